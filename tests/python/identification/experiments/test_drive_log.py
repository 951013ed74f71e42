"""Logs along the motion of their input: of drives whose truth is known, and what is refused."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.identification.experiments.drive_log import DriveLog, DrivenLog
from strainwave.identification.fitting.fit import experiment_of, problem_of
from strainwave.identification.fitting.unknowns import plan

RATIO = 50.0
NOISE = 0.01  # of the range of what is measured, but for the output angle: of that of the transmission error
TRUTH = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=RATIO),
        stiffness=sw.stiffness.Linear(k=8e3),
        damping=15.0,
        kinematic_error=sw.kinematic_error.Fourier(amplitude=[3e-4], order=[2], phase=[0.7]),
        friction_input=sw.friction.LuGre(
            coulomb=0.03, breakaway=0.04, stribeck_speed=3.0, viscous=3e-4, bristle_stiffness=10.0, bristle_damping=8e-4
        ),
        friction_mesh=sw.friction.Viscous(viscous=2.0),
    ),
    motor=sw.motor.DC(resistance=0.5, torque_constant=0.08, back_emf=0.08, inertia=8e-5),
    control=sw.control.PID(proportional=6.0, derivative=0.15),
    load=sw.loads.Inertia(inertia=0.8),
)
FREE = [
    "gear.stiffness.k",
    "gear.damping",
    "gear.kinematic_error.amplitude[0]",
    "gear.kinematic_error.phase[0]",
    "gear.friction_input.coulomb",
    "gear.friction_input.bristle_stiffness",
    "gear.friction_mesh.viscous",
    "load.inertia",
]
CHANNELS = ("output_angle", "current")


@cache
def clean() -> sw.Run:
    command = sw.scenario.chirp(0.01, 0.0, 12.0, 4.0) + sw.scenario.sine(0.1, 0.5, 4.0, phase=-np.pi / 2, offset=0.1)
    return sw.simulate(
        TRUTH, command, 1e-4, sample=1e-3, record=["input_angle", "output_angle", "transmission_error", "torque", "current"]
    )


def measured(seed: int, noise: float = NOISE) -> sw.Recording:
    """The drive with both encoders, each counting from anywhere, and its current."""
    run, random = clean(), np.random.default_rng(seed)
    spread = {"output_angle": np.ptp(run["transmission_error"]), "current": np.ptp(run["current"])}
    columns = {
        name: run[name]
        + noise * spread[name] * random.standard_normal(len(run.time))
        + (1.7 if name == "output_angle" else 0.0)
        for name in CHANNELS
    }
    columns["input_angle"] = run["input_angle"] + noise * 1e-2 * random.standard_normal(len(run.time))
    return sw.Recording(
        {"time": run.time, **columns}, {"time": "s", "output_angle": "rad", "current": "A", "input_angle": "rad"}
    )


def off(factor: float = 1.3) -> sw.Drive:
    gear = TRUTH.gear
    return TRUTH.replace(
        gear=gear.replace(
            stiffness=sw.stiffness.Linear(k=8e3 * factor),
            damping=15.0 / factor,
            friction_input=gear.friction_input.replace(coulomb=0.03 * factor, bristle_stiffness=10.0 * factor),
            friction_mesh=sw.friction.Viscous(viscous=2.0 / factor),
        ),
        load=sw.loads.Inertia(inertia=0.8 * factor),
    )


def true(path: str) -> float:
    return next(each[1] for each in _core.parameters(TRUTH) if each[0] == path)


def test_at_the_truth_what_is_left_is_the_noise() -> None:
    log = DrivenLog.of(measured(0), TRUTH)
    predicted, _ = log.predict(TRUTH, [], np.zeros(2))
    residuals = log.measured - predicted
    residuals -= residuals.mean(axis=1, keepdims=True)
    spread = {"output_angle": np.ptp(clean()["transmission_error"]), "current": np.ptp(clean()["current"])}
    for name, left in zip(log.channels, residuals, strict=True):
        assert left.std() == pytest.approx(NOISE * spread[name], rel=0.1), name


@pytest.mark.parametrize("channels", [("output_angle", "output_speed", "torque"), ("current", "joint_torque", "voltage")])
def test_derivatives_are_those_of_differences(channels: tuple[str, ...]) -> None:
    run = sw.simulate(TRUTH, sw.scenario.sine(0.2, 1.5, 1.0), 1e-4, sample=1e-3)
    columns = {name: run[name] if name in run.names else np.ones(len(run.time)) for name in ("input_angle", *channels)}
    units = {"time": "s", "input_angle": "rad", "output_angle": "rad", "output_speed": "rad/s", "torque": "N.m"}
    units |= {"current": "A", "joint_torque": "N.m", "voltage": "V"}
    recording = sw.Recording({"time": run.time, **columns}, {name: units[name] for name in ("time", "input_angle", *channels)})
    drive = off()
    log = DrivenLog.of(recording, drive)
    described = _core.parameters(drive)
    paths = ["gear.stiffness.k", "gear.friction_input.coulomb", "motor.torque_constant", "motor.resistance", "load.inertia"]
    numbers = [[each[0] for each in described].index(path) for path in paths]
    zeros = np.array([each.start for each in log.nuisances])
    _, slopes = log.predict(drive, numbers, zeros)
    for path, number, slope in zip(paths, numbers, slopes, strict=False):
        value = described[number][1]
        ends = [log.predict(drive.replace({path: value * (1.0 + by)}), [], zeros)[0] for by in (-1e-5, 1e-5)]
        found = (ends[1] - ends[0]) / (2e-5 * value)
        assert slope == pytest.approx(found, abs=1e-4 * max(np.abs(found).max(), 1e-9)), path
    for unknown, nuisance in enumerate(log.nuisances, len(numbers)):
        assert slopes[unknown].sum() == len(log.time), nuisance.name


def test_delays_shift_channels_and_their_derivatives() -> None:
    log = DrivenLog.of(measured(0), TRUTH).with_delays("output_angle")
    assert [each.name for each in log.nuisances] == ["output_angle_zero", "current_zero", "output_angle_delay"]
    number = [each[0] for each in _core.parameters(TRUTH)].index("gear.stiffness.k")
    late = np.array([0.0, 0.0, 3e-3])
    predicted, slopes = log.predict(TRUTH, [number], late)
    now, by_stiffness = DrivenLog.of(measured(0), TRUTH).predict(TRUTH, [number], late[:2])
    inside = slice(10, -10)
    assert predicted[0, inside] == pytest.approx(np.interp(log.time - 3e-3, log.time, now[0])[inside], abs=1e-5)
    assert predicted[1] == pytest.approx(now[1], abs=0.0)
    assert slopes[0, 0, inside] == pytest.approx(
        np.interp(log.time - 3e-3, log.time, by_stiffness[0, 0])[inside], abs=0.05 * np.abs(by_stiffness[0, 0]).max()
    )
    there = [log.predict(TRUTH, [], late + np.array([0.0, 0.0, by]))[0][0] for by in (-1e-5, 1e-5)]
    assert slopes[-1, 0, inside] == pytest.approx(((there[1] - there[0]) / 2e-5)[inside], abs=1e-4)
    with pytest.raises(ValueError, match="delayed channel"):
        log.with_delays("torque")


@pytest.mark.slow("identification")
def test_an_initial_torque_and_speed_that_are_wrong_are_corrected_within_their_limits() -> None:
    """The drive begins at rest without load; damping lets the vibration live for the first samples only."""
    log = DrivenLog.of(measured(0), TRUTH, ["output_angle"], initial={"torque": 2.0, "output_speed": 0.02})
    by_name = {each.path: each for each in sw.fit(TRUTH, log.with_unknown_begin(10.0, 0.1), ["gear.stiffness.k"]).estimates}
    assert [*by_name][-2:] == ["initial_torque", "initial_output_speed"]
    assert by_name["initial_torque"].sigma < 0.5
    assert abs(by_name["initial_torque"].value) < 4.0 * by_name["initial_torque"].sigma
    assert by_name["initial_output_speed"].sigma < 5e-3
    assert abs(by_name["initial_output_speed"].value) < 4.0 * by_name["initial_output_speed"].sigma
    near = log.with_unknown_begin(0.5, 0.01)
    limits = problem_of(plan(TRUTH, [""], ["gear.stiffness.k"]), TRUTH, [near], [None]).limits()
    assert limits[-3:].tolist() == [[-np.inf, np.inf], [1.5, 2.5], [0.01, 0.03]]


def test_the_beginning_of_a_log_is_predicted_as_in_the_whole() -> None:
    log = DrivenLog.of(measured(0).with_column("rigid_torque", clean().time, "N.m"), TRUTH, ["output_angle"])
    beginning = log.beginning(0.7)
    assert log.time[len(beginning.time) - 1] == beginning.time[-1] <= 0.7 < log.time[len(beginning.time)]
    (early, _), (whole, _) = (each.predict(TRUTH, [], np.zeros(1)) for each in (beginning, log))
    assert early == pytest.approx(whole[:, : early.shape[1]], abs=1e-9)
    assert beginning.measured.shape == early.shape


def test_known_torque_of_other_bodies_acts_at_the_output() -> None:
    held = sw.scenario.constant(5.0, duration=1.0)
    run = sw.simulate(TRUTH, sw.scenario.sine(0.2, 1.5, 1.0), 1e-4, load_torque=held, sample=1e-3)
    columns = {name: run[name] for name in ("time", "input_angle", "output_angle")} | {
        "rigid_torque": np.full(len(run.time), 5.0)
    }
    recording = sw.Recording(columns, {"time": "s", "input_angle": "rad", "output_angle": "rad", "rigid_torque": "N.m"})
    log = DrivenLog.of(recording, TRUTH)
    later = log.time > 0.5  # when the vibration of the beginning has decayed
    predicted, _ = log.predict(TRUTH, [], np.zeros(1))
    off = log.gear_torque(TRUTH, np.zeros(len(log.nuisances)))[later] - np.interp(log.time, run.time, run["torque"])[later]
    assert abs(off.mean()) < 0.01  # of 5 N.m; where friction turns over, smoothing rounds the motion for a moment
    assert predicted[0, later] == pytest.approx(log.measured[0, later], abs=2e-5)


@pytest.mark.slow("identification")
def test_the_whole_gear_is_told_by_two_encoders_and_the_current() -> None:
    """Eight numbers from noisy logs, started thirty percent off: right within what the fit says of itself."""
    off_by = np.array([_deviations(seed) for seed in range(3)])
    assert np.abs(off_by).max() < 4.5
    assert np.mean(np.abs(off_by) < 2.0) > 0.8
    assert np.abs(off_by.mean(axis=0)).max() < 2.5  # no number is always off to one side


def _deviations(seed: int) -> list[float]:
    """By how many standard deviations each number is off."""
    found = sw.fit(off(), measured(seed), FREE)
    by_path = {each.path: each for each in found.estimates}
    return [(by_path[path].value - true(path)) / by_path[path].sigma for path in FREE]


def test_a_recording_without_a_command_is_taken_along_the_motion_of_its_input() -> None:
    recording = measured(0)
    assert isinstance(experiment_of(TRUTH, recording), DrivenLog)
    commanded = sw.Recording(
        {**{name: recording[name] for name in recording.names}, "command": np.zeros(len(recording))},
        {**{name: recording.unit(name) for name in recording.names}, "command": "rad"},
    )
    assert isinstance(experiment_of(TRUTH, commanded), DriveLog)


def test_a_log_that_begins_in_motion_is_compared_when_its_beginning_has_faded() -> None:
    recording = measured(0)
    rows = recording.time >= 1.0
    later = sw.Recording(
        {name: recording[name][rows] for name in recording.names}, {name: recording.unit(name) for name in recording.names}
    )
    log = DrivenLog.of(later, TRUTH)
    assert log.time[0] == pytest.approx(0.5, abs=2e-3)
    assert DrivenLog.of(recording, TRUTH).time[0] == 0.0


@pytest.mark.parametrize(
    ("drop", "channels", "message"),
    [
        (("input_angle",), None, 'needs a column "input_angle"'),
        (("output_angle", "current"), None, "nothing to compare: record one of output_angle"),
        ((), ["torque"], 'cannot be compared by "torque"; it can by output_angle'),
    ],
)
def test_what_cannot_be_compared_is_refused(drop: tuple[str, ...], channels: list[str] | None, message: str) -> None:
    recording = measured(0)
    kept = recording.select([name for name in recording.names if name not in drop])
    with pytest.raises(ValueError, match=message):
        DrivenLog.of(kept, TRUTH, channels)
