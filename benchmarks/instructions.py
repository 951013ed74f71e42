"""Instructions, code and stack of one step of firmware on microcontrollers: whole drives, laws of gears, controllers.

Each is exported as firmware in single precision, compiled for Cortex-M4F and Cortex-M7 by GCC with newlib, and run in a machine
that QEMU emulates, whose clock goes on by 1 ns with each instruction. These are instructions, not cycles: a quotient or a root
takes 14 cycles on a Cortex-M4F, most others one. They are counted with sinf, cosf, expf and memcpy. The mean is over all steps,
within a few instructions; the largest is that of the longest step, which is repeated until its count is exact.

Drives follow a command that reverses five times in 10 s, and a load that grows. Controllers follow a simulated motion with many
reversals, then random inputs, far outside of it; laws follow random inputs.

Needs the packages qemu-system-arm, gcc-arm-none-eabi and libnewlib-arm-none-eabi of Debian.
"""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import five_drives
import numpy as np
import strainwave as sw
from five_drives import COMMAND_KNOTS, LOAD_KNOTS
from numpy.typing import NDArray
from peers import strainwave_drive
from report import Column, print_table, save
from rich.console import Console
from strainwave.export.firmware import microcontroller
from strainwave.simulation.excitation import ROOM_TEMPERATURE

Array = NDArray[np.float64]
SAMPLE_PERIOD = 1e-3  # s, of the controllers
MOTION_STEPS = 400  # sampling instants of the simulated motion
RANDOM_STEPS = 100
RANGES = {"input_angle": 1e3, "command": 1e1, "low": 0.0, "high": 0.0}  # of random inputs of controllers; of others 1e2
LAW_STEPS = 2000
LAW_RANGES = {"twist": 2e-3, "speed": 20.0, "load": 5.0, "temperature": 0.0}  # of inputs of laws; of others 1e2
DRIVE_NAMES = {
    "reference": "reference drive",
    "robot": "robot-joint",
    "lumped": "tilt-actuator-lumped",
    "staged": "tilt-actuator",
    "soft": "soft gear of example 14",
}

COLUMNS = (
    Column("firmware", words=True),
    *(Column(heading) for heading in ("state [B]", "code, M4F [B]", "stack [B]", "M4F, mean", "M4F, largest", "M7, largest")),
)
STATES = "both shafts slip", "one sticks", "one stops, breaks away or turns round"
STATE_COLUMNS = (Column("drive", words=True), *(Column(f"M4F, {state}") for state in STATES))


@dataclass(frozen=True)
class Step:
    """A step of firmware: bytes of its state, code and stack on the Cortex-M4F, instructions on both processors."""

    part: str
    state: int
    code: int
    stack: int
    mean: float
    largest: int
    largest_m7: int
    by_state: tuple[int, int, int]  # as in `Counts`, on the Cortex-M4F


@dataclass(frozen=True)
class Case:
    """A part to export, and the inputs of its steps, one row each."""

    name: str
    model: Any
    part: str
    period: float | None = None

    def inputs(self, firmware: sw.export.Firmware) -> Array:
        match self.part:
            case "control":
                return controller_inputs(firmware)
            case "drive":
                return drive_inputs(firmware)
        return law_inputs(firmware)


def cases() -> Iterator[Case]:
    """Yield all that is measured: drives, laws, then controllers."""
    for name, drive in drives().items():
        yield Case(name, drive, "drive")
    for name, (part, law) in laws().items():
        gear = sw.load("csg-20-100").replace(**{part: law})
        yield Case(name, gear, f"gear.{part}", SAMPLE_PERIOD if part.startswith("friction") else None)
    for name, control in controllers().items():
        yield Case(name, joint(control), "control")


def drives() -> dict[str, sw.Drive]:
    """Return the drives whose runs the tests compare with their firmware; the robot joint samples as the catalogue has it."""
    models = five_drives.drives() | {"robot": sw.load("robot-joint")}
    return {name: five_drives.quiet(models[key]) for key, name in DRIVE_NAMES.items()}


