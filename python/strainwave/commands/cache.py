"""The command `strainwave cache`: the kernels that were compiled on this machine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from collections.abc import Iterator

    from strainwave.native.folder import Record

AGE_UNITS = {"d": 86_400.0, "h": 3_600.0, "min": 60.0, "s": 1.0}  # s


def cache(
    clear: Annotated[bool, typer.Option("--clear", help="Remove all kernels; those needed again are compiled again.")] = False,
) -> None:
    """List the kernels: code compiled for one drive, which runs faster and gives the same numbers.

    The cache contains at most 256 MB; the kernels used least recently are removed first. The environment variable
    STRAINWAVE_KERNELS names another folder for it, or is `off`: then no kernel is used. On Windows there are none.
    """
    from strainwave.native import cache as kernels
    from strainwave.native.folder import cache_folder, reason_without_kernels

    folder = cache_folder()
    if folder is None:
        print(f"no kernel is used: {reason_without_kernels()}")
        return
    if clear:
        print(f"removed {_counted(kernels.clear())} from {folder}")
        return
    records = kernels.listing()
    print(*_table(records), sep="\n", end="\n\n" if records else "")
    print(f"{_counted(len(records))}, {_megabytes(sum(record.size for record in records))}, in {folder}")


def _table(records: list[Record]) -> Iterator[str]:
    """Yield the lines of a table of kernels."""
    import time

    from strainwave.report.listing import aligned

    rows = [
        (each.drive, each.job, _megabytes(each.size), f"{each.seconds:.1f} s by {each.compiler}", _age(time.time() - each.made))
        for each in records
    ]
    return aligned([("drive", "job", "size", "compiled in", "age"), *rows], "<<><>") if rows else iter(())


def _counted(kernels: int) -> str:
    return f"{kernels} kernel{'' if kernels == 1 else 's'}"


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.2f} MB"


def _age(seconds: float) -> str:
    """Return a time in the largest unit of which it has one."""
    unit = next((name for name, length in AGE_UNITS.items() if seconds >= length), "s")
    return f"{seconds / AGE_UNITS[unit]:.0f} {unit}"
