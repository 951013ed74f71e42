"""Friction inside the multi-compliance model against the play operator under torque, the erratum's numbers, and its limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.optimize import brentq
from strainwave.hysteresis import FrictionalWindup, MaxwellSlip
from strainwave.stiffness import Linear, MultiCompliance

from tests.support.strategies import log_uniform

Array = NDArray[np.float64]

SPRINGS = MultiCompliance(
    flexspline_stiffness=8000.0,
    flexspline_hardening=0.02,
    wave_generator_stiffness=2.0,
    wave_generator_hardening=1.5,
    reduction=100.0,
)
LAW = FrictionalWindup(springs=SPRINGS, friction=5.0)

hardenings = st.just(0.0) | log_uniform(1e-3, 1e-1)
springs = st.builds(
    MultiCompliance,
    flexspline_stiffness=log_uniform(1e3, 1e5),
    flexspline_hardening=hardenings,
    wave_generator_stiffness=log_uniform(1e-1, 1e1),
    wave_generator_hardening=st.just(0.0) | log_uniform(1e-2, 1e1),
    reduction=st.floats(30.0, 320.0),
)
laws = st.builds(FrictionalWindup, springs=springs, friction=st.just(0.0) | log_uniform(1e-2, 1e2))
loads = st.lists(st.floats(-50.0, 50.0).map(lambda torque: round(torque, 6)), min_size=1, max_size=12)


def flexed(springs: MultiCompliance, torque: float) -> float:
    """delta_f: the flexspline's share of the twist."""
    hardening = springs.flexspline_hardening
    return (math.atan(hardening * torque) / hardening if hardening else torque) / springs.flexspline_stiffness


def wound(springs: MultiCompliance, torque: float) -> float:
    """x: the wave generator's, under a torque at the output."""
    hardening, ratio = springs.wave_generator_hardening / springs.reduction, springs.reduction
    magnitude = -math.expm1(-hardening * abs(torque)) / hardening if hardening else abs(torque)
    return math.copysign(magnitude, torque) / (ratio**2 * springs.wave_generator_stiffness)


def played(torques: Array, friction: float) -> Array:
    """The torque of the wave generator's spring under these: it follows as through play."""
    held, found = 0.0, []
    for torque in torques:
        held = min(max(held, torque - friction), torque + friction)
        found.append(held)
    return np.array(found)


def twists(law: FrictionalWindup, torques: Array) -> Array:
    """What the erratum makes of a path of torques."""
    spring = played(torques, law.friction)
    return np.array([flexed(law.springs, t) + wound(law.springs, w) for t, w in zip(torques, spring, strict=True)])


def flexspline_stiffness(law: FrictionalWindup, torque: float) -> float:
    """Of the flexspline alone [N.m/rad]."""
    return law.springs.flexspline_stiffness * (1.0 + (law.springs.flexspline_hardening * torque) ** 2)


def rounding(law: FrictionalWindup, torques: Array) -> float:
    """Of the twists of such a path, as torques [N.m]."""
    largest = float(np.abs(torques).max())
    return 1e-14 * (largest + law.friction + flexspline_stiffness(law, largest) * float(np.abs(twists(law, torques)).max()))


# The erratum's numbers


CYCLE = np.array([20.0, 0.0, -20.0, 0.0, 20.0])


def test_a_cycle_loses_what_the_erratum_says() -> None:
    """4 F x(T - F), of E-R14: 13.432 mJ."""
    work = LAW.work(np.append(0.0, twists(LAW, CYCLE)))
    assert work[-1] - work[1] == pytest.approx(4.0 * 5.0 * wound(SPRINGS, 15.0), rel=1e-12)
    assert work[-1] - work[1] == pytest.approx(0.013432, abs=5e-7)


def test_the_twist_that_is_left_without_torque_is_what_friction_holds() -> None:
    """x(F), of E-R14: 0.241 mrad."""
    twist = twists(LAW, CYCLE)[1]
    assert twist == pytest.approx(wound(SPRINGS, 5.0), rel=1e-12)
    assert twist == pytest.approx(0.000241, abs=5e-7)
    torque = LAW.trace(np.append(0.0, twists(LAW, CYCLE)))
    assert torque == pytest.approx(np.append(0.0, CYCLE), abs=1e-12)


