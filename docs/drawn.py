"""Draws the pictures that pages show: of examples, each a script, and of pages whose own code writes pictures."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from kept import MAX_PROCESSES, kept

ROOT = Path(__file__).resolve().parent.parent
SHOWN = re.compile(r"(?<![\w/])(?:\.\./)?drawn/([\w-]+)/[\w-]+\.png")  # a picture on a page: drawn/NAME/PICTURE.png
BLOCK = re.compile(r"^```python\n(?!>>>)(.*?)^```$", re.MULTILINE | re.DOTALL)


def draw(source: Path) -> None:
    """Draw each picture that a page shows, in the folder `drawn/NAME`; `NAME` is that of an example or of a page."""
    pages = {page: page.read_text(encoding="utf-8") for page in source.rglob("*.md")}
    names = sorted({name for text in pages.values() for name in SHOWN.findall(text)})
    code = {page.stem: "\n".join(BLOCK.findall(text)) for page, text in pages.items()}
    scripts = {
        name: example.read_text(encoding="utf-8") if (example := path_of(name)).is_file() else code[name] for name in names
    }
    with ThreadPoolExecutor(MAX_PROCESSES) as pool:
        for name, folder in zip(names, pool.map(drawn, names, scripts.values()), strict=True):
            shutil.copytree(folder, source / "drawn" / name)


def path_of(name: str) -> Path:
    """Return the path of an example."""
    return ROOT / "examples" / f"{name}.py"


def drawn(name: str, script: str) -> Path:
    """Return the folder with the pictures of a script."""

    def make(folder: Path) -> None:
        path = path_of(name)
        command = [sys.executable, str(path)] if path.is_file() else [sys.executable, "-c", script]
        subprocess.run(command, cwd=folder, env=os.environ | {"MPLBACKEND": "agg"}, stdout=subprocess.DEVNULL, check=True)

    return kept(name, script.encode(), make)
