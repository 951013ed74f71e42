"""Command signals against their closed forms, and the laws every scenario obeys."""

from __future__ import annotations

import copy
import pickle
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.signal
import strainwave as sw
from hypothesis import assume, given, strategies as st
from numpy.typing import ArrayLike, NDArray
from strainwave.simulation.scenario import (
    Scenario,
    Wave,
    chirp,
    constant,
    pulse_train,
    ramp,
    sine,
    step,
    table,
)

DURATION = 4.0


def rate_before(scenario: Scenario, time: ArrayLike) -> NDArray[np.float64]:
    """Left limit of the rate at `time` [s]."""
    rate: NDArray[np.float64] = scenario.signal.at(np.asarray(time, np.float64), True)[1]
    return rate


amplitude = st.floats(-2.0, 2.0)
frequency = st.floats(0.0, 3.0)
start = st.floats(0.0, DURATION, exclude_max=True)
tables = st.lists(st.tuples(st.floats(0.05, 1.0), amplitude), min_size=2, max_size=6).map(
    lambda points: table(
        np.append(0.0, np.cumsum([gap for gap, _ in points]) / sum(gap for gap, _ in points)) * DURATION,
        [0.0, *(value for _, value in points)],
    )
)
plain = st.one_of(
    st.builds(constant, amplitude, st.just(DURATION)),
    st.builds(step, amplitude, st.just(DURATION), start),
    st.builds(ramp, amplitude, st.just(DURATION), start),
    st.builds(sine, amplitude, frequency, st.just(DURATION), amplitude, amplitude),
    st.builds(chirp, amplitude, frequency, frequency, st.just(DURATION)),
    st.builds(pulse_train, amplitude, st.floats(0.5, 1.0), st.floats(0.1, 0.4), st.just(DURATION), start),
    tables,
)
scenarios = st.one_of(plain, st.builds(lambda a, b, factor: a + factor * b, plain, plain, amplitude))
times = st.floats(0.0, DURATION)


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


def distance_to_breaks(scenario: Scenario, time: float) -> float:
    return float(np.abs(np.concatenate((scenario.breaks, [0.0, scenario.duration])) - time).min())


# Laws of every scenario


@given(scenarios, times)
def test_rate_is_the_derivative_of_the_value(scenario: Scenario, time: float) -> None:
    h = 1e-5  # |third derivative| < 5e4, so that the difference is within 5e4 h^2 / 6 < 1e-6 of the derivative
    assume(distance_to_breaks(scenario, time) > 2 * h)
    difference = (scenario.value(time + h) - scenario.value(time - h)) / (2 * h)
    assert scenario.rate(time) == pytest.approx(difference, rel=1e-8, abs=1e-6)


@given(plain)
def test_breaks_increase_inside_and_something_jumps_at_each(scenario: Scenario) -> None:
    breaks = scenario.breaks
    assert np.all(np.diff(breaks, prepend=0.0, append=DURATION) > 0.0)
    value_jumps = scenario.value(breaks) != scenario.value_before(breaks)
    rate_jumps = scenario.rate(breaks) != rate_before(scenario, breaks)
    assert np.all(value_jumps | rate_jumps)


@given(scenarios)
def test_both_limits_at_a_break_are_approached_from_their_side(scenario: Scenario) -> None:
    breaks = scenario.breaks
    assume(breaks.size > 0)
    h = 1e-9
    assume(np.diff(breaks, prepend=0.0, append=DURATION).min() > 2 * h)
    bound = 1e3 * h  # |rate| < 1e3 for all of these
    np.testing.assert_allclose(scenario.value(breaks), scenario.value(breaks + h), rtol=0, atol=bound)
    np.testing.assert_allclose(scenario.value_before(breaks), scenario.value(breaks - h), rtol=0, atol=bound)
    bound = 3e3 * h  # |second derivative| < 3e3
    np.testing.assert_allclose(scenario.rate(breaks), scenario.rate(breaks + h), rtol=0, atol=bound)
    np.testing.assert_allclose(rate_before(scenario, breaks), scenario.rate(breaks - h), rtol=0, atol=bound)


@given(scenarios, times)
def test_left_limits_differ_at_breaks_only(scenario: Scenario, time: float) -> None:
    assume(time not in scenario.breaks)
    assert scenario.value_before(time) == scenario.value(time)
    assert rate_before(scenario, time) == scenario.rate(time)


