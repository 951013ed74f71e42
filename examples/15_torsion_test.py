"""A torsion test from plan to gear, on a virtual rig: masses on pans, photographs of two markers, loop, stiffness, model.

A catalogue gear is loaded at its input, as on the rig of the torsional stiffness article, its output held. Its own friction is
in the loop, and that of the pulleys, which the file of the rig states, is taken out. Look at the loop: a table of friction,
measured apart, shows what of its width is friction of the wave generator and what is hysteresis of the flexspline. With real
photographs only the simulation is left out. The friction, and the hysteresis of the gear on the rig, are assumed.
"""

from pathlib import Path

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

gear = sw.load("csg-25-100").replace(
    hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[9e3, 4e3], breakaway=[2.0, 3.0]),
    friction_input=sw.friction.Coulomb(coulomb=0.02, viscous=1e-4),
    kinematic_error=sw.kinematic_error.Fourier(),
)
rig = sw.rig.load("couple-rig")
planned = sw.rig.plan(rig, 0.9, positions=[0.0])
print(planned.remarks[0])

folder = Path("torsion-test")
truth = sw.rig.simulate_test(gear, rig, planned.steps, folder=folder, seed=1, progress=False)
test = sw.rig.read_test(folder)
(loop,) = test.loops
print(f"{len(loop)} photographs, each angle to {np.degrees(loop.angle_sigma.max()) * 3600:.0f} arcsec or better")

found = sw.rig.analyse(loop)
for each in found.stiffnesses:
    slope = each.regression
    print(f"{each.name.replace('_', ' '):18} {slope.value:.3f} N.m/rad, 95 %: {slope.low:.3f} to {slope.high:.3f}")

speed = np.geomspace(1.0, 300.0, 12)
friction = {"speed": speed, "torque": gear.friction_input.steady(speed)}
table = sw.Recording(friction, {"speed": "rad/s", "torque": "N.m"}, "friction, measured apart")
found_gear = sw.identify("csg-25-100", {"friction": table, "torsion": loop.recording()})
model = found_gear.gear_set.gear
assert isinstance(gear.hysteresis, sw.hysteresis.MaxwellSlip)
assert isinstance(model.hysteresis, sw.hysteresis.MaxwellSlip)
held = {"true": sum(gear.hysteresis.breakaway), "found": sum(model.hysteresis.breakaway)}
print(f"torque that the flexspline's hysteresis holds: {held['found']:.2f} N.m found, {held['true']:.2f} N.m true")

clean = sw.rig.without_friction(loop, sw.rig.friction_at_rest(table, gear))
for name, lost in (("as measured", found.area), ("without friction of the wave generator", sw.rig.analyse(clean).area)):
    print(f"energy lost in a cycle, {name}: {1e3 * lost.value:.2f} mJ" if lost else f"{name}: the loop does not close")

figure = Figure(figsize=(10.0, 4.2), layout="constrained")
left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.5))
left.imshow(sw.rig.read_image(folder / "step-001.png").grey, cmap="gray", vmin=0.0, vmax=1.0)
left.set(title="photograph of step 1", xlabel="x [px]", ylabel="y [px]")
right.plot(np.degrees(loop.angle), loop.torque, "o-", markersize=3.0, linewidth=1.0, label="as measured")
right.plot(np.degrees(clean.angle), clean.torque, linewidth=1.5, label="without friction of the wave generator")
right.set(xlabel="angle of the input [deg]", ylabel="torque on the input [N.m]")
right.legend(loc="upper left", fontsize="small")
figure.savefig("torsion_test.png", dpi=110)
