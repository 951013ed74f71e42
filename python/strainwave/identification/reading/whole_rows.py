"""Rows in which each column has a number, also of channels that were sampled at other instants."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from strainwave.files.tables import OpenTable
from strainwave.identification.reading.column import Column
from strainwave.messages import listed, one_line

MIN_WHOLE = 0.5  # of the rows of the slowest channel: with fewer whole rows the channels were sampled at other instants


def whole_rows(table: OpenTable, columns: Sequence[Column], remarks: list[str]) -> tuple[list[Column], list[str]]:
    """Return the rows in which each column has a number, or those of the slowest channel; and the remarks with what was done."""
    whole = np.all([np.isfinite(column.si) for column in columns], axis=0)
    if whole.all():
        return list(columns), remarks
    if (resampled := _resampled(columns)) is not None:
        return resampled[0], [*remarks, resampled[1]]
    if not whole.any():
        empty = listed(column.name for column in columns if not np.isfinite(column.si).any()) or "no single column"
        raise ValueError(one_line(f"{table.file}: no row has a number in each of its columns; all are missing in {empty}"))
    lost = int((~whole).sum())
    rows = "1 row without a number in each column is" if lost == 1 else f"{lost} rows without a number in each column are"
    remarks.append(f"{rows} left out, the first at {table.place(int(np.argmin(whole)))}")
    return [replace(column, si=column.si[whole]) for column in columns], remarks


def _resampled(columns: Sequence[Column]) -> tuple[list[Column], str] | None:
    """Return the columns at the instants of the slowest but for temperatures, by linear interpolation; and a remark.

    None if most rows of this one are whole, or there is no time.
    """
    time = next((column.si for column in columns if column.channel.quantity == "time"), None)
    others = [column for column in columns if column.channel.quantity not in ("time", "temperature")]
    if time is None or not others:
        return None
    stamped = np.isfinite(time)
    there = {column.position: np.isfinite(column.si) & stamped for column in columns}
    slowest = min(others, key=lambda column: int(there[column.position].sum()))
    rows = there[slowest.position].copy()
    whole = np.all(list(there.values()), axis=0)
    if whole.sum() > MIN_WHOLE * rows.sum() or not all(each.sum() > 1 for each in there.values()):
        return None
    for column in others:
        own = time[there[column.position]]
        rows &= (time >= own.min()) & (time <= own.max())
    if not rows.any():
        return None
    found, moved = [], []
    for column in columns:
        finite = there[column.position]
        if (finite & rows).sum() == rows.sum():
            found.append(replace(column, si=column.si[rows]))
            continue
        moved.append(column.name)
        order = np.argsort(time[finite], kind="stable")
        found.append(replace(column, si=np.interp(time[rows], time[finite][order], column.si[finite][order])))
    remark = f"rows are of several channels: at the {int(rows.sum())} rows of {slowest.name}"
    return found, f"{remark}, {listed(moved)} is taken by linear interpolation"
