"""Efficiency over the whole envelope: one gear over speed, load and temperature.

The review of dynamic models asks for one model that holds over speed, torque and temperature. Here mixed lubrication of the
wave generator and losses of the teeth that grow with the load are in one gear, and a meter shows how much energy reaches the
output. Look at how the region of good efficiency moves: cold oil costs efficiency at high speeds; with warm oil dry friction
lasts up to higher speeds. Numbers of friction are assumed.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

bearing = sw.friction.MixedLubrication(
    coulomb=0.03, breakaway=0.08, stribeck_speed=20.0, viscous=6e-4, viscosity_fall=0.03, load_sensitivity=0.3
)
teeth = sw.friction.LoadDependent(driving_forward=0.08, driving_reverse=0.08)
drive = sw.Drive(
    gear=sw.load("csg-25-100").replace(
        friction_input=bearing, friction_mesh=teeth, kinematic_error=sw.kinematic_error.Fourier()
    ),
    motor=sw.motor.TorqueSource(inertia=1e-4),
    control=sw.control.PI(proportional=0.1, integral=20.0, limit=50.0),  # of the speed
    load=sw.loads.Inertia(inertia=0.05),
    meter=sw.meter.EnergyMeter(),
)
ratio = drive.gear.kinematics.ratio


def efficiency(speed: float, torque: float, celsius: float) -> float:
    """Energy to the load over energy supplied, once the controller has settled."""
    command = sw.scenario.constant(speed / abs(ratio), duration=0.2)
    begin = {"input_speed": np.copysign(speed, ratio), "torque": torque}
    run = sw.simulate(drive, command, load_torque=torque, temperature=celsius + 273.15, initial=begin, sample=0.05)
    given, taken = (run[name][-1] - run[name][-2] for name in ("energy_load", "energy_supplied"))
    return float(given / taken)


speeds, torques = np.geomspace(5.0, 400.0, 12), np.geomspace(5.0, 140.0, 9)
maps = {celsius: np.array([[efficiency(v, t, celsius) for v in speeds] for t in torques]) for celsius in (-20.0, 20.0, 60.0)}

figure = Figure(figsize=(11.0, 4.2), layout="constrained")
for axes, (celsius, found) in zip(figure.subplots(1, 3, sharey=True), maps.items(), strict=True):
    drawn = axes.contourf(speeds, torques, 100.0 * found, levels=np.arange(0.0, 101.0, 10.0), cmap="viridis")
    lines = axes.contour(speeds, torques, 100.0 * found, levels=np.arange(10.0, 100.0, 10.0), colors="white", linewidths=0.6)
    axes.clabel(lines, levels=[40.0, 60.0, 80.0], fmt="%.0f", fontsize="small")
    axes.set(title=f"{celsius:.0f} °C", xlabel="input speed [rad/s]", xscale="log", yscale="log")
    row, column = np.unravel_index(found.argmax(), found.shape)
    print(f"{celsius:4.0f} °C: best {found.max():.1%} at {speeds[column]:.0f} rad/s and {torques[row]:.0f} N.m")
figure.axes[0].set_ylabel("load torque [N.m]")
figure.colorbar(drawn, ax=figure.axes, label="efficiency [%]")
figure.savefig("envelope.png", dpi=110)
