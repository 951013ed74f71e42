"""Document A's gear as tests/support/actuator_equations.py has it: its numbers, and the laws that Eq. 1 breaks as printed.

Nothing here is of the package. The numbers of the statics and of the modes were computed independently.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import cos, pi, sin, tan

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.integrate import solve_ivp

from tests.support.actuator_equations import (
    IN,
    OUT,
    PRINTED,
    RIGHT,
    WG,
    X2,
    Y1,
    Y2,
    Array,
    Forces,
    Form,
    Gear,
    Outside,
    Spring,
    corrected,
    damping_matrix,
    energy,
    masses,
    outputs,
    printed,
    rates,
    stiffness_matrix,
    with_energies,
)

ALPHA_N, K_OUT = 0.01714733708184737, 12195.12195121951  # rad, N.m/rad
J_FS, R_G = 2e-5, 0.025  # kg.m2, m
GEAR = Gear(
    K_WG=Spring(5e3),
    K_b=Spring(5e7),
    K_t=Spring(2e4),
    K_m=Spring(1e8),
    K_CS=Spring(1e5),
    J_WG=8e-6,
    J_FS=J_FS,
    J_CS=3e-4,
    radial_mass=J_FS / R_G**2,
)
LOAD = 20.0  # N.m
FREE = [WG, X2, Y1, Y2]  # the gear by itself, its shafts not joined to it
MODES = [6298.71, 37476.81, 66337.87]  # rad/s

orientations = st.sampled_from(["flexspline", "circular_spline"])
gears = st.builds(
    lambda fixed, alpha_t, k, c: Gear(
        *(Spring(each, damping) for each, damping in zip(k, c, strict=True)),
        J_WG=2e-5,
        J_FS=4e-5,
        J_CS=2e-4,
        radial_mass=0.05,
        tau=81.0,
        r_g=0.03,
        alpha_t=alpha_t,
        fixed=fixed,
    ),
    orientations,
    st.floats(0.2, 0.9),
    st.tuples(st.floats(20.0, 200.0), *[st.floats(2e5, 4e6), st.floats(2e2, 4e3), st.floats(2e5, 4e6), st.floats(2e2, 4e3)]),
    st.tuples(st.floats(0.0, 0.02), *[st.floats(0.0, 400.0), st.floats(0.0, 0.4), st.floats(0.0, 400.0), st.floats(0.0, 0.4)]),
)


def none(*_: float) -> float:
    """No torque from outside."""
    return 0.0


# Statics


def at_rest(gear: Gear, torque: float) -> Array:
    """The state of a gear that transmits a torque to the output [N.m], its motor shaft at angle zero."""
    moving = [WG, X2, Y1, Y2, OUT]
    pulled = np.zeros(6)
    pulled[OUT] = -torque
    q = np.zeros(6)
    q[moving] = np.linalg.solve(stiffness_matrix(gear)[np.ix_(moving, moving)], pulled[moving])
    return np.concatenate([q, np.zeros(6)])


def test_the_cam_has_the_known_angle() -> None:
    assert GEAR.alpha_n == pytest.approx(ALPHA_N, rel=1e-15)
    assert tan(ALPHA_N) * tan(GEAR.alpha_t) == pytest.approx(1.0 / GEAR.tau, rel=1e-14)


def test_the_circular_spline_gives_way_as_known_where_the_wave_generator_is_held() -> None:
    moving = [X2, Y1, Y2]
    moved = np.linalg.solve(stiffness_matrix(replace(GEAR, K_CS=Spring(0.0)))[np.ix_(moving, moving)], [0.0, 0.0, -LOAD / R_G])
    assert -moved[2] / R_G == pytest.approx(LOAD / K_OUT, rel=1e-12)


@given(gears, st.floats(-50.0, 50.0))
def test_the_compliances_of_the_five_springs_add(gear: Gear, torque: float) -> None:
    """At the output: 1/K_out of the physics, 1/K_CS, and 1/(tau^2 K_WG) of the coupling that A has beside it."""
    r, t, c = gear.r_g, tan(gear.alpha_t), cos(gear.alpha_t)
    within = 1.0 / gear.K_t.k + t * t / (gear.K_b.k * r * r) + 1.0 / (gear.K_m.k * r * r * c * c)
    compliance = within + 1.0 / gear.K_CS.k + 1.0 / (gear.tau**2 * gear.K_WG.k)
    assert -at_rest(gear, torque)[OUT] == pytest.approx(torque * compliance, rel=1e-9, abs=1e-15)


def test_20_newton_metres_load_the_parts_as_known() -> None:
    found = outputs(GEAR, at_rest(GEAR, LOAD))
    assert found["F_m"] == pytest.approx(923.7604307034012, rel=1e-10)
    assert found["F_b"] == pytest.approx(461.8802153517006, rel=1e-10)
    assert found["T_WG"] == pytest.approx(0.198019801980198, rel=1e-10)
    assert found["T"] == pytest.approx(LOAD, rel=1e-10)


@given(gears, st.floats(-50.0, 50.0))
def test_the_loads_of_the_parts_follow_from_equilibrium(gear: Gear, torque: float) -> None:
    """F_m r_g cos alpha_t = T, F_b = F_m sin alpha_t, T_WG = T / i, of the sign of the ratio."""
    sense = 1.0 if gear.fixed == "flexspline" else -1.0
    found = outputs(gear, at_rest(gear, torque))
    mesh = sense * torque / (gear.r_g * cos(gear.alpha_t))
    for name, expected in ("F_m", mesh), ("F_b", mesh * sin(gear.alpha_t)), ("T_WG", sense * torque / gear.tau):
        assert found[name] == pytest.approx(expected, rel=1e-8, abs=1e-12)


def test_eq_1_asks_too_much_of_what_holds_the_flexspline() -> None:
    """A whole 1/tau of the load: T_WG - T and the torque on the housing should add to zero, by which that is T (1 - 1/tau).

    By z_c w_c - z_f w_f = 2 w_w the flexspline takes z_f / z_c = 1 - 1/tau of what the circular spline takes; by Eq. 1 as much.
    """
    state = at_rest(GEAR, LOAD)
    found = outputs(GEAR, state)
    housing = GEAR.K_t.k * found["y1"] / R_G
    assert housing == pytest.approx(LOAD, rel=1e-9)
    assert housing + found["T_WG"] - found["T"] == pytest.approx(LOAD / GEAR.tau, rel=1e-9)


@given(gears, st.floats(-100.0, 100.0))
def test_unloaded_and_aligned_the_output_turns_by_the_ratio_exactly(gear: Gear, angle: float) -> None:
    """A turn of all six coordinates that meets no force."""
    sense = 1.0 if gear.fixed == "flexspline" else -1.0
    ring = gear.r_g * angle / gear.tau
    rings = (0.0, ring) if gear.fixed == "flexspline" else (ring, 0.0)
    q = np.array([angle, angle, ring / tan(gear.alpha_t), *rings, sense * angle / gear.tau])
    largest = np.abs(stiffness_matrix(gear)).max(axis=1) * np.abs(q).max()
    assert np.all(np.abs(corrected(gear, q, np.zeros(6))) <= 1e-14 * largest + 1e-300)


# Modes


def eigenfrequencies(gear: Gear, free: list[int], inertia_in: float = 1.0, inertia_out: float = 1.0) -> Array:
    """Rad/s, ascending, with the other coordinates held."""
    m = 1.0 / np.sqrt(masses(gear, inertia_in, inertia_out)[free])
    return np.sqrt(np.abs(np.linalg.eigvalsh(m[:, None] * stiffness_matrix(gear)[np.ix_(free, free)] * m)))


def test_the_known_modes_are_those_of_the_gear_by_itself_with_both_its_ends_free() -> None:
    """The wave generator not joined to the motor, nor the circular spline to the output; with an end held they are others."""
    by_itself = replace(GEAR, K_WG=Spring(0.0), K_CS=Spring(0.0))
    frequencies = eigenfrequencies(by_itself, FREE)
    assert frequencies[0] < 0.1  # it turns as a whole
    assert frequencies[1:] == pytest.approx(MODES, abs=0.005)
    assert eigenfrequencies(by_itself, [X2, Y1, Y2]) == pytest.approx([6286.9059, 37465.1841, 66336.9037], abs=1e-4)
    assert eigenfrequencies(by_itself, [WG, X2, Y1]) == pytest.approx([386.4436, 37443.6440, 65471.1613], abs=1e-4)


def test_small_vibrations_of_the_equations_have_the_frequency_of_the_slowest_mode() -> None:
    """Both written forms, integrated."""
    by_itself = replace(GEAR, K_WG=Spring(0.0), K_CS=Spring(0.0))
    m = 1.0 / np.sqrt(masses(by_itself, 1.0, 1.0)[FREE])
    _, vectors = np.linalg.eigh(m[:, None] * stiffness_matrix(by_itself)[np.ix_(FREE, FREE)] * m)
    start = np.zeros(12)
    start[FREE] = 1e-6 * vectors[:, 1] * m
    period = 2.0 * pi / eigenfrequencies(by_itself, FREE)[1]
    for forces in corrected, printed_with(RIGHT):
        after = solve_ivp(
            rates(by_itself, 1.0, 1.0, none, none, forces), (0.0, period), start, "DOP853", rtol=1e-11, atol=1e-18
        ).y[:, -1]
        assert after[FREE] == pytest.approx(start[FREE], rel=1e-6)


# Energy


def printed_with(form: Form) -> Forces:
    return lambda gear, q, v: printed(gear, q, v, form)


@given(gears, st.lists(st.floats(-1.0, 1.0), min_size=12, max_size=12), st.floats(0.0, 1e-4), st.floats(-3.0, 3.0))
def test_eq_1_with_its_errata_mended_is_what_the_lagrangian_gives(
    gear: Gear, state: list[float], error: float, phase: float
) -> None:
    misaligned = replace(gear, fixed="flexspline", e_WG=wave(error, 2.0, phase))
    q, v = np.array(state[:6]), np.array(state[6:])
    expected = corrected(misaligned, q, v)
    assert printed(misaligned, q, v, RIGHT) == pytest.approx(expected, rel=1e-9, abs=1e-9 * float(np.abs(expected).max()))


def wave(amplitude: float, order: float, phase: float) -> Callable[[float], tuple[float, float]]:
    """A kinematic error of one harmonic [m]."""
    return lambda theta: (amplitude * sin(order * theta + phase), amplitude * order * cos(order * theta + phase))


def excitation(numbers: list[float], size: float) -> Outside:
    """A sum of sines of random amplitude and frequency up to that of the modes."""
    waves = [(size * a, 4000.0 * abs(b) + 10.0, 3.0 * c) for a, b, c in zip(*[iter(numbers)] * 3, strict=True)]
    return lambda time, *_: sum(a * sin(w * time + p) for a, w, p in waves)


numbers = st.lists(st.floats(-1.0, 1.0), min_size=9, max_size=9)


@pytest.mark.slow("physics")
@given(gears, numbers, numbers, st.floats(-60.0, 60.0), st.floats(1e-6, 5e-5))
@settings(max_examples=5, deadline=None)
def test_corrected_it_gives_no_more_than_it_gets(
    gear: Gear, motor: list[float], load: list[float], speed: float, error: float
) -> None:
    """Energy at any time = energy at the start + work of the shafts - losses of its dampers, which never fall: with a kinematic
    error, and springs that vary."""
    varying = (2.0, 1.0), (0.05, 0.02), (0.3, 1.0)
    rough = replace(
        gear,
        e_WG=wave(error, 2.0, 0.4),
        K_t=replace(gear.K_t, order=varying[0], amplitude=varying[1], phase=varying[2]),
        K_m=replace(gear.K_m, order=varying[0], amplitude=varying[1], phase=varying[2]),
    )
    equations = with_energies(rough, 1e-4, 0.05, excitation(motor, 0.3), excitation(load, 10.0))
    sense = 1.0 if gear.fixed == "flexspline" else -1.0
    ring = gear.r_g * speed / gear.tau
    rings = (0.0, ring) if gear.fixed == "flexspline" else (ring, 0.0)
    start = np.zeros(14)
    start[6:12] = speed, speed, ring / tan(gear.alpha_t), *rings, sense * speed / gear.tau
    run = solve_ivp(equations, (0.0, 0.02), start, "DOP853", rtol=1e-10, atol=1e-13)
    energies = np.array([energy(rough, 1e-4, 0.05, y) for y in run.y.T])
    work, lost = run.y[12], run.y[13]
    turned_over = np.abs(energies).max() + np.abs(work).max() + np.abs(lost).max()
    np.testing.assert_allclose(energies - energies[0], work - lost, rtol=0.0, atol=1e-8 * turned_over)
    assert np.all(np.diff(lost) >= 0.0)


@given(gears)
def test_corrected_no_rate_of_any_part_makes_its_dampers_drive(gear: Gear) -> None:
    matrix = damping_matrix(gear)
    np.testing.assert_allclose(matrix, matrix.T, rtol=1e-14)
    assert np.linalg.eigvalsh(matrix).min() >= -1e-12 * np.abs(matrix).max()


def turned_under_load(form: Form, torque: float, speed: float, dampings: float = 0.0) -> tuple[float, float]:
    """Power of the motor and of the output [W] at a steady speed of the wave generator [rad/s] under load, springs at rest."""
    damped = replace(GEAR, K_b=Spring(5e7, dampings), K_m=Spring(1e8, dampings), K_t=Spring(2e4, 1e-3 * dampings))
    state = at_rest(damped, torque)
    ring = R_G * speed / GEAR.tau
    state[6:] = speed, speed, ring / tan(GEAR.alpha_t), 0.0, ring, speed / GEAR.tau
    acting = printed(damped, state[:6], state[6:], form)
    lever = R_G * form.lever(GEAR.alpha_n)
    assert acting[X2] == pytest.approx(0.0, abs=1e-7)  # N: the parts within are in equilibrium
    return lever * outputs(damped, state)["F_b"] * speed, acting[OUT] * speed / GEAR.tau


@pytest.mark.parametrize("speed", [1.0, 31.73])
@pytest.mark.parametrize("damping", [0.0, 100.0])
def test_with_the_lever_as_printed_a_loaded_gear_gives_more_power_than_it_takes(speed: float, damping: float) -> None:
    """E-A2: by 1/cos^2 alpha_n = 1.000294, at any speed and load, however it is damped: turning evenly moves no damper.

    At 20 N.m, 90 deg under load in 5 s and back unloaded make 9.24 mJ a cycle.
    """
    wrong, right = Form(PRINTED.lever, sin, 1.0), RIGHT
    taken, given_out = turned_under_load(right, LOAD, speed, damping)
    assert given_out == pytest.approx(taken, rel=1e-9)
    taken, given_out = turned_under_load(wrong, LOAD, speed, damping)
    assert given_out / taken == pytest.approx(1.0 / cos(ALPHA_N) ** 2, rel=1e-9)
    assert given_out / taken == pytest.approx(1.000294, abs=5e-7)
    made = (given_out - taken) / (speed / GEAR.tau) * (pi / 2.0)  # J, of 90 degrees
    assert made == pytest.approx(LOAD * pi / 2.0 * sin(ALPHA_N) ** 2, rel=1e-9)
    assert made == pytest.approx(9.236e-3, abs=1e-6)


def ring_of_modes(form: Form, mesh_damping: float) -> Array:
    """Eigenvalues of the gear by itself, damped in its mesh only; those of positive frequency, slowest first."""
    by_itself = replace(GEAR, K_WG=Spring(0.0), K_CS=Spring(0.0), K_m=Spring(1e8, mesh_damping))
    inverse = 1.0 / masses(by_itself, 1.0, 1.0)[FREE, None]
    k, c = (matrix[np.ix_(FREE, FREE)] for matrix in (stiffness_matrix(by_itself), damping_matrix(by_itself, form)))
    values = np.linalg.eigvals(np.block([[np.zeros((4, 4)), np.eye(4)], [-inverse * k, -inverse * c]]))
    return np.array(sorted((value for value in values if value.imag > 1e3), key=lambda value: value.imag))


def test_with_the_mesh_damped_as_printed_a_gear_left_alone_begins_to_ring_louder_and_louder() -> None:
    """E-A3: at 5964 Hz, by a factor e in 23 ms at c_m = 100 N.s/m; nothing drives it. Corrected, all modes fade."""
    wrong = Form(tan, PRINTED.mesh_rate, 1.0)
    assert np.all(ring_of_modes(RIGHT, 100.0).real < -4.0)
    growing = ring_of_modes(wrong, 100.0)[1]
    assert growing.imag / (2.0 * pi) == pytest.approx(5964.0, abs=1.0)
    assert growing.real == pytest.approx(43.05, abs=0.01)
    assert ring_of_modes(wrong, 1000.0)[1].real == pytest.approx(338.6, abs=0.1)


def test_the_energy_of_a_gear_left_alone_grows_where_its_mesh_is_damped_as_printed() -> None:
    """Integrated, with all dampers but that of the mesh absent, from a flexspline that moves at 1 mm/s."""
    by_itself = replace(GEAR, K_WG=Spring(0.0), K_CS=Spring(0.0), K_m=Spring(1e8, 1000.0))
    start = np.zeros(12)
    start[6 + X2] = start[6 + Y1] = 1e-3
    grown = []
    for form in RIGHT, Form(tan, PRINTED.mesh_rate, 1.0):
        run = solve_ivp(
            rates(by_itself, 1.0, 1.0, none, none, printed_with(form)), (0.0, 5e-3), start, "DOP853", rtol=1e-9, atol=1e-15
        )
        grown.append(energy(by_itself, 1.0, 1.0, run.y[:, -1]) / energy(by_itself, 1.0, 1.0, start))
    assert grown[0] < 1.0
    assert grown[1] > 10.0


def test_the_mesh_damped_as_printed_drives_what_it_should_brake() -> None:
    """c_m (x2' - v)(x2' sin alpha_t - v), v = (y1' + y2') cos alpha_t: at most c_m x2'^2 (1 - sin alpha_t)^2 / 4 is made, at
    v = x2' (1 + sin alpha_t) / 2."""
    damped = replace(GEAR, K_WG=Spring(0.0), K_b=Spring(0.0), K_t=Spring(0.0), K_m=Spring(0.0, 100.0), K_CS=Spring(0.0))
    v = np.zeros(6)
    v[X2], v[Y1] = 1.0, 0.5 * (1.0 + sin(GEAR.alpha_t)) / cos(GEAR.alpha_t)
    power = printed(damped, np.zeros(6), v, Form(tan, PRINTED.mesh_rate, 1.0)) @ v
    assert power == pytest.approx(100.0 * (1.0 - sin(GEAR.alpha_t)) ** 2 / 4.0, rel=1e-12)
    assert printed(damped, np.zeros(6), v, RIGHT) @ v < 0.0


