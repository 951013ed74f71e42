"""Assumed figures of the sets, against the rule that docs/reference/catalogue.md states for each."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st

from tests.python.catalogue.makers import (
    ACCURACY,
    ARCMIN,
    BACKDRIVING_TORQUE,
    CPL_RATIO_CORRECTION,
    CPL_RUNNING,
    CPL_SPEED,
    CPL_STARTING,
    HYSTERESIS_LOSS,
    LOST_MOTION,
    RATED,
    ROUNDING,
    ROUNDING_K1,
    SETS,
    STARTING_TORQUE,
    column,
    every_set,
    figures,
    identity,
)
from tests.python.catalogue.torsion import Torsion

# --- hysteresis ---


def rated_torque(name: str) -> float:
    """Rated torque; for HFUC without ratings that of CSG, which the maker rates 30 % higher, less 30 %."""
    rated, part = (name, 1.0) if name in RATED else (name.replace("hfuc", "csg"), 1.0 / 1.3)
    return part * float(figures(rated, "ratings", "rated_torque")[0])


@pytest.mark.slow("files")
@every_set
def test_hysteresis_loss_after_rated_torque_is_half_the_makers_bound(name: str) -> None:
    half_bound = 0.5 * HYSTERESIS_LOSS[column(name)] * ARCMIN
    assert Torsion.of(name).hysteresis_loss(rated_torque(name)) == pytest.approx(half_bound, rel=ROUNDING)


@pytest.mark.slow("files")
@every_set
def test_lost_motion_at_four_percent_of_rated_torque_is_within_the_makers_bound(name: str) -> None:
    positive, _, negative, _, _ = Torsion.of(name).cycle(0.04 * rated_torque(name))
    assert 0.0 < positive.twist - negative.twist < LOST_MOTION * ARCMIN


@every_set
def test_every_element_slips_below_rated_torque_and_holds_an_equal_share(name: str) -> None:
    torsion = Torsion.of(name)
    assert torsion.breakaway.sum() < torsion.knees[0]
    assert torsion.full_slip() < rated_torque(name)
    assert len(set(torsion.breakaway)) == 1
    assert torsion.stiffness == pytest.approx(torsion.slopes[0] * np.array([2 / 3, 1 / 3, 1 / 6]), rel=ROUNDING)


@pytest.mark.slow("files")
@every_set
def test_the_first_loading_is_the_published_curve_beyond_the_twist_at_which_the_last_element_slips(name: str) -> None:
    """Secant K1 to T1, then slopes K2 and K3, of the gear that the package loads."""
    gear, torsion = sw.load(name), Torsion.of(name)
    (k1, k2, k3), (t1, t2) = torsion.published_slopes(), torsion.published_knees()
    first, second = t1 / k1, t1 / k1 + (t2 - t1) / k2
    twist = np.linspace(float(np.max(torsion.breakaway / torsion.stiffness)), 2.0 * second, 200)
    published = np.interp(twist, (0.0, first, second), (0.0, t1, t2)) + k3 * np.maximum(twist - second, 0.0)
    loaded = gear.stiffness.torque(twist) + gear.hysteresis.trace([0.0, *twist])[1:]
    beyond = twist >= first
    assert np.any(~beyond)
    assert loaded[beyond] == pytest.approx(published[beyond], rel=ROUNDING_K1)
    assert np.all(loaded[~beyond] > published[~beyond])
    assert loaded[~beyond] == pytest.approx(published[~beyond], rel=0.35)


@pytest.mark.slow("files")
@every_set
def test_small_twists_and_reversals_meet_thirteen_sixths_of_the_springs_slope(name: str) -> None:
    gear, torsion = sw.load(name), Torsion.of(name)
    small = 1e-3 * float(np.min(torsion.breakaway / torsion.stiffness))
    torque = gear.stiffness.torque(small) + gear.hysteresis.trace([0.0, small])[-1]
    assert torque / small == pytest.approx(13 / 6 * torsion.slopes[0], rel=ROUNDING)
    assert 1.7 < torque / small / torsion.published_slopes()[0] < 1.95


@settings(deadline=None)
@given(name=st.sampled_from(sorted(SETS)), overload=st.floats(1.0, 20.0))
def test_beyond_full_slip_the_loss_is_the_closed_form(name: str, overload: float) -> None:
    torsion = Torsion.of(name)
    assert torsion.hysteresis_loss(overload * torsion.full_slip()) == pytest.approx(torsion.width(), rel=1e-9)


@settings(deadline=None)
@given(name=st.sampled_from(sorted(SETS)), part=st.floats(0.02, 0.97))
def test_below_full_slip_the_loop_is_narrower(name: str, part: float) -> None:
    torsion = Torsion.of(name)
    assert torsion.hysteresis_loss(part * torsion.full_slip()) < (1.0 - 1e-6) * torsion.width()


@settings(deadline=None)
@given(name=st.sampled_from(sorted(SETS)), part=st.floats(0.02, 20.0))
def test_the_loop_closes(name: str, part: float) -> None:
    torsion = Torsion.of(name)
    first, *_, last = torsion.cycle(part * torsion.full_slip())
    assert last.twist == pytest.approx(first.twist, rel=1e-9)
    assert last.held == pytest.approx(first.held, rel=1e-6)


# --- the other assumed figures ---


@every_set
def test_kinematic_error_spans_half_the_bound_on_transmission_accuracy_twice_a_turn(name: str) -> None:
    (order,), (amplitude,), (phase,) = figures(name, "kinematic_error", "order", "amplitude", "phase")
    angle = np.linspace(0.0, 2.0 * pi, 3601)
    error = amplitude * np.sin(order * angle + phase)
    assert np.ptp(error) == pytest.approx(0.5 * ACCURACY[column(name)][identity(name)[1]] * ARCMIN, rel=ROUNDING)
    assert np.argmax(np.abs(np.fft.rfft(error[:-1]))) == 2


def starting_torque(size: int, ratio: int) -> float:
    """size^3 / ratio times the geometric mean of the factors of the two CSF figures [N.m]."""
    factors = [torque * r / s**3 for (s, r), torque in STARTING_TORQUE.items()]
    return sqrt(factors[0] * factors[1]) * size**3 / ratio


@every_set
def test_breakaway_follows_the_two_starting_torques(name: str) -> None:
    (breakaway,) = figures(name, "friction_input", "breakaway")
    assert breakaway == pytest.approx(starting_torque(*identity(name)[1:]), rel=ROUNDING)


def test_the_starting_torque_rule_lies_a_fifth_off_its_own_figures_and_no_more_off_others() -> None:
    assert starting_torque(20, 160) == pytest.approx(CPL_STARTING, rel=0.05)
    for (size, ratio), torque in BACKDRIVING_TORQUE.items():
        assert ratio * starting_torque(size, ratio) == pytest.approx(torque, rel=0.2)
    for (size, ratio), torque in STARTING_TORQUE.items():
        assert abs(starting_torque(size, ratio) / torque - 1.0) == pytest.approx(0.2, abs=0.04)


@every_set
def test_viscous_friction_follows_the_running_torque_and_is_all_at_the_input(name: str) -> None:
    excess = CPL_RUNNING - CPL_RATIO_CORRECTION - CPL_STARTING
    (viscous,) = figures(name, "friction_input", "viscous")
    assert viscous == pytest.approx(excess / CPL_SPEED * (identity(name)[1] / 20) ** 3, rel=ROUNDING)
    assert figures(name, "friction_output", "viscous") == (0.0,)


@every_set
def test_input_friction_has_one_dry_level_as_no_measurement_tells_two_apart(name: str) -> None:
    coulomb, breakaway = figures(name, "friction_input", "coulomb", "breakaway")
    assert coulomb == breakaway


# --- at rest ---


def breakaway_at_output(gear: sw.Gear) -> float:
    """Load at which the wave generator sets off from where it stands, its motor without current [N.m]."""
    torque_ratio = 1.0 / gear.kinematics.ratio - gear.kinematic_error.slope(0.0)
    return float(gear.friction_input.breakaway / abs(torque_ratio))


def under_waves(gear: sw.Gear, peak: float) -> sw.Run:
    """Ten waves of load between zero and `peak` in a second, on a disc so light that it follows them."""
    drive = sw.Drive(
        gear=gear,
        motor=sw.motor.DC(inertia=gear.input_inertia),
        control=sw.control.OpenLoop(gain=1.0),
        load=sw.loads.Inertia(inertia=1e-6 * gear.stiffness.k1),
    )
    waves = sw.scenario.sine(peak / 2, 10.0, 1.0, phase=-pi / 2, offset=peak / 2)
    return sw.simulate(drive, sw.scenario.constant(0.0, 1.0), load_torque=waves)


@pytest.mark.slow("files")
@every_set
def test_a_load_that_wavers_below_breakaway_leaves_the_gear_where_it_stands(name: str) -> None:
    gear = sw.load(name)
    run = under_waves(gear, 0.95 * breakaway_at_output(gear))
    assert not run["input_angle"].any()
    after_each_wave = run["twist"][1500::500]  # the first ones start the disc
    assert np.ptp(after_each_wave) < 1e-5 * np.abs(run["twist"]).max()


@pytest.mark.slow("files")
@every_set
def test_a_load_beyond_breakaway_turns_the_gear(name: str) -> None:
    gear = sw.load(name)
    run = under_waves(gear, 1.05 * breakaway_at_output(gear))
    assert abs(run["input_angle"][-1]) > 1e-6


@pytest.mark.slow("files")
@every_set
def test_breakaway_at_the_output_is_the_starting_torque_times_the_ratio(name: str) -> None:
    """But for the slope of the kinematic error where the gear stands."""
    gear, (_, size, ratio) = sw.load(name), identity(name)
    without_error = gear.replace(kinematic_error=gear.kinematic_error.replace(order=[], amplitude=[], phase=[]))
    expected = ratio * starting_torque(size, ratio)
    assert breakaway_at_output(without_error) == pytest.approx(expected, rel=ROUNDING)
    assert breakaway_at_output(gear) == pytest.approx(expected, rel=0.02)


@every_set
def test_damping_is_two_percent_of_critical_with_the_output_held(name: str) -> None:
    """Read off the roots of the characteristic polynomial, not off the formula."""
    damping, inertia = figures(name, "gear", "damping", "input_inertia")
    k1, *_ = Torsion.of(name).published_slopes()
    root = np.roots([inertia * identity(name)[2] ** 2, damping, k1])[0]
    assert -root.real / abs(root) == pytest.approx(0.02, rel=2 * ROUNDING)
