"""Recordings of real joints beside plain least squares of another program: `python -m tests.evidence.real_joints`.

Each file of `data/arms`, and a few others (STRAINWAVE_DATA points to `data`), is identified by one command. Its error on the
last 30 % of the motion, in the full band at every sample, is compared with the best one of `tools/yardstick`
(STRAINWAVE_YARDSTICK), which shares nothing with this package: it must not be larger by more than 2 % without a failed check,
no check may fail if it is smaller, and its median over joints that move alone must be a quarter smaller. Then both halves of
each record of a joint that moves alone are identified by themselves: 85 % of the numbers that both determine must lie within
two standard deviations of their difference. From a second start set (`--start csg-20-100 csg-25-100`) the numbers must be the
same, likewise.
"""

from __future__ import annotations

import argparse
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from strainwave.commands.file_options import FileOptions
from strainwave.files.recording import Recording
from strainwave.identification.identify import Identified, identify
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.identification.reading.source import measurement_files
from strainwave.identification.results.combined_parameter import difference
from strainwave.identification.results.file_result import MAX_UNEXPLAINED, FileEstimate

Array = NDArray[np.float64]
SHARED = Path(__file__).parents[3] / "shared"
ARMS = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data")) / "arms"
YARDSTICK = Path(os.environ.get("STRAINWAVE_YARDSTICK", SHARED / "tools" / "yardstick"))
START = "csg-20-100"
MAX_SHARE = 1.02  # of the error of plain least squares, of any file
MAX_MEDIAN_SHARE = 0.75  # likewise, over joints alone
MAX_DISTANCE = 2.0  # standard deviations between two halves, or from two start sets
MIN_WITHIN = 0.85  # share of numbers that are no further apart
NOTHING = "parameters determined"  # name of the check that a record determines anything of the gear: a refusal in words
KUKA_RATIOS = ("1798/7", "267.429", "252.333", "221", "239.619", "154.323")


@dataclass(frozen=True)
class Trial:
    """A joint of a file.

    Attributes:
        file: its path from `data/arms` on; of several files that are one record, their pattern
        options: of `strainwave identify csg-20-100 FILE`
        yardstick: arguments of the yardstick; empty if it cannot read the record
        alone: True if no other joint moves
    """

    file: str
    options: str
    yardstick: str
    alone: bool = True

    @property
    def name(self) -> str:
        joint = re.search(r"--joint (\S+)", self.options)
        return f"{self.file} {joint.group(1)}" if joint and not self.alone else self.file


@dataclass(frozen=True)
class Outcome:
    """The held-out error of a trial beside that of the yardstick.

    Attributes:
        trial: the joint
        model: chosen
        error: on the last 30 % of the motion; not a number if the file was refused
        plain: of plain least squares on the same samples
        unit: of both
        relative: the error over that of a model that predicts nothing
        best: smallest error of the yardstick
        failed: messages of failed checks
        refused: why the file is not used, or has no data held out
        seconds: taken
        estimates: of the numbers that the record determines
    """

    trial: Trial
    model: str
    error: float
    plain: float
    unit: str
    relative: float
    best: float
    failed: tuple[str, ...] = ()
    refused: str = ""
    seconds: float = 0.0
    estimates: tuple[FileEstimate, ...] = ()

    @property
    def share(self) -> float:
        """The error over the best of the yardstick."""
        return self.error / self.best

    @property
    def is_right(self) -> bool:
        """True if the model predicts no worse than the yardstick, and explains the record."""
        return self.share <= MAX_SHARE and self.relative <= MAX_UNEXPLAINED


