"""Logs of a joint to and fro at one speed: the sum of Coulomb and viscous friction there is the number, neither alone."""

from __future__ import annotations

import numpy as np
from strainwave.files.recording import Recording
from strainwave.identification.identify import identify
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence.drawn.outcome import Outcome, compared

RATIO = 100.0  # of the gear


def outcome(seed: int) -> Outcome:
    """Return the outcome of a triangle of the angle with short reversals."""
    random = np.random.default_rng(seed)
    rate, speed = float(random.choice([100.0, 200.0, 500.0])), float(np.exp(random.uniform(np.log(0.03), np.log(1.0))))
    time = np.arange(0.0, 30.0, 1.0 / rate)
    half = float(random.uniform(1.0, 4.0))  # s
    ramp = float(random.uniform(0.02, 0.1)) * half  # s
    phase = np.mod(time, 2.0 * half)
    velocity = speed * np.clip(
        np.where(phase < half, np.minimum(phase, half - phase), -np.minimum(phase - half, 2.0 * half - phase)) / ramp, -1.0, 1.0
    )
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]))]) / rate
    acceleration = np.gradient(velocity, 1.0 / rate)
    coulomb = float(np.exp(random.uniform(np.log(0.01), np.log(0.1))))
    viscous = coulomb * float(random.uniform(0.05, 0.6)) / (RATIO * speed)
    load, gravity = float(random.uniform(0.1, 1.0)), float(random.choice([0.0, random.uniform(1.0, 8.0)]))
    torque = coulomb * np.sign(velocity) + viscous * RATIO * velocity + (load * acceleration + gravity * np.sin(angle)) / RATIO
    torque += coulomb * float(random.uniform(0.01, 0.1)) * random.standard_normal(len(time))
    columns = {"time": time, "output_angle": angle + 1e-6 * random.standard_normal(len(time)), "current": torque / 0.1}
    units = {"time": "s", "output_angle": "rad", "current": "A"}
    found = identify("csg-20-100", {"log": Recording(columns, units)}, mapping=FileMapping(constants={"torque_constant": 0.1}))
    (file, *_) = found.files
    if file.refused or found.failed:
        return Outcome("refused", file.refused or "; ".join(each.message for each in found.failed))
    truth = {
        "steady_friction": coulomb + viscous * RATIO * speed,
        "gear.friction_input.coulomb": coulomb,
        "gear.friction_input.viscous": viscous,
    }
    listed = [each for each in file.estimates if each.path in truth and each.state != "not identified"]
    if not listed:
        return Outcome("refused", f"{file.model}: no friction is identified")
    return compared(((each.label, each.value, each.sigma, truth[each.path]) for each in listed), floor=1e-3)
