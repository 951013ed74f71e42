"""A load that moves by itself: the gear's spring is next to none."""

from __future__ import annotations

from typing import Any

import strainwave as sw
from strainwave.simulation.state import State

from tests.support.geared import geared

NONE = sw.stiffness.Linear(k=1e-30)


def free(load: Any, **parts: Any) -> sw.Drive:
    """The load behind a gear that transmits nothing, with all energies measured."""
    drive = geared(load=load, motor=sw.motor.TorqueSource(inertia=1.0), stiffness=NONE, damping=0.0, **parts)
    return drive.replace(meter=sw.meter.EnergyMeter())


def placed(drive: sw.Drive, angle: float, speed: float = 0.0) -> State:
    """The output at an angle and a speed, the input at 0 and at rest."""
    return drive.rest().replace(transmission_error=-angle, output_speed=speed)


def held(load: Any, **parts: Any) -> sw.Drive:
    """The load on the gear's spring, whose input does not move."""
    return geared(load=load, motor=sw.motor.TorqueSource(inertia=1e12), **({"damping": 0.0} | parts))


def run_of(drive: sw.Drive, duration: float, dt: float, start: State | None = None, **others: Any) -> sw.Run:
    return sw.simulate(drive, sw.scenario.constant(0.0, duration), dt, initial=start, **others)
