"""Cases in processes of their own, whose terminal, memory and folder are watched."""

from __future__ import annotations

import os
import resource
import shutil
import tempfile
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import IO, NamedTuple

from tests.fuzz.kinds import KINDS, drawn
from tests.fuzz.laws import Outcome, judged
from tests.support.workers import answers

LIMIT = 60.0  # s, for one case, and for what it needs once in a process
LARGEST = 4 << 30  # bytes, for what makes a case


class Task(NamedTuple):
    """A case to try, by its kind and number."""

    kind: str
    number: int


def outcomes(tasks: Iterable[Task], processes: int, limit: float = LIMIT) -> Iterator[tuple[Task, Outcome]]:
    """Each case with what came of it, as they come."""
    with tempfile.TemporaryDirectory() as folder:
        for task, found in answers(partial(in_process, Path(folder)), tasks, processes, limit):
            yield task, _ended(found, task, Path(folder), limit) if isinstance(found, str) else found


def _ended(how: str, task: Task, folder: Path, limit: float) -> Outcome:
    """Of a case that took its process with it."""
    with warnings.catch_warnings(action="ignore"):
        return Outcome("wrong", how, "", drawn(*task, folder).what, limit)


def in_process(folder: Path, task: Task) -> Outcome:
    """Tries a case where nobody sees the terminal; the process is not to be used for anything else."""
    terminal, place = _prepared(folder)
    terminal.seek(0)
    terminal.truncate()
    with warnings.catch_warnings(action="ignore"):
        _limit_memory(LARGEST)
        case = drawn(*task, place)
    _limit_memory(KINDS[task.kind].memory)
    outcome = judged(case, KINDS[task.kind].slowest)
    _emptied(place)
    terminal.seek(0)
    if outcome.verdict != "wrong" and (seen := terminal.read()):
        outcome = replace(outcome, verdict="wrong", fault="speaks on the terminal", words=seen.decode(errors="replace"))
    return replace(outcome, words=outcome.words.replace(f"{place}", "FOLDER"))


@cache
def _prepared(folder: Path) -> tuple[IO[bytes], Path]:
    """What this process writes to the terminal from now on, and the empty folder it works in."""
    place = Path(tempfile.mkdtemp(dir=folder))
    os.chdir(place)
    terminal = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115
    for stream in (1, 2):
        os.dup2(terminal.fileno(), stream)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    return terminal, place


def _limit_memory(more: int) -> None:
    """Let this process take so much address space [bytes] more than it has: what needs more gets a MemoryError."""
    has = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (has + more, hard))


def _emptied(place: Path) -> None:
    for each in os.scandir(place):
        shutil.rmtree(each) if each.is_dir(follow_symlinks=False) else os.unlink(each)
