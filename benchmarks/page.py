"""Brings docs/validation/benchmarks.md up to date with the last runs: its pictures, and each table whose columns it knows.

A part that has not been run keeps what the page has. A table of solvers keeps its selection of rows.

python benchmarks/page.py
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import scaling
import single
import targets
from report import TABLES, save_figure, saved

DOCS = Path(__file__).resolve().parent.parent / "docs"
PAGE, PICTURES = DOCS / "validation" / "benchmarks.md", DOCS / "pictures"
SELECTED = "| solver | setting |"  # how a table begins of which the page shows the rows that it has


def draw() -> list[str]:
    """Draws the pictures of the parts that have been run; returns the names of the others."""
    precision, growth = saved("single"), saved("scaling")
    if precision is not None:
        save_figure("work_precision", single.drawn(targets.results(precision)), precision, PICTURES)
    if growth is not None:
        lines = [scaling.Line(**line) for line in growth["results"]]
        save_figure("growth", scaling.drawn(lines), growth, PICTURES)
    return [part for part, found in (("single", precision), ("scaling", growth)) if found is None]


def label(row: str) -> tuple[str, str]:
    """Return solver and setting of a row, without the star of an inaccurate one."""
    solver, setting = row.split("|")[1:3]
    return solver.strip().removesuffix(" *"), setting.strip()


def selected(table: str, shown: list[str]) -> str:
    """Return the rows of a table of solvers that the page shows, and end if one is missing; any other table whole."""
    if not table.startswith(SELECTED):
        return table
    heading, rule, *rows = table.splitlines(keepends=True)
    labels = [label(row) for row in shown]
    if missing := [each for each in labels[1:] if each not in map(label, rows)]:  # the first is the rule below the heading
        sys.exit(f"page: the run has no row {', '.join(missing[0])}, which {PAGE.name} shows: measure it or delete it there")
    return "".join([heading, rule, *(row for row in rows if label(row) in labels)])


def replaced(page: str, table: str) -> str:
    """The page with a table in place of that with the same columns."""
    heading = table.partition("\n")[0] + "\n"
    if page.count(heading) != 1:
        sys.exit(f"page: {PAGE.name} has not one table with the columns {heading.strip()}")
    before, _, after = page.partition(heading)
    rows = after.splitlines(keepends=True)
    own = next((i for i, row in enumerate(rows) if not row.startswith("|")), len(rows))
    return before + selected(table, rows[:own]) + "".join(rows[own:])


if __name__ == "__main__":
    if missing := draw():
        print(f"page: pictures kept, as benchmarks/run.py --only {','.join(missing)} has not been run")
    page = PAGE.read_text()
    for kept in sorted(TABLES.glob("*.md")):
        page = replaced(page, kept.read_text())
    partial = PAGE.with_suffix(".partial")
    partial.write_text(page)
    os.replace(partial, PAGE)
