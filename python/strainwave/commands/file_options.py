"""Options of commands that read measurement files, declared once for all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave.identification.kinds import KINDS
from strainwave.messages import listed, pairs, quoted, unquoted
from strainwave.questions import NUMBER

if TYPE_CHECKING:
    from strainwave.identification.reading.mapping import FileMapping
    from strainwave.identification.reading.source import MeasurementFile, MeasurementFiles

Gear = Annotated[
    str,
    typer.Argument(
        help="Where to start: a catalogue set, as hfuc-25-100, or a gear file; of an unknown gear a set of about its size."
    ),
]


@dataclass(frozen=True)
class FileOptions:
    """Options that state what measurement files contain."""

    mapping: Annotated[Path | None, typer.Option(help="TOML file with the columns of all or some files.")] = None
    column: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=COLUMN", help="A column's name or number in the files, as speed=3; repeat as needed."),
    ] = None
    unit: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=UNIT", help="Unit of a column whose header has none, as torque=N.m; repeat as needed."),
    ] = None
    constant: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="A number that belongs to the files, as rate=500 or torque_constant='75 mN.m/A'; repeat as needed.",
        ),
    ] = None
    side: Annotated[
        str | None, typer.Option(help="Side of a table, or of angles, whose names do not contain it: input or output.")
    ] = None
    joint: Annotated[str | None, typer.Option(help="Joint, of files with several; with identify, all takes every one.")] = None
    kind: Annotated[str | None, typer.Option(help=f"Kind of files that may be of two kinds: {', '.join(KINDS)}.")] = None

    def __post_init__(self) -> None:
        from strainwave.arguments import one_of

        if self.side is not None:
            one_of("side", self.side, ("input", "output"))

    def mapping_of(self, files: Sequence[MeasurementFile]) -> Callable[[Path], FileMapping]:
        """Return the function that gives the mapping of each file: of its own columns, the options before the mapping file.

        Args:
            files: that the command reads

        Raises:
            ValueError: an option is not written as it must be, or names no channel, or a column that none of the files has
        """
        from strainwave.identification.reading.mapping import CONSTANTS, FileMapping, MappingFile
        from strainwave.identification.reading.names import CHANNEL_ALIASES, CHANNELS, UNUSED
        from strainwave.identification.reading.source import measurement_file

        side: Any = self.side
        channels = {*CHANNELS, *CHANNEL_ALIASES}
        if open_words := [word for word in (*(self.unit or ()), *(self.constant or ())) if NUMBER in word]:
            raise ValueError(f"{quoted(open_words[0])}: write the number in place of {NUMBER}")
        columns = pairs("--column", self.column, {*channels, UNUSED})
        names = {name for file in files for name in file.names} if columns or self.unit else set[str]()
        for channel, column in columns.items() if names else ():
            if not any(_has(file, column) for file in files):
                plain = listed(sorted(name for name in names if " [" not in name))
                raise ValueError(
                    f"--column {channel}={unquoted(column)}: no file has a column {quoted(column)}; there are {plain}"
                )
        units = pairs("--unit", self.unit, channels | names)
        constants = pairs("--constant", self.constant, set(CONSTANTS))
        from_file = MappingFile.read(self.mapping) if self.mapping is not None else None
        opened = {file.path: file for file in files}

        def of(path: Path) -> FileMapping:
            file = opened.get(path) or measurement_file(path)
            own = {channel: column for channel, column in columns.items() if _has(file, column)}
            of_it = {name: unit for name, unit in units.items() if name in channels or name in file.names}
            given = FileMapping(own, of_it, constants=constants, side=side, joint=self.joint, kind=self.kind)
            return from_file.of(path).updated(given) if from_file is not None else given

        return of


def paths_in(files: MeasurementFiles) -> list[Path]:
    """Return the paths of all files that a command reads, those of a measurement in several files one by one."""
    return list(dict.fromkeys(part.path for file in files.files for part in file.parts or (file,)))


def _has(file: MeasurementFile, column: str) -> bool:
    """True if a file has a column, or each of several separated by commas: by name, or perhaps by number."""
    parts = map(str.strip, column.split(","))
    return file.has(column) or all(file.has(part) or (part.isascii() and part.isdigit()) for part in parts)
