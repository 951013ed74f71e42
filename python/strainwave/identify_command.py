"""The command `strainwave identify`: any mixture of files to one gear."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from strainwave.identification.findings import Finding, Number
    from strainwave.identification.identify import Identified
    from strainwave.identification.reading.mapping import FileMapping

MOST_REMARKS = 5  # of a file on the terminal; the report has all


def identify(
    gear: Annotated[str, typer.Argument(help="Where to start: a catalogue set, as hfuc-25-100, or a gear file.")],
    paths: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Measurements of one gear, of any kind.")],
    mapping: Annotated[
        Path | None, typer.Option(help="TOML file that says what is in which column, for all files or for some.")
    ] = None,
    column: Annotated[
        list[str] | None, typer.Option(help="A column's name or number in the files, as speed=3; repeat as needed.")
    ] = None,
    unit: Annotated[
        list[str] | None, typer.Option(help="Unit of a column whose header has none, as torque=N.m; repeat as needed.")
    ] = None,
    constant: Annotated[
        list[str] | None,
        typer.Option(help="A number that belongs to the files, as rate=500 or torque_constant='75 mN.m/A'; repeat as needed."),
    ] = None,
    side: Annotated[
        str | None, typer.Option(help="Where a table or angles were measured that do not say it: input or output.")
    ] = None,
    joint: Annotated[str | None, typer.Option(help="Which joint, of files with several.")] = None,
    out: Annotated[Path, typer.Option(help="Folder for report.html, the gear and the numbers.")] = Path("out/identify"),
) -> None:
    """Find out what files of measurements are, and what gear they show.

    Tables of friction, torsion loops, logs of the drive in motion and records of two encoders, in any order: each file is told
    what it seems to be and why, and fitted by itself. Every number is taken from the file that tells it best, and where files
    disagree, both values are shown.
    """
    import signal

    from rich.console import Console

    from strainwave.files import gear_file
    from strainwave.files.writing import making, write_all, written
    from strainwave.identification.identify import identify as identified
    from strainwave.report.identify import identify_files, identify_report
    from strainwave.report.provenance import Provenance

    said = said_of(mapping, column, unit, constant, side, joint)
    with Console(stderr=True).status("reading") as status:
        found = identified(gear, paths, mapping=said, progress=status.update)
        status.update("report")
        files = identify_files(found) | {"gear.toml": gear_file.text(found.gear_set)}
        files["report.html"] = identify_report(found, Provenance.of_this_command(paths))
        heeded = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            with making(out):
                write_all({out / name: content for name, content in files.items()})
            written.append(out)
        finally:
            signal.signal(signal.SIGINT, heeded)
    print("\n".join(_summary(found)))
    print(f"\nwrote {out / 'report.html'}, and beside it {', '.join(list(files)[:-1])}")


def said_of(
    mapping: Path | None,
    column: list[str] | None,
    unit: list[str] | None,
    constant: list[str] | None,
    side: Any,
    joint: str | None,
) -> Callable[[Path], FileMapping]:
    """What the options say of a file: of columns that it has; over what the mapping file says."""
    from strainwave.files.tables import open_table
    from strainwave.identification.reading.channels import ALIASES, CHANNELS
    from strainwave.identification.reading.mapping import CONSTANTS, FileMapping, MappingFile, constant_of
    from strainwave.messages import pairs

    known = {*CHANNELS, *ALIASES}
    columns, units = pairs("--column", column, known), pairs("--unit", unit, known)
    constants = {name: constant_of(name, value) for name, value in pairs("--constant", constant, set(CONSTANTS)).items()}
    from_file = MappingFile.read(mapping) if mapping is not None else None

    def of(path: Path) -> FileMapping:
        there = {text for label in open_table(path).labels for text in (label.text, label.name)} if columns else set()
        own = {name: wanted for name, wanted in columns.items() if wanted in there or wanted.isdigit()}
        given = FileMapping(columns=own, units=units, constants=constants, side=side, joint=joint)
        return from_file.of(path).updated(given) if from_file is not None else given

    return of


def _summary(found: Identified) -> Iterator[str]:
    for finding in found.findings:
        yield from _of_file(finding)
    yield ""
    width = max(len(_name(number)) for number in found.numbers)
    for number in found.numbers:
        told = number.told
        yield f"  {_name(number):{width}}  {told.value:11.5g} ± {told.sigma:<8.2g} {told.unit:12} {number.source}"
    for number in found.numbers:
        for other in number.contradicts:
            value = number.others[other]
            yield (
                f"contradiction: {_name(number)} = {number.told.value:.4g} ± {number.told.sigma:.2g} {number.told.unit} in "
                f"{number.source}, {value.value:.4g} ± {value.sigma:.2g} in {other}"
            )


def _of_file(finding: Finding) -> Iterator[str]:
    from strainwave.identification.reading.channels import KINDS

    kind = KINDS[finding.recognised.kind] if finding.recognised is not None else "not read"
    same = f", the same measurement as {finding.same_as}" if finding.same_as else ""
    yield f"{finding.name}: {kind}{same}"
    if finding.recognised is not None:
        yield from (f"  since {why}" for why in finding.recognised.why)
    if finding.refused:
        yield f"  NOT USED: {finding.refused}"
        return
    held_out = f"; error on data held out: {100.0 * finding.error:.2g} % of what varies" if math.isfinite(finding.error) else ""
    yield f"  {finding.model}{held_out}"
    yield from (f"  {remark}" for remark in finding.remarks[:MOST_REMARKS])


def _name(number: Number) -> str:
    return f"{number.told.path} ({number.told.law})" if number.told.law.startswith(("in ", "of ")) else number.told.path
