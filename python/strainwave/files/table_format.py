"""A format of files with tables: how one is opened, and how the documentation lists it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import ColumnSource, Content, Label

Array = NDArray[np.float64]


class OpenTable(Protocol):
    """A file whose columns are known, but not yet read."""

    @property
    def file(self) -> str:
        """Return the name of the file in messages."""

    @property
    def title(self) -> str: ...

    @property
    def labels(self) -> Sequence[Label]: ...

    @property
    def left_out(self) -> Sequence[str]:
        """Parts of the file that are not among the columns, each with the reason."""

    @property
    def contents(self) -> Sequence[Content]:
        """Return the content of each column, by its first rows."""

    def numbers(self, sources: Sequence[ColumnSource]) -> dict[str, Array]:
        """The columns wanted; whatever is no number is refused."""

    def measured(self, sources: Sequence[ColumnSource]) -> tuple[dict[str, Array], list[str]]:
        """The columns wanted, nan where nothing is written, dates as seconds since the first; in words what was left out."""

    def place(self, row: int) -> str:
        """Return the name of a row in messages, counted from 0."""


class Format(NamedTuple):
    """A format of files, which a module of this package reads.

    Attributes:
        suffixes: of its files, in small letters
        open: function that opens a file of it
        title: name of the format
        units: where the unit of a column stands, in Markdown
        kept: what a recording that was written loses, in words
        about: what becomes a column, what is left out, and the extra that it needs, in Markdown; empty if nothing is to be said
    """

    suffixes: tuple[str, ...]
    open: Callable[[str | Path], OpenTable]
    title: str
    units: str
    kept: str = "read only"
    about: str = ""
