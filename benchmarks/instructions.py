"""Instructions, code and stack of one step of exported controllers on microcontrollers.

Controllers with each compensator, and with each law of control that contains a gear, are exported as firmware, compiled for
Cortex-M4F and Cortex-M7 by GCC with newlib, and run in a machine that QEMU emulates, which prints each instruction that it
executes. These are instructions, not cycles: a quotient or a root takes 14 cycles on a Cortex-M4F, most others one. The inputs
are those of a simulated motion with many reversals, then random ones, far outside of it. The largest number of a step is over
all of them, with sinf, cosf and expf.

Needs the packages qemu-system-arm, gcc-arm-none-eabi, libnewlib-arm-none-eabi and libstdc++-arm-none-eabi-newlib of Debian.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from report import Column, print_table, save
from rich.console import Console
from strainwave.export.firmware import FLAGS, INPUTS

QEMU, GCC = "qemu-system-arm", "arm-none-eabi-"
PROGRAMS = (QEMU, *(GCC + name for name in ("gcc", "g++", "size")))
TRACE = ("-singlestep", "-d", "exec,nochain")  # one line for each instruction, with the function that it is of
DRIVER = Path(__file__).with_suffix(".c")
MEMORY = ("--section-start=.vectors=0", "-Ttext=0x400", "-Tdata=0x20000000", "-Tbss=0x20001000", "-e", "steps")
SAMPLE_PERIOD = 1e-3  # s, of the controllers
MOTION_STEPS = 400  # sampling instants of the simulated motion
RANDOM_STEPS = 100
RANGES = {"input_angle": 1e3, "command": 1e1, "low": 0.0, "high": 0.0}  # of random inputs; of others 1e2

COLUMNS = (
    Column("controller", words=True),
    *(Column(heading) for heading in ("state [B]", "code, M4F [B]", "stack [B]", "M4F, mean", "M4F, largest", "M7, largest")),
)


@dataclass(frozen=True)
class Processor:
    """A microcontroller: options of GCC, and a machine of QEMU with it."""

    options: tuple[str, ...]
    machine: str


M4F = Processor(("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"), "mps2-an386")
M7 = Processor(("-mcpu=cortex-m7", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv5-d16"), "mps2-an500")


@dataclass(frozen=True)
class Step:
    """A step of a controller: bytes of its state, code and stack on the Cortex-M4F, instructions on both processors."""

    controller: str
    state: int
    code: int
    stack: int
    mean: float
    largest: int
    largest_m7: int


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
        "Kalman regulator, state space": sw.regulator(drive(), period=SAMPLE_PERIOD, error=1e-3, encoder="input"),
        "feedback linearisation": sw.control.FeedbackLinearisation(bandwidth=60.0, **with_gear),
        "kinematic-error tracking": sw.control.KinematicErrorTracking(bandwidth=30.0, speed_gain=0.03, **with_gear),
    }
    sampled = sw.control.Sampled
    return {
        **{name: sampled(law=cascade, period=SAMPLE_PERIOD, compensation=each) for name, each in compensations.items()},
        **{name: sampled(law=law, period=SAMPLE_PERIOD) for name, law in laws.items()},
    }


def drive(control: Any = None) -> sw.Drive:
    """Return a joint under a controller."""
    return sw.Drive(
        gear=sw.load("csg-20-100"),
        motor=sw.motor.TorqueSource(inertia=2e-5),
        load=sw.loads.Pendulum(inertia=0.5, gravity_torque=10.0),
        control=control or sw.control.OpenLoop(),
    )


def inputs() -> np.ndarray[Any, Any]:
    """Return the inputs of a controller, one row per step: a motion that reverses every 25 ms, then random inputs."""
    duration = SAMPLE_PERIOD * MOTION_STEPS
    motion = sw.scenario.sine(0.02, 20.0, duration) + sw.scenario.sine(0.5, 3.0, duration)
    run = sw.simulate(drive(controllers()["cascade alone"]), motion, sample=SAMPLE_PERIOD)
    rows = np.zeros((MOTION_STEPS + RANDOM_STEPS, len(INPUTS)))
    random = np.random.default_rng(1)
    for column, (name, *_) in enumerate(INPUTS):
        if name in run.names:
            rows[:MOTION_STEPS, column] = run[name][:MOTION_STEPS]
        rows[MOTION_STEPS:, column] = RANGES.get(name, 1e2) * random.uniform(-1.0, 1.0, RANDOM_STEPS)
    rows[:MOTION_STEPS, 1] = motion.rate(SAMPLE_PERIOD * np.arange(MOTION_STEPS))
    rows[:, -2:] = -2.0, 2.0
    return rows


def measured(name: str, control: sw.control.Sampled, rows: np.ndarray[Any, Any]) -> Step:
    """Return the step of one controller."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        written = sw.export.firmware(drive(control), folder)
        lines = (
            "{" + ",".join(f"{value!r}f" for value in row) + "},\n" for row in rows.astype(np.float32).astype(float).tolist()
        )
        (folder / "inputs.h").write_text("".join(lines))
        compile_for(M7, folder)
        on_m7, _ = steps(M7, folder, len(rows))
        compile_for(M4F, folder)
        on_m4f, stack = steps(M4F, folder, len(rows))
        state, code, mean = 4 * len(written.state), code_size(folder), float(np.mean(on_m4f[:MOTION_STEPS]))
        return Step(name, state, code, stack, mean, max(on_m4f), max(on_m7))


