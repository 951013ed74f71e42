"""The command `strainwave rank`: all models of a measurement, by what they predict."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave import exit_codes
from strainwave.commands.file_options import FileOptions, Gear
from strainwave.commands.options import with_groups
from strainwave.commands.progress import progress


@with_groups
def rank(
    gear: Gear,
    paths: Annotated[
        list[Path],
        typer.Argument(metavar="FILE…", help="Tables of friction, torsion and presliding loops, logs, each by itself."),
    ],
    given: FileOptions,
) -> None:
    """Fit every model of a measurement, and rank them by their error on data held out.

    The model to take stands first: the simplest whose error exceeds the smallest by no more than chance explains. The
    correlation of residuals shows what a model leaves unexplained; 1 is white noise. The checks are those of `identify`: if one
    fails, it is printed first, and the exit code is 3.
    """
    from strainwave.files.gear_set import GearSet
    from strainwave.identification.identify import checks_of, not_used, raise_question, read_measurements
    from strainwave.identification.kinds import KINDS
    from strainwave.identification.rank import rank as ranked, table_of
    from strainwave.identification.reading.source import measurement_files
    from strainwave.identification.results.file_result import FileResult
    from strainwave.report.identify_files import failed_lines

    opened, lines, failed = measurement_files(paths), list[str](), list[str]()
    with progress(len(opened.files)) as turn:
        read, start = read_measurements(opened, given.mapping_of(opened.files), GearSet.read(gear))
        for path, file in read.items():
            turn(path.name)
            try:
                models = () if isinstance(file, FileResult) else ranked(start, file)
            except ValueError as error:
                file = not_used(path, error)
            if isinstance(file, FileResult):
                raise_question([file])
                raise ValueError(f"{path.name}: {file.refused}")
            lines += [f"{path.name}: {KINDS[file.kind].title}", *(f"  {line}" for line in table_of(models)), ""]
            failed += failed_lines(check for check in checks_of(start, file) if check.failed)
    print("\n".join([*failed, *lines]).rstrip())
    if failed:
        raise typer.Exit(exit_codes.RESULT_CONTRADICTED)
