"""Stiffness, hysteresis and damping of the gear between two encoders, from a log whose load is known by its motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, hysteresis, loads, stiffness, structure
from strainwave.files.recording import Recording
from strainwave.identification.candidates.elastic import DELAY, ElasticCandidate, fit_elastic
from strainwave.identification.candidates.motion_candidate import MotionCandidate, nuisances_of, spread_by_blocks
from strainwave.identification.candidates.plain import MAX_DELAY_SAMPLES
from strainwave.identification.checks.logs import inertias_of_load
from strainwave.identification.experiments.drive_log import DrivenLog
from strainwave.identification.experiments.motion import motion_of
from strainwave.identification.experiments.motion_log import MIN_INERTIA, MotionLog, inertia_of
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.kinds.prepared_log import RECORDER_BIAS, PreparedLog
from strainwave.identification.results.file_result import (
    GRAVITY_PATH,
    LOAD_INERTIA,
    MAX_RELATIVE_SIGMA,
    MOTOR_INERTIA,
    Check,
    FileEstimate,
    FileResult,
    is_uncertain,
)
from strainwave.identification.results.gear_so_far import ERROR_AMPLITUDE, GearSoFar, compared_path, is_of
from strainwave.identification.results.pictures import Picture
from strainwave.orders.two_encoders import TransmissionError
from strainwave.statistics.residuals import correlation_length

Array = NDArray[np.float64]

SIGNIFICANT_DELAY_SIGMA = 2.5  # standard deviations, beyond which a delay is there
MAX_RELATIVE_TO_INERTIA = 3.0  # standard deviation of gravity over that of the inertia: beyond, torques count from inertia
MAX_CORRELATION_LENGTH = 3.0  # samples, of noise (assumed)
TORQUE_PARTS = ("stiffness", "hysteresis", "damping")  # of the gear; torques in A do not determine them
MAY_BE_ABSENT = ("gear.hysteresis.", "gear.damping")  # parts that a gear need not have
DAMPING_RATIO_SIGMA = 2e-3  # of critical damping (assumed): noise of the input that passes its filter looks like damping
MIN_PART_SIGMA = 3.0  # standard deviations, beyond which such a part is there
ELEMENT_TORQUES, STIFFNESS_PATHS = "gear.hysteresis.breakaway", "gear.stiffness."
START_MOTOR = 1e-4  # kg.m2: initial inertia of a motor (assumed)


def between_encoders(
    taken: PreparedLog,
    best: MotionCandidate,
    along: Sequence[FileEstimate],
    errors: TransmissionError,
    known: GearSoFar,
    source: str,
) -> tuple[FileResult, GearSoFar]:
    """Return spring, hysteresis, damping and kinematic error by a log of both encoders, or why not; and the gear with them.

    Args:
        taken: the log
        best: the fit along its motion
        along: its estimates, of which one is the torque that those between the encoders count from
        errors: orders of the kinematic error, from which the fit starts
        known: before the log
        source: name of the log
    """
    drive, estimates = best.fit.parts[0].model, {each.path: each for each in along}
    try:
        _check(taken.log, drive, errors)
        scale = _scale(estimates, taken, drive)
        drive = drive.replace(gear=drive.gear.replace(stiffness=known.gear_set.gear.stiffness))
        turned = 0.0 if errors.ratio.used * drive.gear.kinematics.ratio > 0.0 else np.pi  # counted the other way round
        law = errors.law.replace(phase=[phase + turned for phase in errors.law.phase])
        elastic = fit_elastic(_sense(taken.recording, errors, drive), taken.log, drive, scale.path, law)
    except (ValueError, FloatingPointError) as error:
        return FileResult(source, remarks=(f"stiffness and hysteresis are not determined: {error}",)), known
    of_gear = tuple(_estimates(elastic, scale, known, taken.in_current))
    has_stiffness = any(each.path.startswith(STIFFNESS_PATHS) and not each.why for each in of_gear)
    result = FileResult(
        source, model=elastic.name, estimates=(*of_gear, *_motor(elastic, of_gear, taken, best, errors)),
        remarks=tuple(_remarks(elastic, scale, taken)),
        checks=tuple(_inertias(elastic, scale, estimates, taken, source)),
        pictures=(
            *([picture_of_twist(elastic.fit, "A" if taken.in_current else "N.m")] if has_stiffness else []),
            Picture(curves_of_shafts(elastic.fit), title="between the shafts", model=elastic.name),
        ),
        between=elastic.fit,
    )  # fmt: skip
    has_waves = any(
        each.path.startswith(ERROR_AMPLITUDE) and not is_uncertain(each.value, float(sigma))
        for each, sigma in zip(elastic.fit.estimates, elastic.sigmas, strict=True)
    )
    parts = [*(() if taken.in_current else TORQUE_PARTS), *(["kinematic_error"] if has_waves else [])]
    finer = {"hysteresis"} if _is_finer(elastic, of_gear, known) else set[str]()
    return result, _with_parts(known, elastic, [part for part in parts if part not in known.determined - finer], result)


def _is_finer(found: ElasticCandidate, estimates: Sequence[FileEstimate], known: GearSoFar) -> bool:
    """True if a log resolves more Maxwell elements than an earlier file, whose torques have the same sum."""
    before, law = known.gear_set.gear.hysteresis, found.drive.gear.hysteresis
    own = [each for each in estimates if each.path.startswith("gear.hysteresis.")]
    if (
        not isinstance(before, hysteresis.MaxwellSlip)
        or not isinstance(law, hysteresis.MaxwellSlip)
        or any(each.why for each in own)
    ):
        return False
    sigmas = [each.sigma for each in own if each.path.startswith(ELEMENT_TORQUES)]
    sigmas += [entry.uncertainty or 0.0 for path, entry in known.gear_set.sources.items() if path.startswith(ELEMENT_TORQUES)]
    apart = abs(float(np.sum(law.breakaway)) - float(np.sum(before.breakaway)))
    return len(law.breakaway) > len(before.breakaway) and apart < MIN_PART_SIGMA * float(np.linalg.norm(sigmas))


def _check(log: MotionLog, drive: Drive, errors: TransmissionError) -> None:
    """
    Raises:
        ValueError: the drive of the log is none that can be simulated along its motion as it was
    """
    if log.regressors:
        raise ValueError("other joints move, and the torque that they add is known by a regression only")
    if not isinstance(drive.gear.structure, structure.Lumped):
        raise ValueError("the gear of the initial set has stages, whose springs a log does not separate")
    used, ratio = abs(errors.ratio.used), abs(drive.gear.kinematics.ratio)
    if abs(used - ratio) > 1e-6 * ratio:
        raise ValueError(f"the angles have the ratio {used:.6g}, the initial set {ratio:.6g}; give --constant ratio={used:.6g}")


@dataclass(frozen=True)
class _Scale:
    """A torque that is known, from which those of the output stage count.

    Attributes:
        path: `load.gravity_torque` or `load.inertia`
        own: its standard deviation over its value, by the log [1]
        common: the part that other files share, of the torque constant and the rotor [1]
    """

    path: str
    own: float
    common: float

    @property
    def relative(self) -> float:
        """Its whole standard deviation over its value [1]."""
        return float(np.hypot(self.own, self.common))


def _scale(estimates: Mapping[str, FileEstimate], taken: PreparedLog, drive: Drive) -> _Scale:
    """Return what torques count from: gravity, which slow motion determines without the motor's inertia, or the load's inertia.

    An inertia of the load that a person gave is exact.
    The load's inertia is the total less the rotor's; a small one has a large uncertainty.

    Raises:
        ValueError: the log determines neither
    """
    if LOAD_INERTIA in taken.given:
        return _Scale(LOAD_INERTIA, 0.0, 0.0)
    gravity, inertia = (
        each if (each := estimates.get(path)) and each.value > 0.0 else None for path in (GRAVITY_PATH, LOAD_INERTIA)
    )
    by_gravity = [] if gravity is None else [_Scale(GRAVITY_PATH, gravity.own / gravity.value, taken.relative)]
    by_inertia = []
    if inertia is not None and taken.motor_known:
        rotor = float((drive.motor.inertia + drive.gear.input_inertia) * drive.gear.kinematics.ratio**2)
        common = float(np.hypot(taken.relative * (inertia.value + rotor), taken.rotor)) / inertia.value
        by_inertia = [_Scale(LOAD_INERTIA, inertia.own / inertia.value, common)]
    usable = [each for each in (*by_gravity, *by_inertia) if each.relative < MAX_RELATIVE_SIGMA]
    if not usable:
        missing = "is not known: give --constant motor_inertia=NUMBER"
        if taken.motor_known:
            missing = f"is not known well enough compared with that of the load: ± {taken.rotor:.2g} kg·m² at the output"
        raise ValueError(
            f"no torque at the output is known to count from: the log determines no gravity, and the inertia of the "
            f"motor {missing}"
        )
    return usable[0] if len(usable) == 1 or usable[0].relative < MAX_RELATIVE_TO_INERTIA * usable[1].relative else usable[1]


def _sense(recording: Recording, errors: TransmissionError, drive: Drive) -> Recording:
    """Return the recording with the output counted as the ratio of the drive has it."""
    if errors.ratio.used * drive.gear.kinematics.ratio > 0.0:
        return recording
    return recording.with_column("output_angle", -recording["output_angle"], recording.unit("output_angle"))


# ---- Estimates and remarks -------------------------------------------------------------------------------------------


def _estimates(found: ElasticCandidate, scale: _Scale, known: GearSoFar, in_current: bool) -> Iterator[FileEstimate]:
    """Yield the numbers of the gear, each as uncertain as the torque that all count from."""
    gear: Any = found.drive.gear
    law = known.gear_set.gear.stiffness
    nuisances = {each.name for each in found.fit.experiment.nuisances}
    for estimate, sigma in zip(found.fit.estimates, found.sigmas, strict=True):
        if estimate.path in nuisances or estimate.path.startswith(("gear.kinematic_error.phase", "load.gravity")):
            continue
        path = _path(estimate.path, found, law)
        if path == "gear.damping":
            stiff = gear.stiffness.tangent(0.0) * inertia_of(found.drive)
            sigma = np.hypot(sigma, 2.0 * DAMPING_RATIO_SIGMA * np.sqrt(stiff))
        own = FileEstimate(path, estimate.unit, estimate.value, float(sigma), _law_of(path, found))
        if own.is_of_torque:
            own = replace(own, sigma=float(np.hypot(sigma, scale.own * own.value))).resting_on(scale.common)
        own = own.unless_uncertain()
        if path.startswith(MAY_BE_ABSENT) and own.value < MIN_PART_SIGMA * own.sigma:
            own = replace(
                own, why=f"no larger than {MIN_PART_SIGMA:g} standard deviations: the record does not show that it is there"
            )
        yield own.in_current() if in_current else own


def _motor(
    found: ElasticCandidate,
    of_gear: Sequence[FileEstimate],
    taken: PreparedLog,
    best: MotionCandidate,
    errors: TransmissionError,
) -> Iterator[FileEstimate]:
    """Yield the inertia of a motor that is not known, if that of the load is: its torque less what moves the output.

    The output moves as its encoder measured it. That of a rigid gear lacks what the spring amplifies.
    """
    load = next((each for each in of_gear if each.path == LOAD_INERTIA and not each.why), None)
    if taken.motor_known or (load is None and LOAD_INERTIA not in taken.given):
        return
    drive, motion = best.fit.parts[0].model, best.log.motion
    carried: Any = found.drive.load
    ratio, input_inertia = drive.gear.kinematics.ratio, drive.gear.input_inertia
    recording = _sense(taken.recording, errors, drive)
    output = motion_of(recording.time, recording.values("output_angle", "rad"), taken.log.motion.cutoff)
    late = next((each.value for each in found.fit.estimates if each.path == DELAY), 0.0)
    torque = carried.inertia * np.interp(motion.time + late, output.time, output.acceleration)
    if isinstance(carried, loads.Pendulum):
        torque += carried.gravity_torque * np.sin(motion.output_angle(ratio) + carried.gravity_phase)
    model = replace(
        best.model, log=replace(best.log, extra=best.log.extra + torque),
        drive=drive.replace(load=loads.Inertia(inertia=MIN_INERTIA), motor=drive.motor.replace(inertia=START_MOTOR)),
        free=(MOTOR_INERTIA, *(path for path in best.model.free if not path.startswith(("load.", MOTOR_INERTIA)))),
    )  # fmt: skip
    candidate = replace(best, model=model, priors={})
    (own,) = (each for each in candidate.fit.estimates if each.path == MOTOR_INERTIA)
    of_load = 0.0 if load is None else load.own / ratio**2
    sigma = float(np.hypot(max(own.sigma, spread_by_blocks(candidate)[MOTOR_INERTIA]), of_load))
    estimate = FileEstimate(MOTOR_INERTIA, own.unit, own.value, sigma, "").resting_on(taken.relative, input_inertia)
    of_recorder = RECORDER_BIAS * (own.value + input_inertia) if taken.log.effort == "current" else 0.0
    estimate = estimate.sharing(float(np.hypot(taken.rotor / ratio**2, of_recorder))).unless_uncertain()
    yield estimate.in_current() if taken.in_current else estimate


def _path(path: str, found: ElasticCandidate, law: Any) -> str:
    """Return the path by which a number is compared with those of other files."""
    is_linear = isinstance(found.drive.gear.stiffness, stiffness.Linear)
    if path == "gear.stiffness.k" and is_linear and isinstance(law, stiffness.ThreeSegment) and found.reach < law.t1:
        return "gear.stiffness.k1"  # the first of three segments, of which the log has reached no other
    return compared_path(path, found.drive.gear)


def _law_of(path: str, found: ElasticCandidate) -> str:
    part, gear = path.removeprefix("gear.").partition(".")[0], found.drive.gear
    if part == "hysteresis":
        count = sum(each.path.startswith(ELEMENT_TORQUES) for each in found.fit.estimates)
        return f"of {count} element{'s' if count > 1 else ''}"  # elements of different sets have nothing in common
    if path == "gear.stiffness.k1":
        return "three_segment"
    return str(getattr(gear, part).name) if part in ("stiffness", "kinematic_error") else ""


def _inertias(
    found: ElasticCandidate, scale: _Scale, by_motor: Mapping[str, FileEstimate], taken: PreparedLog, source: str
) -> Iterator[Check]:
    """Yield the check of the inertia of the load by how it winds the gear up and by the torque of the motor.

    The first is taken: it needs neither the inertia of the motor nor a current that is a mean. If both count from gravity, a
    wrong torque constant changes both alike but for the rotor.
    """
    if scale.path != GRAVITY_PATH or LOAD_INERTIA not in by_motor or not taken.motor_known:
        return
    places = {each.path: place for place, each in enumerate(found.fit.estimates)}
    own, sigma = found.fit.estimates[places[LOAD_INERTIA]].value, float(found.sigmas[places[LOAD_INERTIA]])
    drive, rigid = taken.drive, by_motor[LOAD_INERTIA]
    rotor = float((drive.motor.inertia + drive.gear.input_inertia) * drive.gear.kinematics.ratio**2)
    of_torque = [rigid.own, taken.rotor, taken.relative * rotor]
    by_torque = rigid.value, float(np.linalg.norm(of_torque))
    unit = "A·s²/rad" if taken.in_current else "kg·m²"
    yield inertias_of_load((own, float(np.hypot(sigma, scale.own * own))), by_torque, unit, source)


def _remarks(found: ElasticCandidate, scale: _Scale, taken: PreparedLog) -> Iterator[str]:
    estimates = {each.path: (each, float(sigma)) for each, sigma in zip(found.fit.estimates, found.sigmas, strict=True)}
    torque = "A" if taken.in_current else "N·m"
    of = "gravity" if scale.path == GRAVITY_PATH else "inertia of the load"
    yield (
        f"between the encoders: {found.name}; {found.error:.2g} rad of {found.twist:.2g} rad are left on held-out data. "
        f"The gear transmits up to {found.reach:.3g} {torque}: what it does beyond is not determined. Torques count from "
        f"the {of}"
    )
    together = correlation_length(found.fit.residuals[0])
    if together > MAX_CORRELATION_LENGTH:
        yield (
            f"the residual between the encoders is correlated over {together:.0f} samples: the gear or its load has something "
            "that the model lacks, and its numbers may be off by more than their uncertainty"
        )
    if DELAY not in estimates:
        yield (
            f"a delay of output_angle of more than {MAX_DELAY_SAMPLES:g} samples would fit best: no clock is as late as "
            "that, and none is fitted"
        )
        return
    delay, sigma = estimates[DELAY]
    if abs(delay.value) > SIGNIFICANT_DELAY_SIGMA * sigma:
        yield (
            f"output_angle comes {1e3 * delay.value:.3g} ± {1e3 * sigma:.1g} ms behind input_angle; viscous friction at the "
            "output would look alike"
        )


# ---- The gear with them ----------------------------------------------------------------------------------------------


def _with_parts(known: GearSoFar, found: ElasticCandidate, parts: Sequence[str], result: FileResult) -> GearSoFar:
    """Return the gear with parts of what was found."""
    gear = found.drive.gear
    if "stiffness" in parts:
        gear = gear.replace(stiffness=_spring(gear.stiffness, known.gear_set.gear.stiffness, found.reach))
    of_error = (
        FileEstimate(each.path, each.unit, each.value, float(sigma), "")
        for each, sigma in zip(found.fit.estimates, found.sigmas, strict=True)
        if is_of(each.path, {"kinematic_error"})
    )
    return known.with_fit(gear, parts, (*result.estimates, *of_error), result.name)


def _spring(found: Any, before: Any, reach: float) -> Any:
    """Return the spring that was found, with what lies beyond the torque of the log as it was before."""
    if not isinstance(before, stiffness.ThreeSegment):
        return found
    if isinstance(found, stiffness.Linear) and reach < before.t1:
        return before.replace(k1=found.k)
    if isinstance(found, stiffness.ThreeSegment) and found.t2 > reach:
        return found.replace(k3=before.k3, t2=max(before.t2, reach))
    return found


def picture_of_twist(fit: Fit, unit: str) -> Picture:
    """Return the picture of the twist between both encoders of a log over the torque that the gear transmits.

    Args:
        fit: of the log
        unit: of the torque, N.m, or A if the torque constant is not known
    """
    part = fit.parts[0]
    log, gear = part.experiment, part.model.gear
    assert isinstance(log, DrivenLog)
    turned = log.angle / gear.kinematics.ratio - gear.kinematic_error.error(log.angle)
    measured, modelled = turned - log.measured[0], turned - part.predicted[0]
    columns = {
        "torque": log.gear_torque(part.model, nuisances_of(fit)),
        "twist": measured - modelled.mean(),
        "modelled": modelled - modelled.mean(),
    }
    units = {"torque": unit, "twist": "rad", "modelled": "rad"}
    return Picture(Recording(columns, units), "loop", "twist, at the output", "twist over torque")


def curves_of_shafts(fit: Fit) -> Recording:
    """Return the angle between the shafts in a log and its prediction along the motion of the input.

    Returns:
        time; `transmission_error`, input over ratio less output, from a mean of zero; and `modelled`
    """
    part = fit.parts[0]
    log: Any = part.experiment
    turned = log.angle / part.model.gear.kinematics.ratio
    error, modelled = turned - log.measured[0], turned - part.predicted[0]
    columns = {"time": log.time, "transmission_error": error - error.mean(), "modelled": modelled - error.mean()}
    return Recording(columns, dict.fromkeys(columns, "rad") | {"time": "s"})
