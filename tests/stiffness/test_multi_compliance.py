"""Two hardening springs in series against independent numbers, the formula, its limits, and quadrature."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import quad
from strainwave.stiffness import Linear, MultiCompliance

from tests.support.strategies import log_uniform, signed

# K_f0, C_f, K_w0, C_w, N
SPRING = MultiCompliance(
    flexspline_stiffness=8000.0,
    flexspline_hardening=0.02,
    wave_generator_stiffness=2.0,
    wave_generator_hardening=1.5,
    reduction=100.0,
)
BOUND = math.pi / (2.0 * 0.02 * 8000.0) + 1.0 / (100.0 * 1.5 * 2.0)
LARGEST = 1e6 / 0.02
RIGID = 1e30

hardenings = st.just(0.0) | log_uniform(1e-3, 1e-1)
springs = st.builds(
    MultiCompliance,
    flexspline_stiffness=log_uniform(1e2, 1e5),
    flexspline_hardening=hardenings,
    wave_generator_stiffness=log_uniform(1e-2, 1e2),
    wave_generator_hardening=st.just(0.0) | log_uniform(1e-2, 1e1),
    reduction=st.floats(30.0, 320.0),
)
torques = log_uniform(1e-12, 1e3)


def twist_of(spring: MultiCompliance, torque: float) -> float:
    """The formula, which for a hardening of zero is its limit."""
    flexed, waved = spring.flexspline_hardening, spring.wave_generator_hardening / spring.reduction
    flexspline = math.atan(flexed * torque) / flexed if flexed > 0.0 else torque
    wave_generator = -math.expm1(-waved * torque) / waved if waved > 0.0 else torque
    input_side = spring.reduction**2 * spring.wave_generator_stiffness
    return flexspline / spring.flexspline_stiffness + wave_generator / input_side


def compliance_of(spring: MultiCompliance, torque: float) -> float:
    """1/K = 1/K_f + 1/(N^2 K_w), with each stiffness as document R hardens it."""
    flexspline = spring.flexspline_stiffness * (1.0 + (spring.flexspline_hardening * torque) ** 2)
    wave_generator = math.exp(-spring.wave_generator_hardening * torque / spring.reduction) / spring.wave_generator_stiffness
    return 1.0 / flexspline + wave_generator / spring.reduction**2


def test_twists_computed_independently() -> None:
    expected = [1.74610205321982e-4, 3.242104121346554e-3, 9.509245619051633e-3]
    assert SPRING.twist([1.0, 20.0, 100.0]) == pytest.approx(expected, rel=1e-15)


def test_torque_and_stiffness_computed_independently() -> None:
    assert SPRING.torque(0.003) == pytest.approx(18.34712859873043, rel=1e-15)
    assert SPRING.tangent(0.0) == pytest.approx(5714.285714285714, rel=1e-15)


@given(springs, torques)
def test_twist_is_the_formula_to_the_last_digits(spring: MultiCompliance, torque: float) -> None:
    assert spring.twist(torque) == pytest.approx(twist_of(spring, torque), rel=2e-15)


@given(springs, torques)
def test_torque_is_the_formula_solved(spring: MultiCompliance, torque: float) -> None:
    """Up to the rounding of the twist, times what the stiffness makes of it."""
    twist = twist_of(spring, torque)
    rounding = 2e-15 * (torque + twist / compliance_of(spring, torque))
    assert spring.torque(twist) == pytest.approx(torque, rel=0.0, abs=rounding)


@given(springs, torques)
def test_compliances_add(spring: MultiCompliance, torque: float) -> None:
    twist = spring.twist(torque)
    conditioning = 1.0 + twist / (torque * compliance_of(spring, torque))
    assert spring.tangent(twist) == pytest.approx(1.0 / compliance_of(spring, torque), rel=4e-15 * conditioning)


@pytest.mark.parametrize("torque", [1e-3, 1.0, 20.0, 100.0, 1000.0])
@pytest.mark.parametrize(
    "spring", [SPRING, SPRING.replace(flexspline_hardening=0.0), SPRING.replace(wave_generator_hardening=0.0)]
)
def test_energy_is_the_integral_of_torque_over_twist(spring: MultiCompliance, torque: float) -> None:
    work, _ = quad(lambda t: t * compliance_of(spring, t), 0.0, torque, epsabs=0.0, epsrel=1e-13, limit=200)
    assert spring.energy(twist_of(spring, torque)) == pytest.approx(work, rel=1e-12)


@given(log_uniform(1e1, 1e5), log_uniform(1e-3, 1e-1), st.floats(1e-6, 0.99))
def test_on_a_rigid_wave_generator_it_is_the_flexspline(stiffness: float, hardening: float, share: float) -> None:
    spring = SPRING.replace(flexspline_stiffness=stiffness, flexspline_hardening=hardening, wave_generator_stiffness=RIGID)
    angle = 0.5 * math.pi * share
    twist = angle / (hardening * stiffness)
    assert spring.torque(twist) == pytest.approx(math.tan(angle) / hardening, rel=1e-13)
    energy = -math.log(math.cos(angle)) / (hardening**2 * stiffness)  # of tan over its angle
    assert spring.energy(twist) == pytest.approx(energy, rel=1e-13, abs=1e-16 / (hardening**2 * stiffness))


@given(log_uniform(1e-2, 1e2), log_uniform(1e-2, 1e1), st.floats(30.0, 320.0), st.floats(1e-6, 0.99))
def test_on_a_rigid_flexspline_it_is_the_wave_generator(stiffness: float, hardening: float, ratio: float, share: float) -> None:
    spring = MultiCompliance(
        flexspline_stiffness=RIGID,
        flexspline_hardening=0.02,
        wave_generator_stiffness=stiffness,
        wave_generator_hardening=hardening,
        reduction=ratio,
    )
    twist = share / (ratio * hardening * stiffness)
    assert spring.torque(twist) == pytest.approx(-math.log1p(-share) * ratio / hardening, rel=1e-13)
    energy = (share + (1.0 - share) * math.log1p(-share)) / (hardening**2 * stiffness)  # of -log(1 - u) over u
    assert spring.energy(twist) == pytest.approx(energy, rel=1e-12, abs=1e-15 * share / (hardening**2 * stiffness))


@given(log_uniform(1e2, 1e5), log_uniform(1e-2, 1e2), st.floats(30.0, 320.0), signed(log_uniform(1e-9, 1e3)))
def test_without_hardening_it_is_two_linear_springs(k_f: float, k_w: float, ratio: float, torque: float) -> None:
    linear = Linear(k=1.0 / (1.0 / k_f + 1.0 / (ratio**2 * k_w)))
    soft = partial(MultiCompliance, flexspline_stiffness=k_f, wave_generator_stiffness=k_w, reduction=ratio)
    for hardening in (0.0, 1e-300, 1e-20):
        spring = soft(flexspline_hardening=hardening, wave_generator_hardening=hardening)
        twist = linear.twist(torque)
        assert spring.twist(torque) == pytest.approx(twist, rel=2e-15)
        assert spring.torque(twist) == pytest.approx(torque, rel=2e-15)
        assert spring.tangent(twist) == pytest.approx(linear.k, rel=2e-15)
        assert spring.energy(twist) == pytest.approx(linear.energy(twist), rel=4e-15)


@given(springs, log_uniform(1e-290, 1e-15))
def test_the_tiniest_torque_keeps_its_digits(spring: MultiCompliance, torque: float) -> None:
    """Hardening does not show yet."""
    twist = torque * compliance_of(spring, 0.0)
    assert spring.twist(torque) == pytest.approx(twist, rel=4e-15, abs=0.0)
    assert spring.torque(twist) == pytest.approx(torque, rel=4e-15, abs=0.0)


@given(springs, torques)
def test_the_reduction_only_refers_the_wave_generator_to_the_output(spring: MultiCompliance, torque: float) -> None:
    """Torque at the input is N times smaller, and its angle N times larger."""
    at_output = spring.replace(
        wave_generator_stiffness=spring.wave_generator_stiffness * spring.reduction**2,
        wave_generator_hardening=spring.wave_generator_hardening / spring.reduction,
        reduction=1.0,
    )
    assert spring.twist(torque) == pytest.approx(at_output.twist(torque), rel=2e-15)


def test_the_twist_has_a_bound_and_is_refused_beyond() -> None:
    """The wave generator's share is 1 / (N C_w K_w0) at the output: there its angle counts N times less."""
    assert SPRING.twist(1e12) == pytest.approx(BOUND, rel=1e-12)
    for share in (-1.0 - 1e-12, 1.0 + 1e-12, 2.0, 1e300):
        for verb in (SPRING.torque, SPRING.tangent, SPRING.energy):
            with pytest.raises(ValueError, match=r"multi_compliance: twist = .* rad"):
                verb(share * BOUND)


