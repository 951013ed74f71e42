"""Numbers of a joint for simulators that have no gear: MuJoCo, URDF, Isaac Lab, Genesis."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear
from strainwave.export.elements import GearElements, ShaftFriction, friction_losses, remark_on_rotor, twist_at_largest
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.mujoco import friction_attributes
from strainwave.export.robot import DEFAULT_TIMESTEP
from strainwave.files.gear_set import GearSet, gear_set_of

Array = NDArray[np.float64]

SIGNIFICANT_DIGITS = 12  # of exported numbers: without the last digits of products, as in 3.4919999999999995


@stating_origins
def joint(drive: GearSet | Drive | Gear | str | Path, *, max_torque: float | None = None, name: str = "gear") -> Exported:
    """Return the numbers of a rigid joint for MuJoCo, URDF, Isaac Lab and Genesis.

    Numbers: `armature`, inertia of the input at the output; `frictionloss` and `damping`, dry and viscous friction of the whole
    gear at the output; `breakaway`, the largest dry friction at rest; `stiffness` and `stiffness_damping` of the gear, for a
    joint with a spring between motor and link.

    Args:
        drive: a gear, a drive or a set of one, or the name or path of a file
        max_torque: largest torque at the output [N.m]; by default the peak torque of the ratings
        name: of the default class and of the robot

    Returns:
        The numbers with their units, the files `joint.xml`, `joint.urdf` and `joint.py`, and the laws left out.

    Raises:
        ValueError: neither a torque nor a rating is given

    >>> import strainwave as sw
    >>> found = joint("csg-20-100")
    >>> round(found.numbers["frictionloss"][0], 3), sorted(found.files)
    (4.611, ['joint.py', 'joint.urdf', 'joint.xml'])
    """
    gear_set = gear_set_of(drive)
    elements = GearElements.of_set(gear_set, max_torque)
    numbers = _numbers(elements, gear_set.gear)
    values = {key: repr(value) for key, (value, _) in numbers.items()}

    def friction(speed: Array) -> Array:
        torque = numbers["frictionloss"][0] * np.sign(speed) + numbers["damping"][0] * speed / abs(elements.ratio)
        found: Array = torque / abs(elements.ratio)
        return found

    losses = tuple(friction_losses(gear_set.gear, elements.max_speed, friction))
    left_out = (*elements.left_out, *left_out_if_rigid(elements))
    files = {
        "joint.xml": _mujoco_default(numbers, name),
        "joint.urdf": _urdf(values, elements, name),
        "joint.py": _python(values, [*(f"{each.quantity}: {each.rms:.3g} {each.unit} RMS" for each in losses), *left_out]),
    }
    return Exported(
        "joint",
        gear_set.name,
        files,
        numbers,
        losses,
        left_out,
        (
            "give the joint of your model the class of joint.xml, or all attributes in it: without solimpfriction and "
            "solreffriction it creeps at a torque below its friction",
            "do not copy the stiffness into <joint>: MuJoCo would tie the link to the world. For torsion use `strainwave "
            "export mjcf`",
            *remark_on_rotor(gear_set, ", times the ratio squared"),
        ),
    )


def left_out_if_rigid(elements: GearElements) -> Iterator[str]:
    """Yield what of the torsion a rigid joint leaves out."""
    yield f"torsion: {1e3 * twist_at_largest(elements):.3g} mrad at {elements.max_torque:.4g} N.m"


def _numbers(elements: GearElements, gear: Gear) -> dict[str, tuple[float, str]]:
    ratio = abs(elements.ratio)
    bristle = elements.at_input.bristle
    dry = elements.at_input.dry + (0.0 if bristle is None else float(bristle.coulomb))
    at_rest = _breakaway(gear.friction_input) * ratio + _breakaway(gear.friction_mesh) + _breakaway(gear.friction_output)
    numbers = {
        "armature": (elements.input_inertia * ratio**2, "kg.m2"),
        "frictionloss": (dry * ratio + elements.at_output.dry, "N.m"),
        "breakaway": (max(at_rest, dry * ratio + elements.at_output.dry), "N.m"),
        "damping": (elements.at_input.viscous * ratio**2 + elements.at_output.viscous, "N.m.s/rad"),
        "stiffness": (elements.max_torque / twist_at_largest(elements), "N.m/rad"),
        "stiffness_damping": (elements.damping, "N.m.s/rad"),
    }
    return {key: (float(f"{value:.{SIGNIFICANT_DIGITS}g}"), unit) for key, (value, unit) in numbers.items()}


def _breakaway(law: Any) -> float:
    """Return the largest friction of a shaft at rest [N.m]."""
    return float(law.hold()) if law.set_valued else float(getattr(law, "breakaway", 0.0))


def _python(values: Mapping[str, str], losses: Sequence[str]) -> str:
    """Return a module with the numbers as arguments of Isaac Lab and Genesis."""
    lost = "".join(f"    * {each}\n" for each in losses)
    return f'''"""Numbers of a joint with a strain wave gear, at its output, in SI units.

