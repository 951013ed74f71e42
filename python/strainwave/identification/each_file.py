"""One file of measurements fitted, by what it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from strainwave import Drive, loads, motor
from strainwave.equality import ComparedByFields
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.between_encoders import Between, between_encoders
from strainwave.identification.candidates.motion import MotionCandidate, fit_motion, regression
from strainwave.identification.contact import breakaway, presliding
from strainwave.identification.curves import curves_of, curves_of_orders
from strainwave.identification.dynamics.coupling import coupled
from strainwave.identification.experiments.motion_log import MotionLog, spoilt
from strainwave.identification.findings import Finding, Told
from strainwave.identification.fitting.estimate import Estimate
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.known import Known, TorqueConstant, rotor_sigma, with_torque
from strainwave.identification.orders.two_encoders import TransmissionError, transmission_error
from strainwave.identification.reading.channels import Kind
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.suspicion import clipped_loop, of_levels, too_fast, unlike_set
from strainwave.identification.twin import Twin, twin
from strainwave.identification.warmed import warmed
from strainwave.messages import as_option, listed

EXPLAINED = 0.5  # of the variation of the torque: a log of which inertia and friction explain less tells neither
FRICTION = ("coulomb", "breakaway", "viscous", "stribeck_speed")  # mean the same in every law that has them
NO_ROTOR = 1e-12  # kg.m2: something must turn at the input
UNUSED = {"speed", "temperature"}  # constants that a log is not fitted with
UNLIKE = 0.1  # relative: two inertias that differ by more are not one
EXACTLY = 1e-6  # relative: a number that a person gives is fitted as nearly as that
ANGLES = ("input_angle", "output_angle")


def fitted(file: Recognised, known: Known) -> tuple[Finding, Known]:
    """What a file tells, and what is known after it.

    Raises:
        ValueError: nothing can be found in it; says why
    """
    of_kind: dict[Kind, Callable[[Recognised, Known], tuple[Finding, Known]]] = {
        "friction": _friction,
        "torsion": _torsion,
        "encoders": _encoders,
        "log": _log,
        "presliding": presliding,
        "breakaway": breakaway,
    }
    if file.kind not in of_kind:
        raise ValueError(_without_motion(file))
    return of_kind[file.kind](file, known)


def _without_motion(file: Recognised) -> str:
    """What to do with a torque or a current that has no motion beside it."""
    do = "does it" if len(file.unused) == 1 else "do they"
    hint = f" (columns not used: {listed(file.unused)}: {do} hold texts?)" if file.unused else ""
    if {"angle", "speed", *ANGLES} & {*file.recording.names, *file.constants}:
        return f"torque without motion tells orders alone: strainwave orders finds them{hint}"
    return (
        "torque alone tells nothing of the gear: record an angle or a speed with it, or, if the shaft turned at one speed, "
        f"give that with --constant speed='100 1/min'{hint}"
    )


def _friction(file: Recognised, known: Known) -> tuple[Finding, Known]:
    table, uncertain = with_torque(file, known.gear_set)
    return friction_of(file, _unloaded(table, file, known.gear_set), uncertain, known)


def _unloaded(table: Recording, file: Recognised, gear_set: GearSet) -> Recording:
    """A table without the constant torque at the output that a person gave, and at the temperature that a person gave."""
    if load := file.constants.get("load_torque", 0.0):
        held = load if file.side == "output" else load / gear_set.gear.kinematics.ratio
        table = table.with_column("torque", table.values("torque", "N.m") - held, "N.m")
    if "temperature" in file.constants and "temperature" not in table:
        table = table.with_column("temperature", np.full(len(table), file.constants["temperature"]), "K")
    return table


def friction_of(file: Recognised, table: Recording, uncertain: float, known: Known) -> tuple[Finding, Known]:
    """What a table of friction tells.

    Args:
        file: that it came from
        table: speed and torque, and what else friction may depend on
        uncertain: standard deviation of the torque constant that its torques rest on, over its value [1]
        known: before it
    """
    ratio = abs(known.gear_set.gear.kinematics.ratio) if file.side == "output" else 1.0
    fast = too_fast(ratio * table.values("speed", "rad/s"))
    if fast and not known.accept:
        raise ValueError(f"{fast}; if they are right, --accept")
    side = "output" if file.side == "output" else known.side  # one that was only found is doubted if the set speaks against it
    found = twin(known.gear_set, friction=table, side=side, sources={"friction": file.path.name})
    finding = _of_twin(file, found, known.accept)
    told = tuple(_as_uncertain(each, uncertain) for each in finding.told)
    finding = replace(finding, told=told, remarks=(*finding.remarks, *of_levels(table)))
    if finding.refused or known.knows_better("friction_input", finding.told):
        return finding, known
    gear = known.gear_set.gear.replace(friction_input=found.gear_set.gear.friction_input)
    after = replace(_with_gear(known, gear, found, {"friction_input"}, finding), friction=table)
    return finding, after.judged("friction_input", finding.told)


def _as_uncertain(told: Told, relative: float, beside: float = 0.0) -> Told:
    """A number that rests on a torque constant: as uncertain as that, besides.

    Args:
        told: with the standard deviation by the measurement alone
        relative: standard deviation of the torque constant over its value [1]
        beside: what is taken off a number that grows with the constant, as the inertia of the motor, or what a motor whose
            voltage was measured induces
    """
    if not told.unit.startswith(("N.m", "kg.m2")):
        return told
    common = relative * (abs(told.value) + beside)
    return replace(told, sigma=float(np.hypot(told.sigma, common)), common=common)


def _torsion(file: Recognised, known: Known) -> tuple[Finding, Known]:
    at_input = "input_angle" in file.recording
    if clipped := clipped_loop(file.recording):
        raise ValueError(clipped)
    friction = known.friction if at_input else None
    found = twin(known.gear_set, friction=friction, torsion=file.recording, sources={"torsion": file.path.name})
    finding = _of_twin(file, found, known.accept)
    if finding.refused or known.knows_better("stiffness", finding.told):
        return finding, known
    # a loop at the input has friction inside, and what a table says wrong of it becomes hysteresis
    parts = {"stiffness"} if at_input and "hysteresis" in known.told else {"stiffness", "hysteresis"}
    gear = known.gear_set.gear.replace(**{part: getattr(found.gear_set.gear, part) for part in parts})
    return finding, _with_gear(known, gear, found, parts, finding).judged("stiffness", finding.told)


def _of_twin(file: Recognised, found: Twin, accept: bool) -> Finding:
    evidence = found.evidence[-1]
    exceeded = tuple(f"beyond what the maker allows: {check}" for check in found.ratings if check.exceeded)
    remarks = (*file.remarks, *evidence.remarks, *exceeded)
    curves = curves_of(evidence.fit)
    doubts = tuple(f"{doubt.what}. What to do: {doubt.remedy}" for doubt in evidence.doubts)
    if doubts and (evidence.unexplained or not accept):
        refused = "; ".join(doubts)
        return Finding(file.path.name, file, evidence.candidates[0][0], (), np.nan, remarks, refused=refused, curves=curves)
    own = {evidence.path(estimate) for estimate in evidence.fit.estimates}
    gear = found.gear_set.gear
    told = tuple(
        Told(v.path, v.unit, v.value, v.sigma, _law(v.path, gear), "" if v.state == "identified" else v.why)
        for v in found.verdicts
        if v.path in own
    )
    share = float(evidence.error[0] / np.std(evidence.fit.experiment.measured))
    return Finding(file.path.name, file, evidence.candidates[0][0], told, share, remarks, doubts, curves=curves)


def _with_gear(known: Known, gear: Any, found: Twin, parts: set[str], finding: Finding) -> Known:
    """The set with a gear of which some parts are those of a twin, with their sources."""
    names = tuple(f"gear.{part}." for part in parts)
    sources = {path: entry for path, entry in known.gear_set.sources.items() if not path.startswith(names)}
    sources |= {path: entry for path, entry in found.gear_set.sources.items() if path.startswith(names)}
    told_by = {path: file for path, file in known.told_by.items() if not path.startswith(names)}
    told_by |= {each.path: finding.name for each in finding.told if each.path.startswith(names) and not each.why}
    gear_set = replace(known.gear_set, gear=gear, sources=sources)
    return replace(known, gear_set=gear_set, told=known.told | parts, told_by=told_by)


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
    return known.with_parts({"kinematic_error": law}, sigmas, name)


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
        said: numbers of the drive that a person gave with the file, by path
    """

    log: MotionLog
    drive: Drive
    recording: Recording
    remarks: tuple[str, ...]
    in_current: bool
    said: Mapping[str, float]


