"""Friction over the motor's angle by the position control article: a parabola over many turns, harmonics of each turn.

Friction of sliding at constant speed is f = s1 q^2 + s2 q + s3 + b |v| + sum_k (a_k cos k q + b_k sin k q), k up to 10
(the position control article, equations of f_aver, f_peri and f_visc). It prints neither a_k and b_k nor B; a constant a_0 / 2
or B is the same as s3 (its erratum 9).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.friction import PositionDependent
from strainwave.identification.experiments.experiment import sensible
from strainwave.identification.fitting.estimate import Estimate
from strainwave.statistics.covariance import covariance_of
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]

FULL_TURN = 2.0 * np.pi  # rad
ORDER_COUNT = 10  # harmonics of the position control article, and of the law
MIN_SAMPLES_PER_PERIOD = 4  # of the highest order


@dataclass(frozen=True, eq=False)
class PositionFit(ComparedByFields):
    """Friction over the angle, as the position control article describes it.

    Attributes:
        law: fitted friction, valid over the angles measured
        estimates: its numbers, as `quadratic` and `cosine[0]`, by least squares over all samples
        residual: measured less fitted friction [N.m], shape (n,)
        angle: of the samples of all runs, one after the other [rad], shape (n,)
        friction: their friction, positive if it opposes the motion [N.m], shape (n,)
        integrated: the same law by the article's integrals over whole turns; None for fewer than three whole turns
    """

    law: PositionDependent
    estimates: tuple[Estimate, ...]
    residual: Array
    angle: Array
    friction: Array
    integrated: PositionDependent | None


def fit_position(recordings: Recording | Sequence[Recording]) -> PositionFit:
    """Fit friction over the angle to runs at constant speed.

    Least squares over all samples, so that turns need not be whole; and the article's own way if a run has three whole turns:
    the means of whole turns give the parabola, the integrals of the rest give a_k and b_k. The mean of a parabola over a turn
    exceeds its middle by s1 pi^2 / 3, which is taken off.

    Args:
        recordings: runs at constant speed with columns angle and torque of the motor, and speed if there are several speeds;
            motions towards negative angles are allowed

    Raises:
        ValueError: less than a turn, or too few samples for the orders
    """
    runs = [_run(each) for each in ([recordings] if isinstance(recordings, Recording) else recordings)]
    if not runs:
        raise ValueError("recordings is empty; give at least one run at constant speed")
    angle, level, speed = map(np.concatenate, zip(*runs, strict=True))
    start, end = float(angle.min()), float(angle.max())
    if end - start < FULL_TURN:
        raise ValueError(f"the runs cover {(end - start) / FULL_TURN:.2f} turns; record a whole turn or more")
    if len(angle) < max(MIN_SAMPLES_PER_PERIOD * ORDER_COUNT * (end - start) / FULL_TURN, 2 * ORDER_COUNT + 5):
        raise ValueError(
            f"{len(angle)} samples over {(end - start) / FULL_TURN:.1f} turns do not separate {ORDER_COUNT} orders; record more"
        )
    several = len(np.unique(np.round(speed / max(float(speed.max()), 1e-300), 2))) > 1
    middle, half = 0.5 * (start + end), 0.5 * (end - start)
    u, k = (angle - middle) / half, np.arange(1, ORDER_COUNT + 1)
    waves = (*np.cos(np.outer(k, angle)), *np.sin(np.outer(k, angle)))
    jacobian = np.stack([u**2, u, np.ones_like(u), *waves, *([speed] if several else [])], axis=1)
    found = solved(jacobian, level)
    residual = level - jacobian @ found
    covariance, freedom = covariance_of(jacobian, residual[np.newaxis])
    back = np.eye(len(found))  # from the parabola in u to that in q
    back[:3, :3] = [
        [half**-2, 0.0, 0.0],
        [-2.0 * middle / half**2, 1.0 / half, 0.0],
        [(middle / half) ** 2, -middle / half, 1.0],
    ]
    numbers, sigma = back @ found, np.sqrt(np.diag(back @ covariance @ back.T))
    names = ["quadratic", "linear", "constant", *(f"{n}[{i}]" for n in ("cosine", "sine") for i in range(ORDER_COUNT))]
    units = ["N.m/rad2", "N.m/rad", *(2 * ORDER_COUNT + 1) * ["N.m"]]
    if several:
        names, units = [*names, "viscous"], [*units, "N.m.s/rad"]
    estimates = tuple(
        Estimate(name, unit, 0.0, float(value), float(off), False, freedom)
        for name, unit, value, off in zip(names, units, numbers, sigma, strict=True)
    )
    law = _law(numbers, start, end, viscous=float(numbers[-1]) if several else 0.0)
    whole = [integrated for run in runs if (integrated := _integrated(run[0], run[1])) is not None]
    by_integrals = _law(np.mean(whole, axis=0), start, end) if whole and not several else None
    return PositionFit(law, estimates, residual, angle, level, by_integrals)


def _law(numbers: Array, start: float, end: float, viscous: float = 0.0) -> PositionDependent:
    quadratic, linear, constant, *waves = numbers.tolist()
    return PositionDependent(
        quadratic=quadratic,
        linear=linear,
        constant=constant,
        cosine=waves[:ORDER_COUNT],
        sine=waves[ORDER_COUNT : 2 * ORDER_COUNT],
        viscous=max(viscous, 0.0),
        domain_start=start,
        domain_end=end,
    )


def _run(recording: Recording) -> tuple[Array, Array, Array]:
    """Return angle, size of the friction and size of the speed of a run one way."""
    check_recording("recordings", recording)
    angle, torque = sensible(recording, "angle", "rad"), sensible(recording, "torque", "N.m")
    if np.any(np.abs(np.diff(angle)) > np.pi):  # an encoder that wraps
        angle = np.unwrap(angle)
    way = float(np.sign(angle[-1] - angle[0]))
    if way == 0.0:
        raise ValueError("the angle ends where it began; give each run one way, at constant speed, by itself")
    speed = np.abs(recording.values("speed", "rad/s")) if "speed" in recording.names else np.zeros_like(angle)
    level = way * torque if np.mean(torque) * way > 0.0 or np.any(torque < 0.0) else torque
    return angle, level, speed


def _integrated(angle: Array, level: Array) -> Array | None:
    """Return the article's integrals over the whole turns of a run: s1, s2, s3, a_k, b_k; None for fewer than three turns."""
    order = np.argsort(angle, kind="stable")
    angle, level = angle[order], level[order]
    first, turns = float(angle[0]), int((angle[-1] - angle[0]) // FULL_TURN)
    if turns < 3:
        return None
    centres, means = [], []
    for turn in range(turns):
        q, f = _between(angle, level, first + turn * FULL_TURN, first + (turn + 1) * FULL_TURN)
        centres.append(first + (turn + 0.5) * FULL_TURN)
        means.append(np.trapezoid(f, q) / FULL_TURN)
    quadratic, linear, constant = np.polyfit(centres, means, 2)
    constant -= quadratic * np.pi**2 / 3.0
    q, f = _between(angle, level, first, first + turns * FULL_TURN)
    left = f - np.polyval([quadratic, linear, constant], q)
    k = np.arange(1, ORDER_COUNT + 1)[:, np.newaxis]
    waves = np.concatenate([np.cos(k * q), np.sin(k * q)])
    return np.concatenate([[quadratic, linear, constant], 2.0 / (turns * FULL_TURN) * np.trapezoid(left * waves, q, axis=1)])


def _between(angle: Array, level: Array, start: float, end: float) -> tuple[Array, Array]:
    """Return the samples of a stretch, and both its ends."""
    inside = (angle > start) & (angle < end)
    ends = np.interp([start, end], angle, level)
    return np.concatenate([[start], angle[inside], [end]]), np.concatenate([ends[:1], level[inside], ends[1:]])
