"""MJCF of gears, run by MuJoCo itself, against the gears that they were made of."""

from functools import cache

import numpy as np
import pytest
import strainwave as sw
from strainwave.export.mujoco import mjcf
from strainwave.files.gear_set import GearSet

mujoco = pytest.importorskip("mujoco")

INERTIA = 1.2  # kg.m²
GEARS = ("csg-14-50", "csg-20-100", "csg-25-100", "csg-32-100", "shg-17-100")
ROBOT = """<mujoco><option timestep="0.0005" integrator="implicitfast"/><worldbody><body name="upper">
  <joint name="shoulder" axis="0 1 0"/><geom type="capsule" size=".03" fromto="0 0 0 0 0 -.3"/>
  <body name="fore" pos="0 0 -.3"><joint name="elbow" axis="0 1 0"/><joint name="rail" type="slide"/>
  <geom type="capsule" size=".03" fromto="0 0 0 0 0 -.3"/></body></body></worldbody>
  <actuator><motor joint="elbow" name="old"/></actuator></mujoco>"""
CURRENT = sw.motor.CurrentSource(torque_constant=0.1, inertia=2e-5)
LUGRE = sw.friction.LuGre(
    coulomb=0.05, breakaway=0.07, stribeck_speed=2.0, bristle_stiffness=50.0, bristle_damping=5e-4, viscous=4e-4
)


def quasi_static_torque(text: str, twist: np.ndarray, ratio: float) -> np.ndarray:
    """Torque of the tendons along a path of the twist, both shafts too heavy to move by themselves."""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    model.dof_armature[:] = 1e12
    mujoco.mj_setConst(model, data)  # MuJoCo takes the inertia of such simple bodies from here
    at_input, at_output = model.joint("gear_input"), model.joint("gear_output")
    torque = []
    for angle in twist * ratio:
        data.qpos[:], data.qvel[:] = 0.0, 0.0
        data.qpos[at_input.qposadr[0]] = angle
        mujoco.mj_step(model, data)
        torque.append(data.qfrc_passive[at_output.dofadr[0]])
    return np.array(torque)


def width_and_loss(twist: np.ndarray, torque: np.ndarray) -> tuple[float, float]:
    half = len(twist) // 2
    down = np.interp(0.0, torque[: half + 1][::-1], twist[: half + 1][::-1])
    return float(down - np.interp(0.0, torque[half:], twist[half:])), abs(float(np.trapezoid(torque, twist)))


@pytest.mark.parametrize("name", GEARS)
def test_the_loop_has_width_and_loss_of_the_trace(name):
    gear_set = GearSet.read(name)
    gear, reach = gear_set.gear, 3e-4
    path = np.concatenate([np.linspace(a, b, 4000) for a, b in ((0, reach), (reach, -reach), (-reach, reach))])
    found = quasi_static_torque(mjcf(gear_set, load_inertia=INERTIA).files["gear.xml"], path, gear.kinematics.ratio)
    wanted = np.asarray(gear.stiffness.torque(path)) + np.asarray(gear.hysteresis.trace(path))
    (width, loss), (own_width, own_loss) = (width_and_loss(path[4000:], each[4000:]) for each in (wanted, found))
    assert width > 1e-6
    assert own_width == pytest.approx(width, rel=0.02)
    assert own_loss == pytest.approx(loss, rel=0.01)


@cache
def simulated(drive: sw.Drive, amplitude: float) -> sw.Recording:
    motion = sw.scenario.sine(amplitude=amplitude, frequency=0.5, duration=4.0)
    return sw.simulate(drive, motion, sample=1e-2, record=["input_angle", "output_angle"])


def error_of_mujoco(drive: sw.Drive, amplitude: float, timestep: float) -> float:
    """Largest error of the output angle over its range."""
    gear_set = GearSet.of(drive, name="test", source="test")
    model = mujoco.MjModel.from_xml_string(mjcf(gear_set, max_torque=100.0).files["gear.xml"])
    model.opt.timestep = timestep
    model.dof_solref[:, 0] = np.where(model.dof_solref[:, 0] > 0, 2.0 * timestep, model.dof_solref[:, 0])
    data, every, angle = mujoco.MjData(model), round(1e-2 / timestep), []
    for step in range(round(4.0 / timestep)):
        data.ctrl[0] = amplitude * np.sin(np.pi * data.time)
        mujoco.mj_step(model, data)
        if (step + 1) % every == 0:
            angle.append(data.qpos[model.joint("gear_output").qposadr[0]])
    wanted = simulated(drive, amplitude)["output_angle"]
    return float(np.abs(np.array(angle) - wanted[1:]).max() / np.ptp(wanted))


DC = sw.motor.DC(resistance=0.5, inductance=1e-3, torque_constant=0.1, back_emf=0.1, inertia=5e-5)


@pytest.mark.slow("export")
@pytest.mark.parametrize(("motor", "amplitude"), [(CURRENT, 3.0), (DC, 6.0)])
@pytest.mark.parametrize("friction", [sw.friction.Coulomb(coulomb=0.046, viscous=3.5e-4), LUGRE])
def test_a_run_converges_to_the_simulation_as_the_timestep_falls(motor, amplitude, friction):
    no_error = sw.Gear().kinematic_error
    gear = GearSet.read("csg-20-100").gear.replace(friction_input=friction, kinematic_error=no_error)
    drive = sw.Drive(gear=gear, motor=motor, load=sw.loads.Inertia(inertia=INERTIA))
    coarse, fine = (error_of_mujoco(drive, amplitude, timestep) for timestep in (2.5e-4, 5e-5))
    assert fine < 5e-4
    assert fine < 0.5 * coarse


