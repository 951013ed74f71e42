"""A classifier of features, tested on units and conditions outside its training, and compared with a detector and chance.

A split by run puts runs of one unit into both halves. The classifier then recognises the unit and not its fault: `leaky` is
the accuracy that such a split pretends.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.dataset.folder import DatasetFolder
from strainwave.dataset.plan import HEALTHY_LABEL
from strainwave.files.parquet_table import read_columns
from strainwave.messages import listed, one_line
from strainwave.presentation import Presented

Array = NDArray[np.float64]
Labels = NDArray[np.str_]

FOREST_TREES = 200  # of the forest
MIN_RUNS_PER_LEAF = 2  # runs in a leaf
INTERVAL_CONFIDENCE = 0.95
INTERVAL_ENDS = (0.5 - 0.5 * INTERVAL_CONFIDENCE, 0.5 + 0.5 * INTERVAL_CONFIDENCE)  # ends of an interval
BOOTSTRAP_RESAMPLES = 400  # of units, for an interval
CHANCE_SHUFFLES = 50  # of labels between units, for chance
CHANCE_TREES = 25  # of the forest of a shuffle: 50 forests take less time so than ten of the others
HELD_OUT_SHARE = 0.3  # of the units, and of the conditions
MIN_UNITS = 8
MISSING_EXTRA = "the classifier needs scikit-learn: pip install 'strainwave[learn]'"
MAX_RUNS = 2_000_000  # in memory at once
FALSE_ALARM = 0.01  # share of healthy training runs that the threshold of the detector lets alarm
MIN_HEALTHY_RUNS = 100  # from which a threshold of that share is taken
PHYSICAL_FEATURES = (
    "current_order_",
    "current_mean",
    "current_rms",
    "torque_mean",
    "torque_rms",
)  # beginnings of feature names


@dataclass(frozen=True)
class Score(Presented):
    """Balanced accuracy on runs that were held out: the mean over the labels of the share that is recognised.

    Attributes:
        accuracy: [1]
        low, high: 95 % interval, by drawing whole units anew (bootstrap over units); of chance, quantiles over the shuffles [1]
        runs: that were judged
        units: that these runs belong to
    """

    accuracy: float
    low: float
    high: float
    runs: int
    units: int


@dataclass(frozen=True)
class Benchmark(Presented):
    """Scores of the classifier, of a detector, and of chance.

    Attributes:
        by_unit: units held out, conditions known
        by_condition: conditions held out, units known
        by_both: units and conditions held out
        leaky: runs held out at random, so that units and conditions are known; not a figure to rely on
        chance: labels shuffled between units, units held out: mean and quantiles over the shuffles, by smaller forests
        detector: the physics-based detector on the same held-out units: faulty or not; None without its alarms
        classifier_detects: the classifier on the same question, units held out; None likewise
        false_alarms: share of held-out healthy runs for which the detector alarms; None without it
        confusion: counts of label (rows) and answer (columns), units held out, shape (labels, labels)
        labels: in the order of `confusion`
    """

    by_unit: Score
    by_condition: Score
    by_both: Score
    leaky: Score
    chance: Score
    detector: Score | None
    classifier_detects: Score | None
    false_alarms: float | None
    confusion: NDArray[np.int64]
    labels: tuple[str, ...]


@dataclass(frozen=True)
class LabelledRuns:
    """Features of runs, with their label, unit and condition.

    Args:
        features: by name, each of shape (runs,); not-a-number where a run does not determine one
        label: of each run, shape (runs,)
        unit, condition: number of each run, shape (runs,)
        healthy: the label of runs without a fault
    """

    features: Mapping[str, Array]
    label: Labels
    unit: NDArray[np.int64]
    condition: NDArray[np.int64]
    healthy: str = HEALTHY_LABEL

    def __post_init__(self) -> None:
        runs = len(self.label)
        shapes = {name: np.shape(values) for name, values in self.features.items()}
        shapes |= {"unit": np.shape(self.unit), "condition": np.shape(self.condition)}
        if wrong := [f"{name} {shape}" for name, shape in shapes.items() if shape != (runs,)]:
            raise ValueError(f"all columns must have the shape ({runs},) of label: {listed(wrong)}")
        if not self.features:
            raise ValueError("features must name one column or more")
        if len(np.unique(self.label)) < 2:
            raise ValueError(f"label must have two values or more, not {listed(np.unique(self.label).tolist())} alone")
        if (units := len(np.unique(self.unit))) < MIN_UNITS:
            raise ValueError(f"unit must have {MIN_UNITS} values or more, not {units}: units are held out as a whole")
        if len(np.unique(self.condition)) < 2:
            raise ValueError("condition must have two values or more: conditions are held out as a whole")
        for name, values in self.features.items():
            if np.isinf(values).any():
                raise ValueError(f"{name} has infinite values; leave out the runs that failed")

    @property
    def matrix(self) -> Array:
        """Features, shape (runs, features)."""
        return np.column_stack(list(self.features.values()))


Detector = Callable[[NDArray[np.bool_]], NDArray[np.bool_]]


def benchmark(runs: LabelledRuns, detector: Detector | None = None, seed: int = 0) -> Benchmark:
    """Return how well a random forest recognises the labels of units and conditions that it was not trained on.

    Args:
        runs: with their features
        detector: returns the runs that alarm, shape (runs,), after a calibration on those that are True in its argument
        seed: of the choice of units and conditions, and of the forest

    Raises:
        ImportError: scikit-learn is not installed, with the command that installs it

    Source: Breiman2001 for the forest; the interval draws units and not runs, because runs of one unit are alike.
    """
    seed = arguments.whole("seed", seed, 0)
    chance = np.random.default_rng(seed)
    held_unit = _held_out(runs.unit, chance)
    held_condition = _held_out(runs.condition, chance)
    held_run = chance.random(len(runs.label)) < HELD_OUT_SHARE
    # each run has the label of the same run of another unit, drawn once for a unit
    group, inverse = np.unique(runs.unit, return_inverse=True)
    first = np.array([np.flatnonzero(inverse == place)[0] for place in range(len(group))])
    shuffled = [np.asarray(chance.permutation(runs.label[first])[inverse]) for _ in range(CHANCE_SHUFFLES)]
    answers = _answers(runs, runs.label, ~held_unit, held_unit, seed)
    truth, units = runs.label[held_unit], runs.unit[held_unit]
    labels = tuple(np.unique(runs.label).tolist())

    def score(train: NDArray[np.bool_], test: NDArray[np.bool_]) -> Score:
        return _score(runs.label[test], _answers(runs, runs.label, train, test, seed), runs.unit[test], seed)

    alarms = None if detector is None else detector(~held_unit)[held_unit]
    sound = truth == runs.healthy
    return Benchmark(
        by_unit=_score(truth, answers, units, seed),
        by_condition=score(~held_condition, held_condition),
        by_both=score(~held_unit & ~held_condition, held_unit & held_condition),
        leaky=score(~held_run, held_run),
        chance=_chance(runs, shuffled, held_unit, seed),
        detector=None if alarms is None else _detects(truth, alarms, runs, units, seed),
        classifier_detects=None if alarms is None else _detects(truth, answers != runs.healthy, runs, units, seed),
        false_alarms=None if alarms is None or not sound.any() else float(alarms[sound].mean()),
        confusion=np.array([[np.sum((truth == row) & (answers == column)) for column in labels] for row in labels], np.int64),
        labels=labels,
    )


def balanced_accuracy(truth: Labels, answers: Labels) -> float:
    """Return the mean over the labels of the share of their runs that is recognised.

    >>> balanced_accuracy(np.array(["a", "a", "a", "b"]), np.array(["a", "a", "b", "b"]))
    0.8333333333333333
    """
    return float(np.mean([np.mean(answers[truth == label] == label) for label in np.unique(truth)]))


def _held_out(group: NDArray[np.int64], chance: np.random.Generator) -> NDArray[np.bool_]:
    """True for the runs of a share of the groups, one group at the least."""
    groups = np.unique(group)
    held = chance.permutation(groups)[: max(1, round(HELD_OUT_SHARE * len(groups)))]
    return np.isin(group, held)


def _chance(runs: LabelledRuns, shuffled: list[Labels], held_unit: NDArray[np.bool_], seed: int) -> Score:
    """Score of forests that were trained on shuffled labels: the mean over the shuffles, and their quantiles as interval."""
    truth, units = runs.label[held_unit], runs.unit[held_unit]
    accuracies = [
        balanced_accuracy(truth, _answers(runs, label, ~held_unit, held_unit, seed, CHANCE_TREES)) for label in shuffled
    ]
    low, high = np.quantile(accuracies, INTERVAL_ENDS)
    return Score(float(np.mean(accuracies)), float(low), float(high), len(truth), len(np.unique(units)))


def _answers(
    runs: LabelledRuns, label: Labels, train: NDArray[np.bool_], test: NDArray[np.bool_], seed: int, trees: int | None = None
) -> Labels:
    """Labels that a forest trained on some runs gives to others."""
    try:
        from sklearn.ensemble import RandomForestClassifier
    except ImportError:
        raise ImportError(MISSING_EXTRA) from None
    forest = RandomForestClassifier(
        trees or FOREST_TREES, min_samples_leaf=MIN_RUNS_PER_LEAF, class_weight="balanced", random_state=seed, n_jobs=-1
    )
    forest.fit(runs.matrix[train], label[train])
    return np.asarray(forest.predict(runs.matrix[test]))


def _detects(truth: Labels, alarm: NDArray[np.bool_], runs: LabelledRuns, units: NDArray[np.int64], seed: int) -> Score:
    """Score of the question whether a run is faulty."""
    words = np.array(["healthy", "faulty"])
    return _score(words[(truth != runs.healthy).astype(int)], words[alarm.astype(int)], units, seed)


def _score(truth: Labels, answers: Labels, units: NDArray[np.int64], seed: int) -> Score:
    chance = np.random.default_rng(seed)
    members = [np.flatnonzero(units == unit) for unit in np.unique(units)]
    drawn = []
    for _ in range(BOOTSTRAP_RESAMPLES):
        rows = np.concatenate([members[place] for place in chance.integers(len(members), size=len(members))])
        drawn.append(balanced_accuracy(truth[rows], answers[rows]))
    low, high = np.quantile(drawn, INTERVAL_ENDS)
    return Score(balanced_accuracy(truth, answers), float(low), float(high), len(truth), len(members))


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
        """
        used = self.healthy & train
        if used.sum() < MIN_HEALTHY_RUNS:
            raise ValueError(
                f"{used.sum()} healthy training runs do not determine a threshold; the plan needs {MIN_HEALTHY_RUNS} or more"
            )
        sigma = np.sqrt(_mean_square(self.difference[used], axis=0))
        kept = sigma > 0.0
        statistic = _mean_square(self.difference[:, kept] / sigma[kept], axis=1)
        return np.asarray(statistic > np.quantile(statistic[used], 1.0 - FALSE_ALARM))


