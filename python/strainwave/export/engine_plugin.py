"""A drive as an actuator plugin of MuJoCo, compiled for the version that is installed, with a model that has it.

MuJoCo moves the body behind the gear. The plugin steps controller, motor and gear up to the output shaft along the motion of
that body, and gives the torque.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Collection, Iterator, Mapping
from functools import partial
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, loads
from strainwave.export.command_mode import Command, command_mode
from strainwave.export.coupled import MAX_STABLE_SHARE, SUFFIXES, CoupledDrive, losses, shared_library
from strainwave.export.coupled.comparison import COMPARED_SAMPLES
from strainwave.export.elements import ShaftFriction, max_torque_of
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.internal_step import internal_step
from strainwave.export.mujoco import friction_attributes, inertia_on_a_hinge
from strainwave.export.names import checked_name
from strainwave.export.robot import Element, Robot, child, kept, timestep_of, written
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of
from strainwave.messages import one_line
from strainwave.simulation.signals import load_input

Array = NDArray[np.float64]
MIN_VERSION = 4_000_000  # of MuJoCo, as mjVERSION_HEADER counts
DEFAULT_TIMESTEP = 5e-4  # s, of a model that has the gear and an inertia only
MAX_RUN_SECONDS = 300.0  # of the compared run in MuJoCo

# Runs a model by itself: a plugin stays registered as long as the process lives.
RUN = """
import sys, mujoco, numpy
library, model, command, timestep, every, samples, angle, out = sys.argv[1:]
mujoco.mj_loadPluginLibrary(library)
model = mujoco.MjModel.from_xml_path(model)
model.opt.timestep = float(timestep)
data = mujoco.MjData(model)
data.qpos[0], data.ctrl[0], rows = float(angle), float(command), [float(angle)]
for _ in range(int(samples)):
    mujoco.mj_step(model, data, nstep=int(every))
    rows.append(data.qpos[0])
