# %% [markdown]
# # Torsion rig: from photographs to a report
#
# At the end you have stiffness, hysteresis and lost motion of a gear with their uncertainties, in a report, and a gear file.
# The test needs masses, cords and a camera.
#
# **Time:** 20 minutes. **You need:** strainwave with matplotlib. A virtual rig makes the photographs here. The two
# paragraphs that begin with *With your own rig* list what changes for a real one.

# %% [markdown]
# ## The rig file
#
# The output of the gear is fixed. Masses on cords turn a disk on the shaft of the wave generator, and a camera photographs
# two round markers on it. A TOML file contains the numbers of the rig, each with its unit, its uncertainty and its source:

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import strainwave as sw

print(Path("06_torsion_rig_bench.toml").read_text())

# %% [markdown]
# **With your own rig:** copy this file and write your numbers into it. `disk_radius` and the masses are needed. Measure
# `pulley_torque` and `compliance` too: if they are left out, they count as zero, and the gear appears wider or softer. [The
# torsion rig](../../docs/how-to/torsion-rig.md) describes what to build and how to measure each number.
#
# ## The plan
#
# The torque goes to the positive peak, through zero to the negative peak, and back. `strainwave rig plan` prints what to lay
# on the pans at each step. Choose a peak that the gear may carry: 0.9 N·m at the input are 90 N·m at the output of this gear
# of ratio 100.

# %% [console]
# $ strainwave rig plan --rig 06_torsion_rig_bench.toml --torque 0.9 --positions 0 --out plan.csv | sed -n '1,12p;$p'

# %% [markdown]
# The first line states what the masses cannot do: 0.9 N·m is no whole number of masses, so the plan takes the nearest torque.
# The table is for the bench; `plan.csv` has the same steps for a program.
#
# ## The test
#
# The gear on the virtual rig is one of the catalogue, but with another hysteresis and friction; the analysis does not get
# these numbers. The folder `torsion-test` then has what a real test leaves: a photograph of each step, `steps.csv`,
# `rig.toml`.

# %%
on_the_rig = sw.load("csg-25-100").replace(
    hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[9e3, 4e3], breakaway=[2.0, 3.0]),
    friction_input=sw.friction.Coulomb(coulomb=0.02, viscous=1e-4),
    kinematic_error=sw.kinematic_error.Fourier(),
)
bench = sw.rig.load("06_torsion_rig_bench.toml")
steps = sw.rig.plan(bench, 0.9, positions=[0.0]).steps  # those of plan.csv
scene = sw.rig.Scene(size=(400, 300), radius=22.0, distance=180.0, blur=1.0, noise=0.01)  # pixels
sw.rig.simulate_test(on_the_rig, bench, steps, folder="torsion-test", scene=scene, seed=1)

print(*sorted(path.name for path in Path("torsion-test").iterdir())[:5], "...", sep="\n")
print()
print(*Path("torsion-test/steps.csv").read_text().splitlines()[:4], sep="\n")

# %%
figure, panels = plt.subplots(1, 2, figsize=(9.0, 3.5), layout="constrained")
for axes, number in zip(panels, (1, 19), strict=True):
    axes.imshow(sw.rig.read_image(f"torsion-test/step-{number:03}.png").grey, cmap="gray", vmin=0.0, vmax=1.0)
    axes.set(title=f"photograph of step {number}", xlabel="x [px]", ylabel="y [px]")

# %% [markdown]
# **With your own rig:** leave the cell of `simulate_test` out. Make the folder yourself:
#
# 1. `rig.toml`: your rig file.
# 2. The photographs, with any names, as PNG or JPEG. Both markers must be sharp and not over-exposed.
# 3. `steps.csv` with a row for each step: `number`, the *total* mass on the two positive pans and on the two negative pans,
#    and `image`. The header states the units: `mass_positive [g]` is allowed too. Positive turns against the clock in the
#    picture.
#
# `strainwave rig measure` does this with you, step by step, and goes on after a break. All that follows is the same for real
# photographs.
#
# ## From photographs to a loop
#
# `read_test` finds the markers in each photograph, computes angle and torque, and takes out the friction of the pulleys and
# the compliance of the rig.

# %%
test = sw.rig.read_test("torsion-test")
(loop,) = test.loops  # one for each position of the gear in its mount
print(f"{len(loop)} points of {loop.name}")
print(f"angle of a point: ± {np.degrees(loop.angle_sigma.max()) * 3600:.0f} arcsec (one standard deviation)")
print(sw.rig.torque_budget(bench, test.steps[0]))
print("remarks:", (*test.remarks, *loop.remarks) or "none")

