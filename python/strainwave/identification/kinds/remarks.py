"""Remarks that files of several kinds share."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import check_ratings
from strainwave.files.recording import Recording


def exceeded(start: GearSet, load: Recording) -> Iterator[str]:
    """Yield the ratings of a gear that a measurement exceeded."""
    yield from (f"beyond what the maker allows: {check}" for check in check_ratings(start, load) if check.exceeded)


def thinned(samples: int, taken: int) -> Iterator[str]:
    """Yield how many samples were compared, if these are not all."""
    if samples > taken:
        yield f"of its {samples} samples {taken} were compared"


def unused(recording: Recording, used: Sequence[str]) -> Iterator[str]:
    """Yield the columns that the fit does not use."""
    if names := [name for name in recording.names if name not in used]:
        yield f"not used: {', '.join(names)}"
