"""A synchronous motor with an uneven phase and with dead time, against its three phases and against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from strainwave import _core
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.run import differentiate
from strainwave.simulation.signals import outputs

from tests.support.flywheel import course, flywheel, instant, settled, turning
from tests.support.geared import geared
from tests.support.side_by_side import side_by_side

Array = NDArray[np.float64]
PMSM = sw.motor.PMSM
FREE = {"supply_voltage": 1e4, "current_limit": 1e4}  # no limit acts
SURFACE = PMSM(resistance=0.4, direct_inductance=8e-4, quadrature_inductance=8e-4, flux_linkage=0.012, pole_pairs=5, **FREE)
SALIENT = SURFACE.replace(direct_inductance=6e-4, quadrature_inductance=1.5e-3, direct_current=-4.0)
BOTH = pytest.mark.parametrize("motor", [SURFACE, SALIENT], ids=["surface", "salient"])
FAULTS: dict[str, dict[str, float]] = {
    "uneven phase": {"phase_resistance_excess": 0.3},
    "phase almost open": {"phase_resistance_excess": 30.0},
    "dead time": {"dead_time_voltage": 0.8, "dead_time_current": 0.5},
    "both": {"phase_resistance_excess": 1.0, "dead_time_voltage": 0.5, "dead_time_current": 1.0},
}
PHASES = 2.0 * np.pi / 3.0 * np.arange(3)


# Three phases


def frame(angle: float) -> Array:
    """From values along and across the magnets, shape (2,), to three phases: amplitudes stay amplitudes."""
    return np.stack([np.cos(angle - PHASES), -np.sin(angle - PHASES)], axis=1)


def inverse_frame(angle: float) -> Array:
    return 2.0 / 3.0 * frame(angle).T


def phase_rates(motor: PMSM, voltage: float, speed: float) -> Callable[[float, Array], Array]:
    """Return the rates of three phase currents [A/s] in star without a neutral conductor, by Kirchhoff's laws.

    u_k - w_k - v = R_k i_k + d(L i + psi)_k/dt; the voltage v of the star point keeps the sum of the currents.
    """
    mean, half = 0.5 * (motor.direct_inductance + motor.quadrature_inductance) * 2.0 / 3.0, 1.0 / 3.0
    half *= motor.direct_inductance - motor.quadrature_inductance
    pairs = PHASES[:, None] + PHASES[None, :]
    resistances = motor.resistance + np.array([motor.phase_resistance_excess, 0.0, 0.0])
    w = motor.pole_pairs * speed

    def rate(time: float, current: Array) -> Array:
        angle = w * time
        # Self and mutual inductances of phases whose sum of currents is 0: a constant of all nine would not matter.
        inductance = mean * (np.eye(3) * 1.5 - 0.5) + 2.0 / 3.0 * 1.5 * half * np.cos(2.0 * angle - pairs)
        inductance_rate = -2.0 / 3.0 * 1.5 * half * 2.0 * w * np.sin(2.0 * angle - pairs)
        flux_rate = -motor.flux_linkage * w * np.sin(angle - PHASES)
        across = (inverse_frame(angle) @ current)[1]
        u_d = motor.resistance * motor.direct_current - w * motor.quadrature_inductance * across
        dead = motor.dead_time_voltage * np.clip(current / motor.dead_time_current, -1.0, 1.0)
        driving = frame(angle) @ [u_d, voltage] - dead - resistances * current - inductance_rate @ current - flux_rate
        system = np.block([[inductance, np.ones((3, 1))], [np.ones((1, 3)), np.zeros((1, 1))]])
        return np.linalg.solve(system, np.append(driving, 0.0))[:3]

    return rate


@pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)
@BOTH
def test_its_three_phases_carry_the_same_currents(motor: PMSM, fault: dict[str, float]) -> None:
    faulty, voltage, speed, duration = motor.replace(**fault), 9.0, 120.0, 8e-3
    run = course(faulty, voltage, speed, duration, 2e-6)
    times = run.time[::500]
    solution = solve_ivp(
        phase_rates(faulty, voltage, speed), (0.0, duration), np.zeros(3), "LSODA", times, rtol=1e-9, atol=1e-9, max_step=1e-5
    ).y
    assert np.abs(solution.sum(axis=0)).max() < 1e-7
    wanted = np.array([inverse_frame(faulty.pole_pairs * speed * t) @ i for t, i in zip(times, solution.T, strict=True)])
    assert run["direct_current"][::500] == pytest.approx(wanted[:, 0], abs=2e-5)
    assert run["current"][::500] == pytest.approx(wanted[:, 1], abs=2e-5)
    healthy = course(motor, voltage, speed, duration, 2e-5)
    assert np.abs(healthy["current"][::50] - wanted[:, 1]).max() > 0.1  # the fault matters


# An uneven phase


def test_at_rest_the_uneven_phase_counts_by_the_angle_to_its_axis() -> None:
    """At p theta = 0 the first phase carries no i_q; at a quarter turn it carries all, and R_q = R + 2/3 DR."""
    motor = SURFACE.replace(phase_resistance_excess=0.6, pole_pairs=1)
    drive = flywheel(motor).replace(meter=sw.meter.EnergyMeter())
    for angle, resistance in ((0.0, 0.4), (np.pi / 2.0, 0.4 + 0.4)):
        start = drive.rest().replace(input_angle=angle, transmission_error=0.0)
        end = sw.simulate(drive, sw.scenario.constant(2.0, 0.1), 2e-5, initial=start, sample=0.1)
        assert end["current"][-1] == pytest.approx(2.0 / resistance, rel=1e-9)
        assert end["power_motor"][-1] == pytest.approx(1.5 * 4.0 / resistance, rel=1e-9)


def steady_orders(motor: PMSM, voltage: float, speed: float, name: str) -> Array:
    """Return the complex amplitudes of a signal over one electric turn, by its order, once it has settled."""
    w = motor.pole_pairs * speed
    turns = int(np.ceil(40.0 * 8e-4 / 0.4 * w / (2.0 * np.pi)))
    steps = 2400
    run = course(motor, voltage, speed, (turns + 1) * 2.0 * np.pi / w, 2.0 * np.pi / w / steps)
    spectrum: Array = np.fft.rfft(run[name][-steps - 1 : -1]) / steps
    spectrum[1:] *= 2.0
    return spectrum


def test_a_slightly_uneven_phase_ripples_twice_per_pair_of_poles_as_two_circuits_do() -> None:
    """To first order in DR: v_q = DR/3 (1 - cos 2 phi) i_q and v_d = -DR/3 sin 2 phi i_q drive two circuits R + 2j w L."""
    voltage, speed, excess = 9.0, 120.0, 1e-3
    motor = SURFACE.replace(phase_resistance_excess=excess)
    w, inductance = motor.pole_pairs * speed, motor.quadrature_inductance
    current = (voltage - w * motor.flux_linkage) / motor.resistance
    impedance, driven = motor.resistance + 2j * w * inductance, excess / 3.0 * current
    along = -1j * driven / impedance  # of e^(2j phi); the inverter decouples i_d from i_q
    across = (driven - w * inductance * along) / impedance
    found = {name: steady_orders(motor, voltage, speed, name) for name in ("current", "direct_current")}
    assert abs(found["direct_current"][2]) == pytest.approx(abs(along), rel=2e-3)
    assert abs(found["current"][2]) == pytest.approx(abs(across), rel=2e-3)
    assert found["current"][0].real - current == pytest.approx(-driven / motor.resistance, rel=2e-2)
    assert np.abs(found["current"][[1, 3, 5]]).max() < 1e-6 * abs(across)


def two_phases(motor: PMSM, voltage: float, speed: float, times: Array) -> Array:
    """Return the current [A] from the third phase to the second, if the first is open: one equation of one loop."""
    w, out = motor.pole_pairs * speed, np.array([0.0, 1.0, -1.0])

    def rate(time: float, current: Array) -> Array:
        angle = w * time
        phases = out * current[0]
        across = (inverse_frame(angle) @ phases)[1]
        u_d = motor.resistance * motor.direct_current - w * motor.quadrature_inductance * across
        induced = -motor.flux_linkage * w * np.sin(angle - PHASES)
        loop = out @ (frame(angle) @ [u_d, voltage] - induced - motor.resistance * phases)
        return np.array([loop / (2.0 * motor.quadrature_inductance)])  # without saliency each phase has L

    solution: Array = solve_ivp(rate, (0.0, times[-1]), [0.0], "LSODA", times, rtol=1e-10, atol=1e-10).y[0]
    return solution


def test_a_very_large_excess_approaches_an_open_phase_in_inverse_proportion() -> None:
    voltage, speed, duration = 9.0, 120.0, 8e-3

    def gap(excess: float, dt: float) -> float:
        run = course(SURFACE.replace(phase_resistance_excess=excess), voltage, speed, duration, dt)
        every = round(1e-4 / dt)
        wanted = two_phases(SURFACE, voltage, speed, run.time[::every])
        turns = SURFACE.pole_pairs * speed * run.time[::every]
        phases = np.array(
            [frame(a) @ [d, q] for a, d, q in zip(turns, run["direct_current"][::every], run["current"][::every], strict=True)]
        )
        return float(np.abs(phases[:, 1] - wanted).max() / np.abs(wanted).max())

    gaps = [gap(40.0, 1e-5), gap(160.0, 2.5e-6)]
    assert gaps[1] < 1e-2
    assert gaps[0] / gaps[1] == pytest.approx(4.0, rel=0.15)


# Dead time


def drop_over_a_turn(motor: PMSM, across: float, count: int) -> Array:
    """Return the voltages [V] along and across that the fault takes at `count` angles of an electric turn, shape (2, count)."""
    names = {"motor.direct_current": 0.0, "motor.quadrature_current": across}
    drops = []
    for angle in (np.arange(count) + 0.5) * 2.0 * np.pi / count:
        rates = []
        for one in (motor, motor.replace(dead_time_voltage=0.0, phase_resistance_excess=0.0)):
            drive = geared(motor=one, load=sw.loads.Inertia(inertia=0.1), damping=0.0)
            at = {"input_angle": angle / motor.pole_pairs, "transmission_error": 0.0}
            rates.append(instant(drive, turning(drive, 0.0, names | at))[0])
        drops.append(
            [
                inductance * (rates[1][name] - rates[0][name])
                for name, inductance in zip(names, (motor.direct_inductance, motor.quadrature_inductance), strict=True)
            ]
        )
    return np.array(drops).T


def test_dead_time_takes_the_harmonics_of_a_square_wave() -> None:
    """4 V / pi (1 + 2/35 cos 6 phi + ...) against the current and 4 V / pi 12/35 sin 6 phi aside: of 1, 1/5 and 1/7."""
    volts, count = 0.7, 720
    motor = SURFACE.replace(dead_time_voltage=volts, dead_time_current=1e-6)
    along, across = (np.fft.rfft(drop) / count for drop in drop_over_a_turn(motor, 5.0, count))
    fundamental = 4.0 / np.pi * volts
    assert across[0].real == pytest.approx(fundamental, rel=1e-4)
    assert 2.0 * abs(across[6]) == pytest.approx(fundamental * (1.0 / 5.0 - 1.0 / 7.0), rel=2e-3)
    assert 2.0 * abs(along[6]) == pytest.approx(fundamental * (1.0 / 5.0 + 1.0 / 7.0), rel=2e-3)
    assert 2.0 * abs(across[12]) == pytest.approx(fundamental * (1.0 / 11.0 - 1.0 / 13.0), rel=1e-2)
    others = np.arange(count // 2 + 1) % 6 != 0
    assert max(np.abs(across[others]).max(), np.abs(along[others]).max()) < 1e-12


def test_below_its_current_dead_time_is_a_resistance() -> None:
    motor = SURFACE.replace(dead_time_voltage=0.8, dead_time_current=4.0)
    along, across = drop_over_a_turn(motor, 3.0, 12)
    assert across == pytest.approx(0.8 / 4.0 * 3.0, rel=1e-12)
    assert along == pytest.approx(0.0, abs=1e-12)
    shown = settled(motor, 2.0, 0.0)
    assert shown["current"] == pytest.approx(2.0 / (0.4 + 0.8 / 4.0), rel=1e-9)


def test_dead_time_takes_no_energy_and_an_uneven_phase_does() -> None:
    """The first loses DR i_1^2 more; with the other the inverter gives sum V |i_k| less."""
    numbers = {"motor.direct_current": -2.0, "motor.quadrature_current": 5.0, "input_angle": 0.11, "transmission_error": 0.0}
    phases = frame(5 * 0.11) @ [-2.0, 5.0]

    def powers(motor: PMSM) -> Array:
        drive = geared(motor=motor, load=sw.loads.Inertia(inertia=0.1), damping=0.0).replace(meter=sw.meter.EnergyMeter())
        shown = instant(drive, turning(drive, 30.0, numbers), 4.0)[1]
        return np.array([shown["power_supplied"], shown["power_motor"]])

    healthy = powers(SURFACE)
    uneven = powers(SURFACE.replace(phase_resistance_excess=0.3)) - healthy
    assert uneven == pytest.approx([0.0, 0.3 * phases[0] ** 2], rel=1e-11, abs=1e-11)
    dead = powers(SURFACE.replace(dead_time_voltage=0.7, dead_time_current=0.01)) - healthy
    assert dead == pytest.approx([-0.7 * np.abs(phases).sum(), 0.0], rel=1e-11, abs=1e-11)


# Limits, steps and energy

LIMITED = {"supply_voltage": 40.0, "current_limit": 12.0}


@pytest.mark.slow("physics")
@given(excess=st.floats(0.0, 0.8), volts=st.floats(0.0, 2.0))
def test_an_inverter_that_measures_the_current_reaches_its_limit_in_spite_of_faults(excess: float, volts: float) -> None:
    """At a quarter turn of the first phase, where v_d = 0: more voltage is needed for the same current."""
    motor = SURFACE.replace(phase_resistance_excess=excess, dead_time_voltage=volts, pole_pairs=1, **LIMITED)
    drive = flywheel(motor)
    start = drive.rest().replace(input_angle=np.pi / 2.0, transmission_error=0.0)
    run = sw.simulate(drive, sw.scenario.constant(1e3, 0.1), 2e-5, initial=start, sample=1e-3)
    assert run["current"][-1] == pytest.approx(12.0, rel=1e-9)
    assert run["voltage"][-1] == pytest.approx((0.4 + 2.0 / 3.0 * excess) * 12.0 + 4.0 / 3.0 * volts, rel=1e-9)


def test_steps_too_coarse_for_an_almost_open_phase_are_refused() -> None:
    """2/3 DR / L = 8.3e5 1/s, of which Runge and Kutta's scheme bears 2.5 a step: 3 microseconds."""
    drive = geared(motor=SURFACE.replace(phase_resistance_excess=1e3), load=sw.loads.Inertia(inertia=0.1))
    with pytest.raises(FloatingPointError, match=r"too coarse .* a fault of its motor .* take dt = 3e-06 s or less"):
        sw.simulate(drive, sw.scenario.constant(1.0, 0.01), 1e-5)
    assert _core.max_rate(drive, 0.0, 293.15) == pytest.approx(2.0 / 3.0 * 1e3 / 8e-4 / 2.5, rel=1e-12)


