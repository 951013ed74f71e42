"""Report of a slot: its numbers, their units and signs, and what they lose against the full model."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import metadata
from math import isfinite

import numpy as np

from strainwave.report import typeset
from strainwave.report.rig_files import results_json
from strainwave.tuning.slots import Slot

MAX_ROWS = 12  # of a table on a terminal
NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"


def slot_summary(found: Slot) -> str:
    """Return the numbers of a slot as lines of text, at most 12 rows of its table, and its loss."""
    return "\n".join(_lines(found)).replace(NO_BREAK_SPACE, " ")


def _lines(found: Slot) -> Iterator[str]:
    yield f"{found.gear}: {found.name}, at the {found.side}"
    yield from (f"  {name:20} {typeset.quantity(value, found.units[name], 6)}" for name, value in found.values.items())
    if found.table is not None:
        columns = found.table.columns
        yield "  " + "".join(f"{f'{name} [{found.table.units[name]}]':>22}" for name in columns)
        count = len(next(iter(columns.values())))
        shown = np.unique(np.linspace(0, count - 1, min(count, MAX_ROWS)).round().astype(int))
        yield from ("  " + "".join(f"{values[k]:22.6g}" for values in columns.values()) for k in shown)
        if count > MAX_ROWS:
            yield f"  ({len(shown)} of {count} rows)"
    yield f"  {loss_line(found)}"
    yield f"  sign: {found.sign}"
    yield from (f"  note: {remark}" for remark in found.remarks)


def loss_line(found: Slot) -> str:
    """Return the loss of a slot in one sentence."""
    loss = found.loss
    both = [(loss.rms, loss.rms_share), (loss.largest, loss.largest_share)]
    rms, largest = (
        f"{value:.3g} {typeset.unit(loss.unit)}" + (f" ({100.0 * share:.2g} % of the friction)" if isfinite(share) else "")
        for value, share in both
    )
    return f"loss against the full model: {rms} root mean square, {largest} at most, over {loss.over}"


def slot_files(found: Slot) -> dict[str, str]:
    """Return the numbers of a slot as slot.json, and its table as slot.csv, by file name."""
    table = found.table
    content = {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "slot": found.name,
        "gear": found.gear,
        "side": found.side,
        "sign": found.sign,
        "values": {name: {"value": value, "unit": found.units[name]} for name, value in found.values.items()},
        "table": None if table is None else {"columns": dict(table.columns), "units": dict(table.units)},
        "loss": {
            "rms": found.loss.rms,
            "largest": found.loss.largest,
            "unit": found.loss.unit,
            "rms_over_friction": found.loss.rms_share,
            "largest_over_friction": found.loss.largest_share,
            "over": found.loss.over,
        },
        "remarks": list(found.remarks),
    }
    files = {"slot.json": results_json(content)}
    if table is not None:
        rows = [",".join(f"{name} [{table.units[name]}]" for name in table.columns)]
        rows += [",".join(map(repr, row)) for row in zip(*(each.tolist() for each in table.columns.values()), strict=True)]
        files["slot.csv"] = "\n".join(rows) + "\n"
    return files
