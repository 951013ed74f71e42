"""Winding and gear as they warm up, against the solution of two bodies, and the fixed point of a warm winding."""

from __future__ import annotations

import re

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy.linalg import expm

from tests.support.flywheel import HEAVY, flywheel, turning
from tests.support.geared import RATIO, geared

Array = NDArray[np.float64]
AMBIENT = 293.15
BODY = sw.thermal.Heating(winding_capacity=0.02, winding_resistance=2.5, gear_capacity=0.05, gear_resistance=4.0, coupling=0.3)
LONELY = sw.thermal.Heating(winding_capacity=0.02, winding_resistance=1e30, gear_capacity=0.05, gear_resistance=1e30)
COIL = sw.motor.CurrentSource(torque_constant=0.0, resistance=2.0)  # it warms up, and moves nothing
SPEED = 50.0  # rad/s


def warmed(
    body: sw.thermal.Heating, current: float, viscous: float, duration: float = 1.0, temperature: float = AMBIENT
) -> sw.Recording:
    """Constant losses: R i^2 of the winding, and b omega^2 of the gear, whose input is a flywheel."""
    drive = flywheel(COIL, friction_input=sw.friction.Viscous(viscous=viscous)).replace(thermal=body)
    command = sw.scenario.constant(current, duration)
    return sw.simulate(drive, command, 1e-3, initial=turning(drive, SPEED), temperature=temperature, sample=0.02)


def two_bodies(body: sw.thermal.Heating, heat: tuple[float, float], ambient: float, time: Array) -> Array:
    """Temperatures of winding and gear after constant heat [W], by the exponential of a matrix."""
    g, c_w, c_g = body.coupling, body.winding_capacity, body.gear_capacity
    r_w, r_g = body.winding_resistance, body.gear_resistance
    matrix = np.array(
        [
            [-(1.0 / r_w + g) / c_w, g / c_w, (heat[0] + ambient / r_w) / c_w],
            [g / c_g, -(1.0 / r_g + g) / c_g, (heat[1] + ambient / r_g) / c_g],
            [0.0, 0.0, 0.0],
        ]
    )
    start = [body.initial_temperature, body.initial_temperature, 1.0]
    return np.array([(expm(matrix * t) @ start)[:2] for t in time])


@settings(max_examples=30)  # of a matrix exponential for each sample
@given(
    current=st.floats(-5.0, 5.0),
    viscous=st.floats(0.0, 0.01),
    ambient=st.floats(260.0, 330.0),
    beginning=st.floats(260.0, 330.0),
    coupling=st.floats(0.0, 2.0),
)
def test_constant_losses_warm_both_bodies_as_the_exponential_of_a_matrix_says(
    current: float, viscous: float, ambient: float, beginning: float, coupling: float
) -> None:
    body = BODY.replace(coupling=coupling, initial_temperature=beginning)
    run = warmed(body, current, viscous, temperature=ambient)
    wanted = two_bodies(body, (2.0 * current**2, viscous * SPEED**2), ambient, run.time)
    assert run["winding_temperature"] == pytest.approx(wanted[:, 0], rel=1e-7)
    assert run["temperature"] == pytest.approx(wanted[:, 1], rel=1e-7)


def test_without_exchange_each_body_has_a_time_constant_of_its_own() -> None:
    """By hand: 2 Ohm x (3 A)^2 = 18 W at 2.5 K/W: 45 K in the end, 63.2 % of them after 0.02 J/K x 2.5 K/W = 0.05 s."""
    run = warmed(BODY.replace(coupling=0.0), 3.0, 0.0, duration=1.0)
    at = int(np.searchsorted(run.time, 0.05 - 1e-9))
    assert run.time[at] == pytest.approx(0.06)  # samples are 20 ms apart
    assert run["winding_temperature"][at] - AMBIENT == pytest.approx(45.0 * (1.0 - np.exp(-0.06 / 0.05)), rel=1e-7)
    assert run["winding_temperature"][-1] - AMBIENT == pytest.approx(45.0, rel=1e-7)
    assert run["temperature"] == pytest.approx(AMBIENT, rel=1e-12)


def test_in_the_end_what_is_lost_leaves_through_both_resistances() -> None:
    """Two nodes: (1/R_w + G) x - G y = P_w, (1/R_g + G) y - G x = P_g; by hand 0.7 x - 0.3 y = 18, 0.55 y - 0.3 x = 5."""
    run = warmed(BODY, 3.0, 0.002, duration=3.0)
    wound, geared_ = run["winding_temperature"][-1] - AMBIENT, run["temperature"][-1] - AMBIENT
    determinant = 0.7 * 0.55 - 0.3 * 0.3
    assert wound == pytest.approx((18.0 * 0.55 + 0.3 * 5.0) / determinant, rel=1e-7)
    assert geared_ == pytest.approx((5.0 * 0.7 + 0.3 * 18.0) / determinant, rel=1e-7)


