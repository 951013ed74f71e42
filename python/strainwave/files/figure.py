"""A figure as people and data sheets write it: a number in SI units, a text such as "1.2 N·m/arcmin", or a quantity."""

from __future__ import annotations

import re
from math import isfinite

from strainwave import arguments
from strainwave.files.entries import Quantity
from strainwave.files.units import base_exponents, check
from strainwave.messages import quoted

Figure = float | str | Quantity
MAX_TEXT = 200  # characters of a figure: its pattern takes quadratic time

_RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻−", "0123456789--")
_WRITTEN = re.compile(
    r"(?P<number>[+-]?[0-9]+(?:[.,][0-9]+)?)(?:[eE](?P<exponent>[+-]?[0-9]{1,6}))?"
    r"(?:\s*[x×·*]?\s*10(?:\^(?P<power>[+-]?[0-9]{1,6})|(?P<raised>⁻?[⁰¹²³⁴-⁹]{1,3})))?"
    r"\s*(?P<unit>.*)"
)


def quantity_of(name: str, given: Figure, unit: str, source: str) -> Quantity:
    """A figure as a quantity in the unit it is written in.

    Args:
        name: what the figure is called
        given: a number in `unit`; a text: the number, with a decimal point or comma and perhaps a power of ten, then the unit,
            where "≤" may stand before it; or a quantity, which has a source of its own
        unit: what it must measure
        source: where it comes from

    Raises:
        TypeError: it is none of these
        ValueError: the text is not written so, the comma is ambiguous, or the unit measures something else

    >>> round(quantity_of("k1", "1.2 N·m/arcmin", "N.m/rad", "data sheet").to("N.m/rad").value, 3)
    4125.296
    >>> quantity_of("k1", "3,1 × 10^4 Nm/rad", "N.m/rad", "data sheet").value
    31000.0
    """
    if isinstance(given, Quantity):
        found = given
    elif isinstance(given, str):
        found = _read(name, given.strip().removeprefix("<").removeprefix("≤"), unit, source)
    else:
        found = Quantity(value=arguments.number(name, given, unit), unit=unit, source=source)
    _in_unit(name, found, unit)
    return found


def number_of(name: str, text: str, unit: str) -> float:
    """Return the number of a text with a unit, in `unit`; in SI units if that is empty, as it is for a command.

    >>> number_of("torque_constant", "75 mN.m/A", "N.m/A"), round(number_of("amplitude", "90 deg", ""), 4)
    (0.075, 1.5708)

    Raises:
        ValueError: as `quantity_of`
    """
    written = _read(name, text, unit or "deg", "argument")
    base = ".".join(f"{symbol}{power}" for symbol, power in base_exponents(written.unit)[1].items())
    return _in_unit(name, written, unit or base or "1").value


def _in_unit(name: str, quantity: Quantity, unit: str) -> Quantity:
    try:
        return quantity.to(unit)
    except ValueError as error:
        raise ValueError(f'{name}: {error}; write it as "1.2 {unit}"') from None


def _read(name: str, text: str, unit: str, source: str) -> Quantity:
    if len(text) > MAX_TEXT:
        raise ValueError(f"{name} = {quoted(text)} has {len(text)} characters; a figure has at most {MAX_TEXT}")
    written = _WRITTEN.fullmatch(text.strip())
    if written is None:
        raise ValueError(f'{name} = {quoted(text)} must be a number and its unit, as "1.2 {unit}"')
    number = written["number"]
    if re.fullmatch(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}", number):
        raise ValueError(f"{name} = {quoted(text)}: the comma may separate thousands or decimals; write a point, or none")
    power = (written["raised"] or written["power"] or "0").translate(_RAISED)
    value = float(f"{number.replace(',', '.')}e{int(power) + int(written['exponent'] or 0)}")
    if not written["unit"] and unit != "1":
        raise ValueError(f'{name} = {quoted(text)} has no unit; write it as "{number} {unit}"')
    if not isfinite(value):
        raise ValueError(f"{name} = {quoted(text)} must be finite")
    try:
        standard = check(written["unit"] or "1")
    except ValueError as error:
        raise ValueError(f'{name} = {quoted(text)}: {error}; write it as "{number} {unit}"') from None
    return Quantity(value=value, unit=standard, source=source)
