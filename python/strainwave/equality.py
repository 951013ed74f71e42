"""Equality of values that hold arrays, which Python's own `==` of dataclasses cannot compare."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np


class ComparedByFields:
    """Base of dataclasses with `eq=False`: two of one class are equal if their fields are. Like arrays, they have no hash."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        owned: Any = self  # a dataclass
        return all(equal(getattr(self, field.name), getattr(other, field.name)) for field in fields(owned))


def equal(one: object, other: object) -> bool:
    """True if two values are equal: arrays in type, shape and every number, mappings also in their order.

    Not-a-number equals not-a-number.

    >>> equal({"a": np.array([1.0, np.nan])}, {"a": np.array([1.0, np.nan])})
    True
    >>> equal((np.array([1.0]),), (np.array([1]),))
    False
    """
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=one.dtype.kind in "fc")
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return list(one) == list(other) and all(equal(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list) and type(one) is type(other):
        return len(one) == len(other) and all(map(equal, one, other))
    if isinstance(one, float) and isinstance(other, float) and np.isnan(one):
        return bool(np.isnan(other))
    return type(one) is type(other) and bool(one == other)
