"""The kinematic error shows in the motor's current, in proportion to the load.

The error of the gear moves the point where the load acts, and its reaction asks the motor for torque: order n of the current is
n x load x error / torque constant, besides what the inertia of the output takes. Look at the straight lines: without load only
the ripple from the inertia of the output is left, 1.2 mA at most. So the current of a loaded joint shows its kinematic error
without an encoder at the output.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

orders, error = [1.0, 2.0, 4.0], [8e-5, 3e-4, 5e-5]  # rad at the output
stiffness, inertia, rotor, torque_constant, speed = 8000.0, 0.05, 1.5e-4, 0.05, 10.0
gear = sw.Gear(
    kinematics=sw.kinematics.StrainWave(),
    kinematic_error=sw.kinematic_error.Fourier(order=orders, amplitude=error, phase=[0.0, 0.3, -1.1]),
    stiffness=sw.stiffness.Linear(k=stiffness),
    damping=2.0,
    friction_input=sw.friction.Coulomb(coulomb=0.03, viscous=1e-4),
)
drive = sw.Drive(
    gear=gear,
    motor=sw.motor.CurrentSource(torque_constant=torque_constant, inertia=rotor),
    control=sw.control.PI(proportional=4.0, integral=100.0, limit=50.0),  # holds the speed of the input
    load=sw.loads.Inertia(inertia=inertia),
)
ratio = gear.kinematics.ratio
duration = 14.0 * 2.0 * np.pi / speed
loads = np.array([0.0, 5.0, 10.0, 20.0, 30.0, 40.0])
found = []
for load in loads:
    command = sw.scenario.constant(speed / ratio, duration)
    start = {"input_speed": speed, "output_speed": speed / ratio, "torque": load}
    run = sw.simulate(drive, command, load_torque=load, initial=start, sample=1e-3)
    settled = run.between(duration - 10.1 * 2.0 * np.pi / speed, duration)
    found.append(sw.orders.order_amplitudes(settled, "current", orders).amplitude)
measured = np.array(found)

s = 1j * np.array(orders) * speed
inert = inertia * s**2 * (stiffness + 2.0 * s) / (inertia * s**2 + stiffness + 2.0 * s)  # torque per error, by the inertia
gain = (4.0 + 100.0 / s) * torque_constant / (rotor * s)  # of the loop of the speed
predicted = np.abs((inert / ratio + np.outer(loads, s / speed)) * gain / (1.0 + gain)) * np.array(error) / torque_constant

figure = Figure(figsize=(7.0, 4.5), layout="constrained")
axes = figure.subplots()
for number, order in enumerate(orders):
    (line,) = axes.plot(loads, 1e3 * measured[:, number], "o", label=f"order {order:g}, simulated")
    axes.plot(loads, 1e3 * predicted[:, number], color=line.get_color(), label="closed form" if number == 2 else None)
axes.set(xlabel="load torque [N.m]", ylabel="amplitude of the current [mA]", xlim=(0.0, None), ylim=(0.0, None))
axes.grid(alpha=0.3)
axes.legend()
figure.savefig("current_signature.png", dpi=120)
for load, simulated, closed in zip(loads, measured * 1e3, predicted * 1e3, strict=True):
    print(f"{load:4.0f} N.m: {simulated.round(2)} mA simulated, {closed.round(2)} mA in closed form")
