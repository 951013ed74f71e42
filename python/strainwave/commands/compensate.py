"""The command `strainwave compensate`: a controller that takes away what the gear does to the motion."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave.commands.options import Drive, folder, numeric, whole
from strainwave.commands.output import write_report


def compensate(
    drive: Drive,
    goal: Annotated[
        str, typer.Option(help="position (to and fro), speed (constant), smooth (creeping) or torque.")
    ] = "position",
    period: Annotated[float, numeric("Period of the controller [s].")] = 1e-3,
    delay: Annotated[float, numeric("From a sample to the output of the controller [s].")] = 0.0,
    encoder: Annotated[str, typer.Option(help="output if the controller sees the output angle too.")] = "input",
    travel: Annotated[float | None, numeric("Travel of the output, for position [rad]; usually 0.2.")] = None,
    speed: Annotated[float | None, numeric("Speed of the output [rad/s]; usually 20 rad/s of the input.")] = None,
    torque: Annotated[float | None, numeric("Torque of the output, for torque [N.m]; usually a fifth of the largest.")] = None,
    members: Annotated[int, whole("Number of drawn gears.")] = 40,
    seed: Annotated[int, whole("Seed of the draw.")] = 0,
    out: Annotated[Path, folder("Folder for the files written.")] = Path("out/compensate"),
) -> None:
    """Find the compensation that gains most over a tuned cascade.

    It is judged on gears that the drive may have: members of a draw from what is known of its numbers.

    Examples:
        strainwave compensate gear.toml --goal smooth --members 5
        strainwave compensate gear.toml --goal speed --members 5
    """
    from strainwave.files.gear_set import GearSet
    from strainwave.report.compensate import compensate_files, compensate_summary
    from strainwave.report.provenance import Provenance
    from strainwave.tuning.compensate import compensate as compensated

    found = compensated(
        GearSet.read(drive), goal=goal, period=period, delay=delay, encoder=encoder, travel=travel, speed=speed,
        torque=torque, members=members, seed=seed,
    )  # fmt: skip
    files = compensate_files(found, Provenance.of_this_command([Path(drive)] if Path(drive).is_file() else []))
    write_report(out, files, compensate_summary(found))
