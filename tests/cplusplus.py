"""The headers as other programs meet them: compilers, and drives of static type that hold every model between them."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from itertools import cycle, islice
from pathlib import Path

import pytest
from strainwave import _core

ROOT = Path(__file__).parents[1]
INCLUDE = ROOT / "include"
HEADERS = "#include <strainwave/drive.hpp>\n#include <strainwave/integrate.hpp>\n#include <strainwave/models.hpp>\n"
# A pack is passed in a register or in memory as the machine has it; no ABI of ours crosses a library border.
STRICT = ("-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wno-psabi", f"-I{INCLUDE}")

ZIG = (sys.executable, "-m", "ziglang", "c++")

# Python may not call a module as it calls the function `load`.
NAMESPACE = {"loads": "load", "kinematic_noise": "kinematic_error"}
FRICTION = ("friction", "friction", "friction")
GEAR = (
    *("kinematics", "kinematic_error", "kinematic_noise", "stiffness", "hysteresis", *FRICTION, "softening"),
    *("structure", "variation"),
)
DRIVE = ("control", "motor", "loads", "sensor", "thermal", "meter")


def compiler(name: str) -> tuple[str, ...]:
    """The command of a compiler; for clang++ the one that the package ziglang brings will do. Skips where there is none."""
    if shutil.which(name):
        return (name,)
    if name == "clang++":
        return zig()
    pytest.skip(f"{name} is not installed")


def zig() -> tuple[str, ...]:
    """Clang as the package ziglang brings it, with libraries for many targets."""
    if find_spec("ziglang") is None:
        pytest.skip("the package ziglang is not installed")
    return ZIG


def checker(name: str) -> tuple[str, ...]:
    """The command that goes through sources, templates and all, with warnings as errors, and writes no code: most of the time.

    `zig c++` always writes code; the clang within it, called by itself, need not, and takes the standard library of g++.
    """
    command = compiler(name)
    if command == ZIG:
        (folder,) = find_spec("ziglang").submodule_search_locations  # type: ignore[union-attr]
        command = (f"{folder}/zig", "clang", "--driver-mode=g++", "-resource-dir", f"{folder}/lib")
    return (*command, *STRICT, "-fsyntax-only", "-Wno-unused-command-line-argument")  # which -c is


def compilation(command: tuple[str, ...], folder: Path, sources: dict[str, str], *options: str) -> tuple[int, str]:
    """Compiles sources, by name, to objects in a folder: the exit status and what the compiler said."""
    for name, text in sources.items():
        (folder / name).write_text(text)
    result = subprocess.run([*command, "-c", *sources, *options], cwd=folder, capture_output=True, text=True, check=False)
    return result.returncode, result.stderr


def listed(family: str, scalar: str) -> Iterator[str]:
    """The models of a family, round and round."""
    space = f"strainwave::{NAMESPACE.get(family, family)}"
    return cycle(f"{space}::{model.__name__}<{scalar}>" for model in _core.families[family].values())


def drives(scalar: str) -> list[str]:
    """As many drives as the longest list has models; shorter lists go round, friction is one ahead from place to place."""
    count = max(map(len, _core.families.values()))
    ahead = [GEAR[:i].count("friction") for i in range(len(GEAR))]
    gear = [islice(listed(family, scalar), start, None) for family, start in zip(GEAR, ahead, strict=True)]
    control, motor, load, sensor, thermal, meter = (listed(family, scalar) for family in DRIVE)
    return [
        f"strainwave::Drive<{scalar}, {next(control)}, {next(motor)}, "
        f"strainwave::Gear<{scalar}, {', '.join(map(next, gear))}>, {next(load)}, "
        f"strainwave::Sensors<{scalar}, {next(sensor)}>, {next(thermal)}, {next(meter)}>"
        for _ in range(count)
    ]
