"""The tree of rooms with which CONTRIBUTING begins: what is where, and which room of the package imports which."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "CONTRIBUTING.md"
# Indent, folders, text, and rooms after an arrow.
ROOM = re.compile(r"^( *)((?:[\w.]+/)+(?: (?:[\w.]+/)+)*)\s+\S.*?(?:\s+<- ([\w, ]+))?$")
PACKAGE = "python/strainwave"


def rooms() -> dict[str, tuple[str, ...]]:
    """Return the folders of the tree, by their paths from the root, each with the rooms after its arrow.

    Raises:
        ValueError: a line is none of a tree
    """
    tree = PAGE.read_text(encoding="utf-8").partition("```text\n")[2].partition("```")[0]
    found: dict[str, tuple[str, ...]] = {}
    above = ""
    for line in tree.splitlines():
        room = ROOM.match(line)
        if room is None:
            raise ValueError(f"{PAGE.name}: this line of the tree has no folder and text: {line}")
        indent, listed, arrow = room.groups(default="")
        folders = [folder.rstrip("/") for folder in listed.split()]
        if not indent:
            above = folders[0]
        imports = tuple(arrow.replace(",", " ").split())
        found |= {f"{above}/{folder}" if indent else folder: imports for folder in folders}
    return found


def layers() -> dict[str, set[str]]:
    """Return each room of the package that has code, with itself, those after its arrow, and all that these may import."""
    after = {path.rpartition("/")[2]: imports for path, imports in rooms().items() if path.startswith(f"{PACKAGE}/")}

    def reached(room: str) -> set[str]:
        return {room}.union(*map(reached, after[room]))

    return {room: reached(room) for room in after if (ROOT / PACKAGE / room / "__init__.py").exists()}
