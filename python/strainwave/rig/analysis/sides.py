"""A loop seen from the other shaft, and without the friction of the wave generator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave._core import Gear
from strainwave.files.recording import Recording
from strainwave.identification.candidates.friction import fit_friction
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.rig.analysis.regimes import segment
from strainwave.rig.bench.setup import Value
from strainwave.rig.loop import COLUMNS, Loop, Side, signed

Array = NDArray[np.float64]


def referred(loop: Loop, ratio: float, side: Side) -> Loop:
    """Return a loop referred to the other shaft by the ratio, as that of an ideal gear.

    With a ratio i = input over output, angles are divided by it towards the output, torques multiplied, and so stiffness is
    multiplied by i squared. A negative ratio turns both signs: what loads the input positively loads the output negatively.
    Friction of the wave generator stays in the loop, i times as large at the output.

    Args:
        loop: the loop
        ratio: of the gear, as `gear.kinematics.ratio`, not 0
        side: the shaft to refer it to

    Raises:
        ValueError: the ratio is 0 or not finite, or `side` is no shaft

    >>> at_input = Loop([0.0, 0.5, 0.0], [0.0, 0.2, 0.1], side="input", name="example")
    >>> at_output = referred(at_input, 100.0, "output")
    >>> at_output.angle.tolist(), at_output.torque.tolist()
    ([0.0, 0.005, 0.0], [0.0, 20.0, 10.0])
    """
    arguments.one_of("side", side, COLUMNS)
    if signed("ratio", ratio) == 0.0:
        raise ValueError("ratio = 0 must not be zero: it is the turns of the input for one of the output")
    if side == loop.side:
        return loop
    i = ratio if side == "output" else 1.0 / ratio
    size = abs(i)
    return replace(
        loop,
        angle=loop.angle / i,
        torque=loop.torque * i,
        side=side,
        angle_sigma=loop.angle_sigma / size,
        torque_sigma=loop.torque_sigma * size,
        friction_sigma=loop.friction_sigma * size,
        compliance_sigma=loop.compliance_sigma / size**2,
        corrections=(*loop.corrections, f"measured at the {loop.side}, referred to the {side} by the ratio {ratio:g}"),
    )


def without_friction(loop: Loop, friction: Value) -> Loop:
    """Return a loop from the input without the friction of the wave generator, which another measurement determined.

    At a reversal friction turns over before the gear is unloaded: the torque on the gear follows that of the shaft with a play
    of the friction either way. A loop that closes is run twice, so that it begins as it ends.

    Args:
        loop: measured at the input
        friction: torque at rest, of the size that opposes motion either way [N.m], as `friction_at_rest` gives it

    Raises:
        ValueError: the loop is of the output, where a torque moves no wave generator; or friction holds all of its torque

    >>> loop = Loop([3.0, 3.0, -3.0, -3.0, 3.0], [1.1, 0.9, -1.1, -0.9, 1.1], side="input", name="example")
    >>> without_friction(loop, Value(0.1)).torque.round(9).tolist()
    [1.0, 1.0, -1.0, -1.0, 1.0]
    """
    if loop.side != "input":
        raise ValueError(f"{loop.name}: a loop from the output holds no friction of the wave generator; its input was held")
    held = arguments.number("friction", friction.value, "N.m", brackets="[)", low=0.0)
    if 2.0 * held >= np.ptp(loop.torque):
        raise ValueError(
            f"{loop.name}: friction of ±{held:g} N.m holds all of the loop's torque, {loop.torque.min():g} to "
            f"{loop.torque.max():g} N.m; is it that of the input?"
        )
    start = float(loop.torque[0]) - held * (1.0 if loop.torque[-1] > loop.torque[len(loop) // 2] else -1.0)
    torque = _behind_play(loop.torque, held, start)
    if segment(loop).closed:
        torque = _behind_play(loop.torque, held, float(torque[-1]))
    correction = f"friction of the wave generator, ±{held:.3g} N.m at the input, is subtracted"
    return replace(
        loop,
        torque=torque,
        friction_sigma=float(np.hypot(loop.friction_sigma, friction.sigma)),
        input_friction=False,
        corrections=(*loop.corrections, f"{correction} ({friction.source})" if friction.source else correction),
    )


def _behind_play(torque: Array, half: float, start: float) -> Array:
    """Return the torque behind a play: it changes only if it differs by more than half the play."""
    followed, last = np.empty_like(torque), start
    for i, value in enumerate(torque.tolist()):
        last = followed[i] = min(max(last, value - half), value + half)
    return followed


def friction_at_rest(table: Recording, gear: Gear) -> Value:
    """Return the friction of the input at rest [N.m], from a table of torque over speed.

    The law of the gear's input friction is fitted to the table; its breakaway counts, or, where the table shows no fall of the
    torque at low speed, Coulomb's torque.

    Args:
        table: columns speed and torque of the input
        gear: the gear whose law is fitted

    Raises:
        ValueError: as `strainwave.identify` for a friction table

    >>> import strainwave as sw
    >>> speed = [1.0, 2.0, 5.0, 10.0, 20.0]
    >>> table = sw.Recording({"speed": speed, "torque": [0.05 + 1e-3 * v for v in speed]}, {"speed": "rad/s", "torque": "N.m"})
    >>> round(friction_at_rest(table, sw.load("hfuc-25-100")).value, 6)
    0.05
    """
    best = fit_friction(FrictionTable.of(table), arguments.gear(gear))[0]
    by_name = {estimate.path.rpartition(".")[2]: estimate for estimate in best.fit.estimates}
    found = by_name.get("breakaway") or by_name.get("coulomb") or best.fit.estimates[0]
    return Value(found.value, found.sigma, f"friction table {table.title}".strip())
