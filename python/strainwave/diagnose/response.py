"""Response of a recording to a kinematic error: amplitude of its column per error, by a model or by virtual work."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import tau
from typing import Any

import numpy as np

from strainwave import Drive, loads
from strainwave.diagnose.replicates import JointMotion
from strainwave.diagnose.smallest_error import CURRENT_COLUMN, MAX_CATALOGUE_AMPLITUDE, RecordedOrder, SteadyRun
from strainwave.files.gear_set import GearSet
from strainwave.messages import listed

SAMPLES_PER_PERIOD = 20.0  # of an order, in the runs of the model
MODEL_TURNS = 5.0  # of the input in a run of the model, or periods of an order below 1
FRICTION_SPREAD = 0.3  # of the friction of the model [1], by which that of the gear may be larger
MAX_MODEL_DURATION = 300.0  # s, of a run of the model: slower motion is that of virtual work


@dataclass(frozen=True)
class ErrorResponse:
    """Amplitude of a column per kinematic error of each order, at the speed and load of a recording.

    Attributes:
        per_error: by the order per revolution of the input [unit of the column / rad]; empty if it is not known
        source: from which it follows, in words
    """

    per_error: Mapping[float, float]
    source: str


def error_response(
    motion: JointMotion, orders: Sequence[float], gear_set: GearSet | None, ratio: float | None
) -> ErrorResponse:
    """Return the response by the model of the whole drive in its loop, or else by virtual work.

    By virtual work an error of amplitude A and order n turns a load T into n T A at the motor. This leaves out the inertia of
    the output and the loop of the controller, so it is right at low speed under load. A motion of one direction does not
    separate the load from friction. The model then takes the friction of the file and a spread; virtual work has no response.
    Orders are per revolution of the input. The model needs motor, load and controller of the set.
    """
    if ratio is None or not orders:
        return ErrorResponse({}, "")
    reason = _missing(motion, gear_set)
    if not reason and gear_set is not None:
        try:
            return _by_model(motion, orders, gear_set.drive)
        except (ValueError, FloatingPointError) as error:
            reason = str(error)
    if not motion.shaft.own.reverses():
        remedy = "reverse the motion, or give a gear file with motor, load and controller"
        return ErrorResponse({}, f"not known: one direction does not separate load from friction; {remedy} ({reason})")
    per_error = {order: order * ratio * motion.load for order in orders}
    return ErrorResponse(per_error, f"by virtual work at the load of the recording, right at low speed ({reason})")


def _missing(motion: JointMotion, gear_set: GearSet | None) -> str:
    """Return what the model of the drive lacks; empty if it lacks nothing."""
    if motion.run.column != CURRENT_COLUMN:
        return f"{motion.run.column.replace('_', ' ')} is no current of a motor"
    if not motion.timed:
        return "the speed is not known without time"
    if gear_set is None:
        return "no gear is given"
    parts = {"motor": gear_set.motor, "load": gear_set.load, "controller": gear_set.control}
    if missing := [name for name, part in parts.items() if part is None]:
        return f"the gear has no {listed(missing)}"
    if not getattr(gear_set.motor, "torque_constant", 0.0):
        return f"the motor {gear_set.motor.name} has no torque constant"
    return "" if hasattr(gear_set.load, "inertia") else f"the load {gear_set.load.name} moves the output from outside"


def _by_model(motion: JointMotion, orders: Sequence[float], whole: Drive) -> ErrorResponse:
    """Return the gain at the largest catalogue error, of the drive that turns its inertia at the usual speed under the load."""
    load: Any = whole.load
    motor: Any = whole.motor
    drive = whole.replace(load=loads.Inertia(inertia=load.inertia))  # all other loads are in the recording
    speed = _speed(motion)
    per_torque = float(motor.torque_constant) * abs(float(drive.gear.kinematics.ratio))  # N.m/A
    torque = per_torque * motion.load
    if not motion.shaft.own.reverses():  # one direction does not separate load and friction, which the model has
        friction = abs(float(np.mean(_steady(drive, speed, 0.0, orders).with_error(0.0)[CURRENT_COLUMN])))  # A
        torque = per_torque * max(motion.load - (1.0 + FRICTION_SPREAD) * friction, 0.0)
    run = _steady(drive, speed, torque, orders)
    healthy = run.with_error(0.0)
    per_error = {}
    for order in orders:
        own = replace(run, order=order)
        per_error[order] = abs(own.gain(RecordedOrder.of(healthy, order), MAX_CATALOGUE_AMPLITUDE))
    return ErrorResponse(
        per_error, f"by the model of the drive in its loop, at {speed:.3g} rad/s of the input under {torque:.3g} N.m"
    )


def _speed(motion: JointMotion) -> float:
    """Return the mean size of the speed of the input, where it counts [rad/s]."""
    own, weight = motion.shaft.own, motion.shaft.weight
    return float(np.average(np.abs(own.speed), weights=weight**2)) / motion.step * motion.run.per_input


def _steady(drive: Drive, speed: float, load_torque: float, orders: Sequence[float]) -> SteadyRun:
    """Return a run that determines some orders."""
    lowest, highest = min(orders), max(orders)
    duration = MODEL_TURNS / min(lowest, 1.0) * tau / speed
    if duration > MAX_MODEL_DURATION:
        raise ValueError(f"order {lowest:g} takes {duration:.3g} s in the model at {speed:.3g} rad/s")
    return SteadyRun.of(drive, speed, load_torque, duration, SAMPLES_PER_PERIOD * max(highest, 1.0) * speed / tau, lowest)
