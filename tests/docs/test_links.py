"""Every relative link of a page of the repository leads to a file of it, and to a heading of that if it names one."""

from __future__ import annotations

import posixpath
import re
import subprocess
from collections import Counter
from functools import cache
from pathlib import Path

import links
import pytest

ROOT = Path(__file__).resolve().parents[2]
LIST_FILES = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]  # all but those that git ignores
FILES = subprocess.run(LIST_FILES, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
KNOWN = {*FILES, *(posixpath.dirname(path) for path in FILES)}
PAGES = [path for path in FILES if path.endswith(".md") or re.fullmatch(r"examples/tutorials/\w+\.py", path)]
HEADING = re.compile(r"^#+ (.+?) *$", re.MULTILINE)


def prose(path: str) -> str:
    """Return a page, or the comments of a script, without code."""
    text = (ROOT / path).read_text(encoding="utf-8")
    return links.FENCE.sub("", text) if path.endswith(".md") else "\n".join(re.findall(r"^#.*", text, re.MULTILINE))


@cache
def anchors(path: str) -> set[str]:
    """Return the anchors of the headings of a page, as a code host makes them."""
    found, counts = set[str](), Counter[str]()
    for heading in HEADING.findall(prose(path)):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        slug = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
        found.add(f"#{slug}-{counts[slug]}" if counts[slug] else f"#{slug}")
        counts[slug] += 1
    return found


def broken(path: str, text: str) -> list[str]:
    """Return the links in the text of a page that lead nowhere."""
    targets = re.findall(r"\]\((?!\w+:|<)([^)#\s]*)(#[^)\s]*)?\)", text)
    found = []
    for target, anchor in targets:
        file = posixpath.normpath(posixpath.join(posixpath.dirname(path), target)) if target else path
        if file not in KNOWN or (anchor and file.endswith(".md") and anchor not in anchors(file)):
            found.append(f"{target}{anchor}")
    return found


@pytest.mark.parametrize("path", PAGES)
def test_every_link_of_a_page_leads_to_a_file(path: str) -> None:
    assert broken(path, prose(path)) == []


def test_a_link_without_its_file_or_heading_is_found() -> None:
    text = "[a](no.md) [b](../../README.md#no) [c](../../README.md#install) [d](https://a.b) "
    text += "[e](../../include/strainwave/friction)"
    assert broken("docs/how-to/index.md", text) == ["no.md", "../../README.md#no"]


def test_a_link_to_a_source_leads_to_the_page_that_is_made_from_it() -> None:
    text = "[a](../../include/strainwave/friction/lugre.hpp), [b](../../dev.py), ![c](../pictures/twin.svg), [d](fit.md#run)\n"
    text += "```\n[e](../../dev.py)\n```\n"
    relinked = links.relinked(text, "docs/how-to/identify.md", links.built_pages())
    assert relinked == (
        "[a](../theory/friction.md#lugre), b, ![c](../pictures/twin.svg), [d](fit.md#run)\n```\n[e](../../dev.py)\n```\n"
    )


def test_every_page_of_the_theory_of_the_gallery_and_of_the_tutorials_is_linked_from_its_index() -> None:
    """The pages are made by a build; a code host shows what they are made from."""
    sources = {path: page for path, page in links.built_pages().items() if not path.endswith(".md")}
    for index, of in (
        ("docs/theory/index.md", r"theory/\w+\.md"),
        ("docs/gallery.md", "gallery/.*"),
        ("docs/tutorials/index.md", "tutorials/.*"),
    ):
        linked = {
            sources.get(posixpath.normpath(posixpath.join(posixpath.dirname(index), target)))
            for target in re.findall(r"\]\(([^)#\s]+)\)", prose(index))
        }
        assert {page for page in sources.values() if re.fullmatch(of, page)} - linked == set(), index
