"""Many random drives, of all models at all places, with numbers over the catalogue's range and beyond.

    python -m tests.stress                         a thousand
    python -m tests.stress --drives 100000 --first 5000 --processes 1

Each is run a hundred steps by one of the methods; every fifth to a tolerance too, and every fifth with seven others
beside it that differ in a few numbers, which must not change a bit of its own run. None may hang or give what is not a number
without a word; what cannot be integrated says why. Drive n is the same on every machine.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import re
import time
import warnings
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import strainwave as sw
from strainwave import _core
from strainwave.simulation import METHODS

from tests.strategies import AROUND_ONE, TYPICAL, Field

OUTPUTS = [name for name, _, _ in _core.outputs]
STEPS = 100
MOST_STEPS = 200  # of a run to a tolerance
MEMBERS = 8
SILENT = "NOT A NUMBER, WITHOUT A WORD"
DIFFERENT = "NOT WHAT IT IS ALONE"


def magnitude(unit: str, low: float | None, high: float | None, zero: bool, random: np.random.Generator) -> float:
    """Every decade of the typical range equally likely, one more at either end; 0 now and then where it may be."""
    smallest, largest = TYPICAL.get(unit, AROUND_ONE)
    size = float(math.exp(random.uniform(math.log(smallest / 10.0), math.log(10.0 * largest))))
    signed = size if low is not None else size * random.choice([-1.0, 1.0])
    drawn = 0.0 if random.random() < 0.1 and zero else signed
    return float(min(max(drawn, -math.inf if low is None else low), math.inf if high is None else high))


def number(field: Field, random: np.random.Generator) -> float:
    zero = field["min"] is None or (field["min"] == 0.0 and not field["open"])
    return magnitude(field["unit"], field["min"], field["max"], zero, random)


def value(field: Field, length: int, random: np.random.Generator) -> Any:
    match field["kind"]:
        case "part":
            options = [sw.Gear] if field["name"] == "gear" else list(field["options"].values())
            return model(options[random.integers(len(options))], random)
        case "choice":
            return field["options"][random.integers(len(field["options"]))]
        case "count":
            return int(random.integers(int(field["min"]), min(int(field["max"]), 1000) + 1))
        case "sequence":
            return [number(field, random) for _ in range(length)]
        case _:
            return number(field, random)


def model(kind: Any, random: np.random.Generator) -> Any:
    """Any of its kind, drawn again where a relation between its fields does not hold."""
    while True:
        length = int(random.integers(0, 9))
        members = {field["name"]: value(field, length, random) for field in kind.fields}
        try:
            return kind(**members)
        except ValueError:
            continue


def neighbours(drive: sw.drives.PositionDrive, random: np.random.Generator) -> dict[str, list[float]]:
    """Values of three of its numbers for as many members as a pack holds, the first its own."""
    known = _core.parameters(drive)
    drawn: dict[str, list[float]] = {}
    for place in random.choice(len(known), min(3, len(known)), replace=False):
        path, own, unit, _, low, high = known[place]
        limits = (None if low == -math.inf else low, None if high == math.inf else high)
        drawn[path] = [own, *(magnitude(unit, *limits, low <= 0.0, random) for _ in range(MEMBERS - 1))]
    return drawn


def step(drive: sw.drives.PositionDrive, random: np.random.Generator) -> float:
    """As users take it [s], or so that it follows the gear's vibration, mostly."""
    if random.random() < 0.5:
        return float(10.0 ** random.uniform(-5.0, -3.5))
    return float(10.0 ** random.uniform(-2.0, 0.2)) / _core.vibration(drive, 0.0)


@dataclass(frozen=True)
class Outcome:
    """How the runs of a drive went: its number, what was said of each kind of run, and how long they took [s]."""

    number: int
    said: Mapping[str, str]
    took: float

    @property
    def wrong(self) -> bool:
        return any(SILENT in words or DIFFERENT in words for words in self.said.values())


