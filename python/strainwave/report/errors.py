"""Errors of a model and of simpler ones, as pages and terminals show them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite

from strainwave.identification.results.file_result import HeldOut
from strainwave.typeset import percent, quantity

THIS_MODEL, LEAST_SQUARES, ZERO_MODEL = "this model", "plain least squares", "predicting the mean"
Row = tuple[str, str, str]  # name of the model, its error, and its error over that of predicting the mean


def error_rows(errors: Mapping[str, float], zero: float, unit: str) -> Iterator[Row]:
    """Yield the error of each model, and last that of predicting the mean; errors that are not known are left out.

    Args:
        errors: root mean squares, by the name of the model
        zero: of predicting the mean
        unit: of all

    >>> list(error_rows({"this model": 0.305, LEAST_SQUARES: float("nan")}, 6.3, "A"))
    [('this model', '0.305 A', '4.8 %'), ('predicting the mean', '6.3 A', '100 %')]
    """
    for name, error in {**errors, ZERO_MODEL: zero}.items():
        if isfinite(error):
            yield name, quantity(error, unit), percent(error / zero) if zero > 0.0 else ""


def held_out_rows(held_out: HeldOut | None) -> list[Row]:
    """Return the errors on held-out data; in the pass band of the fit, if the fit had one, as its share alone."""
    if held_out is None:
        return []
    rows = list(error_rows({THIS_MODEL: held_out.error, LEAST_SQUARES: held_out.plain}, held_out.zero, held_out.unit))
    if isfinite(held_out.in_band):
        rows.insert(1, (f"{THIS_MODEL}, in the pass band of its fit", "", percent(held_out.in_band)))
    return rows
