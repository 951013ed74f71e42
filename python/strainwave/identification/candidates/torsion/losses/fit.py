"""Fit of all sources of loss to all torsion loops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave._core import Gear
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.candidates.torsion.losses.sources import Curve, Widths
from strainwave.identification.experiments.loss_loop import MAX_REACH_DIFFERENCE, LossLoop
from strainwave.statistics.covariance import posterior_of
from strainwave.statistics.linear_fit import linear_fit, solved
from strainwave.typeset import quantity

Array = NDArray[np.float64]

MAX_SHARE_SIGMA = 0.05  # of the loss of a cycle: a share with a larger standard deviation is not separated
SHAPE_SIGMA = 0.02  # of the loss of a cycle: how far real widths depart from the shapes (assumed)
PRIOR_SHARE_SIGMA = 1.0  # of the loss of a cycle: no source loses more than all do
REVERSAL_SHARES = (0.02, 0.06, 0.15)  # of the span, next to a reversal, that is left out; the second is taken
ROUNDS_OF_CURVE = 2  # in which curve and widths are fitted in turn
MIN_NOISE_SHARE = 1e-5  # of the torque: no sensor has less noise
MAX_PIECES_OF_CURVE = 24  # cubic pieces of the curve
SAMPLES_PER_PIECE = 12
END_SHARE, MIN_AT_END = 0.1, 3  # of the span next to a reversal, where the curve is a line; twists there
MIN_BOTH_SENSES = 0.1  # of the span of the torque on either side of zero, from which on both senses have a width of their own
STARTS_OF_TIME = (-1.0, 0.0, 1.0)  # standard deviations of the logarithm of the relaxation time
MAX_UNEXPLAINED_AREA = 0.25  # of the largest loop, by the forms of all sources: play and snags have others
MIN_MISFIT_SIGMA = 4.0  # standard deviations of a loop's width that no source explains


@dataclass(frozen=True, eq=False)
class LossFit(ComparedByFields):
    """The fit of all sources to all loops.

    Attributes:
        loops, curves: shape of each
        widths: of the sources that the loops may contain
        amplitudes: of each shape of each source
        changes: fall of each lubricant with the temperature [1/K]; logarithm of the relaxation time over 1 / middle
        covariance: of both
        unit_loss: of each shape for the number 1, in a cycle of the largest loop [J]
        largest: place of that loop
        noise: of the torque of a loop, the median [N.m]
        misfit: the largest part of a loop's width that no source explains [1]
        shifts: of the shares if more or less next to reversals is left out, shape (fits, sources)
    """

    loops: Sequence[LossLoop]
    curves: Sequence[Curve]
    widths: Widths
    amplitudes: Array
    changes: Array
    covariance: Array
    unit_loss: Array
    largest: int
    noise: float
    misfit: float
    shifts: Array

    @property
    def shows_relaxation(self) -> bool:
        """True if the last source, a relaxing material, is beyond chance with the relaxation time that is estimated."""
        place, time = len(self.amplitudes) - 1, len(self.covariance) - 1
        variance = self.covariance[place, place] - self.covariance[place, time] ** 2 / self.covariance[time, time]
        return bool(self.amplitudes[place] > MIN_MISFIT_SIGMA * np.sqrt(variance))

    @property
    def names(self) -> list[str]:
        """Names of the sources."""
        return [source.name for source in self.widths.sources]

    @property
    def total(self) -> float:
        """Loss of a cycle [J]."""
        return float(self.unit_loss @ self.amplitudes)

    @property
    def share_rows(self) -> Array:
        """Matrix that makes shares in the loss of a cycle of amplitudes and changes, shape (sources, unknowns)."""
        return np.pad(self.widths.shape_sums * (self.unit_loss / self.total), ((0, 0), (0, len(self.changes))))

    @property
    def shares(self) -> Array:
        """Shares of the sources in the loss of a cycle, shape (sources,)."""
        return np.asarray(self.share_rows @ np.append(self.amplitudes, self.changes))

    def sigma_by_noise(self, covariance: Array | None = None) -> Array:
        """Return the standard deviation of each share by the covariance of the unknowns, that of the fit by default."""
        of_unknowns = self.covariance if covariance is None else covariance
        return np.asarray(np.sqrt(np.maximum(np.einsum("si,ij,sj->s", self.share_rows, of_unknowns, self.share_rows), 0.0)))

    def sigma_by_forms(self, shifts: Array) -> Array:
        """Return the standard deviation of shares with these shifts, shape (fits, …), as widths depart from their forms."""
        return np.asarray(np.hypot(np.hypot(SHAPE_SIGMA, self.misfit), np.abs(shifts).max(axis=0)))

    @property
    def floors(self) -> Array:
        """Standard deviation of each share that no loop reduces."""
        return self.sigma_by_forms(self.shifts)


def fit_losses(recordings: Sequence[Recording], gear: Gear) -> LossFit:
    """Fit all sources to torsion loops.

    Raises:
        ValueError: a recording is no loop, there is none, some have a time or a temperature and others have none, or the
            largest loop has no loss beyond the noise, or one that the forms of the sources do not make
    """
    loops = [LossLoop.of(recording, arguments.gear(gear)) for recording in recordings]
    if not loops:
        raise ValueError("loss_shares needs at least one torsion loop")
    for name, has in (("time", [loop.is_timed for loop in loops]), ("temperature", [loop.is_warm for loop in loops])):
        if any(has) and not all(has):
            place = f"loop {has.index(False) + 1} of {len(has)}"
            raise ValueError(f"{place} has no {name}, others have one: give it to all or none")
    near, fit, far = _fits(loops, relaxing=True)
    _check_loss(loops[fit.largest], fit)
    if fit.widths.relaxation and not fit.shows_relaxation:
        near, fit, far = _fits(loops, relaxing=False)
    return replace(fit, shifts=np.array([near.shares - fit.shares, far.shares - fit.shares]))


def _check_loss(loop: LossLoop, fit: LossFit) -> None:
    """Raise a ValueError if a loop shows no loss beyond the noise, or one that is not that of the sources."""
    count = len(fit.unit_loss)
    sigma = float(np.sqrt(fit.unit_loss @ fit.covariance[:count, :count] @ fit.unit_loss))
    if not fit.total > MIN_MISFIT_SIGMA * sigma:
        lost = f"{quantity(fit.total, 'J')} ± {quantity(sigma, 'J')} by the forms of friction, load and material"
        raise ValueError(f"a cycle of the loop of {loop.words} loses {lost}: noise or other forms hide it; load it further")
    if not abs(fit.total - loop.area) < MAX_UNEXPLAINED_AREA * abs(loop.area):
        area, loss = quantity(loop.area, "J"), quantity(fit.total, "J")
        raise ValueError(
            f"a cycle of the loop of {loop.words} loses {area}, and the forms of friction, load and material make {loss} of "
            "it: play, a snag or a drift widens it in another way; leave that loop out, or load beyond the play"
        )


def _fits(loops: Sequence[LossLoop], *, relaxing: bool) -> list[LossFit]:
    """Return the fits that leave out more and more next to reversals; `relaxing`: with that material at enough rates."""
    fits: list[LossFit] = []
    for share in REVERSAL_SHARES:
        at_ends = [(curve.low, curve.high) for curve in fits[0].curves] if fits else [None] * len(loops)
        fits.append(_fitted([loop.apart(share) for loop in loops], at_ends, relaxing=relaxing))
    return fits


class _Equations(NamedTuple):
    """A loop as linear equations of its widths, in units of its noise [N.m], less what the curve and both senses explain."""

    loop: LossLoop
    widths: Array
    torque: Array
    noise: float

    @classmethod
    def of(cls, loop: LossLoop, curve: Curve, model: Widths) -> _Equations:
        without_loss = _columns_without_loss(loop, curve)
        both = np.column_stack((model.of_loop(loop, curve), loop.torque))
        left = both - without_loss @ (without_loss.T @ both)
        widths, torque = left[:, :-1], left[:, -1]
        unexplained = torque - widths @ solved(widths, torque)
        free = max(len(torque) - without_loss.shape[1] - widths.shape[1], 1)
        noise = max(float(np.sqrt(unexplained @ unexplained / free)), MIN_NOISE_SHARE * curve.reach)
        return cls(loop, widths / noise, torque / noise, noise)

    @property
    def triangle(self) -> _Equations:
        """The same sum of squares by as many equations as there are unknowns."""
        rows = np.asarray(np.linalg.qr(np.column_stack((self.widths, self.torque)), mode="r"))
        return self._replace(widths=rows[:, :-1], torque=rows[:, -1])


def _fitted(loops: Sequence[LossLoop], at_ends: Sequence[tuple[float, float] | None], *, relaxing: bool) -> LossFit:
    """Fit all sources to all loops, with a curve of each loop that both ways share, between known torques at its ends [N.m]."""
    curves = [_curve(loop, None, ends) for loop, ends in zip(loops, at_ends, strict=True)]
    largest = _largest(loops, curves)
    model = Widths.of(loops, largest, relaxing=relaxing)
    for _ in range(ROUNDS_OF_CURVE):
        curves = [
            _curve(loop, model.of_loop(loop, curve), ends) for loop, curve, ends in zip(loops, curves, at_ends, strict=True)
        ]
    equations = [_Equations.of(loop, curve, model) for loop, curve in zip(loops, curves, strict=True)]
    unit_loss = model.cycle_loss(loops[largest], curves[largest])
    priors = _priors(unit_loss, equations[largest], model.scales)
    amplitudes, changes = _least_squares(model, equations, priors)
    rows = [model.jacobian(of_loop.widths, of_loop.loop, amplitudes, changes) for of_loop in equations]
    explained = [row[:, : len(amplitudes)] @ amplitudes for row in rows]
    left = [of_loop.torque - torque for of_loop, torque in zip(equations, explained, strict=True)]
    covariance, _ = posterior_of(np.concatenate(rows), [residual[np.newaxis] for residual in left], priors)
    misfit = max(map(_misfit, left, explained))
    noise = float(np.median([of_loop.noise for of_loop in equations]))
    unshifted = np.zeros((0, len(model.sources)))
    return LossFit(loops, curves, model, amplitudes, changes, covariance, unit_loss, largest, noise, misfit, unshifted)


def _largest(loops: Sequence[LossLoop], curves: Sequence[Curve]) -> int:
    """Return the place of the loop of the largest torque, at the input if there is one; of several the first of the slowest."""
    has_input = any(loop.ratio for loop in loops)
    places = [place for place, loop in enumerate(loops) if bool(loop.ratio) == has_input]
    max_reach = max(curves[place].reach for place in places)
    near = [place for place in places if curves[place].reach > (1.0 - MAX_REACH_DIFFERENCE) * max_reach]
    slowest = (1.0 + MAX_REACH_DIFFERENCE) * min(loops[place].speed for place in near)
    return next(place for place in near if loops[place].speed <= slowest)


def _priors(unit_loss: Array, largest: _Equations, scales: Array) -> Array:
    """Return priors about zero as rows: no source loses more than a cycle does, and what is not linear has these scales.

    The loss of a cycle is determined by the largest loop alone even if its sources are not.
    """
    loss = max(float(np.abs(unit_loss @ solved(largest.widths, largest.torque))), 1e-300)
    return np.diag(np.append(unit_loss / (PRIOR_SHARE_SIGMA * loss), 1.0 / scales))


def _least_squares(model: Widths, equations: Sequence[_Equations], priors: Array) -> list[Array]:
    """Return amplitudes and changes by least squares with priors about zero."""
    from scipy.optimize import least_squares

    small, shapes, solutions = [of_loop.triangle for of_loop in equations], equations[0].widths.shape[1], []

    def residual(unknowns: Array) -> Array:
        amplitudes, changes = unknowns[:shapes], unknowns[shapes:]
        left = [rows.widths @ (model.factors(rows.loop, changes) * amplitudes) - rows.torque for rows in small]
        return np.concatenate((*left, priors @ unknowns))

    def slopes(unknowns: Array) -> Array:
        rows = [model.jacobian(rows.widths, rows.loop, unknowns[:shapes], unknowns[shapes:]) for rows in small]
        return np.concatenate((*rows, priors))

    for share in STARTS_OF_TIME if model.relaxation else (0.0,):
        start = np.zeros(len(priors))
        start[shapes:][-1:] = share * model.scales[-1:]
        start[:shapes] = solved(slopes(start)[:, :shapes], -residual(start))
        solutions.append(least_squares(residual, start, slopes, method="lm", x_scale="jac"))
    return np.split(min(solutions, key=lambda solution: solution.cost).x, [shapes])


def _misfit(left: Array, explained: Array) -> float:
    """Return the part of a loop's width that no source explains, if it is beyond chance [1]."""
    fit = linear_fit(explained[:, np.newaxis], left)
    is_beyond = abs(fit.values[0]) > MIN_MISFIT_SIGMA * fit.sigma[0]
    return float(abs(fit.values[0])) if is_beyond else 0.0