# %% [markdown]
# The budget lists what limits the torque, the largest first. Improve its first line, not its last. Remarks would name a
# blurred photograph, a skipped step, or a camera that looks askew.
#
# ## A friction table
#
# The loop of the input contains the friction of the wave generator. To separate it, turn the free gear at a few constant
# speeds, and write down the torque. A motor with a known torque constant does it. Here it is a table of the virtual gear.

# %%
speed = np.geomspace(1.0, 300.0, 12)
columns = {"speed": speed, "torque": on_the_rig.friction_input.steady(speed)}
friction = sw.Recording(columns, {"speed": "rad/s", "torque": "N.m"}, "friction, measured apart")
friction.to_csv("rig_friction.csv")
print(*Path("rig_friction.csv").read_text().splitlines()[:4], sep="\n")

# %% [markdown]
# ## The report
#
# `strainwave rig analyse` computes stiffness, hysteresis and lost motion by stated definitions. The interval of 95 % is in
# brackets.

# %% [console]
# $ strainwave rig analyse torsion-test --gear csg-25-100 --friction rig_friction.csv --out analysis

# %% [markdown]
# `analysis/report.html` has the figures, the definitions and the budget. `results.json` has every number. The same in Python,
# for the loop with and without the friction of the wave generator:

# %%
clean = sw.rig.without_friction(loop, sw.rig.friction_at_rest(friction, sw.load("csg-25-100")))
for name, each in (("as measured", loop), ("without friction", clean)):
    found = sw.rig.analyse(each)
    print(f"{name}: {1e3 * found.area.value:.2f} mJ lost in a cycle, widest {np.degrees(found.hysteresis.width.value):.2f}°")

figure, axes = plt.subplots(figsize=(8.0, 4.5), layout="constrained")
axes.plot(np.degrees(loop.angle), loop.torque, "o-", markersize=3, label="as measured")
axes.plot(np.degrees(clean.angle), clean.torque, label="without friction of the wave generator")
axes.set(xlabel="angle of the input [deg]", ylabel="torque at the input [N.m]", title="A torsion loop, measured at the input")
axes.legend()

# %% [markdown]
# The loop as measured is wider. Without a friction table, all of its width would count as hysteresis of the flexspline.
#
# ## The gear
#
# `sw.identify` makes a gear from friction table and loop. The first argument is the start set of the catalogue. On the
# command line: `strainwave identify csg-25-100 rig_friction.csv analysis/loop-0deg.csv`.

# %%
result = sw.identify("csg-25-100", {"friction": friction, "torsion": loop.recording()})
mine = result.gear_set.gear
result.gear_set.save("my_gear.toml")
print(mine.stiffness)
print(mine.hysteresis)

# %% [markdown]
# This test is virtual, so the truth is known. With a real gear, compare with a second test instead.

# %%
for name in ("k1", "k2", "k3"):
    print(f"{name}: {getattr(mine.stiffness, name):8.0f} N.m/rad found, {getattr(on_the_rig.stiffness, name):8.0f} true")
print(f"hysteresis holds {sum(mine.hysteresis.breakaway):.2f} N.m found, {sum(on_the_rig.hysteresis.breakaway):.2f} true")
print(f"friction {mine.friction_input.coulomb:.4f} N.m found, {on_the_rig.friction_input.coulomb:.4f} true")

# %% [markdown]
# `my_gear.toml` is a gear file for `sw.load` and for every command.
#
# ## What can go wrong
#
# | message or effect | cause, and what to do |
# |---|---|
# | `some steps exchange masses` (in the plan) | There are too few small masses. Use masses of one size, or a larger `--step`. |
# | a remark names a photograph | It is blurred, over-exposed, or lacks a marker. The other steps remain. |
# | the sign of the torque is wrong | Positive pans turn the disk against the clock *in the picture*: exchange the columns. |
# | `the loop does not close`, no area | The last step is not the first torque again. Measure to the positive peak again. |
# | lost motion far above the catalogue | The friction table is missing, or the mount yields: measure `compliance`. |
#
# ## Where to go on
#
# * [Torsion test: rig, test, analysis](../../docs/how-to/torsion-rig.md): what to build, cameras, uncertainty.
# * [Analyse a torsion loop](../../docs/how-to/torsion-rig.md#analyse-a-torsion-loop): the definitions of
#   stiffness, hysteresis and lost motion.
# * [Simulate a joint](04_simulate_a_joint.py): what this gear does in a joint.
