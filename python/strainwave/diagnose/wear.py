"""Wear of a gear by repeated tests: its rate over the work that the gear has transmitted, and the remaining life.

The volume that a sliding contact loses is in proportion to its load times the sliding distance (Archard1953). The teeth of a
gear slide in proportion to the angle of the output, and their load is in proportion to its torque. So the worn depth, and all
that follows from it, is in proportion to the transmitted work W = ∫ |torque| |d angle|. The constant of proportion contains
hardness, lubricant and geometry; tests of the gear determine it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import inf, isfinite, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import _core, arguments
from strainwave.diagnose.detection import CONFIDENCE_LEVEL
from strainwave.diagnose.health import line_crossing
from strainwave.files.recording import Recording, check_recording
from strainwave.messages import listed, quoted
from strainwave.presentation import Presented, Row
from strainwave.simulation.usage import work_in
from strainwave.typeset import quantity, uncertain_quantity

Array = NDArray[np.float64]

QUANTITY_UNITS = {"play": "rad", "amplitude": "rad", "friction": "N.m", "stiffness": "N.m/rad"}  # of ToothWear
MIN_TESTS = 3  # of which a line leaves one degree of freedom for its noise
MAX_TESTS = 10_000  # of one gear; a longer table is a log, whose rows are not independent
MAX_EXTRAPOLATION = 5.0  # of the life over the work between the tests, from which it is stated (assumed)
MAX_SOFTENING = 0.95  # of `fault.ToothWear`


def transmitted_work(recording: Recording, *, torque: str = "torque", angle: str = "output_angle") -> float:
    """Return the work that a gear transmitted, ∫ |torque| |d angle| at the output [J], by the trapezoidal rule.

    Args:
        recording: a run, or a measurement, with torque and angle of the output
        torque, angle: names of its columns; the angle must not wrap

    Raises:
        TypeError: something is no recording
        ValueError: a column is missing, or has another unit

    >>> import strainwave as sw
    >>> columns = {"torque": [10.0, 10.0, -10.0], "output_angle": [0.0, 0.5, 0.0]}
    >>> transmitted_work(sw.Recording(columns, {"torque": "N.m", "output_angle": "rad"}))
    10.0
    """
    check_recording("recording", recording)
    return float(work_in(recording.values(torque, "N.m"), recording.values(angle, "rad")))


@dataclass(frozen=True)
class WearTrend(Presented):
    """Straight line through a quantity of a gear over the work that the gear has transmitted.

    Attributes:
        name: play, amplitude, friction or stiffness
        start: value of the line without any work [unit of the quantity]
        rate, rate_sigma: change per work [that unit per J], and its standard deviation
        limit: value at which the gear is worn out [that unit]
        determined: True if the interval of the rate contains rates towards the limit alone
        remaining: work from the last test until the line passes the limit [J]; infinite if it is not determined
        low, high: ends of its interval (Fieller1954) [J]; the high one is infinite if it is not determined
    """

    name: str
    start: float
    rate: float
    rate_sigma: float
    limit: float
    determined: bool
    remaining: float
    low: float
    high: float


@dataclass(frozen=True)
class WearLife(Presented):
    """Remaining life of a gear: the work until the first of its quantities passes its limit.

    Attributes:
        trends: of each quantity
        limited_by: name of the quantity that is the first at its limit; empty if none is determined
        remaining: work from the last test until then [J]; infinite if it is not determined
        low, high: ends of the interval that contains the true one with probability 0.95 or more [J]
        remarks: what is not determined, in words

    >>> life = wear_life([0.0, 1e6, 2e6, 3e6], {"play": [1.0e-4, 1.31e-4, 1.58e-4, 1.92e-4]}, {"play": 4e-4})
    >>> round(life.onset.share(life.onset.scale / 2.0), 2), life.limited_by
    (0.5, 'play')
    """

    trends: tuple[WearTrend, ...]
    limited_by: str
    remaining: float
    low: float
    high: float
    remarks: tuple[str, ...] = ()

    def _headline(self) -> str:
        if not self.limited_by:
            return f"not determined: more than {self.low:.3g} J"
        return f"{self.remaining:.3g} J, from {self.low:.3g} to {self.high:.3g} J, by its {self.limited_by}"

    def _rows(self) -> Iterator[Row]:
        for trend in self.trends:
            unit = QUANTITY_UNITS[trend.name]
            yield Row(f"{trend.name} at no work", trend.start, unit, note=f"limit {trend.limit:.4g} {unit}")
            note = "" if trend.determined else "not determined"
            yield Row(f"rate of the {trend.name}", trend.rate, f"{unit}/J", trend.rate_sigma, note)
            yield Row(f"life by the {trend.name}", (trend.low, trend.high), "J")
        yield Row("remaining life", (self.low, self.high), "J", note=self.limited_by or "not determined")

    @property
    def onset(self) -> _core.onset.Growing:
        """Growth of `fault` over the transmitted work, as `sw.dataset` takes it; severity 1 is the end of the life.

        Raises:
            ValueError: the life is not determined
        """
        return _core.onset.Growing(scale=self._whole_life(), unit="transmitted_work")

    @property
    def fault(self) -> _core.fault.ToothWear:
        """Wear at the end of the life: the changes of the quantities whose rate is determined.

        Raises:
            ValueError: the life is not determined
        """
        work = self._whole_life()
        changed = {trend.name: trend.rate * work for trend in self.trends if trend.determined}
        start = {trend.name: trend.start for trend in self.trends}
        return _core.fault.ToothWear(
            play=changed.get("play", 0.0),
            amplitude=changed.get("amplitude", 0.0),
            friction_rise=changed["friction"] / start["friction"] if "friction" in changed else 0.0,
            softening=min(-changed["stiffness"] / start["stiffness"], MAX_SOFTENING) if "stiffness" in changed else 0.0,
        )

    def _whole_life(self) -> float:
        """Return the work from the new gear to the end of its life [J]."""
        lives = [(trend.limit - trend.start) / trend.rate for trend in self.trends if trend.determined]
        if not lives:
            raise ValueError(f"the life is not determined: {'; '.join(self.remarks)}")
        return min(lives)


def resolution_of(values: Sequence[float]) -> float:
    """Return the largest power of ten of which all values are whole multiples: no digit beyond it was written.

    >>> resolution_of([0.337, 0.45, 0.5]), resolution_of([20100.0, 19800.0])
    (0.001, 100.0)
    """
    exponents = [int(Decimal(repr(float(value))).normalize().as_tuple().exponent) for value in values if value != 0.0]
    return float(Decimal(10) ** min(exponents, default=0))


def wear_life(
    work: ArrayLike,
    tests: Mapping[str, Sequence[float]],
    limits: Mapping[str, float],
    *,
    resolution: Mapping[str, float] | None = None,
    sigma: Mapping[str, float] | None = None,
) -> WearLife:
    """Return wear rates and remaining life of one gear by repeated tests.

    Each quantity is a straight line over the work (Archard1953), with normal noise that is independent from test to test: what
    a test repeats. Intervals are those of Student and of Fieller's theorem (Fieller1954). With m quantities each has the
    confidence 1 - 0.05 / m, so that the interval of the first to reach its limit has 0.95 or more. Leaves out running-in, whose
    tests are to be left out, and wear that accelerates. The work is taken as exact; divide a life by the work per hour
    of the duty, as `transmitted_work` finds it, for hours. The noise is at least that of rounding, resolution / sqrt(12):
    tests with few digits may lie on a line by chance.

    Args:
        work: that the gear had transmitted before each test [J], shape (n,), n at least 3
        tests: values of each test, shape (n,), by the name of the quantity: play [rad], amplitude of the kinematic error [rad],
            friction [N.m], stiffness [N.m/rad]
        limits: value of each at which the gear is worn out
        resolution: smallest difference of the values of each; if not given, that of their last decimal
        sigma: standard deviation that the tests state of each; the noise is at least that

    Raises:
        ValueError: a name is none of these, numbers of tests differ or are too few, all are of the same work, a resolution or
            a standard deviation is negative, or the first test is past a limit

    >>> life = wear_life([0.0, 1e6, 2e6, 3e6], {"play": [1.0e-4, 1.31e-4, 1.58e-4, 1.92e-4]}, {"play": 4e-4})
    >>> round(life.remaining / 1e6, 1), life.low < life.remaining < life.high, round(life.fault.play, 7)
    (6.9, True, 0.0003002)
    >>> wear_life([0.0, 1e6, 2e6], {"play": [1.0e-4, 1.2e-4, 1.1e-4]}, {"play": 4e-4}).limited_by  # not determined
    ''
    """
    done = arguments.numbers("work", work)
    _check(done, tests, limits)
    confidence = 1.0 - (1.0 - CONFIDENCE_LEVEL) / len(tests)
    steps = {name: resolution_of(values) for name, values in tests.items()} | _of_tests("resolution", resolution, tests)
    sigmas = dict.fromkeys(tests, 0.0) | _of_tests("sigma", sigma, tests)
    trends = tuple(
        _trend(name, done, arguments.numbers(name, values), limits[name], confidence, steps[name], sigmas[name])
        for name, values in tests.items()
    )
    first = min(trends, key=lambda trend: trend.remaining)
    return WearLife(
        trends,
        first.name if isfinite(first.remaining) else "",
        first.remaining,
        min(trend.low for trend in trends),
        min(trend.high for trend in trends),
        tuple(_remarks(trends, first.remaining, float(np.ptp(done)))),
    )


def _remarks(trends: Sequence[WearTrend], remaining: float, tested: float) -> Iterator[str]:
    """Yield what the tests do not determine."""
    for trend in trends:
        if not trend.determined:
            rate = uncertain_quantity(1e6 * trend.rate, 1e6 * trend.rate_sigma, f"{QUANTITY_UNITS[trend.name]}/MJ")
            not_determined = f"the rate of the {trend.name}, {rate}, does not differ from zero in the direction of its limit"
            yield f"{not_determined}: more tests, or tests after more work, determine it"
    if isfinite(remaining) and remaining > MAX_EXTRAPOLATION * tested:
        longer = f"{remaining / tested:.2g} times the work between the first and the last test, {quantity(tested, 'J')}"
        yield f"the life is {longer}: that wear stays in proportion to the work so long is assumed, not tested; check the limit"


def _check(work: Array, tests: Mapping[str, Sequence[float]], limits: Mapping[str, float]) -> None:
    if not tests or (unknown := [name for name in tests if name not in QUANTITY_UNITS]):
        wrong = listed(map(quoted, unknown)) if tests else "none"
        raise ValueError(f"tests has the quantities {wrong}; give one or more of {listed(QUANTITY_UNITS)}")
    for name, values in tests.items():
        if name not in limits:
            raise ValueError(f"limits lacks {quoted(name)}; give the value at which the gear is worn out")
        if len(values) != len(work):
            raise ValueError(f"{name} has {len(values)} values for {len(work)} tests; give one for each")
    if len(work) < MIN_TESTS:
        raise ValueError(f"a rate of wear and its uncertainty need {MIN_TESTS} tests, not {len(work)}: test again")
    if len(work) > MAX_TESTS:
        raise ValueError(f"there are {len(work)} tests, at most {MAX_TESTS} are taken; give one row for each test, not a log")
    if float(np.ptp(work)) == 0.0:
        raise ValueError(f"all tests are after the same work, {work[0]:g} J; a rate needs tests after different work")


def _of_tests(argument: str, given: Mapping[str, float] | None, tests: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Return numbers that are given of some tests, by their names."""
    if unknown := [name for name in given or {} if name not in tests]:
        raise ValueError(f"{argument} has {listed(map(quoted, unknown))}; the tests have {listed(map(quoted, tests))}")
    return {
        name: arguments.number(f"{argument}[{quoted(name)}]", value, QUANTITY_UNITS[name], "[)", 0.0)
        for name, value in (given or {}).items()
    }


def _trend(
    name: str, work: Array, values: Array, limit: float, confidence: float, resolution: float, known_sigma: float
) -> WearTrend:
    """Return the trend of one quantity; one that falls towards its limit is turned over."""
    unit = QUANTITY_UNITS[name]
    limit = arguments.number(f"limits[{quoted(name)}]", limit, unit)
    sense = -1.0 if name == "stiffness" else 1.0
    first = float(values[np.argmin(work)])
    if sense * first >= sense * limit:
        raise ValueError(
            f"the first test is past the limit of the {name}: {quantity(first, unit)}, limit {quantity(limit, unit)}, and wear "
            f"{'lowers' if sense < 0.0 else 'raises'} it; correct the limit"
        )
    line = line_crossing(work, sense * values, sense * limit, confidence, resolution / sqrt(12.0), known_sigma)
    determined = isfinite(line.high)
    return WearTrend(
        name,
        sense * line.start,
        sense * line.slope,
        line.slope_sigma,
        limit,
        determined,
        line.distance if determined else inf,
        line.low if isfinite(line.low) else 0.0,
        line.high,
    )
