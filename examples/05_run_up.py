"""Run-up through resonance: which order of the motor's revolution shakes the joint, and at which speed.

The kinematic error repeats 1, 2 and 4 times in each revolution of the input. A worn bearing of the wave generator adds the
order at which its balls pass a point of the outer ring. While the motor slowly speeds up, each order crosses the resonance of
the gear at its own critical speed, eigenfrequency / order. Look at where the dotted lines of the Campbell diagram cross the
dashed one: the torque is largest there. Numbers of the gear are assumed.
"""

from itertools import pairwise

import numpy as np
import strainwave as sw

ratio = -100.0
bearing = sw.orders.bearing_orders(balls=23, ball_diameter=5.5e-3, pitch_diameter=45e-3, outer_speed=1 / ratio)
orders = [1.0, 2.0, 4.0, bearing.outer_ring]
gear = sw.Gear(
    kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202),
    kinematic_error=sw.kinematic_error.Fourier(order=orders, amplitude=[8e-5, 3e-4, 5e-5, 2e-6], phase=[0.0, 0.3, -1.1, 0.0]),
    stiffness=sw.stiffness.Linear(k=8000.0),
    damping=1.0,
    friction_input=sw.friction.Coulomb(coulomb=0.03, viscous=1e-4),
    input_inertia=5e-5,
)
drive = sw.Drive(
    gear=gear,
    motor=sw.motor.CurrentSource(torque_constant=0.05, inertia=1e-4),
    control=sw.control.PI(proportional=0.05, integral=0.2, limit=20.0),  # of the speed
    load=sw.loads.Inertia(inertia=0.05),
)

# So that every order crosses the resonance equally slowly, the speed grows by the same share each second.
duration, lowest, highest = 60.0, 25.0, 450.0
time = np.linspace(0.0, duration, 600)
speed_asked = np.geomspace(lowest, highest, 600)
command = sw.scenario.table(time, speed_asked / ratio)
run = sw.simulate(drive, command, sample=5e-4, initial={"input_speed": lowest})

# Amplitudes of the orders, from five revolutions at a time.
turns = (run["input_angle"] - run["input_angle"][0]) / (2.0 * np.pi)
ends = np.searchsorted(turns, np.arange(20.0, turns[-1], 5.05))
stretches = [run.between(run.time[a], run.time[b]) for a, b in pairwise(ends)]
speed = np.array([stretch["input_speed"].mean() for stretch in stretches])
torque = np.array([sw.orders.order_amplitudes(stretch, "torque", orders).amplitude for stretch in stretches])

(mode,) = sw.analysis.modes(drive)["free"]
predicted = mode / np.array(orders)
observed = speed[torque.argmax(axis=0)]
print(f"eigenfrequency {mode:.1f} rad/s = {mode / 2 / np.pi:.1f} Hz")
for order, critical, peak in zip(orders, predicted, observed, strict=True):
    print(f"order {order:6.3f}: critical speed {critical:5.1f} rad/s predicted, {peak:5.1f} rad/s observed")

diagram = sw.orders.campbell(run, "torque")
diagram.plot(orders=orders, eigenfrequencies=[mode]).savefig("run_up.png")
