"""Forms of the entries of a file of numbers with unit and source, and the errors for any other content."""

from __future__ import annotations

import dataclasses
import reprlib
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple, get_type_hints

from strainwave.files.entries import Entry, Quantity

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails


MAX_ELEMENTS = 1000  # of a list: the sequence of a law has fewer


class Form(NamedTuple):
    """Form of one place of a file: its type, an example of each key, and the name of a key."""

    noun: str
    schema: Any
    examples: Mapping[str, str]


def schema(name: str, keys: Mapping[str, Any]) -> Any:
    """A table with these keys: for each its type and the default, which is `...` where the key must be there."""
    from pydantic import ConfigDict, create_model

    return create_model(name, __config__=ConfigDict(strict=True, extra="forbid", allow_inf_nan=False), **keys)


@cache
def entry_schema(unit: str, without: tuple[str, ...] = ()) -> Any:
    """A number as files give it: the members of a Quantity, but for those left out here. Only the unit 1 need not be given."""
    types = get_type_hints(Quantity)
    keys = {"value": (types["value"], ...), "unit": (types["unit"], "1" if unit == "1" else ...)}
    for member in dataclasses.fields(Entry):
        if member.name not in without:
            keys[member.name] = (types[member.name], ... if member.default is dataclasses.MISSING else member.default)
    return schema("entry", keys)


def elements(content: Any) -> Any:
    """One entry for each number, where a sequence is written as one entry with a list of numbers."""
    if isinstance(content, dict) and isinstance(values := content.get("value"), list) and values:
        return [content | {"value": value} for value in values]
    return content


def checked(form: Form, content: Mapping[str, Any]) -> dict[str, Any]:
    """The content as plain dictionaries, once it has the form."""
    from pydantic import TypeAdapter, ValidationError

    adapter = TypeAdapter[Any](form.schema)
    try:
        plain: dict[str, Any] = adapter.dump_python(adapter.validate_python(content))
    except ValidationError as error:
        # A key that is not known comes first: misspelt, it explains why another one is missing.
        fault = min(error.errors(), key=lambda fault: fault["type"] != "extra_forbidden")
        raise ValueError(_explained(fault, form)) from None
    return plain


_WANTED = {
    "dict_type": "a table",
    "finite_number": "finite",
    "float_type": "a number",
    "int_type": "a whole number",
    "list_type": "a list",
    "model_type": "a table",
    "string_type": "a text",
}


def _explained(fault: ErrorDetails, form: Form) -> str:
    """Return the error of pydantic in the words of the file: key, value, what is allowed."""
    kind, given = fault["type"], fault["input"]
    key, *inner = fault["loc"]
    attribute = next((name for name in inner if isinstance(name, str)), "")
    where = str(key) + "".join(f"[{index}]" for index in inner if isinstance(index, int))
    if kind == "extra_forbidden" and not attribute:
        return f"{key}: not a {form.noun}; it has {', '.join(form.examples)}"
    if kind == "too_long":
        return f"{where} has {len(given)} elements; at most {MAX_ELEMENTS} are read"
    hint = f"write {form.examples[str(key)]}"
    if kind == "extra_forbidden":
        return f"{where}: an entry has no {attribute}; {hint}"
    number = given.get("value") if isinstance(given, dict) else given
    if kind in ("missing", "model_type") and type(number) in (int, float):
        hint = hint.replace("value = …", f"value = {number}")
    if kind == "missing":
        return f"{where} has no {attribute}; {hint}" if attribute else f"{where} is missing; {hint}"
    what = f"{where}.{attribute}".removesuffix(".value").removesuffix(".")
    return f"{what} = {reprlib.repr(given)} must be {_WANTED[kind]}; {hint}"


def inline(value: Any, unit: str, entry: Entry) -> Any:
    """A number, or several of one entry, as files write it."""
    import tomlkit

    known = {key: known for key, known in dataclasses.asdict(entry).items() if known is not None}
    table = tomlkit.inline_table()
    table.update({"value": value, "unit": unit} | known)
    return table
