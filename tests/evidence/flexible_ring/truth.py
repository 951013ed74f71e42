"""Eigenlines of a gear: natural frequencies in the frame of the lobes over the speed of the wave generator.

In that frame the mean contacts stand and the ring runs through them. Shapes come from the mean over a pitch of teeth and of
balls, frequency and decay from the return map of one pass of a ball (Floquet): the stiffness of the balls varies so much that
its mean is 0.2 % too stiff. An order q of the input excites a line where q times the speed is its frequency. A wave that runs
around a free ring shows as a line of slope plus or minus its number of waves, a shape that the contacts keep at the lobes as a
line of slope zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eig, expm
from scipy.optimize import linear_sum_assignment

from tests.evidence.flexible_ring.gear import Gear, ball_contacts, tooth_contacts
from tests.evidence.flexible_ring.motion import stepped
from tests.evidence.flexible_ring.ring import Array

SAMPLES = 48  # of a pitch
STEPS = 128  # of time, in the pass of a ball


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
        """Change of the frequency with the speed, of straight lines through a third of the speeds.

        Where the pass of the balls couples two lines, their frequencies step aside by some 0.1 %, and a tangent would not hold.
        """
        reach = max(len(self.speed) // 6, 1)
        parts = [slice(max(place - reach, 0), place + reach + 1) for place in range(len(self.speed))]
        return np.array([np.polyfit(self.speed[part], self.frequency[part], 1)[0] for part in parts])

    @property
    def natural_frequency(self) -> Array:
        """Frequency [rad/s] of the straight line that touches the eigenline, at speed zero."""
        return self.frequency - self.slope * self.speed[:, np.newaxis]

    @property
    def damping(self) -> Array:
        """Share of critical damping of the vibration as a mode of that natural frequency."""
        return self.decay / np.abs(self.natural_frequency)


def mean_contacts(gear: Gear, torque: float) -> tuple[list[Array], list[Array]]:
    """Return in the frame of the lobes the stiffness of teeth and balls, and their force by a deviation of one metre of all."""
    stiffness, forces = [], []
    tooth_pitch = 2.0 * np.pi / gear.teeth
    ball_pitch = 2.0 * np.pi / gear.ball_order
    for pitch, contacts_at in (
        (tooth_pitch, lambda angle: tooth_contacts(gear, angle, torque)),
        (ball_pitch, lambda angle: ball_contacts(gear, angle)),
    ):
        angle = pitch * (np.arange(SAMPLES) + 0.5) / SAMPLES
        contacts = contacts_at(angle)
        back = np.array([expm(-each * gear.rotation) for each in angle])
        stiffness.append((back @ contacts.matrix() @ back.transpose(0, 2, 1)).mean(axis=0))
        force = -np.einsum("ick,ic->ik", contacts.rows, contacts.stiffness)
        forces.append(np.einsum("ikl,il->ik", back, force).mean(axis=0))
    return stiffness, forces


def return_maps(gear: Gear, speed: Array, of_teeth: Array) -> Array:
    """Return the change of position and speed in the frame of the lobes over the pass of a ball, shape (speeds, 2 n, 2 n).

    Args:
        of_teeth: mean stiffness of the teeth in that frame, shape (n, n)
    """
    size, pass_angle = len(gear.decay), 2.0 * np.pi / gear.ball_order
    turn, angle = gear.rotation, pass_angle * (np.arange(STEPS) + 0.5) / STEPS
    ahead = np.array([expm(each * turn) for each in angle])
    stiffness = gear.stiffness + ball_contacts(gear, angle).matrix() + ahead @ of_teeth @ ahead.transpose(0, 2, 1)
    squares, vectors = np.linalg.eigh(stiffness)
    duration = np.repeat(pass_angle / STEPS / speed, 2 * size)
    x = np.tile(np.eye(size, 2 * size), len(speed))
    v = np.tile(np.eye(size, 2 * size, size), len(speed)) + np.repeat(speed, 2 * size) * (turn @ x)
    for square, shapes in zip(squares, vectors, strict=True):
        v, x = stepped(gear, x, v, duration, np.sqrt(square)[:, np.newaxis], shapes, np.zeros((size, 1)))
    back = expm(-pass_angle * turn)
    x = back @ x
    v = back @ v - np.repeat(speed, 2 * size) * (turn @ x)
    return np.asarray(np.concatenate([x, v]).reshape(2 * size, len(speed), 2 * size).transpose(1, 0, 2))


def eigenlines(gear: Gear, speed: Array, torque: float) -> Lines:
    """Return the eigenlines at speeds [rad/s], shape (speeds,), so close together that each line is followed."""
    (of_teeth, of_balls), forces = mean_contacts(gear, torque)
    stiffness = gear.stiffness + of_teeth + of_balls
    size = len(gear.decay)
    turn, decay = gear.rotation, np.diag(gear.decay) + gear.relaxation * stiffness
    at_rest = np.linalg.solve(stiffness, np.transpose(forces))[-1]
    rows, before = [], None
    for each, of_pass in zip(speed, return_maps(gear, speed, of_teeth), strict=True):
        centred = stiffness + each * decay @ turn + each**2 * turn @ turn
        state = np.block([[np.zeros((size, size)), np.eye(size)], [-centred, -decay - 2.0 * each * turn]])
        values, left, right = eig(state, left=True, right=True)
        up = np.flatnonzero(values.imag > 0.0)
        if before is not None:  # each line goes on as the shape most like its own
            up = up[_partners(before.conj().T @ right[:, up])]
        values, left, right = values[up], left[:, up], right[:, up]
        before = left / np.linalg.norm(left * _scales(values, size), axis=0)
        scale = np.sum(left.conj() * right, axis=0)
        moved = right[size - 1] / (scale * -values.real)
        peaks = [np.abs(moved * (left[size:].conj().T @ force) / rest) for force, rest in zip(forces, at_rest, strict=True)]
        exact = _exponents(of_pass, left / scale.conj(), values, 2.0 * np.pi / (gear.ball_order * each))
        energy = np.abs(right[size:-1]) ** 2
        rows.append((exact.imag, -exact.real, *peaks, gear.modes.waves @ energy / np.maximum(energy.sum(axis=0), 1e-300)))
    return Lines(np.asarray(speed), *(np.array(each) for each in zip(*rows, strict=True)))


def _exponents(of_pass: Array, left: Array, near: Array, duration: float) -> Array:
    """Return the exponents of a return map [1/s] that belong to shapes, next to exponents of the mean contacts."""
    factors, shapes = np.linalg.eig(of_pass)
    partner = _partners(left.conj().T @ (shapes / np.linalg.norm(shapes[: len(shapes) // 2], axis=0)))
    exponents = np.log(factors[partner]) / duration
    turns = np.round((near - exponents).imag * duration / (2.0 * np.pi))
    return np.asarray(exponents + 2j * np.pi * turns / duration)


def _scales(values: Array, size: int) -> Array:
    """Return by how much speeds exceed positions in each line, shape (2 n, lines)."""
    return np.concatenate([np.ones((size, len(values))), np.tile(np.abs(values), (size, 1))])


def _partners(like: Array) -> Array:
    return np.asarray(linear_sum_assignment(-np.abs(like))[1])
