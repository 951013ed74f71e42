"""The command `strainwave rank`: all models of a measurement, by what they predict."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def rank(
    gear: Annotated[str, typer.Argument(help="Where to start: a catalogue set, as hfuc-25-100, or a gear file.")],
    paths: Annotated[
        list[Path], typer.Argument(metavar="FILE…", help="Tables of friction, torsion loops or logs, each by itself.")
    ],
    mapping: Annotated[
        Path | None, typer.Option(help="TOML file that says what is in which column, for all files or for some.")
    ] = None,
    column: Annotated[
        list[str] | None, typer.Option(help="A column's name or number in the files, as speed=3; repeat as needed.")
    ] = None,
    unit: Annotated[
        list[str] | None, typer.Option(help="Unit of a column whose header has none, as torque=N.m; repeat as needed.")
    ] = None,
    constant: Annotated[
        list[str] | None, typer.Option(help="A number that belongs to the files, as rate=500; repeat as needed.")
    ] = None,
    side: Annotated[
        str | None, typer.Option(help="Where a table or angles were measured that do not say it: input or output.")
    ] = None,
    joint: Annotated[str | None, typer.Option(help="Which joint, of files with several.")] = None,
) -> None:
    """Fit every model that a measurement can tell, and rank them by what they predict of data held out.

    The model to take stands first: the simplest that chance alone may make no better. Residuals that hang together show that
    a model leaves something unexplained; 1 is white noise.
    """
    from rich.console import Console

    from strainwave.files.gear_set import GearSet
    from strainwave.identification.rank import rank as ranked
    from strainwave.identification.rank import table_of
    from strainwave.identification.reading.channels import KINDS
    from strainwave.identification.reading.recognise import recognise
    from strainwave.identify_command import said_of

    said, start, told = said_of(mapping, column, unit, constant, side, joint), GearSet.read(gear), list[str]()
    with Console(stderr=True).status("reading") as status:
        for path in paths:
            status.update(path.name)
            file = recognise(path, said(path))
            told += [f"{path.name}: {KINDS[file.kind]}", *(f"  {line}" for line in table_of(ranked(start, file))), ""]
    print("\n".join(told).rstrip())
