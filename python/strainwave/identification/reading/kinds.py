"""What a set of columns is: a table of friction, a torsion loop, a log, two encoders, or torque without motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from strainwave.analysis.branches import turning_points
from strainwave.identification.kinds import KINDS, kind_named
from strainwave.identification.reading.at_rest import at_rest
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Quantity, Side
from strainwave.identification.reading.sides import (
    APART,
    UndecidedError,
    pair,
    side_of_motion,
    side_of_table,
    side_of_torque,
    sides_of_angles,
)
from strainwave.identification.reading.steady import averaged, stretches
from strainwave.messages import as_option, listed

Array = NDArray[np.float64]

SHAFTS: tuple[Side, Side] = ("input", "output")
STEADY = 0.05  # of the usual speed: a record whose speed differs from it by less has one speed
WITHIN = 0.95  # of the rows, that must lie so near: the others are its beginning and end
SAMPLED = 500  # rows: no table of friction measured point by point has more
FEWEST = 4  # rows of a torsion loop or branch, and speeds of a table
TURNING = 2.0 * np.pi  # rad: a shaft that runs on for longer is not twisted, it turns
MAX_REFLECTED = 0.1  # relative: a motion of the input that differs by less from that of the output is divided by the ratio
MIN_STIFFNESS_AT_OUTPUT = 2000.0  # N.m/rad: over the smallest ratio squared, 900, no gear of a catalogue is as stiff
TWISTED = 0.3  # rad at the output: what moves by more is no twist of a gear
MIN_INDEPENDENCE = 1e-3  # smallest singular value of terms that are told apart, of terms of size 1
LOADED = 0.9  # correlation of torque and angle of a spring, which an alternating torque has


@dataclass(frozen=True)
class ColumnRoles:
    """The kind of a set of columns, and the channel of each.

    Args:
        kind: of measurement
        columns: by the names of the channels
        side: where it was measured, if that is one
        why: what tells so
        remarks: what was assumed
    """

    kind: str
    columns: dict[str, Column]
    side: Side | None
    why: tuple[str, ...]
    remarks: tuple[str, ...] = ()


def kind_of(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    """What the columns are, and which channel each is.

    Raises:
        UndecidedError: it cannot be told, or they are no measurement
    """
    return kind_named(mapping.kind or _kind(columns, mapping)).roles(columns, mapping)


def _kind(columns: Sequence[Column], mapping: FileMapping) -> str:
    for name in KINDS:
        if kind_named(name).recognises(columns, mapping):
            return name
    has = {column.channel.quantity for column in columns if column.channel.measured}
    timed = "time" in has or "rate" in mapping.constants
    effort, motion = has & {"torque", "current"}, has & {"angle", "speed"}
    commanded = any(column.channel.commanded for column in columns)
    if "twist" in has and "torque" in has and not (timed and motion):
        return "torsion"
    if effort and "angle" in has and (resting := at_rest(columns, mapping)):
        return resting
    if timed and motion and (effort or "voltage" in has or commanded):
        return "log"
    if len(_measured(columns, "angle")) > 1 and not effort:
        return "encoders"
    if "speed" in has and effort and "angle" not in has:
        return _table_or_samples(columns)
    if "angle" in has and "torque" in has:
        return _loop_or_turns(columns, mapping)
    if "angle" in has and "current" in has:
        return _to_and_fro_or_turns(columns)
    if effort:
        return "effort"
    raise UndecidedError(
        f"it holds {_names(columns)}, which is no measurement that is known: friction needs speed and torque; torsion twist "
        "and torque, or input_angle and input_torque; a log time, a motion, and a current, torque, voltage or command; "
        f"encoders two angles. If it holds more, name it, as with {as_option('column', 'torque', 'NAME')}"
    )


def _table_or_samples(columns: Sequence[Column]) -> str:
    """Whether speeds and torques without time are a table, or samples at one speed."""
    speed = _measured(columns, "speed")[0].si
    if len(speed) > 20 and np.quantile(np.abs(speed - np.median(speed)), WITHIN) < STEADY * abs(np.median(speed)):
        return "effort"
    if len(speed) > SAMPLED and len(stretches(speed)) < FEWEST:
        raise UndecidedError(
            f"it holds {len(speed)} rows of speed and torque without time: samples of a log if their rate is known, with "
            "--constant rate=HZ, or a table of friction, with --kind friction"
        )
    return "friction"


def _loop_or_turns(columns: Sequence[Column], mapping: FileMapping) -> str:
    """Whether angles and torques without time are a torsion loop, or torque while the shaft turns on."""
    column = _measured(columns, "angle")[0]
    angle, torque = column.si, _measured(columns, "torque")[0].si
    if np.ptp(angle) > TWISTED and (column.channel.side == "output" or column.robot or mapping.side == "output"):
        raise UndecidedError(
            f"{column.name} moves by {np.ptp(angle):.3g} rad, by which no gear twists: samples of a log whose rate is needed, "
            "with --constant rate=HZ; or, if it is a torsion loop all the same, --kind torsion"
        )
    turns_on = abs(angle[-1] - angle[0]) > TURNING and not turning_points(angle)
    if not turns_on:
        return "torsion"
    is_spring = torque.min() < 0.0 < torque.max() and np.corrcoef(angle, torque)[0, 1] ** 2 > LOADED**2
    return "torsion" if is_spring else "effort"


def _to_and_fro_or_turns(columns: Sequence[Column]) -> str:
    """Whether currents beside angles without time are ripple while the shaft turns on; asked where it goes to and fro."""
    angle, current = _measured(columns, "angle")[0], _measured(columns, "current")[0]
    if not turning_points(angle.si):
        return "effort"
    raise UndecidedError(
        f"{pair(angle, current)} go to and fro without time: friction before it slides, with --kind presliding, or samples of "
        "a log if their rate is known, with --constant rate=HZ"
    )


def friction_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    speed = _needed(columns, "speed", "friction")
    columns, load, loaded = _with_load(columns, speed)
    effort: Quantity = "torque" if _measured(columns, "torque") else "current"
    torque = _needed(columns, effort, "friction")
    side, told = side_of_table(speed, torque, mapping.side)
    order = "in no order of time" if (np.diff(speed.si) < 0.0).any() else "in the order of speed"
    why = f"its columns are {pair(speed, torque)}, {len(speed.si)} rows {order}: {KINDS['friction'].title}"
    found = {"speed": speed, effort: torque, **load, **_temperature(columns)}
    if len(speed.si) <= SAMPLED:
        return ColumnRoles("friction", found, side, (why, told, *loaded))
    parts = stretches(speed.si)
    rows = sum(part.stop - part.start for part in parts)
    why = f"its columns are {pair(speed, torque)} at one speed after another: {KINDS['friction'].title}"
    said = f"{rows} of its {len(speed.si)} rows are steady; the means of {len(parts)} stretches at one speed are taken"
    return ColumnRoles("friction", averaged(found, parts), side, (why, told, *loaded), (said,))


def _with_load(columns: Sequence[Column], speed: Column) -> tuple[Sequence[Column], dict[str, Column], tuple[str, ...]]:
    """The columns without the torque that loads the gear, this torque by its name, and what determines it.

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
    if (rows := len(angle.si)) < FEWEST:
        raise UndecidedError(f"{rows} rows of {pair(angle, torque)} are no torsion loop or branch; {FEWEST} are the least")
    side = mapping.side or torque.channel.side or angle.channel.side or ("output" if twists else None)
    by_stiffness: tuple[str, ...] = ()
    if side is None and (stiffness := np.ptp(torque.si) / max(float(np.ptp(angle.si)), 1e-300)) > MIN_STIFFNESS_AT_OUTPUT:
        side = "output"
        by_stiffness = (f"its stiffness of {stiffness:.3g} N.m/rad is that of an output; at an input it is far smaller",)
    if side is None:
        raise UndecidedError(
            f"{pair(angle, torque)} are a torsion loop or branch, but no side is stated: --side input if the motor was turned "
            "with the output locked, --side output if the output was loaded with the input locked; or, if the motor was moved "
            "to and fro at rest, --kind presliding"
        )
    turns = len(turning_points(angle.si))
    shape = f"a torsion loop with {turns} reversals" if turns else "one branch of a torsion loop, which tells stiffness only"
    why = f"its columns are {pair(angle, torque)}, {rows} rows: {shape}"
    inside = "the friction of the input is in the loop"
    if side == "input":
        told = f"angle and torque are those of the input: the output was locked, and {inside}"
        return ColumnRoles("torsion", {"input_angle": angle, "input_torque": torque}, side, (why, told))
    counted = f"{torque.name} is a torque of the motor, counted at the output: {inside}"
    remarks = (counted,) if "motor" in torque.name.casefold() else ()
    told = "twist and torque are those of the output"
    return ColumnRoles("torsion", {"twist": angle, "torque": torque}, side, (why, told, *by_stiffness), remarks)


