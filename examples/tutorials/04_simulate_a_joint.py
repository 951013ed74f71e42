# %% [markdown]
# # Simulate a joint and read what the gear does to it
#
# At the end you recognise the four effects of a strain wave gear: kinematic error, wind-up, hysteresis and friction. You
# know the share of each in the error of a joint, and the speed at which the gear makes the joint vibrate.
#
# **Time:** 15 minutes. **You need:** strainwave and matplotlib; no measurement, no compiler.

# %% [markdown]
# ## A joint
#
# A catalogue set has the gear: ratio, stiffness, hysteresis, friction, kinematic error. You add motor, controller and arm.
# The numbers here are those of a shoulder with an arm of 3 kg·m². All units are SI: rad, N·m, s, A.

# %%
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np
import strainwave as sw

gear = sw.load("csg-25-100")
joint = sw.Drive(
    gear=gear,
    motor=sw.motor.CurrentSource(torque_constant=0.06, inertia=6e-5),
    control=sw.control.PositionSpeed(
        position_gain=20.0, speed_proportional=2.0, speed_integral=25.0, speed_feedforward=1.0, limit=60.0
    ),
    load=sw.loads.Pendulum(inertia=3.0, gravity_torque=40.0),
)
print("ratio", gear.kinematics.ratio)
print("stiffness", gear.stiffness)
print("friction", gear.friction_input)

# %% [markdown]
# The ratio is negative: in this gear the circular spline is fixed, and the output turns against the motor. Friction is that
# of the input; at the output it counts with the ratio, 0.09 N·m as 9 N·m.
#
# The controller reads the encoder of the motor only, as in most joints. So it corrects the angle of the *motor*, and not
# what the gear does behind it.
#
# ## A move
#
# The arm swings slowly to and fro by 0.5 rad. The command is the angle of the output. `initial` starts the arm where the
# command begins, wound up by its weight; else the joint starts at zero and jumps to the command.

# %%
move = sw.scenario.sine(amplitude=0.5, frequency=0.1, duration=15.0, phase=-np.pi / 2)
start = {"output_angle": -0.5}
run = sw.simulate(joint, move, sample=1e-3, initial=start).between(5.0, 15.0)
error = run["command"] - run["output_angle"]
print(f"error of the output: {1e6 * np.sqrt(np.mean(error**2)):.0f} µrad rms, {1e6 * np.abs(error).max():.0f} µrad at most")

figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(8.0, 5.0), layout="constrained")
upper.plot(run.time, run["output_angle"])
upper.set(ylabel="output angle [rad]", title="The arm follows its command, but for an error")
lower.plot(run.time, 1e6 * error)
lower.set(xlabel="time [s]", ylabel="command - output [µrad]")

# %% [markdown]
# `between` leaves out the first five seconds, in which the loop settles. The error looks confused because it contains four
# effects. The next sections take them one by one.
#
# ## Kinematic error: a ripple with the angle of the motor
#
# With an encoder on each shaft you can measure the *transmission error*: input angle over ratio, less output angle. It is the
# sum of the kinematic error and the twist of the gear. A recording has all three columns.

# %%
total = run["input_angle"] / gear.kinematics.ratio - run["output_angle"]
print("transmission error = kinematic error + twist:", np.allclose(total, run["kinematic_error"] + run["twist"], atol=1e-12))

forward = run.between(5.5, 9.5)  # the arm moves one way
(order_1, order_2) = sw.orders.order_amplitudes(forward, "transmission_error", [1.0, 2.0]).amplitude
print(f"amplitude of order 1: {1e6 * order_1:.1f} µrad, of order 2: {1e6 * order_2:.1f} µrad")
print(f"the gear file states for order 2: {1e6 * gear.kinematic_error.amplitude[0]:.1f} µrad")

turns = np.abs(forward["input_angle"] - forward["input_angle"][0]) / (2.0 * np.pi)
figure, axes = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
for name in ("transmission_error", "twist", "kinematic_error"):
    axes.plot(turns, 1e6 * forward[name], label=name.replace("_", " "))
axes.set(xlabel="turns of the motor", ylabel="at the output [µrad]", xlim=(5.0, 10.0), ylim=(-400.0, 400.0))
axes.set_title("The kinematic error repeats twice in a turn of the motor")
axes.legend()