def test_without_its_reaction_a_kinematic_error_makes_energy_too() -> None:
    """E-A5: a turn under a force that follows the error, F_b = F cos(2 theta) with e = E sin(2 theta), makes 2 pi F E."""
    error, force = 1e-5, 100.0
    misaligned = replace(GEAR, e_WG=wave(error, 2.0, 0.0))
    angles = np.linspace(0.0, 2.0 * pi, 401)[:-1]
    made = 0.0
    for theta in angles:
        q = np.zeros(6)
        q[WG] = q[IN] = theta
        x1 = R_G * tan(GEAR.alpha_n) * theta
        q[X2] = x1 + error * sin(2.0 * theta) - force * cos(2.0 * theta) / GEAR.K_b.k
        full = printed(misaligned, q, np.zeros(6), RIGHT)[WG]
        made += (printed(misaligned, q, np.zeros(6), Form(tan, sin, 0.0))[WG] - full) * 2.0 * pi / len(angles)
    assert made == pytest.approx(2.0 * pi * force * error, rel=1e-9)


# The kinematic error


def test_a_radial_displacement_turns_the_output_by_tan_alpha_t_over_r_g() -> None:
    """E-A4: forwards, where Eq. 2 counts an error positive that delays; with the circular spline fixed, backwards."""
    for fixed, sense in ("flexspline", 1.0), ("circular_spline", -1.0):
        gear = replace(GEAR, fixed=fixed, e_WG=lambda _: (3e-5, 0.0))
        moving = [X2, Y1, Y2, OUT]
        forces = corrected(gear, np.zeros(6), np.zeros(6))[moving]
        turned = np.linalg.solve(stiffness_matrix(gear)[np.ix_(moving, moving)], forces)[-1]
        assert turned == pytest.approx(sense * 3e-5 * tan(GEAR.alpha_t) / R_G, rel=1e-9)


def test_a_varying_spring_turns_the_wave_generator() -> None:
    """5 % at order 2 of a spring of 8000 N.m/rad at 20 N.m: a T^2 / k = 2.5 mN.m, 50 mA at 0.05 N.m/A; an error of 3e-4 rad of
    that order has 2 T e / K_t = 240 mA, and 1/K_t of A's 2e4 N.m/rad makes 20 mA of the 50."""
    for k, current in (8000.0, 50e-3), (2e4, 20e-3):
        varying = replace(GEAR, K_t=Spring(k, order=(2.0,), amplitude=(0.05,), phase=(0.0,)))
        torques = []
        for theta in np.linspace(0.0, pi, 201)[:-1]:
            q = np.zeros(6)
            q[WG] = theta
            factor, _ = varying.K_t.factor(theta)
            q[Y1] = R_G * LOAD / (k * factor)
            flexspline = corrected(varying, q, np.zeros(6)) - corrected(replace(varying, K_t=Spring(k)), q, np.zeros(6))
            torques.append(flexspline[WG])
        second = 2.0 * abs(np.fft.rfft(torques)[1]) / len(torques)
        assert second / 0.05 == pytest.approx(current, rel=2e-3)
