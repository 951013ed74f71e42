"""Recognition of a file of measurements: its kind, the channel in each column, side, units and time."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import ColumnSource
from strainwave.files.recording import Recording
from strainwave.files.table_format import OpenTable
from strainwave.files.text_table import CsvTable
from strainwave.identification.kinds import KINDS, kind_named
from strainwave.identification.reading import unnamed
from strainwave.identification.reading.answers import in_usual_way, with_answers_that_work
from strainwave.identification.reading.columns import chosen
from strainwave.identification.reading.joints import with_joint
from strainwave.identification.reading.mapping import CONSTANTS, FileMapping
from strainwave.identification.reading.motion import MAX_OFF_SPEED, jumps, renewed_rows, speed_per_slope, unwrapped
from strainwave.identification.reading.names import (
    CHANNEL_ALIASES,
    CHANNELS,
    UNUSED,
    Side,
    joint_in,
    meaning,
    speed_in,
)
from strainwave.identification.reading.roles import Column, ColumnRoles, names_of
from strainwave.identification.reading.source import MeasurementFile, files_of_same_recording, measurement_file
from strainwave.identification.reading.times import clock, regular
from strainwave.identification.reading.units import other_units
from strainwave.identification.reading.unnamed import interleaved, nameless
from strainwave.identification.reading.values import misspelt_units, values_of
from strainwave.messages import listed, one_line, quoted
from strainwave.presentation import Presented
from strainwave.questions import LOG_AT_RATE, Answer, QuestionError

Array = NDArray[np.float64]

MIN_NEIGHBOUR_MOTION = 0.02  # rad: another joint that moves by less rests
# Hz.
RATE_NAMES = ("fs", "rate", "sample_rate", "samplerate", "sampling_rate", "samplingrate", "sampling_frequency", "f_s", "freq")
STEP_NAMES = ("ts", "dt", "t_s", "sample_time", "sampletime", "sampling_time", "delta_t", "period")  # s
RATIO_NAME = re.compile(r"(?i)((gear|reduction)[\s_]*)?ratio|reduction|(über|unter)setzung")
UNUSED_NUMBERS = "single numbers, not used: "
OF_REFLECTED = {"reflected_angle": "input_angle", "reflected_speed": "input_speed"}  # divided by the ratio, and not


@dataclass(frozen=True)
class Recognised(Presented):
    """A file of measurements as it is read.

    Args:
        path: the file
        kind: of measurement, as of `KINDS`
        columns: the name in the file of each channel
        units: the unit of each channel in the file: stated there, given or assumed
        side: at which it was measured, if that is one
        why: what determines it, in short sentences
        remarks: what was left out, assumed or corrected, in short sentences
        left_out: those of the remarks that list what the file contains and nothing uses
        constants: numbers that a person gave with it
        recording: the channels in SI units, with the names of `CHANNELS`
        neighbours: the columns of the recording with the angles of other joints that move, by the names of these joints
        regressors: the columns of the recording with torques of which unknown shares act
        joint: the joint of the recording by its name in the file; empty if it has none
        texts: names in the file of the columns that are not used, and contain texts
        began: the stamp in the file from which the time is counted [s]
        mapping: what a person, or a choice between readings, states of it
        alternatives: other ways to read it that its names and numbers leave open; the fit may decide between them
        question: what to ask if the fit does not decide; None if this reading is the usual one
        unnamed: names in the file of columns that are not used, but may be measured
        is_of_robot: True if its channels have the names of a robot's joints, whose motions are in radians by convention
        units_given: channels whose unit a person gave, and the file does not contain
        units_assumed: channels whose unit neither the file nor a person states, and no number determines
        parts: all files of a recording that has one for each quantity; empty for a recording in one file
        ratio: of the gear, by a remark or a single number in the file; None if it has none
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
    texts: tuple[str, ...] = ()
    began: float = 0.0
    mapping: FileMapping = field(default_factory=FileMapping)
    alternatives: tuple[Answer, ...] = ()
    question: QuestionError | None = None
    unnamed: tuple[str, ...] = ()
    is_of_robot: bool = False
    units_given: tuple[str, ...] = ()
    units_assumed: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    parts: tuple[Path, ...] = ()
    ratio: float | None = None

    @property
    def temperature(self) -> float:
        """Mean temperature of the file, or as given with it [K]; not a number if unknown."""
        if "temperature" in self.recording:
            return float(np.mean(self.recording.values("temperature", "K")))
        return self.constants.get("temperature", np.nan)

    def at_ratio(self, ratio: float) -> Recognised:
        """Return the same with motions of the motor counted at the input, if the file has them divided by the ratio."""
        recording = self.recording
        if not OF_REFLECTED.keys() & set(recording.names):
            return self
        names = sorted(recording.names, key=lambda name: name in OF_REFLECTED)
        series = {OF_REFLECTED.get(name, name): recording[name] * (ratio if name in OF_REFLECTED else 1.0) for name in names}
        units = {OF_REFLECTED.get(name, name): recording.unit(name) for name in names}
        return replace(self, recording=Recording(series, units, recording.title))


