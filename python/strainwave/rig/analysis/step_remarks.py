"""Remarks on the steps of a loop: gaps, steps that go back, and steps that stand out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave.rig.loop import Loop

MIN_ALIKE_SHARE = 0.6  # share of the steps of torque that must be alike before another is called a gap [1]
MIN_GAP_RATIO = 1.5  # a longer step is a gap, in usual steps [1]
MAX_GAPS_SHOWN = 4  # gaps that a remark lists
MAX_BACKWARD_SHARE = 0.1  # share of the steps that go back [1]; beyond it, sorted points may be those of two branches


class Quarter(Protocol):
    """A regime, as far as it is spoken of."""

    @property
    def name(self) -> str: ...
    @property
    def torque(self) -> NDArray[np.float64]: ...
    @property
    def from_zero(self) -> bool: ...


def remarks_on_steps(loop: Loop, turns: Iterable[int], regimes: Sequence[Quarter], names: Sequence[str]) -> Iterator[str]:
    """Points that may be sorted, smaller loops on the way, steps left out, and regimes that are missing or begin late.

    Args:
        loop: the loop
        turns: rows where a smaller loop begins
        regimes: those measured
        names: of all regimes of a cycle
    """
    yield from _of_sorted(loop)
    yield from (_of_turn(loop, turn) for turn in turns)
    yield from _of_gaps(loop)
    found = [regime.name for regime in regimes]
    if missing := [name.replace("_", " ") for name in names if name not in found]:
        yield f"not measured from zero torque to the peak: {', '.join(missing)}"
    yield from (_of_late(regime) for regime in regimes if not regime.from_zero)


def runs_one_way(values: NDArray[np.float64]) -> bool:
    """True if a series never falls, or never rises."""
    steps = np.diff(values)
    return bool(np.all(steps >= 0.0) or np.all(steps <= 0.0))


def _of_sorted(loop: Loop) -> Iterator[str]:
    """Points in the order of their angle or torque: one way by itself, or a whole loop that somebody has sorted."""
    for name, other, values in (("angle", "torque", loop.torque), ("torque", "angle", loop.angle)):
        sense = np.sign(values[-1] - values[0])
        if runs_one_way(getattr(loop, name)) and np.mean(sense * np.diff(values) < 0.0) > MAX_BACKWARD_SHARE:
            yield (
                f"the {name} goes one way through all points while the {other} goes to and fro: if the file holds a whole "
                f"loop, it was sorted by {name}, and its branches are mixed; put the points in the order measured"
            )


def _of_turn(loop: Loop, turn: int) -> str:
    return (
        f"the torque turns back at point {turn + 1} ({loop.torque[turn]:.4g} N.m) before the peak; what lies on that smaller "
        "loop is in no regime"
    )


def _of_gaps(loop: Loop) -> Iterator[str]:
    """Steps of torque that are a multiple of the usual one."""
    steps = np.abs(np.diff(loop.torque))
    usual = float(np.median(steps))
    alike = np.abs(steps - usual) < 0.05 * usual
    if usual == 0.0 or np.mean(alike) < MIN_ALIKE_SHARE:
        return
    rows = np.flatnonzero(steps > MIN_GAP_RATIO * usual).tolist()
    if not rows:
        return
    listed = ", ".join(f"{row + 1} and {row + 2} by {steps[row]:.4g} N.m" for row in rows[:MAX_GAPS_SHOWN])
    more = f" and {len(rows) - MAX_GAPS_SHOWN} more" if len(rows) > MAX_GAPS_SHOWN else ""
    yield (
        f"the torque changes between points {listed}{more}, and by {usual:.4g} N.m as a rule: steps were left out, or "
        "not recorded. Values between are taken on a straight line"
    )


def _of_late(regime: Quarter) -> str:
    least = float(np.abs(regime.torque).min())
    return f"{regime.name.replace('_', ' ')} is measured from {least:.3g} N.m on: it has no secant from zero torque"
