"""Ramp of an actuator: its output turns through its stroke at constant speed, as in the flight actuator paper."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, kinematic_error, stiffness, structure
from strainwave.files.described import parameters, parts
from strainwave.files.recording import Recording
from strainwave.messages import listed, quoted
from strainwave.parameters import every
from strainwave.presentation import Presented
from strainwave.simulation.ensemble import Ensemble, simulate_many
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.resolution import MAX_STEP_PHASE
from strainwave.simulation.run import simulate
from strainwave.simulation.scenario import Scenario, ramp
from strainwave.simulation.signals import outputs

Array = NDArray[np.float64]

OUTPUT, INPUT = "output", "input"
LOOPS = {OUTPUT: "output sensor", INPUT: "motor encoder"}
ERROR_PATH = "gear.kinematic_error"
RUN_IN = 0.1  # of the ramp [1], that is left out until the speed is constant
MAX_STEP = 2e-4  # s, of a simulation
STEP_MARGIN = 0.7  # of a step [1], as a twisted gear may be stiffer than one at rest
MAX_SAMPLE_TIME = 1e-3  # s, between rows
MIN_ROWS_PER_TURN = 64  # of a turn of the input: separates orders up to 10
MIN_TIME, MAX_TIME = 1e-6, 600.0  # s, of the ramp
MIN_TURNS, MAX_TURNS = 3.0, 1e4  # of the input, after the run-in and in all
MIN_SPEED_SHARE = 0.9  # of the commanded speed [1], that a drive must reach on average
RAMP_CHANNELS = ("torque", "current", "output_angle", "input_angle")
# The flight actuator paper prints no dimensions. Assumed where the drive has none: those of erratum 2 of the review of dynamic
# models, 0.6 mm of difference between the half axes.
ASSUMED_MISALIGNMENT = kinematic_error.Misalignment(
    major_radius=25.3e-3, minor_radius=24.7e-3, pitch_radius=25e-3, pressure_angle=np.radians(20.0)
)
ASSUMED_SECTION_OFFSET = 4e-3  # m, from the centre of tilt to the section, of a drive that states none


@dataclass(frozen=True)
class ActuatorRamp(Presented):
    """A drive, a stroke and its time.

    Attributes:
        drive: whose position loop closes on either side
        stroke: of the output [rad]
        duration: of the ramp [s]
        dt: largest step [s]
        load_torque: constant torque that acts on the output besides the load of the drive [N.m]

    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=0.6, duration=2.0)
    >>> ramp.loop, round(ramp.turning, 1)  # speed of the input [rad/s]
    ('output', 30.3)
    """

    drive: Drive
    stroke: float
    duration: float
    dt: float
    load_torque: float = 0.0

    @classmethod
    def of(cls, drive: Drive, stroke: float, duration: float) -> ActuatorRamp:
        """Return the ramp of a drive, with steps that its fastest mode allows.

        Args:
            drive: whose controller is a position loop around a speed loop
            stroke: of the output [rad]
            duration: of the ramp [s]

        Raises:
            ValueError: the stroke or the time is too small or too large, the ramp is less than three turns of the input, or
                the drive has no position loop that closes on both sides, or an output that is moved from outside
        """
        arguments.number("stroke", float(np.degrees(stroke)), "deg", low=0.0)
        duration = arguments.number("time", duration, "s", "[]", low=MIN_TIME, high=MAX_TIME)
        if not hasattr(drive.load, "inertia"):
            raise ValueError(
                f"the load {quoted(drive.load.name)} of the drive moves its output from outside; the ramp needs one that the "
                "motor moves, as inertia and aerodynamic are"
            )
        turns = stroke * abs(drive.gear.kinematics.ratio) / (2.0 * np.pi)
        needed, longest = MIN_TURNS / (1.0 - RUN_IN), MAX_TURNS
        if not needed <= turns <= longest:
            limit = f"{np.degrees(stroke * (needed if turns < needed else longest) / turns):.3g} deg"
            allowed = f"take {limit} or {'more' if turns < needed else 'less'}"
            raise ValueError(f"stroke = {np.degrees(stroke):g} deg is {turns:.2g} turns of the input; {allowed}")
        for name in ("feedback", "position_gain"):
            _control_path(drive, name)
        return cls(drive, stroke, duration, longest_step(drive))

    @property
    def command(self) -> Scenario:
        """Commanded output angle [rad]."""
        return ramp(self.stroke / self.duration, duration=self.duration)

    @property
    def turning(self) -> float:
        """Size of the speed of the input [rad/s]."""
        return self.stroke / self.duration * abs(float(self.drive.gear.kinematics.ratio))

    @property
    def sample(self) -> float:
        """Time between the rows of a run [s]."""
        return min(MAX_SAMPLE_TIME, 2.0 * np.pi / self.turning / MIN_ROWS_PER_TURN)

    @property
    def loop(self) -> str:
        """The side on which the position loop closes: "output" or "input"."""
        control: Any = self.drive.control
        while not hasattr(control, "feedback"):
            control = control.law
        return str(control.feedback)

    @property
    def seeds(self) -> list[str]:
        """Paths of the seeds of all noises of the drive's sensors."""
        return noises(self.drive, "seed")

    @property
    def gain_path(self) -> str:
        """Path of the gain of the position loop [1/s]."""
        return _control_path(self.drive, "position_gain")

    @property
    def gain(self) -> float:
        """Gain of the position loop [1/s]: its bandwidth in rad/s with an ideal speed loop."""
        return every(self.drive)[self.gain_path].value

    def closed_on(self, side: str) -> ActuatorRamp:
        """Return the ramp with the position loop closed on "output" or "input"."""
        return replace(self, drive=self.drive.replace({_control_path(self.drive, "feedback"): side}))

    def with_error(self, law: Any) -> ActuatorRamp:
        """Return the ramp with another kinematic error."""
        return replace(self, drive=self.drive.replace({ERROR_PATH: law}))

    def loaded(self, load_torque: float) -> ActuatorRamp:
        """Return the ramp with a constant torque [N.m] on the output besides the load of the drive."""
        return replace(self, load_torque=load_torque)

    def lasting(self, duration: float) -> ActuatorRamp:
        """Return the ramp in another time [s]."""
        return replace(self, duration=duration)

    def without_noise(self) -> ActuatorRamp:
        """Return the ramp with sensors without noise."""
        return replace(self, drive=self.drive.replace(dict.fromkeys(noises(self.drive, "amplitude"), 0.0)))

    def run(self) -> Recording:
        """Return the recording of one run, with all channels."""
        return simulate(self.drive, self.command, self.dt, sample=self.sample, load_torque=self.load_torque)

    def many(self, members: Sequence[Mapping[str, float]], record: Sequence[str] | None = None) -> Ensemble:
        """Return runs that differ in some numbers; the drive has those that a run does not name.

        Args:
            members: for each run the numbers in which it differs from the drive, by path
            record: columns; without it all that the drive shows

        Raises:
            ValueError: one of them cannot be run to its end, or does not follow the ramp
        """
        own = every(self.drive)
        paths = dict.fromkeys(path for member in members for path in member)
        columns = {path: [member.get(path, own[path].value) for member in members] for path in paths}
        runs = simulate_many(
            self.drive,
            self.command,
            columns,
            dt=self.dt,
            sample=self.sample,
            record=list(dict.fromkeys(("input_angle", *(outputs(self.drive) if record is None else record)))),
            load_torque=self.load_torque,
        )
        if runs.failures:
            member, reason = next(iter(runs.failures.items()))
            raise ValueError(f"the ramp cannot be run with {dict(members[member])}: {reason}")
        for number in range(len(members)):
            self._check_that_it_follows(runs.member(number))
        return runs

    def _check_that_it_follows(self, run: Recording) -> None:
        """Raise ValueError for a drive that stays behind, turns back, or swings."""
        turned = np.diff(self.settled(run)["input_angle"]) * np.sign(float(self.drive.gear.kinematics.ratio))
        asked = self.turning * (1.0 - RUN_IN) * self.duration
        ramp = f"the drive does not follow a ramp of {np.degrees(self.stroke):.4g} deg in {self.duration:.4g} s"
        way_out = "give a smaller stroke, a longer time, or a drive whose motor and controller are fast enough"
        if not turned.sum() > MIN_SPEED_SHARE * asked:
            raise ValueError(
                f"{ramp}: its input turns by {turned.sum():.4g} rad after the run-in, not by {asked:.4g} rad; {way_out}"
            )
        if turned.min() < 0.0:
            raise ValueError(f"{ramp}: its input turns back on the way; {way_out}")

    def settled(self, recording: Recording) -> Recording:
        """Return the recording after the run-in."""
        return recording.between(RUN_IN * self.duration, self.duration)


