"""Progress of long calls: one argument, which means the same everywhere.

`sw.simulate` and its kin, `sw.fit`, `sw.identify`, `sw.predict`, `sw.compensate` and other long calls take `progress`: None
shows a bar on a terminal once the call has taken a second, True shows it at once, False shows nothing, and a function is
called with what is worked on and with the share of the whole that is done. Calls within a call show nothing.

>>> shares = []
>>> with by_count(lambda stage, share: shares.append((stage, share)), "simulating", 4) as done:
...     for step in range(5):
...         done(step)
>>> shares[-2:]  # the end is always reported
[('simulating', 1.0), ('simulating', 1.0)]
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from math import isnan, nan
from threading import Lock, Timer, current_thread, main_thread
from typing import TYPE_CHECKING, Any, TypeAlias

from strainwave.messages import shortened

if TYPE_CHECKING:
    from rich.progress import Progress as RichProgress

Report: TypeAlias = Callable[[str, float], None]  # called with a stage and the share done, in [0, 1], nan if not known
Progress: TypeAlias = bool | Report | None
SHOWN_AFTER = 1.0  # s, that a call takes before its bar appears
_is_within: ContextVar[bool] = ContextVar("is_within", default=False)  # a call that shows its progress, or hides it
_watcher: ContextVar[Report | None] = ContextVar("watcher", default=None)


@contextmanager
def watched_by(report: Report) -> Iterator[None]:
    """Call a function in place of a bar for the calls here that leave `progress` to the terminal; not for calls within these.

    >>> stages = []
    >>> with watched_by(lambda stage, share: stages.append(stage)), in_turn(None, 2) as turn:
    ...     turn("first")
    >>> stages
    ['first']
    """
    token = _watcher.set(report)
    try:
        yield
    finally:
        _watcher.reset(token)


@contextmanager
def by_count(progress: Progress, stage: str, total: int) -> Iterator[Callable[[int], None] | None]:
    """Yield a function to call with how many of `total` are done; None if nobody watches."""
    with _watched(progress) as report:
        if report is None:
            yield None
            return
        yield lambda done: report(stage, done / max(total, 1))
        report(stage, 1.0)


@contextmanager
def in_turn(progress: Progress, total: int | None = None) -> Iterator[Callable[[str], None]]:
    """Yield a function to call with the name of each of `total` parts as its turn comes; of None the count is not known."""
    with _watched(progress) as report:
        begun = 0

        def turn(name: str) -> None:
            nonlocal begun
            if report is not None:
                report(name, min(begun / total, 1.0) if total else nan)
            begun += 1

        yield turn


@contextmanager
def _watched(progress: Progress) -> Iterator[Report | None]:
    """
    Raises:
        TypeError: `progress` is neither None, True, False nor a function
    """
    if not (callable(progress) or progress is None or isinstance(progress, bool)):
        raise TypeError(f"progress = {shortened(progress)} must be True, False, None, or a function of a stage and a share")
    is_outermost = not _is_within.get()
    token = _is_within.set(True)
    try:
        watcher = progress if callable(progress) else _watcher.get() if progress is None and is_outermost else None
        is_wanted = sys.stderr is not None and sys.stderr.isatty() if progress is None else progress
        if watcher is not None:
            yield watcher
        elif is_outermost and is_wanted and current_thread() is main_thread():
            bar = _Bar(0.0 if progress else SHOWN_AFTER)
            try:
                yield bar.report
            finally:
                bar.close()
        else:
            yield None
    finally:
        _is_within.reset(token)


class _Bar:
    """A bar on standard error, which appears after a delay [s] and disappears at the end."""

    def __init__(self, delay: float) -> None:
        self._lock = Lock()
        self._bar: RichProgress | None = None
        self._last: tuple[str, float] = ("", nan)
        self._closed = False
        self._timer = Timer(delay, self._open)
        self._timer.daemon = True
        if delay > 0.0:
            self._timer.start()
        else:
            self._open()

    def report(self, stage: str, share: float) -> None:
        self._last = stage, share
        if self._bar is not None:
            self._update()

    def close(self) -> None:
        """End the bar, and the wait for it."""
        self._timer.cancel()
        with self._lock:
            self._closed = True
            if self._bar is not None:
                self._bar.stop()

    def _open(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, SpinnerColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn

        columns: tuple[Any, ...] = (SpinnerColumn(), BarColumn(), TaskProgressColumn())
        columns += (TextColumn("{task.description}", markup=False), TimeElapsedColumn())
        with self._lock:
            if self._closed:
                return
            # What the call prints meanwhile goes where it goes without a bar.
            bar = Progress(*columns, console=Console(stderr=True), transient=True, redirect_stdout=False, redirect_stderr=False)
            bar.add_task("", total=None)
            bar.start()
            self._bar = bar
        self._update()

    def _update(self) -> None:
        stage, share = self._last
        assert self._bar is not None
        whole = None if isnan(share) else 1.0
        self._bar.update(self._bar.task_ids[0], description=stage, total=whole, completed=0.0 if whole is None else share)
