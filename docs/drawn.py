"""Draws the pictures that pages show: of examples, each a script, and of pages whose own code writes pictures.

The tests take pictures, printed text and values of the same run.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from kept import COMPILED, MAX_PROCESSES, kept

ROOT = Path(__file__).resolve().parent.parent
RUN_SCRIPT = Path(__file__).with_name("run_script.py")
PICTURE = re.compile(r"^<!-- picture ([\w./-]+): (.+) -->$", re.MULTILINE)  # a place on a page: NAME/PICTURE.png, and its words
SHOWN = re.compile(r"(?<![\w/])(?:\.\./)?drawn/([\w-]+)/[\w-]+\.png")  # a picture on a page: drawn/NAME/PICTURE.png
PRINTED, WARNINGS, VALUES = "printed.txt", "warnings.txt", "values.pickle"  # of a script, in its folder
BLOCK = re.compile(r"^```python\n(?!>>>)(.*?)^```$", re.MULTILINE | re.DOTALL)


def pictured(text: str, page: str) -> str:
    """Return the text of a page with a picture at each place for one; a code host, which has no pictures, shows none."""
    return PICTURE.sub(rf"![\2]({'../' * page.count('/')}drawn/\1)", text)


def draw(source: Path) -> None:
    """Draw each picture that a page shows, in the folder `drawn/NAME`; `NAME` is that of an example or of a page."""
    pages = {page: page.read_text(encoding="utf-8") for page in source.rglob("*.md")}
    names = sorted({name for text in pages.values() for name in SHOWN.findall(text)})
    scripts = {name: script_of(name, pages) for name in names}
    with ThreadPoolExecutor(MAX_PROCESSES) as pool:
        for name, folder in zip(names, pool.map(drawn, names, scripts.values()), strict=True):
            shutil.copytree(folder, source / "drawn" / name, ignore=shutil.ignore_patterns(PRINTED, WARNINGS, VALUES))


def path_of(name: str) -> Path:
    """Return the path of an example."""
    return ROOT / "examples" / f"{name}.py"


def script_of(name: str, pages: Mapping[Path, str]) -> str:
    """Return the code that draws the pictures of a name: that of an example, or the programs of the page."""
    if (example := path_of(name)).is_file():
        return example.read_text(encoding="utf-8")
    (text,) = (text for page, text in pages.items() if page.stem == name)
    return "\n".join(BLOCK.findall(text))


def drawn(name: str, script: str) -> Path:
    """Return the folder with the pictures of a script, what it printed, its warnings and, of an example, its values."""

    def make(folder: Path) -> None:
        path = path_of(name)
        command = [str(RUN_SCRIPT), str(path), str(folder / VALUES)] if path.is_file() else ["-c", script]
        done = subprocess.run(
            [sys.executable, *command],
            cwd=folder,
            env=os.environ | {"MPLBACKEND": "agg"},
            capture_output=True,
            encoding="utf-8",
            check=False,
        )
        warned = COMPILED.sub("", done.stderr)
        sys.stderr.write(warned)
        done.check_returncode()
        (folder / PRINTED).write_text(done.stdout, encoding="utf-8")
        (folder / WARNINGS).write_text(warned, encoding="utf-8")

    return kept(name, Path(__file__).read_bytes() + script.encode(), make)
