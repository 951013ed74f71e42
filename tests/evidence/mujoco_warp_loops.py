"""Exported MJCF in MuJoCo Warp, by `python -m tests.evidence.mujoco_warp_loops`: torsion loops against those of the gears,
and runs of gears with each motor and friction, and of an arm with two gears, against MuJoCo.

Warp compiles the step of MuJoCo Warp in about two minutes, and keeps it in its cache. Then the rest takes six minutes on a CPU.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence

import numpy as np
import strainwave as sw
from strainwave.export.mujoco import mjcf
from strainwave.files.gear_set import GearSet

GEARS = ("csg-14-50", "csg-20-100", "csg-25-100", "csg-32-100", "shg-17-100")
ROBOT = """<mujoco><option timestep="0.00025" integrator="implicitfast"/><worldbody><body name="upper">
  <joint name="shoulder" axis="0 1 0"/><geom type="capsule" size=".03" fromto="0 0 0 0 0 -.3" contype="0"/>
  <body name="fore" pos="0 0 -.3"><joint name="elbow" axis="0 1 0"/>
  <geom type="capsule" size=".03" fromto="0 0 0 0 0 -.3" contype="0"/></body></body></worldbody></mujoco>"""
REACH = 3e-4  # rad, of the twist
POINTS = 2000  # of each branch of the loop
HEAVY = 1e12  # kg.m², so that the shafts stay where they are put
MAX_WIDTH_ERROR, MAX_LOSS_ERROR = 0.02, 0.01  # relative
INERTIA = 1.2  # kg.m²
RUN_STEPS = 800  # of runs against MuJoCo
RUN_TIMESTEP = 2.5e-4  # s
MAX_RUN_ERROR = 1e-4  # of the largest angle; MuJoCo Warp has single precision


def tendon_torque(text: str, twist: np.ndarray, ratio: float, device: str) -> np.ndarray:
    """Return the torque of the tendons at the output along a path of the twist [N.m], the output held at zero."""
    import mujoco
    import mujoco_warp as mjw
    import warp as wp

    with wp.ScopedDevice(device):
        source = mujoco.MjModel.from_xml_string(text)
        source.dof_armature[:] = HEAVY
        model, data = mjw.put_model(source), mjw.put_data(source, mujoco.MjData(source))
        at_input = source.joint("gear_input").qposadr[0]
        at_output = source.joint("gear_output").dofadr[0]
        place, torque = np.zeros((1, source.nq), np.float32), []
        for angle in twist * ratio:
            place[0, at_input] = angle
            data.qpos.assign(place)
            data.qvel.zero_()
            mjw.step(model, data)
            torque.append(data.qfrc_passive.numpy()[0, at_output])
        return np.array(torque, dtype=float)


def width_and_loss(twist: np.ndarray, torque: np.ndarray) -> tuple[float, float]:
    """Return the width of a closed loop at torque zero [rad], and its loss per cycle [J]."""
    half = len(twist) // 2
    down = np.interp(0.0, torque[: half + 1][::-1], twist[: half + 1][::-1])
    return float(down - np.interp(0.0, torque[half:], twist[half:])), abs(float(np.trapezoid(torque, twist)))


def errors(name: str, device: str) -> tuple[float, float]:
    """Return the relative errors of width and loss of the loop of a gear."""
    gear_set = GearSet.read(name)
    gear = gear_set.gear
    path = np.concatenate([np.linspace(a, b, POINTS) for a, b in ((0.0, REACH), (REACH, -REACH), (-REACH, REACH))])
    found = tendon_torque(mjcf(gear_set, load_inertia=INERTIA).files["gear.xml"], path, gear.kinematics.ratio, device)
    wanted = np.asarray(gear.stiffness.torque(path)) + np.asarray(gear.hysteresis.trace(path))
    (width, loss), (own_width, own_loss) = (width_and_loss(path[POINTS:], each[POINTS:]) for each in (wanted, found))
    return own_width / width - 1.0, own_loss / loss - 1.0


def run_error(text: str, controls: Sequence[float], device: str) -> float:
    """Return the largest difference of an angle from that of MuJoCo over its largest value, under constant controls."""
    import mujoco
    import mujoco_warp as mjw
    import warp as wp

    with wp.ScopedDevice(device):
        source = mujoco.MjModel.from_xml_string(text)
        source.opt.timestep = RUN_TIMESTEP
        plain = mujoco.MjData(source)
        plain.ctrl[: len(controls)] = controls
        model, data = mjw.put_model(source), mjw.put_data(source, plain)
        wanted, found = [], []
        for _ in range(RUN_STEPS):
            mujoco.mj_step(source, plain)
            mjw.step(model, data)
            wanted.append(plain.qpos.copy())
            found.append(data.qpos.numpy()[0].copy())
    difference = np.abs(np.array(found) - wanted).max(axis=0)
    return float((difference / np.abs(wanted).max(axis=0)).max())


def runs() -> Iterator[tuple[str, str, tuple[float, ...]]]:
    """Yield name, text and controls of models that run."""
    current = sw.motor.CurrentSource(torque_constant=0.1, inertia=2e-5)
    direct = sw.motor.DC(resistance=0.5, inductance=1e-3, torque_constant=0.1, back_emf=0.1, inertia=5e-5)
    dry = sw.friction.Coulomb(coulomb=0.046, viscous=3.5e-4)
    bristle = sw.friction.LuGre(
        coulomb=0.05, breakaway=0.07, stribeck_speed=2.0, bristle_stiffness=50.0, bristle_damping=5e-4, viscous=4e-4
    )
    whole = GearSet.read("csg-20-100")
    for motor, control in ((current, 3.0), (direct, 6.0)):
        for friction in (dry, bristle):
            drive = sw.Drive(
                gear=whole.gear.replace(friction_input=friction), motor=motor, load=sw.loads.Inertia(inertia=INERTIA)
            )
            text = mjcf(GearSet.of(drive, name="test", source="test"), max_torque=100.0).files["gear.xml"]
            yield f"{motor.name}, {friction.name}", text, (control,)
    driven = whole.with_parts(motor=current, source="test")
    first = mjcf(driven, into=ROBOT, joint="elbow", name="elbow_gear").files["gear.xml"]
    both = mjcf(driven, into=first, joint="shoulder", name="shoulder_gear").files["gear.xml"]
    yield "arm with two gears", both, (2.0, 3.0)


def main(device: str = "cpu") -> int:
    """Print the errors of all loops and runs; 1 if one is too large."""
    worst = 0
    for name in GEARS:
        begin = time.perf_counter()
        width, loss = errors(name, device)
        seconds = time.perf_counter() - begin
        print(f"{name}: width {100.0 * width:+.4f} %, loss per cycle {100.0 * loss:+.4f} % ({seconds:.0f} s)", flush=True)
        worst |= abs(width) > MAX_WIDTH_ERROR or abs(loss) > MAX_LOSS_ERROR
    for name, text, controls in runs():
        begin = time.perf_counter()
        error = run_error(text, controls, device)
        print(f"{name}: {error:.2g} of the largest angle ({time.perf_counter() - begin:.0f} s)", flush=True)
        worst |= not error < MAX_RUN_ERROR
    return int(worst)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
