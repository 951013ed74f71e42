"""Plans of torsion loops: the loops that are planned separate the sources that the first ones do not."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave import Gear, kinematics
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
    with pytest.raises(ValueError, match='"bearing" is no source of these loops; they are "bearing, dry"'):
        plan_loops(loops, gear_of(truth), ["bearing"])


def test_a_plan_keeps_its_time(at_input: Measured) -> None:
    truth, loops, _ = at_input
    short = plan_loops(loops, gear_of(truth), time=1.0)
    assert not short.steps
    assert "in this time" in short["bearing, dry"].why
