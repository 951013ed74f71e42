"""Description of a data set: the manifest for programs, the card for people."""

from __future__ import annotations

import json
import platform
from importlib.metadata import version
from typing import Any

from strainwave.dataset.members import HEALTHY, Population
from strainwave.dataset.profiles import PROFILES
from strainwave.dataset.shards import Shards
from strainwave.dataset.splits import MIXED

PACKAGES = ("strainwave", "numpy", "scipy", "pyarrow")
MAX_LISTED_CONDITIONS = 20
ROLES = {
    "index": "which member it is",
    "label": "what is to be predicted",
    "split": "which use it is for",
    "condition": "what the drive was commanded",
    "parameter": "number of the drive; not measurable in service",
    "feature": "of the run; not-a-number if the run does not determine it",
}


def manifest(shards: Shards, schema: Any) -> str:
    """Return the manifest, JSON: schema with units and sources, versions, splits, and the digest of the plan.

    Args:
        shards: of the data set
        schema: of the Parquet files
    """
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
        "versions": {name: version(name) for name in PACKAGES} | {"python": platform.python_version()},
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
        *(f"- {role}: {meaning}" for role, meaning in ROLES.items()),
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
    import numpy as np

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
    rows = [f"| {HEALTHY} | {healthy:.3g} | | |"]
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
        f"- `split`: the value on which both agree, else `{MIXED}`. Its test members share no unit and no condition with its "
        "train members.",
        *(f"- Note: {line}." for line in empty_splits(population)),
    ]


def _text(number: Any) -> str:
    return f"{number.low:g} to {number.high:g}" if hasattr(number, "low") else f"{number:g}"
