"""Torsion of a set by the clip rule of its elements, which shares nothing with the package."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.python.catalogue.makers import figures


@dataclass(frozen=True)
class State:
    twist: float
    held: np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Torsion:
    """Three-segment spring in parallel with Maxwell-slip elements."""

    slopes: tuple[float, float, float]
    knees: tuple[float, float]
    stiffness: np.ndarray[Any, np.dtype[np.float64]]
    breakaway: np.ndarray[Any, np.dtype[np.float64]]

    @staticmethod
    def of(name: str) -> Torsion:
        k1, k2, k3, t1, t2 = figures(name, "stiffness", "k1", "k2", "k3", "t1", "t2")
        stiffness, breakaway = figures(name, "hysteresis", "stiffness", "breakaway")
        return Torsion((k1, k2, k3), (t1, t2), np.array(stiffness), np.array(breakaway))

    def published_knees(self) -> tuple[float, float]:
        """T1 and T2 of the whole gear: those of the spring with all elements slipping beside it."""
        t1, t2 = (knee + float(self.breakaway.sum()) for knee in self.knees)
        return t1, t2

    def published_slopes(self) -> tuple[float, float, float]:
        """K1 of the whole gear is the secant from the origin to the first knee; beyond it the elements only slip."""
        return self.slopes[0] * self.published_knees()[0] / self.knees[0], *self.slopes[1:]

    def spring_twist(self, torque: float) -> float:
        t1, t2 = self.knees
        parts = min(torque, t1), min(max(torque - t1, 0.0), t2 - t1), max(torque - t2, 0.0)
        return sum(part / slope for part, slope in zip(parts, self.slopes, strict=True))

    def spring_torque(self, twist: float) -> float:
        first, second = (self.spring_twist(knee) for knee in self.knees)
        size = abs(twist)
        parts = min(size, first), min(max(size - first, 0.0), second - first), max(size - second, 0.0)
        return float(np.sign(twist) * np.dot(parts, self.slopes))

    def virgin(self) -> State:
        return State(0.0, np.zeros_like(self.breakaway))

    def torque(self, state: State) -> float:
        return self.spring_torque(state.twist) + float(state.held.sum())

    def turned(self, state: State, increment: float) -> State:
        held = np.clip(state.held + self.stiffness * increment, -self.breakaway, self.breakaway)
        return State(state.twist + increment, held)

    def loaded(self, state: State, torque: float) -> State:
        """The state at `torque` after a monotone turn: bisection on the turn, each trial one exact clip."""
        near, far = 0.0, (torque - self.torque(state)) / self.slopes[0]
        for _ in range(60):
            middle = 0.5 * (near + far)
            beyond = (self.torque(self.turned(state, middle)) - torque) * far > 0.0
            near, far = (near, middle) if beyond else (middle, far)
        return self.turned(state, far)

    def cycle(self, amplitude: float) -> list[State]:
        """The states at +amplitude, zero, -amplitude, zero and +amplitude, from the virgin state."""
        states = [self.virgin()]
        for torque in (amplitude, 0.0, -amplitude, 0.0, amplitude):
            states.append(self.loaded(states[-1], torque))
        return states[1:]

    def hysteresis_loss(self, amplitude: float) -> float:
        """Width of the loop at zero torque after +amplitude and after -amplitude."""
        _, after_positive, _, after_negative, _ = self.cycle(amplitude)
        return after_positive.twist - after_negative.twist

    def width(self) -> float:
        """The closed form of the loss once every element slips and the spring stays below its first knee."""
        return 2.0 * float(self.breakaway.sum()) / self.slopes[0]

    def full_slip(self) -> float:
        """Smallest amplitude whose unloading to zero torque reverses every element."""
        reversal = 2.0 * float(np.max(self.breakaway / self.stiffness))
        return self.spring_torque(0.5 * self.width() + reversal) + float(self.breakaway.sum())
