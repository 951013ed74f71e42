r"""Harmonics of a table of the mesh over the angle of the wave generator, at each load.

.. math:: y_j(\theta) = m_j + \mathrm{Im} \sum_h c_{hj} e^{i h \theta}

by least squares, with h all multiples of `repeats` below half of the samples of a turn. |c| is the amplitude of an order, its
argument the phase, as of a sine.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import degrees, log, tau
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.files.mesh_table import MAX_LOADS, PLACE_UNITS, MeshTable
from strainwave.messages import MAX_NAMES, in_a_sentence

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_ORDERS = 1024  # that are looked for, multiples of `repeats`
EVEN_STEP = 1e-6  # relative difference of steps that are even
MAX_LOAD_SPREAD = 1e-3  # of the largest torque, by which rows of one load differ, as a solver's tolerance makes them
ROWS_PER_BLOCK = 8192  # whose normal equations are summed at once
MIN_ORDERS_OF_NOISE = 16  # of fewer a quarter is no sample of noise
FLOOR_QUANTILE = 0.25  # of the squares of all amplitudes: noise makes it as long as three of four orders contain something
MAX_LEVEL_RATIO = 10.0  # of the floors of the lower and the higher orders; noise of 16 orders exceeds it in 2 % of tables
RELATIVE_ROUNDING = 1e-10  # of the largest amplitude: a smaller one is rounding
ROUNDING = float(np.finfo(float).eps)  # of the largest mean, likewise
MAX_OTHER_ORDER = 0.1  # of the largest amplitude, of an order that is no multiple of `repeats`
FALSE_REFUSAL = 1e-6  # probability that noise makes such an order
UNEVEN_GAP = 1.5  # times the usual distance of angles, from which a gap is named
NO_NOISE = "the noise of the solver is not determined"


@dataclass(frozen=True, eq=False)
class Harmonics:
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
        squares, rounding = np.abs(self.waves) ** 2, ROUNDING * float(np.abs(self.mean).max(initial=0.0))
        largest = max(float(squares.max()) * RELATIVE_ROUNDING**2, rounding**2)
        threshold = max(self.noise**2 * log(squares.size / false_alarm), largest)
        return np.asarray((squares > threshold).any(axis=0))


def harmonics(table: MeshTable, quantity: str, repeats: float) -> Harmonics:
    """Return the harmonics of a quantity that repeats so many times in a turn.

    Raises:
        ValueError: the angles of a load determine no order, or the torque is no few loads
    """
    loads, values = _loads(table, repeats), getattr(table, quantity)
    worst = max(loads, key=lambda load: load.gap)
    count = min(int(np.ceil(0.5 * tau / repeats / worst.gap * (1.0 - EVEN_STEP))) - 1, MAX_ORDERS)
    if count < 1 or any(load.steps[1] > np.pi for load in loads):
        raise ValueError(worst.undetermined(repeats))
    fits = [_fit(table.angle[load.rows], values[load.rows], repeats, count) for load in loads]
    mean, waves = np.array([mean for mean, _ in fits]), np.array([waves for _, waves in fits])
    noise, of_noise = _noise(waves)
    torque, orders = np.array([load.torque for load in loads]), repeats * np.arange(1.0, count + 1.0)
    return Harmonics(torque, orders, mean, waves, noise, (*worst.remarks(orders), *of_noise))


def check_repeats(table: MeshTable, quantity: str, repeats: int) -> None:
    """Raise ValueError if a table of several periods has orders that contradict the number of times that all repeats."""
    period, angle = tau / repeats, np.unique(table.angle)
    span = float(np.ptp(angle) + np.diff(angle).max(initial=0.0))
    periods = min(int(span / period * (1.0 + EVEN_STEP)), repeats)
    if periods < 2:
        return
    whole = _rows_of(table, table.angle < angle[0] + periods * period * (1.0 - EVEN_STEP))
    of_all = harmonics(whole, quantity, repeats / periods)
    amplitude = np.abs(of_all.waves).max(axis=0)
    others = of_all.significant(FALSE_REFUSAL) & (amplitude > MAX_OTHER_ORDER * amplitude.max())
    others[periods - 1 :: periods] = False
    if others.any():
        names, sizes = (
            in_a_sentence([f"{x:.4g}" for x in values[others][:MAX_NAMES]]) for values in (of_all.orders, amplitude)
        )
        raise ValueError(f"order {names} has an amplitude of {sizes} and is no multiple of repeats={repeats}; give repeats=1")


def complete_loads(table: MeshTable, repeats: int) -> tuple[MeshTable, tuple[str, ...]]:
    """Return a table without loads that have a hole which other loads do not have, and remarks on those."""
    loads = _loads(table, repeats)
    least = min(load.gap for load in loads)
    kept, remarks = np.ones(len(table.angle), bool), []
    for load in loads:
        if load.gap > UNEVEN_GAP * max(load.steps[0], least):
            kept[load.rows] = False
            hole = f"angles are missing over {degrees(load.gap):.3g} deg"
            remarks.append(f"at {load.torque:g} N.m {hole}: this load is left out; compute its missing rows")
    return _rows_of(table, kept) if remarks else table, tuple(remarks)


def _rows_of(table: MeshTable, rows: NDArray[np.bool_]) -> MeshTable:
    return replace(table, **{name: getattr(table, name)[rows] for name in (*PLACE_UNITS, *table.quantities)})


class _Load(NamedTuple):
    """Rows of a load, its torque [N.m], its angles, increasing, and the largest gap between them in a period [rad]."""

    rows: NDArray[np.int_]
    torque: float
    angle: Array
    gap: float

    @property
    def steps(self) -> tuple[float, float]:
        """The usual and the largest distance of its angles [rad]; 0 of one angle."""
        steps = np.diff(self.angle)
        return (float(np.median(steps)), float(steps.max())) if len(steps) else (0.0, 0.0)

    def undetermined(self, repeats: float) -> str:
        """Return the message of angles that determine no order."""
        (usual, widest), span, period = self.steps, float(np.ptp(self.angle)), tau / repeats
        first, last = np.degrees(self.angle[[0, -1]])
        where = f"at {self.torque:g} N.m the angles go from {first:.4g} to {last:.4g} deg"
        if widest > np.pi:
            far = "angles that are more than half a turn apart are no table: check their unit"
            return f"{where}, {widest:.4g} rad apart; {far}"
        if self.gap > 2.0 * usual > 0.0 and span < period:
            share = round(tau / (span + usual))
            of_part = f"; give repeats={share} if all repeats {share} times in a turn (two lobes alike: 2)"
            whole = f"{where}, less than the {degrees(period):.4g} deg in which it repeats: no order is determined"
            return f"{whole}{of_part if share > repeats else ''}, or compute more"
        needed = f"order {repeats:g} needs less than {180.0 / repeats:g} deg"
        return f"{where}, {degrees(self.gap):.4g} deg apart: {needed}; check the unit of the angle, or compute more"

    def remarks(self, orders: Array) -> Iterator[str]:
        """Yield remarks on the angles, and on the orders that they determine."""
        usual, span = self.steps[0], float(np.ptp(self.angle))
        if span > tau + usual:
            alone = "and whole orders alone are looked for: check the unit of the angle"
            yield f"the angles span {span / tau:.3g} turns, {alone}"
        if self.gap > UNEVEN_GAP * usual:
            yield f"the largest gap between angles is {degrees(self.gap):.3g} deg, the usual one {degrees(usual):.3g} deg"
        why = f"the first {MAX_ORDERS} are looked for" if len(orders) == MAX_ORDERS else "half the samples of a turn"
        yield f"orders up to {orders[-1]:g} are determined ({why}); a higher one would appear as a lower one"


def _loads(table: MeshTable, repeats: float) -> list[_Load]:
    """Return the loads, increasing."""
    order, period = np.argsort(table.torque, kind="stable"), tau / repeats
    tolerance = MAX_LOAD_SPREAD * float(np.abs(table.torque).max())
    groups = np.split(order, np.flatnonzero(np.diff(table.torque[order]) > tolerance) + 1)
    if len(groups) > MAX_LOADS or any(float(np.ptp(table.torque[rows])) > 2.0 * tolerance for rows in groups):
        raise ValueError("the torque varies from row to row; give rows at a few loads, each at all angles")
    loads = []
    for rows in groups:
        within = np.unique(np.mod(table.angle[rows], period))
        gap = float(np.diff(np.append(within, within[0] + period)).max())
        loads.append(_Load(rows, float(table.torque[rows].mean()), np.unique(table.angle[rows]), gap))
    return loads


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
