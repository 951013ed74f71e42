"""What commands that read any files ask of them: the options, and what they say of a file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave.identification.kinds import KINDS
from strainwave.messages import quoted
from strainwave.number_texts import is_whole, number_in

if TYPE_CHECKING:
    from strainwave.identification.reading.mapping import FileMapping
    from strainwave.identification.reading.source import MeasurementFile

Gear = Annotated[str, typer.Argument(help="Where to start: a catalogue set, as hfuc-25-100, or a gear file.")]
Mapping = Annotated[Path | None, typer.Option(help="TOML file that says what is in which column, for all files or for some.")]
Columns = Annotated[
    list[str] | None, typer.Option(help="A column's name or number in the files, as speed=3; repeat as needed.")
]
Units = Annotated[
    list[str] | None, typer.Option(help="Unit of a column whose header has none, as torque=N.m; repeat as needed.")
]
Constants = Annotated[
    list[str] | None,
    typer.Option(help="A number that belongs to the files, as rate=500 or torque_constant='75 mN.m/A'; repeat as needed."),
]
Side = Annotated[str | None, typer.Option(help="Where a table or angles were measured that do not say it: input or output.")]
Kind = Annotated[str | None, typer.Option(help=f"What files are that may be two things: {', '.join(KINDS)}.")]
Joint = Annotated[str | None, typer.Option(help="Which joint, of files with several; with identify, all takes every one.")]


def number_option(value: str | float) -> float:
    """Return the number of an option; one that is not given stands for itself.

    Raises:
        typer.BadParameter: it is no number
    """
    if isinstance(value, float):
        return value
    try:
        return number_in(value)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


def whole_option(value: str | int) -> int:
    """Return the whole number of an option; one that is not given stands for itself.

    Raises:
        typer.BadParameter: it is no whole number
    """
    if isinstance(value, int):
        return value
    if not is_whole(value):
        raise typer.BadParameter(f"{quoted(value)} is no whole number; write digits, at most 18")
    return int(value)


def mapping_from_options(
    mapping: Path | None,
    column: list[str] | None,
    unit: list[str] | None,
    constant: list[str] | None,
    side: Any,
    joint: str | None,
    kind: Any = None,
    files: Sequence[MeasurementFile] = (),
) -> Callable[[Path], FileMapping]:
    """What the options say of a file: of columns that it has; over what the mapping file says.

    Raises:
        ValueError: an option is not written as it must be, or names what is no channel and no column of any of the files
    """
    from strainwave.identification.reading.channels import ALIASES, CHANNELS
    from strainwave.identification.reading.mapping import CONSTANTS, FileMapping, MappingFile, constant_of
    from strainwave.identification.reading.source import measurement_file
    from strainwave.messages import pairs

    known = {*CHANNELS, *ALIASES}
    names = known.union(*(file.names for file in files)) if unit else known
    columns, units = pairs("--column", column, known), pairs("--unit", unit, names)
    constants = {name: constant_of(name, value) for name, value in pairs("--constant", constant, set(CONSTANTS)).items()}
    from_file = MappingFile.read(mapping) if mapping is not None else None
    opened = {file.path: file for file in files}

    def of(path: Path) -> FileMapping:
        file = opened.get(path) or measurement_file(path)
        own = {name: each for name, each in columns.items() if file.has(each) or _are_there(each.split(","), file)}
        of_it = {name: each for name, each in units.items() if name in known or name in file.names}
        given = FileMapping(columns=own, units=of_it, constants=constants, side=side, joint=joint, kind=kind)
        return from_file.of(path).updated(given) if from_file is not None else given

    return of


def _are_there(parts: Sequence[str], file: MeasurementFile) -> bool:
    """True if each part is a name, or may be the number of a column."""
    return all(file.has(part) or (part.isascii() and part.isdigit()) for part in map(str.strip, parts))


def names_in(path: Path) -> set[str]:
    """Column names of a file. Empty if the file cannot be read; `recognise` then reports the error."""
    from strainwave.identification.reading.source import measurement_file

    return measurement_file(path).names
