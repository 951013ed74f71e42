"""Limits of reading one file: regular files only; bytes, nodes and depth are bounded before anything is allocated.

A file from a stranger may claim gigabytes in a few bytes, refer to itself, or be a FIFO that never ends. Every reader opens
its file with `open_regular` or `read_regular` and takes from one `ReadBudget` what it is about to expand or visit.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Hashable
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from strainwave.operating_system import READ_FLAGS

MIN_ALLOWED_BYTES = 2**28  # any file may expand to this: 33 million numbers
MAX_EXPANSION = 100  # times its size, that a larger file may expand to; measured noise compresses 10 times at the most
MAX_ALLOWED_BYTES = 2**32  # no file may expand to more
MAX_NODES = 100_000  # variables, groups, cells, references, blocks of one file
MAX_DEPTH = 64  # of structures in structures
MAX_TEXT_BYTES = 2**24  # of a file of settings: gear, scenario, mapping, rig, data sheet


class RefusedFile(ValueError):  # noqa: N818 - its message is the reason alone, no error of ours
    """The reason why a file is not read, without its name: whoever opened the file puts that in front."""


@dataclass
class ReadBudget:
    """Bytes and nodes that reading one file has taken, and their limits.

    Args:
        file_bytes: size of the file [bytes]; a larger file may expand to more

    >>> budget = ReadBudget(file_bytes=1000)
    >>> budget.take_bytes(8 * 10**9, "dataset q")
    Traceback (most recent call last):
    strainwave.files.budget.RefusedFile: dataset q expands the file to 8000 MB; a file of this size may expand to 268 MB
    """

    file_bytes: int
    expanded_bytes: int = 0
    nodes: int = 0
    visited: set[Hashable] = field(default_factory=set)

    @property
    def allowed_bytes(self) -> int:
        """Largest size of the file in memory [bytes]."""
        return min(max(MIN_ALLOWED_BYTES, MAX_EXPANSION * self.file_bytes), MAX_ALLOWED_BYTES)

    def take_bytes(self, count: int, what: str) -> None:
        """Count bytes that are about to be allocated for a part of the file.

        Args:
            count: bytes of that part in memory
            what: the part, as the message names it

        Raises:
            RefusedFile: the file would expand to more than it may
        """
        self.expanded_bytes += count
        if self.expanded_bytes > self.allowed_bytes:
            wanted, allowed = self.expanded_bytes / 1e6, self.allowed_bytes / 1e6
            raise RefusedFile(f"{what} expands the file to {wanted:.0f} MB; a file of this size may expand to {allowed:.0f} MB")

    def take_node(self, depth: int = 0) -> None:
        """Count a node that is about to be visited, `depth` structures below the file itself.

        Raises:
            RefusedFile: the file has too many nodes, or they are nested too deep
        """
        self.nodes += 1
        if self.nodes > MAX_NODES:
            raise RefusedFile(f"has more than {MAX_NODES} variables, cells or references")
        if depth > MAX_DEPTH:
            raise RefusedFile(f"nests structures more than {MAX_DEPTH} deep")

    def is_new(self, identity: Hashable) -> bool:
        """True at the first visit of a node, by whatever identifies it in the file."""
        known = identity in self.visited
        self.visited.add(identity)
        return not known


def open_regular(path: str | Path) -> BinaryIO:
    """Open a regular file for reading bytes.

    Raises:
        RefusedFile: it is a FIFO, a device or a socket, which may never end
        OSError: there is no such file, or it may not be read
    """
    descriptor = os.open(Path(path), READ_FLAGS)  # a number would be an open file
    mode = os.fstat(descriptor).st_mode
    if not stat.S_ISREG(mode):
        os.close(descriptor)
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(21, "Is a directory", str(path))
        raise RefusedFile("is not a regular file; copy what it gives into one")
    return os.fdopen(descriptor, "rb")


def budget_of(path: str | Path) -> ReadBudget:
    """Return the budget of a file by its size.

    Raises:
        RefusedFile: it is no regular file
        OSError: there is no such file, or it may not be read
    """
    with open_regular(path) as file:
        return ReadBudget(os.fstat(file.fileno()).st_size)


def read_regular(path: str | Path, max_bytes: int = MAX_ALLOWED_BYTES) -> bytes:
    """Read all bytes of a regular file of at most `max_bytes`.

    Raises:
        RefusedFile: it is no regular file, a larger one, or one that grows
        OSError: there is no such file, or it may not be read
    """
    with open_regular(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > max_bytes:
            raise RefusedFile(f"has more than {max_bytes / 1e6:.0f} MB, which is the most that is read of such a file")
        data = file.read(size + 1)  # not of `max_bytes`, which would be allocated at once
    if len(data) > size:
        raise RefusedFile("grows while it is read; read a copy of it")
    return data


def read_text(path: str | Path, max_bytes: int) -> str:
    """Read a text in UTF-8 of at most `max_bytes` from a regular file, with `\\n` at the end of each line, whatever ended it.

    Raises:
        RefusedFile: it is no regular file, a larger one, one that grows, or no text in UTF-8
        OSError: there is no such file, or it may not be read
    """
    try:
        text = read_regular(path, max_bytes).decode("utf-8-sig")
    except UnicodeError:
        raise RefusedFile("is not a text in UTF-8") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")
