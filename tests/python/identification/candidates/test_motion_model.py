"""Torque over the angle of a log: found where the record separates it, and the same in the gear as in the terms of the log."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.candidates.motion import fit_motion
from strainwave.identification.candidates.motion_model import INPUT, MotionModel, by_full_band, is_one_wave, with_ripple
from strainwave.identification.experiments.motion_log import MotionLog

RATIO, COULOMB, VISCOUS, NOISE = 50.0, 0.084, 4e-4, 2e-3
DRIVE = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=RATIO),
        friction_input=sw.friction.Coulomb(coulomb=COULOMB, breakaway=COULOMB, viscous=VISCOUS),
    ),
    motor=sw.motor.TorqueSource(inertia=1e-5),
    load=sw.loads.Inertia(inertia=0.05),
)


@cache
def log(wave: float, detent: float, size: float = 2.0, order: float = 1.0, ahead: float = 0.0) -> MotionLog:
    """Return a log with friction that varies by a share, and a detent of order 2 [N.m], of a joint that drifts [rad/s]."""
    time = np.arange(0.0, 40.0, 0.01)
    angle = size * (np.sin(0.25 * time) + 0.4 * np.sin(0.61 * time)) + ahead * time
    speed = size * (0.25 * np.cos(0.25 * time) + 0.244 * np.cos(0.61 * time)) + ahead
    theta = RATIO * angle
    torque = COULOMB * (1.0 + wave * np.cos(order * theta)) * np.sign(speed) + VISCOUS * RATIO * speed
    torque += detent * np.sin(2.0 * theta - 0.4) + NOISE * np.random.default_rng(1).normal(size=len(time))
    columns = {"time": time, "input_angle": theta, "input_torque": torque}
    return MotionLog.of(sw.Recording(columns, {"time": "s", "input_angle": "rad", "input_torque": "N.m"}), DRIVE)


def model(of: MotionLog) -> MotionModel:
    return MotionModel("Coulomb and viscous", of, DRIVE, (f"{INPUT}coulomb", f"{INPUT}viscous"), {})


def test_waves_are_those_of_the_record_and_stand_in_the_gear() -> None:
    found = with_ripple(model(log(0.25, 0.02)))
    assert found is not None
    law = found.drive.gear.friction_input
    assert (list(law.order), list(law.detent_order)) == ([1.0], [2.0])
    assert law.amplitude[0] == pytest.approx(0.25, abs=0.01)
    assert law.detent_torque[0] == pytest.approx(0.02, abs=4e-4)


def test_a_record_without_waves_or_of_little_motion_has_none() -> None:
    assert with_ripple(model(log(0.0, 0.0))) is None
    assert with_ripple(model(log(0.25, 0.02, size=0.05))) is None  # less than a turn of the input


def test_a_wave_that_another_one_makes_up_is_left_out() -> None:
    """The joint goes back for 4 % of the time: friction over the angle and a detent of its order differ there alone."""
    found = with_ripple(model(log(0.25, 0.02, order=2.0, ahead=0.88)))
    assert found is not None
    law = found.drive.gear.friction_input
    assert [*law.order, *law.detent_order] == [2.0]


def test_waves_without_a_stretch_are_those_of_the_rest() -> None:
    """A detent of twice the size in the last third: what is fitted without it knows nothing of that."""
    whole = log(0.0, 0.02)
    last = whole.motion.time > 27.0
    more = np.where(last, 0.02 * np.sin(2.0 * whole.motion.angle - 0.4), 0.0)
    found = with_ripple(model(replace(whole, force=whole.force + more)))
    assert found is not None
    before, after = by_full_band(found, [~last, last])
    torque = f"{INPUT}detent_torque[0]"
    assert before[torque][0] == pytest.approx(0.02, rel=0.03)
    assert after[torque][0] == pytest.approx(0.04, rel=0.03)


def test_nearly_one_way_a_detent_and_friction_over_the_angle_are_one_wave() -> None:
    assert is_one_wave(log(0.0, 0.02, ahead=0.88))
    assert not is_one_wave(log(0.0, 0.02))


@pytest.mark.slow("identification")
def test_coulomb_and_viscous_friction_are_right_beside_them() -> None:
    best = fit_motion([log(0.25, 0.02)], DRIVE)[0]
    found = {each.path: each for each in best.fit.estimates}
    truths = {"law.coulomb": COULOMB, "law.viscous": VISCOUS, "amplitude[0]": 0.25, "detent_torque[0]": 0.02}
    for name, truth in truths.items():
        each = found[f"{INPUT}{name}"]
        assert abs(each.value - truth) < 3.0 * each.sigma < 0.1 * truth
