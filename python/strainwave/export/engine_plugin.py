"""A drive as an actuator plugin of MuJoCo, compiled for the version that is installed, with a model that has it.

MuJoCo moves the body behind the gear. The plugin steps controller, motor and gear up to the output shaft along the motion of
that body, and gives the torque.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib import resources
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, arguments, loads
from strainwave.export.coupled import MAX_STABLE_SHARE, SUFFIXES, CoupledDrive, losses, shared_library
from strainwave.export.coupled.drive import COMPARED_SAMPLES
from strainwave.export.elements import ShaftFriction, max_torque_of
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.host import Command, checked_name, command_mode, internal_step
from strainwave.export.mujoco import friction_attributes, inertia_on_a_hinge
from strainwave.export.robot import Element, Robot, Twist, child, gears_of_joints, kept, timestep_of, written
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of
from strainwave.messages import listed, one_line
from strainwave.simulation.signals import load_input
from strainwave.tuning.loss import ExportLoss

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
    into: str | Path | None = None,
    joint: str | Mapping[str, GearSet | str | Path] | None = None,
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
        into: MJCF file of a robot, or its text; a model with an inertia alone if not given
        joint: name of a hinge of the robot, which becomes the output; several as "hip,knee"; one with another drive as
            "knee=mine.toml"; "all" for all hinges that are not listed. In Python also a drive for each name
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
    if (into is None) != (joint is None):
        raise ValueError("into and joint belong together: the file of a robot, and one or several of its hinges")
    checked_name(name, "MuJoCo", hyphens=True)
    gear_set = drive if isinstance(drive, GearSet) else GearSet.of(drive_of(drive), name=name, source="given")
    include, version = installed_mujoco()
    if into is None or joint is None:
        plugins = [_Plugin.of(gear_set, name, max_torque, command, step)]
        inertia = _inertia(plugins[0].drive, load_inertia, is_needed=True)
        text, remarks = written(_alone(plugins[0], inertia)), list[str]()
    else:
        robot = Robot.of(into)
        gears = gears_of_joints(robot, joint, gear_set)
        plugins = [
            _Plugin.of(each, name if number == 1 else f"{name}_{number}", max_torque, command, step)
            for number, each in enumerate({id(each): each for each in gears.values()}.values(), start=1)
        ]
        plugin_of = {shaft: next(each for each in plugins if each.gear_set is gear) for shaft, gear in gears.items()}
        twists = list[Twist]()
        for shaft, plugin in plugin_of.items():
            list(robot.replace_friction(robot.hinge(shaft), plugin.hold(robot.root), kept(keep)))
            twists.append(Twist("", shaft, 1.0, plugin.coupled.stiffness, plugin.coupled.damping))
        robot, remarks = Robot.stable(into, robot.longest_timestep(twists))
        for shaft, plugin in plugin_of.items():
            remarks += _attach(robot, shaft, plugin, name if len(gears) == 1 else f"{shaft}_{name}", kept(keep))
        text = written(robot.root)
    files: dict[str, str | bytes] = {}
    numbers, losses_of_runs, left_out = dict[str, tuple[float, str]](), list[ExportLoss](), list[str]()
    for plugin in plugins:
        inertia = _inertia(plugin.drive, load_inertia, is_needed=False)
        alone, prefix = _alone(plugin, inertia), f"{plugin.name}: " if len(plugins) > 1 else ""
        content = compiled(plugin.coupled.sources(f"strainwave.{plugin.name}", plugin.step, "mujoco_plugin.cpp"), include)
        files[plugin.file] = content
        numbers |= {prefix + key: value for key, value in plugin.numbers(inertia).items()}
        run = partial(_run_in_mujoco, content, written(alone))
        found = losses(plugin.drive, inertia, plugin.step, timestep_of(alone), "timestep", run)
        losses_of_runs += [replace(each, quantity=prefix + each.quantity) for each in found]
        left_out += [prefix + each for each in _left_out(plugin.drive)]
        remarks += _remarks(plugin, version, content)
    return Exported(
        "MuJoCo plugin",
        listed(dict.fromkeys(each.gear_set.name for each in plugins)),
        files | {"gear.xml": text},
        numbers,
        tuple(losses_of_runs),
        tuple(left_out),
        (*remarks, "the error is of first order in the timestep: halve it and compare"),
    )


@dataclass(frozen=True)
class _Plugin:
    """A drive and the plugin of it, which any number of joints have.

    Attributes:
        name: of the library, and of the plugin after "strainwave."
        gear_set: the drive with its ratings
        drive: of the set
        coupled: the drive with its output moved by MuJoCo
        command: "held" or "followed"
        step: largest internal step [s]
    """

    name: str
    gear_set: GearSet
    drive: Drive
    coupled: CoupledDrive
    command: Command
    step: float

    @classmethod
    def of(cls, gear_set: GearSet, name: str, max_torque: float | None, command: Command | None, step: float | None) -> _Plugin:
        """Return the plugin of a set with a drive; the arguments are those of `mujoco_plugin`."""
        drive = drive_of(gear_set)
        coupled = CoupledDrive.of(drive, max_torque_of(gear_set, max_torque) or 0.0)
        return cls(name, gear_set, drive, coupled, command_mode(drive, command), internal_step(drive, step))

    @property
    def file(self) -> str:
        """Name of the library."""
        return f"{self.name}{SUFFIXES[sys.platform]}"

    def hold(self, root: Element) -> dict[str, str]:
        """Return the attributes of a joint of a model for the dry friction at the output."""
        return friction_attributes(ShaftFriction(dry=self.coupled.hold, viscous=0.0), timestep_of(root))

    def add(self, root: Element, shaft: Element, name: str) -> None:
        """Add the drive to a model, at a joint of it; `name` begins that of the actuator."""
        plugin = {"plugin": f"strainwave.{self.name}"}
        extension = child(root, "extension")
        if all(each.get("plugin") != plugin["plugin"] for each in extension):
            ElementTree.SubElement(extension, "plugin", plugin)
        motor = {"name": f"{name}_motor", "joint": shaft.attrib["name"], **plugin}
        ElementTree.SubElement(
            ElementTree.SubElement(child(root, "actuator"), "plugin", motor), "config", key="command", value=self.command
        )

    def numbers(self, inertia: float) -> dict[str, tuple[float, str]]:
        """Return what the plugin states, with the longest timestep before an inertia [kg.m²]."""
        return {
            "output_stiffness": (self.coupled.stiffness, "N.m/rad"),
            "output_hold": (self.coupled.hold, "N.m"),
            "longest_timestep": (self.coupled.max_timestep(inertia), "s"),
            "inertia_there": (inertia, "kg.m2"),
            "internal_step": (self.step, "s"),
        }


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


def _alone(plugin: _Plugin, inertia: float) -> Element:
    timestep = min(DEFAULT_TIMESTEP, MAX_STABLE_SHARE * plugin.coupled.max_timestep(inertia))
    root, _, shaft = inertia_on_a_hinge(inertia, timestep, plugin.name)
    plugin.add(root, shaft, plugin.name)
    shaft.attrib.update(plugin.hold(root))
    return root


def _attach(robot: Robot, joint: str, plugin: _Plugin, name: str, keep: Collection[str]) -> list[str]:
    """Put a drive at a joint of a robot, and return remarks on what that changes."""
    shaft = robot.hinge(joint)
    remarks = [*robot.replace_friction(shaft, plugin.hold(robot.root), keep), *robot.others_on(joint, name)]
    plugin.add(robot.root, shaft, name)
    for key in robot.root.findall("keyframe/key"):
        if key.get("ctrl"):
            key.set("ctrl", f"{key.attrib['ctrl']} 0")
    return remarks


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


def _remarks(plugin: _Plugin, version: str, content: bytes) -> Iterator[str]:
    yield f"the command is {plugin.command} from timestep to timestep"
    yield f'load it before the model: mujoco.mj_loadPluginLibrary("./{plugin.file}")'
    yield f"{plugin.file} is for MuJoCo {version} alone, {len(content) / 1e3:.0f} kB; export it again after an update of MuJoCo"


MUJOCO_PLUGIN = Form(
    mujoco_plugin,
    "MuJoCo on a CPU: the whole drive",
    "a library for your version of MuJoCo, and a model that uses it",
    "mujoco.md#the-whole-drive-as-a-plugin",
)
