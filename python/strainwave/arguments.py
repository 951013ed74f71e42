"""Arguments of functions: each is what it must be, or is refused in one line that names it, its value and what is allowed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf
from numbers import Integral, Real
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Drive, _core
from strainwave.arrays import numbers as numbers
from strainwave.files.figures import number_of
from strainwave.messages import listed, quoted, shortened

Model = TypeVar("Model")
MIN_RATIO: float = 0.1  # size of the ratio of a gear
MAX_RATIO: float = 1e4
MIN_PROBABILITY = 1e-12  # of an error: no measurement shows less


def number(name: str, value: object, unit: str = "", brackets: str = "()", low: float = -inf, high: float = inf) -> float:
    """A number in the interval from `low` to `high`, whose ends belong to it where the bracket is square.

    A number with a unit may be given as a text that contains the unit.

    >>> number("dt", 1, "s", low=0.0), number("dt", "2 ms", "s", low=0.0)
    (1.0, 0.002)
    >>> number("dt", -1.0, "s", low=0.0)
    Traceback (most recent call last):
    ValueError: dt = -1.0 s must lie in (0, inf)
    """
    if not isinstance(value, Real) or isinstance(value, bool):
        if isinstance(value, str) and unit not in ("", "1"):
            return number(name, number_of(name, value, unit), unit, brackets, low, high)
        raise TypeError(f"{name} must be a number, not {shortened(value)}")
    try:
        given = float(value)
    except OverflowError:
        raise ValueError(f"{name} = {shortened(value)} is too large a number") from None
    above = low <= given if brackets[0] == "[" else low < given
    below = given <= high if brackets[1] == "]" else given < high
    if not (above and below):
        interval = f"{brackets[0]}{low:g}, {high:g}{brackets[1]}"
        allowed = "be finite" if interval == "(-inf, inf)" else f"lie in {interval}"
        raise ValueError(f"{f'{name} = {value} {unit}'.rstrip()} must {allowed}")
    return given


def bare_number(name: str, value: object, unit: str = "", brackets: str = "()", low: float = -inf, high: float = inf) -> float:
    """Return a number as `number` does; refuse a text, because the value is stored unchanged."""
    if isinstance(value, str):
        raise TypeError(f"{name} must be a number, not {shortened(value)}")
    return number(name, value, unit, brackets, low, high)


def sized(name: str, value: object, unit: str = "", low: float = 0.0, high: float = inf) -> float:
    """A number of either sign whose size lies in [low, high].

    >>> sized("ratio", -0.0, low=0.1, high=1e4)
    Traceback (most recent call last):
    ValueError: ratio = -0.0 must lie in [0.1, 10000] or [-10000, -0.1]
    """
    given = number(name, value, unit, "[]", -high, high)
    if abs(given) < low:
        raise ValueError(f"{f'{name} = {value} {unit}'.rstrip()} must lie in [{low:g}, {high:g}] or [{-high:g}, {-low:g}]")
    return given


def ratio(name: str, value: object) -> float:
    """The ratio of a gear, signed."""
    return sized(name, value, low=MIN_RATIO, high=MAX_RATIO)


def probability(name: str, value: object) -> float:
    """The largest probability of an error that is allowed."""
    return number(name, value, brackets="[)", low=MIN_PROBABILITY, high=1.0)


def seconds(name: str, value: object) -> float:
    """A time that is positive [s]."""
    return number(name, value, "s", low=0.0)


def whole(name: str, value: object, low: int, high: int = 2**63 - 1) -> int:
    """A whole number from `low` to `high`."""
    if not isinstance(value, Integral) or isinstance(value, bool):
        raise TypeError(f"{name} must be a whole number, not {shortened(value)}")
    given = int(value)
    if given < low:
        raise ValueError(f"{name} = {shortened(given)} must be {low} or more")
    if given > high:
        raise ValueError(f"{name} = {shortened(given)} must be {high} or less")
    return given


def positive_series(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """A positive number or more, shape (n,)."""
    series = np.atleast_1d(numbers(name, values))
    if series.ndim != 1 or not series.size or not (series > 0.0).all():
        raise ValueError(f"{name} must be one series of positive numbers")
    return series


def text(name: str, value: object) -> str:
    """A text."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a text, not {shortened(value)}")
    return value


def one_of(name: str, value: object, choices: Iterable[str]) -> str:
    """One of a few words.

    >>> one_of("side", "left", ("input", "output"))
    Traceback (most recent call last):
    ValueError: side = "left" must be one of input, output
    """
    word, known = text(name, value), list(choices)
    if word not in known:
        raise ValueError(f"{name} = {quoted(word)} must be one of {listed(known)}")
    return word


def names(name: str, values: object) -> list[str]:
    """Names, by whatever goes through them; one alone is no list of them."""
    listed = list(values) if isinstance(values, Iterable) and not isinstance(values, str) else None
    if listed is None or not all(isinstance(each, str) for each in listed):
        raise TypeError(f"{name} must be a list of names, not {shortened(values)}")
    return listed


def mapping(name: str, value: object, example: str) -> None:
    """Refuse what does not map names to something, as the example does."""
    if not isinstance(value, Mapping):
        raise TypeError(f"{name} must be a mapping, as in {example}, not {shortened(value)}")


def drive(value: object) -> Drive:
    """A drive to run or to look at.

    >>> drive("robot-joint")
    Traceback (most recent call last):
    TypeError: drive = 'robot-joint' must be a drive, not its name: sw.load(name) returns what a file has
    """
    return _model("drive", value, Drive)


def gear(value: object) -> _core.Gear:
    """A gear."""
    return _model("gear", value, _core.Gear)


def _model(name: str, value: object, kind: type[Model]) -> Model:
    if isinstance(value, str):
        raise TypeError(f"{name} = {shortened(value)} must be a {name}, not its name: sw.load(name) returns what a file has")
    if not isinstance(value, kind):
        raise TypeError(f"{name} = {shortened(value)} must be a {name}, as sw.{kind.__name__}(...) makes one")
    return value
