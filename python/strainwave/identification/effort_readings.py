"""The quantity, side and unit of the effort of a log or a table of friction, if its file leaves them open.

No fit separates them: inertia, gravity and friction all grow with the effort. By Bayes' rule they are compared with the
friction and the average torque of the start set, the spread of friction between gears, that of torque constants between motors,
and the shares of recordings with each of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from strainwave._core import Gear
from strainwave.files.labels import Label
from strainwave.files.units import convert
from strainwave.identification.candidates.plain import fit_plain
from strainwave.identification.checks.sizes import MIN_RATIO, REST_SPEED
from strainwave.identification.kinds.prepared_log import log_of
from strainwave.identification.reading.channels import ALIASES, CHANNELS
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import EFFORTS, Side, meaning, words_of
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.sides import MIN_MOTOR_SPEED
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
SHARE_OF_ROBOTS = 0.95  # of the torques with a word of robots, that are those of joints (assumed)
SHARE_OF_SIDE = 0.8  # of the torques whose name contains no side, that are counted where the motion was measured (assumed)
# Of the columns without a unit, in N.m or A and not in thousandths of it: small motors have torques in mN.m (assumed).
SHARE_OF_USUAL_UNIT = {"current": 0.9, "input_torque": 0.6, "joint_torque": 0.95}
SHARE_BEHIND_GEAR = 0.2  # of the torques of joints, that a sensor behind the gear measured (assumed)
USUAL_FASTEST_SPEED = 100.0  # rad/s of the input, of tables of friction (assumed)
FASTEST_SPREAD = float(np.log(5.0))  # standard deviation of its logarithm (assumed)
RANGE_BEHIND_GEAR = 10.0  # of the logarithm of the friction that such a torque contains, below that of the gear (assumed)
MIN_ODDS = 10.0  # of a reading against each other one, above which it is taken
SIDES: dict[str, Side] = {"input_torque": "input", "joint_torque": "output"}  # of torques
UNITS: dict[str, tuple[str, str]] = {"torque": ("N.m", "mN.m"), "current": ("A", "mA")}  # the usual one of each quantity first


@dataclass(frozen=True)
class _Record:
    """Friction and speed of a recording, in the unit of its effort.

    Attributes:
        friction: at the speed
        effective: root mean square of the effort
        speed: of the input in the way in which the file is read [rad/s]
        fastest: the largest speed of the input of a table of friction; 0 of a log [rad/s]
    """

    friction: float
    effective: float
    speed: float
    fastest: float = 0.0


@dataclass(frozen=True)
class _Effort:
    """One way to read the effort of a file.

    Attributes:
        channel: "current", "input_torque" or "joint_torque"
        unit: of the numbers in the file
        share: of the recordings with such names that are of this kind [1]
        torque: at the input for each number in the file [N.m]
        spread: standard deviation of its logarithm [1]
        side: of a table of friction
        faster: speed of the input over that in the way in which the file is read [1]
    """

    channel: str
    unit: str
    share: float
    torque: float
    spread: float
    side: Side | None = None
    faster: float = 1.0

    def evidence(self, record: _Record, gear: Gear, rating: float) -> float:
        """Return the logarithm of the probability of a record in this reading, but for a constant of all readings.

        Args:
            record: what the file shows
            gear: of the start set
            rating: average torque that the start set allows, at the input [N.m]; infinite if it states none
        """
        usual = float(gear.friction_input.steady(max(self.faster * record.speed, REST_SPEED)))
        density = _density(record.friction * self.torque / usual, float(np.hypot(FRICTION_SPREAD, self.spread)))
        if self.side is not None:
            density *= _density(record.fastest * self.faster / USUAL_FASTEST_SPEED, FASTEST_SPREAD)
        elif self.channel == "joint_torque":
            is_less = record.friction * self.torque < usual
            density = (1.0 - SHARE_BEHIND_GEAR) * density + SHARE_BEHIND_GEAR * is_less / RANGE_BEHIND_GEAR
        beyond = float(np.log(max(record.effective * self.torque / rating, 1.0))) / RATING_SPREAD
        return float(np.log(self.share) + np.log(max(density, 1e-300)) - 0.5 * beyond**2)

    def given(self, column: str) -> dict[str, Any]:
        """Return what states this reading of a column, as keyword arguments of `FileMapping`."""
        if self.side is None:
            return {"columns": {self.channel: column}, "units": {column: self.unit}}
        return {"side": self.side, "units": {column: self.unit}}


def _density(factor: float, spread: float) -> float:
    """Return the normal density of the logarithm of a factor about 0."""
    return float(np.exp(-0.5 * (np.log(factor) / spread) ** 2) / (np.sqrt(2.0 * np.pi) * spread))


def with_effort(file: Recognised, source: MeasurementFile, known: GearSoFar, given: FileMapping) -> Recognised:
    """Return a file in the most probable reading of its effort; with its question, if another one is nearly as probable.

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
        record = _of_table(file, gear, as_read) if file.kind == "friction" else _of_log(file, known, as_read)
    except (ValueError, FloatingPointError):
        return file
    usual = float(gear.friction_input.steady(max(record.speed, REST_SPEED)))
    if not record.friction > 0.0 or not usual > 0.0:
        return file
    limit = known.initial.ratings.get("average_torque")
    rating = np.inf if limit is None else convert(limit.value, limit.unit, "N.m") / abs(gear.kinematics.ratio)
    evidence = {each: each.evidence(record, gear, rating) for each in readings}
    ranked = sorted(readings, key=lambda each: -evidence[each])
    near = [each for each in ranked if evidence[each] > evidence[ranked[0]] - np.log(MIN_ODDS)]
    if near == [as_read]:
        return file
    column = file.columns[_channel_of(file)]
    found = {each: f"friction {record.friction * each.torque:.2g} N·m at {record.speed * each.faster:.3g} rad/s of the input"
             for each in ranked}  # fmt: skip
    of_set = f"the start set has {usual:.2g} N·m at {record.speed:.3g} rad/s"
    if len(near) == 1:
        read = recognise(source, file.mapping.updated(FileMapping(**near[0].given(column))))
        why = f"{column} is read as {_described(near[0])}, as its friction is nearest to that of the start set"
        tried = "; ".join(f"{_described(each)}: {what}" for each, what in found.items())
        return replace(read, remarks=(one_line(f"{why}: {tried}; {of_set}"), *read.remarks))
    what = listed(dict.fromkeys(_described(each) for each in near))
    question = f"{column} may be {what}, and neither its name nor a fit decides; {of_set}"
    return replace(file, question=QuestionError(question, [_answer(column, each, found[each]) for each in near]))