@given(plain, plain, amplitude, times)
def test_sums_and_multiples_are_linear(a: Scenario, b: Scenario, factor: float, time: float) -> None:
    combined = a - factor * b
    assert combined.value(time) == pytest.approx(a.value(time) - factor * b.value(time), rel=1e-13, abs=1e-13)
    assert combined.rate(time) == pytest.approx(a.rate(time) - factor * b.rate(time), rel=1e-13, abs=1e-12)
    assert set(combined.breaks) <= set(a.breaks) | set(b.breaks)


@given(scenarios)
def test_scenarios_are_values(scenario: Scenario) -> None:
    assert scenario == 1.0 * scenario
    assert -scenario == scenario * np.float64(-1.0) == np.float64(-1.0) * scenario
    assert scenario != scenario + constant(1.0, DURATION)
    with pytest.raises(ValueError, match="read-only"):
        scenario.start[0] = 1.0


@given(scenarios)
def test_a_copy_is_equal_also_of_a_scenario_that_was_used(scenario: Scenario) -> None:
    scenario.value(0.0)
    for copied in (pickle.loads(pickle.dumps(scenario)), copy.deepcopy(scenario)):
        assert copied == scenario
        assert not copied.start.flags.writeable


@given(scenarios, st.integers(1, 3))
def test_an_array_of_times_gives_what_each_time_gives(scenario: Scenario, columns: int) -> None:
    time = np.linspace(0.0, DURATION, 6 * columns).reshape(6, columns)
    for method in (scenario.value, scenario.rate, scenario.value_before):
        assert method(time).shape == (6, columns)
        np.testing.assert_allclose(method(time), [[method(t) for t in row] for row in time], rtol=1e-14, atol=1e-14)


@given(scenarios, st.sampled_from([1.0, 1e-7]), st.integers(0, 9))
def test_every_instruction_set_and_every_order_of_times_gives_the_same_bits(
    scenario: Scenario, scale: float, count: int
) -> None:
    times = np.sort(np.concatenate([np.linspace(0.0, DURATION * scale, count), scenario.breaks]))
    signal = replace(scenario, waves=tuple(replace(wave, phase=wave.phase / scale) for wave in scenario.waves)).signal
    for before in (False, True):
        found = signal.at(times, before)
        assert np.array_equal(found, np.transpose([signal.at(np.array([time]), before)[:, 0] for time in times]).reshape(2, -1))
        assert np.array_equal(found, signal.at(times[::-1].copy(), before)[:, ::-1])
        with pytest.MonkeyPatch.context() as environment:
            environment.setenv("STRAINWAVE_INSTRUCTION_SET", "baseline")
            assert np.array_equal(found, signal.at(times, before))


@pytest.mark.parametrize("method", ["value", "rate", "value_before"])
@pytest.mark.parametrize("time", [-1e-9, 4.000001, float("nan"), float("inf")])
def test_a_time_outside_is_refused(method: str, time: float) -> None:
    with pytest.raises(ValueError, match=exactly(f"time = {time} s lies outside the scenario, [0, 4.0] s")):
        getattr(sine(1.0, 1.0, DURATION), method)([0.0, time, 1.0])


# Each signal against its closed form


def test_a_constant_stays_and_rests() -> None:
    scenario = constant(-0.5, 2.0)
    assert scenario.value([0.0, 1.0, 2.0]).tolist() == [-0.5, -0.5, -0.5]
    assert scenario.rate([0.0, 1.0, 2.0]).tolist() == [0.0, 0.0, 0.0]
    assert scenario.breaks.size == 0


def test_a_step_jumps_once() -> None:
    scenario = step(2.0, 1.0, start=0.25)
    assert scenario.value([0.0, 0.2499, 0.25, 1.0]).tolist() == [0.0, 0.0, 2.0, 2.0]
    assert scenario.value_before(0.25) == 0.0
    assert scenario.rate([0.0, 0.25, 1.0]).tolist() == [0.0, 0.0, 0.0]
    assert scenario.breaks.tolist() == [0.25]


def test_a_step_at_zero_has_no_break() -> None:
    assert step(2.0, 1.0).breaks.size == 0
    assert step(2.0, 1.0).value(0.0) == step(2.0, 1.0).value_before(0.0) == 2.0


