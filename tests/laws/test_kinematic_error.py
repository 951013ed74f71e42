"""What every kinematic error obeys: bounded, its slope is its derivative, and it repeats itself with its orders."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core
from strainwave.kinematic_error import Fourier
from strainwave.simulation.signals import outputs

from tests.support.strategies import built, models

errors = models("kinematic_error")
fourier = built(Fourier)
whole_orders = fourier.map(lambda error: error.replace(order=np.rint(error.order)))
angles = st.floats(-math.pi, math.pi)

TURN = np.linspace(0.0, 2.0 * math.pi, 721)


@pytest.mark.slow("physics")
@given(errors, angles)
def test_slope_is_the_derivative_of_the_error(error: Any, angle: float) -> None:
    h = 1e-5
    outer, inner = (np.diff(error.error([angle - d, angle + d]))[0] / (2.0 * d) for d in (2.0 * h, h))
    steepest, largest = np.abs(error.slope(TURN)).max(), np.abs(error.error(TURN)).max()
    geometry = 1e-15 * math.tan(getattr(error, "pressure_angle", 0.0))  # radii are rounded before they become an angle
    slack = 1e-8 * steepest + 1e-15 * largest / h + geometry / h + 2.0 * abs(outer - inner)  # the two differ at a corner
    assert error.slope(angle) == pytest.approx((4.0 * inner - outer) / 3.0, rel=0.0, abs=slack)


@given(errors, st.lists(angles, min_size=1, max_size=4))
def test_an_array_of_angles_gives_what_each_angle_gives(error: Any, angle: list[float]) -> None:
    for verb in (error.error, error.slope):
        assert verb([angle, angle]).tolist() == 2 * [[verb(x) for x in angle]]


@given(fourier, angles)
def test_fourier_stays_below_the_sum_of_its_amplitudes(error: Fourier, angle: float) -> None:
    assert abs(error.error(angle)) <= sum(error.amplitude) * (1.0 + 1e-14)
    slope = sum(amplitude * order for amplitude, order in zip(error.amplitude, error.order, strict=True))
    assert abs(error.slope(angle)) <= slope * (1.0 + 1e-13)


@given(whole_orders, angles, st.integers(-3, 3))
def test_fourier_of_whole_orders_repeats_with_each_turn(error: Fourier, angle: float, turns: int) -> None:
    later = error.error(angle + 2.0 * math.pi * turns)
    harmonics = zip(error.amplitude, error.order, strict=True)
    rounding = 1e-14 * sum(amplitude * (1.0 + order) for amplitude, order in harmonics)
    assert later == pytest.approx(error.error(angle), rel=0.0, abs=rounding)


@given(fourier, angles)
def test_fourier_is_the_sum_of_its_harmonics(error: Fourier, angle: float) -> None:
    harmonics = [
        amplitude * math.sin(order * angle + phase)
        for order, amplitude, phase in zip(error.order, error.amplitude, error.phase, strict=True)
    ]
    assert error.error(angle) == pytest.approx(math.fsum(harmonics), rel=0.0, abs=1e-13 * sum(error.amplitude))


@given(fourier, angles, st.integers(-1_000_000_000, 1_000_000_000))
def test_an_error_is_as_exact_after_many_turns_as_its_orders_are(error: Fourier, angle: float, turns: int) -> None:
    """The reference counts the fraction of a turn that each order has advanced in exact fractions."""
    drive = sw.Drive(gear=sw.Gear(kinematic_error=error))
    state = drive.rest()
    turned = state.replace(turns=float(turns), input_angle=angle)
    column = list(outputs(sw.Drive())).index("kinematic_error")
    expected = rounding = 0.0
    for order, amplitude, phase in zip(error.order, error.amplitude, error.phase, strict=True):
        share = float(Fraction(order) * turns % 1)
        expected += amplitude * math.sin(order * angle + phase + 2.0 * math.pi * share)
        rounding += amplitude * (1e-13 + (0.0 if order.is_integer() else 2.0 * math.pi * math.ulp(order * turns)))
    found = _core.now(drive, turned.numbers, np.array([0.0, 0.0, 0.0, 0.0, 293.15, 0.0]))[column, 0]
    assert found == pytest.approx(expected, rel=0.0, abs=rounding)
