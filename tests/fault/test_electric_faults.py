"""Faults of the winding, the magnets and the inverter: what they do to a motor, in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw

from tests.support.flywheel import course, settled, torque_of
from tests.support.geared import geared

PMSM = sw.motor.PMSM(
    resistance=0.4,
    direct_inductance=8e-4,
    quadrature_inductance=8e-4,
    flux_linkage=0.012,
    pole_pairs=5,
    supply_voltage=1e4,
    current_limit=1e4,
)
DC = sw.motor.DC(resistance=0.5, inductance=1e-3, torque_constant=0.1, back_emf=0.12)
BRUSHLESS = sw.motor.BrushlessDC(resistance=0.5, torque_constant=0.1, current_limit=1e3, supply_voltage=1e3)
EVERY = pytest.mark.parametrize("motor", [PMSM, DC, BRUSHLESS], ids=["pmsm", "dc", "brushless"])


def faulty(motor: Any, *faults: Any) -> Any:
    return sw.dataset.with_faults(geared(motor=motor, load=sw.loads.Inertia(inertia=0.1)), faults).motor


def orders(motor: Any, voltage: float, speed: float, steps: int = 2400) -> Any:
    """Return amplitudes of the current by its order per electric turn, once it has settled."""
    w = motor.pole_pairs * speed
    turns = int(np.ceil(0.08 * w / (2.0 * np.pi)))
    run = course(motor, voltage, speed, (turns + 1) * 2.0 * np.pi / w, 2.0 * np.pi / w / steps)
    return np.abs(np.fft.rfft(run["current"][-steps - 1 : -1])) / steps * np.append(1.0, np.full(steps // 2, 2.0))


@EVERY
def test_a_resistance_that_has_risen_lets_less_current_flow(motor: Any) -> None:
    one = faulty(motor, sw.fault.PhaseResistance(severity=0.5, rise=0.3))
    assert settled(one, 2.0, 0.0)["current"] == pytest.approx(2.0 / (1.15 * motor.resistance), rel=1e-9)


def test_one_phase_of_more_resistance_ripples_twice_per_pair_of_poles() -> None:
    one = faulty(PMSM, sw.fault.PhaseResistance(severity=0.5, rise=0.0, excess=0.2))
    found = orders(one, 9.0, 120.0)
    assert found[2] > 10.0 * np.delete(found, [0, 2]).max()
    assert orders(PMSM, 9.0, 120.0)[2] < 1e-6 * found[2]


def test_an_open_phase_ripples_by_as_much_as_it_drives() -> None:
    """At low speed i_q ~ cos^2 + sin^2 / (1 + k), k = 2/3 R_o / R: mean and ripple of order 2 are as k + 2 to k."""
    found = orders(faulty(PMSM, sw.fault.OpenPhase()), 3.0, 2.0, 9600)
    k = 2.0 / 3.0 * 20.0 / 0.4
    assert found[2] / found[0] == pytest.approx(k / (k + 2.0), abs=2e-3)


@EVERY
def test_weaker_magnets_give_less_torque_and_let_it_turn_faster(motor: Any) -> None:
    """K and back-EMF fall by s l: at no current the speed is the voltage over the back-EMF."""
    one = faulty(motor, sw.fault.MagnetLoss(severity=0.5, loss=0.4))
    name = "motor.quadrature_current" if motor is PMSM else "motor.current"
    assert torque_of(one, 0.0, {name: 3.0}) == pytest.approx(0.8 * torque_of(motor, 0.0, {name: 3.0}), rel=1e-12)
    back_emf = {"pmsm": 5 * 0.012, "dc": 0.12, "brushless_dc": 0.1}[motor.name]
    assert settled(one, 6.0, 6.0 / (0.8 * back_emf))["current"] == pytest.approx(0.0, abs=1e-9)


@EVERY
def test_cogging_adds_to_that_of_the_motor_at_its_order(motor: Any) -> None:
    one = faulty(motor.replace(cogging_torque=0.01, cogging_order=6), sw.fault.Cogging(severity=0.5, torque=0.04))
    zero = {"motor.quadrature_current": 0.0} if motor is PMSM else {"motor.current": 0.0}
    for angle in (0.1, 0.7, -2.0):
        assert torque_of(one, 0.0, zero, angle=angle) == pytest.approx(0.03 * np.sin(6.0 * angle), abs=1e-12)


def test_a_current_far_above_its_clamp_lacks_the_fundamental_of_the_square_wave() -> None:
    """(U - 4 V / pi) / R at low speed, and a ripple of order 6 alone."""
    one = faulty(PMSM, sw.fault.InverterDeadTime(severity=0.5, voltage=1.0)).replace(dead_time_current=1e-2)
    found = orders(one, 3.0, 2.0, 19200)
    assert found[0] == pytest.approx((3.0 - 2.0 * 5 * 0.012 - 4.0 / np.pi * 0.5) / 0.4, rel=2e-3)
    assert found[6] > 10.0 * found[1:6].max()


@pytest.mark.parametrize(
    ("fault", "motor", "needs"),
    [
        (sw.fault.OpenPhase(), BRUSHLESS, "pmsm"),
        (sw.fault.InverterDeadTime(), DC, "pmsm"),
        (sw.fault.PhaseResistance(excess=0.1), DC, "pmsm"),
        (sw.fault.Cogging(), sw.motor.TorqueSource(), "brushless_dc"),
    ],
)
def test_a_motor_without_such_numbers_is_refused(fault: Any, motor: Any, needs: str) -> None:
    with pytest.raises(ValueError, match=rf"{fault.name} needs a law {needs} at motor, where {motor.name} is"):
        faulty(motor, fault)


def test_a_source_of_torque_has_no_magnets_to_lose() -> None:
    with pytest.raises(ValueError, match="magnet_loss changes nothing of this drive"):
        faulty(sw.motor.TorqueSource(), sw.fault.MagnetLoss())


def test_cogging_of_a_catalogue_actuator_shows_in_its_current() -> None:
    """A brushless motor: no other part of the drive has changed."""
    healthy = sw.load("tilt-actuator")
    drive = sw.dataset.with_faults(healthy, [sw.fault.Cogging(torque=4e-3)])
    assert drive == healthy.replace({"motor.cogging_torque": 4e-3})
    runs = [sw.simulate(one, sw.scenario.ramp(0.2, 0.3))["current"] for one in (drive, healthy)]
    assert np.abs(runs[0] - runs[1]).max() > 1e-2
