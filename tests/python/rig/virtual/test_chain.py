"""The whole chain: a gear on the virtual rig, photographs, angles, torques, loop, and what is read from it or identified."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.rig import Loop, Masses, Rig, Scene, Step, Value, analyse, printed_gear, simulate_test
from strainwave.rig.reading.measurement import read_test
from strainwave.rig.virtual.loading import load_by_steps
from strainwave.rig.virtual.printed import PEAK_TORQUE, TABLE_2

Array = NDArray[np.float64]
GRAVITY = 9.80665
STATED = Rig(
    "bench",
    "input",
    disk_radius=Value(0.1, 5e-5),
    gravity=Value(GRAVITY, 0.002),
    masses=(Masses(0.1, 9, 3e-6), Masses(0.025, 16, 3e-6)),
    pulley_torque=Value(0.001, 0.0002),
)
SCENE = Scene(size=(240, 180), radius=18.0, distance=120.0, noise=4.0 / 255.0, gradient=0.3)
REGIMES = {
    "positive_unloading": "regression",
    "negative_loading": "softest",
    "negative_unloading": "regression",
    "positive_loading": "softest",
}


def steps(levels: int) -> list[Step]:
    """From +0.36 N.m to -0.36 N.m and back, in so many equal steps each way."""
    down = np.linspace(PEAK_TORQUE, -PEAK_TORQUE, levels + 1) / (GRAVITY * 0.1)
    return [Step(n, max(mass, 0.0), max(-mass, 0.0)) for n, mass in enumerate((*down, *down[-2::-1]), 1)]


def true_rig(random: np.random.Generator) -> Rig:
    """A rig as it may be, if the stated one is right about its uncertainties."""
    numbers = ("disk_radius", "gravity", "pulley_torque")
    stated = {name: getattr(STATED, name) for name in numbers}
    return replace(STATED, **{name: Value(each.value + each.sigma * random.standard_normal()) for name, each in stated.items()})


def measured(folder: Path) -> Loop:
    """What photographs, masses and the stated rig in the folder of a test say."""
    (loop,) = read_test(folder).loops
    return loop


# Document T's Table 2


@pytest.mark.slow("rig")
def test_each_row_of_the_table_comes_back_through_its_photographs(tmp_path: Path) -> None:
    """Four stiffnesses and a width of each row: all within three of their stated standard deviations, 90 % in the intervals.

    The table is read as E-T4 has it: the unloading stiffnesses hold throughout, the loading ones in the softest stretch.
    Radius, gravity, pulleys and masses of the rig are off by errors of their uncertainties.
    """
    within, far = [], []
    for position, (*slopes, width) in TABLE_2.items():
        rig = true_rig(np.random.default_rng(position))
        test = simulate_test(
            printed_gear(position), rig, steps(24), folder=tmp_path / str(position), scene=SCENE, stated=STATED,
            mass_errors=True, seed=position,
        )  # fmt: skip
        found = analyse(measured(test.folder))
        assert found.hysteresis is not None
        results = [found.stiffness_by(name, definition) for name, definition in REGIMES.items()]
        for result, printed in zip((*results, found.hysteresis.width), (*slopes, math.radians(width)), strict=True):
            assert result is not None
            within.append(result.low <= printed <= result.high)
            far.append((result.value - printed) / math.hypot(result.random, result.shared))
            assert result.high - result.low < 0.01 * printed
        if position == 0:
            assert found.area is not None
            assert found.area.low <= 0.3063483432 <= found.area.high
            assert math.degrees(found.hysteresis.width.value) == pytest.approx(50.5, abs=0.03)
    assert np.abs(far).max() < 3.0
    assert np.mean(within) >= 0.9


# Identification


FREE = ("stiffness.k", "hysteresis.stiffness", "hysteresis.breakaway")


def random_gear(random: np.random.Generator) -> sw.Gear:
    """A spring with two elements that slip on the way; their torques are some tenths of the peak together."""
    ratio = 100.0
    stiffness = 10.0 ** random.uniform(4.0, 4.5)
    slips = PEAK_TORQUE * ratio / stiffness / 1.3 * np.array([random.uniform(0.1, 0.25), random.uniform(0.4, 0.6)])
    breakaway = PEAK_TORQUE * ratio * random.uniform(0.06, 0.15, 2)
    return sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=ratio),
        stiffness=sw.stiffness.Linear(k=stiffness),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=breakaway / slips, breakaway=breakaway),
    )


def numbers(gear: sw.Gear) -> Array:
    return np.array([gear.stiffness.k, *gear.hysteresis.stiffness, *gear.hysteresis.breakaway])  # type: ignore[union-attr]


def identified(gear: sw.Gear, loop: Loop, random: np.random.Generator) -> Array:
    """How far each number of a gear is found from the truth, in its stated standard deviations, from a start 30 % off."""
    k, *others = numbers(gear) * np.exp(random.uniform(-0.3, 0.3, 5))
    start = gear.replace(
        stiffness=sw.stiffness.Linear(k=k),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=others[:2], breakaway=others[2:]),
    )
    found = sw.fit(start, loop.recording(), FREE)
    sigma = np.array([estimate.sigma for estimate in found.estimates[:5]])
    return np.asarray((numbers(found.gear) - numbers(gear)) / sigma)


@pytest.mark.slow("rig")
def test_random_gears_are_identified_from_their_loops() -> None:
    """40 gears, loops of 73 points with the scatter that photographs give the angle, and that masses give the torque.

    Two hundred numbers: 90 % within two of their standard deviations, and their scatter over these 0.7 to 1.4. That angles
    are noisy and not only torques does no harm: what noise of the angle makes of the torque, the residuals show.
    """
    distances = []
    for seed in range(40):
        random = np.random.default_rng(seed)
        gear = random_gear(random)
        true = load_by_steps(gear, replace(STATED, pulley_torque=Value(0.0)), steps(36))
        noisy = true.angle + 3e-5 * random.standard_normal(73)
        torque = true.applied + 1e-4 * random.standard_normal(73)
        distances.append(identified(gear, Loop(noisy, torque, side="input", name=str(seed)), random))
    assert np.mean(np.abs(distances) < 2.0) >= 0.9
    assert 0.7 < np.std(distances) < 1.4


@pytest.mark.whole_path("rig")
@pytest.mark.parametrize("seed", [0, 1])
def test_a_random_gear_is_identified_from_its_photographs(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng([5, seed])
    gear = random_gear(random)
    test = simulate_test(gear, STATED, steps(36), folder=tmp_path, scene=SCENE, mass_errors=True, seed=seed)
    distances = identified(gear, measured(test.folder), random)
    assert np.abs(distances).max() < 3.0
    assert np.sqrt(np.mean(distances**2)) < 2.0
