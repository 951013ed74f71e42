"""Making a data set: what it will take, from a pilot, and all its shards, by workers, Dask or Slurm."""

from __future__ import annotations

import json
import platform
import shutil
import tempfile
import time
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from strainwave.dataset import runners
from strainwave.dataset.folder import DatasetFolder
from strainwave.dataset.members import Population
from strainwave.dataset.plan import HEALTHY_LABEL, DatasetPlan
from strainwave.dataset.profiles import PROFILES
from strainwave.dataset.sampling import MIXED_SPLIT
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

RECORDED_PACKAGES = ("strainwave", "numpy", "scipy", "pyarrow")
MAX_LISTED_CONDITIONS = 20
COLUMN_ROLES = {
    "index": "which member it is",
    "label": "what is to be predicted",
    "split": "which use it is for",
    "condition": "what the drive was commanded",
    "parameter": "number of the drive; not measurable in service",
    "feature": "of the run; not-a-number if the run does not determine it",
}


def manifest(shards: Shards, schema: Any) -> str:
    """Return the manifest, JSON: schema of the Parquet files with units and sources, versions, splits, digest of the plan."""
    population, plan = shards.population, shards.plan
    units = shards.column_units()
    sources = population.gear_set.sources
    columns = []
    for column in schema:
        role = column.metadata[b"role"].decode()
        entry = {"name": column.name, "type": str(column.type), "unit": units[column.name], "role": role}
        if role == "parameter" and column.name in sources:
            entry["source"] = sources[column.name].source
        columns.append(entry)
    content = {
        "format": "strainwave-dataset-1",
        "name": plan.name,
        "plan_digest": plan.digest,
        "seed": plan.seed,
        "versions": {name: version(name) for name in RECORDED_PACKAGES} | {"python": platform.python_version()},
        "machine": platform.machine(),
        "drive": {"gear_set": population.gear_set.name, "parts": population.drive.to_dict()["rows"]},
        "members": plan.members,
        "conditions": plan.condition_count,
        "units": plan.units.number,
        "stages": plan.life.stages,
        "shards": plan.shards,
        "members_per_shard": plan.shard_members,
        "splits": plan.splits.shares,
        "columns": columns,
    }
    return json.dumps(content, indent=1, ensure_ascii=False) + "\n"


def card(shards: Shards, schema: Any) -> str:
    """Return the data set card, Markdown: what is in it, how it was made, columns with units, splits, and limits."""
    population, plan = shards.population, shards.plan
    table = plan.simulation
    noise = ", ".join(f"{name} {value:g}" for name, value in sorted(plan.features.noise.items())) or "none"
    lines = [
        f"# {plan.name}",
        "",
        *([plan.note, ""] if plan.note else []),
        "## What it is",
        "",
        f"Simulated runs of the drive `{population.gear_set.name}`: "
        f"{plan.members} members = {plan.condition_count} conditions x "
        f"{plan.units.number} units x {plan.life.stages} stages of life. No run was measured.",
        "",
        f"- A run takes {table.duration:g} s in steps of {table.dt:g} s, sampled each {table.sample:g} s. It starts at rest.",
        f"- Features begin at {plan.features.start:g} s. Standard deviation of the white noise of each sample: {noise}.",
        f"- Noise of the sensors within the control loop: {'as in the gear set' if table.noise_in_loop else 'none'}.",
        f"- Licence: {plan.licence}.",
        "",
        "## How to make it again",
        "",
        "`strainwave dataset make plan.toml --out folder` makes all files again, and "
        "`strainwave dataset member plan.toml 17` one member alone. "
        "Files have equal hashes with the versions of `manifest.json` on a processor of the same kind.",
        "",
        "## Faults",
        "",
        *_faults(population),
        "",
        "## Conditions",
        "",
        *_conditions(population),
        "",
        "## Splits",
        "",
        *_splits(population),
        "",
        "## Columns",
        "",
        "| column | unit | role |",
        "|---|---|---|",
        *(f"| `{each.name}` | {shards.column_units()[each.name]} | {each.metadata[b'role'].decode()} |" for each in schema),
        "",
        *(f"- {role}: {meaning}" for role, meaning in COLUMN_ROLES.items()),
        "",
        "## Limits",
        "",
        "- The labels are those of the model. A model that lacks an effect lacks it in all members.",
        "- Units differ only in the columns of role parameter.",
        "- Features are computed from true quantities with white noise. Lag, bias and play of a sensor show only in what the "
        "controller makes of them.",
        "- The severity of a fault is constant within a run.",
        "- The column `failure` has the reason if a member could not be run. Its features are not-a-number.",
        *(
            [
                f"- Order {population.features.tooth_order:g} needs {population.features.tooth_turns:.3g} turns of the input "
                "in one direction; shorter runs have not-a-number."
            ]
            if population.features.tooth_order
            else []
        ),
        "",
    ]
    return "\n".join(lines)


