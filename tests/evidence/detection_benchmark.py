"""Detection probability of a comparison with a baseline: `python -m tests.evidence.detection_benchmark`.

Units are drawn from what the catalogue leaves open of a CSG-25-100: stiffness, hysteresis, kinematic error, friction, inertia
and torque constant. Each has its own baseline of six days; friction and load differ from day to day. Three faults grow in each
unit: a misalignment, a crack and a bearing. Load, noise and length of the record vary.

Detectors: the comparison of `strainwave diagnose joint` with its own stated false-alarm rate, at the orders that it names and
at that of the bearing, which is asked for; under the first condition also the whole diagnosis, which searches for lines itself
and is asked for no order; and two simple ones, the relative change of the rms of the current, and of its rms without the mean.
Thresholds of these are what one in a thousand healthy records of the training units exceeds under the training conditions.
Reported are records of other units, under the training conditions and under others. Intervals are exact, of 95 %. Each unit has
each fault once.

`--out FOLDER` writes `detection.png` and `detection.json` there.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):  # matrices are small, and the numbers are those of one core
    os.environ.setdefault(_name, "1")

import numpy as np  # noqa: E402
import strainwave as sw  # noqa: E402
from numpy.typing import NDArray  # noqa: E402
from strainwave.dataset.faults import changes, prepared  # noqa: E402
from strainwave.diagnose.baseline import Baseline, baseline_of, compared  # noqa: E402
from strainwave.diagnose.diagnosis import Question, diagnosed  # noqa: E402
from strainwave.diagnose.refusals import JointRecording, usable  # noqa: E402
from strainwave.diagnose.replicates import joint_motion  # noqa: E402
from strainwave.parameters import every  # noqa: E402
from strainwave.tuning.drawn import drawn_gears  # noqa: E402

from tests.support.shares import share_interval  # noqa: E402

Array = NDArray[np.float64]

FALSE_ALARM = 1e-3
RATIO = 100.0
ASKED = (10.41227,)  # order of the bearing; those of a crack are named by the diagnosis
PROBABILITY = 0.9  # of an alarm, at which a severity counts as found
RUN_IN, LONGEST = 1.5, 16.0  # s before a record, and of the longest one
STEP, SAMPLE = 5e-4, 4e-3  # s, of the simulation and of a record
BASELINE_DAYS, HEALTHY_DAYS, TRAINING_DAYS = 6, 5, 25
FRICTION_BY_DAY, LOAD_BY_DAY, MOTOR_INERTIA = 0.1, 0.05, 0.1  # relative ranges, either way
LOAD_PATHS = ("load.angle[0]", "load.angle[1]", "load.held_torque[0]", "load.held_torque[1]")
FRICTION_PATHS = tuple(f"gear.friction_input.law.{name}" for name in ("coulomb", "breakaway", "viscous"))
SEARCH = "diagnose, nothing asked"
DETECTORS = ("diagnose", "rms without mean", "rms")
FAULTS: Mapping[str, tuple[Any, tuple[float, ...]]] = {
    "misalignment": (sw.fault.Misalignment(), (0.01, 0.02, 0.04, 0.08, 0.16, 0.32)),
    "crack": (sw.fault.FlexsplineCrack(), (0.03, 0.06, 0.12, 0.25, 0.5, 1.0)),
    "bearing": (sw.fault.WaveGeneratorBearing(), (0.005, 0.01, 0.02, 0.04, 0.08, 0.16)),
}


@dataclass(frozen=True)
class Condition:
    """Motion and load of records."""

    speed: float = 20.0  # rad/s of the input
    load: float = 40.0  # N.m at the output

    @property
    def label(self) -> str:
        return f"{self.speed:g} rad/s, {self.load:g} N·m"


@dataclass(frozen=True)
class Case:
    """A condition, a sensor and a length of records."""

    condition: Condition = Condition()
    noise: float = 0.05  # A rms of a sample
    length: float = 8.0  # s
    is_held_out: bool = False  # condition is none of the training

    @property
    def label(self) -> str:
        return f"{self.condition.label}, {1e3 * self.noise:g} mA, {self.length:g} s"


TRAINING = (Condition(), Condition(load=20.0))
BASE = Case()
CASES = (
    BASE,
    replace(BASE, condition=TRAINING[1]),
    replace(BASE, noise=0.02),
    replace(BASE, noise=0.2),
    replace(BASE, length=4.0),
    replace(BASE, length=16.0),
    replace(BASE, condition=Condition(load=10.0), is_held_out=True),
    replace(BASE, condition=Condition(speed=30.0, load=30.0), is_held_out=True),
)
SWEEPS = {"load": (6, 1, 0), "noise": (2, 0, 3), "length": (4, 0, 5), "condition": (0, 7)}  # cases of each


@dataclass(frozen=True)
class Count:
    """Records with an alarm of one detector."""

    alarms: int
    records: int

    @property
    def share(self) -> float:
        return self.alarms / self.records

    @property
    def interval(self) -> tuple[float, float]:
        """Exact interval of 95 %."""
        return share_interval(self.alarms, self.records)


def gear_set() -> sw.GearSet:
    """Return the joint: a gear of the catalogue behind a current source with a speed loop."""
    return sw.GearSet.read("csg-25-100").with_parts(
        motor=sw.motor.CurrentSource(torque_constant=0.06, inertia=1e-4),
        control=sw.control.PI(proportional=1.5, integral=30.0, limit=40.0),
        load=sw.loads.TorqueTable(inertia=0.1, angle=[-100.0, 100.0], held_torque=[40.0, 40.0]),
        source="a benchmark",
    )


class Joint:
    """The drive prepared for all faults, and its units."""

    def __init__(self, units: int, seed: int) -> None:
        whole = gear_set()
        faults = [each for each, _ in FAULTS.values()]
        self.drive = prepared(whole.drive, faults)
        self.question = Question(whole, ratio=RATIO, orders=ASKED, false_alarm=FALSE_ALARM)
        self.chance = np.random.default_rng(seed)
        drawn = {path: values for path, values in drawn_gears(whole, units, seed).items() if path not in LOAD_PATHS}
        drawn["motor.inertia"] = 1e-4 * (1.0 + MOTOR_INERTIA * self.chance.uniform(-1.0, 1.0, units))
        self.drives = [
            prepared(whole.drive.replace({path: float(values[unit]) for path, values in drawn.items()}), faults)
            for unit in range(units)
        ]
        numbers = [{path: each.value for path, each in every(drive).items()} for drive in self.drives]
        paths = [path for path in numbers[0] if any(each[path] != numbers[0][path] for each in numbers)]
        self.units = [{path: each[path] for path in (*paths, *FRICTION_PATHS)} for each in numbers]

    def day(self, unit: int, load: float, fault: str = "", severity: float = 0.0) -> dict[str, float]:
        """Return the numbers of a unit on a day of its own, with a fault or none."""
        wrong = [each.replace(severity=severity if name == fault else 0.0) for name, (each, _) in FAULTS.items()]
        numbers = self.units[unit] | changes(self.drives[unit], wrong)
        friction = 1.0 + FRICTION_BY_DAY * self.chance.uniform(-1.0, 1.0)
        numbers |= {path: friction * numbers[path] for path in FRICTION_PATHS}
        torque = load * (1.0 + LOAD_BY_DAY * self.chance.uniform(-1.0, 1.0))
        return numbers | {"load.held_torque[0]": torque, "load.held_torque[1]": torque}

    def records(self, condition: Condition, days: Sequence[Mapping[str, float]]) -> list[tuple[Array, Array]]:
        """Return angle and current of the longest record of each day, without noise."""
        columns = {path: [day[path] for day in days] for path in days[0]}
        command = sw.scenario.constant(condition.speed / RATIO, RUN_IN + LONGEST)
        runs = sw.simulate_many(
            self.drive, command, columns, STEP, sample=SAMPLE, record=["input_angle", "current"], threads=1
        )  # fmt: skip
        if runs.failures:
            raise RuntimeError(f"a run failed: {next(iter(runs.failures.values()))}")
        begin = round(RUN_IN / SAMPLE)
        members = [runs.member(number) for number in range(len(days))]
        return [(run["input_angle"][begin:].copy(), run["current"][begin:].copy()) for run in members]


class Unit:
    """Records of one unit under one condition: its baseline, and the days to be judged."""

    def __init__(self, case: Case, baseline: Sequence[tuple[Array, Array]], joint: Joint, chance: np.random.Generator) -> None:
        self.case, self.joint, self.chance = case, joint, chance
        noisy = [self.noisy(each) for each in baseline]
        self.rms = float(np.mean([np.sqrt(np.mean(current**2)) for _, current in noisy]))
        self.ripple = float(np.mean([np.std(current) for _, current in noisy]))
        self.records = noisy

    def noisy(self, record: tuple[Array, Array]) -> tuple[Array, Array]:
        samples = round(self.case.length / SAMPLE)
        angle, current = record[0][:samples], record[1][:samples]
        return angle, current + self.case.noise * self.chance.standard_normal(len(current))

    def recording(self, angle: Array, current: Array) -> JointRecording:
        columns = {"time": SAMPLE * np.arange(len(angle)), "input_angle": angle, "current": current}
        return usable(sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"}), "record", ratio=RATIO)

    def simple(self, record: tuple[Array, Array]) -> tuple[float, float]:
        """Return the relative changes of the rms without mean and of the rms, as sizes."""
        _, current = self.noisy(record)
        return abs(float(np.std(current)) / self.ripple - 1.0), abs(float(np.sqrt(np.mean(current**2))) / self.rms - 1.0)

    def judged(self, record: tuple[Array, Array], thresholds: Sequence[float]) -> tuple[bool, bool, bool] | None:
        """Return the alarm of each detector; None if the diagnosis compares nothing."""
        angle, current = self.noisy(record)
        comparison = compared(self.healthy, joint_motion(self.recording(angle, current)), false_alarm=FALSE_ALARM)
        if not comparison.changes:
            return None
        ripple, rms = float(np.std(current)) / self.ripple, float(np.sqrt(np.mean(current**2))) / self.rms
        return bool(comparison.alarms), abs(ripple - 1.0) > thresholds[0], abs(rms - 1.0) > thresholds[1]

    @cached_property
    def recorded(self) -> list[JointRecording]:
        """Recordings of the baseline."""
        return [self.recording(*each) for each in self.records]

    @cached_property
    def healthy(self) -> Baseline:
        """Replicates of the baseline at the orders that are named or asked for."""
        orders = [each.order for each in self.joint.question.named_orders(self.recorded[0])]
        return baseline_of([joint_motion(each) for each in self.recorded], orders)

    def searched(self, records: Sequence[tuple[Array, Array]]) -> list[bool]:
        """Return the alarms of the whole diagnosis, which searches for lines and is asked for no order."""
        own = [replace(self.recording(*self.noisy(record)), name=f"record {day}") for day, record in enumerate(records)]
        found = diagnosed(own, replace(self.joint.question, orders=()), baseline=self.recorded)
        return [run.verdict == "changed" for run in found.runs]


def trained(units: int, cases: Sequence[Case], seed: int) -> dict[tuple[float, float], tuple[float, float]]:
    """Return the thresholds of the simple detectors for each noise and length, by units and conditions of the training."""
    joint = Joint(units, seed)
    runs: list[list[list[tuple[Array, Array]]]] = []
    for condition in TRAINING:
        days = [joint.day(unit, condition.load) for unit in range(units) for _ in range(BASELINE_DAYS + TRAINING_DAYS)]
        each = iter(joint.records(condition, days))
        runs.append([[next(each) for _ in range(BASELINE_DAYS + TRAINING_DAYS)] for _ in range(units)])
    found = {}
    for noise, length in sorted({(case.noise, case.length) for case in cases}):
        case = Case(noise=noise, length=length)
        changed = []
        for own in (records for condition in runs for records in condition):
            unit = Unit(case, own[:BASELINE_DAYS], joint, joint.chance)
            changed += [unit.simple(record) for record in own[BASELINE_DAYS:]]
        ordered = np.sort(np.array(changed), axis=0)
        place = max(int(np.ceil((1.0 - FALSE_ALARM) * len(ordered))) - 1, 0)
        found[noise, length] = (float(ordered[place, 0]), float(ordered[place, 1]))
    return found


@dataclass(frozen=True)
class Result:
    """Alarms of a case.

    Attributes:
        case: the condition, sensor and length
        found: of each detector, by fault and severity; by no fault and 0 of healthy records
        not_compared: records that the diagnosis does not compare with the baseline
    """

    case: Case
    found: Mapping[tuple[str, float], Mapping[str, Count]]
    not_compared: int


def results(
    units: int, cases: Sequence[Case], thresholds: Mapping[tuple[float, float], tuple[float, float]], seed: int
) -> Iterator[Result]:
    """Yield the alarms of each case on units that the training does not contain."""
    joint = Joint(units, seed)
    labels = [("", 0.0)] * HEALTHY_DAYS + [(name, each) for name, (_, severities) in FAULTS.items() for each in severities]
    for condition in dict.fromkeys(case.condition for case in cases):
        days = []
        for unit in range(units):
            days += [joint.day(unit, condition.load) for _ in range(BASELINE_DAYS)]
            days += [joint.day(unit, condition.load, *label) for label in labels]
        each = iter(joint.records(condition, days))
        records = [([next(each) for _ in range(BASELINE_DAYS)], [next(each) for _ in labels]) for _ in range(units)]
        for case in (case for case in cases if case.condition == condition):
            alarms: dict[tuple[str, float], list[tuple[bool, bool, bool]]] = {label: [] for label in labels}
            left_out, searches = 0, list[list[bool]]()
            for baseline, own in records:
                unit = Unit(case, baseline, joint, joint.chance)
                searches += [unit.searched(own)] if case == BASE else []
                for label, record in zip(labels, own, strict=True):
                    judged = unit.judged(record, thresholds[case.noise, case.length])
                    left_out += judged is None
                    alarms[label].append(judged or (False, False, False))
            found = {
                label: {name: Count(sum(row[k] for row in rows), len(rows)) for k, name in enumerate(DETECTORS)}
                for label, rows in alarms.items()
            }
            if searches:
                for label, counts in found.items():
                    places = [place for place, each in enumerate(labels) if each == label]
                    alarms_found = [row[place] for row in searches for place in places]
                    counts[SEARCH] = Count(sum(alarms_found), len(alarms_found))
            yield Result(case, found, left_out)


def shares(result: Result, fault: str, detector: str) -> Array:
    """Return the share of alarms at each severity of a fault."""
    return np.array([result.found[fault, each][detector].share for each in FAULTS[fault][1]])


def severity_for(result: Result, fault: str, detector: str) -> float:
    """Return the least severity at which the probability is reached, between two severities by their logarithm."""
    severities, alarms = FAULTS[fault][1], shares(result, fault, detector)
    reached = np.flatnonzero(alarms >= PROBABILITY)
    if not reached.size:
        return float("inf")
    first = int(reached[0])
    if first == 0:
        return severities[0]
    step = (PROBABILITY - alarms[first - 1]) / (alarms[first] - alarms[first - 1])
    return float(np.exp(np.interp(step, (0.0, 1.0), np.log(severities[first - 1 : first + 1]))))


def is_lost_again(result: Result, fault: str, detector: str) -> bool:
    """True if the probability is reached at one severity and not at a larger one."""
    reached = shares(result, fault, detector) >= PROBABILITY
    return bool(np.any(reached[:-1] & ~reached[1:]))


def severity_cell(result: Result, fault: str, detector: str) -> str:
    """Return the least severity that is found, in words, with a star if a larger one is not."""
    size, star = severity_for(result, fault, detector), "*" * is_lost_again(result, fault, detector)
    return f"> {FAULTS[fault][1][-1]:g}" if np.isinf(size) else f"{size:.2g}{star}"


def planned(case: Case) -> float:
    """Return the severity of a misalignment whose order 4 is the planned detection limit, by noise alone."""
    drive = gear_set().drive.replace(load=sw.loads.Inertia(inertia=0.1))
    limit = sw.diagnose.detection_limit(
        drive, speed=case.condition.speed, load_torque=case.condition.load, duration=case.length, sample_rate=1.0 / SAMPLE,
        noise=case.noise, order=4.0, false_alarm=FALSE_ALARM, tests=4,
    )  # fmt: skip
    facts = sw.fault.Facts(flexspline_teeth=200, circular_spline_teeth=202, ratio=-RATIO)
    return limit.amplitude / next(
        value for *_, value, _, _, _, order in FAULTS["misalignment"][0].changes(facts) if order == 4.0
    )


def table(found: Sequence[Result]) -> str:
    """Return the tables as Markdown."""
    lines = [
        "| held out | record | healthy records | " + " | ".join(f"alarms: {name}" for name in DETECTORS) + " | not compared |"
    ]
    lines.append("|---|---|---|" + "---|" * (len(DETECTORS) + 1))
    groups = {"units": [each for each in found if not each.case.is_held_out]}
    groups["units and condition"] = [each for each in found if each.case.is_held_out]
    for name, group in groups.items():
        for result in group:
            counts = result.found["", 0.0]
            cells = [str(counts[DETECTORS[0]].records), *(str(counts[each].alarms) for each in DETECTORS)]
            lines.append(f"| {name} | {result.case.label} | {' | '.join(cells)} | {result.not_compared} |")
    for name, group in ((name, group) for name, group in groups.items() if group):
        total = {each: sum(result.found["", 0.0][each].alarms for result in group) for each in DETECTORS}
        count = sum(result.found["", 0.0][DETECTORS[0]].records for result in group)
        cells = [
            f"{Count(total[each], count).share:.1e}, {Count(total[each], count).interval[0]:.1e} to "
            f"{Count(total[each], count).interval[1]:.1e}"
            for each in DETECTORS
        ]
        lines.append(f"| {name} | all: rate with interval | {count} | {' | '.join(cells)} | |")
    lines += ["", "| fault | record | " + " | ".join(f"severity for {PROBABILITY:g}: {name}" for name in DETECTORS) + " |"]
    lines.append("|---|---|" + "---|" * len(DETECTORS))
    for fault in FAULTS:
        for result in found:
            cells = [severity_cell(result, fault, each) for each in DETECTORS]
            lines.append(f"| {fault} | {result.case.label} | {' | '.join(cells)} |")
    lines += ["", f"*: at a larger severity the probability is below {PROBABILITY:g} again"]
    lines += ["", "| fault | severity | " + " | ".join(f"probability: {name}" for name in (*DETECTORS, SEARCH)) + " |"]
    lines.append("|---|---|" + "---|" * (len(DETECTORS) + 1))
    base = next(each for each in found if each.case == BASE)
    for fault, severities in {"": (0.0,), **{name: each for name, (_, each) in FAULTS.items()}}.items():
        for severity in severities:
            counts = base.found[fault, severity]
            cells = [f"{each.share:.2f} ({each.interval[0]:.2f} to {each.interval[1]:.2f})" for each in counts.values()]
            lines.append(f"| {fault or 'healthy'} | {severity:g} | {' | '.join(cells)} |")
    return "\n".join(lines)


def draw(found: Sequence[Result], folder: Path) -> None:
    """Draw probability over severity: a row for each fault, a column for each sweep."""
    from matplotlib.figure import Figure

    by_case = {each.case: each for each in found}
    figure = Figure(figsize=(15.0, 10.0), layout="constrained")
    grid = figure.subplots(len(FAULTS), len(SWEEPS), sharey=True)
    styles = dict(zip(DETECTORS, ("-", "--", ":"), strict=True))
    for row, (fault, (_, severities)) in zip(grid, FAULTS.items(), strict=True):
        for axes, (sweep, places) in zip(row, SWEEPS.items(), strict=True):
            for number, place in enumerate(places):
                result = by_case[CASES[place]]
                case = result.case
                label = {
                    "load": f"{case.condition.load:g} N·m",
                    "noise": f"{1e3 * case.noise:g} mA",
                    "length": f"{case.length:g} s",
                }
                for detector, style in styles.items():
                    counts = [result.found[fault, each][detector] for each in severities]
                    if detector == "diagnose" and sweep == "condition":
                        low, high = np.array([each.interval for each in counts]).T
                        axes.fill_between(severities, low, high, color=f"C{number}", alpha=0.15, lw=0)
                    name = label.get(sweep, f"held out: units{', condition' * case.is_held_out}")
                    axes.semilogx(
                        severities, shares(result, fault, detector), style, color=f"C{number}", marker=".",
                        label=name if detector == "diagnose" else None,
                    )  # fmt: skip
                if sweep == "condition" and SEARCH in result.found[fault, severities[0]]:
                    axes.semilogx(
                        severities, shares(result, fault, SEARCH), color="0.3", marker="x", label=SEARCH.partition(", ")[2]
                    )
                if fault == "misalignment":
                    axes.axvline(planned(case), color=f"C{number}", lw=1.0, ls="-.")
            axes.set(title=f"{fault}, by {sweep}", xlabel="severity", xlim=(severities[0], severities[-1]), ylim=(-0.02, 1.02))
            axes.set_xticks(severities, [f"{each:g}" for each in severities])
            axes.minorticks_off()
            axes.grid(alpha=0.3)
            axes.legend(fontsize="small", loc="upper left")
        row[0].set_ylabel("detection probability")
    figure.suptitle("solid: diagnose (band: 95 %); dashed: rms without mean; dotted: rms; dash-dotted: planned limit")
    figure.savefig(folder / "detection.png", dpi=80)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--units", type=int, default=16, help="units that are reported (16)")
    parser.add_argument("--training", type=int, default=20, help="units of the training (20)")
    parser.add_argument("--out", type=Path, help="folder of the picture and of all counts")
    wanted = parser.parse_args()
    begin = time.process_time()
    thresholds = trained(wanted.training, CASES, seed=1)
    print(f"training: {time.process_time() - begin:.0f} s", file=sys.stderr)
    found = []
    for result in results(wanted.units, CASES, thresholds, seed=2):
        found.append(result)
        print(f"{result.case.label}: {result.not_compared} not compared, {time.process_time() - begin:.0f} s", file=sys.stderr)
    print(table(found))
    if wanted.out:
        wanted.out.mkdir(parents=True, exist_ok=True)
        draw(found, wanted.out)
        rows = [
            asdict(each.case) | {"fault": fault, "severity": severity} | {name: asdict(count) for name, count in counts.items()}
            for each in found
            for (fault, severity), counts in each.found.items()
        ]
        (wanted.out / "detection.json").write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    print(f"{time.process_time() - begin:.0f} s of one core", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
