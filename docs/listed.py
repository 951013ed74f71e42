"""Lists on pages that are computed: exports, formats of files, and the tables of contents that Sphinx wants.

A page has a comment where a list goes.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import strainwave as sw
from strainwave.files.tables import LISTED

CONTENTS = "<!-- contents: the pages above -->"
PAGE = re.compile(r"^[*-] \[[^\]]*\]\(([\w/-]+)\.md\)", re.MULTILINE)  # a page that a line of a list begins with


def exports() -> str:
    """Return the table of all exports."""
    head = "| you have | second command | of a | you get |\n|---|---|---|---|"
    rows = (
        f"| {form.program} | [`strainwave export {form.verb}`]({form.page}) | {form.model} | {form.files} |"
        for form in sw.export.FORMS
    )
    return "\n".join([head, *rows])


def export_pages() -> str:
    """Return a list of the pages of all exports, each with its title."""
    pages = dict.fromkeys(form.page.partition("#")[0] for form in sw.export.FORMS)
    return "\n".join(f"* [{title(Path(__file__).parent / 'how-to' / page)}]({page})" for page in pages)


def formats() -> str:
    """Return the table of all formats of files, and what is to be said of some."""
    head = "| format | file | unit of a column | precision |\n|---|---|---|---|"
    rows = []
    for each in LISTED:
        suffixes = ", ".join(f"`{suffix}`" for suffix in each.suffixes)
        rows.append(f"| {each.title} | {suffixes} | {each.units} | {each.kept} |")
    rules = (f"* **{each.title}**: {each.about}" for each in LISTED if each.about)
    return "\n".join([head, *rows, "", *rules])


def title(page: Path) -> str:
    return page.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")


LISTS: dict[str, Callable[[], str]] = {
    "<!-- all exports -->": exports,
    "<!-- pages of the exports -->": export_pages,
    "<!-- all formats of files -->": formats,
}


def write(source: Path) -> None:
    """Replace each comment by its list, and last a comment of contents by a hidden table of the pages that the lists have."""
    for page in source.rglob("*.md"):
        text = before = page.read_text(encoding="utf-8")
        for place, listed in LISTS.items():
            if place in text:
                text = text.replace(place, listed())
        names = "\n".join(PAGE.findall(text))
        text = text.replace(CONTENTS, f"```{{toctree}}\n:hidden:\n\n{names}\n```")
        if text != before:
            page.write_text(text, encoding="utf-8")
