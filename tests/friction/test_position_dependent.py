"""Document P's friction: an average over the whole range, a ripple over each turn, and where it is valid."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave.friction import PositionDependent

from tests.support.strategies import made

PUBLISHED = PositionDependent(
    quadratic=1.5738e-6,
    linear=-3.7901e-4,
    constant=0.0720,
    static_ratio=1.0388,
    speed_factor=0.0004,
    reference_speed=0.8,
    domain_start=0.0,
    domain_end=3.7901e-4 / 1.5738e-6,
)
REFERENCE = 0.8  # rad/s
MINIMUM_PLACE, MINIMUM = 120.412377685, 0.0491812523669  # rad, N.m

coefficients = st.lists(st.floats(-0.01, 0.01), max_size=10)
angles = st.floats(0.0, 240.0)
speeds = st.floats(1e-3, 50.0)


def test_the_published_average_falls_to_its_minimum_and_comes_back() -> None:
    level = PUBLISHED.steady(REFERENCE, angle=[0.0, MINIMUM_PLACE, PUBLISHED.domain_end])
    np.testing.assert_allclose(level, [0.072, MINIMUM, 0.072], rtol=1e-11)
    around = PUBLISHED.steady(REFERENCE, angle=MINIMUM_PLACE + np.array([-0.1, 0.0, 0.1]))
    assert around[1] < min(around[0], around[2])


def test_the_domain_ends_where_the_average_is_back_at_its_start() -> None:
    assert PUBLISHED.domain_start == 0.0
    assert PUBLISHED.domain_end == pytest.approx(2.0 * MINIMUM_PLACE, rel=1e-11)
    assert PUBLISHED.domain_end == -PUBLISHED.linear / PUBLISHED.quadratic


@given(angles, coefficients, coefficients, speeds)
def test_it_is_the_sum_that_document_p_prints_with_the_sign_of_friction(
    angle: float, cosine: list[float], sine: list[float], speed: float
) -> None:
    law = PUBLISHED.replace(cosine=cosine, sine=sine)
    ripple = math.fsum(
        [a * math.cos(k * angle) for k, a in enumerate(cosine, 1)] + [b * math.sin(k * angle) for k, b in enumerate(sine, 1)]
    )
    average = 1.5738e-6 * angle**2 - 3.7901e-4 * angle + 0.0720
    expected = max(average * ((speed - 0.8) * 0.0004 + 1.0) + ripple, 0.0)
    assert law.steady(speed, angle=angle) == pytest.approx(expected, rel=0.0, abs=1e-13)
    assert law.steady(-speed, angle=angle) == -law.steady(speed, angle=angle)


@given(angles, coefficients, coefficients)
def test_it_holds_388_parts_in_ten_thousand_more_than_the_coulomb_level(
    angle: float, cosine: list[float], sine: list[float]
) -> None:
    """The Coulomb level was measured at the reference speed; hence steady() there."""
    law = PUBLISHED.replace(cosine=cosine, sine=sine)
    for sense in (1.0, -1.0):
        assert law.hold(sense, angle=angle) == pytest.approx(1.0388 * law.steady(REFERENCE, angle=angle), rel=1e-13, abs=1e-300)


@given(
    st.lists(st.floats(-0.004, 0.004), min_size=10, max_size=10), st.lists(st.floats(-0.004, 0.004), min_size=10, max_size=10)
)
def test_document_p_s_integrals_give_the_coefficients_back(cosine: list[float], sine: list[float]) -> None:
    law = made(PositionDependent, constant=0.1, cosine=cosine, sine=sine)
    angle = 2.0 * math.pi * np.arange(64) / 64
    spectrum = np.fft.rfft(law.steady(REFERENCE, angle=angle)) / 32.0
    np.testing.assert_allclose(spectrum.real[1:11], cosine, rtol=0.0, atol=1e-16)
    np.testing.assert_allclose(-spectrum.imag[1:11], sine, rtol=0.0, atol=1e-16)


@given(st.integers(-37, 37), st.floats(-math.pi, math.pi))
def test_the_ripple_repeats_with_every_turn(turns: int, angle: float) -> None:
    law = made(PositionDependent, constant=0.1, cosine=[0.01, 0.02], sine=[0.0, 0.0, 0.03], outside="clamp")
    later = law.steady(1.0, angle=angle + 2.0 * math.pi * turns)
    assert later == pytest.approx(law.steady(1.0, angle=angle), rel=0.0, abs=1e-13)


def test_clamp_keeps_the_value_of_the_nearer_end() -> None:
    law = PUBLISHED.replace(domain_end=100.0, outside="clamp")
    ends = law.steady(REFERENCE, angle=[0.0, 100.0])
    assert law.steady(REFERENCE, angle=[-1e6, -1e-9, 100.0 + 1e-9, 1e6]).tolist() == [ends[0], ends[0], ends[1], ends[1]]


@given(st.floats(10.0, 90.0), st.integers(-1000, 1000))
def test_periodic_repeats_the_domain(angle: float, periods: int) -> None:
    law = PUBLISHED.replace(domain_start=5.0, domain_end=105.0, outside="periodic")
    later = law.steady(REFERENCE, angle=angle + 100.0 * periods)
    assert later == pytest.approx(law.replace(outside="refuse").steady(REFERENCE, angle=angle), rel=1e-12)


def test_the_published_average_repeats_without_a_jump() -> None:
    law = PUBLISHED.replace(outside="periodic")
    seam = law.domain_end * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    for side in (-1e-9, 1e-9):
        np.testing.assert_allclose(law.steady(REFERENCE, angle=seam + side), 0.072, rtol=1e-10)


@pytest.mark.parametrize("angle", [-0.1, 240.9, 1e6])
def test_refuse_says_which_angle_lies_outside(angle: float) -> None:
    with pytest.raises(ValueError, match="angle"):
        PUBLISHED.steady(1.0, angle=angle)
    with pytest.raises(ValueError, match="angle"):
        PUBLISHED.hold(angle=angle)
    for outside in ("clamp", "periodic"):
        assert math.isfinite(PUBLISHED.replace(outside=outside).steady(1.0, angle=angle))


def test_refuse_takes_both_ends() -> None:
    assert PUBLISHED.steady(REFERENCE, angle=[0.0, PUBLISHED.domain_end]) == pytest.approx(0.072, rel=1e-11)


@given(coefficients.map(lambda drawn: [100.0 * a for a in drawn]), st.floats(-1e4, 1e4), st.floats(-50.0, 50.0))
def test_a_ripple_larger_than_the_average_never_pushes(cosine: list[float], angle: float, speed: float) -> None:
    law = PUBLISHED.replace(cosine=cosine, outside="clamp")
    assert law.steady(speed, angle=angle) * speed >= 0.0
    assert law.hold(angle=angle) >= abs(law.steady(1e-300, angle=angle))


def test_the_speed_factor_is_relative_to_the_reference_speed_and_viscous_friction_adds_to_it() -> None:
    law = PUBLISHED.replace(speed_factor=0.01, reference_speed=2.0, viscous=1e-3)
    assert law.steady(12.0) == pytest.approx(0.072 * 1.1 + 0.012, rel=1e-14)
    assert law.steady(-12.0) == -law.steady(12.0)


@pytest.mark.parametrize(
    ("field", "value"), [("static_ratio", 0.99), ("speed_factor", -1e-3), ("viscous", -1.0), ("domain_end", 0.0)]
)
def test_what_makes_no_sense_is_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        made(PositionDependent, **{field: value})
