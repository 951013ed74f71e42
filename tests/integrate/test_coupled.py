"""A coupled block in steps far longer than its vibration, against SciPy; and the functions of matrices that it stands on."""

from __future__ import annotations

import subprocess
from functools import cache
from math import factorial
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from tests.support.cplusplus import STRICT, compiler

Array = NDArray[np.float64]
HERE = Path(__file__).parent
SIZE, FREQUENCY, DAMPING, PULL = 6, 2e4, 0.01, 0.3
DRIVE, DURATION = 40.0, 0.1  # rad/s, s: two thousand radians of the body's vibration, four of the swing
START = (0.5, 0.4794, 40.0)  # rad, m, m/s


@cache
def program(folder: Path) -> Path:
    built = folder / "coupled"
    subprocess.run([*compiler("g++"), *STRICT, "-O1", str(HERE / "coupled.cpp"), "-o", str(built)], check=True)
    return built


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return program(tmp_path_factory.mktemp("coupled"))


# Functions of matrices


def augmented(z: Array) -> list[Array]:
    """exp Z, phi_1, phi_2, phi_3, as blocks of the exponential of a larger matrix (Sidje 1998, theorem 1)."""
    n = len(z)
    larger = np.zeros((4 * n, 4 * n))
    larger[:n, :n] = z
    for k in range(3):
        larger[k * n : (k + 1) * n, (k + 1) * n : (k + 2) * n] = np.eye(n)
    found = expm(larger)
    return [found[:n, k * n : (k + 1) * n] for k in range(4)]


def found(built: Path, matrices: list[Array]) -> list[list[Array]]:
    """By the headers; that a lane of a pack has the bits that it has alone is checked on the way."""
    text = "\n".join(" ".join(f"{x:.17g}" for x in z.ravel()) for z in matrices)
    lines = subprocess.run([built], input=text, capture_output=True, text=True, check=True).stdout.splitlines()
    assert lines[4::5] == ["0"] * len(matrices)
    rows = [np.array(line.split(), dtype=float).reshape(SIZE, SIZE) for i, line in enumerate(lines) if i % 5 < 4]
    return [rows[4 * i : 4 * i + 4] for i in range(len(matrices))]


def vibrating(seed: int, longest: float) -> Array:
    """Masses on springs, lightly damped: places and speeds, which differ by the frequency squared. `longest` in radians."""
    random = np.random.default_rng(seed)
    root = random.normal(size=(3, 3))
    stiff = root @ root.T
    stiff /= np.abs(np.linalg.eigvalsh(stiff)).max()
    frequency = 10.0 ** random.uniform(2.0, 5.0)
    block = np.block([[np.zeros((3, 3)), np.eye(3)], [-(frequency**2) * stiff, -0.04 * frequency * stiff]])
    return block * longest / frequency


@pytest.mark.whole_path("physics")
@pytest.mark.parametrize("longest", [1e-3, 0.5, 3.0, 30.0, 300.0])
def test_phi_functions_are_those_of_an_augmented_exponential(built: Path, longest: float) -> None:
    """Of vibrations in the units of physics, to 1e-11 of the largest number where places and speeds weigh alike."""
    matrices = [vibrating(seed, longest) for seed in range(8)]
    for z, functions in zip(matrices, found(built, matrices), strict=True):
        unit = np.repeat([1.0, np.sqrt(np.abs(z[3:, :3]).max() / np.abs(z[:3, 3:]).max())], 3)
        for one, known in zip(functions, augmented(unit[:, None] ** -1 * z * unit), strict=True):
            scaled = unit[:, None] ** -1 * one * unit
            assert np.abs(scaled - known).max() < 1e-11 * np.abs(known).max()


