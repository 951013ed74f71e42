"""The soft gear with a compensated controller: the limit cycle of example 14 gone, and the arm where it should be.

A fast position loop on the arm swings for ever; one on the motor rests, but leaves the arm off by the hysteresis. Here the
fast loop stays on the motor, and a slow integral of the error of the arm shifts its command: an `AdaptiveFourier` of order 0.
No step and no push makes it swing. Along a path the model of the gear leads, so that less is left to integrate, also if its
lost motion is 20 % off. An arm without encoder arrives from one side. Look at the loop on the arm with the whole model: no path
makes it swing, but a push does. Numbers besides the gear are assumed.
"""

from typing import Any

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

gear = sw.rig.printed_gear(0).replace(damping=20.0)
motor, arm = sw.motor.TorqueSource(inertia=1e-4), sw.loads.Inertia(inertia=5.0)
law = sw.control.PositionSpeed(position_gain=40.0, speed_proportional=0.05, speed_integral=1.0, limit=5.0, speed_feedforward=1)
integral = sw.compensation.AdaptiveFourier(order=[0.0], gain=5.0, min_speed=0.0, limit=0.02)  # rad: twice the lost motion


def model(share: float) -> sw.compensation.ModelFeedforward:
    """Feed-forward of a model that has this share of the lost motion of the gear."""
    lost: Any = gear.hysteresis
    known = gear.replace({"hysteresis.lost_motion": share * lost.lost_motion})
    return sw.compensation.ModelFeedforward(gear=known, load=arm, motor_inertia=motor.inertia)


def moved(name: str, command: sw.scenario.Scenario, push: sw.scenario.Scenario | float = 0.0) -> sw.Run:
    """A run under the controller of that name, sampled at 1 kHz."""
    feedback, parts = controllers[name]
    control = sw.control.Sampled(law=law.replace(feedback=feedback), period=1e-3, compensation=sw.Compensation(**parts))
    drive = sw.Drive(gear=gear, motor=motor, control=control, load=arm)
    return sw.simulate(drive, command, dt=5e-4, sample=1e-3, load_torque=push)


def along(*targets: float, overshoot: float = 0.0) -> sw.scenario.Scenario:
    """A path to angles [deg] at 5 rad/s2 or less."""
    path = sw.tuning.positioning_path(np.radians(targets), overshoot, speed=2.0, acceleration=5.0).command
    return sw.scenario.table(time, path.value(np.minimum(time, path.duration)))


controllers: dict[str, tuple[str, dict[str, Any]]] = {
    "loop on the arm": ("output", {}),
    "loop on the arm, model": ("output", {"feedforward": model(1.0)}),
    "loop on the motor": ("input", {}),
    "motor, arm integrated": ("input", {"learning": integral}),
    "and model": ("input", {"learning": integral, "feedforward": model(1.0)}),
    "20 % less lost motion": ("input", {"learning": integral, "feedforward": model(0.8)}),
    "20 % more lost motion": ("input", {"learning": integral, "feedforward": model(1.2)}),
}
time, steps = np.linspace(0.0, 6.0, 6001), (0.1, 0.2, 0.3, 0.4, 0.5, 1.0, 2.0, 5.0)  # s, deg
push = sw.scenario.step(20.0, 6.0, start=2.0) - sw.scenario.step(20.0, 6.0, start=2.1)  # N.m
swings, errors, runs = {}, {}, {}
for name, (_, parts) in controllers.items():
    paths = [along(each) for each in steps]
    kinds: dict[str, list[Any]] = {"path": [(each, 0.0) for each in paths], "push": [(each, push) for each in paths]}
    if "feedforward" not in parts:  # the model of an arm that jumps asks for more torque than there is
        kinds["step"] = [(sw.scenario.step(np.radians(each), 6.0), 0.0) for each in steps]
    for kind, inputs in kinds.items():
        of = runs[name, kind] = [np.degrees(moved(name, *each)["output_angle"]) for each in inputs]
        swings[name, kind] = np.array([0.5 * np.ptp(each[4000:]) for each in of])
        errors[name, kind] = np.array([each[-1] - to for each, to in zip(of, steps, strict=True)])
    pairs = zip(runs[name, "path"], paths, strict=True)
    lag = max(np.abs(each - np.degrees(path.value(time))).max() for each, path in pairs)
    print(f"{name:22}: swings by", ", ".join(f"{swings[name, kind].max():.3f} ({kind})" for kind in kinds), end=" deg; ")
    print(f"off by {lag:.3f} deg along paths, {np.abs(errors[name, 'path']).max():.4f} deg after them")
overshoot, apart = sw.tuning.lost_motion(gear, swing=arm.inertia * 5.0).overshoot(), {}  # by the torque of acceleration
for way, beyond in (("both sides", 0.0), ("one side", overshoot)):
    below, above = (moved("loop on the motor", along(*to, overshoot=beyond)) for to in ((0.0, 3.0), (6.0, 3.0)))
    apart[way] = np.degrees(above["output_angle"][-1] - below["output_angle"][-1])
    print(f"arm without encoder, arrivals from {way}: {abs(apart[way]):.4f} deg apart")

figure = Figure(figsize=(8.0, 4.0), layout="constrained")
axes = figure.add_subplot(xlim=(0.0, 2.0), xlabel="time [s]", ylabel="angle of the arm [deg]", title="A step of 1 deg")
for name in ("loop on the arm", "loop on the motor", "motor, arm integrated"):
    axes.plot(time, runs[name, "step"][5], label=name)
axes.plot(time, runs["and model", "path"][5], label="along a path, with model")
axes.legend()
figure.savefig("soft_gear_at_rest.png", dpi=110)
