"""Actuators of Newton: a Python package with the C++ code of a drive, its PTX, and its difference to the simulation."""

from __future__ import annotations

import importlib.util
import json
import sys
import warnings
from collections.abc import Iterator
from functools import lru_cache
from hashlib import sha256
from importlib import resources
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, _core, arguments, loads, meter
from strainwave.export import cplusplus
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.host import Command, command_mode, internal_step
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of
from strainwave.native import nvrtc
from strainwave.native.static_type import SCALARS, Scalar, in_words, static_type
from strainwave.simulation import scenario, signals
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.run import Run, simulate
from strainwave.simulation.scenario import Scenario
from strainwave.tuning.drawn import drawn_gears
from strainwave.tuning.loss import ExportLoss

Array = NDArray[np.float64]
COMPARED = ("torque", "load_torque", "twist", "input_speed", "current")
COMPARED_DURATION = 0.2  # s
COMPARED_BEGIN = 0.02  # s, of the command
COMPARED_AMPLITUDE = 0.02  # rad, of the joint
COMPARED_FREQUENCY = 5.0  # Hz
COMMAND_SIZES = {"rad": 0.02, "rad/s": 0.5}  # size of the command by its unit
OTHER_COMMAND = 0.1  # in other units: V, A, N.m
PACKAGE = "strainwave_drive"  # folder by default; `newton` would hide the package of that name
DIGEST_LENGTH = 16  # hexadecimal digits
TEMPERATURE = "temperature"  # the last of the numbers
OWN = resources.files("strainwave.export.newton")
TARGETS_BY_UNIT = {
    "rad": "position",
    "rad/s": "speed",
}  # target of a joint by the unit of the command; feedforward for other units
FIRST_STATE = 5  # numbers of a gear before those of its state, as in actuator.hpp
CUDA_ARCHITECTURE = "compute_75"  # virtual, of Turing and later; a driver compiles it for its GPU
MAX_REMEMBERED_TEXTS = 8  # texts of PTX, of some MB each


@stating_origins
def newton(
    drive: Drive | GearSet,
    *,
    scalar: Scalar = "double",
    command: Command | None = None,
    step: float | None = None,
    draws: int = 0,
    seed: int = 0,
    gpu: bool = True,
    compare: bool = True,
) -> Exported:
    """Return a drive as an actuator of Newton: a Python package that needs newton and warp-lang, and not strainwave.

    The joint is the output shaft: Newton moves it, and the actuator acts on it by the torque of the gear. Controller, motor,
    sensors and gear are stepped by the code that `sw.simulate` runs. The load of the drive is left out, as it is in the model
    of the robot.

    Args:
        drive: a drive, or a gear set with one
        scalar: type of the numbers: "double", or "float" for GPUs that are slow with doubles
        command: while the target speed is 0: "held" from call to call, as a staircase, or "followed": it moves in a line; by
            default followed if it is an angle or a speed
        step: largest internal step [s]; by default 0.2 ms, or shorter where the drive needs that
        draws: number of gears that are drawn from what is known of the numbers of a gear set, for domain randomisation
        seed: of the draw
        gpu: include code for GPUs, if the package nvidia-cuda-nvrtc is installed; to compile it takes 10 to 30 s
        compare: state the difference to `sw.simulate`, if newton and warp-lang are installed

    Returns:
        The files of the package by their path, and the difference to `sw.simulate` if it could be computed.

    Raises:
        TypeError, ValueError: an argument is not of its kind, or no step follows the bristles of the drive
        CompileError: the code does not compile for a GPU

    >>> import strainwave as sw
    >>> found = sw.export.newton(sw.GearSet.read("robot-joint"), compare=False)  # doctest: +SKIP
    >>> sorted(found.files)  # doctest: +SKIP
    ['README.md', '__init__.py', 'drive.hpp', 'drive.json', 'drive.ptx']
    """
    model, drive = drive, drive_of(drive)
    arguments.one_of("scalar", scalar, SCALARS)
    drawn = _draws(model, arguments.whole("draws", draws, 1), seed) if draws else {}
    drive = drive.replace(load=loads.Prescribed(), meter=meter.NoMeter())
    step = internal_step(drive, step)
    shown = sorted(signals.outputs(drive).values(), key=lambda each: each.channel)
    about = {
        "made_by": f"strainwave {version('strainwave')}",
        "scalar": scalar,
        "step": step,
        "memory": FIRST_STATE + len(_core.state(drive)[0]),
        "command": TARGETS_BY_UNIT.get(signals.command_unit(drive), "feedforward"),
        "command_unit": signals.command_unit(drive),
        "outputs": {each.name: each.unit for each in shown},
        "parameters": dict(_parameters(drive)),
    }
    mode = command_mode(drive, command)
    text = _source(drive, scalar, signals.command_unit(drive), len(shown), mode == "followed")
    files: dict[str, str | bytes] = {
        "__init__.py": OWN.joinpath("runtime.py").read_text("utf-8"),
        "drive.hpp": text,
        "drive.json": json.dumps(about, indent=1) + "\n",
        "README.md": _readme(about),
    }
    if gpu and nvrtc.is_installed():
        files["drive.ptx"] = ptx(text)
    if drawn:
        files["draws.json"] = json.dumps({path: values.tolist() for path, values in drawn.items()}) + "\n"
    installed = all(find_spec(each) for each in ("newton", "warp"))
    losses = difference_to_simulation(drive, files, about) if compare and installed else ()
    return Exported(
        f"actuator of Newton, numbers of type {scalar}",
        model.name if isinstance(model, GearSet) else "drive",
        files,
        {"internal_step": (step, "s")},
        tuple(losses),
        ("the load of the drive, and what it measures of energies: the joint and its link are the load",),
        tuple(_remarks(about, mode, files, installed)),
    )


