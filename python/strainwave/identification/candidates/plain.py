"""Plain least squares on a log: the simplest model of a joint, from which fits start and which no answer may be worse than."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.equality import ComparedByFields
from strainwave.identification.experiments.motion_log import MotionLog, per_torque

Array = NDArray[np.float64]
Rows = NDArray[np.bool_]

TURNS_OVER = 0.005  # of a fast speed: about there the sign of friction turns over, so that it is smooth at rest (assumed)
FAST_QUANTILE = 0.99  # of the size of the speed
MIN_SPEED = 0.01  # of a fast speed: the motion begins and ends where it is exceeded
POWER_BLOCKS = 10  # of the motion, over which the power of friction is averaged
RCOND = 1e-6  # singular values below this share of the largest are taken as zero


@dataclass(frozen=True, eq=False)
class Plain(ComparedByFields):
    """Offset, inertia, gravity, Coulomb and viscous friction of a log by linear least squares, referred to the input.

    Attributes:
        inertia: of everything that turns [kg.m2]
        viscous: [N.m.s/rad]
        coulomb: [N.m]
        offset: [N.m]
        gravity: amplitude at the output [N.m]
        phase: of the gravity [rad]
        shares: of other bodies in the torque of the output, as many as the log has regressors [1]
        explained: share of the variation of the torque [1]
        dissipated: mean power that friction takes from the motion, over its standard deviation by blocks [1]
    """

    inertia: float
    viscous: float
    coulomb: float
    offset: float
    gravity: float
    phase: float
    shares: tuple[float, ...]
    explained: float
    dissipated: float


def moving(log: MotionLog) -> Rows:
    """Return the samples of the grid from the first motion to the last, shape (m,)."""
    speed = np.abs(log.motion.speed)
    fast = np.flatnonzero(speed > MIN_SPEED * np.quantile(speed, FAST_QUANTILE))
    rows = np.zeros(len(speed), bool)
    rows[fast[0] : fast[-1] + 1] = True
    return rows


def fit_plain(log: MotionLog, drive: Drive) -> Plain:
    """Fit a log by linear least squares, in the full band, at every sample from the first motion to the last.

    torque = J a + b v + c sgn v + o + (g_s sin q + g_c cos q) / i + shares of other bodies
    """
    columns, torque, rows = _columns(log, drive), _torque(log, drive), moving(log)
    weights = _solved(columns[rows], torque[rows])
    left = (torque - columns @ weights)[rows]
    power = (columns[:, 1:3] @ weights[1:3] * log.motion.speed)[rows]
    means = np.array([block.mean() for block in np.array_split(power, POWER_BLOCKS)])
    spread = float(np.std(means, ddof=1)) / np.sqrt(POWER_BLOCKS)
    inertia, viscous, coulomb, offset = (float(each) for each in weights[:4])
    return Plain(
        inertia, viscous, coulomb, offset,
        float(np.hypot(*weights[4:6])),
        float(np.arctan2(weights[5], weights[4])),
        tuple(weights[6:].tolist()),
        1.0 - float(np.var(left) / max(float(np.var(torque[rows])), 1e-300)),
        float(means.mean() / max(spread, 1e-300)),
    )  # fmt: skip


def held_out_residuals(log: MotionLog, drive: Drive, blocks: Sequence[Rows]) -> list[Array]:
    """Return what plain least squares leaves of the effort in each block by the rest of the motion, each of shape (block,)."""
    columns, torque, rows = _columns(log, drive), _torque(log, drive), moving(log)
    scale, found = abs(per_torque(drive, log.effort)), []
    for block in blocks:
        weights = _solved(columns[rows & ~block], torque[rows & ~block])
        found.append(scale * (torque - columns @ weights)[block])
    return found


def _columns(log: MotionLog, drive: Drive) -> Array:
    motion, ratio = log.motion, drive.gear.kinematics.ratio
    angle = motion.angle / ratio
    fast = float(np.quantile(np.abs(motion.speed), FAST_QUANTILE))
    sign = np.tanh(motion.speed / max(TURNS_OVER * fast, 1e-300))
    series = [motion.acceleration, motion.speed, sign, np.ones_like(angle), np.sin(angle) / ratio, np.cos(angle) / ratio]
    return np.stack([*series, *(each / ratio for each in log.regressors.values())], axis=1)


def _torque(log: MotionLog, drive: Drive) -> Array:
    """The torque of the motor at the input without what is known of it, on the grid [N.m]."""
    torque = (log.recorded - log.induced(drive)) / per_torque(drive, log.effort)
    return np.asarray(torque - log.extra / drive.gear.kinematics.ratio)


def _solved(columns: Array, torque: Array) -> Array:
    size = np.linalg.norm(columns, axis=0)
    size[size == 0.0] = 1.0
    found: Array = np.linalg.lstsq(columns / size, torque, rcond=RCOND)[0] / size
    return found
