"""A bearing of the wave generator: its orders against those printed for a bearing of known size."""

from __future__ import annotations

import pytest
import strainwave as sw

from tests.fault.by_hand import FOLLOWING, REVERSING, waves

# SKF 6205-2RS: 9 balls of 0.3126 in on a circle of 1.537 in; multiples of the shaft speed as its maker states them, inner ring
# turning: outer ring 3.5848, inner ring 5.4152, cage 0.39828; a ball meets both rings 4.7135 times, half of it is its spin.
SIZE = {"balls": 9, "ball_diameter": 0.3126 * 0.0254, "pitch_diameter": 1.537 * 0.0254}
PRINTED = {"outer_ring": 3.5848, "inner_ring": 5.4152, "cage": 0.39828, "ball": 4.7135 / 2.0}


def order(element: str, facts: sw.fault.Facts) -> float:
    bearing = sw.fault.WaveGeneratorBearing(element=element, waves=1, **SIZE)
    ((found, _, _),) = waves(bearing, facts, "gear.friction_input")
    return found


@pytest.mark.parametrize("element", PRINTED)
def test_the_orders_of_a_ring_that_stands_are_those_printed(element: str) -> None:
    assert order(element, FOLLOWING) == pytest.approx(PRINTED[element], rel=3e-4)


@pytest.mark.parametrize("element", PRINTED)
def test_an_outer_ring_that_turns_changes_the_orders_by_the_relative_speed(element: str) -> None:
    """It turns at -1/100: all but the cage by 1.01; the cage is the relative one plus the speed of the outer ring."""
    turning, standing = order(element, REVERSING), order(element, FOLLOWING)
    expected = 1.01 * standing - 0.01 if element == "cage" else 1.01 * standing
    assert turning == pytest.approx(expected, rel=1e-12)


def test_multiples_of_the_order_fall_with_their_number_in_friction_and_stiffness() -> None:
    bearing = sw.fault.WaveGeneratorBearing(friction_depth=0.3, stiffness_depth=0.06, waves=3, severity=0.5, phase=0.2)
    for place, depth in (("gear.friction_input", 0.15), ("gear.stiffness_variation", 0.03)):
        found = waves(bearing, REVERSING, place)
        first = found[0][0]
        assert found == [pytest.approx((h * first, depth / h, 0.2 * h), rel=1e-14) for h in (1, 2, 3)]


def test_balls_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match="balls must fit on their circle"):
        sw.fault.WaveGeneratorBearing(balls=40)


def test_friction_that_is_zero_cannot_vary() -> None:
    drive = sw.Drive(gear=sw.Gear(kinematics=sw.kinematics.StrainWave()))
    with pytest.raises(ValueError, match=r"wave_generator_bearing changes nothing of this drive: .* in gear\.friction_input"):
        sw.dataset.with_faults(drive, [sw.fault.WaveGeneratorBearing()])


def test_friction_within_a_law_of_temperature_becomes_cyclic_within_it() -> None:
    law = sw.dataset.with_faults(sw.load("robot-joint"), [sw.fault.WaveGeneratorBearing(waves=1)]).gear.friction_input
    assert (law.name, law.law.name, law.law.law.name) == ("thermal", "cyclic", "coulomb")
