"""Mixed lubrication: its three regimes, its minimum, and that one number tells them all."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from scipy.special import lambertw
from strainwave.friction import MixedLubrication, Stribeck, Thermal

from tests.support.geared import geared
from tests.support.strategies import log_uniform

LAW = MixedLubrication(
    coulomb=0.02, breakaway=0.05, stribeck_speed=5.0, viscous=1e-3, viscosity_fall=0.03, load_sensitivity=0.01
)
speeds = log_uniform(1e-3, 1e3)
temperatures = st.floats(253.15, 373.15)
loads = st.floats(-300.0, 300.0)


@pytest.mark.parametrize(
    ("speed", "load", "temperature", "torque"),
    [  # the documented equation, worked out in decimals of 40 digits
        (5.0, 0.0, 293.15, 0.036036383235143269647866),
        (5.0, 50.0, 293.15, 0.063853117479347956201318),
        (20.0, -50.0, 313.15, 0.046261044386423192321381),
        (-20.0, 120.0, 273.15, -0.080443505555059360463429),
        (100.0, 0.0, 333.15, 0.050119421191220214886038),
    ],
)
def test_numbers_at_high_precision(speed: float, load: float, temperature: float, torque: float) -> None:
    assert LAW.steady(speed, load=load, temperature=temperature) == pytest.approx(torque, rel=1e-14)


@given(loads, temperatures)
def test_slow_motion_is_boundary_friction(load: float, temperature: float) -> None:
    """Metal on metal: the static level, in proportion to the load on the bearing, whatever the oil."""
    assert LAW.steady(1e-9, load=load, temperature=temperature) == pytest.approx(0.05 * (1.0 + 0.01 * abs(load)), rel=1e-9)
    assert LAW.hold(1.0, load=load, temperature=temperature) == pytest.approx(0.05 * (1.0 + 0.01 * abs(load)), rel=1e-14)


@given(loads, temperatures)
def test_fast_motion_is_a_full_film(load: float, temperature: float) -> None:
    """Of the excess nothing is left; the slope is the viscosity, whatever the load (Petroff's bearing)."""
    viscosity = np.exp(-0.03 * (temperature - 293.15))
    fast = 50.0 * 5.0 * (1.0 + 0.01 * abs(load)) / viscosity  # a Hersey number of 50
    slope = (
        LAW.steady(2.0 * fast, load=load, temperature=temperature) - LAW.steady(fast, load=load, temperature=temperature)
    ) / fast
    assert slope == pytest.approx(1e-3 * viscosity, rel=1e-9)
    film = LAW.steady(fast, load=load, temperature=temperature) - 1e-3 * viscosity * fast
    assert film == pytest.approx(0.02 * (1.0 + 0.01 * abs(load)), rel=1e-9)


@given(speed=speeds, load=loads, temperature=temperatures)
def test_friction_per_load_depends_on_viscosity_times_speed_per_load_alone(
    speed: float, load: float, temperature: float
) -> None:
    """Stribeck's curves fall on one: the bearing at T_0 without load, at the speed of the same Hersey number."""
    pressed, viscosity = 1.0 + 0.01 * abs(load), np.exp(-0.03 * (temperature - 293.15))
    same = viscosity * speed / pressed
    assert LAW.steady(speed, load=load, temperature=temperature) / pressed == pytest.approx(LAW.steady(same), rel=1e-12)


@given(load=loads, temperature=temperatures, viscous=log_uniform(1e-4, 4e-3))
def test_friction_is_least_at_one_hersey_number(load: float, temperature: float, viscous: float) -> None:
    """(F_c + (F_s - F_c) exp(-h^2) + b v_s h)' = 0: -2 h^2 exp(-2 h^2) = -(b v_s / (F_s - F_c))^2 / 2, Lambert's W_-1."""
    law = LAW.replace(viscous=viscous)
    share = viscous * 5.0 / 0.03
    hersey = np.sqrt(-0.5 * lambertw(-0.5 * share**2, -1).real)
    assert 2.0 * hersey * np.exp(-(hersey**2)) == pytest.approx(share, rel=1e-9)
    least = hersey * 5.0 * (1.0 + 0.01 * abs(load)) * np.exp(0.03 * (temperature - 293.15))
    around = law.steady(least * np.array([0.99, 1.0, 1.01]), load=load, temperature=temperature)
    assert around[1] < min(around[0], around[2])
    slope = np.diff(law.steady(least * np.array([1.0 - 1e-5, 1.0 + 1e-5]), load=load, temperature=temperature))[0]
    assert abs(slope) < 1e-7 * around[1]


@given(speed=speeds, temperature=temperatures)
def test_the_viscosity_falls_by_the_same_share_for_each_kelvin(speed: float, temperature: float) -> None:
    """Without dry friction nothing but the viscous part is left."""
    law = LAW.replace(coulomb=0.0, breakaway=0.0)
    colder = law.steady(speed, temperature=temperature)
    assert law.steady(speed, temperature=temperature + 10.0) == pytest.approx(colder * np.exp(-0.3), rel=1e-12)


@given(speed=speeds, temperature=temperatures)
def test_cold_and_without_load_it_is_the_law_of_stribeck(speed: float, temperature: float) -> None:
    plain = Stribeck(coulomb=0.02, breakaway=0.05, stribeck_speed=5.0, viscous=1e-3)
    assert LAW.steady(speed) == pytest.approx(plain.steady(speed), rel=1e-14)
    unmoved = LAW.replace(viscosity_fall=0.0)
    assert unmoved.steady(speed, temperature=temperature) == pytest.approx(plain.steady(speed), rel=1e-14)


def test_warm_oil_lets_dry_friction_last_where_a_thermal_law_does_not() -> None:
    """exp(-1.2) = 0.301: at 5 rad/s the film of a cold bearing carries, that of a warm one does not yet."""
    warm = 333.15
    assert LAW.steady(5.0, temperature=warm) > LAW.steady(5.0)
    assert LAW.steady(100.0, temperature=warm) < LAW.steady(100.0)
    thermal = Thermal(law=Stribeck(coulomb=0.02, breakaway=0.05, stribeck_speed=5.0, viscous=1e-3), viscous_fall=0.03)
    assert all(thermal.steady(speed, temperature=warm) < thermal.steady(speed) for speed in (5.0, 100.0))


@given(speed=speeds, load=loads, temperature=temperatures)
def test_it_never_gives_power(speed: float, load: float, temperature: float) -> None:
    for sense in (1.0, -1.0):
        assert sense * LAW.steady(sense * speed, load=load, temperature=temperature) > 0.0


def test_a_drive_that_loads_its_bearing_breaks_away_at_a_higher_torque() -> None:
    """The input transmits T / 20 and holds 0.05 (1 + 0.01 T / 20): its load turns it back from T = 1 / 0.9995 N.m on."""
    drive = geared(
        motor=sw.motor.TorqueSource(inertia=1e-3), load=sw.loads.Inertia(inertia=0.1), friction_input=LAW, damping=60.0
    )
    for share, moves in ((0.999, False), (1.001, True)):
        most = share / 0.9995
        push = sw.scenario.ramp(most / 2.0, 2.5) - sw.scenario.ramp(most / 2.0, 2.5, start=2.0)
        run = sw.simulate(drive, sw.scenario.constant(0.0, 2.5), 1e-3, load_torque=push)
        assert run["input_speed"].any() == moves


def test_its_three_levels_must_be_given() -> None:
    with pytest.raises(TypeError, match="mixed_lubrication needs coulomb, breakaway, stribeck_speed"):
        MixedLubrication()
