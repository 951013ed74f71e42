"""Runners of the shards: processes of this machine, tasks of Dask, or a job array of Slurm. The folder is the queue of all."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import tempfile
import time
from asyncio import CancelledError as TaskCancelled
from collections.abc import Callable
from concurrent.futures import CancelledError
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import IO

from strainwave import exit_codes
from strainwave.dataset.folder import DatasetFolder
from strainwave.dataset.members import Population
from strainwave.dataset.plan import DatasetPlan
from strainwave.dataset.shards import Shards
from strainwave.messages import one_line
from strainwave.native import kernels
from strainwave.operating_system import is_orphan
from strainwave.simulation.threads import THREAD_VARIABLES

POLL_SECONDS = 0.2
PROGRESS_SECONDS = 2.0
MAX_FINISH_SECONDS = 60.0  # that a worker may take to end after the last shard is there
MAX_DEATHS_WITHOUT_SHARD = 5  # of workers in succession, while no shard was completed
MAX_ERROR_BYTES = 4000
DASK_RETRIES = 5  # of a shard whose worker died
SLURM_SCRIPT = "slurm.sh"
SLURM_MEMORY = "1G"
Show = Callable[[str], None]


def work(path: str | Path, part: int = 0, parts: int = 1, parent: int | None = None) -> int:
    """Make the shards of a folder that nobody else makes, those of one's own part, from 0, first; return how many.

    Without its parent process this one ends after its shard; on Windows it goes on.
    """
    folder = DatasetFolder(Path(path))
    shards = _shards(f"{folder.path}", folder.plan.digest)
    made = 0
    count = shards.plan.shards
    for number in (number for turn in range(parts) for number in range((part + turn) % parts, count, parts)):
        if parent is not None and is_orphan(parent):
            break
        made += make_shard(folder, shards, number)
    folder.finish()
    return made


def make_shard(folder: DatasetFolder, shards: Shards, number: int) -> bool:
    """Make a shard if it is not there and nobody else makes it; True if this call made it."""
    if folder.has(number):
        return False
    with folder.lock(number) as is_mine:
        if not is_mine or folder.has(number):
            return False
        shards.write(folder, number)
    return True


@lru_cache(maxsize=4)
def _shards(path: str, digest: str) -> Shards:
    """The shards of a folder, with the kernel that was compiled before."""
    population = Population(DatasetFolder(Path(path)).plan)
    kernels.load(population.drive, "simulate_many", compile_it=False)
    return Shards(population)


def finish(folder: DatasetFolder) -> None:
    """Finish a data set whose shards are all there, once no worker makes one of them a second time."""
    begin = time.monotonic()
    while not folder.finish():
        if time.monotonic() - begin > MAX_FINISH_SECONDS:
            raise RuntimeError(
                f"all shards of {folder.path} are there, but a worker still has one locked; end it and try again"
            )
        time.sleep(POLL_SECONDS)


# Processes of this machine


@dataclass
class _Worker:
    process: subprocess.Popen[bytes]
    errors: IO[bytes]

    def message(self) -> str:
        """The last that it wrote."""
        self.errors.seek(0)
        lines = self.errors.read()[-MAX_ERROR_BYTES:].decode(errors="replace").strip().splitlines()
        return one_line(lines[-1].removeprefix("strainwave: ")) if lines else "it wrote nothing"


def run_locally(folder: DatasetFolder, count: int, show: Show) -> None:
    """Make all shards by processes, and start those anew that die."""
    whole = folder.plan.shards
    board = _Board(whole, folder.done(), show)
    workers = [_start(folder, part, count) for part in range(count)]
    deaths = 0
    try:
        while True:
            time.sleep(POLL_SECONDS)
            codes = [worker.process.poll() for worker in workers]
            if board.note(folder.done()):
                deaths = 0
            if board.done >= whole and None not in codes:
                break
            for part, (worker, code) in enumerate(zip(workers, codes, strict=True)):
                if code is None or board.done >= whole or (code == 0 and None in codes):
                    continue  # at work, or nothing was left for it
                if code == exit_codes.INPUT_REFUSED:
                    raise OSError(f"a worker stopped: {worker.message()}")
                deaths += 1
                if deaths > MAX_DEATHS_WITHOUT_SHARD:
                    raise RuntimeError(
                        f"{deaths} workers ended in succession without a shard, the last with code {code}: {worker.message()}; "
                        "if it was killed for memory, give fewer workers"
                    )
                worker.errors.close()
                workers[part] = _start(folder, part, count)
    finally:
        for worker in workers:
            worker.process.terminate()
            worker.process.wait()
            worker.errors.close()


def _start(folder: DatasetFolder, part: int, parts: int) -> _Worker:
    errors = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the worker
    command = [*worker_command(folder.path), "--part", f"{part}/{parts}", "--parent", f"{os.getpid()}"]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors, env=_environment())
    return _Worker(process, errors)


def worker_command(path: Path) -> list[str]:
    """Return the command of a worker: this Python, with nothing of the caller's script or of the folder it runs in."""
    flags = ["-P", *(["-S"] if sys.flags.no_site else [])]
    return [sys.executable, *flags, "-m", "strainwave", "dataset", "work", f"{path.resolve()}"]


