"""Laws with numbers of the size of a small joint, made from what their fields say: a new law is covered without an edit."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import prod
from typing import Any

# Sizes of what a unit is made of. Friction is of the input; spring and hysteresis are of the output.
INPUT_SIZES = {"N.m": 0.03, "rad": 1.0, "s": 0.02, "K": 100.0, "1": 0.2, "m": 1e-3}
OUTPUT_SIZES = {"N.m": 1.0, "rad": 1e-4, "s": 1e-3, "K": 100.0, "1": 0.2, "m": 1e-3}


def size_of(unit: str, sizes: Mapping[str, float]) -> float:
    """Return the size of a number with a unit such as N.m.s2/rad2 or 1/(N.m)."""
    above, _, below = unit.partition("/")
    factors = (re.findall(r"(N\.m|[A-Za-z]+|1)(\d?)", part) for part in (above, below))
    numerator, denominator = (prod(sizes[name] ** int(power or 1) for name, power in part) for part in factors)
    return numerator / denominator


def joint_sized(model: Any, sizes: Mapping[str, float], within: Any = None) -> Any:
    """Return a law none of whose numbers is zero: its default, or a number of the size of the joint.

    Args:
        model: the class of the law
        sizes: of what its units are made of
        within: the law that it contains, if it contains one

    Raises:
        ValueError: the law does not take such numbers
    """
    numbers = {field["name"]: _sized(field, sizes, within) for field in model.fields if not field["follows"]}
    try:
        return model(**numbers)
    except ValueError as error:
        raise ValueError(f"{error}: list {model.name} with numbers of its own, where this test lists laws") from None


def _sized(field: Mapping[str, Any], sizes: Mapping[str, float], within: Any) -> Any:
    if field["kind"] == "part":
        return within or joint_sized(type(field["default"]), sizes)
    if field["kind"] == "sequence":
        return field["default"] or [size_of(field["unit"], sizes)]
    return field["default"] or size_of(field["unit"], sizes) if field["kind"] == "number" else field["default"]
