"""Stick-slip at creep speed: the motor stops and jumps although the command moves evenly.

Friction that falls with the speed, together with an integral in the controller, makes the motion unsteady: the integral grows
until the shaft breaks away; then the shaft goes too far and sticks again. Look at the steps of the angle at speeds below that
of the Stribeck dip. They vanish at a higher speed, or with friction that does not fall.
"""

import strainwave as sw
from matplotlib.figure import Figure

falling = sw.friction.Stribeck(coulomb=0.05, breakaway=0.08, stribeck_speed=1.0, viscous=2e-3)
level = sw.friction.Coulomb(coulomb=0.08, viscous=2e-3)
drive = sw.Drive(
    gear=sw.load("hfuc-20-100").replace(friction_input=falling, damping=5.0),
    motor=sw.motor.CurrentSource(torque_constant=0.06, inertia=5e-5),
    control=sw.control.PID(proportional=1.0, integral=4.0, derivative=0.02, limit=10.0),
    load=sw.loads.Inertia(inertia=0.3),
)
ratio = drive.gear.kinematics.ratio


def crept(friction: sw.friction.Stribeck | sw.friction.Coulomb, speed: float) -> sw.Recording:
    """The second half of a ramp whose input turns six radians at a speed [rad/s]."""
    duration = 6.0 / speed
    creeping = drive.replace({"gear.friction_input": friction})
    run = sw.simulate(creeping, sw.scenario.ramp(speed / ratio, duration), sample=duration / 6000)
    return run.between(duration / 2, duration)


figure = Figure(figsize=(10.0, 4.0), layout="constrained")
rest = {}
for axes, speed in zip(figure.subplots(1, 3), (0.2, 0.8, 3.0), strict=True):
    for name, friction, style in (("falling", falling, "-"), ("level", level, "--")):
        run = crept(friction, speed)
        rest[name, speed] = float((run["input_speed"] == 0.0).mean())
        print(f"{name:7} friction, {speed} rad/s asked for: at rest {rest[name, speed]:4.0%} of the time")
        axes.plot(run.time, run["input_angle"], style, label=f"{name} friction")
    axes.set(title=f"{speed} rad/s asked for", xlabel="time [s]", ylabel="input angle [rad]")
    axes.grid(alpha=0.3)
figure.axes[0].legend()
figure.savefig("creep.png", dpi=110)
