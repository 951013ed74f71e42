"""strainwave itself: exponential Runge-Kutta in C++, models chosen at run time, called from Python."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import reference_drive as reference
from reference_drive import Array

from peers import Peer


def prepare(step: float) -> Callable[[], Array]:
    """A run with this step, through the public interface."""
    import strainwave as sw

    orders = range(1, len(reference.ERROR_AMPLITUDE) + 1)
    # The kinematic error counts positive where the output lags; the drive's twist adds where it leads.
    phase = [p + math.pi for p in reference.ERROR_PHASE]
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=reference.RATIO),
        kinematic_error=sw.kinematic_error.Fourier(order=list(orders), amplitude=list(reference.ERROR_AMPLITUDE), phase=phase),
        stiffness=sw.stiffness.Cubic(a1=reference.STIFFNESS_LINEAR, a3=reference.STIFFNESS_CUBIC),
        hysteresis=sw.hysteresis.MaxwellSlip(
            stiffness=[reference.ELEMENT_STIFFNESS] * reference.ELEMENTS,
            breakaway=[reference.ELEMENT_STIFFNESS * limit for limit in reference.ELEMENT_LIMIT],
        ),
        damping=reference.DAMPING,
        friction_input=sw.friction.LuGre(
            coulomb=reference.COULOMB,
            breakaway=reference.BREAKAWAY,
            stribeck_speed=reference.STRIBECK_SPEED,
            bristle_stiffness=reference.BRISTLE_STIFFNESS,
            bristle_damping=reference.BRISTLE_DAMPING,
            viscous=reference.VISCOUS_INPUT,
        ),
        friction_output=sw.friction.Viscous(viscous=reference.VISCOUS_OUTPUT),
        input_inertia=0.0,
    )
    drive = sw.drives.PositionDrive(
        gear=gear,
        motor=sw.motor.DC(
            resistance=reference.RESISTANCE,
            inductance=reference.INDUCTANCE,
            torque_constant=reference.MOTOR_CONSTANT,
            back_emf=reference.MOTOR_CONSTANT,
            inertia=reference.INPUT_INERTIA,
        ),
        control=sw.control.PID(
            proportional=reference.PROPORTIONAL, derivative=reference.DERIVATIVE, limit=reference.VOLTAGE_LIMIT
        ),
        load=sw.loads.Pendulum(inertia=reference.OUTPUT_INERTIA, gravity_torque=reference.GRAVITY_TORQUE),
    )
    command = sw.scenario.ramp(reference.COMMAND_SLOPE, reference.DURATION) + sw.scenario.sine(
        reference.COMMAND_AMPLITUDE, reference.COMMAND_FREQUENCY, reference.DURATION
    )

    def solve() -> Array:
        run = sw.simulate(drive, command, dt=step, sample=reference.SAMPLE)
        return np.column_stack([run["output_angle"], run["torque"]])

    solve()  # the first run imports what the later ones need
    return solve


PEERS = (
    Peer(
        name="strainwave",
        distributions=("strainwave",),
        setting="step",
        ladder=(5e-4, 2e-4, 1e-4),
        prepare=prepare,
    ),
)
