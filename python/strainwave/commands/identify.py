"""The command `strainwave identify`: any mixture of files to one gear."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strainwave.commands.file_options import Columns, Constants, Gear, Joint, Kind, Mapping, Side, Units, mapping_from_options

if TYPE_CHECKING:
    from strainwave.identification.identify import Identified
    from strainwave.identification.reading.mapping import FileMapping
    from strainwave.identification.reading.source import MeasurementFiles
    from strainwave.identification.results.file_result import FileResult
    from strainwave.report.experiment import SimulatedExperiment
    from strainwave.report.provenance import Provenance

FAILED = 3  # exit code if a check fails: no gear is written
MAX_REMARKS = 5  # of a file on the terminal; the report has all


def identify(
    gear: Gear,
    paths: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Measurements of one gear, or folders of them.")],
    mapping: Mapping = None,
    column: Columns = None,
    unit: Units = None,
    constant: Constants = None,
    side: Side = None,
    joint: Joint = None,
    kind: Kind = None,
    accept: Annotated[bool, typer.Option("--accept", help="Use files and write the gear although a check fails.")] = False,
    name: Annotated[str | None, typer.Option(help="Name of the gear; by default that of its files.")] = None,
    out: Annotated[Path, typer.Option(help="Folder for report.html, the gear and the numbers.")] = Path("out/identify"),
) -> None:
    """Determine the type of measurement files, and the gear that they show.

    Tables of friction, torsion loops, logs of the drive in motion and records of two encoders, in any order: each file is
    fitted by itself, with the reasons for its type. Of files that agree about a parameter the mean is taken. If a consistency
    check fails, it is printed first, no gear is written, and the exit code is 3.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    from strainwave.files.writing import write_folder
    from strainwave.identification.identify import identify as identified
    from strainwave.identification.joints import ALL
    from strainwave.identification.reading.source import measurement_files
    from strainwave.identification.results.drive import why_no_load
    from strainwave.report.provenance import Provenance

    opened = measurement_files(paths)
    read = [part.path for file in opened.files for part in file.parts or (file,)]
    said = mapping_from_options(mapping, column, unit, constant, side, joint, kind, opened.files)
    if joint == ALL:
        _every_joint(gear, opened, read, said, accept, name, out)
        return
    columns = (SpinnerColumn(), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("reading", total=len(read))
        done = -1

        def turn(name: str) -> None:
            nonlocal done
            done += 1
            bar.update(task, description=name, completed=min(done, len(read)))

        found = identified(gear, opened, mapping=said, accept=accept, name=name, progress=turn)
        bar.update(task, description="report", completed=len(read))
        files = files_to_write(found, Provenance.of_this_command(read), accept=accept)
        write_folder(out, files)
    print("\n".join(summary(found)))
    print(f"\nwrote {out / 'report.html'}, and beside it {', '.join(list(files)[:-1])}")
    if "gear.toml" in files and (why := why_no_load(found.files)):
        print(f"gear.toml: {found.gear_set.name}, without a load: {why}")
    if found.failed and not accept:
        print("no gear is written while a check fails: settle it, or --accept writes it")
        raise typer.Exit(FAILED)


def files_to_write(
    found: Identified,
    provenance: Provenance,
    *,
    accept: bool = False,
    experiments: Sequence[SimulatedExperiment] = (),
) -> dict[str, str]:
    """Return what is written of one gear, by the names of the files; no gear if a check failed, unless it was accepted."""
    from strainwave.files import gear_file
    from strainwave.report.identify import identify_report
    from strainwave.report.identify_files import identify_files

    files = identify_files(found)
    if accept or not found.failed:
        files["gear.toml"] = gear_file.text(found.accepted)
    return files | {"report.html": identify_report(found, provenance, experiments=experiments, accepted=accept)}


def _every_joint(
    gear: str,
    opened: MeasurementFiles,
    read: list[Path],
    said: Callable[[Path], FileMapping],
    accept: bool,
    name: str | None,
    out: Path,
) -> None:
    """All joints of an arm: a folder for each, and one page and one table of all."""
    from rich.console import Console

    from strainwave.files.writing import write_folder
    from strainwave.identification.joints import identify_joints
    from strainwave.report.joints import folder_of, joints_csv, joints_report, joints_summary
    from strainwave.report.provenance import Provenance

    with Console(stderr=True).status("reading") as status:
        joints = identify_joints(gear, opened, mapping=said, accept=accept, name=name, progress=status.update)
        status.update("report")
        provenance = Provenance.of_this_command(read)
        for joint, found in joints.found.items():
            write_folder(out / folder_of(joint), files_to_write(found, provenance, accept=accept))
        write_folder(out, {"joints.csv": joints_csv(joints), "report.html": joints_report(joints, provenance)})
    print("\n".join(joints_summary(joints)))
    folders = ", ".join(map(folder_of, joints.found))
    print(f"\nwrote {out / 'report.html'}, and beside it joints.csv and the results of each joint in {folders}")
    if not accept and any(found.failed for found in joints.found.values()):
        print("no gear is written of joints with a failed check: settle it, or --accept writes them")
        raise typer.Exit(FAILED)


def summary(found: Identified) -> Iterator[str]:
    """Yield the result in lines, failed checks first."""
    from strainwave.identification.results.combined_parameter import lines_of

    for check in found.failed:
        yield f"FAILED: {check.source}: {check.message}"
        yield f"  what to do: {check.remedy}"
    points = [result for result in found.files if result.part_of]
    for result in found.files:
        if not result.part_of:
            yield from _of_file(result)
    if points:
        yield f"{points[0].part_of}, {len(points)} files:"
        width = max(len(result.name) for result in points)
        yield from (f"  {result.name:{width}}  {result.model}" for result in points)
        yield from (f"  {remark}" for remark in dict.fromkeys(remark for result in points for remark in result.remarks))
    yield ""
    yield from lines_of(found.parameters)
    for check in found.checks:
        if check.name == "agreement of files":
            yield f"contradiction: {check.message}"


def _of_file(result: FileResult) -> Iterator[str]:
    from strainwave.identification.kinds import KINDS

    kind = result.what or (KINDS[result.recognised.kind].title if result.recognised is not None else "not read")
    same = f", the same measurement as {result.same_as}" if result.same_as else ""
    yield f"{result.name}: {kind}{same}"
    if result.recognised is not None:
        yield from (f"  since {why}" for why in result.recognised.why)
    if result.refused:
        yield f"  NOT USED: {result.refused}"
        return
    held_out = f"; error on data held out: {100.0 * result.error:.2g} % of what varies" if math.isfinite(result.error) else ""
    yield f"  {result.model}{held_out}"
    if result.failed:
        yield f"  FAILED: {', '.join(check.name for check in result.failed)}; see above"
    yield from (f"  {remark}" for remark in result.remarks[:MAX_REMARKS])
