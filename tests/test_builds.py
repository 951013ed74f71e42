"""Builds of one clone beside each other: the editable one that `dev.py` keeps, and those of any other tool."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import dev

pytestmark = pytest.mark.slow("build")

ROOT = Path(dev.__file__).parent
TOOLS = ("cmake", "ninja", "nanobind", "scikit_build_core", "packaging", "pathspec")
BUILD_WHEEL = "from scikit_build_core.build import build_wheel; build_wheel('dist', {})"
IN_THE_SAME_FOLDER = {"build-dir": "build/{wheel_tag}"}
# Copies the objects that this clone has compiled, from the same sources.
COMPILER = """#!/bin/sh
for word; do [ "$last" = -o ] && object=$word; last=$word; done
[ -f "{objects}/$object" ] && case $object in CMakeFiles/*) exec cp "{objects}/$object" "$object"; esac
exec c++ "$@"
"""


class Clone:
    """A copy of the sources, a .venv with what this environment has, and a compiler that takes no time."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "clone"
        generated = "[!_]*.pyi", "_core.pyi"
        apart = shutil.ignore_patterns(
            ".git", ".venv", "build", "out", "dist", "docs", "tests", *generated, "__pycache__", ".*_cache"
        )
        shutil.copytree(ROOT, self.root, ignore=apart)
        self.packages = make_environment(self.root / ".venv")
        (self.packages / "others.pth").write_text(str(ROOT / self.packages.relative_to(self.root)))
        objects = next(ROOT.glob("build/cp*/CMakeCache.txt")).parent
        compiler = folder / "c++"
        compiler.write_text(COMPILER.format(objects=objects))
        compiler.chmod(0o755)
        self.variables = {**os.environ, "CXX": str(compiler), "PATH": f"{self.root / '.venv' / 'bin'}:{os.environ['PATH']}"}

    def run(self, *command: str | Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, cwd=self.root, env=self.variables, capture_output=True, text=True)

    def build_by_other_tools(self, settings: dict[str, str]) -> None:
        """Builds a wheel with tools that are gone afterwards, as pip does."""
        other = self.root.parent / "other"
        make_environment(other)
        done = self.run(other / "bin" / "python", "-c", BUILD_WHEEL.format(settings))
        assert done.returncode == 0, done.stderr
        shutil.rmtree(other)

    def imported(self) -> subprocess.CompletedProcess[str]:
        return self.run(self.root / ".venv" / "bin" / "python", "-c", "import strainwave")


def make_environment(folder: Path) -> Path:
    """Makes an environment with the tools of the build; returns where its packages are."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    (packages,) = folder.glob("lib/python*/site-packages")
    mine = next((ROOT / ".venv").glob("lib/python*/site-packages"))
    for name in TOOLS:
        for source in (mine / name, *mine.glob(f"{name}-*.dist-info")):
            shutil.copytree(source, packages / source.name, copy_function=os.link)
    for name in ("cmake", "ninja"):
        program = (ROOT / ".venv" / "bin" / name).read_bytes()
        (folder / "bin" / name).write_bytes(program.replace(bytes(ROOT / ".venv"), bytes(folder)))
        (folder / "bin" / name).chmod(0o755)
    return packages


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Clone:
    """A clone in which `dev.py` has installed the package, without its dependencies, which are there."""
    clone = Clone(tmp_path)
    for name in ("ROOT", "BUILD", "STAMPS", "BIN", "PYTHON"):
        monkeypatch.setattr(dev, name, clone.root / getattr(dev, name).relative_to(ROOT))
    uv = str(dev.uv())
    monkeypatch.setattr(
        dev, "install_tools", lambda: (uv, "pip", "install", "--quiet", "--offline", "--no-deps", "--python", dev.PYTHON)
    )
    for name in ("CXX", "PATH"):
        monkeypatch.setenv(name, clone.variables[name])
    dev.prepare()
    return clone


def test_a_wheel_built_by_other_tools_leaves_the_editable_build_as_it_is(clone: Clone) -> None:
    clone.build_by_other_tools({})
    assert clone.imported().returncode == 0
    assert len(list((clone.root / "dist").glob("*.whl"))) == 1


def test_a_build_whose_tools_are_gone_is_named_by_an_import_and_mended_by_dev(
    clone: Clone, capfd: pytest.CaptureFixture[str]
) -> None:
    clone.build_by_other_tools(IN_THE_SAME_FOLDER)
    failed = clone.imported()
    assert failed.returncode == 1
    assert failed.stderr.splitlines()[-1].startswith("ImportError: the compiled core of strainwave does not load: Command")
    assert "python3 dev.py demo" in failed.stderr
    dev.prepare()
    said = [line for line in capfd.readouterr().out.splitlines() if "removing" in line]
    assert len(said) == 1
    assert said[0].startswith("dev.py: removing build/cp")
    assert clone.imported().returncode == 0


def test_an_editable_package_without_the_tools_of_its_build_says_how_to_get_them(clone: Clone) -> None:
    clone.variables["PATH"] = os.devnull
    failed = clone.imported()
    assert failed.returncode == 1
    last = failed.stderr.splitlines()[-1]
    assert "'cmake'" in last
    assert "source .venv/bin/activate" in last
