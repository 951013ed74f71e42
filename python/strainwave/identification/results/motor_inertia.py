"""Inertia of the motor in that of the load: a log of the motor's torque determines both together, one of both encoders each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from strainwave import Drive
from strainwave.identification.experiments.motion_log import MIN_INERTIA
from strainwave.identification.results.combined_parameter import CombinedParameter, combine
from strainwave.identification.results.file_result import IN_CURRENT, FileEstimate, FileResult

MOTOR, LOAD = "motor.inertia", "load.inertia"
TOGETHER = (
    "the inertia of the motor is not known: load.inertia is that of the load, plus that of the motor times the ratio squared"
)
APART = (
    "the inertia of the motor is not known: motor.inertia is what the torque of the motor shows, less the load, which the "
    "wind-up of the gear shows; "
)


def drive_of(result: FileResult) -> Drive | None:
    """Return the drive fitted to a file; None if it was no drive."""
    model = None if result.fit is None else result.fit.parts[0].model
    return model if isinstance(model, Drive) else None


def without_motor(files: Sequence[FileResult], *, accept: bool = False) -> tuple[FileResult, ...]:
    """Return the results with loads less the motor, if a file determines its inertia; a remark states what load.inertia is.

    Args:
        files: results
        accept: whether files with a failed check determine it although others do
    """
    motors = {each.estimate.law: each for each in combine(files, accept=accept) if each.estimate.path == MOTOR}
    return tuple(_without_motor(file, motors) for file in files)


def _without_motor(file: FileResult, motors: Mapping[str, CombinedParameter]) -> FileResult:
    drive, own = drive_of(file), {each.path: each for each in file.estimates}
    if drive is None or LOAD not in own or (drive.motor.inertia > MIN_INERTIA and MOTOR not in own):
        return file
    load, motor = own[LOAD], motors.get(own[LOAD].law)
    if MOTOR in own:
        of_gear = drive.gear.input_inertia
        remark = APART + (f"the gear's {of_gear:.3g} kg·m² are not in it" if of_gear else "the wave generator's is in it")
    elif motor is not None:
        load = _less(load, motor.estimate, drive.gear.kinematics.ratio**2)
        remark = f"the inertia of the motor is that of {motor.taken_from}, and load.inertia is without it"
    elif load.law == IN_CURRENT:
        return file
    else:
        remark = TOGETHER
    estimates = tuple(load if each.path == LOAD else each for each in file.estimates)
    read = () if file.recognised is None else file.recognised.remarks
    place = 1 + max((file.remarks.index(each) for each in read if each in file.remarks), default=-1)  # behind how it was read
    return replace(file, estimates=estimates, remarks=(*file.remarks[:place], remark, *file.remarks[place:]))


def _less(load: FileEstimate, motor: FileEstimate, factor: float) -> FileEstimate:
    """Return the inertia of a load without that of the motor; what both share is no uncertainty of their difference."""
    own, common = float(np.hypot(load.own, factor * motor.own)), abs(load.common - factor * motor.common)
    less = replace(load, value=load.value - factor * motor.value, sigma=float(np.hypot(own, common)), common=common)
    return less.unless_uncertain()
