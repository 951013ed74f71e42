"""Torque over the angle of a log: a detent, the same in both directions, and dry friction that varies over the turn.

Both are linear in the sine and cosine of their orders, so that a search fits them as terms of the log; `settled` then puts them
into the gear, as `friction.Cyclic` around its friction at the input, whose numbers the last fit estimates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, friction
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.motion_model import INPUT, WITHIN, MotionModel
from strainwave.identification.dynamics.log import ORDERS
from strainwave.identification.experiments.motion_log import MotionLog, per_torque, turnover_speed
from strainwave.statistics.linear_fit import linear_fit, own_share, solved
from strainwave.statistics.residuals import chance_of_gain, correlation_length
from strainwave.statistics.student import SIGNIFICANCE_SIGMA

Array = NDArray[np.float64]

INPUT_ORDERS = (1.0, 2.0, 3.0, 4.0)  # of the input's turn
OUTPUT_ORDERS = (1.0, 2.0)  # of the output's turn
MIN_INPUT_TURNS = 2.0  # of a record that separates a wave over the input's turn from what varies over the output's
MIN_OUTPUT_TURNS = 3.0  # the same over the output's turn
MIN_OWN_SHARE = 0.5  # of a wave, that no other term of the model makes up [1]
MIN_PASSED_SHARE = 0.3  # of the size of a wave, that the pass band leaves [1]
MIN_SIZE = 0.05  # of the largest wave: turning over at a reversal makes smaller ones of it
MIN_FAST_SIZE = 0.1  # of the largest wave that the full band alone shows
FAST_BIAS = 0.05  # of a wave in the full band: what numbers by the pass band and a smoothed angle make of it (assumed)
MAX_CHANCE = 1e-3  # probability with which noise alone makes as large a wave at any of the orders
MAX_DEPTH = 0.95  # of dry friction, that its waves take in all: friction stays positive


@dataclass(frozen=True, order=True)
class Wave:
    """A torque over the angle of the input.

    Attributes:
        kind: "detent", the same in both directions of motion, or "friction", against the motion
        order: periods per turn of the input
    """

    kind: Literal["detent", "friction"]
    order: float

    def columns(self, log: MotionLog) -> Array:
        """Return its sine and cosine at every instant of the grid [1], shape (2, m)."""
        motion = log.motion
        sense = np.tanh(motion.speed / turnover_speed(motion.speed)) if self.kind == "friction" else 1.0
        phase = self.order * motion.angle
        return np.stack([sense * np.sin(phase), sense * np.cos(phase)])

    @property
    def names(self) -> tuple[str, str]:
        """Names of its sine and cosine among the waves of a log."""
        return f"sine of {self.kind} {self.order:.12g}", f"cosine of {self.kind} {self.order:.12g}"


def with_ripple(model: MotionModel) -> MotionModel | None:
    """Return the model with the waves over the angle that its residual contains beyond chance; None if there are none.

    Waves are added one by one, each time the one that explains most of the rest. A wave that other terms make up, or that the
    pass band does not contain, is not separable and takes no part.
    """
    if model.log.waves:
        return None
    log, scale = model.log, per_torque(model.drive, model.log.effort)
    starts = np.array([each.start for each in log.nuisances])
    numbers = [place for place, path in enumerate(model.paths) if path in model.free]
    predicted, slopes = log.predict(model.drive, numbers, starts)
    base, left = slopes[:, 0].T, (log.measured - predicted)[0]
    chosen = dict[Wave, Array]()
    series = {wave: scale * wave.columns(log) for wave in _possible(log, model.drive.gear.kinematics.ratio)}
    passed = {wave: log.motion.filtered(each).T for wave, each in series.items()}
    rows = log.motion.rows
    passed = {
        wave: each
        for wave, each in passed.items()
        if np.linalg.norm(each) > MIN_PASSED_SHARE * np.linalg.norm(series[wave][:, rows])
    }
    while True:
        columns = np.column_stack([base, *chosen.values()])
        rest = left - columns @ solved(columns, left)
        best = _most_explaining(columns, left, {wave: each for wave, each in passed.items() if wave not in chosen})
        if best is None:
            break
        wave, still = best
        freedom = (len(left) - columns.shape[1] - 2) / correlation_length(still)
        if len(series) * chance_of_gain(float(rest @ rest), float(still @ still), 2, freedom) > MAX_CHANCE:
            break
        chosen[wave] = passed[wave]
    if not chosen:
        return None
    sizes = np.hypot(*_sizes(base, chosen, left).reshape(-1, 2).T)
    chosen = {wave: each for (wave, each), size in zip(chosen.items(), sizes, strict=True) if size > MIN_SIZE * sizes.max()}
    chosen = dict(sorted(chosen.items(), key=lambda item: item[0]))
    waves, found = list(chosen), _sizes(base, chosen, left)
    named = {name: row for wave in waves for name, row in zip(wave.names, series[wave], strict=True)}
    before = {each.name: each.start for each in log.nuisances} | dict(zip(named, found.tolist(), strict=True))
    rippled = log.with_waves(named)
    return replace(
        model, name=f"{model.name}, {_in_words(waves)}", log=rippled.starting([before[each.name] for each in rippled.nuisances])
    )


def _sizes(base: Array, waves: Mapping[Wave, Array], left: Array) -> Array:
    """Return the sizes of sine and cosine of waves besides other terms [N.m], shape (2 * waves,)."""
    return solved(np.column_stack([base, *waves.values()]), left)[base.shape[1] :]


def _possible(log: MotionLog, ratio: float) -> Iterator[Wave]:
    """Yield the waves whose turn the record contains often enough; of a detent over the output's turn, gravity is the first."""
    moved = np.ptp(log.motion.angle[log.motion.rows]) / (2.0 * np.pi)
    if moved >= MIN_INPUT_TURNS:
        for order in INPUT_ORDERS:
            yield Wave("detent", order)
            if log.both_ways:
                yield Wave("friction", order)
    if moved >= MIN_OUTPUT_TURNS * abs(ratio):
        for order in OUTPUT_ORDERS:
            yield Wave("detent", order / abs(ratio))
            if log.both_ways:
                yield Wave("friction", order / abs(ratio))


