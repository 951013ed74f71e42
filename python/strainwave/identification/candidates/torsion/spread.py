"""Standard deviations of the numbers of a torsion loop by the choice of its model, and by a shape that the model leaves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.candidates.torsion.candidate import TorsionCandidate
from strainwave.identification.checks.unexplained import OVER_TWIST, largest_shape
from strainwave.identification.fitting.influence import change_with

Array = NDArray[np.float64]
MAX_WAVES_OF_SHAPE = 8  # half periods of a wave over the range of the twist: what is finer moves no number of a spring


def spread_by_models(best: TorsionCandidate, others: Sequence[TorsionCandidate]) -> dict[str, float]:
    """Return how far the numbers of a spring lie apart in models that predict no worse, by path.

    A richer model that predicts better is not taken if it gains too little. The same spring beside other elements of hysteresis
    has numbers of the same meaning.
    """
    own = {each.path: each.value for each in best.fit.estimates}
    apart = dict.fromkeys(own, 0.0)
    alike = [each for each in others if each.spring == best.spring and each.error <= best.error]
    for each in (estimate for other in alike for estimate in other.fit.estimates):
        if each.path in own and each.path.startswith("stiffness."):
            apart[each.path] = max(apart[each.path], abs(each.value - own[each.path]))
    return apart


def spread_by_shape(best: TorsionCandidate) -> dict[str, float]:
    """Return how far numbers move by a torque over the twist that the model lacks, by path; zeros if the residual has none.

    That torque is a sum of waves over the range of the twist, of unknown sizes. How far each moves a number if it is fitted too
    is a part of the spread. A shape that repeats on each branch is no noise, of which covariances know; a single branch repeats
    none.
    """
    loop, residual = best.loop, best.fit.residuals[0]
    spread = {each.path: 0.0 for each in best.fit.estimates}
    if loop.single_branch or not largest_shape(residual, {OVER_TWIST: loop.twist}):
        return spread
    turn = np.pi * (loop.twist - loop.twist.min()) / np.ptp(loop.twist)
    for wave in range(1, MAX_WAVES_OF_SHAPE + 1):
        shifts, _ = change_with(best.fit, np.stack([np.sin(wave * turn), np.cos(wave * turn)]))
        spread |= {path: float(np.hypot(spread[path], shift)) for path, shift in shifts.items()}
    return spread
