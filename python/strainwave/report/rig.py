"""The report of a torsion test, as a test laboratory writes one, and the same in a few lines for a terminal."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from importlib import metadata
from math import degrees, floor, log10
from typing import Any

import numpy as np

from strainwave.report import figures, rig_plates, rig_setup
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.report.rig_numbers import Stated, stated
from strainwave.report.typeset import fixed, number
from strainwave.rig.analysis import DEFINITIONS, Definition, LoopAnalysis, table
from strainwave.rig.budget import Budget
from strainwave.rig.catalogue_check import CatalogueCheck
from strainwave.rig.comparison import Compared, Comparison
from strainwave.rig.evaluation import Evaluation, budgets
from strainwave.rig.regimes import NAMES
from strainwave.rig.result import Result
from strainwave.rig.soft_spot import MULTIPLE, words_on_band
from strainwave.rig.stiffness import closure_of_secants, soft_parts
from strainwave.rig.virtual.printed import PEAK, TABLE_2

ARCMIN = 60.0
OF_REGIMES = tuple(name.replace("_", " ") for name in NAMES)  # how remarks on one regime begin
BAND = (0.1, 0.2)  # N.m: where document T saw its soft spot
TITLES: dict[Definition, str] = {
    "softest": "Stiffness of the softest straight stretch of each regime",
    "regression": "Stiffness by regression: one straight line through each regime",
    "secant": "Stiffness by secant: peak torque over the angle from zero torque to the peak",
}


def rig_report(found: Evaluation, provenance: Provenance | None = None, files: Sequence[str] = ()) -> str:
    """The report of a test, as one HTML file that needs nothing else.

    Args:
        found: the test
        provenance: how the report came to be, if that is to be shown
        files: names of the files beside it

    Returns:
        HTML; the same for the same arguments

    >>> from strainwave.rig import Loop
    >>> from strainwave.rig.evaluation import evaluate
    >>> loop = Loop([3.0, 2.0, -3.0, -2.0, 3.0], [1.0, 0.0, -1.0, 0.0, 1.0], side="output", name="example")
    >>> rig_report(evaluate([loop])).startswith("<!doctype html>")
    True
    """
    content = {
        "title": found.name if found.gear_set is None else found.gear_set.name,
        "setting": setting(found),
        "cards": list(_cards(found)),
        "unknown": unknown(found),
        "tables": [_table(found, definition) for definition in TITLES],
        "document": list(_document()),
        "ratio": _ratio(found),
        "loops": [_loop(found, number) for number in range(len(found.analyses))],
        "overlay": rig_plates.overlay(found),
        "comparisons": [_comparison(found, each) for each in found.comparisons],
        "catalogue": list(_catalogue(found)),
        "budgets": [(label, [_budget(each) for each in made]) for label, made in _all_budgets(found)],
        "quality": rig_plates.quality(found),
        "photographs": rig_setup.photographs(found.angles),
        "centres": rig_setup.centre_words(found.angles),
        "steps": list(rig_setup.step_rows(found)),
        "rows": [] if found.rig is None else rig_setup.rig_rows(found.rig),
        "rig": found.rig,
        "sources": list(_sources(found)),
        "multiple": number(MULTIPLE),
        "files": files,
        "provenance": provenance or Provenance(),
        "version": metadata.version("strainwave"),
        "light": figures.variables(figures.LIGHT),
        "dark": figures.variables(figures.DARK),
    }
    return render("rig.html.jinja", content | {"sections": _sections(content)})


def _sections(content: dict[str, Any]) -> dict[str, str]:
    every = {
        "table": "Stiffness and hysteresis",
        "loops": "Loops",
        "comparison": "Positions and units compared",
        "catalogue": "Beside the catalogue",
        "uncertainty": "Uncertainty",
        "photographs": "Photographs",
        "steps": "Steps",
        "setup": "Rig",
        "sources": "Definitions and sources",
    }
    there = {
        "comparison": content["comparisons"],
        "catalogue": content["catalogue"],
        "photographs": content["photographs"],
        "steps": content["steps"],
        "setup": content["rows"],
    }
    return {anchor: name for anchor, name in every.items() if there.get(anchor, True)}


# ---- What was tested, and what came out -------------------------------------------------------------------------------


def setting(found: Evaluation) -> dict[str, str]:
    """What was tested, in words."""
    loops = found.loops
    said = {"Specimen": found.gear_set.name if found.gear_set is not None else "not stated"}
    if units := [unit for unit in dict.fromkeys(loop.unit for loop in loops) if unit]:
        said["Units"] = ", ".join(units)
    held = {"input": "input loaded, output held", "output": "output loaded, input held"}
    said["Loaded shaft"] = ", ".join(held[side] for side in dict.fromkeys(loop.side for loop in loops))
    said["Positions of the flexspline"] = ", ".join(dict.fromkeys(f"{degrees(loop.position):.6g}°" for loop in loops))
    low, high = (
        pick(end) for pick, end in zip((min, max), zip(*(each.peaks for each in found.analyses), strict=True), strict=True)
    )
    said["Torque"] = f"{fixed(low, 3)} to {fixed(high, 3)} N·m"
    said["Points"] = f"{sum(map(len, loops))} in {len(loops)} loop{'s' if len(loops) > 1 else ''}"
    if found.angles:
        frames = [frame for each in found.angles for frame in each.frames]
        lost = sum(frame.markers is None for frame in frames)
        said["Photographs"] = f"{len(frames)}, {f'{lost} without an angle' if lost else 'each with an angle'}"
    if times := [step.time for step in found.steps if step.time is not None]:
        said["Duration"] = _duration(max(times) - min(times))
    temperatures = [value for loop in loops if loop.temperature is not None for value in loop.temperature.tolist()]
    if temperatures:
        said["Temperature"] = f"{fixed(min(temperatures) - 273.15, 1)} to {fixed(max(temperatures) - 273.15, 1)} °C"
    if found.rig is not None:
        said["Rig"] = found.rig.name
    return said


def _duration(seconds: float) -> str:
    minutes = round(seconds / 60.0)
    return f"{minutes // 60} h {minutes % 60:02} min" if minutes >= 60 else f"{minutes} min"


def _ratio(found: Evaluation) -> float | None:
    """Turns of the input for one of the output, where the loops were measured at the input and the gear is known."""
    if found.gear_set is None or any(loop.side != "input" for loop in found.loops):
        return None
    return abs(float(found.gear_set.gear.kinematics.ratio))


def _cards(found: Evaluation) -> Iterator[dict[str, str]]:
    rows = table(found.analyses)
    stiff = [each for row in rows for each in (row.positive_unloading, row.negative_unloading)]
    soft = [each for row in rows for each in (row.positive_loading, row.negative_loading)]
    over = f"over {len(rows)} loops" if len(rows) > 1 else "in the two senses"
    yield _card("Unloading", stiff, 1.0, "N·m/rad", f"Stiffness on the way from a peak to zero torque, {over}.")
    yield _card(
        "Loading", soft, 1.0, "N·m/rad", f"Stiffness of the softest stretch on the way from zero torque to a peak, {over}."
    )
    unit, scale = rig_plates.angle_unit(found.loops[0])
    widths = [row.hysteresis for row in rows]
    at_output = ""
    if (ratio := _ratio(found)) is not None and (told := [each for each in widths if each is not None]):
        low, high = (ARCMIN * degrees(pick(each.value for each in told)) / ratio for pick in (min, max))
        at_output = f" Divided by the ratio of {number(ratio)}: {_range(low, high, 3)}′ at the output."
    yield _card("Hysteresis", widths, scale, unit, f"Widest separation of the branches at equal torque.{at_output}")
    energy = [each.area for each in found.analyses]
    yield _card("Energy lost", energy, 1e3, "mJ", "Area of the loop, in a cycle.")


def _card(eyebrow: str, results: Sequence[Result | None], scale: float, unit: str, text: str) -> dict[str, str]:
    told = [each for each in results if each is not None and np.isfinite(each.value)]
    card = {"eyebrow": eyebrow, "headline": "not told", "unit": "", "text": text}
    if len(told) == 1:
        only = stated(told[0], scale)
        interval = f" 95 %: {only.interval}{'' if unit in '°′' else ' '}{unit}." if only.interval else ""
        card |= {"headline": only.value, "unit": unit, "text": f"{text}{interval}"}
    elif told:
        values = [scale * each.value for each in told]
        card |= {"headline": _range(min(values), max(values), 3), "unit": unit}
    if unit in "°′":  # stands at the number
        card |= {"headline": f"{card['headline']}{card['unit']}", "unit": ""}
    return card


def _range(low: float, high: float, digits: int) -> str:
    ends = [number(each, digits) for each in (low, high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def unknown(found: Evaluation) -> list[str]:
    """What the test could not tell, or what makes it doubtful, each once, with the loops that it holds for."""
    said: dict[str, list[str]] = {}
    for label, analysis in zip(found.labels, found.analyses, strict=True):
        for remark in analysis.remarks:
            if not remark.startswith(OF_REGIMES):  # these stand with the loop
                said.setdefault(remark, []).append(label)
    every = len(found.analyses)
    lines = [remark if len(labels) == every else f"{', '.join(labels)}: {remark}" for remark, labels in said.items()]
    lines += [*found.remarks, *(remark for each in found.comparisons for remark in each.remarks)]
    lines += [remark for each in found.angles for remark in each.remarks]
    if found.gear_set is None:
        lines.append("no gear is named: neither its ratio, its rated torque nor its catalogue figures are known (--gear)")
    return [_sentence(line) for line in dict.fromkeys(lines)]


def _own(found: Evaluation, analysis: LoopAnalysis) -> Iterator[str]:
    """Remarks on a loop that do not hold for all of the test."""
    for remark in analysis.remarks:
        if remark.startswith(OF_REGIMES) or any(remark not in each.remarks for each in found.analyses):
            yield remark


def _sentence(words: str) -> str:
    """Words as a sentence in print: signs and units set as such."""
    signed = re.sub(r"(?<![\w.])-(?=\d)", "−", words.replace("N.m", "N·m"))
    return f"{signed[0].upper()}{signed[1:]}."


# ---- Document T's Table 2 --------------------------------------------------------------------------------------------


def _table(found: Evaluation, definition: Definition) -> dict[str, Any]:
    unit, scale = rig_plates.angle_unit(found.loops[0])
    ratio = _ratio(found)
    rows = []
    for label, row in zip(found.labels, table(found.analyses, definition), strict=True):
        cells = [stated(getattr(row, name)) for name in NAMES]
        cells.append(stated(row.hysteresis, scale))
        if ratio is not None:
            cells.append(stated(row.hysteresis, ARCMIN * degrees(1.0) / ratio))
        rows.append((label, cells))
    heads = [f"{name.replace('_', ' ').capitalize()} [N·m/rad]" for name in NAMES]
    heads.append(f"Total hysteresis [{unit}]")
    if ratio is not None:
        heads.append("At the output [′]")
    return {"title": TITLES[definition], "text": DEFINITIONS[definition], "heads": heads, "rows": rows}


def _document() -> Iterator[list[str]]:
    """Document T's own table, how far it is from closed, and under which reading it is."""
    for position, (*slopes, width) in TABLE_2.items():
        gap = degrees(closure_of_secants(slopes, PEAK))
        parts = soft_parts(slopes, float(np.radians(width)), PEAK)
        signed = f"{gap:+.2f}°".replace("-", "−")
        yield [
            f"{position}°",
            *(fixed(each, 2) for each in slopes),
            fixed(width, 1),
            signed,
            *(fixed(each, 3) for each in parts),
        ]


