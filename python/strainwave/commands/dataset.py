"""The command `strainwave dataset`: labelled runs of many drives, by plan."""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strainwave.commands.options import whole

if TYPE_CHECKING:
    from strainwave.dataset.make import CostEstimate
    from strainwave.dataset.plan import DatasetPlan

RUNNERS = ("local", "dask", "slurm")
QUIET_SECONDS = 60.0  # between lines of progress where nobody watches


def dataset(
    plan: Annotated[Path | None, typer.Argument(help="Plan, TOML. docs/how-to/datasets.md shows the format.")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Folder of the data set; of --member a .parquet file.")
    ] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Show what the plan takes, from a pilot, and end.")] = False,
    member: Annotated[int | None, whole("Make this member alone, with its series.")] = None,
    runner: Annotated[str, typer.Option(help="local, dask or slurm.")] = "local",
    workers: Annotated[int | None, whole("Processes, or tasks of the Slurm array; one for each core, if not given.")] = None,
    scheduler: Annotated[str | None, typer.Option(help="Address of the Dask scheduler, as tcp://host:8786.")] = None,
    work: Annotated[Path | None, typer.Option(help="Only make shards of this folder, as one worker of several.")] = None,
    part: Annotated[str, typer.Option(help="Which worker of how many this is, as 0/4; of --work.")] = "0/1",
    parent: Annotated[int | None, typer.Option(hidden=True)] = None,
) -> None:
    """Make a data set of labelled runs: features, parameters and faults in Parquet shards."""
    if work is not None:
        from strainwave.dataset.runners import work as make_shards

        number, count = _part(part)
        print(f"{make_shards(work, number, count, parent)} shards made")
        return
    if plan is None:
        raise ValueError("give a plan, as in strainwave dataset plan.toml --out folder, or --work FOLDER")
    if runner not in RUNNERS:
        raise ValueError(f"--runner {runner} must be one of {', '.join(RUNNERS)}")
    if workers is not None and workers < 1:
        raise ValueError(f"--workers {workers} must be at least 1")
    if member is not None:
        _make_member(plan, member, out)
    elif dry_run:
        _show_estimate(plan, out or Path(), workers)
    elif out is None:
        raise ValueError("--out is missing: give the folder of the data set, or --dry-run")
    else:
        _make(plan, out, runner, workers, scheduler)


def _part(text: str) -> tuple[int, int]:
    number, slash, count = text.partition("/")
    if not (
        slash and number.isascii() and number.isdigit() and count.isascii() and count.isdigit() and int(number) < int(count)
    ):
        raise ValueError(f"--part {text}: write it as --part 0/4, which is the first of four")
    return int(number), int(count)


def _make(plan: Path, out: Path, runner: str, workers: int | None, scheduler: str | None) -> None:
    from strainwave.dataset.make import make
    from strainwave.files.writing import written

    try:
        made = make(plan, out, runner=runner, workers=workers, scheduler=scheduler, progress=_Progress())  # type: ignore[arg-type]
    except RuntimeError as error:
        raise OSError(str(error)) from None
    written.append(made)
    print(f"sbatch {made}" if runner == "slurm" else f"wrote {made}")


class _Progress:
    """Lines of progress: all on a terminal, now and then in a file."""

    def __init__(self) -> None:
        self.last = time.monotonic()

    def __call__(self, line: str) -> None:
        if sys.stderr.isatty() or time.monotonic() - self.last >= QUIET_SECONDS:
            self.last = time.monotonic()
            print(f"strainwave: {line}", file=sys.stderr, flush=True)


def _make_member(plan: Path, member: int, out: Path | None) -> None:
    from strainwave.dataset.make import member as make_member
    from strainwave.dataset.shards import write_table
    from strainwave.files.writing import written

    if out is not None and out.suffix != ".parquet":
        raise ValueError(f"--out {out} must end in .parquet")
    row, samples = make_member(plan, member)
    for name, values in row.to_pydict().items():
        print(f"{name}  {values[0]}")
    if out is not None:
        write_table(samples, out)
        written.append(out)
        print(f"wrote {out}")


def _show_estimate(plan: Path, out: Path, workers: int | None) -> None:
    from strainwave.dataset.make import estimate
    from strainwave.dataset.members import Population
    from strainwave.dataset.plan import DatasetPlan
    from strainwave.dataset.shards import Shards
    from strainwave.simulation.threads import available_threads

    shards = Shards(Population(DatasetPlan.read(plan)))
    print("\n".join(_lines(shards.plan, estimate(shards, out, workers or available_threads()))))


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
