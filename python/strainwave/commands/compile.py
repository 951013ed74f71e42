"""The command `strainwave compile`: the kernels of a drive, ahead of its runs."""

from __future__ import annotations

from typing import Annotated

import typer


def compile(
    drive: Annotated[
        str, typer.Argument(help="A drive: a set by name (strainwave drives), or a gear file with motor and load.")
    ],
    jobs: Annotated[
        list[str] | None,
        typer.Option("--job", help="A job of a kernel, as simulate_many; repeat as needed. All, if not given."),
    ] = None,
) -> None:
    """Compile the kernels of a drive, and compare them with the code for any drive.

    Later runs of drives with the same laws use them, and give the same numbers. Long work compiles what it needs by itself.
    """
    from strainwave.files.gear_set import GearSet
    from strainwave.native.compile import compile as compiled
    from strainwave.native.kernels import PUBLIC_JOBS

    print(compiled(GearSet.read(drive), jobs or PUBLIC_JOBS))