# ---- Loops -----------------------------------------------------------------------------------------------------------


def _loop(found: Evaluation, place: int) -> dict[str, Any]:
    analysis = found.analyses[place]
    ratio = _ratio(found)
    low, high = analysis.peaks
    return {
        "label": found.labels[place],
        "span": f"{len(analysis.loop)} points from {fixed(low, 3)} to {fixed(high, 3)} N·m",
        "figure": rig_plates.loop(analysis, found.labels[place], f"loop-{place}", ratio),
        "stiffness_figure": rig_plates.stiffness(analysis, found.labels[place], f"stiffness-{place}"),
        "rows": list(_width_rows(analysis, ratio)),
        "ratio": ratio,
        "soft": list(_soft_rows(analysis)),
        "band": [_sentence(words) for words in _band(analysis)],
        "remarks": [_sentence(remark) for remark in _own(found, analysis)],
    }


def _width_rows(analysis: LoopAnalysis, ratio: float | None) -> Iterator[tuple[str, str, Stated, Stated, str]]:
    """What, its definition, its value at the loaded shaft and at the output, and the unit."""
    unit, scale = rig_plates.angle_unit(analysis.loop)

    def angle(name: str, words: str, found: Result | None) -> tuple[str, str, Stated, Stated, str]:
        at_output = stated(found, ARCMIN * degrees(1.0) / ratio) if ratio else Stated("", "")
        return name, words, stated(found, scale), at_output, unit

    wide = analysis.hysteresis
    where = "" if wide is None else f", here at {number(round(wide.torque, 4), 3)} N·m"
    yield angle(
        "Hysteresis",
        f"widest separation of the branches at equal torque, as document T has it{where}",
        None if wide is None else wide.width,
    )
    yield angle("Width at zero torque", "separation of the branches after the peaks of this cycle", analysis.width_at_zero)
    rated = analysis.rated_torque
    yield angle(
        "Hysteresis loss",
        "separation at zero torque after rated torque, as catalogues have it"
        + (
            "; rated torque is not known"
            if rated is None
            else ""
            if analysis.hysteresis_loss
            else f"; rated torque, {number(rated, 4)} N·m, was not the peak"
        ),
        analysis.hysteresis_loss,
    )
    yield angle(
        "Lost motion",
        "mean separation at plus and minus 4 % of rated torque, as catalogues have it"
        + ("; rated torque is not known" if rated is None else f"; ±{number(0.04 * rated, 3)} N·m"),
        analysis.lost_motion,
    )
    if analysis.torque_width is not None:
        words = f"widest separation at equal angle, here at {fixed(scale * analysis.torque_width[1], 2)}{unit}"
        yield "Width in torque", words, Stated(number(analysis.torque_width[0], 4), ""), Stated("", ""), "N·m"
    yield "Energy lost", "area of the loop, in a cycle", stated(analysis.area, 1e3), Stated("", ""), "mJ"
    yield angle("Closure error", "angle at the end of the cycle less that at its beginning, at equal torque", analysis.closure)
    if analysis.drift is not None:
        yield angle("Drift", "movement of the middle of the loop from cycle to cycle", analysis.drift)


