"""A gear as MJCF: a model of MuJoCo without a plugin, alone or attached to a joint of a robot.

The rotor is a joint of its own, at the ratio. The twist of the gear is a tendon of both joints: springs with a gap and springs
that yield are its elastic elements, so that the hysteresis of Maxwell slip elements is exact. A LuGre friction is that of a
`dcmotor`. What MuJoCo has no element for is stated in `left_out`.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from strainwave import Drive, Gear, arguments, loads, motor
from strainwave.export.elements import GearElements, ShaftFriction, Spring, remark_on_rotor
from strainwave.export.exported import Exported, Form, stating_origins
from strainwave.export.robot import Element, Robot, Twist, child, gears_of_joints, kept, written
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.messages import listed
from strainwave.tuning.compensate import MAX_MEMBERS
from strainwave.tuning.drawn import drawn_gears
from strainwave.tuning.loss import ExportLoss

Part = tuple[GearSet, GearElements, list[str]]  # a gear, its elements, and remarks on what it changes in the robot

ROTOR_MASS = 1e-6  # kg: MuJoCo refuses a body that moves without one
ROTOR_INERTIA = 1e-9  # kg.m², at least, across the axis
TIMESTEP_ALONE = 5e-4  # s, of a model that has the gear and an inertia only
STIFF_FRICTION = "0.9999 0.9999 0.001 0.5 2"  # impedance of dry friction: by default MuJoCo gives 5 to 10 % of it away
RANDOMISED_ATTRIBUTES = (  # that drawn gears differ in
    *("armature", "frictionloss", "damping", "stiffness", "springlength", "springyield"),
    *("resistance", "motorconst", "inductance", "cogging", "lugre", "gear"),
)
PLACING_ATTRIBUTES = ("pos", "quat", "euler", "axisangle", "xyaxes", "zaxis")  # of a body


@stating_origins
def mjcf(
    drive: GearSet | Drive | Gear | str | Path,
    *,
    max_torque: float | None = None,
    load_inertia: float | None = None,
    into: str | Path | None = None,
    joint: str | Mapping[str, GearSet | Drive | Gear | str | Path] | None = None,
    keep: str | None = None,
    draws: int = 0,
    seed: int = 0,
    name: str = "gear",
) -> Exported:
    """Return a gear as MJCF, alone with an inertia or behind joints of a robot, with its losses.

    Args:
        drive: a gear, a drive or a set of one, or the name or path of a file
        max_torque: at the output, up to which the torsion is fitted [N.m]; by default the peak torque of the ratings
        load_inertia: at the output about its axis [kg.m²]; by default that of the load
        into: MJCF file of a robot, or its text; a model with an inertia alone if not given
        joint: name of a hinge of the robot, which becomes the output; several as "hip,knee"; one with another gear as
            "knee=mine.toml"; "all" for all hinges that are not listed. In Python also a gear for each name
        keep: what the joint keeps of its own damping, frictionloss and armature besides the gear's, as "damping,armature"
        draws: number of gears that are drawn from what is known of the numbers, for domain randomisation
        seed: of the draw
        name: of the gear, and prefix of joints, tendons and actuators

    Returns:
        The text of the MJCF file, the losses of each law and of a run, and the laws left out.

    Raises:
        ValueError: neither a torque nor a rating is given, there is no inertia, the robot has no such hinge, or gears are
            drawn for several joints

    >>> import strainwave as sw
    >>> found = mjcf("csg-20-100", load_inertia=1.2)
    >>> [loss.quantity for loss in found.losses if loss.rms_share > 1e-9]
    ['transmission error of a run', 'motor torque of a run']
    >>> found.left_out[0].split(";")[0]
    'kinematic error: 58.2 urad at the output'
    """
    gear_set = gear_set_of(drive)
    if (into is None) != (joint is None):
        raise ValueError("into and joint belong together: the file of a robot, and the name of one of its hinges")
    if into is not None and joint is not None:
        text, exports = _in_robot(into, joint, gear_set, max_torque, name, kept(keep))
    else:
        elements = GearElements.of_set(gear_set, max_torque)
        exports = {"": (gear_set, elements, [])}
        text = _alone(elements, gear_set.motor, _inertia(gear_set, load_inertia), name)
    files: dict[str, str | bytes] = {"gear.xml": text}
    if draws and len(exports) > 1:
        raise ValueError(f"draws = {draws} are made for one joint; {listed(exports)} have gears")
    if draws:
        ((own, elements, _),) = exports.values()
        files["randomisation.json"] = _randomisation(own, elements, arguments.whole("draws", draws, 2, MAX_MEMBERS), seed, name)
    losses, left_out, remarks = _of_all(exports)
    remarks += ("dry friction is a constraint in MuJoCo, of first order in its timestep: halve it and compare",)
    names = listed(dict.fromkeys(each.name for each, _, _ in exports.values()))
    return Exported("mjcf", names, files, {}, losses, left_out, remarks)


def _in_robot(
    into: str | Path,
    joint: str | Mapping[str, GearSet | Drive | Gear | str | Path],
    gear_set: GearSet,
    max_torque: float | None,
    name: str,
    keep: Collection[str],
) -> tuple[str, dict[str, Part]]:
    """Return a robot with gears as text, and the gear of each joint. The arguments are those of `mjcf`."""
    robot = Robot.of(into)
    gears = gears_of_joints(robot, joint, gear_set)
    known = {id(each): GearElements.of_set(each, max_torque) for each in gears.values()}
    names = {shaft: name if len(gears) == 1 else f"{shaft}_{name}" for shaft in gears}

    def attached(model: Robot) -> dict[str, Part]:
        return {
            shaft: (each, known[id(each)], attach(model, shaft, known[id(each)], each.motor, name=names[shaft], keep=keep))
            for shaft, each in gears.items()
        }

    twists = [
        Twist(f"{names[shaft]}_input", shaft, each.ratio, stiffness_at_rest(each), each.damping)
        for shaft, (_, each, _) in attached(robot).items()
    ]
    robot, remarks = Robot.stable(into, robot.longest_timestep(twists))
    exports = attached(robot)
    next(iter(exports.values()))[2].extend(remarks)
    return written(robot.root), exports


def _of_all(exports: Mapping[str, Part]) -> tuple[tuple[ExportLoss, ...], tuple[str, ...], tuple[str, ...]]:
    """Return losses, laws left out and remarks of gears, each with the name of its joint if there are several."""
    losses, left_out, remarks = list[ExportLoss](), list[str](), list[str]()
    known = dict[int, tuple[ExportLoss, ...]]()
    for joint, (gear_set, elements, own_remarks) in exports.items():
        prefix = f"{joint}: " if len(exports) > 1 else ""
        found = known.setdefault(id(gear_set), ()) or elements.losses(gear_set.gear)
        known[id(gear_set)] = found
        losses += [replace(each, quantity=prefix + each.quantity) for each in found]
        lost = (*_left_out_of_motor(gear_set.motor), *_left_out_of_load(gear_set.load, alone=not joint))
        left_out += [prefix + each for each in (*elements.left_out, *lost)]
        remarks += [prefix + each for each in (*own_remarks, *remark_on_rotor(gear_set))]
    return tuple(losses), tuple(left_out), tuple(remarks)


def _left_out_of_motor(part: Any) -> Iterator[str]:
    """Yield what of a motor has no element."""
    if isinstance(part, motor.DC):
        if part.brush_drop:
            yield f"voltage of the brushes: {float(part.brush_drop):.3g} V"
        if part.resistance_rise:
            yield "rise of the resistance with temperature"
    elif part is not None and not isinstance(part, motor.CurrentSource | motor.TorqueSource):
        yield f"the motor {part.name}: the actuator is a torque at the input"


def _left_out_of_load(part: Any, *, alone: bool) -> Iterator[str]:
    """Yield the numbers of a load that the model does not have; alone, it has the inertia."""
    fields = () if part is None else part.fields
    values = {field["name"]: (getattr(part, field["name"]), field["unit"]) for field in fields if field["kind"] == "number"}
    carried = {"inertia"} if alone else set()
    lost = [f"{name} {value:.5g} {unit}" for name, (value, unit) in values.items() if value and name not in carried]
    if lost:
        where = "build it of bodies" if alone else "the bodies of the robot take its place"
        yield f"load: {listed(lost)}; {where}"


def _inertia(gear_set: GearSet, given: float | None) -> float:
    if given is not None:
        return arguments.number("load_inertia", given, "kg.m2", low=0.0)
    inertia = getattr(gear_set.load, "inertia", None)
    if not inertia:
        raise ValueError(
            f"{gear_set.name} has no load with an inertia; give --load-inertia, in Python load_inertia, in kg.m2, or a "
            "robot and its joint"
        )
    return float(inertia)


def _randomisation(gear_set: GearSet, elements: GearElements, draws: int, seed: int, name: str) -> str:
    """Return the numbers of the gear's joints, tendons and actuators for drawn gears, and their intervals of 95 %, as JSON."""
    parts = {"motor": gear_set.motor or motor.TorqueSource(inertia=0.0), "load": gear_set.load or loads.Inertia()}
    whole = gear_set.with_parts(source="stated with the export", **parts)
    columns = drawn_gears(whole, draws, seed)
    members = []
    for member in range(draws):
        drive = whole.drive.replace({path: float(values[member]) for path, values in columns.items()})
        rotor = float(getattr(drive.motor, "inertia", 0.0))
        drawn = GearElements.of(drive.gear, rotor, elements.max_torque, elements.max_speed)
        members.append(_numbers(_alone(drawn, drive.motor, 1.0, name)))
    shared = [key for key in members[0] if all(key in each for each in members)]
    ranges = {key: np.quantile([each[key] for each in members], [0.025, 0.975]).tolist() for key in shared}
    return json.dumps({"ranges": ranges, "draws": members}, indent=1) + "\n"


