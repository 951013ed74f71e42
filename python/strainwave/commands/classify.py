"""The command `strainwave classify`: how well faults of a data set are recognised on units that were held out."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave.commands.options import whole

if TYPE_CHECKING:
    from strainwave.dataset.classifier import Benchmark, Score


def classify(
    folder: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder that strainwave dataset made.")],
    seed: Annotated[int, whole("Seed of the choice of units and conditions, and of the forest.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for results.json.")] = Path("out/classify"),
) -> None:
    """Print the scores of a classifier of faults, of a physics-based detector, of chance and of a leaky split."""
    from strainwave.dataset.classifier import benchmark
    from strainwave.dataset.labelled import labelled_runs
    from strainwave.files.writing import write_folder

    runs, changes, detector = labelled_runs(folder)
    try:
        found = {
            "features": benchmark(runs, detector.alarms, seed),
            "differences from the first stage": benchmark(changes, detector.alarms, seed),
        }
    except ImportError as error:
        raise ValueError(str(error)) from None
    result: dict[str, Any] = {name: {**asdict(each), "confusion": each.confusion.tolist()} for name, each in found.items()}
    write_folder(out, {"results.json": json.dumps(result, indent=2) + "\n"})
    for name, each in found.items():
        print(f"trained on {name}\n{table(each)}\n")
    print(f"wrote {out / 'results.json'}")


def table(found: Benchmark) -> str:
    """Return the figures as text.

    Balanced accuracy; the interval is that of drawing units anew.
    """
    rows: list[tuple[str, Score | None]] = [
        ("which fault: units held out", found.by_unit),
        ("which fault: conditions held out", found.by_condition),
        ("which fault: units and conditions held out", found.by_both),
        ("which fault: labels shuffled between units (chance)", found.chance),
        ("which fault: runs held out (leaky, not a result)", found.leaky),
        ("faulty or not: classifier, units held out", found.classifier_detects),
        ("faulty or not: physics-based detector, same runs", found.detector),
    ]
    head = f"{'balanced accuracy':52}{'':6}  95 % interval      runs  units"
    lines = [f"{name:52}{each.accuracy:6.3f}  {each.low:.3f} to {each.high:.3f} {each.runs:9d} {each.units:6d}"
             for name, each in rows if each is not None]  # fmt: skip
    guess = f"one over the {len(found.labels)} labels is {1.0 / len(found.labels):.3f}"
    if found.false_alarms is not None:
        guess += f"; false alarms of the detector on held-out healthy runs: {100.0 * found.false_alarms:.2g} %"
    return "\n".join([head, *lines, guess])
