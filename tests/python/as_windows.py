"""Runs a script in a process that looks to strainwave like one of Windows.

    python -X warn_default_encoding as_windows.py script.py [arguments]

Modules and functions of POSIX are missing. Folders cannot be opened, and files that are open cannot be removed or replaced.
Locks are those of msvcrt, which exclude every other handle of a file. A text file opened without its encoding is an error.
"""

from __future__ import annotations

import fcntl
import importlib
import os
import runpy
import shutil
import struct
import sys
import types
import warnings
from errno import EACCES
from typing import Any

from threadpoolctl import ThreadpoolController

MODULES = "fcntl grp posix pty pwd resource syslog termios tty"
NAMES = """
    chown chroot fchmod fchown fork forkpty getegid geteuid getgid getgroups getloadavg getpgid getpgrp getsid getuid killpg
    lchown mkfifo mknod nice openpty sched_getaffinity sched_setaffinity setegid seteuid setgid setpgid setsid setuid sync
    sysconf uname wait3 wait4 O_CLOEXEC O_DIRECTORY O_NOFOLLOW O_NONBLOCK RTLD_NOW
"""
# Packages that look at the platform when they are imported.
OTHERS = """
    asyncio jinja2 matplotlib.font_manager packaging.requirements PIL.Image pyarrow.parquet pydantic rich.console
    scipy.signal typer
"""


def locking(descriptor: int, mode: int, length: int) -> None:
    """Lock bytes from the position of a handle on against all other handles, as `msvcrt.locking` does."""
    begin = os.lseek(descriptor, 0, os.SEEK_CUR)
    try:
        fcntl.fcntl(descriptor, fcntl.F_OFD_SETLK, struct.pack("hhqqi4x", fcntl.F_WRLCK, os.SEEK_SET, begin, length, 0))
    except BlockingIOError:
        raise PermissionError(EACCES, "Permission denied") from None


def forbid(event: str, arguments: tuple[Any, ...]) -> None:
    """Raise what Windows raises if a folder is opened, or a file that is open is removed or replaced."""
    if event == "open" and os.path.isdir(arguments[0]):
        raise PermissionError(EACCES, "Permission denied", arguments[0])
    for path in {"os.remove": arguments[:1], "os.rename": arguments[:2]}.get(event, ()):
        if os.path.isfile(path) and any(is_same(path, int(each)) for each in os.listdir("/proc/self/fd")):
            raise PermissionError(EACCES, "The process cannot access the file because it is being used", path)


def is_same(path: Any, descriptor: int) -> bool:
    try:
        return os.path.samestat(os.stat(path), os.fstat(descriptor))
    except OSError:  # it is closed
        return False


def main(script: str, *arguments: str) -> None:
    warnings.simplefilter("ignore", EncodingWarning)
    warnings.filterwarnings("error", category=EncodingWarning, module="strainwave")
    for name in OTHERS.split():
        importlib.import_module(name)
    for name in MODULES.split():
        sys.modules[name] = None  # type: ignore[assignment]
    for name in NAMES.split():
        if hasattr(os, name):
            delattr(os, name)
    vars(os)["O_BINARY"] = 0
    vars(shutil)["_use_fd_functions"] = False  # the library opens no folder on Windows
    sys.modules["msvcrt"] = msvcrt = types.ModuleType("msvcrt")
    vars(msvcrt).update(locking=locking, LK_NBLCK=2)
    ThreadpoolController._find_libraries_on_windows = lambda self: None  # by a library of Windows
    sys.platform = "win32"
    sys.addaudithook(forbid)
    sys.argv = [script, *arguments]
    runpy.run_path(script, run_name="__main__")


if __name__ == "__main__":
    main(*sys.argv[1:])
