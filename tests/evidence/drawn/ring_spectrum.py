"""Records of a flexible ring by finite elements: modes and bearing that its orders over the speed determine.

Records come from `tests.evidence.flexible_ring`, by constant speeds or by run-ups. The truth of a mode is an eigenline of the
gear in the frame of the lobes, where an order that is stated to pass it meets it: the frequency of its tangent at speed zero,
its slope, and its damping. A mode whose slope lies more than a quarter beside its waves is wrong, however well it fits. A
bearing is right with its number of balls and its diameter ratio.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite

import numpy as np
from strainwave.files.recording import Recording
from strainwave.orders.bearing_candidates import BearingCandidates
from strainwave.orders.ring_modes import RingMode, RingModes, ring_modes

from tests.evidence.drawn.outcome import Outcome, compared
from tests.evidence.flexible_ring.gear import Gear
from tests.evidence.flexible_ring.records import UNITS, Experiment, drawn_experiment
from tests.evidence.flexible_ring.truth import Lines

MAX_FROM_WAVES = 0.25  # of the slope of an eigenline, to be that of so many waves
NEAR = 0.1  # of the frequency: eigenlines farther from a stated mode are no candidates for it


@dataclass(frozen=True)
class Crossing:
    """Where an order meets an eigenline: slope, natural frequency [rad/s] and damping of its tangent, and the speed [rad/s]."""

    slope: float
    frequency: float
    damping: float
    speed: float


def crossings(lines: Lines, order: float) -> Iterator[Crossing]:
    """Yield where an order of the input meets eigenlines within the speeds."""
    apart = lines.frequency - order * lines.speed[:, np.newaxis]
    for place, line in np.argwhere(apart[:-1] * apart[1:] <= 0.0):
        share = apart[place, line] / (apart[place, line] - apart[place + 1, line])
        values = [lines.slope, lines.natural_frequency, lines.damping]
        at = [(1.0 - share) * each[place, line] + share * each[place + 1, line] for each in values]
        yield Crossing(*map(float, at), float((1.0 - share) * lines.speed[place] + share * lines.speed[place + 1]))


def judged_mode(mode: RingMode, lines: Lines) -> Outcome:
    """Return whether a stated mode is an eigenline that its orders meet."""
    met = [crossing for order in mode.orders for crossing in crossings(lines, order)]
    stated = [
        (candidate.waves, candidate.natural_frequency, candidate.natural_frequency_sigma) for candidate in mode.candidates
    ]
    if mode.waves is None and isfinite(mode.natural_frequency):
        stated = [(mode.slope, mode.natural_frequency, mode.natural_frequency_sigma)]
    outcomes = [
        _compared(mode, waves, frequency, sigma, crossing)
        for waves, frequency, sigma in stated
        for crossing in met
        if abs(crossing.frequency / frequency - 1.0) < NEAR
    ]
    if any(outcome.verdict == "right" for outcome in outcomes):
        return Outcome("right")
    where = "; ".join(outcome.message for outcome in outcomes) or "no eigenline"
    numbers = ", ".join(f"{frequency / (2.0 * np.pi):.1f} Hz waves {waves:.3g}" for waves, frequency, _ in stated)
    return Outcome("wrong", f"mode {numbers} of orders {[round(order, 3) for order in mode.orders]}: {where}")


def _compared(mode: RingMode, waves: float, frequency: float, sigma: float, crossing: Crossing) -> Outcome:
    pairs = [("frequency", frequency, sigma, crossing.frequency)]
    if isfinite(mode.damping):
        pairs.append(("damping", mode.damping, mode.damping_sigma, crossing.damping))
    slope_apart = MAX_FROM_WAVES / 2.5 if mode.waves is not None or len(mode.candidates) > 1 else mode.slope_sigma
    pairs.append(("slope", waves, slope_apart, abs(crossing.slope)))
    return compared(pairs)


def judged_bearing(bearing: BearingCandidates | None, gear: Gear) -> Outcome:
    """Return whether the bearing that is stated is true; refused if its balls are not separable."""
    if bearing is None or not bearing.candidates:
        return Outcome("refused", "no bearing is stated")
    ratio = gear.ball_diameter / gear.pitch_diameter
    outcomes = [
        compared([(f"{each.balls} balls, diameter ratio", each.diameter_ratio, each.diameter_ratio_sigma, ratio)])
        for each in bearing.candidates
        if each.balls == gear.balls
    ]
    if not any(outcome.verdict == "right" for outcome in outcomes):
        found = "; ".join(outcome.message for outcome in outcomes) or bearing._headline()
        return Outcome("wrong", f"{gear.balls} balls, {ratio:.4f}: {found}")
    return Outcome("right") if bearing.balls is not None else Outcome("refused", "; ".join(bearing.remarks))


def identified(experiment: Experiment) -> RingModes:
    """Return what the records of an experiment determine."""
    return ring_modes([Recording(record, UNITS) for record in experiment.records], "output_angle")


def outcome(seed: int) -> Outcome:
    """Return whether every mode and every bearing that is stated is true; refused if none is."""
    experiment = drawn_experiment(seed)
    found = identified(experiment)
    outcomes = [judged_mode(mode, experiment.lines) for mode in found.modes]
    outcomes.append(judged_bearing(found.bearing, experiment.gear))
    wrong = [each.message for each in outcomes if each.verdict == "wrong"]
    if wrong:
        return Outcome("wrong", " | ".join(wrong))
    if all(each.verdict == "refused" for each in outcomes):
        return Outcome("refused", "; ".join(found.remarks))
    return Outcome("right")
