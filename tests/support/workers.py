"""Processes that each do one task after the other; one that crashes or does not end costs its task alone, and is named."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, TypeVar

Task = TypeVar("Task")
Answer = TypeVar("Answer")

HANGS = "hangs"
CRASHES = "ends the process"


class Worker(Generic[Task, Answer]):
    """A process that does one task after the other, each in at most `limit` [s]."""

    def __init__(self, do: Callable[[Task], Answer], limit: float) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, far = context.Pipe()
        self.process = context.Process(target=work, args=(far, do, limit), daemon=True)
        self.process.start()
        far.close()

    def begin(self, task: Task) -> None:
        self.task = task
        self.pipe.send(task)

    def answer(self) -> Answer | str:
        """The answer to the task begun, or in words how the process ended."""
        try:
            found: Answer = self.pipe.recv()
        except EOFError:
            self.process.join()
            return HANGS if self.process.exitcode == -signal.SIGALRM else CRASHES
        return found


def work(pipe: Connection, do: Callable[[Any], Any], limit: float) -> None:
    """Answers tasks until there is None; ends where one lasts, though in compiled code that looks at no signal."""
    while (task := pipe.recv()) is not None:
        signal.setitimer(signal.ITIMER_REAL, limit)
        found = do(task)
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        pipe.send(found)


def answers(
    do: Callable[[Task], Answer], tasks: Iterable[Task], processes: int, limit: float
) -> Iterator[tuple[Task, Answer | str]]:
    """Each task with its answer, as they come; with words where it ended the process or lasted longer than `limit` [s]."""
    left = iter(tasks)
    busy: dict[Any, Worker[Task, Answer]] = {}

    def begin(worker: Worker[Task, Answer], task: Task) -> None:
        worker.begin(task)
        busy[worker.pipe] = worker

    for task in islice(left, processes):
        begin(Worker(do, limit), task)
    while busy:
        for pipe in wait(list(busy)):
            worker = busy.pop(pipe)
            yield worker.task, worker.answer()
            following = next(left, None)
            if following is not None:
                begin(worker if worker.process.is_alive() else Worker(do, limit), following)
            elif worker.process.is_alive():
                worker.pipe.send(None)
