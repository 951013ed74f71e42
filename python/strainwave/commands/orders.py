"""The command `strainwave orders`: kinematic error from two encoders, ripple from torque or current."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave.commands.file_options import FileOptions
from strainwave.commands.options import folder, numeric, with_groups
from strainwave.commands.output import write_report
from strainwave.progress import in_turn

if TYPE_CHECKING:
    from strainwave.files.recording import Recording
    from strainwave.identification.reading.source import MeasurementFile
    from strainwave.orders.measured import OrdersFound

MIN_RECORDINGS = 12  # at constant speeds, whose orders are compared over the speed


@with_groups
def orders(
    paths: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Recordings of a drive, each examined separately.")],
    given: FileOptions,
    ratio: Annotated[float | None, numeric("Ratio of the gear, with all its digits; found, if the file determines it.")] = None,
    rate: Annotated[float | None, numeric("Samples per second of files without time, in Hz.")] = None,
    highest: Annotated[float | None, numeric("Order up to which ripple is looked for, at most 100000.")] = None,
    out: Annotated[Path, folder("Folder for report.html, the numbers and the spectra.")] = Path("out/orders"),
) -> None:
    """Find kinematic error, ripple and ratio of a gear in recordings.

    The angles of both shafts determine ratio, kinematic error and lost motion. Torque or current and one angle determine the
    lines that repeat with the angle, and from them the ratio. Lines that repeat with time, as mains and resonances, are
    separated if the speed varies; lines of other joints that move, if their angles are in the file.
    Angles of both shafts in a run-up, or in twelve files or more at constant speeds, determine the modes that orders pass.

    Examples:
        strainwave orders robot_log.csv
        strainwave orders robot_log.csv --ratio 80 --out out/ripple
    """
    from strainwave.arguments import number
    from strainwave.files.gear_set import catalogue
    from strainwave.identification.reading.mapping import check_constant
    from strainwave.identification.reading.source import measurement_files
    from strainwave.messages import one_line
    from strainwave.orders.measured import OrdersFound, modes_of
    from strainwave.orders.torque_ripple import MAX_ORDER
    from strainwave.questions import QuestionError
    from strainwave.report.orders import orders_files, orders_summary
    from strainwave.report.provenance import Provenance

    for option, value in (("ratio", ratio), ("rate", rate)):
        if value is not None:
            check_constant(f"--{option}", option, value)
    if highest is not None:
        number("--highest", highest, brackets="(]", low=0.0, high=MAX_ORDER)
    if sets := [str(path) for path in paths if not path.exists() and str(path) in catalogue()]:
        raise ValueError(
            f"{sets[0]} is a gear set; orders are found in files alone: leave it out, and give --ratio if it is known"
        )
    runs = [run for file in measurement_files(paths).files for run in file.runs]
    with in_turn(None, len(runs)) as turn:
        found, recordings = [], []
        for run in runs:
            turn(run.path.name)
            try:
                of_file, recording = _of_file(run, given, ratio, rate, highest)
                found.append(of_file)
                recordings.append(recording)
            except QuestionError as question:
                raise (question if run.path.name in question.question else question.of(run.path.name)) from None
            except ValueError as error:
                raise ValueError(one_line(str(error) if str(run.path) in str(error) else f"{run.path}: {error}")) from None
        modes = modes_of(recordings) if len(recordings) >= MIN_RECORDINGS else None
        together = None if modes is None else OrdersFound(f"{len(recordings)} recordings together", None, None, modes=modes)
        turn("report")
        files = orders_files(found, Provenance.of_this_command(paths), together)
    write_report(out, files, orders_summary(found, together))


def _of_file(
    file: MeasurementFile, given: FileOptions, ratio: float | None, rate: float | None, highest: float | None
) -> tuple[OrdersFound, Recording]:
    from strainwave.identification.kinds.positioning import positioning_of, positioning_words
    from strainwave.identification.reading.recognise import recognise
    from strainwave.orders.measured import OrdersFound, orders_found

    mapping = given.mapping_of([file])(file.path)
    constants = mapping.constants if rate is None else {**mapping.constants, "rate": rate}
    read = recognise(file, replace(mapping, constants=constants))
    ratio = read.constants.get("ratio") if ratio is None else ratio
    read = read if ratio is None else read.at_ratio(ratio)  # a motor angle in joint units
    if read.kind == "positioning":
        steps = positioning_of(read)
        words = (*read.remarks, *positioning_words(steps, read.side, ratio), *steps.remarks)
        return OrdersFound(file.path.name, None, None, words), read.recording
    side: Any = mapping.side
    found = orders_found(read.recording, file.path.name, ratio=ratio, side=side, highest=highest, other_angles=read.neighbours)
    return replace(found, remarks=(*read.remarks, *found.remarks)), read.recording
