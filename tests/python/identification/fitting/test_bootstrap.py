"""Draws scatter as the theory of linear models says, of white and of coloured noise."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from scipy.signal import lfilter
from strainwave.identification.fitting.bootstrap import bootstrap

LAW = sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4)
FREE = ["friction_input.coulomb", "friction_input.viscous"]
SPEED = np.linspace(1.0, 60.0, 800)
START = sw.Gear(friction_input=LAW)


def table(noise: NDArray[np.float64]) -> sw.Recording:
    return sw.Recording({"speed": SPEED, "torque": LAW.steady(SPEED) + noise}, {"speed": "rad/s", "torque": "N.m"})


@pytest.mark.parametrize("by", [0.0, 0.8])
def test_draws_scatter_as_the_noise_says(by: float) -> None:
    """Exactly: W cov(e) W' with W the pseudo-inverse of the columns, cov(e) that of the autoregression."""
    noise = lfilter([1.0], [1.0, -by], np.random.default_rng(3).normal(size=2000))[-800:] * 1e-3
    drawn = bootstrap(sw.fit(START, table(noise), FREE), 100, seed=1)
    weights = np.linalg.pinv(np.column_stack((np.ones(800), SPEED)))
    lags = np.abs(np.subtract.outer(np.arange(800), np.arange(800)))
    exact = np.sqrt(np.diag(weights @ (1e-6 * by**lags / (1.0 - by**2)) @ weights.T))
    assert drawn.sigma == pytest.approx(exact, rel=0.35)
    low, high = drawn.interval(FREE[0])
    assert high - low == pytest.approx(3.92 * drawn.sigma[0], rel=0.25)
    assert drawn.failed == 0


def test_the_same_seed_draws_the_same_and_progress_is_told() -> None:
    told: list[tuple[str, float]] = []
    found = sw.fit(START, table(1e-3 * np.random.default_rng(0).normal(size=800)), FREE)
    one = bootstrap(found, 20, seed=5, progress=lambda stage, share: told.append((stage, share)))
    assert one == bootstrap(found, 20, seed=5)
    assert one != bootstrap(found, 20, seed=6)
    assert told[:-1] == [("drawing measurements anew", draw / 20) for draw in range(1, 21)]


def test_what_only_a_prior_tells_scatters_as_it_and_what_is_tied_follows() -> None:
    found = sw.fit(
        START.replace(damping=3.0), table(1e-3 * np.random.default_rng(0).normal(size=800)), [*FREE, "damping"],
        priors={"damping": (3.0, 0.1)}, ties={"friction_mesh.viscous": (FREE[1], 2.0)},
    )  # fmt: skip
    drawn = bootstrap(found, 100)
    columns = dict(zip(drawn.paths, drawn.values.T, strict=True))
    assert np.std(columns["damping"]) == pytest.approx(0.1, rel=0.25)
    assert columns["friction_mesh.viscous"] == pytest.approx(2.0 * columns[FREE[1]])


def test_what_makes_no_sense_is_refused() -> None:
    found = sw.fit(START, table(1e-3 * np.random.default_rng(0).normal(size=800)), FREE)
    with pytest.raises(ValueError, match=r"^draws = 3 must be 20 or more$"):
        bootstrap(found, 3)
    with pytest.raises(ValueError, match=r"^draws = 1000000000 must be 100000 or less$"):
        bootstrap(found, 10**9)
    with pytest.raises(ValueError, match=r'^there is no estimate of "damping"; there are friction_input.coulomb'):
        bootstrap(found, 20).interval("damping")
