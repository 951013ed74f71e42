"""The regulator that measures the input alone: its filter against closed forms, the separation principle, the robot joint."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from scipy.linalg import expm
from strainwave.tuning.linear_quadratic import filter_gain

Array = NDArray[np.float64]
ROTOR, ARM, RATIO, SPRING, DAMPING = 1e-4, 0.6, 100.0, 2e4, 15.0
PERIOD = 1e-3
JOINT = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=RATIO), stiffness=sw.stiffness.Linear(k=SPRING), damping=DAMPING
    ),
    motor=sw.motor.TorqueSource(inertia=ROTOR),
    load=sw.loads.Inertia(inertia=ARM),
)
WEIGHTS = {"error": 1e-3, "effort": 0.2}
NOISE = {"resolution": 1e-3, "torque_noise": 0.02, "disturbance_rate": 0.5}
delays = pytest.mark.parametrize("delay", [0.0, 3e-4, 1e-3])


@pytest.mark.parametrize(("walk", "noise"), [(0.5, 1.0), (1e-6, 2.0), (3.0, 0.01)])
def test_the_gain_of_a_random_walk_has_a_closed_form(walk: float, noise: float) -> None:
    """P = (q + (q^2 + 4 q r)^(1/2))/2 before a measurement, and M = P/(P + r)."""
    before = 0.5 * (walk + np.sqrt(walk**2 + 4.0 * walk * noise))
    found = filter_gain(np.array([[1.0]]), np.array([1.0]), np.array([[walk]]), noise)
    assert found == pytest.approx([before / (before + noise)], rel=1e-9)


def test_the_gain_of_a_double_integrator_is_that_of_kalata() -> None:
    """alpha and beta of the tracking index L = T^2 sigma_w / sigma_v: L^2 = beta^2/(1 - alpha), alpha by Kalata's r."""
    period, sigma_w, sigma_v = 0.1, 3.0, 0.02
    index = period**2 * sigma_w / sigma_v
    r = (4.0 + index - np.sqrt(8.0 * index + index**2)) / 4.0
    alpha = 1.0 - r**2
    beta = 2.0 * (2.0 - alpha) - 4.0 * np.sqrt(1.0 - alpha)
    pushed = np.array([0.5 * period**2, period])
    step = np.array([[1.0, period], [0.0, 1.0]])
    found = filter_gain(step, np.array([1.0, 0.0]), sigma_w**2 * np.outer(pushed, pushed), sigma_v**2)
    assert found == pytest.approx([alpha, beta / period], rel=1e-8)


def exact_plant(delay: float) -> tuple[Array, Array, Array]:
    """F, G of the input before and G of the input, of input angle, input speed, output angle, output speed; by hand."""
    a, b = np.zeros((4, 4)), np.array([0.0, 1.0 / ROTOR, 0.0, 0.0])
    twist = np.array([1.0 / RATIO, 0.0, -1.0, 0.0])
    torque = SPRING * twist + DAMPING * np.roll(twist, 1)
    a[0, 1] = a[2, 3] = 1.0
    a[1], a[3] = -torque / RATIO / ROTOR, torque / ARM

    def over(time: float) -> tuple[Array, Array]:
        whole = np.zeros((5, 5))
        whole[:4, :4], whole[:4, 4] = a, b
        exact = expm(whole * time)
        return exact[:4, :4], exact[:4, 4]

    (first, before), (rest, after) = over(delay), over(PERIOD - delay)
    return rest @ first, rest @ before, after


def matrices(law: sw.control.StateSpace) -> tuple[Array, Array, Array, float]:
    """A_d, B_d, C and D of its recursion."""
    size = len(law.C)
    step = np.eye(size) + PERIOD * np.reshape(law.A, (size, size))
    return step, PERIOD * np.reshape(law.B, (size, 8))[:, 0], np.array(law.C), law.D[0]


def closed_loop(law: sw.control.StateSpace, delay: float) -> Array:
    """The matrix of plant, input before and law from instant to instant."""
    step, late, now = exact_plant(delay)
    a, b, c, d = matrices(law)
    size = len(c)
    sees = -np.eye(1, 4)[0]  # commanded minus measured
    row = np.concatenate([d * sees, [0.0], c])  # u of plant, input before, law
    whole = np.zeros((5 + size, 5 + size))
    whole[:4, :4], whole[:4, 4] = step, late
    whole[:4] += np.outer(now, row)
    whole[4] = row
    whole[5:, :4], whole[5:, 5:] = np.outer(b, sees), a
    return whole


