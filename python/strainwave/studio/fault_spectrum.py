"""Orders of the motor current under a misalignment of the wave generator, and the smallest lines that a record shows."""

from __future__ import annotations

from collections.abc import Mapping
from math import hypot
from typing import Any

from strainwave import Drive, arguments
from strainwave.diagnose.actuator_ramp import wave_generator
from strainwave.diagnose.detection import DETECTION_PROBABILITY, FALSE_ALARM, needed_signal_to_noise
from strainwave.diagnose.smallest_error import RecordedOrder, SteadyRun

ORDERS = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)  # periods per revolution of the input
MAX_MISALIGNMENT = 1e-3  # m and rad: beyond it the wave generator would not fit
MOVED = ("housing_eccentricity", "housing_tilt_x", "generator_eccentricity", "generator_tilt_x")


def fault_spectrum(
    drive: Drive, moved: Mapping[str, float], record: Mapping[str, float], combine: str = "mean"
) -> dict[str, Any]:
    """Return the amplitudes of the current of a drive without and with a misalignment, by order, with the detection limits.

    Args:
        drive: with a controller and a motor whose current is recorded
        moved: eccentricities [m] and tilts [rad] of the wave generator, by the names of `kinematic_error.Misalignment`
        record: speed of the input [rad/s], load_torque at the output [N.m], duration [s], rate [Hz], noise of a sample [A]
        combine: how the lobes share, as of `kinematic_error.Misalignment`

    Raises:
        ValueError: a number is out of range, or the drive does not make such a record

    >>> import strainwave as sw
    >>> record = {"speed": 30.0, "load_torque": 0.0, "duration": 2.0, "rate": 500.0, "noise": 0.02}
    >>> moved = {"housing_eccentricity": 50e-6}
    >>> spectrum = fault_spectrum(sw.load("tilt-actuator-lumped"), moved, record, "single")
    >>> [order for order, size, limit in zip(spectrum["orders"], spectrum["misaligned"], spectrum["limit"]) if size > limit]
    [1.0, 2.0]
    """
    law, is_assumed = wave_generator(drive)
    sizes = {
        name: arguments.number(name, moved.get(name, 0.0), "", "[]", -MAX_MISALIGNMENT, MAX_MISALIGNMENT) for name in MOVED
    }
    numbers = {name: arguments.number(name, record.get(name)) for name in ("speed", "load_torque", "duration", "rate", "noise")}
    run = SteadyRun.of(drive, numbers["speed"], numbers["load_torque"], numbers["duration"], numbers["rate"], max(ORDERS))
    healthy, misaligned = (run.with_law(law.replace(**of, combine=combine)) for of in ({}, sizes))
    spectrum: dict[str, Any] = {"orders": list(ORDERS), "healthy": [], "misaligned": [], "limit": [], "assumed": is_assumed}
    for order in ORDERS:
        before, after = (RecordedOrder.of(each, order) for each in (healthy, misaligned))
        needed = needed_signal_to_noise(DETECTION_PROBABILITY, FALSE_ALARM, before.regression.freedom, len(ORDERS))
        spectrum["healthy"].append(abs(before.wave))
        spectrum["misaligned"].append(abs(after.wave))
        spectrum["limit"].append(needed * before.sigma(hypot(numbers["noise"], before.own_noise)))
    return spectrum
