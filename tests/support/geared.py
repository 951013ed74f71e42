"""A small drive whose steady and linear views have closed forms."""

from __future__ import annotations

import numpy as np
import strainwave as sw
from strainwave import _core
from strainwave.simulation import signals
from strainwave.simulation.state import State

K, RATIO = 1e4, 20.0
MOTOR = sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.12, inertia=1e-4)
SERVO = sw.motor.PMSM(
    resistance=0.5,
    direct_inductance=1e-3,
    quadrature_inductance=1e-3,
    flux_linkage=0.1 / 7.5,
    pole_pairs=5,
    inertia=1e-4,
    supply_voltage=24.0 * np.sqrt(3.0),
    current_limit=10.0,
)
ARM = sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0)


def geared(load: object = ARM, control: object = None, motor: sw.motor.DC = MOTOR, **parts: object) -> sw.Drive:
    """A motor, a gear of ratio 20 with a linear spring, and a load; in open loop if no controller is given."""
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=RATIO), stiffness=sw.stiffness.Linear(k=K), damping=5.0)
    return sw.Drive(gear=gear.replace(**parts), motor=motor, control=control or sw.control.OpenLoop(), load=load)


def outputs(drive: sw.Drive, state: State, *inputs: float) -> dict[str, float]:
    """The outputs in a state under command, load torque and temperature."""
    command, load_torque, temperature = (*inputs, *(0.0, 0.0, 293.15)[len(inputs) :])
    values = _core.now(drive, state.numbers, np.array([command, 0.0, load_torque, 0.0, temperature, 0.0]))[:, 0]
    return {name: float(values[each.channel]) for name, each in signals.outputs(drive).items()}
