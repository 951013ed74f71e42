"""The command `strainwave diagnose misalignment`: what a misaligned wave generator does to a drive."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave.commands.options import folder, numeric


def misalignment(
    drive: Annotated[str, typer.Argument(help="A drive: its file, or a set by name; its controller a cascade.")],
    stroke: Annotated[float, numeric("Stroke of the output in degrees.")] = 90.0,
    time: Annotated[float, numeric("Time of the ramp through the stroke in s.")] = 5.0,
    out: Annotated[Path, folder("Folder for the tables.")] = Path("out/misalignment"),
) -> None:
    """Sweep the misalignment of the wave generator of a drive.

    Runs a ramp of the output over levels of each eccentricity and tilt, for each way in which the lobes may share, with the
    position loop closed on the output and on the motor encoder. Prints half swings of error, torque, current and output.

    Examples:
        strainwave diagnose misalignment tilt-actuator-lumped --stroke 20 --time 1
        strainwave diagnose misalignment tilt-actuator-lumped --stroke 20 --time 2
    """
    from itertools import product
    from math import radians

    from strainwave.diagnose.actuator_ramp import LOOPS, ActuatorRamp, in_series, wave_generator
    from strainwave.diagnose.inversion import COMBINE
    from strainwave.diagnose.misalignment_sweep import BOTH_LOOPS, LOBES, level_lines, sweep_misalignment
    from strainwave.files import writing
    from strainwave.files.gear_set import GearSet
    from strainwave.progress import in_turn

    ramp = ActuatorRamp.of(GearSet.read(drive).drive, radians(stroke), time)
    law, assumed = wave_generator(ramp.drive)
    found = {}
    with in_turn(None, len(LOOPS) * len(COMBINE)) as turn:
        for loop, combine in product(LOOPS, COMBINE):
            turn(f"{LOBES[combine]}, loop on the {LOOPS[loop]}")
            found[loop, combine] = sweep_misalignment(in_series(ramp).closed_on(loop), law.replace(combine=combine))
    with writing.making(out):
        for (loop, combine), levels in found.items():
            levels.table.to_csv(out / f"levels-{combine}-{loop}.csv")
            writing.written.append(out / f"levels-{combine}-{loop}.csv")
    for loop, sweep in product(LOOPS, BOTH_LOOPS):
        print("\n".join([*level_lines([found[loop, combine] for combine in COMBINE], sweep), ""]))
    print("Half swings of the error, and of the differences that it makes; each peak over that without misalignment.")
    if assumed:
        print("The drive has no law of misalignment: the dimensions of the wave generator are assumed.")
    print(f"wrote {len(found)} tables into {out}")
