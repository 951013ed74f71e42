"""Names of the columns of files, and the columns to be read, with their units."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.budget import RefusedFile
from strainwave.files.units import check as check_unit
from strainwave.messages import as_option, listed, one_line, quoted

Content = Literal["numbers", "dates", "other"]  # of a column
MAX_COLUMNS = 4000  # of one file: each name and each unit is interpreted, which takes about a millisecond
MAX_NAME = 1000  # characters of the name of a column, or of a header cell


class Label(NamedTuple):
    """Heading of a column in a file: its text, and the name and unit in it."""

    text: str
    name: str
    unit: str | None


class ColumnSource(NamedTuple):
    """A column to read: where it stands, its name in the file and in the recording, and its unit."""

    position: int
    label: str
    name: str
    unit: str


def label_of(text: str) -> Label:
    """Split `speed [rad/s]` or `speed (rad/s)`. Round brackets around no unit are a part of the name."""
    square = re.search(r"\[([^\[\]]*)\]\Z", text)
    unit_match = square or re.search(r"\(((?:[^()]|\([^()]*\))*)\)\Z", text)
    if unit_match and (name := text[: unit_match.start()].rstrip()) and (square or is_unit(unit_match[1])):
        return Label(text, name, unit_match[1])
    return Label(text, text, None)


def labels_of(texts: Sequence[str]) -> list[Label]:
    """The labels of a header; numbers in brackets are indices, not units, but for a 1 behind a blank that comes once.

    >>> [label.unit for label in labels_of(["t [s]", "q[0]", "q[1]", "slip [1]"])]
    ['s', None, None, '1']
    """
    labels = [label_of(text) for text in texts]
    again = Counter(label.name for label in labels if label.unit is not None and _is_index(label.unit))
    return [
        Label(label.text, label.text, None)
        if label.unit is not None and _is_index(label.unit) and (again[label.name] > 1 or not label.text.endswith(" [1]"))
        else label
        for label in labels
    ]


def check_names(names: Collection[str]) -> None:
    """Refuse names of columns that cannot be interpreted in a few seconds.

    Raises:
        RefusedFile: they are more than `MAX_COLUMNS`, or one has more than `MAX_NAME` characters
    """
    if len(names) > MAX_COLUMNS:
        raise RefusedFile(f"has {len(names)} columns; at most {MAX_COLUMNS} are read: save those that are needed")
    for name in names:
        if len(name) > MAX_NAME:
            raise RefusedFile(f"has a column {quoted(name)} of {len(name)} characters; a name has at most {MAX_NAME}")


def _is_index(text: str) -> bool:
    return text.isascii() and text.isdigit()


def is_unit(text: str) -> bool:
    try:
        check_unit(text)
    except ValueError:
        return False
    return True


def sources_of(
    file: str, labels: Sequence[Label], columns: Mapping[str, str] | None, units: Mapping[str, str] | None
) -> list[ColumnSource]:
    """The columns to read, each found in the file and with its unit."""
    arguments.mapping("columns", {} if columns is None else columns, '{"speed": "Motor Speed"}')
    arguments.mapping("units", {} if units is None else units, '{"speed": "rpm"}')
    if columns is None:
        _check_labels(file, labels)
        chosen = {label.name: index for index, label in enumerate(labels)}
    else:
        chosen = {name: _find(file, labels, wanted) for name, wanted in columns.items()}
    if not chosen:
        raise ValueError(f"{file}: no column to read")
    if extra := (units or {}).keys() - chosen.keys():
        raise ValueError(f"{file}: units names {quoted(min(extra))}, which is not read; there are {listed(chosen)}")
    return [
        ColumnSource(index, labels[index].name, name, _unit(file, labels[index], name, (units or {}).get(name)))
        for name, index in chosen.items()
    ]


def _check_labels(file: str, labels: Sequence[Label]) -> None:
    names = [label.name for label in labels]
    for number, name in enumerate(names, start=1):
        if not name:
            raise ValueError(f"{file} column {number} has no name; name it, or pick columns with columns={{...}}")
    for name, count in Counter(names).most_common(1):
        if count > 1:
            raise ValueError(f"{file} has {count} columns named {quoted(name)}; names must differ")


def places_of(labels: Sequence[Label], wanted: str) -> list[int]:
    """Return the places of the columns with this name; if there is none, the column of this number, counted from 1.

    A column of a matrix may be named by its number there: `out:3` is `out_3`.

    >>> places_of([Label("t [s]", "t", "s"), Label("q", "q", None)], "q"), places_of([Label("t [s]", "t", "s")], "1")
    ([1], [0])
    """
    places = [i for i, label in enumerate(labels) if label.text == wanted]
    places = places or [i for i, label in enumerate(labels) if label.name == wanted]
    if not places and (matrix := re.fullmatch(r"(.+):([1-9]\d{0,3})", wanted, re.ASCII)):
        places = [i for i, label in enumerate(labels) if f"{matrix[1]}_{matrix[2]}" in (label.text, label.name)]
    if not places and re.fullmatch(r"[1-9]\d{0,5}", wanted, re.ASCII) and int(wanted) <= len(labels):
        return [int(wanted) - 1]
    return places


def _find(file: str, labels: Sequence[Label], wanted: str) -> int:
    places = places_of(labels, wanted)
    if len(places) > 1:
        raise ValueError(f"{file} has {len(places)} columns named {quoted(wanted)}; names must differ")
    if not places:
        raise ValueError(f"{file} has no column {quoted(wanted)}; it has {listed(label.name for label in labels)}")
    return places[0]


def _unit(file: str, label: Label, name: str, given: str | None) -> str:
    """The unit the file states, or the one given where the file states none that is known."""
    column = f"{file} column {quoted(label.name)}"
    if given is not None:
        if label.unit is not None and is_unit(label.unit) and check_unit(label.unit) != check_unit(given):
            raise ValueError(f"{column} is in {quoted(label.unit)}, but the unit given for it is {quoted(given)}")
        return given
    if label.unit is None:
        hint = f"write it behind the name, as in torque [N.m], or give it with {as_option('unit', name, 'UNIT')}"
        raise ValueError(f"{column} has no unit; {hint}")
    try:
        return check_unit(label.unit)
    except ValueError as error:
        raise ValueError(f"{column}: {error}") from None


def unreadable(path: str | Path, error: Exception) -> str:
    """The message of a file that is not read: the refusal itself, or what the system or a library reports."""
    if isinstance(error, RefusedFile):
        return one_line(f"{path}: {error}")
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error).partition("\n")[0]
    return one_line(f"{path} cannot be read: {reason}")


@contextmanager
def read_by_others(path: str | Path, kind: str) -> Iterator[None]:
    """Turn any error of a library that reads a file into one line.

    Libraries for binary formats raise any error of a damaged file, in words that mean nothing to who wrote the file.

    Raises:
        ValueError: the file is damaged, or refused, with the reason
        ImportError: as the library raises it
    """
    try:
        yield
    except ImportError:
        raise
    except Exception as error:
        if isinstance(error, RefusedFile) or (isinstance(error, OSError) and error.strerror):
            raise ValueError(unreadable(path, error)) from None
        raise ValueError(one_line(f"{path} cannot be read: it is damaged, or no {kind} file")) from None


def seconds_since_first(stamps: NDArray[np.datetime64]) -> NDArray[np.float64]:
    """Dates as seconds since the first that is written; nan where there is none."""
    there = stamps[~np.isnat(stamps)]
    elapsed = stamps - there[0] if there.size else stamps - stamps
    seconds: NDArray[np.float64] = elapsed / np.timedelta64(1, "s")
    return seconds
