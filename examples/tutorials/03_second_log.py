# %% [markdown]
# # Check a gear against a second log
#
# At the end you know whether a joint still agrees with its gear file, and if not, what changed. It takes ten minutes. You
# need `strainwave` and an empty folder with the files above.
#
# [Tutorial 1](01_robot_log.py) made a gear file from a log. Two questions remain. Does it predict another motion? And half a
# year later: is it still the same joint?
#
# ## 1. The saved joint
#
# As in tutorial 1. The file contains the numbers, their covariance, and the error on its own log.

# %%
import matplotlib.pyplot as plt
import strainwave as sw

stated = sw.FileMapping(constants={"torque_constant": 0.0755})
found = sw.identify("hfuc-20-80", ["robot_log.csv"], mapping=stated, name="joint 2")
found.gear_set.save("joint_2.toml")

# %% [markdown]
# In a terminal, the same is `strainwave identify hfuc-20-80 robot_log.csv --constant torque_constant=0.0755 --name "joint 2"
# --out mine`, and then `cp mine/gear.toml joint_2.toml`.
#
# ## 2. The same joint, another motion
#
# `robot_log_later.csv` was recorded after half an hour, with a smaller motion. `predict` takes the options that `identify`
# had, because it reads files in the same way.

# %% [console]
# $ strainwave predict joint_2.toml robot_log_later.csv --constant torque_constant=0.0755 --out later || echo "exit code $?"

# %% [markdown]
# It **agrees**. Read it from the top:
#
# * **The error** of the current, and the error that is allowed: twice that of the joint on its own log. A larger one
#   contradicts the joint.
# * **Plain least squares on this file**: offset, inertia, gravity, Coulomb and viscous friction, fitted to *this*
#   recording. The saved joint was not fitted to it, and still predicts it better.
# * **Seven quantities** that may have changed: friction and load as multiples of the saved ones, two zeros and a delay. A
#   change is significant if it exceeds three standard deviations and 3 %; a delay, half a sample.
# * **Lines of the residual**: what is left repeats twice and four times a revolution of the motor. This is the kinematic
#   error of the gear. One log of one encoder shows its orders, not its amplitude.
#
# ## 3. A worn joint, and a joint with a tool
#
# Two logs of later days. In one, the friction of the joint has grown. In the other, somebody mounted a tool on the arm.

# %%
logs = ["robot_log_later.csv", "robot_log_worn.csv", "robot_log_tool.csv"]
predictions = sw.predict("joint_2.toml", logs, mapping=stated)

for file, each in zip(logs, predictions, strict=True):
    print(f"{file}: {each.verdict}: error {each.error:.3f} A, {each.allowed:.3f} A allowed")
    for change in each.changed:
        print(f"  {change.name} is {change.value:.3f} ± {change.sigma:.3f} times that saved")

# %% [markdown]
# Read both lines of a file, not the first alone:
#
# * **The tool contradicts** the saved joint: inertia and gravity are larger, friction is the same.
# * **The worn joint differs, within the allowed error.** 0.24 A is less than twice the error on the joint's own log. The list
#   of changes is finer than the error. It finds 30 % more friction, because friction follows the sign of the speed in the whole
#   log. So a maintenance script should look at `verdict` and `changed`, not only at the exit code.
#
# The command prints the same, with everything that did *not* change, and its exit code is 3 if a recording contradicts:

# %% [console]
# $ strainwave predict joint_2.toml robot_log_tool.csv --constant torque_constant=0.0755 --out tool || echo "exit code $?"

# %% [markdown]
# A change has a shape in the residual: friction follows the sign of the speed, a load follows the angle.

# %%
figure, panels = plt.subplots(len(logs), 1, sharex=True, sharey=True, figsize=(8.0, 6.0), layout="constrained")
figure.suptitle("Measured less predicted current")
for axes, file, each in zip(panels, logs, predictions, strict=True):
    axes.plot(each.curves["time"], each.curves["residual"], linewidth=0.6, color="black")
    axes.axhspan(-each.allowed, each.allowed, color="gray", alpha=0.2)
    axes.set(ylabel="[A]", title=file)
_ = panels[-1].set(xlabel="time [s]")

# %% [markdown]
# The grey band is the error that is allowed. The tool leaves a slow wave that follows the angle of the arm: gravity. The worn
# joint leaves steps that change their sign with the direction of motion.
#
# ## 4. Compare with the truth
#
# **The logs are simulated**, by a program that shares nothing with `strainwave`. The truth of the three joints:
#
# | log | truth | found |
# |---|---|---|
# | `…_later.csv` | nothing changed | no significant change |
# | `…_worn.csv` | Coulomb and breakaway torque 1.3 times as large | dry friction |
# | `…_tool.csv` | gravity 1.455 times as large: 16 in place of 11 N·m | gravity of the load |
# | | inertia with the rotor 1.188 times as large: 1.580 in place of 1.330 kg·m² | inertia of the load |
#
# ## 5. Now your own joint
#
# * **Save the joint from a log that is long and varied.** Its error on its own log limits what a later recording can
#   contradict.
# * **Record at the same temperature**, or compare after the same time of running: warm grease has less viscous friction.
# * **Give the same torque constant as before.** If all torques change by one factor, a message names the sensor or the
#   torque constant.
# * **If no change explains the error**, a message states that. The log is then of another joint, or a column or unit
#   differs from the first log.
#
# All messages, and what `predict` compares of other files, are in [Compare a later recording with a saved
# joint](../../docs/how-to/predict.md).
