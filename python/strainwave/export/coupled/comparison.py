"""Comparison of an inertia that a coupled drive moves with the simulation of both."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, loads
from strainwave.export.fmu.comparison import moving_run
from strainwave.simulation.signals import command_unit
from strainwave.tuning.loss import ExportLoss

Array = NDArray[np.float64]
COMPARED_DURATION = 1.0  # s, of the run
COMPARED_SAMPLES = 100  # of the run
REFERENCE_STEP_SHARE = 0.25  # of the internal step: step of the simulation


def losses(
    drive: Drive, inertia: float, step: float, exchange: float, words: str, moved: Callable[[float, float, float, int], Array]
) -> Iterator[ExportLoss]:
    """Yield the loss of the output angle over a step of the command, at an interval of exchange and at half of it.

    Args:
        drive: whose load the inertia replaces
        inertia: at the output [kg.m²]
        step: internal step of the drive [s]
        exchange: interval at which angle and torque are exchanged [s]
        words: name of that interval in the other program
        moved: function that returns the angles at the samples of the run [rad], of the command, the angle at the begin, the
            interval of exchange, and the number of intervals from sample to sample
    """
    drive = drive.replace(load=loads.Inertia(inertia=inertia))
    interval = max(1, round(COMPARED_DURATION / COMPARED_SAMPLES / exchange)) * exchange
    duration = COMPARED_SAMPLES * interval
    size, run = moving_run(drive, duration, REFERENCE_STEP_SHARE * min(step, exchange), interval)
    angle = run["output_angle"]
    for halvings in (0, 1):
        every = round(interval / exchange) * 2**halvings
        apart = interval / every
        error = moved(size, float(angle[0]), apart, every) - angle
        over = f"a step of the command by {size:g} {command_unit(drive)}, {duration:.3g} s, {words} {1e3 * apart:.3g} ms"
        yield ExportLoss.between("output_angle", error, "rad", float(np.ptp(angle)), over)
