"""A crack: its waves against numerical integrals of the pulse, and its orders from the speeds of the members."""

from __future__ import annotations

import math

import numpy as np
import pytest
import strainwave as sw

from tests.fault.by_hand import FOLLOWING, REVERSING, speeds, waves

POINTS = 20000
PLACE = "gear.stiffness_variation"


def pulse(angle: np.ndarray, width: float) -> np.ndarray:
    within = np.remainder(angle + math.pi / 2, math.pi) - math.pi / 2
    return np.where(np.abs(within) < width / 2, 0.5 * (1.0 + np.cos(2.0 * math.pi * within / width)), 0.0)


@pytest.mark.parametrize("width", [0.1, 0.6, math.pi / 2, math.pi / 3, math.pi])
def test_the_waves_are_the_fourier_integrals_of_the_pulse(width: float) -> None:
    angle = (np.arange(POINTS) + 0.5) * math.pi / POINTS
    found = waves(sw.fault.FlexsplineCrack(depth=0.5, width=width, waves=7), FOLLOWING, PLACE)
    assert found[0][1] == pytest.approx(0.5 * pulse(angle, width).mean(), rel=1e-6)
    for k, (order, amplitude, phase) in enumerate(found[1:], start=1):
        assert order == 2 * k
        assert phase == pytest.approx(-math.pi / 2)
        integral = 2.0 * np.mean(pulse(angle, width) * np.cos(2 * k * angle))
        assert amplitude == pytest.approx(0.5 * integral, abs=1e-7)


def test_the_stiffness_falls_where_a_lobe_stands_over_the_crack_and_nowhere_else() -> None:
    crack = sw.fault.FlexsplineCrack(depth=0.4, width=1.2, angle=0.5, waves=7)
    gear = sw.Gear(kinematics=sw.kinematics.StrainWave(fixed="flexspline"))
    law = sw.dataset.with_faults(sw.Drive(gear=gear), [crack]).gear.stiffness_variation
    assert law.factor([0.5, 0.5 + math.pi]) == pytest.approx(0.6, abs=2e-3)
    assert law.factor([0.5 + math.pi / 2, 0.5 + 0.8]) == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("facts", [REVERSING, FOLLOWING], ids=["circular spline fixed", "flexspline fixed"])
def test_the_first_order_is_that_of_two_lobes_passing_the_flexspline(facts: sw.fault.Facts) -> None:
    found = waves(sw.fault.FlexsplineCrack(waves=1), facts, PLACE)
    assert [order for order, *_ in found] == pytest.approx([0.0, 2.0 * (1.0 - speeds(facts)["flexspline"])], rel=1e-14)


def test_a_gear_holds_eight_waves_of_cracks() -> None:
    drive = sw.Drive(gear=sw.Gear(kinematics=sw.kinematics.StrainWave()))
    bearing = sw.fault.WaveGeneratorBearing(friction_depth=0.0, stiffness_depth=0.1, waves=1)
    with pytest.raises(ValueError, match=r"already has 8 waves and holds no more; give the fault fewer waves"):
        sw.dataset.with_faults(drive, [sw.fault.FlexsplineCrack(waves=7), bearing])
