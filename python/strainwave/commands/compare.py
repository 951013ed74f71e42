"""The command `strainwave compare`: two recordings, or two gears or drives."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave.commands.options import numeric


def compare(
    first: Annotated[str, typer.Argument(help="A recording (.csv, .parquet), a gear file, or a set by name.")],
    second: Annotated[str, typer.Argument(help="Another one of the same kind.")],
    column: Annotated[
        list[str] | None,
        typer.Option(metavar="COLUMN", help="A column to compare; repeat as needed. All that both have, if not given."),
    ] = None,
    measured: Annotated[
        Path | None,
        typer.Option(help="Of two drives: a run to compare both with, from rest: time, command and output_angle."),
    ] = None,
    stroke: Annotated[
        float | None, numeric("Of two drives: the largest stroke of the output in degrees, of moves that are compared.")
    ] = None,
    tolerance: Annotated[float, numeric("With --stroke: the rms difference of the output allowed, in mrad.")] = 1.0,
) -> None:
    """Compare two recordings, or two gears or drives.

    Of two gears or drives all numbers are compared; with --measured both are run under the measured command; with --stroke
    both make moves of growing stroke, and the largest that agrees within the tolerance is printed.

    Examples:
        strainwave compare hfuc-20-80 gear.toml
        strainwave compare position-drive-full-friction position-drive
    """
    from strainwave.analysis.compare import compare as compared
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.report.listing import agreement_table, difference_table, stroke_table

    recordings = [Path(each).suffix.lower() in (".csv", ".parquet", ".txt", ".tsv") for each in (first, second)]
    if recordings[0] != recordings[1]:
        recorded, modelled = (first, second) if recordings[0] else (second, first)
        raise ValueError(f"{recorded} is a recording, {modelled} a gear or drive; give two of one kind")
    if recordings[0]:
        if measured is not None or stroke is not None:
            raise ValueError(
                "--measured and --stroke run two drives, and these are recordings; give two drives, or leave it out"
            )
        agreements = compared(Recording.read(first), Recording.read(second), column)
        print(f"{agreements[0].samples} samples compared\n\n{agreement_table(agreements)}")
        return
    if column:
        raise ValueError(f"--column {column[0]}: of gears and drives all numbers are compared; leave it out")
    sets = [GearSet.read(first), GearSet.read(second)]
    differences = compared(*sets)
    parts = [difference_table(differences) if differences else "equal, number by number"]
    if measured is not None:
        from strainwave.analysis.measured_command import MeasuredCommand

        run = MeasuredCommand.read(measured)
        parts += [
            f"{name} against {measured.name}\n{agreement_table([run.agreement(each.drive)])}"
            for name, each in zip((first, second), sets, strict=True)
        ]
    if stroke is not None:
        parts.append(stroke_table(sets[0].drive, sets[1].drive, stroke, tolerance))
    print("\n\n".join(parts))  # last, so that a refusal leaves no half of an answer
