"""A few of the cases of tests/fuzz, which throws them by the thousand; and that what breaks a law is told."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw

from tests.fuzz.kinds import KINDS, drawn, kind_of
from tests.fuzz.laws import Case, judged
from tests.fuzz.run import Task, outcomes
from tests.support.workers import CRASHES, HANGS, answers

FEW = {
    "csv": 40,
    "toml": 60,
    "scenarios": 60,
    "names": 40,
    "parquet": 60,
    "recognised": 60,
    "pairs": 60,
    "formats": 30,
    "units": 60,
    "drives": 40,
    "claims": 20,
    "images": 60,
    "mappings": 40,
    "rigs": 40,
    "datasheets": 60,
}
SLOW = "takes long"  # a fault of the machine's load as well: left to whoever runs the thousands


WERE_WRONG = [Task("rigs", 32849), Task("rigs", 44674)]  # a secant and a line over angles of rounding divided by zero


def raises(error: Exception) -> Callable[[], None]:
    def attempt() -> None:
        raise error

    return attempt


def warns(category: type[Warning], message: str) -> Callable[[], None]:
    return lambda: warnings.warn(message, category, stacklevel=1)


def fails(result: object) -> None:
    assert result == "right", "another result: wrong"


def test_a_few_cases_of_each_kind_break_no_law() -> None:
    tasks = [Task(kind, number) for kind, count in FEW.items() for number in range(count)] + WERE_WRONG
    found = dict(outcomes(tasks, processes=1))
    assert found.keys() == set(tasks)
    assert {
        task: outcome.words for task, outcome in found.items() if outcome.verdict == "wrong" and outcome.fault != SLOW
    } == {}
    assert {outcome.verdict for outcome in found.values()} >= {"accepted", "refused"}


@pytest.mark.slow("physics")
def test_every_kind_is_thrown_and_a_case_is_the_same_each_time(tmp_path: Path) -> None:
    assert {kind_of(number) for number in range(1000)} == KINDS.keys()
    for kind in KINDS:
        words = []
        for turn in ("turn-1", "turn-2"):
            folder = tmp_path / kind / turn
            folder.mkdir(parents=True)
            with warnings.catch_warnings(action="ignore"):
                words.append(drawn(kind, 5, folder).what.replace(turn, ""))
        assert words[0] == words[1]


@pytest.mark.parametrize(
    ("attempt", "fault"),
    [
        (raises(KeyError("x")), "KeyError, which is not documented"),
        (raises(ZeroDivisionError("float division by zero")), "ZeroDivisionError, which is not documented"),
        (raises(np.linalg.LinAlgError("no")), "LinAlgError, which is not documented"),
        (raises(ValueError("")), "no message"),
        (raises(ValueError("one line\nand another")), "more than one line, or control characters"),
        (raises(TypeError("\x1b[31mred")), "more than one line, or control characters"),
        (raises(ValueError("a" * 1001)), "a message of more than 1000 characters"),
        (raises(MemoryError("std::bad_alloc")), "a library's words"),
        (raises(TypeError("unhashable type: 'list'")), "a library's words"),
        (raises(OSError(2, "No such\nfile")), "more than one line, or control characters"),
    ],
)
def test_an_error_that_nobody_can_read_is_wrong(attempt: Callable[[], None], fault: str) -> None:
    found = judged(Case("", attempt), slowest=10.0)
    assert (found.verdict, found.fault) == ("wrong", f"{fault}, from compiled code")


def test_what_is_wrong_in_the_package_is_told_with_its_function() -> None:
    found = judged(Case("", lambda: sw.Recording({"a": [1.0]}, {"a": "1"})[["a"]]), slowest=10.0)
    assert found.fault in ("", "a library's words, from recording.py Recording.__getitem__")
    found = judged(Case("", lambda: sw.scenario.step(1.0, "\n" * 3)), slowest=10.0)  # type: ignore[arg-type]
    assert (found.verdict, found.fault) == ("refused", "")


@pytest.mark.parametrize(
    ("category", "message", "fault"),
    [
        (DeprecationWarning, "old", "DeprecationWarning, which is not documented, in a warning from"),
        (RuntimeWarning, "overflow encountered in multiply", "a library's words, in a warning from"),
        (RuntimeWarning, "the drive has bristles\n", "more than one line, or control characters, in a warning from"),
        (RuntimeWarning, "the drive has bristles", ""),
        (sw.simulation.EnsembleWarning, "1 of 2 members have no result", ""),
    ],
)
def test_a_warning_that_is_not_documented_is_wrong(category: type[Warning], message: str, fault: str) -> None:
    found = judged(Case("", warns(category, message)), slowest=10.0)
    assert found.verdict == ("wrong" if fault else "accepted")
    assert found.fault.startswith(fault)
    assert found.fault or not fault


def test_results_that_break_a_law_are_wrong_and_errors_that_are_documented_are_not() -> None:
    assert judged(Case("", lambda: "right", fails), 10.0).verdict == "accepted"
    assert judged(Case("", lambda: "left", fails), 10.0).fault == "another result"
    assert judged(Case("", lambda: 1, lambda result: raises(ValueError("x"))()), 10.0).fault.startswith(
        "what was accepted fails"
    )
    for error in (ValueError("x = 1 must be 2"), TypeError("x"), OSError(2, "none", "a\nb"), FloatingPointError("x")):
        assert judged(Case("", raises(error)), 10.0).verdict == "refused"


def test_a_case_that_takes_long_is_wrong() -> None:
    assert judged(Case("", lambda: sum(range(100_000))), slowest=1e-9).fault == SLOW


LOUD = """
import os, sys
from pathlib import Path
from tests.fuzz import kinds, laws, run

loud = laws.Case("", lambda: os.write(2, b" ** On entry to DLASCL"))
kinds.KINDS["loud"] = kinds.Kind(lambda random, folder: loud, 1, 10.0)
found = run.in_process(Path(sys.argv[1]), run.Task("loud", 0))
Path(sys.argv[1], "said").write_text(f"{found.verdict}: {found.fault}: {found.words}")
"""


@pytest.mark.slow("physics")
def test_what_a_library_writes_to_the_terminal_is_seen(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-c", LOUD, str(tmp_path)], check=True, timeout=60.0)
    assert (tmp_path / "said").read_text() == "wrong: speaks on the terminal:  ** On entry to DLASCL"


@pytest.mark.slow("physics")
def test_a_task_that_ends_its_process_or_does_not_end_is_named_and_the_next_is_done() -> None:
    assert list(answers(signal.raise_signal, [signal.SIGSEGV, signal.SIGABRT], processes=1, limit=30.0)) == [
        (signal.SIGSEGV, CRASHES),
        (signal.SIGABRT, CRASHES),
    ]
    assert list(answers(time.sleep, [60.0, 60.5], processes=1, limit=0.2)) == [(60.0, HANGS), (60.5, HANGS)]
    assert list(answers(abs, [-1, -2], processes=1, limit=30.0)) == [(-1, 1), (-2, 2)]
