"""Files of a torsion test in the folder of its report: loops, the angle of each photograph, and every number found."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from importlib import metadata
from io import BytesIO, StringIO
from math import degrees
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from strainwave.files.recording import Recording
from strainwave.identification.kinds.torsion_loop import in_steps
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import results_json
from strainwave.rig.analysis.analysis import LoopAnalysis
from strainwave.rig.loop import COLUMNS, Loop
from strainwave.rig.reading.evaluation import Evaluation
from strainwave.rig.report.page import rig_report
from strainwave.rig.vision.angle import Angles

MARKER_COLUMNS = dict.fromkeys(("x", "y", "radius", "sigma", "residual"), "px") | {"contrast": "", "blur": "px", "arc": ""}
NUMBERS = ("hysteresis", "width_at_zero", "rated_torque", "hysteresis_loss", "lost_motion", "torque_width", "area", "closure")
MAX_NAME_PART = 40  # characters of a specimen in the name of a file, which has at most 255 bytes


def loop_names(loops: Sequence[Loop]) -> list[str]:
    """Return the name of each loop, as its files have it: unit, position and, where several are alike, a number.

    >>> turned = [Loop([0.0, 0.1], [0.0, 0.1], side="input", name="a", position=p) for p in (0.0, 1.0471975511965976, 0.0)]
    >>> loop_names(turned)
    ['loop-0deg-1', 'loop-60deg', 'loop-0deg-2']
    """
    plain = []
    for loop in loops:
        kept = "".join(each if each.isalnum() or each in "._" else "-" for each in loop.unit[:MAX_NAME_PART]).strip("-.")
        plain.append(f"loop-{f'{kept}-' if kept else ''}{degrees(loop.position):.6g}deg")
    names = []
    for place, name in enumerate(plain):
        names.append(f"{name}-{plain[: place + 1].count(name)}" if plain.count(name) > 1 else name)
    return names


def loop_files(loops: Sequence[Loop]) -> dict[str, bytes]:
    """Return each loop as CSV and as Parquet, from which `strainwave identify` recognises it as a torsion loop.

    `identify` takes friction of the input out by itself: the loops must be those that contain it, `Evaluation.measured`.
    """
    made = {}
    with TemporaryDirectory() as folder:
        for name, loop in zip(loop_names(loops), loops, strict=True):
            recording = _without_fast_clock(loop.recording())
            for path, write in (
                (Path(folder, f"{name}.csv"), recording.to_csv),
                (Path(folder, f"{name}.parquet"), recording.to_parquet),
            ):
                write(path)
                made[path.name] = path.read_bytes()
    return made


def _without_fast_clock(recording: Recording) -> Recording:
    """Return a loop without its time if rows follow so fast that they would be taken for a log of a drive."""
    angle, torque = (name for pair in COLUMNS.values() for name in pair if name in recording)
    if "time" not in recording or in_steps(recording.time, recording[angle], recording[torque]):
        return recording
    return recording.select([name for name in recording.names if name != "time"])


def angle_files(angles: Sequence[Angles]) -> dict[str, bytes]:
    """Return a row for each photograph, as CSV and as Parquet: its angle, both markers, and what is wrong with it."""
    import pyarrow
    from pyarrow.parquet import write_table

    if not angles:
        return {}
    rows = list(_angle_rows(angles))
    text, parquet = StringIO(), BytesIO()
    writer = csv.DictWriter(text, rows[0], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_table(pyarrow.Table.from_pylist(rows), parquet, compression="zstd")
    return {"angles.csv": text.getvalue().encode(), "angles.parquet": parquet.getvalue()}


def _angle_rows(angles: Sequence[Angles]) -> Iterator[dict[str, str | float | None]]:
    for each in angles:
        by_name = {frame.name: (angle, sigma) for frame, angle, sigma in zip(each.useful, each.angle, each.sigma, strict=True)}
        for frame in each.frames:
            angle, sigma = by_name.get(frame.name, (None, None))
            row: dict[str, str | float | None] = {"image": frame.name, "sha256": frame.sha256, "reference": each.reference}
            row |= {"angle [rad]": angle, "angle_sigma [rad]": sigma}
            row |= {"fault": frame.fault, "warnings": "; ".join(frame.warnings)}
            for number in (1, 2):
                marker = frame.markers[number - 1] if frame.markers else None
                for name, unit in MARKER_COLUMNS.items():
                    value = None if marker is None else float(getattr(marker, name))
                    row[f"marker_{number}_{name}{f' [{unit}]' if unit else ''}"] = value
            yield row


def results(found: Evaluation, date: str = "") -> dict[str, Any]:
    """Every number that a test found, in SI units; each loop with the names of its files."""
    names = loop_names(found.loops)
    return {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "date": date,
        "name": found.name,
        "gear": None if found.gear_set is None else found.gear_set.name,
        "rig": found.rig,
        "loops": [
            _loop_results(name, label, analysis)
            for name, label, analysis in zip(names, found.labels, found.analyses, strict=True)
        ],
        "comparisons": found.comparisons,
        "photographs": {frame.name: frame.sha256 for each in found.angles for frame in each.frames},
        "remarks": found.remarks,
        "deviations_from_plan": found.deviations,
    }


def _loop_results(name: str, label: str, analysis: LoopAnalysis) -> dict[str, Any]:
    loop = analysis.loop
    return {
        "label": label,
        "files": [f"{name}.csv", f"{name}.parquet"],
        "side": loop.side,
        "position": loop.position,
        "unit": loop.unit,
        "points": len(loop),
        "peaks": analysis.peaks,
        "stiffness": {
            each.name: {
                "secant": each.secant,
                "regression": each.regression,
                "softest": each.softest,
                "softest_from": each.stretch[0],
                "softest_to": each.stretch[1],
                "local": each.local,
            }
            for each in analysis.stiffnesses
        },
        **{key: getattr(analysis, key) for key in NUMBERS},
        "drift": analysis.drift,
        "soft_spots": analysis.soft_spots,
        "catalogue": analysis.catalogue,
        "corrections": loop.corrections,
        "remarks": analysis.remarks,
    }


def files_of(found: Evaluation, provenance: Provenance | None = None) -> dict[str, str | bytes]:
    """Return loops and angles of a test of torsion as tables, the numbers as JSON, and the page, by file name."""
    files: dict[str, str | bytes] = {**loop_files(found.measured), **angle_files(found.angles)}
    files["results.json"] = results_json(results(found, provenance.date if provenance else ""))
    files["report.html"] = rig_report(found, provenance, list(files))
    return files