def _numbers(model: str) -> dict[str, float]:
    """Return the numbers of joints, tendons and actuators of a model, by name and attribute."""
    found: dict[str, float] = {}
    for each in ElementTree.fromstring(model).iter():
        if "name" not in each.attrib or each.tag not in ("joint", "fixed", "motor", "dcmotor"):
            continue
        for key, value in each.attrib.items():
            words = value.split()
            if key in RANDOMISED_ATTRIBUTES:
                found |= {f"{each.attrib['name']}.{key}[{place}]": float(word) for place, word in enumerate(words)}
    return found


def _alone(elements: GearElements, actuator: Any, load_inertia: float, name: str) -> str:
    root, link, shaft = inertia_on_a_hinge(load_inertia, TIMESTEP_ALONE, name)
    shaft.attrib.update(friction_attributes(elements.at_output, TIMESTEP_ALONE))
    add_gear(Robot.in_tree(root), link, shaft, elements, actuator, name)
    return written(root)


def inertia_on_a_hinge(inertia: float, timestep: float, name: str) -> tuple[Element, Element, Element]:
    """Return a model of one body that turns about an axis: its root, the body and its joint.

    Args:
        inertia: of the body [kg.m²]
        timestep: of the model [s]
        name: of the gear
    """
    root = Element("mujoco", model=name)
    ElementTree.SubElement(root, "compiler", angle="radian")
    ElementTree.SubElement(root, "option", timestep=repr(timestep), integrator="implicitfast", gravity="0 0 0")
    link = ElementTree.SubElement(ElementTree.SubElement(root, "worldbody"), "body", name=f"{name}_link")
    spread = " ".join([repr(inertia)] * 3)
    ElementTree.SubElement(link, "inertial", pos="0 0 0", mass="1", diaginertia=spread)
    return root, link, ElementTree.SubElement(link, "joint", {"name": f"{name}_output", "type": "hinge", "axis": "0 0 1"})


