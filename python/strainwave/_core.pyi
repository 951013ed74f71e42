"""The physics, compiled."""

from collections.abc import Callable, Sequence
import enum
import pathlib
from typing import Any

import numpy
import numpy.typing

from strainwave import (
    compensation as compensation,
    control as control,
    fault as fault,
    friction as friction,
    hysteresis as hysteresis,
    kinematic_error as kinematic_error,
    kinematics as kinematics,
    loads as loads,
    meter as meter,
    motor as motor,
    onset as onset,
    sensor as sensor,
    softening as softening,
    stiffness as stiffness,
    structure as structure,
    thermal as thermal,
    variation as variation
)
import strainwave.compensation
import strainwave.control
import strainwave.friction
import strainwave.hysteresis
import strainwave.kinematic_error
import strainwave.kinematics
import strainwave.loads
import strainwave.meter
import strainwave.motor
import strainwave.sensor
import strainwave.simulation.state
import strainwave.softening
import strainwave.stiffness
import strainwave.structure
import strainwave.thermal
import strainwave.variation


families: dict[str, dict[str, type[Any]]]

class PassivityWarning(UserWarning):
    """A set of parameters lets its model create energy."""

class Gear:
    """
    One strain wave gear: rigid motion, kinematic error, stiffness, hysteresis, damping, friction at three places.

    .. math:: \\delta = \\theta_{in}/i - \\theta_{out} - e(\\theta_{in}), \\qquad
              T = T_{stiffness}(\\delta) + T_{hysteresis}(\\delta, \\text{history}) + c\\,\\dot\\delta

    T acts on the output and, as T (1/i - e'(theta_in)), on the input. The e' term is the reaction of the error on the
    input: the review derives none (E-R3) and the actuator paper omits it (E-A5), but without it energy is not conserved.
    e is the deterministic kinematic error plus the noise, whose amplitude follows the elastic torque and the input speed.

    Friction acts at the input (wave generator), at the mesh, and at the output (bearing). The mesh lies between the
    kinematics and the spring: it moves with (1/i - e') times the input speed, at the output's scale, transmits T, and
    what it takes weighs on the input. Every law of friction may stand at every place, each under the load that its place
    transmits, the angle it stands at and the temperature.

    Where the stiffness varies with the angle of the wave generator, the energy in the spring turns the wave generator, too.
    A ``structure`` says whether the bodies within the gear move by themselves, between input shaft and output shaft.

    What two parts are told alike must agree: the ratio, the teeth, and, with stages, pitch radius and pressure angle.

    Every part is a law of its own, from the ideal gear to one with all effects over the whole envelope of speed, load and
    temperature; change one with ``gear.replace(hysteresis=...)``.

    >>> import strainwave as sw
    >>> gear = sw.Gear(stiffness=sw.stiffness.Cubic(a1=1.2e4, a3=1e9), damping=10.0)
    >>> gear.stiffness.a1
    12000.0

    Parameters
    ----------
    kinematics: Rigid motion: teeth and fixed member; default StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed='circular_spline')
    kinematic_error: Pure kinematic error at the output, over the input angle; default Fourier(order=(), amplitude=(), phase=())
    kinematic_noise: Random kinematic error, added to the deterministic one; default Stochastic(amplitude=0.0, lowest_order=8.0, highest_order=40.0, seed=0.0, load_sensitivity=0.0, speed_sensitivity=0.0, insertion_depth=0.0, depth_sensitivity=0.0)
    stiffness: Elastic torque over the twist; default Linear(k=10000.0)
    hysteresis: Torque that depends on the history of the twist; default MaxwellSlip(stiffness=(), breakaway=())
    damping: Torque per rate of twist [N.m.s/rad], in [0, inf); default 0.0
    friction_input: Friction at the wave generator, over the input speed; default Viscous(viscous=0.0)
    friction_mesh: Friction of the mesh, at the output's scale, over the speed of the input referred to it; default Viscous(viscous=0.0)
    friction_output: Friction at the output, over the output speed; default Viscous(viscous=0.0)
    input_inertia: Inertia of the wave generator [kg.m2], in [0, inf); default 0.0
    softening: How stiffness and hysteresis give way as the gear warms up; default ThermalSoftening(stiffness_fall=0.0, hysteresis_fall=0.0, reference_temperature=293.15)
    stiffness_variation: How the stiffness varies as the wave generator turns; default Constant()
    structure: What moves within the gear by itself; default Lumped()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    physics: document R, sections 1-4, with the reaction of the kinematic error (errata E-R3, E-A5); for the bodies within it, document A
    """

    def __init__(self, *, kinematics: strainwave.kinematics.StrainWave | strainwave.kinematics.PlainRatio = ..., kinematic_error: strainwave.kinematic_error.Fourier | strainwave.kinematic_error.Misalignment | strainwave.kinematic_error.ToothErrors | strainwave.kinematic_error.Scaled = ..., kinematic_noise: strainwave.kinematic_error.Stochastic = ..., stiffness: strainwave.stiffness.Linear | strainwave.stiffness.Piecewise | strainwave.stiffness.ThreeSegment | strainwave.stiffness.Cubic | strainwave.stiffness.MultiCompliance | strainwave.stiffness.Backlash = ..., hysteresis: strainwave.hysteresis.MaxwellSlip | strainwave.hysteresis.FadingMemory | strainwave.hysteresis.BoucWen | strainwave.hysteresis.Preisach | strainwave.hysteresis.Regimes | strainwave.hysteresis.FrictionalWindup = ..., damping: float = ..., friction_input: strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal = ..., friction_mesh: strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal = ..., friction_output: strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal = ..., input_inertia: float = ..., softening: strainwave.softening.ThermalSoftening = ..., stiffness_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ..., structure: strainwave.structure.Lumped | strainwave.structure.Staged = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, kinematics: strainwave.kinematics.StrainWave | strainwave.kinematics.PlainRatio = ..., kinematic_error: strainwave.kinematic_error.Fourier | strainwave.kinematic_error.Misalignment | strainwave.kinematic_error.ToothErrors | strainwave.kinematic_error.Scaled = ..., kinematic_noise: strainwave.kinematic_error.Stochastic = ..., stiffness: strainwave.stiffness.Linear | strainwave.stiffness.Piecewise | strainwave.stiffness.ThreeSegment | strainwave.stiffness.Cubic | strainwave.stiffness.MultiCompliance | strainwave.stiffness.Backlash = ..., hysteresis: strainwave.hysteresis.MaxwellSlip | strainwave.hysteresis.FadingMemory | strainwave.hysteresis.BoucWen | strainwave.hysteresis.Preisach | strainwave.hysteresis.Regimes | strainwave.hysteresis.FrictionalWindup = ..., damping: float = ..., friction_input: strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal = ..., friction_mesh: strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal = ..., friction_output: strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal = ..., input_inertia: float = ..., softening: strainwave.softening.ThermalSoftening = ..., stiffness_variation: strainwave.variation.Constant | strainwave.variation.Periodic = ..., structure: strainwave.structure.Lumped | strainwave.structure.Staged = ...) -> Gear:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def kinematics(self) -> strainwave.kinematics.StrainWave | strainwave.kinematics.PlainRatio:
        """Rigid motion: teeth and fixed member"""

    @property
    def kinematic_error(self) -> strainwave.kinematic_error.Fourier | strainwave.kinematic_error.Misalignment | strainwave.kinematic_error.ToothErrors | strainwave.kinematic_error.Scaled:
        """Pure kinematic error at the output, over the input angle"""

    @property
    def kinematic_noise(self) -> strainwave.kinematic_error.Stochastic:
        """Random kinematic error, added to the deterministic one"""

    @property
    def stiffness(self) -> strainwave.stiffness.Linear | strainwave.stiffness.Piecewise | strainwave.stiffness.ThreeSegment | strainwave.stiffness.Cubic | strainwave.stiffness.MultiCompliance | strainwave.stiffness.Backlash:
        """Elastic torque over the twist"""

    @property
    def hysteresis(self) -> strainwave.hysteresis.MaxwellSlip | strainwave.hysteresis.FadingMemory | strainwave.hysteresis.BoucWen | strainwave.hysteresis.Preisach | strainwave.hysteresis.Regimes | strainwave.hysteresis.FrictionalWindup:
        """Torque that depends on the history of the twist"""

    @property
    def damping(self) -> float:
        """Torque per rate of twist [N.m.s/rad]"""

    @property
    def friction_input(self) -> strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal:
        """Friction at the wave generator, over the input speed"""

    @property
    def friction_mesh(self) -> strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal:
        """
        Friction of the mesh, at the output's scale, over the speed of the input referred to it
        """

    @property
    def friction_output(self) -> strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal:
        """Friction at the output, over the output speed"""

    @property
    def input_inertia(self) -> float:
        """Inertia of the wave generator [kg.m2]"""

    @property
    def softening(self) -> strainwave.softening.ThermalSoftening:
        """How stiffness and hysteresis give way as the gear warms up"""

    @property
    def stiffness_variation(self) -> strainwave.variation.Constant | strainwave.variation.Periodic:
        """How the stiffness varies as the wave generator turns"""

    @property
    def structure(self) -> strainwave.structure.Lumped | strainwave.structure.Staged:
        """What moves within the gear by itself"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'gear'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    def save(self, path: str | pathlib.Path, *, name: str, source: str) -> None:
        """Writes a gear file, as `strainwave.save` does."""

    def trace(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), of spring and hysteresis along a slow path of `twist` [rad], shape (n,), from twist 0 and without history.
        """

    def twist(self, torque: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Twist [rad], shape (n,), along a slow path of `torque` [N.m], shape (n,), as a rig applies it; the inverse of `trace`, to rounding, for every spring and hysteresis.
        """

    @staticmethod
    def from_datasheet(ratio: float, **figures: Any) -> Gear: ...

class Compensation:
    """
    Lead of the input and torque that a sampled controller adds: those of a model, a dither, a learner and an observer.

    .. math:: \\theta_r = i r + \\theta_f + \\theta_l, \\qquad u_f = p\\,(\\tau_f + \\tau_d + \\tau_l + \\tau_o) + q\\,\\dot\\theta_r

    with r the commanded output angle, theta_f, theta_l the leads of the input by feed-forward and learner, tau_f, tau_d, tau_l,
    tau_o the torques of feed-forward, dither, learner and observer; p = actuation_per_torque, q = actuation_per_speed. The
    controller follows theta_r with the input and r with the output. It adds u_f to its actuation before any limit.

    p is 1 if the motor takes a torque, and 1 over the torque constant if it takes a current, and for a Cascade. For a motor that
    takes a voltage p is resistance over torque constant, and q the back-EMF constant.

    >>> import strainwave as sw
    >>> part = sw.Compensation(observer=sw.compensation.DisturbanceObserver(inertia=2e-4, limit=0.3))
    >>> sw.control.Sampled(law=sw.control.PositionSpeed(), compensation=part).compensation.observer.limit
    0.3

    Parameters
    ----------
    feedforward: Feed-forward of a model of the drive; default NoFeedforward()
    learning: Learning of errors that repeat; default NoLearning()
    observer: Observer of what the model lacks; default NoObserver()
    dither: Torque that swings around zero; default NoDither()
    actuation_per_torque: Actuation of the motor per torque, p [1/(N.m)], in (0, inf); default 1.0
    actuation_per_speed: Actuation of the motor per input speed, q: its back-EMF [s/rad]; default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, feedforward: strainwave.compensation.NoFeedforward | strainwave.compensation.ModelFeedforward | strainwave.compensation.LostMotionMap = ..., learning: strainwave.compensation.NoLearning | strainwave.compensation.AdaptiveFourier | strainwave.compensation.Repetitive | strainwave.compensation.IterativeLearning | strainwave.compensation.TwistIdentification = ..., observer: strainwave.compensation.NoObserver | strainwave.compensation.DisturbanceObserver | strainwave.compensation.FrictionScale | strainwave.compensation.BristleObserver = ..., dither: strainwave.compensation.NoDither | strainwave.compensation.Dither = ..., actuation_per_torque: float = ..., actuation_per_speed: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, feedforward: strainwave.compensation.NoFeedforward | strainwave.compensation.ModelFeedforward | strainwave.compensation.LostMotionMap = ..., learning: strainwave.compensation.NoLearning | strainwave.compensation.AdaptiveFourier | strainwave.compensation.Repetitive | strainwave.compensation.IterativeLearning | strainwave.compensation.TwistIdentification = ..., observer: strainwave.compensation.NoObserver | strainwave.compensation.DisturbanceObserver | strainwave.compensation.FrictionScale | strainwave.compensation.BristleObserver = ..., dither: strainwave.compensation.NoDither | strainwave.compensation.Dither = ..., actuation_per_torque: float = ..., actuation_per_speed: float = ...) -> Compensation:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def feedforward(self) -> strainwave.compensation.NoFeedforward | strainwave.compensation.ModelFeedforward | strainwave.compensation.LostMotionMap:
        """Feed-forward of a model of the drive"""

    @property
    def learning(self) -> strainwave.compensation.NoLearning | strainwave.compensation.AdaptiveFourier | strainwave.compensation.Repetitive | strainwave.compensation.IterativeLearning | strainwave.compensation.TwistIdentification:
        """Learning of errors that repeat"""

    @property
    def observer(self) -> strainwave.compensation.NoObserver | strainwave.compensation.DisturbanceObserver | strainwave.compensation.FrictionScale | strainwave.compensation.BristleObserver:
        """Observer of what the model lacks"""

    @property
    def dither(self) -> strainwave.compensation.NoDither | strainwave.compensation.Dither:
        """Torque that swings around zero"""

    @property
    def actuation_per_torque(self) -> float:
        """Actuation of the motor per torque, p [1/(N.m)]"""

    @property
    def actuation_per_speed(self) -> float:
        """Actuation of the motor per input speed, q: its back-EMF [s/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'compensation'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""

fault_families: dict[str, dict[str, type[Any]]]

class Signal:
    """
    A command or another input over time, as the compiled loops know it: a line in pieces, and waves.
    """

    def __init__(self, start: numpy.typing.NDArray[numpy.float64], level: numpy.typing.NDArray[numpy.float64], slope: numpy.typing.NDArray[numpy.float64], waves: numpy.typing.NDArray[numpy.float64]) -> None:
        """
        Pieces of a line, shape (n,) each, and amplitude, frequency, sweep and phase of each wave, shape (m, 4).
        """

    def at(self, instants: numpy.typing.NDArray[numpy.float64], before: bool) -> numpy.typing.NDArray[numpy.float64]:
        """Values and rates at `instants` [s], or just before them: shape (2, …)."""

def inputs(command: Signal, load: Signal, temperature: Signal, instants: numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
    """
    Command, input of the load and temperature, each with its rate, at start, middle and end of each step: shape (n, 3, 6).
    """

def grid(step: float, duration: float, tolerance: float) -> numpy.typing.NDArray[numpy.float64]:
    """
    0, step, 2 step, … and `duration`, from which the one before is further than `tolerance`.
    """

def time_grid(steps: numpy.typing.NDArray[numpy.float64], samples: numpy.typing.NDArray[numpy.float64], breaks: numpy.typing.NDArray[numpy.float64], tolerance: float) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.uint8], float]:
    """
    All instants in order, whatever is within `tolerance` of its neighbour being one, which of them are samples, and the longest step from one to the next.
    """

class Sensors:
    """
    What the controller of a drive sees: one sensor for each quantity.

    Recordings show the quantities themselves, not what sensors make of them.

    >>> import strainwave as sw
    >>> sensors = sw.Sensors(output_angle=sw.sensor.FirstOrder(time_constant=2e-3))
    >>> sensors.output_angle.time_constant
    0.002

    Parameters
    ----------
    input_angle: Sensor of the input angle: the motor's encoder; default Ideal()
    input_speed: Sensor of the input speed; default Ideal()
    output_angle: Sensor of the output angle; default Ideal()
    output_speed: Sensor of the output speed; default Ideal()
    current: Sensor of the motor current; default Ideal()
    torque: Sensor of the torque transmitted, at the output; default Ideal()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, input_angle: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., input_speed: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., output_angle: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., output_speed: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., current: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., torque: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, input_angle: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., input_speed: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., output_angle: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., output_speed: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., current: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ..., torque: strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised = ...) -> Sensors:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def input_angle(self) -> strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised:
        """Sensor of the input angle: the motor's encoder"""

    @property
    def input_speed(self) -> strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised:
        """Sensor of the input speed"""

    @property
    def output_angle(self) -> strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised:
        """Sensor of the output angle"""

    @property
    def output_speed(self) -> strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised:
        """Sensor of the output speed"""

    @property
    def current(self) -> strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised:
        """Sensor of the motor current"""

    @property
    def torque(self) -> strainwave.sensor.Ideal | strainwave.sensor.Gain | strainwave.sensor.FirstOrder | strainwave.sensor.SecondOrder | strainwave.sensor.Encoder | strainwave.sensor.Delayed | strainwave.sensor.Noisy | strainwave.sensor.Quantised:
        """Sensor of the torque transmitted, at the output"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'sensors'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class Drive:
    """
    A motor, its controller, one strain wave gear, a load, and the sensors through which the controller sees the drive.

    .. math:: J_{in} \\ddot\\theta_{in} = \\tau - (T + F_{mesh})\\,(1/i - e') - F_{in}, \\qquad
              J_{out} \\ddot\\theta_{out} = T - T_{load} - F_{out}

    with tau the torque of the motor, J_in = motor.inertia + gear.input_inertia, J_out = load.inertia, T and e' of the gear,
    F the friction of each place. A load can also prescribe the motion of the output shaft, a motor that of the input. The temperature of a run is that
    of gear and winding, unless the drive has a thermal model: then it is that around them.
    Where set-valued friction of the input and of the mesh hold the input together, the torque that each holds cannot be
    told apart: it is reported in proportion to what each can hold.
    Angles are carried relative to the rigid motion, so an hour of rotation is as accurate as a second.

    >>> import strainwave as sw
    >>> drive = sw.Drive(motor=sw.motor.DC(resistance=2.0), load=sw.loads.Inertia(inertia=0.005))
    >>> drive.motor.resistance
    2.0

    Parameters
    ----------
    gear: The gear; default Gear(kinematics=StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed='circular_spline'), kinematic_error=Fourier(order=(), amplitude=(), phase=()), kinematic_noise=Stochastic(amplitude=0.0, lowest_order=8.0, highest_order=40.0, seed=0.0, load_sensitivity=0.0, speed_sensitivity=0.0, insertion_depth=0.0, depth_sensitivity=0.0), stiffness=Linear(k=10000.0), hysteresis=MaxwellSlip(stiffness=(), breakaway=()), damping=0.0, friction_input=Viscous(viscous=0.0), friction_mesh=Viscous(viscous=0.0), friction_output=Viscous(viscous=0.0), input_inertia=0.0, softening=ThermalSoftening(stiffness_fall=0.0, hysteresis_fall=0.0, reference_temperature=293.15), stiffness_variation=Constant(), structure=Lumped())
    motor: The motor on the input shaft; default DC(resistance=1.0, inductance=0.0, torque_constant=0.05, back_emf=0.05, inertia=1e-05, brush_drop=0.0, resistance_rise=0.0, cogging_torque=0.0, cogging_order=24.0)
    control: What turns the command into the motor's voltage, current or torque; default OpenLoop(gain=1.0)
    load: What the output shaft carries; default Inertia(inertia=0.01)
    sensors: What the controller sees the drive through; default Sensors(input_angle=Ideal(), input_speed=Ideal(), output_angle=Ideal(), output_speed=Ideal(), current=Ideal(), torque=Ideal())
    thermal: How warm gear and winding become; default Isothermal()
    meter: What is measured of powers and energies; default NoMeter()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document P, eqs. of motion, with r = 1/100 (E-P1) in the motor equation too (E-P2)
    """

    def __init__(self, *, gear: Gear = ..., motor: strainwave.motor.DC | strainwave.motor.BrushlessDC | strainwave.motor.PMSM | strainwave.motor.TorqueSource | strainwave.motor.CurrentSource | strainwave.motor.AccelerationSource = ..., control: strainwave.control.OpenLoop | strainwave.control.PID | strainwave.control.PI | strainwave.control.PositionSpeed | strainwave.control.Cascade | strainwave.control.LeadLag | strainwave.control.StateFeedback | strainwave.control.StateSpace | strainwave.control.FeedbackLinearisation | strainwave.control.KinematicErrorTracking | strainwave.control.Sampled = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed = ..., sensors: Sensors = ..., thermal: strainwave.thermal.Isothermal | strainwave.thermal.Heating = ..., meter: strainwave.meter.NoMeter | strainwave.meter.EnergyMeter = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gear: Gear = ..., motor: strainwave.motor.DC | strainwave.motor.BrushlessDC | strainwave.motor.PMSM | strainwave.motor.TorqueSource | strainwave.motor.CurrentSource | strainwave.motor.AccelerationSource = ..., control: strainwave.control.OpenLoop | strainwave.control.PID | strainwave.control.PI | strainwave.control.PositionSpeed | strainwave.control.Cascade | strainwave.control.LeadLag | strainwave.control.StateFeedback | strainwave.control.StateSpace | strainwave.control.FeedbackLinearisation | strainwave.control.KinematicErrorTracking | strainwave.control.Sampled = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed = ..., sensors: Sensors = ..., thermal: strainwave.thermal.Isothermal | strainwave.thermal.Heating = ..., meter: strainwave.meter.NoMeter | strainwave.meter.EnergyMeter = ...) -> Drive:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def gear(self) -> Gear:
        """The gear"""

    @property
    def motor(self) -> strainwave.motor.DC | strainwave.motor.BrushlessDC | strainwave.motor.PMSM | strainwave.motor.TorqueSource | strainwave.motor.CurrentSource | strainwave.motor.AccelerationSource:
        """The motor on the input shaft"""

    @property
    def control(self) -> strainwave.control.OpenLoop | strainwave.control.PID | strainwave.control.PI | strainwave.control.PositionSpeed | strainwave.control.Cascade | strainwave.control.LeadLag | strainwave.control.StateFeedback | strainwave.control.StateSpace | strainwave.control.FeedbackLinearisation | strainwave.control.KinematicErrorTracking | strainwave.control.Sampled:
        """What turns the command into the motor's voltage, current or torque"""

    @property
    def load(self) -> strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed:
        """What the output shaft carries"""

    @property
    def sensors(self) -> Sensors:
        """What the controller sees the drive through"""

    @property
    def thermal(self) -> strainwave.thermal.Isothermal | strainwave.thermal.Heating:
        """How warm gear and winding become"""

    @property
    def meter(self) -> strainwave.meter.NoMeter | strainwave.meter.EnergyMeter:
        """What is measured of powers and energies"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'drive'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    def rest(self) -> strainwave.simulation.state.State:
        """The state at rest, untwisted and without history, input angle 0."""

    def step(self, state: strainwave.simulation.state.State, *, command: float = 0.0, command_rate: float = 0.0, load_torque: float = 0.0, brake_torque: float = 0.0, output_angle: float = 0.0, output_speed: float = 0.0, temperature: float = 293.15, dt: float) -> strainwave.simulation.state.State:
        """
        The state `dt` [s] later, the command moving at `command_rate`; where the load prescribes the motion of the output shaft, that at `output_speed` from `output_angle`. A sampled controller acts within the step. `ValueError` for a state of another drive, for what is not finite, for a `dt` or a `temperature` that is not positive, and where a part is not valid; `FloatingPointError` if the step diverges.
        """

def outputs(drive: Drive) -> list[tuple[str, str, str, str, int]]:
    """
    Name, unit, doc, part and channel of each number that a drive shows of itself.
    """

def load_input(drive: Drive) -> tuple[str, str, str]:
    """Name, unit and doc of the input that the load of a drive takes."""

def actuation(drive: Drive) -> tuple[str, str]:
    """
    The output of a drive's motor that is what the controller gives it, and its unit.
    """

def command_unit(drive: Drive) -> str:
    """The unit of the command of a drive."""

def schedule(drive: Drive, state: numpy.typing.NDArray[numpy.float64]) -> tuple[float, float, float]:
    """
    When a sampled controller acts: time to its next sample, period and delay [s]. A period of 0: it acts all the time.
    """

def natural_frequency(drive: Drive, twist: float, temperature: float = 293.15) -> float:
    """
    The fastest angular frequency [rad/s] at which gear and load vibrate at twists up to `twist` [rad], where a run of this `temperature` [K] begins.
    """

def max_rate(drive: Drive, twist: float, temperature: float = 293.15) -> float:
    """
    The fastest that fixed steps must follow at twists up to `twist` [rad], as an angular frequency [rad/s], where a run of this `temperature` [K] begins: the vibration of gear and load, the decay of speeds, sensors and controller.
    """

def bristle_frequency(drive: Drive) -> float:
    """
    The fastest angular frequency [rad/s] at which a shaft vibrates on the bristles that hold it.
    """

def now(drive: Drive, state: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
    """All channels in `state`, shape (channels, 1)."""

def measured(drive: Drive, state: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
    """
    What a controller sees through the sensors: input angle and speed, output angle and speed, current, torque; then the least and the largest actuation that the motor can follow.
    """

def differentiate_rates(drive: Drive, state: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64]) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
    """
    Rates of the n continuous numbers, then outputs, shape (n + channels,), in `state`, and derivatives by those numbers and the inputs, shape (n + 6, n + channels).
    """

def state(drive: Drive) -> tuple[list[tuple[str, str, str]], int]:
    """
    Name, unit and part of each number of a drive's state, and how many of them are continuous; those come first.
    """

def shape(drive: Drive) -> dict[str, tuple[str, str]]:
    """
    Of each part that has a state, the name of its model and the counts that say which number means what.
    """

quantities: tuple[tuple[str, str, str], ...]

def started(drive: Drive, quantities: Sequence[int], values: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
    """
    The state in which some quantities are known and the rest has settled; its transmission error is not finite where there is none.
    """

def aged(drive: Drive, state: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64], dt: float) -> numpy.typing.NDArray[numpy.float64]:
    """
    `state` with what friction remembers after `dt` [s] at constant speeds.
    """

def advance_hysteresis(drive: Drive, state: numpy.typing.NDArray[numpy.float64], twist: float) -> numpy.typing.NDArray[numpy.float64]:
    """`state` with its hysteresis brought up to date at `twist` [rad]."""

def consistent(drive: Drive, state: numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
    """
    `state` with the slip direction of each shaft as its speed and its law have it.
    """

def break_away(drive: Drive, state: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
    """
    `state` with those shafts slipping that stick and are driven beyond what holds them.
    """

def begin(drive: Drive, state: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
    """
    `state` as a run begins in it: consistent, and sampled if its controller samples.
    """

def differentiate_loop(gear: Gear, twist: numpy.typing.NDArray[numpy.float64], parameters: Sequence[int]) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
    """
    Quasi-static torque [N.m] along a path of twist [rad], virgin at its first point, and derivatives, shape (parameters + 1, n), the last by a shift of all points but the first.
    """

def differentiate_steady(gear: Gear, speed: numpy.typing.NDArray[numpy.float64], angle: numpy.typing.NDArray[numpy.float64], load: numpy.typing.NDArray[numpy.float64], temperature: numpy.typing.NDArray[numpy.float64], parameters: Sequence[int]) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
    """
    Steady friction torque [N.m] at the input over speed [rad/s], angle [rad] and load [N.m] of the input and temperature [K], each of shape (n,), and derivatives, shape (parameters, n).
    """

def parameters(model: object) -> list[tuple[str, float, str, str, float, float]]:
    """
    Every number of a set of parameters: path, value, unit, doc, lower and upper limit.
    """

def parts(drive: Drive) -> tuple[list[int], list[int], numpy.typing.NDArray[numpy.float64]]:
    """
    The laws that a drive has chosen, its other whole numbers (counts, teeth, options), and its numbers.
    """

def with_numbers(model: Any, numbers: Sequence[float]) -> Any:
    """The same models with other numbers, in the order of `parameters`."""

max_lanes: int = 8

slopes: int = 4

largest: float = 1000000000000000.0

class Method(enum.Enum):
    """How steps are taken."""

    exponential = 0

    moreau_jean = 1

    rosenbrock = 2

def simulate(drive: Drive, start: numpy.typing.NDArray[numpy.float64], instants: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64], keep: numpy.typing.NDArray[numpy.uint8], method: Method, recorded: Sequence[int], out: numpy.typing.NDArray[numpy.float64], first: int, progress: Callable[[int], None] | None = None) -> numpy.typing.NDArray[numpy.float64]:
    """
    The state at the end; the outputs go to `out`, shape (recorded, samples), from sample `first` on.
    """

def simulate_adaptively(drive: Drive, start: numpy.typing.NDArray[numpy.float64], command: Signal, load: Signal, temperature: Signal, ends: numpy.typing.NDArray[numpy.float64], relative: float, absolute: float, max_steps: int, samples: numpy.typing.NDArray[numpy.float64], recorded: Sequence[int], out: numpy.typing.NDArray[numpy.float64], first: int, progress: Callable[[int], None] | None = None) -> tuple[numpy.typing.NDArray[numpy.float64], int, int]:
    """
    The state at the end, steps taken and steps given up. Steps end at all of `ends` [s], between which no signal jumps; the outputs at `samples` [s] go to `out`, shape (recorded, samples), from sample `first` on.
    """

def simulate_many(drive: Drive, numbers: Sequence[int], values: numpy.typing.NDArray[numpy.float64], initial: tuple[Sequence[int], numpy.typing.NDArray[numpy.float64]] | None, instants: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64], keep: numpy.typing.NDArray[numpy.uint8], recorded: Sequence[int], max_rate: float, threads: int, out: numpy.typing.NDArray[numpy.float64], progress: Callable[[int], None] | None = None) -> tuple[numpy.typing.NDArray[numpy.bool_], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], dict[int, str]]:
    """
    Runs members, whose outputs go to `out`, shape (recorded, members, 1 + kept). Of each: whether it ran and no output, recorded or not, is beyond `largest`, its largest twist [rad], the fastest that steps had to follow up to there, and the vibration of a shaft on its bristles [rad/s]; and why members ended early, if any did. `values`, shape (numbers, members), takes the place of the numbered parameters. Members that are faster by themselves than `max_rate` at rest are not run. `initial` has quantities known at the start, and their values, shape (quantities, members); all begin at rest if there is none.
    """

def member_starts(drive: Drive, numbers: Sequence[int], values: numpy.typing.NDArray[numpy.float64], initial: tuple[Sequence[int], numpy.typing.NDArray[numpy.float64]] | None, inputs: numpy.typing.NDArray[numpy.float64], threads: int) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], dict[int, str]]:
    """
    The parameters of each member and the numbers of the state in which it begins, not-a-number where it cannot, and why it cannot; the arguments are those of `simulate_many`.
    """

def no_beginning(known: bool) -> str:
    """
    Says that a run cannot begin, where quantities are known at the start or only the motion that the load prescribes.
    """

def instruction_set() -> str:
    """The instruction set that kernels are compiled for."""

def inverse_dynamics(drive: Drive, motion: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64], parameters: Sequence[int]) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
    """
    Torque [N.m] that the motor must give for each motion of the input, shape (n,), and derivatives, shape (parameters, n). A motion is angle [rad], speed [rad/s], acceleration [rad/s2] and the time since the motion before [s], 0 where friction has long been sliding; the gear is as stiff as a rigid one, and what acts is as in `inputs`, shape (n, 6).
    """

def instruction_sets() -> list[str]:
    """
    Those of this machine that kernels can be compiled for, the widest first.
    """

def add_kernel(drive: Drive, address: int) -> None:
    """
    Uses a kernel that is loaded, its table at an address, for all drives of the laws of one.
    """

def forget_kernels(drive: Drive) -> None:
    """Lets the general drive run drives of the laws of one again."""

def loaded_jobs(drive: Drive) -> list[str]:
    """What a kernel is loaded for, for drives of the laws of one."""

def differentiate(drive: Drive, initial: tuple[Sequence[int], numpy.typing.NDArray[numpy.float64]] | None, instants: numpy.typing.NDArray[numpy.float64], inputs: numpy.typing.NDArray[numpy.float64], keep: numpy.typing.NDArray[numpy.uint8], parameters: Sequence[int], progress: Callable[[int], None] | None = None) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
    """
    Outputs, from rest or with quantities known at the start, shape (channels, 1 + kept), and derivatives, shape (parameters, channels, 1 + kept).
    """
