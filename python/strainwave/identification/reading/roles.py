"""The column of each channel: the columns that may be one, and the questions if several may be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from strainwave.identification.reading.column import Column
from strainwave.identification.reading.names import Quantity, Side
from strainwave.identification.reading.sides import pair
from strainwave.messages import listed
from strainwave.questions import Answer, QuestionError

MAX_NAMED = 8  # columns of one list


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


def measured(columns: Sequence[Column], *quantities: Quantity) -> list[Column]:
    """Return the measured columns of quantities, those of the first quantity first."""
    return [column for each in quantities for column in columns if column.channel.quantity == each and column.channel.measured]


def commanded(columns: Sequence[Column], quantity: Quantity) -> list[Column]:
    """Return the references of a quantity."""
    return [column for column in columns if column.channel.quantity == quantity and column.channel.commanded]


def first(columns: Sequence[Column], quantity: Quantity) -> dict[str, Column]:
    """Return the first measured column of a quantity by its name; empty if there is none."""
    return {str(quantity): column for column in measured(columns, quantity)[:1]}


def needed_effort(columns: Sequence[Column], title: str) -> tuple[Quantity, Column]:
    """Return the one torque, or the one current if no torque was measured, with its quantity; raises as `needed`."""
    quantity: Quantity = "torque" if measured(columns, "torque") else "current"
    return quantity, needed(columns, quantity, title)


def needed(columns: Sequence[Column], quantity: Quantity, title: str) -> Column:
    """Return the one column of a quantity, or the one that a person named.

    Args:
        columns: of the file
        quantity: that it must have
        title: of the kind of measurement that needs it

    Raises:
        QuestionError: there is none, or several
    """
    found = measured(columns, quantity)
    found = found if len(found) == 1 else [column for column in found if column.by_user] or found
    if len(found) == 1:
        return found[0]
    lack = f"each of {names_of(found)} may be it" if found else f"it has {names_of(columns)}"
    raise QuestionError(f"{title} needs one {quantity}: {lack}", columns_for(quantity, found))


def channels(wanted: Mapping[str, Sequence[Column]]) -> dict[str, Column]:
    """Return the column of each channel, of those that may be it; raises as `put`."""
    found = dict[str, Column]()
    for name, columns in wanted.items():
        for column in columns:
            put(found, name, column)
    return found


def put(found: dict[str, Column], name: str, column: Column) -> None:
    """Add the column of a channel; one that a person named replaces one that has it by its name.

    Raises:
        QuestionError: both may be the channel
    """
    if name not in found or (column.by_user and not found[name].by_user):
        found[name] = column
    elif column.by_user or not found[name].by_user:
        both = [found[name], column]
        raise QuestionError(f"{pair(*both)} may both be the {name}", columns_for(name, both))


def columns_for(name: str, columns: Sequence[Column]) -> list[Answer]:
    """Return the answers to which of some columns is a channel."""
    return [Answer(column.name, {"columns": {name: column.reference}}) for column in columns]


def names_of(columns: Sequence[Column]) -> str:
    """Return the names of columns in one list, of many the first ones and their number."""
    names = [column.name for column in columns]
    return listed(names) if len(names) <= MAX_NAMED else f"{listed(names[:MAX_NAMED])} and {len(names) - MAX_NAMED} more"
