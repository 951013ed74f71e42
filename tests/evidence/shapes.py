"""False alarms of the check for shape: `python -m tests.evidence.shapes [COUNT]`.

Tables of friction, torsion loops and logs are drawn of laws that `identify` fits, with white noise. The model is right, and
what it leaves has no shape: chance makes one in 1 of 1000 for each abscissa, and the check fails in none.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

import numpy as np
import strainwave as sw
from strainwave.identification.checks.unexplained import SHAPE_OF_RESIDUALS
from strainwave.identification.reading.mapping import FileMapping

COUNT = 200
START = "csg-20-100"
RATIO = 100.0
Drawn = tuple[str, sw.Recording]


def table(random: np.random.Generator) -> Drawn:
    """Return a table of 40 speeds, both ways, of Coulomb and viscous friction."""
    speed = np.concatenate([way * np.geomspace(2.0, 250.0, 20) for way in (-1.0, 1.0)])
    torque = random.uniform(0.03, 0.08) * np.sign(speed) + random.uniform(2e-4, 5e-4) * speed
    torque += random.uniform(2e-4, 2e-3) * random.normal(size=len(speed))
    return "friction", sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


def loop(random: np.random.Generator) -> Drawn:
    """Return a torsion loop of a linear spring with one Maxwell element, 400 samples."""
    twist = random.uniform(2e-3, 4e-3) * np.sin(np.linspace(0.0, 4.5 * np.pi, 400))
    element = sw.hysteresis.MaxwellSlip(stiffness=[random.uniform(2e3, 6e3)], breakaway=[random.uniform(0.5, 2.0)])
    torque = random.uniform(18e3, 30e3) * twist + element.trace(twist)
    torque += random.uniform(0.02, 0.2) * random.normal(size=len(twist))
    return "torsion", sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"})


def log(random: np.random.Generator) -> Drawn:
    """Return a log of a joint with Coulomb and viscous friction, inertia and gravity, 40 s at 100 Hz."""
    time = np.arange(0.0, 40.0, 0.01)
    rates, phases = random.uniform(0.3, 2.0, 4), random.uniform(0.0, 2.0 * np.pi, 4)
    sizes = random.uniform(0.2, 0.5, 4) / rates
    angle, speed, acceleration = (
        sum(size * rate**order * np.sin(rate * time + phase + order * np.pi / 2.0)
            for size, rate, phase in zip(sizes, rates, phases, strict=True))
        for order in range(3)
    )  # fmt: skip
    joint = random.uniform(0.5, 2.0) * acceleration + random.uniform(2.0, 10.0) * np.sin(angle)
    joint += RATIO * (random.uniform(0.03, 0.08) * np.sign(speed) + random.uniform(2e-4, 5e-4) * RATIO * speed)
    joint += random.uniform(0.1, 0.5) * random.normal(size=len(time))
    columns = {"time": time, "output_angle": angle, "joint_torque": joint}
    return "log", sw.Recording(columns, {"time": "s", "output_angle": "rad", "joint_torque": "N.m"})


def named(draw: Callable[[np.random.Generator], Drawn], count: int) -> tuple[int, int, int]:
    """Return how many drawn records have the check, how many of these a shape by it, and in how many it fails."""
    checks = []
    for seed in range(count):
        kind, recording = draw(np.random.default_rng(seed))
        found = sw.identify(START, {kind: recording}, mapping=FileMapping(), accept=True)
        checks += [check for check in found.checks if check.name == SHAPE_OF_RESIDUALS]
    return len(checks), sum(check.value > 0.0 for check in checks), sum(check.failed for check in checks)


def main(given: Sequence[str] | None = None) -> int:
    """Print the rates. Return 1 if a check fails, or more have a shape than 1 of 1000 makes with 99.9 % (4 of 600)."""
    count = int((given or sys.argv[1:] or [COUNT])[0])
    totals = np.zeros(3, int)
    for draw in (table, loop, log):
        found = named(draw, count)
        totals += found
        print(f"{draw.__name__}: {found[0]} checked, {found[1]} with a shape, {found[2]} failed", flush=True)
    return int(totals[2] > 0 or totals[1] > 1 + 5 * totals[0] / 1000)


if __name__ == "__main__":
    sys.exit(main())
