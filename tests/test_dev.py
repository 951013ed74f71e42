"""The processor times that a build and a run of the tests leave behind, and what `dev.py times` prints of them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import dev
from tests.conftest import ROOMS

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
    (tmp_path / "test-times.txt").write_text(
        "1.00\ttests/python/orders/x.py::one\n2.00\ttests/python/orders/two/y.py::two[a::b]\n1.50\ttests/python/orders/x.py::three\n"
    )
    monkeypatch.setattr(dev, "BUILD", tmp_path)
    monkeypatch.setattr(dev, "TEST_TIMES", tmp_path / "test-times.txt")
    monkeypatch.setattr(dev, "MAX_SLOWEST", 2)
    assert dev.main(["times"]) == 0
    assert [line.split(None, 2)[::2] for line in capsys.readouterr().out.splitlines()] == [
        ["5.5", "all 2 objects of cp311"],
        ["4.0", "b.cpp.o"],
        ["1.5", "a.cpp.o"],
        ["4.5", "all 3 tests"],
        ["2.0", "tests/python/orders/two/y.py::two[a::b]"],
        ["1.5", "tests/python/orders/x.py::three"],
        ["4.5", "all 2 files of tests"],
        ["2.5", "tests/python/orders/x.py"],
        ["2.0", "tests/python/orders/two/y.py"],
        ["4.5", "all 1 rooms of tests"],
        ["4.5", "tests/python/orders"],
    ]


def run_tests(folder: Path, text: str, *options: str) -> subprocess.CompletedProcess[str]:
    """Run pytest on a file of tests with what holds for all tests of this repository."""
    (folder / "test_some.py").write_text(text)
    command = (sys.executable, "-m", "pytest", "-q", "-p", "tests.conftest", *options, "--rootdir", folder, folder)
    environment = {**os.environ, "STRAINWAVE_TEST_TIMES": str(folder / "times")}
    return subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.slow("build")
@pytest.mark.parametrize("processes", ["0", "1"])
def test_a_run_of_the_tests_writes_the_time_of_each_with_its_processes(processes: str, tmp_path: Path) -> None:
    assert run_tests(tmp_path, TESTS, "-n", processes).returncode == 0
    found = dev.read_times(tmp_path / "times")
    assert list(found) == ["test_some.py::test_idle", "test_some.py::test_busy[1]"]
    assert found["test_some.py::test_busy[1]"] > 0.05


TIERS = """
import time
from functools import cache

import pytest
from tests import conftest

conftest.MAX_FAST_SECONDS = 0.05

def burn():
    begin = time.process_time()
    while time.process_time() < begin + 0.4: pass

@pytest.fixture(scope="module")
def costly(): burn()

once = cache(burn)

def test_fast(): pass

def test_fast_from_its_second_run_on(): once()

def test_too_long(): burn()

def test_fixture_takes_too_long(costly): pass

def test_same_fixture(costly): pass

@pytest.mark.slow("orders")
def test_slow(): burn()

@pytest.mark.whole_path("orders")
def test_whole_path(): burn()
"""


@pytest.mark.slow("build")
def test_a_test_fails_if_it_takes_too_long_without_a_mark(tmp_path: Path) -> None:
    """What only the first run of a process does counts for none; a fixture counts for each test that needs it."""
    done = run_tests(tmp_path, TIERS, "-rfp")
    assert re.findall(r"^(PASSED|FAILED) \S*test_some.py::test_(\w+)", done.stdout, re.MULTILINE) == [
        ("FAILED", "too_long"),
        ("FAILED", "fixture_takes_too_long"),
        ("PASSED", "fast"),
        ("PASSED", "fast_from_its_second_run_on"),
        ("PASSED", "same_fixture"),  # the one before it was charged
        ("PASSED", "slow"),
        ("PASSED", "whole_path"),
    ]
    assert "s of the processor twice, more than 0.05 s times" in done.stdout


@pytest.mark.slow("build")
def test_a_mark_names_a_room(tmp_path: Path) -> None:
    done = run_tests(tmp_path, 'import pytest\n@pytest.mark.slow("cellar")\ndef test_some(): pass\n')
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert "slow('cellar',) must name one of the rooms physics, native" in done.stderr


def test_every_room_has_a_whole_path_in_the_fast_tier() -> None:
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py")]
    marked = {room for text in texts for room in re.findall(r'mark\.whole_path\("(\w+)"\)', text)}
    assert sorted(marked) == sorted(ROOMS)
