"""Folders of kernels: where they are, and how a compiled kernel and its record lie there under one key."""

from __future__ import annotations

import json
import os
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

from strainwave import _core
from strainwave.files.writing import DRAFT_PREFIX, replacing
from strainwave.native.private import content_of
from strainwave.operating_system import HAS_OWNERS, LOCK_POLL_SECONDS, NO_LINK, lock_file, user

VARIABLE = "STRAINWAVE_KERNELS"  # environment variable: `off`, or the folder of the cache
OFF = "off"
PREFIX = "strainwave-"  # of the files of kernels: the user's folder may contain other files
MAX_RECORD_NUMBER = 1e15  # of bytes or seconds: what is larger is no number of a kernel
MAX_CACHE_BYTES = 256_000_000  # of all kernels in the cache
MAX_DRAFT_SECONDS = 86_400.0  # age of what a killed process left, after which it is removed
SHIPPED_KERNELS = Path(_core.__file__).parent / "kernels"  # folder


@dataclass(frozen=True)
class Record:
    """The record of a compiled kernel.

    Args:
        drive: its models in words
        job: what it does, as in `strainwave.native.kernels.JOBS`
        compiler: its name
        seconds: that the compilation took [s]
        made: when, as seconds since 1970 [s]
        size: of the file [byte]
        sha256: digest of the file
    """

    drive: str
    job: str
    compiler: str
    seconds: float
    made: float
    size: int
    sha256: str


def reason_without_kernels() -> str:
    """Return why no kernel is used; empty if kernels are used.

    On Windows no kernel is used. A kernel is loaded into the process, so that nobody else may have written its file; owners and
    modes of files do not show that there. The general drive gives the same numbers, more slowly.
    """
    if not HAS_OWNERS:
        return "there are none on Windows; the general code gives the same numbers"
    return f"they are switched off by {VARIABLE}" if os.environ.get(VARIABLE) == OFF else ""


def cache_folder() -> Path | None:
    """Return the folder of the user's kernels, which may not exist; None if no kernel is used.

    Raises:
        ValueError: the environment variable is neither `off` nor an absolute path
    """
    if reason_without_kernels():
        return None
    chosen = os.environ.get(VARIABLE, "")
    if chosen and not os.path.isabs(chosen):
        raise ValueError(f'{VARIABLE} = "{chosen}" must be {OFF} or an absolute path')
    return Path(chosen) if chosen else _user_cache() / "strainwave" / "kernels"


def read(folder: Path, key: str, owners: set[int]) -> Path | None:
    """Return the file of a kernel whose bytes are those of its record; None if one of the two is missing.

    Raises:
        OSError: the file or its record is damaged, or somebody else than the owners could have written it
    """
    path = _path(folder, key)
    if not (os.path.lexists(path) and os.path.lexists(_record_path(folder, key))):  # the record is written last
        return None
    record, content = _record(folder, key, owners), content_of(path, owners)
    if sha256(content).hexdigest() != record.sha256:
        raise OSError(f"{path} is damaged: its bytes are not those of its record; it is not used")
    return path


def write(folder: Path, key: str, content: bytes, record: Record) -> Path:
    """Store a compiled kernel and its record, and return its path.

    Raises:
        OSError: it cannot be written
    """
    path = _path(folder, key)
    # The record completes the kernel: a process killed between the two leaves one that is not used.
    for target, part in ((path, content), (_record_path(folder, key), json.dumps(asdict(record)).encode())):
        target.unlink(missing_ok=True)  # or the new file would have the owner and the mode of the old one
        with replacing(target) as file:
            os.chmod(file.fileno(), 0o600)
            file.write(part)
    return path


def records(folder: Path) -> dict[str, Record]:
    """Return the records of all kernels in a folder that are complete, by their keys, the most recently used first."""
    found = {}
    for path in sorted(_kernels(folder), key=_last_used, reverse=True):
        key = path.stem.removeprefix(PREFIX)
        with suppress(OSError):
            found[key] = _record(folder, key, {user()})
    return found


def clear(folder: Path) -> int:
    """Remove all kernels of a folder, and what killed processes left; return the number of kernels."""
    kernels = _kernels(folder)
    for path in kernels:
        _remove(path)
    _remove_drafts(folder, older_than=0.0)
    return len(kernels)


def tidy(folder: Path, keep: str) -> None:
    """Remove what killed processes left, and the least recently used kernels but one beyond `MAX_CACHE_BYTES`."""
    _remove_drafts(folder, MAX_DRAFT_SECONDS)
    total = 0
    kept = _path(folder, keep)
    for path in sorted(_kernels(folder), key=lambda path: (path == kept, _last_used(path)), reverse=True):
        with suppress(OSError):  # another process is removing it
            total += path.stat().st_size
        if total > MAX_CACHE_BYTES and path != kept:
            _remove(path)


@contextmanager
def draft(folder: Path) -> Iterator[Path]:
    """Make a folder for the files of one compilation in the folder of the kernels, and remove it."""
    with TemporaryDirectory(prefix=DRAFT_PREFIX, dir=folder, ignore_cleanup_errors=True) as name:
        yield Path(name)


@contextmanager
def alone(folder: Path, key: str, max_wait: float) -> Iterator[None]:
    """Wait until no other process makes the kernel of a key, and keep others waiting. The lock ends with its process.

    Args:
        folder: of the kernels
        key: of the kernel
        max_wait: after which both make it, which is no harm [s]
    """
    path = folder / f"{DRAFT_PREFIX}{key}.lock"
    with ExitStack() as stack:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | NO_LINK, 0o600)
        stack.callback(os.close, descriptor)
        deadline = time.monotonic() + max_wait
        while not lock_file(descriptor) and time.monotonic() < deadline:
            time.sleep(LOCK_POLL_SECONDS)
        stack.callback(path.unlink, missing_ok=True)
        yield


def _user_cache() -> Path:
    """Return the folder in which this platform keeps a user's caches."""
    chosen = os.environ.get("XDG_CACHE_HOME", "")
    if os.path.isabs(chosen):
        return Path(chosen)
    return Path(os.path.expanduser("~/Library/Caches" if sys.platform == "darwin" else "~/.cache"))


def _path(folder: Path, key: str) -> Path:
    return folder / f"{PREFIX}{key}.so"


def _record_path(folder: Path, key: str) -> Path:
    return folder / f"{PREFIX}{key}.json"


def _kernels(folder: Path) -> list[Path]:
    return list(folder.glob(f"{PREFIX}*.so"))


def _record(folder: Path, key: str, owners: set[int]) -> Record:
    path = _record_path(folder, key)
    try:
        read = json.loads(content_of(path, owners))
        numbers = {name: float(read[name]) for name in ("seconds", "made", "size")}
        if not all(0.0 <= number <= MAX_RECORD_NUMBER for number in numbers.values()):
            raise ValueError
        texts = {name: str(read[name]) for name in ("drive", "job", "compiler", "sha256")}
        return Record(**texts, seconds=numbers["seconds"], made=numbers["made"], size=int(numbers["size"]))
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
        raise OSError(f"{path} is damaged: it is no record of a kernel; the kernel is not used") from None


def _last_used(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:  # another process has just removed it
        return 0.0


def _remove(path: Path) -> None:
    for each in (path, path.with_suffix(".json")):
        each.unlink(missing_ok=True)


def _remove_drafts(folder: Path, older_than: float) -> None:
    """Remove drafts and locks of an age [s] that no compilation reaches."""
    for path in folder.glob(f"{DRAFT_PREFIX}*"):
        if time.time() - _last_used(path) >= older_than:
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)
