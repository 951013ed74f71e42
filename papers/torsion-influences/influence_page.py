"""The page of what influences a torsion loop, and the same in lines for a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from math import degrees
from pathlib import Path
from typing import Any

import influence_figures as plots
import strainwave as sw
from influence_claims import InfluenceClaim, counts, entries, life, over_size, steps_and_falls
from jinja2 import Environment, StrictUndefined
from strainwave.typeset import ARCMIN_PER_RADIAN, fixed, number, quantity
from torsion_influences import OWN, SPECIMEN, Influence, Sweep

LETTERS_PER_LINE = 110  # on a terminal


def write_page(found: Influence, folder: Path) -> None:
    """Write the page as page.md, and its figures, into a folder."""
    for name, figure in plots.figures(found).items():
        figure.savefig(folder / f"{name}.svg")
    (folder / "page.md").write_text(page(found), encoding="utf-8")


def page(found: Influence) -> str:
    """Return the page in Markdown; its figures are files beside it."""
    environment = Environment(undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    template = environment.from_string(Path(__file__).with_name("page.md.jinja").read_text(encoding="utf-8"))
    table, age = entries(found), life(found)
    series = found.series
    return template.render(
        title=found.gear_set.name,
        torque=quantity(found.torque, "N.m", 3),
        input_torque=quantity(found.input_torque, "N.m", 3),
        friction=quantity(found.friction, "N.m", 3),
        table=[*table, *([age] if age else [])],
        counts=list(counts(table)),
        levels=[
            _level_table(f"{found.gear_set.name}, at the output", found.amplitude[OWN], ARCMIN_PER_RADIAN, "′"),
            _level_table("The article’s gear, at the input", found.amplitude[SPECIMEN], degrees(1.0), "°"),
        ],
        steps=steps_and_falls(found.rows)[0],
        sizes=list(_size_rows(found)),
        shares={part: f"{number(100.0 * share, 3)} %" for part, share in found.shares.items()},
        has_friction=found.preload is not None,
        rates=list(_rate_rows(found)),
        series=None if series is None else f"{series.name}, {len(series)} loops",
        listing=sw.listing(found.gear_set),
    )


def summary(found: Influence) -> str:
    """Return the results as lines of text."""
    table, age = entries(found), life(found)
    lines = [f"{found.gear_set.name}: loops up to {quantity(found.torque, 'N.m', 3)} at the output"]
    lines += [", ".join(f"{count} {verdict}" for verdict, count in counts(table))]
    for each in (*table, *([age] if age else [])):
        lines += ["", *_entry_lines(each)]
    return "\n".join(lines)


def _entry_lines(entry: InfluenceClaim) -> Iterator[str]:
    yield from textwrap.wrap(f"{entry.parameter}, {entry.regime}: “{entry.words}”", LETTERS_PER_LINE)
    inside = textwrap.TextWrapper(LETTERS_PER_LINE, initial_indent="  ", subsequent_indent="  ")
    yield from inside.wrap(f"{entry.verdict}: {entry.answer}")
    if entry.measured:
        yield from inside.wrap(f"measured, {entry.measured_verdict}: {' '.join(entry.measured)}")


def tables(found: Influence) -> dict[str, sw.Recording]:
    """The sweeps as tables, by name."""
    named = {
        "torque-level": (found.amplitude[OWN], "torque_max", "N.m"),
        "torque-level-article": (found.amplitude[SPECIMEN], "torque_max", "N.m"),
        "modulus": (found.material, "modulus", "1"),
        "temperature": (found.temperature, "temperature", "K"),
    }
    if found.preload is not None:
        named["preload"] = (found.preload, "preload", "1")
    return {name: _table(*each) for name, each in named.items()}


UNITS = {"area": "J", "width": "rad", "width_at_zero": "rad"}


def _table(sweep: Sweep, name: str, unit: str) -> sw.Recording:
    columns = {name: sweep.levels, **sweep.figures}
    return sw.Recording(columns, {name: unit, **{each: UNITS.get(each, "N.m/rad") for each in sweep.figures}})


def _level_table(title: str, sweep: Sweep, angle: float, unit: str) -> dict[str, Any]:
    return {"title": title, "rows": list(_level_rows(sweep, angle, unit))}


def _level_rows(sweep: Sweep, angle: float, unit: str) -> Iterator[list[str]]:
    for row, level in enumerate(sweep.levels.tolist()):
        yield [
            quantity(level, "N.m", 3),
            quantity(float(sweep["area"][row]), "J", 3),
            f"{number(angle * float(sweep['width'][row]), 3)}{unit}",
            *(quantity(float(sweep[name][row]), "N.m/rad", 3) for name in ("high_stiffness", "low_stiffness", "stiffness")),
        ]


def _size_rows(found: Influence) -> Iterator[list[str]]:
    for ratio in sorted({row.ratio for row in found.rows}):
        sizes = sorted(row.size for row in found.rows if row.ratio == ratio)
        if len(sizes) > 3:
            powers = [over_size(found.rows, ratio, name) for name in ("k1", "k2", "k3", "t1")]
            yield [str(ratio), f"{sizes[0]} to {sizes[-1]}", *(f"{fixed(v, 2)} ± {fixed(h, 2)}" for v, h in powers)]


def _rate_rows(found: Influence) -> Iterator[list[str]]:
    rates = found.rates
    values = (rates.stiffness, rates.hysteresis, rates.friction)
    for words, value, source in zip(("Spring", "Hysteresis", "Friction at the input"), values, rates.sources, strict=True):
        yield [words, f"{number(100.0 * value, 3)} % per kelvin", source]
