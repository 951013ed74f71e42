"""The command `strainwave plan`: which measurements to make next."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strainwave.commands.options import numeric
from strainwave.number_texts import is_number, number_in
from strainwave.presentation import PAGE_WIDTH

if TYPE_CHECKING:
    from strainwave._core import Gear
    from strainwave.identification.reading.recognise import Recognised


def plan(
    start: Annotated[
        str, typer.Argument(help="A set by name, as hfuc-25-100, a gear file, or a data sheet: what is known so far.")
    ],
    want: Annotated[
        list[str],
        typer.Option(
            metavar="PATH",
            help="A number to know, as gear.friction_input.viscous, or a part; with --loop a source of loss, or loss for all; "
            "repeat as needed.",
        ),
    ],
    experiment: Annotated[
        list[str] | None,
        typer.Option(metavar="KIND", help="What can be made: friction, torsion; repeat as needed. Both, if not given."),
    ] = None,
    unknown: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PATH",
            help="Parameters that are not known either; if not given, the ones in the same part as the wanted ones.",
        ),
    ] = None,
    noise: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="Standard deviation in SI units, as friction=0.002; also torsion, input_torsion. Repeat as needed.",
        ),
    ] = None,
    resolution: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="Smallest difference a sensor resolves, in SI units, as angle=1e-5; also torque, input_torque, input_angle.",
        ),
    ] = None,
    loop: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="A measured torsion loop (.csv, .parquet): plan loops that separate its sources of loss; repeat as needed.",
        ),
    ] = None,
    minutes: Annotated[float, numeric("What all measurements may take together.")] = 30.0,
    criterion: Annotated[
        str | None, typer.Option(help="A: sum of relative variances, if not given; D: determinant of the covariance.")
    ] = None,
    speed_limit: Annotated[str | None, typer.Option(help='Of the input, as "2000 rpm"; the rating, if not given.')] = None,
    lowest_speed: Annotated[str | None, typer.Option(help='That can be held steady, as "5 rpm".')] = None,
    torque_limit: Annotated[str | None, typer.Option(help='At the output, as "50 N.m"; the rating, if not given.')] = None,
) -> None:
    """Rank candidate measurements by what they reach per minute.

    Candidates are the speeds of a friction table and torsion loops within the limits of the gear. The output has the standard
    deviation of each wanted number before and after, and what would remain unknown, and why. With --loop candidates are loops
    at another load, rate, temperature or side of the gear, for the shares of the sources in the loss of a cycle.

    Examples:
        strainwave plan csg-25-100 --want gear.friction_input
        strainwave plan gear.toml --want loss --loop 20Nm.csv --loop 40Nm.csv
    """
    from typing import Any

    from strainwave.arguments import number, one_of
    from strainwave.files.entries import quantity_of
    from strainwave.files.gear_set import GearSet
    from strainwave.identification.excitation.plan import plan_experiments

    if loop:
        others = {"unknown": unknown, "noise": noise, "resolution": resolution, "criterion": criterion,
                  "speed-limit": speed_limit, "lowest-speed": lowest_speed, "torque-limit": torque_limit}  # fmt: skip
        _check_alone(experiment, [name for name, value in others.items() if value])
        for line in _plan_of_loops(loop, GearSet.read(start).gear, want, 60.0 * number("--minutes", minutes, low=0.0)):
            print(line)
        return
    if "loss" in want:
        raise ValueError("--want loss plans by loops that were measured; give them, as --loop 20Nm.csv --loop 40Nm.csv")

    def in_si(option: str, given: str | None, unit: str) -> float | None:
        return None if given is None else quantity_of(option, given, unit, "command line").to(unit).value

    chosen: Any = one_of("--criterion", criterion or "A", ("A", "D"))
    kinds = [one_of("--experiment", kind, ("friction", "torsion")) for kind in experiment or ("friction", "torsion")]
    experiments = plan_experiments(
        GearSet.read(start),
        want,
        experiments=kinds,
        time=60.0 * number("--minutes", minutes, low=0.0),
        criterion=chosen,
        unknown=unknown,
        speed_limit=in_si("--speed-limit", speed_limit, "rad/s"),
        lowest_speed=in_si("--lowest-speed", lowest_speed, "rad/s"),
        torque_limit=in_si("--torque-limit", torque_limit, "N.m"),
        noise=_numbers("noise", "friction=0.002", noise or []),
        resolution=_numbers("resolution", "angle=1e-5", resolution or []),
    )
    print(experiments)


def _plan_of_loops(files: list[Path], gear: Gear, want: list[str], seconds: float) -> Iterator[object]:
    """Yield a plan of further loops, and remarks on the files of those that were measured."""
    from strainwave.identification.excitation.loops import plan_loops

    loops = _loops(files, gear)
    yield plan_loops([measured.recording for measured in loops], gear, want, time=seconds)
    for measured in loops:
        for remark in measured.remarks:
            yield textwrap.fill(f"note: {measured.path.name}: {remark}", PAGE_WIDTH, subsequent_indent="  ")


def _check_alone(experiment: list[str] | None, options: list[str]) -> None:
    """Raise ValueError for options that a plan of loops does not use."""
    if any(kind != "torsion" for kind in experiment or ()):
        raise ValueError("--loop plans torsion loops; leave out other experiments")
    if options:
        raise ValueError(f"--loop plans by the loops that were measured, up to their torque; leave out --{options[0]}")


def _of_file(file: Path, message: str) -> str:
    """Return a message with the name of its file."""
    return message if message.startswith(str(file)) else f"{file}: {message}"


def _loops(files: Sequence[Path], gear: Gear) -> list[Recognised]:
    """Return measured loops, each read as `identify` does.

    Raises:
        ValueError: a file is no loop, or two contain the same measurement
    """
    from dataclasses import replace

    from strainwave.identification.kinds.torsion_loop import lossy_loop
    from strainwave.identification.reading.mapping import FileMapping
    from strainwave.identification.reading.recognise import recognise
    from strainwave.identification.reading.several_files import same_as
    from strainwave.questions import QuestionError

    loops = []
    for file in files:
        try:
            loop = recognise(file, FileMapping(kind="torsion"))
            loop = replace(loop, recording=lossy_loop(loop, gear))
        except QuestionError as question:
            names = "call the columns twist [rad] and torque [N.m], or input_angle and input_torque, with the unit of each"
            raise ValueError(_of_file(file, f"{question.question}; {names}")) from None
        except ValueError as error:
            raise ValueError(_of_file(file, str(error))) from None
        if loop.units_assumed:
            raise ValueError(f"{file}: {loop.units_assumed[0]} has no unit; write it behind the name, as in torque [N.m]")
        loops.append(loop)
    if copies := same_as(loops):
        copy, original = next(iter(copies.items()))
        raise ValueError(f"{copy} and {original} contain the same measurement; leave one of the two out")
    return loops


def _numbers(option: str, example: str, given: list[str]) -> dict[str, float]:
    """Return the numbers of an option by their names."""
    found = {}
    for each in given:
        name, _, value = each.partition("=")
        if not is_number(value):
            raise ValueError(f"--{option} {each}: write it as --{option} {example}")
        found[name] = number_in(value)
    return found
