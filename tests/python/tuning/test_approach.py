"""Lost motion against closed forms, and paths that arrive from one side."""

from __future__ import annotations

import math

import numpy as np
import pytest
import strainwave as sw

SPRING, STIFFNESS, BREAKAWAY = 500.0, (1000.0, 600.0, 300.0), (0.5, 0.9, 0.9)
SLIPPING = sw.Gear(
    stiffness=sw.stiffness.Linear(k=SPRING), hysteresis=sw.hysteresis.MaxwellSlip(stiffness=STIFFNESS, breakaway=BREAKAWAY)
)
# The exact inverse of these elements beside the spring: plays with these thresholds [N.m] and weights [rad/(N.m)].
THRESHOLD = np.array([0.0, 1.2, 2.6, 3.8])
WEIGHT = np.array([1.0 / 2400.0, 1.0 / 1400.0 - 1.0 / 2400.0, 1.0 / 800.0 - 1.0 / 1400.0, 1.0 / 500.0 - 1.0 / 800.0])


@pytest.mark.parametrize("swing", [1.0, 2.0, 4.0, 5.0, 8.0])
def test_the_loop_of_slipping_elements_is_that_of_plays(swing: float) -> None:
    """A play of threshold r that is driven by +-S moves by 2 (S - r) in all, and is 2 min(r, S - r) wide at zero."""
    beyond = np.maximum(swing - THRESHOLD, 0.0)
    lost = sw.tuning.lost_motion(SLIPPING, swing=swing)
    assert lost.extent == pytest.approx(WEIGHT @ (2.0 * beyond), rel=1e-9)
    assert lost.width == pytest.approx(WEIGHT @ (2.0 * np.minimum(THRESHOLD, beyond)), rel=1e-9, abs=1e-15)


def test_one_element_that_slips_back_is_twice_its_torque_over_the_spring_wide() -> None:
    """It slips back within the torque 2 F (1 + k / k1), here 5 N.m, which the swing of 6 N.m has."""
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4), hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[4e4], breakaway=[2.0]))
    assert sw.tuning.lost_motion(gear, swing=6.0).width == pytest.approx(2.0 * 2.0 / 1e4, rel=1e-9)
    assert sw.tuning.lost_motion(gear, swing=6.0).extent == pytest.approx(2.0 * (6.0 - 2.0) / 1e4, rel=1e-9)


def test_memory_that_fades_settles_to_its_steady_cycle() -> None:
    """Of amplitude X it has the torque k X + (A / alpha) tanh(alpha X)."""
    fading = sw.hysteresis.FadingMemory(stiffness=[1e3], forgetting=[2e3])
    lost = sw.tuning.lost_motion(sw.Gear(stiffness=sw.stiffness.Linear(k=1e3), hysteresis=fading), swing=0.5)
    assert 1e3 * 0.5 * lost.extent + 0.5 * math.tanh(2e3 * 0.5 * lost.extent) == pytest.approx(0.5, rel=1e-9)


def test_friction_of_the_output_swings_the_torque_about_the_load() -> None:
    gear = SLIPPING.replace(friction_output=sw.friction.Coulomb(coulomb=3.0, breakaway=4.0))
    about = sw.tuning.lost_motion(gear, load_torque=30.0)
    assert about.extent == pytest.approx(sw.tuning.lost_motion(SLIPPING, swing=4.0).extent, rel=1e-9)


def test_the_gear_of_document_t_has_its_printed_width_and_the_extent_of_its_vertices() -> None:
    """The vertices of a closed loop for row 0 lie 59.326382 degrees apart at +-0.36 N.m."""
    lost = sw.tuning.lost_motion(sw.rig.printed_gear(0), swing=36.0)
    assert math.degrees(lost.input_width) == pytest.approx(50.5, abs=1e-6)
    assert math.degrees(lost.input_extent) == pytest.approx(59.326382, abs=1e-6)
    assert lost.overshoot() == pytest.approx(1.2 * lost.extent)


def arrivals(drive: sw.Drive, overshoot: float, acceleration: float, **options: float) -> np.ndarray:
    """Angles of the output at rest at 0.05 rad, from below and from above."""
    path = sw.tuning.positioning_path([0.0, 0.05, 0.1, 0.05], overshoot, speed=0.5, acceleration=acceleration)
    run = sw.simulate(drive, path.command, dt=5e-4, record=["output_angle"], **options)
    return np.interp(path.rests, run.time, run["output_angle"])[[1, 3]]


LOOP = sw.control.PositionSpeed(
    position_gain=40.0, speed_proportional=0.05, speed_integral=1.0, speed_feedforward=1.0, limit=5.0, feedback="input"
)
SOFT = sw.rig.printed_gear(0).replace(damping=20.0, friction_output=sw.friction.Coulomb(coulomb=36.0))
STIFF = sw.load("csg-20-100").replace(
    damping=30.0,
    friction_output=sw.friction.Coulomb(coulomb=5.0),
    friction_input=sw.friction.Coulomb(coulomb=0.03),
)


