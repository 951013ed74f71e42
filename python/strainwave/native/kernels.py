"""Kernels of drives: the source of one, when one is worth its compilation, and its use by every later run."""

from __future__ import annotations

import ctypes
import os
import sys
import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

from strainwave import Drive, _core, structure

if TYPE_CHECKING:
    from strainwave.native.kernel import Kernel

Job = Literal["simulate", "simulate_adaptively", "simulate_many", "differentiate", "inverse_dynamics"]
JOBS: tuple[Job, ...] = get_args(Job)
PUBLIC_JOBS = JOBS[:-1]  # inverse dynamics are of the rigid drives that `identify` makes
LOOK_UP_SECONDS = 0.04  # of the general drive: from then on a kernel that was compiled before is worth its look-up of some ms
SAVED_SHARE = 0.75  # of the general drive's time, at the least: a kernel takes a quarter of it, one of members less
# Time of a compilation, and of a step of the general drive (with four derivatives, or at an instant of inverse dynamics), as
# measured with the drive of the benchmarks on an AMD EPYC, November 2026: processor time of g++ 12 and of one thread.
COMPILE_SECONDS: dict[Job, float] = {
    "simulate": 2.9,
    "simulate_adaptively": 2.8,
    "simulate_many": 4.4,
    "differentiate": 3.4,
    "inverse_dynamics": 1.1,
}
STEP_SECONDS: dict[Job, float] = {
    "simulate": 2.2e-6,
    "simulate_adaptively": 8.1e-6,
    "simulate_many": 2.0e-6,
    "differentiate": 7.8e-6,
    "inverse_dynamics": 2.1e-6,
}
TYPICAL_STEPS = 10_000.0  # measured steps that count as much as the typical time of a step


@dataclass
class Work:
    """Work of the general drive in this process: steps and their time [s]."""

    steps: float = 0.0
    seconds: float = 0.0
    looked_up: bool = False

    def step_seconds(self, job: Job) -> float:
        """Return the estimated time of a step: as measured, or the typical time as long as few steps are measured."""
        return (self.seconds + TYPICAL_STEPS * STEP_SECONDS[job]) / (self.steps + TYPICAL_STEPS)


# What each job is in the table of a kernel, `strainwave::kernel::Table`.
ENTRIES: dict[Job, str] = {
    "simulate": "&Entries::simulate",
    "simulate_adaptively": "&Entries::simulate_adaptively",
    "simulate_many": "&Entries::run_members<strainwave::Pack<lanes>>",
    "differentiate": "&Entries::differentiate<strainwave::kernel::slopes>",
    "inverse_dynamics": "&Entries::inverse_dynamics<strainwave::kernel::slopes>",
}


def _core_on_disk() -> tuple[int, int, int]:
    """Return what an update of the package changes of the file of its extension."""
    found = os.stat(_core.__file__)
    return found.st_ino, found.st_size, found.st_mtime_ns


_CORE_IN_USE = _core_on_disk()
UPDATED = "strainwave was updated after this process had begun; restart the process"

_work: dict[tuple[tuple[int, ...], Job], Work] = defaultdict(Work)  # by laws
_clock = time.perf_counter


def source(drive: Drive, jobs: Sequence[Job]) -> str:
    """Return the C++ of a kernel that does these jobs for all drives with the laws of one."""
    from strainwave.native.static_type import static_type

    # To inline each stage of a step takes minutes where bodies move within the gear, and gains nothing there, nor for slopes.
    is_short = isinstance(drive.gear.structure, structure.Lumped) and not {"differentiate", "inverse_dynamics"} & {*jobs}
    inlining = "SW_INLINE_STEPS" if is_short else "SW_INLINE_RATES"
    entries = "".join(f",\n    {ENTRIES[job] if job in jobs else 'nullptr'}" for job in JOBS)
    return f"""#define {inlining}
#include <strainwave/kernel/entries.hpp>
#include <strainwave/models.hpp>

namespace {{
template <class S>
using Drive = {static_type(drive)};
using Entries = strainwave::kernel::Entries<strainwave::kernel::StaticDrives<Drive>>;
constexpr int lanes = strainwave::detail::register_width;
}}  // namespace

extern "C" __attribute__((visibility("default"))) const strainwave::kernel::Table strainwave_kernel{{lanes{entries}}};
"""