def _of_log(file: Recognised, known: GearSoFar, as_read: _Effort) -> _Record:
    """Return what a log shows by plain least squares; raises as `log_of`."""
    log = log_of(replace(file, neighbours={}).at_ratio(known.gear_set.gear.kinematics.ratio), known)
    plain, speed = fit_plain(log.log, log.drive), float(np.median(np.abs(log.log.motion.speed[log.log.sound])))
    in_file = 1.0 / (convert(1.0, as_read.unit, "A") if log.in_current else as_read.torque)
    effort = file.recording.values(as_read.channel, as_read.unit)
    return _Record(in_file * (plain.coulomb + plain.viscous * speed), float(np.sqrt(np.nanmean(effort**2))), speed)


def _of_table(file: Recognised, gear: Gear, as_read: _Effort) -> _Record:
    """Return what a table of friction shows at its medium speed."""
    effort = np.abs(file.recording.values(_channel_of(file), as_read.unit))
    speed = np.abs(file.recording["speed"]) * (abs(gear.kinematics.ratio) if as_read.side == "output" else 1.0)
    return _Record(
        float(np.median(effort)),
        float(np.sqrt(np.mean(effort**2))),
        float(np.median(speed)),
        float(max(speed.max(), REST_SPEED)),
    )


def _channel_of(file: Recognised) -> str:
    """Return the channel of the one effort of a file; empty if it has none or several."""
    efforts = [name for name in ("current", "torque", "input_torque", "joint_torque") if name in file.columns]
    return efforts[0] if len(efforts) == 1 and "load_torque" not in file.columns else ""


