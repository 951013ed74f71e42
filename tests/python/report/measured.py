"""Measurements of gears that are not there, to be identified and reported."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet

HOSTILE = '<script>alert("x")</script> & <b>table</b>.csv'
SPEED = np.concatenate((-np.geomspace(0.5, 150.0, 15)[::-1], np.geomspace(0.5, 150.0, 15)))
LAW = sw.friction.LuGre(
    coulomb=0.06, breakaway=0.11, stribeck_speed=3.0, bristle_stiffness=90.0, bristle_damping=0.004, viscous=7e-4
)


def friction_table() -> sw.Recording:
    torque = LAW.steady(SPEED) * (1.0 + 0.01 * np.random.default_rng(1).normal(size=len(SPEED)))
    return sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}, title=HOSTILE)


def torsion_loop() -> sw.Recording:
    quarter = np.linspace(0.0, 1e-3, 60)
    path = np.concatenate((quarter[::-1], -quarter[1:], -quarter[-2::-1], quarter[1:]))
    elements = sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3], breakaway=[0.8, 1.2])
    torque = elements.trace(np.concatenate((path, path)))[-len(path) :] + 3e4 * path
    torque += 0.01 * np.random.default_rng(2).normal(size=len(path))
    return sw.Recording({"twist": path, "torque": torque}, {"twist": "rad", "torque": "N.m"})


def input_loop(start: GearSet, friction: float = 0.05) -> sw.Recording:
    """The same gear, measured at the input with the output locked."""
    loop, ratio = torsion_loop(), start.gear.kinematics.ratio
    angle = ratio * loop["twist"]
    torque = loop["torque"] / ratio + friction * np.sign(np.gradient(angle))
    return sw.Recording({"input_angle": angle, "input_torque": torque}, {"input_angle": "rad", "input_torque": "N.m"})


def with_drive(start: GearSet) -> GearSet:
    """The set with a small motor, a controller and a load, given by a maker."""
    rest = {
        "motor": sw.motor.DC(resistance=2.0, inductance=1e-3, torque_constant=0.05, back_emf=0.05, inertia=5e-5),
        "control": sw.control.PID(proportional=10.0, derivative=0.1, limit=24.0),
        "load": sw.loads.Inertia(inertia=0.2),
    }
    numbers = {
        f"{part}.{member['name']}": Entry("data sheet", uncertainty=0.0)
        for part, model in rest.items()
        for member in model.fields
        if member["kind"] != "choice"
    }
    return replace(start, sources={**start.sources, **numbers}, **rest)


def drive_log(start: GearSet) -> sw.Recording:
    command = sw.scenario.sine(amplitude=0.1, frequency=2.0, duration=0.6, phase=-np.pi / 2, offset=0.1)
    run, random = sw.simulate(start.drive, command, sample=5e-3), np.random.default_rng(3)
    noise = {"input_angle": 1e-4, "output_angle": 2e-6, "current": 5e-3}
    columns = {name: run[name] + sigma * random.normal(size=len(run)) for name, sigma in noise.items()}
    names = ("time", "command")
    units = {name: run.unit(name) for name in (*names, *noise)}
    return sw.Recording({name: run[name] for name in names} | columns, units)


def swing(samples: int, amplitude: float = 0.1) -> sw.Recording:
    time = np.linspace(0.0, 2.0, samples)
    command = amplitude * np.sin(2.0 * np.pi * time)
    columns = {"time": time, "command": command, "output_angle": 0.9 * command}
    return sw.Recording(columns, {"time": "s", "command": "rad", "output_angle": "rad"})
