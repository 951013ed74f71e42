"""The reading of a file, if its names and numbers leave several open: the most probable one, or the question which it is.

Readings of a motion are fitted by plain least squares to a part of the motion, and predict the rest. A wrong unit or side
scales inertia and friction, which absorb it, but not the angle in the sine of gravity. Samples of sliding are compared, as
plain least squares does not describe how friction begins. Readings that explain as much are compared by friction and speed
with gears of the size of the start set, by Bayes' rule (`evidence`). Which joint or which column is meant is asked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import zip_longest

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.candidates.plain import fit_plain, sliding_squares
from strainwave.identification.checks.sizes import input_speed
from strainwave.identification.evidence import MIN_ODDS, Effort, Record, Usual, efforts_of, record_of
from strainwave.identification.kinds.prepared_log import PreparedLog, log_of
from strainwave.identification.reading.answers import MAX_ANSWERS, in_words
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.roles import AS_WAS_GIVEN
from strainwave.identification.reading.source import MeasurementFile
from strainwave.identification.results.file_result import MAX_UNEXPLAINED
from strainwave.identification.results.gear_so_far import GearSoFar, with_ratio
from strainwave.messages import listed, one_line
from strainwave.questions import ALL_JOINTS, Answer, QuestionError
from strainwave.statistics.scale import MIN_READING_GAIN_SIGMA, sigmas_of_gain, without_single_events

Array = NDArray[np.float64]

MAX_OF_ANOTHER = 0.95  # of the error of another reading: what leaves more is no better
MAX_OF_USUAL = 0.7  # of the error of the usual reading, which nothing but the fit puts in question
MIN_SENSE = 0.5  # of `Plain.sense`: below, inertia is negative or friction drives the motion
UNITS_OPEN = "no unit is stated, and another one than the usual explains more"
UNITS_EQUAL = "no unit is stated, and several explain it equally well"
TORQUE_CHANNELS = ("joint_torque", "input_torque")


@dataclass(frozen=True, eq=False)
class _Reading:
    """One way to read a file, and what it leaves unexplained.

    Attributes:
        answer: by which it is read so; without a label if it is the only one
        file: read so; None if it is not compared with others
        squares: sum of squares of what plain least squares leaves, over the variance of the effort, of each block of the motion
        samples: of sliding, of each block; none of a table
        contradiction: why no gear moves so; empty if one may
    """

    answer: Answer
    file: Recognised | None = None
    squares: Array = field(default_factory=lambda: np.zeros(0))
    samples: Array = field(default_factory=lambda: np.zeros(0))
    contradiction: str = ""

    @property
    def error(self) -> float:
        """Root mean square over what varies, on held-out data [1]."""
        return float(np.sqrt(self.squares.sum() / max(self.samples.sum(), 1.0)))

    @property
    def of_columns(self) -> object:
        """The joint and the columns that its answer names."""
        return self.answer.given.get("joint"), frozenset(self.answer.given.get("columns", {}).values())

    def is_better_than(self, other: _Reading, share: float) -> bool:
        """True if it leaves at most this share of what another one leaves, and less over the whole motion, beyond chance."""
        gains = without_single_events(other.squares - self.squares)
        return sigmas_of_gain(gains) > MIN_READING_GAIN_SIGMA and self.error < share * other.error


@dataclass(frozen=True, eq=False)
class _Way:
    """One way to read motion and effort of a file.

    Attributes:
        reading: of the motion
        effort: its reading; None if it is not judged
        record: friction and speed; None if it is not judged
        evidence: logarithm of the probability, but for a constant; infinite if it is not judged
        is_usual: True if the effort is read so without being asked about
        is_open: True if the effort may be read in another way
    """

    reading: _Reading
    effort: Effort | None = None
    record: Record | None = None
    evidence: float = np.inf
    is_usual: bool = True
    is_open: bool = False

    @property
    def shown(self) -> str:
        """Friction and speed in it, in words."""
        return self.effort.shown(self.record) if self.effort is not None and self.record is not None else ""

    @property
    def answer(self) -> Answer:
        """The answer with which the file is read so, and what it gives."""
        motion = self.reading.answer
        of_motion, of_effort = motion.gives, Answer("")
        if self.is_open and self.effort is not None:
            as_usual = Answer("" if motion.label else self.effort.described, self.effort.given)
            of_effort = as_usual if self.is_usual else self.effort.answer
        if len(self.reading.samples):
            of_motion = f"{_percent(self.reading)} unexplained"
        elif of_motion and self.effort is not None and self.reading.file is not None:
            of_motion = in_words(self.reading.file, FileMapping(**of_effort.given))
        gives = (of_motion, f"{self.shown} {of_effort.gives}".strip())
        return replace(self._of_any_joint(of_effort.after(motion)), gives="; ".join(filter(None, gives)))

    def _of_any_joint(self, answer: Answer) -> Answer:
        """Return an answer with the columns of all joints that the question named, so that another joint may be put into it."""
        channel, column = ("", "") if self.effort is None else (self.effort.channel, self.effort.column)
        named = self.reading.answer.given.get("columns", {}).get(channel, column)
        if named == column:
            return answer
        columns = {**answer.given.get("columns", {}), channel: named}
        units = {channel if name == column else name: unit for name, unit in answer.given.get("units", {}).items()}
        return replace(answer, given={**answer.given, "columns": columns, **({"units": units} if units else {})})


def decided(file: Recognised, source: MeasurementFile, known: GearSoFar, given: FileMapping) -> Recognised:
    """Return a file in the most probable reading of its motion and effort.

    Args:
        file: as it is usually read
        source: to read it again
        known: the gear before the file is fitted
        given: what a person states of it

    Raises:
        QuestionError: several readings are nearly as probable
    """
    if file.kind != "log" or not file.alternatives:
        return _most_probable([_Reading(Answer(""), file)], "", source, known, given)
    readings, question = _of_motion(file, source, known)
    return _most_probable(readings, question, source, known, given)


def answered(question: QuestionError, source: MeasurementFile, known: GearSoFar, given: FileMapping) -> Recognised:
    """Return a file whose names and numbers leave a question open in the most probable one of its answers.

    Args:
        question: each of its answers leads to a measurement
        source, known, given: as of `decided`

    Raises:
        QuestionError: several answers are possible; those to questions that would follow are among them
    """
    readings = list[_Reading]()
    for answer in question.answers:
        if answer.numbers or answer.files or answer.given.get("joint") == ALL_JOINTS:
            readings.append(_Reading(answer))
            continue
        file = recognise(source, given.updated(FileMapping(**answer.given)))
        known_of_file = with_ratio(known, file)
        of_motion = _of_motion(file, source, known_of_file)[0] if file.kind == "log" and file.alternatives else []
        readings += [replace(each, answer=each.answer.after(answer)) for each in of_motion]
        if not of_motion:
            readings.append((_tried(file, answer, known_of_file) if file.kind == "log" else None) or _Reading(answer, file))
        if readings[-1].error >= MAX_UNEXPLAINED:
            readings[-1] = replace(readings[-1], contradiction=f"{_percent(readings[-1])} is unexplained")
    return _most_probable(readings, question.question, source, known, given)


# ---- The most probable one -------------------------------------------------------------------------------------------


def _most_probable(
    readings: Sequence[_Reading], question: str, source: MeasurementFile, known: GearSoFar, given: FileMapping
) -> Recognised:
    """Return the file in the most probable way to read its motion and effort.

    Args:
        readings: of the motion, the usual one first
        question: that is open between them; empty if there is one
        source, known, given: as of `decided`
    """
    usual = Usual.of(known)
    by_reading = [_ways(each, known, given, usual, is_one=not question) for each in _sensible(readings)]
    every = [way for same_place in zip_longest(*by_reading) for way in same_place if way is not None]
    near = [way for way in every if way.evidence > _best(way, every) - np.log(MIN_ODDS)]
    first, is_of_same_columns = near[0], len({each.of_columns for each in readings}) == 1
    if len(near) == 1 and (not question or (first.effort is not None and is_of_same_columns and len(readings) > 1)):
        return _read_so(first, every, source, usual)
    if not question:
        assert first.effort is not None
        assert first.record is not None
        what = listed(dict.fromkeys(way.effort.described for way in near if way.effort is not None))
        question = f"{first.effort.column} may be {what}, and neither its name nor a fit decides; {usual.shown(first.record)}"
    shown, first_of = {way.reading for way in near}, {ways[0].reading: ways[0] for ways in by_reading}
    asked = [way for way in every if way in near or (way.reading not in shown and way is first_of[way.reading])]
    ranked = sorted(asked, key=lambda way: -way.evidence) if is_of_same_columns else asked
    raise QuestionError(one_line(question), [way.answer for way in ranked[:MAX_ANSWERS]])


def _sensible(readings: Sequence[_Reading]) -> list[_Reading]:
    """Return the readings in which a gear may move; of a joint of which none is so, all."""
    fitted = [each for each in readings if each.file is not None]
    moving = {each.answer.given.get("joint") for each in fitted if not each.contradiction}
    return [each for each in readings if not each.contradiction or each.answer.given.get("joint") not in moving]


def _best(way: _Way, ways: Sequence[_Way]) -> float:
    """Return the largest evidence of the ways that are compared with one: those of the same columns."""
    same = [each.evidence for each in ways if each.reading.of_columns == way.reading.of_columns and each.effort is not None]
    return max(same, default=-np.inf)


def _ways(reading: _Reading, known: GearSoFar, given: FileMapping, usual: Usual, *, is_one: bool) -> list[_Way]:
    """Return the ways to read the effort beside a motion, the most probable first; one that is not judged, if none is."""
    file = reading.file
    stated = {name: value for name, value in reading.answer.given.items() if name != "side"}  # of the motion
    efforts = [] if file is None else efforts_of(file, known, given.updated(FileMapping(**stated)))
    record = None if file is None or len(efforts) < 1 + is_one else record_of(file, known, efforts[0])
    if record is None:
        return [_Way(reading)]
    is_open, first = len(efforts) > 1, efforts[0]
    ways = [_Way(reading, each, record, each.evidence(record, usual), each is first, is_open) for each in efforts]
    return sorted(ways, key=lambda way: -way.evidence)


def _read_so(way: _Way, ways: Sequence[_Way], source: MeasurementFile, usual: Usual) -> Recognised:
    """Return the file in the most probable way, with a remark of the others if it is not the usual one."""
    file, effort, record = way.reading.file, way.effort, way.record
    assert file is not None
    if effort is None or record is None or (way.is_usual and not way.reading.answer.label):
        return file
    read = file if way.is_usual else recognise(source, file.mapping.updated(FileMapping(**effort.given)))
    tried = "; ".join(f"{_name_of(each)}: {each.shown}" for each in ways if each.effort is not None)
    taken = f"{effort.column} is read as {_name_of(way)}, as its friction is nearest to that of the start set"
    if way.reading.answer.label:
        taken = f"taken as most probable: {_name_of(way)}, with the friction and speed nearest to usual ones"
    remark = one_line(f"{taken}: {tried}; {usual.shown(record)}")
    why = tuple(each for each in read.why if not ("side" in way.reading.answer.given and AS_WAS_GIVEN in each))
    return replace(read, question=None, alternatives=(), why=why, remarks=(remark, *read.remarks))


def _name_of(way: _Way) -> str:
    """Return a way to read a file in words."""
    effort = way.effort.described if way.effort is not None and (way.is_open or not way.reading.answer.label) else ""
    return ", ".join(filter(None, (way.reading.answer.label, effort)))


# ---- The motion ------------------------------------------------------------------------------------------------------


def _of_motion(file: Recognised, source: MeasurementFile, known: GearSoFar) -> tuple[list[_Reading], str]:
    """Return the readings of the motion of a log that remain, and the question that is open if there are several.

    The usual reading of a log without a question is kept if it leaves clearly less than others, or if none explains the log.
    If another one leaves far less, that one is taken. Between them it is asked about, but for joints of robots, whose usual
    reading is kept unless another one leaves clearly less.

    Args:
        file: as it is usually read
        source: to read it again
        known: the gear before the file is fitted
    """
    tried = [_tried(file, _answer_of(file), known), *(_tried_again(file, source, each, known) for each in file.alternatives)]
    readings = [each for each in tried if each is not None]
    sensible = _sensible(readings)
    as_usual = [_Reading(Answer(""), file)]
    if not sensible:
        return as_usual, ""
    best = min(sensible, key=lambda each: each.error)
    remaining = [each for each in sensible if each is best or not best.is_better_than(each, MAX_OF_ANOTHER)]
    usual = next((each for each in readings if each.file is file), None)
    others = [each for each in readings if each is not best]
    if file.question:
        if best.error >= MAX_UNEXPLAINED:
            named, question = _open(file.question.question, remaining)
            return [replace(each, file=None) for each in named], question
        return ([_taken(best, others, file)], "") if len(remaining) == 1 else _open(file.question.question, remaining)
    is_open = usual in remaining and len(remaining) > 1
    if best.error >= MAX_UNEXPLAINED or (is_open and file.is_of_robot):
        return as_usual, ""
    if is_open:
        return _open(UNITS_EQUAL, remaining)
    rivals = [usual] if usual is not None and usual is not best and not usual.contradiction else []
    if len(remaining) == 1 and all(best.is_better_than(each, MAX_OF_USUAL) for each in rivals):
        return [_taken(best, others, file)], ""
    return _open(UNITS_OPEN, [*rivals, *remaining])


def _open(question: str, remaining: Sequence[_Reading]) -> tuple[list[_Reading], str]:
    """Return readings between which no fit decides, called by their sides and units, and the question."""
    named = [replace(each, answer=replace(each.answer, label=_described(each))) for each in remaining]
    return named, f"{question}; the fit does not decide"


def _taken(best: _Reading, others: Sequence[_Reading], file: Recognised) -> _Reading:
    """Return the best reading as the only one, with a remark of what each leaves."""
    assert best.file is not None
    why = tuple(each for each in best.file.why if not (file.question and AS_WAS_GIVEN in each))
    remarks = (_report(best, others), *best.file.remarks)
    return _Reading(Answer(""), replace(best.file, question=None, alternatives=(), why=why, remarks=remarks))


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
    return _Reading(answer, file, squares, samples, _doubt(log))


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
    assert best.file is not None
    effort = next(name for name in ("current", *TORQUE_CHANNELS, "voltage") if name in best.file.columns)
    least = f"read as {_described(best)}, which leaves {_percent(best)} of {best.file.columns[effort]} unexplained"
    return "; ".join([f"{least} on held-out data", *(f"{_described(each)}: {_left(each)}" for each in others)])


def _answer_of(file: Recognised) -> Answer:
    """Return the answer with which a file is read as it was."""
    known = {**{column: file.units[name] for name, column in file.columns.items() if name in file.units}, **file.units}
    units = {name: known[name] for each in file.alternatives for name in each.given.get("units", ()) if name in known}
    side = {} if file.side is None else {"side": file.side}
    return Answer("as it is usually read", {**side, **({"units": units} if units else {})})


def _described(reading: _Reading) -> str:
    """Return side and units of the motions; their channels and that of the torque, if they are not of one side."""
    file = reading.file
    assert file is not None
    torques = [name for name in TORQUE_CHANNELS if name in file.units]
    motions = [name for name in file.units if name.endswith(("_angle", "_speed"))]
    if file.side is not None:
        return f"{listed(file.units[name] for name in motions)} at the {file.side}"
    return listed(f"{name} in {file.units[name]}" for name in (*motions, *torques))


def _left(reading: _Reading) -> str:
    return f"{_percent(reading)}{f', and {reading.contradiction}' if reading.contradiction else ''}"


def _percent(reading: _Reading) -> str:
    percent = 100.0 * reading.error
    return f"{percent:.2g} %" if percent < 99.0 else f"{percent:.0f} %"
