"""Gear sets: a gear with the source of each of its numbers, read from and written to TOML.

What a table of a gear file may hold is what its model describes; no parameter is named here. What is wrong in a file is
refused in one line with file, table and key. docs/gear-files.md shows the format.
"""

from __future__ import annotations

import dataclasses
import difflib
import math
import reprlib
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, TypeVar, get_type_hints, overload

from strainwave._core import Gear
from strainwave.drives import PositionDrive
from strainwave.files import replacing
from strainwave.units import check as check_unit
from strainwave.units import convert

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

Kind = TypeVar("Kind", bound="Entry")

CATALOGUE = Path(__file__).with_name("catalogue")
NOT_GIVEN = "not given"


@dataclass(frozen=True)
class Entry:
    """Where a number comes from, and how well it is known.

    Args:
        source: document, measurement or rule, one line of text; "not given" where a file leaves out the whole table
        spread: scatter of individual gears about the number, relative; None if not known
        uncertainty: standard deviation of the number, in its unit; None if not known

    Raises:
        ValueError: the source is no line of text, or a number is negative or not finite.
    """

    source: str
    spread: float | None = None
    uncertainty: float | None = None

    def __post_init__(self) -> None:
        _check_line("source", self.source)
        for name in ("spread", "uncertainty"):
            number = getattr(self, name)
            if number is not None and not 0.0 <= number < math.inf:
                raise ValueError(f"{name} = {number} must lie in [0, inf)")


@dataclass(frozen=True, kw_only=True)
class Quantity(Entry):
    """A number with its unit and where it comes from.

    Args:
        value: the number, in `unit`
        unit: a unit that `strainwave.units.check` knows
        source, spread, uncertainty: as in `Entry`

    Raises:
        ValueError: the number is not finite, the unit is not known, or as in `Entry`.

    >>> Quantity(value=30.0, unit="rpm", source="measured on the rig").to("rad/s").value
    3.141592653589793
    """

    value: float
    unit: str

    def __post_init__(self) -> None:
        super().__post_init__()
        check_unit(self.unit)
        if not math.isfinite(self.value):
            raise ValueError(f"value = {self.value} {self.unit} must be finite")

    def to(self, unit: str) -> Quantity:
        """The same in another unit; `ValueError` where the units do not agree."""
        if unit == self.unit:
            return self
        uncertainty = self.uncertainty
        if uncertainty is not None:  # a difference: the zeros of the units do not count
            uncertainty *= convert(1.0, self.unit, unit) - convert(0.0, self.unit, unit)
        return dataclasses.replace(self, value=convert(self.value, self.unit, unit), unit=unit, uncertainty=uncertainty)


