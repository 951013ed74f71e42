"""Units against their definitions (SI brochure, ISO 80000-3), and the spellings people use."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strainwave.units import check, convert

untimed = settings(deadline=None)  # the first example pays for the import of pint
finite = st.floats(-1e200, 1e200, allow_subnormal=False).filter(lambda number: number == 0.0 or abs(number) > 1e-200)


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


@pytest.mark.parametrize(
    ("value", "unit", "to", "expected"),
    [
        (1.0, "rpm", "rad/s", math.pi / 30),
        (60.0, "r/min", "rad/s", 2 * math.pi),
        (180.0, "deg", "rad", math.pi),
        (1.0, "arcmin", "deg", 1 / 60),
        (3600.0, "arcsec", "°", 1.0),
        (1.0, "rad/s^2", "deg/s2", 180 / math.pi),
        (100.0, "Ncm", "N.m", 1.0),
        (1.0, "kNm", "mNm", 1e6),
        (1.0, "g.cm2", "kg.m2", 1e-7),
        (1.0, "N.m.s/rad", "N.m/(r/min)", math.pi / 30),
        (1.0, "V/rpm", "V.s/rad", 30 / math.pi),
        (1.0, "N.m", "kg.m2/s2", 1.0),
        (1.0, "Ohm.A", "mV", 1000.0),
        (1.0, "H", "V.s/A", 1.0),
        (20.0, "°C", "K", 293.15),
        (250.0, "ms", "s", 0.25),
    ],
)
def test_conversions_follow_the_definitions(value: float, unit: str, to: str, expected: float) -> None:
    assert convert(value, unit, to) == pytest.approx(expected, rel=1e-15)


@untimed
@given(finite)
def test_radians_to_degrees_and_back_is_the_identity(angle: float) -> None:
    assert convert(convert(angle, "rad", "deg"), "deg", "rad") == pytest.approx(angle, rel=1e-15, abs=0.0)


@untimed
@given(finite, st.sampled_from([("rpm", "rad/s"), ("Ncm", "N.m"), ("min", "ms"), ("N.m/deg", "N.m/rad")]))
def test_conversion_there_and_back_is_the_identity(value: float, pair: tuple[str, str]) -> None:
    there, back = pair
    assert convert(convert(value, there, back), back, there) == pytest.approx(value, rel=1e-15, abs=0.0)


@pytest.mark.parametrize(
    ("standard", "spellings"),
    [
        ("N.m", ["Nm", "N·m", "N m", "N*m", "N . m", "m.N", " N.m "]),
        ("N.m.s/rad", ["Nms/rad", "N·m·s/rad", "N m s / rad", "N.m/(rad/s)"]),
        ("rad/s2", ["rad/s^2", "rad/s**2", "rad/s²", "rad.s-2", "rad·s⁻²"]),
        ("kg.m2", ["kgm2", "kg m²", "kg*m^2"]),
        ("deg", ["°"]),
        ("rev/min", ["r/min"]),
        ("um", ["\u00b5m", "\u03bcm"]),
        ("Ohm", ["\u03a9", "\u2126", "ohm"]),
        ("V.s/rad", ["Vs/rad"]),
        ("1", ["-"]),
        ("1/s", ["s-1", "s^-1"]),
    ],
)
def test_common_spellings_mean_one_unit(standard: str, spellings: list[str]) -> None:
    assert {check(spelling) for spelling in [standard, *spellings]} == {standard}


@pytest.mark.parametrize(
    "unit",
    ["", "xyz", "Ns", "rads", "meter", "nm", "N.m/rad.s", "m/s/s", "N..m", "/s", "s/", "(N", "11", "3.m", "N.m/degC"],
)
def test_unknown_and_ambiguous_units_are_refused(unit: str) -> None:
    with pytest.raises(ValueError, match=exactly(f'unit "{unit}" is not known; write it like N.m, rad/s, deg')):
        check(unit)


@pytest.mark.parametrize(
    ("unit", "to"),
    [("rad", "N.m"), ("1", "rad"), ("deg", "1"), ("Hz", "rad/s"), ("1/min", "rpm"), ("N.m/rad", "N.m"), ("A", "V")],
)
def test_units_of_different_things_are_refused(unit: str, to: str) -> None:
    with pytest.raises(ValueError, match=exactly(f'cannot convert "{unit}" to "{to}"')):
        convert(1.0, unit, to)


def test_a_unit_that_is_not_a_text_is_refused() -> None:
    with pytest.raises(TypeError, match=exactly("a unit is a text like N.m, not 3")):
        check(3)


@untimed
@given(st.text(alphabet="NmradskgVA/.*()^-12 °²·\n'[", max_size=8))
def test_any_text_is_refused_or_has_a_standard_spelling(text: str) -> None:
    try:
        standard = check(text)
    except ValueError:
        return
    assert check(standard) == standard
    assert convert(1.0, text, standard) == 1.0


def test_arrays_keep_their_shape_and_stay_as_they_are() -> None:
    angles = np.array([[0.0, 90.0], [180.0, 360.0]])
    radians = convert(angles, "deg", "rad")
    np.testing.assert_allclose(radians, math.pi * np.array([[0.0, 0.5], [1.0, 2.0]]), rtol=1e-15)
    assert angles[1, 1] == 360.0
