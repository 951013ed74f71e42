"""Making a data set: what it will take, from a pilot, and all its shards, by workers, Dask or Slurm."""

from __future__ import annotations

import shutil
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from strainwave.dataset import runners
from strainwave.dataset.card import card, empty_splits, manifest
from strainwave.dataset.folder import DatasetFolder
from strainwave.dataset.members import Population
from strainwave.dataset.plan import DatasetPlan
from strainwave.dataset.shards import Shards, write_table
from strainwave.files.writing import claiming, making, replacing
from strainwave.messages import one_line
from strainwave.native import kernels
from strainwave.presentation import Presented
from strainwave.progress import Progress, in_turn
from strainwave.simulation.threads import available_threads

if TYPE_CHECKING:
    import pyarrow

PILOT_MEMBERS = 512  # at most, of the first condition
MIN_BYTES_PER_NUMBER = 2.0  # of a number that varies from member to member, compressed; noise takes its full width
DISK_MARGIN = 1.1  # free bytes over those needed
Runner = Literal["local", "dask", "slurm"]


@dataclass(frozen=True)
class CostEstimate(Presented):
    """Time and size of a data set, estimated from a pilot of some members.

    Args:
        members, shards: of the plan
        seconds_per_member: of one core
        bytes: of all shards
        workers: processes at once
        notes: what a user should know before it runs
        schema: of the shards
    """

    members: int
    shards: int
    seconds_per_member: float
    bytes: float
    workers: int
    notes: tuple[str, ...]
    schema: pyarrow.Schema

    @property
    def seconds(self) -> float:
        """Return the time of the whole data set on all workers [s]."""
        return self.members * self.seconds_per_member / self.workers


def estimate(shards: Shards, folder: Path, workers: int, shards_left: int | None = None) -> CostEstimate:
    """Return what a plan takes, measured on a pilot.

    Raises:
        ValueError: the plan is refused
        OSError: it does not fit on the disk
    """
    population, plan = shards.population, shards.plan
    _check_disk(folder, MIN_BYTES_PER_NUMBER * plan.members * len(population.features.signals), "at least")
    population.check()
    prepare_kernel(population)
    count = min(PILOT_MEMBERS, plan.members_per_condition, plan.shard_members)
    shards.tables(0, count)  # once for what only a first run does
    begin = time.process_time()
    table, samples = shards.tables(0, count)
    seconds = (time.process_time() - begin) / count
    whole = sum(_bytes(each, plan, count) for each in (table, samples) if each is not None)
    left = plan.shards if shards_left is None else shards_left
    _check_disk(folder, whole * left / plan.shards, "about")
    notes = empty_splits(population)
    if failed := [reason for reason in table["failure"].to_pylist() if reason]:
        notes.append(one_line(f"{len(failed)} of {count} members of the pilot fail, the first because: {failed[0]}"))
    return CostEstimate(plan.members, plan.shards, seconds, whole, workers, tuple(notes), table.schema)


def prepare_kernel(population: Population) -> None:
    """Compile the kernel of the drive, once and before the workers start, if the runs are worth it."""
    table = population.plan.simulation
    if kernels.pays(population.drive, "simulate_many", population.plan.members * table.duration / table.dt):
        kernels.load(population.drive, "simulate_many", compile_it=True)


def make(
    plan: str | Path,
    folder: str | Path,
    *,
    runner: Runner = "local",
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = None,
) -> Path:
    """Make the data set of a plan; one that was begun goes on, and its complete shards stay.

    Safe to call from any script or notebook: workers are processes of their own, which run nothing of the caller.

    Args:
        plan: file of the plan
        folder: of the data set
        runner: processes on this machine, a Dask cluster, or a script for Slurm to be handed in
        workers: processes, or tasks of the Slurm array; as many as this process may use cores, if not given
        scheduler: address of the Dask scheduler
        progress: as of `sw.simulate`

    Returns:
        the folder; of Slurm the script

    Raises:
        ValueError, FloatingPointError: the plan is refused
        OSError: the folder has other files, does not fit, or is in use
        ImportError: Dask is not installed
        RuntimeError: workers die again and again
    """
    text = Path(plan).read_bytes() if Path(plan).is_file() else b""
    shards = Shards(Population(DatasetPlan.read(plan)))
    target = DatasetFolder(Path(folder))
    count = workers or available_threads()
    cost = estimate(shards, target.path, count, shards.plan.shards - target.done())
    with making(target.path), claiming(target.path):
        target.begin(shards.plan, text, manifest(shards, cost.schema), card(shards, cost.schema))
        if target.is_finished and target.done() == shards.plan.shards:
            return target.path
        if runner == "slurm":
            script = target.path / runners.SLURM_SCRIPT
            with replacing(script) as file:
                file.write(runners.slurm_script(target.path, shards.plan, count).encode())
            return script
        target.remove_drafts()
        try:
            with in_turn(progress) as show:
                if runner == "dask":
                    runners.run_by_dask(target, scheduler, show)
                else:
                    runners.run_locally(target, min(count, shards.plan.shards), show)
        finally:
            target.remove_drafts()
        runners.finish(target)
    return target.path


def member(plan: str | Path, index: int) -> tuple[pyarrow.Table, pyarrow.Table]:
    """Return one member, made alone: its row in the data set, and its series.

    Args:
        plan: file of the plan
        index: from 0

    Raises:
        ValueError: the plan is refused, or has no such member
    """
    shards = Shards(Population(DatasetPlan.read(plan)))
    if not 0 <= index < shards.plan.members:
        raise ValueError(f"member = {index} must lie in [0, {shards.plan.members - 1}]")
    row, samples = shards.member(index)
    assert samples is not None
    return row, samples


def _bytes(table: pyarrow.Table, plan: DatasetPlan, count: int) -> float:
    """Bytes of all shards: what each has, and what each member adds, from files of two lengths."""
    half = max(count // 2, 1)
    with tempfile.TemporaryDirectory() as place:
        large = write_table(table, Path(place, "large.parquet"))
        small = write_table(table.slice(0, half), Path(place, "small.parquet")) if half < count else 0
    slope = max((large - small) / (count - half), 1.0) if half < count else float(large)
    return plan.shards * max(large - slope * count, 0.0) + plan.members * slope


def _check_disk(folder: Path, needed: float, how: str) -> None:
    there = next(each for each in (folder, *folder.resolve().parents) if each.exists())
    free = shutil.disk_usage(there).free
    if DISK_MARGIN * needed > free:
        raise OSError(
            one_line(
                f"the data set takes {how} {1e-9 * needed:.3g} GB, and {there} has {1e-9 * free:.3g} GB free; "
                "take fewer members, keep fewer samples, or give another folder"
            )
        )
