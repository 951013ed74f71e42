"""Records at constant speed, whose means are the points of one friction table; and torque without the motion that made it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from strainwave.analysis.branches import turning_points
from strainwave.identification.candidates.plain import sliding_squares
from strainwave.identification.experiments.drive_log import ENCODERS
from strainwave.identification.kinds import constant_speed_runs
from strainwave.identification.kinds.constant_speed_runs import ConstantSpeedRun, Together, is_one_speed, run_of
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.kinds.prepared_log import log_of
from strainwave.identification.kinds.warm_up import warmed
from strainwave.identification.reading import unnamed
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import ColumnRoles, channels, measured
from strainwave.identification.reading.sides import pair
from strainwave.identification.results.file_result import MAX_UNEXPLAINED, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar, with_ratio
from strainwave.identification.results.steady_friction import MIN_SPEEDS
from strainwave.messages import listed
from strainwave.questions import LOG_AT_RATE, Answer, QuestionError

MIN_ROWS = 20  # of a record at one speed: fewer are a table


class ConstantSpeed(Kind):
    """A record of one speed, or of several speeds one way: each a point of the table that all such files are together."""

    time = "used"
    section = "Files at constant speed"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for a torque or current alone, with an angle, or with one speed.

        Raises:
            QuestionError: an angle goes to and fro under a current, as before it slides or in a log
        """
        efforts, angles, speeds = (measured(columns, *each) for each in (("torque", "current"), ("angle",), ("speed",)))
        if efforts and angles and not measured(columns, "torque") and turning_points(angles[0].si):
            ways = [LOG_AT_RATE, Answer("friction before it slides", {"kind": "presliding"})]
            raise QuestionError(f"{pair(angles[0], efforts[0])} go to and fro without time", ways)
        return bool(efforts) and (bool(angles) or not speeds or (len(speeds[0].si) > MIN_ROWS and is_one_speed(speeds[0].si)))

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        quantities = dict.fromkeys(column.channel.quantity for column in columns if column.channel.measured)
        found = channels({quantity: measured(columns, quantity) for quantity in quantities})
        effort = listed(found[name].name for name in ("torque", "current") if name in found)
        side = mapping.side or next((column.channel.side for column in found.values() if column.channel.side), None)
        robot = next((column.name for column in found.values() if column.robot), None) if side is None else None
        if "speed" in found:
            why = f"at one speed, {found['speed'].si.mean():.4g} rad/s: a record at constant speed"
        elif "angle" in found:
            turns = np.ptp(found["angle"].si) / (2.0 * np.pi)
            why = f"over {found['angle'].name}, which runs on for {turns:.3g} turns"
        elif "speed" in mapping.constants:
            why = f"at {mapping.constants['speed']:.4g} rad/s, as was given: a record at constant speed"
        else:
            why = "and nothing that moves: the output was locked, or the speed was constant and is not stated"
        why_side = (f"{robot} is what robots call a channel of a joint: it is taken to be at the output",) if robot else ()
        return ColumnRoles(self.name, found, "output" if robot else side, (f"it has {effort} {why}", *why_side))

    def takes(self, file: Recognised, known: GearSoFar, files: Sequence[Recognised]) -> bool:
        """True also for logs at constant speed, but for one of few speeds whose torque changes as that of a log.

        The torque of a joint is not its friction if other joints move.
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
            raise _without_motion(file)
        result, warm = constant_speed_runs.of_run(run), warmed(file)
        if warm is None:
            return result, known
        of_temperature, _ = warm
        return replace(
            result, remarks=(*of_temperature.remarks, *result.remarks), pictures=(*result.pictures, *of_temperature.pictures)
        ), known

    def fit_together(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Fit the friction table of the means of all files."""
        return _or_refused(constant_speed_runs.JOINED, constant_speed_runs.joined, files, known)

    def fit_last(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Fit friction over the angle of the input, around that which other files determine."""
        return _or_refused("friction over the angle", constant_speed_runs.over_the_angle, files, known)


def _or_refused(
    name: str, fit: Callable[[Sequence[ConstantSpeedRun], GearSoFar], Together], files: Sequence[Recognised], known: GearSoFar
) -> Together:
    """Return what the runs of files determine together, or a result of this name that is refused."""
    try:
        return fit(_runs(files, known), known)
    except (ValueError, FloatingPointError) as error:
        return (FileResult(name, refused=str(error)),), known


def _runs(files: Sequence[Recognised], known: GearSoFar) -> list[ConstantSpeedRun]:
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


def _without_motion(file: Recognised) -> QuestionError:
    """Return the refusal of a torque or a current without a motion, or the question which column is one."""
    if {"angle", "speed", *ENCODERS} & {*file.recording.names, *file.constants}:
        return QuestionError("torque without motion determines orders alone: strainwave orders finds them")
    hint = f" (not used, as they contain texts: {listed(file.texts)})" if file.texts else ""
    speed = Answer("the shaft turned at one speed", {"constants": {"speed": 10.0}}, {"speed": "this speed [rad/s]"})
    ways = [*unnamed.motions(file.unnamed), speed]
    return QuestionError(f"torque alone determines nothing of the gear: record an angle or a speed with it{hint}", ways)
