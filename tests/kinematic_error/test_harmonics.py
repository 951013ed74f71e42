"""Harmonics at two angles together: the bits of each angle alone, and the sum in a closed form."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from strainwave import _core

from tests.support.cplusplus import STRICT, compiler

Array = NDArray[np.float64]
SOURCE = Path(__file__).parent / "harmonics.cpp"
ANGLE_PAIRS = 500
MAX_PAIRED_ANGLE = 1e6  # rad, within which sines of two angles are evaluated together


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if "avx2" not in _core.instruction_sets():
        pytest.skip("this machine has no registers of four numbers")
    built = tmp_path_factory.mktemp("harmonics") / "harmonics"
    subprocess.run([*compiler("g++"), *STRICT, "-O1", "-mavx2", "-ffp-contract=off", str(SOURCE), "-o", str(built)], check=True)
    return built


@pytest.mark.whole_path("physics")
@pytest.mark.parametrize(
    "orders",
    [[2], [1, 2, 3, 4, 5, 6], [2, 4, 31, 32], list(range(1, 17)), [2, 1.98], [2, 202], [0.5], []],
    ids=["one", "all to six", "the highest", "sixteen", "with a broken one", "with one too high", "a broken one", "none"],
)
def test_two_angles_together_have_the_bits_of_each_and_the_closed_form(program: Path, orders: list[float]) -> None:
    random = np.random.default_rng(len(orders))
    amplitude, phase = random.uniform(-1e-3, 1e-3, len(orders)), random.uniform(-4.0, 4.0, len(orders))
    within, turns = random.uniform(-np.pi, np.pi, (ANGLE_PAIRS, 2)), np.round(random.uniform(-100.0, 100.0, (ANGLE_PAIRS, 2)))
    within[0], within[1], within[2] = (0.0, -0.0), (1.0, 10.0 * MAX_PAIRED_ANGLE), (1e300, 1.0)
    law = "\n".join(f"{each[0]:.17g} {each[1]:.17g} {each[2]:.17g}" for each in zip(orders, amplitude, phase, strict=True))
    angles = "\n".join(f"{w[0]:.17g} {t[0]:.17g} {w[1]:.17g} {t[1]:.17g}" for w, t in zip(within, turns, strict=True))
    printed = subprocess.run(
        [program], input=f"{len(orders)}\n{law}\n{angles}\n", capture_output=True, text=True, check=True
    ).stdout
    rows = np.array([line.split() for line in printed.splitlines()], dtype=float)
    assert rows.shape == (ANGLE_PAIRS, 5)
    assert rows[:, 4].all()
    angle = (within + 2.0 * np.pi * turns)[3:, :, None]
    order = np.array(orders, dtype=float)
    value = (amplitude * np.sin(order * angle + phase)).sum(axis=2)
    slope = (order * amplitude * np.cos(order * angle + phase)).sum(axis=2)
    rounding = 1e-12 * max(order.max(initial=1.0), 1.0)  # of an angle of 100 turns, and of the recurrence
    np.testing.assert_allclose(rows[3:, [0, 2]], value, rtol=0.0, atol=rounding * (1e-3 * max(len(orders), 1)))
    np.testing.assert_allclose(rows[3:, [1, 3]], slope, rtol=0.0, atol=rounding * (1e-3 * (abs(order).sum() + 1.0)))
