"""Five drives, and the inputs under which their exports are compared with the simulation over 10 s."""

from __future__ import annotations

import strainwave as sw

from tests.reference_drive import DRIVE

STEP = 2.0**-12  # s; its multiples are exact
ROOM = 293.15  # K
COMMAND = ((0.0, 1.0, 3.0, 5.0, 7.0, 9.0, 10.0), (0.0, 0.25, -0.25, 0.25, -0.25, 0.25, 0.0))  # s and rad: five reversals
LOAD = ((0.0, 5.5, 6.5, 10.0), (0.0, 0.0, 1.0, 1.0))  # s, N.m


def soft() -> sw.Drive:
    """The gear of document T under the position loop of example 14."""
    law = sw.control.PositionSpeed(
        position_gain=40.0, speed_proportional=0.05, speed_integral=1.0, limit=5.0, feedback="output"
    )
    gear, motor = sw.rig.printed_gear(0).replace(damping=20.0), sw.motor.TorqueSource(inertia=1e-4)
    return sw.Drive(gear=gear, motor=motor, control=law, load=sw.loads.Inertia(inertia=5.0))


def robot() -> sw.Drive:
    """The robot joint of the catalogue, whose controller samples in multiples of a step."""
    joint = sw.GearSet.read("robot-joint").drive
    return joint.replace(control=joint.control.replace(period=STEP, delay=0.5 * STEP))


def quiet(noisy: sw.Drive) -> sw.Drive:
    """A drive without what single precision cannot hold: noise of sensors, temperatures and energies."""
    plain, sensors = sw.Drive(), noisy.sensors
    laws = {field["name"]: getattr(sensors, field["name"]) for field in type(sensors).fields}
    laws = {name: law.law if isinstance(law, sw.sensor.Noisy) else law for name, law in laws.items()}
    return noisy.replace(sensors=sensors.replace(**laws), thermal=plain.thermal, meter=plain.meter)


DRIVES = {
    "reference": DRIVE,
    "robot": robot(),
    "lumped": sw.load("tilt-actuator-lumped"),
    "staged": sw.load("tilt-actuator"),
    "soft": soft(),
}
PERIODS = {name: 0.25 * STEP if name == "robot" else STEP for name in DRIVES}
