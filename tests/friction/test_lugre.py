"""LuGre: what it stores and dissipates, with a bristle damping that is constant or fades with speed."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from scipy.integrate import solve_ivp
from strainwave.friction import LuGre

from tests.support.strategies import made

COULOMB, STRIBECK_SPEED, STIFFNESS, DAMPING = 0.05, 0.1, 50.0, 0.02

levels = st.floats(0.3, 6.0)  # breakaway over coulomb
fadings = st.just(0.0) | st.floats(0.05, 60.0)  # s/rad


def bristle(**changed: float) -> LuGre:
    """A bristle that may create energy, built without a warning."""
    fields = {
        "coulomb": COULOMB,
        "breakaway": 0.07,
        "stribeck_speed": STRIBECK_SPEED,
        "bristle_stiffness": STIFFNESS,
        "bristle_damping": DAMPING,
        "viscous": 4e-4,
    } | changed
    with warnings.catch_warnings(action="ignore", category=sw.PassivityWarning):
        return LuGre(**fields)


def level(law: LuGre, speed: Any) -> Any:
    return law.coulomb + (law.breakaway - law.coulomb) * np.exp(-np.minimum((speed / law.stribeck_speed) ** 2, 700.0))


def needed(law: LuGre) -> float:
    """The viscous friction that outweighs the damping of a fully bent bristle at every speed, searched for by brute force."""
    highest = max(law.coulomb, law.breakaway)

    def surplus(y: Any) -> Any:  # over y = exp(-(v/v_s)^2), from where v is infinite to where it is 0
        r = (law.stribeck_speed * law.damping_fading) ** 2
        return np.asarray(y) ** r * (highest / (law.coulomb + (law.breakaway - law.coulomb) * np.asarray(y)) - 1.0)

    low, high = 0.0, 1.0
    for _ in range(12):  # zoom in on the best of a grid
        grid = np.linspace(low, high, 2001)
        best = int(np.argmax(surplus(grid)))
        low, high = grid[max(best - 1, 0)], grid[min(best + 1, 2000)]
    return float(law.bristle_damping * max(surplus(np.array([low, high, grid[best]]))))


def dissipated(law: LuGre, speed: float, deflection: float) -> float:
    """Power [W] that neither the bristle takes up nor gives back: F v - d/dt sigma_0 z^2 / 2."""
    torque = law.trace([0.0], [speed], state=LuGre.State(deflection=deflection))[0]
    rate = speed - STIFFNESS * abs(speed) * deflection / level(law, speed)
    return float(torque * speed - STIFFNESS * deflection * rate)


def test_a_bristle_without_damping_is_passive() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", sw.PassivityWarning)
        made(LuGre, bristle_damping=0.0).check()


@pytest.mark.parametrize("speed", [-3.0, -0.05, 0.02, 0.4])
def test_the_damping_of_the_bristle_fades_with_speed(speed: float) -> None:
    """A bristle that is not bent moves with the speed."""
    law = bristle(damping_fading=4.0)
    damping = DAMPING * math.exp(-((4.0 * speed) ** 2))
    assert law.trace([0.0], [speed])[0] == pytest.approx((damping + 4e-4) * speed, rel=1e-14)


@given(fadings, st.floats(1e-3, 1e3))
def test_fading_leaves_steady_sliding_as_it_is(fading: float, speed: float) -> None:
    law = bristle(damping_fading=fading)
    expected = level(law, speed) + law.viscous * speed
    assert law.steady(speed) == pytest.approx(expected, rel=1e-14)


@given(levels, fadings)
def test_the_warning_starts_where_viscous_friction_outweighs_the_bristle(ratio: float, fading: float) -> None:
    law = bristle(breakaway=COULOMB * ratio, damping_fading=fading)
    enough = needed(law)
    bristle(breakaway=COULOMB * ratio, damping_fading=fading, viscous=enough * (1.0 + 1e-9) + 1e-16).check()
    if enough > 1e-9:
        with pytest.warns(sw.PassivityWarning, match="viscous"):
            bristle(breakaway=COULOMB * ratio, damping_fading=fading, viscous=enough * (1.0 - 1e-9)).check()


@given(levels, fadings, st.floats(1e-4, 1e3), st.floats(-1.0, 1.0))
def test_a_bristle_that_is_not_warned_of_dissipates_however_it_is_bent(
    ratio: float, fading: float, speed: float, bent: float
) -> None:
    law = bristle(breakaway=COULOMB * ratio, damping_fading=fading)
    law = bristle(breakaway=COULOMB * ratio, damping_fading=fading, viscous=max(needed(law), 0.0))
    deflection = bent * max(law.coulomb, law.breakaway) / STIFFNESS
    rounding = 1e-13 * (DAMPING * speed + law.breakaway + law.coulomb) * speed
    assert dissipated(law, speed, deflection) >= -rounding * ratio


@given(st.floats(1.05, 6.0), st.floats(0.5, 0.99))
def test_less_viscous_friction_creates_energy_at_some_speed(ratio: float, missing: float) -> None:
    """The condition is necessary for a constant damping, as the bristle stays bent while the speed rises without bound."""
    law = bristle(breakaway=COULOMB * ratio)
    law = bristle(breakaway=COULOMB * ratio, viscous=missing * needed(law))
    fully_bent = law.breakaway / STIFFNESS
    speed = 2.0 * law.breakaway**2 / (COULOMB * (1.0 - missing) * needed(law))
    assert dissipated(law, speed, fully_bent) < 0.0


def test_the_published_set_creates_energy_above_its_critical_speed() -> None:
    law = bristle()
    assert dissipated(law, 13.0, 0.07 / STIFFNESS) == pytest.approx(-0.0104, rel=1e-12)
    assert dissipated(law, 12.89473684210526, 0.07 / STIFFNESS) == pytest.approx(0.0, abs=1e-14)


def test_damping_that_fades_makes_the_published_set_passive() -> None:
    law = bristle(damping_fading=100.0)
    assert needed(law) < law.viscous
    law.check()
    assert dissipated(law, 13.0, 0.07 / STIFFNESS) > 0.0


def test_a_bristle_follows_its_differential_equation() -> None:
    """Constant accelerations in small steps against an adaptive solver: the mean speed of a step is exact to second order."""
    law = bristle(damping_fading=2.0)
    time = np.linspace(0.0, 0.3, 30001)
    speed = 0.5 * np.sin(20.0 * time)

    def rate(t: float, z: Any) -> Any:
        v = 0.5 * math.sin(20.0 * t)
        return v - STIFFNESS * abs(v) * z / level(law, v)

    z = solve_ivp(rate, (0.0, 0.3), [0.0], rtol=1e-11, atol=1e-14, t_eval=time, max_step=1e-3).y[0]
    rates = speed - STIFFNESS * np.abs(speed) * z / level(law, speed)
    expected = STIFFNESS * z + DAMPING * np.exp(-((2.0 * speed) ** 2)) * rates + 4e-4 * speed
    np.testing.assert_allclose(law.trace(time, speed), expected, rtol=0.0, atol=1e-7)


@pytest.mark.parametrize("speed", [-1e4, -1e-3, 1e-9, 2.0, 1e8])
def test_without_dry_friction_only_viscous_friction_is_left(speed: float) -> None:
    law = bristle(coulomb=0.0, breakaway=0.0, viscous=0.03)
    assert law.steady(speed) == pytest.approx(0.03 * speed, rel=1e-12)


def test_a_bristle_has_some_reach_at_rest() -> None:
    with pytest.raises(ValueError, match=r"^lugre: breakaway must be positive if coulomb is positive$"):
        made(LuGre, coulomb=0.03, breakaway=0.0)
    with pytest.raises(ValueError, match="breakaway must be positive if coulomb is positive"):
        bristle().replace(breakaway=0.0)


@pytest.mark.parametrize("speed", [5e-324, 1e-300, 1e200, 1e300])
def test_no_speed_is_too_extreme(speed: float) -> None:
    law = bristle()
    assert law.steady(speed) == pytest.approx(float(level(law, 0.0 if speed < 1.0 else 1.0)) + 4e-4 * speed, rel=1e-12)
    assert math.isfinite(law.trace([0.0, 1.0], [speed, -speed])[-1])
