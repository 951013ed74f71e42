"""Error of a model on data that its numbers were not fitted to, by which models were compared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from strainwave import typeset
from strainwave.presentation import Presented, Row
from strainwave.typeset import percent, quantity

MAX_UNEXPLAINED = 0.5  # of the signal on held-out data: a model that leaves more explains nothing
MAX_SHARE_OF_PLAIN = 1.02  # of the error of plain least squares: a model that leaves more is no answer
MAX_SHARE_VIBRATING = 1.1  # likewise, if sliding in the pass band is predicted to MAX_IN_BAND: both leave vibrations
MAX_IN_BAND = 0.01  # of the signal in the pass band


def error_in_words(error: float, unit: str, varies: float, plain: float = np.nan) -> str:
    """Return an RMS error in the unit of its signal, beside that of plain least squares, and its share of the signal.

    Args:
        error: root mean square of measured less predicted
        unit: of all
        varies: root mean square of the signal about its mean; not positive if it does not vary
        plain: what plain least squares leaves; not a number without

    >>> error_in_words(0.147, "A", 1.79, 0.185), error_in_words(8.3e-3, "N.m", 0.054)
    ('0.147 A (plain least squares 0.185 A), 8.2 % of the signal', '8.3 mN·m, 15 % of the signal')
    """
    beside = f" (plain least squares {quantity(plain, unit)})" if np.isfinite(plain) else ""
    return f"{quantity(error, unit)}{beside}{f', {percent(error / varies)} of the signal' if varies > 0.0 else ''}"


@dataclass(frozen=True)
class HeldOut(Presented):
    """The error of a model over a contiguous stretch that its numbers were not fitted to: every sample, in the full band.

    Models were chosen by such stretches, this one among them, so that a new record has a somewhat larger error.

    Attributes:
        stretch: the stretch, as `last 30 % of the motion`
        channel: that is predicted
        unit: of all errors
        error: root mean square of measured less predicted, at rest of what no friction that holds makes up for
        zero: error of the mean of the channel in the rest of the motion: of a model that predicts nothing
        plain: error of plain least squares there (offset, inertia, gravity, Coulomb and viscous friction); not a number without
        samples: compared
        in_band: the error over that of the mean in the pass band of the fit, where slow sliding alone is compared [1]
    """

    stretch: str
    channel: str
    unit: str
    error: float
    zero: float
    plain: float = np.nan
    samples: int = 0
    in_band: float = np.nan

    @property
    def words(self) -> str:
        """The error in words, as `error_in_words`."""
        return error_in_words(self.error, self.unit, self.zero, self.plain)

    @property
    def relative(self) -> float:
        """Error over that of a model that predicts nothing [1]."""
        return self.error / self.zero if self.zero > 0.0 else np.inf

    @property
    def share_of_plain(self) -> float:
        """Error over that of plain least squares [1]; not a number without."""
        return self.error / max(self.plain, 1e-300)

    @property
    def max_share_of_plain(self) -> float:
        """Limit of `share_of_plain` [1]."""
        return MAX_SHARE_VIBRATING if self.in_band < MAX_IN_BAND else MAX_SHARE_OF_PLAIN

    def _headline(self) -> str:
        plain = f", plain least squares {typeset.quantity(self.plain, self.unit)}" if np.isfinite(self.plain) else ""
        return f"error on held-out data {typeset.quantity(self.error, self.unit)}{plain}"

    def _rows(self) -> Iterator[Row]:
        yield Row("error on held-out data", self.error, self.unit, note=f"of {self.channel}, {self.stretch}")
        if np.isfinite(self.plain):
            yield Row("error of plain least squares", self.plain, self.unit)
        yield Row("error of the mean", self.zero, self.unit)
        yield Row("samples held out", self.samples)
