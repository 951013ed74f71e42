"""Spring of a gear by the means over the angle of a table of its mesh, and the transmission error that it makes of an error."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import stiffness
from strainwave.orders.mesh.harmonics import Harmonics
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA
from strainwave.typeset import percent

Array = NDArray[np.float64]

MAX_BEND = 0.002  # of the largest twist: a spring whose twist is off by less in the root mean square is straight enough
MAX_KNEE_LEVELS = 30  # loads that knees are looked for at
MIN_WINDUP_SIGMA = 10.0  # standard deviations of a mean: a smaller change with the load is no wind-up
MIN_WINDUP_OF_ORDERS = 0.02  # of the largest amplitude, likewise
MIN_WINDUP_OF_STIFFNESS = 0.05  # of the twist by the column stiffness, likewise
MAX_DISAGREEMENT = 0.25  # relative, of the column stiffness and the slope of the error: a larger one is a mistake
NAMED_DISAGREEMENT = 0.02  # relative, from which a difference is stated
MAX_CHANGE_OF_TWIST = 1e-11  # relative, in an iteration under an error that falls
MAX_ITERATIONS = 100


def spring_fit(torque: Array, twist: Array, sigma: float) -> tuple[Any, float]:
    """Return the spring of the fewest segments that explains the mean twist at each load, and what it leaves (rms) [rad].

    Args:
        torque: of the loads [N.m], shape (m,), two different ones or more
        twist: mean over the angle, with any zero [rad], shape (m,)
        sigma: its standard deviation [rad]

    Raises:
        ValueError: the twist falls as the torque rises
    """
    tolerance, fits = max(SIGNIFICANCE_SIGMA * sigma, MAX_BEND * float(np.ptp(twist))), []
    for knees in _knees(torque):
        segments = (np.clip(np.abs(torque) - low, 0.0, high - low) for low, high in pairwise([0.0, *knees, np.inf]))
        columns = np.column_stack([np.ones_like(torque), *(np.sign(torque) * segment for segment in segments)])
        values = solved(columns, twist)
        if values[1:].min() > 0.0:
            fits.append((float(np.sqrt(np.mean((twist - columns @ values) ** 2))), 1.0 / values[1:], knees))
            if fits[-1][0] <= tolerance:
                break
    if not fits:
        raise ValueError("the twist falls as the torque rises")
    left, slopes, knees = min(fits, key=lambda fit: fit[0])
    if not knees:
        return stiffness.Linear(k=float(slopes[0])), left
    k1, k2, k3 = slopes[np.minimum([0, 1, 2], len(knees))].tolist()
    return stiffness.ThreeSegment(k1=k1, k2=k2, k3=k3, t1=knees[0], t2=knees[-1]), left


def _knees(torque: Array) -> Iterator[tuple[float, ...]]:
    """Yield the knees of springs that the loads determine, the fewest first."""
    levels = np.unique(np.abs(torque[torque != 0.0]))[:-1]
    if len(levels) > MAX_KNEE_LEVELS:
        levels = levels[np.linspace(0, len(levels) - 1, MAX_KNEE_LEVELS).astype(int)]
    for count in range(min(3, len(torque) - 1)):
        yield from combinations(levels.tolist(), count)


def spring_by_tangents(column: Harmonics) -> Any:
    """Return the spring by its stiffness at the loads, with a linear compliance between them."""
    levels = np.unique(np.abs(column.torque))
    compliance = np.array([float(np.mean(1.0 / column.mean[np.abs(column.torque) == level])) for level in levels])
    torque = np.append(0.0, levels[levels > 0.0])
    if len(torque) == 1:
        return stiffness.Linear(k=float(1.0 / compliance[0]))
    at_ends = np.interp(torque, levels, compliance)
    twist = np.append(0.0, np.cumsum(0.5 * (at_ends[1:] + at_ends[:-1]) * np.diff(torque)))
    return spring_fit(np.append(-torque[:0:-1], torque), np.append(-twist[:0:-1], twist), 0.0)[0]


def spring_of(error: Harmonics, column: Harmonics | None, shift: Array) -> tuple[Any, list[str]]:
    """Return the spring by the mean error less a shift of it, or by the column stiffness, None without both; and remarks.

    Raises:
        ValueError: the error falls as the torque rises, or the column stiffness contradicts it
    """
    by_column = None if column is None else 0.5 * (1.0 / column.mean[1:] + 1.0 / column.mean[:-1]) * np.diff(column.torque)
    loads, twists = len(error.torque), np.diff(error.mean)
    if not _winds_up(error, twists, by_column):
        spring, whose = (None, "not determined") if column is None else (spring_by_tangents(column), "that of its column")
        same = "the mean transmission error does not change with the load: the twist is not in it, and the stiffness is"
        one = ["one load does not determine the stiffness"] if column is None else []
        return spring, one if loads == 1 else [f"{same} {whose}"]
    spring, left = spring_fit(error.torque, error.mean - shift, 0.5 * error.noise)
    remarks = ["two loads determine a straight spring alone: whether it bends is not tested"] if loads == 2 else []
    if (share := left / float(np.ptp(spring.twist(error.torque)))) > NAMED_DISAGREEMENT:
        remarks.append(f"the spring leaves {percent(share)} of the twist unexplained, as if the two senses differed")
    if by_column is not None and (off := np.abs(twists / by_column - 1.0)).max() > NAMED_DISAGREEMENT:
        worst = int(np.argmax(off))
        low, high = error.torque[worst : worst + 2].tolist()
        by_error, by_table = ((high - low) / twist[worst] for twist in (twists, by_column))
        where, of_column = f"from {low:g} to {high:g} N.m", f"the column stiffness {by_table:.4g} N.m/rad"
        remarks.append(f"{where} the transmission error gives {by_error:.4g} N.m/rad, {of_column}: the former is in the model")
    return spring, remarks


def _winds_up(error: Harmonics, twists: Array, by_column: Array | None) -> bool:
    """True if the mean transmission error changes with the load as the twist does; raises as `spring_of`."""
    wound, of_column = float(np.sum(twists)), 0.0 if by_column is None else float(np.sum(by_column))
    largest, (first, last) = float(np.abs(error.waves).max(initial=0.0)), error.torque[[0, -1]].tolist()
    small = max(MIN_WINDUP_SIGMA * 0.5 * error.noise, MIN_WINDUP_OF_ORDERS * largest)
    if wound < -max(small, 0.5 * largest):
        raise ValueError(
            f"the mean transmission error falls by {-wound:.4g} rad as the torque rises by {last - first:g} N.m; input angle / "
            "ratio - output angle grows with a torque that drives the output: change the sign of one of the two columns"
        )
    winds = wound > max(small, MIN_WINDUP_OF_STIFFNESS * of_column)
    if winds and by_column is not None and abs(wound / of_column - 1.0) > MAX_DISAGREEMENT:
        raise ValueError(
            f"from {first:g} to {last:g} N.m the mean transmission error grows by {wound:.4g} rad, the column stiffness gives "
            f"a twist of {of_column:.4g} rad; correct units or sides, or leave one of the two columns out"
        )
    return winds


def transmission_error(spring: Any, error: Array, sensitivity: float, factor: Array | float, torque: Array) -> Array:
    """Return the transmission error of a gear at rest under loads, as Gear has it with Scaled and a variation of the stiffness.

    Args:
        spring: None if only the error is of interest
        error: kinematic error without load [rad], shape (n,)
        sensitivity: relative fall of it with the torque [1/(N.m)]
        factor: of the stiffness [1], shape (n,)
        torque: of the load [N.m], shape (n,)
    """
    if spring is None:
        return np.asarray(error / (1.0 + sensitivity * np.abs(torque)) ** 2)
    twist, fall = np.asarray(spring.twist(torque / factor)), np.ones(len(error))
    for _ in range(MAX_ITERATIONS if sensitivity else 0):
        bears = np.asarray(spring.torque(twist))
        fall = 1.0 / (1.0 + sensitivity * np.abs(bears))
        per_twist = -error * sensitivity * np.sign(bears) * fall**2 * np.asarray(spring.tangent(twist))
        before, twist = twist, np.asarray(spring.twist(torque * (1.0 + per_twist) / factor))
        if np.abs(twist - before).max() <= MAX_CHANGE_OF_TWIST * np.abs(twist).max():
            break
    return np.asarray(error * fall + twist)
