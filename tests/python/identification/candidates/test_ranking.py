"""Ranking of loops: the law that made a loop comes first, drifts and zeros aside."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.candidates.torsion import fit_loop, held_out_blocks
from strainwave.identification.candidates.torsion.candidate import TorsionCandidate, candidate, starts
from strainwave.identification.candidates.torsion.dissipation import BoucWen, Elements, FadingMemory
from strainwave.identification.candidates.torsion.ranking import rank_loop
from strainwave.identification.candidates.torsion.springs import LINEAR, THREE_SEGMENT
from strainwave.identification.experiments.torsion_loop import TorsionLoop

from tests.evidence.loops import KINDS

Array = NDArray[np.float64]

HALF = 1.5e-3
ELEMENTS = sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3], breakaway=[0.8, 1.2])
SEGMENTS = sw.stiffness.ThreeSegment(k1=1e4, k2=2e4, k3=4e4, t1=4.0, t2=16.0)
NOTHING = sw.stiffness.Linear(k=1e-3)


def along(*ends: float, n: int = 121) -> Array:
    """Twist [rad] from one end to the next, evenly."""
    turns = HALF * np.array(ends)
    travelled = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(turns)))))
    return np.interp(np.linspace(0.0, travelled[-1], n), travelled, turns)


def measured(gear: sw.Gear, twist: Array, noise: float = 0.15) -> TorsionLoop:
    torque = gear.trace(twist)
    return TorsionLoop(twist, torque + noise * np.random.default_rng(4).normal(size=len(twist)), "virgin")


def stiffness(found: TorsionCandidate) -> Any:
    return found.fit.gear.stiffness


@pytest.mark.slow("identification")
def test_the_law_that_made_a_loop_is_found_among_all() -> None:
    law = sw.hysteresis.Regimes(
        positive_unloading=4e4,
        negative_loading=1.5e4,
        negative_unloading=4.4e4,
        positive_loading=1.4e4,
        onset=1.5,
        lost_motion=6e-4,
    )
    ranked = rank_loop(measured(sw.Gear(stiffness=NOTHING, hysteresis=law), along(0, 1, -1, 0.5, 0, 1)), sw.Gear())
    assert ranked[0].name == "a stiffness for each of four regimes"
    assert ranked[0].parameters == 6
    assert ranked[0].good
    assert ranked[0].correlation == pytest.approx(1.0, abs=0.5)
    names = " ".join(each.name for each in ranked)
    assert all(word in names for word in ("Maxwell", "fading", "Bouc", "Preisach", "friction inside", "play", "without"))
    worse = [each.worse[0] for each in ranked if not each.good]
    assert worse == sorted(worse)
    assert {each.predicted for each in ranked} <= {5, 20}
    assert all(each.cost > 0.0 for each in ranked)


@pytest.mark.slow("identification")
def test_the_simplest_of_equals_comes_first() -> None:
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=2e4), hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[8e3], breakaway=[1.2]))
    ranked = rank_loop(measured(gear, along(0, 1, -1, 1, -1)), sw.Gear())
    assert ranked[0].name == "linear spring with 1 Maxwell element"
    assert all(ranked[0].parameters <= each.parameters for each in ranked if each.good)
    assert ranked[0].error == pytest.approx(0.15, rel=0.15)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.words)
def test_torques_of_a_start_are_those_of_the_gear_it_puts(kind: Any) -> None:
    """What is solved for as linear in the weights is what the gear then does."""
    loop = measured(sw.Gear(stiffness=SEGMENTS, hysteresis=ELEMENTS), along(0, 1, -1, 1))
    every = np.ones(len(loop.twist), bool)
    begun = starts(loop, sw.Gear(), every, kind, BoucWen())[0]
    residual = loop.torque - begun.gear.trace(loop.path(loop.middle))[-len(loop.twist) :] - begun.loop.torque_zero
    few = residual[:: -(-len(residual) // 500)]
    assert np.sqrt(np.sum(few**2)) == pytest.approx(begun.error, rel=1e-6)


def test_a_convex_fit_has_no_better_choice_on_its_grid() -> None:
    """Against brute force: non-negative least squares on the tall matrix, for each choice of knees."""
    from scipy.optimize import nnls

    loop = measured(sw.Gear(stiffness=SEGMENTS, hysteresis=ELEMENTS), along(0, 1, -1, 1))
    every = np.ones(len(loop.twist), bool)
    begun = starts(loop, sw.Gear(), every, THREE_SEGMENT, Elements())[0]
    springs = THREE_SEGMENT.library(loop.twist - loop.middle, float(np.abs(loop.twist - loop.middle).max()), sw.Gear())
    plays, ones = Elements().library(loop, sw.Gear()).torques, np.ones((len(loop.twist), 1))
    errors = [
        nnls(np.column_stack((springs.torques[:, choice.columns], plays, ones, -ones)), loop.torque)[1]
        for choice in springs.choices
    ]
    assert begun.error == pytest.approx(min(errors), rel=1e-6)


LAWS: dict[str, tuple[Any, Any]] = {
    "fading memory": (FadingMemory(1), sw.hysteresis.FadingMemory(stiffness=[1.6e4], forgetting=[4e3])),
    "Bouc-Wen": (BoucWen(), sw.hysteresis.BoucWen(stiffness=1.2e4, saturation=4.0, sharpness=2.0, shape=0.7)),
}


@pytest.mark.parametrize("law", LAWS)
def test_numbers_of_other_laws_come_back(law: str) -> None:
    beside, hysteresis = LAWS[law]
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=2e4), hysteresis=hysteresis)
    loop = measured(gear, along(0, 1, -1, 0.5, 0, 1), noise=1e-4)
    found = candidate(loop, sw.Gear(), np.ones(len(loop.twist), bool), LINEAR, beside)
    assert found.error < 1.2e-4
    assert stiffness(found).k == pytest.approx(2e4, rel=1e-3)
    for field in hysteresis.fields:
        assert getattr(found.fit.gear.hysteresis, field["name"]) == pytest.approx(getattr(hysteresis, field["name"]), rel=0.01)


def torque_drift(loop: TorsionLoop) -> TorsionLoop:
    return TorsionLoop(loop.twist, loop.torque + np.linspace(-1.5, 1.5, len(loop.twist)), "virgin")


def twist_drift(loop: TorsionLoop) -> TorsionLoop:
    return TorsionLoop(loop.twist + np.linspace(-5e-5, 5e-5, len(loop.twist)), loop.torque, "virgin")


@pytest.mark.parametrize(("drift", "size"), [(torque_drift, 3.0), (twist_drift, 1e-4)])
def test_a_drift_is_found_where_there_is_one(drift: Callable[[TorsionLoop], TorsionLoop], size: float) -> None:
    loop = measured(sw.Gear(stiffness=SEGMENTS, hysteresis=ELEMENTS), along(0, 1, -1, 1, -1, 0))
    training = held_out_blocks(len(loop.twist))
    still = fit_loop(loop, sw.Gear(), training)[0]
    assert not any(e.path.endswith("_drift") for e in still.fit.estimates)
    best = fit_loop(drift(loop), sw.Gear(), training)[0]
    estimates = {e.path: e for e in best.fit.estimates}
    found = estimates[drift.__name__]
    assert found.value == pytest.approx(size, abs=3.0 * found.sigma)
    assert stiffness(best).k3 == pytest.approx(4e4, rel=0.02)


def test_a_gear_twisted_farther_to_one_side_has_its_zero_where_it_is_unloaded() -> None:
    twist = along(0, 1, -0.3, 1, -0.3, 1)
    loop = measured(sw.Gear(stiffness=SEGMENTS, hysteresis=ELEMENTS), twist)
    shifted = TorsionLoop(twist + 5e-3, loop.torque + 1.0)
    best = fit_loop(shifted, sw.Gear())[0]
    zeros = {e.path: e for e in best.fit.estimates if e.path.endswith("_zero")}
    assert zeros["twist_zero"].value == pytest.approx(5e-3, abs=3.0 * zeros["twist_zero"].sigma)
    assert stiffness(best).k3 == pytest.approx(4e4, rel=0.03)


def test_of_a_single_branch_springs_are_ranked_with_the_hysteresis_kept() -> None:
    gear = sw.Gear(stiffness=SEGMENTS, hysteresis=ELEMENTS)
    ranked = rank_loop(measured(gear, along(0, 1)), sw.Gear(hysteresis=ELEMENTS))
    assert ranked[0].name == "three-segment spring, hysteresis kept"
    assert all(each.fit.gear.hysteresis == ELEMENTS for each in ranked)


def test_a_loop_of_few_samples_is_not_ranked() -> None:
    with pytest.raises(ValueError, match="it needs 40 samples; there are 30"):
        rank_loop(measured(sw.Gear(stiffness=SEGMENTS, hysteresis=ELEMENTS), along(0, 1, -1, 1, n=30)), sw.Gear())