def test_adaptive_steps_follow_an_almost_open_phase() -> None:
    """To what fixed steps give, which are short enough."""
    motor = SURFACE.replace(phase_resistance_excess=300.0)
    drive = flywheel(motor)
    start = turning(drive, 120.0)
    course_ = sw.scenario.constant(9.0, 4e-3)
    adaptive = sw.simulate_adaptively(drive, course_, 1e-9, initial=start, sample=1e-4)
    fixed = sw.simulate(drive, course_, 1e-6, initial=start, sample=1e-4)
    assert adaptive["current"] == pytest.approx(fixed["current"], abs=1e-5)


def test_a_faulty_motor_in_closed_loop_keeps_the_balance_of_its_energy() -> None:
    motor = SALIENT.replace(
        supply_voltage=30.0,
        current_limit=9.0,
        inertia=1e-4,
        cogging_torque=5e-3,
        phase_resistance_excess=0.5,
        dead_time_voltage=0.6,
        dead_time_current=0.3,
    )
    law = sw.control.Cascade(position_gain=30.0, speed_proportional=0.1, speed_integral=1.0, current_proportional=2.0)
    drive = geared(motor=motor, control=law, load=sw.loads.Inertia(inertia=0.2), damping=5.0).replace(
        meter=sw.meter.EnergyMeter()
    )
    run = sw.simulate_adaptively(drive, sw.scenario.step(1.0, 0.3), 1e-9, sample=1e-3)
    assert np.ptp(run["input_angle"]) > 10.0
    stored = run["stored_input"] + run["stored_output"] + run["stored_spring"] + run["stored_motor"]
    taken = run["energy_motor"] + run["energy_damping"] + run["energy_load"]
    gap = run["energy_supplied"] - taken - (stored - stored[0])
    assert np.abs(gap).max() < 1e-8 * np.abs(run["energy_supplied"]).max()


