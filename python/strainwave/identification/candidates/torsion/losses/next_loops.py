"""Torsion loops that could be measured next, and what they would determine of the shares of the sources of loss."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear
from strainwave.analysis.torsion_loop import series_compliance
from strainwave.identification.candidates.torsion.losses.fit import MAX_SHARE_SIGMA, PRIOR_SHARE_SIGMA, SHAPE_SIGMA, LossFit
from strainwave.identification.candidates.torsion.losses.sources import Curve, possible_sources
from strainwave.identification.experiments.loss_loop import LossLoop
from strainwave.typeset import percent

Array = NDArray[np.float64]

MAX_PLANNED_LOOPS = 3
PLANNED_REACHES, PLANNED_RATES, PLANNED_WARMTHS = (1.0, 0.5, 0.25), (1.0, 5.0), (0.0, 20.0)  # of the loop that is there; K


def next_loops(fit: LossFit, place: int) -> str:
    """Return in words the loops that would separate a source, the best one first."""
    covariance, chosen, possible = fit.covariance, list[str](), [*options(fit)]

    def sigma(after: Array) -> float:
        return float(np.hypot(fit.sigma_by_noise(after)[place], SHAPE_SIGMA))

    while len(chosen) < MAX_PLANNED_LOOPS and sigma(covariance) > MAX_SHARE_SIGMA:
        loop, rows = min(possible, key=lambda option: sigma(with_rows(covariance, option[1])))
        covariance, chosen = with_rows(covariance, rows), [*chosen, loop.words]
    loops = f"{'a loop' if len(chosen) == 1 else 'loops'} of {' and '.join(chosen)}"
    return f"{loops} would determine it to ± {percent(sigma(covariance))}"


def with_rows(covariance: Array, rows: Array) -> Array:
    """Return the covariance after further equations of unit uncertainty, without the inverse of an ill-conditioned one."""
    shared = rows @ covariance
    return np.asarray(covariance - shared.T @ np.linalg.solve(np.eye(len(rows)) + shared @ rows.T, shared))


def options(fit: LossFit, input_ratio: float = 0.0) -> Iterator[tuple[LossLoop, Array]]:
    """Yield loops that could be measured, and their equations of amplitudes and changes, as rows of unit uncertainty.

    Loops at the input are among them if some were measured there, or if a ratio is given.
    """
    largest, curve, model = fit.loops[fit.largest], fit.curves[fit.largest], fit.widths
    stiffness = 2.0 * curve.reach / (largest.ends[1] - largest.ends[0])
    rate = largest.speed if largest.is_timed else np.nan
    rates, warmths = PLANNED_RATES if largest.is_timed else (1.0,), PLANNED_WARMTHS if model.lubricants else (0.0,)
    ratios = {0.0, input_ratio, *(loop.ratio for loop in fit.loops)}
    for ratio, warmer, faster, part in product(sorted(ratios), warmths, rates, PLANNED_REACHES):
        temperature, reach = largest.temperature + warmer, part * curve.reach
        loop = LossLoop.planned(ratio, stiffness, reach, faster * rate, temperature)
        widths = model.of_loop(loop, Curve(loop.torque, -reach, reach)) / fit.noise
        rows = model.jacobian(widths, loop, fit.amplitudes, fit.changes)
        yield loop, np.asarray(np.linalg.qr(rows, mode="r"))


def with_bearing(fit: LossFit, gear: Gear) -> LossFit:
    """Return a fit with the sources of loops at the input, of which nothing but the prior is known if there is no such loop.

    A gear with stages has none. Shifts that may be due to the noise are left out.
    """
    shifts = np.where(fit.sigma_by_noise() > MAX_SHARE_SIGMA, 0.0, fit.shifts)
    if any(loop.ratio for loop in fit.loops) or series_compliance(gear) != 0.0:
        return replace(fit, shifts=shifts)
    own_sources, largest = fit.widths.sources, fit.loops[fit.largest]
    bearing = [source for source in possible_sources(True, largest.is_timed) if source not in own_sources]  # one shape each
    model, count = replace(fit.widths, sources=[*bearing, *own_sources]), len(bearing)
    unit_loss = model.cycle_loss(replace(largest, ratio=abs(gear.kinematics.ratio)), fit.curves[fit.largest])
    covariance = np.pad(fit.covariance, ((count, 0), (count, 0)))
    covariance[:count, :count] = np.diag((PRIOR_SHARE_SIGMA * fit.total / unit_loss[:count]) ** 2)
    shifts = np.hstack((shifts[:, :count], shifts))  # the bearing has the forms of the friction of the gear, which comes next
    amplitudes = np.append(np.zeros(count), fit.amplitudes)
    return replace(fit, widths=model, amplitudes=amplitudes, covariance=covariance, unit_loss=unit_loss, shifts=shifts)
