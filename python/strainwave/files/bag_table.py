"""Bags of the Robot Operating System: rosbag, rosbag2 and MCAP; the states of joints in them, and plain numbers."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from strainwave.files.array_table import Grid, GridTable, grid_table
from strainwave.files.bag_containers import bag_files, messages_of
from strainwave.files.bag_messages import JOINTS, NUMBERS, UNITS, joint_states, plain_number
from strainwave.files.budget import ReadBudget
from strainwave.files.labels import check_names, read_by_others
from strainwave.files.table_format import Format
from strainwave.messages import one_line


def open_bag(path: str | Path) -> GridTable:
    """The channels of a bag: position, velocity and effort of each joint, as `elbow.position`, and topics of plain numbers.

    The time of a joint's state is that of its header; that of a plain number is when it was recorded. It counts from the first.
    """
    series: dict[tuple[str, str], _Series] = {}
    with read_by_others(path, "bag"):
        files = bag_files(Path(path))
        budget = ReadBudget(sum(file.stat().st_size for file in files))
        for message in messages_of(files, (JOINTS, *NUMBERS), budget):
            own = series.setdefault((message.topic, message.kind), _Series(budget))
            if message.kind == JOINTS:
                state = joint_states(message)
                own.add(message.stamp, state.stamp or message.stamp, dict(state.numbers))
            else:
                own.add(message.stamp, message.stamp, {"": plain_number(message)})
        begin = min((each.begin for each in series.values()), default=0)
        several = sum(kind == JOINTS for _, kind in series) > 1
        check_names([name for each in series.values() for name in each.columns])
        grids = [each.grid(begin, _prefix(topic, kind, several)) for (topic, kind), each in series.items()]
    names = [name for grid in grids for name in grid.columns]
    units = {name: UNITS[name.rpartition(".")[2]] for name in names if name.rpartition(".")[2] in UNITS}
    return grid_table(one_line(str(path)), "", grids, units)


def _prefix(topic: str, kind: str, several: bool) -> str:
    """Return what stands before the names of a topic's numbers."""
    if kind == JOINTS:
        return f"{topic.strip('/')}." if several else ""
    return topic.strip("/").replace("/", ".")


class _Series:
    """Numbers of one topic as they come, nan where a message lacks one."""

    def __init__(self, budget: ReadBudget) -> None:
        self.budget = budget
        self.recorded = array("q")  # ns
        self.stamps = array("q")  # ns
        self.columns: dict[str, array[float]] = {}

    def add(self, recorded: int, stamp: int, numbers: Mapping[str, float]) -> None:
        new = numbers.keys() - self.columns.keys()
        self.budget.take_bytes(8 * (2 + len(self.columns) + len(new) * (1 + len(self.stamps))), "its messages")
        self.columns.update((name, array("d", [np.nan]) * len(self.stamps)) for name in numbers if name in new)
        self.recorded.append(recorded)
        self.stamps.append(stamp)
        for name, values in self.columns.items():
            values.append(numbers.get(name, np.nan))

    @property
    def begin(self) -> int:
        """The stamp of the message that was recorded first [ns]."""
        return self.stamps[int(np.argmin(self.recorded))]

    def grid(self, begin: int, prefix: str) -> Grid:
        """Return the numbers in the order in which they were recorded."""
        order = np.argsort(self.recorded, kind="stable")
        time = (np.array(self.stamps)[order] - begin).astype(float) * 1e-9
        return Grid(time, {f"{prefix}{name}": np.array(values)[order] for name, values in self.columns.items()})


ABOUT = (
    "a file, or the folder of a bag. Each joint state has `knee.position`, `knee.velocity`, `knee.effort` over the time in "
    "its header; topics of plain numbers are columns, too. With several topics of joint states, the topic precedes the "
    "name."
)
FORMAT: Format = Format(
    (".bag", ".mcap", ".db3"), open_bag, "Bags of ROS 1 and 2", "of the message: rad, rad/s, N.m", about=ABOUT
)
