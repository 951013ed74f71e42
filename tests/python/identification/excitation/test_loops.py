"""Plans of torsion loops: the loops that are planned separate the sources that the first ones do not."""

from __future__ import annotations

import re

import numpy as np
import pytest
from strainwave import Gear, kinematics
from strainwave.analysis.torsion_loop import series_compliance
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.identification import loss_shares, plan_loops

from tests.evidence.drawn.loss_sources import ROOM_TEMPERATURE, SOURCES, Truth, drawn, loops_of, measured

SEED = 6
Measured = tuple[Truth, list[Recording], dict[str, float]]


def gear_of(truth: Truth) -> Gear:
    teeth = 2 * truth.ratio
    wave = kinematics.StrainWave(flexspline_teeth=teeth, circular_spline_teeth=teeth + 2, fixed="circular_spline")
    return Gear().replace(kinematics=wave)


@pytest.fixture(scope="module")
def at_input() -> Measured:
    """A drawn gear, its loops at the input alone, and the true share of each source."""
    random = np.random.default_rng(SEED)
    truth = drawn(random)
    loops, works = zip(*loops_of(truth, "input alone", random), strict=True)
    return truth, list(loops), dict(zip(SOURCES, (works[0] / works[0].sum()).tolist(), strict=True))


def test_planned_loops_separate_what_loops_at_the_input_do_not(
    at_input: tuple[Truth, list[Recording], dict[str, float]],
) -> None:
    truth, loops, true_shares = at_input
    gear = gear_of(truth)
    plan = plan_loops(loops, gear)
    assert plan["bearing, dry"].before > 0.5
    assert {step.settings["measured_at"] for step in plan.steps} == {"output"}
    for step in plan.steps:
        load, rate = float(step.settings["torque_N_m"]) / truth.reach, float(step.settings["twist_rate_rad_s"])
        period = 4.0 * load * truth.reach / truth.stiffness / rate
        random = np.random.default_rng(SEED)
        further, _ = measured(
            truth, random, at_input=False, load=load, period=period, temperature=ROOM_TEMPERATURE, triangle=True
        )
        loops = [*loops, further]
    after = loss_shares(loops, gear)
    for share in after.shares:
        assert share.is_separated
        assert share.sigma == pytest.approx(plan[share.name].after, abs=0.015)
        assert abs(share.share - true_shares[share.name]) < 3.0 * share.sigma


def test_one_source_is_wanted_by_its_name(at_input: Measured) -> None:
    truth, loops, _ = at_input
    plan = plan_loops(loops, gear_of(truth), ["flexspline, material"])
    assert not plan.steps, "its share is separated"
    assert "no loop is needed" in str(plan)
    with pytest.raises(ValueError, match='"bearing" is no source of these loops; they are "bearing, dry"'):
        plan_loops(loops, gear_of(truth), ["bearing"])


def test_a_plan_keeps_its_time(at_input: Measured) -> None:
    truth, loops, _ = at_input
    short = plan_loops(loops, gear_of(truth), time=1.0)
    assert not short.steps
    assert "in this time" in short["bearing, dry"].why
    assert short["bearing, dry"].after == short["bearing, dry"].before
    assert "no measurement fits in 0.0167 min; the shortest takes" in str(short)


def test_loops_at_the_output_lead_to_one_at_the_input(at_input: Measured) -> None:
    truth, at_the_input, _ = at_input
    random, gear = np.random.default_rng(SEED), gear_of(truth)
    loops = [
        measured(truth, random, at_input=False, load=load, period=period, temperature=ROOM_TEMPERATURE, triangle=True)[0]
        for load in (1.0, 0.5)
        for period in (60.0, 12.0)
    ]
    plan = plan_loops(loops, gear, ["bearing, dry"])
    assert {step.settings["measured_at"] for step in plan.steps} == {"input"}
    bearing = plan["bearing, dry"]
    assert np.isinf(bearing.before)
    assert re.search(r"bearing, dry +± 0\.0\d+, was unknown", str(plan))
    share = loss_shares([*loops, *at_the_input[:2]], gear)["bearing, dry"]
    assert share.sigma == pytest.approx(bearing.after, abs=0.005)
    at_one_rate = plan_loops(loops[::2], gear)  # which depart from the form of dry friction, that of the bearing, too
    assert at_one_rate["gear, dry"].after > 2.0 * plan["gear, dry"].after
    assert at_one_rate["bearing, dry"].after == pytest.approx(at_one_rate["gear, dry"].after, abs=0.01)


def test_no_loop_at_the_input_is_planned_of_a_gear_with_stages(at_input: Measured) -> None:
    """`loss_shares` refuses one: it does not determine the torque of the stages."""
    staged = GearSet.read("tilt-actuator").gear
    recording, _ = measured(
        at_input[0], np.random.default_rng(SEED), at_input=False, load=1.0, period=60.0, temperature=ROOM_TEMPERATURE,
        triangle=True,
    )  # fmt: skip
    series = {name: recording[name] for name in recording.names}
    series["twist"] = series["twist"] + series_compliance(staged) * series["torque"]
    with pytest.raises(ValueError, match='"bearing, dry" is no source of these loops'):
        plan_loops([Recording(series, recording.units)], staged, ["bearing, dry"])
