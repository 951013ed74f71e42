"""Atomic writing of files: whole or not there at all. docs/reference/files.md states the guarantees."""

from __future__ import annotations

import os
import signal
import stat
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO
from uuid import uuid4

from strainwave.messages import one_line
from strainwave.operating_system import adopt, locked_folder

DRAFT_PREFIX = ".strainwave-"  # beginning of the names of files that are still being written
written: list[Path] = []  # folders and files with results of this process' command, listed at an interrupt


@contextmanager
def replacing(path: str | Path) -> Iterator[BinaryIO]:
    """A file to write, which takes the place of `path` once it is complete; nothing is lost when writing fails.

    A link is followed. A device or a FIFO is written to as it is.

    Raises:
        OSError: the file cannot be written; the message names it and the reason

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with replacing(Path(folder, "note.txt")) as file:
    ...         _ = file.write(b"done")
    ...     Path(folder, "note.txt").read_text()
    'done'
    """
    with _named(path), _draft(Path(path)) as draft:
        yield draft.file
        draft.complete()
        draft.put()


def write_all(contents: Mapping[Path, str | bytes]) -> None:
    """Write texts or bytes to files, all or none: all are complete under other names before the first replaces its target.

    Who else writes to the same folders in this way waits, so that the files of two writers are not mixed.

    Raises:
        OSError: a file cannot be written; the message names it and the reason
    """
    with ExitStack() as stack:
        drafts = {}
        for path, content in contents.items():
            with _named(path):
                drafts[path] = stack.enter_context(_draft(path))
                drafts[path].file.write(content.encode() if isinstance(content, str) else content)
                drafts[path].complete()
        for folder in sorted({path.parent.resolve() for path in contents}):
            stack.enter_context(locked_folder(folder, wait=True))
        for path, draft in drafts.items():
            with _named(path):
                draft.put()


def write_folder(folder: Path, contents: Mapping[str, str | bytes]) -> None:
    """Write the results of a command to files in a folder, all or none; an interrupt waits until they are there.

    Args:
        folder: made if it is not there
        contents: by the path of the file in the folder

    Raises:
        OSError: folder or file cannot be written; the message names it and the reason
    """
    heeded = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        paths = {folder / name: content for name, content in contents.items()}
        with ExitStack() as stack:
            for each in sorted({folder, *(path.parent for path in paths)}):
                stack.enter_context(making(each))
            write_all(paths)
        written.append(folder)
    finally:
        signal.signal(signal.SIGINT, heeded)


@contextmanager
def making(folder: Path) -> Iterator[None]:
    """Make a folder and those above it; those that it made are taken away again where what follows fails.

    Raises:
        OSError: the folder cannot be made; the message gives the reason
    """
    new: list[Path] = []
    try:
        try:
            _check_name(folder)
            new += [each for each in (folder, *folder.parents) if not os.path.lexists(each)]
            folder.mkdir(parents=True, exist_ok=True)
        except FileExistsError:
            raise FileExistsError(one_line(f"{folder} is a file where a folder is to be made; give another name")) from None
        except OSError as error:
            raise _explained(f"{folder} cannot be made", error) from None
        yield
    except BaseException:
        for each in new:
            with suppress(OSError):  # somebody else has put something there
                each.rmdir()
        raise


@contextmanager
def claiming(folder: Path) -> Iterator[None]:
    """Keeps others who claim it out of a folder, until this process ends, however it ends.

    Raises:
        BlockingIOError: another one has claimed it
    """
    with ExitStack() as stack:
        try:
            stack.enter_context(locked_folder(folder, wait=False))
        except BlockingIOError:
            raise BlockingIOError(f"{folder} is being written by another process; wait until it ends") from None
        yield


def remove_drafts(folder: Path) -> None:
    """Removes what processes that were killed left in a folder, which nobody else may be writing to."""
    for draft in folder.glob(f"{DRAFT_PREFIX}*"):
        draft.unlink(missing_ok=True)


@dataclass(frozen=True)
class _Draft:
    """A file that is written under another name in its folder."""

    file: BinaryIO
    target: Path

    def complete(self) -> None:
        """All of it is on the disk."""
        self.file.flush()
        os.fsync(self.file.fileno())
        self.file.close()

    def put(self) -> None:
        os.replace(self.file.name, self.target)
        with suppress(OSError), _opened(self.target.parent) as descriptor:  # not every file system can
            os.fsync(descriptor)


@dataclass(frozen=True)
class _Through:
    """Writer that passes bytes on as they come."""

    file: BinaryIO

    def complete(self) -> None:
        self.file.close()

    def put(self) -> None:
        """Do nothing: the bytes are already in place."""


@contextmanager
def _draft(path: Path) -> Iterator[_Draft | _Through]:
    _check_name(path)
    target = Path(os.path.realpath(path))
    try:
        status = os.stat(path)
    except FileNotFoundError:
        status = None
        if not target.parent.is_dir():
            raise FileNotFoundError(f"there is no folder {target.parent if path.is_symlink() else path.parent}") from None
    if status is not None and (stream := _stream(path, status)) is not None:
        with stream:
            yield _Through(stream)
        return
    if status is not None and not os.access(target, os.W_OK):
        raise PermissionError("it is read-only")
    draft = _open_beside(target)
    try:
        with draft as file:  # closed before it is removed, as Windows removes no open file
            if status is not None:
                adopt(file.fileno(), status)
            yield _Draft(file, target)
    finally:
        Path(draft.name).unlink(missing_ok=True)


def _check_name(path: Path) -> None:
    try:
        os.fsencode(path)
    except UnicodeEncodeError:
        raise OSError("no file can have this name") from None


def _stream(path: Path, found: os.stat_result) -> BinaryIO | None:
    """Open a device or FIFO at a path for writing; None if the path is a regular file."""
    for descriptor in (1, 2):  # a shell's redirection must not be replaced under its hands
        with suppress(OSError):  # closed
            if os.path.samestat(found, os.fstat(descriptor)):
                return os.fdopen(os.dup(descriptor), "wb")
    if stat.S_ISDIR(found.st_mode):
        raise IsADirectoryError("it is a folder")
    if stat.S_ISCHR(found.st_mode) or stat.S_ISFIFO(found.st_mode):
        return path.open("wb")
    if not stat.S_ISREG(found.st_mode):
        raise OSError("it is no regular file, no character device and no FIFO")
    return None


def _open_beside(target: Path) -> BinaryIO:
    try:
        return target.with_name(f"{DRAFT_PREFIX}{uuid4().hex}").open("xb")
    except PermissionError:
        raise PermissionError(f"no file can be made in {target.parent}, as permission is denied") from None


@contextmanager
def _opened(folder: Path) -> Iterator[int]:
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


@contextmanager
def _named(path: str | Path) -> Iterator[None]:
    """Add the name of the file to an error of writing."""
    try:
        yield
    except OSError as error:
        raise _explained(f"{path} cannot be written", error) from None


def _explained(what: str, error: OSError) -> OSError:
    explained = type(error)(one_line(f"{what}: {error.strerror or error}"))
    explained.errno = error.errno  # for a caller that reads it: the message stays as it is
    return explained
