"""A shaft that turns in a recording: evenly in time, without wraps, each sample with its direction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi, tau

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.files.units import convert
from strainwave.messages import quoted

Array = NDArray[np.float64]

MIN_SAMPLES = 64  # samples
MAX_WRAPPED_STEP = 0.45 * tau  # between samples of an angle that wraps; beyond it the sense is a guess
MAX_GAP_SAMPLES = 8  # samples missing in a row that are filled with a straight line
MAX_JITTER_STEPS = 0.35  # of a step, by which a time stamp may be off
MAX_STEP_RATIO = 4.0  # steps, that one of twenty steps may be long: others are no clock
MAX_FILLED_STEPS = 2.5  # steps without a row, between which nothing is known
REST_SPEED_SHARE = 1e-3  # of the fastest speed, below which a shaft counts as resting


@dataclass(frozen=True, eq=False)
class Evenly(ComparedByFields):
    """Columns of a recording, evenly in time.

    Attributes:
        columns: by name, as in the recording, shape (n,)
        measured: where there was a row; elsewhere the columns are straight lines between their neighbours, shape (n,)
        step: between two samples [s]; 1 without time
        timed: whether there is a time
        start: time of the first sample [s]; 0 without time
        remarks: what was done to the recording, in words
    """

    columns: dict[str, Array]
    measured: NDArray[np.bool_]
    step: float
    timed: bool
    start: float
    remarks: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.measured)


def evenly(recording: Recording, names: Sequence[str], rate: float | None = None) -> Evenly:
    """Return the named columns, each row at its place in an even time; `rate` [Hz] is for a recording without time.

    Stamps are rounded to whole steps of their median distance, so that jitter of the stamps does not matter; where they are
    more uneven than that, rows are put on an even clock by interpolation. Where rows are missing for long, the longest stretch
    without such a gap is taken. Remarks follow.
    """
    columns = {name: recording[name] for name in names}
    count = len(recording)
    if rate is not None:
        rate = arguments.number("rate", rate, "Hz", low=0.0)
    if count < MIN_SAMPLES:
        raise ValueError(f"the recording has {count} samples; orders need {MIN_SAMPLES} or more: record longer")
    if "time" not in recording:
        step = 1.0 if rate is None else 1.0 / rate
        return Evenly(columns, np.ones(count, dtype=bool), step, rate is not None, 0.0, ())
    if rate is not None:
        raise ValueError(f"rate = {rate:g} Hz is given, but the recording has a time; leave one of them out")
    return _placed(columns, recording.time)


def beginning(record: Evenly, count: int | None) -> Evenly:
    """Return the first samples of a long record, with a remark; a shorter record itself."""
    if count is None or len(record) <= count:
        return record
    remark = f"the first {count} of {len(record)} samples are used, which is enough for orders"
    columns = {name: values[:count] for name, values in record.columns.items()}
    return replace(record, columns=columns, measured=record.measured[:count], remarks=(*record.remarks, remark))


def evenly_turning(
    recording: Recording, angles: Sequence[str], columns: Sequence[str], rate: float | None, count: int | None = None
) -> Evenly:
    """Return columns as `evenly`, at most `count` samples; angles in rad go on over revolutions."""
    record = beginning(evenly(recording, [*angles, *columns], rate), count)
    turned = {name: unwrapped(name, convert(record.columns[name], recording.unit(name), "rad")) for name in angles}
    return replace(record, columns={**record.columns, **turned})


def _placed(columns: dict[str, Array], time: Array) -> Evenly:
    steps = np.diff(time)
    step = float(np.median(steps))
    whole = np.rint(steps / step)
    off = np.abs(steps - whole * step)
    if float(np.quantile(off, 0.95)) > MAX_JITTER_STEPS * step:
        return _resampled(columns, time, step)
    place = np.concatenate([[0], np.cumsum(whole)]).astype(int)
    first = np.concatenate([[True], np.diff(place) > 0])
    remarks = []
    if doubled := int(np.sum(~first)):
        remarks.append(f"{doubled} rows repeat the time of the row before and are left out")
    place, time = place[first], time[first]
    columns = {name: values[first] for name, values in columns.items()}
    stretch = _longest(place)
    if stretch.stop - stretch.start < len(place):
        used, all_of_it = time[stretch.stop - 1] - time[stretch.start], time[-1] - time[0]
        remarks.append(
            f"rows are missing for more than {MAX_GAP_SAMPLES} samples; the longest stretch without such a gap is used, "
            f"{used:.4g} s of {all_of_it:.4g} s"
        )
    place, time = place[stretch] - place[stretch.start], time[stretch]
    count = int(place[-1]) + 1
    if count < MIN_SAMPLES:
        raise ValueError(f"{count} samples lie between gaps; orders need {MIN_SAMPLES} or more: record without gaps")
    if missing := count - len(place):
        remarks.append(f"{missing} of {count} samples are missing; straight lines stand for them")
    measured = np.zeros(count, dtype=bool)
    measured[place] = True
    everywhere = np.arange(count)
    filled = {name: np.interp(everywhere, place, values[stretch]) for name, values in columns.items()}
    exact = float(np.polyfit(place, time, 1)[0])
    return Evenly(filled, measured, exact, True, float(time[0]), tuple(remarks))


def _resampled(columns: dict[str, Array], time: Array, step: float) -> Evenly:
    """Return rows of an uneven clock on an even one, by interpolation."""
    from scipy.interpolate import Akima1DInterpolator

    steps = np.diff(time)
    if (often := float(np.quantile(steps, 0.95))) > MAX_STEP_RATIO * step:
        raise ValueError(
            f"time is not even: every second step between samples is longer than {step:.4g} s, and every twentieth longer than "
            f"{often:.4g} s; orders need samples at nearly equal distances: leave the time out, or record at a fixed rate"
        )
    stretch = _longest(np.rint((time - time[0]) / step).astype(int))
    remarks = [f"its clock is not even: rows are put on one of {1.0 / step:.4g} Hz by interpolation"]
    if stretch.stop - stretch.start < len(time):
        remarks.append(
            f"rows are missing for more than {MAX_GAP_SAMPLES} samples; the longest stretch without such a gap is used"
        )
    when = time[stretch]
    grid = np.arange(when[0], when[-1], step)
    if len(grid) < MIN_SAMPLES:
        raise ValueError(f"{len(grid)} samples lie between gaps; orders need {MIN_SAMPLES} or more: record without gaps")
    after = np.clip(np.searchsorted(when, grid), 1, len(when) - 1)
    measured = when[after] - when[after - 1] < MAX_FILLED_STEPS * step
    resampled = {name: np.asarray(Akima1DInterpolator(when, values[stretch])(grid)) for name, values in columns.items()}
    return Evenly(resampled, measured, step, True, float(when[0]), tuple(remarks))


def _longest(place: NDArray[np.int_]) -> slice:
    """Return the longest run of places without a long gap."""
    edges = np.concatenate([[0], np.flatnonzero(np.diff(place) > MAX_GAP_SAMPLES + 1) + 1, [len(place)]])
    longest = int(np.argmax(np.diff(edges)))
    return slice(int(edges[longest]), int(edges[longest + 1]))


def unwrapped(name: str, angle: Array) -> Array:
    """Return an angle that goes on where a revolution ends [rad], shape (n,); one that goes on already, unchanged.

    An angle that stays within one revolution, and jumps by more than half of one, is taken to wrap.

    >>> unwrapped("input_angle", np.array([6.0, 6.2, 0.1, 0.3])).round(3)
    array([6.   , 6.2  , 6.383, 6.583])
    """
    jumps = np.abs(np.diff(angle)) > pi
    if not jumps.any() or float(np.ptp(angle)) > tau * (1.0 + 1e-3):
        return angle
    turned = np.unwrap(angle)
    if (largest := float(np.quantile(np.abs(np.diff(turned)), 0.999))) > MAX_WRAPPED_STEP:
        raise ValueError(
            f"{quoted(name)} wraps at each revolution and turns by up to {largest:.3g} rad between two samples; beyond half a "
            "revolution its direction is not determined; record faster, or turn slower"
        )
    return turned


def smooth_speed(angle: Array, reach: int) -> Array:
    """Return the slope of a line through 2 reach + 1 samples [rad per sample], shape (n,)."""
    weights = np.arange(reach, -reach - 1.0, -1.0)
    return np.pad(np.convolve(angle, weights, "valid") / (weights @ weights), reach, mode="edge")


def direction(speed: Array) -> Array:
    """Return 1 forward, -1 backward, shape (n,); at rest that of the motion before, or of the first one."""
    fastest = float(np.abs(speed).max())
    sense = np.where(np.abs(speed) > REST_SPEED_SHARE * fastest, np.sign(speed), 0.0)
    moving = np.flatnonzero(sense)
    if not len(moving):
        return np.zeros_like(speed)
    last = np.maximum.accumulate(np.where(sense != 0.0, np.arange(len(sense)), moving[0]))
    return np.asarray(sense[last])


def reach_of(count: int) -> int:
    """Return the samples on each side that a speed is fitted to: few, as orders pass in tens of samples."""
    return max(1, min(5, count // 32))
