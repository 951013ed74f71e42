"""One file of measurements fitted, by what it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from strainwave import Drive, loads, motor
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.candidates.motion import MotionCandidate, fit_motion, regression
from strainwave.identification.experiments.motion_log import MotionLog, spoilt
from strainwave.identification.findings import Finding, Told
from strainwave.identification.orders.two_encoders import TransmissionError, transmission_error
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.twin import Twin, twin

EXPLAINED = 0.5  # of the variation of the torque: a log of which inertia and friction explain less tells neither
FRICTION = ("coulomb", "breakaway", "viscous", "stribeck_speed")  # mean the same in every law that has them
ANGLES = ("input_angle", "output_angle")


@dataclass(frozen=True)
class Known:
    """What is known before a file is fitted.

    Attributes:
        gear_set: the set, with what earlier files have told of it
        friction: the recording of a friction table, if one was given
        told: parts of the gear that earlier files have told
    """

    gear_set: GearSet
    friction: Recording | None = None
    told: frozenset[str] = frozenset()


def fitted(file: Recognised, known: Known) -> tuple[Finding, Known]:
    """What a file tells, and what is known after it.

    Raises:
        ValueError: nothing can be found in it; says why
    """
    if file.kind == "friction":
        return _friction(file, known)
    if file.kind == "torsion":
        return _torsion(file, known)
    if file.kind == "encoders":
        return _encoders(file, known)
    if file.kind == "log":
        return _log(file, known)
    raise ValueError("torque without motion tells orders alone: strainwave orders finds them")


def _friction(file: Recognised, known: Known) -> tuple[Finding, Known]:
    found = twin(known.gear_set, friction=file.recording, side=file.side, sources={"friction": file.path.name})
    finding = _of_twin(file, found)
    if finding.refused:
        return finding, known
    gear = known.gear_set.gear.replace(friction_input=found.gear_set.gear.friction_input)
    return finding, _with_gear(known, gear, found, {"friction_input"}, friction=file.recording)


def _torsion(file: Recognised, known: Known) -> tuple[Finding, Known]:
    at_input = "input_angle" in file.recording
    friction = known.friction if at_input else None
    found = twin(known.gear_set, friction=friction, torsion=file.recording, sources={"torsion": file.path.name})
    finding = _of_twin(file, found)
    parts = {"stiffness", "hysteresis"}
    if finding.refused or parts & known.told:
        return finding, known
    gear = known.gear_set.gear.replace(**{part: getattr(found.gear_set.gear, part) for part in parts})
    return finding, _with_gear(known, gear, found, parts)


def _of_twin(file: Recognised, found: Twin) -> Finding:
    evidence = found.evidence[-1]
    remarks = (*file.remarks, *evidence.remarks)
    if doubts := evidence.doubts:
        refused = "; ".join(f"{doubt.what}. What to do: {doubt.remedy}" for doubt in doubts)
        return Finding(file.path.name, file, evidence.candidates[0][0], (), np.nan, remarks, refused)
    own = {evidence.path(estimate) for estimate in evidence.fit.estimates}
    gear = found.gear_set.gear
    told = tuple(
        Told(v.path, v.unit, v.value, v.sigma, _law(v.path, gear), "" if v.state == "identified" else v.why)
        for v in found.verdicts
        if v.path in own
    )
    share = float(evidence.error[0] / np.std(evidence.fit.experiment.measured))
    return Finding(file.path.name, file, evidence.candidates[0][0], told, share, remarks)


def _with_gear(known: Known, gear: Any, found: Twin, parts: set[str], friction: Recording | None = None) -> Known:
    """The set with a gear of which some parts are those of a twin, with their sources."""
    names = tuple(f"gear.{part}" for part in parts)
    sources = {path: entry for path, entry in known.gear_set.sources.items() if not path.startswith(names)}
    sources |= {path: entry for path, entry in found.gear_set.sources.items() if path.startswith(names)}
    gear_set = replace(known.gear_set, gear=gear, sources=sources)
    return Known(gear_set, friction if friction is not None else known.friction, known.told | parts)


def _law(path: str, gear: Any) -> str:
    """The law that gives a number its meaning."""
    part, _, name = path.removeprefix("gear.").partition(".")
    return "" if part == "friction_input" and name in FRICTION else str(getattr(gear, part).name)


# ---- Two encoders ---------------------------------------------------------------------------------------------------


def _encoders(file: Recognised, known: Known) -> tuple[Finding, Known]:
    found = transmission_error(file.recording, ratio=None)
    return Finding(
        file.path.name, file, "orders of the input", tuple(_orders(found)), np.nan, (*file.remarks, *found.remarks)
    ), known


def _orders(found: TransmissionError) -> Iterator[Told]:
    for each in found.orders:
        if each.shaft == "input" and each.significant:
            yield Told(
                f"gear.kinematic_error.amplitude of order {each.order:g}",
                "rad",
                each.amplitude,
                each.amplitude_sigma,
                "fourier",
            )


# ---- Logs -----------------------------------------------------------------------------------------------------------


def _log(file: Recognised, known: Known) -> tuple[Finding, Known]:
    drive, remarks, in_current = _drive(file, known.gear_set)
    recording = file.recording
    log = MotionLog.of(recording, drive)
    before = regression(log, drive)
    if before.reversed:
        remarks.append(f"{log.effort} is counted against the motion: its sign is turned round")
        recording = recording.with_column(log.effort, -recording[log.effort], recording.unit(log.effort))
        log = MotionLog.of(recording, drive)
        before = regression(log, drive)
    if not before.share > EXPLAINED or before.inertia <= 0.0:
        raise ValueError(
            f"inertia, friction and gravity explain {100.0 * max(before.share, 0.0):.0f} % of the variation of {log.effort}: "
            "the drive did more than one shaft does (give the torque of other joints as a column load_torque), or sides or units "
            "are not what they are taken for"
        )
    spoilt_rows = int(np.sum(spoilt(recording[log.effort])))
    if spoilt_rows:
        remarks.append(f"{spoilt_rows} samples of {log.effort} are outliers or clipped, and left out")
    best, *_ = fit_motion({file.path.name: log}, drive)
    told = list(_of_motion(best, known.gear_set, drive, in_current))
    if set(ANGLES) <= set(recording.names):
        errors = transmission_error(recording, ratio=None)
        told += _orders(errors)
        remarks += errors.remarks
    return Finding(file.path.name, file, best.name, tuple(told), best.error, (*file.remarks, *remarks)), known


def _drive(file: Recognised, gear_set: GearSet) -> tuple[Drive, list[str], bool]:
    """The drive of a log, of the motor that the set or the person tells; remarks; and whether torques are in A."""
    constants, remarks, gear = file.constants, list[str](), gear_set.gear
    given = gear_set.motor
    constant = constants.get("torque_constant", getattr(given, "torque_constant", None))
    inertia = constants.get("motor_inertia", getattr(given, "inertia", None))
    in_current = constant is None and not {"input_torque", "joint_torque"} & set(file.recording.names)
    if in_current:
        remarks.append("the torque constant is not known: torques are told in A; give --constant torque_constant=… for N.m")
        gear = gear.replace(input_inertia=0.0)
    elif inertia is None:
        remarks.append("the inertia of the motor is not known: that of the load has it inside, times the ratio squared")
    motor_there = motor.CurrentSource(
        torque_constant=1.0 if constant is None else constant,
        inertia=0.0 if inertia is None or in_current else inertia,
        resistance=constants.get("resistance", getattr(given, "resistance", 0.0)),
    )
    return Drive(gear=gear, motor=motor_there, load=loads.Inertia(inertia=1.0)), remarks, in_current


def _of_motion(best: MotionCandidate, gear_set: GearSet, drive: Drive, in_current: bool) -> Iterator[Told]:
    """The numbers of a log; each as uncertain as the torque constant, besides."""
    entry = gear_set.sources.get("motor.torque_constant")
    constant, ratio = getattr(gear_set.motor, "torque_constant", 0.0), drive.gear.kinematics.ratio
    relative = (
        (entry.uncertainty / constant if entry.uncertainty else entry.spread or 0.0) if entry is not None and constant else 0.0
    )
    rotor = (drive.motor.inertia + drive.gear.input_inertia) * ratio**2
    nuisances = {nuisance.name for part in best.fit.parts for nuisance in part.experiment.nuisances}
    for estimate in best.fit.estimates:
        if estimate.path in nuisances or estimate.path.rpartition(".")[2] in (
            "driving_reverse",
            "backdriving_forward",
            "backdriving_reverse",
        ):
            continue
        if estimate.path.endswith(".breakaway") and best.name in ("Coulomb and viscous", "with loss under load"):
            continue  # it follows Coulomb's torque
        size = abs(estimate.value) + (rotor if estimate.path == "load.inertia" else 0.0)
        of_torque = estimate.unit.startswith(("N.m", "kg.m2"))
        sigma = float(np.hypot(estimate.sigma, relative * size if of_torque else 0.0))
        untold = "its standard deviation exceeds half the value" if sigma > 0.5 * abs(estimate.value) and of_torque else ""
        unit = estimate.unit.replace("N.m", "A").replace("kg.m2", "A.s2/rad") if in_current else estimate.unit
        law = "in A" if in_current and of_torque else ""
        yield Told(estimate.path, unit, estimate.value, sigma, law, untold)
