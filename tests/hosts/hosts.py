"""Hosts: each takes the files of a first command, moves the gear as its user would, and is compared with `sw.simulate`."""

from __future__ import annotations

import io
import json
import math
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.export.newton import build

from tests.python.command import strainwave
from tests.support.firmware import Loaded, library, written

Array = NDArray[np.float64]
DURATION, FREQUENCY, SWING = 1.0, 1.0, 0.05  # s, Hz, rad: a motion to and fro that begins at rest
COMMUNICATION_STEP = 1e-3  # s
ENGINE_STEP = 5e-4  # s
SOLVER_TOLERANCE = 1e-6  # of CVODE
NEWTON_JOINTS = 1024  # simulated at once
DRIVING_TORQUE = 3.0  # times the friction at the input, in open loop
SPEEDS = np.concatenate([-np.geomspace(100.0, 1.0, 50), np.geomspace(1.0, 100.0, 50)])  # rad/s of the input


class Compared(NamedTuple):
    """Comparison of a host: RMS difference to the simulation over the size of a quantity, and steps per processor second."""

    share: float
    quantity: str
    rate: float = math.nan


@dataclass(frozen=True)
class Host:
    """A host: the words of its first command, and a function that runs the files of that command.

    Attributes:
        name: as the table has it
        words: of the command after `strainwave export`, without the gear and the folder
        run: function of the gear set and the folder with the files
        takes: function that makes the file of the drive to one that the host takes, if that is another one
    """

    name: str
    words: Sequence[str]
    run: Callable[[sw.GearSet, Path], Compared]
    takes: Callable[[sw.GearSet], sw.GearSet] = lambda gear_set: gear_set


class Outcome(NamedTuple):
    """A host with a gear: "yes" or the message of the first command, the comparison or its failure, and what is lost."""

    works: str
    compared: Compared | str
    lost: Sequence[str]


def outcome(host: Host, gear_set: sw.GearSet, folder: Path) -> Outcome:
    """Return what the first command and the run of a host give for a gear."""
    folder.mkdir(parents=True)
    gear_set = host.takes(gear_set)
    gear_set.save(folder / "gear.toml")
    verb, *options = host.words
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        if verb == "linearise":  # of Python: there is no file
            return Outcome("yes", _compared(host, gear_set, folder), ("stick, slip and hysteresis", "sampling", "noise"))
        done = strainwave("export", verb, "gear.toml", *options, "--out", "written", folder=folder)
        if done.returncode != 0:
            return Outcome(done.stderr.strip(), "-", ())
        about = folder / "written" / "export.json"
        lost = json.loads(about.read_text())["left_out"] if about.exists() else []
        return Outcome("yes", _compared(host, gear_set, folder / "written"), lost)


def _compared(host: Host, gear_set: sw.GearSet, folder: Path) -> Compared | str:
    try:
        with redirect_stdout(io.StringIO()):  # FMPy names inputs without a signal
            return host.run(gear_set, folder)
    except Exception as error:
        return f"{type(error).__name__}: {' '.join(str(error).split())[:100]}"


def motion(duration: float = DURATION) -> sw.scenario.Scenario:
    """Return the command of all hosts: an angle that swings to and fro from rest."""
    return sw.scenario.sine(SWING, FREQUENCY, duration, phase=-0.5 * np.pi, offset=SWING)


def share(found: Array, wanted: Array) -> float:
    """Return the RMS difference over the range of what is wanted."""
    return float(np.sqrt(np.mean((found - wanted) ** 2)) / np.ptp(wanted))


