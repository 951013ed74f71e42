"""Diagnosis of one joint from recordings: lines against noise and against a baseline, the verdict, condition and life."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import nan, pi, sqrt
from typing import Any, Literal

import numpy as np

from strainwave import arguments
from strainwave.diagnose.baseline import BaselineComparison, baseline_of, compared
from strainwave.diagnose.detection import DETECTION_PROBABILITY, FALSE_ALARM, needed_signal_to_noise, threshold_of
from strainwave.diagnose.geometry import Geometry, misalignment_from_current
from strainwave.diagnose.health import CatalogueLife, HealthIndicator, HealthTrend, catalogue_life, condition, trend
from strainwave.diagnose.named_orders import NamedOrder, causes, name_of, named_orders
from strainwave.diagnose.refusals import JointRecording
from strainwave.diagnose.replicates import BOTH_DIRECTIONS, Cell, JointMotion, apart, cells_of, gear_lines, joint_motion
from strainwave.diagnose.response import error_response
from strainwave.diagnose.smallest_error import MAX_CATALOGUE_AMPLITUDE
from strainwave.files.gear_set import GearSet
from strainwave.files.typical_gear import RAD_PER_ARCMIN
from strainwave.messages import without_name
from strainwave.orders.lines import SpectrumLine
from strainwave.orders.torque_ripple import Ripple, ripple
from strainwave.presentation import Presented, Reported
from strainwave.spline_orders import WAVE_ORDER

Verdict = Literal["changed", "no change found", "insensitive", "not comparable", "lines found", "no line found"]

LOAD_LEVELS = 3  # of the size of the load, in the table of the wave generator's ripple
MIN_LOAD_SPREAD = 0.3  # of the load's root mean square [1], from which it has levels
WAVE_RESOLUTIONS = 1.5  # resolutions, by which a line differs at most from the order of the wave generator
MAX_OTHER_LINES = 6  # that are fitted in addition to the wave generator's


@dataclass(frozen=True)
class OrderAgainstNoise(Presented):
    """A named order of a recording, compared with its noise.

    Attributes:
        order: with its cause
        forward, backward: amplitude in each direction, in the unit of the column; None without such motion
        threshold: amplitude from which noise alone is less probable than the stated rate, over all orders of the recording; the
            larger one of both directions
        expected: amplitude by the kinematic error of the gear and the load of the recording; nan if it is not known
        error: kinematic error at the output that is detected with probability 0.9 [rad]; nan if it is not known
        needed: amplitude of this error
        detected: True if an amplitude is above the threshold
    """

    order: NamedOrder
    forward: Cell | None
    backward: Cell | None
    threshold: float
    expected: float
    error: float
    needed: float
    detected: bool


@dataclass(frozen=True)
class LoadCell:
    """Amplitude of the wave generator's ripple in one direction at one level of load."""

    direction: str
    low: float
    high: float
    amplitude: float
    sigma: float
    speed: float


@dataclass(frozen=True)
class WaveRipple(Presented):
    """Ripple of the wave generator, found without a ratio or at a given one.

    Attributes:
        order: per revolution of the shaft
        sigma: its standard deviation
        ratios: that the lines determine; empty if the ratio was given or the angle is that of the input
        false_alarm: probability that noise alone makes such a line
        cells: amplitude by direction and load
    """

    order: float
    sigma: float
    ratios: tuple[int, ...]
    false_alarm: float
    cells: tuple[LoadCell, ...]


@dataclass(frozen=True, eq=False)
class RunDiagnosis(Presented):
    """Diagnosis of one recording.

    Attributes:
        name: of the recording
        run: its columns
        ripple: lines found blind
        wave: ripple of the wave generator; None if none was found
        orders: named orders against noise; empty if the ratio is not known
        response: source of the amplitude per kinematic error, in words
        comparison: with the baseline; None without one
        verdict: in one or two words
        reason: of the verdict, in a sentence
        condition: health indicator; None without a comparison
        geometry: misalignment of the wave generator; None if it was not asked for or not determined
        revolutions: of the input, end to end; nan if the ratio is not known
        load: root mean square of the load, in the unit of the column
        causes: of the orders of the alarms, in words
        remarks: what to know of these numbers
    """

    name: str
    run: JointRecording
    ripple: Ripple
    wave: WaveRipple | None
    orders: tuple[OrderAgainstNoise, ...]
    response: str
    comparison: BaselineComparison | None
    verdict: Verdict
    reason: str
    condition: HealthIndicator | None
    geometry: Geometry | None
    revolutions: float
    load: float
    causes: tuple[str, ...]
    remarks: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Diagnosis(Presented, Reported):
    """Diagnosis of one joint.

    Attributes:
        joint: its name; empty if the files have one joint
        runs: of each recording
        refused: the reason why a recording cannot be used, by its name, which it does not contain
        baseline: names of the recordings of the baseline
        false_alarm: stated rate of false alarms of a recording
        gear: name of the gear; empty if none is given
        ratio: size of the ratio; nan if it is not known
        life: by the maker's formula; None if it is not determined
        trend: of the condition; None if it is not determined
        remarks: what was not determined, and why
    """

    joint: str
    runs: tuple[RunDiagnosis, ...]
    refused: Mapping[str, str]
    baseline: tuple[str, ...]
    false_alarm: float
    gear: str
    ratio: float
    life: CatalogueLife | None
    trend: HealthTrend | None
    remarks: tuple[str, ...]

    @property
    def alarms(self) -> int:
        """Number of recordings with an alarm."""
        return sum(each.verdict == "changed" for each in self.runs)


