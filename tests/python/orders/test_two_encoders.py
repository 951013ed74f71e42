"""Two encoders: ratio, orders and lost motion of synthetic pairs are recovered, whatever the zeros, senses, units and wraps."""

from __future__ import annotations

from math import tau
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from strainwave.orders.two_encoders import ErrorOrder

from tests.evidence.drawn import te
from tests.support.samples import sample
from tests.support.shares import allowed_count

Array = NDArray[np.float64]
UNITS = {"time": "s", "input_angle": "rad", "output_angle": "rad"}


def slow(ratio: float, *, swing: float = 40.0, play: float = 0.0, noise: float = 1e-5, seed: int = 0) -> dict[str, Array]:
    """A slow motion to and fro, with orders 2 and 4, as both shafts have it."""
    time = np.arange(0.0, 30.0, 0.006)
    theta = swing * (np.sin(0.4 * time) + 0.2 * np.sin(1.1 * time))
    error = 2e-4 * np.sin(2 * theta + 0.4) + 5e-5 * np.sin(4 * theta - 1.0)
    sense = np.sign(np.gradient(theta / ratio))
    scatter = np.random.default_rng(seed).normal(0.0, noise, len(time))
    return {"time": time, "input_angle": theta, "output_angle": theta / ratio - error - 0.5 * play * sense + scatter}


def error_of(columns: dict[str, Array], units: dict[str, str] = UNITS, **options: Any) -> sw.orders.TransmissionError:
    return sw.transmission_error(sw.Recording(columns, units), **options)


def order(found: sw.orders.TransmissionError, which: float) -> ErrorOrder:
    return next(each for each in found.orders if each.order == which and each.shaft == "input")


def turned(angle: float) -> float:
    return float((angle + np.pi) % tau - np.pi)


@pytest.mark.slow("orders")
@settings(deadline=None, max_examples=sample(4, 10))
@given(
    ratio=st.sampled_from([-50.0, 51.0, -80.0, 101.0, -160.0]),
    zero=st.floats(-100.0, 100.0),
    at=st.floats(-3.0, 3.0),
    back=st.booleans(),
)
def test_orders_are_those_put_in_whatever_the_zeros_and_senses(ratio: float, zero: float, at: float, back: bool) -> None:
    columns = slow(ratio)
    columns["input_angle"] = columns["input_angle"] + zero
    columns["output_angle"] = (-1.0 if back else 1.0) * columns["output_angle"] + at
    found = error_of(columns)
    assert found.ratio.used == (-ratio if back else ratio)
    assert {each.order for each in found.orders if each.significant} == {2.0, 4.0}
    for which, amplitude, phase in ((2.0, 2e-4, 0.4), (4.0, 5e-5, -1.0)):
        each = order(found, which)
        expected = turned(phase - which * zero + (np.pi if back else 0.0))
        assert abs(each.amplitude - amplitude) < 4.0 * each.amplitude_sigma
        assert abs(turned(each.phase - expected)) < 4.0 * each.phase_sigma
        assert each.amplitude_sigma < 0.02 * amplitude
    law = found.law
    assert list(law.order) == [2.0, 4.0]


def test_degrees_and_wraps_change_nothing() -> None:
    plain = error_of(slow(-100.0))
    columns = slow(-100.0)
    wrapped = {
        "time": columns["time"],
        "input_angle": np.degrees(columns["input_angle"]) % 360.0,
        "output_angle": np.degrees(columns["output_angle"]),
    }
    found = error_of(wrapped, {"time": "s", "input_angle": "deg", "output_angle": "deg"})
    assert found.ratio.used == plain.ratio.used
    for one, other in zip(found.orders, plain.orders, strict=True):
        assert one.amplitude == pytest.approx(other.amplitude, abs=1e-9)


def test_lost_motion_is_the_difference_between_forward_and_backward() -> None:
    found = error_of(slow(-80.0, play=3e-4))
    assert found.lost_motion is not None
    assert abs(found.lost_motion.value - 3e-4) < 4.0 * found.lost_motion.sigma
    assert found.lost_motion.sigma < 3e-5


