"""Robots with a gear in each joint: a UR10e along a trajectory with gravity, and one with nested classes and a free body."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import strainwave as sw
from numpy.typing import NDArray

from tests.hosts.hosts import Compared, Outcome, share
from tests.python.command import Result, strainwave
from tests.python.export.test_robot import ROBOT

Array = NDArray[np.float64]
SHARED = Path(__file__).parents[3] / "shared"
UR10E = Path(os.environ.get("STRAINWAVE_HOSTS", SHARED / "hosts")) / "ur10e.xml"
GEAR, SMALL_GEAR = "csg-32-100", "csg-14-100"
TIMESTEP, DURATION, SWING = 1e-4, 10.0, 0.4  # s, s, rad
FREQUENCIES = {"elbow_joint": 0.3, "knee": 2.0}  # Hz; a light leg of a falling robot loads its gear by fast motion alone
INERTIA_SHARE, BANDWIDTH = 5.0, 60.0  # of the rotor's inertia, and rad/s: of the controllers of the rotors
OPTION = f'<option timestep="{TIMESTEP!r}" integrator="implicitfast"/>'


def robots(folder: Path) -> Iterator[tuple[str, str, Outcome]]:
    """Yield gear, host and outcome of each robot."""
    if UR10E.exists():
        text = UR10E.read_text()
        begin = text.index(">", text.index("<mujoco")) + 1
        (folder / "ur10e.xml").write_text(text[:begin] + OPTION + text[begin:])
        joints = ",".join(f"wrist_{i}_joint={SMALL_GEAR}" for i in (1, 2, 3))
        done = _exported(GEAR, "ur10e.xml", f"{joints},all", folder)
        yield f"{GEAR}, {SMALL_GEAR}", "MuJoCo, UR10e, six joints", _outcome(done, folder, GEAR, "elbow_joint")
    (folder / "walker.xml").write_text(ROBOT.replace('timestep="0.0005"', f'timestep="{TIMESTEP!r}"'))
    done = _exported(SMALL_GEAR, "walker.xml", "all", folder)
    yield SMALL_GEAR, "MuJoCo, nested classes and a free body", _outcome(done, folder, SMALL_GEAR, "knee")


def _exported(gear: str, robot: str, joints: str, folder: Path) -> Result:
    """Return what the command for a robot prints."""
    return strainwave("export", "mjcf", gear, "--into", robot, "--joint", joints, "--out", "robot", folder=folder)


def _outcome(done: Result, folder: Path, gear: str, joint: str) -> Outcome:
    if done.returncode:
        return Outcome(done.stderr.strip(), "-", ())
    left_out = [line.partition("left out: ")[2] for line in done.stdout.splitlines() if f"left out: {joint}" in line]
    return Outcome("yes", moved(folder / "robot" / "gear.xml", gear, joint), left_out)


def moved(path: Path, gear: str, joint: str) -> Compared:
    """Return the twist of one gear of a robot that moves all its joints, against that of `sw.simulate`.

    The simulation gets the torque of the motor and the motion of the joint, as MuJoCo has them with gravity and the coupling of
    the links. Its gear has no kinematic error, which MJCF states as left out.
    """
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    rotors = [i for i in range(model.njnt) if model.joint(i).name.endswith("_gear_input")]
    motors = [model.actuator(model.joint(i).name.replace("_input", "_motor")).id for i in rotors]
    places, speeds = model.jnt_qposadr[rotors], model.jnt_dofadr[rotors]
    ratio = float(sw.load(gear).kinematics.ratio)
    begin, own = data.qpos[places].copy(), [model.joint(i).name for i in rotors].index(f"{joint}_gear_input")
    frequency = 2.0 * np.pi * FREQUENCIES[joint]
    output, steps = model.joint(joint).qposadr[0], round(DURATION / TIMESTEP)
    torques, angles, twists = np.zeros(steps + 1), np.zeros(steps + 1), np.zeros(steps + 1)
    started = time.process_time()
    for k in range(steps + 1):
        wanted = begin + ratio * SWING * (1.0 - np.cos(frequency * data.time))
        rate = ratio * SWING * frequency * np.sin(frequency * data.time)
        error = BANDWIDTH * (wanted - data.qpos[places]) + 2.0 * (rate - data.qvel[speeds])
        data.ctrl[motors] = INERTIA_SHARE * model.dof_armature[speeds] * BANDWIDTH * error
        torques[k], angles[k] = data.ctrl[motors[own]], data.qpos[output]
        twists[k] = data.qpos[places[own]] / ratio - angles[k]
        mujoco.mj_step(model, data)
    seconds = time.process_time() - started
    drive = sw.Drive(
        gear=sw.load(gear).replace(kinematic_error=sw.Gear().kinematic_error),
        motor=sw.motor.TorqueSource(inertia=0.0),
        control=sw.control.OpenLoop(),
        load=sw.loads.Prescribed(),
    )
    instants = TIMESTEP * np.arange(steps + 1)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = sw.simulate(
            drive,
            sw.scenario.table(instants, torques),
            TIMESTEP,
            sample=1e-2,
            inputs={"output_angle": sw.scenario.table(instants, angles)},
        )
    return Compared(
        share(twists[:: round(1e-2 / TIMESTEP)], run["twist"]), f"twist of {joint}, {DURATION:g} s", steps / seconds
    )
