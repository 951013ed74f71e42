"""Evidence for a reading of the effort of a log or a table of friction, if its file leaves quantity, side or unit open.

No fit separates them: inertia, gravity and friction all grow with the effort. By Bayes' rule they are compared with the
friction and the average torque of the start set, the spread of friction between gears, that of torque constants between motors,
the usual speeds of recordings, and the shares of recordings with each of the readings.
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
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import CHANNEL_ALIASES, CHANNELS, EFFORT_WORDS, Side, meaning, words_of
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import MIN_MOTOR_SPEED
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.questions import Answer

USUAL_TORQUE_CONSTANT = 0.1  # N.m/A, of motors of robots' joints (assumed)
CONSTANT_SPREAD = float(np.log(2.0))  # standard deviation of its logarithm (assumed)
FRICTION_SPREAD = float(np.log(3.0))  # of the logarithm of the friction of gears of about one size (assumed)
RATING_SPREAD = float(np.log(2.0))  # of the logarithm of a torque beyond the largest of the ratings (assumed)
# Of the efforts of robots, that are torques; of those beside a torque constant, that are currents (assumed).
SHARE_OF_TORQUES = 0.8
SHARE_OF_ROBOTS = 0.95  # of the torques with a word of robots, that are those of joints (assumed)
SHARE_OF_SIDE = 0.8  # of the torques whose name contains no side, that are counted where the motion was measured (assumed)
# Of the columns without a unit, in N.m or A and not in thousandths of it: small motors have torques in mN.m (assumed).
SHARE_OF_USUAL_UNIT = {"current": 0.9, "input_torque": 0.6, "joint_torque": 0.95}
SHARE_BEHIND_GEAR = 0.2  # of the torques of joints, that a sensor behind the gear measured (assumed)
USUAL_FASTEST_SPEED = 100.0  # rad/s of the input (assumed)
FASTEST_SPREAD = float(np.log(5.0))  # standard deviation of its logarithm (assumed)
SHARE_OF_OTHER_SPEEDS = 0.1  # of the recordings, that are as slow or fast as any gear turns (assumed)
RANGE_OF_SPEEDS = float(np.log(1e6))  # of the logarithm of these: from a hundredth of 1 rad/s to 10 000 rad/s
RANGE_BEHIND_GEAR = 10.0  # of the logarithm of the friction that such a torque contains, below that of the gear (assumed)
MIN_ODDS = 10.0  # of a reading against each other one, above which it is taken
SIDES_OF_TORQUE: dict[str, Side] = {"input_torque": "input", "joint_torque": "output"}  # of torques
USUAL_UNITS: dict[str, tuple[str, str]] = {"torque": ("N.m", "mN.m"), "current": ("A", "mA")}  # usual one first


@dataclass(frozen=True)
class Record:
    """Friction and speed of a recording, in the unit of its effort.

    Attributes:
        friction: at the speed
        effective: root mean square of the effort
        speed: of the input in the way in which the file is read [rad/s]
        fastest: the largest speed of the input [rad/s]
    """

    friction: float
    effective: float
    speed: float
    fastest: float


@dataclass(frozen=True)
class Usual:
    """Friction and torque of the start set.

    Attributes:
        gear: of it
        rating: average torque that it allows, at the input [N.m]; infinite if it states none
    """

    gear: Gear
    rating: float

    @staticmethod
    def of(known: GearSoFar) -> Usual:
        """Return them for a start set."""
        gear, limit = known.gear_set.gear, known.initial.ratings.get("average_torque")
        return Usual(gear, np.inf if limit is None else convert(limit.value, limit.unit, "N.m") / abs(gear.kinematics.ratio))

    def friction(self, speed: float) -> float:
        """Return the friction torque at a speed of the input [N.m]."""
        return float(self.gear.friction_input.steady(max(speed, REST_SPEED)))

    def shown(self, record: Record) -> str:
        """Return its friction at the speed of a record, in words."""
        return f"the start set has {self.friction(record.speed):.2g} N·m at {record.speed:.3g} rad/s"


@dataclass(frozen=True)
class Effort:
    """One way to read the effort of a file.

    Attributes:
        column: its name in the file
        channel: "current", "input_torque" or "joint_torque"
        unit: of the numbers in the file
        share: of the recordings with such names that are of this kind [1]
        torque: at the input for each number in the file [N.m]
        spread: standard deviation of its logarithm [1]
        side: of a table of friction
        faster: speed of the input over that in the way in which the file is read [1]
    """

    column: str
    channel: str
    unit: str
    share: float
    torque: float
    spread: float
    side: Side | None = None
    faster: float = 1.0

    def evidence(self, record: Record, usual: Usual) -> float:
        """Return the logarithm of the probability of a record in this reading, but for a constant of all readings."""
        friction = usual.friction(self.faster * record.speed)
        density = 1.0  # a set without friction says nothing of it
        if friction > 0.0:
            density = _density(record.friction * self.torque / friction, float(np.hypot(FRICTION_SPREAD, self.spread)))
        if self.side is None and self.channel == "joint_torque":
            is_less = record.friction * self.torque < friction
            density = (1.0 - SHARE_BEHIND_GEAR) * density + SHARE_BEHIND_GEAR * is_less / RANGE_BEHIND_GEAR
        of_speed = _density(record.fastest * self.faster / USUAL_FASTEST_SPEED, FASTEST_SPREAD)
        density *= (1.0 - SHARE_OF_OTHER_SPEEDS) * of_speed + SHARE_OF_OTHER_SPEEDS / RANGE_OF_SPEEDS
        beyond = float(np.log(max(record.effective * self.torque / usual.rating, 1.0))) / RATING_SPREAD
        return float(np.log(self.share) + np.log(max(density, 1e-300)) - 0.5 * beyond**2)

    @property
    def given(self) -> dict[str, Any]:
        """Keyword arguments of `FileMapping` that select this reading."""
        of_side = {"columns": {self.channel: self.column}} if self.side is None else {"side": self.side}
        return {**of_side, "units": {self.column: self.unit}}

    def shown(self, record: Record) -> str:
        """Return friction and speed of a record in this reading, in words."""
        return f"friction {record.friction * self.torque:.2g} N·m at {record.speed * self.faster:.3g} rad/s of the input"

    @property
    def described(self) -> str:
        """Quantity, side and unit."""
        what = {
            "current": "a current of the motor",
            "input_torque": "a torque of the motor",
            "joint_torque": "a torque of the joint",
        }
        beside = "" if self.side is None else f" beside a speed of the {'joint' if self.side == 'output' else 'motor'}"
        return f"{what[self.channel]} in {self.unit}{beside}"

    @property
    def answer(self) -> Answer:
        """The answer with which the file is read so."""
        given = self.given
        if self.channel != "current" or self.spread == 0.0:
            return Answer(self.described, given)
        given["constants"] = {"torque_constant": USUAL_TORQUE_CONSTANT}
        return Answer(self.described, given, {"torque_constant": "N.m/A, of the motor"}, gives="with the usual motor")


def _density(factor: float, spread: float) -> float:
    """Return the normal density of the logarithm of a factor about 0."""
    return float(np.exp(-0.5 * (np.log(max(factor, 1e-300)) / spread) ** 2) / (np.sqrt(2.0 * np.pi) * spread))


def record_of(file: Recognised, known: GearSoFar, as_read: Effort) -> Record | None:
    """Return friction and speed of a log or table; None if nothing determines them, or friction would drive the motion."""
    try:
        record = _of_table(file, known.gear_set.gear, as_read) if file.kind == "friction" else _of_log(file, known, as_read)
    except (ValueError, FloatingPointError):
        return None
    return record if record.friction > 0.0 else None


def _of_log(file: Recognised, known: GearSoFar, as_read: Effort) -> Record:
    """Return what a log shows by plain least squares; raises as `log_of`."""
    log = log_of(replace(file, neighbours={}).at_ratio(known.gear_set.gear.kinematics.ratio), known)
    speed = np.abs(log.log.motion.speed[log.log.sound])
    plain, medium = fit_plain(log.log, log.drive), float(np.median(speed))
    in_file = 1.0 / (convert(1.0, as_read.unit, "A") if log.in_current else as_read.torque)
    effort = float(np.sqrt(np.nanmean(file.recording.values(as_read.channel, as_read.unit) ** 2)))
    return Record(in_file * (plain.coulomb + plain.viscous * medium), effort, medium, float(speed.max()))


def _of_table(file: Recognised, gear: Gear, as_read: Effort) -> Record:
    """Return what a table of friction shows at its medium speed."""
    channel = next(name for name, column in file.columns.items() if column == as_read.column)
    effort = np.abs(file.recording.values(channel, as_read.unit))
    speed = np.abs(file.recording["speed"]) * (abs(gear.kinematics.ratio) if as_read.side == "output" else 1.0)
    effective, fastest = float(np.sqrt(np.mean(effort**2))), float(max(speed.max(), REST_SPEED))
    return Record(float(np.median(effort)), effective, float(np.median(speed)), fastest)


def _channel_of(file: Recognised, *, is_motor_known: bool) -> str:
    """Return the channel of the effort that a log is fitted to; empty if the file has none, or loads the gear with a torque."""
    first = ("current",) * is_motor_known + ("input_torque", "joint_torque", "torque", "current")
    channel = next((name for name in first if name in file.columns), "")
    return "" if "load_torque" in file.columns or file.columns.keys() >= SIDES_OF_TORQUE.keys() else channel


def efforts_of(file: Recognised, known: GearSoFar, given: FileMapping) -> list[Effort]:
    """Return the ways to read the effort of a file that its names and a person leave open, first that in which it is read.

    Args:
        file: as it is read
        known: the gear before the file is fitted
        given: what a person states of it
    """
    constant = file.constants.get("torque_constant", getattr(known.gear_set.motor, "torque_constant", None))
    channel = _channel_of(file, is_motor_known=constant is not None)
    if file.kind not in ("log", "friction") or not channel or " of " in file.units[channel]:  # a share of a rated torque
        return []
    column, ratio, is_table = file.columns[channel], abs(known.gear_set.gear.kinematics.ratio), file.kind == "friction"
    quantity, is_unit_open = CHANNELS[channel].quantity, channel in file.units_assumed
    names = [column, file.columns["speed"]] if is_table else [column]
    meanings = [each for name in names if (each := meaning(Label(name, name, None))) is not None]
    by_person = {CHANNEL_ALIASES.get(each, each) for each in given.columns}
    has_side = given.side or channel in by_person & set(SIDES_OF_TORQUE) or any(each.side for each in meanings)
    if is_table:
        has_side = has_side or any(each.robot for each in meanings) or np.abs(file.recording["speed"]).max() > MIN_MOTOR_SPEED
    is_open = not has_side and ratio > MIN_RATIO and (is_table or quantity == "torque")
    own: Side = file.side or "input" if is_table else SIDES_OF_TORQUE.get(channel, "input")
    of_own = SHARE_OF_ROBOTS if own == "output" and any(each.robot for each in meanings) else SHARE_OF_SIDE
    sides: dict[Side, float] = {own: of_own, "input" if own == "output" else "output": 1.0 - of_own}
    torques = {("joint_torque" if side == "output" else "input_torque", side): share for side, share in sides.items()}
    shares = {("current", side): share for side, share in sides.items()} if quantity == "current" else torques
    shares = shares if is_open else {next(iter(shares)): 1.0}
    may_be_current = (
        EFFORT_WORDS & set(words_of(column)) and not {channel, quantity} & by_person and "current" not in file.columns
    )
    if not is_table and quantity == "torque" and is_unit_open and may_be_current:
        of_torques = 1.0 - SHARE_OF_TORQUES if "torque_constant" in file.constants else SHARE_OF_TORQUES
        shares = {each: share * of_torques for each, share in shares.items()} | {("current", "input"): 1.0 - of_torques}
    per_ampere, spread = (USUAL_TORQUE_CONSTANT, CONSTANT_SPREAD) if constant is None else (float(constant), 0.0)
    readings = []
    for (name, side), share in shares.items():
        usual, _ = units = USUAL_UNITS[CHANNELS[name].quantity]
        size = {"current": per_ampere, "joint_torque": 1.0 / ratio}.get(name, 1.0)
        of_usual = SHARE_OF_USUAL_UNIT[name]
        of_unit = dict(zip(units, (of_usual, 1.0 - of_usual), strict=True)) if is_unit_open else {file.units[channel]: 1.0}
        faster = 1.0 if not is_table or side == own else ratio if side == "output" else 1.0 / ratio
        for unit, more in of_unit.items():
            torque, wide = size * convert(1.0, unit, usual), spread if name == "current" else 0.0
            readings.append(Effort(column, name, unit, share * more, torque, wide, side if is_table else None, faster))
    return readings