def test_a_shaft_that_turns_one_way_tells_no_lost_motion_but_orders_of_mesh_and_output() -> None:
    ratio, theta = -50.0, np.linspace(0.0, 150.0 * tau, 40_000)
    mesh = 2.0 * (1.0 - 1.0 / ratio)
    error = 1e-4 * np.sin(2 * theta) + 4e-5 * np.sin(mesh * theta + 1.0) + 3e-4 * np.sin(theta / 50.0)
    noise = np.random.default_rng(2).normal(0.0, 1e-5, len(theta))
    found = sw.transmission_error(
        sw.Recording(
            {"input_angle": theta, "output_angle": theta / ratio - error + noise}, {"input_angle": "rad", "output_angle": "rad"}
        )
    )
    assert found.lost_motion is None
    assert any("one way" in each for each in found.remarks)
    significant = {(round(each.order, 6), each.shaft): each.amplitude for each in found.orders if each.significant}
    assert significant[2.0, "input"] == pytest.approx(1e-4, rel=0.02)
    assert significant[round(mesh, 6), "mesh"] == pytest.approx(4e-5, rel=0.03)
    assert list(found.law.order) == pytest.approx([2.0, mesh])


@pytest.mark.slow("orders")
def test_noise_alone_makes_an_order_significant_no_more_often_than_allowed() -> None:
    seen, trials = 0, sample(12, 24)
    for seed in range(trials):
        rng = np.random.default_rng(seed)
        time = np.arange(0.0, 8.0, 0.004)
        theta = 60.0 * np.sin(0.9 * time)
        coloured = np.convolve(rng.normal(0.0, 1e-5, len(time) + 30), np.exp(-np.arange(31) / 8.0), "valid")
        found = error_of({"time": time, "input_angle": theta, "output_angle": theta / 100.0 + coloured}, false_alarm=0.05)
        seen += any(each.significant for each in found.orders)
    assert seen <= allowed_count(trials, 0.05)


def test_what_cannot_be_is_refused() -> None:
    columns = slow(-80.0)
    with pytest.raises(ValueError, match="ratio = 100 is not that of the angles"):
        error_of(columns, ratio=100.0)
    with pytest.raises(ValueError, match="do not move together"):
        error_of({**columns, "output_angle": np.random.default_rng(0).normal(size=len(columns["time"]))})
    with pytest.raises(ValueError, match="the two seem to be swapped"):
        error_of({**columns, "input_angle": columns["output_angle"], "output_angle": columns["input_angle"]})
    with pytest.raises(ValueError, match="does not change"):
        error_of({**columns, "output_angle": np.zeros(len(columns["time"]))})


def test_a_given_ratio_of_the_other_sign_says_that_an_encoder_counts_the_other_way_round() -> None:
    found = error_of(slow(-80.0), ratio=80.0)
    assert found.ratio.used == -80.0
    assert any("counts the other way round" in each for each in found.remarks)


@pytest.mark.slow("orders")
def test_of_a_long_record_the_beginning_is_used_and_that_is_said() -> None:
    time = np.arange(0.0, 400.0, 0.001)
    theta = 60.0 * np.sin(0.9 * time)
    scatter = np.random.default_rng(0).normal(0.0, 1e-5, len(time))
    found = error_of({"time": time, "input_angle": theta, "output_angle": theta / 50.0 - 1e-4 * np.sin(2 * theta) + scatter})
    assert any("samples are used" in each for each in found.remarks)
    assert abs(order(found, 2.0).amplitude - 1e-4) < 4.0 * order(found, 2.0).amplitude_sigma


REDUCER = 1798.0 / 7.0  # of a robot's first axis, an RV gear


def test_a_ratio_that_is_not_whole_is_obeyed_to_its_digits() -> None:
    found = error_of(slow(REDUCER, swing=100.0, noise=1e-6), ratio=REDUCER)
    assert found.ratio.used == REDUCER
    assert not found.ratio.whole
    assert not any("teeth" in each or "257" in each for each in found.remarks)
    blind = error_of(slow(REDUCER, swing=100.0, noise=1e-6))
    assert abs(blind.ratio.value - REDUCER) < 3.0 * blind.ratio.sigma
    assert not any("teeth" in each for each in blind.remarks)


