"""Lists that the build of the documentation computes: they are complete, and each page has a place for its list."""

from __future__ import annotations

from pathlib import Path

import listed
import pytest
import strainwave as sw
from strainwave.export.exported import Form

DOCS = Path(__file__).resolve().parents[2] / "docs"


@pytest.mark.parametrize("form", sw.export.FORMS, ids=lambda form: form.verb)
def test_the_page_of_an_export_shows_its_command(form: Form) -> None:
    page = DOCS / "how-to" / form.page.partition("#")[0]
    assert f"strainwave export {form.verb} " in page.read_text(encoding="utf-8")


def test_a_comment_becomes_its_list_and_the_contents_are_the_pages_that_lists_begin_with(tmp_path: Path) -> None:
    page = tmp_path / "index.md"
    page.write_text(
        f"* [One](one.md) before [two](two.md)\n\n<!-- all exports -->\n\n- [Four](a/four.md)\n\n{listed.CONTENTS}\n"
    )
    listed.write(tmp_path)
    text = page.read_text()
    assert listed.exports() in text
    assert text.endswith("```{toctree}\n:hidden:\n\none\na/four\n```\n")
    assert "<!--" not in text


def test_every_list_has_a_place() -> None:
    pages = "".join(page.read_text(encoding="utf-8") for page in DOCS.rglob("*.md"))
    assert [place for place in listed.LISTS if pages.count(place) != 1] == []
