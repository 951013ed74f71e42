"""Torsion loop of one amplitude, both ways apart: what the width of a loop is computed from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave._core import Gear
from strainwave.analysis.branches import turning_points
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.typeset import quantity

Array = NDArray[np.float64]

MAX_REACH_DIFFERENCE = 0.05  # of the span: reversals of one loop that differ by more are those of several
MIN_SAMPLES_PER_WAY = 10
RATE_DEGREE = 5  # of the polynomial in time of one way: half a period of a sine to 1e-4
PLANNED_SAMPLES = 400


@dataclass(frozen=True, eq=False)
class LossLoop(ComparedByFields):
    """Both ways of a torsion loop of one amplitude, referred to the output.

    Attributes:
        twist: shape (n,) [rad]
        torque: shape (n,) [N.m]
        sense: 1 on the way up, -1 down, shape (n,)
        rate: of the twist without its sign, shape (n,) [rad/s]; not a number without a clock
        ratio: of the gear without its sign if the loop was measured at the input, 0 if at the output
        frequency: angular, of the sine whose mean squares of twist and rate are those of the loop [rad/s]; not a number without
            a clock
        temperature: mean [K]; not a number if it was not measured
        ends: smallest and largest twist, at the reversals [rad]
        reach: half of the range of the torque, reversals included [N.m]
    """

    twist: Array
    torque: Array
    sense: Array
    rate: Array
    ratio: float
    frequency: float
    temperature: float
    ends: tuple[float, float]
    reach: float

    @classmethod
    def of(cls, recording: Recording, gear: Gear) -> LossLoop:
        """Return the loop of a recording, without the first way of a gear that was not loaded before.

        Raises:
            ValueError: the columns are none of a loop, it has no two ways, or reversals of several amplitudes
        """
        loop = TorsionLoop.of(recording, gear)
        turns = turning_points(loop.twist)
        ends = [0, *turns, len(loop.twist) - 1]
        span = float(np.ptp(loop.twist))
        away = np.minimum(loop.twist - loop.twist.min(), loop.twist.max() - loop.twist) > MAX_REACH_DIFFERENCE * span
        if any(away[turns]):
            raise ValueError("it reverses at several amplitudes; give a recording for each amplitude")
        first = 1 if away[0] else 0
        ways = [slice(begin, end) for begin, end in zip(ends[first:-1], ends[first + 1 :], strict=True)]
        sense, rate = np.zeros(len(loop.twist)), np.full(len(loop.twist), np.nan)
        time = None
        if "time" in recording and loop.moments is not None:
            time = loop.moments * float(np.ptp(recording.time))
        for way in ways:
            sense[way] = np.sign(loop.twist[way.stop] - loop.twist[way.start])
        _check_ways(sense)
        for way in ways:
            if time is not None:
                path = np.polynomial.Polynomial.fit(time[way], loop.twist[way], RATE_DEGREE)
                rate[way] = np.abs(path.deriv()(time[way]))
        low, high = float(loop.twist.min()), float(loop.twist.max())
        kept = sense != 0.0
        warmth = float(np.mean(recording.values("temperature", "K"))) if "temperature" in recording else np.nan
        ratio = 0.0 if loop.input_ratio is None else abs(loop.input_ratio)
        frequency = np.nan if time is None else _frequency(time[kept], loop.twist[kept] - 0.5 * (low + high), rate[kept])
        series, reach = (loop.twist[kept], loop.torque[kept], sense[kept], rate[kept]), 0.5 * float(np.ptp(loop.torque[kept]))
        return cls(*series, ratio, frequency, warmth, (low, high), reach)

    def apart(self, share: float) -> LossLoop:
        """Return the loop without what is nearer to a reversal than a share of the span, on both ways alike.

        Raises:
            ValueError: few samples are left of a way
        """
        low, high = self.ends
        kept = np.minimum(self.twist - low, high - self.twist) >= share * (high - low)
        _check_ways(self.sense[kept])
        series = (self.twist[kept], self.torque[kept], self.sense[kept], self.rate[kept])
        return LossLoop(*series, self.ratio, self.frequency, self.temperature, self.ends, self.reach)

    @classmethod
    def planned(cls, ratio: float, stiffness: float, reach: float, rate: float, temperature: float) -> LossLoop:
        """Return a loop of a linear spring that could be measured, without a width."""
        up = np.linspace(-reach, reach, PLANNED_SAMPLES // 2)[1:-1]
        torque = np.concatenate((up, up[::-1]))
        sense = np.repeat([1.0, -1.0], len(up))
        ends = -reach / stiffness, reach / stiffness
        frequency = np.sqrt(3.0) * rate / ends[1]
        return cls(torque / stiffness, torque, sense, np.full(len(torque), rate), ratio, frequency, temperature, ends, reach)

    @property
    def area(self) -> float:
        """Work that a cycle takes, whatever loses it [J]. Each way ends short of a reversal: a line takes the spring out."""
        torque = self.torque - np.polynomial.Polynomial.fit(self.twist, self.torque, 1)(self.twist)
        ways = (np.flatnonzero(self.sense == sense) for sense in (1.0, -1.0))
        up, down = (way[np.argsort(self.twist[way])] for way in ways)
        return float(np.trapezoid(torque[up], self.twist[up]) - np.trapezoid(torque[down], self.twist[down]))

    @property
    def is_timed(self) -> bool:
        """True if the rate of the twist is known."""
        return bool(np.isfinite(self.rate).all())

    @property
    def is_warm(self) -> bool:
        """True if the temperature is known."""
        return bool(np.isfinite(self.temperature))

    @property
    def speed(self) -> float:
        """Median rate of the twist [rad/s]; 0 without a clock."""
        return float(np.median(self.rate)) if self.is_timed else 0.0

    @property
    def words(self) -> str:
        """Side, largest torque, and what else is known of it."""
        side = "input with the output locked" if self.ratio else "output with the input locked"
        at_rate = f", {quantity(self.speed, 'rad/s')} of twist" if self.is_timed else ""
        warm = f", {self.temperature - 273.15:.0f} °C" if self.is_warm else ""
        return f"±{quantity(self.reach, 'N.m')} at the {side}{at_rate}{warm}"


def _check_ways(sense: Array) -> None:
    if min(np.count_nonzero(sense == 1.0), np.count_nonzero(sense == -1.0)) < MIN_SAMPLES_PER_WAY:
        raise ValueError(
            f"the width of a loop needs ways up and down of at least {MIN_SAMPLES_PER_WAY} samples each, between its reversals"
        )


def _frequency(time: Array, twist: Array, rate: Array) -> float:
    """Return the angular frequency of the sine with the mean squares of a twist and its rate [rad/s].

    A Maxwell branch that relaxes much slower or faster than that loses per cycle what it loses under the sine, whatever the
    waveform is.
    """
    return float(np.sqrt(np.trapezoid(rate**2, time) / np.trapezoid(twist**2, time)))
