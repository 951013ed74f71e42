"""A drawn strain wave gear: flexspline, teeth, balls of the wave generator's bearing, output."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tests.evidence.flexible_ring.ring import Array, Modes, Wall, eigenmodes

NODES, MODES = 72, 24
MORE_TEETH = 2  # of the circular spline


@dataclass(frozen=True)
class Gear:
    """A gear whose flexspline is held and whose circular spline turns with the load.

    Attributes:
        wall: sizes of the flexspline
        damping: ratio of each of its modes to the critical one
        relaxation: damping of all springs, contacts too, over their stiffness [s]
        teeth: of the flexspline; the circular spline has two more
        pressure_angle: of the line of action [rad]
        pair_stiffness: of one pair of teeth in the middle of its engagement [N/m]
        engaged: half of the angle over which teeth engage at each lobe without load [rad]
        spread: increase of that angle at the rated torque, relative
        rated_torque: [N.m]
        flexspline_pitch, circular_pitch: deviation of each tooth along the line of action [m]
        relief: deviation of the flank at the ends of its engagement [m]
        balls, ball_diameter, pitch_diameter: of the bearing [1, m, m]
        ball_sizes: deviation of the diameter of each ball [m]
        ball_stiffness: of one ball under a lobe [N/m]
        loaded: half of the angle over which balls carry load at each lobe [rad]
        first_ball: angle of a ball before the first lobe, at rest [rad]
        output_inertia: circular spline and load [kg.m2]
        output_stiffness: of a spring from the output to a shaft that turns evenly [N.m/rad]
        output_damping: rate at which a speed of the output against that shaft decays [1/s]
    """

    wall: Wall
    damping: Array
    relaxation: float
    teeth: int
    pressure_angle: float
    pair_stiffness: float
    engaged: float
    spread: float
    rated_torque: float
    flexspline_pitch: Array
    circular_pitch: Array
    relief: float
    balls: int
    ball_diameter: float
    pitch_diameter: float
    ball_sizes: Array
    ball_stiffness: float
    loaded: float
    first_ball: float
    output_inertia: float
    output_stiffness: float
    output_damping: float

    @cached_property
    def modes(self) -> Modes:
        """Eigenmodes of the flexspline without teeth and balls in contact."""
        return eigenmodes(self.wall, MODES)

    @property
    def ratio(self) -> float:
        """Input angle over output angle: a tooth of the circular spline moves two teeth on in a revolution of the lobes."""
        return (self.teeth + MORE_TEETH) / MORE_TEETH

    @property
    def deflection(self) -> float:
        """Radial deflection of the ring at a lobe [m]: half of the difference of the pitch diameters."""
        return self.wall.radius * MORE_TEETH / self.teeth

    @cached_property
    def cage_share(self) -> float:
        """Speed of the balls around the ring over that of the wave generator.

        Seen from the lobes the ring's race runs through, the generator's race stands, and a ball rolls between both: its centre
        runs half as fast as the ring's race. A parallel curve a ball's radius outside the path of the centres is longer by pi
        times the ball's diameter. So the centres need longer for their path than the race for its own.
        """
        path = np.pi * self.pitch_diameter
        race = path + np.pi * self.ball_diameter
        behind_lobes = 0.5 * race / path
        return float(1.0 - behind_lobes)

    @property
    def ball_order(self) -> float:
        """Balls that pass one lobe per revolution of the wave generator."""
        return self.balls * (1.0 - self.cage_share)

    @cached_property
    def stiffness(self) -> Array:
        """Stiffness without contacts, of the modes and then of the output, per unit of modal mass, shape (n, n)."""
        return np.diag(np.append(self.modes.frequency**2, self.output_stiffness / self.output_inertia))

    @cached_property
    def decay(self) -> Array:
        """Rate at which the speed of each coordinate decays [1/s], shape (n,)."""
        return np.append(2.0 * self.damping * self.modes.frequency, self.output_damping)

    @cached_property
    def tooth_rows(self) -> Array:
        """Stretch along the line of action at each tooth of the flexspline, of each coordinate, shape (teeth, n)."""
        sine, cosine = np.sin(self.pressure_angle), np.cos(self.pressure_angle)
        ring = self.modes.at(2.0 * np.pi * np.arange(self.teeth) / self.teeth) @ np.array([sine, cosine])
        return np.pad(ring, ((0, 0), (0, 1)), constant_values=-cosine * self.wall.radius * self.output_scale)

    @property
    def output_scale(self) -> float:
        """Angle of the output [rad] per unit of its coordinate."""
        return 1.0 / float(np.sqrt(self.output_inertia))

    @property
    def rotation(self) -> Array:
        """Generator of a turn of the ring's shape; the output does not turn with it, shape (n, n)."""
        return np.pad(self.modes.rotation, (0, 1))

    def half_width(self, torque: float) -> float:
        """Return half of the angle over which teeth engage at each lobe [rad]."""
        return self.engaged * (1.0 + self.spread * np.sqrt(abs(torque) / self.rated_torque))


