"""Half widths of loops by sources, and their derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.identification.candidates.torsion.losses.relaxation import Relaxation
from strainwave.identification.candidates.torsion.losses.sources import RELAXING, Curve, Widths, possible_sources
from strainwave.identification.experiments.loss_loop import LossLoop


def test_derivatives_by_fall_and_relaxation_time_are_those_of_differences() -> None:
    loop = LossLoop.planned(100.0, 2e4, 30.0, 1e-4, 310.0)
    model = Widths([*possible_sources(True, True), RELAXING], ["bearing", "oil", "mesh"], 295.0, Relaxation(0.3, 0.5, 1.0))
    widths = model.of_loop(loop, Curve(loop.torque, -30.0, 30.0))
    random = np.random.default_rng(0)
    amplitudes, changes = random.uniform(0.5, 1.5, widths.shape[1]), np.array([0.02, -0.01, 0.03, 0.4])
    jacobian = model.jacobian(widths, loop, amplitudes, changes)
    assert jacobian[:, : len(amplitudes)] == pytest.approx(widths * model.factors(loop, changes))
    for place, step in enumerate(1e-4 * np.eye(len(changes)), len(amplitudes)):
        ahead, back = (widths @ (model.factors(loop, changes + sign * step) * amplitudes) for sign in (1.0, -1.0))
        assert jacobian[:, place] == pytest.approx((ahead - back) / 2e-4, rel=1e-5)


def test_a_cycle_loses_the_area_of_its_width() -> None:
    loop = LossLoop.planned(0.0, 2e4, 30.0, 1e-4, 295.0)
    model = Widths(possible_sources(False, True), [], 295.0, None)
    names = [source.name for source in model.sources]
    loss = model.shape_sums @ model.cycle_loss(loop, Curve(loop.torque, -30.0, 30.0))
    travel = 4.0 * 30.0 / 2e4
    assert loss[names.index("gear, dry")] == pytest.approx(travel)
    assert loss[names.index("mesh, in proportion to the load")] == pytest.approx(0.5 * 30.0 * travel, rel=1e-3)
    stored = 0.5 * 30.0**2 / 2e4
    assert loss[names.index("flexspline, material")] == pytest.approx(2.0 * 2.0 * np.pi * stored, rel=1e-2)  # of two shapes
