"""Units of measurement at the boundary: the only place where pint is used.

Inside the package everything is SI; files, plots and people may use other units. Units are spelled as in Modelica and
FMI: `N.m`, `rad/s`, `N.m.s/rad`, `kg.m2`, `1`. An angle is a dimension of its own here, so that a rotation is never
taken for a plain number, nor a frequency [Hz] for an angular speed [rad/s].
"""

from __future__ import annotations

import math
import re
import tokenize
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.messages import quoted, shortened

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
    "nanosecond = 1e-9 second = ns",  # of time stamps; no other unit has this prefix, as nm is meant for N.m
    "hertz = 1 / second = Hz",
    f"degree = {math.pi / 180!r} radian = deg",
    f"arcminute = {math.pi / 10_800!r} radian = arcmin",
    f"arcsecond = {math.pi / 648_000!r} radian = arcsec",
    f"revolution = {math.tau!r} radian = rev",
    "revolution_per_minute = revolution / minute = rpm",
    "gram = 1e-3 kilogram = g",
    "newton = kilogram * meter / second ** 2 = N",
    "kilogram_force = 9.80665 newton = kgf",
    "joule = newton * meter = J",
    "watt = joule / second = W",
    "volt = watt / ampere = V",
    "ohm = volt / ampere = Ohm",
    "henry = volt * second / ampere = H",
    "weber = volt * second = Wb",
    "degree_Celsius = kelvin; offset: 273.15 = degC",
    "pixel = [pixel] = px",  # of an image
)

# Standard spellings that most recordings and models have. pint, whose import takes half a second, is not needed for them.
STANDARD = frozenset(
    {"1", "1/(N.m)", "1/(N.m.rad)", "1/K", "1/m", "1/rad", "1/s", "A", "A.s/rad", "A/rad", "H", "Hz", "J", "J/K", "K", "K/W"}
    | {"N.m", "N.m.s/rad", "N.m/A", "N.m/rad", "N.m/rad2", "N.m/rad3", "N.m/s", "N.s/m", "N/m", "Ohm", "V", "V.s/rad"}
    | {"V/(A.s)", "V/(N.m)", "V/(rad.s)", "V/A", "V/rad", "W", "W/K", "kg", "kg.m2", "kg/m3", "m", "m/s", "m/s2", "m2", "rad"}
    | {"rad/s", "rad/s2", "s", "s/rad"}
)

_MAX_UNIT_CHARACTERS = 100  # a bound for the work that a text from outside can cause

_CHARACTERS = str.maketrans(
    {"°": "deg", "\u2032": "arcmin", "\u2033": "arcsec", "Ω": "Ohm", "\u2126": "Ohm", "µ": "u", "\u03bc": "u"}
    | {"·": ".", "⋅": ".", "*": ".", "\u2212": "-", "⁻": "-", "¹": "1", "²": "2", "³": "3"}
    | dict.fromkeys("\u00a0\u2009\u202f", " ")
)

