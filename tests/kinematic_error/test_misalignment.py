"""Misalignment against the geometry itself, point by point in space, and against the closed forms of what is small."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.optimize import brentq
from strainwave.kinematic_error import Misalignment

from tests.support.strategies import made

Array = NDArray[np.float64]

A, B, R = 25.3e-3, 24.7e-3, 25e-3  # m
FLANK = math.tan(math.radians(20.0)) / R
RADII: dict[str, float] = {"major_radius": A, "minor_radius": B, "pitch_radius": R, "pressure_angle": math.radians(20.0)}
COMBINE = ("single", "mean", "max")
combines = pytest.mark.parametrize("combine", COMBINE)

EVERYTHING: dict[str, float] = {
    "housing_eccentricity": 200e-6,
    "housing_direction": 0.4,
    "housing_tilt_x": 0.02,
    "housing_tilt_y": -0.03,
    "generator_eccentricity": 100e-6,
    "generator_direction": 0.9,
    "generator_tilt_x": 0.01,
    "generator_tilt_y": 0.015,
}
GENERATOR = {name: value for name, value in EVERYTHING.items() if name.startswith("generator")}
HOUSING = {name: value for name, value in EVERYTHING.items() if name.startswith("housing")}


def gear(scale: float = 1.0, misalignment: Mapping[str, float] = EVERYTHING, **others: Any) -> Misalignment:
    """A misalignment whose lengths and tilts, not its directions, are so many times as large."""
    scaled = {name: value if "direction" in name else scale * value for name, value in misalignment.items()}
    return Misalignment(**{**RADII, "minor_radius": 20e-3, "offset": 4e-3, **scaled, **others})


def turn(samples: int) -> Array:
    return 2.0 * np.pi * np.arange(samples) / samples


def harmonics(values: Array) -> NDArray[np.complex128]:
    """By order n, the y_n of Re sum y_n exp(j n theta)."""
    return np.fft.rfft(values) / (len(values) / 2)


def closed_form(law: Misalignment, highest: int) -> NDArray[np.complex128]:
    """`leading` in the same terms."""
    sum_ = np.zeros(highest + 1, dtype=np.complex128)
    fourier = law.leading()
    for order, amplitude, phase in zip(fourier.order, fourier.amplitude, fourier.phase, strict=True):
        sum_[int(order)] += amplitude * np.exp(1j * (phase - np.pi / 2.0))
    return sum_


# The geometry, in space


def rotation(axis: int, angle: float) -> Array:
    """About x, y or z, right-handed."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = math.cos(angle)
    matrix[j, i] = math.sin(angle)
    matrix[i, j] = -matrix[j, i]
    return matrix


def polar_radius(law: Misalignment, angle: float, direction: float) -> float:
    """Where a ray from the circular spline's axis meets the section: a search along the cylinder's circumference.

    A point of the cylinder is put where the assembly puts it, slid along the cylinder into the plane normal to the shaft.
    """
    axis = law.housing_eccentricity * np.array([math.cos(law.housing_direction), math.sin(law.housing_direction), 0.0])
    off = law.generator_eccentricity * np.array([math.cos(law.generator_direction), math.sin(law.generator_direction), 0.0])
    shaft = rotation(1, law.housing_tilt_x) @ rotation(0, -law.housing_tilt_y)
    body = rotation(1, law.generator_tilt_x) @ rotation(0, -law.generator_tilt_y)
    turned = rotation(2, angle)

    def point(t: float) -> Array:
        ring = turned @ (off + body @ np.array([law.major_radius * math.cos(t), law.minor_radius * math.sin(t), 0.0]))
        along = turned @ body[:, 2]
        place: Array = axis + shaft @ (ring + along * (law.offset - ring[2]) / along[2])
        return place

    def beside(t: float) -> float:
        x, y, _ = point(t)
        return float(y * math.cos(direction) - x * math.sin(direction))

    x, y, _ = point(brentq(beside, direction - angle - 1.0, direction - angle + 1.0, xtol=1e-15))
    return float(x * math.cos(direction) + y * math.sin(direction))


tilts = st.floats(-0.2, 0.2)
lengths = st.floats(0.0, 1e-3)
directions = st.floats(-math.pi, math.pi)
misalignments = st.builds(
    Misalignment,
    major_radius=st.just(A),
    minor_radius=st.sampled_from([B, 18e-3]),
    pitch_radius=st.just(R),
    offset=st.floats(-10e-3, 10e-3),
    housing_eccentricity=lengths,
    housing_direction=directions,
    housing_tilt_x=tilts,
    housing_tilt_y=tilts,
    generator_eccentricity=lengths,
    generator_direction=directions,
    generator_tilt_x=tilts,
    generator_tilt_y=tilts,
    combine=st.sampled_from(COMBINE),
)


