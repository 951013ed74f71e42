"""Gravity along a chain of joints: the sums of angles of known arms, against the torque of a chain of random links."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from strainwave.identification.dynamics.chain import Chain, Sum, best_chain, named
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]
ACROSS = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # a quarter of a turn about x


def rotation(angle: Array) -> Array:
    """Return rotations about z, shape (n, 3, 3)."""
    zero, one = np.zeros_like(angle), np.ones_like(angle)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([cosine, -sine, zero, sine, cosine, zero, zero, zero, one], axis=1).reshape(-1, 3, 3)


def gravity_torques(q: Array, relations: tuple[int, ...], upright: bool, seed: int) -> Array:
    """Return the gravity torque of each joint of a chain of random links by moments of their weights, shape (joints, n).

    Axes are z of frames in a row; `relations` as those of a `Chain`. The first axis is upright, or lies.
    """
    random = np.random.default_rng(seed)
    count, samples = q.shape
    down = np.array([0.0, 0.0, -1.0]) if upright else np.array([0.0, -1.0, 0.0])
    turn, place = np.broadcast_to(np.eye(3), (samples, 3, 3)), np.zeros((samples, 3))
    axes, origins, centres = [], [], []
    for joint in range(count):
        relation = relations[joint - 1] if joint else 1
        turn = (
            turn
            @ {0: ACROSS, 1: np.eye(3), -1: np.diag([1.0, -1.0, -1.0])}[relation]
            @ rotation(q[joint] + random.uniform(-3, 3))
        )
        axes.append(turn[:, :, 2])
        origins.append(place)
        centres.append(place + turn @ random.normal(size=3))
        place = place + turn @ random.normal(size=3)
    masses = random.uniform(1.0, 5.0, count)
    return np.array([
        sum(masses[k] * np.sum(axes[j] * np.cross(centres[k] - origins[j], down), axis=1) for k in range(j, count))
        for j in range(count)
    ])  # fmt: skip


UNIVERSAL = (0, 1, 1, 0, 0)  # upright, three parallel, two across: arms of Universal Robots


@pytest.mark.parametrize(
    ("relations", "upright"), [(UNIVERSAL, True), ((0, -1, 0, 0, 0), True), ((0, 0, 0, 0, 0, 0), True), ((1, 0, 1, 0), False)]
)
def test_sums_of_angles_make_up_the_gravity_of_any_chain(relations: tuple[int, ...], upright: bool) -> None:
    """Whatever lengths, masses and zeros of the angles: least squares on the sums leaves nothing."""
    q = np.random.default_rng(1).uniform(-3.0, 3.0, (len(relations) + 1, 800))
    torques = gravity_torques(q, relations, upright, seed=2)
    first = int(upright)
    for joint in range(first, len(q)):
        sums = Chain(joint, first, relations[first:]).sums()
        angles = [sum(sense * q[place] for place, sense in each) for each in sums]
        columns = np.stack([wave(angle) for angle in angles for wave in (np.sin, np.cos)], axis=1)
        if columns.shape[1] < 400:
            assert columns @ solved(columns, torques[joint]) == pytest.approx(torques[joint], abs=1e-8)


@pytest.mark.parametrize("joint", [2, 3, 4])
def test_relations_of_axes_are_found_from_the_torque(joint: int) -> None:
    """A minute of a Fourier series, with friction and noise: what the sums found predict is the gravity."""
    random, time = np.random.default_rng(5), np.arange(3000) * 0.02
    q = np.array([
        sum(random.normal() * np.sin(0.4 * (k + 1) * time + random.uniform(0, 6.0)) for k in range(5)) for _ in range(6)
    ])  # fmt: skip
    gravity = gravity_torques(q, UNIVERSAL, upright=True, seed=6)[joint]
    sign = np.sign(np.gradient(q[joint]))
    size = float(np.std(gravity))
    torque = gravity + size * (0.5 * sign + 0.02 * random.normal(size=3000))

    def wave(each: Sum) -> Array:
        angle = sum(sense * q[place] for place, sense in each)
        return np.stack([np.sin(angle), np.cos(angle)], axis=1)

    base = np.stack([np.ones(3000), sign], axis=1)
    found = best_chain(torque[:2100], base[:2100], lambda each: wave(each)[:2100], joint, 6)
    assert found is not None
    columns = np.column_stack([base, *(wave(each) for each in found.sums())])
    left = torque - columns @ solved(columns[:2100], torque[:2100])
    print(f"\n{found}: {np.std(left[2100:]) / size:.3f} of the gravity is left")
    assert np.std(left[2100:]) < 0.1 * size


def test_without_gravity_no_chain_is_found() -> None:
    random = np.random.default_rng(7)
    q = np.cumsum(random.normal(size=(3, 900)), axis=1) * 0.05
    torque, base = random.normal(size=900), np.ones((900, 1))
    wave = lambda each: np.stack([f(sum(s * q[p] for p, s in each)) for f in (np.sin, np.cos)], axis=1)  # noqa: E731
    assert best_chain(torque, base, wave, 1, 3) is None


def test_sums_are_named_by_their_joints() -> None:
    assert named([((0, -1), (2, 1)), ((1, 1),)], ["1", "2", "elbow"]) == ["-q1+qelbow", "q2"]