def _remarks(about: dict[str, Any], mode: Command, files: dict[str, str | bytes], installed: bool) -> Iterator[str]:
    target = {"position": "joint_target_q, with joint_target_qd as its rate", "speed": "joint_target_qd"}
    yield f"the command [{about['command_unit']}] is {target.get(about['command'], 'joint_act')}; without a rate it is {mode}"
    yield f"{len(about['parameters'])} numbers, each settable for each gear; {len(about['outputs'])} outputs"
    yield f"drive.ptx: for GPUs, {len(files['drive.ptx']) / 1e6:.1f} MB" if "drive.ptx" in files else "for CPUs only"
    if not installed:
        yield "not compared with the simulation: newton and warp-lang are not installed"


def _parameters(drive: Drive) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield each number of a drive by its path, and the temperature; a bound is None if it is infinite."""
    numbers = [*_core.parameters(drive), (TEMPERATURE, ROOM_TEMPERATURE, "K", "Temperature around the drive", 1.0, np.inf)]
    for path, value, unit, _, low, high in numbers:
        bounds = {key: bound if np.isfinite(bound) else None for key, bound in (("low", low), ("high", high))}
        yield path, {"value": value, "unit": unit, **bounds}


def _draws(model: Drive | GearSet, members: int, seed: int) -> dict[str, Array]:
    if not isinstance(model, GearSet):
        raise TypeError("draws needs a gear set, which states how sure its numbers are; a drive alone does not")
    return {path: values for path, values in drawn_gears(model, members, seed).items() if not path.startswith("load.")}


def difference_to_simulation(drive: Drive, files: dict[str, str | bytes], about: dict[str, Any]) -> list[ExportLoss]:
    """Return what an actuator loses against `sw.simulate` while its joint follows a sine, in some of its outputs."""
    size = COMMAND_SIZES.get(about["command_unit"], OTHER_COMMAND)
    duration = round(COMPARED_DURATION / about["step"]) * about["step"]
    begin = round(COMPARED_BEGIN / about["step"]) * about["step"]
    command = scenario.table([0.0, begin, duration], [0.0, 0.0, size])
    # Both begin at rest, so that controller and motor have nothing to do at once.
    joint = scenario.sine(COMPARED_AMPLITUDE, COMPARED_FREQUENCY, duration, phase=-0.5 * np.pi, offset=COMPARED_AMPLITUDE)
    run = reference_run(drive, command, joint, about["step"])
    with TemporaryDirectory() as folder:
        for path, content in files.items():
            Path(folder, path).write_bytes(content if isinstance(content, bytes) else content.encode())
        found = followed(loaded(Path(folder)), run, command, about)
    over = f"a joint that follows a sine of {COMPARED_AMPLITUDE:g} rad and {COMPARED_FREQUENCY:g} Hz, {COMPARED_DURATION:g} s"
    losses = []
    for name in COMPARED:
        if name in found and run[name].any():
            losses.append(
                ExportLoss.between(name, found[name] - run[name], run.unit(name), float(np.abs(run[name]).max()), over)
            )
    return losses


def reference_run(drive: Drive, command: Scenario, joint: Scenario, step: float) -> Run:
    """Return the run of a drive under a command while its output shaft moves as a joint, from rest at the angle 0."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return simulate(drive, command, step, inputs={"output_angle": joint}, initial=drive.rest())


def loaded(folder: Path) -> Any:
    """Return an exported package, imported from its folder."""
    digest = sha256((folder / "drive.hpp").read_bytes()).hexdigest()[:DIGEST_LENGTH]  # Warp has one module of a name
    specification = importlib.util.spec_from_file_location(f"{PACKAGE}_{digest}", folder / "__init__.py")
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    sys.modules[specification.name] = module  # Warp looks the module up
    try:
        specification.loader.exec_module(module)
    finally:
        del sys.modules[specification.name]
    return module


