"""Records of a flexible ring: both encoders, and an accelerometer, at constant speeds or along run-ups, with noise."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from tests.evidence.flexible_ring.gear import Gear, drawn
from tests.evidence.flexible_ring.motion import move
from tests.evidence.flexible_ring.ring import Array
from tests.evidence.flexible_ring.truth import Lines, eigenlines

SLOWEST, FASTEST = 8.0, 60.0  # revolutions of the wave generator per second
UNITS = {"time": "s", "input_angle": "rad", "output_angle": "rad", "acceleration": "m/s2"}
Record = dict[str, Array]  # columns by name, in UNITS


@dataclass(frozen=True)
class Experiment:
    """A drawn gear, the speeds it is run at, and the sensors.

    Attributes:
        gear: that is measured
        first, last: speed of each record at its beginning and its end [rad/s], shape (records,)
        torque: of the load [N.m]
        revolutions: of the wave generator in each record
        rate: of samples [Hz]
        counts: of the encoders of input and output, to a revolution
        noise: standard deviation of the output angle [rad] and of the acceleration over its own
        seed: of the noise
    """

    gear: Gear
    first: Array
    last: Array
    torque: float
    revolutions: float
    rate: float
    counts: tuple[int, int]
    noise: tuple[float, float]
    seed: int

    @cached_property
    def records(self) -> list[Record]:
        """Records of all speeds: angles count from the same zero of the wave generator, teeth and balls."""
        random = np.random.default_rng([self.seed, 1])
        motion = move(self.gear, self.first, self.last, self.torque, revolutions=self.revolutions)
        return [
            self._record(random, motion.time[:, place], motion.angle, motion.error[:, place], motion.radial[:, place])
            for place in range(len(self.first))
        ]

    def _record(self, random: np.random.Generator, time: Array, angle: Array, error: Array, radial: Array) -> Record:
        at = np.arange(0.0, time[-1], 1.0 / self.rate)
        turned, lost, shaken = (CubicSpline(time, each)(at) for each in (angle, error, radial))
        output = turned / self.gear.ratio + lost + self.noise[0] * random.standard_normal(len(at))
        shaken = shaken + self.noise[1] * shaken.std() * random.standard_normal(len(at))
        return {
            "time": at,
            "input_angle": _counted(turned, self.counts[0]),
            "output_angle": _counted(output, self.counts[1]),
            "acceleration": shaken,
        }

    @cached_property
    def lines(self) -> Lines:
        """Eigenlines over the speeds of the records."""
        return eigenlines(self.gear, np.linspace(self.first.min(), self.last.max(), 48), self.torque)


def _counted(angle: Array, counts: int) -> Array:
    step = 2.0 * np.pi / counts
    return np.asarray(step * np.round(angle / step))


def drawn_experiment(seed: int, count: int = 48) -> Experiment:
    """Return an experiment: constant speeds if the seed is even, else short run-ups that join to one of the whole range."""
    random = np.random.default_rng(seed)
    gear = drawn(random)
    edges = 2.0 * np.pi * np.geomspace(SLOWEST, FASTEST * float(random.uniform(0.6, 1.0)), count + 1)
    first, last = (edges[:-1], edges[1:]) if seed % 2 else (edges[1:], edges[1:])
    return Experiment(
        gear=gear,
        first=first,
        last=last,
        torque=gear.rated_torque * float(random.choice([0.0, random.uniform(0.1, 1.0)])),
        revolutions=16.0,
        rate=float(random.choice([12800.0, 20000.0, 25600.0])),
        counts=(2 ** int(random.integers(14, 19)), 2 ** int(random.integers(22, 27))),
        noise=(float(np.exp(random.uniform(np.log(2e-8), np.log(1e-6)))), float(random.uniform(0.005, 0.05))),
        seed=seed,
    )
