"""Numbers in print: what a reader takes from them is what was put in."""

from __future__ import annotations

import re

import pytest
from hypothesis import given, strategies as st
from strainwave import typeset

NUMBERS = st.floats(-1e12, 1e12).filter(lambda x: x == 0.0 or abs(x) > 1e-12)
SIGMAS = st.floats(-12.0, 12.0).map(lambda power: 10.0**power)
PLAIN = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")


def read(text: str) -> float:
    """A printed number, as a reader takes it."""
    digits, _, power = text.translate(PLAIN).partition(" × 10")
    return float(f"{digits}e{power or 0}")


@given(NUMBERS, st.integers(1, 12))
def test_a_number_reads_back_to_its_digits(value: float, digits: int) -> None:
    assert read(typeset.number(value, digits)) == pytest.approx(value, rel=0.501 * 10.0 ** (1 - digits), abs=0.0)


@given(NUMBERS, SIGMAS)
def test_a_value_and_its_uncertainty_read_back_to_two_digits_of_the_uncertainty(value: float, sigma: float) -> None:
    text = typeset.uncertain(value, sigma)
    shared = re.fullmatch(r"\((.*) ± (.*)\)( × 10.*)", text)
    first, second = (shared[1] + shared[3], shared[2] + shared[3]) if shared else text.split(" ± ")
    assert read(second) == pytest.approx(sigma, rel=0.0501)
    assert read(first) == pytest.approx(value, rel=5e-6, abs=0.0501 * sigma)


@given(NUMBERS, SIGMAS)
def test_both_end_at_the_same_digit(value: float, sigma: float) -> None:
    text = typeset.uncertain(value, sigma)
    first, second = (part.strip("()") for part in re.sub(r"\) × .*", "", text).split(" ± "))
    if sigma > abs(value) * 1e-8 and "." in second:
        assert len(first.partition(".")[2]) == len(second.partition(".")[2])


@given(st.floats(1e-9, 1e9), st.sampled_from(["N.m", "rad", "s", "A", "N.m/rad"]))
def test_a_prefix_does_not_change_a_quantity(value: float, of: str) -> None:
    number, _, unit = typeset.quantity(value, of).rpartition(" ")
    prefix = unit.removesuffix(typeset.unit(of))
    scale = {"n": 1e-9, "µ": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6}[prefix]
    assert read(number) * scale == pytest.approx(value, rel=5.01e-3)


@pytest.mark.parametrize(
    ("value", "text"),
    [(float("nan"), "—"), (float("inf"), "∞"), (float("-inf"), "−∞"), (-0.0, "0"), (999999.6, "1 × 10⁶")],
)
def test_numbers_at_the_edge(value: float, text: str) -> None:
    assert typeset.number(value) == text


@given(st.text())
def test_symbols_never_let_markup_through(text: str) -> None:
    assert re.sub(r"</?(?:var|sub)>", "", str(typeset.symbols(text))).count("<") == 0
