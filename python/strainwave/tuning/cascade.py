"""A tuned cascade: position around speed, with the feed-forward that every servo drive has, and a disturbance observer."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Compensation, Drive, Gear, _core, arguments, compensation, control, friction, loads, motor, stiffness
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.simulation.excitation import ROOM_TEMPERATURE

Array = NDArray[np.float64]

RIGID_STIFFNESS = 1e9  # N.m/rad: stiffer than any gear of a catalogue by a factor of 100
PHASE_OF_DELAY = 0.5  # rad that the delay takes where the speed loop crosses over: 60 degrees are left
POSITION_SHARE = 0.25  # bandwidth of the position loop over that of the speed loop, so that it does not overshoot
INTEGRAL_SHARE = 0.25  # likewise of the integral of the speed
FAST_SPEED, SLOW_SPEED = 100.0, 1.0  # rad/s of the input, through whose friction the line of Coulomb and viscous friction goes
ANGLES_PER_TURN = 64  # of the input, over which friction is averaged
LIMIT_OF_LEVELS = 20.0  # times friction and weight: torque of a motor without a stated limit, besides that of acceleration
LIMIT_OF_ACCELERATION = 1e4  # rad/s2 of the input
MIN_PERIOD = 1e-5  # s: no controller of a joint is faster, and a motion of a second has 100 000 periods
MAX_VIBRATION = 1e6  # rad/s of the fastest vibration: steps of 1 us, of which a motion of seconds has millions


class SteadyTorque(NamedTuple):
    """Torques at the input beyond the load over the ratio, each in the shape of speed and angle.

    Attributes:
        friction: of all places [N.m], positive where it opposes a positive speed
        reaction: change of the load's torque by the kinematic error [N.m]
    """

    friction: Array
    reaction: Array


def steady_torque(
    gear: Gear, speed: ArrayLike, angle: ArrayLike = 0.0, load: float = 0.0, temperature: float = ROOM_TEMPERATURE
) -> SteadyTorque:
    """Return the torques of a gear that turns steadily.

    Args:
        speed: of the input [rad/s]
        angle: of the input [rad]; speed and angle are broadcast
        load: torque at the output that opposes forward motion [N.m]
        temperature: of the gear [K]
    """
    turning, where = (np.array(each) for each in np.broadcast_arrays(np.asarray(speed, float), np.asarray(angle, float)))
    inverse = 1.0 / gear.kinematics.ratio
    full = np.asarray(gear.kinematic_error.slope(where.ravel())).reshape(where.shape)
    transmitted = np.full(where.shape, load)
    for _ in range(2):  # friction of the output is transmitted too, and eases the error a little
        slope = full / (1.0 + getattr(gear.kinematic_error, "load_sensitivity", 0.0) * np.abs(transmitted))
        per_input = inverse - slope
        at_output = gear.friction_output.steady(turning * per_input, where * inverse, load, temperature)
        transmitted = load + at_output
    at_mesh = gear.friction_mesh.steady(turning * per_input, where * inverse, transmitted, temperature)
    at_input = gear.friction_input.steady(turning, where, per_input * transmitted, temperature)
    return SteadyTorque(np.asarray(at_input + per_input * (at_mesh + at_output)), np.asarray(-load * slope))


@dataclass(frozen=True)
class Plant:
    """A drive as its controller knows it, its own current loop taken as ideal.

    Attributes:
        drive: with a motor that takes a current or a torque
        actuation_per_torque: what the motor takes, per torque [A/(N.m)] or [1]
        limit: largest actuation
        period: of the controller [s]
        delay: from a sample to the output [s]
    """

    drive: Drive
    actuation_per_torque: float
    limit: float
    period: float
    delay: float

    @classmethod
    def read(cls, drive: GearSet | Drive | Gear | str | Path, period: float, delay: float) -> Plant:
        """Return the plant of a set, of a drive, or of a file by its name or path.

        Raises:
            TypeError: `drive` is none of these, or a time is no number
            ValueError: the period is below 10 us, the delay is negative or exceeds the period, and as `of`
        """
        period, delay = arguments.seconds("period", period), arguments.number("delay", delay, "s", "[)", 0.0)
        if period < MIN_PERIOD:
            raise ValueError(f"period = {period:g} s must be {MIN_PERIOD:g} s or more")
        if delay > period:
            raise ValueError(f"delay = {delay:g} s exceeds the period of {period:g} s; take a longer period or a shorter delay")
        return cls.of(gear_set_of(drive), period, delay)

    @classmethod
    def of(cls, gear_set: GearSet, period: float, delay: float) -> Plant:
        """Return the plant of a set."""
        drive, load = gear_set.drive, gear_set.drive.load
        if isinstance(load, loads.Prescribed):
            raise ValueError(f"{gear_set.name}: the load prescribes the motion of the output; give one with an inertia")
        constant = torque_constant(drive.motor)
        inertia = drive.motor.inertia
        ideal = motor.TorqueSource(inertia=inertia) if constant is None else motor.CurrentSource(
            torque_constant=constant, inertia=inertia)  # fmt: skip
        per_torque = 1.0 if constant is None else 1.0 / constant
        limit = getattr(drive.motor, "current_limit", None) or per_torque * _usual_limit(drive)
        plain = drive.replace(motor=ideal, control=control.OpenLoop())
        if (vibration := _core.max_rate(plain, 0.0)) > MAX_VIBRATION:
            raise ValueError(
                f"{gear_set.name}: load and gear vibrate at up to {vibration:.3g} rad/s, and {MAX_VIBRATION:g} are the most; "
                f"load.inertia is {load.inertia:g} kg.m2: state that of the real load"
            )
        return cls(plain, per_torque, float(limit), period, delay)

    @property
    def ratio(self) -> float:
        """Signed ratio of the gear."""
        return float(self.drive.gear.kinematics.ratio)

    @property
    def effort_unit(self) -> str:
        """Unit of what the motor takes."""
        return "A" if type(self.drive.motor) is motor.CurrentSource else "N.m"

    @property
    def input_inertia(self) -> float:
        """Inertia of rotor and wave generator [kg.m2]."""
        return float(self.drive.motor.inertia + self.drive.gear.input_inertia)

    @property
    def total_inertia(self) -> float:
        """The same with that of the load over the ratio squared [kg.m2]."""
        load: Any = self.drive.load
        return float(self.input_inertia + load.inertia / self.ratio**2)

    @property
    def start_temperature(self) -> float:
        """Temperature of the gear at the begin of a motion [K]."""
        return float(getattr(self.drive.thermal, "initial_temperature", ROOM_TEMPERATURE))

    def controlled(self, law: Any, added: Compensation) -> Drive:
        """Return the drive under a sampled law with a compensation."""
        sampled = control.Sampled(law=law, compensation=added, period=self.period, delay=self.delay)
        return self.drive.replace(control=sampled)


def torque_constant(part: Any) -> float | None:
    """Return the torque per current of a motor [N.m/A]; None if it takes a torque."""
    if type(part) is motor.TorqueSource:
        return None
    if type(part) is motor.PMSM:
        return float(1.5 * part.pole_pairs * part.flux_linkage)
    if (constant := getattr(part, "torque_constant", None)) is None:
        raise ValueError(
            f"a motor that takes {type(part).__name__} is not compensated; give one that takes a current or a torque"
        )
    return float(constant)


def _usual_limit(drive: Drive) -> float:
    """Return the torque of a motor that states no limit [N.m]."""
    coulomb, _ = line_of_friction(drive.gear)
    load: Any = drive.load
    ratio = abs(drive.gear.kinematics.ratio)
    inertia = drive.motor.inertia + drive.gear.input_inertia + load.inertia / ratio**2
    levels = coulomb + getattr(load, "gravity_torque", 0.0) / ratio
    return float(LIMIT_OF_LEVELS * levels + LIMIT_OF_ACCELERATION * inertia)


def line_of_friction(gear: Gear, temperature: float = ROOM_TEMPERATURE) -> tuple[float, float]:
    """Return Coulomb [N.m] and viscous friction [N.m.s/rad] at the input: the line through its mean at two speeds."""
    turn = np.linspace(0.0, 2.0 * np.pi, ANGLES_PER_TURN, endpoint=False)
    slow, fast = (
        float(steady_torque(gear, speed, turn, temperature=temperature).friction.mean()) for speed in (SLOW_SPEED, FAST_SPEED)
    )
    viscous = max((fast - slow) / (FAST_SPEED - SLOW_SPEED), 0.0)
    return max(slow - viscous * SLOW_SPEED, 0.0), viscous


def bare(gear: Gear, temperature: float = ROOM_TEMPERATURE) -> Gear:
    """Return a gear of which only the ratio, the inertia and the line of its friction at a temperature [K] are known."""
    coulomb, viscous = line_of_friction(gear, temperature)
    law = friction.Coulomb(coulomb=coulomb, viscous=viscous)
    spring = stiffness.Linear(k=RIGID_STIFFNESS)
    return Gear(kinematics=gear.kinematics, stiffness=spring, friction_input=law, input_inertia=gear.input_inertia)


@dataclass(frozen=True)
class Setting:
    """Tuning parameters of a cascade.

    Attributes:
        sharpness: of its loops; at 1 the delay takes `PHASE_OF_DELAY` where the speed loop crosses over
        feedback: encoder on which the position loop closes
        observer_share: bandwidth of the disturbance observer over that of the speed loop; 0 for none
    """

    sharpness: float
    feedback: str
    observer_share: float


def tuned_law(plant: Plant, setting: Setting) -> Any:
    """Return position around speed, as fast as the delay lets it be times the sharpness.

    The speed loop crosses over on the inertia of the input alone, as it does above the vibration of the load, where the delay
    takes 0.5 rad times the sharpness. It feeds nothing forward but the speed: what is fed forward besides belongs to the
    compensation, so that an observer does not supply it once more.
    """
    bandwidth, per_torque = speed_bandwidth(plant, setting), plant.actuation_per_torque
    gain = bandwidth * plant.total_inertia
    return control.PositionSpeed(
        position_gain=POSITION_SHARE * bandwidth,
        speed_proportional=per_torque * gain,
        speed_integral=per_torque * gain * INTEGRAL_SHARE * bandwidth,
        speed_feedforward=1.0,
        limit=plant.limit,
        speed_limit=1e4,
        feedback=setting.feedback,
    )


def speed_bandwidth(plant: Plant, setting: Setting) -> float:
    """Return the bandwidth of the speed loop below the vibration of the load [rad/s]."""
    late = plant.delay + 0.5 * plant.period
    return setting.sharpness * PHASE_OF_DELAY / late * plant.input_inertia / plant.total_inertia


def observer_of(plant: Plant, setting: Setting) -> compensation.DisturbanceObserver | compensation.NoObserver:
    """Return the disturbance observer of a setting."""
    if not setting.observer_share:
        return compensation.NoObserver()
    return compensation.DisturbanceObserver(
        inertia=plant.total_inertia,
        bandwidth=setting.observer_share * speed_bandwidth(plant, setting),
        limit=plant.limit / plant.actuation_per_torque,
    )


def model_of(plant: Plant, gear: Gear) -> compensation.ModelFeedforward:
    """Return the feed-forward of a model of the drive: its load, and a gear with the effects that it is to compensate."""
    inertia = float(plant.drive.motor.inertia)
    return compensation.ModelFeedforward(
        gear=gear, load=plant.drive.load, motor_inertia=inertia, temperature=plant.start_temperature
    )
