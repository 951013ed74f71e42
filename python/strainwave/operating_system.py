"""Locks, owners of files and the end of processes, on Windows and on other systems."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

LOCK_POLL_SECONDS = 0.05  # between two attempts to get a lock

if sys.platform == "win32":
    import msvcrt
    from hashlib import sha256
    from tempfile import gettempdir

    MAX_LOCK_BYTES = 2**31 - 1  # that Windows locks by one call; more than the shards of any data set
    HAS_OWNERS = False  # numbers and modes of files do not show who may write to them
    READ_FLAGS = os.O_RDONLY | os.O_BINARY
    NO_LINK = 0

    def lock_bytes(descriptor: int, start: int, length: int) -> bool:
        """Lock bytes of a file, of length 0 all; False if they are locked already."""
        os.lseek(descriptor, start, os.SEEK_SET)
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, length or MAX_LOCK_BYTES)
        except OSError as error:  # of another kind: the file system has no locks
            return error.errno not in (errno.EACCES, errno.EDEADLK)
        return True

    def lock_file(descriptor: int, *, wait: bool = False) -> bool:
        """Lock a file; False if it is locked already, unless this call is to wait."""
        while not lock_bytes(descriptor, 0, 1):
            if not wait:
                return False
            time.sleep(LOCK_POLL_SECONDS)
        return True

    def _open_lock(folder: Path) -> int:
        """Open a file of this user that stands for a folder: folders have no locks, and in it the file would be a result."""
        name = sha256(os.path.normcase(os.path.realpath(folder)).encode()).hexdigest()
        return os.open(Path(gettempdir(), f"strainwave-{name}.lock"), os.O_RDWR | os.O_CREAT)

    def adopt(descriptor: int, found: os.stat_result) -> None:
        """Do nothing: a new file has the rights that its folder gives to all."""

    def user() -> int:
        """Return the number that all files have as their owner."""
        return 0

    def kill_group(pid: int) -> None:
        """End a process and those that it started."""
        subprocess.run(["taskkill", "/T", "/F", "/PID", str(pid)], capture_output=True, check=False)

    def limit_process(seconds: int, size: int) -> None:
        """Do nothing: Windows has no such limits of a process."""

    def is_orphan(parent: int) -> bool:
        """False: in a virtual environment the parent of a Python is another process than the one that started it."""
        return False

else:
    import fcntl
    import resource
    import signal

    HAS_OWNERS = True
    READ_FLAGS = os.O_RDONLY | os.O_NONBLOCK  # a FIFO does not make anybody wait
    NO_LINK = os.O_NOFOLLOW

    def lock_bytes(descriptor: int, start: int, length: int) -> bool:
        """Lock bytes of a file, of length 0 all; False if another process has locked some of them."""
        try:
            fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, length, start)
        except OSError:
            return False
        return True

    def lock_file(descriptor: int, *, wait: bool = False) -> bool:
        """Lock a file or folder; False if it is locked already, unless this call is to wait."""
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:  # the file system has no locks
            return True
        return True

    def _open_lock(folder: Path) -> int:
        return os.open(folder, os.O_RDONLY)

    def adopt(descriptor: int, found: os.stat_result) -> None:
        """Give a file the owner, as far as this process may, and the mode of another one."""
        with suppress(PermissionError):
            os.fchown(descriptor, found.st_uid, found.st_gid)
        os.fchmod(descriptor, stat.S_IMODE(found.st_mode))

    def user() -> int:
        """Return the number of the user to whom the files of this process belong."""
        return os.geteuid()

    def kill_group(pid: int) -> None:
        """End the process group of a process: that process and those that it started."""
        with suppress(ProcessLookupError):  # they have just ended
            os.killpg(pid, signal.SIGKILL)

    def limit_process(seconds: int, size: int) -> None:
        """Limit the processor time [s] and, but on macOS, the memory [bytes] of this process and of those that it starts."""
        for limit, wanted in ((resource.RLIMIT_CPU, seconds), (resource.RLIMIT_AS, size)):
            soft, hard = resource.getrlimit(limit)
            lowest = min(each for each in (soft, hard, wanted) if each != resource.RLIM_INFINITY)
            with suppress(ValueError, OSError):  # macOS refuses a limit of addresses
                resource.setrlimit(limit, (lowest, hard))

    def is_orphan(parent: int) -> bool:
        """True if the process that started this one, its parent, has ended."""
        return os.getppid() != parent


@contextmanager
def locked_folder(folder: Path, *, wait: bool) -> Iterator[None]:
    """Lock a folder, where its file system has locks. The lock ends with the process, however that ends.

    On Windows the lock keeps out processes of this user alone.

    Raises:
        BlockingIOError: another process has locked it, and this call is not to wait
    """
    descriptor = _open_lock(folder)
    try:
        if not lock_file(descriptor, wait=wait):
            raise BlockingIOError(f"{folder} is locked by another process")
        yield
    finally:
        os.close(descriptor)
