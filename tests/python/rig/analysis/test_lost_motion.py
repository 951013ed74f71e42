"""Widths and areas of loops that have closed forms, and laws of all loops."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from hypothesis import example, given, settings, strategies as st
from strainwave.rig import Loop, LoopAnalysis, analyse
from strainwave.rig.analysis.lost_motion import drift
from strainwave.rig.reading.recorded import read_loop

from tests.python.rig.loops import TABLE, loop_of_table, parallelogram, refined, shoelace, straight, vertices


def loop(angle: np.ndarray, torque: np.ndarray, **more: object) -> Loop:
    return Loop(angle, torque, side="output", name="loop", **more)  # type: ignore[arg-type]


def test_document_ts_loop_has_the_width_and_the_loss_of_its_corners() -> None:
    found = analyse(loop_of_table())
    assert found.width_at_zero is not None
    assert found.hysteresis is not None
    assert found.area is not None
    assert found.closure is not None
    assert np.degrees(found.width_at_zero.value) == pytest.approx(50.5, abs=1e-9)
    assert found.area.value == pytest.approx(0.3063483432, abs=1e-10)
    # between 0 and the onset the branches part by (1/4.51 - 1/4.68) rad/(N.m), so that the widest is at the onset
    assert found.hysteresis.width.value == pytest.approx(np.radians(50.5) + 0.03 * (1 / 4.51 - 1 / 4.68), abs=1e-12)
    assert found.hysteresis.torque == pytest.approx(0.03)
    assert found.closure.value == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("position", TABLE)
def test_each_row_of_document_ts_table_has_its_width(position: float) -> None:
    found = analyse(loop_of_table(position))
    assert found.hysteresis is not None
    assert np.degrees(found.hysteresis.width.value) == pytest.approx(TABLE[position][4], abs=0.1)


@pytest.mark.slow("rig")
@settings(max_examples=12)
@given(k=st.floats(1.0, 1e3), slip=st.floats(0.1, 10.0), beyond=st.floats(1.1, 10.0), share=st.floats(0.1, 2.0))
def test_an_element_that_slips_beside_a_spring(k: float, slip: float, beyond: float, share: float) -> None:
    """Jenkin: area 4 f (A - f/k); torque width 2 f; width at zero torque 2 f/c, with the spring c and all slipping there."""
    amplitude, spring = beyond * slip / k, share * k
    found = analyse(loop(*parallelogram(k, spring, slip, amplitude)))
    assert found.area is not None
    assert found.torque_width is not None
    assert found.area.value == pytest.approx(4.0 * slip * (amplitude - slip / k), rel=1e-9)
    if amplitude >= 2.0 * slip / k:  # else no angle has both branches slipping
        assert found.torque_width[0] == pytest.approx(2.0 * slip, rel=1e-9)
    if spring * (amplitude - 2.0 * slip / k) >= slip:
        assert found.width_at_zero is not None
        assert found.width_at_zero.value == pytest.approx(2.0 * slip / spring, rel=1e-9)


def test_elastic_and_plastic_alone() -> None:
    """Without the spring the branches are level: at every torque between, the loop is 2 (A - f/k) wide."""
    found = analyse(loop(*parallelogram(k=10.0, spring=0.0, slip=1.0, amplitude=1.0)))
    assert found.hysteresis is not None
    assert found.hysteresis.width.value == pytest.approx(2.0 * (1.0 - 0.1))
    assert found.hysteresis.band == (pytest.approx(-1.0), pytest.approx(1.0))
    assert found.torque_width is not None
    assert found.torque_width[0] == pytest.approx(2.0)
    unloading = found.stiffness("positive_unloading")
    assert unloading is not None
    assert unloading.secant is not None
    assert unloading.secant.value == pytest.approx(10.0)


def test_masings_branches() -> None:
    """Skeleton T = k x / (1 + x/a), branches twice as large: width at zero torque and area from integrals of the skeleton."""
    k, a, amplitude = 3.0, 0.5, 1.0
    peak = k * amplitude / (1.0 + amplitude / a)
    x = np.linspace(0.0, 2.0 * amplitude, 4001)
    fallen = 2.0 * k * (0.5 * x) / (1.0 + 0.5 * x / a)
    angle = np.concatenate((amplitude - x, x[1:] - amplitude))
    torque = np.concatenate((peak - fallen, fallen[1:] - peak))
    found = analyse(loop(angle, torque))
    # zero torque where the skeleton carries half the peak: x/2 = (P/2)/(k - P/(2a))
    zero = amplitude - 2.0 * (0.5 * peak) / (k - 0.5 * peak / a)
    assert found.width_at_zero is not None
    assert found.area is not None
    assert found.width_at_zero.value == pytest.approx(2.0 * zero, rel=1e-6)
    # Masing: area = 8 (integral of the skeleton) - 4 A P
    integral = k * a * (amplitude - a * np.log1p(amplitude / a))
    assert found.area.value == pytest.approx(8.0 * integral - 4.0 * amplitude * peak, rel=1e-6)


def test_the_area_of_a_bouc_wen_loop_is_that_of_its_equation_integrated() -> None:
    law = sw.hysteresis.BoucWen(stiffness=2.0, saturation=0.8, sharpness=1.5, shape=0.7)
    back = np.concatenate((np.linspace(1.0, -1.0, 1000, endpoint=False), np.linspace(-1.0, 1.0, 1000, endpoint=False)))
    path = np.concatenate((np.linspace(0.0, 1.0, 500, endpoint=False), np.tile(back, 3), [1.0]))
    torque = law.trace(path)
    found = analyse(loop(path[-2001:], torque[-2001:]))
    assert found.area is not None
    assert found.area.value == pytest.approx(bouc_wen_area(), rel=1e-5)


def bouc_wen_area() -> float:
    """Third cycle of dT/dx = A - |T|^n (beta sign(T dx) + gamma), by Runge and Kutta's steps."""
    stiffness, n = 2.0, 1.5
    beta, gamma = (share * stiffness / 0.8**n for share in (0.7, 0.3))
    step, torque, lost = 1e-3, 0.0, 0.0

    def slope(torque: float, sense: float) -> float:
        return stiffness - abs(torque) ** n * (beta * np.sign(torque * sense) + gamma)

    for leg, (sense, length) in enumerate([(1.0, 1.0), *[(-1.0, 2.0), (1.0, 2.0)] * 3]):
        for _ in range(round(length / step)):
            dx = sense * step
            k1 = slope(torque, sense)
            k2 = slope(torque + 0.5 * dx * k1, sense)
            k3 = slope(torque + 0.5 * dx * k2, sense)
            k4 = slope(torque + dx * k3, sense)
            new = torque + dx * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
            lost += 0.5 * (torque + new) * dx if leg > 4 else 0.0
            torque = new
    return lost


