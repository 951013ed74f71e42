"""Shares of the sources in the loss of torsion loops, each with its standard deviation or why it is not separated."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear
from strainwave.files.recording import Recording
from strainwave.identification.candidates.torsion.losses.fit import MAX_SHARE_SIGMA, LossFit, fit_losses
from strainwave.identification.candidates.torsion.losses.next_loops import next_loops
from strainwave.identification.candidates.torsion.losses.relaxation import MIN_RATES, rate_count
from strainwave.identification.candidates.torsion.losses.sources import RELAXING
from strainwave.presentation import Presented, Row, Statement
from strainwave.statistics.determined_sum import sum_by_covariance
from strainwave.typeset import percent, quantity, uncertain_quantity

Array = NDArray[np.float64]

MIN_CORRELATION_OF_PARTNERS = 0.5  # of shares that are stated as a sum
MIN_RELAXING_SIGMA = 3.0  # standard deviations of the share of a material whose relaxation time is stated


@dataclass(frozen=True)
class LossShare(Statement):
    """Share of one source in the loss of a cycle.

    Attributes:
        name: of the source
        share: of the loss of a cycle [1]
        sigma: its standard deviation [1]
        value, value_sigma: its number, as `quantity` and `unit` describe it, and its standard deviation
        quantity: that number, in words
        unit: of it
        why: why the loops do not separate it, and what would; empty if they do
    """

    name: str
    share: float
    sigma: float
    value: float
    value_sigma: float
    quantity: str
    unit: str
    why: str = ""

    @property
    def is_separated(self) -> bool:
        """True if the loops determine it by itself."""
        return not self.why

    @property
    def number(self) -> str:
        """Its number with unit and standard deviation."""
        return f"{self.quantity} {uncertain_quantity(self.value, self.value_sigma, self.unit)}"

    @property
    def note(self) -> str:
        """Its number, or why the loops do not separate it."""
        return f"not separable: {self.why}" if self.why else self.number

    def _headline(self) -> str:
        share = "" if self.why else f"{100.0 * self.share:.1f} ± {100.0 * self.sigma:.1f} %, "
        return f"{self.name}: {share}{self.note}"


@dataclass(frozen=True)
class LossShares(Presented):
    """Result of `loss_shares`.

    Attributes:
        shares: of each source that the loops may contain
        loss: of a cycle of the largest loop [J]
        loop: that loop, in words
        remarks: what the loops do not contain, and what no source explains
    """

    shares: tuple[LossShare, ...]
    loss: float
    loop: str
    remarks: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> LossShare:
        """Return the share of a source.

        Raises:
            KeyError: the loops contain no such source; names those that they may contain
        """
        by_name = {share.name: share for share in self.shares}
        if name not in by_name:
            raise KeyError(f"{name!r} is no source of these loops; they are {list(by_name)}")
        return by_name[name]

    @property
    def in_words(self) -> str:
        """The shares that are separated, in one line."""
        separated = [share for share in self.shares if share.is_separated]
        shares = [f"{share.name} {100.0 * share.share:.0f} ± {100.0 * share.sigma:.0f} %" for share in separated]
        return "; ".join(shares) or "no source is separated"

    @property
    def lines(self) -> tuple[str, ...]:
        """The result as sentences: the loss, each source, and the remarks."""
        loss = f"{quantity(self.loss, 'J')} are lost in a cycle of the loop of {self.loop}"
        return (loss, *map(str, self.shares), *self.remarks)

    def _headline(self) -> str:
        count = sum(share.is_separated for share in self.shares)
        return f"{count} of {len(self.shares)} sources separated, {quantity(self.loss, 'J')} a cycle of the loop of {self.loop}"

    def _rows(self) -> Iterator[Row]:
        yield Row("loss of a cycle", self.loss, "J", note=f"of the loop of {self.loop}")
        for share in self.shares:
            yield Row(share.name, share.share, "1", share.sigma, share.note)


def loss_shares(loops: Sequence[Recording], gear: Gear) -> LossShares:
    """Return the share of each source in the loss of torsion loops, or why the loops do not separate it.

    Give loops of one gear at both sides, several loads, rates and temperatures, one amplitude a recording.

    Args:
        loops: `twist` and `torque` at the output with the input locked, or `input_angle` and `input_torque` with the output
            locked; with `time` if friction may be viscous, and `temperature`
        gear: whose ratio refers loops at the input to the output

    Raises:
        ValueError: a recording is no loop, or some have a time or a temperature and others have none

    >>> import strainwave as sw
    >>> loops, units = [], {"twist": "rad", "torque": "N.m"}
    >>> way = np.sin(np.linspace(0.5, 4.5, 801) * np.pi)
    >>> for reach in (10.0, 40.0):  # of a mesh that loses 2 % of the load, and 0.5 N.m of dry friction
    ...     torque = reach * way + (0.5 + 0.02 * np.abs(reach * way)) * np.sign(np.gradient(way))
    ...     loops.append(sw.Recording({"twist": reach * way / 4e4, "torque": torque}, units))
    >>> result = loss_shares(loops, sw.load("hfuc-25-100"))
    >>> [round(result[name].value, 3) for name in ("gear, dry", "mesh, in proportion to the load")]
    [0.5, 0.02]
    """
    return shares_of(fit_losses(loops, gear))


def shares_of(fit: LossFit) -> LossShares:
    """Return the shares of sources by a fit to loops, their shapes added."""
    sums = fit.widths.shape_sums
    count = sums.shape[1]
    of_one = sums @ fit.unit_loss / sums.sum(axis=1)  # loss for the number 1 [J]
    of_values = np.sqrt(np.diag(sums @ fit.covariance[:count, :count] @ sums.T))
    sigmas = np.hypot(fit.sigma_by_noise(), fit.floors)
    value_sigmas = np.hypot(of_values, fit.floors * abs(fit.total) / of_one)
    numbers = np.stack([fit.shares, sigmas, sums @ fit.amplitudes, value_sigmas], axis=1).tolist()
    shares = []
    for place, (source, (share, sigma, value, value_sigma)) in enumerate(zip(fit.widths.sources, numbers, strict=True)):
        why = _why(fit, place) if sigma > MAX_SHARE_SIGMA else ""
        shares.append(LossShare(source.name, share, sigma, value, value_sigma, source.quantity, source.unit, why))
    return LossShares(tuple(shares), fit.total, fit.loops[fit.largest].words, tuple(_remarks(fit, shares[-1])))


def _why(fit: LossFit, place: int) -> str:
    """Return why loops do not separate a source: the sum with others that they determine, and the loops that would."""
    if fit.sigma_by_noise()[place] <= MAX_SHARE_SIGMA:
        by_forms = percent(float(fit.floors[place]))
        if fit.misfit == 0.0:
            return f"what is left out next to the reversals changes it, by {by_forms} of the loss: add loops of other loads"
        return f"the loops depart from the forms of all sources, by {by_forms} of the loss: friction may slip little by little"
    covariance, further = fit.total**2 * fit.share_rows @ fit.covariance @ fit.share_rows.T, next_loops(fit, place)
    related = np.abs(covariance[place]) / np.sqrt(covariance[place, place] * np.diag(covariance))
    together = [place, *(int(other) for other in np.flatnonzero(related > MIN_CORRELATION_OF_PARTNERS) if other != place)]
    joint_loss = sum_by_covariance(covariance, together, fit.total * fit.shares, fit.names, "J")
    by_forms_of_sum = float(fit.sigma_by_forms(fit.shifts[:, together] @ joint_loss.factors))
    joint_loss = replace(joint_loss, sigma=float(np.hypot(joint_loss.sigma, by_forms_of_sum * abs(fit.total))))
    is_known = len(together) > 1 and joint_loss.sigma < MAX_SHARE_SIGMA * abs(fit.total)
    return f"{joint_loss}, {further}" if is_known else further


def _remarks(fit: LossFit, last: LossShare) -> Iterator[str]:
    """Yield the relaxation time if the share of the last source is beyond chance, and what the loops do not contain."""
    if fit.widths.relaxation and last.is_separated and last.share > MIN_RELAXING_SIGMA * last.sigma:
        time = float(np.exp(fit.changes[-1])) / fit.widths.relaxation.middle
        sigma = time * float(np.hypot(np.sqrt(fit.covariance[-1, -1]), last.sigma / last.share))
        yield f"{last.name}: one Maxwell branch that relaxes in {uncertain_quantity(time, sigma, 's')}"
    if not any(loop.ratio for loop in fit.loops):
        yield "no loop was measured at the input: the bearing of the wave generator stands still in all of them"
    elif all(loop.ratio for loop in fit.loops):
        yield "no loop was measured at the output with the input locked, which alone separates the bearing from the gear"
    if not all(loop.is_timed for loop in fit.loops):
        yield "the loops have no time, so they are taken for so slow that no friction depends on the rate"
    elif fit.widths.relaxation is None:
        too_few = f"not separable: loops at {MIN_RATES} rates would separate it from viscous friction and a loss factor"
        none = "viscous friction and a loss factor explain the loops at all rates without it"
        yield f"{RELAXING.name}: {too_few if rate_count(fit.loops) < MIN_RATES else none}"
    if not fit.widths.lubricants:
        yield "the shares are those at the temperature of the loops, which does not vary or was not measured"
    if fit.misfit > 0.0:
        yield f"the sources leave up to {percent(fit.misfit)} of the width of a loop unexplained, which is part of ±"
