"""Results of compilers, kept in `build/test-compiled` between runs of the tests while nothing changes that they depend on."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import pytest
from strainwave.native import compilers, kernel

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "build" / "test-compiled"
RESULT = "result.json"
MAX_UNUSED_SECONDS = 14.0 * 86_400.0  # of what is kept
MAX_BYTES = 1_000_000  # of a file that is an argument and is read; compilers are larger
TEMPORARY = re.compile(rf"{re.escape(tempfile.gettempdir())}/(?:[^/\s]+/)*")  # folders that differ from run to run

Result = tuple[int, str]  # exit status, and what the compiler said


def kept(folder: Path, words: Sequence[str], make: Callable[[], Result]) -> Result:
    """Let `make` fill a folder and return its result, or copy what it made before with the same words and files."""
    begun = {path for path in sorted(folder.rglob("*")) if path.is_file() and path.suffix != ".gch"}
    place = KEPT / _digest(folder, begun, words)
    if place.is_dir():
        os.utime(place)
        for path in place.iterdir():
            if path.name != RESULT:
                shutil.copy(path, folder)
        status, said = json.loads((place / RESULT).read_text())
        return status, said
    result = make()
    _remove_unused()
    KEPT.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=KEPT) as temporary:
        (made := Path(temporary, "made")).mkdir()
        for path in folder.iterdir():
            if path.is_file() and path not in begun:
                shutil.copy(path, made)
        (made / RESULT).write_text(json.dumps(result))
        with suppress(OSError):  # another process has made it meanwhile
            made.rename(place)
    return result


def _digest(folder: Path, files: set[Path], words: Sequence[str]) -> str:
    """Return the digest of all that a compilation depends on."""
    digest = hashlib.sha256(_sources())
    for path in sorted(files):
        digest.update(f"{path.relative_to(folder)}\0".encode() + path.read_bytes())
    for word in words:
        digest.update(f"\0{TEMPORARY.sub('', word.replace(str(folder), '.'))}".encode())
        if (program := shutil.which(word)) and os.path.isabs(word):
            digest.update(compilers._identity(program).encode())
        elif "/" in word and (path := Path(word)).is_file() and path.stat().st_size < MAX_BYTES:
            digest.update(path.read_bytes())
    return digest.hexdigest()


@cache
def _sources() -> bytes:
    """Return the digest of the sources that tests compile, and of the compilers and packages that they do it with."""
    digest = hashlib.sha256()
    for folder in (ROOT / "include", ROOT / "src", ROOT / "tests", kernel.INCLUDE_FOLDER):
        for path in sorted(folder.rglob("*.[ch]pp")):
            digest.update(f"{path}\0".encode() + path.read_bytes())
    for name in ("nanobind", "ziglang"):
        with suppress(PackageNotFoundError):
            digest.update(f"{name} {version(name)}\0".encode())
    for name in ("c++", "g++", "gcc", "clang++", os.environ.get("CXX", "")):
        if program := shutil.which(name):
            digest.update(compilers._identity(program).encode())
    return digest.digest()


def _remove_unused() -> None:
    """Remove what no test has used for long."""
    for place in KEPT.glob("*"):
        with suppress(OSError):  # another process has removed it meanwhile
            if time.time() - place.stat().st_mtime > MAX_UNUSED_SECONDS:
                shutil.rmtree(place)


def keep_builds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep the shared objects that the package compiles in this process, as those of exports."""
    build = compilers.Compiler.build

    def kept_build(self: compilers.Compiler, source: Path, flags: Sequence[str], *arguments: Any, **options: Any) -> Path:
        words = (self.identity, *self.command, *flags, *map(str, arguments), *map(str, options.items()))
        kept(source.parent, words, lambda: (0, str(build(self, source, flags, *arguments, **options))))
        return source.with_suffix(".so")

    monkeypatch.setattr(compilers.Compiler, "build", kept_build)
