"""The key of a kernel changes with everything that its code depends on, and with nothing else."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from strainwave import _core
from strainwave.native import kernel
from strainwave.native.compilers import find_compiler
from strainwave.native.kernel import INCLUDE_FOLDER, Kernel

KERNEL = Kernel("int x;", "run", "load Pendulum")
COMPILER = find_compiler()


@pytest.fixture
def headers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Two headers of their own."""
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "one.hpp").write_text("1")
    (tmp_path / "two.hpp").write_text("2")
    monkeypatch.setattr(kernel, "INCLUDE_FOLDER", tmp_path)
    kernel.headers_digest.cache_clear()
    yield tmp_path
    kernel.headers_digest.cache_clear()


def test_the_headers_are_those_that_the_package_brings() -> None:
    assert (INCLUDE_FOLDER / "strainwave" / "drive.hpp").is_file()


def test_the_source_the_instruction_set_and_the_compiler_are_in_the_key(monkeypatch: pytest.MonkeyPatch) -> None:
    other = next(name for name in ("baseline", "avx2") if name != _core.instruction_set())
    keys = {KERNEL.key(COMPILER), KERNEL.shipped_key(), replace(KERNEL, source="int y;").key(COMPILER)}
    keys |= {KERNEL.key(replace(COMPILER, identity="another")), KERNEL.key(replace(COMPILER, command=("c++", "-m32")))}
    with monkeypatch.context() as patch:
        patch.setattr(_core, "instruction_set", lambda: other)
        keys |= {KERNEL.key(COMPILER), KERNEL.shipped_key()}
    assert len(keys) == 7
    assert KERNEL.key(COMPILER) in keys


def test_what_the_list_shows_is_not_in_the_key() -> None:
    assert replace(KERNEL, drive="another", job="another").key(COMPILER) == KERNEL.key(COMPILER)


def test_names_and_contents_of_all_headers_are_in_the_key(headers: Path) -> None:
    keys = {KERNEL.shipped_key()}
    for change in (
        lambda: (headers / "inner" / "one.hpp").write_text("3"),
        lambda: (headers / "two.hpp").rename(headers / "other.hpp"),
        lambda: shutil.copy(headers / "other.hpp", headers / "inner"),
    ):
        change()
        kernel.headers_digest.cache_clear()
        keys.add(KERNEL.shipped_key())
    assert len(keys) == 4
