"""All models of a file, ranked by their error on data held out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.identification.kinds import kind_named
from strainwave.identification.kinds.kind import Ranked
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.gear_so_far import GearSoFar


def rank(start: GearSet, file: Recognised) -> tuple[Ranked, ...]:
    """Return all models of a file, the one to take first: the simplest whose error is larger by no more than chance may make.

    Args:
        start: the set to start from
        file: a table of friction, a torsion loop, a presliding loop, or a log

    Raises:
        ValueError: the file is none of these, or cannot be fitted
    """
    return kind_named(file.kind).rank(file.at_ratio(start.gear.kinematics.ratio), GearSoFar(start))


def table_of(ranked: Sequence[Ranked]) -> list[str]:
    """Return the lines of a table to print."""
    width = max(len(each.name) for each in ranked)
    unit = ranked[0].unit
    head = f"{'model':{width}}  numbers  error held out [{unit}]  residuals together  cost [µs]"
    return [head, *(_line(each, width) for each in ranked)]


def _line(each: Ranked, width: int) -> str:
    error = f"{each.error:.4g}" + (f" ± {each.standard_error:.2g}" if np.isfinite(each.standard_error) else "")
    cost = f"{each.cost:.2g}" if np.isfinite(each.cost) else "-"
    return f"{each.name:{width}}  {each.parameters:7}  {error:>22}  {each.correlation:18.3g}  {cost:>9}"
