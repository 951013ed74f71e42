"""Orders of a gear in a recording: from two encoders if it has both, from torque or current if it has one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.messages import listed, named
from strainwave.orders.lines import SpectrumLine
from strainwave.orders.ring_modes import RingModes, passes_frequencies, ring_modes
from strainwave.orders.run_up import RunUp, is_run_up, run_up
from strainwave.orders.torque_ripple import Ripple, Side, ripple
from strainwave.orders.two_encoders import TransmissionError, transmission_error
from strainwave.presentation import Presented
from strainwave.questions import LOG_AT_RATE, OF_SIDES, QuestionError
from strainwave.typeset import number

EFFORT_COLUMNS = (
    "joint_torque",
    "torque",
    "input_torque",
    "current",
    "vibration",
)  # in which ripple is looked for, the best first
ANGLE_COLUMNS: tuple[tuple[str, Side | None], ...] = (("input_angle", "input"), ("output_angle", "output"), ("angle", None))
MAX_SHIFT, MAX_SIDE_LINE = 1.0, 8.0  # periods in a run-up, of an order that passes a resonance and of its side lines (assumed)
SPEED_COLUMNS: tuple[tuple[str, Side | None], ...] = (("input_speed", "input"), ("output_speed", "output"), ("speed", None))


@dataclass(frozen=True, eq=False)
class OrdersFound(ComparedByFields, Presented):
    """Orders of one recording.

    Attributes:
        name: of the recording
        transmission: from two encoders, if it has both
        ripple: from torque or current, if it has one and an angle
        remarks: what is not determined, and why
        run_up: orders, resonance and fixed frequencies of a vibration while the speed varies
        modes: that the orders of the output angle pass, in a run-up or in several recordings
    """

    name: str
    transmission: TransmissionError | None
    ripple: Ripple | None
    remarks: tuple[str, ...] = ()
    run_up: RunUp | None = None
    modes: RingModes | None = None


def orders_found(
    recording: Recording,
    name: str = "recording",
    *,
    ratio: float | None = None,
    side: Side | None = None,
    highest: float | None = None,
    rate: float | None = None,
    other_angles: Mapping[str, str] | None = None,
) -> OrdersFound:
    """Return the orders of a gear in a recording, from all its columns.

    Args:
        recording: columns with the names of a drive log: time, input_angle, output_angle, angle, a speed instead of an angle,
            joint_torque, torque, input_torque, current, vibration
        side: on which the angle or speed was measured, if its name does not contain it
        highest: order up to which ripple is looked for, of the shaft whose angle is used: the input of two
        rate: samples per second of a recording without time [Hz]
        other_angles: columns with the angles of other joints that move, by the name of the joint

    >>> theta = np.linspace(0.0, 400.0, 9000)
    >>> torque = 0.05 + 0.004 * np.cos(2 * theta) + np.random.default_rng(0).normal(0.0, 0.004, len(theta))
    >>> found = orders_found(Recording({"angle": theta, "torque": torque}, {"angle": "rad", "torque": "N.m"}), side="input")
    >>> [(line.kind, round(line.order, 1)) for line in found.ripple.lines]
    [('either', 2.0)]
    """
    if side is not None:
        arguments.one_of("side", side, ("input", "output"))
    effort = next((each for each in EFFORT_COLUMNS if each in recording), None)
    if "input_angle" in recording and "output_angle" in recording:
        load = next((each for each in ("joint_torque", "current") if each in recording), "")
        both = [each for each in ("time", "input_angle", "output_angle", load) if each in recording]
        error_of_gear = transmission_error(recording.select(both), ratio=ratio, rate=rate, ratio_option="--ratio")
        in_joint_units = error_of_gear.ratio.in_joint_units
        modes = None if in_joint_units else modes_of([recording])
        if effort is None:
            return OrdersFound(name, error_of_gear, None, modes=modes)
        try:
            own = ripple(
                recording, effort, angle="input_angle", side="output" if in_joint_units else "input",
                ratio=ratio if in_joint_units else abs(error_of_gear.ratio.used), highest=highest, rate=rate,
                other_angles=other_angles,
            )  # fmt: skip
        except ValueError as error:
            return OrdersFound(name, error_of_gear, None, (f"ripple in {effort} is not determined: {error}",), modes=modes)
        return OrdersFound(name, error_of_gear, own, modes=modes)
    if effort is None:
        raise ValueError(
            f"orders need two angles, input_angle and output_angle, or one angle and a torque or current; there are "
            f"{listed(recording.names)}"
        )
    turning, angle, side_of_angle, remarks = with_angle(recording, side, rate)
    lines = ripple(
        turning, effort, angle=angle, side=side_of_angle, ratio=ratio, highest=highest, rate=rate, other_angles=other_angles
    )
    passing, curves = None, lines.curves
    if effort == "vibration" and "speed" in curves and is_run_up(curves["speed"]):
        passing = run_up(curves.time, curves["angle"], curves["speed"], curves["series"], lines.lines)
        lines = _of_run_up(lines)
    lines = replace(lines, remarks=(*remarks, *lines.remarks))
    return OrdersFound(name, None, lines, () if passing is None else passing.remarks, passing)


def _of_run_up(found: Ripple) -> Ripple:
    """Return lines as exact as a run-up allows, without side lines of stronger ones.

    An order that passes a resonance grows and falls there, and turns by half a period.
    """
    kept = list[SpectrumLine]()
    for line in found.lines:
        apart = [abs(line.order - other.order) * found.revolutions for other in kept if other.kind == "order"]
        if line.kind != "order" or min(apart, default=MAX_SIDE_LINE) >= MAX_SIDE_LINE:
            kept.append(replace(line, order_sigma=hypot(line.order_sigma, MAX_SHIFT / found.revolutions)))
    if len(kept) == len(found.lines):
        return replace(found, lines=tuple(kept))
    hidden = named(
        "order", [number(line.order, 5) for line in found.lines if line.order not in [other.order for other in kept]]
    )
    remark = f"not determined: {hidden}, where stronger orders that change with the speed have side lines"
    return replace(found, lines=tuple(kept), remarks=(*found.remarks, remark))


def modes_of(recordings: Sequence[Recording]) -> RingModes | None:
    """Return the modes that orders of the output angle pass in recordings of two encoders; None if the speeds are too close."""
    needed = ("time", "input_angle", "output_angle")
    if not all(name in recording for recording in recordings for name in needed):
        return None
    return ring_modes(recordings, "output_angle") if passes_frequencies(recordings, "input_angle") else None


def of_several(modes: RingModes, count: int) -> OrdersFound:
    """Return the modes of several recordings as a result of all together."""
    one_zero = "modes need one zero and one sense of the input angle in all recordings, because phases are compared"
    return OrdersFound(f"{count} recordings together", None, None, () if modes.modes else (one_zero,), modes=modes)


def with_angle(recording: Recording, side: Side | None, rate: float | None) -> tuple[Recording, str, Side, tuple[str, ...]]:
    """Return the recording with an angle, its name and side, and what was done for it."""
    for name, side_of_name in ANGLE_COLUMNS:
        if name in recording:
            return recording, name, _side(name, side_of_name, side), ()
    for name, side_of_name in SPEED_COLUMNS:
        if name not in recording:
            continue
        if "time" not in recording and rate is None:
            raise QuestionError(f"{name} gives an angle only over time", [LOG_AT_RATE])
        speed = recording.values(name, "rad/s")
        if rate is not None:
            rate = arguments.number("rate", rate, "Hz", low=0.0)
        step = np.diff(recording.time) if "time" in recording else np.full(len(speed) - 1, 1.0 / float(rate or 1.0))
        angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * step)])
        remark = f"there is no angle: {name} is summed up over time; its errors widen the lines"
        return recording.with_column("angle", angle, "rad"), "angle", _side(name, side_of_name, side), (remark,)
    raise ValueError(f"orders need an angle, or a speed over time: record one; there are {listed(recording.names)}")


def _side(name: str, known: Side | None, given: Side | None) -> Side:
    if given is None and known is None:
        raise QuestionError(f"{name} may be that of the motor or that of the joint", OF_SIDES)
    if given is not None and known is not None and given != known:
        raise ValueError(f'side = "{given}" is given, but {name} is that of the {known}; leave one of them out')
    return given or known or "output"