def test_the_loop_is_as_wide_as_the_erratum_on_friction_at_the_wrong_shaft_says() -> None:
    """2 F / (N^2 K_w0) without hardening, F = 100 x 0.05 N.m, of E-R13: 1.72 arcmin, whatever the flexspline."""
    law = LAW.replace(springs=SPRINGS.replace(wave_generator_hardening=0.0))
    width = 2.0 * twists(law, CYCLE)[1]
    assert law.trace([0.0, twists(law, CYCLE)[0], 0.5 * width, -0.5 * width])[2] == pytest.approx(0.0, abs=1e-12)
    assert math.degrees(width) * 60.0 == pytest.approx(1.72, abs=5e-3)


# The law itself


@given(laws, loads)
def test_torque_is_the_one_under_which_the_play_has_that_twist(law: FrictionalWindup, load: list[float]) -> None:
    torques = np.append(0.0, load)
    assert law.trace(twists(law, torques)) == pytest.approx(torques, rel=0.0, abs=rounding(law, torques))


@given(laws, loads)
def test_what_is_lost_is_friction_times_slip(law: FrictionalWindup, load: list[float]) -> None:
    """Work less what the springs hold; their energies by quadrature are those of MultiCompliance, which has its own test."""
    torques = np.append(0.0, load)
    path, spring = twists(law, torques), played(torques, law.friction)
    slip = np.abs(np.diff([wound(law.springs, w) for w in spring]))
    lost = law.work(path) - law.stored(path)
    energy = rounding(law, torques) * float(np.abs(np.diff(path)).sum() + np.abs(path).max()) + 1e-300
    assert lost == pytest.approx(np.append(0.0, np.cumsum(law.friction * slip)), rel=1e-12, abs=10.0 * energy)


@given(laws, loads)
def test_a_closed_loop_of_any_shape_costs_the_area_it_encloses(law: FrictionalWindup, load: list[float]) -> None:
    """Passivity: gone through until the wave generator comes back to where it was, it gives nothing back."""
    torques = np.tile(np.append(load, -np.array(load)), 3)
    path = np.append(0.0, twists(law, torques))
    work, period = law.work(path), 2 * len(load)
    slip = np.abs(np.diff([wound(law.springs, w) for w in played(torques, law.friction)]))[-period:].sum()
    energy = rounding(law, torques) * float(np.abs(np.diff(path)).sum())
    assert work[-1] - work[-1 - period] == pytest.approx(law.friction * slip, rel=1e-12, abs=10.0 * energy)
    assert np.diff(work - law.stored(path)).min() >= -energy


@given(laws, st.floats(1.0, 50.0), st.floats(1e-3, 1.0))
def test_while_it_sticks_it_is_its_flexspline(law: FrictionalWindup, load: float, share: float) -> None:
    """After a reversal, until the torque is the friction below that of the wave generator's spring, which stays as it was."""
    spring = played(np.array([load]), law.friction)[0]
    back = load + share * (spring - law.friction - load)
    path = [0.0, *(flexed(law.springs, torque) + wound(law.springs, spring) for torque in (load, back))]
    assert law.trace(path) == pytest.approx([0.0, load, back], rel=0.0, abs=rounding(law, np.array([0.0, load, back])))


@pytest.mark.parametrize("load", [0.0, 3.0, 20.0, -40.0])
def test_after_a_reversal_it_is_as_stiff_as_its_flexspline(load: float) -> None:
    """K_f0 (1 + (C_f T)^2), by a difference quotient."""
    state = LAW.advance([0.0, *twists(LAW, np.array([load]))])
    step = -1e-9 * math.copysign(1.0, load)
    slope = (LAW.trace([0.0, step], state=state)[1] - load) / step
    assert slope == pytest.approx(flexspline_stiffness(LAW, load), rel=1e-5)


def test_while_it_slips_both_give_way() -> None:
    """1/K = 1/K_f(T) + 1/(N^2 K_w(T - F)), by a difference quotient."""
    state = LAW.advance([0.0, *twists(LAW, np.array([20.0]))])
    slope = (LAW.trace([0.0, 1e-9], state=state)[1] - 20.0) / 1e-9
    soft = math.exp(-1.5 * 15.0 / 100.0) / (100.0**2 * 2.0)
    assert slope == pytest.approx(1.0 / (1.0 / flexspline_stiffness(LAW, 20.0) + soft), rel=1e-5)


# Its limits


