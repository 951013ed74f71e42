"""A log of a drive along its motion: friction, inertia, gravity; with both encoders also what lies between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.identification.candidates.motion import bands, fit_motion, prior_of_viscous
from strainwave.identification.candidates.motion_candidate import (
    SHARE_OF_UNKNOWN_ROTOR,
    MotionCandidate,
    confirmed,
    inertia_at_input,
    nuisances_of,
    other_laws,
    refit,
    slopes_by_rotor,
    spread_by_blocks,
    spread_by_models,
    with_rotor,
)
from strainwave.identification.candidates.motion_model import INPUT, LOSSES, is_one_wave, sliding
from strainwave.identification.candidates.plain import MAX_DELAY_SAMPLES, fit_plain, gravity_sigma, moving
from strainwave.identification.checks.logs import (
    CONSTANT_BY_VOLTAGE,
    INERTIA_IN_TWO_WAYS,
    RATIO_BY_ORDERS,
    RATIO_OF_ENCODERS,
    another_ratio_of_shafts,
    checks_of_motion,
    held_out_error,
    motions_of_both_shafts,
    ratio_of_encoders,
    speed_against_angle,
    speed_of_another_clock,
    torque_constant_by_voltage,
    unit_of_torque,
)
from strainwave.identification.checks.sizes import friction_of_log, input_speed
from strainwave.identification.checks.unexplained import OVER_OUTPUT, OVER_SPEED, OVER_TURN, Judged, judged_shape, largest_shape
from strainwave.identification.experiments.drive_log import ENCODERS
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.motion_log import SHARE_OF, MotionLog, per_torque, transmitted_torque, turnover_speed
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.fitting.influence import change_with
from strainwave.identification.kinds.between_encoders import between_encoders
from strainwave.identification.kinds.prepared_log import PreparedLog, log_of
from strainwave.identification.kinds.two_encoders import (
    orders_of,
    picture_of_turn,
    with_error,
)
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.file_result import (
    BEHIND_GEAR,
    BREAKAWAY_PATH,
    COULOMB_PATH,
    LOAD_INERTIA,
    MAX_SHARE_OF_PLAIN,
    MOTOR_INERTIA,
    Check,
    FileEstimate,
    FileResult,
    is_uncertain,
)
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.identifiability import (
    MAX_SIGMA_OF_PHASE,
    PriorOfSet,
    moved,
    priors_of,
    priors_of_undetermined,
)
from strainwave.identification.results.pictures import Picture
from strainwave.identification.results.steady_friction import STEADY_FRICTION, friction_at
from strainwave.messages import listed
from strainwave.orders.two_encoders import TransmissionError, transmission_error
from strainwave.parameters import plain
from strainwave.statistics.determined_sum import DeterminedSum
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

Array = NDArray[np.float64]
SLIDING_SPEED_FACTOR = 4.0  # of the speed at which friction turns its sign: beyond it the mean over both senses is within 0.1 %
MAX_OFF_INERTIA = 0.1  # relative difference of a given inertia from that of the log
FRICTION_PARTS = ("friction_input", "friction_mesh")  # parts of the gear
VISCOUS_PATH = f"{INPUT}viscous"
DRY_TORQUES = (COULOMB_PATH, BREAKAWAY_PATH)  # that a zero of the torque shifts
ONE_WAY = "the motion goes one way only: Coulomb friction and the zero of the torque are one number; record both directions"
DETENT_PATHS, DEPTH_PATHS = f"{INPUT}detent_", f"{INPUT}amplitude["  # numbers of waves over the angle
ONE_WAVE = "the motion goes nearly one way: a detent and friction over the angle are one wave; record both directions"
DEPTH_BY_SET = "it counts from Coulomb friction, whose split from viscous friction is that of the start set"
UNKNOWN_ROTOR = (
    "the inertia of the motor is not known, and with it the torque of the load, on which this loss rests: give "
    "--constant motor_inertia=NUMBER"
)
CHECKS_OF = {  # numbers of the drive by which estimates scale, and the checks of each
    "ratio": {RATIO_OF_ENCODERS, RATIO_BY_ORDERS},
    "torque constant": {CONSTANT_BY_VOLTAGE, INERTIA_IN_TWO_WAYS},
}
RELATIVE_SIGMA_OF_GIVEN = 1e-6  # of a number that a person gives, in the fit
SPEED_BINS = 16  # of each direction of motion, with as many samples each


def fit_along_motion(file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    """Return the estimates of a log along its motion, and between its encoders; and the gear with them."""
    prepared, name, start = log_of(file, known), file.path.name, known.initial.gear
    drive, recording, in_current = prepared.drive, prepared.recording, prepared.in_current
    models = _models(prepared)
    best, held_out, predicted = confirmed(models[0], models[1:], drive)
    others, log = [each for each in models if each.model is not best.model], best.log
    remarks = [*_other_joints(file, log), *_delay(best), *_other_laws(best, others, prepared)]
    apart = spread_by_models(best, others)
    judged, estimates = _judged(best, apart, prepared, known)
    if judged is not best:
        refitted, by_set = refit(judged)
        if refitted.error > MAX_SHARE_OF_PLAIN * held_out.error:  # the record contradicts the set: no prior
            judged, estimates = best, list(_of_motion(best, apart, prepared))
        else:
            held_out, predicted = replace(refitted, plain=held_out.plain), by_set
    checks = list(held_out_error(held_out, name, file.neighbours))
    between = FileResult(name)
    if set(ENCODERS) <= set(recording.names):
        errors = _errors(file, recording, abs(start.kinematics.ratio))
        between, known = between_encoders(prepared, judged, estimates, errors, known, name)
        if any(each.significant and each.shaft == "input" for each in errors.orders):
            between = replace(between, pictures=(*between.pictures, picture_of_turn(errors)))
        checks += [*ratio_of_encoders(errors.ratio, drive, name), *between.checks]
        rotor = next((each for each in between.estimates if each.path == MOTOR_INERTIA and not each.why), None)
        if rotor is not None and not in_current:
            squared = drive.gear.kinematics.ratio**2
            prepared = replace(prepared, drive=drive.replace({MOTOR_INERTIA: rotor.value}), rotor=rotor.sigma * squared)
            judged, estimates = _judged(with_rotor(best, rotor.value), apart, prepared, known)
        along = {each.path: each for each in estimates if not each.why}
        surer = {each.path: each for each in between.estimates if not (each.why and each.path in along)}
        estimates = [each for each in (*estimates, *orders_of(errors)) if each.path not in surer] + list(surer.values())
        remarks += [*errors.remarks, *between.remarks]
        known = with_error(known, errors, name)
    best, speed, ratio = judged, log.motion.speed, start.kinematics.ratio
    if not in_current and prepared.has_friction:
        known, estimates = _with_friction(known, best, estimates, name)
        checks += friction_of_log(
            sliding(best.fit.parts[0].model), start.friction_input, speed, log.effort, name, ratio=ratio,
            column=file.columns[log.effort], constant=file.constants.get("torque_constant", 0.0),
        )  # fmt: skip
    checks += [
        *unit_of_torque(file),
        *speed_against_angle(file),
        *motions_of_both_shafts(file, ratio),
        input_speed(speed, name),
        *_given_inertia(prepared, name),
    ]
    constant = float(getattr(prepared.drive.motor, "torque_constant", 0.0))
    if not in_current and constant > 0.0:
        at_rows = np.interp(recording.time, prepared.log.motion.time, prepared.log.motion.speed)
        checks += torque_constant_by_voltage(recording, at_rows, constant, name)
    checks += checks_of_motion(best, drive, recording, held_out, file)
    unchecked = _unchecked(prepared, file, estimates, {check.name for check in checks})
    shaped = _shape(best, estimates, name)
    remarks += [
        *_scales(unchecked, log.effort), *speed_of_another_clock(file), *another_ratio_of_shafts(file, ratio),
        *file.remarks, *prepared.remarks,
        *_shares(best.fit, file.regressors), *shaped.remarks,
    ]  # fmt: skip
    dry = [each for each in estimates if each.path == COULOMB_PATH and (not each.why or each.in_combination)]
    of_friction = [picture_of_friction(best.fit, "A" if in_current else "N.m")] if dry and prepared.has_friction else []
    result = FileResult(
        name, file, best.name, tuple(estimates), tuple(remarks), (*checks, *shaped.checks),
        pictures=(Picture(predicted), *of_friction, *between.pictures), held_out=held_out, fit=best.fit, bend=best.bend,
        between=between.between, unchecked=unchecked,
    )  # fmt: skip
    return result, known


def _shape(best: MotionCandidate, estimates: Sequence[FileEstimate], source: str) -> Judged:
    """Return the check of the shape of what a model leaves of a log over angles and speed, and a remark.

    A large shape fails if it moves a number by more than three standard deviations, of which it is no part here.
    """
    residual, abscissae, varies = _left_over(best)

    def biased(over: str) -> list[str]:
        shifts = _shifts_by_shape(best, over)
        written = {each.path: each.sigma for each in estimates if not each.why}
        others = {path: np.sqrt(max(sigma**2 - shifts.get(path, 0.0) ** 2, 0.0)) for path, sigma in written.items()}
        return [path for path, sigma in others.items() if abs(shifts.get(path, 0.0)) > SIGNIFICANCE_SIGMA * sigma]

    return judged_shape(residual, abscissae, varies, best.log.units[0], source, biased=biased)


def _left_over(best: MotionCandidate) -> tuple[Array, dict[str, Array], float]:
    """Return what a model leaves of a log where it slides, angles and speed by their names, and how the effort varies there.

    The model is fitted to the whole log: what it leaves of a stretch held out contains the error of its numbers, too.
    """
    log, rows = best.log, moving(best.log)
    rows &= np.abs(log.motion.speed) > SLIDING_SPEED_FACTOR * turnover_speed(log.motion.speed)
    residual = best.left(best.fit.parts[0].model, nuisances_of(best.fit))[rows]
    angle = log.motion.angle[rows]
    abscissae = {OVER_OUTPUT: angle / best.model.drive.gear.kinematics.ratio, OVER_SPEED: log.motion.speed[rows]}
    if np.ptp(angle) > 2.0 * np.pi:
        abscissae[OVER_TURN] = np.mod(angle, 2.0 * np.pi)
    return residual, abscissae, float(np.std(log.recorded[rows]))


def _shifts_by_shape(best: MotionCandidate, over: str) -> dict[str, float]:
    """Return how far the numbers of a fit move by a torque with a shape over an abscissa, as `_shifts_by`."""
    motion, ratio = best.log.motion, best.model.drive.gear.kinematics.ratio
    output, speed = motion.angle / ratio, motion.speed
    shapes = {
        OVER_OUTPUT: [output, np.sin(2.0 * output), np.cos(2.0 * output)],
        OVER_SPEED: [speed * np.abs(speed), np.sign(speed) * np.sqrt(np.abs(speed))],
        OVER_TURN: [wave(order * motion.angle) for order in (1.0, 2.0) for wave in (np.sin, np.cos)],
    }[over]
    return _shifts_by(best, shapes)


def _shifts_by_late_effort(best: MotionCandidate) -> dict[str, float]:
    """Return how far the numbers of a fit move by a delay that is too long to be fitted, as `_shifts_by`; empty without one."""
    return _shifts_by(best, [_change_per_sample(best)]) if _samples_late(best) != 0.0 else {}


def _samples_late(best: MotionCandidate) -> float:
    """Return how many samples the effort comes behind the motion, or ahead of it if negative, too many to be fitted; else 0."""
    if best.log.delayed:
        return 0.0
    _, shares = change_with(best.fit, best.log.motion.filtered(_change_per_sample(best)[np.newaxis]))
    late = -float(shares[0])
    return late if abs(late) > MAX_DELAY_SAMPLES - 0.5 else 0.0


def _change_per_sample(best: MotionCandidate) -> Array:
    """Return by how much the modelled effort changes from one sample to the next, on the grid of its motion, shape (m,)."""
    return np.gradient(best.log.whole(best.fit.parts[0].model, nuisances_of(best.fit)))


def _shifts_by(best: MotionCandidate, series: Sequence[Array]) -> dict[str, float]:
    """Return how far the numbers of a fit move if shares of further series of the effort are fitted too, by path.

    Args:
        best: the fit of a log
        series: on the grid of its motion, shape (m,) each
    """
    shifts, _ = change_with(best.fit, best.log.motion.filtered(np.stack(series)))
    return {plain(path): shift for path, shift in shifts.items()}


def _models(taken: PreparedLog) -> tuple[MotionCandidate, ...]:
    """Return the models of a log, without terms of other joints and with them; the best one first."""
    best, *others = _fitted(taken, taken.log)
    for log in taken.with_others:
        more, *rest = _fitted(taken, log)
        before, after = best.comparable_errors(more)
        takes_over = more.predicts_no_worse_than(best) and after < before
        best, others = (more, [best, *others, *rest]) if takes_over else (best, [*others, more, *rest])
    return best, *others


def _fitted(taken: PreparedLog, log: MotionLog) -> tuple[MotionCandidate, ...]:
    """Return the models of a log, best first."""
    priors = {path: (value, RELATIVE_SIGMA_OF_GIVEN * value) for path, value in taken.given.items()}
    logs = [log] if taken.in_current else bands(log, taken.drive)
    if LOAD_INERTIA in taken.given and not taken.motor_known:
        return fit_motion(logs, taken.drive.replace({LOAD_INERTIA: taken.given[LOAD_INERTIA]}), inertia=MOTOR_INERTIA)
    return fit_motion(logs, taken.drive, priors=priors)


def _other_joints(file: Recognised, log: MotionLog) -> Iterator[str]:
    """Yield the sentence about the terms of other joints that move."""
    names, terms = list(file.neighbours), list(log.regressors)
    if not names or file.regressors:
        return
    which = f"joint {names[0]} moves too: " if len(names) == 1 else f"joints {listed(names)} move too: "
    if not terms:
        yield f"{which}none of their terms makes the model predict better; if they load it, record longer"
        return
    own = "inertia is its mean over the record, gravity what goes with the angle of this joint alone"
    yield f"{which}{len(terms)} terms of them are fitted, {listed(terms)}; numbers are as sure as these terms: {own}"


def _delay(best: MotionCandidate) -> Iterator[str]:
    """Yield the sentence about a delay that was fitted, or that is too long to be fitted."""
    if (late := _samples_late(best)) != 0.0:
        samples, time, way = abs(late), 1e3 * abs(late) * best.log.motion.step, "behind" if late > 0.0 else "ahead of"
        yield (
            f"{best.log.effort} comes about {samples:.2g} samples, {time:.2g} ms, {way} the motion: it was filtered, or "
            "another clock stamped it. No such delay is fitted; what it moves is part of ±. Record it unfiltered"
        )
    for nuisance in best.fit.estimates:
        if nuisance.path == "delay":
            way = "behind" if nuisance.value > 0.0 else "ahead of"
            yield f"{best.log.effort} comes {1e3 * abs(nuisance.value):.3g} ± {1e3 * nuisance.sigma:.2g} ms {way} the motion"


def _errors(file: Recognised, recording: Recording, ratio: float) -> TransmissionError:
    """Return the transmission error; without orders of the input if the ratio of its motor angle was only assumed."""
    column, stated = file.columns.get("reflected_angle"), file.constants.get("ratio")
    assumed = column is not None and stated is None
    option = "--constant ratio=NUMBER"
    errors = transmission_error(recording, ratio=ratio if assumed else stated, ratio_option=option)
    if not assumed:
        return errors
    why = (
        f"the kinematic error is not determined: {column} was already divided by the ratio, and {ratio:.6g} is that of the "
        f"start set, which nothing checks; give {option} for its orders"
    )
    return replace(errors, orders=tuple(each for each in errors.orders if each.shaft == "output"), remarks=(why,))


def _unchecked(taken: PreparedLog, file: Recognised, estimates: Sequence[FileEstimate], checks: Set[str]) -> dict[str, str]:
    """Return ratio and torque constant, with their values, if estimates scale with them and no check of the log is theirs.

    An angle that was multiplied by the ratio does not check it.
    """
    effort = taken.log.effort
    if taken.in_current or effort == "voltage" or not taken.has_friction:
        return {}
    ratio = abs(taken.drive.gear.kinematics.ratio)
    values = {"ratio": f"{ratio:.6g}"}
    if effort == "current":
        values["torque constant"] = f"{float(getattr(taken.drive.motor, 'torque_constant', 0.0)):.4g} N·m/A"
    elif "ratio" not in file.constants:
        values["ratio"] += ", of the start set"
    if effort == "joint_torque":
        dry = next((each.value for each in estimates if each.path == COULOMB_PATH and not each.why), None)
        at_output = "" if dry is None else f"; Coulomb friction at the output is {dry * ratio:.4g} N·m with any ratio"
        values["ratio"] += f" (friction at the input scales with it{at_output})"
    elif effort == "input_torque":
        of_speed = "" if "input_angle" in file.columns else "viscous friction, "
        values["ratio"] += f" ({of_speed}inertia and gravity scale with it)"
    checks = checks - {RATIO_OF_ENCODERS} if "reflected_angle" in file.columns else checks
    return {name: value for name, value in values.items() if not checks & CHECKS_OF[name]}


def _scales(unchecked: Mapping[str, str], effort: str) -> Iterator[str]:
    """Yield the sentence about numbers of the drive that a log does not check."""
    if effort != "current":
        yield from (f"nothing checks the {name}, {value}" for name, value in unchecked.items())
        return
    names = [f"the {name}, {value}" for name, value in unchecked.items()]
    if len(names) == 2:
        yield f"one encoder checks neither {', nor '.join(names)}: friction, inertia and gravity scale with them"
    elif names:
        yield f"it does not check {names[0]}: friction, inertia and gravity scale with it"


def _other_laws(best: MotionCandidate, others: Sequence[MotionCandidate], taken: PreparedLog) -> Iterator[str]:
    """Yield a sentence for each law of friction that predicts as well: numbers of friction belong to their law."""
    for other in other_laws(best, others) if taken.has_friction else ():
        law, unit = other.model.law, "A" if taken.in_current else "N·m"
        yield (
            f"another law of friction, {type(law).__name__}, predicts as well, with a Coulomb torque of {law.coulomb:.3g} "
            f"{unit}: use the friction over the measured speeds, not the Coulomb torque alone"
        )


def _shares(found: Fit, regressors: Sequence[str]) -> list[str]:
    """Return the share of each given regressor."""
    shares = {each.path.removeprefix(SHARE_OF): each for each in found.estimates}
    each = [f"{name.partition(' ')[2]} {shares[name].value:.4g} ± {shares[name].sigma:.2g}" for name in regressors]
    return [f"shares of the regressors in the torque at the output: {listed(each)}"] if each else []


def _judged(
    best: MotionCandidate, apart: Mapping[str, float], taken: PreparedLog, known: GearSoFar
) -> tuple[MotionCandidate, list[FileEstimate]]:
    """Return a model and its estimates; what the log does not determine is that of the set before.

    Of a record at one speed the fit itself splits friction as the set does.
    """
    estimates = list(_of_motion(best, apart, taken))
    priors = {} if taken.in_current or best.model.one_speed else priors_of_undetermined(best.fit, estimates, known)
    if not priors:
        return best, estimates
    again = _with_priors(best, priors)
    return again, list(moved(estimates, again.fit, best.fit, priors))


def _with_priors(best: MotionCandidate, priors: Mapping[str, PriorOfSet]) -> MotionCandidate:
    return replace(best, priors={**best.priors, **{path: (each.value, each.weighted) for path, each in priors.items()}})


def _with_friction(
    known: GearSoFar, best: MotionCandidate, estimates: list[FileEstimate], name: str
) -> tuple[GearSoFar, list[FileEstimate]]:
    """Return the set with the friction of a log, whole, unless an earlier file determines it; and the estimates.

    A loss under load belongs to the friction without load that it was fitted with. If an earlier file determines that, the
    loss is fitted with the friction of that file as its prior.
    """
    gear, before = best.fit.parts[0].model.gear, known.gear_set.gear
    laws = [part for part in FRICTION_PARTS if getattr(gear, part) != getattr(before, part)]
    earlier = COULOMB_PATH in map(plain, known.determined_by)
    own = any(each.path == COULOMB_PATH and not each.why for each in estimates)
    if not laws:
        return known, estimates
    if not known.determined & set(FRICTION_PARTS) or (own and not earlier):
        return known.with_fit(gear, laws, estimates, name), estimates
    if "friction_mesh" in known.determined or not any(each.path == LOSSES[0] and not each.why for each in estimates):
        return known, estimates
    priors = {path: prior for path, prior in priors_of(best.fit, estimates, known).items() if path.startswith(INPUT)}
    again = _with_priors(best, priors).fit
    losses = {each.path: each for each in moved(estimates, again, best.fit, {}) if each.path in LOSSES}
    estimates = [losses.get(each.path, each) for each in estimates]
    return known.with_fit(again.parts[0].model.gear, ["friction_mesh"], estimates, name), estimates


def _given_inertia(taken: PreparedLog, name: str) -> Iterator[Check]:
    """Yield the check that a given inertia of the load agrees with the log."""
    if LOAD_INERTIA not in taken.given:
        return
    drive, shown = taken.drive, fit_plain(taken.log, taken.drive).inertia
    stated = drive.motor.inertia + drive.gear.input_inertia + taken.given[LOAD_INERTIA] / drive.gear.kinematics.ratio**2
    off = (abs(shown - stated) if taken.motor_known else max(stated - shown, 0.0)) / stated
    yield Check(
        "given inertia of the load", name, off, MAX_OFF_INERTIA, "1", off > MAX_OFF_INERTIA,
        f"the log shows a total inertia of {shown:.3g} kg·m² at the input, but that of the load as it was given makes "
        f"{stated:.3g} with motor and gear",
        "see whether load_inertia, motor_inertia, ratio and torque constant are right",
    )  # fmt: skip


def _of_motion(best: MotionCandidate, apart: Mapping[str, float], taken: PreparedLog) -> Iterator[FileEstimate]:
    """Yield the estimates of a log; each is as uncertain as the torque constant too, inertia and loss as that of the rotor.

    Args:
        best: the model
        apart: how far estimates lie apart in models that predict as well, by path
        taken: the log
    """
    drive, in_current = taken.drive, taken.in_current
    rotating: Any = drive.motor
    squared = drive.gear.kinematics.ratio**2
    independent = {  # parts of the torque that do not grow with the constant
        LOAD_INERTIA: (drive.motor.inertia + drive.gear.input_inertia) * squared,
        MOTOR_INERTIA: drive.gear.input_inertia + taken.given.get(LOAD_INERTIA, 0.0) / squared,
    }
    rotors = {LOAD_INERTIA: taken.rotor, MOTOR_INERTIA: taken.rotor / squared}
    induced = {}
    if taken.log.effort == "voltage":
        induced["gear.friction_input.viscous"] = rotating.torque_constant * rotating.back_emf / rotating.resistance
    encoder = "of input_angle" if "input_angle" in taken.recording else "of output_angle"  # from whose zero the phase counts
    nuisances = {nuisance.name for part in best.fit.parts for nuisance in part.experiment.nuisances}
    spread, by_rotor = spread_by_blocks(best), slopes_by_rotor(best)
    residual, abscissae, varies = _left_over(best)
    shape_over = largest_shape(residual, abscissae, varies)
    moved_by = [*([_shifts_by_shape(best, shape_over)] if shape_over else []), _shifts_by_late_effort(best)]
    unknown = 0.0 if taken.motor_known else SHARE_OF_UNKNOWN_ROTOR * inertia_at_input(best)
    gravity = 0.0, 0.0  # and its standard deviation; it comes before its phase
    for estimate in best.fit.estimates:
        if estimate.path in nuisances or estimate.path in best.model.ties or estimate.path in taken.given:
            continue
        path = plain(estimate.path)
        if best.model.one_speed and path in (COULOMB_PATH, VISCOUS_PATH):
            continue
        law = encoder if path == "load.gravity_phase" else ""
        turned = by_rotor.get(estimate.path, 0.0) if path.startswith("gear.") else 0.0
        own = (
            max(estimate.sigma, spread.get(path, 0.0)),
            apart.get(path, 0.0),
            turned * unknown,
            *(each.get(path, 0.0) for each in moved_by),
        )
        sigma = float(np.linalg.norm(own))
        if path == "load.gravity_torque" and not best.log.regressors:
            sigma = max(sigma, gravity_sigma(best.log, best.model.drive))
        gravity = (estimate.value, sigma) if path == "load.gravity_torque" else gravity
        number = FileEstimate(path, estimate.unit, estimate.value, sigma, law)
        offset = independent.get(path, 0.0)
        number = number.resting_on(taken.relative, offset + induced.get(path, 0.0))
        number = number.resting_on(taken.of_resistance, offset)
        number = number.sharing(rotors.get(path, abs(turned) * taken.rotor / squared))
        if not taken.has_friction and path.startswith("gear.friction_"):
            number = replace(number, why=BEHIND_GEAR)
        elif path in DRY_TORQUES and not best.log.both_ways:
            number = replace(number, sigma=np.inf, why=ONE_WAY)
        elif path.startswith(DETENT_PATHS) and is_one_wave(best.log):
            number = replace(number, why=_one_wave(number, best), in_combination=True)
        elif path.startswith(DEPTH_PATHS) and best.model.one_speed:
            share = prior_of_viscous(best.model.law, best.model.one_speed)[1] * best.model.one_speed / best.model.law.coulomb
            number = replace(number, sigma=float(np.hypot(sigma, share * number.value)), why=DEPTH_BY_SET, in_combination=True)
        elif is_uncertain(number.value, abs(turned) * unknown):
            number = replace(number, why=UNKNOWN_ROTOR)
        elif not number.is_phase:
            number = number.unless_uncertain()
        elif path != "load.gravity_phase":
            number = replace(number, why="its wave is too small" if sigma > MAX_SIGMA_OF_PHASE else "")
        elif is_uncertain(*gravity) or sigma > MAX_SIGMA_OF_PHASE:
            number = replace(number, why="the log determines no gravity")
        yield number.in_current() if in_current else number
    for each in _at_one_speed(best, spread, apart) if best.model.one_speed else ():
        number = each.resting_on(taken.relative)
        yield number.in_current() if in_current else number


def _one_wave(detent: FileEstimate, best: MotionCandidate) -> str:
    """Return what a log that goes nearly one way determines of a detent: its sum with friction over the angle."""
    if detent.is_phase:
        return ONE_WAVE
    amplitude = detent.path.replace("detent_torque", "amplitude")
    law = sliding(best.fit.parts[0].model)
    both = DeterminedSum((detent.path, amplitude), (1.0, float(law.coulomb)), detent.value, detent.sigma, "N.m")
    return f"{ONE_WAVE}; {both.with_others}"


def _at_one_speed(best: MotionCandidate, spread: Mapping[str, float], apart: Mapping[str, float]) -> Iterator[FileEstimate]:
    """Yield the friction at the one speed of a record, and Coulomb and viscous friction, with the spread of the start set.

    Args:
        best: the model
        spread, apart: standard deviations by blocks of the record, and by models that predict as well, by path
    """
    speed, law, fitted = best.model.one_speed, sliding(best.fit.parts[0].model), best.fit
    weights = np.array([{COULOMB_PATH: 1.0, VISCOUS_PATH: speed}.get(plain(each.path), 0.0) for each in fitted.estimates])
    acting = np.flatnonzero(weights)
    variance = float(weights[acting] @ fitted.covariance[np.ix_(acting, acting)] @ weights[acting])
    own = max(float(np.sqrt(max(variance, 0.0))), spread[STEADY_FRICTION])
    at_speed = friction_at(speed, float(law.coulomb + speed * law.viscous), float(np.hypot(own, apart[STEADY_FRICTION])))
    if not best.log.both_ways:
        at_speed = replace(at_speed, sigma=np.inf, why=ONE_WAY)
    yield at_speed
    both = DeterminedSum((COULOMB_PATH, VISCOUS_PATH), (1.0, speed), at_speed.value, at_speed.sigma, "N.m")
    why = at_speed.why or (
        f"determined together, at the one speed of the record: {both}; the split is that of the start set within its spread"
    )
    together, (_, split) = not at_speed.why, prior_of_viscous(law, speed)
    coulomb = float(np.hypot(at_speed.sigma, split * speed))
    yield FileEstimate(COULOMB_PATH, "N.m", float(law.coulomb), coulomb, "", why, in_combination=together)
    yield FileEstimate(VISCOUS_PATH, "N.m.s/rad", float(law.viscous), split, "", why, in_combination=together)


def picture_of_friction(fit: Fit, unit: str) -> Picture:
    """Return the picture of friction over the speed of a log along its motion, means of what is left added to its law.

    Args:
        fit: of the log
        unit: of the friction, N.m, or A if the torque constant is not known
    """
    part = fit.parts[0]
    log, drive = part.experiment, part.model
    assert isinstance(log, MotionLog)
    rows = log.motion.rows
    speed, left = log.motion.speed[rows], part.residuals[0] / per_torque(drive, log.effort)
    load = np.abs(transmitted_torque(log, drive)[rows]) / abs(drive.gear.kinematics.ratio)
    bins = [
        each
        for way in (-1.0, 1.0)
        for each in np.array_split(np.flatnonzero(way * speed > 0.0)[np.argsort(speed[way * speed > 0.0])], SPEED_BINS)
        if len(each)
    ]
    means = np.array([[float(np.mean(series[each])) for series in (speed, left, load)] for each in bins]).reshape(-1, 3).T
    table = FrictionTable(np.abs(means[0]), np.zeros(len(bins)), load=means[2])
    friction = np.sign(means[0]) * table.predict(drive.gear, [], np.zeros(0))[0][0]
    columns = {"speed": means[0], "friction": friction + means[1], "modelled": friction}
    units = {"speed": "rad/s", "friction": unit, "modelled": unit}
    return Picture(Recording(columns, units), "table", "friction, at the input", "friction over speed")