def _soft_rows(analysis: LoopAnalysis) -> Iterator[list[str]]:
    for spot in analysis.soft_spots:
        beyond = "" if spot.bounded else ", where the regime ends"
        yield [
            spot.regime.replace("_", " "),
            f"{fixed(spot.low, 3)} to {fixed(spot.high, 3)} N·m{beyond}",
            f"{fixed(spot.multiple, 2)} (at least {fixed(spot.at_least, 2)})",
        ]


def _band(analysis: LoopAnalysis) -> Iterator[str]:
    """What there is of document T's soft spot, where the loop reaches so far."""
    if analysis.loop.side != "input" or max(map(abs, analysis.peaks)) < BAND[0]:
        return
    for name in ("negative_loading", "positive_loading"):
        if (each := analysis.stiffness(name)) is not None:
            yield words_on_band(each, *BAND)


# ---- Beside each other, and beside the catalogue ----------------------------------------------------------------------


def _comparison(found: Evaluation, comparison: Comparison) -> dict[str, Any]:
    what = {"position": "Positions of the flexspline", "unit": "Units"}[comparison.by]
    return {
        "by": comparison.by,
        "title": what,
        "groups": comparison.quantities[0].groups if comparison.quantities else (),
        "rows": [_compared(each, found) for each in comparison.quantities],
        "figure": rig_plates.comparison(found, comparison),
        "remarks": [_sentence(each) for each in comparison.remarks],
    }


