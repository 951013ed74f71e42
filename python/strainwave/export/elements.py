"""A gear in the elements that multibody programs have: springs with a gap, springs that yield, dry and viscous friction.

Springs with a gap make a piecewise linear spring, springs that yield make Maxwell slip elements. Both are exact for
those laws. Other laws are fitted, and `torsion_loss` and `friction_loss` state the difference to the gear.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, nnls

from strainwave import Drive, Gear, arguments, friction, hysteresis, loads, motor, stiffness
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.files.units import convert
from strainwave.questions import NUMBER, Answer, QuestionError
from strainwave.simulation import scenario
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.run import simulate
from strainwave.tuning.cascade import steady_torque
from strainwave.tuning.loss import ExportLoss

Array = NDArray[np.float64]

MAX_TORQUES = ("peak_torque", "average_torque", "rated_torque")  # ratings from which the range of the torsion is taken
MAX_SPEEDS = ("average_input_speed", "maximum_input_speed")  # likewise of the friction
DEFAULT_INPUT_SPEED = 200.0  # rad/s, of a gear without a rating
CREEP_SHARE = 0.01  # of the largest speed, from which friction is fitted
FITTED_SPEEDS = 400  # in each sense
FITTED_ANGLES = 61  # over a turn of the output
FITTED_SEGMENTS = 12  # of the line that stands for a curved spring
MAX_FITTED_SLIPS = 16  # of a hysteresis that is fitted; least squares keeps some of them
MIN_SLIP_SHARE = 2e-3  # of the largest twist, at which the first of them slips
LOSS_WEIGHT = 1e3  # of the loss per cycle over that of a torque of the loop
LOOP_POINTS = 400  # of a branch of the loop in which hysteresis is compared
RUN_DURATION = 10.0  # s
RUN_FREQUENCY = 0.5  # Hz
RUN_SPEED = 100.0  # rad/s of the input at most
RUN_TORQUE_SHARE = 0.3  # of the largest torque, that the run reaches
RUN_SAMPLE = 2e-3  # s
MIN_FRICTION_SHARE = 1e-9  # of the largest torque [1]: a smaller dry or viscous part is a rounding error
MIN_SLOPE_SHARE = 1e-9  # of the stiffness: a smaller slope is rounding


@dataclass(frozen=True)
class Spring:
    """Spring of the twist beyond a gap: (linear + quadratic |x| + cubic x²) x, with x the twist beyond +-gap.

    Attributes:
        linear, quadratic, cubic: coefficients [N.m/rad, N.m/rad², N.m/rad³]
        gap: twist on either side, up to which it has no torque [rad]
    """

    linear: float
    quadratic: float = 0.0
    cubic: float = 0.0
    gap: float = 0.0

    def torque(self, twist: Array) -> Array:
        """Return the torque [N.m], shape as the twist [rad]."""
        x = twist - np.clip(twist, -self.gap, self.gap)
        force: Array = (self.linear + self.quadratic * np.abs(x) + self.cubic * x**2) * x
        return force

    def times(self, factor: float) -> Spring:
        """Return the spring with a multiple of the torque."""
        return Spring(factor * self.linear, factor * self.quadratic, factor * self.cubic, self.gap)


@dataclass(frozen=True)
class ShaftFriction:
    """Friction of a shaft: a bristle, or a dry and a viscous part.

    Attributes:
        dry: torque at any speed [N.m]; 0 with a bristle
        viscous: torque per speed [N.m.s/rad]
        bristle: the LuGre law of the shaft; None if its friction is dry and viscous
    """

    dry: float
    viscous: float
    bristle: friction.LuGre | None = None

    def steady(self, speed: Array) -> Array:
        """Return the torque against a steady speed [N.m], shape as the speed [rad/s]."""
        if self.bristle is not None:
            law: Array = np.asarray(self.bristle.steady(speed)) + self.dry * np.sign(speed)
            return law
        torque: Array = self.dry * np.sign(speed) + self.viscous * speed
        return torque


@dataclass(frozen=True)
class GearElements:
    """A gear in elements of multibody programs.

    Attributes:
        ratio: input over output speed, signed
        input_inertia: of gear and rotor about the input [kg.m²]
        springs: whose torques add
        slips: stiffness and breakaway torque of each spring that yields [N.m/rad, N.m]
        damping: of the twist [N.m.s/rad]
        at_input, at_output: friction of both shafts
        max_torque: at the output, up to which the torsion was fitted [N.m]
        max_speed: of the input, up to which friction was fitted [rad/s]
        left_out: laws of the gear without an element, in words
    """

    ratio: float
    input_inertia: float
    springs: tuple[Spring, ...]
    slips: tuple[tuple[float, float], ...]
    damping: float
    at_input: ShaftFriction
    at_output: ShaftFriction
    max_torque: float
    max_speed: float
    left_out: tuple[str, ...]

    @classmethod
    def of_set(cls, gear_set: GearSet, max_torque: float | None = None) -> GearElements:
        """Return the elements of the gear of a set.

        Args:
            gear_set: the gear, with its ratings, and its motor if that is known
            max_torque: at the output, up to which the torsion is fitted [N.m]; by default the peak torque of the ratings

        Raises:
            ValueError: neither a torque nor a rating is given
        """
        rotor = float(getattr(gear_set.motor, "inertia", 0.0))
        return cls.of(gear_set.gear, rotor, _max_torque(gear_set, max_torque), max_speed_of(gear_set))

    @classmethod
    def of(cls, gear: Gear, rotor_inertia: float, max_torque: float, max_speed: float) -> GearElements:
        """Return the elements of a gear.

        Args:
            gear: at room temperature
            rotor_inertia: of the motor [kg.m²]
            max_torque: at the output, up to which the torsion is fitted [N.m]
            max_speed: of the input, up to which friction is fitted [rad/s]
        """
        twist = _twist_at(gear, max_torque)
        return cls(
            ratio=float(gear.kinematics.ratio),
            input_inertia=float(gear.input_inertia) + rotor_inertia,
            springs=_springs(gear.stiffness, twist),
            slips=_slips(gear.hysteresis, twist),
            damping=float(gear.damping),
            at_input=_friction_at_input(gear, max_speed),
            at_output=_friction_of(gear.friction_output, max_speed / abs(gear.kinematics.ratio), 1.0),
            max_torque=max_torque,
            max_speed=max_speed,
            left_out=tuple(_left_out(gear, max_torque)),
        )

    def losses(self, gear: Gear) -> tuple[ExportLoss, ...]:
        """Return the losses against a gear: of torsion loops, of friction over speed, and of a run."""
        twist = _twist_at(gear, self.max_torque)
        friction = friction_losses(gear, self.max_speed, self.friction)
        return (*self.torsion_losses(gear, twist), *friction, *self.run_losses(gear))

    def torque(self, twist: Array) -> Array:
        """Return the torque along a path of the twist from a virgin state [N.m], shape as the path [rad]."""
        memory = hysteresis.MaxwellSlip(stiffness=[k for k, _ in self.slips], breakaway=[f for _, f in self.slips])
        total: Array = sum((spring.torque(twist) for spring in self.springs), np.asarray(memory.trace(twist)))
        return total

    def torsion_losses(self, gear: Gear, twist: float) -> Iterator[ExportLoss]:
        """Yield what torque, width and loss per cycle of a loop to the largest twist, and of one to half of it, differ by."""
        for reach in (twist, 0.5 * twist):
            path, loop = _loop(reach)
            held = np.asarray(gear.hysteresis.trace(path))
            both = [(np.asarray(gear.stiffness.torque(path)) + held)[loop], self.torque(path)[loop]]
            top = float(np.abs(both[0]).max())
            over = f"a torsion loop to {top:.4g} N.m"
            yield ExportLoss.between("torque of the loop", both[1] - both[0], "N.m", top, over)
            if held.any():
                (width, energy), (own_width, own_energy) = (_width_and_energy(path[loop], torque) for torque in both)
                yield ExportLoss.between("width of the loop", np.array([own_width - width]), "rad", width, over)
                yield ExportLoss.between("loss per cycle", np.array([own_energy - energy]), "J", energy, over)

    def run_losses(self, gear: Gear) -> Iterator[ExportLoss]:
        """Yield what output angle and motor torque differ by if the input moves to and fro before an inertia."""
        speed = min(RUN_SPEED, 0.5 * self.max_speed)
        inertia = RUN_TORQUE_SHARE * self.max_torque * abs(self.ratio) / (2.0 * np.pi * RUN_FREQUENCY * speed)
        full, own = (
            _to_and_fro(each, self.input_inertia - gear.input_inertia, speed, inertia) for each in (gear, self.simplified(gear))
        )
        motion = f"{RUN_DURATION:g} s at {RUN_FREQUENCY:g} Hz, the input to {speed:.4g} rad/s"
        over = f"{motion} before {inertia:.3g} kg.m2 at the output, a load of this comparison only"
        twist = float(np.ptp(full["transmission_error"]))
        yield ExportLoss.between("transmission error of a run", own["output_angle"] - full["output_angle"], "rad", twist, over)
        torque = float(np.sqrt(np.mean(full["motor_torque"] ** 2)))
        yield ExportLoss.between("motor torque of a run", own["motor_torque"] - full["motor_torque"], "N.m", torque, over)

    def simplified(self, gear: Gear) -> Gear:
        """Return a gear with the spring of the given one and no law but the elements."""
        at_input = self.at_input.bristle or friction.Coulomb(coulomb=self.at_input.dry, viscous=self.at_input.viscous)
        return Gear(
            kinematics=gear.kinematics,
            stiffness=gear.stiffness,
            hysteresis=hysteresis.MaxwellSlip(stiffness=[k for k, _ in self.slips], breakaway=[f for _, f in self.slips]),
            damping=self.damping,
            friction_input=at_input,
            friction_output=friction.Coulomb(coulomb=self.at_output.dry, viscous=self.at_output.viscous),
            input_inertia=gear.input_inertia,
        )

    def friction(self, speed: Array) -> Array:
        """Return the friction of the whole gear at the input [N.m] at steady speeds of the input [rad/s]."""
        at_output: Array = self.at_output.steady(speed / self.ratio) / self.ratio
        return self.at_input.steady(speed) + at_output


def _to_and_fro(gear: Gear, rotor_inertia: float, speed: float, inertia: float) -> Recording:
    """Return the run of a gear whose input moves as a sine with a largest speed [rad/s] before an inertia [kg.m²]."""
    drive = Drive(gear=gear, motor=motor.AccelerationSource(inertia=rotor_inertia), load=loads.Inertia(inertia=inertia))
    rate = 2.0 * np.pi * RUN_FREQUENCY
    motion = scenario.sine(amplitude=-rate * speed, frequency=RUN_FREQUENCY, duration=RUN_DURATION)
    begin = {"input_speed": speed, "output_speed": speed / float(gear.kinematics.ratio)}
    recorded = ["output_angle", "transmission_error", "motor_torque"]
    return simulate(drive, motion, sample=RUN_SAMPLE, initial=begin, record=recorded)


def friction_losses(gear: Gear, max_speed: float, exported: Callable[[Array], Array]) -> Iterator[ExportLoss]:
    """Yield what the friction of an exported model differs by, at the input, over speeds of both senses and a turn.

    Args:
        gear: the gear
        max_speed: of the input [rad/s]
        exported: friction at the input [N.m] as a function of the speed of the input [rad/s]
    """
    forward = np.linspace(CREEP_SHARE * max_speed, max_speed, FITTED_SPEEDS)
    speed = np.concatenate([-forward[::-1], forward])
    angle = _angles(float(gear.kinematics.ratio))
    full = steady_torque(gear, speed[:, None], angle[None, :], 0.0, ROOM_TEMPERATURE).friction
    size = float(np.sqrt(np.mean(full**2)))
    if size > 0.0:
        over = f"{forward[0]:.3g} to {forward[-1]:.4g} rad/s of the input in both senses, over a turn of the output"
        yield ExportLoss.between("friction at the input", exported(speed)[:, None] - full, "N.m", size, over)


def remark_on_rotor(gear_set: GearSet, factor: str = "") -> Iterator[str]:
    """Yield a remark if the inertia of the motor is not part of the armature.

    Args:
        gear_set: the gear with its motor
        factor: that the armature has the inertia of the rotor with, in words
    """
    if gear_set.motor is None:
        yield (
            "the file contains no motor: armature is the inertia of the wave generator alone. Add that of the rotor" + factor
        )
    elif not getattr(gear_set.motor, "inertia", 0.0):
        yield (
            "motor.inertia is 0 in the file: armature is the inertia of the wave generator alone. If `identify` found the "
            "inertia of the load, it contains that of the rotor: do not add it again to that load; bodies of a robot lack "
            "it. `identify` with --constant motor_inertia=NUMBER parts them"
        )


def twist_at_largest(elements: GearElements) -> float:
    """Return the twist of a virgin gear at its largest torque [rad]."""

    def missing(twist: float) -> float:
        return float(elements.torque(np.array([0.0, twist]))[-1]) - elements.max_torque

    high = 1e-6
    while missing(high) < 0.0:
        high *= 2.0
    return float(brentq(missing, 0.0, high))


def rated_torque(gear_set: GearSet) -> float | None:
    """Return the largest torque at the output among the ratings of a gear [N.m]; None if it has none."""
    ratings = (gear_set.ratings.get(name) for name in MAX_TORQUES)
    return next((convert(each.value, each.unit, "N.m") for each in ratings if each), None)


def max_torque_of(model: object, max_torque: float | None) -> float | None:
    """Return a given torque at the output [N.m], or the largest among the ratings of a gear set; None without both.

    Raises:
        TypeError, ValueError: the torque is not a positive number
    """
    if max_torque is not None:
        return arguments.number("max_torque", max_torque, "N.m", low=0.0)
    return rated_torque(model) if isinstance(model, GearSet) else None


def max_speed_of(gear_set: GearSet) -> float:
    """Return the largest speed of the input among the ratings of a gear [rad/s], or `DEFAULT_INPUT_SPEED` without one."""
    for name in MAX_SPEEDS:
        if rating := gear_set.ratings.get(name):
            return convert(rating.value, rating.unit, "rad/s")
    return DEFAULT_INPUT_SPEED


def _max_torque(gear_set: GearSet, given: float | None) -> float:
    found = max_torque_of(gear_set, given)
    if found is not None:
        return found
    largest = Answer(
        "the largest torque at the output is known, in Python as max_torque",
        files=("--max-torque", NUMBER),
        numbers={"max_torque": "largest torque at the output [N.m]"},
    )
    raise QuestionError(f"{gear_set.name} has no rating {MAX_TORQUES[0]}, so the range of its torsion is not known", [largest])


def _twist_at(gear: Gear, torque: float) -> float:
    """Return a twist at which spring and hysteresis have the torque [rad]."""
    twist = float(gear.stiffness.twist(torque))
    held = float(np.asarray(gear.hysteresis.trace(np.array([0.0, twist])))[-1])
    return float(gear.stiffness.twist(max(torque - held, 0.1 * torque)))


def _loop(twist: float) -> tuple[Array, slice]:
    """Return a path of the twist from rest to both ends and a whole loop after it, and the loop."""
    corners = [0.0, twist, -twist, twist, -twist, twist]
    path = [np.linspace(a, b, LOOP_POINTS, endpoint=False) for a, b in pairwise(corners)]
    whole = np.concatenate([*path, [twist]])
    return whole, slice(3 * LOOP_POINTS, None)


def _width_and_energy(twist: Array, torque: Array) -> tuple[float, float]:
    """Return width at no torque [rad] and area [J] of a loop that begins and ends at its upper corner."""
    half = len(twist) // 2
    down = np.interp(0.0, torque[: half + 1][::-1], twist[: half + 1][::-1])
    up = np.interp(0.0, torque[half:], twist[half:])
    return float(down - up), abs(float(np.trapezoid(torque, twist)))


def _springs(law: Any, twist: float) -> tuple[Spring, ...]:
    """Return springs whose sum is the law up to a twist, exactly if it is linear, cubic, piecewise linear or one of these with
    play; of a law that differs between the senses of twist the mean."""
    match law:
        case stiffness.Linear():
            return (Spring(float(law.k)),)
        case stiffness.Cubic():
            return (Spring(float(law.a1), 0.0, float(law.a3)),)
        case stiffness.Piecewise():
            return _stiffening([0.0, law.knee], [law.k1, law.k1 + law.k2])
        case stiffness.ThreeSegment() if law.k1 <= law.k2 <= law.k3:
            return _stiffening([0.0, float(law.twist(law.t1)), float(law.twist(law.t2))], [law.k1, law.k2, law.k3])
        case stiffness.TwoSided():  # the mean of both senses, as these springs are odd
            mean = 0.5 * (1.0 + float(law.negative_factor))
            return tuple(spring.times(mean) for spring in _springs(law.law, twist))
        case stiffness.Backlash():
            half = 0.5 * float(law.clearance)
            return tuple(replace(spring, gap=spring.gap + half) for spring in _springs(law.law, twist - half))
        case _:
            knots = np.linspace(0.0, twist, FITTED_SEGMENTS + 1)
            slopes = np.diff(np.asarray(law.torque(knots))) / np.diff(knots)
            return _stiffening(knots[:-1].tolist(), np.maximum.accumulate(slopes).tolist())


def _stiffening(knees: Sequence[float], slopes: Sequence[float]) -> tuple[Spring, ...]:
    """Return springs with gaps whose sum has each slope from its knee on."""
    steps = np.diff([0.0, *slopes])
    least = MIN_SLOPE_SHARE * max(slopes)
    return tuple(Spring(float(step), gap=float(knee)) for knee, step in zip(knees, steps, strict=True) if step > least)


def _slips(law: Any, twist: float) -> tuple[tuple[float, float], ...]:
    """Return Maxwell slip elements of a hysteresis, exactly if it has them, else by least squares over the loop to a twist."""
    if isinstance(law, hysteresis.MaxwellSlip):
        return tuple(zip(map(float, law.stiffness), map(float, law.breakaway), strict=True))
    path, loop = _loop(twist)
    target = np.asarray(law.trace(path))[loop]
    if not target.any():
        return ()
    reach = twist * np.geomspace(MIN_SLIP_SHARE, 1.0, MAX_FITTED_SLIPS)
    units = [hysteresis.MaxwellSlip(stiffness=[1.0], breakaway=[float(slip)]) for slip in reach]
    traces = np.stack([np.asarray(unit.trace(path))[loop] for unit in units], axis=1)
    energy = np.trapezoid(traces, path[loop], axis=0) * LOSS_WEIGHT / twist
    wanted = np.append(target, float(np.trapezoid(target, path[loop])) * LOSS_WEIGHT / twist)
    weights, _ = nnls(np.vstack([traces, energy]), wanted)
    return tuple((float(k), float(k * slip)) for k, slip in zip(weights, reach, strict=True) if k > 0.0)


def _friction_at_input(gear: Gear, fast: float) -> ShaftFriction:
    """Return the friction of input and mesh, at the input."""
    at_mesh = _friction_of(gear.friction_mesh, fast / abs(gear.kinematics.ratio), 1.0)
    ratio = abs(float(gear.kinematics.ratio))
    own = _friction_of(gear.friction_input, fast, float(gear.kinematics.ratio))
    return ShaftFriction(own.dry + at_mesh.dry / ratio, own.viscous + at_mesh.viscous / ratio**2, own.bristle)


def _friction_of(law: Any, fast: float, turns: float) -> ShaftFriction:
    """Return a bristle if the law is one, else the least squares of a dry and a viscous part over speeds and angles.

    Args:
        law: of the friction
        fast: largest speed of its shaft [rad/s]
        turns: of its shaft per turn of the output, over which it is averaged
    """
    if isinstance(law, friction.LuGre):
        return ShaftFriction(0.0, float(law.viscous), law)
    forward = np.linspace(CREEP_SHARE * fast, fast, FITTED_SPEEDS)
    angle = _angles(turns)
    speed, where = (each.ravel() for each in np.meshgrid(forward, angle, indexing="ij"))
    both = [np.asarray(law.steady(sense * speed, where, 0.0, ROOM_TEMPERATURE)) * sense for sense in (1.0, -1.0)]
    mean = np.mean(both, axis=0).reshape(len(forward), len(angle)).mean(axis=1)
    columns = np.stack([np.ones_like(forward), forward], axis=1)
    shares = nnls(columns, mean)[0]
    dry, viscous = np.where(shares * columns[-1] > MIN_FRICTION_SHARE * np.abs(mean).max(), shares, 0.0).tolist()
    return ShaftFriction(dry, viscous)


def _angles(turns: float) -> Array:
    angle: Array = np.asarray(2.0 * np.pi * abs(turns) / FITTED_ANGLES * np.arange(FITTED_ANGLES), dtype=np.float64)
    return angle


def _left_out(gear: Gear, torque: float) -> Iterator[str]:
    """Yield what of a gear has no element, each with its size."""
    angle = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    if (error := float(np.abs(np.asarray(gear.kinematic_error.error(angle))).max())) > 0.0:
        slope = float(np.abs(np.asarray(gear.kinematic_error.slope(angle))).max())
        yield (
            f"kinematic error: {1e6 * error:.3g} urad at the output; its reaction, {slope * torque:.3g} N.m at the input under "
            f"{torque:.4g} N.m at the output"
        )
    default = type(gear)()
    for name, words in (
        ("kinematic_noise", "noise of the kinematic error"),
        ("softening", "softening of the spring with temperature"),
        ("stiffness_variation", "variation of the stiffness with the angle"),
        ("structure", "stages of the compliance"),
        ("material", "internal damping of the material"),
    ):
        if getattr(gear, name) != getattr(default, name):
            yield words
    if getattr(getattr(gear.structure, "ring", None), "active", False):
        yield "resonances of the flexspline's ring"
    laws = (gear.friction_input, gear.friction_mesh, gear.friction_output)
    if any(isinstance(law, friction.LoadDependent | friction.TorqueEfficiency) for law in laws):
        yield "friction that grows with the load"
