"""Columns without names: a time, then blocks of one column for each joint, of which the second is the speed of the first.

Matrices that controllers and simulators write have this layout: time, q of all joints, dq of all joints, then torques or
currents; or q, dq and torque of one joint after the other. The numbers determine it: an angle has a slope.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Content, Label, Source
from strainwave.files.tables import OpenTable
from strainwave.identification.reading.names import QUANTITY_OF, meaning, words_of
from strainwave.messages import listed

Array = NDArray[np.float64]

MAX_UNEVEN = 0.5  # of the usual step: half of the steps of a time differ from it by less
MIN_SLOPE_CORRELATION = 0.95  # of a speed and of the slope of its angle
MAX_ROWS = 20_000  # that are compared
MAX_VALUE = 1e30  # in any unit: a column with larger numbers was not measured
MAX_COLUMNS = 64  # that are compared with each other
MIN_SHARE_OF_MATRIX = 0.6  # of the columns
MIN_SPREAD = 1e-9  # of the largest one of all columns: what varies by less is rounding
MIN_ROWS = 20  # of samples: fewer are a table
DIFFERENCES = (2000, 200)  # parts of a record over which slopes are taken, the finest first: encoders have steps
MAX_GAP = 0.5  # of the range of an angle: a larger step is a revolution begun anew, and has no slope


@dataclass(frozen=True)
class Layout:
    """Which column of a matrix is which.

    Args:
        names: of each column by its layout, as `q_2`, `dq_2` or `block3_2`; empty for one that belongs to none
        time: place of the time; None if no column is one
        joints: their number
        efforts: the blocks that may be torques or currents, each by its name and the places of its columns
    """

    names: tuple[str, ...]
    time: int | None
    joints: int
    efforts: Mapping[str, tuple[int, ...]]

    def options(self, known_time: bool) -> str:
        """The options to add on the command line, so that the columns are read.

        Args:
            known_time: True if the time is known without this layout
        """
        rate = "" if known_time or self.time is not None else " --constant rate=HZ"
        first = next(iter(self.efforts), "NAME")
        return f"--column joint_torque={first}{rate}, or --column current={first}{rate} if it is a current"


@dataclass(frozen=True, eq=False)
class LaidOutTable:
    """A table whose columns have no names that mean anything, with the names of its layout."""

    table: OpenTable
    layout: Layout

    @property
    def file(self) -> str:
        return self.table.file

    @property
    def title(self) -> str:
        return self.table.title

    @property
    def labels(self) -> Sequence[Label]:
        return [
            Label(label.text, name, label.unit) if name else label
            for label, name in zip(self.table.labels, self.layout.names, strict=True)
        ]

    @property
    def contents(self) -> Sequence[Content]:
        return self.table.contents

    @property
    def left_out(self) -> Sequence[str]:
        return self.table.left_out

    def numbers(self, sources: Sequence[Source]) -> dict[str, Array]:
        """The columns wanted, all of them numbers."""
        return self.table.numbers(sources)

    def measured(self, sources: Sequence[Source]) -> tuple[dict[str, Array], list[str]]:
        """The columns wanted, nan where nothing is written; and what was left out."""
        return self.table.measured(sources)

    def place(self, row: int) -> str:
        return self.table.place(row)

    @property
    def remark(self) -> str:
        """What was determined, in words."""
        places = {name: str(place + 1) for place, name in enumerate(self.layout.names) if name}
        angles, speeds = ([each for name, each in places.items() if name.partition("_")[0] == stem] for stem in ("q", "dq"))
        time = "" if self.layout.time is None else f"column {self.layout.time + 1} is the time, "
        return f"its columns have no names, but a layout: {time}{_run(angles)} the angle of joints, {_run(speeds)} the speed"


def with_layout(table: OpenTable) -> OpenTable:
    """Return the table with the names of its layout, if no name means a motion or a torque and the numbers determine one.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from strainwave.files.tables import open_table
    >>> time = np.arange(0.0, 5.0, 0.01)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     columns = [time, np.sin(time), np.sin(3.0 * time), np.cos(time), 3.0 * np.cos(3.0 * time), time % 0.3, time % 0.2]
    ...     np.savetxt(Path(folder, "log.txt"), np.stack(columns, axis=1))
    ...     table = with_layout(open_table(Path(folder, "log.txt")))
    >>> [label.name for label in table.labels]
    ['time', 'q_1', 'q_2', 'dq_1', 'dq_2', 'block3_1', 'block3_2']
    """
    quantities = [found.quantity if (found := meaning(label)) else None for label in table.labels]
    if set(quantities) - {"time", None}:
        return table
    timed = next((place for place, quantity in enumerate(quantities) if quantity == "time"), None)
    layout = layout_of(table, timed)
    return LaidOutTable(table, layout) if layout is not None else table


@np.errstate(all="ignore")
def layout_of(table: OpenTable, timed: int | None = None) -> Layout | None:
    """The layout of the columns of a table; None if the numbers determine none.

    Args:
        timed: place of the time, if its name is known
    """
    places = [place for place, content in enumerate(table.contents) if content == "numbers"]
    if len(places) < 3 or not nameless(table):
        return None
    numbers, _ = table.measured([Source(place, str(place), str(place), "1") for place in places[:MAX_COLUMNS]])
    begins = {int(place): values[:MAX_ROWS] for place, values in numbers.items()}
    finite = {place: np.where(np.isfinite(values), values, np.nan) for place, values in begins.items()}
    columns = {place: values for place, values in finite.items() if _may_be_measured(values)}
    rows = len(next(iter(columns.values()), []))
    if rows < MIN_ROWS:
        return None
    time = timed if timed is not None else next((place for place, values in columns.items() if rises_evenly(values)), None)
    instants = columns.get(time, np.arange(rows, dtype=float)) if time is not None else np.arange(rows, dtype=float)
    spread = {place: float(np.nanstd(values)) for place, values in columns.items() if place != time}
    moving = {place: columns[place] for place in spread if spread[place] > MIN_SPREAD * max(spread.values())}
    pairs = _speeds(moving, instants)
    return _blocks(pairs, [place for place in places if place != time], len(table.labels), time)


def nameless(table: OpenTable) -> bool:
    """True if the columns have no names, or most of them are the numbered columns of one matrix."""
    words = [words_of(label.name) for label in table.labels]
    names = Counter(tuple(word for word in each if not word.isdigit()) for each in words)
    most, count = names.most_common(1)[0] if names else ((), 0)
    is_matrix = count == len(words) or (count > 1 and count > MIN_SHARE_OF_MATRIX * len(words))
    return is_matrix and any(word.isdigit() for each in words for word in each) and not set(most) & QUANTITY_OF.keys()


def _blocks(pairs: Sequence[tuple[int, int]], places: Sequence[int], count: int, time: int | None) -> Layout | None:
    """The layout of columns that contain these pairs of an angle and its speed, those that move most first."""
    order = {place: at for at, place in enumerate(places)}
    ranks = [(order[one], order[other]) for one, other in pairs if one in order and order.get(other, -1) > order[one]]
    speeds = {speed for _, speed in ranks}
    own = [pair for pair in ranks if pair[0] not in speeds]  # speeds have slopes, too: accelerations
    if not own:
        return None
    (apart, _), *_ = Counter(speed - angle for angle, speed in own).most_common(1)
    angles = [angle for angle, speed in own if speed - angle == apart]
    interleaved = apart == 1 and len(angles) > 1
    width = int(np.gcd.reduce([angle - min(angles) for angle in angles])) if interleaved else 0
    joints = len(places) // width if width else apart
    if (interleaved and (width < 2 or min(angles) >= width)) or (not interleaved and angles[0] >= joints):
        return None
    is_accelerated = any((angle + apart, angle + 2 * apart) in ranks for angle in angles)
    stems = ("q", "dq", "ddq") if is_accelerated else ("q", "dq")
    names, efforts = [""] * count, dict[str, list[int]]()
    if time is not None:
        names[time] = "time"
    for place, at in order.items():
        block, joint = (at % width, at // width) if width else divmod(at, joints)
        if joint >= joints or (not width and (block + 1) * joints > len(places)):
            continue
        stem = stems[block] if block < len(stems) else f"block{block + 1}"
        names[place] = stem if joints == 1 else f"{stem}_{joint + 1}"
        if block >= len(stems):
            efforts.setdefault(stem, []).append(place)
    return Layout(tuple(names), time, joints, {name: tuple(each) for name, each in efforts.items()})


@np.errstate(all="ignore")
def is_slope(speeds: Sequence[Array], angles: Sequence[Array]) -> bool:
    """True if series are the slopes of others over rows, of those that move."""
    rows = np.arange(len(angles[0]), dtype=float) if angles else np.zeros(0)
    pairs = [
        (angle, speed) for angle, speed in zip(angles, speeds, strict=False) if len(angle) == len(speed) and np.ptp(angle) > 0.0
    ]
    alike = [_likeness(angle, speed, rows, max(2, len(rows) // DIFFERENCES[0])) for angle, speed in pairs]
    return bool(alike) and float(np.median(alike)) > MIN_SLOPE_CORRELATION


def rises_evenly(values: Array) -> bool:
    """True if a series rises by about equal steps, as a time does."""
    steps = np.diff(values)
    usual = float(np.median(steps)) if len(steps) > 2 else 0.0
    return bool(usual > 0.0 and (steps >= 0.0).all() and np.quantile(np.abs(steps - usual), 0.5) <= MAX_UNEVEN * usual)


def _may_be_measured(values: Array) -> bool:
    """True if a column holds numbers, and but for single rows none beyond all that is measured."""
    finite = np.isfinite(values)
    return bool(finite.any() and np.quantile(np.abs(values[finite]), 0.99) < MAX_VALUE)


def _speeds(columns: Mapping[int, Array], time: Array) -> list[tuple[int, int]]:
    """Angles and the speeds that are their slopes, the angles that move most first."""
    found = dict[int, int]()
    for parts in DIFFERENCES:
        apart = max(2, len(time) // parts)
        for angle in columns.keys() - found.keys() if len(time) > apart else ():
            alike = {
                speed: _likeness(columns[angle], others, time, apart) for speed, others in columns.items() if speed != angle
            }
            if alike and alike[best := max(alike, key=lambda speed: alike[speed])] > MIN_SLOPE_CORRELATION:
                found[angle] = best
    return sorted(found.items(), key=lambda pair: -float(np.nanmax(columns[pair[0]]) - np.nanmin(columns[pair[0]])))


def _likeness(angle: Array, speed: Array, time: Array, apart: int) -> float:
    """Correlation of a speed and of the slope of an angle over rows that are so far apart; 0 if one of them rests."""
    elapsed, moved = time[apart:] - time[:-apart], angle[apart:] - angle[:-apart]
    middle = speed[apart // 2 : len(speed) - apart + apart // 2]
    sound = (elapsed > 0.0) & (np.abs(moved) < MAX_GAP * (np.nanmax(angle) - np.nanmin(angle))) & np.isfinite(middle)
    slope, middle = moved[sound] / elapsed[sound], middle[sound]
    if len(slope) < MIN_ROWS or not np.std(slope) > 0.0 or not np.std(middle) > 0.0:
        return 0.0
    return float(np.corrcoef(slope, middle)[0, 1])


def _run(places: Sequence[str]) -> str:
    if len(places) == 1:
        return f"column {places[0]} is"
    is_run = int(places[-1]) - int(places[0]) == len(places) - 1
    return f"columns {f'{places[0]} to {places[-1]}' if is_run else listed(places)} are"
