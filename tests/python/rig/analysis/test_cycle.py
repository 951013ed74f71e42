"""Loops of gear models: against closed forms of one Maxwell element beside a spring, and document T's row 0 degrees."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.rig.analysis.cycle import Factors, cycle, cycle_to, scaled
from strainwave.rig.virtual.printed import PEAK_TORQUE, printed_gear

K, ELEMENT, SLIP = 800.0, 400.0, 2.0  # N.m/rad, N.m/rad, N.m


def one_element(**parts: object) -> sw.Gear:
    law = sw.hysteresis.MaxwellSlip(stiffness=[ELEMENT], breakaway=[SLIP])
    return sw.Gear(stiffness=sw.stiffness.Linear(k=K), hysteresis=law, **parts)  # type: ignore[arg-type]


@pytest.mark.parametrize("torque", [7.0, 12.0, 40.0])
def test_a_loop_of_one_element_is_the_closed_form(torque: float) -> None:
    """Beyond its slip the element holds F: the twist is (T - F)/k, the area 4 F (x - F/k_1), the width at zero torque 2 F/k."""
    loop = cycle_to(one_element(), torque)
    twist = (torque - SLIP) / K
    assert loop.peak == torque
    assert loop.angle.max() == pytest.approx(twist, rel=1e-12)
    assert loop.area == pytest.approx(4.0 * SLIP * (twist - SLIP / ELEMENT), rel=1e-4)
    assert loop.stiffness == pytest.approx(torque / twist, rel=1e-12)


def test_the_loop_is_as_wide_as_all_elements_hold_over_the_spring() -> None:
    loop = cycle_to(one_element(), 40.0)
    assert loop.width_at_zero == pytest.approx(2.0 * SLIP / K, rel=1e-9)
    assert loop.width == pytest.approx(2.0 * SLIP / K, rel=1e-9)


def test_below_its_slip_a_gear_loses_nothing() -> None:
    """All of it then acts as one spring of stiffness k + k_1."""
    loop = cycle_to(one_element(), 0.99 * SLIP * (K + ELEMENT) / ELEMENT)
    assert loop.area == pytest.approx(0.0, abs=1e-15)
    for slope in (loop.stiffness, loop.high_stiffness, loop.low_stiffness):
        assert slope == pytest.approx(K + ELEMENT, rel=1e-9)


def test_document_t_loop_has_the_width_and_loss_of_its_closed_row() -> None:
    """50.5 degrees and 0.3063483432 J, by a polygon of its vertices; slopes of unloading as printed."""
    loop = cycle_to(printed_gear(0), PEAK_TORQUE, side="input")
    assert np.degrees(loop.width) == pytest.approx(50.5, abs=1e-6)
    assert loop.area == pytest.approx(0.3063483432, rel=1e-5)
    assert loop.high_stiffness == pytest.approx(2.0 / (1.0 / 4.51 + 1.0 / 4.85), rel=1e-9)


@pytest.mark.parametrize("gain", [0.1, 0.5])
def test_friction_at_the_input_raises_the_loop_by_two_of_it_and_leaves_each_slope(gain: float) -> None:
    """At the same elastic torque every point moves by the friction alone."""
    friction = 0.05
    gear = one_element(
        friction_input=sw.friction.Coulomb(coulomb=friction), kinematics=sw.kinematics.PlainRatio(reduction=50.0)
    )
    loops = [cycle(gear, 20.0, side="input", factors=Factors(friction=factor)) for factor in (1.0, 1.0 + gain)]
    turn = int(np.argmin(loops[0].elastic))
    assert np.array_equal(loops[0].angle, loops[1].angle)
    moved = loops[1].torque - loops[0].torque
    assert moved[2:turn] == pytest.approx(-gain * friction, rel=1e-12)
    assert moved[turn + 2 :] == pytest.approx(gain * friction, rel=1e-12)
    taken = loops[1].area - loops[0].area
    assert taken == pytest.approx(2.0 * gain * friction * np.ptp(loops[0].angle), rel=1e-3)


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5, 0.7])
def test_under_a_given_torque_the_area_of_dry_friction_is_largest_at_half_of_it(share: float) -> None:
    """A spring k/i^2 at the input with friction F under T: 4 F (T - F) i^2/k."""
    torque, ratio, stiffness = 1.0, 50.0, 1e4
    gear = sw.Gear(
        stiffness=sw.stiffness.Linear(k=stiffness),
        kinematics=sw.kinematics.PlainRatio(reduction=ratio),
        friction_input=sw.friction.Coulomb(coulomb=share * torque),
    )
    loop = cycle_to(gear, torque, side="input")
    assert loop.peak == pytest.approx(torque, rel=1e-9)
    assert loop.area == pytest.approx(4.0 * share * (1.0 - share) * torque**2 * ratio**2 / stiffness, rel=1e-9)


def test_friction_that_holds_all_of_the_torque_is_refused() -> None:
    gear = one_element(friction_input=sw.friction.Coulomb(coulomb=2.0))
    with pytest.raises(ValueError, match=r"peak = 1\.5 N\.m does not turn the input: its friction holds as much"):
        cycle_to(gear, 1.5, side="input")


def test_a_gear_of_stages_is_refused() -> None:
    with pytest.raises(ValueError, match="the gear has stages that move by themselves"):
        cycle(sw.load("tilt-actuator").gear, 10.0)


SPRINGS = [
    sw.stiffness.Linear(k=1e4),
    sw.stiffness.Piecewise(k1=1e4, k2=5e3, knee=1e-3),
    sw.stiffness.ThreeSegment(k1=1e4, k2=2e4, k3=3e4, t1=5.0, t2=20.0),
    sw.stiffness.Cubic(a1=1e4, a3=1e9),
    sw.stiffness.MultiCompliance(
        flexspline_stiffness=8000.0,
        flexspline_hardening=0.02,
        wave_generator_stiffness=2.0,
        wave_generator_hardening=1.5,
        reduction=100.0,
    ),
    sw.stiffness.Backlash(clearance=1e-3),
]
MEMORIES = [
    sw.hysteresis.MaxwellSlip(stiffness=[5e3, 1e3], breakaway=[1.0, 2.0]),
    sw.hysteresis.FadingMemory(stiffness=[1000.0], forgetting=[2000.0]),
    sw.hysteresis.BoucWen(stiffness=5e3, saturation=2.0),
    printed_gear(0).hysteresis,
]


@pytest.mark.parametrize("law", SPRINGS, ids=lambda law: law.name)
def test_a_scaled_spring_has_the_torque_times_the_factor_at_every_twist(law: object) -> None:
    gear = sw.Gear(stiffness=law)  # type: ignore[arg-type]
    twist = np.linspace(-2e-3, 2e-3, 41)
    factor = 1.3
    assert scaled(gear, Factors(stiffness=factor)).trace(twist) == pytest.approx(
        factor * gear.trace(twist), rel=1e-10, abs=1e-12
    )


@pytest.mark.parametrize("law", MEMORIES, ids=lambda law: law.name)
def test_a_scaled_memory_has_the_torque_times_the_factor_along_every_path(law: object) -> None:
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1.0), hysteresis=law)  # type: ignore[arg-type]
    path = 4e-3 * np.sin(np.linspace(0.0, 12.0, 60)) * np.linspace(1.0, 0.2, 60)
    of_spring = 1.0 * path
    scaled_torque = scaled(gear, Factors(hysteresis=0.7)).trace(path) - of_spring
    assert scaled_torque == pytest.approx(0.7 * (gear.trace(path) - of_spring), rel=1e-9, abs=1e-12)