def compile_for(processor: Processor, folder: Path) -> None:
    """Compile controller and driver to the program `steps` for a processor."""
    linking = ["-nostartfiles", *(f"-Wl,{option}" for option in MEMORY)]
    for command in (
        [f"{GCC}g++", *processor.options, *FLAGS.split(), "-c", "controller.cpp"],
        [f"{GCC}gcc", *processor.options, "-O1", *linking, "-I.", str(DRIVER), "controller.o", "-lm", "-o", "steps"],
    ):
        subprocess.run(command, cwd=folder, check=True)


def steps(processor: Processor, folder: Path, number: int) -> tuple[list[int], int]:
    """Return the instructions of each step that the program runs, and the bytes of stack below that of its loop."""
    output = ("-chardev", "file,id=out,path=depth", "-semihosting-config", "enable=on,target=native,chardev=out")
    command = [QEMU, "-M", processor.machine, "-kernel", "steps", "-display", "none", *output, *TRACE]
    process = subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE)
    assert process.stderr is not None
    calls, in_loop = list[int](), None
    for line in process.stderr:
        if line.endswith(b" steps\n"):
            in_loop = True
        elif in_loop is not None:
            if in_loop:
                calls.append(0)
            calls[-1] += 1
            in_loop = False
    if process.wait() != 0 or len(calls) <= number:
        raise RuntimeError(f"{QEMU} ended with status {process.returncode} after {len(calls)} calls")
    return calls[1 : number + 1], int((folder / "depth").read_text())  # the first is controller_start


def code_size(folder: Path) -> int:
    """Return the bytes of code and constants of the controller."""
    printed = subprocess.run([f"{GCC}size", "controller.o"], cwd=folder, check=True, capture_output=True, text=True).stdout
    return int(printed.splitlines()[1].split()[0])


def run(console: Console) -> None:
    """Count the steps of all controllers."""
    if missing := [program for program in PROGRAMS if shutil.which(program) is None]:
        console.print(f"instructions: left out, as {', '.join(missing)} is not installed")
        return
    rows = inputs()
    found = [measured(name, control, rows) for name, control in controllers().items()]
    cells = [
        [
            each.controller,
            *(str(number) for number in (each.state, each.code, each.stack, round(each.mean), each.largest, each.largest_m7)),
        ]
        for each in found
    ]
    print_table(
        console,
        "Instructions of a step",
        COLUMNS,
        cells,
        f"over {MOTION_STEPS} steps of a motion and {RANDOM_STEPS} of random inputs",
    )
    save("instructions", found)


if __name__ == "__main__":
    run(Console())
