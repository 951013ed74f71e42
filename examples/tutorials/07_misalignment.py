# %% [markdown]
# # Misalignment and the motor current
#
# At the end you can find a misaligned wave generator in the motor current. You compute the detection limit before you record,
# and compare with a baseline afterwards.
#
# **Time:** 20 minutes. **You need:** strainwave with matplotlib. All recordings are simulated here.

# %% [markdown]
# ## A joint, and a misaligned wave generator
#
# The joint turns at constant speed, with a gear of the catalogue. `with_faults` changes the numbers of a drive as a fault
# does: here the shaft of the wave generator is 15 µm or 30 µm off the middle of the housing.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import strainwave as sw

gear_set = sw.GearSet.read("csg-25-100").with_parts(
    motor=sw.motor.CurrentSource(torque_constant=0.2, inertia=1.5e-4),
    control=sw.control.PI(proportional=2.0, integral=40.0, limit=20.0),  # of the speed
    load=sw.loads.Inertia(inertia=0.5),
    source="an example",
)
gear_set.save("joint.toml")
healthy = gear_set.drive
drives = {"healthy": healthy}
for micrometres in (15, 30):
    fault = sw.fault.Misalignment(housing_eccentricity=1e-6 * micrometres)
    drives[f"{micrometres} µm"] = sw.dataset.with_faults(healthy, [fault])

turn = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.0), layout="constrained")
for number, (name, drive) in enumerate(drives.items()):
    error = 1e6 * drive.gear.kinematic_error.error(turn)
    orders = 2.0 * np.abs(np.fft.rfft(error)) / len(turn)
    print(f"{name:8} orders 1 to 4 [µrad]: {orders[1:5].round(1)}")
    left.plot(np.degrees(turn), error, label=name)
    right.bar(np.arange(1, 9) + 0.25 * (number - 1), orders[1:9], 0.25, label=name)
left.set(xlabel="angle of the motor [deg]", ylabel="kinematic error at the output [µrad]", title="The error over one turn")
right.set(xlabel="order, cycles in a turn of the motor", ylabel="amplitude [µrad]", title="Its orders")
left.legend()

# %% [markdown]
# A healthy gear has an order 2 too. The misalignment adds to it, and makes orders 4, 6 and 8. So no single order proves a
# misalignment: the *change* counts, and whether the recording could show it.
#
# ## From the error to the current
#
# The error moves the output against its load, and the motor has to supply the work. At low speed an error of amplitude $A$
# and order $n$ under the load $T$ asks the motor for the torque $n\,T\,A$. Without a load, only the inertia of the output is
# left. Look at the amplitude of order 2 over the load:

# %%
OUTPUT_SPEED = 0.1  # rad/s of the output: 10 rad/s of the motor
TORQUE_CONSTANT = healthy.motor.torque_constant
ratio = healthy.gear.kinematics.ratio


def recording(drive, load, duration=10.0, noise=0.0, seed=0):
    """Return a recording of the drive at constant speed, with a torque [N.m] that holds the output back."""
    start = {"input_speed": OUTPUT_SPEED * ratio, "output_speed": OUTPUT_SPEED, "torque": load}
    command = sw.scenario.constant(OUTPUT_SPEED, duration + 1.0)
    run = sw.simulate(drive, command, dt=5e-4, sample=2e-3, load_torque=load, initial=start).between(1.0, duration + 1.0)
    noisy = run["current"] + np.random.default_rng(seed).normal(0.0, noise, len(run))
    return run.with_column("current", noisy, "A")


loads = np.array([0.0, 20.0, 40.0])
figure, axes = plt.subplots(figsize=(7.0, 4.0), layout="constrained")
for number, (name, drive) in enumerate(drives.items()):
    error = 2.0 * np.abs(np.fft.rfft(drive.gear.kinematic_error.error(turn)))[2] / len(turn)
    current = [sw.orders.order_amplitudes(recording(drive, load), "current", [2.0]).amplitude[0] for load in loads]
    print(f"{name:8} order 2 of the current [mA] at {loads} N.m: {(1e3 * np.array(current)).round(2)}")
    axes.plot(loads, 1e3 * np.array(current), "o", color=f"C{number}", label=name)
    axes.plot(loads, 1e3 * 2.0 * loads * error / TORQUE_CONSTANT, color=f"C{number}")
axes.set(
    xlabel="load at the output [N.m]",
    ylabel="order 2 of the current [mA]",
    title="Points: simulated. Lines: 2 T A / torque constant",
)
axes.legend()

# %% [markdown]
# Under load the current follows the line. Without a load nearly nothing is left, however large the misalignment.
#
# ## Before you record: the detection limit
#
# `sw.diagnose.detection_limit` computes the smallest kinematic error that a planned recording shows. It needs the speed of
# the motor, the load, the duration, the sample rate, and the noise of a sample of the current. Measure the noise at standstill.

