"""Torsion loops: which place loses how much, over load, speed and temperature.

The review of dynamic models, a review of dynamic models, names an open challenge: how much of a loop comes from the bearing of
the wave generator, from the teeth, from the output bearing and from the flexspline, and what changes that. Here it is an
experiment. A fixture holds the input, a torque winds the output to and fro. A meter separates the places by their energies,
which a torque cell cannot do. Look at the shares: the output bearing has the largest in the smallest loops, that of the teeth
grows with the load, and that of the wave generator grows with speed and cold, because of its thick oil. Numbers of friction and
hysteresis are assumed.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

gear = sw.load("csg-25-100").replace(
    hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3, 2e3], breakaway=[0.8, 1.0, 1.2]),
    damping=10.0,
    friction_input=sw.friction.MixedLubrication(
        coulomb=0.03, breakaway=0.05, stribeck_speed=0.3, viscous=0.03, viscosity_fall=0.03, load_sensitivity=0.3
    ),
    friction_mesh=sw.friction.LoadDependent(
        driving_forward=0.1, driving_reverse=0.1, backdriving_forward=0.1, backdriving_reverse=0.1
    ),
    friction_output=sw.friction.Coulomb(coulomb=0.4, viscous=0.5),
)
drive = sw.Drive(
    gear=gear,
    motor=sw.motor.TorqueSource(inertia=1e-4),
    control=sw.control.PID(proportional=10.0, limit=10.0),  # a fixture of 10 N.m/rad at the input
    load=sw.loads.Inertia(inertia=0.02),
    meter=sw.meter.EnergyMeter(),
)
places = {
    "friction_input": "wave generator",
    "friction_mesh": "teeth",
    "friction_output": "output bearing",
    "hysteresis": "flexspline",
    "damping": "damping",
}


def loop(torque: float = 40.0, frequency: float = 1.0, celsius: float = 20.0) -> tuple[sw.Recording, float, np.ndarray]:
    """The third cycle: its samples, its area [J], and what each place took of it [J]."""
    wave = sw.scenario.sine(amplitude=torque, frequency=frequency, duration=3.0 / frequency)
    still = sw.scenario.constant(0.0, duration=3.0 / frequency)
    run = sw.simulate(drive, still, load_torque=wave, temperature=celsius + 273.15, sample=1.0 / (500.0 * frequency))
    cycle = run.between(2.0 / frequency, 3.0 / frequency)
    taken = np.array([cycle[f"energy_{place}"][-1] - cycle[f"energy_{place}"][0] for place in places])
    area = float(abs(np.trapezoid(cycle["load_torque"], cycle["output_angle"])))
    return cycle, area, taken


studies = {
    "torque [N.m]": [(value, loop(torque=value)) for value in (5.0, 10.0, 20.0, 40.0, 80.0)],
    "frequency [Hz]": [(value, loop(frequency=value)) for value in (0.5, 1.0, 2.0, 4.0, 8.0)],
    "8 Hz, at [°C]": [(value, loop(celsius=value, frequency=8.0)) for value in (-20.0, 0.0, 20.0, 40.0, 60.0)],
}

figure = Figure(figsize=(11.0, 7.0), layout="constrained")
for (quantity, study), above, below in zip(studies.items(), *figure.subplots(2, 3), strict=True):
    for value, (cycle, area, taken) in study:
        above.plot(cycle["output_angle"] * 1e3, -cycle["load_torque"], linewidth=1.0, label=f"{value:g}")
        width = abs(cycle["output_angle"][250] - cycle["output_angle"][0])  # where the torque crosses zero
        sums = f"area {area * 1e3:6.3f} mJ, sum of the places {taken.sum() * 1e3:6.3f} mJ"
        print(f"{quantity:25} {value:5g}: width {width * 1e3:.3f} mrad, {sums}")
    above.set(xlabel="output angle [mrad]", ylabel="torque on the output [N.m]")
    above.legend(loc="lower right", fontsize="small", title=quantity, title_fontsize="small")
    shares = np.array([taken / taken.sum() for _, (_, _, taken) in study])
    bottom = np.zeros(len(study))
    for name, share in zip(places.values(), shares.T, strict=True):
        below.bar([f"{value:g}" for value, _ in study], share, bottom=bottom, label=name)
        bottom += share
    below.set(xlabel=quantity, ylabel="share of the loss", ylim=(0.0, 1.0))
figure.legend(*below.get_legend_handles_labels(), loc="outside lower center", ncols=5)
figure.savefig("torsion_loops.png", dpi=110)
