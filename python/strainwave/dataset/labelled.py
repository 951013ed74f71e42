"""Labelled runs of a data set, with the alarms of a detector that compares each unit with its own first stage."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.dataset.classifier import LabelledRuns
from strainwave.dataset.folder import DatasetFolder
from strainwave.files.parquet_table import read_columns
from strainwave.messages import one_line

Array = NDArray[np.float64]

HEALTHY = "healthy"
MAX_RUNS = 2_000_000  # in memory at once
FALSE_ALARM = 0.01  # share of healthy training runs that the threshold of the detector lets alarm
MIN_HEALTHY_RUNS = 100  # from which a threshold of that share is taken
PHYSICAL = ("current_order_", "current_mean", "current_rms", "torque_mean", "torque_rms")  # beginnings of feature names


@dataclass(frozen=True)
class DetectorRuns:
    """Differences of physical features from those of the same unit and condition at its first stage.

    Args:
        difference: shape (runs, features); not-a-number where a run does not determine a feature
        healthy: True for runs without a fault, shape (runs,)
    """

    difference: Array
    healthy: NDArray[np.bool_]

    def alarms(self, train: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return the runs whose differences exceed those that healthy training runs have by chance.

        The statistic is the sum of squared differences over their standard deviation in healthy training runs; its threshold is
        exceeded by the share `FALSE_ALARM` of these.

        Raises:
            ValueError: there are too few healthy training runs
        """
        used = self.healthy & train
        if used.sum() < MIN_HEALTHY_RUNS:
            raise ValueError(
                f"{used.sum()} healthy training runs do not determine a threshold; the plan needs {MIN_HEALTHY_RUNS} or more"
            )
        sigma = np.sqrt(_mean_square(self.difference[used], axis=0))
        kept = sigma > 0.0
        statistic = _mean_square(self.difference[:, kept] / sigma[kept], axis=1)
        alarms: NDArray[np.bool_] = statistic > np.quantile(statistic[used], 1.0 - FALSE_ALARM)
        return alarms


def _mean_square(values: Array, axis: int) -> Array:
    """Return the mean of the squares of numbers, those that are not-a-number left out; 0 if there are none."""
    there = ~np.isnan(values)
    total = np.sum(np.where(there, values, 0.0) ** 2, axis=axis)
    mean: Array = total / np.maximum(there.sum(axis=axis), 1)
    return mean


def labelled_runs(folder: str | Path) -> tuple[LabelledRuns, LabelledRuns, DetectorRuns]:
    """Return the runs of a data set with their features, with differences from the first stage, and for the detector.

    First stages and failed runs are left out.

    A run counts as faulty if its unit has a fault and the severity at its stage is above 0.

    Raises:
        ValueError: the folder has no finished data set, one stage only, or too many runs
    """
    target = DatasetFolder(Path(folder))
    plan = target.plan
    if plan.life.stages < 2:
        raise ValueError(
            one_line(f"{folder} has one stage; the detector compares with the first: give life.stages = 2 or more")
        )
    if plan.members > MAX_RUNS:
        raise ValueError(f"{folder} has {plan.members} runs; at most {MAX_RUNS} are read at once")
    if target.done() < plan.shards:
        raise ValueError(
            one_line(f"{folder} has {target.done()} of {plan.shards} shards; call strainwave dataset make again first")
        )
    names, columns = _columns([target.shard(number) for number in range(plan.shards)])
    sound = np.isfinite(columns["current_mean"]) if "current_mean" in columns else np.isfinite(columns[names[0]])
    severity = np.max([columns[name] for name in columns if name.startswith("severity.")], axis=0)
    stage = columns["stage"].astype(int)
    group = columns["condition"] * plan.units.number + columns["unit"]
    first = {key: row for row, key in zip(np.flatnonzero(stage == 0).tolist(), group[stage == 0].tolist(), strict=True)}
    kept = np.flatnonzero(sound & (stage > 0))
    reference = np.array([first[key] for key in group[kept].tolist()])
    label = np.where(severity[kept] > 0.0, columns["fault"][kept], HEALTHY).astype(np.str_)
    features = {name: columns[name][kept].astype(np.float64) for name in names}
    features = {name: values for name, values in features.items() if not np.isnan(values).all()}
    changes = {name: values - columns[name][reference] for name, values in features.items()}
    groups = columns["unit"][kept].astype(np.int64), columns["condition"][kept].astype(np.int64)
    physical = np.column_stack([values for name, values in changes.items() if name.startswith(PHYSICAL)])
    return (
        LabelledRuns(features, label, *groups),
        LabelledRuns(changes, label, *groups),
        DetectorRuns(physical, label == HEALTHY),
    )


def _columns(paths: list[Path]) -> tuple[list[str], dict[str, NDArray[Any]]]:
    """Names of the features, and the columns of all shards that are used."""
    tables = [read_columns(path) for path in paths]
    roles = {field.name: (field.metadata or {}).get(b"role", b"").decode() for field in tables[0].schema}
    names = [name for name, role in roles.items() if role == "feature"]
    wanted = [*names, "unit", "condition", "stage", "fault", *(name for name in roles if name.startswith("severity."))]
    return names, {name: np.concatenate([table[name].to_numpy() for table in tables]) for name in wanted}
