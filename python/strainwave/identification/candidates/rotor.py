"""Friction of a log by the inertia of its rotor, which the fit takes as known.

A log of the motor's torque determines one inertia, of rotor and load together. What the gear transmits, and with it the loss
under load, is the torque of the load alone: the loss is as uncertain as the share of the rotor.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from strainwave.identification.candidates.motion_candidate import MotionCandidate, nuisances_of
from strainwave.identification.candidates.motion_model import LOSSES
from strainwave.identification.experiments.motion_log import MIN_INERTIA_SHARE, inertia_of
from strainwave.identification.fitting.fit import solved_problem
from strainwave.statistics.linear_fit import solved

MOTOR, LOAD = "motor.inertia", "load.inertia"
RELATIVE_STEP = 1e-3  # of all that turns, for a derivative
SHARE_OF_UNKNOWN_ROTOR = 3.0**-0.5  # rms share of the rotor in all that turns, if any share is as likely as another


def inertia_at_input(best: MotionCandidate) -> float:
    """Return the inertia of the load at the input [kg.m2]; if that of the motor is not known, it includes it."""
    drive = best.fit.parts[0].model
    return float(inertia_of(drive) / drive.gear.kinematics.ratio**2)


def slopes_by_rotor(best: MotionCandidate) -> Mapping[str, float]:
    """Return the change of each estimate over that of the rotor's inertia, by path; empty without a loss under load."""
    if LOSSES[0] not in best.model.free:
        return {}
    problem, x = solved_problem(best.fit)
    (part,) = best.fit.parts
    ((predicted, slopes),) = problem.predict(x)
    drive, nuisances = part.model, nuisances_of(best.fit)
    step = RELATIVE_STEP * (inertia_at_input(best) + drive.motor.inertia)
    other, _ = part.experiment.predict(drive.replace({MOTOR: drive.motor.inertia + step}), [], nuisances)
    before, _ = problem.prior_rows()
    noise = float(np.std(part.residuals))
    rows = np.concatenate([slopes[:, 0].T, noise * before])
    moved = -solved(rows, np.concatenate([(other - predicted)[0] / step, np.zeros(len(before))]))
    return {each.path: float(slope) for each, slope in zip(problem.plan.unknowns, moved, strict=False)}


def with_rotor(best: MotionCandidate, inertia: float) -> MotionCandidate:
    """Return the model fitted anew with an inertia of the motor [kg.m2] that the wind-up of the gear shows."""
    drive = best.fit.parts[0].model
    carried = inertia_of(drive) - inertia * drive.gear.kinematics.ratio**2
    start = drive.replace({MOTOR: inertia, LOAD: max(carried, MIN_INERTIA_SHARE * inertia_of(drive))})
    return replace(best, model=replace(best.model, drive=start))