@given(misalignments, directions)
def test_the_lobes_stand_where_the_section_of_the_cylinder_has_them(law: Misalignment, angle: float) -> None:
    lobes = law.lobes(np.array([angle]))
    for displacement, direction in zip(lobes, (angle, angle + math.pi), strict=True):
        assert displacement[0] == pytest.approx(polar_radius(law, angle, direction) - law.major_radius, rel=0.0, abs=1e-15)


@given(misalignments, directions)
def test_the_error_is_the_combined_displacement_acting_through_the_flank(law: Misalignment, angle: float) -> None:
    one, other = (float(displacement[0]) for displacement in law.lobes(np.array([angle])))
    combined = {"single": one, "mean": (one + other) / 2.0, "max": max(one, other)}[str(law.combine)]
    flank = math.tan(law.pressure_angle) / law.pitch_radius
    assert law.error(angle) == pytest.approx(-flank * combined, rel=1e-13, abs=1e-18)


@pytest.mark.parametrize("combine", ["single", "mean"])
def test_the_slope_is_the_derivative_of_every_harmonic(combine: str) -> None:
    law, theta = gear(combine=combine), turn(128)
    spectrum = np.fft.rfft(law.error(theta)) * 1j * np.arange(65)
    assert abs(spectrum[-9:]).max() < 1e-13 * abs(spectrum).max()
    slope = np.fft.irfft(spectrum)
    np.testing.assert_allclose(law.slope(theta), slope, rtol=0.0, atol=1e-12 * np.abs(slope).max())


def test_the_slope_of_the_larger_lobe_is_that_of_the_lobe_that_carries() -> None:
    """Without faults of the generator the second lobe is the first, half a turn later."""
    larger, single = (gear(misalignment=HOUSING, combine=combine) for combine in ("max", "single"))
    theta = turn(720)
    one, other = larger.lobes(theta)
    slope = larger.slope(theta)
    assert 0 < np.count_nonzero(one < other) < len(theta)
    assert slope[one > other].tolist() == single.slope(theta)[one > other].tolist()
    opposite = single.slope(theta + math.pi)
    np.testing.assert_allclose(slope[one < other], opposite[one < other], rtol=0.0, atol=1e-14 * np.abs(slope).max())


# The numbers computed independently at high precision


def test_published_lobes_of_a_gear_with_every_misalignment() -> None:
    law = Misalignment(
        **RADII,
        offset=4e-3,
        housing_eccentricity=20e-6,
        housing_direction=0.4,
        housing_tilt_x=math.radians(0.1),
        housing_tilt_y=math.radians(-0.05),
        generator_eccentricity=10e-6,
        generator_direction=0.9,
        generator_tilt_x=math.radians(0.08),
        generator_tilt_y=math.radians(0.03),
    )
    one, other = law.lobes(np.array([0.0, 1.0]))
    assert one == pytest.approx([3.71855839927659e-05, 2.91650039928662e-05], rel=1e-11)
    assert other == pytest.approx([-3.72217203524899e-05, -2.91202356540871e-05], rel=1e-11)


@pytest.mark.parametrize(
    ("combine", "order", "displacement", "minutes"),
    [("single", 1, 2.0e-5, 1.001), ("max", 2, 8.492e-6, 0.425), ("max", 4, 1.698e-6, None)],
)
def test_published_harmonics_of_an_eccentric_gear(combine: str, order: int, displacement: float, minutes: float | None) -> None:
    law = Misalignment(**RADII, housing_eccentricity=20e-6, combine=combine)
    amplitude = abs(harmonics(law.error(turn(1 << 14)))[order])
    assert amplitude / FLANK == pytest.approx(displacement, rel=1e-3)
    if minutes is not None:
        assert math.degrees(amplitude) * 60.0 == pytest.approx(minutes, abs=1e-3)


# What remains of a small misalignment


def test_leading_harmonics_of_an_eccentric_gear_are_the_textbook_ones() -> None:
    def amplitudes(combine: str) -> dict[float, float]:
        fourier = Misalignment(**RADII, housing_eccentricity=20e-6, combine=combine).leading()
        return dict(zip(fourier.order, fourier.amplitude, strict=True))

    e = 20e-6
    assert amplitudes("single") == pytest.approx({1.0: FLANK * e}, rel=1e-13)
    assert amplitudes("mean") == pytest.approx({1.0: 0.0, 2.0: FLANK * e**2 * A / (4.0 * B**2)}, rel=1e-13, abs=1e-22)
    even = {float(n): FLANK * 4.0 * e / (math.pi * (n * n - 1)) for n in (2, 4, 6, 8)}
    assert amplitudes("max") == pytest.approx({**even, 1.0: 0.0, 3.0: 0.0, 5.0: 0.0, 7.0: 0.0}, rel=1e-13, abs=1e-22)


