"""Results of an identification as files, and as lines for a terminal."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict
from importlib import metadata
from io import StringIO
from itertools import groupby
from math import isfinite
from pathlib import Path
from typing import Any

from strainwave.files import gear_file
from strainwave.identification.checks.comparisons import AGREEMENT
from strainwave.identification.identify import Identified
from strainwave.identification.results.combined_parameter import CombinedParameter, distance, lines_of
from strainwave.identification.results.drive import not_written
from strainwave.identification.results.file_result import ASSUMED_BY_RECORDER, Check, FileEstimate, FileResult
from strainwave.messages import listed, with_options
from strainwave.report.identify import identify_report
from strainwave.report.parameter_names import name_of
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import results_json
from strainwave.workbench import page as workbench

COLUMNS = (
    "path", "law", "unit", "file", "value", "sigma", "taken", "same_measurement", "sigmas_apart", "contradicts",
    "state", "reason",
)  # fmt: skip
WORKBENCH = "workbench.html"
MAX_REMARKS = 8  # of a file on a terminal; the report has all


def identify_files(
    found: Identified,
    provenance: Provenance | None = None,
    *,
    accepted: bool = False,
    folder: Path = Path(),
    remark: str = "",
) -> dict[str, str]:
    """Return the files of a result by their names: numbers as JSON and CSV, the gear, and the report.

    If the workbench is installed, its page with the gear is among them.

    Args:
        found: the result
        provenance: command, date and files, if the report is to show them
        accepted: if true, the gear is among them in spite of failed checks
        folder: that they are written into, as the commands of the report name it
        remark: a sentence for the box of failed checks in the report
    """
    text = StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(_csv_rows(found))
    files = {"results.json": results_json(_results(found)), "numbers.csv": text.getvalue()}
    if accepted or not found.failed:
        files["gear.toml"] = gear_file.text(found.accepted)
        if workbench.is_installed():
            with suppress(ValueError):  # of a drive that cannot be assumed: no page, but the report
                files[WORKBENCH] = workbench.page(found.accepted)
    link = WORKBENCH if WORKBENCH in files else ""
    report = identify_report(found, provenance, accepted=accepted, folder=folder, remark=remark, workbench=link)
    return files | {"report.html": report}


def _results(found: Identified) -> dict[str, Any]:
    return {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "start": found.start_set.name,
        "failed": [check.name for check in found.failed],
        "checks": [asdict(check) for check in found.checks],
        "files": [_file(each) for each in found.files],
        "parameters": [_parameter(each) for each in found.parameters],
        "states": [asdict(each) for each in found.states],
    }


def _file(result: FileResult) -> dict[str, Any]:
    read = result.recognised
    return {
        "name": result.name,
        "kind": None if read is None else read.kind,
        "why": [] if read is None else read.why,
        "columns": {} if read is None else read.columns,
        "units": {} if read is None else read.units,
        "side": None if read is None else read.side,
        "constants": {} if read is None else read.constants,
        "model": result.model,
        "candidates": [{"model": name, "error": error} for name, error in result.candidates],
        "held_out": None if result.held_out is None else asdict(result.held_out),
        "same_as": result.same_as or None,
        "part_of": result.part_of or None,
        "failed": [check.name for check in result.failed],
        "refused": result.refused or None,
        "remarks": result.remarks,
        "estimates": [
            {
                **_estimate(each),
                "state": each.state,
                "reason": each.why or None,
                "shift_by_kept": dict(each.shift_by_kept),
            }
            for each in result.estimates
        ],
    }


def _parameter(each: CombinedParameter) -> dict[str, Any]:
    best = each.of_file(each.source)
    return {
        **_estimate(each.estimate),
        "name": name_of(each.estimate),
        "file": each.source,
        "mean_of": each.mean_of if len(each.mean_of) > 1 else [],
        "widened": each.widened,
        "best": _estimate(best),
        "others": [
            {"file": name, **_estimate(other), "sigmas_apart": distance(best, other)} for name, other in each.others.items()
        ],
        "contradicts": each.contradicts,
    }


def _estimate(estimate: FileEstimate) -> dict[str, Any]:
    return {name: getattr(estimate, name) for name in ("path", "law", "unit", "value", "sigma")}


def _csv_rows(found: Identified) -> Iterator[dict[str, Any]]:
    """Yield the estimates of each parameter, the best first, and their mean; then what files do not determine."""
    copies = {file.name for file in found.files if file.same_as}
    for each in found.parameters:
        best, mean = each.of_file(each.source), each.mean_of if len(each.mean_of) > 1 else ()
        for name in (each.source, *each.others):
            estimate = each.of_file(name)
            yield _estimate(estimate) | {
                "file": name,
                "taken": "in the mean" if name in mean else "yes" if name == each.source else "no",
                "same_measurement": "yes" if name in copies else "no",
                "sigmas_apart": distance(best, estimate),
                "contradicts": "yes" if name in each.contradicts else "no",
                "state": estimate.state,
            }
        if mean:
            yield _estimate(each.estimate) | {"file": each.taken_from, "taken": "yes", "state": "identified"}
    for file in found.files:
        for estimate in file.estimates:
            if estimate.why:
                row = {"file": file.name, "taken": "no", "state": estimate.state, "reason": estimate.why}
                yield _estimate(estimate) | row


# ---- On a terminal ---------------------------------------------------------------------------------------------------


def identify_summary(found: Identified) -> Iterator[str]:
    """Yield the result in lines, failed checks first, then what was measured in A."""
    yield from failed_lines(found.failed)
    if in_current := not_written(found.files):
        yield f"{found.gear_set.name}: {in_current}"
    points = [result for result in found.files if result.part_of]
    for result in found.files:
        if not result.part_of:
            yield from _of_file(result)
    if points:
        yield f"{points[0].part_of}, {len(points)} files:"
        width = max(len(result.name) for result in points)
        yield from (f"  {result.name:{width}}  {result.model}" for result in points)
        yield from (f"  {remark}" for remark in dict.fromkeys(remark for result in points for remark in result.remarks))
    yield ""
    yield from lines_of([*found.parameters, *_in_combination(found)])
    yield from _not_identified(found)
    passed = [check for check in found.checks if check.name == AGREEMENT and not check.failed and check.message]
    yield from (f"{check.source}: {check.message}" for check in passed)
    if refused := [file.name for file in found.files if file.refused]:
        yield f"\nNOT USED, {len(refused)} of {len(found.files)} files, for the reasons above: {listed(refused)}"


def failed_lines(failed: Iterable[Check]) -> Iterator[str]:
    """Yield failed checks in lines, with what to do once behind those that have the same remedy."""
    for remedy, checks in groupby(failed, lambda check: check.remedy):
        yield from (f"FAILED: {check.source}: {check.message}" for check in checks)
        yield f"  what to do: {with_options(remedy)}"


def _in_combination(found: Identified) -> Iterator[CombinedParameter]:
    """Yield the estimates that a file determines in combination with others, unless another file determines them alone."""
    alone = {each.estimate.label for each in found.parameters}
    for file in found.files:
        for each in file.estimates:
            if each.in_combination and each.label not in alone:
                yield CombinedParameter(each, f"{file.name}, identified in combination")


def _not_identified(found: Identified) -> Iterator[str]:
    """Yield a line for each file and reason with the parameters of the gear that it does not determine, nor another file."""
    determined = {each.estimate.path for each in found.parameters}
    for file in found.files:
        reasons: dict[str, list[str]] = {}
        for each in file.estimates:
            shown = each.path.startswith("gear.") or each.why == ASSUMED_BY_RECORDER
            if each.state == "not identified" and shown and each.path not in determined:
                sigma = f" ± {each.sigma:.2g}" if isfinite(each.sigma) else ""
                reasons.setdefault(each.why, []).append(f"{each.label} {each.value:.3g}{sigma} {each.unit}")
        yield from (f"  not identified: {', '.join(numbers)}, {file.name}: {why}" for why, numbers in reasons.items())


def first_remarks(remarks: Sequence[str], before: str) -> Iterator[str]:
    """Yield the remarks that a terminal shows, and how many more the report has."""
    yield from (f"{before}{with_options(remark)}" for remark in remarks[:MAX_REMARKS])
    if len(remarks) > MAX_REMARKS:
        yield f"{before}{len(remarks) - MAX_REMARKS} more in the report"


def _of_file(result: FileResult) -> Iterator[str]:
    same = f", the same measurement as {result.same_as}" if result.same_as else ""
    yield f"{result.name}: {result.title}{same}"
    if result.recognised is not None:
        yield from (f"  since {why}" for why in result.recognised.why)
    if result.refused:
        yield f"  NOT USED: {with_options(result.refused)}"
        return
    yield f"  {result.model}{f'; RMS error on held-out data: {result.held_out.words}' if result.held_out is not None else ''}"
    if result.failed:
        yield f"  FAILED: {', '.join(check.name for check in result.failed)}; see above"
    yield from first_remarks(result.remarks, "  ")
