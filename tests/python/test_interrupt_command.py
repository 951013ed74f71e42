"""Ctrl-C ends the command at any time, also while packages that swallow it are imported, and leaves nothing half written."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import time
from math import inf
from pathlib import Path

import pytest

from tests.support.samples import sample

TUTORIALS = Path(__file__).parents[2] / "examples" / "tutorials"
MOVE = 'duration = 0.2\n[command]\nkind = "ramp"\nrate = 0.5\n'
VERBS = {
    "identify": f"identify hfuc-20-80 {TUTORIALS / 'robot_log.csv'} --constant torque_constant=0.0755",
    "simulate": "simulate robot-joint --scenario move.toml --out run.parquet --plot run.svg",
    "demo": "demo",
    "dataset": f"dataset make {TUTORIALS / '09_fault_data_plan.toml'} --out faults --workers 1",
}
PRESSES = sample(3, 6)
PYTHON_SECONDS = 0.5  # in which Python starts
ENDED = "it had ended by itself"
PART_OF_RUN = 0.4  # in which Ctrl-C is pressed: on a machine that other work shares a run may take less than the one before


def run(verb: str, folder: Path, press_after: float = inf) -> tuple[int, str, float]:
    """Return exit code, errors and duration [s] of the command, in which Ctrl-C is pressed once if it takes that long [s]."""
    folder.mkdir()
    (folder / "move.toml").write_text(MOVE)
    begin = time.monotonic()
    command = [sys.executable, "-m", "strainwave", *VERBS[verb].split()]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        if press_after < inf:
            time.sleep(press_after)
            if process.poll() is not None:
                return process.returncode, ENDED, press_after
            process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=300.0)
    return process.returncode, errors.decode(), time.monotonic() - begin


@pytest.mark.slow("commands")
@pytest.mark.parametrize("verb", VERBS)
def test_ctrl_c_at_any_time_ends_a_verb(verb: str, tmp_path: Path) -> None:
    code, errors, duration = run(verb, tmp_path / "whole")
    assert code == 0, errors
    draw, ended = random.Random(verb), 0
    for number in range(PRESSES):
        folder, moment = tmp_path / f"{number}", draw.uniform(PYTHON_SECONDS, PART_OF_RUN * duration)
        code, errors, _ = run(verb, folder, moment)
        if errors == ENDED:
            ended += 1
            continue
        # Before the command has begun Python itself ends, by the signal: for a shell that is 130, too.
        assert code in (130, -signal.SIGINT), f"after {moment:.2f} of {duration:.2f} s: {code}, {errors}"
        assert code < 0 or errors.splitlines()[-1].startswith("strainwave: interrupted; ")
        assert not list(folder.rglob(".strainwave-*")), "no draft is left"
        if "nothing written" in errors and verb != "dataset":  # whole shards stay: the same command goes on with them
            assert [path.name for path in folder.rglob("*") if path.is_file()] == ["move.toml"]
    assert ended < PRESSES / 2
