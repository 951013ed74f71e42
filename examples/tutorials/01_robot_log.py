# %% [markdown]
# # A robot's log to a gear in ten minutes
#
# At the end you have a gear file of a robot joint: its friction, inertia and gravity, each with a standard deviation, from
# one log of its controller. You need `strainwave` and an empty folder with the files above.
#
# Each step is a command for the terminal, after a `$`, or Python. Where both do the same, one is enough.
#
# ## 1. Look at the log
#
# A controller recorded a joint of a robot for 30 s while no other joint moved. `q` and `qd` are angle and speed of the joint,
# behind the gear. `current` is the motor's.

# %% [console]
# $ head -n 3 robot_log.csv

# %%
import matplotlib.pyplot as plt
import numpy as np
import strainwave as sw

log = sw.Recording.from_csv("robot_log.csv")
figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(8.0, 4.2), layout="constrained")
figure.suptitle("The log of the joint")
above.plot(log["t"], log["q"])
above.set(ylabel="joint angle q [rad]")
below.plot(log["t"], log["current"], linewidth=0.7)
below.set(ylabel="motor current [A]", xlabel="time [s]")

# %% [markdown]
# The joint moves both ways, slowly and fast, and through a large angle. A log of your own should do the same for half a
# minute or more.
#
# ## 2. Identify the joint
#
# Three facts are not in the log. You find the first two on data sheets:
#
# * **The gear.** The joint has a strain wave gear of size 20 and ratio 80. `strainwave list gears 20-80` lists the sets
#   of this size; `hfuc-20-80` is one of them. Its numbers are the start; those that the log determines are replaced.
# * **The torque constant** of the motor, 0.0755 N·m/A. Without it all torques are in A.
# * **The side** of the angle: in front of the gear or behind it. Here the names `q` and `qd` are enough, because robots name
#   joint angles so.

# %% [console]
# $ strainwave identify hfuc-20-80 robot_log.csv --constant torque_constant=0.0755 --name "joint 2" --out mine

# %% [markdown]
# From top to bottom:
#
# * `since …`: the type of the file, and the reasons. **Read these lines first.** If the type is wrong, all numbers are.
# * `Coulomb and viscous, a delay, …`: the model. Effects are added as long as they improve the prediction.
# * `RMS error on held-out data: …`: the model was fitted to the first 70 % of the motion and predicts the last 30 %. Beside
#   it is what plain least squares leaves, then the share of the current that is not predicted.
# * `current comes … behind`: this controller averages the current over its period of 10 ms, so the current is 5 ms late.
#   The delay is estimated and corrected.
# * `the inertia of the motor …`: the log cannot separate the rotor from the load. The inertia below is that of the load,
#   plus that of the rotor times 80².
# * `current is counted in the sense of the output …`: in `strainwave` a positive current turns the motor forward, and the
#   output of this gear turns against its motor. In this robot a positive current turns the joint forward. This is detected
#   and corrected.
# * `the residual has a shape over the speed …`: a small part repeats, so it is no noise. The gear of this joint is
#   elastic and has a kinematic error, and this model has neither.
# * The numbers: value ± standard deviation. The friction is at the motor's side; multiply it by 80 for the joint.
#
# The exit code is 0. It is 3 if a check finds a contradiction, and then there is no `gear.toml`: [five wrong
# assumptions](02_wrong_assumptions.py).
#
# ## 3. Open the report
#
# `mine/report.html` has the pictures, the parameters and the checks in one file. Its most important picture is the measured
# and the predicted current. In Python:

# %%
stated = sw.FileMapping(constants={"torque_constant": 0.0755})
found = sw.identify("hfuc-20-80", ["robot_log.csv"], mapping=stated, name="joint 2")
curves = found.files[0].pictures[0].curves

figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(8.0, 5.0), layout="constrained", height_ratios=(2, 1))
figure.suptitle("Measured and predicted current")
above.plot(curves["time"], curves["current"], linewidth=1.5, alpha=0.5, label="measured")
above.plot(curves["time"], curves["modelled"], linewidth=0.8, label="predicted")
above.set(ylabel="motor current [A]")
below.plot(curves["time"], curves["current"] - curves["modelled"], linewidth=0.6, color="black")
below.set(ylabel="difference [A]", xlabel="time [s]")
held_out = curves["time"][curves["held_out"] > 0.0]
for axes in (above, below):
    axes.axvspan(held_out[0], held_out[-1], color="gray", alpha=0.15, label="held out")
