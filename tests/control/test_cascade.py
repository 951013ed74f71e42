"""Position, speed and current in cascade."""

from __future__ import annotations

from math import tau

import numpy as np
import pytest
import strainwave as sw
from strainwave.simulation.resolution import rounded_down

from tests.control import by_hand
from tests.control.discrete import DC, PROMPT, RATIO, TIMES, Plant, check, drive

LAW = sw.control.Cascade(
    position_gain=25.0,
    speed_proportional=0.1,
    speed_integral=2.0,
    current_proportional=0.3,
    current_integral=200.0,
    speed_feedforward=0.9,
    viscous_feedforward=0.002,
    coulomb_feedforward=0.05,
    back_emf_feedforward=0.1,
)
OUTER = (
    "position_gain",
    "speed_proportional",
    "speed_integral",
    "speed_limit",
    "speed_feedforward",
    "viscous_feedforward",
    "coulomb_feedforward",
    "feedback",
)


LIMITS = {"free": {}, "speed": {"speed_limit": 9.0}, "current": {"current_limit": 0.8}, "voltage": {"voltage_limit": 1.5}}


@pytest.mark.parametrize(("period", "delay", "dt"), TIMES)
@pytest.mark.parametrize("feedback", ["input", "output"])
@pytest.mark.parametrize("limited", list(LIMITS))
def test_sampled_it_is_the_recursion(period: float, delay: float, dt: float, feedback: str, limited: str) -> None:
    law = LAW.replace(feedback=feedback, **LIMITS[limited])
    wanted = check(law, by_hand.Cascade(law, period), DC, period, delay, dt)
    assert (np.abs(wanted["actuation"]).max() == law.voltage_limit) == (limited == "voltage")


@pytest.mark.parametrize("delay", [0.0, 3e-4, 1e-3])
def test_so_it_is_where_the_current_follows_the_voltage_at_once(delay: float) -> None:
    """The current it sees is that under the voltage that is still held."""
    law = LAW.replace(current_proportional=0.1, current_integral=60.0)
    check(law, by_hand.Cascade(law, 1e-3), PROMPT, 1e-3, delay)


def test_a_current_that_would_determine_its_own_voltage_is_refused() -> None:
    with pytest.raises(ValueError, match="give the motor an inductance, or let the control be Sampled"):
        drive(LAW, PROMPT)
    with pytest.raises(ValueError, match="control gives a voltage, and the motor takes none"):
        drive(LAW, sw.motor.TorqueSource())


def test_a_current_loop_designed_as_the_text_says_has_its_bandwidth() -> None:
    """k_c = L w, k_ci = R w, and the back-EMF fed forward: i = i_r (1 - e^(-w t))."""
    width = 800.0
    law = sw.control.Cascade(
        position_gain=0.0,
        speed_proportional=0.0,
        viscous_feedforward=0.02,
        current_proportional=DC.inductance * width,
        current_integral=DC.resistance * width,
        back_emf_feedforward=DC.back_emf,
    )
    run = sw.simulate(drive(law), sw.scenario.ramp(0.5, 0.02), 1e-5)
    asked = 0.02 * RATIO * 0.5
    assert run["current"] == pytest.approx(-asked * np.expm1(-width * run.time), abs=1e-9)


def test_its_response_is_that_of_the_block_diagram() -> None:
    law = LAW.replace(coulomb_feedforward=0.0, voltage_limit=1e6, current_limit=1e6, speed_limit=1e6)
    frequency = np.array([0.3, 2.0, 7.0, 30.0])
    found = sw.linearise(drive(law)).response(frequency, output="input_angle")
    a, b = Plant(DC).matrices
    for f, response in zip(frequency, found, strict=True):
        s = 1j * tau * f
        current, angle, speed, *_ = np.linalg.solve(s * np.eye(5) - a, b)
        inner, outer = law.current_proportional + law.current_integral / s, law.speed_proportional + law.speed_integral / s
        # u = inner (i_r - i) + K omega, with i_r = outer (k_p (c - theta) + f s c - omega) + b s c, of a command c = i r
        loop = inner * (outer * (law.position_gain * angle + speed) + current) - law.back_emf_feedforward * speed
        forward = inner * (outer * (law.position_gain + law.speed_feedforward * s) + law.viscous_feedforward * s)
        assert response == pytest.approx(RATIO * angle * forward / (1.0 + loop), rel=1e-9)


