"""Records of a flexible ring by finite elements: modes and bearing that its orders over the speed determine.

Records come from `tests.evidence.flexible_ring`, by constant speeds or by run-ups. The truth of a mode is the tangent of an
eigenline of the gear, in the frame of the lobes, where one of its orders meets it: frequency at speed zero, slope and damping.
A bearing is right with its number of balls.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from strainwave.files.recording import Recording
from strainwave.orders.bearing_candidates import BearingCandidates
from strainwave.orders.ring_modes import RingMode, RingModes, ring_modes

from tests.evidence.drawn.outcome import Outcome, compared
from tests.evidence.flexible_ring.gear import Gear
from tests.evidence.flexible_ring.records import UNITS, Experiment, drawn_experiment
from tests.evidence.flexible_ring.truth import Lines

MAX_FROM_WAVES = 0.25  # of the slope of an eigenline, to be that of so many waves
MAX_APART = 0.1  # of the frequency: eigenlines farther from a stated mode are no candidates for it


@dataclass(frozen=True)
class Crossing:
    """Crossing of an order with an eigenline: slope, frequency [rad/s] and damping of its tangent, and the speed [rad/s]."""

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
    """Return whether a mode is an eigenline that one of its orders meets."""
    near = [
        crossing
        for order in mode.orders
        for crossing in crossings(lines, order)
        if abs(crossing.frequency / mode.frequency - 1.0) < MAX_APART
    ]
    outcomes = [_compared(mode, crossing) for crossing in near]
    if any(outcome.verdict == "right" for outcome in outcomes):
        return Outcome("right")
    where = "; ".join(outcome.message for outcome in outcomes) or "no eigenline"
    return Outcome("wrong", f"mode {mode.frequency / (2.0 * np.pi):.1f} Hz of orders {mode.orders}: {where}")


def _compared(mode: RingMode, crossing: Crossing) -> Outcome:
    slope, sigma = (mode.slope, mode.slope_sigma) if mode.waves is None else (float(mode.waves), MAX_FROM_WAVES / 2.5)
    return compared(
        [
            ("frequency", mode.frequency, mode.frequency_sigma, crossing.frequency),
            ("damping", mode.damping, mode.damping_sigma, crossing.damping),
            ("slope", slope, sigma, abs(crossing.slope)),
        ]
    )


def judged_bearing(bearing: BearingCandidates | None, gear: Gear) -> Outcome:
    """Return whether the number of balls that is stated is true; refused if none is."""
    if bearing is None or bearing.balls is None:
        return Outcome("refused", "no bearing is stated")
    right = bearing.balls == gear.balls
    return Outcome("right") if right else Outcome("wrong", f"{bearing.balls} balls, {gear.balls} are true")


def identified(experiment: Experiment) -> RingModes:
    """Return what the records of an experiment determine."""
    return ring_modes([Recording(record, UNITS) for record in experiment.records], "output_angle")


def outcome(seed: int) -> Outcome:
    """Return whether every mode and bearing that is stated is true; refused if none is."""
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