def test_one_trajectory_in_double_and_in_packs_of_healthy_and_faulty_motors() -> None:
    """Bit by bit, also where only some of the drives side by side have a fault."""
    base = geared(motor=SURFACE.replace(inertia=1e-4), load=sw.loads.Inertia(inertia=0.1), damping=5.0)
    motors: list[Any] = [base.motor, *(base.motor.replace(**fault) for fault in list(FAULTS.values()) * 2)]
    drives = [base.replace(motor=motor) for motor in motors]
    command = sw.scenario.sine(6.0, 20.0, 0.05)
    packed = side_by_side(drives, command, 2e-5, sample=1e-3)
    for member, drive in enumerate(drives):
        single = sw.simulate(drive, command, 2e-5, sample=1e-3)
        for name in ("current", "direct_current", "input_angle"):
            assert packed.member(member)[name].tolist() == single[name].tolist()


def test_derivatives_by_the_faults_are_what_differences_show() -> None:
    """From a healthy motor on, too: at 0 a fault is a number like any other."""
    command = sw.scenario.sine(6.0, 20.0, 0.02)
    for healthy in (False, True):
        faults = {
            "phase_resistance_excess": 0.3 * (not healthy),
            "dead_time_voltage": 0.5 * (not healthy),
            "dead_time_current": 0.7,
        }
        motor = SURFACE.replace(inertia=1e-4, **faults)
        drive = geared(motor=motor, load=sw.loads.Inertia(inertia=0.1), damping=5.0)
        for name, value in list(faults.items())[: 2 if healthy else 3]:
            path = [each for each, *_ in _core.parameters(drive)].index(f"motor.{name}")
            run, slopes = differentiate(drive, Excitation(command), [path], 2e-5, 1e-3)
            h = 1e-5
            up, down = (
                sw.simulate(drive.replace(motor=motor.replace(**{name: max(value + d, 0.0)})), command, 2e-5, sample=1e-3)
                for d in (h, -h)
            )
            current = list(outputs(drive)).index("current")
            difference = (up["current"] - down["current"]) / (h if value == 0.0 else 2.0 * h)
            assert slopes[0][current] == pytest.approx(difference, abs=2e-4 * np.abs(difference).max())
            assert np.abs(difference).max() > 0.1
            assert run["current"] == pytest.approx(
                sw.simulate(drive, command, 2e-5, sample=1e-3)["current"], rel=1e-10, abs=1e-12
            )
