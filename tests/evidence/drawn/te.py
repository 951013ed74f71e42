"""Transmission error of two encoders: one speed, both ways, a sine, a ramp or steps; the output may vibrate."""

from __future__ import annotations

from math import pi, tau

import numpy as np
import strainwave as sw
from numpy.typing import NDArray

from tests.evidence.drawn.outcome import Outcome, compared

Array = NDArray[np.float64]
RATIOS = (30, 50, 51, 80, 100, 101, 120, 160)
MOTIONS = ("one speed", "there and back", "sine", "ramp", "steps")
MAX_SAMPLES = 30_000
STEPS_PER_SAMPLE = 8  # of the vibration, whose input is a straight line between two samples


def speed_of(motion: str, time: Array, top: float, random: np.random.Generator) -> Array:
    """Return the speed of the input over time [rad/s], shape (n,)."""
    share = time / time[-1]
    if motion == "there and back":
        return top * np.clip(40.0 * np.abs(((share * random.integers(1, 4)) % 1.0) - 0.5) - 10.0, -1.0, 1.0)
    if motion == "sine":
        return top * np.sin(tau * random.integers(1, 6) * share)
    if motion == "ramp":
        return top * (random.uniform(0.02, 0.3) + share)
    if motion == "steps":
        levels = top * random.permutation(np.geomspace(random.uniform(0.1, 0.4), 1.0, random.integers(3, 7)))
        step = share * len(levels)
        place = np.minimum(step.astype(int), len(levels) - 1)
        after = levels[np.minimum(place + 1, len(levels) - 1)]
        rise = np.clip((step - place - 0.95) / 0.05, 0.0, 1.0)
        return levels[place] + (after - levels[place]) * rise
    return np.full_like(time, top)


def vibrating(goal: Array, step: float, frequency: float, damping: float) -> Array:
    """Return the output angle that follows a goal through the spring of the gear, at rest in the frame of the first speed."""
    from scipy.signal import cont2discrete, lfilter

    line = goal[0] + (goal[1] - goal[0]) * np.arange(len(goal))  # steady motion passes unchanged
    over, under = [2.0 * damping * frequency, frequency**2], [1.0, 2.0 * damping * frequency, frequency**2]
    above, below, _ = cont2discrete((over, under), step, "foh")
    return np.asarray(lfilter(above.ravel(), below, goal - line)) + line


def outcome(seed: int) -> Outcome:
    """Return the outcome of `sw.transmission_error` for a drawn bench."""
    random = np.random.default_rng(seed)
    ratio, motion = float(random.choice(RATIOS)), str(random.choice(MOTIONS, p=(0.4, 0.15, 0.15, 0.15, 0.15)))
    top = random.uniform(5.0, 150.0) * pi / 30.0
    turns = min(20.0, random.choice([1.0, 1.0, 2.0, 5.0, 20.0]), MAX_SAMPLES / ratio / 20.0)  # of the output
    turns *= random.uniform(0.3, 1.0) if random.random() < 0.2 else 1.0
    length = turns * ratio * tau / top
    count = int(np.clip(turns * ratio * random.uniform(20.0, 100.0), 500, MAX_SAMPLES))
    time = np.linspace(-0.1 * length, length, STEPS_PER_SAMPLE * count)
    speed = speed_of(motion, time - time[0], top, random)
    theta = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    amplitudes = {2.0: random.uniform(3e-5, 3e-4), 4.0: random.uniform(1e-5, 8e-5)}
    phases = {order: random.uniform(-pi, pi) for order in amplitudes}
    error = sum(amplitudes[order] * np.sin(order * theta + phases[order]) for order in amplitudes)
    goal = theta / ratio - error
    frequency, damping, vibrates = random.uniform(0.1, 3.0) * 2.0 * top, random.uniform(0.02, 0.3), random.random() < 0.4
    output = vibrating(goal, float(time[1] - time[0]), frequency, damping) if vibrates else goal
    output = output + random.choice([0.0, 3e-4]) * np.sin(output + 1.0)  # a disc out of centre
    output = (
        output - 0.5 * random.choice([0.0, 2e-4]) * np.tanh(speed / (0.01 * top))
        if motion in ("sine", "there and back")
        else output
    )
    kept = (time >= 0.0) & (np.arange(len(time)) % STEPS_PER_SAMPLE == 0)
    time, theta, output = time[kept], theta[kept], output[kept]
    if random.random() < 0.3:
        counts = tau / 2.0 ** random.integers(12, 18), tau / 2.0 ** random.integers(18, 24)
        theta, output = (np.round(angle / count) * count for angle, count in zip((theta, output), counts, strict=True))
    else:
        theta = theta + random.normal(0.0, 10.0 ** random.uniform(-5.5, -3.0), len(time))
        output = output + random.normal(0.0, 10.0 ** random.uniform(-6.5, -4.5), len(time))
    sense = random.choice([-1.0, 1.0])
    columns = {"time": time, "input_angle": theta, "output_angle": sense * output}
    recording = sw.Recording(columns, {"time": "s", "input_angle": "rad", "output_angle": "rad"})
    try:
        result = sw.transmission_error(recording, ratio=ratio * sense)
    except ValueError as problem:
        return Outcome("refused", str(problem))
    pairs = []
    as_measured = [remark for remark in result.remarks if "are those measured at" in remark]
    if any("change with the speed" in remark for remark in as_measured):
        return Outcome("refused", *as_measured)
    for order, amplitude in amplitudes.items():
        found = next((each for each in result.orders if each.order == order and each.shaft == "input"), None)
        if found is None:
            continue
        x = 1j * order * top / frequency
        passed = (1.0 + 2.0 * damping * x) / (1.0 + 2.0 * damping * x + x**2)
        passed = passed.real if motion == "there and back" else passed  # its lag is of both senses
        gain = abs(passed) if vibrates and as_measured else 1.0
        pairs.append((f"order {order:g}", 1e6 * found.amplitude, 1e6 * found.amplitude_sigma, 1e6 * amplitude * gain))
    if not pairs:
        return Outcome("refused", "; ".join(result.remarks))
    what = f"{motion}, {turns:.2g} turns, ratio {ratio:g}, {count} samples"
    what += f", vibrates at {frequency / 2.0 / top:.2f} of order 2" if vibrates else ""
    found = compared(pairs, floor=0.005)
    return Outcome(found.verdict, f"{what}; stage {result.natural_frequency}; {found.message}")
