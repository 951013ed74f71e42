"""Gears that all hosts get: each with one law that hosts often lose, and one that was identified."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import strainwave as sw

from tests.python.command import strainwave

TIME = np.arange(0.0, 12.0, 0.004)  # s, of the log that a gear is identified from
BRISTLES = {"bristle_stiffness": 50.0, "bristle_damping": 5e-4}
LUGRE = sw.friction.LuGre(coulomb=0.06, breakaway=0.08, stribeck_speed=2.0, viscous=4e-4, **BRISTLES)
ENDS = {"robot-joint": 4.0, "tilt-actuator": 0.6}  # kg.m², of the inertia that is the load of each drive


def gear_files(folder: Path) -> Iterator[tuple[str, Path]]:
    """Yield the gear files by what is special of them; each is a whole drive that takes an angle, before an inertia."""
    joint, staged = (_before_an_inertia(name) for name in ENDS)
    gear = joint.gear.replace(friction_input=LUGRE)
    lugre = sw.GearSet.of(joint.drive.replace(gear=gear), name="LuGre joint", source="of this table")
    lugre = lugre.replace(ratings=joint.ratings)
    for name, gear_set in (("hysteresis", joint), ("LuGre", lugre), ("staged", staged)):
        gear_set.save(folder / f"{name}.toml")
        yield name, folder / f"{name}.toml"
    yield "identified", _identified(folder)


def _before_an_inertia(name: str) -> sw.GearSet:
    """Return a drive of the catalogue with an inertia as its load."""
    load = sw.loads.Inertia(inertia=ENDS[name])
    return sw.GearSet.read(name).with_parts(load=load, source="of this table")


def _identified(folder: Path) -> Path:
    """Return the gear file that `identify` writes for a log of a joint with an inertia of 2 kg.m² and friction."""
    random = np.random.default_rng(1)
    angle = 0.8 * np.sin(1.3 * TIME) + 0.25 * np.sin(3.1 * TIME)
    speed = np.gradient(angle, TIME)
    torque = 2.0 * np.gradient(speed, TIME) + 6.0 * np.sign(speed) + 4.0 * speed + 0.2 * random.normal(size=len(TIME))
    columns = {"time": TIME, "q": angle + 2e-6 * random.normal(size=len(TIME)), "tau": torque}
    sw.Recording(columns, {"time": "s", "q": "rad", "tau": "N.m"}).to_csv(folder / "log.csv")
    strainwave("identify", "hysteresis.toml", "log.csv", "--out", "found", folder=folder)
    return folder / "found" / "gear.toml"
