"""Numbers with their source, as people and data sheets write them, and as files contain them."""

from __future__ import annotations

import dataclasses
import reprlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from math import hypot
from typing import TYPE_CHECKING, Any, NamedTuple, get_type_hints

from strainwave import arguments
from strainwave.files import figures
from strainwave.files.described import parameters, parts
from strainwave.files.units import check as check_unit, convert
from strainwave.messages import shortened

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

NOT_GIVEN = "not given"
OPPOSITE_SENSE = "of the log = -"  # in the source of a motor whose effort a log counts in the other sense


@dataclass(frozen=True)
class Entry:
    """Source of a number, with its spread and its standard deviation.

    Args:
        source: document, measurement or rule, one line of text; "not given" where a file leaves out the whole table
        spread: scatter of individual gears about the number, relative; None if not known
        uncertainty: standard deviation of the number, in its unit; None if not known

    Raises:
        ValueError: the source is no line of text, or a number is negative or not finite.

    >>> import strainwave as sw
    >>> entry = sw.files.Entry("maker's catalogue", spread=0.3)  # single gears scatter by 30 %
    >>> entry.sigma(31000.0), entry.assumed
    (9300.0, False)
    """

    source: str
    spread: float | None = None
    uncertainty: float | None = None

    @property
    def assumed(self) -> bool:
        """True if the number was neither measured nor published."""
        return self.source.startswith("assumed") or self.source == NOT_GIVEN

    def sigma(self, value: float) -> float | None:
        """Return the standard deviation of a value from this source; None if it states neither spread nor uncertainty."""
        stated = self.spread is not None or self.uncertainty is not None
        return hypot((self.spread or 0.0) * value, self.uncertainty or 0.0) if stated else None

    def __post_init__(self) -> None:
        check_line("source", self.source)
        for name in ("spread", "uncertainty"):
            if (number := getattr(self, name)) is not None:
                arguments.bare_number(name, number, brackets="[)", low=0.0)


@dataclass(frozen=True, kw_only=True)
class Quantity(Entry):
    """A number with its unit and its source.

    Args:
        value: the number, in `unit`
        unit: a unit that `strainwave.files.units.check` knows
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
        arguments.bare_number("value", self.value, self.unit)

    def to(self, unit: str) -> Quantity:
        """Return the quantity in another unit.

        Raises:
            ValueError: the unit is not known, or measures something else
        """
        if arguments.text("unit", unit) == self.unit:
            return self
        uncertainty = self.uncertainty
        if uncertainty is not None:  # a difference: the zeros of the units do not count
            uncertainty *= convert(1.0, self.unit, unit) - convert(0.0, self.unit, unit)
        return dataclasses.replace(self, value=convert(self.value, self.unit, unit), unit=unit, uncertainty=uncertainty)


def check_line(name: str, text: str) -> None:
    if not arguments.text(name, text).strip() or not text.isprintable():
        raise ValueError(f"{name} = {shortened(text)} must be one line of text")


# ---- Figures ---------------------------------------------------------------------------------------------------------


Figure = float | str | Quantity


def quantity_of(name: str, given: Figure, unit: str, source: str) -> Quantity:
    """A figure as a quantity in the unit it is written in.

    Args:
        name: what the figure is called
        given: a number in `unit`; a text: the number, with a decimal point or comma and perhaps a power of ten, then the unit,
            where "≤" may stand before it; or a quantity, which has a source of its own
        unit: what it must measure
        source: where it comes from

    Raises:
        TypeError: it is none of these
        ValueError: the text is not written so, the comma is ambiguous, or the unit measures something else

    >>> round(quantity_of("k1", "1.2 N·m/arcmin", "N.m/rad", "data sheet").to("N.m/rad").value, 3)
    4125.296
    >>> quantity_of("k1", "3,1 × 10^4 Nm/rad", "N.m/rad", "data sheet").value
    31000.0
    """
    if isinstance(given, Quantity):
        quantity = given
    elif isinstance(given, str):
        number, written_unit = figures.read(name, given.strip().removeprefix("<").removeprefix("≤"), unit)
        quantity = Quantity(value=number, unit=written_unit, source=source)
    else:
        quantity = Quantity(value=arguments.number(name, given, unit), unit=unit, source=source)
    figures.converted(name, quantity.value, quantity.unit, unit)  # refuses what measures something else
    return quantity


# ---- Forms -----------------------------------------------------------------------------------------------------------


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


_WANTED_TYPES = {
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
    kind, content = fault["type"], fault["input"]
    key, *inner = fault["loc"]
    attribute = next((name for name in inner if isinstance(name, str)), "")
    where = str(key) + "".join(f"[{index}]" for index in inner if isinstance(index, int))
    if kind == "extra_forbidden" and not attribute:
        return f"{key}: not a {form.noun}; it has {', '.join(form.examples)}"
    if kind == "too_long":
        return f"{where} has {len(content)} elements; at most {MAX_ELEMENTS} are read"
    hint = f"write {form.examples[str(key)]}"
    if kind == "extra_forbidden":
        return f"{where}: an entry has no {attribute}; {hint}"
    number = content.get("value") if isinstance(content, dict) else content
    if kind in ("missing", "model_type") and type(number) in (int, float):
        hint = hint.replace("value = …", f"value = {number}")
    if kind == "missing":
        return f"{where} has no {attribute}; {hint}" if attribute else f"{where} is missing; {hint}"
    what = f"{where}.{attribute}".removesuffix(".value").removesuffix(".")
    return f"{what} = {reprlib.repr(content)} must be {_WANTED_TYPES[kind]}; {hint}"


def inline(value: Any, unit: str, entry: Entry) -> Any:
    """A number, or several of one entry, as files write it."""
    import tomlkit

    stated = {key: member for key, member in dataclasses.asdict(entry).items() if member is not None}
    table = tomlkit.inline_table()
    table.update({"value": value, "unit": unit} | stated)
    return table


# ---- Origins ---------------------------------------------------------------------------------------------------------


IDENTIFIED_SOURCE = "identified"  # begins the source of a number that a measurement determines, alone or in combination
ORIGIN_HEADINGS = {
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
    for path, value, unit in (number for name, model in models.items() for number in numbers_of(name, model)):
        entry = sources.get(path, Entry(NOT_GIVEN))
        if entry.source != NOT_GIVEN:
            identified, sigma = entry.source.startswith(IDENTIFIED_SOURCE), entry.sigma(value)
            within = "" if sigma is None else f" ± {sigma:.2g}"
            line = f"  {path} = {value:.6g}{within} {unit.removesuffix('1')}".rstrip()
            is_said = identified or OPPOSITE_SENSE in entry.source
            groups[identified].append(f"{line}, {entry.source}" if is_said else line)
    return [line for each, lines in groups.items() for line in (ORIGIN_HEADINGS[each], *lines) if lines] if groups[True] else []


def numbers_of(path: str, model: Any) -> Iterator[tuple[str, float, str]]:
    """Yield path, value and unit of every number of a model and its parts."""
    for name, kind, unit in parameters(model):
        if kind == "sequence":
            yield from ((f"{path}.{name}[{i}]", value, unit) for i, value in enumerate(getattr(model, name)))
        elif kind != "choice":
            yield f"{path}.{name}", getattr(model, name), unit
    for part in parts(model):
        yield from numbers_of(f"{path}.{part.name}", getattr(model, part.name))