def in_fmpy(version: int, exchange: bool) -> Callable[[sw.GearSet, Path], Compared]:
    """Return the run of an FMU by FMPy, which gets the command only; of model exchange also its rate, as a solver needs it."""

    def run(gear_set: sw.GearSet, folder: Path) -> Compared:
        import fmpy

        (path,) = folder.glob("*.fmu")
        instants = np.linspace(0.0, DURATION, round(DURATION / COMMUNICATION_STEP) + 1)
        command, rate = motion().value(instants), motion().rate(instants)
        columns = [("time", instants), ("command", command), *([("command_rate", rate)] if exchange else [])]
        signals = np.rec.fromarrays([each for _, each in columns], names=[name for name, _ in columns])
        begin = time.process_time()
        result = fmpy.simulate_fmu(
            str(path),
            stop_time=DURATION,
            output_interval=COMMUNICATION_STEP,
            input=signals,
            output=["output_angle"],
            fmi_type="ModelExchange" if exchange else "CoSimulation",
            **({"relative_tolerance": SOLVER_TOLERANCE} if exchange else {}),
        )
        rate_of_steps = len(instants) / (time.process_time() - begin)
        wanted = sw.simulate(gear_set.drive, motion(), sample=COMMUNICATION_STEP)
        angle = np.interp(wanted.time, result["time"], result["output_angle"])
        return Compared(share(angle, wanted["output_angle"]), "output angle", rate_of_steps)

    return run


# Runs in a process of its own: its library prints. The wheel of ecospy lacks a library of TBB, which that of tbb contains.
ECOS_RUN = """
import ctypes, importlib.metadata, sys, time, numpy
(library,) = (each for each in importlib.metadata.files("tbb") if each.name == "libtbb.so.12")
ctypes.CDLL(str(library.locate()), ctypes.RTLD_GLOBAL)
from ecospy import EcosSimulation, EcosSimulationStructure
path, commands, step, out = sys.argv[1:]
structure = EcosSimulationStructure()
structure.add_model("gear", path)
simulation = EcosSimulation(float(step), structure=structure)
simulation.init()
angles, begin = [], time.process_time()
for command in numpy.load(commands):
    simulation.set_real("gear::command", command)
    angles.append(simulation.get_real("gear::output_angle"))
    simulation.step()
numpy.save(out, [*angles, len(angles) / (time.process_time() - begin)])
"""


def in_ecos(gear_set: sw.GearSet, folder: Path) -> Compared:
    """Return the run of an FMU by ecos, whose importer is fmi4c."""
    (path,) = folder.glob("*.fmu")
    instants = np.linspace(0.0, DURATION, round(DURATION / COMMUNICATION_STEP) + 1)
    np.save(folder / "commands.npy", motion().value(instants))
    words = [str(path), str(folder / "commands.npy"), str(COMMUNICATION_STEP), str(folder / "angles.npy")]
    done = subprocess.run([sys.executable, "-c", ECOS_RUN, *words], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr.strip().splitlines()[-1])
    *angles, rate = np.load(folder / "angles.npy")
    wanted = sw.simulate(gear_set.drive, motion(), sample=COMMUNICATION_STEP)["output_angle"]
    return Compared(share(np.array(angles), wanted), "output angle", rate)


# Runs in a process of its own: a plugin stays registered.
PLUGIN_RUN = """
import sys, time, mujoco, numpy
library, path, swing, frequency, steps, out = sys.argv[1:]
mujoco.mj_loadPluginLibrary(library)
model = mujoco.MjModel.from_xml_path(path)
data, angles, begin = mujoco.MjData(model), [0.0], time.process_time()
for _ in range(int(steps)):
    data.ctrl[0] = float(swing) * (1.0 - numpy.cos(2.0 * numpy.pi * float(frequency) * data.time))
    mujoco.mj_step(model, data)
    angles.append(data.qpos[0])
numpy.save(out, [*angles, int(steps) / (time.process_time() - begin), model.opt.timestep])
"""


def in_plugin(gear_set: sw.GearSet, folder: Path) -> Compared:
    """Return the run of the plugin of MuJoCo, with the timestep that the export chose or 0.5 ms."""
    steps = round(DURATION / ENGINE_STEP)
    words = ["./gear.so", "gear.xml", str(SWING), str(FREQUENCY), str(steps), "angles.npy"]
    done = subprocess.run([sys.executable, "-c", PLUGIN_RUN, *words], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr.strip().splitlines()[-1])
    *angles, rate, timestep = np.load(folder / "angles.npy")
    wanted = sw.simulate(gear_set.drive, motion(steps * timestep), sample=timestep)["output_angle"]
    return Compared(share(np.array(angles), wanted), "output angle", rate)


