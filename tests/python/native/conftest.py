"""A cache of kernels for each test, and stand-ins for compilers."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from strainwave.native import cache, folder

Fake = Callable[[str], Path]


@pytest.fixture(autouse=True)
def kernels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the cache, which is not there yet; nothing is shipped, and nothing was warned of."""
    monkeypatch.setenv("STRAINWAVE_KERNELS", str(tmp_path / "kernels"))
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setattr(folder, "SHIPPED_KERNELS", tmp_path / "shipped")
    monkeypatch.setattr(cache, "_failed", set())
    monkeypatch.setattr(cache, "_warned", set())
    return tmp_path / "kernels"


@pytest.fixture
def fake(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Fake:
    """Makes a script the compiler of this machine, which answers as the real one and first does something else to compile."""

    def compiler(instead: str) -> Path:
        real = shutil.which("c++")
        script = tmp_path / "fake-compiler"
        script.write_text(f'#!/bin/sh\ncase " $* " in *" -c "*) {instead};; esac\nexec {real} "$@"\n')
        script.chmod(0o700)
        monkeypatch.setenv("CXX", str(script))
        return script

    return compiler


@pytest.fixture
def empty_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No program can be found by its name."""
    monkeypatch.setenv("PATH", str(tmp_path / "nowhere"))


@pytest.fixture
def given_away(monkeypatch: pytest.MonkeyPatch) -> Callable[[Path], None]:
    """Lets a file appear to belong to another user, whoever runs the tests."""
    real = {name: getattr(os, name) for name in ("stat", "lstat", "fstat")}
    others: set[int] = set()

    def seen(name: str) -> Callable[..., os.stat_result]:
        def stat(*arguments: object, **options: object) -> os.stat_result:
            found = real[name](*arguments, **options)
            return os.stat_result((*found[:4], found.st_uid + 1, *found[5:10])) if found.st_ino in others else found

        return stat

    def give(path: Path) -> None:
        others.add(real["lstat"](path).st_ino)
        for name in real:
            monkeypatch.setattr(os, name, seen(name))

    return give