@dataclass(frozen=True)
class GearSet:
    """A gear, the source of each of its numbers, and what else is known of it.

    Args:
        name: what the gear is called, one line of text
        gear: its model
        sources: where each number of the models comes from, by path: "gear.stiffness.k1", "motor.resistance",
            "gear.hysteresis.stiffness[0]"
        maker: who makes it
        note: what else is to be said
        ratings: what the maker allows, by name; no part of the model
        motor, control, load: the rest of a drive, models of `sw.motor`, `sw.control` and `sw.loads`; None if not known

    Raises:
        ValueError: a number has no source, a source has no number, or the name is no line of text
        TypeError: a model is of the wrong family, or a source or rating not of its type

    >>> gear_set = GearSet.read("csg-20-100")
    >>> gear_set.gear.stiffness.k1, gear_set.sources["gear.stiffness.k1"].spread
    (16000.0, 0.3)
    >>> gear_set.ratings["rated_torque"].value
    52.0
    """

    name: str
    gear: Gear
    sources: Mapping[str, Entry] = field(repr=False, hash=False)
    maker: str = ""
    note: str = ""
    ratings: Mapping[str, Quantity] = field(default_factory=dict, repr=False, hash=False)
    motor: Any = None
    control: Any = None
    load: Any = None

    def __post_init__(self) -> None:
        _check_line("name", self.name)
        _drive(vars(self))  # refuses what is no model of its family
        places = list(_places(vars(self)))
        if bare := [place for place in places if place not in self.sources]:
            raise ValueError(f"{self.name}: {bare[0]} has no source")
        if extra := self.sources.keys() - set(places):
            raise ValueError(f"{self.name}: sources name {min(extra)}, which is no number of the set")
        object.__setattr__(self, "sources", _frozen(self.sources, Entry))
        object.__setattr__(self, "ratings", _frozen(self.ratings, Quantity))

    def __reduce__(self) -> tuple[partial[GearSet], tuple[()]]:
        return partial(GearSet, **vars(self) | {"sources": dict(self.sources), "ratings": dict(self.ratings)}), ()

    @property
    def drive(self) -> PositionDrive:
        """The drive that the set describes; open loop where it has no control.

        Raises:
            ValueError: the set has no motor or no load.
        """
        if missing := [name for name in ("motor", "load") if getattr(self, name) is None]:
            raise ValueError(f"{self.name} has no [{'] and no ['.join(missing)}]; a drive needs a motor and a load")
        return _drive(vars(self))

    @property
    def left_out(self) -> frozenset[str]:
        """Tables that a file of the set does without, by path: parts that do nothing, of whose numbers no source is given.

        >>> sorted(GearSet.read("hfuc-25-100").left_out)
        ['gear.friction_mesh', 'gear.kinematic_noise']
        """
        return frozenset(table.path for table, model in _filled(vars(self)) if _is_left_out(table, model, self.sources))

    @classmethod
    def of(cls, model: Gear | PositionDrive, *, name: str, source: str) -> GearSet:
        """The set of a model whose numbers all come from one source.

        Args:
            model: a gear, or a whole drive
            name: what the gear is called, one line of text
            source: where the numbers come from, one line of text

        >>> import strainwave as sw
        >>> GearSet.of(sw.Gear(damping=3.0), name="printed", source="assumed").sources["gear.damping"]
        Entry(source='assumed', spread=None, uncertainty=None)
        """
        whole = isinstance(model, PositionDrive)
        models = {part.name: getattr(model, part.name) for part in _parts(model)} if whole else {"gear": model}
        _drive(models)  # refuses what is no gear
        return cls(name=name, sources=dict.fromkeys(_places(models), Entry(source)), **models)

    @classmethod
    def read(cls, name_or_path: str | Path) -> GearSet:
        """Read a set of the catalogue by name, or a gear file by path.

        Args:
            name_or_path: a name in `catalogue()`, or a path: what ends in .toml or has a folder

        Returns:
            The set, in SI units. A table left out is the part that does nothing, its sources say "not given".

        Raises:
            ValueError: no such name or file, or what is wrong in it, with file, table and key.
        """
        path = _path(name_or_path)
        document = _document(path)
        models: dict[str, Any] = {}
        sources: dict[str, Entry] = {}
        with _at(f"{path}"):
            _checked(_head_form(), document)
        for table in _tables():
            with _at(f"{path}"):
                model, entries = _read_table(table, document.get(table.name))
            if model is not None:
                models[table.path] = model
                sources |= zip(_numbers(table, model), entries, strict=True)
        with _at(f"{path} [ratings]"):
            ratings = _read_ratings(document.get("ratings", {}))
        parts = {table.name: models.pop(table.path) for table in _tables() if table.in_gear}
        texts = {key: document[key] for key in _TEXTS if key in document}
        with _at(f"{path}"):
            gear = models.pop("gear").replace(**parts)
            return cls(gear=gear, sources=sources, ratings=ratings, **texts, **models)

    def replace(self, **changes: Any) -> GearSet:
        """The same with the named members changed; `sources` and `ratings` are replaced as a whole.

        >>> found = Entry("fitted to a friction table", uncertainty=2e-3)
        >>> gear_set = GearSet.read("hfuc-25-100")
        >>> changed = gear_set.replace(
        ...     gear=gear_set.gear.replace(damping=5.0), sources={**gear_set.sources, "gear.damping": found}
        ... )
        >>> changed.sources["gear.damping"].uncertainty
        0.002
        """
        return dataclasses.replace(self, **changes)

    def save(self, path: str | Path) -> None:
        """Write a gear file that `read` reads back equal, bit for bit.

        Args:
            path: the file, which must end in .toml

        Raises:
            ValueError: the path does not end in .toml.

        >>> import tempfile
        >>> gear_set = GearSet.read("hfuc-25-100")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     gear_set.save(f"{folder}/mine.toml")
        ...     GearSet.read(f"{folder}/mine.toml") == gear_set
        True
        """
        if Path(path).suffix != ".toml":
            raise ValueError(f"{path}: a gear file ends in .toml")
        text = _text(self)
        with replacing(path) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="\n")


