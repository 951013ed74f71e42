"""The kind of a set of columns, and the channel of each: friction, torsion, a log, encoders, or torque without motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave.analysis.branches import turning_points
from strainwave.files.units import convert
from strainwave.identification.kinds import KINDS, kind_named
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.motions import at_rest, averaged, stretches
from strainwave.identification.reading.names import Quantity, Side
from strainwave.identification.reading.sides import (
    MIN_FACTOR_OF_SIDES,
    UndecidedError,
    pair,
    side_of_motion,
    side_of_table,
    side_of_torque,
    sides_of_angles,
)
from strainwave.messages import as_option, listed

Array = NDArray[np.float64]

MAX_DEVIATION = 0.05  # from the usual speed, of a record at one speed
SPEED_QUANTILE = 0.95  # of its rows: the others are its beginning and end
MIN_ROWS_AT_ONE_SPEED = 20
MAX_ROWS_OF_TABLE = 500  # of friction, measured point by point
MIN_ROWS = 4  # of a torsion loop or branch, and speeds of a table
MIN_TURNING = 2.0 * np.pi  # rad: a shaft that runs on for longer is not twisted
MAX_TWIST = 0.3  # rad of a gear at the output
MAX_REFLECTED = 0.1  # relative difference of a motion of the input from that of the output, if it is divided by the ratio
MAX_REFLECTED_RANGE = 2.0 * np.pi  # rad, rad/s: a motor that moves less, beside no encoder of the joint, is counted there
MIN_STIFFNESS_AT_OUTPUT = 2000.0  # N.m/rad: over the smallest ratio squared, 900, no gear of a catalogue is as stiff
MIN_INDEPENDENCE = 1e-3  # smallest singular value of terms of size 1 that are fitted together
SPEEDS = ("rad/s", "rpm", "rev/s")  # in which tables of friction have their speeds
MIN_CORRELATION_OF_SPRING = 0.9  # of torque and angle, if the torque alternates


@dataclass(frozen=True)
class ColumnRoles:
    """The kind of a set of columns, and the channel of each.

    Args:
        kind: of measurement
        columns: by the names of the channels
        side: at which it was measured, if that is one
        why: what determines it
        remarks: what was assumed
    """

    kind: str
    columns: dict[str, Column]
    side: Side | None
    why: tuple[str, ...]
    remarks: tuple[str, ...] = ()


def kind_of(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    """Return the kind of a set of columns, and the channel of each.

    Raises:
        UndecidedError: several kinds or channels are possible, or none
    """
    return kind_named(mapping.kind or _kind(columns, mapping)).roles(columns, mapping)


def _kind(columns: Sequence[Column], mapping: FileMapping) -> str:
    for name in KINDS:
        if kind_named(name).recognises(columns, mapping):
            return name
    has = {column.channel.quantity for column in columns if column.channel.measured}
    timed = "time" in has or "rate" in mapping.constants
    effort, motion = has & {"torque", "current"}, has & {"angle", "speed"}
    if "twist" in has and "torque" in has and not (timed and motion):
        return "torsion"
    if effort and "angle" in has and (resting := at_rest(columns, mapping)):
        return resting
    if timed and motion and (effort or "voltage" in has or any(column.channel.commanded for column in columns)):
        return "log"
    if len(_measured(columns, "angle")) > 1 and not effort:
        return "encoders"
    if effort and motion:
        return _without_time(columns, mapping)
    if effort:
        return "effort"
    raise UndecidedError(
        f"it has {_names(columns)}, which is no measurement that is known: friction needs speed and torque; torsion twist "
        "and torque, or input_angle and input_torque; a log time, a motion, and a current, torque, voltage or command; "
        f"encoders two angles. If it has more, name it, as with {as_option('column', 'torque', 'NAME')}"
    )


def _without_time(columns: Sequence[Column], mapping: FileMapping) -> str:
    """Return the kind of a motion beside a torque or current without time.

    Raises:
        UndecidedError: these may be samples of a log
    """
    angles, torques = _measured(columns, "angle"), _measured(columns, "torque")
    if not angles:
        return _over_speed(_measured(columns, "speed")[0].si)
    column, angle = angles[0], angles[0].si
    turns_back = bool(turning_points(angle))
    if not torques and turns_back:
        raise UndecidedError(
            f"{pair(column, _measured(columns, 'current')[0])} go to and fro without time: friction before it slides, with "
            "--kind presliding, or samples of a log if their rate is known, with --constant rate=HZ"
        )
    if not torques:
        return "effort"
    if np.ptp(angle) > MAX_TWIST and (column.channel.side == "output" or column.robot or mapping.side == "output"):
        raise UndecidedError(
            f"{column.name} moves by {np.ptp(angle):.3g} rad, by which no gear twists: samples of a log whose rate is needed, "
            "with --constant rate=HZ; or, if it is a torsion loop all the same, --kind torsion"
        )
    torque = torques[0].si
    is_spring = torque.min() < 0.0 < torque.max() and abs(np.corrcoef(angle, torque)[0, 1]) > MIN_CORRELATION_OF_SPRING
    return "effort" if abs(angle[-1] - angle[0]) > MIN_TURNING and not turns_back and not is_spring else "torsion"


def _over_speed(speed: Array) -> str:
    """Return the kind of speeds beside torques without time: a table, or samples at one speed.

    Raises:
        UndecidedError: these may be samples of a log
    """
    usual = np.median(speed)
    if len(speed) > MIN_ROWS_AT_ONE_SPEED and np.quantile(abs(speed - usual), SPEED_QUANTILE) < MAX_DEVIATION * abs(usual):
        return "effort"
    if len(speed) > MAX_ROWS_OF_TABLE and len(stretches(speed)) < MIN_ROWS:
        raise UndecidedError(
            f"it has {len(speed)} rows of speed and torque without time: samples of a log if their rate is known, with "
            "--constant rate=HZ, or a table of friction, with --kind friction"
        )
    return "friction"


# ---- Tables and loops ------------------------------------------------------------------------------------------------


def friction_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    speed = _needed(columns, "speed", "friction")
    _check_speed_unit(speed)
    columns, load, loaded = _with_load(columns, speed)
    effort, torque = _needed_effort(columns, "friction")
    side, why_side = side_of_table(speed, torque, mapping.side)
    found = {"speed": speed, effort: torque, **load, **_first(columns, "temperature")}
    rows, remarks = len(speed.si), tuple[str, ...]()
    order = f", {rows} rows in {'no order of time' if (np.diff(speed.si) < 0.0).any() else 'the order of speed'}"
    if rows > MAX_ROWS_OF_TABLE:
        parts = stretches(speed.si)
        if not parts:
            raise UndecidedError(
                f"none of its {rows} rows belongs to a stretch at one speed: give a row for each speed, or its time, as a log"
            )
        steady = sum(part.stop - part.start for part in parts)
        remarks = (f"{steady} of its {rows} rows are steady; the means of {len(parts)} stretches at one speed are taken",)
        found, order = averaged(found, parts), " at one speed after another"
    why = f"its columns are {pair(speed, torque)}{order}: {KINDS['friction'].title}"
    return ColumnRoles("friction", found, side, (why, why_side, *loaded), remarks)


def _check_speed_unit(speed: Column) -> None:
    """Ask for the unit of the speeds of a table, which friction alone does not determine; robots have radians.

    Raises:
        UndecidedError: no unit is stated
    """
    if speed.sure or speed.robot:
        return
    fastest = float(np.abs(speed.raw[np.isfinite(speed.raw)]).max(initial=0.0))
    ways = [f"{as_option('unit', speed.name, each)} ({convert(fastest, each, 'rpm'):.0f} 1/min at most)" for each in SPEEDS]
    question = f"the unit of {speed.name} is not stated, and a table of friction does not determine it; give it, with "
    answer = FileMapping(units={speed.name: SPEEDS[0]})
    raise UndecidedError(question + " or ".join(ways), (), as_option("unit", speed.name, SPEEDS[0]), answer)


def _with_load(columns: Sequence[Column], speed: Column) -> tuple[Sequence[Column], dict[str, Column], tuple[str, ...]]:
    """Return the columns without the torque that loads the gear, this torque by its name, and what determines it.

    It is `output_torque` if the other torque drives it too, as on a dynamometer, and `load_torque` beside a torque that is
    friction alone.
    """
    named = [column for column in columns if column.channel.loading]
    torques = _measured(columns, "torque")
    loads = named or [column for column in torques if column.channel.side == "output"]
    own = [column for column in torques if column not in loads]
    if len(loads) != 1 or len(own) != 1 or loads[0].by_user != own[0].by_user:
        return columns, {}, ()
    ((load,), (torque,)) = loads, own
    name = "load_torque" if named or not _drives(speed.si, torque, load) else "output_torque"
    what = "which loads the gear" if name == "load_torque" else f"which {torque.name} drives through the gear"
    return [column for column in columns if column is not load], {name: load}, (f"{load.name} is a torque {what}",)


@np.errstate(all="ignore")
def _drives(speed: Array, torque: Column, load: Column) -> bool:
    """True if a torque contains what drives a load, not only the friction under it."""
    way = np.sign(speed)
    terms = np.stack([way, speed, load.si, way * np.abs(load.si)], axis=1)
    sizes = np.linalg.norm(terms, axis=0)
    if not sizes.all() or np.linalg.matrix_rank(terms / sizes, tol=MIN_INDEPENDENCE) < len(sizes):
        return torque.channel.side == "input"
    _, _, driving, rubbing = np.linalg.lstsq(terms, torque.si, rcond=None)[0]
    return bool(abs(driving) > abs(rubbing))


def torsion_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    torque = _needed(columns, "torque", "torsion")
    twists = _measured(columns, "twist")
    angle = twists[0] if twists else _needed(columns, "angle", "torsion")
    if (rows := len(angle.si)) < MIN_ROWS:
        raise UndecidedError(f"{rows} rows of {pair(angle, torque)} are no torsion loop or branch; {MIN_ROWS} are the least")
    turns = len(turning_points(angle.si))
    shape = f"a torsion loop with {turns} reversals" if turns else "one branch of a torsion loop, which shows stiffness only"
    why = [f"its columns are {pair(angle, torque)}, {rows} rows: {shape}"]
    stiffness = np.ptp(torque.si) / max(float(np.ptp(angle.si)), 1e-300)
    side = mapping.side or torque.channel.side or angle.channel.side or ("output" if twists else None)
    if side == "input":
        why.append(
            "angle and torque are those of the input: the output was locked, and the friction of the input is in the loop"
        )
        return ColumnRoles("torsion", {"input_angle": angle, "input_torque": torque}, side, tuple(why))
    why.append("twist and torque are those of the output")
    if side is None and stiffness > MIN_STIFFNESS_AT_OUTPUT:
        why.append(f"its stiffness of {stiffness:.3g} N.m/rad is that of an output; at an input it is far smaller")
    elif side is None:
        raise UndecidedError(
            f"{pair(angle, torque)} are a torsion loop or branch, but no side is stated: --side input if the motor was turned "
            "with the output locked, --side output if the output was loaded with the input locked; or, if the motor was moved "
            "to and fro at rest, --kind presliding"
        )
    counted = f"{torque.name} is a torque of the motor, counted at the output: the friction of the input is in the loop"
    remarks = (counted,) if "motor" in torque.name.casefold() else ()
    return ColumnRoles("torsion", {"twist": angle, "torque": torque}, "output", tuple(why), remarks)


def at_rest_roles(columns: Sequence[Column], mapping: FileMapping, kind: str) -> ColumnRoles:
    angle, (effort, force) = _needed(columns, "angle", kind), _needed_effort(columns, kind)
    side = mapping.side or angle.channel.side or ("output" if angle.robot else "input")
    found: dict[str, Column] = {"angle": angle, effort: force}
    why = f"{force.name} rises while {angle.name} rests, until it moves"
    if kind == "presliding":
        turns, moved = len(turning_points(angle.si)), f"moves by {1e3 * np.ptp(angle.si):.3g} mrad in all"
        why = f"{angle.name} {moved} and turns back {turns} times beside {force.name}"
    else:
        found |= _first(columns, "time")
    return ColumnRoles(kind, found, side, (f"{why}: {KINDS[kind].title}",))


def encoder_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    angles = _measured(columns, "angle")
    if len(angles) != 2:
        raise UndecidedError(f"a record of two encoders needs two angles; it has {_names(columns)}")
    fast, slow, why_side = sides_of_angles(angles)
    why = f"its columns are {pair(*angles)}, and no torque or current: {KINDS['encoders'].title}"
    found = {**_first(columns, "time"), "input_angle": fast, "output_angle": slow, **_first(columns, "temperature")}
    return ColumnRoles("encoders", found, None, tuple(filter(None, (why, why_side))))


def effort_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    measured = [column for column in columns if column.channel.measured]
    found = _channels({column.channel.quantity: _measured(columns, column.channel.quantity) for column in measured})
    effort = listed(found[name].name for name in ("torque", "current") if name in found)
    side = mapping.side or next((column.channel.side for column in found.values() if column.channel.side), None)
    robot = next((column.name for column in found.values() if column.robot), None) if side is None else None
    if "speed" in found:
        why = f"at one speed, {found['speed'].si.mean():.4g} rad/s: a record at constant speed"
    elif "angle" in found:
        turns = np.ptp(found["angle"].si) / (2.0 * np.pi)
        why = f"over {found['angle'].name}, which runs on for {turns:.3g} turns"
    elif "speed" in mapping.constants:
        why = f"at {mapping.constants['speed']:.4g} rad/s, as was given: a record at constant speed"
    else:
        why = "and nothing that moves: the output was locked, or the speed was constant and is not stated"
    why_side = (f"{robot} is what robots call a channel of a joint: it is taken to be at the output",) if robot else ()
    return ColumnRoles("effort", found, "output" if robot else side, (f"it has {effort} {why}", *why_side))


# ---- Logs and runs ---------------------------------------------------------------------------------------------------


def log_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    torques, currents, remarks = _efforts(columns)
    _check_voltage(columns, [*torques, *currents])
    found = _channels(
        {
            "time": _measured(columns, "time"),
            "command": _commanded(columns, "angle"),
            "voltage": _measured(columns, "voltage") or _commanded(columns, "voltage"),
            "current": currents,
            "temperature": _measured(columns, "temperature"),
            "rigid_torque": [column for column in columns if column.channel.modelled],
        }
    )
    sides, why = _put_sided(found, columns, torques, mapping)
    first = f"it has {_names(columns)}, {len(columns[0].si)} rows in time: {KINDS['log'].title}"
    return ColumnRoles("log", found, next(iter(sides)) if len(sides) == 1 else None, (first, *why), remarks)


def run_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    """Return the channels of a run of the whole drive: time, command and what was measured; an encoder is that of the motor."""
    found = _channels(
        {
            "time": _measured(columns, "time"),
            "command": _commanded(columns, "angle") or _commanded(columns, "voltage"),
            "current": _measured(columns, "current"),
        }
    )
    if "command" not in found:
        raise UndecidedError(f"{KINDS['run'].title} needs its command; it has {_names(columns)}")
    _, why = _put_sided(found, columns, [], mapping if mapping.side else replace(mapping, side="input"))
    first = f"it has {_names(columns)}, {len(columns[0].si)} rows in time: {KINDS['run'].title}"
    return ColumnRoles("run", found, None, (first, *why))


def _efforts(columns: Sequence[Column]) -> tuple[list[Column], list[Column], tuple[str, ...]]:
    """Return torques and currents of a log: those that a person named, else those measured, else those commanded."""
    torques, currents = _measured(columns, "torque"), _measured(columns, "current")
    if any(column.by_user for column in (*torques, *currents)):
        torques, currents = ([column for column in some if column.by_user] for some in (torques, currents))
    if torques or currents:
        return torques, currents, ()
    torques, currents = _commanded(columns, "torque"), _commanded(columns, "current")
    remarks = (f"{column.name} is a reference, and is taken for what the drive did" for column in (*torques, *currents))
    return torques, currents, tuple(remarks)


def _check_voltage(columns: Sequence[Column], others: Sequence[Column]) -> None:
    """Ask for the letter u, which is a voltage beside motors, and any input of a robot beside joints.

    Raises:
        UndecidedError: a column has this letter and nothing else for a name
    """
    for column in _measured(columns, "voltage"):
        is_letter = len(column.name.rstrip("_0123456789[]")) == 1 and column.label.unit is None
        if is_letter and not others and not column.by_user and any(each.robot for each in columns):
            ways = " or ".join(as_option("column", name, column.name) for name in ("joint_torque", "current", "voltage"))
            raise UndecidedError(f"{column.name} may be a torque, a current or a voltage; name it with {ways}")


def _put_sided(
    found: dict[str, Column], columns: Sequence[Column], torques: Sequence[Column], mapping: FileMapping
) -> tuple[set[Side], list[str]]:
    """Add motions and torques of a log with their sides; return the sides that move, and what determines them."""
    motions, why = _of_both_shafts([*_measured(columns, "angle"), *_measured(columns, "speed")])
    if not motions:
        raise UndecidedError(f"a log needs an angle or a speed; it has {_names(columns)}")
    sides: set[Side] = set()
    for column in motions:
        side, why_side = side_of_motion(column, (*motions, *torques), found.get("time"), mapping.side)
        sides.add(side)
        why.append(why_side)
        _put(found, f"{'reflected' if column.channel.reflected else side}_{column.channel.quantity}", column)
    why += _reflect(found, mapping)
    if len(torques) > 1 and not any(column.by_user or column.channel.side for column in torques):
        first = torques[0]
        stem = first.name.removesuffix(first.which).rstrip("_.") if first.robot and first.which else first.name
        ways = f"--column input_torque={stem} if it is that of the motor, or --column joint_torque={stem} if of the joint"
        raise UndecidedError(f"each of {_names(torques)} may be the torque; choose one, with {ways}", (), ways)
    for column in torques:
        side, why_side = side_of_torque(column, sides, mapping.side)
        why.append(why_side)
        _put(found, "joint_torque" if side == "output" else "input_torque", column)
    return sides, [each for each in why if each]


def _of_both_shafts(motions: Sequence[Column]) -> tuple[list[Column], list[str]]:
    """Return the motions, with the sides of two whose names contain none by their sizes; and what determines them."""
    found, why = list(motions), list[str]()
    for quantity in ("angle", "speed"):
        both = [column for column in found if column.channel.quantity == quantity]
        is_open = [column.channel.side is None for column in both]
        small, large = sorted(float(np.ptp(column.si)) for column in both) if len(both) == 2 else (0.0, 0.0)
        if len(both) == 2 and (all(is_open) or (any(is_open) and large > MIN_FACTOR_OF_SIDES * small > 0.0)):
            fast, slow, why_side = sides_of_angles(both)
            sides: tuple[tuple[Column, Side], ...] = ((fast, "input"), (slow, "output"))
            for column, side in sides:
                found[found.index(column)] = replace(column, channel=column.channel._replace(side=side))
            why.append(why_side)
    return found, why


@np.errstate(all="ignore")
def _reflect(found: dict[str, Column], mapping: FileMapping) -> list[str]:
    """Rename motions of the input that are as large as those of a joint, as they are divided by the ratio."""
    if abs(abs(mapping.constants.get("ratio", np.inf)) - 1.0) < MAX_REFLECTED:
        return []
    why = []
    for quantity in ("angle", "speed"):
        motor, joint = found.get(f"input_{quantity}"), found.get(f"output_{quantity}")
        if motor is None or joint is None:
            continue
        if not np.ptp(joint.si) > 0.0:
            del found[f"output_{quantity}"]
            why.append(f"{joint.name} never changes, as of an encoder that is not there: it is left out")
            if np.ptp(motor.si) < MAX_REFLECTED_RANGE and not motor.by_user:
                found[f"reflected_{quantity}"] = found.pop(f"input_{quantity}")
                moves = f"{motor.name} moves no further than a joint: it is taken as divided by the ratio"
                why.append(f"{moves}; otherwise add {as_option('column', f'input_{quantity}', motor.name)}")
            continue
        slope = float(np.cov(motor.si, joint.si)[0, 1] / np.var(joint.si, ddof=1))
        if abs(abs(slope) - 1.0) < MAX_REFLECTED:
            found[f"reflected_{quantity}"] = found.pop(f"input_{quantity}")
            why.append(f"{motor.name} moves as far as {joint.name}: it is the {quantity} of the motor divided by the ratio")
    return why


# ---- Columns of a quantity -------------------------------------------------------------------------------------------


def _measured(columns: Sequence[Column], quantity: Quantity) -> list[Column]:
    return [column for column in columns if column.channel.quantity == quantity and column.channel.measured]


def _commanded(columns: Sequence[Column], quantity: Quantity) -> list[Column]:
    return [column for column in columns if column.channel.quantity == quantity and column.channel.commanded]


def _first(columns: Sequence[Column], quantity: Quantity) -> dict[str, Column]:
    return {str(quantity): column for column in _measured(columns, quantity)[:1]}


def _needed_effort(columns: Sequence[Column], kind: str) -> tuple[str, Column]:
    quantity: Quantity = "torque" if _measured(columns, "torque") else "current"
    return quantity, _needed(columns, quantity, kind)


def _needed(columns: Sequence[Column], quantity: Quantity, kind: str) -> Column:
    """Return the one column of a quantity, or the one that a person named.

    Raises:
        UndecidedError: there is none, or several
    """
    found = _measured(columns, quantity)
    found = found if len(found) == 1 else [column for column in found if column.by_user] or found
    if len(found) == 1:
        return found[0]
    lack = f"each of {_names(found)} may be it" if found else f"it has {_names(columns)}"
    way = as_option("column", quantity, "NAME")
    raise UndecidedError(f"{KINDS[kind].title} needs one {quantity}: {lack}; choose one, as with {way}")


def _channels(wanted: Mapping[str, Sequence[Column]]) -> dict[str, Column]:
    """Return the column of each channel, of those that may be it."""
    found = dict[str, Column]()
    for name, columns in wanted.items():
        for column in columns:
            _put(found, name, column)
    return found


def _put(found: dict[str, Column], name: str, column: Column) -> None:
    """Add the column of a channel; one that a person named replaces one that has it by its name.

    Raises:
        UndecidedError: both may be the channel
    """
    if name not in found or (column.by_user and not found[name].by_user):
        found[name] = column
    elif column.by_user or not found[name].by_user:
        way = as_option("column", name, column.name)
        raise UndecidedError(f"{pair(found[name], column)} may both be the {name}; choose one, as with {way}")


def _names(columns: Sequence[Column]) -> str:
    return listed(column.name for column in columns)
