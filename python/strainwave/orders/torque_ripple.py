"""Ripple of a gear, blind: order lines in the torque or current of a joint, without a second encoder and without a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import tau
from typing import TYPE_CHECKING, Literal

import numpy as np

from strainwave import arguments, typeset
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.messages import listed
from strainwave.orders.comb import (
    MIN_LINE_ORDER,
    STRAIN_WAVE_RATIOS,
    RatioCandidate,
    candidates,
    conclusive,
    lowest_usable,
    usable_lines,
)
from strainwave.orders.lines import (
    MERGE_PERIODS,
    MIN_PERIODS,
    LinePart,
    LineSearch,
    SpectrumLine,
    find_lines,
    waves,
    weighed_fit,
)
from strainwave.orders.smooth_part import Moving, shaft_of
from strainwave.orders.turning import Evenly
from strainwave.presentation import Pictured, Reported, Row, counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Side = Literal["input", "output"]

MIN_RATIO = float(STRAIN_WAVE_RATIOS[0])  # of strain wave gears that makers offer
TYPICAL_RATIO = 100.0
MAX_RATIO = 161.0
MAX_INPUT_ORDER = 20.0  # order of the input up to which is looked, without a limit given
MAX_OUTPUT_ORDER = 40.0  # times the ratio, or 100 if it is not known: pole pairs and slots of the motor
MAX_ORDER = 1e5  # that may be asked for: more than the teeth of any gear
MAX_PHASE_STEP = 0.8  # half turns of a line between two samples at the usual speed
MIN_SPREAD = 0.1  # relative spread of speed or load [1], from which ripple is separated by it
MAX_CHANCE_IN_MOTION = 1e-6  # that noise alone makes an order of the angle: removing one that is none costs ripple
MIN_INPUT_ORDER = 0.5  # slower ripple is not separated from friction and gravity
MAX_SAMPLES = 2**19  # that are looked at
MIN_GEAR_PERIODS = 3.0  # periods of the slowest order, that a record needs


@dataclass(frozen=True, eq=False)
class Ripple(ComparedByFields, Pictured, Reported):
    """Order lines in torque or current.

    Attributes:
        column: in which they were looked for
        side: whose angle it is
        unit: of the amplitudes
        lines: the strongest evidence first
        candidates: ratios that explain the lines, the most probable first; none if the ratio is known, the angle is that of the
            input, or no line is surely one of this joint
        concluded: the ratio that the lines determine, or two neighbours: one gear with either spline fixed; else empty
        ratio: size of the ratio, if it was given
        revolutions: of the shaft, end to end
        turned: all of its motion, to and fro, in revolutions
        resolution: two orders that differ by less are one line [1]
        lowest, highest: order that was looked for
        spectrum: columns order, amplitude, floor (its mean by noise alone, in one direction) and threshold (what a line needs
            to be found)
        curves: angle, series, smooth part, residual, and time where it is known
        remarks: what to know of these numbers, in words

    >>> import numpy as np
    >>> import strainwave as sw
    >>> q = 1.5 * np.sin(np.linspace(0.0, 20.0, 4000))
    >>> torque = 4.0 * np.sign(np.gradient(q)) + 0.25 * np.cos(200 * q) + np.random.default_rng(3).normal(0.0, 0.3, len(q))
    >>> record = sw.Recording({"output_angle": q, "torque": torque}, {"output_angle": "rad", "torque": "N.m"})
    >>> found = sw.orders.ripple(record, "torque")
    >>> [round(line.order) for line in found.lines], round(found.resolution, 1), found.concluded
    ([200], 2.1, (100, 101))
    """

    column: str
    side: Side
    unit: str
    lines: tuple[SpectrumLine, ...]
    candidates: tuple[RatioCandidate, ...]
    concluded: tuple[int, ...]
    ratio: float | None
    revolutions: float
    turned: float
    resolution: float
    lowest: float
    highest: float
    spectrum: Recording
    curves: Recording
    remarks: tuple[str, ...]

    def _headline(self) -> str:
        ratio = f", ratio {' or '.join(map(str, self.concluded))}" if self.concluded else ""
        lines = counted(len(self.lines), "line")
        return f"{lines} in {self.column} over {self.revolutions:.3g} revolutions of the {self.side}{ratio}"

    def _rows(self) -> Iterator[Row]:
        for line in self.lines:
            note = f"{line.kind}, by chance {typeset.number(line.false_alarm, 2)}"
            yield Row(f"order {typeset.number(line.order, 5)}", line.amplitude, self.unit, line.sigma, note)
        for each in self.candidates:
            yield Row(f"probability of ratio {each.ratio}", each.share, "1")
        yield Row("resolution of orders", self.resolution, "1")
        yield Row("orders looked for", (self.lowest, self.highest), "1")

    def plot(self) -> Figure:
        """Return a figure of amplitude over order, with the noise, what a line needs, and the lines found."""
        with marks.new_figure(3.2) as figure:
            draw_spectrum(figure, self)
        return figure


def draw_spectrum(figure: Figure, ripple: Ripple) -> None:
    """Draw amplitude over order, with noise, threshold and lines."""
    axes = figure.subplots()
    spectrum = ripple.spectrum
    order = spectrum["order"]
    marks.curve(axes, order, spectrum["amplitude"], color=LIGHT["measured"], linewidth=0.9, label="spectrum")
    marks.curve(axes, order, spectrum["floor"], color=LIGHT["muted"], linewidth=0.9, label="noise")
    marks.curve(axes, order, spectrum["threshold"], color=LIGHT["earlier"], linestyle="--", label="needed for a line")
    for kind, colour, mark in (("order", "model", "o"), ("time", "held-out", "x"), ("either", "earlier", "s")):
        lines = [line for line in ripple.lines if line.kind == kind and line.order <= ripple.highest]
        if lines:
            where = [line.order for line in lines], [line.amplitude for line in lines]
            axes.plot(*where, mark, color=LIGHT[colour], label={"either": "order or time"}.get(kind, f"{kind} line"))
    axes.set_ylim(bottom=0.0)
    marks.label_axes(axes, "amplitude", ripple.unit, f"order per revolution of the {ripple.side}", "1")
    marks.legend(figure, axes)


def ripple(
    recording: Recording,
    column: str,
    *,
    angle: str = "output_angle",
    side: Side = "output",
    ratio: float | None = None,
    highest: float | None = None,
    rate: float | None = None,
    false_alarm: float = 0.01,
    other_angles: Mapping[str, str] | None = None,
) -> Ripple:
    """Return the order lines in a torque or a current over the angle of a joint or a motor.

    Friction over speed, inertia and gravity are taken out. The rest is compared with the noise around each line, at the
    frequencies at which it passes. Each line is tested against the time, if the speed varies, and against the angles of other
    joints that move.

    Args:
        recording: with the column, an angle, and `time` if it is known; samples at equal distances in time
        column: torque or current, in any unit
        angle: column with the angle of the shaft, that may wrap at each revolution
        side: of the gear, on which this shaft is
        ratio: of the gear, if it is known; the sign does not matter
        highest: order up to which lines are looked for, at most 1e5; by default that of motors, or what samples allow
        rate: samples per second of a recording without time [Hz]
        false_alarm: largest probability of a line by noise alone, over all lines tested together
        other_angles: columns with the angles of other joints that move, by the name of the joint

    Returns:
        The lines with their orders [1] and amplitudes [unit of the column], the spectrum, and the ratios that explain the
        lines.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a column is missing, the shaft does not turn far enough, or samples are too far apart for orders of gears

    >>> import strainwave as sw
    >>> time = np.arange(0.0, 30.0, 0.004)
    >>> q = 1.2 * np.sin(0.5 * time) + 0.3 * np.sin(1.3 * time)
    >>> noise = np.random.default_rng(3).normal(0.0, 0.3, len(time))
    >>> torque = 4.0 * np.sign(np.gradient(q)) + 10.0 * np.sin(q) + 0.25 * np.cos(200 * q) + noise
    >>> units = {"time": "s", "output_angle": "rad", "torque": "N.m"}
    >>> found = sw.orders.ripple(sw.Recording({"time": time, "output_angle": q, "torque": torque}, units), "torque")
    >>> [(line.kind, round(line.order), round(line.amplitude, 1)) for line in found.lines], found.candidates[0].ratio
    ([('order', 200, 0.3)], 100)
    """
    check_recording("recording", recording)
    arguments.text("column", column)
    arguments.one_of("side", side, ("input", "output"))
    false_alarm = arguments.probability("false_alarm", false_alarm)
    size = None if ratio is None else abs(arguments.ratio("ratio", ratio))
    per_input = 1.0 if side == "input" else size or np.nan
    taken_of = partial(shaft_of, recording, column, angle, others=other_angles or {}, rate=rate, count=MAX_SAMPLES)
    record, shaft = taken_of(per_input=per_input)
    lowest, top = _range(shaft, side, size, highest)
    _check_sampled(shaft, record, side, size, top, angle)
    if np.isnan(per_input) and (order := _order_of_the_motion(shaft, top)):
        record, shaft = taken_of(per_input=0.5 * order)  # order 2 of the input, the main one of a gear
    search = find_lines(shaft, lowest, top, false_alarm)
    revolutions = shaft.own.revolutions
    lines = tuple(_line(line, shaft, search, record, side, size) for line in search.lines)
    blind = side == "output" and size is None
    likely = candidates(search.lines, 1.0 / revolutions, top) if blind else ()
    remarks = [*record.remarks, *_remarks(shaft, search, record, top)]
    remarks += _ratio_remarks(search, likely, revolutions, top, shaft) if blind else []
    return Ripple(
        column=column,
        side=side,
        unit=recording.unit(column),
        lines=lines,
        candidates=likely,
        concluded=conclusive(likely),
        ratio=size,
        revolutions=revolutions,
        turned=float(np.abs(np.diff(shaft.own.angle)).sum()) / tau,
        resolution=1.0 / revolutions,
        lowest=lowest,
        highest=top,
        spectrum=_spectrum(search, recording.unit(column), false_alarm),
        curves=_curves(shaft, search, record, recording.unit(column)),
        remarks=tuple(remarks),
    )


def _order_of_the_motion(shaft: Moving, top: float) -> float | None:
    """Return the strongest order of a gear in the measured angle itself; None if there is none."""
    quick, weight = shaft.own.quick(shaft.own.angle, MIN_LINE_ORDER)
    if not weight.any():
        return None
    swinging = replace(shaft, shafts=(shaft.own,), series=quick, weight=weight / weight.max(), basis=np.ones((len(quick), 1)))
    lines = find_lines(replace(swinging, own_columns=1), MIN_LINE_ORDER, top, MAX_CHANCE_IN_MOTION).lines
    return lines[0].order if lines else None


def _range(shaft: Moving, side: Side, size: float | None, highest: float | None) -> tuple[float, float]:
    """Return the lowest and the highest order that are looked for."""
    lowest = max(MIN_PERIODS / shaft.own.revolutions, MIN_INPUT_ORDER * (1.0 if side == "input" else size or MIN_RATIO))
    if highest is not None:
        return lowest, arguments.number("highest", highest, brackets="(]", low=lowest, high=MAX_ORDER)
    if side == "input":
        return lowest, min(MAX_INPUT_ORDER, _sampled(shaft))
    return lowest, min(MAX_OUTPUT_ORDER * (size or TYPICAL_RATIO), _sampled(shaft))


def _sampled(shaft: Moving) -> float:
    """Return the highest order that the samples can follow at the usual speed."""
    swift = np.abs(shaft.own.speed[shaft.weight > 0.5])
    usual = float(np.median(swift)) if len(swift) else 0.0
    return MAX_PHASE_STEP * np.pi / usual if usual > 0.0 else np.inf


def _check_sampled(shaft: Moving, record: Evenly, side: Side, size: float | None, top: float, angle: str) -> None:
    """Raise ValueError for a record in which no order of a gear can be seen."""
    revolutions = shaft.own.revolutions
    gear = 2.0 if side == "input" else 2.0 * (size or MIN_RATIO)
    name = "order 2 of the wave generator" + ("" if side == "input" else f", {gear:g} per revolution of the output")
    name += "" if side == "input" or size else " in a gear of ratio 30, and higher in others"
    if top < gear:
        often = f"{1.0 / record.step:.3g} samples per second" if record.timed else "these samples"
        raise ValueError(
            f"{often} show orders up to {top:.3g} per revolution of {angle} at the speeds of this record; the main line of a "
            f"gear is {name}; record faster, or turn slower"
        )
    if revolutions * gear < MIN_GEAR_PERIODS:
        raise ValueError(
            f"{angle} turns {revolutions:.3g} revolutions: {revolutions * gear:.2g} periods of {name}; lines need "
            f"{MIN_GEAR_PERIODS:g} or more; turn further"
        )


def _line(
    line: SpectrumLine, shaft: Moving, search: LineSearch, record: Evenly, side: Side, size: float | None
) -> SpectrumLine:
    """Return a line with its frequency in Hz, its order of the input, and its parts."""
    by_ratio = np.nan if size is None or line.joint else line.order / size
    return replace(
        line,
        per_input=line.order if side == "input" else by_ratio,
        frequency=line.frequency / record.step if record.timed else np.nan,
        parts=_parts(line, shaft, search) if line.kind == "order" else (),
    )


def _parts(line: SpectrumLine, shaft: Moving, search: LineSearch) -> tuple[LinePart, ...]:
    """Regress a line on what it may grow with: nothing, direction, load, speed squared (physics of the current signature)."""
    weight = shaft.weight
    share = weight / max(float(np.sqrt(np.mean(weight**2))), 1e-300)
    growing = {"constant": np.ones_like(weight)}
    if len(shaft.own.senses(weight)) > 1:
        growing["direction"] = shaft.own.sense
    if float(np.std(shaft.load * share)) > MIN_SPREAD * float(np.std(shaft.series * share)):
        growing["load"] = shaft.load
    squared = shaft.own.speed**2
    if float(np.std(squared[weight > 0.5])) > MIN_SPREAD * float(np.mean(squared)):
        growing["speed squared"] = squared
    if len(growing) == 1:
        return ()
    sizes = {name: float(np.sqrt(np.average(each**2, weights=weight**2))) for name, each in growing.items()}
    phase = line.order * shaft.own.angle
    cosine, sine = weight * np.cos(phase), -weight * np.sin(phase)
    columns = np.stack([wave * each / sizes[name] for name, each in growing.items() for wave in (cosine, sine)], axis=1)
    shape = np.stack(waves(shaft, line), axis=1)
    values = [part for part in (line.wave_forward, line.wave_backward) if not np.isnan(part)]
    series = search.residual * weight + shape @ np.array([number for part in values for number in (part.real, part.imag)])
    coefficients, covariance = weighed_fit(columns, series, search.floor)
    parts = []
    for k, name in enumerate(growing):
        pair, within = coefficients[2 * k : 2 * k + 2], covariance[2 * k : 2 * k + 2, 2 * k : 2 * k + 2]
        evidence = float(pair @ np.asarray(np.linalg.pinv(within)) @ pair)
        alarm = min(1.0, len(search.lines) * len(growing) * float(np.exp(-0.5 * evidence)))
        parts.append(LinePart(name, float(np.hypot(*pair)), float(np.sqrt(0.5 * np.trace(within))), alarm))
    return tuple(parts)


def _spectrum(search: LineSearch, unit: str, allowed: float) -> Recording:
    """Return amplitude over order, its floor, and the amplitude at which a line is found."""
    spectrum = search.orders
    needed = spectrum.evidence_of(allowed, search.tested)
    columns = {"order": spectrum.place, "amplitude": spectrum.amplitude}
    columns |= {"floor": spectrum.noise * np.sqrt(np.pi / 2.0), "threshold": spectrum.noise * np.sqrt(2.0 * needed)}
    return Recording(columns, dict.fromkeys(columns, unit) | {"order": "1"}, "spectrum over the angle")


def _curves(shaft: Moving, search: LineSearch, record: Evenly, unit: str) -> Recording:
    columns = {"time": record.start + record.step * np.arange(len(record)), "angle": shaft.own.angle}
    columns |= {"series": shaft.series + shaft.smooth, "smooth": shaft.smooth, "residual": search.residual}
    columns["speed"] = shaft.own.speed / record.step
    units = {"time": "s", "angle": "rad", "series": unit, "smooth": unit, "residual": unit, "speed": "rad/s"}
    if not record.timed:
        for name in ("time", "speed"):
            del columns[name], units[name]
    return Recording(columns, units, "ripple")


def _remarks(shaft: Moving, search: LineSearch, record: Evenly, top: float) -> list[str]:
    remarks = []
    if shaft.outliers:
        far = "sample lies" if shaft.outliers == 1 else "samples lie"
        remarks.append(f"{shaft.outliers} {far} far outside of the others; outliers do not count")
    if any("time" in line.rivals for line in search.lines):
        remarks.append(
            "the speed is too constant to separate order lines from time lines (mains, resonances); a second run at another "
            "speed settles it"
        )
    if joints := sorted({rival for line in search.lines for rival in line.rivals if rival != "time"}):
        remarks.append(
            f"{_joints(joints)} moved in proportion to this one, so lines may be of either; record this joint while others rest"
        )
    if joints := sorted({line.joint for line in search.lines if line.kind == "joint"}):
        remarks.append(f"lines that repeat with the angle of {_joints(joints)} are not of this gear")
    if search.merged:
        remarks.append(
            f"{search.merged} weaker lines lie within {MERGE_PERIODS:g} times the resolution of stronger ones and are not "
            "listed: the stronger ones vary with speed or load"
        )
    if not record.timed:
        remarks.append("without time no frequency is known, and samples are taken to be at equal distances in time")
    beyond = [line for line in search.lines if line.kind == "time" and line.order > top]
    if beyond and top < _sampled(shaft):
        limit = min(1.1 * max(line.order for line in beyond), MAX_ORDER)
        remarks.append(
            f"{len(beyond)} time lines pass at orders {listed(f'{line.order:.0f}' for line in beyond)}, beyond the highest "
            f"order looked for, {top:.4g}: they may be orders of the motor; --highest {limit:.0f} looks for these"
        )
    if not search.lines:
        remarks.append("no line stands out of the noise; a longer record, slower motion or more load would lower the threshold")
    return remarks


def _joints(names: Sequence[str]) -> str:
    return f"joint {names[0]}" if len(names) == 1 else f"joints {listed(names)}"


def _ratio_remarks(
    search: LineSearch, likely: Sequence[RatioCandidate], revolutions: float, top: float, shaft: Moving
) -> list[str]:
    """Return remarks on the ratio: why none is concluded, or which other one is possible."""
    remarks = []
    slow = [line for line in search.lines if line.kind in ("order", "either") and line.order < lowest_usable(1.0 / revolutions)]
    if slow:
        limit = f"{lowest_usable(1.0 / revolutions):.3g}"
        hint = "" if len(shaft.shafts) > 1 else "; name the angles of other joints that move, with --column other_angles=…"
        remarks.append(
            f"lines below order {limit} do not count for the ratio: they come from gravity, inertia, "
            f"hysteresis and friction of all joints that move{hint}"
        )
    if top < 2.0 * MAX_RATIO:
        remarks.append(
            f"samples follow orders up to {top:.3g} per revolution at the usual speed: order 2 of a gear with a ratio above "
            f"{0.5 * top:.0f} lies beyond; record faster, or turn slower"
        )
    concluded = conclusive(likely)
    if len(concluded) == 2:
        remarks.append(
            f"ratio {concluded[0]} or {concluded[1]}: one gear with the circular spline or the flexspline fixed, whose lines "
            "this record does not separate; --ratio gives the right one"
        )
    elif likely and not concluded:
        ratios = listed(f"{candidate.ratio} ({100.0 * candidate.share:.2g} %)" for candidate in likely[:3])
        remarks.append(
            f"no ratio is concluded: the lines fit {ratios}; give --ratio, or turn further: orders are determined to "
            f"{1.0 / revolutions:.2g} per revolution"
        )
    elif search.lines and not usable_lines(search.lines, 1.0 / revolutions):
        remarks.append(
            "no ratio is concluded: no line is surely one of this joint; record this joint alone, at speeds that vary, and "
            "over more of a revolution"
        )
    return remarks
