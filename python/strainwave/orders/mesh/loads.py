r"""Spring of a gear, and how its orders change with the load, by the harmonics of a table of the mesh.

With e the complex amplitudes of the kinematic error without load, v those of the relative variation of the stiffness, c the
compliance at the load,

.. math:: c_{hj} = \frac{e_h}{(1 + \kappa_T |T_j|)^2} - T_j \, c(T_j) \, v_h

The square is that of an error that falls by r = 1 / (1 + kappa_T |T|) and conserves energy (kinematic_error.Scaled): as the
error falls with the torque of the spring, the spring bears T (1 + k e dr/dT) under a load T, with k its stiffness. To the first
order the transmission error is then e (r + T dr/dT) + T / k. The first term of the sum is even in the torque. At loads
of one sign both terms differ in their curvature alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
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
MIN_LOADS = 3  # that determine a change with the load, and test its form
RELATIVE_NOISE = 1e-3  # of the largest amplitude: a solver is not believed to be more exact (assumed)
MAX_FALL = 100.0  # of the error over what is left at the largest load
SEARCH_POINTS = 60
MAX_MISFIT = 2.0  # times the noise, that a model may leave where curvature alone separates its terms
NAMED_MISFIT = 5.0  # times the noise, from which what a model leaves is stated
MAX_RELATIVE_SIGMA = 0.1  # of what curvature alone determines, over its value
MIN_EVIDENCE = 10.0  # difference of the Bayesian information criterion (Schwarz 1978) from which a model is preferred


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
    """How the orders change with the load.

    Attributes:
        error: complex amplitudes of the error without load [rad], shape (h,)
        variation: complex amplitudes of the relative variation of the stiffness [1], shape (h,); zeros if none is determined
        sensitivity, sensitivity_sigma: relative fall of the error with the torque [1/(N.m)], and its standard deviation
        sigma: standard deviation of an amplitude of the error over that of a wave of one load
        misfit: root mean square over the loads of what the model leaves of each order [rad], shape (h,)
        remarks: in words
    """

    error: Complex
    variation: Complex
    sensitivity: float
    sensitivity_sigma: float
    sigma: float
    misfit: Array
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class _Model:
    """A model of the change with the load: its coefficients, and its information criterion."""

    falls: bool
    varies: bool
    sensitivity: float
    coefficients: Complex
    criterion: float
    columns: Array
    squares: float

    def rms(self, cells: int) -> float:
        """Root mean square of the complex amplitudes that it leaves, of that many."""
        return float(np.sqrt(self.squares / cells))

    def slope(self, torque: Array) -> tuple[Complex, Complex]:
        """Return the change of the waves with the sensitivity: what the coefficients make up of it, and what they do not."""
        level = np.abs(torque)
        slope = np.outer(-2.0 * level / (1.0 + self.sensitivity * level) ** 3, self.coefficients[0])
        made_up = solved(self.columns, slope)
        return made_up, slope - self.columns @ made_up

    def sigmas(self, torque: Array, noise: float) -> tuple[float, Array]:
        """Return the standard deviation of the sensitivity [1/(N.m)], and that of the last coefficient of each order, (h,)."""
        inverse = np.linalg.inv(self.columns.T @ self.columns)
        of_order = np.full(self.coefficients.shape[1], noise * float(np.sqrt(inverse[-1, -1])))
        if not self.falls:
            return 0.0, of_order
        made_up, own = self.slope(torque)
        of_fall = noise / float(np.sqrt(2.0 * np.sum(np.abs(own) ** 2)))
        return of_fall, np.hypot(of_order, of_fall * np.abs(made_up[-1]))


def load_fit(torque: Array, compliance: Array | None, waves: Complex, noise: float) -> LoadFit:
    """Return how the orders change with the load.

    Args:
        torque: of the loads [N.m], shape (m,)
        compliance: at each load [rad/(N.m)], shape (m,); None if the variation of the stiffness is no unknown
        waves: complex amplitudes [rad], shape (m, h)
        noise: standard deviation of a complex amplitude [rad]
    """
    if not waves.shape[1]:
        none = np.zeros(0, complex)
        return LoadFit(none, none, 0.0, 0.0, 1.0, np.zeros(0), ())
    of_solver, noise = noise, max(noise, RELATIVE_NOISE * float(np.abs(waves).max(initial=0.0)), 1e-300)
    varying = None if compliance is None else -torque * compliance
    models = [_model(torque, None, waves, noise, falls=False)]
    if len(torque) >= MIN_LOADS:
        models += [_model(torque, each, waves, noise, falls=falls) for falls, each in _choices(torque, varying)]
    chosen = min(models, key=lambda each: each.criterion)
    remarks: tuple[str, ...] = ()
    if len(torque) < MIN_LOADS:
        remarks = (_few_loads(torque, waves),)
    elif chosen is not models[0] and not _separates(chosen, models, torque, noise, of_solver):
        chosen, remarks = models[0], (_not_separable(torque, waves),)
    elif (left := chosen.rms(waves.size)) > NAMED_MISFIT * noise:
        remarks = (
            f"{_change(torque, waves)}; {quantity(left, 'rad')} of it (rms) is no fall and no variation as the laws have it",
        )
    variation = chosen.coefficients[1] if chosen.varies else np.zeros(waves.shape[1], complex)
    inverse = np.linalg.inv(chosen.columns.T @ chosen.columns)
    of_fall, of_orders = chosen.sigmas(torque, of_solver)
    variation = np.where(np.abs(variation) > SIGNIFICANCE_SIGMA * of_orders, variation, 0.0)
    misfit = np.sqrt(np.mean(np.abs(waves - chosen.columns @ chosen.coefficients) ** 2, axis=0))
    sigma = float(np.sqrt(inverse[0, 0]))
    return LoadFit(chosen.coefficients[0], variation, chosen.sensitivity, of_fall, sigma, misfit, remarks)


def _separates(chosen: _Model, models: Sequence[_Model], torque: Array, noise: float, of_solver: float) -> bool:
    """True if the loads separate a fall of the error from a variation of the stiffness.

    Loads of both signs do, as one is even and the other odd. Of one sign the curvature alone does: then the model must explain
    the orders within the noise, the opposite one must not, and what it determines must be larger than its standard deviation.
    """
    if not any(each.varies for each in models) or torque.min() < 0.0 < torque.max():
        return True
    opposite = [each for each in models if (each.falls, each.varies) == (chosen.varies, chosen.falls) and each is not chosen]
    is_clear = all(each.criterion - chosen.criterion > MIN_EVIDENCE for each in opposite)
    of_fall, of_orders = chosen.sigmas(torque, of_solver)
    largest = int(np.argmax(np.abs(chosen.coefficients[-1])))
    known = not chosen.falls or of_fall < MAX_RELATIVE_SIGMA * chosen.sensitivity
    known &= not chosen.varies or bool(of_orders[largest] < MAX_RELATIVE_SIGMA * abs(chosen.coefficients[-1, largest]))
    return is_clear and known and chosen.rms(len(torque) * len(of_orders)) < MAX_MISFIT * noise


def _choices(torque: Array, varying: Array | None) -> Iterator[tuple[bool, Array | None]]:
    """Yield the models that the loads determine: error that falls or not, and the column of a variation of the stiffness."""
    sizes = len(np.unique(np.abs(torque)))
    if sizes > 1:
        yield True, None
    if varying is not None:
        yield False, varying
        if sizes > 1:
            yield True, varying


def _model(torque: Array, varying: Array | None, waves: Complex, noise: float, *, falls: bool) -> _Model:
    """Return the model of largest likelihood."""
    others = [] if varying is None else [varying]

    def solution(sensitivity: float) -> tuple[float, Array, Complex]:
        columns = np.column_stack([(1.0 + sensitivity * np.abs(torque)) ** -2.0, *others])
        coefficients = solved(columns, waves)
        return float(np.sum(np.abs(waves - columns @ coefficients) ** 2)), columns, coefficients

    def model(sensitivity: float) -> _Model:
        squares, columns, coefficients = solution(sensitivity)
        unknowns = 2 * waves.shape[1] * columns.shape[1] + falls
        criterion = 2.0 * squares / noise**2 + unknowns * float(np.log(2.0 * waves.size))
        return _Model(falls, varying is not None, sensitivity, np.atleast_2d(coefficients), criterion, columns, squares)

    if not falls:
        return model(0.0)
    nearly = model(_least(lambda each: solution(each)[0], float(np.abs(torque).max())))
    _, own = nearly.slope(torque)  # a step of Newton's method, as the search is exact to the root of rounding alone
    left = waves - nearly.columns @ nearly.coefficients
    step = float(np.sum((own.conj() * left).real) / np.sum(np.abs(own) ** 2))
    return min(nearly, model(max(nearly.sensitivity + step, 0.0)), key=lambda each: each.squares)


def _least(squares: Callable[[float], float], largest: float) -> float:
    """Return the sensitivity of least squares [1/(N.m)]."""
    from scipy.optimize import minimize_scalar

    tried = np.geomspace(1e-4, MAX_FALL, SEARCH_POINTS) / largest
    values = [squares(each) for each in tried.tolist()]
    place = int(np.argmin(values))
    ends = float(np.log(tried[max(place - 1, 0)])), float(np.log(tried[min(place + 1, len(tried) - 1)]))
    best = minimize_scalar(lambda each: squares(float(np.exp(each))), bounds=ends, method="bounded", options={"xatol": 1e-10})
    return float(np.exp(best.x))


def _few_loads(torque: Array, waves: Complex) -> str:
    if len(torque) == 1:
        where = f"at one load, {torque[0]:g} N.m"
        return f"{where}, the change of the error with the load is not determined: it is constant in the model"
    alone = "two loads do not separate a fall of the error from a variation of the stiffness"
    return f"{_change(torque, waves)}; {alone}: neither is in the model; add a load"


def _not_separable(torque: Array, waves: Complex) -> str:
    add = "loads of the other sign" if torque.min() >= 0.0 or torque.max() <= 0.0 else "further loads"
    return (
        f"{_change(torque, waves)}; a fall of the error and a variation of the stiffness are not separable in it: "
        f"neither is in the model; add {add}, or the column stiffness"
    )


def _change(torque: Array, waves: Complex) -> str:
    """Return the largest change of an order with the load in words."""
    moved = np.abs(waves - waves[int(np.argmin(np.abs(torque)))])
    load, order = np.unravel_index(int(np.argmax(moved)), moved.shape)
    ends = in_a_sentence([f"{torque[int(np.argmin(np.abs(torque)))]:g} N.m", f"{torque[load]:g} N.m"])
    return f"between {ends} an order changes by up to {quantity(float(moved[load, order]), 'rad')}"
