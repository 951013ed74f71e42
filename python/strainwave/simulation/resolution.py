"""Checks of a run: steps that are too long, and outputs without meaning."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from decimal import ROUND_FLOOR, Context

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core
from strainwave.messages import listed
from strainwave.simulation.excitation import ROOM_TEMPERATURE

Array = NDArray[np.float64]

MAX_STEP_PHASE = 1.0  # rad: step times angular frequency of a drive's own motion
FASTEST_ON_BRISTLES = 2.0  # rad: step times angular frequency of a shaft on its bristles, beyond which fixed steps may be wrong
MOTOR_FAULTS = ("phase_resistance_excess", "dead_time_voltage")  # that let currents decay faster
LARGEST_OUTPUT: float = _core.largest  # of all that is recorded


def diverged(time: Array, names: Sequence[str], outputs: Array, what_to_do: str) -> str:
    """Return the message that names the first output without meaning and its time; outputs of shape (names, samples)."""
    sound = np.abs(outputs) <= LARGEST_OUTPUT  # neither not-a-number nor out of all bounds
    where = int(np.argmin(sound.all(axis=0)))
    wrong = [name for name, is_sound in zip(names, sound[:, where], strict=True) if not is_sound]
    place = f" at t = {time[where]:.6g} s ({listed(wrong)})" if wrong else ""
    return f"the simulation diverged{place}; {what_to_do}"


def check_resolution(drive: Drive, dt: float, twist: float, temperature: float) -> None:
    """Refuse steps too coarse for a drive at the temperature [K] where a run begins.

    Before a run at rest, else many a step may be spent on events that mean nothing.
    """
    fastest = _core.max_rate(drive, twist, temperature)
    if fastest * dt > MAX_STEP_PHASE:
        raise FloatingPointError(too_coarse(dt, twist, fastest, fastest_part(drive, twist, temperature, fastest)))


def fine_enough(drive: Drive, dt: float, shortest: float) -> float:
    """The step `dt` [s], or half, a quarter … of it where a drive at room temperature needs that; `shortest` at the least.

    By halves, so that drives that differ little take the same steps.
    """
    needed = MAX_STEP_PHASE / _core.max_rate(drive, 0.0, ROOM_TEMPERATURE)
    return dt if dt <= needed else max(dt * 0.5 ** np.ceil(np.log2(dt / needed)), shortest)


def fastest_part(drive: Drive, twist: float, temperature: float, fastest: float) -> str:
    """Return the part of a drive that causes this rate [rad/s]: the one without which the drive is slower."""
    plain, motor = Drive(), drive.motor
    healthy = motor.replace(**{name: 0.0 for name in MOTOR_FAULTS if hasattr(motor, name)})
    without = {
        "a body within its gear": drive.replace(gear=drive.gear.replace(structure=plain.gear.structure)),
        "a sensor": drive.replace(sensors=plain.sensors),
        "what its controller filters": drive.replace(control=plain.control),
        "a fault of its motor (an uneven phase, dead time)": drive.replace(motor=healthy),
    }
    slower = (words for words, rest in without.items() if _core.max_rate(rest, twist, temperature) < fastest)
    return next(slower, "its own motion")


def too_coarse(dt: float, twist: float, fastest: float, part: str) -> str:
    """Return the message that steps of `dt` [s] cannot follow the motion of a part, so that the numbers would mean nothing.

    Of a vibration of angular frequency w the classical scheme diverges beyond dt w = 2.8, and loses a hundredth of the
    amplitude each step at 1.
    """
    return (
        f"dt = {dt:g} s is too coarse for this drive: {part} is as fast as a vibration of {fastest:.4g} rad/s "
        f"at a twist of {twist:.3g} rad; take dt = {rounded_down(MAX_STEP_PHASE / fastest):g} s or less"
    )


def rounded_down(step: float) -> float:
    """Return the largest number of two digits that does not exceed a step [s], beyond errors of rounding."""
    return float(Context(prec=2, rounding=ROUND_FLOOR).create_decimal(f"{step:.12g}"))


def too_stiff(dt: float, vibration: float) -> str:
    """Return the message that fixed steps of `dt` [s] may be wrong for a shaft that vibrates on its bristles [rad/s]."""
    return (
        f"bristles on which a shaft vibrates faster than steps of {dt:g} s can follow, at {vibration:.3g} rad/s; where it "
        f"comes to rest or turns round results may be wrong: "
        f"take dt = {rounded_down(FASTEST_ON_BRISTLES / vibration):g} s or less"
    )


def warn_of_bristles(drive: Drive, dt: float) -> None:
    """Warns the caller of a function of this package that takes steps of `dt` [s], if the drive's bristles are too stiff."""
    vibration = _core.bristle_frequency(drive)
    if dt * vibration > FASTEST_ON_BRISTLES:
        warnings.warn(f"the drive has {too_stiff(dt, vibration)}", RuntimeWarning, stacklevel=3)


def remedy(dt: float) -> str:
    """Return the remedy for a run that diverged."""
    return f"take a smaller dt (now {dt:g} s) or check the parameters"
