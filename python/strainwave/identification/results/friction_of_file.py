"""Steady friction by the fit of a file: at which speeds and loads it was measured, and its torque there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive
from strainwave.identification.experiments.friction_table import FRICTIONLESS, FrictionTable
from strainwave.identification.experiments.motion_log import MotionLog, transmitted_torque
from strainwave.identification.results.determined import steady_friction_at
from strainwave.identification.results.file_result import FileEstimate, FileResult

Array = NDArray[np.float64]


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