def catalogue() -> list[str]:
    """Names of the gear sets that come with the package, in order.

    >>> len(catalogue()), catalogue()[0]
    (127, 'csg-14-100')
    """
    return sorted(file.stem for file in CATALOGUE.glob("*.toml"))


def load(name_or_path: str | Path) -> Gear:
    """The gear of a catalogue set or of a gear file.

    Args:
        name_or_path: a name in `catalogue()`, or a path: what ends in .toml or has a folder

    Raises:
        ValueError: as `GearSet.read`, which also gives sources, ratings, motor, control and load.

    >>> load("hfuc-25-100").stiffness.k1
    31000.0
    """
    return GearSet.read(name_or_path).gear


@overload
def save(model: GearSet, path: str | Path) -> None: ...
@overload
def save(model: Gear | PositionDrive, path: str | Path, *, name: str, source: str) -> None: ...
def save(model: GearSet | Gear | PositionDrive, path: str | Path, **naming: str) -> None:
    """Write a gear file.

    Args:
        model: a set, or a gear or a drive whose numbers all come from one source
        path: the file, which must end in .toml
        name, source: of a gear or a drive; a set has its own

    Raises:
        ValueError: the path does not end in .toml, or a text is no line of text.

    >>> import tempfile, strainwave as sw
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save(sw.Gear(damping=0.1 + 0.2), f"{folder}/mine.toml", name="mine", source="measured on my rig")
    ...     load(f"{folder}/mine.toml").damping
    0.30000000000000004
    """
    if isinstance(model, GearSet):
        model.replace(**naming).save(path)
    else:
        GearSet.of(model, **naming).save(path)


# The tables of a file, as the models describe themselves

_TEXTS = ("name", "maker", "note")


class _Table(NamedTuple):
    """A table of a gear file: the numbers of one model, without those of its parts.

    `kinds` are the models to choose from, none where there is but one. `absent` holds where the table is left out: the
    part that does nothing, or None.
    """

    name: str
    path: str
    kinds: Mapping[str, Any]
    absent: Any
    required: bool

    @property
    def in_gear(self) -> bool:
        return self.path.startswith("gear.")

    @property
    def header(self) -> str:
        """As the file writes it."""
        return f"[{self.path.removeprefix('gear.')}]"


@cache
def _tables() -> tuple[_Table, ...]:
    drive = PositionDrive()
    return tuple(_table(path, model, part) for path, model in (("gear.", drive.gear), ("", drive)) for part in _parts(model))


def _table(path: str, model: Any, part: _Part) -> _Table:
    of_gear = path == "gear." or part.name == "gear"
    default = getattr(model, part.name)
    idle = not getattr(default, "active", any(getattr(default, p.name) not in (0, ()) for p in _parameters(default)))
    absent = default if of_gear and idle else None
    return _Table(part.name, path + part.name, part.options or {}, absent, required=of_gear and not idle)


def _inner(path: str, model: Any) -> list[_Table]:
    """The tables of the models that a model, or a class of models, holds; those of a gear stand in the file by themselves."""
    if path == "gear":
        return []
    return [_Table(part.name, f"{path}.{part.name}", part.options, None, required=True) for part in _parts(model)]


class _Part(NamedTuple):
    name: str
    options: Mapping[str, Any]


def _parts(model: Any) -> list[_Part]:
    """The models that a model, or a class of models, holds, and what they may be chosen from."""
    return [_Part(field["name"], field["options"]) for field in model.fields if field["kind"] == "part"]


class _Parameter(NamedTuple):
    name: str
    kind: str
    unit: str


