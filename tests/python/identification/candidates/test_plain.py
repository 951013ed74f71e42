"""Place at which the torque of a log was measured, by the sizes of inertia and friction; friction at one speed."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from strainwave.files.gear_set import GearSet
from strainwave.identification.candidates.plain import NO_ROTOR, fit_plain, gravity_sigma, one_speed, torque_place
from strainwave.identification.experiments.motion_log import MotionLog, needed_torque
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence.drawn import friction_log

RATIO, LEVEL = 100.0, 0.02
TIME = np.arange(0.0, 15.0, 0.01)
SETS = ("csg-14-100", "csg-17-100", "csg-20-100", "csg-25-100", "csg-32-100")


def drive(start: str = "csg-20-100", motor: float = 1e-5) -> sw.Drive:
    motor_there = sw.motor.CurrentSource(torque_constant=0.1, inertia=motor)
    return sw.Drive(gear=GearSet.read(start).gear, motor=motor_there, load=sw.loads.Inertia(inertia=1.0))


def record(effort: str, inertia: float, friction: float = LEVEL, noise: float = 1e-3) -> sw.Recording:
    """Return a log of a joint that has an inertia and Coulomb friction at the input [kg.m2, N.m]."""
    angle = 0.8 * np.sin(1.3 * TIME) + 0.2 * np.sin(3.1 * TIME)
    speed = 1.04 * np.cos(1.3 * TIME) + 0.62 * np.cos(3.1 * TIME)
    rise = -1.352 * np.sin(1.3 * TIME) - 1.922 * np.sin(3.1 * TIME)
    torque = inertia * RATIO * rise + friction * np.tanh(speed / 0.01)
    torque += noise * np.random.default_rng(0).standard_normal(len(TIME))
    scale = RATIO if effort == "joint_torque" else -1.0  # the input turns against the output
    return sw.Recording(
        {"time": TIME, "output_angle": angle, effort: scale * torque}, {"time": "s", "output_angle": "rad", effort: "N.m"}
    )


@settings(max_examples=20, deadline=None)
@given(size=st.sampled_from(SETS), total=st.floats(1e-6, 1e-3), effort=st.sampled_from(["input_torque", "joint_torque"]))
def test_no_inertia_of_a_start_set_is_more_than_all_that_turns(size: str, total: float, effort: str) -> None:
    log = MotionLog.of(record(effort, total), drive(size))
    place = torque_place(log, drive(size))
    rotor = place.drive.motor.inertia + place.drive.gear.input_inertia
    assert rotor <= 1.05 * total + 2.0 * NO_ROTOR
    before = drive(size).motor.inertia + drive(size).gear.input_inertia
    assert (place.remark == "") == (rotor == pytest.approx(before))


@pytest.mark.parametrize("size", SETS)
def test_beside_a_given_motor_the_wave_generator_is_a_guess_of_the_set(size: str) -> None:
    place = torque_place(MotionLog.of(record("input_torque", 1.4e-5), drive(size)), drive(size), motor_given=True)
    assert place.drive.motor.inertia == 1e-5
    too_large = drive(size).gear.input_inertia > 4e-6
    assert bool(place.remark) == too_large
    assert place.drive.gear.input_inertia < 4e-6
    assert (place.open_inertia > 0.0) == too_large


def test_a_torque_without_friction_was_measured_behind_the_gear() -> None:
    place = torque_place(MotionLog.of(record("joint_torque", 1e-4, friction=0.0, noise=1e-6), drive()), drive())
    assert not place.has_friction
    assert place.drive.gear.input_inertia == 0.0
    assert "no friction of the gear" in place.remark


def test_a_torque_behind_the_motor_contains_the_wave_generator_alone() -> None:
    heavy = drive(motor=1e-4)
    place = torque_place(MotionLog.of(record("input_torque", 5e-5), heavy), heavy)
    assert place.drive.gear.input_inertia == heavy.gear.input_inertia
    assert place.drive.motor.inertia == NO_ROTOR
    assert place.open_inertia == pytest.approx(1e-4)


@pytest.mark.slow("identification")
def test_the_error_does_not_depend_on_the_start_set() -> None:
    errors = [sw.identify(start, {"log": record("joint_torque", 6e-6)}).files[0].held_out for start in SETS]
    assert max(each.error for each in errors if each) == pytest.approx(min(each.error for each in errors if each), rel=0.02)


def test_one_speed_determines_the_sum_of_coulomb_and_viscous_friction() -> None:
    way = np.where(np.mod(TIME, 6.0) < 3.0, 1.0, -1.0)
    torque = (0.06 + 4e-4 * 10.0) * way + 1e-3 * np.random.default_rng(1).standard_normal(len(TIME))
    angle = 0.1 * np.cumsum(way) * 0.01
    measured = sw.Recording(
        {"time": TIME, "output_angle": angle, "current": torque / 0.1}, {"time": "s", "output_angle": "rad", "current": "A"}
    )
    assert one_speed(MotionLog.of(measured, drive())) == pytest.approx(10.0, rel=0.02)
    assert one_speed(MotionLog.of(record("input_torque", 1e-4), drive())) == 0.0
    found = sw.identify("csg-20-100", {"log": measured}, mapping=FileMapping(constants={"torque_constant": 0.1}))
    estimates = {each.path: each for each in found.files[0].estimates}
    assert estimates["steady_friction"].value == pytest.approx(0.064, abs=3.0 * estimates["steady_friction"].sigma)
    assert estimates["steady_friction"].state == "identified"
    for name, truth in (("coulomb", 0.06), ("viscous", 4e-4)):
        own = estimates[f"gear.friction_input.{name}"]
        assert own.state == "identified in combination"
        assert own.value == pytest.approx(truth, abs=2.0 * own.sigma)


def test_gravity_of_a_one_way_run_is_as_uncertain_as_slow_drift_makes_it() -> None:
    time, random = np.arange(0.0, 20.0, 0.01), np.random.default_rng(2)
    angle = 0.12 * time + 0.01 * np.sin(2.0 * time)  # 240 rad of the input
    torque = 0.05 + 1e-3 * (time / 20.0) + 2e-4 * random.standard_normal(len(time))  # warms up; no gravity
    measured = sw.Recording(
        {"time": time, "output_angle": angle, "input_torque": torque},
        {"time": "s", "output_angle": "rad", "input_torque": "N.m"},
    )
    found = sw.identify("csg-20-100", {"log": measured})
    known = {each.path for each in found.files[0].estimates if not each.why}
    assert "load.gravity_torque" not in known
    log = MotionLog.of(record("input_torque", 1e-4), drive())
    assert gravity_sigma(log, drive()) < 0.1  # N.m: to and fro over a part of a turn determines it


def test_gravity_is_as_uncertain_as_a_drift_that_resembles_it() -> None:
    """A torque without gravity that drifts over a motion one way: fits find gravity, and it must be no more than chance."""
    time = np.arange(0.0, 20.0, 0.005)
    angle, speed = 0.06 * time + 0.01 * np.sin(2.0 * time), 0.06 + 0.02 * np.cos(2.0 * time)
    torque = 0.05 + 0.04 * speed + 0.002 * np.sqrt(time / 20.0) + 1e-3 * np.random.default_rng(2).standard_normal(len(time))
    columns = {"time": time, "output_angle": angle, "input_torque": -torque}
    log = MotionLog.of(sw.Recording(columns, {"time": "s", "output_angle": "rad", "input_torque": "N.m"}), drive())
    assert fit_plain(log, drive()).gravity > 0.1
    assert fit_plain(log, drive()).gravity < 2.0 * gravity_sigma(log, drive())


GRAVITY = 30.0  # N.m at the output


def wound_up(*channels: str, sense: float = -1.0) -> MotionLog:
    """Return a slow log of a load that hangs on a spring of 10 000 N.m/rad: it turns less than a rigid gear would turn it."""
    output = 0.9 * np.sin(1.3 * TIME) + 0.4 * np.sin(0.7 * TIME)
    load = GRAVITY * np.sin(output) - 1.2 * (1.521 * np.sin(1.3 * TIME) + 0.196 * np.sin(0.7 * TIME))
    angle = -RATIO * (output + load / 1e4)
    torque = -load / RATIO + 3e-4 * np.gradient(angle, TIME)
    columns = {"input_angle": angle, "output_angle": sense * -output, "input_torque": torque}
    units = {"time": "s", "input_angle": "rad", "output_angle": "rad", "input_torque": "N.m"}
    kept = {name: columns[name] for name in (*channels, "input_torque")}
    return MotionLog.of(sw.Recording({"time": TIME, **kept}, {name: units[name] for name in ("time", *kept)}), drive())


@pytest.mark.parametrize("sense", [-1.0, 1.0])
def test_a_load_hangs_at_the_measured_angle_of_the_output(sense: float) -> None:
    both = wound_up("input_angle", "output_angle", sense=sense)
    assert fit_plain(both, drive()).gravity == pytest.approx(GRAVITY, rel=2e-4)
    assert gravity_sigma(both, drive()) < 1e-3 * GRAVITY


def test_gravity_by_the_input_alone_is_as_uncertain_as_the_wind_up_makes_it() -> None:
    by_input, by_output = wound_up("input_angle"), wound_up("output_angle")
    off = fit_plain(by_input, drive()).gravity - GRAVITY
    assert abs(off) > 1e-3 * GRAVITY  # a rigid gear is wrong by that
    assert abs(off) < 2.0 * gravity_sigma(by_input, drive())
    assert fit_plain(by_output, drive()).gravity == pytest.approx(GRAVITY, rel=2e-4)
    assert gravity_sigma(by_output, drive()) < 0.5 * gravity_sigma(by_input, drive())


def test_derivatives_by_gravity_contain_the_wind_up() -> None:
    log, paths = wound_up("input_angle", "output_angle"), ("load.gravity_torque", "load.gravity_phase", "load.inertia")
    load = sw.loads.Pendulum(inertia=1.2, gravity_torque=GRAVITY, gravity_phase=0.3)
    there = drive().replace(load=load)
    _, slopes = needed_torque(there, log.motion, log.extra, paths)
    for path, slope in zip(paths, slopes, strict=True):
        step = 1e-4 * abs(getattr(load, path.removeprefix("load.")))
        ends = [
            needed_torque(there.replace({path: getattr(load, path.removeprefix("load.")) + way * step}), log.motion, log.extra)[
                0
            ]
            for way in (-1.0, 1.0)
        ]
        np.testing.assert_allclose(slope, (ends[1] - ends[0]) / (2.0 * step), atol=1e-7)


@pytest.mark.slow("identification")
@pytest.mark.parametrize("seed", range(6))
def test_a_clean_log_of_any_law_of_friction_fails_no_check(seed: int) -> None:
    assert friction_log.outcome(seed).verdict == "right"
