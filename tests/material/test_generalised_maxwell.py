"""A material of Maxwell branches: moduli, losses and relaxation in closed form, alone and in a run."""

from __future__ import annotations

import math

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from strainwave.material import GeneralisedMaxwell

from tests.support.strategies import log_uniform

Array = NDArray[np.float64]

TWO = GeneralisedMaxwell(stiffness=[300.0, 80.0], relaxation_time=[0.02, 0.4])
branches = st.lists(st.tuples(log_uniform(1e0, 1e5), log_uniform(1e-4, 1e2)), min_size=1, max_size=8)
steps = st.lists(st.tuples(log_uniform(1e-5, 1e1), st.floats(-1e-2, 1e-2)), min_size=1, max_size=12)


def law_of(pairs: list[tuple[float, float]]) -> GeneralisedMaxwell:
    return GeneralisedMaxwell(stiffness=[k for k, _ in pairs], relaxation_time=[tau for _, tau in pairs])


def course_of(drawn: list[tuple[float, float]]) -> tuple[Array, Array]:
    """Time and twist, from 0."""
    return np.append(0.0, np.cumsum([dt for dt, _ in drawn])), np.append(0.0, np.cumsum([move for _, move in drawn]))


@given(branches, log_uniform(1e-3, 1e5))
def test_storage_and_loss_are_those_of_the_complex_stiffness(pairs: list[tuple[float, float]], frequency: float) -> None:
    """Of a spring and a damper in series: j w tau k / (1 + j w tau)."""
    whole = sum(k * 1j * frequency * tau / (1.0 + 1j * frequency * tau) for k, tau in pairs)
    assert law_of(pairs).storage(frequency) == pytest.approx(whole.real, rel=1e-12)
    assert law_of(pairs).loss(frequency) == pytest.approx(whole.imag, rel=1e-12)


def test_the_loss_of_a_branch_is_largest_at_its_own_time() -> None:
    law = GeneralisedMaxwell(stiffness=[500.0], relaxation_time=[0.1])
    frequencies = np.geomspace(0.1, 1e3, 401)
    loss = law.loss(frequencies)
    assert frequencies[np.argmax(loss)] == pytest.approx(10.0, rel=0.03)
    assert law.loss(10.0) == pytest.approx(250.0, rel=1e-12)
    assert law.loss(1e-3) == pytest.approx(500.0 * 0.1 * 1e-3, rel=1e-7)  # a damping k tau


@given(branches, steps)
def test_a_ramp_leads_to_the_exponential_of_each_branch(
    pairs: list[tuple[float, float]], drawn: list[tuple[float, float]]
) -> None:
    """T = k tau v + (T_0 - k tau v) e^(-dt / tau), written out with expm1."""
    time, twist = course_of(drawn)
    torque = np.zeros((len(pairs), len(time)))
    for j, (k, tau) in enumerate(pairs):
        for i, (dt, move) in enumerate(drawn):
            decay = -math.expm1(-dt / tau)
            torque[j, i + 1] = torque[j, i] * (1.0 - decay) + k * tau * move / dt * decay
    scale = max(float(np.abs(torque).sum(axis=0).max()), 1e-300)
    assert law_of(pairs).trace(time, twist) == pytest.approx(torque.sum(axis=0), abs=1e-12 * scale)


@given(branches, steps, st.integers(2, 30))
def test_a_step_may_be_divided(pairs: list[tuple[float, float]], drawn: list[tuple[float, float]], parts: int) -> None:
    law, (time, twist) = law_of(pairs), course_of(drawn)
    fine = np.append((time[:-1, None] + np.diff(time)[:, None] * np.arange(parts) / parts).ravel(), time[-1])
    between = np.interp(fine, time, twist)
    scale = max(float(np.abs(law.trace(fine, between)).max()), 1e-300)
    assert law.trace(fine, between)[::parts] == pytest.approx(law.trace(time, twist), abs=1e-9 * scale)
    most = max(float(np.abs(law.work(fine, between)).max()), 1e-300)
    assert law.work(fine, between)[::parts] == pytest.approx(law.work(time, twist), abs=1e-9 * most)


@given(branches, steps)
def test_work_is_stored_or_lost_and_what_is_lost_never_comes_back(
    pairs: list[tuple[float, float]], drawn: list[tuple[float, float]]
) -> None:
    law, (time, twist) = law_of(pairs), course_of(drawn)
    work, stored = law.work(time, twist), law.stored(time, twist)
    scale = 1e-12 * max(float(np.abs(work).max()), float(stored.max()), 1e-300)
    assert stored.min() >= 0.0
    assert np.diff(work - stored).min() >= -scale * len(time)


def test_a_cycle_loses_pi_a_squared_times_the_loss() -> None:
    """In the steady state of a sine, sampled finely."""
    frequency, amplitude, points = 5.0, 2e-3, 20000
    time = np.linspace(0.0, 2.0 * np.pi / frequency * 12, 12 * points + 1)
    work = TWO.work(time, amplitude * np.sin(frequency * time))
    assert work[-1] - work[-1 - points] == pytest.approx(np.pi * amplitude**2 * TWO.loss(frequency), rel=1e-6)


