"""The type stubs in the package say what the compiled modules are."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STUBS: dict[Path, str] = runpy.run_path(str(ROOT / "src" / "stubs.py"))["stubs"]()


@pytest.mark.parametrize("path", STUBS, ids=lambda path: path.stem)
def test_a_stub_says_what_its_module_is(path: Path) -> None:
    written = path.read_text() if path.is_file() else ""
    assert written == STUBS[path], f"{path.name} is out of date: run python3 dev.py stubs"


def test_every_stub_has_a_module() -> None:
    assert set((ROOT / "python" / "strainwave").glob("*.pyi")) == set(STUBS)
