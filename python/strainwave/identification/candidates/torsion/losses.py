"""Loss of torsion loops by its source: bearing at the input, dry and viscous friction of the gear, mesh, and flexspline.

On both ways of a loop the torque is S(twist) ± h: a curve that both ways share, and half of the width. Each source has its own
form of h, with S the torque on that curve, T its largest, v the rate of the twist and i the ratio:

    bearing, dry                  h = |i| b             at the input alone: with the input locked it does not turn
    bearing, viscous              h = i² c_b |v|        at the input alone
    gear, dry                     h = d                 at both sides, whatever the load is
    gear, viscous                 h = c |v|             at both sides
    mesh, in proportion to load   h = mu |S|            sliding between teeth, Coulomb
    flexspline, material          h = eta T sqrt(1 - (S/T)²), or with 3 pi / 8 (1 - (S/T)²) in place of the root
    flexspline, relaxing material h = k tau |v| / (1 + omega² tau²)

Both shapes of the material lose 2 pi eta times the stored energy in a cycle of a linear spring, at any rate: eta is a loss
factor. The first is the ellipse of a complex stiffness, the second the lens of Rayleigh's law; any mixture is fitted. The
relaxing material is one Maxwell branch (`sw.material.GeneralisedMaxwell`). It loses pi a² k omega tau / (1 + omega² tau²) in a
cycle under a sine of the amplitude a and the angular frequency omega. Viscous friction, a loss factor, k and tau are four
unknowns over the rate: the material takes part from four rates on, if they show it beyond chance. Friction changes with the
temperature by exp(-kappa (temperature - that of the largest loop)); the material does not.

The torque is linear in all but kappa and tau, and so is the loss of a cycle. Loops at one load do not separate what is
proportional to load from what is constant, loops at one rate not viscous from dry friction, and loops at one side not the
bearing from the gear: the covariance of the fit contains that, and a share is stated only as well as it is separated.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave._core import Gear
from strainwave.analysis.torsion_loop import series_compliance
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.candidates.steady_shapes import MIN_TEMPERATURE_SPAN
from strainwave.identification.experiments.loss_loop import MAX_REACH_DIFFERENCE, LossLoop
from strainwave.presentation import Presented, Row, Statement
from strainwave.statistics.covariance import posterior_of
from strainwave.statistics.determined_sum import sum_by_covariance
from strainwave.statistics.linear_fit import linear_fit, solved
from strainwave.typeset import percent, quantity, uncertain_quantity

Array = NDArray[np.float64]

MAX_SHARE_SIGMA = 0.05  # of the loss of a cycle: a share with a larger standard deviation is not separated
SHAPE_SIGMA = 0.02  # of the loss of a cycle: how far real widths depart from the shapes (assumed)
PRIOR_SHARE_SIGMA = 1.0  # of the loss of a cycle: no source loses more than all do
FALL_SIGMA = 0.05  # 1/K: of the relative fall of friction with the temperature, about none (assumed)
MIN_CORRELATION_OF_PARTNERS = 0.5  # of shares that are stated as a sum
REVERSAL_SHARES = (0.02, 0.06, 0.15)  # of the span, next to a reversal, that is left out; the second is taken
MAX_PIECES_OF_CURVE = 24  # cubic pieces of the curve that both ways share
SAMPLES_PER_PIECE = 12
END_SHARE = 0.1  # of the span next to a reversal, where the curve is a line
MIN_BOTH_SENSES = 0.1  # of the span of the torque on either side of zero, from which on both senses have a width of their own
ROUNDS_OF_CURVE = 2  # in which curve and widths are fitted in turn
MIN_NOISE_SHARE = 1e-5  # of the torque: no sensor has less noise
MIN_MISFIT_SIGMA = 4.0  # standard deviations of a loop's width that no source explains
MIN_RATES, MIN_RATIO_OF_RATES = 4, 1.3  # that determine a relaxation, too; of a rate to the next slower one (assumed)
STARTS_OF_TIME = (-1.0, 0.0, 1.0)  # standard deviations of the logarithm of the relaxation time
MIN_RELAXING_SIGMA = 3.0  # standard deviations of the share of a material whose relaxation time is stated
MAX_PLANNED_LOOPS = 3
PLANNED_REACHES, PLANNED_RATES, PLANNED_WARMTHS = (1.0, 0.5, 0.25), (1.0, 5.0), (0.0, 20.0)  # of the loop that is there; K


# ---- Sources ---------------------------------------------------------------------------------------------------------


class _Curve(NamedTuple):
    """The torque on the curve that both ways of a loop share, and its ends [N.m]."""

    torque: Array
    low: float
    high: float

    @property
    def bow(self) -> Array:
        """1 - (S/T)² about the middle, shape (n,)."""
        half = 0.5 * (self.high - self.low)
        return np.clip((self.high - self.torque) * (self.torque - self.low), 0.0, None) / half**2

    @property
    def reach(self) -> float:
        return 0.5 * (self.high - self.low)


Shape = Callable[[LossLoop, _Curve], Array]


@dataclass(frozen=True)
class Source:
    """A source of loss.

    Attributes:
        name: of it
        quantity: its number, in words
        unit: of that
        shapes: half of the width of a loop for the number 1 [N.m], one or several that are added
        lubricant: the fall with the temperature that it shares with others; empty if it has none
    """

    name: str
    quantity: str
    unit: str
    shapes: tuple[Shape, ...]
    lubricant: str = ""


def _dry(loop: LossLoop, curve: _Curve) -> Array:
    return np.ones(len(loop.twist))


SOURCES = (
    Source("bearing, dry", "torque at the input", "N.m", (lambda loop, _: np.full(len(loop.twist), loop.ratio),), "bearing"),
    Source("bearing, viscous", "at the input", "N.m.s/rad", (lambda loop, _: loop.ratio**2 * loop.rate,), "oil"),
    Source("gear, dry", "torque at the output", "N.m", (_dry,), "mesh"),
    Source("gear, viscous", "at the output", "N.m.s/rad", (lambda loop, _: loop.rate,), "oil"),
    Source("mesh, in proportion to the load", "share of the load", "1", (lambda _, curve: np.abs(curve.torque),), "mesh"),
    Source(
        "flexspline, material", "loss factor", "1",
        (lambda _, curve: curve.reach * np.sqrt(curve.bow), lambda _, curve: 3.0 * np.pi / 8.0 * curve.reach * curve.bow),
    ),
)  # fmt: skip
RELAXING = Source(
    "flexspline, relaxing material", "loss modulus at the rate of the largest loop", "N.m/rad",
    (lambda loop, _: loop.rate / loop.frequency,),
)  # fmt: skip


# ---- Result ----------------------------------------------------------------------------------------------------------


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

    def _headline(self) -> str:
        if self.why:
            return f"{self.name}: not separable: {self.why}"
        return f"{self.name}: {100.0 * self.share:.1f} ± {100.0 * self.sigma:.1f} %, {self.number}"

    @property
    def number(self) -> str:
        """Its number with unit and standard deviation."""
        return f"{self.quantity} {uncertain_quantity(self.value, self.value_sigma, self.unit)}"


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
        return (
            f"{quantity(self.loss, 'J')} are lost in a cycle of the loop of {self.loop}",
            *map(str, self.shares),
            *self.remarks,
        )

    def _headline(self) -> str:
        count = sum(share.is_separated for share in self.shares)
        return f"{count} of {len(self.shares)} sources separated, {quantity(self.loss, 'J')} a cycle of the loop of {self.loop}"

    def _rows(self) -> Iterator[Row]:
        yield Row("loss of a cycle", self.loss, "J", note=f"of the loop of {self.loop}")
        for share in self.shares:
            note = share.number if share.is_separated else f"not separable: {share.why}"
            yield Row(share.name, share.share, "1", share.sigma, note)


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
    return _shares(*_of_recordings(loops, gear))


@dataclass(frozen=True, eq=False)
class FurtherLoops(ComparedByFields):
    """Loops that could be measured, and what they would determine of the shares of the sources.

    Unknowns are the shares, then what else is unknown of shapes and temperatures, all of a size about 1.

    Attributes:
        shares: result of the loops that were measured
        sources: names of the sources, whose shares are the first unknowns; those of loops at the input, too
        covariance: of the unknowns by these, shape (p, p), infinite in no direction
        floors: standard deviation of each share that no loop reduces, as real widths depart from the forms
        loops: that could be measured
        information: of each about the unknowns, shape (loops, p, p)
        temperature: of the largest loop that was measured [K]
    """

    shares: LossShares
    sources: tuple[str, ...]
    covariance: Array
    floors: Array
    loops: tuple[LossLoop, ...]
    information: Array
    temperature: float


def further_loops(loops: Sequence[Recording], gear: Gear) -> FurtherLoops:
    """Return the loops that could be measured after those of `loss_shares`, whose arguments and errors these are."""
    measured, shifts = _of_recordings(loops, gear)
    shares = _shares(measured, shifts)
    fit = measured
    if not any(each.ratio for each in measured.loops) and series_compliance(gear) == 0.0:
        fit = _with_bearing(measured, abs(gear.kinematics.ratio))
    total = float(fit.unit_loss @ fit.amplitudes)
    into = _unknowns(fit, total)
    options, back = [*_planned(fit, abs(gear.kinematics.ratio))], np.linalg.inv(into)
    information = np.stack([back.T @ rows.T @ rows @ back for _, rows in options])
    covariance = into @ fit.covariance @ into.T
    floor = float(np.hypot(SHAPE_SIGMA, fit.misfit))
    count = len(fit.widths.sources) - shifts.shape[1]  # of sources that were not measured: those of the bearing
    by_noise = np.sqrt(np.diag(covariance)[count : len(fit.widths.sources)]) > MAX_SHARE_SIGMA
    floors = np.where(by_noise, floor, np.hypot(floor, np.abs(shifts).max(axis=0)))
    floors = np.append(floors[:count], floors)  # the bearing has the forms of the friction of the gear, which comes next
    planned = tuple(loop for loop, _ in options)
    names = tuple(source.name for source in fit.widths.sources)
    return FurtherLoops(shares, names, covariance, floors, planned, information, fit.widths.reference_temperature)


def _with_bearing(fit: _Fit, ratio: float) -> _Fit:
    """Return the fit of loops at the output with the sources of loops at the input, of which nothing but the prior is known."""
    possible = _possible(has_input=True, timed=fit.loops[fit.largest].is_timed)
    model = replace(fit.widths, sources=[*(each for each in possible if each not in fit.widths.sources), *fit.widths.sources])
    unit_loss = _cycle(replace(fit.loops[fit.largest], ratio=ratio), fit.curves[fit.largest], model)
    count = len(unit_loss) - len(fit.unit_loss)  # SOURCES begins with the bearing
    covariance = np.pad(fit.covariance, ((count, 0), (count, 0)))
    prior = PRIOR_SHARE_SIGMA * (fit.unit_loss @ fit.amplitudes) / unit_loss[:count]
    covariance[:count, :count] = np.diag(prior**2)
    amplitudes = np.append(np.zeros(count), fit.amplitudes)
    return replace(fit, widths=model, amplitudes=amplitudes, covariance=covariance, unit_loss=unit_loss)


def _unknowns(fit: _Fit, total: float) -> Array:
    """Return the matrix that makes shares, differences of shapes of one source, and changes of amplitudes and changes."""
    added = _added(fit.widths.sources)
    shapes = added.shape[1]
    first = [int(np.flatnonzero(row)[0]) for row in added]
    differences = np.eye(shapes)[[place for place in range(shapes) if place not in first]]
    into = np.zeros((shapes + len(fit.changes),) * 2)
    into[:shapes, :shapes] = np.concatenate((added, differences)) * (fit.unit_loss / total)
    into[shapes:, shapes:] = np.diag(1.0 / fit.widths.scales)
    return into


def _of_recordings(loops: Sequence[Recording], gear: Gear) -> tuple[_Fit, Array]:
    """Return the fit to loops, and the change of the shares if more or less next to reversals is left out."""
    measured = [LossLoop.of(each, arguments.gear(gear)) for each in loops]
    if not measured:
        raise ValueError("loss_shares needs at least one torsion loop")
    known = {"time": [each.is_timed for each in measured], "temperature": [each.is_warm for each in measured]}
    for what, has in known.items():
        if any(has) and not all(has):
            raise ValueError(
                f"loop {has.index(False) + 1} of {len(has)} has no {what}, others have one: give it to all or none"
            )
    near, fit, far = _fits(measured, relaxing=True)
    if fit.widths.relaxation and not fit.shows_relaxation:
        near, fit, far = _fits(measured, relaxing=False)
    return fit, np.array([each.shares - fit.shares for each in (near, far)])


def _fits(loops: Sequence[LossLoop], *, relaxing: bool) -> Iterator[_Fit]:
    """Yield the fits that leave out more and more next to reversals; `relaxing`: with that material at enough rates."""
    at_ends = None
    for share in REVERSAL_SHARES:
        fit = _fitted([loop.apart(share) for loop in loops], at_ends, relaxing=relaxing)
        at_ends = at_ends or [(curve.low, curve.high) for curve in fit.curves]
        yield fit


# ---- Fit -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Widths:
    """Half widths of all shapes of sources on loops at temperatures."""

    sources: list[Source]
    lubricants: list[str]
    reference_temperature: float
    relaxation: _Relaxation | None

    @property
    def scales(self) -> Array:
        """Standard deviations of what is not linear before the loops: falls [1/K], logarithm of the relaxation time."""
        return np.array([FALL_SIGMA] * len(self.lubricants) + ([self.relaxation.spread] if self.relaxation else []))

    @property
    def starts(self) -> Iterator[Array]:
        """Initial values of the same."""
        for share in STARTS_OF_TIME if self.relaxation else (0.0,):
            yield np.append(np.zeros(len(self.lubricants)), [share * self.relaxation.spread] if self.relaxation else [])

    def of_loop(self, loop: LossLoop, curve: _Curve) -> Array:
        """Return them for the number 1 at temperature and rate of the largest loop, shape (n, shapes)."""
        shapes = [shape(loop, curve) for source in self.sources for shape in source.shapes]
        return loop.sense[:, np.newaxis] * np.stack(shapes, axis=1)

    def factors(self, loop: LossLoop, changes: Array) -> tuple[Array, Array]:
        """Return the factor of each shape at temperature and rate of a loop, and its derivatives, shape (shapes, changes)."""
        warmer = loop.temperature - self.reference_temperature if self.lubricants else 0.0
        own = [source.lubricant for source in self.sources for _ in source.shapes]
        of_fall = np.array([[name == each for each in self.lubricants] for name in own], float).reshape(len(own), -1)
        factor = np.exp(-warmer * (of_fall @ changes[: len(self.lubricants)]))
        slopes = -warmer * of_fall * factor[:, np.newaxis]
        if self.relaxation is None:
            return factor, slopes
        factor[-1], slope = self.relaxation.factor(loop.frequency, float(changes[-1]))
        return factor, np.column_stack((slopes, np.append(np.zeros(len(own) - 1), slope)))

    def jacobian(self, widths: Array, loop: LossLoop, amplitudes: Array, changes: Array) -> Array:
        """Return the derivatives of the torque by amplitudes and changes, shape (n, shapes + changes)."""
        factor, slopes = self.factors(loop, changes)
        return np.concatenate((widths * factor, widths @ (amplitudes[:, np.newaxis] * slopes)), axis=1)


@dataclass(frozen=True)
class _Relaxation:
    """Loss modulus of a Maxwell branch over the angular frequency, in units of that of the largest loop.

    Attributes:
        reference: angular frequency of the largest loop [rad/s]
        middle, spread: geometric mean of those of all loops [rad/s], and half of the logarithm of their range: what is assumed
            of the inverse of the relaxation time, and of the logarithm of that
    """

    reference: float
    middle: float
    spread: float

    def factor(self, frequency: float, logarithm: float) -> tuple[float, float]:
        """Return it at a frequency [rad/s], and its derivative by the logarithm of the relaxation time over 1 / middle."""
        here, there = (float((each * np.exp(logarithm) / self.middle) ** 2) for each in (frequency, self.reference))
        factor = frequency / self.reference * (1.0 + there) / (1.0 + here)
        return factor, factor * 2.0 * (there / (1.0 + there) - here / (1.0 + here))


@dataclass(frozen=True, eq=False)
class _Fit:
    """The fit of all sources to all loops.

    Attributes:
        loops, curves: shape of each
        widths: of the sources that the loops may contain
        amplitudes: of each shape of each source
        changes: fall of each lubricant with the temperature [1/K]; logarithm of the relaxation time over 1 / middle
        covariance: of both
        unit_loss: of each shape for the number 1, in a cycle of the largest loop [J]
        largest: place of that loop
        noise: of the torque of a loop, the median [N.m]
        misfit: the largest part of a loop's width that no source explains [1]
    """

    loops: Sequence[LossLoop]
    curves: Sequence[_Curve]
    widths: _Widths
    amplitudes: Array
    changes: Array
    covariance: Array
    unit_loss: Array
    largest: int
    noise: float
    misfit: float

    @property
    def shows_relaxation(self) -> bool:
        """True if the last source, a relaxing material, is beyond chance with the relaxation time that is estimated."""
        place, time = len(self.amplitudes) - 1, len(self.covariance) - 1
        variance = self.covariance[place, place] - self.covariance[place, time] ** 2 / self.covariance[time, time]
        return bool(self.amplitudes[place] > MIN_MISFIT_SIGMA * np.sqrt(variance))

    @property
    def shares(self) -> Array:
        """Shares of the sources in the loss of a cycle, shape (sources,)."""
        losses = _added(self.widths.sources) @ (self.unit_loss * self.amplitudes)
        return np.asarray(losses / losses.sum())


@dataclass(frozen=True, eq=False)
class _Equations:
    """A loop as linear equations in units of its noise, less what the curve and both senses of torque explain.

    Attributes:
        loop: with the temperature
        widths: of all shapes for the number 1, shape (n, shapes)
        torque: shape (n,)
        noise: of the torque [N.m]
    """

    loop: LossLoop
    widths: Array
    torque: Array
    noise: float

    @classmethod
    def of(cls, loop: LossLoop, curve: _Curve, model: _Widths) -> _Equations:
        shared = _shared(loop, curve)
        both = np.column_stack((model.of_loop(loop, curve), loop.torque))
        left = both - shared @ (shared.T @ both)
        widths, torque = left[:, :-1], left[:, -1]
        unexplained = torque - widths @ solved(widths, torque)
        free = max(len(torque) - shared.shape[1] - widths.shape[1], 1)
        noise = max(float(np.sqrt(unexplained @ unexplained / free)), MIN_NOISE_SHARE * curve.reach)
        return cls(loop, widths / noise, torque / noise, noise)

    @property
    def triangle(self) -> _Equations:
        """The same sum of squares by as many equations as there are unknowns."""
        rows = np.asarray(np.linalg.qr(np.column_stack((self.widths, self.torque)), mode="r"))
        return replace(self, widths=rows[:, :-1], torque=rows[:, -1])


def _fitted(loops: Sequence[LossLoop], at_ends: Sequence[tuple[float, float]] | None, *, relaxing: bool) -> _Fit:
    """Fit all sources to all loops, with a curve of each loop that both ways share, between known torques at its ends [N.m]."""
    known = [None] * len(loops) if at_ends is None else at_ends
    curves = [_curve(loop, None, ends) for loop, ends in zip(loops, known, strict=True)]
    largest = _largest(loops, curves)
    model = _model_of(loops, largest, relaxing=relaxing)
    for _ in range(ROUNDS_OF_CURVE):
        curves = [
            _curve(loop, model.of_loop(loop, curve), ends) for loop, curve, ends in zip(loops, curves, known, strict=True)
        ]
    equations = [_Equations.of(loop, curve, model) for loop, curve in zip(loops, curves, strict=True)]
    unit_loss = _cycle(loops[largest], curves[largest], model)
    before = _priors(unit_loss, equations[largest], model.scales)
    amplitudes, changes = _solved(model, equations, before)
    rows = [model.jacobian(each.widths, each.loop, amplitudes, changes) for each in equations]
    explained = [row[:, : len(amplitudes)] @ amplitudes for row in rows]
    left = [each.torque - whole for each, whole in zip(equations, explained, strict=True)]
    covariance, _ = posterior_of(np.concatenate(rows), [each[np.newaxis] for each in left], before)
    misfit = max(_misfit(*each) for each in zip(left, explained, strict=True))
    noise = float(np.median([each.noise for each in equations]))
    return _Fit(loops, curves, model, amplitudes, changes, covariance, unit_loss, largest, noise, misfit)


def _priors(unit_loss: Array, largest: _Equations, scales: Array) -> Array:
    """Return priors about zero as rows: no source loses more than a cycle does, and what is not linear has these scales.

    The loss of a cycle is determined by the largest loop alone even if its sources are not.
    """
    loss = max(float(np.abs(unit_loss @ solved(largest.widths, largest.torque))), 1e-300)
    return np.diag(np.append(unit_loss / (PRIOR_SHARE_SIGMA * loss), 1.0 / scales))


def _largest(loops: Sequence[LossLoop], curves: Sequence[_Curve]) -> int:
    """Return the place of the loop of the largest torque, at the input if there is one; of several the first of the slowest."""
    has_input = any(loop.ratio for loop in loops)
    places = [place for place, loop in enumerate(loops) if bool(loop.ratio) == has_input]
    most = max(curves[place].reach for place in places)
    near = [place for place in places if curves[place].reach > (1.0 - MAX_REACH_DIFFERENCE) * most]
    slowest = (1.0 + MAX_REACH_DIFFERENCE) * min(loops[place].speed for place in near)
    return next(place for place in near if loops[place].speed <= slowest)


def _model_of(loops: Sequence[LossLoop], largest: int, *, relaxing: bool) -> _Widths:
    """Return the sources that loops may contain, referred to the largest, and the lubricants whose fall they show."""
    has_input, timed = any(loop.ratio for loop in loops), all(loop.is_timed for loop in loops)
    sources = _possible(has_input, timed)
    temperatures = np.array([loop.temperature for loop in loops])
    warmed = bool(np.isfinite(temperatures).all()) and float(np.ptp(temperatures)) >= MIN_TEMPERATURE_SPAN
    lubricants = [*dict.fromkeys(each.lubricant for each in sources if each.lubricant)] if warmed else []
    relaxation = _relaxation(loops, largest) if relaxing else None
    return _Widths([*sources, *([RELAXING] if relaxation else [])], lubricants, temperatures[largest].item(), relaxation)


def _rates(loops: Sequence[LossLoop]) -> int:
    """Return at how many rates loops were measured; 0 if not all have a clock."""
    rates = np.sort([loop.frequency for loop in loops])
    return int(np.isfinite(rates).all()) * (1 + int(np.count_nonzero(rates[1:] > MIN_RATIO_OF_RATES * rates[:-1])))


def _relaxation(loops: Sequence[LossLoop], largest: int) -> _Relaxation | None:
    """Return the relaxation that loops at enough rates may show; None if they have fewer, or no clock."""
    if _rates(loops) < MIN_RATES:
        return None
    slowest, fastest = (float(pick([loop.frequency for loop in loops])) for pick in (np.min, np.max))
    return _Relaxation(loops[largest].frequency, float(np.sqrt(slowest * fastest)), 0.5 * float(np.log(fastest / slowest)))


def _possible(has_input: bool, timed: bool) -> list[Source]:
    """Return the sources that loops may contain."""
    return [
        each
        for each in SOURCES
        if (has_input or not each.name.startswith("bearing")) and (timed or not each.name.endswith("viscous"))
    ]


def _splines(loop: LossLoop) -> Array:
    """Return cubic splines over the twist, shape (n, pieces + 3)."""
    from scipy.interpolate import BSpline

    pieces = int(np.clip(len(loop.twist) // (2 * SAMPLES_PER_PIECE), 1, MAX_PIECES_OF_CURVE))
    low, high = float(loop.twist.min()), float(loop.twist.max())
    knots = np.concatenate(([low] * 3, np.linspace(low, high, pieces + 1), [high] * 3))
    return np.asarray(BSpline.design_matrix(loop.twist, knots, 3).toarray())


def _curve(loop: LossLoop, widths: Array | None, at_ends: tuple[float, float] | None) -> _Curve:
    """Return the torque on the curve that both ways share, beside the widths of sources; of a linear spring if None."""
    splines = _splines(loop)
    if widths is None:  # as of a linear spring
        low, high = loop.ends
        way = 2.0 * (loop.twist - low) / (high - low) - 1.0
        bow = np.clip(1.0 - way**2, 0.0, None)
        widths = loop.sense[:, np.newaxis] * np.stack([np.ones_like(way), np.abs(way), np.sqrt(bow), bow], axis=1)
    coefficients = solved(np.column_stack((splines, widths)), loop.torque)
    torque = splines @ coefficients[: splines.shape[1]]
    low, high = at_ends or (_at_end(loop.twist, torque, end) for end in loop.ends)
    return _Curve(torque, low, high)


def _at_end(twist: Array, torque: Array, end: float) -> float:
    """Return the torque at a reversal [N.m], by a line through the curve next to it."""
    near = np.abs(twist - end) <= END_SHARE * float(np.ptp(twist))
    return float(np.polyval(np.polyfit(twist[near] - end, torque[near], 1), 0.0))


def _shared(loop: LossLoop, curve: _Curve) -> Array:
    """Return orthonormal columns of what says nothing of a loss: the curve, and a width that differs between both senses.

    The latter is also what an error of the zero of the torque changes of the width in proportion to load.
    """
    columns = [_splines(loop)]
    if min(-curve.low, curve.high) > MIN_BOTH_SENSES * (curve.high - curve.low):
        columns.append((loop.sense * np.sign(curve.torque))[:, np.newaxis])
    return np.asarray(np.linalg.qr(np.concatenate(columns, axis=1))[0])


def _cycle(loop: LossLoop, curve: _Curve, model: _Widths) -> Array:
    """Return the loss of a cycle for the number 1 of each shape, from reversal to reversal and back [J]."""
    loss = np.zeros(sum(len(each.shapes) for each in model.sources))
    for sense in (1.0, -1.0):
        way = np.flatnonzero(loop.sense == sense)
        way = way[np.argsort(loop.twist[way])]
        twist = np.concatenate((loop.ends[:1], loop.twist[way], loop.ends[1:]))
        torque = np.concatenate(([curve.low], curve.torque[way], [curve.high]))
        rate = np.concatenate((loop.rate[way[:1]], loop.rate[way], loop.rate[way[-1:]]))
        whole = replace(loop, twist=twist, torque=torque, sense=np.ones(len(twist)), rate=rate)
        loss += np.trapezoid(model.of_loop(whole, curve._replace(torque=torque)), twist, axis=0)
    return loss


def _solved(model: _Widths, equations: Sequence[_Equations], before: Array) -> tuple[Array, Array]:
    """Return amplitudes and changes by least squares with priors about zero."""
    from scipy.optimize import least_squares

    small, shapes = [each.triangle for each in equations], equations[0].widths.shape[1]

    def residual(unknowns: Array) -> Array:
        amplitudes, changes = unknowns[:shapes], unknowns[shapes:]
        left = [each.widths @ (model.factors(each.loop, changes)[0] * amplitudes) - each.torque for each in small]
        return np.concatenate((*left, before @ unknowns))

    def slopes(unknowns: Array) -> Array:
        amplitudes, changes = unknowns[:shapes], unknowns[shapes:]
        rows = [model.jacobian(each.widths, each.loop, amplitudes, changes) for each in small]
        return np.concatenate((*rows, before))

    def solution(changes: Array) -> tuple[float, Array]:
        nothing = np.append(np.zeros(shapes), changes)
        begin = np.append(solved(slopes(nothing)[:, :shapes], -residual(nothing)), changes)
        answer = least_squares(residual, begin, slopes, method="lm", x_scale="jac")
        return float(answer.cost), answer.x

    _, unknowns = min((solution(changes) for changes in model.starts), key=lambda each: each[0])
    return unknowns[:shapes], unknowns[shapes:]


def _misfit(left: Array, explained: Array) -> float:
    """Return the part of a loop's width that no source explains, if it is beyond chance [1]."""
    fit = linear_fit(explained[:, np.newaxis], left)
    is_beyond = abs(fit.values[0]) > MIN_MISFIT_SIGMA * fit.sigma[0]
    return float(abs(fit.values[0])) if is_beyond else 0.0


