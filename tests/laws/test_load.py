"""What every load obeys: it gives back no more than it has taken, and its input adds to it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.load.free import free, placed
from tests.support.flywheel import instant
from tests.support.geared import outputs
from tests.support.strategies import log_uniform, models, signed

loads = models("loads")
moved = loads.filter(lambda load: hasattr(load, "inertia"))  # by torques
pushed = moved.filter(lambda load: not isinstance(load, sw.loads.Brake))  # by a torque that adds to its own
angles = st.floats(-6.0, 6.0)
speeds = st.just(0.0) | signed(log_uniform(1e-3, 1e2))
torques = st.just(0.0) | signed(log_uniform(1e-2, 1e3))


def held(load: Any, angle: float, speed: float = 0.0, given_: float = 0.0) -> float:
    """The torque [N.m] that holds the output back."""
    drive = free(load)
    return outputs(drive, placed(drive, angle, speed), 0.0, given_)["load_torque"]


@given(pushed, angles, speeds, torques)
def test_the_load_torque_of_a_run_adds_to_it(load: Any, angle: float, speed: float, push: float) -> None:
    own = held(load, angle, speed)
    assert held(load, angle, speed, push) == pytest.approx(own + push, rel=1e-15)


@given(moved, angles, speeds)
def test_motion_only_ever_costs(load: Any, angle: float, speed: float) -> None:
    """What a load takes more while it moves than at rest, at one angle, opposes the motion: the rest is held by its angle."""
    assert (held(load, angle, speed, 1.0) - held(load, angle, 0.0, 1.0)) * speed >= 0.0


@given(moved, angles, speeds, torques)
def test_the_torque_slows_its_inertia(load: Any, angle: float, speed: float, given_: float) -> None:
    """J dw/dt = -T_load of a body that nothing else moves; and its power is what the meter shows."""
    drive = free(load)
    state = placed(drive, angle, speed)
    rates, shown, _ = instant(drive, state, 0.0, given_)
    if speed or not isinstance(load, sw.loads.Brake):
        assert load.inertia * rates["output_speed"] == pytest.approx(-shown["load_torque"], rel=1e-14, abs=1e-25)
    assert shown["power_load"] == pytest.approx(shown["load_torque"] * speed, rel=1e-15)
    assert shown["stored_output"] == pytest.approx(0.5 * load.inertia * speed**2, rel=1e-15)


@given(moved, angles, st.floats(0.01, 1.0))
def test_a_slow_way_there_and_back_costs_nothing_but_friction(load: Any, start: float, way: float) -> None:
    """The work over a way and back: none of a torque over the angle alone, and of a brake never less."""
    there = start + way * np.linspace(0.0, 1.0, 21)
    forth = [held(load, angle, 1e-9, 1.0) for angle in there]
    back = [held(load, angle, -1e-9, 1.0) for angle in there]
    work = np.trapezoid(forth, there) - np.trapezoid(back, there)
    scale = np.abs(forth).max() * way
    assert work >= -1e-12 * scale
    if not isinstance(load, sw.loads.Brake):
        assert work == pytest.approx(0.0, abs=1e-6 * scale + 1e-9)