def test_an_arm_gets_two_gears():
    gear_set = GearSet.read("csg-20-100").with_parts(motor=CURRENT, source="test")
    first = mjcf(gear_set, into=ROBOT, joint="elbow", name="elbow_gear")
    assert first.remarks[0].startswith("the actuator old still acts on elbow")
    both = mjcf(gear_set, into=first.files["gear.xml"], joint="shoulder", name="shoulder_gear").files["gear.xml"]
    model = mujoco.MjModel.from_xml_string(both)
    data = mujoco.MjData(model)
    for _ in range(2000):
        mujoco.mj_step(model, data)
    ratio = gear_set.gear.kinematics.ratio
    for link, name in (("shoulder", "shoulder_gear"), ("elbow", "elbow_gear")):
        at_output, at_input = data.joint(link).qpos[0], data.joint(f"{name}_input").qpos[0]
        assert abs(at_input / ratio - at_output) < 1e-3
    assert model.nq == 5


def test_drawn_gears_are_numbers_that_the_model_takes():
    import json

    found = mjcf(GearSet.read("csg-20-100"), load_inertia=INERTIA, draws=20, seed=3)
    drawn = json.loads(found.files["randomisation.json"])
    low, high = drawn["ranges"]["gear_twist_0.stiffness[0]"]
    assert low < 13719.5 < high  # k1 of the set less its hysteresis
    assert len(drawn["draws"]) == 20


@pytest.mark.parametrize(
    ("model", "joint", "message"),
    [
        (ROBOT, "wrist", "it has shoulder, elbow, rail"),
        (ROBOT, "rail", "a gear turns a hinge"),
        ("<robot/>", "elbow", "is a robot, not a mujoco"),
        ("<mujoco>", "elbow", "no XML"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><mujoco/>', "elbow", "declares entities"),
    ],
)
def test_a_robot_that_cannot_have_the_gear_is_refused(model, joint, message):
    with pytest.raises(ValueError, match=message):
        mjcf(GearSet.read("csg-20-100"), into=model, joint=joint)


def test_a_gear_alone_needs_an_inertia():
    with pytest.raises(ValueError, match="load_inertia"):
        mjcf(GearSet.read("csg-20-100"))


def test_the_cogging_of_a_motor_has_its_sign_and_order():
    part = sw.motor.DC(resistance=0.5, torque_constant=0.1, back_emf=0.1, inertia=5e-5, cogging_torque=0.02, cogging_order=24.0)
    gear_set = GearSet.of(sw.Drive(motor=part, load=sw.loads.Inertia(inertia=INERTIA)), name="test", source="test")
    model = mujoco.MjModel.from_xml_string(mjcf(gear_set, max_torque=100.0).files["gear.xml"])
    data = mujoco.MjData(model)
    data.joint("gear_input").qpos[0] = 0.03
    mujoco.mj_forward(model, data)
    assert data.actuator_force[0] == pytest.approx(0.02 * np.sin(24.0 * 0.03))  # as added_to in motor/cogging.hpp


def test_what_a_motor_has_no_element_for_is_named():
    part = sw.motor.BrushlessDC(resistance=0.5, torque_constant=0.1, inertia=5e-5)
    found = mjcf(GearSet.read("csg-20-100").with_parts(motor=part, source="test"), load_inertia=INERTIA)
    assert "the motor brushless_dc: the actuator is a torque at the input" in found.left_out


def test_numbers_of_the_load_and_a_missing_rotor_are_named():
    pendulum = sw.loads.Pendulum(inertia=INERTIA, gravity_torque=10.973)
    whole = GearSet.read("csg-20-100").with_parts(motor=sw.motor.CurrentSource(inertia=0.0), load=pendulum, source="test")
    alone, in_robot = mjcf(whole), mjcf(whole, into=ROBOT, joint="elbow")
    assert "load: gravity_torque 10.973 N.m; build it of bodies" in alone.left_out
    assert "load: inertia 1.2 kg.m2, gravity_torque 10.973 N.m; the bodies of the robot take its place" in in_robot.left_out
    for found in (alone, in_robot):
        (rotor,) = (each for each in found.remarks if each.startswith("motor.inertia is 0 in the file"))
        assert "--constant motor_inertia=NUMBER" in rotor
    with_rotor = mjcf(whole.with_parts(motor=CURRENT, load=sw.loads.Inertia(inertia=INERTIA), source="test"))
    assert not any(each.startswith("load: ") for each in with_rotor.left_out)
    assert not any("armature" in each for each in with_rotor.remarks)


def test_the_load_of_the_run_that_is_compared_is_said_to_be_that_of_the_comparison_alone():
    losses = mjcf(GearSet.read("csg-20-100"), load_inertia=INERTIA).losses
    of_run = [each.over for each in losses if each.quantity.endswith(" of a run")]
    assert len(of_run) == 2
    assert all(each.endswith(" kg.m2 at the output, a load of this comparison only") for each in of_run)
