"""MDF files of measurement systems in vehicles and test benches, versions 2 to 4.

They are read here and not by a library: asammdf evaluates the formulas that a file contains, as code, and follows links, claims
and external files without a bound. Here a formula refuses its channel, and one budget bounds blocks, bytes and depth.
"""

from __future__ import annotations

import mmap
from collections import Counter
from collections.abc import Collection, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.budget import ReadBudget, RefusedFile, open_regular
from strainwave.files.labels import check_names, read_by_others
from strainwave.files.mdf3_blocks import channel_groups
from strainwave.files.mdf4_blocks import Mdf4File
from strainwave.files.mdf_channels import Bytes, ChannelGroup, channel_values
from strainwave.files.mdf_conversion import RefusedChannel
from strainwave.files.table_format import Format
from strainwave.messages import one_line

Array = NDArray[np.float64]
MAGIC = (b"MDF ", b"UnFinMF ")  # at the beginning of every MDF file; the second while it is still being recorded


def open_mdf(path: str | Path) -> GridTable:
    """The channels of an MDF file that contain numbers, each group of them on a grid of its own.

    Linear, rational and table conversions are applied. A channel whose conversion is a formula is left out by its name.
    """
    grids: list[Grid] = []
    units = {"time": "s"}  # of the instants, whose name no channel shares
    left_out: list[str] = []
    with read_by_others(path, "MDF"), open_regular(path) as file:
        data = np.frombuffer(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ), np.uint8)
        budget, names, tries = ReadBudget(len(data)), list[str](), Counter[tuple[str, int]]()
        for number, group in enumerate(_groups(data, budget)):
            names += [channel.name for channel in group.channels]
            check_names(names)
            if len(group.records) and (grid := _grid(group, number, units, tries, left_out, budget)):
                grids.append(grid)
    return grid_table(one_line(str(path)), "", grids, units, left_out)


def _groups(data: Bytes, budget: ReadBudget) -> Iterator[ChannelGroup]:
    begin = data[:64].tobytes()
    if begin.startswith(MAGIC[1]):
        raise RefusedFile("was not closed by its recorder (UnFinMF); let the recorder's software finalise it")
    if not begin.startswith(MAGIC[0]):
        raise ValueError("no MDF file")
    version = int.from_bytes(begin[28:30], "little")
    return Mdf4File(data, budget).channel_groups() if version >= 400 else channel_groups(data, budget)


def _grid(
    group: ChannelGroup,
    number: int,
    units: dict[str, str],
    tries: Counter[tuple[str, int]],
    left_out: list[str],
    budget: ReadBudget,
) -> Grid | None:
    """Return the channels of a group; add what they are measured in, and what of it is not read."""
    try:
        time = _time(group, budget)
    except RefusedChannel as refused:
        left_out.append(f"channel group {number} is left out: {refused}")
        return None
    columns: dict[str, Array] = {}
    for channel in group.channels:
        if channel.is_master:
            continue
        name = _unique(channel.name, number, units, tries)
        try:
            columns[name] = channel_values(channel, group.records, budget)
            units[name] = channel.unit
        except RefusedChannel as refused:
            left_out.append(f"{name} is left out: {refused}")
    return Grid(time, columns) if columns else None


def _time(group: ChannelGroup, budget: ReadBudget) -> Array:
    """Return the instants of a group [s]."""
    if group.master is None:
        raise RefusedChannel("it has no time channel")
    channel, records = group.master
    if not channel.is_time:
        raise RefusedChannel(f"{channel.name}, over which it was sampled, is not the time")
    if len(records) != len(group.records):
        raise RefusedFile(f"has {len(group.records)} samples at {len(records)} instants of {channel.name}")
    return channel_values(channel, records, budget)


def _unique(name: str, group: int, taken: Collection[str], tries: Counter[tuple[str, int]]) -> str:
    """Return the name, with the number of its group behind it where the file has it already; `tries` counts these."""
    found = name
    while found in taken:
        count = tries[name, group]
        tries[name, group] += 1
        found = f"{name}.{group}.{count}" if count else f"{name}.{group}"
    return found


ABOUT = (
    "version 2 to 4: the numeric channels; invalid values become nan. Linear, rational and table conversions are applied. A "
    "formula is never evaluated: its channel is left out and named."
)
FORMAT: Format = Format((".mf4", ".mdf"), open_mdf, "MDF", "of the channel", about=ABOUT)
