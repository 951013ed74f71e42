"""A gear under the steps of a test: against the gear's own law, closed forms of dry friction, and a drive that is simulated."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.rig import Rig, Step, Value
from strainwave.rig.virtual.loading import Loading, load_by_steps

Array = NDArray[np.float64]
RATIO = 100.0
GEAR = sw.Gear(
    kinematics=sw.kinematics.PlainRatio(reduction=RATIO),
    stiffness=sw.stiffness.Linear(k=4e3),
    hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[6e3, 3e3], breakaway=[2.0, 6.0]),
)
SPRING = GEAR.replace(hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[], breakaway=[]))  # 0.4 N.m/rad at the input
BENCH = Rig("bench", "input", disk_radius=Value(0.1), gravity=Value(10.0))  # 1 kg is 1 N.m
CYCLE = np.concatenate((np.linspace(0.36, -0.36, 19), np.linspace(-0.36, 0.36, 19)[1:]))


def steps(torques: Any) -> list[Step]:
    return [Step(n, max(each, 0.0), max(-each, 0.0)) for n, each in enumerate(torques, 1)]


def loaded(gear: sw.Gear, torques: Any, rig: Rig = BENCH, **given: Any) -> Loading:
    return load_by_steps(gear, rig, steps(torques), **given)


def plays(torques: Any, held: Any, start: float = 0.0) -> Array:
    """What follows torques, each with what friction holds then: the definition of dry friction in series."""
    followed, at = [], start
    for torque, width in zip(torques, np.broadcast_to(held, len(torques)), strict=True):
        at = min(max(at, torque - width), torque + width)
        followed.append(at)
    return np.array(followed)


@pytest.mark.parametrize(
    "parts",
    [
        {},
        {"stiffness": sw.stiffness.Cubic(a1=5e3, a3=1e6)},
        {"stiffness": sw.stiffness.ThreeSegment(k1=3e3, k2=6e3, k3=9e3, t1=9.0, t2=20.0)},
        {"hysteresis": sw.hysteresis.BoucWen(stiffness=5e3, saturation=4.0, sharpness=1.5)},
        {"hysteresis": sw.hysteresis.Regimes(
            positive_unloading=4.51e4, negative_loading=3.1e3, negative_unloading=4.85e4, positive_loading=3e3,
            onset=3.0, lost_motion=8.8e-3)},
        {"kinematics": sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202)},
    ],
)  # fmt: skip
def test_without_friction_the_twist_is_the_gears(parts: dict[str, Any]) -> None:
    gear = GEAR.replace(**parts)
    ratio = gear.kinematics.ratio
    expected = gear.twist(ratio * np.append(CYCLE, CYCLE))[len(CYCLE) :]
    found = loaded(gear, CYCLE)
    assert found.twist == pytest.approx(expected, rel=1e-9, abs=1e-13)
    assert found.angle == pytest.approx(ratio * (expected - expected[0]), rel=1e-9, abs=1e-11)
    assert found.applied == pytest.approx(CYCLE)
    assert found.shaft == pytest.approx(CYCLE)
    assert found.elastic == pytest.approx(CYCLE)


def test_at_the_output_the_angle_is_the_twist() -> None:
    gear = GEAR.replace(friction_output=sw.friction.Coulomb(coulomb=0.5), friction_input=sw.friction.Coulomb(coulomb=9.0))
    rig = replace(BENCH, side="output", disk_radius=Value(1.0), gravity=Value(100.0))
    found = loaded(gear, CYCLE, rig)
    applied = 100.0 * np.append(CYCLE, CYCLE)
    expected = gear.twist(plays(applied, 0.5))[len(CYCLE) :]
    assert found.twist == pytest.approx(expected, rel=1e-9)
    assert found.angle == pytest.approx(expected - expected[0], rel=1e-9, abs=1e-15)


def test_a_virgin_gear_begins_without_history() -> None:
    torques = [0.1, 0.36, 0.1]
    found = loaded(GEAR, torques, virgin=True)
    assert found.twist == pytest.approx(GEAR.twist(RATIO * np.array(torques)), rel=1e-9)
    assert found.angle[-1] > 0.05  # the first branch is no part of the cycle
    assert loaded(GEAR, torques).angle[-1] == pytest.approx(0.0, abs=1e-9)


# Friction


def test_friction_holds_by_its_breakaway_in_series() -> None:
    friction = sw.friction.Coulomb(coulomb=0.02, breakaway=0.03)
    found = loaded(SPRING.replace(friction_input=friction), [0.0, 0.02, 0.1, 0.3, 0.26, 0.2, -0.1, 0.0], virgin=True)
    assert found.elastic == pytest.approx([0.0, 0.0, 0.07, 0.27, 0.27, 0.23, -0.07, -0.03])
    assert found.angle == pytest.approx(found.elastic / 0.4)
    assert found.shaft == pytest.approx(found.applied)


def test_pulleys_hold_more_under_more_load() -> None:
    """0.01 N.m and 10 % of the load: on the way down nothing moves until the load is 0.3 - 0.04 - 0.034."""
    rig = replace(BENCH, pulley_torque=Value(0.01), pulley_share=Value(0.1))
    torques = [0.0, 0.005, 0.3, 0.25, 0.21, 0.0, -0.2, -0.1, 0.3]
    found = loaded(SPRING, torques, rig, virgin=True)
    assert found.shaft == pytest.approx([0.0, 0.0, 0.26, 0.26, 0.241, 0.01, -0.17, -0.12, 0.26])
    assert found.elastic == pytest.approx(found.shaft)
    assert found.applied == pytest.approx(torques)


def test_friction_of_pulleys_and_gear_is_one_behind_the_other() -> None:
    rig = replace(BENCH, pulley_torque=Value(0.004), pulley_share=Value(0.02))
    found = loaded(GEAR.replace(friction_input=sw.friction.Coulomb(coulomb=0.015)), CYCLE, rig)
    twice = np.append(CYCLE, CYCLE)
    shaft = plays(twice, 0.004 + 0.02 * np.abs(twice))
    elastic = plays(shaft, 0.015)
    assert found.shaft == pytest.approx(shaft[len(CYCLE) :], abs=1e-12)
    assert found.elastic == pytest.approx(elastic[len(CYCLE) :], abs=1e-12)
    assert found.twist == pytest.approx(GEAR.twist(RATIO * elastic)[len(CYCLE) :], abs=1e-13)


def test_friction_that_follows_the_load_holds_a_share_of_the_elastic_torque() -> None:
    """Driving, T = T_el (1 + mu); driven back, T = T_el (1 - mu); between the two the shaft sticks."""
    friction = sw.friction.LoadDependent(
        driving_forward=0.25, driving_reverse=0.25, backdriving_forward=0.2, backdriving_reverse=0.2
    )
    found = loaded(SPRING.replace(friction_input=friction), [0.1, 0.25, 0.2, 0.16, 0.08, -0.25], virgin=True)
    assert found.elastic == pytest.approx([0.08, 0.2, 0.2, 0.2, 0.1, -0.2])


def test_what_the_mesh_takes_weighs_on_the_input_by_the_ratio() -> None:
    gear = SPRING.replace(friction_mesh=sw.friction.Coulomb(coulomb=3.0))
    assert loaded(gear, CYCLE, virgin=True).elastic == pytest.approx(plays(CYCLE, 3.0 / RATIO), abs=1e-12)


def test_bristles_bend_before_they_slip() -> None:
    """Elements of friction in parallel with the spring: what they hold, by their own law, balances the torque."""
    friction = sw.friction.MaxwellSlipFriction(
        stiffness=[5.0, 1.0], share=[0.4, 0.6], coulomb=0.05, stribeck_speed=1.0, attraction=1.0
    )
    found = loaded(SPRING.replace(friction_input=friction), CYCLE, virgin=True)
    angle = found.twist * RATIO
    held = friction.quasistatic(np.append(0.0, angle))[1:]
    assert 0.4 * angle + held == pytest.approx(CYCLE, abs=1e-11)
    assert np.abs(np.abs(held).max() - 0.05) < 1e-12


def simulated(gear: sw.Gear, torques: list[float], seconds: float) -> Array:
    """The input angle of a drive whose motor gives these torques slowly, its output held, where each is reached."""
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-5), load=sw.loads.Prescribed())
    ways = np.abs(np.diff([0.0, *torques]))
    time = np.cumsum(seconds * ways)
    command = sw.scenario.table(np.append(0.0, time), [0.0, *torques])
    run = sw.simulate(drive, command, 2e-4, sample=float(np.gcd.reduce(np.rint(time * 1e3).astype(int))) * 1e-3)
    return np.interp(time, run["time"], run["input_angle"])


@pytest.mark.parametrize("error", [0.0, 1e-3])
def test_a_drive_that_is_loaded_slowly_comes_to_the_same_angles(error: float) -> None:
    """By its equations of motion, with inertia, damping and set-valued friction, through a kinematic error of either size.

    A ramp of 0.1 N.m/s moves the shaft at some 0.3 rad/s, which damping answers by 20/100^2 N.m.s/rad: 2e-3 rad at 0.4 N.m/rad.
    """
    gear = GEAR.replace(
        friction_input=sw.friction.Coulomb(coulomb=0.02),
        kinematic_error=sw.kinematic_error.Fourier(order=[2.0], amplitude=[error], phase=[0.0]),
        damping=20.0,
    )
    torques = [0.3, -0.35, 0.2, 0.1, 0.36]
    found = loaded(gear, [0.0, *torques], virgin=True)
    assert found.angle[1:] == pytest.approx(simulated(gear, torques, 10.0), abs=2e-3)
    assert np.abs(found.angle[1:]).min() > 0.1


# Geometry


@pytest.mark.slow("rig")
@pytest.mark.parametrize(
    "kinematics", [GEAR.kinematics, sw.kinematics.StrainWave(flexspline_teeth=50, circular_spline_teeth=52)]
)
def test_an_error_of_the_kinematics_turns_and_weighs_on_the_input(kinematics: Any) -> None:
    """Work is kept: over a closed cycle the work of the input's torque is what the spring and its elements lose."""
    error = sw.kinematic_error.Fourier(order=[2.0, 1.0], amplitude=[1e-3, 5e-4], phase=[0.4, 2.0])
    gear = GEAR.replace(kinematic_error=error, kinematics=kinematics)
    fine = np.interp(np.linspace(0.0, 36.0, 289), np.arange(37.0), CYCLE)
    twice = np.concatenate(([0.0], fine, fine))
    found = loaded(gear, twice, virgin=True)
    expected = found.angle / kinematics.ratio - (error.error(found.angle) - error.error(0.0))
    assert found.twist == pytest.approx(expected, abs=1e-12)
    assert found.elastic == pytest.approx(twice, abs=1e-11)
    spring = gear.trace(found.twist)
    per_angle = 1.0 / kinematics.ratio - error.slope(found.angle)
    assert found.elastic == pytest.approx(spring * per_angle, abs=1e-11)
    cycle = slice(len(fine) + 1, None)
    work = float(np.trapezoid(found.shaft[cycle], found.angle[cycle]))
    assert work == pytest.approx(float(np.trapezoid(spring[cycle], found.twist[cycle])), rel=1e-3)