def laws() -> dict[str, tuple[str, Any]]:
    """Return laws of a gear, each with its place."""
    orders = list(range(1, 11))
    return {
        "friction: Stribeck": ("friction_input", sw.friction.Stribeck(coulomb=0.03, breakaway=0.045, stribeck_speed=2.0)),
        "friction: LuGre": ("friction_input", strainwave_drive.friction()),
        "friction: Maxwell slip, 4 elements": (
            "friction_input",
            sw.friction.MaxwellSlipFriction(
                stiffness=[20.0, 40.0, 80.0, 160.0],
                share=[0.25] * 4,
                coulomb=0.03,
                breakaway=0.045,
                stribeck_speed=2.0,
                attraction=0.3,
            ),
        ),
        "stiffness: three segments": ("stiffness", sw.load("csg-20-100").stiffness),
        "stiffness: cubic": ("stiffness", sw.stiffness.Cubic(a1=1.2e4, a3=1e9)),
        "hysteresis: Maxwell slip, 8 elements": ("hysteresis", strainwave_drive.gear().hysteresis),
        "hysteresis: Bouc and Wen": ("hysteresis", sw.hysteresis.BoucWen(stiffness=1e3, saturation=5.0)),
        "hysteresis: Preisach": (
            "hysteresis",
            sw.hysteresis.Preisach(density=sw.hysteresis.PowerDensity(limit=2e-3, saturation=5.0)),
        ),
        "hysteresis: regimes": ("hysteresis", sw.rig.printed_gear(0).hysteresis),
        "kinematic error: 10 orders": (
            "kinematic_error",
            sw.kinematic_error.Fourier(order=orders, amplitude=[1e-5] * 10, phase=[0.1] * 10),
        ),
        "kinematic error: misalignment": ("kinematic_error", sw.load("tilt-actuator").gear.kinematic_error),
        "random kinematic error": ("kinematic_noise", sw.kinematic_error.Stochastic(amplitude=2e-5)),
    }


def controllers() -> dict[str, sw.control.Sampled]:
    """Return a cascade with each compensator and with several at once, then the laws of control that contain a gear."""
    cascade = sw.control.PositionSpeed(
        position_gain=30.0, speed_proportional=0.02, speed_integral=0.3, speed_feedforward=1.0, limit=2.0
    )
    friction = sw.friction.LuGre(
        coulomb=0.03, breakaway=0.045, stribeck_speed=2.0, bristle_stiffness=50.0, bristle_damping=1e-3, viscous=1e-3
    )
    error = sw.kinematic_error.Fourier(order=[1, 2, 4], amplitude=[1e-4, 2e-4, 3e-5], phase=[0.0, 0.5, 1.0])
    gear = sw.load("csg-20-100").replace(friction_input=friction, kinematic_error=error)
    bare = sw.Gear(kinematics=gear.kinematics, stiffness=sw.stiffness.Linear(k=2e4), friction_input=friction)
    load = sw.loads.Pendulum(inertia=0.5, gravity_torque=10.0)

    def model(gear: Any) -> sw.compensation.ModelFeedforward:
        return sw.compensation.ModelFeedforward(gear=gear, load=load, motor_inertia=2e-5)

    observer = sw.compensation.DisturbanceObserver(inertia=8e-5, limit=0.5)
    bristles = sw.compensation.BristleObserver(friction=friction, friction_share=0.9, bristle_gain=2.0)
    fourier = sw.compensation.AdaptiveFourier(order=[1, 2, 4, 2.02], max_frequency=300.0)
    lost_motion = sw.compensation.LostMotionMap(angle=[-1.0, 0.0, 1.0], forward=[1e-4] * 3, backward=[-1e-4] * 3)
    passes = sw.compensation.IterativeLearning(low=-0.2, high=0.2)
    twist = sw.compensation.TwistIdentification(order=[1, 2, 4, 2.02])
    every = sw.Compensation
    compensations = {
        "cascade alone": every(),
        "model of friction and inertia": every(feedforward=model(bare)),
        "model of the whole gear": every(feedforward=model(gear)),
        "lost-motion map": every(feedforward=lost_motion),
        "adaptive Fourier, 4 orders": every(learning=fourier),
        "repetitive": every(learning=sw.compensation.Repetitive(max_speed=100.0)),
        "iterative learning": every(learning=passes),
        "lost-motion map, twist identification, 4 orders": every(feedforward=lost_motion, learning=twist),
        "disturbance observer": every(observer=observer),
        "friction and inertia, friction scale": every(feedforward=model(bare), observer=sw.compensation.FrictionScale()),
        "friction and inertia, bristle observer": every(feedforward=model(bare), observer=bristles),
        "dither": every(dither=sw.compensation.Dither(amplitude=0.02, frequency=80.0)),
        "whole gear, adaptive Fourier, observer": every(feedforward=model(gear), learning=fourier, observer=observer),
    }
    with_gear = {"gear": gear, "load": load, "motor_inertia": 2e-5, "reference_time": 2e-3, "limit": 2.0}
    laws: dict[str, Any] = {
        "Kalman regulator, state space": sw.tuning.lqg(joint(), period=SAMPLE_PERIOD, error=1e-3, encoder="input"),
        "feedback linearisation": sw.control.FeedbackLinearisation(bandwidth=60.0, **with_gear),
        "kinematic-error tracking": sw.control.KinematicErrorTracking(bandwidth=30.0, speed_gain=0.03, **with_gear),
    }
    sampled = sw.control.Sampled
    return {
        **{name: sampled(law=cascade, period=SAMPLE_PERIOD, compensation=each) for name, each in compensations.items()},
        **{name: sampled(law=law, period=SAMPLE_PERIOD) for name, law in laws.items()},
    }


