r"""Change of the orders of a transmission error with the load.

With e the complex amplitudes of the kinematic error without load, v those of the relative variation of the stiffness, c the
compliance at the load,

.. math:: c_{hj} = \frac{e_h}{(1 + \kappa_T |T_j|)^2} - T_j \, c(T_j) \, v_h

The square is that of an error that falls by r = 1 / (1 + kappa_T |T|) and conserves energy (kinematic_error.Scaled): as the
error falls with the torque of the spring, the spring bears T (1 + k e dr/dT) under a load T, with k its stiffness. To the first
order the transmission error is then e (r + T dr/dT) + T / k. The first term of the sum is even in the torque, the second one
odd if the spring is: loads of both signs separate them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from strainwave.messages import in_a_sentence
from strainwave.orders.mesh.harmonics import Harmonics
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA
from strainwave.typeset import quantity

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MIN_LOADS = 3  # that determine a change with the load
RELATIVE_NOISE = 1e-3  # of the largest amplitude: a solver is not believed to be more exact (assumed)
MIN_FALL, MAX_FALL = 1e-4, 100.0  # of the error at the largest load over what is left there, between which it is looked for
SEARCH_POINTS = 60
MAX_STEPS = 30  # of Gauss and Newton, from the best of these points
NOISE_QUANTILE = 0.25  # of what a model leaves of the orders: most of them may have a misfit
MAX_LEFT_BY_FALL = 0.5  # of the squares without it, by a fall in the model: orders that fall each by its own rate have none
NAMED_MISFIT = 5.0  # times the noise, from which what a model leaves is stated


@dataclass(frozen=True, eq=False)
class LoadFit:
    """Change of the orders with the load, by least squares.

    Attributes:
        data: orders that are not left out, whose waves are fitted; the others are 0
        falls: True in a model of an error that falls with the torque
        sensitivity: relative fall of it [1/(N.m)]; 0 in a model without
        columns: of the error and, in a model with it, of the variation of the stiffness over the loads, shape (m, 1 or 2)
        coefficients: complex amplitudes of both [rad] and [1], shape (1 or 2, h)
        remarks: in words
        unlike: share of the largest order by which the data differ from the laws at orders that the laws make of others: the
            form of the laws is off by as much, also where it is not seen [1]
    """

    data: Harmonics
    falls: bool
    sensitivity: float
    columns: Array
    coefficients: Complex
    remarks: tuple[str, ...] = ()
    unlike: float = 0.0

    @cached_property
    def left(self) -> Complex:
        """Residual of the waves [rad], shape (m, h)."""
        return np.asarray(self.data.waves - self.columns @ self.coefficients)

    @property
    def squares(self) -> float:
        """Sum of the squares that it leaves."""
        return float(np.sum(np.abs(self.left) ** 2))

    @property
    def misfit(self) -> Array:
        """Root mean square over the loads of what it leaves of each order [rad], shape (h,)."""
        return np.asarray(np.sqrt(np.mean(np.abs(self.left) ** 2, axis=0)))

    @property
    def counts(self) -> tuple[int, int]:
        """Number of real numbers that it is fitted to, at least 1, and of its real unknowns."""
        orders = 2 * int(np.count_nonzero(self.coefficients[0]))
        return max(len(self.left) * orders, 1), len(self.coefficients) * orders + self.falls

    def criterion(self, noise: float) -> float:
        """Bayesian information criterion (Schwarz 1978)."""
        data, unknowns = self.counts
        return 2.0 * self.squares / noise**2 + unknowns * float(np.log(data))

    def slope(self) -> tuple[Complex, Complex]:
        """Return the change of the waves with the sensitivity: what the coefficients make up of it, and what they do not."""
        level = np.abs(self.data.torque)
        slope = np.outer(-2.0 * level / (1.0 + self.sensitivity * level) ** 3, self.coefficients[0])
        made_up = solved(self.columns, slope)
        return made_up, slope - self.columns @ made_up

    @cached_property
    def sigmas(self) -> tuple[float, Array]:
        """Standard deviations of the sensitivity [1/(N.m)] and of the coefficients, by noise or by what the model leaves."""
        data, unknowns = self.counts
        of_order = np.sqrt(data / max(data - unknowns, 1)) * self.misfit  # one load leaves nothing
        # A fall in common takes the noise out of one order; it is in all, so a lower one of them shows it.
        shown = of_order[self.coefficients[0] != 0.0].tolist() or [0.0]
        level = float(np.quantile(shown, NOISE_QUANTILE, method="lower"))
        form = self.unlike * np.abs(self.coefficients[0])
        scatter = np.max([np.full_like(of_order, max(self.data.noise, level)), form, of_order], axis=0)
        of_orders = np.outer(np.sqrt(np.diag(np.linalg.inv(self.columns.T @ self.columns))), scatter)
        if not self.falls:
            return 0.0, of_orders
        made_up, own = self.slope()
        information = np.sum(np.abs(own) ** 2, axis=0)
        of_fall = float(np.sqrt(0.5 * np.sum(scatter**2 * information)) / information.sum())
        return of_fall, np.hypot(of_orders, of_fall * np.abs(made_up))

    @property
    def sigma(self) -> Array:
        """Standard deviation of the error, with what the model leaves: no number of loads averages that out [rad], (h,)."""
        beyond_noise = np.maximum(self.misfit**2 - self.data.noise**2, 0.0)
        return np.asarray(np.sqrt(self.sigmas[1][0] ** 2 + beyond_noise))

    @property
    def variation(self) -> Complex:
        """Complex amplitudes of the relative variation of the stiffness, zeros if none is determined [1], shape (h,)."""
        if len(self.coefficients) < 2:
            return np.zeros_like(self.coefficients[0])
        # Products of error and variation are in other orders: what is left of one order may be in another one as a variation.
        least = SIGNIFICANCE_SIGMA * float(self.sigmas[1][1].max())
        return np.where(np.abs(self.coefficients[1]) > least, self.coefficients[1], 0.0)


def load_fit(data: Harmonics, compliance: Array | None) -> LoadFit:
    """Return how the orders change with the load.

    Args:
        data: orders at the loads; waves of orders left out are 0
        compliance: at each load [rad/(N.m)], shape (m,); None if the variation of the stiffness is no unknown
    """
    torque, sizes = data.torque, len(np.unique(np.abs(data.torque)))
    several = len(torque) >= MIN_LOADS and bool(data.waves.any())
    others = [[], [-torque * compliance]] if several and compliance is not None else [[]]
    models = [_fit(data, columns, falls=falls) for falls in sorted({False, several and sizes > 1}) for columns in others]
    believed = max(data.noise, RELATIVE_NOISE * float(np.abs(data.waves).max()), 1e-150)
    without_fall = min((model for model in models if not model.falls), key=lambda model: model.criterion(believed))
    chosen = min(models, key=lambda model: model.criterion(believed))
    chosen = without_fall if chosen.squares > MAX_LEFT_BY_FALL * without_fall.squares else chosen
    inseparable = len(others) > 1 and chosen is not models[0] and not torque.min() < 0.0 < torque.max()
    remarks = _remarks(chosen, inseparable, believed) if data.waves.any() else []
    return replace(models[0] if inseparable else chosen, remarks=tuple(remarks))


def _remarks(chosen: LoadFit, inseparable: bool, believed: float) -> Iterator[str]:
    """Yield a remark on the change with the load, if it is not in the model or not tested."""
    torque, left = chosen.data.torque, float(np.sqrt(2.0 * chosen.squares / chosen.counts[0]))
    change, neither, one = _change(chosen.data), "neither is in the model; add", "choose one load by load="
    fall, variation = "a fall of the error", "a variation of the stiffness"
    if len(torque) == 1:
        where = f"at one load, {torque[0]:g} N.m"
        yield f"{where}, the change of the error with the load is not determined: it is constant in the model"
    elif len(torque) < MIN_LOADS:
        yield f"{change}; two loads do not separate {fall} from {variation}: {neither} a load, or {one}"
    elif inseparable:
        more = f"{neither} loads of the other sign or the column stiffness, or {one}"
        yield f"{change}; {fall} and {variation} are not separable in it: {more}"
    elif left > NAMED_MISFIT * believed:
        yield f"{change}; {quantity(left, 'rad')} of it (rms) is no fall and no variation as the laws have it"
    elif chosen.falls and len(np.unique(np.abs(torque))) == 2:
        yield f"between 0 and {np.abs(torque).max():g} N.m the form of the fall is not tested; add loads between"


def _fit(data: Harmonics, others: list[Array], *, falls: bool) -> LoadFit:
    """Return the model of least squares."""
    level = np.abs(data.torque)

    def model(sensitivity: float) -> LoadFit:
        columns = np.column_stack([(1.0 + sensitivity * level) ** -2.0, *others])
        return LoadFit(data, falls, sensitivity, columns, np.atleast_2d(solved(columns, data.waves)))

    if not falls:
        return model(0.0)
    starts = np.geomspace(MIN_FALL, MAX_FALL, SEARCH_POINTS) / float(level.max())
    best = min(map(model, starts.tolist()), key=lambda fit: fit.squares)
    for _ in range(MAX_STEPS):
        _, own = best.slope()
        step = float(np.sum((own.conj() * best.left).real) / np.sum(np.abs(own) ** 2))
        better = model(max(best.sensitivity + step, 0.0))
        if not better.squares < best.squares:
            break
        best = better
    return best


def _change(data: Harmonics) -> str:
    """Return the largest change of an order with the load in words."""
    least = int(np.argmin(np.abs(data.torque)))
    moved = np.abs(data.waves - data.waves[least])
    load, order = np.unravel_index(int(np.argmax(moved)), moved.shape)
    ends = in_a_sentence([f"{data.torque[place]:g} N.m" for place in (least, load)])
    return f"between {ends} an order changes by up to {quantity(float(moved[load, order]), 'rad')}"
