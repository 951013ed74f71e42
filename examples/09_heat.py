"""An hour of duty warms a joint: its friction falls, and its spring gives way a little.

An arm goes to and fro. The losses of motor and gear warm them, and the warm gear loses less. Look at the temperatures, which
settle after some time constants, at what they change, and at where the energy of the hour went. What is lost and what is stored
add up to what was supplied. All numbers are assumed.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

hour = 3600.0
friction = sw.friction.Coulomb(coulomb=0.05, viscous=8e-4)
gear = sw.Gear(
    kinematics=sw.kinematics.StrainWave(),
    stiffness=sw.stiffness.Linear(k=1.2e4),
    hysteresis=sw.hysteresis.FadingMemory(stiffness=[2e3], forgetting=[1e3]),
    damping=60.0,
    friction_input=sw.friction.Thermal(law=friction, dry_fall=0.004, viscous_fall=0.025),
    softening=sw.softening.ThermalSoftening(stiffness_fall=3e-4, hysteresis_fall=2e-3),
)
drive = sw.Drive(
    gear=gear,
    motor=sw.motor.DC(resistance=0.5, torque_constant=0.08, back_emf=0.08, inertia=4e-4, resistance_rise=0.0039),
    control=sw.control.PID(proportional=10.0, derivative=0.2, limit=48.0),
    load=sw.loads.Pendulum(inertia=4.0, gravity_torque=40.0),
    thermal=sw.thermal.Heating(
        winding_capacity=100.0, winding_resistance=2.0, gear_capacity=400.0, gear_resistance=2.5, coupling=0.5
    ),
    meter=sw.meter.EnergyMeter(),
)
command = sw.scenario.sine(amplitude=0.6, frequency=0.5, duration=hour, phase=-np.pi / 2, offset=0.6)
run = sw.simulate(drive, command, dt=4e-3, sample=0.02)


def largest(name: str) -> np.ndarray:
    """The largest of each cycle of two seconds, in percent of that of the last cycle of the first minute, shape (cycles,)."""
    each = np.abs(run[name][1:]).reshape(-1, 100).max(axis=1)
    share: np.ndarray = 100.0 * each / each[29]
    return share


minutes, cycles = run.time / 60.0, np.arange(1, 1801) / 30.0
gear_warmth, winding_warmth = run["temperature"] - 273.15, run["winding_temperature"] - 273.15
figure = Figure(figsize=(8.0, 8.5), layout="constrained")
top, middle, bottom = figure.subplots(3, 1)
top.plot(minutes, winding_warmth, label="winding")
top.plot(minutes, gear_warmth, label="gear")
top.set(xlabel="time [min]", ylabel="temperature [°C]")
for name, label in (("friction_input", "friction at the input"), ("twist", "twist of the gear"), ("voltage", "voltage")):
    middle.plot(cycles[29:], largest(name)[29:], label=label)
    print(f"{label}: {largest(name)[-1] - 100.0:+.1f} % after an hour")
middle.set(xlabel="time [min]", ylabel="largest of a cycle [%\nof that after a minute]")
places = ("motor", "friction_input", "damping", "hysteresis")
taken = np.array([run[f"energy_{place}"][-1] for place in places])
bars = bottom.barh([place.replace("_", " at the ") for place in places], taken)
bottom.bar_label(bars, [f"{each:,.1f} J" for each in taken], padding=4)
bottom.set(xlabel="energy lost in the hour [J]", xscale="log", xlim=(1e-2, 1e7))
top.legend()
middle.legend()
for axes in (top, middle, bottom):
    axes.grid(alpha=0.3)
figure.savefig("heat.png", dpi=110)
print(f"after an hour the winding has {winding_warmth[-1]:.1f} °C, the gear {gear_warmth[-1]:.1f} °C")
supplied, kept = run["energy_supplied"][-1], run["energy_load"][-1] + run["energy_softening"][-1]
kept += sum(run[name][-1] - run[name][0] for name in run.names if name.startswith("stored_"))
print(f"supplied {supplied:,.1f} J = lost {taken.sum():,.1f} J + stored, softening and load {kept:.2f} J")
print(f"the balance closes to {abs(supplied - taken.sum() - kept) / supplied:.0e} of the energy supplied")
