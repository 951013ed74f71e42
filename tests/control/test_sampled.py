"""A controller in a computer against the recursion that the computer would run."""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray

from tests.support.geared import RATIO, geared
from tests.support.little_memory import little_memory

Array = NDArray[np.float64]
LAW = sw.control.PID(proportional=2.0, integral=15.0, derivative=0.05, limit=24.0)
PERIOD = 1e-3
COMMAND = sw.scenario.sine(0.3, 4.0, 0.2)
DT = 1.3e-4  # no divisor of the period


def drive(**sampled: float) -> sw.Drive:
    return geared(control=sw.control.Sampled(law=LAW, **({"period": PERIOD} | sampled)))


@pytest.mark.parametrize("delay", [0.0, 3e-4, PERIOD])
@pytest.mark.parametrize("gain", [1.0, 40.0], ids=["free", "limited"])
def test_it_is_the_recursion_of_a_computer(delay: float, gain: float) -> None:
    law = LAW.replace(proportional=gain * LAW.proportional)
    one = geared(control=sw.control.Sampled(law=law, period=PERIOD, delay=delay))
    sample = 1e-4
    run = sw.simulate(one, COMMAND, DT, sample=sample)
    instants = PERIOD * np.arange(200)
    rows = np.rint(instants / sample).astype(int)
    angle = RATIO * run["command"][rows] - run["input_angle"][rows]
    speed = RATIO * COMMAND.rate(instants) - run["input_speed"][rows]
    integral = 0.0
    for k, (error, rate) in enumerate(zip(angle, speed, strict=True)):
        unlimited = law.proportional * error + law.integral * integral + law.derivative * rate
        integral += PERIOD * error * (abs(unlimited) <= law.limit or error * unlimited < 0.0)
        held = np.clip(unlimited, -law.limit, law.limit)
        first = rows[k] + round(delay / sample)
        seen = run["voltage"][first + 1 : first + 11]  # what is recorded at an instant is what was there just before
        assert seen == pytest.approx(held, rel=1e-12, abs=1e-12 * law.limit)


def test_before_its_first_output_it_gives_nothing() -> None:
    run = sw.simulate(drive(delay=5e-4), sw.scenario.constant(0.1, 0.01), 1e-4)
    early = run.time < 5.5e-4
    assert (run["voltage"][early] == 0.0).all()
    assert (run["voltage"][~early] != 0.0).any()


def test_it_acts_within_steps_wherever_they_end() -> None:
    """The same run whatever the steps."""
    one = drive(delay=3e-4)
    runs = [sw.simulate(one, COMMAND, dt, sample=PERIOD) for dt in (5e-5, 1e-5)]
    adaptive = sw.simulate_adaptively(one, COMMAND, 1e-10, sample=PERIOD)
    for run in (*runs, adaptive):
        assert run["output_angle"] == pytest.approx(runs[1]["output_angle"], abs=1e-8)


def test_packs_and_derivatives_take_the_same_steps() -> None:
    one = drive(delay=3e-4)
    alone = sw.simulate(one, COMMAND, DT, sample=PERIOD, method="exponential")
    many = sw.simulate_many(one, COMMAND, {"load.inertia": [one.load.inertia] * 3}, DT, sample=PERIOD)
    assert all(np.array_equal(row, alone["output_angle"]) for row in many["output_angle"])
    found = sw.analysis.derivatives(one, COMMAND, ["control.law.proportional"], DT, sample=PERIOD)
    assert np.array_equal(found.run["output_angle"], alone["output_angle"])
    near = [
        sw.simulate(one.replace({"control.law.proportional": 2.0 + by}), COMMAND, DT, sample=PERIOD)["output_angle"]
        for by in (-1e-4, 1e-4)
    ]
    slope = found["output_angle", "control.law.proportional"]
    assert slope == pytest.approx((near[1] - near[0]) / 2e-4, abs=1e-6 * np.abs(slope).max())


@given(at=st.floats(1e-3, 0.19))
def test_a_run_goes_on_where_another_ended(at: float) -> None:
    one = drive(delay=3e-4)
    level = sw.scenario.constant(0.2, 0.2)
    whole = sw.simulate(one, level, 1e-4)
    first = sw.simulate(one, sw.scenario.constant(0.2, at), 1e-4)
    second = sw.simulate(one, sw.scenario.constant(0.2, 0.2 - at), 1e-4, initial=first.end)
    assert second.end["output_speed"] == pytest.approx(whole.end["output_speed"], abs=1e-7)
    assert second["output_angle"][-1] == pytest.approx(whole["output_angle"][-1], abs=1e-9)


