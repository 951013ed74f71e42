"""Eigenlines of a gear: natural frequencies in the frame of the lobes over the speed of the wave generator.

In that frame the contacts stand, on the average over a pitch of teeth and of balls, and the ring runs through them. So the
eigenvalues depend on the speed alone. An order q of the input excites a line where q times the speed is its frequency: a wave
that runs around a free ring shows as a line of slope plus or minus its number of waves, a shape that the contacts keep at the
lobes as a line of slope zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig, expm
from scipy.optimize import linear_sum_assignment

from tests.evidence.flexible_ring.gear import Gear, ball_contacts, tooth_contacts
from tests.evidence.flexible_ring.ring import Array

SAMPLES = 48  # of a pitch


@dataclass(frozen=True)
class Lines:
    """Eigenlines over the speed; of each speed and line, shape (speeds, lines).

    Attributes:
        speed: of the wave generator [rad/s], shape (speeds,)
        frequency: in the frame of the lobes [rad/s]
        decay: rate at which the vibration decays [1/s]
        of_teeth, of_balls: largest angle of the output at the line by an equal deviation of all pairs of teeth, or of all
            balls, over that at rest
        waves: mean number of waves around the ring, weighted by energy
    """

    speed: Array
    frequency: Array
    decay: Array
    of_teeth: Array
    of_balls: Array
    waves: Array

    @property
    def slope(self) -> Array:
        """Change of the frequency with the speed."""
        return np.gradient(self.frequency, self.speed, axis=0)

    @property
    def natural_frequency(self) -> Array:
        """Frequency [rad/s] of the straight line that touches the eigenline, at speed zero."""
        return self.frequency - self.slope * self.speed[:, np.newaxis]

    @property
    def damping(self) -> Array:
        """Share of critical damping of the vibration as a mode of that natural frequency."""
        return self.decay / np.abs(self.natural_frequency)


def mean_contacts(gear: Gear, torque: float) -> tuple[Array, Array, Array]:
    """Return stiffness of all contacts in the frame of the lobes, and force by a unit deviation of all teeth, of all balls."""
    size = len(gear.decay)
    stiffness, forces = np.zeros((size, size)), []
    tooth_pitch = 2.0 * np.pi / gear.teeth
    ball_pitch = 2.0 * np.pi / gear.ball_order
    for pitch, contacts_at in (
        (tooth_pitch, lambda angle: tooth_contacts(gear, angle, torque)),
        (ball_pitch, lambda angle: ball_contacts(gear, angle)),
    ):
        angle = pitch * (np.arange(SAMPLES) + 0.5) / SAMPLES
        contacts = contacts_at(angle)
        back = np.array([expm(-each * gear.rotation) for each in angle])
        stiffness += (back @ contacts.matrix() @ back.transpose(0, 2, 1)).mean(axis=0)
        force = -np.einsum("ick,ic->ik", contacts.rows, contacts.stiffness)
        forces.append(np.einsum("ikl,il->ik", back, force).mean(axis=0))
    return stiffness, forces[0], forces[1]


def eigenlines(gear: Gear, speed: Array, torque: float) -> Lines:
    """Return the eigenlines at speeds [rad/s], shape (speeds,), so close together that each line is followed."""
    contact, of_teeth, of_balls = mean_contacts(gear, torque)
    size = len(gear.decay)
    turn, decay = gear.rotation, np.diag(gear.decay) + gear.relaxation * (gear.stiffness + contact)
    at_rest = np.linalg.solve(gear.stiffness + contact, np.stack([of_teeth, of_balls], axis=1))[-1]
    rows, before = [], None
    for each in speed:
        stiffness = gear.stiffness + contact + each * decay @ turn + each**2 * turn @ turn
        state = np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness, -decay - 2.0 * each * turn]])
        values, left, right = eig(state, left=True, right=True)
        up = np.flatnonzero(values.imag > 0.0)
        if before is not None:  # each line goes on as the shape most like its own
            like = np.abs(before.conj().T @ _of_unit_energy(right[:, up], gear))
            up = up[_best_partners(like)]
        values, left, right = values[up], left[:, up], right[:, up]
        before = _of_unit_energy(right, gear)
        scale = np.sum(left.conj() * right, axis=0)
        moved = right[size - 1] / (scale * -values.real)
        peaks = [
            np.abs(moved * (left[size:].conj().T @ force) / rest)
            for force, rest in zip((of_teeth, of_balls), at_rest, strict=True)
        ]
        energy = np.abs(right[size:-1]) ** 2
        rows.append((values.imag, -values.real, *peaks, gear.modes.waves @ energy / np.maximum(energy.sum(axis=0), 1e-300)))
    return Lines(np.asarray(speed), *(np.array(each) for each in zip(*rows, strict=True)))


def _of_unit_energy(vectors: Array, gear: Gear) -> Array:
    """Return eigenvectors scaled so that positions and speeds count alike, shape (2 n, lines)."""
    size = len(gear.decay)
    scaled = vectors.copy()
    scaled[size:] /= np.maximum(np.abs(vectors[size:]).max(axis=0) / np.abs(vectors[:size]).max(axis=0), 1e-300)
    return np.asarray(scaled / np.linalg.norm(scaled, axis=0))


def _best_partners(like: Array) -> Array:
    return np.asarray(linear_sum_assignment(-like)[1])
