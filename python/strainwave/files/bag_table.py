"""Bags of the Robot Operating System: rosbag, rosbag2 and MCAP, by rosbags; the states of joints in them, and plain numbers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.labels import read_by_others
from strainwave.messages import one_line

Array = NDArray[np.float64]

JOINTS = "sensor_msgs/msg/JointState"
UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}  # of revolute joints, as the message defines them
NUMBERS = tuple(f"std_msgs/msg/{kind}" for kind in ("Float64", "Float32", "Int32", "Int64"))


def open_bag(path: str | Path) -> GridTable:
    """The channels of a bag: position, velocity and effort of each joint, as `elbow.position`, and topics of plain numbers.

    The time of a joint's state is that of its header; that of a plain number is when it was recorded. It counts from the first.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise ImportError(f"{Path(path).name}: bags are read by rosbags: pip install strainwave[formats]") from None

    samples: dict[str, list[tuple[int, dict[str, float]]]] = {}
    with (
        read_by_others(path, "bag"),
        AnyReader([Path(path)], default_typestore=get_typestore(Stores.LATEST)) as reader,
    ):
        wanted = [each for each in reader.connections if each.msgtype in (JOINTS, *NUMBERS)]
        several = len({each.topic for each in wanted if each.msgtype == JOINTS}) > 1
        for connection, stamp, data in reader.messages(wanted) if wanted else ():
            message: Any = reader.deserialize(data, connection.msgtype)
            if connection.msgtype == JOINTS:
                row = dict(_of_joints(message, f"{connection.topic.strip('/')}." if several else ""))
                samples.setdefault(connection.topic, []).append((_stamp(message) or stamp, row))
            else:
                name = connection.topic.strip("/").replace("/", ".")
                samples.setdefault(connection.topic, []).append((stamp, {name: float(message.data)}))
    begin = min((rows[0][0] for rows in samples.values()), default=0)
    grids = [_grid(rows, begin) for rows in samples.values()]
    names = [name for grid in grids for name in grid.columns]
    units = {name: UNITS[name.rpartition(".")[2]] for name in names if name.rpartition(".")[2] in UNITS}
    return grid_table(one_line(str(path)), "", grids, units)


def _of_joints(message: Any, prefix: str) -> Iterator[tuple[str, float]]:
    """What a message says of each joint; an effort or velocity that is not measured is left empty in it."""
    for channel in UNITS:
        values = getattr(message, channel)
        if len(values) == len(message.name):
            for joint, value in zip(message.name, values, strict=True):
                yield f"{prefix}{joint}.{channel}", float(value)


def _stamp(message: Any) -> int:
    """The time in the header [ns]; 0 where none was set."""
    stamp = message.header.stamp
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def _grid(rows: list[tuple[int, dict[str, float]]], begin: int) -> Grid:
    names = list(dict.fromkeys(name for _, row in rows for name in row))
    time = np.array([stamp - begin for stamp, _ in rows], float) * 1e-9
    return Grid(time, {name: np.array([row.get(name, np.nan) for _, row in rows]) for name in names})
