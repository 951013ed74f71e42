"""Lines of faults in the motor current of a joint under load, against closed forms of an ideal speed loop.

A wave A sin(n theta) of kinematic error acts on the input with T n A, a wave a sin(n theta) of stiffness with the change of the
energy T^2 / (2 k) at constant torque, T^2 n a / (2 k); the motor balances both by a current, over its torque constant.
"""

from __future__ import annotations

from typing import Any

import pytest
import strainwave as sw

from tests.fault.by_hand import REVERSING, waves

SPRING, CONSTANT, LOAD, SPEED = 8000.0, 0.05, 20.0, 10.0  # N.m/rad, N.m/A, N.m, rad/s of the input
TURNS = 55  # which separate orders 2 and 2.02
HEALTHY = sw.Drive(
    gear=sw.Gear(
        kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline"),
        stiffness=sw.stiffness.Linear(k=SPRING),
        damping=4.0,
        friction_input=sw.friction.Coulomb(coulomb=0.05),
    ),
    motor=sw.motor.CurrentSource(torque_constant=CONSTANT, inertia=1.5e-4),
    control=sw.control.PI(proportional=10.0, integral=100.0, limit=40.0),
    load=sw.loads.Inertia(inertia=0.05),
)


def lines(fault: Any, orders: list[float], load: float = LOAD) -> list[float]:
    """Amplitudes [A] in the current at constant speed, once the load has settled."""
    duration = 2.0 + TURNS * 6.2832 / SPEED
    run = sw.simulate(
        sw.dataset.with_faults(HEALTHY, [fault]), sw.scenario.constant(-SPEED / 100.0, duration), load_torque=load
    )
    return [float(each) for each in sw.orders.order_amplitudes(run.between(1.0, duration), "current", orders).amplitude]


def test_worn_teeth_show_by_the_reaction_of_the_error_on_the_input() -> None:
    at_order, beside = lines(sw.fault.ToothWear(play=0.0, amplitude=3e-4), [2.02, 2.0])
    assert at_order == pytest.approx(LOAD * 2.02 * 3e-4 / CONSTANT, rel=0.02)
    assert beside < 0.05 * at_order


def test_a_crack_shows_by_the_energy_of_the_spring() -> None:
    crack = sw.fault.FlexsplineCrack(depth=0.05, waves=2)
    (_, mean, _), *pulse = waves(crack, REVERSING, "gear.stiffness_variation")
    found = lines(crack, [order for order, *_ in pulse])
    for (order, amplitude, _), line in zip(pulse, found, strict=True):
        assert line == pytest.approx(LOAD**2 * order * amplitude / (2.0 * SPRING * (1.0 - mean) ** 2 * CONSTANT), rel=0.03)


def test_a_bearing_shows_by_the_friction_at_the_input() -> None:
    bearing = sw.fault.WaveGeneratorBearing(friction_depth=0.3, waves=1)
    ((order, _, _),) = waves(bearing, REVERSING, "gear.friction_input")
    (line,) = lines(bearing, [order])
    assert line == pytest.approx(0.3 * 0.05 / CONSTANT, rel=0.02)


@pytest.mark.slow("physics")
@pytest.mark.parametrize(
    ("fault", "order", "power"),
    [
        (sw.fault.ToothWear(play=0.0, amplitude=3e-4), 2.02, 1),
        (sw.fault.FlexsplineCrack(depth=0.05, waves=2), 2.02, 2),
        (sw.fault.WaveGeneratorBearing(friction_depth=0.3, waves=1), 10.41227, 0),
    ],
    ids=lambda each: getattr(each, "name", None),
)
def test_a_line_grows_with_a_power_of_the_load(fault: Any, order: float, power: int) -> None:
    (half,), (whole,) = lines(fault, [order], 20.0), lines(fault, [order], 40.0)
    assert whole / half == pytest.approx(2.0**power, rel=0.01)
