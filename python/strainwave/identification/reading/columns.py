"""The columns of a file that seem to measure something, and which of several are taken."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import compress

from strainwave.files.labels import places_of
from strainwave.files.table_format import OpenTable
from strainwave.files.units import measures
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import (
    CHANNEL_ALIASES,
    CHANNELS,
    QUANTITIES,
    UNUSED,
    Channel,
    Meaning,
    is_of_joint,
    meaning,
    meaning_by_unit,
    unit_in,
    which_of,
    words_of,
)
from strainwave.identification.reading.roles import Column, columns_for
from strainwave.messages import listed, one_line, quoted
from strainwave.questions import ALL_JOINTS, Answer, QuestionError

MAX_JOINTS_OFFERED = 8  # by a question: more than an arm has are a humanoid's
LISTED_CHANNELS = ("other_angles", "regressors")  # channels that may be several columns
EITHER_QUANTITY = (("angle", "speed"), ("torque", "current", "voltage"))  # quantities of which a joint needs one
MEASURED_WORDS = {"act", "actual", "meas", "measured", "ist", "istwert", "msr"}  # words of what was measured
EFFORT_KINDS = ("torque", "current")  # quantities
USUAL_FIRST = ("time", "temperature", "vibration")  # of which the first column is taken, if a file has several
CURRENT_WORDS, TORQUE_WORDS = set(QUANTITIES["current"]), set(QUANTITIES["torque"])


def chosen(table: OpenTable, mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """Return the columns with a meaning, one for each channel: those that a person named, and those with a known name.

    If a person gives the rate of the rows, a column of time is taken only if the person names it.

    Returns:
        the columns, and what was decided between duplicates
    """
    by_user = _by_user(table, mapping)
    named = by_name(table, mapping, by_user)
    times = [column for column in named if column.channel.quantity == "time"]
    time = next((column for column in times if not column.which), times[0] if times else None)
    named = [replace(each, which="") if each is time else each for each in named if each not in times or each is time]
    own, remarks = _one_effort(named if mapping.joint is not None else _beside(by_user, named))
    columns = by_user + _of_one_joint(table, own, mapping, by_user)
    is_stated = any(column.channel.quantity in EFFORT_KINDS for column in by_user)
    names = set[str]() if is_stated else {column.name for column in columns}
    return columns, [remark for name, remark in remarks.items() if name in names]


# ---- By their names --------------------------------------------------------------------------------------------------


def by_name(table: OpenTable, mapping: FileMapping, by_user: Sequence[Column] = ()) -> list[Column]:
    """Return the columns with a known name, but for channels that a person named."""
    taken = {column.position for column in by_user} | _unused_places(table, mapping)
    columns = []
    for position, (label, content, named) in enumerate(
        zip(table.labels, table.contents, _meanings(table, mapping), strict=True)
    ):
        if content == "other" or position in taken:
            continue
        is_time = named is not None and named.quantity == "time"
        if named is None or (content == "dates" and not is_time) or (is_time and "rate" in mapping.constants):
            continue
        sided = named.quantity in ("angle", "speed", "torque") and not named.commanded
        channel = Channel(named.quantity, named.side if sided else None, named.commanded)
        if not any(column.channel == channel and column.own for column in by_user):
            unit = "s" if content == "dates" else named.unit or label.unit or None
            columns.append(Column(position, label, channel, named.which, named.robot, unit=unit, estimated=named.estimated))
    columns = _of_measured_structure(columns)
    certain = {(column.channel, column.which) for column in columns if not column.estimated}
    return _numbered_apart([each for each in columns if not each.estimated or (each.channel, each.which) not in certain])


def _meanings(table: OpenTable, mapping: FileMapping) -> list[Meaning | None]:
    """Return the meaning of each column; by its unit alone only if no other column has a measurement of that quantity."""
    labels = [label._replace(unit=None) if label.name in mapping.units else label for label in table.labels]
    meanings = [meaning(label) for label in labels]
    named = {each.quantity for each in meanings if each is not None and not each.commanded}
    by_unit = [meaning_by_unit(label) if own is None else None for label, own in zip(labels, meanings, strict=True)]
    return [
        own or (other if other and other.quantity not in named else None) for own, other in zip(meanings, by_unit, strict=True)
    ]


def _of_measured_structure(columns: Sequence[Column]) -> list[Column]:
    """Return the columns; of a channel in several structures those of the ones with measured values, as `rec.act_pos`."""
    structures = [re.sub(r"\d+", "", column.name.rpartition(".")[0]) for column in columns]
    pairs = list(zip(columns, structures, strict=True))
    measured = {structure for column, structure in pairs if set(words_of(column.name)) & MEASURED_WORDS}
    channels = {column.channel for column, structure in pairs if structure in measured}
    return [column for column, structure in pairs if structure in measured or column.channel not in channels]


def _numbered_apart(columns: Sequence[Column]) -> list[Column]:
    """Return the columns without the numbers in their names that all of one channel have: of the robot, and of no joint."""
    groups, differs = dict[Channel, list[list[str]]](), dict[Channel, list[bool]]()
    for column in columns:
        groups.setdefault(column.channel, []).append(column.which.split("."))
    for channel, group in groups.items():
        is_even = len(group) > 1 and all(len(each) == len(group[0]) and "".join(each).isdigit() for each in group)
        differs[channel] = [len(set(each)) > 1 for each in zip(*group, strict=True)] if is_even else []
    own = [compress(column.which.split("."), differs[column.channel]) for column in columns]
    return [replace(column, which=".".join(each) or column.which) for column, each in zip(columns, own, strict=True)]


def _beside(by_user: Sequence[Column], named: Sequence[Column]) -> list[Column]:
    """Return the named columns, without those of several joints whose channel or a like one a person named."""
    taken = {group for group in EITHER_QUANTITY for column in by_user if column.channel.quantity in group and column.own}
    quantities = {quantity for group in taken for quantity in group}
    channels = [column.channel for column in named]
    return [each for each in named if each.channel.quantity not in quantities or channels.count(each.channel) == 1]


def _one_effort(columns: Sequence[Column]) -> tuple[list[Column], dict[str, str]]:
    """Return the columns with one torque or current of each joint, if several are duplicates; and remarks, by the one taken.

    The torque of the motor contains the friction of the gear, that of a sensor behind the gear does not. So a torque from the
    current goes before a current, and this before any other torque.
    """
    efforts = [each for each in columns if each.channel.quantity in EFFORT_KINDS and each.channel.measured]
    efforts = [each for each in efforts if each.channel.side is None and each.own and not each.by_user]
    taken, remarks = list(columns), dict[str, str]()
    for joint in dict.fromkeys(column.which for column in efforts):
        several = [column for column in efforts if column.which == joint]
        words = {column.position: set(words_of(column.name)) for column in several}
        from_current = [
            each for each in several if words[each.position] & CURRENT_WORDS and words[each.position] & TORQUE_WORDS
        ]
        others = [column for column in several if column not in from_current]
        currents = [column for column in others if column.channel.quantity == "current"]
        first = from_current if from_current and others else currents if len(others) - len(currents) > 1 else []
        if len(first) != 1:
            continue
        (best,) = first
        as_torque = best in from_current and (best.unit is None or measures(best.unit, "N.m"))
        kept = replace(best, channel=best.channel._replace(quantity="torque")) if as_torque else best
        taken = [kept if column is best else column for column in taken if column is best or column not in several]
        what = "is the motor's torque from its current" if best in from_current else "is the current of the motor"
        instead = f"--column joint_torque=NAME takes another one of {listed(each.name for each in several if each is not best)}"
        remarks[best.name] = f"{best.name} {what}, which contains the friction, and is taken; {instead}"
    return taken, remarks


# ---- By a person -----------------------------------------------------------------------------------------------------


def _by_user(table: OpenTable, mapping: FileMapping) -> list[Column]:
    """Return the columns that a person named."""
    columns = []
    wanted = [(name, column) for name, column in mapping.columns.items() if name not in (*LISTED_CHANNELS, UNUSED)]
    wanted += [
        (name, each.strip()) for name in LISTED_CHANNELS for each in mapping.columns.get(name, "").split(",") if each.strip()
    ]
    for name, column in wanted:
        place, channel = _place_of(table, name, column, mapping.joint), CHANNELS[CHANNEL_ALIASES.get(name, name)]
        label, by_name = table.labels[place], meaning(table.labels[place])
        by_name_unit = by_name.unit if by_name and by_name.quantity == channel.quantity else None
        unit = label.unit or by_name_unit or unit_in(label.name, channel.quantity)
        unit = "s" if table.contents[place] == "dates" else unit
        if name == "regressors":  # of one, any unit is that of torque over that of its share
            columns.append(Column(place, label, channel, by_user=True, regressor=True, unit=channel.unit))
            continue
        neighbour = name == "other_angles"
        which = ((by_name.which if by_name else "") or str(place + 1)) if neighbour else ""
        columns.append(Column(place, label, channel, which, by_user=True, neighbour=neighbour, unit=unit))
    sided = {each.position for each in columns if each.channel.quantity == "torque" and each.channel.side}
    return [each for each in columns if each.channel != CHANNELS["torque"] or each.position not in sided]


def _unused_places(table: OpenTable, mapping: FileMapping) -> set[int]:
    """Return the positions of the columns that a person does not want to be used."""
    names = [name.strip() for name in mapping.columns.get(UNUSED, "").split(",")]
    return {_place_of(table, UNUSED, name, mapping.joint) for name in names if name}


def _place_of(table: OpenTable, name: str, column: str, joint: str | None) -> int:
    """Return the position of a column that a person named; raises as `_by_user`."""
    places = places_of(table.labels, column) or _of_joint(table, column, joint)
    names = [table.labels[place].name for place in places]
    joints = [match[1] for each in names if (match := re.search(r"(\d+)\]?$", each))]
    if len(places) > 1 and joint is None and len(set(joints)) == len(places):
        raise which_joint(f"it has {quoted(column)} of {len(joints)} joints", joints)
    if len(places) != 1:
        fault = f"has {len(places)} columns" if places else "has no column"
        there = listed(label.name for label in table.labels)
        raise ValueError(one_line(f"{table.file} {fault} {quoted(column)} to be the {name}; it has {there}"))
    return places[0]


def _of_joint(table: OpenTable, wanted: str, joint: str | None) -> list[int]:
    """Return the places of columns of a joint by the begin of their name, as `Cur` for `Cur4`; of all joints if None."""
    places = [place for place, label in enumerate(table.labels) if is_of_joint(label.name, wanted, joint)]
    return places if joint is not None or len(places) > 1 else []


# ---- One for each channel --------------------------------------------------------------------------------------------


def _of_one_joint(table: OpenTable, columns: Sequence[Column], mapping: FileMapping, by_user: Sequence[Column]) -> list[Column]:
    """Return one column for each channel: those of the joint that is asked for, or the one whose name has no further word.

    If no name contains a joint, they are those of the one that is asked for. Columns that a person named are not among them.
    """
    groups: dict[Channel, list[Column]] = {}
    for column in columns:
        groups.setdefault(column.channel, []).append(column)
    several = [group for group in groups.values() if len(group) > 1]
    joints = list(dict.fromkeys(column.which for group in several for column in group if column.which))
    which_joints = joints or list(dict.fromkeys(column.which for column in columns if column.which))
    if mapping.joint is not None and which_joints:
        joint = mapping.joint if mapping.joint in which_joints else which_of(words_of(mapping.joint))  # J3 is joint 3
        if joint not in {*which_joints, *(which_of(words_of(column.label.name)) for column in by_user)}:
            raise ValueError(one_line(f"{table.file} has no joint {quoted(mapping.joint)}; it has {listed(which_joints)}"))
        return _with_neighbours(columns, joint, which_joints)
    quantities = {column.channel.quantity for column in columns} - set(USUAL_FIRST)
    if len(several) == 1 and len(several[0]) == 2 and quantities == {"angle"}:  # two encoders
        return list(columns)
    return [column for group in groups.values() for column in _taken(group, joints)]


def _with_neighbours(columns: Sequence[Column], joint: str, known: Sequence[str]) -> list[Column]:
    """Return the columns of a joint, and the angles of the others."""
    own = [column for column in columns if column.which in ("", joint) or column.which not in known]
    angle = next((column for column in own if column.channel.quantity == "angle" and column.which == joint), None)
    of_others = [column for column in columns if column.which in known and column.which != joint]
    neighbours = [column for column in of_others if angle is not None and column.channel == angle.channel]
    return [
        *(replace(each, robot=each.robot or (len(known) > 1 and each.which == joint)) for each in own),
        *(replace(each, neighbour=True) for each in neighbours),
    ]


def _taken(group: Sequence[Column], joints: Sequence[str]) -> Sequence[Column]:
    """Return the column of a channel that is taken; two, if their sizes show which is that of the input."""
    plain = [column for column in group if not column.which] if len(group) > 1 else group
    channel = group[0].channel
    if len(plain) == 2 and channel.quantity in ("angle", "speed") and channel.side is None and channel.measured:
        return plain
    if plain and channel.quantity in USUAL_FIRST:
        return plain[:1]
    if len(plain) == 1:
        return plain
    name = "command" if channel.commanded else "_".join(filter(None, (channel.side, channel.quantity)))
    side = "output" if channel.side == "output" or group[0].robot or len(joints) > 1 else "input"
    wanted = {"output_torque": "joint_torque", "angle": f"{side}_angle", "speed": f"{side}_speed"}.get(name, name)
    names = [column.name for column in group]
    if len({column.which for column in group}) == len(group) and len(joints) > 1:
        some = listed(names[:2]) + (" …" if len(names) > 2 else "")
        raise which_joint(f"it has {len(joints)} joints ({listed(joints)}), as {some}", joints)
    raise QuestionError(f"each of {listed(names)} may be the {name}", columns_for(wanted, group))


def which_joint(question: str, joints: Sequence[str]) -> QuestionError:
    """Return the question which joint is meant."""
    ways = [Answer(f"joint {joint}", {"joint": joint}) for joint in joints[:MAX_JOINTS_OFFERED]]
    return QuestionError(question, [*ways, Answer("each joint, with a gear of its own", {"joint": ALL_JOINTS})])
