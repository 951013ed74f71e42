"""The command `strainwave compensate`: a controller that takes away what the gear does to the motion, or numbers for it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave.commands.progress import progress

if TYPE_CHECKING:
    from strainwave.files.gear_set import GearSet


OF_SLOT = ("side", "unit", "points", "threshold", "load", "rated_torque", "temperature")  # options of a slot alone
OF_CONTROLLER = ("goal", "delay", "encoder", "torque")  # options that no slot has


def compensate(
    context: typer.Context,
    drive: Annotated[str, typer.Argument(help="A drive with motor and load: a set by name, or a file as identify writes it.")],
    goal: Annotated[
        str, typer.Option(help="position (to and fro), speed (constant), smooth (creeping) or torque.")
    ] = "position",
    period: Annotated[float, typer.Option(help="Period of the controller [s].")] = 1e-3,
    delay: Annotated[float, typer.Option(help="From a sample to the output of the controller [s].")] = 0.0,
    encoder: Annotated[str, typer.Option(help="output if the controller sees the output angle too.")] = "input",
    travel: Annotated[float | None, typer.Option(help="Travel of the output, for position [rad]; usually 0.2.")] = None,
    speed: Annotated[float | None, typer.Option(help="Speed of the output [rad/s]; usually 20 rad/s of the input.")] = None,
    torque: Annotated[
        float | None, typer.Option(help="Torque of the output, for torque [N.m]; usually a fifth of the largest.")
    ] = None,
    members: Annotated[int, typer.Option(help="Number of drawn gears; usually 40, for a slot 200.")] = 40,
    seed: Annotated[int, typer.Option(help="Seed of the draw.")] = 0,
    slot: Annotated[
        str | None,
        typer.Option(
            help="Numbers for another controller instead: viscous-coulomb-scale, coulomb-viscous, speed-table, anticogging-map "
            "or torque-offset."
        ),
    ] = None,
    side: Annotated[str | None, typer.Option(help="Of a slot: the shaft of its speeds and torques, input or output.")] = None,
    unit: Annotated[str | None, typer.Option(help="Of a slot: N.m or A.")] = None,
    points: Annotated[int | None, typer.Option(help="Of a slot: number of points of its table.")] = None,
    threshold: Annotated[float | None, typer.Option(help="Of a slot: lowest speed of the output [rad/s].")] = None,
    load: Annotated[float | None, typer.Option(help="Of a slot: torque at the output against forward motion [N.m].")] = None,
    rated_torque: Annotated[float | None, typer.Option(help="Of a slot: rated torque of the motor [N.m].")] = None,
    temperature: Annotated[float | None, typer.Option(help="Of a slot: temperature of the gear [K].")] = None,
    out: Annotated[Path, typer.Option(help="Folder for the files written.")] = Path("out/compensate"),
) -> None:
    """Find the compensation that gains most over a tuned cascade, judged on gears that the drive may have."""
    from strainwave.files.gear_set import GearSet
    from strainwave.files.writing import write_folder
    from strainwave.report.compensate import compensate_files, compensate_summary
    from strainwave.report.provenance import Provenance
    from strainwave.tuning.compensate import compensate as compensated

    stated = [name for name in context.params if str(context.get_parameter_source(name)).endswith("COMMANDLINE")]
    gear_set = GearSet.read(drive)
    if slot is not None:
        if alien := [name for name in stated if name in OF_CONTROLLER]:
            raise ValueError(f"--{alien[0]} belongs to a controller that is found, and not to a slot; leave it out")
        options = {name: context.params[name] for name in stated if name not in ("drive", "slot", "out")}
        _slot(gear_set, slot, out, options)
        return
    if alien := [name for name in stated if name in OF_SLOT]:
        raise ValueError(f"--{alien[0].replace('_', '-')} belongs to a slot; name one by --slot")
    with progress(None) as turn:
        found = compensated(
            gear_set, goal=goal, period=period, delay=delay, encoder=encoder, travel=travel, speed=speed, torque=torque,
            members=members, seed=seed, progress=turn,
        )  # fmt: skip
        turn("report")
        files = compensate_files(found, Provenance.of_this_command([Path(drive)] if Path(drive).is_file() else []))
        write_folder(out, files)
    print(compensate_summary(found))
    print(f"\nwrote {out / 'report.html'}, and beside it {', '.join(list(files)[:-1])}")


def _slot(gear_set: GearSet, name: str, out: Path, options: dict[str, Any]) -> None:
    """Write and print the numbers for a slot."""
    from strainwave.files.writing import write_folder
    from strainwave.report.slots import slot_files, slot_summary
    from strainwave.tuning.slots import slot

    found = slot(gear_set, name, **options)
    files = slot_files(found)
    write_folder(out, files)
    print(slot_summary(found))
    print(f"\nwrote {' and '.join(str(out / file) for file in files)}")
