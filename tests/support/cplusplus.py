"""The headers as other programs meet them: compilers, and drives of static type that hold every model between them."""

from __future__ import annotations

import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import strainwave as sw
from strainwave import _core
from strainwave.native.static_type import instance, parameters, static_type

from tests.support.kept import kept
from tests.support.strategies import made

ROOT = Path(__file__).parents[2]
INCLUDE_FOLDER = ROOT / "include"
HEADERS = "#include <strainwave/drive.hpp>\n#include <strainwave/integrate.hpp>\n#include <strainwave/models.hpp>\n"
# A pack is passed in a register or in memory as the machine has it; no ABI of ours crosses a library border.
STRICT = ("-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-Wno-psabi", f"-I{INCLUDE_FOLDER}")

ZIG = (sys.executable, "-m", "ziglang", "c++")


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
    return compiled(folder, *command, "-c", *sources, *options)


def compiled(folder: Path, *words: str) -> tuple[int, str]:
    """Runs a compiler in a folder, unless it ran before with the same sources: the exit status and what it said."""

    def run() -> tuple[int, str]:
        result = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
        return result.returncode, result.stderr

    return kept(folder, words, run)


def compiled_before(command: tuple[str, ...], folder: Path, headers: str, *options: str) -> tuple[str, str]:
    """Compiles what many sources include once; with the options that are returned, and those given here, they find it done."""
    (folder / "before.hpp").write_text(headers)
    compiling = [*command, *options, "-x", "c++-header", "before.hpp", "-o", "before.hpp.gch"]
    subprocess.run(compiling, cwd=folder, check=True)
    return "-include", "before.hpp"


def drives(scalar: str) -> list[str]:
    """As many drives as the longest list has models; shorter lists go round, friction is one ahead from place to place."""
    return [mixed(sw.Drive, number, scalar) for number in range(max(map(len, _core.families.values())))]


def mixed(kind: Any, number: int, scalar: str) -> str:
    """The static type of a drive, a gear or sensors with the models of this number, round and round."""
    fields, names = {field["name"]: field for field in kind.fields}, parameters(kind)
    arguments = []
    for place, name in enumerate(names):
        ahead = sum("friction" in before for before in names[:place])
        models = list((fields[name]["options"] or {}).values())
        law = models and made(models[(number + ahead) % len(models)])
        arguments.append(static_type(law, scalar) if law else mixed(type(fields[name]["default"]), number, scalar))
    return instance(kind, arguments, scalar)
