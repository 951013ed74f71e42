"""Kernels that are asked for: by `sw.compile`, and by the command."""

from __future__ import annotations

from pathlib import Path

import pytest
import strainwave as sw
from strainwave import _core
from strainwave.native.compilers import NoCompilerError

from tests.python.command import strainwave


def test_the_jobs_asked_for_are_loaded_and_compared() -> None:
    drive = sw.load("two-inertia-gear")
    found = sw.compile(drive, ["simulate_adaptively"])
    (job,) = found.jobs
    assert job.job == "simulate_adaptively"
    assert job.seconds > 0.0
    assert job.times_faster > 0.0
    assert _core.loaded_jobs(drive) == ["simulate_adaptively"]
    assert found.drive in str(found)
    _core.forget_kernels(drive)


def test_what_is_no_job_is_refused_with_those_there_are() -> None:
    with pytest.raises(ValueError, match='jobs = "fly" must be one of simulate, simulate_adaptively'):
        sw.compile(sw.load("two-inertia-gear"), ["fly"])


@pytest.mark.usefixtures("empty_path")
def test_without_a_compiler_it_is_an_error_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("strainwave.native.compilers._zig", lambda: None)
    with pytest.raises(NoCompilerError, match="pip install"):
        sw.compile(sw.load("two-inertia-gear"), ["simulate"])


def test_the_command_prints_a_line_for_each_job(tmp_path: Path) -> None:
    result = strainwave("compile", "two-inertia-gear", "--job", "simulate_adaptively", folder=tmp_path)
    assert result.returncode == 0
    assert [line.split()[0] for line in result.stdout.splitlines()[1:]] == ["job", "simulate_adaptively"]