def test_a_ratio_that_the_angles_contradict_is_shown_beside_theirs() -> None:
    columns = slow(-100.0, swing=400.0, noise=1e-6)
    found = error_of(columns, ratio=100.5)
    assert found.ratio.used == -100.5
    assert found.ratio.sigma < 0.15
    remark = next(each for each in found.remarks if "is used as given" in each)
    assert "ratio 100.5" in remark
    assert "the angles give 100" in remark
    assert "±" in remark


def test_a_motor_angle_already_divided_by_the_ratio_is_recognised() -> None:
    """As robot controllers export them: both angles in joint units."""
    columns = slow(REDUCER, swing=100.0, noise=1e-7)
    exported = {**columns, "input_angle": columns["input_angle"] / REDUCER}
    given = error_of(exported, ratio=REDUCER)
    assert (given.ratio.used, given.ratio.in_joint_units) == (REDUCER, True)
    assert any("both are counted in joint units" in each for each in given.remarks)
    assert {each.order for each in given.orders if each.significant and each.shaft == "input"} == {2.0, 4.0}
    assert order(given, 2.0).amplitude == pytest.approx(2e-4, rel=0.02)
    blind = error_of(exported, ratio_option="--constant ratio=NUMBER")
    assert blind.ratio.in_joint_units
    assert blind.orders == ()
    assert any("joint units" in each and "--constant ratio=NUMBER" in each for each in blind.remarks)


@pytest.mark.parametrize("option", ["--ratio", "--constant ratio=NUMBER"])
def test_advice_names_the_option_of_the_command(option: str) -> None:
    found = error_of(slow(-80.0, swing=2.5), ratio_option=option)
    assert any(f"with {option}" in each for each in found.remarks)


@pytest.mark.parametrize(
    ("turns", "orders"), [(0.13, set()), (0.9, set()), (1.6, {2.0, 3.0, 4.0, 6.0, 8.0}), (3.2, {1.0, 2.0})]
)
def test_an_order_needs_three_periods_and_a_whole_turn(turns: float, orders: set[float]) -> None:
    swing = np.pi * turns
    columns = slow(-80.0)
    time = columns["time"]
    theta = swing * np.sin(0.4 * time)
    noise = np.random.default_rng(0).normal(0.0, 1e-6, len(time))
    columns |= {"input_angle": theta, "output_angle": theta / -80.0 - 2e-4 * np.sin(2 * theta) + noise}
    found = error_of(columns, ratio=80.0)
    reported = {each.order for each in found.orders if each.shaft == "input"}
    assert reported >= orders
    assert bool(reported) == bool(orders)
    assert (1.0 in reported) == (turns >= 3.0)
    if turns < 3.0:
        assert any("needs 3 periods" in each for each in found.remarks)


def bench(seed: int) -> tuple[dict[str, Any], float]:
    """Columns of a bench at one speed, one way, over one turn of the output, by NumPy alone; and the amplitude of order 2."""
    random = np.random.default_rng(seed)
    speed, amplitude = random.uniform(5.0, 150.0) * np.pi / 30.0, random.uniform(5e-5, 3e-4)  # rad/s of the input, rad
    time = np.linspace(0.0, 200.0 * np.pi / speed, random.integers(8000, 20000))
    theta = speed * time
    error = amplitude * np.sin(2.0 * theta + 0.3) + 4e-5 * np.sin(4.0 * theta)
    noise = random.normal(0.0, 3e-6, (2, len(time)))
    return {"time": time, "input_angle": theta + noise[0], "output_angle": -theta / 100.0 - error + noise[1]}, amplitude