def open_loop(gear_set: sw.GearSet) -> sw.GearSet:
    """Return a drive with a torque at its input, as an actuator of MJCF is."""
    motor = sw.motor.TorqueSource(inertia=float(gear_set.motor.inertia))
    return gear_set.replace(
        motor=None,
        control=None,
        sensors=None,
        thermal=None,
        meter=None,
        covariance=None,
        sources={
            path: entry
            for path, entry in gear_set.sources.items()
            if path.partition(".")[0] not in ("motor", "control", "sensors", "thermal", "meter")
        },
    ).with_parts(motor=motor, source="of this table")


def in_mujoco(gear_set: sw.GearSet, folder: Path) -> Compared:
    """Return the run of the MJCF under a torque of the motor that swings."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(folder / "gear.xml"))
    data, steps = mujoco.MjData(model), round(DURATION / model.opt.timestep)
    size = DRIVING_TORQUE * float(np.abs(_friction_at_input(gear_set.gear, SPEEDS)).max())
    torque = sw.scenario.sine(size, FREQUENCY, DURATION)
    values = torque.value(model.opt.timestep * np.arange(steps))
    angles, place = [0.0], model.joint("gear_output").qposadr[0]
    begin = time.process_time()
    for value in values:
        data.ctrl[0] = value
        mujoco.mj_step(model, data)
        angles.append(data.qpos[place])
    rate = steps / (time.process_time() - begin)
    wanted = sw.simulate(gear_set.drive, torque, sample=model.opt.timestep)["output_angle"]
    return Compared(share(np.array(angles), wanted), "output angle, open loop", rate)


def in_firmware(scalar: Any) -> Callable[[sw.GearSet, Path], Compared]:
    """Return the run of firmware of the whole drive on the compiler of this machine."""

    def run(gear_set: sw.GearSet, folder: Path) -> Compared:
        firmware = written(gear_set, folder, scalar, name="drive", part="drive")
        program = Loaded(firmware, library(folder, [firmware]))
        steps = round(DURATION / firmware.period)
        instants = firmware.period * np.arange(steps + 1)
        command = motion().value(instants)
        inputs = {"command": command[:-1], "command_rate": np.diff(command) / firmware.period}
        begin = time.process_time()
        found = program.run(**inputs, temperature=np.full(steps, 293.15))
        rate = steps / (time.process_time() - begin)
        straight = sw.scenario.table(instants, command)
        wanted = sw.simulate(gear_set.drive, straight, firmware.period, sample=firmware.period)["output_angle"]
        return Compared(share(found["output_angle"], wanted[:steps]), "output angle", rate)

    return run


def in_newton(gear_set: sw.GearSet, folder: Path) -> Compared:
    """Return the run of the actuator of Newton on this processor, at joints that follow the simulated motion."""
    about = json.loads((folder / "drive.json").read_text())
    package = build.loaded(folder)
    plant = gear_set.drive.replace(load=sw.loads.Prescribed(), meter=sw.meter.NoMeter())
    instants = about["step"] * np.arange(round(0.2 / about["step"]) + 1)
    straight = sw.scenario.table(instants, motion().value(instants))
    run = build.reference_run(plant, straight, motion(0.2), about["step"])
    angles: Any = SimpleNamespace(value=straight.value, rate=np.zeros_like)  # as a user who sets no target speed
    found = build.followed(package, run, angles, about)
    begin = time.process_time()
    build.followed(package, run, angles, about, count=NEWTON_JOINTS)
    rate = NEWTON_JOINTS * len(run) / (time.process_time() - begin)
    return Compared(share(found["load_torque"], run["load_torque"]), "torque of the joint", rate)


def in_control(gear_set: sw.GearSet, folder: Path) -> Compared:
    """Return the response of the drive in python-control, linearised where it moves fastest: at rest it sticks."""
    import control

    fastest = 0.25 / FREQUENCY
    there = {"command": float(motion().value(fastest)), "command_rate": float(motion().rate(fastest))}
    linear = sw.linearise(gear_set.drive, sw.simulate(gear_set.drive, motion(fastest)).end, **there)
    plant = control.StateSpace(*linear, **linear.labels)
    instants = np.linspace(0.0, DURATION, round(DURATION / COMMUNICATION_STEP) + 1)
    inputs = {"command": motion().value(instants), "command_rate": motion().rate(instants)}
    given = np.array([inputs.get(name, np.zeros(len(instants))) for name in plant.input_labels])
    begin = time.process_time()
    response = control.forced_response(plant, instants, given)
    rate = len(instants) / (time.process_time() - begin)
    wanted = sw.simulate(gear_set.drive, motion(), sample=COMMUNICATION_STEP)["output_angle"]
    return Compared(share(response.outputs[plant.output_labels.index("output_angle")], wanted), "output angle", rate)


def _friction_at_input(gear: sw.Gear, speed: Array) -> Array:
    """Return the friction of a gear at the input [N.m], in the mean over a turn."""
    from strainwave.simulation.excitation import ROOM_TEMPERATURE
    from strainwave.tuning.cascade import steady_torque

    angle = np.linspace(0.0, 2.0 * np.pi * abs(float(gear.kinematics.ratio)), 61)
    torque: Array = steady_torque(gear, speed[:, None], angle[None, :], 0.0, ROOM_TEMPERATURE).friction.mean(axis=1)
    return torque


def in_bam(gear_set: sw.GearSet, folder: Path) -> Compared:
    """Return the friction by the law of BAM, over speeds of both senses."""
    numbers, ratio = json.loads((folder / "bam.json").read_text()), float(gear_set.gear.kinematics.ratio)
    speed = SPEEDS / ratio
    falls = 0.0
    if "friction_stribeck" in numbers:
        slow = np.exp(-(np.abs(speed / numbers["dtheta_stribeck"]) ** numbers["alpha"]))
        falls = numbers["friction_stribeck"] * slow
    torque = np.sign(speed) * (numbers["friction_base"] + falls) + numbers["friction_viscous"] * speed
    return Compared(share(torque / ratio, _friction_at_input(gear_set.gear, SPEEDS)), "friction")


def in_urdf(gear_set: sw.GearSet, folder: Path) -> Compared:
    """Return the friction of the joint that xacro and MuJoCo read from the macros of ROS 2."""
    import mujoco
    import xacro

    (path,) = folder.glob("*.xacro")
    link = '<inertial><mass value="2"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    (folder / "arm.xacro").write_text(f"""<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
      <xacro:include filename="{path}"/><link name="upper"/><link name="fore">{link}</link>
      <xacro:joint_joint parent="upper" child="fore" lower="-1" upper="1" xyz="0 0 1"/></robot>""")
    model = mujoco.MjModel.from_xml_string(xacro.process_file(str(folder / "arm.xacro")).toxml())
    ratio = float(gear_set.gear.kinematics.ratio)
    speed = SPEEDS / ratio
    torque = model.dof_frictionloss[0] * np.sign(speed) + np.ravel(model.dof_damping)[0] * speed
    return Compared(share(torque / ratio, _friction_at_input(gear_set.gear, SPEEDS)), "friction")


HOSTS = (
    Host("MuJoCo, MJCF", ("mjcf",), in_mujoco, open_loop),
    Host("MuJoCo, plugin", ("mujoco-plugin",), in_plugin),
    Host("FMPy, FMI 2 co-simulation", ("fmu",), in_fmpy(2, False)),
    Host("FMPy, FMI 3 co-simulation", ("fmu", "--version", "3"), in_fmpy(3, False)),
    Host("ecos, FMI 2 co-simulation", ("fmu",), in_ecos),
    Host("ecos, FMI 3 co-simulation", ("fmu", "--version", "3"), in_ecos),
    Host("FMPy, FMI 2 model exchange", ("fmu", "--model-exchange"), in_fmpy(2, True)),
    Host("FMPy, FMI 3 model exchange", ("fmu", "--version", "3", "--model-exchange"), in_fmpy(3, True)),
    Host("firmware, double", ("firmware", "--part", "drive", "--scalar", "double", "--name", "drive"), in_firmware("double")),
    Host("firmware, float", ("firmware", "--part", "drive", "--name", "drive"), in_firmware("float")),
    Host("Newton", ("newton", "--no-gpu", "--no-compare"), in_newton),
    Host("python-control", ("linearise",), in_control),
    Host("BAM", ("bam",), in_bam),
    Host("URDF, ROS 2", ("ros2", "--name", "joint"), in_urdf),
)
