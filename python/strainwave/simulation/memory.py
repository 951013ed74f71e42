"""Limits on memory and on the length of runs. A message names what is too large, its count and size, and the remedy."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

MAX_INSTANTS = 1e8  # steps or samples of one run or signal: 5.5 hours in steps of 0.2 ms
MAX_ACTIONS = 1e7  # of a controller in one run: 10 000 s at 1 kHz
MAX_BYTES = 8e9  # that steps or samples of one run may take
BYTES_PER_ACTION = 120.0  # memory for a sample of a controller with the instant at which its output arrives (measured)


@contextmanager
def room_for(what: str, count: float, each: float, remedy: str) -> Iterator[None]:
    """Refuse what takes more than `MAX_BYTES`; a MemoryError within names it, its size, and the remedy.

    Args:
        what: takes it, in the plural
        count: how many there are
        each: size of one [bytes]
        remedy: what to do about it

    >>> with room_for("samples", 5e8, 8.0, "take fewer"):
    ...     raise MemoryError
    Traceback (most recent call last):
    MemoryError: 5e+08 samples take 4 GB, more memory than there is; take fewer
    """
    if count * each > MAX_BYTES:
        raise MemoryError(
            f"{count:.3g} {what} take {1e-9 * count * each:.3g} GB; at most {1e-9 * MAX_BYTES:g} GB are allowed; {remedy}"
        )
    try:
        yield
    except MemoryError:
        size = f"{1e-9 * count * each:.3g} GB"
        raise MemoryError(f"{count:.3g} {what} take {size}, more memory than there is; {remedy}") from None


def check_room(what: str, count: float, each: float, remedy: str) -> None:
    """Refuse what is too large for the memory, as `room_for` does, before time is spent on a part of it.

    >>> check_room("samples", 1e15, 8.0, "take fewer")
    Traceback (most recent call last):
    MemoryError: 1e+15 samples take 8e+06 GB; at most 8 GB are allowed; take fewer
    """
    with room_for(what, count, each, remedy):
        np.empty(int(count * each), np.uint8)


def check_instants(duration: float, step: float, remedy: str, most: float = MAX_INSTANTS) -> None:
    """Refuse to cut a duration [s] into more than `most` steps [s].

    >>> check_instants(1.0, 1e-12, "take longer ones")
    Traceback (most recent call last):
    ValueError: 1 s are more than 1e+08 steps of 1e-12 s; take longer ones
    """
    if duration > most * step:
        raise ValueError(f"{duration:g} s are more than {most:g} steps of {step:g} s; {remedy}")


def check_acting(duration: float, period: float) -> None:
    """Refuse more than `MAX_ACTIONS` of a controller, one a period [s] over a duration [s].

    >>> check_acting(0.1, 1e-9)
    Traceback (most recent call last):
    ValueError: a controller with period = 1e-09 s acts 1e+08 times in 0.1 s; at most 1e+07 times are allowed; take a longer \
period, or make several runs
    """
    if duration > MAX_ACTIONS * period:
        raise ValueError(
            f"a controller with period = {period:g} s acts {duration / period:.3g} times in {duration:g} s; at most "
            f"{MAX_ACTIONS:g} times are allowed; take a longer period, or make several runs"
        )
    check_room("samples of the controller", duration / period, BYTES_PER_ACTION, "take a longer period, or make several runs")
