"""The verb `doctor`: what is installed, what is missing for what, and the kernels of this machine."""

from __future__ import annotations

import os
import shutil
import stat
import subprocess
import sys
import time
from importlib import metadata
from pathlib import Path

import pytest
import strainwave as sw
from strainwave import _core
from strainwave.commands import doctor
from strainwave.native import compilers, folder
from strainwave.native.folder import Record

from tests.python.command import refused, strainwave

EXTRAS = metadata.metadata("strainwave").get_all("Provides-Extra") or []
HEAVY = {
    "numpy",
    "scipy",
    "matplotlib",
    "pyarrow",
    "pydantic",
    "h5py",
    "fmpy",
    "mujoco",
    "warp",
    "cuda",
    "sklearn",
    "distributed",
}


@pytest.fixture(autouse=True)
def kernels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("STRAINWAVE_KERNELS", str(tmp_path / "kernels"))
    return tmp_path / "kernels"


def answer(folder: Path) -> dict[str, str]:
    """Return the lines that the verb prints by their first words, and the last two by those before the colon."""
    result = strainwave("doctor", folder=folder)
    assert (result.returncode, result.stderr) == (0, "")
    lines = result.stdout.splitlines()
    found = {line[: doctor.LABEL_WIDTH].strip(): line[doctor.LABEL_WIDTH :] for line in lines[1:-2]}
    return {"first": lines[0], **found, **dict(line.split(": ", 1) for line in lines[-2:])}


def with_version(monkeypatch: pytest.MonkeyPatch, package: str, version: str | None) -> None:
    """Let a package be installed in a version, or not at all."""
    real = metadata.version

    def found(name: str) -> str:
        if name != package:
            return real(name)
        if version is None:
            raise metadata.PackageNotFoundError(name)
        return version

    monkeypatch.setattr(metadata, "version", found)


def test_it_shows_package_core_and_kernels(tmp_path: Path, kernels: Path) -> None:
    found = answer(tmp_path)
    assert found["first"].startswith(f"strainwave {metadata.version('strainwave')}, Python {sys.version.split()[0]}, ")
    assert found["package"] == str(Path(sw.__file__).parent)
    assert found["core"] == f"loads; instruction set {_core.instruction_set()}"
    assert found["cached kernels"] == f"0, 0.0 MB, in {kernels}"
    assert found["works"].startswith("simulation, identification, reports")


def test_it_shows_each_extra_of_the_package_with_its_use(tmp_path: Path) -> None:
    assert set(doctor.PURPOSES) == set(EXTRAS)
    found = answer(tmp_path)
    for extra in EXTRAS:
        assert found[extra].startswith(f"{doctor.PURPOSES[extra]}: "), extra
        assert (doctor.PURPOSES[extra] in found["works"]) != (doctor.PURPOSES[extra] in found["does not work"]), extra


def test_a_package_that_is_missing_is_named_with_the_command_that_installs_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_version(monkeypatch, "fmpy", "99")
    found = answer(tmp_path)
    assert found["fmu"] == "export of FMUs: installed"
    assert "export of FMUs" in found["works"]
    with_version(monkeypatch, "fmpy", None)
    found = answer(tmp_path)
    assert found["fmu"] == "export of FMUs: missing fmpy: pip install 'strainwave[fmu]'"
    assert "export of FMUs" in found["does not work"]


def test_a_package_that_is_too_old_is_named_with_both_versions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with_version(monkeypatch, "h5py", "2.9")
    assert "missing h5py >=3.10 (2.9 is installed): pip install" in answer(tmp_path)["formats"]


def test_without_a_package_that_is_always_needed_nothing_works(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with_version(monkeypatch, "pyarrow", None)
    found = answer(tmp_path)
    assert found["works"] == "nothing"
    assert found["does not work"].startswith("simulation")


def test_without_a_compiler_kernels_do_not_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setattr(compilers, "zig_program", lambda: None)
    found = answer(tmp_path)
    assert found["C++ compiler"].startswith("none: ")
    assert "kernels of any drive" in found["does not work"]


def test_kernels_that_are_not_used_are_shown_with_the_reason(
    tmp_path: Path, kernels: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kernels.mkdir()
    kernels.chmod(0o777)
    assert answer(tmp_path)["cached kernels"].startswith(f"not used: other users may write to {kernels}")
    monkeypatch.setenv("STRAINWAVE_KERNELS", "off")
    assert answer(tmp_path)["cached kernels"] == "not used: they are switched off by STRAINWAVE_KERNELS"
    assert stat.S_IMODE(kernels.stat().st_mode) == 0o777


@pytest.mark.slow("commands")
def test_it_imports_nothing_that_takes_long() -> None:
    """Typer itself imports pydantic where it reads a command line, from 0.29 on: here only the verb runs."""
    shown = "from strainwave.commands.doctor import check; check(SimpleNamespace(invoked_subcommand=None))"
    code = f"import sys; from types import SimpleNamespace; {shown}; print({HEAVY} & sys.modules.keys())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "set()"


def test_a_core_that_does_not_load_ends_with_exit_code_1_and_what_to_do(tmp_path: Path) -> None:
    package = tmp_path / "strainwave"
    package.mkdir()
    for name in ("__init__.py", "__main__.py"):
        shutil.copy(Path(sw.__file__).with_name(name), package)
    command = [sys.executable, "-S", "-m", "strainwave", "doctor"]  # without an editable package
    done = subprocess.run(command, env={"PYTHONPATH": str(tmp_path)}, capture_output=True, text=True)
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith("ImportError: the compiled core of strainwave does not load: ")
    assert "python3 dev.py demo" in last


# ---- Kernels ---------------------------------------------------------------------------------------------------------


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
