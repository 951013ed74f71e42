"""Members: each a function of plan and index, with units and conditions that stay on one side of each split."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.dataset.faults import with_faults
from strainwave.dataset.plan import HEALTHY_LABEL, DatasetPlan
from strainwave.dataset.sampling import MIXED_SPLIT
from strainwave.dataset.shards import Shards

from tests.python.dataset.plans import SMALL, changed, population, shards

FAULTY = changed(
    units=SMALL["units"] | {"number": 20},
    life={"stages": 3, "usage": 1e6},
    faults=[
        {
            "kind": "lubrication_loss",
            "share": 0.25,
            "severity": {"low": 0.2, "high": 1.0},
            "onset": {"law": "growing", "numbers": {"scale": 1e6}},
        },
        {"kind": "misalignment", "share": 0.5, "numbers": {"housing_eccentricity": {"low": 1e-5, "high": 5e-5}}},
    ],
)


def rows(made: Shards) -> list[dict[str, Any]]:
    return [row for number in range(made.plan.shards) for row in made.tables(*made.span(number))[0].to_pylist()]


@pytest.fixture(scope="module")
def faulty() -> tuple[Shards, list[dict[str, Any]]]:
    made = shards(FAULTY)
    return made, rows(made)


def test_shards_have_every_member_once_and_none_spans_two_conditions() -> None:
    made = shards(FAULTY)
    spans = [made.span(number) for number in range(made.plan.shards)]
    assert spans[0][0] == 0
    assert spans[-1][1] == made.plan.members
    assert all(early[1] == late[0] for early, late in pairwise(spans))
    each = made.plan.members_per_condition
    assert all(first // each == (last - 1) // each for first, last in spans)


@pytest.mark.slow("dataset")
def test_a_member_made_alone_is_its_row_of_the_data_set(faulty: tuple[Shards, list[dict[str, Any]]]) -> None:
    made, all_rows = faulty
    for index in (0, 61, 130, len(all_rows) - 1):
        (alone,) = made.member(index)[0].to_pylist()
        for name, value in all_rows[index].items():
            expected = pytest.approx(value, nan_ok=True, rel=1e-6, abs=1e-9) if isinstance(value, float) else value
            assert alone[name] == expected, name


def test_no_unit_and_no_condition_is_in_two_splits(faulty: tuple[Shards, list[dict[str, Any]]]) -> None:
    _, all_rows = faulty
    for what in ("unit", "condition"):
        splits: dict[int, set[str]] = {}
        for row in all_rows:
            splits.setdefault(row[what], set()).add(row[f"split_{what}"])
        assert all(len(names) == 1 for names in splits.values())
        assert len(set.union(*splits.values())) > 1
    train, test = ([row for row in all_rows if row["split"] == name] for name in ("train", "test"))
    assert train
    assert test
    assert not {row["unit"] for row in train} & {row["unit"] for row in test}
    assert not {row["condition"] for row in train} & {row["condition"] for row in test}
    assert MIXED_SPLIT in {row["split"] for row in all_rows}


def test_shares_of_faults_and_splits_are_met_to_one_unit() -> None:
    units = np.arange(1000)
    whole = population(FAULTY | {"units": {"number": 1000}})
    assert [(whole.unit_faults(units) == name).sum() for name in ("lubrication_loss", "misalignment", HEALTHY_LABEL)] == [
        250,
        500,
        250,
    ]
    assert [(whole.unit_split(units) == name).sum() for name in ("train", "validation", "test")] == [700, 150, 150]


def test_fault_and_split_are_independent() -> None:
    units = np.arange(4000)
    whole = population(FAULTY | {"units": {"number": 4000}})
    share = (whole.unit_split(units)[whole.unit_faults(units) == HEALTHY_LABEL] == "test").mean()
    assert share == pytest.approx(0.15, abs=5.0 * np.sqrt(0.15 * 0.85 / 1000))


def test_severity_grows_with_the_stages_of_a_unit(faulty: tuple[Shards, list[dict[str, Any]]]) -> None:
    _, all_rows = faulty
    units = {row["unit"] for row in all_rows if row["fault"] == "lubrication_loss"}
    assert len(units) == 5
    for unit in units:
        life = [row["severity.lubrication_loss"] for row in all_rows if row["unit"] == unit and row["condition"] == 0]
        assert life[0] == 0.0
        assert life[1] == pytest.approx(0.5 * life[2])
        assert 0.2 <= life[2] <= 1.0


def test_numbers_of_a_member_are_those_of_its_drive_with_its_fault(faulty: tuple[Shards, list[dict[str, Any]]]) -> None:
    made, all_rows = faulty
    drive = sw.load("tilt-actuator-lumped")
    found = 0
    for row in all_rows[: made.plan.members_per_condition]:
        own = drive.replace({path: row[path] for path in ("motor.resistance", "load.inertia")})
        if row["fault"] == "lubrication_loss":
            own = with_faults(own, [sw.fault.LubricationLoss(severity=row["severity.lubrication_loss"])])
        elif row["fault"] == HEALTHY_LABEL:
            assert row["severity.misalignment"] == row["severity.lubrication_loss"] == 0.0
        else:
            continue
        found += 1
        for name in ("coulomb", "breakaway", "stribeck_speed", "viscous"):
            assert row[f"gear.friction_output.{name}"] == pytest.approx(getattr(own.gear.friction_output, name), rel=1e-12)
    assert found == 30


def test_features_are_those_of_a_run_of_the_drive_with_these_numbers() -> None:
    made = shards(changed(features={}))
    (row,) = made.member(5)[0].to_pylist()
    drive = sw.load("tilt-actuator-lumped")
    sensors = drive.sensors
    quiet = {name: getattr(sensors, name).law for name in ("input_speed", "output_angle", "current")}
    own = drive.replace({path: row[path] for path in ("motor.resistance", "load.inertia")}, sensors=sensors.replace(**quiet))
    run = sw.simulate(
        own,
        sw.scenario.ramp(row["condition.speed"], 0.1),
        5e-4,
        sample=2e-3,
        temperature=row["condition.temperature"],
    )
    assert row["current_rms"] == pytest.approx(np.sqrt((run["current"] ** 2).mean()), rel=1e-6)
    assert row["torque_peak"] == pytest.approx(np.abs(run["torque"]).max(), rel=1e-6)


def test_a_member_that_cannot_run_has_the_reason_and_no_features() -> None:
    """An inertia of almost nothing vibrates faster than the steps can follow."""
    spread = {"load.inertia": {"low": 1e-7, "high": 0.6}}
    table = shards(changed(units={"number": 12, "design": "grid", "spread": spread})).tables(0, 12)[0]
    failures = table["failure"].to_pylist()
    assert failures[0] is not None
    assert "too coarse" in failures[0]
    assert failures[-1] is None
    assert np.isnan(table["current_rms"].to_numpy()[0])
    assert np.isfinite(table["current_rms"].to_numpy()[-1])


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ({"kind": "no_such_fault", "share": 0.5}, 'faults.kind = "no_such_fault" is not known; there are misalignment'),
        ({"kind": "misalignment", "share": 0.5, "numbers": {"colour": 1.0}}, 'misalignment has no "colour"'),
        ({"kind": "lubrication_loss", "share": 0.5, "onset": {"law": "sudden"}}, 'onset.law = "sudden" is not known'),
        ({"kind": "encoder_eccentricity", "share": 0.5}, "needs a law encoder at sensors.output_angle, where second_order is"),
        ({"kind": "wave_generator_bearing", "share": 0.5}, "changes nothing of this drive"),
    ],
)
def test_a_fault_without_its_part_is_refused_before_the_first_run(
    fault: dict[str, Any], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Shards, "tables", None)  # no run
    with pytest.raises(ValueError, match=said):
        population(changed(faults=[fault])).check()


def test_samples_are_decimated_series() -> None:
    kept = shards(changed(samples={"columns": ["current", "tracking_error"], "every": 5}))
    table = kept.tables(0, 4)[1]
    assert table is not None
    assert table.column_names == ["member", "current", "tracking_error"]
    whole = kept.member(2)[1]
    assert whole is not None
    assert table["current"].to_pylist()[2] == pytest.approx(whole["current"].to_pylist()[0][::5], rel=1e-6)


def test_the_plan_of_a_population_is_untouched_by_one_member() -> None:
    made = shards(SMALL)
    made.member(1)
    assert made.plan == DatasetPlan.of(SMALL)


WORN = changed(
    drive="space-pointing-joint",
    simulation={"duration": 0.2, "dt": 5e-4, "sample": 2e-3},
    units={"number": 3, "spread": {"load.inertia": {"low": 4.0, "high": 6.0}}},
    life={"stages": 3, "runs": 2e6},
    faults=[
        {
            "kind": "tooth_wear",
            "share": 1.0,
            "onset": {"law": "growing", "numbers": {"scale": 1e6}, "words": {"unit": "transmitted_work"}},
        }
    ],
    conditions=[{"profile": "constant_speed", "numbers": {"speed": 0.1}, "load_torque": load} for load in (1.0, 4.0)],
    features={},
)


def test_wear_grows_with_the_work_of_the_own_run_of_each_member() -> None:
    """The work of a healthy run by the general drive, one by one, stands against that of all units together."""
    made = population(WORN)
    assert shards(WORN).column_units()["usage"] == "J"
    last = {}
    for number, load in enumerate((1.0, 4.0)):
        table = made.members(9 * number, 9 * number + 9)
        assert table.usage[::3].tolist() == [0.0, 0.0, 0.0]
        assert table.usage[1::3] == pytest.approx(0.5 * table.usage[2::3])
        assert table.severity["tooth_wear"] == pytest.approx(np.minimum(table.usage / 1e6, 1.0))
        own = [
            sw.simulate(
                made.drive.replace({"load.inertia": float(table.parameters["load.inertia"][3 * unit])}),
                table.condition.command, 5e-4, sample=2e-3, load_torque=load,
            )
            for unit in range(3)
        ]  # fmt: skip
        work = [sw.diagnose.transmitted_work(each) for each in own]
        assert table.usage[2::3] == pytest.approx(2e6 * np.array(work), rel=1e-9)
        assert len(set(table.usage[2::3].tolist())) == 3
        last[load] = table
    assert (last[4.0].usage[2::3] > last[1.0].usage[2::3]).all()
    clearance = "gear.stiffness.clearance"
    assert last[1.0].parameters[clearance] == pytest.approx(3e-4 * last[1.0].severity["tooth_wear"])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"life": {"stages": 3, "runs": 1e6, "usage": 1.0}}, "usage and runs are given"),
        (
            {"faults": [*WORN["faults"], {"kind": "lubrication_loss", "share": 0.0, "onset": FAULTY["faults"][0]["onset"]}]},
            "onset.words.unit is output_revolutions, transmitted_work; all onsets of a plan count usage in one unit",
        ),
    ],
)
def test_a_usage_in_two_measures_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        population(WORN | changes).check()
