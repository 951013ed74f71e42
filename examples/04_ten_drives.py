"""Ten drives that share no combination of parts, each a TOML file in `drives/`: read, run, drawn.

The script does not depend on which motor, controller, load, sensor or friction a file names. It has only how far each drive
goes and back, in the unit that its controller takes: an angle [rad], or for the rig with a brake and the conveyor a speed
[rad/s].
"""

from pathlib import Path

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

reach = {
    "01-rotary-table": 0.5,
    "02-solar-array": 0.1,
    "03-control-surface": 0.3,
    "04-welding-arm": 0.4,
    "05-toggle-clamp": 1.0,
    "06-brake-rig": 1.0,
    "07-torsion-rig": 0.0,
    "08-exoskeleton": 0.5,
    "09-telescope": 0.01,
    "10-conveyor": 2.0,
}
inputs = {
    "06-brake-rig": {"brake_torque": sw.scenario.constant(20.0, duration=1.0)},
    "07-torsion-rig": {"output_angle": sw.scenario.sine(amplitude=0.05, frequency=2.0, duration=1.0)},
}

figure = Figure(figsize=(10.0, 9.0), layout="constrained")
runs = {}
for axes, (name, far) in zip(figure.subplots(5, 2, sharex=True).flat, reach.items(), strict=True):
    found = sw.GearSet.read(Path(__file__).parent / "drives" / f"{name}.toml")
    command = sw.scenario.sine(amplitude=far / 2, frequency=1.0, duration=1.0, phase=-np.pi / 2, offset=far / 2)
    run = runs[name] = sw.simulate(found.drive, command, sample=1e-3, inputs=inputs.get(name))
    print(f"{found.name:32} largest torque {np.abs(run['torque']).max():6.2f} N.m")
    axes.plot(run.time, run["torque"], linewidth=1.0)
    axes.set(title=found.name, ylabel="torque [N.m]")
    axes.grid(alpha=0.3)
for axes in figure.axes[-2:]:
    axes.set_xlabel("time [s]")
figure.savefig("ten_drives.png", dpi=110)
