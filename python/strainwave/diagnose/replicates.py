"""Amplitudes of orders in blocks of a recording: replicates, whose spread contains noise, load, temperature and place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import tau

import numpy as np
from numpy.typing import NDArray

from strainwave.diagnose.refusals import JointRecording
from strainwave.files.units import convert
from strainwave.orders.floor import Floor, floor_under
from strainwave.orders.ripple import Ripple
from strainwave.orders.smooth_part import Moving, moving
from strainwave.orders.turning import beginning, evenly, unwrapped

Array = NDArray[np.float64]

MAX_SAMPLES = 2**18  # that are fitted
MIN_CELL_SHARE = 0.05  # of the squared weight of a block: a direction or a load with less has no amplitude
MIN_CELL_PERIODS = 3.0  # periods of an order in a cell
SENSES = (("forward", 1.0), ("backward", -1.0))


@dataclass(frozen=True, eq=False)
class JointMotion:
    """A run evenly in time, with its smooth part taken out.

    Attributes:
        run: the recording
        shaft: its shaft, what drives it, and other joints that move
        floor: noise of the series over its frequencies
        step: between two samples [s], or 1 if no time is known
        timed: True if the time is known
    """

    run: JointRecording
    shaft: Moving
    floor: Floor
    step: float
    timed: bool

    @property
    def travel(self) -> float:
        """JointMotion to and fro that counts [rad]."""
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
        speed: mean size of the speed there [rad/s; rad per sample if no time is known]
        load: mean load there, in the unit of the column
        place: mean angle there [rad]
    """

    amplitude: float
    sigma: float
    speed: float
    load: float
    place: float


def joint_motion(run: JointRecording) -> JointMotion:
    """Return a run with friction over speed, inertia and gravity taken out of its torque or current.

    Raises:
        ValueError: its samples are too few or too uneven
    """
    names = [run.column, run.angle, *run.others.values()]
    record = beginning(evenly(run.recording, names, run.rate), MAX_SAMPLES)
    angles = {name: unwrapped(name, convert(record.columns[name], run.recording.unit(name), "rad")) for name in names[1:]}
    others = {joint: angles[name] for joint, name in run.others.items() if float(np.ptp(angles[name])) > 0.0}
    shaft = moving(angles[run.angle], record.columns[run.column], others, run.per_input)
    weight = np.where(record.measured, shaft.weight, 0.0)
    shaft = Moving(shaft.shafts, shaft.series, shaft.smooth, shaft.load, weight, shaft.outliers)
    return JointMotion(
        run, shaft, floor_under(shaft.series * weight, weight), record.step if record.timed else 1.0, record.timed
    )


def blocks_of(motion: JointMotion, travel: float) -> NDArray[np.int_]:
    """Return the number of the block of each sample, for blocks of so much motion [rad], shape (n,).

    A recording of less than one block is one block.
    """
    path = np.cumsum(np.abs(motion.shaft.own.speed) * (motion.shaft.weight > 0.5))
    count = max(int(path[-1] / travel + 1e-9), 1)
    block: NDArray[np.int_] = np.minimum((path / max(path[-1] / count, 1e-300)).astype(int), count - 1)
    return block


def cells_of(
    motion: JointMotion, orders: Sequence[float], block: NDArray[np.int_], parts: Sequence[NDArray[np.bool_]] | None = None
) -> list[list[list[Cell | None]]]:
    """Return the amplitude of each order in each part of each block, by least squares over all of them together.

    Series and waves are whitened over the whole recording before they are cut, so that noise at low frequencies does not leak
    into short blocks.

    Args:
        motion: the recording
        orders: per revolution of the shaft
        block: number of the block of each sample, shape (n,)
        parts: samples of each part of a block; by default both directions

    Returns:
        cells by block, part and order; None for one with too little motion
    """
    shaft = motion.shaft
    masks = [shaft.own.sense == sign for _, sign in SENSES] if parts is None else list(parts)
    white = motion.floor.whitened(shaft.series * shaft.weight)
    waves = []
    for mask in masks:
        there = np.where(mask, shaft.weight, 0.0)
        for order in orders:
            phase = order * shaft.own.angle
            waves += [motion.floor.whitened(there * np.cos(phase)), motion.floor.whitened(-there * np.sin(phase))]
    columns = np.stack(waves, axis=1)
    return [
        _block_cells(motion, orders, masks, block == number, columns, white) for number in range(int(block.max(initial=-1)) + 1)
    ]


def _block_cells(
    motion: JointMotion,
    orders: Sequence[float],
    masks: Sequence[NDArray[np.bool_]],
    inside: NDArray[np.bool_],
    columns: Array,
    white: Array,
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
    size = np.linalg.norm(own, axis=0)
    size[size == 0.0] = 1.0
    inverse = np.asarray(np.linalg.pinv((own / size).T @ (own / size), rcond=1e-8)) / np.outer(size, size)
    values, sigmas = inverse @ (own.T @ white[inside]), np.sqrt(np.diag(inverse))
    for place, (part, k) in enumerate(used):
        here = inside & masks[part]
        share = weight[here]
        cells[part][k] = Cell(
            amplitude=float(np.hypot(values[2 * place], values[2 * place + 1])),
            sigma=float(np.hypot(sigmas[2 * place], sigmas[2 * place + 1]) / np.sqrt(2.0)),
            speed=float(np.average(np.abs(shaft.own.speed[here]), weights=share)) / motion.step,
            load=float(np.average(shaft.load[here], weights=share)),
            place=float(np.average(shaft.own.angle[here], weights=share)),
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