@dataclass(frozen=True)
class Question:
    """Settings of a diagnosis; what is not known or not asked for is None or empty.

    Attributes:
        ratio: its size
        orders: further orders per revolution of the input
        bearings: `sw.fault.WaveGeneratorBearing` with the geometry of bearings, whose orders are named
        false_alarm: stated rate of false alarms, over all tests of a recording
        hours: of operation, by the name of the recording
        threshold: of the health indicator, at which the gear is to be exchanged
        ramp_drive: drive whose misalignment is estimated from recordings that are ramps from its zero
    """

    gear_set: GearSet | None = None
    ratio: float | None = None
    orders: tuple[float, ...] = ()
    bearings: tuple[Any, ...] = ()
    false_alarm: float = FALSE_ALARM
    hours: Mapping[str, float] = field(default_factory=dict)
    threshold: float | None = None
    ramp_drive: GearSet | None = None

    @property
    def kinematics(self) -> Any:
        """Kinematics of the gear; None if it is not known."""
        return None if self.gear_set is None else self.gear_set.gear.kinematics

    def named_orders(self, run: JointRecording) -> tuple[NamedOrder, ...]:
        """Return the orders that the gear may have over the angle of a recording."""
        return named_orders(run, self.kinematics, self.orders, self.bearings)


def diagnosed(
    runs: Sequence[JointRecording],
    question: Question,
    *,
    baseline: Sequence[JointRecording] = (),
    joint: str = "",
    refused: Mapping[str, str] | None = None,
) -> Diagnosis:
    """Return the diagnosis of a joint.

    Args:
        runs: its recordings, in the order of time
        question: gear, rates and hours
        baseline: recordings of the same joint when it was healthy
        joint: its name
        refused: recordings that cannot be used, with the reasons

    Raises:
        ValueError: there is no recording, recordings are in different columns or over different shafts, or the hours do not
            match
    """
    arguments.probability("false_alarm", question.false_alarm)
    refused = dict(refused or {})
    if not runs:
        reasons = "; ".join(f"{name}: {why}" for name, why in refused.items())
        raise ValueError(reasons or "there is no recording to diagnose; give one or more")
    first = runs[0]
    for run in (*runs, *baseline):
        for what, one, other in (("column", first.column, run.column), ("shaft", first.side, run.side)):
            if one != other:
                raise ValueError(
                    f"{run.name}: {what} {other}, but {one} in {first.name}; recordings of one joint are compared in the same "
                    f"column over the same shaft: name them with --column, or diagnose them apart"
                )
    healthy = [joint_motion(run) for run in baseline]
    baseline_lines = [line for run in baseline for line in gear_lines(_blind(run))]
    done: list[RunDiagnosis] = []
    for run in runs:
        try:
            done.append(_run(run, question, healthy, baseline_lines))
        except ValueError as error:
            refused[run.name] = without_name(str(error), run.name)
    if not done:
        raise ValueError("; ".join(f"{name}: {why}" for name, why in refused.items()))
    remarks: list[str] = []
    if not baseline:
        remarks.append(
            "without a baseline lines are compared with noise and with the gear's expected values alone: a line is no fault, "
            "and its absence no proof of health; --baseline compares with recordings of the healthy joint"
        )
    life = _life(runs, question, remarks)
    return Diagnosis(
        joint,
        tuple(done),
        refused,
        tuple(run.name for run in baseline),
        question.false_alarm,
        "" if question.gear_set is None else question.gear_set.name,
        float("nan") if question.ratio is None else abs(question.ratio),
        life,
        _trend(done, question, remarks),
        tuple(remarks),
    )


