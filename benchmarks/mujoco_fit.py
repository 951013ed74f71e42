"""A drive that MuJoCo can express, fitted beside MuJoCo's own identification: seven numbers to a log of 10 s at 500 Hz.

Two inertias with a spring and a damper between them: the rotor, with Coulomb and viscous friction, and a pendulum. The torque
of the motor is the command, both encoders are compared. In MuJoCo these are two hinges with armature, `frictionloss` and
`damping`, coupled by a fixed tendon. Its friction is a soft constraint, and strainwave's sticks: runs with the same numbers
differ by more than the noise. So each is fitted to a run of its own with the same noise, by the same numbers and with steps of
the same length; both begin at the same numbers. `mujoco.sysid` is told how much each sensor weighs, `sw.fit` finds it.
"""

from __future__ import annotations

from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from typing import Any

import numpy as np
import strainwave as sw
from measure import least
from numpy.typing import NDArray
from report import Column, installed, print_table, save, three_digits
from rich.console import Console
from strainwave.identification.fitting.fit import Fit

Array = NDArray[np.float64]

DURATION, SAMPLE, DT = 10.0, 2e-3, 1e-3  # s; the step of both simulations
RATIO, TORQUE_CONSTANT, GRAVITY, ARM = 80.0, 0.1, 9.81, 0.2  # arm: m, from the axis to the centre of mass of the pendulum
TRUTH = {
    "load.inertia": 0.85, "load.gravity_torque": 11.0, "motor.inertia": 9.4e-5, "gear.friction_input.coulomb": 0.047,
    "gear.friction_input.viscous": 5e-4, "gear.stiffness.k": 1.42e4, "gear.damping": 20.0,
}  # fmt: skip
OFF = np.array([1.2, 0.85, 1.2, 1.3, 0.7, 0.8, 1.5])  # where fits begin, over the truth
LOWEST, HIGHEST = 0.3, 3.0  # limits of MuJoCo's search, over the truth: it asks for some
NOISE = {"input_angle": 1e-3, "output_angle": 1e-5}  # rad
ROUNDS = 3
COLUMNS = (
    Column("drive against MuJoCo", words=True, long=True),
    Column("off the truth [σ]"),
    Column("off the truth [%]"),
    Column("time of all cores [s]"),
    Column("ratio"),
    Column("time on the wall [s]"),
)
XML = f"""
<mujoco>
  <option timestep="{DT}" gravity="0 0 -{GRAVITY}" integrator="implicitfast"><flag contact="disable"/></option>
  <worldbody>
    <body name="rotor">
      <inertial pos="0 0 0" mass="1" diaginertia="1e-6 1e-6 1e-6"/>
      <joint name="rotor" type="hinge" axis="0 1 0"/>
    </body>
    <body name="link">
      <inertial pos="0 0 -{ARM}" mass="1" diaginertia="1 1 1"/>
      <joint name="link" type="hinge" axis="0 1 0"/>
    </body>
  </worldbody>
  <tendon><fixed name="gear" springlength="0"><joint joint="rotor" coef="1"/><joint joint="link" coef="-1"/></fixed></tendon>
  <actuator><motor name="motor" joint="rotor"/></actuator>
  <sensor><jointpos name="rotor" joint="rotor"/><jointpos name="link" joint="link"/></sensor>
</mujoco>
"""


@dataclass(frozen=True)
class MujocoFit:
    """A fit: largest distance from the truth in standard deviations of strainwave's, and as a share of the truth; time of all
    cores and on the wall [s]."""

    name: str
    off: float
    relative: float
    cpu_time: float
    wall_time: float


def truth() -> Array:
    return np.array(list(TRUTH.values()))


def drive(numbers: Array) -> sw.Drive:
    inertia, gravity, rotor, coulomb, viscous, stiffness, damping = numbers.tolist()
    friction = sw.friction.Coulomb(coulomb=coulomb, breakaway=coulomb, viscous=viscous)
    return sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.PlainRatio(reduction=RATIO),
            input_inertia=0.0,
            stiffness=sw.stiffness.Linear(k=stiffness),
            damping=damping,
            friction_input=friction,
        ),
        motor=sw.motor.CurrentSource(torque_constant=TORQUE_CONSTANT, inertia=rotor),
        control=sw.control.OpenLoop(),
        load=sw.loads.Pendulum(inertia=inertia, gravity_torque=gravity),
    )


def times() -> Array:
    return np.asarray(SAMPLE * np.arange(round(DURATION / SAMPLE) + 1), np.float64)


def commanded() -> Array:
    """Current of the motor at the instants of the log [A]."""
    time = times()
    waves = 1.3 * np.sin(0.8 * np.pi * time) + 0.7 * np.sin(3.1 * np.pi * time)
    waves += 1.0 * np.sin(13.0 * np.pi * time) + 1.5 * np.sin(34.0 * np.pi * time) + 1.5 * np.sin(50.0 * np.pi * time)
    return np.asarray(np.minimum(time, 1.0) ** 2 * waves)


def noise() -> Array:
    """Of both encoders [rad], shape (2, n)."""
    sigma = np.array(list(NOISE.values()))[:, np.newaxis]
    return np.asarray(sigma * np.random.default_rng(3).normal(size=(2, len(times()))))


