"""Settling time of a response."""

from __future__ import annotations

from math import inf

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.recording import Recording, check_recording
from strainwave.messages import unquoted

Array = NDArray[np.float64]


def settling_time(
    response: Recording,
    name: str = "output_angle",
    *,
    band: float = 0.02,
    final: float | None = None,
    start: float | None = None,
) -> float:
    r"""Return the time from a change until a response stays within a band around its final value.

    .. math:: |y(t) - y_f| \le b\, |y_f - y(t_0)| \quad \text{for all } t \ge t_0 + t_s

    with y_f the final value, b the band, t_0 the start and t_s what is returned. Between samples the response is a straight
    line. A recording that ends before the response has settled shows it only where its last sample lies outside of the band:
    give the value that it settles at, or record longer. Of several changes, `Recording.between` takes one.

    Args:
        response: what was measured or simulated, with the column `time`
        name: the column that settles
        band: half the width of the band, as a share of the change, in (0, 1)
        final: what it settles at [unit of the column]; its last value if not given
        start: when the change begins [s]; the first sample if not given

    Returns:
        Time [s], from `start` on; 0 where the response never leaves the band, inf where it ends outside.

    Raises:
        TypeError: an argument is not of its kind
        ValueError: there is no such column or no time, `band` lies outside of (0, 1), `start` lies outside of the recording, or
            the response begins at its final value

    >>> time = np.linspace(0.0, 1.0, 1001)
    >>> lag = Recording({"time": time, "speed": 1.0 - np.exp(-time / 0.1)}, {"time": "s", "speed": "rad/s"})
    >>> round(settling_time(lag, "speed", final=1.0), 4)  # 0.1 s times the logarithm of 50
    0.3912
    """
    check_recording("response", response)
    values, time = response[name], response.time
    band = arguments.number("band", band, low=0.0, high=1.0)
    last = float(values[-1]) if final is None else arguments.number("final", final, response.unit(name))
    first = time[0] if start is None else arguments.number("start", start, "s", "[]", time[0], time[-1])
    largest = max(float(np.abs(values).max()), abs(last)) or 1.0  # differences of large numbers could overflow
    offset = values / largest - last / largest
    at_start = float(np.interp(first, time, offset))
    if at_start == 0.0:
        there = f"{unquoted(name)} = {last:g} {response.unit(name)} at {first:g} s"
        raise ValueError(f"{there} is its final value already; give the start of a change, or the value that it leads to")
    later = time > first
    times, offsets = np.append(first, time[later]), np.append(at_start, offset[later])
    return _last_entry(times, offsets, band * abs(at_start)) - float(first)


def _last_entry(time: Array, offset: Array, width: float) -> float:
    """Return the time from which the offset stays within the width, on the straight line between two samples."""
    outside = np.flatnonzero(np.abs(offset) > width)
    if not outside.size:
        return float(time[0])
    before = int(outside[-1])
    if before == len(time) - 1:
        return inf
    side = np.sign(offset[before])
    from_there, to_there = side * offset[before], side * offset[before + 1]
    share = (from_there - width) / (from_there - to_there)
    return float(time[before] + share * (time[before + 1] - time[before]))
