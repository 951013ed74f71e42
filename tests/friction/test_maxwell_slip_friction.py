"""The generalized Maxwell-slip law: sticks as springs do, slips with a lag, and what energy that costs."""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from strainwave.friction import MaxwellSlipFriction
from strainwave.hysteresis import MaxwellSlip

from tests.support.strategies import made

STIFFNESS, SHARE = [60.0, 30.0, 10.0], [0.2, 0.3, 0.5]
COULOMB, BREAKAWAY, STRIBECK_SPEED, ATTRACTION, VISCOUS = 0.05, 0.07, 0.1, 0.5, 4e-4
JUMP = 1e-12  # s, over which the speed goes from one value to the next


def contact(**changed: Any) -> MaxwellSlipFriction:
    """The elements of the published numbers; their Stribeck fall is warned of, which is not the matter here."""
    fields: dict[str, Any] = {
        "stiffness": STIFFNESS,
        "share": SHARE,
        "coulomb": COULOMB,
        "breakaway": BREAKAWAY,
        "stribeck_speed": STRIBECK_SPEED,
        "attraction": ATTRACTION,
        "viscous": VISCOUS,
    }
    with warnings.catch_warnings(action="ignore", category=sw.PassivityWarning):
        return MaxwellSlipFriction(**(fields | changed))


def level(speed: float) -> float:
    return COULOMB + (BREAKAWAY - COULOMB) * math.exp(-((speed / STRIBECK_SPEED) ** 2))


def run(law: MaxwellSlipFriction, legs: list[tuple[float, float]], samples: int = 2) -> tuple[NDArray[Any], NDArray[Any]]:
    """Time [s] and dry torque [N.m], both of shape (legs, samples), over legs of constant speed [rad/s] and duration [s]."""
    ends = np.cumsum([duration for _, duration in legs])
    starts = np.append(0.0, ends[:-1] + JUMP)
    time = np.linspace(starts, ends, samples, axis=1)
    speed = np.repeat([speed for speed, _ in legs], samples)
    torque = law.trace(time.ravel(), speed) - law.viscous * speed
    return time, torque.reshape(time.shape)


def work(law: MaxwellSlipFriction, legs: list[tuple[float, float]], samples: int = 4001) -> NDArray[np.float64]:
    """Work [J] put into dry friction up to the end of each leg."""
    time, torque = run(law, legs, samples)
    speed = np.array([speed for speed, _ in legs])
    return np.cumsum(np.trapezoid(torque * speed[:, None], time, axis=1))


fall_free = contact(breakaway=COULOMB)
paths = st.lists(st.floats(-3e-3, 3e-3), min_size=2, max_size=12)  # rad
legs = st.lists(
    st.tuples(st.floats(-4.0, 0.0).map(lambda e: 10.0**e), st.floats(1e-5, 5e-3), st.sampled_from([-1.0, 1.0])).map(
        lambda drawn: (drawn[2] * drawn[0], drawn[1] / drawn[0])  # speed, and the time for so many radians
    ),
    min_size=1,
    max_size=8,
)


def test_steady_sliding_follows_the_stribeck_curve() -> None:
    assert contact().steady(0.05) == pytest.approx(0.0655960156614281, rel=1e-14)
    curve = sw.friction.Stribeck(coulomb=COULOMB, breakaway=BREAKAWAY, stribeck_speed=STRIBECK_SPEED, viscous=VISCOUS)
    speed = np.array([-30.0, -0.2, -1e-3, 1e-6, 0.1, 5.0])
    np.testing.assert_allclose(contact().steady(speed), curve.steady(speed), rtol=1e-14)


def test_after_a_step_in_speed_the_torque_lags() -> None:
    torque = contact().trace([0.0, 100.0, 100.0 + JUMP, 100.1], [0.05, 0.05, 0.5, 0.5])
    assert torque[-1] == pytest.approx(0.05593009593741121, rel=1e-12)


@given(paths)
def test_without_a_stribeck_fall_it_is_maxwell_slip(path: list[float]) -> None:
    """Whatever the attraction: nothing draws an element away from a level that does not move."""
    twist = np.append(0.0, path)
    expected = MaxwellSlip(stiffness=STIFFNESS, breakaway=[COULOMB * share for share in SHARE]).trace(twist)
    speed = np.diff(twist) / 0.5
    for attraction in (1e-3, 1e12):
        law = contact(breakaway=COULOMB, attraction=attraction, viscous=0.0)
        time, torque = run(law, [(v, 0.5) for v in speed.tolist()])
        assert time.shape == torque.shape
        np.testing.assert_allclose(torque[:, -1], expected[1:], rtol=0.0, atol=1e-11)


