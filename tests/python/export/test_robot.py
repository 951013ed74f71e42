"""Gears in robots of others: classes that give a joint range and friction, keyframes, free and fixed bodies."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.export.mujoco import mjcf
from strainwave.export.robot import MAX_NESTED_ELEMENTS, kept

mujoco = pytest.importorskip("mujoco")

RATIO = sw.load("csg-20-100").kinematics.ratio
# A walking robot: a free body, classes in classes, a ball, a fixed body, an axis that a class gives, and keyframes.
ROBOT = """<mujoco><compiler angle="radian" autolimits="true"/><option timestep="0.0005" gravity="0 0 0"/>
  <default><joint damping="1" range="-9 9"/><motor ctrlrange="-1 1"/>
    <default class="leg"><joint axis="0 1 0" armature="0.1" frictionloss="2"/>
      <default class="knee"><joint range="-2 2" damping="40"/></default></default></default>
  <worldbody><body name="trunk" childclass="leg"><freejoint/><geom size=".1" mass="9"/>
    <body name="tail"><joint type="ball" name="tail" limited="false" range="0 1"/>
      <geom size=".02" pos="0 0 .1" mass=".1"/></body>
    <body name="thigh"><joint name="hip"/><geom size=".03" pos="0 0 -.1" mass="1"/>
      <body name="foot" pos="0 0 -.2"><geom size=".01" mass=".1"/></body>
      <body name="shank" pos="0 0 -.2"><joint name="knee" class="knee"/><geom size=".03" pos="0 0 -.1" mass="1"/>
        <body name="toe"><joint name="toe" type="slide"/><geom size=".01" mass=".1"/></body></body></body></body></worldbody>
  <actuator><motor name="hip" joint="hip"/></actuator>
  <keyframe><key name="crouch" qpos="1 2 3 1 0 0 0 1 0 0 0 .3 .7 .01" qvel="0 0 0 0 0 0 0 0 0 .2 .5 0" ctrl=".1"/></keyframe>
