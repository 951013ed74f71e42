"""Figures with units, as people and data sheets write them: "1.2 N·m/arcmin", "3,1 × 10^4 Nm/rad", "2 ms"."""

from __future__ import annotations

import re
from math import isfinite

from strainwave.files.units import base_exponents, check, convert, plain_unit
from strainwave.messages import quoted

MAX_FIGURE_LETTERS = 200  # characters of a figure: its pattern takes quadratic time

_RAISED_DIGITS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻−", "0123456789--")
_WRITTEN_FIGURE = re.compile(
    r"(?P<number>[+-]?(?:[0-9]+(?:[.,][0-9]+)?|\.[0-9]+))(?:[eE](?P<exponent>[+-]?[0-9]{1,6}))?"
    r"(?:\s*[x×·*]?\s*10(?:\^(?P<power>[+-]?[0-9]{1,6})|(?P<raised>⁻?[⁰¹²³⁴-⁹]{1,3})))?"
    r"\s*(?P<unit>.*)"
)


def number_of(name: str, text: str, unit: str) -> float:
    """Return the number of a text with a unit, in `unit`.

    >>> number_of("torque_constant", "75 mN.m/A", "N.m/A")
    0.075

    Raises:
        ValueError: as `read`, or the unit measures something else
    """
    return converted(name, *read(name, text, unit), unit)


def written_figure(name: str, text: str) -> tuple[float, str]:
    """Return the number of a text in SI units, and its unit: of counts rev, of a share that of the rated value.

    >>> number, unit = written_figure("amplitude", "90 deg")
    >>> round(number, 4), unit
    (1.5708, 'deg')

    Raises:
        ValueError: the text is no number with a known unit
    """
    number, written_unit = read(name, text, "deg")
    base = ".".join(f"{symbol}{power}" for symbol, power in base_exponents(written_unit)[1].items())
    return converted(name, number, written_unit, base or "1"), plain_unit(written_unit)


def converted(name: str, number: float, written_unit: str, unit: str) -> float:
    """Return a number in another unit; `ValueError` with the name if that measures something else."""
    try:
        return convert(number, written_unit, unit)
    except ValueError as error:
        raise ValueError(f'{name}: {error}; write a number and its unit, as "1.2 {unit}"') from None


def read(name: str, text: str, unit: str) -> tuple[float, str]:
    """Return the number of a text, with a decimal point or comma and perhaps a power of ten, and its unit as `check` spells it.

    Raises:
        ValueError: the text is not written so, the comma is ambiguous, the unit is not known, or missing where `unit` is not 1
    """
    if len(text) > MAX_FIGURE_LETTERS:
        raise ValueError(f"{name} = {quoted(text)} has {len(text)} characters; a figure has at most {MAX_FIGURE_LETTERS}")
    written = _WRITTEN_FIGURE.fullmatch(text.strip())
    if written is None:
        raise ValueError(f'{name} = {quoted(text)} must be a number and its unit, as "1.2 {unit}"')
    number = written["number"]
    if re.fullmatch(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}", number):
        raise ValueError(f"{name} = {quoted(text)}: the comma may separate thousands or decimals; write a point, or none")
    power = (written["raised"] or written["power"] or "0").translate(_RAISED_DIGITS)
    value = float(f"{number.replace(',', '.')}e{int(power) + int(written['exponent'] or 0)}")
    if not written["unit"] and unit != "1":
        raise ValueError(f'{name} = {quoted(text)} has no unit; write a number and its unit, as "1.2 {unit}"')
    if not isfinite(value):
        raise ValueError(f"{name} = {quoted(text)} must be finite")
    try:
        return value, check(written["unit"] or "1")
    except ValueError as error:
        raise ValueError(f'{name} = {quoted(text)}: {error}; write a number and its unit, as "1.2 {unit}"') from None