def _mean_square(values: Array, axis: int) -> Array:
    """Return the mean of the squares of numbers, those that are not-a-number left out; 0 if there are none."""
    there = ~np.isnan(values)
    return np.asarray(np.sum(np.where(there, values, 0.0) ** 2, axis=axis) / np.maximum(there.sum(axis=axis), 1))


def labelled_runs(folder: str | Path) -> tuple[LabelledRuns, LabelledRuns, DetectorRuns]:
    """Return the runs of a data set with their features, with differences from the first stage, and for the detector.

    First stages and failed runs are left out.

    A run counts as faulty if its unit has a fault and the severity at its stage is above 0.
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
    label = np.where(severity[kept] > 0.0, columns["fault"][kept], HEALTHY_LABEL).astype(np.str_)
    features = {name: columns[name][kept].astype(np.float64) for name in names}
    features = {name: values for name, values in features.items() if not np.isnan(values).all()}
    changes = {name: values - columns[name][reference] for name, values in features.items()}
    groups = columns["unit"][kept].astype(np.int64), columns["condition"][kept].astype(np.int64)
    physical = np.column_stack([values for name, values in changes.items() if name.startswith(PHYSICAL_FEATURES)])
    return (
        LabelledRuns(features, label, *groups),
        LabelledRuns(changes, label, *groups),
        DetectorRuns(physical, label == HEALTHY_LABEL),
    )


def _columns(paths: list[Path]) -> tuple[list[str], dict[str, NDArray[Any]]]:
    """Names of the features, and the columns of all shards that are used."""
    tables = [read_columns(path) for path in paths]
    roles = {field.name: (field.metadata or {}).get(b"role", b"").decode() for field in tables[0].schema}
    names = [name for name, role in roles.items() if role == "feature"]
    wanted = [*names, "unit", "condition", "stage", "fault", *(name for name in roles if name.startswith("severity."))]
    return names, {name: np.concatenate([table[name].to_numpy() for table in tables]) for name in wanted}
