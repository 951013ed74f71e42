"""Several torques and currents of one joint: which of them shows the friction of the gear."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from strainwave.files.units import measures
from strainwave.identification.reading.column import Column
from strainwave.identification.reading.names import QUANTITIES, words_of
from strainwave.messages import listed

CURRENT, TORQUE = set(QUANTITIES["current"]), set(QUANTITIES["torque"])


def one_effort(columns: Sequence[Column]) -> tuple[list[Column], list[tuple[str, str]]]:
    """The columns with one torque or current of each joint where several are duplicates; and for each what was decided.

    The torque of the motor shows the friction of the gear, that of a sensor behind the gear does not. So a torque from the
    current goes before a current, and this before any other torque.
    """
    efforts = [column for column in columns if _is_effort(column)]
    joints = dict.fromkeys(column.which for column in efforts)
    taken, remarks = list(columns), list[tuple[str, str]]()
    for joint in joints:
        several = [column for column in efforts if column.which == joint]
        from_current = [column for column in several if _words(column) & CURRENT and _words(column) & TORQUE]
        currents = [column for column in several if column.channel.quantity == "current" and column not in from_current]
        torques = [column for column in several if column.channel.quantity == "torque" and column not in from_current]
        first = from_current if from_current and (currents or torques) else currents if len(torques) > 1 else []
        if len(first) != 1:
            continue
        (best,) = first
        as_torque = best in from_current and (best.unit is None or measures(best.unit, "N.m"))
        kept = replace(best, channel=best.channel._replace(quantity="torque")) if as_torque else best
        taken = [kept if column is best else column for column in taken if column is best or column not in several]
        others = listed(column.name for column in several if column is not best)
        what = "is the motor's torque from its current" if best in from_current else "is the current of the motor"
        instead = f"--column joint_torque=NAME takes another one of {others}"
        remarks.append((best.name, f"{best.name} {what}, which contains the friction, and is taken; {instead}"))
    return taken, remarks


def _is_effort(column: Column) -> bool:
    is_one = column.channel.quantity in ("torque", "current") and column.channel.measured and column.channel.side is None
    return is_one and column.own and not column.by_user


def _words(column: Column) -> set[str]:
    return set(words_of(column.name))
