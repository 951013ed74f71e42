"""A control surface of an eVTOL aircraft under gusts: what a feed-forward removes, and what only feedback removes.

The actuator of example 13 moves a surface to and fro in the air stream. Gusts come as one minus cosine of the way flown, as
certification has them (CS-25.341: half length H, velocity 17.07 m/s (H / 106.7 m)^(1/6)); a gust w turns the stream by w / V.
The feed-forward of a model removes the error of the motion: friction, torsion, inertia, the steady stream. It removes nothing
of a gust, which no command announces. A disturbance observer does, of a long gust more than of a short one. What is left of
the long one is mainly the kinematic error, which makes ripple of its torque. The surface and its hinge moment are assumed and
quasi-steady; sensors are ideal, and the model is right.
"""

from typing import Any

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from strainwave.tuning.cascade import Plant, Setting, model_of, observer_of, tuned_law

speed = 40.0  # m/s, of the aircraft
surface = sw.loads.Aerodynamic(inertia=0.05, area=0.4, chord=0.2, airspeed=speed, moment_slope=0.4)
actuator = sw.load("tilt-actuator-lumped").replace(load=surface, sensors=sw.Sensors())
plant = Plant.of(sw.GearSet.of(actuator, name="surface", source="assumed"), period=1e-3, delay=5e-4)
setting = Setting(sharpness=0.25, feedback="output", observer_share=0.5)
law, observer = tuned_law(plant, setting), observer_of(plant, setting)
model = model_of(plant, plant.drive.gear).replace(presliding=0.1)  # rad of the input: friction turns within 1 mrad
parts: dict[str, dict[str, Any]] = {
    "cascade": {},
    "cascade with model": {"feedforward": model},
    "cascade with observer": {"observer": observer},
    "model and observer": {"feedforward": model, "observer": observer},
}
command = sw.scenario.sine(amplitude=0.15, frequency=0.25, duration=5.0, phase=-np.pi / 2, offset=0.15)
begin = 2.1  # s: the surface moves from 2 to 4 s, so that friction has one sense


def gust(half_length: float) -> sw.scenario.Scenario:
    """Torque at the hinge [N.m] of a gust that takes this way [m] to its top; `load_torque` is positive if it holds back."""
    time = np.linspace(0.0, command.duration, 5001)
    way = np.clip(speed * (time - begin), 0.0, 2.0 * half_length)
    velocity = 0.5 * 17.07 * (half_length / 106.7) ** (1.0 / 6.0) * (1.0 - np.cos(np.pi * way / half_length))
    pressure = 0.5 * surface.density * speed**2
    moment = pressure * surface.area * surface.chord * surface.moment_slope * np.sin(velocity / speed)
    return sw.scenario.table(time, moment)


gusts = {"calm": 0.0} | {f"H = {length:g} m": gust(length) for length in (9.0, 18.0, 35.0)}
runs, tracking, deviation = {}, {}, {}
for name, added in parts.items():
    drive = plant.controlled(law, sw.Compensation(**added, actuation_per_torque=plant.actuation_per_torque))
    for air, torque in gusts.items():
        run = runs[name, air] = sw.simulate(drive, command, load_torque=torque, sample=1e-3)
        error = (run["command"] - run["output_angle"])[2000:]
        tracking[name, air] = np.sqrt(np.mean(error**2))
        deviation[name, air] = np.abs(run["output_angle"] - runs[name, "calm"]["output_angle"]).max()
    print(f"{name:22}: error {1e6 * tracking[name, 'calm']:4.0f} urad rms in calm air;", end=" ")
    pushed = (f"{1e3 * deviation[name, air]:.2f} ({air})" for air in list(gusts)[1:])
    print("a gust moves it by", ", ".join(pushed), "mrad")

figure = Figure(figsize=(8.0, 7.0), layout="constrained")
above, below = figure.subplots(2, 1)
for (name, air), run in runs.items():
    if air == "H = 18 m":
        above.plot(run.time, 1e3 * (run["command"] - run["output_angle"]), linewidth=0.9, label=name)
lengths = np.array([float(air.split()[2]) for air in list(gusts)[1:]])
for name, mark in zip(parts, ("o-", "s--", "^-", "x--"), strict=True):
    below.plot(lengths, [1e3 * deviation[name, air] for air in list(gusts)[1:]], mark, label=name)
above.set(xlim=(2.0, 5.0), ylim=(-6.0, 6.0), xlabel="time [s]", ylabel="error [mrad]", title="With a gust of H = 18 m")
below.set(xlabel="half length H of the gust [m]", ylabel="largest deviation [mrad]", title="Deviation by the gust alone")
for axes in (above, below):
    axes.grid(alpha=0.3)
    axes.legend()
figure.savefig("surface_under_gust.png", dpi=110)