def in_series(ramp: ActuatorRamp) -> ActuatorRamp:
    """Return the ramp with the stages of a staged gear in series as one spring, which takes less time; else the ramp itself.

    Right for what is slow against the stages, as orders of the wave generator are. Inertias between the stages are left out.
    Referred to the output, with the ratio i, compliances add up (its erratum 6), with those of both couplings:

    1/K = 1/K_t + tan^2(alpha_t) / (K_b r_g^2) + 1 / (K_m r_g^2 cos^2(alpha_t)) + 1/K_CS + 1 / (K_WG i^2)

    Each damper takes the rate that its spring takes of the twist: c = K^2 sum c_j / K_j^2.

    >>> import strainwave as sw
    >>> ramp = sw.diagnose.ActuatorRamp.of(sw.load("tilt-actuator"), stroke=0.6, duration=2.0)
    >>> sw.diagnose.in_series(ramp).drive.gear.structure.name
    'lumped'
    """
    gear: Any = ramp.drive.gear
    stages: Any = gear.structure
    if not isinstance(stages, structure.Staged) or not isinstance(gear.stiffness, stiffness.Linear):
        return ramp
    race = (stages.pitch_radius / np.tan(stages.pressure_angle)) ** 2
    flank = (stages.pitch_radius * np.cos(stages.pressure_angle)) ** 2
    square = float(gear.kinematics.ratio) ** 2
    pairs = (
        (gear.stiffness.k, gear.damping),
        (race * stages.bearing_stiffness, race * stages.bearing_damping),
        (flank * stages.mesh_stiffness, flank * stages.mesh_damping),
        (stages.circular_spline_stiffness, stages.circular_spline_damping),
        (square * stages.coupling_stiffness, square * stages.coupling_damping),
    )
    k = 1.0 / sum(1.0 / spring for spring, _ in pairs)
    damping = k**2 * sum(damper / spring**2 for spring, damper in pairs)
    one = {"structure": structure.Lumped(), "stiffness": stiffness.Linear(k=k), "damping": damping}
    return ActuatorRamp.of(ramp.drive.replace(gear=gear.replace(**one)), ramp.stroke, ramp.duration).loaded(ramp.load_torque)