@cache
def analysed_plain() -> LoopAnalysis:
    return analyse(loop_of_table(angle_sigma=1e-4, torque_sigma=1e-4))


@pytest.mark.slow("rig")
@settings(max_examples=8)
@given(a=st.floats(1e-4, 1e4), b=st.floats(1e-4, 1e4))
@example(a=1e-4, b=1e4)
@example(a=1e4, b=1e-4)
def test_units_scale_every_number(a: float, b: float) -> None:
    """Angle times a, torque times b: widths times a, stiffnesses times b/a, area times a b."""
    plain = loop_of_table(angle_sigma=1e-4, torque_sigma=1e-4)
    scaled = loop(a * plain.angle, b * plain.torque, angle_sigma=a * 1e-4, torque_sigma=b * 1e-4)
    one, other = analysed_plain(), analyse(scaled)
    assert other.hysteresis is not None
    assert one.hysteresis is not None
    assert other.hysteresis.width.value == pytest.approx(a * one.hysteresis.width.value)
    assert other.hysteresis.width.random == pytest.approx(a * one.hysteresis.width.random)
    assert other.area is not None
    assert one.area is not None
    assert other.area.value == pytest.approx(a * b * one.area.value)
    assert other.area.random == pytest.approx(a * b * one.area.random)
    for before, after in zip(one.stiffnesses, other.stiffnesses, strict=True):
        for name in ("secant", "regression", "softest"):
            found, known = getattr(after, name), getattr(before, name)
            assert (found.value, found.low) == (pytest.approx(b / a * known.value), pytest.approx(b / a * known.low))


@pytest.mark.parametrize("position", TABLE)
def test_turned_by_half_a_turn_the_regimes_change_places(position: float) -> None:
    plain = loop_of_table(position)
    one, other = analyse(plain), analyse(loop(-plain.angle, -plain.torque))
    pairs = {"positive_unloading": "negative_unloading", "negative_loading": "positive_loading"}
    for name, mirrored in (*pairs.items(), *((b, a) for a, b in pairs.items())):
        before, after = one.stiffness_by(name, "softest"), other.stiffness_by(mirrored, "softest")  # type: ignore[arg-type]
        assert before is not None
        assert after is not None
        assert after.value == pytest.approx(before.value, rel=1e-9)
    assert one.area is not None
    assert other.area is not None
    assert other.area.value == pytest.approx(one.area.value)


