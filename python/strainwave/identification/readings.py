"""The reading of a log, if names and numbers of its file leave several open: the one that leaves least unexplained.

Each reading is fitted by plain least squares to a part of the motion, and predicts the rest. A wrong unit or side scales
inertia and friction, which absorb it, but not the angle in the sine of gravity. Samples of sliding are compared, as plain least
squares does not describe how friction begins. If several readings remain, nothing in the file separates them: `decided` asks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.candidates.plain import fit_plain, sliding_squares
from strainwave.identification.checks.sizes import input_speed
from strainwave.identification.effort_readings import with_effort
from strainwave.identification.kinds.prepared_log import PreparedLog, log_of
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.sides import GIVEN
from strainwave.identification.reading.source import MeasurementFile
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.held_out import MAX_UNEXPLAINED
from strainwave.messages import listed
from strainwave.questions import Answer, QuestionError
from strainwave.statistics.gain import MIN_READING_GAIN_SIGMA, sigmas_of_gain, without_single_events

Array = NDArray[np.float64]

MAX_OF_ANOTHER = 0.95  # of the error of another reading: what leaves more is no better
MAX_OF_USUAL = 0.7  # of the error of the usual reading, which nothing but the fit puts in question
MIN_SENSE = 0.5  # of `Plain.sense`: below, inertia is negative or friction drives the motion
UNITS_OPEN = "no unit is stated, and another one than the usual explains more"
UNITS_EQUAL = "no unit is stated, and several explain it equally well"
TORQUES = ("joint_torque", "input_torque")


@dataclass(frozen=True, eq=False)
class _Reading:
    """One way to read a log, and what it leaves unexplained.

    Attributes:
        file: read so
        answer: by which it is read so
        squares: sum of squares of what plain least squares leaves, over the variance of the effort, of each block of the motion
        samples: of sliding, of each block
        contradiction: why no gear moves so; empty if one may
    """

    file: Recognised
    answer: Answer
    squares: Array
    samples: Array
    contradiction: str

    @property
    def error(self) -> float:
        """Root mean square over what varies, on data held out [1]."""
        return float(np.sqrt(self.squares.sum() / max(self.samples.sum(), 1.0)))

    def is_better_than(self, other: _Reading, share: float) -> bool:
        """True if it leaves at most this share of what another one leaves, and less over the whole motion, beyond chance."""
        gains = without_single_events(other.squares - self.squares)
        return sigmas_of_gain(gains) > MIN_READING_GAIN_SIGMA and self.error < share * other.error


def decided(file: Recognised, source: MeasurementFile, known: GearSoFar, given: FileMapping) -> Recognised:
    """Return a log in the reading of motion and effort that leaves least open; with its question, if several remain.

    Args:
        file: as it is usually read
        source: to read it again
        known: the gear before the file is fitted
        given: what a person states of it
    """
    read = _with_motion(file, source, known)
    return read if read.question else with_effort(read, source, known, given)


def _with_motion(file: Recognised, source: MeasurementFile, known: GearSoFar) -> Recognised:
    """Return a log in the reading that leaves least unexplained; with its question, if several leave as little.

    The usual reading of a log without a question is kept if it leaves clearly less than others, or if none explains the log.
    If another one leaves far less, that one is taken. Between them it is asked about, but for joints of robots, whose usual
    reading is kept unless another one leaves clearly less.

    Args:
        file: as it is usually read
        source: to read it again
        known: the gear before the file is fitted
    """
    if file.kind != "log" or not file.alternatives:
        return file
    tried = [_tried(file, _answer_of(file), known), *(_tried_again(file, source, each, known) for each in file.alternatives)]
    readings = [each for each in tried if each is not None]
    sensible = [each for each in readings if not each.contradiction] or readings
    if not sensible:
        return file
    best = min(sensible, key=lambda each: each.error)
    remaining = [each for each in sensible if each is best or not best.is_better_than(each, MAX_OF_ANOTHER)]
    usual = next((each for each in readings if each.file is file), None)
    others = [each for each in readings if each is not best]
    if file.question:
        is_decided = best.error < MAX_UNEXPLAINED and len(remaining) == 1
        return _taken(best, others, file) if is_decided else replace(file, question=_asked(file.question.question, remaining))
    is_open = usual in remaining and len(remaining) > 1
    if best.error >= MAX_UNEXPLAINED or (is_open and file.is_of_robot):
        return file
    if is_open:
        return replace(file, question=_asked(UNITS_EQUAL, remaining))
    rivals = [usual] if usual is not None and usual is not best and not usual.contradiction else []
    if len(remaining) == 1 and all(best.is_better_than(each, MAX_OF_USUAL) for each in rivals):
        return _taken(best, others, file)
    return replace(file, question=_asked(UNITS_OPEN, [*rivals, *remaining]))


def _taken(best: _Reading, others: Sequence[_Reading], file: Recognised) -> Recognised:
    """Return the file in the best reading, with a remark of what each leaves."""
    why = tuple(each for each in best.file.why if not (file.question and GIVEN in each))
    return replace(best.file, question=None, alternatives=(), why=why, remarks=(_report(best, others), *best.file.remarks))


def _tried_again(file: Recognised, source: MeasurementFile, other: Answer, known: GearSoFar) -> _Reading | None:
    """Return another reading with what it leaves; None if the file cannot be read so, or is no log then."""
    try:
        read = recognise(source, file.mapping.updated(FileMapping(**other.given)))
    except ValueError:
        return None
    return _tried(read, other, known) if read.kind == "log" else None


def _tried(file: Recognised, answer: Answer, known: GearSoFar) -> _Reading | None:
    """Return a reading with what it leaves; None if it is no log that can be fitted."""
    try:
        log = log_of(replace(file, neighbours={}).at_ratio(known.gear_set.gear.kinematics.ratio), known)
        squares, samples = sliding_squares(log.log, log.drive)
    except (ValueError, FloatingPointError):
        return None
    return _Reading(file, answer, squares, samples, _doubt(log))


def _doubt(log: PreparedLog) -> str:
    """Return why no gear moves so; empty if one may."""
    speed = input_speed(log.log.motion.speed, "")
    if speed.failed:
        return f"its input would turn at {speed.value:.3g} {speed.unit}"
    return (
        "its inertia would be negative, or friction would drive it" if fit_plain(log.log, log.drive).sense < MIN_SENSE else ""
    )


def _report(best: _Reading, others: Sequence[_Reading]) -> str:
    """Return which reading is taken, and what each leaves."""
    effort = next(name for name in ("current", *TORQUES, "voltage") if name in best.file.columns)
    least = f"read as {_described(best)}, which leaves {_percent(best)} of {best.file.columns[effort]} unexplained"
    return "; ".join([f"{least} on data held out", *(f"{_described(each)}: {_left(each)}" for each in others)])


def _asked(question: str, remaining: Sequence[_Reading]) -> QuestionError:
    """Return a question with the readings that remain as its answers, and what each leaves."""
    ways = [replace(each.answer, label=_described(each), gives=f"{_percent(each)} unexplained") for each in remaining]
    return QuestionError(f"{question}; the fit does not decide", ways)


def _answer_of(file: Recognised) -> Answer:
    """Return the answer with which a file is read as it was."""
    known = {**{column: file.units[name] for name, column in file.columns.items() if name in file.units}, **file.units}
    units = {name: known[name] for each in file.alternatives for name in each.given.get("units", ()) if name in known}
    side = {} if file.side is None else {"side": file.side}
    return Answer("as it is usually read", {**side, **({"units": units} if units else {})})


def _described(reading: _Reading) -> str:
    """Return side and units of the motions; their channels and that of the torque, if they are not of one side."""
    file, torques = reading.file, [name for name in TORQUES if name in reading.file.units]
    motions = [name for name in file.units if name.endswith(("_angle", "_speed"))]
    if file.side is not None:
        return f"{listed(file.units[name] for name in motions)} at the {file.side}"
    return listed(f"{name} in {file.units[name]}" for name in (*motions, *torques))


def _left(reading: _Reading) -> str:
    return f"{_percent(reading)}{f', and {reading.contradiction}' if reading.contradiction else ''}"


def _percent(reading: _Reading) -> str:
    percent = 100.0 * reading.error
    return f"{percent:.2g} %" if percent < 99.0 else f"{percent:.0f} %"