# %% [markdown]
# *Order 2* means: twice in each turn of the motor, because the wave generator has two lobes. The amplitude in the
# transmission error is larger than that of the gear file. The ripple shakes the arm a little, and this twists the gear.
# Near a resonance it does this much more.
#
# ## Wind-up and hysteresis: the twist under load
#
# The weight of the arm twists the gear. Over the torque, the twist is a loop: on the way back the gear keeps a part of its
# twist.

# %%
at_zero = np.flatnonzero(np.diff(np.sign(run["torque"])))
print(f"torque from {run['torque'].min():.1f} to {run['torque'].max():.1f} N.m")
print(f"twist from {1e6 * run['twist'].min():.0f} to {1e6 * run['twist'].max():.0f} µrad")
lost = run["twist"][at_zero]
print(f"twist where the torque passes zero: {1e6 * lost.min():.0f} and {1e6 * lost.max():.0f} µrad")

figure, axes = plt.subplots(figsize=(6.0, 5.0), layout="constrained")
axes.plot(1e6 * run["twist"], run["torque"], label="with hysteresis")
spring = np.linspace(run["twist"].min(), run["twist"].max(), 200)
axes.plot(1e6 * spring, gear.stiffness.torque(spring), "--", label="the spring of the gear alone")
axes.set(xlabel="twist [µrad]", ylabel="torque [N.m]", title="Wind-up, and the loop of the hysteresis")
axes.legend()

# %% [markdown]
# The width at zero torque is the lost motion that hysteresis makes. The small teeth inside the loop come from order 2: the
# ripple reverses the twist for a moment, and each reversal has its own small loop.
#
# ## Friction: the reversal
#
# Where the arm turns round, the friction of the input changes its sign. Until the controller has built up the torque, the
# motor rests, and so does the arm.

# %%
around = run.between(9.6, 10.4)
stands = around["input_speed"] == 0.0
print(f"the motor rests for {1e3 * np.count_nonzero(stands) * 1e-3:.0f} ms")
print(f"friction torque from {around['friction_input'].min():.3f} to {around['friction_input'].max():.3f} N.m at the input")

figure, panels = plt.subplots(3, 1, sharex=True, figsize=(8.0, 6.0), layout="constrained")
panels[0].plot(around.time, around["input_speed"])
panels[0].set(ylabel="motor [rad/s]", title="The motor sticks where the motion turns round")
panels[1].plot(around.time, around["friction_input"])
panels[1].set(ylabel="friction [N.m]")
panels[2].plot(around.time, 1e6 * (around["command"] - around["output_angle"]))
panels[2].set(xlabel="time [s]", ylabel="error [µrad]")

# %% [markdown]
# ## Resonance: where the ripple meets the arm
#
# Spring and arm vibrate at an eigenfrequency. Order 2 meets it when the motor turns at half of it. `sw.analysis.modes`
# computes it, and a run-up shows it: the speed of the motor grows steadily. The arm turns in a horizontal plane, so that its
# weight does not load the spring.

# %%
flat = joint.replace({"load.gravity_torque": 0.0})  # the arm turns in a horizontal plane
(mode,) = sw.analysis.modes(flat)["input held"]
(sliding,) = sw.analysis.modes(flat.replace({"gear.hysteresis": sw.hysteresis.MaxwellSlip()}))["input held"]
print(f"eigenfrequency with the motor held: {mode:.0f} rad/s; order 2 meets it at {mode / 2:.0f} rad/s of the motor")
print(f"without hysteresis: {sliding:.0f} rad/s; order 2 meets it at {sliding / 2:.0f} rad/s of the motor")

time = np.linspace(0.0, 12.0, 1201)
slow, fast = 20.0, 120.0  # rad/s of the motor
angle = (slow * time + 0.5 * (fast - slow) * time**2 / time[-1]) / abs(gear.kinematics.ratio)
turning = {"output_angle": 0.0, "output_speed": slow / abs(gear.kinematics.ratio)}
run_up = sw.simulate(flat, sw.scenario.table(time, angle), sample=1e-3, initial=turning)

