"""A joint that sticks is moved by small angles with pulses of torque, and a soft gear always arrives from the same side.

Above, the position control article's drive: its friction holds it, and a position loop without much gain leaves it there. A
pulse of torque moves it by (tau - F) tau w^2 / 2 J F. Planned open loop, the friction that is not known is in the angle;
measured at rest after each pulse, it is not. Look at the errors over a hundred drawn frictions. What is left is the jump of a
load that breaks away. Below, the article's gear: a motor that is positioned exactly leaves the output on
either branch of the loop, 59 degrees of the input apart; a path that overshoots by more than that leaves it on one. The
friction of the outputs is assumed.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

travel, tolerance = 1e-3, 1e-4  # rad of the output
plan = sw.tuning.plan_pulses("position-drive", travel)
width = sw.tuning.pulse_width(abs(plan.torque), 0.05, plan.inertia, plan.friction)
run = sw.simulate(plan.drive, plan.pulses([width]), record=["input_angle"])
print(f"a pulse of {1e3 * width:.1f} ms for 0.05 rad of the motor moves it by {run['input_angle'][-1]:.4f} rad")
spreads = {
    name: sw.tuning.pulse_repeatability(plan, tolerance, measured=name == "measured") for name in ("planned", "measured")
}
for name, found in spreads.items():
    errors = f"error {1e6 * found.median_error:.0f} urad, 95 % within {1e6 * found.upper_error:.0f} urad"
    pulses = f"{found.median_pulses:.0f} pulses, 95 % with {found.upper_pulses:.0f} or fewer"
    print(f"{name}: {errors}; {pulses}; {found.reached:.0%} within the tolerance")

soft = sw.rig.printed_gear(0).replace(damping=20.0, friction_output=sw.friction.Coulomb(coulomb=36.0))
stiff = sw.load("csg-20-100").replace(damping=30.0, friction_output=sw.friction.Coulomb(coulomb=5.0))
loop = sw.control.PositionSpeed(
    position_gain=40.0, speed_proportional=0.05, speed_integral=1.0, speed_feedforward=1.0, limit=5.0, feedback="input"
)
targets = np.radians([0.0, 3.0, 6.0, 3.0])  # the second from below, the last from above
paths, apart = {}, {}
for name, gear, inertia in (("the article's gear", soft, 0.5), ("CSG-20-100", stiff, 0.05)):
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), control=loop, load=sw.loads.Inertia(inertia=inertia))
    lost = sw.tuning.lost_motion(gear)
    print(f"{name}: {np.degrees(lost.input_width):.2f} deg of the input wide, {np.degrees(lost.input_extent):.2f} deg in all")
    for way, overshoot in (("plain", 0.0), ("one side", lost.overshoot())):
        path = sw.tuning.positioning_path(targets, overshoot, speed=0.5, acceleration=0.5)
        run = sw.simulate(drive, path.command, dt=5e-4, record=["output_angle", "command"])
        rest = np.interp(path.rests, run.time, run["output_angle"])
        paths[name, way], apart[name, way] = (path, run), (rest[1] - rest[3]) / lost.extent
        print(f"  {way}: arrivals from both sides differ by {abs(apart[name, way]):.2%} of that")

figure = Figure(figsize=(8.0, 7.0), layout="constrained")
above, below = figure.subplots(2, 1)
bins = np.linspace(-1000.0, 1500.0, 51)
for name, found in spreads.items():
    above.hist(1e6 * found.errors, bins, alpha=0.6, label=name)
above.set(xlabel="error of the output [µrad]", ylabel="drives", title="1 mrad by pulses, with a hundred drawn frictions")
for way in ("plain", "one side"):
    path, run = paths["the article's gear", way]
    below.plot(run.time, np.degrees(run["output_angle"] - run["command"]), label=way)
    below.plot(path.rests, np.degrees(np.interp(path.rests, run.time, run["output_angle"]) - path.targets), "o", color="black")
below.set(
    xlabel="time [s]",
    ylabel="output less command [deg]",
    title="The article's gear; points: at rest at a target",
)
for axes in (above, below):
    axes.legend()
figure.savefig("pulse_positioning.png", dpi=110)