@pytest.mark.slow("rig")
@settings(max_examples=25, deadline=None)
@given(step=st.sampled_from([0.06, 0.03, 0.01, 0.005]))
def test_more_points_on_the_same_polygon_change_no_width_and_no_area(step: float) -> None:
    fine = analyse(loop(*refined(*vertices(TABLE[0.0]), step)))
    coarse = analyse(loop(*vertices(TABLE[0.0])))
    for name in ("width_at_zero", "area"):
        assert getattr(fine, name).value == pytest.approx(getattr(coarse, name).value, rel=1e-12)
    for one, other in zip(fine.stiffnesses, coarse.stiffnesses, strict=True):
        assert one.secant is not None
        assert other.secant is not None
        assert one.secant.value == pytest.approx(other.secant.value, rel=1e-12)


@pytest.mark.slow("rig")
@settings(max_examples=8)
@given(shift=st.floats(-10.0, 10.0), seed=st.integers(0, 100))
def test_the_area_is_that_of_the_polygon(shift: float, seed: int) -> None:
    plain = loop_of_table()
    angle = plain.angle + shift + 1e-3 * np.random.default_rng(seed).normal(size=len(plain))
    found = analyse(loop(angle, plain.torque))
    assert found.area is not None
    assert found.area.value == pytest.approx(shoelace(angle, plain.torque), rel=1e-9)


def test_a_loop_that_does_not_close_says_by_how_much() -> None:
    plain = loop_of_table(angle_sigma=1e-4)
    drifting = loop(plain.angle + 0.05 * np.arange(len(plain)) / (len(plain) - 1), plain.torque, angle_sigma=1e-4)
    found = analyse(drifting)
    assert found.closure is not None
    assert found.closure.value == pytest.approx(0.05)
    assert found.closure.random == pytest.approx(1e-4 * 2**0.5)
    assert any("the cycle ends 2.86 degrees from where it began" in remark for remark in found.remarks)


def test_drift_is_the_movement_from_cycle_to_cycle() -> None:
    plain = loop_of_table()
    n = len(plain) - 1
    angle = np.tile(plain.angle[:-1], 4) + 0.01 * np.arange(4 * n) / n
    found = analyse(loop(np.append(angle, 0.04), np.append(np.tile(plain.torque[:-1], 4), plain.torque[-1])))
    assert found.drift is not None
    assert found.drift.value == pytest.approx(0.01, rel=1e-6)
    assert found.closure is not None
    assert found.closure.value == pytest.approx(0.01, rel=1e-6)


def test_two_cycles_tell_a_drift_without_a_scatter() -> None:
    assert drift(np.array([1.0, 1.5]), 0.1).random == pytest.approx(0.1 * 2**0.5)


def test_a_loop_that_gives_energy_is_refused() -> None:
    plain = loop_of_table()
    with pytest.raises(ValueError, match=r"gives 0\.3063 J instead of losing energy"):
        analyse(loop(plain.angle[::-1], plain.torque[::-1]))


def test_widths_wait_for_a_whole_cycle() -> None:
    plain = loop_of_table()
    found = analyse(loop(plain.angle[:60], plain.torque[:60]))
    assert (found.hysteresis, found.width_at_zero, found.area, found.closure) == (None, None, None, None)
    assert any("the cycle is not complete" in remark for remark in found.remarks)


def test_friction_of_the_rig_widens_by_its_error_on_both_branches() -> None:
    angle, torque = straight(2.0, 0.5, 1.0, 10)
    found = analyse(loop(angle, torque, angle_sigma=1e-3, friction_sigma=0.01))
    assert found.width_at_zero is not None
    assert found.area is not None
    assert found.width_at_zero.shared == pytest.approx(2.0 * 0.01 / 2.0)  # 2 F / k
    assert found.area.shared == pytest.approx(0.01 * np.abs(np.diff(angle)).sum())


@pytest.mark.parametrize("position", TABLE)
@pytest.mark.parametrize("error", [0.002, -0.002])
def test_friction_changes_the_widest_as_the_stiffer_branch_has_it(position: float, error: float) -> None:
    """Pulleys that hold more than is thought shift the torques of both branches; so the width is found once more."""
    plain = loop_of_table(position, step=0.005, angle_sigma=1e-6, friction_sigma=abs(error))
    n = len(plain) // 2
    sense = np.where(np.arange(len(plain)) < n, 1.0, -1.0)
    shifted = loop(plain.angle, plain.torque + error * sense)
    here, there = analyse(plain).hysteresis, analyse(shifted).hysteresis
    assert here is not None
    assert there is not None
    assert abs(there.width.value - here.width.value) == pytest.approx(here.width.shared, rel=0.1)