A rigid joint loses, against the gear:

{lost}"""

# Isaac Lab: ImplicitActuatorCfg(joint_names_expr=["elbow"], stiffness=..., damping=..., **ISAAC_LAB). `damping` and `stiffness`
# are gains of the controller there. Frictions are torques from Isaac Sim 5.0 on. Isaac Sim 4.5 takes `friction` as a
# coefficient, and ignores the other two: leave it out.
ISAAC_LAB = {{
    "armature": {values["armature"]},  # kg.m2
    "friction": {values["breakaway"]},  # N.m, at rest
    "dynamic_friction": {values["frictionloss"]},  # N.m, in motion
    "viscous_friction": {values["damping"]},  # N.m.s/rad
}}


def set_in_genesis(robot, dofs):
    """Give these degrees of freedom of a built entity of Genesis the numbers of the joint."""
    robot.set_dofs_armature([{values["armature"]}] * len(dofs), dofs)
    robot.set_dofs_frictionloss([{values["frictionloss"]}] * len(dofs), dofs)
    robot.set_dofs_damping([{values["damping"]}] * len(dofs), dofs)
'''


def _mujoco_default(numbers: Mapping[str, tuple[float, str]], name: str) -> str:
    """Return a default class of MJCF."""
    armature, dry, viscous = (numbers[key][0] for key in ("armature", "frictionloss", "damping"))
    friction = friction_attributes(ShaftFriction(dry=dry, viscous=viscous), DEFAULT_TIMESTEP)
    attributes = " ".join(f'{key}="{value}"' for key, value in {"armature": repr(armature), **friction}.items())
    return (
        f"<mujoco>\n  <default>\n    <default class={quoteattr(name)}>\n      <joint {attributes}/>\n    </default>\n"
        "  </default>\n</mujoco>\n"
    )


def _urdf(values: Mapping[str, str], elements: GearElements, name: str) -> str:
    """Return a robot of two links with one joint in URDF."""
    return f"""<?xml version="1.0"?>
<!-- Put limit and dynamics into the joint of your robot, and the name of that joint into the transmission. -->
<robot name={quoteattr(name)}>
  <link name="base"/>
  <link name="output"/>
  <joint name="joint" type="continuous">
    <parent link="base"/>
    <child link="output"/>
    <axis xyz="0 0 1"/>
    <limit effort="{elements.max_torque!r}" velocity="{elements.max_speed / abs(elements.ratio)!r}"/>
    <dynamics damping="{values["damping"]}" friction="{values["frictionloss"]}"/>
  </joint>
  <transmission name="joint_transmission">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="joint"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
    <actuator name="motor">
      <mechanicalReduction>{elements.ratio!r}</mechanicalReduction>
    </actuator>
  </transmission>
</robot>
"""


JOINT = Form(
    joint, "MuJoCo, Isaac Lab, Genesis, a URDF: numbers of a joint", "`joint.xml`, `joint.urdf`, `joint.py`", "mujoco.md"
)
