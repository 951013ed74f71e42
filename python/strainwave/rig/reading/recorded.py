"""Loops that were measured elsewhere: columns of angle and torque in a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.files.tables import open_table
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.messages import listed, one_line, quoted
from strainwave.questions import OF_SIDES, Answer, QuestionError
from strainwave.rig.loop import COLUMNS, Loop, Side

Array = NDArray[np.float64]

BOTH_SHAFTS = QuestionError("it has the angle and torque of both shafts", OF_SIDES)


def read_loop(
    path: str | Path,
    *,
    side: Side | None = None,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    position: float = 0.0,
    unit: str = "",
) -> Loop:
    """Read a loop from columns of angle and torque in a CSV or Parquet file.

    Args:
        path: the file; the columns are found by their names and sizes, or called input_angle and input_torque, or twist and
            torque
        side: which of the two, if the file has both, or if neither names nor sizes determine it
        columns: for each name wanted the name in the file, where it differs
        units: units of columns whose header has none
        position, unit: of the loop

    Returns:
        Angle [rad] and torque [N.m] at that side, shape (n,).

    Raises:
        ValueError: the file cannot be read, lacks a column or has both sides

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "loop.csv")
    ...     _ = path.write_text("input_angle [deg],input_torque [N.m]\\n2,0.6\\n1,0.3\\n0,0\\n-1,-0.3\\n")
    ...     read_loop(path).torque.tolist()
    [0.6, 0.3, 0.0, -0.3]
    """
    recording, remarks = _recording(path, side, columns, units)
    try:
        loop = loop_of(recording, side=side, name=recording.title or Path(path).stem, position=position, unit=unit)
    except ValueError as error:
        raise ValueError(one_line(f"{path}: {error}")) from None
    return replace(loop, remarks=(*loop.remarks, *remarks))


def _recording(
    path: str | Path, side: Side | None, columns: Mapping[str, str] | None, units: Mapping[str, str] | None
) -> tuple[Recording, tuple[str, ...]]:
    """Return the columns of a loop, by their names here or as `recognise` finds them, and what was assumed for them."""
    header = {name.casefold() for name in Recording.header(path)}
    there = [each for each, pair in COLUMNS.items() if set(pair) <= header]
    if not columns and len(there) > 1:
        if side is None:
            raise BOTH_SHAFTS.of(one_line(str(path)))
        columns = {name: name for name in COLUMNS[side]}
    stated = {label.name for label in open_table(path).labels if label.unit is not None}
    found = recognise(path, FileMapping(columns=columns or {}, units=units or {}, kind="torsion", side=side))
    for name in (each for pair in COLUMNS.values() for each in pair if each in found.columns):
        if found.columns[name] not in stated and name not in (units or {}):
            unit = "deg" if name in ("input_angle", "twist") else "N.m"
            question = one_line(f"{path}: column {quoted(found.columns[name])} states no unit")
            raise QuestionError(question, [Answer(f"it is in {unit}", {"units": {name: unit}})])
    assumed = () if columns or there else (*found.why[2:], *found.remarks)  # the first two are its columns and their side
    return found.recording, assumed


def loop_of(recording: Recording, *, side: Side | None = None, name: str = "", position: float = 0.0, unit: str = "") -> Loop:
    """The loop of a recording; the standard deviation of its angles is estimated from their scatter.

    Args:
        recording: with input_angle and input_torque, or twist and torque; temperature, too, if it has it
        side: the shaft that was loaded, where it has both
        name: what was measured; the recording's title if not given
        position, unit: of the loop

    Raises:
        ValueError: neither side is there, or both are and none is chosen

    >>> loop = loop_of(Recording({"twist": [1.0, 0.0], "torque": [5.0, 0.0]}, {"twist": "arcmin", "torque": "N.m"}))
    >>> loop.side, float(loop.angle[0].round(6))
    ('output', 0.000291)
    """
    there = [each for each, pair in COLUMNS.items() if set(pair) <= set(recording.names)]
    if side is None and len(there) > 1:
        raise BOTH_SHAFTS
    chosen = side or (there[0] if there else "input")
    if chosen not in there:
        raise ValueError(f"has no columns {' and '.join(COLUMNS[chosen])}; it has {listed(recording.names)}")
    angle, torque = (recording.values(column, of) for column, of in zip(COLUMNS[chosen], ("rad", "N.m"), strict=True))
    return Loop(
        angle,
        torque,
        side=chosen,
        name=name or recording.title or "loop",
        angle_sigma=scatter(angle, torque),
        time=recording.time if "time" in recording else None,
        temperature=recording.values("temperature", "K") if "temperature" in recording else None,
        position=position,
        unit=unit,
    )


def scatter(angle: Array, torque: Array) -> float:
    r"""Standard deviation of each angle, from how far it lies from the line between its neighbours.

    Of a point between two others of the same branch, with a share w of the way to the second, the distance has the variance
    sigma^2 (1 + (1 - w)^2 + w^2). The median of the distances is taken, so that corners of the curve do not count.

    Args:
        angle: [rad], shape (n,)
        torque: in the order measured, shape (n,)

    Returns:
        0 where fewer than three points lie between others.

    >>> torque = np.linspace(0.0, 1.0, 5)
    >>> scatter(2.0 * torque, torque)
    0.0
    """
    before, after = torque[1:-1] - torque[:-2], torque[2:] - torque[1:-1]
    inside = before * after > 0.0
    if np.sum(inside) < 3:
        return 0.0
    w = (before / np.where(inside, before + after, 1.0))[inside]
    apart = (angle[1:-1] - angle[:-2])[inside] - w * (angle[2:] - angle[:-2])[inside]
    normal = np.abs(apart) / np.sqrt(1.0 + (1.0 - w) ** 2 + w**2)
    return float(np.median(normal)) / 0.674489750196082  # the median of |x| of a standard normal distribution
