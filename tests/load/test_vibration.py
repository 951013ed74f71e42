"""How fast a load lets the output vibrate, which steps of a fixed length must follow."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given
from strainwave import _core

from tests.support.geared import RATIO, K, geared
from tests.support.strategies import log_uniform

STIFF = sw.loads.TorsionSpring(inertia=0.01, stiffness=1e6, rest_angle=1e-3)
FAST = [
    (sw.loads.TorsionSpring(inertia=0.01, stiffness=1e6), 1e6),
    (sw.loads.Pendulum(inertia=0.01, gravity_torque=3e4), 3e4),
    (sw.loads.TorqueTable(inertia=0.01, angle=[-1.0, 0.0, 0.5, 2.0], held_torque=[0.0, 2e4, -1e4, 0.0]), 6e4),
    (sw.loads.TorqueTable(inertia=0.01), 0.0),
    (sw.loads.Aerodynamic(inertia=0.01, area=2.0, chord=0.5, airspeed=100.0, density=1.2, moment_slope=-3.0), 1.8e4),
    (sw.loads.Inertia(inertia=0.01), 0.0),
    (sw.loads.Brake(inertia=0.01), 0.0),
]


def fastest(inertia: float, stiffness: float) -> float:
    """The larger eigenfrequency [rad/s] of the rotor on the gear's spring and of the load on both."""
    spring = K * np.array([[1.0 / RATIO**2, -1.0 / RATIO], [-1.0 / RATIO, 1.0]]) + np.diag([0.0, stiffness])
    return float(np.sqrt(np.linalg.eigvals(spring / np.array([[1e-4], [inertia]])).real.max()))


@pytest.mark.parametrize(("load", "stiffness"), FAST, ids=lambda value: getattr(value, "name", ""))
def test_the_vibration_is_that_of_two_masses_on_two_springs(load: Any, stiffness: float) -> None:
    assert _core.natural_frequency(geared(load=load), 0.0) == pytest.approx(fastest(0.01, stiffness), rel=1e-9)


@given(inertia=log_uniform(1e-3, 1e3), stiffness=log_uniform(1e-3, 1e9))
def test_it_is_so_of_any_spring(inertia: float, stiffness: float) -> None:
    load = sw.loads.TorsionSpring(inertia=inertia, stiffness=stiffness)
    assert _core.natural_frequency(geared(load=load), 0.0) == pytest.approx(fastest(inertia, stiffness), rel=1e-9)


def test_steps_too_long_for_a_stiff_load_are_refused_with_those_that_do() -> None:
    """sqrt(k / J) = 1e4 rad/s: steps of 0.2 ms would damp the vibration away, and give a smooth result that is wrong."""
    drive = geared(load=STIFF)
    command = sw.scenario.constant(0.0, 0.02)
    with pytest.raises(FloatingPointError, match=r"too coarse .* rad/s at a twist of 0 rad") as refused:
        sw.simulate(drive, command, 2e-4)
    found = re.search(r"take dt = (\S+) s or less", str(refused.value))
    assert found is not None
    longest = float(found[1])
    assert longest == pytest.approx(1.0 / fastest(0.01, 1e6), rel=0.1)
    sw.simulate(drive, command, longest)
    with pytest.warns(sw.simulation.EnsembleWarning, match="1 of 2 members have no result"):
        sw.simulate_many(drive, command, {"load.stiffness": [1e2, 1e6]}, 2e-4)
