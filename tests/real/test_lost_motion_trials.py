"""A test of lost motion and a whole loop as a bench exports them, read and evaluated at the first command."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.identify import identify
from strainwave.rig import analyse
from strainwave.rig.reading.recorded import read_loop

TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", Path(__file__).parents[3] / "shared" / "trials"))
FOLDER = TRIALS / "lostmotion"

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason=f"trials not found: {FOLDER} (set STRAINWAVE_TRIALS)")

RATED = 67.0
A1, A3, STIFFNESS, BREAKAWAY = 1.6e4, 3e9, [6e3, 4e3], [0.5, 1.2]  # of the simulated gear, by the README of the trials


def turned(peak: float, torque: float) -> float:
    """Angle of the rising branch of a steady cycle at a torque, by bisection of its twist."""

    def loop(twist: float) -> tuple[np.ndarray, np.ndarray]:
        path = twist * np.interp(np.linspace(0.0, 5.0, 20001), [0.0, 1.0, 3.0, 5.0], [0.0, 1.0, -1.0, 1.0])
        held = sw.hysteresis.MaxwellSlip(stiffness=STIFFNESS, breakaway=BREAKAWAY).trace(path)
        return path, A1 * path + A3 * path**3 + held

    low, high = 0.0, 0.01
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if loop(middle)[1][-1] < peak else (low, middle)
    path, whole = loop(low)
    return float(np.interp(torque, whole[12000:], path[12000:]))


def test_a_cycle_to_four_percent_has_the_lost_motion_of_the_gear() -> None:
    found = analyse(read_loop(FOLDER / "lost.csv"), rated_torque=RATED)
    assert found.whole_angle
    assert found.lost_motion is not None
    truth = 2.0 * turned(0.04 * RATED, 0.04 * RATED)
    assert found.lost_motion.low < truth < found.lost_motion.high
    assert found.lost_motion.value == pytest.approx(truth, rel=0.02)


@pytest.mark.slow("rig")
def test_the_whole_loop_has_the_losses_and_the_spring_of_the_gear() -> None:
    found = analyse(read_loop(FOLDER / "full.csv"), rated_torque=RATED)
    assert not found.whole_angle
    for result, torque in ((found.lost_motion, 0.04 * RATED), (found.hysteresis_loss, 0.0)):
        assert result is not None
        falling, rising = -turned(RATED, -torque), turned(RATED, torque)  # the falling branch is the rising one, turned round
        assert result.value == pytest.approx(falling - rising, rel=0.03)
    identified = identify("csg-20-100", [FOLDER / "full.csv"])
    assert any("cubic spring with 2 Maxwell elements predicts better" in each for each in identified.files[0].remarks)
    numbers = {each.estimate.path: each.estimate for each in identified.parameters}
    assert abs(numbers["gear.stiffness.a1"].value - A1) < 3.0 * numbers["gear.stiffness.a1"].sigma < 0.02 * A1
    assert abs(numbers["gear.stiffness.a3"].value - A3) < 3.0 * numbers["gear.stiffness.a3"].sigma < 0.05 * A3
    assert numbers["gear.hysteresis.breakaway[0]"].value == pytest.approx(sum(BREAKAWAY), rel=0.05)


def test_correlated_estimates_with_small_standard_deviations_are_identified() -> None:
    found = identify("csg-20-100", [FOLDER / "lost.csv"])
    numbers = {each.estimate.path: each.estimate for each in found.parameters}
    stiffness, breakaway = (next(path for path in numbers if name in path) for name in ("hysteresis.stiffness", "breakaway"))
    assert numbers.keys() == {"gear.stiffness.k", stiffness, breakaway}
    truth = [A1 + STIFFNESS[1], STIFFNESS[0], BREAKAWAY[0]]  # of small loads, under which the second element never slips
    assert all(abs(each.value - true) < 2.0 * each.sigma for each, true in zip(numbers.values(), truth, strict=True))
    k = numbers["gear.stiffness.k"]
    assert k.sigma < 0.025 * k.value  # although its correlation with the breakaway torque is -0.991
