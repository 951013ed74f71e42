"""Where a law is not valid it says so, with the numbers; nothing that is not finite goes in."""

from __future__ import annotations

import math
from typing import Any

import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core

from tests.support.strategies import models

NOT_FINITE = st.sampled_from([math.nan, math.inf, -math.inf])
SOFT = sw.stiffness.MultiCompliance(
    flexspline_stiffness=8000.0,
    flexspline_hardening=0.02,
    wave_generator_stiffness=2.0,
    wave_generator_hardening=1.5,
    reduction=100.0,
)
BOUND = math.pi / (2.0 * 0.02 * 8000.0) + 1.0 / (100.0 * 1.5 * 2.0)


def position_dependent(outside: str) -> sw.friction.PositionDependent:
    return sw.friction.PositionDependent(constant=0.072, outside=outside, domain_start=0.0, domain_end=2.0)


@pytest.mark.parametrize("verb", ["steady", "hold"])
def test_an_angle_outside_is_refused_with_angle_domain_and_unit(verb: str) -> None:
    with pytest.raises(ValueError, match=r"position_dependent: angle = 2\.5 rad lies outside of \[0, 2\] rad"):
        getattr(position_dependent("refuse"), verb)(1.0, angle=2.5)
    for outside in ("clamp", "periodic"):
        assert math.isfinite(getattr(position_dependent(outside), verb)(1.0, angle=2.5))


def test_a_motion_that_leaves_the_domain_is_refused() -> None:
    with pytest.raises(ValueError, match=r"position_dependent: angle = 3 rad lies outside"):
        position_dependent("refuse").trace([0.0, 1.0, 2.0, 3.0], [1.0, 1.0, 1.0, 1.0])


def test_a_drive_that_leaves_a_domain_says_which_part_where_and_when() -> None:
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=100.0), friction_input=position_dependent("refuse"), damping=10.0
    )
    drive = sw.Drive(gear=gear, motor=sw.motor.DC(inertia=1e-4), load=sw.loads.Inertia(inertia=0.5))
    with pytest.raises(ValueError, match=r"gear\.friction_input: angle = 2\.\d+ rad lies .*\[0, 2\] rad.* at t = 0\.\d+ s"):
        sw.simulate(drive, sw.scenario.constant(12.0, 2.0))


@pytest.mark.parametrize("verb", ["torque", "tangent", "energy"])
def test_a_twist_beyond_both_compliances_is_refused_with_the_bound(verb: str) -> None:
    with pytest.raises(ValueError, match=r"multi_compliance: twist = 0\.014 rad lies outside of \[-0\.01315081037"):
        getattr(SOFT, verb)(0.014)
    assert math.isfinite(getattr(SOFT, verb)(0.99 * BOUND))


def test_a_bristle_that_can_create_energy_warns_with_both_sides() -> None:
    message = r"lugre can create energy: viscous = 0\.0004 N\.m\.s/rad must be at least .* = 0\.008"
    numbers = {"coulomb": 0.05, "breakaway": 0.07, "stribeck_speed": 0.1, "bristle_stiffness": 50.0, "bristle_damping": 0.02}
    with pytest.warns(_core.PassivityWarning, match=message):
        law = sw.friction.LuGre(**numbers, viscous=4e-4)
    with pytest.warns(_core.PassivityWarning, match=message):
        law.check()
    with pytest.warns(_core.PassivityWarning, match=message):
        law.replace(viscous=1.0).replace(viscous=4e-4)


@given(models("stiffness"), NOT_FINITE)
def test_a_spring_refuses_what_is_not_finite(law: Any, x: float) -> None:
    for verb in (law.torque, law.twist, law.tangent, law.energy):
        for given_so in (x, [x]):
            with pytest.raises(ValueError, match=r"is not finite|lies outside"):
                verb(given_so)


@given(models("friction"), NOT_FINITE)
def test_friction_refuses_what_is_not_finite(law: Any, x: float) -> None:
    for arguments in ((x,), ([x],), (1.0, x), (1.0, 0.0, x), (1.0, 0.0, 0.0, x)):
        with pytest.raises(ValueError, match=r"is not finite|lies outside"):
            law.steady(*arguments)


@given(models("hysteresis"), NOT_FINITE)
def test_hysteresis_refuses_what_is_not_finite(law: Any, x: float) -> None:
    for verb in (law.trace, law.work, law.advance):
        with pytest.raises(ValueError, match="is not finite"):
            verb([0.0, x])
