"""Files of one set of measurements: in one reading, joined if one goes on where another one ends, and each counted once."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.identification.experiments.drive_log import ENCODERS
from strainwave.identification.experiments.motion_log import EFFORTS
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import CHANNELS, Side
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.source import MeasurementFile
from strainwave.messages import listed
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.residuals import rms

Array = NDArray[np.float64]

MAX_FILES = 200  # of one recorder: each is read once for each of its alternatives
MIN_STEPS_BETWEEN, MAX_STEPS_BETWEEN = 0.2, 3.0  # of the clock, from the last row of a file to the first of the next
MAX_STEP_BETWEEN = 3.0  # largest steps of an angle, from the last row of a file to the first of the next
CONDITIONS = {"time", "temperature"}  # two measurements may share these
MIN_COMMON_CHANNELS = 2  # besides conditions, of two files that may contain one measurement
MAX_OFF_NUMBER = 1e-3  # of the range, between two readings of one number
MAX_OFF_RUN = 4e-3  # usual deviations, between two encoders of one drive that moved once, but for scale and zero
MAX_OFF_EFFORT = 0.2  # of the same: as much as noise and delay make
MAX_OFF_ERROR = 0.01  # of the kinematic error, between two copies of one record: as much as rounding makes
MAX_OFF_TEMPERATURE = 0.5  # K: as much as rounding of one temperature makes
SAMPLES_COMPARED = 500  # of two runs

_Reading = tuple[Side | None, tuple[tuple[str, str], ...]]  # the side, and quantity and unit of each motion


# ---- One reading -----------------------------------------------------------------------------------------------------


def consistent(files: Sequence[Recognised], opened: Mapping[Path, MeasurementFile]) -> list[Recognised]:
    """Return the files, those of one recorder in the one reading that all of them allow, if there is one.

    Files are of one recorder if their columns have the same names: it writes all of them in the same units.

    Args:
        files: in any order
        opened: the files to read again, by their paths
    """
    groups = dict[frozenset[str], list[Recognised]]()
    for file in files:
        groups.setdefault(frozenset(file.columns.values()), []).append(file)
    taken = dict[Path, Recognised]()
    for group in groups.values():
        if 1 < len(group) <= MAX_FILES and any(file.question for file in group):
            taken |= _in_one_reading(group, opened)
    return [taken.get(file.path, file) for file in files]


def _in_one_reading(group: Sequence[Recognised], opened: Mapping[Path, MeasurementFile]) -> dict[Path, Recognised]:
    """Return the files of a recorder in the reading that all of the usual kind allow; empty if there is none, or several."""
    usual, _ = Counter(file.kind for file in group).most_common(1)[0]
    readings = dict[Path, dict[_Reading, Recognised]]()
    for file in group:
        ways = [
            file,
            *(recognise(opened[file.path], file.mapping.updated(FileMapping(**each.given))) for each in file.alternatives),
        ]
        readings[file.path] = {_reading(way): way for way in ways}
    common = set[_Reading].intersection(*(set(readings[file.path]) for file in group if file.kind == usual))
    if len(common) != 1:
        return {}
    (one,) = common
    _, motions = one
    remark = f"in {', '.join(unit for _, unit in motions)}, as the other files with these columns allow nothing else"
    in_one = dict[Path, Recognised]()
    for file in group:
        own = readings[file.path]
        same = own.get(one) or next((way for (_, moved), way in own.items() if moved == motions), file)
        in_one[file.path] = replace(same, question=None, alternatives=(), remarks=(remark, *same.remarks))
    return in_one


def _reading(file: Recognised) -> _Reading:
    quantities = {name: str(CHANNELS[name].quantity) for name in file.units if name in CHANNELS}
    motions = {(quantity, file.units[name]) for name, quantity in quantities.items() if quantity in ("angle", "speed")}
    return file.side, tuple(sorted(motions))


# ---- Joined ----------------------------------------------------------------------------------------------------------


def joined(files: Sequence[Recognised]) -> list[Recognised]:
    """Return the files, with logs that go on where others end joined to them, in the order of their first parts.

    A log goes on if it has the same channels, its time begins a step behind the end of the other's, and its angles where the
    other's end. A clock that begins anew in each file does not show whether rows are missing between: such files stay apart.

    Args:
        files: in any order
    """
    logs = sorted((file for file in files if file.kind == "log"), key=lambda file: file.began + float(file.recording.time[0]))
    chains: list[list[Recognised]] = []
    for log in logs:
        chain = next((each for each in chains if _goes_on(each[-1], log)), None)
        if chain is None:
            chains.append([log])
        else:
            chain.append(log)
    wholes = {id(chain[0]): _whole(chain) for chain in chains}
    return [wholes.get(id(file), file) for file in files if file.kind != "log" or id(file) in wholes]


def _whole(chain: Sequence[Recognised]) -> Recognised:
    """Return the log of which these are the parts."""
    first, *others = chain
    if not others:
        return first
    names = first.recording.names
    columns = {name: np.concatenate([each.recording[name] for each in chain]) for name in names if name != "time"}
    time = np.concatenate([each.recording.time + (each.began - first.began) for each in chain])
    units = {name: first.recording.unit(name) for name in names}
    do = "goes on where it ends, and is" if len(others) == 1 else "go on where it ends, and are"
    remark = f"{listed(each.path.name for each in others)} {do} joined to it"
    recording = Recording({"time": time, **columns}, units, first.recording.title)
    return replace(first, recording=recording, remarks=(remark, *first.remarks))


def _goes_on(one: Recognised, other: Recognised) -> bool:
    """True if a log goes on in another file."""
    before, after = one.recording, other.recording
    if (set(before.names), one.constants, one.joint) != (set(after.names), other.constants, other.joint):
        return False
    if min(len(before), len(after)) < 2:
        return False
    step = float(np.median(np.diff(before.time)))
    apart = (other.began + float(after.time[0])) - (one.began + float(before.time[-1]))
    angles = [(before[name], after[name]) for name in ENCODERS if name in before]
    return MIN_STEPS_BETWEEN * step < apart < MAX_STEPS_BETWEEN * step and all(
        abs(angle[0] - last[-1]) <= MAX_STEP_BETWEEN * max(float(np.abs(np.diff(last)).max()), 1e-300) for last, angle in angles
    )


# ---- Counted once ----------------------------------------------------------------------------------------------------


def same_as(files: Sequence[Recognised]) -> dict[str, str]:
    """Return paths of files that contain the measurement of another one, each with the path of that one.

    Of several it is the one with most channels, and the first of those.
    """
    copies: dict[str, str] = {}
    richest_first = sorted(files, key=lambda file: -len(file.recording.names))
    for place, file in enumerate(richest_first):
        others = [each for each in richest_first[:place] if str(each.path) not in copies and each.kind == file.kind]
        if (richer := next((each for each in others if _are_alike(each, file)), None)) is not None:
            copies[str(file.path)] = str(richer.path)
    return copies


def _are_alike(one: Recognised, other: Recognised) -> bool:
    """True if two files of one kind contain one measurement: a motion may be repeated at another temperature."""
    if abs(one.temperature - other.temperature) > MAX_OFF_TEMPERATURE:
        return False
    if one.kind in ("log", "encoders"):
        return _are_one_run(one.recording, other.recording)
    common = [name for name in one.recording.names if name in other.recording]
    pairs = [(one.recording[name], other.recording[name]) for name in common]
    if len(one.recording) != len(other.recording) or len(set(common) - CONDITIONS) < MIN_COMMON_CHANNELS:
        return False
    return all(bool(np.all(np.abs(a - b) <= MAX_OFF_NUMBER * max(float(np.ptp(a)), 1e-300))) for a, b in pairs)


def _less_line(series: Array) -> Array:
    """Return a series less the straight line that fits it best."""
    place = np.arange(len(series))
    return np.asarray(series - np.polyval(np.polyfit(place, series, 1), place))


def _are_one_run(one: Recording, other: Recording) -> bool:
    """True if two logs contain one motion: an angle of one is a multiple of an angle of the other, at the same times.

    Straight lines are always multiples of each other: what the angles have besides must be so.
    """
    angles = [next((each[name] for name in ENCODERS if name in each), None) for each in (one, other)]
    if angles[0] is None or angles[1] is None or "time" not in one or "time" not in other:
        return False
    time = np.linspace(max(one.time[0], other.time[0]), min(one.time[-1], other.time[-1]), SAMPLES_COMPARED)
    if not time[-1] > time[0]:
        return False
    a, b = _less_line(np.interp(time, one.time, angles[0])), _less_line(np.interp(time, other.time, angles[1]))
    if not _are_proportional(a, b, MAX_OFF_RUN):
        return False
    return _may_be_one_effort(one, other, time) and _may_be_one_error(one, other, time)


def _may_be_one_error(one: Recording, other: Recording, time: Array) -> bool:
    """True if the output is off the motion of the input by the same: a repeated motion has another error, and other noise."""
    if not all(set(ENCODERS) <= set(recording.names) for recording in (one, other)):
        return True
    errors = []
    for recording in (one, other):
        angles = {name: np.interp(time, recording.time, recording[name]) for name in ENCODERS}
        columns = np.stack([angles["input_angle"], np.ones_like(time)], axis=1)
        errors.append(angles["output_angle"] - columns @ solved(columns, angles["output_angle"]))
    a, b = errors
    return rms(a - np.sign(a @ b) * b) <= MAX_OFF_ERROR * rms(a)


def _may_be_one_effort(one: Recording, other: Recording, time: Array) -> bool:
    """True if the same may have moved both: two drives may follow one command with different loads."""
    first, second = ([name for name in EFFORTS if name in each] for each in (one, other))
    if not first or not second:
        return True
    common = [name for name in first if name in second]
    names = (common[0], common[0]) if common else (first[0], second[0])
    a, b = (np.interp(time, each.time, each[name]) for each, name in zip((one, other), names, strict=True))
    size = float(np.median(np.abs(a)) / max(np.median(np.abs(b)), 1e-300))
    return _are_proportional(a, b, MAX_OFF_EFFORT) and (not common or abs(size - 1.0) < MAX_OFF_EFFORT)


def _are_proportional(one: Array, other: Array, max_off: float) -> bool:
    """True if two series are multiples of each other but for zeros and noise; outliers do not count."""
    if np.std(one) == 0.0 or np.std(other) == 0.0:
        return False
    a, b = (each - np.median(each) for each in (one, other))
    a, b = (each / (np.median(np.abs(each)) or np.std(each)) for each in (a, b))  # no median size if it rests most of the time
    return bool(np.median(np.abs(a - np.sign(a @ b) * b)) < max_off)
