"""Clean logs of joints that move both ways at several speeds, by six laws of friction: no check may fail."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from strainwave.files.recording import Recording
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence.drawn.joint import Friction, several_speeds, torque_of_input
from tests.evidence.drawn.outcome import Outcome, compared

Array = NDArray[np.float64]


def outcome(seed: int) -> Outcome:
    """Return the outcome of a record; the law of friction is the remainder of the seed by six."""
    random = np.random.default_rng(seed)
    ratio = float(random.choice([50.0, 80.0, 100.0, 120.0, 160.0]))
    motion = several_speeds(random)
    level, fast = float(np.exp(random.uniform(np.log(0.015), np.log(0.12)))), ratio * float(np.abs(motion.speed).max())
    viscous = level * float(random.uniform(0.2, 1.0)) / fast
    name, law = tuple(LAWS.items())[seed % len(LAWS)]
    gravity = float(random.choice([0.0, random.uniform(1.0, 20.0)]))
    load, rotor = float(random.uniform(0.3, 2.0)), 2e-5
    torque, _ = torque_of_input(motion, ratio, rotor, load, gravity, law(level, viscous, fast))
    torque += float(random.uniform(0.01, 0.1)) * level * random.standard_normal(len(torque))
    at_joint = bool(random.integers(2))
    columns = {
        "time": motion.time,
        "output_angle": motion.angle + 1e-5 * random.standard_normal(len(torque)),
        "joint_torque" if at_joint else "input_torque": torque * (ratio if at_joint else 1.0),
    }
    units = {"time": "s", "output_angle": "rad"} | {each: "N.m" for each in columns if each.endswith("torque")}
    found = identify(
        "csg-20-100", {"log": Recording(columns, units)}, mapping=FileMapping(constants={"ratio": ratio, "motor_inertia": 1e-5})
    )
    if found.failed:
        return Outcome("wrong", f"{name}: " + "; ".join(f"{each.name}: {each.message}" for each in found.failed))
    (file, *_) = found.files
    known = {each.path: each for each in file.estimates if not each.why}
    if name not in ("Coulomb", "smooth"):
        return Outcome("right", name)
    truth = {"gear.friction_input.coulomb": level, "gear.friction_input.viscous": viscous}
    result = compared((path, known[path].value, known[path].sigma, truth[path]) for path in truth.keys() & known.keys())
    return Outcome(result.verdict, f"{name}: {file.model}: {result.message}")


def _coulomb(level: float, viscous: float, fast: float) -> Friction:
    return lambda speed, load: level * np.sign(speed) + viscous * speed


def _smooth(level: float, viscous: float, fast: float) -> Friction:
    return lambda speed, load: level * np.tanh(speed / (0.01 * fast)) + viscous * speed


def _stribeck(level: float, viscous: float, fast: float) -> Friction:
    return lambda speed, load: level * np.sign(speed) * (1.0 + 0.5 * np.exp(-((speed / (0.1 * fast)) ** 2))) + viscous * speed


def _curved(level: float, viscous: float, fast: float) -> Friction:
    return lambda speed, load: np.sign(speed) * (level + viscous * fast * (np.abs(speed) / fast) ** 0.6)


def _under_load(level: float, viscous: float, fast: float) -> Friction:
    return lambda speed, load: np.sign(speed) * (level + 0.05 * np.abs(load)) + viscous * speed


def _bristles(level: float, viscous: float, fast: float) -> Friction:
    """Return a friction that turns over within some angle of the input behind a reversal (Dahl1968), by its own integration."""

    def friction(speed: Array, load: Array) -> Array:
        bend, force, found = 0.1, 0.0, np.zeros_like(speed)
        step = 0.01
        for place, each in enumerate(speed):
            rate = step * abs(float(each)) / bend
            force += (float(np.sign(each)) * level - force) * (1.0 - np.exp(-rate))
            found[place] = force + viscous * float(each)
        return found

    return friction


LAWS: dict[str, Callable[[float, float, float], Friction]] = {
    "Coulomb": _coulomb,
    "smooth": _smooth,
    "Stribeck": _stribeck,
    "curved": _curved,
    "under load": _under_load,
    "bristles": _bristles,
}
