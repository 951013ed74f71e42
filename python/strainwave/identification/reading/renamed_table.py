"""A table whose columns have other names than in its file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Content, Label, Source
from strainwave.files.tables import OpenTable

Array = NDArray[np.float64]


class Part(NamedTuple):
    """A column that is added to another one: its position, and its unit in that of the other one."""

    position: int
    size: float


@dataclass(frozen=True, eq=False)
class RenamedTable:
    """A table with other labels, of which columns may be the sums of two.

    Args:
        table: as it is in the file
        labels: of the columns
        parts: the column that is added, by the position of the one to which it is; it is no channel of its own then
    """

    table: OpenTable
    labels: Sequence[Label]
    parts: Mapping[int, Part] = field(default_factory=dict)

    @property
    def file(self) -> str:
        return self.table.file

    @property
    def title(self) -> str:
        return self.table.title

    @property
    def left_out(self) -> Sequence[str]:
        return self.table.left_out

    @property
    def contents(self) -> Sequence[Content]:
        added = {part.position for part in self.parts.values()}
        return ["other" if position in added else content for position, content in enumerate(self.table.contents)]

    def numbers(self, sources: Sequence[Source]) -> dict[str, Array]:
        """Return the columns wanted, all of them numbers."""
        return self._summed(self.table.numbers(self._with_parts(sources)), sources)

    def measured(self, sources: Sequence[Source]) -> tuple[dict[str, Array], list[str]]:
        """Return the columns wanted, nan in empty cells; and what was left out."""
        numbers, remarks = self.table.measured(self._with_parts(sources))
        return self._summed(numbers, sources), remarks

    def place(self, row: int) -> str:
        return self.table.place(row)

    def _with_parts(self, sources: Sequence[Source]) -> list[Source]:
        parts = {place: self.parts[source.position] for place, source in enumerate(sources) if source.position in self.parts}
        return [*sources, *(Source(part.position, "", f"part of {place}", "1") for place, part in parts.items())]

    def _summed(self, numbers: Mapping[str, Array], sources: Sequence[Source]) -> dict[str, Array]:
        return {
            source.name: numbers[source.name] + self.parts[source.position].size * numbers[f"part of {place}"]
            if source.position in self.parts
            else numbers[source.name]
            for place, source in enumerate(sources)
        }
