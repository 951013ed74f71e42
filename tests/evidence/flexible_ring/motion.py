"""Time integration of a gear at many constant speeds, or along many ramps of the speed, at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tests.evidence.flexible_ring.gear import Contacts, Gear, ball_contacts, tooth_contacts
from tests.evidence.flexible_ring.ring import Array

INSTANTS_AT_ONCE = 256  # instants whose contacts are computed together
MAX_STEP = 1.0 / 15e3  # s
SENSOR_PLACE = 0.3  # rad, on the toothed ring


def stiffness_and_force(gear: Gear, angle: Array, torque: float) -> tuple[Array, Array]:
    """Return stiffness, shape (instants, n, n), and force, shape (instants, n), at angles of the wave generator [rad]."""
    contacts: tuple[Contacts, ...] = tooth_contacts(gear, angle, torque), ball_contacts(gear, angle)
    stiffness = gear.stiffness + sum(each.matrix() for each in contacts)
    force = sum(each.force() for each in contacts)
    load = np.zeros(stiffness.shape[-1])
    load[-1] = -torque * gear.output_scale
    return np.asarray(stiffness), np.asarray(force + load)


@dataclass(frozen=True)
class Motion:
    """Motion of a gear after its transients.

    Attributes:
        angle: of the wave generator [rad], shape (instants,)
        time: at each angle [s], shape (instants, speeds)
        error: output angle less input angle over the ratio [rad], shape (instants, speeds)
        radial: acceleration of one place of the toothed ring [m/s2], shape (instants, speeds)
    """

    angle: Array
    time: Array
    error: Array
    radial: Array


def move(
    gear: Gear, first: Array, last: Array, torque: float, *, revolutions: float = 16.0, settling: float = 8.0, finer: int = 1
) -> Motion:
    """Return the motion along ramps of the square of the speed over the angle, of constant speed if both ends are equal.

    Each step holds the stiffness and the force of its middle and follows the oscillation in it exactly. The damping of the
    modes acts in two halves before and after (splitting of Strang, order 2).

    Args:
        first, last: speed of the wave generator [rad/s] at the beginning and the end, shape (speeds,)
        torque: of the load [N.m]
        revolutions: that are given back, from angle zero on
        settling: revolutions that pass at the first speed before
        finer: steps in the place of one; one is a fifteenth of a millisecond at the most, because vibrations of lightly damped
            modes would grow at resonances with longer steps
    """
    pitch = 2.0 * np.pi / gear.teeth
    steps = finer * int(np.ceil(pitch / (MAX_STEP * min(first.min(), last.min()))))
    before, count = round(settling * steps * gear.teeth), round(revolutions * steps * gear.teeth)
    angle = pitch / steps * np.arange(-before, count + 1)
    share = np.clip(0.5 * (angle[1:] + angle[:-1]) / angle[-1], 0.0, 1.0)[:, np.newaxis]
    duration = np.diff(angle)[:, np.newaxis] / np.sqrt(first**2 + share * (last**2 - first**2))
    sensor = np.append(gear.modes.radial(np.array(SENSOR_PLACE)), 0.0)
    x = np.repeat(rest(gear, angle[:1], torque).T, len(first), axis=1)
    v = np.zeros_like(x)
    error, radial = (np.zeros((len(angle), len(first))) for _ in range(2))
    error[0] = gear.output_scale * x[-1]
    for number, (rate, vectors, centre) in enumerate(_springs(gear, 0.5 * (angle[:-1] + angle[1:]), torque)):
        faster, x = stepped(gear, x, v, duration[number], rate, vectors, centre)
        error[number + 1] = gear.output_scale * x[-1]
        radial[number + 1] = sensor @ (faster - v) / duration[number]
        v = faster
    time = np.vstack([np.zeros(len(first)), np.cumsum(duration[before:], axis=0)])
    return Motion(angle[before:], time, error[before:], radial[before:])


def stepped(gear: Gear, x: Array, v: Array, duration: Array, rate: Array, vectors: Array, centre: Array) -> tuple[Array, Array]:
    """Return speeds and coordinates after a step, shape (n, columns), with the springs of its middle.

    Args:
        x, v: coordinates and speeds before, shape (n, columns)
        duration: of the step in each column [s], shape (columns,)
        rate, vectors, centre: natural frequencies [rad/s], shape (n, 1), their shapes, shape (n, n), and rest in these shapes
    """
    slower = np.exp(-0.5 * gear.decay[:, np.newaxis] * duration)
    from_rest, speed = vectors.T @ x - centre, vectors.T @ (slower * v)
    decay = 0.5 * gear.relaxation * rate**2
    damped = np.sqrt(rate**2 - decay**2)
    fading = np.exp(-decay * duration)
    cosine, sine = fading * np.cos(damped * duration), fading * np.sin(damped * duration) / damped
    faster = slower * (vectors @ (cosine * speed - sine * (rate**2 * from_rest + decay * speed)))
    return faster, vectors @ (centre + cosine * from_rest + sine * (speed + decay * from_rest))


def _springs(gear: Gear, angle: Array, torque: float) -> Iterator[tuple[Array, Array, Array]]:
    """Yield of each step frequencies [rad/s], shape (n, 1), shapes, shape (n, n), and rest in these shapes, shape (n, 1)."""
    for begin in range(0, len(angle), INSTANTS_AT_ONCE):
        stiffness, force = stiffness_and_force(gear, angle[begin : begin + INSTANTS_AT_ONCE], torque)
        squares, vectors = np.linalg.eigh(stiffness)
        centre = np.einsum("ikm,ik->im", vectors, force) / squares
        yield from zip(np.sqrt(squares)[..., np.newaxis], vectors, centre[..., np.newaxis], strict=True)


def rest(gear: Gear, angle: Array, torque: float) -> Array:
    """Return the coordinates at rest at angles of the wave generator [rad], shape (instants, n)."""
    stiffness, force = stiffness_and_force(gear, angle, torque)
    return np.linalg.solve(stiffness, force[..., np.newaxis])[..., 0]
