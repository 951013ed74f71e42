"""Draws the pictures of docs/benchmarks.md anew, from the tables of the last runs.

python benchmarks/pictures.py
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import scaling
import single
import targets
from report import save_figure, saved

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "pictures"


def content(part: str) -> dict[str, Any]:
    found = saved(part)
    if found is None:
        sys.exit(f"pictures: run benchmarks/run.py --only {part} first")
    return found


if __name__ == "__main__":
    precision, growth = content("single"), content("scaling")
    save_figure("work_precision", single.drawn(targets.results(precision)), precision, FOLDER)
    lines = [scaling.Line(**line) for line in growth["results"]]
    save_figure("growth", scaling.drawn(lines), growth, FOLDER)