def joint(control: Any = None) -> sw.Drive:
    """Return a joint under a controller."""
    return sw.Drive(
        gear=sw.load("csg-20-100"),
        motor=sw.motor.TorqueSource(inertia=2e-5),
        load=sw.loads.Pendulum(inertia=0.5, gravity_torque=10.0),
        control=control or sw.control.OpenLoop(),
    )


def drive_inputs(firmware: sw.export.Firmware) -> Array:
    """Return the inputs of a drive over 10 s."""
    time = firmware.period * np.arange(round(COMMAND_KNOTS[0][-1] / firmware.period))
    columns = {"temperature": np.full(len(time), ROOM_TEMPERATURE)}
    for name, (knots, values) in {"command": COMMAND_KNOTS, "load_torque": LOAD_KNOTS}.items():
        rates = np.diff(values) / np.diff(knots)
        columns[name] = np.interp(time, knots, values)
        columns[f"{name}_rate"] = rates[np.searchsorted(knots, time, side="right") - 1]
    return np.column_stack([columns.get(name, np.zeros(len(time))) for name in firmware.inputs])


def law_inputs(firmware: sw.export.Firmware) -> Array:
    """Return random inputs of a law."""
    random = np.random.default_rng(1)
    columns = [LAW_RANGES.get(name, 1e2) * random.uniform(-1.0, 1.0, LAW_STEPS) for name in firmware.inputs]
    return np.column_stack(
        [
            ROOM_TEMPERATURE + each if name == "temperature" else each
            for name, each in zip(firmware.inputs, columns, strict=True)
        ]
    )


def controller_inputs(firmware: sw.export.Firmware) -> Array:
    """Return inputs of a controller: a motion that reverses every 25 ms, then random inputs."""
    duration = SAMPLE_PERIOD * MOTION_STEPS
    motion = sw.scenario.sine(0.02, 20.0, duration) + sw.scenario.sine(0.5, 3.0, duration)
    run = sw.simulate(joint(controllers()["cascade alone"]), motion, sample=SAMPLE_PERIOD)
    rows = np.zeros((MOTION_STEPS + RANDOM_STEPS, len(firmware.inputs)))
    random = np.random.default_rng(1)
    for column, name in enumerate(firmware.inputs):
        if name in run.names:
            rows[:MOTION_STEPS, column] = run[name][:MOTION_STEPS]
        rows[MOTION_STEPS:, column] = RANGES.get(name, 1e2) * random.uniform(-1.0, 1.0, RANDOM_STEPS)
    rows[:MOTION_STEPS, 1] = motion.rate(SAMPLE_PERIOD * np.arange(MOTION_STEPS))
    rows[:, -2:] = -2.0, 2.0
    return rows


def measured(case: Case) -> Step:
    """Return the step of one part."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        firmware = sw.export.firmware(case.model, folder, part=case.part, name="part", period=case.period)
        inputs = case.inputs(firmware)
        on_m7 = microcontroller.counted(microcontroller.M7, folder, firmware, inputs)
        on_m4f = microcontroller.counted(microcontroller.M4F, folder, firmware, inputs)
        state = 4 * len(firmware.state)
        return Step(
            case.name,
            state,
            microcontroller.code_size(folder),
            on_m4f.stack,
            on_m4f.mean,
            max(on_m4f.largest),
            max(on_m7.largest),
            on_m4f.largest,
        )


def run(console: Console) -> None:
    """Count the steps of all parts."""
    if missing := microcontroller.missing_programs():
        console.print(f"instructions: left out, as {', '.join(missing)} is not installed")
        return
    found = list[Step]()
    with warnings.catch_warnings(action="ignore"), console.status("instructions"):
        found += [measured(case) for case in cases()]
    cells = [
        [
            each.part,
            *(str(number) for number in (each.state, each.code, each.stack, round(each.mean), each.largest, each.largest_m7)),
        ]
        for each in found
    ]
    print_table(console, "Instructions of a step", COLUMNS, cells, "drives over 10 s, laws and controllers over random inputs")
    whole = [each for each in found if sum(count > 0 for count in each.by_state) > 1]
    print_table(
        console,
        "Largest step by what the shafts do",
        STATE_COLUMNS,
        [[each.part, *(str(each.by_state[place]) for place in (1, 0, 2))] for each in whole],
    )
    save("instructions", found)


if __name__ == "__main__":
    run(Console())
