"""Ensembles on a GPU compared with all cores of the processor: agreement and time.

Drives of the catalogue run through one command with as many inertias of the load as there are members, and keep angle and
torque of the output every 10 ms. Kernels are compiled before. The difference is the largest over members and instants, relative
to the largest of the output.

Needs a GPU that CUDA can use, and the extra cuda.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial

import numpy as np
import strainwave as sw
from report import Column, print_table, save, three_digits
from rich.console import Console
from strainwave.simulation.ensemble import Backend
from strainwave.simulation.signals import command_unit
from strainwave.simulation.threads import available_threads

SETS = ("position-drive", "two-inertia-gear", "tilt-actuator-lumped", "robot-joint")
COMMAND_SIZES = {"rad": 0.2, "V": 5.0, "N.m": 0.5}  # steps
SIMULATION_STEP = 2e-4  # s
SAMPLE_INTERVAL = 1e-2  # s
OUTPUTS = ("output_angle", "torque")
MEMBER_COUNT = 65536
RUN_DURATION = 2.0  # s

COLUMNS = (
    Column("drive", words=True),
    *(
        Column(heading)
        for heading in ("cpu [s]", "gpu [s]", "ratio", "gpu-float [s]", "ratio", "difference", "difference, float")
    ),
)


@dataclass(frozen=True)
class Comparison:
    """Times of an ensemble [s], and how far the results of a GPU lie from those of the processor."""

    drive: str
    cpu: float
    gpu: float
    single: float
    difference: float
    difference_of_single: float


def timed(drive: sw.Drive, backend: Backend) -> tuple[sw.Ensemble, float]:
    """Return an ensemble and the time that it took [s], a few members having run before."""
    command = sw.scenario.step(COMMAND_SIZES[command_unit(drive)], RUN_DURATION)
    inertia = drive.load.inertia * np.geomspace(0.5, 2.0, MEMBER_COUNT)  # type: ignore[union-attr] # those of SETS have one
    run = partial(sw.simulate_many, drive, command, dt=SIMULATION_STEP, sample=SAMPLE_INTERVAL, record=OUTPUTS, backend=backend)
    run(parameters={"load.inertia": inertia[:64]})
    began = time.perf_counter()
    found = run(parameters={"load.inertia": inertia})
    return found, time.perf_counter() - began


def difference(found: sw.Ensemble, expected: sw.Ensemble) -> float:
    """Return the largest difference of two ensembles, relative to the largest of each output."""
    return max(float(np.abs(found[name] - expected[name]).max() / np.abs(expected[name]).max()) for name in OUTPUTS)


def comparison(name: str) -> Comparison:
    """Return how a drive of the catalogue runs on both."""
    drive = sw.GearSet.read(name).drive
    sw.compile(drive, ["simulate_many"])
    (cpu, cpu_time), (gpu, gpu_time), (single, single_time) = (timed(drive, backend) for backend in ("cpu", "gpu", "gpu-float"))
    return Comparison(name, cpu_time, gpu_time, single_time, difference(gpu, cpu), difference(single, cpu))


def row(one: Comparison) -> list[str]:
    """Return the cells of a comparison."""
    return [
        one.drive,
        three_digits(one.cpu),
        three_digits(one.gpu),
        three_digits(one.cpu / one.gpu),
        three_digits(one.single),
        three_digits(one.cpu / one.single),
        f"{one.difference:.1e}",
        f"{one.difference_of_single:.1e}",
    ]


def run(console: Console) -> None:
    """Measure and print; without a GPU print the missing package or driver."""
    try:
        found = [comparison(name) for name in SETS]
    except (ImportError, OSError) as error:
        console.print(f"gpu: {error}", markup=False)
        return
    caption = f"ratios: of time on {available_threads()} threads of the processor, over that on the GPU"
    print_table(
        console, f"{MEMBER_COUNT} members of {RUN_DURATION:g} s on a GPU", COLUMNS, [row(one) for one in found], caption
    )
    save("gpu", found)