# ---- Shares ----------------------------------------------------------------------------------------------------------


def _shares(fit: _Fit, shifts: Array) -> LossShares:
    """Return the shares of sources, their shapes added.

    Args:
        fit: of all loops
        shifts: of the shares if more or less next to reversals is left out, shape (fits, sources)
    """
    added = _added(fit.widths.sources)
    losses = added @ (fit.unit_loss * fit.amplitudes)
    total = float(losses.sum())
    by_shape = fit.covariance[: len(fit.amplitudes), : len(fit.amplitudes)]
    of_losses = added @ (by_shape * np.outer(fit.unit_loss, fit.unit_loss)) @ added.T
    chance, names = np.sqrt(np.diag(of_losses)) / abs(total), [each.name for each in fit.widths.sources]
    of_forms = np.hypot(np.hypot(SHAPE_SIGMA, fit.misfit), np.abs(shifts).max(axis=0))
    of_one = added @ fit.unit_loss / added.sum(axis=1)  # loss for the number 1 [J]
    values = added @ fit.amplitudes
    value_sigmas = np.hypot(np.sqrt(np.diag(added @ by_shape @ added.T)), of_forms * abs(total) / of_one)

    def share(place: int) -> LossShare:
        source, of_cycle = fit.widths.sources[place], float(losses[place] / total)
        sigma, number = float(np.hypot(chance[place], of_forms[place])), (float(values[place]), float(value_sigmas[place]))
        own = LossShare(source.name, of_cycle, sigma, *number, source.quantity, source.unit)
        return own if sigma <= MAX_SHARE_SIGMA else replace(own, why=_why(place))

    def _why(place: int) -> str:
        if chance[place] <= MAX_SHARE_SIGMA:
            by = percent(float(of_forms[place]))
            return f"the loops depart from the forms of all sources, by {by} of the loss: friction may slip little by little"
        related = np.abs(of_losses[place]) / np.sqrt(of_losses[place, place] * np.diag(of_losses))
        partners = [other for other in range(len(names)) if other != place and related[other] > MIN_CORRELATION_OF_PARTNERS]
        together = sum_by_covariance(of_losses, [place, *partners], losses, names, "J")
        of_sum = np.abs(shifts[:, [place, *partners]] @ together.factors).max() if partners else of_forms[place]
        floor = float(np.hypot(np.hypot(SHAPE_SIGMA, fit.misfit), of_sum))
        together = replace(together, sigma=float(np.hypot(together.sigma, floor * abs(total))))
        known = f"{together}, " if partners and together.sigma < MAX_SHARE_SIGMA * abs(total) else ""
        return f"{known}{_next_loops(fit, place, total)}"

    shares = tuple(share(place) for place in range(len(names)))
    return LossShares(shares, total, fit.loops[fit.largest].words, (*_relaxation_time(fit, shares[-1]), *_remarks(fit)))