# ---- Curve that both ways share --------------------------------------------------------------------------------------


def _curve(loop: LossLoop, widths: Array | None, at_ends: tuple[float, float] | None) -> Curve:
    """Return the curve of a loop by splines, beside half widths of sources, shape (n, k); if None, those on a linear spring."""
    splines = _splines(loop)
    if widths is None:
        low, high = loop.ends
        way = 2.0 * (loop.twist - low) / (high - low) - 1.0
        bow = np.clip(1.0 - way**2, 0.0, None)
        widths = loop.sense[:, np.newaxis] * np.stack([np.ones_like(way), np.abs(way), np.sqrt(bow), bow], axis=1)
    coefficients = solved(np.column_stack((splines, widths)), loop.torque)
    torque = splines @ coefficients[: splines.shape[1]]
    return Curve(torque, *(at_ends or (_at_end(loop.twist, torque, end) for end in loop.ends)))


def _columns_without_loss(loop: LossLoop, curve: Curve) -> Array:
    """Return orthonormal columns that no loss determines: the curve, and a width that differs between both senses.

    An error of the zero of the torque changes the width in proportion to load as the latter does.
    """
    columns = [_splines(loop)]
    if min(-curve.low, curve.high) > MIN_BOTH_SENSES * (curve.high - curve.low):
        columns.append((loop.sense * np.sign(curve.torque))[:, np.newaxis])
    return np.asarray(np.linalg.qr(np.concatenate(columns, axis=1))[0])


def _splines(loop: LossLoop) -> Array:
    """Return cubic splines over the twist, shape (n, pieces + 3)."""
    from scipy.interpolate import BSpline

    pieces = int(np.clip(len(loop.twist) // (2 * SAMPLES_PER_PIECE), 1, MAX_PIECES_OF_CURVE))
    low, high = float(loop.twist.min()), float(loop.twist.max())
    knots = np.concatenate(([low] * 3, np.linspace(low, high, pieces + 1), [high] * 3))
    return np.asarray(BSpline.design_matrix(loop.twist, knots, 3).toarray())


def _at_end(twist: Array, torque: Array, end: float) -> float:
    """Return the torque at a reversal by a line through the curve next to it [N.m]."""
    away = np.round(np.abs(twist - end) / np.ptp(twist), 6)
    near = away <= max(END_SHARE, float(np.unique(away)[:MIN_AT_END][-1]))
    return float(np.polyval(np.polyfit(twist[near] - end, torque[near], 1), 0.0))
