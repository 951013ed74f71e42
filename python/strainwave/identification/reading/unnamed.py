"""Columns whose names mean nothing: the layout of a matrix by its numbers, and what a person is asked to name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import ColumnSource
from strainwave.files.table_format import OpenTable
from strainwave.identification.reading.motion import MIN_CORRELATION, PARTS_OF_RECORD, correlation
from strainwave.identification.reading.names import QUANTITY_OF, meaning, words_of
from strainwave.identification.reading.roles import Column
from strainwave.messages import MAX_TEXT, listed, one_line
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
        layout = f"its columns have no names, but a layout: {time}{angles} the angle of joints, {speeds} the speed"
        return QuestionError(f"{layout}; which is the torque or current, of {blocks}", ways)


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
    quantities = [channel.quantity if (channel := meaning(label)) else None for label in table.labels]
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
    # Single numbers alone may be larger than anything that is measured.
    sizes = {place: np.abs(values[np.isfinite(values)]) for place, values in finite.items()}
    columns = {place: finite[place] for place, size in sizes.items() if size.size and np.quantile(size, 0.99) < MAX_VALUE}
    rows = len(next(iter(columns.values()), []))
    if rows < MIN_ROWS:
        return None
    time = timed if timed is not None else next((place for place, values in columns.items() if rises_evenly(values)), None)
    instants = columns.get(time, np.arange(rows, dtype=float)) if time is not None else np.arange(rows, dtype=float)
    spread = {place: float(np.nanstd(values)) for place, values in columns.items() if place != time}
    moving = {place: columns[place] for place in spread if spread[place] > MIN_SPREAD * max(spread.values())}
    pairs = _speeds(moving, instants)
    layout = _blocks(pairs, [place for place in places if place != time], len(table.labels), time)
    efforts = {} if layout is None else {name: each for name, each in layout.efforts.items() if set(each) & moving.keys()}
    return layout and replace(layout, efforts=efforts)


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


def _speeds(columns: Mapping[int, Array], time: Array) -> list[tuple[int, int]]:
    """Return angles and the speeds that are their slopes, the angles that move most first."""
    speed_of = dict[int, int]()
    for parts in PARTS_OF_RECORD:
        for angle in columns.keys() - speed_of.keys():
            others = [place for place in columns if place != angle]
            alike = {place: correlation(columns[angle], columns[place], time, parts) for place in others}
            if alike and alike[best := max(alike, key=lambda place: alike[place])] > MIN_CORRELATION:
                speed_of[angle] = best
    return sorted(speed_of.items(), key=lambda pair: -float(np.nanmax(columns[pair[0]]) - np.nanmin(columns[pair[0]])))


# ---- Questions -------------------------------------------------------------------------------------------------------


MAX_OFFERED = 3  # columns of one question
MAX_COMPARED = 64  # columns whose numbers are read
MIN_STAMP = 1e8  # of a column: s since 1970, or ns in a second, and nothing that a drive measures
EFFORTS_IN_WORDS = {"joint_torque": "the torque of the joint", "current": "the current of the motor"}
MOTIONS_IN_WORDS = {"output_angle": "the angle of the joint", "input_angle": "the angle of the motor", "speed": "a speed"}
OF_ONE_SIDE = ("friction", "torsion")  # kinds whose torque has no side in its name
PAIRS_OF_CHANNELS = (("output_angle", "joint_torque"), ("speed", "torque"))  # of channels that are a measurement together
FREQUENCY_WORDS, RESPONSE_WORDS = (
    {"frequency", "freq", "frequenz"},
    {"magnitude", "mag", "gain", "amplitude", "phase", "betrag"},
)
CONSTANT_SPEED = {"constants": {"speed": 10.0}}, {"speed": "the constant speed [rad/s]"}


def is_measured(values: Array) -> bool:
    """True if a series may be measured: it varies, and is no counter and no time stamp.

    >>> [is_measured(np.array(each)) for each in ([3.0, 4.0, 5.0], [7.0, 7.0], [1.7e9, 1.7e9 + 0.1], [0.1, 0.3, 0.2])]
    [False, False, False, True]
    """
    finite = values[np.isfinite(values)]
    if len(finite) < 2 or not np.ptp(finite) > 0.0 or np.abs(finite).max() > MIN_STAMP:
        return False
    steps = np.diff(finite)
    is_counter = bool((finite == np.round(finite)).all() and len(np.unique(steps[steps != 0.0])) == 1 and (steps >= 0.0).all())
    return not is_counter


def measured_columns(table: OpenTable, used: Sequence[int]) -> dict[str, Array]:
    """Return the numbers of the columns of a file that may be measured, but for those at some positions, by their names."""
    labels = [label.name for label in table.labels]
    places = [place for place, content in enumerate(table.contents) if content == "numbers" and place not in used]
    sources = [ColumnSource(place, str(place), str(place), "1") for place in places[:MAX_COMPARED]]
    numbers, _ = table.measured(sources) if sources else ({}, [])
    is_plain = {name for name in labels if name and labels.count(name) == 1 and len(name) <= MAX_TEXT and name.isprintable()}
    names = {place: labels[place] if labels[place] in is_plain else str(place + 1) for place in places}
    return {names[int(place)]: values for place, values in numbers.items() if is_measured(values)}


def answers(table: OpenTable, known: Sequence[Column], kind: str | None) -> list[Answer]:
    """Return what the columns of a file may be whose names mean nothing, if others lack an effort, a motion, or both."""
    series = measured_columns(table, [column.position for column in known])
    quantities = {column.channel.quantity for column in known if column.own and not column.channel.commanded}
    has_effort, has_motion = bool(quantities & {"torque", "current"}), bool(quantities & {"angle", "speed", "twist"})
    names = [name for name, values in series.items() if not rises_evenly(values)] or list(series)
    if has_effort != has_motion:
        wanted = {"torque": "the torque"} if "twist" in quantities or kind in OF_ONE_SIDE else EFFORTS_IN_WORDS
        return _each(names, wanted if has_motion else MOTIONS_IN_WORDS)
    if has_effort or not names:
        return []
    if len(names) == 1:
        statement, numbers = CONSTANT_SPEED
        ways = [_named({channel: names[0]}) for channel in EFFORTS_IN_WORDS]
        return [Answer(f"{way.label}, at one speed", {**way.given, **statement}, numbers) for way in ways]
    pairs = [_named(dict(zip(channels, names[:2], strict=True))) for channels in PAIRS_OF_CHANNELS]
    if "time" in quantities:
        return pairs
    return [Answer(f"{pairs[0].label}", {**pairs[0].given, **LOG_AT_RATE.given}, LOG_AT_RATE.numbers), *pairs[1:]]


def is_frequency_response(table: OpenTable) -> bool:
    """True if a column is a frequency and another one a magnitude, a gain or a phase."""
    words = {word for label in table.labels for word in words_of(label.name)}
    return bool(words & FREQUENCY_WORDS and words & RESPONSE_WORDS)


def motions(names: Sequence[str]) -> list[Answer]:
    """Return the answers to which of some columns is a motion."""
    return _each(names, MOTIONS_IN_WORDS)


def _each(names: Sequence[str], channels: Mapping[str, str]) -> list[Answer]:
    return [_named({channel: name}) for name in names[:MAX_OFFERED] for channel in channels]


def _named(columns: dict[str, str]) -> Answer:
    words = {**EFFORTS_IN_WORDS, **MOTIONS_IN_WORDS, "torque": "the torque"}
    return Answer(", ".join(f"{one_line(name)} is {words[channel]}" for channel, name in columns.items()), {"columns": columns})
