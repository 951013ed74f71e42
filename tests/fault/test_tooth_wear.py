"""Worn teeth: their order is how often lobes pass them, by the equation of the three speeds."""

from __future__ import annotations

import pytest
import strainwave as sw

from tests.fault.by_hand import FOLLOWING, REVERSING, speeds, waves


@pytest.mark.parametrize("facts", [REVERSING, FOLLOWING], ids=["circular spline fixed", "flexspline fixed"])
@pytest.mark.parametrize("spline", ["flexspline", "circular_spline"])
def test_the_order_is_that_of_two_lobes_passing_the_spline(facts: sw.fault.Facts, spline: str) -> None:
    ((order, amplitude, phase),) = waves(sw.fault.ToothWear(spline=spline, phase=0.3), facts, "gear.kinematic_error")
    assert order == pytest.approx(2.0 * (1.0 - speeds(facts)[spline]), rel=1e-14)
    assert (amplitude, phase) == (1.5e-4, 0.3)


def test_the_play_is_the_twist_without_torque() -> None:
    worn = sw.dataset.with_faults(sw.load("robot-joint"), [sw.fault.ToothWear(play=4e-4, severity=0.5)]).gear.stiffness
    assert worn.twist(1e-9) - worn.twist(-1e-9) == pytest.approx(2e-4, rel=1e-6)
    healthy = sw.load("robot-joint").gear.stiffness
    assert worn.twist(20.0) == pytest.approx(healthy.twist(20.0) + 1e-4, rel=1e-12)