@pytest.mark.parametrize(("combine", "left_out"), [("single", 2), ("mean", 4), ("max", 2)])
def test_leading_harmonics_leave_out_what_is_of_higher_order(combine: str, left_out: int) -> None:
    def gap(scale: float) -> float:
        law = gear(scale, combine=combine)
        leading = closed_form(law, 8)
        kept = [int(order) for order in law.leading().order]
        return float(np.abs(harmonics(law.error(turn(1 << 14)))[:9] - leading)[kept].max())

    assert math.log10(gap(0.5) / gap(0.05)) == pytest.approx(left_out, abs=0.05)


@given(st.floats(-3.0, 3.0), directions)
def test_the_larger_lobe_compares_the_generator_with_the_housing(ratio: float, direction: float) -> None:
    """Of first order is |c + m cos(theta - beta)|, with c of the generator along its major axis; FFT against closed form."""
    law = Misalignment(
        **RADII,
        housing_eccentricity=1e-5,
        housing_direction=direction,
        generator_eccentricity=1e-5 * abs(ratio),
        generator_direction=0.0 if ratio > 0.0 else math.pi,
        combine="max",
    )
    displacement = np.abs(1e-5 * ratio + 1e-5 * np.cos(turn(1 << 13) - direction))
    expected = -FLANK * harmonics(displacement)[1:9]
    kink = 1e-6 * FLANK * 1e-5  # what the samples miss of it
    np.testing.assert_allclose(closed_form(law, 8)[1:], expected, rtol=0.0, atol=kink)


@combines
def test_leading_harmonics_tell_the_direction_of_the_eccentricity(combine: str) -> None:
    one = closed_form(Misalignment(**RADII, housing_eccentricity=2e-5, housing_direction=0.3, combine=combine), 8)
    other = closed_form(Misalignment(**RADII, housing_eccentricity=2e-5, housing_direction=-2.5, combine=combine), 8)
    np.testing.assert_allclose(other, one * np.exp(2.8j * np.arange(9)), rtol=0.0, atol=1e-15)


# Which parameters harmonics can tell


def test_the_eccentricity_is_that_of_the_shaft_where_the_section_lies() -> None:
    def gap(scale: float) -> float:
        law = gear(scale)
        e, beta, h = law.housing_eccentricity, law.housing_direction, law.offset
        expected = (e * math.cos(beta) + h * law.housing_tilt_x, e * math.sin(beta) + h * law.housing_tilt_y)
        x, y = law.eccentricity
        assert (x, y) == pytest.approx(expected, rel=3e-3 * scale**2)
        return math.hypot(x - expected[0], y - expected[1])

    assert math.log10(gap(1.0) / gap(0.1)) == pytest.approx(3.0, abs=0.01)


def test_an_eccentricity_and_a_tilt_with_offset_look_alike() -> None:
    """To first order; `mean` lives of the second, where a tilt leaves its own mark."""
    tilted = Misalignment(**RADII, offset=4e-3, housing_tilt_x=3e-4, housing_tilt_y=4e-4)
    eccentric = Misalignment(**RADII, housing_eccentricity=2e-6, housing_direction=math.atan2(4.0, 3.0))
    theta = turn(64)
    np.testing.assert_allclose(tilted.error(theta), eccentric.error(theta), rtol=0.0, atol=3e-3 * FLANK * 2e-6)
    assert closed_form(tilted, 1) == pytest.approx(closed_form(eccentric, 1), rel=1e-6)


@combines
def test_the_generator_alone_gives_no_harmonic_at_all(combine: str) -> None:
    law, theta = gear(misalignment=GENERATOR, combine=combine), turn(360)
    assert np.ptp(law.error(theta)) == 0.0
    assert np.abs(law.slope(theta)).max() == 0.0
    assert law.error(0.0) != 0.0


