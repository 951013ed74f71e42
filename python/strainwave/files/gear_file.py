"""Gear files: what may be written where, and how a set is read from TOML and written to it.

What a table may hold is what its model describes; no parameter is named here. What is wrong in a file is refused in one line
with file, table and key. docs/reference/gear-files.md shows the format.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Protocol

from strainwave import Drive, Gear
from strainwave.files.budget import MAX_DEPTH, RefusedFile, read_regular
from strainwave.files.described import ParameterField, PartField, all_paths, default_of, optional, own_paths, parameters, parts
from strainwave.files.entries import (
    MAX_ELEMENTS,
    NOT_GIVEN,
    Entry,
    Form,
    Quantity,
    checked,
    elements,
    entry_schema,
    inline,
    origin_lines,
    schema,
)
from strainwave.files.identified_tables import (
    Covariance,
    Validation,
    covariance_table,
    read_covariance,
    read_validation,
    validation_tables,
)
from strainwave.files.writing import replacing
from strainwave.messages import one_line, quoted

Sources = dict[str, Entry]


class Contents(Protocol):
    """Content of a file, as members of a gear set."""

    @property
    def note(self) -> str: ...
    @property
    def gear(self) -> Gear: ...
    @property
    def sources(self) -> Mapping[str, Entry]: ...
    @property
    def ratings(self) -> Mapping[str, Quantity]: ...
    @property
    def covariance(self) -> Covariance | None: ...
    @property
    def validation(self) -> tuple[Validation, ...]: ...


ACCEPTED = "Accepted in spite of failed checks"  # begins what the note of a gear says of them
MAX_TOML_BYTES = 2**21  # of a gear or mapping file: a covariance of 200 parameters takes half of it
_TEXT_KEYS = ("name", "maker", "note")
_PART_OF_KEY = r"""(?:"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|(?<![\w-])[\w-]++)[ \t]*+"""
_LONG_KEY = re.compile(rf"(?:{_PART_OF_KEY}\.[ \t]*+){{{MAX_DEPTH}}}")


def read(content: Mapping[str, Any]) -> dict[str, Any]:
    """Return the members of the set in a file; a `ValueError` names the table and key of a fault."""
    checked(_head_form(), content)
    models, sources = _read_models(content)
    with at("[ratings]"):
        ratings = _read_ratings(content.get("ratings", {}))
    with at("[covariance]"):
        covariance = None if content.get("covariance") is None else read_covariance(content["covariance"])
    with at("[[validation]]"):
        validation = read_validation(content.get("validation", ()))
    texts = {key: content[key] for key in _TEXT_KEYS if key in content}
    return {"sources": sources, "ratings": ratings, "covariance": covariance, "validation": validation, **texts, **models}


def write(gear_set: Contents, path: Path) -> None:
    """Write a file that `read` reads back equal, bit for bit; `ValueError` where its name does not end in .toml."""
    if path.suffix != ".toml":
        raise ValueError(one_line(f"{path}: a gear file ends in .toml"))
    content = text(gear_set)
    with replacing(path) as file:
        file.write(content.encode())


def left_out(gear_set: Contents) -> frozenset[str]:
    """Tables that the file of a set does without, by path."""
    return frozenset(table.path for table, model in _filled(gear_set) if _is_left_out(table, model, gear_set.sources))


def origins(gear_set: Contents) -> list[str]:
    """Return lines that state which numbers of a set were identified, the others, and where the files were measured.

    Empty if none was identified.
    """
    names = dict.fromkeys(table.path.partition(".")[0] for table in _tables())
    models = {name: getattr(gear_set, name) for name in names}
    lines = origin_lines({name: model for name, model in models.items() if model is not None}, gear_set.sources)
    if not lines or not (ranges := measured_ranges(gear_set)):
        return lines
    accepted = "; a check failed, as its note states" if ACCEPTED in gear_set.note else ""
    return [
        *lines,
        f"identified numbers were measured by, and nothing checks them beyond{accepted}:",
        *(f"  {each}" for each in ranges),
    ]


def measured_ranges(gear_set: Contents) -> list[str]:
    """Return the range of speed, torque, angle and temperature of each file that a gear was identified from, in words."""
    return list(dict.fromkeys(words for each in gear_set.validation if (words := each.range_in_words)))


def idle(gear_set: Contents) -> list[str]:
    """Path of every number without effect, which a file may do without: those of the parts that do nothing, and some others."""
    filled = list(_filled(gear_set))
    of_parts = [path for table, model in filled if _does_nothing(table, model) for path in own_paths(table.path, model)]
    return of_parts + [path for table, model in filled for name in at_rest(model) for path in _paths_of(table, model, name)]


def optional_tables(kind: type[Any]) -> frozenset[str]:
    """Return the names of the parts of a class of models whose tables a file may leave out.

    >>> import strainwave as sw
    >>> sorted(set(sw.Gear.fields[i]["name"] for i in range(5)) & optional_tables(sw.Gear))
    ['hysteresis', 'kinematic_error', 'kinematic_noise']
    """
    own = {Gear: [each for each in _tables() if each.in_gear], Drive: [each for each in _tables() if not each.in_gear]}
    return frozenset(table.name for table in own.get(kind, _inner("", kind)) if not table.required)


def at_rest(model: Any) -> list[str]:
    """Return the numbers of a model that a file may leave out, and that have the value which they then have."""
    return [name for name in sorted(optional(model)) if getattr(model, name) == default_of(model, name)]


def _paths_of(table: _Table, model: Any, name: str) -> list[str]:
    """Return the path of a number, or of each number of a sequence."""
    place = f"{table.path}.{name}"
    return [path for path in own_paths(table.path, model) if path == place or path.startswith(f"{place}[")]


# The tables of a file, as the models describe themselves


class _Table(NamedTuple):
    """A table of a gear file: the numbers of one model, without those of its parts.

    `kinds` are the models to choose from, none where there is but one, `only`. `absent` holds where the table is left out:
    the part that does nothing, or None.
    """

    name: str
    path: str
    kinds: Mapping[str, Any]
    only: Any
    absent: Any
    required: bool

    @property
    def in_gear(self) -> bool:
        return self.path.startswith("gear.")

    @property
    def header(self) -> str:
        """Return the header of the table in the file."""
        return f"[{self.path.removeprefix('gear.')}]"


@cache
def _tables() -> tuple[_Table, ...]:
    drive = Drive()
    return tuple(_table(path, model, part) for path, model in (("gear.", drive.gear), ("", drive)) for part in parts(model))


def _table(path: str, model: Any, part: PartField) -> _Table:
    of_gear = path == "gear." or part.name == "gear"
    default = getattr(model, part.name)
    idle = not getattr(default, "active", any(getattr(default, p.name) not in (0, ()) for p in parameters(default)))
    absent = default if of_gear and idle else None
    return _Table(part.name, path + part.name, part.options or {}, type(default), absent, required=of_gear and not idle)


def _inner(path: str, model: Any) -> list[_Table]:
    """The tables of the models that a model, or a class of models, holds; those of a gear stand in the file by themselves."""
    if path == "gear":
        return []
    tables = []
    for part in parts(model):
        default = default_of(model, part.name)
        # one without numbers, so without a source, or that does nothing
        absent = default if not (getattr(default, "active", True) and list(all_paths("", default))) else None
        tables.append(_Table(part.name, f"{path}.{part.name}", part.options or {}, type(default), absent, absent is None))
    return tables


def _filled(gear_set: Contents) -> Iterator[tuple[_Table, Any]]:
    """The tables that a set fills, each with its model."""
    for table in _tables():
        model = getattr(gear_set.gear if table.in_gear else gear_set, table.name)
        if model is not None:
            yield table, model


# Reading


def document(path: Path) -> dict[str, Any]:
    """Return the content of a TOML file; `ValueError` if it cannot be read, is no TOML or is empty."""
    try:
        text = read_regular(path, MAX_TOML_BYTES).decode("utf-8-sig")
        if _LONG_KEY.search(text):
            raise RefusedFile(f"contains a key of more than {MAX_DEPTH} parts")  # which tomllib reads in quadratic memory
        content = tomllib.loads(text)
    except RefusedFile:
        raise
    except OSError as error:
        raise ValueError(one_line(f"cannot be read: {error.strerror}")) from None
    except (tomllib.TOMLDecodeError, UnicodeError, RecursionError) as error:
        raise ValueError(one_line(f"is not valid TOML: {error}")) from None
    except ValueError:  # that Python has of a whole number, which is the last thing that it can be
        raise ValueError("contains a whole number with too many digits") from None
    if not content:
        raise ValueError("is empty")
    return content


def _read_models(document: Mapping[str, Any]) -> tuple[dict[str, Any], Sources]:
    """The parts of a drive, as far as there are, and where their numbers come from, by path."""
    models: dict[str, Any] = {}
    sources: Sources = {}
    for table in _tables():
        model, its_sources = _read_table(table, document.get(table.name))
        sources |= its_sources
        if model is not None:
            models[table.path] = model
    parts_of_gear = {table.name: models.pop(table.path) for table in _tables() if table.in_gear}
    return models | {"gear": models["gear"].replace(**parts_of_gear)}, sources


def _read_table(table: _Table, content: dict[str, Any] | None) -> tuple[Any, Sources]:
    """The model that a table holds, and where its numbers come from, by path."""
    if content is None:
        absent = table.absent
        return absent, dict.fromkeys(own_paths(table.path, absent), Entry(NOT_GIVEN)) if absent else {}
    sources: Sources = {}
    with at(table.header):
        model, content = _chosen(table, content)
        members = checked(_table_form(table.path, model), content)
        for parameter in parameters(model):
            content_of = members[parameter.name]
            if content_of is None:
                members[parameter.name] = default_of(model, parameter.name)
                its_sources = {} if parameter.kind == "sequence" else {f"{table.path}.{parameter.name}": Entry(NOT_GIVEN)}
            else:
                members[parameter.name], its_sources = _read_parameter(table.path, parameter, content_of)
            sources |= its_sources
    for inner in _inner(table.path, model):
        members[inner.name], its_sources = _read_table(inner, members[inner.name])
        sources |= its_sources
    with at(table.header):
        return model(**members), sources


def _read_parameter(path: str, parameter: ParameterField, given: Any) -> tuple[Any, Sources]:
    """The value of a parameter in its unit, and where its numbers come from, by path."""
    name, kind, unit = parameter
    if kind == "choice":
        return given, {}
    is_sequence = kind == "sequence"
    with at(f"{name}:"):
        quantities = [Quantity(**entry).to(unit) for entry in (given if is_sequence else [given])]
    values = [quantity.value for quantity in quantities]
    entries = [Entry(quantity.source, quantity.spread, quantity.uncertainty) for quantity in quantities]
    if is_sequence:
        return values, {f"{path}.{name}[{i}]": entry for i, entry in enumerate(entries)}
    return values[0], {f"{path}.{name}": entries[0]}


def _chosen(table: _Table, content: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """The class of the model that a table names, and the rest of the table."""
    if not table.kinds:
        return table.only, content
    if "model" not in content:
        raise ValueError(f"has no model; write {_choice(table)}")
    name = str(content["model"])
    if name not in table.kinds:
        raise ValueError(f"model = {quoted(name)} is not known; write {_choice(table)}")
    return table.kinds[name], {key: content[key] for key in content if key != "model"}


def _choice(table: _Table) -> str:
    return "model = " + " or ".join(f'"{name}"' for name in table.kinds)


def _read_ratings(content: Mapping[str, Any]) -> dict[str, Quantity]:
    examples = {key: f'{key} = {{ value = …, unit = "…", source = "…" }}' for key in content}
    entries = checked(Form("rating", dict[str, entry_schema("")], examples), content)  # type: ignore[misc]
    ratings = {}
    for key, entry in entries.items():
        with at(f"{key}:"):
            ratings[key] = Quantity(**entry)
    return ratings


@contextmanager
def at(place: str) -> Iterator[None]:
    """Put the place before the message of whatever is refused inside."""
    try:
        yield
    except (TypeError, ValueError) as error:
        raise ValueError(one_line(f"{place} {error}")) from None


# What may be written where: pydantic types made of the models' fields


@cache
def _head_form() -> Form:
    """The texts and tables of a file."""
    keys: dict[str, Any] = dict.fromkeys(_TEXT_KEYS, (str, "")) | {"name": (str, ...), "ratings": (dict[str, Any], {})}
    keys |= {"covariance": (dict[str, Any] | None, None), "validation": (list[dict[str, Any]], [])}
    examples = {key: f'{key} = "…"' for key in _TEXT_KEYS} | {"ratings": "[ratings]"}
    examples |= {"covariance": "[covariance]", "validation": "[[validation]]"}
    for table in _tables():
        keys[table.name] = (dict[str, Any], ... if table.required else {})
        examples[table.name] = f"[{table.name}]{_with_model(table)}"
    return Form("part of a gear file", schema("gear file", keys), examples)


@cache
def _table_form(path: str, model: Any) -> Form:
    """The keys of a table with the parameters of this class of models."""
    keys: dict[str, Any] = {parameter.name: (_content(parameter), ...) for parameter in parameters(model)}
    keys |= {name: (kind | None, None) for name, (kind, _) in keys.items() if name in optional(model)}
    examples = {
        parameter.name: f"{parameter.name} = {_example(parameter, default_of(model, parameter.name))}"
        for parameter in parameters(model)
    }
    for inner in _inner(path, model):
        keys[inner.name] = (dict[str, Any], ...) if inner.required else (dict[str, Any] | None, None)
        examples[inner.name] = f"{inner.header}{_with_model(inner)}"
    return Form(f"parameter of {model.name}", schema(model.name, keys), examples)


def _with_model(table: _Table) -> str:
    """Return the choice of models of a table in words; empty if there is none."""
    return f" with {_choice(table)}" if table.kinds else ""


def _content(parameter: ParameterField) -> Any:
    from pydantic import BeforeValidator, Field

    if parameter.kind == "choice":
        return str
    number = entry_schema(parameter.unit)
    if parameter.kind == "sequence":
        return Annotated[list[number], Field(max_length=MAX_ELEMENTS), BeforeValidator(elements)]  # type: ignore[valid-type]
    return number


def _example(parameter: ParameterField, default: Any) -> str:
    if parameter.kind == "choice":
        return f'"{default}"'
    unit = "" if parameter.unit == "1" else f', unit = "{parameter.unit}"'
    if parameter.kind == "sequence":
        return f'{{ value = […]{unit}, source = "…" }}, or [] for none'
    return f'{{ value = …{unit}, source = "…" }}'


# Writing


def text(gear_set: Contents) -> str:
    """Return the text of the file of a set."""
    import tomlkit

    document = tomlkit.document()
    for line in origins(gear_set):
        document.add(tomlkit.comment(line))
    for key in _TEXT_KEYS:
        if written := getattr(gear_set, key):
            document.add(key, written)
    for table, model in _filled(gear_set):
        if not _is_left_out(table, model, gear_set.sources):
            document.add(table.name, _written(table, model, gear_set.sources))
    if gear_set.ratings:
        ratings = document["ratings"] = tomlkit.table()
        for name, rating in gear_set.ratings.items():
            ratings.add(name, inline(rating.value, rating.unit, rating))
    if gear_set.covariance is not None:
        document["covariance"] = covariance_table(gear_set.covariance)
    if gear_set.validation:
        document["validation"] = validation_tables(gear_set.validation)
    return tomlkit.dumps(document)


def _is_left_out(table: _Table, model: Any, sources: Mapping[str, Entry]) -> bool:
    """True if a file omits this table: the part does nothing, and no source is given for its numbers."""
    return _does_nothing(table, model) and all(sources[path].source == NOT_GIVEN for path in own_paths(table.path, model))


def _does_nothing(table: _Table, model: Any) -> bool:
    """True if a table that is left out is read as this model, of a gear without its parts."""
    absent = table.absent
    return type(model) is type(absent) and all(getattr(model, p.name) == getattr(absent, p.name) for p in parameters(model))


def _written(table: _Table, model: Any, sources: Mapping[str, Entry]) -> Any:
    """The table of a model: one line a parameter."""
    import tomlkit

    written = tomlkit.table()
    if table.kinds:
        written.add("model", model.name)
    for name, kind, unit in parameters(model):
        value, place = getattr(model, name), f"{table.path}.{name}"
        if name in at_rest(model) and all(sources[path].source == NOT_GIVEN for path in _paths_of(table, model, name)):
            continue
        if kind == "choice":
            written.add(name, value)
        elif kind == "sequence":
            entries = [sources[f"{place}[{i}]"] for i in range(len(value))]
            written.add(name, _inline_sequence(value, unit, entries))
        else:
            written.add(name, inline(value, unit, sources[place]))
    for inner in _inner(table.path, model):
        if not _is_left_out(inner, part := getattr(model, inner.name), sources):
            written.add(inner.name, _written(inner, part, sources))
    return written


def _inline_sequence(values: Sequence[float], unit: str, entries: Sequence[Entry]) -> Any:
    """One entry for all numbers where they have it in common, else a list with one for each."""
    import tomlkit

    if len(set(entries)) == 1:
        return inline(list(values), unit, entries[0])
    array = tomlkit.array().multiline(len(values) > 0)
    for value, entry in zip(values, entries, strict=True):
        array.append(inline(value, unit, entry))
    return array
