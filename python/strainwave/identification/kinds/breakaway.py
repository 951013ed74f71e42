"""Ramps of torque until the shaft breaks away."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.candidates.presliding import BreakawayTorque, breakaway_torque, breakaways
from strainwave.identification.checks.sizes import friction_at_rest
from strainwave.identification.checks.unexplained import MAX_SHARE_OF_TORQUE, Left, error_left, only_if_explained
from strainwave.identification.fitting.unknowns import Estimate
from strainwave.identification.kinds.at_rest import (
    AtRest,
    angle_and_effort,
    at_input,
    estimate_of,
    goes_to_and_fro,
    with_breakaway,
)
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.motion import MAX_SPEED_AT_REST, jumps
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, first
from strainwave.identification.results.file_result import BREAKAWAY_PATH, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.statistics.residuals import rms
from strainwave.statistics.runs import runs_of
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

Array = NDArray[np.float64]

MIN_LOAD_SHARE = 0.1  # of the largest torque
MIN_TIME_AT_REST = 0.5  # of the time under load, while ramps rise
MIN_CORRELATION = 0.9  # of a ramp with time
PARTS_OF_RECORD = 500  # over which motion is counted
MIN_RECORD_ROWS, MIN_ROWS_OF_RAMP = 100, 10


class Breakaway(AtRest):
    """A torque that rises while the shaft rests, until it moves."""

    time = "needed"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True if the torque rises while the shaft rests, most of the time under load."""
        pair, time = angle_and_effort(columns, mapping), first(columns, "time")
        if pair is None or not time or goes_to_and_fro(columns, mapping):
            return False
        angle, effort = pair
        return _ramps(time["time"].si, angle.si, effort.si)

    def motion(self, angle: Column, force: Column) -> str:
        """Return in words how the shaft moves."""
        return f"{force.name} rises while {angle.name} rests, until it moves"

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit the breakaway torque of ramps, in both directions.

        Raises:
            ValueError: no ramp broke the shaft away
        """
        name = file.path.name
        recording, uncertain = at_input(file, known)
        ramps = breakaways(recording)
        torque = breakaway_torque(ramps)
        ways = (torque.reverse, torque.forward)
        sides = [each for each in ways if each is not None]
        both = _mean(sides)
        off = [abs(ramp.torque) - each.value for ramp in ramps if (each := ways[ramp.torque > 0.0]) is not None]
        left = Left(rms(np.array(off)), both.value, "N.m", MAX_SHARE_OF_TORQUE)
        whole = error_left({"the torque of breakaway": left}, name)
        few = "one ramp shows no scatter" if len(ramps) <= len(sides) else ""
        estimates = only_if_explained((estimate_of(both, BREAKAWAY_PATH, "", uncertain, few),), whole)
        after, below = with_breakaway(known, estimates[0], name)
        remarks = (*file.remarks, *_remarks(torque, len(ramps)), *below)
        checks = (*friction_at_rest(both.value, known.initial.gear, name), whole)
        return FileResult(name, file, "breakaway of each ramp", estimates, remarks, checks), after


def _remarks(found: BreakawayTorque, ramps: int) -> Iterator[str]:
    yield f"{ramps} {'ramp of torque breaks' if ramps == 1 else 'ramps of torque break'} it away"
    for each, way in ((found.forward, "forward"), (found.reverse, "in reverse")):
        if each is None:
            yield f"{way}: no ramp went that way"
        else:
            scatter = f"± {each.sigma:.2g} N·m" if np.isfinite(each.sigma) else "N·m, of one ramp"
            yield f"{way}: {each.value:.4g} {scatter}"
    if found.slope is not None:
        yield f"for each decade of the ramps' rate it changes by {found.slope.value:.2g} ± {found.slope.sigma:.1g} N·m"


def _mean(sides: list[Estimate]) -> Estimate:
    """Return the mean of both directions; if they differ by more than chance, half the difference adds to its uncertainty."""
    values, sigmas = np.array([each.value for each in sides]), np.array([each.sigma for each in sides])
    value, sigma = float(values.mean()), float(np.linalg.norm(sigmas)) / len(sides)
    half = 0.5 * float(np.ptp(values))
    if 2.0 * half > SIGNIFICANCE_SIGMA * np.linalg.norm(sigmas):
        sigma = float(np.hypot(sigma, half))
    return replace(sides[0], path="breakaway", value=value, sigma=sigma)


def _ramps(time: Array, angle: Array, effort: Array) -> bool:
    """True if the torque rises while the shaft rests, most of the time under load."""
    if len(time) < MIN_RECORD_ROWS or not np.isfinite(time + angle + effort).all():
        return False
    apart = max(len(time) // PARTS_OF_RECORD, 1)
    for row in jumps(angle, time):
        angle = np.concatenate([angle[:row], angle[row:] - (angle[row] - angle[row - 1])])
    moved, size = np.abs(angle[apart:] - angle[:-apart]), np.abs(effort[apart:])
    loaded, resting = size > MIN_LOAD_SHARE * size.max(), moved <= MAX_SPEED_AT_REST * moved.max()
    if not moved.max() > 0.0:
        return False
    ramps = [size[rows] for rows in runs_of(loaded & resting, MIN_ROWS_OF_RAMP)]
    rising = [
        len(ramp) for ramp in ramps if np.ptp(ramp) > 0.0 and np.corrcoef(np.arange(len(ramp)), ramp)[0, 1] > MIN_CORRELATION
    ]
    return sum(rising) > MIN_TIME_AT_REST * float(loaded.sum())