def test_lost_motion_and_hysteresis_loss_are_the_catalogues() -> None:
    angle, torque = straight(2.0, 0.5, 1.0, 50)
    at_rated = analyse(loop(angle, torque), rated_torque=1.0)
    assert at_rated.hysteresis_loss is not None
    assert at_rated.lost_motion is not None
    assert (at_rated.hysteresis_loss.value, at_rated.lost_motion.value) == (pytest.approx(0.5), pytest.approx(0.5))
    beyond = analyse(loop(angle, torque), rated_torque=2.0)
    assert beyond.hysteresis_loss is None
    assert any("is not the hysteresis loss of a catalogue" in remark for remark in beyond.remarks)
    assert beyond.lost_motion is not None
    assert analyse(loop(angle, torque)).lost_motion is None


def small_cycle(peak: float, steps: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """Torque and angle of a spring k beside one element that slips at F, run to both peaks and back, by its closed form."""
    spring, element, slips = 16e3, 8e3, 0.8
    ends = [0.0, peak, -peak, peak, -peak, peak]
    torque, angle = [0.0], [0.0]
    held, turned = 0.0, 0.0
    for end in ends[1:]:
        way = np.sign(end - torque[-1])
        sticks = (way * slips - held) / element  # the turn at which the element slips
        for level in np.linspace(torque[-1], end, steps)[1:]:
            done = level - (spring * turned + held)
            x = done / (spring + element)
            x = x if abs(x) <= abs(sticks) else sticks + (done - sticks * (spring + element)) / spring
            torque.append(float(level))
            angle.append(turned + x)
        gone = angle[-1] - turned
        held += np.clip(element * gone, -abs(way * slips - held), abs(way * slips - held))
        turned = angle[-1]
    return np.array(torque), np.array(angle)


@pytest.mark.parametrize("missed", [1.0, 0.97, 1.3])
def test_a_cycle_to_four_percent_has_the_whole_angle_as_lost_motion_though_it_misses_its_torque(missed: float) -> None:
    rated = 67.0
    level = 0.04 * rated
    torque, angle = small_cycle(missed * level)
    found = analyse(Loop(angle, torque, side="output", name="test", angle_sigma=1e-6), rated_torque=rated)
    assert found.whole_angle
    assert found.lost_motion is not None
    truth = 2.0 * (level - 0.8) / 16e3  # loading, the element slips: T = k x + F
    assert found.lost_motion.value == pytest.approx(truth, rel=1e-3)
    assert not any("hysteresis loss" in remark for remark in found.remarks)


def test_a_cycle_that_stops_short_of_four_percent_states_its_peaks_and_the_torque_it_needs() -> None:
    torque, angle = small_cycle(1.5)
    found = analyse(Loop(angle, torque, side="output", name="test", angle_sigma=1e-6), rated_torque=67.0)
    assert found.lost_motion is None
    assert "the cycle from -1.5 to 1.5 N.m does not reach ±2.68 N.m" in " ".join(found.remarks)


def test_a_loop_of_a_bench_is_read_without_names_or_a_side(tmp_path: Path) -> None:
    torque, angle = small_cycle(2.68)
    rows = "\n".join(f"{t:.6g},{math.degrees(x) * 60.0:.6g}" for t, x in zip(torque, angle, strict=True))
    (tmp_path / "lost.csv").write_text("Torque [Nm],Angle [arcmin]\n" + rows + "\n")
    loop = read_loop(tmp_path / "lost.csv")
    assert loop.side == "output"
    assert loop.angle == pytest.approx(angle, abs=1e-8)
    assert "that of an output" in " ".join(loop.remarks)


def test_without_a_rated_torque_the_lost_motion_is_stated_for_peaks_of_four_percent() -> None:
    torque, angle = small_cycle(2.68)
    found = analyse(Loop(angle, torque, side="output", name="test", angle_sigma=1e-6))
    arcmin = 60.0 * math.degrees(2.0 * (2.68 - 0.8) / 16e3)
    (remark,) = (each for each in found.remarks if "4 % of the rated torque" in each)
    assert remark.endswith(f"that is 67 N.m, the lost motion is {arcmin:.3g} arcmin")
