"""Descriptions of parts and numbers by the models."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple


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


def is_required(model: Any, name: str) -> bool:
    """True for a parameter that whoever makes the model must give."""
    return any(field["name"] == name and field["required"] for field in model.fields)


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