def _parameters(model: Any) -> list[_Parameter]:
    """What a model, or a class of models, says of its parameters; its parts have their own."""
    return [_Parameter(*map(field.get, _Parameter._fields)) for field in model.fields if field["kind"] != "part"]


def _numbers(table: _Table, model: Any) -> Iterator[str]:
    """Path of every number of a model, and of the models it holds."""
    for name, kind, _ in _parameters(model):
        if kind == "sequence":
            yield from (f"{table.path}.{name}[{i}]" for i in range(len(getattr(model, name))))
        elif kind != "choice":
            yield f"{table.path}.{name}"
    for inner in _inner(table.path, model):
        yield from _numbers(inner, getattr(model, inner.name))


def _filled(models: Mapping[str, Any]) -> Iterator[tuple[_Table, Any]]:
    """The tables that gear, motor, control and load fill, each with its model."""
    for table in _tables():
        model = getattr(models["gear"], table.name) if table.in_gear else models.get(table.name)
        if model is not None:
            yield table, model


def _places(models: Mapping[str, Any]) -> Iterator[str]:
    """Path of every number of gear, motor, control and load."""
    return (place for table, model in _filled(models) for place in _numbers(table, model))


def _drive(models: Mapping[str, Any]) -> PositionDrive:
    """The drive of these models, with the default for each that is None."""
    rest = {name: models[name] for name in ("motor", "control", "load") if models.get(name) is not None}
    return PositionDrive(gear=models["gear"], **rest)


def _check_line(name: str, text: str) -> None:
    if not isinstance(text, str):
        raise TypeError(f"{name} must be a text, not {text!r}")
    if not text.strip() or not text.isprintable():
        raise ValueError(f"{name} = {text!r} must be one line of text")


def _frozen(entries: Mapping[str, Kind], kind: type[Kind]) -> Mapping[str, Kind]:
    for key, entry in entries.items():
        if not isinstance(entry, kind):
            raise TypeError(f"{key} must have a strainwave.gear_set.{kind.__name__}, not {entry!r}")
    return MappingProxyType(dict(entries))


# Reading


def _path(name_or_path: str | Path) -> Path:
    path = Path(name_or_path)
    if isinstance(name_or_path, Path) or path.name != name_or_path or path.suffix == ".toml":
        return path
    names = catalogue()
    if name_or_path not in names:
        near = difflib.get_close_matches(name_or_path.lower(), names)
        raise ValueError(
            f'no gear set "{name_or_path}" in the catalogue{"; near it are " * bool(near)}{", ".join(near)}; '
            "strainwave.catalogue() lists all, and the path of a file ends in .toml"
        )
    return CATALOGUE / f"{name_or_path}.toml"


def _document(path: Path) -> dict[str, Any]:
    try:
        document = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path} is not valid TOML: {error}") from None
    if not document:
        raise ValueError(f"{path} is empty")
    return document


def _read_table(table: _Table, content: dict[str, Any] | None) -> tuple[Any, list[Entry]]:
    """The model that a table holds, and where its numbers come from, in the order of `_numbers`."""
    if content is None:
        return table.absent, [Entry(NOT_GIVEN) for _ in _numbers(table, table.absent)] if table.absent else []
    entries: list[Entry] = []
    with _at(table.header):
        model, content = _chosen(table, content)
        checked = _checked(_table_form(table.path, model), content)
        for name, kind, unit in _parameters(model):
            if kind != "choice":
                given = checked[name]
                with _at(f"{name}:"):
                    quantities = [Quantity(**entry).to(unit) for entry in (given if kind == "sequence" else [given])]
                values = [quantity.value for quantity in quantities]
                checked[name] = values if kind == "sequence" else values[0]
                entries += [Entry(quantity.source, quantity.spread, quantity.uncertainty) for quantity in quantities]
    for inner in _inner(table.path, model):
        checked[inner.name], its_entries = _read_table(inner, checked[inner.name])
        entries += its_entries
    with _at(table.header):
        return model(**checked), entries


