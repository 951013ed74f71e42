"""Torsion loops: gears with known springs and elements come back from the loops they make."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identify.experiment import TorsionLoop
from strainwave.identify.torsion import fit_loop, held_out_blocks

Array = NDArray[np.float64]

ELEMENTS = sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3], breakaway=[0.8, 1.2])
SPRINGS = {
    "linear": sw.stiffness.Linear(k=2e4),
    "cubic": sw.stiffness.Cubic(a1=1.5e4, a3=6e9),
    "three_segment": sw.stiffness.ThreeSegment(k1=1e4, k2=2e4, k3=4e4, t1=4.0, t2=16.0),
}


def cycle(amplitude: float = 1.5e-3, n: int = 200) -> Array:
    quarter = np.linspace(0.0, amplitude, n // 4)
    return np.concatenate((quarter[::-1], -quarter[1:], -quarter[-2::-1], quarter[1:]))


def loop(spring: object, twist: Array, *, virgin: bool = False) -> TorsionLoop:
    path = np.concatenate(([0.0], twist)) if virgin else np.concatenate((twist, twist))
    torque = ELEMENTS.trace(path)[-len(twist) :] + spring.torque(twist)  # type: ignore[attr-defined]
    return TorsionLoop(twist, torque)


@pytest.mark.parametrize("kind", SPRINGS)
def test_each_spring_is_recognised_by_data_held_out_blocks(kind: str) -> None:
    measured = loop(SPRINGS[kind], cycle())
    best = fit_loop(measured, sw.Gear(), held_out_blocks(len(measured.twist)))[0]
    assert best.name.startswith(kind.replace("_", "-"))
    assert best.error < 2e-3 * np.ptp(measured.torque)


def test_stiffness_and_breakaway_come_back() -> None:
    best = fit_loop(loop(SPRINGS["linear"], cycle(n=800)), sw.Gear())[0]
    assert best.fit.gear.stiffness.k == pytest.approx(2e4, rel=0.01)
    assert sum(best.fit.gear.hysteresis.breakaway) == pytest.approx(2.0, rel=0.02)
    assert sum(best.fit.gear.hysteresis.stiffness) == pytest.approx(1.2e4, rel=0.05)


def test_zeros_of_both_axes_do_not_matter() -> None:
    measured = loop(SPRINGS["cubic"], cycle())
    shifted = TorsionLoop(measured.twist + 0.02, measured.torque - 3.0)
    best = fit_loop(shifted, sw.Gear())[0]
    assert best.error < 2e-3 * np.ptp(measured.torque)
    zeros = {e.path: e.value for e in best.fit.estimates if e.path.endswith("_zero")}
    assert zeros["twist_zero"] == pytest.approx(0.02, abs=2e-5)
    assert zeros["torque_zero"] == pytest.approx(-3.0, abs=0.05)


def test_a_first_loading_is_told_from_a_cycle() -> None:
    quarter = np.linspace(0.0, 1.5e-3, 60)
    path = np.concatenate((quarter[1:], quarter[-2::-1], -quarter[1:], -quarter[-2::-1]))
    best = fit_loop(loop(SPRINGS["linear"], path, virgin=True), sw.Gear())[0]
    assert best.fit.experiment.history == "virgin"  # type: ignore[attr-defined]
    assert best.error < 2e-3 * 60.0


def test_a_loop_at_the_input_is_referred_to_the_output() -> None:
    gear = sw.Gear(kinematics=sw.kinematics.StrainWave(flexspline_teeth=100, circular_spline_teeth=102))
    assert gear.kinematics.ratio == -50.0
    angle, torque = np.array([0.0, 0.5, 0.0]), np.array([0.0, 0.1, -0.02])
    recording = sw.Recording({"input_angle": angle, "input_torque": torque}, {"input_angle": "rad", "input_torque": "N.m"})
    measured = TorsionLoop.of(recording, gear)
    assert measured.twist == pytest.approx(angle / -50.0)
    assert measured.torque == pytest.approx(-50.0 * torque)
    # virtual work: the torque does the same work on either side
    assert np.trapezoid(measured.torque, measured.twist) == pytest.approx(np.trapezoid(torque, angle))


@pytest.mark.parametrize("twist", [np.linspace(0.0, 1e-3, 50), np.zeros(50)])
def test_one_branch_is_refused(twist: Array) -> None:
    with pytest.raises(ValueError, match="one branch only"):
        TorsionLoop(twist, 1e4 * twist)


def test_what_is_kept_back_comes_in_blocks_over_the_whole_loop() -> None:
    training = held_out_blocks(400)
    assert training.sum() == 300
    assert np.count_nonzero(np.diff(training.astype(int))) == 9  # five blocks, the last one at the end


def test_no_element_that_cannot_slip_within_the_loop_is_left_in_the_model() -> None:
    noise = 0.02 * np.random.default_rng(11).normal(size=197)
    for kind, spring in SPRINGS.items():
        measured = loop(spring, cycle())
        noisy = TorsionLoop(measured.twist, measured.torque + noise[: len(measured.torque)])
        for candidate in fit_loop(noisy, sw.Gear()):
            elements = candidate.fit.gear.hysteresis
            slips = np.array(elements.breakaway) / np.array(elements.stiffness)
            assert np.all(slips < 0.5 * np.ptp(measured.twist)), kind
            assert all(np.isfinite(e.sigma) for e in candidate.fit.estimates if e.path.startswith("hysteresis")), kind


def test_a_loop_that_cannot_be_one_is_refused() -> None:
    measured = loop(SPRINGS["linear"], cycle())
    with pytest.raises(ValueError, match="torque falls as the twist grows"):
        TorsionLoop(measured.twist, -measured.torque)
    with pytest.raises(ValueError, match="gives energy instead of losing it"):
        TorsionLoop(measured.twist[::-1].copy(), measured.torque[::-1].copy())