def log_of_strainwave() -> sw.Recording:
    run = sw.simulate(drive(truth()), sw.scenario.table(times(), commanded()), DT, sample=SAMPLE)
    columns = {name: run[name] + each for name, each in zip(NOISE, noise(), strict=True)}
    units = {"time": "s", "command": "A", "input_angle": "rad", "output_angle": "rad"}
    return sw.Recording({"time": run.time, "command": commanded(), **columns}, units)


def by_strainwave(log: sw.Recording) -> Fit:
    alike = {"gear.friction_input.breakaway": "gear.friction_input.coulomb"}
    return sw.fit(drive(OFF * truth()), log, list(TRUTH), dt=DT, initial={"output_angle": 0.0}, ties=alike)


def write(spec: Any, numbers: Array) -> None:
    """Numbers of the drive into the description of MuJoCo's model, all at the output."""
    inertia, gravity, rotor, coulomb, viscous, stiffness, damping = numbers.tolist()
    link, shaft, gear = spec.body("link"), spec.joint("rotor"), spec.tendon("gear")
    link.mass = gravity / (GRAVITY * ARM)
    link.inertia = np.full(3, inertia - link.mass * ARM**2)
    shaft.armature, shaft.frictionloss = rotor * RATIO**2, coulomb * RATIO
    shaft.damping, gear.stiffness, gear.damping = (  # polynomials, of which the others leave the first
        np.array([first, 0.0, 0.0]) for first in (viscous * RATIO**2, stiffness, damping)
    )


@dataclass(frozen=True)
class Mujoco:
    """What MuJoCo's identification is given: model, its state at the beginning, torque and angles over time."""

    spec: Any
    beginning: Array
    torque: Any
    angles: Any


def log_of_mujoco() -> Mujoco:
    import mujoco
    from mujoco import rollout, sysid

    spec = mujoco.MjSpec.from_string(XML)
    write(spec, truth())
    model = spec.compile()
    data = mujoco.MjData(model)
    beginning = sysid.create_initial_state(model, data.qpos, data.qvel, data.act)
    fine = DT * np.arange(round(DURATION / DT) + 1)
    torque = (TORQUE_CONSTANT * RATIO * np.interp(fine, times(), commanded()))[:, np.newaxis]
    states, sensors = rollout.rollout(model, data, beginning, torque[:-1])
    every = round(SAMPLE / DT)
    instants, angles = states[0, every - 1 :: every, 0], sensors[0, every - 1 :: every]
    both = noise()[:, 1:].T * np.array([1.0 / RATIO, 1.0])
    seen = sysid.TimeSeries.from_names(instants, angles + both, model)
    return Mujoco(spec, beginning, sysid.TimeSeries(fine, torque), seen)


def by_mujoco(log: Mujoco) -> Array:
    """The numbers that MuJoCo's identification finds, by its own optimiser and differences."""
    from mujoco import sysid

    count = len(TRUTH)
    unknown = sysid.Parameter(
        "drive", np.ones(count), np.full(count, LOWEST), np.full(count, HIGHEST),
        modifier=lambda spec, scaled: write(spec, scaled.value * truth()),
    )  # fmt: skip
    parameters = sysid.ParameterDict({"drive": unknown})
    parameters["drive"].value[:] = OFF
    sequence = sysid.ModelSequences("drive", log.spec, "log", log.beginning, log.torque, log.angles)
    weights = {"rotor": RATIO / NOISE["input_angle"], "link": 1.0 / NOISE["output_angle"]}
    residual = sysid.build_residual_fn(models_sequences=[sequence], sensor_weights=weights)
    with redirect_stdout(StringIO()):
        found, _ = sysid.optimize(initial_params=parameters, residual_fn=residual, verbose=False)
    return np.asarray(found["drive"].value * truth())


def run(console: Console) -> None:
    """Prints, and writes the table."""
    own_log = log_of_strainwave()
    fitted, *own_times = least(lambda: by_strainwave(own_log), ROUNDS)
    estimates = {each.path: each for each in fitted.estimates}
    sigma = np.array([estimates[path].sigma for path in TRUTH])

    def told(name: str, numbers: Array, times: list[float]) -> MujocoFit:
        off = np.abs(numbers - truth())
        return MujocoFit(name, float(np.max(off / sigma)), float(np.max(off / truth())), *times)

    rows = [told("sw.fit", np.array([estimates[path].value for path in TRUTH]), own_times)]
    if installed("mujoco"):
        other_log = log_of_mujoco()
        numbers, *other_times = least(lambda: by_mujoco(other_log), 1)
        rows.append(told("mujoco.sysid", numbers, other_times))
    else:
        console.print("MuJoCo: not installed: pip install mujoco[sysid]")
    cells = [
        (
            row.name,
            three_digits(row.off),
            three_digits(100.0 * row.relative),
            *map(three_digits, (row.cpu_time, row.cpu_time / rows[0].cpu_time, row.wall_time)),
        )
        for row in rows
    ]
    print_table(console, "A drive fitted beside MuJoCo", COLUMNS, cells)
    save("mujoco_fit", rows)


if __name__ == "__main__":
    run(Console())