def test_a_strong_attraction_leaves_no_lag() -> None:
    law = contact(attraction=1e9)
    speeds = [0.01, 0.3, 0.05, 0.02, 1.0]
    _, torque = run(law, [(0.01, 10.0)] + [(speed, 1e-5) for speed in speeds])
    np.testing.assert_allclose(torque[1:, -1], [level(speed) for speed in speeds], rtol=1e-12)


def test_a_virgin_contact_is_as_stiff_as_all_its_elements_together() -> None:
    _, torque = run(contact(), [(1e-3, 1e-2)])  # 1e-5 rad
    assert torque[0, -1] == pytest.approx(sum(STIFFNESS) * 1e-5, rel=1e-12)


def test_a_contact_at_rest_keeps_its_torque_and_sticks_when_it_goes_on() -> None:
    """It slid at its kinetic level; after a stop it has to break away again, at the level of creeping."""
    law = contact(stiffness=[20.0], share=[1.0])
    _, torque = run(law, [(1.0, 5.0), (0.0, 100.0), (1e-3, 0.5), (1e-3, 10.0)])
    assert torque[0, -1] == pytest.approx(COULOMB, rel=1e-12)
    assert torque[1, -1] == torque[1, 0] == pytest.approx(torque[0, -1], rel=1e-10)
    assert torque[2, -1] == pytest.approx(COULOMB + 20.0 * 5e-4, rel=1e-10)
    assert torque[3, -1] == pytest.approx(level(1e-3), rel=1e-12)


def test_an_element_that_carries_more_than_a_faster_motion_holds_slips_down_from_there() -> None:
    law = contact(stiffness=[20.0], share=[1.0])
    carried = 20.0 * 3.2e-3
    assert level(1.0) < carried < level(0.01)
    _, torque = run(law, [(0.01, 0.32), (1.0, 0.04)])
    assert torque[0, -1] == pytest.approx(carried, rel=1e-12)
    expected = COULOMB + (carried - COULOMB) * math.exp(-ATTRACTION * 0.04 / COULOMB)
    assert torque[1, -1] == pytest.approx(expected, rel=1e-9)


def test_an_element_on_the_way_back_is_unloaded_by_its_stiffness_however_fast() -> None:
    """It carries more than the fast motion holds, but against it."""
    law = contact(stiffness=[20.0], share=[1.0])
    _, torque = run(law, [(0.01, 5.0), (-1.0, 1e-3), (-1.0, 0.1)])
    assert torque[0, -1] == pytest.approx(level(0.01), rel=1e-12)
    assert torque[1, -1] == pytest.approx(level(0.01) - 20.0 * 1e-3, rel=1e-9)
    assert torque[2, -1] == pytest.approx(-COULOMB, rel=1e-12)


def by_events(stiffness: float, share: float, legs: list[tuple[float, float]]) -> list[float]:
    """One element by an adaptive solver that stops where it starts to slip: the torque [N.m] at the end of each leg."""
    torque, slipping, ends = 0.0, False, []
    for speed, duration in legs:
        sense, limit = math.copysign(1.0, speed), share * level(speed)
        slipping = sense * torque >= limit * (1.0 - 1e-13) or (slipping and sense * torque >= 0.0)
        left = duration
        if not slipping:

            def full(_: float, f: Any, sense: float = sense, limit: float = limit) -> float:
                return float(sense * f[0] - limit)

            full.terminal = True  # type: ignore[attr-defined]
            path = solve_ivp(lambda _, f, v=speed: [stiffness * v], (0.0, left), [torque], events=full, rtol=1e-12, atol=1e-15)
            torque, slipping = float(path.y[0, -1]), path.status == 1
            left -= float(path.t[-1])
        if slipping and left > 0.0:

            def drawn(_: float, f: Any, sense: float = sense, speed: float = speed) -> Any:
                return sense * ATTRACTION * (share - sense * f / level(speed))

            torque = float(solve_ivp(drawn, (0.0, left), [torque], rtol=1e-12, atol=1e-15).y[0, -1])
        ends.append(torque)
    return ends


