"""The page of the influences on the loops of a measured series, and the same in lines for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from math import isfinite
from typing import Any

from strainwave.report.influence_figures import series_figure
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.rig.influence.series import FACTORS, QUANTITIES, Series
from strainwave.rig.influence.trend import SHUFFLE_COUNT, Trend
from strainwave.rig.influence.trend_words import bent_words, chance, change_of, trend_words

LETTERS_PER_LINE = 110  # on a terminal


def influence_report(series: Series, trends: Sequence[Trend], provenance: Provenance | None = None) -> str:
    """Return the page, as one HTML file that needs nothing else.

    Args:
        series: what was measured
        trends: of it, as `analyse_series` returns them
        provenance: how the page came to be, if that is to be shown

    Returns:
        HTML; the same for the same arguments
    """
    return render(
        "influence.html.jinja",
        {
            "title": series.name,
            "points": len(series),
            "figures": [series_figure(series, trends, name) for name in FACTORS if name in series.varied],
            "sentences": [trend_words(each) for each in trends],
            "trends": [_row(each) for each in trends],
            "shuffles": SHUFFLE_COUNT,
        },
        provenance,
    )


def summary(series: Series, trends: Sequence[Trend]) -> str:
    """Return the trends as lines of text, a sentence for each."""
    lines = [f"{series.name}, {len(series)} loops"]
    for each in trends:
        lines += textwrap.wrap(trend_words(each), LETTERS_PER_LINE, initial_indent="  ", subsequent_indent="    ")
    return "\n".join(lines)


def _row(trend: Trend) -> dict[str, Any]:
    return {
        "quantity": QUANTITIES[trend.quantity][0],
        "factor": FACTORS[trend.factor].words,
        "words": f"{change_of(trend)}{bent_words(trend)}" if isfinite(trend.slope.value) else trend_words(trend),
        "p": chance(trend.slope.p).removeprefix("= "),
        "corrected": chance(trend.corrected).removeprefix("= "),
        "shuffled": chance(trend.shuffled).removeprefix("= "),
        "significant": "significant" if trend.significant else "not significant",
    }