def test_a_step_of_the_drive_acts_within() -> None:
    one = drive(delay=3e-4)
    state = one.rest()
    for _ in range(10):
        state = one.step(state, command=0.1, dt=1.7e-3)
    run = sw.simulate(one, sw.scenario.constant(0.1, 0.017), 1e-5)
    assert state.output_speed == pytest.approx(run["output_speed"][-1], rel=1e-5)
    assert state["control.actuation"] == pytest.approx(run["voltage"][-1], rel=1e-4)


@pytest.mark.parametrize(("jump", "seen"), [(0.01, 0.01), (0.0102, 0.011), (0.0109999, 0.011), (0.0, 0.0)])
def test_a_jump_of_the_command_is_seen_at_the_next_instant(jump: float, seen: float) -> None:
    """One that happens at an instant is seen at it: the command is what it is from there on."""
    one = geared(control=sw.control.Sampled(law=LAW.replace(derivative=0.0), period=PERIOD))
    run = sw.simulate(one, sw.scenario.step(0.1, 0.02, start=jump), 1e-4)
    assert run.time[np.argmax(run["voltage"] != 0.0)] == pytest.approx(seen + 1e-4 * (seen > 0.0), abs=1e-9)


@pytest.mark.slow("physics")
def test_its_instants_do_not_drift() -> None:
    """Ten minutes of 7.3 ms, which no step divides: the next sample is due when a clock says so."""
    slow = drive(period=7.3e-3, delay=2e-3)
    run = sw.simulate(slow, sw.scenario.constant(0.1, 600.0), 1e-3, sample=100.0)
    assert run.end["control.until_sample"] == pytest.approx(-600.0 % 7.3e-3, abs=1e-10)


def test_a_fast_one_is_the_law_itself() -> None:
    errors = []
    for period in (1e-3, 5e-4):
        found = sw.simulate(drive(period=period), COMMAND, 1e-4, sample=PERIOD)
        wanted = sw.simulate(geared(control=LAW), COMMAND, 1e-4, sample=PERIOD)
        errors.append(np.abs(found["output_angle"] - wanted["output_angle"]).max())
    assert errors[0] == pytest.approx(2.0 * errors[1], rel=0.2)  # of first order in the period


def test_a_run_shorter_than_a_period_ends_when_it_should() -> None:
    slow = drive(period=0.5, delay=0.1)
    run = sw.simulate(slow, sw.scenario.constant(0.1, 0.01), initial={"output_angle": 0.1})
    assert run.time[-1] == 0.01
    assert run.end["control.until_sample"] == pytest.approx(0.49)
    assert not run["voltage"].any()


@pytest.mark.parametrize("path", ["control.period", "control.delay"])
def test_time_is_no_number_of_a_run(path: str) -> None:
    with pytest.raises(ValueError, match="must be that of the drive for all members"):
        sw.simulate_many(drive(), COMMAND, {path: [1e-3, 9e-4]})
    with pytest.raises(ValueError, match=f"no derivative by {path}"):
        sw.analysis.derivatives(drive(), COMMAND, [path])


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is limited as Linux does it")
@pytest.mark.parametrize(
    "run",
    [
        lambda long: sw.simulate(drive(), long, dt=1.0),
        lambda long: sw.simulate_adaptively(drive(), long, max_steps=10**9, sample=1e3),
        lambda long: sw.analysis.derivatives(drive(), long, ["load.inertia"], dt=1.0),
        lambda long: sw.simulate_many(drive(), long, {"load.inertia": [0.1]}, dt=1.0),
        lambda long: sw.simulate_controlled(
            drive().replace(control=sw.control.OpenLoop()), lambda _: 0.0, long, dt=1.0, period=1e-3, sample=1e3
        ),
    ],
)
def test_samples_of_a_controller_too_many_for_the_memory_say_how_large_they_are(
    run: Callable[[sw.scenario.Scenario], object],
) -> None:
    words = r"^9e\+06 samples of the controller take 1\.08 GB, .*; take a longer period, or make several runs$"
    with little_memory(64 << 20), pytest.raises(MemoryError, match=words):
        run(sw.scenario.constant(0.1, 9e3))


def test_what_is_wrong_is_refused() -> None:
    with pytest.raises(ValueError, match="delay must not exceed period"):
        sw.control.Sampled(law=LAW, period=1e-3, delay=2e-3)
    with pytest.raises(TypeError, match=r"sampled\.law must be one of OpenLoop, PID"):
        sw.control.Sampled(law=sw.control.Sampled(law=LAW))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"acts 2e\+11 times in 0\.2 s"):
        sw.simulate(drive(period=1e-12), COMMAND)
