"""What is stated of the uncertainty is what estimates scatter by, whatever the noise."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.statistics.covariance import covariance_of, posterior_of
from strainwave.statistics.residuals import autoregression, correlation_length, spectrum
from strainwave.statistics.scale import ONE_SIGMA, student

Array = NDArray[np.float64]
N = 600
TIME = np.arange(N)
COLUMNS = {  # of linear models: a line, a drive that goes to and fro, a wave within ten samples
    "line": np.column_stack((np.ones(N), TIME / N)),
    "drive": np.column_stack(
        (np.ones(N), np.sin(TIME / 19.0), np.where(np.sin(TIME / 19.0) > 0.0, 1.0, -1.0), np.cos(TIME / 19.0))
    ),
    "wave": np.column_stack((np.ones(N), np.sin(0.63 * TIME), np.cos(0.63 * TIME))),
}


def coloured(random: np.random.Generator, by: float) -> Array:
    """Noise of variance 1 that an autoregression of first order makes."""
    from scipy.signal import lfilter

    return np.asarray(np.sqrt(1.0 - by**2) * lfilter([1.0], [1.0, -by], random.normal(size=N + 400))[400:])


def periodic(random: np.random.Generator) -> Array:
    """What a model leaves that knows no ripple, beside noise: of any period, but none of those of the columns."""
    wave = np.sqrt(2.0) * np.sin(random.uniform(0.15, 0.4) * TIME + random.uniform(0.0, 6.3))
    return np.asarray(wave + 0.5 * coloured(random, 0.8))


NOISE = {
    "white": lambda random: random.normal(size=N),
    "coloured": lambda random: coloured(random, 0.95),
    "periodic": periodic,
}


@pytest.mark.parametrize("columns", COLUMNS.values(), ids=COLUMNS)
@pytest.mark.parametrize("noise", ["white", "coloured"])
def test_scatter_is_as_stated_and_intervals_hold_the_truth(columns: Array, noise: str) -> None:
    scatter, sigma, held = _calibration(columns, noise)
    assert np.all((scatter / sigma > 0.7) & (scatter / sigma < 1.4))
    assert np.all(held > 0.86)  # 0.90 less what 160 draws scatter by


@pytest.mark.parametrize("columns", COLUMNS.values(), ids=COLUMNS)
def test_what_repeats_itself_does_not_make_estimates_look_surer_than_they_are(columns: Array) -> None:
    scatter, sigma, held = _calibration(columns, "periodic")
    assert np.all(scatter / sigma < 1.4)
    assert np.all(held > 0.86)


def _calibration(columns: Array, noise: str) -> tuple[Array, Array, Array]:
    """Scatter of estimates, median of their sigma, and share of the 95 % intervals that hold the truth."""
    errors, sigmas, held = [], [], []
    for seed in range(160):
        measured = NOISE[noise](np.random.default_rng(seed))
        found = np.linalg.lstsq(columns, measured, rcond=None)[0]
        covariance, freedom = posterior_of(columns, [(measured - columns @ found)[np.newaxis]], np.zeros((0, len(found))))
        errors.append(found)
        sigmas.append(np.sqrt(np.diag(covariance)))
        wide = np.array([student(0.95, each) / student(ONE_SIGMA, each) for each in freedom])
        held.append(np.abs(found) < wide * sigmas[-1])
    return np.std(errors, axis=0), np.median(sigmas, axis=0), np.mean(held, axis=0)


def test_white_noise_has_the_covariance_of_the_textbook() -> None:
    columns = COLUMNS["wave"]
    noise = np.random.default_rng(0).normal(size=N)
    residual = noise - columns @ np.linalg.lstsq(columns, noise, rcond=None)[0]
    covariance, freedom = covariance_of(columns, residual[np.newaxis])
    exact = float(residual @ residual) / (N - 3) * np.linalg.inv(columns.T @ columns)
    assert np.sqrt(np.diag(covariance)) == pytest.approx(np.sqrt(np.diag(exact)), rel=0.08)
    assert freedom > 100.0


def test_channels_that_err_together_tell_no_more_than_one() -> None:
    """The same noise in two channels of the same motion: two copies are as sure as one."""
    columns = COLUMNS["line"]
    noise = np.random.default_rng(1).normal(size=N)
    residual = noise - columns @ np.linalg.lstsq(columns, noise, rcond=None)[0]
    one, _ = covariance_of(columns, residual[np.newaxis])
    two, _ = covariance_of(np.tile(columns, (2, 1)), np.stack((residual, residual)))
    assert np.sqrt(np.diag(two)) == pytest.approx(np.sqrt(np.diag(one)), rel=0.15)


def test_the_spectrum_of_an_autoregression_is_that_of_its_formula() -> None:
    series = coloured(np.random.default_rng(2), 0.9)
    by = -autoregression(series)[1]
    assert by == pytest.approx(0.9, abs=0.05)
    assert len(autoregression(series)) == 2
    frequency = np.arange(N + 1) / (2 * N)
    exact = (1.0 - by**2) / (1.0 - 2.0 * by * np.cos(2.0 * np.pi * frequency) + by**2)
    assert spectrum(series, 2 * N) == pytest.approx(exact, rel=1e-6)
    assert spectrum(series, 2 * N)[0] == pytest.approx((1.0 + by) / (1.0 - by), rel=1e-6)


def test_samples_hang_together_as_long_as_their_autoregression_says() -> None:
    lengths = [correlation_length(coloured(np.random.default_rng(seed), 0.8)) for seed in range(40)]
    assert np.median(lengths) == pytest.approx(9.0, rel=0.2)  # (1 + 0.8) / (1 - 0.8)
    white = [correlation_length(np.random.default_rng(seed).normal(size=N)) for seed in range(40)]
    assert np.median(white) == 1.0


@pytest.mark.slow("identification")
def test_a_long_record_that_drifts_does_not_drown_a_short_table() -> None:
    """3000 samples that hang together by hundreds tell as little as a dozen: the table tells more."""
    from scipy.signal import lfilter

    speed, short = np.linspace(1.0, 60.0, 3000), np.linspace(1.0, 60.0, 26)
    errors = []
    for seed in range(40):
        random = np.random.default_rng(seed)
        drift = 3e-3 * np.sqrt(1.0 - 0.995**2) * lfilter([1.0], [1.0, -0.995], random.normal(size=6000))[3000:]
        log = FrictionTable(speed, LAW.steady(speed) + drift)
        table = FrictionTable(short, LAW.steady(short) + 1e-3 * random.normal(size=26))
        found = [sw.fit(START, records, FREE).estimates[0].value - LAW.coulomb for records in ([log, table], table, log)]
        errors.append(found)
    both, by_table, by_log = np.abs(errors).T
    assert np.median(both) < 1.3 * np.median(by_table)
    assert np.sqrt(np.mean(both**2)) < 0.5 * np.sqrt(np.mean(by_log**2))


LAW = sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4)
FREE = ["friction_input.coulomb", "friction_input.viscous"]
START = sw.Gear(friction_input=LAW.replace(coulomb=0.1, viscous=1e-5))
SPEED = np.linspace(1.0, 60.0, 200)


def spoilt(seed: int, share: float = 0.02) -> sw.Recording:
    """A table of which some samples are outliers, a hundred times as large as the noise and all to the same side."""
    random = np.random.default_rng(seed)
    noise = 1e-4 * random.normal(size=len(SPEED)) + 1e-2 * (random.random(len(SPEED)) < share)
    return sw.Recording({"speed": SPEED, "torque": LAW.steady(SPEED) + noise}, {"speed": "rad/s", "torque": "N.m"})


@pytest.mark.slow("identification")
def test_soft_loss_is_all_but_as_sure_as_without_outliers_and_knows_it() -> None:
    truth = np.array([LAW.coulomb, LAW.viscous])
    found = [sw.fit(START, spoilt(seed), FREE, loss="soft_l1") for seed in range(50)]
    values = np.array([[each.value for each in one.estimates] for one in found])
    sigmas = np.array([[each.sigma for each in one.estimates] for one in found])
    clean = np.array([[each.value for each in sw.fit(START, spoilt(seed, 0.0), FREE).estimates] for seed in range(50)])
    assert np.all(np.sqrt(np.mean((values - truth) ** 2, axis=0)) < 1.4 * np.std(clean, axis=0))
    ratio = np.std(values, axis=0) / np.median(sigmas, axis=0)
    assert np.all((ratio > 0.7) & (ratio < 1.4))
    strict = np.array([[each.value for each in sw.fit(START, spoilt(seed), FREE).estimates] for seed in range(20)])
    assert np.all(np.sqrt(np.mean((strict - truth) ** 2, axis=0)) > 5.0 * np.std(clean, axis=0) * [1.0, 0.5])


@pytest.mark.slow("identification")
def test_soft_loss_without_outliers_is_nearly_as_good_as_squares() -> None:
    pairs = [
        [sw.fit(START, spoilt(seed, 0.0), FREE, loss=loss).estimates[0] for loss in ("linear", "soft_l1")] for seed in range(40)
    ]
    scatter = np.std([[each.value for each in pair] for pair in pairs], axis=0)
    assert scatter[1] < 1.15 * scatter[0]
    assert np.median([pair[1].sigma for pair in pairs]) == pytest.approx(scatter[1], rel=0.25)
