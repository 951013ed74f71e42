"""Logs of a drive in motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.identification.candidates.motion import fit_motion
from strainwave.identification.candidates.motion_candidate import MotionCandidate
from strainwave.identification.kinds.along_motion import fit_along_motion
from strainwave.identification.kinds.kind import Kind, Ranked
from strainwave.identification.kinds.predicted_log import predict_log
from strainwave.identification.kinds.prepared_log import log_of
from strainwave.identification.kinds.shafts import put_sided
from strainwave.identification.kinds.torsion_loop import is_loaded_spring, is_series_spring
from strainwave.identification.kinds.warm_up import warmed, with_fall
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles, channels, commanded, measured, names_of
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.prediction import Prediction
from strainwave.questions import Answer, QuestionError
from strainwave.statistics.residuals import correlation_length


class Log(Kind):
    """Time, a motion, and what drove it: a current, torque, voltage or command."""

    needs = "time, a motion, and a current, torque, voltage or command"
    time = "needed"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for a motion in time, and what drove it; a spring that a rig loads in steps does not move.

        The torque that a series elastic actuator computes from the twist of its spring is none that drove it.
        """
        if not measured(columns, "time") and "rate" not in mapping.constants:
            return False
        drove = measured(columns, "torque", "current", "voltage") or any(column.channel.commanded for column in columns)
        moves = bool(drove and measured(columns, "angle", "speed"))
        return moves and not is_loaded_spring(columns, mapping) and not is_series_spring(columns)

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        torques, currents, remarks = _efforts(columns)
        _check_voltage(columns, [*torques, *currents])
        found = channels(
            {
                "time": measured(columns, "time"),
                "command": sorted(commanded(columns, "angle"), key=lambda column: not column.by_user)[:1],
                "voltage": measured(columns, "voltage") or commanded(columns, "voltage"),
                "current": currents,
                "temperature": measured(columns, "temperature"),
                "rigid_torque": [column for column in columns if column.channel.modelled],
            }
        )
        sides, why = put_sided(found, columns, torques, mapping)
        first = f"it has {names_of(columns)}, {len(columns[0].si)} rows in time: {self.title}"
        return ColumnRoles(self.name, found, next(iter(sides)) if len(sides) == 1 else None, (first, *why), remarks)

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit friction, inertia and gravity along the motion, with two encoders what lies between them; and warm-up."""
        if (warm := warmed(file)) is None:
            return fit_along_motion(file, known)
        own, found = warm
        try:
            result, after = fit_along_motion(file, known)
        except ValueError as error:
            remarks = (*file.remarks, f"not used along its motion: {error}")
            result, after = replace(own, estimates=(), checks=(), remarks=remarks), known
        after, assumed = with_fall(after, found, own)
        return replace(
            result,
            estimates=(*result.estimates, *own.estimates),
            remarks=(*own.remarks, *assumed, *result.remarks),
            checks=(*result.checks, *own.checks),
        ), after

    def rank(self, file: Recognised, known: GearSoFar) -> tuple[Ranked, ...]:
        """Return the laws of friction by their error on data held out."""
        found = log_of(file, known)
        unit = found.log.units[0]
        return tuple(_ranked(each, unit) for each in fit_motion([found.log], found.drive))

    def predict(self, file: Recognised, gear_set: GearSet) -> Prediction:
        """Compare the torque along the motion with that of a saved drive."""
        return predict_log(file, gear_set)


def _efforts(columns: Sequence[Column]) -> tuple[list[Column], list[Column], tuple[str, ...]]:
    """Return torques and currents of a log: those that a person named, else those measured, else those commanded."""
    torques, currents = measured(columns, "torque"), measured(columns, "current")
    if any(column.by_user for column in (*torques, *currents)):
        torques, currents = ([column for column in some if column.by_user] for some in (torques, currents))
    if torques or currents:
        return torques, currents, ()
    torques, currents = commanded(columns, "torque"), commanded(columns, "current")
    remarks = (f"{column.name} is a reference, and is taken for what the drive did" for column in (*torques, *currents))
    return torques, currents, tuple(remarks)


def _check_voltage(columns: Sequence[Column], others: Sequence[Column]) -> None:
    """Ask for the letter u, which is a voltage in files of motors, and any input of a robot in files of joints.

    Raises:
        QuestionError: a column has this letter and nothing else for a name
    """
    for column in measured(columns, "voltage"):
        is_letter = len(column.name.rstrip("_0123456789[]")) == 1 and column.label.unit is None
        if is_letter and not others and not column.by_user and any(each.robot for each in columns):
            name = column.label.name
            of_motor = {"columns": {"voltage": name}, "constants": {"resistance": 1.0, "torque_constant": 0.1}}
            ways = [
                Answer("a torque of the joint", {"columns": {"joint_torque": name}}),
                Answer("a current of the motor", {"columns": {"current": name}}),
                Answer("a voltage of the motor", of_motor, {"resistance": "Ohm", "torque_constant": "N.m/A, of the motor"}),
            ]
            raise QuestionError(f"{column.name} may be a torque, a current or a voltage", ways)


def _ranked(each: MotionCandidate, unit: str) -> Ranked:
    correlation = max(correlation_length(part.residuals[0]) for part in each.fit.parts)
    nuisances = sum(len(part.experiment.nuisances) for part in each.fit.parts)
    fitted = len(each.fit.estimates) - nuisances - len(each.model.ties)
    return Ranked(each.name, fitted, each.error, np.nan, unit, correlation)
