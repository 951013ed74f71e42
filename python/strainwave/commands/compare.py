"""The command `strainwave compare`: two recordings, or two gears or drives."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def compare(
    first: Annotated[str, typer.Argument(help="A recording (.csv, .parquet), a gear file, or a set by name.")],
    second: Annotated[str, typer.Argument(help="Another one of the same kind.")],
    column: Annotated[
        list[str] | None, typer.Option(help="A column to compare; repeat as needed. All that both have, if not given.")
    ] = None,
) -> None:
    """Compare two recordings, or two gears or drives."""
    from strainwave.analysis.compare import compare as compared
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.report.listing import agreement_table, difference_table

    recordings = [Path(each).suffix.lower() in (".csv", ".parquet", ".txt", ".tsv") for each in (first, second)]
    if recordings[0] != recordings[1]:
        recorded, modelled = (first, second) if recordings[0] else (second, first)
        raise ValueError(f"{recorded} is a recording, {modelled} a gear or drive; give two of one kind")
    if recordings[0]:
        agreements = compared(Recording.read(first), Recording.read(second), column)
        print(f"{agreements[0].samples} samples compared\n\n{agreement_table(agreements)}")
        return
    if column:
        raise ValueError(f"--column {column[0]}: of gears and drives all numbers are compared; leave it out")
    differences = compared(GearSet.read(first), GearSet.read(second))
    print(difference_table(differences) if differences else "equal, number by number")