def _most_explaining(columns: Array, left: Array, waves: Mapping[Wave, Array]) -> tuple[Wave, Array] | None:
    """Return the wave that leaves least of a residual beside the columns of a model, and that rest; None if none is left."""
    found = list[tuple[float, Wave, Array]]()
    for wave, pair in waves.items():
        if own_share(pair, columns).min() < MIN_OWN_SHARE:
            continue
        both = np.column_stack([columns, pair])
        rest = left - both @ solved(both, left)
        found.append((float(rest @ rest), wave, rest))
    if not found:
        return None
    _, wave, rest = min(found, key=lambda each: each[:2])
    return wave, rest


def _in_words(waves: Sequence[Wave]) -> str:
    """Return what was added to a model."""
    names = {"detent": "a detent", "friction": "friction over the angle"}
    return " and ".join(names[kind] for kind in names if any(wave.kind == kind for wave in waves))


@dataclass(frozen=True, eq=False)
class FastDetent(ComparedByFields):
    """A detent at orders that the pass band of a log does not contain, by what a model leaves in the full band.

    Attributes:
        orders: periods per turn of the input, shape (k,)
        sizes: of the sine and, imaginary, of the cosine of the angle of the input [N.m], shape (k,)
        sigmas: standard deviation of each size [N.m], shape (k,)
    """

    orders: Array
    sizes: NDArray[np.complex128]
    sigmas: Array

    @classmethod
    def of(cls, log: MotionLog, drive: Drive, residual: Array, rows: NDArray[np.bool_]) -> FastDetent:
        """Return the detent that samples show, at orders that are no waves of the log, beside friction over the angle.

        Args:
            log: with the motion
            drive: by which the effort rests on the torque
            residual: measured less predicted effort, shape (m,)
            rows: the samples, shape (m,)
        """
        known = {wave.order for wave in waves_of(log) if wave.kind == "detent"}
        orders = [order for order in ORDERS if order not in known]
        waves = [Wave("detent", order) for order in orders] + [Wave("friction", order) for order in orders]
        columns = np.concatenate([wave.columns(log) for wave in waves])[:, rows].T
        found = linear_fit(per_torque(drive, log.effort) * columns, residual[rows])
        own = (each[: 2 * len(orders)].reshape(-1, 2) for each in (found.values, found.sigma, found.own_share))
        pairs, sigmas, shares = own
        sizes = pairs[:, 0] + 1j * pairs[:, 1]
        sigma = np.hypot(sigmas.max(axis=1), FAST_BIAS * np.abs(sizes))
        return cls(np.array(orders), sizes, np.where(shares.min(axis=1) > MIN_OWN_SHARE, sigma, np.inf))

    def significant(self) -> FastDetent:
        """Return the same without waves that chance makes as large."""
        sizes = np.abs(self.sizes)
        shown = (sizes > SIGNIFICANCE_SIGMA * self.sigmas) & (sizes > MIN_FAST_SIZE * sizes.max(initial=0.0))
        return FastDetent(self.orders[shown], self.sizes[shown], self.sigmas[shown])

    def among(self, orders: Array) -> FastDetent:
        """Return the same at some of its orders."""
        shown = np.isin(self.orders, orders)
        return FastDetent(self.orders[shown], self.sizes[shown], self.sigmas[shown])

    def added_to(self, model: MotionModel) -> MotionModel:
        """Return a model with this detent in its gear, as a number that is known."""
        law: Any = model.drive.gear.friction_input
        outer = law if isinstance(law, friction.Cyclic) else friction.Cyclic(law=law, viscous_share=0.0)
        whole = outer.replace(
            detent_order=[*outer.detent_order, *self.orders.tolist()],
            detent_torque=[*outer.detent_torque, *np.abs(self.sizes).tolist()],
            detent_phase=[*outer.detent_phase, *np.angle(self.sizes).tolist()],
        )
        drive = model.drive.replace(gear=model.drive.gear.replace(friction_input=whole))
        if outer is law:
            return replace(model, drive=drive)
        ties = {_within(path): _within(other) for path, other in model.ties.items()}
        return replace(model, drive=drive, free=tuple(map(_within, model.free)), ties=ties)

    def estimates(self, model: MotionModel) -> Iterator[tuple[str, str, float, float]]:
        """Yield path, unit, value and standard deviation of its numbers in a model that has them."""
        places = list(sliding_detents(model))
        for order, size, sigma in zip(self.orders.tolist(), self.sizes.tolist(), self.sigmas.tolist(), strict=True):
            place = places.index(order)
            yield f"{INPUT}detent_torque[{place}]", "N.m", abs(size), sigma
            yield f"{INPUT}detent_phase[{place}]", "rad", float(np.angle(size)), sigma / abs(size)