# %%
plan = {"speed": OUTPUT_SPEED * abs(ratio), "duration": 10.0, "sample_rate": 500.0, "noise": 0.05, "order": 2.0}
limits = {load: sw.diagnose.detection_limit(healthy, load_torque=load, **plan) for load in (0.0, 20.0)}
for load, limit in limits.items():
    print(f"{load:4.0f} N.m: an error of {1e6 * limit.amplitude:6.1f} µrad is found, insensitive: {limit.insensitive}")
    print("      remarks:", *limit.remarks or ["none"])

# %% [markdown]
# On the command line the same is `strainwave diagnose limit joint.toml --speed 10 --torque 20 --duration 10 --noise
# 0.05 --rate 500 --order 2`.
#
# Now make both recordings, with this noise, on the joint with 15 µm:

# %%
figure, panels = plt.subplots(2, 1, sharex=True, figsize=(8.0, 5.0), layout="constrained")
for axes, load in zip(panels, (0.0, 20.0), strict=True):
    noisy = recording(drives["15 µm"], load, noise=0.05, seed=1)
    for line in sw.diagnose.order_lines(noisy, "current", [2.0, 4.0]):
        print(f"{load:4.0f} N.m, order {line.order:g}: {1e3 * line.amplitude:5.1f} mA, detected: {line.detected}")
    axes.plot(noisy.time, noisy["current"], linewidth=0.5)
    axes.set(ylabel="current [A]", title=f"{load:g} N.m at the output")
panels[1].set(xlabel="time [s]")

# %% [markdown]
# You cannot see the order in these curves; the fit over whole revolutions finds it, under load. Order 4 of this
# misalignment stays below the limit here. A recording without load and without an alarm proves nothing.
#
# ## After you recorded: compare with a baseline
#
# A healthy joint has lines too, and they change a little from day to day. So record the healthy joint on several days first.
# The baseline here has three recordings of a motion to and fro under the weight of an arm, with different friction each day.
# Record the later days with the *same* motion.

# %%
arm = healthy.replace(load=sw.loads.Pendulum(inertia=0.5, gravity_torque=40.0))
gear_set.with_parts(load=arm.load, source="an example").save("arm.toml")


def day(name, drive, friction, seed):
    """Write a recording of a day: time, angle of the motor, current with noise."""
    changed = drive.replace({"gear.friction_input.coulomb": friction * drive.gear.friction_input.coulomb})
    motion = sw.scenario.sine(amplitude=0.4, frequency=0.05, duration=40.0)  # of the speed of the output [rad/s]
    run = sw.simulate(changed, motion, dt=5e-4, sample=4e-3, record=["input_angle", "current"])
    noise = np.random.default_rng(seed).normal(0.0, 0.03, len(run))
    run.with_column("current", run["current"] + noise, "A").to_csv(name)


Path("baseline").mkdir()
for number, friction in enumerate((1.1, 1.0, 0.9), 1):
    day(f"baseline/day-{number}.csv", arm, friction, number)
day("later.csv", arm, 0.95, 4)
day("misaligned.csv", sw.dataset.with_faults(arm, [sw.fault.Misalignment(housing_eccentricity=15e-6)]), 1.05, 5)
print(*Path("later.csv").read_text().splitlines()[:3], sep="\n")

# %% [console]
# $ strainwave diagnose joint later.csv misaligned.csv --gear arm.toml --baseline baseline > found.txt || echo "exit code $?"
# $ sed -n '/csv:/,/indicator/p' found.txt

# %% [markdown]
# The exit code is 3 because a recording differs from the baseline. The healthy joint of the later day gives no alarm,
# although its friction changed. `out/diagnose/report.html` has all amplitudes, their limits and the smallest change that
# would be an alarm.
#
# ## What can go wrong
#
# | message or effect | cause, and what to do |
# |---|---|
# | `insensitive` | Load too small or noise too large. Load the output, or record longer. No alarm means nothing here. |
# | `not comparable` | The later day has another motion, load or place than the baseline. Repeat the motion of the baseline. |
# | `aliased` | Order 2 passes above 0.8 of half the sample rate. Record faster, or turn slower. |
# | an alarm after a repair | Record a new baseline. |
# | order 2 alone is larger | A misalignment is one cause. Cogging, a coupling or another load make lines too. |
#
# ## Where to go on
#
# * [Diagnose a gear from its motor current](../../docs/how-to/diagnose.md): the report, false alarms, remaining life.
# * [Detection limit of the motor current](../../docs/how-to/diagnose.md#detection-limit-of-the-motor-current): what the
#   limit depends on.
# * [Estimate a misalignment from the motor current](../../docs/validation/misalignment-from-current.md):
#   from the orders back to the geometry.
# * [Fault data and a detector](09_fault_data.py): the same question for many units.
