"""How much of the "stochastic" kinematic error is random, and why it changes with the speed.

The review of dynamic models calls the part of the error that grows with the speed stochastic, and asks where it comes from.
Here an encoder pair sees the error of teeth and bearing, noise that really is random but the same over the angle at every
speed, and the twist that both excite. Look at the dashed line: orders near the eigenfrequency grow, orders far above it vanish.
The resonance changes with the speed, not the noise. Numbers are assumed.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

bearing = sw.orders.bearing_orders(balls=23, ball_diameter=5.5e-3, pitch_diameter=45e-3, outer_speed=-0.01)
orders, amplitudes = [1.0, 2.0, 4.0, bearing.outer_ring], [2e-5, 6e-5, 1e-5, 4e-6]
drive = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.StrainWave(),
        kinematic_error=sw.kinematic_error.Fourier(order=orders, amplitude=amplitudes, phase=[0.0, 0.3, -1.1, 0.5]),
        kinematic_noise=sw.kinematic_error.Stochastic(amplitude=3e-6, lowest_order=8.0, highest_order=40.0, seed=1),
        stiffness=sw.stiffness.Linear(k=8000.0),
        damping=1.0,
    ),
    motor=sw.motor.TorqueSource(inertia=1.5e-4),
    control=sw.control.PI(proportional=0.1, integral=2.0, limit=5.0),
    load=sw.loads.Inertia(inertia=0.05),
)
ratio = drive.gear.kinematics.ratio
(mode,) = sw.analysis.modes(drive)["free"]
found = {}
figure = Figure(figsize=(9.0, 7.5), layout="constrained")
for axes, speed in zip(figure.subplots(3, 1, sharex=True), (15.0, 60.0, 190.0), strict=True):
    turn = 2.0 * np.pi / speed
    command = sw.scenario.constant(speed / ratio, duration=1.0 + 20.0 * turn)
    run = sw.simulate(drive, command, initial={"input_speed": speed}, sample=turn / 400.0)
    seen = run.between(1.0, 1.0 + 20.0 * turn)
    found[speed] = sw.orders.order_amplitudes(seen, "transmission_error", orders)
    spectrum = sw.orders.order_spectrum(seen, "transmission_error", highest=45.0)
    axes.vlines(orders, 1e-9, found[speed].amplitude, color="tab:orange", linewidth=4.0, alpha=0.6, label="orders asked for")
    axes.plot(spectrum["order"], spectrum["amplitude"], linewidth=0.8, label="spectrum")
    axes.axvline(mode / speed, color="black", linestyle="--", linewidth=1.0, label="eigenfrequency")
    axes.set(yscale="log", ylim=(1e-8, 1e-3), xlim=(0.0, 45.0), ylabel="amplitude [rad]", title=f"{speed:.0f} rad/s")
    axes.grid(alpha=0.3)
    shown, rest = "  ".join(f"{each * 1e6:.2f}" for each in found[speed].amplitude), found[speed].residual * 1e6
    print(f"{speed:4.0f} rad/s: orders {shown} urad, the rest {rest:.2f} urad rms")
figure.axes[0].legend(loc="upper center")
figure.axes[-1].set_xlabel("order of the input [1]")
figure.savefig("what_is_random.png", dpi=110)