@pytest.mark.parametrize("limited", [{"current_limit": 0.3}, {"voltage_limit": 3.0}], ids=["current", "voltage"])
def test_its_integrals_do_not_wind_up(limited: dict[str, float]) -> None:
    """Long at a limit, it arrives without going beyond; summed up, the error would ask for thirty times the current."""
    law = sw.control.Cascade(
        position_gain=1.0,
        speed_proportional=0.05,
        speed_integral=0.5,
        current_proportional=0.4,
        current_integral=400.0,
        back_emf_feedforward=DC.back_emf,
        **limited,
    )
    run = sw.simulate(drive(law), sw.scenario.constant(4.0, 12.0), sample=1e-3)
    at_limit = run["current"] > 0.297 if "current_limit" in limited else run["voltage"] == 3.0
    speed_error = (4.0 * RATIO - run["input_angle"]) * law.position_gain - run["input_speed"]
    assert law.speed_integral * speed_error[at_limit].sum() * 1e-3 > 30.0 * 0.3
    assert run["output_angle"].max() <= 4.0
    assert run["output_angle"][-1] == pytest.approx(4.0, rel=1e-4)


def test_what_its_motor_cannot_follow_rests_its_integrals() -> None:
    """The supply of a brushless motor, below the limit of the law, does the same as a law with that limit."""
    weak = sw.motor.BrushlessDC(
        resistance=0.5, inductance=5e-4, torque_constant=0.1, inertia=1e-4, supply_voltage=1.0, current_limit=1e3
    )
    strong = weak.replace(supply_voltage=1e3)
    law = LAW.replace(coulomb_feedforward=0.0)
    command = sw.scenario.constant(1.0, 1.0)
    by_motor = sw.simulate(drive(law, weak), command, sample=1e-3)
    by_law = sw.simulate(drive(law.replace(voltage_limit=1.0), strong), command, sample=1e-3)
    assert np.count_nonzero(by_motor["voltage"] == 1.0) > 50
    for name in ("output_angle", "current", "voltage"):
        assert np.array_equal(by_motor[name], by_law[name])
    assert by_motor.end["control.speed_integral"] == by_law.end["control.speed_integral"]
    assert by_motor.end["control.current_integral"] == by_law.end["control.current_integral"]


def test_its_outer_loops_are_those_of_position_and_speed() -> None:
    """With a current loop much faster than they are, the drive is that of a motor whose current is given."""
    outer = {name: getattr(LAW, name) for name in OUTER}
    alone = sw.control.PositionSpeed(limit=LAW.current_limit, **outer)
    source = sw.motor.CurrentSource(torque_constant=DC.torque_constant, inertia=DC.inertia)
    command = sw.scenario.sine(0.2, 2.0, 0.5)
    wanted = sw.simulate(drive(alone, source), command, sample=1e-3)
    errors = []
    for width in (4e3, 4e4):
        gains = {"current_proportional": DC.inductance * width, "current_integral": DC.resistance * width}
        law = LAW.replace(back_emf_feedforward=DC.back_emf, **gains)
        run = sw.simulate(drive(law), command, 1e-5, sample=1e-3)
        errors.append(np.abs(run["output_angle"] - wanted["output_angle"]).max())
    assert errors[1] == pytest.approx(0.1 * errors[0], rel=0.2)


def test_steps_that_cannot_follow_its_current_loop_are_refused() -> None:
    """The current decays by k_c / L beyond R / L, which steps take exactly; of 1 / s a step bears 2.5 times its length."""
    rate = LAW.current_proportional / DC.inductance
    bound = 2.5 / rate
    command = sw.scenario.constant(0.01, 0.02)
    with pytest.raises(FloatingPointError, match=f"is too coarse for this drive.*take dt = {rounded_down(bound):g} s or less"):
        sw.simulate(drive(LAW), command, 1.01 * bound)
    assert np.isfinite(sw.simulate(drive(LAW), command, 0.99 * bound)["current"]).all()
    sampled = sw.control.Sampled(law=LAW, period=1e-3)  # holds its voltage: nothing decays by it
    assert len(sw.simulate(drive(sampled), command, 1.01 * bound)) > 1


@pytest.mark.parametrize("gain", [1.0, 3.0])
def test_steps_that_are_allowed_follow_it(gain: float) -> None:
    law = LAW.replace(current_proportional=gain, current_integral=100.0 * gain, coulomb_feedforward=0.0)
    command = sw.scenario.sine(0.02, 4.0, 0.1)
    fine, coarse = (sw.simulate(drive(law), command, dt, sample=1e-3) for dt in (2e-6, 2e-4))
    assert coarse["output_angle"] == pytest.approx(fine["output_angle"], abs=1e-6 * np.abs(fine["output_angle"]).max())
    assert coarse["current"] == pytest.approx(fine["current"], abs=2e-3 * np.abs(fine["current"]).max())
