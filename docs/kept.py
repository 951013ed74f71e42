"""Results of scripts that earlier builds ran, kept in `build/pages` while neither script nor package changes."""

from __future__ import annotations

import hashlib
import re
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import strainwave
from strainwave import _core

KEPT = Path(__file__).resolve().parent.parent / "build" / "pages"
DIGEST_DIGITS = 16  # of the name of a folder
COMPILED = re.compile(r"^strainwave: compiling a kernel .*\n", re.MULTILINE)  # printed only if no earlier run compiled it
MAX_PROCESSES = 2  # scripts at a time; most use all cores for a part of their time


def kept(name: str, depends_on: bytes, make: Callable[[Path], None]) -> Path:
    """Return the folder that `make` fills; it is called if `depends_on` or the package changed since the last build."""
    folder = KEPT / f"{name}-{hashlib.sha256(depends_on + package_digest()).hexdigest()[:DIGEST_DIGITS]}"
    if not folder.is_dir():
        for old in {*KEPT.glob(f"{name}-{'[0-9a-f]' * DIGEST_DIGITS}")} - {folder}:
            shutil.rmtree(old, ignore_errors=True)
        KEPT.mkdir(parents=True, exist_ok=True)
        with TemporaryDirectory(dir=KEPT) as begun:
            (made := Path(begun, "made")).mkdir()
            make(made)
            try:
                made.rename(folder)
            except OSError:  # another process has made it meanwhile
                if not folder.is_dir():
                    raise
    return folder


@cache
def package_digest() -> bytes:
    """Return the digest of all files of the package that a run depends on."""
    package = Path(strainwave.__file__).parent
    files = [Path(_core.__file__), *sorted(path for path in package.rglob("*") if path.suffix in (".py", ".toml"))]
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.read_bytes())
    return digest.digest()