def test_a_cord_from_a_fixed_point_pulls_by_the_arm_that_is_left() -> None:
    rig = replace(BENCH, cord="fixed point", cord_tangent=Value(-0.3))
    found = loaded(GEAR, CYCLE, rig)
    assert found.angle[0] == 0.0
    assert found.applied == pytest.approx(CYCLE * np.cos(found.angle + 0.3), abs=1e-12)
    assert found.elastic == pytest.approx(found.applied, abs=1e-9)
    assert np.ptp(found.angle) > 1.0


@pytest.mark.slow("rig")
def test_where_the_arm_grows_faster_than_the_gear_stiffens_the_disk_jumps() -> None:
    """0.05 N.m/rad against m g r cos(a): at +1.4 rad the negative weights have an arm of 0.17 r, which grows as they pull back.

    The disk rests at the first root of the balance on its way, found here on a fine grid.
    """
    rig = replace(BENCH, cord="fixed point")
    soft = SPRING.replace(stiffness=sw.stiffness.Linear(k=500.0))
    torques = [0.0, 0.35, 0.0, -0.05, -0.1, -0.2]
    found = loaded(soft, torques, rig, virgin=True)
    at = 0.0
    for torque, angle in zip(torques, found.angle, strict=True):
        grid = np.linspace(-1.6, 1.6, 3_200_001)
        net = torque * np.cos(grid) - 0.05 * grid
        here = int(np.searchsorted(grid, at))
        way = grid[here:][net[here:] <= 0.0][:1] if net[here] > 0.0 else grid[: here + 1][net[: here + 1] >= 0.0][-1:]
        at = float(way[0])
        assert angle == pytest.approx(at, abs=2e-6)


