"""Logs of two encoders and the current of the motor between a spring of three kinds with no, one or two Maxwell elements.

The input moves as it is prescribed; the output is integrated in steps of 0.1 ms. Springs are linear, cubic or of three
segments, damping is there or not, noise, ratio, load and amplitude vary. What `identify` lists as identified of stiffness,
hysteresis, damping and load must lie within 2.5 standard deviations of the truth, or within 1 %.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.identify import Identified
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence.drawn.outcome import Outcome, compared

Array = NDArray[np.float64]

STEP, EVERY = 1e-4, 20  # s of the integration; steps a sample
MAX_RELATIVE_BIAS = 0.01  # relative: the motor's encoder, which is smoothed and noisy, moves the simulated input


@dataclass(frozen=True)
class Joint:
    """A drawn joint: spring, Maxwell elements, damping, load, and motor."""

    kind: str
    stiffness: tuple[float, ...]
    elements: tuple[tuple[float, float], ...]
    damping: float
    inertia: float
    gravity: float
    ratio: int
    rotor: float
    coulomb: float
    viscous: float
    loss: float
    noise: float

    def spring(self, twist: float) -> float:
        """Return the torque of the spring [N.m]."""
        if self.kind == "cubic":
            return self.stiffness[0] * twist + self.stiffness[1] * twist**3
        k1, k2, k3, t1, t2 = self.stiffness if self.kind == "three_segment" else (*self.stiffness, 1.0, 1.0, 1e9, 2e9)
        size = abs(twist)
        first, second = t1 / k1, t1 / k1 + (t2 - t1) / k2
        torque = k1 * size if size < first else t1 + k2 * (size - first) if size < second else t2 + k3 * (size - second)
        return torque if twist > 0.0 else -torque


def drawn(random: np.random.Generator, kind: str, count: int, damped: bool) -> Joint:
    """Return a joint whose spring is bent within its torque, and whose elements slip within its twist."""
    gravity, inertia = float(random.uniform(8.0, 40.0)), float(random.uniform(0.5, 2.5))
    stiff, reach = float(random.uniform(2e4, 3.5e4)), 0.9 * gravity
    half = reach / stiff
    numbers: tuple[float, ...] = (stiff,)
    if kind == "cubic":
        numbers = (stiff, float(random.uniform(0.3, 1.0)) * stiff / half**2)
    if kind == "three_segment":
        numbers = (stiff, 1.6 * stiff, 2.2 * stiff, 0.3 * reach, 0.75 * reach)
    shares = (0.3, 0.12) if count == 2 else (0.25,) * count
    slips = (0.15, 0.4) if count == 2 else (0.3,) * count
    breakaways = [share * stiff * slip * half for share, slip in zip(shares, slips, strict=True)]
    elements = tuple(
        (share * stiff, torque * float(random.uniform(0.8, 1.2))) for share, torque in zip(shares, breakaways, strict=True)
    )
    damping = 0.06 * float(np.sqrt(stiff * inertia)) if damped else 0.0
    ratio = int(random.choice([50, 80, 100, 120]))
    rotor = float(random.uniform(0.3, 1.2)) * inertia / ratio**2
    coulomb = float(random.uniform(0.05, 0.2)) * gravity / ratio
    noise = float(random.choice([1e-3, 3e-3])) * half
    return Joint(kind, numbers, elements, damping, inertia, gravity, ratio, rotor, coulomb, coulomb / 200.0, 0.0, noise)


def run(joint: Joint, seconds: float, random: np.random.Generator, constant: float) -> dict[str, Array]:
    """Return the columns of a log of a joint along a sum of sines."""
    steps = int(seconds / STEP)
    time = STEP * np.arange(steps)
    waves = [(0.5, 0.17, 0.0), (0.12, 0.71, 0.6), (0.02, 2.3, 1.1)]
    angle, speed, acceleration = np.zeros((3, steps))
    for size, frequency, phase in waves:
        size, rate = size * float(random.uniform(0.8, 1.2)), 2.0 * np.pi * frequency * float(random.uniform(0.9, 1.1))
        angle += size * (np.sin(rate * time + phase) - np.sin(phase))
        speed += size * rate * np.cos(rate * time + phase)
        acceleration -= size * rate**2 * np.sin(rate * time + phase)
    output, torque = _output(joint, angle, speed)
    loss = 1.0 + joint.loss * np.abs(torque) / (joint.coulomb * joint.ratio)
    motor = speed * joint.ratio
    needed = joint.rotor * acceleration * joint.ratio + torque / joint.ratio
    needed += joint.coulomb * loss * np.tanh(motor / 0.05) + joint.viscous * motor
    rows = slice(0, steps, EVERY)
    count = len(time[rows])
    level = float(np.std(needed))
    return {
        "time [s]": time[rows],
        "motor_angle [rad]": angle[rows] * joint.ratio + joint.noise * joint.ratio * random.standard_normal(count),
        "link_angle [rad]": output[rows] + joint.noise * random.standard_normal(count),
        "current [A]": (needed[rows] + 0.03 * level * random.standard_normal(count)) / constant,
    }


def _output(joint: Joint, angle: Array, speed: Array) -> tuple[Array, Array]:
    """Return angle of the output, and torque of the gear."""
    q, w, slips, last = float(angle[0]), float(speed[0]), [0.0] * len(joint.elements), 0.0
    places, torques = np.empty(len(angle)), np.empty(len(angle))
    limits = [(k, f) for k, f in joint.elements]
    for row, (drive, rate) in enumerate(zip(angle.tolist(), speed.tolist(), strict=True)):
        twist = drive - q
        torque = joint.spring(twist) + joint.damping * (rate - w)
        for place, (k, f) in enumerate(limits):
            slips[place] = min(max(slips[place] + k * (twist - last), -f), f)
            torque += slips[place]
        last = twist
        places[row], torques[row] = q, torque
        w += STEP * (torque - joint.gravity * float(np.sin(q))) / joint.inertia
        q += STEP * w
    return places, torques


def recording(columns: dict[str, Array]) -> sw.Recording:
    """Return columns whose headers state their units."""
    units = {name: name.partition("[")[2].strip("]") for name in columns}
    names = {"time [s]": "time", "motor_angle [rad]": "motor_angle", "link_angle [rad]": "link_angle", "current [A]": "current"}
    return sw.Recording({names[name]: values for name, values in columns.items()}, {names[n]: u for n, u in units.items()})


def outcome(seed: int) -> Outcome:
    """Return the outcome of one log."""
    random = np.random.default_rng(seed)
    kind = ("linear", "cubic", "three_segment")[seed % 3]
    joint = drawn(random, kind, (seed // 3) % 3, bool((seed // 9) % 2))
    columns = run(joint, 12.0, random, 0.1)
    found = identified([columns], [{"torque_constant": 0.1, "ratio": float(joint.ratio), "motor_inertia": joint.rotor}])
    return judged(found, joint)


def identified(logs: Sequence[dict[str, Array]], constants: Sequence[dict[str, float]]) -> Identified:
    """Return what `identify` makes of logs, from a set whose rotor is that of the motor."""
    start = sw.GearSet.read("csg-25-100")
    start = start.replace(gear=start.gear.replace(input_inertia=0.0))
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"run_{place}.csv" for place in range(len(logs))]
        for path, columns in zip(paths, logs, strict=True):
            np.savetxt(
                path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="", fmt="%.9g"
            )
        given = dict(zip(paths, constants, strict=True))
        return sw.identify(start, paths, mapping=lambda path: FileMapping(constants=given[path]))


def judged(found: Identified, joint: Joint) -> Outcome:
    """Return the outcome of what was identified of a joint."""
    pairs = list(_pairs(found, joint))
    named = [f"{check.name}: {check.message}" for check in found.failed]
    if named or not pairs:
        return Outcome("refused", "; ".join(named) or "nothing of the spring is identified")
    return compared(pairs, MAX_RELATIVE_BIAS)


def _pairs(found: Identified, joint: Joint) -> Iterator[tuple[str, float, float, float]]:
    """Yield name, estimate, standard deviation and truth of what was listed as identified."""
    names = {"linear": ("k",), "cubic": ("a1", "a3"), "three_segment": ("k1", "k2", "k3", "t1", "t2")}[joint.kind]
    truth = {f"gear.stiffness.{name}": value for name, value in zip(names, joint.stiffness, strict=True)}
    truth |= {"load.inertia": joint.inertia, "load.gravity_torque": joint.gravity, "gear.damping": joint.damping}
    truth["gear.stiffness.k"] = truth["gear.stiffness.k1"] = truth["gear.stiffness.a1"] = joint.stiffness[0]
    truth["gear.friction_input.coulomb"] = joint.coulomb
    for place, (k, f) in enumerate(sorted(joint.elements, key=lambda each: each[1] / each[0])):
        truth |= {f"gear.hysteresis.stiffness[{place}]": k, f"gear.hysteresis.breakaway[{place}]": f}
    for parameter in found.parameters:
        each = parameter.estimate
        if each.path.startswith("gear.hysteresis") and f"of {len(joint.elements)} element" not in each.law:
            if not joint.elements:
                yield f"{each.path} {each.law}", each.value, each.sigma, 0.0
            continue  # elements of another count have another meaning
        if each.path in truth:
            yield each.path, each.value, each.sigma, truth[each.path]