def attach(
    robot: Robot, joint: str, elements: GearElements, actuator: Any, *, name: str = "gear", keep: Collection[str] = ()
) -> list[str]:
    """Put a gear behind a joint of a robot, and return remarks on what that changes.

    Args:
        robot: its model, which is changed
        joint: name of a hinge in it, which becomes the output of the gear
        elements: of the gear
        actuator: motor of the drive; None for a torque at the input
        name: of the gear
        keep: of damping, frictionloss and armature, what the joint keeps of its own

    Raises:
        ValueError: the joint is not a hinge of the robot with a body of its own
    """
    shaft = robot.hinge(joint)
    remarks = list(robot.replace_friction(shaft, friction_attributes(elements.at_output, robot.timestep), keep))
    link = robot.body_of(shaft)
    before = len(robot.root.findall("actuator/*"))
    rotor = add_gear(robot, link, shaft, elements, actuator, name)
    added = robot.root.findall("actuator/*")[before:]
    return [*remarks, *robot.extended_keyframes(rotor, shaft, elements.ratio, added), *robot.others_on(joint, name)]


def stiffness_at_rest(elements: GearElements) -> float:
    """Return the stiffness of a gear about zero twist, where no element slips [N.m/rad]."""
    springs = (spring.linear for spring in elements.springs if not spring.gap)
    return sum(springs) + sum(stiffness for stiffness, _ in elements.slips)


