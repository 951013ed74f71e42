"""JSON: series by their names, or a row for each sample, in a list or one a line."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import unreadable
from strainwave.files.variables import table_of
from strainwave.messages import one_line


def open_json(path: str | Path) -> ArrayTable:
    """The series of an object of lists, `{"t": […], "q": [[…], …]}`, or of rows, `[{"t": 0.0, "q": […]}, …]`.

    A number that a row lacks, or that is null in it, is nan.

    Raises:
        ValueError: the file cannot be read, or holds neither; says where

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
        found = _parsed(file, Path(path).read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeError, RecursionError) as error:
        raise ValueError(unreadable(path, error)) from None
    if isinstance(found, Mapping):
        rows = next((each for each in found.values() if _are_rows(each)), None)
        return table_of(file, _of_rows(rows) if rows is not None else ((name, _numbers(each)) for name, each in found.items()))
    if _are_rows(found):
        return table_of(file, _of_rows(found))
    return table_of(file, [("", _numbers(found))])


def _parsed(file: str, text: str) -> Any:
    """One value, or one a line."""
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        whole = error
    lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
    rows = []
    for place, (number, line) in enumerate(lines):
        try:
            rows.append(json.loads(line))
        except json.JSONDecodeError as error:
            if not rows:
                raise ValueError(f"{file} line {whole.lineno} is no JSON: {one_line(whole.msg)}") from None
            if place == len(lines) - 1:  # its writer was stopped
                break
            raise ValueError(f"{file} line {number} is no JSON: {one_line(error.msg)}") from None
    return rows


def _are_rows(value: Any) -> bool:
    return isinstance(value, list) and len(value) > 1 and all(isinstance(each, Mapping) for each in value)


def _of_rows(rows: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, Any]]:
    """The series of rows, by the names that any of them has."""
    flat = [dict(_flat("", row)) for row in rows]
    for name in dict.fromkeys(name for row in flat for name in row):
        yield name, np.array([row.get(name, np.nan) for row in flat], float)


def _flat(name: str, value: Any) -> Iterator[tuple[str, float]]:
    """The numbers of a row by their names, as `joint.q_1`."""
    if isinstance(value, Mapping):
        for key, each in value.items():
            yield from _flat(f"{name}.{key}" if name else str(key), each)
    elif isinstance(value, list):
        for number, each in enumerate(value, start=1):
            yield from _flat(f"{name}_{number}", each)
    elif value is None or (isinstance(value, int | float) and not isinstance(value, bool)):
        yield name, np.nan if value is None else float(value)


def _numbers(value: Any) -> Any:
    """A list of numbers, or of lists of them, as an array; a table of names to such; what else there is as it stands."""
    if isinstance(value, Mapping):
        return {name: _numbers(each) for name, each in value.items()}
    try:
        return np.array(value, float)  # None becomes nan
    except (TypeError, ValueError):
        return np.array([])
