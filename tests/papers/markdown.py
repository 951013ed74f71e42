"""Reading of pages in Markdown: their sections and tables."""

from __future__ import annotations

import re


def section(page: str, title: str) -> str:
    """Return the text of a section of level 2, to the next of its level."""
    (found,) = re.findall(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", page, re.MULTILINE | re.DOTALL)
    return str(found)


def tables(text: str) -> list[list[list[str]]]:
    """Return all tables, each as rows of cells, without the line below its head."""
    found = re.findall(r"(?:^\|.*\|$\n?)+", text, re.MULTILINE)
    return [[_cells(line) for line in table.splitlines() if not re.fullmatch(r"[|-]+", line)] for table in found]


def _cells(line: str) -> list[str]:
    return [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
