"""Torsion loops at the output that a rig disturbed, by plain numpy: a clamp that slips, an encoder that drops out, and others.

Springs are linear, cubic or of three segments, beside one or two elements that slip; the path has three cycles of falling size.
One of the disturbances is in each record, or none: a clamp that slips for good near the largest torque of some cycles; an
encoder that keeps its last count for some samples, several times; a ripple of the torque over the twist, as of a bent shaft; a
zero that wanders and comes back. What `identify` lists as identified of a spring of the kind that was drawn must be true. No
disturbance is in the model, so that ± must contain it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from strainwave import identify
from strainwave.files.recording import Recording
from strainwave.identification.identify import Identified

from tests.evidence.drawn.asymmetric_spring import slipping
from tests.evidence.drawn.outcome import Outcome, compared

Array = NDArray[np.float64]
KINDS = {"linear": ("k",), "cubic": ("a1", "a3"), "three_segment": ("k1", "k2", "k3", "t1", "t2")}
DISTURBANCES = ("none", "clamp", "dropouts", "ripple", "wander")
SAMPLES_OF_LOOP = 1200


def spring(kind: str, numbers: tuple[float, ...], twist: Array) -> Array:
    """Return the torque of an odd spring [N.m]."""
    size = np.abs(twist)
    if kind == "linear":
        return numbers[0] * twist
    if kind == "cubic":
        return numbers[0] * twist + numbers[1] * twist**3
    k1, k2, k3, t1, t2 = numbers
    first, second = t1 / k1, t1 / k1 + (t2 - t1) / k2
    beyond = (k2 - k1) * np.maximum(size - first, 0.0) + (k3 - k2) * np.maximum(size - second, 0.0)
    return np.asarray(np.sign(twist) * (k1 * size + beyond))


def drawn(random: np.random.Generator, kind: str) -> tuple[tuple[float, ...], float]:
    """Return the numbers of a spring and the largest twist [rad] of its loop."""
    stiffness, half = float(random.uniform(1e4, 5e4)), float(random.uniform(8e-4, 2e-3))
    if kind == "linear":
        return (stiffness,), half
    if kind == "cubic":
        return (stiffness, float(random.uniform(0.3, 1.0)) * stiffness / half**2), half
    first, second = half * float(random.uniform(0.2, 0.35)), half * float(random.uniform(0.55, 0.7))
    middle, last = stiffness * float(random.uniform(1.3, 1.7)), stiffness * float(random.uniform(2.0, 2.6))
    knee = stiffness * first
    return (stiffness, middle, last, knee, knee + middle * (second - first)), half


def disturbed(name: str, twist: Array, torque: Array, random: np.random.Generator) -> tuple[Array, Array]:
    """Return twist and torque as a rig with that disturbance measures them."""
    half, level, count = float(np.abs(twist).max()), float(np.abs(torque).max()), len(twist)
    if name == "clamp":
        threshold, size = float(random.uniform(0.7, 0.95)) * level, float(random.uniform(0.01, 0.05)) * half
        loading = (torque > threshold) & (np.gradient(twist) > 0.0)
        cycle = np.arange(count) * 3 // count
        slips = loading & (cycle < int(random.integers(1, 3)))
        twist = twist + size * np.cumsum(slips) / max(int(slips.sum()), 1)
    if name == "dropouts":
        twist = twist.copy()
        for begin in random.integers(1, count - 60, int(random.integers(3, 8))):
            length = int(random.integers(5, 40))
            twist[begin : begin + length] = twist[begin - 1]
    if name == "ripple":
        turns, phase = float(random.uniform(1.5, 5.0)), float(random.uniform(0.0, 6.0))
        torque = torque + float(random.uniform(0.005, 0.03)) * level * np.sin(np.pi * turns * twist / half + phase)
    if name == "wander":
        path = np.sin(np.pi * float(random.uniform(1.0, 2.5)) * np.linspace(0.0, 1.0, count))
        torque = torque + float(random.uniform(0.01, 0.04)) * level * path
    return twist, torque


def measured(seed: int) -> tuple[Recording, str, tuple[float, ...]]:
    """Return a disturbed loop, and the kind and the numbers of its spring."""
    random = np.random.default_rng(seed)
    disturbance = DISTURBANCES[seed % len(DISTURBANCES)]
    kind = list(KINDS)[seed // len(DISTURBANCES) % len(KINDS)]
    numbers, half = drawn(random, kind)
    turn = np.linspace(0.0, 3.0, SAMPLES_OF_LOOP)
    twist = half * np.array([1.0, 0.8, 0.55])[np.minimum(turn.astype(int), 2)] * np.sin(2.0 * np.pi * turn)
    torque = spring(kind, numbers, twist)
    level = float(np.abs(torque).max())
    for share in (0.06, 0.12)[: int(random.integers(1, 3))]:
        slip = float(random.uniform(0.08, 0.4)) * half
        breakaway = share * float(random.uniform(0.5, 1.2)) * level
        torque = torque + slipping(twist, breakaway / slip, breakaway)
    twist, torque = disturbed(disturbance, twist, torque, random)
    noise = float(random.choice([1e-3, 3e-3, 1e-2]))
    torque = torque + noise * level * random.normal(size=SAMPLES_OF_LOOP) + float(random.uniform(-0.02, 0.02)) * level
    twist = twist + float(random.uniform(-0.05, 0.05)) * half
    series = {"time": 20.0 * turn, "twist": twist, "torque": torque}
    return Recording(series, {"time": "s", "twist": "rad", "torque": "N.m"}), kind, numbers


def pairs(found: Identified, kind: str, numbers: tuple[float, ...]) -> Iterator[tuple[str, float, float, float]]:
    """Yield name, estimate, standard deviation and truth of what was identified of the spring."""
    truth = dict(zip((f"gear.stiffness.{name}" for name in KINDS[kind]), numbers, strict=True))
    listed = {each.estimate.path: each.estimate for each in found.parameters if each.estimate.path.startswith("gear.stiffness")}
    for path, each in listed.items():
        if set(listed) == set(truth):
            yield path, each.value, each.sigma, truth[path]


def result(seed: int) -> tuple[Identified, list[tuple[str, float, float, float]]]:
    """Return what `identify` makes of a disturbed loop, and the numbers that are compared."""
    recording, kind, numbers = measured(seed)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "loop.csv"
        columns = np.column_stack([recording[name] for name in recording.names])
        np.savetxt(path, columns, delimiter=",", header="time [s],twist [rad],torque [N.m]", comments="")
        found = identify("hfuc-25-100", path)
    return found, list(pairs(found, kind, numbers))


def outcome(seed: int) -> Outcome:
    """Return whether what is identified of a disturbed loop is true."""
    found, stated = result(seed)
    if found.failed or not stated:
        return Outcome("refused", "; ".join(check.message for check in found.failed) or "another spring, or none")
    return compared(stated)
