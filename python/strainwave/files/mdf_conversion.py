"""Conversions of MDF channels from raw to physical values, with fixed arithmetic alone.

ASAM MDF has one kind of conversion that is a formula in text. A formula from a file is never evaluated: its channel is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.messages import quoted

Array = NDArray[np.float64]
Convert = Callable[[Array], Array]


class RefusedChannel(ValueError):  # noqa: N818 - its message is the reason alone
    """The reason why a channel is not read; the other channels are."""


def refuse_formula(formula: str) -> RefusedChannel:
    """Return the refusal of a conversion that is a formula."""
    advice = "save the channel with a linear or table conversion, or as .csv"
    return RefusedChannel(f"its conversion is a formula, {quoted(formula)}, which is not evaluated; {advice}")


def identity(raw: Array) -> Array:
    """Return the raw values."""
    return raw


def linear(offset: float, factor: float) -> Convert:
    """Return the conversion `offset + factor * raw`."""
    return lambda raw: offset + factor * raw if (offset, factor) != (0.0, 1.0) else raw


def rational(parameters: Sequence[float]) -> Convert:
    """Return the quotient of two polynomials of second degree, highest power first.

    >>> rational([0.0, 2.0, 1.0, 0.0, 0.0, 4.0])(np.array([1.5]))
    array([1.])
    """
    p1, p2, p3, p4, p5, p6 = parameters
    return lambda raw: _divide((p1 * raw + p2) * raw + p3, (p4 * raw + p5) * raw + p6)


def hyperbolic(parameters: Sequence[float]) -> Convert:
    """Return the conversion that MDF 3 calls polynomial."""
    p1, p2, p3, p4, p5, p6 = parameters
    return lambda raw: _divide(p2 - p4 * (raw - p5 - p6), p3 * (raw - p5 - p6) - p1)


def exponential(parameters: Sequence[float], function: Callable[[Array], Array]) -> Convert:
    """Return the exponential or logarithmic conversion of MDF 3; `function` is `numpy.exp` or `numpy.log`."""
    p1, p2, p3, p4, p5, p6, p7 = parameters
    if p4 == 0.0:
        return lambda raw: _divide(function(_divide((raw - p7) * p6 - p3, p1)), p2)
    if p1 == 0.0:
        return lambda raw: _divide(function(_divide(_divide(p3, raw - p7) - p6, p4)), p5)
    raise RefusedChannel("its exponential conversion has both P1 and P4; one of them must be 0")


def interpolated(keys: Array, values: Array) -> Convert:
    """Return linear interpolation in a table, constant beyond its ends."""
    _check_sorted(keys)
    return lambda raw: np.interp(raw, keys, values)


def nearest(keys: Array, values: Array) -> Convert:
    """Return the value of the nearest key, of the lower one if two are equally near.

    >>> nearest(np.array([0.0, 2.0]), np.array([10.0, 20.0]))(np.array([-5.0, 1.0, 1.1, 9.0]))
    array([10., 10., 20., 20.])
    """
    _check_sorted(keys)
    return lambda raw: values[np.searchsorted(0.5 * keys[1:] + 0.5 * keys[:-1], raw, side="left")]


def ranges(lower: Array, upper: Array, values: Array, default: float, of_integers: bool) -> Convert:
    """Return the value of the range that contains the raw value; `default` if none does.

    >>> table = ranges(np.array([0.0, 5.0]), np.array([2.0, 6.0]), np.array([1.0, 2.0]), -1.0, of_integers=True)
    >>> table(np.array([0.0, 2.0, 3.0, 6.0]))
    array([ 1.,  1., -1.,  2.])
    """
    places = range_finder(lower, upper, of_integers)
    return lambda raw: np.append(values, default)[places(raw)]


def range_finder(lower: Array, upper: Array, of_integers: bool) -> Callable[[Array], NDArray[np.intp]]:
    """Return which range contains a value, -1 if none. The upper end belongs to a range of integers alone."""
    _check_sorted(lower)

    def places(raw: Array) -> NDArray[np.intp]:
        found = np.searchsorted(lower, raw, side="right") - 1
        inside = (raw <= upper[found]) if of_integers else ((raw < upper[found]) | (raw == lower[found]))
        return np.where((found >= 0) & inside, found, -1)

    return places


def piecewise(places: Callable[[Array], NDArray[np.intp]], pieces: Sequence[Convert | None]) -> Convert:
    """Return the conversion that differs between keys or ranges; the last is that of all other values, None gives nan."""

    known = np.array([piece is not None for piece in pieces])

    def convert(raw: Array) -> Array:
        place = places(raw) % len(pieces)
        order = np.argsort(place, kind="stable")
        order = order[known[place[order]]]
        found = np.full(len(raw), np.nan)
        for rows in np.split(order, np.flatnonzero(np.diff(place[order])) + 1) if len(order) else ():
            if piece := pieces[place[rows[0]]]:
                found[rows] = piece(raw[rows])
        return found

    return convert


def key_finder(keys: Array) -> Callable[[Array], NDArray[np.intp]]:
    """Return which key equals a value, -1 if none does."""
    _check_sorted(keys)

    def places(raw: Array) -> NDArray[np.intp]:
        found = np.minimum(np.searchsorted(keys, raw), len(keys) - 1)
        return np.where(keys[found] == raw, found, -1)

    return places


def _check_sorted(keys: Array) -> None:
    if not len(keys) or not (np.diff(keys) >= 0.0).all():
        raise RefusedChannel("the keys of its conversion table do not increase")


def _divide(numerator: Array | float, denominator: Array | float) -> Array:
    with np.errstate(all="ignore"):
        quotient: Array = np.divide(numerator, denominator)
    return quotient