def sliding_detents(model: MotionModel) -> Sequence[float]:
    """Return the orders of the detent in the gear of a model."""
    law: Any = model.drive.gear.friction_input
    return tuple(law.detent_order) if isinstance(law, friction.Cyclic) else ()


def settled(model: MotionModel) -> MotionModel:
    """Return the model with the waves of its log in the gear; the same if it has none."""
    values = {each.name: each.start for each in model.log.nuisances}
    sizes, law = sizes_of_waves(model.log), model.law
    if not sizes:
        return model
    lists, free = dict[str, list[float]](), list[str]()
    for kind, names, unit in (
        ("friction", ("order", "amplitude", "phase"), law.coulomb),
        ("detent", ("detent_order", "detent_torque", "detent_phase"), 1.0),
    ):
        own = [(wave.order, abs(size) / unit, float(np.angle(size))) for wave, size in sizes.items() if wave.kind == kind]
        lists |= {name: [each[place] for each in own] for place, name in enumerate(names)}
        free += [f"{INPUT}{name}[{place}]" for name in names[1:] for place in range(len(own))]
    cyclic = friction.Cyclic(law=law, viscous_share=0.0, **lists)
    log = model.log.with_waves({})
    return replace(
        model,
        log=log.starting([values[each.name] for each in log.nuisances]),
        drive=model.drive.replace(gear=model.drive.gear.replace(friction_input=cyclic)),
        free=(*map(_within, model.free), *free),
        ties={_within(path): _within(other) for path, other in model.ties.items()},
    )


def sizes_of_waves(log: MotionLog) -> dict[Wave, complex]:
    """Return the size of sine and cosine of each wave of a log [N.m]."""
    values = {each.name: each.start for each in log.nuisances}
    return {wave: complex(*(values[name] for name in wave.names)) for wave in waves_of(log)}


def is_passive(log: MotionLog, coulomb: float) -> bool:
    """True if friction opposes the motion at every angle, with the waves of a log about a dry level [N.m]."""
    return sum(abs(size) for wave, size in sizes_of_waves(log).items() if wave.kind == "friction") <= MAX_DEPTH * coulomb


def _within(path: str) -> str:
    """Return the path of a number of the friction at the input that now stands inside another law."""
    return path.replace(INPUT, WITHIN) if path.startswith(INPUT) else path


def waves_of(log: MotionLog) -> Iterator[Wave]:
    """Yield the waves among the terms of a log."""
    for name in log.waves:
        quadrature, _, rest = name.partition(" of ")
        kind, _, order = rest.partition(" ")
        if quadrature == "sine":
            yield Wave("detent" if kind == "detent" else "friction", float(order))
