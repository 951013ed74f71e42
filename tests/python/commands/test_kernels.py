"""The verb `doctor kernels`: the kernels of this machine, listed and removed."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest
from strainwave.native import folder
from strainwave.native.folder import Record

from tests.python.command import refused, strainwave


@pytest.fixture(autouse=True)
def kernels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("STRAINWAVE_KERNELS", str(tmp_path / "kernels"))
    return tmp_path / "kernels"


def filled(kernels: Path) -> None:
    kernels.mkdir(mode=0o700)
    for age, drive, job, size in ((2e5, "load Pendulum", "run", 20_000), (7300.0, "control \x1b[31mPID", "all", 1_000_000)):
        made = time.time() - age
        path = folder.write(kernels, job * 16, b"", Record(drive, job, "g++", 3.96, made, size, ""))
        os.utime(path, (made, made))


def test_kernels_are_listed_the_last_used_first(kernels: Path, tmp_path: Path) -> None:
    filled(kernels)
    result = strainwave("doctor", "kernels", folder=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.splitlines() == [
        "drive             job     size  compiled in   age",
        "control  [31mPID  all  1.00 MB  4.0 s by g++  2 h",
        "load Pendulum     run  0.02 MB  4.0 s by g++  2 d",
        "",
        f"2 kernels, 1.02 MB, in {kernels}",
    ]


def test_kernels_are_removed(kernels: Path, tmp_path: Path) -> None:
    filled(kernels)
    assert strainwave("doctor", "kernels", "--clear", folder=tmp_path).stdout == f"removed 2 kernels from {kernels}\n"
    assert not list(kernels.iterdir())
    assert strainwave("doctor", "kernels", folder=tmp_path).stdout == f"0 kernels, 0.00 MB, in {kernels}\n"


def test_without_a_cache_nothing_is_made(kernels: Path, tmp_path: Path) -> None:
    assert strainwave("doctor", "kernels", folder=tmp_path).stdout == f"0 kernels, 0.00 MB, in {kernels}\n"
    assert strainwave("doctor", "kernels", "--clear", folder=tmp_path).stdout == f"removed 0 kernels from {kernels}\n"
    assert not kernels.exists()


def test_kernels_that_are_switched_off_are_said_to_be(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("STRAINWAVE_KERNELS", "off")
    assert (
        strainwave("doctor", "kernels", folder=tmp_path).stdout
        == "no kernel is used: they are switched off by STRAINWAVE_KERNELS\n"
    )


def test_a_folder_that_cannot_be_trusted_is_refused(kernels: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    filled(kernels)
    kernels.chmod(0o777)
    for arguments in (["doctor", "kernels"], ["doctor", "kernels", "--clear"]):
        refused(tmp_path, arguments, f"other users may write to {kernels}")
    monkeypatch.setenv("STRAINWAVE_KERNELS", "kernels")
    refused(tmp_path, ["doctor", "kernels"], "must be off or an absolute path")
