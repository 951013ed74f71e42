"""Numbers and units as a reader expects them in print: plain Unicode, the same in every locale."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from markupsafe import Markup

__all__ = [
    "ARCMIN_PER_DEGREE",
    "ARCMIN_PER_RADIAN",
    "ARCSEC_PER_DEGREE",
    "ZERO_CELSIUS",
    "breakable",
    "fixed",
    "interval",
    "number",
    "plain_symbols",
    "power_of_ten",
    "prefix_power",
    "prefixed",
    "quantity",
    "symbols",
    "uncertain",
    "uncertain_quantity",
    "unit",
]

ARCMIN_PER_RADIAN = 180.0 * 60.0 / math.pi
ARCMIN_PER_DEGREE = 60.0
ARCSEC_PER_DEGREE = 3600.0
ZERO_CELSIUS = 273.15  # K

_INDEXED = re.compile(r"\b([^\W\d_])_(\w+)\b")  # a letter with an index, as F_c
_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_GREEK = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "theta": "θ", "sigma": "σ", "tau": "τ",
    "phi": "φ", "psi": "ψ", "omega": "ω",
}  # fmt: skip
_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M"}
_PLAIN = range(-4, 6)  # decades of numbers written without a power of ten
_MAX_DIGITS = 8  # a standard deviation below the last of them is written by itself


def number(value: float, digits: int = 6) -> str:
    """Return a number to so many significant digits at most, with a power of ten where that is shorter.

    >>> number(31000.0), number(0.0126), number(-5.818e-5), number(2e9)
    ('31000', '0.0126', '−58.18 × 10⁻⁶', '2 × 10⁹')
    """
    if not math.isfinite(value):
        return {math.inf: "∞", -math.inf: "−∞"}.get(value, "—")
    if value == 0.0:
        return "0"
    power = _power(_decade(value, digits))
    scaled = value / 10.0**power
    text = fixed(scaled, digits - 1 - _decade(scaled, digits))
    return (text.rstrip("0").rstrip(".") if "." in text else text) + _times(power)


def uncertain(value: float, sigma: float) -> str:
    """Return a value with its standard deviation, which is written to two significant digits.

    Not-a-number stands for no standard deviation, infinity for a value that nothing determines.

    >>> uncertain(0.012554, 0.00213), uncertain(31234.0, 870.0), uncertain(1.185e-4, 2.13e-6)
    ('0.0126 ± 0.0021', '31230 ± 870', '(118.5 ± 2.1) × 10⁻⁶')
    >>> uncertain(0.02, float("inf")), uncertain(3e-4, 1e-18)
    ('0.02 ± ∞', '0.0003 ± 1 × 10⁻¹⁸')
    """
    if math.isnan(sigma):
        return number(value)
    if not math.isfinite(sigma) or sigma <= abs(value) * 10.0**-_MAX_DIGITS:
        return f"{number(value)} ± {number(sigma, 2)}"
    return _to_digits_of(sigma, (value, sigma), " ± ")


def interval(low: float, high: float, sigma: float) -> str:
    """Return an interval, its ends to the digits of a standard deviation.

    >>> interval(0.945, 1.0117, 0.017), interval(7.83e-6, 17.0e-6, 2.3e-6), interval(1.0, 1.0, 0.0)
    ('0.945 to 1.012', '(7.8 to 17.0) × 10⁻⁶', '1 to 1')
    """
    if not math.isfinite(sigma) or sigma <= max(abs(low), abs(high)) * 10.0**-_MAX_DIGITS:
        return f"{number(low)} to {number(high)}"
    return _to_digits_of(sigma, (low, high), " to ")


def _to_digits_of(sigma: float, numbers: tuple[float, float], between: str) -> str:
    """Return two numbers with as many digits as a standard deviation of two, and one power of ten."""
    decade = _decade(max(*map(abs, numbers), sigma), 2)
    power = 3 * math.floor(decade / 3) if _decade(sigma, 2) < -5 else _power(decade)
    places = 1 - _decade(sigma / 10.0**power, 2)
    pair = between.join(fixed(each / 10.0**power, places) for each in numbers)
    return f"({pair}){_times(power)}" if power else pair


def unit(text: str) -> str:
    """Return a unit in print; nothing for plain numbers.

    >>> unit("N.m.s/rad"), unit("kg.m2"), unit("V/(rad.s)"), unit("Ohm"), unit("1")
    ('N·m·s/rad', 'kg·m²', 'V/(rad·s)', 'Ω', '')
    """
    if text == "1":
        return ""
    raised = re.sub(r"(?<=[A-Za-z])-?\d", lambda power: power[0].translate(_SUPERSCRIPTS), text)
    return re.sub(r"\bdeg\b", "°", raised.replace("Ohm", "Ω")).replace(".", "·")


def quantity(value: float, of: str, digits: int = 3) -> str:
    """Return a number with its unit, scaled by a prefix where that reads better.

    >>> quantity(0.000612, "N.m"), quantity(3.2e-6, "rad"), quantity(31000.0, "N.m/rad"), quantity(0.5, "1")
    ('612 µN·m', '3.2 µrad', '31 kN·m/rad', '0.5')
    """
    power = prefix_power(value, of)
    return f"{number(value / 10.0**power, digits)} {prefixed(of, power)}".strip()


def percent(share: float) -> str:
    """Return a share in print, to two digits.

    >>> percent(0.0484)
    '4.8 %'
    """
    return f"{number(100.0 * share, 2)} %"


def symbols(text: str) -> Markup:
    """Return a text as HTML, escaped, with the symbols in it set as such.

    >>> print(symbols("Kinetic friction torque F_c < F_s, where theta_out = 0"))
    Kinetic friction torque <var>F<sub>c</sub></var> &lt; <var>F<sub>s</sub></var>, where <var>θ<sub>out</sub></var> = 0
    """
    from markupsafe import Markup, escape

    return Markup(_INDEXED.sub(r"<var>\1<sub>\2</sub></var>", _in_greek(str(escape(text)))))


def plain_symbols(text: str) -> str:
    """Return a text with its symbols as a drawing shows them, without indices.

    >>> plain_symbols("Kinetic friction torque F_c, where theta_out = 0")
    'Kinetic friction torque Fc, where θout = 0'
    """
    return _INDEXED.sub(r"\1\2", _in_greek(text))


def _in_greek(text: str) -> str:
    return re.sub(rf"\b(?:{'|'.join(_GREEK)})(?![a-z])", lambda word: _GREEK[word[0]], text)


def breakable(path: str) -> Markup:
    """Return the path of a parameter as HTML, in which a short line may be broken between words.

    >>> print(breakable("gear.input_inertia"))
    gear.<wbr>input_<wbr>inertia
    """
    from markupsafe import Markup, escape

    return Markup(re.sub(r"([._])", r"\1<wbr>", str(escape(path))))


def fixed(value: float, places: int) -> str:
    """Return a number rounded to so many decimal places; if negative, to tens, hundreds …

    >>> fixed(-0.0312, 2), fixed(-0.001, 2), fixed(31234.0, -2)
    ('−0.03', '0.00', '31200')
    """
    return f"{round(value, places) + 0.0:.{max(places, 0)}f}".replace("-", "−")


def uncertain_quantity(value: float, sigma: float, of: str) -> str:
    """Return a value with its standard deviation and unit, scaled by a prefix where that reads better.

    >>> uncertain_quantity(1.2e-5, 1.4e-5, "rad"), uncertain_quantity(-340.7e-6, 2.2e-6, "rad/A")
    ('12 ± 14 µrad', '−340.7 ± 2.2 µrad/A')
    """
    power = prefix_power(max(abs(value), sigma) if math.isfinite(sigma) else value, of)
    return f"{uncertain(value / 10.0**power, sigma / 10.0**power)} {prefixed(of, power)}".strip()


def prefix_power(largest: float, of: str) -> int:
    """Return the power of ten, a multiple of three, by whose prefix numbers of this size are best written."""
    takes_none = of in ("1", "permille") or of.startswith(("k", "1/"))
    if takes_none or not math.isfinite(largest) or 0.1 <= abs(largest) < 1e4 or largest == 0.0:
        return 0
    return min(max(3 * math.floor(_decade(largest, 3) / 3), -9), 6)


def prefixed(of: str, power: int) -> str:
    """Return a unit in print with the prefix of a power of ten."""
    return _PREFIXES[power] + unit(of)


def _decade(value: float, digits: int) -> int:
    """Return the power of ten of the first digit of a number rounded to so many digits."""
    return int(f"{value:.{digits - 1}e}".partition("e")[2])


def _power(decade: int) -> int:
    return 0 if decade in _PLAIN else 3 * math.floor(decade / 3)


def _times(power: int) -> str:
    return f" × {power_of_ten(power)}" if power else ""


def power_of_ten(power: int) -> str:
    """Return a power of ten in print.

    >>> power_of_ten(-3)
    '10⁻³'
    """
    return f"10{str(power).translate(_SUPERSCRIPTS)}"


def __dir__() -> list[str]:
    return __all__
