"""Report of predictions: verdict of each recording, its error and those of other models, and changes, as lines and a page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from importlib import metadata
from typing import Any

from strainwave.files.gear_set import GearSet
from strainwave.identification.results.file_result import FileResult, error_in_words
from strainwave.identification.results.prediction import PartChange, Prediction
from strainwave.report.errors import LEAST_SQUARES, Row, error_rows
from strainwave.report.identify_figures import file_figure
from strainwave.report.identify_files import first_remarks
from strainwave.report.orders import line_numbers, line_words
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import results_json
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA
from strainwave.typeset import number, percent, quantity, uncertain, uncertain_quantity

MAX_LINES = 4  # of the spectrum of a residual, on a terminal
NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"


def verdict_sentence(found: Prediction) -> str:
    """Return in one sentence whether a recording agrees with a saved gear, and what changed."""
    if found.refused:
        return f"{found.name} cannot be predicted: {found.refused}"
    error = f"RMS error {error_in_words(found.error, found.unit, found.varies, found.plain)}"
    allowed = quantity(found.allowed, found.unit)
    if found.contradicts:
        result = f"{found.name} contradicts {found.gear}: {error}, where {allowed} is allowed"
        return f"{result}; {_changes(found) if found.changed else _not_explained(found)}."
    if found.same_as:
        name = "" if found.same_as == found.name else f" as {found.same_as}"
        return (
            f"{found.name} is no evidence: {found.gear} was identified from this recording{name}; {error}; compare one made "
            "later."
        )
    error = f"{error}, of {allowed} allowed"
    if found.changed:
        return f"{found.name} differs from {found.gear}, within the allowed error: {_changes(found)}; {error}."
    unchanged = "nothing changed significantly" if found.changes else "it does not determine whether anything changed"
    return f"{found.name} agrees with {found.gear}: {error}; {unchanged}."


def _changes(found: Prediction) -> str:
    if found.common_scale is not None:
        scale = f"all torques are {uncertain(*found.common_scale)} times those saved"
        return f"{scale}: the torque constant or the range of a sensor is another one"
    return "; ".join(f"{each.name} is {change_in_words(each)}" for each in found.changed)


def _not_explained(found: Prediction) -> str:
    why = "no change of friction, load, zero or delay explains it"
    if not any(each.significant for each in found.changes):
        return why
    return f"{why}: {percent(found.error_with_changes / found.error)} of the error is left with all changes"


def change_in_words(change: PartChange) -> str:
    """Return a change as `1.31 ± 0.02 times that saved`."""
    if change.unit == "1":
        return f"{uncertain(change.value, change.sigma)} times that saved"
    if change.unit == "rad":
        return f"{uncertain(math.degrees(change.value), math.degrees(change.sigma))}° off"
    if change.unit == "1/K":
        return f"{uncertain(100.0 * change.value, 100.0 * change.sigma)} % per kelvin"
    return f"{uncertain_quantity(change.value, change.sigma, change.unit)}, saved {quantity(change.unchanged, change.unit)}"


def state_in_words(change: PartChange, found: Prediction) -> str:
    """Return whether a part changed, and why not if it differs by more than chance makes."""
    if change in found.changed:
        return "changed"
    if change.significance <= SIGNIFICANCE_SIGMA:
        return "no significant change"
    return f"no significant change: below {change.limit}" if change.is_small else "does not explain the error"


def predict_summary(found: Sequence[Prediction]) -> str:
    """Return the predictions as lines of text, the verdict of each first."""
    return "\n".join(line for each in found for line in _lines(each)).replace(NO_BREAK_SPACE, " ")


def _lines(found: Prediction) -> Iterator[str]:
    yield verdict_sentence(found)
    if found.refused:
        return
    for name, size, share in _errors(found):
        yield f"  {name:38} {size} ({share})"
    for change in found.changes:
        yield f"  {change.name:38} {change_in_words(change)} ({state_in_words(change, found)})"
    if found.lines:
        lines = (f"{line_words(each)} {quantity(each.amplitude, found.unit, 2)}" for each in found.lines[:MAX_LINES])
        yield f"  {'lines of the residual':38} {'; '.join(lines)}"
    yield from (f"  {check.remedy}" for check in found.checks if check.failed)
    yield from first_remarks(found.remarks, "  note: ")


def _errors(found: Prediction) -> list[Row]:
    """Return the error and those of other models, each with its name."""
    errors = {
        f"error of {found.channel.replace('_', ' ')}, root mean square": found.error,
        "with the changes below": found.error_with_changes,
        f"{LEAST_SQUARES} on this file": found.plain,
    }
    return list(error_rows(errors, found.varies, found.unit))


def predict_report(found: Sequence[Prediction], gear_set: GearSet, provenance: Provenance | None = None) -> str:
    """Return the page of predictions, as one HTML file that needs nothing else.

    Args:
        found: of each recording
        gear_set: the saved one
        provenance: command, date and files of the page, if they are to be shown
    """
    return render(
        "predict.html.jinja",
        {
            "name": gear_set.name,
            "note": gear_set.note,
            "recordings": [_section(each, f"recording-{place}") for place, each in enumerate(found)],
            "validation": [
                (each.file, quantity(each.error, each.unit), quantity(each.held_out, each.unit), percent(each.relative))
                for each in gear_set.validation
            ],
        },
        provenance,
    )  # fmt: skip


def _section(found: Prediction, anchor: str) -> dict[str, Any]:
    return {
        "name": found.name,
        "anchor": anchor,
        "verdict": verdict_sentence(found),
        "refused": bool(found.refused),
        "failed": [check for check in found.checks if check.failed],
        "errors": [] if found.refused else _errors(found),
        "figure": "" if (drawn := found.picture) is None else file_figure(FileResult(found.name), drawn, f"{anchor}-figure"),
        "changes": [
            (each.name, change_in_words(each), number(each.significance, 2), state_in_words(each, found), each in found.changed)
            for each in found.changes
        ],
        "lines": [
            (line_words(each), f"{number(each.frequency, 4)} Hz" if math.isfinite(each.frequency) else "",
             uncertain_quantity(each.amplitude, each.sigma, found.unit))
            for each in found.lines
        ],
        "remarks": found.remarks,
    }  # fmt: skip


def predict_files(found: Sequence[Prediction], gear_set: GearSet, provenance: Provenance | None = None) -> dict[str, str]:
    """Return the predictions as JSON, and the page, by file name."""
    results = {"made_by": f"strainwave {metadata.version('strainwave')}", "files": [_json(each) for each in found]}
    return {"results.json": results_json(results), "report.html": predict_report(found, gear_set, provenance)}


def _json(found: Prediction) -> dict[str, Any]:
    names = (
        "name", "gear", "kind", "channel", "unit", "error", "varies", "relative", "plain", "allowed", "samples",
        "error_with_changes", "verdict", "refused", "same_as", "remarks",
    )  # fmt: skip
    return {
        **{name: getattr(found, name) for name in names},
        "summary": verdict_sentence(found).replace(NO_BREAK_SPACE, " "),
        "changes": [{**asdict(each), "significant": each in found.changed} for each in found.changes],
        "lines": [line_numbers(each) for each in found.lines],
        "checks": [asdict(check) for check in found.checks],
    }