def _readings(file: Recognised, known: GearSoFar, given: FileMapping) -> list[_Effort]:
    """Return the ways to read the effort of a file that its names and a person leave open, first that in which it is read."""
    channel = _channel_of(file)
    if file.kind not in ("log", "friction") or not channel or " of " in file.units[channel]:  # a share of a rated torque
        return []
    column, ratio, is_table = file.columns[channel], abs(known.gear_set.gear.kinematics.ratio), file.kind == "friction"
    quantity, is_unit_open = CHANNELS[channel].quantity, channel in file.units_assumed
    names = [column, file.columns["speed"]] if is_table else [column]
    meanings = [each for name in names if (each := meaning(Label(name, name, None))) is not None]
    by_person = {ALIASES.get(each, each) for each in given.columns}
    has_side = given.side or channel in by_person & set(SIDES) or any(each.side for each in meanings)
    if is_table:
        has_side = has_side or any(each.robot for each in meanings) or np.abs(file.recording["speed"]).max() > MIN_MOTOR_SPEED
    is_open = not has_side and ratio > MIN_RATIO and (is_table or quantity == "torque")
    own: Side = file.side or "input" if is_table else SIDES.get(channel, "input")
    of_own = SHARE_OF_ROBOTS if own == "output" and any(each.robot for each in meanings) else SHARE_OF_SIDE
    sides: dict[Side, float] = {own: of_own, "input" if own == "output" else "output": 1.0 - of_own}
    torques = {("joint_torque" if side == "output" else "input_torque", side): share for side, share in sides.items()}
    shares = {("current", side): share for side, share in sides.items()} if quantity == "current" else torques
    shares = shares if is_open else {next(iter(shares)): 1.0}
    may_be_current = bool(EFFORTS & set(words_of(column))) and not {channel, quantity} & by_person
    if not is_table and quantity == "torque" and is_unit_open and may_be_current:
        of_torques = 1.0 - SHARE_OF_TORQUES if "torque_constant" in file.constants else SHARE_OF_TORQUES
        shares = {each: share * of_torques for each, share in shares.items()} | {("current", "input"): 1.0 - of_torques}
    constant = file.constants.get("torque_constant", getattr(known.gear_set.motor, "torque_constant", None))
    per_ampere, spread = (USUAL_TORQUE_CONSTANT, CONSTANT_SPREAD) if constant is None else (float(constant), 0.0)
    readings = []
    for (name, side), share in shares.items():
        usual, _ = units = UNITS[CHANNELS[name].quantity]
        size = {"current": per_ampere, "joint_torque": 1.0 / ratio}.get(name, 1.0)
        of_usual = SHARE_OF_USUAL_UNIT[name]
        of_unit = dict(zip(units, (of_usual, 1.0 - of_usual), strict=True)) if is_unit_open else {file.units[channel]: 1.0}
        faster = 1.0 if not is_table or side == own else ratio if side == "output" else 1.0 / ratio
        for unit, more in of_unit.items():
            torque, wide = size * convert(1.0, unit, usual), spread if name == "current" else 0.0
            readings.append(_Effort(name, unit, share * more, torque, wide, side if is_table else None, faster))
    return readings


def _described(effort: _Effort) -> str:
    """Return quantity, side and unit of a reading."""
    what = {
        "current": "a current of the motor",
        "input_torque": "a torque of the motor",
        "joint_torque": "a torque of the joint",
    }
    beside = "" if effort.side is None else f" beside a speed of the {'joint' if effort.side == 'output' else 'motor'}"
    return f"{what[effort.channel]} in {effort.unit}{beside}"


def _answer(column: str, effort: _Effort, gives: str) -> Answer:
    """Return the answer with which a file is read so."""
    given = effort.given(column)
    if effort.channel != "current" or effort.spread == 0.0:
        return Answer(_described(effort), given, gives=gives)
    given["constants"] = {"torque_constant": USUAL_TORQUE_CONSTANT}
    return Answer(_described(effort), given, {"torque_constant": "N.m/A, of the motor"}, gives=f"{gives} with the usual motor")
