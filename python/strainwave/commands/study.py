"""The command `strainwave study`: each of its verbs runs a study and writes what it found."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave.commands.options import numeric

study = typer.Typer(help="Put questions of the literature to a drive, and answer them with numbers.")


@study.command("position-control")
def position_control(
    out: Annotated[Path, typer.Option(help="Folder for the recordings and report.html.")] = Path("out/position-control"),
    measured: Annotated[
        Path | None,
        typer.Option(help="A run of your own drive to compare with: time, command and output_angle, as .csv or .parquet."),
    ] = None,
) -> None:
    """Ask whether average friction suffices for position control.

    Runs step, 1 Hz sine and pulse train of document P with its full and its simplified friction, and strokes of all sizes.
    Prints how far the two are apart, and up to which angle average friction suffices. Document P prints neither its
    controller nor its measurements, so its Table 4 is not reproduced; report.html gives the reason, and the assumptions.
    """
    from rich.console import Console

    from strainwave.report.page import write_results
    from strainwave.report.position_control import position_control_report, summary
    from strainwave.report.provenance import Provenance
    from strainwave.studies.position_control import position_control as run
    from strainwave.studies.position_control import recordings

    with Console(stderr=True).status("reading") as status:
        found = run(measured, progress=status.update)
        status.update("report")
        html = position_control_report(found, Provenance.of_this_command([] if measured is None else [measured]))
    runs = recordings(found)
    write_results(out, html, runs=runs)
    print(summary(found))
    print(f"wrote {out / 'report.html'} and {len(runs)} recordings beside it: {', '.join(f'{name}.parquet' for name in runs)}")


@study.command("misalignment")
def misalignment(
    out: Annotated[Path, typer.Option(help="Folder for the recordings, tables and report.html.")] = Path("out/misalignment"),
    drive: Annotated[
        str, typer.Option(help="Drive to run: a name of `strainwave drives`, or a .toml file; its controller a cascade.")
    ] = "tilt-actuator",
    stroke: Annotated[float, numeric("Stroke of the output in degrees.")] = 90.0,
    time: Annotated[float, numeric("Time of the ramp through the stroke in s.")] = 5.0,
    measured: Annotated[
        Path | None,
        typer.Option(help="A ramp of your own drive to lay over: time, and torque, current, output_angle or input_angle."),
    ] = None,
    measured_error: Annotated[
        Path | None,
        typer.Option(help="A measured curve of the error over a turn: input_angle and kinematic_error, as .csv or .parquet."),
    ] = None,
) -> None:
    """Ask what a misaligned wave generator does to an actuator.

    Runs the ramp of document A over levels of every misalignment, with the position loop closed on the output and on the motor
    encoder, over ramp times and gains. Confirms or corrects each of document A's claims with a number, and tries what a record
    of a ramp shows of the misalignment.
    """
    from math import radians

    from rich.console import Console

    from strainwave.report.misalignment import misalignment_report, summary
    from strainwave.report.page import write_results
    from strainwave.report.provenance import Provenance
    from strainwave.studies.misalignment import misalignment as run
    from strainwave.studies.misalignment import recordings, tables

    with Console(stderr=True).status("reading") as status:
        found = run(drive, radians(stroke), time, measured, measured_error, progress=status.update)
        status.update("report")
        read = [path for path in (measured, measured_error) if path is not None]
        html = misalignment_report(found, Provenance.of_this_command(read))
    runs, tabled = recordings(found), tables(found)
    write_results(out, html, runs=runs, tables=tabled)
    print(summary(found))
    print(f"wrote {out / 'report.html'}, {len(runs)} recordings and {len(tabled)} tables beside it")
