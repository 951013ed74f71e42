"""What a sensor shows of a motion that is given: the actuation of a controller that does nothing but pass it on."""

from __future__ import annotations

from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray

Array = NDArray[np.float64]
STILL = sw.motor.TorqueSource(inertia=1e12)  # nothing moves its shaft
SPRING = 50.0
GEAR = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=20.0), stiffness=sw.stiffness.Linear(k=SPRING))


def probe(sensor: Any, quantity: str = "output_angle") -> sw.Drive:
    """A drive whose output is moved from outside, and whose motor is asked for what the sensor shows."""
    return sw.Drive(
        gear=GEAR,
        motor=STILL,
        control=sw.control.StateFeedback(**{quantity: -1.0}, limit=1e12),
        load=sw.loads.Prescribed(),
        sensors=sw.Sensors(**{quantity: sensor}),
    )


def run_of(
    sensor: Any, motion: sw.scenario.Scenario, dt: float, quantity: str = "output_angle", **options: Any
) -> sw.Recording:
    """The run of that drive; what the sensor shows is its `motor_torque`."""
    still, start = sw.scenario.constant(0.0, motion.duration), {"input_angle": 0.0, "input_speed": 0.0}
    return sw.simulate(probe(sensor, quantity), still, dt, inputs={"output_angle": motion}, initial=start, **options)


def shown(sensor: Any, motion: sw.scenario.Scenario, dt: float, quantity: str = "output_angle") -> tuple[Array, Array]:
    """When, and what it shows."""
    run = run_of(sensor, motion, dt, quantity)
    return run.time, run["motor_torque"]


def from_elsewhere(sensor: Any, at: dict[str, float], duration: float, dt: float) -> tuple[Array, Array]:
    """What it shows of an angle that is 0, from where its own state is not that of rest."""
    drive = probe(sensor)
    start = drive.rest().replace({f"sensors.output_angle.{name}": value for name, value in at.items()})
    still = sw.scenario.constant(0.0, duration)
    run = sw.simulate(drive, still, dt, initial=start)
    return run.time, run["motor_torque"]
