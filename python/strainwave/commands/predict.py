"""The command `strainwave predict`: later recordings against a saved gear or drive."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave.commands.file_options import Columns, Constants, Joint, Kind, Mapping, Side, Units, mapping_from_options

CONTRADICTS = 3  # exit code if a recording contradicts the saved gear


def predict(
    gear: Annotated[str, typer.Argument(help="The saved gear or drive, as gear.toml of identify, or a set by name.")],
    paths: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Later recordings of this gear, or folders of them.")],
    mapping: Mapping = None,
    column: Columns = None,
    unit: Units = None,
    constant: Constants = None,
    side: Side = None,
    joint: Joint = None,
    kind: Kind = None,
    out: Annotated[Path, typer.Option(help="Folder for report.html and the numbers.")] = Path("out/predict"),
) -> None:
    """Compare later recordings with what a saved gear or drive predicts, and report what changed.

    Logs of a drive in motion need a load in the saved file; tables of friction do not. Recordings are read as by identify. If
    one contradicts the saved gear, the exit code is 3.
    """
    from rich.console import Console

    from strainwave.files.gear_set import GearSet
    from strainwave.files.writing import write_folder
    from strainwave.identification.predict import predict as predicted
    from strainwave.identification.reading.source import measurement_files
    from strainwave.report.predict import predict_files, predict_report, predict_summary
    from strainwave.report.provenance import Provenance

    saved, opened = GearSet.read(gear), measurement_files(paths)
    said = mapping_from_options(mapping, column, unit, constant, side, joint, kind, opened.files)
    read = [part.path for file in opened.files for part in file.parts or (file,)]
    with Console(stderr=True).status("reading") as status:
        found = predicted(saved, opened, mapping=said, progress=status.update)
        status.update("report")
        files = predict_files(found)
        files["report.html"] = predict_report(found, saved, Provenance.of_this_command(read))
        write_folder(out, files)
    print(predict_summary(found))
    print(f"\nwrote {out / 'report.html'}, and beside it {', '.join(list(files)[:-1])}")
    if any(each.contradicts for each in found):
        raise typer.Exit(CONTRADICTS)
