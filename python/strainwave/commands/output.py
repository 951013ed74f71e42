"""Output of verbs that write a report."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

MAX_NAMED_FILES = 8  # of a folder; more are counted


def write_report(folder: Path, files: Mapping[str, str | bytes], summary: str) -> None:
    """Write the files of a report into a folder, and print its summary with what was written."""
    from strainwave.files.writing import write_folder

    write_folder(folder, files)
    names = [name for name in files if not name.endswith(".html")]
    counted = [f"{len(names) - MAX_NAMED_FILES} more"] if len(names) > MAX_NAMED_FILES else []
    beside = ", ".join([*names[:MAX_NAMED_FILES], *counted])
    print(f"{summary}\n\nwrote {folder / 'report.html'}, and beside it {beside}")
