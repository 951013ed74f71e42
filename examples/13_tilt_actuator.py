"""A misaligned gear in an actuator that tilts a nacelle: current and torque with and without the misalignment.

The actuator of the flight actuator paper moves its nacelle by 90 degrees in 5 s, against the air stream. Its wave generator
sits 10 um off the axis of the circular spline and leans by 0.05 degrees. Look at the current: its ripple comes twice per turn
of the generator, at 10.1 Hz, and near the end of the stroke it is about what the load makes of the error. The flight actuator
paper finds torques significantly greater than nominal: here the peak is 1 % greater, and 3 % with twice the misalignment. The
gear is lumped: "tilt-actuator" has its stages, and shows the same.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

drive = sw.load("tilt-actuator-lumped")
ratio, misalignment = drive.gear.kinematics.ratio, drive.gear.kinematic_error
ramp = sw.scenario.ramp(np.radians(90.0) / 5.0, duration=5.0)
laws = {
    "aligned": misalignment.replace(housing_eccentricity=0.0, housing_tilt_x=0.0),
    "misaligned": misalignment,
    "twice as much": misalignment.replace(
        housing_eccentricity=2.0 * misalignment.housing_eccentricity, housing_tilt_x=2.0 * misalignment.housing_tilt_x
    ),
}
runs = {name: sw.simulate(drive.replace({"gear.kinematic_error": law}), ramp, sample=1e-3) for name, law in laws.items()}
turn = 2.0 * np.pi / (ratio * np.radians(18.0))  # s, of the wave generator

figure = Figure(figsize=(8.0, 8.5), layout="constrained")
current, torque, spectra = figure.subplots(3, 1)
straight = runs["aligned"]
found: dict[str, dict[str, float]] = {}
for name, run in reversed(runs.items()):
    current.plot(run.time, run["current"], linewidth=0.9, label=name)
    last = run.between(5.0 - 5.0 * turn, 5.0)
    orders = np.arange(1.0, 13.0)
    rippled = sw.orders.order_amplitudes(last, "current", orders).amplitude
    spectra.bar(orders + 0.25 * len(found) - 0.25, 1e3 * rippled, width=0.25, label=name)  # side by side
    later = run.time > 0.5
    found[name] = {
        "error": sw.orders.order_amplitudes(last, "kinematic_error", [2.0]).amplitude[0],
        "current": rippled[1],
        "peak": run["torque"][later].max() / straight["torque"][later].max(),
        "load": last["torque"].mean(),
        "end": np.degrees(run["output_angle"][-1]),
    }
    if name != "aligned":
        torque.plot(run.time, run["torque"] - straight["torque"], linewidth=0.9, label=f"{name}, less aligned")
current.set(ylabel="current [A]", title="A tilt of 90 deg in 5 s")
torque.set(ylabel="difference of the torque [N.m]", xlabel="time [s]", ylim=(-0.8, 2.4))
spectra.set(
    xlabel="order of the wave generator [1]", ylabel="amplitude of the current [mA]", xlim=(0.0, 13.0), ylim=(0.0, 170.0)
)
for axes in (current, torque, spectra):
    axes.grid(alpha=0.3)
    axes.legend()
figure.savefig("tilt_actuator.png", dpi=110)
for name, values in found.items():
    asked = 2.0 * values["load"] * values["error"] / drive.motor.torque_constant  # A, by the reaction of the error alone
    print(f"{name:13}: ends at {values['end']:.2f} deg; order 2 of the error {1e6 * values['error']:5.1f} urad,", end=" ")
    print(f"of the current {1e3 * values['current']:5.1f} mA (load x error x 2 / K: {1e3 * asked:5.1f} mA);", end=" ")
    print(f"peak of the torque {values['peak']:.3f} times the aligned one")