def _environment() -> dict[str, str]:
    package = f"{Path(__file__).parents[2]}"
    there = os.environ.get("PYTHONPATH", "")
    return os.environ | dict.fromkeys(THREAD_VARIABLES, "1") | {"PYTHONPATH": os.pathsep.join(filter(None, (package, there)))}


class _Board:
    """Progress and time left, a line from time to time."""

    def __init__(self, whole: int, done: int, show: Show) -> None:
        self.whole, self.first, self.done, self.show = whole, done, done, show
        self.begin = self.last = time.monotonic()

    def note(self, done: int) -> bool:
        """Show how many shards are done; True if there are more than the last time."""
        more, self.done = done > self.done, done
        now = time.monotonic()
        if more and (now - self.last >= PROGRESS_SECONDS or done == self.whole):
            self.last = now
            left = (self.whole - done) * (now - self.begin) / (done - self.first)
            self.show(f"{done} of {self.whole} shards, {duration_text(left)} left")
        return more


def duration_text(seconds: float) -> str:
    """Return a time in the unit that one reads.

    >>> duration_text(42.0), duration_text(600.0), duration_text(7200.0), duration_text(864000.0)
    ('42 s', '10 min', '2 h', '10 days')
    """
    for unit, size, most in (("s", 1.0, 120.0), ("min", 60.0, 7200.0), ("h", 3600.0, 172800.0)):
        if seconds < most:
            return f"{seconds / size:.0f} {unit}"
    return f"{seconds / 86400.0:.0f} days"


# Dask


def run_by_dask(folder: DatasetFolder, scheduler: str | None, show: Show) -> None:
    """Make all shards as tasks of a Dask cluster, whose workers reach the folder by the same path."""
    try:
        from distributed import Client, as_completed
        from distributed.comm import CommClosedError
    except ImportError:
        raise ImportError("the runner dask needs Dask: pip install 'strainwave[dask]'") from None
    if scheduler is None:
        raise ValueError("the runner dask needs the address of a scheduler; give scheduler = tcp://host:8786")
    missing = [number for number in range(folder.plan.shards) if not folder.has(number)]
    board = _Board(folder.plan.shards, folder.done(), show)
    try:
        with Client(scheduler) as client:
            tasks = client.map(shard_task, missing, path=f"{folder.path.resolve()}", retries=DASK_RETRIES, pure=False)
            for task in as_completed(tasks):
                task.result()
                board.note(folder.done())
    except (CommClosedError, CancelledError, TaskCancelled):
        raise ConnectionError(
            f"the Dask scheduler at {scheduler} was lost, with {folder.done()} of {folder.plan.shards} shards complete; "
            "start it, and give the command again"
        ) from None


def shard_task(number: int, path: str) -> int:
    """Make one shard of a folder; it waits if another process makes the shard."""
    folder = DatasetFolder(Path(path))
    shards = _shards(path, folder.plan.digest)
    while not folder.has(number):
        if not make_shard(folder, shards, number):
            time.sleep(POLL_SECONDS)
    return number


# Slurm


def slurm_script(path: Path, plan: DatasetPlan, tasks: int) -> str:
    """Return a job array that makes the shards of a folder, each task those of its part first."""
    command = " ".join(shlex.quote(word) for word in worker_command(path))
    count = min(tasks, plan.shards)
    exports = "\n".join(f"export {name}=1" for name in THREAD_VARIABLES)
    return f"""#!/bin/bash
#SBATCH --job-name=strainwave-dataset
#SBATCH --array=0-{count - 1}
#SBATCH --cpus-per-task=1
#SBATCH --mem={SLURM_MEMORY}
#SBATCH --requeue
#SBATCH --output={shlex.quote(f"{path.resolve()}")}/slurm-%A_%a.log
{exports}
exec {command} --part "${{SLURM_ARRAY_TASK_ID}}/{count}"
"""
