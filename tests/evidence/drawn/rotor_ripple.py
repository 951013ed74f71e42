"""Logs of a joint, with and without a detent and friction over the angle of the rotor.

Friction at the input is (C + A sin(m theta + a)) sgn(omega) + v omega, with a detent D sin(n theta + d); behind it a load with
gravity. Angles come from one encoder or both, the torque as a torque at the output, at the input, or as a current.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.identify import Identified
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence.drawn.outcome import Outcome, compared

Array = NDArray[np.float64]

RATIOS = (30.0, 50.0, 80.0, 100.0, 120.0, 160.0)


@dataclass(frozen=True)
class Joint:
    """A joint whose numbers are known; torques at the input [N.m], load at the output.

    Attributes:
        ratio: of the gear
        coulomb, viscous: of the friction [N.m, N.m.s/rad]
        wave: order, amplitude over `coulomb` and phase of the friction over the angle
        detent: order, amplitude [N.m] and phase
        inertia: of all that turns, at the output [kg.m2]
        gravity: [N.m]
    """

    ratio: float
    coulomb: float
    viscous: float
    wave: tuple[float, float, float]
    detent: tuple[float, float, float]
    inertia: float
    gravity: float

    def torque(self, angle: Array, speed: Array, acceleration: Array) -> Array:
        """Return the torque of the motor [N.m] along a motion of the output."""
        theta, sense = self.ratio * angle, np.sign(speed)
        order, size, phase = self.wave
        dry = self.coulomb * (1.0 + size * np.sin(order * theta + phase)) * sense
        n, detent, at = self.detent
        stored = detent * np.sin(n * theta + at)
        load = self.inertia * acceleration + self.gravity * np.sin(angle)
        return np.asarray(dry + self.viscous * self.ratio * speed + stored + load / self.ratio)


def drawn_joint(random: np.random.Generator, ratio: float, fastest: float) -> Joint:
    """Return a joint whose fastest motion at the output [rad/s] is known."""
    coulomb = float(np.exp(random.uniform(np.log(0.015), np.log(0.15))))
    wave = (float(random.choice([1.0, 2.0])), float(random.uniform(0.08, 0.4)), float(random.uniform(-np.pi, np.pi)))
    detent = (
        float(random.choice([1.0, 2.0, 4.0])),
        coulomb * float(random.uniform(0.05, 0.5)),
        float(random.uniform(-np.pi, np.pi)),
    )
    return Joint(
        ratio,
        coulomb,
        coulomb * float(random.uniform(0.1, 1.0)) / (ratio * fastest),
        wave if random.random() < 0.5 else (1.0, 0.0, 0.0),
        detent if random.random() < 0.6 else (1.0, 0.0, 0.0),
        float(np.exp(random.uniform(np.log(0.02), np.log(2.0)))),
        float(random.choice([0.0, 0.0, random.uniform(1.0, 20.0)])),
    )


def motion(random: np.random.Generator, time: Array) -> tuple[Array, Array, Array]:
    """Return angle, speed and acceleration of the output along a triangle of several speeds, a sine or a sum of sines."""
    span, kind = time[-1], random.choice(["triangle", "sine", "multisine"])
    size = random.uniform(0.6, 2.8)
    if kind == "triangle":
        speeds = random.uniform(0.1, 1.0) * np.linspace(0.25, 1.0, random.integers(4, 9))
        angle, now, place, way = [], 0.0, -size, 1.0
        for speed in np.tile(speeds, 100):
            for _ in range(2):
                angle.append((now, place))
                now, place, way = now + 2.0 * size / speed, place + way * 2.0 * size, -way
            if now > span:
                break
        angle.append((now, place))
        instants, places = map(np.array, zip(*angle, strict=True))
        q = np.interp(time, instants, places)
        width = max(3, round(0.05 / (time[1] - time[0])))
        for _ in range(3):  # ramps of the speed
            q = np.convolve(np.pad(q, width, mode="edge"), np.ones(width) / width, "same")[width:-width]
        speed = np.gradient(q, time)
        return q, speed, np.gradient(speed, time)
    count = 1 if kind == "sine" else 4
    frequency = random.uniform(0.02, 0.25, count)
    share = np.ones(count) / count
    phase = random.uniform(0.0, 2.0 * np.pi, count)
    waves = 2.0 * np.pi * np.outer(frequency, time) + phase[:, np.newaxis]
    omega = 2.0 * np.pi * frequency
    return (
        np.asarray(size * share @ np.sin(waves)),
        np.asarray(size * (share * omega) @ np.cos(waves)),
        np.asarray(-size * (share * omega**2) @ np.sin(waves)),
    )


def record(seed: int) -> tuple[Joint, sw.Recording, dict[str, float]]:
    """Return a joint, a log of it, and the constants that a person gives with the log."""
    random = np.random.default_rng(seed)
    ratio, rate = float(random.choice(RATIOS)), float(random.choice([100.0, 200.0, 250.0, 500.0]))
    time = np.arange(0.0, float(random.uniform(25.0, 70.0)), 1.0 / rate)
    angle, speed, acceleration = motion(random, time)
    joint = drawn_joint(random, ratio, float(np.abs(speed).max()))
    torque = joint.torque(angle, speed, acceleration)
    torque = torque + joint.coulomb * float(random.choice([0.01, 0.03, 0.1])) * random.normal(size=len(time))
    torque = torque + joint.coulomb * float(random.uniform(-0.1, 0.1))
    count = 2.0 * np.pi / float(random.choice([4096, 16384]))
    columns, units = {"time": time}, {"time": "s"}
    encoders = random.choice(["input", "output", "both"])
    if encoders != "output":
        columns["input_angle"], units["input_angle"] = count * np.round(ratio * angle / count), "rad"
    if encoders != "input":
        fine = count / 16.0
        columns["output_angle"], units["output_angle"] = fine * np.round(angle / fine), "rad"
    constants = {"ratio": ratio}
    effort = random.choice(["joint_torque", "input_torque", "current"])
    constant = float(random.uniform(0.03, 0.2))
    scale = {"joint_torque": ratio, "input_torque": 1.0, "current": 1.0 / constant}[str(effort)]
    columns[str(effort)], units[str(effort)] = scale * torque, "A" if effort == "current" else "N.m"
    if effort == "current":
        constants["torque_constant"] = constant
    return joint, sw.Recording(columns, units), constants


def outcome(seed: int) -> Outcome:
    """Return the outcome of a log: Coulomb, viscous friction, waves and detent right, or refused; none where there is none."""
    joint, recording, constants = record(seed)
    try:
        found = sw.identify("csg-20-100", {"log": recording}, mapping=FileMapping(constants=constants))
    except ValueError as error:
        return Outcome("refused", str(error))
    return judged(joint, found)


def judged(joint: Joint, found: Identified) -> Outcome:
    """Return the outcome of what was identified of a joint."""
    file = found.files[0]
    if found.failed or file.refused:
        return Outcome("refused", "; ".join(check.message for check in found.failed) or file.refused)
    prefix = "gear.friction_input."
    values = {each.path.removeprefix(prefix): each for each in file.estimates if each.path.startswith(prefix) and not each.why}
    law = found.gear_set.gear.friction_input
    truths = {"coulomb": joint.coulomb, "viscous": joint.viscous}
    for name, orders, (order, size, _) in (
        ("amplitude", getattr(law, "order", ()), joint.wave),
        ("detent_torque", getattr(law, "detent_order", ()), joint.detent),
    ):
        truths |= {f"{name}[{place}]": size if order == each else 0.0 for place, each in enumerate(orders)}
    pairs = [(name, values[name].value, values[name].sigma, truth) for name, truth in truths.items() if name in values]
    result = compared(pairs)
    if result.verdict == "wrong":
        return result
    missed = [
        name
        for name, (_, size, _) in (("amplitude", joint.wave), ("detent", joint.detent))
        if size > 0.0 and not any(each.startswith(name) for each in values)
    ]
    missed += [name for name in ("coulomb", "viscous") if name not in values]
    return Outcome("refused", f"no {missed} in {file.model}") if missed else result
