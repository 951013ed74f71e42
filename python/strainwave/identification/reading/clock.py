"""The time of a log whose stamps are crooked: jitter, gaps, repeated rows, restarts, or no stamps at all.

Each row of a log was sampled at some tick of a clock. If the stamps lie about a regular clock by much less than a step, the
scatter is that of the stamps, and the regular time is taken: a line fitted to the stamps over the number of the tick, by least
squares. But if the angle of a shaft is as uneven as the stamps are, the shaft was sampled at uneven instants, and the stamps
are right. If they do not lie about a regular clock, they are taken as they are, too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.identification.reading.times import restarts
from strainwave.questions import LOG_AT_RATE, Answer, QuestionError
from strainwave.statistics.student import SIGNIFICANCE_SIGMA

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

MAX_SCATTER = 0.2  # of a step: root mean square of stamps about a regular clock, above which ticks could not be counted
MAX_SCATTER_OF_EXACT = 1e-3  # of a step: such stamps are taken as they are
REPEAT_WINDOW = 0.5  # of a step: a row with the values of the row before it and a stamp so near is a repetition
MAX_SHARED_STAMPS = 0.05  # of the rows: if more share the stamp of the row before, stamps are coarser than the samples
MAX_TIME = 1e12  # s of a log
MAX_TICKS = 1e12  # from the first row to the last
MAX_BEGIN = 1e6  # s: later stamps count from some epoch
MAX_FITS = 5  # of a line to the ticks, until these stay the same


@dataclass(frozen=True, eq=False)
class Clock(ComparedByFields):
    """The instants at which the rows of a log were sampled.

    Args:
        time: of each row that is kept [s], increasing, shape (n,)
        rows: which rows are kept, shape (n,)
        remarks: what was found and done, in words
        began: the stamp from which the time is counted [s]
    """

    time: Array
    rows: Rows
    remarks: tuple[str, ...] = ()
    began: float = 0.0


def regular(rows: int, rate: float) -> Clock:
    """Return the time of rows without stamps that were sampled at a known rate [1/s].

    >>> regular(3, rate=500.0).time
    array([0.   , 0.002, 0.004])
    """
    rate = arguments.number("rate", rate, "Hz", "()", low=0.0)
    remark = f"it has no time: {rate:g} rows in a second, as was given"
    return Clock(np.arange(rows, dtype=float) / rate, np.arange(rows), (remark,))


def clock(stamps: Array, repeated: NDArray[np.bool_] | None = None, angle: Array | None = None) -> Clock:
    """Return the instants of rows, from their time stamps.

    Args:
        stamps: as they were recorded [s], shape (n,)
        repeated: True for a row with the same values as the row before it, shape (n,); no row if not given
        angle: of a shaft, which shows whether the stamps or the samples scatter, shape (n,)

    Raises:
        ValueError: the stamps do not run forward, or are no times

    >>> crooked = clock(np.array([0.0, 0.0101, 0.0199, 0.0401, 0.0499, 0.06]))
    >>> crooked.time.round(3).tolist()
    [0.0, 0.01, 0.02, 0.04, 0.05, 0.06]
    >>> for remark in crooked.remarks:
    ...     print(remark)
    1 row is missing: a gap of 0.02 s after 0.0199 s
    time stamps scatter by 0.0802 ms about a clock of 100.1 Hz, which is taken
    """
    if (largest := float(np.abs(stamps).max())) > MAX_TIME:
        ways = [Answer(f"in {unit}", {"units": {"time": unit}}) for unit in ("ms", "us", "ns")]
        raise QuestionError(f"its time reaches {largest:g} s, which no log lasts", ways)
    rows, remarks = _longest_stretch(stamps)
    step = _step(stamps[rows])
    if repeated is not None:
        again = np.zeros(len(rows), bool)
        again[1:] = repeated[rows[1:]] & (np.abs(np.diff(stamps[rows])) < REPEAT_WINDOW * step)
        if count := int(again.sum()):
            rows = rows[~again]
            remarks.append(f"{_rows(count, 'repeats', 'repeat')} the row before and {_are(count)} left out")
    found = _regular(stamps[rows], step, None if angle is None else angle[rows]) or _as_they_are(stamps[rows])
    began = float(found.time[0]) if found.time[0] > MAX_BEGIN else 0.0
    remarks += ["its time is counted from its first row"] if began else []
    return Clock(found.time - began, rows[found.rows], (*remarks, *found.remarks), began)


def _longest_stretch(stamps: Array) -> tuple[Rows, list[str]]:
    """Return the rows of the longest stretch between restarts of the clock, and what was left out."""
    begins = restarts(stamps)
    ends = np.array([0, *begins, len(stamps)])
    longest = int(np.argmax(np.diff(ends)))
    rows = np.arange(ends[longest], ends[longest + 1])
    if not begins.size:
        return rows, []
    places = ", ".join(str(row) for row in begins[:5]) + (" …" if len(begins) > 5 else "")
    of_several = f"{len(begins) + 1} recordings in one file, of which the longest is taken, rows {rows[0]} to {rows[-1]}"
    return rows, [f"its time begins anew at row {places}: {of_several}"]


def _step(stamps: Array) -> float:
    """Return the usual time from row to row [s]."""
    steps = np.diff(stamps)
    if not (forward := steps[steps > 0.0]).size:
        raise QuestionError("its time does not run forward", [LOG_AT_RATE])
    return float(np.median(forward))


def _regular(stamps: Array, step: float, angle: Array | None) -> Clock | None:
    """Return the time of a regular clock; None if the stamps do not lie about one."""
    if np.ptp(stamps) > MAX_TICKS * step:
        return None
    rows, steps = np.arange(len(stamps)), np.diff(stamps)
    is_coarse, rises = (steps == 0.0).mean() > MAX_SHARED_STAMPS, bool((steps > 0.0).all())
    ticks = rows if is_coarse else np.cumsum([0, *np.round(steps / step).astype(int)])
    for _ in range(MAX_FITS):
        begin, period = _line(ticks, stamps)
        better = ticks if is_coarse or period <= 0.0 else np.round((stamps - begin) / period).astype(int)
        if np.array_equal(better, ticks):
            break
        ticks = better
    time = begin + period * ticks.astype(float)
    scatter = float(np.sqrt(np.mean((stamps - time) ** 2)))
    is_near = np.abs(stamps - time).max() <= step if is_coarse else scatter <= MAX_SCATTER * period
    if not (np.diff(time) > 0.0).all() or not is_near:
        return None
    gaps, of_clock = _gaps(ticks, stamps, period), f"about a clock of {1.0 / period:.4g} Hz"
    if not is_coarse and rises and scatter <= MAX_SCATTER_OF_EXACT * period:
        return Clock(stamps, rows, gaps)
    if not is_coarse and rises and angle is not None and _follows(angle, time, stamps - time):
        why = f"rows were sampled at uneven instants, as the angle shows: by {scatter * 1e3:.3g} ms {of_clock}"
        return Clock(stamps, rows, (*gaps, f"{why}; the stamps are taken"))
    return Clock(time, rows, (*gaps, f"time stamps scatter by {scatter * 1e3:.3g} ms {of_clock}, which is taken"))


def _follows(angle: Array, time: Array, late: Array) -> bool:
    """True if an angle is as much further as a sample is late: second differences contain little of the motion itself."""
    if len(angle) < 5:
        return False
    speed = np.gradient(angle, time)
    smooth = np.convolve(speed, np.ones(5) / 5.0, "same")[1:-1]
    expected, seen = smooth * np.diff(late, 2), np.diff(angle, 2)
    square = float(expected @ expected)
    if square == 0.0:
        return False
    slope = float(expected @ seen) / square
    sigma = float(np.sqrt(np.mean((seen - slope * expected) ** 2) / square))
    return slope > 0.5 + SIGNIFICANCE_SIGMA * sigma


def _line(ticks: Rows, stamps: Array) -> tuple[float, float]:
    """Return begin and period of a clock [s] by least squares."""
    about = ticks - ticks.mean()
    period = float(about @ (stamps - stamps.mean()) / (about @ about))
    return float(stamps.mean() - period * ticks.mean()), period


def _gaps(ticks: Rows, stamps: Array, period: float) -> tuple[str, ...]:
    steps = np.diff(ticks)
    missing = int((steps - 1).sum())
    if not missing:
        return ()
    places, widest = int((steps > 1).sum()), int(np.argmax(steps))
    where = f"a gap of {steps[widest] * period:.3g} s after {stamps[widest]:.6g} s"
    at = "" if places == 1 else f" at {places} places, the longest"
    return (f"{_rows(missing, 'is', 'are')} missing{at}: {where}",)


def _as_they_are(stamps: Array) -> Clock:
    """Return the stamps of a clock that is not regular, without the rows that do not lie behind all before them."""
    latest = np.maximum.accumulate(stamps)
    forward = np.concatenate([[True], stamps[1:] > latest[:-1]])
    remarks = []
    if count := int((~forward).sum()):
        remarks.append(f"{_rows(count, 'does', 'do')} not lie after the row before in time and {_are(count)} left out")
    rows = np.flatnonzero(forward)
    if len(rows) > 2:
        steps = np.diff(stamps[rows])
        low, middle, high = (f"{value * 1e3:.4g}" for value in (steps.min(), np.median(steps), steps.max()))
        remarks.append(f"its clock is not regular: steps from {low} ms to {high} ms, mostly {middle} ms; its stamps are taken")
    return Clock(stamps[rows], rows, tuple(remarks))


def _rows(count: int, verb: str, of_several: str) -> str:
    return f"1 row {verb}" if count == 1 else f"{count} rows {of_several}"


def _are(count: int) -> str:
    return "is" if count == 1 else "are"
