"""Worn teeth: their order is how often lobes pass them, by the equation of the three speeds."""

from __future__ import annotations

from typing import Any

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


@pytest.mark.parametrize(
    "spring",
    [
        sw.stiffness.Linear(k=1e4),
        sw.stiffness.Cubic(a1=1e4, a3=1e9),
        sw.stiffness.ThreeSegment(k1=1e4, k2=2e4, k3=3e4, t1=1.0, t2=2.0),
        sw.stiffness.Piecewise(k1=1e4, k2=2e4, knee=1e-4),
        sw.stiffness.MultiCompliance(
            flexspline_stiffness=8e3,
            flexspline_hardening=0.02,
            wave_generator_stiffness=2.0,
            wave_generator_hardening=1.5,
            reduction=100.0,
        ),
    ],
    ids=lambda spring: spring.name,
)
def test_softening_reaches_every_stiffness_of_a_spring(spring: Any) -> None:
    """The first slope behind the play is lower by the share, whatever the law."""
    drive = sw.Drive(gear=sw.Gear(kinematics=sw.kinematics.StrainWave(), stiffness=spring))
    worn = sw.dataset.with_faults(drive, [sw.fault.ToothWear(play=0.0, softening=0.2)]).gear.stiffness
    assert worn.tangent(1e-6) == pytest.approx(0.8 * spring.tangent(1e-6), rel=1e-4)
    assert worn.tangent(3e-4) == pytest.approx(0.8 * spring.tangent(3e-4), rel=0.2)


def test_friction_of_the_mesh_rises_and_that_of_the_shafts_does_not() -> None:
    dry = sw.friction.Coulomb(coulomb=2.0, breakaway=3.0, viscous=0.1)
    gear = sw.Gear(kinematics=sw.kinematics.StrainWave(), friction_input=dry, friction_mesh=dry, friction_output=dry)
    worn = sw.dataset.with_faults(sw.Drive(gear=gear), [sw.fault.ToothWear(friction_rise=0.5, severity=0.5)]).gear
    assert worn.friction_mesh == sw.friction.Coulomb(coulomb=2.5, breakaway=3.75, viscous=0.1)
    assert (worn.friction_input, worn.friction_output) == (dry, dry)