def has(poles: Array, pole: complex, error: float) -> bool:
    return bool(np.abs(poles - pole).min() < error)


def test_the_closed_loop_has_the_poles_of_the_regulator() -> None:
    """The separation principle: those of the regulator that measures all are among them."""
    found = np.linalg.eigvals(closed_loop(sw.tuning.lqg(JOINT, period=PERIOD, encoder="input", **WEIGHTS, **NOISE), 0.0))
    full = sw.tuning.lqg(JOINT, period=PERIOD, **WEIGHTS)
    step, _, now = exact_plant(0.0)
    gains = np.array([full.input_angle, full.input_speed, full.output_angle, full.output_speed])
    for pole in np.linalg.eigvals(step - np.outer(now, gains)):
        assert has(found, pole, 1e-6)


@delays
def test_the_other_poles_are_those_of_the_filter(delay: float) -> None:
    """They are the five stable roots of r + H(z) Q H(1/z), with H from process noise to measurement."""
    law = sw.tuning.lqg(JOINT, period=PERIOD, delay=delay, encoder="input", **WEIGHTS, **NOISE)
    found = np.linalg.eigvals(closed_loop(law, delay))
    assert np.abs(found).max() < 1.0
    step, late, now = exact_plant(delay)
    whole = np.zeros((5, 5))
    whole[:4, :4], whole[:4, 4], whole[4, 4] = step, late + now, 1.0
    process = np.zeros((5, 5))
    process[:4, :4] = NOISE["torque_noise"] ** 2 * np.outer(late + now, late + now)
    process[4, 4] = NOISE["disturbance_rate"] ** 2 * PERIOD

    def spectrum(z: complex) -> complex:
        forth, back = (np.linalg.solve(each * np.eye(5) - whole.T, np.eye(5)[0]) for each in (z, 1.0 / z))
        return complex(NOISE["resolution"] ** 2 / 12.0 + forth @ process @ back)

    def newton(z: complex) -> complex:
        for _ in range(4):
            z -= spectrum(z) * 2e-6 / (spectrum(z + 1e-6) - spectrum(z - 1e-6))
        return z

    of_filter = [pole for pole in found if abs(pole) > 1e-9 and abs(newton(pole) - pole) < 1e-5]
    assert len(of_filter) == 5


def test_of_a_step_the_motion_is_that_of_the_regulator_that_measures_all() -> None:
    """The jump of the command does not excite the filter, and the joint is the model."""
    runs = []
    for encoder in ("input", "output"):
        law: Any = sw.tuning.lqg(JOINT, period=PERIOD, encoder=encoder, **WEIGHTS)  # type: ignore[call-overload]
        control = sw.control.Sampled(law=law.replace(limit=1e6), period=PERIOD)
        run = sw.simulate(JOINT.replace(control=control), sw.scenario.constant(0.1, 0.5), 2e-5, sample=PERIOD)
        runs.append(run["output_angle"])
    assert runs[0] == pytest.approx(runs[1], abs=1e-7 * np.abs(runs[1]).max())


def test_a_feedforward_of_the_model_does_not_excite_the_filter() -> None:
    """Of a planned motion: the joint follows as the model moves, where without feed-forward it lags."""
    model = sw.compensation.ModelFeedforward(gear=JOINT.gear, load=JOINT.load, motor_inertia=ROTOR)
    command, errors = sw.scenario.sine(0.2, 1.0, 2.0, phase=-0.5 * np.pi, offset=0.2), []
    law = sw.tuning.lqg(JOINT, period=PERIOD, encoder="input", **WEIGHTS)
    for added in (sw.Compensation(), sw.Compensation(feedforward=model)):
        control = sw.control.Sampled(law=law, period=PERIOD, compensation=added)
        run = sw.simulate(JOINT.replace(control=control), command, sample=PERIOD)
        errors.append(np.abs(command.value(run.time) - run["output_angle"])[1000:].max())
    assert errors[1] < 0.02 * errors[0]


