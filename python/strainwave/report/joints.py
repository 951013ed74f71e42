"""The page of all joints of an arm, the same in lines for a terminal, and as a table."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from io import StringIO
from typing import Any

from strainwave.identification.identify import Identified
from strainwave.identification.joints import Joints
from strainwave.identification.results.combined_parameter import lines_of
from strainwave.identification.results.file_result import FileEstimate
from strainwave.report.errors import LEAST_SQUARES, THIS_MODEL, ZERO_MODEL, held_out_rows
from strainwave.report.identify_files import failed_lines
from strainwave.report.page import render
from strainwave.report.parameter_names import name_of
from strainwave.report.provenance import Provenance
from strainwave.typeset import uncertain, unit

COLUMNS = ("joint", "path", "law", "unit", "value", "sigma", "file")


def joints_report(joints: Joints, provenance: Provenance | None = None) -> str:
    """Return the page as one HTML file; it links to the report of each joint, in the folder that `folder_of` names."""
    return render(
        "joints.html.jinja",
        {
            "verdict": _verdict(joints),
            "models": (THIS_MODEL, LEAST_SQUARES, ZERO_MODEL),
            "joints": [_joint(name, found) for name, found in joints.found.items()],
            "refused": list(joints.refused.items()),
            "left_out": list(joints.left_out.items()),
            "numbers": list(_rows(joints)),
        },
        provenance,
    )


def _verdict(joints: Joints) -> str:
    """Return the outcome in one sentence."""
    count, failed = len(joints.found), sum(bool(found.failed) for found in joints.found.values())
    state = f"{failed} of them with failed checks" if failed else "no check failed"
    refused = f"; {len(joints.refused)} cannot be used" if joints.refused else ""
    return f"{count} {'joint' if count == 1 else 'joints'} identified, {state}{refused}."


def folder_of(joint: str) -> str:
    """Return the name of the folder with the results of a joint.

    >>> folder_of("arm/elbow")
    'joint-arm_elbow'
    """
    return f"joint-{re.sub(r'[^A-Za-z0-9._-]', '_', joint)}"


def joints_summary(joints: Joints) -> Iterator[str]:
    """Yield what was identified of each joint, in lines."""
    for name, found in joints.found.items():
        yield f"joint {name}: {'; '.join(_of_files(found))}"
        yield from (f"  {line}" for line in failed_lines(found.failed))
        yield from lines_of(found.parameters)
    yield from (f"joint {name}: NOT USED: {why}" for name, why in joints.refused.items())
    yield from (f"{name}: NOT USED: {why}" for name, why in joints.left_out.items())


def joints_files(joints: Joints, provenance: Provenance | None = None) -> dict[str, str]:
    """Return the page, and every parameter of every joint as CSV in SI units, by file name."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for name, found in joints.found.items():
        for each in found.parameters:
            own = each.estimate
            writer.writerow([name, own.path, own.law, own.unit, own.value, own.sigma, each.taken_from])
    return {"joints.csv": text.getvalue(), "report.html": joints_report(joints, provenance)}


def _of_files(found: Identified) -> Iterator[str]:
    """Yield the model of each file, and its error on held-out data."""
    for each in found.files:
        error = f", RMS error on held-out data {each.held_out.words}" if each.held_out is not None else ""
        yield f"{each.name} {f'NOT USED: {each.refused}' if each.refused else each.model}{error}"


def _joint(name: str, found: Identified) -> dict[str, Any]:
    files = [
        {
            "name": each.name,
            "model": each.refused or each.model,
            "errors": {model: f"{size} ({share})" for model, size, share in held_out_rows(each.held_out)},
        }
        for each in found.files
    ]
    failed = dict.fromkeys(check.name for check in found.failed)
    return {"name": name, "report": f"{folder_of(name)}/report.html", "files": files, "failed": ", ".join(failed)}


def _rows(joints: Joints) -> Iterator[dict[str, Any]]:
    """Yield a row for each parameter of any joint, with its value of each joint; empty if a joint does not determine it."""
    table: dict[tuple[str, str], dict[str, FileEstimate]] = {}
    for joint, found in joints.found.items():
        for each in found.parameters:
            table.setdefault((each.estimate.path, each.estimate.unit), {}).setdefault(joint, each.estimate)
    for (path, of_unit), own in table.items():
        yield {
            "name": name_of(next(iter(own.values()))),
            "path": path,
            "unit": unit(of_unit),
            "values": [uncertain(own[joint].value, own[joint].sigma) if joint in own else "" for joint in joints.found],
        }