@pytest.mark.parametrize("field", ["flexspline_hardening", "wave_generator_hardening"])
def test_without_one_of_the_hardenings_there_is_no_bound(field: str) -> None:
    spring = SPRING.replace(**{field: 0.0})
    torque = spring.torque([BOUND, 1.0, 1e3])
    assert np.all(np.diff(torque) > 0.0)
    assert spring.twist(torque) == pytest.approx([BOUND, 1.0, 1e3], rel=1e-15)


@pytest.mark.parametrize("left", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_torque_is_found_however_near_the_bound(left: float) -> None:
    twist = BOUND * (1.0 - left)
    torque = SPRING.torque(twist)
    assert SPRING.twist(torque) == pytest.approx(twist, rel=5e-16)
    assert torque < LARGEST


def test_near_the_bound_the_torque_grows_as_the_flexspline_lets_it() -> None:
    """The arctan's end: torque times what is left of the twist tends to 1 / (C_f^2 K_f0), the wave generator being spent."""
    twist = BOUND * (1.0 - 1e-4)
    assert SPRING.torque(twist) * (BOUND - twist) == pytest.approx(1.0 / (0.02**2 * 8000.0), rel=1e-7)


def test_at_the_bound_the_torque_is_the_largest() -> None:
    twist = np.array([1.0 - 4e-7, 1.0 - 1e-9, 1.0 - 1e-14]) * BOUND
    assert SPRING.torque(twist) == pytest.approx(LARGEST, rel=1e-15)
    assert SPRING.twist(LARGEST) == pytest.approx(BOUND, rel=1e-6)


def test_torque_rises_all_the_way_from_bound_to_bound() -> None:
    left = np.geomspace(1e-6, 1.0, 2000)
    twist = BOUND * np.concatenate((left[:-1] - 1.0, (1.0 - left)[::-1]))
    assert np.all(np.diff(twist) > 0.0)
    assert np.all(np.diff(SPRING.torque(twist)) > 0.0)
    assert np.all(np.diff(SPRING.energy(twist[twist >= 0.0])) > 0.0)


@given(springs, torques)
def test_a_step_of_the_last_digit_does_not_turn_the_torque_round(spring: MultiCompliance, torque: float) -> None:
    twist = spring.twist(torque) * (1.0 - 1e-3)
    steps = twist * (1.0 + np.arange(50) * 2.0**-50)
    rounding = 2e-15 * (torque + twist / compliance_of(spring, torque))
    assert np.diff(spring.torque(steps)).min() >= -rounding


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("flexspline_stiffness", 0.0),
        ("wave_generator_stiffness", 0.0),
        ("flexspline_hardening", -0.02),
        ("wave_generator_hardening", -1.5),
        ("reduction", 0.5),
        ("reduction", -100.0),
    ],
)
def test_what_is_no_spring_or_no_reduction_is_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"multi_compliance.{field} = "):
        SPRING.replace(**{field: value})
