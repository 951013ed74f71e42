"""Report of a diagnosis: a page, lines for a terminal, and the numbers as files."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from importlib import metadata
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave.diagnose.baseline import BaselineComparison, OrderChange
from strainwave.diagnose.diagnosis import Diagnosis, OrderAgainstNoise, RunDiagnosis, WaveRipple
from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.files.typical_gear import RAD_PER_ARCMIN
from strainwave.presentation import PAGE_WIDTH
from strainwave.report import figures
from strainwave.report.orders import line_numbers, spectrum_figure
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import results_json
from strainwave.typeset import interval, number, quantity, uncertain, uncertain_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_CHANGES = 12  # in a table; the rest is in results.json


def diagnose_report(
    found: Sequence[Diagnosis], provenance: Provenance | None = None, hours: Mapping[str, float] | None = None
) -> str:
    """Return the page, as one HTML file that needs nothing else.

    Args:
        found: of each joint
        provenance: command, date and files of the page, if they are to be shown
        hours: of operation, by the name of the recording
    """
    joints = [_joint(each, f"joint-{place}", hours or {}) for place, each in enumerate(found)]
    return render("diagnose.html.jinja", {"joints": joints}, provenance)


def _joint(found: Diagnosis, name: str, hours: Mapping[str, float]) -> dict[str, Any]:
    own = [hours[each.name] for each in found.runs if each.condition is not None and each.name in hours]
    return {
        "title": f"Joint {found.joint}" if found.joint else found.gear or "Joint",
        "facts": _joint_facts(found),
        "runs": [_run(each, f"{name}-{place}") for place, each in enumerate(found.runs)],
        "refused": dict(found.refused),
        "conditions": _conditions(found),
        "condition": condition_figure(found, own, f"{name}-condition"),
        "life": list(_life_lines(found)),
        "remarks": found.remarks,
    }


def _joint_facts(found: Diagnosis) -> dict[str, str]:
    facts = {"Gear": found.gear or "not given", "Ratio": number(found.ratio) if isfinite(found.ratio) else "not given"}
    facts["Baseline"] = ", ".join(found.baseline) or "none"
    facts["False alarms"] = f"{number(found.false_alarm)} of the recordings of a joint that did not change"
    return facts


def _run(found: RunDiagnosis, name: str) -> dict[str, Any]:
    unit, comparison, wave = found.run.unit, found.comparison, found.wave
    return {
        "name": found.name,
        "verdict": found.verdict,
        "reason": found.reason,
        "facts": _run_facts(found),
        "causes": (*found.causes, *_misalignment(found)),
        "spectrum": spectrum_figure(found.ripple, f"{name}-spectrum"),
        "changes": [] if comparison is None else [_change(each, unit) for each in comparison.changes[:MAX_CHANGES]],
        "left": 0 if comparison is None else max(len(comparison.changes) - MAX_CHANGES, 0),
        "change_figure": changes_figure(comparison, unit, f"{name}-changes") if comparison and comparison.changes else "",
        "wave": None
        if wave is None
        else {
            "order": uncertain(wave.order, wave.sigma),
            "ratios": " or ".join(map(str, wave.ratios)),
            "cells": [
                {
                    "direction": each.direction,
                    "load": f"{number(each.low, 3)} to {number(each.high, 3)}",
                    "speed": number(each.speed, 3),
                    "amplitude": uncertain_quantity(each.amplitude, each.sigma, unit),
                }
                for each in wave.cells
            ],
            "figure": load_figure(wave, unit, f"{name}-load"),
        },
        "unit": unit,
        "orders": [_order(each, unit) for each in found.orders],
        "remarks": found.remarks,
    }


def _run_facts(found: RunDiagnosis) -> dict[str, str]:
    facts = {"Column": f"{found.run.column.replace('_', ' ')} over the angle of the {found.run.side}"}
    if isfinite(found.revolutions):
        facts["Turned"] = f"{number(found.revolutions, 3)} revolutions of the input from end to end"
    facts["Load"] = f"{quantity(found.load, found.run.unit)}, root mean square without friction"
    if found.response:
        facts["Amplitude per error"] = found.response
    return facts


def _change(each: OrderChange, unit: str) -> dict[str, str]:
    return {
        "order": number(each.order, 5),
        "direction": each.direction,
        "baseline": uncertain_quantity(each.baseline, each.spread, unit),
        "amplitude": quantity(each.amplitude, unit),
        "change": f"{interval(each.low, each.high, each.sigma)} {unit}",
        "limit": quantity(each.limit, unit),
        "detectable": quantity(each.detectable, unit),
        "alarm": "< 10⁻⁹" if each.false_alarm < 1e-9 else number(each.false_alarm, 2),
        "state": "alarm" if each.alarm else "no alarm",
    }


def _order(each: OrderAgainstNoise, unit: str) -> dict[str, str]:
    def cell(value: Any) -> str:
        return "" if value is None else uncertain_quantity(value.amplitude, value.sigma, unit)

    return {
        "order": number(each.order.order, 5),
        "name": each.order.name,
        "forward": cell(each.forward),
        "backward": cell(each.backward),
        "threshold": quantity(each.threshold, unit),
        "expected": quantity(each.expected, unit) if isfinite(each.expected) else "",
        "error": f"{number(each.error / RAD_PER_ARCMIN, 3)}′" if isfinite(each.error) else "",
        "state": "above noise" if each.detected else "within noise",
    }


def _conditions(found: Diagnosis) -> list[dict[str, str]]:
    return [
        {
            "name": each.name,
            "indicator": number(each.condition.indicator, 3),
            "distance": number(each.condition.distance, 3),
            "order": f"{number(each.condition.order, 5)} {each.condition.direction}",
        }
        for each in found.runs
        if each.condition is not None
    ]


def _life_lines(found: Diagnosis) -> Iterator[str]:
    if found.life is not None:
        life = found.life
        early, median, late = (number(each, 3) for each in life.remaining)
        yield (
            f"remaining life by the maker's formula: {median} h, 80 % interval {early} to {late} h (L10 {number(life.l10, 3)} "
            f"h at {number(life.average_torque, 3)} N·m and {number(life.average_speed, 3)} rpm, {number(life.hours, 4)} h "
            "used); it assumes that the gear always works as in these recordings, and knows nothing of its condition"
        )
    if found.trend is not None:
        trend = found.trend
        yield (
            f"remaining life by the trend of the condition: {number(trend.remaining, 3)} h until the indicator is "
            f"{number(trend.threshold)}, 95 % interval {number(trend.low, 3)} to {number(trend.high, 3)} h; it assumes that "
            "the indicator grows on a straight line"
        )


# ---- On a terminal ---------------------------------------------------------------------------------------------------


def diagnose_summary(found: Sequence[Diagnosis]) -> str:
    """Return the results as lines of text."""
    lines: list[str] = []
    for each in found:
        if each.joint:
            lines += [f"joint {each.joint}"]
        for run in each.runs:
            lines += _wrapped(f"{run.name}: {run.verdict}", "")
            for text in _run_lines(run):
                lines += _wrapped(text, "  ")
            for remark in run.remarks:
                lines += _wrapped(f"note: {remark}", "  ")
        for name, why in each.refused.items():
            lines += _wrapped(f"{name}: refused: {why}", "")
        for text in (*_life_lines(each), *(f"note: {remark}" for remark in each.remarks)):
            lines += _wrapped(text, "")
    return "\n".join(lines).replace("\N{NO-BREAK SPACE}", " ")


def _wrapped(text: str, indent: str) -> list[str]:
    return textwrap.wrap(text, PAGE_WIDTH, initial_indent=indent, subsequent_indent=f"{indent}  ")


def _run_lines(found: RunDiagnosis) -> Iterator[str]:
    unit = found.run.unit
    yield found.reason
    yield from (*found.causes, *_misalignment(found))
    if found.condition is not None:
        yield f"health indicator {number(found.condition.indicator, 3)} (1 is an alarm)"
    if found.wave is not None:
        ratios = f", ratio {' or '.join(map(str, found.wave.ratios))}" if found.wave.ratios else ""
        order = uncertain(found.wave.order, found.wave.sigma)
        yield f"ripple of the wave generator at order {order} of the {found.run.side}{ratios}:"
        for cell in found.wave.cells:
            load = f"load {number(cell.low, 3)} to {number(cell.high, 3)} {unit}"
            yield f"  {cell.direction}, {load}: {uncertain_quantity(cell.amplitude, cell.sigma, unit)}"
    if found.response:
        yield f"amplitude per kinematic error: {found.response}"
    for each in found.orders:
        row = _order(each, unit)
        text = f"order {row['order']} ({row['name']}): {row['state']}"
        text += "".join(f", {name} {row[name]}" for name in ("forward", "backward") if row[name])
        text += f"; noise reaches {row['threshold']}"
        text += f", an error of {row['error']} would be seen" if row["error"] else ""
        yield text + (f"; expected {row['expected']}" if row["expected"] else "")
    if found.comparison is not None:
        for change in [each for each in found.comparison.changes if each.alarm][:MAX_CHANGES]:
            row = _change(change, unit)
            yield (
                f"alarm at order {row['order']} {row['direction']}: {row['baseline']} before, {row['amplitude']} now, change "
                f"{row['change']} (95 %), false alarm {row['alarm']}"
            )


# ---- As files --------------------------------------------------------------------------------------------------------


def diagnose_files(
    found: Sequence[Diagnosis], provenance: Provenance | None = None, hours: Mapping[str, float] | None = None
) -> dict[str, str | bytes]:
    """Return the numbers as JSON, and last the page, by file name."""
    results = {"made_by": f"strainwave {metadata.version('strainwave')}", "joints": [_results(each) for each in found]}
    return {"results.json": results_json(results), "report.html": diagnose_report(found, provenance, hours)}


def _results(found: Diagnosis) -> dict[str, Any]:
    return {
        "joint": found.joint,
        "gear": found.gear,
        "ratio": found.ratio,
        "baseline": found.baseline,
        "false_alarm": found.false_alarm,
        "recordings": [_run_results(each) for each in found.runs],
        "refused": found.refused,
        "life": found.life,
        "trend": found.trend,
        "remarks": found.remarks,
    }


def _misalignment(found: RunDiagnosis) -> tuple[str, ...]:
    """Return the misalignment in words, its warnings first; empty if none was asked for."""
    if found.geometry is None:
        return ()
    return (f"misalignment: {found.geometry.words().removesuffix('.')}",)


def _misalignment_results(found: RunDiagnosis) -> dict[str, Any] | None:
    if found.geometry is None:
        return None
    return {
        "condition": found.geometry.condition,
        "words": found.geometry.words(),
        "m": [end.m for end in found.geometry.ends],
        "size_interval": found.geometry.size_interval,
        "contradictions": found.geometry.contradictions,
    }


def _run_results(found: RunDiagnosis) -> dict[str, Any]:
    return {
        "name": found.name,
        "verdict": found.verdict,
        "reason": found.reason,
        "column": found.run.column,
        "unit": found.run.unit,
        "side": found.run.side,
        "input_revolutions": found.revolutions,
        "load": found.load,
        "lines": [line_numbers(line) for line in found.ripple.lines],
        "wave_generator": found.wave,
        "orders": found.orders,
        "response": found.response,
        "comparison": found.comparison,
        "condition": found.condition,
        "causes": found.causes,
        "misalignment": _misalignment_results(found),
        "remarks": found.remarks,
    }


# ---- Figures ---------------------------------------------------------------------------------------------------------


DIRECTIONS = (("forward", "model", "o", -0.12), ("backward", "earlier", "s", 0.12))
MAX_DRAWN_CHANGES = 24  # that are drawn


def changes_figure(comparison: BaselineComparison, unit: str, name: str) -> str:
    """Return the figure of the amplitudes of a recording over its orders, with the band that is no alarm."""
    drawn = sorted(comparison.changes[:MAX_DRAWN_CHANGES], key=lambda each: each.order)
    orders = sorted({each.order for each in drawn})

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for direction, colour, mark, shift in DIRECTIONS:
            own = [each for each in drawn if each.direction == direction]
            x = np.array([orders.index(each.order) + shift for each in own])
            low = [max(each.baseline - each.limit, 0.0) for each in own]
            high = [each.baseline + each.limit for each in own]
            axes.vlines(x, low, high, color=LIGHT["muted"], linewidth=5.0, alpha=0.45)
            axes.plot(x, [each.baseline for each in own], "_", color=LIGHT["ink"], markersize=9)
            axes.plot(x, [each.amplitude for each in own], mark, color=LIGHT[colour], label=f"recording, {direction}")
        axes.set_ylim(bottom=0.0)
        marks.label_axes(axes, "amplitude", unit, "order per revolution of the shaft", "1")
        axes.set_xticks(range(len(orders)), [f"{order:.5g}" for order in orders], rotation=60)
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 3.0), name, "Amplitudes of the recording and what the baseline allows")


def load_figure(wave: WaveRipple, unit: str, name: str) -> str:
    """Return the figure of the ripple of the wave generator over the load, by direction; empty with a single load."""
    if len({each.low for each in wave.cells}) < 2:
        return ""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        for direction, colour, mark, _ in DIRECTIONS:
            own = [each for each in wave.cells if each.direction == direction]
            if own:
                x = [0.5 * (each.low + each.high) for each in own]
                y, sigma = [each.amplitude for each in own], [each.sigma for each in own]
                axes.errorbar(x, y, yerr=sigma, fmt=mark, color=LIGHT[colour], capsize=3.0, label=direction)
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        marks.label_axes(axes, "amplitude", unit, "size of the load", unit)
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 2.6), name, "Ripple of the wave generator over the load")


def condition_figure(found: Diagnosis, hours: Sequence[float], name: str) -> str:
    """Return the figure of the health indicator over the recordings, or over the hours of operation; empty below two."""
    conditions = [each.condition for each in found.runs if each.condition is not None]
    if len(conditions) < 2:
        return ""
    timed = len(hours) == len(conditions)
    x = np.array(hours) if timed else np.arange(1.0, len(conditions) + 1.0)

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        axes.axhline(1.0, color=LIGHT["earlier"], linestyle="--", linewidth=0.9, label="alarm")
        axes.plot(x, [each.indicator for each in conditions], "o", color=LIGHT["measured"], label="health indicator")
        if found.trend is not None:
            axes.axhline(found.trend.threshold, color=LIGHT["muted"], linewidth=0.9, label="threshold")
            level = float(np.mean([each.indicator for each in conditions]))
            end = float(x.max()) + min(found.trend.remaining, 2.0 * float(np.ptp(x)))
            line = np.array([float(x.min()), end])
            axes.plot(line, level + found.trend.slope * (line - float(x.mean())), color=LIGHT["model"], label="trend")
        axes.set_ylim(bottom=0.0)
        marks.label_axes(axes, "indicator", "1", "hours of operation" if timed else "recording", "h" if timed else "1")
        marks.legend(figure, axes)

    return figures.inline(draw, (FIGURE_WIDTH, 2.6), name, "Health indicator")