</mujoco>"""


def with_gear(joint, **options):
    found = mjcf("csg-20-100", into=ROBOT, joint=joint, **options)
    model = mujoco.MjModel.from_xml_string(found.files["gear.xml"])
    return found, model, mujoco.MjData(model)


@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_a_keyframe_has_the_rotor_where_the_gear_is_not_wound_up(joint):
    _, model, data = with_gear(joint)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    output, rotor = model.joint(joint), model.joint("gear_input")
    before = {"hip": (0.3, 0.2), "knee": (0.7, 0.5)}[joint]
    assert (data.joint(joint).qpos[0], data.joint(joint).qvel[0]) == before
    assert data.joint("gear_input").qpos[0] == pytest.approx(RATIO * before[0], rel=1e-12)
    assert data.joint("gear_input").qvel[0] == pytest.approx(RATIO * before[1], rel=1e-12)
    assert data.joint("toe").qpos[0] == 0.01
    assert data.ten_length == pytest.approx(np.zeros(model.ntendon), abs=1e-12)
    assert data.ctrl.tolist() == [0.1, 0.0]
    assert np.cross(model.jnt_axis[output.id], model.jnt_axis[rotor.id]) == pytest.approx(np.zeros(3))


@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_rotor_and_motor_have_nothing_of_the_robots_classes(joint):
    found, model, _ = with_gear(joint)
    rotor = model.joint("gear_input")
    gear = sw.load("csg-20-100")
    assert not model.jnt_limited[rotor.id]
    assert model.dof_armature[rotor.dofadr[0]] == pytest.approx(gear.input_inertia)
    assert not model.actuator_ctrllimited[model.actuator("gear_motor").id]
    assert model.joint(joint).damping[0] == model.joint(joint).armature[0] == 0.0
    assert any(f"armature 0.1 of {joint} is replaced" in remark for remark in found.remarks)


def test_what_is_kept_of_a_joint_adds_to_the_gear():
    found, model, _ = with_gear("knee", keep="damping, armature")
    assert model.joint("knee").damping[0] == 40.0
    assert model.joint("knee").armature[0] == 0.1
    assert not any("damping" in remark and "replaced" in remark for remark in found.remarks)
    with pytest.raises(ValueError, match=r"keep = \"mass\" must be one of damping, frictionloss, armature"):
        kept("mass")


@pytest.mark.parametrize("depth", [400, 20_000])
def test_a_model_that_nests_deeper_than_its_writer_is_refused_in_one_line(depth):
    """Each body is in the one before; the joint is that of the first."""
    bodies = '<body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>' * depth + "</body>" * depth
    robot = f"<mujoco><worldbody>{bodies}</worldbody></mujoco>".replace("<body>", '<body><joint name="hip"/>', 1)
    if depth < MAX_NESTED_ELEMENTS:
        assert "gear_input" in mjcf("csg-20-100", into=robot, joint="hip").files["gear.xml"]
        return
    with pytest.raises(ValueError, match="the model nests 20003 elements in each other; a robot may have 500 at most"):
        mjcf("csg-20-100", into=robot, joint="hip")


def test_a_keyframe_of_another_length_is_named():
    found = mjcf("csg-20-100", into=ROBOT.replace(".7 .01", ".7"), joint="knee")
    assert any("qpos of the keyframe crouch has 13 numbers, not 14" in remark for remark in found.remarks)


def test_the_output_turns_as_far_as_the_motor_drives_it():
    """A class with a range of 2 rad must not stop the rotor: at the output that is a fiftieth of it."""
    _, model, data = with_gear("hip")
    data.ctrl[model.actuator("gear_motor").id] = 0.5
    mujoco.mj_step(model, data, nstep=1000)
    assert abs(data.joint("gear_input").qpos[0]) > 10.0
    assert data.joint("hip").qpos[0] == pytest.approx(data.joint("gear_input").qpos[0] / RATIO, abs=1e-3)


def test_a_motor_is_not_limited_by_the_class_of_another_actuator():
    """MuJoCo gives the attributes of `position` in a default class to every actuator."""
    robot = ROBOT.replace('<motor ctrlrange="-1 1"/>', '<position ctrlrange="-1 1" forcerange="-2 2"/>')
    model = mujoco.MjModel.from_xml_string(mjcf("csg-20-100", into=robot, joint="knee").files["gear.xml"])
    motor = model.actuator("gear_motor").id
    assert not model.actuator_ctrllimited[motor]
    assert not model.actuator_forcelimited[motor]


def test_each_joint_of_a_robot_gets_its_gear():
    gear = sw.load("csg-32-50")
    found = mjcf("csg-20-100", into=ROBOT, joint={"knee": gear, "all": "csg-20-100"}, max_torque=100.0)
    model = mujoco.MjModel.from_xml_string(found.files["gear.xml"])
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    for joint, ratio, angle in (("hip", RATIO, 0.3), ("knee", gear.kinematics.ratio, 0.7)):
        assert data.joint(joint).qpos[0] == angle
        assert data.joint(f"{joint}_gear_input").qpos[0] == pytest.approx(ratio * angle, rel=1e-12)
    assert data.ten_length == pytest.approx(np.zeros(model.ntendon), abs=1e-12)
    assert {each.quantity.partition(": ")[0] for each in found.losses} == {"hip", "knee"}
    assert mjcf("csg-20-100", into=ROBOT, joint="hip, knee").files == mjcf("csg-20-100", into=ROBOT, joint="all").files
    with pytest.raises(ValueError, match="draws = 3 are made for one joint; hip, knee have gears"):
        mjcf("csg-20-100", into=ROBOT, joint="all", draws=3)


@pytest.mark.parametrize(("share", "is_stable"), [(0.9, True), (1.15, False)])
def test_a_timestep_is_shortened_to_what_the_gears_of_light_links_need(share, is_stable):
    light = ROBOT.replace('mass="1"', 'mass="0.02"')
    found = mjcf("csg-20-100", into=light, joint="hip, knee")
    (remark,) = (each for each in found.remarks if "stable up to" in each)
    model = mujoco.MjModel.from_xml_string(found.files["gear.xml"])
    longest = float(remark.partition("up to ")[2].split()[0])
    assert 0.1 * longest < model.opt.timestep < 0.5 * longest < 2.5e-4
    model.opt.timestep = share * longest
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    data = mujoco.MjData(model)
    data.joint("knee").qpos[0] = data.joint("hip").qpos[0] = 1e-6
    mujoco.mj_step(model, data, nstep=2000)
    twists = [data.joint(name).qpos[0] - data.joint(f"{name}_gear_input").qpos[0] / RATIO for name in ("hip", "knee")]
    assert (np.abs(twists).max() < 1e-5) == is_stable


# A joint in degrees that begins at another angle than 0, with a class three deep from the body around it; a name in UTF-8.
DEEP = """<mujoco><compiler angle="degree"/>
  <default><joint damping="1"/>
    <default class="robot"><joint armature="0.2" frictionloss="3"/>
      <default class="arm"><joint range="-120 120" stiffness="5"/>
        <default class="upper"><joint damping="7" ref="20" limited="true"/><position kp="50" ctrlrange="-2 2"/></default>
      </default></default></default>
  <worldbody><body childclass="robot"><body childclass="arm"><body childclass="upper">
    <frame euler="0 0 30"><joint name="élbow joint" axis="0 1 0"/></frame><geom size=".05" pos=".3 0 0" mass="1"/>
  </body></body></body></worldbody>
  <actuator><position class="upper" name="p" joint="élbow joint"/></actuator>
  <keyframe><key qpos="0.8" ctrl="0.8"/></keyframe></mujoco>"""
LEG = """<mujocoinclude><body pos="0 0 1"><freejoint/><geom type="box" size=".1 .1 .1" mass="3"/>
  <frame pos="0 0 -.1" euler="0 30 0" childclass="leg"><body><joint name="hip pitch" axis="0 1 0" range="-90 90"/>
    <geom type="mesh" mesh="bone" mass="1"/>
    <body pos="0 0 -.3"><joint name="knee" axis="0 1 0" range="0 100"/><geom size=".03" pos="0 0 -.2" mass=".7"/>
      <body pos="0 0 -.3"><joint name="ankle" type="ball"/><geom size=".04" mass=".2"/></body></body></body></frame>