def trials() -> Iterator[Trial]:
    """Yield every joint of every log, those that move alone first."""
    for joint in (1, 2, 4, 5):
        yield Trial(f"ur10e/ur-20_01_22-joint_{joint}.csv", _ur(joint), _ur_columns(joint))
    for joint in (1, 2, 4, 5, 6, 7):
        yield Trial(f"kinova-gen3/joint_{joint}_trapez.csv", "", _kinova_columns(joint))
    idle = (
        "left-hip-pitch/idle", "left-hip-pitch/ref", "left-hip-roll/idle", "genova01-left-hip-pitch/idle",
        "right-ankle-roll/Idle", "right-knee/idle", "right-knee/ref",
    )  # fmt: skip
    for name in idle:
        yield Trial(
            f"icub/{name}.mat", "--kind log --side output --column joint_torque=block3",
            "--rate 100 --degrees --angle 0 --speed 1 --effort 2",
        )  # fmt: skip
    for name in ("20_01_17-ptp_10_points", "20_02_05-20sec_12harm", "20_02_19_14harm50secLoad"):
        for joint in range(1, 7):
            yield Trial(f"ur10e/ur-{name}.csv", _ur(joint), _ur_columns(joint, others=6), alone=False)
    for name in ("RunTrajectory1", "Trajectory1"):
        for joint in range(1, 8):
            yield Trial(
                f"kinova-gen3/{name}.csv", f"--joint {joint}", _kinova_columns(joint, others=7), alone=False
            )  # fmt: skip
    for run in (1, 3):
        for joint in range(1, 8):
            options = f"--joint {joint} --column joint_torque=tau_{joint}"
            yield Trial(f"kinova-gen3-split/*_{run}.csv", options, _block_columns(joint, 7), alone=False)
    for joint, ratio in enumerate(KUKA_RATIOS, 1):
        value = "256.857142857" if "/" in ratio else ratio
        options = f"--joint {joint} --column input_torque=rec.act_torque_abs_nm --constant ratio={value}"
        yield Trial("kuka-kr300/FF_A.mat", options, f"--degrees {_block_columns(joint, 6)}", alone=False)
    for joint in range(1, 8):
        options = f"--joint {joint} --unit '- arm_{joint}_joint_effort=N.m'"
        yield Trial("tiago/tiago_*.csv", options, _block_columns(joint, 7), alone=False)
    for speed in ("slow", "middle", "high"):
        yield Trial(f"nnfm/case4_{speed}.csv", "", "--time time --angle q7 --effort q7_tau_J_compensate", alone=False)
    yield Trial(
        "../../trials/turn4/08-panda-theta.csv", "--column input_angle=theta --column output_angle=q",
        "--time time --angle q --effort tau_J", alone=False,
    )  # fmt: skip
    yield Trial(
        "direct-drive/cin_*1_n90_exp_gan.t", "--constant ratio=1", "--time 0 --angle 1 --effort 2 --degrees", alone=False
    )
    axis = "--column input_angle=qm --unit qm=rad --column current=vir --constant torque_constant=35.15 --constant ratio=1"
    yield Trial("../emps/DATA_EMPS.mat", axis, "--time 0 --angle 1 --effort 2", alone=False)
    constant = "--joint 3 --constant torque_constant=0.1"
    yield Trial("../cobot-temperature/dataset_02052023.csv", constant, "", alone=False)


def _ur(joint: int) -> str:
    return f"--joint {joint} --column current=block3 --constant ratio=101"


def _ur_columns(joint: int, others: int = 0) -> str:
    return f"--time 0 --angle {joint} --speed {joint + 6} --effort {joint + 12}{_others(map(str, _except(joint, others)))}"


def _kinova_columns(joint: int, others: int = 0) -> str:
    names = (f"Position{other}" for other in _except(joint, others))
    return f"--rate 1000 --angle Position{joint} --speed Velocity{joint} --effort TorqueCur{joint}{_others(names)}"


def _block_columns(joint: int, count: int) -> str:
    """Return the columns of a table of time and, of `count` joints each, angle, speed and torque."""
    columns = f"--time 0 --angle {joint} --speed {joint + count} --effort {joint + 2 * count}"
    return columns + _others(map(str, _except(joint, count)))