def _chosen(table: _Table, content: dict[str, Any]) -> tuple[Any, dict[str, Any]]:
    """The class of the model that a table names, and the rest of the table."""
    if not table.kinds:
        return type(table.absent), content
    if "model" not in content:
        raise ValueError(f"has no model; write {_choice(table)}")
    name = str(content["model"])
    if name not in table.kinds:
        raise ValueError(f'model = "{name}" is not known; write {_choice(table)}')
    return table.kinds[name], {key: content[key] for key in content if key != "model"}


def _choice(table: _Table) -> str:
    return "model = " + " or ".join(f'"{name}"' for name in table.kinds)


def _read_ratings(content: Mapping[str, Any]) -> dict[str, Quantity]:
    examples = {key: f'{key} = {{ value = …, unit = "…", source = "…" }}' for key in content}
    checked = _checked(_Form("rating", dict[str, _entry_schema("")], examples), content)  # type: ignore[misc]
    ratings = {}
    for key, entry in checked.items():
        with _at(f"{key}:"):
            ratings[key] = Quantity(**entry)
    return ratings


@contextmanager
def _at(place: str) -> Iterator[None]:
    """Puts the place before the message of whatever is refused inside."""
    try:
        yield
    except (TypeError, ValueError) as error:
        raise ValueError(f"{place} {error}") from None


# What may be written where: pydantic types made of the models' fields


class _Form(NamedTuple):
    """What may be written in one place of a file: its type, how each key is written, and what a key is called."""

    noun: str
    schema: Any
    examples: Mapping[str, str]


@cache
def _head_form() -> _Form:
    """The texts and tables of a file."""
    keys: dict[str, Any] = dict.fromkeys(_TEXTS, (str, "")) | {"name": (str, ...), "ratings": (dict[str, Any], {})}
    examples = {key: f'{key} = "…"' for key in _TEXTS} | {"ratings": "[ratings]"}
    for table in _tables():
        keys[table.name] = (dict[str, Any], ... if table.required else {})
        examples[table.name] = f"[{table.name}]" + (f" with {_choice(table)}" if table.kinds else "")
    return _Form("part of a gear file", _schema("gear file", keys), examples)


@cache
def _table_form(path: str, model: Any) -> _Form:
    """The keys of a table with the parameters of this class of models."""
    keys: dict[str, Any] = {parameter.name: (_content(parameter), ...) for parameter in _parameters(model)}
    examples = {
        parameter.name: f"{parameter.name} = {_example(parameter, getattr(model(), parameter.name))}"
        for parameter in _parameters(model)
    }
    for inner in _inner(path, model):
        keys[inner.name] = (dict[str, Any], ...)
        examples[inner.name] = f"{inner.header} with {_choice(inner)}"
    return _Form(f"parameter of {model.name}", _schema(model.name, keys), examples)


def _content(parameter: _Parameter) -> Any:
    from pydantic import BeforeValidator

    if parameter.kind == "choice":
        return str
    number = _entry_schema(parameter.unit)
    if parameter.kind == "sequence":
        return Annotated[list[number], BeforeValidator(_elements)]  # type: ignore[valid-type]
    return number


def _elements(content: Any) -> Any:
    """One entry for each number, where a sequence is written as one entry with a list of numbers."""
    if isinstance(content, dict) and isinstance(values := content.get("value"), list) and values:
        return [content | {"value": value} for value in values]
    return content


@cache
def _entry_schema(unit: str) -> Any:
    """A number as files give it: the members of a Quantity. Only the unit 1 may be left out."""
    types = get_type_hints(Quantity)
    keys = {"value": (types["value"], ...), "unit": (types["unit"], "1" if unit == "1" else ...)}
    for member in dataclasses.fields(Entry):
        keys[member.name] = (types[member.name], ... if member.default is dataclasses.MISSING else member.default)
    return _schema("entry", keys)


def _schema(name: str, keys: Mapping[str, Any]) -> Any:
    from pydantic import ConfigDict, create_model

    return create_model(name, __config__=ConfigDict(strict=True, extra="forbid", allow_inf_nan=False), **keys)


def _example(parameter: _Parameter, default: Any) -> str:
    if parameter.kind == "choice":
        return f'"{default}"'
    unit = "" if parameter.unit == "1" else f', unit = "{parameter.unit}"'
    if parameter.kind == "sequence":
        return f'{{ value = […]{unit}, source = "…" }}, or [] for none'
    return f'{{ value = …{unit}, source = "…" }}'


