"""Spring, kinematic error and variation of the stiffness of a gear, fitted together to harmonics of its transmission error."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import variation
from strainwave.orders.mesh.harmonics import Harmonics
from strainwave.orders.mesh.loads import RELATIVE_NOISE, LoadFit, load_fit
from strainwave.orders.mesh.spring import spring_of, transmission_error
from strainwave.presentation import counted
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Variation = tuple[variation.Periodic | None, list[str]]  # and remarks on it

MAX_VARIATION_ORDERS = 8  # capacity of variation.Periodic
MAX_VARIATION = 0.95  # sum of the relative amplitudes
NAMED_SPREAD = 0.02  # relative, from which a change with the load is stated
MAX_CHANGE_OF_ROUND = 1e-11  # relative change in a round
MAX_ROUNDS = 20  # of the corrections beyond the first order
POINTS_PER_PERIOD = 4  # of the highest order that may vary, at which they are computed
MIN_POINTS = 1024  # per turn


def variation_of_column(name: str, column: Harmonics | None, false_alarm: float) -> Variation:
    """Return the variation of a stiffness in the table, the median over the loads: a bend of the spring does not move it."""
    if column is None:
        return None, []
    relative = column.waves / column.mean[:, np.newaxis]
    middle = np.median(relative.real, axis=0) + 1j * np.median(relative.imag, axis=0)
    kept = column.significant(false_alarm) & (np.abs(middle) > RELATIVE_NOISE * np.abs(middle).max())
    law, remarks = variation_of(name, column.orders, np.where(kept, middle, 0.0))
    spread = float(np.abs(relative - middle)[:, kept].max(initial=0.0))
    remark = f"the relative variation of {name} changes with the load by up to {spread:.2g}: the median is in the model"
    return law, [remark, *remarks] if spread > NAMED_SPREAD else remarks


def variation_of(name: str, orders: Array, waves: Complex) -> Variation:
    """Return the variation of the strongest orders, None without any, and remarks; `waves` are relative amplitudes.

    Raises:
        ValueError: they add up to more than a law allows
    """
    shown = np.where(np.abs(waves) > RELATIVE_NOISE * np.abs(waves).max(initial=0.0), waves, 0.0)
    chosen, rest = strongest(shown, MAX_VARIATION_ORDERS)
    if (total := float(np.abs(waves[chosen]).sum())) > MAX_VARIATION:
        by = f"{name} varies by {total:.2g} of its mean as the wave generator turns"
        raise ValueError(f"{by}; a law allows {MAX_VARIATION:g}: check the columns")
    left = f"{counted(len(rest), 'order')} of {name}, of up to {float(np.abs(waves[rest]).max(initial=0.0)):.2g} of its mean"
    remarks = [f"a variation has {MAX_VARIATION_ORDERS} orders; left out: {left}"] if len(rest) else []
    return (variation.Periodic(**of_waves(orders, waves, chosen)) if len(chosen) else None), remarks


def strongest(waves: Complex, capacity: int) -> tuple[NDArray[np.int_], NDArray[np.int_]]:
    """Return the places of the largest waves that a law has room for, and of the others; the strongest first, without zeros."""
    places = np.argsort(-np.abs(waves), kind="stable")[: np.count_nonzero(waves)]
    return places[:capacity], places[capacity:]


def of_waves(orders: Array, waves: Complex, chosen: NDArray[np.int_]) -> dict[str, list[float]]:
    """Return order, amplitude and phase of a law, orders increasing."""
    columns = orders, np.abs(waves), np.angle(waves)
    return {name: of[np.sort(chosen)].tolist() for name, of in zip(("order", "amplitude", "phase"), columns, strict=True)}


@dataclass(frozen=True)
class ErrorFit:
    """Fit of the transmission error.

    Attributes:
        spring: of the whole gear; None if it is not determined
        variation: of the stiffness; None if it is not determined, or does not vary
        error: complex amplitudes without load, 0 of those that noise makes [rad], shape (h,)
        orders: over the load
        remarks: on the spring
    """

    spring: Any
    variation: variation.Periodic | None
    error: Complex
    orders: LoadFit
    remarks: list[str]

    def factor(self, angle: Array) -> Array:
        """Return the factor of the stiffness by its variation, shape (n,)."""
        return np.ones(len(angle)) if self.variation is None else np.asarray(self.variation.factor(angle))


def error_fit(error: Harmonics, column: Harmonics | None, given: Any, loads: slice, false_alarm: float) -> ErrorFit:
    """Return the fit of the transmission error.

    What the laws do beyond the first order is computed from the last fit and taken out of the data.

    Args:
        error: of the transmission error
        column: the stiffness; None without
        given: variation by that column; None without
        loads: at which the orders are fitted; the spring is fitted to the means at all
        false_alarm: probability that noise makes an order

    Raises:
        ValueError: the error falls as the torque rises, or the column stiffness contradicts it
    """
    chosen, kept = error.torque[loads], error.significant(false_alarm)
    shift, beyond, before = np.zeros(len(error.torque)), np.zeros_like(error.waves), None
    for _ in range(MAX_ROUNDS):
        spring, remarks = spring_of(error, column, shift)
        compliance = None if spring is None or column is not None else 1.0 / np.asarray(spring.tangent(spring.twist(chosen)))
        waves = np.where(kept, error.waves - beyond, 0.0)[loads]
        orders = load_fit(replace(error, torque=chosen, mean=error.mean[loads], waves=waves), compliance)
        varying = given if column is not None else variation_of("stiffness", error.orders, orders.variation)[0]
        fit = ErrorFit(spring, varying, orders.coefficients[0], orders, remarks)
        if spring is None or (varying is None and orders.sensitivity == 0.0):
            break
        now = np.concatenate([fit.error, orders.variation, spring.twist(error.torque)])
        if before is not None and np.allclose(now, before, rtol=MAX_CHANGE_OF_ROUND, atol=0.0):
            break
        before = now
        shift, beyond = _beyond_first_order(fit, error, varies=column is None)
    by_noise = error.noise * np.sqrt(log(error.waves.size / false_alarm) / len(chosen))
    least = max(by_noise, RELATIVE_NOISE * float(np.abs(fit.error).max()))
    by_others = np.abs(beyond[loads]).max(axis=0)  # products of the orders that the table has
    is_open = (np.abs(fit.error) < SIGNIFICANCE_SIGMA * orders.sigma) & (np.abs(fit.error) < by_others)
    shown = np.where((np.abs(fit.error) < least) | is_open, 0.0, fit.error)
    made = (by_others > error.noise) & (shown == 0.0) & (orders.variation == 0.0)
    unlike = np.sqrt(np.mean(np.abs((error.waves - beyond)[loads][:, made]) ** 2, axis=0)).max(initial=0.0)
    return replace(fit, error=shown, orders=replace(orders, unlike=float(unlike / max(np.abs(shown).max(initial=0.0), 1e-300))))


def _beyond_first_order(fit: ErrorFit, data: Harmonics, *, varies: bool) -> tuple[Array, Complex]:
    """Return what the laws have beyond the model: of the means, shape (m,), and of the waves, shape (m, h).

    The variation of the stiffness is in the model if it `varies`, as an unknown.
    """
    points = max(MIN_POINTS, POINTS_PER_PERIOD * int(data.orders[-1]))
    angle, present = 2.0 * np.pi * np.arange(points) / points, np.flatnonzero(fit.error)
    error = np.asarray(np.imag(np.exp(1j * np.outer(angle, data.orders[present])) @ fit.error[present]))
    factor, twist = fit.factor(angle), np.asarray(fit.spring.twist(data.torque))
    exact = [
        transmission_error(fit.spring, error, fit.orders.sensitivity, factor, np.full(points, load)) for load in data.torque
    ]
    model = np.outer((1.0 + fit.orders.sensitivity * np.abs(data.torque)) ** -2.0, error) + twist[:, np.newaxis]
    if varies:
        model -= np.outer(data.torque / np.asarray(fit.spring.tangent(twist)), factor - 1.0)
    spectrum = np.fft.rfft(np.array(exact) - model, axis=1) / points
    return spectrum[:, 0].real, 2j * spectrum[:, data.orders.astype(int)]