def test_coupling_and_frame_give_way_by_the_torque_on_the_shaft() -> None:
    rig = replace(BENCH, pulley_torque=Value(0.01))
    gear = GEAR.replace(friction_input=sw.friction.Coulomb(coulomb=0.03))
    stiff, soft = loaded(gear, CYCLE, rig), loaded(gear, CYCLE, replace(rig, compliance=Value(0.2)))
    assert soft.angle - stiff.angle == pytest.approx(0.2 * (stiff.shaft - stiff.shaft[0]), abs=1e-10)
    assert soft.shaft == pytest.approx(stiff.shaft, abs=1e-12)
    assert soft.twist == pytest.approx(stiff.twist, abs=1e-13)


def test_a_photograph_before_it_settled_lacks_the_rest() -> None:
    """A first-order delay: of one step, exp(-t/tau) is lacking after t."""
    found = loaded(SPRING, [0.0, 0.1, 0.1, 0.1, 0.3], virgin=True, wait=3.0, settling=2.0)
    lack = np.exp(-1.5)
    expected = 0.25 * np.array([0.0, 1.0 - lack, 1.0 - lack**2, 1.0 - lack**3])
    assert found.angle == pytest.approx([0.0, 0.25, 0.25, 0.25, 0.75])
    assert found.seen[:4] == pytest.approx(expected)
    assert found.seen[4] == pytest.approx(0.75 - (0.75 - expected[3]) * lack)
    timed = [replace(step, time=time) for step, time in zip(steps([0.0, 0.1]), (0.0, 8.0), strict=True)]
    assert load_by_steps(SPRING, BENCH, timed, settling=2.0, virgin=True).seen[1] == pytest.approx(0.25 * (1.0 - np.exp(-4.0)))