ends = np.searchsorted(np.abs(run_up["input_angle"]) / (2.0 * np.pi), np.arange(5.0, 130.0, 3.0))
stretches = [run_up.between(run_up.time[a], run_up.time[b]) for a, b in pairwise(ends)]
speed = np.array([np.abs(each["input_speed"]).mean() for each in stretches])
ripple = np.array([sw.orders.order_amplitudes(each, "torque", [2.0]).amplitude[0] for each in stretches])
print(f"largest ripple of the torque: {ripple.max():.1f} N.m, at {speed[ripple.argmax()]:.0f} rad/s")

figure, axes = plt.subplots(figsize=(8.0, 4.0), layout="constrained")
axes.plot(speed, ripple, "o-")
axes.axvline(mode / 2.0, linestyle="--", color="gray", label="half the eigenfrequency, hysteresis sticks")
axes.axvline(sliding / 2.0, linestyle=":", color="gray", label="half the eigenfrequency, without hysteresis")
axes.set(xlabel="speed of the motor [rad/s]", ylabel="order 2 of the torque [N.m]", title="A run-up passes the resonance")
axes.legend()

# %% [markdown]
# The peak lies between the two lines. In small motion the elements of the hysteresis stick and add their stiffness to that
# of the spring; `sw.analysis.modes` computes this case. In larger motion they slide, and the gear is softer. So the resonance
# of a gear moves with the amplitude, and no linear model has the right value.
#
# ## The share of each effect
#
# Each effect is switched off alone, and then left as the only one. `replace` makes a changed copy of the drive; paths name
# the part.

# %%
switched_off = {
    "kinematic error": {"gear.kinematic_error": sw.kinematic_error.Fourier()},
    "wind-up": {"gear.stiffness": sw.stiffness.Linear(k=1e7)},  # N.m/rad, 200 times as stiff
    "hysteresis": {"gear.hysteresis": sw.hysteresis.MaxwellSlip()},
    "friction": {"gear.friction_input": sw.friction.Viscous()},
}


def rms_error(changes):
    """Return the rms of command less output [µrad] of the joint with these changes."""
    changed = sw.simulate(joint.replace(changes), move, sample=1e-3, initial=start).between(5.0, 15.0)
    return 1e6 * np.sqrt(np.mean((changed["command"] - changed["output_angle"]) ** 2))


everything = rms_error({})
without = {name: rms_error(change) for name, change in switched_off.items()}
alone = {}
for name in switched_off:
    others = {}
    for other, change in switched_off.items():
        if other != name:
            others |= change
    alone[name] = rms_error(others)
print(f"all effects: {everything:.0f} µrad rms")
for name in switched_off:
    print(f"{name:16} without it {without[name]:4.0f} µrad, it alone {alone[name]:4.0f} µrad")

figure, axes = plt.subplots(figsize=(8.0, 3.5), layout="constrained")
place = np.arange(len(switched_off))
axes.barh(place - 0.2, without.values(), 0.4, label="without this effect")
axes.barh(place + 0.2, alone.values(), 0.4, label="this effect alone")
axes.axvline(everything, color="black", linestyle="--", label="all effects")
axes.set_yticks(place, switched_off)
axes.invert_yaxis()
axes.set(xlabel="error of the output [µrad rms]", title="What each effect does to the error")
figure.legend(loc="outside lower center", ncols=3)

# %% [markdown]
# Here the weight of the arm makes most of the error, by wind-up. The shares do not add up. The elements of the hysteresis
# carry a part of the load, so the twist is larger without them. Friction acts at the reversal only, and there the loop reacts
# to it.
#
# ## What can go wrong
#
# | message or effect | cause, and what to do |
# |---|---|
# | `dt = … s is too coarse …` | A part is very stiff or very light. Give the step of the message, or look for a wrong unit. |
# | the joint jumps at the start | The command does not begin at 0: give `initial={"output_angle": …}`. |
# | a twist of the wrong sign | The output turns against the motor if the circular spline is fixed: the ratio is negative. |
# | a ripple without a fault | Catalogue sets have an assumed `kinematic_error`; the gear file marks it. |
#
# ## Where to go on
#
# * [Simulate a drive](../../docs/how-to/simulate.md): steps, scenarios, temperature, noise.
# * [The parts of a drive](../../docs/how-to/drives.md): other motors, controllers, loads and sensors.
# * [Which model when](../../docs/how-to/which-model.md): friction and hysteresis that fit your joint.
# * [Compensate torsion, friction and kinematic error](../../docs/how-to/compensate.md): what a
#   controller can remove of this error.
