"""Units against their definitions (SI brochure, ISO 80000-3), and the spellings people use."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from contextlib import suppress
from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave import _core
from strainwave.files.units import check, convert, counts, is_share, measures

from tests.support.work import calls

finite = st.floats(-1e200, 1e200, allow_subnormal=False).filter(lambda number: number == 0.0 or abs(number) > 1e-200)


def check_told(error: ValueError) -> None:
    """The message is one short line."""
    assert str(error).isprintable()
    assert len(str(error)) < 200


def test_every_unit_of_a_model_is_in_standard_spelling() -> None:
    models = [model for family in _core.families.values() for model in family.values()]
    spelled = {field["unit"] for model in models for field in model.fields if field.get("unit")}
    assert {check(unit) for unit in spelled} == spelled


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


@pytest.mark.parametrize(
    ("value", "unit", "to", "expected"),
    [
        (1.0, "rpm", "rad/s", math.pi / 30),
        (60.0, "r/min", "rad/s", 2 * math.pi),
        (60.0, "1/min", "rad/s", 2 * math.pi),
        (60.0, "min-1", "rad/s", 2 * math.pi),
        (60.0, "min⁻¹", "rpm", 60.0),
        (2 * math.pi, "rad/s", "1/min", 60.0),
        (1.0, "U/s", "rad/s", 2 * math.pi),
        (3.0, "1/min", "Hz", 0.05),
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
        (1.0, "kWh", "MJ", 3.6),
        (1.0, "Wh", "J", 3600.0),
        (1.0, "Ohm.A", "mV", 1000.0),
        (1.0, "H", "V.s/A", 1.0),
        (20.0, "°C", "K", 293.15),
        (250.0, "ms", "s", 0.25),
        (4096.0, "counts/16384", "deg", 90.0),
        (90.0, "Grad", "inc/4096", 1024.0),
        (2500.0, "inc/10000/s", "rad/s", math.pi / 2),
        (2.0, "counts/10", "counts/100", 20.0),
        (1.0, "tr/min", "rpm", 1.0),
        (1.0, "Upm", "rad/s", math.pi / 30),
        (1.0, "Grad/s", "rad/s", math.pi / 180),
        (60.0, "arc-min", "deg", 1.0),
        (60.0, "arc min", "deg", 1.0),
        (60.0, "arc. min.", "deg", 1.0),
        (60.0, "arcminutes", "degrees", 1.0),
        (60.0, "Winkelminuten", "degree", 1.0),
        (3600.0, "arc-sec", "deg", 1.0),
        (3600.0, "arc seconds", "deg", 1.0),
        (3600.0, "Bogensekunden", "deg", 1.0),
        (1.0, "Nm/arc-min", "N.m/arcmin", 1.0),
        (1.0, "N·m/arc min", "N.m/arcmin", 1.0),
        (1.0, "kgf m/arc-minute", "N.m/arcmin", 9.80665),
        (1.0, "arc-min/(N m)", "arcmin/(N.m)", 1.0),
        (1.0, "arcmin.s", "arc min s", 1.0),
        (1.0, "rad/Nm", "rad/(N.m)", 1.0),
        (1.0, "V/(Vs/rad)", "rad/s", 1.0),
        (3.0, "A/(Nm/(rad/s))", "A.rad/(N.m.s)", 3.0),
    ],
)
def test_conversions_follow_the_definitions(value: float, unit: str, to: str, expected: float) -> None:
    assert convert(value, unit, to) == pytest.approx(expected, rel=1e-15)


@given(finite)
def test_radians_to_degrees_and_back_is_the_identity(angle: float) -> None:
    assert convert(convert(angle, "rad", "deg"), "deg", "rad") == pytest.approx(angle, rel=1e-15, abs=0.0)


@given(finite, st.sampled_from([("rpm", "rad/s"), ("Ncm", "N.m"), ("min", "ms"), ("N.m/deg", "N.m/rad")]))
def test_conversion_there_and_back_is_the_identity(value: float, pair: tuple[str, str]) -> None:
    there, back = pair
    assert convert(convert(value, there, back), back, there) == pytest.approx(value, rel=1e-15, abs=0.0)


@pytest.mark.parametrize(
    ("standard", "spellings"),
    [
        ("N.m", ["Nm", "NM", "N·m", "N m", "N\u00a0m", "N*m", "N-m", "N . m", "m.N", " N.m "]),
        ("N.m.s/rad", ["Nms/rad", "N·m·s/rad", "N m s / rad", "N.m/(rad/s)"]),
        ("rad/s2", ["rad/s^2", "rad/s**2", "rad/s²", "rad.s-2", "rad·s⁻²"]),
        ("kg.m2", ["kgm2", "kg m²", "kg*m^2"]),
        ("deg", ["°"]),
        ("rev/min", ["r/min", "U/min", "U / min", "U·min⁻¹", "rev/min"]),
        ("rpm", ["RPM"]),
        ("1/min", ["min-1", "min^-1", "min⁻¹"]),
        ("ms", ["msec"]),
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
    [
        *("", "xyz", "Ns", "rads", "meter", "nm", "N.m/rad.s", "m/s/s", "N..m", "/s", "s/", "(N", "11", "3.m", "N.m/degC"),
        *("U", "V/U", "k^m", "m^", "kgU/min"),
    ],
)
def test_unknown_and_ambiguous_units_are_refused(unit: str) -> None:
    with pytest.raises(ValueError, match=exactly(f'unit "{unit}" is not known; write it like N.m, rad/s, deg')):
        check(unit)


@pytest.mark.parametrize("unit", ["N\nm", "N\tm", "N.m\n", "\x1b[31mN", "N\u2028m"])
def test_a_unit_is_one_line_without_control_characters(unit: str) -> None:
    with pytest.raises(ValueError, match=r'^unit ".*" is not known; write it like N\.m, rad/s, deg$') as told:
        check(unit)
    assert str(told.value).isprintable()


@pytest.mark.parametrize(
    ("unit", "message"),
    [
        (101 * "m", f'unit "{60 * "m"}…" has 101 characters; at most 100 are allowed'),
        (
            "Ncm.Vs.kgm.uN.mN.kN.um.mm.km.uA.mA.kA.cA.uV.mV.kV.cV.uW.mW.kW.cW.uJ.mJ.kJ.cJ.uK.mK.kK.cK.us.ms.ks.cs",
            'unit "Ncm.Vs.kgm.uN.mN.kN.um.mm.km.uA.mA.kA.cA.uV.mV.kV.cV.uW.mW.k…" has more than 100 characters '
            "in standard spelling",
        ),
        (".".join(20 * ["km9"]), f'unit "{15 * "km9."}…" is too large or too small a number of SI units'),
        (".".join(20 * ["um9"]), f'unit "{15 * "um9."}…" is too large or too small a number of SI units'),
    ],
)
def test_units_beyond_all_bounds_are_refused(unit: str, message: str) -> None:
    with pytest.raises(ValueError, match=exactly(message)):
        check(unit)


@pytest.mark.parametrize("unit", [99 * "a" + "_", 50 * "(" + "m" + 49 * ")", 33 * "m9." + "x", 99 * " " + "m"])
def test_no_text_costs_more_work_than_its_characters(unit: str) -> None:
    def attempt() -> None:
        with suppress(ValueError):
            check(unit)

    assert calls(attempt) < 50 * len(unit)


@pytest.mark.parametrize(
    ("unit", "to"),
    [("rad", "N.m"), ("1", "rad"), ("deg", "1"), ("N.m/rad", "N.m"), ("A", "V"), ("1/min", "rad/s2"), ("1/h", "rad")],
)
def test_units_of_different_things_are_refused(unit: str, to: str) -> None:
    with pytest.raises(ValueError, match=exactly(f'cannot convert "{unit}" to "{to}"')):
        convert(1.0, unit, to)


@pytest.mark.parametrize("unit", ["1/s", "Hz", "1/h", "kHz"])
def test_a_frequency_is_no_angular_speed_for_the_reason_told(unit: str) -> None:
    reason = "it may count revolutions or radians; write rev/s or rad/s"
    with pytest.raises(ValueError, match=exactly(f'cannot convert "{unit}" to "rad/s": {reason}')):
        convert(1.0, unit, "rad/s")


@pytest.mark.parametrize("asked", [check, counts, is_share])
@pytest.mark.parametrize("unit", [3, None, ["N.m"], {"N.m"}, Decimal("NaN")])
def test_a_unit_that_is_not_a_text_is_refused(asked: Callable[[object], object], unit: object) -> None:
    with pytest.raises(TypeError, match=exactly(f"a unit is a text like N.m, not {unit!r}")):
        asked(unit)


@pytest.mark.parametrize(("values", "kind"), [(np.array(["a"]), "<U1"), (len, "object"), (True, "bool"), ("3", "<U1")])
def test_what_is_no_number_is_refused(values: object, kind: str) -> None:
    with pytest.raises(TypeError, match=exactly(f"values must hold numbers, not {kind}")):
        convert(values, "s", "min")  # type: ignore[type-var]


@pytest.mark.parametrize("values", [math.nan, np.array([1.0, math.nan])])
def test_not_a_number_is_refused(values: float) -> None:
    with pytest.raises(ValueError, match=exactly("values must be numbers, and nan is none")):
        convert(values, "s", "min")


def test_a_value_too_large_for_the_other_unit_is_refused() -> None:
    with pytest.raises(ValueError, match=exactly("1e+308 km is too large a number in m")):
        convert(np.array([1.0, 1e308]), "km", "m")
    with pytest.raises(ValueError, match=exactly("-1e+308 km is too large a number in m")):
        convert(-1e308, "km", "m")
    assert convert(math.inf, "km", "m") == math.inf


PIECES = ("N", "m", "rad", "s", "kg", "V", "U", "min", "k", "u", *"/.*()^-129°²· _\n")
unit_texts = st.lists(st.sampled_from(PIECES), max_size=30).map("".join)


@given(st.one_of(unit_texts, st.text(max_size=120)))
def test_any_text_is_refused_or_has_a_standard_spelling(text: str) -> None:
    try:
        standard = check(text)
    except ValueError as error:
        check_told(error)
        return
    assert check(standard) == standard
    assert convert(1.0, text, standard) == 1.0


def test_arrays_keep_their_shape_and_stay_as_they_are() -> None:
    angles = np.array([[0.0, 90.0], [180.0, 360.0]])
    radians = convert(angles, "deg", "rad")
    np.testing.assert_allclose(radians, math.pi * np.array([[0.0, 0.5], [1.0, 2.0]]), rtol=1e-15)
    assert angles[1, 1] == 360.0


def test_counts_need_the_counts_of_a_revolution() -> None:
    with pytest.raises(
        ValueError, match=exactly('unit "counts" needs the counts of one revolution; write it like counts/16384')
    ):
        check("counts")
    with pytest.raises(ValueError, match=exactly('cannot convert "rev" to "N.m"')):
        convert(1.0, "counts/16384", "N.m")


@given(st.integers(1, 10**12 - 1), st.sampled_from(["", "/s"]), finite)
def test_counts_are_parts_of_a_revolution(counts: int, over: str, value: float) -> None:
    unit = f"counts/{counts}{over}"
    assert check(unit) == unit
    assert convert(value, unit, unit) == value
    assert convert(value, unit, f"rev{over}") == pytest.approx(value / counts, rel=1e-14)


@pytest.mark.parametrize(
    ("unit", "message"),
    [
        ("‰", "needs the rated value; write it like permille of 0.4 N.m"),
        ("% of 0 A", "the rated value must be larger than 0"),
        ("% of 12 furlongs", '"furlongs" is not known'),
        ("percent of N.m", "is not known"),
    ],
)
def test_a_share_needs_a_rated_value_in_a_known_unit(unit: str, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        check(unit)


def test_a_share_of_a_rated_value_is_that_value() -> None:
    shares = np.array([-1000.0, 250.0])
    assert convert(shares, "‰ of 0.4 Nm", "N.m") == pytest.approx([-0.4, 0.1])
    assert convert(12.0, "A", "% of 12 A") == pytest.approx(100.0)
    assert not measures("% of 12 A", "N.m")