@delays
def test_weight_and_viscous_friction_leave_no_error_of_the_input(delay: float) -> None:
    """They are torques at the motor to the filter, at rest and at constant speed."""
    viscous = JOINT.gear.replace(friction_input=sw.friction.Viscous(viscous=2e-3))
    load = sw.loads.Pendulum(inertia=ARM, gravity_torque=5.0)
    for plant, command in (
        (JOINT.replace(load=load), sw.scenario.constant(0.5, 3.0)),
        (JOINT.replace(gear=viscous), sw.scenario.ramp(0.1, 3.0)),
    ):
        law = sw.tuning.lqg(plant, period=PERIOD, delay=delay, encoder="input", **WEIGHTS)
        control = sw.control.Sampled(law=law, period=PERIOD, delay=delay)
        run = sw.simulate(plant.replace(control=control), command, sample=PERIOD)
        assert run["input_angle"][-1] / RATIO == pytest.approx(float(command.value(3.0)), rel=1e-6)


@delays
def test_a_constant_torque_at_the_motor_leaves_no_error(delay: float) -> None:
    """Of Coulomb friction on a ramp; the regulator that measures all keeps the error friction / gain."""
    friction = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05)
    command = sw.scenario.ramp(0.1, 3.0)
    errors = {}
    for encoder in ("input", "output"):
        law: Any = sw.tuning.lqg(JOINT, period=PERIOD, delay=delay, encoder=encoder, **WEIGHTS)  # type: ignore[call-overload]
        control = sw.control.Sampled(law=law, period=PERIOD, delay=delay)
        plant = JOINT.replace(gear=JOINT.gear.replace(friction_input=friction), control=control)
        run = sw.simulate(plant, command, sample=PERIOD)
        errors[encoder] = RATIO * command.value(3.0) - run["input_angle"][-1]
    gain = law.input_angle + law.output_angle / RATIO
    assert errors["output"] == pytest.approx(0.05 / gain, rel=1e-3)
    assert abs(errors["input"]) < 1e-6 * errors["output"]


def test_at_its_limit_the_filter_goes_on() -> None:
    """By `tracking` it takes what the motor was given, and moves as the regulator that measures all does at the same limit."""
    full, law = (
        sw.tuning.lqg(JOINT, period=PERIOD, **WEIGHTS),
        sw.tuning.lqg(JOINT, period=PERIOD, encoder="input", **WEIGHTS),
    )
    runs = []
    for each in (full, law, law.replace(tracking=())):
        control = sw.control.Sampled(law=each.replace(limit=0.5), period=PERIOD)
        run = sw.simulate(JOINT.replace(control=control), sw.scenario.constant(1.0, 1.0), 2e-5, sample=PERIOD)
        runs.append(run["output_angle"])
    assert runs[1] == pytest.approx(runs[0], abs=1e-6)
    assert np.abs(runs[2] - runs[0]).max() > 0.01


def test_on_the_robot_joint_it_is_about_as_good_as_all_that_is_measured() -> None:
    """With its friction, weight, hysteresis and kinematic error, in rms over a sine that reverses."""
    joint = sw.GearSet.read("robot-joint")
    errors, command = {}, sw.scenario.sine(0.2, 0.5, 4.0)
    for encoder in ("output", "input"):
        law: Any = sw.tuning.lqg(joint, error=2e-4, encoder=encoder)  # type: ignore[call-overload]
        plant = joint.drive.replace(
            motor=sw.motor.CurrentSource(torque_constant=0.0320319, inertia=5.48e-5),
            sensors=sw.Sensors(),
            control=sw.control.Sampled(law=law, period=PERIOD),
        )
        run = sw.simulate(plant, command, sample=PERIOD)
        errors[encoder] = np.sqrt(np.mean((command.value(run.time) - run["output_angle"])[2000:] ** 2))
    assert errors["input"] < 1.5 * errors["output"]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"encoder": "motor"}, "encoder"),
        ({"encoder": "input", "delay": 2 * PERIOD}, "exceeds the period"),
        ({"encoder": "input", "resolution": 0.0}, "resolution"),
        ({"encoder": "input", "torque_noise": -1.0}, "torque_noise"),
        ({"encoder": "input", "disturbance_rate": 0.0}, "disturbance_rate"),
    ],
)
def test_what_it_refuses(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        sw.tuning.lqg(JOINT, **changes)
