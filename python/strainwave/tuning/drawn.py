"""Gears that a set of numbers may be: drawn by what is known of each number."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.gear_set import GearSet
from strainwave.parameters import every

Array = NDArray[np.float64]

MAX_DRAWN = 1_000_000  # gears at a time, some 100 MB of numbers
ASSUMED_SPREAD = 0.3  # drawn factor up to 1 + this, either way, of a number that is assumed or has no stated spread
ASSUMED_SPREADS = {
    "load": 0.2,
    "motor.torque_constant": 0.05,
}  # likewise, of a load, and of a motor: magnets scatter by some percent and lose 0.1 % per kelvin
# Numbers that a gear has more than once, or of which no effect is larger or smaller.
SHAPE_NUMBERS = {"pressure_angle", "pitch_radius", "major_radius", "minor_radius", "offset", "reference_temperature"}
SCALED_UNITS = {
    "N.m",
    "N.m/rad",
    "N.m/rad3",
    "m",
    "N.m.s/rad",
    "rad",
    "kg.m2",
    "N.m/A",
}  # units of numbers that a gear may have more or less of
DRAWN_PARTS = ("gear.stiffness", "gear.hysteresis", "gear.kinematic_error", "gear.friction_input", "gear.friction_mesh",
         "gear.friction_output", "load", "gear.damping", "motor.torque_constant")  # fmt: skip


def drawn_gears(gear_set: GearSet, members: int, seed: int = 0) -> dict[str, Array]:
    """Return numbers of drives that a set may be, as `simulate_many` takes them.

    Identified numbers are drawn from their covariance. All other numbers of a part are multiplied by one factor, as a stiffer
    gear is stiffer at every twist: by up to 1 + the spread that the set states, either way, by 1.3 if it states none, 1.2 for
    the load, 1.05 for the torque constant of a motor. A phase that is assumed may be any. Exponents, characteristic speeds and
    the inertia of the motor are not drawn.

    Returns:
        the values of each number that differs, by path, shape (members,)

    >>> import strainwave as sw
    >>> draws = drawn_gears(sw.GearSet.read("robot-joint"), 3)
    >>> sorted({path.split(".")[1] for path in draws})
    ['damping', 'friction_input', 'gravity_torque', 'hysteresis', 'inertia', 'kinematic_error', 'stiffness']
    """
    arguments.whole("members", members, 1, MAX_DRAWN)
    chance = np.random.default_rng(seed)
    numbers = every(gear_set.drive)
    identified = dict(_identified(gear_set, members, chance))
    draws: dict[str, Array] = {}
    for part in DRAWN_PARTS:
        spread = spread_of(gear_set, part)
        factor = (1.0 + spread) ** chance.uniform(-1.0, 1.0, members)
        for path, number in numbers.items():
            if not _belongs(path, part):
                continue
            if path in identified:
                draws[path] = np.clip(identified[path], number.low, number.high)
            elif is_phase(path):
                if gear_set.sources[path].assumed and part != "load":
                    draws[path] = chance.uniform(-np.pi, np.pi, members)
            elif scales(path, number.unit) and number.value != 0.0:
                draws[path] = np.clip(number.value * factor, number.low, number.high)
    return draws


def is_phase(path: str) -> bool:
    """True for the phase of a wave over an angle."""
    return path.split("[")[0].endswith("phase")


def scales(path: str, unit: str) -> bool:
    """True if a gear may have more or less of a number."""
    return unit in SCALED_UNITS and path.rpartition(".")[2] not in SHAPE_NUMBERS and not is_phase(path)


def _identified(gear_set: GearSet, members: int, chance: np.random.Generator) -> Iterator[tuple[str, Array]]:
    """Yield draws of the numbers of a covariance, by path."""
    if gear_set.covariance is None:
        return
    numbers = every(gear_set.drive)
    paths = gear_set.covariance.paths
    offsets = chance.multivariate_normal(np.zeros(len(paths)), gear_set.covariance.array, members, method="eigh")
    for path, offset in zip(paths, offsets.T, strict=True):
        if path in numbers:
            yield path, numbers[path].value + offset


def spread_of(gear_set: GearSet, part: str) -> float:
    """Return the largest spread that a set states of the numbers of a part; that of numbers without one if it states none.

    >>> spread_of(GearSet.read("robot-joint"), "load"), spread_of(GearSet.read("robot-joint"), "motor.torque_constant")
    (0.2, 0.05)
    """
    stated = [entry.spread for path, entry in gear_set.sources.items() if _belongs(path, part) and entry.spread]
    return max(stated, default=ASSUMED_SPREADS.get(part, ASSUMED_SPREAD))


def _belongs(path: str, part: str) -> bool:
    return path == part or path.startswith(f"{part}.")
