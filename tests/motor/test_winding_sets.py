"""A motor of several winding sets, some of which are lost: against the sets written out, and against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.support.flywheel import course, settled, torque_of
from tests.support.geared import geared

FREE = {"supply_voltage": 1e4, "current_limit": 1e4}  # no limit acts
# Numbers of one set.
RESISTANCE, INDUCTANCE, CONSTANT, FLUX, PAIRS = 0.8, 1.6e-3, 0.1, 0.012, 5
BRUSHLESS = sw.motor.BrushlessDC(resistance=RESISTANCE / 2, inductance=INDUCTANCE / 2, torque_constant=CONSTANT, **FREE)
PMSM = sw.motor.PMSM(
    resistance=RESISTANCE / 2,
    direct_inductance=INDUCTANCE / 2,
    quadrature_inductance=INDUCTANCE / 2,
    flux_linkage=FLUX,
    pole_pairs=PAIRS,
    **FREE,
)
SALIENT = PMSM.replace(direct_inductance=6e-4, quadrature_inductance=1.5e-3, direct_current=-4.0)
EVERY = pytest.mark.parametrize("motor", [BRUSHLESS, PMSM], ids=["brushless", "pmsm"])
ONE_OF_TWO = {"open": sw.fault.WindingSetLoss(sets=2), "shorted": sw.fault.WindingSetLoss(sets=2, terminals="shorted")}


def faulty(motor: Any, *faults: Any) -> Any:
    return sw.dataset.with_faults(geared(motor=motor, load=sw.loads.Inertia(inertia=0.1)), faults).motor


@EVERY
@pytest.mark.parametrize("terminals", ["open", "shorted"])
def test_of_two_sets_one_has_its_own_resistance_and_inductance(motor: Any, terminals: str) -> None:
    """The current of the set that drives, written out: u (1 - e^(-R t / L)) / R with the numbers of one set."""
    left = faulty(motor, ONE_OF_TWO[terminals])
    run = course(left, 2.0, 0.0, 0.01, 1e-5)
    rise = 1.0 - np.exp(-run.time * RESISTANCE / INDUCTANCE)
    assert run["current"] == pytest.approx(2.0 / RESISTANCE * rise, rel=1e-9, abs=1e-12)
    healthy = course(motor, 2.0, 0.0, 0.01, 1e-5)
    assert healthy["current"] == pytest.approx(2.0 * run["current"], rel=1e-9, abs=1e-12)


@EVERY
def test_the_torque_per_current_stays_and_the_largest_torque_halves(motor: Any) -> None:
    name = "motor.quadrature_current" if motor is PMSM else "motor.current"
    left = faulty(motor.replace(current_limit=10.0), ONE_OF_TWO["open"])
    per_current = 1.5 * PAIRS * FLUX if motor is PMSM else CONSTANT
    assert torque_of(left, 0.0, {name: 3.0}) == pytest.approx(3.0 * per_current, rel=1e-12)
    assert settled(left, 1e3, 0.0)["current"] == pytest.approx(5.0, rel=1e-9)


@pytest.mark.parametrize("sets", [2, 3, 6])
def test_at_low_speed_a_shorted_set_brakes_as_its_resistance_lets_it(sets: int) -> None:
    """One of n sets has n times the resistance of all: K^2 w / (n R), and of a PMSM 3/2 p^2 psi^2 w / (n R)."""
    fault, speed = sw.fault.WindingSetLoss(sets=sets, terminals="shorted"), 0.01
    brushless, pmsm = faulty(BRUSHLESS, fault), faulty(PMSM, fault)
    whole = RESISTANCE / 2
    assert torque_of(brushless, speed) == pytest.approx(-(CONSTANT**2) * speed / (sets * whole), rel=1e-12)
    # of the impedance of a set, p w L is 4e-5 of n R at this speed
    assert torque_of(pmsm, speed) == pytest.approx(-1.5 * (PAIRS * FLUX) ** 2 * speed / (sets * whole), rel=1e-8)


def test_a_shorted_set_brakes_most_where_its_reactance_is_its_resistance() -> None:
    """There the torque is 3/4 p psi^2 / L of a set, half of what the resistance alone would let through."""
    left = faulty(PMSM, ONE_OF_TWO["shorted"])
    peak = RESISTANCE / INDUCTANCE / PAIRS  # rad/s
    assert torque_of(left, peak) == pytest.approx(-0.75 * PAIRS * FLUX**2 / INDUCTANCE, rel=1e-12)
    assert torque_of(left, 0.9 * peak) > torque_of(left, peak) < torque_of(left, 1.1 * peak)


@given(st.floats(-400.0, 400.0), st.sampled_from([2, 3]))
def test_a_shorted_set_is_a_motor_without_voltage(speed: float, sets: int) -> None:
    """Its steady currents, solved from both equations of a salient set, and their torque."""
    left = faulty(SALIENT, sw.fault.WindingSetLoss(sets=sets, terminals="shorted"))
    resistance, direct, quadrature = (sets * each for each in (RESISTANCE / 2, 6e-4, 1.5e-3))  # of one set
    turns = PAIRS * speed
    along, across = np.linalg.solve([[resistance, -turns * quadrature], [turns * direct, resistance]], [0.0, -turns * FLUX])
    expected = 1.5 * PAIRS * (FLUX + (direct - quadrature) * along) * across
    zero = {"motor.quadrature_current": 0.0, "motor.direct_current": 0.0}
    assert torque_of(left, speed, zero) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@EVERY
def test_a_share_of_a_set_counts_in_proportion(motor: Any) -> None:
    half = faulty(motor, sw.fault.WindingSetLoss(severity=0.5, sets=2, terminals="shorted"))
    whole = faulty(motor, ONE_OF_TWO["shorted"])
    assert torque_of(half, 5.0) == pytest.approx(0.5 * torque_of(whole, 5.0), rel=1e-12)
    assert settled(half, 2.0, 0.0)["current"] == pytest.approx(0.75 * 2.0 / (RESISTANCE / 2), rel=1e-9)


def test_faults_add_up_and_some_sets_must_drive() -> None:
    both = faulty(PMSM, sw.fault.WindingSetLoss(sets=3), sw.fault.WindingSetLoss(sets=3, terminals="shorted"))
    assert (both.open_share, both.shorted_share) == pytest.approx((1.0 / 3.0, 1.0 / 3.0))
    with pytest.raises(ValueError, match=r"open_share \+ shorted_share must be below 0.999: some sets must drive"):
        PMSM.replace(open_share=0.5, shorted_share=0.5)
