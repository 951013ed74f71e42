"""The verbs under `dataset`: labelled runs of many drives, by plan, and a classifier of them."""

from __future__ import annotations

import json
import sys
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave.commands.help import Verbs
from strainwave.commands.options import folder, whole, whole_option

if TYPE_CHECKING:
    from strainwave.dataset.classifier import Benchmark, Score
    from strainwave.dataset.make import CostEstimate
    from strainwave.dataset.plan import DatasetPlan

RUNNERS = ("local", "dask", "slurm")
QUIET_SECONDS = 60.0  # between lines of progress where nobody watches

dataset = typer.Typer(cls=Verbs, help="Make labelled runs for learning, and score a classifier.")

Plan = Annotated[Path, typer.Argument(help="Plan, TOML. `strainwave docs datasets` shows the format.")]
Workers = Annotated[int | None, whole("Processes, or tasks of the Slurm array; one for each core, if not given.")]


@dataset.command("make")
def make_command(
    plan: Plan,
    out: Annotated[Path, folder("Folder of the data set.")],
    runner: Annotated[str, typer.Option(help=f"{', '.join(RUNNERS[:-1])} or {RUNNERS[-1]}.")] = "local",
    workers: Workers = None,
    scheduler: Annotated[str | None, typer.Option(help="Address of the Dask scheduler, as tcp://host:8786.")] = None,
) -> None:
    """Make a data set of labelled runs in Parquet shards.

    A row has features, parameters and faults. Called again, it goes on where it was broken off.

    Examples:
        strainwave dataset make plan.toml --out faults
        strainwave dataset make plan.toml --out faults --workers 2
    """
    from strainwave.arguments import one_of
    from strainwave.dataset.make import make
    from strainwave.files.writing import written

    one_of("--runner", runner, RUNNERS)
    _check_workers(workers)
    try:
        made = make(plan, out, runner=runner, workers=workers, scheduler=scheduler, progress=_Progress())  # type: ignore[arg-type]
    except RuntimeError as error:
        raise OSError(str(error)) from None
    written.append(made)
    print(f"sbatch {made}" if runner == "slurm" else f"wrote {made}")


@dataset.command("estimate")
def estimate_command(plan: Plan, workers: Workers = None) -> None:
    """Measure on a pilot what a plan takes: time, disk and members.

    Examples:
        strainwave dataset estimate plan.toml
        strainwave dataset estimate plan.toml --workers 8
    """
    from strainwave.dataset.make import estimate
    from strainwave.dataset.members import Population
    from strainwave.dataset.plan import DatasetPlan
    from strainwave.dataset.shards import Shards
    from strainwave.simulation.threads import available_threads

    _check_workers(workers)
    shards = Shards(Population(DatasetPlan.read(plan)))
    print("\n".join(_lines(shards.plan, estimate(shards, Path(), workers or available_threads()))))


@dataset.command()
def member(
    plan: Plan,
    number: Annotated[int, typer.Argument(parser=whole_option, help="Number of the member, from 0.")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Its series, a .parquet file to write.")] = None,
) -> None:
    """Make one member of a plan alone, with its series.

    Examples:
        strainwave dataset member plan.toml 17
        strainwave dataset member plan.toml 17 --out one.parquet
    """
    from strainwave.dataset.make import member as make_member
    from strainwave.dataset.shards import write_table
    from strainwave.files.writing import written

    if out is not None and out.suffix != ".parquet":
        raise ValueError(f"--out {out} must end in .parquet")
    row, samples = make_member(plan, number)
    for name, values in row.to_pydict().items():
        print(f"{name}  {values[0]}")
    if out is not None:
        write_table(samples, out)
        written.append(out)
        print(f"wrote {out}")


@dataset.command()
def work(
    folder: Annotated[Path, typer.Argument(help="Folder of a data set that is being made.")],
    part: Annotated[str, typer.Option(help="Which worker of how many this is, as 0/4.")] = "0/1",
    parent: Annotated[int | None, typer.Option(hidden=True)] = None,
) -> None:
    """Make shards of a data set, as one worker of several.

    Examples:
        strainwave dataset work faults
        strainwave dataset work faults --part 0/4
    """
    from strainwave.dataset.runners import work as make_shards

    number, count = _part(part)
    print(f"{make_shards(folder, number, count, parent)} shards made")


@dataset.command()
def classify(
    folder: Annotated[Path, typer.Argument(metavar="DATASET", help="Folder that `strainwave dataset make` made.")],
    seed: Annotated[int, whole("Seed of the choice of units and conditions, and of the forest.")] = 0,
    out: Annotated[Path, folder("Folder for results.json.")] = Path("out/classify"),
) -> None:
    """Score a classifier of faults on units that were held out.

    Beside it stand a physics-based detector, chance, and a leaky split.

    Examples:
        strainwave dataset classify faults
        strainwave dataset classify faults --seed 1
    """
    from strainwave.dataset.classifier import benchmark, labelled_runs
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


def _check_workers(workers: int | None) -> None:
    if workers is not None and workers < 1:
        raise ValueError(f"--workers {workers} must be at least 1")


def _part(text: str) -> tuple[int, int]:
    number, slash, count = text.partition("/")
    if not (
        slash and number.isascii() and number.isdigit() and count.isascii() and count.isdigit() and int(number) < int(count)
    ):
        raise ValueError(f"--part {text}: write it as --part 0/4, which is the first of four")
    return int(number), int(count)


class _Progress:
    """Lines of progress: all on a terminal, now and then in a file."""

    def __init__(self) -> None:
        self.last = time.monotonic()

    def __call__(self, line: str, share: float) -> None:
        if sys.stderr.isatty() or time.monotonic() - self.last >= QUIET_SECONDS:
            self.last = time.monotonic()
            print(f"strainwave: {line}", file=sys.stderr, flush=True)


def _lines(plan: DatasetPlan, cost: CostEstimate) -> list[str]:
    from strainwave.dataset.runners import duration_text

    return [
        plan.name,
        f"conditions  {plan.condition_count}",
        f"units       {plan.units.number}",
        f"stages      {plan.life.stages}",
        f"members     {cost.members}",
        f"shards      {cost.shards} of at most {plan.shard_members} members",
        f"columns     {len(cost.schema)}",
        f"disk        {1e-6 * cost.bytes:.3g} MB, {cost.bytes / cost.members:.0f} bytes a member",
        f"time        {duration_text(cost.seconds)} on {cost.workers} cores, {1e6 * cost.seconds_per_member:.0f} us a member",
        *(f"note: {note}" for note in cost.notes),
    ]


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
