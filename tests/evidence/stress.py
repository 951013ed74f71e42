"""Many random drives, of all models at all places, with numbers over the catalogue's range and beyond.

    python -m tests.evidence.stress                         a thousand
    python -m tests.evidence.stress --drives 100000 --first 5000 --processes 1

Each is run a hundred steps by one of the methods, or by that which `simulate` chooses; every fifth to a tolerance too, every
fifth with seven others beside it that differ in a few numbers, and every fifth with derivatives, neither of which may change
a bit of its own run. What cannot be integrated says why. None may hang: a process that is at one drive for `LIMIT` is ended.
Of runs that end, `simulate` has refused those whose recording is not finite; here it is looked at whether the state at the
end is, whether it is what was recorded last, and whether columns contradict each other or a law. Drive n is the same on every
machine.
"""

from __future__ import annotations

import argparse
import math
import os
import re
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave import _core
from strainwave.analysis.sensitivity import NO_MEASURE
from strainwave.simulation.ensemble import COUNTED_NAMES
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.run import METHOD_WORDS
from strainwave.simulation.signals import load_input, outputs

from tests.laws.test_gear import has_memory, passive, speeds, steady
from tests.support.strategies import AROUND_ONE, SUITED, TYPICAL, Field, kinds_of, suited
from tests.support.workers import answers

STEPS = 100
MOST_STEPS = 2000  # of a run to a tolerance
MEMBERS = 8
LIMIT = 60.0  # s, for all runs of a drive
ROUNDING = 1e-15
FARTHEST = 1e6  # rad
WRONG = "WRONG: "
SILENT = WRONG + "not a number, without a word"
DIFFERENT = WRONG + "not what it is alone"
# Numbers that differ from member to member only at a cost that is documented: a last digit where some are whole and others are
# not; instants of sampling, which all members share and which nothing is derived by; and what is counted.
SHARED = re.compile(
    rf"\.({'|'.join(sorted(COUNTED_NAMES))})(\[\d+\])?$|\.order\[|\.density\.exponent$|^control\.(period|delay)$"
)


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


def element(field: Field, random: np.random.Generator) -> float:
    """A number, or one of a sequence."""
    if field["whole"]:
        return int(random.integers(int(field["min"]), min(int(field["max"]), 1000) + 1))
    return number(field, random)


def value(field: Field, length: int, random: np.random.Generator) -> Any:
    match field["kind"]:
        case "part":
            options = kinds_of(field)
            return model(options[random.integers(len(options))], random)
        case "choice":
            return field["options"][random.integers(len(field["options"]))]
        case "sequence":
            return [element(field, random) for _ in range(length)]
        case _:
            return element(field, random)


def model(kind: Any, random: np.random.Generator) -> Any:
    """Any of its kind, drawn again where a relation between its fields does not hold."""
    while True:
        length = int(random.integers(0, 9))
        fields = [field for field in kind.fields if not (kind is sw.friction.Cyclic and field.get("optional"))]  # a detent
        members = {field["name"]: value(field, length, random) for field in fields}  # is valid below the dry friction
        if "kinematics" in members:
            members |= {name: suited(members[name], members["kinematics"]) for name in SUITED}
        try:
            if kind is sw.Drive:
                members["control"] = suited(members["control"], members["gear"].kinematics)
            return kind(**members)
        except ValueError:
            continue


def acting_on(drive: sw.Drive, random: np.random.Generator) -> dict[str, float]:
    """Inputs besides the command."""
    load = load_input(drive)
    size = {"load_torque": 10.0, "brake_torque": 10.0, "output_angle": 1e-3}[load]
    return {load: random.normal(0.0, size), "temperature": random.uniform(230.0, 370.0)}


def neighbours(drive: sw.Drive, random: np.random.Generator) -> dict[str, list[float]]:
    """Values of three of its numbers for as many members as a pack holds, the first its own."""
    known = [one for one in _core.parameters(drive) if not SHARED.search(one[0])]
    drawn: dict[str, list[float]] = {}
    for place in random.choice(len(known), min(3, len(known)), replace=False):
        path, own, unit, _, low, high = known[place]
        limits = (None if low == -math.inf else low, None if high == math.inf else high)
        drawn[path] = [own, *(magnitude(unit, *limits, low <= 0.0, random) for _ in range(MEMBERS - 1))]
    return drawn


def step(drive: sw.Drive, random: np.random.Generator) -> float:
    """As users take it [s], or so that it follows the gear's vibration, mostly; with few instants of a sampled controller."""
    if random.random() < 0.5:
        return float(10.0 ** random.uniform(-5.0, -3.5))
    period = _core.schedule(drive, drive.rest().numbers)[1]
    longest = 10.0 * period if period > 0.0 else math.inf
    frequency = _core.natural_frequency(drive, 0.0)  # none within the play of a spring
    return min(float(10.0 ** random.uniform(-2.0, 0.2)) / frequency, longest) if frequency else min(1e-4, longest)


