"""Tooth errors against the balance of forces on every engaged tooth pair, against quadrature, and against closed forms."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave import _core
from strainwave.kinematic_error import ToothErrors
from strainwave.simulation.signals import outputs

Array = NDArray[np.float64]

RADIUS = 25e-3  # m
GEAR: dict[str, Any] = {
    "flexspline_teeth": 200,
    "circular_spline_teeth": 202,
    "pitch_radius": RADIUS,
    "engaged_share": 0.3,
}
FIXED = ("circular_spline", "flexspline")
every_fixed = pytest.mark.parametrize("fixed", FIXED)

sizes = st.lists(st.floats(0.0, 1e-5), min_size=1, max_size=16)
seeds = st.integers(0, 16777215)
angles = st.floats(-math.pi, math.pi)


@st.composite
def charts(draw: st.DrawFn) -> tuple[Array, Array]:
    amplitude = draw(sizes)
    phase = draw(st.lists(angles, min_size=len(amplitude), max_size=len(amplitude)))
    return np.array(amplitude), np.array(phase)


def deviation(chart: tuple[Array, Array], angle: Array) -> Array:
    """Cumulative pitch deviation at angles along the pitch circle."""
    amplitude, phase = chart
    order = np.arange(1, len(amplitude) + 1)
    found: Array = np.sin(np.multiply.outer(angle, order) + phase) @ amplitude
    return found


def gear(flexspline: tuple[Array, Array], circular_spline: tuple[Array, Array], **others: Any) -> ToothErrors:
    return ToothErrors(
        **{
            **GEAR,
            "flexspline_amplitude": flexspline[0],
            "flexspline_phase": flexspline[1],
            "circular_spline_amplitude": circular_spline[0],
            "circular_spline_phase": circular_spline[1],
            **others,
        }
    )


def in_frames(theta: float, fixed: str, z_f: int, z_c: int) -> tuple[float, float]:
    """Angle of the first lobe in the frames of both splines, from how far the output has turned: theta over the ratio."""
    if fixed == "circular_spline":
        return theta + theta * (z_c - z_f) / z_f, theta
    return theta, theta - theta * (z_c - z_f) / z_c


# Every tooth


def balanced(law: ToothErrors, flexspline: Array, circular_spline: Array, theta: float) -> float:
    """The error at which the forces of all engaged pairs balance, from the place of every tooth and its deviation."""
    z_f, z_c = len(flexspline), len(circular_spline)
    turned_f, turned_c = (theta - frame for frame in in_frames(theta, str(law.fixed), z_f, z_c))
    half_zone = law.engaged_share * z_f / 4.0  # pitches
    torque = 0.0
    for lobe, share in ((theta, law.first_lobe), (theta + math.pi, 1.0 - law.first_lobe)):

        def places(teeth: int, turned: float, lobe: float = lobe) -> Array:
            """In pitches from the lobe, of every tooth."""
            place = np.arange(teeth) + (turned - lobe) * teeth / (2.0 * math.pi)
            found: Array = place - teeth * np.rint(place / teeth)
            return found

        at_f, at_c = places(z_f, turned_f), places(z_c, turned_c)
        engaged_f = np.flatnonzero(np.abs(at_f) < half_zone - 1e-6)
        engaged_c = np.flatnonzero(np.abs(at_c) < half_zone - 1e-6)
        engaged_f, engaged_c = engaged_f[np.argsort(at_f[engaged_f])], engaged_c[np.argsort(at_c[engaged_c])]
        np.testing.assert_allclose(at_f[engaged_f], at_c[engaged_c], rtol=0.0, atol=1e-9)  # pair by pair
        stiffness = 1.0 + np.cos(math.pi * at_f[engaged_f] / half_zone)
        torque += share * stiffness @ (flexspline[engaged_f] - circular_spline[engaged_c]) / stiffness.sum()
    # Without torque r (turn of the flexspline - turn of the circular spline) + torque = 0; the error is what the output lags.
    return torque / law.pitch_radius if str(law.fixed) == "circular_spline" else -torque / law.pitch_radius


def window(order: Array, zone: float) -> Array:
    """What the mean over a zone [rad] weighted by 1 + cos leaves of an order: that of three plain means."""
    x = np.asarray(order) * zone / (2.0 * math.pi)
    found: Array = np.sinc(x) + 0.5 * (np.sinc(x + 1.0) + np.sinc(x - 1.0))
    return found


def between_teeth(amplitude: Array, teeth: int, zone: float) -> float:
    """Bound on what a sum over single teeth, and not the mean over a zone, adds: by Poisson's formula orders n + j z.

    Of a high order n about pi^2 / x^3 is left, x = n zone / 2, because both ends of the zone are smooth.
    """
    j = np.arange(1, 2001) * teeth
    empty = 2.0 * float(np.abs(window(j, zone)).sum())
    bound = 0.0
    for order, size in enumerate(amplitude, start=1):
        others = float(np.abs(window(order + j, zone)).sum() + np.abs(window(order - j, zone)).sum())
        bound += size * (others + empty * abs(float(window(np.array(order), zone)))) / (1.0 - empty)
    tail = 2.0 * math.pi**2 / (2.0 * 1999.0**2 * (teeth * zone / 2.0) ** 3)
    return bound + 3.0 * tail * float(amplitude.sum())


@every_fixed
@given(charts(), charts(), st.floats(-20.0, 20.0), st.floats(0.1, 0.6), st.floats(0.0, 1.0))
def test_the_forces_of_all_engaged_teeth_balance(
    fixed: str, flexspline: Any, circular_spline: Any, theta: float, engaged_share: float, first_lobe: float
) -> None:
    law = gear(flexspline, circular_spline, fixed=fixed, engaged_share=engaged_share, first_lobe=first_lobe)
    teeth = [2.0 * math.pi * np.arange(z) / z for z in (200, 202)]
    expected = balanced(law, deviation(flexspline, teeth[0]), deviation(circular_spline, teeth[1]), theta)
    zones = [math.pi * engaged_share * 200 / z for z in (200, 202)]
    bound = between_teeth(flexspline[0], 200, zones[0]) + between_teeth(circular_spline[0], 202, zones[1])
    rounding = 1e-12 * float(flexspline[0].sum() + circular_spline[0].sum())
    largest = float(flexspline[0].sum() + circular_spline[0].sum())
    assert bound < 0.01 * largest + 1e-300
    assert law.error(theta) == pytest.approx(expected, rel=0.0, abs=(bound + rounding) / RADIUS)


@every_fixed
@given(charts(), charts(), st.floats(-20.0, 20.0), st.floats(0.01, 1.0), st.floats(0.0, 1.0))
def test_the_error_is_the_mean_of_the_deviations_over_both_zones(
    fixed: str, flexspline: Any, circular_spline: Any, theta: float, engaged_share: float, first_lobe: float
) -> None:
    """By quadrature, to rounding."""
    law = gear(flexspline, circular_spline, fixed=fixed, engaged_share=engaged_share, first_lobe=first_lobe)
    nodes, weights = np.polynomial.legendre.leggauss(80)
    means = []
    for chart, frame, teeth in zip((flexspline, circular_spline), in_frames(theta, fixed, 200, 202), (200, 202), strict=True):
        place = 0.5 * math.pi * engaged_share * 200 / teeth * nodes
        stiffness = weights * 0.5 * (1.0 + np.cos(math.pi * nodes))
        lobes = [float(stiffness @ deviation(chart, frame + side + place)) for side in (0.0, math.pi)]
        means.append(first_lobe * lobes[0] + (1.0 - first_lobe) * lobes[1])
    expected = (means[0] - means[1]) / RADIUS * (1.0 if fixed == "circular_spline" else -1.0)
    rounding = 1e-13 * float(flexspline[0].sum() + circular_spline[0].sum()) / RADIUS + 1e-300
    assert law.error(theta) == pytest.approx(expected, rel=0.0, abs=rounding)


# Which orders


def one_order(spline: str, order: int, **others: Any) -> ToothErrors:
    chart = {f"{spline}_amplitude": [0.0] * (order - 1) + [5e-6], f"{spline}_phase": [0.0] * order}
    return ToothErrors(**{**GEAR, **chart, **others})


@pytest.mark.parametrize("spline", FIXED)
@pytest.mark.parametrize("order", [1, 2, 3, 4])
@every_fixed
def test_odd_orders_cancel_where_both_lobes_share_equally_and_even_ones_do_not(spline: str, order: int, fixed: str) -> None:
    """An eccentric spline gives nothing, an oval one all of its own; one lobe alone shows both."""
    theta = np.linspace(0.0, 2.0 * math.pi, 400)
    zone = math.pi * 0.3 * 200 / (200 if spline == "flexspline" else 202)
    full = float(window(np.array(order), zone)) * 5e-6 / RADIUS
    frame = theta * {
        ("circular_spline", "flexspline"): 202 / 200,
        ("flexspline", "circular_spline"): 200 / 202,
    }.get((fixed, spline), 1.0)
    sign = 1.0 if spline != fixed else -1.0
    for first_lobe in (0.5, 1.0, 0.0, 0.8):
        found = one_order(spline, order, fixed=fixed, first_lobe=first_lobe).error(theta)
        share = 1.0 if order % 2 == 0 else 2.0 * first_lobe - 1.0
        np.testing.assert_allclose(found, sign * share * full * np.sin(order * frame), rtol=0.0, atol=1e-13 * full)


@pytest.mark.parametrize(
    ("fixed", "orders"), [("circular_spline", (2.0, 2.0 * 202 / 200)), ("flexspline", (2.0 * 200 / 202, 2.0))]
)
def test_a_running_gear_shows_the_order_of_each_spline(fixed: str, orders: tuple[float, float]) -> None:
    """Document R's 2 z_c / z_f is the flexspline's second order where the circular spline is fixed."""
    law = ToothErrors(
        **GEAR,
        fixed=fixed,
        circular_spline_amplitude=[3e-6, 4e-6],
        circular_spline_phase=[0.0, 0.7],
        flexspline_amplitude=[2e-6, 6e-6],
        flexspline_phase=[0.0, -0.4],
    )
    drive = sw.Drive(
        gear=sw.Gear(kinematics=sw.kinematics.StrainWave(fixed=fixed), kinematic_error=law, damping=100.0),
        motor=sw.motor.TorqueSource(inertia=1.0),
        control=sw.control.OpenLoop(),
        load=sw.loads.Inertia(inertia=0.1),
    )
    speed = 2.0 * math.pi * 20.0
    run = sw.simulate(
        drive,
        sw.scenario.constant(0.0, 5.2),
        1e-3,
        initial={"input_speed": speed, "output_speed": speed / drive.gear.kinematics.ratio},
    )
    found = sw.orders.order_amplitudes(run, "kinematic_error", [*sorted(orders), 1.0, 1.01, 4.0])
    expected = {
        orders[0]: 4e-6 * float(window(np.array(2), math.pi * 0.3 * 200 / 202)) / RADIUS,
        orders[1]: 6e-6 * float(window(np.array(2), math.pi * 0.3)) / RADIUS,
    }
    assert found.amplitude[:2] == pytest.approx([expected[order] for order in sorted(orders)], rel=1e-3)
    assert np.abs(found.amplitude[2:]).max() < 1e-3 * min(expected.values())


def test_the_second_orders_of_both_splines_beat_twice_in_a_turn_of_the_output() -> None:
    """Order n does so n times: within one turn of the input the envelope |sin(theta / 100)| changes by 2 pi / 100 at most."""
    law = ToothErrors(
        **GEAR,
        flexspline_amplitude=[0.0, 5e-6],
        flexspline_phase=[0.0, 0.0],
        circular_spline_amplitude=[0.0, 5e-6],
        circular_spline_phase=[0.0, 0.0],
    )
    turn = np.linspace(0.0, 2.0 * math.pi, 200)
    ripple = [float(np.ptp(law.error(turn + 2.0 * math.pi * turns))) for turns in (0, 25, 50, 75, 100)]
    full = 2.0 * 5e-6 / RADIUS * sum(float(window(np.array(2), math.pi * 0.3 * 200 / z)) for z in (200, 202))
    expected = [full * abs(math.sin(2.0 * math.pi * turns / 100.0)) for turns in (0, 25, 50, 75, 100)]
    assert ripple == pytest.approx(expected, rel=0.0, abs=2.0 * math.pi / 100.0 * full)


@pytest.mark.parametrize(("order", "left"), [(4, 8.0 / (3.0 * math.pi)), (8, 0.5), (16, 0.0)])
def test_a_zone_leaves_half_of_a_deviation_of_its_own_length_and_nothing_of_one_half_as_long(order: int, left: float) -> None:
    """A quarter of the teeth is engaged: an eighth of the pitch circle under each lobe."""
    law = one_order("flexspline", order, engaged_share=0.25, fixed="flexspline")
    assert abs(law.error(math.pi / (2.0 * order))) == pytest.approx(left * 5e-6 / RADIUS, rel=1e-13, abs=1e-13 * 5e-6 / RADIUS)


def test_a_single_pair_under_each_lobe_follows_the_deviation_itself() -> None:
    law = one_order("circular_spline", 16, engaged_share=0.0)
    theta = np.linspace(-3.0, 3.0, 101)
    np.testing.assert_allclose(law.error(theta), -5e-6 / RADIUS * np.sin(16.0 * theta), rtol=0.0, atol=1e-16)


@every_fixed
@given(charts(), charts(), angles, st.integers(-1_000_000_000, 1_000_000_000))
def test_it_is_as_exact_after_many_turns_as_at_first(
    fixed: str, flexspline: Any, circular_spline: Any, angle: float, turns: int
) -> None:
    """The reference counts in exact fractions where the lobe stands in the frame of the output."""
    law = gear(flexspline, circular_spline, fixed=fixed, first_lobe=1.0, engaged_share=0.0)
    drive = sw.Drive(gear=sw.Gear(kinematics=sw.kinematics.StrainWave(fixed=fixed), kinematic_error=law))
    state = drive.rest().replace(turns=float(turns), input_angle=angle)
    column = list(outputs(sw.Drive())).index("kinematic_error")
    found = _core.now(drive, state.numbers, np.array([0.0, 0.0, 0.0, 0.0, 293.15, 0.0]))[column, 0]
    output, teeth, other = (flexspline, 200, 202) if fixed == "circular_spline" else (circular_spline, 202, 200)
    frame = angle * other / teeth + 2.0 * math.pi * float(Fraction(turns * other, teeth) % 1)
    still = circular_spline if fixed == "circular_spline" else flexspline
    expected = (deviation(output, np.array(frame)) - deviation(still, np.array(angle))) / RADIUS
    rounding = 1e-13 * float(flexspline[0].sum() + circular_spline[0].sum()) / RADIUS
    rounding += float(np.finfo(float).tiny)  # below it numbers have fewer digits
    assert found == pytest.approx(float(expected), rel=0.0, abs=rounding)


# Random charts

MODULI = np.array([30269, 30307, 30323])
FACTORS = np.array([171, 172, 170])


def drawn(seed: int) -> tuple[Array, Array]:
    """Phases of both splines, in the integers of Python: AS 183 (WichmannHill1982), stirred before use."""
    high = round(seed / 4096)
    state = np.array([seed - 4096 * high + 2049, high + 1, 1])
    for _ in range(16):
        for i in range(3):
            state[i] = max((FACTORS[i] * state[i] + state[(i + 1) % 3]) % MODULI[i], 1)
    phases = []
    for _ in range(32):
        state = FACTORS * state % MODULI
        phases.append(2.0 * math.pi * math.fsum(state / MODULI))
    return np.array(phases[:16]), np.array(phases[16:])


def independent(total: float) -> Array:
    """Amplitudes of pitches that are cut independently of each other."""
    amplitude: Array = math.sqrt(2.0 / math.pi) * total / (math.pi * np.arange(1, 17))
    return amplitude


@every_fixed
@given(seeds, st.floats(1e-7, 1e-4), st.floats(1e-7, 1e-4), st.floats(-20.0, 20.0), st.floats(0.0, 1.0))
def test_a_random_gear_is_that_of_the_charts_that_the_seed_draws(
    fixed: str, seed: int, flexspline: float, circular_spline: float, theta: float, first_lobe: float
) -> None:
    random = ToothErrors(
        **GEAR,
        fixed=fixed,
        first_lobe=first_lobe,
        flexspline_deviation=flexspline,
        circular_spline_deviation=circular_spline,
        seed=seed,
    )
    phases = drawn(seed)
    written_out = gear(
        (independent(flexspline), phases[0]), (independent(circular_spline), phases[1]), fixed=fixed, first_lobe=first_lobe
    )
    rounding = 1e-12 * (flexspline + circular_spline) / RADIUS
    assert random.error(theta) == pytest.approx(written_out.error(theta), rel=0.0, abs=rounding)


def test_a_random_chart_adds_to_a_measured_one() -> None:
    measured = one_order("flexspline", 2)
    random = ToothErrors(**GEAR, flexspline_deviation=15e-6, seed=3)
    both = measured.replace(flexspline_deviation=15e-6, seed=3)
    theta = np.linspace(0.0, 6.0, 50)
    np.testing.assert_allclose(both.error(theta), measured.error(theta) + random.error(theta), rtol=0.0, atol=1e-18)


@given(seeds)
def test_the_same_seed_gives_the_same_gear_and_another_one_another(seed: int) -> None:
    theta = np.linspace(0.0, 6.0, 50)
    one, same, other = (
        ToothErrors(**GEAR, flexspline_deviation=15e-6, circular_spline_deviation=15e-6, seed=each).error(theta)
        for each in (seed, seed, (seed + 1) % 16777216)
    )
    assert one.tolist() == same.tolist()
    assert np.abs(one - other).max() > 1e-2 * np.abs(one).max()


def test_a_deviation_of_one_spline_changes_nothing_of_what_is_drawn_of_the_other() -> None:
    theta = np.linspace(0.0, 6.0, 50)
    flexspline, circular_spline, both = (
        ToothErrors(**GEAR, flexspline_deviation=a, circular_spline_deviation=b, seed=5).error(theta)
        for a, b in ((15e-6, 0.0), (0.0, 15e-6), (15e-6, 15e-6))
    )
    np.testing.assert_allclose(both, flexspline + circular_spline, rtol=0.0, atol=1e-18)


@pytest.mark.slow("physics")
def test_amplitudes_are_those_of_pitches_cut_independently_of_each_other() -> None:
    """Rings with 2000 teeth by the thousand; within four standard deviations of the estimates.

    The range of a walk of z steps falls short of the limit for many by 1.17 steps (their overshoot at both ends).
    """
    random, teeth, rings = np.random.default_rng(1), 2000, 4000
    sigma = 1.0 / math.sqrt(math.pi / 2.0 * teeth)  # such that F_p is 1 in the mean
    pitches = sigma * random.standard_normal((rings, teeth))
    cumulative = np.cumsum(pitches - pitches.mean(axis=1, keepdims=True), axis=1)
    power = np.mean(np.abs(np.fft.rfft(cumulative, axis=1)[:, 1:17] * 2.0 / teeth) ** 2, axis=0)
    np.testing.assert_allclose(power, independent(1.0) ** 2, rtol=4.0 / math.sqrt(rings) + 1e-3)
    spread = math.sqrt((math.pi**2 / 6.0 - math.pi / 2.0) / (math.pi / 2.0) / rings)  # of the mean of ranges, relative to it
    assert np.ptp(cumulative, axis=1).mean() == pytest.approx(1.0 - 1.17 * sigma, abs=4.0 * spread)


def test_the_deviation_of_a_random_spline_is_in_the_mean_about_the_one_asked_for() -> None:
    """Sixteen orders hold less of it than all teeth do: nine tenths."""
    theta = np.linspace(0.0, 2.0 * math.pi, 361)
    alone = {**GEAR, "engaged_share": 0.0, "first_lobe": 1.0, "fixed": "flexspline", "flexspline_deviation": 1e-5}
    ranges = [float(np.ptp(ToothErrors(**alone, seed=seed).error(theta))) * RADIUS for seed in range(500)]
    assert np.mean(ranges) == pytest.approx(0.9e-5, rel=0.05)


# Flanks


def flanks_of_single_pairs(law: ToothErrors, theta: Array) -> Array:
    """Mean flank deviation over the engaged pairs, from the place of each tooth of the fixed spline and its own weight."""
    circular_spline_held = str(law.fixed) == "circular_spline"
    teeth = law.circular_spline_teeth if circular_spline_held else law.flexspline_teeth
    half_zone = 0.5 * math.pi * law.engaged_share * law.flexspline_teeth / teeth
    places = np.linspace(0.0, 1.0, len(law.flank_deviation))
    mean = np.zeros_like(theta)
    for lobe, share in ((0.0, law.first_lobe), (math.pi, 1.0 - law.first_lobe)):
        gone = np.subtract.outer(theta + lobe, 2.0 * math.pi * np.arange(teeth) / teeth)  # by the lobe, of each tooth
        gone -= 2.0 * math.pi * np.rint(gone / (2.0 * math.pi))
        weight = np.where(np.abs(gone) < half_zone, 1.0 + np.cos(math.pi * gone / half_zone), 0.0)
        deviation = np.interp(0.5 * (1.0 + gone / half_zone), places, law.flank_deviation)
        mean += share * (weight * deviation).sum(axis=1) / weight.sum(axis=1)
    return mean / law.pitch_radius * (1.0 if circular_spline_held else -1.0)


@every_fixed
@pytest.mark.parametrize("teeth", [(100, 102), (101, 103)])
@pytest.mark.parametrize("first_lobe", [0.5, 0.8])
@given(st.lists(st.floats(-1e-5, 1e-5), min_size=2, max_size=16), st.floats(0.1, 0.4))
def test_each_multiple_of_passing_flanks_is_that_of_the_sum_over_single_pairs(
    fixed: str, teeth: tuple[int, int], first_lobe: float, profile: list[float], engaged_share: float
) -> None:
    """Over one passing of a tooth. The mean over single pairs divides by a stiffness that varies with them: twice its share."""
    z_f, z_c = teeth
    numbers = {"flexspline_teeth": z_f, "circular_spline_teeth": z_c, "engaged_share": engaged_share}
    law = ToothErrors(**(GEAR | numbers), fixed=fixed, first_lobe=first_lobe, flank_deviation=profile)
    passing = z_c if fixed == "circular_spline" else z_f
    samples = 1024
    theta = 2.0 * math.pi / passing * np.arange(samples) / samples
    known, found = (np.fft.rfft(values)[1:5] / samples for values in (flanks_of_single_pairs(law, theta), law.error(theta)))
    half_zone = 0.5 * math.pi * engaged_share * z_f / passing
    relative = 2.0 * float(np.abs(window(np.arange(1, 50) * passing, 2.0 * half_zone)).sum())
    largest = max(abs(value) for value in profile) / RADIUS
    np.testing.assert_allclose(found, known, rtol=0.0, atol=2.0 * relative * float(np.abs(known).max()) + 3e-6 * largest)


@every_fixed
def test_flanks_have_the_order_of_the_teeth_of_the_fixed_spline(fixed: str) -> None:
    """Of two equal lobes an odd number of teeth leaves every other multiple."""
    for z_f, z_c, first in ((100, 102, 1), (101, 103, 2)):
        law = ToothErrors(
            **(GEAR | {"flexspline_teeth": z_f, "circular_spline_teeth": z_c, "engaged_share": 0.1}),
            fixed=fixed,
            flank_deviation=[5e-6, 0.0, 1e-6],
        )
        theta = 2.0 * math.pi * np.arange(4096) / 4096
        waves = np.abs(np.fft.rfft(law.error(theta)))
        passing = z_c if fixed == "circular_spline" else z_f
        assert np.flatnonzero(waves > 1e-9 * waves.max())[0] == first * passing


def test_a_constant_flank_deviation_is_none_and_one_place_alone_is_refused() -> None:
    law = ToothErrors(**GEAR, flank_deviation=[3e-6, 3e-6, 3e-6])
    assert np.abs(law.error(np.linspace(0.0, 0.1, 50))).max() < 1e-15 * 3e-6 / RADIUS * 1e3
    with pytest.raises(ValueError, match="flank_deviation must have at least 2 elements"):
        ToothErrors(**GEAR, flank_deviation=[3e-6])


# What is refused


@pytest.mark.parametrize("teeth", [(200, 201), (202, 200), (200, 200)])
def test_teeth_that_do_not_mesh_at_two_lobes_are_refused(teeth: tuple[int, int]) -> None:
    with pytest.raises(
        ValueError, match=rf"circular_spline_teeth = {teeth[1]} must exceed flexspline_teeth = {teeth[0]} by an even number"
    ):
        ToothErrors(**GEAR | {"flexspline_teeth": teeth[0], "circular_spline_teeth": teeth[1]})


@pytest.mark.parametrize("spline", FIXED)
def test_a_chart_without_all_its_phases_is_refused(spline: str) -> None:
    with pytest.raises(ValueError, match=rf"{spline}_amplitude and {spline}_phase must have equally many elements"):
        ToothErrors(**GEAR, **{f"{spline}_amplitude": [1e-6, 2e-6], f"{spline}_phase": [0.0]})


def test_a_seed_that_is_no_whole_number_is_refused() -> None:
    for seed in (0.5, -1, 16777216):
        with pytest.raises((TypeError, ValueError), match="seed"):
            ToothErrors(**GEAR, seed=seed)
