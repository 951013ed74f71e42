"""False alarms of the diagnosis against a baseline, by simulation: `python -m tests.evidence.false_alarms`.

Each healthy unit has its own kinematic error, stiffness, friction, inertia and load. Its recordings are of several days: the
friction differs with the temperature, the load with what is carried, the kinematic error by `--day`, and the noise is another
one. Some days are the baseline, the others are diagnosed as `strainwave diagnose joint RECORDING --baseline FOLDER --gear FILE`
does it, the blind search included. Every alarm is false. Runs of one unit share a baseline, so that their alarms are not
independent. Intervals are therefore those of the share of units with an alarm.

The spread of changes over their stated standard deviation is 1 if that is right, and less if it is larger than need be.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import strainwave as sw
from strainwave.diagnose.diagnosis import Diagnosis, Question, RunDiagnosis, diagnosed
from strainwave.diagnose.refusals import JointRecording, usable
from strainwave.parameters import every
from strainwave.simulation.ensemble import Ensemble, simulate_many

from tests.support.shares import share_interval

RATES = (0.05, 0.01, 0.001)  # stated rates of false alarms
SEED = 7
STROKE, PERIOD, DURATION = 0.5, 10.0, 20.0  # rad and s, of a motion to and fro of the output: 25 revolutions of the input
SAMPLE = 0.01  # s
NOISE = (0.003, 0.03)  # A, of the current of a unit
UNIT_SPREAD = 0.2  # relative standard deviation of the numbers of a unit
FRICTION_SPREAD, LOAD_SPREAD = 0.1, 0.02  # relative standard deviation from day to day, by the temperature and what is carried
ORDERS, AMPLITUDES = (1.0, 2.0, 4.0), (2e-5, 6e-5, 1e-5)  # of the kinematic error, rad
UNITS_AT_ONCE = 16  # of one ensemble


@dataclass(frozen=True)
class Days:
    """Numbers of recordings of each unit.

    Attributes:
        baseline: days of the baseline
        later: days that are diagnosed
    """

    baseline: int = 3
    later: int = 5

    @property
    def all(self) -> int:
        """All recordings of a unit."""
        return self.baseline + self.later


def joint() -> sw.GearSet:
    """Return a catalogue gear with a motor and an arm under gravity."""
    return sw.GearSet.read("csg-25-100").with_parts(
        motor=sw.motor.CurrentSource(torque_constant=0.2, inertia=1.5e-4),
        control=sw.control.PI(proportional=2.0, integral=40.0, limit=20.0),
        load=sw.loads.Pendulum(inertia=0.5, gravity_torque=40.0),
        source="simulated",
    )


def numbers(drive: sw.Drive, days: Days, day_spread: float, random: np.random.Generator) -> list[dict[str, float]]:
    """Return the numbers of the recordings of one unit, a mapping for each day."""
    own = every(drive)
    parts = ("gear.stiffness.", "gear.friction_input.", "load.", "motor.", "gear.kinematic_error.amplitude")
    varied = [path for path in own if path.startswith(parts) and own[path].value > 0.0]
    unit = {path: own[path].value * float(np.exp(UNIT_SPREAD * random.standard_normal())) for path in varied}
    unit["gear.friction_input.breakaway"] = unit["gear.friction_input.coulomb"]
    unit |= {path: random.uniform(-np.pi, np.pi) for path in own if path.startswith("gear.kinematic_error.phase")}
    recorded = []
    for _ in range(days.all):
        friction = float(np.exp(FRICTION_SPREAD * random.standard_normal()))
        load = 1.0 + LOAD_SPREAD * float(random.standard_normal())
        of_the_day = dict(unit)
        for path in unit:
            if "friction" in path:
                of_the_day[path] *= friction
            elif path.startswith("load."):
                of_the_day[path] *= load
            elif day_spread > 0.0 and path.startswith("gear.kinematic_error.amplitude"):
                of_the_day[path] *= float(np.exp(day_spread * random.standard_normal()))
        recorded.append(of_the_day)
    return recorded


def recordings(
    runs: Ensemble, first: int, days: Days, ratio: float, noise: float, random: np.random.Generator
) -> list[JointRecording]:
    """Return the recordings of one unit with noise of the current [A]."""
    found = []
    for day in range(days.all):
        run = runs.member(first + day)
        noisy = run.with_column("current", run["current"] + noise * random.standard_normal(len(run)), "A")
        found.append(usable(noisy, f"day {day}", ratio=ratio))
    return found


def diagnoses(
    units: int,
    days: Days,
    *,
    day_spread: float = 0.0,
    noise: tuple[float, float] = NOISE,
    seed: int = SEED,
    false_alarm: float = RATES[-1],
) -> Iterator[Diagnosis]:
    """Yield the diagnosis of each unit: its later days against its baseline.

    Args:
        units: number of healthy units
        days: of each
        day_spread: relative standard deviation of the kinematic error from day to day
        noise: of the current, least and largest of a unit [A]
        seed: of all that is drawn
        false_alarm: stated rate
    """
    gear_set = joint()
    error = sw.kinematic_error.Fourier(order=ORDERS, amplitude=AMPLITUDES, phase=[0.0] * len(ORDERS))
    drive, random = gear_set.drive.replace({"gear.kinematic_error": error}), np.random.default_rng(seed)
    ratio = float(drive.gear.kinematics.ratio)
    question = Question(gear_set, ratio=ratio, false_alarm=false_alarm)
    motion = sw.scenario.sine(amplitude=STROKE, frequency=1.0 / PERIOD, duration=DURATION)
    for begin in range(0, units, UNITS_AT_ONCE):
        count = min(UNITS_AT_ONCE, units - begin)
        members = [member for _ in range(count) for member in numbers(drive, days, day_spread, random)]
        columns = {path: [member[path] for member in members] for path in members[0]}
        runs = simulate_many(drive, motion, columns, sample=SAMPLE, record=["input_angle", "current"])
        if runs.failures:
            raise ValueError(f"a healthy unit cannot be simulated: {next(iter(runs.failures.values()))}")
        for unit in range(count):
            own_noise = float(np.exp(random.uniform(*np.log(noise))))
            record = recordings(runs, unit * days.all, days, ratio, own_noise, random)
            yield diagnosed(record[days.baseline :], question, baseline=record[: days.baseline])


def least_probability(run: RunDiagnosis) -> float:
    """Return the least probability of a change: the run is an alarm at each stated rate above it; 1 if nothing is compared."""
    return 1.0 if run.comparison is None else min((each.false_alarm for each in run.comparison.changes), default=1.0)


def scores(run: RunDiagnosis) -> list[float]:
    """Return the changes of a run over their stated standard deviations, of orders that were not found in it alone."""
    changes = () if run.comparison is None else run.comparison.changes
    return [each.change / each.sigma for each in changes if not each.is_new]


def spread(changed: Sequence[float]) -> str:
    """Return the spread of changes over their stated standard deviations, in words."""
    middle = float(np.median(np.abs(changed))) if changed else float("nan")
    square = float(np.sqrt(np.mean(np.square(changed)))) if changed else float("nan")
    return f"changes over their stated standard deviation: root mean square {square:.3f}, median size {middle:.3f}"


def units_with_an_alarm(least: Sequence[Sequence[float]], rate: float) -> int:
    """Return the number of units with a run that is an alarm at a stated rate."""
    return sum(any(each < rate for each in one) for one in least)


def table(least: Sequence[Sequence[float]]) -> str:
    """Return alarms and units with an alarm at each stated rate, with the interval of the share of units.

    The rate of alarms per run is at most this share, and at least the share over the number of runs of a unit.

    Args:
        least: least probability of each run, by unit
    """
    runs = sum(map(len, least))
    lines = [f"{'stated':>7} {'alarms':>7} {'runs':>6} {'rate':>8} {'units with an alarm':>21}   95 % interval of this share"]
    for rate in RATES:
        alarms = sum(each < rate for one in least for each in one)
        units = units_with_an_alarm(least, rate)
        low, high = share_interval(units, len(least))
        lines.append(
            f"{rate:>7g} {alarms:>7} {runs:>6} {alarms / runs:>8.5f} {f'{units} of {len(least)}':>21}   {low:.4f} to {high:.4f}"
        )
    return "\n".join(lines)


def exceeds(least: Sequence[Sequence[float]], rate: float) -> bool:
    """True if the rate of alarms per run is above a stated one, by the lower end of the interval over units.

    A unit with n runs has an alarm with a probability of at most n times the rate.
    """
    most = max(map(len, least)) * rate
    return share_interval(units_with_an_alarm(least, rate), len(least))[0] > most


def main() -> int:
    """Print the counts, and return 1 if a rate is higher than stated."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--units", type=int, default=2000)
    parser.add_argument("--baseline", type=int, default=3, help="days of the baseline of each unit (3)")
    parser.add_argument("--later", type=int, default=5, help="later days of each unit, each of them a run (5)")
    parser.add_argument("--day", type=float, default=0.0, help="spread of the kinematic error from day to day, as 0.1 (0)")
    parser.add_argument("--noise", type=float, nargs=2, default=NOISE, metavar=("LEAST", "LARGEST"), help="of a unit, A")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--minutes", type=float, default=float("inf"), help="after which no further unit is begun")
    asked = parser.parse_args()
    begin, least, changed = time.monotonic(), list[list[float]](), list[float]()
    verdicts, shown = dict[str, int](), begin
    for found in diagnoses(
        asked.units,
        Days(asked.baseline, asked.later),
        day_spread=asked.day,
        noise=(asked.noise[0], asked.noise[1]),
        seed=asked.seed,
    ):
        least.append([least_probability(run) for run in found.runs])
        changed += [score for run in found.runs for score in scores(run)]
        for run in found.runs:
            verdicts[run.verdict] = verdicts.get(run.verdict, 0) + 1
            for change in run.comparison.alarms if run.comparison else ():
                new = ", found in this run alone" if change.is_new else ""
                print(
                    f"unit {len(least)}: order {change.order:.4g} {change.direction}, {change.false_alarm:.2g}{new}", flush=True
                )
        now = time.monotonic()
        if now - shown > 60.0:
            shown = now
            print(f"{len(least)} units in {now - begin:.0f} s", table(least), spread(changed), sep="\n", flush=True)
        if now - begin > 60.0 * asked.minutes:
            break
    print(f"{STROKE:g} rad, {DURATION:g} s at {1.0 / SAMPLE:g} Hz; baseline of {asked.baseline} days; {verdicts}")
    print(table(least), spread(changed), sep="\n")
    return int(any(exceeds(least, rate) for rate in RATES))


if __name__ == "__main__":
    sys.exit(main())
