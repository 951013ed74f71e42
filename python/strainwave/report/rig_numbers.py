"""Numbers of a torsion test in print: a value, and below it the interval that holds the truth with 95 %."""

from __future__ import annotations

import re
from math import floor, isfinite, log10
from typing import NamedTuple

from strainwave.rig.analysis.result import Result
from strainwave.typeset import fixed, number

DEFAULT_DIGITS = 4  # of a value whose uncertainty is not known
MAX_DIGITS = 6  # of a value, however small its uncertainty


class Stated(NamedTuple):
    """A number in print.

    Attributes:
        value: rounded to what its interval allows
        interval: both ends, empty if the uncertainty is not known
    """

    value: str
    interval: str

    def __str__(self) -> str:
        return f"{self.value} ({self.interval})" if self.interval else self.value


def stated(found: Result | None, scale: float = 1.0) -> Stated:
    """A number times a scale, rounded to the second digit of half its interval.

    >>> str(stated(Result(4.5123, "N.m/rad", 0.04, 0.02, 4.4247, 4.5999)))
    '4.512 (4.425 to 4.600)'
    >>> str(stated(Result(0.30634, "J", float("nan"), 0.0, float("nan"), float("nan"))))
    '0.3063'
    >>> str(stated(None))
    '—'
    """
    if found is None or not isfinite(found.value):
        return Stated("—", "")
    value, low, high = (scale * each for each in (found.value, found.low, found.high))
    if not (isfinite(high - low) and high > low):
        return Stated(
            number(value, DEFAULT_DIGITS),
            f"{number(low, DEFAULT_DIGITS)} to {number(high, DEFAULT_DIGITS)}" if high > low else "",
        )
    places = 1 - floor(log10(0.5 * (high - low)))
    most = MAX_DIGITS - 1 - floor(log10(max(abs(low), abs(high))))
    if not -3 <= min(places, most) <= MAX_DIGITS:
        return Stated(number(value, MAX_DIGITS), f"{number(low, MAX_DIGITS)} to {number(high, MAX_DIGITS)}")
    texts = [fixed(each, min(places, most)) for each in (value, low, high)]
    return Stated(texts[0], f"{texts[1]} to {texts[2]}" if texts[1] != texts[2] else f"± {number(0.5 * (high - low), 1)}")


def sentence(words: str) -> str:
    """Words as a sentence in print: signs and units set as such.

    >>> sentence("soft from -0.1 N.m on")
    'Soft from −0.1 N·m on.'
    >>> sentence("step-005.png: is empty")
    'step-005.png: is empty.'
    """
    signed = re.sub(r"(?<![\w.])-(?=\d)", "−", words.replace("N.m", "N·m"))
    first = signed[0] if re.match(r"\S+\.[A-Za-z]+:", signed) else signed[0].upper()  # a file's name stays as it is
    return f"{first}{signed[1:]}."
