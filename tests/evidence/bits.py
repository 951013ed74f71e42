"""The bits of many runs, to compare before and after a change that must not alter them.

    python -m tests.evidence.bits write bits.txt                 before the change
    python -m tests.evidence.bits compare bits.txt               after it
    python -m tests.evidence.bits kernels --drives 200           the general drive and kernels, which must give the same

Random drives of all models, as those of `tests.evidence.stress`: each run by every method, to a tolerance, in a pack of eight,
and with derivatives. What is refused must be refused again. The file has a digest of each run; nobody needs to keep it.
"""

from __future__ import annotations

import argparse
import hashlib
import math
import sys
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from strainwave import _core
from strainwave.native import kernels
from strainwave.native.cache import find_kernel, make_kernel
from strainwave.native.kernel import Kernel
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.run import METHOD_WORDS, differentiate
from strainwave.simulation.signals import outputs

from tests.evidence.stress import MOST_STEPS, STEPS, acting_on, model, neighbours, step
from tests.support.workers import answers

DERIVATIVES = 12
LIMIT = 120.0  # s, for all runs of a drive
EVERY = 8  # drives of which one is compiled in both ways
KERNEL_LIMIT = 600.0  # s, with its kernels compiled
MAX_PHASE_PER_STEP = 0.4  # rad of the fastest vibration, so that fewer runs are refused, of which kernels take no step
MIN_STEP = 1e-8  # s, which resolves no drive that is faster


def digest(number: int, max_phase: float = math.inf) -> dict[str, str]:
    """Of each run of a drive, in steps of at most a phase [rad] of its fastest vibration."""
    warnings.simplefilter("ignore")
    random = np.random.default_rng(number)
    drive = model(sw.Drive, random)
    dt = min(step(drive, random), max(max_phase / max(_core.max_rate(drive, 0.0), 1.0), MIN_STEP))
    volts = sw.scenario.sine(random.uniform(0.0, 48.0), random.uniform(0.5, 5.0) / (STEPS * dt), STEPS * dt)
    acting: dict[str, Any] = {"inputs": acting_on(drive, random)}
    varied, sample = neighbours(drive, random), 5.0 * dt
    count = min(DERIVATIVES, len(_core.parameters(drive)))
    free = sorted(random.choice(len(_core.parameters(drive)), count, replace=False).tolist())
    course: dict[str, Any] = {"sample": sample, **acting}
    runs: dict[str, Callable[[], Any]] = {
        method: partial(sw.simulate, drive, volts, dt, method=method, **course) for method in METHOD_WORDS
    }
    runs["adaptive"] = partial(sw.simulate_adaptively, drive, volts, 1e-5, max_steps=MOST_STEPS, **course)
    runs["many"] = partial(sw.simulate_many, drive, volts, varied, dt, record=list(outputs(drive)), **course)
    runs["derivatives"] = partial(differentiate, drive, Excitation(volts), free, dt, sample)
    return {kind: bits(run) for kind, run in runs.items()}


def digest_by_kernel(number: int) -> dict[str, str]:
    """Of each run of a drive that differs by its kernels; empty if none does."""
    drive = model(sw.Drive, np.random.default_rng(number))
    _core.forget_kernels(drive)
    expected = digest(number, MAX_PHASE_PER_STEP)
    runs = [job for job in kernels.JOBS if job.startswith("simulate")]
    # Alone, runs are compiled in another way than beside derivatives, which takes several times as long.
    for jobs in [kernels.JOBS, runs] if number % EVERY == 0 else [kernels.JOBS]:
        kernel = Kernel(kernels.source(drive, jobs), " ".join(jobs), str(number))
        kernels.use(drive, find_kernel(kernel) or make_kernel(kernel))
    found = digest(number, MAX_PHASE_PER_STEP)
    return {kind: f"{expected[kind]}, by its kernel {found[kind]}" for kind in found if found[kind] != expected[kind]}


def bits(run: Callable[[], Any]) -> str:
    try:
        found = run()
    except (ValueError, FloatingPointError, RuntimeError) as error:
        return f"refused: {type(error).__name__}"
    return hashlib.sha256(b"".join(comparable(array).tobytes() for array in arrays(found))).hexdigest()[:16]


def comparable(array: Any) -> Any:
    """An array whose bytes are equal where its numbers are: one zero, and one that is no number."""
    numbers = np.ascontiguousarray(array) + 0.0
    return np.where(np.isnan(numbers), np.nan, numbers)


def arrays(found: Any) -> Iterator[Any]:
    """The numbers of a result, in order."""
    if isinstance(found, tuple):
        for one in found:
            yield from arrays(one)
    elif isinstance(found, np.ndarray):
        yield found
    else:
        yield from found.columns.values()


def differences(drives: int, processes: int) -> Iterator[str]:
    """What kernels do to the bits of random drives."""
    for number, found in answers(digest_by_kernel, range(drives), processes, KERNEL_LIMIT):
        if not isinstance(found, dict):
            yield f"{number}: {found}"
        else:
            yield from (f"{number} {kind}: {value}" for kind, value in found.items())
        if number % 20 == 19:
            print(f"{number + 1} drives", file=sys.stderr, flush=True)


def lines(drives: int, processes: int) -> Iterator[str]:
    for number, found in answers(digest, range(drives), processes, LIMIT):
        kinds = found if isinstance(found, dict) else {"all": "no answer"}
        yield from (f"{number} {kind} {value}" for kind, value in kinds.items())


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("verb", choices=["write", "compare", "kernels"])
    options.add_argument("file", type=Path, nargs="?")
    options.add_argument("--drives", type=int, default=1000)
    options.add_argument("--processes", type=int, default=2)
    given = options.parse_args()
    if given.verb == "kernels":
        other = list(differences(given.drives, given.processes))
        print("\n".join(other[:40]) or f"{given.drives} drives, all runs the same by their kernels")
        sys.exit(bool(other))
    found = sorted(lines(given.drives, given.processes))
    if given.verb == "write":
        given.file.write_text("\n".join(found) + "\n")
        print(f"{len(found)} runs, {sum('refused' in line for line in found)} refused")
        return
    other = sorted(set(found) ^ set(given.file.read_text().splitlines()))
    print("\n".join(other[:40]) or f"{len(found)} runs, all as they were")
    sys.exit(bool(other))


if __name__ == "__main__":
    main()
