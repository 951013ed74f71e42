"""The conservative gear of document R with its kinematic error, against numbers computed independently at high precision."""

from __future__ import annotations

from itertools import pairwise
from math import sqrt

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from tests.support.samples import sample

INPUT_INERTIA, OUTPUT_INERTIA = 1.5e-4, 0.05  # kg.m2
SPRING = sw.stiffness.Cubic(a1=8000.0, a3=4e7)
DRIVE = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline"),
        kinematic_error=sw.kinematic_error.Fourier(order=[2.0, 4.0], amplitude=[3e-4, 0.8e-4], phase=[0.3, -1.1]),
        stiffness=SPRING,
    ),
    motor=sw.motor.DC(torque_constant=0.0, inertia=INPUT_INERTIA),
    load=sw.loads.Inertia(inertia=OUTPUT_INERTIA),
)
DURATION = 0.1  # s
KNOWN = {
    "input_angle": 5.000121927883016,
    "output_angle": -0.04972844972996274,
    "input_speed": 49.87041932393943,
    "output_speed": -0.5371014992864561,
}
ENERGY = 0.19375  # J


def coasting(dt: float) -> sw.Recording:
    """From an untwisted gear that turns at 50 rad/s, and its output the other way at 0.5 rad/s."""
    rest = DRIVE.rest()
    start = rest.replace(input_speed=50.0, output_speed=-0.5)
    return sw.simulate(DRIVE, sw.scenario.constant(0.0, DURATION), dt, initial=start)


def energy(run: sw.Recording) -> NDArray[np.float64]:
    kinetic = INPUT_INERTIA * run["input_speed"] ** 2 + OUTPUT_INERTIA * run["output_speed"] ** 2
    return 0.5 * kinetic + SPRING.energy(run["twist"])


def distance(run: sw.Recording) -> float:
    """The largest, relative, from the known numbers."""
    return max(float(abs(run[name][-1] / number - 1.0)) for name, number in KNOWN.items())


def test_after_a_tenth_of_a_second_the_gear_is_where_it_is_known_to_be() -> None:
    run = coasting(1e-5)
    for name, number in KNOWN.items():
        assert run[name][-1] == pytest.approx(number, rel=1e-11)


def test_the_known_numbers_are_approached_in_fourth_order() -> None:
    distances = [distance(coasting(dt)) for dt in (4e-4, 2e-4, 1e-4, 5e-5)]
    orders = [np.log2(coarse / fine) for coarse, fine in pairwise(distances)]
    assert orders == pytest.approx([4.0, 4.0, 4.0], abs=0.3)


def test_the_energy_is_the_known_one_all_the_while() -> None:
    np.testing.assert_allclose(energy(coasting(1e-5)), ENERGY, rtol=1e-12)


def test_the_input_and_the_output_pass_energy_to_and_fro() -> None:
    """What is constant is a sum of parts that change: it shows the reaction of the error on the input (E-R3, E-A5)."""
    run = coasting(1e-5)
    stored = SPRING.energy(run["twist"])
    assert np.ptp(stored) > 1e-4 * ENERGY
    assert np.ptp(0.5 * OUTPUT_INERTIA * run["output_speed"] ** 2) > 1e-3 * ENERGY


# Further cases


def in_the_signs_of_r(drive: sw.Drive, speeds: tuple[float, float], duration: float) -> NDArray[np.float64]:
    """Document R's equations, integrated here: delta = theta_o + theta_i / N + e, and the torque against it acts on both."""
    gear, error = drive.gear, drive.gear.kinematic_error
    order, amplitude, phase = (np.array(numbers) for numbers in (error.order, error.amplitude, error.phase))
    teeth, a1, a3 = gear.kinematics.flexspline_teeth / 2.0, gear.stiffness.a1, gear.stiffness.a3

    def rates(_: float, y: NDArray[np.float64]) -> list[float]:
        wave = order * y[0] + phase
        delta = y[1] + y[0] / teeth + amplitude @ np.sin(wave)
        torque = a1 * delta + a3 * delta**3
        slope = (amplitude * order) @ np.cos(wave)
        return [y[2], y[3], -torque * (1.0 / teeth + slope) / gear.input_inertia, -torque / drive.load.inertia]

    start = [0.0, -float(amplitude @ np.sin(phase)), *speeds]
    return solve_ivp(rates, (0.0, duration), start, "DOP853", rtol=1e-12, atol=1e-14).y[:, -1]


