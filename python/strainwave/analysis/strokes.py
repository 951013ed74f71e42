"""Difference of two models of a drive over moves of growing stroke, each under its own controller."""

from __future__ import annotations

from math import inf, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Drive, arguments
from strainwave.files.recording import Recording, check_recording
from strainwave.simulation.run import simulate
from strainwave.simulation.scenario import Scenario, sine
from strainwave.simulation.signals import outputs

MOVE_DURATION = 2.0  # s: of a move
SWEEP_STEP = 1e-3  # s: ten times shorter steps change strokes by a few millionths
SAMPLE_TIME = 1e-3  # s


def move_of(angle: float, duration: float = MOVE_DURATION) -> Scenario:
    """Return half a cosine from rest at 0 to rest at an output angle [rad] in a time [s]."""
    return sine(0.5 * angle, frequency=0.5 / duration, duration=duration, phase=-0.5 * pi, offset=0.5 * angle)


def strokes_apart(first: Drive, second: Drive, strokes: ArrayLike, duration: float = MOVE_DURATION) -> Recording:
    """Return how far two models of a drive are apart over moves of growing stroke, as full and simplified friction.

    Each move is half a cosine from rest to rest.

    Args:
        first, second: with controllers of the output angle
        strokes: of the motor [rad]
        duration: of each move [s]

    Returns:
        A row for each stroke. Columns: `stroke` [rad at the motor]; root mean square of the difference of the two models in
        `output_angle` [rad] and, if both have a motor with one, in `current` [A]; and `used`, that of the first one's current
        [A].

    Raises:
        ValueError: a stroke or the duration is not positive, or a move cannot be run to its end

    >>> import strainwave as sw
    >>> full, simplified = sw.load("position-drive-full-friction"), sw.load("position-drive")
    >>> apart = sw.analysis.strokes_apart(full, simplified, [1.0, 100.0])
    >>> [round(1e6 * size) for size in apart["output_angle"].tolist()]  # urad
    [24, 257]
    """
    first, second = arguments.drive(first), arguments.drive(second)
    duration = arguments.number("duration", duration, "s", low=0.0)
    levels = np.atleast_1d(arguments.numbers("strokes", strokes))
    if levels.ndim != 1 or not levels.size:
        raise ValueError(f"strokes has shape {levels.shape}; it must be one series of at least one stroke")
    both = [name for name in ("output_angle", "current") if all(name in outputs(drive) for drive in (first, second))]
    rows = []
    for stroke in levels.tolist():
        angle = arguments.number("stroke", stroke, "rad", low=0.0) / abs(float(second.gear.kinematics.ratio))
        runs = [
            simulate(drive, move_of(angle, duration), SWEEP_STEP, sample=SAMPLE_TIME, record=both) for drive in (first, second)
        ]
        row = {name: _rms(runs[0][name] - runs[1][name]) for name in both}
        rows.append({"stroke": stroke} | row | ({"used": _rms(runs[0]["current"])} if "current" in both else {}))
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    return Recording(columns, {name: "A" if name in ("current", "used") else "rad" for name in columns})


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def stroke_within(apart: Recording, tolerance: ArrayLike, column: str = "output_angle") -> float:
    """Return the stroke [rad] up to which two models are apart by less than a tolerance; inf if they are at every stroke.

    Args:
        apart: as `strokes_apart` returns it; between its strokes a straight line is taken
        tolerance: the largest difference, in the unit of the column; one, or one for each stroke
        column: of `apart`

    Raises:
        TypeError, ValueError: `apart` is no recording with these columns, or there are not as many tolerances as strokes

    >>> import strainwave as sw
    >>> columns = {"stroke": [1.0, 2.0, 3.0], "output_angle": [1e-4, 2e-4, 4e-4]}
    >>> apart = sw.Recording(columns, dict.fromkeys(columns, "rad"))
    >>> sw.analysis.stroke_within(apart, 3e-4), sw.analysis.stroke_within(apart, 1e-3)
    (2.5, inf)
    """
    check_recording("apart", apart)
    place, allowed = apart["stroke"], arguments.numbers("tolerance", tolerance)
    if allowed.shape not in ((), place.shape):
        raise ValueError(f"tolerance has shape {allowed.shape}; it must be one number, or one for each of {len(place)} strokes")
    excess = apart[arguments.text("column", column)] - allowed
    above = np.flatnonzero(excess > 0.0)
    if not above.size:
        return inf
    after = int(above[0])
    if after == 0:
        return float(place[0])
    share = excess[after - 1] / (excess[after - 1] - excess[after])
    return float(place[after - 1] + share * (place[after] - place[after - 1]))
