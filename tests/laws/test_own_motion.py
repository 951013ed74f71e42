"""How fast a drive is by itself, which steps must follow: against the slopes of its laws and the eigenvalues of its rates."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.analysis.steady import constant_inputs
from strainwave.hysteresis import FrictionalWindup, Preisach, Regimes
from strainwave.kinematic_error import Stochastic
from strainwave.simulation.state import StateLayout

from tests.structure.staged_gear import STRUCTURE

ROTOR, LOAD, RATIO = 1e-4, 0.05, 80.0
SOFT = sw.stiffness.Linear(k=1e-3)  # N.m/rad, nothing beside a hysteresis
LARGE = 0.02  # rad
STABLE = 2.5  # radians of a decay that a step of fourth order bears, with room


def drive_of(**parts: Any) -> sw.Drive:
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=RATIO), **({"input_inertia": 0.0} | parts))
    return sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=ROTOR), load=sw.loads.Inertia(inertia=LOAD))


def stiffness_told(drive: sw.Drive, twist: float) -> float:
    """What the vibration of two masses says of the spring between them, N.m/rad."""
    return float(_core.natural_frequency(drive, twist) ** 2 / (1.0 / LOAD + 1.0 / (RATIO**2 * ROTOR)))


TO_THE_LEFT = Regimes(
    positive_unloading=20.0, negative_loading=3.0, negative_unloading=900.0, positive_loading=2.0, onset=0.1, lost_motion=0.01
)
TO_THE_RIGHT = Regimes(
    positive_unloading=900.0, negative_loading=2.0, negative_unloading=20.0, positive_loading=3.0, onset=0.1, lost_motion=0.01
)
STIFFENING = Preisach(density=sw.hysteresis.PowerDensity(limit=LARGE, saturation=10.0, exponent=3.0))
SPRINGS = sw.stiffness.MultiCompliance(
    flexspline_stiffness=9e3,
    flexspline_hardening=3e-3,
    wave_generator_stiffness=2e4,
    wave_generator_hardening=1e-2,
    reduction=RATIO,
)
HARDENING = FrictionalWindup(springs=SPRINGS, friction=0.02)


@pytest.mark.parametrize(
    "law",
    [TO_THE_LEFT, TO_THE_RIGHT, STIFFENING, HARDENING],
    ids=["stiff to the left", "stiff to the right", "stiffening", "hardening"],
)
def test_a_spring_with_memory_is_as_stiff_as_it_becomes_to_either_side(law: Any) -> None:
    drive = drive_of(stiffness=SOFT, hysteresis=law)
    for twist in (1e-4, 1e-3, LARGE):
        ways = [np.concatenate(([0.0], np.geomspace(1e-12, twist, 2000))) * side for side in (1.0, -1.0)]
        stiffest = max(float(np.max(np.diff(law.trace(way)) / np.diff(way))) for way in ways)
        assert stiffness_told(drive, twist) == pytest.approx(stiffest + SOFT.k, rel=0.01)


def damping_by_noise(drive: sw.Drive, wave_generator: str) -> float:
    """By how much the noise changes the decay of the wave generator's speed, at the most of many angles, at rest [1/s]."""
    layout = StateLayout(drive)
    place = layout.names.index(wave_generator)
    without = drive.replace(gear=drive.gear.replace(kinematic_noise=Stochastic()))
    inputs = constant_inputs(0.0, 0.0, 293.15, 0.0)

    def decay(noisy: sw.Drive, angle: float) -> float:
        state = noisy.rest().replace(**{"input_angle": angle, "input_speed": 1e-9, wave_generator: 1e-9})
        return float(-_core.differentiate_rates(noisy, state.numbers, inputs)[1][place, place])

    angles = np.random.default_rng(5).uniform(-np.pi, np.pi, 200)
    return max(abs(decay(drive, angle) - decay(without, angle)) for angle in angles.tolist())


@pytest.mark.parametrize("of", ["lumped", "staged"])
def test_steps_follow_what_a_random_error_that_grows_with_the_speed_damps(of: str) -> None:
    """It feeds the speed of the wave generator back to its torque; where it is negative this drives instead."""
    noise = Stochastic(amplitude=1e-3, lowest_order=1.0, highest_order=4.0, speed_sensitivity=0.5, seed=3)
    structure = sw.structure.Lumped() if of == "lumped" else STRUCTURE
    drive = drive_of(stiffness=sw.stiffness.Linear(k=2e4), kinematic_noise=noise, structure=structure, input_inertia=2e-5)
    damped = damping_by_noise(drive, "input_speed" if of == "lumped" else "structure.generator_speed")
    told = _core.max_rate(drive, 0.0)
    assert damped < STABLE * told < 6.0 * damped  # four standard deviations are hardly met in a turn
    assert _core.max_rate(drive.replace(gear=drive.gear.replace(kinematic_noise=Stochastic())), 0.0) < 0.5 * told


def test_a_small_random_error_that_grows_with_the_speed_asks_for_no_shorter_steps() -> None:
    plain = drive_of(stiffness=sw.stiffness.Linear(k=2e4))
    noisy = plain.replace(gear=plain.gear.replace(kinematic_noise=Stochastic(amplitude=2e-5, speed_sensitivity=0.01)))
    assert _core.max_rate(noisy, 0.0) < 1.5 * _core.max_rate(plain, 0.0)
