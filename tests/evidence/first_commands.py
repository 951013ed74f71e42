"""Recordings of others at the first command, and at those that questions suggest: `python -m tests.evidence.first_commands`.

Each recording of `trials` (STRAINWAVE_TRIALS), of `data/arms` (STRAINWAVE_DATA) and of a recorder that the tests write is given
to the command that a person would type first. If it is refused with a question, the answer that is true of the file is pasted,
twice at most. The table has the commands that were needed and the outcome: right, refused in words, or WRONG: a number that is
further from the truth than three of its standard deviations, without a failed check.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import io
import json
import os
import re
import shlex
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import radians
from pathlib import Path
from unittest import mock

from strainwave import exit_codes
from strainwave.commands.cli import main as strainwave
from strainwave.questions import NUMBER, Answer

from tests.python.identification.reading.test_your_recorder import RECORDERS

SHARED = Path(__file__).parents[3] / "shared"
ARMS = Path(os.environ.get("STRAINWAVE_DATA", SHARED / "data")) / "arms"
TRIALS = Path(os.environ.get("STRAINWAVE_TRIALS", SHARED / "trials"))
MAX_COMMANDS = 3  # the first, and two that questions suggest
MAX_ROUNDING = 2e-3  # relative, of friction and gravity, whose truth is stated in two or three digits
MAX_SIGMA = 3.0  # standard deviations of a number from the truth
MIN_SHARE_OF_FIRST = 0.8  # of the recordings that are read at the first command
NO_COMMAND = "no command is suggested"
COULOMB, VISCOUS, GRAVITY = "gear.friction_input.coulomb", "gear.friction_input.viscous", "load.gravity_torque"
# Numbers that commands print: the pattern of value and standard deviation, and the size of their unit.
PRINTED = {
    "order 2": (r"order 2: (\S+) ± (\S+) µrad", 1e-6),
    "200": (r"line 200\.\d+ .*: (\S+) ± (\S+) mA", 1e-3),
    "resonance": (r"resonance at (\S+) ± (\S+) Hz", 1.0),
    "damping ratio": (r"damping ratio (\S+) ± (\S+)", 1.0),
}
Truth = Mapping[str, tuple[float, float]]  # value, and the relative difference that counts as right whatever the deviation


@dataclass(frozen=True)
class Case:
    """A recording and the command that a person would type first.

    Attributes:
        command: with the path of the file below `TRIALS` or `ARMS` as FILE
        file: that path
        truth: of the numbers that are known; none of a recording whose truth nobody knows
        knows: what the person knows: words of the right answer, the first ones before others
        number: what the person writes in place of a number that only the person knows
    """

    command: str
    file: Path
    truth: Truth = field(default_factory=dict)
    knows: Sequence[str] = ()
    number: str = ""

    def started(self, start: str) -> Case:
        """Return the case from another set; the ratio is given if that of the set is not the true one."""
        own = re.search(r"identify (\S+)", self.command)
        if own is None:
            return self
        ratio = own[1].rpartition("-")[2]
        more = "" if start.endswith(f"-{ratio}") or "ratio=" in self.command else f" --constant ratio={ratio}"
        return replace(self, command=f"{self.command.replace(own[1], start)}{more}")


@dataclass(frozen=True)
class Outcome:
    """Outcome of a recording at its first commands.

    Attributes:
        commands: that were needed
        verdict: "right", "read" if the truth is not known, "contradicted" by a failed check, "refused", or "WRONG"
        message: the last refusal, the failed checks, or the numbers that are wrong
    """

    commands: int
    verdict: str
    message: str = ""


def about(coulomb: float, viscous: float | None = None, gravity: float | None = None, off: float = MAX_ROUNDING) -> Truth:
    """Return the truth of friction at the input and of gravity, each with a relative difference that counts as right."""
    known = {COULOMB: coulomb, VISCOUS: viscous, GRAVITY: gravity}
    return {path: (value, off) for path, value in known.items() if value is not None}


def cases() -> list[Case]:
    """Return every recording with its natural command, and what is known of it."""
    t, joint = TRIALS, about(0.060, 4e-4, 25.0)
    identify, orders = "identify csg-20-100 FILE", "orders FILE"
    current = f"{identify} --constant torque_constant=0.1"
    order2 = {"order 2": (121.2e-6, 1e-3)}
    found = [
        Case(identify, t / "moteus/output.csv", joint),
        Case(identify, t / "epos/permille.csv", joint, number="0.4"),
        Case(current, t / "belt150/log.csv", {"ratio": (150.0, 0.0), GRAVITY: (24.98, 0.0)}, knows=("ratio=150",)),
        Case(identify, t / "loadloss/dyno.csv", about(0.050, 3e-4)),
        Case(identify, t / "loadloss/dyno_driving_only.csv", about(0.050, 3e-4)),
        Case(identify, t / "loadloss/friction_load.csv", about(0.050, 3e-4)),
        Case(identify, t / "twincat/scope_single.csv", joint, number="0.4"),
        Case(identify, t / "plotjuggler/export.csv", joint),
        Case(identify, t / "lostmotion/lost.csv"),
        Case(identify, t / "lostmotion/full.csv", {"gear.stiffness.a1": (1.6e4, 0.0)}),
        *(Case(orders, t / f"turn4/{name}.csv", order2) for name in ("te_60rpm_s7", "te_30rpm_s3")),
        *(Case(orders, t / f"turn4/{name}.csv", order2) for name in ("v_order2only", "v_sine_speed")),
        Case(orders, t / "turn4/te_one.mat", order2),
        Case(orders, t / "turn4/enc2.csv", order2),
        *(Case(f"{orders} --ratio 100", t / f"turn4/{name}.csv", {"200": (0.030, 0.0)}) for name in ("te_noise", "no_te")),
        Case(current, t / "turn4/slow.csv", {"steady_friction": (0.064, 0.0)}),
        Case(current, t / "turn4/slow_sine.csv", about(0.060, 4e-4)),
        Case("identify csg-14-50 FILE --joint 3 --constant rate=200", t / "turn4/rl_motor.csv", about(0.022, 3.6e-5, 4.9)),
        Case(
            f"{identify} --constant ratio=101", t / "turn4/ur_effort.csv", about(0.085, 4e-4, 38.0), knows=("current",),
            number="0.0985",
        ),
        Case(
            f"{identify} --constant torque_constant=0.12", t / "turn4/bighyst.csv",
            {"gear.stiffness.a1": (1.2e4, 0.0), "gear.hysteresis.stiffness[0]": (3e3, 0.0)},
        ),
        Case(f"{identify} --constant torque_constant=0.05", t / "turn4/dxl.csv", about(0.02, 1e-4, 3.2)),
        Case(identify, t / "turn4/small_table.csv", about(0.05, 4e-4)),
        Case(identify, t / "turn4/dial.csv", {"lost_motion": (radians(0.021), 0.0)}),
        Case(orders, t / "turn4/runup.csv", {"resonance": (38.0, 0.0), "damping ratio": (0.03, 0.0)}),
        Case("identify csg-17-50 FILE", t / "turn4/rotor_detent.csv", about(0.084, 3.82e-4)),
        Case(identify, t / "turn4/07-sea.csv"),
        Case(identify, t / "turn4/08-panda-theta.csv", {"gear.stiffness.a1": (1.6e4, 0.0)}, knows=("input_angle=theta",)),
        Case(
            current, t / "turn4/erob_data.txt", {"gear.friction_input.law.coulomb": (0.0118, 0.0)},
            knows=("spd=rpm", "output"),
        ),
        Case(identify, t / "turn4/gravity_compensated.csv", about(0.06, 4e-4)),
    ]  # fmt: skip
    ur = ("--joint 1 ", "current=block3")
    for path in sorted((ARMS / "ur10e").glob("*.csv")):
        found.append(Case(f"{identify} --constant ratio=101", path, knows=ur))
    found += [Case(identify, path) for path in sorted((ARMS / "kinova-gen3").glob("*.csv"))]
    found += [Case(identify, path, knows=("joint_torque=block3",)) for path in sorted((ARMS / "icub").glob("*/*.mat"))]
    found += [Case(identify, ARMS / name, knows=("joint_torque",)) for name in ("direct-drive", "kinova-gen3-split", "tiago")]
    found += [Case(f"{identify} --joint all", ARMS / name) for name in ("nnfm", "tiago")]
    found += [Case(identify, path) for path in sorted((ARMS / "nnfm").glob("*.csv"))]
    kuka = {COULOMB: (397.0 / 256.857, 0.12), VISCOUS: (1800.0 / 256.857**2, 0.12)}
    found.append(
        Case(
            f"{identify} --constant ratio=256.857142857",
            ARMS / "kuka-kr300/FF_A.mat",
            kuka,
            knows=("--joint 1 ", "input_torque"),
        )
    )
    return found


def recorders(folder: Path) -> list[Case]:
    """Return the files of recorders that the tests write, with the options that their page states."""
    known = about(0.060, 4e-4, 25.0, off=0.02)  # their torque has no noise
    found = []
    for name, (write, answer) in RECORDERS.items():
        (folder / name).mkdir()
        path = write(folder / name)
        given = Answer(name, {key: value for key, value in vars(answer).items() if value and key in ("joint", "side", "units")})
        constant = " --constant torque_constant=0.1" if name == "UR RTDE" else ""
        found.append(Case(f"identify csg-20-100 FILE{constant} {shlex.join(given.options)}", path, known))
    return found


def ran(words: Sequence[str]) -> tuple[int, str, str]:
    """Return exit code, output and message of a command."""
    out, err = io.StringIO(), io.StringIO()
    with mock.patch.object(sys, "argv", list(words)), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            strainwave()
            code = 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 0
    return code, out.getvalue(), err.getvalue()


def suggested(words: Sequence[str], message: str, case: Case) -> list[str] | None:
    """Return the command of a message that is pasted: of several answers the one that the person knows to be true."""
    lines = message.splitlines()
    commands = [line.strip() for line in lines if line.startswith("    strainwave ")]
    if not commands:
        return None
    known = [each for each in commands if all(word in f"{each} " for word in case.knows)]
    known = known or [each for each in commands if any(word in f"{each} " for word in case.knows)]
    command = (known or commands)[0]
    return shlex.split(command.replace(NUMBER, case.number))


def outcome(case: Case, folder: Path) -> Outcome:
    """Return the outcome of a recording."""
    words = ["strainwave", *shlex.split(case.command.replace("FILE", shlex.quote(str(case.file))))]
    for count in range(1, MAX_COMMANDS + 1):
        out = folder / str(count)
        code, printed, message = ran([*words, "--out", str(out)])
        if code != exit_codes.INPUT_REFUSED:
            failed = "; ".join(line.strip() for line in printed.splitlines() if line.startswith(("FAILED", "failed")))
            if code == exit_codes.RESULT_CONTRADICTED:
                return Outcome(count, "contradicted", failed)
            return judged(case, out, count, printed)
        following = suggested(words, message.replace(f" --out {out}", ""), case)
        if following is None or following == words:
            return Outcome(count, "refused", f"{NO_COMMAND}: {message.strip()}")
        words = following
    return Outcome(MAX_COMMANDS, "refused", message.strip())


def judged(case: Case, out: Path, count: int, printed: str) -> Outcome:
    """Return the outcome of a recording that was read, by what is known of it."""
    numbers = numbers_of(out, printed)
    wrong, right = [], 0
    for path, (value, off) in case.truth.items():
        for estimate, sigma in numbers.get(path, ()):
            apart = abs(estimate - value)
            if apart > max(off * abs(value), MAX_SIGMA * sigma):
                wrong.append(f"{path} {estimate:.5g} ± {sigma:.2g}, true {value:.5g}")
            right += 1
    if wrong:
        return Outcome(count, "WRONG", "; ".join(wrong))
    if case.truth and not right:
        return Outcome(count, "read", f"without {', '.join(case.truth)}")
    return Outcome(count, "right" if case.truth else "read")


def numbers_of(out: Path, printed: str) -> dict[str, list[tuple[float, float]]]:
    """Return the numbers that a command determined, each with its standard deviation."""
    found: dict[str, list[tuple[float, float]]] = {}
    if (out / "numbers.csv").is_file():
        with open(out / "numbers.csv", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if (
                    row["state"] == "identified"
                    and row["unit"].startswith(("N.m", "kg", "rad", "1", ""))
                    and "in A" not in row["law"]
                ):
                    found.setdefault(row["path"], []).append((float(row["value"]), float(row["sigma"] or 0.0)))
    for path in (out / "results.json",):
        if path.is_file() and (ratio := json.loads(path.read_text(encoding="utf-8")).get("ratio")) is not None:
            found.setdefault("ratio", []).append((float(ratio), 0.0)) if isinstance(ratio, int | float) else None
    for name, (pattern, size) in PRINTED.items():
        if (numbers := re.search(pattern, printed)) is not None:
            found[name] = [(size * float(numbers[1]), size * float(numbers[2]))]
    return found


def main(given: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="a part of the paths of the recordings (all)")
    parser.add_argument("--start", default="", help="the set to start from in each command (its own)")
    wanted = parser.parse_args(given)
    counted = Counter[tuple[str, int]]()
    print(f"{'recording':58} {'commands':>8} {'outcome':13} {'s':>5}")
    written = tempfile.TemporaryDirectory()
    for case in [*cases(), *recorders(Path(written.name))]:
        if wanted.only not in str(case.file):
            continue
        begun = time.process_time()
        with tempfile.TemporaryDirectory() as folder:
            found = outcome(case.started(wanted.start) if wanted.start else case, Path(folder))
        root = next(each for each in (TRIALS, ARMS, Path(written.name)) if case.file.is_relative_to(each))
        name = f"{case.file.relative_to(root)}{' --joint all' if 'joint all' in case.command else ''}"
        counted[found.verdict, found.commands] += 1
        print(
            f"{name:58} {found.commands:8d} {found.verdict:13} {time.process_time() - begun:5.1f}  {found.message[:300]}",
            flush=True,
        )
    read = {
        number: sum(
            count for (verdict, commands), count in counted.items() if verdict in ("right", "read") and commands == number
        )
        for number in (1, 2, 3)
    }
    total, wrong = sum(counted.values()), sum(count for (verdict, _), count in counted.items() if verdict == "WRONG")
    print(f"{total} recordings: {read[1]} at the first command, {read[2]} at the second, {read[3]} at the third, {wrong} WRONG")
    return int(wrong > 0 or read[1] < MIN_SHARE_OF_FIRST * total)


if __name__ == "__main__":
    raise SystemExit(main())
