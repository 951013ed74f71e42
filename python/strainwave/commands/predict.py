"""The command `strainwave predict`: later recordings against a saved gear or drive."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave import exit_codes
from strainwave.commands.file_options import FileOptions, paths_in
from strainwave.commands.options import folder, with_groups
from strainwave.commands.output import write_report


@with_groups
def predict(
    gear: Annotated[str, typer.Argument(help="The saved gear or drive, as gear.toml of identify, or a set by name.")],
    paths: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Later recordings of this gear, or folders of them.")],
    given: FileOptions,
    out: Annotated[Path, folder("Folder for report.html and the numbers.")] = Path("out/predict"),
) -> None:
    r"""Compare later recordings with the prediction of a saved gear.

    Logs of a drive in motion need a load in the saved file; tables of friction do not. Recordings are read as by identify. If
    one contradicts the saved gear, the exit code is 3.

    Examples:
        strainwave predict gear.toml robot_log_later.csv \
          --constant torque_constant=0.0755
        strainwave predict gear.toml friction.csv
    """
    from strainwave.files.gear_set import GearSet
    from strainwave.identification.predict import predict as predicted
    from strainwave.identification.reading.source import measurement_files
    from strainwave.report.predict import predict_files, predict_summary
    from strainwave.report.provenance import Provenance

    saved, opened = GearSet.read(gear), measurement_files(paths)
    read = paths_in(opened)
    found = predicted(gear, opened, mapping=given.mapping_of(opened.files))
    files = predict_files(found, saved, Provenance.of_this_command(read))
    write_report(out, files, predict_summary(found))
    if any(each.contradicts for each in found):
        raise typer.Exit(exit_codes.RESULT_CONTRADICTED)
