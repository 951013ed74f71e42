"""Slots of other controllers: numbers that robot controllers and firmware take for friction and ripple, of a gear.

Each slot is a function of a `Request`, by the name of the slot in `SLOTS`. Each states what it loses against the full model.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from inspect import signature
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog, nnls

from strainwave import Drive, Gear, arguments, loads, motor
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.files.recording import Recording
from strainwave.files.units import convert
from strainwave.messages import listed, shortened
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.scenario import Scenario
from strainwave.tuning import goals
from strainwave.tuning.candidates import USUAL_SPEED
from strainwave.tuning.cascade import FAST_SPEED, Plant, model_of, steady_torque, torque_constant
from strainwave.tuning.compensate import CREEP_SPEED_SHARE, MAX_MEMBERS, MEASUREMENT_OF_EFFECT, assumed_numbers
from strainwave.tuning.drawn import drawn_gears
from strainwave.tuning.loss import ExportLoss

Array = NDArray[np.float64]

MIN_TEMPERATURE = 200.0  # K: less is a temperature in another unit
SPEEDS_PER_SENSE = 1001  # of each sense, over which friction is compared
SPEEDS_OF_DRAWS = 33  # likewise of each drawn gear
ANGLES_PER_TURN = 257  # of a turn of the output: prime, so that they are spread over the turns of the input, too
MAX_TURNS = 200  # of the input, over which a map is averaged
COMPARED_ANGLES_PER_POINT = 4  # angles at which a map is compared, per point
MAX_OVER_COMPENSATED_SHARE = 0.05  # share of gears of which the scaled friction may exceed that of the gear
MIN_MEMBERS = 19  # drawn gears, of which the weakest stands for that share
MIN_POINTS, MAX_POINTS = 4, 4096  # of a table
MAX_VALUES = 1_000_000  # of a torque offset along a motion
MAX_SPEED = 1e6  # rad/s
MAX_TORQUE = 1e9  # N.m
MIN_RATED_TORQUE = 1e-9  # N.m
MAX_PERMILLE = 32767  # that a 16 bit number holds


@dataclass(frozen=True)
class Request:
    """A gear, and in which form its slot is wanted; the arguments of `slot`."""

    name: str
    gear_set: GearSet
    side: str
    unit: str
    speed: float | None
    threshold: float | None
    points: int | None
    torque: float | None
    rated_torque: float | None
    motion: Scenario | None
    travel: float
    period: float
    temperature: float
    members: int
    seed: int

    @property
    def gear(self) -> Gear:
        """The gear."""
        return self.gear_set.gear

    @property
    def ratio(self) -> float:
        """Signed ratio of the gear."""
        return float(self.gear.kinematics.ratio)

    @property
    def speed_ratio(self) -> float:
        """Speed of the input over that of the side, signed."""
        return 1.0 if self.side == "input" else self.ratio

    @property
    def per_torque(self) -> float:
        """Number in the unit wanted per torque at the input."""
        return self.speed_ratio if self.unit == "N.m" else 1.0 / self._torque_constant()

    def _torque_constant(self) -> float:
        part = self.gear_set.motor
        constant = None if part is None else torque_constant(part)
        if constant is None:
            has = "has no [motor]" if part is None else "has a motor that takes a torque"
            raise ValueError(
                f'unit = "A" needs the torque constant of the motor, and {self.gear_set.name} {has}; '
                f"give it a motor with one, or take N.m"
            )
        return constant

    def friction(self, gear: Gear, speed: Array, angles: int = ANGLES_PER_TURN) -> Array:
        """Return the friction over speeds of the side, shape (speeds, angles), in the unit wanted."""
        angle = 2.0 * np.pi * abs(self.ratio) / angles * np.arange(angles)
        at_input = (speed * self.speed_ratio)[:, np.newaxis]
        return np.asarray(self.per_torque * steady_torque(gear, at_input, angle, self.torque or 0.0, self.temperature).friction)

    def speed_range(self) -> tuple[float, float]:
        """Return the threshold and the largest speed of the side [rad/s]."""
        at_side = 1.0 if self.side == "output" else abs(self.ratio)
        if self.speed is not None:
            top = at_side * abs(arguments.sized("speed", self.speed, "rad/s", 1e-9, MAX_SPEED))
        else:
            rated = self.gear_set.ratings.get("average_input_speed")
            at_input = FAST_SPEED if rated is None else convert(rated.value, rated.unit, "rad/s")
            top = at_input / abs(self.speed_ratio)
        if self.threshold is None:
            return CREEP_SPEED_SHARE * top, top
        at_output = arguments.number("threshold", self.threshold, "rad/s", low=0.0)
        threshold = at_side * at_output
        if threshold >= top:
            raise ValueError(f"threshold = {at_output} rad/s must be below the largest speed, {top / at_side:g} rad/s")
        return threshold, top

    def remarks(self, *effects: str) -> Iterator[str]:
        """Yield what is assumed of the effects of the gear, and in what unit currents are."""
        for effect in effects:
            if assumed := assumed_numbers(self.gear_set, effect):
                consequence = (
                    "the slot may add as much as it takes away" if effect == "kinematic error" else "so is the loss of the slot"
                )
                yield f"{effect} is assumed ({assumed}), and {consequence}; {MEASUREMENT_OF_EFFECT[effect]}"
        if self.unit == "A" and type(self.gear_set.motor) is motor.PMSM:
            yield "currents are amplitudes of the phases; the root mean square is smaller by the square root of 2"

    def exported(
        self,
        numbers: Mapping[str, tuple[float, str]],
        losses: tuple[ExportLoss, ...],
        sign: str,
        remarks: Iterator[str],
        table: Recording | None = None,
    ) -> Exported:
        """Return the numbers of the slot, with side and sign convention as the first remarks."""
        side = f"speeds and torques are those of the {self.side}"
        return Exported(
            self.name, self.gear_set.name, {}, numbers, losses, remarks=(side, f"sign: {sign}", *remarks), table=table
        )


@stating_origins
def slot(
    drive: GearSet | Drive | Gear | str | Path,
    name: str,
    *,
    side: str = "input",
    unit: str = "N.m",
    speed: float | None = None,
    threshold: float | None = None,
    points: int | None = None,
    torque: float | None = None,
    rated_torque: float | None = None,
    motion: Scenario | None = None,
    travel: float = 0.2,
    period: float = 1e-3,
    temperature: float = ROOM_TEMPERATURE,
    members: int = 200,
    seed: int = 0,
) -> Exported:
    """Return the numbers of a gear for a slot that controllers have, with what they lose against the full model.

    Args:
        drive: a gear, a drive or a set of one, or the name or path of a file
        name: "viscous-coulomb-scale" (scales of the friction compensation of a robot's torque interface), "coulomb-viscous"
            (of joint firmware), "speed-table" (of joint modules), "anticogging-map" (of servo drives) or "torque-offset"
            (CiA 402, object 0x60B2)
        side: "input" or "output", to which speeds and torques belong; maps and torque offsets belong to the input
        unit: "N.m" or, at the input, "A"
        speed: of the output [rad/s]: the largest; for a map that of the motion, with its sense. If not given, the rated average
            input speed, else 100 rad/s of the input; for a map 0.2 and for torque-offset 20 rad/s of the input
        threshold: speed of the output below which friction is not compensated in full [rad/s]; usually 1 % of the largest
        points: of a speed-table, half for each sense, or of an anticogging-map, per turn of the input
        torque: at the output, opposing forward motion [N.m]
        rated_torque: of the motor [N.m], which torque-offset refers to; if not given, the rating motor_rated_torque of the set
        motion: of the output from rest, for torque-offset; if not given, one period to and fro
        travel: of that motion, from end to end [rad]
        period: at which a torque offset is sent [s]
        temperature: of the gear [K]
        members: number of drawn gears, by which friction scales are judged
        seed: of the draw

    Returns:
        The numbers with their units, the loss of each, and the table of a slot that takes one.

    Raises:
        TypeError: `drive` is none
        ValueError: the set lacks what the slot needs, or a number is out of its range

    >>> import strainwave as sw
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05, viscous=1e-4))
    >>> found = slot(gear, "coulomb-viscous")
    >>> (coulomb, unit), (loss,) = found.numbers["coulomb_plus"], found.losses
    >>> round(coulomb, 9), unit, loss.rms < 1e-15
    (0.05, 'N.m', True)
    """
    arguments.one_of("slot", name, SLOTS)
    gear_set = gear_set_of(drive)
    if motion is not None and not isinstance(motion, Scenario):
        raise TypeError(f"motion must be a scenario, as sw.scenario.sine gives it, not {shortened(motion)}")
    if motion is not None:
        motion.check_unit("motion", "rad")
    arguments.one_of("side", side, ("input", "output"))
    arguments.one_of("unit", unit, ("N.m", "A"))
    if side == "output" and (unit == "A" or name in OF_THE_INPUT):
        wanted = 'unit = "A"' if unit == "A" else f"the slot {name}"
        raise ValueError(f'{wanted} belongs to the input; side = "output" must be "input"')
    if unit == "A" and name == "torque-offset":
        raise ValueError('unit = "A": a torque-offset is in permille of the rated torque; leave the unit out')
    _refuse_unused(
        name,
        speed=speed, threshold=threshold, points=points, torque=torque, rated_torque=rated_torque, motion=motion, travel=travel,
        period=period, members=members, seed=seed,
    )  # fmt: skip
    return SLOTS[name](
        Request(
            name,
            gear_set,
            side,
            unit,
            speed,
            threshold,
            points,
            None if torque is None else arguments.number("torque", torque, "N.m", "[]", -MAX_TORQUE, MAX_TORQUE),
            None if rated_torque is None else arguments.number("rated_torque", rated_torque, "N.m", "[)", MIN_RATED_TORQUE),
            motion,
            arguments.number("travel", travel, "rad", low=0.0),
            arguments.number("period", period, "s", low=0.0),
            arguments.number("temperature", temperature, "K", low=MIN_TEMPERATURE),
            arguments.whole("members", members, MIN_MEMBERS, MAX_MEMBERS),
            arguments.whole("seed", seed, 0),
        )
    )


def _refuse_unused(name: str, **options: object) -> None:
    """
    Raises:
        ValueError: an option that the slot does not use has another value than its default
    """
    defaults = signature(slot).parameters
    for option, value in options.items():
        if value == defaults[option].default:
            continue
        if option not in OPTIONS[name]:
            users = [each for each, used in OPTIONS.items() if option in used]
            raise ValueError(f"{option} is not used by the slot {name}, only by {listed(users)}; leave it out")
        if options["motion"] is not None and option in ("speed", "travel"):
            raise ValueError(f"{option} is that of a motion to and fro; leave it out, as motion states another")


@dataclass(frozen=True)
class FullFriction:
    """Friction of a gear over the speeds of a side, each sense from the threshold to the largest speed.

    Attributes:
        speed: shape (2 SPEEDS_PER_SENSE,), those of the negative sense first, rising
        torque: shape (2 SPEEDS_PER_SENSE, ANGLES_PER_TURN), in `unit`
        unit: of the torque
        over: the range in words
    """

    speed: Array
    torque: Array
    unit: str
    over: str

    @classmethod
    def of(cls, request: Request) -> FullFriction:
        """Return the friction of the gear of a request.

        Raises:
            ValueError: the gear has none
        """
        low, top = request.speed_range()
        forward = np.linspace(low, top, SPEEDS_PER_SENSE)
        speed = np.concatenate((-forward[::-1], forward))
        torque = request.friction(request.gear, speed)
        if not torque.any():
            raise ValueError(
                f"{request.gear_set.name}: the gear has no friction, so the slot {request.name} has nothing to compensate; "
                f"{MEASUREMENT_OF_EFFECT['friction']}"
            )
        over = f"{low:.3g} to {top:.3g} rad/s of the {request.side} in both senses, over a turn of the output"
        over += f", under {request.torque:g} N·m" if request.torque else ""
        return cls(speed, torque, request.unit, over)

    @property
    def mean(self) -> Array:
        """Mean over the angle; exactly the friction where this does not vary."""
        return mean_over_last(self.torque)

    def loss(self, applied: Array) -> ExportLoss:
        """Return the loss of what a slot applies at the speeds; both senses weigh the same."""
        difference = self.torque - applied[:, np.newaxis]
        return ExportLoss(
            "friction", self._rms(difference), float(np.abs(difference).max()), self.unit, self._rms(self.torque), self.over
        )

    def _rms(self, values: Array) -> float:
        """Return the root mean square over the speeds, by trapezoids, and over the angles."""
        weight = np.ones(SPEEDS_PER_SENSE)
        weight[[0, -1]] = 0.5
        return float(np.sqrt(np.average((values**2).mean(axis=1), weights=np.tile(weight, 2))))


def mean_over_last(values: Array) -> Array:
    """Return the mean over the last axis, without rounding if all values are the same."""
    return np.asarray(values[..., 0] + (values - values[..., :1]).mean(axis=-1))


def line_over_speed(speed: Array, torque: Array) -> tuple[float, float]:
    """Return Coulomb and viscous friction, neither negative: the best line through the friction of one sense over the speed."""
    columns = np.column_stack((np.ones_like(speed), speed / speed.max()))
    (coulomb, viscous), _ = nnls(columns, torque)
    return float(coulomb), float(viscous / speed.max())


def coulomb_viscous(request: Request) -> Exported:
    """Return Coulomb and viscous friction of each sense, and the threshold speed below which both fall to zero in a line."""
    full = FullFriction.of(request)
    forward = full.speed > 0.0
    plus = line_over_speed(full.speed[forward], full.mean[forward])
    minus = line_over_speed(-full.speed[~forward], -full.mean[~forward])
    applied = np.where(forward, plus[0] + plus[1] * full.speed, minus[1] * full.speed - minus[0])
    numbers = {
        f"{term}_{sense}": (line[k], request.unit + ".s/rad" * k)
        for sense, line in {"plus": plus, "minus": minus}.items()
        for k, term in enumerate(("coulomb", "viscous"))
    }
    numbers["threshold"] = (float(full.speed[forward][0]), "rad/s")
    sign = (
        "coulomb_plus + viscous_plus w is added at speeds w above the threshold, -coulomb_minus + viscous_minus w below its "
        "negative, and in between the line that joins both"
    )
    return request.exported(numbers, (full.loss(applied),), sign, request.remarks("friction"))


def speed_table(request: Request) -> Exported:
    """Return the friction over speeds in geometric steps from the threshold up, half of them in each sense."""
    count = arguments.whole("points", 32 if request.points is None else request.points, MIN_POINTS, MAX_POINTS)
    if count % 2:
        raise ValueError(f"points = {count} must be even: half of them belong to each sense of motion")
    full = FullFriction.of(request)
    forward = np.geomspace(full.speed[SPEEDS_PER_SENSE], full.speed[-1], count // 2)
    speed = np.concatenate((-forward[::-1], forward))
    torque = mean_over_last(request.friction(request.gear, speed))
    column = "torque" if request.unit == "N.m" else "current"
    table = Recording({"speed": speed, column: torque}, {"speed": "rad/s", column: request.unit})
    loss = full.loss(np.interp(full.speed, speed, torque))
    sign = "the value is added, in the sense of the speed; lines join the points, through zero between the slowest two"
    return request.exported({"points": (float(count), "1")}, (loss,), sign, request.remarks("friction"), table)


def viscous_coulomb_scale(request: Request) -> Exported:
    """Return the largest scales of viscous and Coulomb friction that over-compensate at most 5 % of the gears."""
    full = FullFriction.of(request)
    forward = full.speed > 0.0
    coulomb, viscous = line_over_speed(full.speed[forward], (full.mean[forward] - full.mean[~forward][::-1]) / 2.0)
    speed = np.linspace(full.speed[SPEEDS_PER_SENSE], full.speed[-1], SPEEDS_OF_DRAWS)
    least = np.array([_least_friction(request, gear, speed) for gear in _drawn(request)])
    if len(least) < MIN_MEMBERS:
        raise ValueError(f"{request.gear_set.name}: {len(least)} of {request.members} drawn gears have friction in its range")
    # Another gear is weaker in that share of draws.
    weaker = int(MAX_OVER_COMPENSATED_SHARE * (len(least) + 1) + 1e-9) - 1
    floor = least[np.argsort(least.mean(axis=1))[weaker:]].min(axis=0)
    parts = np.column_stack((np.full(speed.size, coulomb), viscous * speed))
    useful = parts.mean(axis=0)
    found = linprog(-useful, A_ub=parts, b_ub=np.maximum(floor, 0.0), bounds=[(0.0, float(part > 0.0)) for part in useful])
    scales = np.clip(np.asarray(found.x, dtype=float), 0.0, 1.0)
    over = float(np.mean((parts @ scales > least * (1.0 + 1e-9)).any(axis=1)))
    numbers = {
        "viscous_scale": (float(scales[1]), "1"),
        "coulomb_scale": (float(scales[0]), "1"),
        "viscous": (viscous, f"{request.unit}.s/rad"),
        "coulomb": (coulomb, request.unit),
        "over_compensated": (over, "1"),
    }
    applied = scales[0] * coulomb * np.sign(full.speed) + scales[1] * viscous * full.speed
    sign = "scale 1 is the friction of the gear as stated (coulomb and viscous), added in the sense of motion"
    return request.exported(numbers, (full.loss(applied),), sign, request.remarks("friction"))


def _least_friction(request: Request, gear: Gear, speed: Array) -> Array:
    """Return the smaller friction of both senses over the angle, at each speed."""
    forward, backward = request.friction(gear, speed), -request.friction(gear, -speed)
    return np.asarray(np.minimum(forward, backward).min(axis=1))


def _drawn(request: Request) -> Iterator[Gear]:
    """Yield gears that the set may be, with the friction of each; draws that are no gear are left out."""
    gear_set = request.gear_set
    if gear_set.motor is None or gear_set.load is None:  # neither matters to friction
        gear_set = gear_set.with_parts(motor=motor.TorqueSource(inertia=1e-4), load=loads.Inertia(), source="assumed")
    draws = drawn_gears(gear_set, request.members, request.seed)
    paths = [path for path in draws if path.startswith("gear.friction")]
    for k in range(request.members):
        with suppress(ValueError):
            yield request.gear.replace({path.removeprefix("gear."): float(draws[path][k]) for path in paths})


def anticogging_map(request: Request) -> Exported:
    """Return what the motor adds over the angle of the input: reaction of the error, friction that varies, cogging."""
    count = arguments.whole("points", 256 if request.points is None else request.points, MIN_POINTS, MAX_POINTS)
    if request.torque is None:
        raise ValueError(
            f"torque is needed for the slot {request.name}: the reaction of the kinematic error is in proportion to the torque "
            "[N.m] at the output"
        )
    turns = min(max(round(abs(request.ratio)), 1), MAX_TURNS)
    fine = 2.0 * np.pi / (COMPARED_ANGLES_PER_POINT * count) * np.arange(COMPARED_ANGLES_PER_POINT * count)
    angle = fine[:, np.newaxis] + 2.0 * np.pi * np.arange(turns)
    slow = CREEP_SPEED_SHARE * USUAL_SPEED / abs(request.ratio) if request.speed is None else request.speed
    speed = arguments.sized("speed", slow, "rad/s", 1e-9, MAX_SPEED) * abs(request.ratio)
    both = {each: _over_turn(request, angle, each) for each in (speed, -speed)}
    there = both[speed]
    if not there.ripple.any():
        raise ValueError(
            f"{request.gear_set.name}: neither kinematic error nor friction of the gear varies with the angle under "
            f"{request.torque:g} N·m, so the map is zero; {MEASUREMENT_OF_EFFECT['kinematic error']}"
        )
    values = mean_over_last(there.ripple)[::COMPARED_ANGLES_PER_POINT]
    applied = np.interp(fine, fine[::COMPARED_ANGLES_PER_POINT], values, period=2.0 * np.pi)[:, np.newaxis]
    losses = tuple(
        ExportLoss.between(
            "ripple", turn.ripple - applied, request.unit, _rms(turn.friction),
            f"{turns} turns of the input at {each:.3g} rad/s under {request.torque:g} N·m", "friction",
        )
        for each, turn in both.items()
    )  # fmt: skip
    column = "torque" if request.unit == "N.m" else "current"
    table = Recording(
        {"input_angle": fine[::COMPARED_ANGLES_PER_POINT], column: values}, {"input_angle": "rad", column: request.unit}
    )
    numbers = {
        "points": (float(count), "1"), "output_torque": (request.torque, "N.m"), "speed": (speed, "rad/s"),
        "amplitude": (float(np.abs(values).max()), request.unit),
    }  # fmt: skip
    sign = "the value is added at its input angle, positive forwards; the mean torque is left out, lines join the points"
    return request.exported(numbers, losses, sign, _map_remarks(request), table)


def _map_remarks(request: Request) -> Iterator[str]:
    if getattr(request.gear_set.motor, "cogging_torque", 0.0):
        yield "the cogging of the motor is in the map"
    yield from request.remarks("kinematic error", "friction")


@dataclass(frozen=True)
class _OverTurn:
    """Torque over the angle in the unit wanted, without its mean, and the friction in it."""

    ripple: Array
    friction: Array


def _over_turn(request: Request, angle: Array, speed: float) -> _OverTurn:
    resisting, reaction = steady_torque(request.gear, speed, angle, request.torque or 0.0, request.temperature)
    part = request.gear_set.motor
    cogging = getattr(part, "cogging_torque", 0.0) * np.sin(getattr(part, "cogging_order", 0.0) * angle)
    varying = resisting - resisting.flat[0]  # first, so that what does not vary leaves no rounding
    varying = varying + reaction - cogging
    return _OverTurn(request.per_torque * (varying - varying.mean()), request.per_torque * resisting)


def torque_offset(request: Request) -> Exported:
    """Return the torque offset of CiA 402 along a motion, as whole permille of the rated torque of the motor."""
    rated = _rated_torque(request)
    plant = Plant.of(request.gear_set, request.period, 0.0)
    motion = _to_and_fro(request) if request.motion is None else request.motion
    periods = motion.duration / request.period * (1.0 + 1e-12)
    if not 1.0 <= periods <= MAX_VALUES:
        raise ValueError(
            f"period = {request.period:g} s must divide the motion, {motion.duration:g} s, into 1 to {MAX_VALUES} parts"
        )
    time = request.period * np.arange(int(periods) + 1)
    model = model_of(plant, request.gear).replace(temperature=request.temperature)
    _, _, torque, resisting = model.requests(motion.value(time), motion.rate(time), plant.ratio, request.period)
    begun = time >= (goals.SETTLING_SHARE * motion.duration if request.motion is None else 0.0)  # at first it begins from rest
    torque, resisting = torque[begun], resisting[begun]
    time = time[: torque.size]
    wanted = 1e3 * torque / rated
    sent = np.rint(wanted)
    if np.abs(sent).max() > MAX_PERMILLE:
        raise ValueError(
            f"rated_torque = {rated:g} N.m is too small: the motion takes {np.abs(torque).max():.3g} N.m, and the object holds "
            f"at most {MAX_PERMILLE} permille"
        )
    begin, end = sent[:-1] - wanted[:-1], sent[:-1] - wanted[1:]  # held while the torque moves in a line
    loss = ExportLoss(
        "torque",
        float(np.sqrt(np.mean((begin**2 + begin * end + end**2) / 3.0))),
        float(np.maximum(np.abs(begin), np.abs(end)).max()),
        "permille",
        _rms(1e3 * resisting / rated),
        f"{time[-1]:.3g} s of the motion, each value held for {request.period:g} s",
        "friction",
    )
    sign = (
        "added to the torque command, positive drives the input forwards; inertia and load are in it: switch off other "
        "feed-forward"
    )
    table = Recording({"time": time, "permille": sent}, {"time": "s", "permille": "1"})
    numbers = {
        "rated_torque": (rated, "N.m"),
        "period": (request.period, "s"),
        "largest": (float(np.abs(sent).max()), "permille"),
    }
    return request.exported(numbers, (loss,), sign, request.remarks("friction", "torsion", "kinematic error"), table)


def _to_and_fro(request: Request) -> Scenario:
    usual = USUAL_SPEED / abs(request.ratio) if request.speed is None else request.speed
    return goals.to_and_fro(request.travel, arguments.number("speed", usual, "rad/s", low=0.0))


def _rated_torque(request: Request) -> float:
    if request.rated_torque is not None:
        return request.rated_torque
    rating = request.gear_set.ratings.get("motor_rated_torque")
    if rating is None:
        raise ValueError(
            "rated_torque is needed for the slot torque-offset: the rated torque of the motor [N.m], which is object 0x6076 "
            f"of the drive; {request.gear_set.name} has no rating motor_rated_torque"
        )
    return convert(rating.value, rating.unit, "N.m")


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


SLOTS: dict[str, Callable[[Request], Exported]] = {
    "viscous-coulomb-scale": viscous_coulomb_scale,
    "coulomb-viscous": coulomb_viscous,
    "speed-table": speed_table,
    "anticogging-map": anticogging_map,
    "torque-offset": torque_offset,
}
_OF_FRICTION = frozenset({"speed", "threshold", "torque"})
OPTIONS: dict[str, frozenset[str]] = {
    "viscous-coulomb-scale": _OF_FRICTION | {"members", "seed"},
    "coulomb-viscous": _OF_FRICTION,
    "speed-table": _OF_FRICTION | {"points"},
    "anticogging-map": frozenset({"speed", "points", "torque"}),
    "torque-offset": frozenset({"speed", "rated_torque", "motion", "travel", "period"}),
}  # that a slot uses, besides side, unit and temperature
OF_THE_INPUT = ("anticogging-map", "torque-offset")


SLOT = Form(slot, "a robot controller or servo drive", "the numbers of its slots for friction and ripple", "slots.md")