def _except(joint: int, count: int) -> list[int]:
    return [other for other in range(1, count + 1) if other != joint]


def _others(names: Any) -> str:
    found = ",".join(names)
    return f" --others {found}" if found else ""


TIAGO_FILES = ("position", "velocity", "effort")

# ---- One trial -------------------------------------------------------------------------------------------------------


def outcome(trial: Trial, start: str = START, best: float | None = None) -> Outcome:
    """Return the held-out error of a trial beside that of the yardstick, which is run unless it is given."""
    begun = time.perf_counter()
    best = best_of_yardstick(trial) if best is None else best
    try:
        found = identified(trial, start)
    except ValueError as error:
        return Outcome(trial, "refused", np.nan, np.nan, "", np.nan, best, refused=str(error))
    result, seconds = found.files[0], time.perf_counter() - begun
    failed = tuple(f"{check.name}: {check.message}" for check in found.failed if check.name != NOTHING)
    nothing = next((check.message for check in found.failed if check.name == NOTHING), "")
    estimates = tuple(each.estimate for each in found.parameters if not each.estimate.why)
    if (held_out := result.held_out) is None:
        why = nothing or result.refused or "nothing held out"
        return Outcome(trial, result.model, np.nan, np.nan, "", np.nan, best, failed, why, seconds, estimates)
    return Outcome(
        trial, result.model, held_out.error, held_out.plain, held_out.unit, held_out.relative, best, failed, nothing, seconds,
        estimates,
    )  # fmt: skip


def identified(trial: Trial, start: str = START) -> Identified:
    """Return the result of the command of a trial."""
    return identify(start, paths(trial), mapping=mapping(trial))


def paths(trial: Trial) -> list[Path]:
    """Return the files of a trial."""
    return sorted(ARMS.glob(trial.file))


def mapping(trial: Trial) -> Any:
    """Return what the options of a trial state of its files."""
    return mapping_of(trial.options, paths(trial))


def mapping_of(options: str, files: Sequence[Path]) -> Any:
    """Return what options of `strainwave identify` state of files."""
    given = shlex.split(options)
    values: dict[str, list[str]] = {}
    for name, value in zip(given[::2], given[1::2], strict=True):
        values.setdefault(name, []).append(value)
    one = {name: values.get(f"--{name}", [None])[0] for name in ("side", "joint", "kind")}
    several = (values.get(f"--{name}") for name in ("column", "unit", "constant"))
    return FileOptions(None, *several, **one).mapping_of(measurement_files(files).files)


def best_of_yardstick(trial: Trial) -> float:
    """Return the smallest error of the yardstick's models, with the terms of other joints and without."""
    printed = ""
    if not trial.yardstick:
        return np.nan
    with tempfile.TemporaryDirectory() as folder:
        file = _readable(trial, Path(folder))
        for words in {trial.yardstick, trial.yardstick.partition(" --others")[0]}:
            command = [sys.executable, str(YARDSTICK), file, *words.split()]
            printed += subprocess.run(command, check=False, capture_output=True, text=True).stdout  # nothing of a joint at rest
    errors = [float(value) for value in re.findall(r"(?:CV|curved|load) (\S+?)(?:;|\s|$)", printed)]
    return min(errors, default=np.nan)


