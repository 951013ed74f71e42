"""Two rings of plane frame elements, the toothed one and the wall of the cup behind it, on springs to the base of the cup."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

Array = NDArray[np.float64]

PER_NODE = 3  # radial [m], tangential [m], rotation [rad]


def frame_element(length: float, area: float, second_moment: float, modulus: float, density: float) -> tuple[Array, Array]:
    """Return stiffness and consistent mass of a straight beam element: along, across, rotation at either end, shape (6, 6)."""
    along, across = modulus * area / length, modulus * second_moment / length**3
    stiffness = np.zeros((6, 6))
    stiffness[np.ix_([0, 3], [0, 3])] = along * np.array([[1.0, -1.0], [-1.0, 1.0]])
    bending = np.ix_([1, 2, 4, 5], [1, 2, 4, 5])
    a, b = 6.0 * length, length**2
    stiffness[bending] = across * np.array([[12, a, -12, a], [a, 4 * b, -a, 2 * b], [-12, -a, 12, -a], [a, 2 * b, -a, 4 * b]])
    mass = np.zeros((6, 6))
    whole = density * area * length
    mass[np.ix_([0, 3], [0, 3])] = whole / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    c, d = 22.0 * length, 13.0 * length
    mass[bending] = (
        whole / 420.0 * np.array([[156, c, 54, -d], [c, 4 * b, d, -3 * b], [54, d, 156, -c], [-d, -3 * b, -c, 4 * b]])
    )
    return stiffness, mass


def ring_matrices(
    nodes: int, radius: float, thickness: float, width: float, modulus: float, density: float
) -> tuple[Array, Array]:
    """Return stiffness and mass of a free ring, shape (3 nodes, 3 nodes)."""
    step = 2.0 * np.pi / nodes
    length = 2.0 * radius * np.sin(0.5 * step)
    stiffness, mass = frame_element(length, thickness * width, width * thickness**3 / 12.0, modulus, density)
    turn = np.zeros((6, 6))  # from radial, tangential, rotation of both nodes to along, across, rotation of the element
    for node, lean in enumerate((0.5 * step, -0.5 * step)):
        place = PER_NODE * node
        # The chord points along the tangent at its middle, its normal inwards, so that both make a right-handed pair.
        turn[place, place : place + 2] = np.sin(lean), np.cos(lean)
        turn[place + 1, place : place + 2] = -np.cos(lean), np.sin(lean)
        turn[place + 2, place + 2] = 1.0
    stiffness, mass = turn.T @ stiffness @ turn, turn.T @ mass @ turn
    size = PER_NODE * nodes
    all_stiffness, all_mass = np.zeros((size, size)), np.zeros((size, size))
    for node in range(nodes):
        places = (PER_NODE * node + np.arange(2 * PER_NODE)) % size
        all_stiffness[np.ix_(places, places)] += stiffness
        all_mass[np.ix_(places, places)] += mass
    return all_stiffness, all_mass


@dataclass(frozen=True)
class Wall:
    """Sizes of a flexspline and the springs of its cup.

    Attributes:
        nodes: of each ring
        radius: of the middle of the toothed ring and of the wall [m]
        thickness, width: of the toothed ring and of the wall behind it [m]
        modulus, density: of the material [Pa, kg/m3]
        torsion: stiffness from the toothed ring to the wall, and from the wall to the base, about the axis [N.m/rad]
        radial, tangential: the same, all around, of a displacement of each place by itself [N/m]
    """

    nodes: int
    radius: float
    thickness: tuple[float, float]
    width: tuple[float, float]
    modulus: float
    density: float
    torsion: tuple[float, float]
    radial: tuple[float, float]
    tangential: tuple[float, float]


def flexspline_matrices(wall: Wall) -> tuple[Array, Array]:
    """Return stiffness and mass of both rings, the toothed one first, shape (6 nodes, 6 nodes)."""
    size = PER_NODE * wall.nodes
    stiffness, mass = np.zeros((2 * size, 2 * size)), np.zeros((2 * size, 2 * size))
    for ring in range(2):
        own = slice(ring * size, (ring + 1) * size)
        stiffness[own, own], mass[own, own] = ring_matrices(
            wall.nodes, wall.radius, wall.thickness[ring], wall.width[ring], wall.modulus, wall.density
        )
    toothed, behind = np.eye(2 * size)[:size], np.eye(2 * size)[size:]
    for spring, stretch in enumerate((toothed - behind, behind)):
        turn = stretch[1::PER_NODE].mean(axis=0) / wall.radius
        stiffness += wall.torsion[spring] * np.outer(turn, turn)
        for direction, whole in ((0, wall.radial[spring]), (1, wall.tangential[spring])):
            each = stretch[direction::PER_NODE]
            stiffness += whole / wall.nodes * each.T @ each
    return stiffness, mass


@dataclass(frozen=True)
class Modes:
    """Mass-normalised eigenmodes of a flexspline.

    Attributes:
        frequency: natural frequencies [rad/s], shape (modes,)
        waves: number of waves around the ring of each, shape (modes,)
        rotation: generator of a turn about the axis: a shape q turned by an angle a is expm(a rotation) q, shape (modes, modes)
        shape: radial and tangential displacement of the toothed ring over the angle, as coefficients of its cosine and
            sine of that many waves, shape (modes, 2, 2): direction, then cosine and sine
    """

    frequency: Array
    waves: NDArray[np.int64]
    rotation: Array
    shape: Array

    def at(self, angle: Array) -> Array:
        """Return the displacement of the toothed ring at places [rad], shape (..., modes, 2): radial, then tangential."""
        phase = angle[..., np.newaxis] * self.waves
        both = np.stack([np.cos(phase), np.sin(phase)], axis=-1)
        return np.einsum("...kp,kdp->...kd", both, self.shape)

    def radial(self, angle: Array) -> Array:
        """Return the radial displacement of the toothed ring at places [rad], shape (..., modes)."""
        phase = angle[..., np.newaxis] * np.arange(self.waves.max() + 1)
        return np.asarray(
            np.cos(phase)[..., self.waves] * self.shape[:, 0, 0] + np.sin(phase)[..., self.waves] * self.shape[:, 0, 1]
        )


def eigenmodes(wall: Wall, count: int) -> Modes:
    """Return the lowest modes, some `count` of them: a pair of equal frequency is never parted; and the torsion of the cup."""
    stiffness, mass = flexspline_matrices(wall)
    squares, vectors = eigh(stiffness, mass)
    rings = vectors.reshape(2, wall.nodes, PER_NODE, -1)
    # By the symmetry of equal elements a mode's values at the nodes are waves exactly.
    spectrum = np.fft.rfft(rings[:, :, :2], axis=1) / wall.nodes
    waves = np.abs(spectrum).sum(axis=(0, 2)).argmax(axis=0)
    while squares[count] - squares[count - 1] < 1e-6 * squares[count]:
        count += 1
    turns = np.abs(spectrum[0, 0, 1]) > np.abs(spectrum[0, 0, 0])
    torsion = np.flatnonzero((waves == 0) & turns)[:2]
    kept = np.union1d(np.arange(count), torsion)
    waves, vectors = waves[kept], vectors[:, kept]
    line = spectrum[0, waves, :, kept] * np.where(waves == 0, 1.0, 2.0)[:, np.newaxis]
    shape = np.stack([line.real, -line.imag], axis=-1)
    turned = np.roll(rings[..., kept], 1, axis=1).reshape(len(mass), -1)
    step = vectors.T @ mass @ turned  # a turn by one element
    sine = np.sin(2.0 * np.pi * waves / wall.nodes)
    rotation = 0.5 * (step - step.T) * np.divide(waves, sine, out=np.zeros(len(waves)), where=waves > 0)
    return Modes(np.sqrt(squares[kept]), waves, rotation, shape)
