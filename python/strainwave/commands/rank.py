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
    from strainwave.identification.identify import read_measurements
    from strainwave.identification.kinds import KINDS
    from strainwave.identification.rank import rank as ranked
    from strainwave.identification.rank import table_of
    from strainwave.identification.reading.source import measurement_files
    from strainwave.identification.results.file_result import FileResult

    files, told = measurement_files(paths), list[str]()
    said = mapping_from_options(mapping, column, unit, constant, side, joint, kind, files.files)
    with Console(stderr=True).status("reading") as status:
        read, start = read_measurements(files, said, GearSet.read(gear))
        for path, file in read.items():
            status.update(path.name)
            if isinstance(file, FileResult):
                raise ValueError(f"{path.name}: {file.refused}")
            told += [
                f"{path.name}: {KINDS[file.kind].title}",
                *(f"  {line}" for line in table_of(ranked(start, file))),
                "",
            ]
    print("\n".join(told).rstrip())
