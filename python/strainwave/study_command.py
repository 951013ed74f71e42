"""The command `strainwave study`: each of its verbs runs a study and writes what it found."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

study = typer.Typer(help="Put questions of the literature to a drive, and answer them with numbers.")


@study.callback()
def _studies() -> None:
    """Keeps `position-control` a name to be given, though it is the only one."""


@study.command("position-control")
def position_control(
    out: Annotated[Path, typer.Option(help="Folder for the recordings and report.html.")] = Path("out/position-control"),
    measured: Annotated[
        Path | None,
        typer.Option(help="A run of your own drive to compare with: time, command and output_angle, as .csv or .parquet."),
    ] = None,
) -> None:
    """Ask whether average friction suffices for position control.

    Runs step, 1 Hz sine and pulse train of document P with its full and its simplified friction, and strokes of all sizes. Says
    how far the two are apart, and up to which angle average friction suffices. Document P prints neither its controller nor its
    measurements, so its Table 4 is not reproduced; report.html says why, and what is assumed.
    """
    from rich.console import Console

    from strainwave.files.writing import making, written
    from strainwave.report.page import write
    from strainwave.report.position_control import position_control_report, summary
    from strainwave.report.provenance import Provenance
    from strainwave.studies.position_control import position_control as run
    from strainwave.studies.position_control import recordings

    with Console(stderr=True).status("reading") as status:
        found = run(measured, progress=status.update)
        status.update("report")
        html = position_control_report(found, Provenance.of_this_command([] if measured is None else [measured]))
    files = {out / f"{name}.parquet": recording for name, recording in recordings(found).items()}
    with making(out):
        for path, recording in files.items():
            recording.to_parquet(path)
            written.append(path)
        write(html, out / "report.html")
        written.append(out / "report.html")
    print(summary(found))
    print(f"wrote {out / 'report.html'} and {len(files)} recordings beside it: {', '.join(path.name for path in files)}")
