"""Torsion loops at the output of springs that differ between the senses of twist or do not, by plain numpy.

Springs are linear, cubic or of two segments, beside an element that slips; the torque at negative twist has a factor on every
even seed. Both zeros are off, and every fifth loop is loaded more to one side. A factor that is taken must be the true one.
Where none is taken, either there is none or the file's remark gives it or says that the loop does not determine it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from strainwave import load
from strainwave.files.recording import Recording
from strainwave.identification.candidates.torsion import fit_loop, held_out_blocks
from strainwave.identification.candidates.torsion.candidate import FACTOR_PATH
from strainwave.identification.experiments.torsion_loop import TorsionLoop

from tests.evidence.drawn.outcome import Outcome, compared

Array = NDArray[np.float64]
HALF, STIFFNESS, NOISE = 1.2e-3, 3e4, 0.1  # rad, N.m/rad, N.m
ELEMENT = (4e3, 1.0)  # N.m/rad, N.m


def spring(kind: int, twist: Array) -> Array:
    """Return the torque of one of three odd springs [N.m]."""
    size = np.abs(twist)
    more = (np.zeros_like(size), 0.5 * size * (size / HALF) ** 2, 0.5 * np.maximum(size - 0.4 * HALF, 0.0))[kind]
    return np.asarray(STIFFNESS * np.sign(twist) * (size + more))


def slipping(twist: Array, stiffness: float, breakaway: float) -> Array:
    """Return the torque of an element of Maxwell slip [N.m]."""
    torque = np.zeros_like(twist)
    for place, step in enumerate(np.diff(twist), 1):
        torque[place] = np.clip(torque[place - 1] + stiffness * step, -breakaway, breakaway)
    return torque


def measured(seed: int) -> tuple[Recording, float]:
    """Return two cycles, and the factor of the torque at negative twist."""
    random = np.random.default_rng(seed)
    factor = 1.0 if seed % 2 else float(np.exp(random.choice([-1.0, 1.0]) * random.uniform(0.05, 0.5)))
    twist = HALF * np.sin(np.linspace(0.0, 4.0 * np.pi, 600)) + 0.3 * HALF * (seed % 5 == 0)
    torque = spring(seed % 3, twist) * np.where(twist < 0.0, factor, 1.0) + slipping(twist, *ELEMENT)
    torque += NOISE * (1.0 + random.normal(size=len(twist)))
    return Recording({"twist": twist + 1e-5 * random.normal(), "torque": torque}, {"twist": "rad", "torque": "N.m"}), factor


def outcome(seed: int) -> Outcome:
    """Return whether a factor is taken where there is one, and is true."""
    recording, truth = measured(seed)
    gear = load("hfuc-25-100")
    loop = TorsionLoop.of(recording, gear)
    best, *_ = fit_loop(loop, gear, held_out_blocks(len(loop.twist)))
    factor = next((each for each in best.fit.estimates if each.path == FACTOR_PATH), None)
    if factor is None:
        return Outcome("right") if truth == 1.0 else Outcome("refused", f"a factor of {truth:.3f} is not taken")
    return compared([("factor", factor.value, factor.sigma, truth)])
