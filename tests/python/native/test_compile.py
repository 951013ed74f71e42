"""Kernels that are asked for: by `sw.compile`, and by the command."""

from __future__ import annotations

from pathlib import Path

import pytest
import strainwave as sw
from strainwave import _core
from strainwave.native import kernels
from strainwave.native.compilers import NoCompilerError

from tests.python.command import strainwave


@pytest.mark.whole_path("native")
def test_the_jobs_asked_for_are_loaded_and_compared() -> None:
    drive = sw.load("two-inertia-gear")
    found = sw.compile(drive, ["simulate_adaptively"])
    (job,) = found.jobs
    assert job.job == "simulate_adaptively"
    assert job.seconds > 0.0
    assert job.times_faster > 0.0
    assert _core.loaded_jobs(drive) == ["simulate_adaptively"]
    assert found.drive in str(found)
    sw.compile(drive, [])
    assert _core.loaded_jobs(drive) == ["simulate_adaptively"]  # of jobs not asked for, kernels stay
    _core.forget_kernels(drive)


@pytest.fixture
def loaded(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Jobs whose kernels are asked for; none is compiled."""
    jobs: list[str] = []
    monkeypatch.setattr(kernels, "load_or_raise", lambda drive, job: jobs.append(job))
    return jobs


def test_a_drive_that_cannot_run_from_rest_can_be_compiled(loaded: list[str]) -> None:
    away = sw.friction.PositionDependent(constant=0.1, domain_start=1.0, domain_end=2.0)
    drive = sw.Drive(gear=sw.Gear(friction_output=away), load=sw.loads.Inertia(inertia=0.01))
    with pytest.raises(ValueError, match="lies outside"):
        sw.simulate(drive, sw.scenario.step(1.0, 0.01))
    assert len(sw.compile(drive).jobs) == len(loaded) == len(kernels.PUBLIC_JOBS)


def test_jobs_may_be_any_sequence_of_names(loaded: list[str]) -> None:
    sw.compile(sw.load("two-inertia-gear"), (job for job in ["simulate_many", "simulate", "simulate"]))  # type: ignore[arg-type]
    assert loaded == ["simulate", "simulate_many"]
    for wrong in ("simulate", 5, None, [5]):
        with pytest.raises(TypeError, match="jobs must be a list of names, not"):
            sw.compile(sw.load("two-inertia-gear"), wrong)  # type: ignore[arg-type]


def test_what_is_no_job_is_refused_with_those_there_are() -> None:
    with pytest.raises(ValueError, match='jobs = "fly" must be one of simulate, simulate_adaptively'):
        sw.compile(sw.load("two-inertia-gear"), ["fly"])


@pytest.mark.usefixtures("empty_path")
def test_without_a_compiler_it_is_an_error_with_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("strainwave.native.compilers.zig_program", lambda: None)
    with pytest.raises(NoCompilerError, match="pip install"):
        sw.compile(sw.load("two-inertia-gear"), ["simulate"])


@pytest.mark.slow("native")
def test_the_command_prints_a_line_for_each_job(tmp_path: Path) -> None:
    result = strainwave("doctor", "compile", "two-inertia-gear", "--job", "simulate_adaptively", folder=tmp_path)
    assert result.returncode == 0
    assert [line.split()[0] for line in result.stdout.splitlines()[1:]] == ["simulate_adaptively"]
