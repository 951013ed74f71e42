"""Numbers of a joint: MuJoCo keeps a joint at rest below its friction, and the inertia that armature lacks is stated."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

import pytest
import strainwave as sw
from strainwave.export.joint_numbers import joint
from strainwave.files.gear_set import GearSet

mujoco = pytest.importorskip("mujoco")

RUN_SECONDS = 10.0
GEAR = GearSet.read("csg-20-100")


def turned(attributes: dict[str, str], torque: float, timestep: float) -> float:
    """Angle of a link of 1 kg.m² after a constant torque [rad]."""
    own = " ".join(f'{key}="{value}"' for key, value in attributes.items())
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="0 0 0" timestep="{timestep}"/><worldbody><body><joint name="elbow" axis="0 0 1" {own}/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>'
        '<actuator><motor joint="elbow"/></actuator></mujoco>'
    )
    data = mujoco.MjData(model)
    data.ctrl[0] = torque
    mujoco.mj_step(model, data, nstep=round(RUN_SECONDS / timestep))
    return float(data.qpos[0])


@pytest.mark.parametrize("timestep", [5e-4, 2e-3, 5e-3])
def test_a_joint_of_mujoco_rests_below_its_friction(timestep: float) -> None:
    found = joint(GEAR)
    written = ElementTree.fromstring(str(found.files["joint.xml"])).find("default/default/joint")
    assert written is not None
    friction = found.numbers["frictionloss"][0]
    assert float(written.attrib["frictionloss"]) == friction
    assert 0.0 < turned(written.attrib, 0.9 * friction, timestep) < 1e-4  # rad in 10 s
    assert turned(written.attrib, 1.1 * friction, timestep) > 0.1
    plain = {key: value for key, value in written.attrib.items() if not key.startswith("sol")}
    assert turned(plain, 0.9 * friction, timestep) > 1e-3  # MuJoCo's own default creeps


def test_the_parser_of_ros_reads_the_urdf() -> None:
    urdf = pytest.importorskip("urdf_parser_py.urdf")
    found = joint(GEAR)
    robot = urdf.URDF.from_xml_string(str(found.files["joint.urdf"]).encode())
    (only,), (transmission,) = robot.joints, robot.transmissions
    assert (only.dynamics.friction, only.dynamics.damping) == tuple(
        found.numbers[key][0] for key in ("frictionloss", "damping")
    )
    assert only.limit.effort == GEAR.ratings["peak_torque"].value
    assert transmission.actuators[0].mechanicalReduction == GEAR.gear.kinematics.ratio


class Genesis:
    """Methods of an entity of Genesis, which record what is set."""

    def __init__(self) -> None:
        self.values = dict[str, list[float]]()

    def set_dofs_armature(self, values: list[float], dofs: list[int]) -> None:
        self.values["armature"] = values

    def set_dofs_frictionloss(self, values: list[float], dofs: list[int]) -> None:
        self.values["frictionloss"] = values

    def set_dofs_damping(self, values: list[float], dofs: list[int]) -> None:
        self.values["damping"] = values


def test_isaac_lab_and_genesis_get_the_numbers_under_their_names() -> None:
    """Isaac Lab takes a friction at rest of its own, at least that in motion."""
    law = sw.friction.Stribeck(coulomb=0.03, breakaway=0.05, stribeck_speed=2.0)
    gear = GearSet.of(GEAR.gear.replace(friction_input=law), name="Stribeck", source="test")
    found, names = joint(gear, max_torque=100.0), dict[str, Any]()
    exec(str(found.files["joint.py"]), names)
    robot = Genesis()
    names["set_in_genesis"](robot, [3, 4])
    numbers = {name: value for name, (value, _) in found.numbers.items()}
    assert robot.values == {name: 2 * [numbers[name]] for name in ("armature", "frictionloss", "damping")}
    assert names["ISAAC_LAB"] == {
        "armature": numbers["armature"],
        "friction": numbers["breakaway"],
        "dynamic_friction": numbers["frictionloss"],
        "viscous_friction": numbers["damping"],
    }
    ratio = abs(gear.gear.kinematics.ratio)
    assert numbers["breakaway"] == pytest.approx(0.05 * ratio)
    assert 0.03 * ratio <= numbers["frictionloss"] < numbers["breakaway"]
    assert all(each in names["__doc__"] for each in found.left_out)


def test_an_armature_without_the_rotor_is_stated() -> None:
    for inertia, words in ((0.0, "motor.inertia is 0 in the file"), (2e-5, "")):
        whole = GEAR.with_parts(motor=sw.motor.TorqueSource(inertia=inertia), source="test")
        found = joint(whole)
        stated = [each for each in found.remarks if "armature" in each]
        assert len(stated) == bool(words)
        assert all(words in each and "do not add it again" in each for each in stated)
        armature = (whole.gear.input_inertia + inertia) * whole.gear.kinematics.ratio**2
        assert found.numbers["armature"][0] == pytest.approx(armature)
    assert any("contains no motor" in each for each in joint(GEAR).remarks)
