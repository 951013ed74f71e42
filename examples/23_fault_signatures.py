"""Signatures of faults: the signal that each fault of the package changes, over its severity, in a joint of the catalogue.

Dashed is the healthy joint, grey what noise and sensors hide. Look at the severity at which a curve leaves the grey band.
"""

from functools import cache
from typing import Any

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from strainwave import fault

speed, load, noise, rate = 25.0, 40.0, 0.05, 1000.0  # rad/s of the input, N.m at the output, A of a sample, samples per s
loops = {"position_gain": 20.0, "speed_proportional": 1.5, "speed_integral": 30.0, "speed_feedforward": 1.0}
inner = {"current_proportional": 2.0, "current_integral": 1000.0, "current_limit": 40.0, "voltage_limit": 27.0}
joint = sw.Drive(
    gear=sw.load("csg-25-100"),
    motor=sw.motor.PMSM(pole_pairs=4, inertia=1e-4, current_limit=40.0, cogging_torque=1e-3, cogging_order=24),
    control=sw.control.Cascade(**loops, **inner, feedback="input"),
    load=sw.loads.Inertia(inertia=0.1),
    sensors=sw.Sensors(input_angle=sw.sensor.Encoder(counts=2**17)),
)
severities, recorded = [0.0, 0.25, 0.5, 1.0], ["input_angle", "output_angle", "current", "voltage"]
LINE, MEAN, VOLTAGE, REST, TWIST = "current [mA]", "mean current [A]", "voltage / current [Ω]", "offset [′]", "twist [′]"
faults: dict[str, tuple[Any, str, tuple[float, ...], int]] = {  # signal, orders of a line, turns recorded
    "misalignment, 30 µm": (fault.Misalignment(housing_direction=np.pi / 4.0), LINE, (2.0, 4.0), 12),
    "misalignment, 0.43°": (fault.Misalignment(housing_eccentricity=0.0, housing_tilt_x=7.5e-3), LINE, (2.0, 4.0), 12),
    "tooth wear, wave of 0.5′": (fault.ToothWear(play=0.0), LINE, (2.02, 2.0), 50),
    "tooth wear, play of 1′": (fault.ToothWear(amplitude=0.0), TWIST, (), 0),
    "crack, 30 % of the stiffness": (fault.FlexsplineCrack(), LINE, (2.02, 4.04, 6.06, 2.0), 50),
    "bearing, 20 % of the friction": (fault.WaveGeneratorBearing(), LINE, (10.41227, 20.82454), 12),
    "lubrication loss": (fault.LubricationLoss(), MEAN, (), 12),
    "preload loss": (fault.PreloadLoss(), TWIST, (), 0),
    "linkage play of 1.7′": (fault.LinkagePlay(), TWIST, (), 0),
    "encoder offset, 0.57°": (fault.EncoderOffset(shaft="input", offset=1e-2), REST, (), 0),
    "encoder eccentricity, 0.29°": (fault.EncoderEccentricity(shaft="input", eccentricity=5e-3), LINE, (1.0,), 12),
    "speed sensor bias, 0.1 rad/s": (fault.SensorBias(quantity="input_speed", offset=0.1), REST, (), 0),
    "winding resistance, +20 %": (fault.PhaseResistance(), VOLTAGE, (), 12),
    "uneven phase, +20 %": (fault.PhaseResistance(rise=0.0, excess=0.1), LINE, (8.0,), 12),
    "open phase": (fault.OpenPhase(resistance=5.0), LINE, (8.0,), 12),
    "one of two winding sets open": (fault.WindingSetLoss(), VOLTAGE, (), 12),
    "one of two winding sets shorted": (fault.WindingSetLoss(terminals="shorted"), MEAN, (), 12),
    "magnet loss, 30 %": (fault.MagnetLoss(), MEAN, (), 12),
    "cogging, 5 mN·m": (fault.Cogging(), LINE, (24.0,), 12),
    "inverter dead time, 1 V": (fault.InverterDeadTime(), LINE, (24.0,), 12),
}
highest = 1e3 * noise * np.sqrt(4.0 * np.log(1e3) * speed / (2.0 * np.pi * rate))  # mA by noise, in 1 of 1000 records of a turn
hidden = {MEAN: 0.05, VOLTAGE: 0.01, REST: 0.041, TWIST: 0.041}  # offset of a current sensor; 1 %; a count of 19 bit


@cache
def measured(drive: sw.Drive, signal: str, orders: tuple[float, ...], turns: int) -> list[float]:
    """Return the signal of a drive that turns under load or rests: of lines, the amplitude of each order."""
    begin, end = (1.0, 1.0 + (turns + 0.1) * 2.0 * np.pi / speed) if turns else (2.0, 4.0)
    push = sw.scenario.sine(amplitude=5.0, frequency=0.5, duration=end) if signal == TWIST else load * bool(turns)
    command = sw.scenario.ramp(rate=speed / 100.0 * bool(turns), duration=end)
    run = sw.simulate(drive, command, load_torque=push, sample=1.0 / rate, record=recorded).between(begin, end)
    if signal == LINE:
        return list(1e3 * sw.orders.order_amplitudes(run, "current", orders).amplitude)
    if not turns:
        return [60.0 * np.degrees(np.ptp(run["output_angle"]) if signal == TWIST else abs(run["output_angle"].mean()))]
    return [abs(run["current"].mean() if signal == MEAN else run["voltage"].mean() / run["current"].mean())]


figure = Figure(figsize=(14.0, 12.5), layout="constrained")
found: dict[str, np.ndarray] = {}  # signal by severity and order
for axes, (name, (worst, signal, orders, turns)) in zip(figure.subplots(5, 4).flat, faults.items(), strict=True):
    faulty = [sw.dataset.with_faults(joint, [worst.replace(severity=severity)]) for severity in severities[1:]]
    found[name] = np.array([measured(drive, signal, orders, turns) for drive in (joint, *faulty)])
    floor = hidden.get(signal, highest / np.sqrt(max(turns, 1)))
    for number, (order, values) in enumerate(zip(orders or [None], found[name].T, strict=True)):
        axes.axhspan(values[0] - floor, values[0] + floor, color="0.85", lw=0)
        axes.axhline(values[0], color=f"C{number}", ls="--", lw=1.0)
        axes.plot(severities, values, "o-", color=f"C{number}", label=f"order {order:.4g}" if order else signal)
        seen = np.interp(floor, np.maximum.accumulate(np.abs(values - values[0])), severities, right=np.inf)
        print(f"{name:32} {order or signal!s:23} {values[0]:7.3g} to {values[-1]:7.3g}, seen from severity {seen:.2f}")
    axes.set(title=name, xlabel="severity", ylabel=signal, xlim=(0.0, 1.0), ylim=(0.0, None))
    axes.legend(fontsize="small")
figure.savefig("fault_signatures.png", dpi=90)