def _readable(trial: Trial, folder: Path) -> str:
    """Return the file of a trial as the yardstick reads it: one table of time, angles, speeds and torques of all joints."""
    if trial.file.startswith("icub"):
        return f"{ARMS / trial.file}:out"
    if trial.file.startswith("kuka"):
        from scipy.io import loadmat

        record = loadmat(ARMS / trial.file)["rec"][0, 0]
        names = ("time_cont", "act_pos_mot_deg", "act_vel_mot_deg_per_s", "act_torque_abs_nm")
        blocks = [record[name].T for name in names]
    elif trial.file.startswith("kinova-gen3-split"):
        blocks = [
            np.loadtxt(ARMS / trial.file.replace("*", f"{name}_downsampled"), ndmin=2) for name in ("t", "q", "q_d", "tau")
        ]
        blocks[0] = blocks[0].reshape(-1, 1)
    elif trial.file.startswith("tiago"):
        tables = [np.loadtxt(ARMS / f"tiago/tiago_{name}.csv", delimiter=",", skiprows=1) for name in TIAGO_FILES]
        blocks = [tables[0][:, :1], *(table[:, 2:] for table in tables)]  # without the lift of the torso
    elif trial.file.startswith("direct-drive"):
        angle, torque = (np.loadtxt(path) for path in paths(trial))
        blocks = [angle, torque[:, 1:]]
    elif trial.file.endswith("EMPS.mat"):
        from scipy.io import loadmat

        axis = loadmat(ARMS / trial.file)
        blocks = [axis[name].reshape(-1, 1) for name in ("t", "qm", "vir")]
    else:
        return str(ARMS / trial.file)
    np.savetxt(folder / "table.csv", np.hstack(blocks), delimiter=",")
    return str(folder / "table.csv")


# ---- Halves ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Pair:
    """A number by both halves of a record, or from two start sets.

    Attributes:
        file: the record
        one, other: by each half
        one_model: True if both have the same law of friction
    """

    file: str
    one: FileEstimate
    other: FileEstimate
    one_model: bool

    @property
    def apart(self) -> float:
        """Standard deviations of the difference."""
        return abs(difference(self.one, self.other)) / float(np.hypot(self.one.sigma, self.other.sigma))


def halves(trial: Trial) -> Iterator[Pair]:
    """Yield the numbers that both halves of the motion of a record determine."""
    file = recognise(measurement_files(paths(trial)).files[0], mapping(trial)(paths(trial)[0]))
    said = FileMapping(constants={name: value for name, value in file.constants.items() if name != "rate"})
    results = []
    for half in cut(file.recording):
        try:
            results.append(identify(START, {"log": half}, mapping=said).files[0])
        except ValueError as error:
            print(f"  {trial.name}: a half is refused: {error}")
            return
    yield from pairs(trial, *([each for each in result.estimates if not each.why] for result in results))


def pairs(trial: Trial, *estimates: Sequence[FileEstimate]) -> Iterator[Pair]:
    """Yield the numbers that two results of a trial both determine."""
    one, other = ({each.label: each for each in result} for result in estimates)
    laws = [{path for path in each if "friction" in path} for each in (one, other)]
    for label in sorted(one.keys() & other.keys()):
        yield Pair(trial.name, one[label], other[label], laws[0] == laws[1])


def cut(recording: Recording) -> tuple[Recording, Recording]:
    """Return both halves of the motion of a record, its rest before and behind left out."""
    angle = recording[next(name for name in recording.names if name.endswith("angle"))]
    moved = np.flatnonzero(np.abs(np.gradient(angle)) > 1e-3 * np.ptp(angle) / len(angle))
    first, last = int(moved[0]), int(moved[-1]) + 1
    middle = (first + last) // 2
    return _rows(recording, first, middle), _rows(recording, middle, last)


def _rows(recording: Recording, first: int, last: int) -> Recording:
    columns = {name: recording[name][first:last] for name in recording.names}
    return Recording(columns, {name: recording.unit(name) for name in recording.names})


# ---- Report ----------------------------------------------------------------------------------------------------------


def line(each: Outcome) -> str:
    """Return an outcome in a line, with its failed checks below."""
    words = (
        f"{each.trial.name:48} {each.error:9.4g} {each.plain:9.4g} {each.best:9.4g} {each.unit:5} "
        f"{100.0 * each.relative:6.1f} % {each.share:6.3f} {each.seconds:5.1f} s  {each.model}"
    )
    refused = [f"    refused: {each.refused[:230]}"] * bool(each.refused)
    return "\n".join([words, *refused, *(f"    failed: {message[:230]}" for message in each.failed)])