def test_a_ramp_rises_from_its_start() -> None:
    scenario = ramp(3.0, 2.0, start=0.5)
    assert scenario.value([0.0, 0.5, 1.0, 2.0]).tolist() == [0.0, 0.0, 1.5, 4.5]
    assert rate_before(scenario, 0.5) == 0.0
    assert scenario.rate(0.5) == 3.0
    assert scenario.breaks.tolist() == [0.5]


def test_a_sine_is_offset_plus_amplitude_times_sine() -> None:
    time = np.linspace(0.0, 5.0, 1001)
    scenario = sine(0.2, 2.0, 5.0, phase=0.4, offset=1.5)
    np.testing.assert_allclose(scenario.value(time), 1.5 + 0.2 * np.sin(4 * np.pi * time + 0.4), rtol=0, atol=1e-14)
    np.testing.assert_allclose(scenario.rate(time), 0.8 * np.pi * np.cos(4 * np.pi * time + 0.4), rtol=0, atol=1e-13)


@given(st.floats(0.0, 50.0), st.floats(0.0, 50.0))
def test_a_chirp_is_scipys_chirp(start_frequency: float, stop_frequency: float) -> None:
    time = np.linspace(0.0, 3.0, 200)
    reference = scipy.signal.chirp(time, start_frequency, 3.0, stop_frequency, method="linear", phi=-90)
    value = chirp(1.0, start_frequency, stop_frequency, 3.0).value(time)
    np.testing.assert_allclose(value, reference, rtol=0, atol=1e-12)


def test_numbers_of_numpy_are_numbers() -> None:
    """Small whole numbers of numpy would overflow, and its short floats lose digits."""
    assert chirp(np.float32(0.25), np.int64(300), np.uint8(255), 1.0) == chirp(0.25, 300.0, 255.0, 1.0)
    assert pulse_train(1.0, np.float32(3e38), np.float32(0.5), 1.0) == pulse_train(1.0, 2.0, 0.5, 1.0)


def test_the_frequency_of_a_chirp_moves_linearly() -> None:
    time = np.linspace(0.0, 10.0, 1234)
    scenario = chirp(0.3, 1.0, 6.0, 10.0)
    cosine = np.sqrt(0.3**2 - scenario.value(time) ** 2)  # so that rate = 2 pi f * cosine
    clear = cosine > 0.01
    instantaneous = np.abs(scenario.rate(time[clear])) / (2 * np.pi * cosine[clear])
    np.testing.assert_allclose(instantaneous, 1.0 + 0.5 * time[clear], rtol=1e-9)


@given(st.integers(1, 20), st.floats(0.1, 3.0), st.floats(0.05, 0.95), st.floats(0.0, 1.0), amplitude)
def test_the_area_of_pulses_is_amplitude_times_width_times_count(
    count: int, period: float, duty: float, begin: float, height: float
) -> None:
    width = duty * period
    duration = begin + (count - 1) * period + width + 0.5 * (period - width)  # ends in the gap after the last pulse
    pulses = pulse_train(height, period, width, duration, begin)
    edges = np.concatenate(([0.0], pulses.breaks, [duration]))
    area = float(pulses.value(edges[:-1]) @ np.diff(edges))
    assert area == pytest.approx(height * width * count, rel=1e-12)


def test_a_pulse_begins_with_its_period_and_ends_before_its_width_is_over() -> None:
    pulses = pulse_train(2.0, period=0.5, width=0.125, duration=1.0, start=0.25)
    assert pulses.breaks.tolist() == [0.25, 0.375, 0.75, 0.875]
    assert pulses.value([0.0, 0.25, 0.3, 0.375, 0.75, 0.875, 1.0]).tolist() == [0.0, 2.0, 2.0, 0.0, 2.0, 0.0, 0.0]
    assert pulses.value_before(pulses.breaks).tolist() == [0.0, 2.0, 0.0, 2.0]


@given(st.lists(st.tuples(st.floats(0.01, 1.0), amplitude), min_size=1, max_size=10), amplitude)
def test_a_table_is_linear_interpolation(points: list[tuple[float, float]], first: float) -> None:
    time = np.append(0.0, np.cumsum([gap for gap, _ in points]))
    value = [first, *(value for _, value in points)]
    between = np.linspace(0.0, time[-1], 57)
    scenario = table(time, value)
    assert scenario.duration == time[-1]
    np.testing.assert_allclose(scenario.value(between), np.interp(between, time, value), rtol=0, atol=1e-13)
    np.testing.assert_allclose(scenario.value(time), value, rtol=0, atol=1e-14)