def _blind(run: JointRecording) -> Ripple:
    return ripple(
        run.recording, run.column, angle=run.angle, side=run.side, ratio=run.ratio, rate=run.rate, other_angles=run.others
    )


def _run(
    run: JointRecording, question: Question, healthy: Sequence[JointMotion], baseline_lines: Sequence[float]
) -> RunDiagnosis:
    blind = _blind(run)
    motion = joint_motion(run)
    named = question.named_orders(run)
    orders, response = _against_noise(motion, named, blind, question)
    comparison, remarks = _compared(motion, blind, question, healthy, baseline_lines)
    alarms = (
        [_located(each.order, comparison, blind, motion, baseline_lines) for each in comparison.alarms] if comparison else []
    )
    name = name_of(*alarms[0], named) if alarms else ""
    verdict, reason = _verdict(orders, comparison, blind, name, bool(healthy), remarks, run.unit)
    geometry = _geometry(run, question, remarks)
    return RunDiagnosis(
        run.name,
        run,
        blind,
        _wave(motion, blind),
        orders,
        response,
        comparison,
        verdict,
        reason,
        None if comparison is None else condition(run.name, comparison),
        geometry,
        motion.span * run.per_input,
        motion.load,
        causes(alarms, run.per_input, question.kinematics, question.bearings),
        tuple(dict.fromkeys([*run.remarks, *blind.remarks, *remarks, *(() if comparison is None else comparison.remarks)])),
    )


def _geometry(run: JointRecording, question: Question, remarks: list[str]) -> Geometry | None:
    """Return the misalignment by a ramp of the drive; if there is none, add the reason to `remarks`."""
    if question.ramp_drive is None:
        return None
    try:
        return misalignment_from_current(run.recording, question.ramp_drive)
    except ValueError as error:
        remarks.append(f"no misalignment is estimated: {error}")
        return None


def _compared(
    motion: JointMotion, blind: Ripple, question: Question, healthy: Sequence[JointMotion], baseline_lines: Sequence[float]
) -> tuple[BaselineComparison | None, list[str]]:
    """Return the comparison with the baseline, or why there is none."""
    if not healthy:
        return None, []
    named = [each for each in question.named_orders(motion.run) if each.order <= blind.highest]
    multiples = {each.order for each in named if each.is_multiple}
    resolution = 1.0 / max(each.span for each in healthy)
    # a line is where it was found, also next to a whole order
    planned = apart([*baseline_lines, *(each.order for each in named)], resolution)
    own = apart([*planned, *gear_lines(blind)], resolution)[len(planned) :]
    ranked = [*(each for each in planned if each not in multiples), *own, *(each for each in planned if each in multiples)]
    searched = (blind.highest - blind.lowest) * max(blind.revolutions, 1.0)
    try:
        baseline = baseline_of(healthy, ranked)
    except ValueError as error:
        return None, [str(error)]
    new = [order for order in own if order in baseline.orders]
    return compared(baseline, motion, false_alarm=question.false_alarm, new=new, searched=searched), []


def _located(
    order: float, comparison: BaselineComparison, blind: Ripple, motion: JointMotion, baseline_lines: Sequence[float]
) -> tuple[float, float]:
    """Return where the line of an alarm is, and with what resolution.

    The blocks that were compared separate less than the recording. A line that is new and alone among what they do not
    separate is the one that changed: it is where the blind search found it in the whole recording.
    """
    near = [line for line in gear_lines(blind) if abs(line - order) < comparison.resolution]
    if len(near) == 1 and all(abs(line - near[0]) >= comparison.resolution for line in baseline_lines):
        return near[0], 1.0 / max(motion.span, 1e-300)
    return order, comparison.resolution