def outcome(number: int) -> Outcome:
    warnings.simplefilter("ignore")
    random = np.random.default_rng(number)
    drive = model(sw.drives.PositionDrive, random)
    dt = step(drive, random)
    duration = STEPS * dt
    volts = sw.scenario.sine(random.uniform(0.0, 48.0), random.uniform(0.5, 5.0) / duration, duration)
    course: dict[str, Any] = {
        "load_torque": random.normal(0.0, 10.0),
        "temperature": random.uniform(230.0, 370.0),
        "sample": 20.0 * dt,
    }
    method: Any = METHODS[random.integers(len(METHODS))]
    began = time.perf_counter()
    said = {method: words(lambda: sw.simulate(drive, volts, dt, method=method, **course))}
    if number % 5 == 0:
        rtol = float(10.0 ** random.uniform(-8.0, -3.0))
        said["adaptive"] = words(lambda: sw.simulate_adaptively(drive, volts, rtol, most_steps=MOST_STEPS, **course))
    if number % 5 == 1:
        said["many"] = words(lambda: beside_others(drive, neighbours(drive, random), volts, dt, course))
    return Outcome(number, said, time.perf_counter() - began)


def words(simulate: Callable[[], sw.Recording]) -> str:
    """What came of a run, numbers left out."""
    try:
        recording = simulate()
    except (ValueError, FloatingPointError, AssertionError) as error:
        return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", re.sub(r"\(.*?\)", "", str(error)))
    return "finite" if all(np.isfinite(recording[name]).all() for name in OUTPUTS) else SILENT


def beside_others(
    drive: sw.drives.PositionDrive, others: Mapping[str, list[float]], volts: Any, dt: float, course: dict[str, Any]
) -> sw.Recording:
    """The first of an ensemble, which is the drive itself; raises AssertionError if it is not what it is alone."""
    runs = sw.simulate_many(drive, volts, others, dt, record=OUTPUTS, threads=1, **course)
    for member in runs.failures.keys() ^ set(range(MEMBERS)):
        assert all(np.isfinite(runs[name][member]).all() for name in OUTPUTS), SILENT
    try:
        alone = sw.simulate(drive, volts, dt, method="exponential", **course)
    except (ValueError, FloatingPointError):
        assert 0 in runs.failures, DIFFERENT
        return runs.member(0)
    assert 0 not in runs.failures, DIFFERENT
    assert all(np.array_equal(runs[name][0], alone[name]) for name in OUTPUTS), DIFFERENT
    return alone


def tell(counted: Counter[tuple[str, str]], slowest: list[Outcome], wrong: list[Outcome]) -> None:
    for (kind, said), count in sorted(counted.items(), key=lambda item: (item[0][0], -item[1])):
        print(f"{count:7d}  {kind:12} {said[:160]}")
    for one in slowest:
        print(f"drive {one.number} took {one.took:.2f} s: {one.said}")
    for one in wrong:
        print(f"WRONG: drive {one.number}: {one.said}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drives", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=None)
    options = parser.parse_args()
    counted: Counter[tuple[str, str]] = Counter()
    slowest: list[Outcome] = []
    wrong: list[Outcome] = []
    began = time.perf_counter()
    try:
        with multiprocessing.get_context("spawn").Pool(options.processes) as pool:
            numbers = range(options.first, options.first + options.drives)
            for done, one in enumerate(pool.imap_unordered(outcome, numbers, chunksize=16), start=1):
                counted.update(one.said.items())
                slowest = sorted([*slowest, one], key=lambda other: -other.took)[:5]
                wrong += [one] if one.wrong else []
                if done % max(options.drives // 100, 1) == 0:
                    print(f"{done} drives, {len(wrong)} wrong, {time.perf_counter() - began:.0f} s", flush=True)
    finally:
        tell(counted, slowest, wrong)
    raise SystemExit(bool(wrong))


if __name__ == "__main__":
    main()