def log_of(file: Recognised, known: Known) -> Taken:
    """A log along its motion, with the torque in the sense of the motion.

    Raises:
        ValueError: inertia, friction and gravity do not explain it
    """
    drive, remarks, in_current = _drive(file, known.gear_set)
    recording = _loaded(file)
    if not in_current and "current" in recording and "torque_constant" not in file.constants and known.gear_set.motor is None:
        remarks.append("the current is not used, as the torque constant is not known and a torque was measured")
        recording = recording.select([name for name in recording.names if name != "current"])
    log = MotionLog.of(recording, drive, regressors=file.regressors)
    if np.ptp(recording[log.effort]) == 0.0:
        raise ValueError(f"{log.effort} never changes: a set value, a limit, or a channel that was not recorded")
    before = regression(log, drive)
    if before.reversed:
        remarks.append(f"{log.effort} is counted against the motion: its sign is turned round")
        recording = recording.with_column(log.effort, -recording[log.effort], recording.unit(log.effort))
        log = MotionLog.of(recording, drive, regressors=file.regressors)
        before = regression(log, drive)
    if file.neighbours and not file.regressors:
        log, told = _with_neighbours(file, log, drive)
        before = regression(log, drive)
        remarks += told
    if not before.share > EXPLAINED or before.inertia <= 0.0:
        raise ValueError(
            f"inertia, friction and gravity explain {100.0 * max(before.share, 0.0):.0f} % of the variation of {log.effort}: "
            "the drive did more than one shaft does (give the torque of other joints as a column rigid_torque), or sides or "
            "units are not what they are taken for"
        )
    spoilt_rows = int(np.sum(spoilt(recording[log.effort])))
    if spoilt_rows:
        share = 100.0 * spoilt_rows / len(recording)
        remarks.append(f"outliers or clipped samples of {log.effort} are left out: {spoilt_rows}, {share:.2g} % of all")
    said = {"load.inertia": file.constants["load_inertia"]} if "load_inertia" in file.constants and not in_current else {}
    return Taken(log, drive, recording, tuple(remarks), in_current, said)


