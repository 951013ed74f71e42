"""Check that what a model leaves has no shape over angle, speed or the order of the samples, as white noise has none."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.identification.results.check import Check
from strainwave.identification.results.held_out import error_in_words
from strainwave.statistics.shape import shape

Array = NDArray[np.float64]
NAME = "shape of what is left"
MAX_CHANCE = 1e-3  # of noise that repeats as well: of right models 1 in 1000 has a shape by chance
MAX_SHARE_OF_SHAPE = 0.25  # of what varies: models of real joints leave up to 16 %
MIN_SHARE_OF_SHAPE = 0.01  # of what varies: a smaller one is no remark


def has_small_shape(check: Check) -> bool:
    """True for a check of a shape that is there, and too small to fail."""
    least = MIN_SHARE_OF_SHAPE / MAX_SHARE_OF_SHAPE * check.limit
    return check.name == NAME and least < check.value and not check.failed


class Judged(NamedTuple):
    """Check of the shape of residuals, None for too few samples, and a remark if the shape is significant but small."""

    checks: tuple[Check, ...] = ()
    remarks: tuple[str, ...] = ()


def judged_shape(
    residual: Array, abscissae: Mapping[str, Array], varies: float, unit: str, source: str, *, ordered: bool = False
) -> Judged:
    """Return the check that what a model leaves has no large shape, and a remark on a small one.

    Args:
        residual: measured less modelled, in the order of the samples, shape (n,)
        abscissae: over which it may repeat, by their names in words, each of shape (n,)
        varies: root mean square of the signal about its mean
        unit: of both
        source: name of the file
        ordered: True if the samples are in the order of their only abscissa
    """
    tried = {name: shape(residual, over, ordered=ordered) for name, over in abscissae.items()}
    sizes = {name: each.size if each.chance < MAX_CHANCE else 0.0 for name, each in tried.items() if each is not None}
    if not sizes:
        return Judged()
    name = max(sizes, key=lambda each: sizes[each])
    size, limit = sizes[name], MAX_SHARE_OF_SHAPE * varies
    words = f"the residual has a shape over {name}: RMS {error_in_words(size, unit, varies)}"
    check = Check(
        NAME, source, size, limit, unit, size > limit, words if size > limit else "",
        "look at the residual below the picture: the model lacks what it shows there, or a column is of another joint",
    )  # fmt: skip
    return Judged((check,), (words,) if MIN_SHARE_OF_SHAPE * varies < size <= limit else ())
