"""JSON: series by their names, or a row for each sample, in a list or one a line."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from math import nan
from pathlib import Path
from typing import Any

import numpy as np

from strainwave.files.array_table import IN_THE_NAME, MAX_NESTING, ArrayTable, table_of
from strainwave.files.budget import ReadBudget, RefusedFile, read_regular
from strainwave.files.labels import unreadable
from strainwave.files.table_format import Format
from strainwave.messages import one_line

BYTES_OF_VALUE = 64  # that a value takes in memory as Python has it


def open_json(path: str | Path) -> ArrayTable:
    """The series of an object of lists, `{"t": […], "q": [[…], …]}`, or of rows, `[{"t": 0.0, "q": […]}, …]`.

    A number that a row lacks, or that is null in it, is nan.

    Raises:
        ValueError: the file cannot be read, or contains neither; the message gives the place

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "log.jsonl")
    ...     _ = path.write_text('{"t": 0.0, "joint": {"q": [0.1, 0.2]}}\\n{"t": 0.01, "joint": {"q": [0.1, null]}}\\n')
    ...     table = open_json(path)
    >>> [(label.name, column.tolist()) for label, column in zip(table.labels, table.columns)]
    [('t', [0.0, 0.01]), ('joint.q_1', [0.1, 0.1]), ('joint.q_2', [0.2, nan])]
    """
    file = one_line(str(path))
    try:
        data = read_regular(path)
        budget = ReadBudget(len(data))
        budget.take_bytes(BYTES_OF_VALUE * sum(map(data.count, (b",", b"[", b"{"))), "its values")
        parsed = _parsed(file, data.decode("utf-8-sig"))
        if isinstance(parsed, Mapping):
            rows = next((each for each in parsed.values() if _are_rows(each)), None)
        else:
            rows = parsed if _are_rows(parsed) else None
        if rows is not None:
            return table_of(file, _of_rows(rows, budget), budget)
        variables = parsed if isinstance(parsed, Mapping) else {"": parsed}
        return table_of(file, ((name, _numbers(each, name)) for name, each in variables.items()), budget)
    except (OSError, UnicodeError, RecursionError, RefusedFile) as error:
        raise ValueError(unreadable(path, error)) from None


def _parsed(file: str, text: str) -> Any:
    """One value, or one a line."""
    try:
        return _value(text)
    except json.JSONDecodeError as error:
        whole = error
    lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
    rows = []
    for place, (number, line) in enumerate(lines):
        try:
            rows.append(_value(line, number))
        except json.JSONDecodeError as error:
            if not rows:
                raise ValueError(f"{file} line {whole.lineno} is no JSON: {one_line(whole.msg)}") from None
            if place == len(lines) - 1:  # its writer was stopped
                break
            raise ValueError(f"{file} line {number} is no JSON: {one_line(error.msg)}") from None
    return rows


def _value(text: str, line: int = 1) -> Any:
    """The value in a text that begins in a line of the file."""
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        raise
    except ValueError:  # from int, which does not name the place
        begin = next(match.start() for match in re.finditer(r"[0-9]++", text) if len(match[0]) > sys.get_int_max_str_digits())
        at = line + text.count("\n", 0, begin)
        raise RefusedFile(f"line {at} has an integer of more than {sys.get_int_max_str_digits()} digits") from None


def _are_rows(value: Any) -> bool:
    return isinstance(value, list) and len(value) > 1 and all(isinstance(each, Mapping) for each in value)


def _of_rows(rows: Sequence[Mapping[str, Any]], budget: ReadBudget) -> Iterator[tuple[str, Any]]:
    """The series of rows, by the names that any of them has."""
    columns: dict[str, list[float]] = {}
    for place, row in enumerate(rows):
        for name, value in _flat("", row, MAX_NESTING):
            column = columns.get(name)
            if column is None:
                budget.take_bytes(len(name) + 8 * len(rows), "a column for each name in its rows")
                column = columns[name] = [nan] * place
            elif len(column) > place:  # two keys make the same name; the last is taken
                column.pop()
            elif len(column) < place:
                column += [nan] * (place - len(column))
            column.append(_float(value, f"{name} in row {place}") if type(value) is int else nan if value is None else value)
    for name, column in columns.items():
        yield name, np.array(column + [nan] * (len(rows) - len(column)))


def _flat(name: str, value: Any, depth: int) -> Iterator[tuple[str, float | None]]:
    """The numbers of a row by their names, as `joint.q_1`."""
    if isinstance(value, Mapping):
        for key, each in value.items():
            if type(each) is float and not name:
                yield key, each
            elif depth:
                yield from _flat(f"{name}.{key}" if name else key, each, depth - 1)
    elif isinstance(value, list):
        for number, each in enumerate(value, start=1) if depth else ():
            yield from _flat(f"{name}_{number}", each, depth - 1)
    elif value is None or (isinstance(value, int | float) and not isinstance(value, bool)):
        yield name, value


def _float(value: int, place: str) -> float:
    try:
        return float(value)
    except OverflowError:
        raise RefusedFile(f"{place} is an integer of {len(str(abs(value)))} digits; a number is at most 1.8e308") from None


def _numbers(value: Any, name: str) -> Any:
    """A list of numbers, or of lists of them, as an array; a table of names to such; what else there is as it stands."""
    if isinstance(value, Mapping):
        return {key: _numbers(each, f"{name}.{key}") for key, each in value.items()}
    inner = chain.from_iterable(each for each in value if isinstance(each, list)) if isinstance(value, list) else ()
    if isinstance(value, str) or (isinstance(value, list) and str in {*map(type, value), *map(type, inner)}):
        return np.array([])
    try:
        return np.array(value, float)  # None becomes nan
    except OverflowError:
        raise RefusedFile(f"{name or 'its list'} has an integer beyond the largest number, 1.8e308") from None
    except (TypeError, ValueError):
        return np.array([])


FORMAT: Format = Format(
    (".json", ".jsonl"),
    open_json,
    "JSON",
    IN_THE_NAME,
    about='series by their names, `{"t": […], "q": [[…], …]}`, or a row for each sample, in one list or one a line.',
)
