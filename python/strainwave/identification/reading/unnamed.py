"""Columns whose names mean nothing, but whose numbers may be measured: what a person is asked to name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import ColumnSource
from strainwave.files.table_format import OpenTable
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.layout import rises_evenly
from strainwave.identification.reading.names import words_of
from strainwave.messages import MAX_TEXT, one_line
from strainwave.questions import LOG_AT_RATE, Answer

Array = NDArray[np.float64]

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
        given, numbers = CONSTANT_SPEED
        ways = [_named({channel: names[0]}) for channel in EFFORTS_IN_WORDS]
        return [Answer(f"{way.label}, at one speed", {**way.given, **given}, numbers) for way in ways]
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
