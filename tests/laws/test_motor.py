"""What every motor obeys, whatever it is made of: what it takes is lost, stored, or given to its shaft."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core

from tests.support.flywheel import instant, turning
from tests.support.geared import geared
from tests.support.strategies import log_uniform, models, signed

motors = models("motor").filter(lambda motor: motor.inertia > 0.0)
asked = st.just(0.0) | signed(log_uniform(1e-2, 1e3))
currents = st.just(0.0) | signed(log_uniform(1e-3, 1e2))
speeds = st.just(0.0) | signed(log_uniform(1e-2, 1e3))
temperatures = st.floats(250.0, 400.0)


def alone(motor: Any) -> sw.Drive:
    """On a gear that transmits nothing as long as it is not wound up, with its powers measured."""
    drive = geared(motor=motor, load=sw.loads.Inertia(inertia=0.1), damping=0.0)
    return drive.replace(meter=sw.meter.EnergyMeter())


@st.composite
def running(draw: st.DrawFn, motor: st.SearchStrategy[Any] = motors) -> tuple[sw.Drive, Any, float, float]:
    """A motor at any speed, angle and currents: drive, state, actuation and temperature."""
    drive = alone(draw(motor))
    held = {name: draw(currents) for name in drive.rest() if name.startswith("motor.")}
    placed = turning(drive, draw(speeds), held | {"input_angle": draw(st.floats(-3.0, 3.0))})
    return drive, placed, draw(asked), draw(temperatures)


def ideal(motor: Any) -> Any:
    """Of a torque constant and a back-EMF that differ, one sense of the power is given more than it takes."""
    return motor.replace(back_emf=motor.torque_constant) if type(motor) is sw.motor.DC else motor


@given(running())
def test_what_it_takes_is_lost_stored_or_given_to_its_shaft(drawn: tuple[sw.Drive, Any, float, float]) -> None:
    """u i = losses + d(stored)/dt + torque x speed, at any instant: the torque is that which accelerates its inertia."""
    drive, state, actuation, temperature = drawn
    rates, shown, changes = instant(drive, state, actuation, 0.0, temperature)
    torque = drive.motor.inertia * rates["input_speed"]
    given_ = torque * state.input_speed
    parts = [shown["power_motor"], changes["stored_motor"], given_]
    scale = max(abs(shown["power_supplied"]), *map(abs, parts), _largest(drive, state, rates, shown))
    assert shown["power_supplied"] == pytest.approx(sum(parts), abs=1e-12 * scale)


def _largest(drive: sw.Drive, state: Any, rates: dict[str, float], shown: dict[str, float]) -> float:
    """The largest of the powers that cancel each other within what is compared [W]."""
    names = ("inductance", "quadrature_inductance", "direct_inductance")
    inductances = [getattr(drive.motor, name) for name in names if hasattr(drive.motor, name)]
    moved = [abs(rates[name] * state[name]) for name in state if name.startswith("motor.")]
    current = shown.get("current", 0.0)
    electric = [abs(shown.get("voltage", 0.0) * current), getattr(drive.motor, "resistance", 0.0) * current**2]
    return max(1e-300, *electric, *(1.5 * a * b for a in inductances for b in moved))


@given(running(motors.map(ideal)))
def test_it_never_loses_less_than_nothing(drawn: tuple[sw.Drive, Any, float, float]) -> None:
    drive, state, actuation, temperature = drawn
    assert instant(drive, state, actuation, 0.0, temperature)[1]["power_motor"] >= 0.0


@given(running())
def test_its_mirror_image_does_the_opposite(drawn: tuple[sw.Drive, Any, float, float]) -> None:
    """Turned and fed the other way, it gives the same torque the other way; a current along magnets knows no sense."""
    drive, state, actuation, temperature = drawn
    turned = {name: -state[name] for name in state if name in MIRRORED}
    rates, shown, _ = instant(drive, state, actuation, 0.0, temperature)
    opposite, mirrored, _ = instant(drive, state.replace(turned), -actuation, 0.0, temperature)
    assert opposite["input_speed"] == -rates["input_speed"]
    for name in ("current", "voltage", "direct_voltage"):
        if name in shown:
            assert mirrored[name] == (shown[name] if name == "direct_voltage" else -shown[name])
    assert (mirrored["power_supplied"], mirrored["power_motor"]) == (shown["power_supplied"], shown["power_motor"])


MIRRORED = ("motor.current", "motor.quadrature_current", "input_angle", "input_speed", "output_speed")


@given(running())
def test_what_it_is_given_lies_within_the_limits_that_it_hands_back(drawn: tuple[sw.Drive, Any, float, float]) -> None:
    """What it takes more than that changes nothing."""
    drive, state, actuation, temperature = drawn
    inputs = np.array([actuation, 0.0, 0.0, 0.0, temperature, 0.0])
    low, high = _core.measured(drive, state.numbers, inputs)[-2:]
    assert low <= high
    within = float(np.clip(actuation, low, high))
    rates, shown, _ = instant(drive, state, actuation, 0.0, temperature)
    assert shown[_core.actuation(drive)[0]] == within
    assert instant(drive, state, within, 0.0, temperature)[0] == rates