@dataclass(frozen=True)
class Outcome:
    """How the runs of a drive went: its number, what was said of each kind of run, and how long they took [s]."""

    number: int
    said: Mapping[str, str]
    took: float

    @property
    def wrong(self) -> bool:
        return any(words.startswith(WRONG) for words in self.said.values())


def outcome(number: int) -> Outcome:
    warnings.simplefilter("ignore")
    random = np.random.default_rng(number)
    drive = model(sw.Drive, random)
    dt = step(drive, random)
    duration = STEPS * dt
    volts = sw.scenario.sine(random.uniform(0.0, 48.0), random.uniform(0.5, 5.0) / duration, duration)
    acting = {"inputs": acting_on(drive, random)}
    course: dict[str, Any] = {**acting, "sample": 20.0 * dt}
    excitation = Excitation.of(drive, volts, **acting)
    inputs = excitation.over(excitation.time_grid(dt, None).instants)[-1, -1]
    method: Any = (*METHOD_WORDS, None)[random.integers(len(METHOD_WORDS) + 1)]
    began = time.perf_counter()
    said = {method or "chosen": words(lambda: check(drive, sw.simulate(drive, volts, dt, method=method, **course), inputs))}
    if number % 5 == 0:
        rtol = float(10.0 ** random.uniform(-8.0, -3.0))
        options = {"max_steps": MOST_STEPS, **course}
        said["adaptive"] = words(lambda: check(drive, sw.simulate_adaptively(drive, volts, rtol, **options), inputs))
    if number % 5 == 1:
        said["many"] = words(lambda: beside_others(drive, neighbours(drive, random), volts, dt, course))
    if number % 5 == 2:
        paths = [path for path in neighbours(drive, random) if NO_MEASURE.keys().isdisjoint((path, path.rpartition(".")[2]))]
        said["derivatives"] = words(lambda: with_derivatives(drive, paths, volts, dt, course)) if paths else "by none"
    return Outcome(number, said, time.perf_counter() - began)


def words(run: Callable[[], object]) -> str:
    """What came of a run, numbers and paths left out."""
    try:
        run()
    except (ValueError, FloatingPointError, AssertionError) as error:
        named = re.sub(r"^derivatives by .* are", "derivatives by some are", str(error))
        return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", re.sub(r"\(.*?\)", "", named))
    return "finite"


def check(drive: sw.Drive, run: sw.Run, inputs: NDArray[np.float64]) -> None:
    """Raises AssertionError if a run that ended under these inputs says what cannot be."""
    assert np.isfinite(run.end.numbers).all(), SILENT
    check_end(drive, run, inputs)
    check_angles(drive, run)
    check_friction(drive.gear, run)
    if isinstance(drive.meter, sw.meter.EnergyMeter):
        check_powers(drive, run)


def check_end(drive: sw.Drive, run: sw.Run, inputs: NDArray[np.float64]) -> None:
    """What was recorded last is what the state at the end makes of the inputs; what sticks there stands still."""
    for side in ("input", "output"):
        sticks = getattr(run.end, f"{side}_slip_direction") == 0.0
        assert not sticks or getattr(run.end, f"{side}_speed") == 0.0, f"{WRONG}the {side} sticks and moves"
    found = _core.now(drive, run.end.numbers, inputs)[:, 0]
    for name, now in ((name, found[each.channel]) for name, each in outputs(drive).items()):
        assert abs(now - run[name][-1]) <= 1e-9 * np.abs(run[name]).max(), f"{WRONG}{name} at the end is not that of the state"


def check_angles(drive: sw.Drive, run: sw.Recording) -> None:
    """The output lags behind by twist and kinematic error; with stages, by what each of them gives way, too."""
    if not isinstance(drive.gear.structure, sw.structure.Lumped):
        return
    terms = [
        run["input_angle"] / drive.gear.kinematics.ratio,
        *(-run[name] for name in ("output_angle", "twist", "kinematic_error")),
    ]
    gap, size = np.abs(sum(terms)), sum(np.abs(term) for term in terms)
    assert np.all(gap <= ROUNDING * size), f"{WRONG}angles do not add up"


def check_friction(gear: sw.Gear, run: sw.Recording) -> None:
    """Friction without memory never gives power, unless its law says it may."""
    for place, speed in known_speeds(gear, run).items():
        law = getattr(gear, place)
        if not has_memory(law) and passive(law):
            least = -ROUNDING * np.abs(run[place]).max() * np.abs(speed).max()
            assert np.min(run[place] * speed) >= least, f"{WRONG}{place} drives"


