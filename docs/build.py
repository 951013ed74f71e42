"""Builds the documentation: the pages of this folder, and a theory page for each family of models from its own words.

python docs/build.py FOLDER
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import theory
from sphinx.cmd.build import main as sphinx

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
SOURCE = ROOT / "build" / "docs"


def gather() -> None:
    """Everything Sphinx reads, in one folder: this one, the pages of the root with their links from here, the theory."""
    shutil.rmtree(SOURCE, ignore_errors=True)
    shutil.copytree(HERE, SOURCE, ignore=shutil.ignore_patterns("__pycache__", "build.py", "theory.py", "parts.py"))
    for page in ("CONTRIBUTING.md", "CHANGELOG.md"):
        text = (ROOT / page).read_text(encoding="utf-8")
        (SOURCE / page.lower()).write_text(text.replace("](docs/", "]("), encoding="utf-8")
    theory.write(SOURCE / "theory")


def main(out: str) -> int:
    gather()
    shutil.rmtree(out, ignore_errors=True)
    code: int = sphinx(["--quiet", "--fail-on-warning", "--keep-going", "-d", str(SOURCE) + ".doctrees", str(SOURCE), out])
    return code


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
