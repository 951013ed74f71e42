"""A joint is identified once, saved, and compared with a recording of a later day: its friction has grown by 30 %.

The joint is made by its equation, so that its truth is known: inertia, gravity, Coulomb and viscous friction at the motor, with
noise on the current. A result that is saved contains its load, the covariance of its numbers and its error on its own file:
with these a later recording either agrees, or contradicts it and shows what changed.
"""

import numpy as np
import strainwave as sw
from matplotlib.figure import Figure

RATIO, TORQUE_CONSTANT, INERTIA, GRAVITY = 100.0, 0.1, 1.2, 25.0
STATED = sw.FileMapping(constants={"ratio": RATIO, "torque_constant": TORQUE_CONSTANT})


def recorded(coulomb: float, seed: int) -> sw.Recording:
    """A log of the joint: time, its angle, and the current of its motor."""
    random, time = np.random.default_rng(seed), np.arange(0.0, 30.0, 0.004)
    angle = sum(a * np.sin(w * time + random.uniform(0.0, 6.0)) for a, w in ((0.7, 0.8), (0.3, 1.9), (0.1, 3.7)))
    speed = np.gradient(angle, time)
    load = INERTIA * np.gradient(speed, time) + GRAVITY * np.sin(angle)
    friction = coulomb * np.sign(speed) + 3e-4 * RATIO * speed
    current = (load / RATIO + friction) / TORQUE_CONSTANT + 0.05 * random.normal(size=len(time))
    columns = {"time": time, "output_angle": angle + 2e-6 * random.normal(size=len(time)), "current": current}
    return sw.Recording(columns, {"time": "s", "output_angle": "rad", "current": "A"})


found = sw.identify("csg-20-100", {"log": recorded(0.06, seed=1)}, mapping=STATED, name="joint 3 of the cell")
found.gear_set.save("joint.toml")
saved = sw.GearSet.read("joint.toml")
print(f"{saved.name}: inertia {saved.load.inertia:.3f} kg.m2, gravity {saved.load.gravity_torque:.2f} N.m")
print(f"error on its own file: {100.0 * saved.validation[0].relative:.1f} % of what the current varies by")

(same,) = sw.predict("joint.toml", {"log": recorded(0.06, seed=2)}, mapping=STATED)
(worn,) = sw.predict("joint.toml", {"log": recorded(0.078, seed=3)}, mapping=STATED)
for day, later in (("next day", same), ("a year later", worn)):
    result = later.verdict
    print(f"{day}: error {later.error:.3f} A of {later.varies:.3f} A, {later.allowed:.3f} A allowed: {result}")
    for change in later.changed:
        print(f"  {change.name} is {change.value:.3f} +- {change.sigma:.3f} times that saved")

assert worn.curves is not None
figure = Figure(figsize=(9.0, 5.0), layout="constrained")
above, below = figure.subplots(2, 1, sharex=True)
above.plot(worn.curves["time"], worn.curves["current"], linewidth=2.0, alpha=0.5, label="a year later, measured")
above.plot(worn.curves["time"], worn.curves["predicted"], linewidth=0.9, label="predicted by the saved joint")
above.set(ylabel="current [A]")
above.legend(loc="upper right", fontsize="small")
below.plot(worn.curves["time"], worn.curves["residual"], linewidth=0.7, color="black")
below.set(xlabel="time [s]", ylabel="measured less predicted [A]")
figure.savefig("worn_joint.png", dpi=110)
