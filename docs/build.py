"""Builds the documentation: the pages of this folder, and those computed from the package, its examples and its catalogue.

python docs/build.py FOLDER
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from urllib.parse import urljoin

import api
import catalogue_check
import cli_reference
import drawn
import gallery
import links
import listed
import theory
import tutorials
from sphinx.cmd.build import main as sphinx
from sphinx.util.inventory import InventoryFile
from strainwave.workbench import page as workbench

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
SOURCE = ROOT / "build" / "docs"
TOOLS = ("__pycache__", "*.py")


def gather() -> None:
    """Gather all that Sphinx reads in one folder: this one, the pages of the root and of papers/, and those generated."""
    shutil.rmtree(SOURCE, ignore_errors=True)
    shutil.copytree(HERE, SOURCE, ignore=shutil.ignore_patterns(*TOOLS, "*.md"))
    shutil.copy(HERE / "conf.py", SOURCE)
    pages = links.built_pages()
    for path, page in pages.items():
        if path.endswith(".md") and path != "README.md":  # which is a page of the code host alone
            (SOURCE / page).parent.mkdir(parents=True, exist_ok=True)
            text = links.relinked((ROOT / path).read_text(encoding="utf-8"), path, pages)
            (SOURCE / page).write_text(drawn.pictured(listed.with_contents(text), page), encoding="utf-8")
    theory.write(SOURCE / "theory")
    tutorials.write(SOURCE / "tutorials")
    for path, page in pages.items():
        if page.startswith("tutorials/") and path.endswith(".py"):
            text = links.relinked((SOURCE / page).read_text(encoding="utf-8"), path, pages)
            (SOURCE / page).write_text(text, encoding="utf-8")
    api.write(SOURCE / "reference" / "api")
    cli_reference.write(SOURCE / "reference")
    gallery.write(SOURCE)
    catalogue_check.write(SOURCE / "reference" / "catalogue-check.md")
    drawn.draw(SOURCE)


def main(out: str) -> int:
    gather()
    shutil.rmtree(out, ignore_errors=True)
    code: int = sphinx(["--quiet", "--fail-on-warning", "--keep-going", "-d", str(SOURCE) + ".doctrees", str(SOURCE), out])
    if workbench.is_installed():
        shutil.copy(workbench.FILE, out)  # docs/how-to/workbench.md links it
    return code or unlisted(Path(out) / "objects.inv")


def unlisted(inventory: Path) -> int:
    """Print the public names that the inventory lacks, for want of a docstring; return 1 if there are some, else 0."""
    with inventory.open("rb") as file:
        listed = {name for names in InventoryFile.load(file, "", urljoin).values() for name in names}
    lacking = sorted(api.public() - listed)
    print(*(f"the reference has no entry for {name}: give it a docstring" for name in lacking), sep="\n", file=sys.stderr)
    return int(bool(lacking))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
