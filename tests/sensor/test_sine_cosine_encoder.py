"""A sensor of two tracks: its error against the arctangent of them, its orders and its steps in closed form."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.sensor.probe import Array
from tests.sensor.test_encoder import seen

PERIODS = 128
TURN = tau / 4096 * np.arange(4096) - 0.5 * tau  # 32 samples a period
offsets, phases = st.floats(-0.25, 0.25), st.floats(-0.5, 0.5)


def error(law: sw.sensor.SineCosineEncoder) -> Array:
    """Of the phase [rad], over a turn."""
    return (seen(law, TURN) - TURN) * law.periods


def order(values: Array, periods: float) -> complex:
    """Amplitude of the sine, and that of the cosine as the imaginary part, of so many periods a turn."""
    wave = np.exp(1j * periods * TURN)
    return complex(2.0 * np.mean(values * wave.imag), 2.0 * np.mean(values * wave.real))


@given(offsets, offsets, st.floats(0.5, 2.0), phases, st.floats(0.0, 0.05), st.lists(st.floats(-50.0, 50.0), max_size=8))
def test_it_shows_the_argument_of_its_tracks(
    cosine: float, sine: float, ratio: float, quadrature: float, step: float, angles: list[float]
) -> None:
    """By numpy's argument, on the branch that is nearest to the true phase."""
    law = sw.sensor.SineCosineEncoder(
        periods=50,
        cosine_offset=cosine,
        sine_offset=sine,
        amplitude_ratio=ratio,
        quadrature_error=quadrature,
        converter_step=step,
    )
    x = np.array(angles)
    first, second = np.cos(50.0 * x) + cosine, ratio * np.sin(50.0 * x + quadrature) + sine
    found = (seen(law, x) - x) * 50.0
    assert np.abs(found).max(initial=0.0) < 0.25 * tau
    if step == 0.0:
        around = np.angle((first + 1j * second) * np.exp(-50j * x))
        assert found == pytest.approx(around, abs=1e-9)
    else:  # each track lies half a step beside its own at the most
        beside = np.abs(np.sin(found + 50.0 * x) * first - np.cos(found + 50.0 * x) * second)
        assert np.all(beside <= step / np.sqrt(2.0) + 1e-9)


@pytest.mark.parametrize("size", [1e-4, -3e-4])
def test_offsets_are_the_first_order_of_a_period(size: float) -> None:
    of_cosine = error(sw.sensor.SineCosineEncoder(periods=PERIODS, cosine_offset=size))
    of_sine = error(sw.sensor.SineCosineEncoder(periods=PERIODS, sine_offset=size))
    assert order(of_cosine, PERIODS) == pytest.approx(complex(-size, 0.0), abs=size**2)
    assert order(of_sine, PERIODS) == pytest.approx(complex(0.0, size), abs=size**2)
    for found in (of_cosine, of_sine):
        assert abs(order(found, 2 * PERIODS)) < size**2


@pytest.mark.parametrize("size", [1e-4, -3e-4])
def test_unequal_amplitudes_and_the_quadrature_error_are_the_second_order(size: float) -> None:
    """Half of r - 1, and half of the quadrature error, whose mean stays."""
    unequal = error(sw.sensor.SineCosineEncoder(periods=PERIODS, amplitude_ratio=1.0 + size))
    leading = error(sw.sensor.SineCosineEncoder(periods=PERIODS, quadrature_error=size))
    assert order(unequal, 2 * PERIODS) == pytest.approx(complex(0.5 * size, 0.0), abs=size**2)
    assert order(leading, 2 * PERIODS) == pytest.approx(complex(0.0, 0.5 * size), abs=size**2)
    assert np.mean(leading) == pytest.approx(0.5 * size, abs=size**2)
    for found in (unequal, leading):
        assert abs(order(found, PERIODS)) < size**2


def test_large_errors_have_the_orders_of_an_ellipse() -> None:
    """Of unequal amplitudes alone tan y = r tan x: order 2 n has ((r - 1) / (r + 1))^n / n."""
    found = error(sw.sensor.SineCosineEncoder(periods=PERIODS, amplitude_ratio=1.5))
    for n in (1, 2, 3):
        assert order(found, 2 * n * PERIODS) == pytest.approx(complex(0.2**n / n, 0.0), abs=1e-9)


def test_without_errors_it_is_ideal() -> None:
    assert seen(sw.sensor.SineCosineEncoder(periods=2048), TURN) == pytest.approx(TURN, rel=0.0, abs=1e-12)


@pytest.mark.parametrize("bits", [8, 10, 12])
def test_the_steps_of_the_converters_are_as_noise_of_a_uniform_one(bits: int) -> None:
    """Both tracks have the variance h^2 / 12, and the phase sees that across its own direction alone."""
    step = 2.5 / 2**bits
    angles = np.random.default_rng(bits).uniform(-np.pi, np.pi, 40000)
    law = sw.sensor.SineCosineEncoder(periods=37, converter_step=step)
    found = (seen(law, angles) - angles) * 37.0
    assert np.sqrt(np.mean(found**2)) == pytest.approx(step / np.sqrt(12.0), rel=0.02)


def test_a_counter_behind_it_reads_in_steps() -> None:
    law = sw.sensor.Quantised(law=sw.sensor.SineCosineEncoder(periods=16, sine_offset=0.1), resolution=tau / 4096)
    count = seen(law, TURN) / (tau / 4096)
    assert count == pytest.approx(np.rint(count), abs=1e-9)


def test_the_linear_view_leaves_its_errors_out() -> None:
    drive = sw.Drive(control=sw.control.PID(proportional=2.0, derivative=0.05))
    rough = sw.Sensors(output_angle=sw.sensor.SineCosineEncoder(periods=512, sine_offset=0.02, converter_step=1e-3))
    seen_roughly = sw.linearise(drive.replace(sensors=rough)).A
    assert seen_roughly == pytest.approx(sw.linearise(drive).A)
