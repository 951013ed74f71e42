"""Summary and numbers of an export: what was written, and what it loses against the gear."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import metadata
from math import isfinite

import numpy as np

from strainwave import typeset
from strainwave.export.exported import Exported
from strainwave.files.recording import Recording
from strainwave.report.results_json import results_json
from strainwave.tuning.loss import ExportLoss

NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
NUMBERS_FILE = "export.json"
MAX_PRINTED_ROWS = 12  # of a table
MIN_STATED_SHARE = 1e-9  # a smaller loss is rounding


def export_summary(found: Exported) -> str:
    """Return the numbers of an export as lines of text, with its losses and remarks."""
    return "\n".join(_lines(found)).replace(NO_BREAK_SPACE, " ")


def _lines(found: Exported) -> Iterator[str]:
    yield f"{found.gear}: {found.kind}"
    yield from (f"  {name:20} {typeset.quantity(value, unit, 6)}" for name, (value, unit) in found.numbers.items())
    if found.table is not None:
        yield from (f"  {line}" for line in _table_lines(found.table))
    yield "loss against the gear:"
    yield from (f"  {loss_words(each)}" for each in found.losses)
    yield from (f"  left out: {each}" for each in found.left_out)
    yield from (f"note: {each}" for each in found.remarks)


def _table_lines(table: Recording) -> Iterator[str]:
    """Yield the header and at most 12 rows of a table, evenly spread."""
    yield "".join(f"{f'{name} [{unit}]':>22}" for name, unit in table.units.items())
    shown = np.unique(np.linspace(0, len(table) - 1, min(len(table), MAX_PRINTED_ROWS)).round().astype(int))
    yield from ("".join(f"{values[k]:22.6g}" for values in table.columns.values()) for k in shown)
    if len(table) > len(shown):
        yield f"({len(shown)} of {len(table)} rows)"


def loss_words(loss: ExportLoss) -> str:
    """Return a loss in one sentence.

    >>> words = loss_words(ExportLoss("loss per cycle", 0.001, 0.001, "J", 0.1, "a torsion loop to 100 N.m"))
    >>> print(words.replace(NO_BREAK_SPACE, " "))
    loss per cycle: 1 % (1 mJ), over a torsion loop to 100 N.m
    >>> words = loss_words(ExportLoss("ripple", 0.001, 0.003, "N.m", 0.1, "a turn of the input", "friction"))
    >>> print(words.replace(NO_BREAK_SPACE, " "))
    ripple: 1 % of the friction (1 mN·m, at most 3 mN·m), over a turn of the input
    """
    if loss.rms == 0.0 or loss.rms_share < MIN_STATED_SHARE:
        return f"{loss.quantity}: nothing lost, over {loss.over}"
    amount = typeset.quantity(loss.rms, loss.unit)
    if loss.largest > loss.rms:
        amount += f", at most {typeset.quantity(loss.largest, loss.unit)}"
    if isfinite(loss.rms_share):
        of = f" of the {loss.relative_to}" if loss.relative_to else ""
        amount = f"{100.0 * loss.rms_share:.2g} %{of} ({amount})"
    return f"{loss.quantity}: {amount}, over {loss.over}"


def export_files(found: Exported) -> dict[str, str | bytes]:
    """Return the files of an export, its table as <kind>.csv, and its numbers, losses and remarks as export.json."""
    content = {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "kind": found.kind,
        "gear": found.gear,
        "numbers": {name: {"value": value, "unit": unit} for name, (value, unit) in found.numbers.items()},
        "losses": [vars(loss) | {"share": loss.rms_share, "largest_share": loss.largest_share} for loss in found.losses],
        "left_out": list(found.left_out),
        "remarks": list(found.remarks),
    }
    files = {**found.files}
    if found.table is not None:
        files[f"{found.kind}.csv"] = _csv(found.table)
    return {**files, NUMBERS_FILE: results_json(content)}


def _csv(table: Recording) -> str:
    """Return a table as CSV with units in the header, which `Recording.from_csv` reads back bit for bit."""
    rows = [",".join(f"{name} [{unit}]" for name, unit in table.units.items())]
    rows += [",".join(map(repr, row)) for row in table]
    return "\n".join(rows) + "\n"
