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

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_ORDERS = 1024  # that are looked for at even angles, multiples of `repeats`
MAX_ORDERS_OF_UNEVEN = 64  # likewise at uneven angles, by normal equations
EVEN_STEP = 1e-6  # relative difference of steps that are even
MAX_LOAD_SPREAD = 1e-3  # of the largest torque, by which rows of one load differ, as a solver's tolerance makes them
MAX_LOAD_COUNT = 1000
ROWS_PER_BLOCK = 8192  # whose normal equations are summed at once
FLOOR_QUANTILE = 0.25  # of the squares of all amplitudes: noise makes it as long as three of four orders contain something
RELATIVE_ROUNDING = 1e-12  # of the largest amplitude: a smaller one is rounding
UNEVEN_GAP = 1.5  # times the usual distance of angles, from which a gap is named


@dataclass(frozen=True, eq=False)
class Harmonics(ComparedByFields):
    """Harmonics of one quantity of a table.

    Attributes:
        torque: of the loads [N.m], increasing, shape (m,)
        orders: that the angles determine [1], shape (h,)
        mean: over the angle, in the unit of the quantity, shape (m,)
        waves: complex amplitudes in the unit of the quantity, shape (m, h)
        floor: mean square of the amplitude that noise of the solver makes of an order
        gap: largest distance of neighbouring angles [rad]
        remarks: in words
    """

    torque: Array
    orders: Array
    mean: Array
    waves: Complex
    floor: float
    gap: float
    remarks: tuple[str, ...]

    def significant(self, false_alarm: float) -> NDArray[np.bool_]:
        """Return the orders that stand out of the noise at a load or more, shape (h,).

        Args:
            false_alarm: probability that noise alone makes any order of any load stand out
        """
        threshold = self.floor * log(self.waves.size / false_alarm)
        return np.asarray((np.abs(self.waves) ** 2 > threshold).any(axis=0))


def harmonics(angle: Array, torque: Array, values: Array, repeats: int) -> Harmonics:
    """Return the harmonics of a quantity.

    Args:
        angle: of the wave generator [rad], shape (n,)
        torque: [N.m], shape (n,)
        values: in any unit, shape (n,)
        repeats: number of times that it repeats in a turn

    Raises:
        ValueError: the angles of a load determine no order, or the torque is no few loads
    """
    rows_of_loads = _loads(torque)
    gaps = [_largest_gap(angle[rows], tau / repeats) for rows in rows_of_loads]
    loads = np.array([torque[rows].mean() for rows in rows_of_loads])
    worst = int(np.argmax(gaps))
    are_even = all(_is_even(angle[rows], tau / repeats) for rows in rows_of_loads)
    most = MAX_ORDERS if are_even else MAX_ORDERS_OF_UNEVEN
    count = min(int(np.ceil(np.pi / (repeats * gaps[worst]) * (1.0 - EVEN_STEP))) - 1, most)
    if count < 1 or any(len(rows) > 1 and np.diff(np.unique(angle[rows])).max(initial=0.0) > np.pi for rows in rows_of_loads):
        raise ValueError(_undetermined(angle[rows_of_loads[worst]], float(loads[worst]), gaps[worst], repeats))
    orders = repeats * np.arange(1.0, count + 1.0)
    fit = _transform if are_even else _fit
    fits = [fit(angle[rows], values[rows], repeats, count) for rows in rows_of_loads]
    mean, waves = np.array([fit[0] for fit in fits]), np.array([fit[1] for fit in fits])
    return Harmonics(
        loads, orders, mean, waves, _floor(waves), gaps[worst], tuple(_of_gap(angle[rows_of_loads[worst]], gaps[worst], orders))
    )


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


def _undetermined(angle: Array, torque: float, gap: float, repeats: int) -> str:
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
    needed = f"order {repeats} needs less than {180.0 / repeats:g} deg"
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
    limits = MAX_ORDERS, MAX_ORDERS_OF_UNEVEN
    why = f"the first {len(orders)} are looked for" if len(orders) in limits else "half the samples of a turn"
    return [*remarks, f"orders up to {orders[-1]:g} are determined ({why}); a higher one would appear as a lower one"]


def _is_even(angle: Array, period: float) -> bool:
    """True if angles cut a period into even steps."""
    within = np.sort(np.mod(angle, period))
    steps = np.diff(np.append(within, within[0] + period))
    return bool(np.ptp(steps) < EVEN_STEP * period / len(angle))


def _transform(angle: Array, values: Array, repeats: int, count: int) -> tuple[float, Complex]:
    """Return the mean and the waves of values at angles that cut a period into even steps."""
    within = np.mod(angle, tau / repeats)
    order = np.argsort(within)
    spectrum = np.fft.rfft(values[order]) / len(values)
    turn = np.exp(-1j * repeats * within[order[0]] * np.arange(count + 1))
    return float(spectrum[0].real), 2j * (spectrum[: count + 1] * turn)[1:]


def _fit(angle: Array, values: Array, repeats: int, count: int) -> tuple[float, Complex]:
    """Return the mean and the waves of the values of one load, by normal equations.

    In the waves exp(i k theta) of both signs of k their matrix is a Toeplitz matrix of sums of such waves over the rows.
    """
    from scipy.linalg import toeplitz

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
    coefficients = np.linalg.solve(toeplitz(sums.conj(), sums), both)[count:]
    return middle + float(coefficients[0].real), 2j * coefficients[1:]


def _floor(waves: Complex) -> float:
    """Return the mean square that noise makes: that of exponentially distributed squares with the same lower quartile."""
    squares = np.abs(waves) ** 2
    noise = float(np.quantile(squares, FLOOR_QUANTILE)) / -log(1.0 - FLOOR_QUANTILE)
    return max(noise, float(squares.max()) * RELATIVE_ROUNDING**2, 1e-300)
