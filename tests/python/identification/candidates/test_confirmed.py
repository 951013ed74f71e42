"""Plain least squares with terms of other joints beside a model."""

from __future__ import annotations

import numpy as np
import pytest
from strainwave.identification.candidates.confirmed import beats_by_chance


@pytest.mark.parametrize(
    ("left", "by_chance"),
    [((0.3, 1.6, 0.2), True), ((0.2, 0.1, 0.2), False), ((0.3, 1.6, 0.4), False)],
)
def test_terms_that_predict_the_last_stretch_alone_hit_it_by_chance(left: tuple[float, ...], by_chance: bool) -> None:
    """Errors of 0.3, 0.2 and 0.3 by the model; axis 5 of a robot was recorded for 10 s, with two terms of other joints."""
    of_plain, of_model = ([error * np.ones(50) for error in errors] for errors in (left, (0.3, 0.2, 0.3)))
    assert beats_by_chance(of_plain, of_model) == by_chance
