"""Torsion loops of one amplitude: their area, and ways that are too short."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.experiments.loss_loop import LossLoop


def ellipse(samples: int) -> sw.Recording:
    """Two cycles from the right end: the torque of 2 N.m leads by a quarter of a period, and a spring is beside it."""
    turned = 2.0 * np.pi * np.arange(2 * samples + 1) / samples
    twist, torque = 1e-3 * np.cos(turned), 50.0 * np.cos(turned) - 2.0 * np.sin(turned)
    return sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"})


@pytest.mark.parametrize(("samples", "tolerance"), [(1000, 1e-3), (50, 0.05)])
def test_the_area_is_the_work_of_one_cycle(samples: int, tolerance: float) -> None:
    loop = LossLoop.of(ellipse(samples), sw.load("hfuc-25-100"))
    assert loop.area == pytest.approx(np.pi * 1e-3 * 2.0, rel=tolerance)


def test_few_samples_between_the_reversals_are_refused() -> None:
    loop = LossLoop.of(ellipse(22), sw.load("hfuc-25-100"))
    with pytest.raises(ValueError, match="needs ways up and down of at least 10 samples each, between its reversals"):
        loop.apart(0.3)
