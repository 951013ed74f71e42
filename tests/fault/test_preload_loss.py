"""Loss of preload: a soft and free centre, in closed form."""

from __future__ import annotations

import pytest
import strainwave as sw

SPRING = sw.stiffness.ThreeSegment(k1=1e4, k2=2e4, k3=3e4, t1=10.0, t2=50.0)


def test_the_first_segment_is_soft_and_the_others_are_shifted() -> None:
    drive = sw.Drive(gear=sw.Gear(stiffness=SPRING))
    loose = sw.dataset.with_faults(drive, [sw.fault.PreloadLoss(softening=0.5, play=2e-4)]).gear.stiffness
    assert loose.twist(5.0) == pytest.approx(1e-4 + 5.0 / 5e3, rel=1e-12)
    assert loose.twist(40.0) == pytest.approx(1e-4 + 10.0 / 5e3 + 30.0 / 2e4, rel=1e-12)


def test_a_linear_spring_gets_the_play_alone() -> None:
    drive = sw.Drive(gear=sw.Gear(stiffness=sw.stiffness.Linear(k=1e4)))
    loose = sw.dataset.with_faults(drive, [sw.fault.PreloadLoss(play=2e-4)]).gear.stiffness
    assert loose == sw.stiffness.Backlash(law=sw.stiffness.Linear(k=1e4), clearance=2e-4)