def log_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    torques, currents, remarks = _efforts(columns)
    _check_voltage(columns, [*torques, *currents])
    found: dict[str, Column] = {}
    for name, some in (
        ("time", _measured(columns, "time")),
        ("command", _commanded(columns, "angle")),
        ("voltage", _measured(columns, "voltage") or _commanded(columns, "voltage")),
        ("current", currents),
        ("temperature", _measured(columns, "temperature")),
        ("rigid_torque", [column for column in columns if column.channel.modelled]),
    ):
        for column in some:
            _put(found, name, column)
    sides, why = _put_sided(found, columns, torques, mapping)
    first = f"it holds {_names(columns)}, {len(columns[0].si)} rows in time: {KINDS['log'].title}"
    return ColumnRoles("log", found, next(iter(sides)) if len(sides) == 1 else None, (first, *why), remarks)


def _check_voltage(columns: Sequence[Column], others: Sequence[Column]) -> None:
    """The letter u is a voltage beside motors, and whatever a robot is driven by beside joints."""
    for column in _measured(columns, "voltage"):
        is_letter = len(column.name.rstrip("_0123456789[]")) == 1 and column.label.unit is None
        if is_letter and not others and not column.by_user and any(each.robot for each in columns):
            ways = " or ".join(as_option("column", name, column.name) for name in ("joint_torque", "current", "voltage"))
            raise UndecidedError(f"{column.name} may be a torque, a current or a voltage; say it with {ways}")