def _with_neighbours(file: Recognised, log: MotionLog, drive: Drive) -> tuple[MotionLog, list[str]]:
    """The log with the torque by other joints that move, and what to know of it."""
    found = coupled(
        log, drive, file.recording.time, {name: file.recording[at] for name, at in file.neighbours.items()}, file.joint
    )
    errors = f"error {100.0 * found.before:.2g} % of what varies without and {100.0 * found.after:.2g} % with them"
    which = f"joints {listed(found.joints)} move too: "
    if not found.terms:
        return log, [f"{which}no torque of them was found that other parts of the record show; if they load it, record longer"]
    own = "inertia is its mean over the record, gravity what goes with the angle of this joint alone"
    terms = f"{len(found.terms)} terms of them are fitted beside, {listed(found.terms)}"
    if found.combined:
        count = len(found.log.regressors) - len(log.regressors)
        terms = f"{count} combinations of all terms that they may add are fitted beside, the largest {listed(found.terms)}"
    return found.log, [f"{which}{terms}; {errors}; numbers are as sure as these terms: {own}"]


def _log(file: Recognised, known: Known) -> tuple[Finding, Known]:
    """What a log tells along its motion, and, where it warms up, of friction over the temperature."""
    warm, name = warmed(file), file.path.name
    try:
        finding, after = _along_motion(file, known)
    except ValueError as error:
        if warm is None:
            raise
        unused = f"not used along its motion: {error}"
        finding, after = Finding(name, file, "friction over the temperature", (), np.nan, (*file.remarks, unused)), known
        finding = replace(finding, curves=warm.curves)
    if warm is None:
        return finding, after
    after, said = warm.known(after, name)
    return replace(finding, told=(*finding.told, *warm.told), remarks=(*warm.remarks, *said, *finding.remarks)), after


def _along_motion(file: Recognised, known: Known) -> tuple[Finding, Known]:
    taken, before = log_of(file, known), known.gear_set.gear
    drive, recording, in_current, remarks = taken.drive, taken.recording, taken.in_current, list(taken.remarks)
    log = taken.log
    priors = {path: (value, EXACTLY * value) for path, value in taken.said.items()}
    best, *_ = fit_motion({file.path.name: log}, drive, priors=priors)
    rotor = rotor_sigma(file, known.gear_set) * drive.gear.kinematics.ratio**2 if not in_current else 0.0
    told = list(_of_motion(best, taken, TorqueConstant.of(file, known.gear_set), rotor))
    if not in_current:
        known = _with_friction(known, best, told, file.path.name)
    between = Between()
    if set(ANGLES) <= set(recording.names):
        errors = transmission_error(recording)
        between = _between(file, taken, best, errors, known, rotor)
        surer = {each.path for each in between.told}
        told = [each for each in (*told, *_orders(errors)) if each.path not in surer] + list(between.told)
        remarks += [*errors.remarks, *between.remarks]
        known = _with_error(between.known(known, file.path.name), errors, file.path.name)
    remarks += _shares(best.fit, file.regressors)
    every, curves = (*file.remarks, *remarks), curves_of(best.fit)
    law = best.fit.parts[0].model.gear.friction_input
    unlike = None if in_current else unlike_set(law, before.friction_input, log.motion.speed, log.effort)
    doubts = tuple(filter(None, (unlike, too_fast(log.motion.speed), _unlike_said(taken))))
    return (
        Finding(file.path.name, file, best.name, tuple(told), best.error, every, doubts, curves=curves, between=between.curves),
        known,
    )


