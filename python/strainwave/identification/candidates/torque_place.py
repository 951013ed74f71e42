"""Place at which the torque of a log was measured: it decides which inertias and which friction the torque contains.

A torque of the motor accelerates the motor's rotor and the wave generator; one behind the motor the wave generator alone; one
behind the gear neither, and it contains no friction of the gear. The inertias of the start set are guesses. If all that turns
has less than they have, the torque was measured behind them, or they are smaller.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from strainwave import Drive
from strainwave.identification.candidates.plain import Plain, fit_plain, inertia_with_sigma, moving
from strainwave.identification.experiments.friction_table import FRICTIONLESS
from strainwave.identification.experiments.motion_log import MIN_INERTIA, MotionLog
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

ROTOR_MARGIN = 1.2  # times the inertia of the rotor: a joint torque with less of it was measured behind the rotor
MIN_FRICTION_SHARE = 1e-3  # of the friction of the start set: a joint torque with less was measured behind the gear
MIN_FRICTION_OF_INPUT = 0.1  # of the friction of the start set: with less, a joint torque may lack the rotor (assumed)
NO_ROTOR = 10.0 * MIN_INERTIA  # kg.m2: a drive must have some, and MIN_INERTIA stands for a rotor that is not known
SHARE_OF_ROTOR = 0.5  # of all that turns, if the start set's rotor has more than that


@dataclass(frozen=True)
class TorquePlace:
    """The part of a drive that a torque accelerates.

    Attributes:
        drive: with the inertias that the torque contains
        open_inertia: inertia at the input that the torque may contain or not [kg.m2]; 0 if the record decides
        has_friction: False if the torque contains no friction of the gear
        remark: what was decided and why; empty if the torque is that of the motor, as is assumed
    """

    drive: Drive
    open_inertia: float = 0.0
    has_friction: bool = True
    remark: str = ""


def torque_place(log: MotionLog, drive: Drive, motor_given: bool = False) -> TorquePlace:
    """Return the place at which the torque of a log was measured, by the sizes of its inertia and friction.

    Args:
        log: of the torque
        drive: with the inertias of motor and gear, and the friction of the gear, as guessed before
        motor_given: True if a person knows the motor's inertia, so that the torque is that of the motor; that of the gear is
            a guess all the same
    """
    ratio, motor, gear = drive.gear.kinematics.ratio, drive.motor.inertia, drive.gear.input_inertia
    inertia, sigma = inertia_with_sigma(log, drive)
    rotor, total = motor + gear, max(inertia + SIGNIFICANCE_SIGMA * sigma, 0.0)  # no more than that turns
    sizes = f"all that turns has {inertia * ratio**2:.3g} kg·m² at the output, the rotor {rotor * ratio**2:.3g} kg·m²"
    if motor_given:
        rest = max(inertia - motor, 0.0)
        if total >= rotor or total < motor:
            return TorquePlace(drive)
        return TorquePlace(
            _with_rotor(drive, motor, SHARE_OF_ROTOR * rest), total - motor,
            remark=f"{sizes}: that of the start set's wave generator is too large; the load's is not separable from it",
        )  # fmt: skip
    if log.effort == "joint_torque":
        share = _friction_share(fit_plain(log, drive), log, drive)
        if share < MIN_FRICTION_SHARE or total < ROTOR_MARGIN * rotor:
            why = "it contains no friction of the gear" if share < MIN_FRICTION_SHARE else sizes
            behind = _with_rotor(drive, NO_ROTOR, 0.0)
            return TorquePlace(
                behind if share >= MIN_FRICTION_SHARE else frictionless(behind),
                0.0 if total < rotor else rotor, share >= MIN_FRICTION_SHARE,
                f"{log.effort} was measured behind the rotor: {why}; the load's inertia is all that it contains",
            )  # fmt: skip
        return TorquePlace(drive, rotor if share < MIN_FRICTION_OF_INPUT else 0.0)
    if log.effort == "input_torque" and gear < total < rotor:
        return TorquePlace(
            _with_rotor(drive, NO_ROTOR, gear), motor, remark=f"{log.effort} was measured behind the motor's rotor: {sizes}"
        )
    if total >= rotor:
        return TorquePlace(drive)
    less = SHARE_OF_ROTOR * total / rotor
    return TorquePlace(
        _with_rotor(drive, less * motor, less * gear), total,
        remark=f"{sizes}: that of the start set is too large, or the torque was measured behind it; the inertia of the load is "
        "not separable from it",
    )  # fmt: skip


def _with_rotor(drive: Drive, motor: float, gear: float) -> Drive:
    """Return the drive with other inertias of motor and wave generator [kg.m2]."""
    return drive.replace(
        motor=drive.motor.replace(inertia=max(motor, MIN_INERTIA)), gear=drive.gear.replace(input_inertia=gear)
    )


def frictionless(drive: Drive) -> Drive:
    """Return the drive without friction at input and mesh, which a torque behind the gear does not contain."""
    return drive.replace(gear=drive.gear.replace(friction_input=FRICTIONLESS, friction_mesh=FRICTIONLESS))


def _friction_share(plain: Plain, log: MotionLog, drive: Drive) -> float:
    """Return the friction of a log over that of the drive, at the median speed."""
    speed = float(np.median(np.abs(log.motion.speed[moving(log)])))
    before = float(drive.gear.friction_input.steady(speed))
    return max(plain.coulomb + plain.viscous * speed, 0.0) / before if before > 0.0 else 1.0
