"""Results for a person: one line, a table, a notebook's HTML with the picture, and plain data, all from one list of rows."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from importlib import import_module
from itertools import chain, count
from math import isfinite, isnan, nan
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from strainwave import typeset
from strainwave.messages import one_line, shortened

if TYPE_CHECKING:
    from pathlib import Path

    import pandas
    from matplotlib.figure import Figure

Value = float | str | tuple[float, float] | None

MAX_REPR = 120  # characters
PAGE_WIDTH = 80  # characters of a line of a table
MAX_NAME_WIDTH = 32  # characters; a longer name has a line of its own
MIN_NOTE_WIDTH = 24  # characters; a note with less room stands below its row
MAX_PRINTED_ROWS = 500  # of a table; data and frames have all
MAX_LISTED_NUMBERS = 4  # of an array; of a longer one both ends of its range are stated
PLAIN_DIGITS = 5  # of a number without a standard deviation
COUNT_DIGITS = 9  # of a whole number without a unit, as the counts of an encoder
FIELDS_BESIDE_ROWS = ("remarks", "unit", "units")  # shown next to the rows, or within them
_ATTRIBUTE = re.compile(r"^ {8}(\w[\w, ]*): (.*(?:\n {12}.*)*)", re.MULTILINE)  # of a docstring
_UNIT = re.compile(r"\[([^\]\s]+)\]")


class Row(NamedTuple):
    """A row of a table.

    Attributes:
        name: of the quantity
        value: a number, a text, both ends of a range, or None if it is not known
        unit: of the number
        sigma: standard deviation; not a number without one
        note: what else to know of it
    """

    name: str
    value: Value
    unit: str = ""
    sigma: float = nan
    note: str = ""


class Presented:
    """Base of results. A subclass states its `_headline` and its `_rows`; all forms follow from these.

    Without rows of its own, a dataclass has one for each field, with the unit that its docstring states as [unit].
    """

    __slots__ = ()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "__repr__" not in vars(cls):  # before `dataclass` writes one with every field
            cls.__repr__ = Presented.__repr__  # type: ignore[method-assign]

    def _headline(self) -> str:
        """Return what it is of and the verdict, in one line."""
        return in_one_line(self._rows())

    def _rows(self) -> Iterable[Row]:
        """Return the rows of the table."""
        return rows_of_fields(self)

    def _remarks(self) -> Iterable[str]:
        """Return sentences below the table."""
        return getattr(self, "remarks", ())

    def __repr__(self) -> str:
        """One line of at most 120 characters: what it is, of what, and the verdict."""
        name = type(self).__name__
        return f"<{name}: {cut(one_line(self._headline()), MAX_REPR - len(name) - 4)}>"

    def __str__(self) -> str:
        """The result as a table of at most 80 columns."""
        head = wrapped(f"{getattr(self, '_title', type(self).__name__)}: {one_line(self._headline())}")
        rows = list(self._rows())
        more = len(rows) - MAX_PRINTED_ROWS
        table = [*aligned(rows[:MAX_PRINTED_ROWS]), *([f"… and {more} more: to_dict() has all"] if more > 0 else [])]
        remarks = [line for remark in self._remarks() for line in wrapped(f"note: {one_line(remark)}")]
        return "\n".join([*head, *(f"  {line}" for line in table), *remarks])

    def _repr_html_(self) -> str:
        """The table, with the picture if there is one, for a light or a dark notebook."""
        from strainwave.drawing.notebook import html

        rows = list(self._rows())
        table = [_cells(row) for row in rows[:MAX_PRINTED_ROWS]]
        more = len(rows) - len(table)
        return html(type(self).__name__, self._headline(), table, more, list(self._remarks()), self._picture())

    def _picture(self) -> Figure | None:
        """Return the picture for a notebook; None if there is nothing to draw."""
        if not hasattr(self, "plot"):
            return None
        try:
            return self.plot()  # type: ignore[no-any-return]
        except ValueError:  # nothing to draw
            return None

    def to_dict(self) -> dict[str, Any]:
        """Return the result in the types that JSON has: every row by its name, in full precision.

        Returns:
            `type`, `summary`, `remarks`, and `rows`: by name `value`, `unit`, `sigma` and `note`. None is no number, a pair is
            a range
        """
        return {
            "type": type(self).__name__,
            "summary": self._headline(),
            "rows": {name: _entry(row) for name, row in named_apart(self._rows())},
            "remarks": list(self._remarks()),
        }

    def to_frame(self) -> pandas.DataFrame:
        """Return the rows as a frame of pandas: value, sigma, unit and note, by name.

        Raises:
            ImportError: pandas is not installed
        """
        try:
            import pandas
        except ImportError:
            raise ImportError("to_frame needs pandas, which is not installed; to_dict() needs nothing") from None
        entries = dict(named_apart(self._rows()))
        columns = ("value", "sigma", "unit", "note")
        cells = [[getattr(row, column) for column in columns] for row in entries.values()]
        return pandas.DataFrame(cells, index=pandas.Index(list(entries), name="name"), columns=list(columns))


class Statement(Presented):
    """Base of results that are one sentence, and print as that."""

    __slots__ = ()

    def __str__(self) -> str:
        return self._headline()


class Pictured(Presented):
    """Base of results that have a picture."""

    __slots__ = ()

    @abstractmethod
    def plot(self) -> Figure:
        """Return the picture as a figure of matplotlib.

        Raises:
            ValueError: there is nothing to draw
        """


class Reported:
    """Base of results that have a report."""

    __slots__ = ()
    _report_module: ClassVar[str] = "strainwave.report.files_of"  # by name, as rooms of results know nothing of reports

    def report(self, folder: str | Path) -> Path:
        """Write the report of the result and its files, as the command does.

        Args:
            folder: where to; files of the same names are replaced

        Returns:
            the page, `report.html`

        Raises:
            OSError: a file cannot be written
        """
        from pathlib import Path

        from strainwave.files.writing import write_folder

        write_folder(Path(folder), import_module(self._report_module).files_of(self))
        return Path(folder) / "report.html"


# ---- Rows of a dataclass ---------------------------------------------------------------------------------------------


def rows_of_fields(result: Any) -> Iterator[Row]:
    """Yield a row for each field of a dataclass, with the unit that its docstring states."""
    from dataclasses import fields

    names = [field.name for field in fields(result) if not field.name.startswith("_")]
    units = _units(type(result).__doc__ or "")
    for name in names:
        base = name.removesuffix("_sigma") if name != "sigma" else "value"
        if name in FIELDS_BESIDE_ROWS or (base != name and base in names):
            continue
        sigma = getattr(result, "sigma" if name == "value" else f"{name}_sigma", nan)
        unit = units.get(name, "")
        unit = str(getattr(result, "unit", "")) if unit == "unit" or (not unit and name == "value") else unit
        of_items = getattr(result, "units", {})
        value = getattr(result, name)
        if isinstance(value, Mapping) and isinstance(of_items, Mapping):
            for key, item in value.items():
                yield from rows_of(f"{name} {key}".replace("_", " "), item, of_items.get(key, unit))
        else:
            yield from rows_of(name.replace("_", " "), value, unit, sigma if isinstance(sigma, float) else nan)


@cache
def _units(doc: str) -> Mapping[str, str]:
    """Return the unit of each field, as the docstring of its class states it: `name: meaning [unit]`."""
    units: dict[str, str] = {}
    for names, text in _ATTRIBUTE.findall(doc):
        if unit := _UNIT.search(text):
            units |= dict.fromkeys(names.split(", "), unit[1])
    return units


def rows_of(name: str, value: Any, unit: str = "", sigma: float = nan) -> Iterator[Row]:
    """Yield the rows of a value of any type: of a number one, of a mapping or sequence one for each item."""
    if value is None or isinstance(value, bool | int | float):
        yield Row(name, value, unit, sigma)
    elif isinstance(value, complex):
        yield Row(name, abs(value), unit, sigma, f"at {typeset.number(_degrees(value), 4)}°")
    elif isinstance(value, str | PathLike):
        yield from [Row(name, one_line(str(value)))] if str(value) else []
    elif isinstance(getattr(value, "value", None), float) and isinstance(getattr(value, "sigma", None), float):
        yield Row(name, value.value, getattr(value, "unit", unit), value.sigma)
    elif hasattr(value, "_headline"):
        yield Row(name, value._headline())
    elif hasattr(value, "dtype"):
        yield from _rows_of_array(name, value, unit)
    elif isinstance(value, Mapping):
        for key, item in value.items():
            yield from rows_of(f"{name} {key}", item, unit)
    elif isinstance(value, Sequence):
        yield from _rows_of_sequence(name, value, unit)
    elif not callable(value):
        yield Row(name, shortened(value))


def _degrees(value: complex) -> float:
    from cmath import phase
    from math import degrees

    return degrees(phase(value))


def _rows_of_array(name: str, values: Any, unit: str) -> Iterator[Row]:
    """Yield one row: few numbers, the range of many, or how many of them are true."""
    if values.ndim == 0:
        yield from rows_of(name, values.item(), unit)
    elif values.dtype.kind == "b":
        yield Row(name, f"{int(values.sum())} of {values.size}")
    elif values.dtype.kind not in "fiu" or values.size == 0:
        yield Row(name, f"{' × '.join(map(str, values.shape))} values")
    else:
        finite = values[abs(values) < float("inf")]
        ends = (float(finite.min()), float(finite.max())) if finite.size else (nan, nan)
        yield Row(name, ends, unit, note=f"{' × '.join(map(str, values.shape))} values")


def _rows_of_sequence(name: str, items: Sequence[Any], unit: str) -> Iterator[Row]:
    if all(isinstance(item, str) for item in items):
        yield from [Row(name, ", ".join(map(one_line, items)))] if items else []
    elif all(isinstance(item, float | int) for item in items):
        if len(items) <= MAX_LISTED_NUMBERS:
            for place, item in enumerate(items):
                yield Row(f"{name}[{place}]", item, unit)
        else:
            yield Row(name, (float(min(items)), float(max(items))), unit, note=f"{len(items)} values")
    else:
        for place, item in enumerate(items):
            label = next((text for each in ("label", "path", "name") if isinstance(text := getattr(item, each, None), str)), "")
            yield from rows_of(label or f"{name}[{place}]", item, unit)


def named_apart(rows: Iterable[Row]) -> Iterator[tuple[str, Row]]:
    """Yield each row with its name, which is numbered if another row has it."""
    used = set[str]()
    for row in rows:
        names = chain([row.name], (f"{row.name} ({number})" for number in count(2)))
        name = next(each for each in names if each not in used)
        used.add(name)
        yield name, row


def _entry(row: Row) -> dict[str, Any]:
    value: Any = [_finite(end) for end in row.value] if isinstance(row.value, tuple) else _finite(row.value)
    return {"value": value, "unit": row.unit, "sigma": _finite(row.sigma), "note": row.note}


def _finite(value: Any) -> Any:
    """Return a value as JSON has it, without infinite numbers."""
    value = value.item() if hasattr(value, "item") else value
    return None if isinstance(value, float) and not isfinite(value) else value


# ---- Text ------------------------------------------------------------------------------------------------------------


def number_text(row: Row) -> str:
    """Return the number of a row with its standard deviation; its text if it has no number.

    >>> number_text(Row("k1", 31234.0, "N.m/rad", 870.0)), number_text(Row("speed", (0.0, 2.5))), number_text(Row("time", None))
    ('31230 ± 870', '0 to 2.5', '—')
    >>> number_text(Row("counts", 131072.0)), number_text(Row("k1", 131072.0, "N.m/rad"))
    ('131072', '131070')
    """
    value = row.value
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return " to ".join(typeset.number(float(end), PLAIN_DIGITS) for end in value)
    if value is None or isinstance(value, str):
        return value or "—"
    if isnan(value):
        return "—"
    if row.sigma >= 0.0:
        return typeset.uncertain(value, row.sigma)
    is_count = row.unit in ("", "1") and float(value).is_integer()
    return typeset.number(value, COUNT_DIGITS if is_count else PLAIN_DIGITS)


def _cells(row: Row) -> tuple[str, ...]:
    """Return name, number, unit and note of a row; name and text if it has no number."""
    if isinstance(row.value, str):
        return row.name, ", ".join(filter(None, (row.value, row.note)))
    return row.name, number_text(row), typeset.unit(row.unit), row.note


def in_one_line(rows: Iterable[Row]) -> str:
    """Return the first rows as one line, as many as fit."""
    line = ""
    for row in rows:
        cell = f"{row.name} {number_text(row)} {typeset.unit(row.unit)}".rstrip()
        if len(line) + len(cell) > MAX_REPR:
            break
        line = f"{line}, {cell}" if line else cell
    return line


def aligned(rows: Sequence[Row]) -> Iterator[str]:
    """Yield rows as lines of at most 78 columns: name, number, unit and note; a text begins where numbers do."""
    import textwrap

    width = PAGE_WIDTH - 2
    rows = [Row(one_line(row.name), row.value, row.unit, row.sigma, one_line(row.note)) for row in rows]
    numbers = [row for row in rows if not isinstance(row.value, str)]
    names = max((len(row.name) for row in rows if len(row.name) <= MAX_NAME_WIDTH), default=0)
    values = max((len(number_text(row)) for row in numbers), default=0)
    units = max((len(typeset.unit(row.unit)) for row in numbers), default=0)
    for row in rows:
        name = row.name
        if len(name) > names:
            yield from textwrap.wrap(name, width)
            name = ""
        if isinstance(row.value, str):
            words = one_line(_cells(row)[1]) or "—"
            indent = names + 2
            yield from textwrap.wrap(words, width, initial_indent=f"{name:<{indent}}", subsequent_indent=" " * indent)
            continue
        line = f"{name:<{names}}  {number_text(row):>{values}}  {typeset.unit(row.unit):<{units}}"
        indent = len(line) + 2
        if row.note and width - indent >= min(MIN_NOTE_WIDTH, len(row.note)):
            yield from textwrap.wrap(row.note, width, initial_indent=f"{line}  ", subsequent_indent=" " * indent)
        else:
            yield line.rstrip()
            yield from textwrap.wrap(row.note, width, initial_indent="    ", subsequent_indent="    ")


def wrapped(text: str) -> list[str]:
    """Return a sentence as lines of at most 80 columns, all but the first indented."""
    import textwrap

    return textwrap.wrap(text, PAGE_WIDTH, subsequent_indent="  ")


def counted(count: int, noun: str) -> str:
    """Return a count with its noun.

    >>> counted(1, "file"), counted(2, "file")
    ('1 file', '2 files')
    """
    return f"{count} {noun}{'' if count == 1 else 's'}"


def cut(text: str, length: int) -> str:
    """Return a text, or its beginning if it is longer.

    >>> cut("a long sentence", 8)
    'a long …'
    """
    return text if len(text) <= length else f"{text[: length - 2].rstrip(' ,;:(')} …"
