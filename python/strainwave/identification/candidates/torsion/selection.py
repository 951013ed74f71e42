"""Spring and Maxwell-slip hysteresis of a loop, as `identify` fits them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear
from strainwave.identification.candidates.torsion.candidate import (
    MIN_ERROR_SHARE,
    TorsionCandidate,
    candidate,
    drifts,
    with_drift,
    with_fewer,
)
from strainwave.identification.candidates.torsion.dissipation import Dissipation, Dry, Elements, InputFriction, Nothing
from strainwave.identification.candidates.torsion.springs import CUBIC, LINEAR, THREE_SEGMENT, SpringKind
from strainwave.identification.experiments.torsion_loop import TorsionLoop

SPRINGS = (LINEAR, CUBIC, THREE_SEGMENT)


def fit_loop(
    loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_] | None = None, *, friction_measured: bool = False
) -> list[TorsionCandidate]:
    """Fit each kind of spring to a loop, with the dissipation that the loop determines.

    That is Maxwell-slip hysteresis, in parallel with the spring. A single branch determines none: the hysteresis of the gear is
    kept. A loop from the input contains the friction of the wave generator, too. If this was measured, it is taken out. If not,
    the loop determines the sum of friction and hysteresis alone; one of them is fitted, friction rather than hysteresis, and
    the other is kept. A drift of torque or twist is fitted if the loop shows one.

    Args:
        loop: measured torque over twist
        gear: the gear to start from; fitted parts are replaced, the rest is kept
        training: samples that take part, shape (n,); the rest validates
        friction_measured: True if `gear.friction_input` was measured on this gear

    Returns:
        candidates, best first by the error on data held out; of those within 5 % of it, and a thousandth of the span of the
        torque, the one with the fewest parameters

    Raises:
        ValueError: too few samples for any candidate
    """
    chosen = np.ones(len(loop.twist), bool) if training is None else training
    kinds = [(spring, dissipation) for dissipation in asked(loop, gear, friction_measured) for spring in SPRINGS]
    candidates = _fitted(loop, gear, chosen, kinds)
    best = min(candidates, key=lambda c: c.error)
    if drift := drifts(with_drift(best, gear)):
        loop = replace(loop, **drift)
        candidates = _fitted(loop, gear, chosen, kinds)
        best = min(candidates, key=lambda c: c.error)
    good = float(np.hypot(1.05 * best.error, MIN_ERROR_SHARE * np.ptp(loop.torque)))
    candidates += simpler(best, good, gear)
    return sorted(candidates, key=lambda c: (c.error > good, len(c.fit.estimates) if c.error <= good else c.error))


def _fitted(
    loop: TorsionLoop, gear: Gear, training: NDArray[np.bool_], kinds: Sequence[tuple[SpringKind, Dissipation]]
) -> list[TorsionCandidate]:
    """Return the candidates of springs and dissipations for which there are samples enough; raises if there are for none."""
    found, refused = list[TorsionCandidate](), list[ValueError]()
    for each in kinds:
        try:
            found.append(candidate(loop, gear, training, *each))
        except ValueError as error:
            refused.append(error)
    if not found:
        raise refused[0]
    return found


def simpler(best: TorsionCandidate, good: float, known: Gear) -> Iterator[TorsionCandidate]:
    """Yield the best candidate with fewer and fewer Maxwell elements, as long as its error is at most `good`."""
    found = best
    while len(found.dissipation.elements(found.fit.gear)) > 1 and found.error <= good:
        found = with_fewer(found, known)
        yield found


def asked(loop: TorsionLoop, gear: Gear, friction_measured: bool) -> list[Dissipation]:
    """Return the dissipations that are fitted to the loop: Maxwell elements, or those in their place."""
    if loop.single_branch:
        return [Nothing()]
    friction_inside = bool(np.any(loop.friction(gear))) and isinstance(gear.friction_input, Dry)
    return [Elements()] if friction_measured or not friction_inside else [InputFriction(), Elements()]
