"""The model of a robot in MJCF: its hinges, what their classes give them, and its keyframes.

An element has the attributes of its class where it states none: that of its own, else the `childclass` of the nearest body
around it, else the main class. A gear that is added between two bodies states what it must not have of these.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from strainwave import Drive, Gear
from strainwave.export.coupled import MAX_STABLE_SHARE
from strainwave.files.budget import read_text
from strainwave.files.folder import inside
from strainwave.files.gear_set import GearSet, gear_set_of
from strainwave.files.labels import read_by_others
from strainwave.messages import listed, quoted

Element = ElementTree.Element

DEFAULT_TIMESTEP = 2e-3  # s, of a model that states none
MAX_MODEL_BYTES = 64 << 20  # of a robot's file
MAX_NESTED_ELEMENTS = 500  # each takes a call of Python's writer of XML, which allows 1000
MAX_INCLUDED_FILES = 100
GENERATING = {"replicate", "attach", "composite", "flexcomp"}  # elements of which MuJoCo makes bodies and joints
POSITIONS = {"hinge": 1, "slide": 1, "ball": 4, "free": 7}  # numbers of a joint in qpos
SPEEDS = {"hinge": 1, "slide": 1, "ball": 3, "free": 6}  # in qvel
# What a joint or actuator of a gear must not have of a class of the robot, and the value that turns it off.
# In one default class the actuators of all kinds have the same attributes, whichever element states them.
ACTUATORS = {"general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion", "dcmotor"}
NEUTRAL = {
    "limited": "false", "actuatorfrclimited": "false", "damping": "0", "stiffness": "0", "frictionloss": "0", "armature": "0",
    "springref": "0", "ref": "0", "ctrllimited": "false", "forcelimited": "false", "actlimited": "false",
}  # fmt: skip
IMPLIED = {"range": "limited", "actuatorfrcrange": "actuatorfrclimited", "ctrlrange": "ctrllimited"}
IMPLIED |= {"forcerange": "forcelimited", "actrange": "actlimited"}
REPLACED = ("damping", "frictionloss", "armature")  # of a robot's joint, which a gear has itself


class Twist(NamedTuple):
    """The twist of a gear: its joints, the ratio, stiffness [N.m/rad] and damping [N.m.s/rad]; no rotor if it is no joint."""

    rotor: str
    output: str
    ratio: float
    stiffness: float
    damping: float


@dataclass(frozen=True)
class Robot:
    """Model of a robot, to which gears are added.

    Attributes:
        root: of the model
        parents: of each element
    """

    root: Element
    parents: dict[Element, Element]

    @classmethod
    def of(cls, model: str | Path, timestep: float | None = None) -> Robot:
        """Return the robot of an MJCF file, or of its text, with another timestep [s] if one is given.

        Raises:
            OSError: the file cannot be read
            ValueError: the text is no MJCF, or only MuJoCo can say which joints it has, and MuJoCo is not installed
        """
        is_text = isinstance(model, str) and "<" in model
        root = _whole(_parsed(str(model)), None) if is_text else _read(Path(model))
        if timestep is not None:
            child(root, "option").set("timestep", repr(timestep))
        return cls.in_tree(root)

    @classmethod
    def stable(cls, model: str | Path, longest: float) -> tuple[Robot, list[str]]:
        """Return the robot of a file or text, with a shorter timestep if its own exceeds the longest [s], and a remark."""
        robot = cls.of(model)
        if robot.timestep <= longest:
            return robot, []
        wanted = MAX_STABLE_SHARE * longest
        digit = 10.0 ** np.floor(np.log10(wanted))
        shortened = cls.of(model, timestep=float(f"{np.floor(wanted / digit) * digit:.1g}"))
        return shortened, [
            f"the timestep is {shortened.timestep:g} s, not {robot.timestep:g} s: with this robot the gears are stable up to "
            f"{longest:.2g} s; softer gears or more armature allow more"
        ]

    @classmethod
    def in_tree(cls, root: Element) -> Robot:
        """Return the robot of a parsed model."""
        return cls(root, {child: parent for parent in root.iter() for child in parent})

    @property
    def timestep(self) -> float:
        """Timestep of the model [s]."""
        return timestep_of(self.root)

    def longest_timestep(self, twists: Collection[Twist]) -> float:
        """Return the longest stable timestep of a model with gears [s]; infinite if MuJoCo is missing or refuses the model.

        Semi-implicit steps of a force k x + c v at an inertia J are stable for k dt² + 2 c dt < 4 J. Here 1/J is that of all
        twists together, by the inertia of the whole robot where its joints are 0.
        """
        try:
            import mujoco

            model = mujoco.MjModel.from_xml_string(written(self.root))
        except (ImportError, ValueError):
            return np.inf
        state, inertia = mujoco.MjData(model), np.zeros((model.nv, model.nv))
        mujoco.mj_forward(model, state)
        mujoco.mj_fullM(model, state, inertia)
        rows = np.zeros((len(twists), model.nv))
        for row, each in zip(rows, twists, strict=True):
            row[model.joint(each.output).dofadr[0]] = -1.0
            if each.rotor:
                row[model.joint(each.rotor).dofadr[0]] = 1.0 / each.ratio
        mobility = rows @ np.linalg.solve(inertia, rows.T)
        stiffness, damping = (
            np.linalg.eigvalsh(mobility * np.sqrt(np.outer(values, values))).max()
            for values in ([each.stiffness for each in twists], [each.damping for each in twists])
        )
        return float((np.sqrt(damping**2 + 4.0 * stiffness) - damping) / stiffness)

    def hinges(self) -> Iterator[str]:
        """Yield the names of the hinges of bodies."""
        for each in self._named_joints():
            if self.kind(each) == "hinge":
                yield each.attrib["name"]

    def hinge(self, joint: str) -> Element:
        """Return a hinge of the robot.

        Raises:
            ValueError: the joint is not a hinge with a body of its own
        """
        there = self._named_joints()
        shaft = next((each for each in there if each.get("name") == joint), None)
        if shaft is None:
            names = listed(each.get("name", "") for each in there) or "no joint with a name"
            raise ValueError(f"joint = {quoted(joint)} is not in the model; it has {names}")
        if (kind := self.kind(shaft)) != "hinge":
            raise ValueError(f"joint = {quoted(joint)} is of type {kind}; a gear turns a hinge")
        return shaft

    def _named_joints(self) -> list[Element]:
        return [each for each in self.joints() if each.tag == "joint" and each.get("name")]

    def stated(self, element: Element) -> dict[str, str]:
        """Return the attributes of an element, those of its classes included."""
        return {**self.of_classes(element), **element.attrib}

    def of_classes(self, element: Element) -> dict[str, str]:
        """Return the attributes that an element of this place and tag has of its classes."""
        name, body = element.get("class"), self.parents.get(element)
        while name is None and body is not None:
            name, body = body.get("childclass"), self.parents.get(body)
        found: dict[str, str] = {}
        for default in self._classes(name):
            for stated in default:
                if stated.tag == element.tag or {stated.tag, element.tag} <= ACTUATORS:
                    found |= stated.attrib
        return found

    def _classes(self, name: str | None) -> list[Element]:
        """Return the classes whose attributes count for one of them, the outermost first."""
        main = self.root.findall("default")
        if name is None:
            return main
        for default in main:
            for each in default.iter("default"):
                if each.get("class") == name:
                    chain = [each]
                    while chain[0] is not default:
                        chain.insert(0, self.parents[chain[0]])
                    return chain
        return main

    def neutral(self, element: Element) -> None:
        """State what an element must not have of the classes of its place, unless it states it itself."""
        given = self.of_classes(element)
        unwanted = {IMPLIED.get(name, name) for name in given} & NEUTRAL.keys()
        for name in sorted(unwanted - element.attrib.keys()):
            element.set(name, NEUTRAL[name])

    def replace_friction(self, shaft: Element, own: dict[str, str], keep: Collection[str]) -> Iterator[str]:
        """Give a joint the friction of a gear at its output in place of its own; yield a remark of what is replaced.

        Args:
            shaft: joint of the robot
            own: attributes of the friction at the output of the gear
            keep: those of `REPLACED` that the joint keeps besides
        """
        before = self.stated(shaft)
        for name in REPLACED:
            value = before.get(name, "0")
            if name in keep:
                total = _first(value) + _first(own.get(name, "0"))
                shaft.set(name, repr(total)) if total else None
                continue
            if _first(value):
                yield f"{name} {value} of {shaft.get('name')} is replaced by that of the gear; --keep {name} keeps it besides"
                shaft.set(name, "0")
            if name in own:
                shaft.set(name, own[name])
        shaft.attrib.update({name: value for name, value in own.items() if name not in REPLACED})

    def others_on(self, joint: str, name: str) -> Iterator[str]:
        """Yield a remark on each actuator that acts on a joint in addition to the motor of a gear."""
        motor = f"{name}_motor"
        for each in self.root.findall("actuator/*"):
            if each.get("joint") == joint and (own := each.get("name")) != motor:
                yield f"the actuator {own or each.tag} still acts on {joint}, behind the gear; let {motor} take its place"

    # ---- Keyframes ---------------------------------------------------------------------------------------------------

    def joints(self) -> list[Element]:
        """Return the joints in the order of their numbers in qpos: bodies in the order of the file, depth first."""
        return [each for body in self.root.iter("body") for each in _joints_of(body)]

    def body_of(self, joint: Element) -> Element:
        """Return the body that a joint moves, which may have the joint in a frame."""
        body = self.parents[joint]
        while body.tag == "frame":
            body = self.parents[body]
        return body

    def kind(self, joint: Element) -> str:
        """Return the type of a joint."""
        return "free" if joint.tag == "freejoint" else self.stated(joint).get("type", "hinge")

    def extended_keyframes(self, rotor: Element, shaft: Element, ratio: float, added: Collection[Element]) -> Iterator[str]:
        """Give each keyframe the angle and speed of a rotor that has just been added; yield a remark on those it cannot.

        Args:
            rotor: joint of the rotor
            shaft: joint of the output
            ratio: of the gear
            added: actuators of the gear, the last ones
        """
        joints = [each for each in self.joints() if each is not rotor]
        place = self.joints().index(rotor)
        for key in self.root.findall("keyframe/key"):
            for name, counts in (("qpos", POSITIONS), ("qvel", SPEEDS)):
                if not (text := key.get(name)):
                    continue
                values, sizes = text.split(), [counts[self.kind(each)] for each in joints]
                if len(values) != sum(sizes):
                    which = f"{name} of the keyframe {key.get('name', '')}"
                    yield f"{which} has {len(values)} numbers, not {sum(sizes)}: add that of the rotor by hand"
                    continue
                turned = ratio * float(values[sum(sizes[: joints.index(shaft)])])
                values.insert(sum(sizes[:place]), repr(turned))
                key.set(name, " ".join(values))
            if key.get("ctrl"):
                key.set("ctrl", " ".join([key.attrib["ctrl"], *["0"] * len(added)]))
            if key.get("act") and any(each.tag == "dcmotor" for each in added):
                yield f"act of the keyframe {key.get('name', '')} lacks the states of the gear's motor: add them by hand"


def gears_of_joints(
    robot: Robot, joint: str | Mapping[str, GearSet | Drive | Gear | str | Path], default: GearSet
) -> dict[str, GearSet]:
    """Return the gear of each joint that gets one, in the order of the robot.

    Raises:
        ValueError: the robot has no such hinge
    """
    if isinstance(joint, Mapping):
        chosen = {name: gear_set_of(gear) for name, gear in joint.items()}
    else:
        entries = [each.strip().partition("=") for each in joint.split(",")]
        files = {gear: GearSet.read(gear) if gear else default for _, _, gear in entries}
        chosen = {name: files[gear] for name, _, gear in entries}
    others = chosen.pop("all", None)
    hinges = list(robot.hinges())
    for name in chosen:
        robot.hinge(name)
    gears = {name: chosen.get(name, others) for name in hinges}
    return {name: gear for name, gear in gears.items() if gear is not None}


def kept(names: str | None) -> tuple[str, ...]:
    """Return the attributes that a joint keeps of its own, of a text with commas.

    Raises:
        ValueError: one is none that a gear replaces
    """
    found = tuple(each.strip() for each in (names or "").split(",") if each.strip())
    if wrong := [each for each in found if each not in REPLACED]:
        raise ValueError(f"keep = {quoted(wrong[0])} must be one of {listed(REPLACED)}, or several with commas")
    return found


def timestep_of(root: Element) -> float:
    """Return the timestep of a model [s]."""
    option = root.find("option")
    return DEFAULT_TIMESTEP if option is None else float(option.get("timestep", DEFAULT_TIMESTEP))


def child(root: Element, tag: str) -> Element:
    """Return the child of a root with this tag, which is added if there is none."""
    found = root.find(tag)
    return ElementTree.SubElement(root, tag) if found is None else found


def written(root: Element) -> str:
    """Return a model as text."""
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _first(text: str) -> float:
    """Return the first number of an attribute, as damping may be a polynomial; 0 if all are."""
    numbers = [float(each) for each in text.split()]
    return next((each for each in numbers if each), 0.0) if np.isfinite(numbers).all() else 0.0


def _joints_of(body: Element) -> Iterator[Element]:
    """Yield the joints of a body, those in its frames included."""
    for each in body:
        if each.tag in ("joint", "freejoint"):
            yield each
        elif each.tag == "frame":
            yield from _joints_of(each)


def _read(path: Path) -> Element:
    """Return the model of a file, which finds its meshes and textures from any folder."""
    with read_by_others(path, "text"):
        text = read_text(path, MAX_MODEL_BYTES)
    root = _whole(_parsed(text), path)
    compilers = root.findall("compiler")
    if root.find("asset/*[@file]") is not None:
        stated = {key: value for each in compilers for key, value in each.attrib.items()}
        both = stated.get("assetdir", "")
        folders = {each: str((path.parent / stated.get(each, both)).resolve()) for each in ("meshdir", "texturedir")}
        for each in compilers or [child(root, "compiler")]:
            each.attrib.update(folders)
    return root


def _whole(root: Element, path: Path | None) -> Element:
    """Return a model with the files that it includes, and with the bodies that MuJoCo makes of `GENERATING` elements.

    Raises:
        ValueError: a file is included twice or lies outside of the folder, or all are too many, too large or too deep
    """
    files, room = set[Path](), MAX_MODEL_BYTES
    while True:
        parents = {each: parent for parent in root.iter() for each in parent}
        included = next(root.iter("include"), None)
        if included is None:
            break
        if path is None:
            raise ValueError("the model includes other files; give its path, not its text")
        parent = parents[included]
        place = list(parent).index(included)
        file = inside(path.parent, included.attrib.get("file", ""))
        if file in files or len(files) == MAX_INCLUDED_FILES:
            raise ValueError(f"the model includes {quoted(file.name)} twice, or more than {MAX_INCLUDED_FILES} files")
        files.add(file)
        with read_by_others(file, "text"):
            text = read_text(file, room)
        room -= len(text)
        parent[place : place + 1] = list(_xml(text))
    _check_depth(root)
    if not any(each.tag in GENERATING for each in root.iter()):
        return root
    try:
        import mujoco
    except ImportError:
        elements = listed(sorted({each.tag for each in root.iter()} & GENERATING))
        raise ValueError(
            f"only MuJoCo, which is not installed, can say what joints {elements} make; `pip install mujoco`"
        ) from None
    model = mujoco.MjSpec.from_file(str(path)) if path else mujoco.MjSpec.from_string(written(root))
    model.compile()
    return _parsed(model.to_xml())


def _parsed(model: str) -> Element:
    """Return the root of an MJCF file."""
    root = _xml(model)
    if root.tag != "mujoco":
        raise ValueError(f"the model is a {root.tag}, not a mujoco; MuJoCo itself saves a URDF as MJCF (mj_saveLastXML)")
    _check_depth(root)
    return root


def _check_depth(root: Element) -> None:
    depths = {root: 1}
    for parent in root.iter():
        depths.update(dict.fromkeys(parent, depths[parent] + 1))
    if (deepest := max(depths.values())) > MAX_NESTED_ELEMENTS:
        raise ValueError(f"the model nests {deepest} elements in each other; a robot may have {MAX_NESTED_ELEMENTS} at most")


def _xml(model: str) -> Element:
    """Return the root of a text; one that declares entities is refused, as these may grow without bound."""
    if len(model) > MAX_MODEL_BYTES or "<!DOCTYPE" in model or "<!ENTITY" in model:
        raise ValueError("the model declares entities, or is larger than 64 MiB; save it without a DOCTYPE")
    try:
        return ElementTree.fromstring(model)
    except ElementTree.ParseError as error:
        raise ValueError(f"the model is no XML: {error}") from None
