"""A pointing joint that creeps: friction by the measured motion removes its stick-slip, but not that of the output.

A computer closes the loop of the joint, at -20 degC, a hundred times per second, by a speed that lags behind by 5 ms. This is
too slow for friction that falls as the speed rises. The tuned cascade sticks and slips, with a disturbance observer or with a
model of friction along the command, which does not stick. A bristle observer follows the measured motion, and the joint moves.
On the right the loop is ten times as fast, and a seal rubs at the output. Below a critical speed none of them removes that.
"""

import dataclasses

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from strainwave.tuning.candidates import with_effects
from strainwave.tuning.cascade import Plant, Setting, bare, model_of, observer_of, tuned_law

COLD = {"gear.friction_input.reference_temperature": 293.15 + 40.0}  # K: as far above the joint as +20 degC above -20 degC
SEAL = {"gear.friction_output": sw.friction.Stribeck(coulomb=0.3, breakaway=0.6, stribeck_speed=5e-4)}


def plant_of(period: float, lag: float) -> Plant:
    """The joint under a controller of this period [s], by a measured speed of this lag [s]."""
    plant = Plant.of(sw.GearSet.read("space-pointing-joint"), period=period, delay=0.0)
    sensors = sw.Sensors(input_speed=sw.sensor.FirstOrder(time_constant=lag))
    return dataclasses.replace(plant, drive=plant.drive.replace(sensors=sensors, thermal=sw.thermal.Isothermal()).replace(COLD))


def controllers(plant: Plant, sharpness: float) -> dict[str, sw.Drive]:
    """The drive under the tuned cascade with each compensation."""
    setting = Setting(sharpness=sharpness, feedback="input", observer_share=0.5)
    gear, law = plant.drive.gear, tuned_law(plant, setting)
    line, model = model_of(plant, bare(gear)), model_of(plant, with_effects(gear, ("friction",)))
    bristles = sw.compensation.BristleObserver(
        friction=gear.friction_input, friction_share=0.9, bristle_gain=2.0, position_gain=law.position_gain
    )
    parts = {
        "cascade, disturbance observer": sw.Compensation(feedforward=line, observer=observer_of(plant, setting)),
        "friction of a model": sw.Compensation(feedforward=model),
        "bristle observer": sw.Compensation(feedforward=line, observer=bristles),
        "dither": sw.Compensation(feedforward=line, dither=sw.compensation.Dither(amplitude=0.04, frequency=40.0)),
    }
    per_torque = plant.actuation_per_torque
    return {name: plant.controlled(law, part.replace(actuation_per_torque=per_torque)) for name, part in parts.items()}


def crept(drive: sw.Drive, speed: float) -> sw.Recording:
    """The second half of a ramp at a speed of the input [rad/s]."""
    duration = max(4.0, 2.0 / speed)
    return sw.simulate(drive, sw.scenario.ramp(speed / 100.0, duration), 5e-4, sample=5e-3).between(duration / 2, duration)


def figures(drive: sw.Drive, speed: float) -> tuple[float, float]:
    """Share of the time that the output rests, and ripple of its speed."""
    share = 100.0 * crept(drive, speed)["output_speed"] / speed
    return float(np.mean(np.abs(share) < 0.1)), float(np.sqrt(np.mean((share - 1.0) ** 2)))


computer, servo = plant_of(0.01, 5e-3), plant_of(1e-3, 5e-4)
sealed = controllers(dataclasses.replace(servo, drive=servo.drive.replace(SEAL)), 0.35)
cases = {"friction at the input": (controllers(computer, 1.0), (0.2, 0.4, 0.7, 1.0, 2.0)),
         "friction at the output, too": (sealed, (0.05, 0.1, 0.2, 0.4))}  # fmt: skip
found = {case: {name: np.array([figures(each, speed) for speed in speeds]) for name, each in drives.items()}
         for case, (drives, speeds) in cases.items()}  # fmt: skip
for (case, each), speed in zip(found.items(), (0.2, 0.05), strict=True):
    for name, rows in each.items():
        print(f"{case}, {speed} rad/s: at rest {rows[0, 0]:4.0%} of the time, ripple {rows[0, 1]:.2f} by {name}")

figure = Figure(figsize=(9.0, 3.6), layout="constrained")
for axes, (case, each) in zip(figure.subplots(1, 2, sharey=True), found.items(), strict=True):
    for (name, rows), style in zip(each.items(), ("o-", "s--", "D-", ".:"), strict=True):
        axes.semilogx(cases[case][1], 100.0 * rows[:, 0], style, label=name)
    axes.minorticks_off()
    axes.set_xticks(cases[case][1], [f"{speed:g}" for speed in cases[case][1]])
    axes.set(xlabel="speed of the input [rad/s]", title=case)
    axes.grid(alpha=0.3)
figure.axes[0].set(ylabel="time at rest [%]")
figure.axes[0].legend()
figure.savefig("creeping.png", dpi=110)
