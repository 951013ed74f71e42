"""The quantity, side and unit of the effort of a log, if its file leaves them open: the most probable, or a question.

No fit separates them: inertia, gravity and friction all grow with the effort. By Bayes' rule they are compared with the
friction and the average torque of the start set, the spread of friction between gears, that of torque constants between motors,
and the shares of recordings with each of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from strainwave.files.labels import Label
from strainwave.files.units import convert
from strainwave.identification.candidates.plain import fit_plain
from strainwave.identification.checks.sizes import MIN_RATIO, REST_SPEED
from strainwave.identification.kinds.prepared_log import log_of
from strainwave.identification.reading.channels import ALIASES, CHANNELS
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import EFFORTS, meaning, words_of
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.source import MeasurementFile
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.messages import listed, one_line
from strainwave.questions import Answer, QuestionError

USUAL_TORQUE_CONSTANT = 0.1  # N.m/A, of motors of robots' joints (assumed)
CONSTANT_SPREAD = float(np.log(2.0))  # standard deviation of its logarithm (assumed)
FRICTION_SPREAD = float(np.log(3.0))  # of the logarithm of the friction of gears of about one size (assumed)
RATING_SPREAD = float(np.log(2.0))  # of the logarithm of a torque beyond the largest of the ratings (assumed)
SHARE_OF_TORQUES = (
    0.8  # of the efforts of robots, that are torques; of those beside a torque constant, that are currents (assumed)
)
SHARE_OF_SIDE = 0.8  # of the torques whose name contains no side, that are counted where the motion was measured (assumed)
SHARE_OF_USUAL_UNIT = 0.9  # of the columns without a unit, that are in N.m or A, and not in thousandths of it (assumed)
SHARE_BEHIND_GEAR = 0.2  # of the torques of joints, that a sensor behind the gear measured (assumed)
RANGE_BEHIND_GEAR = 10.0  # of the logarithm of the friction that such a torque contains, below that of the gear (assumed)
MIN_ODDS = 10.0  # of a reading against each other one, above which it is taken
UNITS: dict[str, tuple[str, str]] = {"torque": ("N.m", "mN.m"), "current": ("A", "mA")}  # the usual one of each quantity first


@dataclass(frozen=True)
class _Effort:
    """One way to read the effort of a log.

    Attributes:
        channel: "current", "input_torque" or "joint_torque"
        unit: of the numbers in the file
        share: of the recordings with such names that are of this kind [1]
        torque: at the input for each number in the file [N.m]
        spread: standard deviation of its logarithm [1]
    """

    channel: str
    unit: str
    share: float
    torque: float
    spread: float

    def evidence(self, friction: float, usual: float, effective: float, rating: float) -> float:
        """Return the logarithm of the probability of a log in this reading, but for a constant of all readings.

        Args:
            friction: in the unit of the file
            usual: friction of the start set at the same speed [N.m]
            effective: root mean square of the effort, in the unit of the file
            rating: average torque that the start set allows, at the input [N.m]; infinite if it states none
        """
        distance, spread = float(np.log(friction * self.torque / usual)), float(np.hypot(FRICTION_SPREAD, self.spread))
        density = np.exp(-0.5 * (distance / spread) ** 2) / (np.sqrt(2.0 * np.pi) * spread)
        if self.channel == "joint_torque":
            density = (1.0 - SHARE_BEHIND_GEAR) * density + SHARE_BEHIND_GEAR * (distance < 0.0) / RANGE_BEHIND_GEAR
        beyond = float(np.log(max(effective * self.torque / rating, 1.0))) / RATING_SPREAD
        return float(np.log(self.share) + np.log(max(density, 1e-300)) - 0.5 * beyond**2)


def with_effort(file: Recognised, source: MeasurementFile, known: GearSoFar, given: FileMapping) -> Recognised:
    """Return a log in the most probable reading of its effort; with its question, if another one is nearly as probable.

    Args:
        file: as it is read
        source: to read it again
        known: the gear before the file is fitted
        given: what a person states of it
    """
    readings = _readings(file, known, given)
    if len(readings) < 2:
        return file
    gear, as_read = known.gear_set.gear, readings[0]
    try:
        log = log_of(replace(file, neighbours={}).at_ratio(gear.kinematics.ratio), known)
    except (ValueError, FloatingPointError):
        return file
    plain, speed = fit_plain(log.log, log.drive), float(np.median(np.abs(log.log.motion.speed[log.log.sound])))
    in_file = 1.0 / (convert(1.0, as_read.unit, "A") if log.in_current else as_read.torque)
    friction = in_file * (plain.coulomb + plain.viscous * speed)
    usual = float(gear.friction_input.steady(max(speed, REST_SPEED)))
    if not friction > 0.0 or not usual > 0.0:
        return file
    effective = float(np.sqrt(np.nanmean(file.recording.values(as_read.channel, as_read.unit) ** 2)))
    limit = known.initial.ratings.get("average_torque")
    rating = np.inf if limit is None else convert(limit.value, limit.unit, "N.m") / abs(gear.kinematics.ratio)
    evidence = {each: each.evidence(friction, usual, effective, rating) for each in readings}
    ranked = sorted(readings, key=lambda each: -evidence[each])
    near = [each for each in ranked if evidence[each] > evidence[ranked[0]] - np.log(MIN_ODDS)]
    if near == [as_read]:
        return file
    column = file.columns[as_read.channel]
    found = [f"{_described(each)}: friction {friction * each.torque:.2g} N·m at the input" for each in ranked]
    of_set = f"the start set has {usual:.2g} N·m at {speed:.3g} rad/s"
    if len(near) == 1:
        read = recognise(source, file.mapping.updated(FileMapping({near[0].channel: column}, {column: near[0].unit})))
        why = f"{column} is read as {_described(near[0])}, as its friction is nearest to that of the start set"
        return replace(read, remarks=(one_line(f"{why}: {'; '.join(found)}; {of_set}"), *read.remarks))
    what = listed(dict.fromkeys(_described(each) for each in near))
    question = f"{column} may be {what}, and neither its name nor a fit decides; {of_set}"
    answers = [_answer(column, each, f"friction {friction * each.torque:.2g} N·m at the input") for each in near]
    return replace(file, question=QuestionError(question, answers))


def _readings(file: Recognised, known: GearSoFar, given: FileMapping) -> list[_Effort]:
    """Return the ways to read the effort of a log that its names and a person leave open, first that in which it is read."""
    efforts = [name for name in ("current", "input_torque", "joint_torque") if name in file.columns]
    if file.kind != "log" or len(efforts) != 1 or " of " in file.units[efforts[0]]:  # a share of the motor's rated torque
        return []
    (channel,) = efforts
    column, ratio = file.columns[channel], abs(known.gear_set.gear.kinematics.ratio)
    quantity, name = CHANNELS[channel].quantity, meaning(Label(column, column, None))
    by_person = {ALIASES.get(each, each) for each in given.columns}
    shares = {channel: 1.0}
    has_side = channel in by_person or given.side or (name is not None and name.side)
    if quantity == "torque" and not has_side and ratio > MIN_RATIO:
        other = "joint_torque" if channel == "input_torque" else "input_torque"
        shares = {channel: SHARE_OF_SIDE, other: 1.0 - SHARE_OF_SIDE}
    is_unit_open = channel in file.units_assumed
    if quantity == "torque" and is_unit_open and EFFORTS & set(words_of(column)) and not {channel, quantity} & by_person:
        of_torques = 1.0 - SHARE_OF_TORQUES if "torque_constant" in file.constants else SHARE_OF_TORQUES
        shares = {each: share * of_torques for each, share in shares.items()} | {"current": 1.0 - of_torques}
    constant = file.constants.get("torque_constant", getattr(known.gear_set.motor, "torque_constant", None))
    per_ampere, spread = (USUAL_TORQUE_CONSTANT, CONSTANT_SPREAD) if constant is None else (float(constant), 0.0)
    of_unit = (SHARE_OF_USUAL_UNIT, 1.0 - SHARE_OF_USUAL_UNIT) if is_unit_open else (1.0,)
    readings = []
    for each, share in shares.items():
        usual, _ = units = UNITS[CHANNELS[each].quantity]
        size = {"current": per_ampere, "joint_torque": 1.0 / ratio}.get(each, 1.0)
        for unit, more in zip(units if is_unit_open else (file.units[channel],), of_unit, strict=True):
            torque = size * convert(1.0, unit, usual)
            readings.append(_Effort(each, unit, share * more, torque, spread if each == "current" else 0.0))
    return readings


def _described(effort: _Effort) -> str:
    """Return quantity, side and unit of a reading."""
    what = {
        "current": "a current of the motor",
        "input_torque": "a torque of the motor",
        "joint_torque": "a torque of the joint",
    }
    return f"{what[effort.channel]} in {effort.unit}"


def _answer(column: str, effort: _Effort, gives: str) -> Answer:
    """Return the answer with which a log is read so."""
    given: dict[str, Any] = {"columns": {effort.channel: column}, "units": {column: effort.unit}}
    if effort.channel != "current" or effort.spread == 0.0:
        return Answer(_described(effort), given, gives=gives)
    given["constants"] = {"torque_constant": USUAL_TORQUE_CONSTANT}
    return Answer(_described(effort), given, {"torque_constant": "N.m/A, of the motor"}, gives=f"{gives} with the usual motor")