@pytest.mark.parametrize(
    "motor",
    [
        sw.motor.DC(resistance=2.0, torque_constant=0.0, back_emf=0.0, resistance_rise=0.00393),
        sw.motor.DC(resistance=2.0, torque_constant=0.0, back_emf=0.0, inductance=1e-3, resistance_rise=0.00393),
        sw.motor.BrushlessDC(
            resistance=2.0, torque_constant=0.0, inductance=1e-3, supply_voltage=1e3, current_limit=1e3, resistance_rise=0.00393
        ),
    ],
    ids=["dc", "dc with inductance", "brushless_dc"],
)
def test_a_winding_under_voltage_settles_where_its_resistance_has_risen_enough(motor: object) -> None:
    """x = R_w u^2 / (R_0 (1 + alpha x)): a quadratic equation; 12 V at 2 Ohm and 2.5 K/W: 121.75 K, not 180 K."""
    drive = geared(motor=motor, load=sw.loads.Inertia(inertia=0.1)).replace(thermal=BODY.replace(coupling=0.0))
    run = sw.simulate(drive, sw.scenario.constant(12.0, 1.5), 2e-4, sample=0.1)
    alpha, cold = 0.00393, 2.5 * 12.0**2 / 2.0
    rise = (-1.0 + np.sqrt(1.0 + 4.0 * alpha * cold)) / (2.0 * alpha)
    assert rise == pytest.approx(121.75, abs=0.005)
    assert run["winding_temperature"][-1] - AMBIENT == pytest.approx(rise, rel=1e-7)
    assert run["current"][-1] == pytest.approx(6.0 / (1.0 + alpha * rise), rel=1e-7)


def test_a_pmsm_warms_up_by_both_of_its_currents() -> None:
    """3/2 R (i_q^2 + i_d^2) = 1.5 x 0.5 x (3^2 + 2^2) = 9.75 W."""
    motor = sw.motor.PMSM(resistance=0.5, flux_linkage=0.0, direct_current=-2.0)
    drive = geared(motor=motor, load=sw.loads.Inertia(inertia=0.1)).replace(thermal=BODY.replace(coupling=0.0))
    run = sw.simulate(drive, sw.scenario.constant(1.5, 1.0), 2e-4, sample=0.1)
    assert run["current"][-1] == pytest.approx(3.0, rel=1e-9)
    assert run["winding_temperature"][-1] - AMBIENT == pytest.approx(2.5 * 9.75, rel=1e-7)


def test_friction_has_the_temperature_of_the_gear() -> None:
    """C dT/dt = b w^2 exp(-k (T - T_0)) without any loss to the air: exp(k (T - T_0)) = 1 + k b w^2 t / C."""
    fall, viscous = 0.03, 0.004
    law = sw.friction.Thermal(law=sw.friction.Viscous(viscous=viscous), viscous_fall=fall)
    drive = flywheel(COIL, friction_input=law).replace(thermal=LONELY)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 2.0), 1e-3, initial=turning(drive, SPEED), sample=0.05)
    warmer = np.log(1.0 + fall * viscous * SPEED**2 * run.time / 0.05) / fall
    assert warmer[-1] > 80.0
    assert run["temperature"] - AMBIENT == pytest.approx(warmer, rel=1e-8, abs=1e-9)
    assert run["friction_input"] == pytest.approx(viscous * SPEED * np.exp(-fall * warmer), rel=1e-8)


def test_friction_of_all_places_and_damping_warm_the_gear() -> None:
    """A shaft that is turned against the other: power at each place by hand."""
    drive = geared(
        motor=sw.motor.TorqueSource(inertia=HEAVY),
        load=sw.loads.Prescribed(),
        damping=2.0,
        stiffness=sw.stiffness.Linear(k=1e-30),
        friction_input=sw.friction.Viscous(viscous=1e-3),
        friction_mesh=sw.friction.Viscous(viscous=0.3),
        friction_output=sw.friction.Viscous(viscous=0.5),
    ).replace(thermal=LONELY)
    turned = sw.scenario.ramp(1.0, 0.5)
    run = sw.simulate(
        drive, sw.scenario.constant(0.0, 0.5), 1e-3, initial=turning(drive, 40.0), inputs={"output_angle": turned}
    )
    power = 1e-3 * 40.0**2 + 0.3 * (40.0 / RATIO) ** 2 + 0.5 * 1.0**2 + 2.0 * (40.0 / RATIO - 1.0) ** 2
    assert run["temperature"] - AMBIENT == pytest.approx(power / 0.05 * run.time, rel=1e-9, abs=1e-9)


