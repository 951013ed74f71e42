"""The torque that a motion needs: by the inverse dynamics, by hand, and as a motor that prescribes the motion reports it."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave import _core

Array = NDArray[np.float64]
RATIO = 100.0
MOTION = np.column_stack(
    [np.linspace(-300.0, 300.0, 61), np.linspace(-120.0, 121.0, 61), np.linspace(500.0, -400.0, 61), np.zeros(61)]
)


def acting(load: float = 0.0, temperature: float = 293.15) -> Array:
    """Inputs at each of the motions: command, input of the load and temperature, each with its rate."""
    return np.tile([0.0, 0.0, load, 0.0, temperature, 0.0], (len(MOTION), 1))


def drive(**gear: object) -> sw.Drive:
    return sw.Drive(
        gear=sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=RATIO), stiffness=sw.stiffness.Linear(k=1e4), **gear),  # type: ignore[arg-type]
        motor=sw.motor.TorqueSource(inertia=1e-4),
        load=sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0, gravity_phase=0.3),
    )


def needed(one: sw.Drive, inputs: Array) -> Array:
    torque, slopes = _core.inverse_dynamics(one, MOTION, inputs, [])
    assert slopes.shape == (0, len(MOTION))
    return torque


def test_inertias_gravity_and_friction_at_all_places_add_up() -> None:
    one = drive(
        friction_input=sw.friction.Coulomb(coulomb=0.03, viscous=1e-4),
        friction_mesh=sw.friction.Viscous(viscous=0.2),
        friction_output=sw.friction.Coulomb(coulomb=0.7, viscous=0.1),
    )
    angle, speed, acceleration, _ = MOTION.T
    output = 0.5 * acceleration / RATIO + 15.0 * np.sin(angle / RATIO + 0.3) + 2.5
    output += 0.7 * np.sign(speed) + 0.1 * speed / RATIO + 0.2 * speed / RATIO
    by_hand = 1e-4 * acceleration + 0.03 * np.sign(speed) + 1e-4 * speed + output / RATIO
    assert needed(one, acting(2.5)) == pytest.approx(by_hand, rel=1e-13, abs=1e-15)


def test_friction_that_grows_with_the_torque_transmitted_is_that_of_the_torque_found() -> None:
    """At the output: T = T_0 + share |T|, thus T = T_0 / (1 - share) where it drives on."""
    share = 0.2
    law = sw.friction.LoadDependent(**dict.fromkeys(("driving_forward", "driving_reverse"), share))
    torque, without = needed(drive(friction_output=law), acting()), needed(drive(), acting())
    speed, at_output = MOTION[:, 1], RATIO * (without - 1e-4 * MOTION[:, 2])
    drives_on = at_output * speed > 0.0
    assert drives_on.sum() > 10
    found = RATIO * (torque - 1e-4 * MOTION[:, 2])
    assert found[drives_on] == pytest.approx(at_output[drives_on] / (1.0 - share), rel=2e-3)  # share ** 4 is left by the rounds


def test_a_kinematic_error_multiplies_what_the_output_needs() -> None:
    one = drive(kinematic_error=sw.kinematic_error.Fourier(order=[2], amplitude=[1e-4], phase=[0.4]))
    angle, _, acceleration, _ = MOTION.T
    per_input = 1.0 / RATIO - 2e-4 * np.cos(2.0 * angle + 0.4)
    output_angle = angle / RATIO - 1e-4 * np.sin(2.0 * angle + 0.4)
    by_hand = 1e-4 * acceleration + per_input * (0.5 * per_input * acceleration + 15.0 * np.sin(output_angle + 0.3))
    assert needed(one, acting()) == pytest.approx(by_hand, rel=1e-11)


def test_a_motor_that_prescribes_the_motion_of_a_stiff_gear_needs_as_much() -> None:
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=RATIO),
        stiffness=sw.stiffness.Linear(k=1e6),
        damping=2e3,
        friction_input=sw.friction.Stribeck(coulomb=0.02, breakaway=0.03, stribeck_speed=3.0, viscous=1e-4),
        friction_output=sw.friction.Viscous(viscous=0.5),
    )
    one = sw.Drive(
        gear=gear,
        motor=sw.motor.AccelerationSource(inertia=1e-4),
        load=sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0),
    )
    run = sw.simulate(one, sw.scenario.sine(200.0, 0.5, 2.0), 1e-4, sample=1e-2, initial={"input_speed": 90.0})
    motion = np.column_stack([run["input_angle"], run["input_speed"], run["command"], np.zeros(len(run))])
    inputs = np.tile([0.0, 0.0, 0.0, 0.0, 293.15, 0.0], (len(run), 1))
    torque, _ = _core.inverse_dynamics(one, motion, inputs, [])
    settled = run["time"] > 0.2
    assert torque[settled] == pytest.approx(run["motor_torque"][settled], abs=2e-4 * float(np.abs(run["motor_torque"]).max()))


def test_derivatives_are_what_differences_show() -> None:
    one = drive(
        friction_input=sw.friction.Thermal(
            law=sw.friction.Coulomb(coulomb=0.03, viscous=1e-4), dry_fall=0.01, viscous_fall=0.02
        )
    )
    parameters = _core.parameters(one)
    paths = [path for path, value, *_ in parameters if value != 0.0 and path != "gear.stiffness.k"]
    places = [[path for path, *_ in parameters].index(path) for path in paths]
    _, slopes = _core.inverse_dynamics(one, MOTION, acting(1.0, 310.0), places)
    for path, slope in zip(paths, slopes, strict=True):
        value = next(number for name, number, *_ in parameters if name == path)
        step = 1e-6 * abs(value)
        above, below = (needed(one.replace({path: value + side * step}), acting(1.0, 310.0)) for side in (1.0, -1.0))
        assert slope == pytest.approx((above - below) / (2.0 * step), rel=1e-6, abs=1e-6 * float(np.abs(slope).max())), path


def reversal(step: float) -> Array:
    """A motion to and fro between -0.2 and 0.2 rad of the input at 1 rad/s, which begins in the middle."""
    forth = np.arange(0.0, 0.2, step)
    path = np.concatenate([forth, 0.2 - np.arange(0.0, 0.4, step), -0.2 + np.arange(0.0, 0.4, step)])
    speed = np.concatenate([np.ones(len(forth)), -np.ones(len(forth) * 2), np.ones(len(forth) * 2)])
    return np.column_stack([path, speed, np.zeros(len(path)), np.r_[0.0, np.full(len(path) - 1, step)]])


def test_a_bristle_bends_after_each_reversal_as_the_law_of_dahl_has_it() -> None:
    """F = F_c (1 - 2 exp(-sigma s / F_c)), s the way since the reversal."""
    coulomb, stiffness, step = 0.05, 2.0, 1e-3
    law = sw.friction.LuGre(
        coulomb=coulomb, breakaway=coulomb, stribeck_speed=1.0, bristle_stiffness=stiffness, bristle_damping=0.0
    )
    motion = reversal(step)
    one = sw.Drive(
        gear=sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=RATIO), friction_input=law),
        motor=sw.motor.TorqueSource(inertia=1e-4),
        load=sw.loads.Inertia(inertia=0.5),
    )
    inputs = np.tile([0.0, 0.0, 0.0, 0.0, 293.15, 0.0], (len(motion), 1))
    numbers = [path for path, *_ in _core.parameters(one)]
    paths = ["gear.friction_input.coulomb", "gear.friction_input.bristle_stiffness"]
    torque, slopes = _core.inverse_dynamics(one, motion, inputs, [numbers.index(path) for path in paths])
    back = motion[:, 1] < 0.0
    way = 0.2 - motion[back, 0]
    bend = np.exp(-stiffness * way / coulomb)
    assert torque[:200] == pytest.approx(coulomb)
    assert torque[back] == pytest.approx(-coulomb * (1.0 - 2.0 * bend), abs=1e-3 * coulomb)
    assert slopes[1][back] == pytest.approx(-2.0 * way * bend, abs=3e-4)


def test_friction_in_the_mesh_and_at_the_output_remembers_as_well() -> None:
    law = sw.friction.LuGre(coulomb=1.0, breakaway=1.0, stribeck_speed=1.0, bristle_stiffness=2e3, bristle_damping=0.0)
    motion = reversal(1e-3)
    inputs = np.tile([0.0, 0.0, 0.0, 0.0, 293.15, 0.0], (len(motion), 1))
    for place in ("friction_mesh", "friction_output"):
        one = sw.Drive(
            gear=sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=RATIO), **{place: law}),  # type: ignore[arg-type]
            motor=sw.motor.TorqueSource(inertia=1e-4),
            load=sw.loads.Inertia(inertia=0.5),
        )
        torque, _ = _core.inverse_dynamics(one, motion, inputs, [])
        back = motion[:, 1] < 0.0
        bend = np.exp(-2e3 * (0.2 - motion[back, 0]) / RATIO)
        assert RATIO * torque[back] == pytest.approx(-(1.0 - 2.0 * bend), abs=0.06)  # by twenty rows to a bend
