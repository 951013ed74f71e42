"""A system that is no drive, through every method and scalar. The truth is piecewise linear: matrix exponentials."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from tests.support.cplusplus import STRICT, compiler

HERE = Path(__file__).parent
INERTIA, STIFFNESS, FRICTION, TORQUE, DURATION = 0.5, 200.0, 0.8, 0.3, 0.6
GRID = 1e-4  # s: events lie further apart


def way(stiffness: float, friction: float, direction: float) -> Callable[[float], Any]:
    """The exact solution over time while the first body slips one way, or sticks: a matrix that acts on the state and 1."""
    matrix = np.zeros((5, 5))
    matrix[1, 3] = 1.0
    matrix[3] = [stiffness / INERTIA, -stiffness / INERTIA, 0.0, 0.0, TORQUE / INERTIA]
    if direction:
        matrix[0, 2] = 1.0
        matrix[2] = [-stiffness / INERTIA, stiffness / INERTIA, 0.0, 0.0, -direction * friction / INERTIA]
    return lambda time: expm(matrix * time)


def truth(stiffness: float = STIFFNESS, friction: float = FRICTION) -> tuple[Any, int]:
    """Angles and speeds at the end, and how many events there were. The body sticks at first, driven beyond what holds it."""
    state, time, events = np.array([0.0, 0.05, 0.0, 0.0, 1.0]), 0.0, 0
    direction = 1.0
    while True:
        exact = way(stiffness, friction, direction)

        def left(t: float, start: Any = state, exact: Any = exact, direction: float = direction) -> float:
            y = exact(t) @ start
            return direction * y[2] if direction else friction - abs(stiffness * (y[1] - y[0]))

        grid = np.arange(GRID, DURATION - time, GRID)
        step = expm_steps(exact(GRID), state, len(grid))
        behind = [
            i for i, y in enumerate(step) if (direction * y[2] if direction else friction - abs(stiffness * (y[1] - y[0]))) < 0
        ]
        if not behind:
            return (exact(DURATION - time) @ state)[:4], events
        moment = brentq(left, max(grid[behind[0]] - GRID, 1e-7), grid[behind[0]], xtol=1e-15)
        state, time, events = exact(moment) @ state, time + moment, events + 1
        state[2] = 0.0
        spring = stiffness * (state[1] - state[0])
        direction = 0.0 if direction and abs(spring) <= friction else float(np.sign(spring))


def expm_steps(matrix: Any, start: Any, count: int) -> list[Any]:
    steps = []
    for _ in range(count):
        start = matrix @ start
        steps.append(start)
    return steps


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    program = tmp_path_factory.mktemp("two_masses") / "two_masses"
    options = (*STRICT, "-O1", "-ffp-contract=off", "-Wno-missing-field-initializers")
    subprocess.run([*compiler("g++"), HERE / "two_masses.cpp", "-o", program, *options], check=True)
    lines = subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()
    return {name: np.array(list(map(float, numbers))) for name, *numbers in map(str.split, lines)}


@cache
def exact_end() -> Any:
    end, events = truth()
    assert events >= 5  # it slips both ways, sticks and breaks away
    return end


# The first three take steps of 0.5 ms; what Moreau and Jean's impulses round at an event is of first order.
@pytest.mark.whole_path("physics")
@pytest.mark.parametrize(
    ("method", "tolerance"), [("exponential", 1e-9), ("rosenbrock", 1e-6), ("adaptive", 1e-8), ("moreau_jean", 2e-3)]
)
def test_every_method_finds_the_exact_solution(runs: dict[str, Any], method: str, tolerance: float) -> None:
    np.testing.assert_allclose(runs[method], exact_end(), rtol=0, atol=tolerance)


@pytest.mark.whole_path("physics")
def test_every_lane_of_a_pack_is_the_run_alone_to_the_last_bit(runs: dict[str, Any]) -> None:
    assert runs["lanes_that_differ"] == 0


@pytest.mark.whole_path("physics")
@pytest.mark.parametrize(("number", "value"), [("stiffness", STIFFNESS), ("friction", FRICTION)])
def test_derivatives_are_those_of_the_exact_solution(runs: dict[str, Any], number: str, value: float) -> None:
    little = 1e-5 * value
    above, below = (truth(**{number: value + sign * little})[0] for sign in (1.0, -1.0))
    np.testing.assert_allclose(runs[f"by_{number}"], (above - below) / (2.0 * little), rtol=1e-5, atol=1e-8)


def test_the_system_is_described_in_forty_lines() -> None:
    lines = (HERE / "two_masses.hpp").read_text().split("template <class S>\n", 1)[1].splitlines()
    assert sum(any(character.isalpha() for character in line) for line in lines) <= 40
