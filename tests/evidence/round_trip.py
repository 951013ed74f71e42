"""Gears of real joints and of supplied trials, written and predicted with: `python -m tests.evidence.round_trip`.

Each record of `real_joints` and of `trials` (STRAINWAVE_TRIALS) is identified, its gear saved, read back, and compared with the
same record by `predict`. The error must be the one that the gear file states, and no number may be a limit.
"""

from __future__ import annotations

import argparse
import os
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.parameters import every

from tests.evidence import real_joints
from tests.evidence.drawn.written_gears import MAX_DIFFERENCE, MIN_NUMBER

TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", real_joints.SHARED / "trials"))
CONSTANT = "--constant torque_constant=0.1"  # N.m/A, of currents whose constant nobody knows (assumed)
SUPPLIED = (  # set, file, options
    ("csg-20-100", "turn4/slow.csv", CONSTANT),
    ("csg-20-100", "turn4/slow_sine.csv", CONSTANT),
    ("csg-14-50", "turn4/rl_motor.csv", "--joint 3 --constant rate=200"),
    ("csg-20-100", "turn4/bighyst.csv", "--constant torque_constant=0.12"),
    ("csg-20-100", "turn4/small_table.csv", "--column output_angle=table_deg --unit table_deg=deg"),
    ("csg-17-50", "turn4/rotor_detent.csv", "--side output"),
    ("csg-20-100", "turn4/08-panda-theta.csv", "--column input_angle=theta --column output_angle=q"),
    ("csg-20-100", "turn4/gravity_compensated.csv", "--unit position=rad"),
    ("csg-20-100", "turn4/te_noise.csv", CONSTANT),
    ("csg-20-100", "belt150/log.csv", "--constant ratio=150"),
    ("csg-20-100", "moteus/output.csv", "--unit position=rev"),
    ("csg-20-100", "plotjuggler/export.csv", ""),
)


@dataclass(frozen=True)
class RoundTrip:
    """A gear written, read and predicted with.

    Attributes:
        name: of the record
        held_out: the error that identify stated on held-out data; not a number if there is none
        stated: the error of the written gear on the whole record, as its file has it
        predicted: that of `predict`
        problem: why the gear is refused, or what is wrong with it; empty if nothing is
    """

    name: str
    held_out: float
    stated: float
    predicted: float
    problem: str


Record = tuple[str, str, list[Path], str]


def joints() -> Iterator[Record]:
    """Yield name, initial set, files and options of each record."""
    for trial in real_joints.trials():
        constant = CONSTANT if trial.file.startswith(("ur10e", "kinova-gen3/")) else ""
        yield trial.name, real_joints.START, real_joints.paths(trial), f"{trial.options} {constant}"
    for start, file, options in SUPPLIED:
        yield file, start, [TRIALS / file], options


def round_trip(name: str, start: str, files: Sequence[Path], options: str) -> RoundTrip:
    """Return the round trip of one record."""
    mapping = real_joints.mapping_of(options, files)
    try:
        found = sw.identify(start, files, mapping=mapping, accept=True)
    except ValueError as error:
        return RoundTrip(name, float("nan"), float("nan"), float("nan"), f"identify: {error}")
    held_out = found.files[0].held_out
    error = float("nan") if held_out is None else held_out.error
    stated = found.gear_set.validation[0].error if found.gear_set.validation else float("nan")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "gear.toml")
        found.gear_set.save(file)
        saved = GearSet.read(file)
        try:
            (predicted, *_) = sw.predict(file, files, mapping=mapping)
        except ValueError as refused:
            return RoundTrip(name, error, stated, float("nan"), f"predict: {refused}")
    tiny = [path for path, each in every(saved.gear).items() if 0.0 < abs(each.value) < MIN_NUMBER]
    problem = f"limits were written: {', '.join(tiny)}" if tiny else ""
    if not abs(predicted.error - stated) <= MAX_DIFFERENCE * stated:
        problem = f"predict leaves {predicted.error:.4g}, the file states {stated:.4g}"
    return RoundTrip(name, error, stated, predicted.error, problem)


def main(given: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="a part of the names of the records (all)")
    wanted = parser.parse_args(given)
    print(f"{'record':48} {'held out':>9} {'stated':>9} {'predict':>9}")
    bad = 0
    for name, *record in joints():
        if wanted.only in name:
            each = round_trip(name, *record)
            is_refused = each.problem.startswith("identify: ")
            bad += bool(each.problem) and not is_refused
            print(f"{name:48} {each.held_out:9.4g} {each.stated:9.4g} {each.predicted:9.4g}  {each.problem[:200]}", flush=True)
    print(f"{bad} gears are not what they state")
    return int(bad > 0)


if __name__ == "__main__":
    raise SystemExit(main())
