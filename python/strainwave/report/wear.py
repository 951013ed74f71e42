"""Report of the wear of a gear by repeated tests: its rates, and the remaining life with its interval."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from importlib import metadata
from math import inf, isfinite
from typing import TYPE_CHECKING

import numpy as np

from strainwave.diagnose.wear import QUANTITY_UNITS, WearLife, WearTrend
from strainwave.diagnose.wear_tests import WearTests
from strainwave.drawing import marks
from strainwave.drawing.style import FIGURE_WIDTH, LIGHT
from strainwave.presentation import PAGE_WIDTH
from strainwave.report import figures
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import results_json
from strainwave.typeset import number, quantity, uncertain_quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_DRAWN_LIFE = 3.0  # of the tested work: a line to a limit further on is cut


def wear_summary(tests: WearTests, life: WearLife, work_per_hour: float | None = None) -> str:
    """Return rates and life as lines of text."""
    lines = [f"{len(tests.work)} tests over {quantity(float(np.ptp(tests.work)), 'J')} of transmitted work"]
    for trend in life.trends:
        life_of_it = f"limit {_limit(trend)} after {_span(trend.low, trend.high)}"
        lines.append(f"  {trend.name} ({tests.names[trend.name]}): {_rate(trend)}, {life_of_it}")
    lines += list(_life(life, work_per_hour))
    for remark in life.remarks:
        lines += textwrap.wrap(remark, PAGE_WIDTH, initial_indent="  note: ", subsequent_indent="    ")
    return "\n".join(lines).replace("\N{NO-BREAK SPACE}", " ")


def _rate(trend: WearTrend) -> str:
    unit = QUANTITY_UNITS[trend.name]
    start = quantity(trend.start, unit, 4)
    return f"{start} at no work, {uncertain_quantity(1e6 * trend.rate, 1e6 * trend.rate_sigma, f'{unit}/MJ')}"


def _limit(trend: WearTrend) -> str:
    return quantity(trend.limit, QUANTITY_UNITS[trend.name], 4)


def _span(low: float, high: float) -> str:
    return f"{quantity(low, 'J')} to {quantity(high, 'J')} more" if isfinite(high) else f"more than {quantity(low, 'J')}"


def _life(life: WearLife, work_per_hour: float | None) -> Iterator[str]:
    if life.limited_by:
        yield f"remaining life: {quantity(life.remaining, 'J')}, 95 %: {_span(life.low, life.high)}, by its {life.limited_by}"
    else:
        yield f"remaining life not determined: {_span(life.low, inf)}"
    if work_per_hour is not None:
        hours = f"{number(life.low / work_per_hour, 3)} h"
        more = f" to {number(life.high / work_per_hour, 3)} h" if isfinite(life.high) else " or more"
        yield f"  at {quantity(work_per_hour, 'J')} an hour: {hours}{more}"


def wear_files(
    tests: WearTests, life: WearLife, work_per_hour: float | None = None, provenance: Provenance | None = None
) -> dict[str, str | bytes]:
    """Return the numbers as JSON, and last the page, by file name."""
    results = {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "tests": tests,
        "life": life,
        "work_per_hour": work_per_hour,
    }
    return {"results.json": results_json(results), "report.html": wear_report(tests, life, work_per_hour, provenance)}


def wear_report(
    tests: WearTests, life: WearLife, work_per_hour: float | None = None, provenance: Provenance | None = None
) -> str:
    """Return the page, as one HTML file that needs nothing else."""
    rows = [
        {
            "name": trend.name,
            "of": tests.names[trend.name],
            "rate": _rate(trend),
            "limit": _limit(trend),
            "life": _span(trend.low, trend.high),
        }
        for trend in life.trends
    ]
    content = {"rows": rows, "lines": list(_life(life, work_per_hour)), "remarks": life.remarks, "figure": _figure(tests, life)}
    return render("diagnose_wear.html.jinja", content, provenance)


def _figure(tests: WearTests, life: WearLife) -> str:
    """Return the values of each quantity over the work, with their lines and limits."""
    work = 1e-6 * np.array(tests.work)

    def draw(figure: Figure) -> None:
        every = figure.subplots(len(life.trends), 1, sharex=True, squeeze=False)[:, 0]
        for axes, trend in zip(every, life.trends, strict=True):
            unit = QUANTITY_UNITS[trend.name]
            end = work.max() + min(1e-6 * trend.remaining, MAX_DRAWN_LIFE * float(np.ptp(work)))
            line = np.array([work.min(), end])
            axes.axhline(trend.limit, color=LIGHT["muted"], linewidth=0.9, label="limit")
            axes.plot(line, trend.start + 1e6 * trend.rate * line, color=LIGHT["model"], label="line")
            axes.plot(work, tests.values[trend.name], "o", color=LIGHT["measured"], label="tests")
            if isfinite(trend.high):
                life_left = work.max() + 1e-6 * np.array([trend.low, trend.high])
                drawn = np.minimum(life_left, work.max() + MAX_DRAWN_LIFE * float(np.ptp(work)))
                if drawn[0] < drawn[1]:
                    axes.plot(drawn, [trend.limit] * 2, color=LIGHT["model"], linewidth=4.0, alpha=0.4, label="life, 95 %")
            marks.label_axes(axes, trend.name, unit)
        marks.label_abscissa(every[-1], "transmitted work", "MJ")
        marks.legend(figure, every[0])

    return figures.inline(draw, (FIGURE_WIDTH, 0.8 + 1.8 * len(life.trends)), "wear", "Wear over the transmitted work")
