"""Orders: signals of known orders are recovered, whatever the speed and the sampling; bearings are those of others' tables."""

from __future__ import annotations

from math import pi, tau

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray

UNITS = {"time": "s", "input_angle": "rad", "torque": "N.m"}


def turning(revolutions: float = 40.3, count: int = 9000, seed: int = 0) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Times at random distances, and angles at a speed that rises and wavers."""
    time = np.cumsum(np.random.default_rng(seed).uniform(0.3, 1.7, count))
    time = (time - time[0]) / (time[-1] - time[0])
    angle = time + time**2 + 0.02 * np.sin(9.0 * time)
    return time, tau * revolutions * angle / angle[-1]


def recorded(time: NDArray[np.float64], angle: NDArray[np.float64], torque: NDArray[np.float64]) -> sw.Recording:
    return sw.Recording({"time": time, "input_angle": angle, "torque": torque}, UNITS)


@given(
    amplitude=st.lists(st.floats(0.01, 10.0), min_size=4, max_size=4),
    phase=st.lists(st.floats(-3.0, 3.0), min_size=4, max_size=4),
    mean=st.floats(-5.0, 5.0),
    drift=st.floats(-0.05, 0.05),
    backward=st.booleans(),
)
def test_a_signal_of_known_orders_is_recovered_at_any_speed(
    amplitude: list[float], phase: list[float], mean: float, drift: float, backward: bool
) -> None:
    order = [1.0, 2.0, 2.0 * 202 / 200 + 0.03, 4.0]
    time, angle = turning()
    angle = -angle if backward else angle
    ripple = sum(a * np.sin(n * angle + p) for n, a, p in zip(order, amplitude, phase, strict=True))
    found = sw.orders.order_amplitudes(recorded(time, angle, mean + drift * angle + ripple), "torque", order)
    assert found.amplitude == pytest.approx(amplitude, rel=1e-10)
    assert np.angle(np.exp(1j * (found.phase - phase))) == pytest.approx(0.0, abs=1e-9)
    middle = angle[-1] - np.sign(angle[-1]) * pi * found.revolutions
    assert found.mean == pytest.approx(mean + drift * middle, abs=1e-9)
    assert found.residual < 1e-11 * (1.0 + abs(mean) + sum(amplitude))
    assert (found.revolutions, found.unit) == (40, "N.m")


def test_whole_orders_that_are_not_asked_for_do_not_leak() -> None:
    """What is left falls with the square of the distance between samples."""
    leaked = []
    for count in (5000, 10000):
        angle = np.linspace(0.0, tau * 20.37, count) ** 1.2
        angle *= tau * 20.37 / angle[-1]
        torque = 5.0 * np.sin(3 * angle + 0.2) + 0.01 * np.sin(2 * angle)
        found = sw.orders.order_amplitudes(recorded(np.arange(float(count)), angle, torque), "torque", [1, 2])
        leaked.append(max(abs(found.amplitude - [0.0, 0.01])))
        assert found.residual == pytest.approx(5.0 / np.sqrt(2.0), rel=1e-3)
    assert leaked[0] < 5e-5
    assert leaked[1] < 0.3 * leaked[0]


def test_a_drift_is_no_order_one() -> None:
    time, angle = turning()
    found = sw.orders.order_amplitudes(recorded(time, angle, 3.0 + 0.2 * angle), "torque", [1.0])
    assert found.amplitude[0] < 1e-10


def test_noise_moves_an_amplitude_by_as_much_as_it_must() -> None:
    """Of n samples of white noise s, the amplitude of a sine has the standard deviation s sqrt(2 / n)."""
    angle = tau * np.arange(1, 4001) / 200.0
    pure, noise = 0.3 * np.sin(2 * angle + 1.0), np.random.default_rng(5).normal(0.0, 0.2, (300, 4000))
    found = [sw.orders.order_amplitudes(recorded(angle, angle, pure + each), "torque", [1, 2]).amplitude[1] for each in noise]
    expected = 0.2 * np.sqrt(2.0 / 4000)
    assert np.mean(found) == pytest.approx(0.3, abs=4.0 * expected / np.sqrt(300))
    assert np.std(found) == pytest.approx(expected, rel=0.15)  # four times its own uncertainty


def test_the_angle_may_have_any_unit_and_be_of_any_shaft() -> None:
    angle = turning()[1]
    torque = 0.4 * np.sin(2 * angle + 0.1)
    degrees = sw.Recording({"turned": np.degrees(angle), "torque": torque}, {"turned": "deg", "torque": "N.m"})
    found = sw.orders.order_amplitudes(degrees, "torque", 2, angle="turned")
    assert (found.amplitude[0], found.phase[0]) == pytest.approx((0.4, 0.1))


def test_two_orders_need_as_many_revolutions_as_tell_them_apart() -> None:
    """Orders 2 and 2 z_c/z_f differ by 1 %: half the teeth of the flexspline in revolutions of the wave generator."""
    z = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202)
    tooth = 2.0 * z.circular_spline_teeth / z.flexspline_teeth
    angle = np.linspace(0.0, tau * 50.0, 6000)
    torque = np.sin(2 * angle) + 0.5 * np.sin(tooth * angle)
    assert sw.orders.order_amplitudes(recorded(angle, angle, torque), "torque", [tooth, 2.0]).amplitude == pytest.approx(
        [0.5, 1.0]
    )
    short = recorded(angle, angle, torque).between(0.0, tau * 49.5)
    with pytest.raises(ValueError, match=r"to resolve orders 2 and 2\.02 takes 50 revolutions .* has 49; record longer"):
        sw.orders.order_amplitudes(short, "torque", [2.0, tooth])


@pytest.mark.parametrize(
    ("order", "message"),
    [
        ([1, 0], r"order = 0\.0 must lie in \(0, inf\)"),
        ([-2.0], r"order = -2\.0 must lie in"),
        ([np.nan], r"order = nan must lie in"),
        ([], r"order must be a number or one series of at least one; its shape is \(0,\)"),
        ([[1.0]], r"its shape is \(1, 1\)"),
        ([2, 1, 2], r"order 2 is asked for twice"),
        ([0.01], r"order 0\.01 and the mean takes 100 revolutions"),
        ([200.0], r"order 200 needs samples less than 0\.0157 rad of input_angle apart; rows \d+ and \d+ are 0\.\d+ rad apart"),
    ],
)
def test_what_cannot_be_told_is_refused(order: list[float], message: str) -> None:
    time, angle = turning()
    with pytest.raises(ValueError, match=message):
        sw.orders.order_amplitudes(recorded(time, angle, angle), "torque", order)


def test_a_shaft_must_turn_one_way_and_far_enough() -> None:
    time, angle = turning()
    swung = recorded(time, 10.0 * np.sin(5.0 * time), angle)
    with pytest.raises(ValueError, match=r"input_angle turns back at t = 0\.314\d* s; take a stretch that turns one way"):
        sw.orders.order_amplitudes(swung, "torque", 1)
    with pytest.raises(ValueError, match=r"input_angle makes 0\.5 revolutions; orders need 1 or more"):
        sw.orders.order_amplitudes(recorded(time, 0.5 * tau * time, angle), "torque", 1)
    with pytest.raises(ValueError, match=r'column "torque" reaches 1e\+200; values up to 1e\+150'):
        sw.orders.order_amplitudes(recorded(time, angle, 1e200 * time), "torque", 1)
    with pytest.raises(ValueError, match=r"speed"):
        sw.orders.order_amplitudes(recorded(time, angle, angle), "speed", 1)
    with pytest.raises(TypeError, match=r"recording must be a Recording"):
        sw.orders.order_amplitudes({"torque": angle}, "torque", 1)  # type: ignore[arg-type]


def test_the_kinematic_error_of_a_simulated_gear_is_found_in_its_run() -> None:
    """Amplitudes and phases are those of the law, by the same convention."""
    law = sw.kinematic_error.Fourier(order=[1, 2, 4, 2.02], amplitude=[8e-5, 3e-4, 5e-5, 2e-5], phase=[0.2, -1.0, 2.5, 0.7])
    gear = sw.Gear(kinematic_error=law, stiffness=sw.stiffness.Linear(k=8000.0), damping=2.0)
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.05))
    run = sw.simulate(drive, sw.scenario.constant(0.0, 4.0), initial={"input_speed": 90.0}, sample=1e-3)
    found = sw.orders.order_amplitudes(run, "kinematic_error", law.order)
    assert found.amplitude == pytest.approx(law.amplitude, rel=1e-7)
    assert found.phase == pytest.approx(law.phase, abs=1e-7)


def test_a_spectrum_shows_each_order_with_its_amplitude() -> None:
    time, angle = turning(20.0, 20000)
    torque = 7.0 - 0.01 * angle + 0.3 * np.sin(2 * angle) + 0.02 * np.sin(5.25 * angle + 1.0)
    spectrum = sw.orders.order_spectrum(recorded(time, angle, torque), "torque", 8.0)
    order, amplitude = spectrum["order"], spectrum["amplitude"]
    assert (spectrum.unit("order"), spectrum.unit("amplitude")) == ("1", "N.m")
    assert order == pytest.approx(np.arange(1, 161) / 20.0)
    assert amplitude[39:42] == pytest.approx([0.3, 0.15, 1e-3], abs=1e-3)
    assert amplitude[38] == pytest.approx(0.15, abs=1e-3)
    assert amplitude[104] == pytest.approx(0.02, rel=1e-2)
    assert amplitude[60:90].max() < 2e-5


def test_an_order_between_two_lines_is_low_by_the_scalloping_of_the_window() -> None:
    """Half a line off, a Hann window shows 8 / (3 pi) of the amplitude."""
    angle = np.linspace(0.0, tau * 20.0, 20001)
    spectrum = sw.orders.order_spectrum(recorded(angle, angle, np.sin(3.025 * angle)), "torque", 4.0)
    assert spectrum["amplitude"].max() == pytest.approx(8.0 / (3.0 * pi), rel=2e-3)


def test_a_spectrum_needs_one_line_and_dense_samples() -> None:
    time, angle = turning()
    with pytest.raises(ValueError, match=r"highest = 0\.02 is less than the first line at 1/40"):
        sw.orders.order_spectrum(recorded(time, angle, angle), "torque", 0.02)
    with pytest.raises(ValueError, match=r"order 200 needs samples"):
        sw.orders.order_spectrum(recorded(time, angle, angle), "torque", 200.0)


def test_a_shaft_that_pauses_has_the_same_orders() -> None:
    """Samples at rest stand for no angle."""
    angle = turning()[1]
    torque = 0.3 * np.sin(2 * angle)
    paused = recorded(
        np.arange(9100.0), np.insert(angle, 4000, np.full(100, angle[4000])), np.insert(torque, 4000, np.full(100, 9.0))
    )
    assert sw.orders.order_amplitudes(paused, "torque", [1, 2]).amplitude == pytest.approx([0.0, 0.3], abs=1e-3)
    spectrum = sw.orders.order_spectrum(paused, "torque", 4.0)
    assert len(spectrum) == 160


def test_the_orders_of_a_bearing_are_those_of_its_data_sheet() -> None:
    """SKF 6205-2RS as the bearing data centre of Case Western Reserve University gives it; the ball's fault twice a turn.

    It gives the pitch diameter as 1.537 inches, so to 3e-4.
    """
    found = sw.orders.bearing_orders(9, ball_diameter=0.3126, pitch_diameter=1.537)
    assert (found.inner_ring, found.outer_ring, found.cage) == pytest.approx((5.4152, 3.5848, 0.39828), rel=3e-4)
    assert 2.0 * found.ball == pytest.approx(4.7135, rel=3e-4)


@given(
    balls=st.integers(3, 40),
    share=st.floats(0.02, 0.99),
    pitch=st.floats(0.01, 1.0),
    contact=st.floats(0.0, 1.5),
    outer=st.floats(-2.0, 2.0),
)
def test_balls_roll_without_slip(balls: int, share: float, pitch: float, contact: float, outer: float) -> None:
    """The contacts of a ball move with the rings: its centre at the mean of both, and it turns alike at both."""
    ball = share * pitch * np.sin(pi / balls)
    found = sw.orders.bearing_orders(balls, ball, pitch, contact, outer_speed=outer)
    inner_radius, outer_radius = (0.5 * (pitch + side * ball * np.cos(contact)) for side in (-1.0, 1.0))
    cage = 0.5 * (inner_radius + outer * outer_radius) / (0.5 * pitch)
    assert found.cage == pytest.approx(cage, abs=1e-12)
    assert found.inner_ring == pytest.approx(balls * abs(1.0 - cage), abs=1e-9)
    assert found.outer_ring == pytest.approx(balls * abs(outer - cage), abs=1e-9)
    for radius, ring in ((inner_radius, 1.0), (outer_radius, outer)):
        assert found.ball == pytest.approx(abs(ring - cage) * radius / (0.5 * ball), rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((2, 1.0, 10.0), r"balls = 2 must be 3 or more"),
        ((9, 0.0, 10.0), r"ball_diameter = 0\.0 m must lie in \(0, 3\.4202\]"),
        ((9, 4.0, 10.0), r"ball_diameter = 4\.0 m must lie in \(0, 3\.4202\]"),
        ((9, 1.0, -1.0), r"pitch_diameter = -1\.0 m must lie in"),
        ((9, 1.0, 10.0, 1.6), r"contact_angle = 1\.6 rad must lie in \[0, 1\.5708\)"),
    ],
)
def test_what_is_no_bearing_is_refused(arguments: tuple[int, float, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        sw.orders.bearing_orders(*arguments)
