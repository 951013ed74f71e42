"""An observer of what disturbs a drive: the closed form of a rotor under a step of torque, its limit, and what it goes by."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.compensation import DisturbanceObserver

from tests.compensation.ideal import KINEMATICS, PERIOD, RATIO

Array = NDArray[np.float64]

ROTOR, ARM = 2e-4, 1e-3  # kg.m2
INERTIA = ROTOR + ARM / RATIO**2
STEP, BANDWIDTH, DURATION = 0.05, 80.0, 0.1  # N.m at the input, rad/s, s
# So soft a spring that steps resolve it, and so light an arm that the rotor hardly feels it swing.
GEAR = sw.Gear(kinematics=KINEMATICS, stiffness=sw.stiffness.Linear(k=1e3), damping=0.3)


def run(motor: Any, law: Any, observer: Any, command: sw.scenario.Scenario | None = None, step: float = STEP,
        period: float = PERIOD, **part: float) -> sw.Recording:  # fmt: skip
    """A run under a torque that is there from the start, and twists the spring already."""
    control = sw.control.Sampled(law=law, period=period, compensation=sw.Compensation(observer=observer, **part))
    drive = sw.Drive(gear=GEAR, motor=motor, load=sw.loads.Inertia(inertia=ARM), control=control)
    return sw.simulate(
        drive,
        command or sw.scenario.constant(0.0, DURATION),
        sample=PERIOD,
        inputs={"load_torque": step * RATIO},
        initial={"torque": step * RATIO},
    )


def observer(**changed: float) -> DisturbanceObserver:
    return DisturbanceObserver(**({"inertia": INERTIA, "bandwidth": BANDWIDTH, "limit": 1.0} | changed))


IDLE = sw.control.PID(proportional=0.0, limit=10.0)


@pytest.mark.parametrize(
    ("motor", "actuation", "part"),
    [
        (sw.motor.TorqueSource(inertia=ROTOR), "motor_torque", {"actuation_per_torque": 1.0}),
        (sw.motor.CurrentSource(torque_constant=0.1, inertia=ROTOR), "current", {"actuation_per_torque": 10.0}),
        (
            sw.motor.DC(resistance=0.5, inductance=0.0, torque_constant=0.1, back_emf=0.12, inertia=ROTOR),
            "voltage",
            {"actuation_per_torque": 5.0, "actuation_per_speed": 0.12},
        ),
    ],
    ids=["torque", "current", "voltage"],
)
def test_under_a_step_it_rises_to_what_disturbs(motor: Any, actuation: str, part: dict[str, float]) -> None:
    """d (1 - exp(-g t)), which held for a period is d (1 - (1 - g T)^k); of a voltage the back-EMF is not held."""
    found = run(motor, IDLE, observer(), **part)
    torque = found[actuation][1:] / part["actuation_per_torque"]  # recorded just before the next instant
    number = np.arange(torque.size)
    tolerance = 2e-2 if actuation == "voltage" else 1e-3
    assert torque == pytest.approx(STEP * (1.0 - (1.0 - BANDWIDTH * PERIOD) ** number), abs=tolerance * STEP)
    assert torque == pytest.approx(STEP * (1.0 - np.exp(-BANDWIDTH * PERIOD * number)), abs=0.02 * STEP + tolerance * STEP)


def test_the_error_falls_with_the_period() -> None:
    """Against the exponential of continuous time: of first order."""
    errors = []
    for period in (1e-3, 5e-4):
        found = run(sw.motor.TorqueSource(inertia=ROTOR), IDLE, observer(), period=period)
        speed = -STEP / INERTIA / BANDWIDTH * (1.0 - np.exp(-BANDWIDTH * found.time))
        errors.append(np.abs(found["input_speed"] - speed).max())
    assert errors[0] == pytest.approx(2.0 * errors[1], rel=0.1)


@pytest.mark.parametrize("limit", [0.02, 0.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_it_adds_no_more_than_its_limit(limit: float, sense: float) -> None:
    """The rest of the torque accelerates the rotor."""
    found = run(sw.motor.TorqueSource(inertia=ROTOR), IDLE, observer(limit=limit), step=sense * STEP)
    assert np.abs(found["motor_torque"]).max() == pytest.approx(limit, abs=1e-15)
    late = found.time > 0.5 * DURATION
    acceleration = np.polyfit(found.time[late], found["input_speed"][late], 1)[0]
    assert acceleration == pytest.approx(-sense * (STEP - limit) / INERTIA, rel=1e-3)


def test_by_the_current_measured_it_is_the_same_under_a_cascade() -> None:
    """What it observes is the current that the step needs, whatever a cascade makes of its voltage."""
    motor = sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=ROTOR)
    law = sw.control.Cascade(
        position_gain=0.0, speed_proportional=0.0, current_proportional=0.4, current_integral=400.0, back_emf_feedforward=0.1
    )
    found = run(motor, law, observer(torque_constant=0.1, bandwidth=40.0), actuation_per_torque=10.0)
    torque = 0.1 * found["current"]
    assert torque[-1] == pytest.approx(STEP, rel=0.03)
    assert torque == pytest.approx(STEP * (1.0 - np.exp(-40.0 * found.time)), abs=0.1 * STEP)  # the current follows in 1.3 ms
    late = found.time > 0.5 * DURATION
    assert np.ptp(found["input_speed"][late]) < 0.15 * np.abs(found["input_speed"][late]).max()


def test_a_loop_without_an_integral_holds_its_angle_under_any_load() -> None:
    """J w' = tau - d with tau = PD + d^: the angle comes back to what is commanded."""
    law = sw.control.PID(proportional=ROTOR * 900.0, derivative=ROTOR * 60.0, limit=10.0)
    still = sw.scenario.constant(0.0, 1.0)
    without, with_it = (
        run(sw.motor.TorqueSource(inertia=ROTOR), law, part, still)["input_angle"][-1]
        for part in (sw.compensation.NoObserver(), observer())
    )
    assert without == pytest.approx(-STEP / (ROTOR * 900.0), rel=1e-3)
    assert abs(with_it) < 1e-6 * abs(without)


