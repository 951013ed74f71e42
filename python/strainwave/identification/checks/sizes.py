"""Checks of one file: its sizes against the start set and against the limits of gears; likely mistakes in a unit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.files.units import convert
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.results.file_result import Check, FileEstimate
from strainwave.messages import as_option
from strainwave.statistics.linear_fit import solved
from strainwave.statistics.runs import runs_of

Array = NDArray[np.float64]

MIN_RATIO = 2.0  # of a gear: the friction of a joint without one is not compared with that of a gear
MAX_RATIO = 1e4  # of a gear
MAX_FACTOR = 10.0  # gears of one kind differ by less: by a factor of three in friction, by a third in stiffness
MAX_FACTOR_OF_LOG = 50.0  # the start set is a guess, and data held out judge a log; but wrong units or sides make more
MIN_FACTOR_OF_LOG = 1e-6  # no wrong unit makes less: a fit that ends with less has found no friction
STIFFNESS_SPREAD = 1.3  # factor by which gears of one kind differ in stiffness, as makers state
MIN_SPREAD_OF_STIFFNESS = 0.3  # standard deviation of its logarithm, as makers state it
MAX_SHARE_BY_ACCELERATION = 0.5  # of what steady friction leaves unexplained: if acceleration explains more, it is a log
MIN_ROWS_OF_LOG = 30  # tables of steady friction are shorter, or in no order that acceleration could follow
MAX_FRICTION_SHARE = 0.8  # of the torque at the ends of a loop: a twisted gear carries more than the rest by its spring
MAX_CLIPPED_SHARE = 0.05  # of the range of the angle, over which a torque stays at the end of its range
MIN_CLIPPED_SAMPLES = 5
MAX_SHARE_OF_ONE_SIZE = 0.9  # of the torques of a table
SIZE_TOLERANCE = 1e-6  # relative: torques that differ by less have one size
END_TOLERANCE = 1e-9  # relative: torques that differ by less are at the end of the range
REST_SPEED = 0.01  # rad/s of the input, at which friction is that of a shaft about to slide
MAX_INPUT_SPEED = 1600.0  # rad/s, 15 000 1/min: makers allow 14 000 1/min to the smallest gears, and less to others
MAX_FACTOR_LEFT = 4.0  # a mistake explains a factor if it leaves a smaller one
# What the header of a column may name wrongly, and what it may be.
MISTAKEN_UNITS = {
    "rad": ("deg", "rev", "arcmin"), "deg": ("rad", "rev", "arcmin"), "rad/s": ("rpm", "deg/s"), "rpm": ("rad/s",),
    "deg/s": ("rad/s",), "N.m": ("mN.m", "N.cm"), "mN.m": ("N.m",), "A": ("mA",), "V": ("mV",),
}  # fmt: skip


def input_speed(speed: Array, source: str) -> Check:
    """Return the check that the input turns no faster than gears of this kind may."""
    fastest = float(np.quantile(np.abs(speed), 0.99))
    return Check(
        "input speed", source, fastest, MAX_INPUT_SPEED, "rad/s", fastest > MAX_INPUT_SPEED,
        f"its input would turn at {fastest:.4g} rad/s, {fastest * 30.0 / np.pi:.0f} 1/min, faster than strain wave gears may",
        "speeds may be in 1/min, not in rad/s, or angles in degrees; see whether units, side and ratio are right",
    )  # fmt: skip


# ---- Friction --------------------------------------------------------------------------------------------------------


def friction_level(
    law: Any, start: Any, speed: float, source: str, remedy: str, max_factor: float = MAX_FACTOR
) -> Check | None:
    """Return the check that friction is of the size of that of the start set; None if the set has none.

    Args:
        law: fitted
        start: law of the start set
        speed: of the input, at which both are compared [rad/s]
        source: name of the file
        remedy: what to check first
        max_factor: by which both may differ
    """
    fitted, before = float(law.steady(speed)), float(start.steady(speed))
    if before <= 0.0 or not fitted > 0.0:
        return None
    factor = fitted / before
    return Check(
        "friction of the start set", source, max(factor, 1.0 / factor), max_factor, "1",
        not 1.0 / max_factor < factor < max_factor,
        f"its friction is {fitted:.3g} N·m at {speed:.3g} rad/s of the input, {times(factor)} that of the start set "
        f"({before:.3g} N·m)",
        remedy,
    )  # fmt: skip


def opposes_motion(at_speeds: Iterable[FileEstimate], source: str) -> Iterator[Check]:
    """Yield the check that friction at each speed opposes the motion: a torque that drives it is none."""
    for each in at_speeds:
        yield Check(
            "friction against the motion", source, -each.value, 0.0, each.unit, each.value < 0.0,
            f"{each.label} would be {each.value:.4g} {each.unit}: a torque that drives the motion",
            "see whether torque and speed are counted in one sense, and whether gravity or a load is in the torque; record "
            "both directions",
        )  # fmt: skip


def friction_at_rest(torque: float, start: Gear, source: str) -> Iterator[Check]:
    """Yield the check that a torque at which the input still rests is no more than friction of the start set may hold.

    Args:
        torque: at the input, at which it does not slide yet [N.m]
        start: the gear of the start set
        source: name of the file
    """
    law: Any = start.friction_input
    held = float(law.hold(1.0)) if hasattr(law, "hold") else float(law.steady(REST_SPEED))
    if abs(start.kinematics.ratio) < MIN_RATIO or held <= 0.0:
        return
    factor = torque / held
    yield Check(
        "friction at rest", source, factor, MAX_FACTOR, "1", factor > MAX_FACTOR,
        f"its input would rest against {torque:.3g} N·m, {times(factor)} the friction of the start set ({held:.3g} N·m)",
        "see whether units and side are right; if the other side of the gear was locked, it is a torsion loop: --kind torsion",
    )  # fmt: skip


def friction_of_table(recording: Recording, found: Fit, start: Gear, side: str | None, source: str) -> Iterator[Check]:
    """Yield the checks of a friction table: that it is none of a moving drive, and the size of its friction.

    Args:
        recording: the table as it was read
        found: the fit
        start: the gear of the start set
        side: at which it was measured, if a person or the names of its columns state it
        source: name of the file
    """
    table, ratio = found.experiment, abs(start.kinematics.ratio)
    assert isinstance(table, FrictionTable)
    yield (accelerating := _acceleration(recording, found, ratio if side == "output" else 1.0, source))
    if accelerating.failed or side == "input" or ratio < MIN_RATIO:
        return
    speed = float(np.exp(np.mean(np.log(np.abs(table.speed)))))
    law, law_of_set = found.gear.friction_input, start.friction_input
    check = friction_level(law, law_of_set, speed, source, "")
    if check is None:
        return
    factor = law.steady(speed) / law_of_set.steady(speed)
    mistake, rest = nearest(factor, wrong_units("torque", recording.unit("torque")))
    remedy = f"{mistake}see whether the units of both columns are right"
    if side == "output":
        remedy = f"if it was measured at the input, give --side input; {mistake}see whether units are right"
    elif factor > MAX_FACTOR:
        ends = np.array([np.abs(table.speed).min(), np.abs(table.speed).max()])  # were it measured at the output
        off = np.abs(np.log(np.maximum(law.steady(ends) / ratio / law_of_set.steady(ends * ratio), 1e-300))).max()
        if off < min(np.log(MAX_FACTOR), max(rest, np.log(MAX_FACTOR_LEFT))):
            at_joint = law.steady(speed) / ratio / law_of_set.steady(speed * ratio)
            remedy = (
                f"taken as measured at the output, it gives {times(at_joint)} the friction of the set: if it was measured "
                "there, give --side output; if at the input, --side input"
            )
    yield Check(**vars(check) | {"remedy": remedy})


def friction_of_log(
    law: Any, start: Any, speeds: Array, effort: str, source: str, *, ratio: float, column: str = "NAME", constant: float = 0.0
) -> Iterator[Check]:
    """Yield the check of the size of the friction of a log; none without friction, or without a gear to compare it with.

    Args:
        law: fitted
        start: law of the start set
        speeds: of the input while it was measured [rad/s]
        effort: the channel of the torque
        source: name of the file
        ratio: of the gear, by which friction differs if the torque is counted at the other side
        column: name of the torque in the file
        constant: that a person gave of the motor [N.m/A]; 0 if none
    """
    speed = float(np.median(np.abs(speeds[speeds != 0.0]))) if np.any(speeds != 0.0) else 0.0
    fitted, before = float(law.steady(speed)), float(start.steady(speed))
    if speed <= 0.0 or before <= 0.0 or fitted < MIN_FACTOR_OF_LOG * before or abs(ratio) < MIN_RATIO:
        return
    factor = fitted / before
    unit = {"current": "mA and A", "voltage": "mV and V"}.get(effort, "mN·m and N·m")
    if effort == "current" and constant:
        constant *= 1e-3 if factor > 1.0 else 1e3
        unit += f", or between mN·m/A and N·m/A (--constant torque_constant={constant:.6g})"
    near_thousand = abs(abs(np.log(factor)) - np.log(1000.0)) < np.log(MAX_FACTOR_LEFT)
    mistake = f"a factor of 1000 lies between {unit}; " if near_thousand else _other_side(factor, effort, abs(ratio), column)
    remedy = f"{mistake}see whether units, side, ratio and torque constant are right, or start from a set like this gear"
    if (check := friction_level(law, start, speed, source, remedy, MAX_FACTOR_OF_LOG)) is not None:
        yield check


def _other_side(factor: float, effort: str, ratio: float, column: str) -> str:
    """Return the option to give if friction has the size of the start set with the torque counted at the other side."""
    other, there = {"joint_torque": ("input", factor * ratio), "input_torque": ("joint", factor / ratio)}.get(effort, ("", 0.0))
    if not other or 1.0 / MAX_FACTOR < factor < MAX_FACTOR or abs(np.log(max(there, 1e-300))) >= abs(np.log(factor)):
        return ""
    shaft = "motor" if other == "input" else "joint"
    option = as_option("column", f"{other}_torque", column)
    return f"counted at the {shaft}, its torque gives {times(there)} the friction of the set: if it is, give {option}; "


def _acceleration(recording: Recording, found: Fit, ratio: float, source: str) -> Check:
    """Return the check that the residuals of steady friction do not follow the change of speed from row to row.

    `ratio` is the speed of the input over the one recorded.
    """
    speed, torque = ratio * recording.values("speed", "rad/s"), recording.values("torque", "N.m") / ratio
    share = 0.0
    if len(speed) >= MIN_ROWS_OF_LOG:
        load = recording.values("load", "N.m") / ratio if "load" in recording else None
        residual = torque - FrictionTable(speed, torque, load=load).predict(found.gear, (), np.zeros(0))[0][0]
        change = np.gradient(speed)
        columns = np.column_stack((change, np.ones_like(change)))
        rest = residual - columns @ solved(columns, residual)
        if np.any(np.diff(np.sign(change))) and np.var(residual) > 0.0:
            share = 1.0 - float(np.var(rest) / np.var(residual))
    return Check(
        "acceleration in a friction table", source, share, MAX_SHARE_BY_ACCELERATION, "1", share > MAX_SHARE_BY_ACCELERATION,
        "its torque follows the acceleration: this is a log of a moving drive, not a table of steady friction",
        "average the torque over stretches of constant speed, one row for each; or give its time, as a log",
    )  # fmt: skip


# ---- Torsion ---------------------------------------------------------------------------------------------------------


def clipping(recording: Recording, source: str) -> Check:
    """Return the check that the torque of a loop does not stay at the end of its range while the twist goes on."""
    angle, torque = ("twist", "torque") if "twist" in recording else ("input_angle", "input_torque")
    path, values, unit = recording[angle], recording[torque], recording.unit(torque)
    share, message = 0.0, ""
    for end in (values.max(), values.min()):
        for clipped in runs_of(np.abs(values - end) <= END_TOLERANCE * abs(end), MIN_CLIPPED_SAMPLES):
            moved = float(np.ptp(path[clipped]) / max(np.ptp(path), 1e-300))
            if moved > share:
                share = moved
                message = (
                    f"{torque} stays at {end:.4g} {unit} for {clipped.stop - clipped.start} samples while {angle} goes on by "
                    f"{100.0 * moved:.0f} % of its range: the sensor or the amplifier is at its limit"
                )
    return Check(
        "torque at its limit", source, share, MAX_CLIPPED_SHARE, "1", share > MAX_CLIPPED_SHARE, message,
        "record with a larger range, or twist less far",
    )  # fmt: skip


def stiffness_of_loop(recording: Recording, found: Fit, start: GearSet, source: str) -> Iterator[Check]:
    """Yield the checks of a torsion loop: that a spring carries most of its torque, and the size of its stiffness."""
    loop = found.experiment
    assert isinstance(loop, TorsionLoop)
    half, largest = 0.5 * float(np.ptp(loop.twist)), 0.5 * float(np.ptp(loop.torque))
    spring = float(found.gear.stiffness.torque(half))
    if not loop.single_branch:
        carried = spring / max(largest, 1e-300)
        share = 1.0 - carried
        yield Check(
            "friction in a torsion loop", source, share, MAX_FRICTION_SHARE, "1", share > MAX_FRICTION_SHARE,
            f"its spring carries {100.0 * carried:.0f} % of the torque at its ends, the rest is friction: this is how "
            "a shaft behaves that turns against friction, not a gear that is twisted",
            "lock one side while the other is loaded; if this is friction over speed, give a friction table",
        )  # fmt: skip
        if share > MAX_FRICTION_SHARE:
            return
    measured, of_set = max(spring, 0.0) / half, float(start.gear.stiffness.torque(half)) / half
    factor, squared, limit = max(measured / of_set, 1e-300), start.gear.kinematics.ratio**2, _largest_factor(start)
    mistakes = {
        "angle and torque were measured at the input: give --side input": 1.0 / squared,
        "angle and torque were measured at the output: give --side output": squared,
    }
    torque, angle = ("torque", "twist") if loop.input_ratio is None else ("input_torque", "input_angle")
    mistakes |= wrong_units("torque", recording.unit(torque))
    mistakes |= {what: 1.0 / size for what, size in wrong_units("angle", recording.unit(angle)).items()}
    yield Check(
        "stiffness of the start set", source, max(factor, 1.0 / factor), limit, "1", not 1.0 / limit < factor < limit,
        f"it gives {measured:.3g} N·m/rad, {times(factor)} that of the start set ({of_set:.3g} N·m/rad)",
        f"{nearest(factor, mistakes)[0]}see whether sides and units are right, and the start set is that of this gear",
    )  # fmt: skip


def _largest_factor(start: GearSet) -> float:
    """Return the factor by which the stiffness of a gear may differ from that of its set: three standard deviations."""
    first = f"gear.stiffness.{start.gear.stiffness.fields[0]['name']}"
    entry = start.sources.get(first)
    if entry is None or entry.assumed:
        return MAX_FACTOR
    return float(np.exp(3.0 * max(entry.spread or 0.0, MIN_SPREAD_OF_STIFFNESS)))


def hint_of_ratio(found: Fit, start: Gear) -> Iterator[str]:
    """Yield the ratio at which a loop from the input would have the stiffness of the start set, if it is another one."""
    loop = found.experiment
    assert isinstance(loop, TorsionLoop)
    half = 0.5 * float(np.ptp(loop.twist))
    factor = float(found.gear.stiffness.torque(half) / start.stiffness.torque(half))
    if loop.input_ratio is None or factor <= 0.0 or 1.0 / STIFFNESS_SPREAD < factor < STIFFNESS_SPREAD:
        return
    ratio = abs(loop.input_ratio) / np.sqrt(factor)
    if MIN_RATIO <= ratio <= MAX_RATIO:
        yield (
            f"its stiffness is {times(factor)} that of the start set. Seen from the input, stiffness goes with the square of "
            f"the ratio: with a ratio of {ratio:.3g} it would be that of the set. See whether the ratio is right"
        )


def levels_of_table(table: Recording, source: str) -> Check:
    """Return the check that the torques of a friction table differ, as measured ones do, if only by their noise."""
    torque = np.abs(table["torque"])
    share = float(np.mean(torque >= (1.0 - SIZE_TOLERANCE) * torque.max()))
    return Check(
        "torques of one size", source, share, MAX_SHARE_OF_ONE_SIZE, "1", share > MAX_SHARE_OF_ONE_SIZE,
        f"{100.0 * share:.0f} % of its torques have the size {torque.max():.4g} N·m: a limit or a set value is no measurement",
        "give the torque that was measured, with its digits",
    )  # fmt: skip


def hints_of_levels(table: Recording) -> Iterator[str]:
    """Yield the limits of a friction table by its speeds."""
    speed = table["speed"]
    if (speed > 0.0).all() or (speed < 0.0).all():
        yield "it has one direction only: a zero error of the torque is counted as Coulomb friction; measure both"


# ---- Mistakes in units -----------------------------------------------------------------------------------------------


def wrong_units(quantity: str, unit: str) -> dict[str, float]:
    """Return mistakes in the unit of a quantity, and the factor by which each makes it too large."""
    return {f"the {quantity} is in {other}, not in {unit}": convert(1.0, unit, other) for other in MISTAKEN_UNITS.get(unit, ())}


def nearest(factor: float, mistakes: Mapping[str, float]) -> tuple[str, float]:
    """Return the mistake that explains a factor best, in words, and the logarithm that it leaves; no words if none does.

    >>> nearest(900.0, {"the torque is in mN.m, not in N.m": 1000.0})[0]
    'perhaps the torque is in mN.m, not in N.m; '
    """
    distances = {name: abs(float(np.log(factor / size))) for name, size in mistakes.items()}
    name, least = min(distances.items(), key=lambda item: item[1], default=("", np.inf))
    return f"perhaps {name}; " if least < np.log(MAX_FACTOR_LEFT) else "", least


def times(factor: float) -> str:
    """Return a factor in words.

    >>> times(1234.0)
    '1 234 times'
    """
    return f"{factor:.3g} times" if factor < 100.0 else f"{factor:,.0f} times".replace(",", " ")