def add_gear(robot: Robot, link: Element, joint: Element, elements: GearElements, actuator: Any, name: str) -> Element:
    """Add rotor, tendons and actuator of a gear to a model, and return the joint of the rotor.

    Args:
        robot: the model
        link: body that the gear turns
        joint: of the link, a hinge with a name
        elements: of the gear
        actuator: motor of the drive; None for a torque at the input
        name: of the gear
    """
    parent, stated = robot.parents[link], robot.stated(joint)
    place = {key: value for key, value in link.attrib.items() if key in PLACING_ATTRIBUTES}
    body = ElementTree.SubElement(parent, "body", {"name": f"{name}_rotor", **place})
    inertia = " ".join([repr(ROTOR_INERTIA)] * 3)
    ElementTree.SubElement(body, "inertial", pos="0 0 0", mass=repr(ROTOR_MASS), diaginertia=inertia)
    axis = {key: value for key, value in stated.items() if key in ("axis", "pos")}
    start = {"ref": repr(elements.ratio * float(stated["ref"]))} if float(stated.get("ref", 0.0)) else {}
    own = {"armature": repr(elements.input_inertia), **friction_attributes(elements.at_input, robot.timestep)}
    rotor = ElementTree.SubElement(body, "joint", {"name": f"{name}_input", "type": "hinge", **axis, **start, **own})
    robot.parents.update({body: parent, rotor: body})
    robot.neutral(rotor)
    _add_twist(child(robot.root, "tendon"), elements, name, joint.attrib["name"])
    actuators = child(robot.root, "actuator")
    before = len(actuators)
    _add_actuators(actuators, actuator, elements.at_input, name)
    for each in actuators[before:]:
        robot.parents[each] = actuators
        robot.neutral(each)
    return rotor


def friction_attributes(shaft: ShaftFriction, timestep: float) -> dict[str, str]:
    """Return attributes of a joint for its dry and viscous friction."""
    dry = {"frictionloss": repr(shaft.dry), "solreffriction": f"{2.0 * timestep!r} 1", "solimpfriction": STIFF_FRICTION}
    return (dry if shaft.dry > 0.0 else {}) | ({"damping": repr(shaft.viscous)} if shaft.viscous > 0.0 else {})


def _add_twist(tendons: Element, elements: GearElements, name: str, output: str) -> None:
    """Add a tendon for each elastic element of the twist, which is the input angle over the ratio less the output angle."""
    parts: list[dict[str, str]] = [_spring(spring) for spring in elements.springs]
    parts += [{"stiffness": repr(k), "springyield": repr(torque / k)} for k, torque in elements.slips]
    if elements.damping > 0.0:
        parts[0] = {"damping": repr(elements.damping), **parts[0]}
    for number, attributes in enumerate(parts):
        length = attributes if "springlength" in attributes else {"springlength": "0", **attributes}
        tendon = ElementTree.SubElement(tendons, "fixed", {"name": f"{name}_twist_{number}", **length})
        ElementTree.SubElement(tendon, "joint", joint=f"{name}_input", coef=repr(1.0 / elements.ratio))
        ElementTree.SubElement(tendon, "joint", joint=output, coef="-1")


def _spring(spring: Spring) -> dict[str, str]:
    coefficients = [spring.linear, spring.quadratic, spring.cubic]
    while len(coefficients) > 1 and coefficients[-1] == 0.0:
        coefficients.pop()
    found = {"stiffness": " ".join(map(repr, coefficients))}
    return found | ({"springlength": f"{-spring.gap!r} {spring.gap!r}"} if spring.gap else {})


def _add_actuators(actuators: Element, part: Any, at_input: ShaftFriction, name: str) -> None:
    joint = {"joint": f"{name}_input"}
    bristle = {} if at_input.bristle is None else {"lugre": _lugre(at_input)}
    match part:
        case motor.DC():
            attributes = dict(_dc(part))
            ElementTree.SubElement(actuators, "dcmotor", {"name": f"{name}_motor", **joint, **attributes, **bristle})
            return
        case motor.CurrentSource():
            gear = repr(float(part.torque_constant))
            ElementTree.SubElement(actuators, "motor", {"name": f"{name}_motor", **joint, "gear": gear})
        case _:
            ElementTree.SubElement(actuators, "motor", {"name": f"{name}_motor", **joint})
    if bristle:
        passive = {"input": "none", "resistance": "1", "motorconst": "0 0"}
        ElementTree.SubElement(actuators, "dcmotor", {"name": f"{name}_bristle", **joint, **passive, **bristle})


def _dc(part: motor.DC) -> Iterator[tuple[str, str]]:
    yield "resistance", repr(float(part.resistance))
    yield "motorconst", f"{float(part.torque_constant)!r} {float(part.back_emf)!r}"
    if part.inductance > 0.0:
        yield "inductance", f"{float(part.inductance)!r} 0"
    if part.cogging_torque:
        yield "cogging", f"{float(part.cogging_torque)!r} {float(part.cogging_order)!r} 0"


def _lugre(at_input: ShaftFriction) -> str:
    law = at_input.bristle
    assert law is not None
    numbers = (law.bristle_stiffness, law.bristle_damping, law.coulomb, law.breakaway, law.stribeck_speed)
    return " ".join(repr(float(each)) for each in numbers)


MJCF = Form(
    mjcf,
    "MuJoCo or MuJoCo Warp: torsion and hysteresis",
    "a model in XML, alone or in your robot, without a plugin",
    "mujoco.md",
)
