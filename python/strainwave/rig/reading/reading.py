"""From folders of tests and files of loops to what they found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import radians
from pathlib import Path

from strainwave._core import Gear
from strainwave.files.gear_set import GearSet
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.progress import Progress
from strainwave.rig.analysis.sides import friction_at_rest, without_friction
from strainwave.rig.bench.setup import Rig
from strainwave.rig.loop import Loop
from strainwave.rig.reading.evaluation import Evaluation, evaluate
from strainwave.rig.reading.measurement import PLAN, TorsionTest, read_test
from strainwave.rig.reading.recorded import read_loop


@dataclass(frozen=True)
class EvaluationOptions:
    """Options of `evaluate_paths` that the files of tests and loops do not contain; None if not given.

    Attributes:
        rig: instead of `rig.toml` of a test
        gear_set: the gear on the rig
        rated_torque: at the loaded shaft [N.m], instead of that of the gear
        reference: name of the photograph whose angle is 0
        friction: table of speed and torque of the input, whose friction is taken out of the loops
        positions: of the flexspline for each file of a loop [deg]
        columns, units: of files of loops, as `read_loop` takes them
    """

    rig: Rig | None = None
    gear_set: GearSet | None = None
    rated_torque: float | None = None
    reference: str | None = None
    friction: Path | None = None
    positions: Sequence[float] | None = None
    columns: Mapping[str, str] | None = None
    units: Mapping[str, str] | None = None


def evaluate_paths(paths: Sequence[Path], given: EvaluationOptions, progress: Progress = None) -> tuple[Evaluation, list[Path]]:
    """Read folders of tests and files of loops, and evaluate them together.

    Args:
        paths: folders and files
        given: what the files do not contain
        progress: as of `sw.simulate`

    Returns:
        What was found, and the files that were read for it, photographs left out.

    Raises:
        OSError: a file or folder is not there
        ValueError: one cannot be read, or what is given does not fit
    """
    tests, measured, read = _read(paths, given, progress)
    loops = measured
    if given.friction is not None:
        if given.gear_set is None:
            raise ValueError(f"friction {given.friction} needs a gear, whose law of friction is fitted to the table")
        loops, read = _without_friction(measured, given.friction, given.gear_set.gear), [*read, given.friction]
    found = evaluate(
        loops,
        name=" and ".join(path.resolve().name for path in paths),
        measured=measured,
        gear_set=given.gear_set,
        rated_torque=given.rated_torque,
        rig=tests[0].rig if len(tests) == len(paths) else None,
        steps=[step for test in tests for step in test.steps],
        angles=[angles for test in tests for angles in test.angles],
        remarks=[remark for test in tests for remark in test.remarks],
        deviations=_deviations(tests),
    )
    return found, read


def _read(
    paths: Sequence[Path], given: EvaluationOptions, progress: Progress
) -> tuple[list[TorsionTest], list[Loop], list[Path]]:
    if missing := [path for path in paths if not path.exists()]:
        raise FileNotFoundError(f"{missing[0]}: there is no such folder or file")
    files = [path for path in paths if not path.is_dir()]
    if files and (given.rig is not None or given.reference is not None):
        raise ValueError(f"rig and reference are for folders of tests; {files[0]} is no folder")
    if given.positions is not None and len(given.positions) != len(files):
        raise ValueError(f"there are {len(given.positions)} positions for {len(files)} files of loops; give one for each")
    places = iter(given.positions or [0.0] * len(files))
    tests: list[TorsionTest] = []
    loops: list[Loop] = []
    read: list[Path] = []
    for path in paths:
        if path.is_dir():
            _check_test(path, given.rig)
            tests.append(read_test(path, rig=given.rig, reference=given.reference, progress=progress))
            loops += tests[-1].loops
            read += [path / each for each in ("rig.toml", "steps.csv", PLAN) if (path / each).exists()]
        else:
            unit = path.stem if len(files) > 1 and given.positions is None else ""
            place = radians(next(places))
            loops.append(read_loop(path, columns=given.columns, units=given.units, position=place, unit=unit))
            read.append(path)
    return tests, loops, read


def _check_test(folder: Path, rig: Rig | None) -> None:
    """Refuse a folder that holds no test, with what it lacks."""
    if not (folder / "steps.csv").exists():
        raise FileNotFoundError(f"{folder} holds no steps.csv, in which each step of a test has its masses and photograph")
    if rig is None and not (folder / "rig.toml").exists():
        raise FileNotFoundError(f"{folder} holds no rig.toml; name the rig, as --rig couple-rig")


def _deviations(tests: Sequence[TorsionTest]) -> list[str] | None:
    """Return the deviations of tests from the plans in their folders; None if there is no plan."""
    planned = [test.deviations for test in tests if test.deviations is not None]
    return [words for of_test in planned for words in of_test] if planned else None


def _without_friction(loops: Sequence[Loop], table: Path, gear: Gear) -> list[Loop]:
    friction = friction_at_rest(recognise(table, FileMapping(kind="friction")).recording, gear)
    return [without_friction(loop, friction) for loop in loops]