def _compared(each: Compared, found: Evaluation) -> dict[str, Any]:
    unit, scale = _in_print(each.unit, found)
    verdict, word = {
        True: ("they differ", "differ"),
        False: ("no difference shown", "agree"),
        None: ("not known", "undecided"),
    }[each.significant]
    basis = "repeats" if not np.isnan(each.by_repeats) else "stated errors"
    return {
        "name": f"{each.name[0].upper()}{each.name[1:]} [{unit}]",
        "means": [_to_spread(scale * mean, scale * each.spread) for mean in each.means],
        "spread": f"{number(scale * each.spread, 2)} ({number(100.0 * each.relative, 2)} %)",
        "probability": "—" if np.isnan(each.probability) else f"{_probability(each.probability)}, by {basis}",
        "verdict": verdict,
        "word": word,
    }


def _to_spread(value: float, spread: float) -> str:
    """A mean to the third digit of the spread of the means, which tells them apart."""
    return fixed(value, min(max(2 - floor(log10(spread)), 0), 6)) if spread > 0.0 else number(value, 4)


def _probability(value: float) -> str:
    return "< 0.0001" if value < 1e-4 else number(value, 2)


def _in_print(unit: str, found: Evaluation) -> tuple[str, float]:
    """The unit that a quantity is printed in, and the factor to it."""
    if unit == "rad":
        return rig_plates.angle_unit(found.loops[0])
    return ("mJ", 1e3) if unit == "J" else (unit.replace(".", "·"), 1.0)