def _against_noise(
    motion: JointMotion, named: Sequence[NamedOrder], blind: Ripple, question: Question
) -> tuple[tuple[OrderAgainstNoise, ...], str]:
    """Return the named orders that the samples follow and the record separates, and the source of their response to errors."""
    followed = [each for each in named if each.order <= blind.highest]
    kept = set(apart([each.order for each in followed], 1.0 / max(motion.span, 1e-12)))
    separate = [each for each in followed if each.order in kept]
    if not separate:
        return (), ""
    (cells,) = cells_of(motion, [each.order for each in separate], np.zeros(len(motion.shaft.series), dtype=int))
    directions = zip(separate, *cells, strict=True)
    by_order = {each: (there, back) for each, there, back in directions if not (there is None and back is None)}
    tests = sum(cell is not None for both in by_order.values() for cell in both)
    of_error = [each.per_input for each in by_order if each.of_error]
    response = error_response(motion, of_error, question.gear_set, motion.run.ratio)
    law = None if question.gear_set is None else question.gear_set.gear.kinematic_error
    amplitudes = dict(zip(getattr(law, "order", ()), getattr(law, "amplitude", ()), strict=True))
    rows = []
    for each, both in by_order.items():
        there = [cell for cell in both if cell is not None]
        noisy = max(there, key=lambda cell: _threshold(cell, question.false_alarm, tests))
        threshold = _threshold(noisy, question.false_alarm, tests)
        needed = noisy.sigma * needed_signal_to_noise(DETECTION_PROBABILITY, question.false_alarm, noisy.freedom, tests)
        per_error = response.per_error.get(each.per_input, nan)
        rows.append(
            OrderAgainstNoise(
                each,
                both[0],
                both[1],
                threshold=threshold,
                expected=float(amplitudes.get(each.per_input, nan) * per_error),
                error=needed / per_error if per_error > 0.0 else nan,
                needed=needed,
                detected=any(cell.amplitude > threshold for cell in there),
            )
        )
    return tuple(rows), response.source


def _threshold(cell: Cell, false_alarm: float, tests: int) -> float:
    """Return the amplitude that noise alone exceeds with a probability in any of some tests."""
    return cell.sigma * sqrt(2.0 * threshold_of(false_alarm, 2, cell.freedom, tests))


def _verdict(
    orders: Sequence[OrderAgainstNoise],
    comparison: BaselineComparison | None,
    blind: Ripple,
    name: str,
    has_baseline: bool,
    remarks: Sequence[str],
    unit: str,
) -> tuple[Verdict, str]:
    """Return the verdict with its reason, which names the surest alarm; never that a gear is healthy."""
    if comparison is not None and comparison.alarms:
        worst = comparison.alarms[0]
        own = f" ({name})" if name else ""
        return "changed", (
            f"{len(comparison.alarms)} of {len(comparison.changes)} amplitudes differ from the baseline; the surest is order "
            f"{worst.order:.5g} {worst.direction}{own}: {worst.baseline:.3g} before, {worst.amplitude:.3g} now, probability "
            f"{worst.false_alarm:.1g} in a joint that did not change"
        )
    wave = next((each for each in orders if each.order.per_input == WAVE_ORDER), None)
    if wave is not None and wave.error > MAX_CATALOGUE_AMPLITUDE and not wave.detected:
        current = wave.needed * MAX_CATALOGUE_AMPLITUDE / wave.error
        return "insensitive", (
            f"only a kinematic error above {wave.error / RAD_PER_ARCMIN:.3g} arc minutes would be seen at this load and speed, "
            f"and gears may have {MAX_CATALOGUE_AMPLITUDE / RAD_PER_ARCMIN:g}, which makes {current:.3g} {unit} where "
            f"{wave.needed:.3g} {unit} are needed: a fault may be there; record under more load, longer or with less noise"
        )
    if comparison is not None and comparison.changes:
        sizes = [(each.limit, each.detectable, max(each.baseline, 1e-300)) for each in comparison.changes]
        low, seen = (100.0 * min(size[place] / size[2] for size in sizes) for place in (0, 1))
        return "no change found", (
            f"none of {len(comparison.changes)} amplitudes differs from the baseline by more than it varies; the smallest "
            f"change that would be an alarm is {low:.3g} % of an amplitude; from {seen:.3g} % on, a true change is one with "
            "probability 0.9"
        )
    if has_baseline:
        why = [*remarks, *(() if comparison is None else comparison.remarks)]
        return "not comparable", why[0] if why else "no block of the recording has conditions that the baseline contains"
    count = sum(line.kind in ("order", "either") and not line.joint for line in blind.lines)
    if count or any(each.detected for each in orders):
        lines = max(count, sum(each.detected for each in orders))
        return "lines found", f"{lines} {'line repeats' if lines == 1 else 'lines repeat'} with the angle of this joint"
    return "no line found", "no line stands out of the noise, which is no proof of health"


def _wave(motion: JointMotion, blind: Ripple) -> WaveRipple | None:
    """Return the ripple of the wave generator: of the lines of a blind search the one that is order 2 of the ratio."""
    own = [line for line in blind.lines if line.kind in ("order", "either") and not line.joint]
    line = _wave_line(own, motion, blind)
    if line is None:
        return None
    others = [each.order for each in own if each is not line][:MAX_OTHER_LINES]
    orders = apart([line.order, *others], 1.0 / motion.span)
    return WaveRipple(line.order, line.order_sigma, blind.concluded, line.false_alarm, _by_load(motion, orders))


