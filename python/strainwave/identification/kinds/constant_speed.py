"""Records at constant speed, whose means are the points of one friction table; and torque without the motion that made it."""

from __future__ import annotations

from collections.abc import Sequence

from strainwave.identification.candidates.plain import sliding_squares
from strainwave.identification.experiments.drive_log import ENCODERS
from strainwave.identification.kinds import constant_speed_runs
from strainwave.identification.kinds.constant_speed_runs import Run, run_of
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.kinds.prepared_log import log_of
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.kinds import ColumnRoles, effort_roles
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.readings import MAX_UNEXPLAINED
from strainwave.identification.results.determined import MIN_SPEEDS
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.ratio import with_ratio
from strainwave.messages import listed


class ConstantSpeed(Kind):
    """A record of one speed, or of several speeds one way: each a point of the table that all such files are together."""

    time = "used"
    section = "Files at constant speed"

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        return effort_roles(columns, mapping)

    def takes(self, file: Recognised, known: GearSoFar, files: Sequence[Recognised]) -> bool:
        """True also for logs at constant speed, but for one of few speeds whose torque changes as that of a log.

        The torque of a joint beside others that move is not its friction.
        """
        if file.kind == "log" and file.neighbours:
            return False
        if file.kind == "log":
            try:
                run = run_of(file, with_ratio(known, file))
            except ValueError:
                return True
            return run is not None and (len(run.stretches) + len(files) > MIN_SPEEDS or not _is_explained(file, known))
        return file.kind == self.name

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Return the means of a file, which is a point of the table of all."""
        run = run_of(file, known)
        if run is None:
            raise ValueError(_without_motion(file))
        return constant_speed_runs.of_run(run), known

    def fit_together(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Fit the friction table of the means of all files."""
        runs = _runs(files, known)
        if not runs:
            return (), known
        try:
            table, after = constant_speed_runs.joined(runs, known)
        except (ValueError, FloatingPointError) as error:
            return (FileResult(constant_speed_runs.JOINED, refused=str(error)),), known
        return (table,), after

    def fit_last(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Fit friction over the angle of the input, around that which other files determine."""
        try:
            found = constant_speed_runs.over_the_angle(_runs(files, known), known)
        except (ValueError, FloatingPointError) as error:
            return (FileResult("friction over the angle", refused=str(error)),), known
        return ((), known) if found is None else ((found[0],), found[1])


def _runs(files: Sequence[Recognised], known: GearSoFar) -> list[Run]:
    """Return the runs of files; those that cannot be used are left out."""
    found = []
    for file in files:
        try:
            run = run_of(file, with_ratio(known, file))
        except ValueError:
            continue
        found += [run] if run is not None else []
    return found


def _is_explained(file: Recognised, known: GearSoFar) -> bool:
    """True if inertia, gravity and friction explain the torque of a log on data held out."""
    try:
        found = log_of(file.at_ratio(known.gear_set.gear.kinematics.ratio), known)
        squares, samples = sliding_squares(found.log, found.drive)
    except (ValueError, FloatingPointError):
        return False
    return bool(squares.sum() < MAX_UNEXPLAINED**2 * samples.sum())


def _without_motion(file: Recognised) -> str:
    """Return what to do with a torque or a current that has no motion beside it."""
    do = "does it" if len(file.unused) == 1 else "do they"
    hint = f" (columns not used: {listed(file.unused)}: {do} hold texts?)" if file.unused else ""
    if {"angle", "speed", *ENCODERS} & {*file.recording.names, *file.constants}:
        return f"torque without motion determines orders alone: strainwave orders finds them{hint}"
    return (
        "torque alone determines nothing of the gear: record an angle or a speed with it, or, if the shaft turned at one "
        f"speed, give that with --constant speed='100 1/min'{hint}"
    )
