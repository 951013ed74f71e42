"""Options of verbs: numbers, and groups of options that several verbs have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import is_dataclass
from functools import wraps
from inspect import Parameter, signature
from typing import Annotated, Any

import typer

from strainwave.messages import quoted
from strainwave.number_texts import is_whole, number_in

Drive = Annotated[str, typer.Argument(help="A drive: a set of `strainwave list drives`, or a file with motor and load.")]


def with_groups(verb: Callable[..., None]) -> Callable[..., None]:
    """Return a verb with options of its own in place of each parameter that is a dataclass: one for each of its fields."""
    own = signature(verb, eval_str=True)
    kinds: dict[str, Any] = {name: each.annotation for name, each in own.parameters.items() if is_dataclass(each.annotation)}
    groups = {name: (kind, signature(kind, eval_str=True).parameters) for name, kind in kinds.items()}
    places = [groups[name][1].values() if name in groups else (each,) for name, each in own.parameters.items()]
    parameters: list[Parameter] = [each for place in places for each in place]

    @wraps(verb)
    def expanded(**arguments: Any) -> None:
        made = {
            name: group(**{option: arguments.pop(option) for option in options}) for name, (group, options) in groups.items()
        }
        verb(**made, **arguments)

    expanded.__signature__ = own.replace(parameters=parameters)  # type: ignore[attr-defined]
    expanded.__annotations__ = {each.name: each.annotation for each in parameters}
    return expanded


def folder(help: str) -> Any:
    """Return the option for the folder of the results."""
    return typer.Option("--out", "-o", help=help, file_okay=False)


def numeric(help: str) -> Any:
    """Return an option that takes a number."""
    return typer.Option(parser=number_option, help=help)


def whole(help: str) -> Any:
    """Return an option that takes a whole number."""
    return typer.Option(parser=whole_option, help=help)


def number_option(value: str | float) -> float:
    """Return the number of an option; one that is not given stands for itself.

    Raises:
        typer.BadParameter: it is no number
    """
    if isinstance(value, float):
        return value
    try:
        return number_in(value)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


def whole_option(value: str | int) -> int:
    """Return the whole number of an option; one that is not given stands for itself.

    Raises:
        typer.BadParameter: it is no whole number
    """
    if isinstance(value, int):
        return value
    if not is_whole(value):
        raise typer.BadParameter(f"{quoted(value)} is no whole number; write digits, at most 18")
    return int(value)


def changed_number(option: str, text: str, example: str = "load.inertia=0.6") -> tuple[str, float | str]:
    """Return the path and the value of a number that an option changes.

    >>> changed_number("--set", "load.inertia=0.6")
    ('load.inertia', 0.6)
    """
    path, equals, value = text.partition("=")
    if not (path and equals and value):
        raise ValueError(f"{option} {text}: write it as {option} {example}")
    if is_whole(value):
        return path, int(value)
    try:
        float(value)  # nan and other digits than ASCII are no words of a model either
    except ValueError:
        return path, value
    return path, number_in(value)
