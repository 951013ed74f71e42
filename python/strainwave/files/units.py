"""Units of measurement at the boundary.

Inside the package everything is SI; files, plots and people may use other units. Units are spelled as in Modelica and
FMI: `N.m`, `rad/s`, `N.m.s/rad`, `kg.m2`, `1`. An angle is a dimension of its own here, so that a rotation is never
taken for a plain number, nor a frequency [Hz] for an angular speed [rad/s]. Sizes are fractions: a conversion rounds once.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from strainwave import arrays
from strainwave.messages import quoted, shortened

Values = TypeVar("Values", float, NDArray[np.float64])
Powers = dict[str, int]  # of symbols, none of them zero

_UNIT_PREFIXES = {"u": Fraction("1e-6"), "m": Fraction("1e-3"), "c": Fraction("1e-2"), "k": Fraction(1000)}
_BASE_UNITS = ("s", "m", "kg", "A", "K", "rad", "px")  # px: pixels of an image
_PI = Fraction(math.pi)

# Size of each further unit in others. The list is closed: else nearly every short word means something ("[t]" tonnes).
_DERIVED_UNITS: dict[str, tuple[Fraction | int, Powers]] = {
    "min": (60, {"s": 1}),
    "h": (3600, {"s": 1}),
    "ns": (Fraction("1e-9"), {"s": 1}),  # of time stamps; no other unit has this prefix, as nm is meant for N.m
    "Hz": (1, {"s": -1}),
    "deg": (_PI / 180, {"rad": 1}),
    "arcmin": (_PI / 10_800, {"rad": 1}),
    "arcsec": (_PI / 648_000, {"rad": 1}),
    "rev": (2 * _PI, {"rad": 1}),
    "rpm": (1, {"rev": 1, "min": -1}),
    "g": (Fraction("1e-3"), {"kg": 1}),
    "N": (1, {"kg": 1, "m": 1, "s": -2}),
    "kgf": (Fraction("9.80665"), {"N": 1}),
    "gn": (Fraction("9.80665"), {"m": 1, "s": -2}),  # standard gravity, in which accelerometers count
    "J": (1, {"N": 1, "m": 1}),
    "MJ": (10**6, {"J": 1}),  # no other unit has the prefix M
    "Wh": (3600, {"J": 1}),
    "W": (1, {"J": 1, "s": -1}),
    "V": (1, {"W": 1, "A": -1}),
    "Ohm": (1, {"V": 1, "A": -1}),
    "H": (1, {"V": 1, "s": 1, "A": -1}),
    "Wb": (1, {"V": 1, "s": 1}),
    "degC": (1, {"K": 1}),
}
_ZERO_OF_CELSIUS = Fraction("273.15")  # K

_MAX_UNIT_CHARACTERS = 100  # a bound for the work that a text from outside can cause

_OTHER_CHARACTERS = str.maketrans(
    {"°": "deg", "\u2032": "arcmin", "\u2033": "arcsec", "Ω": "Ohm", "\u2126": "Ohm", "µ": "u", "\u03bc": "u"}
    | {"·": ".", "⋅": ".", "*": ".", "\u2212": "-", "⁻": "-", "¹": "1", "²": "2", "³": "3"}
    | dict.fromkeys("\u00a0\u2009\u202f", " ")
)

# Products people write in one word, and other names of a symbol.
_OTHER_SPELLINGS = {
    "Nm": "N*m", "NM": "N*m", "Ncm": "N*cm", "Nmm": "N*mm", "mNm": "mN*m", "kNm": "kN*m", "Nms": "N*m*s", "kgm": "kg*m",
    "kgcm": "kg*cm", "gcm": "g*cm", "Vs": "V*s", "As": "A*s", "r": "rev", "RPM": "rpm", "ohm": "Ohm", "sec": "s", "msec": "ms",
    "cNm": "cN*m", "kgfm": "kgf*m", "kgfcm": "kgf*cm", "Grad": "deg", "tr": "rev", "Umdr": "rev", "Upm": "rpm", "UPM": "rpm",
    "degree": "deg", "degrees": "deg", "turn": "rev", "turns": "rev", "revs": "rev", "rot": "rev",
}  # fmt: skip
# As catalogues write minutes and seconds of arc: arc-min, arc min, arc. min., arcminutes, Winkelminuten.
_OF_ARC = re.compile(
    r"\b(?:arc[-. ]{0,2}|Winkel|Bogen)(min|sec|[Ss]ek)(?:ut|und|ond)?(?:en|es|e|s)?(?![a-z])(?:\.(?![a-z(]))?",
    re.ASCII | re.IGNORECASE,
)
_PER_SECOND = {"degps": "deg/s", "dps": "deg/s", "radps": "rad/s", "rps": "rev/s"}  # as data sheets write them

# Counts of an encoder with the counts of one revolution: counts/16384, inc/4096/s.
_COUNTED_UNIT = re.compile(
    r"(?:counts?|cnts?|cts|inc|ink|increments?|inkremente?|ticks?|pulses?)/([1-9]\d{0,11})(/s)?", re.ASCII | re.IGNORECASE
)

# A share of a rated value, as drives report torque and current: permille of 0.4 N.m, % of 12 A.
_SHARE_SIZES = {"%": 1e-2, "percent": 1e-2, "\u2030": 1e-3, "permille": 1e-3, "promille": 1e-3, "permil": 1e-3}
_SHARE_UNIT = re.compile(rf"({'|'.join(_SHARE_SIZES)}) of (\d{{1,9}}(?:\.\d{{1,9}})?) ?(\S.{{0,40}})")

# German data sheets count revolutions as U, but only per time; alone, U is a voltage there.
_GERMAN_REVOLUTIONS = re.compile(r"^U(?=/(?:min|s)$|\*(?:min|s)-1$)")


def convert(values: Values, unit: str, to: str) -> Values:
    """Express values given in one unit in another.

    Data sheets write revolutions per minute as `1/min`. So where the other unit is an angular speed, `1/min` means
    `rev/min`. `1/s` and `Hz` are refused there: both revolutions and radians per second are written so.

    Args:
        values: a number or an array, of any shape, in `unit`
        unit: the unit the values are in
        to: the unit wanted

    Returns:
        The values in `to`; where both units are the same, `values` itself.

    Raises:
        ValueError: a unit is not known, the two measure different things, or a value is not a number or too large a one
            in `to`. Angles are not plain numbers.
        TypeError: the values are not numbers

    >>> convert(30.0, "rpm", "rad/s")
    3.141592653589793
    >>> convert(30.0, "1/min", "rad/s")
    3.141592653589793
    >>> convert(1.0, "1", "rad")
    Traceback (most recent call last):
    ValueError: cannot convert "1" to "rad"
    """
    if np.isnan(arrays.numbers("values", values)).any():
        raise ValueError("values must be numbers, and nan is none")
    if any(isinstance(each, str) and (_COUNTED_UNIT.fullmatch(each) or _SHARE_UNIT.fullmatch(each)) for each in (unit, to)):
        return _convert_scaled(values, unit, to)
    source, target = _parse(unit), _parse(to)
    if source == target:
        return values
    source, target = _turning(source, target), _turning(target, source)
    if source.dimension != target.dimension:
        raise ValueError(f"cannot convert {quoted(unit)} to {quoted(to)}{_reason(source, target)}")
    try:
        factor = float(source.size / target.size)
    except OverflowError:
        raise ValueError(f"the ratio of {quoted(unit)} to {quoted(to)} is too large a number") from None
    with np.errstate(over="ignore"):
        converted: Values = values * factor
        if source.zero != target.zero:
            converted = converted + float((source.zero - target.zero) / target.size)
    _check_finite(values, converted, unit, to)
    return converted


def _convert_scaled(values: Values, unit: str, to: str) -> Values:
    """Express counts of an encoder as revolutions or shares of a rated value as that value, or the other way round."""
    (size, plain), (size_to, plain_to) = _size(unit), _size(to)
    if (size, plain) == (size_to, plain_to):
        return values
    with np.errstate(over="ignore"):
        scaled: Values = convert(values, plain, plain_to) * (size / size_to)
    _check_finite(values, scaled, unit, to)
    return scaled


def _size(unit: str) -> tuple[float, str]:
    """Return the size of a unit in a plain one: of a count in revolutions, of a share of a rated value in its unit."""
    if counted := _COUNTED_UNIT.fullmatch(unit):
        return 1.0 / int(counted[1]), f"rev{counted[2] or ''}"
    if share := _SHARE_UNIT.fullmatch(unit):
        return _SHARE_SIZES[share[1]] * float(share[2]), share[3]
    return 1.0, unit


def is_share(unit: str) -> bool:
    """True if a unit is a share whose rated value is not given.

    >>> is_share("%"), is_share("‰"), is_share("% of 12 A")
    (True, True, False)
    """
    return _text(unit).strip().casefold() in _SHARE_SIZES


def _turning(unit: _Unit, other: _Unit) -> _Unit:
    """The unit itself, but revolutions per minute where 1/min stands for an angular speed."""
    is_speed = unit.powers == {"min": -1} and other.dimension == {"rad": 1, "s": -1}
    return _parse("rev/min") if is_speed else unit


def _reason(source: _Unit, target: _Unit) -> str:
    """Return the reason why a frequency is no angular speed; empty for other units."""
    if (source.dimension, target.dimension) == ({"s": -1}, {"rad": 1, "s": -1}):
        return ": it may count revolutions or radians; write rev/s or rad/s"
    return ""


def _check_finite(values: Values, converted: Values, unit: str, to: str) -> None:
    lost = np.isfinite(values) & ~np.isfinite(converted)
    if np.any(lost):
        worst = np.asarray(values)[lost].flat[0]
        raise ValueError(f"{worst} {unit} is too large a number in {to}")


@lru_cache(maxsize=1024)
def measures(unit: str, wanted: str) -> bool:
    """True if a unit is known and measures what another one does.

    >>> measures("1/min", "rad/s"), measures("N.m", "rad/s"), measures("furlong", "m")
    (True, False, False)
    """
    try:
        convert(1.0, unit, wanted)
    except ValueError:
        return False
    return True


def base_exponents(unit: str) -> tuple[float, dict[str, int]]:
    """Return the size of a unit in SI base units, and their exponents; an angle counts as a base unit.

    >>> base_exponents("N.m/rad")
    (1.0, {'kg': 1, 'm': 2, 'rad': -1, 's': -2})

    Raises:
        ValueError: the unit is not known
    """
    size, plain = _size(unit)
    parsed = _parse(plain)
    return size * float(parsed.size), dict(sorted(parsed.dimension.items()))


def plain_unit(unit: str) -> str:
    """Return the unit that counts or shares of a rated value are converted to, and any other unit itself.

    >>> plain_unit("counts/4096/s"), plain_unit("% of 12 A"), plain_unit("deg")
    ('rev/s', 'A', 'deg')
    """
    return _size(unit)[1]


def counts(unit: str) -> bool:
    """True if a unit is that of an encoder's counts, without or with the counts of a revolution.

    Raises:
        TypeError: the unit is no text

    >>> counts("inc"), counts("counts/16384"), counts("rad")
    (True, True, False)
    """
    unit = _text(unit)
    return any(_COUNTED_UNIT.fullmatch(each) for each in (unit, f"{unit}/1", unit.replace("/", "/1/", 1)))


def check(unit: str) -> str:
    """Standard spelling of a unit, which must be known.

    Args:
        unit: a unit in Modelica's spelling or a common other one: N·m, N m, Nm, r/min, °, rad/s^2

    Returns:
        The same unit as Modelica and FMI write it.

    Raises:
        ValueError: the unit is not known, or ambiguous like `N.m/rad.s` (write `N.m/(rad.s)`).

    An encoder's counts are a unit with the counts of one revolution behind them: `counts/16384`, `inc/4096`. A share of a
    rated value is one with this value: `permille of 0.4 N.m`, `% of 12 A`.

    >>> check("Nm s/rad"), check("kg m^2"), check("°"), check("N.m/(rad/s)"), check("inc/4096"), check("‰ of 0.4 Nm")
    ('N.m.s/rad', 'kg.m2', 'deg', 'N.m.s/rad', 'counts/4096', 'permille of 0.4 N.m')
    """
    if isinstance(unit, str) and (counted := _COUNTED_UNIT.fullmatch(unit)):
        return f"counts/{counted[1]}{counted[2] or ''}"
    if isinstance(unit, str) and (share := _SHARE_UNIT.fullmatch(unit)):
        if not float(share[2]) > 0.0:
            raise ValueError(f"unit {quoted(unit)}: the rated value must be larger than 0")
        return f"{'%' if _SHARE_SIZES[share[1]] == 1e-2 else 'permille'} of {share[2]} {check(share[3])}"
    standard = _spelling(_parse(unit).powers)
    if len(standard) > _MAX_UNIT_CHARACTERS:
        raise ValueError(f"unit {quoted(unit)} has more than {_MAX_UNIT_CHARACTERS} characters in standard spelling")
    return standard


def ratio_of_units(unit: str, by: str) -> str:
    """Return the unit of a quantity over another one.

    >>> ratio_of_units("rad", "N.m"), ratio_of_units("rad", "rad"), ratio_of_units("A", "1")
    ('rad/(N.m)', '1', 'A')
    """
    return check(f"({unit})/({by})")


def _spelling(powers: Powers) -> str:
    factors = sorted(powers.items(), key=lambda factor: (_split(factor[0])[1], factor[0]))
    above = [_factor(symbol, power) for symbol, power in factors if power > 0]
    below = [_factor(symbol, -power) for symbol, power in factors if power < 0]
    denominator = below[0] if len(below) == 1 else f"({'.'.join(below)})"
    return (".".join(above) or "1") + (f"/{denominator}" if below else "")


def _factor(symbol: str, power: int) -> str:
    return symbol + ("" if power == 1 else str(power))


def _text(unit: str) -> str:
    if not isinstance(unit, str):
        raise TypeError(f"a unit is a text like N.m, not {shortened(unit)}")
    return unit


@dataclass(frozen=True)
class _Unit:
    """A product of powers of symbols, as it is written.

    Attributes:
        powers: of its symbols, with their prefixes
        size: in SI base units
        dimension: powers of SI base units
        zero: value of its zero in SI base units
    """

    powers: Powers
    size: Fraction
    dimension: Powers
    zero: Fraction = Fraction(0)


def _parse(unit: str) -> _Unit:
    if len(_text(unit)) > _MAX_UNIT_CHARACTERS:
        raise ValueError(f"unit {quoted(unit)} has {len(unit)} characters; at most {_MAX_UNIT_CHARACTERS} are allowed")
    return _parsed(unit)


@lru_cache(maxsize=1024)
def _parsed(unit: str) -> _Unit:
    try:
        parsed = _measured(_powers(unit))
    except ValueError:
        if _COUNTED_UNIT.fullmatch(f"{unit.strip()}/1"):
            raise ValueError(f"unit {quoted(unit)} needs the counts of one revolution; write it like counts/16384") from None
        if is_share(unit):
            raise ValueError(f"unit {quoted(unit)} needs the rated value; write it like permille of 0.4 N.m") from None
        raise ValueError(f"unit {quoted(unit)} is not known; write it like N.m, rad/s, deg") from None
    try:
        scale = float(parsed.size)
    except OverflowError:
        scale = math.inf
    if not 0.0 < scale < math.inf:
        raise ValueError(f"unit {quoted(unit)} is too large or too small a number of SI units")
    return parsed


def _measured(powers: Powers) -> _Unit:
    """Return a unit with its size and its dimension."""
    if powers == {"degC": 1}:
        return _Unit(powers, Fraction(1), {"K": 1}, _ZERO_OF_CELSIUS)
    if any(symbol.endswith("degC") for symbol in powers):
        raise ValueError("the zero of a product is not determined")
    size, dimension = Fraction(1), Powers()
    for symbol, power in powers.items():
        prefix, stem = _split(symbol)
        own_size, own_dimension = _of_symbol(stem)
        size *= (own_size * _UNIT_PREFIXES.get(prefix, 1)) ** power
        dimension = _times(dimension, own_dimension, power)
    return _Unit(powers, size, dimension)


@cache
def _of_symbol(symbol: str) -> tuple[Fraction, Powers]:
    """Return the size of a symbol without a prefix, and its dimension."""
    if symbol in _BASE_UNITS:
        return Fraction(1), {symbol: 1}
    times, powers = _DERIVED_UNITS[symbol]
    defined = _measured(powers)
    return times * defined.size, defined.dimension


def _split(symbol: str) -> tuple[str, str]:
    """Return the prefix of a symbol, which may be empty, and the rest."""
    for prefix, stem in (("", symbol), (symbol[:1], symbol[1:])):
        if (stem in _BASE_UNITS or stem in _DERIVED_UNITS) and (not prefix or prefix in _UNIT_PREFIXES):
            return prefix, stem
    raise ValueError(f"{symbol} is not a symbol")


def _times(powers: Powers, others: Powers, exponent: int) -> Powers:
    """Return the product of powers with others to an exponent."""
    product = {symbol: powers.get(symbol, 0) + exponent * others.get(symbol, 0) for symbol in powers | others}
    return {symbol: power for symbol, power in product.items() if power}


def _powers(unit: str) -> Powers:
    """Return the powers of the symbols of a unit: of `N·m s/rad^2`, N 1, m 1, s 1, rad -2."""
    text = unit.replace("**", "^").translate(_OTHER_CHARACTERS)
    if not text.isprintable():
        raise ValueError("not one line of text")
    text = _OF_ARC.sub(lambda found: "arcmin" if found[1].lower() == "min" else "arcsec", text)
    text = re.sub(r" *([./()]) *", r"\1", text.strip())
    text = "1" if text == "-" else re.sub(r" +|\.|(?<=[A-Za-z])-(?=[A-Za-z])", "*", text)
    text = _GERMAN_REVOLUTIONS.sub("rev", re.sub(r"\^(?=-?\d)", "", _PER_SECOND.get(text, text)))
    if not re.fullmatch(r"(?:[A-Za-z]++(?:-?[1-9])?+|\b1\b|[*/()])++", text):  # possessive, so that it takes linear time
        raise ValueError("not a product of powers")
    tokens = re.findall(r"[A-Za-z]+(?:-?[1-9])?|[1*/()]", text)[::-1]
    powers = _ratio(tokens)
    if tokens:
        raise ValueError("ambiguous: a/b*c")
    return powers


def _ratio(tokens: list[str]) -> Powers:
    """Take a product from the end of tokens, and what it may be divided by; return the powers of its symbols."""
    powers = _taken(tokens)
    while tokens and tokens[-1] == "*":
        tokens.pop()
        powers = _times(powers, _taken(tokens), 1)
    if tokens and tokens[-1] == "/":
        tokens.pop()
        powers = _times(powers, _taken(tokens), -1)
    return powers


def _taken(tokens: list[str]) -> Powers:
    """Take a symbol, a 1 or what stands between brackets from the end of tokens; return the powers of its symbols."""
    token = tokens.pop() if tokens else ""
    if token == "(":
        inside = _ratio(tokens)
        if not tokens or tokens.pop() != ")":
            raise ValueError("a bracket is not closed")
        return inside
    if token == "1":
        return {}
    if not token or token in "*/)":
        raise ValueError("a symbol is missing")
    word = token.rstrip("-123456789")
    *leading, last = _OTHER_SPELLINGS.get(word, word).split("*")
    powers = {last: int(token[len(word) :] or 1)}
    for symbol in leading:
        powers = _times(powers, {symbol: 1}, 1)
    for symbol in powers:
        _split(symbol)
    return powers
