"""Modes that orders pass over the speed, from sums in closed form: u = Re(f / 2 [H((q + n) Ω) + H((q - n) Ω)] e^(j q θ))."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from math import tau

import numpy as np
import pytest
import strainwave as sw

UNITS = {"time": "s", "input_angle": "rad", "output_angle": "rad"}
Mode = tuple[float, float, int, Mapping[float, complex]]  # frequency [Hz], damping, waves, force of each order


def receptance(passes: float, speed: float, frequency: float, damping: float) -> complex:
    ratio = passes * speed / (tau * frequency)
    return 1.0 / (1.0 - ratio**2 + 2j * damping * ratio)


def at_constant_speeds(
    modes: Sequence[Mode], fastest: float, count: int = 60, column: str = "output_angle", noise: float = 1e-7
) -> list[sw.Recording]:
    """Return recordings of eight revolutions each, with order 2 and 4 of an error that does not vibrate."""
    random = np.random.default_rng(count)
    recordings = []
    for speed in tau * np.linspace(0.1 * fastest, fastest, count):
        angle = np.linspace(0.0, 8.0 * tau, 240)
        error = 2e-5 * np.cos(2.0 * angle) + 1e-5 * np.sin(4.0 * angle) + random.normal(0.0, noise, len(angle))
        for frequency, damping, waves, forces in modes:
            for order, force in forces.items():
                both = sum(receptance(passes, speed, frequency, damping) for passes in (order + waves, order - waves))
                error += np.real(0.5 * force * both * np.exp(1j * order * angle))
        columns = {"time": angle / speed, "input_angle": angle, column: error + (angle / 80.0 if column in UNITS else 0.0)}
        recordings.append(sw.Recording(columns, {name: UNITS.get(name, "m/s2") for name in columns}))
    return recordings


@cache
def travelling() -> sw.orders.RingModes:
    mode = (120.0, 0.03, 2, {2.0: 4e-6, 4.0: 3e-6j})
    return sw.orders.ring_modes(at_constant_speeds([mode], 40.0), "output_angle", orders=[2.0, 4.0])


@pytest.mark.slow("orders")
def test_two_orders_separate_frequency_and_waves() -> None:
    (mode,) = travelling().modes
    assert mode.waves == 2
    assert mode.natural_frequency == pytest.approx(tau * 120.0, abs=2.0 * mode.natural_frequency_sigma)
    assert mode.natural_frequency_sigma < tau * 0.5
    assert mode.damping == pytest.approx(0.03, abs=2.0 * mode.damping_sigma)
    assert mode.damping_sigma < 0.0025
    assert mode.orders == (2.0, 4.0)


@pytest.mark.slow("orders")
def test_the_critical_speeds_are_those_of_both_lines() -> None:
    (mode,) = travelling().modes
    speeds = sorted((order, round(speed / tau)) for order, speed in mode.candidates[0].critical_speeds)
    assert speeds == [(2.0, 30), (4.0, 20), (4.0, 60)]


@pytest.mark.slow("orders")
def test_the_picture_has_a_panel_for_each_order() -> None:
    assert len(travelling().plot().axes) == 2


@pytest.mark.slow("orders")
def test_one_order_leaves_several_waves_in_words() -> None:
    mode = (60.0, 0.03, 0, {2.0: 4e-6})
    found = sw.orders.ring_modes(at_constant_speeds([mode], 40.0), "output_angle", orders=[2.0, 4.0])
    (passed,) = found.modes
    assert passed.waves is None
    assert np.isnan(passed.natural_frequency)
    frequencies = {each.waves: each.natural_frequency / tau for each in passed.candidates}
    assert frequencies[0] == pytest.approx(60.0, rel=0.01)
    assert frequencies[2] == pytest.approx(120.0, rel=0.01)
    assert "not separable: order 2 alone passes it: run to" in passed.separated_by


@pytest.mark.slow("orders")
def test_a_mode_beyond_the_speeds_is_not_stated() -> None:
    mode = (300.0, 0.03, 0, {2.0: 4e-6, 4.0: 3e-6})
    found = sw.orders.ring_modes(at_constant_speeds([mode], 40.0), "output_angle", orders=[2.0, 4.0])
    assert found.modes == ()


@pytest.mark.slow("orders")
def test_orders_that_do_not_change_have_no_mode() -> None:
    found = sw.orders.ring_modes(at_constant_speeds([], 40.0), "output_angle", orders=[2.0, 4.0])
    assert found.modes == ()


@pytest.mark.slow("orders")
def test_a_sensor_that_stands_does_not_determine_waves() -> None:
    mode = (100.0, 0.03, 0, {2.0: 4e-6, 4.0: 3e-6})
    recordings = at_constant_speeds([mode], 60.0, column="vibration")
    (passed,) = sw.orders.ring_modes(recordings, "vibration", orders=[2.0, 4.0]).modes
    assert passed.waves is None
    assert passed.natural_frequency == pytest.approx(tau * 100.0, abs=2.0 * passed.natural_frequency_sigma)
    assert "whatever the waves" in passed.separated_by


@pytest.mark.slow("orders")
def test_two_modes_are_separated_by_orders_that_are_found() -> None:
    modes = [(60.0, 0.03, 0, {2.0: 4e-6, 4.0: 2e-6}), (140.0, 0.02, 3, {1.0: 3e-6, 2.0: 3e-6, 4.0: 4e-6})]
    found = sw.orders.ring_modes(at_constant_speeds(modes, 45.0, count=120), "output_angle")
    assert set(found.orders) == {1.0, 2.0, 4.0}
    assert [mode.waves for mode in found.modes] == [0, 3]
    for mode, (frequency, damping, _, _) in zip(found.modes, modes, strict=True):
        assert mode.natural_frequency == pytest.approx(tau * frequency, abs=2.0 * mode.natural_frequency_sigma)
        assert mode.damping == pytest.approx(damping, abs=2.0 * mode.damping_sigma)


def test_one_speed_is_too_little() -> None:
    found = sw.orders.ring_modes(at_constant_speeds([], 40.0)[:1], "output_angle", orders=[2.0])
    assert found.modes == ()
    assert "stretches determine no mode" in found.remarks[0]


@pytest.mark.parametrize(
    ("recordings", "column", "message"),
    [([], "output_angle", "has none"), (None, "nothing", "nothing")],
)
def test_what_is_missing_is_named(recordings: list[sw.Recording] | None, column: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sw.orders.ring_modes(at_constant_speeds([], 40.0)[:2] if recordings is None else recordings, column)
