"""Runs of the whole drive from rest under a known command, simulated as a whole: friction, stiffness and kinematic error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from strainwave import Drive
from strainwave.files.recording import Recording
from strainwave.identification.candidates.drive_log import LogFit, fit_log, free_parameters, prepared
from strainwave.identification.checks.unexplained import causes, explained, unexplained
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.fitting.influence import InfluenceOfKept, influence
from strainwave.identification.kinds.kind import Kind, exceeded, thinned, unused
from strainwave.identification.kinds.log import put_sided
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles, channels, commanded, measured, names_of
from strainwave.identification.results.file_result import Check, FileResult, HeldOut
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.identifiability import MAX_KEPT_LISTED, JudgedFit
from strainwave.identification.results.pictures import pictures_of_run
from strainwave.questions import QuestionError
from strainwave.simulation.run import simulate

MAX_CAUSES = 2  # likely mistakes that are fitted if the model does not explain a run, the likeliest first
MAX_SHARE_LEFT_BY_MISTAKE = 0.5  # of what was unexplained before: a mistake that leaves more explains nothing


class RunFromRest(Kind):
    """Time, command and measured outputs of a drive whose motor, controller and load the start set has."""

    time = "needed"

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        """Return the channel of each column; an encoder is that of the motor."""
        by_channel = channels(
            {
                "time": measured(columns, "time"),
                "command": commanded(columns, "angle") or commanded(columns, "voltage"),
                "current": measured(columns, "current"),
            }
        )
        if "command" not in by_channel:
            raise QuestionError(f"{self.title} needs its command; it has {names_of(columns)}")
        _, why = put_sided(by_channel, columns, [], mapping if mapping.side else replace(mapping, side="input"))
        first = f"it has {names_of(columns)}, {len(columns[0].si)} rows in time: {self.title}"
        return ColumnRoles(self.name, by_channel, None, (first, *why))

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit what no better file determines, by simulating the drive."""
        name, recording = file.path.name, file.recording
        log = DriveLog.of(recording, known.gear_set.drive)
        friction_known, torsion_known = (part in known.determined for part in ("friction_input", "stiffness"))
        drive = prepared(log, known.gear_set.drive, friction_known=friction_known)
        free = free_parameters(log, drive, friction_known=friction_known, torsion_known=torsion_known)
        log_fit = fit_log(log, drive, free)
        whole = explained(log_fit.fit, name)
        kept = InfluenceOfKept.none(len(log_fit.fit.estimates)) if whole.failed else influence(log_fit.fit)
        if whole.failed:
            whole = _with_cause(whole, log_fit.fit, file, drive, free)
        fitted = JudgedFit(log_fit.fit, name, kept, not whole.failed, prefix="")
        fit, estimates = fitted.with_set_before(known)
        result = FileResult(
            name, file, ", ".join(path.removeprefix("gear.") for path in free) or "nothing free", estimates,
            (*file.remarks, *_remarks(recording, log, log_fit.fit, kept, known)), (whole,),
            pictures=pictures_of_run(fit.parts[0].curves()), held_out=_held_out(log_fit), fit=fit,
        )  # fmt: skip
        if whole.failed:
            return result, known
        parts = dict.fromkeys(each.path.split(".")[1] for each in estimates)
        return result, known.with_fit(fit.gear, list(parts), estimates, name)


def _held_out(found: LogFit) -> HeldOut:
    """Return the error of the channel that is predicted worst."""
    experiment, rows = found.fit.experiment, ~found.fit.training
    each = [
        HeldOut("last 30 % of the record", channel, unit, float(error), float(np.std(measured[rows])), samples=int(rows.sum()))
        for channel, unit, error, measured in zip(
            experiment.channels, experiment.units, found.error, experiment.measured, strict=True
        )
    ]
    return max(each, key=lambda channel: channel.relative)


def _remarks(recording: Recording, log: DriveLog, fit: Fit, kept: InfluenceOfKept, known: GearSoFar) -> Iterator[str]:
    yield from thinned(log.samples, len(log.time))
    if log.time[-1] < 0.99 * np.ptp(recording.time):
        yield f"of its {np.ptp(recording.time):.4g} s the first {log.time[-1]:.4g} s are taken, to fit in little time"
    yield from unused(recording, ("time", "command", *log.channels))
    if not {"input_angle", "output_angle"} <= set(log.channels):
        yield "one encoder only: kinematic error and stiffness are not seen"
    if wrong := kept.suspects(known.gear_set.sources):
        others = [
            f"{each.path} = {each.value:.4g} {each.unit} (about {each.value + kept.shift_if_free[place]:.3g} {each.unit} would "
            f"leave {100.0 * kept.explained_share[place]:.0f} % less of the residuals' power)"
            for place in wrong[:MAX_KEPT_LISTED]
            for each in [kept.kept[place]]
        ]
        yield f"the run contradicts what was kept: {' or '.join(others)}. Measure them, or free one"
    try:
        load = _load(log, fit)
    except FloatingPointError as error:  # a fit that explains nothing may end where its drive hardly runs
        yield f"the torque of the fitted drive is not compared with the ratings: {error}"
    else:
        yield from exceeded(known.initial, load)


def _load(log: DriveLog, fit: Fit) -> Recording:
    """Return what the gear went through: its torque was not measured, and is that of the fitted drive."""
    run = simulate(fit.model, log.command, log.step(fit.model), sample=log.interval)
    return Recording(run.columns, run.units)


def _with_cause(check: Check, found: Fit, file: Recognised, drive: Drive, free: list[str]) -> Check:
    """Return the check with the mistake that would explain the run, if one does."""
    before = float(unexplained(found).max())
    for cause in causes(file.recording, drive, file.columns)[:MAX_CAUSES]:
        log = DriveLog.of(cause.recording, cause.drive)
        again = fit_log(log, prepared(log, cause.drive, friction_known=False), free).fit
        if not explained(again, check.source).failed:
            what = f"{cause.what[0].upper()}{cause.what[1:]}: then it is explained"
            return replace(check, message=f"{check.message}. {what}", remedy=cause.remedy)
        if float(unexplained(again).max()) < MAX_SHARE_LEFT_BY_MISTAKE * before:
            what = f"Perhaps {cause.what}: then less is left"
            return replace(check, message=f"{check.message}. {what}", remedy=cause.remedy)
    remedy = "no single mistake in sign, unit, side or ratio explains it; look at the plot, and at what is known of the drive"
    return replace(check, remedy=remedy)
