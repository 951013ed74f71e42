"""A controller in a computer: how slow may it be, and how late?

A law that is computed every T seconds and acts d seconds later is late by T/2 + d on average. The loop stays stable up to a
delay of phase margin over crossover frequency: its delay margin. Look at the overshoot: all periods and delays lie close to
one curve over T/2 + d. Beyond the dashed line, found without any simulation, the joint swings without end. The line is right
to some percent, since T/2 stands for the held samples.
"""

from math import tau

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

law = sw.control.PID(proportional=3.0, derivative=0.15, limit=100.0)
open_loop = sw.Drive(
    gear=sw.Gear(kinematics=sw.kinematics.StrainWave(), stiffness=sw.stiffness.Linear(k=3e4), damping=30.0),
    motor=sw.motor.CurrentSource(torque_constant=0.06, inertia=2e-4),
    load=sw.loads.Inertia(inertia=0.5),
)

# The delay margin: from the response of the angle to the current, times the law.
frequency = np.geomspace(0.5, 200.0, 20000)
loop = sw.linearise(open_loop).response(frequency, "input_angle") * (law.proportional + law.derivative * tau * 1j * frequency)
crossing = np.flatnonzero(np.abs(loop) > 1.0)[-1]
margin = (np.pi + np.unwrap(np.angle(loop))[crossing]) / (tau * frequency[crossing])
print(f"gain 1 at {frequency[crossing]:.1f} Hz, delay margin {margin * 1e3:.2f} ms")

command = sw.scenario.step(0.01, duration=0.8)
periods, parts = np.array([1, 2, 4, 6, 8, 11, 14, 17, 20, 23]) * 1e-3, np.linspace(0.0, 1.0, 6)
overshoot, lateness, still = (np.empty((len(parts), len(periods))) for _ in range(3))
for row, part in enumerate(parts):
    for column, period in enumerate(periods):
        drive = open_loop.replace(control=sw.control.Sampled(law=law, period=period, delay=part * period))
        run = sw.simulate(drive, command, sample=1e-3)
        overshoot[row, column] = run["output_angle"].max() / 0.01 - 1.0
        lateness[row, column] = (0.5 + part) * period
        late, early = (np.ptp(run.between(start, start + 0.15)["output_angle"]) for start in (0.65, 0.35))
        still[row, column] = late < early

figure = Figure(figsize=(7.5, 4.8), layout="constrained")
axes = figure.subplots()
for stable, marker, name in ((1.0, "o", "dies out"), (0.0, "x", "grows")):
    chosen = still == stable
    axes.plot(1e3 * lateness[chosen], 100.0 * overshoot[chosen], marker, label=f"swinging {name}")
axes.axvline(1e3 * margin, linestyle="--", color="black", linewidth=1.0, label="delay margin")
axes.set(xlabel="period / 2 + delay [ms]", ylabel="overshoot [%]", xlim=(0.0, None), yscale="log")
axes.grid(alpha=0.3)
axes.legend(loc="upper left")
figure.savefig("sampled_control.png", dpi=120)
print(f"stable up to {1e3 * lateness[still == 1.0].max():.2f} ms, unstable from {1e3 * lateness[still == 0.0].min():.2f} ms")
