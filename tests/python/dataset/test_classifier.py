"""The classifier on runs whose classes are known: one that features determine, one that they do not, one that leaks."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.dataset import classifier
from strainwave.dataset.classifier import LabelledRuns, balanced_accuracy, benchmark

pytest.importorskip("sklearn")

UNITS, CONDITIONS, REPEATS = 24, 4, 6
TREES = 20  # of a forest: five features need no more
CHANCE_SHUFFLES, CHANCE_TREES = 20, 5  # fewer than those of a result, as a test grows them each time


@pytest.fixture(autouse=True)
def small_forests(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(classifier, "FOREST_TREES", TREES)
    monkeypatch.setattr(classifier, "CHANCE_SHUFFLES", CHANCE_SHUFFLES)
    monkeypatch.setattr(classifier, "CHANCE_TREES", CHANCE_TREES)


def runs(effect: float, own: float, seed: int = 0) -> LabelledRuns:
    """Runs whose first feature contains the fault times `effect`, and whose others contain the unit times `own`."""
    chance = np.random.default_rng(seed)
    unit, condition, _ = (each.reshape(-1) for each in np.indices((UNITS, CONDITIONS, REPEATS)))
    faulty = unit % 2 == 1
    first = effect * faulty + chance.standard_normal(len(unit))
    others = {
        f"own_{n}": own * chance.standard_normal(UNITS)[unit] + 0.01 * chance.standard_normal(len(unit)) for n in range(4)
    }
    label = np.where(faulty, "crack", "healthy")
    return LabelledRuns({"first": first} | others, label, unit, condition)


@pytest.mark.slow("dataset")
def test_a_feature_that_determines_the_fault_is_found_on_units_and_conditions_that_are_held_out() -> None:
    labelled = runs(effect=12.0, own=1.0)
    found = benchmark(labelled, lambda train: labelled.features["first"] > 6.0)
    assert min(found.by_unit.accuracy, found.by_condition.accuracy, found.by_both.accuracy) > 0.98
    assert found.detector is not None
    assert found.false_alarms == 0.0
    assert found.detector.accuracy > 0.98


@pytest.mark.slow("dataset")
def test_a_split_by_run_pretends_what_held_out_units_do_not_have() -> None:
    found = benchmark(runs(effect=0.0, own=1.0))
    assert found.leaky.accuracy > 0.95  # the forest recognises units
    assert found.by_unit.low < 0.5 < found.by_unit.high + 0.1


@pytest.mark.slow("dataset")
def test_chance_has_one_over_the_labels_inside_the_quantiles_of_its_shuffles() -> None:
    """Features of the unit alone: the answers of a shuffle are the same for all runs of a unit, and differ between shuffles."""
    found = benchmark(runs(effect=0.0, own=1.0)).chance
    assert found.low < 0.5 < found.high
    assert found.low < found.accuracy < found.high
    assert found.units == round(classifier.HELD_OUT_SHARE * UNITS)


@pytest.mark.slow("dataset")
def test_counts_of_the_confusion_are_those_of_the_runs_that_were_held_out() -> None:
    found = benchmark(runs(effect=3.0, own=0.0))
    assert found.confusion.sum() == found.by_unit.runs
    shares = np.diag(found.confusion) / found.confusion.sum(axis=1)
    assert shares.mean() == pytest.approx(found.by_unit.accuracy)


def test_balanced_accuracy_of_one_answer_is_one_over_the_labels() -> None:
    truth = np.array(["a"] * 90 + ["b"] * 9 + ["c"])
    assert balanced_accuracy(truth, np.full(100, "a")) == pytest.approx(1 / 3)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"unit": np.zeros(4, dtype=np.int64)}, "shape"),
        ({"label": np.full(UNITS * CONDITIONS * REPEATS, "crack")}, "two values"),
        ({"unit": np.zeros(UNITS * CONDITIONS * REPEATS, dtype=np.int64)}, "unit must have 8"),
        ({"condition": np.zeros(UNITS * CONDITIONS * REPEATS, dtype=np.int64)}, "condition must have two"),
        ({"features": {}}, "features"),
    ],
)
def test_runs_that_cannot_be_split_are_refused(change: dict[str, object], text: str) -> None:
    good = vars(runs(effect=1.0, own=0.0))
    with pytest.raises(ValueError, match=text):
        LabelledRuns(**(good | change))
