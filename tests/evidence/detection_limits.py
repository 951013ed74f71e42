"""Planned detection limits, false alarms, bounds of amplitudes by Monte Carlo: `python -m tests.evidence.detection_limits`.

Limits: five drives of the catalogue are simulated at .8, 1 and 1.2 times the planned limit. White noise is added to the current
many times, and detections are counted. The measured limit is the amplitude with 90 % of detections, between these.

False alarms: healthy units of a drive, whose friction, inertia and speed differ, are simulated without error. White and
coloured noise is added, four orders are tested together, and alarms are counted. The 95 % interval is that of a binomial count.

Bound: standard deviation of the amplitude found over sigma_i sqrt(2 / M).

Tables: each limit that docs/how-to/diagnose.md prints, computed again.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from math import sqrt
from pathlib import Path

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from scipy import fft
from strainwave.diagnose.detection import threshold_of
from strainwave.diagnose.regression import SampledMotion, motion_of, regressions
from strainwave.diagnose.smallest_error import CURRENT_COLUMN, DetectionLimit, RecordedOrder, SteadyRun, detection_limit

Array = NDArray[np.float64]

PROBABILITY, FALSE_ALARM = 0.9, 1e-3
FACTORS = (0.8, 1.0, 1.2)  # of the planned limit
ORDERS = (1.0, 2.0, 4.0, 6.28)
COLOURS = ("white", "first order", "pink", "brown below 2 Hz")
BLOCK = 500  # draws at once
PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "diagnose.md"
PAGE_RECORD = {"speed": 10.0, "duration": 20.0, "sample_rate": 500.0, "noise": 0.05, "order": 2.0}  # of its first example
PAGE_LOAD = 20.0  # N.m, if a table does not have another one
PAGE_HEADS = {"load [N·m]": "load_torque", "speed of the input [rad/s]": "speed", "duration [s]": "duration"}


@dataclass(frozen=True)
class Case:
    """A drive with a motion, and the noise of its current."""

    name: str
    drive: sw.Drive
    speed: float  # of the input [rad/s]
    load_torque: float  # N.m
    noise: float  # A
    duration: float = 20.0  # s
    sample_rate: float = 500.0  # Hz
    order: float = 2.0

    @property
    def limit(self) -> DetectionLimit:
        """The planned limit."""
        return detection_limit(
            self.drive, speed=self.speed, load_torque=self.load_torque, duration=self.duration, sample_rate=self.sample_rate,
            noise=self.noise, order=self.order, probability=PROBABILITY, false_alarm=FALSE_ALARM,
        )  # fmt: skip

    def record(self, amplitude: float, phase: float = 0.7) -> sw.Recording:
        """A record with an error of this amplitude [rad], without noise of sensors."""
        run = SteadyRun.of(self.drive, self.speed, self.load_torque, self.duration, self.sample_rate, self.order)
        return run.with_error(amplitude, phase)


def signature_drive(friction: float = 0.03, inertia: float = 1.5e-4, error: bool = False) -> sw.Drive:
    """The drive of the current signature, with a speed loop."""
    law = sw.kinematic_error.Fourier(order=[1.0, 2.0, 4.0], amplitude=[8e-5, 3e-4, 5e-5], phase=[0.0, 0.3, -1.1])
    gear = sw.Gear(
        kinematics=sw.kinematics.StrainWave(),
        kinematic_error=law if error else sw.kinematic_error.Fourier(order=[], amplitude=[], phase=[]),
        stiffness=sw.stiffness.Linear(k=8000.0),
        damping=2.0,
        friction_input=sw.friction.Coulomb(coulomb=friction, viscous=1e-4),
    )
    return sw.Drive(
        gear=gear,
        motor=sw.motor.CurrentSource(torque_constant=0.05, inertia=inertia),
        control=sw.control.PI(proportional=4.0, integral=100.0, limit=50.0),
        load=sw.loads.Inertia(inertia=0.05),
    )


def cases() -> Iterator[Case]:
    """Five drives of the catalogue, each at a speed and load that it reaches."""
    two = sw.load("two-inertia-gear").replace(
        motor=sw.motor.CurrentSource(torque_constant=0.05, inertia=0.0),
        control=sw.control.PI(proportional=4.0, integral=100.0, limit=50.0),
    )
    yield Case("tilt-actuator-lumped", sw.load("tilt-actuator-lumped"), 20.0, 10.0, 0.1)
    yield Case("robot-joint", sw.load("robot-joint"), 50.0, 40.0, 0.5)
    yield Case("space-pointing-joint", sw.load("space-pointing-joint"), 5.0, 5.0, 0.02)
    yield Case("position-drive", sw.load("position-drive"), 20.0, 2.0, 0.02)
    yield Case("two-inertia-gear, PI", two, 10.0, 20.0, 0.1)


def detections(record: sw.Recording, order: float, noise: float, draws: int, seed: int) -> int:
    """How often the order is detected in a record to which noise is added."""
    recorded = RecordedOrder.of(record, order)
    threshold = threshold_of(FALSE_ALARM, 2, recorded.regression.freedom)
    random, found = np.random.default_rng(seed), 0
    for _ in range(0, draws, BLOCK):
        rows = noise / sqrt(recorded.every) * random.standard_normal((len(recorded.series), min(BLOCK, draws)))
        found += int(np.sum(recorded.regression.evidence(recorded.series[:, None] + rows) > threshold))
    return found


def measured_limit(case: Case, planned: DetectionLimit, draws: int) -> tuple[float, list[float]]:
    """The amplitude [rad] with 90 % of detections, and the share of detections at each factor of the planned one."""
    from scipy.stats import norm

    shares = [
        detections(case.record(factor * planned.amplitude), case.order, case.noise, draws, seed) / draws
        for seed, factor in enumerate(FACTORS)
    ]
    scores = norm.ppf(np.clip(shares, 0.5 / draws, 1.0 - 0.5 / draws))
    return float(np.interp(norm.ppf(PROBABILITY), scores, FACTORS)) * planned.amplitude, shares


def noises(colour: str, count: int, draws: int, step: float, random: np.random.Generator) -> Array:
    """Noise of variance about 1, shape (count, draws)."""
    white = random.standard_normal((2 * count, draws))
    if colour == "white":
        return white[:count]
    frequency = np.fft.rfftfreq(2 * count, step)
    positive = np.maximum(frequency, frequency[1])
    shape = {
        "first order": 1.0 / np.sqrt(1.0 + (frequency / 5.0) ** 2),
        "pink": 1.0 / np.sqrt(positive),
        "brown below 2 Hz": np.sqrt(1.0 + (2.0 / positive) ** 2),
    }[colour]
    shape[0] = 0.0
    coloured = fft.irfft(fft.rfft(white, axis=0) * shape[:, None], axis=0)[:count]  # many columns at once, unlike numpy.fft
    return np.asarray(coloured / np.std(coloured))


@cache
def healthy_motions(units: int, seed: int = 3) -> tuple[SampledMotion, ...]:
    """Motions of healthy units whose friction, inertia, load and speed differ, simulated once for all colours of noise."""
    random, motions = np.random.default_rng(seed), []
    for _ in range(units):
        friction, inertia, faster, load = 1.0 + 0.2 * random.uniform(-1.0, 1.0, 4)
        drive = signature_drive(0.03 * friction, 1.5e-4 * inertia)
        run = SteadyRun(drive, 10.0 * faster, 20.0 * load, 24.0, 250.0, 1.0)
        motions.append(motion_of(run.with_error(0.0), CURRENT_COLUMN, max(ORDERS)))
    return tuple(motions)


def false_alarms(colour: str, rate: float, units: int, draws: int, noise: float = 0.05) -> tuple[int, int]:
    """Alarms in any of the orders, and the number of runs, over healthy units with draws of noise each."""
    random = np.random.default_rng(5)
    alarms = 0
    for motion in healthy_motions(units):
        fitted = regressions(motion, ORDERS)
        rows = motion.series[:, None] + noise * noises(colour, len(motion.series), draws, motion.step, random)
        alarm = np.zeros(draws, dtype=bool)
        for each in fitted:
            alarm |= each.evidence(rows) > threshold_of(rate, 2, each.freedom, len(ORDERS))
        alarms += int(alarm.sum())
    return alarms, units * draws


def interval(rate: float, runs: int) -> tuple[int, int]:
    """95 % interval of the number of alarms."""
    from scipy.stats import binom

    low, high = binom.interval(0.95, runs, rate)
    return int(low), int(high)


def bound_ratio(case: Case, draws: int, level: float = 5.0) -> tuple[float, float]:
    """Standard deviation of the amplitude over the bound, and the mean standard deviation that is reported over it."""
    recorded = RecordedOrder.of(case.record(level * case.limit.amplitude), case.order)
    random = np.random.default_rng(11)
    rows = case.noise / sqrt(recorded.every) * random.standard_normal((len(recorded.series), draws))
    waves = recorded.regression.mean_estimator @ (recorded.series[:, None] + rows)
    bound = case.noise * sqrt(2.0 / recorded.samples)
    factor = sqrt(0.5 * float(np.trace(recorded.regression.mean_factor)))
    reported = factor * np.sqrt(recorded.regression.variance(recorded.series[:, None] + rows))
    return float(np.std(np.hypot(*waves))) / bound, float(np.mean(reported)) / bound


@dataclass(frozen=True)
class PrintedLimit:
    """A limit in a table of the page.

    Attributes:
        varied: argument of the detection limit that the table varies
        value: of this argument
        load_torque: N.m
        arcminutes: as printed
        half_place: half of the last place that is printed [arcmin]
        insensitive: True if the page adds that
    """

    varied: str
    value: float
    load_torque: float
    arcminutes: float
    half_place: float
    insensitive: bool

    def computed(self) -> DetectionLimit:
        """Return the limit of the drive of the page's first example."""
        example = re.search(r"### Plan a recording\n.*?```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
        assert example is not None, f"{PAGE.name} has no example"
        names = dict[str, object]()
        exec(example[1].partition("record =")[0], names)
        drive = names["drive"]
        assert isinstance(drive, sw.Drive), f"{PAGE.name} makes no drive"
        return detection_limit(drive, **{**PAGE_RECORD, "load_torque": self.load_torque, self.varied: self.value})

    def is_met_by(self, found: DetectionLimit) -> bool:
        """True if the limit rounds to the printed one."""
        is_close = abs(found.arcminutes - self.arcminutes) <= self.half_place
        return is_close and found.insensitive == self.insensitive


def printed_limits() -> Iterator[PrintedLimit]:
    """Yield the limits in the tables of the page."""
    varied, values = "", list[float]()
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        head, *cells = [cell.strip() for cell in line.strip("|").split("|")]
        if head in PAGE_HEADS:
            varied, values = PAGE_HEADS[head], [float(cell) for cell in cells]
        elif varied and head.startswith("limit"):
            for value, cell in zip(values, cells, strict=True):
                number, _, word = cell.partition(" ")
                half = 0.5 * 10.0 ** -len(number.partition(".")[2])
                load = value if varied == "load_torque" else 0.0 if head == "limit without load" else PAGE_LOAD
                yield PrintedLimit(varied, value, load, float(number), half, word == "(insensitive)")
        elif not line.startswith("|"):
            varied = ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=2000, help="of noise for each amplitude (2000)")
    parser.add_argument("--healthy", type=int, default=10000, help="healthy runs for each colour and rate (10000)")
    wanted = parser.parse_args()
    failures = 0
    print(f"limit: detected with {PROBABILITY} at {FALSE_ALARM} false alarms, order 2, 20 s at 500 Hz")
    print(
        f"{'drive':24} {'rad/s':>6} {'N.m':>5} {'noise A':>8} {'planned':>9} {'measured':>9} {'ratio':>6}  share at .8, 1, 1.2"
    )
    for case in cases():
        planned = case.limit
        measured, shares = measured_limit(case, planned, wanted.draws)
        ratio = measured / planned.amplitude
        failures += not 0.8 <= ratio <= 1.2
        print(
            f"{case.name:24} {case.speed:6g} {case.load_torque:5g} {case.noise:8g} {planned.arcminutes:8.4f}' "
            f"{measured / planned.amplitude * planned.arcminutes:8.4f}' {ratio:6.3f}  "
            f"{', '.join(f'{each:.3f}' for each in shares)}",
            flush=True,
        )
    print("\nstandard deviation of an amplitude over sigma_i sqrt(2 / M): by Monte Carlo, and as reported")
    for case in cases():
        spread, reported = bound_ratio(case, wanted.draws)
        failures += not (0.8 <= spread <= 1.2 and 0.8 <= reported <= 1.2)
        print(f"{case.name:24} {spread:6.3f} {reported:6.3f}", flush=True)
    print(f"\ntables of {PAGE.name}: printed and computed limits in arc minutes")
    for printed in printed_limits():
        found = printed.computed()
        failures += not printed.is_met_by(found)
        print(
            f"{printed.varied:12} {printed.value:5g}, {printed.load_torque:4g} N.m: {printed.arcminutes:8g} "
            f"{found.arcminutes:10.5f}{' insensitive' if found.insensitive else ''}",
            flush=True,
        )
    print(f"\nfalse alarms in any of {len(ORDERS)} orders, {wanted.healthy} healthy runs of 50 simulated units")
    for colour in COLOURS:
        for rate in (1e-3, 1e-2, 5e-2):
            alarms, runs = false_alarms(colour, rate, 50, wanted.healthy // 50)
            low, high = interval(rate, runs)
            failures += not low <= alarms <= high
            print(f"{colour:18} stated {rate * runs:5.0f}, 95 % from {low} to {high}: {alarms}", flush=True)
    return int(failures > 0)


if __name__ == "__main__":
    sys.exit(main())
