"""The law of Gandhi and Ghorbel: a Lyapunov function that falls as it should, and an output that converges."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from tests.control import by_hand
from tests.control.discrete import ARM, DC, TIMES, TORQUE, check, drive

Array = NDArray[np.float64]
ROTOR, INERTIA, RATIO = 1.5e-4, 0.5, -100.0
WAVES = sw.kinematic_error.Fourier(order=[1.0, 2.0, 4.0], amplitude=[2e-4, 1e-3, 1e-4], phase=[0.3, -1.0, 2.0])
NONE = sw.kinematic_error.Fourier()
STIFF = sw.Gear(
    kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline"),
    kinematic_error=WAVES,
    stiffness=sw.stiffness.Linear(k=2e7),
    damping=5e3,
)
LOAD = sw.loads.Pendulum(inertia=INERTIA, gravity_torque=20.0)
GAIN, RATE = 0.01, 15.0  # K / M is about 50 1/s
COMMAND = sw.scenario.sine(0.3, 0.5, 4.0)


def law_for(gear: sw.Gear = STIFF, **changed: Any) -> sw.control.KinematicErrorTracking:
    gains = {"motor_inertia": ROTOR, "bandwidth": RATE, "speed_gain": GAIN, "reference_time": 1e-4, "limit": 1e3}
    return sw.control.KinematicErrorTracking(gear=gear, load=LOAD, **(gains | changed))


def joint(law: Any, gear: sw.Gear = STIFF) -> sw.Drive:
    return sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=ROTOR), load=LOAD, control=law)


def error_and_derivatives(angle: Array | float) -> tuple[Any, Any, Any]:
    waves = zip(WAVES.order, WAVES.amplitude, WAVES.phase, strict=True)
    terms = [(n, a, n * np.asarray(angle) + p) for n, a, p in waves]
    return (
        sum(a * np.sin(x) for n, a, x in terms),
        sum(n * a * np.cos(x) for n, a, x in terms),
        sum(-n * n * a * np.sin(x) for n, a, x in terms),
    )


@pytest.mark.parametrize(("period", "delay", "dt"), TIMES)
@pytest.mark.parametrize("limit", [1e3, 0.05], ids=["free", "limited"])
@pytest.mark.parametrize("feedback", ["input", "output"])
@pytest.mark.parametrize("motor", [DC, TORQUE], ids=["dc", "torque"])
def test_sampled_it_is_the_recursion(period: float, delay: float, dt: float, limit: float, feedback: str, motor: Any) -> None:
    gear = drive(sw.control.OpenLoop()).gear.replace(kinematic_error=WAVES, input_inertia=2e-5)
    per_torque, per_speed = (5.0, 0.12) if motor is DC else (1.0, 0.0)
    law = sw.control.KinematicErrorTracking(
        gear=gear,
        load=ARM,
        speed_gain=5e-3,
        limit=limit,
        feedback=feedback,
        actuation_per_torque=per_torque,
        actuation_per_speed=per_speed,
        reference_time=0.02,
    )
    wanted = check(law, by_hand.KinematicErrorTracking(law, period), motor, period, delay, dt)
    assert (np.abs(wanted["actuation"]).max() == limit) == (limit < 1.0)


def test_the_equations_of_the_page_have_the_lyapunov_function() -> None:
    """The law as the page states it, on the rigid gear of Lagrange: V = M s^2/2 falls by K s^2, in any motion."""

    def of(time: float, x: Array) -> tuple[float, float, float]:
        """Acceleration, V and K s^2."""
        angle, speed = x[:2]
        error, slope, curvature = error_and_derivatives(angle)
        g, dg = 1.0 / RATIO - slope, -curvature
        q, mass, dmass = angle / RATIO - error, ROTOR + INERTIA * g**2, 2.0 * INERTIA * g * dg
        w = np.pi
        r, dr, ddr = 0.3 * np.sin(w * time), 0.3 * w * np.cos(w * time), -0.3 * w**2 * np.sin(w * time)
        wanted = (dr + RATE * (r - q)) / g
        wanted_rate = (ddr + RATE * (dr - g * speed)) / g - wanted * dg * speed / g
        carried = 20.0 * np.sin(q)
        s = speed - wanted
        torque = mass * wanted_rate + 0.5 * dmass * speed * wanted + g * carried - GAIN * s
        acceleration = (torque - g * carried - 0.5 * dmass * speed**2) / mass
        return float(acceleration), float(0.5 * mass * s**2), float(GAIN * s**2)

    def rate(time: float, x: Array) -> list[float]:
        acceleration, _, dissipated = of(time, x)
        return [x[1], acceleration, dissipated]

    found = solve_ivp(rate, (0.0, 1.0), [1.0, 30.0, 0.0], rtol=1e-11, atol=1e-13, t_eval=np.linspace(0.0, 1.0, 50))
    values = np.array([of(t, x)[1] for t, x in zip(found.t, found.y.T, strict=True)])
    assert values + found.y[2] == pytest.approx(values[0], rel=1e-8)
    assert values[-1] < 1e-6 * values[0]


def lyapunov(run: Any, command: Any) -> tuple[Array, Array]:
    """V and K s^2 of a run of the joint, by its own angles and speeds."""
    _, slope, _ = error_and_derivatives(run["input_angle"])
    g = 1.0 / RATIO - slope
    s = run["input_speed"] - (command.rate(run.time) + RATE * (command.value(run.time) - run["output_angle"])) / g
    return 0.5 * (ROTOR + INERTIA * g**2) * s**2, GAIN * s**2


def test_along_the_motion_of_a_stiff_joint_it_falls_as_predicted() -> None:
    """From a state away from the command; the twist leaves a per cent."""
    start = {"input_speed": 20.0, "output_speed": 20.0 / RATIO}
    command = sw.scenario.constant(0.3, 0.3)
    run = sw.simulate(joint(law_for()), command, 2e-6, sample=1e-4, initial=start)
    value, dissipated = lyapunov(run, command)
    gone = np.concatenate([[0.0], np.cumsum(0.5 * (dissipated[1:] + dissipated[:-1]) * np.diff(run.time))])
    settled = run.time > 0.01  # the twist that the start lacks has come
    assert (np.diff(value[settled]) < 1e-4 * value[0]).all()
    assert value[settled] == pytest.approx((value[0] - gone)[settled], abs=0.02 * value[0])
    assert value[-1] < 1e-5 * value[0]


@pytest.mark.slow("physics")
def test_the_output_converges_where_the_error_is_known() -> None:
    """On a sine, with gravity: to a hundredth of the kinematic error; where it is left out, it stays."""
    errors = {}
    for name, known in (("known", WAVES), ("unknown", NONE)):
        run = sw.simulate(joint(law_for(STIFF.replace(kinematic_error=known))), COMMAND, 5e-6, sample=1e-3)
        errors[name] = np.abs((COMMAND.value(run.time) - run["output_angle"])[2000:]).max()
    assert errors["known"] < 1e-5
    assert errors["unknown"] > 20.0 * errors["known"]


@pytest.mark.slow("physics")
def test_by_the_input_encoder_alone_the_twist_stays() -> None:
    """The output follows but for its twist under the torque of load and acceleration."""
    run = sw.simulate(joint(law_for(feedback="input")), COMMAND, 5e-6, sample=1e-3)
    error = (COMMAND.value(run.time) - run["output_angle"])[2000:]
    assert error == pytest.approx(run["torque"][2000:] / 2e7, abs=1e-5)


@pytest.mark.slow("physics")
def test_at_a_set_point_it_comes_to_rest_with_the_rate_of_its_loop() -> None:
    command = sw.scenario.constant(0.2, 1.5)
    run = sw.simulate(joint(law_for()), command, 5e-6, sample=1e-3)
    error = 0.2 - run["output_angle"]
    assert abs(error[-1]) < 1e-7
    late = (run.time > 0.3) & (run.time < 0.5)  # K / M is three times as fast as lambda
    rate = -np.polyfit(run.time[late], np.log(np.abs(error[late])), 1)[0]
    assert rate == pytest.approx(RATE, rel=0.02)


@pytest.mark.slow("physics")
@pytest.mark.parametrize("share", [0.7, 1.3])
def test_a_wrong_amplitude_leaves_a_bounded_error(share: float) -> None:
    """With e' wrong by D the error obeys de/dt = -lambda e + D omega + g s: |e| <= (D omega + g |s|) / lambda."""
    wrong = WAVES.replace(amplitude=[share * each for each in WAVES.amplitude])
    run = sw.simulate(joint(law_for(STIFF.replace(kinematic_error=wrong))), COMMAND, 5e-6, sample=1e-3)
    error = np.abs((COMMAND.value(run.time) - run["output_angle"])[2000:]).max()
    _, slope, _ = error_and_derivatives(np.linspace(0.0, 2.0 * np.pi, 1000))
    missing, speed = abs(share - 1.0) * np.abs(slope).max(), np.abs(run["input_speed"]).max()
    assert error < 1.1 * missing * speed / RATE
    assert error > 0.02 * missing * speed / RATE
