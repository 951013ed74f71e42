"""Files that show one and the same measurement, which must not count twice."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from strainwave.files.recording import Recording
from strainwave.identification.experiments.drive_log import ENCODERS
from strainwave.identification.experiments.motion_log import EFFORTS
from strainwave.identification.reading.recognise import Recognised

Array = NDArray[np.float64]
ALIKE = 1e-3  # of the range: two readings of one number differ by less
OF_RUN = 4e-3  # of the usual deviation: two encoders of one drive that moved once differ by less, but for scale and zero
OF_TORQUE = 0.2  # of the same: noise and delay make as much


def same_as(files: Sequence[Recognised]) -> dict[str, str]:
    """Paths of files that show what another one shows, each with the path of that one: of several the one with most channels.

    Where they have as many, it is the first.
    """
    found: dict[str, str] = {}
    richest_first = sorted(files, key=lambda file: -len(file.recording.names))
    for place, file in enumerate(richest_first):
        for richer in richest_first[:place]:
            if str(richer.path) not in found and _alike(richer, file):
                found[str(file.path)] = str(richer.path)
                break
    return found


def _alike(one: Recognised, other: Recognised) -> bool:
    if one.kind != other.kind:
        return False
    if one.kind in ("log", "encoders"):
        return _same_run(one.recording, other.recording)
    names = [name for name in one.recording.names if name in other.recording]
    if len(one.recording) != len(other.recording) or len(names) < 2:
        return False
    return all(_close(one.recording[name], other.recording[name]) for name in names)


def _close(one: Array, other: Array) -> bool:
    return bool(np.all(np.abs(one - other) <= ALIKE * max(float(np.ptp(one)), 1e-300)))


def _same_run(one: Recording, other: Recording) -> bool:
    """Whether two logs show one motion: an angle of the one is a multiple of an angle of the other, at the same times."""
    first, second = _angle(one), _angle(other)
    if first is None or second is None:
        return False
    time = np.linspace(max(one.time[0], other.time[0]), min(one.time[-1], other.time[-1]), 500)
    if not time[-1] > time[0]:
        return False
    a, b = np.interp(time, one.time, first), np.interp(time, other.time, second)
    return _proportional(a, b, OF_RUN) and _same_effort(one, other, time)


def _same_effort(one: Recording, other: Recording, time: Array) -> bool:
    """Whether what moved them may be the same: two drives may follow one command with different loads."""
    first, second = ([name for name in EFFORTS if name in each] for each in (one, other))
    if not first or not second:
        return True
    common = [name for name in first if name in second]
    names = (common[0], common[0]) if common else (first[0], second[0])
    a, b = (np.interp(time, each.time, each[name]) for each, name in zip((one, other), names, strict=True))
    size = float(np.median(np.abs(a)) / max(np.median(np.abs(b)), 1e-300))
    return _proportional(a, b, OF_TORQUE) and (not common or abs(size - 1.0) < OF_TORQUE)


def _proportional(one: Array, other: Array, allowed: float) -> bool:
    """Whether two series are multiples of each other but for zeros and noise; outliers do not count."""
    if np.std(one) == 0.0 or np.std(other) == 0.0:
        return False
    a, b = (each - np.median(each) for each in (one, other))
    a, b = (
        each / (np.median(np.abs(each)) or np.std(each)) for each in (a, b)
    )  # what rests most of the time has no median size
    off = a - np.sign(a @ b) * b
    return bool(np.median(np.abs(off)) < allowed)


def _angle(recording: Recording) -> Array | None:
    names = [name for name in ENCODERS if name in recording]
    return recording[names[0]] if names and "time" in recording else None
