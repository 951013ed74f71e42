"""Wrong assumptions about an independent joint fail a check, right ones none: `python -m tests.evidence.assumptions --seeds 3`.

The joint and its measurements are a program that shares nothing with this package (STRAINWAVE_RIG points to its folder). Of
each seed its files are identified with a wrong ratio, torque constant, side, unit or start set, one mistake at a time, in files
that contain what contradicts it; and with everything right. Each wrong assumption must fail a check, and no right one may.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from strainwave.files.gear_set import GearSet
from strainwave.identification.identify import Identified, identify
from strainwave.identification.reading.mapping import FileMapping

from tests.evidence.rig import START, measured

FILES = (
    "friction.csv", "friction_de.csv", "torsion_input.csv", "torsion_output.csv", "branch.csv", "log.csv", "log_full.csv",
    "log_link.csv", "log_torque_sign.csv", "log_outliers.csv", "two_loads/light.csv", "two_loads/middle.csv",
    "two_loads/heavy.csv",
)  # fmt: skip
OF_MOTOR = ("log.csv", "log_outliers.csv", "log_full.csv", "two_loads/light.csv", "two_loads/middle.csv", "two_loads/heavy.csv")


@dataclass(frozen=True)
class Case:
    """Files with what is assumed of them.

    Attributes:
        kind: of the mistake; empty if all is right
        name: what is assumed
        files: below the folder of a seed
        mapping: stated of them
        start: set to start from
        constant: factor of the torque constant given
    """

    kind: str
    name: str
    files: tuple[str, ...]
    mapping: FileMapping = field(default_factory=FileMapping)
    start: str = START
    constant: float = 1.0


@dataclass(frozen=True)
class Verdict:
    """The checks of a case: names of those that failed, the first message, and the time taken [s]."""

    case: Case
    failed: tuple[str, ...]
    message: str
    seconds: float

    @property
    def is_right(self) -> bool:
        """True if a wrong assumption failed a check, or a right one none."""
        return bool(self.failed) == bool(self.case.kind)


def wrong() -> Iterator[Case]:
    """Yield wrong assumptions that the files contradict."""
    yield Case("ratio", "100 of a gear of 80, two encoders", ("log_full.csv",), start="csg-20-100")
    yield Case("ratio", "100 of a gear of 80, two encoders, other loads", ("two_loads/heavy.csv",), start="csg-20-100")
    yield Case("ratio", "100 of a gear of 80, motor encoder", ("log.csv",), start="csg-20-100")
    both = ("torsion_input.csv", "torsion_output.csv")
    yield Case("ratio", "100 of a gear of 80, a loop from both sides", both, start="csg-20-100")
    yield Case("constant", "half, with voltage and speed", ("log_full.csv",), constant=0.5)
    yield Case("constant", "twice, with voltage and speed", ("log_full.csv",), constant=2.0)
    yield Case("constant", "half, with two encoders", ("two_loads/middle.csv",), constant=0.5)
    yield Case("side", "joint angle as that of the motor", ("log_link.csv",), FileMapping(columns={"input_angle": "q [deg]"}))
    yield Case(
        "side", "joint torque as that of the motor", ("log_link.csv",), FileMapping(columns={"input_torque": "tau [N.m]"})
    )
    yield Case(
        "side", "motor angle as that of the joint", ("log.csv",), FileMapping(columns={"output_angle": "motor_angle [deg]"})
    )
    yield Case("side", "friction of the motor as that of the joint", ("friction.csv",), FileMapping(side="output"))
    swapped = {"input_angle": "twist [arcmin]", "input_torque": "torque [N.m]"}
    yield Case("side", "loop of the output as that of the input", ("torsion_output.csv",), FileMapping(columns=swapped))
    swapped = {"twist": "input_angle [deg]", "torque": "input_torque [N.m]"}
    yield Case("side", "loop of the input as that of the output", ("torsion_input.csv",), FileMapping(columns=swapped))
    yield Case("unit", "joint angle in rev as rad", ("log_link_rev.csv",))
    yield Case("unit", "joint angle in deg as rad", ("log_link_deg.csv",))
    yield Case("unit", "motor angle in rev as rad", ("log_rev.csv",))
    yield Case("unit", "motor angle in deg as rad", ("log_deg.csv",))
    yield Case("unit", "joint torque in mN.m as N.m", ("log_link_mNm.csv",))
    yield Case("unit", "friction in mN.m as N.m", ("friction_Nm.csv",))
    yield Case("unit", "current in mA as A", ("log_mA.csv",))
    for files in (("torsion_output.csv",), ("torsion_input.csv",), ("log_full.csv",), ("two_loads/middle.csv",)):
        yield Case("set", f"size 32, ratio 50, with {files[0]}", files, start="hfuc-32-50")


def right() -> Iterator[Case]:
    """Yield the right assumptions about each file."""
    for name in FILES:
        yield Case("", name, (name,))
    yield Case("", "all files", FILES)


def made(folder: Path, seed: int) -> dict[str, float]:
    """Write the files of a seed, and those with units that nobody states; return the truth."""
    shutil.copytree(measured(seed), folder, dirs_exist_ok=True)
    rev, deg = 1.0 / 360.0, 1.0
    _copy(
        folder / "log_link.csv", folder / "log_link_rev.csv", {"q [deg]": ("q [rad]", rev), "dq [deg/s]": ("dq [rad/s]", rev)}
    )
    _copy(
        folder / "log_link.csv", folder / "log_link_deg.csv", {"q [deg]": ("q [rad]", deg), "dq [deg/s]": ("dq [rad/s]", deg)}
    )
    _copy(folder / "log_link.csv", folder / "log_link_mNm.csv", {"tau [N.m]": ("tau [N.m]", 1e3)})
    _copy(folder / "log.csv", folder / "log_rev.csv", {"motor_angle [deg]": ("motor_angle [rad]", rev)})
    _copy(folder / "log.csv", folder / "log_deg.csv", {"motor_angle [deg]": ("motor_angle [rad]", deg)})
    _copy(folder / "log.csv", folder / "log_mA.csv", {"current [A]": ("current [A]", 1e3)})
    _copy(folder / "friction.csv", folder / "friction_Nm.csv", {"torque [mNm]": ("torque [Nm]", 1.0)})
    truth: dict[str, float] = json.loads((folder / "truth.json").read_text())
    return truth


def _copy(source: Path, target: Path, changed: Mapping[str, tuple[str, float]]) -> None:
    """Write a table with other names of columns, their values times a factor."""
    with source.open() as file:
        head, *rows = csv.reader(file)
    factors = [changed.get(name, (name, None))[1] for name in head]
    with target.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([changed.get(name, (name, 1.0))[0] for name in head])
        for row in rows:
            writer.writerow(
                [text if factor is None else f"{float(text) * factor:.10g}" for text, factor in zip(row, factors, strict=True)]
            )


def verdict(case: Case, folder: Path, truth: Mapping[str, float]) -> Verdict:
    """Return the checks of a case."""
    begun = time.perf_counter()
    try:
        found = identified(case, folder, truth)
    except ValueError as refused:
        return Verdict(case, ("refused",), str(refused), time.perf_counter() - begun)
    refused_files = [f"{each.name}: {each.refused}" for each in found.files if each.refused]
    names = [check.name for check in found.failed] + ["refused"] * bool(refused_files)
    messages = [check.message for check in found.failed] + refused_files
    return Verdict(case, tuple(names), messages[0] if messages else "", time.perf_counter() - begun)


def identified(case: Case, folder: Path, truth: Mapping[str, float]) -> Identified:
    """Return the result of a case: of logs by current with the torque constant and the inertia of the motor."""
    own = GearSet.read(START)  # the right one: the motor of the truth has the gear's input inside
    of_motor = {"torque_constant": truth["Kt"] * case.constant, "motor_inertia": truth["Jm"] - own.gear.input_inertia}
    logs = {folder / name for name in OF_MOTOR}

    def mapping(path: Path) -> FileMapping:
        by_current = path in logs or path.name in ("log_rev.csv", "log_deg.csv", "log_mA.csv")
        return case.mapping.updated(FileMapping(constants=of_motor)) if by_current else case.mapping

    return identify(case.start, [folder / name for name in case.files], mapping=mapping)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3, help="how many (3)")
    parser.add_argument("--first", type=int, default=0, help="the first seed (0)")
    parser.add_argument("--only", default="", help="a part of the kind and the name of cases (all)")
    wanted = parser.parse_args()
    verdicts: list[Verdict] = []
    for seed in range(wanted.first, wanted.first + wanted.seeds):
        with tempfile.TemporaryDirectory() as folder:
            truth = made(Path(folder), seed)
            for case in (*wrong(), *right()):
                if wanted.only not in f"{case.kind or 'right'} {case.name}":
                    continue
                verdicts.append(verdict(case, Path(folder), truth))
                print(line(verdicts[-1], seed), flush=True)
    return int(not all([_counted("wrong", [each for each in verdicts if each.case.kind]),
                        _counted("right", [each for each in verdicts if not each.case.kind])]))  # fmt: skip


def line(each: Verdict, seed: int) -> str:
    """Return a verdict in a line."""
    words = f"{each.message[:150]}" if each.failed else "no check failed"
    mark = "ok " if each.is_right else "BAD"
    name = f"{each.case.kind or 'right':8} {each.case.name:48}"
    return f"{mark} seed {seed} {name} {each.seconds:5.1f} s  {', '.join(each.failed)}: {words}"


def _counted(kind: str, verdicts: list[Verdict]) -> bool:
    good = sum(each.is_right for each in verdicts)
    share = 100.0 * good / len(verdicts) if verdicts else math.nan
    print(f"{kind}: {good} of {len(verdicts)} as they must be ({share:.0f} %)")
    return good == len(verdicts)


if __name__ == "__main__":
    sys.exit(main())
