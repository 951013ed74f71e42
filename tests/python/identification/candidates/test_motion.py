"""Logs of moving drives: what the torque along a measured motion determines, against equations written down here."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from strainwave.files.gear_set import GearSet
from strainwave.identification.candidates.motion import bands, fit_motion
from strainwave.identification.candidates.motion_candidate import beats_by_chance, refit
from strainwave.identification.candidates.motion_model import LOSSES
from strainwave.identification.candidates.plain import MAX_DELAY_SAMPLES, fit_plain
from strainwave.identification.experiments.motion_log import MotionLog, spoilt

RATE, RATIO = 250.0, -80.0
TIME = np.arange(0.0, 20.0, 1.0 / RATE)
MOTOR = 1e-4  # kg.m2, known
ANGLE = 0.9 * np.sin(0.7 * TIME) + 0.25 * np.sin(2.9 * TIME + 0.6) + 0.05 * np.sin(11.9 * TIME)  # rad, of the output
SPEED = 0.63 * np.cos(0.7 * TIME) + 0.725 * np.cos(2.9 * TIME + 0.6) + 0.595 * np.cos(11.9 * TIME)
RISE = -0.441 * np.sin(0.7 * TIME) - 2.1025 * np.sin(2.9 * TIME + 0.6) - 7.0805 * np.sin(11.9 * TIME)


def drive() -> sw.Drive:
    gear = GearSet.read("hfuc-20-80").gear.replace(input_inertia=0.0)
    motor = sw.motor.CurrentSource(torque_constant=0.08, inertia=MOTOR)
    return sw.Drive(gear=gear, motor=motor, load=sw.loads.Inertia(inertia=0.1))


def torque(truth: dict[str, float]) -> NDArray[np.float64]:
    """Of the motor [N.m], by hand."""
    load = truth["inertia"] * RISE + truth["gravity"] * np.sin(ANGLE + truth["phase"])
    motor = MOTOR * RATIO * RISE + load / RATIO + truth["viscous"] * RATIO * SPEED
    dry = truth["coulomb"] + truth["loss"] * np.abs(load / RATIO)
    dry += truth.get("asymmetry", 0.0) * truth["coulomb"] * np.sign(RATIO * SPEED)
    return np.asarray(motor + dry * np.sign(RATIO * SPEED))


def record(truth: dict[str, float], noise: float = 0.0, seed: int = 0, **shifted: Any) -> sw.Recording:
    random = np.random.default_rng(seed)
    current = torque(truth) / 0.08
    late = np.interp(TIME - shifted.get("delay", 0.0), TIME, current) + shifted.get("zero", 0.0)
    columns = {
        "time": TIME,
        "input_angle": RATIO * ANGLE + 1e-4 * random.standard_normal(len(TIME)),
        "current": late + noise * random.standard_normal(len(TIME)),
    }
    return sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})


TRUTH = {"inertia": 0.8, "gravity": 10.0, "phase": 0.4, "coulomb": 0.05, "viscous": 3e-4, "loss": 0.0}
NAMES = {
    "inertia": "load.inertia", "gravity": "load.gravity_torque", "phase": "load.gravity_phase",
    "coulomb": "gear.friction_input.coulomb", "viscous": "gear.friction_input.viscous", "loss": LOSSES[0],
}  # fmt: skip
numbers = st.floats(0.5, 2.0)


@settings(max_examples=5, deadline=None)
@given(inertia=numbers, gravity=numbers, phase=st.floats(-3.0, 3.0), coulomb=numbers, viscous=numbers)
def test_regression_finds_what_a_motor_without_noise_gave(**scale: float) -> None:
    truth = {name: TRUTH[name] * factor for name, factor in scale.items()} | {"phase": scale["phase"], "loss": 0.0}
    found = fit_plain(MotionLog.of(record(truth), drive()), drive())
    assert found.inertia == pytest.approx(MOTOR + truth["inertia"] / RATIO**2, rel=2e-3)
    assert found.coulomb == pytest.approx(truth["coulomb"], rel=2e-2)  # which turns over smoothly
    assert found.viscous == pytest.approx(truth["viscous"], rel=0.1, abs=5e-5)
    assert found.gravity == pytest.approx(truth["gravity"], rel=5e-3)
    assert np.exp(1j * found.phase) == pytest.approx(np.exp(1j * truth["phase"]), abs=5e-3)
    assert found.explained > 0.995
    assert found.sense > 0.99


def test_a_torque_counted_the_other_way_makes_inertia_and_friction_negative() -> None:
    reversed_record = record(TRUTH)
    turned = reversed_record.with_column("current", -reversed_record["current"], "A")
    assert fit_plain(MotionLog.of(turned, drive()), drive()).sense < -0.99


def test_slopes_agree_with_differences() -> None:
    model = drive().replace(load=sw.loads.Pendulum(inertia=0.7, gravity_torque=9.0, gravity_phase=0.2))
    lossy = sw.friction.LoadDependent(driving_forward=0.02, driving_reverse=0.02, backdriving_forward=0.02)
    seal = sw.friction.Coulomb(coulomb=1.0, breakaway=1.0, viscous=0.5)
    law = sw.friction.Stribeck(coulomb=0.05, breakaway=0.07, stribeck_speed=3.0, viscous=3e-4)
    model = model.replace(gear=model.gear.replace(friction_input=law, friction_mesh=lossy, friction_output=seal))
    base = record(TRUTH)
    log = MotionLog.of(base.with_column("arm", np.sin(TIME), "N.m"), model, regressors=("arm",)).with_delay()
    from strainwave import _core

    described = _core.parameters(model)
    paths = (
        "gear.friction_input.coulomb",
        "gear.friction_input.stribeck_speed",
        "gear.friction_mesh.driving_forward",
        "gear.friction_output.coulomb",
        "load.inertia",
        "load.gravity_torque",
        "load.gravity_phase",
        "motor.inertia",
        "motor.torque_constant",
    )
    places = [[each[0] for each in described].index(path) for path in paths]
    nuisances = np.array([0.1, 2e-3, 0.3])
    _, slopes = log.predict(model, places, nuisances)

    def predicted(values: list[float], given: NDArray[np.float64]) -> NDArray[np.float64]:
        return log.predict(_core.with_numbers(model, values), [], given)[0]

    values = [each[1] for each in described]
    for slope, place in zip(slopes, places, strict=False):
        step = 1e-4 * values[place]
        ends = [[*values[:place], values[place] + way * step, *values[place + 1 :]] for way in (1.0, -1.0)]
        apart = (predicted(ends[0], nuisances) - predicted(ends[1], nuisances)) / (2.0 * step)
        assert np.sqrt(np.mean((slope - apart) ** 2)) < 1e-3 * np.sqrt(np.mean(apart**2))  # steps meet kinks in other places
    for i, step in enumerate((1e-3, 1e-6, 1e-3)):
        moved = np.eye(3)[i] * step
        apart = (predicted(values, nuisances + moved) - predicted(values, nuisances - moved)) / (2.0 * step)
        slope = slopes[len(places) + i]
        assert np.sqrt(np.mean((slope - apart) ** 2)) < 1e-3 * np.sqrt(np.mean(apart**2))


@pytest.mark.slow("identification")
def test_intervals_hold_the_truth_and_the_loss_is_found() -> None:
    truth, distances = TRUTH | {"loss": 0.05}, []
    for seed in range(4):
        best = fit_motion([MotionLog.of(record(truth, 0.05, seed), drive())], drive())[0]
        assert "a loss under load" in best.name
        values = {each.path: each for each in best.fit.estimates}
        distances += [(values[path].value - truth[name]) / values[path].sigma for name, path in NAMES.items()]
    assert np.mean(np.abs(distances) < 2.0) >= 0.8
    assert 0.5 < np.sqrt(np.mean(np.square(distances))) < 1.6


@pytest.mark.slow("identification")
def test_a_delay_is_found_and_does_not_bias_friction() -> None:
    best = fit_motion([MotionLog.of(record(TRUTH, 0.05, 1, delay=6e-3, zero=0.2), drive())], drive())[0]
    values = {each.path: each for each in best.fit.estimates}
    assert values["delay"].value == pytest.approx(6e-3, abs=3.0 * values["delay"].sigma)
    assert values["current_zero"].value == pytest.approx(0.2, abs=3.0 * values["current_zero"].sigma)
    for name in ("coulomb", "viscous", "inertia"):
        assert abs(values[NAMES[name]].value - TRUTH[name]) < 4.0 * values[NAMES[name]].sigma


@pytest.mark.slow("identification")
def test_no_delay_is_longer_than_five_samples() -> None:
    """An effort that another motion made, as that of a hand, fits best with a delay that no clock makes."""
    log = MotionLog.of(record(TRUTH, 0.05, 1, delay=0.4), drive())
    tried = fit_motion([log], drive())
    delays = [nuisance.start for each in tried for nuisance in each.log.nuisances if nuisance.name == "delay"]
    assert all(abs(delay) < MAX_DELAY_SAMPLES / RATE for delay in delays)


@pytest.mark.slow("identification")
def test_the_error_held_out_is_that_of_all_samples_in_the_full_band() -> None:
    """A wave of 40 Hz lies above the pass band of the fit, and begins in the last third of the motion."""
    usual = record(TRUTH, 0.02, 1)
    wave = np.where(0.7 * TIME[-1] < TIME, np.sin(2.0 * np.pi * 40.0 * TIME), 0.0)
    log = MotionLog.of(usual.with_column("current", usual["current"] + wave, "A"), drive())
    held_out, _ = refit(fit_motion([log], drive())[0])
    assert held_out.error == pytest.approx(np.sqrt(0.5), rel=0.1)
    assert held_out.samples == pytest.approx(0.3 * len(TIME), rel=0.05)
    assert held_out.in_band < 0.2 * held_out.relative


def test_a_slow_clock_that_jitters_does_not_bias_the_inertia() -> None:
    """Of 100 Hz: straight lines between samples, or differences of second order, would move it by 0.2 %."""
    rows = np.cumsum(np.random.default_rng(4).integers(2, 4, 1900))
    whole = record(TRUTH, delay=4e-3)
    slow = sw.Recording({name: whole[name][rows] for name in whole.names}, {name: whole.unit(name) for name in whole.names})
    log = MotionLog.of(slow, drive()).with_delay()
    paths = [NAMES[name] for name in ("inertia", "gravity", "phase", "coulomb", "viscous")]
    start = drive().replace(load=sw.loads.Pendulum(inertia=0.5, gravity_torque=8.0, gravity_phase=0.2))
    values = {each.path: each.value for each in sw.fit(start, log, paths).estimates}
    assert values[NAMES["inertia"]] == pytest.approx(TRUTH["inertia"], rel=3e-4)
    assert values["delay"] == pytest.approx(4e-3, abs=1e-4)


def test_outliers_and_clipped_samples_are_found_and_no_others() -> None:
    random = np.random.default_rng(3)
    clean = np.sin(TIME) + 0.01 * random.standard_normal(len(TIME))
    assert np.mean(spoilt(clean)) < 1e-3
    clipped = np.clip(clean, -0.8, 0.8)
    assert np.mean(spoilt(clipped)[np.abs(clean) > 0.8]) == 1.0
    assert np.mean(spoilt(clipped)[np.abs(clean) < 0.8]) < 1e-3
    outlying = clean.copy()
    hit = random.choice(len(TIME), 100, replace=False)
    outlying[hit] += 3.0 * np.sign(random.standard_normal(100))
    assert np.mean(spoilt(outlying)[hit]) > 0.95
    assert np.mean(np.delete(spoilt(outlying), hit)) < 0.01


def test_noise_and_what_is_smooth_are_no_outliers() -> None:
    random = np.random.default_rng(5)
    for smooth in (np.sin(TIME), np.sin(40.0 * TIME), np.abs(np.sin(3.0 * TIME))):
        assert np.mean(spoilt(smooth)) < 2e-3
        for noise in (1e-4, 1e-2, 0.3):
            assert np.mean(spoilt(smooth + noise * random.standard_normal(len(TIME)))) < 1e-3


def test_ripple_that_grows_with_the_speed_has_no_outliers() -> None:
    """A threshold from the noise of the whole record takes 14 % for outliers."""
    ripple = np.abs(SPEED) * np.cos(240.0 * ANGLE)
    values = 6.0 * np.sign(SPEED) + 25.0 * np.sin(ANGLE) + ripple + 0.1 * np.random.default_rng(2).standard_normal(len(TIME))
    assert np.mean(spoilt(values)) < 0.01


@pytest.mark.slow("identification")
def test_an_inertia_that_a_person_gave_stays_where_a_slow_motion_hardly_shows_it() -> None:
    angle, slow = 0.5 * np.sin(0.3 * TIME), 0.15 * np.cos(0.3 * TIME)
    friction = (0.05 + 3e-4 * np.abs(RATIO * slow)) * np.sign(RATIO * slow)
    noise = np.random.default_rng(4).standard_normal(len(TIME))
    columns = {"time": TIME, "input_angle": RATIO * angle, "current": friction / 0.08 + 0.02 * noise}
    recording = sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})
    log = MotionLog.of(recording, drive())
    best, *_ = fit_motion([log], drive(), priors={"load.inertia": (0.7, 7e-7)})
    assert best.fit.parts[0].model.load.inertia == pytest.approx(0.7, rel=1e-5)


def ringing(truth: dict[str, float], stiffness: float, seed: int) -> sw.Recording:
    """A record of a load on a spring, its motor moved as by a stiff servo: joint and motor by semi-implicit Euler."""
    step, damping = 1e-4, 12.0
    time = np.arange(0.0, 20.0, step)
    wanted = RATIO * (0.9 * np.sin(0.7 * time) + 0.25 * np.sin(2.9 * time + 0.6) - 0.25 * np.sin(0.6))
    angle = speed = turned = turning = 0.0
    rows = []
    for k in range(len(time)):
        spring = stiffness * (angle / RATIO - turned) + damping * (speed / RATIO - turning)
        friction = truth["coulomb"] * np.tanh(speed / 0.05) + truth["viscous"] * speed
        rate = (wanted[min(k + 1, len(time) - 1)] - wanted[k]) / step
        servo = 1.0 * (wanted[k] - angle) + 0.03 * (rate - speed)
        if k % 40 == 0:
            rows.append((time[k], angle, servo))
        speed += step * (servo - friction - spring / RATIO) / MOTOR
        turning += step * (spring - truth["gravity"] * np.sin(turned + truth["phase"])) / truth["inertia"]
        angle, turned = angle + step * speed, turned + step * turning
    clock, motor, torques = np.array(rows).T
    current = torques / 0.08 + 0.05 * np.random.default_rng(seed).standard_normal(len(clock))
    columns = {"time": clock, "input_angle": motor, "current": current}
    return sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})


@pytest.mark.slow("identification")
def test_a_load_that_rings_on_its_spring_moves_no_friction() -> None:
    truth = TRUTH | {"inertia": 1.6}
    stiff = drive().replace(gear=drive().gear.replace(stiffness=sw.stiffness.Linear(k=1.2e4)))
    best = fit_motion(bands(MotionLog.of(ringing(truth, 1.2e4, 1), stiff), stiff), stiff)[0]
    log = best.fit.parts[0].experiment
    assert isinstance(log, MotionLog)
    assert log.motion.cutoff == pytest.approx(np.sqrt(1.2e4 / 1.6) / (2.0 * np.pi), rel=0.05)
    values = {each.path: each.value for each in best.fit.estimates}
    assert values[NAMES["coulomb"]] == pytest.approx(truth["coulomb"], rel=0.01)
    assert values[NAMES["viscous"]] == pytest.approx(truth["viscous"], rel=0.02)
    assert values[NAMES["gravity"]] == pytest.approx(truth["gravity"], rel=0.005)


def test_a_log_that_does_not_tell_the_torque_or_the_motion_is_refused() -> None:
    only = sw.Recording({"time": TIME, "input_angle": RATIO * ANGLE}, {"time": "s", "input_angle": "rad"})
    with pytest.raises(ValueError, match="the log needs an effort, one of current"):
        MotionLog.of(only, drive())
    current = sw.Recording({"time": TIME, "current": torque(TRUTH)}, {"time": "s", "current": "A"})
    with pytest.raises(ValueError, match="needs an angle"):
        MotionLog.of(current, drive())
    with pytest.raises(ValueError, match="never changes"):
        MotionLog.of(current.with_column("input_angle", np.ones_like(TIME), "rad"), drive())
    one_way = MotionLog.of(current.with_column("input_angle", 10.0 * TIME + np.sin(TIME), "rad"), drive())
    assert not one_way.both_ways
    assert not one_way.nuisances  # a zero of the current is not separable from Coulomb friction


@pytest.mark.parametrize(
    ("left", "by_chance"),
    [((0.3, 1.6, 0.2), True), ((0.2, 0.1, 0.2), False), ((0.3, 1.6, 0.4), False)],
)
def test_terms_that_predict_the_last_stretch_alone_hit_it_by_chance(left: tuple[float, ...], by_chance: bool) -> None:
    """Errors of 0.3, 0.2 and 0.3 by the model; axis 5 of a robot was recorded for 10 s, with two terms of other joints."""
    of_plain, of_model = ([error * np.ones(50) for error in errors] for errors in (left, (0.3, 0.2, 0.3)))
    assert beats_by_chance(of_plain, of_model) == by_chance
