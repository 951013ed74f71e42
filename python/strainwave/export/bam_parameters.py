"""Parameters of BAM (better actuator models, DuclusaudPassault2024), written and read: friction of a joint at its output."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear, arguments, friction, kinematics, motor
from strainwave.export.elements import GearElements, friction_losses
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.joint_numbers import left_out_if_rigid
from strainwave.files.budget import read_text
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.files.labels import read_by_others
from strainwave.messages import listed, one_line, quoted
from strainwave.tuning.cascade import torque_constant

Array = NDArray[np.float64]

MAX_BYTES = 1 << 20  # of a parameter file
MAX_REASON_LENGTH = 120  # characters of the reason of the reader of JSON
DEFAULT_ACTUATOR = "erob80_100"  # of BAM, a strain wave gear of 100 behind a current loop
STRIBECK_EXPONENT = 2.0  # of the laws of this package; other ones are refused
LOAD_TERMS = "load_friction_"  # how the names of friction that grows with the load begin


@stating_origins
def bam(
    drive: GearSet | Drive | Gear | str | Path, *, actuator: str = DEFAULT_ACTUATOR, max_torque: float | None = None
) -> Exported:
    """Return the parameter file of BAM for a joint, with the loss in the friction.

    Model M2 is exact for a Stribeck or LuGre friction of the input in steady motion, M1 for a Coulomb friction.

    Args:
        drive: a drive or a set of one, with a motor that has a torque constant, or the name or path of a file
        actuator: a name that BAM has; it determines the control law there
        max_torque: largest torque at the output [N.m]; by default the peak torque of the ratings

    Returns:
        The file `bam.json`, its numbers with their units, the loss in the friction, and the laws left out.

    Raises:
        ValueError: the motor is not known, or takes a torque

    >>> import strainwave as sw
    >>> found = sw.export.bam("robot-joint")
    >>> value, unit = found.numbers["friction_base"]
    >>> list(found.files), round(value, 2), unit
    (['bam.json'], 9.0, 'N.m')
    """
    gear_set = gear_set_of(drive)
    elements = GearElements.of_set(gear_set, max_torque)
    constant = None if gear_set.motor is None else torque_constant(gear_set.motor)
    if constant is None:
        raise ValueError(
            f"{gear_set.name} has no motor with a torque constant, which BAM needs; add a [motor] to the file, or give --motor"
        )
    ratio, law, shaft = abs(elements.ratio), gear_set.gear.friction_input, elements.at_input
    numbers: dict[str, tuple[float, str]] = {
        "kt": (constant * ratio, "N.m/A"),
        "armature": (elements.input_inertia * ratio**2, "kg.m2"),
    }
    if resistance := getattr(gear_set.motor, "resistance", 0.0):
        numbers["R"] = float(resistance), "ohm"
    falls = law if isinstance(law, friction.Stribeck | friction.LuGre) else None
    dry, viscous = (shaft.dry, shaft.viscous) if falls is None else (float(falls.coulomb), float(falls.viscous))
    numbers["friction_base"] = dry * ratio + elements.at_output.dry, "N.m"
    if falls is not None:
        numbers["friction_stribeck"] = (float(falls.breakaway) - float(falls.coulomb)) * ratio, "N.m"
        numbers["dtheta_stribeck"] = float(falls.stribeck_speed) / ratio, "rad/s"
        numbers["alpha"] = STRIBECK_EXPONENT, "1"
    numbers["friction_viscous"] = viscous * ratio**2 + elements.at_output.viscous, "N.m.s/rad"
    values = {name: value for name, (value, _) in numbers.items()}

    def at_input(speed: Array) -> Array:
        return friction_of(values, speed / elements.ratio) / elements.ratio

    content = values | {"model": "m1" if falls is None else "m2", "actuator": actuator}
    return Exported(
        "bam",
        gear_set.name,
        {"bam.json": json.dumps(content, indent=2) + "\n"},
        numbers,
        tuple(friction_losses(gear_set.gear, elements.max_speed, at_input)),
        (*elements.left_out, *left_out_if_rigid(elements)),
        (f"load it by bam.model.load_model; its actuator, {actuator}, has the control law",),
    )


def friction_of(numbers: Mapping[str, float], speed: Array) -> Array:
    """Return the friction of models M1 and M2 of BAM [N.m], shape as the speed of the output [rad/s]."""
    dry = numbers["friction_base"] * np.ones_like(speed)
    if "friction_stribeck" in numbers:
        dry = dry + numbers["friction_stribeck"] * np.exp(-(np.abs(speed / numbers["dtheta_stribeck"]) ** numbers["alpha"]))
    torque: Array = dry * np.sign(speed) + numbers["friction_viscous"] * speed
    return torque


def _reason(error: Exception) -> str:
    """Return why a content is not that of a parameter file."""
    if isinstance(error, KeyError):
        return f"it has no {quoted(str(error.args[0]))}"
    return str(error)[:MAX_REASON_LENGTH]


def read_bam(path: str | Path, ratio: float) -> GearSet:
    """Return gear and motor of a parameter file of BAM.

    Args:
        path: of the file
        ratio: of the gear, which BAM does not state [1]

    Returns:
        The set, in SI units, with friction and inertia at the input; its `note` names what was left out.

    Raises:
        ValueError: the file cannot be read, is no parameter file, or has friction that the laws of this package do not have

    >>> import pathlib, tempfile
    >>> import strainwave as sw
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "joint.json")
    ...     _ = path.write_text(sw.export.bam(sw.GearSet.read("robot-joint")).files["bam.json"])
    ...     joint = sw.export.read_bam(path, ratio=100.0)
    >>> joint.name, round(joint.gear.friction_input.coulomb, 4)  # N.m at the input
    ('joint', 0.09)
    """
    path, ratio = Path(path), abs(arguments.ratio("ratio", ratio))
    with read_by_others(path, "JSON"):
        text = read_text(path, MAX_BYTES)
    try:
        content = json.loads(text)
        if not isinstance(content, dict):
            raise ValueError("it contains no names with values")
        names = {name: float(content[name]) for name in content if name not in ("model", "actuator")}
        dry, viscous = names["friction_base"] / ratio, names["friction_viscous"] / ratio**2
        inertia, constant = names["armature"] / ratio**2, names["kt"] / ratio
        resistance = names.get("R", 0.0)
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise ValueError(one_line(f"{path} is no parameter file of BAM: {_reason(error)}")) from None
    loads = [name for name, value in names.items() if name.startswith(LOAD_TERMS) and value]
    law: Any = friction.Coulomb(coulomb=dry, viscous=viscous)
    if names.get("friction_stribeck"):
        law = friction.Stribeck(
            coulomb=dry,
            breakaway=dry + names["friction_stribeck"] / ratio,
            stribeck_speed=names["dtheta_stribeck"] * ratio,
            viscous=viscous,
        )
    note = f"read from {path.name} of BAM"
    if loads:
        note += f"; left out: {listed(loads)}, whose friction grows with the load"
    if (exponent := names.get("alpha", STRIBECK_EXPONENT)) != STRIBECK_EXPONENT and names.get("friction_stribeck"):
        note += f"; the exponent {exponent:.3g} of its Stribeck curve became {STRIBECK_EXPONENT:g}"
    drive = Drive(
        gear=Gear(
            kinematics=kinematics.PlainRatio(reduction=ratio),
            friction_input=law,
            input_inertia=inertia,
        ),
        motor=motor.DC(resistance=resistance, torque_constant=constant, back_emf=constant, inertia=0.0)
        if resistance
        else motor.CurrentSource(torque_constant=constant, inertia=0.0),
    )
    return replace(GearSet.of(drive, name=path.stem, source=f"BAM, {path.name}"), note=note)


BAM = Form(bam, "BAM", "its parameter file; `from-bam` reads one", "mujoco.md#bam-both-ways")
