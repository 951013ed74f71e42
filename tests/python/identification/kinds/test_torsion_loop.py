"""Torsion loops: what the kinematic error of a gear changes of one at the input."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.kinds.torsion_loop import MAX_ERROR_OF_RICHER, _gain_sigma, _of_richer_model

OWN = sw.load("hfuc-20-80")
GEAR = OWN.replace(friction_input=OWN.friction_input.replace(coulomb=0.0, breakaway=0.0))
AMPLITUDE, ORDER = 8e-5, 2.0
TRAVEL = 0.25  # rad of the input


def loop_of(gear: sw.Gear, begin: float) -> sw.Recording:
    """A loop at the input with the output locked, where the input begins at an angle of it [rad]: virtual work, no friction."""
    way = TRAVEL * np.concatenate([np.linspace(0, 1, 20), np.linspace(1, -1, 40)[1:], np.linspace(-1, 1, 40)[1:]])
    error, ratio = gear.kinematic_error, gear.kinematics.ratio
    twist = way / ratio + error.error(begin + way) - error.error(begin)
    torque = (1.0 / ratio + error.slope(begin + way)) * np.asarray(gear.trace(twist))
    return sw.Recording({"input_angle": way, "input_torque": torque}, {"input_angle": "rad", "input_torque": "N.m"})


def gear_with(phase: float) -> sw.Gear:
    return GEAR.replace(kinematic_error=sw.kinematic_error.Fourier(order=[ORDER], amplitude=[AMPLITUDE], phase=[phase]))


def test_a_short_travel_sees_the_slope_of_the_error() -> None:
    """One order at a random place of the turn gives i A B / sqrt 2, times the chord over the travel."""
    gear = gear_with(0.3)
    loop = TorsionLoop.of(loop_of(gear, 0.0), gear)
    chord = np.sin(ORDER * TRAVEL) / (ORDER * TRAVEL)  # of a travel to both sides
    expected = abs(gear.kinematics.ratio) * AMPLITUDE * ORDER * chord / np.sqrt(2.0)
    assert _gain_sigma(loop, gear) == pytest.approx(expected, rel=0.01)


@pytest.mark.slow("identification")
def test_stiffness_of_a_loop_at_the_input_contains_the_error_of_the_gear() -> None:
    """Eight places of the turn, which nothing in the file states. Without the error in it ± would be a twentieth."""
    start = replace(sw.GearSet.read("hfuc-20-80"), gear=gear_with(0.0))
    off = []
    for begin in np.arange(8) * np.pi / 8.0:
        found = sw.identify(start, {"torsion": loop_of(gear_with(0.0), begin)})
        k1 = next(each for each in found.files[0].estimates if each.path == "gear.stiffness.k1")
        off.append((k1.value - GEAR.stiffness.k1) / k1.sigma)
    assert np.max(np.abs(off)) < 2.0
    assert 0.5 < np.sqrt(np.mean(np.square(off))) < 1.5


@pytest.mark.parametrize("breakaway", [[0.5, 1.2], [1.7]])
def test_elements_that_one_element_stands_for_leave_a_shape_and_a_remark(breakaway: list[float]) -> None:
    """The gain of a second element is below a thousandth of the range of the torque, and it is not fitted."""
    half = np.linspace(-2.1e-3, 2.1e-3, 120)
    twist = np.concatenate([half, half[::-1], half, half[::-1]])
    spring = sw.stiffness.Cubic(a1=1.6e4, a3=3e9)
    slips = sw.hysteresis.MaxwellSlip(stiffness=[6e3, 4e3][: len(breakaway)], breakaway=breakaway)
    path = np.concatenate([np.linspace(0.0, half[0], 50), twist])
    torque = (np.asarray(spring.torque(path)) + np.asarray(slips.trace(path)))[50:]
    torque += 0.06 * np.random.default_rng(0).standard_normal(len(torque))
    loop = sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"})
    (file,) = sw.identify("csg-20-100", {"torsion": loop}).files
    assert file.model == "cubic spring with 1 Maxwell element"
    remark = "cubic spring with 2 Maxwell elements predicts better, with an error on held-out data of "
    errors = [each.split(remark)[1].split(". ")[0] for each in file.remarks if remark in each]
    assert len(errors) == len(breakaway) - 1
    for richer, taken in (each.split(" in place of ") for each in errors):
        assert float(richer.removesuffix(" N·m")) < MAX_ERROR_OF_RICHER * float(taken.removesuffix(" N·m"))


@pytest.mark.parametrize("share", [0.75, 0.85])
def test_a_richer_loop_that_gains_little_is_no_remark(share: float) -> None:
    taken: Any
    richer: Any
    taken, richer = (SimpleNamespace(name=name, error=error) for name, error in (("one", 0.1), ("two", 0.1 * share)))
    waves = np.sin(np.linspace(0.0, 12.0, 400))
    assert len(list(_of_richer_model(taken, [richer], waves))) == (share < MAX_ERROR_OF_RICHER)
