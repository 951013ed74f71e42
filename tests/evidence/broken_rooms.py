"""The tests that see a fault in a room of the package: `python -m tests.evidence.broken_rooms`.

Each of some faults is put into a clone of the committed state, one at a time. The fast tier runs until the first test fails,
the tests of the room first. If none fails, so do the slow tests. Of each fault the table has the tier that sees it, and the
first test that fails.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = "python/strainwave"
NO_TESTS = 5  # exit code of pytest
TIERS = {"fast": "not slow", "slow": "slow"}  # marks that pytest selects


@dataclass(frozen=True)
class Fault:
    """A fault of one line.

    Args:
        room: the room of the package
        file: path from the root
        right: text in the file, once
        wrong: what replaces it
    """

    room: str
    file: str
    right: str
    wrong: str

    def put_into(self, root: Path) -> None:
        path = root / self.file
        text = path.read_text(encoding="utf-8")
        if text.count(self.right) != 1:
            raise ValueError(f"{self.file} contains {self.right!r} {text.count(self.right)} times: exactly 1 is needed")
        path.write_text(text.replace(self.right, self.wrong), encoding="utf-8")


FAULTS = (
    Fault(
        "physics",
        "include/strainwave/stiffness/cubic.hpp",
        "a1 + S(3.0) * a3 * twist * twist",
        "a1 + S(2.0) * a3 * twist * twist",
    ),
    Fault(
        "physics", "include/strainwave/hysteresis/maxwell_slip.hpp", "breakaway[i] * (path - sticking)", "breakaway[i] * path"
    ),
    Fault("files", f"{PACKAGE}/files/units.py", "* (size / size_to)", "* (size_to / size)"),
    Fault("analysis", f"{PACKAGE}/analysis/linear.py", "np.divide(-self.poles.real, size,", "np.divide(self.poles.real, size,"),
    Fault(
        "orders",
        f"{PACKAGE}/orders/order_spectrum.py",
        "amplitude=np.hypot(in_phase, across)",
        "amplitude=2.0 * np.hypot(in_phase, across)",
    ),
    Fault(
        "identification",
        f"{PACKAGE}/statistics/covariance.py",
        "total += (1.0 - lag / (lags + 1)) *",
        "total -= (1.0 - lag / (lags + 1)) *",
    ),
    Fault(
        "tuning",
        f"{PACKAGE}/tuning/loops.py",
        "modulus=float(np.abs(1.0 + loop).min())",
        "modulus=float(np.abs(1.0 - loop).min())",
    ),
    Fault(
        "diagnose",
        f"{PACKAGE}/diagnose/detection.py",
        "return min(1.0, tests * float(single))",
        "return min(1.0, float(single))",
    ),
    Fault(
        "dataset",
        f"{PACKAGE}/dataset/sampling.py",
        "np.where(by_unit == by_condition, by_unit, MIXED_SPLIT)",
        "np.where(by_unit == by_condition, by_unit, by_condition)",
    ),
    Fault("export", f"{PACKAGE}/export/mujoco.py", "coef=repr(1.0 / elements.ratio)", "coef=repr(-1.0 / elements.ratio)"),
    Fault(
        "rig",
        f"{PACKAGE}/rig/analysis/lost_motion.py",
        "result(0.5 * (low.value + high.value)",
        "result(1.0 * (low.value + high.value)",
    ),
    Fault(
        "native", f"{PACKAGE}/native/kernel.py", "_digest(self.source, headers_digest(), *flags", "_digest(self.source, *flags"
    ),
    Fault("commands", f"{PACKAGE}/exit_codes.py", "RESULT_CONTRADICTED = 3", "RESULT_CONTRADICTED = 0"),
)


def main(arguments: list[str]) -> int:
    """Print the table; return 1 if a fault is not seen by any test."""
    options = argparse.ArgumentParser(prog="python -m tests.evidence.broken_rooms", description=__doc__)
    options.add_argument("--room", action="append", help="faults of this room only; may be repeated")
    rooms = options.parse_args(arguments).room
    unseen = 0
    with tempfile.TemporaryDirectory() as folder:
        clone = Path(folder, "clone")
        subprocess.run(["git", "clone", "--quiet", ROOT, clone], check=True)
        for fault in FAULTS:
            if rooms is None or fault.room in rooms:
                tier, test = first_failure(fault, clone)
                unseen += not tier
                print(f"{fault.room:16}{tier or 'not seen':10}{test or fault.file}", flush=True)
    return int(unseen > 0)


def first_failure(fault: Fault, clone: Path) -> tuple[str, str]:
    """Return the tier and the name of the first test that fails with a fault; empty texts if none does."""
    fault.put_into(clone)
    try:
        for tier, marks in TIERS.items():
            for folders in (nearest_tests(fault, clone), []):  # then all
                command = (sys.executable, "dev.py", "test", "-x", "-q", "-rfE", "-m", marks, *folders)
                done = subprocess.run(command, cwd=clone, capture_output=True, text=True, check=False)
                if failed := re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE):
                    return tier, failed[1]
                if done.returncode not in (0, NO_TESTS):
                    raise RuntimeError(done.stdout[-2000:] + done.stderr[-2000:])
    finally:
        subprocess.run(["git", "checkout", "--quiet", "."], cwd=clone, check=True)
    return "", ""


def nearest_tests(fault: Fault, clone: Path) -> list[str]:
    """Return the folder of tests that mirrors the folder of a fault, which most likely sees it."""
    mirrors = (f"tests/python/{fault.room}", f"tests/{Path(fault.file).parent.name}")
    return [folder for folder in mirrors if (clone / folder).is_dir()][:1]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
