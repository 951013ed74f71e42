"""One shard: its members are simulated, reduced to features, and written as a Parquet file."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave.dataset.features import add_noise
from strainwave.dataset.folder import DatasetFolder
from strainwave.dataset.members import USAGE_UNITS, MemberTable, Population
from strainwave.dataset.plan import SamplesTable
from strainwave.dataset.sampling import joint
from strainwave.files.writing import replacing
from strainwave.simulation.ensemble import EnsembleWarning, simulate_many

if TYPE_CHECKING:
    import pyarrow

Array = NDArray[np.float64]

BLOCK_BYTES = 16 << 20  # of series in memory at once
COMPRESSION_LEVEL = 3
DICTIONARY_COLUMNS = ("split", "split_unit", "split_condition", "fault", "profile")


class Shards:
    """The shards of a population, made one by one.

    Args:
        population: of a plan
    """

    def __init__(self, population: Population) -> None:
        self.population = population
        self.plan = population.plan

    def span(self, number: int) -> tuple[int, int]:
        """First member of a shard, and that after its last."""
        plan = self.plan
        condition, part = divmod(number, plan.shards_per_condition)
        first = condition * plan.members_per_condition + part * plan.shard_members
        return first, min(first + plan.shard_members, (condition + 1) * plan.members_per_condition)

    def write(self, folder: DatasetFolder, number: int) -> None:
        """Make a shard. Its features are written last, so that they are there only if the samples are."""
        table, samples = self.tables(*self.span(number))
        if samples is not None:
            write_table(samples, folder.shard(number, "samples"))
        write_table(table, folder.shard(number))

    def tables(self, first: int, last: int) -> tuple[pyarrow.Table, pyarrow.Table | None]:
        """Labels, parameters and features of members of one condition, and their samples if the plan keeps some."""
        members = self.population.members(first, last)
        columns, samples, failures = self.results(members)
        return self._labelled(members, columns, failures), self._sampled(members, samples)

    def results(self, members: MemberTable) -> tuple[dict[str, Array], dict[str, Array], dict[int, str]]:
        """Features, samples, and why a member has none, by its place in the table."""
        kept, failures = [], dict(members.refusals)
        for rows in self._blocks(len(members.index)):
            columns, samples, failed = self._block(members, rows)
            kept.append((columns, samples))
            failures |= {rows.start + place: reason for place, reason in failed.items() if rows.start + place not in failures}
        columns = {name: np.concatenate([each[0][name] for each in kept]) for name in kept[0][0]}
        samples = {name: np.concatenate([each[1][name] for each in kept]) for name in kept[0][1]}
        for values in (*columns.values(), *samples.values()):
            values[list(failures)] = np.nan
        return columns, samples, failures

    def _blocks(self, count: int) -> Iterator[slice]:
        table = self.plan.simulation
        bytes_each = 8 * len(self.population.recorded) * (table.duration / table.sample + 1.0)
        size = int(max(BLOCK_BYTES / bytes_each, 16.0)) // 16 * 16  # whole registers of any width
        for first in range(0, count, size):
            yield slice(first, min(first + size, count))

    def _block(self, members: MemberTable, rows: slice) -> tuple[dict[str, Array], dict[str, Array], dict[int, str]]:
        population, table = self.population, self.plan.simulation
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", EnsembleWarning)  # the column "failure" has the reasons
            warnings.simplefilter("ignore", RuntimeWarning)  # of bristles: the plan was checked
            runs = simulate_many(
                population.drive,
                members.condition.command,
                {path: values[rows] for path, values in members.parameters.items()},
                table.dt,
                record=population.recorded,
                sample=table.sample,
                load_torque=members.condition.load_torque,
                temperature=members.condition.temperature,
                threads=1,
            )
        series = dict(runs.columns)
        series["tracking_error"] = (
            members.condition.command.value(np.minimum(runs.time, table.duration)) - series["output_angle"]
        )
        angle, speed = series["input_angle"], series["input_speed"].copy()
        features = self.plan.features
        add_noise(series, features.noise, population.noise_seed, members.index[rows])
        begin = int(np.searchsorted(runs.time, features.start))
        used = {name: series[name][:, begin:] for name in population.features.signals}
        with np.errstate(invalid="ignore"):  # of members that failed
            columns = population.features.of(used, angle[:, begin:], speed[:, begin:])
        kept, samples = self.plan.samples, dict[str, Any]()
        if kept is not None:
            samples = {name: series[name][:, :: kept.every].astype(np.float32) for name in kept.columns}
        return columns, samples, dict(runs.failures)

    def _labelled(self, members: MemberTable, features: Mapping[str, Array], failures: Mapping[int, str]) -> pyarrow.Table:
        import pyarrow

        columns = self._labels(members)
        columns |= {path: (values, "parameter") for path, values in members.parameters.items()}
        columns |= {name: (values.astype(np.float32), "feature") for name, values in features.items()}
        units = self.column_units()
        arrays, fields = [], []
        for name, (values, role) in columns.items():
            array = pyarrow.array(values)
            arrays.append(array)
            fields.append(pyarrow.field(name, array.type, metadata={"unit": units[name], "role": role}))
        arrays.append(pyarrow.array([failures.get(row) for row in range(len(members.index))], pyarrow.string()))
        fields.append(pyarrow.field("failure", pyarrow.string(), metadata={"unit": "", "role": "label"}))
        return pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields, {"plan": self.plan.digest}))

    def _labels(self, members: MemberTable) -> dict[str, tuple[NDArray[Any], str]]:
        population, condition = self.population, members.condition
        count = len(members.index)
        by_unit = population.unit_split(members.unit)
        by_condition = np.repeat(population.condition_split(np.array([condition.number])), count)
        constants = {name: condition.numbers.get(name, np.nan) for name in population.condition_units}
        constants |= {"temperature": condition.temperature, "load_torque": condition.load_torque}
        labels: dict[str, tuple[NDArray[Any], str]] = {
            "member": (members.index, "index"),
            "unit": (members.unit, "index"),
            "condition": (np.full(count, condition.number, dtype=np.int32), "index"),
            "stage": (members.stage.astype(np.int32), "index"),
            "usage": (members.usage, "label"),
            "split": (joint(by_unit, by_condition), "split"),
            "split_unit": (by_unit, "split"),
            "split_condition": (by_condition, "split"),
            "fault": (members.fault, "label"),
        }
        labels |= {f"severity.{kind}": (values, "label") for kind, values in members.severity.items()}
        labels["profile"] = np.full(count, condition.profile), "condition"
        return labels | {f"condition.{name}": (np.full(count, value), "condition") for name, value in constants.items()}

    def _sampled(self, members: MemberTable, samples: Mapping[str, Array]) -> pyarrow.Table | None:
        import pyarrow

        if self.plan.samples is None:
            return None
        columns = {"member": pyarrow.array(members.index)}
        for name, values in samples.items():
            flat = pyarrow.array(np.ascontiguousarray(values).reshape(-1))
            columns[name] = pyarrow.FixedSizeListArray.from_arrays(flat, values.shape[1])
        return pyarrow.table(columns).replace_schema_metadata({"plan": self.plan.digest})

    def column_units(self) -> dict[str, str]:
        """Unit of each column of a shard, by its name; empty for names and indices."""
        population = self.population
        names = dict.fromkeys(("member", "unit", "condition", "stage", *DICTIONARY_COLUMNS, "failure"), "")
        severities = {f"severity.{kind}": "1" for kind in population.fault_kinds}
        conditions = population.condition_units | {"temperature": "K", "load_torque": "N.m"}
        return (
            names
            | {"usage": USAGE_UNITS[population.usage_kind]}
            | severities
            | {f"condition.{name}": unit for name, unit in conditions.items()}
            | population.parameter_units
            | population.features.units
        )

    def member(self, index: int) -> tuple[pyarrow.Table, pyarrow.Table | None]:
        """Return labels, parameters and features of one member, made alone, and all samples of its run."""
        kept = self.plan.samples.columns if self.plan.samples else ()
        columns = tuple(dict.fromkeys([*self.population.recorded, "tracking_error", *kept]))
        plan = self.plan.model_copy(update={"samples": SamplesTable(columns=columns, every=1)})
        return Shards(replace(self.population, plan=plan)).tables(index, index + 1)


def write_table(table: pyarrow.Table, path: Path) -> int:
    """Write a Parquet file, whole or not at all, whose bytes are a function of the table; returns its size."""
    from pyarrow.parquet import write_table as write

    names = [name for name in table.column_names if name in DICTIONARY_COLUMNS]
    with replacing(path) as file:
        options: dict[str, Any] = {"compression": "zstd", "compression_level": COMPRESSION_LEVEL, "write_page_checksum": True}
        write(table, file, use_dictionary=names, **options)
    return os.stat(path).st_size
