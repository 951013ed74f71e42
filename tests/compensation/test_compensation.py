"""Compensation around a controller in a computer against the same by hand; and what it adds, one part after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core, compensation

from tests.compensation import by_hand
from tests.compensation.ideal import KINEMATICS, RATIO
from tests.control.discrete import CURRENT, DC as WOUND

PERIOD, DURATION = 1e-3, 1.2  # s
COMMAND = sw.scenario.sine(0.15, 1.3, DURATION) + sw.scenario.ramp(0.1, DURATION)
GEAR = sw.Gear(
    kinematics=KINEMATICS,
    stiffness=sw.stiffness.Linear(k=1e4),
    damping=20.0,
    kinematic_error=sw.kinematic_error.Fourier(order=[1.0, 2.0], amplitude=[1e-4, 3e-4], phase=[0.2, -1.0]),
    friction_input=sw.friction.Coulomb(coulomb=0.03, breakaway=0.04, viscous=5e-4),
    input_inertia=1e-4,
)
DRY = sw.Gear(
    kinematics=KINEMATICS,
    stiffness=sw.stiffness.Linear(k=1e15),
    friction_input=sw.friction.Coulomb(coulomb=0.025, breakaway=0.025),
)
NO_LOAD = sw.loads.Inertia(inertia=1e-15)
DC = sw.motor.DC(resistance=0.5, inductance=0.0, torque_constant=0.1, back_emf=0.12, inertia=1e-4)
PARTS: dict[str, Any] = {
    "lost_motion_map": compensation.LostMotionMap(
        angle=[-0.1, 0.05, 0.2], forward=[3e-4, 1e-4, 4e-4], backward=[-2e-4, -3e-4, 1e-4], reach=0.02
    ),
    "model_feedforward": compensation.ModelFeedforward(gear=DRY, load=NO_LOAD, presliding=0.5),
    "adaptive_fourier": compensation.AdaptiveFourier(
        order=[1.0, 2.0, 2.02], gain=20.0, lag=0.01, max_frequency=130.0, limit=2e-4
    ),
    "repetitive": compensation.Repetitive(gain=30.0, smoothing=5.0, lag=0.01, min_speed=5.0, max_speed=100.0, limit=2e-4),
    "iterative_learning": compensation.IterativeLearning(
        low=-0.05, high=0.2, reach=0.02, gain=30.0, smoothing=5.0, lag=0.01, min_speed=5.0, max_speed=130.0, limit=2e-4
    ),
    "twist_identification": compensation.TwistIdentification(
        order=[1.0, 2.0, 2.02], noise=1e-4, window=0.3, memory=2.0, min_excitation=5.0, min_speed=5.0, limit=1.5
    ),
    "disturbance_observer": compensation.DisturbanceObserver(inertia=2.1e-4, bandwidth=120.0, limit=0.1),
    "friction_scale": compensation.FrictionScale(gain=3.0, max_scale=1.2, min_speed=2.0),
    "bristle_observer": compensation.BristleObserver(
        friction=sw.friction.LuGre(
            coulomb=0.025, breakaway=0.035, stribeck_speed=4.0, bristle_stiffness=0.5, bristle_damping=1e-3, viscous=4e-4
        ),
        friction_share=0.9,
        bristle_gain=0.4,
        gain=3.0,
        max_scale=1.2,
        min_speed=2.0,
    ),
    "dither": compensation.Dither(amplitude=0.02, frequency=37.0),
}
HANDS = {
    "lost_motion_map": by_hand.LostMotionMap,
    "model_feedforward": lambda law: by_hand.DryFriction(law.gear.friction_input.coulomb, law.presliding),
    "adaptive_fourier": by_hand.AdaptiveFourier,
    "repetitive": by_hand.Repetitive,
    "iterative_learning": by_hand.IterativeLearning,
    "twist_identification": by_hand.TwistIdentification,
    "disturbance_observer": by_hand.DisturbanceObserver,
    "friction_scale": by_hand.FrictionScale,
    "bristle_observer": by_hand.BristleObserver,
    "dither": by_hand.Dither,
}
PLACES = ("feedforward", "dither", "learning", "observer")  # in the order in which they are asked
NAMES = [(place, name) for place in PLACES for name in _core.families[place] if name != f"no_{place}"]
ALONE = [{place: name} for place, name in NAMES]
TOGETHER = [
    {"feedforward": "model_feedforward", "learning": "adaptive_fourier", "observer": "friction_scale"},
    {"feedforward": "model_feedforward", "learning": "repetitive", "observer": "disturbance_observer"},
    {"feedforward": "lost_motion_map", "learning": "adaptive_fourier", "observer": "disturbance_observer"},
    {"feedforward": "model_feedforward", "dither": "dither", "learning": "adaptive_fourier", "observer": "bristle_observer"},
    {"feedforward": "model_feedforward", "dither": "dither", "observer": "disturbance_observer"},
    {"feedforward": "lost_motion_map", "learning": "twist_identification", "observer": "disturbance_observer"},
]
# A motor, and what it takes per torque and per input speed.
MOTORS = {
    "torque": (sw.motor.TorqueSource(inertia=1e-4), 1.0, 0.0),
    "current": (sw.motor.CurrentSource(torque_constant=0.1, inertia=1e-4), 10.0, 0.0),
    "voltage": (DC, DC.resistance / DC.torque_constant, DC.back_emf),
}


@pytest.mark.parametrize("motor", list(MOTORS))
@pytest.mark.parametrize("chosen", [*ALONE, *TOGETHER], ids=lambda chosen: "+".join(chosen.values()))
def test_it_is_the_recursion_by_hand(chosen: dict[str, str], motor: str) -> None:
    plant, per_torque, per_speed = MOTORS[motor]
    law = sw.control.PID(proportional=2.0 * per_torque, derivative=0.04 * per_torque, limit=0.12 * per_torque)
    part = sw.Compensation(
        **{place: PARTS[name] for place, name in chosen.items()}, actuation_per_torque=per_torque, actuation_per_speed=per_speed
    )
    drive = sw.Drive(gear=GEAR, motor=plant, load=sw.loads.Inertia(inertia=0.1))
    control = sw.control.Sampled(law=law, period=PERIOD, compensation=part)
    hands = [HANDS[name](PARTS[name]) for name in chosen.values()]
    found = sw.simulate(drive.replace(control=control), COMMAND, sample=PERIOD)
    wanted = sw.simulate_controlled(
        drive, by_hand.Compensated(law, part, hands, RATIO, PERIOD), COMMAND, period=PERIOD, sample=PERIOD
    )
    for column in ("input_angle", "input_speed", "output_angle"):
        assert found[column] == pytest.approx(wanted[column], abs=1e-9 * np.abs(wanted[column]).max())


def test_every_compensator_is_written_by_hand() -> None:
    listed = {name for _, name in NAMES}
    assert listed == set(HANDS) == set(PARTS)


def test_without_parts_it_is_the_controller_alone() -> None:
    """Whatever the motor is said to take."""
    drive = sw.Drive(gear=GEAR, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.1))
    law = sw.control.PID(proportional=2.0, derivative=0.04, limit=0.12)
    runs = [
        sw.simulate(drive.replace(control=sw.control.Sampled(law=law, **part)), COMMAND, sample=PERIOD)["output_angle"]
        for part in ({}, {"compensation": sw.Compensation(actuation_per_torque=3.0)})
    ]
    assert np.array_equal(*runs)


LAWS = {
    "position_speed": (
        sw.control.PositionSpeed(position_gain=20.0, speed_proportional=0.1, speed_feedforward=1.0), CURRENT, 10.0, 0.0),
    "cascade": (
        sw.control.Cascade(position_gain=20.0, speed_proportional=0.1, speed_feedforward=1.0, current_proportional=0.4,
                           current_integral=100.0, back_emf_feedforward=0.12), WOUND, 10.0, 0.0),
    "pid": (sw.control.PID(proportional=2.0, derivative=0.2), WOUND, 5.0, 0.12),
    "lead_lag": (sw.control.LeadLag(gain=2.0, lead_numerator=0.05, lead_denominator=0.005), WOUND, 5.0, 0.12),
    "state_feedback": (sw.control.StateFeedback(input_angle=2.0, input_speed=0.05), WOUND, 5.0, 0.12),
    "state_space": (sw.control.StateSpace(A=[-500.0], B=[500.0, 0.0], C=[1.0], D=[1.0, 0.05]), WOUND, 5.0, 0.12),
}  # fmt: skip


@pytest.mark.parametrize("name", list(LAWS))
def test_it_serves_every_law_that_follows_an_angle(name: str) -> None:
    """Without a model of its own, each follows the input that the model leads and adds the torque, in the unit of its motor."""
    law, motor, per_torque, per_speed = LAWS[name]
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=20.0),
        stiffness=sw.stiffness.Linear(k=2e3),
        damping=0.4,
        kinematic_error=sw.kinematic_error.Fourier(order=[1.0], amplitude=[1e-3], phase=[0.4]),
        friction_input=sw.friction.Coulomb(coulomb=0.05, viscous=1e-3),
    )
    arm = sw.loads.Pendulum(inertia=0.05, gravity_torque=2.0)
    model = sw.compensation.ModelFeedforward(gear=gear, load=arm, motor_inertia=1e-4)
    whole = sw.Compensation(feedforward=model, actuation_per_torque=per_torque, actuation_per_speed=per_speed)
    command, errors = sw.scenario.sine(0.3, 0.5, 4.0, phase=-0.5 * np.pi, offset=0.3), []
    for added in (sw.Compensation(), whole):
        control = sw.control.Sampled(law=law, period=5e-4, compensation=added)
        run = sw.simulate(sw.Drive(gear=gear, motor=motor, load=arm, control=control), command, 1e-4, sample=1e-3)
        errors.append(np.sqrt(np.mean((command.value(run.time) - run["output_angle"])[2000:] ** 2)))
    assert errors[1] < 0.1 * errors[0]


@pytest.mark.parametrize("law", [sw.control.PI(), sw.control.OpenLoop()])
def test_a_law_that_follows_no_angle_is_refused(law: sw.control.PI | sw.control.OpenLoop) -> None:
    observer = sw.compensation.DisturbanceObserver(inertia=1e-4, limit=1.0)
    with pytest.raises(ValueError, match="law must follow an angle"):
        sw.control.Sampled(law=law, compensation=sw.Compensation(observer=observer))
    assert not sw.control.Sampled(law=law).compensation.active
