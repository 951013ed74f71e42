"""The commands `strainwave doctor kernels` and `strainwave doctor compile`: code compiled for one drive."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from strainwave.commands.options import Drive

if TYPE_CHECKING:
    from collections.abc import Iterator

    from strainwave.native.folder import Record

AGE_UNITS = {"d": 86_400.0, "h": 3_600.0, "min": 60.0, "s": 1.0}  # s


def kernels(
    clear: Annotated[bool, typer.Option("--clear", help="Remove all kernels; those needed again are compiled again.")] = False,
) -> None:
    """List the kernels: code compiled for one drive, which runs faster.

    A kernel gives the same numbers as the code for any drive. The cache contains at most 256 MB; the kernels used least
    recently are removed first. The environment variable STRAINWAVE_KERNELS names another folder for it, or is `off`: then no
    kernel is used. On Windows there are none.

    Examples:
        strainwave doctor kernels
        strainwave doctor kernels --clear
    """
    from strainwave.native import cache
    from strainwave.native.folder import cache_folder, reason_without_kernels

    folder = cache_folder()
    if folder is None:
        print(f"no kernel is used: {reason_without_kernels()}")
        return
    if clear:
        print(f"removed {_counted(cache.clear())} from {folder}")
        return
    records = cache.listing()
    print(*_table(records), sep="\n", end="\n\n" if records else "")
    print(f"{_counted(len(records))}, {_megabytes(sum(record.size for record in records))}, in {folder}")


def compile_command(
    drive: Drive,
    jobs: Annotated[
        list[str] | None,
        typer.Option("--job", metavar="JOB", help="A job of a kernel, as simulate_many; repeat as needed. All, if not given."),
    ] = None,
) -> None:
    """Compile the kernels of a drive ahead of its runs.

    They are compared with the code for any drive: the numbers are the same. Later runs of drives with the same laws use them.
    Long work compiles what it needs by itself.

    Examples:
        strainwave doctor compile robot-joint
        strainwave doctor compile robot-joint --job simulate_many
    """
    from strainwave.files.gear_set import GearSet
    from strainwave.native.compile import compile as compiled
    from strainwave.native.kernels import PUBLIC_JOBS

    print(compiled(GearSet.read(drive), jobs or PUBLIC_JOBS))


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
