"""Recordings that stand in several files: a log that goes on where another one ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.identification.experiments.drive_log import ENCODERS
from strainwave.identification.reading.recognise import Recognised
from strainwave.messages import listed

Array = NDArray[np.float64]

NEXT = (0.2, 3.0)  # steps of the clock from the last row of one file to the first of the next
FURTHER = 3.0  # of the largest step, by which an angle may move from the one to the other


def joined(files: Sequence[Recognised]) -> list[Recognised]:
    """The files, with logs that go on where others end joined to them.

    A log goes on where it has the same channels, its time begins a step behind the end of the other's, and its angles where the
    other's end. A clock that begins anew in each file does not show whether rows are missing between: such files stay apart.

    Args:
        files: in any order

    Returns:
        those that are left, in the order of their first parts
    """
    logs = sorted((file for file in files if file.kind == "log"), key=lambda file: file.began + float(file.recording.time[0]))
    chains: list[list[Recognised]] = []
    for log in logs:
        chain = next((each for each in chains if _goes_on(each[-1], log)), None)
        chains += [[log]] if chain is None else []
        if chain is not None:
            chain.append(log)
    wholes = {id(chain[0]): _whole(chain) for chain in chains}
    return [wholes.get(id(file), file) for file in files if file.kind != "log" or id(file) in wholes]


def _whole(chain: Sequence[Recognised]) -> Recognised:
    """The log whose parts these are."""
    first, *others = chain
    if not others:
        return first
    names = first.recording.names
    columns = {name: np.concatenate([each.recording[name] for each in chain]) for name in names if name != "time"}
    time = np.concatenate([each.recording.time + (each.began - first.began) for each in chain])
    units = {name: first.recording.unit(name) for name in names}
    do = "goes on where it ends, and is" if len(others) == 1 else "go on where it ends, and are"
    remark = f"{listed(each.path.name for each in others)} {do} joined to it"
    recording = Recording({"time": time, **columns}, units, first.recording.title)
    return replace(first, recording=recording, remarks=(remark, *first.remarks))


def _goes_on(one: Recognised, other: Recognised) -> bool:
    """Whether a log goes on in another file."""
    before, after = one.recording, other.recording
    if (set(before.names), one.constants, one.joint) != (set(after.names), other.constants, other.joint):
        return False
    if min(len(before), len(after)) < 2:
        return False
    step = float(np.median(np.diff(before.time)))
    apart = (other.began + float(after.time[0])) - (one.began + float(before.time[-1]))
    return NEXT[0] * step < apart < NEXT[1] * step and all(
        _near(before[name], after[name]) for name in ENCODERS if name in before
    )


def _near(before: Array, after: Array) -> bool:
    steps = np.abs(np.diff(before))
    return bool(abs(after[0] - before[-1]) <= FURTHER * max(float(steps.max()), 1e-300))
