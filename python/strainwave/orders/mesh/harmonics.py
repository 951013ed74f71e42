r"""Harmonics of a table of the mesh over the angle of the wave generator, at each load.

.. math:: y_j(\theta) = m_j + \mathrm{Im} \sum_h c_{hj} e^{i h \theta}

by least squares, with h all multiples of `repeats` below half of the samples of a turn. |c| is the amplitude of an order, its
argument the phase, as of a sine.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, tau

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.messages import MAX_NAMES, in_a_sentence

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_ORDERS = 1024  # that are looked for, multiples of `repeats`
EVEN_STEP = 1e-6  # relative difference of steps that are even
MAX_LOAD_SPREAD = 1e-3  # of the largest torque, by which rows of one load differ, as a solver's tolerance makes them
MAX_LOAD_COUNT = 1000
ROWS_PER_BLOCK = 8192  # whose normal equations are summed at once
MIN_ORDERS_OF_NOISE = 16  # of fewer a quarter is no sample of noise
FLOOR_QUANTILE = 0.25  # of the squares of all amplitudes: noise makes it as long as three of four orders contain something
MAX_LEVEL_RATIO = 10.0  # of the floors of the lower and the higher orders; noise of 16 orders exceeds it in 2 % of tables
RELATIVE_ROUNDING = 1e-10  # of the largest amplitude: a smaller one is rounding
MAX_OTHER_ORDER = 0.1  # of the largest amplitude, of an order that is no multiple of `repeats`
FALSE_REFUSAL = 1e-6  # probability that noise makes such an order
UNEVEN_GAP = 1.5  # times the usual distance of angles, from which a gap is named
NO_NOISE = "the noise of the solver is not determined"


@dataclass(frozen=True, eq=False)
class Harmonics(ComparedByFields):
    """Harmonics of one quantity of a table.

    Attributes:
        torque: of the loads [N.m], increasing, shape (m,)
        orders: that the angles determine [1], shape (h,)
        mean: over the angle, in the unit of the quantity, shape (m,)
        waves: complex amplitudes in the unit of the quantity, shape (m, h)
        noise: standard deviation of a complex amplitude by the noise of the solver; 0 if that is rounding, or not determined
        remarks: in words
    """

    torque: Array
    orders: Array
    mean: Array
    waves: Complex
    noise: float
    remarks: tuple[str, ...]

    def significant(self, false_alarm: float) -> NDArray[np.bool_]:
        """Return the orders that stand out of the noise at a load or more, shape (h,).

        Args:
            false_alarm: probability that noise alone makes any order of any load stand out
        """
        squares = np.abs(self.waves) ** 2
        threshold = max(self.noise**2 * log(squares.size / false_alarm), float(squares.max()) * RELATIVE_ROUNDING**2)
        return np.asarray((squares > threshold).any(axis=0))


def harmonics(angle: Array, torque: Array, values: Array, repeats: float) -> Harmonics:
    """Return the harmonics of a quantity.

    Args:
        angle: of the wave generator [rad], shape (n,)
        torque: [N.m], shape (n,)
        values: in any unit, shape (n,)
        repeats: number of times that it repeats in a turn

    Raises:
        ValueError: the angles of a load determine no order, or the torque is no few loads
    """
    period = tau / repeats
    rows_of_loads = _loads(torque)
    gaps = [_largest_gap(angle[rows], period) for rows in rows_of_loads]
    loads = np.array([torque[rows].mean() for rows in rows_of_loads])
    worst = int(np.argmax(gaps))
    count = min(int(np.ceil(0.5 * period / gaps[worst] * (1.0 - EVEN_STEP))) - 1, MAX_ORDERS)
    if count < 1 or any(len(rows) > 1 and np.diff(np.unique(angle[rows])).max(initial=0.0) > np.pi for rows in rows_of_loads):
        raise ValueError(_undetermined(angle[rows_of_loads[worst]], float(loads[worst]), gaps[worst], repeats))
    orders = repeats * np.arange(1.0, count + 1.0)
    fits = [_fit(angle[rows], values[rows], repeats, count) for rows in rows_of_loads]
    mean, waves = np.array([fit[0] for fit in fits]), np.array([fit[1] for fit in fits])
    noise, of_noise = _noise(waves)
    remarks = *_of_gap(angle[rows_of_loads[worst]], gaps[worst], orders), *of_noise
    return Harmonics(loads, orders, mean, waves, noise, remarks)


def check_repeats(angle: Array, torque: Array, values: Array, repeats: int) -> None:
    """Raise ValueError if a table of several periods has orders that contradict the number of times that all repeats."""
    period = tau / repeats
    span = float(np.ptp(angle)) + float(np.diff(np.unique(angle)).max(initial=0.0))
    periods = min(int(span / period * (1.0 + EVEN_STEP)), repeats)
    if periods < 2:
        return
    rows = angle < angle.min() + periods * period * (1.0 - EVEN_STEP)
    found = harmonics(angle[rows], torque[rows], values[rows], repeats / periods)
    amplitude = np.abs(found.waves).max(axis=0)
    others = found.significant(FALSE_REFUSAL) & (amplitude > MAX_OTHER_ORDER * amplitude.max())
    others[periods - 1 :: periods] = False
    if others.any():
        names, sizes = (in_a_sentence([f"{each:.4g}" for each in of[others][:MAX_NAMES]]) for of in (found.orders, amplitude))
        raise ValueError(f"order {names} has an amplitude of {sizes} and is no multiple of repeats={repeats}; give repeats=1")


def complete_loads(angle: Array, torque: Array, repeats: int) -> tuple[NDArray[np.bool_], tuple[str, ...]]:
    """Return the rows of loads without a hole that other loads do not have, shape (n,), and remarks on loads left out."""
    rows_of_loads, kept, remarks = _loads(torque), np.ones(len(angle), bool), []
    gaps = [_largest_gap(angle[rows], tau / repeats) for rows in rows_of_loads]
    for rows, gap in zip(rows_of_loads, gaps, strict=True):
        usual = max(float(np.median(np.diff(np.unique(angle[rows])))) if len(rows) > 1 else 0.0, min(gaps))
        if gap > UNEVEN_GAP * usual:
            kept[rows] = False
            hole = f"angles are missing over {np.degrees(gap):.3g} deg"
            remarks.append(f"at {torque[rows].mean():g} N.m {hole}: this load is left out; compute its missing rows")
    return kept, tuple(remarks)


def _loads(torque: Array) -> list[NDArray[np.int_]]:
    """Return the rows of each load, loads increasing."""
    order = np.argsort(torque, kind="stable")
    tolerance = MAX_LOAD_SPREAD * float(np.abs(torque).max())
    groups = np.split(order, np.flatnonzero(np.diff(torque[order]) > tolerance) + 1)
    if len(groups) > MAX_LOAD_COUNT or any(float(np.ptp(torque[rows])) > 2.0 * tolerance for rows in groups):
        raise ValueError("the torque varies from row to row; give rows at a few loads, each at all angles")
    return groups


def _largest_gap(angle: Array, period: float) -> float:
    """Return the largest distance of neighbouring angles in a period [rad]."""
    within = np.unique(np.mod(angle, period))
    return float(np.diff(np.append(within, within[0] + period)).max())


def _undetermined(angle: Array, torque: float, gap: float, repeats: float) -> str:
    """Return the message of angles that determine no order."""
    span, period = float(np.ptp(angle)), tau / repeats
    where = f"at {torque:g} N.m the angles go from {np.degrees(angle.min()):.4g} to {np.degrees(angle.max()):.4g} deg"
    steps = np.diff(np.unique(angle))
    if len(steps) and steps.max() > np.pi:
        return (
            f"{where}, {steps.max():.4g} rad apart; angles that are more than half a turn apart are no table: check their unit"
        )
    if len(steps) and gap > 2.0 * float(np.median(steps)) and span < period:
        share = round(tau / (span + float(np.median(steps))))
        of_part = (
            f"; give repeats={share} if all repeats {share} times in a turn (two lobes alike: 2)" if share > repeats else ""
        )
        whole = f"{np.degrees(period):.4g} deg in which it repeats"
        return f"{where}, less than the {whole}: no order is determined{of_part}, or compute more"
    needed = f"order {repeats:g} needs less than {180.0 / repeats:g} deg"
    return f"{where}, {np.degrees(gap):.4g} deg apart: {needed}; check the unit of the angle, or compute more"


def _of_gap(angle: Array, gap: float, orders: Array) -> list[str]:
    usual = float(np.median(np.diff(np.unique(angle)))) if len(angle) > 1 else gap
    remarks = []
    if float(np.ptp(angle)) > tau + usual:
        turns = float(np.ptp(angle)) / tau
        remarks.append(f"the angles span {turns:.3g} turns, and whole orders alone are looked for: check the unit of the angle")
    if gap > UNEVEN_GAP * usual:
        remarks.append(
            f"the largest gap between angles is {np.degrees(gap):.3g} deg, the usual one {np.degrees(usual):.3g} deg"
        )
    why = f"the first {len(orders)} are looked for" if len(orders) == MAX_ORDERS else "half the samples of a turn"
    return [*remarks, f"orders up to {orders[-1]:g} are determined ({why}); a higher one would appear as a lower one"]


def _fit(angle: Array, values: Array, repeats: float, count: int) -> tuple[float, Complex]:
    """Return the mean and the waves of the values of one load, by normal equations.

    In the waves exp(i k theta) of both signs of k their matrix is a Toeplitz matrix of sums of such waves over the rows.
    """
    from scipy.linalg import solve_toeplitz

    middle = float(values.mean())
    sums, right = np.zeros(2 * count + 1, complex), np.zeros(count + 1, complex)
    for begin in range(0, len(angle), ROWS_PER_BLOCK):
        part = slice(begin, begin + ROWS_PER_BLOCK)
        turn, rest = np.exp(1j * repeats * angle[part]), values[part] - middle
        wave = np.ones_like(turn)
        for k in range(2 * count + 1):
            sums[k] += wave.sum()
            if k <= count:
                right[k] += rest @ wave.conj()
            wave *= turn
    both = np.concatenate([right[:0:-1].conj(), right])
    coefficients = solve_toeplitz((sums.conj(), sums), both)[count:]
    return middle + float(coefficients[0].real), 2j * coefficients[1:]


def _noise(waves: Complex) -> tuple[float, tuple[str, ...]]:
    """Return the standard deviation of an amplitude by noise, and a remark if it is not determined.

    Noise has one level at all orders. Its mean square is that of exponentially distributed squares of the same lower quartile.
    """
    squares = np.abs(waves) ** 2
    if squares.shape[1] < MIN_ORDERS_OF_NOISE:
        return 0.0, (f"{NO_NOISE}: the angles determine fewer than {MIN_ORDERS_OF_NOISE} orders",)
    lower, higher = (float(np.quantile(half, FLOOR_QUANTILE)) for half in np.array_split(squares, 2, axis=1))
    if lower < float(squares.max()) * RELATIVE_ROUNDING**2:
        return 0.0, ()
    if lower > MAX_LEVEL_RATIO * higher:
        return 0.0, (f"{NO_NOISE}: amplitudes fall up to the highest order, and reach no level; add angles",)
    return float(np.sqrt(np.quantile(squares, FLOOR_QUANTILE) / -log(1.0 - FLOOR_QUANTILE))), ()
