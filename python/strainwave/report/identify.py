"""Report of an identification: verdict, failed checks, each file measured against predicted, and the parameters by effect."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from strainwave.files.entries import NOT_GIVEN
from strainwave.files.gear_set import GearSet
from strainwave.identification.checks.comparisons import AGREEMENT
from strainwave.identification.checks.unexplained import has_shape
from strainwave.identification.identify import Identified
from strainwave.identification.kinds import kind_named
from strainwave.identification.reading.mapping import CONSTANTS
from strainwave.identification.results.combined_parameter import (
    MAX_DISTANCE,
    MAX_DISTANCE_IN_MEAN,
    CombinedParameter,
    difference,
    distance,
)
from strainwave.identification.results.drive import not_written
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.parameter_state import UNDETERMINED
from strainwave.identification.results.pictures import SIGMA_OF_95_PERCENT, Picture, residual_of
from strainwave.messages import listed
from strainwave.report import identify_figures as plots
from strainwave.report.errors import held_out_rows
from strainwave.report.first_screen import next_commands, not_determined, numbers_by_source, pictures
from strainwave.report.page import render
from strainwave.report.parameter_names import EFFECTS, OTHER, effect_of, name_of
from strainwave.report.provenance import Provenance
from strainwave.statistics.residuals import rms
from strainwave.typeset import fixed, interval, number, percent, plain_symbols, quantity, uncertain, uncertain_quantity, unit

NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
MIN_WIDENED = 1.05  # factor of the standard deviation of a mean, from which on it is stated
DIGITS_WITH_SPREAD = 4  # of a number that is followed by the scatter of individual gears


def identify_report(
    found: Identified,
    provenance: Provenance | None = None,
    *,
    accepted: bool = False,
    folder: Path = Path(),
    remark: str = "",
    workbench: str = "",
) -> str:
    """Return the report of an identification, as one HTML file that needs nothing else.

    Args:
        found: the result
        provenance: how the page came to be, if that is to be shown
        accepted: if true, the gear is written in spite of failed checks
        folder: that it is written into, as the commands of the page name it
        remark: a sentence for the box of failed checks
        workbench: page beside it that draws the gear, by its name; empty if there is none

    Returns:
        HTML; the same for the same arguments
    """
    anchors = {id(file): f"file-{place}" for place, file in enumerate(found.files)}
    given = _given_with_all(found)
    alone = [file for file in found.files if not file.part_of]
    return render(
        "identify.html.jinja",
        {
            "name": found.gear_set.name,
            "note": found.gear_set.note,
            "verdict": _verdict(found, accepted),
            "failed": found.failed,
            "remark": remark,
            "panels": list(pictures(found)),
            "not_shown": not_determined(found),
            "numbers": numbers_by_source(found),
            "next": next_commands(found, folder) if accepted or not found.failed else [],
            "accepted": accepted,
            "workbench": workbench,
            "refused": [(each.name, each.refused) for each in found.files if each.refused],
            "cards": [_card(each, anchors[id(each)]) for each in alone if not each.refused],
            "apart": [_apart(each, other) for each in found.parameters for other in each.contradicts],
            "agreement_failed": any(check.name == AGREEMENT for check in found.failed),
            "max_distance": number(MAX_DISTANCE),
            "max_distance_in_mean": number(MAX_DISTANCE_IN_MEAN),
            "effects": (effects := list(_by_effect(found))),
            "has": {key for _, rows in effects for row in rows for key in ("start", "others", "copies") if row[key]},
            "comparisons": list(_comparisons(found)),
            "undetermined": _undetermined(found),
            "kept": _kept(found),
            "absent": _absent(found),
            "given": [_constant(name, value) for name, value in given.items()],
            "files": [_file(each, anchors[id(each)], given) for each in alone],
            "sections": list(_sections(found, given)),
            "checks": [(each, number(each.value, 3), number(each.limit, 3)) for each in found.checks],
        },
        provenance,
    )


# ---- First screen ----------------------------------------------------------------------------------------------------


def _verdict(found: Identified, accepted: bool) -> str:
    """Return the outcome in one sentence."""
    failed, checks = len(found.failed), len(found.checks)
    parts = [_counts(found), *_error(found)]
    if failed:
        written = "the gear was written all the same, as accepted" if accepted else "no gear was written"
        parts.insert(0, f"{failed} of {_several(checks, 'check')} failed, and {written}")
    else:
        parts.append({0: "no check applied", 1: "the one check passed"}.get(checks, f"all {checks} checks passed"))
    if shapes := [quantity(check.value, check.unit) for check in found.checks if has_shape(check)]:
        parts.append(f"the residual has a shape of RMS {listed(shapes)}")
    if found.unchecked:
        parts.append(f"nothing checks {' or '.join(f'the {name}, {value}' for name, value in found.unchecked.items())}")
    sentence = "; ".join(filter(None, [not_written(found.files), *parts]))
    return f"{sentence[0].upper()}{sentence[1:]}.".replace(" %", f"{NO_BREAK_SPACE}%")


def _counts(found: Identified) -> str:
    """Return how many files determine how many parameters: "5 files: 3 determine 17 parameters, 1 is refused"."""
    given = [each for each in found.files if each.recognised is None or each.recognised.columns]  # no table of several files
    refused = sum(bool(each.refused) for each in found.files)
    copies = sum(bool(each.same_as) and not each.refused for each in found.files)
    points = sum(bool(each.part_of) for each in found.files)
    determining = sum(any(not estimate.why for estimate in each.estimates) and not each.same_as for each in given)
    parameters = _several(len(found.parameters), "parameter") if found.parameters else "no parameter"
    if len(given) == 1:
        return f"the file {'is refused' if refused else f'determines {parameters}'}"
    parts = []
    for count, one, many in (
        (determining, f"determines {parameters}", f"determine {parameters}"),
        (copies, "contains the measurement of another", "contain the measurement of another"),
        (points, "is a point of a table of several files", "are points of a table of several files"),
        (len(given) - determining - copies - refused - points, "determines none", "determine none"),
        (refused, "is refused", "are refused"),
    ):
        parts += [f"{count} {one if count == 1 else many}"] if count else []
    return f"{len(given)} files: {', '.join(parts)}"


def _error(found: Identified) -> list[str]:
    """Return the error on held-out data; of several files the shares of the best and the worst. Empty if there is none."""
    errors = [each.held_out for each in found.files if each.held_out is not None and not each.refused]
    if len(errors) < 2:
        return [f"RMS error on held-out data {each.words}" for each in errors]
    ends = dict.fromkeys(percent(end) for end in (min(each.relative for each in errors), max(each.relative for each in errors)))
    return [f"RMS errors on held-out data {' to '.join(ends)} of the signal"]


def _several(count: int, noun: str) -> str:
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _card(result: FileResult, anchor: str) -> dict[str, Any]:
    """Return what the first screen shows of a file: its errors on held-out data, and its first picture."""
    drawn = [
        {
            "title": picture.title,
            "caption": _caption(result, picture),
            "svg": plots.file_figure(result, picture, f"{anchor}-{place}-figure" if place else f"{anchor}-figure"),
        }
        for place, picture in enumerate(result.pictures)
    ]
    return {
        "name": result.name,
        "anchor": anchor,
        "kind": result.title,
        "model": result.model,
        "failed": bool(result.failed),
        "same_as": result.same_as,
        "held_out": result.held_out,
        "errors": held_out_rows(result.held_out),
        "pictures": drawn,
    }


def _caption(result: FileResult, picture: Picture) -> str:
    curves = picture.curves
    of, words = curves.unit(curves.names[1]), [f"Model: {picture.model or result.model}."]
    if result.held_out is None or result.held_out.unit != of:  # else the table has the error on held-out data
        words.append(f"RMS error {quantity(rms(residual_of(curves)), of)}.")
    if "residual" in curves:
        words.append("The slow part above is what load and lost motion add; it is taken out below, too.")
    if "held_out" in curves and curves["held_out"].any():
        words.append("Shaded: held out from the fit.")
    return " ".join(words)


# ---- Parameters ------------------------------------------------------------------------------------------------------


def _by_effect(found: Identified) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """Yield each effect with its parameters."""
    rows: dict[str, list[dict[str, Any]]] = {effect: [] for effect in (*EFFECTS, OTHER)}
    for each in found.parameters:
        rows[effect_of(each.estimate.path)].append(_parameter(each, found))
    yield from ((effect, own) for effect, own in rows.items() if own)


def _parameter(each: CombinedParameter, found: Identified) -> dict[str, Any]:
    taken, same_as = each.estimate, {file.name: file.same_as for file in found.files}
    files = [each.source, *each.others] if len(each.mean_of) > 1 else list(each.others)
    half = SIGMA_OF_95_PERCENT * taken.sigma
    return {
        "path": taken.path,
        "name": name_of(taken),
        "law": taken.law if taken.law.startswith(("in ", "of ", "at ")) else "",
        "unit": unit(taken.unit),
        "value": uncertain(taken.value, taken.sigma),
        "interval": interval(taken.value - half, taken.value + half, taken.sigma),
        "source": each.source if len(each.mean_of) < 2 else f"mean of {len(each.mean_of)} files",
        "widened": number(each.widened, 2) if each.widened > MIN_WIDENED else "",
        "shifts": ", ".join(f"{path} by {number(100.0 * by, 2)} %" for path, by in taken.shift_by_kept.items()),
        "start": _start(found.start_set, taken),
        "others": [
            {
                "file": name,
                "value": uncertain(each.of_file(name).value, each.of_file(name).sigma),
                "distance": "" if name == each.source else _sigmas(distance(each.of_file(each.source), each.of_file(name))),
                "counted": name in each.mean_of or name == each.source,
            }
            for name in files
            if not same_as.get(name) or name == each.source
        ],
        "copies": [
            f"{name} {uncertain(each.of_file(name).value, each.of_file(name).sigma)}"
            for name in each.others
            if same_as.get(name)
        ],
    }


def _start(start: GearSet, estimate: FileEstimate) -> str:
    """Return the number in the start set; empty if it has none, or one of another meaning."""
    if "[" in estimate.path or estimate.law == "in A":  # elements of a sequence fitted anew, or torque without a constant
        return ""
    try:
        value = float(attrgetter(estimate.path)(start))
    except AttributeError:
        return ""
    entry = start.sources.get(estimate.path)
    if entry is None:
        return number(value)
    if entry.spread is not None:
        return f"{number(value, DIGITS_WITH_SPREAD)} ± {number(100.0 * entry.spread, 2)} %"
    return number(value) if entry.uncertainty is None else uncertain(value, entry.uncertainty)


def _apart(each: CombinedParameter, other: str) -> dict[str, str]:
    best, estimate = each.of_file(each.source), each.others[other]
    return {
        "title": name_of(best),
        "path": best.path,
        "unit": unit(best.unit),
        "taken": uncertain(best.value, best.sigma),
        "source": each.source,
        "value": uncertain(estimate.value, estimate.sigma),
        "other": other,
        "distance": _sigmas(distance(best, estimate)),
    }


def _sigmas(distance: float) -> str:
    """Return standard deviations, to a tenth if they are few."""
    return fixed(distance, 1 if distance < 10.0 else 0) if np.isfinite(distance) else "∞"


def _undetermined(found: Identified) -> list[tuple[str, str, str, list[dict[str, str]]]]:
    """Return what was fitted to a file without being determined by it: file, state, reason, and the parameters."""
    groups: dict[tuple[str, str, str], list[dict[str, str]]] = {}
    for file in found.files:
        for each in file.estimates:
            if each.why or not np.isfinite(each.sigma):
                why = each.why or "the file does not determine it"
                state = each.state if each.why else "not identified"
                row = {"name": name_of(each), "path": each.path, "value": uncertain_quantity(each.value, each.sigma, each.unit)}
                groups.setdefault((file.name, state, why), []).append(row)
    return [(*place, numbers) for place, numbers in groups.items()]


def _kept(found: Identified) -> dict[str, list[tuple[str, str]]]:
    """Return path and value of the numbers of the gear that no file determines, by the reason."""
    kept: dict[str, list[tuple[str, str]]] = {}
    for each in found.states:
        if each.state == "kept" and not each.why.endswith(NOT_GIVEN):
            why = each.why.removeprefix(f"{UNDETERMINED}; ") or "as in the start set"
            kept.setdefault(why, []).append((each.path, f"{number(each.value)} {unit(each.unit)}".strip()))
    return kept


def _absent(found: Identified) -> str:
    """Return the parts that the model does without, as neither the set nor a file has anything of them."""
    parts = [each.path.rpartition(".")[0] for each in found.states if each.why.endswith(NOT_GIVEN)]
    return ", ".join(part.removeprefix("gear.").replace("_", " ") for part in dict.fromkeys(parts))


# ---- Files -----------------------------------------------------------------------------------------------------------


def _given_with_all(found: Identified) -> Mapping[str, float]:
    """Return the constants that a person gave with every file."""
    given = [set(each.recognised.constants.items()) for each in found.files if each.recognised and each.recognised.columns]
    return dict(sorted(set.intersection(*given))) if given else {}


def _constant(name: str, value: float) -> str:
    return f"{name.replace('_', ' ')} {quantity(value, CONSTANTS[name].unit)}"


def _file(result: FileResult, anchor: str, given: Mapping[str, float]) -> dict[str, Any]:
    read = result.recognised
    of = "" if result.held_out is None else result.held_out.unit
    return {
        "name": result.name,
        "anchor": anchor if result.pictures and not result.refused else "",
        "kind": result.title,
        "why": read.why if read is not None else (),
        "columns": list(_columns(result, given)),
        "model": result.model,
        "candidates": [(name, quantity(error, of) if of else number(error, 3)) for name, error in result.candidates],
        "determined": sum(not each.why for each in result.estimates),
        "same_as": result.same_as,
        "refused": result.refused,
        "failed": [check.name for check in result.failed],
        "remarks": result.remarks,
    }


def _columns(result: FileResult, given: Mapping[str, float]) -> Iterator[str]:
    """Yield each channel with its column and unit in the file, "speed: Drehzahl [1/min]", and constants given with it alone."""
    read = result.recognised
    if read is None:
        return
    for channel, name in read.columns.items():
        of = unit(read.units.get(channel, "1"))
        yield f"{channel.replace('_', ' ')}: {name}" + (f" [{of}]" if of else "")
    if read.side is not None:
        yield f"side: {read.side}"
    for name, value in read.constants.items():
        if name not in given:
            yield f"given: {_constant(name, value)}"


def _sections(found: Identified, given: Mapping[str, float]) -> Iterator[dict[str, Any]]:
    """Yield a section for each table of which several files are points."""
    for table in dict.fromkeys(each.part_of for each in found.files if each.part_of):
        own = [each for each in found.files if each.part_of == table]
        kinds = [kind_named(each.recognised.kind).section for each in own if each.recognised is not None]
        yield {
            "heading": next(filter(None, kinds), table.capitalize()),
            "table": table,
            "files": [_file(each, "", given) for each in own],
            "remarks": list(dict.fromkeys(remark for each in own for remark in each.remarks)),
        }


# ---- Comparison of files ---------------------------------------------------------------------------------------------


def _comparisons(found: Identified) -> Iterator[tuple[str, str]]:
    """Yield a drawing for each part of the drive of which more than one file determines a parameter."""
    copies = {file.name for file in found.files if file.same_as}
    parts: dict[str, list[CombinedParameter]] = {}
    for each in found.parameters:
        if each.others and (each.estimate.value != 0.0 or each.estimate.is_phase):
            parts.setdefault(each.estimate.path.partition(" of ")[0].rpartition(".")[0], []).append(each)
    for place, (part, numbers) in enumerate(parts.items()):
        rows = [(plain_symbols(name_of(each.estimate)), list(_rows(each, copies))) for each in numbers]
        yield part.removeprefix("gear.").replace("_", " ").capitalize(), plots.comparison(rows, f"comparison-{place}")


def _rows(each: CombinedParameter, copies: set[str]) -> Iterator[plots.EstimateRow]:
    taken, mean = each.estimate, len(each.mean_of) > 1
    scale = 1.0 if taken.is_phase else abs(taken.value)  # a phase has no size: of it, 1 rad is 100 %
    title = f"mean of {len(each.mean_of)} files" if mean else each.source
    yield plots.EstimateRow(title, 0.0, 100.0 * taken.sigma / scale, "value taken")
    for name in [each.source, *each.others] if mean else each.others:
        other = each.of_file(name)
        agrees = "agrees" if name in each.mean_of else "not counted"
        look = plots.BEYOND if name in each.contradicts else "copy of another" if name in copies else agrees
        yield plots.EstimateRow(name, 100.0 * difference(other, taken) / scale, 100.0 * other.sigma / scale, look)
