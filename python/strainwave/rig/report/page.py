"""The report of a torsion test, as a test laboratory writes one, and the same in a few lines for a terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees

import numpy as np

from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.rig.analysis.analysis import table
from strainwave.rig.analysis.lost_motion import LOST_MOTION
from strainwave.rig.analysis.result import Result
from strainwave.rig.analysis.stiffness import SOFT_COMPLIANCE_RATIO
from strainwave.rig.reading.evaluation import Evaluation
from strainwave.rig.report.figures import angle_unit, overlay_figure, quality_figure
from strainwave.rig.report.tables import (
    OF_REGIMES,
    SOURCES,
    TITLES,
    budget_parts,
    catalogue_rows,
    centre_words,
    comparison_part,
    document_rows,
    loop_part,
    photographs,
    ratio_of,
    rig_rows,
    sentence,
    stated,
    step_rows,
    stiffness_table,
)
from strainwave.typeset import ARCMIN_PER_RADIAN, ZERO_CELSIUS, fixed, number

SECTIONS = {
    "table": "Stiffness and hysteresis",
    "loops": "Loops",
    "comparison": "Positions and units compared",
    "catalogue": "Comparison with the catalogue",
    "uncertainty": "Uncertainty",
    "photographs": "Photographs",
    "steps": "Steps",
    "setup": "Rig",
    "sources": "Definitions and sources",
}


def rig_report(found: Evaluation, provenance: Provenance | None = None, files: Sequence[str] = ()) -> str:
    """Return the report of a test, as one HTML file that needs nothing else.

    Args:
        found: the test
        provenance: how the report came to be, if that is to be shown
        files: names of the files in its folder

    Returns:
        HTML; the same for the same arguments

    >>> from strainwave.rig import Loop
    >>> from strainwave.rig.reading.evaluation import evaluate
    >>> loop = Loop([3.0, 2.0, -3.0, -2.0, 3.0], [1.0, 0.0, -1.0, 0.0, 1.0], side="output", name="example")
    >>> rig_report(evaluate([loop])).startswith("<!doctype html>")
    True
    """
    sources = dict(SOURCES)
    if (gear_set := found.gear_set) is not None:
        sources["Gear"] = f"{gear_set.name}{f', {gear_set.maker}' if gear_set.maker else ''}"
    content = {
        "title": found.name if found.gear_set is None else found.gear_set.name,
        "setting": setting(found),
        "cards": list(_cards(found)),
        "unknown": unknown(found),
        "tables": [stiffness_table(found, definition) for definition in TITLES],
        "document": list(document_rows()),
        "ratio": ratio_of(found),
        "loops": [loop_part(found, number) for number in range(len(found.analyses))],
        "overlay": overlay_figure(found),
        "comparisons": [comparison_part(found, each) for each in found.comparisons],
        "catalogue": list(catalogue_rows(found)),
        "budgets": list(budget_parts(found)),
        "quality": quality_figure(found),
        "photographs": list(photographs(found.angles)),
        "centres": list(centre_words(found.angles)),
        "steps": list(step_rows(found)),
        "deviations": None if found.deviations is None else [sentence(each) for each in found.deviations],
        "rows": [] if found.rig is None else list(rig_rows(found.rig)),
        "rig": found.rig,
        "sources": sources,
        "multiple": number(SOFT_COMPLIANCE_RATIO),
        "files": files,
    }
    there = {
        "comparison": "comparisons",
        "catalogue": "catalogue",
        "photographs": "photographs",
        "steps": "steps",
        "setup": "rows",
    }
    sections = {anchor: name for anchor, name in SECTIONS.items() if anchor not in there or content[there[anchor]]}
    return render("rig.html.jinja", content | {"sections": sections}, provenance, "strainwave.rig.report")


# ---- What was tested, and what came out -------------------------------------------------------------------------------


def setting(found: Evaluation) -> dict[str, str]:
    """Return what was tested, in words."""
    loops = found.loops
    facts = {"Specimen": found.gear_set.name if found.gear_set is not None else "not stated"}
    if units := [unit for unit in dict.fromkeys(loop.unit for loop in loops) if unit]:
        facts["Units"] = ", ".join(units)
    held = {"input": "input loaded, output held", "output": "output loaded, input held"}
    facts["Loaded shaft"] = ", ".join(held[side] for side in dict.fromkeys(loop.side for loop in loops))
    facts["Positions of the flexspline"] = ", ".join(dict.fromkeys(f"{degrees(loop.position):.6g}°" for loop in loops))
    low, high = (
        pick(end) for pick, end in zip((min, max), zip(*(each.peaks for each in found.analyses), strict=True), strict=True)
    )
    facts["Torque"] = f"{fixed(low, 3)} to {fixed(high, 3)} N·m"
    facts["Points"] = f"{sum(map(len, loops))} in {len(loops)} loop{'s' if len(loops) > 1 else ''}"
    if found.angles:
        frames = [frame for each in found.angles for frame in each.frames]
        lost = sum(frame.markers is None for frame in frames)
        facts["Photographs"] = f"{len(frames)}, {f'{lost} without an angle' if lost else 'each with an angle'}"
    if times := [step.time for step in found.steps if step.time is not None]:
        minutes = round((max(times) - min(times)) / 60.0)
        facts["Duration"] = f"{minutes // 60} h {minutes % 60:02} min" if minutes >= 60 else f"{minutes} min"
    temperatures = [value for loop in loops if loop.temperature is not None for value in loop.temperature.tolist()]
    if temperatures:
        facts["Temperature"] = (
            f"{fixed(min(temperatures) - ZERO_CELSIUS, 1)} to {fixed(max(temperatures) - ZERO_CELSIUS, 1)} °C"
        )
    if found.rig is not None:
        facts["Rig"] = found.rig.name
    if corrections := _with_labels(found, [each.loop.corrections for each in found.analyses]):
        facts["Corrections"] = " ".join(map(sentence, corrections))
    return facts


def _cards(found: Evaluation) -> Iterator[dict[str, str]]:
    rows = table(found.analyses)
    stiff = [each for row in rows for each in (row.positive_unloading, row.negative_unloading)]
    soft = [each for row in rows for each in (row.positive_loading, row.negative_loading)]
    over = f"over {len(rows)} loops" if len(rows) > 1 else "in the two senses"
    yield _card("Unloading", stiff, 1.0, "N·m/rad", f"Stiffness on the way from a peak to zero torque, {over}.")
    yield _card(
        "Loading", soft, 1.0, "N·m/rad", f"Stiffness of the softest stretch on the way from zero torque to a peak, {over}."
    )
    unit, scale = angle_unit(found.loops[0])
    widths = [row.hysteresis for row in rows]
    at_output = ""
    if (ratio := ratio_of(found)) is not None and (known := [each for each in widths if each is not None]):
        low, high = (ARCMIN_PER_RADIAN * (pick(each.value for each in known)) / ratio for pick in (min, max))
        at_output = f" Divided by the ratio of {number(ratio)}: {_range(low, high, 3)}′ at the output."
    yield _card("Hysteresis", widths, scale, unit, f"Widest separation of the branches at equal torque.{at_output}")
    energy = [each.area for each in found.analyses]
    yield _card("Energy lost", energy, 1e3, "mJ", "Area of the loop, in a cycle.")


def _card(eyebrow: str, results: Sequence[Result | None], scale: float, unit: str, text: str) -> dict[str, str]:
    known = [each for each in results if each is not None and np.isfinite(each.value)]
    card = {"eyebrow": eyebrow, "headline": "not determined", "unit": "", "text": text}
    if len(known) == 1:
        only = stated(known[0], scale)
        interval = f" 95 %: {only.interval}{'' if unit in '°′' else ' '}{unit}." if only.interval else ""
        card |= {"headline": only.value, "unit": unit, "text": f"{text}{interval}"}
    elif known:
        values = [scale * each.value for each in known]
        card |= {"headline": _range(min(values), max(values), 3), "unit": unit}
    if unit in "°′":  # stands at the number
        card |= {"headline": f"{card['headline']}{card['unit']}", "unit": ""}
    return card


def _range(low: float, high: float, digits: int) -> str:
    ends = [number(each, digits) for each in (low, high)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def unknown(found: Evaluation) -> list[str]:
    """Return what the test does not determine, or what makes it doubtful, each once, with its loops."""
    lines = _with_labels(
        found,
        [[remark for remark in each.remarks if not remark.startswith(OF_REGIMES)] for each in found.analyses],  # with the loop
    )
    on_photographs = [each for each in found.remarks if not any(line.endswith(f"is left out: {each}") for line in lines)]
    lines += [*on_photographs, *(found.deviations or ()), *(remark for each in found.comparisons for remark in each.remarks)]
    lines += [remark for each in found.angles for remark in each.remarks]
    if found.gear_set is None:
        lines.append("no gear is named: neither its ratio, its rated torque nor its catalogue figures are known (--gear)")
    return [sentence(line) for line in dict.fromkeys(lines)]


def _with_labels(found: Evaluation, remarks: Sequence[Sequence[str]]) -> list[str]:
    """Return the remarks of each loop, each once: with the labels of its loops, unless it is of all."""
    labels: dict[str, list[str]] = {}
    for label, of_loop in zip(found.labels, remarks, strict=True):
        for remark in of_loop:
            labels.setdefault(remark, []).append(label)
    return [remark if len(of) == len(found.labels) else f"{', '.join(of)}: {remark}" for remark, of in labels.items()]


# ---- Lines for a terminal --------------------------------------------------------------------------------------------


def _catalogued(found: Evaluation) -> Iterator[str]:
    """Yield the widths that catalogues state, of each loop that determines them."""
    for label, analysis in zip(found.labels, found.analyses, strict=True):
        unit, scale = angle_unit(analysis.loop)
        of = f"{label}: " if len(found.labels) > 1 else ""
        level = f"±{number(LOST_MOTION * (analysis.rated_torque or 0.0), 3)} N·m, 4 % of the rated torque"
        words = f"whole angle between {level}" if analysis.whole_angle else f"mean width at {level}"
        for name, result in ((f"lost motion, {words}", analysis.lost_motion), ("hysteresis loss", analysis.hysteresis_loss)):
            if result is not None:
                yield f"{of}{name}: {stated(result, scale)}{unit}"


def summary(found: Evaluation) -> str:
    """Return the results of the test, as lines of text."""
    shown = stiffness_table(found, "softest")
    head = ["", *(each.replace(" [", "\n[") for each in shown["heads"])]
    rows = [[label, *(str(cell) for cell in cells)] for label, cells in shown["rows"]]
    lines = [*(f"{name}: {value}" for name, value in setting(found).items()), ""]
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
    lines += ["", *catalogued] if (catalogued := list(_catalogued(found))) else []
    for each in found.comparisons:
        lines += ["", *(str(compared) for compared in each.quantities)]
    if open_questions := unknown(found):
        lines += ["", "limits of this test:", *(f"  {line}" for line in open_questions)]
    return "\n".join(lines)
