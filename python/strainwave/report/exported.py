"""Summary and numbers of an export: what was written, and what it loses against the gear."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import metadata
from math import isfinite

from strainwave.export.exported import Exported
from strainwave.report import typeset
from strainwave.report.rig_files import results_json
from strainwave.tuning.loss import Loss

NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
NUMBERS_FILE = "export.json"
MIN_STATED_SHARE = 1e-9  # a smaller loss is rounding


def export_summary(found: Exported) -> str:
    """Return the numbers of an export as lines of text, with its losses and remarks."""
    return "\n".join(_lines(found)).replace(NO_BREAK_SPACE, " ")


def _lines(found: Exported) -> Iterator[str]:
    yield f"{found.gear}: {found.kind}"
    yield from (f"  {name:20} {typeset.quantity(value, unit, 6)}" for name, (value, unit) in found.numbers.items())
    yield "loss against the gear:"
    yield from (f"  {loss_words(each)}" for each in found.losses)
    yield from (f"  left out: {each}" for each in found.left_out)
    yield from (f"note: {each}" for each in found.remarks)


def loss_words(loss: Loss) -> str:
    """Return a loss in one sentence.

    >>> words = loss_words(Loss("loss per cycle", 0.001, 0.001, "J", 0.1, "a torsion loop to 100 N.m"))
    >>> print(words.replace(NO_BREAK_SPACE, " "))
    loss per cycle: 1 % (1 mJ), over a torsion loop to 100 N.m
    """
    if isfinite(loss.rms_share) and loss.rms_share < MIN_STATED_SHARE:
        return f"{loss.quantity}: none, over {loss.over}"
    largest = "" if loss.largest <= loss.rms else f", at most {typeset.quantity(loss.largest, loss.unit)}"
    return (
        f"{loss.quantity}: {100.0 * loss.rms_share:.2g} % ({typeset.quantity(loss.rms, loss.unit)}{largest}), over {loss.over}"
    )


def export_files(found: Exported) -> dict[str, str | bytes]:
    """Return the files of an export, and its numbers, losses and remarks as export.json."""
    content = {
        "made_by": f"strainwave {metadata.version('strainwave')}",
        "kind": found.kind,
        "gear": found.gear,
        "numbers": {name: {"value": value, "unit": unit} for name, (value, unit) in found.numbers.items()},
        "losses": [vars(loss) | {"share": loss.rms_share} for loss in found.losses],
        "left_out": list(found.left_out),
        "remarks": list(found.remarks),
    }
    return {**found.files, NUMBERS_FILE: results_json(content)}
