"""What columns without names seem to be, by their numbers alone: a time that rises evenly, angles and their speeds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Source
from strainwave.files.tables import OpenTable

Array = NDArray[np.float64]

EVEN = 0.5  # of the usual step: by which half of the steps of a time differ from it at most
SLOPE = 0.95  # correlation of a speed and of the slope of its angle
SEEN = 20_000  # rows that are looked at
BEYOND = 1e30  # in any unit
MOST = 64  # columns that are compared with each other
FEWEST = 20  # rows of samples: fewer are a table
ALONE = "of a record at one constant speed say it, as with --column current=1 --constant speed='20 1/min'"


def apparent(table: OpenTable) -> str:
    """What the columns of a table seem to be, and the options that say so; empty where its numbers tell nothing.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from strainwave.files.tables import open_table
    >>> time = np.arange(0.0, 5.0, 0.01)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.savetxt(Path(folder, "log.txt"), np.stack([time, np.sin(time), np.cos(time), time % 0.3], axis=1))
    ...     said = apparent(open_table(Path(folder, "log.txt")))
    >>> said.partition(": ")[0]
    'column 1 rises as a time does, and column 3 is the speed of 2'
    >>> said.partition("as with ")[2]
    '--column time=1 --column output_angle=2 --column output_speed=3 --column current=4'
    """
    places = [place for place, content in enumerate(table.contents) if content == "numbers"][:MOST]
    if len(places) < 2:
        return ALONE if len(places) == 1 else ""
    numbers, _ = table.measured([Source(place, str(place), str(place), "1") for place in places])
    columns = {place: values for place in places if _may_be_measured(values := numbers[str(place)][:SEEN])}
    if not columns:
        return ""
    rows = len(next(iter(columns.values())))
    time = next((place for place, values in columns.items() if _rises_evenly(values)), None)
    moving = {place: values for place, values in columns.items() if place != time and np.nanstd(values) > 0.0}
    if not moving or rows < FEWEST:
        return ""
    instants = np.arange(rows, dtype=float) if time is None else columns[time]
    pairs = _speeds(moving, instants)
    said = ["no column rises as a time does" if time is None else f"column {time + 1} rises as a time does"]
    options = ["--constant rate=HZ" if time is None else f"--column time={time + 1}"]
    slopes = {place for pair in pairs for place in pair}
    pairs = [pair for pair in pairs if pair[0] not in {speed for _, speed in pairs}]  # speeds have slopes, too
    if pairs:
        more = "".join(f", {speed + 1} of {angle + 1}" for angle, speed in pairs[1:])
        angle, speed = pairs[0]
        said.append(f"column {speed + 1} is the speed of {angle + 1}{more}")
        options += [f"--column output_angle={angle + 1}", f"--column output_speed={speed + 1}"]
    else:
        angle, speed = min(moving, key=lambda place: _roughness(moving[place])), None
        options.append(f"--column output_angle={angle + 1}")
    effort = _effort([place for place in moving if place not in slopes and place != angle], angle, speed)
    guess = "" if pairs else " the angle and"
    tells = [f"--column current={effort + 1}"] if effort is not None else []
    return f"{', and '.join(said)}: name{guess} what tells the torque, as with {' '.join([*options, *tells])}"


def _may_be_measured(values: Array) -> bool:
    """Whether a column holds numbers, of which none is beyond all that is measured."""
    return bool(np.isfinite(values).any() and np.nanmax(np.abs(values)) < BEYOND)


def _effort(left: Sequence[int], angle: int, speed: int | None) -> int | None:
    """The column that may tell the torque: as far behind the speed as that is behind the angle, or else any that is left.

    Matrices hold the angles of all joints, then their speeds, perhaps accelerations, and then torques.
    """
    if speed is None:
        return next(iter(left), None)
    return min(left, key=lambda place: (place < speed or (place - speed) % (speed - angle) != 0, place), default=None)


def _roughness(values: Array) -> float:
    """How much a series changes from row to row, over how much it varies."""
    return float(np.nanstd(np.diff(values)) / np.nanstd(values))


def _rises_evenly(values: Array) -> bool:
    steps = np.diff(values)
    usual = float(np.median(steps)) if len(steps) > 2 else 0.0
    return bool(usual > 0.0 and (steps >= 0.0).all() and np.quantile(np.abs(steps - usual), 0.5) <= EVEN * usual)


@np.errstate(all="ignore")
def _speeds(columns: Mapping[int, Array], time: Array) -> list[tuple[int, int]]:
    """Angles and the speeds that are their slopes, the angles that move most first."""
    apart = max(2, len(time) // 2000)
    elapsed = time[apart:] - time[:-apart]
    forward = elapsed > 0.0
    found = []
    for angle, values in columns.items():
        if len(values) <= apart:
            continue
        slope = ((values[apart:] - values[:-apart])[forward]) / elapsed[forward]
        if not np.std(slope) > 0.0:
            continue
        for speed, others in columns.items():
            middle = others[apart // 2 : len(others) - apart + apart // 2][forward]
            if speed != angle and np.std(middle) > 0.0 and np.corrcoef(slope, middle)[0, 1] > SLOPE:
                found.append((angle, speed))
                break
    return sorted(found, key=lambda pair: -float(np.ptp(columns[pair[0]])))