@pytest.mark.parametrize(("gear", "inertia"), [(SOFT, 0.5), (STIFF, 0.05)], ids=["document T", "catalogue"])
def test_arrivals_from_both_sides_differ_by_the_loop_but_not_on_the_planned_path(gear: sw.Gear, inertia: float) -> None:
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), control=LOOP, load=sw.loads.Inertia(inertia=inertia))
    lost = sw.tuning.lost_motion(gear)
    plain, planned = (np.diff(arrivals(drive, overshoot, 0.5))[0] for overshoot in (0.0, lost.overshoot()))
    assert plain == pytest.approx(lost.extent, rel=0.03)
    assert abs(planned) < 0.01 * min(lost.width, lost.extent)


def test_smooth_braking_without_friction_leaves_the_width_of_the_loop() -> None:
    """The torque falls from inertia times acceleration to nothing so slowly that nothing rings."""
    gear = sw.Gear(
        stiffness=sw.stiffness.Linear(k=2e3),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[8e3], breakaway=[0.5]),
        damping=40.0,
    )
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), control=LOOP, load=sw.loads.Inertia(inertia=1.0))
    lost = sw.tuning.lost_motion(gear, swing=2.0)
    assert lost.width == pytest.approx(2.0 * 0.5 / 2e3)
    path = sw.tuning.positioning_path([0.0, 20.0, 40.0, 20.0], 0.0, speed=50.0, acceleration=2.0)
    run = sw.simulate(drive, path.command, dt=5e-4, record=["output_angle"])
    rest = np.interp(path.rests, run.time, run["output_angle"])
    assert rest[3] - rest[1] == pytest.approx(-lost.width, rel=0.05)


@pytest.mark.parametrize("from_above", [False, True])
def test_a_path_keeps_its_limits_and_arrives_from_its_side(from_above: bool) -> None:
    targets = np.array([0.3, 0.31, 0.1, -0.2, 0.4, 0.39])
    path = sw.tuning.positioning_path(targets, 0.02, speed=0.8, acceleration=4.0, from_above=from_above, rest=0.1)
    time = np.linspace(0.0, path.command.duration, 200_001)
    value, rate = path.command.value(time), path.command.rate(time)
    assert np.abs(rate).max() <= 0.8 * (1.0 + 1e-9)
    pieces = path.command.slope
    assert np.abs(np.diff(pieces)).max() <= 4.0 * 1e-3 * (1.0 + 1e-6)
    assert path.command.value(path.rests) == pytest.approx(targets)
    way = -1.0 if from_above else 1.0
    for target, rest in zip(targets, path.rests, strict=True):
        before = value[time < rest - 0.1]
        turned = np.flatnonzero(way * np.diff(before) < 0.0)
        last = before[turned[-1] + 1 if turned.size else 0 :]
        assert way * (target - last[0]) >= 0.02 - 1e-9


def test_a_path_without_overshoot_goes_straight() -> None:
    path = sw.tuning.positioning_path([0.1, -0.1], 0.0, speed=1.0, acceleration=10.0)
    low = path.command.value(np.linspace(0.0, path.command.duration, 1001)).min()
    assert low == pytest.approx(-0.1)


def test_speed_and_acceleration_reach_their_limits() -> None:
    """A long motion reaches the speed, a short one the acceleration: 15 D / 8 v and sqrt(10 D / sqrt(3) a)."""
    for travel, duration in ((10.0, 15.0 * 10.0 / 8.0), (1e-3, math.sqrt(10.0 * 1e-3 / math.sqrt(3.0) / 5.0))):
        path = sw.tuning.positioning_path([travel], 0.0, speed=1.0, acceleration=5.0, rest=0.25, sample=1e-4)
        assert path.command.duration == pytest.approx(duration + 0.25)


def test_what_is_no_loop_or_no_path_is_refused() -> None:
    with pytest.raises(
        ValueError, match="its torque does not change when the output turns back; state the friction of the load"
    ):
        sw.tuning.lost_motion(SLIPPING)
    with pytest.raises(TypeError, match="gear"):
        sw.tuning.lost_motion("csg-20-100")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"factor = 0\.9"):
        sw.tuning.lost_motion(SLIPPING, swing=3.0).overshoot(0.9)
    with pytest.raises(ValueError, match="targets must be"):
        sw.tuning.positioning_path([], 0.0, speed=1.0, acceleration=1.0)
    with pytest.raises(ValueError, match="targets must be"):
        sw.tuning.positioning_path([0.1, np.nan], 0.0, speed=1.0, acceleration=1.0)
    with pytest.raises(ValueError, match=r"speed = 0\.0 rad/s"):
        sw.tuning.positioning_path([0.1], 0.0, speed=0.0, acceleration=1.0)
