"""The flexible ring of `tests.evidence` by itself: textbook rings, springs in closed form, and orders that come out of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from tests.evidence.flexible_ring.gear import Gear, ball_contacts, drawn
from tests.evidence.flexible_ring.motion import move, rest, stiffness_and_force
from tests.evidence.flexible_ring.ring import PER_NODE, ring_matrices
from tests.evidence.flexible_ring.tables import mesh_table, modes_table
from tests.evidence.flexible_ring.truth import eigenlines

NODES, RADIUS, THICKNESS, WIDTH, MODULUS, DENSITY = 72, 0.031, 0.0006, 0.015, 2.06e11, 7850.0
SECOND_MOMENT = WIDTH * THICKNESS**3 / 12.0


def test_a_free_ring_has_the_frequencies_of_the_textbook():
    """Love's formula for inextensional bending, Timoshenko, "Vibration problems in engineering" (1937), article 62."""
    squares = eigh(*ring_matrices(NODES, RADIUS, THICKNESS, WIDTH, MODULUS, DENSITY), eigvals_only=True)
    n = np.arange(2, 6)
    scale = MODULUS * SECOND_MOMENT / (DENSITY * THICKNESS * WIDTH * RADIUS**4)
    love = scale * (n * (n**2 - 1.0)) ** 2 / (n**2 + 1.0)
    assert np.all(np.abs(squares[:3]) < 1e-6 * love[0])  # it moves freely in its plane
    # Chords instead of arcs, and extension.
    np.testing.assert_allclose(squares[3:11:2], love, rtol=4e-3)
    np.testing.assert_allclose(squares[4:12:2], squares[3:11:2], rtol=1e-6)


def test_two_opposite_forces_deflect_a_ring_as_in_closed_form():
    """Between them by (pi / 4 - 2 / pi) F R^3 / E I, Timoshenko, "Strength of materials" part 1, article 80."""
    stiffness, _ = ring_matrices(NODES, RADIUS, THICKNESS, WIDTH, MODULUS, DENSITY)
    force = np.zeros(len(stiffness) - PER_NODE)  # the first node is held
    force[PER_NODE * (NODES // 2 - 1)] = 1.0
    shape = np.linalg.solve(stiffness[PER_NODE:, PER_NODE:], force)
    expected = (np.pi / 4.0 - 2.0 / np.pi) * RADIUS**3 / (MODULUS * SECOND_MOMENT)
    assert shape @ force == pytest.approx(expected, rel=4e-3)


def test_balls_roll_without_slip():
    gear = drawn(np.random.default_rng(3))
    # Speeds of the races, in the frame of the cage, at the two ends of a ball's diameter are opposite: it spins in its place.
    inner, outer = (0.5 * (gear.pitch_diameter + side * gear.ball_diameter) for side in (-1.0, 1.0))
    of_cage = gear.cage_share
    assert (1.0 - of_cage) * inner == pytest.approx(of_cage * outer)
    one_pass = 2.0 * np.pi / gear.ball_order
    even = replace(gear, ball_sizes=np.zeros(gear.balls))
    first, later = (ball_contacts(even, np.array([angle])).stiffness for angle in (0.4, 0.4 + one_pass))
    np.testing.assert_allclose(np.sort(first), np.sort(later), atol=1e-3 * gear.ball_stiffness)


def test_the_mesh_table_is_that_of_the_springs():
    gear = drawn(np.random.default_rng(2))
    angle = np.linspace(0.0, 2.0 * np.pi / gear.teeth, 9)
    table = mesh_table(gear, angle, np.array([0.0, 5.0]))
    lever = gear.wall.radius * np.cos(gear.pressure_angle)
    # Sum of the weights 1 - (place / half width)^2 at both lobes, as an integral.
    smooth = gear.pair_stiffness * 8.0 / 3.0 * gear.engaged / (2.0 * np.pi / gear.teeth) * lever**2
    np.testing.assert_allclose(table["mesh_stiffness [N.m/rad]"][:9], smooth, rtol=3e-3)
    assert np.all(table["stiffness [N.m/rad]"] < table["mesh_stiffness [N.m/rad]"])
    stiffness, force = stiffness_and_force(gear, angle[:1], 5.0)
    np.testing.assert_allclose(stiffness[0] @ rest(gear, angle[:1], 5.0)[0], force[0], rtol=1e-6, atol=1e-9)
    modes = modes_table(gear)
    # Of equal and opposite lobes' sums, odd numbers of waves cancel.
    assert set(modes["waves [1]"].tolist()) <= {0.0, 2.0, 4.0, 6.0, 8.0}


def plain(seed: int) -> Gear:
    """Return a drawn gear whose teeth and balls have no deviations."""
    gear = drawn(np.random.default_rng(seed))
    no_pitch = {name: np.zeros(len(getattr(gear, name))) for name in ("flexspline_pitch", "circular_pitch", "ball_sizes")}
    return replace(gear, **no_pitch)


def test_orders_of_teeth_and_balls_come_out_of_perfect_ones():
    gear, revolutions = plain(2), 5
    angle = 2.0 * np.pi * np.arange(revolutions * 8 * gear.teeth) / (8 * gear.teeth)
    error = rest(gear, angle, 0.0)[:, -1]
    amplitude = np.abs(np.fft.rfft(np.hanning(len(error)) * (error - error.mean())))
    order = np.arange(len(amplitude)) / revolutions
    both_lobes = gear.ball_order * (1 + gear.balls % 2)
    causes = [both_lobes, 2.0 * both_lobes, gear.teeth]
    strongest = [float(order[np.abs(order - each) < 1.0][np.argmax(amplitude[np.abs(order - each) < 1.0])]) for each in causes]
    assert strongest == pytest.approx(causes, abs=1.0 / revolutions)
    others = np.all([np.abs(order - each) > 0.5 for each in (*causes, 0.0)], axis=0) & (order < 1.1 * gear.teeth)
    assert amplitude[others].max() < 0.5 * max(amplitude[np.abs(order - each) < 0.5].max() for each in causes)


def test_an_eigenline_is_where_the_motion_is_largest():
    gear = plain(0)
    lines = eigenlines(gear, 2.0 * np.pi * np.array([30.0, 35.0, 40.0]), 0.0)
    both_lobes = 2.0 * gear.ball_order
    peak = lines.frequency[1, np.argmax(lines.of_teeth[1])] / both_lobes
    speed = peak * np.linspace(0.985, 1.015, 7)
    motion = move(gear, speed, speed, 0.0, revolutions=2.0, settling=2.0)
    window = np.hanning(len(motion.angle) - 1)
    error = motion.error[:-1] - motion.error[:-1].mean(axis=0)
    answer = np.abs((window * np.exp(-1j * both_lobes * motion.angle[:-1])) @ error)
    bend, lean, _ = np.polyfit(speed / peak - 1.0, answer**-2.0, 2)
    assert abs(0.5 * lean / bend) < 1e-3
