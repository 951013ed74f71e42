"""Time in two columns, whole seconds and the nanoseconds beside them, as stamps of ROS and of robots' controllers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.files.labels import Content, Label, Source
from strainwave.files.tables import OpenTable
from strainwave.identification.reading.names import words_of

Array = NDArray[np.float64]

SECONDS = ("s", "sec", "secs", "second", "seconds")
PARTS = {
    **dict.fromkeys(("ns", "nsec", "nsecs", "nanosec", "nanosecs", "nanosecond", "nanoseconds"), 1e-9),
    **dict.fromkeys(("us", "usec", "usecs", "microsec", "microseconds"), 1e-6),
}  # of a second


@dataclass(frozen=True, eq=False)
class TwoPartTime:
    """A table whose time stands in two columns, with their sum in the first of them.

    Args:
        table: as it is
        seconds, part: where whole seconds stand, and what is to be added
        size: of the part [s]
    """

    table: OpenTable
    seconds: int
    part: int
    size: float

    @property
    def file(self) -> str:
        return self.table.file

    @property
    def title(self) -> str:
        return self.table.title

    @property
    def labels(self) -> Sequence[Label]:
        found = list(self.table.labels)
        found[self.seconds] = Label(f"{found[self.seconds].text} and {found[self.part].text}", "time", "s")
        return found

    @property
    def contents(self) -> Sequence[Content]:
        return ["other" if place == self.part else content for place, content in enumerate(self.table.contents)]

    @property
    def left_out(self) -> Sequence[str]:
        return self.table.left_out

    def numbers(self, sources: Sequence[Source]) -> dict[str, Array]:
        """The columns wanted, all of them numbers."""
        return self._added(self.table.numbers(self._with_part(sources)), sources)

    def measured(self, sources: Sequence[Source]) -> tuple[dict[str, Array], list[str]]:
        """The columns wanted, nan where nothing is written; and what was left out."""
        numbers, remarks = self.table.measured(self._with_part(sources))
        return self._added(numbers, sources), remarks

    def place(self, row: int) -> str:
        return self.table.place(row)

    def _with_part(self, sources: Sequence[Source]) -> list[Source]:
        if all(source.position != self.seconds for source in sources):
            return list(sources)
        return [*sources, Source(self.part, self.table.labels[self.part].name, _PART, "1")]

    def _added(self, numbers: dict[str, Array], sources: Sequence[Source]) -> dict[str, Array]:
        part = numbers.pop(_PART, None)
        for source in sources:
            if source.position == self.seconds and part is not None:
                numbers[source.name] = numbers[source.name] + self.size * part
        return numbers


_PART = "part of a second"  # no column that is wanted has this name


def with_whole_time(table: OpenTable) -> OpenTable:
    """The table, with the sum of two columns that are a time in seconds and nanoseconds, where it has such.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from strainwave.files.tables import open_table
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "log.csv").write_text("stamp.sec,stamp.nanosec,q\\n7,500000000,0.1\\n8,0,0.2\\n")
    ...     table = with_whole_time(open_table(Path(folder, "log.csv")))
    ...     numbers, _ = table.measured([Source(0, "time", "time", "s")])
    >>> numbers["time"].tolist()
    [7.5, 8.0]
    """
    ends = [_end(label) for label in table.labels]
    parts = [part for part, (_, size) in enumerate(ends) if size in PARTS]
    contents = table.contents if parts else ()
    for seconds, (before, unit) in enumerate(ends):
        if unit not in SECONDS:
            continue
        for part in parts:
            beside, size = ends[part]
            if beside == before and contents[seconds] == contents[part] == "numbers":
                found = TwoPartTime(table, seconds, part, PARTS[size])
                if _is_time(found):
                    return found
    return table


def _end(label: Label) -> tuple[tuple[str, ...], str]:
    """The words of a name, and the last of them or the unit, which says what is counted."""
    words = words_of(label.name) + ([label.unit] if label.unit else [])
    if len(words) > 1 and words[-2] in ("nano", "micro"):
        words[-2:] = [words[-2] + words[-1]]
    return (tuple(words[:-1]), words[-1]) if words else ((), "")


def _is_time(found: TwoPartTime) -> bool:
    """Whether the one column holds whole numbers, and the other parts of one second."""
    places = [Source(place, str(place), str(place), "1") for place in (found.seconds, found.part)]
    numbers, _ = found.table.measured(places)
    whole, part = (numbers[place.name][np.isfinite(numbers[place.name])] for place in places)
    return bool(
        whole.size and part.size and (whole == np.round(whole)).all() and part.min() >= 0.0 and found.size * part.max() < 1.0
    )