def test_it_is_not_rate_independent() -> None:
    """A loop of 0.1 Hz and one of 1 Hz, as hysteresis would have them alike."""
    slow, fast = (TWO.loss(2.0 * np.pi * each) for each in (0.1, 1.0))
    assert fast == pytest.approx(sum(k * w / (1.0 + w * w) for k, w in ((300.0, 0.04 * np.pi), (80.0, 0.8 * np.pi))))
    assert fast > 1.9 * slow


STILL = {"input_angle": 0.0, "input_speed": 0.0}


def rig(**parts: object) -> sw.Drive:
    """A gear whose input does not turn, and whose output is moved from outside."""
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), stiffness=sw.stiffness.Linear(k=1e3), **parts)
    return sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(), load=sw.loads.Prescribed(), meter=sw.meter.EnergyMeter())


@pytest.mark.parametrize("dt", [1e-2, 1e-3])
def test_a_run_relaxes_exactly_after_a_ramp(dt: float) -> None:
    """A twist at a constant rate, then held: steps longer than the shorter relaxation time follow it too."""
    law = TWO.replace(relaxation_time=[4e-3, 0.4])
    motion = sw.scenario.table([0.0, 0.5, 1.5], [0.0, 2e-3, 2e-3])
    run = sw.simulate(
        rig(material=law), sw.scenario.constant(0.0, 1.5), dt, inputs={"output_angle": motion}, initial=STILL, sample=1e-2
    )
    wanted = 1e3 * run["twist"] + law.trace(run.time, run["twist"])
    assert run["torque"] == pytest.approx(wanted, abs=1e-10)
    assert abs(run["torque"][-1] - 1e3 * run["twist"][-1]) == pytest.approx(
        80.0 * 0.4 * 4e-3 * (1.0 - math.exp(-0.5 / 0.4)) * math.exp(-1.0 / 0.4), rel=1e-6
    )


def test_a_run_under_a_sine_loses_the_closed_form_and_its_balance_closes() -> None:
    law, frequency, amplitude = TWO.replace(relaxation_time=[0.02, 0.1]), 8.0, 1e-3  # s, Hz, rad
    motion = sw.scenario.sine(amplitude, frequency, 20.0 / frequency)
    still = sw.scenario.constant(0.0, motion.duration)
    run = sw.simulate(rig(material=law), still, 2.5e-4, inputs={"output_angle": motion}, initial=STILL, sample=1.0 / 800.0)
    lost = run["energy_damping"]
    cycle = np.pi * amplitude**2 * law.loss(2.0 * np.pi * frequency)
    assert lost[-1] - lost[-101] == pytest.approx(cycle, rel=1e-6)
    stored = run["stored_spring"]
    gap = -run["energy_load"] - lost - (stored - stored[0])
    assert np.abs(gap).max() < 1e-9 * lost[-1]


def test_a_vibration_is_damped_as_the_standard_linear_solid_damps_it() -> None:
    """Output inertia on spring and one branch, input held: against an independent integration of three equations."""
    law, inertia = GeneralisedMaxwell(stiffness=[400.0], relaxation_time=[0.01]), 0.5
    drive = rig(material=law).replace(load=sw.loads.Inertia(inertia=inertia))
    start = drive.rest().replace(output_speed=0.1)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 1.0), 1e-4, initial=start, sample=1e-2)

    def rates(_: float, x: Array) -> list[float]:
        return [x[1], -(1e3 * x[0] + x[2]) / inertia, 400.0 * x[1] - x[2] / 0.01]

    solution = solve_ivp(rates, (0.0, 1.0), [0.0, 0.1, 0.0], "DOP853", run.time, rtol=1e-12, atol=1e-14)
    assert run["output_angle"] == pytest.approx(solution.y[0], abs=1e-10)


def test_the_linear_view_has_its_poles() -> None:
    """(1 + s tau) (J s^2 + k) + k_1 s tau = 0 with the input held."""
    law = GeneralisedMaxwell(stiffness=[400.0], relaxation_time=[0.01])
    drive = rig(material=law).replace(load=sw.loads.Inertia(inertia=0.5))
    expected = np.roots([0.5 * 0.01, 0.5, (1e3 + 400.0) * 0.01, 1e3])
    poles = sw.linearise(drive, drive.rest()).poles
    moving = poles[np.abs(poles) > 1e-3]  # the input, which nothing holds, has two at 0
    assert np.sort_complex(moving) == pytest.approx(np.sort_complex(expected), rel=1e-9)


def test_time_must_increase_and_be_as_long_as_the_twist() -> None:
    with pytest.raises(ValueError, match=r"time\[1\] = 0 s must lie after the time before it"):
        TWO.trace([0.0, 0.0], [0.0, 1.0])
    with pytest.raises(ValueError, match="time and twist must have the same length"):
        TWO.trace([0.0], [0.0, 1.0])
    with pytest.raises(ValueError, match="stiffness and relaxation_time must have equally many elements"):
        GeneralisedMaxwell(stiffness=[1.0])