@pytest.mark.whole_path("physics")
def test_of_zero_they_are_one_over_the_factorial_and_a_row_of_zeros_stays(built: Path) -> None:
    """What does not move, as a shaft that sticks, must not move by a rounding."""
    resting = vibrating(3, 20.0)
    resting[3] = 0.0
    for function, k in zip(found(built, [np.zeros((SIZE, SIZE))])[0], range(4), strict=True):
        np.testing.assert_allclose(function, np.eye(SIZE) / factorial(k), rtol=1e-15, atol=0.0)
    for function, k in zip(found(built, [resting])[0], range(4), strict=True):
        assert np.all(np.delete(function[3], 3) == 0.0)
        assert function[3, 3] == pytest.approx(1.0 / factorial(k), rel=1e-14)


# Steps


def stepped(
    built: Path, *steps: int, kinked: bool = False, told: bool = True, drive: float = DRIVE, duration: float = DURATION
) -> Array:
    """Angle, place, speed, and the derivative of the angle by the frequency, at the end; a row for each number of steps."""
    words = [str(float(kinked)), str(float(told)), repr(drive), repr(duration), *map(str, steps)]
    run = subprocess.run([built, *words], capture_output=True, text=True, check=True)
    return np.array([line.split() for line in run.stdout.splitlines()], dtype=float)


@cache
def exact(kinked: bool, frequency: float = FREQUENCY) -> Array:
    """By SciPy, from one kink to the next."""

    def rate(_: float, y: Array) -> list[float]:
        end = abs(np.sin(y[0])) if kinked else np.sin(y[0])
        return [DRIVE * (1.0 + PULL * y[1]), y[2], frequency * (frequency * (end - y[1]) - 2.0 * DAMPING * y[2])]

    def kink(_: float, y: Array) -> float:
        return float(np.sin(y[0])) if kinked else 1.0

    kink.terminal = True  # type: ignore[attr-defined]
    y, begin = np.array(START), 0.0
    while begin < DURATION:
        run = solve_ivp(rate, (begin, DURATION), y, "DOP853", rtol=1e-12, atol=1e-13, events=kink, first_step=1e-7)
        y, begin = run.y[:, -1], float(run.t[-1])
        if run.status == 1:
            y, begin = y + 1e-9 * np.array(rate(begin, y)), begin + 1e-9  # past the kink
    return y


@pytest.mark.whole_path("physics")
def test_what_is_linear_is_exact_in_one_step_of_twenty_radians(built: Path) -> None:
    """A free vibration about where the other end stands, by its closed form."""
    duration = 1e-3
    decay, wave = FREQUENCY * DAMPING, FREQUENCY * np.sqrt(1.0 - DAMPING**2)
    off, speed = START[1] - np.sin(START[0]), START[2]
    swing = off * np.cos(wave * duration) + (speed + decay * off) / wave * np.sin(wave * duration)
    for place in stepped(built, 1, 2, 7, drive=0.0, duration=duration)[:, 1]:
        assert place == pytest.approx(np.sin(START[0]) + np.exp(-decay * duration) * swing, abs=1e-14)


@pytest.mark.slow("physics")
def test_steps_of_twenty_radians_follow_what_the_swing_does(built: Path) -> None:
    """Where explicit steps would diverge; it is the body's place, all of a metre, that turns the swing."""
    off = np.abs(stepped(built, 50, 100, 400)[:, 0] - exact(False)[0])
    assert np.all(off < [1e-4, 1e-4, 1e-6])


@pytest.mark.slow("physics")
def test_a_kink_within_a_step_is_found(built: Path) -> None:
    """To step over it is an error of first order."""
    off, over = (np.abs(stepped(built, 400, kinked=True, told=told)[0, 0] - exact(True)[0]) for told in (True, False))
    assert off < 1e-6
    assert over > 10.0 * off


@pytest.mark.slow("physics")
def test_derivatives_by_the_stiffness_are_differences(built: Path) -> None:
    step = 10.0
    more, less = (exact(False, FREQUENCY + change) for change in (step, -step))
    assert stepped(built, 1600)[0, 3] == pytest.approx((more[0] - less[0]) / (2.0 * step), rel=1e-2)
