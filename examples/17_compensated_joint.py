"""A joint that swings an arm to and fro, with and without compensation, and with a model that is wrong.

The gear is that of a catalogue, taken as though every number had been measured to 5 %. The controller to beat is the tuned
cascade of `sw.compensate`, with feed-forward of inertia, weight, Coulomb and viscous friction. What a model gains over it
depends on how right it is: each number of the gear is made larger or smaller than the model has it.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from strainwave.files.entries import Entry
from strainwave.parameters import every

stated = sw.GearSet.read("robot-joint")
joint = stated.replace(sources=dict.fromkeys(stated.sources, Entry("measured", spread=0.05)))
found = sw.compensate(joint, encoder="output", members=3, travel=0.05)
before, after = (1e6 * each.median("tracking error") for each in (found.baseline, found.chosen))
print(f"{found.chosen.candidate.name}:")
print(f"tracking error {before:.0f} urad with the cascade, {after:.0f} urad with it")

command = found.goal.command
controllers = {"cascade": found.baseline.candidate.drive, "compensated": found.drive}
parts = ("gear.friction_input", "gear.stiffness", "gear.hysteresis", "gear.kinematic_error.amplitude")
changed = (0.7, 0.9, 1.0, 1.1, 1.3)


def errors(drive: sw.Drive) -> np.ndarray:
    """Error of the output [rad] for each change, shape (changes, samples)."""
    units = ("N.m", "N.m/rad", "N.m.s/rad", "rad")
    numbers = {path: each.value for path, each in every(drive).items() if path.startswith(parts) and each.unit in units}
    values = {path: value * np.array(changed) for path, value in numbers.items()}
    runs = sw.simulate_many(drive, command, values, record=["output_angle"], sample=1e-3)
    return np.asarray(command.value(runs.time) - runs["output_angle"])


later = slice(int(500 * command.duration), None)
traces = {name: errors(drive) for name, drive in controllers.items()}
print("the gear has of what the model has".ljust(40), "  ".join(f"{factor:.0%}".rjust(6) for factor in changed))
for name, trace in traces.items():
    print(f"{name}: error [urad]".ljust(40), "  ".join(f"{1e6 * np.sqrt(np.mean(row[later] ** 2)):6.1f}" for row in trace))

figure = Figure(figsize=(7.0, 4.0), layout="constrained")
axes = figure.add_subplot()
time = np.linspace(0.0, command.duration, traces["cascade"].shape[1])
for (name, trace), color in zip(traces.items(), ("#2166ac", "#c2410c"), strict=True):
    axes.plot(time[later], 1e6 * trace[changed.index(1.0)][later], color=color, label=name)
axes.set(xlabel="time [s]", ylabel="error of the output [µrad]")
axes.legend()
figure.savefig("compensated_joint.png")