def wave_generator(drive: Drive) -> tuple[Any, bool]:
    """Return the `Misalignment` of a drive, straight, and True if it is assumed because the drive has none.

    >>> import strainwave as sw
    >>> law, assumed = sw.diagnose.wave_generator(sw.load("tilt-actuator-lumped"))
    >>> law.pitch_radius, assumed  # m
    (0.025, False)
    """
    own = next(_laws(drive.gear.kinematic_error), None)
    law: Any = ASSUMED_MISALIGNMENT if own is None else own
    straight: dict[str, Any] = {
        name: 0.0 for name, kind, _ in parameters(law) if name.startswith(("housing_", "generator_")) and kind == "number"
    }
    return law.replace(**straight, offset=law.offset or ASSUMED_SECTION_OFFSET), own is None


def longest_step(drive: Drive) -> float:
    """Return the longest step of a run [s], for the fastest mode of the drive."""
    return min(MAX_STEP, STEP_MARGIN * MAX_STEP_PHASE / _core.max_rate(drive, 0.0, ROOM_TEMPERATURE))


def noises(drive: Drive, name: str) -> list[str]:
    """Return the paths of a number ("amplitude", "seed") of all noises of the drive's sensors."""
    return [path for path in every(drive) if path.startswith("sensors.") and path.endswith(f".{name}")]


def _laws(law: Any) -> Iterator[Any]:
    """Yield every law of misalignment in another law, or it itself."""
    if isinstance(law, kinematic_error.Misalignment):
        yield law
    for part in parts(law):
        yield from _laws(getattr(law, part.name))


def _control_path(drive: Drive, name: str) -> str:
    """Return the path of a parameter of the controller, which may be inside of a sampled one."""
    place, control = "control", drive.control
    while name not in (known := [each.name for each in parameters(control)]):
        inner = parts(control)
        if not inner:
            raise ValueError(
                f"the controller {quoted(control.name)} of the drive has no {name}, but {listed(known)}; the ramp needs a "
                "position loop around a speed loop, as cascade and position_speed are"
            )
        place, control = f"{place}.{inner[0].name}", getattr(control, inner[0].name)
    return f"{place}.{name}"
