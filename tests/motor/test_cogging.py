"""Cogging of motors with one current: a sine over the angle that takes no energy, and nothing at all without it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.support.flywheel import torque_of
from tests.support.geared import K, geared

MOTORS = [
    sw.motor.DC(torque_constant=0.1, back_emf=0.1, inertia=2e-4),
    sw.motor.DC(torque_constant=0.1, back_emf=0.1, inductance=1e-3, inertia=2e-4),
    sw.motor.BrushlessDC(torque_constant=0.1, inertia=2e-4),
]
EVERY = pytest.mark.parametrize("motor", MOTORS, ids=["dc", "dc with inductance", "brushless"])


@EVERY
@given(angle=st.floats(-3.0, 3.0), torque=st.floats(0.0, 0.1), order=st.integers(1, 84))
def test_cogging_is_a_sine_over_the_angle(motor: Any, angle: float, torque: float, order: int) -> None:
    cogging = motor.replace(cogging_torque=torque, cogging_order=order)
    without = torque_of(motor, 3.0, angle=angle)
    assert torque_of(cogging, 3.0, angle=angle) - without == pytest.approx(torque * np.sin(order * angle), abs=1e-15)


@EVERY
def test_cogging_holds_its_energy(motor: Any) -> None:
    """A rotor without current on the spring of a locked gear, thrown over a cog."""
    names = {"torque_constant": 0.0} | ({"back_emf": 0.0} if hasattr(motor, "back_emf") else {})
    cogging = motor.replace(cogging_torque=0.02, cogging_order=12, **names)
    drive = geared(motor=cogging, load=sw.loads.Prescribed(), damping=0.0).replace(meter=sw.meter.EnergyMeter())
    start = drive.rest().replace(input_speed=200.0)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.05), 1e-5, initial=start, inputs={"output_angle": 0.0})
    assert np.ptp(run["input_angle"]) > 2.0 * np.pi / 12.0
    stored = 0.02 / 12.0 * np.cos(12.0 * run["input_angle"])
    energy = 0.5 * 2e-4 * run["input_speed"] ** 2 + 0.5 * K * run["twist"] ** 2 + stored
    assert energy == pytest.approx(energy[0], rel=1e-9)
    assert run["stored_motor"] == pytest.approx(stored, abs=1e-15)


@EVERY
def test_without_cogging_its_order_changes_no_bit(motor: Any) -> None:
    drives = [geared(motor=motor.replace(cogging_order=order), load=sw.loads.Inertia(inertia=0.1)) for order in (24, 7)]
    one, other = (sw.simulate(drive, sw.scenario.sine(5.0, 10.0, 0.05), 1e-4) for drive in drives)
    assert one["input_angle"].tolist() == other["input_angle"].tolist()
