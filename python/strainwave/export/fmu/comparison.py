"""Comparison of an FMU with the simulation of its drive: both run the same motion."""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.export.fmu.variables import Variable, recorded
from strainwave.simulation import scenario, signals
from strainwave.simulation.run import Run, simulate
from strainwave.tuning.loss import ExportLoss

if TYPE_CHECKING:
    from collections.abc import Iterator

Array = NDArray[np.float64]
COMMUNICATION_STEPS = 1000  # of the compared run
MIN_DURATION = 0.2  # s, of that run
COMMAND_SIZES = {"rad": 0.1, "rad/s": 1.0}  # size of the command by its unit
OTHER_COMMAND = 0.1  # in other units: V, A, N.m
MAX_COMMAND_FACTOR = 1000.0  # by which the command is raised until the drive moves
COMPARED = ("input_angle", "output_angle", "twist", "torque")


def difference_to_simulation(
    content: bytes, drive: Drive, found: list[Variable], version: int, step: float
) -> list[ExportLoss]:
    """Return what an FMU loses against `sw.simulate` over a step of the command, in some of its outputs."""
    interval = max(1, math.ceil(MIN_DURATION / COMMUNICATION_STEPS / step)) * step
    duration = COMMUNICATION_STEPS * interval
    size, run = moving_run(drive, duration, step, interval)
    names = {output.name: name for name, output in recorded(drive, found).items()}
    chosen = [name for name in COMPARED if name in names]
    with instance(content, found, version) as block:
        block.start({"command": size})
        values = [block.get([names[each] for each in chosen])]
        for i in range(COMMUNICATION_STEPS):
            block.step(i * interval, interval)
            values.append(block.get([names[each] for each in chosen]))
    over = f"a step of the command by {size:g} {signals.command_unit(drive)}, {duration:.3g} s"
    losses = []
    for name, column in zip(chosen, np.array(values).T, strict=True):
        size = float(np.abs(run[name]).max())
        if size > 0.0 or column.any():  # an angle that the load holds at 0 compares nothing
            losses.append(ExportLoss.between(name, column - run[name], run.unit(name), size, over))
    return losses


def moving_run(drive: Drive, duration: float, step: float, interval: float) -> tuple[float, Run]:
    """Return the size of a constant command at which a drive moves, and its run; the largest tried if it does not move."""
    size = COMMAND_SIZES.get(signals.command_unit(drive), OTHER_COMMAND)
    largest = MAX_COMMAND_FACTOR * size
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        while True:
            run = simulate(drive, scenario.constant(size, duration), step, sample=interval)
            if run["input_angle"].any() or size >= largest:
                return size, run
            size *= 10.0


class Block:
    """An instance of an FMU in this process."""

    def __init__(self, slave: Any, references: Mapping[str, int], version: int) -> None:
        self.slave, self._references, self._version = slave, references, version

    def start(self, values: Mapping[str, float]) -> None:
        """Initialise with values of inputs and parameters."""
        if self._version == 2:
            self.slave.setupExperiment(startTime=0.0)
        self.set(values)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, values: Mapping[str, float]) -> None:
        references = [self._references[name] for name in values]
        set_reals = self.slave.setReal if self._version == 2 else self.slave.setFloat64
        set_reals(references, list(values.values()))

    def get(self, names: list[str]) -> list[float]:
        get_reals = self.slave.getReal if self._version == 2 else self.slave.getFloat64
        found: list[float] = get_reals([self._references[name] for name in names])
        return found

    def step(self, time: float, length: float) -> None:
        self.slave.doStep(currentCommunicationPoint=time, communicationStepSize=length)


@contextmanager
def instance(content: bytes, found: list[Variable], version: int) -> Iterator[Block]:
    """Load an FMU, and free it in the end."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave
    from fmpy.fmi3 import FMU3Slave

    with ExitStack() as stack:
        folder = stack.enter_context(TemporaryDirectory())
        fmpy.extract(io.BytesIO(content), unzipdir=folder)
        about = fmpy.read_model_description(Path(folder, "modelDescription.xml").as_posix())
        slave = (FMU2Slave if version == 2 else FMU3Slave)(
            guid=about.guid,
            unzipDirectory=folder,
            modelIdentifier=about.coSimulation.modelIdentifier,
            instanceName="comparison",
        )
        slave.instantiate()
        stack.callback(slave.freeInstance)
        yield Block(slave, {each.name: each.reference for each in found}, version)
        slave.terminate()
