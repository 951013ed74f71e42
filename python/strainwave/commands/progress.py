"""Progress of a command on a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def progress(count: int | None = None) -> Iterator[Callable[[str], None]]:
    """Show on a terminal what a command works on, and how much of it is done; the bar disappears at the end.

    Args:
        count: of the files or joints that it works on; none shows no share

    Yields:
        a function to call with the name of each as its turn comes
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task, done = bar.add_task("reading", total=count), -1

        def turn(name: str) -> None:
            nonlocal done
            done += 1
            bar.update(task, description=name, completed=done if count is None else min(done, count))

        yield turn
