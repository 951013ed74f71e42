"""Standard deviations by blocks: those of the fit where the model is right, larger where it changes along the record."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.fitting.blocks import sigma_by_blocks
from strainwave.identification.fitting.fit import fit, solved_problem

LAW = sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=3e-4)


def ratios(change: float) -> NDArray[np.float64]:
    """Of both standard deviations, where viscous friction is larger by this share in the second half than in the first."""
    random = np.random.default_rng(2)
    speed = random.uniform(1.0, 50.0, 600) * random.choice([-1.0, 1.0], 600)
    noise = 1e-4 * random.standard_normal(len(speed))
    torque = LAW.steady(speed) + 3e-4 * np.linspace(-0.5, 0.5, len(speed)) * change * speed + noise
    table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    found = fit(sw.Gear(friction_input=LAW), table, ["friction_input.coulomb", "friction_input.viscous"])
    problem, x = solved_problem(found)
    sigmas: NDArray[np.float64] = sigma_by_blocks(problem, x, found.estimates) / [each.sigma for each in found.estimates]
    return sigmas


def test_where_the_model_is_right_blocks_tell_what_the_fit_does() -> None:
    found = ratios(0.0)
    assert (found >= 1.0).all()
    assert found == pytest.approx(1.0, abs=0.7)  # a deviation by twelve blocks is known to a fifth


def test_where_a_number_changes_along_the_record_blocks_differ_by_more_than_noise_tells() -> None:
    assert ratios(0.3)[1] > 1.5
