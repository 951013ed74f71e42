"""A misalignment as a fault, against the numbers of an independent computation (25.3 and 24.7 mm, 20 degrees, 25 mm, 20 um)."""

from __future__ import annotations

import math

import pytest
import strainwave as sw
from strainwave.dataset.faults import prepared, with_faults

from tests.fault.by_hand import FOLLOWING, waves

ARC_MINUTE = math.pi / 10800
GEOMETRY = {"major_radius": 25.3e-3, "minor_radius": 24.7e-3, "pitch_radius": 25e-3, "pressure_angle": math.radians(20.0)}
HEALTHY = sw.kinematic_error.Misalignment(**GEOMETRY, offset=4e-3, combine="single")


def drive(error: object) -> sw.Drive:
    kinematics = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="flexspline")
    return sw.Drive(gear=sw.Gear(kinematics=kinematics, kinematic_error=error))


def amplitudes(combine: str) -> dict[float, float]:
    """In arc minutes, by order."""
    law = sw.fault.Misalignment(**GEOMETRY, housing_eccentricity=20e-6, combine=combine)
    return {order: amplitude / ARC_MINUTE for order, amplitude, _ in waves(law, FOLLOWING, "gear.kinematic_error")}


def test_one_lobe_makes_order_1() -> None:
    assert amplitudes("single") == {1.0: pytest.approx(1.001, abs=5e-4)}


def test_the_lobe_further_out_makes_orders_2_and_4() -> None:
    found = amplitudes("max")
    assert found[2.0] == pytest.approx(0.425, abs=5e-4)
    assert found[4.0] == pytest.approx(0.425 * 1.698 / 8.492, abs=5e-4)
    assert found[1.0] == pytest.approx(0.0, abs=1e-12)


def test_two_lobes_cancel_order_1_and_leave_order_2_of_second_order() -> None:
    found = amplitudes("mean")
    assert found[1.0] == 0.0
    displacement = 20e-6**2 * 25.3e-3 / (4.0 * 24.7e-3**2)
    assert found[2.0] * ARC_MINUTE == pytest.approx(displacement * math.tan(math.radians(20.0)) / 25e-3, rel=1e-12)


def test_a_geometry_moves_to_the_lobes_that_were_computed_for_it() -> None:
    moved = with_faults(
        drive(HEALTHY),
        [
            sw.fault.Misalignment(
                housing_eccentricity=20e-6, housing_direction=0.4, generator_eccentricity=10e-6, generator_direction=0.9,
                housing_tilt_x=math.radians(0.1), housing_tilt_y=math.radians(-0.05), generator_tilt_x=math.radians(0.08),
                generator_tilt_y=math.radians(0.03),
            )
        ],
    )  # fmt: skip
    law = moved.gear.kinematic_error
    assert law.lobes(0.0) == pytest.approx((3.71855839927659e-05, -3.72217203524899e-05), rel=1e-9)
    assert law.lobes(1.0) == pytest.approx((2.91650039928662e-05, -2.91202356540871e-05), rel=1e-9)


def test_eccentricities_of_a_geometry_add_as_vectors() -> None:
    three = sw.fault.Misalignment(housing_eccentricity=3e-5, housing_direction=0.0)
    four = sw.fault.Misalignment(housing_eccentricity=4e-5, housing_direction=math.pi / 2)
    law = with_faults(drive(HEALTHY), [three, four]).gear.kinematic_error
    assert law.housing_eccentricity == pytest.approx(5e-5, rel=1e-12)
    assert law.housing_direction == pytest.approx(math.atan2(4.0, 3.0), rel=1e-12)


def test_waves_of_an_order_that_is_there_add_as_vectors() -> None:
    fault = sw.fault.Misalignment(**GEOMETRY, housing_eccentricity=20e-6, combine="single")
    ((_, amplitude, phase),) = waves(fault, FOLLOWING, "gear.kinematic_error")
    opposed = sw.kinematic_error.Fourier(order=[1], amplitude=[amplitude], phase=[phase + math.pi])
    left = with_faults(drive(opposed), [fault]).gear.kinematic_error
    assert left.order == (1.0,)
    assert left.amplitude[0] == pytest.approx(0.0, abs=1e-15 * amplitude + 1e-18)


def test_a_geometry_and_its_waves_are_one_error_to_leading_order() -> None:
    fault = sw.fault.Misalignment(**GEOMETRY, offset=4e-3, housing_eccentricity=2e-6, housing_tilt_x=1e-4, combine="single")
    of_geometry = with_faults(drive(HEALTHY), [fault]).gear.kinematic_error
    of_waves = with_faults(drive(sw.kinematic_error.Fourier()), [fault]).gear.kinematic_error
    angles = [0.0, 1.0, 2.0, 4.0]
    assert of_waves.error(angles) == pytest.approx(of_geometry.error(angles), abs=2e-3 * max(abs(of_waves.error(angles))))


def test_tooth_errors_have_no_waves_to_add_to() -> None:
    law = sw.kinematic_error.ToothErrors(flexspline_teeth=200, circular_spline_teeth=202, pitch_radius=25e-3, engaged_share=0.3)
    law = law.replace(fixed="flexspline")
    with pytest.raises(ValueError, match=r"misalignment needs a law fourier at gear\.kinematic_error, where tooth_errors is"):
        prepared(drive(law), [sw.fault.Misalignment()])
