"""The page of what files tell of a gear, and its numbers as files."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import replace
from importlib import metadata
from io import StringIO
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import Drive
from strainwave.files.entries import NOT_GIVEN
from strainwave.files.gear_set import GearSet
from strainwave.identification.evidence import verdict
from strainwave.identification.identify import Identified
from strainwave.identification.reading.kind import KINDS
from strainwave.identification.reading.mapping import CONSTANTS
from strainwave.identification.results.file_result import (
    AGREE,
    APART,
    CombinedParameter,
    FileEstimate,
    FileResult,
    difference,
    distance,
)
from strainwave.report import figures
from strainwave.report import identify_figures as plots
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.report.rig_files import results_json
from strainwave.report.typeset import fixed, number, plain_symbols, quantity, uncertain, uncertain_quantity, unit

if TYPE_CHECKING:
    from markupsafe import Markup

WIDER = 1.05  # times: a mean that is wider by less needs no word
SPREAD = 4  # digits of a number beside the scatter of individual gears
COLUMNS = (
    "path", "law", "unit", "file", "value", "sigma", "taken", "same_measurement", "sigmas_apart", "contradicts",
    "not_told_because",
)  # fmt: skip


def identify_report(found: Identified, provenance: Provenance | None = None) -> str:
    """The page, as one HTML file that needs nothing else.

    Args:
        found: what files tell
        provenance: how the page came to be, if that is to be shown

    Returns:
        HTML; the same for the same arguments
    """
    anchors = {id(finding): f"file-{place}" for place, finding in enumerate(found.files)}
    given = _given_with_all(found)
    return render(
        "identify.html.jinja",
        {
            "start": found.start,
            "counts": _counts(found),
            "contradictions": [_contradiction(each, other) for each in found.parameters for other in each.contradicts],
            "apart": number(APART),
            "agree": number(AGREE),
            "doubts": [(each.name, doubt) for each in found.files for doubt in each.doubts],
            "refused": [(each.name, each.refused) for each in found.files if each.refused],
            "given": [_constant(name, value) for name, value in given.items()],
            "files": [_file(each, anchors[id(each)], given) for each in found.files if not each.part_of],
            "points": [_file(each, "", given) for each in found.files if each.part_of],
            "mapping_from_options_points": list(
                dict.fromkeys(told for each in found.files if each.part_of for told in each.remarks)
            ),
            "numbers": [_number(each, found) for each in found.parameters],
            "comparisons": list(_comparisons(found)),
            "untold": _untold(found),
            "kept": _kept(found),
            "absent": _absent(found),
            "plates": list(_plates(found, anchors)),
            "provenance": provenance or Provenance(),
            "version": metadata.version("strainwave"),
            "light": figures.variables(figures.LIGHT),
            "dark": figures.variables(figures.DARK),
        },
    )


def _counts(found: Identified) -> str:
    """How many files came to what: "5 files: 3 tell 17 numbers, 1 shows what another file shows too, 1 is refused"."""
    refused = sum(bool(each.refused) for each in found.files)
    copies = sum(bool(each.same_as) and not each.refused for each in found.files)
    points = sum(bool(each.part_of) for each in found.files)
    given = [each for each in found.files if each.recognised is None or each.recognised.columns]  # no table of several files
    telling = sum(_tells(each) and not each.same_as for each in given)
    files, numbers = len(given), len(found.parameters)
    parts = [f"{telling} {'tells' if telling == 1 else 'tell'} {numbers} {'number' if numbers == 1 else 'numbers'}"]
    for count, one, several in (
        (copies, "shows what another file shows too", "show what others show too"),
        (points, "is a point of a table of several files", "are points of a table of several files"),
        (files - telling - copies - refused - points, "tells none", "tell none"),
        (refused, "is refused", "are refused"),
    ):
        parts += [f"{count} {one if count == 1 else several}"] if count else []
    return f"{files} {'file' if files == 1 else 'files'}: {', '.join(parts)}"


def _tells(finding: FileResult) -> bool:
    return any(not told.why for told in finding.estimates)


def _contradiction(each: CombinedParameter, other: str) -> dict[str, str]:
    best, told = each.of_file(each.source), each.others[other]
    return {
        "title": name_of(best),
        "path": best.path,
        "unit": unit(best.unit),
        "taken": uncertain(best.value, best.sigma),
        "source": each.source,
        "value": uncertain(told.value, told.sigma),
        "other": other,
        "distance": _sigmas(distance(best, told)),
    }


def _sigmas(distance: float) -> str:
    """Standard deviations, to a tenth where they are few."""
    return fixed(distance, 1 if distance < 10.0 else 0) if np.isfinite(distance) else "∞"


# ---- Files -----------------------------------------------------------------------------------------------------------


def _given_with_all(found: Identified) -> Mapping[str, float]:
    """The constants that a person gave with every file."""
    given = [set(each.recognised.constants.items()) for each in found.files if each.recognised and each.recognised.columns]
    return dict(sorted(set.intersection(*given))) if given else {}


def _constant(name: str, value: float) -> str:
    return f"{name.replace('_', ' ')} {quantity(value, CONSTANTS[name].unit)}"


def _file(finding: FileResult, anchor: str, given: Mapping[str, float]) -> dict[str, Any]:
    read = finding.recognised
    return {
        "name": finding.name,
        "anchor": anchor if finding.curves is not None else "",
        "kind": finding.what or (KINDS[read.kind] if read is not None else "not read"),
        "why": read.why if read is not None else (),
        "columns": list(_columns(finding, given)),
        "model": finding.model,
        "error": f"{number(100.0 * finding.error, 2)} %" if np.isfinite(finding.error) else "",
        "told": sum(not each.why for each in finding.estimates),
        "same_as": finding.same_as,
        "refused": finding.refused,
        "remarks": finding.remarks,
    }


def _columns(finding: FileResult, given: Mapping[str, float]) -> Iterator[str]:
    """Each channel with its column and unit in the file, "speed: Drehzahl [1/min]", and constants given with it alone."""
    read = finding.recognised
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


def _plates(found: Identified, anchors: dict[int, str]) -> Iterator[dict[str, Any]]:
    from markupsafe import Markup

    for finding in found.files:
        if finding.curves is not None:
            anchor = anchors[id(finding)]
            yield {
                "name": finding.name,
                "anchor": anchor,
                "caption": _caption(finding),
                "svg": Markup(plots.file_figure(finding, f"{anchor}-figure")),
            }
        if finding.between is not None:
            shafts = replace(finding, curves=finding.between, model=finding.between.title)
            anchor = f"{anchors[id(finding)]}-between"
            yield {
                "name": f"{finding.name}, between the shafts",
                "anchor": anchor,
                "caption": _caption(shafts),
                "svg": Markup(plots.file_figure(shafts, f"{anchor}-figure")),
            }


def _caption(finding: FileResult) -> str:
    curves = finding.curves
    assert curves is not None
    error, of = float(np.sqrt(np.mean(plots.residual_of(curves) ** 2))), curves.unit(curves.names[1])
    words = [f"Model: {finding.model}. Root mean square of what is left: {quantity(error, of)}."]
    if "residual" in curves:
        words.append("The slow part above is what load and lost motion add; it is taken out below, too.")
    if "held_out" in curves and curves["held_out"].any():
        words.append("Shaded: held out from the fit.")
    if finding.refused:
        words.append("This file is refused; its model is not used.")
    return " ".join(words)


# ---- Numbers ---------------------------------------------------------------------------------------------------------


def name_of(told: FileEstimate) -> str:
    """What a number is, in words, as its law has it.

    >>> name_of(FileEstimate("gear.friction_input.coulomb", "N.m", 0.05, 0.001, "")).lower()
    'kinetic friction torque f_c'
    >>> name_of(FileEstimate("gear.kinematic_error.amplitude of order 2", "rad", 6e-5, 1e-6, "fourier"))
    'Amplitude A_h at the output, of order 2'
    """
    path, _, order = told.path.partition(" of order ")
    path, _, place = path.removesuffix("]").partition("[")
    *parts, last = path.split(".")
    owners: list[Any] = [Drive]
    for part in parts:
        fields = [field for owner in owners for field in owner.fields if field["name"] == part and field["kind"] == "part"]
        owners = list(dict.fromkeys(option for field in fields for option in _options(field)))
    owners.sort(key=lambda owner: getattr(owner, "name", "") != told.law)  # the law that it belongs to comes first
    docs = [field["doc"] for owner in owners for field in owner.fields if field["name"] == last]
    words = docs[0] if docs else last.replace("_", " ").capitalize()
    if place:
        words += f", no. {int(place) + 1}"
    return f"{words}, of order {order}" if order else words


def _options(field: dict[str, Any]) -> list[Any]:
    """The laws that a part may have; one that has no choice is what it is by default."""
    return list(field["options"].values()) if field["options"] else [type(field["default"])]


def _number(each: CombinedParameter, found: Identified) -> dict[str, Any]:
    told, same_as = each.estimate, {finding.name: finding.same_as for finding in found.files}
    files = [each.source, *each.others] if len(each.mean_of) > 1 else list(each.others)
    return {
        "path": told.path,
        "name": name_of(told),
        "law": told.law if told.law.startswith(("in ", "of ", "at ")) else "",
        "unit": unit(told.unit),
        "value": uncertain(told.value, told.sigma),
        "source": each.source if len(each.mean_of) < 2 else f"the mean of {len(each.mean_of)} files",
        "widened": number(each.widened, 2) if each.widened > WIDER else "",
        "start": _start(found.start, told),
        "others": [
            {
                "file": name,
                "value": uncertain(each.of_file(name).value, each.of_file(name).sigma),
                "distance": "" if name == each.source else _sigmas(distance(each.of_file(each.source), each.of_file(name))),
                "counted": name in each.mean_of or name == each.source,
                "contradicts": name in each.contradicts,
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


def _start(start: GearSet, told: FileEstimate) -> str:
    """The number as the set had it that was started from; nothing where it had none, or one of another meaning."""
    if "[" in told.path or told.law == "in A":  # elements of a sequence that was fitted anew, or torque without a constant
        return ""
    try:
        value = float(attrgetter(told.path)(start))
    except AttributeError:
        return ""
    entry = start.sources.get(told.path)
    if entry is None:
        return number(value)
    if entry.spread is not None:
        return f"{number(value, SPREAD)} ± {number(100.0 * entry.spread, 2)} %"
    return number(value) if entry.uncertainty is None else uncertain(value, entry.uncertainty)


def _untold(found: Identified) -> list[tuple[str, str, list[dict[str, str]]]]:
    """What was fitted to a file, and is not told by it: the file, why, and the numbers."""
    untold: dict[tuple[str, str], list[dict[str, str]]] = {}
    for finding in found.files:
        for told in finding.estimates:
            if told.why or not np.isfinite(told.sigma):
                why = told.why or "the file does not determine it"
                value = uncertain_quantity(told.value, told.sigma, told.unit)
                number_there = {"name": name_of(told), "path": told.path, "value": value}
                untold.setdefault((finding.name, why), []).append(number_there)
    return [(*place, numbers) for place, numbers in untold.items()]


def _kept(found: Identified) -> dict[str, list[str]]:
    """The numbers of the gear of which no file tells anything, by where the set has them from."""
    told = {each.estimate.path for each in found.parameters}
    kept: dict[str, list[str]] = {}
    for path, (value, of) in verdict.numbers(found.gear_set.gear).items():
        entry = found.start.sources.get(path)
        unchanged = entry is not None and found.gear_set.sources.get(path) == entry
        if entry is not None and unchanged and path not in told and entry.source != NOT_GIVEN:
            kept.setdefault(entry.source, []).append(f"{path} = {number(value)} {unit(of)}".strip())
    return kept


def _absent(found: Identified) -> str:
    """What the model does without, as neither the set nor a file says anything of it."""
    sources = found.gear_set.sources
    parts = [path.rpartition(".")[0] for path, entry in sources.items() if entry.source == NOT_GIVEN]
    return ", ".join(part.removeprefix("gear.").replace("_", " ") for part in dict.fromkeys(parts))


# ---- Files beside each other -----------------------------------------------------------------------------------------


def _comparisons(found: Identified) -> Iterator[tuple[str, Markup]]:
    """A drawing for each part of the drive of which more than one file tells a number."""
    from markupsafe import Markup

    copies = {finding.name for finding in found.files if finding.same_as}
    parts: dict[str, list[CombinedParameter]] = {}
    for each in found.parameters:
        if each.others and (each.estimate.value != 0.0 or each.estimate.is_phase):
            parts.setdefault(each.estimate.path.partition(" of ")[0].rpartition(".")[0], []).append(each)
    for place, (part, numbers) in enumerate(parts.items()):
        rows = [(plain_symbols(name_of(each.estimate)), list(_rows(each, copies))) for each in numbers]
        yield part.removeprefix("gear.").replace("_", " ").capitalize(), Markup(plots.comparison(rows, f"comparison-{place}"))


def _rows(each: CombinedParameter, copies: set[str]) -> Iterator[plots.Row]:
    taken, mean = each.estimate, len(each.mean_of) > 1
    scale = 1.0 if taken.is_phase else abs(taken.value)  # a phase has no size: of it, 1 rad is 100 %
    title = f"mean of {len(each.mean_of)} files" if mean else each.source
    yield plots.Row(title, 0.0, 100.0 * taken.sigma / scale, "value taken")
    for name in [each.source, *each.others] if mean else each.others:
        other = each.of_file(name)
        look = "contradicts" if name in each.contradicts else "copy of another" if name in copies else "agrees"
        if look == "agrees" and name not in each.mean_of:
            look = "not counted"
        yield plots.Row(name, 100.0 * difference(other, taken) / scale, 100.0 * other.sigma / scale, look)


# ---- As files --------------------------------------------------------------------------------------------------------


def identify_files(found: Identified) -> dict[str, str]:
    """All that was found as JSON, and every number as every file tells it as CSV; in SI units, each beside its number."""
    text = StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(_csv_rows(found))
    return {"results.json": results_json(_results(found)), "numbers.csv": text.getvalue()}


def _results(found: Identified) -> dict[str, Any]:
    return {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "start": found.start.name,
        "files": [_file_results(each) for each in found.files],
        "numbers": [
            {
                **_told_results(each.estimate),
                "name": name_of(each.estimate),
                "file": each.source,
                "mean_of": each.mean_of if len(each.mean_of) > 1 else [],
                "widened": each.widened,
                "best": _told_results(each.of_file(each.source)),
                "others": [
                    {"file": name, **_told_results(other), "sigmas_apart": distance(each.of_file(each.source), other)}
                    for name, other in each.others.items()
                ],
                "contradicts": each.contradicts,
            }
            for each in found.parameters
        ],
    }


def _told_results(told: FileEstimate) -> dict[str, Any]:
    return {"path": told.path, "law": told.law, "unit": told.unit, "value": told.value, "sigma": told.sigma}


def _file_results(finding: FileResult) -> dict[str, Any]:
    read = finding.recognised
    return {
        "name": finding.name,
        "kind": None if read is None else read.kind,
        "why": [] if read is None else read.why,
        "columns": {} if read is None else read.columns,
        "units": {} if read is None else read.units,
        "side": None if read is None else read.side,
        "constants": {} if read is None else read.constants,
        "model": finding.model,
        "error_on_data_held_out": finding.error,
        "same_as": finding.same_as or None,
        "part_of": finding.part_of or None,
        "doubts": finding.doubts,
        "refused": finding.refused or None,
        "remarks": finding.remarks,
        "told": [{**_told_results(each), "not_told_because": each.why or None} for each in finding.estimates],
    }


def _csv_rows(found: Identified) -> Iterator[dict[str, Any]]:
    """What each file says of each number, the best first, and their mean; then what files do not tell."""
    copies = {finding.name for finding in found.files if finding.same_as}
    for each in found.parameters:
        best, mean = each.of_file(each.source), each.mean_of if len(each.mean_of) > 1 else ()
        for name in (each.source, *each.others):
            told = each.of_file(name)
            yield _told_results(told) | {
                "file": name,
                "taken": "in the mean" if name in mean else "yes" if name == each.source else "no",
                "same_measurement": "yes" if name in copies else "no",
                "sigmas_apart": distance(best, told),
                "contradicts": "yes" if name in each.contradicts else "no",
            }
        if mean:
            yield _told_results(each.estimate) | {"file": each.taken_from, "taken": "yes"}
    for finding in found.files:
        for told in finding.estimates:
            if told.why:
                yield _told_results(told) | {"file": finding.name, "taken": "no", "not_told_because": told.why}
