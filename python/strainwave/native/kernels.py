"""Kernels of drives: the source of one, when one is worth its compilation, and its use by every later run."""

from __future__ import annotations

import ctypes
import sys
from collections import defaultdict
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, get_args

from strainwave import Drive, _core

if TYPE_CHECKING:
    from strainwave.native.kernel import Kernel

Job = Literal["simulate", "simulate_adaptively", "simulate_many", "differentiate"]
JOBS: tuple[Job, ...] = get_args(Job)
LOOK_UP_STEPS = 20_000  # of the general drive: from then on a kernel that was compiled before is worth its look-up of some ms
COMPILE_STEPS = 4_000_000  # of the general drive, some 6 to 10 s: several times what a compilation takes
ADAPTIVE_STEPS = 3  # of the general drive that take as long as one whose error is estimated
DERIVATIVE_STEPS = 3  # of the general drive that take as long as one with four derivatives

# What each job is in the table of a kernel, `strainwave::kernel::Table`.
ENTRIES: dict[Job, str] = {
    "simulate": "&Entries::simulate",
    "simulate_adaptively": "&Entries::simulate_adaptively",
    "simulate_many": "&Entries::run_members<strainwave::Pack<lanes>>",
    "differentiate": "&Entries::differentiate<strainwave::kernel::slopes>",
}

_steps_taken: dict[tuple[tuple[int, ...], Job], float] = defaultdict(float)  # by the general drive in this process, by laws


def source(drive: Drive, jobs: Sequence[Job]) -> str:
    """Return the C++ of a kernel that does these jobs for all drives with the laws of one."""
    from strainwave.native.static_type import static_type

    entries = "".join(f",\n    {ENTRIES[job] if job in jobs else 'nullptr'}" for job in JOBS)
    return f"""#define SW_KERNEL
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

    It pays once the general drive has taken or is about to take several times as long, in this process. The results are the
    same with and without a kernel. Without a compiler the general drive goes on, with one warning.
    """
    laws = tuple(_core.parts(drive)[0])
    before = _steps_taken[laws, job]
    total = _steps_taken[laws, job] = before + steps
    if total < LOOK_UP_STEPS or job in _core.loaded_jobs(drive):
        return
    worth_it = total >= COMPILE_STEPS
    if worth_it or before < LOOK_UP_STEPS:
        load(drive, job, compile_it=worth_it)


def note(drive: Drive, job: Job, steps: float) -> None:
    """Count steps that the general drive has taken for a job, beyond those that `prepare` was told."""
    _steps_taken[tuple(_core.parts(drive)[0]), job] += steps


def load(drive: Drive, job: Job, *, compile_it: bool) -> bool:
    """True if a kernel does this job from now on: one compiled before, or else compiled now."""
    from strainwave.native.cache import find_kernel, kernel_file

    kernel = kernel_of(drive, job)
    path = find_kernel(kernel)
    if path is None and compile_it:
        print(f"strainwave: compiling a kernel of this drive for {job}, once; it takes some seconds", file=sys.stderr)
        path = kernel_file(kernel)
    if path is None:
        return False
    table = ctypes.c_char.in_dll(ctypes.CDLL(str(path)), "strainwave_kernel")
    _core.add_kernel(drive, ctypes.addressof(table))
    return True