@pytest.mark.parametrize("combine", ["single", "mean"])
def test_the_generator_off_along_its_major_axis_changes_no_harmonic(combine: str) -> None:
    theta = turn(64)
    eccentric = Misalignment(**RADII, housing_eccentricity=2e-4, housing_direction=0.4, combine=combine)
    both = eccentric.replace(generator_eccentricity=1e-4)
    change = harmonics(both.error(theta)) - harmonics(eccentric.error(theta))
    rounding = 1e-15 * FLANK * A
    assert np.abs(change[1:]).max() < rounding
    assert change[0].real == pytest.approx(-2.0 * FLANK * 1e-4 if combine == "single" else 0.0, rel=1e-10, abs=rounding)


@pytest.mark.parametrize("combine", ["single", "mean"])
def test_the_generator_off_along_its_minor_axis_acts_by_its_product_with_the_housing(combine: str) -> None:
    def change(scale: float) -> float:
        eccentric = gear(misalignment={}, housing_eccentricity=2e-4 * scale, housing_direction=0.4, combine=combine)
        both = eccentric.replace(generator_eccentricity=1e-4 * scale, generator_direction=math.pi / 2.0)
        theta = turn(64)
        return float(np.abs(harmonics(both.error(theta)) - harmonics(eccentric.error(theta)))[1])

    expected = FLANK * A * 1e-4 * 2e-4 / 20e-3**2
    assert change(1.0) == pytest.approx(expected, rel=1e-4)
    assert change(0.1) == pytest.approx(1e-2 * expected, rel=1e-6)


def test_tilts_of_the_generator_act_in_third_order_beside_the_offset() -> None:
    def change(scale: float) -> float:
        tilts = {name: GENERATOR[name] for name in ("generator_tilt_x", "generator_tilt_y")}
        both = gear(scale, misalignment=HOUSING | tilts, offset=0.0)
        theta = turn(64)
        alone = gear(scale, misalignment=HOUSING, offset=0.0)
        return float(np.abs(harmonics(both.error(theta)) - harmonics(alone.error(theta)))[1:].max())

    assert math.log10(change(1.0) / change(0.1)) == pytest.approx(3.0, abs=0.02)


def test_a_generator_further_off_than_the_housing_stops_the_lobes_from_changing() -> None:
    law = Misalignment(**RADII, housing_eccentricity=1e-5, generator_eccentricity=3e-5, combine="max")
    theta = turn(64)
    assert law.error(theta).tolist() == law.replace(combine="single").error(theta).tolist()
    assert closed_form(law, 8)[2:] == pytest.approx(np.zeros(7), abs=1e-15 * FLANK * 3e-5)


@combines
def test_without_offset_a_tilt_of_the_housing_acts_in_second_order(combine: str) -> None:
    tilts = {name: HOUSING[name] for name in ("housing_tilt_x", "housing_tilt_y")}

    def ripple(scale: float, offset: float) -> float:
        return float(np.ptp(gear(scale, misalignment=tilts, offset=offset, combine=combine).error(turn(128))))

    assert math.log10(ripple(1.0, 0.0) / ripple(0.1, 0.0)) == pytest.approx(2.0, abs=0.01)
    with_offset = 2.0 if combine == "mean" else 1.0
    assert math.log10(ripple(0.1, 4e-3) / ripple(0.01, 4e-3)) == pytest.approx(with_offset, abs=0.01)


@combines
def test_a_gear_without_misalignment_has_no_error(combine: str) -> None:
    law = Misalignment(**RADII, combine=combine)
    assert np.abs(law.error(turn(360))).max() == 0.0
    assert np.abs(law.slope(turn(360))).max() == 0.0
    assert max(law.leading().amplitude) == 0.0
    assert tuple(law.eccentricity) == (0.0, 0.0)


def test_an_axis_outside_the_generator_is_refused() -> None:
    for far in ({"housing_eccentricity": B}, {"generator_eccentricity": B}, {"offset": 1.0, "housing_tilt_x": 0.1}):
        with pytest.raises(ValueError, match="must pass through the wave generator"):
            Misalignment(**RADII, **far)
    with pytest.raises(
        ValueError, match=r"^misalignment: major_radius = \S+ m must lie between minor_radius = \S+ m and ten times that$"
    ):
        made(Misalignment, major_radius=B, minor_radius=A)


def test_every_sign_of_every_tilt_counts() -> None:
    """No two of the sixteen ways to lean give the same lobes."""
    names = ("housing_tilt_x", "housing_tilt_y", "generator_tilt_x", "generator_tilt_y")
    ways = product((1.0, -1.0), repeat=len(names))
    leaning = [gear(misalignment={n: s * EVERYTHING[n] for n, s in zip(names, signs, strict=True)}) for signs in ways]
    seen = {tuple(float(x[0]).hex() for x in law.lobes(np.array([0.7]))) for law in leaning}
    assert len(seen) == len(leaning)
