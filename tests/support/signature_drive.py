"""Drive of section 7.9 of the physics: its signature in the current is known in closed form."""

from __future__ import annotations

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.diagnose.actuator_ramp import ActuatorRamp

ORDER, AMPLITUDE = (1.0, 2.0, 4.0), (0.8e-4, 3e-4, 0.5e-4)
RATIO, INERTIA, STIFFNESS, DAMPING, TORQUE_CONSTANT, SPEED = 100.0, 0.05, 8000.0, 2.0, 0.05, 10.0
DURATION = 6.0


def signature_ramp(load_torque: float) -> ActuatorRamp:
    """Return the drive with its input at 10 rad/s under a load, its speed held by a stiff loop on the motor."""
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=RATIO),
        stiffness=sw.stiffness.Linear(k=STIFFNESS),
        damping=DAMPING,
        input_inertia=1.5e-5,
        kinematic_error=sw.kinematic_error.Fourier(order=ORDER, amplitude=AMPLITUDE, phase=[0.3, -0.8, 0.7]),
    )
    control = sw.control.Cascade(
        position_gain=20.0,
        speed_proportional=2.0,
        speed_integral=20.0,
        current_proportional=1.0,
        current_integral=1000.0,
        speed_limit=200.0,
        current_limit=20.0,
        voltage_limit=48.0,
        speed_feedforward=1.0,
        feedback="input",
    )
    motor = sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=TORQUE_CONSTANT, inertia=1.35e-4)
    drive = sw.Drive(gear=gear, motor=motor, load=sw.loads.Inertia(inertia=INERTIA), control=control)
    return ActuatorRamp.of(drive, SPEED * DURATION / RATIO, DURATION).loaded(load_torque)


def ideal_current(order: float, load_torque: float) -> NDArray[np.complex128]:
    """Return the current per error [A/rad] if the input's speed is held ideally: (H/N + j n T) / K_t."""
    pulsation = order * SPEED
    coupling = STIFFNESS + 1j * pulsation * DAMPING
    inertial = INERTIA * pulsation**2
    followed = inertial * coupling / (coupling - inertial)
    return np.asarray((followed / RATIO + 1j * order * load_torque) / TORQUE_CONSTANT)
