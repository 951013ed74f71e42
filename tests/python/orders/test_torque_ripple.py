"""Ripple: lines put into a torque are found and named; noise makes no more lines than allowed; ratios come out blind."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

from tests.evidence import arms
from tests.support.samples import sample
from tests.support.shares import allowed_count

Array = NDArray[np.float64]
UNITS = {"time": "s", "output_angle": "rad", "torque": "N.m"}
MOTIONS: dict[str, Callable[[Array], Array]] = {
    "to and fro": lambda t: 1.2 * np.sin(0.5 * t) + 0.3 * np.sin(1.3 * t),
    "run-up": lambda t: 0.2 * t + 0.012 * t**2,
    "two speeds": lambda t: np.where(t < 15.0, 0.5 * t, 7.5 + 0.9 * (t - 15.0)),
    "constant": lambda t: 0.7 * t,
}


def joint(motion: str, seed: int = 0, noise: float = 0.4, coloured: bool = False, step: float = 0.004) -> dict[str, Array]:
    """A joint with friction and gravity, without ripple."""
    time = np.arange(0.0, 30.0, step)
    q = MOTIONS[motion](time)
    rough = np.random.default_rng(seed).normal(0.0, noise, len(time) + 50)
    if coloured:
        kernel = np.exp(-np.arange(51) / 10.0) * np.cos(0.5 * np.arange(51))
        rough = np.convolve(rough, kernel, "valid")
    torque = 5.0 * np.sign(np.gradient(q)) + 3.0 * np.gradient(q, time) + 8.0 * np.sin(q) + rough[: len(time)]
    return {"time": time, "output_angle": q, "torque": torque}


def rippled(columns: dict[str, Array], order: float, amplitude: float, phase: float = 0.0) -> dict[str, Array]:
    return {**columns, "torque": columns["torque"] + amplitude * np.cos(order * columns["output_angle"] + phase)}


def found(columns: dict[str, Array], **options: Any) -> sw.orders.Ripple:
    units = {name: UNITS.get(name, "rad") for name in columns}
    return sw.orders.ripple(sw.Recording(columns, units), "torque", **options)


@pytest.mark.parametrize("motion", ["to and fro", "run-up", "two speeds"])
@pytest.mark.parametrize("seed", [0, 1])
def test_an_order_line_and_mains_are_told_apart_where_the_speed_varies(motion: str, seed: int) -> None:
    columns = rippled(joint(motion, seed), 200.0, 0.15)
    columns["torque"] = columns["torque"] + 0.15 * np.cos(2.0 * np.pi * 50.0 * columns["time"] + 1.0)
    lines = {line.kind: line for line in found(columns).lines}
    assert set(lines) == {"order", "time"}
    assert abs(lines["order"].order - 200.0) < 4.0 * lines["order"].order_sigma
    assert lines["time"].frequency == pytest.approx(50.0, abs=0.02)
    for line in lines.values():
        assert abs(line.amplitude - 0.15) < 4.0 * line.sigma
        assert line.sigma < 0.02


@pytest.mark.parametrize("put_in", ["order", "mains"])
def test_at_constant_speed_it_is_said_that_order_and_time_cannot_be_told_apart(put_in: str) -> None:
    columns = joint("constant")
    wave = 200.0 * columns["output_angle"] if put_in == "order" else 2.0 * np.pi * 50.0 * columns["time"]
    columns["torque"] = columns["torque"] + 0.15 * np.cos(wave)
    told = found(columns)
    assert [line.kind for line in told.lines] == ["either"]
    assert any("too constant" in each for each in told.remarks)


@pytest.mark.slow("orders")
@pytest.mark.parametrize("motion", ["to and fro", "constant"])
@pytest.mark.parametrize("coloured", [False, True])
def test_noise_alone_makes_no_more_lines_than_allowed(motion: str, coloured: bool) -> None:
    trials = sample(12, 24)
    seen = sum(bool(found(joint(motion, seed, coloured=coloured), false_alarm=0.05).lines) for seed in range(trials))
    assert seen <= allowed_count(trials, 0.05)


@pytest.mark.slow("orders")
def test_amplitudes_scatter_by_as_much_as_is_stated() -> None:
    off = []
    for seed in range(sample(15, 30)):
        told = found(rippled(joint("to and fro", seed, coloured=True), 160.0, 0.3, 0.7), ratio=80.0)
        line = next(line for line in told.lines if abs(line.order - 160.0) < 1.0)
        off += [(line.forward - 0.3) / line.sigma, (line.order - 160.0) / line.order_sigma]
    assert 0.7 < np.sqrt(np.mean(np.square(off[0::2]))) < 1.4
    assert 0.5 < np.sqrt(np.mean(np.square(off[1::2]))) < 1.4


@pytest.mark.parametrize("swing", [0.0, 1e-4, 1e-3])
def test_a_shaft_that_swings_with_its_gear_shows_the_whole_ripple(swing: float) -> None:
    time = np.arange(0.0, 6.0, 1e-3)
    even = 30.0 * time
    angle = even + swing * np.sin(2.0 * even)
    noise = np.random.default_rng(0).normal(0.0, 0.02, len(time))
    columns = {"time": time, "input_angle": angle, "torque": 2.0 + 0.1 * np.cos(2.0 * angle + 0.4) + noise}
    told = found(columns, angle="input_angle", side="input")
    line = max(told.lines, key=lambda each: each.amplitude)
    assert line.order == pytest.approx(2.0, abs=0.01)
    assert line.amplitude == pytest.approx(0.1, abs=4.0 * line.sigma)
    assert line.sigma < 0.002


@settings(deadline=None, max_examples=sample(4, 10))
@given(ratio=st.sampled_from([50, 80, 100, 101, 120, 160]), seed=st.integers(0, 100))
def test_the_ratio_is_found_blind_from_orders_two_and_four(ratio: int, seed: int) -> None:
    columns = joint("to and fro", seed)
    columns = rippled(rippled(columns, 2.0 * ratio, 0.3, 0.4), 4.0 * ratio, 0.12, -1.0)
    told = found(columns)
    assert told.candidates[0].ratio == ratio
    assert {order for _, order in told.candidates[0].matched} >= {2.0}


def test_the_parts_of_a_line_tell_what_makes_it() -> None:
    columns = joint("to and fro", 3, noise=0.2)
    q, time = columns["output_angle"], columns["time"]
    sense, speed = np.sign(np.gradient(q)), np.gradient(q, time)
    wave = np.cos(160.0 * q)
    load = 6.0 + 8.0 * np.sin(q)
    for name, growing in (("direction", sense), ("speed squared", speed**2 / np.mean(speed**2)), ("load", load / 8.0)):
        told = found({**columns, "torque": columns["torque"] + 6.0 + 0.3 * growing * wave}, ratio=80.0)
        line = next(line for line in told.lines if abs(line.order - 160.0) < 1.5)
        largest = max(line.parts, key=lambda part: part.amplitude)
        assert largest.name == name
        assert largest.false_alarm < 1e-6


def test_it_works_without_time_and_with_a_wrapped_angle_of_the_motor() -> None:
    theta = np.linspace(0.0, 900.0, 20_000)
    torque = 0.05 + 0.004 * np.cos(2 * theta + 0.5) + np.random.default_rng(0).normal(0.0, 0.01, len(theta))
    recording = sw.Recording(
        {"input_angle": np.degrees(theta) % 360.0, "torque": torque}, {"input_angle": "deg", "torque": "N.m"}
    )
    told = sw.orders.ripple(recording, "torque", angle="input_angle", side="input")
    assert [(line.kind, round(line.order, 2)) for line in told.lines] == [("either", 2.0)]
    assert np.isnan(told.lines[0].frequency)
    assert any("without time" in each for each in told.remarks)


def test_outliers_do_not_count() -> None:
    columns = rippled(joint("to and fro"), 200.0, 0.3)
    hit = np.random.default_rng(1).choice(len(columns["time"]), 150, replace=False)
    columns["torque"][hit] += 30.0 * np.random.default_rng(2).standard_normal(150)
    told = found(columns)
    assert [round(line.order) for line in told.lines] == [200]
    assert any("far outside" in each for each in told.remarks)


def test_what_cannot_show_orders_is_refused_with_the_reason() -> None:
    columns = joint("to and fro", step=0.25)
    with pytest.raises(ValueError, match=r"4 samples per second show orders up to .* record faster, or turn slower"):
        found(columns)
    columns = joint("to and fro")
    columns["output_angle"] = 0.01 * columns["output_angle"]
    with pytest.raises(ValueError, match="turn further"):
        found(columns)
    columns = joint("to and fro")
    with pytest.raises(ValueError, match="torque does not change"):
        found({**columns, "torque": np.ones(len(columns["time"]))})
    for options, message in (
        ({"highest": 1e300}, r"^highest = 1e\+300 must lie in \(.*, 100000\]$"),
        ({"ratio": 0.0}, r"^ratio = 0\.0 must lie in \[0\.1, 10000\] or "),
        ({"false_alarm": 5e-324}, r"^false_alarm = 5e-324 must lie in \[1e-12, 1\)$"),
    ):
        with pytest.raises(ValueError, match=message):
            found(columns, **options)


def arm(seed: int, ratio: float, ripple: dict[float, float], jitter: float = 0.0) -> dict[str, Array]:
    """A joint of an arm with presliding, a fall at low speed and a loss under load, from plain NumPy (tests.evidence.arms)."""
    joint = arms.Joint(ratio=ratio, ripple=ripple)
    seen = arms.Recorder(rate=250.0, jitter=jitter, seed=seed)(arms.run((joint,) * 3, arms.fourier(20.0, (1,), seed, size=1.2)))
    return {"time": seen["time"], "output_angle": seen["q"][1], "torque": seen["motor_torque"][1]}


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_a_loss_under_load_and_friction_of_an_arm_are_no_lines(seed: int) -> None:
    assert not found(arm(seed, 100.0, {})).lines


def test_the_ratio_of_a_joint_whose_clock_is_not_even() -> None:
    told = found(arm(1, 80.0, {2.0: 0.006, 4.0: 0.002}, jitter=1.6e-3))
    assert "its clock is not even: rows are put on one of " in told.remarks[0]
    assert told.candidates[0].ratio == 80


def beside(columns: dict[str, Array], other: Array, order: float, amplitude: float) -> dict[str, Array]:
    """The joint beside another one, over whose angle [rad] its torque has a line."""
    return {**columns, "other": other, "torque": columns["torque"] + amplitude * np.cos(order * other + 0.3)}


def test_a_line_of_another_joint_is_attributed_to_it_and_gives_no_ratio() -> None:
    columns = joint("to and fro")
    q, time = columns["output_angle"], columns["time"]
    columns = beside(columns, 4.0 * q + 0.4 * np.sin(0.9 * time), 50.0, 0.8)
    result = found(columns, other_angles={"2": "other"})
    line = result.lines[0]
    assert (line.kind, line.joint) == ("joint", "2")
    assert line.order == pytest.approx(50.0, abs=0.3)
    assert all(each.kind != "order" for each in result.lines)
    assert (result.candidates, result.concluded) == ((), ())
    assert any("joint 2" in each and "not of this gear" in each for each in result.remarks)


def test_own_lines_remain_beside_those_of_another_joint() -> None:
    columns = rippled(joint("to and fro"), 160.0, 0.4)
    columns = beside(columns, 1.1 * np.sin(0.7 * columns["time"] + 1.0), 200.0, 0.4)
    result = found(columns, other_angles={"2": "other"})
    assert {(each.kind, each.joint, round(each.order)) for each in result.lines} >= {("order", "", 160), ("joint", "2", 200)}
    assert set(result.concluded) <= {80, 81}
    assert result.concluded


def test_a_line_that_may_be_of_a_joint_in_proportion_gives_no_ratio() -> None:
    columns = rippled(joint("to and fro"), 160.0, 0.5)
    result = found({**columns, "other": 1.25 * columns["output_angle"]}, other_angles={"3": "other"})
    assert [(each.kind, each.rivals, round(each.order)) for each in result.lines] == [("either", ("3",), 160)]
    assert result.concluded == ()
    assert any("moved in proportion" in each for each in result.remarks)


@pytest.mark.parametrize("order", [29.0, 35.0, 50.0])
def test_slow_lines_alone_give_no_ratio(order: float) -> None:
    result = found(rippled(joint("to and fro"), order, 0.5))
    assert result.lines[0].order == pytest.approx(order, abs=0.5)
    assert result.concluded == ()
    assert any("below order 60" in each and "other_angles" in each for each in result.remarks)


def test_a_single_line_of_no_usual_gear_gives_no_ratio() -> None:
    result = found(rippled(joint("to and fro"), 463.0, 0.3))
    assert result.concluded == ()
    assert any("no ratio is concluded" in each for each in result.remarks)


@pytest.mark.slow("orders")
def test_orders_of_the_motor_determine_which_spline_is_fixed() -> None:
    """Cogging of a motor with 7 pole pairs and 12 slots, as in recordings of commercial joints, without wave orders."""
    for ratio in (100, 101):
        columns = joint("to and fro", noise=0.2, step=0.001)
        for order in (12.0, 14.0, 24.0):
            columns = rippled(columns, order * ratio, 0.05)
        result = found(columns)
        assert result.concluded == (ratio,)
        assert all(each.kind == "order" for each in result.lines)


def test_either_spline_makes_the_line_of_a_gear() -> None:
    """A gear of 101 with the flexspline fixed has lines at 202, and at 200 as the circular spline sees the wave generator."""
    for order in (200.0, 202.0):
        assert found(rippled(joint("to and fro"), order, 0.4)).concluded == (100, 101)


def test_a_direction_with_hardly_any_motion_has_no_amplitude() -> None:
    time = np.arange(0.0, 20.0, 0.004)
    q = 0.7 * time - 0.02 * np.maximum(time - 19.8, 0.0) * 40.0
    rough = np.random.default_rng(0).normal(0.0, 0.3, len(time))
    result = found({"time": time, "output_angle": q, "torque": 5.0 + 0.3 * np.cos(200.0 * q) + rough})
    assert np.isnan(result.lines[0].backward)
    assert result.lines[0].amplitude == pytest.approx(0.3, abs=0.1)


def test_samples_that_follow_no_gear_of_a_large_ratio_are_named() -> None:
    result = found(rippled(joint("to and fro", step=0.02), 100.0, 0.4))
    assert any("lies beyond; record faster" in each for each in result.remarks)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_line_remains_where_the_measured_angle_swings_with_the_gear(seed: int) -> None:
    """To and fro at one speed, the measured speed varies by the error of the gear alone: friction over it took the line."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, 40.0, 0.01)
    q = 0.05 * np.abs((time % 40.0) - 20.0)
    angle = q + 150e-6 * np.sin(200.0 * q + 0.3) + random.normal(0.0, 1e-6, len(time))
    current = 0.3 * np.sign(np.gradient(q)) + 0.1 * np.gradient(q, time) + 0.03 * np.cos(200.0 * q + random.uniform(0.0, 6.0))
    result = found({"time": time, "output_angle": angle, "torque": current + random.normal(0.0, 0.01, len(time))})
    assert [round(line.order) for line in result.lines] == [200]
    assert result.lines[0].forward == pytest.approx(0.03, abs=3.0 * result.lines[0].sigma)
    assert result.lines[0].sigma < 0.001


@pytest.mark.parametrize("ratio", [80.0, None])
def test_viscous_friction_over_an_angle_that_swings_takes_nothing_of_a_line(ratio: float | None) -> None:
    """The measured speed swings by 1 %: friction of 0.5 A·s/rad over it took some mA of a line of 45."""
    random = np.random.default_rng(0)
    time = np.arange(0.0, 35.0, 0.01)
    q = 2.2 * np.sin(0.18 * time)
    speed = np.gradient(q, time)
    angle = q - 71e-6 * np.sin(160.0 * q + 0.3) + random.normal(0.0, 1e-5, len(time))
    current = 0.3 * np.tanh(speed / 1e-3) + 0.5 * speed + 0.045 * np.cos(160.0 * q) + random.normal(0.0, 0.003, len(time))
    line = found({"time": time, "output_angle": angle, "torque": current}, ratio=ratio).lines[0]
    assert line.sigma < 0.0002
    assert line.forward == pytest.approx(0.045, abs=4.0 * line.sigma)