def main(given: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="a part of the names of the files (all)")
    parser.add_argument("--alone", action="store_true", help="joints that move alone")
    parser.add_argument("--no-halves", action="store_true", help="whole records only")
    parser.add_argument(
        "--start", nargs="+", default=[START], help=f"start sets, each of which every joint is identified from ({START})"
    )
    wanted = parser.parse_args(given)
    chosen = [each for each in trials() if wanted.only in each.name and (each.alone or not wanted.alone)]
    print(f"{'file, joint':48} {'error':>9} {'plain':>9} {'yardstick':>9} {'':5} {'of rms':>8} {'share':>6} {'time':>7}  model")
    outcomes: dict[str, list[Outcome]] = {start: [] for start in wanted.start}
    for trial in chosen:
        best = best_of_yardstick(trial)
        for start, of_start in outcomes.items():
            of_start.append(outcome(trial, start, best))
            print(line(of_start[-1]), flush=True)
    bad = False
    for start, of_start in outcomes.items():
        print(f"\nfrom {start}:")
        bad |= verdict(of_start)
    first, *others = outcomes.values()
    for other in others:
        both = zip(first, other, strict=True)
        bad |= verdict_of_pairs("start sets", [pair for a, b in both for pair in pairs(a.trial, a.estimates, b.estimates)])
    if not wanted.no_halves:
        bad |= verdict_of_pairs("halves", [pair for trial in chosen if trial.alone for pair in halves(trial)])
    return int(bad)


def verdict(outcomes: Sequence[Outcome]) -> bool:
    """Print what all outcomes show together; return True if it is not what must be reached."""
    alone, every = (
        [each.share for each in outcomes if np.isfinite(each.share) and each.trial.alone >= least] for least in (1, 0)
    )
    worse = [each for each in outcomes if each.share > MAX_SHARE]
    silent = [each.trial.name for each in worse if not each.failed]
    wrongly = [each.trial.name for each in outcomes if each.is_right and each.failed]
    median = float(np.median(alone)) if alone else np.nan
    of_every = float(np.median(every)) if every else np.nan
    print(
        f"median over {len(alone)} joints alone: {median:.3f} of the yardstick's error; over all {len(every)}: {of_every:.3f}"
    )
    print(f"worse than {MAX_SHARE} of it: {len(worse)}, without a failed check: {len(silent)}: {', '.join(silent)}")
    print(f"no worse, but with a failed check: {len(wrongly)}: {', '.join(wrongly)}")
    return bool(silent or wrongly) or median > MAX_MEDIAN_SHARE


def verdict_of_pairs(what: str, pairs: Sequence[Pair]) -> bool:
    """Print the share of numbers that agree; return True if it is too small."""
    for pair in sorted(pairs, key=lambda pair: -pair.apart):
        one, other = pair.one, pair.other
        print(
            f"{pair.apart:6.1f} σ  {one.label:40} {one.value:10.4g} ± {one.sigma:<8.2g} {other.value:10.4g} ± "
            f"{other.sigma:<8.2g} {one.unit:10} {pair.file}{'' if pair.one_model else '  (other law of friction)'}"
        )
    same = [pair.apart < MAX_DISTANCE for pair in pairs if pair.one_model or "friction" not in pair.one.path]
    every = [pair.apart < MAX_DISTANCE for pair in pairs]
    share = float(np.mean(same)) if same else np.nan
    print(
        f"{what}: {100.0 * share:.0f} % of {len(same)} numbers within {MAX_DISTANCE:g} standard deviations; with friction of "
        f"two laws {100.0 * float(np.mean(every)) if every else np.nan:.0f} % of {len(every)}"
    )
    return share < MIN_WITHIN


if __name__ == "__main__":
    sys.exit(main())