def _shares(found: Fit, regressors: Sequence[str]) -> list[str]:
    """What of each regressor that a person gave acts."""
    shares = {each.path.removeprefix("share of "): each for each in found.estimates}
    said = [f"{name.partition(' ')[2]} {shares[name].value:.4g} ± {shares[name].sigma:.2g}" for name in regressors]
    return [f"shares of the regressors in the torque at the output: {listed(said)}"] if said else []


def _between(
    file: Recognised, taken: Taken, best: MotionCandidate, errors: TransmissionError, known: Known, rotor: float
) -> Between:
    """What both encoders tell of the gear between them."""
    constant = TorqueConstant.of(file, known.gear_set)
    rotor_known = not taken.in_current and _rotor(file, known.gear_set) is not None
    return between_encoders(
        taken.recording,
        taken.log,
        best,
        errors,
        known,
        rotor=rotor if rotor_known else np.inf,
        in_current=taken.in_current,
        relative=0.0 if constant is None else constant.relative,
    )


def _rotor(file: Recognised, gear_set: GearSet) -> float | None:
    """The inertia of the motor, as a person or the set tells it."""
    return file.constants.get("motor_inertia", getattr(gear_set.motor, "inertia", None))


def _with_friction(known: Known, best: MotionCandidate, told: Sequence[Told], name: str) -> Known:
    """The set with the friction that a log tells, of places of which no earlier file has told any."""
    gear = best.fit.parts[0].model.gear
    sigmas = {each.path: each.sigma for each in told}
    for part in ("friction_input", "friction_mesh"):
        law = getattr(gear, part)
        if part not in known.told and law != getattr(known.gear_set.gear, part):
            known = known.with_parts({part: law}, sigmas, name)
    return known


def _drive(file: Recognised, gear_set: GearSet) -> tuple[Drive, list[str], bool]:
    """The drive of a log, of the motor that the set or the person tells; remarks; and whether torques are in A."""
    constants, remarks, gear = file.constants, list[str](), gear_set.gear
    if unused := sorted(constants.keys() & UNUSED):
        remarks.append(f"given, but not used of a log: {listed(unused)}")
    given = gear_set.motor
    constant = constants.get("torque_constant", getattr(given, "torque_constant", None))
    inertia = _rotor(file, gear_set)
    if not {"current", "input_torque", "joint_torque"} & set(file.recording.names):
        by_voltage = _motor_by_voltage(file, given)
        share = 0.01 * by_voltage.torque_constant * by_voltage.back_emf / by_voltage.resistance
        remarks.append(
            "the voltage tells the torque, less what the motor induces: if its torque constant is 1 % larger, the viscous "
            f"friction is {share:.2g} N·m·s/rad smaller"
        )
        return Drive(gear=gear, motor=by_voltage, load=loads.Inertia(inertia=1.0)), remarks, False
    in_current = constant is None and not {"input_torque", "joint_torque"} & set(file.recording.names)
    if in_current:
        remarks.append("the torque constant is not known: torques are told in A; give --constant torque_constant=… for N.m")
        gear = gear.replace(input_inertia=0.0)
    elif inertia is None:
        remarks.append("the inertia of the motor is not known: that of the load has it inside, times the ratio squared")
    elif "motor_inertia" in constants:
        remarks.append(
            f"beside the motor's {inertia:.3g} kg·m² the set's {gear.input_inertia:.3g} kg·m² of the gear turn at the input; "
            "where the first has the gear inside, give it without"
        )
    motor_there = motor.CurrentSource(
        torque_constant=1.0 if constant is None else constant,
        inertia=NO_ROTOR if inertia is None or in_current else inertia,
        resistance=constants.get("resistance", getattr(given, "resistance", 0.0)),
    )
    return Drive(gear=gear, motor=motor_there, load=loads.Inertia(inertia=1.0)), remarks, in_current


