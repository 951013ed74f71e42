"""The command `strainwave orders`: kinematic error from two encoders, ripple from torque or current."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave.commands.file_options import Columns, Joint, Kind, Units, names_in, number_option

if TYPE_CHECKING:
    from strainwave.orders.measured import OrdersFound


def orders(
    paths: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Recordings of a drive, each examined separately.")],
    ratio: Annotated[
        float | None,
        typer.Option(
            parser=number_option,
            help="Ratio of the gear, if it is known, with all its digits; else it is found, if the file determines it.",
        ),
    ] = None,
    column: Columns = None,
    unit: Units = None,
    side: Annotated[str | None, typer.Option(help="Side of an angle whose name does not contain it: input or output.")] = None,
    rate: Annotated[
        float | None, typer.Option(parser=number_option, help="Samples per second of files without time, in Hz.")
    ] = None,
    joint: Joint = None,
    kind: Kind = None,
    highest: Annotated[
        float | None, typer.Option(parser=number_option, help="Order up to which ripple is looked for, at most 100000.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for report.html, the numbers and the spectra.")] = Path("out/orders"),
) -> None:
    """Find the orders of a gear: its kinematic error from two encoders, its ripple from torque or current.

    The angles of both shafts determine ratio, kinematic error and lost motion. Torque or current and one angle determine the
    lines that repeat with the angle, and from them the ratio. Lines that repeat with time, as mains and resonances, are
    separated if the speed varies; lines of other joints that move, if their angles are in the file.
    """
    from rich.console import Console

    from strainwave.arguments import number, one_of
    from strainwave.files.writing import write_folder
    from strainwave.identification.reading.mapping import check_constant
    from strainwave.messages import one_line
    from strainwave.orders.ripple import MAX_ORDER
    from strainwave.report.orders import orders_files, orders_report, orders_summary
    from strainwave.report.provenance import Provenance

    if side is not None:
        one_of("side", side, ("input", "output"))
    for option, value in (("ratio", ratio), ("rate", rate)):
        if value is not None:
            check_constant(f"--{option}", option, value)
    if highest is not None:
        number("--highest", highest, brackets="(]", low=0.0, high=MAX_ORDER)
    _check_files(paths)
    with Console(stderr=True).status("reading") as status:
        found = []
        for path in paths:
            status.update(path.name)
            try:
                found.append(_of_file(path, ratio, column or (), unit or (), side, rate, joint, kind, highest))
            except ValueError as error:
                raise ValueError(one_line(str(error) if str(path) in str(error) else f"{path}: {error}")) from None
        status.update("report")
        files = orders_files(found)
        files["report.html"] = orders_report(found, Provenance.of_this_command(paths))
        write_folder(out, files)
    print(orders_summary(found))
    print(f"\nwrote {out / 'report.html'}, and beside it {', '.join(list(files)[:-1])}")


def _check_files(paths: Sequence[Path]) -> None:
    """Raise ValueError for the name of a gear set, which other commands take before the files."""
    from strainwave.files.gear_set import catalogue

    sets = [str(path) for path in paths if not path.exists() and str(path) in catalogue()]
    if sets:
        raise ValueError(
            f"{sets[0]} is a gear set; orders are found in files alone: leave it out, and give --ratio if it is known"
        )


def _of_file(
    path: Path,
    ratio: float | None,
    column: Sequence[str],
    unit: Sequence[str],
    side: str | None,
    rate: float | None,
    joint: str | None,
    kind: Any,
    highest: float | None,
) -> OrdersFound:
    from dataclasses import replace

    from strainwave.identification.reading.channels import CHANNELS
    from strainwave.identification.reading.mapping import FileMapping
    from strainwave.identification.reading.recognise import recognise
    from strainwave.messages import pairs
    from strainwave.orders.measured import orders_found

    where: Any = side
    known = set(CHANNELS)
    names = known | names_in(path) if unit else known
    mapping = FileMapping(
        columns=pairs("--column", list(column), known),
        units=pairs("--unit", list(unit), names),
        constants={} if rate is None else {"rate": rate},
        joint=joint,
        side=where,
        kind=kind,
    )
    read = recognise(path, mapping)
    read = read if ratio is None else read.at_ratio(ratio)  # a motor angle in joint units
    found = orders_found(read.recording, path.name, ratio=ratio, side=where, highest=highest, other_angles=read.neighbours)
    return replace(found, remarks=(*read.remarks, *found.remarks))
