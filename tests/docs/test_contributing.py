"""The modules on the pages for contributors pass the lint of the project at the place where each page puts it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MODULE = re.compile(r"`(python/strainwave/[\w/]+\.py)` \(new\)(?:(?!^```).)*^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
MODULES = {
    place: code
    for page in sorted((ROOT / "docs" / "contributing").glob("*.md"))
    for place, code in MODULE.findall(page.read_text(encoding="utf-8"))
}


def checked(*command: str | Path, text: str = "") -> str:
    """Return what a program of the lint prints about a text or a file."""
    paths = os.environ | {"MYPYPATH": str(ROOT / "python")}
    run = [sys.executable, "-m", *command]
    return subprocess.run(run, cwd=ROOT, env=paths, input=text, capture_output=True, text=True, check=False).stdout


def test_each_page_that_adds_a_module_shows_it() -> None:
    rooms = {Path(place).parent.relative_to("python/strainwave").as_posix() for place in MODULES}
    assert rooms == {"commands", "export", "files", "identification/kinds"}


@pytest.mark.parametrize("place", MODULES)
def test_the_style_of_a_module_on_a_page(place: str) -> None:
    pytest.importorskip("ruff")
    here = ("--stdin-filename", place, "-")
    assert checked("ruff", "check", *here, text=MODULES[place]) == "All checks passed!\n"
    assert checked("ruff", "format", *here, text=MODULES[place]) == MODULES[place]
    assert "F401" in checked("ruff", "check", *here, text=f"import os\n{MODULES[place]}")


@pytest.mark.slow("docs")
def test_the_types_of_the_modules_on_pages(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    for place, code in MODULES.items():
        (tmp_path / Path(place).name).write_text(code, encoding="utf-8")
    assert checked("mypy", tmp_path).startswith("Success: no issues found in 4 source files")
    (tmp_path / "wrong.py").write_text('number: int = "text"\n')
    assert "wrong.py:1: error" in checked("mypy", tmp_path)
