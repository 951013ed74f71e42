"""The processor times that a build and a run of the tests leave behind, and what `dev.py times` prints of them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import dev

ROOT = Path(dev.__file__).parent
BURN = "import time\nwhile time.process_time() < 0.1: pass"
TESTS = f"""
import pytest

def test_idle(): pass

@pytest.mark.parametrize("n", [1])
def test_busy(n):
    import subprocess, sys
    subprocess.run([sys.executable, "-c", {BURN!r}], check=True)
"""


def launched(times: Path, *command: str) -> int:
    return subprocess.run([sys.executable, ROOT / ".ci" / "timed.py", times, *command]).returncode


def test_the_launcher_of_the_compiler_adds_what_a_compilation_takes(tmp_path: Path) -> None:
    times = tmp_path / "times.txt"
    for name in ("a.o", "b c.o"):
        assert launched(times, sys.executable, "-c", BURN, "-o", name) == 0
    found = dev.read_times(times)
    assert list(found) == ["a.o", "b c.o"]
    assert min(found.values()) > 0.05


@pytest.mark.parametrize(("code", "status"), [("exit(3)", 3), ("import os; os.kill(os.getpid(), 9)", 137)])
def test_a_compilation_that_fails_keeps_its_status_and_leaves_no_time(code: str, status: int, tmp_path: Path) -> None:
    assert launched(tmp_path / "times.txt", sys.executable, "-c", code, "-o", "a.o") == status
    assert not (tmp_path / "times.txt").exists()


def test_times_of_objects_and_tests_are_printed_slowest_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An object that was compiled again counts once, and one that the build no longer makes not at all."""
    build = tmp_path / "cp311"
    build.mkdir()
    (build / "build.ninja").write_text("build a.cpp.o: CXX a.cpp\nbuild b.cpp.o: CXX b.cpp\n")
    (build / "times.txt").write_text("9.00\ta.cpp.o\n7.00\told.cpp.o\n4.00\tb.cpp.o\n1.50\ta.cpp.o\n")
    (tmp_path / "test-times.txt").write_text("1.00\tx.py::one\n2.00\ty.py::two[a::b]\n1.50\tx.py::three\n")
    monkeypatch.setattr(dev, "BUILD", tmp_path)
    monkeypatch.setattr(dev, "TEST_TIMES", tmp_path / "test-times.txt")
    monkeypatch.setattr(dev, "MAX_SLOWEST", 2)
    assert dev.main(["times"]) == 0
    assert [line.split(None, 2)[::2] for line in capsys.readouterr().out.splitlines()] == [
        ["5.5", "all 2 objects of cp311"],
        ["4.0", "b.cpp.o"],
        ["1.5", "a.cpp.o"],
        ["4.5", "all 3 tests"],
        ["2.0", "y.py::two[a::b]"],
        ["1.5", "x.py::three"],
        ["4.5", "all 2 files of tests"],
        ["2.5", "x.py"],
        ["2.0", "y.py"],
    ]


@pytest.mark.parametrize("processes", ["0", "1"])
def test_a_run_of_the_tests_writes_the_time_of_each_with_its_processes(processes: str, tmp_path: Path) -> None:
    (tmp_path / "test_some.py").write_text(TESTS)
    command = (sys.executable, "-m", "pytest", "-q", "-p", "tests.conftest", "-n", processes, "--rootdir", tmp_path, tmp_path)
    subprocess.run(command, env={**os.environ, "STRAINWAVE_TEST_TIMES": str(tmp_path / "times")}, cwd=ROOT, check=True)
    found = dev.read_times(tmp_path / "times")
    assert list(found) == ["test_some.py::test_idle", "test_some.py::test_busy[1]"]
    assert found["test_some.py::test_busy[1]"] > 0.05
