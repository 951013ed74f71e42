"""A servo on a soft gear: limit cycle and bandwidth over amplitude.

The torsional stiffness article warns that low stiffness at a reversal of the torque may bring "instability, limit cycling, or
reduced bandwidth". Here its gear, as the loop of Table 2 has it, carries an arm, and the position loop is closed on the arm.
Look at the steps: after one of 0.3 degrees the arm rests, after one of 0.4 degrees it swings for ever by 0.69 degrees at 9.3
Hz. Such a limit cycle is foretold by the describing function. With a gear as stiff as in unloading there is none, nor with the
loop on the motor. A slower loop attenuates large commands no more than small ones up to 6 Hz, and a peak appears; at 8 Hz its
gain is not ordered by amplitude. Other numbers are assumed.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from scipy.optimize import fsolve

gear = sw.rig.printed_gear(0).replace(damping=20.0)
ratio, width = gear.kinematics.ratio, 0.505  # deg at the output; 50.5 deg at the input, Table 2
motor, arm = sw.motor.TorqueSource(inertia=1e-4), sw.loads.Inertia(inertia=5.0)
loop = sw.control.PositionSpeed(position_gain=40.0, speed_proportional=0.05, speed_integral=1.0, limit=5.0, feedback="output")
drive = sw.Drive(gear=gear, motor=motor, control=loop, load=arm)
stiff = {"gear.hysteresis": sw.hysteresis.MaxwellSlip(), "gear.stiffness": sw.stiffness.Linear(k=4.51 * ratio**2)}
on_motor = drive.replace({"control.feedback": "input"})
drives = {"the article's gear": drive, "as stiff as its unloading": drive.replace(stiff), "loop on the motor": on_motor}


def swinging(drive: sw.Drive, degrees: float) -> tuple[sw.Run, float, float]:
    """A step; half the swing that is left [rad] after four seconds, and its frequency [Hz], 0 where it is at rest."""
    run = sw.simulate(drive, sw.scenario.step(np.radians(degrees), duration=6.0), sample=1e-3, dt=5e-4)
    late, above = run.between(4.0, 6.0), run.between(4.0, 6.0)["output_angle"] > np.radians(degrees)
    rises, swing = late.time[1:][~above[:-1] & above[1:]], 0.5 * np.ptp(late["output_angle"])
    return run, swing, (len(rises) - 1) / np.ptp(rises) if swing > 1e-6 else 0.0


def complex_stiffness(twist: float) -> complex:
    """First harmonic of the torque over that of the twist, for a sine of the twist about the middle of the loop."""
    phase = np.arange(1440) * 2.0 * np.pi / 720  # the second turn counts
    torque = gear.trace(twist * np.cos(phase))
    return complex(2.0 * np.mean((torque * np.exp(-1j * phase))[720:]) / twist)


def balance(unknown: np.ndarray) -> list[float]:
    """What is left of the loop at a swing of the twist [deg] and a frequency [Hz]; zero in a limit cycle."""
    s = 2j * np.pi * unknown[1]
    spring = complex_stiffness(np.radians(unknown[0])) + gear.damping * s
    share = spring / (spring + arm.inertia * s**2)  # angle of the arm over that of the motor, referred to the output
    driven = (loop.speed_proportional + loop.speed_integral / s) * (s + loop.position_gain * share)
    left = motor.inertia * s**2 + driven + spring * (1.0 - share) / ratio**2
    return [left.real, left.imag]


steps = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 1.0, 2.0, 5.0])  # degrees
runs = {name: [swinging(each, step) for step in steps.tolist()] for name, each in drives.items()}
swings = {name: np.array([each[1:] for each in found]) for name, found in runs.items()}
foretold = fsolve(balance, [0.5, 9.0])
slower = drive.replace({"control.position_gain": 15.0})
frequency = np.geomspace(0.5, 8.0, 13)
answers = {size: sw.analysis.frequency_response(slower, frequency, np.radians(size), dt=1e-3) for size in (0.1, 0.5, 1.0, 4.0)}

figure = Figure(figsize=(8.0, 8.5), layout="constrained")
time, over, bode = figure.subplots(3, 1)
for step, (run, _, _) in list(zip(steps, runs["the article's gear"], strict=True))[2:4]:
    time.plot(run.time, np.degrees(run["output_angle"]), label=f"step of {step:g} deg")
for (name, each), mark in zip(swings.items(), "osx", strict=True):
    over.semilogx(steps, np.degrees(each[:, 0]), mark + "-", label=name)
    print(f"{name:25}: swings by {np.degrees(each[:, 0]).max():.3f} deg at {each[:, 1].max():.2f} Hz after the largest steps")
for size, answer in answers.items():
    gain = np.abs(answer["output_angle"])
    bode.semilogx(frequency, gain, ".-", label=f"{size:g} deg")
    least = gain[frequency < 7.0].min()
    print(f"command of {size:3g} deg: gain {least:.2f} or more below 7 Hz, at most {gain.max():.2f}; {gain[-1]:.2f} at 8 Hz")
time.set(xlim=(0.0, 2.0), xlabel="time [s]", ylabel="angle of the arm [deg]", title="Steps of the loop on the article's gear")
over.set(xlabel="step [deg]", ylabel="half swing left [deg]", title="What is left of a step after four seconds")
bode.set(xlabel="frequency [Hz]", ylabel="arm over command [1]", title="A slower loop, by amplitude of the command")
bode.set_xticks([0.5, 1.0, 2.0, 4.0, 8.0], ["0.5", "1", "2", "4", "8"])
bode.minorticks_off()
for axes in (time, over, bode):
    axes.grid(alpha=0.3, which="both")
    axes.legend()
figure.savefig("servo_on_soft_gear.png", dpi=110)
print(f"foretold: {foretold[0]:.3f} deg of twist at {foretold[1]:.2f} Hz; lost motion {width:.3f} deg at the output")
