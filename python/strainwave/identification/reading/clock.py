"""The time of a log whose stamps are crooked: jitter, gaps, repeated rows, restarts, or no stamps at all.

Each row of a log was sampled at some tick of a clock. Where the stamps lie about a regular clock by much less than a step, the
scatter is that of the stamps, and the regular time is taken: a line fitted to the stamps over the number of the tick, by least
squares. But where the angle of a shaft is as uneven as the stamps are, the shaft was sampled at uneven instants, and the stamps
are right. Where they do not lie about a regular clock, they are taken as they are, too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

REGULAR = 0.2  # of a step: root mean square of stamps about a regular clock, above which ticks could not be counted
EXACT = 1e-3  # of a step: what scatters less is taken as it is
SURE = 3.0  # standard deviations, by which an angle must follow its stamps rather than a clock
AGAIN = 0.5  # of a step: a row with the values of the row before it and a stamp so near is a repetition
RESTART = 10.0  # steps: a clock that goes back by more has begun anew
COARSE = 0.05  # of the rows: where more share the stamp of the row before, stamps are coarser than the samples
LARGEST = 1e12  # s: what lies beyond is no time
MOST = 1e12  # ticks from the first row to the last: more are none of a clock
LATE = 1e6  # s: stamps that begin later count from some epoch, and are counted from the first row instead


@dataclass(frozen=True, eq=False)
class Clock(ComparedByFields):
    """When the rows of a log were sampled.

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
    """The time of rows without stamps that were sampled at a known rate [1/s].

    >>> regular(3, rate=500.0).time
    array([0.   , 0.002, 0.004])
    """
    arguments.number("rate", rate, "Hz", "()", low=0.0)
    return Clock(
        np.arange(rows, dtype=float) / rate, np.arange(rows), (f"it has no time: {rate:g} rows in a second, as was said",)
    )


