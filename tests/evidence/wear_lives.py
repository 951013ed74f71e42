"""Coverage of the remaining life of worn gears: `python -m tests.evidence.wear_lives`.

50 fleets of six gears. A gear wears by an independent program: at each of its tooth pairs the depth grows by the load of the
pair times its sliding distance (Archard 1953), over cycles of random torque and stroke, which differ from block to block. Play
at the output is the depth of both flanks over the radius; the wave of order 2 grows by a share of it. The duty is recorded,
and `transmitted_work` integrates it.

Before each test the rig is set up anew: lost motion and amplitude differ by that. A test is a record of two encoders with
noise, which `transmission_error` evaluates. `wear_life` fits the tests of a gear, and the interval of its life is compared with
the work at which the first of both quantities passes its limit.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from math import inf, pi

import numpy as np
import strainwave as sw
from numpy.typing import NDArray

Array = NDArray[np.float64]

FLEETS, GEARS = 50, 6
RATIO, RADIUS, PRESSURE_ANGLE, PAIRS = 100.0, 0.025, 0.35, 60  # of the teeth in contact at once
SLIDING_SHARE = 0.05  # sliding distance per distance that the pitch circle of the output turns
HYSTERESIS, AMPLITUDE = 1e-4, 6e-5  # rad, of a new gear: lost motion and error
PLAY_LIMIT, AMPLITUDE_LIMIT = 4e-4, 2.5e-4  # rad
WAVE_SHARE = (0.1, 0.6)  # of the play, by which the error grows
SET_UP = 6e-6  # rad: standard deviation of both quantities from one set-up to the next
ENCODER_NOISE = 1e-5  # rad, of the encoder of the output
DUTY_BLOCKS = 200  # of duty up to the last test


@dataclass
class Gear:
    """A gear with its wear so far."""

    random: np.random.Generator

    def __post_init__(self) -> None:
        self.coefficient = 2e-9 * float(np.exp(self.random.normal(0.0, 0.4)))  # m of depth per N·m, of a pair
        self.wave_share = float(self.random.uniform(*WAVE_SHARE))
        self.depth, self.work = 0.0, 0.0

    @property
    def play(self) -> float:
        """Play at the output [rad]."""
        return 2.0 * self.depth / RADIUS

    def use(self, scale: float) -> None:
        """Do a block of duty, `scale` repetitions of one cycle of motion."""
        time = np.linspace(0.0, 1.0, 401)
        stroke, torque, phase = self.random.uniform(0.2, 1.5), self.random.uniform(5.0, 60.0), self.random.uniform(0.0, pi)
        angle = stroke * np.sin(2.0 * pi * time)
        load = torque * np.sin(2.0 * pi * time + phase) + self.random.uniform(-10.0, 10.0)
        per_pair = np.abs(load) / (RADIUS * np.cos(PRESSURE_ANGLE) * PAIRS)  # N
        slid = SLIDING_SHARE * RADIUS * np.abs(np.diff(angle))  # m
        self.depth += scale * self.coefficient * float(0.5 * (per_pair[1:] + per_pair[:-1]) @ slid)
        columns = {"torque": load, "output_angle": angle}
        self.work += scale * sw.diagnose.transmitted_work(sw.Recording(columns, {"torque": "N.m", "output_angle": "rad"}))

    def tested(self) -> tuple[float, float]:
        """Return lost motion and amplitude of order 2 that a test finds [rad]."""
        set_up = self.random.normal(0.0, SET_UP, 2)
        theta = 30.0 * np.sin(np.linspace(0.0, 6.0, 1200)) + self.random.uniform(0.0, 2.0 * pi)
        way = np.sign(np.gradient(theta))
        error = (AMPLITUDE + self.wave_share * self.play + set_up[1]) * np.sin(2.0 * theta + 0.3)
        error += 0.5 * (HYSTERESIS + self.play + set_up[0]) * way
        output = -theta / RATIO - error + self.random.normal(0.0, ENCODER_NOISE, len(theta))
        record = sw.Recording({"input_angle": theta, "output_angle": output}, {"input_angle": "rad", "output_angle": "rad"})
        found = sw.transmission_error(record, ratio=-RATIO)
        assert found.lost_motion is not None
        return found.lost_motion.value, next(each.amplitude for each in found.orders if each.order == 2.0)


def life_of(random: np.random.Generator) -> tuple[sw.diagnose.WearLife, float, int]:
    """Return the estimated and the true remaining life of one gear [J], and the number of its tests."""
    gear, tests = Gear(random), int(random.integers(3, 9))
    scale = float(random.uniform(20.0, 120.0))
    works, values = [gear.work], [gear.tested()]
    for _ in range(tests - 1):
        for _ in range(DUTY_BLOCKS // (tests - 1)):
            gear.use(scale)
        works.append(gear.work)
        values.append(gear.tested())
    play, amplitude = zip(*values, strict=True)
    limits = {"play": PLAY_LIMIT, "amplitude": AMPLITUDE_LIMIT}
    life = sw.diagnose.wear_life(works, {"play": list(play), "amplitude": list(amplitude)}, limits)
    # From here on the truth: the duty goes on until a limit is passed.
    end = min(PLAY_LIMIT - HYSTERESIS, (AMPLITUDE_LIMIT - AMPLITUDE) / gear.wave_share)
    if gear.play >= end:
        return life, 0.0, tests
    now = gear.work
    while gear.play < end:
        before, depth = gear.work, gear.play
        gear.use(scale)
    return life, before + (gear.work - before) * (end - depth) / (gear.play - depth) - now, tests


def main() -> None:
    """Print the coverage by fleet, by number of tests, and of all gears."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--fleets", type=int, default=FLEETS)
    arguments.add_argument("--seed", type=int, default=0)
    options = arguments.parse_args()
    rows = []
    for fleet in range(options.fleets):
        random = np.random.default_rng([options.seed, fleet])
        for _ in range(GEARS):
            life, true, tests = life_of(random)
            rows.append((fleet, tests, life.low <= true <= life.high, life.high < inf, life.low / true if true else 1.0))
    fleets, counts, covered, determined = (np.array(column) for column in zip(*((*row[:4],) for row in rows), strict=True))
    print(f"gears {len(rows)}, interval contains the true life: {np.mean(covered):.1%}")
    print(f"determined {np.mean(determined):.1%}, of these it contains the true life: {np.mean(covered[determined]):.1%}")
    for tests in sorted(set(counts.tolist())):
        own = counts == tests
        words = f"contains {np.mean(covered[own]):.0%}, determined {np.mean(determined[own]):.0%}"
        print(f"  {tests} tests: {np.sum(own)} gears, {words}")
    shares = [np.mean(covered[fleets == fleet]) for fleet in range(options.fleets)]
    print(f"fleets whose first gear is covered: {np.mean(covered[::GEARS]):.0%}; worst fleet {min(shares):.0%}")


if __name__ == "__main__":
    main()