def test_the_area_of_a_loop_of_hysteresis_warms_the_gear() -> None:
    """Steady loops of one Maxwell element: 4 F (X - F/k) a cycle."""
    k, force, amplitude = 1e4, 2.0, 5e-4
    drive = geared(
        motor=sw.motor.TorqueSource(inertia=HEAVY),
        load=sw.loads.Prescribed(),
        damping=0.0,
        stiffness=sw.stiffness.Linear(k=1e3),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[k], breakaway=[force]),
    ).replace(thermal=LONELY)
    turned = sw.scenario.sine(amplitude, 10.0, 0.5)
    command = sw.scenario.constant(0.0, 0.5)
    run = sw.simulate(drive, command, 1e-4, initial=drive.rest(), inputs={"output_angle": turned}, sample=0.05)
    cycle = 4.0 * force * (amplitude - force / k)
    rise = 0.05 * (run["temperature"][8] - run["temperature"][6])  # samples at twice the frequency: one cycle
    assert rise == pytest.approx(cycle, rel=1e-4)


@given(voltage=st.floats(-20.0, 20.0), coupling=st.floats(0.0, 1.0))
def test_without_air_all_that_is_lost_is_in_the_bodies(voltage: float, coupling: float) -> None:
    """C_w dT_w + C_g dT_g = the energy that motor, friction, damping and hysteresis have taken."""
    body = LONELY.replace(coupling=coupling)
    drive = geared(
        motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, resistance_rise=0.00393),
        friction_input=sw.friction.Coulomb(coulomb=0.02),
        friction_mesh=sw.friction.Viscous(viscous=0.2),
        hysteresis=sw.hysteresis.FadingMemory(stiffness=[200.0], forgetting=[500.0]),
    ).replace(thermal=body, meter=sw.meter.EnergyMeter())
    run = sw.simulate(drive, sw.scenario.constant(voltage, 0.1), 1e-4, sample=0.01)
    places = ("motor", "friction_input", "friction_mesh", "friction_output", "damping", "hysteresis")
    lost = sum(run[f"energy_{place}"] for place in places)
    warmth = 0.02 * (run["winding_temperature"] - AMBIENT) + 0.05 * (run["temperature"] - AMBIENT)
    assert warmth == pytest.approx(lost, rel=1e-9, abs=1e-12)


def test_a_run_begins_at_its_initial_temperature_whatever_the_ambient_one() -> None:
    run = warmed(BODY.replace(initial_temperature=320.0, coupling=0.0), 0.0, 0.0, temperature=280.0)
    assert run["temperature"] == pytest.approx(280.0 + 40.0 * np.exp(-run.time / 0.2), rel=1e-8)
    assert run["winding_temperature"] == pytest.approx(280.0 + 40.0 * np.exp(-run.time / 0.05), rel=1e-8)


def test_its_numbers_must_be_given() -> None:
    with pytest.raises(TypeError, match="heating needs winding_capacity, winding_resistance, gear_capacity, gear_resistance"):
        sw.thermal.Heating()


@pytest.mark.parametrize("coupling", [0.0, 30.0])
def test_bodies_that_warm_up_faster_than_a_step_are_refused_with_the_step_that_does(coupling: float) -> None:
    """Time constants of 2 us and less: longer steps would end in numbers out of all bounds."""
    body = sw.thermal.Heating(
        winding_capacity=1e-6, winding_resistance=2.0, gear_capacity=1e-6, gear_resistance=5.0, coupling=coupling
    )
    flows = np.array([[0.5 + coupling, -coupling], [-coupling, 0.2 + coupling]])
    drive = flywheel(COIL, friction_input=sw.friction.Viscous(viscous=0.001)).replace(thermal=body)
    acting = {"initial": turning(drive, SPEED), "sample": 1e-3}
    with pytest.raises(FloatingPointError, match=r"take dt = \S+ s or less") as refused:
        sw.simulate(drive, sw.scenario.constant(2.0, 1e-3), 1e-4, **acting)
    found = re.search(r"take dt = (\S+) s or less", str(refused.value))
    assert found is not None
    assert float(found[1]) * np.linalg.eigvalsh(flows).max() * 1e6 < 2.78
    run = sw.simulate(drive, sw.scenario.constant(2.0, 1e-3), 0.9 * float(found[1]), **acting)
    winding, gear = AMBIENT + np.linalg.solve(flows, [2.0 * 2.0**2, 0.001 * SPEED**2])
    assert run["winding_temperature"][-1] == pytest.approx(winding, rel=1e-9)
    assert run["temperature"][-1] == pytest.approx(gear, rel=1e-9)
