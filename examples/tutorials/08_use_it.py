# %% [markdown]
# # Use it: MJCF and URDF, FMU, C++ step, feed-forward
#
# At the end you have the gear of a log in a robot simulator, a co-simulation tool, a firmware, and a controller that
# compensates it. Each export is checked against strainwave.
#
# **Time:** 25 minutes. **You need:** strainwave with matplotlib. The FMU and the firmware need a C++ compiler, the checks of
# FMU and MJCF the packages `fmpy` and `mujoco`. What is not installed is skipped.

# %% [markdown]
# ## The gear of a log
#
# A log has the time, the angle and the torque of a joint at its output. This one is computed by a formula, with a friction
# of 6 N·m and 4 N·m·s/rad. Put your own log in its place: [the first tutorial](01_robot_log.py) shows how.

# %%
import ctypes
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import strainwave as sw

random = np.random.default_rng(1)
t = np.arange(0.0, 12.0, 0.004)
q = 0.8 * np.sin(1.3 * t) + 0.25 * np.sin(3.1 * t)
speed = np.gradient(q, t)
torque = 2.0 * np.gradient(speed, t) + 30.0 * np.sin(q) + 6.0 * np.sign(speed) + 4.0 * speed
torque += 0.2 * random.normal(size=len(t))  # noise of the sensor
columns = {"t": t, "q": q + 2e-6 * random.normal(size=len(t)), "tau": torque}
sw.Recording(columns, {"t": "s", "q": "rad", "tau": "N.m"}).to_csv("log.csv")

# %%
result = sw.identify("robot-joint", ["log.csv"])
for parameter in result.parameters:
    each = parameter.estimate
    print(f"{each.path:30} {each.value:9.3g} ± {each.sigma:.2g} {each.unit}")
found = result.gear_set
found.save("found.toml")

# %% [markdown]
# On the command line: `strainwave identify robot-joint log.csv --out found`, which writes the same gear to `found/gear.toml`.
#
# The numbers of friction belong to the input: 0.06 N·m there are 6 N·m at the output of a gear of ratio 100. What the log
# does not determine, as stiffness and hysteresis, stays that of the set `robot-joint` and is marked as assumed in
# `found.toml`.
#
# ## MJCF and URDF: the numbers of a joint

# %% [console]
# $ strainwave export joint found.toml --out joint
# $ cat joint/joint.xml joint/joint.urdf

# %% [markdown]
# The export states the loss: a joint of MuJoCo has friction and inertia, and no torsion. `armature` and
# `load.inertia` together are the 2 kg·m² of the formula: the log shows their sum, and `robot-joint` states the rotor.
#
# The check: a torque of 20 N·m turns a free joint, and MuJoCo must turn it as far as strainwave does. Under 0.9 of its
# friction it must rest.

# %%
ratio = abs(found.gear.kinematics.ratio)
free = sw.Drive(
    gear=found.gear, motor=sw.motor.TorqueSource(inertia=found.drive.motor.inertia), load=sw.loads.Inertia(inertia=1.0)
)
pushed = sw.simulate(free, sw.scenario.constant(-20.0 / ratio, duration=2.0), sample=1e-3)  # N.m of the motor
print(f"strainwave: {pushed['output_angle'][-1]:.3f} rad after 2 s")

if find_spec("mujoco"):
    import mujoco

    exported = sw.export.joint(found)
    scene = """<mujoco><include file="joint.xml"/><option gravity="0 0 0" timestep="0.001"/><worldbody><body>
        <joint class="gear" name="elbow" axis="0 0 1"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
        </body></worldbody><actuator><motor joint="elbow"/></actuator></mujoco>"""
    model = mujoco.MjModel.from_xml_string(scene, {"joint.xml": exported.files["joint.xml"].encode()})
    data = mujoco.MjData(model)
    data.ctrl[0] = 20.0
    mujoco.mj_step(model, data, nstep=2000)
    print(f"MuJoCo:     {data.qpos[0]:.3f} rad after 2 s")

    mujoco.mj_resetData(model, data)
    data.ctrl[0] = 0.9 * exported.numbers["frictionloss"][0]
    mujoco.mj_step(model, data, nstep=10000)
    print(f"below its friction: {1e6 * data.qpos[0]:.0f} µrad after 10 s")

# %% [markdown]
# Dry friction in MuJoCo is soft: a joint with `frictionloss` alone creeps. The class in `joint.xml` has `solimpfriction` and
# `solreffriction`, with which it rests.
#
# ## A drive for the other exports
#
# FMU, firmware and feed-forward need a motor, a controller and a load as well. The controller is a sampled one, because a
# firmware acts once a period.

# %%
load = sw.loads.Pendulum(inertia=2.0, gravity_torque=30.0)
motor = sw.motor.CurrentSource(torque_constant=0.1, inertia=5.5e-5)
law = sw.control.PositionSpeed(
    position_gain=20.0, speed_proportional=1.0, speed_integral=10.0, speed_feedforward=1.0, limit=30.0
)
control = sw.control.Sampled(law=law, period=1e-3)
mine = found.with_parts(motor=motor, control=control, load=load, source="an example").replace(name="Elbow")
drive = sw.Drive(gear=found.gear, motor=motor, control=control, load=load)
mine.save("elbow.toml")

