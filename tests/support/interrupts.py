"""Ctrl-C while something runs, without a clock: what looks for it only at its end finds all presses to be one."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager

INTERVAL = 0.01  # s of the processor, between presses
PRESSES = 3


@contextmanager
def ctrl_c() -> Iterator[None]:
    """Presses Ctrl-C again and again. KeyboardInterrupt comes with the third press that is noticed by itself."""
    noticed = 0

    def notice(*_: object) -> None:
        nonlocal noticed
        noticed += 1
        if noticed == PRESSES:
            raise KeyboardInterrupt

    before = signal.signal(signal.SIGPROF, notice)
    signal.setitimer(signal.ITIMER_PROF, INTERVAL, INTERVAL)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
