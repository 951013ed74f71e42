"""Real and imaginary part of waves: the same unknowns and derivatives, few steps if a constant nearly makes them up."""

from __future__ import annotations

import numpy as np
import strainwave as sw
from hypothesis import given, settings, strategies as st
from strainwave.identification.fitting.descent import Waves
from strainwave.identification.fitting.unknowns import Unknown

UNKNOWNS = (
    Unknown("load.gravity_torque", "N.m", 1.0, 0.0, np.inf),
    Unknown("load.gravity_phase", "rad", 0.0, -np.inf, np.inf),
    Unknown("load.inertia", "kg.m2", 1.0, 0.0, np.inf),
)


@settings(max_examples=50, deadline=None)
@given(st.floats(0.1, 10.0), st.floats(-6.0, 6.0), st.floats(0.1, 10.0), st.floats(-3.0, 3.0))
def test_parts_give_back_unknowns_and_their_derivatives(begun: float, phase: float, amplitude: float, turned: float) -> None:
    waves = Waves.of(UNKNOWNS, np.array([begun, phase, 1.0]), np.arange(3))
    x = np.array([amplitude, phase + turned, 2.0])
    parts = waves.parts(x)
    assert np.allclose(waves.unknowns(parts), x, rtol=1e-9, atol=1e-9)
    steps = [1e-6 * np.eye(3)[place] for place in range(3)]
    numeric = np.stack([(waves.unknowns(parts + step) - waves.unknowns(parts - step)) / 2e-6 for step in steps], axis=1)
    assert np.allclose(waves.slopes(np.eye(3), x), numeric, rtol=1e-5, atol=1e-6)


def test_a_limited_or_held_phase_is_no_wave() -> None:
    start = np.array([1.0, 0.0, 1.0])
    limited = (UNKNOWNS[0], Unknown("load.gravity_phase", "rad", 0.0, -1.0, 1.0))
    assert not len(Waves.of(limited, start, np.arange(2)).phase)
    assert not len(Waves.of(UNKNOWNS, start, np.array([0, 2])).phase)


def test_gravity_over_a_small_angle_takes_few_evaluations() -> None:
    """A cosine over .05 rad is nearly the zero of the torque: by amplitude and phase the fit took more than twenty."""
    from strainwave.identification.experiments.motion_log import MotionLog

    time = np.arange(0.0, 20.0, 0.01)
    angle = 0.05 * np.sin(1.3 * time) + 0.02 * np.sin(3.1 * time)
    speed, rise = np.gradient(angle, time), np.gradient(np.gradient(angle, time), time)
    torque = 1e-4 * 100.0 * rise + 0.02 * np.tanh(speed / 1e-3) + 0.05 * np.sin(angle)
    torque += 1e-3 * np.random.default_rng(0).standard_normal(len(time))
    log = sw.Recording({"time": time, "output_angle": angle, "input_torque": torque},
                       {"time": "s", "output_angle": "rad", "input_torque": "N.m"})  # fmt: skip
    law = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=0.0)
    drive = sw.Drive(
        gear=sw.load("csg-20-100").replace(friction_input=law),
        motor=sw.motor.CurrentSource(torque_constant=0.1, inertia=1e-5),
        load=sw.loads.Pendulum(inertia=0.8, gravity_torque=8.0, gravity_phase=0.5),
    )
    free = ["gear.friction_input.coulomb", "load.inertia", "load.gravity_torque", "load.gravity_phase"]
    assert sw.fit(drive, MotionLog.of(log, drive), free).evaluations < 10
