"""One file of measurements fitted, by what it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification.experiments.drive_log import ENCODERS
from strainwave.identification.experiments.friction_table import with_load
from strainwave.identification.kinds.along_motion import log
from strainwave.identification.kinds.at_rest import breakaway, presliding
from strainwave.identification.kinds.plausibility import clipped_loop, of_levels, too_fast
from strainwave.identification.kinds.two_encoders import encoders
from strainwave.identification.reading.kind import Kind
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.curves import curves_of
from strainwave.identification.results.determined import (
    AT_SPEEDS,
    MIN_SPEEDS,
    best_known_friction,
    different_speeds,
    friction_at_speeds,
)
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar, is_of, with_torque
from strainwave.identification.twin import Twin, twin
from strainwave.messages import listed

FRICTION = ("coulomb", "breakaway", "viscous", "stribeck_speed")  # mean the same in every law that has them


def fitted(file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    """What a file tells, and what is known after it.

    Raises:
        ValueError: nothing can be found in it; says why
    """
    of_kind: dict[Kind, Callable[[Recognised, GearSoFar], tuple[FileResult, GearSoFar]]] = {
        "friction": _friction,
        "torsion": _torsion,
        "encoders": encoders,
        "log": log,
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
    if {"angle", "speed", *ENCODERS} & {*file.recording.names, *file.constants}:
        return f"torque without motion tells orders alone: strainwave orders finds them{hint}"
    return (
        "torque alone tells nothing of the gear: record an angle or a speed with it, or, if the shaft turned at one speed, "
        f"give that with --constant speed='100 1/min'{hint}"
    )


def _friction(file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    table, uncertain = with_torque(file, known.gear_set)
    table, remarks = with_load(_unloaded(table, file, known.gear_set), abs(known.gear_set.gear.kinematics.ratio), file.side)
    return friction_of(replace(file, remarks=(*file.remarks, *remarks)), table, uncertain, known)


def _unloaded(table: Recording, file: Recognised, gear_set: GearSet) -> Recording:
    """A table without the constant torque at the output that a person gave, and at the temperature that a person gave."""
    if load := file.constants.get("load_torque", 0.0):
        held = load if file.side == "output" else load / gear_set.gear.kinematics.ratio
        table = table.with_column("torque", table.values("torque", "N.m") - held, "N.m")
    if "temperature" in file.constants and "temperature" not in table:
        table = table.with_column("temperature", np.full(len(table), file.constants["temperature"]), "K")
    return table


def friction_of(file: Recognised, table: Recording, uncertain: float, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
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
    speed, torque = table.values("speed", "rad/s"), table.values("torque", "N.m")
    if "load" not in table and different_speeds(speed) < MIN_SPEEDS:
        at_speeds, few = friction_at_speeds(speed, torque, side=file.side or "input")
        at_speeds = tuple(each.resting_on(uncertain) for each in at_speeds)
        return FileResult(file.path.name, file, AT_SPEEDS, at_speeds, remarks=(*file.remarks, *few)), known
    side = "output" if file.side == "output" else known.side  # one that was only found is doubted if the set speaks against it
    found = twin(known.gear_set, friction=table, side=side, sources={"friction": file.path.name})
    finding = _of_twin(file, found, known.accept)
    estimates = finding.estimates
    if any(each.why for each in estimates):
        fit = found.evidence[-1].fit
        speeds = np.quantile(ratio * np.abs(speed), np.linspace(0.0, 1.0, 9)).tolist()
        estimates = (*estimates, best_known_friction(fit.gear, [each.path for each in fit.estimates], fit.covariance, speeds))
    estimates = tuple(each.resting_on(uncertain) for each in estimates)
    finding = replace(finding, estimates=estimates, remarks=(*finding.remarks, *of_levels(table)))
    if finding.refused or known.knows_better("friction_input", finding.estimates):
        return finding, known
    parts = {"friction_input", "friction_mesh"} if "load" in table else {"friction_input"}
    gear = known.gear_set.gear.replace(**{part: getattr(found.gear_set.gear, part) for part in parts})
    after = replace(_with_gear(known, gear, found, parts, finding), friction=table)
    return finding, after.judged("friction_input", finding.estimates)


def _torsion(file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    at_input = "input_angle" in file.recording
    if clipped := clipped_loop(file.recording):
        raise ValueError(clipped)
    friction = known.friction if at_input else None
    found = twin(known.gear_set, friction=friction, torsion=file.recording, sources={"torsion": file.path.name})
    finding = _of_twin(file, found, known.accept)
    if finding.refused or known.knows_better("stiffness", finding.estimates):
        return finding, known
    # a loop at the input has friction inside, and what a table says wrong of it becomes hysteresis
    parts = {"stiffness"} if at_input and "hysteresis" in known.determined else {"stiffness", "hysteresis"}
    gear = known.gear_set.gear.replace(**{part: getattr(found.gear_set.gear, part) for part in parts})
    return finding, _with_gear(known, gear, found, parts, finding).judged("stiffness", finding.estimates)


def _of_twin(file: Recognised, found: Twin, accept: bool) -> FileResult:
    evidence = found.evidence[-1]
    exceeded = tuple(f"beyond what the maker allows: {check}" for check in found.ratings if check.exceeded)
    remarks = (*file.remarks, *evidence.remarks, *exceeded)
    curves = curves_of(evidence.fit)
    doubts = tuple(f"{doubt.what}. What to do: {doubt.remedy}" for doubt in evidence.doubts)
    if doubts and (evidence.unexplained or not accept):
        refused = "; ".join(doubts)
        return FileResult(file.path.name, file, evidence.candidates[0][0], (), np.nan, remarks, refused=refused, curves=curves)
    own = {evidence.path(estimate) for estimate in evidence.fit.estimates}
    gear = found.gear_set.gear
    told = tuple(
        FileEstimate(v.path, v.unit, v.value, v.sigma, _law(v.path, gear), "" if v.state == "identified" else v.why)
        for v in found.verdicts
        if v.path in own
    )
    share = float(evidence.error[0] / np.std(evidence.fit.experiment.measured))
    return FileResult(file.path.name, file, evidence.candidates[0][0], told, share, remarks, doubts, curves=curves)


def _with_gear(known: GearSoFar, gear: Any, found: Twin, parts: set[str], finding: FileResult) -> GearSoFar:
    """The set with a gear of which some parts are those of a twin, with their sources."""
    sources = {path: entry for path, entry in known.gear_set.sources.items() if not is_of(path, parts)}
    sources |= {path: entry for path, entry in found.gear_set.sources.items() if is_of(path, parts)}
    determined_by = {path: file for path, file in known.determined_by.items() if not is_of(path, parts)}
    determined_by |= {each.path: finding.name for each in finding.estimates if is_of(each.path, parts) and not each.why}
    gear_set = replace(known.gear_set, gear=gear, sources=sources)
    return replace(known, gear_set=gear_set, determined=known.determined | parts, determined_by=determined_by)


def _law(path: str, gear: Any) -> str:
    """The law that gives a number its meaning."""
    part, _, name = path.removeprefix("gear.").partition(".")
    return "" if part == "friction_input" and name in FRICTION else str(getattr(gear, part).name)
