"""Five drives and a motion of 10 s, by which exports are compared with the simulation and measured."""

from __future__ import annotations

from functools import cache

import strainwave as sw
from peers.strainwave_drive import drive as reference_drive

EXACT_STEP = 2.0**-12  # s: its multiples are exact
COMMAND_KNOTS = ((0.0, 1.0, 3.0, 5.0, 7.0, 9.0, 10.0), (0.0, 0.25, -0.25, 0.25, -0.25, 0.25, 0.0))  # s and rad
LOAD_KNOTS = ((0.0, 5.5, 6.5, 10.0), (0.0, 0.0, 1.0, 1.0))  # s and N.m
NAMES = ("reference", "robot", "lumped", "staged", "soft")
PERIODS = {name: 0.25 * EXACT_STEP if name == "robot" else EXACT_STEP for name in NAMES}  # s, of the steps of each


@cache
def drives() -> dict[str, sw.Drive]:
    """Return the drives by name."""
    found = reference_drive(), _robot(), sw.load("tilt-actuator-lumped"), sw.load("tilt-actuator"), _soft()
    return dict(zip(NAMES, found, strict=True))


def _robot() -> sw.Drive:
    """Return the robot joint of the catalogue with a controller that samples in multiples of a step."""
    return sw.load("robot-joint").replace({"control.period": EXACT_STEP, "control.delay": 0.5 * EXACT_STEP})  # type: ignore[no-any-return]


def _soft() -> sw.Drive:
    """Return the gear of document T under the position loop of example 14."""
    law = sw.control.PositionSpeed(
        position_gain=40.0, speed_proportional=0.05, speed_integral=1.0, limit=5.0, feedback="output"
    )
    gear, motor = sw.rig.printed_gear(0).replace(damping=20.0), sw.motor.TorqueSource(inertia=1e-4)
    return sw.Drive(gear=gear, motor=motor, control=law, load=sw.loads.Inertia(inertia=5.0))


def quiet(noisy: sw.Drive) -> sw.Drive:
    """Return a drive without noise of its sensors, at one temperature and without energies: what single precision can hold."""
    plain, sensors = sw.Drive(), noisy.sensors
    laws = {field["name"]: getattr(sensors, field["name"]) for field in type(sensors).fields}
    laws = {name: law.law if isinstance(law, sw.sensor.Noisy) else law for name, law in laws.items()}
    return noisy.replace(sensors=sensors.replace(**laws), thermal=plain.thermal, meter=plain.meter)
