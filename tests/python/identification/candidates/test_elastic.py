"""Gears between two encoders: known ones are found, and what the encoders cannot show is refused; deviations by blocks."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.candidates.elastic import ElasticCandidate, fit_elastic, sigma_by_blocks
from strainwave.identification.experiments.motion_log import MotionLog
from strainwave.identification.fitting.fit import fit, solved_problem

LAW = sw.kinematic_error.Fourier(amplitude=[1e-4], order=[2], phase=[0.7])
TRUTH = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=50.0),
        stiffness=sw.stiffness.Linear(k=9e3),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[4e3], breakaway=[0.8]),
        damping=15.0,
        kinematic_error=LAW,
        friction_input=sw.friction.Viscous(viscous=3e-4),
        friction_mesh=sw.friction.Viscous(viscous=0.0),
    ),
    motor=sw.motor.DC(resistance=0.5, torque_constant=0.08, back_emf=0.08, inertia=8e-5),
    control=sw.control.PID(proportional=6.0, derivative=0.15),
    load=sw.loads.Pendulum(inertia=0.8, gravity_torque=15.0, gravity_phase=0.0),
)
LATE = 2e-4  # s
NUMBERS = {"gear.stiffness.k": 9e3, "gear.hysteresis.breakaway[0]": 0.8, "load.inertia": 0.8, "output_angle_delay": LATE}
FRICTION = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4)


@cache
def run() -> sw.Run:
    command = sw.scenario.sine(0.9, 0.25, 8.0) + sw.scenario.sine(0.1, 1.1, 8.0)
    return sw.simulate(TRUTH, command, 2e-4, sample=2e-3, record=["input_angle", "output_angle", "current"])


def found(noise: float, delay: float = LATE, seconds: float = 8.0) -> ElasticCandidate:
    """From the beginning of the log and a spring a third off, with an output encoder that is late."""
    random, time = np.random.default_rng(1), run().time
    late = np.interp(time - delay, time, run()["output_angle"])
    columns = {
        "time": time,
        "input_angle": run()["input_angle"] + 1e-5 * random.standard_normal(len(time)),
        "output_angle": late + noise * random.standard_normal(len(time)),
        "current": run()["current"] + 0.02 * random.standard_normal(len(time)),
    }
    columns = {name: values[time < seconds] for name, values in columns.items()}
    recording = sw.Recording(columns, {"time": "s", "input_angle": "rad", "output_angle": "rad", "current": "A"})
    drive = TRUTH.replace(gear=TRUTH.gear.replace(stiffness=sw.stiffness.Linear(k=1.2e4)))
    return fit_elastic(recording, MotionLog.of(recording, drive), drive, "load.gravity_torque", LAW)


@pytest.mark.slow("identification")
def test_spring_hysteresis_inertia_and_delay_are_found_as_surely_as_is_said() -> None:
    told = found(1e-5)
    assert told.name == "linear spring, 1 Maxwell element"
    estimates = {each.path: (each, sigma) for each, sigma in zip(told.fit.estimates, told.sigmas, strict=True)}
    for path, truth in NUMBERS.items():
        estimate, sigma = estimates[path]
        assert abs(estimate.value - truth) < 3.5 * sigma, path
    assert estimates["gear.stiffness.k"][1] < 0.02 * 9e3
    assert told.error == pytest.approx(1e-5, rel=0.15)  # the noise, and nothing else


def test_a_twist_that_noise_hides_is_not_told() -> None:
    with pytest.raises(ValueError, match="load it more, or measure the angles better"):
        found(0.1)


@pytest.mark.slow("identification")
def test_no_delay_between_encoders_is_longer_than_five_samples() -> None:
    fitted = found(1e-5, delay=0.03, seconds=4.0).fit  # 15 samples
    assert not any(each.path == "output_angle_delay" for each in fitted.estimates)


def ratios(change: float) -> NDArray[np.float64]:
    """Return sigma by blocks over sigma of the fit; viscous friction rises by the share `change` along the record."""
    random = np.random.default_rng(2)
    speed = random.uniform(1.0, 50.0, 600) * random.choice([-1.0, 1.0], 600)
    noise = 1e-4 * random.standard_normal(len(speed))
    torque = FRICTION.steady(speed) + 3e-4 * np.linspace(-0.5, 0.5, len(speed)) * change * speed + noise
    table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    found = fit(sw.Gear(friction_input=FRICTION), table, ["friction_input.coulomb", "friction_input.viscous"])
    problem, x = solved_problem(found)
    sigmas: NDArray[np.float64] = sigma_by_blocks(problem, x, found.estimates) / [each.sigma for each in found.estimates]
    return sigmas


def test_where_the_model_is_right_blocks_tell_what_the_fit_does() -> None:
    found = ratios(0.0)
    assert (found >= 1.0).all()
    assert found == pytest.approx(1.0, abs=0.7)  # a deviation by twelve blocks is known to a fifth


def test_where_a_number_changes_along_the_record_blocks_differ_by_more_than_noise_tells() -> None:
    assert ratios(0.3)[1] > 1.5