def _put_sided(
    found: dict[str, Column], columns: Sequence[Column], torques: Sequence[Column], mapping: FileMapping
) -> tuple[set[Side], list[str]]:
    """Puts motions and torques of a log on their sides; returns the sides that move, and what tells them."""
    motions, why = _of_both_shafts([*_measured(columns, "angle"), *_measured(columns, "speed")])
    if not motions:
        raise UndecidedError(f"a log needs an angle or a speed; it holds {_names(columns)}")
    sides: set[Side] = set()
    reflected = [column for column in motions if column.channel.reflected]
    for column in motions:
        side, told = side_of_motion(column, (*motions, *torques), found.get("time"), mapping.side)
        sides.add(side)
        why.append(told)
        _put(found, f"{'reflected' if column in reflected else side}_{column.channel.quantity}", column)
    why += _reflect(found, mapping)
    if len(torques) > 1 and not any(column.by_user or column.channel.side for column in torques):
        first = torques[0]
        stem = first.name.removesuffix(first.which).rstrip("_.") if first.robot and first.which else first.name
        ways = f"--column input_torque={stem} if it is that of the motor, or --column joint_torque={stem} if of the joint"
        raise UndecidedError(f"each of {_names(torques)} may be the torque; say which, with {ways}", (), ways)
    for column in torques:
        side, told = side_of_torque(column, sides, mapping.side)
        why.append(told)
        _put(found, "joint_torque" if side == "output" else "input_torque", column)
    return sides, [told for told in why if told]


