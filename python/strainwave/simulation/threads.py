"""Calls of the core side by side, in as many threads as there are processors."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ContextDecorator
from functools import cache
from threading import Event, Lock, Thread
from typing import Any, TypeVar

StepCounter = Callable[[int], None]  # a call of the core reports to it now and then the count of steps done

T = TypeVar("T")

# Of libraries of linear algebra, whose threads wait for each other if other processes run: ten times the processor time.
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def available_threads() -> int:
    """Return the count of threads that this process may run at once."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def _libraries() -> Any:
    """Return the controller of the libraries with threads that are loaded; to find them takes some milliseconds."""
    import scipy.linalg  # noqa: F401  # loads its library, which is then limited too
    from threadpoolctl import ThreadpoolController  # type: ignore[import-untyped]

    return ThreadpoolController()


class OneThreadOfAlgebra(ContextDecorator):
    """Lets libraries of linear algebra use one thread: fits solve many small systems, for which threads wait for each other.

    The limit is one of the process, from the first of the calls that overlap, in whichever thread, to the end of the last.
    A thread of its own sets and lifts it, because threadpoolctl lets no other thread lift what one has set.
    """

    def __init__(self) -> None:
        self._lock, self._calls = Lock(), 0
        self._ended, self._holder = Event(), Thread()

    def __enter__(self) -> None:
        def hold_limit(libraries: Any, limited: Event, ended: Event) -> None:
            with libraries.limit(limits=1, user_api="blas"):
                limited.set()
                ended.wait()

        with self._lock:
            if self._calls == 0:
                limited, self._ended = Event(), Event()
                self._holder = Thread(target=hold_limit, args=(_libraries(), limited, self._ended), daemon=True)
                self._holder.start()
                limited.wait()
            self._calls += 1

    def __exit__(self, *_: object) -> None:
        with self._lock:
            self._calls -= 1
            if self._calls == 0:
                self._ended.set()
                self._holder.join()


one_thread_of_algebra = OneThreadOfAlgebra()


def side_by_side(calls: Sequence[Callable[[StepCounter], T]]) -> list[T]:
    """Return the results of the calls. The first runs in this thread, which Ctrl-C reaches; its failure ends the others."""
    ended = Event()

    def go_on(_: int) -> None:
        if ended.is_set():
            raise InterruptedError("a parallel call has failed")

    if len(calls) == 1 or available_threads() == 1:
        return [call(go_on) for call in calls]
    with ThreadPoolExecutor(available_threads() - 1) as pool:
        others = [pool.submit(call, go_on) for call in calls[1:]]
        try:
            return [calls[0](go_on), *(each.result() for each in others)]
        except BaseException:
            ended.set()
            raise
