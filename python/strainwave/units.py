"""Units of measurement at the boundary: the only place where pint is used.

Inside the package everything is SI; files, plots and people may use other units. Units are spelled as in Modelica and
FMI: `N.m`, `rad/s`, `N.m.s/rad`, `kg.m2`, `1`. An angle is a dimension of its own here, so that a rotation is never
taken for a plain number, nor a frequency [Hz] for an angular speed [rad/s].
"""

from __future__ import annotations

import math
import re
import tokenize
from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pint

Values = TypeVar("Values", float, NDArray[np.float64])

# A closed list: among pint's own thousand units nearly every short word means something ("[t]" would be tonnes).
_DEFINITIONS = (
    "micro- = 1e-6 = u-",
    "milli- = 1e-3 = m-",
    "centi- = 1e-2 = c-",
    "kilo- = 1e3 = k-",
    "second = [time] = s",
    "meter = [length] = m",
    "kilogram = [mass] = kg",
    "ampere = [current] = A",
    "kelvin = [temperature] = K",
    "radian = [angle] = rad",
    "minute = 60 second = min",
    "hour = 3600 second = h",
    "hertz = 1 / second = Hz",
    f"degree = {math.pi / 180!r} radian = deg",
    f"arcminute = {math.pi / 10_800!r} radian = arcmin",
    f"arcsecond = {math.pi / 648_000!r} radian = arcsec",
    f"revolution = {math.tau!r} radian = rev",
    "revolution_per_minute = revolution / minute = rpm",
    "gram = 1e-3 kilogram = g",
    "newton = kilogram * meter / second ** 2 = N",
    "joule = newton * meter = J",
    "watt = joule / second = W",
    "volt = watt / ampere = V",
    "ohm = volt / ampere = Ohm",
    "henry = volt * second / ampere = H",
    "weber = volt * second = Wb",
    "degree_Celsius = kelvin; offset: 273.15 = degC",
)

_CHARACTERS = str.maketrans(
    {"°": "deg", "\u2032": "arcmin", "\u2033": "arcsec", "Ω": "Ohm", "\u2126": "Ohm", "µ": "u", "\u03bc": "u"}
    | {"·": ".", "⋅": ".", "*": ".", "^": "", "\u2212": "-", "⁻": "-", "¹": "1", "²": "2", "³": "3"}
)

# Products people write in one word, and other names of a symbol.
_WORDS = {
    "Nm": "N*m", "Ncm": "N*cm", "Nmm": "N*mm", "mNm": "mN*m", "kNm": "kN*m", "Nms": "N*m*s", "kgm": "kg*m",
    "kgcm": "kg*cm", "gcm": "g*cm", "Vs": "V*s", "As": "A*s", "r": "rev", "ohm": "Ohm",
}  # fmt: skip


def convert(values: Values, unit: str, to: str) -> Values:
    """Express values given in one unit in another.

    Args:
        values: a number or an array, of any shape, in `unit`
        unit: the unit the values are in
        to: the unit wanted

    Returns:
        The values in `to`; where both units are the same, `values` itself.

    Raises:
        ValueError: a unit is not known, or the two measure different things. Angles are not plain numbers.

    >>> convert(30.0, "rpm", "rad/s")
    3.141592653589793
    >>> convert(1.0, "1", "rad")
    Traceback (most recent call last):
    ValueError: cannot convert "1" to "rad"
    """
    import pint

    source, target = _parse(unit), _parse(to)
    if source == target:
        return values
    try:
        converted: Values = _registry().convert(values, source, target)
    except pint.DimensionalityError:
        raise ValueError(f'cannot convert "{unit}" to "{to}"') from None
    return converted


@cache
def check(unit: str) -> str:
    """Standard spelling of a unit, which must be known.

    Args:
        unit: a unit in Modelica's spelling or a common other one: N·m, N m, Nm, r/min, °, rad/s^2

    Returns:
        The same unit as Modelica and FMI write it.

    Raises:
        ValueError: the unit is not known, or ambiguous like `N.m/rad.s` (write `N.m/(rad.s)`).

    >>> check("Nm s/rad"), check("kg m^2"), check("°"), check("N.m/(rad/s)")
    ('N.m.s/rad', 'kg.m2', 'deg', 'N.m.s/rad')
    """
    from pint.util import to_units_container

    powers = cast("dict[str, int]", to_units_container(_parse(unit)))
    factors = sorted(powers.items(), key=lambda factor: _without_prefix(factor[0]))
    above = [_factor(name, power) for name, power in factors if power > 0]
    below = [_factor(name, -power) for name, power in factors if power < 0]
    denominator = below[0] if len(below) == 1 else f"({'.'.join(below)})"
    return (".".join(above) or "1") + (f"/{denominator}" if below else "")


def _without_prefix(name: str) -> str:
    (_, stem, _), *_ = _registry().parse_unit_name(name)
    return _registry().get_symbol(stem)


def _factor(name: str, power: int) -> str:
    return _registry().get_symbol(name) + ("" if power == 1 else str(power))


@cache
def _registry() -> pint.UnitRegistry[Any]:
    import pint

    return pint.UnitRegistry(_DEFINITIONS)


@cache
def _parse(unit: str) -> pint.Unit:
    import pint

    if not isinstance(unit, str):
        raise TypeError(f"a unit is a text like N.m, not {unit!r}")
    registry = _registry()
    try:
        parsed = registry.parse_units(_expression(unit), as_delta=False)
        registry.convert(1.0, parsed, registry.get_base_units(parsed)[1])  # refuses degC in a product
    except (pint.PintError, tokenize.TokenError, ValueError, TypeError, AssertionError):
        raise ValueError(f'unit "{unit}" is not known; write it like N.m, rad/s, deg') from None
    return parsed


def _expression(unit: str) -> str:
    """The unit as pint reads it: `N·m s/rad^2` becomes `N*m*s/rad**2`."""
    text = "1" if unit == "-" else unit.strip().replace("**", "^").translate(_CHARACTERS)
    text = re.sub(r"\s*([./()])\s*", r"\1", text)
    text = re.sub(r"\s+|\.", "*", text)
    _check_grammar(text)
    return re.sub(r"([A-Za-z]+)(-?[1-9])?", _power, text)


def _check_grammar(text: str) -> None:
    if not re.fullmatch(r"(?:[A-Za-z]+(?:-?[1-9])?|\b1\b|[*/()])+", text):
        raise ValueError("not a product of powers")
    groups = re.findall(r"\(([^()]*)\)", text)
    if any(re.search(r"/.*[*/]", part) for part in (*groups, re.sub(r"\([^()]*\)", "", text))):
        raise ValueError("ambiguous: a/b*c")


def _power(match: re.Match[str]) -> str:
    *leading, last = [_symbol(word) for word in _WORDS.get(match[1], match[1]).split("*")]
    return "*".join([*leading, f"{last}**({match[2] or 1})"])


def _symbol(word: str) -> str:
    """A symbol spelled exactly; pint itself would take "Ns" for a plural of newton."""
    if _registry().get_symbol(word) != word:
        raise ValueError(f"{word} is not a symbol")
    return word
