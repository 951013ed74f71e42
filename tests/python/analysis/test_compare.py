"""Comparisons: of recordings against closed forms, whatever their units and sampling; of models number by number."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from strainwave import Recording, compare
from strainwave.analysis import Agreement, Difference
from strainwave.files import Quantity
from strainwave.files.entries import Entry

from tests.support.samples import sample
from tests.support.strategies import drives, made


def series(time: Any, values: Any, unit: str = "N.m", name: str = "torque", time_unit: str = "s") -> Recording:
    return Recording({"time": time, name: values}, {"time": time_unit, name: unit})


TIME = {"time": "s"}
TURN = np.arange(1000) / 1000.0  # one period, its end left out, so that means over it are those of the integrals


# Recordings


@given(st.floats(0.01, 3.1), st.floats(1e-3, 1e3))
def test_a_shifted_sine_differs_as_the_closed_form_says(shift: float, amplitude: float) -> None:
    """sin(x + s) - sin(x) = 2 sin(s / 2) cos(x + s / 2); the correlation over a period is cos(s)."""
    one, other = (series(TURN, amplitude * np.sin(2.0 * pi * TURN + phase)) for phase in (0.0, shift))
    (found,) = compare(one, other)
    assert found.rms == pytest.approx(amplitude * sqrt(2.0) * sin(shift / 2.0), rel=1e-9)
    assert found.largest == pytest.approx(2.0 * amplitude * sin(shift / 2.0), rel=1e-5)  # a sample is that near the crest
    assert found.correlation == pytest.approx(cos(shift), abs=1e-9)
    assert found.samples == 1000


def test_an_offset_is_the_error_everywhere_and_does_not_spoil_the_correlation() -> None:
    one = series(TURN, np.sin(2.0 * pi * TURN))
    (found,) = compare(one, series(TURN, 0.25 + np.sin(2.0 * pi * TURN)))
    assert (found.rms, found.largest) == (pytest.approx(0.25), pytest.approx(0.25))
    assert found.correlation == pytest.approx(1.0, abs=1e-12)
    assert compare(one, series(TURN, -2.0 * np.sin(2.0 * pi * TURN)))[0].correlation == pytest.approx(-1.0, abs=1e-12)


def test_the_largest_difference_is_told_with_its_time() -> None:
    values = np.zeros(11)
    values[7] = -3.0
    (found,) = compare(series(np.arange(11.0), np.zeros(11)), series(np.arange(11.0), values))
    assert (found.largest, found.time, found.rms) == (3.0, 7.0, pytest.approx(3.0 / sqrt(11.0)))
    assert found.correlation is None
    assert str(found) == "torque: rms 0.9045 N.m, largest 3 N.m at t = 7 s, one is constant"


def test_units_of_values_and_times_are_converted_to_those_of_the_first() -> None:
    one = series([0.0, 1.0, 2.0], [0.0, 90.0, 180.0], "deg", "output_angle")
    (found,) = compare(one, series([0.0, 1000.0, 2000.0], [0.0, pi / 2.0, pi], "rad", "output_angle", time_unit="ms"))
    assert (found.unit, found.rms) == ("deg", pytest.approx(0.0, abs=1e-12))


@given(st.integers(2, 40), st.integers(2, 40), st.floats(-0.5, 0.5))
def test_a_straight_line_is_the_same_however_it_is_sampled(first: int, second: int, later: float) -> None:
    one, other = np.linspace(0.0, 1.0, first), np.linspace(later, 1.0 + later, second)
    if not ((one >= other[0]) & (one <= other[-1])).any():
        return
    (found,) = compare(series(one, 3.0 * one - 1.0), series(other, 3.0 * other - 1.0))
    assert found.largest < 1e-14
    assert found.samples == np.count_nonzero((one >= other[0]) & (one <= other[-1]))


def test_what_only_one_of_them_covers_is_left_out() -> None:
    time = np.arange(0.0, 3.0, 0.5)
    beyond = np.where(time > 2.0, 100.0, time)
    (found,) = compare(series(time, beyond), series([0.5, 2.0], [0.5, 2.0]))
    assert (found.samples, found.largest) == (4, 0.0)


def test_columns_are_those_of_both_or_those_named_in_their_order() -> None:
    one = Recording({"time": [0.0, 1.0], "a": [0.0, 1.0], "b": [0.0, 1.0], "c": [1.0, 2.0]}, dict.fromkeys("abc", "1") | TIME)
    other = Recording({"time": [0.0, 1.0], "c": [1.0, 2.0], "a": [0.0, 3.0]}, dict.fromkeys("ca", "1") | TIME)
    assert [each.name for each in compare(one, other)] == ["a", "c"]
    assert [each.name for each in compare(one, other, ["c", "a"])] == ["c", "a"]


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1e-160, 1.0, 1e160, 8e307])
def test_sizes_whose_squares_are_no_numbers_are_compared_as_any_others(size: float) -> None:
    one, other = np.array([0.0, 1.0, 0.0, -1.0]), np.array([0.0, 0.0, 1.0, 0.0])
    (found,) = compare(series(range(4), size * one), series(range(4), size * other))
    assert (found.largest, found.correlation) == (size, 0.0)
    assert found.rms == pytest.approx(sqrt(0.75) * size, rel=1e-12) or size == 5e-324


def test_a_run_agrees_with_itself_and_follows_its_own_file(tmp_path: Any) -> None:
    drive = sw.Drive(load=sw.loads.Inertia(inertia=0.05))
    run = sw.simulate(drive, sw.scenario.sine(5.0, frequency=5.0, duration=0.2), sample=1e-3)
    run.to_csv(tmp_path / "run.csv")
    for each in compare(run, Recording.read(tmp_path / "run.csv")):
        assert (each.rms, each.largest) == (0.0, 0.0)
        assert each.correlation in (None, pytest.approx(1.0, abs=1e-12))


ONE = series([0.0, 1.0], [0.0, 1.0])


@pytest.mark.parametrize(
    ("attempt", "message"),
    [
        (lambda: compare(ONE, series([2.0, 3.0], [0.0, 1.0])),
         "the recordings have no time in common: 0 s to 1 s and 2 s to 3 s; shift the time of one"),
        (lambda: compare(ONE, series([0.4, 0.6], [0.0, 1.0])),
         "the recordings have no time in common: 0 s to 1 s and 0.4 s to 0.6 s; no sample of the first lies within"),
        (lambda: compare(ONE, series([0.0, 1.0], [0.0, 1.0], name="speed")), "the recordings have no column in common:"),
        (lambda: compare(ONE, Recording({"torque": [0.0]}, {"torque": "N.m"})), 'no column "time"; there are torque'),
        (lambda: compare(ONE, series([0.0, 1.0], [0.0, 1.0], "rad")),
         'column "torque": cannot convert "rad" to "N.m"; name the columns to compare'),
        (lambda: compare(ONE, ONE, ["speed"]), 'no column "speed"; there are time, torque'),
        (lambda: compare(ONE, ONE, []), "names = [] must name columns besides the time; there are time, torque"),
        (lambda: compare(ONE, ONE, ["time"]), "names = ['time'] must name columns besides the time"),
        (lambda: compare(ONE, ONE, "torque"), "names must be a list of names, not 'torque'"),
        (lambda: compare(ONE, sw.Gear()), "first is a recording, second a model; give two recordings, or two of gear,"),
        (lambda: compare(sw.Gear(), 3), "second = 3 must be a recording, a gear, a drive or a set"),
        (lambda: compare(sw.Gear(), sw.Gear(), ["torque"]), "names = ['torque']: of models all numbers are compared"),
        (lambda: compare(series([0.0, 1.0], [1.5e308, 0.0]), series([0.0, 1.0], [-1.5e308, 0.0])),
         'column "torque" differs by more than the largest number there is, at t = 0 s'),
    ],
)  # fmt: skip
def test_what_cannot_be_compared_is_refused(attempt: Callable[[], Any], message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=f"^{re.escape(message)}"):
        attempt()


# Models


def test_models_differ_where_numbers_and_laws_do() -> None:
    one = sw.Gear(stiffness=sw.stiffness.Cubic(a1=100.0, a3=0.0), damping=2.0)
    other = one.replace(damping=3.0, friction_input=sw.friction.Coulomb(coulomb=0.1))
    assert compare(one, other) == [
        Difference("gear.damping", 2.0, 3.0, "N.m.s/rad"),
        Difference("gear.friction_input", "viscous", "coulomb"),
    ]
    assert [str(each) for each in compare(one, other)] == [
        "gear.damping: 2 N.m.s/rad against 3 N.m.s/rad (+50 %)",
        "gear.friction_input: viscous against coulomb",
    ]


@settings(max_examples=sample(5, 15))
@given(drives)
def test_a_model_differs_from_itself_nowhere_and_a_changed_number_is_found(drive: sw.Drive) -> None:
    assert compare(drive, drive) == compare(drive.gear, drive) == []
    changed = drive.replace({"gear.damping": drive.gear.damping + 1.0, "gear.input_inertia": 0.5})
    found = {each.path: (each.first, each.second) for each in compare(drive, changed)}
    assert found["gear.damping"] == (drive.gear.damping, drive.gear.damping + 1.0)
    assert set(found) <= {"gear.damping", "gear.input_inertia"}


def test_laws_within_laws_and_sequences_of_other_lengths_are_compared_in_their_places() -> None:
    inner = made(sw.friction.Coulomb, coulomb=0.1, breakaway=0.1)
    warm = sw.Gear(friction_input=sw.friction.Thermal(law=inner, viscous_fall=0.02))
    warmer = warm.replace(friction_input=sw.friction.Thermal(law=inner.replace(viscous=1e-3), viscous_fall=0.03))
    assert [each.path for each in compare(warm, warmer)] == [
        "gear.friction_input.viscous_fall",
        "gear.friction_input.law.viscous",
    ]
    two, three = (
        sw.Gear(hysteresis=sw.hysteresis.MaxwellSlip(stiffness=k, breakaway=len(k) * [0.1]))
        for k in ([2.0, 1.0], [2.0, 1.5, 1.0])
    )
    assert [(each.path, each.first, each.second) for each in compare(two, three)] == [
        ("gear.hysteresis.stiffness[1]", 1.0, 1.5),
        ("gear.hysteresis.stiffness[2]", None, 1.0),
        ("gear.hysteresis.breakaway[2]", None, 0.1),
    ]


def test_parts_and_ratings_that_one_set_lacks_are_differences() -> None:
    gear = sw.GearSet.read("csg-25-100")
    whole = gear.with_parts(motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=1.0), source="assumed")
    assert compare(gear, whole) == [Difference("motor", None, "torque_source"), Difference("load", None, "inertia")]
    assert compare(gear.gear, whole) == []
    fast = Quantity(value=6000.0 / 60.0, unit="rev/s", source="assumed")
    heavier = gear.replace(ratings={**gear.ratings, "maximum_input_speed": fast, "tilting": fast})
    speed, tilting = compare(gear, heavier)
    assert (speed.path, speed.first, speed.second, speed.unit) == (
        "ratings.maximum_input_speed",
        5600.0,
        pytest.approx(6000.0),
        "rpm",
    )
    assert (tilting.path, tilting.first, tilting.second) == ("ratings.tilting", None, 100.0)
    wrong = gear.replace(ratings={"peak_torque": Quantity(value=1.0, unit="m", source="assumed")})
    with pytest.raises(ValueError, match=r'^ratings\.peak_torque: cannot convert "m" to "N\.m"$'):
        compare(gear, wrong)


def test_sources_are_no_part_of_the_comparison() -> None:
    gear = sw.GearSet.read("csg-25-100")
    renamed = gear.replace(name="other", sources=dict.fromkeys(gear.sources, Entry("assumed")))
    assert compare(gear, renamed) == []


def test_a_difference_is_as_uncertain_as_both_numbers_are() -> None:
    """Variances of independent numbers add. The difference has no deviation where one set states none."""
    gear = sw.GearSet.read("csg-25-100")
    path, k1, damping = "gear.stiffness.k1", gear.gear.stiffness.k1, gear.gear.damping
    one = gear.replace(sources={**gear.sources, path: Entry("log", uncertainty=300.0)})
    changed = gear.gear.replace({"stiffness.k1": k1 + 1000.0, "damping": 2.0 * damping})
    sources = {**gear.sources, path: Entry("log", uncertainty=400.0), "gear.damping": Entry("log", uncertainty=0.1)}
    found = {each.path: each for each in compare(one, gear.replace(gear=changed, sources=sources))}
    assert found[path].sigma == pytest.approx(500.0)
    assert found[path].deviations == pytest.approx(2.0)
    assert found["gear.damping"].deviations is None
    assert compare(one.gear, changed)[0].sigma is None


@pytest.mark.parametrize(
    ("difference", "text"),
    [
        (Difference("a", 1.0, 1.0 + 1e-9, "m"), "a: 1 m against 1.000000001 m (+1e-07 %)"),
        (Difference("a", 0.1, 0.1 + 2e-17, "m"), "a: 0.10000000000000001 m against 0.10000000000000002 m (+1.39e-14 %)"),
        (Difference("a", 0.0, 2.0, "1"), "a: 0 against 2"),
        (Difference("a", 200, 160, "1"), "a: 200 against 160 (-20 %)"),
        (Difference("a", -2.0, -1.0), "a: -2 against -1 (-50 %)"),
        (Difference("a", None, 1.0, "m"), "a: nothing against 1 m"),
        (Difference("a", "input", "output"), "a: input against output"),
        (Difference("a", 1e-300, 1e300), "a: 1e-300 against 1e+300"),
        (Difference("a", 2.0, 1.0, "m", 0.25), "a: 2 m against 1 m (-50 %, -4 σ)"),
        (Difference("a", 0.0, 1.0, "m", 0.5), "a: 0 m against 1 m (+2 σ)"),
    ],
)
def test_a_difference_in_one_line(difference: Difference, text: str) -> None:
    assert str(difference) == text


def test_an_agreement_in_one_line() -> None:
    assert str(Agreement("a", "rad", 0.1, 0.2, 3.0, 0.5, 7)) == "a: rms 0.1 rad, largest 0.2 rad at t = 3 s, correlation 0.5"


def test_phases_are_within_half_a_turn_and_a_whole_turn_is_no_difference() -> None:
    def gear(*phase: float) -> sw.Gear:
        error = sw.kinematic_error.Fourier(order=[1.0, 2.0], amplitude=[1e-4, 2e-4], phase=phase)
        return sw.Gear(kinematic_error=error)

    assert compare(gear(0.3, 7.0), gear(0.3 + 2.0 * pi, 7.0 - 4.0 * pi)) == []
    (difference,) = compare(gear(0.3, 3.1), gear(0.3, -3.1))
    assert (difference.first, difference.second, difference.change) == (pytest.approx(3.1), pytest.approx(-3.1), None)
    assert replace(difference, sigma=0.1).deviations == pytest.approx((2.0 * pi - 6.2) / 0.1)
    (difference,) = compare(gear(0.3, -pi), gear(0.3, 9.0))
    assert (difference.first, difference.second) == (pytest.approx(pi), pytest.approx(9.0 - 2.0 * pi))
