"""Probability that a crack is found from the motor current, over its severity: a small version of the detection benchmark.

Units differ in friction and stiffness, days of a unit in friction and load. The comparison with healthy days of a unit is that
of `strainwave diagnose joint`, at one false alarm in a thousand. The simplest detector is the change of the current's rms
without its mean; its threshold is the largest change on 12 healthy days of other units. Look at severity 0: twelve days are too
few for a threshold. The bands are intervals of 95 %.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure
from scipy.stats import binomtest
from strainwave.diagnose.baseline import baseline_of, compared
from strainwave.diagnose.refusals import usable
from strainwave.diagnose.replicates import JointMotion, joint_motion
from strainwave.parameters import every

speed, load, noise, duration = 20.0, 40.0, 0.05, 8.0  # rad/s of the input, N.m, A of a sample, s
orders = [2.0, 1.0, 4.0, 6.06, 8.08]  # of a strain wave gear, those of a crack included
severities = [0.0, 0.06, 0.12, 0.25, 0.5]
chance = np.random.default_rng(1)
joint = sw.Drive(
    gear=sw.load("csg-25-100"),
    motor=sw.motor.CurrentSource(torque_constant=0.06, inertia=1e-4),
    control=sw.control.PI(proportional=1.5, integral=30.0, limit=40.0),
    load=sw.loads.Inertia(inertia=0.1),
)
scaled = {"coulomb": 0, "breakaway": 0, "viscous": 0, "k1": 1, "k2": 1, "k3": 1}  # by the friction or the stiffness of a unit
own = {path: number.value for path, number in every(joint).items() if path.rpartition(".")[2] in scaled and number.value}


def day(unit: np.ndarray, severity: float = 0.0) -> np.ndarray:
    """Return input angle and current of a record of a unit, with the friction and load of a day."""
    friction, push = 1.0 + np.array([0.1, 0.05]) * chance.uniform(-1.0, 1.0, 2)
    factors = unit * (friction, 1.0)
    numbers = {path: factors[scaled[path.rpartition(".")[2]]] * value for path, value in own.items()}
    drive = sw.dataset.with_faults(joint.replace(numbers), [sw.fault.FlexsplineCrack(severity=severity)])
    command = sw.scenario.constant(speed / 100.0, 1.5 + duration)
    run = sw.simulate(drive, command, 8e-4, load_torque=load * push, sample=4e-3, record=["input_angle", "current"])
    record = run.between(1.5, 1.5 + duration)
    return np.array([record["input_angle"], record["current"] + noise * chance.standard_normal(len(record))])


def motion(record: np.ndarray) -> JointMotion:
    columns = {"time": 4e-3 * np.arange(record.shape[1]), "input_angle": record[0], "current": record[1]}
    return joint_motion(
        usable(sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"}), "a day", ratio=100.0)
    )


def ripple(records: list[np.ndarray]) -> np.ndarray:
    return np.array([np.std(record[1]) for record in records])


changes: list[float] = []
for unit in 1.3 ** chance.uniform(-1.0, 1.0, (4, 2)):  # of the training
    days = ripple([day(unit) for _ in range(7)])
    changes += list(np.abs(days[4:] / days[:4].mean() - 1.0))
found: dict[str, list[list[bool]]] = {"comparison with a baseline": [], "rms without mean": []}  # alarms by unit and severity
for unit in 1.3 ** chance.uniform(-1.0, 1.0, (8, 2)):
    healthy, faulty = [day(unit) for _ in range(4)], [day(unit, severity) for severity in severities]
    baseline, before = baseline_of([motion(each) for each in healthy], orders), ripple(healthy).mean()
    found["comparison with a baseline"].append([bool(compared(baseline, motion(each)).alarms) for each in faulty])
    found["rms without mean"].append([abs(each / before - 1.0) > max(changes) for each in ripple(faulty)])

figure = Figure(figsize=(7.0, 4.5), layout="constrained")
axes = figure.subplots()
for number, (name, alarms) in enumerate(found.items()):
    counts = np.sum(alarms, axis=0)
    bands = [binomtest(int(count), len(alarms)).proportion_ci() for count in counts]
    axes.plot(severities, counts / len(alarms), "o-", color=f"C{number}", label=name)
    axes.fill_between(severities, *np.array(bands).T, color=f"C{number}", alpha=0.2, lw=0)
    print(f"{name:27} of {len(alarms)} units: {counts} at severities {severities}")
axes.set(xlabel="severity of the crack", xlim=(0.0, 0.5), ylabel="share of units with an alarm", ylim=(0.0, 1.02))
axes.grid(alpha=0.3)
axes.legend(loc="lower right")
figure.savefig("detection_probability.png", dpi=110)
