"""Stiffness and hysteresis as they fall with the temperature of the gear, and what becomes of their energy."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core

from tests.support.flywheel import HEAVY
from tests.support.geared import RATIO, K, geared

COLD = 293.15
SOFT = sw.softening.ThermalSoftening(stiffness_fall=3e-3, hysteresis_fall=8e-3)
ELEMENT = sw.hysteresis.MaxwellSlip(stiffness=[2e4], breakaway=[3.0])
temperatures = st.floats(243.15, 393.15)
twists = st.floats(-1e-3, 1e-3)


def rig(softening: sw.softening.ThermalSoftening = SOFT, **parts: object) -> sw.Drive:
    """The input held by a flywheel, the output turned from outside: the twist is what the output is turned by, backwards."""
    drive = geared(
        motor=sw.motor.TorqueSource(inertia=HEAVY), load=sw.loads.Prescribed(), softening=softening, damping=0.0, **parts
    )
    return drive.replace(meter=sw.meter.EnergyMeter())


def turned(
    drive: sw.Drive, angle: sw.scenario.Scenario | float, duration: float, temperature: object, **others: object
) -> sw.Run:
    command = sw.scenario.constant(0.0, duration)
    start = drive.rest()  # its input stays there
    return sw.simulate(drive, command, 1e-4, inputs={"output_angle": angle}, temperature=temperature, initial=start, **others)


@given(temperature=temperatures, twist=twists)
def test_a_spring_is_weaker_by_the_exponential_of_its_warmth(temperature: float, twist: float) -> None:
    run = turned(rig(), -twist, 1e-3, temperature)
    factor = np.exp(-3e-3 * (temperature - COLD))
    assert run["torque"] == pytest.approx(factor * K * twist, rel=1e-12, abs=1e-15)
    assert run["stored_spring"] == pytest.approx(factor * 0.5 * K * twist**2, rel=1e-12, abs=1e-15)


def test_thirty_kelvin_take_a_tenth_of_a_spring() -> None:
    """exp(-0.003 x 30) = 0.9139311852712282."""
    run = turned(rig(), -1e-3, 1e-3, COLD + 30.0)
    assert run["torque"][-1] == pytest.approx(0.9139311852712282 * 10.0, rel=1e-12)


@pytest.mark.parametrize("temperature", [273.15, COLD, 333.15])
def test_loops_of_hysteresis_shrink_with_their_own_rate(temperature: float) -> None:
    """4 F (X - F/k) a cycle, times the factor: stiffness and breakaway fall alike."""
    amplitude = 6e-4
    run = turned(
        rig(hysteresis=ELEMENT), sw.scenario.sine(amplitude, 10.0, 0.3), 0.3, temperature, sample=0.05
    )  # a sample each half period
    area = 4.0 * 3.0 * (amplitude - 3.0 / 2e4) * np.exp(-8e-3 * (temperature - COLD))
    assert run["energy_hysteresis"][5] - run["energy_hysteresis"][3] == pytest.approx(area, rel=1e-4)


def test_spring_and_hysteresis_add_each_with_its_factor() -> None:
    run = turned(rig(hysteresis=ELEMENT), sw.scenario.ramp(-0.1, 0.01), 0.01, COLD + 40.0)
    twist = 0.1 * run.time
    spring, element = K * twist, np.minimum(2e4 * twist, 3.0)
    assert run["torque"] == pytest.approx(np.exp(-0.12) * spring + np.exp(-0.32) * element, rel=1e-9, abs=1e-12)


def test_the_frequency_of_a_gear_falls_with_the_root_of_its_stiffness() -> None:
    warm = 353.15
    drive = geared(motor=sw.motor.TorqueSource(inertia=HEAVY), load=sw.loads.Inertia(inertia=0.05), softening=SOFT, damping=0.0)
    start = drive.rest().replace(transmission_error=1e-4)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.1), 1e-5, initial=start, temperature=warm, sample=1e-3)
    w = np.sqrt(K * np.exp(-3e-3 * (warm - COLD)) / 0.05)
    assert run["twist"] == pytest.approx(1e-4 * np.cos(w * run.time), abs=1e-10)


def test_what_a_wound_up_spring_loses_as_it_warms_up_is_booked() -> None:
    """At constant twist: V_0 (1 - exp(-kappa dT)) turns to heat; as it cools down again it comes back."""
    twist, there = 1e-3, 0.5
    temperature = sw.scenario.constant(COLD, 1.0) + sw.scenario.ramp(80.0, 1.0) - sw.scenario.ramp(160.0, 1.0, start=there)
    run = turned(rig(), -twist, 1.0, temperature)
    warmer = np.where(run.time <= there, 80.0 * run.time, 80.0 * (1.0 - run.time))
    lost = 0.5 * K * twist**2 * (1.0 - np.exp(-3e-3 * warmer))
    assert lost.max() > 5e-4
    assert run["energy_softening"] == pytest.approx(lost, rel=1e-7, abs=1e-12)
    assert run["stored_spring"] + run["energy_softening"] == pytest.approx(0.5 * K * twist**2, rel=1e-10)


@given(rate=st.floats(-100.0, 100.0), speed=st.floats(-0.05, 0.05))
def test_the_work_on_the_shaft_is_stored_or_lost_while_it_warms_up(rate: float, speed: float) -> None:
    """Work that turns the output = energy of the spring + what hysteresis and softening have taken."""
    temperature = sw.scenario.constant(COLD, 0.05) + sw.scenario.ramp(rate, 0.05)
    run = turned(rig(hysteresis=ELEMENT), sw.scenario.ramp(speed, 0.05), 0.05, temperature)
    taken = run["energy_hysteresis"] + run["energy_softening"]
    scale = np.abs(run["stored_spring"]).max() + np.abs(run["energy_hysteresis"]).max()
    assert -run["energy_load"] == pytest.approx(run["stored_spring"] + taken, abs=1e-6 * scale + 1e-15)


@given(temperature=temperatures, twist=twists)
def test_without_rates_it_is_not_there(temperature: float, twist: float) -> None:
    runs = [turned(rig(softening), -twist, 1e-3, temperature) for softening in (sw.softening.ThermalSoftening(), SOFT)]
    assert runs[0]["torque"] == pytest.approx(K * twist, rel=1e-14, abs=1e-18)
    at_reference = turned(rig(SOFT.replace(reference_temperature=temperature)), -twist, 1e-3, temperature)
    assert np.array_equal(at_reference["torque"], runs[0]["torque"])


def test_the_gear_is_as_soft_as_its_own_losses_make_it() -> None:
    """Friction warms the gear without air: the frequency of its spring falls. By hand: 10 W in 0.05 J/K for 0.2 s are 40 K."""
    body = sw.thermal.Heating(winding_capacity=1.0, winding_resistance=1e30, gear_capacity=0.05, gear_resistance=1e30)
    drive = rig(friction_input=sw.friction.Viscous(viscous=4e-3)).replace(thermal=body, meter=sw.meter.NoMeter())
    start = drive.rest().replace(input_speed=50.0)
    follows = sw.scenario.ramp(2.5, 0.2) + sw.scenario.constant(-1e-3, 0.2)  # with the input, but for a twist of 1e-3 rad
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.2), 1e-4, initial=start, inputs={"output_angle": follows})
    assert run["temperature"][-1] - COLD == pytest.approx(40.0, rel=1e-9)
    assert run["torque"] == pytest.approx(K * 1e-3 * np.exp(-3e-3 * 200.0 * run.time), rel=1e-8)


def test_steps_must_follow_a_cold_gear_which_is_stiffer() -> None:
    """w^2 = k (1 / J_out + 1 / (i^2 J_in)); 50 K below, k = e^0.15 K + e^0.4 2e4 N.m/rad. In a run or a body."""
    drive = geared(load=sw.loads.Inertia(inertia=0.5), softening=SOFT, hysteresis=ELEMENT)
    body = sw.thermal.Heating(winding_capacity=100.0, winding_resistance=1.0, gear_capacity=500.0, gear_resistance=1.0)
    mobility = 1.0 / 0.5 + 1.0 / (RATIO**2 * 1e-4)
    for colder in (0.0, 50.0, -50.0):
        stiffness = np.exp(3e-3 * colder) * K + np.exp(8e-3 * colder) * 2e4
        frequency = pytest.approx(np.sqrt(stiffness * mobility), rel=1e-6)
        assert _core.natural_frequency(drive, 0.0, COLD - colder) == frequency
        warmed = drive.replace(thermal=body.replace(initial_temperature=COLD - colder))
        assert _core.natural_frequency(warmed, 0.0) == frequency


def test_an_ensemble_in_the_cold_is_refused_steps_that_would_do_in_the_warmth() -> None:
    drive = geared(load=sw.loads.Inertia(inertia=0.5), softening=SOFT.replace(stiffness_fall=0.02))
    command = sw.scenario.constant(0.0, 0.01)
    longest = 0.9 / _core.max_rate(drive, 0.0)
    assert sw.simulate_many(drive, command, {"gear.damping": [0.0, 1.0]}, longest).failures == {}
    with pytest.warns(sw.simulation.EnsembleWarning, match="2 of 2 members have no result"):
        sw.simulate_many(drive, command, {"gear.damping": [0.0, 1.0]}, longest, temperature=233.15)


def test_derivatives_of_a_warm_drive_are_not_refused_steps_that_would_not_do_in_the_cold() -> None:
    """Neither before the run nor after it: they are those of the run."""
    drive = geared(load=sw.loads.Inertia(inertia=0.5), softening=SOFT.replace(stiffness_fall=0.02))
    warm, command = COLD + 60.0, sw.scenario.constant(0.1, 0.01)
    longest = 0.9 / _core.max_rate(drive, 0.0, warm)
    with pytest.raises(FloatingPointError, match="too coarse"):
        sw.analysis.derivatives(drive, command, ["load.inertia"], longest)
    found = sw.analysis.derivatives(drive, command, ["load.inertia"], longest, temperature=warm)
    run = sw.simulate(drive, command, longest, temperature=warm)
    assert np.array_equal(found.run["twist"], run["twist"])
