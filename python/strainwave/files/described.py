"""Descriptions of parts and numbers by the models, and the origin of each number in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from strainwave.files.entries import NOT_GIVEN, OPPOSITE, Entry


class PartField(NamedTuple):
    """A model that another one holds, and what it may be chosen from, by name; None where there is but one."""

    name: str
    options: Mapping[str, Any] | None


def parts(model: Any) -> list[PartField]:
    """The parts of a model, or of a class of models."""
    return [PartField(field["name"], field["options"]) for field in model.fields if field["kind"] == "part"]


class ParameterField(NamedTuple):
    """A parameter: its kind is number, count, sequence (of numbers) or choice (of words)."""

    name: str
    kind: str
    unit: str


def parameters(model: Any) -> list[ParameterField]:
    """The parameters of a model, or of a class of models; its parts have their own."""
    return [ParameterField(*map(field.get, ParameterField._fields)) for field in model.fields if field["kind"] != "part"]


def default_of(model: Any, name: str) -> Any:
    """Return the default of a parameter of a model or class of models; an order of magnitude if it must be given."""
    return next(field["default"] for field in model.fields if field["name"] == name)


def optional(model: Any) -> frozenset[str]:
    """Return the numbers of a model, or of a class of models, that a file may leave out: by default they have no effect."""
    return frozenset(field["name"] for field in model.fields if field.get("optional"))


def own_paths(path: str, model: Any) -> Iterator[str]:
    """Path of every number of a model, but for those of its parts."""
    for name, kind, _ in parameters(model):
        if kind == "sequence":
            yield from (f"{path}.{name}[{i}]" for i in range(len(getattr(model, name))))
        elif kind != "choice":
            yield f"{path}.{name}"


def all_paths(path: str, model: Any) -> Iterator[str]:
    """Path of every number of a model, and of its parts."""
    yield from own_paths(path, model)
    for part in parts(model):
        yield from all_paths(f"{path}.{part.name}", getattr(model, part.name))


# ---- Origins ---------------------------------------------------------------------------------------------------------


IDENTIFIED = "identified"  # begins the source of a number that a measurement determines, alone or in combination
HEADINGS = {
    True: "identified, with one standard deviation:",
    False: "not identified, of the set before or assumed, with the spread or standard deviation that its source states:",
}


def origin_lines(models: Mapping[str, Any], sources: Mapping[str, Entry]) -> list[str]:
    """Return a line for each number of models by their names, those that were identified first; empty if none was.

    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05)
    >>> sources = {"law.coulomb": Entry("identified from a.csv", uncertainty=3e-4), "law.breakaway": Entry("maker", spread=0.3)}
    >>> print("\\n".join(origin_lines({"law": law}, sources)))
    identified, with one standard deviation:
      law.coulomb = 0.05 ± 0.0003 N.m, identified from a.csv
    not identified, of the set before or assumed, with the spread or standard deviation that its source states:
      law.breakaway = 0.05 ± 0.015 N.m
    """
    groups: dict[bool, list[str]] = {True: [], False: []}
    for path, value, unit in (number for name, model in models.items() for number in _numbers(name, model)):
        entry = sources.get(path, Entry(NOT_GIVEN))
        if entry.source != NOT_GIVEN:
            identified, sigma = entry.source.startswith(IDENTIFIED), entry.sigma(value)
            within = "" if sigma is None else f" ± {sigma:.2g}"
            line = f"  {path} = {value:.6g}{within} {unit.removesuffix('1')}".rstrip()
            is_said = identified or OPPOSITE in entry.source
            groups[identified].append(f"{line}, {entry.source}" if is_said else line)
    return [line for each, lines in groups.items() for line in (HEADINGS[each], *lines) if lines] if groups[True] else []


def _numbers(path: str, model: Any) -> Iterator[tuple[str, float, str]]:
    """Yield path, value and unit of every number of a model and its parts."""
    for name, kind, unit in parameters(model):
        if kind == "sequence":
            yield from ((f"{path}.{name}[{i}]", value, unit) for i, value in enumerate(getattr(model, name)))
        elif kind != "choice":
            yield f"{path}.{name}", getattr(model, name), unit
    for part in parts(model):
        yield from _numbers(f"{path}.{part.name}", getattr(model, part.name))