numpy.save(out, rows)
"""


@stating_origins
def mujoco_plugin(
    drive: Drive | GearSet,
    *,
    into: str | None = None,
    joint: str | None = None,
    keep: str | None = None,
    load_inertia: float | None = None,
    max_torque: float | None = None,
    command: Command | None = None,
    step: float | None = None,
    name: str = "gear",
) -> Exported:
    """Return a drive as a plugin of the MuJoCo that is installed, and a model with it: an inertia alone, or a robot.

    The plugin is an actuator. Its control is the command of the drive. It contains controller, sensors, motor and gear, and
    steps them by the code of `sw.simulate`; MuJoCo moves the load. Its state is in `mjData.plugin_state`.

    Args:
        drive: a drive, or a gear set with one. A body of MuJoCo takes the place of its load
        into: text of the MJCF file of a robot; a model with an inertia alone if not given
        joint: name of a hinge of the robot, which becomes the output
        keep: what the joint keeps of its own damping, frictionloss and armature besides the drive's, as "damping,armature"
        load_inertia: of the model with an inertia alone [kg.m²]; by default that of the load
        max_torque: at the output [N.m], up to which the stiffness limits the timestep; by default the peak torque of the
            ratings, or 0 without one
        command: "held" within a timestep, as a staircase, or "followed": it goes on at the rate of the last timestep; by
            default followed if it is an angle or a speed
        step: largest internal step [s]; by default 0.2 ms, or shorter where the drive needs that
        name: of the library, of the plugin after "strainwave.", and prefix of the actuator

    Returns:
        The library and the model `gear.xml`, the loss in a run, and the laws left out.

    Raises:
        TypeError, ValueError: an argument is not of its kind, there is no inertia, or the robot has no such hinge
        ImportError: MuJoCo is not installed, or older than 4.0
        NoCompilerError: there is no compiler
        CompileError: the compiler reports an error

    >>> import strainwave as sw
    >>> found = sw.export.mujoco_plugin(sw.GearSet.read("robot-joint"))  # doctest: +SKIP
    >>> list(found.files)  # doctest: +SKIP
    ['gear.so', 'gear.xml']
    """
    model, drive = drive, drive_of(drive)
    if (into is None) != (joint is None):
        raise ValueError("into and joint belong together: the file of a robot, and the name of one of its hinges")
    mode = command_mode(drive, command)
    checked_name(name, "MuJoCo", hyphens=True)
    largest = max_torque_of(model, max_torque) or 0.0
    include, version = installed_mujoco()
    step = internal_step(drive, step)
    coupled = CoupledDrive.of(drive, largest)
    inertia = _inertia(drive, load_inertia, into is None)
    alone = _alone(coupled, inertia, mode, name)
    text, remarks = (written(alone), ()) if into is None else _attached(into, str(joint), coupled, mode, name, kept(keep))
    suffix = SUFFIXES[sys.platform]
    content = compiled(coupled.sources(f"strainwave.{name}", step, "mujoco_plugin.cpp"), include)
    numbers = {
        "output_stiffness": (coupled.stiffness, "N.m/rad"),
        "output_hold": (coupled.hold, "N.m"),
        "longest_timestep": (coupled.max_timestep(inertia), "s"),
        "inertia_there": (inertia, "kg.m2"),
        "internal_step": (step, "s"),
    }
    lost = losses(drive, inertia, step, timestep_of(alone), "timestep", partial(_run_in_mujoco, content, written(alone)))
    return Exported(
        "MuJoCo plugin",
        model.name if isinstance(model, GearSet) else name,
        {f"{name}{suffix}": content, "gear.xml": text},
        numbers,
        tuple(lost),
        tuple(_left_out(drive)),
        (*remarks, *_remarks(name + suffix, version, mode, content)),
    )


def installed_mujoco() -> tuple[Path, str]:
    """Return the folder of the headers of MuJoCo, and its version.

    Raises:
        ImportError: it is not installed, older than `MIN_VERSION`, or has no headers
        ValueError: plugins are not compiled on this system
    """
    if sys.platform not in SUFFIXES:
        raise ValueError("a plugin of MuJoCo is compiled on Linux and macOS; on other systems take strainwave export mjcf")
    try:
        import mujoco
    except ImportError:
        raise ImportError("a plugin needs MuJoCo 4.0 or later, which is not installed; `pip install mujoco`") from None
    if mujoco.mj_version() < MIN_VERSION:
        raise ImportError(
            f"MuJoCo {mujoco.__version__} is installed, and a plugin needs 4.0 or later; `pip install --upgrade mujoco`, or "
            "take strainwave export mjcf"
        )
    include = Path(str(resources.files("mujoco"))) / "include"
    if not (include / "mujoco" / "mjplugin.h").is_file():
        raise ImportError(f"MuJoCo {mujoco.__version__} is installed without its headers; install the wheel from the index")
    return include, str(mujoco.__version__)


def compiled(sources: Mapping[str, str], include: Path) -> bytes:
    """Return the shared library of a plugin.

    Args:
        sources: texts by their names
        include: folder of the headers of MuJoCo

    Raises:
        NoCompilerError: there is no compiler
        CompileError: the compiler reports an error
    """
    return shared_library(sources, "mujoco_plugin.cpp", (f"-isystem{include}",))


def _inertia(drive: Drive, given: float | None, is_needed: bool) -> float:
    """Return the inertia at the output of the model with an inertia alone [kg.m²]."""
    if given is not None:
        return arguments.number("load_inertia", given, "kg.m2", low=0.0)
    inertia = float(getattr(drive.load, "inertia", 0.0))
    if inertia <= 0.0 and is_needed:
        raise ValueError(
            "the load has no inertia; give --load-inertia, in Python load_inertia, in kg.m2, or a robot and its joint"
        )
    return inertia or float(loads.Inertia().inertia)


def _alone(coupled: CoupledDrive, inertia: float, command: Command, name: str) -> Element:
    timestep = min(DEFAULT_TIMESTEP, MAX_STABLE_SHARE * coupled.max_timestep(inertia))
    root, _, shaft = inertia_on_a_hinge(inertia, timestep, name)
    _add_plugin(root, shaft, command, name)
    shaft.attrib.update(_hold(coupled, root))
    return root


def _attached(
    model: str, joint: str, coupled: CoupledDrive, command: Command, name: str, keep: Collection[str] = ()
) -> tuple[str, tuple[str, ...]]:
    """Return a robot's model with a drive at one of its joints, and remarks on what it changes."""
    robot = Robot.of(model)
    shaft = robot.hinge(joint)
    remarks = [*robot.replace_friction(shaft, _hold(coupled, robot.root), keep), *robot.others_on(joint, name)]
    _add_plugin(robot.root, shaft, command, name)
    for key in robot.root.findall("keyframe/key"):
        if key.get("ctrl"):
            key.set("ctrl", f"{key.attrib['ctrl']} 0")
    return written(robot.root), tuple(remarks)


