"""The command `strainwave rank`: all models of a measurement, by what they predict."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave.commands.file_options import Columns, Constants, Gear, Joint, Kind, Mapping, Side, Units, mapping_from_options


def rank(
    gear: Gear,
    paths: Annotated[
        list[Path],
        typer.Argument(metavar="FILE…", help="Tables of friction, torsion and presliding loops, logs, each by itself."),
    ],
    mapping: Mapping = None,
    column: Columns = None,
    unit: Units = None,
    constant: Constants = None,
    side: Side = None,
    joint: Joint = None,
    kind: Kind = None,
) -> None:
    """Fit every model that a measurement can tell, and rank them by what they predict of data held out.

    The model to take stands first: the simplest that chance alone may make no better. Residuals that hang together show that
    a model leaves something unexplained; 1 is white noise.
    """
    from rich.console import Console

    from strainwave.files.gear_set import GearSet
    from strainwave.identification.rank import rank as ranked
    from strainwave.identification.rank import table_of
    from strainwave.identification.kinds import KINDS
    from strainwave.identification.reading.recognise import recognise
    from strainwave.identification.reading.source import measurement_files

    files = measurement_files(paths).files
    said = mapping_from_options(mapping, column, unit, constant, side, joint, kind, files)
    start, told = GearSet.read(gear), list[str]()
    with Console(stderr=True).status("reading") as status:
        for each in files:
            status.update(each.path.name)
            file = recognise(each, said(each.path))
            told += [
                f"{each.path.name}: {KINDS[file.kind].title}",
                *(f"  {line}" for line in table_of(ranked(start, file))),
                "",
            ]
    print("\n".join(told).rstrip())
