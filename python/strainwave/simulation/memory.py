"""What does not fit into memory is said in one line: how much there is of it, how large it is, and what to do."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

MOST_INSTANTS = 1e9  # of a run or a signal: what memory could hold
ACTION = 120.0  # bytes: a sample of a controller, found in a few goes together with the instant at which its output arrives


@contextmanager
def room_for(what: str, count: float, each: float, remedy: str) -> Iterator[None]:
    """Says what takes the memory that is not there.

    Args:
        what: takes it, in the plural
        count: how many there are
        each: size of one [bytes]
        remedy: what to do about it

    >>> with room_for("samples", 2e9, 8.0, "take fewer"):
    ...     raise MemoryError
    Traceback (most recent call last):
    MemoryError: 2e+09 samples take 16 GB, more memory than there is; take fewer
    """
    try:
        yield
    except MemoryError:
        size = f"{1e-9 * count * each:.3g} GB"
        raise MemoryError(f"{count:.3g} {what} take {size}, more memory than there is; {remedy}") from None


def check_room(what: str, count: float, each: float, remedy: str) -> None:
    """Refuses what is too large for the memory, as `room_for` says it, before time is spent on a part of it.

    >>> check_room("samples", 1e15, 8.0, "take fewer")
    Traceback (most recent call last):
    MemoryError: 1e+15 samples take 8e+06 GB, more memory than there is; take fewer
    """
    with room_for(what, count, each, remedy):
        np.empty(int(count * each), np.uint8)


def check_instants(duration: float, step: float, remedy: str) -> None:
    """Refuses to cut a duration [s] into so many steps [s] that no memory could hold them.

    >>> check_instants(1.0, 1e-12, "take longer ones")
    Traceback (most recent call last):
    ValueError: 1 s are more than 1e+09 steps of 1e-12 s; take longer ones
    """
    if duration > MOST_INSTANTS * step:
        raise ValueError(f"{duration:g} s are more than {MOST_INSTANTS:g} steps of {step:g} s; {remedy}")


def check_acting(duration: float, period: float) -> None:
    """Refuses so many samples of a controller, one a period [s] over a duration [s], that no memory could hold them.

    >>> check_acting(1e12, 1.0)
    Traceback (most recent call last):
    ValueError: 1e+12 s are more than 1e+09 steps of 1 s; take a longer period
    """
    remedy = "take a longer period"
    check_instants(duration, period, remedy)
    check_room("samples of the controller", duration / period, ACTION, f"{remedy}, or make several runs")
