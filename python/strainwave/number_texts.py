"""Numbers as people write them in options, files and names: ASCII digits, a decimal point, perhaps a power of ten."""

from __future__ import annotations

import re
from math import isinf

from strainwave.messages import quoted

NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"


def is_number(text: str) -> bool:
    """True if a text is a number and nothing else. `float` also takes other digits, underscores, inf and nan.

    >>> is_number("-2.5e-3"), is_number("1_000"), is_number("inf"), is_number("\\u0661\\u0662")
    (True, False, False, False)
    """
    return re.fullmatch(NUMBER, text) is not None


def is_whole(text: str) -> bool:
    """True if a text is a whole number of at most 18 digits and nothing else."""
    return re.fullmatch("[+-]?[0-9]{1,18}", text) is not None


def number_in(text: str) -> float:
    """Return the number that a text contains.

    Raises:
        ValueError: it contains no number, something else too, or a number above 1.8e308

    >>> number_in("2e-3")
    0.002
    """
    if not is_number(text):
        raise ValueError(f"{quoted(text)} is no number; write digits with a decimal point, as 0.5 or 2e-3")
    number = float(text)
    if isinf(number):
        raise ValueError(f"{quoted(text)} is too large a number")
    return number
