"""Motions of the output shaft that a condition commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from strainwave.dataset.sampling import uniform
from strainwave.simulation import scenario
from strainwave.simulation.scenario import Scenario

POINTS_PER_MOVE = 24  # straight lines that a smooth move is made of
RANDOM_WAVES = 8  # sines of a random motion


@dataclass(frozen=True)
class ProfileKind:
    """A profile: its numbers with their units, and what makes the command of them and a seed."""

    doc: str
    units: Mapping[str, str]
    command: Callable[..., Scenario]


def _constant_speed(duration: float, seed: int, *, speed: float) -> Scenario:
    return scenario.ramp(speed, duration)


def _ramp(duration: float, seed: int, *, stroke: float, rise: float) -> Scenario:
    if rise >= duration:
        return scenario.ramp(stroke / rise, duration)
    return scenario.table([0.0, rise, duration], [0.0, stroke, stroke])


def _flight(duration: float, seed: int, *, stroke: float, correction: float, frequency: float) -> Scenario:
    third = duration / 3.0
    moves = scenario.table([0.0, third, 2.0 * third, duration], [0.0, stroke, stroke, 0.0])
    return moves + scenario.sine(correction, frequency, duration)


def _pick_and_place(duration: float, seed: int, *, stroke: float, period: float, dwell: float) -> Scenario:
    """Cycloidal moves there and back, each followed by a pause of `dwell` of its time."""
    share = np.linspace(0.0, 1.0, POINTS_PER_MOVE + 1)
    move = share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi)
    half = 0.5 * period
    cycles = np.arange(int(np.ceil(duration / period)))
    begin = np.concatenate([share * (1.0 - dwell), 1.0 + share * (1.0 - dwell)]) * half
    angle = np.concatenate([move, 1.0 - move]) * stroke
    times = (cycles[:, None] * period + begin).ravel()
    angles = np.tile(angle, len(cycles))
    kept = np.append(True, np.diff(times) > 0.0)  # without a pause a move begins where the last one ends
    times, angles = times[kept], angles[kept]
    inside = times < duration
    last = float(np.interp(duration, times, angles))
    return scenario.table(np.append(times[inside], duration), np.append(angles[inside], last))


def _random(duration: float, seed: int, *, amplitude: float, bandwidth: float) -> Scenario:
    """A sum of sines of random frequency up to the bandwidth and random phase, of root mean square `amplitude` if long."""
    places = np.arange(RANDOM_WAVES)
    frequencies = bandwidth * (places + uniform(seed, 0, places)) / RANDOM_WAVES
    phases = 2.0 * np.pi * uniform(seed, 1, places)
    height = amplitude * np.sqrt(2.0 / RANDOM_WAVES)
    motion = scenario.constant(-height * float(np.sin(phases).sum()), duration)  # begins at angle 0
    for frequency, phase in zip(frequencies.tolist(), phases.tolist(), strict=True):
        motion = motion + scenario.sine(height, frequency, duration, phase)
    return motion


PROFILES: dict[str, ProfileKind] = {
    "constant_speed": ProfileKind("a steady speed", {"speed": "rad/s"}, _constant_speed),
    "ramp": ProfileKind("to `stroke` within `rise`, then rest", {"stroke": "rad", "rise": "s"}, _ramp),
    "flight": ProfileKind(
        "out to `stroke`, a hold, and back, a third of the time each, with corrections by a sine",
        {"stroke": "rad", "correction": "rad", "frequency": "Hz"},
        _flight,
    ),
    "pick_and_place": ProfileKind(
        "smooth moves there and back within `period`, with a pause of the share `dwell` after each",
        {"stroke": "rad", "period": "s", "dwell": "1"},
        _pick_and_place,
    ),
    "random": ProfileKind(
        "eight sines of random frequency and phase, each condition with its own",
        {"amplitude": "rad", "bandwidth": "Hz"},
        _random,
    ),
}
PROFILE_LIMITS: dict[str, tuple[float, float]] = {"rise": (1e-3, np.inf), "period": (1e-2, np.inf), "dwell": (0.0, 0.9)}


def command_of(kind: str, numbers: Mapping[str, float], duration: float, seed: int) -> Scenario:
    """Return the command [rad] of a profile."""
    return PROFILES[kind].command(duration, seed, **numbers)


def peak_speed(command: Scenario, dt: float) -> float:
    """Return the highest speed [rad/s] that a command has at instants `dt` [s] apart."""
    instants = np.linspace(0.0, command.duration, int(np.ceil(command.duration / dt)) + 1)
    return float(np.abs(command.rate(instants)).max())