def check_powers(drive: sw.Drive, run: sw.Recording) -> None:
    """Powers are those of the torques and speeds beside them, nothing is taken before the start, and damping never gives.

    What sticks takes no power, so a torque that several share while they stick does not matter.
    """
    turned = {"friction_input": "input_speed", "friction_output": "output_speed", "load_torque": "output_speed"}
    for torque, speed in turned.items():
        told, power = run[f"power_{torque.removesuffix('_torque')}"], run[torque] * run[speed]
        assert np.all(np.abs(told - power) <= ROUNDING * np.abs(power)), f"{WRONG}{torque} has another power"
    for name in run.names:
        assert not name.startswith("energy_") or run[name][0] == 0.0, f"{WRONG}{name} at the start"
    for name in ("power_damping", "stored_input", "stored_output"):
        assert np.all(run[name] >= 0.0), f"{WRONG}{name} is negative"


def known_speeds(gear: sw.Gear, run: sw.Recording) -> Mapping[str, NDArray[np.float64]]:
    """Those of the mesh only where the slope of the error is told by the angle, and that to more than rounding."""
    noise = gear.kinematic_noise
    if not steady(noise) or np.abs(run["input_angle"]).max() > FARTHEST:
        return {"friction_input": run["input_speed"], "friction_output": run["output_speed"]}
    return speeds(gear, run)


def beside_others(
    drive: sw.Drive, others: Mapping[str, list[float]], volts: Any, dt: float, course: dict[str, Any]
) -> sw.Recording:
    """The first of an ensemble, which is the drive itself; raises AssertionError if it is not what it is alone."""
    runs = sw.simulate_many(drive, volts, others, dt, record=list(outputs(drive)), threads=1, **course)
    for member in runs.failures.keys() ^ set(range(MEMBERS)):
        assert all(np.isfinite(runs[name][member]).all() for name in outputs(drive)), SILENT
    try:
        alone = sw.simulate(drive, volts, dt, method="exponential", **course)
    except (ValueError, FloatingPointError):
        assert 0 in runs.failures, DIFFERENT
        return runs.member(0)
    assert 0 not in runs.failures, DIFFERENT
    assert all(np.array_equal(runs[name][0], alone[name]) for name in outputs(drive)), DIFFERENT
    return alone


def with_derivatives(drive: sw.Drive, paths: list[str], volts: Any, dt: float, course: dict[str, Any]) -> None:
    """Raises AssertionError if derivatives change the run, or contradict each other."""

    def differentiated() -> sw.analysis.Derivatives:
        return sw.analysis.derivatives(drive, volts, paths, dt, **course)

    try:
        run = sw.simulate(drive, volts, dt, method="exponential", **course)
    except (ValueError, FloatingPointError):
        assert words(differentiated) != "finite", DIFFERENT
        raise
    try:
        found = differentiated()
    except (ValueError, FloatingPointError) as error:
        if not str(error).endswith("though the run is"):
            raise AssertionError(DIFFERENT) from error
        raise
    assert all(np.array_equal(found.run[name], run[name]) for name in outputs(drive)), DIFFERENT
    if not isinstance(drive.gear.structure, sw.structure.Lumped):  # stages give way, too
        return
    for path in found.parameters:
        whole, *parts = (found[name, path] for name in ("transmission_error", "twist", "kinematic_error"))
        size = sum(np.abs(part) for part in (whole, *parts))
        assert np.all(np.abs(whole - sum(parts)) <= ROUNDING * size), f"{WRONG}derivatives do not add up"
        assert not any(found[name, path].any() for name in given(drive)), f"{WRONG}an input depends on the drive"


def given(drive: sw.Drive) -> list[str]:
    """Columns that are inputs of the run. A gear that warms up has a temperature of its own."""
    return ["command"] if isinstance(drive.thermal, sw.thermal.Heating) else ["command", "temperature"]


def outcomes(numbers: Iterable[int], processes: int, limit: float = LIMIT) -> Iterator[Outcome]:
    """As they come."""
    for number, found in answers(outcome, numbers, processes, limit):
        yield Outcome(number, {"any": WRONG + found}, limit) if isinstance(found, str) else found


def tell(counted: Counter[tuple[str, str]], slowest: list[Outcome], wrong: list[Outcome]) -> None:
    for (kind, said), count in sorted(counted.items(), key=lambda item: (item[0][0], -item[1])):
        print(f"{count:7d}  {kind:12} {said[:160]}")
    for one in slowest:
        print(f"drive {one.number} took {one.took:.2f} s: {one.said}")
    for one in wrong:
        print(f"drive {one.number}: {one.said}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drives", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    options = parser.parse_args()
    counted: Counter[tuple[str, str]] = Counter()
    slowest: list[Outcome] = []
    wrong: list[Outcome] = []
    began = time.perf_counter()
    try:
        numbers = range(options.first, options.first + options.drives)
        for done, one in enumerate(outcomes(numbers, options.processes), start=1):
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
