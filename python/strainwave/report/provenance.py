"""Origin of a report."""

from __future__ import annotations

import hashlib
import os
import shlex
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

from strainwave.files.budget import MAX_ALLOWED_BYTES, RefusedFile, open_regular

BLOCK_BYTES = 2**20  # bytes read at a time


@dataclass(frozen=True)
class Provenance:
    """Origin of a report: date, command and files.

    Attributes:
        date: when, as the report shows it
        command: what was called
        files: SHA-256 of each file that was read, by the name the report shows; empty for what no command reads
    """

    date: str = ""
    command: str = ""
    files: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, files: Iterable[str | Path], *, command: str, date: str) -> Provenance:
        """Return the origin with the digests of files as they are now.

        Raises:
            OSError: a file cannot be read
        """
        return cls(date, command, {Path(file).name: _digest(Path(file)) for file in files})

    @classmethod
    def of_this_command(cls, files: Iterable[Path]) -> Provenance:
        """Return the origin of a report that the command line of this process makes now from these files.

        Raises:
            OSError: a file cannot be read
        """
        now = datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
        return cls.of(sorted(files), command=shlex.join(["strainwave", *sys.argv[1:]]), date=now)


def _digest(file: Path) -> str:
    """Return the SHA-256 of a file, or of the files of a folder, as a bag is one; empty for what no command reads."""
    parts = [file] if not file.is_dir() else sorted(each for each in file.iterdir() if each.is_file() and not each.is_symlink())
    digest = hashlib.sha256()
    for part in parts:
        try:
            with open_regular(part) as content:
                if content.seek(0, os.SEEK_END) > MAX_ALLOWED_BYTES:
                    return ""
                content.seek(0)
                while block := content.read(BLOCK_BYTES):
                    digest.update(block)
        except RefusedFile:
            return ""
    return digest.hexdigest()
