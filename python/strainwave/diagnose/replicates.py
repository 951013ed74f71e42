"""Amplitudes of orders in blocks of a recording: replicates, whose spread contains noise, load, temperature and place.

`order_lines` is the other estimator, with exact statistics: it needs whole revolutions of the shaft, and most blocks of a joint
of a robot are less than one (none of 39 halves of measured joints makes one, their median is 0.25).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import tau

import numpy as np
from numpy.typing import NDArray

from strainwave.diagnose.refusals import JointRecording
from strainwave.diagnose.regression import MAX_SAMPLES
from strainwave.orders.smooth_part import Moving, floor_without, shaft_of
from strainwave.orders.torque_ripple import Ripple
from strainwave.statistics.linear_fit import amplitudes_of, normal_inverse, order_waves, solved
from strainwave.statistics.spectrum import Floor

Array = NDArray[np.float64]

TREND_SPANS = 1.2  # of the range of the angle [1], in the longest period of the load
TREND_HARMONICS = 2  # of this period, in the load
LOAD_RIDGE = 1e-3  # of the squared weight [1]
MIN_CELL_SHARE = 0.05  # of the squared weight of a block: a direction or a load with less has no amplitude
MIN_CELL_PERIODS = 3.0  # periods of an order in a cell
BOTH_DIRECTIONS = (("forward", 1.0), ("backward", -1.0))


@dataclass(frozen=True, eq=False)
class JointMotion:
    """A run evenly in time, with its smooth part taken out.

    Attributes:
        run: the recording
        shaft: its shaft, what drives it, and other joints that move
        step: between two samples [s], or 1 if no time is known
        timed: True if the time is known
    """

    run: JointRecording
    shaft: Moving
    step: float
    timed: bool

    @property
    def travel(self) -> float:
        """Motion to and fro that counts [rad]."""
        return float(np.sum(np.abs(self.shaft.own.speed) * (self.shaft.weight > 0.5)))

    @property
    def span(self) -> float:
        """Revolutions from end to end."""
        return self.shaft.own.revolutions

    @property
    def load(self) -> float:
        """Root mean square of the load in the unit of the column, friction taken out."""
        return float(np.sqrt(np.average(self.shaft.load**2, weights=self.shaft.weight**2 + 1e-300)))


@dataclass(frozen=True)
class Cell:
    """Amplitude of one order in part of a recording.

    Attributes:
        amplitude: in the unit of the column; it contains noise, which adds sigma² to its square in the mean
        sigma: standard deviation of a component of it by noise
        freedom: degrees of freedom of the level of the noise
        speed: mean size of the speed there [rad/s; rad per sample if no time is known]
        load: mean load there, in the unit of the column
        first, last: ends of the range of the angle there [rad]
    """

    amplitude: float
    sigma: float
    freedom: float
    speed: float
    load: float
    first: float
    last: float


def joint_motion(run: JointRecording) -> JointMotion:
    """Return a run with friction over speed, inertia and gravity taken out of its torque or current."""
    record, shaft = shaft_of(
        run.recording, run.column, run.angle, others=run.others, rate=run.rate, per_input=run.per_input, count=MAX_SAMPLES
    )
    if run.side == "input":
        shaft = _without_gravity(shaft)
    shaft = replace(shaft, load=_load(shaft, record.columns[run.column]))
    return JointMotion(run, shaft, record.step if record.timed else 1.0, record.timed)


def _without_gravity(shaft: Moving) -> Moving:
    """Return a shaft of the input whose smooth part has no waves of order 1: these are gravity at the output alone."""
    own = shaft.own.angle
    angles = [own, *(both for other in shaft.shafts[1:] for both in (own + other.angle, own - other.angle))]
    waves = [wave(angle) for angle in angles for wave in (np.sin, np.cos)]
    kept = [column for column in shaft.basis.T if not any(np.array_equal(column, wave) for wave in waves)]
    basis = np.stack(kept, axis=1)
    whole = shaft.series + shaft.smooth
    smooth = basis @ solved(basis * shaft.weight[:, None], whole * shaft.weight)
    return replace(shaft, series=whole - smooth, smooth=smooth, basis=basis)


def _load(shaft: Moving, series: Array) -> Array:
    """Return what of a torque or current varies slowly with the angle, friction and inertia taken out, shape (n,).

    The ridge prefers small parts if the motion does not separate them, as speed and angle of a single sine. A motion of one
    direction does not separate friction from load: both count as load.
    """
    own, weight = shaft.own, shaft.weight
    span = max(float(np.ptp(own.angle)), 1e-12)
    slow = [tau * k / (TREND_SPANS * span) for k in range(1, TREND_HARMONICS + 1)]
    trend = [np.ones_like(own.angle), *order_waves(own.angle - own.angle[0], slow).T]
    others = [own.sense, own.speed / max(float(np.abs(own.speed).max()), 1e-300)] if own.reverses() else []
    others.append(own.acceleration / max(float(np.abs(own.acceleration).max()), 1e-300))
    columns = np.stack([*trend, *others], axis=1) * weight[:, None]
    squares = columns.T @ columns
    ridge = LOAD_RIDGE * float(weight @ weight) * np.eye(len(squares))
    coefficients = np.linalg.solve(squares + ridge, columns.T @ (series * weight))
    return np.asarray(np.stack(trend, axis=1) @ coefficients[: len(trend)])


def blocks_of(motion: JointMotion, travel: float) -> NDArray[np.int_]:
    """Return the number of the block of each sample, for blocks of so much motion [rad], shape (n,).

    A recording of less than one block is one block.
    """
    path = np.cumsum(np.abs(motion.shaft.own.speed) * (motion.shaft.weight > 0.5))
    count = max(int(path[-1] / travel + 1e-9), 1)
    return np.asarray(np.minimum((path / max(path[-1] / count, 1e-300)).astype(int), count - 1))


def cells_of(
    motion: JointMotion, orders: Sequence[float], block: NDArray[np.int_], parts: Sequence[NDArray[np.bool_]] | None = None
) -> list[list[list[Cell | None]]]:
    """Return the amplitude of each order in each part of each block, by least squares over all of them together.

    Series and waves are whitened over the whole recording before they are cut, so that noise at low frequencies does not leak
    into short blocks. Parts of a block are both directions if not given.
    """
    shaft = motion.shaft
    masks = [shaft.own.sense == sign for _, sign in BOTH_DIRECTIONS] if parts is None else list(parts)
    waves = order_waves(shaft.own.angle, orders) * shaft.weight[:, None]
    basis = shaft.basis * shaft.weight[:, None]
    weighted = np.concatenate([waves * mask[:, None] for mask in masks], axis=1)
    # Without what the fit of the smooth part takes of them (Frisch and Waugh): over few revolutions friction over speed
    # follows a slow order near reversals, which would make its amplitude too small.
    weighted = np.asarray(weighted - basis @ solved(basis, weighted))
    series = shaft.series * shaft.weight
    both = np.concatenate([basis, weighted], axis=1)
    floor = floor_without(both, series, shaft.weight)  # waves would raise it where the speed varies
    white, columns = floor.whitened(series), floor.whitened(weighted)
    count = int(block.max(initial=-1)) + 1
    return [_block_cells(motion, orders, masks, block == number, columns, white, floor) for number in range(count)]


def _block_cells(
    motion: JointMotion,
    orders: Sequence[float],
    masks: Sequence[NDArray[np.bool_]],
    inside: NDArray[np.bool_],
    columns: Array,
    white: Array,
    floor: Floor,
) -> list[list[Cell | None]]:
    """Return the cells of one block."""
    shaft = motion.shaft
    weight = shaft.weight**2
    whole = float(weight[inside].sum())
    cells: list[list[Cell | None]] = [[None] * len(orders) for _ in masks]
    used = []
    for part, mask in enumerate(masks):
        here = inside & mask
        if float(weight[here].sum()) < MIN_CELL_SHARE * whole or whole == 0.0:
            continue
        travel = float(np.abs(shaft.own.speed[here]).sum()) / tau
        used += [(part, k) for k, order in enumerate(orders) if travel * order >= MIN_CELL_PERIODS]
    if not used:
        return cells
    places = [2 * (part * len(orders) + k) + half for part, k in used for half in (0, 1)]
    own = columns[inside][:, places]
    amplitudes, _ = amplitudes_of(solved(own, white[inside]))
    sigmas = np.sqrt(np.diag(normal_inverse(own)))
    for place, (part, k) in enumerate(used):
        here = inside & masks[part]
        share = weight[here]
        speed = float(np.average(np.abs(shaft.own.speed[here]), weights=share))
        cells[part][k] = Cell(
            amplitude=float(amplitudes[place]),
            sigma=float(np.hypot(sigmas[2 * place], sigmas[2 * place + 1]) / np.sqrt(2.0)),
            freedom=floor.freedom(orders[k] * speed / tau),
            speed=speed / motion.step,
            load=float(np.average(shaft.load[here], weights=share)),
            first=float(shaft.own.angle[here].min()),
            last=float(shaft.own.angle[here].max()),
        )
    return cells


def gear_lines(found: Ripple) -> list[float]:
    """Return the orders of a blind search that repeat with the angle of the shaft, the strongest evidence first."""
    return [line.order for line in found.lines if line.kind in ("order", "either") and not line.joint]


def apart(orders: Sequence[float], resolution: float) -> tuple[float, ...]:
    """Return the orders without those that lie closer than the resolution to one before them.

    >>> apart([200.0, 100.0, 200.4, 202.0], 1.0)
    (200.0, 100.0, 202.0)
    """
    kept: list[float] = []
    for order in orders:
        if all(abs(order - other) >= resolution for other in kept):
            kept.append(order)
    return tuple(kept)