def test_a_torque_measured_otherwise_is_taken_as_it_is() -> None:
    measured = [replace(step, torque=torque) for step, torque in zip(steps([0.0, 0.0]), (0.0, 0.2), strict=True)]
    rig = replace(BENCH, cord="fixed point", pulley_torque=Value(0.05))
    assert load_by_steps(SPRING, rig, measured, virgin=True).angle[1] == pytest.approx(0.5)


# What cannot be


@pytest.mark.parametrize(
    ("gear", "rig", "said"),
    [
        (GEAR, BENCH, r"steps: a test needs one step or more"),
        (GEAR.replace(stiffness_variation=sw.variation.Periodic(order=[2.0], amplitude=[0.05], phase=[0.0])), BENCH,
         r"gear.stiffness_variation = Periodic\(\.\.\.\): the virtual rig loads gears of one spring that does not vary"),
        (SPRING.replace(kinematic_error=sw.kinematic_error.Fourier(order=[2.0], amplitude=[0.02], phase=[0.0])), BENCH,
         r"step 1: the kinematic error is so steep that it turns the twist back; the virtual rig cannot follow it"),
        (SPRING.replace(stiffness=sw.stiffness.Linear(k=1e-9)), BENCH, r"step 1: nothing holds the disk"),
    ],
)  # fmt: skip
def test_what_cannot_be_loaded_is_refused(gear: sw.Gear, rig: Rig, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        loaded(gear, [] if said.startswith("steps") else CYCLE, rig)