def _wave_line(own: Sequence[SpectrumLine], motion: JointMotion, blind: Ripple) -> SpectrumLine | None:
    reach = WAVE_RESOLUTIONS / motion.span
    per_input = motion.run.per_input
    if motion.run.side == "input":
        wanted = [WAVE_ORDER]
    elif np.isfinite(per_input):
        wanted = [WAVE_ORDER * (per_input + shift) for shift in (0.0, 1.0, -1.0)]
    else:  # motors have combs of whole orders, too: a line that may be one of time is not taken for the wave generator's
        wanted = [WAVE_ORDER * (ratio + shift) for ratio in blind.concluded for shift in (0.0, 1.0, -1.0)]
        own = [line for line in own if line.kind == "order"]
    near = [line for line in own if any(abs(line.order - order) <= max(reach, 3.0 * line.order_sigma) for order in wanted)]
    return max(near, key=lambda line: line.evidence, default=None)


def _by_load(motion: JointMotion, orders: Sequence[float]) -> tuple[LoadCell, ...]:
    """Return the amplitude of the first order in each direction at each level of the load."""
    shaft = motion.shaft
    size, moving = np.abs(shaft.load), shaft.weight > 0.5
    is_varied = float(np.std(size[moving])) > MIN_LOAD_SPREAD * max(motion.load, 1e-300) if moving.any() else False
    levels = LOAD_LEVELS if is_varied else 1
    edges = np.quantile(size[moving] if moving.any() else size, np.linspace(0.0, 1.0, levels + 1))
    places = np.clip(np.searchsorted(edges, size, side="right") - 1, 0, levels - 1)
    kinds = [(name, sign, level) for name, sign in BOTH_DIRECTIONS for level in range(levels)]
    parts = [(shaft.own.sense == sign) & (places == level) for _, sign, level in kinds]
    (cells,) = cells_of(motion, orders, np.zeros(len(size), dtype=int), parts)
    return tuple(
        LoadCell(name, float(edges[level]), float(edges[level + 1]), cell[0].amplitude, cell[0].sigma, cell[0].speed)
        for (name, _, level), cell in zip(kinds, cells, strict=True)
        if cell[0] is not None
    )


# ---- Condition and life -----------------------------------------------------------------------------------------------


def _trend(done: Sequence[RunDiagnosis], question: Question, remarks: list[str]) -> HealthTrend | None:
    if question.threshold is None:
        return None
    if not question.hours:
        raise ValueError("--threshold needs the hours of operation of each recording: add --hours, one number for each")
    judged = [run for run in done if run.condition is not None]
    hours = [question.hours[run.name] for run in judged]
    try:
        return trend(hours, [run.condition.indicator for run in judged if run.condition], question.threshold)
    except ValueError as error:
        remarks.append(f"no trend: {error}")
        return None


def _life(runs: Sequence[JointRecording], question: Question, remarks: list[str]) -> CatalogueLife | None:
    """Return the life by the maker's formula, with torque and speed of all recordings."""
    if question.gear_set is None or question.ratio is None:
        return None
    turned = cubed = lasted = 0.0
    for run in runs:
        torque = _output_torque(run, question)
        if torque is None or "time" not in run.recording:
            remarks.append(f"no life by the maker's formula: {run.name} has no torque at the output or no time")
            return None
        time = run.recording.time
        speed = np.abs(np.gradient(run.recording.values(run.angle, "rad"), time)) * run.per_input
        turned += float(np.trapezoid(speed, time))
        cubed += float(np.trapezoid(speed * np.abs(torque) ** 3, time))
        lasted += float(time[-1] - time[0])
    try:
        return catalogue_life(
            question.gear_set,
            average_torque=float(np.cbrt(cubed / turned)),
            average_speed=turned / lasted * 60.0 / (2.0 * pi),
            hours=max(question.hours.values(), default=0.0),
        )
    except ValueError as error:
        remarks.append(f"no life by the maker's formula: {error}")
        return None


def _output_torque(run: JointRecording, question: Question) -> np.ndarray | None:
    """Return the torque at the output [N.m]; of a motor's torque or current it contains the friction of the input."""
    ratio = question.ratio
    if ratio is None or question.gear_set is None:
        return None
    if "joint_torque" in run.recording:
        return run.recording.values("joint_torque", "N.m")
    if "input_torque" in run.recording:
        return run.recording.values("input_torque", "N.m") * abs(ratio)
    constant = getattr(question.gear_set.motor, "torque_constant", None)
    if "current" in run.recording and constant:
        return run.recording.values("current", "A") * float(constant) * abs(ratio)
    return None
