"""Ripple of a gear, blind: order lines in the torque or current of a joint, without a second encoder and without a model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import tau
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.files.units import convert
from strainwave.orders.comb import Candidate, candidates
from strainwave.orders.floor import Floor
from strainwave.orders.lines import BESIDE, LOWEST, Found, Kind, Line, find_lines, waves, weighed_fit
from strainwave.orders.smooth_part import Moving, moving
from strainwave.orders.turning import Evenly, beginning, evenly, unwrapped

Array = NDArray[np.float64]
Side = Literal["input", "output"]

SMALLEST_RATIO = 30.0  # of strain wave gears that makers offer
LARGEST_RATIO = 161.0
INPUT_HIGHEST = 20.0  # order of the input up to which is looked, if nothing is said
OUTPUT_HIGHEST = 8.0  # times the ratio, or as much where that is not known as makes order 4 of the largest visible
MAX_ORDER = 1e5  # that may be asked for: more than the teeth of any gear
SAMPLED = 0.8  # of a half revolution of the line, that may lie between samples at a usual speed
VARIES = 0.1  # of the speed or the load, above which ripple is told apart by it
LEAST_ORDER = 0.5  # of the input: what repeats more slowly is not told from friction and gravity
LONGEST = 2**19  # samples that are looked at
PERIODS = 3.0  # of the slowest order, that a record needs


@dataclass(frozen=True)
class Part:
    """A share of a line that grows with something.

    Attributes:
        name: `constant` (cogging), `direction` (friction), `load` (kinematic error), `speed squared` (inertia)
        amplitude: at the root mean square of what it grows with, in the unit of the series
        sigma: its standard deviation
        false_alarm: probability that noise alone gives as much, over all parts of all lines
    """

    name: str
    amplitude: float
    sigma: float
    false_alarm: float


@dataclass(frozen=True)
class RippleLine:
    """A line in the spectrum over the angle.

    Attributes:
        kind: `order` follows the angle, `time` the time (mains, a resonance, a beat of the sampling); `either` where the speed
            is too constant to tell
        order: per revolution of the shaft whose angle it is; of a time line that at the usual speed
        order_sigma: its standard deviation by noise; a line whose phase changes with the speed, as near a resonance, moves by
            up to a tenth of the resolution more
        per_input: the same per revolution of the input; None where the ratio is not known
        frequency: at the usual speed [Hz]; None where neither time nor rate is known
        amplitude: the larger one of both directions, in the unit of the series
        forward, backward: of each direction; None without such motion
        phase: where the angle is 0 [rad], as of a cosine, in the direction with the larger amplitude
        sigma: standard deviation of the amplitude
        false_alarm: probability that noise alone makes such a line anywhere in the spectra
        parts: what it grows with, where the record tells
    """

    kind: Kind
    order: float
    order_sigma: float
    per_input: float | None
    frequency: float | None
    amplitude: float
    forward: float | None
    backward: float | None
    phase: float
    sigma: float
    false_alarm: float
    parts: tuple[Part, ...]


@dataclass(frozen=True, eq=False)
class Ripple(ComparedByFields):
    """Order lines in torque or current.

    Attributes:
        column: in which they were looked for
        side: whose angle it is
        unit: of the amplitudes
        lines: the strongest evidence first
        candidates: ratios that explain the lines, the most probable first; none where the ratio is known or the angle is that
            of the input
        ratio: size of the ratio, if it was given
        revolutions: of the shaft, end to end
        turned: all of its motion, to and fro, in revolutions
        resolution: two orders that differ by less are one line [1]
        lowest, highest: order that was looked for
        spectrum: columns order, amplitude, floor (its mean by noise alone, in one direction) and threshold (what a line needs
            to be found)
        curves: angle, series, smooth part, residual, and time where it is known
        remarks: what to know of these numbers, in words
    """

    column: str
    side: Side
    unit: str
    lines: tuple[RippleLine, ...]
    candidates: tuple[Candidate, ...]
    ratio: float | None
    revolutions: float
    turned: float
    resolution: float
    lowest: float
    highest: float
    spectrum: Recording
    curves: Recording
    remarks: tuple[str, ...]


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
) -> Ripple:
    """Order lines in a torque or a current over the angle of a joint or a motor.

    Friction over speed, inertia and gravity are taken out. What is left is compared with the noise around each line, at the
    frequencies at which it passes. Lines that follow the time, not the angle, are told apart, if the speed varies.

    Args:
        recording: with the column, an angle, and `time` if it is known; samples at equal distances in time
        column: torque or current, in any unit
        angle: column with the angle of the shaft, that may wrap at each revolution
        side: of the gear, on which this shaft is
        ratio: of the gear, if it is known; the sign does not matter
        highest: order up to which is looked, at most 1e5; what the samples allow, and gears show, if not given
        rate: samples per second of a recording without time [Hz]
        false_alarm: largest probability of a line by noise alone, over all lines tested together

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a column is missing, the shaft does not turn far enough, or samples are too far apart for orders of gears

    >>> import strainwave as sw
    >>> time = np.arange(0.0, 30.0, 0.004)
    >>> q = 1.2 * np.sin(0.5 * time) + 0.3 * np.sin(1.3 * time)
    >>> noise = np.random.default_rng(3).normal(0.0, 0.3, len(time))
    >>> torque = 4.0 * np.sign(np.gradient(q)) + 10.0 * np.sin(q) + 0.25 * np.cos(200 * q) + noise
    >>> units = {"time": "s", "output_angle": "rad", "torque": "N.m"}
    >>> found = sw.ripple(sw.Recording({"time": time, "output_angle": q, "torque": torque}, units), "torque")
    >>> [(line.kind, round(line.order), round(line.amplitude, 1)) for line in found.lines], found.candidates[0].ratio
    ([('order', 200, 0.3)], 100)
    """
    check_recording("recording", recording)
    arguments.text("column", column)
    arguments.one_of("side", side, ("input", "output"))
    false_alarm = arguments.probability("false_alarm", false_alarm)
    size = None if ratio is None else abs(arguments.ratio("ratio", ratio))
    record, told = _moved(recording, column, angle, rate)
    lowest, top = _range(told, side, size, highest)
    _check_sampled(told, record, side, size, top, angle)
    found = find_lines(told, lowest, top, false_alarm)
    revolutions = float(np.ptp(told.angle)) / tau
    lines = tuple(_line(each, told, found, record, side, size, len(found.lines)) for each in found.lines)
    guessed = candidates(found.lines, 1.0 / revolutions) if side == "output" and size is None else ()
    return Ripple(
        column=column,
        side=side,
        unit=recording.unit(column),
        lines=lines,
        candidates=guessed,
        ratio=size,
        revolutions=revolutions,
        turned=float(np.abs(np.diff(told.angle)).sum()) / tau,
        resolution=1.0 / revolutions,
        lowest=lowest,
        highest=top,
        spectrum=_spectrum(found, recording.unit(column), false_alarm),
        curves=_curves(told, found, record, recording.unit(column)),
        remarks=(*record.remarks, *_remarks(told, found, record, guessed, revolutions)),
    )


def _moved(recording: Recording, column: str, angle: str, rate: float | None) -> tuple[Evenly, Moving]:
    """A shaft and what drives it, evenly in time, of a long record the beginning; rows that were filled in do not count."""
    record = beginning(evenly(recording, [column, angle], rate), LONGEST)
    turned = unwrapped(angle, convert(record.columns[angle], recording.unit(angle), "rad"))
    if float(np.ptp(turned)) == 0.0:
        raise ValueError(f"{angle} does not change; orders need a shaft that turns")
    if float(np.ptp(record.columns[column])) == 0.0:
        raise ValueError(f"{column} does not change; there is no ripple in it")
    told = moving(turned, record.columns[column])
    return record, replace(told, weight=np.where(record.measured, told.weight, 0.0))


def _range(told: Moving, side: Side, size: float | None, highest: float | None) -> tuple[float, float]:
    """Orders between which is looked."""
    revolutions = float(np.ptp(told.angle)) / tau
    swift = np.abs(told.speed[told.weight > 0.5])
    usual = float(np.median(swift)) if len(swift) else 0.0
    sampled = SAMPLED * np.pi / usual if usual > 0.0 else np.inf
    lowest = max(LOWEST / revolutions, LEAST_ORDER * (1.0 if side == "input" else size or SMALLEST_RATIO))
    if highest is not None:
        return lowest, arguments.number("highest", highest, brackets="(]", low=lowest, high=MAX_ORDER)
    if side == "input":
        return lowest, min(INPUT_HIGHEST, sampled)
    return lowest, min(OUTPUT_HIGHEST * size if size else 4.5 * LARGEST_RATIO, sampled)


def _check_sampled(told: Moving, record: Evenly, side: Side, size: float | None, top: float, angle: str) -> None:
    """Refuses a record in which no order of a gear can be seen."""
    revolutions = float(np.ptp(told.angle)) / tau
    gear = 2.0 if side == "input" else 2.0 * (size or SMALLEST_RATIO)
    name = "order 2 of the wave generator" + ("" if side == "input" else f", {gear:g} per revolution of the output")
    name += "" if side == "input" or size else " in a gear of ratio 30, and higher in others"
    if top < gear:
        often = f"{1.0 / record.step:.3g} samples per second" if record.timed else "these samples"
        raise ValueError(
            f"{often} show orders up to {top:.3g} per revolution of {angle} at the speeds of this record; the main line of a "
            f"gear is {name}; record faster, or turn slower"
        )
    if revolutions * gear < PERIODS:
        raise ValueError(
            f"{angle} turns {revolutions:.3g} revolutions: {revolutions * gear:.2g} periods of {name}; lines need "
            f"{PERIODS:g} or more; turn further"
        )


def _line(line: Line, told: Moving, found: Found, record: Evenly, side: Side, size: float | None, count: int) -> RippleLine:
    both = {"forward": line.forward, "backward": line.backward}
    sizes = {name: None if np.isnan(value) else abs(value) for name, value in both.items()}
    larger = max(both, key=lambda name: sizes[name] or 0.0)
    per_input = line.order if side == "input" else None if size is None else line.order / size
    return RippleLine(
        kind=line.kind,
        order=line.order,
        order_sigma=line.order_sigma,
        per_input=per_input,
        frequency=line.frequency / record.step if record.timed else None,
        amplitude=line.amplitude,
        forward=sizes["forward"],
        backward=sizes["backward"],
        phase=float(np.angle(both[larger])),
        sigma=line.sigma,
        false_alarm=line.false_alarm,
        parts=_parts(line, told, found.floor, found.residual, count) if line.kind == "order" else (),
    )


def _parts(line: Line, told: Moving, floor: Floor, residual: Array, count: int) -> tuple[Part, ...]:
    """A line regressed on what it may grow with: nothing, direction, load, speed squared (physics of the current signature)."""
    weight = told.weight
    share = weight / max(float(np.sqrt(np.mean(weight**2))), 1e-300)
    growing = {"constant": np.ones_like(weight)}
    if np.any(told.sense > 0.0) and np.any(told.sense < 0.0):
        growing["direction"] = told.sense
    if float(np.std(told.load * share)) > VARIES * float(np.std(told.series * share)):
        growing["load"] = told.load
    squared = told.speed**2
    if float(np.std(squared[weight > 0.5])) > VARIES * float(np.mean(squared)):
        growing["speed squared"] = squared
    if len(growing) == 1:
        return ()
    sizes = {name: float(np.sqrt(np.average(each**2, weights=weight**2))) for name, each in growing.items()}
    phase = line.order * told.angle
    cosine, sine = weight * np.cos(phase), -weight * np.sin(phase)
    columns = np.stack([wave * each / sizes[name] for name, each in growing.items() for wave in (cosine, sine)], axis=1)
    shape = np.stack(waves(told, line), axis=1)
    values = [part for part in (line.forward, line.backward) if not np.isnan(part)]
    series = residual * weight + shape @ np.array([number for part in values for number in (part.real, part.imag)])
    coefficients, covariance = weighed_fit(columns, series, floor)
    parts = []
    for k, name in enumerate(growing):
        pair, within = coefficients[2 * k : 2 * k + 2], covariance[2 * k : 2 * k + 2, 2 * k : 2 * k + 2]
        evidence = float(pair @ np.asarray(np.linalg.pinv(within)) @ pair)
        alarm = min(1.0, count * len(growing) * float(np.exp(-0.5 * evidence)))
        parts.append(Part(name, float(np.hypot(*pair)), float(np.sqrt(0.5 * np.trace(within))), alarm))
    return tuple(parts)


def _spectrum(found: Found, unit: str, allowed: float) -> Recording:
    """Amplitude over order, its floor, and the amplitude at which a line would be found."""
    spectrum = found.orders
    needed = spectrum.evidence_of(allowed, found.tested)
    columns = {
        "order": spectrum.place,
        "amplitude": spectrum.amplitude,
        "floor": spectrum.noise * np.sqrt(np.pi / 2.0),
        "threshold": spectrum.noise * np.sqrt(2.0 * needed),
    }
    return Recording(columns, {"order": "1", "amplitude": unit, "floor": unit, "threshold": unit}, "spectrum over the angle")


def _curves(told: Moving, found: Found, record: Evenly, unit: str) -> Recording:
    columns = {"time": record.start + record.step * np.arange(len(record)), "angle": told.angle}
    columns |= {"series": told.series + told.smooth, "smooth": told.smooth, "residual": found.residual, "speed": told.speed}
    units = {"time": "s", "angle": "rad", "series": unit, "smooth": unit, "residual": unit, "speed": "rad/s"}
    columns["speed"] = told.speed / record.step
    if not record.timed:
        for name in ("time", "speed"):
            del columns[name], units[name]
    return Recording(columns, units, "ripple")


def _remarks(told: Moving, found: Found, record: Evenly, guessed: Sequence[Candidate], revolutions: float) -> list[str]:
    remarks = []
    if told.outliers:
        remarks.append(f"{told.outliers} samples lie far outside of the others and do not count")
    if any(line.kind == "either" for line in found.lines):
        remarks.append(
            "the speed is too constant to tell order lines from time lines (mains, resonances); a second run at another "
            "speed settles it"
        )
    if found.beside:
        remarks.append(
            f"{found.beside} weaker lines stand beside stronger ones, within {BESIDE:g} times the resolution, and are not "
            "listed: they say that these vary with speed or load"
        )
    if not record.timed:
        remarks.append("without time no frequency is told, and samples are taken to be at equal distances in time")
    if not found.lines:
        remarks.append("no line stands out of the noise; a longer record, slower motion or more load would lower the threshold")
    if guessed and guessed[0].share < 0.95:
        others = ", ".join(str(each.ratio) for each in guessed[1:4])
        remarks.append(
            f"the ratio is not settled: beside {guessed[0].ratio} there is {others}; give --ratio, or turn further: orders "
            f"are told to {1.0 / revolutions:.2g} per revolution"
        )
    return remarks
