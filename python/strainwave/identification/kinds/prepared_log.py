"""A log of a drive prepared for the fit: its motor, and its torque in the sense of the motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from strainwave import Drive, loads, motor
from strainwave.equality import ComparedByFields
from strainwave.files.entries import OPPOSITE_SENSE
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.candidates.coupling import are_numbers, coupled, in_order
from strainwave.identification.candidates.plain import TorquePlace, along_best_motion, fit_plain, torque_place
from strainwave.identification.experiments.motion import integrated
from strainwave.identification.experiments.motion_log import MIN_INERTIA, MotionLog, spoilt
from strainwave.identification.reading.names import which_of, words_of
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.gear_so_far import GearSoFar, relative_sigma, rotor_sigma, torque_constant_of
from strainwave.messages import listed
from strainwave.questions import Answer, QuestionError

RECORDER_BIAS = 0.05  # of the rotor's inertia: a current recorded where a controller has just acted shows it larger (assumed)
UNUSED_CONSTANTS = {"speed", "temperature"}  # constants that a log is not fitted with


@dataclass(frozen=True, eq=False)
class PreparedLog(ComparedByFields):
    """A log prepared for the fit.

    Attributes:
        log: the experiment
        with_others: the log with terms of the other joints that move
        drive: as far as it is known
        recording: with the torque in the sense of the motion
        remarks: what was assumed, put right or left out
        in_current: whether torques are in A, as the torque constant is not known
        given: numbers of the drive that a person gave with the file, by path
        relative: standard deviation of the torque constant over its value, where the torque rests on it; else 0 [1]
        of_resistance: the same of the resistance, where the torque is that of a voltage [1]
        rotor: standard deviation of the inertia of motor and gear, as the output has it [kg.m2], with the bias of a recorder of
            currents; 0 where torques are in A
        has_friction: False if the torque was measured behind the gear, and contains no friction of it
    """

    log: MotionLog
    with_others: tuple[MotionLog, ...]
    drive: Drive
    recording: Recording
    remarks: tuple[str, ...]
    in_current: bool
    given: Mapping[str, float]
    relative: float
    of_resistance: float
    rotor: float
    has_friction: bool

    @property
    def motor_known(self) -> bool:
        """True if the inertia of the motor is known; else that of the load includes it."""
        return self.drive.motor.inertia > MIN_INERTIA


def log_of(file: Recognised, known: GearSoFar) -> PreparedLog:
    """Return a log along its motion, with the torque in the sense of the motion.

    Raises:
        ValueError: inertia, friction and gravity do not explain it
    """
    drive, remarks, in_current = _drive(file, known.gear_set)
    recording = _loaded(file)
    if not {"input_angle", "output_angle"} & set(recording.names):
        recording, remark = _with_angle(recording)
        remarks.append(remark)
    constant_known = "torque_constant" in file.constants or hasattr(known.gear_set.motor, "torque_constant")
    if not in_current and "current" in recording and not constant_known:
        remarks.append("the current is not used, as the torque constant is not known and a torque was measured")
        recording = recording.select([name for name in recording.names if name != "current"])
    log = MotionLog.of(recording, drive, regressors=file.regressors)
    if fit_plain(log, drive).sense < 0.0:
        of_output = drive.gear.kinematics.ratio < 0.0 and log.effort != "joint_torque"
        how = "in the sense of the output, which turns against the input" if of_output else "against the motion"
        opposite = f"{log.effort} {OPPOSITE_SENSE}{log.effort} of the model"
        remarks.append(f"{log.effort} is counted {how}: its sign is turned round, {opposite}")
        recording = recording.with_column(log.effort, -recording[log.effort], recording.unit(log.effort))
        log = MotionLog.of(recording, drive, regressors=file.regressors)
    log, is_of_speed = along_best_motion(log, recording, drive)
    is_given = "motor_inertia" in file.constants and log.effort != "joint_torque"
    place = TorquePlace(drive) if in_current else torque_place(log, drive, motor_given=is_given)
    remarks += [place.remark] * bool(place.remark)
    remarks += [
        "the speed is taken as it was recorded: along it the torque is predicted better than along the angle"
    ] * is_of_speed
    others = {name: file.recording[at] for name, at in file.neighbours.items()}
    with_others = tuple(coupled(log, drive, recording.time, others, _joint(file))) if others and not file.regressors else ()
    if with_others and not are_numbers(joints := [_joint(file), *others]):
        remarks.append(
            f"the names of joints are no numbers: their order from the base on is taken as {listed(in_order(joints))}; if the "
            "arm has another one, name the columns with numbers, as q1, q2"
        )
    spoilt_rows = int(np.sum(spoilt(recording[log.effort])))
    if spoilt_rows:
        share = 100.0 * spoilt_rows / len(recording)
        remarks.append(f"outliers or clipped samples of {log.effort} are left out: {spoilt_rows}, {share:.2g} % of all")
    given = {"load.inertia": file.constants["load_inertia"]} if "load_inertia" in file.constants and not in_current else {}
    rests = log.effort in ("current", "voltage") and not in_current  # a torque that was measured rests on no constant
    constant = torque_constant_of(file, known.gear_set) if rests else None
    relative = 0.0 if constant is None else constant[1]
    turning = place.drive.motor.inertia + place.drive.gear.input_inertia
    of_recorder = RECORDER_BIAS * turning if log.effort == "current" and not in_current else 0.0
    spread = 0.0 if in_current or place.drive is not drive else rotor_sigma(file, known.gear_set)
    drive = place.drive
    rotor = float(np.linalg.norm([spread, of_recorder, place.open_inertia])) * drive.gear.kinematics.ratio**2
    by_voltage = log.effort == "voltage" and "resistance" not in file.constants
    of_resistance = (
        relative_sigma(known.gear_set, "motor.resistance", getattr(drive.motor, "resistance", 0.0)) if by_voltage else 0.0
    )
    return PreparedLog(
        log, with_others, drive, recording, tuple(remarks), in_current, given, relative, of_resistance, rotor,
        place.has_friction,
    )  # fmt: skip


def _with_angle(recording: Recording) -> tuple[Recording, str]:
    """Return a recording of a speed with the angle that it makes, and a remark."""
    side = next(name.removesuffix("_speed") for name in recording.names if name.endswith("_speed"))
    angle = integrated(recording.values(f"{side}_speed", "rad/s"), recording.time)
    remark = f"no angle was recorded: {side}_speed is summed up, from 0 at the first row, and with it an error of its zero"
    return recording.with_column(f"{side}_angle", angle, "rad"), remark


def _joint(file: Recognised) -> str:
    """Return the name of the joint, as the columns of other joints have theirs."""
    own = next(column for name, column in file.columns.items() if name.endswith(("_angle", "_speed")))
    return file.joint or which_of(words_of(own))


def _drive(file: Recognised, gear_set: GearSet) -> tuple[Drive, list[str], bool]:
    """Return the drive of a log, with the motor of the set or of the mapping; remarks; and True if torques are in A."""
    constants, remarks, gear = file.constants, list[str](), gear_set.gear
    if unused := sorted(constants.keys() & UNUSED_CONSTANTS):
        remarks.append(f"given, but not used of a log: {listed(unused)}")
    given = gear_set.motor
    constant = constants.get("torque_constant", getattr(given, "torque_constant", None))
    inertia = constants.get("motor_inertia", getattr(given, "inertia", None))
    if "voltage" in file.columns and not {"current", "input_torque", "joint_torque"} & set(file.recording.names):
        by_voltage = _motor_by_voltage(file, given, inertia)
        share = 0.01 * by_voltage.torque_constant * by_voltage.back_emf / by_voltage.resistance
        remarks.append(
            "the torque is that of the voltage, less what the motor induces: if its torque constant is 1 % larger, the viscous "
            f"friction is {share:.2g} N·m·s/rad smaller; if its resistance is 1 % larger, all torques are 1 % smaller"
        )
        return Drive(gear=gear, motor=by_voltage, load=loads.Inertia(inertia=1.0)), remarks, False
    in_current = constant is None and not {"input_torque", "joint_torque"} & set(file.recording.names)
    if in_current:
        remarks.append("the torque constant is not known: torques are in A; give --constant torque_constant=NUMBER for N.m")
        gear = gear.replace(input_inertia=0.0)
    elif "motor_inertia" in constants:
        remarks.append(
            f"at the input turn the motor's {inertia:.3g} kg·m² and the set's {gear.input_inertia:.3g} kg·m² of the gear; "
            "where the first has the gear inside, give it without"
        )
    motor_there = motor.CurrentSource(
        torque_constant=1.0 if constant is None else constant,
        inertia=MIN_INERTIA if inertia is None or in_current else inertia,
        resistance=constants.get("resistance", getattr(given, "resistance", 0.0)),
    )
    return Drive(gear=gear, motor=motor_there, load=loads.Inertia(inertia=1.0)), remarks, in_current


def _motor_by_voltage(file: Recognised, given: Any, rotor: float | None) -> motor.DC:
    """Return the motor of a log that has its voltage alone; what the motor induces as it turns belongs to the voltage.

    Raises:
        ValueError: resistance or torque constant is neither given nor known of the set
    """
    numbers = {name: file.constants.get(name, getattr(given, name, 0.0)) for name in ("resistance", "torque_constant")}
    if missing := [name for name, value in numbers.items() if value == 0.0]:
        units, column = {"resistance": "Ohm, of the motor", "torque_constant": "N.m/A, of the motor"}, file.columns["voltage"]
        ways = [
            Answer("the motor is known", {"constants": dict.fromkeys(missing, 1.0)}, {name: units[name] for name in missing}),
            Answer("it asks an amplifier for a current", {"columns": {"current": column}, "units": {column: "A"}}),
        ]
        raise QuestionError("a voltage determines the torque of a motor that is known", ways)
    induced = numbers["torque_constant"] if "torque_constant" in file.constants else getattr(given, "back_emf", 0.0)
    return motor.DC(**numbers, back_emf=induced or numbers["torque_constant"], inductance=0.0, inertia=rotor or MIN_INERTIA)


def _loaded(file: Recognised) -> Recording:
    """Return the recording with a constant torque at the output that was given, added to that of a model of the arm."""
    if "load_torque" not in file.constants:
        return file.recording
    own = file.recording["rigid_torque"] if "rigid_torque" in file.recording else np.zeros(len(file.recording))
    return file.recording.with_column("rigid_torque", own + file.constants["load_torque"], "N.m")