def test_it_supplies_the_torque_of_acceleration() -> None:
    """Along a ramp of the speed, from which the loop alone would fall behind by J a / k."""
    law = sw.control.PID(proportional=ROTOR * 900.0, derivative=ROTOR * 60.0, limit=10.0)
    time = np.linspace(0.0, 1.0, 20_001)
    command = sw.scenario.table(time, 0.5 * 0.4 * time**2)
    errors = []
    for part in (sw.compensation.NoObserver(), observer()):
        found = run(sw.motor.TorqueSource(inertia=ROTOR), law, part, command, step=0.0)
        errors.append(RATIO * found["command"][-1] - found["input_angle"][-1])
    assert errors[0] == pytest.approx(RATIO * 0.4 / 900.0, rel=0.01)
    assert abs(errors[1]) < 0.01 * abs(errors[0])


@pytest.mark.parametrize(("share", "stable"), [(0.55, True), (0.40, False)])
def test_a_rotor_of_less_than_half_of_its_inertia_is_unstable(share: float, stable: bool) -> None:
    """As its documentation has it: a light rotor, and a bandwidth near the highest that the period allows."""
    drive = {"motor": sw.motor.TorqueSource(inertia=ROTOR), "law": IDLE}
    found = run(**drive, observer=observer(inertia=INERTIA / share, bandwidth=0.99 / PERIOD, limit=1e3))
    swing = np.abs(np.diff(found["motor_torque"]))[-20:].max()
    assert (swing < STEP) == stable


@pytest.mark.parametrize("missing", ["inertia", "limit"])
def test_inertia_and_limit_must_be_given(missing: str) -> None:
    numbers = {"inertia": 1e-4, "limit": 1.0}
    del numbers[missing]
    with pytest.raises(TypeError, match=missing):
        DisturbanceObserver(**numbers)
