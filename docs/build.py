"""Builds the documentation: the pages of this folder, tutorials, pictures of examples, and a theory page for each family.

python docs/build.py FOLDER
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import theory
import tutorials
from sphinx.cmd.build import main as sphinx

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
SOURCE = ROOT / "build" / "docs"
SHOWN = re.compile(r"\]\((?:\.\./)?drawn/(\d\d_\w+)/\w+\.png\)")  # a picture that an example draws


def gather() -> None:
    """Everything Sphinx reads, in one folder: this one, the pages of the root with their links from here, the theory."""
    shutil.rmtree(SOURCE, ignore_errors=True)
    programs = (path.name for path in HERE.glob("*.py") if path.name != "conf.py")
    shutil.copytree(HERE, SOURCE, ignore=shutil.ignore_patterns("__pycache__", *programs))
    for page in (ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", ROOT / "python" / "strainwave" / "AGENTS.md"):
        text = page.read_text(encoding="utf-8")
        (SOURCE / page.name.lower()).write_text(text.replace("](docs/", "]("), encoding="utf-8")
    theory.write(SOURCE / "theory")
    tutorials.write(SOURCE / "tutorials")
    draw()


def draw() -> None:
    """Run each example whose picture a page shows, in the folder `drawn/` and its name."""
    pages = [page.read_text(encoding="utf-8") for page in SOURCE.rglob("*.md")]
    for name in sorted({name for page in pages for name in SHOWN.findall(page)}):
        folder = SOURCE / "drawn" / name
        folder.mkdir(parents=True)
        example = [sys.executable, str(ROOT / "examples" / f"{name}.py")]
        subprocess.run(example, cwd=folder, env=os.environ | {"MPLBACKEND": "agg"}, stdout=subprocess.DEVNULL, check=True)


def main(out: str) -> int:
    gather()
    shutil.rmtree(out, ignore_errors=True)
    code: int = sphinx(["--quiet", "--fail-on-warning", "--keep-going", "-d", str(SOURCE) + ".doctrees", str(SOURCE), out])
    return code


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
