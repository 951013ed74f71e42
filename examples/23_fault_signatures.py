"""Signatures of faults: the line that each makes in the motor current of a loaded joint, over its severity.

A fault is a change of numbers of the drive, so one prepared drive runs at every severity. Look at the slopes: all lines grow in
proportion to the severity. Worn teeth and a crack have order 2.02 in common; the crack has multiples of it as well.
"""

from typing import Any

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from strainwave.dataset.faults import changes, prepared

stiffness, torque_constant, load, speed = 8000.0, 0.05, 20.0, 10.0
joint = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.StrainWave(),
        stiffness=sw.stiffness.Linear(k=stiffness),
        damping=4.0,
        friction_input=sw.friction.Coulomb(coulomb=0.05),
    ),
    motor=sw.motor.CurrentSource(torque_constant=torque_constant, inertia=1.5e-4),
    control=sw.control.PI(proportional=10.0, integral=100.0, limit=40.0),
    load=sw.loads.Inertia(inertia=0.05),
)
facts = sw.fault.Facts(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline", ratio=-100.0)
bearing = sw.fault.WaveGeneratorBearing(friction_depth=0.3, waves=1)
faults: dict[str, tuple[Any, list[float]]] = {
    "misalignment": (sw.fault.Misalignment(housing_eccentricity=3e-5, combine="max"), [2.0, 4.0]),
    "worn teeth": (sw.fault.ToothWear(play=0.0, amplitude=3e-4), [2.02]),
    "crack": (sw.fault.FlexsplineCrack(depth=0.05, waves=2), [2.02, 4.04]),
    "bearing": (bearing, [order for *_, order in bearing.changes(facts)]),
}
severities = np.array([0.0, 0.25, 0.5, 1.0])
duration = 2.0 + 12.0 * 2.0 * np.pi / speed
command = sw.scenario.constant(speed / joint.gear.kinematics.ratio, duration)

found: dict[tuple[str, float], np.ndarray] = {}  # amplitude [A] at each severity, by fault and order
for name, (fault, orders) in faults.items():
    ready = prepared(joint, [fault])
    numbers = [changes(ready, [fault.replace(severity=float(severity))]) for severity in severities]
    columns = {path: [each[path] for each in numbers] for path in numbers[0]}
    runs = sw.simulate_many(ready, command, columns, load_torque=load, sample=1e-3, record=["input_angle", "current"])
    settled = [runs.member(number).between(2.0, duration) for number in range(len(runs))]
    for order in orders:
        found[name, order] = np.array([sw.order_amplitudes(run, "current", order).amplitude[0] for run in settled])

figure = Figure(figsize=(7.0, 4.5), layout="constrained")
axes = figure.subplots()
for (name, order), amplitude in found.items():
    axes.plot(severities, 1e3 * amplitude, "o-", label=f"{name}, order {order:.4g}")
axes.set(xlabel="severity", ylabel="amplitude of the current [mA]", xlim=(0.0, 1.0), ylim=(0.0, None))
axes.grid(alpha=0.3)
axes.legend()
figure.savefig("fault_signatures.png", dpi=120)
for (name, order), amplitude in found.items():
    print(f"{name:12}  order {order:7.4f}: {(1e3 * amplitude).round(2)} mA at severities {severities}")
