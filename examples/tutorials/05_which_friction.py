# %% [markdown]
# # Which friction does my joint have?
#
# At the end you have a friction law for your joint, chosen by its predictions. You also know what your data do not
# separate. It takes 15 minutes. You need `strainwave` and an empty folder with the files above.
#
# ## 1. A table of friction
#
# `friction.csv` is a table of 13 speeds in both directions. In each row the motor turned the gear at one speed, with
# nothing at the output, and the torque was averaged. `--rank` fits every law to it, and computes the error on rows that were
# not fitted.

# %% [console]
# $ strainwave identify hfuc-20-80 friction.csv --rank

# %% [markdown]
# | column | meaning |
# |---|---|
# | `numbers` | fitted numbers of the law |
# | `error held out` | each tenth of the rows is predicted from the rest; root mean square, ± its standard error |
# | `residuals together` | how many neighbouring rows are wrong in the same sense; if more than 1, the law lacks something |
# | `cost` | time of the law in a simulation, for each evaluation |
#
# Take the law in the first line: the **simplest law whose error exceeds the smallest by no more than chance explains**.
# Laws without a fall at low speed have an error about four times as large. Laws with more numbers than the first gain
# nothing.
#
# ## 2. Look at the laws
#
# `sw.fit` fits a law that you choose. Three laws, over the speed and over its logarithm:

# %%
import matplotlib.pyplot as plt
import numpy as np
import strainwave as sw

table = sw.Recording.from_csv("friction.csv")
speed, torque = table["speed"] * 2.0 * np.pi / 60.0, table["torque"]  # 1/min to rad/s
measured = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
laws = {
    "Coulomb and viscous": sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=3e-4),
    "curved viscous": sw.friction.CurvedViscous(coulomb=0.05, viscous_torque=0.03, exponent=0.7, reference_speed=100.0),
    "with a fall at low speed": sw.friction.Stribeck(coulomb=0.05, breakaway=0.06, stribeck_speed=5.0, viscous=3e-4),
}
free = {
    "Coulomb and viscous": ["coulomb", "viscous"],
    "curved viscous": ["coulomb", "viscous_torque", "exponent"],
    "with a fall at low speed": ["coulomb", "breakaway", "stribeck_speed", "viscous"],
}
gear = sw.load("hfuc-20-80")
fits = {
    name: sw.fit(gear.replace(friction_input=law), measured, [f"friction_input.{each}" for each in free[name]])
    for name, law in laws.items()
}

figure, panels = plt.subplots(1, 2, sharey=True, figsize=(9.0, 4.0), layout="constrained")
figure.suptitle("Three friction laws on one table")
grid = np.geomspace(0.3, 320.0, 400)
for axes, scale in zip(panels, ("linear", "log"), strict=True):
    axes.plot(np.abs(speed), np.abs(torque), "o", color="black", markersize=3.5, label="measured, both directions")
    for name, fit in fits.items():
        axes.plot(grid, fit.model.friction_input.steady(grid), linewidth=1.2, label=name)
    axes.set(xscale=scale, xlabel="speed of the input [rad/s]")
panels[0].set(ylabel="friction torque [N·m]")
_ = panels[0].legend(fontsize="small")

# %% [markdown]
# On the left, all laws look alike. The logarithm shows the difference: below 5 rad/s (50 1/min) the friction rises toward
# rest. Two laws cannot follow, and are too high at 5 to 50 rad/s.

# %%
print(fits["with a fall at low speed"])

# %% [markdown]
# ## 3. What a table does not separate
#
# **Without slow speeds there is no fall.** The same table without its rows below 100 1/min:

# %%
fast = np.abs(table["speed"]) >= 100.0
columns = {"speed": speed[fast], "torque": torque[fast]}
short = sw.Recording(columns, {"speed": "rad/s", "torque": "N.m"})
found = sw.identify("hfuc-20-80", {"friction": short})
print(f"law taken: {found.files[0].model}")

fall = gear.replace(friction_input=laws["with a fall at low speed"])
forced = sw.fit(fall, short, [f"friction_input.{each}" for each in free["with a fall at low speed"]])
for each in sw.identification.combinations(forced):
    print(each)

# %% [markdown]
# `identify` takes a simpler law. If you fit the law with a fall to these rows, `sw.identification.combinations` reports
# that the numbers of the fall are determined only together. Both are right: the rows contain no low speeds. So **record slow
# speeds if your joint moves slowly**.
#
# **A table does not separate laws that differ before sliding.** `LuGre` has bristles that bend before the contact slides. At
# constant speed it is the law with a fall:

# %%
stribeck = fits["with a fall at low speed"].model.friction_input
lugre = sw.friction.LuGre(
    coulomb=stribeck.coulomb,
    breakaway=stribeck.breakaway,
    stribeck_speed=stribeck.stribeck_speed,
    viscous=stribeck.viscous,
    bristle_stiffness=40.0,
    bristle_damping=0.0,
)
print(f"largest difference in a table: {np.abs(lugre.steady(grid) - stribeck.steady(grid)).max():.1e} N.m")

# %% [markdown]
# Small motions to and fro [determine the bristles](../../docs/how-to/measure.md#further-friction); reversals in a log
# show them.
#
# ## 4. What a log shows
#
# `robot_log.csv` is the log of [tutorial 1](01_robot_log.py). The joint carries an arm, so friction, gravity and inertia are
# fitted together.

# %% [console]
# $ strainwave identify hfuc-20-80 robot_log.csv --constant torque_constant=0.0755 --rank

# %% [markdown]
# Each line is a set of effects; its error is further right. The table shows:
#
# * **Bristles that bend at reversals** are in all of the best lines: the joint turns round often, and friction does not jump
#   there.
# * **Another friction at low speed** is no better than without, though the joint has one. A log passes quickly through low
#   speeds, and the bristles explain the same samples. The table above shows the fall, and so does a log of the same joint at
#   500 Hz.
# * **A loss under load** changes nothing: the joint has none.
#
# A log shows what matters for *its* motion. It does not show that an effect is absent.
#
# ## 5. Give both files

# %%
stated = sw.FileMapping(constants={"torque_constant": 0.0755})
both = sw.identify("hfuc-20-80", ["friction.csv", "robot_log.csv"], mapping=stated)
truth = {"coulomb": 0.047, "breakaway": 0.062, "stribeck_speed": 3.0, "viscous": 2.9e-4}
for parameter in both.parameters:
    estimate = parameter.estimate
    name = estimate.path.rpartition(".")[2]
    known = f"truth {truth[name]:<8.4g}" if name in truth else ""
    print(f"{estimate.path:34} {estimate.value:9.4g} ± {estimate.sigma:<8.2g} {known:14} {parameter.source}")

# %% [markdown]
# The table determines the law, and the log the load. **Both files are simulated**: the log by a program that shares nothing
# with `strainwave`, the table by the steady friction of the same joint with 1 % noise. Now viscous friction is right as
# well; the log alone gave it [5 % too low](01_robot_log.py).
#
# ## 6. Which law for your own joint
#
# | what you do with the gear | what to record | law |
# |---|---|---|
# | fast motion, energy, cycle time | a log, or a table from 100 1/min up | Coulomb and viscous, or curved viscous |
# | slow motion, reversals, positioning | a table with slow speeds and presliding loops | `Stribeck`, or `LuGre` with bristles |
# | load on the joint | a table with a column `load`, two loads or more | with a loss under load |
# | hours of running | a log with its temperature | `Thermal` |
#
# [Which model when](../../docs/how-to/which-model.md) compares all laws, and [What to measure](../../docs/how-to/measure.md)
# has the details.
