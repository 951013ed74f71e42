"""Report of the orders in recordings: a page, lines for a terminal, and the numbers as files."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from importlib import metadata
from itertools import pairwise
from math import isfinite, tau
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.files.recording import Recording
from strainwave.orders.lines import SpectrumLine
from strainwave.orders.measured import OrdersFound
from strainwave.orders.ring_modes import RingModes, draw_modes, words_of
from strainwave.orders.run_up import RunUp
from strainwave.orders.torque_ripple import Ripple, draw_spectrum
from strainwave.orders.two_encoders import TransmissionError, draw_error
from strainwave.presentation import PAGE_WIDTH
from strainwave.report import figures
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import results_json
from strainwave.typeset import number, quantity, uncertain, uncertain_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STRIP_LETTERS = 72  # of a spectrum on a terminal
STRIP_HEIGHTS = " ▁▂▃▄▅▆▇█"
RAD_PER_MICRORADIAN = 1e-6


def orders_report(
    found: Sequence[OrdersFound], provenance: Provenance | None = None, together: OrdersFound | None = None
) -> str:
    """Return the page, as one HTML file that needs nothing else.

    Args:
        found: of each recording
        provenance: command, date and files of the page, if they are to be shown
        together: of all recordings together; first on the page

    Returns:
        HTML; the same for the same arguments
    """
    recordings = [_section(each, place) for place, each in enumerate(_all(together, found))]
    return render("orders.html.jinja", {"recordings": recordings}, provenance)


def _all(together: OrdersFound | None, found: Sequence[OrdersFound]) -> list[OrdersFound]:
    return [*found] if together is None else [together, *found]


def _section(found: OrdersFound, place: int) -> dict[str, Any]:
    error, ripple = found.transmission, found.ripple
    return {
        "name": found.name,
        "error": None if error is None else _error(error, f"error-{place}"),
        "ripple": None
        if ripple is None
        else {
            "title": f"{ripple.column.replace('_', ' ')} over the angle of the {ripple.side}",
            "facts": _facts(ripple),
            "lines": [_line(each, ripple) for each in ripple.lines],
            "scaled": ripple.side == "output" and any(isfinite(each.per_input) for each in ripple.lines),
            "concluded": _concluded(ripple),
            "candidates": [_candidate(each.ratio, each.share, each.matched) for each in ripple.candidates],
            "spectrum": spectrum_figure(ripple, f"spectrum-{place}"),
            "map": map_figure(ripple, f"map-{place}"),
        },
        "run_up": [] if found.run_up is None else list(_run_up_words(found.run_up)),
        "modes": [] if found.modes is None else list(_modes_words(found.modes)),
        "modes_figure": "" if found.modes is None or not found.modes.orders else modes_figure(found.modes, f"modes-{place}"),
        "remarks": _remarks(found),
    }


def _error(error: TransmissionError, name: str) -> dict[str, Any]:
    return {
        "ratio": _ratio(error),
        "lost": _quantity(error.lost_motion),
        "windup": _quantity(error.windup),
        "frequency": _quantity(error.natural_frequency),
        "damping": _quantity(error.damping_ratio),
        "noise": quantity(error.noise, "rad"),
        "turns": number(error.revolutions, 4),
        "orders": [
            {
                "order": number(each.order),
                "shaft": each.shaft,
                "amplitude": uncertain(each.amplitude / RAD_PER_MICRORADIAN, each.amplitude_sigma / RAD_PER_MICRORADIAN),
                "phase": uncertain(each.phase, each.phase_sigma),
                "alarm": _chance(each.false_alarm),
                "state": "significant" if each.significant else "within noise",
            }
            for each in error.orders
        ],
        "figure": error_figure(error, name),
        "over_angle": turn_figure(error, f"{name}-turn"),
    }


def _quantity(measured: Any) -> str:
    return "" if measured is None else uncertain_quantity(measured.value, measured.sigma, measured.unit)


def _chance(probability: float) -> str:
    return "< 10⁻⁹" if probability < 1e-9 else number(probability, 2)


def _facts(ripple: Ripple) -> dict[str, str]:
    facts = {
        "Turned": f"{number(ripple.revolutions, 4)} revolutions from end to end, {number(ripple.turned, 4)} to and fro",
        "Resolution": f"{number(ripple.resolution, 3)} per revolution: orders that are closer are one line",
        "Looked for": f"orders {number(ripple.lowest, 3)} to {number(ripple.highest, 4)}",
    }
    if ripple.ratio is not None:
        facts["Ratio"] = number(ripple.ratio)
    return facts


def _line(line: SpectrumLine, ripple: Ripple) -> dict[str, str]:
    order = uncertain(line.order, line.order_sigma) if line.kind in ("order", "either") else ""
    return {
        "kind": _kind(line),
        "order": order,
        "per_input": number(line.per_input, 5) if isfinite(line.per_input) and ripple.side == "output" and order else "",
        "frequency": f"{number(line.frequency, 4)} Hz" if isfinite(line.frequency) else "",
        "amplitude": uncertain_quantity(line.amplitude, line.sigma, ripple.unit),
        "forward": quantity(line.forward, ripple.unit) if isfinite(line.forward) else "",
        "backward": quantity(line.backward, ripple.unit) if isfinite(line.backward) else "",
        "alarm": _chance(line.false_alarm),
        "parts": ", ".join(_parts(line, ripple.unit)),
    }


def _kind(line: SpectrumLine) -> str:
    """Return what a line repeats with, in words."""
    others = ["time" if name == "time" else f"joint {name}" for name in line.rivals]
    if line.kind == "joint":
        return f"order {number(line.order, 5)} of joint {line.joint}"
    return f"{' or '.join(['order', *others] if line.kind == 'either' else [line.kind])} line"


def line_words(line: SpectrumLine) -> str:
    """Return a line of a spectrum in words, as `order line 2.00`."""
    return f"{_kind(line)}{_place(line)}"


def line_numbers(line: SpectrumLine) -> dict[str, Any]:
    """Return the numbers of a line by name, as results.json contains them."""
    names = (
        "kind", "joint", "rivals", "order", "order_sigma", "per_input", "frequency", "amplitude", "forward", "backward",
        "phase", "sigma", "false_alarm", "parts",
    )  # fmt: skip
    return {name: getattr(line, name) for name in names}


def _parts(line: SpectrumLine, of: str) -> Iterator[str]:
    """Yield the parts of a line, the largest first; parts that noise explains are left out."""
    words = {"constant": "constant", "direction": "with the direction", "load": "with the load"}
    for part in sorted(line.parts, key=lambda each: -each.amplitude):
        if part.false_alarm < 0.01:
            yield f"{words.get(part.name, 'with the speed squared')} {quantity(part.amplitude, of)}"


def _candidate(ratio: int, share: float, matched: Sequence[tuple[float, float]]) -> dict[str, str]:
    lines = ", ".join(f"{number(order, 5)} as order {number(of, 2)}" for order, of in matched)
    return {"ratio": str(ratio), "share": f"{number(100.0 * share, 2)} %", "lines": lines}


def _remarks(found: OrdersFound) -> list[str]:
    remarks = [*found.remarks]
    for part in (found.transmission, found.ripple, found.modes):
        remarks += [] if part is None else [each for each in part.remarks if each not in remarks]
    return remarks


# ---- On a terminal ---------------------------------------------------------------------------------------------------


def orders_summary(found: Sequence[OrdersFound], together: OrdersFound | None = None) -> str:
    """Return the results as lines of text; of recordings together without each of them, whose lines are on the page."""
    if together is not None:
        shared = [remark for remark in _remarks(found[0]) if all(remark in _remarks(each) for each in found[1:])]
        single = f"the results of each recording are in report.html{', with its other notes' if shared else ', with its notes'}"
        found = [replace(together, remarks=(*together.remarks, *(f"of each recording: {each}" for each in shared), single))]
    lines: list[str] = []
    for each in found:
        lines += ["", each.name] if lines else [each.name]
        lines += [] if each.transmission is None else _error_lines(each.transmission)
        lines += [] if each.ripple is None else _ripple_lines(each.ripple)
        lines += [] if each.run_up is None else [f"  run-up: {text}" for text in _run_up_words(each.run_up)]
        for text in [] if each.modes is None else _modes_words(each.modes):
            lines += textwrap.wrap(f"  over the speed: {text}", PAGE_WIDTH, subsequent_indent="    ")
        for remark in _remarks(each):
            lines += textwrap.wrap(f"  note: {remark}", PAGE_WIDTH, subsequent_indent="    ")
    return "\n".join(lines).replace("\N{NO-BREAK SPACE}", " ")


def _error_lines(error: TransmissionError) -> Iterator[str]:
    yield f"  ratio {_ratio(error)}"
    if error.orders:
        yield f"  kinematic error, over {number(error.revolutions, 4)} revolutions of the input:"
    for each in error.orders:
        if each.significant:
            amplitude = uncertain(each.amplitude / RAD_PER_MICRORADIAN, each.amplitude_sigma / RAD_PER_MICRORADIAN)
            shaft = "" if each.shaft == "input" else f" ({each.shaft})"
            phase = uncertain(each.phase, each.phase_sigma)
            yield f"    order {number(each.order, 6)}{shaft}: {amplitude} µrad, phase {phase} rad"
    if missing := [number(each.order, 5) for each in error.orders if not each.significant]:
        yield f"    within noise: orders {', '.join(missing)}"
    if error.lost_motion is not None:
        yield f"  lost motion, backward against forward: {_quantity(error.lost_motion)}"
    if error.windup is not None:
        yield f"  wind-up: {_quantity(error.windup)}"
    if error.natural_frequency is not None:
        yield f"  output vibrates at {_quantity(error.natural_frequency)} with the input held"


def _ratio(error: TransmissionError) -> str:
    """Return the ratio used and that of the angles, in words."""
    measured = uncertain(error.ratio.value, error.ratio.sigma)
    if error.ratio.in_joint_units and not error.orders:
        return f"of the angles {measured}: both are counted in joint units"
    return f"{number(error.ratio.used, 9)} (measured {measured})"


def _ripple_lines(ripple: Ripple) -> Iterator[str]:
    per = "revolution" + (" of the input" if ripple.side == "input" else " of the output")
    yield f"  ripple in {ripple.column.replace('_', ' ')}, orders per {per}:"
    yield f"    {_strip(ripple)}"
    low, high = number(ripple.lowest, 3), number(ripple.highest, 4)
    yield f"    {low}{high:>{STRIP_LETTERS - len(low)}}"
    for line in ripple.lines:
        place = _place(line)
        text = f"    {_kind(line)}{place}: {uncertain_quantity(line.amplitude, line.sigma, ripple.unit)}"
        if isfinite(line.forward + line.backward) and line.kind != "time":
            text += f"; forward {quantity(line.forward, ripple.unit)}, backward {quantity(line.backward, ripple.unit)}"
        if parts := list(_parts(line, ripple.unit)):
            text += f"; parts: {', '.join(parts)}"
        yield from textwrap.wrap(text, PAGE_WIDTH, subsequent_indent="      ")
    if not ripple.lines:
        yield "    no line stands out of the noise"
    if ripple.concluded:
        yield f"  ratio from these lines: {_concluded(ripple)}"
    elif ripple.side == "output" and ripple.ratio is None:
        yield "  ratio from these lines: none concluded"


def _run_up_words(passing: RunUp) -> Iterator[str]:
    """Yield orders, resonance and fixed frequencies of a run-up in words."""
    for each in passing.orders:
        largest = f"{uncertain_quantity(each.largest, each.sigma, 'm/s2')} at {number(each.speed * 30.0 / np.pi, 4)} 1/min"
        away = uncertain_quantity(each.amplitude, each.sigma, "m/s2")
        yield f"order {number(each.order, 5)} of the shaft: {away} away from the resonance, at most {largest}"
    if isfinite(passing.frequency):
        frequency = uncertain_quantity(passing.frequency, passing.frequency_sigma, "Hz")
        yield f"resonance at {frequency}, damping ratio {uncertain(passing.damping, passing.damping_sigma)}"
    for place, size, sigma in passing.lines:
        yield f"fixed frequency {number(place, 5)} Hz: {uncertain_quantity(size, sigma, 'm/s2')}, no order of the shaft"


def _modes_words(modes: RingModes) -> Iterator[str]:
    """Yield the modes that orders pass, and the bearings that explain the others, in words."""
    for mode in modes.modes:
        yield f"mode at {words_of(mode)}"
    if not modes.modes:
        yield "no mode is determined"
    if modes.bearing is not None:
        yield f"bearing: {modes.bearing._headline()}"


def _concluded(ripple: Ripple) -> str:
    """Return the ratio that the lines determine, with its probability; empty without one."""
    share = sum(each.share for each in ripple.candidates if each.ratio in ripple.concluded)
    return f"{' or '.join(map(str, ripple.concluded))} ({number(100.0 * share, 3)} %)" if ripple.concluded else ""


def _place(line: SpectrumLine) -> str:
    """Return the order of a line, its frequency, or both if the record does not separate them; of another joint nothing."""
    order, frequency = uncertain(line.order, line.order_sigma), f"{number(line.frequency, 4)} Hz"
    if line.kind == "joint":
        return ""
    if line.kind == "time" and isfinite(line.frequency):
        return f" {frequency}"
    return f" {order} or {frequency}" if "time" in line.rivals and isfinite(line.frequency) else f" {order}"


def _strip(ripple: Ripple) -> str:
    """Return the spectrum as one row of blocks, which are full from ten times the amplitude that a line needs."""
    over = ripple.spectrum["amplitude"] / ripple.spectrum["threshold"]
    places = np.linspace(0, len(over), STRIP_LETTERS + 1).astype(int)
    peaks = [float(over[low : max(high, low + 1)].max()) for low, high in pairwise(places.tolist())]
    heights = [0 if peak < 1.0 else 1 + min(int(7.0 * np.log10(peak)), 7) for peak in peaks]
    return "".join(STRIP_HEIGHTS[height] if height else "·" for height in heights)


# ---- As files --------------------------------------------------------------------------------------------------------


def orders_files(
    found: Sequence[OrdersFound], provenance: Provenance | None = None, together: OrdersFound | None = None
) -> dict[str, str | bytes]:
    """Return the numbers as JSON, spectra and curves as CSV, and last the page, by file name."""
    results = [_results(each) for each in _all(together, found)]
    files: dict[str, str | bytes] = {"results.json": results_json({"recordings": results})}
    stems = [Path(each.name).stem for each in found]
    for place, (each, stem) in enumerate(zip(found, stems, strict=True)):
        name = stem if stems.count(stem) == 1 else f"{stem}-{place + 1}"
        if each.transmission is not None:
            files[f"{name}-error.csv"] = _csv(each.transmission.curves)
        if each.ripple is not None:
            files[f"{name}-spectrum.csv"] = _csv(each.ripple.spectrum)
    return files | {"report.html": orders_report(found, provenance, together)}


def _results(found: OrdersFound) -> dict[str, Any]:
    def members_of(value: Any) -> dict[str, Any]:
        members = {each.name: getattr(value, each.name) for each in fields(value)}
        return {name: member for name, member in members.items() if not isinstance(member, Recording)}

    ripple, error = found.ripple, found.transmission
    law = None if error is None else error.law
    return {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "name": found.name,
        "two_encoders": None if error is None else members_of(error),
        "law": None if law is None else {name: list(getattr(law, name)) for name in ("order", "amplitude", "phase")},
        "ripple": None if ripple is None else {**members_of(ripple), "lines": [line_numbers(each) for each in ripple.lines]},
        "run_up": None if found.run_up is None else members_of(found.run_up),
        "modes": None if found.modes is None else found.modes.to_dict(),
        "remarks": _remarks(found),
    }


def _csv(recording: Recording) -> bytes:
    with TemporaryDirectory() as folder:
        path = Path(folder, "table.csv")
        recording.to_csv(path)
        return path.read_bytes()


# ---- Figures ---------------------------------------------------------------------------------------------------------


TURN_BINS = 60  # of a revolution, over which samples are averaged
TIME_BLOCKS = 40  # of time, in the map
ORDER_CELLS = 90  # of the order, in the map
SHADE_LIMITS = (0.25, 0.45, 0.7, 1.0)  # of a cell, over the largest amplitude
MIN_SPEED_SPREAD = 0.1  # of the speed, above which a map shows more than the spectrum
MIN_BLOCK_SAMPLES = 8  # samples of a block that can show anything


def spectrum_figure(ripple: Ripple, name: str) -> str:
    """Return the figure of amplitude over order, with floor, threshold and lines."""
    return figures.inline(
        lambda figure: draw_spectrum(figure, ripple), (FIGURE_WIDTH, 3.0), name, "Amplitude of ripple over its order"
    )


def map_figure(ripple: Ripple, name: str) -> str:
    """Return the figure of order against time; empty if the speed is constant, no time is known, or the samples are too few."""
    curves = ripple.curves
    if "time" not in curves or not ripple.lines:
        return ""
    speed = np.abs(curves["speed"])
    if float(np.std(speed)) < MIN_SPEED_SPREAD * float(np.mean(speed)):
        return ""
    drawn = [line.order for line in ripple.lines if line.kind != "joint" and line.order <= ripple.highest * 1.01]
    highest = min(ripple.highest, 1.3 * max(drawn, default=ripple.highest))
    order = np.linspace(ripple.lowest, highest, ORDER_CELLS)
    wave = curves["series"] - curves["smooth"]
    edges = np.linspace(0, len(wave), TIME_BLOCKS + 1).astype(int)
    blocks = [slice(low, high) for low, high in pairwise(edges.tolist()) if high - low >= MIN_BLOCK_SAMPLES]
    if not blocks:
        return ""
    rows = []
    for block in blocks:
        window = np.hanning(block.stop - block.start)
        turned = np.exp(-1j * np.outer(order, curves["angle"][block]))
        rows.append(2.0 / window.sum() * np.abs(turned @ (window * (wave[block] - wave[block].mean()))))
    amplitude = np.array(rows)
    middle = np.array([float(curves["time"][block].mean()) for block in blocks])
    share = np.minimum(amplitude / np.quantile(amplitude, 0.995), 1.0)  # where friction turns over, all orders are large

    def draw(figure: Figure) -> None:
        axes, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.6, 1.0))
        for low, high in zip(SHADE_LIMITS, (*SHADE_LIMITS[1:], 1.1), strict=True):
            row, column = np.nonzero((share >= low) & (share < high))
            axes.plot(middle[row], order[column], "s", color=LIGHT["measured"], alpha=low, markersize=2.6, markeredgewidth=0.0)
        marks.curve(below, curves["time"], curves["speed"], color=LIGHT["ink"], linewidth=0.8)
        axes.set_ylim(ripple.lowest, highest)
        marks.label_axes(axes, f"order per revolution of the {ripple.side}", "1")
        marks.label_axes(below, "speed", "rad/s", "time", "s")

    return figures.inline(draw, (FIGURE_WIDTH, 3.6), name, "Amplitude of ripple over order and time")


def error_figure(error: TransmissionError, name: str) -> str:
    """Return the figure of the transmission error over the record, its orders and its residual."""
    return figures.inline(
        lambda figure: draw_error(figure, error), (FIGURE_WIDTH, 3.6), name, "Transmission error, kinematic error and residual"
    )


def modes_figure(modes: RingModes, name: str) -> str:
    """Return the figure of the amplitudes of orders over the speed, with the model."""
    return figures.inline(
        lambda figure: draw_modes(figure, modes), (FIGURE_WIDTH, 5.0), name, "Amplitudes of orders over the speed, and modes"
    )


def turn_figure(error: TransmissionError, name: str) -> str:
    """Return the figure of the kinematic error over a revolution of the input, with the residual of the samples."""
    law = error.law
    turn = np.linspace(0.0, 1.0, 400)
    angle, residual = error.curves["input_angle"], error.curves["residual"]
    bins = ((angle / tau) % 1.0 * TURN_BINS).astype(int) % TURN_BINS
    counts = np.bincount(bins, minlength=TURN_BINS)
    measured = np.bincount(bins, law.error(angle) + residual, TURN_BINS)[counts > 0] / counts[counts > 0]
    middle = ((np.arange(TURN_BINS) + 0.5) / TURN_BINS)[counts > 0]

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.plot(middle, measured, "o", color=LIGHT["measured"], markersize=2.8, label="mean of the samples")
        axes.plot(turn, law.error(tau * turn), color=LIGHT["model"], label="significant orders")
        marks.label_axes(axes, "kinematic error", "rad", "revolution of the input", "1")
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 2.8), name, "Kinematic error over a revolution of the input")