def empty_splits(population: Population) -> list[str]:
    """Return what the plan has too few units or conditions for, one line each."""
    plan = population.plan
    counts = {"unit": plan.units.number, "condition": plan.condition_count}
    lines = []
    for what, count in counts.items():
        if count > 1000:
            continue
        of = population.unit_split if what == "unit" else population.condition_split
        names = set(of(np.arange(count)).tolist())
        missing = [name for name, share in plan.splits.shares.items() if share > 0.0 and name not in names]
        if missing:
            lines.append(f"the split by {what} leaves {', '.join(missing)} empty: the plan has only {count} of them")
    return lines


def _faults(population: Population) -> list[str]:
    plan = population.plan
    if not plan.faults:
        return ["None: all units are healthy."]
    healthy = 1.0 - sum(table.share for table in plan.faults)
    rows = [f"| {HEALTHY_LABEL} | {healthy:.3g} | | |"]
    for table in plan.faults:
        onset = "constant" if table.onset is None else table.onset.law
        rows.append(f"| {table.label} | {table.share:.3g} | {_text(table.severity)} | {onset} |")
    return ["| fault | share of units | severity | onset |", "|---|---|---|---|", *rows]


def _conditions(population: Population) -> list[str]:
    rows = []
    for table in population.plan.conditions[:MAX_LISTED_CONDITIONS]:
        numbers = ", ".join(
            f"{name} {_text(number)} {PROFILES[table.profile].units[name]}" for name, number in sorted(table.numbers.items())
        )
        rows.append(
            f"| {table.profile} | {table.number} | {numbers} | {_text(table.temperature)} | {_text(table.load_torque)} |"
        )
    more = len(population.plan.conditions) - MAX_LISTED_CONDITIONS
    head = ["| profile | conditions | numbers | temperature, K | load torque, N.m |", "|---|---|---|---|---|"]
    return [*head, *rows, *([f"and {more} more tables"] if more > 0 else [])]


def _splits(population: Population) -> list[str]:
    shares = ", ".join(f"{name} {share:g}" for name, share in population.plan.splits.shares.items())
    return [
        f"Shares: {shares}, of the units and of the conditions separately.",
        "",
        "- `split_unit`: all members of a unit have one value.",
        "- `split_condition`: all members of a condition have one value.",
        f"- `split`: the value on which both agree, else `{MIXED_SPLIT}`. Its test members share no unit and no condition with "
        "its train members.",
        *(f"- Note: {line}." for line in empty_splits(population)),
    ]


def _text(number: Any) -> str:
    return f"{number.low:g} to {number.high:g}" if hasattr(number, "low") else f"{number:g}"


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


def estimate(
    shards: Shards, folder: Path, workers: int, shards_left: int | None = None, progress: Progress = None
) -> CostEstimate:
    """Return what a plan takes, measured on a pilot; refuse it if it does not fit on the disk."""
    population, plan = shards.population, shards.plan
    _check_disk(folder, MIN_BYTES_PER_NUMBER * plan.members * len(population.features.signals), "at least")
    population.check()
    prepare_kernel(population)
    count = min(PILOT_MEMBERS, plan.members_per_condition, plan.shard_members)
    with in_turn(progress, 2) as turn:
        turn("preparing a pilot")
        shards.tables(0, count)  # once for what only a first run does
        turn("running the pilot")
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
    cost = estimate(shards, target.path, count, shards.plan.shards - target.done(), progress)
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
    """Return one member, made alone: its row in the data set, and its series."""
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