# Products people write in one word, and other names of a symbol.
_WORDS = {
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
_COUNTED = re.compile(
    r"(?:counts?|cnts?|cts|inc|ink|increments?|inkremente?|ticks?|pulses?)/([1-9]\d{0,11})(/s)?", re.ASCII | re.IGNORECASE
)

# A share of a rated value, as drives report torque and current: permille of 0.4 N.m, % of 12 A.
_SHARES = {"%": 1e-2, "percent": 1e-2, "\u2030": 1e-3, "permille": 1e-3, "promille": 1e-3, "permil": 1e-3}
_SHARE = re.compile(rf"({'|'.join(_SHARES)}) of (\d{{1,9}}(?:\.\d{{1,9}})?) ?(\S.{{0,40}})")

# German data sheets count revolutions as U, but only per time; alone, U is a voltage there.
_REVOLUTIONS = re.compile(r"^U(?=/(?:min|s)$|\*(?:min|s)-1$)")


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
    if np.isnan(arguments.numbers("values", values)).any():
        raise ValueError("values must be numbers, and nan is none")
    if isinstance(unit, str) and unit == to and unit in STANDARD:
        return values
    import pint

    if any(isinstance(each, str) and (_COUNTED.fullmatch(each) or _SHARE.fullmatch(each)) for each in (unit, to)):
        return _convert_scaled(values, unit, to)
    source, target = _parse(unit), _parse(to)
    if source == target:
        return values
    try:
        with np.errstate(over="ignore"):
            converted: Values = _registry().convert(values, _turning(source, target), _turning(target, source))
    except pint.DimensionalityError:
        raise ValueError(f"cannot convert {quoted(unit)} to {quoted(to)}{_reason(source, target)}") from None
    except OverflowError:
        raise ValueError(f"the ratio of {quoted(unit)} to {quoted(to)} is too large a number") from None
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
    if counted := _COUNTED.fullmatch(unit):
        return 1.0 / int(counted[1]), f"rev{counted[2] or ''}"
    if share := _SHARE.fullmatch(unit):
        return _SHARES[share[1]] * float(share[2]), share[3]
    return 1.0, unit


def is_share(unit: str) -> bool:
    """True if a unit is a share whose rated value is not given.

    >>> is_share("%"), is_share("‰"), is_share("% of 12 A")
    (True, True, False)
    """
    return _text(unit).strip().casefold() in _SHARES


def _turning(unit: pint.Unit, other: pint.Unit) -> pint.Unit:
    """The unit itself, but revolutions per minute where 1/min stands for an angular speed."""
    is_speed = unit == _parse("1/min") and other.dimensionality == _parse("rad/s").dimensionality
    return _parse("rev/min") if is_speed else unit


def _reason(source: pint.Unit, target: pint.Unit) -> str:
    """Return the reason why a frequency is no angular speed; empty for other units."""
    if [unit.dimensionality for unit in (source, target)] == [_parse(unit).dimensionality for unit in ("1/s", "rad/s")]:
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
    from pint.util import to_units_container

    parsed = _parse(unit)
    _, base = _registry().get_base_units(parsed)
    powers = cast("dict[str, int]", to_units_container(base))
    exponents = {_registry().get_symbol(name): int(power) for name, power in powers.items()}
    return float(_registry().convert(1.0, parsed, base)), dict(sorted(exponents.items()))


def counts(unit: str) -> bool:
    """True if a unit is that of an encoder's counts, without or with the counts of a revolution.

    Raises:
        TypeError: the unit is no text

    >>> counts("inc"), counts("counts/16384"), counts("rad")
    (True, True, False)
    """
    unit = _text(unit)
    return any(_COUNTED.fullmatch(each) for each in (unit, f"{unit}/1", unit.replace("/", "/1/", 1)))


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
    if isinstance(unit, str) and unit in STANDARD:
        return unit
    if isinstance(unit, str) and (counted := _COUNTED.fullmatch(unit)):
        return f"counts/{counted[1]}{counted[2] or ''}"
    if isinstance(unit, str) and (share := _SHARE.fullmatch(unit)):
        if not float(share[2]) > 0.0:
            raise ValueError(f"unit {quoted(unit)}: the rated value must be larger than 0")
        return f"{'%' if _SHARES[share[1]] == 1e-2 else 'permille'} of {share[2]} {check(share[3])}"
    standard = _spelling(_parse(unit))
    if len(standard) > _MAX_UNIT_CHARACTERS:
        raise ValueError(f"unit {quoted(unit)} has more than {_MAX_UNIT_CHARACTERS} characters in standard spelling")
    return standard


def ratio_of_units(unit: str, by: str) -> str:
    """Return the unit of a quantity over another one.

    >>> ratio_of_units("rad", "N.m"), ratio_of_units("rad", "rad"), ratio_of_units("A", "1")
    ('rad/(N.m)', '1', 'A')
    """
    return check(f"({unit})/({by})")


@lru_cache(maxsize=1024)
def _spelling(unit: pint.Unit) -> str:
    from pint.util import to_units_container

    powers = cast("dict[str, int]", to_units_container(unit))
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


def _text(unit: str) -> str:
    if not isinstance(unit, str):
        raise TypeError(f"a unit is a text like N.m, not {shortened(unit)}")
    return unit


def _parse(unit: str) -> pint.Unit:
    if len(_text(unit)) > _MAX_UNIT_CHARACTERS:
        raise ValueError(f"unit {quoted(unit)} has {len(unit)} characters; at most {_MAX_UNIT_CHARACTERS} are allowed")
    return _parsed(unit)


@lru_cache(maxsize=1024)
def _parsed(unit: str) -> pint.Unit:
    import pint

    registry = _registry()
    try:
        parsed = registry.parse_units(_expression(unit), as_delta=False)
        scale = registry.convert(1.0, parsed, registry.get_base_units(parsed)[1])  # refuses degC in a product
    except (pint.PintError, tokenize.TokenError, ValueError, TypeError, AssertionError):
        if _COUNTED.fullmatch(f"{unit.strip()}/1"):
            raise ValueError(f"unit {quoted(unit)} needs the counts of one revolution; write it like counts/16384") from None
        if is_share(unit):
            raise ValueError(f"unit {quoted(unit)} needs the rated value; write it like permille of 0.4 N.m") from None
        raise ValueError(f"unit {quoted(unit)} is not known; write it like N.m, rad/s, deg") from None
    except OverflowError:
        scale = math.inf
    if not 0.0 < scale < math.inf:
        raise ValueError(f"unit {quoted(unit)} is too large or too small a number of SI units")
    return parsed


def _expression(unit: str) -> str:
    """The unit as pint reads it: `N·m s/rad^2` becomes `N*m*s/rad**2`."""
    text = unit.replace("**", "^").translate(_CHARACTERS)
    if not text.isprintable():
        raise ValueError("not one line of text")
    text = _OF_ARC.sub(lambda found: "arcmin" if found[1].lower() == "min" else "arcsec", text)
    text = re.sub(r" *([./()]) *", r"\1", text.strip())
    text = "1" if text == "-" else re.sub(r" +|\.|(?<=[A-Za-z])-(?=[A-Za-z])", "*", text)
    text = _REVOLUTIONS.sub("rev", re.sub(r"\^(?=-?\d)", "", _PER_SECOND.get(text, text)))
    _check_grammar(text)
    return re.sub(r"([A-Za-z]+)(-?[1-9])?", _power, text)


def _check_grammar(text: str) -> None:
    if not re.fullmatch(r"(?:[A-Za-z]++(?:-?[1-9])?+|\b1\b|[*/()])++", text):  # possessive, so that it takes linear time
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
