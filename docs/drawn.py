"""Draws the pictures that pages show: of examples, each a script, and of pages whose own code writes pictures."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

import strainwave

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "build" / "pictures"  # of the last build, by what they depend on
SHOWN = re.compile(r"(?<![\w/])(?:\.\./)?drawn/([\w-]+)/[\w-]+\.png")  # a picture on a page: drawn/NAME/PICTURE.png
BLOCK = re.compile(r"^```python\n(?!>>>)(.*?)^```$", re.MULTILINE | re.DOTALL)
PROCESSES = 2  # side by side; most scripts use all cores for a part of their time


def draw(source: Path) -> None:
    """Draw each picture that a page shows, in the folder `drawn/NAME`; `NAME` is that of an example or of a page."""
    pages = {page: page.read_text(encoding="utf-8") for page in source.rglob("*.md")}
    names = sorted({name for text in pages.values() for name in SHOWN.findall(text)})
    code = {page.stem: "\n".join(BLOCK.findall(text)) for page, text in pages.items()}
    scripts = {
        name: example.read_text(encoding="utf-8") if (example := path_of(name)).is_file() else code[name] for name in names
    }
    with ThreadPoolExecutor(PROCESSES) as pool:
        for name, folder in zip(names, pool.map(drawn, names, scripts.values()), strict=True):
            shutil.copytree(folder, source / "drawn" / name)


def path_of(name: str) -> Path:
    """Return the path of an example."""
    return ROOT / "examples" / f"{name}.py"


def drawn(name: str, script: str) -> Path:
    """Return the folder with the pictures of a script; it runs if the script or the package changed since the last build."""
    folder = KEPT / f"{name}-{hashlib.sha256((script + package_digest()).encode()).hexdigest()[:16]}"
    if not folder.is_dir():
        for old in KEPT.glob(f"{name}-*"):
            shutil.rmtree(old)
        begun = folder.with_suffix(".begun")
        begun.mkdir(parents=True)
        path = path_of(name)
        command = [sys.executable, str(path)] if path.is_file() else [sys.executable, "-c", script]
        subprocess.run(command, cwd=begun, env=os.environ | {"MPLBACKEND": "agg"}, stdout=subprocess.DEVNULL, check=True)
        begun.rename(folder)
    return folder


@cache
def package_digest() -> str:
    """Return the digest of all files of the package that a run depends on."""
    files = sorted(path for path in Path(strainwave.__file__).parent.rglob("*") if path.suffix in (".py", ".so", ".toml"))
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.read_bytes())
    return digest.hexdigest()
