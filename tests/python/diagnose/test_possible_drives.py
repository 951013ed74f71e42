"""The current of an error, separated into reaction and inertia: against closed forms, and against what one load alone gives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.testing import assert_allclose
from strainwave.diagnose.actuator_ramp import ActuatorRamp, wave_generator
from strainwave.diagnose.inversion import displaced, harmonics
from strainwave.diagnose.possible_drives import CurrentPerError, current_per_error, parts_over_load
from strainwave.orders.order_spectrum import order_amplitudes

from tests.support.signature_drive import AMPLITUDE, ORDER, ideal_current, signature_ramp

RAMP = ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=np.pi / 2.0, duration=5.0)
E1 = 20e-6


@pytest.fixture(scope="module")
def parts() -> CurrentPerError:
    return current_per_error(RAMP)


def order_2(ramp: ActuatorRamp, law: Any) -> tuple[complex, float]:
    run = ramp.settled(ramp.with_error(law).run())
    line = order_amplitudes(run, "current", [2.0])
    return complex(line.amplitude[0] * np.exp(1j * line.phase[0])), order_amplitudes(run, "torque", [2.0]).mean


@pytest.mark.parametrize(("load", "printed"), [(0.0, (0.08, 1.2, 0.8)), (20.0, (32.0, 240.0, 80.0))])
def test_the_signature_of_a_held_input_is_that_of_the_closed_form(load: float, printed: tuple[float, ...]) -> None:
    found = current_per_error(signature_ramp(load))
    places = [0, 1, 3]
    per_error = np.array([ideal_current(order, load) for order in ORDER])
    assert_allclose(1e3 * np.abs(per_error) * AMPLITUDE, printed, rtol=0.03)
    assert_allclose(np.abs(found.total[places] / per_error), 1.0, rtol=0.06)  # the loop multiplies by T_c
    inertial = np.abs(found.inertial[places] / [ideal_current(order, 0.0) for order in ORDER])
    assert_allclose(inertial, 1.0, rtol=0.1)  # at order 1 a part of 0.08 mA is separated from 32 mA


@pytest.mark.slow("diagnose")
def test_two_thirds_of_order_2_of_the_tilt_actuator_are_not_from_the_reaction(parts: CurrentPerError) -> None:
    """64.7 mA by J Omega^2 k / (k - J Omega^2) / (N K_t), 82 mA by n T / K_t; a loop multiplies both, and they are phasors."""
    law, _ = wave_generator(RAMP.drive)
    error = float(np.abs(harmonics(displaced(law.replace(combine="max"), (E1, 0.0)))[1]))
    motor: Any = RAMP.drive.motor
    gear: Any = RAMP.drive.gear
    load: Any = RAMP.drive.load
    wanted = load.inertia * (2.0 * RAMP.turning) ** 2
    inertial = wanted / (1.0 - wanted / gear.stiffness.k) / gear.kinematics.ratio / motor.torque_constant
    assert 1e3 * error * inertial == pytest.approx(64.7, abs=0.1)
    assert abs(parts.inertial[1]) == pytest.approx(inertial, rel=0.05)
    assert abs(parts.reaction[1]) == pytest.approx(2.0 * parts.torque / motor.torque_constant, rel=0.05)
    total = [1e3 * error * abs(part[1]) for part in (parts.total, parts.inertial, parts.reaction)]
    assert_allclose(total, [92.0, 66.0, 85.0], atol=1.0)
    simulated, _ = order_2(RAMP.without_noise(), displaced(law.replace(combine="max"), (E1, 0.0)))
    none, _ = order_2(RAMP.without_noise(), displaced(law.replace(combine="max"), (0.0, 0.0)))
    assert 1e3 * abs(simulated - none) == pytest.approx(total[0], rel=0.01)
    wrong = parts.if_all_were_reaction(2.0)
    assert (abs(wrong), np.degrees(np.angle(wrong))) == (pytest.approx(1.08, abs=0.02), pytest.approx(44.0, abs=2.0))
    assert "Taken for reaction alone" in parts.words(2.0, error)


@pytest.mark.slow("diagnose")
def test_two_loads_determine_the_error_though_the_output_inertia_is_not_known(parts: CurrentPerError) -> None:
    law, _ = wave_generator(RAMP.drive)
    error = harmonics(displaced(law, (E1, 0.0)))[1]
    heavier = RAMP.drive.replace({"load.inertia": 0.7})
    ramp = ActuatorRamp.of(heavier, RAMP.stroke, RAMP.duration).without_noise()
    lines, torque = zip(*(order_2(ramp.loaded(load), displaced(law, (E1, 0.0))) for load in (0.0, 15.0)), strict=True)
    found = parts_over_load(lines, torque, [1e-3, 1e-3])
    by_slope = abs(found.per_torque / parts.per_torque[1] / error)
    by_one_load = abs(lines[0] / parts.total[1] / error)
    as_reaction = abs(lines[0] / parts.reaction[1] / error)
    assert by_slope == pytest.approx(1.0, abs=0.02)
    assert by_one_load > 1.04  # with the inertia of the nominal drive
    assert as_reaction > 1.1


def test_a_line_over_the_load_has_the_covariance_of_least_squares() -> None:
    torque, sigma = np.array([0.0, 10.0, 20.0]), np.full(3, 0.01)
    chance = np.random.default_rng(4)
    clean = (0.02 + 0.01j) + (0.001 - 0.004j) * torque
    noise = 0.01 * (chance.standard_normal((4000, 3)) + 1j * chance.standard_normal((4000, 3)))
    found = [parts_over_load(clean + each, torque, sigma) for each in noise]
    constants, slopes = (np.array([getattr(each, name) for each in found]) for name in ("constant", "per_torque"))
    assert_allclose((constants.mean(), slopes.mean()), (0.02 + 0.01j, 0.001 - 0.004j), atol=5e-4)
    assert_allclose((constants.real.std(), slopes.imag.std()), found[0].sigma, rtol=0.05)


def test_one_load_is_refused() -> None:
    with pytest.raises(ValueError, match="two different torques"):
        parts_over_load([0.1, 0.1], [5.0, 5.0], [1e-3, 1e-3])
    with pytest.raises(ValueError, match="series of one length"):
        parts_over_load([0.1, 0.1], [5.0], [1e-3, 1e-3])
