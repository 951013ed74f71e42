"""Kernels that were compiled before, shipped or by this user, and how one that is missing is compiled."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable, Iterable
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

from strainwave import _core
from strainwave.messages import one_line
from strainwave.native import folder as store
from strainwave.native.compilers import MAX_COMPILE_SECONDS, Compiler, candidates, find_compiler, flags_for
from strainwave.native.folder import Record, cache_folder
from strainwave.native.kernel import INCLUDE_FOLDER, Kernel
from strainwave.native.private import check_private, make_private
from strainwave.operating_system import user

_failed: set[Kernel] = set()  # in this process: none is tried again
_warned: set[str] = set()  # in this process: each reason is given once


class KernelWarning(UserWarning):
    """Kernels are not used, for the reason given; the general code gives the same numbers, more slowly.

    >>> import warnings
    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", sw.native.KernelWarning)  # on a machine without a compiler
    ...     run = sw.simulate(drive, sw.scenario.step(5.0, duration=0.1))
    """


def kernel_file(kernel: Kernel, announce: Callable[[], None] = lambda: None) -> Path | None:
    """Return the shared object of a kernel, which is compiled if it is missing; None, with a warning, if that is impossible.

    None without a warning if the environment variable STRAINWAVE_KERNELS is `off`, and on Windows.

    Args:
        kernel: what to compile
        announce: called before a compilation
    """
    if cache_folder() is None or kernel in _failed:
        return None
    found = find_kernel(kernel)
    if found is None:
        found = _or_warning(lambda: make_kernel(kernel, announce))
    if found is None:
        _failed.add(kernel)
    return found


def find_kernel(kernel: Kernel) -> Path | None:
    """Return the shared object of a kernel, shipped or compiled before; None if there is none. Nothing is compiled.

    A kernel that is damaged, or that another user could have written, is not used; strainwave warns once.
    """
    folder = cache_folder()
    if folder is None:
        return None
    return _or_warning(lambda: _shipped(kernel)) or _or_warning(lambda: _cached(folder, kernel, candidates()))


def make_kernel(kernel: Kernel, announce: Callable[[], None] = lambda: None) -> Path:
    """Return the shared object of a kernel, compiled by the first compiler of this machine, and put into the cache.

    Another process that makes the same kernel is waited for.

    Args:
        kernel: what to compile
        announce: called before the compilation

    Raises:
        NoCompilerError: there is no compiler
        CompileError: the compiler reports an error, or takes too long
        OSError: the cache cannot be written, or no kernel is used
    """
    folder, compiler = cache_folder(), find_compiler()
    if folder is None:
        raise OSError(f"no kernel is compiled: {store.reason_without_kernels()}")
    make_private(folder)
    key = kernel.key(compiler)
    with store.alone(folder, key, MAX_COMPILE_SECONDS):
        found = _or_warning(lambda: _cached(folder, kernel, [compiler]))
        if found is None:
            announce()
            found = _compile(kernel, compiler, folder, key, _core.instruction_set())
            store.tidy(folder, keep=key)
    return found


def ship(kernel: Kernel, folder: Path, instruction_set: str) -> Path:
    """Compile a kernel into a folder that a wheel carries, for an instruction set, and return its path.

    Raises:
        OSError: as of `make_kernel`
    """
    return _compile(kernel, find_compiler(), folder, kernel.shipped_key(instruction_set), instruction_set)


def listing() -> list[Record]:
    """Return the records of the kernels in the user's cache, the most recently used first.

    Raises:
        OSError: another user could have written to the cache
    """
    folder = _existing()
    return [] if folder is None else list(store.records(folder).values())


def clear() -> int:
    """Remove all kernels from the user's cache, and return their number.

    Raises:
        OSError: another user could have written to the cache
    """
    folder = _existing()
    return 0 if folder is None else store.clear(folder)


def _shipped(kernel: Kernel) -> Path | None:
    """Return the kernel that the package carries; whoever could change the package itself may have written it."""
    if not store.SHIPPED_KERNELS.is_dir():
        return None
    owners = {user(), 0, Path(_core.__file__).stat().st_uid}
    return store.read(store.SHIPPED_KERNELS, kernel.shipped_key(), owners)


def _cached(folder: Path, kernel: Kernel, compilers: Iterable[Compiler]) -> Path | None:
    """Return what one of these compilers made of a kernel before."""
    if not os.path.lexists(folder):
        return None
    check_private(folder)
    for compiler in compilers:
        if path := store.read(folder, kernel.key(compiler), {user()}):
            with suppress(OSError):  # a read-only file system
                os.utime(path)  # the least recently used are removed first
            return path
    return None


def _compile(kernel: Kernel, compiler: Compiler, folder: Path, key: str, instruction_set: str) -> Path:
    """Compile a kernel into a folder under a key, for an instruction set, and return its path."""
    began = time.perf_counter()
    with store.draft(folder) as draft:
        source = draft / "kernel.cpp"
        source.write_text(kernel.source, "utf-8")
        shared = compiler.build(source, (*flags_for(instruction_set), f"-I{INCLUDE_FOLDER}"))
        content = shared.read_bytes()
    seconds = time.perf_counter() - began
    record = Record(kernel.drive, kernel.job, compiler.name, seconds, time.time(), len(content), sha256(content).hexdigest())
    return store.write(folder, key, content, record)


def _existing() -> Path | None:
    """Return the folder of the cache if there is one that nobody else could have written to."""
    folder = cache_folder()
    if folder is None or not os.path.lexists(folder):
        return None
    check_private(folder)
    return folder


def _or_warning(action: Callable[[], Path | None]) -> Path | None:
    """Return what an action returns; None, with a warning the first time, if it fails."""
    try:
        return action()
    except OSError as error:
        reason = one_line(f"{error.strerror}: {cache_folder()}" if error.strerror else str(error))
    warn_once(reason)
    return None


def warn_once(reason: str) -> None:
    """Warn that no kernel is used, and why; of each reason once in a process."""
    if reason not in _warned:
        _warned.add(reason)
        warnings.warn(f"runs take longer, because no kernel is used: {reason}", KernelWarning, stacklevel=2)
