"""A first drive: put together, run and drawn.

A motor turns a gear of the catalogue, and a controller lets an arm follow a sine. Then a constant torque pushes the arm. Look
at the torque of the gear: it carries the arm's weight, and has a ripple from the kinematic error of the gear.
"""

import numpy as np
import strainwave as sw

drive = sw.Drive(
    gear=sw.load("hfuc-25-100"),
    motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
    control=sw.control.PID(proportional=30.0, integral=100.0, derivative=0.5, limit=48.0),
    load=sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0),
)
command = sw.scenario.sine(amplitude=0.5, frequency=0.5, duration=4.0, phase=-np.pi / 2, offset=0.5)  # begins at rest
push = sw.scenario.step(amplitude=30.0, duration=4.0, start=3.0)  # N.m against the output
run = sw.simulate(drive, command, sample=1e-3, load_torque=push)

error = run["command"] - run["output_angle"]
before, after = run.time < 3.0, run.time >= 3.0
print(f"largest error {np.abs(error[before]).max() * 1e3:.2f} mrad, after the push {np.abs(error[after]).max() * 1e3:.2f} mrad")
print(f"largest torque {np.abs(run['torque']).max():.1f} N.m, largest current {np.abs(run['current']).max():.2f} A")
run.with_column("error", error, "rad").plot(["command", "output_angle", "torque", "current"]).savefig("first_run.png", dpi=120)
