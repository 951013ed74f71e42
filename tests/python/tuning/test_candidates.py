"""Candidates: what learns at the phase of its loop, and a table of lost motion in place of a model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import strainwave as sw
from strainwave.tuning import goals
from strainwave.tuning.candidates import candidates, learnable, lost_motion_map
from strainwave.tuning.cascade import Plant, Setting
from strainwave.tuning.drawn import drawn_gears
from strainwave.tuning.loops import Loops, sampled_cascade

PLANT = Plant.of(sw.GearSet.read("robot-joint"), 1e-3, 0.0)
SETTING = Setting(0.5, "input", 0.0)


def test_the_lag_of_an_order_is_the_phase_of_its_loop_over_its_frequency() -> None:
    frequency = np.array([60.0])
    learnt, lag = learnable(PLANT, SETTING, [2.0], frequency, {})
    follows = Loops.of(PLANT, sampled_cascade(PLANT, SETTING)).following(frequency)
    assert learnt == [2.0]
    assert np.angle(follows * np.exp(1j * frequency * lag)) == pytest.approx(0.0, abs=1e-9)


def test_an_order_is_not_learnt_if_a_drawn_loop_follows_it_by_more_than_90_degrees_from_the_lag() -> None:
    """A load so heavy that the vibration falls below the wave turns the phase by half a turn."""
    frequency = np.array([10.0, 60.0])
    heavy = {"load.inertia": np.array([PLANT.drive.load.inertia, 400.0 * PLANT.drive.load.inertia])}
    assert learnable(PLANT, SETTING, [1.0, 6.0], frequency, {})[0] == [1.0, 6.0]
    assert learnable(PLANT, SETTING, [1.0, 6.0], frequency, heavy)[0] == []
    usual = drawn_gears(sw.GearSet.read("robot-joint"), 5)
    assert learnable(PLANT, SETTING, [1.0, 6.0], frequency, usual)[0] == [1.0, 6.0]


def test_a_map_of_lost_motion_has_the_width_of_the_loop_of_a_gear() -> None:
    """Play with a spring: lead and lag differ by the lost motion of the gear under the friction of its output."""
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=100.0),
        stiffness=sw.stiffness.Linear(k=1e4),
        friction_output=sw.friction.Coulomb(coulomb=5.0),
    )
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=1e-3))
    plant = Plant.of(sw.GearSet.of(drive, name="joint", source="stated"), 1e-3, 0.0)
    found = lost_motion_map(plant, goals.position(0.2, 0.2, "N.m"))
    extent = sw.tuning.lost_motion(gear).extent
    assert extent == pytest.approx(2.0 * 5.0 / 1e4)
    assert np.array(found.forward) - np.array(found.backward) == pytest.approx(extent, rel=0.02)


def test_table_and_waves_are_alternatives_and_a_map_is_for_motions_that_turn_back() -> None:
    settings = [SETTING, replace(SETTING, feedback="output")]
    there = {each.name for each in candidates(PLANT, settings, goals.position(0.05, 0.2, "A"), {})}
    assert {"map of lost motion", "no model, order 2 learnt", "no model, a turn of the input learnt"} <= there
    ahead = {each.name for each in candidates(PLANT, settings, goals.speed(0.2, 2.0, "A"), {})}
    assert "map of lost motion" not in ahead
    assert "no model, order 2 learnt" in ahead
