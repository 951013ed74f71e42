"""Spring, kinematic error and variation of the stiffness of a gear, fitted together to harmonics of its transmission error."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import log
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import stiffness, variation
from strainwave.orders.mesh.harmonics import Harmonics
from strainwave.orders.mesh.loads import RELATIVE_NOISE, LoadFit, SpringFit, load_fit, spring_fit
from strainwave.presentation import counted

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

MAX_VARIATION_ORDERS = 8  # capacity of variation.Periodic
MAX_VARIATION = 0.95  # sum of the relative amplitudes
MIN_WINDUP_SIGMA = 10.0  # standard deviations of a mean: a smaller change with the load is no wind-up
MIN_WINDUP_OF_ORDERS = 0.02  # of the largest amplitude, likewise
MIN_WINDUP_OF_STIFFNESS = 0.05  # of the twist by the column stiffness, likewise
MAX_DISAGREEMENT = 0.25  # relative, of the column stiffness and the slope of the error: a larger one is a mistake
NAMED_SPREAD = 0.02  # relative, from which a change with the load is stated
MAX_CHANGE_OF_ROUND = 1e-11  # relative change in a round
MAX_ITERATIONS = 100  # of the twist under an error that falls
MAX_ROUNDS = 20  # of the corrections beyond the first order
POINTS_PER_PERIOD = 4  # of the highest order that may vary, at which they are computed
MIN_POINTS = 1024  # per turn


# ---- Variation of a stiffness ----------------------------------------------------------------------------------------


@dataclass(frozen=True)
class StiffnessVariation:
    """Relative variation of a stiffness over the angle.

    Attributes:
        waves: complex amplitudes [1], shape (h,)
        law: the strongest of them; None without any
        remarks: in words
    """

    waves: Complex
    law: variation.Periodic | None
    remarks: tuple[str, ...]

    @classmethod
    def of_column(cls, name: str, found: Harmonics, false_alarm: float) -> StiffnessVariation:
        """Return that of a stiffness in the table: the median over the loads, which single bends of the spring do not move."""
        relative = found.waves / found.mean[:, np.newaxis]
        middle = np.median(relative.real, axis=0) + 1j * np.median(relative.imag, axis=0)
        kept = found.significant(false_alarm) & (np.abs(middle) > RELATIVE_NOISE * np.abs(middle).max())
        spread = float(np.abs(relative - middle)[:, kept].max(initial=0.0))
        remark = f"the relative variation of {name} changes with the load by up to {spread:.2g}: the median is in the model"
        return cls.of_waves(name, found.orders, np.where(kept, middle, 0.0), (remark,) if spread > NAMED_SPREAD else ())

    @classmethod
    def of_waves(cls, name: str, orders: Array, waves: Complex, remarks: tuple[str, ...] = ()) -> StiffnessVariation:
        """Return that of complex amplitudes.

        Raises:
            ValueError: they add up to more than a law allows
        """
        present = np.flatnonzero(np.abs(waves) > RELATIVE_NOISE * np.abs(waves).max(initial=0.0))
        strongest = present[np.argsort(-np.abs(waves[present]), kind="stable")]
        chosen, rest = np.sort(strongest[:MAX_VARIATION_ORDERS]), np.sort(strongest[MAX_VARIATION_ORDERS:])
        if not len(chosen):
            return cls(np.zeros_like(waves), None, remarks)
        if (total := float(np.abs(waves[chosen]).sum())) > MAX_VARIATION:
            by = f"{name} varies by {total:.2g} of its mean as the wave generator turns"
            raise ValueError(f"{by}; a law allows {MAX_VARIATION:g}: check the columns")
        law = variation.Periodic(
            order=orders[chosen].tolist(), amplitude=np.abs(waves[chosen]).tolist(), phase=np.angle(waves[chosen]).tolist()
        )
        if len(rest):
            left = f"{counted(len(rest), 'order')} of {name}, of up to {float(np.abs(waves[rest]).max()):.2g} of its mean"
            remarks += (f"a variation has {MAX_VARIATION_ORDERS} orders; left out: {left}",)
        kept = np.zeros_like(waves)
        kept[chosen] = waves[chosen]
        return cls(kept, law, remarks)


# ---- Everything together ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ErrorFit:
    """Fit of the transmission error.

    Attributes:
        spring: of the whole gear; None if it is not determined
        wound: True if the spring follows from the transmission error
        variation: of the stiffness
        orders: of the error, over the loads; without those that noise makes
    """

    spring: SpringFit | None
    wound: bool
    variation: StiffnessVariation
    orders: LoadFit


def error_fit(
    error: Harmonics, of_spring: Harmonics | None, given: StiffnessVariation | None, loads: slice, false_alarm: float
) -> ErrorFit:
    """Return the fit of the transmission error.

    What the laws do beyond the first order is computed from the last fit and taken out of the data.

    Args:
        error: of the transmission error
        of_spring: of the column stiffness; None without
        given: variation by that column; None without
        loads: at which the orders are fitted; the spring is fitted to the means at all
        false_alarm: probability that noise makes an order

    Raises:
        ValueError: the error falls as the torque rises, or the column stiffness contradicts it
    """
    kept, wound = error.significant(false_alarm), winds_up(error, of_spring)
    varying = given or StiffnessVariation(np.zeros(len(kept), complex), None, ())
    shift, beyond, before = np.zeros(len(error.torque)), np.zeros_like(error.waves), None
    for _ in range(MAX_ROUNDS):
        spring = _spring(error, of_spring, wound, shift)
        compliance = spring.compliance(error.torque)[loads] if spring is not None and given is None else None
        fit = load_fit(error.torque[loads], compliance, np.where(kept, error.waves - beyond, 0.0)[loads], error.noise)
        if given is None:
            varying = StiffnessVariation.of_waves("stiffness", error.orders, fit.variation)
        now = np.concatenate([fit.error, fit.variation])
        if spring is None or (varying.law is None and fit.sensitivity == 0.0):
            break
        if before is not None and np.allclose(now, before, rtol=MAX_CHANGE_OF_ROUND, atol=0.0):
            break
        before = now
        shift, beyond = _beyond_first_order(spring, error, fit.error, fit.sensitivity, varying)
        if given is not None:
            beyond += np.outer(-error.torque * spring.compliance(error.torque), varying.waves)
    by_noise = error.noise * np.sqrt(log(error.waves.size / false_alarm) / len(error.torque[loads]))
    least = max(by_noise, RELATIVE_NOISE * float(np.abs(fit.error).max(initial=0.0)))
    fit = replace(fit, error=np.where(np.abs(fit.error) < least, 0.0, fit.error))
    return ErrorFit(spring, wound, varying, fit)


def _spring(error: Harmonics, of_spring: Harmonics | None, wound: bool, shift: Array) -> SpringFit | None:
    """Return the spring by the mean error less what is known of it, or by the column stiffness."""
    if wound:
        return spring_fit(error.torque, error.mean - shift, 0.5 * error.noise)
    return None if of_spring is None else spring_by_tangents(of_spring)


def _beyond_first_order(
    spring: SpringFit, found: Harmonics, error: Complex, sensitivity: float, varying: StiffnessVariation
) -> tuple[Array, Complex]:
    """Return what the laws have beyond the first order: of the means, shape (m,), and of the waves, shape (m, h)."""
    points = max(MIN_POINTS, POINTS_PER_PERIOD * int(found.orders[-1]))
    angle = 2.0 * np.pi * np.arange(points) / points
    of_error, of_stiffness = (_sum_of_waves(angle, found.orders, waves) for waves in (error, varying.waves))
    exact = np.array(
        [
            transmission_error(spring.law, of_error, sensitivity, 1.0 + of_stiffness, np.full(points, load))
            for load in found.torque.tolist()
        ]
    )
    spectrum = np.fft.rfft(exact, axis=1) / points
    fall = (1.0 + sensitivity * np.abs(found.torque)) ** -2.0
    first = np.outer(fall, error) - np.outer(found.torque * spring.compliance(found.torque), varying.waves)
    even = np.array([spring.law.twist(load) for load in found.torque.tolist()])
    return spectrum[:, 0].real - even, 2j * spectrum[:, found.orders.astype(int)] - first


def _sum_of_waves(angle: Array, orders: Array, waves: Complex) -> Array:
    present = np.flatnonzero(waves)
    return np.asarray(np.imag(np.exp(1j * np.outer(angle, orders[present])) @ waves[present]))


def transmission_error(law: Any, error: Array, sensitivity: float, factor: Array, torque: Array) -> Array:
    """Return the transmission error of a gear at rest under loads, as Gear has it with Scaled and a variation of the stiffness.

    Args:
        law: the spring
        error: kinematic error without load [rad], shape (n,)
        sensitivity: relative fall of it with the torque [1/(N.m)]
        factor: of the stiffness [1], shape (n,)
        torque: of the load [N.m], shape (n,)
    """
    twist = np.asarray(law.twist(torque / factor))
    if sensitivity == 0.0:
        return np.asarray(error + twist)
    for _ in range(MAX_ITERATIONS):
        spring = np.asarray(law.torque(twist))
        fall = 1.0 / (1.0 + sensitivity * np.abs(spring))
        per_twist = -error * sensitivity * np.sign(spring) * fall**2 * np.asarray(law.tangent(twist))
        before, twist = twist, np.asarray(law.twist(torque * (1.0 + per_twist) / factor))
        if np.abs(twist - before).max() <= MAX_CHANGE_OF_ROUND * np.abs(twist).max():
            break
    return np.asarray(error * fall + twist)


def spring_by_tangents(found: Harmonics) -> SpringFit:
    """Return the spring by its stiffness at the loads, whose compliance is linear between them."""
    levels = np.unique(np.abs(found.torque))
    compliance = np.array([float(np.mean(1.0 / found.mean[np.abs(found.torque) == level])) for level in levels])
    torque = np.append(0.0, levels[levels > 0.0])
    if len(torque) == 1:
        return SpringFit(stiffness.Linear(k=float(1.0 / compliance[0])), 0.0, 0.0)
    at_ends = np.interp(torque, levels, compliance)
    twist = np.append(0.0, np.cumsum(0.5 * (at_ends[1:] + at_ends[:-1]) * np.diff(torque)))
    return spring_fit(np.append(-torque[:0:-1], torque), np.append(-twist[:0:-1], twist), 0.0)


def winds_up(error: Harmonics, of_spring: Harmonics | None) -> bool:
    """True if the mean transmission error changes with the load as the twist does.

    Raises:
        ValueError: it falls as the torque rises, or the column stiffness contradicts it
    """
    if len(error.torque) < 2:
        return False
    span, wound = float(np.ptp(error.torque)), float(error.mean[-1] - error.mean[0])
    largest = float(np.abs(error.waves).max(initial=0.0))
    small = max(MIN_WINDUP_SIGMA * 0.5 * error.noise, MIN_WINDUP_OF_ORDERS * largest)
    if wound < -max(small, 0.5 * largest):
        raise ValueError(
            f"the mean transmission error falls by {-wound:.4g} rad as the torque rises by {span:g} N.m; input angle / ratio - "
            "output angle grows with a torque that drives the output: change the sign of one of the two columns"
        )
    if of_spring is None:
        return wound > small
    twist = float(np.sum(twists_of(of_spring)))
    if wound <= max(small, MIN_WINDUP_OF_STIFFNESS * twist):
        return False
    if abs(wound / twist - 1.0) > MAX_DISAGREEMENT:
        raise ValueError(
            f"from {error.torque[0]:g} to {error.torque[-1]:g} N.m the mean transmission error grows by {wound:.4g} rad, the "
            f"column stiffness gives a twist of {twist:.4g} rad; correct units or sides, or leave one of the two columns out"
        )
    return True


def twists_of(of_spring: Harmonics) -> Array:
    """Return the twist from each load to the next by the column stiffness [rad], shape (m - 1,)."""
    return np.asarray(0.5 * (1.0 / of_spring.mean[1:] + 1.0 / of_spring.mean[:-1]) * np.diff(of_spring.torque))
