"""Steady friction at a speed: determined even if a measurement does not determine Coulomb and viscous friction one by one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core
from strainwave._core import Gear
from strainwave.identification.experiments.friction_table import FRICTIONLESS, FrictionTable
from strainwave.identification.experiments.motion_log import MotionLog, transmitted_torque
from strainwave.identification.results.file_result import TOO_UNCERTAIN, FileEstimate, FileResult, is_uncertain
from strainwave.statistics.scale import ONE_SIGMA, student

Array = NDArray[np.float64]

MIN_SPEEDS = 4  # different ones, that determine a law of friction and validate it
STEADY_FRICTION = "steady_friction"
AT_SPEEDS = "friction at each speed"  # the model of a measurement of fewer speeds
STEADY_FRICTION_PARTS = ("friction_input.", "friction_mesh.")  # whose numbers act on steady friction


def friction_at(speed: float, value: float, sigma: float, *, side: str = "input") -> FileEstimate:
    """Return steady friction at a speed as an estimate.

    >>> print(friction_at(-0.41152, 2.3, 0.05, side="output").label)
    steady_friction (at 0.412 rad/s of the output)
    """
    why = TOO_UNCERTAIN if is_uncertain(value, sigma) else ""
    return FileEstimate(STEADY_FRICTION, "N.m", value, sigma, f"at {abs(speed):.3g} rad/s of the {side}", why)


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
        estimate = friction_at(mean, float(weights @ torque), float(np.sqrt(variance)), side=side)
        estimates.append(estimate if estimate.sigma else replace(estimate, sigma=np.inf, why="one number shows no scatter"))
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
    used = [place for place, path in enumerate(plain) if path.startswith(STEADY_FRICTION_PARTS) and path in numbers]
    table = FrictionTable(np.array([abs(speed)]), np.zeros(1), load=np.array([load]))
    torque, slopes = table.predict(gear, [numbers[plain[place]] for place in used], np.zeros(0))
    gradient = slopes[:, 0, 0]
    acting = gradient != 0.0
    places = np.array(used, int)[acting]
    with np.errstate(invalid="ignore"):  # of infinite variances
        variance = float(gradient[acting] @ covariance[np.ix_(places, places)] @ gradient[acting])
    return friction_at(speed, float(torque[0, 0]), float(np.sqrt(variance)) if variance >= 0.0 else np.inf)


def best_known_friction(gear: Gear, paths: Sequence[str], covariance: Array, speeds: Iterable[float]) -> FileEstimate:
    """Return the steady friction at that of the speeds where its relative standard deviation is smallest.

    Args:
        gear, paths, covariance: as of `steady_friction_at`
        speeds: of the input that were measured [rad/s]
    """
    tried = [steady_friction_at(gear, paths, covariance, speed) for speed in dict.fromkeys(map(abs, speeds)) if speed > 0.0]
    return min(tried, key=lambda each: each.sigma / abs(each.value) if each.value else np.inf)


# ---- By the fit of a file --------------------------------------------------------------------------------------------


def measured_speeds(file: FileResult) -> Array:
    """Return the sizes of the speeds at which a file shows steady friction, of the input [rad/s]; empty if it shows none."""
    experiment = None if file.fit is None else file.fit.parts[0].experiment
    if isinstance(experiment, FrictionTable):
        return np.abs(experiment.speed)
    if isinstance(experiment, MotionLog):
        speed = np.abs(experiment.motion.speed[experiment.motion.rows])
        return speed[speed > 0.0]
    return np.zeros(0)


def mean_load(file: FileResult) -> float:
    """Return the mean size of the torque that the input transmitted in a file that has speeds [N.m]; 0 if it is not known."""
    assert file.fit is not None
    experiment, model = file.fit.parts[0].experiment, file.fit.parts[0].model
    if isinstance(experiment, FrictionTable):
        return 0.0 if experiment.load is None else float(np.mean(np.abs(experiment.load)))
    if not isinstance(experiment, MotionLog) or not isinstance(model, Drive):
        return 0.0
    torque = transmitted_torque(experiment, model)[experiment.motion.rows]
    return float(np.mean(np.abs(torque))) / abs(model.gear.kinematics.ratio)


def has_loss(file: FileResult) -> bool:
    """True if the law of a file has a loss under load."""
    return file.fit is not None and file.fit.gear.friction_mesh != FRICTIONLESS


def friction_of(file: FileResult, speed: float, load: float) -> FileEstimate:
    """Return the steady friction by a file that has speeds, with the standard deviations of its estimates.

    Args:
        file: the file
        speed: of the input [rad/s]
        load: torque that the input transmits [N.m]
    """
    fit, by_path = file.fit, {each.path: each for each in file.estimates}
    assert fit is not None
    prefix = "" if isinstance(fit.model, Drive) else "gear."
    own = [by_path.get(prefix + each.path) for each in fit.estimates]
    sigma = np.array([free.sigma if each is None else each.own for each, free in zip(own, fit.estimates, strict=True)])
    with np.errstate(invalid="ignore"):  # what a file does not determine has no finite standard deviation, nor has the result
        covariance = fit.correlation * np.outer(sigma, sigma)
    common = max((each.common / abs(each.value) for each in own if each is not None and each.value), default=0.0)
    return steady_friction_at(fit.gear, [each.path for each in fit.estimates], covariance, speed, load).resting_on(common)