def _are_of_both(one: Column, other: Column) -> bool:
    """True if one motion is so much larger than the other one that they are those of the input and of the output."""
    small, large = sorted(float(np.ptp(column.si)) for column in (one, other))
    return large > APART * small > 0.0


@np.errstate(all="ignore")
def _reflect(found: dict[str, Column], mapping: FileMapping) -> list[str]:
    """Name motions of the input that are as large as those of the output by what they are: divided by the ratio."""
    if abs(abs(mapping.constants.get("ratio", np.inf)) - 1.0) < MAX_REFLECTED:
        return []
    pairs = [(found.get(f"input_{each}"), found.get(f"output_{each}"), each) for each in ("angle", "speed")]
    why = []
    for motor, joint, quantity in pairs:
        if motor is None or joint is None or not np.std(joint.si) > 0.0:
            continue
        slope = float(np.cov(motor.si, joint.si)[0, 1] / np.var(joint.si, ddof=1))
        if abs(abs(slope) - 1.0) < MAX_REFLECTED:
            found[f"reflected_{quantity}"] = found.pop(f"input_{quantity}")
            why.append(f"{motor.name} moves as far as {joint.name}: it is the {quantity} of the motor divided by the ratio")
    return why


def _of_both_shafts(motions: Sequence[Column]) -> tuple[list[Column], list[str]]:
    """The motions, of two whose names say no side with those that their sizes tell; and what tells so."""
    found, why = list(motions), list[str]()
    for quantity in ("angle", "speed"):
        pair_of = [column for column in found if column.channel.quantity == quantity]
        open_ones = [column for column in pair_of if column.channel.side is None]
        if len(pair_of) == 2 and open_ones and (len(open_ones) == 2 or _are_of_both(*pair_of)):
            fast, slow, told = sides_of_angles(pair_of)
            for column, side in zip((fast, slow), SHAFTS, strict=True):
                found[found.index(column)] = replace(column, channel=column.channel._replace(side=side))
            why.append(told)
    return found, why


def _efforts(columns: Sequence[Column]) -> tuple[list[Column], list[Column], tuple[str, ...]]:
    """Torques and currents of a log: those that a person named, else those measured, else those commanded."""
    torques, currents = _measured(columns, "torque"), _measured(columns, "current")
    if any(column.by_user for column in (*torques, *currents)):
        torques, currents = ([column for column in some if column.by_user] for some in (torques, currents))
    if torques or currents:
        return torques, currents, ()
    torques, currents = _commanded(columns, "torque"), _commanded(columns, "current")
    remarks = (f"{column.name} is a reference, and is taken for what the drive did" for column in (*torques, *currents))
    return torques, currents, tuple(remarks)


def run_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    """Return the channels of a run of the whole drive: time, command and what was measured; an encoder is that of the motor."""
    found: dict[str, Column] = {}
    for name, some in (
        ("time", _measured(columns, "time")),
        ("command", _commanded(columns, "angle") or _commanded(columns, "voltage")),
        ("current", _measured(columns, "current")),
    ):
        for column in some:
            _put(found, name, column)
    if "command" not in found:
        raise UndecidedError(f"{KINDS['run'].title} needs its command; it holds {_names(columns)}")
    _, why = _put_sided(found, columns, [], mapping if mapping.side else replace(mapping, side="input"))
    first = f"it holds {_names(columns)}, {len(columns[0].si)} rows in time: {KINDS['run'].title}"
    return ColumnRoles("run", found, None, (first, *why))


def encoder_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    angles = _measured(columns, "angle")
    if len(angles) != 2:
        raise UndecidedError(f"a record of two encoders needs two angles; it holds {_names(columns)}")
    fast, slow, told = sides_of_angles(angles)
    why = f"its columns are {pair(*angles)}, and no torque or current: {KINDS['encoders'].title}"
    times = {"time": column for column in _measured(columns, "time")[:1]}  # noqa: B035 - one or none
    found = {**times, "input_angle": fast, "output_angle": slow, **_temperature(columns)}
    return ColumnRoles("encoders", found, None, tuple(filter(None, (why, told))))


