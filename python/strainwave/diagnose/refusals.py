"""Recordings that a diagnosis cannot use: too short, aliased, at rest, or without the columns that it needs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import pi, tau

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.messages import listed
from strainwave.orders.comb import STRAIN_WAVE_RATIOS
from strainwave.orders.measured import ANGLE_COLUMNS, SPEED_COLUMNS, with_angle
from strainwave.orders.shaft_pair import Pair, ratio_of
from strainwave.orders.torque_ripple import MAX_PHASE_STEP, Side
from strainwave.orders.turning import evenly_turning
from strainwave.questions import QuestionError
from strainwave.spline_orders import WAVE_ORDER

Array = NDArray[np.float64]

DIAGNOSED_COLUMNS = (
    "current",
    "input_torque",
    "torque",
    "joint_torque",
)  # in which lines are looked for: what the motor measures first
MIN_INPUT_REVOLUTIONS = 3.0  # revolutions of the input from end to end
MIN_TRAVEL = 1e-3  # rad of the shaft: less is noise of an encoder at rest
SLOW_SHARE = 0.05  # of the largest speed: slower samples count as rest
SPEED_QUANTILE = 0.5  # of the moving samples: half of them must be slow enough for an order


@dataclass(frozen=True)
class JointRecording:
    """A recording of one joint that a diagnosis can use.

    Attributes:
        name: of the recording
        recording: with the columns
        column: torque or current in which lines are looked for
        angle: column with the angle of the shaft
        side: of the gear on which this shaft is
        ratio: size of the ratio, if it is known
        others: columns with the angles of other joints that move, by their names
        rate: samples per second of a recording without time [Hz]
        remarks: what was done for it
    """

    name: str
    recording: Recording
    column: str
    angle: str
    side: Side
    ratio: float | None = None
    others: Mapping[str, str] = field(default_factory=dict)
    rate: float | None = None
    remarks: tuple[str, ...] = ()

    @property
    def unit(self) -> str:
        """Unit of the torque or current."""
        return self.recording.unit(self.column)

    @property
    def per_input(self) -> float:
        """Revolutions of the input per revolution of the shaft; nan if the ratio is not known."""
        return 1.0 if self.side == "input" else np.nan if self.ratio is None else self.ratio


def usable(
    recording: Recording,
    name: str,
    *,
    ratio: float | None = None,
    side: Side | None = None,
    rate: float | None = None,
    other_angles: Mapping[str, str] | None = None,
) -> JointRecording:
    """Return a recording as a diagnosis uses it.

    Args:
        recording, name: columns with the names of a drive log, and the name for messages
        ratio: of the gear, if it is known; the sign does not matter
        side: on which the angle or speed was measured, if its name does not contain it
        rate: samples per second of a recording without time [Hz]
        other_angles: columns with the angles of other joints that move, by the name of the joint

    Raises:
        ValueError: there is no torque or current, no angle and no speed; both angles have another ratio than the one given; the
            shaft rests; it turns too little; or its samples are too far apart for order 2 of the wave generator

    >>> resting = Recording({"time": np.arange(100.0), "output_angle": np.zeros(100), "current": np.ones(100)},
    ...                     {"time": "s", "output_angle": "rad", "current": "A"})
    >>> usable(resting, "rest.csv")
    Traceback (most recent call last):
    ValueError: rest.csv: at rest: output_angle moves by 0 rad from end to end; at least 0.001 rad is needed; record a motion
    """
    size = None if ratio is None else abs(ratio)
    effort = next((each for each in DIAGNOSED_COLUMNS if each in recording), None)
    if effort is None:
        raise ValueError(
            f"{name}: without current or torque: its columns are {listed(recording.names)}; a diagnosis needs one of "
            f"{listed(DIAGNOSED_COLUMNS)}; record it"
        )
    if not any(each in recording for each, _ in (*ANGLE_COLUMNS, *SPEED_COLUMNS)):
        raise ValueError(
            f"{name}: without an angle or a speed: its columns are {listed(recording.names)}; a diagnosis needs one of "
            f"{listed(each for each, _ in (*ANGLE_COLUMNS, *SPEED_COLUMNS))}; record it"
        )
    try:
        turning, angle, side_of_angle, remarks = with_angle(recording, side, rate)
        run = JointRecording(name, turning, effort, angle, side_of_angle, size, dict(other_angles or {}), rate, remarks)
        run = _with_shaft_of_input(run) if "input_angle" in recording and "output_angle" in recording else run
        _check_motion(run)
    except QuestionError as question:
        raise question.of(name) from None
    except ValueError as error:
        raise ValueError(str(error) if str(error).startswith(f"{name}:") else f"{name}: {error}") from None
    return run


def _with_shaft_of_input(run: JointRecording) -> JointRecording:
    """Return a run with both angles over the input itself, whose angle a controller may have divided by the ratio.

    Without a ratio it is then a run over the output.
    """
    names = ("input_angle", "output_angle")
    record = evenly_turning(run.recording, names, [], run.rate)
    try:
        pair = Pair(record, *(record.columns[name] for name in names))
        _, free = ratio_of(pair, None)
    except ValueError as error:
        return replace(run, remarks=(*run.remarks, f"the ratio of both angles is not determined: {error}"))
    if run.ratio is None:
        return replace(run, side="output") if free.in_joint_units else run
    _, ratio = ratio_of(pair, run.ratio)
    if not ratio.in_joint_units:
        return run
    angle = run.ratio * run.recording.values("input_angle", "rad")
    remark = f"both angles are counted in joint units; the motor angle is multiplied by the ratio, {run.ratio:.9g}"
    recording = run.recording.with_column("input_angle", angle, "rad")
    return replace(run, recording=recording, remarks=(*run.remarks, remark))


def _check_motion(run: JointRecording) -> None:
    """Raise ValueError for a shaft that rests, turns too little or too fast for the samples."""
    raw = run.recording.values(run.angle, "rad")
    if (travel := float(np.ptp(raw))) < MIN_TRAVEL:
        raise ValueError(
            f"at rest: {run.angle} moves by {travel:.3g} rad from end to end; at least {MIN_TRAVEL:g} rad is needed; "
            "record a motion"
        )
    record = evenly_turning(run.recording, [run.angle], [], run.rate)
    angle = record.columns[run.angle]
    least_ratio = float(STRAIN_WAVE_RATIOS[0])
    per_input = run.per_input if np.isfinite(run.per_input) else least_ratio
    assumed = "" if np.isfinite(run.per_input) else f", with the smallest ratio that makers offer, {least_ratio:g}"
    turned = float(np.ptp(angle)) / tau * per_input
    if turned < MIN_INPUT_REVOLUTIONS:
        raise ValueError(
            f"too short: the input turns {turned:.3g} revolutions from end to end{assumed}; a diagnosis needs "
            f"{MIN_INPUT_REVOLUTIONS:g} or more; record a longer motion"
        )
    steps = np.abs(np.diff(angle))
    moving = steps[steps > SLOW_SHARE * float(np.quantile(steps, 0.95))]
    step = float(np.quantile(moving, SPEED_QUANTILE))  # rad per sample
    limit = MAX_PHASE_STEP * pi
    if (phase := WAVE_ORDER * per_input * step) > limit:
        rate = 1.0 / record.step
        share = f"{MAX_PHASE_STEP:g} of half"
        allowed = f"{limit / tau * rate:.4g} Hz, {share} of the sample rate" if record.timed else f"{share} a period per sample"
        value = f"{phase / tau * rate:.4g} Hz" if record.timed else f"{phase / tau:.3g} periods per sample"
        raise ValueError(
            f"aliased: order 2 of the wave generator passes at {value} at the usual speed{assumed}; the limit is {allowed}; "
            f"record {phase / limit:.2g} times faster, or turn {phase / limit:.2g} times slower"
        )
