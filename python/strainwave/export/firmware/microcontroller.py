"""Code size, stack and instructions of a step of firmware on microcontrollers that QEMU emulates.

The clock of the emulated machine goes on by 1 ns with each instruction. These are instructions, not cycles: a quotient or a
root takes 14 cycles on a Cortex-M4F, most others one. They are counted with sinf, cosf, expf and memcpy.

Needs the packages qemu-system-arm, gcc-arm-none-eabi and libnewlib-arm-none-eabi of Debian.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear
from strainwave.export.firmware.build import FLAGS, Firmware, drive_with, firmware
from strainwave.export.firmware.step import step
from strainwave.export.fmu.build import moving_run
from strainwave.files.gear_set import GearSet
from strainwave.native.static_type import Scalar

Array = NDArray[np.float64]
QEMU, GCC = "qemu-system-arm", "arm-none-eabi-"
PROGRAMS = (QEMU, *(GCC + name for name in ("gcc", "g++", "size")))
CLOCK = ("-icount", "shift=0")  # 1 ns with each instruction
TIMER_TICK = 40  # ns, of the system timer of both machines
DRIVER = Path(__file__).with_name("instructions.c")
MEMORY = ("--section-start=.vectors=0", "-Ttext=0x400", "-Tdata=0x20000000", "-Tbss=0x20001000", "-e", "steps")
REPEATED_STEPS = 1000  # of the longest step, as in the driver
REPORTED_STEPS = 2000  # of a report
LAW_RANGES = {"twist": 2e-3, "speed": 20.0, "load": 5.0}  # of random inputs of laws; of others 1e2


@dataclass(frozen=True)
class Processor:
    """A microcontroller: options of GCC, and a machine of QEMU with it."""

    options: tuple[str, ...]
    machine: str


M4F = Processor(("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"), "mps2-an386")
M7 = Processor(("-mcpu=cortex-m7", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv5-d16"), "mps2-an500")


@dataclass(frozen=True)
class Counts:
    """Instructions of steps, and bytes of stack below that of their caller.

    Attributes:
        largest: of steps in which a shaft sticks, both slip, one stops, breaks away or turns round; 0 without such steps
    """

    mean: float
    largest: tuple[int, int, int]
    stack: int


def missing_programs() -> list[str]:
    """Return the programs that are needed and not installed."""
    return [program for program in PROGRAMS if shutil.which(program) is None]


def report(model: Drive | GearSet | Gear, part: str, scalar: Scalar, period: float | None) -> Iterator[str]:
    """Yield lines on the size and the instructions of a step on a Cortex-M4F; what is missing if programs are not installed.

    Controllers and drives follow a step of the command, laws get random inputs.
    """
    if missing := missing_programs():
        yield f"report: not measured, as {', '.join(missing)} is not installed"
        return
    with TemporaryDirectory() as place:
        folder = Path(place)
        written = firmware(model, folder, part=part, name="part", scalar=scalar, period=period)
        inputs, what = _inputs(model, part, written)
        counts = counted(M4F, folder, written, inputs)
        state, largest = np.dtype(_numpy(scalar)).itemsize * len(written.state), max(counts.largest)
        yield f"code and constants: {code_size(folder)} bytes; state: {state} bytes; stack: {counts.stack} bytes"
        yield f"instructions of a step: {min(counts.mean, largest):.0f} in the mean, {largest} at most, over {what}"
    yield "on a Cortex-M4F (GCC, -O2, newlib), emulated by QEMU, which counts instructions and not cycles"


def _inputs(model: Drive | GearSet | Gear, part: str, written: Firmware) -> tuple[Array, str]:
    """Return inputs of the steps of a part, one row each, and what they are."""
    drive = drive_with(model, part)
    members = step(drive, part, None if part == "control" else written.period or None).inputs
    rows = np.tile([each.start[0] for each in members], (REPORTED_STEPS, 1))
    if part in ("control", "drive"):
        size, run = moving_run(drive, REPORTED_STEPS * written.period, written.period, written.period)
        for column, each in enumerate(members):
            if each.name in run.names and not each.name.startswith("temperature"):
                rows[:, column] = run[each.name][:REPORTED_STEPS]
        rows[:, [each.name for each in members].index("command")] = size
        return rows, f"{REPORTED_STEPS * written.period:.3g} s of a step of the command by {size:g}"
    random = np.random.default_rng(1)
    for column, each in enumerate(members):
        if each.name != "temperature":
            rows[:, column] = LAW_RANGES.get(each.name, 1e2) * random.uniform(-1.0, 1.0, REPORTED_STEPS)
    return rows, f"{REPORTED_STEPS} random inputs"


def _numpy(scalar: Scalar) -> str:
    return {"float": "<f4", "double": "<f8"}[scalar]


def counted(processor: Processor, folder: Path, written: Firmware, inputs: Array) -> Counts:
    """Compile firmware and driver for a processor, run them over inputs, and return what they counted.

    Args:
        processor: on which they run
        folder: that contains the firmware, and gets the files of the run
        written: the firmware
        inputs: of its steps, one row each
    """
    inputs.astype(_numpy(written.scalar)).tofile(folder / "inputs")
    name = written.header.stem
    linking = ["-nostartfiles", *(f"-Wl,{option}" for option in MEMORY)]
    files = ("-semihosting-config", "enable=on,target=native")
    own = ["-I.", f"-DNAME={name}", *_directions(written.state), "-include", f"{name}.h", str(DRIVER), f"{name}.o"]
    for command in (
        [f"{GCC}g++", *processor.options, *FLAGS.split(), "-nostdinc++", "-c", f"{name}.cpp"],
        [f"{GCC}gcc", *processor.options, "-O1", *linking, *own, "-lm", "-o", "steps"],
        [QEMU, "-M", processor.machine, "-kernel", "steps", "-display", "none", *CLOCK, *files],
    ):
        subprocess.run(command, cwd=folder, check=True)
    numbers = np.fromfile(folder / "counts", "<u4").astype(int)
    steps, depth, empty = numbers[:3]
    found, repeated, idle = numbers[3:12].reshape(3, 3)
    ticks = TIMER_TICK * (repeated - idle) / REPEATED_STEPS
    exact = np.where(found > 0, np.rint(ticks).astype(int) + 1, 0)  # 1: the function that is idle
    mean = TIMER_TICK * (float(np.mean(numbers[12 : 12 + steps])) - empty / REPEATED_STEPS) + 1.0
    return Counts(mean, tuple(exact.tolist()), int(depth))


def _directions(state: Sequence[str]) -> Iterator[str]:
    """Yield definitions of the sense in which each shaft slips, 1 if the firmware has none."""
    for side in ("input", "output"):
        name = f"{side}_slip_direction"
        yield f"-D{side.upper()}_DIRECTION={f'state.{name}' if name in state else '1'}"


def code_size(folder: Path, name: str = "part") -> int:
    """Return the bytes of code and constants of compiled firmware."""
    printed = subprocess.run([f"{GCC}size", f"{name}.o"], cwd=folder, check=True, capture_output=True, text=True).stdout
    return int(printed.splitlines()[1].split()[0])
