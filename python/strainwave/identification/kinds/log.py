"""Logs of a drive in motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.gear_set import GearSet
from strainwave.identification.candidates.motion import fit_motion
from strainwave.identification.kinds.along_motion import fit_along_motion
from strainwave.identification.kinds.kind import Kind, Ranked
from strainwave.identification.kinds.predicted_log import predict_log
from strainwave.identification.kinds.prepared_log import log_of
from strainwave.identification.kinds.torsion_loop import is_loaded_spring, is_series_spring
from strainwave.identification.kinds.warm_up import warmed, with_fall
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import (
    MIN_FACTOR_OF_SIDES,
    Column,
    ColumnRoles,
    channels,
    commanded,
    measured,
    names_of,
    put,
    side_of_motion,
    side_of_torque,
    sides_of_angles,
    sides_of_torques,
)
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.prediction import Prediction
from strainwave.messages import as_option
from strainwave.questions import Answer, QuestionError
from strainwave.statistics.residuals import correlation_length

Array = NDArray[np.float64]

MAX_REFLECTED = 0.1  # relative difference of a motion of the input from that of the output, if it is divided by the ratio
MAX_REFLECTED_RANGE = 2.0 * np.pi  # rad, rad/s: a motor that moves less, without an encoder of the joint, is counted there


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
        by_channel = channels(
            {
                "time": measured(columns, "time"),
                "command": sorted(commanded(columns, "angle"), key=lambda column: not column.by_user)[:1],
                "voltage": measured(columns, "voltage") or commanded(columns, "voltage"),
                "current": currents,
                "temperature": measured(columns, "temperature"),
                "rigid_torque": [column for column in columns if column.channel.modelled],
            }
        )
        sides, why = put_sided(by_channel, columns, torques, mapping)
        first = f"it has {names_of(columns)}, {len(columns[0].si)} rows in time: {self.title}"
        return ColumnRoles(self.name, by_channel, next(iter(sides)) if len(sides) == 1 else None, (first, *why), remarks)

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit friction, inertia and gravity along the motion, with two encoders what lies between them; and warm-up."""
        if (warm := warmed(file)) is None:
            return fit_along_motion(file, known)
        own, warming = warm
        try:
            result, after = fit_along_motion(file, known)
        except ValueError as error:
            remarks = (*file.remarks, f"not used along its motion: {error}")
            result, after = replace(own, estimates=(), checks=(), remarks=remarks), known
        after, assumed = with_fall(after, warming, own)
        return replace(
            result,
            estimates=(*result.estimates, *own.estimates),
            remarks=(*own.remarks, *assumed, *result.remarks),
            checks=(*result.checks, *own.checks),
        ), after

    def rank(self, file: Recognised, known: GearSoFar) -> tuple[Ranked, ...]:
        """Return the laws of friction by their error on data held out."""
        prepared = log_of(file, known)
        ranked = []
        for each in fit_motion([prepared.log], prepared.drive):
            correlation = max(correlation_length(part.residuals[0]) for part in each.fit.parts)
            nuisances = sum(len(part.experiment.nuisances) for part in each.fit.parts)
            fitted = len(each.fit.estimates) - nuisances - len(each.model.ties)
            ranked.append(Ranked(each.name, fitted, each.error, np.nan, prepared.log.units[0], correlation))
        return tuple(ranked)

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


# ---- Motions and torques with their sides ----------------------------------------------------------------------------


def put_sided(
    found: dict[str, Column], columns: Sequence[Column], torques: Sequence[Column], mapping: FileMapping
) -> tuple[set[Side], list[str]]:
    """Add motions and torques of a log with their sides; return the sides that move, and what determines them."""
    motions, why = _of_both_shafts([*measured(columns, "angle"), *measured(columns, "speed")])
    if not motions:
        raise QuestionError(f"a log needs an angle or a speed; it has {names_of(columns)}")
    sides: set[Side] = set()
    for column in motions:
        side, why_side = side_of_motion(column, (*motions, *torques), found.get("time"), mapping.side)
        sides.add(side)
        why.append(why_side)
        put(found, f"{'reflected' if column.channel.reflected else side}_{column.channel.quantity}", column)
    why += _reflect(found, mapping)
    if len(torques) > 1 and not any(column.by_user or column.channel.side for column in torques):
        raise QuestionError(f"each of {names_of(torques)} may be the torque", sides_of_torques(torques))
    for column in torques:
        side, why_side = side_of_torque(column, sides, mapping.side)
        why.append(why_side)
        put(found, "joint_torque" if side == "output" else "input_torque", column)
    return sides, [each for each in why if each]


def _of_both_shafts(motions: Sequence[Column]) -> tuple[list[Column], list[str]]:
    """Return the motions, with the sides of two whose names contain none by their sizes; and what determines them."""
    sided, why = list(motions), list[str]()
    for quantity in ("angle", "speed"):
        both = [column for column in sided if column.channel.quantity == quantity]
        is_open = [column.channel.side is None for column in both]
        small, large = sorted(float(np.ptp(column.si)) for column in both) if len(both) == 2 else (0.0, 0.0)
        if len(both) == 2 and (all(is_open) or (any(is_open) and large > MIN_FACTOR_OF_SIDES * small > 0.0)):
            fast, slow, why_side = sides_of_angles(both)
            sides: tuple[tuple[Column, Side], ...] = ((fast, "input"), (slow, "output"))
            for column, side in sides:
                sided[sided.index(column)] = replace(column, channel=column.channel._replace(side=side))
            why.append(why_side)
        elif len(both) == 2 and any(is_open) and not all(is_open):
            named, other = both if is_open[1] else both[::-1]
            differ = np.nanmax(np.abs(both[0].si - both[1].si)) > 0.0
            if not (differ and abs(_slope(both[0].si, both[1].si) - 1.0) < MAX_REFLECTED):
                continue
            of_other: Side = "output" if named.channel.side == "input" else "input"
            sided[sided.index(other)] = replace(other, channel=other.channel._replace(side=of_other))
            why.append(f"{other.name} is recorded with {named.name}, from which it differs: it is that of the {of_other}")
    return sided, why


@np.errstate(all="ignore")
def _slope(motion: Array, other: Array) -> float:
    return abs(float(np.cov(motion, other)[0, 1] / np.var(other, ddof=1)))


@np.errstate(all="ignore")
def _reflect(found: dict[str, Column], mapping: FileMapping) -> list[str]:
    """Rename motions of the input that are as large as those of a joint, as they are divided by the ratio."""
    if abs(abs(mapping.constants.get("ratio", np.inf)) - 1.0) < MAX_REFLECTED:
        return []
    why = []
    for quantity in ("angle", "speed"):
        motor, joint = found.get(f"input_{quantity}"), found.get(f"output_{quantity}")
        if motor is None or joint is None:
            continue
        if not np.ptp(joint.si) > 0.0:
            del found[f"output_{quantity}"]
            why.append(f"{joint.name} never changes, as of an encoder that is not there: it is left out")
            if np.ptp(motor.si) < MAX_REFLECTED_RANGE and not motor.by_user:
                found[f"reflected_{quantity}"] = found.pop(f"input_{quantity}")
                moves = f"{motor.name} moves no further than a joint: it is taken as divided by the ratio"
                why.append(f"{moves}; otherwise add {as_option('column', f'input_{quantity}', motor.name)}")
            continue
        if abs(_slope(motor.si, joint.si) - 1.0) < MAX_REFLECTED:
            found[f"reflected_{quantity}"] = found.pop(f"input_{quantity}")
            why.append(f"{motor.name} moves as far as {joint.name}: it is the {quantity} of the motor divided by the ratio")
    return why
