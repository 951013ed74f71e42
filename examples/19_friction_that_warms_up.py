"""A joint that warms up: the scale of its friction is observed while it works, and the compensation stays right.

The feed-forward knows the friction of the cold joint. As its grease warms up, friction falls, and what is fed forward becomes
too much. The observer of the scale follows by the error of speed and angle, without a thermometer. The dashed line is true:
the friction of the warm joint over that of the cold one at the mean speed of the motion. The heat capacities are small, so that
three minutes stand for an hour.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from strainwave.tuning.candidates import EFFECTS, with_effects
from strainwave.tuning.cascade import Plant, Setting, model_of, observer_of, tuned_law

joint = sw.GearSet.read("robot-joint")
plant = Plant.of(joint, period=1e-3, delay=0.0)
gear = plant.drive.gear.replace({"friction_input.dry_fall": 0.02})  # its dry friction falls, too
heat = sw.thermal.Heating(winding_capacity=50.0, winding_resistance=1.0, gear_capacity=20.0, gear_resistance=2.0)
law = tuned_law(plant, Setting(sharpness=0.25, feedback="input", observer_share=0.0))
Observer = sw.compensation.NoObserver | sw.compensation.DisturbanceObserver | sw.compensation.FrictionScale
swing = sw.scenario.sine(0.5, 0.5, 4.0, phase=-np.pi / 2, offset=0.5)


def worked(observer: Observer, rounds: int = 40) -> np.ndarray:
    """Temperature [K], tracking error [rad], observed and true scale of friction after each round of four seconds."""
    model = model_of(plant, with_effects(gear, tuple(EFFECTS)))
    added = sw.Compensation(feedforward=model, observer=observer, actuation_per_torque=plant.actuation_per_torque)
    drive = plant.controlled(law, added).replace(gear=gear, thermal=heat, sensors=sw.Sensors())
    state, rows = drive.rest(), []
    for _ in range(rounds):
        run = sw.simulate(drive, swing, sample=4e-3, start=state)
        state, warm, error = run.end, float(run["temperature"][-1]), run["command"] - run["output_angle"]
        speed = float(np.mean(np.abs(run["input_speed"])))
        true = gear.friction_input.steady(speed, temperature=warm) / gear.friction_input.steady(speed)
        scale = state["control.compensation.observer.scale"] if isinstance(observer, sw.compensation.FrictionScale) else 1.0
        rows.append((warm, float(np.sqrt(np.mean(error[100:] ** 2))), scale, float(true)))
    return np.array(rows).T


observer = sw.compensation.FrictionScale(gain=2.0, position_gain=law.position_gain, min_speed=30.0)
cold, observed = worked(sw.compensation.NoObserver()), worked(observer)
disturbed = worked(observer_of(plant, Setting(sharpness=0.25, feedback="input", observer_share=0.5)))
print(f"the gear warms up from 20 degC to {observed[0, -1] - 273.15:.0f} degC")
print(f"scale of friction: observed {observed[2, -1]:.2f}, true {observed[3, -1]:.2f}")
ends = (1e6 * each[1, -1] for each in (cold, disturbed, observed))
print("tracking error: {:.0f} urad by the cold model, {:.0f} with a disturbance observer, {:.0f} with the scale".format(*ends))

figure = Figure(figsize=(8.0, 3.6), layout="constrained")
scales, errors = figure.subplots(1, 2)
time = 4.0 * np.arange(1, 1 + observed.shape[1])
scales.plot(time, observed[2], color="#c2410c", label="observed")
scales.plot(time, observed[3], "--", color="#1c2127", label="true")
errors.plot(time, 1e6 * cold[1], color="#2166ac", label="model of the cold joint")
errors.plot(time, 1e6 * disturbed[1], color="#7b3fa0", label="with a disturbance observer")
errors.plot(time, 1e6 * observed[1], color="#c2410c", label="with the scale observed")
scales.set(xlabel="time [s]", ylabel="friction over that of the cold joint [1]")
errors.set(xlabel="time [s]", ylabel="tracking error [µrad]")
for axes in (scales, errors):
    axes.legend()
    axes.grid(alpha=0.3)
figure.savefig("warming.png", dpi=110)