_ = above.legend(ncols=3)

# %% [markdown]
# A good difference looks like noise and is no larger in the grey part, which was not fitted. Here a part of the difference
# is noise of the current sensor, 0.06 A.
#
# ## 4. Which numbers are determined, and which are not
#
# A gear has more numbers than one log determines. `identify` states for each if it is determined:

# %%
shown = ("coulomb", "breakaway", "viscous", "k1", "amplitude[0]")
for each in found.states:
    if each.path.startswith(("gear.friction_input", "gear.stiffness", "gear.kinematic_error")) and each.path.endswith(shown):
        sigma = f"± {each.sigma:.2g}" if each.sigma > 0.0 else ""
        print(f"{each.path:34} {each.value:<9.4g} {sigma:10} {each.state}")

# %% [markdown]
# * **identified** with a standard deviation: the log determines it.
# * **kept**: the log does not determine it. A log of one encoder does not show stiffness and kinematic error, so they are
#   those of the catalogue, or assumed.
# * **breakaway** has no standard deviation: it was set equal to the Coulomb torque, because the log shows no fall of the
#   friction at low speed. A [table of friction](05_which_friction.py) determines it.
#
# For each number that is not determined, the report lists the measurement that determines it.
#
# ## 5. Use the gear
#
# The command wrote `mine/gear.toml`. In Python:

# %%
found.gear_set.save("joint_2.toml")
drive = sw.load("joint_2.toml")

speed = 2000.0 * 2.0 * np.pi / 60.0  # rad/s, 2000 1/min of the motor
print(f"friction at 2000 1/min: {drive.gear.friction_input.steady(speed):.4f} N.m at the motor")
print(f"load: {drive.load.inertia:.3f} kg.m2, {drive.load.gravity_torque:.2f} N.m")

# %% [markdown]
# The file is a drive: gear, motor and load, with the source of each number. `strainwave show` prints it, `strainwave predict`
# compares it with [a second log](03_second_log.py), and [other programs](../../docs/how-to/exports.md) take it.
#
# ## 6. Compare with the truth
#
# **This log is simulated**, so the truth is known. A program that shares nothing with `strainwave` wrote it, with noise and
# quantisation of its sensors. Its joint has friction that falls from 0.062 N·m at rest to 0.047 N·m, a spring of three
# segments with hysteresis, and a kinematic error.

# %%
ratio = 80.0
rotor = 9.43e-5 - drive.gear.input_inertia  # kg.m2, of the motor without the wave generator
truth = {
    "gear.friction_input.coulomb": 0.047,
    "gear.friction_input.viscous": 2.9e-4,
    "load.inertia": 0.85 + rotor * ratio**2,
    "load.gravity_torque": 11.0,
    "load.gravity_phase": 0.0,
}
print(f"{'':30} {'identified':>10} {'truth':>9}  standard deviations apart")
for parameter in found.parameters:
    estimate = parameter.estimate
    distance = (estimate.value - truth[estimate.path]) / estimate.sigma
    print(f"{estimate.path:30} {estimate.value:10.4g} {truth[estimate.path]:9.4g} {distance:10.1f}")

# %% [markdown]
# **Viscous friction is 5 % too low**, and Coulomb friction 2 % too high. Their standard deviations contain this: another law of
# friction predicts the log as well, and its numbers lie as far apart. The cause is the rate of the log, 100 samples a second:
# at a reversal the friction changes its sign between two of them. So **record faster** if you can, or [add a table of
# friction](05_which_friction.py).
#
# ## 7. Now your own log
#
# | your log | what to add |
# |---|---|
# | columns without units | `--unit q=deg`, if the command asks, or if a remark names a unit that was assumed |
# | the torque of the joint in place of a current | nothing: `tau` or `effort` are found; the torque constant is not needed |
# | all joints of the robot in one file | `--joint 2`, or `--joint all` for every joint |
# | no header at all | `--column current=NAME`, with the name that the message proposes |
# | rows without time | `--constant rate=500`: samples per second |
# | another ratio than the catalogue set | `--constant ratio=101` |
# | the motor's angle | `--column input_angle=NAME` |
#
# **What can go wrong.** If a large share is unexplained, other joints may have moved, or the motion was too small. A log of
# one direction does not separate Coulomb friction from the zero of the current. [Identify a gear from
# measurements](../../docs/how-to/identify.md) has the details.
