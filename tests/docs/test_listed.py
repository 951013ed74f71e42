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


def test_the_contents_are_the_pages_that_lists_begin_with() -> None:
    text = listed.with_contents(f"* [One](one.md) before [two](two.md)\n\n- [Four](a/four.md)\n\n{listed.CONTENTS}\n")
    assert text.endswith("```{toctree}\n:hidden:\n\none\na/four\n```\n")
    assert "<!--" not in text


def test_every_list_has_a_place_and_is_as_computed() -> None:
    """A code host shows the pages without a build: `python docs/listed.py` writes the lists."""
    pages = [page.read_text(encoding="utf-8") for page in DOCS.rglob("*.md")]
    assert [place for place in listed.LISTS if "".join(pages).count(place) != 1] == []
    assert [text.partition("\n")[0] for text in pages if listed.filled(text) != text] == []