@given(springs, st.lists(st.floats(-0.9, 0.9), min_size=1, max_size=6))
def test_without_friction_it_is_the_elastic_spring(springs: MultiCompliance, shares: list[float]) -> None:
    reach = springs.twist(50.0)
    path = np.append(0.0, reach * np.array(shares))
    law = FrictionalWindup(springs=springs, friction=0.0)
    stiffest = springs.flexspline_stiffness * (1.0 + (50.0 * springs.flexspline_hardening) ** 2)
    slack = 1e-13 * (50.0 + stiffest * reach)
    assert law.trace(path) == pytest.approx(springs.torque(path), rel=0.0, abs=slack)
    assert law.work(path) == pytest.approx(springs.energy(path), rel=0.0, abs=slack * reach)


@given(springs, st.lists(st.floats(-50.0, 50.0), min_size=1, max_size=6))
def test_with_friction_that_nothing_overcomes_it_is_the_flexspline(springs: MultiCompliance, load: list[float]) -> None:
    torques = np.append(0.0, load)
    path = np.array([flexed(springs, torque) for torque in torques])
    law = FrictionalWindup(springs=springs, friction=1e30)
    slack = 1e-14 * (
        50.0 + springs.flexspline_stiffness * (1.0 + (50.0 * springs.flexspline_hardening) ** 2) * np.abs(path).max()
    )
    assert law.trace(path) == pytest.approx(torques, rel=0.0, abs=slack)
    assert not law.advance(path).windup_torque


@given(log_uniform(1e3, 1e5), log_uniform(1e-1, 1e1), log_uniform(1e-1, 1e1), loads)
def test_without_hardening_it_is_one_maxwell_element_beside_a_spring(
    flexspline: float, wave_generator: float, friction: float, load: list[float]
) -> None:
    """Of K = K_f K_w / (K_f + K_w) the spring, of K_f - K the element, which slips at F (K_f - K) / K_f."""
    linear = SPRINGS.replace(flexspline_stiffness=flexspline, flexspline_hardening=0.0, wave_generator_hardening=0.0)
    law = FrictionalWindup(springs=linear.replace(wave_generator_stiffness=wave_generator), friction=friction)
    path = twists(law, np.append(0.0, load))
    at_output = 100.0**2 * wave_generator
    both = flexspline * at_output / (flexspline + at_output)
    element = MaxwellSlip(stiffness=[flexspline - both], breakaway=[friction * (flexspline - both) / flexspline])
    slack = 1e-13 * (flexspline * np.abs(path).max() + friction)
    assert law.trace(path) == pytest.approx(both * path + element.trace(path), rel=0.0, abs=slack)
    work = 0.5 * both * path**2 + element.work(path)
    assert law.work(path) == pytest.approx(work, rel=0.0, abs=slack * (np.abs(np.diff(path)).sum() + 1e-300))


def test_far_beyond_what_the_springs_can_bear_the_torque_stays_what_it_is_at_most() -> None:
    """1e6 / C_f, as that of the springs themselves in a run; back and forth nothing is lost but by friction."""
    path = [0.0, 0.05, 0.1, 0.0, 0.1]
    torque, lost = LAW.trace(path), LAW.work(path) - LAW.stored(path)
    assert torque[[1, 2, 4]] == pytest.approx(1e6 / 0.02, rel=1e-15)
    untwisted = brentq(lambda t: flexed(SPRINGS, t) + wound(SPRINGS, t + 5.0), -5.0, 0.0, xtol=1e-12)
    slip = 1.0 / 300.0 - wound(SPRINGS, untwisted + 5.0)
    assert lost[4] - lost[2] == pytest.approx(2.0 * 5.0 * slip, abs=1e-15 * float(LAW.work(path).max()))


# In a gear


def gear(**changed: float) -> sw.Gear:
    kinematics = sw.kinematics.PlainRatio(reduction=100.0)
    return sw.Gear(kinematics=kinematics, stiffness=Linear(k=1e-30), hysteresis=LAW.replace(**changed))


def test_in_a_gear_without_another_spring_it_is_the_gear() -> None:
    torques = np.append(0.0, CYCLE)
    assert gear().trace(twists(LAW, torques)) == pytest.approx(torques, abs=1e-12)
    assert gear().twist(torques) == pytest.approx(twists(LAW, torques), rel=1e-12, abs=1e-16)