def _catalogue(found: Evaluation) -> Iterator[dict[str, Any]]:
    for label, analysis in zip(found.labels, found.analyses, strict=True):
        for check in analysis.catalogue:
            unit, scale = _in_print(check.unit, found)
            verdict, word = {
                True: ("within the spread", "agree"),
                False: ("beyond the spread", "differ"),
                None: ("", "undecided"),
            }[check.within]
            yield {
                "label": label,
                "name": check.name,
                "measured": stated(check.measured, scale),
                "stated": number(scale * check.stated, 4)
                + ("" if check.spread is None else f" ± {number(100.0 * check.spread, 2)} %"),
                "share": _share(check),
                "unit": unit,
                "verdict": verdict,
                "word": word,
                "why": check.why.replace("N.m", "N·m"),
            }


def _share(check: CatalogueCheck) -> str:
    if check.measured is None or check.stated == 0.0:
        return "—"
    return f"{number(100.0 * check.measured.value / check.stated, 3)} %"


# ---- Uncertainty and sources -----------------------------------------------------------------------------------------


def _all_budgets(found: Evaluation) -> Iterator[tuple[str, list[Budget]]]:
    for label, analysis in zip(found.labels, found.analyses, strict=True):
        if made := budgets(found, analysis):
            yield label, made


def _budget(budget: Budget) -> dict[str, Any]:
    unit, scale = ("°", degrees(1.0)) if budget.unit == "rad" else (budget.unit.replace(".", "·"), 1.0)
    if budget.unit == "N.m":
        unit, scale = "mN·m", 1e3
    return {
        "name": f"{budget.quantity[0].upper()}{budget.quantity[1:]}",
        "value": number(scale * budget.value, 4),
        "sigma": number(scale * budget.sigma, 2),
        "relative": f"{number(100.0 * budget.sigma / abs(budget.value), 2)} %" if budget.value else "",
        "unit": unit,
        "parts": [
            (each.name, number(scale * each.sigma, 2), f"{fixed(100.0 * budget.share(each), 1)} %", each.kind)
            for each in budget.contributions
        ],
    }


DOCUMENT = "document T, “Harmonic Drive Torsional Stiffness: Measurement and Hysteresis Analysis”"
SOURCES = {
    "Form of the table, rig, cycle of five steps": f"{DOCUMENT}, Tables 1 and 2; corrected by the errata E-T1 to E-T10",
    "Torque of a couple: m is the total of both pans of a pair": "document T; erratum E-T7",
    "Angle from two markers by atan2, followed from photograph to photograph": "erratum E-T1",
    "Centres of the markers: circle, or ellipse, fitted by distance to sub-pixel edges": "erratum E-T2",
    "Regression with errors in torque and angle": "York1968",
    "Differences between groups of repeated loops": "Welch1951",
    f"Soft spot: local compliance beyond {number(MULTIPLE)} times that of the regime's regression, by more than chance": (
        "a definition of this package; document T gives none"
    ),
    "Hysteresis loss, lost motion": "catalogues: at zero torque after ± rated torque, and at ± 4 % of rated torque",
    "Uncertainty: the squares of independent contributions add up": "GUM (JCGM 100:2008), Eq. 10",
}


def _sources(found: Evaluation) -> Iterator[tuple[str, str]]:
    yield from SOURCES.items()
    if found.gear_set is not None:
        yield "Gear", f"{found.gear_set.name}{f', {found.gear_set.maker}' if found.gear_set.maker else ''}"


# ---- Lines for a terminal --------------------------------------------------------------------------------------------


def summary(found: Evaluation) -> str:
    """What the test found, as lines of text."""
    shown = _table(found, "softest")
    head = ["", *(each.replace(" [", "\n[") for each in shown["heads"])]
    rows = [[label, *(str(cell) for cell in cells)] for label, cells in shown["rows"]]
    lines = ["; ".join(f"{name}: {value}" for name, value in setting(found).items()), ""]
    upper = [each.split("\n")[0] for each in head]
    lower = [each.partition("\n")[2] for each in head]
    widths = [max(map(len, column)) for column in zip(upper, lower, *rows, strict=True)]
    for row in (upper, lower, *rows):
        lines.append(
            "  ".join(
                [f"{row[0]:{widths[0]}}", *(f"{cell:>{width}}" for cell, width in zip(row[1:], widths[1:], strict=True))]
            ).rstrip()
        )
    lines += ["", "stiffness of the softest straight stretch of each regime; in brackets, the interval of 95 %"]
    for each in found.comparisons:
        lines += ["", *(str(compared) for compared in each.quantities)]
    if told := unknown(found):
        lines += ["", "not told, or in doubt:", *(f"  {line}" for line in told)]
    return "\n".join(lines)
