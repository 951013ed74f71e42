"""The command `strainwave identify`: any mixture of files to one gear, or to one for each joint."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strainwave import exit_codes
from strainwave.commands.file_options import FileOptions, Gear, paths_in
from strainwave.commands.options import folder, with_groups
from strainwave.commands.output import write_report
from strainwave.progress import in_turn
from strainwave.questions import ALL_JOINTS

if TYPE_CHECKING:
    from strainwave.identification.reading.mapping import FileMapping
    from strainwave.identification.reading.source import MeasurementFiles


@with_groups
def identify(
    gear: Gear,
    paths: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Measurements of one gear, or folders of them.")],
    given: FileOptions,
    rank: Annotated[
        bool, typer.Option("--rank", help="Also fit every model of each file, and rank them by their error on held-out data.")
    ] = False,
    accept: Annotated[bool, typer.Option("--accept", help="Use files and write the gear although a check fails.")] = False,
    name: Annotated[str | None, typer.Option(help="Name of the gear; by default that of its files.")] = None,
    out: Annotated[Path, folder("Folder for report.html, the gear and the numbers.")] = Path("out/identify"),
) -> None:
    r"""Identify a gear from measurement files.

    Tables of friction, torsion loops, logs of the drive in motion and records of two encoders, in any order: each file is
    fitted by itself, with the reasons for its type. Of files that agree about a parameter the mean is taken. If a consistency
    check fails, it is printed first, no gear is written, and the exit code is 3.

    With --rank the model to take stands first in a table of each file: the simplest whose error exceeds the smallest by no more
    than chance explains. The correlation of residuals shows what a model leaves unexplained; 1 is white noise.

    Examples:
        strainwave identify hfuc-20-80 robot_log.csv \
          --constant torque_constant=0.0755
        strainwave identify hfuc-20-80 friction.csv --rank
    """
    from strainwave.identification.reading.source import measurement_files

    if rank and given.joint == ALL_JOINTS:
        raise ValueError("--rank ranks the models of one joint: give its name as --joint, or leave --rank out")
    opened = measurement_files(paths)
    fit = _every_joint if given.joint == ALL_JOINTS else _one_gear
    mapping = given.mapping_of(opened.files)
    failed = fit(gear, opened, mapping, accept, name, out)
    if rank:
        print("", *_ranking(gear, opened, mapping), sep="\n")
    if failed and not accept:
        print("a gear with a failed check is not written: settle it, or --accept writes it")
        raise typer.Exit(exit_codes.RESULT_CONTRADICTED)


def _one_gear(
    gear: str, opened: MeasurementFiles, mapping: Callable[[Path], FileMapping], accept: bool, name: str | None, out: Path
) -> bool:
    """Write and print the gear of all files. Return True if a check fails."""
    from strainwave.identification.identify import identify as identified
    from strainwave.report.first_screen import next_lines
    from strainwave.report.identify_files import identify_files, identify_summary
    from strainwave.report.provenance import Provenance

    read = paths_in(opened)
    found = identified(gear, opened, mapping=mapping, accept=accept, name=name)
    files = identify_files(found, Provenance.of_this_command(read), accepted=accept, folder=out)
    write_report(out, files, "\n".join(identify_summary(found)))
    if "gear.toml" in files:
        print("\n".join(next_lines(found, out)))
    return bool(found.failed)


def _ranking(gear: str, opened: MeasurementFiles, mapping: Callable[[Path], FileMapping]) -> Iterator[str]:
    """Yield the lines of a table of all models for each file that can be used."""
    from strainwave.files.gear_set import GearSet
    from strainwave.identification.identify import read_measurements
    from strainwave.identification.kinds import KINDS
    from strainwave.identification.kinds.kind import rank, table_of
    from strainwave.identification.reading.recognise import Recognised

    with in_turn(None, len(opened.files)) as turn:
        read, start = read_measurements(opened, mapping, GearSet.read(gear))
        for path, file in read.items():
            turn(path.name)
            if isinstance(file, Recognised):
                try:
                    lines = table_of(rank(start, file))
                except ValueError as error:
                    lines = [f"not ranked: {error}"]
                yield from (f"{path.name}: {KINDS[file.kind].title}", *(f"  {line}" for line in lines))


def _every_joint(
    gear: str, opened: MeasurementFiles, mapping: Callable[[Path], FileMapping], accept: bool, name: str | None, out: Path
) -> bool:
    """Write and print the gear of each joint, one page and one table of all. Return True if a check of any fails."""
    from strainwave.files.writing import write_folder
    from strainwave.identification.joints import identify_joints
    from strainwave.report.identify_files import identify_files
    from strainwave.report.joints import folder_of, joints_files, joints_summary
    from strainwave.report.provenance import Provenance

    joints = identify_joints(gear, opened, mapping=mapping, accept=accept, name=name)
    provenance = Provenance.of_this_command(paths_in(opened))
    for joint, found in joints.found.items():
        write_folder(out / folder_of(joint), identify_files(found, provenance, accepted=accept, folder=out / folder_of(joint)))
    write_folder(out, joints_files(joints, provenance))
    print("\n".join(joints_summary(joints)))
    folders = ", ".join(map(folder_of, joints.found))
    print(f"\nwrote {out / 'report.html'}, and beside it joints.csv and the results of each joint in {folders}")
    return any(found.failed for found in joints.found.values())
