r"""Spring of a gear, and how its orders change with the load, by the harmonics of a table of the mesh.

With e the complex amplitudes of the kinematic error without load, v those of the relative variation of the stiffness, c the
compliance at the load,

.. math:: c_{hj} = \frac{e_h}{(1 + \kappa_T |T_j|)^2} - T_j \, c(T_j) \, v_h

The square is that of an error that falls by r = 1 / (1 + kappa_T |T|) and conserves energy (kinematic_error.Scaled): as the
error falls with the torque of the spring, the spring bears T (1 + k e dr/dT) under a load T, with k its stiffness. To the first
order the transmission error is then e (r + T dr/dT) + T / k. The first term of the sum is even in the torque, the second one
odd if the spring is: loads of both signs separate them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from strainwave import stiffness
from strainwave.messages import in_a_sentence
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA
from strainwave.typeset import quantity

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_BEND = 0.002  # of the largest twist: a spring whose twist is off by less in the root mean square is straight enough
MAX_KNEE_LEVELS = 30  # loads that knees are looked for at
MIN_LOADS = 3  # that determine a change with the load
RELATIVE_NOISE = 1e-3  # of the largest amplitude: a solver is not believed to be more exact (assumed)
MIN_FALL, MAX_FALL = 1e-4, 100.0  # of the error at the largest load over what is left there, between which it is looked for
SEARCH_POINTS = 60
NOISE_QUANTILE = 0.25  # of what a model leaves of the orders: most of them may have a misfit
MAX_STEPS = 30  # of Gauss and Newton, from the best of these points
MAX_LEFT_BY_FALL = 0.5  # of the squares without it, by a fall in the model: orders that fall each by its own rate have none
NAMED_MISFIT = 5.0  # times the noise, from which what a model leaves is stated


# ---- Spring ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class SpringFit:
    """Spring of a gear.

    Attributes:
        law: Linear or ThreeSegment
        zero: transmission error without load, mean over the angle [rad]
        residual: root mean square of the twist that the law does not explain [rad]
    """

    law: stiffness.Linear | stiffness.ThreeSegment
    zero: float
    residual: float

    def compliance(self, torque: Array) -> Array:
        """Return the compliance at a torque [rad/(N.m)], shape (n,)."""
        return np.array([1.0 / self.law.tangent(self.law.twist(each)) for each in torque.tolist()])


def spring_fit(torque: Array, twist: Array, sigma: float) -> SpringFit:
    """Return the spring of the fewest segments that explains the mean twist at each load.

    Args:
        torque: of the loads [N.m], shape (m,), two different ones or more
        twist: mean over the angle, with any zero [rad], shape (m,)
        sigma: its standard deviation [rad]

    Raises:
        ValueError: the twist falls as the torque rises
    """
    tolerance = max(SIGNIFICANCE_SIGMA * sigma, MAX_BEND * float(np.ptp(twist)))
    best = None
    for knees in _knees(torque):
        columns = np.column_stack([np.ones_like(torque), *_segments(torque, knees)])
        values = solved(columns, twist)
        residual = float(np.sqrt(np.mean((twist - columns @ values) ** 2)))
        if not values[1:].min() > 0.0:
            continue
        if best is None or residual < best.residual:
            best = SpringFit(_law(1.0 / values[1:], knees), float(values[0]), residual)
        if best.residual <= tolerance:
            return best
    if best is None:
        raise ValueError("the twist falls as the torque rises")
    return best


def _knees(torque: Array) -> Iterator[tuple[float, ...]]:
    """Yield the knees of springs that the loads determine, the fewest first."""
    levels = np.unique(np.abs(torque[torque != 0.0]))[:-1]
    if len(levels) > MAX_KNEE_LEVELS:
        levels = levels[np.linspace(0, len(levels) - 1, MAX_KNEE_LEVELS).astype(int)]
    for count in (0, 1, 2):
        if count + 2 <= len(torque):
            yield from combinations(levels.tolist(), count)


def _segments(torque: Array, knees: Sequence[float]) -> list[Array]:
    """Return the torque in each segment of a spring."""
    ends = [0.0, *knees, np.inf]
    return [np.sign(torque) * np.clip(np.abs(torque) - low, 0.0, high - low) for low, high in pairwise(ends)]


def _law(slopes: Array, knees: Sequence[float]) -> stiffness.Linear | stiffness.ThreeSegment:
    if not knees:
        return stiffness.Linear(k=float(slopes[0]))
    k1, k2, k3 = (float(slopes[min(place, len(knees))]) for place in range(3))
    return stiffness.ThreeSegment(k1=k1, k2=k2, k3=k3, t1=knees[0], t2=knees[-1])


# ---- Orders over the load --------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class LoadFit:
    """Change of the orders with the load.

    Attributes:
        error: complex amplitudes of the error without load [rad], shape (h,)
        sigma: standard deviation of each, by noise and by what the model leaves of it over the loads [rad], shape (h,)
        variation: complex amplitudes of the relative variation of the stiffness [1], shape (h,); zeros if none is determined
        sensitivity, sensitivity_sigma: relative fall of the error with the torque [1/(N.m)], and its standard deviation
        misfit: root mean square over the loads of what the model leaves of each order [rad], shape (h,)
        remarks: in words
    """

    error: Complex
    sigma: Array
    variation: Complex
    sensitivity: float
    sensitivity_sigma: float
    misfit: Array
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class _Model:
    """A model of the change with the load, by its columns over the loads, and its coefficients of each order."""

    falls: bool
    sensitivity: float
    columns: Array
    coefficients: Complex
    left: Complex

    @property
    def orders(self) -> int:
        """Number of orders that are not left out."""
        return int(np.count_nonzero(self.coefficients[0]))

    @property
    def squares(self) -> float:
        """Sum of the squares that it leaves."""
        return float(np.sum(np.abs(self.left) ** 2))

    @property
    def unknowns(self) -> int:
        """Number of its real unknowns."""
        return 2 * len(self.coefficients) * self.orders + self.falls

    @property
    def data(self) -> int:
        """Number of real numbers that it is fitted to."""
        return 2 * len(self.left) * self.orders

    def criterion(self, noise: float) -> float:
        """Bayesian information criterion (Schwarz 1978)."""
        return 2.0 * self.squares / noise**2 + self.unknowns * float(np.log(self.data))

    def slope(self, torque: Array) -> tuple[Complex, Complex]:
        """Return the change of the waves with the sensitivity: what the coefficients make up of it, and what they do not."""
        level = np.abs(torque)
        slope = np.outer(-2.0 * level / (1.0 + self.sensitivity * level) ** 3, self.coefficients[0])
        made_up = solved(self.columns, slope)
        return made_up, slope - self.columns @ made_up

    def scatter(self, noise: float) -> Array:
        """Return the standard deviation of a wave, by noise or by what the model leaves of its order [rad], shape (h,)."""
        per_freedom = self.data / max(self.data - self.unknowns, 1)  # one load leaves nothing
        of_order = np.sqrt(per_freedom * np.mean(np.abs(self.left) ** 2, axis=0))
        # A fall in common takes the noise out of one order; it is in all, so a lower one of them shows it.
        level = float(np.quantile(of_order[self.coefficients[0] != 0.0], NOISE_QUANTILE, method="lower"))
        return np.asarray(np.maximum(max(noise, level), of_order))

    def sigmas(self, torque: Array, noise: float) -> tuple[float, Array]:
        """Return the standard deviations of the sensitivity [1/(N.m)] and of the coefficients, shape (p, h)."""
        scatter = self.scatter(noise)
        of_orders = np.outer(np.sqrt(np.diag(np.linalg.inv(self.columns.T @ self.columns))), scatter)
        if not self.falls:
            return 0.0, of_orders
        made_up, own = self.slope(torque)
        information = np.sum(np.abs(own) ** 2, axis=0)
        of_fall = float(np.sqrt(0.5 * np.sum(scatter**2 * information)) / information.sum())
        return of_fall, np.hypot(of_orders, of_fall * np.abs(made_up))


def load_fit(torque: Array, compliance: Array | None, waves: Complex, noise: float) -> LoadFit:
    """Return how the orders change with the load.

    Args:
        torque: of the loads [N.m], shape (m,)
        compliance: at each load [rad/(N.m)], shape (m,); None if the variation of the stiffness is no unknown
        waves: complex amplitudes [rad], shape (m, h); 0 of orders left out
        noise: standard deviation of a complex amplitude by the noise of the solver [rad]
    """
    none = np.zeros(waves.shape[1])
    if not waves.any():
        return LoadFit(none.astype(complex), none, none.astype(complex), 0.0, 0.0, none, ())
    believed = max(noise, RELATIVE_NOISE * float(np.abs(waves).max()), 1e-300)
    varying = None if compliance is None else -torque * compliance
    constant = _model(torque, None, waves, falls=False)
    models = [constant]
    if len(torque) >= MIN_LOADS:
        models += [_model(torque, each, waves, falls=falls) for falls, each in _choices(torque, varying)]
    chosen = min(models, key=lambda each: each.criterion(believed))
    without_fall = min((each for each in models if not each.falls), key=lambda each: each.criterion(believed))
    if chosen.squares > MAX_LEFT_BY_FALL * without_fall.squares:
        chosen = without_fall
    remarks: tuple[str, ...] = ()
    if len(torque) < MIN_LOADS:
        remarks = (_few_loads(torque, waves),)
    elif chosen is not constant and varying is not None and not torque.min() < 0.0 < torque.max():
        chosen, remarks = constant, (_not_separable(torque, waves),)
    elif (left := float(np.sqrt(2.0 * chosen.squares / chosen.data))) > NAMED_MISFIT * believed:
        no_law = f"{quantity(left, 'rad')} of it (rms) is no fall and no variation as the laws have it"
        remarks = (f"{_change(torque, waves)}; {no_law}",)
    elif chosen.falls and len(np.unique(np.abs(torque))) == 2:
        remarks = (f"between 0 and {np.abs(torque).max():g} N.m the form of the fall is not tested; add loads between",)
    of_fall, of_orders = chosen.sigmas(torque, noise)
    misfit = np.sqrt(np.mean(np.abs(chosen.left) ** 2, axis=0))
    sigma = np.hypot(of_orders[0], np.sqrt(np.maximum(misfit**2 - noise**2, 0.0)))  # no number of loads averages a misfit out
    variation = none.astype(complex)
    if len(chosen.coefficients) > 1:
        # Products of error and variation are in other orders: what is left of one order may be in another one as a variation.
        least = SIGNIFICANCE_SIGMA * float(of_orders[1].max())
        variation = np.where(np.abs(chosen.coefficients[1]) > least, chosen.coefficients[1], 0.0)
    return LoadFit(chosen.coefficients[0], sigma, variation, chosen.sensitivity, of_fall, misfit, remarks)


def _choices(torque: Array, varying: Array | None) -> Iterator[tuple[bool, Array | None]]:
    """Yield the models that the loads determine: error that falls or not, and the column of a variation of the stiffness."""
    sizes = len(np.unique(np.abs(torque)))
    if sizes > 1:
        yield True, None
    if varying is not None:
        yield False, varying
        if sizes > 1:
            yield True, varying


def _model(torque: Array, varying: Array | None, waves: Complex, *, falls: bool) -> _Model:
    """Return the model of least squares."""
    others = [] if varying is None else [varying]

    def model(sensitivity: float) -> _Model:
        columns = np.column_stack([(1.0 + sensitivity * np.abs(torque)) ** -2.0, *others])
        coefficients = np.atleast_2d(solved(columns, waves))
        return _Model(falls, sensitivity, columns, coefficients, waves - columns @ coefficients)

    if not falls:
        return model(0.0)
    starts = np.geomspace(MIN_FALL, MAX_FALL, SEARCH_POINTS) / float(np.abs(torque).max())
    best = min(map(model, starts.tolist()), key=lambda each: each.squares)
    for _ in range(MAX_STEPS):
        _, own = best.slope(torque)
        step = float(np.sum((own.conj() * best.left).real) / np.sum(np.abs(own) ** 2))
        better = model(max(best.sensitivity + step, 0.0))
        if not better.squares < best.squares:
            break
        best = better
    return best


def _few_loads(torque: Array, waves: Complex) -> str:
    if len(torque) == 1:
        where = f"at one load, {torque[0]:g} N.m"
        return f"{where}, the change of the error with the load is not determined: it is constant in the model"
    alone = "two loads do not separate a fall of the error from a variation of the stiffness"
    return f"{_change(torque, waves)}; {alone}: neither is in the model; add a load, or choose one by load="


def _not_separable(torque: Array, waves: Complex) -> str:
    return (
        f"{_change(torque, waves)}; a fall of the error and a variation of the stiffness are not separable in it: "
        "neither is in the model; add loads of the other sign or the column stiffness, or choose one load by load="
    )


def _change(torque: Array, waves: Complex) -> str:
    """Return the largest change of an order with the load in words."""
    moved = np.abs(waves - waves[int(np.argmin(np.abs(torque)))])
    load, order = np.unravel_index(int(np.argmax(moved)), moved.shape)
    ends = in_a_sentence([f"{torque[int(np.argmin(np.abs(torque)))]:g} N.m", f"{torque[load]:g} N.m"])
    return f"between {ends} an order changes by up to {quantity(float(moved[load, order]), 'rad')}"
