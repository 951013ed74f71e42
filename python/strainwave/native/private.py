"""Files and folders that nobody but this user could have changed: only such are loaded into the process."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from strainwave.operating_system import NO_LINK, READ_FLAGS, user


def check_private(folder: Path) -> None:
    """Check that no other user could have put a file into a folder.

    Raises:
        OSError: somebody could, or the folder is a link, no folder or not there
    """
    found = folder.lstat()
    if stat.S_ISLNK(found.st_mode):
        raise PermissionError(f"{folder} is a link; set STRAINWAVE_KERNELS to the folder itself")
    if not stat.S_ISDIR(found.st_mode):
        raise NotADirectoryError(f"{folder} is no folder; remove it, or set STRAINWAVE_KERNELS to another one")
    _check_writers(folder, found, {user()})
    _check_above(folder)


def make_private(folder: Path) -> None:
    """Make a folder, and those above it that are missing, for this user alone.

    Raises:
        OSError: that is impossible, or another user could put a file into it
    """
    if not os.path.lexists(folder):
        _check_above(folder)
        for each in (*reversed(folder.parents), folder):
            each.mkdir(mode=0o700, exist_ok=True)
    check_private(folder)


def content_of(path: Path, owners: set[int]) -> bytes:
    """Return the bytes of a regular file that nobody but its owner, one of these, could have written."""
    with open(os.open(path, READ_FLAGS | NO_LINK), "rb") as file:  # a link is an error
        found = os.fstat(file.fileno())
        if not stat.S_ISREG(found.st_mode):
            raise OSError(f"{path} is no regular file; it is not used")
        _check_writers(path, found, owners)
        return file.read()


def _check_above(folder: Path) -> None:
    """Check that no other user could exchange a folder, or make it first."""
    for above in folder.resolve().parents:
        if above.exists():
            _check_writers(above, above.stat(), _administrators() | {user()})


def _check_writers(path: Path, found: os.stat_result, owners: set[int]) -> None:
    """Check that a file or folder belongs to one of these users, and that nobody else may write to it.

    In a folder with the sticky bit, as /tmp, nobody can exchange what belongs to others. A group with the number of the user
    is the user's own.
    """
    if found.st_uid not in owners:
        raise PermissionError(f"{path} belongs to another user ({found.st_uid}), who could change kernels; none there is used")
    of_others = stat.S_IWOTH | (stat.S_IWGRP if found.st_gid != found.st_uid else 0)
    is_sticky = stat.S_ISDIR(found.st_mode) and found.st_mode & stat.S_ISVTX
    if found.st_mode & of_others and not is_sticky:
        raise PermissionError(f"other users may write to {path} and change kernels; `chmod go-w {path}` forbids it")


def _administrators() -> set[int]:
    """Return root, which within a user namespace may have another number."""
    return {0, Path("/").stat().st_uid}