def _relaxation_time(fit: _Fit, share: LossShare) -> Iterator[str]:
    """Yield the relaxation time in words if the share of the relaxing material is beyond chance."""
    if fit.widths.relaxation and share.is_separated and share.share > MIN_RELAXING_SIGMA * share.sigma:
        time = float(np.exp(fit.changes[-1])) / fit.widths.relaxation.middle
        sigma = time * float(np.hypot(np.sqrt(fit.covariance[-1, -1]), share.sigma / share.share))
        yield f"{share.name}: one Maxwell branch that relaxes in {uncertain_quantity(time, sigma, 's')}"


def _added(sources: Sequence[Source]) -> Array:
    """Return the matrix that adds the shapes of each source, shape (sources, shapes)."""
    rows = np.eye(len(sources))
    return np.repeat(rows, [len(each.shapes) for each in sources], axis=1)


def _next_loops(fit: _Fit, place: int, total: float) -> str:
    """Return in words the loops that would separate a source, the best one first."""
    weights = np.append((_added(fit.widths.sources)[place] * fit.unit_loss) / abs(total), np.zeros(len(fit.changes)))
    covariance, chosen, options = fit.covariance, list[LossLoop](), [*_planned(fit)]

    def sigma(after: Array) -> float:
        return float(np.hypot(np.sqrt(max(weights @ after @ weights, 0.0)), SHAPE_SIGMA))

    while len(chosen) < MAX_PLANNED_LOOPS and sigma(covariance) > MAX_SHARE_SIGMA:
        loop, rows = min(options, key=lambda option: sigma(_with_rows(covariance, option[1])))
        covariance, chosen = _with_rows(covariance, rows), [*chosen, loop]
    loops = f"{'a loop' if len(chosen) == 1 else 'loops'} of {' and '.join(loop.words for loop in chosen)}"
    return f"{loops} would determine it to ± {percent(sigma(covariance))}"


