"""Report of a planned diagnosis: the smallest kinematic error that a record would show, by order and duration."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata

from strainwave.diagnose.smallest_error import DetectionLimit
from strainwave.files.typical_gear import RAD_PER_ARCMIN
from strainwave.presentation import PAGE_WIDTH
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import results_json
from strainwave.typeset import number, quantity


@dataclass(frozen=True)
class PlannedRecord:
    """Record for which detection limits are computed.

    Attributes:
        drive: its name
        speed: of the input [rad/s]
        load_torque: at the output [N.m]
        duration: of the record [s]
        sample_rate: of the current [Hz]
        noise: standard deviation of a sample of the current [A]
    """

    drive: str
    speed: float
    load_torque: float
    duration: float
    sample_rate: float
    noise: float

    @property
    def facts(self) -> dict[str, str]:
        """Settings in words."""
        return {
            "Drive": self.drive,
            "Speed of the input": quantity(self.speed, "rad/s", 4),
            "Load at the output": quantity(self.load_torque, "N.m", 4),
            "Record": f"{number(self.duration, 4)} s at {number(self.sample_rate, 5)} Hz",
            "Noise of a sample": quantity(self.noise, "A", 3),
        }


def plan_summary(record: PlannedRecord, limits: Sequence[DetectionLimit]) -> str:
    """Return the limits as lines of text."""
    first = limits[0]
    lines = [
        f"{record.drive}: {', '.join(f'{name.lower()} {value}' for name, value in record.facts.items() if name != 'Drive')}",
        f"smallest kinematic error that is found with probability {number(first.probability)}, at a false-alarm rate of "
        f"{number(first.false_alarm)}:",
    ]
    for each in limits:
        lines.append(f"  {_sentence(each)}")
        for remark in each.remarks:
            lines += textwrap.wrap(remark, PAGE_WIDTH, initial_indent="    note: ", subsequent_indent="      ")
    return "\n".join(lines).replace("\N{NO-BREAK SPACE}", " ")


def _sentence(each: DetectionLimit) -> str:
    size = f"{number(each.arcminutes, 3)}′ at the output, {quantity(each.current, 'A')} in the current"
    return f"order {number(each.order, 5)}: {size}{' (insensitive)' if each.insensitive else ''}"


def plan_files(
    record: PlannedRecord, limits: Sequence[DetectionLimit], provenance: Provenance | None = None
) -> dict[str, str | bytes]:
    """Return the numbers as JSON, and last the page, by file name."""
    results = {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "record": record,
        "limits": [{**vars(each), "gain": [each.gain.real, each.gain.imag], "arcminutes": each.arcminutes} for each in limits],
    }
    return {"results.json": results_json(results), "report.html": plan_report(record, limits, provenance)}


def plan_report(record: PlannedRecord, limits: Sequence[DetectionLimit], provenance: Provenance | None = None) -> str:
    """Return the page, as one HTML file that needs nothing else."""
    rows = [
        {
            "order": number(each.order, 5),
            "error": f"{number(each.arcminutes, 3)}′",
            "current": quantity(each.current, "A"),
            "allowed": f"{number(each.accuracy / RAD_PER_ARCMIN, 3)}′",
            "state": "insensitive" if each.insensitive else "sensitive",
        }
        for each in limits
    ]
    remarks = [f"order {number(each.order, 5)}: {remark}" for each in limits for remark in each.remarks]
    first = limits[0]
    rates = {"probability": number(first.probability), "false_alarm": number(first.false_alarm)}
    content = {"facts": record.facts, "rows": rows, "remarks": remarks, **rates}
    return render("diagnose_plan.html.jinja", content, provenance)