def recognise(file: str | Path | MeasurementFile, mapping: FileMapping | None = None) -> Recognised:
    """Return a file of measurements as it is read, by its names and numbers.

    Args:
        file: of any of the formats of `Recording.read`; a `MeasurementFile` is opened once, however often it is read
        mapping: what a person states of it

    Raises:
        QuestionError: the file leaves open what it is; each answer was tried, and leads to a measurement or another question
        ValueError: the file cannot be read

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
    source, stated = measurement_file(file), mapping or FileMapping()
    read = partial(_as_stated, source)
    try:
        recognised = in_usual_way(read, stated)
        if recognised.kind == "effort" and (question := misspelt_units(source.table, stated)):
            raise question
        return recognised
    except QuestionError as question:
        misspelt = misspelt_units(source.table, stated)
        raise with_answers_that_work(source, stated, misspelt or question, read) from None


def _as_stated(source: MeasurementFile, stated: FileMapping) -> Recognised:
    """Return a file as it is read: columns, their values in SI units, their roles, the recording; raises as `recognise`."""
    table = source.table
    mapping, of_numbers, ratio = _with_single_numbers(table, stated)
    mapping, of_joint = with_joint(source, mapping)
    _check_parts(source)
    _check_named_effort(source, mapping)

    columns, of_efforts = chosen(table, mapping)
    columns, of_values = values_of(table, columns, mapping)
    mapping, by_file_name = _with_speed_of_name(columns, mapping, source.path)
    roles = _roles_or_question(table, columns, mapping)
    is_log = roles.kind == "log"
    moving = [each for each in columns if each.neighbour and is_log and np.ptp(each.si) > MIN_NEIGHBOUR_MOTION]
    neighbours = {f"angle_of_joint_{column.which}": column for column in moving}
    regressors = {f"regressor {column.name}": column for column in columns if column.regressor}
    used = {**roles.columns, **neighbours, **regressors}

    series = {name: column.si * (mapping.sign.get(name, 1) if column.own else 1) for name, column in used.items()}
    of_wraps = list(_unwrap(table, series, used))
    try:
        series, of_time, began = _in_time(series, roles.columns, roles.kind, mapping)
    except QuestionError:
        raise
    except ValueError as error:
        raise ValueError(one_line(f"{table.file}: {error}")) from None

    parts = source.parts if source.run is None else ()
    remarks = [f"one recording in files of one quantity each: {listed(part.path.name for part in parts)}"] if parts else []
    remarks += [*of_numbers, *of_joint]
    if mapping.joint is not None and not any(column.which for column in columns):
        remarks.append(f"its columns name no joint: they are taken for those of joint {mapping.joint}")
    unused = _unused(table, list(used.values()))
    angle = next((roles.columns[name] for name in ("output_angle", "angle", "input_angle") if name in roles.columns), None)
    return Recognised(
        source.path,
        roles.kind,
        columns={name: column.name for name, column in roles.columns.items()},
        units={name: column.unit or "1" for name, column in roles.columns.items()},
        side=roles.side,
        why=(*roles.why, *by_file_name),
        remarks=(*remarks, *of_efforts, *of_values, *roles.remarks, *of_wraps, *of_time, *_of_unused(table, unused)),
        constants=dict(mapping.constants),
        recording=Recording(series, {name: used[name].si_unit if name in used else "s" for name in series}, table.title),
        neighbours={column.which: name for name, column in neighbours.items()},
        regressors=tuple(regressors),
        joint=(angle.which if angle is not None else "") or joint_in(source.path),
        texts=tuple(name for place, name in unused.items() if table.contents[place] == "other"),
        unnamed=tuple(unnamed.measured_columns(table, [column.position for column in columns])),
        began=began,
        mapping=stated,
        alternatives=_other_units(columns, roles.columns),
        is_of_robot=any(column.robot for column in roles.columns.values()),
        units_given=tuple(name for name, each in roles.columns.items() if each.sure and each.unit and not each.label.unit),
        units_assumed=tuple(name for name, each in roles.columns.items() if not each.sure),
        left_out=(
            *table.left_out,
            *(remark for remark in of_numbers if remark.startswith(UNUSED_NUMBERS)),
            *_of_unused(table, unused),
        ),
        parts=tuple(part.path for part in parts),
        ratio=ratio,
    )


def _roles_or_question(table: OpenTable, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    """Return the kind of a file, and the channel of each column."""
    try:
        return _roles([column for column in columns if column.own], mapping)
    except QuestionError as question:
        if question.answers:
            raise
        left = "".join(f"; {remark}" for remark in (*table.left_out, *_of_unused(table, _unused(table, columns))))
        if unnamed.is_frequency_response(table):
            why = "it is a frequency response, which is not read: give the record in time from which it was computed"
            raise QuestionError(f"{why}{left}") from None
        raise QuestionError(f"{question.question}{left}", unnamed.answers(table, columns, mapping.kind)) from None


def _roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    """Return the kind of a set of columns, and the channel of each; the kinds that need most are asked first."""
    if mapping.kind is not None:
        return kind_named(mapping.kind).roles(columns, mapping)
    kinds = [kind_named(name) for name in KINDS]
    if (kind := next((each for each in reversed(kinds) if each.recognises(columns, mapping)), None)) is not None:
        return kind.roles(columns, mapping)
    needs = "; ".join(f"{each.needs} for {each.name}" for each in kinds if each.needs)
    unknown = f"it has {names_of(columns)}, which is no measurement that is known: it needs {needs}"
    raise QuestionError(unknown)


def _other_units(columns: Sequence[Column], roles: Mapping[str, Column]) -> tuple[Answer, ...]:
    """Return other units of the channels without one, if their numbers fit them as well."""
    names = {each.position: each.name if name in OF_REFLECTED else name for name, each in roles.items()}
    ways = []
    for units in other_units([column for column in columns if column.own and column.position in names]):
        by_name = {names[place]: unit for place, unit in units.items()}
        ways.append(Answer("in " + listed(by_name.values()), {"units": by_name}))
    return tuple(ways)


def _unused(table: OpenTable, columns: Sequence[Column]) -> dict[int, str]:
    """Return the names in the file of the columns that are not among these, by their positions."""
    used = {column.position for column in columns}
    return {place: one_line(label.text) for place, label in enumerate(table.labels) if place not in used and label.name}


def _of_unused(table: OpenTable, unused: Mapping[int, str]) -> list[str]:
    """Return a remark on columns that are not used; a unit promises numbers, so that a text in such a column is named."""
    texts = {place for place in unused if table.contents[place] == "other" and table.labels[place].unit}
    names = [f"{name} (contains text)" if place in texts else name for place, name in unused.items()]
    return [f"columns not used: {listed(names)}"] if names else []


# ---- What a file adds to its mapping ---------------------------------------------------------------------------------


def _check_parts(source: MeasurementFile) -> None:
    """Refuse one file of a recording that has several, and files in which the numbers of several joints follow each other."""
    joints = dict[str, int]()
    for part in source.parts or (source,):
        if len(part.raw.labels) == 1 and nameless(part.raw):
            numbers, _ = part.raw.measured([ColumnSource(0, "numbers", "numbers", "1")])
            joints |= {part.path.name: count} if (count := interleaved(numbers["numbers"])) else {}
    if joints:
        count = max(joints.values())
        rows = f"np.savetxt('rows-' + name, np.loadtxt(name).reshape(-1, {count}))"
        raise QuestionError(
            f"the numbers of {count} joints follow each other in one column; write a row for each sample, as with "
            f'python -c "import numpy as np; [{rows} for name in {list(joints)}]", and take the files with rows'
        )
    if source.is_of_one_quantity and not source.parts and (others := files_of_same_recording(source.path)):
        together = Answer("the files of the recording together", files=tuple(map(str, others)))
        raise QuestionError("it has one quantity of a recording", [together])


def _check_named_effort(source: MeasurementFile, mapping: FileMapping) -> None:
    """Ask for the torque or current of columns without names, whose layout contains the motion alone."""
    channels = [CHANNELS[CHANNEL_ALIASES.get(name, name)] for name in mapping.columns if name != UNUSED]
    named, layout = {channel.quantity for channel in channels}, source.layout
    if layout is not None and layout.efforts and not named & {"torque", "current", "voltage"}:
        is_timed = "rate" in mapping.constants or any(label.name == "time" for label in source.table.labels)
        raise layout.question(is_timed=is_timed)


def _with_single_numbers(table: OpenTable, mapping: FileMapping) -> tuple[FileMapping, list[str], float | None]:
    """Return the mapping, with the rate of rows if a single number is one; remarks; and the ratio that the file states."""
    singles = dict(table.singles) if isinstance(table, ArrayTable | CsvTable) else {}
    ratios = [singles.pop(name) for name in list(singles) if RATIO_NAME.fullmatch(name.rpartition(".")[2])]
    timed = "time" in mapping.columns or any(
        (channel := meaning(label)) and channel.quantity == "time" for label in table.labels
    )
    remarks = []
    rates = {name: rate for name, value in singles.items() if (rate := _rate(name.rpartition(".")[2].casefold(), value))}
    if rates and not timed and "rate" not in mapping.constants:
        name, rate = next(iter(rates.items()))
        remarks.append(f"{name} = {singles.pop(name):g} is taken for the rate of its rows: {rate:g} Hz")
        mapping = mapping.updated(FileMapping(constants={"rate": rate}))
    if singles:
        remarks.append(f"{UNUSED_NUMBERS}{listed(f'{name} = {value:g}' for name, value in singles.items())}")
    return mapping, remarks, ratios[0] if ratios else None


def _rate(name: str, value: float) -> float | None:
    """Return the rate of rows [Hz] that a number of this name is; None if it is none."""
    highest = CONSTANTS["rate"].high
    if name in RATE_NAMES and 1.0 <= value <= highest:
        return value
    return 1.0 / value if name in STEP_NAMES and 1.0 / highest <= value < 1.0 else None


def _with_speed_of_name(columns: Sequence[Column], mapping: FileMapping, path: Path) -> tuple[FileMapping, tuple[str, ...]]:
    """Return the mapping, with the speed in the name of a file whose columns contain no motion; and what determines it."""
    quantities = {column.channel.quantity for column in columns if column.channel.measured}
    moves = (
        quantities & {"time", "speed"} or mapping.constants.keys() & {"rate", "speed"} or mapping.kind not in (None, "effort")
    )
    speed = None if moves or not quantities & {"torque", "current"} else speed_in(path)
    if speed is None:
        return mapping, ()
    why = f"by its name it turned at {speed:.4g} rad/s; otherwise add --constant speed=NUMBER"
    return mapping.updated(FileMapping(constants={"speed": speed})), (why,)


# ---- Motion and time -------------------------------------------------------------------------------------------------


def _unwrap(table: OpenTable, series: dict[str, Array], columns: Mapping[str, Column]) -> Iterator[str]:
    """Let angles run on that begin anew with each revolution; yield a remark of each."""
    for name, column in columns.items():
        if column.channel.quantity == "angle":
            try:
                series[name], wraps = unwrapped(series[name])
            except ValueError as error:
                raise ValueError(one_line(f"{table.file} column {quoted(column.name)} {error}")) from None
            if wraps:
                yield f"{column.name} begins anew with each revolution, {wraps} times: it is taken to run on"


def _in_time(
    series: dict[str, Array], columns: Mapping[str, Column], kind: str, mapping: FileMapping
) -> tuple[dict[str, Array], list[str], float]:
    """Return the rows of a recording in the order of time, remarks, and the stamp from which the time is counted [s]."""
    if kind_named(kind).time == "none":
        return series, [], 0.0
    remarks = list[str]()
    if "time" not in series and "rate" in mapping.constants:
        when = regular(len(next(iter(series.values()))), mapping.constants["rate"])
        series, remarks = {"time": when.time, **series}, list(when.remarks)
    if "time" not in series:
        if kind_named(kind).time == "needed":
            raise QuestionError("it has no time", [LOG_AT_RATE])
        return series, remarks, 0.0
    if kind in ("log", "encoders"):
        series, of_rows = _renewed(series, columns)
        series, of_jumps = _of_one_recording(series, columns)
        remarks += [*of_rows, *of_jumps, *_turn_speeds(series, columns, mapping)]
    others = {name: values for name, values in series.items() if name != "time"}
    repeated = np.zeros(len(series["time"]), bool)
    repeated[1:] = np.all([np.diff(values) == 0.0 for values in others.values()], axis=0)
    angle = next((values for name, values in others.items() if name in ("input_angle", "output_angle", "angle")), None)
    when = clock(series["time"], repeated, angle)
    others = {name: values[when.rows] for name, values in others.items()}
    return {"time": when.time, **others}, [*remarks, *when.remarks], when.began


def _renewed(series: dict[str, Array], columns: Mapping[str, Column]) -> tuple[dict[str, Array], list[str]]:
    """Return the rows in which an angle was renewed, and a remark if it was held between."""
    for name in ("input_angle", "reflected_angle", "output_angle"):
        if name in series and (renewed := renewed_rows(series[name])) is not None:
            rows, held = renewed
            rate = (len(rows) - 1) / max(float(series["time"][rows[-1]] - series["time"][rows[0]]), 1e-300)
            was = f"{columns[name].name} holds each value for {held} rows: it was sampled at {rate:.3g} Hz"
            remark = f"{was}, and the {len(rows)} rows are kept"
            return {each: values[rows] for each, values in series.items()}, [remark]
    return series, []


def _of_one_recording(series: dict[str, Array], columns: Mapping[str, Column]) -> tuple[dict[str, Array], list[str]]:
    """Return the rows of the longest stretch between jumps of an angle, and a remark."""
    time = series["time"]
    for name, column in columns.items():
        if not name.endswith("_angle"):
            continue
        behind = jumps(series[name], time, series.get(name.replace("angle", "speed")))
        if not len(behind):
            continue
        ends = np.array([0, *behind, len(time)])
        longest, first = int(np.argmax(np.diff(ends))), int(behind[0])
        rows = slice(ends[longest], ends[longest + 1])
        jump, elapsed = series[name][first] - series[name][first - 1], time[first] - time[first - 1]
        remark = (
            f"{column.name} jumps by {jump:.3g} rad within {1e3 * elapsed:.3g} ms at row {first}, further than it moves: "
            f"{len(ends) - 1} recordings in one file, of which the longest is taken, rows {rows.start} to {rows.stop - 1}"
        )
        return {each: values[rows] for each, values in series.items()}, [remark]
    return series, []


def _turn_speeds(series: dict[str, Array], columns: Mapping[str, Column], mapping: FileMapping) -> Iterator[str]:
    """Turn the sign of speeds that are counted against their angle, if a person gave none; yield a remark of each."""
    for name, column in columns.items():
        angle = name.replace("speed", "angle")
        if not name.endswith("_speed") or angle not in series or name in mapping.sign:
            continue
        if abs(speed_per_slope(series[angle], series[name], series["time"]) + 1.0) < MAX_OFF_SPEED:
            series[name] = -series[name]
            yield f"{column.name} is counted against {columns[angle].name}: its sign is turned round"
