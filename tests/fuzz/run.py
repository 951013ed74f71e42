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
from tests.workers import answers

LIMIT = 60.0  # s, for one case, on a machine that has other work too
MEMORY = 4 << 30  # bytes of address space: what asks for more must say so


class Task(NamedTuple):
    """A case to try, by its kind and number."""

    kind: str
    number: int


def outcomes(tasks: Iterable[Task], processes: int, limit: float = LIMIT) -> Iterator[tuple[Task, Outcome]]:
    """Each case with what came of it, as they come."""
    with tempfile.TemporaryDirectory() as folder:
        for task, found in answers(partial(in_process, Path(folder)), tasks, processes, limit):
            yield task, Outcome("wrong", found, drawn(*task, Path(folder)).what, limit) if isinstance(found, str) else found


def in_process(folder: Path, task: Task) -> Outcome:
    """Tries a case where nobody sees the terminal; the process is not to be used for anything else."""
    terminal, place = _prepared(folder)
    terminal.seek(0)
    terminal.truncate()
    with warnings.catch_warnings(action="ignore"):
        case = drawn(*task, place)
    outcome = judged(case, KINDS[task.kind].slowest)
    _emptied(place)
    terminal.seek(0)
    if outcome.verdict != "wrong" and (seen := terminal.read()):
        outcome = replace(outcome, verdict="wrong", words=f"on the terminal: {seen.decode(errors='replace')}")
    return replace(outcome, words=outcome.words.replace(f"{place}", "FOLDER"))


@cache
def _prepared(folder: Path) -> tuple[IO[bytes], Path]:
    """What this process writes to the terminal from now on, and the empty folder it works in."""
    place = Path(tempfile.mkdtemp(dir=folder))
    os.chdir(place)
    terminal = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115
    for stream in (1, 2):
        os.dup2(terminal.fileno(), stream)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    return terminal, place


def _emptied(place: Path) -> None:
    for each in os.scandir(place):
        shutil.rmtree(each) if each.is_dir(follow_symlinks=False) else os.unlink(each)