</body></mujocoinclude>"""
SCENE = """<mujoco><compiler angle="degree" autolimits="true" meshdir="parts"/><option timestep="0.0005"/>
  <default><default class="leg"><joint damping="2" armature=".05"/><general dyntype="filter" dynprm=".05"/></default></default>
  <asset><mesh name="bone" file="bone.obj" scale=".1 .1 .3"/></asset>
  <worldbody><include file="leg.xml"/>{posts}
    <body pos="0 2 .3"><joint name="rail" type="slide" axis="1 0 0"/><geom size=".1" mass="1"/>
      <body><joint name="pole" axis="0 1 0" range="-60 60"/><geom size=".05" pos="0 0 .4" mass=".3"/></body></body></worldbody>
  <tendon><fixed name="t"><joint joint="hip pitch" coef="1"/><joint joint="knee" coef="-.5"/></fixed></tendon>
  <equality><joint joint1="pole" joint2="knee" polycoef="0 .1 0 0 0" active="false"/></equality>
  <actuator><general class="leg" name="g" joint="knee" gainprm="20"/></actuator>
  <sensor><jointpos joint="knee"/></sensor>
  <keyframe><key qpos="0 0 1 1 0 0 0 .2 .5 1 0 0 0 {angles} .1 .3" act=".1" ctrl=".1"/></keyframe></mujoco>"""
REPLICATED = """<replicate count="3" offset=".5 0 0"><body pos="2 0 .5"><joint name="swing" axis="0 1 0"/>
  <geom size=".05" pos="0 0 -.2" mass=".2"/></body></replicate>"""
BONE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def unwound(model):
    """The largest twist of the gears where a model begins, and at its keyframe [rad]."""
    data, twists = mujoco.MjData(model), []
    gears = [i for i in range(model.ntendon) if "_twist_" in model.tendon(i).name]
    for begin in (mujoco.mj_resetData, lambda *which: mujoco.mj_resetDataKeyframe(*which, 0)):
        begin(model, data)
        mujoco.mj_forward(model, data)
        twists.append(np.abs(data.ten_length[gears]).max())
    return max(twists)


def test_a_joint_in_a_frame_with_classes_three_deep_and_another_zero_gets_its_gear(tmp_path):
    (tmp_path / "robot.xml").write_text(DEEP, "utf-8")
    found = mjcf("csg-20-100", into=tmp_path / "robot.xml", joint="all")
    model = mujoco.MjModel.from_xml_string(found.files["gear.xml"])
    rotor, output = model.joint("gear_input"), model.joint("élbow joint")
    assert not model.jnt_limited[rotor.id]
    assert model.dof_armature[rotor.dofadr[0]] == pytest.approx(sw.load("csg-20-100").input_inertia)
    assert output.damping[0] == output.armature[0] == 0.0
    assert unwound(model) < 1e-12
    assert model.body_parentid[model.jnt_bodyid[rotor.id]] == model.body_parentid[model.jnt_bodyid[output.id]]


@pytest.mark.parametrize("posts", ["", REPLICATED], ids=["include", "replicate"])
def test_a_scene_of_several_files_is_one_model_with_gears(tmp_path, posts):
    (tmp_path / "robot" / "parts").mkdir(parents=True)
    (tmp_path / "robot" / "parts" / "bone.obj").write_text(BONE)
    (tmp_path / "robot" / "leg.xml").write_text(LEG)
    (tmp_path / "robot" / "scene.xml").write_text(SCENE.format(posts=posts, angles="0 .7 0" if posts else ""))
    found = mjcf("csg-14-100", into=tmp_path / "robot" / "scene.xml", joint="all")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "gear.xml").write_text(found.files["gear.xml"])
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "gear.xml"))  # which finds the mesh
    hinges = ["hip pitch", "knee", "pole", *(["swing0", "swing1", "swing2"] if posts else [])]
    assert {model.joint(i).name for i in range(model.njnt)} >= {f"{each}_gear_input" for each in hinges}
    assert unwound(model) < 1e-12
    assert not any("by hand" in remark for remark in found.remarks)


def test_a_text_that_includes_files_asks_for_its_path():
    with pytest.raises(ValueError, match="give its path, not its text"):
        mjcf("csg-14-100", into=SCENE.format(posts="", angles=""), joint="knee")
