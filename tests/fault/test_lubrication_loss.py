"""Loss of lubricant, against the friction laws' closed forms."""

from __future__ import annotations

import math

import pytest
import strainwave as sw

SPEED = 3.0
HEALTHY = sw.friction.Stribeck(coulomb=0.05, breakaway=0.08, stribeck_speed=2.0, viscous=4e-3)


def drive(law: object, place: str = "friction_input") -> sw.Drive:
    return sw.Drive(gear=sw.Gear(**{place: law}))


@pytest.mark.parametrize("place", ["friction_input", "friction_mesh", "friction_output"])
def test_friction_is_the_stribeck_curve_of_more_dry_and_less_viscous_friction(place: str) -> None:
    fault = sw.fault.LubricationLoss(severity=0.5, dry_rise=0.6, stribeck_rise=2.0, viscous_fall=0.8)
    law = getattr(sw.dataset.with_faults(drive(HEALTHY, place), [fault]).gear, place)
    dry, scale, viscous = 1.3, 2.0, 0.6
    expected = dry * (0.05 + 0.03 * math.exp(-((SPEED / (scale * 2.0)) ** 2))) + viscous * 4e-3 * SPEED
    assert law.steady(SPEED) == pytest.approx(expected, rel=1e-12)


def test_losses_per_load_rise_as_dry_friction_does() -> None:
    law = sw.friction.LoadDependent(driving_forward=0.1, driving_reverse=0.1, backdriving_forward=0.2, backdriving_reverse=0.2)
    worn = sw.dataset.with_faults(drive(law), [sw.fault.LubricationLoss(dry_rise=0.5)]).gear.friction_input
    assert worn.steady(1.0, load=10.0) == pytest.approx(1.5 * law.steady(1.0, load=10.0), rel=1e-12)


def test_two_losses_multiply() -> None:
    twice = sw.dataset.with_faults(drive(HEALTHY), 2 * [sw.fault.LubricationLoss(dry_rise=0.5)])
    assert twice.gear.friction_input.coulomb == pytest.approx(0.05 * 1.5**2, rel=1e-12)


def test_a_drive_without_friction_is_refused() -> None:
    with pytest.raises(ValueError, match="lubrication_loss changes nothing of this drive"):
        sw.dataset.with_faults(sw.Drive(), [sw.fault.LubricationLoss()])
