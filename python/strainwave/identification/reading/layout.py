"""Columns without names: a time, then blocks of one column for each joint, of which the second is the speed of the first.

Matrices that controllers and simulators write have this layout: time, q of all joints, dq of all joints, then torques or
currents; or q, dq and torque of one joint after the other. The numbers determine it: an angle has a slope.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import ColumnSource
from strainwave.files.table_format import OpenTable
from strainwave.identification.reading.names import QUANTITY_OF, meaning, words_of
from strainwave.identification.reading.slopes import MIN_CORRELATION, PARTS_OF_RECORD, correlation
from strainwave.messages import listed
from strainwave.questions import LOG_AT_RATE, Answer, QuestionError

Array = NDArray[np.float64]

MAX_BLOCKS_OFFERED = 2  # by a question
MAX_UNEVEN = 0.5  # of the usual step: half of the steps of a time differ from it by less
MAX_ROWS = 20_000  # that are compared
MAX_VALUE = 1e30  # in any unit: a column with larger numbers was not measured
MAX_COLUMNS = 64  # that are compared with each other
MIN_SHARE_OF_MATRIX = 0.6  # of the columns
MAX_JOINTS = 14  # whose numbers may follow each other in one column: two arms
MIN_SAMPLES_OF_JOINT, MAX_SAMPLES_OF_LAYOUT = 20, 2000  # of each of them
MAX_STEP_OF_JOINT = 0.2  # of the step from joint to joint, by which a joint moves between two samples
MIN_SPREAD = 1e-9  # of the largest one of all columns: what varies by less is rounding
MIN_ROWS = 20  # of samples: fewer are a table


@dataclass(frozen=True)
class MatrixLayout:
    """Meaning of the columns of a matrix.

    Args:
        names: of each column by its layout, as `q_2`, `dq_2` or `block3_2`; empty for one that belongs to none
        time: position of the time; None if no column is one
        joints: their number
        efforts: the blocks that may be torques or currents, each by its name and the positions of its columns
    """

    names: tuple[str, ...]
    time: int | None
    joints: int
    efforts: Mapping[str, tuple[int, ...]]

    def named(self, table: OpenTable) -> OpenTable:
        """Return a table with these names of its columns."""
        opened: Any = table  # a dataclass, whatever the format
        pairs = zip(table.labels, self.names, strict=True)
        renamed: OpenTable = replace(opened, labels=[label._replace(name=name) if name else label for label, name in pairs])
        return renamed

    def question(self, *, is_timed: bool) -> QuestionError:
        """Return the question which block is the torque or current.

        Args:
            is_timed: True if the time of the rows is known
        """
        rate = ({}, {}) if is_timed else (LOG_AT_RATE.given, LOG_AT_RATE.numbers)
        ways = [
            Answer(f"{name} is a {what}", {"columns": {channel: name}, **rate[0]}, rate[1])
            for name in list(self.efforts)[:MAX_BLOCKS_OFFERED]
            for channel, what in (("joint_torque", "torque of the joint"), ("current", "current of the motor"))
        ]
        time = "" if self.time is None else f"column {self.time + 1} is the time, "
        motions = [[place for place, name in enumerate(self.names) if name.partition("_")[0] == each] for each in ("q", "dq")]
        angles, speeds = (f"{_columns(places)} {'is' if len(places) == 1 else 'are'}" for places in motions)
        blocks = listed(f"{name} = {_columns(places)}" for name, places in self.efforts.items())
        found = f"its columns have no names, but a layout: {time}{angles} the angle of joints, {speeds} the speed"
        return QuestionError(f"{found}; which is the torque or current, of {blocks}", ways)


def _columns(places: Sequence[int]) -> str:
    is_run = places[-1] - places[0] == len(places) - 1 > 0
    numbers = f"{places[0] + 1} to {places[-1] + 1}" if is_run else listed(str(place + 1) for place in places)
    return f"column{'s' * (len(places) > 1)} {numbers}"


def layout_of(table: OpenTable) -> MatrixLayout | None:
    """Return the layout of the columns of a table; None if a name means a motion or torque, or the numbers determine none.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from strainwave.files.tables import open_table
    >>> time = np.arange(0.0, 5.0, 0.01)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     columns = [time, np.sin(time), np.sin(3.0 * time), np.cos(time), 3.0 * np.cos(3.0 * time), time % 0.3, time % 0.2]
    ...     np.savetxt(Path(folder, "log.txt"), np.stack(columns, axis=1))
    ...     layout = layout_of(open_table(Path(folder, "log.txt")))
    >>> layout.names
    ('time', 'q_1', 'q_2', 'dq_1', 'dq_2', 'block3_1', 'block3_2')
    """
    quantities = [found.quantity if (found := meaning(label)) else None for label in table.labels]
    if set(quantities) - {"time", None}:
        return None
    return _by_numbers(table, quantities.index("time") if "time" in quantities else None)


@np.errstate(all="ignore")
def _by_numbers(table: OpenTable, timed: int | None) -> MatrixLayout | None:
    """Return the layout of a table by its numbers, and by the position of its time if a name contains it."""
    places = [place for place, content in enumerate(table.contents) if content == "numbers"]
    if len(places) < 3 or not nameless(table):
        return None
    numbers, _ = table.measured([ColumnSource(place, str(place), str(place), "1") for place in places[:MAX_COLUMNS]])
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
    found = _blocks(pairs, [place for place in places if place != time], len(table.labels), time)
    efforts = {} if found is None else {name: each for name, each in found.efforts.items() if set(each) & moving.keys()}
    return found and replace(found, efforts=efforts)


def interleaved(values: Array) -> int:
    """Return the number of joints whose numbers follow each other in one series; 0 if it is of one channel.

    >>> time = np.arange(0.0, 3.0, 0.01)
    >>> interleaved(np.stack([time, 5.0 - time, np.sin(time)], axis=1).ravel()), interleaved(np.sin(time))
    (3, 0)
    """
    values = values[: MAX_JOINTS * MAX_SAMPLES_OF_LAYOUT]
    if len(values) < MIN_SAMPLES_OF_JOINT * MAX_JOINTS or not np.isfinite(values).all():
        return 0
    steps = [float(np.mean(np.abs(values[each:] - values[:-each]))) for each in range(1, MAX_JOINTS + 1)]
    best = int(np.argmin(steps))
    return best + 1 if best and steps[best] < MAX_STEP_OF_JOINT * steps[0] else 0


def nameless(table: OpenTable) -> bool:
    """True if the columns have no names, or most of them are the numbered columns of one matrix."""
    words = [words_of(label.name) for label in table.labels]
    names = Counter(tuple(word for word in each if not word.isdigit()) for each in words)
    most, count = names.most_common(1)[0] if names else ((), 0)
    is_matrix = count == len(words) or (count > 1 and count > MIN_SHARE_OF_MATRIX * len(words))
    return is_matrix and any(word.isdigit() for each in words for word in each) and not set(most) & QUANTITY_OF.keys()


def _blocks(pairs: Sequence[tuple[int, int]], places: Sequence[int], count: int, time: int | None) -> MatrixLayout | None:
    """Return the layout of columns that contain these pairs of an angle and its speed, those that move most first."""
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
    return MatrixLayout(tuple(names), time, joints, {name: tuple(each) for name, each in efforts.items()})


def rises_evenly(values: Array) -> bool:
    """True if a series rises by about equal steps, as a time does."""
    steps = np.diff(values)
    usual = float(np.median(steps)) if len(steps) > 2 else 0.0
    return bool(usual > 0.0 and (steps >= 0.0).all() and np.quantile(np.abs(steps - usual), 0.5) <= MAX_UNEVEN * usual)


def _may_be_measured(values: Array) -> bool:
    """True if a column contains numbers, of which single ones alone are larger than anything that is measured."""
    finite = np.isfinite(values)
    return bool(finite.any() and np.quantile(np.abs(values[finite]), 0.99) < MAX_VALUE)


def _speeds(columns: Mapping[int, Array], time: Array) -> list[tuple[int, int]]:
    """Return angles and the speeds that are their slopes, the angles that move most first."""
    found = dict[int, int]()
    for parts in PARTS_OF_RECORD:
        for angle in columns.keys() - found.keys():
            others = [place for place in columns if place != angle]
            alike = {place: correlation(columns[angle], columns[place], time, parts) for place in others}
            if alike and alike[best := max(alike, key=lambda place: alike[place])] > MIN_CORRELATION:
                found[angle] = best
    return sorted(found.items(), key=lambda pair: -float(np.nanmax(columns[pair[0]]) - np.nanmin(columns[pair[0]])))