def test_any_sequence_of_sticking_and_slipping_is_exact() -> None:
    legs = [
        (0.01, 0.05),
        (0.04, 0.1),
        (0.5, 0.05),
        (0.02, 0.2),
        (-0.02, 0.03),
        (-0.3, 0.02),
        (-0.01, 0.05),
        (0.02, 0.03),
        (0.2, 0.1),
    ]
    expected = np.sum([by_events(k, share, legs) for k, share in zip(STIFFNESS, SHARE, strict=True)], axis=0)
    _, torque = run(contact(), legs)
    np.testing.assert_allclose(torque[:, -1], expected, rtol=0.0, atol=1e-11)


@given(legs, st.integers(2, 30))
def test_a_path_and_not_its_sampling_decides(legs: list[tuple[float, float]], samples: int) -> None:
    (_, coarse), (_, fine) = (run(contact(), legs, n) for n in (2, samples))
    np.testing.assert_allclose(fine[:, -1], coarse[:, -1], rtol=0.0, atol=1e-11)


@given(legs)
def test_no_motion_carries_more_than_breakaway(legs: list[tuple[float, float]]) -> None:
    _, torque = run(contact(), legs, 50)
    assert np.abs(torque).max() <= BREAKAWAY * (1.0 + 1e-14)


@given(legs)
def test_without_a_stribeck_fall_no_path_from_rest_yields_work(legs: list[tuple[float, float]]) -> None:
    assert work(fall_free, legs).min() >= -1e-9 * COULOMB


@given(st.floats(1e-3, 0.2), st.floats(0.1, 100.0))
def test_a_sine_costs_work_in_every_cycle(amplitude: float, frequency: float) -> None:
    """With the Stribeck fall, in the cycle that motion settles on."""
    time = np.linspace(0.0, 5.0, 20001) / frequency
    speed = 2.0 * math.pi * frequency * amplitude * np.cos(2.0 * math.pi * frequency * time)
    power = contact(viscous=0.0).trace(time, speed) * speed
    assert np.trapezoid(power[-4001:], time[-4001:]) > 0.0


def test_a_stribeck_fall_can_create_energy_and_is_warned_of() -> None:
    """Slip fast, slow down until the element carries more, go back while it sticks, and fast forward to where it was."""
    stiffness = 20.0
    with pytest.warns(sw.PassivityWarning, match="breakaway"):
        made(MaxwellSlipFriction, stiffness=[stiffness], share=[1.0], coulomb=COULOMB, breakaway=BREAKAWAY).check()
    law = contact(stiffness=[stiffness], share=[1.0], viscous=0.0)
    back = (BREAKAWAY - COULOMB) / stiffness
    cycle = [(1e-9, 10.0), (-1e-3, back / 1e-3), (1.0, back)]
    put_in = work(law, [(1.0, 1.0), *cycle])
    assert put_in[-1] - put_in[0] == pytest.approx(-((BREAKAWAY - COULOMB) ** 2) / (2.0 * stiffness), rel=1e-3)


def test_without_a_stribeck_fall_or_without_elements_there_is_no_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error", sw.PassivityWarning)
        made(MaxwellSlipFriction).check()
        made(MaxwellSlipFriction, coulomb=0.03, breakaway=0.05).check()
        made(MaxwellSlipFriction, stiffness=[20.0], share=[1.0], coulomb=0.03, breakaway=0.03).check()


def test_a_breakaway_below_coulomb_counts_as_coulomb() -> None:
    legs = [(0.01, 0.3), (-0.5, 0.1), (0.02, 0.05)]
    (_, lower), (_, equal) = (run(contact(breakaway=breakaway), legs, 20) for breakaway in (0.01, COULOMB))
    assert lower.tolist() == equal.tolist()


def test_no_elements_is_no_dry_friction() -> None:
    law = made(MaxwellSlipFriction, viscous=0.01)
    assert law.steady(3.0) == pytest.approx(0.03, rel=1e-15)


@given(st.floats(0.01, 100.0))
def test_shares_are_relative_to_their_sum(factor: float) -> None:
    legs = [(0.01, 0.3), (-0.5, 0.1), (0.02, 0.05)]
    (_, one), (_, other) = (run(contact(share=share), legs) for share in (SHARE, [factor * a for a in SHARE]))
    np.testing.assert_allclose(other, one, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize(
    ("stiffness", "share", "message"),
    [([10.0, 20.0], [1.0], "equally many"), ([10.0], [0.0], "share"), ([0.0], [1.0], "stiffness"), ([10.0], [-1.0], "share")],
)
def test_what_makes_no_sense_is_refused(stiffness: list[float], share: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        made(MaxwellSlipFriction, stiffness=stiffness, share=share)
