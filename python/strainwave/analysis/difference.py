"""Differences of two models."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import zip_longest
from math import hypot, isfinite
from typing import Any, TypeAlias

from strainwave import Drive
from strainwave._core import Gear
from strainwave.files.described import parameters, parts
from strainwave.files.gear_file import at
from strainwave.files.gear_set import GearSet
from strainwave.presentation import Statement

Model: TypeAlias = Gear | Drive | GearSet


@dataclass(frozen=True)
class Difference(Statement):
    """A place where two models differ.

    Attributes:
        path: of a number, as "gear.stiffness.k1", of the model of a part, as "gear.stiffness", or of a rating
        first, second: the numbers, or the models' names; None where one of them does not have it
        unit: of the numbers, empty for names
        sigma: standard deviation of the second less the first, as if they were independent; None unless both sets state one

    >>> import strainwave as sw
    >>> gear = sw.load("csg-25-100")
    >>> (difference,) = sw.compare(gear, gear.replace({"stiffness.k1": 0.8 * gear.stiffness.k1}))
    >>> difference.path, round(difference.change, 3)
    ('gear.stiffness.k1', -0.2)
    """

    path: str
    first: float | str | None
    second: float | str | None
    unit: str = ""
    sigma: float | None = None

    @property
    def deviations(self) -> float | None:
        """The second less the first in standard deviations; None where none is stated, or it is 0."""
        if isinstance(self.first, str | None) or isinstance(self.second, str | None) or not self.sigma:
            return None
        return (self.second - self.first) / self.sigma

    @property
    def change(self) -> float | None:
        """The second less the first, relative to the first; None where that is no number."""
        if isinstance(self.first, str | None) or isinstance(self.second, str | None) or self.first == 0:
            return None
        change = (self.second - self.first) / self.first
        return change if isfinite(change) else None

    def _headline(self) -> str:
        """The difference in one line."""
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        first, second = (text if value is None else text + unit for text, value in zip(self.texts, self._values, strict=True))
        parts = [f"{100.0 * self.change:+.3g} %"] if self.change is not None else []
        parts += [f"{self.deviations:+.2g} σ"] if self.deviations is not None else []
        change = f" ({', '.join(parts)})" if parts else ""
        return f"{self.path}: {first} against {second}{change}"

    @property
    def texts(self) -> tuple[str, str]:
        """Return both numbers or names as texts, without their unit; numbers with so many digits that they differ."""
        digits = next(digits for digits in (6, 10, 17) if digits == 17 or len({_shown(v, digits) for v in self._values}) == 2)
        first, second = (_shown(value, digits) for value in self._values)
        return first, second

    @property
    def _values(self) -> tuple[float | str | None, float | str | None]:
        return self.first, self.second


def _shown(value: float | str | None, digits: int) -> str:
    return "nothing" if value is None else value if isinstance(value, str) else f"{value:.{digits}g}"


def differences(first: Model, second: Model) -> list[Difference]:
    """Return every number and every law in which two models differ; see `compare`."""
    ours, theirs = _parts(first), _parts(second)
    if isinstance(first, Gear) or isinstance(second, Gear):
        return _between("gear", ours["gear"], theirs["gear"])
    found = [each for name in ours for each in _between(name, ours[name], theirs[name])]
    if isinstance(first, GearSet) and isinstance(second, GearSet):
        found = [_with_sigma(each, first, second) for each in found] + _ratings(first, second)
    return found


def _with_sigma(each: Difference, first: GearSet, second: GearSet) -> Difference:
    """Return a difference of numbers with its standard deviation, if both sets state that of theirs."""
    if isinstance(each.first, str | None) or isinstance(each.second, str | None):
        return each
    one, other = (of.sources[each.path].sigma(value) for of, value in ((first, each.first), (second, each.second)))
    return each if one is None or other is None else replace(each, sigma=hypot(one, other))


def _parts(model: Model) -> dict[str, Any]:
    """The parts of a drive by name; None where a set does not have one."""
    return {"gear": model} if isinstance(model, Gear) else {each.name: getattr(model, each.name) for each in parts(Drive())}


def _between(path: str, first: Any, second: Any) -> list[Difference]:
    if type(first) is not type(second):
        one, other = (None if each is None else str(each.name) for each in (first, second))
        return [Difference(path, one, other)]
    if first is None:
        return []
    found: list[Difference] = []
    for each in parameters(first):
        one, other = getattr(first, each.name), getattr(second, each.name)
        for place, pair in _pairs(f"{path}.{each.name}", one, other):
            if pair[0] != pair[1]:
                found.append(Difference(place, *pair, each.unit or ""))
    for part in parts(first):
        found += _between(f"{path}.{part.name}", getattr(first, part.name), getattr(second, part.name))
    return found


def _pairs(path: str, first: Any, second: Any) -> list[tuple[str, tuple[Any, Any]]]:
    """The two numbers at each place; None where one of two sequences has ended."""
    if isinstance(first, float | int | str):
        return [(path, (first, second))]
    return [(f"{path}[{i}]", pair) for i, pair in enumerate(zip_longest(first, second))]


def _ratings(first: GearSet, second: GearSet) -> list[Difference]:
    """The ratings that differ, in the unit of the first set."""
    found = []
    for name in [*first.ratings, *(name for name in second.ratings if name not in first.ratings)]:
        given = [each.ratings.get(name) for each in (first, second)]
        unit = next(each.unit for each in given if each is not None)
        with at(f"ratings.{name}:"):
            one, other = (None if each is None else float(each.to(unit).value) for each in given)
        if one != other:
            found.append(Difference(f"ratings.{name}", one, other, unit))
    return found