@given(
    st.integers(30, 160),
    st.floats(5e-5, 1e-3),
    st.floats(0.02, 0.5),
    st.floats(2e3, 2e4),
    st.floats(0.0, 1e8),
    st.lists(
        st.tuples(st.sampled_from([1.0, 2.0, 4.0, 2.02]), st.floats(1e-5, 3e-4), st.floats(-3.0, 3.0)), min_size=1, max_size=3
    ),
    st.floats(-60.0, 60.0),
)
@settings(max_examples=sample(10, 25))
def test_gears_of_any_numbers_move_as_document_r_has_it(
    ratio: int, j_in: float, j_out: float, a1: float, a3: float, error: list[tuple[float, float, float]], speed: float
) -> None:
    """With the meter of the set that comes with the package, whose energies stay what they are at the start."""
    template = sw.load("two-inertia-gear")
    order, amplitude, phase = zip(*error, strict=True)
    kinematics = sw.kinematics.StrainWave(flexspline_teeth=2 * ratio, circular_spline_teeth=2 * ratio + 2)
    gear = template.gear.replace(
        kinematics=kinematics,
        stiffness=sw.stiffness.Cubic(a1=a1, a3=a3),
        kinematic_error=sw.kinematic_error.Fourier(order=order, amplitude=amplitude, phase=phase),
        input_inertia=j_in,
    )
    drive = template.replace(gear=gear, load=sw.loads.Inertia(inertia=j_out))
    speeds = (speed, -1.2 * speed / ratio)
    start = {"input_speed": speeds[0], "output_speed": speeds[1]}
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.05), 1e-5, sample=1e-3, initial=start)
    known = in_the_signs_of_r(drive, speeds, 0.05)
    names = ("input_angle", "output_angle", "input_speed", "output_speed")
    for name, number, size in zip(names, known, (1.0, 0.01, abs(speed) + 1.0, 0.01 * abs(speed) + 0.01), strict=True):
        assert run[name][-1] == pytest.approx(number, abs=1e-8 * size)
    stored = run["stored_input"] + run["stored_output"] + run["stored_spring"]
    begun = 0.5 * (j_in * speeds[0] ** 2 + j_out * speeds[1] ** 2)
    np.testing.assert_allclose(stored, begun, rtol=1e-9, atol=1e-12)


@given(st.floats(1e-5, 1e-3), st.floats(0.01, 1.0), st.floats(1e3, 5e4), st.floats(0.5, 30.0))
@settings(max_examples=sample(10, 25))
def test_two_inertias_on_a_linear_spring_swing_about_their_common_centre(
    j_in: float, j_out: float, k: float, speed: float
) -> None:
    """Without an error: the twist is a sine of the eigenfrequency, and the common centre runs on evenly."""
    template = sw.load("two-inertia-gear")
    linear = template.gear.replace(
        stiffness=sw.stiffness.Linear(k=k), kinematic_error=sw.kinematic_error.Fourier(), input_inertia=j_in
    )
    drive = template.replace(gear=linear, load=sw.loads.Inertia(inertia=j_out))
    run = sw.simulate(
        drive, sw.scenario.constant(0.0, 0.02), 1e-5, sample=1e-3, initial={"input_speed": speed, "output_speed": 0.0}
    )
    w, twisted = sqrt(k * (1.0 / j_out + 1.0 / (1e4 * j_in))), speed / 100.0
    lag = (w * 1e-5) ** 4 * w * 0.02 / 120.0  # rad, of a fourth-order method behind a sine
    np.testing.assert_allclose(run["twist"], -twisted / w * np.sin(w * run.time), rtol=0.0, atol=(lag + 1e-10) * twisted / w)
    centre = -1e4 * j_in * run["input_angle"] / 100.0 + j_out * run["output_angle"]
    np.testing.assert_allclose(centre, -100.0 * j_in * speed * run.time, rtol=0.0, atol=1e-11 * 100.0 * j_in * speed)
