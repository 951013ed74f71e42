"""Tables of finite elements: the mesh and the modes of a flexible ring."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.evidence.flexible_ring.gear import Gear, hill, tooth_contacts
from tests.evidence.flexible_ring.motion import rest, stiffness_and_force
from tests.evidence.flexible_ring.ring import Array

Table = dict[str, Array]
MODES_COLUMNS = "frequency [Hz]", "waves [1]", "damping_ratio [1]", "mass_at_mesh [kg]"
CONTACTS_PER_BALL = 12  # contacts in the place of a ball
LARGEST_MASS = 1e3  # kg; modes that move the mesh less are not listed


def with_even_bearing(gear: Gear) -> Gear:
    """Return a gear whose bearing is as stiff all the way, as a bearing without balls in finite elements."""
    count = CONTACTS_PER_BALL * gear.balls
    return replace(gear, balls=count, ball_stiffness=gear.ball_stiffness / CONTACTS_PER_BALL, ball_sizes=np.zeros(count))


def mesh_table(gear: Gear, angle: Array, torque: Array) -> Table:
    """Return the columns of a quasi-static table: one row for each torque and angle, the angle fastest.

    `transmission_error` is the output angle less the input angle over the ratio, `stiffness` the torque over the turn that a
    little more of it adds while generator and base stand, `mesh_stiffness` the part of the teeth: the ring does not deform.
    The bearing of the generator has no single balls.

    Args:
        angle: of the wave generator [rad], shape (n,)
        torque: on the output against its motion [N.m], shape (m,)
    """
    gear = with_even_bearing(gear)
    columns: dict[str, list[Array]] = {}
    for load in torque:
        compliance = np.linalg.inv(stiffness_and_force(gear, angle, float(load))[0])[:, -1, -1]
        rows = tooth_contacts(gear, angle, float(load))
        lever = gear.wall.radius * np.cos(gear.pressure_angle)
        for name, values in {
            "wave_generator_angle [rad]": angle,
            "torque [N.m]": np.full(len(angle), load),
            "transmission_error [rad]": gear.output_scale * rest(gear, angle, float(load))[:, -1],
            "stiffness [N.m/rad]": 1.0 / (gear.output_scale**2 * compliance),
            "mesh_stiffness [N.m/rad]": rows.stiffness.sum(axis=1) * lever**2,
        }.items():
            columns.setdefault(name, []).append(values)
    return {name: np.concatenate(values) for name, values in columns.items()}


def modes_table(gear: Gear, torque: float = 0.0) -> Table:
    """Return the modes of the flexspline on its base without contacts that move the mesh; a pair of equal frequency is one row.

    `mass_at_mesh` is one over the square of the displacement along the line of action, mean over the engaged teeth, of the
    mode that is scaled to unit mass and stands where it is largest.
    """
    modes, half_width = gear.modes, gear.half_width(torque)
    pitch = 2.0 * np.pi / gear.teeth
    place = pitch * np.arange(gear.teeth)
    from_lobe = (place + 0.5 * np.pi) % np.pi - 0.5 * np.pi
    weight = hill(from_lobe, half_width)
    moved = weight @ gear.tooth_rows[:, :-1] / weight.sum()
    pairs = np.unique(np.round(modes.frequency, 3), return_inverse=True)[1]
    rows = []
    for pair in range(pairs.max() + 1):
        members = np.flatnonzero(pairs == pair)
        square = float(np.sum(moved[members] ** 2))
        if square * LARGEST_MASS > 1.0:
            frequency = modes.frequency[members[0]]
            ratio = gear.damping[members[0]] + 0.5 * gear.relaxation * frequency
            rows.append((frequency / (2.0 * np.pi), modes.waves[members[0]], ratio, 1.0 / square))
    return {name: np.array(values) for name, values in zip(MODES_COLUMNS, np.array(rows).T, strict=True)}
