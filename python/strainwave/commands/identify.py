"""The command `strainwave identify`: any mixture of files to one gear."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strainwave.commands.file_options import Columns, Constants, Gear, Joint, Kind, Mapping, Side, Units, mapping_from_options

if TYPE_CHECKING:
    from strainwave.identification.identify import Identified
    from strainwave.identification.reading.mapping import FileMapping
    from strainwave.identification.reading.source import MeasurementFiles
    from strainwave.identification.results.file_result import FileResult
    from strainwave.report.provenance import Provenance

MOST_REMARKS = 5  # of a file on the terminal; the report has all


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
    accept: Annotated[bool, typer.Option("--accept", help="Use tables and loops although their sizes are doubted.")] = False,
    out: Annotated[Path, typer.Option(help="Folder for report.html, the gear and the numbers.")] = Path("out/identify"),
) -> None:
    """Find out what files of measurements are, and what gear they show.

    Tables of friction, torsion loops, logs of the drive in motion and records of two encoders, in any order: each file is told
    what it seems to be and why, and fitted by itself. Of files that agree about a number the mean is taken; where files
    contradict each other, both values are shown.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    from strainwave.files.writing import write_folder
    from strainwave.identification.identify import identify as identified
    from strainwave.identification.joints import ALL
    from strainwave.identification.reading.source import measurement_files
    from strainwave.report.provenance import Provenance

    opened = measurement_files(paths)
    read = [part.path for file in opened.files for part in file.parts or (file,)]
    said = mapping_from_options(mapping, column, unit, constant, side, joint, kind, opened.files)
    if joint == ALL:
        _every_joint(gear, opened, read, said, accept, out)
        return
    columns = (SpinnerColumn(), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=len(read))
        done = -1

        def turn(name: str) -> None:
            nonlocal done
            done += 1
            bar.update(task, description=name, completed=min(done, len(read)))

        found = identified(gear, opened, mapping=said, accept=accept, progress=turn)
        bar.update(task, description="report", completed=len(read))
        files = _files(found, Provenance.of_this_command(read))
        write_folder(out, files)
    print("\n".join(_summary(found)))
    print(f"\nwrote {out / 'report.html'}, and beside it {', '.join(list(files)[:-1])}")


def _files(found: Identified, provenance: Provenance) -> dict[str, str]:
    """What is written of one gear, by the names of the files."""
    from strainwave.files import gear_file
    from strainwave.report.identify import identify_files, identify_report

    files = identify_files(found) | {"gear.toml": gear_file.text(found.gear_set)}
    return files | {"report.html": identify_report(found, provenance)}


def _every_joint(
    gear: str, opened: MeasurementFiles, read: list[Path], said: Callable[[Path], FileMapping], accept: bool, out: Path
) -> None:
    """All joints of an arm: a folder for each, and one page and one table of all."""
    from rich.console import Console

    from strainwave.files.writing import write_folder
    from strainwave.identification.joints import identify_joints
    from strainwave.report.joints import folder_of, joints_csv, joints_report, joints_summary
    from strainwave.report.provenance import Provenance

    with Console(stderr=True).status("reading") as status:
        joints = identify_joints(gear, opened, mapping=said, accept=accept, progress=status.update)
        status.update("report")
        provenance = Provenance.of_this_command(read)
        for name, found in joints.found.items():
            write_folder(out / folder_of(name), _files(found, provenance))
        write_folder(out, {"joints.csv": joints_csv(joints), "report.html": joints_report(joints, provenance)})
    print("\n".join(joints_summary(joints)))
    folders = ", ".join(map(folder_of, joints.found))
    print(f"\nwrote {out / 'report.html'}, and beside it joints.csv and the results of each joint in {folders}")


def _summary(found: Identified) -> Iterator[str]:
    from strainwave.identification.results.file_result import lines_of

    points = [finding for finding in found.files if finding.part_of]
    for finding in found.files:
        if not finding.part_of:
            yield from _of_file(finding)
    if points:
        yield f"{points[0].part_of}, {len(points)} files:"
        width = max(len(finding.name) for finding in points)
        yield from (f"  {finding.name:{width}}  {finding.model}" for finding in points)
        yield from (f"  {remark}" for remark in dict.fromkeys(remark for finding in points for remark in finding.remarks))
    yield ""
    yield from lines_of(found.parameters)
    for number in found.parameters:
        for other in number.contradicts:
            best, value = number.of_file(number.source), number.others[other]
            yield (
                f"contradiction: {number.estimate.label} = {best.value:.4g} ± {best.sigma:.2g} {best.unit} in "
                f"{number.source}, {value.value:.4g} ± {value.sigma:.2g} in {other}"
            )


def _of_file(finding: FileResult) -> Iterator[str]:
    from strainwave.identification.reading.kind import KINDS

    kind = finding.what or (KINDS[finding.recognised.kind] if finding.recognised is not None else "not read")
    same = f", the same measurement as {finding.same_as}" if finding.same_as else ""
    yield f"{finding.name}: {kind}{same}"
    if finding.recognised is not None:
        yield from (f"  since {why}" for why in finding.recognised.why)
    if finding.refused:
        yield f"  NOT USED: {finding.refused}"
        return
    held_out = f"; error on data held out: {100.0 * finding.error:.2g} % of what varies" if math.isfinite(finding.error) else ""
    yield f"  {finding.model}{held_out}"
    yield from (f"  DOUBT: {doubt}" for doubt in finding.doubts)
    yield from (f"  {remark}" for remark in finding.remarks[:MOST_REMARKS])
