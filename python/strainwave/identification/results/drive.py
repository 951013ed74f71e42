"""The drive that files determine: their gear with the load and motor of a log, their covariance, and its errors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, loads, motor
from strainwave.files.described import own_paths
from strainwave.files.entries import OPPOSITE_SENSE, Entry
from strainwave.files.gear_set import GearSet
from strainwave.files.identified_tables import MAX_NUMBERS, Covariance, Validation
from strainwave.identification.candidates.motion_candidate import nuisances_of
from strainwave.identification.candidates.motion_model import bristled
from strainwave.identification.candidates.plain import frictionless, from_motion_to_motion
from strainwave.identification.experiments.motion_log import MIN_INERTIA, SHARE_OF, MotionLog
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.results.combined_parameter import CombinedParameter, distance, drive_of
from strainwave.identification.results.file_result import (
    BEHIND_GEAR,
    COULOMB_PATH,
    IN_CURRENT,
    LOAD_INERTIA,
    MOTOR_INERTIA,
    FileEstimate,
    FileResult,
)
from strainwave.identification.results.gear_so_far import is_of, source_of
from strainwave.identification.results.measured_range import measured_range
from strainwave.messages import listed, one_line
from strainwave.parameters import gear_numbers, plain

Array = NDArray[np.float64]

MIN_LOAD_DIFFERENCE = 3.0  # standard deviations: two logs that differ by more carry different loads
MIN_LOAD_SHARE = 1e-3  # of the inertia of the rotor at the output [1]: a load with less changes no torque measurably
PARTS_OF_TORQUE = {
    "load.": "load", "gear.friction_": "friction", "gear.stiffness.": "stiffness", "gear.hysteresis.": "hysteresis",
    "gear.damping": "damping",
}  # fmt: skip


def drive_set(
    start: GearSet, gear_set: GearSet, files: Sequence[FileResult], parameters: Sequence[CombinedParameter], name: str
) -> GearSet:
    """Return the set of an identified gear under a name of its own, with load and motor of the log that determines them best.

    Args:
        start: the set that the identification started from
        gear_set: with the numbers that files determine
        files: results of the files that count: those without a failed check, or all if these were accepted
        parameters: that files determine
        name: of the gear
    """
    logs = [each for each in files if _has_load(each)]
    best = min(logs, key=_load_sigma, default=None)
    whole = replace(
        gear_set, name=name, maker="", note=_note(start, files, logs, best), covariance=None,
        validation=(),
    )  # fmt: skip
    if best is not None:
        whole = _with_bristles(_with_motor(_with_load(whole, best), best, parameters), files)
    elif whole.load is None and (
        steady := [each for each in files if each.part_of and each.recognised is not None and each.recognised.kind == "log"]
    ):  # logs that are points of a table of friction
        whole = _with_motor(_with_steady_load(whole, steady[0], parameters), steady[0], parameters)
    unchanged = {path for path, entry in start.sources.items() if whole.sources.get(path) == entry}
    before = None if start.covariance is None else start.covariance.among(unchanged)
    ordered = sorted(files, key=lambda each: each is not best)
    return replace(
        whole, covariance=_covariance(whole, parameters, files, before), validation=tuple(_validation(whole, ordered, best))
    )


def name_of_files(files: Sequence[FileResult]) -> str:
    """Return a name for the gear of some files, as `gear of joint_5`."""
    first = next((each for each in files if each.estimates), files[0])
    stem = one_line(Path(first.name).stem)
    joint = first.recognised.joint if first.recognised is not None else ""
    of = f"joint {joint} of {stem}" if joint and joint not in stem else stem
    others = sum(not each.what for each in files) - 1  # without results of several files together
    return f"gear of {of}" + (f" and {others} more" if others > 0 else "")


def _note(start: GearSet, files: Sequence[FileResult], logs: Sequence[FileResult], best: FileResult | None) -> str:
    """Return from which files and which set a gear comes, and whose load it carries."""
    maker = f" of {start.maker}" if start.maker else ""
    read = ", ".join(one_line(each.name) for each in files) or "no file"
    notes = [
        f"Identified from {read}, starting from {start.name}{maker}: numbers that "
        "no file determines, and ratings, are of that set."
    ]
    if best is not None and (others := [each for each in logs if each is not best and _differs(best, each)]):
        carried = (f"{each.name} ({_load_in_words(each)})" for each in others)
        notes.append(f"Its load is that of {best.name}; other logs carry other loads: {', '.join(carried)}.")
    if lacking := not_written(files):
        notes.append(f"{lacking[0].upper()}{lacking[1:]}.")
    return " ".join(notes)


def not_written(files: Sequence[FileResult]) -> str:
    """Return the parts that files determine only in A, so that the gear lacks them, and why; empty if there are none."""
    determined = [each for file in files for each in file.estimates if each.is_of_torque and not each.why]
    in_current = [each.path for file in files for each in file.estimates if each.law == IN_CURRENT and not each.why]
    parts = [
        name for start, name in PARTS_OF_TORQUE.items()
        if any(path.startswith(start) for path in in_current)
        and not any(each.path.startswith(start) for each in determined)
        and not (name == "load" and any(map(_has_load, files)))
    ]  # fmt: skip
    if not parts:
        return ""
    kept = [part for part in parts if part != "load"]
    without = f"keeps {listed(kept)} of the start set" if kept else "has no load"
    return (
        f"{listed(parts)} measured in A, as the torque constant is not known: give --constant torque_constant=NUMBER, or the "
        f"gear {without}"
    )


# ---- Load and motor --------------------------------------------------------------------------------------------------


def _loads_of(result: FileResult) -> dict[str, FileEstimate]:
    return {each.path: each for each in result.estimates if each.path.startswith("load.")}


def _has_load(result: FileResult) -> bool:
    """True for a log whose torque is known: what it shows of its load, be it nothing that counts, is the load of the gear."""
    return drive_of(result) is not None and not result.is_in_current


def _load_sigma(result: FileResult) -> float:
    """Return the smallest relative standard deviation of the inertia of a load, or of its gravity without one [1]."""
    own = {path: each for path, each in _loads_of(result).items() if not each.why and not each.is_phase}
    number = own.get("load.inertia") or next(iter(own.values()), None)
    return np.inf if number is None else number.sigma / max(abs(number.value), 1e-300)


def _differs(one: FileResult, other: FileResult) -> bool:
    """True if two logs carry different loads."""
    first, second = _loads_of(one), _loads_of(other)
    shared = [path for path in first.keys() & second.keys() if first[path].law == second[path].law]
    return any(distance(first[path], second[path]) > MIN_LOAD_DIFFERENCE for path in shared)


def _load_in_words(result: FileResult) -> str:
    numbers = [each for each in _loads_of(result).values() if not each.why and not each.is_phase]
    return ", ".join(f"{each.path.removeprefix('load.').replace('_', ' ')} {each.value:.4g} {each.unit}" for each in numbers)


def _with_load(whole: GearSet, log: FileResult) -> GearSet:
    """Return the set with the load of a log; numbers that the log does not determine state so."""
    drive, own = drive_of(log), _loads_of(log)
    assert drive is not None
    constants = {} if log.recognised is None else log.recognised.constants
    load: Any = drive.load
    sources = {}
    for path in own_paths("load", load):
        name = path.removeprefix("load.")
        estimate, before = own.get(path), getattr(whole.load, name, None)
        if path == LOAD_INERTIA and "load_inertia" in constants:
            sources[path] = Entry(f"given with {log.name}")
        elif estimate is not None and (estimate.state != "not identified" or before is None):
            sources[path] = source_of(estimate, log.name)
            load = load.replace(inertia=estimate.value) if path == LOAD_INERTIA and estimate.value > 0.0 else load
        elif before is not None:
            load = load.replace(**{name: before})
            stated = whole.sources.get(path, Entry("not given"))
            sources[path] = replace(stated, source=f"assumed: that of the start set, as {log.name} does not determine it")
        else:
            sources[path] = Entry(f"assumed: {log.name} does not determine it")
    rotor = (drive.motor.inertia + drive.gear.input_inertia) * drive.gear.kinematics.ratio**2  # as the output has it
    least = MIN_LOAD_SHARE * float(rotor)
    if hasattr(load, "inertia") and load.inertia < least:  # with less, no step of a simulation would be short enough
        load = load.replace(inertia=least)
        sources[LOAD_INERTIA] = Entry(f"assumed: {100.0 * MIN_LOAD_SHARE:g} % of the rotor's; {log.name} shows none")
    return _with_part(whole, "load", load, sources)


def _with_steady_load(whole: GearSet, log: FileResult, parameters: Sequence[CombinedParameter]) -> GearSet:
    """Return the set with the load of logs at constant speed: their gravity, and an inertia that changes nothing there."""
    assert log.recognised is not None
    constants = log.recognised.constants
    shown = {each.estimate.path: each for each in parameters if each.estimate.path.startswith("load.gravity")}
    rotor = (whole.gear.input_inertia + constants.get("motor_inertia", 0.0)) * whole.gear.kinematics.ratio**2
    inertia = constants.get("load_inertia", max(MIN_LOAD_SHARE * rotor, MIN_INERTIA))
    gravity = {path.removeprefix("load."): each.estimate.value for path, each in shown.items()}
    load: Any = loads.Pendulum(inertia=inertia, **gravity) if gravity else loads.Inertia(inertia=inertia)
    why = f"given with {log.name}" if "load_inertia" in constants else f"assumed: {log.name}, at constant speed, shows none"
    sources = {LOAD_INERTIA: Entry(why), **{path: source_of(each.estimate, each.source) for path, each in shown.items()}}
    return _with_part(whole, "load", load, sources)


def _with_motor(whole: GearSet, log: FileResult, parameters: Sequence[CombinedParameter]) -> GearSet:
    """Return the set with the motor of a log; the source of its constant states if the log counts the other way."""
    with_motor = _with_motor_of(whole, log, parameters)
    path = "motor.torque_constant" if "motor.torque_constant" in with_motor.sources else MOTOR_INERTIA
    entry, turned = with_motor.sources[path], next((each for each in log.remarks if OPPOSITE_SENSE in each), "")
    if not turned or OPPOSITE_SENSE in entry.source:
        return with_motor
    stated = replace(entry, source=f"{entry.source}; in {one_line(log.name)} {turned}")
    return with_motor.replace(sources={**with_motor.sources, path: stated})


def _with_motor_of(whole: GearSet, log: FileResult, parameters: Sequence[CombinedParameter]) -> GearSet:
    """Return the set with the motor of a log: with its torque constant if that is known, else one that gives a torque."""
    constants = {} if log.recognised is None else log.recognised.constants
    if whole.motor is not None:
        names = {field["name"] for field in whole.motor.fields}
        numbers = {"torque_constant": "torque_constant", "resistance": "resistance", "inertia": "motor_inertia"}
        changed = {name: constants[key] for name, key in numbers.items() if key in constants and name in names}
        sources = {path: entry for path, entry in whole.sources.items() if path.startswith("motor.")}
        sources |= {f"motor.{name}": Entry(f"given with {log.name}") for name in changed}
        return _with_part(whole, "motor", whole.motor.replace(**changed), sources)
    inertia, source = _motor_inertia(whole, log, parameters)
    fitted: Any = motor.TorqueSource()
    if "torque_constant" in constants:
        of_fit = drive_of(log)
        fitted = motor.CurrentSource(torque_constant=constants["torque_constant"]) if of_fit is None else of_fit.motor
    saved = fitted.replace(inertia=inertia)
    sources = {path: Entry(f"assumed: none; {log.name} does not determine it") for path in own_paths("motor", saved)}
    sources |= {
        f"motor.{name}": Entry(f"given with {log.name}") for name in ("torque_constant", "resistance") if name in constants
    }
    if "motor.back_emf" in sources and "torque_constant" in constants:
        sources["motor.back_emf"] = Entry(f"torque constant given with {log.name}")
    sources[MOTOR_INERTIA] = source
    return _with_part(whole, "motor", saved, {path: sources[path] for path in own_paths("motor", saved)})


def _motor_inertia(whole: GearSet, log: FileResult, parameters: Sequence[CombinedParameter]) -> tuple[float, Entry]:
    """Return the inertia of a motor that the set lacks, with its source: given, else of all files, else of the log alone."""
    if log.recognised is not None and "motor_inertia" in log.recognised.constants:
        return log.recognised.constants["motor_inertia"], Entry(f"given with {log.name}")
    least = 0.0 if whole.gear.input_inertia > 0.0 else MIN_INERTIA
    combined = [(each.estimate, each.taken_from) for each in parameters if each.estimate.label == MOTOR_INERTIA]
    for estimate, name in (*combined, *((each, log.name) for each in log.estimates if each.label == MOTOR_INERTIA)):
        if estimate.state != "not identified":
            return max(estimate.value, least), source_of(estimate, name)
    return least, Entry("assumed: not known; the inertia of the load has it inside, times the ratio squared")


def _with_bristles(whole: GearSet, files: Sequence[FileResult]) -> GearSet:
    """Return the set with bristles that bend at reversals, if its friction is that of a log which shows how they bend."""
    source = next((entry.source for path, entry in whole.sources.items() if plain(path) == COULOMB_PATH), "")
    is_of_log = source.startswith("identified from")
    log = next((each for each in files if is_of_log and each.bend > 0.0 and each.name in source), None)
    if log is None:
        return whole
    before: Any = whole.gear.friction_input
    law = bristled(Drive(gear=whole.gear), log.bend).gear.friction_input
    if law is before:
        return whole
    fitted = Entry(f"fitted to reversals of {log.name}; a presliding loop determines it")
    unused = Entry("assumed: friction does not fall at low speed")
    gear = whole.gear.replace(friction_input=law)
    sources = {path: whole.sources.get(path, unused) for path in gear_numbers(gear) if is_of(path, {"friction_input"})}
    of_bristle = {
        "gear.friction_input.bristle_stiffness": fitted,
        "gear.friction_input.bristle_damping": Entry("assumed: none, as sliding damps as well"),
        "gear.friction_input.damping_fading": Entry("assumed: none"),
    }
    sources |= {path: of_bristle[plain(path)] for path in sources if plain(path) in of_bristle}
    kept = {path: entry for path, entry in whole.sources.items() if not is_of(path, {"friction_input"})}
    return replace(whole, gear=gear, sources=kept | sources)


def _with_part(whole: GearSet, part: str, model: Any, sources: Mapping[str, Entry]) -> GearSet:
    kept = {path: entry for path, entry in whole.sources.items() if not path.startswith(f"{part}.")}
    changes: dict[str, Any] = {part: model, "sources": {**kept, **sources}}
    return whole.replace(**changes)


# ---- Covariance and errors -------------------------------------------------------------------------------------------


def _covariance(
    whole: GearSet, parameters: Sequence[CombinedParameter], files: Sequence[FileResult], before: Covariance | None
) -> Covariance | None:
    """Return the covariance of the identified numbers of a set, with that of numbers kept from before.

    Estimates of one file correlate as its fit has it; what files share, as the torque constant, correlates all of them.
    """
    paths, estimates, sources = list[str](), list[FileEstimate](), list[str]()
    for path, each in _identified(whole, parameters):
        if each.estimate.sigma > 0.0 and len(paths) < MAX_NUMBERS:
            paths.append(path)
            estimates.append(each.estimate)
            sources.append(each.source)
    kept = {} if before is None else {path: place for place, path in enumerate(before.paths) if path not in paths}
    if not paths and not kept:
        return None
    own = np.array([each.own for each in estimates])
    common = np.array(  # with the sign of a torque: all torques grow with the constant
        [np.copysign(each.common, each.value) if each.is_of_torque else each.common for each in estimates]
    )
    n, every = len(paths), min(len(paths) + len(kept), MAX_NUMBERS)
    matrix = np.zeros((every, every))
    if n:
        matrix[:n, :n] = np.outer(own, own) * _correlation(estimates, sources, files) + np.outer(common, common)
    if before is not None and kept:
        places = list(kept.values())[: every - n]
        matrix[n:, n:] = before.array[np.ix_(places, places)]
    return Covariance.of([*paths, *list(kept)[: every - n]], matrix)


def _identified(whole: GearSet, parameters: Sequence[CombinedParameter]) -> Iterator[tuple[str, CombinedParameter]]:
    """Yield the path of each number of a set that was identified, with the parameter that determines it."""
    for path, entry in whole.sources.items():
        if not entry.source.startswith("identified") or entry.uncertainty is None:
            continue
        own = [each for each in parameters if each.estimate.path in (path, plain(path)) and each.estimate.law != IN_CURRENT]
        of_file = [each for each in own if each.source in entry.source]
        if own:
            yield path, (of_file or own)[0]


def _correlation(estimates: Sequence[FileEstimate], sources: Sequence[str], files: Sequence[FileResult]) -> Array:
    """Return the correlation of estimates by the fits of their files, shape (n, n); 0 between fits."""
    correlation = np.eye(len(estimates))
    for file in files:
        for fit in file.fits:
            own, at = list[int](), list[int]()
            for k, (estimate, source) in enumerate(zip(estimates, sources, strict=True)):
                if source == file.name and (place := _place(estimate, fit)) is not None:
                    own.append(k)
                    at.append(place)
            block = fit.correlation[np.ix_(at, at)]
            if own and np.isfinite(block).all():
                correlation[np.ix_(own, own)] = block
    return correlation


def _place(estimate: FileEstimate, fit: Fit) -> int | None:
    """Return the place of an estimate in the fit that determined it, where its path may be another; None if another one did."""
    prefix = "" if isinstance(fit.model, Drive) else "gear."
    paths = [prefix + each.path for each in fit.estimates]
    part = estimate.path.split(".")[:2]
    same = [k for k, each in enumerate(fit.estimates) if each.value == estimate.value and paths[k].split(".")[:2] == part]
    return min(same, key=lambda k: paths[k] != estimate.path, default=None)


def _saved(drive: Drive, whole: GearSet) -> Drive:
    """Return the drive of a log as saved; without inertias that its torque does not contain, as `predict` has it."""
    motor_there: Any = drive.motor
    gear = whole.gear.replace(input_inertia=drive.gear.input_inertia)
    is_of_motor = gear.input_inertia == whole.gear.input_inertia
    inertia = float(getattr(whole.motor, "inertia", motor_there.inertia)) if is_of_motor else motor_there.inertia
    return drive.replace(gear=gear, load=whole.load, motor=motor_there.replace(inertia=inertia))


def _validation(whole: GearSet, files: Sequence[FileResult], best: FileResult | None) -> Iterator[Validation]:
    """Yield the errors of the saved model on the files that it was identified from; its load is that of the best log."""
    for each in files:
        held_out, drive = each.held_out, drive_of(each)
        if (
            held_out is None
            or each.recognised is None
            or each.is_in_current
            or not np.isfinite([held_out.error, held_out.zero]).all()
        ):
            continue
        error, varies, zero, delay, shares = held_out.error, held_out.zero, 0.0, 0.0, dict[str, float]()
        if each.fit is not None and drive is not None and isinstance(log := each.fit.parts[0].experiment, MotionLog):
            unknown = dict(zip([part.name for part in log.nuisances], nuisances_of(each.fit).tolist(), strict=True))
            rows = from_motion_to_motion(log)
            saved = _saved(drive, whole)
            saved = saved if each is best else saved.replace(load=drive.load, motor=drive.motor)
            if any(estimate.why == BEHIND_GEAR for estimate in each.estimates):
                saved = frictionless(saved)
            left = log.residual(saved, nuisances_of(each.fit))[rows]
            offset = 0.0 if log.both_ways else float(np.mean(left))  # one way, a zero and friction are one number
            left = left - offset
            error, varies = float(np.sqrt(np.mean(left**2))), float(np.std(log.recorded[rows]))
            zero, delay = unknown.get(f"{log.effort}_zero", 0.0) + offset, unknown.get("delay", 0.0)
            shares = {name: unknown[f"{SHARE_OF}{name}"] for name in log.regressors}
        yield Validation(
            one_line(each.name), each.recognised.kind, held_out.channel, held_out.unit, error, varies, held_out.error,
            held_out.zero, zero, delay, shares, measured_range(each, whole.gear.kinematics.ratio),
        )  # fmt: skip
