"""Play of the linkage adds to that of the gear."""

from __future__ import annotations

import pytest
import strainwave as sw


def test_plays_in_series_add() -> None:
    gear = sw.Gear(stiffness=sw.stiffness.Backlash(law=sw.stiffness.Linear(k=1e4), clearance=1e-4))
    loose = sw.dataset.with_faults(
        sw.Drive(gear=gear), [sw.fault.LinkagePlay(play=4e-4, severity=0.5), sw.fault.LinkagePlay(play=1e-4)]
    )
    assert loose.gear.stiffness.clearance == pytest.approx(4e-4, rel=1e-12)
    assert loose.gear.stiffness.torque(3e-4) == pytest.approx(1.0, rel=1e-9)