# %% [markdown]
# ## FMU: the drive in Simulink, Dymola or OpenModelica
#
# The FMU contains the C++ code of the simulation. FMPy runs it here; the result must be that of `sw.simulate`. On the command
# line: `strainwave export fmu elbow.toml`.

# %%
if find_spec("fmpy") and shutil.which("c++"):
    import fmpy

    name, content = next(each for each in sw.export.fmu(mine).files.items() if each[0].endswith(".fmu"))
    Path(name).write_bytes(content)
    start = {"command": 0.005}
    block = fmpy.simulate_fmu(name, stop_time=0.5, output_interval=1e-3, start_values=start, output=["output_angle", "torque"])
    same = sw.simulate(mine, sw.scenario.constant(0.005, duration=0.5), sample=1e-3)
    for column in ("output_angle", "torque"):
        print(
            f"{column}: largest difference {np.abs(block[column] - same[column]).max():.1e} of {np.abs(same[column]).max():.3g}"
        )

# %% [markdown]
# ## Firmware: the controller as a C++ step
#
# `sw.export.firmware` writes the controller as one header without heap and without a library, and an interface in C. Firmware
# uses `float`; here `double` makes the check exact: the compiled step runs in the simulated drive.

# %%
written = sw.export.firmware(drive, "firmware", name="elbow", scalar="double")
print(*sorted(path.name for path in Path("firmware").iterdir()))
if shutil.which("c++"):
    flags = "-std=c++20 -O2 -ffreestanding -ffp-contract=off -fno-exceptions -fno-rtti -fPIC -shared"
    subprocess.run(["c++", *flags.split(), "firmware/elbow.cpp", "-o", "elbow.so", "-lm"], check=True)
    library = ctypes.CDLL("./elbow.so")
    library.elbow_step.restype = ctypes.c_double  # the current
    state = (ctypes.c_double * len(written.state))()
    library.elbow_start(state)

    def firmware(readings):
        return library.elbow_step(state, (ctypes.c_double * len(written.inputs))(*readings[1:]))  # all but the time

    swing = sw.scenario.sine(amplitude=0.5, frequency=0.5, duration=2.0)
    plant = drive.replace(control=sw.control.OpenLoop())
    by_firmware = sw.simulate_controlled(plant, firmware, swing, period=1e-3, sample=1e-3)
    simulated = sw.simulate(drive, swing, sample=1e-3)
    print("the same to the last bit:", np.array_equal(by_firmware["output_angle"], simulated["output_angle"]))

# %% [markdown]
# In your firmware, call `elbow_start` once and `elbow_step` in each period. `elbow.h` lists the inputs with their units.
#
# ## Feed-forward: let the controller supply what the gear takes
#
# `ModelFeedforward` solves the equations of the gear along the command: torque, friction, twist and kinematic error. It is a
# part of the sampled controller, and so of the firmware too.

# %%
model = sw.compensation.ModelFeedforward(gear=found.gear, load=load, motor_inertia=motor.inertia)
part = sw.Compensation(feedforward=model, actuation_per_torque=1.0 / motor.torque_constant)  # A/(N.m)
helped = drive.replace(control=control.replace(compensation=part))
move = sw.scenario.sine(amplitude=0.4, frequency=0.25, duration=8.0, phase=-np.pi / 2, offset=0.4)  # begins at rest

figure, axes = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
for label, each in (("controller alone", drive), ("with feed-forward", helped)):
    run = sw.simulate(each, move, sample=1e-3).between(4.0, 8.0)
    error = 1e6 * (run["command"] - run["output_angle"])
    print(f"{label}: {np.sqrt(np.mean(error**2)):.0f} µrad rms")
    axes.plot(run.time, error, label=label)
axes.set(xlabel="time [s]", ylabel="command - output [µrad]", title="Feed-forward of the model of the gear")
axes.legend()

# %% [markdown]
# Here the joint is exactly the model. A real joint is not: stiffness and hysteresis are assumed in this file, and the gain
# is smaller. `strainwave compensate elbow.toml` tries many compensations on gears drawn from the uncertainty of the file,
# and keeps those that gain on them.
#
# ## What can go wrong
#
# | message or effect | cause, and what to do |
# |---|---|
# | `… has no [motor] and no [load]` | Add the parts, as above, or begin from a drive (`strainwave list drives`). |
# | `there is no C++20 compiler …` | `pip install 'strainwave[compiler]'`, or export sources: `--platform source` of an FMU. |
# | `drive.control = … must be sampled` | Put the law into `sw.control.Sampled`, and simulate it so too. |
# | firmware gives other numbers | `-ffp-contract=off` is missing, or the period differs from that in the header. |
# | a joint in MuJoCo creeps | `frictionloss` is soft. Copy `solimpfriction` and `solreffriction` of `joint.xml`, too. |
#
# ## Where to go on
#
# * [From a measurement to another program](../../docs/how-to/exports.md): all exports, and what each loses.
# * [MuJoCo and URDF](../../docs/how-to/mujoco.md), [FMU](../../docs/how-to/fmu.md), [firmware](../../docs/how-to/firmware.md).
# * [Compensate torsion, friction and kinematic error](../../docs/how-to/compensate.md).
