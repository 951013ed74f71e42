"""Report of a compensation: what it gains over a tuned cascade, which effect each part removes, and what remains."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from importlib import metadata
from typing import Any

import numpy as np

from strainwave import typeset
from strainwave.drawing.style import FIGURE_WIDTH
from strainwave.files import gear_file
from strainwave.report import figures
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.report.results_json import results_json
from strainwave.tuning.candidates import GEAR_EFFECTS
from strainwave.tuning.compensate import Compensated, draw_errors
from strainwave.tuning.judging import Judged

NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
MAX_LISTED = 8  # controllers on a terminal
SECONDARY_WIDTH = 16  # characters


def compensate_summary(found: Compensated) -> str:
    """Return the result as lines of text, the verdict first."""
    return "\n".join(_lines(found)).replace(NO_BREAK_SPACE, " ")


def _lines(found: Compensated) -> Iterator[str]:
    yield found.verdict
    yield f"  {found.goal.judged_by} on the gears by which one was chosen, and median of {found.goal.secondary_figure}:"
    yield f"  {'as stated':>10}{'median':>10}{'95 % below':>12}{found.goal.secondary_figure:>{SECONDARY_WIDTH}}"
    for judged in found.tried[: 1 + MAX_LISTED]:
        stated, median, upper = _figures(judged, found)
        numbers = f"{stated:>10}{median:>10}{upper:>12}{_secondary(judged, found):>{SECONDARY_WIDTH}}"
        yield f"  {numbers}  {judged.candidate.name}"
    yield from (f"  {line}" for line in (*removed(found), *too_much(found), *elsewhere(found), margins(found)))
    yield from (f"  note: {remark}" for remark in found.remarks)


def _figures(judged: Judged, found: Compensated) -> list[str]:
    figure, unit = found.goal.judged_by, found.goal.units[found.goal.judged_by]
    return [_or_none(value, unit) for value in (judged.nominal[figure], judged.median(figure), judged.upper(figure))]


def _secondary(judged: Judged, found: Compensated) -> str:
    name = found.goal.secondary_figure
    return _or_none(judged.median(name), found.goal.units[name])


def _or_none(value: float, unit: str) -> str:
    """Return a number with its unit; a dash for one that is not reached, as a time that ends before the output settles."""
    return typeset.quantity(value, unit) if np.isfinite(value) else "\N{EN DASH}"


def removed(found: Compensated) -> Iterator[str]:
    """Yield for each effect the change by its model, if the models of all other effects are present."""
    setting, figure = found.tried[0].candidate.setting, found.goal.judged_by
    present = tuple(effect for effect in GEAR_EFFECTS if found.model_of((effect,), setting) is not None)
    whole = found.model_of(present, setting)
    for effect in present:
        rest = found.model_of(tuple(each for each in present if each != effect), setting) or found.tried[0]
        if whole is not None:
            before, after = rest.median(figure), whole.median(figure)
            does = "removes" if after < before else "adds"
            change, left = (typeset.quantity(each, found.goal.units[figure]) for each in (abs(before - after), after))
            yield f"{effect}: its model {does} {change} of {figure}; {left} are left with the models of all effects"


def too_much(found: Compensated) -> Iterator[str]:
    """Yield for each effect how much less of it the drive may have than the model of the chosen controller."""
    for each in found.over_compensation:
        first, most = each.factors[0], each.factors[-1]
        less = f"if the drive has up to {each.gains_up_to:g} times less of it than the model"
        gains = f"gains {less if each.gains_up_to > 1.0 else 'with none of these'}"
        fails = "" if each.stable_up_to == most else f"; runs fail above {each.stable_up_to:g} times"
        yield f"{each.effect}, tried with {first:g} to {most:g} times less: the controller {gains}{fails}"


def _too_much(found: Compensated) -> Iterator[tuple[str, str, str, str]]:
    """Yield effect, factor and the figures of cascade and chosen controller."""
    unit = found.goal.units[found.goal.judged_by]
    for each in found.over_compensation:
        for factor, before, after in zip(each.factors, each.baseline, each.chosen, strict=True):
            yield each.effect, f"{factor:g}", _or_none(before, unit), _or_none(after, unit)


def elsewhere(found: Compensated) -> Iterator[str]:
    """Yield the medians of cascade and chosen controller under other conditions, if one was chosen."""
    if found.is_compensated:
        for name, before, after in _conditions(found):
            yield f"{name}: {before} with the cascade, {after} with the chosen controller"


def _conditions(found: Compensated) -> Iterator[tuple[str, str, str]]:
    figure, unit = found.goal.judged_by, found.goal.units[found.goal.judged_by]
    for each in found.conditions:
        yield each.name, _or_none(each.baseline.median(figure), unit), _or_none(each.chosen.median(figure), unit)


def margins(found: Compensated) -> str:
    """Return the margins of both loops of the chosen controller."""
    return "; ".join(f"{name} loop: {', '.join(values)}" for name, *values in _margins(found, named=True))


def _margins(found: Compensated, named: bool = False) -> Iterator[tuple[str, ...]]:
    for name, loop in (("speed", found.margins.speed), ("position", found.margins.position)):
        yield (
            name,
            f"{'crossover ' if named else ''}{typeset.quantity(loop.crossover, 'rad/s')}",
            f"{'gain margin ' if named else ''}{f'{loop.gain:.3g}' if np.isfinite(loop.gain) else 'any'}",
            f"{'phase margin ' if named else ''}{f'{np.degrees(loop.phase):.0f}°' if np.isfinite(loop.phase) else 'any'}",
            f"{'modulus margin ' if named else ''}{loop.modulus:.2f}",
        )


def compensate_files(found: Compensated, provenance: Provenance | None = None) -> dict[str, str]:
    """Return the drive, its controller, the figures and the page, by file name."""
    whole = gear_file.text(found.saved)
    return {
        "drive.toml": whole,
        "compensation.toml": _table(whole, "control"),
        "results.json": results_json(_results(found)),
        "report.html": compensate_report(found, provenance),
    }


def _table(document: str, name: str) -> str:
    import tomlkit

    return tomlkit.dumps({name: tomllib.loads(document)[name]})


def _results(found: Compensated) -> dict[str, Any]:
    return {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "verdict": found.verdict.replace(NO_BREAK_SPACE, " "),
        "goal": found.goal.name,
        "judged_by": found.goal.judged_by,
        "units": dict(found.goal.units),
        "members": found.members,
        "chosen": found.chosen.candidate.name,
        "remarks": list(found.remarks),
        "margins": found.margins,
        "over_compensation": [
            {
                "effect": each.effect,
                "smaller_by": each.factors,
                "cascade": each.baseline,
                "chosen": each.chosen,
                "gains_up_to": each.gains_up_to,
                "stable_up_to": each.stable_up_to,
            }
            for each in found.over_compensation
        ],
        "conditions": [
            {
                "name": each.name,
                "cascade": each.baseline.median(found.goal.judged_by),
                "chosen": each.chosen.median(found.goal.judged_by),
            }
            for each in found.conditions
        ],
        "controllers": [
            {
                "name": each.candidate.name,
                "effects": list(each.candidate.effects),
                "failures": each.failures,
                "nominal": dict(each.nominal),
                "median": {name: each.median(name) for name in each.figures},
                "upper_95": {name: each.upper(name) for name in each.figures},
            }
            for each in found.tried
        ],
    }


def compensate_report(found: Compensated, provenance: Provenance | None = None) -> str:
    """Return the page of a compensation, as one HTML file that needs nothing else."""
    figure, units = found.goal.judged_by, found.goal.units
    shown = f"Error of the {'torque' if found.goal.name == 'torque' else 'output'}"
    title = f"{shown} of {found.gear_set.name}: cascade, and with the compensation chosen"
    return render(
        "compensate.html.jinja",
        {
            "name": found.gear_set.name,
            "verdict": found.verdict.replace(" %", f"{NO_BREAK_SPACE}%"),
            "figure": figure,
            "cascade": found.baseline.candidate.name,
            "rows": [
                (
                    each.candidate.name,
                    *_figures(each, found),
                    _secondary(each, found),
                    each.failures,
                    each.candidate is found.chosen.candidate,
                )
                for each in found.tried
            ],
            "others": [
                (name, _or_none(found.baseline.median(name), unit), _or_none(found.chosen.median(name), unit))
                for name, unit in units.items()
            ],
            "removed": list(removed(found)),
            "secondary_figure": found.goal.secondary_figure,
            "too_much": list(_too_much(found)),
            "limits": list(too_much(found)),
            "conditions": list(_conditions(found)) if found.is_compensated else [],
            "margins": list(_margins(found)),
            "remarks": found.remarks,
            "members": found.members,
            "picture_shows": shown,
            "picture": figures.inline(lambda canvas: draw_errors(canvas, found), (FIGURE_WIDTH, 3.0), "errors", title),
        },
        provenance,
    )