def test_a_table_breaks_where_its_slope_changes() -> None:
    assert table([0.0, 1.0, 2.0, 4.0], [0.0, 1.0, 2.0, 0.0]).breaks.tolist() == [2.0]


# Sampling


@pytest.mark.parametrize(
    ("duration", "dt", "samples", "last"),
    [(0.3, 0.1, 4, 0.3), (5.0, 2e-4, 25_001, 5.0), (1.0, 0.3, 4, 0.9), (1.0, 1.0, 2, 1.0), (0.7, 0.1, 8, 0.7)],
)
def test_samples_run_to_the_last_multiple_inside(duration: float, dt: float, samples: int, last: float) -> None:
    recording = ramp(2.0, duration).recording(dt, "rad")
    assert recording.names == ("time", "command")
    assert (recording.unit("time"), recording.unit("command")) == ("s", "rad")
    assert len(recording) == samples
    assert recording.time[-1] == pytest.approx(last, rel=1e-15)
    np.testing.assert_allclose(recording["command"], 2.0 * recording.time, rtol=1e-15)


# Refusals


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: constant(1.0, 0.0), "constant.duration = 0.0 s must lie in [1e-30, inf)"),
        (lambda: constant(float("nan"), 1.0), "constant.value = nan must be finite"),
        (lambda: step(1.0, 5.0, 5.0), "step.start = 5.0 s must lie in [0, 5)"),
        (lambda: step(1.0, 5.0, -0.1), "step.start = -0.1 s must lie in [0, 5)"),
        (lambda: ramp(float("inf"), 5.0), "ramp.rate = inf must be finite"),
        (lambda: sine(1.0, -1.0, 5.0), "sine.frequency = -1.0 Hz must lie in [0, inf)"),
        (lambda: sine(1.0, 1.0, 5.0, phase=float("nan")), "sine.phase = nan rad must be finite"),
        (lambda: chirp(1.0, 0.0, float("inf"), 5.0), "chirp.stop_frequency = inf Hz must lie in [0, inf)"),
        (lambda: pulse_train(1.0, 1.0, 1.0, 5.0), "pulse_train.width = 1.0 s must lie in (0, 1)"),
        (lambda: pulse_train(1.0, 0.0, 1.0, 5.0), "pulse_train.period = 0.0 s must lie in (0, inf)"),
        (
            lambda: table([0.0, 2.0, 1.0], [0.0, 1.0, 2.0]),
            'column "time" row 2: 1.0 s does not lie after 2.0 s; time must increase',
        ),
        (lambda: table([0.0, 1.0], [0.0, float("nan")]), 'column "value" row 1: nan is not finite'),
        (lambda: table([0.0, 1.0], [0.0]), 'column "value" has 1 samples, column "time" has 2'),
        (lambda: table([0.5, 1.0], [0.0, 1.0]), "table.time begins at 0.5 s; it must begin at 0 s"),
        (lambda: table([0.0], [0.0]), "table.time holds 1 time; at least 2 are needed"),
        (lambda: float("inf") * step(1.0, 1.0), "factor = inf must be finite"),
        (
            lambda: step(1.0, 1.0) + step(1.0, 2.0),
            "durations differ, 1.0 s and 2.0 s; a sum needs one duration",
        ),
        (lambda: step(1.0, 5e-324), "step.duration = 5e-324 s must lie in [1e-30, inf)"),
        (
            lambda: table([0.0, 1.0, 1.0 + 1e-15], [0.0, 0.0, 1e300]),
            "table.value changes so much from row 1 to row 2 that its rate is not finite; take less",
        ),
        (lambda: 1e10 * constant(1e300, 1.0), "scenario.level = inf must be finite"),
        (lambda: constant(1e308, 1.0) + constant(1e308, 1.0), "scenario.level = inf must be finite"),
        (
            lambda: ramp(1e300, 1e10),
            "scenario: the command, its rate or the angle of a wave grows beyond 1.8e+308 within 1e+10 s; "
            "take smaller numbers, or a shorter duration",
        ),
        (lambda: step(1.0, 1.0).recording(5e-324, "rad"), "1 s are more than 1e+08 steps of 4.94066e-324 s; take longer ones"),
        (lambda: pulse_train(1.0, 1e-12, 1e-13, 1.0), "1 s are more than 1e+06 steps of 1e-12 s; take fewer pulses"),
        (lambda: step(1.0, 1.0).recording(2.0, "rad"), "recording.dt = 2.0 s must lie in (0, 1]"),
        (
            lambda: Scenario(1.0, np.array([0.0, 1.0]), np.zeros(2), np.zeros(2)),
            "scenario.start must increase from 0 s and stay below 1.0 s",
        ),
        (
            lambda: Scenario(1.0, np.zeros(1), np.zeros(2), np.zeros(1)),
            "scenario.level must hold one number for each piece",
        ),
        (
            lambda: Scenario(1.0, np.zeros(1), np.zeros(1), np.zeros(1), (Wave(float("nan"), 1.0, 0.0, 0.0),)),
            "wave.amplitude = nan must be finite",
        ),
    ],
)
def test_what_is_no_signal_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=exactly(message)):
        make()


