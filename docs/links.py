"""Links of pages: on a code host to files of the repository, in the built documentation to the pages made from these."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Mapping
from pathlib import Path

import api
import theory

ROOT = Path(__file__).resolve().parent.parent
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\((?!\w+:|[#<])([^)#\s]+)(#[^)\s]*)?\)")
FENCE = re.compile(r"(^ *```.*?^ *```$)", re.MULTILINE | re.DOTALL)
LAWS = "include/strainwave/"


def built_pages() -> dict[str, str]:
    """Return the page in the built documentation of each file or folder that has one, by the path in the repository."""
    docs = (path for path in (ROOT / "docs").rglob("*.*") if path.suffix in (".md", ".svg"))
    pages = {f"docs/{name}": name for name in (path.relative_to(ROOT / "docs").as_posix() for path in docs)}
    pages |= {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md", "README.md": "index.md"}
    pages |= {"python/strainwave/AGENTS.md": "agents.md", "python/strainwave/commands": "reference/command-line.rst"}
    pages |= {
        f"papers/{page.parent.name}/README.md": f"validation/{page.parent.name}.md" for page in ROOT.glob("papers/*/*.md")
    }
    for folder, page in (("examples", "gallery"), ("examples/tutorials", "tutorials")):
        pages |= {f"{folder}/{script.name}": f"{page}/{script.stem}.md" for script in ROOT.glob(f"{folder}/[0-9]*.py")}
    return {path: page for path, page in (pages | sections_of_laws() | reference()).items() if (ROOT / path).exists()}


def sections_of_laws() -> dict[str, str]:
    """Return the theory page of each folder of laws, and the section of each header."""
    folders = {"loads": "load/", "gear_and_drive": "", "kinematics": ""}
    found = {f"{LAWS}kinematics.hpp": "theory/kinematics.md", f"{LAWS}drive": "theory/gear_and_drive.md"}
    for page, (_, models) in theory.pages().items():
        folder = folders.get(page, f"{page}/")
        found |= {f"{LAWS}{folder}".rstrip("/"): f"theory/{page}.md"} if folder else {}
        found |= {f"{LAWS}{folder}{model.name}.hpp": f"theory/{page}.md#{model.__name__.lower()}" for model in models}
    return found


def reference() -> dict[str, str]:
    """Return the page of the API reference of the package and of each of its rooms."""
    rooms = {room: api.file_name(title) for room, title in api.PAGES.items()} | {name: name for name in api.MODULES}
    names = {"__init__.pyi": "index"} | rooms
    return {f"python/strainwave/{name}": f"reference/api/{page}.rst" for name, page in names.items()}


def relinked(text: str, path: str, pages: Mapping[str, str]) -> str:
    """Return a page with the links of the built documentation; a link to what that lacks becomes its words."""

    def link(found: re.Match[str]) -> str:
        mark, words, target, anchor = found.groups(default="")
        page = pages.get(posixpath.normpath(posixpath.join(posixpath.dirname(path), target)))
        if page is None:
            return found[0] if mark else words  # a picture that a script has drawn lies beside its page
        to = posixpath.relpath(page, posixpath.dirname(pages[path]) or ".")
        return f"{mark}[{words}]({to}{'' if '#' in page else anchor})"

    parts = FENCE.split(text)
    return "".join(part if part.lstrip().startswith("```") else LINK.sub(link, part) for part in parts)
