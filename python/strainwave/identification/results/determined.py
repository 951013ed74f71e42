"""Steady friction at a speed: determined even if a measurement does not determine Coulomb and viscous friction one by one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave import _core
from strainwave._core import Gear
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.results.file_result import TOO_UNCERTAIN, FileEstimate, is_uncertain
from strainwave.statistics.scale import ONE_SIGMA, student

Array = NDArray[np.float64]

MIN_SPEEDS = 4  # different ones, that determine a law of friction and validate it
PATH = "steady_friction"
AT_SPEEDS = "friction at each speed"  # the model of a measurement of fewer speeds
PLACES = ("friction_input.", "friction_mesh.")  # whose numbers act on steady friction


def friction_at(speed: float, value: float, sigma: float, *, side: str = "input") -> FileEstimate:
    """Return steady friction at a speed as an estimate.

    >>> print(friction_at(-0.41152, 2.3, 0.05, side="output").label)
    steady_friction (at 0.412 rad/s of the output)
    """
    why = TOO_UNCERTAIN if is_uncertain(value, sigma) else ""
    return FileEstimate(PATH, "N.m", value, sigma, f"at {abs(speed):.3g} rad/s of the {side}", why)


def different_speeds(speed: Array) -> int:
    """Return how many speeds differ, by 10 % or by their sign.

    >>> different_speeds(np.array([1.0, 1.001, -1.0, 2.0]))
    3
    """
    return np.unique(np.stack([np.round(np.log(np.abs(speed)), 1), np.sign(speed)]), axis=1).shape[1] if len(speed) else 0


def sizes_of(speed: Array) -> Array:
    """Return the mean of each size of speeds that differ by 10 % at least [rad/s], in order, shape (sizes,)."""
    sizes = np.round(np.log(np.abs(speed)), 1)
    return np.array([float(np.abs(speed[sizes == size]).mean()) for size in np.unique(sizes)])


def friction_at_speeds(
    speed: Array, torque: Array, covariance: Array | None = None, side: str = "input"
) -> tuple[tuple[FileEstimate, ...], tuple[str, ...]]:
    """Return friction at each size of the speed, and what it leaves open, of a measurement with too few speeds for a law.

    Of both directions it is half the difference of their torques, so that gravity and a zero error cancel.

    Args:
        speed: of each torque, with the sign of the motion [rad/s], shape (n,)
        torque: [N.m], shape (n,)
        covariance: of the torques [N2.m2], shape (n, n); of their scatter at one speed if not given
        side: at which both were measured

    >>> (found,), _ = friction_at_speeds(np.array([0.4, -0.4]), np.array([2.5, -2.1]), np.diag([0.01, 0.01]))
    >>> found.value, round(found.sigma, 3)
    (2.3, 0.071)
    """
    sizes = np.round(np.log(np.abs(speed)), 1)
    estimates = []
    for size, mean in zip(np.unique(sizes), sizes_of(speed).tolist(), strict=True):
        alike = [(sizes == size) & (np.sign(speed) == way) for way in (1.0, -1.0)]
        present = [rows for rows in alike if rows.any()]
        weights = np.zeros_like(speed)
        for rows in present:
            weights[rows] = np.sign(speed[rows]) / (rows.sum() * len(present))
        left = np.concatenate([torque[rows] - torque[rows].mean() for rows in present])
        freedom = len(left) - len(present)
        scatter = student(ONE_SIGMA, freedom) ** 2 * float(left @ left) / freedom if freedom > 0 else 0.0
        variance = scatter * float(weights @ weights) if covariance is None else float(weights @ covariance @ weights)
        found = friction_at(mean, float(weights @ torque), float(np.sqrt(variance)), side=side)
        estimates.append(found if found.sigma else replace(found, sigma=np.inf, why="one number shows no scatter"))
    count = different_speeds(speed)
    few = (
        f"{count} different {'speed' if count == 1 else 'speeds'}, slow or fast, one way or the other, determine friction "
        f"there and no law: record {MIN_SPEEDS} speeds or more, best both ways"
    )
    one_way = bool((speed > 0.0).all() or (speed < 0.0).all())
    zero = ("it has one direction only: gravity and a zero error of the torque are part of the friction",) if one_way else ()
    return tuple(estimates), (few, *zero)


def steady_friction_at(gear: Gear, paths: Sequence[str], covariance: Array, speed: float, load: float = 0.0) -> FileEstimate:
    r"""Return the steady friction of a gear at a speed of its input, with the standard deviation by the covariance.

    The standard deviation is that of a linear function of the estimates, $\sqrt{g^T C g}$, with g the derivatives of the
    friction (JCGM 100:2008, eq. 13). It is small where the measurement was made, even if the numbers of the law are known
    together only.

    Args:
        gear: the fitted gear
        paths: of the estimates in the gear or in its drive; other numbers than those of friction are left out
        covariance: of these estimates, shape (p, p); not finite where they are not determined, and so is the result
        speed: of the input [rad/s], not 0
        load: torque that the input transmits [N.m]

    >>> import strainwave as sw
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=2.0, breakaway=2.0, viscous=0.5))
    >>> covariance = np.array([[0.25, -0.25], [-0.25, 0.2504]])  # of a torque that was measured at 1 rad/s
    >>> found = steady_friction_at(gear, ["friction_input.coulomb", "friction_input.viscous"], covariance, 1.0)
    >>> found.value, round(found.sigma, 3)
    (2.5, 0.02)
    """
    plain = [path.removeprefix("gear.") for path in paths]
    numbers = {path: number for number, (path, *_) in enumerate(_core.parameters(gear))}
    used = [place for place, path in enumerate(plain) if path.startswith(PLACES) and path in numbers]
    table = FrictionTable(np.array([abs(speed)]), np.zeros(1), load=np.array([load]))
    torque, slopes = table.predict(gear, [numbers[plain[place]] for place in used], np.zeros(0))
    gradient = slopes[:, 0, 0]
    acting = gradient != 0.0
    known = np.array(used, int)[acting]
    with np.errstate(invalid="ignore"):  # of infinite variances
        variance = float(gradient[acting] @ covariance[np.ix_(known, known)] @ gradient[acting])
    return friction_at(speed, float(torque[0, 0]), float(np.sqrt(variance)) if variance >= 0.0 else np.inf)


def best_known_friction(gear: Gear, paths: Sequence[str], covariance: Array, speeds: Iterable[float]) -> FileEstimate:
    """Return the steady friction at that of the speeds where its relative standard deviation is smallest.

    Args:
        gear, paths, covariance: as of `steady_friction_at`
        speeds: of the input that were measured [rad/s]
    """
    tried = [steady_friction_at(gear, paths, covariance, speed) for speed in dict.fromkeys(map(abs, speeds)) if speed > 0.0]
    return min(tried, key=lambda each: each.sigma / abs(each.value) if each.value else np.inf)
