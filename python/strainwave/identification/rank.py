"""All models that a file can be fitted by, ranked by what they predict of data held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.identification.candidates.friction import fit_friction, ranking
from strainwave.identification.candidates.motion import MotionCandidate, fit_motion
from strainwave.identification.candidates.presliding import fit_presliding
from strainwave.identification.candidates.torsion.ranking import rank_loop
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.presliding import PreslidingLoop
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.covariance import correlation_length
from strainwave.identification.kinds.at_rest import at_input
from strainwave.identification.kinds.prepared_log import log_of
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.gear_so_far import GearSoFar, with_torque


@dataclass(frozen=True)
class Ranked:
    """One model of a file, and how well it predicts.

    Attributes:
        name: of the model
        parameters: how many numbers of the gear and its drive were fitted
        error: rms error on data held out, in `unit`
        standard_error: of that error; not a number where it was not worked out
        unit: of both
        together: neighbouring residuals that hang together [1]: 1 of white noise, which leaves nothing to explain
        cost: time that the model takes for a sample [µs]; not a number where it was not measured
    """

    name: str
    parameters: int
    error: float
    standard_error: float
    unit: str
    together: float
    cost: float


def rank(start: GearSet, file: Recognised) -> tuple[Ranked, ...]:
    """All models of a file, the one to take first: the simplest that chance alone may make no better.

    Args:
        start: the set to start from
        file: a table of friction, a torsion loop, a presliding loop, or a log

    Raises:
        ValueError: the file is none of these, or cannot be fitted
    """
    if file.kind == "friction":
        return _frictions(start, file)
    if file.kind == "torsion":
        return _loops(start, file)
    if file.kind == "log":
        return _logs(start, file)
    if file.kind == "presliding":
        return _at_rest(start, file)
    raise ValueError(
        "only tables of friction, torsion loops, presliding loops and logs have models to rank; strainwave orders finds orders"
    )


def _frictions(start: GearSet, file: Recognised) -> tuple[Ranked, ...]:
    recording, _ = with_torque(file, start)
    table = FrictionTable.of_output(recording, start.gear) if file.side == "output" else FrictionTable.of(recording)
    found = fit_friction(table, start.gear)
    order = np.argsort(table.speed, kind="stable")
    return tuple(
        Ranked(
            line.name, line.parameters, line.error, line.error_sigma, "N.m",
            correlation_length(each.fit.residuals[0][order]), line.cost,
        )
        for line, each in zip(ranking(found), found, strict=True)
    )  # fmt: skip


def _loops(start: GearSet, file: Recognised) -> tuple[Ranked, ...]:
    loop = TorsionLoop.of(file.recording, start.gear)
    found = rank_loop(loop, start.gear)
    return tuple(
        Ranked(each.name, each.parameters, each.error, each.standard_error, "N.m", each.correlation, 1e6 * each.cost)
        for each in found
    )


def _logs(start: GearSet, file: Recognised) -> tuple[Ranked, ...]:
    found = log_of(file, GearSoFar(start))
    size = float(np.std(found.log.measured))
    unit = found.log.units[0]
    return tuple(_of_motion(each, size, unit) for each in fit_motion([found.log], found.drive))


def _at_rest(start: GearSet, file: Recognised) -> tuple[Ranked, ...]:
    loop = PreslidingLoop.of(at_input(file, GearSoFar(start))[0])
    begun = np.arange(len(loop.angle)) >= loop.turns[0]
    return tuple(
        Ranked(
            each.name, len(each.estimates), each.error, np.nan, "N.m",
            correlation_length((loop.torque - each.predicted)[begun]), np.nan,
        )
        for each in fit_presliding(loop)
    )  # fmt: skip


def _of_motion(each: MotionCandidate, size: float, unit: str) -> Ranked:
    together = max(correlation_length(part.residuals[0]) for part in each.fit.parts)
    nuisances = sum(len(part.experiment.nuisances) for part in each.fit.parts)
    fitted = len(each.fit.estimates) - nuisances - len(each.model.ties)
    return Ranked(each.name, fitted, each.error, np.nan, unit, together, np.nan)


def table_of(ranked: Sequence[Ranked]) -> list[str]:
    """The lines of a table to print."""
    width = max(len(each.name) for each in ranked)
    unit = ranked[0].unit
    head = f"{'model':{width}}  numbers  error held out [{unit}]  residuals together  cost [µs]"
    return [head, *(_line(each, width) for each in ranked)]


def _line(each: Ranked, width: int) -> str:
    error = f"{each.error:.4g}" + (f" ± {each.standard_error:.2g}" if np.isfinite(each.standard_error) else "")
    cost = f"{each.cost:.2g}" if np.isfinite(each.cost) else "-"
    return f"{each.name:{width}}  {each.parameters:7}  {error:>22}  {each.together:18.3g}  {cost:>9}"
