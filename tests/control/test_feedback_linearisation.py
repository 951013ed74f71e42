"""Feedback linearisation of a flexible joint: the output obeys the linear equation that the gains make."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray

from tests.control import by_hand
from tests.control.discrete import ARM, DC, SPRING, TIMES, TORQUE, check, drive

Array = NDArray[np.float64]
W = 40.0  # rad/s
ROTOR = 1e-4
HARDENS = sw.stiffness.Cubic(a1=8000.0, a3=4e7)
WAVES = sw.kinematic_error.Fourier(order=[1.0, 2.0], amplitude=[1e-4, 3e-4], phase=[0.0, 0.0])
GEAR = sw.Gear(
    kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline"),
    kinematic_error=WAVES,
    stiffness=HARDENS,
    input_inertia=5e-5,
)
LOADS = {"inertia": sw.loads.Inertia(inertia=0.5), "pendulum": sw.loads.Pendulum(inertia=0.5, gravity_torque=40.0)}


def law_for(gear: sw.Gear, load: Any, **changed: float) -> sw.control.FeedbackLinearisation:
    gains = {"motor_inertia": ROTOR, "bandwidth": W, "limit": 1e6} | changed
    return sw.control.FeedbackLinearisation(gear=gear, load=load, **gains)


def joint(control: Any, load: Any, gear: sw.Gear = GEAR) -> sw.Drive:
    return sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=ROTOR), load=load, control=control)


def step_error(time: Array, w: float = W) -> Array:
    """Of a step of 1 that four poles at -w take away, from rest."""
    x = w * time
    return np.asarray(np.exp(-x) * (1.0 + x + x**2 / 2.0 + x**3 / 6.0))


@pytest.mark.parametrize(("period", "delay", "dt"), TIMES)
@pytest.mark.parametrize("limit", [1e3, 0.05], ids=["free", "limited"])
@pytest.mark.parametrize("motor", [DC, TORQUE], ids=["dc", "torque"])
def test_sampled_it_is_the_recursion(period: float, delay: float, dt: float, limit: float, motor: Any) -> None:
    gear = drive(sw.control.OpenLoop()).gear.replace(kinematic_error=WAVES, input_inertia=2e-5)
    per_torque, per_speed = (5.0, 0.12) if motor is DC else (1.0, 0.0)
    law = law_for(
        gear,
        ARM,
        bandwidth=25.0,
        limit=limit,
        actuation_per_torque=per_torque,
        actuation_per_speed=per_speed,
        reference_time=0.02,
    )
    wanted = check(law, by_hand.FeedbackLinearisation(law, period), motor, period, delay, dt, share=1e-10)
    assert (np.abs(wanted["actuation"]).max() == limit) == (limit < 1.0)


@pytest.mark.parametrize("kind", LOADS)
@pytest.mark.parametrize("size", [1e-3, 1.0])
def test_a_step_of_any_size_is_that_of_a_linear_equation(kind: str, size: float) -> None:
    """Closed form; with gravity, within the differences over 0.01 / w."""
    run = sw.simulate_adaptively(
        joint(law_for(GEAR, LOADS[kind]), LOADS[kind]), sw.scenario.constant(size, 0.5), 1e-9, sample=1e-3
    )
    error = 1.0 - run["output_angle"] / size
    assert np.abs(error - step_error(run.time)).max() < {"inertia": 1e-6, "pendulum": 3e-5}[kind]


def test_where_a_linear_design_differs() -> None:
    """Poles placed at -w for the stiffness at rest: a small step is that of the linear equation, a large one is not."""
    gear, load = GEAR.replace(kinematic_error=sw.kinematic_error.Fourier()), LOADS["inertia"]
    ratio, rotor, k, inertia = gear.kinematics.ratio, ROTOR + gear.input_inertia, HARDENS.a1, load.inertia
    # theta = i (q + J q''/k) in rotor theta'' = u - T/i: the coefficients of q and its derivatives are those of a (s + w)^4
    a = rotor * ratio * inertia / k
    of_angle, of_speed = 6.0 * W**2 * rotor - k / inertia * rotor - k / ratio**2, 4.0 * W * rotor
    gains = {"input_angle": of_angle, "input_speed": of_speed}
    gains |= {"output_angle": W**4 * a - of_angle * ratio, "output_speed": 4.0 * W**3 * a - of_speed * ratio}
    linear = sw.control.StateFeedback(**gains, limit=1e6)
    misses = {}
    for size in (1e-3, 1.0):
        run = sw.simulate_adaptively(joint(linear, load, gear), sw.scenario.constant(size, 0.5), 1e-9, sample=1e-3)
        misses[size] = np.abs(1.0 - run["output_angle"] / size - step_error(run.time)).max()
    assert misses[1e-3] < 1e-4
    assert misses[1.0] > 0.02


def test_its_poles_are_four_at_the_bandwidth() -> None:
    """And those of the two lags of the command."""
    found = sw.linearise(joint(law_for(GEAR, LOADS["inertia"], reference_time=1e-3), LOADS["inertia"])).poles
    of_output = found[np.abs(found) < 500.0]
    assert np.poly(of_output).real == pytest.approx([1.0, 4.0 * W, 6.0 * W**2, 4.0 * W**3, W**4], rel=1e-5)


@pytest.mark.parametrize("time", [0.002, 0.02])
def test_a_sine_leaves_what_the_lags_miss(time: float) -> None:
    r"""E/R = (s^4 + 4 w s^3 (1 - 1/(1 + t s)^2) + 6 w^2 s^2 (1 - 1/(1 + t s)))/(s + w)^4."""
    load, frequency = LOADS["inertia"], 1.0
    command = sw.scenario.sine(0.3, frequency, 3.0)
    run = sw.simulate_adaptively(joint(law_for(GEAR, load, reference_time=time), load), command, 1e-9, sample=1e-3)
    last = run.time >= 2.0 - 1e-9
    t = run.time[last][:-1]
    error = (command.value(run.time) - run["output_angle"])[last][:-1]
    s = 2j * np.pi * frequency
    lag = 1.0 / (1.0 + time * s)
    share = (s**4 + 4.0 * W * s**3 * (1.0 - lag**2) + 6.0 * W**2 * s**2 * (1.0 - lag)) / (s + W) ** 4
    found = 2.0 * np.mean(error * np.exp(-s * t)) * 1j / 0.3
    assert found == pytest.approx(share, rel=1e-5)


@pytest.mark.parametrize("share", [0.7, 1.1, 1.3])
def test_a_wrong_stiffness_moves_the_poles_as_the_page_says(share: float) -> None:
    """To s^4 + 4 w s^3 + (6 w^2 - (k - 1) W^2) s^2 + (4 w^3 s + w^4)/k, W the vibration of the joint with both ends free."""
    gear, load = GEAR.replace(kinematic_error=sw.kinematic_error.Fourier()), LOADS["inertia"]
    model = gear.replace(stiffness=sw.stiffness.Cubic(a1=share * HARDENS.a1, a3=share * HARDENS.a3))
    rotor = ROTOR + gear.input_inertia
    vibration = HARDENS.a1 / load.inertia * (1.0 + load.inertia / (gear.kinematics.ratio**2 * rotor))
    for w in (30.0, 60.0):
        law = law_for(model, load, bandwidth=w, reference_time=1e-4)
        found = sw.linearise(joint(law, load, gear)).poles
        of_output = np.poly(found[np.abs(found) < 5e3]).real
        wanted = [1.0, 4.0 * w, 6.0 * w**2 - (share - 1.0) * vibration, 4.0 * w**3 / share, w**4 / share]
        assert of_output == pytest.approx(wanted, rel=1e-5, abs=1e-3 * w**2)


@pytest.mark.parametrize("share", [1.1, 1.3])
def test_the_least_bandwidth_for_a_stiffness_too_large_is_that_of_routh(share: float) -> None:
    """w^2 = (k - 1) W^2/(5 - 1/k): a per cent above it the joint is stable, a per cent below it is not."""
    gear, load = GEAR.replace(kinematic_error=sw.kinematic_error.Fourier()), LOADS["inertia"]
    model = gear.replace(stiffness=sw.stiffness.Cubic(a1=share * HARDENS.a1, a3=share * HARDENS.a3))
    rotor = ROTOR + gear.input_inertia
    vibration = HARDENS.a1 / load.inertia * (1.0 + load.inertia / (gear.kinematics.ratio**2 * rotor))
    least = np.sqrt((share - 1.0) * vibration / (5.0 - 1.0 / share))
    stable = [
        sw.linearise(joint(law_for(model, load, bandwidth=by * least), load, gear)).poles.real.max() < 0.0
        for by in (0.99, 1.01)
    ]
    assert stable == [False, True]


def test_a_load_that_the_model_lacks_leaves_an_error() -> None:
    """At rest v = -T' d/J^2 and 6 w^2 of the acceleration d/J that the twist feigns: e = (6/w^2 - T'/(J w^4)) d/J."""
    load, torque = LOADS["inertia"], 0.5
    plant = joint(law_for(GEAR.replace(kinematic_error=sw.kinematic_error.Fourier()), load), load)
    plant = plant.replace({"gear.kinematic_error": sw.kinematic_error.Fourier()})
    run = sw.simulate_adaptively(plant, sw.scenario.constant(0.0, 1.0), 1e-9, load_torque=torque, sample=0.01)
    wanted = (6.0 / W**2 - HARDENS.a1 / (load.inertia * W**4)) * torque / load.inertia
    assert 0.0 - run["output_angle"][-1] == pytest.approx(wanted, rel=1e-3)


def test_friction_is_left_to_a_compensation() -> None:
    """A model of friction alone and an observer: Coulomb friction on a sine leaves a tenth of the error without them."""
    friction, load = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05, viscous=1e-3), LOADS["inertia"]
    gear = GEAR.replace(damping=5.0, friction_input=friction)
    law = law_for(gear, load, limit=5.0)
    dry = sw.Gear(kinematics=GEAR.kinematics, stiffness=sw.stiffness.Linear(k=1e12), friction_input=friction)
    model = sw.compensation.ModelFeedforward(gear=dry, load=sw.loads.Inertia(inertia=1e-12))
    command, errors = sw.scenario.sine(0.3, 0.5, 4.0), []
    for added in (sw.Compensation(), sw.Compensation(feedforward=model)):
        control = sw.control.Sampled(law=law, period=5e-4, compensation=added)
        run = sw.simulate(joint(control, load, gear), command, sample=1e-3)
        errors.append(np.sqrt(np.mean((command.value(run.time) - run["output_angle"])[2000:] ** 2)))
    assert errors[1] < 0.1 * errors[0]


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"load": sw.loads.Prescribed()}, "load must not be Prescribed"),
        (
            {"gear": GEAR.replace(kinematic_error=sw.kinematic_error.Fourier(order=[2.0], amplitude=[6e-3], phase=[0.0]))},
            r"steepest slope of the kinematic error is 1\.2",
        ),
    ],
)
@pytest.mark.parametrize("law", [sw.control.FeedbackLinearisation, sw.control.KinematicErrorTracking])
def test_what_it_refuses(law: Any, parts: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        law(**parts)


def test_a_gear_without_stiffness_asks_for_what_is_finite() -> None:
    """In the play of a gear the law divides by the least stiffness, and the limit holds."""
    play = sw.stiffness.Backlash(law=sw.stiffness.Linear(k=SPRING), clearance=0.01)
    gear = drive(sw.control.OpenLoop()).gear.replace(stiffness=play)
    control = sw.control.Sampled(law=law_for(gear, ARM, limit=0.3), period=1e-3)
    run = sw.simulate(drive(control, TORQUE).replace(gear=gear), sw.scenario.constant(0.1, 0.5), sample=1e-3)
    assert np.isfinite(run["output_angle"]).all()
    assert np.abs(run["motor_torque"]).max() == 0.3


@pytest.mark.parametrize("law", [sw.control.FeedbackLinearisation, sw.control.KinematicErrorTracking])
def test_a_model_whose_ratio_is_rounded_has_that_of_the_drive(law: Any) -> None:
    """A drive accepts a difference of 0.1 %. By its own ratio the law would be wrong in proportion to the angle."""
    load, others = sw.loads.Inertia(inertia=0.5), {"motor_inertia": ROTOR, "limit": 1e6}
    plain = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), stiffness=sw.stiffness.Linear(k=1e5), damping=50.0)
    model = plain.replace({"kinematics.reduction": 100.05})
    run = sw.simulate(joint(law(gear=model, load=load, **others), load, plain), sw.scenario.ramp(2.0, 3.0), sample=1e-3)
    assert abs(run["command"][-1] - run["output_angle"][-1]) < 1e-7


@pytest.mark.parametrize("law", [sw.control.FeedbackLinearisation, sw.control.KinematicErrorTracking])
def test_a_period_beyond_the_lags_of_the_command_is_refused(law: Any) -> None:
    within = law(gear=GEAR, load=ARM, reference_time=0.005)
    assert sw.control.Sampled(law=within, period=0.005).period == 0.005
    with pytest.raises(ValueError, match="period must not exceed reference_time of the law"):
        sw.control.Sampled(law=within, period=0.0051)


def test_a_feedforward_of_another_ratio_than_that_of_the_law_is_refused() -> None:
    other = sw.compensation.ModelFeedforward(gear=sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=50.0)))
    with pytest.raises(ValueError, match="law and compensation contain models of different ratios"):
        sw.control.Sampled(law=law_for(GEAR, ARM), compensation=sw.Compensation(feedforward=other))
