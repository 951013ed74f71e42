"""Lists on pages that are computed: exports, formats of files, and the tables of contents that Sphinx wants.

python docs/listed.py    writes the lists into the pages, between comments; a test compares them
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import strainwave as sw
from strainwave.files.tables import LISTED_FORMATS

CONTENTS = "<!-- contents: the pages above -->"
TOCTREE = re.compile(r"^<!-- toctree\n(.*?)\n-->$", re.MULTILINE | re.DOTALL)  # which a code host does not show
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
    for each in LISTED_FORMATS:
        suffixes = ", ".join(f"`{suffix}`" for suffix in each.suffixes)
        rows.append(f"| {each.title} | {suffixes} | {each.units} | {each.kept} |")
    rules = (f"* **{each.title}**: {each.about}" for each in LISTED_FORMATS if each.about)
    return "\n".join([head, *rows, "", *rules])


def title(page: Path) -> str:
    return page.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")


END = "<!-- end of the list -->"
LISTS: dict[str, Callable[[], str]] = {
    "<!-- all exports -->": exports,
    "<!-- pages of the exports -->": export_pages,
    "<!-- all formats of files -->": formats,
}


def filled(text: str) -> str:
    """Return a page with each list as it is computed now, between its comment and the one of its end."""
    for place, listed in LISTS.items():
        before, found, rest = text.partition(f"{place}\n")
        if found:
            text = f"{before}{found}\n{listed()}\n\n{END}{rest.partition(END)[2]}"
    return text


def with_contents(text: str) -> str:
    """Return a page with tables of contents of Sphinx: that of the pages of its lists, and those in comments."""
    names = "\n".join(PAGE.findall(text))
    return TOCTREE.sub(r"```{toctree}\n\1\n```", text.replace(CONTENTS, f"<!-- toctree\n:hidden:\n\n{names}\n-->"))


if __name__ == "__main__":
    for page in Path(__file__).parent.rglob("*.md"):
        page.write_text(filled(page.read_text(encoding="utf-8")), encoding="utf-8")