def _motor_by_voltage(file: Recognised, given: Any) -> motor.DC:
    """The motor of a log that has its voltage alone; what the motor induces as it turns belongs to the voltage.

    Raises:
        ValueError: resistance or torque constant is neither said nor known of the set
    """
    known = {name: file.constants.get(name, getattr(given, name, 0.0)) for name in ("resistance", "torque_constant")}
    if missing := [name for name, value in known.items() if value == 0.0]:
        options = " and ".join(f"--constant {name}=…" for name in missing)
        raise ValueError(
            f"a voltage tells the torque of a motor that is known: give {options}; what a controller asks of an amplifier of "
            f"currents is a current, whatever its unit: {as_option('column', 'current', file.columns['voltage'])}"
        )
    induced = known["torque_constant"] if "torque_constant" in file.constants else getattr(given, "back_emf", 0.0)
    rotor = file.constants.get("motor_inertia", getattr(given, "inertia", NO_ROTOR))
    return motor.DC(**known, back_emf=induced or known["torque_constant"], inductance=0.0, inertia=rotor)


def _unlike_said(taken: Taken) -> str | None:
    """That the inertia that a person gave is not what the log shows; None where it is, or none was given."""
    if "load.inertia" not in taken.said:
        return None
    drive, shown = taken.drive, regression(taken.log, taken.drive).inertia
    given = drive.motor.inertia + drive.gear.input_inertia + taken.said["load.inertia"] / drive.gear.kinematics.ratio**2
    if abs(shown - given) <= UNLIKE * given:
        return None
    return (
        f"the log shows a total inertia of {shown:.3g} kg·m² at the input, but that of the load as it was given makes "
        f"{given:.3g} with motor and gear: see whether load_inertia, motor_inertia, ratio and torque constant are right"
    )


def _loaded(file: Recognised) -> Recording:
    """The recording, with a constant torque at the output that a person gave, beside what a model of the arm says."""
    if "load_torque" not in file.constants:
        return file.recording
    own = file.recording["rigid_torque"] if "rigid_torque" in file.recording else np.zeros(len(file.recording))
    return file.recording.with_column("rigid_torque", own + file.constants["load_torque"], "N.m")


def _of_motion(best: MotionCandidate, taken: Taken, constant: TorqueConstant | None, rotor: float) -> Iterator[Told]:
    """The numbers of a log; each as uncertain as the torque constant, besides, and inertia as that of the rotor [kg.m2]."""
    drive, in_current = taken.drive, taken.in_current
    rotating: Any = drive.motor
    by_constant = taken.log.effort in ("current", "voltage") and not in_current  # a torque that was measured needs none
    relative = constant.relative if constant is not None and by_constant else 0.0
    beside = {"load.inertia": (drive.motor.inertia + drive.gear.input_inertia) * drive.gear.kinematics.ratio**2}
    if taken.log.effort == "voltage":
        beside["gear.friction_input.viscous"] = rotating.torque_constant * rotating.back_emf / rotating.resistance
    encoder = "of input_angle" if "input_angle" in taken.recording else "of output_angle"  # from whose zero the phase counts
    nuisances = {nuisance.name for part in best.fit.parts for nuisance in part.experiment.nuisances}
    for estimate in best.fit.estimates:
        if estimate.path in nuisances or estimate.path in best.tied or estimate.path in taken.said:
            continue
        of_torque = estimate.unit.startswith(("N.m", "kg.m2"))
        law = "in A" if in_current and of_torque else encoder if estimate.path == "load.gravity_phase" else ""
        told = Told(estimate.path, estimate.unit, estimate.value, estimate.sigma, law)
        told = _as_uncertain(told, relative, beside.get(estimate.path, 0.0))
        if estimate.path == "load.inertia":
            told = replace(told, sigma=float(np.hypot(told.sigma, rotor)), common=float(np.hypot(told.common, rotor)))
        unit = told.unit.replace("N.m", "A").replace("kg.m2", "A.s2/rad") if in_current else told.unit
        yield replace(told, unit=unit, why=_untold(estimate, told.sigma, best))


def _untold(estimate: Estimate, sigma: float, best: MotionCandidate) -> str:
    """Why a log does not tell a number; empty where it does."""
    if estimate.path != "load.gravity_phase":
        return "its standard deviation exceeds half the value" if sigma > 0.5 * abs(estimate.value) else ""
    gravity = next(each for each in best.fit.estimates if each.path == "load.gravity_torque")
    return "there is no gravity that the log tells" if gravity.sigma > 0.5 * abs(gravity.value) or sigma > 0.5 else ""
