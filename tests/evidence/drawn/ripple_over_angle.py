"""Ripple of a slow joint over an angle that has the gear's own error: there and back, triangles and sines."""

from __future__ import annotations

from math import pi, tau

import numpy as np
import strainwave as sw

from tests.evidence.drawn.outcome import Outcome, compared

RATIOS = (50, 80, 100, 120, 160)
MAX_GHOST_SHARE = 0.25  # of the amplitude of the line, beyond which a second line is a ghost


def outcome(seed: int) -> Outcome:
    """Return the outcome of `sw.orders.ripple` for a drawn joint."""
    random = np.random.default_rng(seed)
    ratio, motion = float(random.choice(RATIOS)), str(random.choice(["one way", "there and back", "triangle", "sine"]))
    order = float(random.choice([1.0, 2.0, 2.0, 4.0])) * ratio  # per turn of the joint
    swing, top = random.uniform(0.3, 3.0), random.uniform(0.03, 0.3)  # rad, rad/s
    per_period = random.uniform(8.0, 40.0)  # samples
    step = tau / (order * top * per_period)
    cycles = {
        "one way": 0.5,
        "there and back": 1.0,
        "triangle": float(random.integers(2, 5)),
        "sine": float(random.integers(1, 5)),
    }
    length = cycles[motion] * 4.0 * swing / top
    time = np.arange(0.0, min(length, 40_000 * step), step)
    share = time * cycles[motion] / length
    q = swing * np.sin(tau * share) if motion == "sine" else 2.0 * swing * np.abs(2.0 * ((0.5 * (share * 2.0)) % 1.0) - 1.0)
    speed = np.gradient(q, time)
    amplitude, noise = random.uniform(0.005, 0.1), random.uniform(0.001, 0.02)
    phase = random.uniform(-pi, pi)
    current = 0.3 * np.tanh(speed / 1e-3) + random.uniform(0.0, 1.0) * speed + random.uniform(0.0, 1.0) * np.cos(q + 0.3)
    current = current + amplitude * np.cos(order * q + phase) + random.normal(0.0, noise, len(time))
    error = random.choice([0.0, random.uniform(50e-6, 300e-6)])
    measured = q - error * np.sin(2.0 * ratio * q + 0.3) + random.normal(0.0, random.uniform(1e-6, 3e-5), len(time))
    known = bool(random.random() < 0.5)
    columns = {"time": time, "output_angle": measured, "current": current}
    recording = sw.Recording(columns, {"time": "s", "output_angle": "rad", "current": "A"})
    what = (
        f"{motion}, {len(time)} samples, {per_period:.0f} a period, ratio {ratio:g} {'given' if known else 'blind'}, "
        f"order {order:g}, swing {swing:.2f}, "
        f"{1e3 * amplitude:.3g} mA in {1e3 * noise:.2g}, error {1e6 * error:.0f} µrad"
    )
    try:
        result = sw.orders.ripple(recording, "current", ratio=ratio if known else None)
    except ValueError as problem:
        return Outcome("refused", str(problem))
    width = 2.0 * max(1.0, result.resolution)
    line = next((each for each in result.lines if abs(each.order - order) < width), None)
    threshold = float(np.interp(order, result.spectrum["order"], result.spectrum["threshold"]))
    if line is None:
        verdict = "refused" if threshold > amplitude else "wrong"
        return Outcome(verdict, f"{what}: no line, threshold {1e3 * threshold:.3g}")
    ghosts = [
        each
        for each in result.lines
        if each is not line and each.amplitude > MAX_GHOST_SHARE * amplitude and each.kind != "time"
    ]
    values = [each for each in (line.forward, line.backward) if not np.isnan(each)]
    found = compared([("line [mA]", 1e3 * each, 1e3 * line.sigma, 1e3 * amplitude) for each in values], floor=0.02)
    ghost = f"; ghosts {[(round(each.order, 1), round(1e3 * each.amplitude, 1)) for each in ghosts]}" if ghosts else ""
    return Outcome("wrong" if ghosts else found.verdict, f"{what}: {found.message}{ghost}")
