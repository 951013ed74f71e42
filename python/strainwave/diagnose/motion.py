"""A recording of a shaft prepared for orders: evenly in time, whole revolutions, without rest, with a speed free of ripple."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, tau

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.recording import Recording, check_recording
from strainwave.messages import quoted
from strainwave.orders.turning import evenly_turning, unwrapped

Array = NDArray[np.float64]

MIN_REVOLUTIONS = 1.0  # of the shaft, below which no order is determined
MIN_SPEED_SHARE = 0.1  # of a fast speed [1]: slower samples are left out, since friction turns over there
MAX_SAMPLES = 2**18  # samples that are fitted, the first ones
MAX_PHASE_STEP = 0.125 * pi  # rad of the highest order between two averaged samples: an amplitude loses 0.7 %
MAX_AVERAGED = 64  # samples in one mean
MAX_RATE = 1e9  # Hz, of samples
MAX_ROUNDING = 1e-6  # revolutions, by which a whole number may be missed


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """A turning shaft and a column, sampled evenly in time.

    Attributes:
        angle: of the shaft [rad], shape (n,)
        series: the column [unit of the column], shape (n,)
        load: load column, or None, shape (n,)
        speed: of the shaft over about a revolution, so that ripple of orders is not in it [rad/s], shape (n,)
        sense: 1 forward, -1 backward, shape (n,)
        step: between samples [s]
        every: neighbours averaged in each sample
        revolutions: of the shaft, end to end
        output_turns: of the output, end to end; nan if the ratio is not known
        ratio: size of the ratio; nan if it is not known
        remarks: what was done, in words
    """

    angle: Array
    series: Array
    load: Array | None
    speed: Array
    sense: Array
    step: float
    every: int
    revolutions: float
    output_turns: float
    ratio: float
    remarks: tuple[str, ...]

    def wave(self, order: float) -> tuple[Array, Array]:
        """Return sine and cosine of an order as the averaged samples have them, each of shape (n,)."""
        phase = order * self.angle
        half = 0.5 * order * self.speed * self.step / self.every
        with np.errstate(invalid="ignore", divide="ignore"):
            kept = np.where(np.abs(half) > 1e-12, np.sin(self.every * half) / (self.every * np.sin(half)), 1.0)
        return kept * np.sin(phase), kept * np.cos(phase)

    @property
    def reverses(self) -> bool:
        """True if the shaft turns both ways."""
        return bool(np.ptp(self.sense) > 0.0)


def motion_of(
    recording: Recording,
    column: str,
    highest: float,
    *,
    load_column: str | None = None,
    angle: str = "input_angle",
    ratio: float | None = None,
    rate: float | None = None,
) -> SampledMotion:
    """Return the shaft with the column, prepared for orders up to the highest.

    A motion of one sense is cut to its last whole revolutions: of the output if it makes one and its angle or the ratio is
    known, else of the shaft. So no whole order leaks into its neighbours. Samples are averaged as far as the highest order
    allows.

    Args:
        recording: with the column, the angle, and `time` if it is known
        column: current or torque
        highest: order [1]
        load_column: torque of the load, if it was measured
        angle: column with the angle of the shaft
        ratio: of the gear; from `output_angle` if it is recorded and no ratio is given
        rate: samples per second of a recording without time [Hz]

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a column is missing, or the shaft rests, or turns less than a revolution
    """
    check_recording("recording", recording)
    arguments.text("column", column)
    if rate is not None:
        rate = arguments.number("rate", rate, "Hz", "(]", 0.0, MAX_RATE)
    record = evenly_turning(recording, [angle], [column, *([load_column] if load_column else [])], rate, MAX_SAMPLES)
    turned, series, measured = record.columns[angle], record.columns[column], record.measured
    load = record.columns[load_column] if load_column else None
    _check_turns(turned, angle)
    size = _ratio(recording, turned, angle, ratio)
    moves = _senses(turned)
    cut, remarks = _whole(turned, size) if moves == 1 else (slice(None), [])
    turned, series, measured = turned[cut], series[cut], measured[cut]
    load = None if load is None else load[cut]
    speed = _slow_speed(turned) / record.step
    fast = float(np.quantile(np.abs(speed), 0.95))
    used = measured & (np.abs(speed) > MIN_SPEED_SHARE * fast)
    every = _averaged(fast * record.step, highest, len(turned))
    remarks = [*record.remarks, *remarks]
    if (resting := float(np.mean(~used))) > 0.01:
        remarks.append(f"{resting:.0%} of the samples are of rest or slow motion, or were filled in, and do not count")
    rows = _means(used.astype(float), every) == 1.0
    series_of = [_means(each, every)[rows] for each in (turned, series, speed)]
    turns = float(np.ptp(turned)) / tau
    return SampledMotion(
        angle=series_of[0],
        series=series_of[1],
        load=None if load is None else _means(load, every)[rows],
        speed=series_of[2],
        sense=np.sign(series_of[2]),
        step=record.step * every,
        every=every,
        revolutions=turns,
        output_turns=turns / size,
        ratio=size,
        remarks=tuple(remarks),
    )


def _check_turns(turned: Array, angle: str) -> None:
    turns = float(np.ptp(turned)) / tau
    if turns == 0.0:
        raise ValueError(f"{quoted(angle)} does not change: the shaft rests; record it while it turns")
    if turns < MIN_REVOLUTIONS:
        raise ValueError(
            f"{quoted(angle)} turns {turns:.3g} revolutions; orders need {MIN_REVOLUTIONS:g} or more: turn further"
        )


def _ratio(recording: Recording, turned: Array, angle: str, given: float | None) -> float:
    """Return the size of the ratio, from the output angle if none is given; nan if neither is known."""
    if given is not None:
        return abs(arguments.ratio("ratio", given))
    if "output_angle" not in recording or angle == "output_angle":
        return float("nan")
    output = unwrapped("output_angle", recording.values("output_angle", "rad"))
    span = float(np.ptp(output))
    return float(np.ptp(unwrapped(angle, recording.values(angle, "rad")))) / span if span > 0.0 else float("nan")


def _senses(turned: Array) -> int:
    """Return 1 if the shaft turns one way but for noise, else 2."""
    path = float(np.abs(np.diff(turned[:: max(1, len(turned) // 512)])).sum())
    return 1 if abs(float(turned[-1] - turned[0])) > 0.98 * path else 2


def _whole(turned: Array, ratio: float) -> tuple[slice, list[str]]:
    """Return the last whole revolutions: of the output if there is one, else of the shaft."""
    turns = abs(float(turned[-1] - turned[0])) / tau
    outputs = int(turns / ratio + MAX_ROUNDING) if ratio == ratio else 0
    period = ratio if outputs >= 1 else 1.0
    span = tau * period * int(turns / period + MAX_ROUNDING)
    left = np.abs(turned - turned[-1])
    first = int(np.searchsorted(-left, -span))
    if outputs >= 1 or ratio != ratio:
        return slice(first, None), []
    return slice(first, None), [f"the output turns {turns / ratio:.2g} revolutions: whole ones of the input are used"]


def _slow_speed(turned: Array) -> Array:
    """Return the speed over about a revolution, twice averaged [rad per sample], shape (n,)."""
    from scipy.ndimage import uniform_filter1d

    speed = np.gradient(turned)
    fast = float(np.quantile(np.abs(speed), 0.9))
    width = int(np.clip(round(tau / max(fast, 1e-300)), 3, max(3, len(turned) // 8))) | 1
    for _ in range(2):
        speed = uniform_filter1d(speed, width, mode="nearest")
    return speed


def _averaged(fast: float, highest: float, count: int) -> int:
    """Return the neighbours to average that keep the highest order, and enough samples."""
    by_order = int(MAX_PHASE_STEP / max(fast * highest, 1e-300))
    return max(1, min(by_order, MAX_AVERAGED, count // 512))


def _means(series: Array, every: int) -> Array:
    """Return means of so many neighbours each; the rest at the beginning is left out."""
    rest = len(series) % every
    means: Array = series[rest:].reshape(-1, every).mean(axis=1)
    return means
