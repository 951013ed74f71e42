"""The columns of a file that seem to measure something: which of several are taken, and their values in SI units."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Source, places_of
from strainwave.files.tables import OpenTable
from strainwave.files.units import convert, counts, is_share, measures
from strainwave.identification.reading.channels import ALIASES, CHANNELS, Channel
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.layout import nameless
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.missing_units import Assumed, counts_of_revolution, missing_units
from strainwave.identification.reading.names import QUANTITIES, UNITS, meaning, which_of, words_of
from strainwave.identification.reading.sides import UndecidedError
from strainwave.messages import as_option, listed, one_line, quoted

Array = NDArray[np.float64]


FEW = 4  # names that are listed where none says anything
STILL = 0.01  # of how far a joint moves, by which others move less that rest
SEVERAL = ("other_angles", "regressors")  # as what a person names several columns
ALIKE = (("angle", "speed"), ("torque", "current", "voltage"))  # of which a person names what is needed of one joint
MEASURED = {"act", "actual", "meas", "measured", "ist", "istwert", "msr"}  # words of what was measured
CURRENT, TORQUE = set(QUANTITIES["current"]), set(QUANTITIES["torque"])
MIN_COUNTS = 1000  # range of whole numbers that are counts of an encoder
MIN_STEPS, MIN_SAMPLES = 20, 100  # range and rows of whole numbers that are shares of a rated torque
MIN_WHOLE = 0.5  # of the rows of the slowest channel: with fewer whole rows the channels were sampled at other instants
FIRST = ("time", "temperature")  # of which the first column is taken, where a file has several


def chosen(table: OpenTable, mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """The columns that mean something, one for each channel: those that a person named, and those whose names tell.

    Where a person says the rate of the rows, a column of time is taken only if the person names it.

    Returns:
        the columns, and what was decided between duplicates
    """
    said = _said(table, mapping)
    told = _of_one_time(_told(table, mapping, said))
    own, remarks = one_effort(told if mapping.joint is not None else _beside(said, told))
    found = said + _of_one_joint(table, own, mapping)
    names = {column.name for column in found}
    return found, [remark for name, remark in remarks if name in names]


def _beside(said: Sequence[Column], told: Sequence[Column]) -> list[Column]:
    """Those columns that stand beside what a person named, without several joints that move, or tell a torque, as that does."""
    named = {place for place, group in enumerate(ALIKE) for column in said if column.channel.quantity in group and column.own}
    return [
        column
        for column in told
        if not any(
            place in named and column.channel.quantity in group and sum(each.channel == column.channel for each in told) > 1
            for place, group in enumerate(ALIKE)
        )
    ]


def _told(table: OpenTable, mapping: FileMapping, said: Sequence[Column] = ()) -> list[Column]:
    """The columns whose names tell, but for channels that a person named."""
    taken = {column.position for column in said}
    told = []
    for position, (label, content) in enumerate(zip(table.labels, table.contents, strict=True)):
        if content == "other" or position in taken:
            continue
        found = meaning(label._replace(unit=None) if label.name in mapping.units else label)
        if found is None or (content == "dates" and found.quantity != "time"):
            continue
        if found.quantity == "time" and "rate" in mapping.constants:
            continue
        sided = found.quantity in ("angle", "speed", "torque") and not found.commanded
        channel = Channel(found.quantity, found.side if sided else None, found.commanded)
        if not any(column.channel == channel and column.own for column in said):
            unit = "s" if content == "dates" else found.unit or label.unit or None
            told.append(Column(position, label, channel, found.which, found.robot, unit=unit, estimated=found.estimated))
    return _numbered_apart(_without_estimates(_of_measured_structure(told)))


def _of_measured_structure(columns: Sequence[Column]) -> list[Column]:
    """The columns; of a channel in several structures those of the ones with names for what was measured, as `rec.act_pos`."""
    measured = {_structure(column) for column in columns if set(words_of(column.name)) & MEASURED}
    channels = {column.channel for column in columns if _structure(column) in measured}
    return [column for column in columns if _structure(column) in measured or column.channel not in channels]


def _structure(column: Column) -> str:
    return re.sub(r"\d+", "", column.name.rpartition(".")[0])


def _without_estimates(columns: Sequence[Column]) -> list[Column]:
    """The columns without estimates of what another one contains."""
    own = {(column.channel, column.which) for column in columns if not column.estimated}
    return [column for column in columns if not column.estimated or (column.channel, column.which) not in own]


def one_effort(columns: Sequence[Column]) -> tuple[list[Column], list[tuple[str, str]]]:
    """The columns with one torque or current of each joint where several are duplicates; and for each what was decided.

    The torque of the motor shows the friction of the gear, that of a sensor behind the gear does not. So a torque from the
    current goes before a current, and this before any other torque.
    """
    efforts = [column for column in columns if _is_effort(column)]
    joints = dict.fromkeys(column.which for column in efforts)
    taken, remarks = list(columns), list[tuple[str, str]]()
    for joint in joints:
        several = [column for column in efforts if column.which == joint]
        from_current = [column for column in several if _words(column) & CURRENT and _words(column) & TORQUE]
        currents = [column for column in several if column.channel.quantity == "current" and column not in from_current]
        torques = [column for column in several if column.channel.quantity == "torque" and column not in from_current]
        first = from_current if from_current and (currents or torques) else currents if len(torques) > 1 else []
        if len(first) != 1:
            continue
        (best,) = first
        as_torque = best in from_current and (best.unit is None or measures(best.unit, "N.m"))
        kept = replace(best, channel=best.channel._replace(quantity="torque")) if as_torque else best
        taken = [kept if column is best else column for column in taken if column is best or column not in several]
        others = listed(column.name for column in several if column is not best)
        what = "is the motor's torque from its current" if best in from_current else "is the current of the motor"
        instead = f"--column joint_torque=NAME takes another one of {others}"
        remarks.append((best.name, f"{best.name} {what}, which contains the friction, and is taken; {instead}"))
    return taken, remarks


def _is_effort(column: Column) -> bool:
    is_one = column.channel.quantity in ("torque", "current") and column.channel.measured and column.channel.side is None
    return is_one and column.own and not column.said


def _words(column: Column) -> set[str]:
    return set(words_of(column.name))


def _numbered_apart(columns: Sequence[Column]) -> list[Column]:
    """The columns, without those numbers in their names that all of one channel have: of the robot, and of no joint."""
    groups: dict[Channel, list[list[str]]] = {}
    for column in columns:
        groups.setdefault(column.channel, []).append(column.which.split("."))
    differing = {channel: _differing(group) for channel, group in groups.items()}
    found = []
    for column in columns:
        parts = column.which.split(".")
        own = [parts[place] for place in differing[column.channel]]
        found.append(replace(column, which=".".join(own)) if own else column)
    return found


def _differing(group: Sequence[Sequence[str]]) -> list[int]:
    """Which parts of names of numbers are not the same in all of them; none if the names are not of one form."""
    if len(group) < 2 or not all(len(each) == len(group[0]) and "".join(each).isdigit() for each in group):
        return []
    return [place for place, parts in enumerate(zip(*group, strict=True)) if len(set(parts)) > 1]


def _of_one_time(columns: Sequence[Column]) -> list[Column]:
    """The columns with one time: the first whose name says nothing else, or the first."""
    times = [column for column in columns if column.channel.quantity == "time"]
    taken = next((column for column in times if not column.which), times[0] if times else None)
    return [
        replace(column, which="") if column is taken else column for column in columns if column not in times or column is taken
    ]


def moving_joints(table: OpenTable, mapping: FileMapping) -> list[str]:
    """The joints whose angles change, of a file with several of which a person named none."""
    if mapping.joint is not None or "output_angle" in mapping.columns or "input_angle" in mapping.columns:
        return []
    groups = dict[Channel, dict[str, int]]()
    for column in _told(table, mapping):
        if column.channel.quantity == "angle" and column.channel.measured and column.which:
            angles = groups.setdefault(column.channel, {})
            if column.which in angles:
                return []
            angles[column.which] = column.position
    angles = max(groups.values(), key=len, default={})
    if len(angles) < 2:
        return []
    numbers, _ = table.measured([Source(place, which, which, "1") for which, place in angles.items()])
    finite = {which: values[np.isfinite(values)] for which, values in numbers.items()}
    spans = {which: float(np.ptp(values)) for which, values in finite.items() if values.size}
    least = STILL * max(spans.values(), default=0.0)
    return [which for which, span in spans.items() if span > 0.0 and span >= least]


def _said(table: OpenTable, mapping: FileMapping) -> list[Column]:
    """The columns that a person named."""
    found = []
    each = [(name, wanted) for name, wanted in mapping.columns.items() if name not in SEVERAL]
    for name in SEVERAL:
        each += [(name, wanted.strip()) for wanted in mapping.columns.get(name, "").split(",") if wanted.strip()]
    for name, wanted in each:
        channel = CHANNELS[ALIASES.get(name, name)]
        places = places_of(table.labels, wanted) or _of_joint(table, wanted, mapping.joint)
        if len(places) > 1 and mapping.joint is None and (joints := _numbers_of_joints(table, places)):
            which = f"it holds {len(joints)} joints ({listed(joints)}), as {table.labels[places[0]].name}"
            question = f"{which}; say which with --joint {joints[0]} or --joint all"
            raise UndecidedError(question, (), f"--joint {joints[0]}", FileMapping(joint=joints[0]))
        if len(places) != 1:
            fault = f"has {len(places)} columns" if places else "has no column"
            there = listed(label.name for label in table.labels)
            raise ValueError(one_line(f"{table.file} {fault} {quoted(wanted)} to be the {name}; it has {there}"))
        label = table.labels[places[0]]
        told = meaning(label)
        unit = label.unit or (told.unit if told and told.quantity == channel.quantity else None) or None
        unit = "s" if table.contents[places[0]] == "dates" else unit
        which = (told.which if told else "") or str(places[0] + 1)
        neighbour, regressor = name == "other_angles", name == "regressors"
        unit = channel.unit if name == "regressors" else unit  # of a regressor any unit is that of torque over its share's
        kept = which if neighbour else ""
        found.append(Column(places[0], label, channel, kept, said=True, neighbour=neighbour, regressor=regressor, unit=unit))
    return found


def _numbers_of_joints(table: OpenTable, places: Sequence[int]) -> list[str]:
    """The numbers behind the names of columns that are one for each joint; empty if they are not."""
    found = [match[0] if (match := re.search(r"\d+$", table.labels[place].name)) else "" for place in places]
    return found if all(found) and len(set(found)) == len(found) else []


def _of_joint(table: OpenTable, wanted: str, joint: str | None) -> list[int]:
    """Places of the columns of a joint whose name begins so, as `Cur` for `Cur4` or `block3` for `block3_4`; of all if None."""
    number = r"\d+" if joint is None else f"0*{re.escape(which_of(words_of(joint)) or joint)}"
    name = re.compile(rf"{re.escape(wanted)}[_.]?{number}")
    places = [place for place, label in enumerate(table.labels) if name.fullmatch(label.name)]
    return places if joint is not None or len(places) > 1 else []


def _of_one_joint(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> list[Column]:
    """One column for each channel: those of the joint that is asked for, or the one whose name says nothing else.

    Where no name says a joint, they are those of the one that is asked for.
    """
    groups: dict[Channel, list[Column]] = {}
    for column in columns:
        groups.setdefault(column.channel, []).append(column)
    several = [group for group in groups.values() if len(group) > 1]
    joints = list(dict.fromkeys(column.which for group in several for column in group if column.which))
    known = joints or list(dict.fromkeys(column.which for column in columns if column.which))
    if mapping.joint is not None and known:
        joint = mapping.joint if mapping.joint in known else which_of(words_of(mapping.joint))  # J3 is joint 3
        if joint not in known:
            raise ValueError(one_line(f"{table.file} has no joint {quoted(mapping.joint)}; it has {listed(known)}"))
        several_joints = len(known) > 1
        own = [
            replace(column, robot=column.robot or (several_joints and column.which == joint))
            for column in columns
            if column.which in ("", joint) or column.which not in known
        ]
        angle = next((column for column in own if column.channel.quantity == "angle" and column.which == joint), None)
        return own + [
            replace(column, neighbour=True)
            for column in columns
            if angle is not None and column.which in known and column.which != joint and column.channel == angle.channel
        ]
    if len(several) == 1 and _are_two_encoders(columns, several[0]):
        return list(columns)
    taken = []
    for group in groups.values():
        plain = [column for column in group if not column.which] if len(group) > 1 else group
        if _may_be_of_both_shafts(plain):
            taken += plain
            continue
        if plain and plain[0].channel.quantity in FIRST:
            plain = plain[:1]
        if len(plain) != 1:
            raise _choice(group, joints)
        taken += plain
    return taken


def _may_be_of_both_shafts(group: Sequence[Column]) -> bool:
    """Whether two angles or two speeds may be those of input and output, which their sizes tell."""
    channel = group[0].channel if group else Channel("time")
    return len(group) == 2 and channel.quantity in ("angle", "speed") and channel.side is None and channel.measured


def _are_two_encoders(columns: Sequence[Column], group: Sequence[Column]) -> bool:
    """Whether two angles are those of input and output: nothing else is measured beside them but time."""
    others = {column.channel.quantity for column in columns} - {"time", "temperature"}
    return len(group) == 2 and others == {"angle"}


def _choice(group: Sequence[Column], joints: Sequence[str]) -> UndecidedError:
    """The question which of several columns is meant."""
    channel = group[0].channel
    name = "command" if channel.commanded else "_".join(filter(None, (channel.side, channel.quantity)))
    side = "output" if channel.side == "output" or group[0].robot or len(joints) > 1 else "input"
    wanted = {"output_torque": "joint_torque", "angle": f"{side}_angle", "speed": f"{side}_speed"}.get(name, name)
    option = as_option("column", wanted, group[0].name)
    if len({column.which for column in group}) == len(group) and len(joints) > 1:
        few = listed(column.name for column in group[:2]) + (" …" if len(group) > 2 else "")
        which = f"it holds {len(joints)} joints ({listed(joints)}), as {few}"
        ways = f"--joint {joints[0]} or --joint all, or name columns, as {option}"
        return UndecidedError(f"{which}; say which with {ways}", (), f"--joint {joints[0]}", FileMapping(joint=joints[0]))
    names = listed(column.name for column in group)
    return UndecidedError(f"each of {names} may be the {name}; say which, as with {option}", (), option)


def read(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """The columns with their values in SI units, and what was said of units and left out."""
    if not columns:
        names = [label.text for label in table.labels]
        there = listed(names) if len(names) <= FEW else f"{listed(names[:FEW])} and {len(names) - FEW} more"
        raise ValueError(one_line(f"{table.file}: no name of a column tells what it measures: {there}; {_naming(table)}"))
    sources = [
        Source(column.position, column.name, str(column.position), column.unit or column.channel.unit) for column in columns
    ]
    numbers, left_out = table.measured(sources)
    raw = {column.position: numbers[str(column.position)] for column in columns}
    known, told = _with_units(table, columns, mapping)
    known, counted = _with_counts(known, raw)
    told += counted
    _check_units([column for column in known if column.own], raw)
    try:
        assumed = missing_units([_with_side(column, mapping) for column in known if column.own], raw)
    except ValueError as error:
        raise ValueError(one_line(f"{table.file} {error}")) from None
    known = _as_the_joint(known, assumed)
    if assumed:
        taken = ", ".join(f"{c.name} in {assumed[c.position].told}" for c in known if c.position in assumed)
        told.append(f"no unit is stated: {taken}; --unit NAME=UNIT says another one")
    found = []
    for column in known:
        unit, _, sure, scale = Assumed(column.unit, "", True) if column.unit else assumed[column.position]
        is_open = column.unit is None and not sure
        values = scale * _in_si(table, column, raw[column.position], unit)
        found.append(replace(column, unit=unit, sure=sure, is_open=is_open, values=values))
    remarks = [*left_out, *told]
    empty = [column for column in found if not column.said and not np.isfinite(column.si).any()]
    if empty and len(empty) < len(found):
        remarks.append(f"left out, as no row holds a number: {listed(column.name for column in empty)}")
        found = [column for column in found if column not in empty]
    return _whole_rows(table, found, remarks)


def _naming(table: OpenTable) -> str:
    """How to name columns of which neither names nor numbers determine anything."""
    if len([content for content in table.contents if content == "numbers"]) == 1:
        return "of a record at one constant speed say it, as with --column current=1 --constant speed='20 1/min'"
    names = [label.name for label in table.labels]
    if nameless(table):
        return "say which is which, as with --constant rate=HZ --column output_angle=1 --column joint_torque=2"
    return f"say it, as with {as_option('column', 'speed', names[0])}"


def _with_counts(columns: Sequence[Column], raw: Mapping[int, Array]) -> tuple[list[Column], list[str]]:
    """The columns, with the counts of a revolution where the speed beside an encoder determines them; and which."""
    found = counts_of_revolution(
        [replace(c, unit="counts") if counts(_incomplete_unit(c, raw[c.position])) else c for c in columns], raw
    )
    told = [
        f"a revolution has {found[c.position]} counts of {c.name}, as its speed shows" for c in columns if c.position in found
    ]
    return [replace(c, unit=f"counts/{found[c.position]}") if c.position in found else c for c in columns], told


def _check_units(columns: Sequence[Column], raw: Mapping[int, Array]) -> None:
    """Ask for the numbers that units need and the file does not contain.

    Raises:
        UndecidedError: a unit needs the counts of a revolution, or a rated value
    """
    needs = {column.name: unit for column in columns if (unit := _incomplete_unit(column, raw[column.position]))}
    if needs:
        counted = [name for name, unit in needs.items() if counts(unit)]
        shares = [name for name in needs if name not in counted]
        lacks = [f"how many counts a revolution has in {listed(counted)}"] if counted else []
        lacks += [f"of which rated value {listed(shares)} is a share"] if shares else []
        options = " ".join(as_option("unit", name, unit) for name, unit in needs.items())
        told = f"the file does not contain {' and '.join(lacks)}; add it, as with {options}"
        raise UndecidedError(told, (), options, FileMapping(units=needs))


def _incomplete_unit(column: Column, values: Array) -> str:
    """The unit of a column as it may be with a number that is missing; empty if it is complete."""
    share = f"permille of {'0.4 N.m' if column.channel.quantity == 'torque' else '10 A'}"
    if column.unit is not None:
        if is_share(column.unit):
            return share.replace("permille", "%") if column.unit.strip() in ("%", "percent") else share
        counted = "counts/16384/s" if column.channel.quantity == "speed" else "counts/16384"
        return counted if counts(column.unit) and not measures(column.unit, column.channel.unit) else ""
    there = values[np.isfinite(values)]
    is_whole = len(there) > 1 and bool((there == np.round(there)).all())
    if column.channel.quantity == "angle":
        return "counts/16384" if is_whole and np.ptp(there) > MIN_COUNTS else ""
    is_torque = column.channel.quantity == "torque" and column.channel.measured
    return share if is_torque and is_whole and len(there) > MIN_SAMPLES and np.ptp(there) >= MIN_STEPS else ""


def _with_side(column: Column, mapping: FileMapping) -> Column:
    """The column with the side that a person said of the file, where its name says none."""
    side = column.channel.side or (mapping.side if column.channel.quantity in ("angle", "speed") else None)
    return replace(column, channel=column.channel._replace(side=side))


def _as_the_joint(columns: Sequence[Column], assumed: Mapping[int, Assumed]) -> list[Column]:
    """The columns, with angles of other joints in the unit of the one that is asked for."""
    own = next((c for c in columns if c.own and c.channel.quantity == "angle" and not c.channel.commanded), None)
    unit = UNITS["angle"] if own is None else own.unit or assumed[own.position].unit
    return [replace(c, unit=c.unit or unit) if c.neighbour else c for c in columns]


def _with_units(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> tuple[list[Column], list[str]]:
    """The columns with the units that a person gave, for a channel, a quantity, or by the name in the file."""
    found, remarks = list(columns), []
    for name, unit in mapping.units.items():
        channel = CHANNELS.get(ALIASES.get(name, name))
        places = [place for place, column in enumerate(columns) if column.name == name or _is_called(column, channel)]
        if not places:
            there = listed(column.name for column in columns)
            raise ValueError(one_line(f"{table.file}: a unit is given for {quoted(name)}, which is not read; read are {there}"))
        for place in places:
            stated = found[place].unit
            if stated is not None and stated != unit:
                remarks.append(f"{found[place].name} is stated in {stated}, and taken in {unit}, as was said")
            found[place] = replace(found[place], unit=unit)
    return found, remarks


def _is_called(column: Column, channel: Channel | None) -> bool:
    if channel is None or channel._replace(side=None) != column.channel._replace(side=None):
        return False
    return channel.side is None or column.channel.side in (None, channel.side)


def _in_si(table: OpenTable, column: Column, values: Array, unit: str) -> Array:
    wanted = column.channel.unit
    if column.channel.commanded and measures(unit, "V"):
        wanted = "V"
    there = ~np.isnan(values)
    try:
        found = np.full(len(values), np.nan)
        found[there] = convert(values[there], unit, wanted)
    except ValueError as error:
        what = "command" if column.channel.commanded else column.channel.quantity
        place = f"{table.file} column {quoted(column.name)}"
        hint = as_option("unit", column.name, "counts/16384" if counts(unit) else column.channel.unit)
        remedy = f"give its unit, with {hint}"
        raise ValueError(one_line(f"{place} cannot be the {what}: {error}; {remedy}")) from None
    return found


def _whole_rows(table: OpenTable, columns: Sequence[Column], remarks: list[str]) -> tuple[list[Column], list[str]]:
    """The rows in which each column holds a number; of channels that were sampled at other instants those of the slowest."""
    whole = np.all([np.isfinite(column.si) for column in columns], axis=0)
    if whole.all():
        return list(columns), remarks
    if (resampled := _resampled(columns)) is not None:
        return resampled[0], [*remarks, resampled[1]]
    if not whole.any():
        empty = listed(column.name for column in columns if not np.isfinite(column.si).any()) or "no single column"
        raise ValueError(one_line(f"{table.file}: no row holds a number in each of its columns; all are missing in {empty}"))
    lost = int((~whole).sum())
    rows = "1 row without a number in each column is" if lost == 1 else f"{lost} rows without a number in each column are"
    remarks.append(f"{rows} left out, the first at {table.place(int(np.argmin(whole)))}")
    return [replace(column, values=column.si[whole]) for column in columns], remarks


def _resampled(columns: Sequence[Column]) -> tuple[list[Column], str] | None:
    """The columns at the instants of the slowest of them but for temperatures, by linear interpolation; and what was done.

    None if most rows of this one are whole, or there is no time.
    """
    time = next((column.si for column in columns if column.channel.quantity == "time"), None)
    others = [column for column in columns if column.channel.quantity not in ("time", "temperature")]
    if time is None or not others:
        return None
    stamped = np.isfinite(time)
    there = {column.position: np.isfinite(column.si) & stamped for column in columns}
    slowest = min(others, key=lambda column: int(there[column.position].sum()))
    rows = there[slowest.position].copy()
    whole = np.all(list(there.values()), axis=0)
    if whole.sum() > MIN_WHOLE * rows.sum() or not all(each.sum() > 1 for each in there.values()):
        return None
    for column in others:
        own = time[there[column.position]]
        rows &= (time >= own.min()) & (time <= own.max())
    if not rows.any():
        return None
    found, moved = [], []
    for column in columns:
        finite = there[column.position]
        if (finite & rows).sum() == rows.sum():
            found.append(replace(column, values=column.si[rows]))
            continue
        moved.append(column.name)
        order = np.argsort(time[finite], kind="stable")
        found.append(replace(column, values=np.interp(time[rows], time[finite][order], column.si[finite][order])))
    said = f"rows are of several channels: at the {int(rows.sum())} rows of {slowest.name}"
    return found, f"{said}, {listed(moved)} is taken by linear interpolation"
