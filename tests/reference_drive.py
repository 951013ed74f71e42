"""The reference drive of the benchmarks: a position-controlled joint with every nonlinearity of a strain wave gear."""

from __future__ import annotations

import numpy as np
import strainwave as sw

ORDERS = np.arange(1, 11)
PHASES = np.array([0.3, 0.7, 1.1, 2.1, 0.2, 0.9, 1.7, 2.6, 0.5, 1.3])  # of the benchmarks' error, which is -e
SLIP = 5e-5 * 1.6 ** np.arange(8)  # twist at which each Maxwell element slips [rad]
STIFFNESS = np.full(8, 3e3 / 8)

DRIVE = sw.drives.PositionDrive(
    gear=sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=100.0),
        kinematic_error=sw.kinematic_error.Fourier(
            order=ORDERS, amplitude=np.where(ORDERS == 2, 2e-4, 2e-5 / ORDERS), phase=PHASES + np.pi
        ),
        stiffness=sw.stiffness.Cubic(a1=1.2e4, a3=1e9),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=STIFFNESS, breakaway=STIFFNESS * SLIP),
        damping=10.0,
        friction_input=sw.friction.LuGre(
            coulomb=0.03,
            breakaway=0.045,
            stribeck_speed=2.0,
            bristle_stiffness=50.0,
            bristle_damping=0.02,
            viscous=5e-5,
        ),
        friction_output=sw.friction.Viscous(viscous=0.5),
    ),
    motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
    control=sw.control.PID(proportional=2.0, derivative=0.05, limit=48.0),
    load=sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0),
)


def command(duration: float) -> sw.scenario.Scenario:
    """0.3 t + 0.2 sin(4 pi t) [rad]: a slow rise with reversals."""
    return sw.scenario.ramp(0.3, duration) + sw.scenario.sine(0.2, 2.0, duration)