def _with_rows(covariance: Array, rows: Array) -> Array:
    """Return the covariance after further equations of unit uncertainty, without the inverse of an ill-conditioned one."""
    shared = rows @ covariance
    return np.asarray(covariance - shared.T @ np.linalg.solve(np.eye(len(rows)) + shared @ rows.T, shared))


def _planned(fit: _Fit, input_ratio: float = 0.0) -> Iterator[tuple[LossLoop, Array]]:
    """Yield loops that could be measured, and their equations of amplitudes and changes, as rows of unit uncertainty.

    Loops at the input are among them if some were measured there, or if a ratio is given.
    """
    largest, curve, model = fit.loops[fit.largest], fit.curves[fit.largest], fit.widths
    stiffness = 2.0 * curve.reach / (largest.ends[1] - largest.ends[0])
    rate = largest.speed if largest.is_timed else np.nan
    rates, warmths = PLANNED_RATES if largest.is_timed else (1.0,), PLANNED_WARMTHS if model.lubricants else (0.0,)
    ratios = {0.0, input_ratio, *(each.ratio for each in fit.loops)}
    for ratio, warmer, faster, part in product(sorted(ratios), warmths, rates, PLANNED_REACHES):
        temperature, reach = largest.temperature + warmer, part * curve.reach
        loop = LossLoop.planned(ratio, stiffness, reach, faster * rate, temperature)
        widths = model.of_loop(loop, _Curve(loop.torque, -reach, reach)) / fit.noise
        rows = model.jacobian(widths, loop, fit.amplitudes, fit.changes)
        yield loop, np.asarray(np.linalg.qr(rows, mode="r"))


def _remarks(fit: _Fit) -> Iterator[str]:
    if not any(each.ratio for each in fit.loops):
        yield "no loop was measured at the input: the bearing of the wave generator stands still in all of them"
    elif all(each.ratio for each in fit.loops):
        yield "no loop was measured at the output with the input locked, which alone separates the bearing from the gear"
    if not all(each.is_timed for each in fit.loops):
        yield "the loops have no time, so they are taken for so slow that no friction depends on the rate"
    elif fit.widths.relaxation is None:
        too_few = f"not separable: loops at {MIN_RATES} rates would separate it from viscous friction and a loss factor"
        none = "viscous friction and a loss factor explain the loops at all rates without it"
        yield f"{RELAXING.name}: {too_few if _rates(fit.loops) < MIN_RATES else none}"
    if not fit.widths.lubricants:
        yield "the shares are those at the temperature of the loops, which does not vary or was not measured"
    if fit.misfit > 0.0:
        yield f"the sources leave up to {percent(fit.misfit)} of the width of a loop unexplained, which is part of ±"
