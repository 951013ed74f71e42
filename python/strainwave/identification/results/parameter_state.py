"""State of every number of a gear after an identification: determined by a file, or kept, and why."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from strainwave import typeset
from strainwave.files.gear_set import GearSet
from strainwave.identification.results.combined_parameter import CombinedParameter
from strainwave.identification.results.file_result import FileResult, State
from strainwave.parameters import gear_numbers, plain
from strainwave.presentation import Presented

UNDETERMINED = "no file determines it"


@dataclass(frozen=True)
class ParameterState(Presented):
    """State of a number of the gear.

    Attributes:
        path: of the number in the gear set
        unit: its unit
        start: value in the start set; not a number if that has none
        value: value in the gear
        sigma: standard deviation; not a number if it was kept
        state: identified, identified in combination with another (each may be off, together they are not), not identified
            though fitted, or kept from the start set
        why: the reason, or the source
    """

    path: str
    unit: str
    start: float
    value: float
    sigma: float
    state: State
    why: str

    def _headline(self) -> str:
        return f"{self.path} = {typeset.uncertain_quantity(self.value, self.sigma, self.unit)}, {self.state}"


def states_of(
    start: GearSet, gear_set: GearSet, parameters: Sequence[CombinedParameter], files: Sequence[FileResult]
) -> Iterator[ParameterState]:
    """Yield the state of every number of a gear."""
    before = gear_numbers(start.gear)
    combined = {each.estimate.path: each for each in reversed(parameters)}
    in_doubt = {file.name for file in files if file.failed}
    undetermined = {estimate.path: estimate for file in files for estimate in file.estimates if estimate.why}
    for path, (value, unit) in gear_numbers(gear_set.gear).items():
        entry, known = gear_set.sources.get(path), before.get(path, (np.nan, ""))[0]
        source = "" if entry is None else entry.source
        if path in start.sources and start.sources[path] == entry and value == known:
            failed = (each := combined.get(path)) is not None and each.source in in_doubt
            why = f"a check of {each.source} failed" if each is not None and failed else UNDETERMINED
            yield ParameterState(path, unit, known, value, np.nan, "kept", f"{why}; {source}")
        elif source.startswith("assumed"):
            yield ParameterState(path, unit, known, value, np.nan, "kept", source.removeprefix("assumed: "))
        elif (each := combined.get(plain(path))) is not None or source.startswith("identified from"):
            sigma = each.estimate.sigma if each is not None else np.nan
            sigma = entry.uncertainty if entry is not None and entry.uncertainty is not None else sigma
            yield ParameterState(path, unit, known, value, sigma, "identified", source)
        elif source.startswith("identified in combination") and path not in undetermined:
            sigma = np.nan if entry is None or entry.uncertainty is None else entry.uncertainty
            yield ParameterState(path, unit, known, value, sigma, "identified in combination", source)
        elif (estimate := undetermined.get(path)) is not None:
            yield ParameterState(path, unit, known, value, estimate.sigma, estimate.state, estimate.why)
        else:
            yield ParameterState(path, unit, known, value, np.nan, "kept", source)
