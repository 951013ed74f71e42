"""The page of errata: its table has each entry once, with a link to it and a severity."""

from __future__ import annotations

import re
from pathlib import Path

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "validation" / "errata.md").read_text(encoding="utf-8")
SEVERITIES = {"wrong result", "misleading", "gap", "wording"}
HEADINGS = re.findall(r"^### ((E-\w+) .*)$", PAGE, re.MULTILINE)
ROWS = [
    [cell.strip() for cell in line.strip("|").split(" | ")]
    for line in PAGE.splitlines()
    if re.match(r"\| \[E-[RPAT]\d+\]", line)
]


def anchor(title: str) -> str:
    """Return the anchor of a heading, as MyST forms it."""
    return re.sub(r"[^\w\- ]", "", re.sub(r"\$[^$]*\$|[*]", "", title).lower()).replace(" ", "-")


def test_each_entry_has_a_row_that_leads_to_it() -> None:
    assert [row[0] for row in ROWS] == [f"[{number}](#{anchor(title)})" for title, number in HEADINGS]


def test_each_row_names_the_document_and_a_severity_and_leaves_no_cell_empty() -> None:
    for row in ROWS:
        assert len(row) == 7, row
        assert all(row), row
        assert row[1][0] == row[0][3], "the document of the entry's number"
        assert row[6] in SEVERITIES, row


def test_numbers_of_entries_run_without_a_gap() -> None:
    numbers = [number for _, number in HEADINGS]
    for letter in "RPAT":
        of_document = [number for number in numbers if number[2] == letter]
        assert of_document == [f"E-{letter}{k}" for k in range(1, len(of_document) + 1)]


def test_each_link_to_an_entry_leads_to_one() -> None:
    known = {anchor(title) for title, _ in HEADINGS}
    root = Path(__file__).resolve().parents[2]
    for page in (*(root / "docs").rglob("*.md"), *(root / "papers").rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        used = re.findall(r"\((?:\.\./validation/|\.\./\.\./docs/validation/)?errata\.md#(e-[rpat]\d+[^)]*)\)", text)
        used += re.findall(r"\(#(e-[rpat]\d+[^)]*)\)", text) if page.name == "errata.md" else []
        assert known.issuperset(used), (page.name, sorted(set(used) - known))