def hill(place: Array, half_width: float) -> Array:
    """Return a weight that is one in the middle of a zone and falls to zero at its ends."""
    return np.asarray(np.maximum(1.0 - (place / half_width) ** 2, 0.0))


@dataclass(frozen=True)
class Contacts:
    """Contacts at instants: stretch = rows @ coordinates + offset; each pushes back by its stiffness times its stretch.

    Attributes:
        rows: shape (instants, contacts, n)
        offset: [m], shape (instants, contacts)
        stiffness: [N/m], shape (instants, contacts)
    """

    rows: Array
    offset: Array
    stiffness: Array

    def matrix(self) -> Array:
        """Return the stiffness of the coordinates, shape (instants, n, n)."""
        return np.matmul(self.rows.transpose(0, 2, 1), self.stiffness[..., np.newaxis] * self.rows)

    def force(self) -> Array:
        """Return the force on the coordinates while they are zero, shape (instants, n)."""
        return -np.einsum("ick,ic->ik", self.rows, self.stiffness * self.offset)


def tooth_contacts(gear: Gear, angle: Array, torque: float) -> Contacts:
    """Return the contacts of pairs of teeth at angles of the wave generator [rad], shape (instants,).

    Tooth j of the flexspline stands at 2 pi j / teeth. In the middle of its engagement at the first lobe it meets tooth j of
    the circular spline, at the second lobe the next one.
    """
    half_width, pitch = gear.half_width(torque), 2.0 * np.pi / gear.teeth
    beside = np.arange(-int(half_width / pitch) - 1, int(half_width / pitch) + 2)
    lobe = angle[:, np.newaxis] + np.array([0.0, np.pi])
    tooth = np.round(lobe / pitch).astype(np.int64)[..., np.newaxis] + beside
    place = tooth * pitch - lobe[..., np.newaxis]
    tooth, place = tooth.reshape(len(angle), -1), place.reshape(len(angle), -1)
    # Counted without wrapping, the lobes have passed tooth `tooth` once more in each half revolution.
    passes = np.repeat(np.arange(2), len(beside))
    facing = tooth % gear.teeth + passes - (tooth // gear.teeth) * MORE_TEETH
    error = (
        gear.flexspline_pitch[tooth % gear.teeth]
        - gear.circular_pitch[facing % len(gear.circular_pitch)]
        + gear.relief * (place / half_width) ** 2
    )
    sine, cosine = np.sin(gear.pressure_angle), np.cos(gear.pressure_angle)
    # The ideal ellipse of constant length fits the teeth without stretch.
    ellipse = gear.deflection * (sine * np.cos(2.0 * place) - 0.5 * cosine * np.sin(2.0 * place))
    stiffness = gear.pair_stiffness * hill(place, half_width)
    return Contacts(gear.tooth_rows[tooth % gear.teeth], error - ellipse, stiffness)


def ball_contacts(gear: Gear, angle: Array) -> Contacts:
    """Return the contacts of the balls between the ellipse of the wave generator and the ring."""
    first = gear.first_ball + gear.cage_share * angle
    place = first[:, np.newaxis] + 2.0 * np.pi * np.arange(gear.balls) / gear.balls
    before = place - angle[:, np.newaxis]
    from_lobe = (before + 0.5 * np.pi) % np.pi - 0.5 * np.pi
    ring = gear.modes.radial(place)
    rows = np.concatenate([ring, np.zeros((*ring.shape[:2], 1))], axis=-1)
    offset = -gear.deflection * np.cos(2.0 * before) - gear.ball_sizes
    return Contacts(rows, offset, gear.ball_stiffness * hill(from_lobe, gear.loaded))


def drawn(random: np.random.Generator) -> Gear:
    """Return a gear of a real size, 14 to 40, with steel of usual sizes and teeth of usual accuracy."""
    radius, teeth = float(random.uniform(17e-3, 50e-3)), 2 * int(random.choice([50, 50, 60, 80, 100, 100, 120]))
    wall, scale = _drawn_wall(random, radius), radius / 31e-3
    flexspline, circular = (_drawn_pitch(random, count, scale) for count in (teeth, teeth + MORE_TEETH))
    half_width = float(random.uniform(0.35, 0.7))
    torsion = 7e4 * scale**3 * float(np.exp(random.uniform(-0.7, 0.7)))  # N.m/rad of the mesh
    pressure_angle = float(random.uniform(0.3, 0.6))
    pairs = 8.0 / 3.0 * half_width / (2.0 * np.pi / teeth)  # of both lobes, by weight
    pair_stiffness = torsion / (pairs * (radius * np.cos(pressure_angle)) ** 2)
    resonance = 2.0 * np.pi * float(np.exp(random.uniform(np.log(100.0), np.log(4000.0))))
    whole = 1.0 / (1.0 / torsion + sum(1.0 / each for each in wall.torsion))
    inertia = whole / resonance**2
    balls = int(random.integers(19, 28))
    pitch_diameter = 1.62 * radius
    ball_diameter = float(random.uniform(0.55, 0.8)) * np.pi * pitch_diameter / balls
    pair = np.unique(np.round(eigenmodes(wall, MODES).frequency, 3), return_inverse=True)[1]
    return Gear(
        wall=wall,
        damping=float(np.exp(random.uniform(np.log(0.003), np.log(0.03)))) * np.exp(random.uniform(-0.3, 0.3, len(pair)))[pair],
        relaxation=float(random.uniform(0.5e-6, 2e-6)),
        teeth=teeth,
        pressure_angle=pressure_angle,
        pair_stiffness=pair_stiffness,
        engaged=half_width,
        spread=float(random.uniform(0.0, 0.3)),
        rated_torque=100.0 * scale**3,
        flexspline_pitch=flexspline,
        circular_pitch=circular,
        relief=scale * float(random.uniform(0.0, 10e-6)),
        balls=balls,
        ball_diameter=ball_diameter,
        pitch_diameter=pitch_diameter,
        ball_sizes=float(random.uniform(0.1e-6, 1e-6)) * random.standard_normal(balls),
        ball_stiffness=float(random.uniform(2e7, 1e8)),
        loaded=float(random.uniform(0.5, 1.0)),
        first_ball=float(random.uniform(0.0, 2.0 * np.pi)),
        output_inertia=inertia,
        output_stiffness=float(random.choice([0.0, 0.0, random.uniform(0.05, 0.3)])) * whole,
        output_damping=2.0 * resonance * float(np.exp(random.uniform(np.log(0.003), np.log(0.03)))),
    )


def _drawn_wall(random: np.random.Generator, radius: float) -> Wall:
    modulus, density = float(random.uniform(1.95e11, 2.1e11)), float(random.uniform(7700.0, 7900.0))
    thickness = radius * float(random.uniform(0.03, 0.045)), radius * float(random.uniform(0.009, 0.015))
    width = radius * float(random.uniform(0.4, 0.7)), radius * float(random.uniform(0.7, 1.2))
    shear = modulus / 2.6 * 2.0 * np.pi * radius**3 * thickness[1] / width[1]  # N.m/rad of the whole cup in torsion
    wall_mass = density * 2.0 * np.pi * radius * thickness[1] * width[1]
    lowest = 2.0 * np.pi * np.exp(random.uniform(np.log(300.0), np.log(1500.0)))  # rad/s of the wall on its springs
    base = float(wall_mass * lowest**2)
    coupling = base * float(np.exp(random.uniform(np.log(0.1), np.log(4.0))))
    return Wall(
        NODES, radius, thickness, width, modulus, density, (2.0 * shear, 2.0 * shear), (coupling, base), (0.5 * coupling, base)
    )


def _drawn_pitch(random: np.random.Generator, count: int, scale: float) -> NDArray[np.float64]:
    """Return deviations of the pitch [m]: waves of one to four a revolution, and a random part of each tooth."""
    angle = 2.0 * np.pi * np.arange(count) / count
    waves = np.arange(1, 5)
    size = scale * 3e-6 / waves * random.uniform(0.2, 1.5, 4)
    phase = random.uniform(0.0, 2.0 * np.pi, 4)
    single = scale * float(random.uniform(0.3e-6, 1.5e-6)) * random.standard_normal(count)
    return np.asarray(size @ np.cos(np.outer(waves, angle) + phase[:, np.newaxis]) + single)
