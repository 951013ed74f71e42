"""A space pointing joint that creeps: with the cascade it sticks and jumps, with a model of its friction it does not.

The friction of its grease falls with the speed, so that a controller which waits for an error breaks the joint away, and the
joint goes too far. A feed-forward of the friction gives the torque before there is an error. What the model has too much or too
little is observed as a scale, by the error of speed and angle, on gears that have up to 30 % more or less friction.
"""

import strainwave as sw
from matplotlib.figure import Figure

SPEED = 1e-4  # rad/s of the output: a turn in 17 hours

found = sw.compensate("space-pointing-joint", goal="smooth", speed=SPEED, members=6)
print(f"chosen: {found.chosen.candidate.name}")
for name, judged in (("cascade", found.baseline), ("compensated", found.chosen)):
    rest, ripple = judged.median("time at rest"), judged.median("speed ripple")
    print(f"{name:12} at rest {rest:4.0%} of the time, ripple of the speed {ripple:7.2%}, median of {found.members} gears")

command = found.goal.command
figure = Figure(figsize=(8.0, 3.6), layout="constrained")
position, speed = figure.subplots(1, 2)
for name, drive, color in (
    ("cascade", found.baseline.candidate.drive, "#2166ac"),
    ("compensated", found.drive, "#c2410c"),
):
    run = sw.simulate(drive, command, sample=command.duration / 4000).between(0.5 * command.duration, command.duration)
    position.plot(run.time, 1e6 * (run["output_angle"] - command.value(run.time)), color=color, label=name)
    speed.plot(run.time, run["output_speed"] / SPEED, color=color, label=name)
position.set(xlabel="time [s]", ylabel="output angle less commanded [µrad]")
speed.set(xlabel="time [s]", ylabel="output speed over commanded [1]", ylim=(-3.0, 8.0))
position.legend()
for axes in (position, speed):
    axes.grid(alpha=0.3)
figure.savefig("pointing.png", dpi=110)
