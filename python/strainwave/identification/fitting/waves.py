"""Amplitude and phase of waves in a fit, as a solver moves them: by their real and imaginary part.

A prediction is linear in the sine and cosine of a wave, but not in amplitude and phase. Where a constant torque makes up nearly
all of a wave, as of gravity over a small angle, a step of Gauss and Newton in amplitude and phase goes far astray.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.fitting.unknowns import Unknown

Array = NDArray[np.float64]
AMPLITUDES = ("amplitude", "torque")  # in a name in place of "phase"


@dataclass(frozen=True, eq=False)
class Waves:
    """The waves among the unknowns of a fit.

    Attributes:
        amplitude, phase: places of the unknowns of each wave, shape (waves,)
        turned: phase at the start of the fit, from which the imaginary part counts [rad], shape (waves,)
    """

    amplitude: NDArray[np.intp]
    phase: NDArray[np.intp]
    turned: Array

    @classmethod
    def of(cls, unknowns: Sequence[Unknown], start: Array, free: NDArray[np.intp]) -> Waves:
        """Return the waves whose amplitude and phase are both free and not limited but for the sign of the amplitude."""
        places = {unknowns[place].path: place for place in free.tolist() if place < len(unknowns)}
        pairs = [
            (places[path], phase)
            for name, phase in places.items() if "phase" in name
            for path in (name.replace("phase", amplitude) for amplitude in AMPLITUDES) if path in places
        ]  # fmt: skip
        pairs = [
            (own, phase) for own, phase in pairs
            if start[own] > 0.0 and np.isinf([*_limits(unknowns[phase]), unknowns[own].high]).all()
        ]  # fmt: skip
        amplitude, phase = np.array(pairs, np.intp).reshape(-1, 2).T
        return cls(amplitude, phase, start[phase])

    def parts(self, x: Array) -> Array:
        """Return unknowns with real and imaginary part in the places of amplitude and phase."""
        found, wave = x.copy(), x[self.amplitude] * np.exp(1j * (x[self.phase] - self.turned))
        found[self.amplitude], found[self.phase] = wave.real, wave.imag
        return found

    def unknowns(self, parts: Array) -> Array:
        """Return the unknowns of parts; a phase is within half a turn of that at the start."""
        found, wave = parts.copy(), parts[self.amplitude] + 1j * parts[self.phase]
        found[self.amplitude], found[self.phase] = np.abs(wave), self.turned + np.angle(wave)
        return found

    def slopes(self, rows: Array, x: Array) -> Array:
        """Return derivatives by the parts, of those by the unknowns at x, shape (samples, unknowns)."""
        found, angle = rows.copy(), x[self.phase] - self.turned
        along, across = rows[:, self.amplitude], rows[:, self.phase] / np.maximum(x[self.amplitude], 1e-300)
        found[:, self.amplitude] = along * np.cos(angle) - across * np.sin(angle)
        found[:, self.phase] = along * np.sin(angle) + across * np.cos(angle)
        return found

    def limits(self, ends: Array) -> Array:
        """Return lowest and highest values of the parts, of those of the unknowns, shape (unknowns, 2)."""
        found = ends.copy()
        found[self.amplitude], found[self.phase] = (-np.inf, np.inf), (-np.inf, np.inf)
        return found


def _limits(unknown: Unknown) -> tuple[float, float]:
    return unknown.low, unknown.high