def _hold(coupled: CoupledDrive, root: Element) -> dict[str, str]:
    """Return the attributes of a joint for the dry friction at the output of a drive."""
    return friction_attributes(ShaftFriction(dry=coupled.hold, viscous=0.0), timestep_of(root))


def _add_plugin(root: Element, shaft: Element, command: Command, name: str) -> None:
    """Add a drive to a model, at a joint of it."""
    plugin = f"strainwave.{name}"
    ElementTree.SubElement(child(root, "extension"), "plugin", plugin=plugin)
    motor = ElementTree.SubElement(
        child(root, "actuator"), "plugin", {"name": f"{name}_motor", "joint": shaft.attrib["name"], "plugin": plugin}
    )
    ElementTree.SubElement(motor, "config", key="command", value=command)


def _run_in_mujoco(content: bytes, model: str, command: float, angle: float, timestep: float, every: int) -> Array:
    """Return the output angle under a constant command [rad], in a process of its own."""
    with TemporaryDirectory() as folder:
        paths = [Path(folder, each) for each in ("plugin.so", "model.xml", "rows.npy")]
        paths[0].write_bytes(content)
        paths[1].write_text(model, "utf-8")
        words = (paths[0], paths[1], repr(command), repr(timestep), every, COMPARED_SAMPLES, repr(angle), paths[2])
        done = subprocess.run(
            [sys.executable, "-c", RUN, *map(str, words)], cwd=folder, capture_output=True, text=True, timeout=MAX_RUN_SECONDS
        )
        if done.returncode != 0:
            raise ValueError(f"MuJoCo did not run the plugin: {one_line(done.stderr.strip().rpartition(chr(10))[2])}")
        found: Array = np.load(paths[2])
        return found


def _left_out(drive: Drive) -> Iterator[str]:
    if load_input(drive) != "output_angle" and not isinstance(drive.load, loads.Inertia):
        yield f"the torque of the load {drive.load.name}: a body of MuJoCo takes the place of the load"
    yield "spin of the housing: the rotor counts its speed relative to the housing, as in joints with armature"
    yield "parameters in MJCF: they are constants of the library; export it again for others"
    yield "the temperature around the drive, which is constant"


def _remarks(file: str, version: str, mode: Command, content: bytes) -> Iterator[str]:
    yield "the error is of first order in the timestep: halve it and compare"
    yield f"the command is {mode} from timestep to timestep"
    yield f'load it before the model: mujoco.mj_loadPluginLibrary("./{file}")'
    yield f"{file} is for MuJoCo {version} alone, {len(content) / 1e3:.0f} kB; export it again after an update of MuJoCo"


MUJOCO_PLUGIN = Form(
    mujoco_plugin,
    "MuJoCo on a CPU: the whole drive",
    "a library for your version of MuJoCo, and a model that uses it",
    "mujoco.md#the-whole-drive-as-a-plugin",
)
