"""From a gear of the catalogue to a robot joint, and whether a move keeps what the maker allows.

A gear set has the source of each number and the maker's ratings. Motor, controller and arm are added; the joint is saved as a
file and read back. It moves its arm by a radian, once gently and once hastily, and so does the joint that comes with the
package. Look at the torque of the hasty move: at start and stop it exceeds the repeated peak torque of the gear.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

gear = sw.GearSet.read("csg-25-100")
joint = gear.with_parts(
    motor=sw.motor.BrushlessDC(
        resistance=0.1, inductance=1.5e-4, torque_constant=0.06, inertia=6e-5, supply_voltage=48.0, current_limit=60.0
    ),
    control=sw.control.Cascade(
        position_gain=15.0,
        speed_proportional=0.8,
        speed_integral=8.0,
        current_proportional=0.3,
        current_integral=200.0,
        speed_limit=580.0,
        current_limit=60.0,
        speed_feedforward=1.0,
    ),
    load=sw.loads.Pendulum(inertia=4.0, gravity_torque=59.0),
    source="data sheet of a motor, mass and length of an arm",
).replace(name="My joint")
joint.save("my_joint.toml")

joints = [sw.GearSet.read("my_joint.toml"), sw.GearSet.read("robot-joint")]
figure = Figure(figsize=(9.0, 6.0), layout="constrained")
panels = figure.subplots(2, 2, sharex="col", sharey="row")
for column, (name, duration) in zip(panels.T, {"gentle": 2.0, "hasty": 0.32}.items(), strict=True):
    time = np.linspace(0.0, 1.5 * duration, 600)
    command = sw.scenario.table(time, 0.5 - 0.5 * np.cos(np.pi * np.minimum(time / duration, 1.0)))
    for each in joints:
        run = sw.simulate(each.drive, command, sample=1e-3)
        column[0].plot(run.time, run["output_angle"], label=each.name)
        column[1].plot(run.time, run["torque"])
        exceeded = [str(check) for check in sw.check_ratings(each, run) if check.exceeded]
        print(f"{each.name}, {name} move: {'; '.join(exceeded) or 'keeps all ratings'}")
    column[0].plot(run.time, run["command"], color="gray", linestyle=":", label="command")
    column[0].set(title=f"{name} move", ylabel="output angle [rad]")
    column[1].axhline(gear.ratings["peak_torque"].value, color="black", linestyle="--", label="repeated peak torque")
    column[1].set(xlabel="time [s]", ylabel="torque [N.m]")
panels[0, 0].legend()
panels[1, 0].legend()
figure.savefig("robot_joint.png", dpi=110)