@pytest.mark.parametrize("seed", range(6))
def test_at_one_speed_the_measured_amplitude_stands(seed: int) -> None:
    """One speed does not determine how the output vibrates: a natural frequency fitted to it made 491 of 121 µrad."""
    columns, amplitude = bench(seed)
    result = error_of(columns)
    assert result.natural_frequency is None
    assert abs(order(result, 2.0).amplitude - amplitude) < 3.0 * order(result, 2.0).amplitude_sigma
    assert order(result, 2.0).amplitude_sigma < 2e-7
    assert any("amplitudes are those measured at" in remark for remark in result.remarks)


def test_above_its_resonance_a_ramp_shows_amplitudes_at_its_speeds_alone() -> None:
    """Orders and loads of another size predict a ramp above the natural frequency as well: 100 µrad look like 6."""
    time = np.linspace(0.0, 40.0, 6001)
    theta = 10.0 * (0.2 * time + 0.5 * time**2 / time[-1])
    goal = theta / 100.0 - 1e-4 * np.sin(2.0 * theta + 0.4)
    output = te.vibrating(goal, float(time[1]), frequency=2.0, damping=0.2) + np.random.default_rng(1).normal(0.0, 1e-6, 6001)
    result = error_of({"time": time, "input_angle": theta, "output_angle": output})
    assert result.natural_frequency is None
    assert any("they change with the speed" in remark for remark in result.remarks)


def test_an_order_that_passes_a_resonance_has_side_lines_that_are_no_orders_of_the_mesh() -> None:
    """Its amplitude and phase over the run make lines beside it, as that of the other spline would be."""
    time = np.arange(0.0, 40.0, 5e-3)
    speed = 4.0 + 0.725 * time
    theta = 4.0 * time + 0.3625 * time**2
    passing = 1.0 / (1.0 - (2.0 * speed / 50.0) ** 2 + 0.06j * (2.0 * speed / 50.0))
    error = 1e-5 * np.real(passing * np.exp(2j * theta)) + np.random.default_rng(0).normal(0.0, 1e-7, len(time))
    result = error_of({"time": time, "input_angle": theta, "output_angle": theta / 50.0 + error})
    assert result.vibrates
    assert not [each for each in result.orders if each.shaft == "mesh"]
    assert any("not determined: orders 0.98, 1.96, 3.92; orders of the input" in remark for remark in result.remarks)


@pytest.mark.slow("orders")
@pytest.mark.parametrize(
    ("seed", "verdict"),
    [(7, "right"), (102, "right"), (104, "refused"), (201, "right"), (225, "right"), (302, "right")],
)
def test_a_vibration_is_fitted_where_the_record_determines_it(seed: int, verdict: str) -> None:
    """102, 104: none, with noise of the input encoder and friction; 201, 225, 302: one, both ways and in a ramp."""
    assert te.outcome(seed).verdict == verdict


@pytest.mark.parametrize("turns", [3.0, 5.3])
def test_once_per_turn_of_the_output_is_one_order_with_the_wind_up_by_a_weight(turns: float) -> None:
    """Which a separate column of gravity would take from it."""
    theta = np.arange(0.0, tau * 80.0 * turns, 0.2)
    noise = np.random.default_rng(4).normal(0.0, 1e-6, len(theta))
    output = theta / 80.0 + 9e-5 * np.sin(2.0 * theta) + 1.1e-4 * np.sin(theta / 80.0 + 0.5) + noise
    found = error_of({"time": 0.01 * np.arange(len(theta)), "input_angle": theta, "output_angle": output})
    (of_output,) = [each for each in found.orders if each.shaft == "output" and each.significant]
    assert of_output.order == pytest.approx(1.0 / 80.0)
    assert of_output.amplitude == pytest.approx(1.1e-4, abs=4.0 * of_output.amplitude_sigma)
    assert of_output.amplitude_sigma < 1e-6
    assert any("order 1 of the output contains the wind-up by a weight" in each for each in found.remarks)


def test_a_simulation_has_the_ratio_of_its_drive() -> None:
    """The motion is too small to determine it: a recording of the same angles takes another one."""
    run = sw.simulate(sw.load("robot-joint"), sw.scenario.sine(0.002, 1.0, 1.0))
    assert sw.transmission_error(run).ratio.used == -100.0
    assert sw.transmission_error(run.select(list(run.names))).ratio.used == -99.0
