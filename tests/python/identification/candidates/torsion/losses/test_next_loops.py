"""Loops that could be measured next."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.identification.candidates.torsion.losses.fit import fit_losses
from strainwave.identification.candidates.torsion.losses.next_loops import options, with_bearing, with_rows

from tests.support.loss_loops import GEAR, RATIO, loss_loop


def test_further_equations_add_their_information() -> None:
    random = np.random.default_rng(0)
    before, rows = random.normal(size=(5, 3)), random.normal(size=(2, 3))
    covariance = np.linalg.inv(before.T @ before)
    assert with_rows(covariance, rows) == pytest.approx(np.linalg.inv(before.T @ before + rows.T @ rows))


def test_loops_at_the_output_leave_the_bearing_to_the_prior_until_one_at_the_input_is_there() -> None:
    measured = fit_losses([loss_loop(reach, at_input=False) for reach in (20.0, 40.0)], GEAR)
    fit = with_bearing(measured, GEAR)
    assert fit.names == ["bearing, dry", *measured.names]
    assert fit.sigma_by_noise()[0] == pytest.approx(1.0)  # of the loss of a cycle
    assert fit.sigma_by_noise()[1:] == pytest.approx(measured.sigma_by_noise())
    after = {loop.ratio: fit.sigma_by_noise(with_rows(fit.covariance, rows))[0] for loop, rows in options(fit, abs(RATIO))}
    assert after[0.0] == pytest.approx(1.0)
    assert after[abs(RATIO)] < 0.1
