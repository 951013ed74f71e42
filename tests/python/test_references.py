"""Every work that a model or a function names as its source is on the page of references, and no other."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEY = re.compile(r"\b[A-Z][A-Za-z]+(?:1[6-9]|20)\d\d\b")  # authors and year


def test_every_key_of_a_source_resolves() -> None:
    sources = [*(ROOT / "include").rglob("*.hpp"), *(ROOT / "python").rglob("*.py")]
    used = {key for source in sources for key in KEY.findall(source.read_text(encoding="utf-8"))}
    page = (ROOT / "docs" / "theory" / "references.md").read_text(encoding="utf-8")
    described = re.findall(r"^### (\w+)\n\n\S", page, re.MULTILINE)
    assert described == sorted(used)