def test_a_unit_is_kept_by_sums_and_multiples_and_compared_where_it_is_known() -> None:
    swing = sine("5 deg", 1.0, 1.0)
    for signal in (
        swing + step(1.0, 1.0),
        step(1.0, 1.0) - swing,
        2.0 * swing,
        ramp("3 rpm", 1.0),
        pickle.loads(pickle.dumps(swing)),
    ):
        signal.check_unit("command", "rad")
        with pytest.raises(
            ValueError, match=r"^command: the scenario is in (deg|rpm\.s), and N\.m is expected; give its numbers in N\.m$"
        ):
            signal.check_unit("command", "N.m")
    step(1.0, 1.0).check_unit("command", "N.m")
    step("50 % of 12 A", 1.0).check_unit("command", "A")
    with pytest.raises(ValueError, match=exactly("a sum: the units differ, deg and N.m; both must measure the same")):
        swing + constant("5 N.m", 1.0)
    with pytest.raises(
        ValueError, match=exactly("sine.amplitude and sine.offset: the units differ, deg and s; both must measure the same")
    ):
        sine("5 deg", 1.0, 1.0, offset="3 s")
    with pytest.raises(ValueError, match=r"is in deg, and N\.m is expected"):
        swing.recording(0.5, "N.m")
    with pytest.raises(ValueError, match='"furlong" is not known'):
        replace(swing, unit="furlong")


@pytest.mark.parametrize(
    ("command", "load", "wrong"),
    [
        (step("5 N.m", 0.01), 0.0, "command: the scenario is in N.m, and rad is expected; give its numbers in rad"),
        (step("3 s", 0.01), 0.0, "command: the scenario is in s, and rad is expected; give its numbers in rad"),
        (ramp("30 deg", 0.01), 0.0, "command: the scenario is in deg.s, and rad is expected; give the rate of a ramp in rad/s"),
        (
            step("5 deg", 0.01),
            constant("5 A", 0.01),
            "load_torque: the scenario is in A, and N.m is expected; give its numbers in N.m",
        ),
    ],
)
def test_a_run_refuses_a_signal_in_another_unit(command: Scenario, load: Any, wrong: str) -> None:
    with pytest.raises(ValueError, match=exactly(wrong)):
        sw.simulate(sw.load("position-drive"), command, load_torque=load)


def test_a_scenario_in_another_unit_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"the scenario is in N\.m, and rad is expected"):
        sw.simulation.ScenarioFile(step("5 N.m", 0.01)).save(tmp_path / "step.toml", sw.load("position-drive"))


@pytest.mark.parametrize(
    "make", [lambda a: sine(a, 1.0, 1.0), lambda a: step(a, 1.0), lambda a: ramp(a, 1.0), lambda a: chirp(a, 1.0, 2.0, 1.0)]
)
def test_a_difference_of_temperatures_is_in_kelvin(make: Callable[[str], Scenario]) -> None:
    with pytest.raises(ValueError, match="= '5 degC' is a difference of temperatures: write 5 degC as 5 K"):
        make("5 degC")
    warm = sine("5 K", 1.0, 1.0, offset="20 degC")
    assert (warm.waves[0].amplitude, warm.level[0]) == (5.0, 293.15)


