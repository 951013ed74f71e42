"""Gears of drawn joint logs: what identify writes, predict takes, with the error stated; friction is that of the record.

A joint moves at one speed or several, with gravity and inertia that count or do not. Motion and torque are sums of sines and
triangles in numpy.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.files.gear_set import GearSet
from strainwave.parameters import every

from tests.evidence.drawn.outcome import Outcome

Array = NDArray[np.float64]
START = "csg-20-100"
SAMPLE_RATE = 200.0  # Hz
RECORD_DURATION = 12.0  # s
MAX_DIFFERENCE = 1e-3  # relative, of the error of predict from the one stated
MAX_FRICTION_ERROR = 0.05  # relative, at the usual speed
MIN_NUMBER = 1e-9  # a smaller number that is not 0 is a limit or rounding


def record(seed: int) -> tuple[sw.Recording, float, float]:
    """Return a log, its usual speed [rad/s], and the friction there [N.m], both of the input."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, RECORD_DURATION, 1.0 / SAMPLE_RATE)
    speed = float(random.uniform(5.0, 80.0))
    if random.random() < 0.5:  # to and fro at one speed
        period = float(random.uniform(2.0, 5.0))
        rate = speed * np.tanh(40.0 * np.sin(2.0 * np.pi * time / period + 0.3))
    else:
        rate = sum(speed * np.sin(2.0 * np.pi * f * time + random.uniform(0.0, 6.0)) for f in random.uniform(0.1, 0.8, 3))
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) / SAMPLE_RATE)])
    coulomb, viscous = float(random.uniform(0.03, 0.1)), float(random.uniform(1e-4, 8e-4))
    torque = coulomb * np.tanh(rate / 0.3) + viscous * rate + 2e-5 * np.gradient(rate, time)
    torque += random.choice([0.0, 0.1]) * np.sin(angle / 100.0) + random.choice([0.0, 1e-4]) * np.gradient(rate, time)
    torque += float(random.uniform(5e-4, 5e-3)) * random.standard_normal(len(time))
    columns = {"time": time, "input_angle": angle, "input_torque": torque}
    usual = float(np.median(np.abs(rate)))
    return sw.Recording(columns, {"time": "s", "input_angle": "rad", "input_torque": "N.m"}), usual, coulomb + viscous * usual


def outcome(seed: int) -> Outcome:
    """Return the outcome of one log."""
    log, speed, friction = record(seed)
    try:
        found = sw.identify(START, {"log": log}, accept=True)
    except ValueError as error:
        return Outcome("refused", str(error))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "gear.toml")
        found.gear_set.save(file)
        saved = GearSet.read(file)
        try:
            (predicted,) = sw.predict(file, {"log": log})
        except ValueError as error:
            return Outcome("wrong", f"predict refuses the gear: {error}")
    return judged(found, saved, predicted, speed, friction)


def judged(
    found: sw.identification.Identified, saved: GearSet, predicted: sw.identification.Prediction, speed: float, friction: float
) -> Outcome:
    """Return the outcome of a gear that was written and read, and of its prediction."""
    tiny = [path for path, each in every(saved.drive).items() if 0.0 < abs(each.value) < MIN_NUMBER and path != "motor.inertia"]
    if tiny:
        return Outcome("wrong", f"limits were written: {', '.join(tiny)}")
    stated = saved.validation[0].error
    if abs(predicted.error - stated) > MAX_DIFFERENCE * stated:
        return Outcome("wrong", f"predict leaves {predicted.error:.4g}, identify stated {stated:.4g}")
    off = float(saved.gear.friction_input.steady(speed)) / friction - 1.0
    if abs(off) > MAX_FRICTION_ERROR:
        return Outcome("refused" if found.failed else "wrong", f"friction at {speed:.3g} rad/s is off by {100.0 * off:.2g} %")
    return Outcome("right")