def followed(
    package: Any, run: Run, command: Scenario, about: dict[str, Any], device: str = "cpu", count: int = 1
) -> dict[str, Array]:
    """Return the outputs of the first of `count` actuators whose joints follow the output of a run, under its command."""
    import warp as wp

    wp.config.log_level = wp.LOG_WARNING
    from newton.actuators import Actuator

    actuator = Actuator(indices=wp.array(np.arange(count), dtype=wp.uint32, device=device), drive=package.DriveStrainWave())
    state, control = actuator.sim_state(), actuator.sim_control()
    joint = [wp.zeros(count, dtype=wp.float32, device=device) for _ in range(6)]
    state.joint_q, state.joint_qd, control.joint_target_q, control.joint_target_qd, control.joint_act, control.joint_f = joint
    here, there = actuator.state(), actuator.state()
    values = {"position": ((2, command.value), (3, command.rate)), "speed": ((3, command.value),)}
    given = [(0, run["output_angle"]), (1, run["output_speed"])]
    given += [(i, of(run["time"])) for i, of in values.get(about["command"], ((4, command.value),))]
    rows = []
    for instant in range(len(run)):
        for i, signal in given:
            joint[i].fill_(float(signal[instant]))
        actuator.step(state, control, here, there, dt=about["step"])
        here, there = there, here
        rows.append(here.drive_state.outputs.numpy()[:, 0].astype(np.float64))
    return dict(zip(package.OUTPUTS, np.array(rows).T, strict=True))


def _readme(about: dict[str, Any]) -> str:
    """Return how to use the package."""
    unit = about["command_unit"]
    command = {
        "position": f"`control.joint_target_q` [{unit}], with `control.joint_target_qd` as its rate",
        "speed": f"`control.joint_target_qd` [{unit}]",
    }.get(about["command"], f"`control.joint_act` [{unit}]")
    return f"""# Drive for Newton

A drive with strain wave gear as an actuator of Newton, written by {about["made_by"]}. It needs `newton` and `warp-lang`.

```python
import newton
from {PACKAGE} import DriveStrainWave

builder.add_actuator(DriveStrainWave, index=dof)
```

The command is {command}. The joint is the output shaft of the gear. The actuator adds the torque of the gear
to `control.joint_f`.

Numbers that `PARAMETERS` lists can differ from gear to gear: `builder.add_actuator(DriveStrainWave, index=dof,
**{{"gear.damping": 20.0}})`, or `drive.set({{"gear.damping": values}})` between episodes. `state.drive_state.outputs` has a row
for each name in `OUTPUTS`.
"""


NEWTON = Form(
    newton, "Newton: thousands of joints, CPU or GPU", "a Python package that needs Newton and Warp only", "newton.md", PACKAGE
)


def _source(drive: Drive, scalar: str, command: str, outputs: int, follows: bool) -> str:
    """Return the code of an actuator as one text that includes nothing.

    Args:
        drive: whose load prescribes the motion of the output
        scalar: "float" or "double"
        command: unit of its command
        outputs: number of outputs
        follows: whether a command without a rate moves in a line from call to call; else it is held
    """
    texts = {"drive.hpp": _drive_header(drive, scalar, command, outputs, follows)}
    return cplusplus.amalgamated(["actuator.hpp"], texts | {"actuator.hpp": OWN.joinpath("actuator.hpp").read_text("utf-8")})


def _drive_header(drive: Drive, scalar: str, command: str, outputs: int, follows: bool) -> str:
    """Return the header with the static type of a drive."""
    laws, shape, _ = _core.parts(drive)
    includes = "".join(f"#include <{each}>\n" for each in cplusplus.headers_of(drive))
    return f"""// {in_words(drive)}
#pragma once
{includes}
namespace actuator {{

using S = {scalar};

template <class S>
using Drive = {static_type(drive)};

inline constexpr int laws[] = {{{", ".join(map(str, [*laws, 0]))}}};    // one more than there are,
inline constexpr int shape[] = {{{", ".join(map(str, [*shape, 0]))}}};  // so that none is empty
inline constexpr int parameter_count = {len(_core.parameters(drive))}, output_count = {outputs};

enum class CommandIs {{ position, speed, feedforward }};
inline constexpr CommandIs command_is = CommandIs::{TARGETS_BY_UNIT.get(command, "feedforward")};
inline constexpr bool is_followed = {str(follows).lower()};

}}  // namespace actuator
"""


@lru_cache(maxsize=MAX_REMEMBERED_TEXTS)
def ptx(text: str, *options: str) -> str:
    """Return the PTX of an actuator.

    Args:
        text: source of the actuator
        options: of NVRTC, further ones

    Raises:
        CompileError: NVRTC reports an error
    """
    kernels = cplusplus.INCLUDING.sub("", OWN.joinpath("cuda.hpp").read_text("utf-8")).replace("#pragma once\n", "")
    return nvrtc.compiled(text + kernels, f"--gpu-architecture={CUDA_ARCHITECTURE}", *options)[0]
