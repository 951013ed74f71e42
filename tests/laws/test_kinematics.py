"""What every kinematics obeys."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from strainwave.kinematics import StrainWave

from tests.support.strategies import built, models


@given(models("kinematics"))
def test_a_ratio_is_finite_and_not_zero(kinematics: Any) -> None:
    assert math.isfinite(kinematics.ratio)
    assert kinematics.ratio != 0.0


@given(built(StrainWave))
def test_the_ratio_solves_the_motion_of_the_three_members(kinematics: StrainWave) -> None:
    """z_c w_c - z_f w_f = (z_c - z_f) w_w, the wave generator turning at w_w = 1 and one spline at rest."""
    flexspline, circular = kinematics.flexspline_teeth, kinematics.circular_spline_teeth
    output = 1.0 / kinematics.ratio
    driven = -flexspline * output if kinematics.fixed == "circular_spline" else circular * output
    assert driven == pytest.approx(circular - flexspline, rel=1e-14)


@given(built(StrainWave))
def test_the_other_spline_turns_the_other_way_and_the_ratios_differ_by_one(
    kinematics: StrainWave,
) -> None:
    reverse, forward = (kinematics.replace(fixed=fixed).ratio for fixed in ("circular_spline", "flexspline"))
    assert reverse < 0.0 < forward
    assert reverse + forward == pytest.approx(1.0, abs=1e-12 * forward)
