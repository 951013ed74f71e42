"""Run-ups with an accelerometer: the resonance that orders of the shaft pass, and its damping ratio."""

from __future__ import annotations

from math import pi, tau

import numpy as np
from strainwave.files.recording import Recording
from strainwave.orders.measured import orders_found

from tests.evidence.drawn.outcome import Outcome, compared


def outcome(seed: int) -> Outcome:
    """Return the outcome of a run-up at a rate at which the resonance follows the orders as at each speed by itself."""
    random = np.random.default_rng(seed)
    frequency, damping = float(random.uniform(15.0, 60.0)), float(np.exp(random.uniform(np.log(0.015), np.log(0.1))))
    orders = sorted(float(each) for each in random.choice([1.0, 2.0, 3.0, 4.0], int(random.integers(1, 4)), replace=False))
    fastest = frequency / min(orders) * float(random.uniform(1.2, 2.0))  # revolutions per second
    slow = (damping * frequency) ** 2 / max(orders)  # revolutions per second, per second
    duration = float(np.clip(fastest / (0.05 * slow), 10.0, 60.0))
    time = np.arange(0.0, duration, 1.0 / (20.0 * max(orders) * fastest / 4.0))
    speed = np.linspace(0.02 * fastest, fastest, len(time))
    angle = tau * np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time))])
    measured = float(random.uniform(0.002, 0.03)) * random.standard_normal(len(time))
    measured += float(random.choice([0.0, 0.03])) * np.cos(tau * 50.0 * time)
    for order in orders:
        r = order * speed / frequency
        answer = r**2 / (1.0 - r**2 + 2j * damping * r)
        size, phase = float(random.uniform(0.02, 0.1)), float(random.uniform(-pi, pi))
        measured += size * np.real(answer * np.exp(1j * (order * angle + phase)))
    columns = {"time": time, "input_speed": tau * speed, "vibration": measured}
    try:
        found = orders_found(Recording(columns, {"time": "s", "input_speed": "rad/s", "vibration": "m/s2"})).run_up
    except ValueError as refused:
        return Outcome("refused", str(refused))
    if found is None or not np.isfinite(found.frequency):
        return Outcome("refused", "no resonance is stated" if found is None else "; ".join(found.remarks))
    what = f"orders {orders}, {frequency:.3g} Hz, damping {damping:.3f}, {fastest / duration / slow:.2g} of the slow rate"
    result = compared(
        [
            ("resonance", found.frequency, found.frequency_sigma, frequency),
            ("damping ratio", found.damping, found.damping_sigma, damping),
        ]
    )
    return Outcome(result.verdict, f"{what}: {result.message}")
