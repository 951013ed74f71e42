"""Many random drives, of all models at all places, with numbers over the catalogue's range and beyond.

    python -m tests.stress                         a thousand
    python -m tests.stress --drives 100000 --first 5000

Each is run at a fixed step, and every tenth to a tolerance too. None may hang or give what is not a number without a word; what
cannot be integrated says why. Drive n is the same on every machine.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import re
import time
import warnings
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
import strainwave as sw
from strainwave import _core

from tests.strategies import AROUND_ONE, TYPICAL, Field

DURATION = 0.01  # s


def magnitude(field: Field, random: np.random.Generator) -> float:
    """Every decade of the typical range equally likely, one more at either end; 0 now and then where it may be."""
    low, high = TYPICAL.get(field["unit"], AROUND_ONE)
    size = float(math.exp(random.uniform(math.log(low / 10.0), math.log(10.0 * high))))
    signed = size if field["min"] is not None else size * random.choice([-1.0, 1.0])
    zero = 0.0 if random.random() < 0.1 and not (field["min"] is not None and (field["open"] or field["min"] > 0.0)) else signed
    lowest = -math.inf if field["min"] is None else field["min"]
    return float(min(max(zero, lowest), math.inf if field["max"] is None else field["max"]))


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
            return [magnitude(field, random) for _ in range(length)]
        case _:
            return magnitude(field, random)


def model(kind: Any, random: np.random.Generator) -> Any:
    """Any of its kind, drawn again where a relation between its fields does not hold."""
    while True:
        length = int(random.integers(0, 9))
        members = {field["name"]: value(field, length, random) for field in kind.fields}
        try:
            return kind(**members)
        except ValueError:
            continue


@dataclass(frozen=True)
class Outcome:
    """How the run of a drive went: its number, what was said, and how long it took [s]."""

    number: int
    said: str
    took: float


def outcome(number: int) -> Outcome:
    warnings.simplefilter("ignore")
    random = np.random.default_rng(number)
    drive = model(sw.drives.PositionDrive, random)
    volts = sw.scenario.sine(random.uniform(0.0, 48.0), random.uniform(1.0, 100.0), DURATION)
    course: dict[str, Any] = {
        "load_torque": random.normal(0.0, 10.0),
        "temperature": random.uniform(230.0, 370.0),
        "sample": 1e-3,
    }
    began = time.perf_counter()
    said = run(lambda: sw.simulate(drive, volts, 10.0 ** random.uniform(-5.0, -3.5), **course))
    if number % 10 == 0:
        said += "; adaptive: " + run(lambda: sw.simulate_adaptively(drive, volts, 1e-4, **course))
    return Outcome(number, said, time.perf_counter() - began)


def run(simulate: Any) -> str:
    """What came of it, numbers left out."""
    try:
        recording = simulate()
    except (ValueError, FloatingPointError) as error:
        return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", re.sub(r"\(.*?\)", "", str(error)))
    finite = all(np.isfinite(recording[name]).all() for name, _, _ in _core.outputs)
    return "finite" if finite else "NOT A NUMBER, WITHOUT A WORD"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drives", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args()
    counted: Counter[str] = Counter()
    slowest: list[Outcome] = []
    with multiprocessing.get_context("spawn").Pool() as pool:
        for one in pool.imap_unordered(outcome, range(options.first, options.first + options.drives), chunksize=16):
            counted[one.said] += 1
            slowest = sorted([*slowest, one], key=lambda other: -other.took)[:5]
    for said, count in counted.most_common(40):
        print(f"{count:7d}  {said[:150]}")
    for one in slowest:
        print(f"drive {one.number} took {one.took:.2f} s: {one.said[:100]}")


if __name__ == "__main__":
    main()