def _checked(form: _Form, content: Mapping[str, Any]) -> dict[str, Any]:
    """The content as plain dictionaries, once it has the form."""
    from pydantic import TypeAdapter, ValidationError

    adapter = TypeAdapter[Any](form.schema)
    try:
        checked: dict[str, Any] = adapter.dump_python(adapter.validate_python(content))
    except ValidationError as error:
        # A key that is not known comes first: misspelt, it explains why another one is missing.
        fault = min(error.errors(), key=lambda fault: fault["type"] != "extra_forbidden")
        raise ValueError(_explained(fault, form)) from None
    return checked


_WANTED = {
    "dict_type": "a table",
    "finite_number": "finite",
    "float_type": "a number",
    "list_type": "a list",
    "model_type": "a table",
    "string_type": "a text",
}


def _explained(fault: ErrorDetails, form: _Form) -> str:
    """What pydantic found, in the words of the file: key, value, what is allowed."""
    kind, given = fault["type"], fault["input"]
    key, *inner = fault["loc"]
    attribute = next((name for name in inner if isinstance(name, str)), "")
    where = str(key) + "".join(f"[{index}]" for index in inner if isinstance(index, int))
    if kind == "extra_forbidden" and not attribute:
        return f"{key}: not a {form.noun}; it has {', '.join(form.examples)}"
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


# Writing


def _text(gear_set: GearSet) -> str:
    import tomlkit

    document = tomlkit.document()
    for key in _TEXTS:
        if text := getattr(gear_set, key):
            document.add(key, text)
    left_out = gear_set.left_out
    for table, model in _filled(vars(gear_set)):
        if table.path not in left_out:
            document.add(table.name, _written(table, model, gear_set.sources))
    if gear_set.ratings:
        ratings = document["ratings"] = tomlkit.table()
        for name, rating in gear_set.ratings.items():
            ratings.add(name, _inline(rating.value, rating.unit, rating))
    return tomlkit.dumps(document)


def _is_left_out(table: _Table, model: Any, sources: Mapping[str, Entry]) -> bool:
    """Whether a file says this without a table: the part does nothing, and no source is given for its numbers."""
    return _does_nothing(table, model) and all(sources[place].source == NOT_GIVEN for place in _numbers(table, model))


def _does_nothing(table: _Table, model: Any) -> bool:
    """Whether a table that is left out is read as this model, of a gear without its parts."""
    absent = table.absent
    return type(model) is type(absent) and all(getattr(model, p.name) == getattr(absent, p.name) for p in _parameters(model))


def _written(table: _Table, model: Any, sources: Mapping[str, Entry]) -> Any:
    """The table of a model: one line a parameter."""
    import tomlkit

    written = tomlkit.table()
    if table.kinds:
        written.add("model", model.name)
    for name, kind, unit in _parameters(model):
        value, place = getattr(model, name), f"{table.path}.{name}"
        if kind == "choice":
            written.add(name, value)
        elif kind == "sequence":
            entries = [sources[f"{place}[{i}]"] for i in range(len(value))]
            written.add(name, _inline_sequence(value, unit, entries))
        else:
            written.add(name, _inline(value, unit, sources[place]))
    for inner in _inner(table.path, model):
        written.add(inner.name, _written(inner, getattr(model, inner.name), sources))
    return written


def _inline_sequence(values: Sequence[float], unit: str, entries: Sequence[Entry]) -> Any:
    """One entry for all numbers where they have it in common, else a list with one for each."""
    import tomlkit

    if len(set(entries)) == 1:
        return _inline(list(values), unit, entries[0])
    array = tomlkit.array().multiline(len(values) > 0)
    for value, entry in zip(values, entries, strict=True):
        array.append(_inline(value, unit, entry))
    return array


def _inline(value: Any, unit: str, entry: Entry) -> Any:
    import tomlkit

    known = {key: known for key, known in dataclasses.asdict(entry).items() if known is not None}
    inline = tomlkit.inline_table()
    inline.update({"value": value, "unit": unit} | known)
    return inline
