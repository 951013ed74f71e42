"""The page of all joints of an arm, the same in lines for a terminal, and as a table."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from io import StringIO
from math import isfinite
from typing import Any

from strainwave.identification.identify import Identified
from strainwave.identification.joints import Joints
from strainwave.identification.results.combined_parameter import lines_of
from strainwave.identification.results.file_result import FileResult
from strainwave.report.page import render
from strainwave.report.parameter_names import name_of
from strainwave.report.provenance import Provenance
from strainwave.report.typeset import number, uncertain, unit

COLUMNS = ("joint", "path", "law", "unit", "value", "sigma", "file")


def joints_report(joints: Joints, provenance: Provenance | None = None) -> str:
    """The page, as one HTML file; the report of each joint lies in the folder beside it that `folder_of` names."""
    return render(
        "joints.html.jinja",
        {
            "joints": [_joint(name, found) for name, found in joints.found.items()],
            "refused": list(joints.refused.items()),
            "left_out": list(joints.left_out.items()),
            "numbers": list(_rows(joints)),
        },
        provenance,
    )


def folder_of(joint: str) -> str:
    """The folder with the results of a joint.

    >>> folder_of("arm/elbow")
    'joint-arm_elbow'
    """
    return f"joint-{re.sub(r'[^A-Za-z0-9._-]', '_', joint)}"


def joints_summary(joints: Joints) -> Iterator[str]:
    """Yield what was identified of each joint, in lines."""
    for name, found in joints.found.items():
        yield f"joint {name}: {'; '.join(_of_files(found))}"
        yield from (f"  FAILED: {check.source}: {check.message}. What to do: {check.remedy}" for check in found.failed)
        yield from lines_of(found.parameters)
    yield from (f"joint {name}: NOT USED: {why}" for name, why in joints.refused.items())
    yield from (f"{name}: NOT USED: {why}" for name, why in joints.left_out.items())


def joints_csv(joints: Joints) -> str:
    """Every number of every joint, a row each, in SI units."""
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for name, found in joints.found.items():
        for each in found.parameters:
            told = each.estimate
            writer.writerow([name, told.path, told.law, told.unit, told.value, told.sigma, each.taken_from])
    return text.getvalue()


def _of_files(found: Identified) -> Iterator[str]:
    """What was made of each file."""
    for each in found.files:
        held_out = f", error on data held out {_error(each)} of what varies" if _error(each) else ""
        yield f"{each.name} {f'NOT USED: {each.refused}' if each.refused else each.model}{held_out}"


def _error(finding: FileResult) -> str:
    return f"{number(100.0 * finding.error, 2)} %" if isfinite(finding.error) else ""


def _joint(name: str, found: Identified) -> dict[str, Any]:
    return {
        "name": name,
        "report": f"{folder_of(name)}/report.html",
        "files": [{"name": each.name, "model": each.refused or each.model, "error": _error(each)} for each in found.files],
        "failed": [f"{check.source}: {check.message}. What to do: {check.remedy}" for check in found.failed],
    }


def _rows(joints: Joints) -> Iterator[dict[str, Any]]:
    """Yield a row for each parameter of any joint, with its value of each joint; empty if a joint does not determine it."""
    keys = dict.fromkeys(
        (each.estimate.path, each.estimate.unit) for found in joints.found.values() for each in found.parameters
    )
    for path, of_unit in keys:
        told = {
            name: next(
                (each.estimate for each in found.parameters if (each.estimate.path, each.estimate.unit) == (path, of_unit)),
                None,
            )
            for name, found in joints.found.items()
        }
        first = next(each for each in told.values() if each is not None)
        yield {
            "name": name_of(first),
            "path": path,
            "unit": unit(of_unit),
            "values": ["" if each is None else uncertain(each.value, each.sigma) for each in told.values()],
        }
