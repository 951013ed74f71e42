"""The command `strainwave export`: a gear in the form of another program, with what that form loses."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strainwave.commands.options import numeric, whole

if TYPE_CHECKING:
    from strainwave.export.exported import Exported

export = typer.Typer(help="Write a gear in the form of another program, and state what that form loses.")

Gear = Annotated[str, typer.Argument(help="A gear or drive: a set by name, or a file as identify writes it.")]
Torque = Annotated[float | None, numeric("Largest torque at the output in N.m; usually the peak torque of the ratings.")]
Name = Annotated[str, typer.Option(help="Of the gear in the files.")]
Drive = Annotated[str, typer.Argument(help="A drive: a set with a motor and a load, by name or as a file.")]
Step = Annotated[float | None, numeric("Internal step in s; 0.2 ms, or shorter if the drive needs that.")]
Into = Annotated[Path | None, typer.Option(help="MJCF file of a robot that gets the gear.")]
Joint = Annotated[str | None, typer.Option(help="With --into: name of the hinge behind the gear.")]
LoadInertia = Annotated[float | None, numeric("Inertia at the output in kg.m2; usually that of the load.")]
Draws = Annotated[int, whole("Number of drawn gears, for domain randomisation.")]
Seed = Annotated[int, whole("Seed of the draw.")]
Out = Annotated[Path, typer.Option(help="Folder for the files written.", file_okay=False)]


@export.command("joint")
def joint(
    gear: Gear,
    max_torque: Torque = None,
    name: Name = "gear",
    out: Out = Path("out/joint"),
) -> None:
    """Numbers of a joint without a gear: frictionloss, armature, damping for MuJoCo; dynamics and transmission for URDF."""
    from strainwave.export.joint_numbers import joint as exported
    from strainwave.files.gear_set import GearSet

    _write(exported(GearSet.read(gear), max_torque=max_torque, name=name), out)


@export.command("mjcf")
def mjcf(
    gear: Gear,
    max_torque: Torque = None,
    load_inertia: LoadInertia = None,
    into: Into = None,
    joint: Joint = None,
    draws: Draws = 0,
    seed: Seed = 0,
    name: Name = "gear",
    out: Out = Path("out/mjcf"),
) -> None:
    """A model for MuJoCo without a plugin: twist with hysteresis, friction with a bristle, motor; alone or in a robot."""
    from strainwave.export.mujoco import mjcf as exported
    from strainwave.files.gear_set import GearSet

    found = exported(
        GearSet.read(gear), max_torque=max_torque, load_inertia=load_inertia, into=_model_text(into), joint=joint, draws=draws,
        seed=seed, name=name,
    )  # fmt: skip
    _write(found, out)


@export.command("ros2")
def ros2(
    gear: Gear,
    max_torque: Torque = None,
    name: Annotated[str, typer.Option(help="Of the joint.")] = "joint",
    out: Out = Path("out/ros2"),
) -> None:
    """Limits, feed-forward and transmission of a joint for ros2_control, and a node that simulates its drive."""
    from strainwave.export.ros2 import ros2 as exported
    from strainwave.files.gear_set import GearSet

    _write(exported(GearSet.read(gear), max_torque=max_torque, name=name), out)


@export.command("bam")
def bam(
    gear: Gear,
    max_torque: Torque = None,
    actuator: Annotated[str, typer.Option(help="Name of an actuator that BAM has, with its control law.")] = "erob80_100",
    out: Out = Path("out/bam"),
) -> None:
    """Parameters of BAM (better actuator models), with friction, inertia and torque constant at the output."""
    from strainwave.export.bam_parameters import bam as exported
    from strainwave.files.gear_set import GearSet

    _write(exported(GearSet.read(gear), actuator=actuator, max_torque=max_torque), out)


@export.command("slot")
def slot(
    gear: Gear,
    name: Annotated[
        str,
        typer.Argument(help="coulomb-viscous, speed-table, viscous-coulomb-scale, anticogging-map or torque-offset."),
    ],
    side: Annotated[str, typer.Option(help="Shaft of speeds and torques: input or output.")] = "input",
    unit: Annotated[str, typer.Option(help="N.m or, at the input, A.")] = "N.m",
    speed: Annotated[float | None, numeric("Of the output in rad/s: the largest, of a map that of the motion.")] = None,
    threshold: Annotated[float | None, numeric("Lowest speed of the output in rad/s; usually 1 % of the largest.")] = None,
    points: Annotated[int | None, whole("Number of points of a table.")] = None,
    load: Annotated[float | None, numeric("Torque at the output against forward motion in N.m.")] = None,
    rated_torque: Annotated[float | None, numeric("Of the motor in N.m; usually that of the ratings.")] = None,
    travel: Annotated[float, numeric("Of the motion of a torque-offset, from end to end in rad.")] = 0.2,
    period: Annotated[float, numeric("At which a torque-offset is sent, in s.")] = 1e-3,
    temperature: Annotated[float, numeric("Of the gear in K.")] = 293.15,
    members: Annotated[int, whole("Number of drawn gears that judge the scales.")] = 200,
    seed: Seed = 0,
    out: Out = Path("out/slot"),
) -> None:
    """Numbers of friction and ripple that robot controllers, joint firmware and servo drives have a slot for."""
    from strainwave.export.slots import slot as exported

    found = exported(
        gear, name, side=side, unit=unit, speed=speed, threshold=threshold, points=points, load=load,
        rated_torque=rated_torque, travel=travel, period=period, temperature=temperature, members=members, seed=seed,
    )  # fmt: skip
    _write(found, out)


@export.command("fmu")
def fmu(
    drive: Drive,
    version: Annotated[int, typer.Option(help="Of FMI: 2 or 3.")] = 2,
    platform: Annotated[
        list[str] | None,
        typer.Option(help="Of a binary, as x86_64-windows; may be repeated. `source` makes no binary. Default: this machine."),
    ] = None,
    model_exchange: Annotated[bool, typer.Option("--model-exchange", help="For the solver of the tool.")] = False,
    step: Step = None,
    name: Annotated[str | None, typer.Option(help="Of the model and of the file.")] = None,
    out: Out = Path("out/fmu"),
) -> None:
    """The whole drive as an FMU for Simulink, OpenModelica, Dymola or FMPy."""
    from strainwave.export.fmu import fmu as exported
    from strainwave.files.gear_set import GearSet

    platforms = None if platform is None else [each for each in platform if each != "source"]
    found = exported(
        GearSet.read(drive), version=version, platforms=platforms, model_exchange=model_exchange, step=step, name=name
    )
    _write(found, out)


@export.command("mujoco-plugin")
def mujoco_plugin(
    drive: Drive,
    into: Into = None,
    joint: Joint = None,
    load_inertia: LoadInertia = None,
    max_torque: Torque = None,
    command: Annotated[str, typer.Option(help="Within a timestep: held, or followed at the rate of the last one.")] = "held",
    step: Step = None,
    name: Annotated[str, typer.Option(help="Of the library, the plugin and the actuator.")] = "gear",
    out: Out = Path("out/mujoco-plugin"),
) -> None:
    """The whole drive as an actuator plugin, compiled for the MuJoCo that is installed, with a model that has it."""
    from strainwave.export.engine_plugin import mujoco_plugin as exported
    from strainwave.files.gear_set import GearSet

    found = exported(
        GearSet.read(drive), into=_model_text(into), joint=joint, load_inertia=load_inertia, max_torque=max_torque,
        command=command, step=step, name=name,  # type: ignore[arg-type] # checked there
    )  # fmt: skip
    _write(found, out)


@export.command("modelica")
def modelica(
    drive: Drive,
    max_torque: Torque = None,
    period: Annotated[float | None, numeric("Of the exchange in s; 0.5 ms, or shorter if the drive needs that.")] = None,
    step: Step = None,
    name: Annotated[str, typer.Option(help="Of the package and the library.")] = "StrainWaveDrive",
    out: Out = Path("out/modelica"),
) -> None:
    """The whole drive as a Modelica package: a component with a flange, and the library that it calls."""
    from strainwave.export.modelica_package import modelica as exported
    from strainwave.files.gear_set import GearSet

    _write(exported(GearSet.read(drive), max_torque=max_torque, period=period, step=step, name=name), out)


@export.command("newton")
def newton(
    drive: Drive,
    scalar: Annotated[
        str, typer.Option(help="Type of all numbers: double, or float for GPUs that are slow with doubles.")
    ] = "double",
    step: Step = None,
    draws: Draws = 0,
    seed: Seed = 0,
    gpu: Annotated[bool, typer.Option(help="Code for GPUs, if the package nvidia-cuda-nvrtc is installed.")] = True,
    compare: Annotated[bool, typer.Option(help="Compare with the simulation, if Newton is installed.")] = True,
    out: Out = Path("out/strainwave_drive"),
) -> None:
    """The drive as an actuator of Newton, for thousands of joints in one launch, on the CPU and on GPUs."""
    from strainwave.export.newton import newton as exported
    from strainwave.files.gear_set import GearSet

    found = exported(
        GearSet.read(drive),
        scalar=scalar,  # type: ignore[arg-type] # checked there
        step=step,
        draws=draws,
        seed=seed,
        gpu=gpu,
        compare=compare,
    )
    _write(found, out)


@export.command("firmware")
def firmware(
    drive: Annotated[str, typer.Argument(help="A drive, by name or as a file; for a law of the gear, a gear alone will do.")],
    part: Annotated[
        str,
        typer.Option(help="control, drive, or a law of the gear, as gear.friction_input."),
    ] = "control",
    scalar: Annotated[str, typer.Option(help="Type of all numbers: float or double.")] = "float",
    period: Annotated[float | None, numeric("Time between steps of a drive or a friction in s; 0.2 ms or shorter.")] = None,
    name: Annotated[
        str | None, typer.Option(help="Of the files, and prefix of all names in C; else the end of the part.")
    ] = None,
    out: Out = Path("out/firmware"),
) -> None:
    """A part of a drive for a microcontroller: a header of C++20 without includes, with an interface in C."""
    from strainwave.export.firmware import firmware as exported
    from strainwave.files.gear_set import GearSet

    found = GearSet.read(drive)
    written = exported(found, out, part=part, name=name, scalar=scalar, period=period)  # type: ignore[arg-type] # checked there
    for kind in ("inputs", "outputs"):
        print(f"{kind}: {', '.join(getattr(written, kind))}")
    print(f"size of the state: {len(written.state)}")
    every = f", to be called every {written.period:g} s" if written.period else ""
    files = (written.header, written.declarations, written.source)
    print(f"wrote {', '.join(each.name for each in files)} to {out}{every}")


@export.command("from-bam")
def from_bam(
    file: Annotated[Path, typer.Argument(help="Parameter file of BAM.")],
    ratio: Annotated[float, numeric("Ratio of the gear, which BAM does not state.")],
    out: Annotated[Path, typer.Option(help="Gear file to write.")] = Path("out/gear.toml"),
) -> None:
    """A gear file from parameters of BAM."""
    from strainwave.export.bam_parameters import read_bam

    found = read_bam(file, ratio)
    out.parent.mkdir(parents=True, exist_ok=True)
    found.save(out)
    print(f"{found.name}: {found.note}\nwrote {out}")


def _model_text(file: Path | None) -> str | None:
    """Return the text of the MJCF file of a robot; None if none is given."""
    from strainwave.export.mujoco import MAX_MODEL_BYTES
    from strainwave.files.budget import read_text

    return None if file is None else read_text(file, MAX_MODEL_BYTES)


def _listing(files: Collection[str]) -> str:
    """Return names of files in one line; of those in a folder of sources their number."""
    names = [each for each in files if "/Source/" not in each]
    sources = len(files) - len(names)
    return ", ".join(names) + (f" and {sources} sources" if sources else "")


def _write(found: Exported, out: Path) -> None:
    """Write the files of an export, and print its summary."""
    from strainwave.files.writing import write_folder
    from strainwave.report.exported import export_files, export_summary

    files = export_files(found)
    write_folder(out, files)
    print(export_summary(found))
    print(f"\nwrote {_listing(files)} to {out}")
