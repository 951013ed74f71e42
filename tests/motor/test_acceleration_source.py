"""A motor that prescribes the motion of the input, against closed forms and against the motors that make the same motion."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from strainwave import _core
from strainwave.simulation.motion import InputMotion

from tests.support.geared import MOTOR, RATIO, K, geared

INERTIA, LOAD = 2e-4, 0.5
MOVED = sw.motor.AccelerationSource(inertia=INERTIA)
DRY = sw.friction.Coulomb(coulomb=0.02, viscous=1e-4)


@settings(max_examples=20)
@given(frequency=st.floats(5.0, 40.0), damping=st.floats(70.0, 140.0), speed=st.floats(1.0, 100.0))
def test_an_input_that_swings_moves_an_inertia_on_a_spring_as_linear_theory_has_it(
    frequency: float, damping: float, speed: float
) -> None:
    """x / (theta / i) = (k + j w c) / (k - J w^2 + j w c); tau = J_in a + (k + j w c) (theta / i - x) / i."""
    w = 2.0 * np.pi * frequency
    drive = geared(load=sw.loads.Inertia(inertia=LOAD), motor=MOVED, damping=damping)
    command = sw.scenario.sine(speed * w, frequency, 0.5)
    run = sw.simulate(drive, command, 1e-4, sample=1e-3, initial={"input_speed": -speed})
    wave = np.exp(1j * w * run.time)
    rigid = -speed / w / RATIO
    joint = K + 1j * w * damping
    output = rigid * joint / (joint - LOAD * w**2)
    torque = INERTIA * speed * w + joint * (rigid - output) / RATIO
    late = run.time > 0.35  # transients have decayed by e^-24
    assert run["input_angle"] == pytest.approx((rigid * RATIO * wave).imag, abs=1e-6 * abs(rigid) * RATIO)
    for name, amplitude in (("output_angle", output), ("motor_torque", torque)):
        assert run[name][late] == pytest.approx((amplitude * wave).imag[late], abs=1e-5 * abs(amplitude))


@pytest.mark.parametrize(
    "friction",
    [
        sw.friction.Viscous(viscous=3e-4),
        sw.friction.LuGre(
            coulomb=0.03, breakaway=0.04, stribeck_speed=2.0, bristle_stiffness=20.0, bristle_damping=2e-4, viscous=1e-4
        ),
        DRY,
    ],
    ids=lambda f: f.name,
)
def test_the_motion_that_another_motor_made_needs_the_torque_that_it_gave(friction: object) -> None:
    parts = {
        "friction_input": friction,
        "friction_mesh": sw.friction.Coulomb(coulomb=0.3, viscous=0.1),
        "friction_output": sw.friction.Viscous(viscous=0.5),
        "hysteresis": sw.hysteresis.MaxwellSlip(stiffness=[2e3], breakaway=[0.5]),
        "kinematic_error": sw.kinematic_error.Fourier(amplitude=[2e-4], order=[2], phase=[0.3]),
    }
    pushed = geared(motor=sw.motor.TorqueSource(inertia=INERTIA), **parts)
    made = sw.simulate(pushed, sw.scenario.sine(0.8, 3.0, 0.6), 1e-4)
    measured = InputMotion.through(made.time, made["input_angle"], from_rest=True)
    moved = sw.simulate(pushed.replace(motor=MOVED), measured.command, 1e-4, initial=measured.initial)
    assert moved["input_angle"] == pytest.approx(made["input_angle"], abs=1e-9)
    for name, near in (("output_angle", 1e-6), ("torque", 1e-4)):
        assert moved[name] == pytest.approx(made[name], abs=near * np.ptp(made[name]))
    # Where friction turns over the motion has a kink, about which a spline rings.
    turning = np.flatnonzero(np.abs(np.gradient(np.sign(made["input_speed"]))) > 0.0)
    far = np.abs(np.arange(len(made))[:, None] - np.r_[0, turning, len(made)]).min(axis=1) > 20
    far &= made["input_speed"] != 0.0  # there friction holds as much as it must
    assert far.mean() > 0.9
    assert moved["motor_torque"][far] == pytest.approx(made["motor_torque"][far], abs=1e-4)


def test_at_constant_speed_the_motor_gives_what_friction_takes_both_ways() -> None:
    for speed in (-30.0, 30.0):
        drive = geared(load=sw.loads.Inertia(inertia=LOAD), motor=MOVED, friction_input=DRY, damping=300.0)
        run = sw.simulate(drive, sw.scenario.constant(0.0, 0.3), initial={"input_speed": speed})
        assert run["input_angle"] == pytest.approx(speed * run.time, abs=1e-9)
        assert run["motor_torque"][-1] == pytest.approx(np.sign(speed) * 0.02 + 1e-4 * speed, rel=1e-9)


def test_what_it_resists_at_the_input_does_not_change_the_motion() -> None:
    command = sw.scenario.sine(500.0, 3.0, 0.4)
    light = sw.simulate(geared(motor=MOVED), command)
    heavy = sw.simulate(geared(motor=MOVED.replace(inertia=1.0), friction_input=DRY), command)
    assert np.array_equal(light["output_angle"], heavy["output_angle"])
    assert np.array_equal(light["torque"], heavy["torque"])
    expected = light["motor_torque"] + (1.0 - INERTIA) * light["input_acceleration"] + heavy["friction_input"]
    assert heavy["motor_torque"] == pytest.approx(expected, abs=1e-9)


def test_only_the_output_vibrates() -> None:
    drive = geared(load=sw.loads.Inertia(inertia=LOAD), motor=MOVED)
    assert _core.natural_frequency(drive, 0.0) == pytest.approx(np.sqrt(K / LOAD), rel=1e-12)


def test_all_ways_to_run_it_agree() -> None:
    """With friction that sticks at the output, and some that does not hold the input."""
    drive = geared(
        motor=MOVED,
        friction_input=DRY,
        friction_output=sw.friction.Coulomb(coulomb=2.0, breakaway=3.0, viscous=0.5),
        damping=20.0,
    )
    command = sw.scenario.sine(300.0, 2.0, 0.5)
    acting = {"initial": {"input_speed": -20.0}, "sample": 1e-3}
    alone = sw.simulate(drive, command, 1e-4, method="exponential", **acting)
    many = sw.simulate_many(drive, command, {"gear.damping": [20.0, 30.0]}, 1e-4, record=["torque", "motor_torque"], **acting)
    assert np.array_equal(many["torque"][0], alone["torque"])
    assert np.array_equal(many["motor_torque"][0], alone["motor_torque"])
    scale = np.ptp(alone["torque"])
    for method, near in (("rosenbrock", 1e-4), ("moreau_jean", 2e-2)):
        run = sw.simulate(drive, command, 1e-4, method=method, **acting)
        assert run["torque"] == pytest.approx(alone["torque"], abs=near * scale)
    adaptive = sw.simulate_adaptively(drive, command, 1e-9, **acting)
    assert adaptive["torque"] == pytest.approx(alone["torque"], abs=1e-4 * scale)


def test_derivatives_are_those_of_differences() -> None:
    drive = geared(motor=MOVED, friction_input=sw.friction.Viscous(viscous=1e-3), damping=20.0)
    command = sw.scenario.sine(300.0, 4.0, 0.2)
    paths = ["gear.stiffness.k", "gear.damping", "motor.inertia", "gear.friction_input.viscous", "load.inertia"]
    found = sw.analysis.derivatives(drive, command, paths, 1e-4)
    for path in paths:
        value = _core.parameters(drive)[[each[0] for each in _core.parameters(drive)].index(path)][1]
        ends = [sw.simulate(drive.replace({path: value * (1.0 + by)}), command, 1e-4) for by in (-1e-5, 1e-5)]
        for name in ("motor_torque", "output_angle"):
            slope = (ends[1][name] - ends[0][name]) / (2e-5 * value)
            assert found[name, path] == pytest.approx(slope, abs=1e-5 * np.abs(slope).max() + 1e-13)


def test_a_controller_may_ask_for_the_acceleration() -> None:
    """A position loop on an input that has no friction and no mass: a damped oscillator of its gains."""
    law = sw.control.StateFeedback(input_angle=400.0, input_speed=40.0, limit=1e6)
    drive = geared(motor=MOVED, control=law)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.5), initial={"input_angle": 1.0})
    assert run["input_angle"] == pytest.approx((1.0 + 20.0 * run.time) * np.exp(-20.0 * run.time), abs=1e-6)


def test_a_motion_passes_through_what_was_measured_at_crooked_instants() -> None:
    time = np.cumsum(np.r_[0.0, np.random.default_rng(3).uniform(5e-4, 3e-3, 400)])
    angle = 30.0 * np.sin(8.0 * time) + 100.0
    measured = InputMotion.through(time, angle)
    run = sw.simulate(geared(motor=MOVED), measured.command, 5e-4, sample=1e-3, initial=measured.initial)
    assert run["input_angle"] == pytest.approx(30.0 * np.sin(8.0 * run.time) + 100.0, abs=1e-6)


@pytest.mark.parametrize(
    ("time", "angle", "message"),
    [
        ([0.0, 1.0, 2.0], [0.0, 1.0, 2.0], "at least 4; they hold 3 and 3"),
        ([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 2.0], "they hold 4 and 3"),
        ([1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 2.0, 3.0], "must begin at 0 s"),
        ([0.0, 1.0, 2.0, 3.0], [0.0, np.nan, 2.0, 3.0], "finite"),
    ],
)
def test_what_is_no_motion_is_refused(time: list[float], angle: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        InputMotion.through(time, angle)


def test_a_locked_joint_between_two_prescribed_motions_shows_its_spring() -> None:
    drive = geared(motor=MOVED, load=sw.loads.Prescribed(), damping=0.0)
    run = sw.simulate(drive, sw.scenario.constant(2.0, 0.2), inputs={"output_angle": 0.0})
    twist = run.time**2 / RATIO
    assert run["torque"] == pytest.approx(K * twist, abs=1e-9)
    assert run["motor_torque"] == pytest.approx(2.0 * INERTIA + K * twist / RATIO, abs=1e-9)


def test_the_ordinary_motor_is_untouched() -> None:
    assert _core.natural_frequency(geared(load=sw.loads.Inertia(inertia=LOAD), motor=MOTOR), 0.0) == pytest.approx(
        np.sqrt(K * (1.0 / LOAD + 1.0 / (RATIO**2 * MOTOR.inertia))), rel=1e-9
    )
