"""Output of verbs that write a report."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path


def write_report(folder: Path, files: Mapping[str, str | bytes], summary: str) -> None:
    """Write the files of a report into a folder, and print its summary with what was written."""
    from strainwave.files.writing import write_folder

    write_folder(folder, files)
    beside = ", ".join(name for name in files if not name.endswith(".html"))
    print(f"{summary}\n\nwrote {folder / 'report.html'}, and beside it {beside}")