def kernel_of(drive: Drive, job: Job) -> Kernel:
    """Return the kernel that does a job for all drives with the laws of one."""
    from strainwave.native.kernel import Kernel
    from strainwave.native.static_type import in_words

    return Kernel(source(drive, [job]), job, in_words(drive))


def prepare(drive: Drive, job: Job, steps: float) -> None:
    """Load a kernel before a job of so many steps of the general drive, and compile it if that pays.

    It pays once the seconds that a kernel saves, of those the general drive has taken and is about to take in this process,
    exceed those of a compilation. The results are the same with and without a kernel. Without a compiler the general drive goes
    on, with one warning.
    """
    work = _work_of(drive, job)
    seconds = work.seconds + steps * work.step_seconds(job)
    if seconds < LOOK_UP_SECONDS or job in _core.loaded_jobs(drive):
        return
    worth_it = _pays(job, seconds)
    if worth_it or not work.looked_up:
        work.looked_up = True
        load(drive, job, compile_it=worth_it)


def pays(drive: Drive, job: Job, steps: float) -> bool:
    """True if a kernel saves more seconds of so many steps than its compilation takes."""
    return _pays(job, steps * _work_of(drive, job).step_seconds(job))


def _pays(job: Job, seconds: float) -> bool:
    return SAVED_SHARE * seconds >= COMPILE_SECONDS[job]


@contextmanager
def prepared(drive: Drive, job: Job, steps: float, to_come: float = 0.0) -> Iterator[None]:
    """Prepare a job of `steps` and those `to_come`, and measure the time of `steps`, unless a kernel takes them."""
    prepare(drive, job, steps + to_come)
    begin, by_kernel = _clock(), job in _core.loaded_jobs(drive)
    yield
    if not by_kernel:
        work = _work_of(drive, job)
        work.steps += steps
        work.seconds += _clock() - begin


def note(drive: Drive, job: Job, steps: float) -> None:
    """Count steps that a job took and that were not measured."""
    work = _work_of(drive, job)
    work.seconds, work.steps = work.seconds + steps * work.step_seconds(job), work.steps + steps


def forget_work() -> None:
    """Begin to count the steps of the general drive anew."""
    _work.clear()


def _work_of(drive: Drive, job: Job) -> Work:
    return _work[tuple(_core.parts(drive)[0]), job]


def load(drive: Drive, job: Job, *, compile_it: bool) -> bool:
    """True if a kernel does this job from now on: one compiled before, or else compiled now."""
    from strainwave.native.cache import find_kernel, kernel_file, warn_once

    if _is_updated():
        warn_once(UPDATED)
        return False
    kernel = kernel_of(drive, job)
    announcement = f"strainwave: compiling a kernel of this drive for {job}, once; it takes some seconds"
    path = kernel_file(kernel, lambda: print(announcement, file=sys.stderr)) if compile_it else find_kernel(kernel)
    if path is None:
        return False
    try:
        use(drive, path)
    except (OSError, ValueError) as error:  # a file system that runs no code, or a symbol that is missing
        warn_once(f"{path} cannot be loaded: {error}")
        return False
    return True


def load_or_raise(drive: Drive, job: Job) -> None:
    """Load the kernel of a job, compiled now if it was not before.

    Raises:
        OSError: there is no compiler, it reports an error, or the cache or the kernel cannot be used
    """
    from strainwave.native.cache import find_kernel, make_kernel

    if _is_updated():
        raise OSError(UPDATED)
    kernel = kernel_of(drive, job)
    use(drive, find_kernel(kernel) or make_kernel(kernel))


def _is_updated() -> bool:
    """True if the package was replaced: kernels of its new headers would not fit the extension in use."""
    return _core_on_disk() != _CORE_IN_USE


def use(drive: Drive, path: Path) -> None:
    """Load a shared object, and do its jobs by it for drives with the laws of one."""
    table = ctypes.c_char.in_dll(ctypes.CDLL(str(path)), "strainwave_kernel")
    _core.add_kernel(drive, ctypes.addressof(table))
