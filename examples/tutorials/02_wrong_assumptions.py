# %% [markdown]
# # Five wrong assumptions and what you see
#
# At the end you know what `strainwave` prints if a unit, a side or a file is wrong, and which error no check can find. It
# takes 15 minutes. You need `strainwave` and an empty folder with the files above.
#
# Measurement files lack units, and an angle may be that of the motor or of the joint. Most wrong assumptions contradict the
# numbers of the file. Then a **check** fails: it is printed first, no `gear.toml` is written, and the exit code is 3. In
# the commands below, `|| echo` prints the exit code if it is not 0.
#
# ## 1. The unit of the speed
#
# `friction.csv` is a table of the friction of a gear, measured at the motor's side. Its first line has the units. A colleague
# sends it without them, and writes that the speed is in rad/s. In fact it is in 1/min.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import strainwave as sw

table = Path("friction.csv").read_text()
Path("friction_colleague.csv").write_text(table.replace("speed [1/min]", "speed").replace("torque [N.m]", "torque"))
print(table[:60])

# %% [console]
# $ strainwave identify hfuc-20-80 friction_colleague.csv || echo "exit code $?"

# %% [markdown]
# The numbers alone do not determine the unit of a speed. So `strainwave` asks, and shows what each unit would mean. Now
# with the wrong one:

# %% [console]
# $ strainwave identify hfuc-20-80 friction_colleague.csv --unit speed=rad/s --unit torque=N.m || echo "exit code $?"

# %% [markdown]
# The check `input speed` fails, because no strain wave gear turns that fast. The numbers below it show the same error: a
# Stribeck speed of 30 rad/s is ten times too large.
#
# ## 2. The side
#
# The same table with its units, but stated to be measured at the joint, behind the gear: `strainwave identify hfuc-20-80
# friction.csv --side output` ends with exit code 3. From here on in Python: `failed` has the checks that the command prints
# after `FAILED`.

# %%
stated = sw.FileMapping(side="output")
found = sw.identify("hfuc-20-80", ["friction.csv"], mapping=stated)
for check in found.failed:
    print(f"{check.name}: {check.message}")

# %% [markdown]
# Two checks fail. The second compares the friction with that of the catalogue set: a gear of the same size has a similar
# friction, not a thousandth of it. This is why the set to start from matters.
#
# ## 3. Degrees in place of radians
#
# The header of this log states radians. The numbers are degrees.

# %%
rows = Path("robot_log.csv").read_text().splitlines()
numbers = [[float(text) for text in row.split(",")] for row in rows[1:]]
degrees = [f"{t:.2f},{57.29578 * q:.4f},{57.29578 * qd:.2f},{current}" for t, q, qd, current in numbers]
Path("robot_log_degrees.csv").write_text("\n".join([rows[0], *degrees]) + "\n")
print(*[rows[0], *degrees[:2]], sep="\n")

# %%
stated = sw.FileMapping(constants={"torque_constant": 0.0755})
found = sw.identify("hfuc-20-80", ["robot_log_degrees.csv"], mapping=stated)
for check in found.failed:
    print(f"{check.name}: {check.message}")

# %% [markdown]
# One wrong unit fails several checks at once. Read them together: a speed of 82 000 1/min and a model that predicts worse
# than a constant both point to the angle. If you leave the unit out of the header (`q` in place of `q [rad]`), the unit is
# chosen that predicts best, with a remark.
#
# ## 4. A file of another joint
#
# `friction_other_joint.csv` was measured on another joint of the robot, with a larger gear. Somebody put both files into one
# folder.

# %%
found = sw.identify("hfuc-20-80", ["friction.csv", "friction_other_joint.csv"])
for check in found.failed:
    print(f"{check.name}: {check.message}\n  what to do: {check.remedy}")

# %% [markdown]
# The results of both files differ by far more than two runs of one gear do. **Smaller differences pass:** friction changes
# with temperature, lubricant and run-in. Two tables may differ by up to about 60 % before the check fails. So the check
# does not find a joint of the same size with similar friction.
#
# ## 5. The torque constant
#
# The last one is twice as large as it should be: 0.151 N·m/A in place of 0.0755.

# %%
figure, panels = plt.subplots(2, 1, sharex=True, figsize=(8.0, 4.2), layout="constrained")
figure.suptitle("Both torque constants predict the current equally well")
for axes, constant in zip(panels, (0.0755, 0.151), strict=True):
    stated = sw.FileMapping(constants={"torque_constant": constant})
    found = sw.identify("hfuc-20-80", ["robot_log.csv"], mapping=stated)
    print(f"{constant} N.m/A: {len(found.failed)} failed checks")
    rigid = [parameter for parameter in found.parameters if "detent" not in parameter.estimate.path]
    for parameter in rigid:
        print(f"  {parameter.estimate.path:30} {parameter.estimate.value:.4g} {parameter.estimate.unit}")
    curves = found.files[0].pictures[0].curves.between(20.0, 30.0)
    axes.plot(curves["time"], curves["current"], linewidth=1.5, alpha=0.5, label="measured")
    axes.plot(curves["time"], curves["modelled"], linewidth=0.8, label="predicted")
    axes.set(ylabel="current [A]", title=f"{constant} N·m/A")
panels[0].legend(ncols=2)
_ = panels[1].set(xlabel="time [s]")

# %% [markdown]
# **No check fails, and none can.** With twice the torque constant, inertia, gravity and friction are about twice as large, and
# the predicted current is the same. A wrong ratio with an angle behind the gear is of the same sort. What you can do:
#
# * **Compare the gravity torque with what you know**: weight of the arm times the distance of its centre. Here it is 11 N·m,
#   and not 22.
# * **Record the voltage too**: the voltage that the motor induces determines the torque constant, and a check compares both.
# * **Add a known mass** and record again: the gravity torque must grow by what the mass weighs.
#
# ## And a wrong sign?
#
# A wrong sign is repaired, not refused. In `robot_log.csv` a positive current turns the joint forward. `strainwave` counts it
# at the motor, and the output of this gear turns against its motor. The remark of `identify` is `current is counted in the
# sense of the output, which turns against the input: its sign is turned round`.
#
# ## In short
#
# | exit code | what happened | what to do |
# |---|---|---|
# | 0 | no contradiction was found | read the reasons and remarks; compare gravity or inertia with what you know |
# | 2 | no file can be used | the message has the option that is missing |
# | 3 | a check failed | see *what to do* below it; `--accept` writes the gear all the same, with a note |
#
# [All checks](../../docs/reference/identify.md#checks) are listed with their limits.
