"""Texts that may be units."""

from __future__ import annotations

import math
from pathlib import Path

from numpy.random import Generator
from strainwave.files import units

from tests.fuzz.laws import Case, described
from tests.fuzz.mutation import TEXTS, picked

SYMBOLS = (
    "N", "m", "s", "kg", "rad", "deg", "A", "V", "K", "degC", "Hz", "rpm", "rev", "Ohm", "ohm", "H", "J", "W", "Wb", "arcmin",
    "arcsec", "min", "h", "g", "1", "2", "-1", "N.m", "Nm", "kNm", "mm", "um", "kN", "mN", "microN", "r", "°", "Ω", "µm", "2",
    "3", "9", "10", "-", "--", "**", "^", "²", "³", "⁻¹", "·", ".", "*", "/", "(", ")", " ", "$", "%", "e", "E5", "pi",
    "radian", "meters", "furlong", "lambda", "import", "__", "x" * 200, "(" * 200, ")" * 200, "N." * 200, "/s" * 100,
    "m" * 100, "9" * 100, "counts/", "inc/16384", "Grad", "tr",
)  # fmt: skip


def units_case(random: Generator, folder: Path) -> Case:
    length = int(random.integers(1, 10))
    text = "".join(picked(random, TEXTS if random.random() < 0.1 else SYMBOLS) for _ in range(length))
    return Case(described(text), lambda: units.check(text), lambda standard: _check(text, standard))


def _check(text: str, standard: str) -> None:
    assert units.check(standard) == standard, f"the standard spelling {standard!r} has another one"
    one = units.convert(1.0, text, standard)
    assert math.isclose(one, 1.0, rel_tol=1e-12), f"1 {text!r} is {one} {standard}"
    assert len(standard) <= 10 * len(text) + 10, "a unit longer than what it was made from"
