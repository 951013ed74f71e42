"""Whether a measurement can be what it is taken for: judged by the gear it starts from, and by physics."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear
from strainwave.files.recording import Recording
from strainwave.files.units import convert
from strainwave.identification.evidence.explain import MISTAKEN
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit

Array = NDArray[np.float64]

APART = 10.0  # gears of one kind differ by less: by a factor of three in friction, by a third in stiffness
SPREAD = 1.3  # by which gears of one kind differ in stiffness, as makers say
NEAR = 4.0  # a mistake explains a factor that it comes as near to as this
MOVING = 0.5  # of what a table leaves unexplained: if acceleration explains more, the table is a log
MIN_RATIO = 2.0  # of a gear: the friction of a joint without one is not compared with that of a gear
FEWEST = 30  # rows of a log; tables of steady friction are shorter, or in no order that acceleration could follow
ELASTIC = 0.2  # of the torque at the ends of a loop: a gear carries more of it by its spring


def doubts_of_table(recording: Recording, found: Fit, start: Gear, side: str | None) -> Iterator[tuple[str, str]]:
    """What speaks against a friction table, each with what to do about it. Of the side only if it was not said."""
    table = found.experiment
    assert isinstance(table, FrictionTable)
    if _is_accelerating(recording, found, abs(start.kinematics.ratio) if side == "output" else 1.0):
        yield (
            "its torque follows the acceleration: this is a log of a moving drive, not a table of steady friction",
            "average the torque over stretches of constant speed, one row for each; or give the log as --log",
        )
        return
    if abs(start.kinematics.ratio) < MIN_RATIO:
        return
    speed = float(np.exp(np.mean(np.log(np.abs(table.speed)))))
    measured, known = found.gear.friction_input.steady(speed), start.friction_input.steady(speed)
    if known <= 0.0 or 1.0 / APART < measured / known < APART:
        return
    factor, ratio = measured / known, abs(start.kinematics.ratio)
    at_joint = measured / ratio / start.friction_input.steady(speed * ratio)
    mistake, rest = _nearest(factor, _wrong_units("torque", recording.unit("torque")))
    what = (
        f"it gives {measured:.3g} N·m at {speed:.3g} rad/s of the input, {_times(factor)} what the gear it starts from has "
        f"({known:.3g} N·m)"
    )
    ends = np.array([np.abs(table.speed).min(), np.abs(table.speed).max()])
    law, known_law = found.gear.friction_input, start.friction_input
    shapes = np.abs(np.log(law.steady(ends) / ratio / known_law.steady(ends * ratio)))
    off = float(shapes.max())  # what the other side would leave unexplained, as a logarithm
    if side == "output":
        yield what, f"if it was measured at the input, leave --side output out; {mistake}see whether units are right"
    elif factor > APART and off < np.log(APART) and off < max(rest, np.log(NEAR)):
        yield (
            f"{what}; taken as measured at the output, it gives {_times(at_joint)} that gear's",
            "if it was measured at the output, say so: --side output; if at the input, --side input",
        )
    else:
        yield what, f"{mistake}see whether the units of both columns are right; if they are, --accept"


def doubts_of_loop(recording: Recording, found: Fit, start: Gear) -> Iterator[tuple[str, str]]:
    """What speaks against a torsion loop, each with what to do about it."""
    loop = found.experiment
    assert isinstance(loop, TorsionLoop)
    half = 0.5 * float(np.ptp(loop.twist))
    largest = 0.5 * float(np.ptp(loop.torque))
    spring = float(found.gear.stiffness.torque(half))
    if not loop.single_branch and spring < ELASTIC * largest:
        yield (
            f"its spring carries {100.0 * spring / largest:.0f} % of the torque at its ends, the rest is friction: this is how "
            "a shaft behaves that turns against friction, not a gear that is twisted",
            "lock one side while the other is loaded; if this is friction over speed, give a friction table",
        )
        return
    measured, known = spring / half, float(start.stiffness.torque(half)) / half
    factor = measured / known
    if not 1.0 / APART < factor < APART:
        squared = start.kinematics.ratio**2
        mistakes = {
            "twist and torque were measured at the input (name them input_angle and input_torque)": 1.0 / squared,
            "input_angle and input_torque were measured at the output (name them twist and torque)": squared,
        }
        torque, angle = ("torque", "twist") if loop.input_ratio is None else ("input_torque", "input_angle")
        mistakes |= _wrong_units("torque", recording.unit(torque))
        mistakes |= {what: 1.0 / size for what, size in _wrong_units("angle", recording.unit(angle)).items()}
        yield (
            f"it gives {measured:.3g} N·m/rad, {_times(factor)} what the gear it starts from has ({known:.3g} N·m/rad)",
            f"{_nearest(factor, mistakes)[0]}see whether sides and units are right; if they are, --accept",
        )


def hint_of_ratio(found: Fit, start: Gear) -> Iterator[str]:
    """That a loop from the input, whose stiffness is not that of the initial model, has it at another ratio."""
    loop = found.experiment
    assert isinstance(loop, TorsionLoop)
    half = 0.5 * float(np.ptp(loop.twist))
    factor = float(found.gear.stiffness.torque(half) / start.stiffness.torque(half))
    if loop.input_ratio is not None and not 1.0 / SPREAD < factor < SPREAD:
        ratio = abs(loop.input_ratio) / np.sqrt(factor)
        yield (
            f"its stiffness is {_times(factor)} that of the set it starts from. Seen from the input, stiffness goes with the "
            f"square of the ratio: with a ratio of {ratio:.0f} it would be that of the set. See whether the ratio is right"
        )


def _is_accelerating(recording: Recording, found: Fit, ratio: float) -> bool:
    """Whether what steady friction leaves unexplained follows the change of speed from row to row.

    `ratio` is the speed of the input over the one recorded.
    """
    speed, torque = ratio * recording.values("speed", "rad/s"), recording.values("torque", "N.m") / ratio
    if len(speed) < FEWEST:
        return False
    load = recording.values("load", "N.m") / ratio if "load" in recording else None
    residual = torque - FrictionTable(speed, torque, load=load).predict(found.gear, (), np.zeros(0))[0][0]
    change = np.gradient(speed)
    columns = np.column_stack((change, np.ones_like(change)))
    rest = residual - columns @ np.linalg.lstsq(columns, residual, rcond=None)[0]
    return bool(np.var(rest) < (1.0 - MOVING) * np.var(residual)) and bool(np.any(np.diff(np.sign(change))))


def _wrong_units(quantity: str, unit: str) -> dict[str, float]:
    """Mistakes in the unit of a quantity, and by how much they make it too large."""
    return {f"the {quantity} is in {other}, not in {unit}": convert(1.0, unit, other) for other in MISTAKEN.get(unit, ())}


def _nearest(factor: float, mistakes: dict[str, float]) -> tuple[str, float]:
    """The mistake that explains a factor best, if one does, and what it leaves unexplained, as a logarithm."""
    distances = {name: abs(float(np.log(factor / size))) for name, size in mistakes.items()}
    name, least = min(distances.items(), key=lambda item: item[1], default=("", np.inf))
    return f"perhaps {name}; " if least < np.log(NEAR) else "", least


def _times(factor: float) -> str:
    return f"{factor:.3g} times" if factor < 100.0 else f"{factor:,.0f} times".replace(",", " ")
