"""An hour in which a joint warms up: the numbers of its model change, and the compensation follows them while the joint works.

The feed-forward knows the cold joint. As the joint warms up, its friction falls and its gear becomes softer. So the torque and
the twist of the feed-forward become wrong. `FrictionScale` follows the friction by the error of speed and angle.
`TwistIdentification` follows the compliance by both encoders and states its standard deviation. Neither has a thermometer. The
dashed lines are true. The speed loop has no integral, which would hide the friction from its observer. The heat capacities are
a thirtieth of those of a joint, so that two minutes stand for an hour. All thermal numbers are assumed.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from strainwave.tuning.candidates import GEAR_EFFECTS, with_effects
from strainwave.tuning.cascade import Plant, Setting, model_of, observer_of, tuned_law

plant = Plant.of(sw.GearSet.read("robot-joint"), period=1e-3, delay=0.0)
falls = {"friction_input.dry_fall": 0.02, "softening.stiffness_fall": 0.005, "softening.hysteresis_fall": 0.005}  # 1/K
gear = plant.drive.gear.replace(falls)
heat = sw.thermal.Heating(winding_capacity=12.0, winding_resistance=1.0, gear_capacity=2.5, gear_resistance=10.0)
setting = Setting(sharpness=0.25, feedback="input", observer_share=0.5)
law, swing = (
    tuned_law(plant, setting).replace(speed_integral=0.0),
    sw.scenario.sine(0.3, 0.2, 5.0, phase=-np.pi / 2, offset=0.3),
)
scale = sw.compensation.FrictionScale(gain=30.0, position_gain=law.position_gain, min_speed=15.0)
twist = sw.compensation.TwistIdentification(order=[2], compliance_prior=0.1, offset_prior=1e-4, memory=120.0)
number = "control.compensation.learning.{}_compliance"
model = model_of(plant, with_effects(gear, tuple(GEAR_EFFECTS)))
plain = sw.Compensation(feedforward=model, actuation_per_torque=plant.actuation_per_torque)
COMPENSATIONS = {
    "model of the cold joint": plain,
    "with a disturbance observer": plain.replace(observer=observer_of(plant, setting)),
    "with both scales identified": plain.replace(observer=scale, learning=twist),
}


def worked(added: sw.Compensation, rounds: int = 24) -> np.ndarray:
    """Error [rad], friction and compliance, each identified and true, deviation and temperature, after each round."""
    drive = plant.controlled(law, added).replace(gear=gear, thermal=heat, sensors=sw.Sensors())
    state, rows = drive.rest(), []
    for _ in range(rounds):
        run = sw.simulate(drive, swing, dt=1e-3, sample=4e-3, initial=state)
        state, error, speed = run.end, run["command"] - run["output_angle"], float(np.mean(np.abs(run["input_speed"])))
        warm = float(run["temperature"][-1])
        friction = gear.friction_input.steady(speed, temperature=warm) / gear.friction_input.steady(speed)
        unheated = gear.twist(run["torque"])  # that of the cold gear
        row = [np.sqrt(np.mean(error[100:] ** 2)), state.get("control.compensation.observer.scale", 1.0), friction]
        row += [1.0 + state.get(number.format("value"), 0.0), run["twist"] @ unheated / (unheated @ unheated)]
        rows.append([*row, state.get(number.format("deviation"), 0.0), warm])
    return np.array(rows, dtype=float).T


results = {name: worked(added) for name, added in COMPENSATIONS.items()}
error, friction, true_friction, compliance, true_compliance, deviation, warm = results["with both scales identified"]
print(f"the gear warms up from 20 degC to {warm[-1] - 273.15:.0f} degC")
print(f"friction over that of the cold joint: identified {friction[-1]:.2f}, true {true_friction[-1]:.2f}")
print(f"compliance: identified {compliance[-1]:.3f} with deviation {deviation[-1]:.3f}, true {true_compliance[-1]:.3f}")
for name, found in results.items():
    print(f"tracking error of the warm joint {1e6 * found[0, -1]:.0f} urad: {name}")

figure = Figure(figsize=(8.0, 6.4), layout="constrained")
scales, errors = figure.subplots(2, 1)
minutes = 60.0 * np.arange(1, 1 + error.size) / error.size
for label, found, true, colour in (("friction", friction, true_friction, "#c2410c"),
                                   ("compliance", compliance, true_compliance, "#2166ac")):  # fmt: skip
    scales.plot(minutes, found, color=colour, label=f"{label}, identified")
    scales.plot(minutes, true, "--", color=colour, label=f"{label}, true")
band = (compliance - 2.0 * deviation, compliance + 2.0 * deviation)
scales.fill_between(minutes, *band, color="#2166ac", alpha=0.2, label="two standard deviations")
for name, found in results.items():
    errors.plot(minutes, 1e6 * found[0], label=name)
scales.set(xlabel="time [min]", ylabel="over that of the cold joint [1]")
errors.set(xlabel="time [min]", ylabel="tracking error [µrad]", yscale="log")
for axes in (scales, errors):
    axes.legend()
    axes.grid(alpha=0.3)
figure.savefig("warming.png", dpi=110)
