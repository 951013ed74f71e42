"""Every work that a model names as its source stands on the page of references, and no other."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEY = re.compile(r"\b[A-Z][A-Za-z]+(?:1[6-9]|20)\d\d\b")  # authors and year


def test_every_key_of_a_source_resolves() -> None:
    headers = sorted((ROOT / "include").rglob("*.hpp"))
    used = {key for header in headers for key in KEY.findall(header.read_text(encoding="utf-8"))}
    page = (ROOT / "docs" / "references.md").read_text(encoding="utf-8")
    described = re.findall(r"^### (\w+)\n\n\S", page, re.MULTILINE)
    assert described == sorted(used)