def test_texts_with_units_are_the_numbers_in_si_units() -> None:
    assert sine("90 deg", "2000 mHz", duration="500 ms", phase="180 deg") == sine(np.pi / 2.0, 2.0, 0.5, phase=np.pi)
    assert constant("20 degC", 1.0) == constant(293.15, 1.0)
    for amplitude, wrong in (
        ("5", 'sine.amplitude = "5" has no unit; write a number and its unit, as "1.2 deg"'),
        (
            "5 furlong",
            'sine.amplitude = "5 furlong": unit "furlong" is not known; write it like N.m, rad/s, deg; '
            'write a number and its unit, as "1.2 deg"',
        ),
    ):
        with pytest.raises(ValueError, match=exactly(wrong)):
            sine(amplitude, 1.0, 1.0)
    with pytest.raises(
        ValueError, match=exactly('sine.frequency: cannot convert "s" to "Hz"; write a number and its unit, as "1.2 Hz"')
    ):
        sine(1.0, "3 s", 1.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sine(None, 1.0, 1.0), "sine.amplitude must be a number, not None"),  # type: ignore[arg-type]
        (lambda: step(1.0, None), "step.duration must be a number, not None"),  # type: ignore[arg-type]
        (lambda: replace(step(1.0, 1.0), waves=[3]), "scenario.waves must be a tuple of waves, not [3]"),
        (lambda: replace(step(1.0, 1.0), waves=(3,)), "scenario.waves must be a tuple of waves, not (3,)"),
        (lambda: step(1.0, 1.0) - [1.0], "unsupported operand type(s) for -: 'Scenario' and 'list'"),  # type: ignore[operator]
        (lambda: step(1.0, 1.0) + 1.0, "unsupported operand type(s) for +: 'Scenario' and 'float'"),  # type: ignore[operator]
        (lambda: np.ones(2) * step(1.0, 1.0), "unsupported operand type(s) for *: 'numpy.ndarray' and 'Scenario'"),  # type: ignore[operator]
        (lambda: step(1.0, 1.0) * step(1.0, 1.0), "unsupported operand type(s) for *: 'Scenario' and 'Scenario'"),  # type: ignore[operator]
    ],
)
def test_what_is_no_number_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(TypeError, match=exactly(message)):
        make()


anything = st.floats() | st.sampled_from([5e-324, 1e-300, 1e300, 1.7976931348623157e308])
made_of_anything = st.one_of(
    st.tuples(st.just(constant), st.tuples(anything, anything)),
    st.tuples(st.sampled_from([step, ramp]), st.tuples(anything, anything, anything)),
    st.tuples(st.just(sine), st.tuples(anything, anything, anything, anything, anything)),
    st.tuples(st.just(chirp), st.tuples(anything, anything, anything, anything)),
    st.tuples(
        st.just(table), st.tuples(st.lists(anything, min_size=2, max_size=2), st.lists(anything, min_size=2, max_size=2))
    ),
)


@given(made_of_anything, anything)
def test_a_command_of_any_numbers_is_refused_or_finite_to_its_end(made: tuple[Any, Any], factor: float) -> None:
    """Warnings are errors here."""
    make, numbers = made
    try:
        command = factor * make(*numbers)
        command = command + command - 0.5 * command
    except ValueError:
        return
    instants = [0.0, 0.3 * command.duration, command.duration]
    for values in (command.value(instants), command.rate(instants), command.value_before(instants)):
        assert np.isfinite(values).all()


TOO_LARGE = """
from strainwave.simulation.scenario import pulse_train, step
from tests.support.little_memory import little_memory
for attempt in (lambda: step(1.0, 1e4).recording(1e-4, "rad"), lambda: pulse_train(1.0, 1e-4, 1e-5, 100.0)):
    try:
        with little_memory(64 << 20):
            attempt()
    except MemoryError as error:
        print(error)
"""


@pytest.mark.slow("simulation")
@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is limited as Linux does it")
def test_more_samples_or_pulses_than_memory_holds_are_told_in_a_line() -> None:
    """In a process of its own: one that has run other tests has freed as much as pulses take."""
    run = subprocess.run([sys.executable, "-c", TOO_LARGE], capture_output=True, text=True, check=True)
    samples, pulses = run.stdout.splitlines()
    assert samples.startswith("1e+08 samples take 4 GB, more memory than there is; ")
    assert pulses.startswith("1e+06 pulses take 0.2 GB, more memory than there is; ")
