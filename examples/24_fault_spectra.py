"""Spectra of the motor current over the order: a healthy joint, and four faults whose orders differ.

A record has two revolutions of the output, 200 of the input, so that orders 2 and 2.02 are two lines. Look at whole orders and
those 1 % beside them: a misalignment stands still with the housing, worn teeth and a crack turn with the flexspline.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from strainwave import fault

speed, load, noise = 25.0, 40.0, 0.05  # rad/s of the input, N.m at the output, A rms of a sample at 1 kHz
loops = {"position_gain": 20.0, "speed_proportional": 1.5, "speed_integral": 30.0, "speed_feedforward": 1.0}
inner = {"current_proportional": 2.0, "current_integral": 1000.0, "current_limit": 40.0, "voltage_limit": 27.0}
joint = sw.Drive(
    gear=sw.load("csg-25-100"),
    motor=sw.motor.PMSM(pole_pairs=4, inertia=1e-4, current_limit=40.0),
    control=sw.control.Cascade(**loops, **inner, feedback="input"),
    load=sw.loads.Inertia(inertia=0.1),
)
faults = {
    "misalignment, 10 µm": fault.Misalignment(severity=1.0 / 3.0),
    "worn teeth of the flexspline, 0.17′": fault.ToothWear(play=0.0, severity=1.0 / 3.0),
    "crack of the flexspline, 10 % of the stiffness": fault.FlexsplineCrack(severity=1.0 / 3.0),
    "bearing of the wave generator, 7 % of the friction": fault.WaveGeneratorBearing(severity=1.0 / 3.0),
}
duration = 1.0 + 200.5 * 2.0 * np.pi / speed
command = sw.scenario.ramp(rate=speed / 100.0, duration=duration)


def spectrum(drive: sw.Drive, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return orders and amplitudes [mA] of a record of the current with the noise of a sensor."""
    run = sw.simulate(drive, command, 5e-4, load_torque=load, sample=1e-3, record=["input_angle", "current"])
    record = run.between(1.0, duration)
    current = record["current"] + noise * np.random.default_rng(seed).standard_normal(len(record))
    lines = sw.orders.order_spectrum(record.with_column("current", current, "A"), "current", 12.5)
    return lines["order"], 1e3 * lines["amplitude"]


order, healthy = spectrum(joint, 0)
found = {name: spectrum(sw.dataset.with_faults(joint, [each]), seed)[1] for seed, (name, each) in enumerate(faults.items(), 1)}
floor = (
    1e3 * noise * np.sqrt(6.0 * np.log(1e3) / (1e3 * (duration - 1.0)))
)  # mA by noise under a Hann window, in 1 of 1000 lines

figure = Figure(figsize=(9.0, 11.0), layout="constrained")
peaks: dict[str, list[int]] = {}  # lines above noise that are higher than those around
for number, (axes, (name, amplitude)) in enumerate(zip(figure.subplots(4, 1), found.items(), strict=True)):
    highest = [k for k in range(100, len(order) - 3) if amplitude[k] == amplitude[k - 2 : k + 3].max() > 1.5 * floor]
    peaks[name] = highest
    for each in (axes, inset := axes.inset_axes((0.16, 0.4, 0.12, 0.55))):
        each.semilogy(order, amplitude, color=f"C{number}", lw=1.0)
        each.semilogy(order, healthy, color="0.35", lw=0.8)
    inset.set(xlim=(1.98, 2.04), xticks=(2.0, 2.02), xticklabels=("2", "2.02"), ylim=(0.1, 1000.0), yticklabels=())
    inset.tick_params(labelsize="small")
    axes.axhline(floor, color="k", ls=":", lw=1.0)
    for k in highest:
        label = {"textcoords": "offset points", "fontsize": "small", "ha": "right" if order[k] < 2.01 else "left"}
        axes.annotate(f"{order[k]:.2f}", (order[k], amplitude[k]), (0, 4), **label)
    axes.set(ylabel="current [mA]", xlim=(0.5, 12.0), ylim=(0.1, 1000.0))
    axes.set_title(f"{name}; grey: healthy", loc="left", fontsize="medium")
    axes.grid(alpha=0.3)
    print(f"{name:50}", ", ".join(f"{order[k]:.2f}: {amplitude[k]:.1f} mA" for k in highest))
axes.set_xlabel("order, cycles per revolution of the input")
figure.savefig("fault_spectra.png", dpi=90)
