"""One file of measurements fitted, by what it is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from strainwave import Drive, loads, motor
from strainwave.equality import ComparedByFields
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.candidates.motion import MotionCandidate, fit_motion, regression
from strainwave.identification.curves import curves_of, curves_of_orders
from strainwave.identification.evidence.verdict import numbers
from strainwave.identification.experiments.motion_log import MotionLog, spoilt
from strainwave.identification.findings import Finding, Told
from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.orders.two_encoders import TransmissionError, transmission_error
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.twin import Twin, twin

EXPLAINED = 0.5  # of the variation of the torque: a log of which inertia and friction explain less tells neither
FRICTION = ("coulomb", "breakaway", "viscous", "stribeck_speed")  # mean the same in every law that has them
NO_ROTOR = 1e-12  # kg.m2: something must turn at the input
UNUSED = {"ratio", "load_inertia", "load_torque", "speed", "temperature"}  # constants that a log is not fitted with
ANGLES = ("input_angle", "output_angle")


@dataclass(frozen=True)
class Known:
    """What is known before a file is fitted.

    Attributes:
        gear_set: the set, with what earlier files have told of it
        friction: the recording of a friction table, if one was given
        told: parts of the gear that earlier files have told
        sigmas: standard deviation of the first number of friction and spring, as the file has it that tells the part
    """

    gear_set: GearSet
    friction: Recording | None = None
    told: frozenset[str] = frozenset()
    sigmas: Mapping[str, float] = field(default_factory=dict)

    def knows_better(self, part: str, told: Sequence[Told]) -> bool:
        """Whether an earlier file tells a part of the gear better than this one."""
        return part in self.told and self.sigmas.get(part, np.inf) <= _first_sigma(part, told)


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
    table = with_torque(file, known.gear_set)
    found = twin(known.gear_set, friction=table, side=file.side, sources={"friction": file.path.name})
    finding = _of_twin(file, found)
    if finding.refused or known.knows_better("friction_input", finding.told):
        return finding, known
    gear = known.gear_set.gear.replace(friction_input=found.gear_set.gear.friction_input)
    after = _with_gear(known, gear, found, {"friction_input"}, friction=table)
    return finding, _judged(after, "friction_input", finding.told)


def _first_sigma(part: str, told: Sequence[Told]) -> float:
    """Standard deviation of the first number of a part; infinite where the file does not tell it."""
    own = [each.sigma for each in told if each.path.startswith(f"gear.{part}.") and not each.why]
    return own[0] if own else np.inf


def _judged(known: Known, part: str, told: Sequence[Told]) -> Known:
    return replace(known, sigmas={**known.sigmas, part: _first_sigma(part, told)})


def with_torque(file: Recognised, gear_set: GearSet) -> Recording:
    """A friction table with the torque of the motor, where only its current was measured."""
    if "torque" in file.recording:
        return file.recording
    constant = file.constants.get("torque_constant", getattr(gear_set.motor, "torque_constant", None))
    if constant is None:
        raise ValueError("it tells the current alone; give the torque constant of the motor, with --constant torque_constant=…")
    return file.recording.with_column("torque", constant * file.recording["current"], "N.m")


def _torsion(file: Recognised, known: Known) -> tuple[Finding, Known]:
    at_input = "input_angle" in file.recording
    friction = known.friction if at_input else None
    found = twin(known.gear_set, friction=friction, torsion=file.recording, sources={"torsion": file.path.name})
    finding = _of_twin(file, found)
    parts = {"stiffness", "hysteresis"}
    if finding.refused or known.knows_better("stiffness", finding.told):
        return finding, known
    gear = known.gear_set.gear.replace(**{part: getattr(found.gear_set.gear, part) for part in parts})
    return finding, _judged(_with_gear(known, gear, found, parts), "stiffness", finding.told)


def _of_twin(file: Recognised, found: Twin) -> Finding:
    evidence = found.evidence[-1]
    remarks = (*file.remarks, *evidence.remarks)
    curves = curves_of(evidence.fit)
    if doubts := evidence.doubts:
        refused = "; ".join(f"{doubt.what}. What to do: {doubt.remedy}" for doubt in doubts)
        return Finding(file.path.name, file, evidence.candidates[0][0], (), np.nan, remarks, refused, curves=curves)
    own = {evidence.path(estimate) for estimate in evidence.fit.estimates}
    gear = found.gear_set.gear
    told = tuple(
        Told(v.path, v.unit, v.value, v.sigma, _law(v.path, gear), "" if v.state == "identified" else v.why)
        for v in found.verdicts
        if v.path in own
    )
    share = float(evidence.error[0] / np.std(evidence.fit.experiment.measured))
    return Finding(file.path.name, file, evidence.candidates[0][0], told, share, remarks, curves=curves)


def _with_gear(known: Known, gear: Any, found: Twin, parts: set[str], friction: Recording | None = None) -> Known:
    """The set with a gear of which some parts are those of a twin, with their sources."""
    names = tuple(f"gear.{part}" for part in parts)
    sources = {path: entry for path, entry in known.gear_set.sources.items() if not path.startswith(names)}
    sources |= {path: entry for path, entry in found.gear_set.sources.items() if path.startswith(names)}
    gear_set = replace(known.gear_set, gear=gear, sources=sources)
    table = friction if friction is not None else known.friction
    return replace(known, gear_set=gear_set, friction=table, told=known.told | parts)


def _law(path: str, gear: Any) -> str:
    """The law that gives a number its meaning."""
    part, _, name = path.removeprefix("gear.").partition(".")
    return "" if part == "friction_input" and name in FRICTION else str(getattr(gear, part).name)


# ---- Two encoders ---------------------------------------------------------------------------------------------------


def _encoders(file: Recognised, known: Known) -> tuple[Finding, Known]:
    found = transmission_error(file.recording)
    told = tuple(_orders(found))
    remarks, curves = (*file.remarks, *found.remarks), curves_of_orders(found)
    finding = Finding(file.path.name, file, "orders of the input", told, np.nan, remarks, curves=curves)
    return finding, _with_error(known, found, file.path.name)


def _with_error(known: Known, found: TransmissionError, name: str) -> Known:
    """The set with a kinematic error, unless an earlier file has told it."""
    law = found.law
    if "kinematic_error" in known.told or not law.order:
        return known
    by_order = {each.order: each for each in found.orders if each.significant and each.shaft != "output"}
    sigmas = {f"gear.kinematic_error.amplitude[{i}]": by_order[order].amplitude_sigma for i, order in enumerate(law.order)}
    sigmas |= {f"gear.kinematic_error.phase[{i}]": by_order[order].phase_sigma for i, order in enumerate(law.order)}
    return _with_parts(known, {"kinematic_error": law}, sigmas, name)


def _with_parts(known: Known, parts: Mapping[str, Any], sigmas: Mapping[str, float], name: str) -> Known:
    """The set with parts of the gear that a file tells."""
    gear, names = known.gear_set.gear.replace(**parts), tuple(f"gear.{part}." for part in parts)
    sources = {path: entry for path, entry in known.gear_set.sources.items() if not path.startswith(names)}
    for path in (path for path in numbers(gear) if path.startswith(names)):
        told = path in sigmas and np.isfinite(sigmas[path])
        sources[path] = Entry(source=f"identified from {name}", uncertainty=sigmas[path] if told else None)
    return replace(known, gear_set=replace(known.gear_set, gear=gear, sources=sources), told=known.told | set(parts))


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


@dataclass(frozen=True, eq=False)
class Taken(ComparedByFields):
    """A log as it is taken.

    Attributes:
        log: the experiment
        drive: as far as it is known
        recording: with the torque in the sense of the motion
        remarks: what was assumed, put right or left out
        in_current: whether torques are in A, as the torque constant is not known
        constant_given: whether a person told the torque constant with the file
    """

    log: MotionLog
    drive: Drive
    recording: Recording
    remarks: tuple[str, ...]
    in_current: bool
    constant_given: bool


def log_of(file: Recognised, known: Known) -> Taken:
    """A log along its motion, with the torque in the sense of the motion.

    Raises:
        ValueError: inertia, friction and gravity do not explain it
    """
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
            "the drive did more than one shaft does (give the torque of other joints as a column rigid_torque), or sides or "
            "units are not what they are taken for"
        )
    spoilt_rows = int(np.sum(spoilt(recording[log.effort])))
    if spoilt_rows:
        remarks.append(f"{spoilt_rows} samples of {log.effort} are outliers or clipped, and left out")
    return Taken(log, drive, recording, tuple(remarks), in_current, "torque_constant" in file.constants)


def _log(file: Recognised, known: Known) -> tuple[Finding, Known]:
    taken = log_of(file, known)
    drive, recording, in_current, remarks = taken.drive, taken.recording, taken.in_current, list(taken.remarks)
    log = taken.log
    best, *_ = fit_motion({file.path.name: log}, drive)
    told = list(_of_motion(best, known.gear_set, taken))
    if not in_current:
        known = _with_friction(known, best, told, file.path.name)
    if set(ANGLES) <= set(recording.names):
        errors = transmission_error(recording)
        told += _orders(errors)
        remarks += errors.remarks
        known = _with_error(known, errors, file.path.name)
    every, curves = (*file.remarks, *remarks), curves_of(best.fit)
    return Finding(file.path.name, file, best.name, tuple(told), best.error, every, curves=curves), known


def _with_friction(known: Known, best: MotionCandidate, told: Sequence[Told], name: str) -> Known:
    """The set with the friction that a log tells, of places of which no earlier file has told any."""
    gear = best.fit.parts[0].model.gear
    sigmas = {each.path: each.sigma for each in told}
    for part in ("friction_input", "friction_mesh"):
        law = getattr(gear, part)
        if part not in known.told and law != getattr(known.gear_set.gear, part):
            known = _with_parts(known, {part: law}, sigmas, name)
    return known


def _drive(file: Recognised, gear_set: GearSet) -> tuple[Drive, list[str], bool]:
    """The drive of a log, of the motor that the set or the person tells; remarks; and whether torques are in A."""
    constants, remarks, gear = file.constants, list[str](), gear_set.gear
    if unused := sorted(constants.keys() & UNUSED):
        remarks.append(f"not used of a log: {', '.join(unused)}; what the set says is taken")
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
        inertia=NO_ROTOR if inertia is None or in_current else inertia,
        resistance=constants.get("resistance", getattr(given, "resistance", 0.0)),
    )
    return Drive(gear=gear, motor=motor_there, load=loads.Inertia(inertia=1.0)), remarks, in_current


def _of_motion(best: MotionCandidate, gear_set: GearSet, taken: Taken) -> Iterator[Told]:
    """The numbers of a log; each as uncertain as the torque constant, besides."""
    drive, in_current = taken.drive, taken.in_current
    ratio, relative = drive.gear.kinematics.ratio, 0.0 if taken.constant_given else _of_constant(gear_set)
    rotor = (drive.motor.inertia + drive.gear.input_inertia) * ratio**2
    encoder = "of input_angle" if "input_angle" in taken.recording else "of output_angle"  # from whose zero the phase counts
    nuisances = {nuisance.name for part in best.fit.parts for nuisance in part.experiment.nuisances}
    for estimate in best.fit.estimates:
        if estimate.path in nuisances or estimate.path in best.tied:
            continue
        size = abs(estimate.value) + (rotor if estimate.path == "load.inertia" else 0.0)
        of_torque = estimate.unit.startswith(("N.m", "kg.m2"))
        sigma = float(np.hypot(estimate.sigma, relative * size if of_torque else 0.0))
        untold = _untold(estimate, sigma, best)
        unit = estimate.unit.replace("N.m", "A").replace("kg.m2", "A.s2/rad") if in_current else estimate.unit
        law = "in A" if in_current and of_torque else encoder if estimate.path == "load.gravity_phase" else ""
        yield Told(estimate.path, unit, estimate.value, sigma, law, untold)


def _of_constant(gear_set: GearSet) -> float:
    """Relative uncertainty of the torque constant, as the set has it."""
    entry, constant = gear_set.sources.get("motor.torque_constant"), getattr(gear_set.motor, "torque_constant", 0.0)
    if entry is None or not constant:
        return 0.0
    return float(entry.uncertainty / constant if entry.uncertainty else entry.spread or 0.0)


def _untold(estimate: Estimate, sigma: float, best: MotionCandidate) -> str:
    """Why a log does not tell a number; empty where it does."""
    if estimate.path != "load.gravity_phase":
        return "its standard deviation exceeds half the value" if sigma > 0.5 * abs(estimate.value) else ""
    gravity = next(each for each in best.fit.estimates if each.path == "load.gravity_torque")
    return "there is no gravity that the log tells" if gravity.sigma > 0.5 * abs(gravity.value) or sigma > 0.5 else ""
