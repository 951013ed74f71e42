"""Files of a folder. Symbolic links are named and not followed."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection
from pathlib import Path
from typing import NamedTuple

from strainwave.files.budget import MAX_DEPTH
from strainwave.messages import one_line, quoted

MAX_ENTRIES = 20_000  # files and folders below one folder
LINK_NOT_FOLLOWED = "it is a symbolic link in a folder, which is not followed; name the file itself"


class FolderFiles(NamedTuple):
    """Files below a folder, sorted, and the symbolic links among them."""

    files: list[Path]
    links: list[Path]


def files_below(folder: Path, suffixes: Collection[str], accepts: Callable[[Path], bool] = lambda path: False) -> FolderFiles:
    """Return the regular files with given suffixes in a folder and in the folders below it.

    Args:
        folder: the folder, which may be a link itself
        suffixes: in small letters, as `.csv`
        accepts: True for a file that is taken although it has none of these suffixes

    Raises:
        ValueError: the folder has more than 20 000 entries, or is nested more than 64 deep
        OSError: a folder cannot be read
    """
    files, links = list[Path](), list[Path]()
    folders, count = [(folder, 0)], 0
    while folders:
        here, depth = folders.pop()
        with os.scandir(here) as entries:
            for entry in entries:
                count += 1
                if count > MAX_ENTRIES or depth > MAX_DEPTH:
                    limits = f"more than {MAX_ENTRIES} files, or is nested more than {MAX_DEPTH} deep"
                    raise ValueError(one_line(f"{folder} contains {limits}; name the files themselves"))
                if entry.is_dir(follow_symlinks=False):
                    folders.append((Path(entry), depth + 1))
                elif entry.is_symlink() and (Path(entry).suffix.lower() in suffixes or entry.is_dir()):
                    links.append(Path(entry))
                elif entry.is_file(follow_symlinks=False) and (Path(entry).suffix.lower() in suffixes or accepts(Path(entry))):
                    files.append(Path(entry))
    return FolderFiles(sorted(files), sorted(links))


def inside(folder: Path, name: str) -> Path:
    """Return the path of a file that is named relative to a folder and lies in it, links resolved.

    Raises:
        ValueError: it lies elsewhere

    >>> inside(Path("."), "../secret.png")
    Traceback (most recent call last):
    ValueError: "../secret.png" does not lie in the folder .; copy it there
    """
    path = folder / name
    try:
        within = path.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # a loop of links
        within = False
    if not within:
        raise ValueError(one_line(f"{quoted(name)} does not lie in the folder {folder}; copy it there"))
    return path