def clock(stamps: Array, repeated: NDArray[np.bool_] | None = None, angle: Array | None = None) -> Clock:
    """When rows were sampled, from their time stamps.

    Args:
        stamps: as they were recorded [s], shape (n,)
        repeated: whether a row holds the same values as the row before it, shape (n,); no row if not given
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
    if (largest := float(np.abs(stamps).max())) > LARGEST:
        raise ValueError(f"its time reaches {largest:g} s, which no log lasts; give its unit, with --unit time=UNIT")
    whole = _longest_stretch(stamps)
    rows, remarks = whole.rows, [*whole.remarks]
    step = _step(stamps[rows])
    if repeated is not None:
        again = np.zeros(len(rows), bool)
        again[1:] = repeated[rows[1:]] & (np.abs(np.diff(stamps[rows])) < AGAIN * step)
        if count := int(again.sum()):
            rows = rows[~again]
            remarks.append(f"{_rows(count)} {_verb(count, 'repeats', 'repeat')} the row before and {_is(count)} left out")
    found = _regular(stamps[rows], step, None if angle is None else angle[rows]) or _as_they_are(stamps[rows])
    time, began = found.time, 0.0
    if time[0] > LATE:
        began = float(time[0])
        time = time - began
        remarks.append("its time is counted from its first row")
    return Clock(time, rows[found.rows], (*remarks, *found.remarks), began)


def _longest_stretch(stamps: Array) -> Clock:
    """The longest stretch between restarts of the clock."""
    step = _step(stamps)
    restarts = np.flatnonzero(np.diff(stamps) < -RESTART * step) + 1
    if not restarts.size:
        return Clock(stamps, np.arange(len(stamps)))
    ends = np.array([0, *restarts, len(stamps)])
    longest = int(np.argmax(np.diff(ends)))
    rows = np.arange(ends[longest], ends[longest + 1])
    places = ", ".join(str(row) for row in restarts[:5]) + (" …" if len(restarts) > 5 else "")
    remark = (
        f"its time begins anew at row {places}: {len(restarts) + 1} recordings in one file, of which the longest is taken, "
        f"rows {rows[0]} to {rows[-1]}"
    )
    return Clock(stamps[rows], rows, (remark,))


def _step(stamps: Array) -> float:
    """The usual time from row to row."""
    steps = np.diff(stamps)
    if not (forward := steps[steps > 0.0]).size:
        raise ValueError("its time does not run forward; give the rate of its rows instead, with --rate HZ")
    return float(np.median(forward))


def _regular(stamps: Array, step: float, angle: Array | None) -> Clock | None:
    """The time of a regular clock, if the stamps lie about one."""
    if np.ptp(stamps) > MOST * step:
        return None
    same = np.diff(stamps) == 0.0
    if same.mean() > COARSE:
        return _of_coarse_stamps(stamps, step)
    ticks = np.cumsum([0, *np.round(np.diff(stamps) / step).astype(int)])
    for _ in range(5):
        begin, period = _line(ticks, stamps)
        if period <= 0.0:
            return None
        better = np.round((stamps - begin) / period).astype(int)
        if np.array_equal(better, ticks):
            break
        ticks = better
    time = begin + period * ticks.astype(float)
    scatter = float(np.sqrt(np.mean((stamps - time) ** 2)))
    if not (np.diff(ticks) > 0).all() or scatter > REGULAR * period:
        return None
    gaps = _gaps(ticks, stamps, period)
    if scatter <= EXACT * period and (np.diff(stamps) > 0.0).all():
        return Clock(stamps, np.arange(len(stamps)), gaps)
    if angle is not None and (np.diff(stamps) > 0.0).all() and _follows(angle, time, stamps - time):
        said = f"rows were sampled at uneven instants, as the angle shows: by {scatter * 1e3:.3g} ms about a clock of "
        return Clock(stamps, np.arange(len(stamps)), (*gaps, f"{said}{1.0 / period:.4g} Hz; the stamps are taken"))
    return Clock(time, np.arange(len(stamps)), (*gaps, _told(scatter, period)))


def _follows(angle: Array, time: Array, late: Array) -> bool:
    """Whether an angle is as much further as a sample is late: second differences, which see little of the motion itself."""
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
    return slope > 0.5 + SURE * sigma


def _of_coarse_stamps(stamps: Array, step: float) -> Clock | None:
    """The time of a regular clock without gaps, whose stamps are coarser than its steps."""
    ticks = np.arange(len(stamps))
    begin, period = _line(ticks, stamps)
    time = begin + period * ticks.astype(float)
    if not (np.diff(time) > 0.0).all() or np.abs(stamps - time).max() > step:
        return None
    return Clock(time, ticks, (_told(float(np.sqrt(np.mean((stamps - time) ** 2))), period),))


def _line(ticks: NDArray[np.int64], stamps: Array) -> tuple[float, float]:
    """Begin and period of a clock by least squares."""
    about = ticks - ticks.mean()
    period = float(about @ (stamps - stamps.mean()) / (about @ about))
    return float(stamps.mean() - period * ticks.mean()), period


def _gaps(ticks: NDArray[np.int64], stamps: Array, period: float) -> tuple[str, ...]:
    steps = np.diff(ticks)
    missing = int((steps - 1).sum())
    if not missing:
        return ()
    places, widest = int((steps > 1).sum()), int(np.argmax(steps))
    where = f"a gap of {steps[widest] * period:.3g} s after {stamps[widest]:.6g} s"
    if places == 1:
        return (f"{_rows(missing)} {_is(missing)} missing: {where}",)
    return (f"{_rows(missing)} are missing at {places} places, the longest: {where}",)


def _told(scatter: float, period: float) -> str:
    return f"time stamps scatter by {scatter * 1e3:.3g} ms about a clock of {1.0 / period:.4g} Hz, which is taken"


def _as_they_are(stamps: Array) -> Clock:
    """The stamps of a clock that is not regular, without the rows that do not lie behind all before them."""
    latest = np.maximum.accumulate(stamps)
    forward = np.concatenate([[True], stamps[1:] > latest[:-1]])
    remarks = []
    if count := int((~forward).sum()):
        do = _verb(count, "does", "do")
        remarks.append(f"{_rows(count)} {do} not lie after the row before in time and {_is(count)} left out")
    rows = np.flatnonzero(forward)
    if len(rows) > 2:
        steps = np.diff(stamps[rows])
        low, middle, high = (f"{value * 1e3:.4g}" for value in (steps.min(), np.median(steps), steps.max()))
        remarks.append(f"its clock is not regular: steps from {low} ms to {high} ms, mostly {middle} ms; its stamps are taken")
    return Clock(stamps[rows], rows, tuple(remarks))


def _rows(count: int) -> str:
    return "1 row" if count == 1 else f"{count} rows"


def _is(count: int) -> str:
    return _verb(count, "is", "are")


def _verb(count: int, one: str, many: str) -> str:
    return one if count == 1 else many
