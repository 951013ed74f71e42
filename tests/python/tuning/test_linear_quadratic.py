"""A linear-quadratic regulator: against closed forms of a rigid joint, and the poles of the drive that it closes."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.tuning.cascade import Plant
from strainwave.tuning.linear_plant import LinearPlant

from tests.support.compensated_joint import robot_joint

ROTOR, ARM, RATIO = 1e-4, 0.6, 100.0
ERROR, EFFORT = 1e-3, 0.2


def joint(stiffness: float, damping: float = 0.0) -> sw.Drive:
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=RATIO), stiffness=sw.stiffness.Linear(k=stiffness), damping=damping
    )
    return sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=ROTOR), load=sw.loads.Inertia(inertia=ARM))


def test_of_a_rigid_joint_it_is_that_of_a_double_integrator() -> None:
    """J w' = u: the gains are q/r and (2 J q/r)^(1/2), with q = 1/(i e), r = 1/u_0, as the period goes to zero."""
    law = sw.tuning.lqg(joint(1e7, damping=1e3), period=1e-5, error=ERROR, effort=EFFORT)
    inertia = ROTOR + ARM / RATIO**2
    stiff = EFFORT / (RATIO * ERROR)
    assert law.input_angle + law.output_angle / RATIO == pytest.approx(stiff, rel=2e-2)
    assert law.input_speed + law.output_speed / RATIO == pytest.approx(np.sqrt(2.0 * inertia * stiff), rel=2e-2)


def test_the_poles_of_the_drive_lie_on_the_symmetric_root_locus() -> None:
    """Of an undamped flexible joint: D(s) D(-s) + (u_0/e)^2 N(s) N(-s) = 0 has them as its stable roots."""
    drive = joint(2e3)
    law = sw.tuning.lqg(drive, period=1e-5, error=ERROR, effort=EFFORT)
    found = np.sort_complex(sw.linearise(drive.replace(control=law)).poles)
    k, j, m = 2e3, ROTOR, ARM
    # theta_out over torque: N = k / i, D = s^2 (j m s^2 + k (j + m / i^2))
    d = np.array([j * m, 0.0, k * (j + m / RATIO**2), 0.0, 0.0])
    whole = np.polymul(d, d)  # D is even
    whole[-1] += (EFFORT / ERROR * k / RATIO) ** 2
    roots = np.roots(whole)
    stable = np.sort_complex(roots[roots.real < 0.0])
    assert found == pytest.approx(stable, rel=1e-2)


def test_errors_of_angle_and_speed_are_weighed_as_they_are_stated() -> None:
    """The cost of a state is 2 if the angle and the speed of the output are as large as the errors."""
    linear = LinearPlant.of(Plant.read(joint(2e3), 1e-3, 0.0))
    state = dict.fromkeys(linear.states, 0.0) | {"input_angle": 0.02 * RATIO, "transmission_error": 0.01, "output_speed": 3.0}
    values = np.array([state[name] for name in linear.states])
    assert values @ linear.cost(0.01, 3.0) @ values == pytest.approx(2.0)
    assert values @ linear.cost(0.01) @ values == pytest.approx(1.0)


def test_with_an_observer_it_holds_the_robot_joint_against_its_friction_and_weight() -> None:
    joint_set = sw.GearSet.read("robot-joint")
    law = sw.tuning.lqg(joint_set, error=2e-4)
    found = robot_joint()
    compensation = found.chosen.candidate.drive.control.compensation
    control = sw.control.Sampled(law=law, period=1e-3, compensation=compensation)
    run = sw.simulate(found.drive.replace(control=control, sensors=sw.Sensors()), found.goal.command, sample=1e-3)
    error = found.goal.command.value(run.time) - run["output_angle"]
    assert np.abs(error[len(error) // 2 :]).max() < 2e-3


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"error": 0.0}, "error"),
        ({"effort": -1.0}, "effort"),
        ({"speed_error": 0.0}, "speed_error"),
        ({"error": 1e-7, "effort": 10.0, "delay": 1e-3}, "not stable with a delay of 0.001 s"),
    ],
)
def test_what_it_refuses(changes: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        sw.tuning.lqg(joint(2e3, damping=1.0), **changes)


def test_states_that_no_encoder_measures_are_refused() -> None:
    """The bodies within a staged gear; their gains were dropped."""
    with pytest.raises(ValueError, match=r"the states of the drive are .*; take the lumped gear"):
        sw.tuning.lqg("tilt-actuator", error=1e-3)
