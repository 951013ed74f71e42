"""What a file of measurements seems to be, and why: its kind, the channel in each column, side, units and time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import ArrayTable
from strainwave.files.recording import Recording
from strainwave.files.tables import OpenTable
from strainwave.identification.kinds import kind_named
from strainwave.identification.reading.channels import ALIASES, CHANNELS
from strainwave.identification.reading.clock import Clock, clock, regular
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.columns import chosen, moving_joints
from strainwave.identification.reading.held import renewed_rows
from strainwave.identification.reading.kinds import kind_of
from strainwave.identification.reading.mapping import CONSTANTS, FileMapping
from strainwave.identification.reading.missing_units import other_units
from strainwave.identification.reading.name_of_file import joint_in, speed_in
from strainwave.identification.reading.names import Side, meaning, which_of, words_of
from strainwave.identification.reading.sides import UndecidedError
from strainwave.identification.reading.source import MeasurementFile, beside, measurement_file
from strainwave.identification.reading.values import read
from strainwave.identification.reading.wraps import unwrapped
from strainwave.messages import listed, one_line, quoted

Array = NDArray[np.float64]

MOVES = 0.02  # rad: another joint that moves by less rests
RATES = ("fs", "rate", "sample_rate", "samplerate", "sampling_rate", "samplingrate", "sampling_frequency", "f_s", "freq")  # Hz
STEPS = ("ts", "dt", "t_s", "sample_time", "sampletime", "sampling_time", "delta_t", "period")  # s


@dataclass(frozen=True)
class Recognised:
    """What a file seems to be.

    Args:
        path: the file
        kind: `friction`, `torsion`, `log`, `encoders` (two angles) or `effort` (torque or current alone, or at one speed)
        columns: the name in the file of each channel
        units: the unit of each channel in the file, stated there, given or assumed
        side: where it was measured, if at one side
        why: what tells so, in short sentences
        remarks: what was left out, assumed or put right, in short sentences
        constants: numbers that a person gave with it
        recording: the channels in SI units, with the names of `CHANNELS`
        neighbours: the columns of the recording with the angles of other joints that move, by what the file calls the joints
        regressors: the columns of the recording with torques of which shares that are not known act
        joint: what it calls the joint whose recording it is; empty where it says nothing of it
        unused: what it calls the columns that are not used
        began: the stamp in the file from which the time is counted [s]
        alternatives: other ways to read it that its names and numbers leave open; the fit may decide between them
        question: what to ask if the fit does not decide; empty if this reading is the usual one
    """

    path: Path
    kind: str
    columns: Mapping[str, str]
    units: Mapping[str, str]
    side: Side | None
    why: tuple[str, ...]
    remarks: tuple[str, ...]
    constants: Mapping[str, float]
    recording: Recording
    neighbours: Mapping[str, str] = field(default_factory=dict)
    regressors: tuple[str, ...] = ()
    joint: str = ""
    unused: tuple[str, ...] = ()
    began: float = 0.0
    alternatives: tuple[Alternative, ...] = ()
    question: str = ""

    def at_ratio(self, ratio: float) -> Recognised:
        """The same with motions of the motor counted at the input, if the file has them divided by the ratio."""
        recording = self.recording
        names = [name for name in REFLECTED if name in recording]
        if not names:
            return self
        kept = {name: recording[name] for name in recording.names if name not in names}
        moved = {REFLECTED[name]: ratio * recording[name] for name in names}
        units = {REFLECTED.get(name, name): recording.unit(name) for name in recording.names}
        return replace(self, recording=Recording(kept | moved, units, recording.title))


REFLECTED = {"reflected_angle": "input_angle", "reflected_speed": "input_speed"}  # divided by the ratio, and not


@dataclass(frozen=True)
class Alternative:
    """Another way to read a file.

    Args:
        mapping: with which `recognise` reads it so
        reason: the difference, in words
        options: the difference on the command line
    """

    mapping: FileMapping
    reason: str
    options: str


def recognise(file: str | Path | MeasurementFile, mapping: FileMapping | None = None) -> Recognised:
    """Reads a file of measurements, and tells what it seems to be.

    Args:
        file: of any of the formats of `Recording.read`; a `MeasurementFile` is opened once, however often it is read
        mapping: what a person says of it

    Raises:
        ValueError: the file cannot be read, or what it is cannot be told; says which option settles it

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "table.csv")
    ...     _ = path.write_text("Drehzahl [1/min];Reibmoment [mNm]\\n600;41,2\\n-600;-40,9\\n1200;50,1\\n")
    ...     found = recognise(path)
    >>> found.kind, found.side, found.recording
    ('friction', 'input', <Recording: 3 samples; speed [rad/s], torque [N.m]>)
    >>> print(*found.why, sep="\\n")
    its columns are Drehzahl and Reibmoment, 3 rows in no order of time: a table of steady friction
    it reaches 1200 1/min, so it was measured at the input
    """
    source = measurement_file(file)
    said = mapping or FileMapping()
    try:
        return _recognised(source, said)
    except UndecidedError as undecided:
        if not undecided.ways:
            further = _further(source, said, undecided)
            raise ValueError(one_line(f"{source.table.file}: {undecided}{further}")) from None
        first, *others = (said.updated(way) for way in undecided.ways)
        found = _recognised(source, first)
        ways = [Alternative(other, f"measured at the {other.side}", f"--side {other.side}") for other in others]
        of_others = [
            Alternative(each.mapping, f"{way.reason}, {each.reason}", f"{way.options} {each.options}")
            for way in ways
            for each in _recognised(source, way.mapping).alternatives
        ]
        assumed = f"no name or number determines the side: {first.side} is taken; {ways[0].options} says another one"
        own = [replace(each, options=f"--side {first.side} {each.options}") for each in found.alternatives]
        return replace(
            found,
            alternatives=(*own, *ways, *of_others),
            question=one_line(str(undecided)),
            remarks=(assumed, *found.remarks),
        )


def _recognised(source: MeasurementFile, said: FileMapping) -> Recognised:
    table = source.table
    said, remarks = _with_single_numbers(table, said)
    said, told = _with_joint(source, said)
    remarks += told
    if source.parts:
        remarks.insert(0, f"one recording in files of one quantity each: {listed(part.path.name for part in source.parts)}")
    _check_named_effort(source, said)
    columns, decided = chosen(table, said)
    columns, more = read(table, columns, said)
    if said.joint is not None and not any(column.which for column in columns):
        remarks.append(f"its columns name no joint: they are taken for those of joint {said.joint}")
    remarks += [*decided, *more]
    said, by_name = _with_speed_of_name(columns, said, source.path)
    try:
        found = kind_of([column for column in columns if column.own], said)
    except UndecidedError as undecided:
        left = "".join(f"; {remark}" for remark in (*table.left_out, *_of_unused(_unused(table, columns))))
        is_complete = undecided.ways or undecided.options
        raise UndecidedError(f"{undecided}{'' if is_complete else left}", undecided.ways, undecided.options) from None
    remarks += found.remarks
    alternatives = _other_units(columns, found.columns, said)
    series = {name: said.sign.get(name, 1) * column.si for name, column in found.columns.items()}
    neighbours = _neighbours(columns) if found.kind == "log" else {}
    regressors = {f"regressor {column.name}": column for column in columns if column.regressor}
    series |= {name: column.si for name, column in (neighbours | regressors).items()}
    used = {**found.columns, **neighbours, **regressors}
    remarks += _unwrap(table, series, used)
    began = 0.0
    if kind_named(found.kind).time != "none":
        try:
            series, slower = _without_held(series, found.columns, found.kind)
            remarks += slower
            when = _clock(series, said, found.kind)
        except ValueError as error:
            raise ValueError(one_line(f"{table.file}: {error}")) from None
        if when is not None:
            remarks += when.remarks
            began = when.began
            series = {"time": when.time} | {name: values[when.rows] for name, values in series.items() if name != "time"}
    unused = _unused(table, used.values())
    return Recognised(
        source.path,
        found.kind,
        {name: column.name for name, column in found.columns.items()},
        {name: column.unit or "1" for name, column in found.columns.items()},
        found.side,
        (*found.why, *by_name),
        (*remarks, *_of_unused(unused)),
        dict(said.constants),
        Recording(series, {name: used[name].si_unit if name in used else "s" for name in series}, table.title),
        {column.which: name for name, column in neighbours.items()},
        tuple(regressors),
        _joint_of(found.columns, source.path),
        unused,
        began,
        alternatives,
    )


def joints_of(file: str | Path | MeasurementFile, mapping: FileMapping | None = None) -> tuple[str, ...]:
    """The joints that move in a file, by what it calls them; the one in its name if its columns name none; else none.

    Args:
        file, mapping: as of `recognise`

    Raises:
        ValueError: the file cannot be read
    """
    source, said = measurement_file(file), mapping or FileMapping()
    moving = moving_joints(source.table, said)
    named = joint_in(source.path)
    if named and (named in moving or not moving):
        return (named,)
    return tuple(moving)


def check_one_joint(files: Sequence[Recognised]) -> None:
    """Refuse files of several joints, as each joint has a gear of its own.

    Raises:
        ValueError: the names of files or columns contain several numbers of joints
    """
    joints = dict[str, str]()
    for file in files:
        if file.joint.isdigit():
            joints.setdefault(file.joint, file.path.name)
    if len(joints) > 1:
        which = listed(f"{name} of joint {joint}" for joint, name in joints.items())
        raise ValueError(one_line(f"each joint has a gear of its own, but {which}: add --joint {min(joints)}, or --joint all"))


def _joint_of(columns: Mapping[str, Column], path: Path) -> str:
    """The joint by the name of its column, or by that of the file."""
    angle = next((columns[name] for name in ("output_angle", "angle", "input_angle") if name in columns), None)
    return (angle.which if angle is not None else "") or joint_in(path)


def _with_joint(source: MeasurementFile, said: FileMapping) -> tuple[FileMapping, list[str]]:
    """What is said of a file, with the joint that its name contains, or that alone moves; and what determines it."""
    moving = moving_joints(source.table, said)
    named = joint_in(source.path)
    if said.joint is not None and named and not _is_joint(said.joint, named) and not moving_joints(source.table, FileMapping()):
        raise ValueError(one_line(f"{source.table.file}: by its name it is of joint {named}, and not of joint {said.joint}"))
    if named in moving and len(moving) > 1:
        others = listed(joint for joint in moving if joint != named)
        remark = f"joint {named} is taken, which its name contains, while {others} move too; --joint says another one"
        return replace(said, joint=named), [remark]
    if len(moving) == 1:
        remark = f"joint {moving[0]} alone moves, and is taken; --joint says another one"
        return replace(said, joint=moving[0]), [remark]
    return said, []


def _is_joint(said: str, named: str) -> bool:
    return (which_of(words_of(said)) or said) == named


def _check_named_effort(source: MeasurementFile, said: FileMapping) -> None:
    """Ask for the torque or current of columns without names, whose layout contains the motion alone.

    Raises:
        UndecidedError: no one named it; says how to
    """
    named = {CHANNELS[ALIASES.get(name, name)].quantity for name in said.columns}
    if source.is_of_one_quantity and not source.parts and (others := beside(source.path)):
        paths = " ".join(str(other) for other in (source.path, *others))
        raise UndecidedError(f"it has one quantity of a recording; name its files together: {paths}")
    layout = source.layout
    if layout is None or not layout.efforts or named & {"torque", "current", "voltage"}:
        return
    is_timed = "rate" in said.constants or any(label.name == "time" for label in source.table.labels)
    question, options = layout.question(is_timed=is_timed, joint=said.joint)
    raise UndecidedError(question, (), options)


def _further(source: MeasurementFile, said: FileMapping, undecided: UndecidedError) -> str:
    """What to add besides an answer, if that leaves further questions."""
    further, asked = "", {undecided.options}
    while undecided.answer is not None:
        said = said.updated(undecided.answer)
        try:
            _recognised(source, said)
        except UndecidedError as next_one:
            if next_one.ways or not next_one.options or next_one.options in asked:
                break
            further += f"; and add {next_one.options}"
            asked.add(next_one.options)
            undecided = next_one
        except ValueError:
            break
        else:
            break
    return further


def _other_units(columns: Sequence[Column], found: Mapping[str, Column], said: FileMapping) -> tuple[Alternative, ...]:
    """Other units of the channels without one, if their numbers fit them as well."""
    names = {column.position: name for name, column in found.items()}
    own = [column for column in columns if column.own and column.position in names]
    ways = []
    for units in other_units(own):
        by_name = {names[place]: unit for place, unit in units.items()}
        options = " ".join(f"--unit {name}={unit}" for name, unit in by_name.items())
        reason = "in " + listed(by_name.values())
        ways.append(Alternative(said.updated(FileMapping(units=by_name)), reason, options))
    return tuple(ways)


def _neighbours(columns: Sequence[Column]) -> dict[str, Column]:
    """The angles of other joints that move, by names for the recording."""
    return {f"angle_of_joint_{column.which}": column for column in columns if column.neighbour and np.ptp(column.si) > MOVES}


def _with_single_numbers(table: OpenTable, said: FileMapping) -> tuple[FileMapping, list[str]]:
    """What is said of a file, with the rate of its rows where a single number in it tells it and no column of time does."""
    singles = dict(table.singles) if isinstance(table, ArrayTable) else {}
    timed = "time" in said.columns or any((found := meaning(label)) and found.quantity == "time" for label in table.labels)
    remarks = []
    if "rate" not in said.constants and not timed:
        for name, value in singles.items():
            rate = _rate(name.rpartition(".")[2].casefold(), value)
            if rate is not None:
                del singles[name]
                said = said.updated(FileMapping(constants={"rate": rate}))
                remarks.append(f"{name} = {value:g} is taken for the rate of its rows: {rate:g} Hz")
                break
    if singles:
        numbers = listed(f"{name} = {value:g}" for name, value in singles.items())
        remarks.append(f"single numbers, not used: {numbers}")
    return said, remarks


def _with_speed_of_name(columns: Sequence[Column], said: FileMapping, path: Path) -> tuple[FileMapping, tuple[str, ...]]:
    """What is said of a file, with the speed that its name says, where nothing in it tells how it moved; and what tells so."""
    known = {column.channel.quantity for column in columns if column.channel.measured}
    told = bool(known & {"time", "speed"} or said.constants.keys() & {"rate", "speed"} or said.kind not in (None, "effort"))
    speed = None if told or not known & {"torque", "current"} else speed_in(path)
    if speed is None:
        return said, ()
    why = f"its name says that it turned at {speed:.4g} rad/s; --constant speed=… says another speed"
    return said.updated(FileMapping(constants={"speed": speed})), (why,)


def _rate(name: str, value: float) -> float | None:
    """Rows in a second that a number of this name says."""
    highest = CONSTANTS["rate"].high
    if name in RATES and 1.0 <= value <= highest:
        return value
    return 1.0 / value if name in STEPS and 1.0 / highest <= value < 1.0 else None


def _unwrap(table: OpenTable, series: dict[str, Array], columns: Mapping[str, Column]) -> Iterator[str]:
    """Lets angles run on that begin anew with each revolution; says which."""
    for name, column in columns.items():
        if column.channel.quantity == "angle":
            try:
                series[name], wraps = unwrapped(series[name])
            except ValueError as error:
                raise ValueError(one_line(f"{table.file} column {quoted(column.name)} {error}")) from None
            if wraps:
                yield f"{column.name} begins anew with each revolution, {wraps} times: it is taken to run on"


def _without_held(series: dict[str, Array], columns: Mapping[str, Column], kind: str) -> tuple[dict[str, Array], list[str]]:
    """The rows in which the angle was renewed, if it is held for several; and what was left out."""
    names = [name for name in (*REFLECTED.values(), *REFLECTED, "output_angle") if name in series and name.endswith("angle")]
    for name in names if kind in ("log", "encoders") and "time" in series else ():
        if (found := renewed_rows(series[name])) is not None:
            rows, held = found
            rate = (len(rows) - 1) / max(float(series["time"][rows[-1]] - series["time"][rows[0]]), 1e-300)
            said = f"{columns[name].name} holds each value for {held} rows: it was sampled at {rate:.3g} Hz"
            return {each: values[rows] for each, values in series.items()}, [f"{said}, and the {len(rows)} rows are kept"]
    return series, []


def _clock(series: Mapping[str, Array], said: FileMapping, kind: str) -> Clock | None:
    """The time of the rows; none where nothing tells it and nothing needs it."""
    count = len(next(iter(series.values())))
    if "time" in series:
        others = [values for name, values in series.items() if name != "time"]
        repeated = np.zeros(count, bool)
        repeated[1:] = np.all([np.diff(values) == 0.0 for values in others], axis=0)
        angle = next((values for name, values in series.items() if name in ("input_angle", "output_angle", "angle")), None)
        return clock(series["time"], repeated, angle)
    if "rate" in said.constants:
        return regular(count, said.constants["rate"])
    if kind_named(kind).time == "needed":
        raise ValueError("it has no time; give the rate of its rows, with --constant rate=HZ")
    return None


def _unused(table: OpenTable, columns: Iterable[Column]) -> tuple[str, ...]:
    """What a file calls the columns that are not among these."""
    used = {column.position for column in columns}
    return tuple(label.text for place, label in enumerate(table.labels) if place not in used and label.name)


def _of_unused(names: Sequence[str]) -> list[str]:
    return [f"columns not used: {listed(names)}"] if names else []
