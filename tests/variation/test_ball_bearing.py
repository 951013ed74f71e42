"""Stiffness of the wave generator's bearing against the sum over its single balls, which roll between their rings."""

from __future__ import annotations

from math import cos, pi, tau
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave.variation import BallBearing

Array = NDArray[np.float64]

BEARING: dict[str, Any] = {
    "balls": 22,
    "ball_diameter": 4.8e-3,
    "pitch_diameter": 46e-3,
    "contact_angle": 0.2,
    "loaded_share": 0.3,
    "outer_speed": -0.01,
}


def ball_angle(law: BallBearing, theta: Array) -> Array:
    """Angle of the first ball from the first lobe: its centre has the mean of the speeds of both contacts, without slip."""
    reach = 0.5 * law.ball_diameter * cos(law.contact_angle)
    inner, outer = 0.5 * law.pitch_diameter - reach, 0.5 * law.pitch_diameter + reach
    cage = 0.5 * (inner * 1.0 + outer * law.outer_speed) / (0.5 * law.pitch_diameter)
    return law.phase + (cage - 1.0) * theta


def summed(law: BallBearing, theta: Array) -> Array:
    """Sum over the stiffness of all balls; that of the middle of a zone is 2 times the lobe's share."""
    half_zone = 0.5 * pi * law.loaded_share
    total = np.zeros_like(theta)
    for ball in range(law.balls):
        for lobe, share in ((0.0, law.first_lobe), (pi, 1.0 - law.first_lobe)):
            place = ball_angle(law, theta) + tau * ball / law.balls - lobe
            place -= tau * np.rint(place / tau)
            total += np.where(np.abs(place) < half_zone, share * (1.0 + np.cos(pi * place / half_zone)), 0.0)
    return total


def order_of(law: BallBearing) -> float:
    """Balls that pass a lobe in a turn of the input."""
    turn = ball_angle(law, np.array([0.0, tau]))
    return law.balls * float(turn[0] - turn[1]) / tau


@pytest.mark.parametrize("balls", [21, 22, 23])
@pytest.mark.parametrize("first_lobe", [0.5, 0.7])
@given(st.floats(0.15, 0.6), st.floats(-3.0, 3.0), st.sampled_from([0.0, -0.01, 0.0125]))
def test_each_multiple_is_that_of_the_sum_over_single_balls(
    balls: int, first_lobe: float, loaded_share: float, phase: float, outer_speed: float
) -> None:
    """Fourier coefficients over one passing of a ball; 4096 samples leave 1e-8 of a wave whose second derivative jumps."""
    changed = {
        "balls": balls,
        "first_lobe": first_lobe,
        "loaded_share": loaded_share,
        "phase": phase,
        "outer_speed": outer_speed,
    }
    law = BallBearing(**(BEARING | changed))
    samples = 4096
    theta = tau / order_of(law) * np.arange(samples) / samples
    single, whole = summed(law, theta), law.factor(theta)
    known, found = (np.fft.rfft(values)[:9] / np.fft.rfft(values)[0].real for values in (single, whole))
    np.testing.assert_allclose(found, known, rtol=0.0, atol=1e-6)


def test_equal_lobes_and_an_odd_number_of_balls_leave_even_multiples_alone() -> None:
    odd, even = (BallBearing(**(BEARING | {"balls": balls})) for balls in (23, 22))
    for law, first in (odd, 2), (even, 1):
        theta = tau / order_of(law) * np.arange(256) / 256
        waves = np.abs(np.fft.rfft(law.factor(theta)))[1:5]
        assert np.flatnonzero(waves > 1e-9 * waves.max())[0] + 1 == first


def test_its_order_is_that_of_a_place_of_the_inner_ring() -> None:
    geometry = {name: value for name, value in BEARING.items() if name != "loaded_share"}
    orders = sw.orders.bearing_orders(**geometry)
    law = BallBearing(**BEARING)
    assert orders.inner_ring == pytest.approx(order_of(law), rel=1e-12)
    assert orders.inner_ring == pytest.approx(22 * (1.0 - orders.cage), rel=1e-12)
    assert law.factor(0.3) == pytest.approx(law.factor(0.3 + tau / orders.inner_ring), abs=1e-12)


def test_with_the_torque_by_which_it_turns_the_wave_generator_energy_is_conserved() -> None:
    """The only spring of the gear varies; nothing damps."""
    drive = sw.Drive(
        gear=sw.Gear(stiffness=sw.stiffness.Linear(k=2e4), stiffness_variation=BallBearing(**BEARING)),
        motor=sw.motor.TorqueSource(inertia=5e-5),
        control=sw.control.OpenLoop(),
        load=sw.loads.Inertia(inertia=0.02),
        meter=sw.meter.EnergyMeter(),
    )
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.02), 1e-5, initial={"input_speed": 100.0, "twist": 2e-3})
    stored = sum(run[name] for name in run.names if name.startswith("stored_"))
    assert np.ptp(stored) < 1e-7 * stored[0]
    assert np.ptp(run["input_speed"]) > 1.0


def test_a_running_gear_shows_the_order_of_the_passing_balls() -> None:
    """In the bearing force of stages under a constant load."""
    part = sw.structure.Staged(
        pitch_radius=25e-3,
        coupling_stiffness=5e3,
        coupling_damping=5.0,
        bearing_stiffness=5e6,
        bearing_damping=500.0,
        mesh_stiffness=1e8,
        mesh_damping=5e3,
        circular_spline_stiffness=1e5,
        circular_spline_damping=30.0,
        radial_mass=0.032,
        flexspline_inertia=2e-5,
        circular_spline_inertia=3e-4,
        bearing_variation=BallBearing(**BEARING),
    )
    drive = sw.Drive(
        gear=sw.Gear(structure=part, input_inertia=1e-2, damping=10.0),
        motor=sw.motor.AccelerationSource(inertia=1.0),
        control=sw.control.OpenLoop(),
        load=sw.loads.Inertia(inertia=0.1),
    )
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.5), 2e-5, load_torque=20.0, initial={"input_speed": 60.0}, sample=2e-4)
    order = order_of(BallBearing(**BEARING))
    found = sw.orders.order_amplitudes(run, "transmission_error", [order, 2.0 * order, order + 1.5])
    assert found.amplitude[0] > 20.0 * max(found.amplitude[1:])


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"ball_diameter": 8e-3}, "the balls must fit on their circle"),
        ({"loaded_share": 0.02}, "loaded_share = 0.02 is too small for balls = 22"),
    ],
)
def test_a_bearing_that_cannot_be_is_refused(changed: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        BallBearing(**(BEARING | changed))
