"""The conservative gear of document R with its kinematic error, against numbers computed independently at high precision."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray

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
    return sw.simulate(DRIVE, sw.scenario.constant(0.0, DURATION), dt, start=start)


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