def effort_roles(columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
    found: dict[str, Column] = {}
    for column in columns:
        if column.channel.measured:
            _put(found, column.channel.quantity, column)
    effort = listed(found[name].name for name in ("torque", "current") if name in found)
    side = mapping.side or next((column.channel.side for column in found.values() if column.channel.side), None)
    robot = next((column.name for column in found.values() if column.robot), None) if side is None else None
    side = "output" if robot else side
    if "speed" in found:
        why = f"it holds {effort} at one speed, {found['speed'].si.mean():.4g} rad/s: a record at constant speed"
    elif "angle" in found:
        turns = np.ptp(found["angle"].si) / (2.0 * np.pi)
        why = f"it holds {effort} over {found['angle'].name}, which runs on for {turns:.3g} turns"
    elif "speed" in mapping.constants:
        why = f"it holds {effort} at {mapping.constants['speed']:.4g} rad/s, as was said: a record at constant speed"
    else:
        why = f"it holds {effort} and nothing that moves: the output was locked, or the speed was constant and is not stated"
    told = (f"{robot} is what robots call a channel of a joint: it is taken to be at the output",) if robot else ()
    return ColumnRoles("effort", found, side, (why, *told))


def at_rest_roles(columns: Sequence[Column], mapping: FileMapping, kind: str) -> ColumnRoles:
    effort: Quantity = "torque" if _measured(columns, "torque") else "current"
    angle, force = _needed(columns, "angle", kind), _needed(columns, effort, kind)
    side = mapping.side or angle.channel.side or ("output" if angle.robot else "input")
    found: dict[str, Column] = {"angle": angle, effort: force}
    moved = f"{angle.name} moves by {1e3 * np.ptp(angle.si):.3g} mrad in all"
    if kind == "presliding":
        turns = len(turning_points(angle.si))
        return ColumnRoles(
            kind, found, side, (f"{moved} and turns back {turns} times beside {force.name}: {KINDS[kind].title}",)
        )
    if times := _measured(columns, "time"):
        found["time"] = times[0]
    return ColumnRoles(
        kind, found, side, (f"{force.name} rises while {angle.name} rests, until it moves: {KINDS[kind].title}",)
    )


def _measured(columns: Sequence[Column], quantity: Quantity) -> list[Column]:
    return [column for column in columns if column.channel.quantity == quantity and column.channel.measured]


def _commanded(columns: Sequence[Column], quantity: Quantity) -> list[Column]:
    return [column for column in columns if column.channel.quantity == quantity and column.channel.commanded]


def _needed(columns: Sequence[Column], quantity: Quantity, kind: str) -> Column:
    """The one column of a quantity, or the one that a person named."""
    found = _measured(columns, quantity)
    found = found if len(found) == 1 else [column for column in found if column.by_user] or found
    if len(found) == 1:
        return found[0]
    lack = f"each of {_names(found)} may be it" if found else f"it holds {_names(columns)}"
    raise UndecidedError(
        f"{KINDS[kind].title} needs one {quantity}: {lack}; say which, as with {as_option('column', quantity, 'NAME')}"
    )


def _temperature(columns: Sequence[Column]) -> dict[str, Column]:
    found = _measured(columns, "temperature")
    return {"temperature": found[0]} if found else {}


def _put(found: dict[str, Column], name: str, column: Column) -> None:
    """A channel; a column that a person named goes before one whose name tells."""
    if name not in found or (column.by_user and not found[name].by_user):
        found[name] = column
    elif column.by_user or not found[name].by_user:
        ways = as_option("column", name, column.name)
        raise UndecidedError(f"{pair(found[name], column)} may both be the {name}; say which, as with {ways}")


def _names(columns: Sequence[Column]) -> str:
    return listed(column.name for column in columns)
