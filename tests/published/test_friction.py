"""LuGre against numbers computed independently at high precision, from its closed forms."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from scipy.integrate import simpson

BRISTLE = sw.friction.LuGre(
    coulomb=0.05, breakaway=0.07, stribeck_speed=0.1, bristle_stiffness=50.0, bristle_damping=0.02, viscous=4e-4
)
SLOW = 0.01  # rad/s


@pytest.mark.parametrize(
    ("speed", "torque"),
    [
        (0.001, 0.06999840009999667),
        (0.01, 0.06980499667498336),
        (0.1, 0.05739758882342885),
        (1.0, 0.0504),
        (100.0, 0.09),
    ],
)
def test_steady_sliding_follows_the_stribeck_curve(speed: float, torque: float) -> None:
    assert BRISTLE.steady(speed) == pytest.approx(torque, rel=1e-14)


def test_the_bristle_bends_from_rest() -> None:
    time = [0.0, 0.1]
    torque = BRISTLE.trace(time, speed=[SLOW, SLOW])
    assert torque[0] == pytest.approx(0.000204, rel=1e-14)
    assert torque[1] == pytest.approx(0.03580172528196663, rel=1e-14)


def test_the_bristle_after_half_a_second() -> None:
    """Its deflection is what a contact that has stopped still holds, over the bristle's stiffness."""
    held = BRISTLE.trace([0.0, 0.5, 0.5 + 1e-12], speed=[SLOW, SLOW, 0.0])[-1]
    assert held / BRISTLE.bristle_stiffness == pytest.approx(1.357167534975793e-3, rel=1e-10)


def test_a_slow_loop_has_its_peak_and_its_loss() -> None:
    """Back and forth until the loop repeats itself, so slowly that only the bristle is left of the torque."""
    speed, amplitude, legs = 1e-12, 2e-3, 15
    duration = 2.0 * amplitude / speed
    starts = duration * (np.arange(legs) - 0.5)
    starts[0] = 0.0
    counts = np.append(np.full(legs - 1, 2), 2001)
    ends = np.append(starts[1:], starts[-1] + duration)
    time = [np.linspace(a + 1e-12 * duration, b, n) for a, b, n in zip(starts, ends, counts, strict=True)]
    velocity = np.repeat(speed * (-1.0) ** np.arange(legs), counts)
    last = BRISTLE.trace(np.concatenate(time), velocity)[-counts[-1] :]
    assert last[-1] == pytest.approx(0.06239614274143031, rel=1e-11)
    assert last[0] == pytest.approx(-last[-1], rel=1e-11)
    assert 2.0 * simpson(last, dx=2.0 * amplitude / (counts[-1] - 1)) == pytest.approx(2.105816006479903e-4, rel=1e-10)


def dissipated(speed: float) -> float:
    """Power [W] that is neither stored in the fully bent bristle nor given back by it: F v - z dz/dt sigma_0."""
    bent = BRISTLE.breakaway / BRISTLE.bristle_stiffness
    torque = BRISTLE.trace([0.0], [speed], state=BRISTLE.State(deflection=bent))[0]
    rate = (torque - BRISTLE.breakaway - BRISTLE.viscous * speed) / BRISTLE.bristle_damping
    return float(torque * speed - BRISTLE.breakaway * rate)


def test_too_little_viscous_friction_creates_energy_at_high_speed() -> None:
    assert dissipated(13.0) == pytest.approx(-0.0104, rel=1e-12)
    assert dissipated(12.89473684210526) == pytest.approx(0.0, abs=1e-14)
    assert dissipated(12.89) > 0.0


def test_a_set_that_can_create_energy_says_so_and_the_limit_itself_is_silent() -> None:
    with pytest.warns(sw.PassivityWarning, match=r"viscous = 0\.0004 .* 0\.008"):
        BRISTLE.check()
    BRISTLE.replace(viscous=0.02 * (0.07 / 0.05 - 1.0)).check()
