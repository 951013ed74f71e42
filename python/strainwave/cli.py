"""The command `strainwave`: thin; it reads files, calls the package and writes files."""

from __future__ import annotations

import os
import shlex
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, redirect_stdout
from datetime import UTC, datetime
from io import StringIO, TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TextIO

import typer

from strainwave.messages import listed, one_line, unquoted, with_options

if TYPE_CHECKING:
    from strainwave.files.gear_set import GearSet
    from strainwave.identify.measurement import Kind
    from strainwave.identify.twin import Twin
    from strainwave.report.twin import Provenance

REFUSED = 2  # exit code for input that cannot be used
DOUBTED = 3  # exit code for measurements that speak against themselves: no gear is written
written: list[Path] = []  # folders that hold results of this command by now

app = typer.Typer(
    help="Strain wave gears: measurements in, a validated model of that gear out.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # plain help: rich alone takes longer to import than the help may take to appear
    pretty_exceptions_enable=False,
)


def _show_version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        print(f"strainwave {version('strainwave')}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and end.", callback=_show_version, is_eager=True)
    ] = False,
) -> None:
    """What comes before a verb."""


@app.command()
def twin(
    gear: Annotated[str, typer.Option(help="Where to start: a catalogue set, as hfuc-25-100, or a gear file.")],
    friction: Annotated[Path | None, typer.Option(help="Table of steady friction: speed, torque.")] = None,
    torsion: Annotated[
        Path | None,
        typer.Option(help="Torsion loop or branch: twist, torque; or input_angle, input_torque with the output locked."),
    ] = None,
    log: Annotated[
        Path | None, typer.Option(help="Run from rest: time, command, position, output_angle, current … as measured.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for gear.toml and report.html.")] = Path("twin"),
    side: Annotated[
        str | None, typer.Option(help="Where the friction table was measured, input or output; taken to be the input.")
    ] = None,
    accept: Annotated[bool, typer.Option("--accept", help="Write the gear though a measurement is doubted.")] = False,
    column: Annotated[
        list[str] | None, typer.Option(help="A column's name in your file, as speed='Motor Speed'; repeat as needed.")
    ] = None,
    unit: Annotated[
        list[str] | None, typer.Option(help="Unit of a column whose header has none, as torque=N.m; repeat as needed.")
    ] = None,
) -> None:
    """Identify a gear from measurements.

    Measurements are CSV or Parquet files whose columns carry units, as speed [rad/s]. Any of them will do: each tells what it
    can, a part of it is held out to validate, and the report says what remains unknown. Where a measurement cannot be what it
    is taken for, or the model does not explain it, that is said first, no gear is written, and the exit code is 3.
    """
    from strainwave.files.gear_set import GearSet
    from strainwave.identify.measurement import COLUMNS, columns_in, read_measurements, unused_columns
    from strainwave.identify.twin import twin as identify
    from strainwave.report.twin import twin_report

    given: dict[Kind, Path | None] = {"friction": friction, "torsion": torsion, "log": log}
    files = {kind: path for kind, path in given.items() if path is not None}
    if not files:
        raise ValueError(f"twin needs at least one measurement: {', '.join(f'--{kind} FILE' for kind in given)}")
    known = {name for kind in files for name in COLUMNS[kind]}
    columns, units = _pairs("--column", column, known), _pairs("--unit", unit, known)
    with _stages() as stage:
        start = GearSet.read(gear)
        recordings = read_measurements(files, columns, units)
        found = identify(
            start,
            friction=recordings.get("friction"),
            torsion=recordings.get("torsion"),
            log=recordings.get("log"),
            side=side,  # type: ignore[arg-type] # anything else is refused there
            sources={kind: path.name for kind, path in files.items()},
            progress=stage,
        )
        stage("report")
        report = twin_report(found, provenance=_provenance(files.values()))
        doubted = bool(found.doubts) and not accept
        _write(out, None if doubted else found.gear_set, report)
    _tell_doubts(found)
    _summarise(found)
    for kind, path in files.items():
        if unused := unused_columns(kind, path, columns_in(kind, path, columns)):
            print(f"{path.name}: columns not used: {', '.join(unused)}")
    if doubted:
        print(f"wrote {out / 'report.html'} alone: no gear is written while a measurement is doubted; --accept writes it")
        raise typer.Exit(DOUBTED)
    print(f"wrote {out / 'gear.toml'} and {out / 'report.html'}")


@app.command()
def demo(out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/demo")) -> None:
    """Identify two gears from published measurements, and simulate published experiments with one of them."""
    from strainwave.demo import PUBLISHED, experiments, position_drive, torsion_rig
    from strainwave.report.twin import twin_report

    with _stages() as stage:
        for name, identify in (("torsion-rig", torsion_rig), ("position-drive", position_drive)):
            stage(name.replace("-", " "))
            found = identify()
            runs = experiments(found) if name == "position-drive" else []
            provenance = _provenance(PUBLISHED.glob(f"{'torsional' if name == 'torsion-rig' else 'position'}*"))
            _write(out / name, found.gear_set, twin_report(found, runs, provenance))
            _summarise(found)
            print(f"wrote {out / name / 'gear.toml'} and {out / name / 'report.html'}")


@app.command()
def gears(part: Annotated[str, typer.Argument(help="Part of a name.")] = "") -> None:
    """List the catalogue sets."""
    from difflib import get_close_matches

    from strainwave.files.gear_set import catalogue

    names = catalogue()
    found = [name for name in names if part.lower() in name]
    if not found:
        near = ", ".join(get_close_matches(part.lower(), names))
        told = f"near it are {near}" if near else "`strainwave gears` lists all"
        raise ValueError(f'no gear set of the catalogue has "{part}" in its name; {told}')
    print("\n".join(found))


@app.command()
def models(name: Annotated[str, typer.Argument(help="A model, to be described in full.")] = "") -> None:
    """List the models that a gear file may name, or describe one."""
    from difflib import get_close_matches
    from inspect import cleandoc

    from strainwave import _core

    kinds = {model: kind for family in _core.families.values() for model, kind in family.items()}
    if name and name not in kinds:
        near = get_close_matches(name, kinds, n=3) or list(kinds)
        raise ValueError(f"there is no model {unquoted(name)}; near to it is {listed(near)}; strainwave models lists all")
    if name:
        print(cleandoc(str(kinds[name].__doc__)))
        return
    width = max(map(len, kinds))
    for family, members in _core.families.items():
        print(family)
        for model, kind in members.items():
            print(f"  {model:{width}}  {cleandoc(str(kind.__doc__)).splitlines()[0]}")


def _pairs(option: str, values: list[str] | None, known: set[str]) -> dict[str, str]:
    pairs = {}
    for value in values or []:
        name, equals, given = value.partition("=")
        if not (name and equals and given):
            raise ValueError(f"{option} {value}: write it as {option} name=value")
        if name not in known:
            raise ValueError(
                f"{option} {value}: {name} is no column of these measurements; they have {', '.join(sorted(known))}"
            )
        pairs[name] = given
    return pairs


def _provenance(files: Iterable[Path]) -> Provenance:
    from strainwave.report.twin import Provenance

    now = datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC")
    return Provenance.of(sorted(files), command=shlex.join(["strainwave", *sys.argv[1:]]), date=now)


def _write(folder: Path, gear_set: GearSet | None, report: str) -> None:
    """Both files or none, the gear only if there is one. An interrupt that comes while they are written changes nothing."""
    from strainwave.files import gear_file
    from strainwave.files.writing import making, write_all

    contents = {folder / "report.html": report}
    if gear_set is not None:
        contents[folder / "gear.toml"] = gear_file.text(gear_set)
    heeded = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with making(folder):
            write_all(contents)
        written.append(folder)
    finally:
        signal.signal(signal.SIGINT, heeded)


def _tell_doubts(found: Twin) -> None:
    for doubt in found.doubts:
        print(f"DOUBT: {doubt.source}: {doubt.what}")
        print(f"  what to do: {doubt.remedy}")


def _summarise(found: Twin) -> None:
    for evidence in found.evidence:
        experiment = evidence.fit.experiment
        errors = [
            f"{name} {error:.3g} {unit}"
            for name, unit, error in zip(experiment.channels, experiment.units, evidence.error, strict=True)
        ]
        print(f"{evidence.source}: rms error on data held out: {', '.join(errors)}")
    fitted = [verdict for verdict in found.verdicts if verdict.state != "kept"]
    width = max((len(verdict.path) for verdict in fitted), default=0)
    for v in fitted:
        print(f"  {v.path:{width}}  {v.value:11.5g} ± {v.sigma:<8.2g} {v.unit:12} {v.state}")
    for check in found.ratings:
        if check.exceeded:
            print(f"rating: {check.recording}: {check}")
    for c in found.contradictions:
        print(f"contradiction: {c.path} = {c.earlier:g} {c.unit} ({c.earlier_source}) against {c.measured:.4g} ({c.source})")


@contextmanager
def _stages() -> Iterator[Callable[[str], None]]:
    """Shows on a terminal what is being done, and stays silent in a pipe."""
    from rich.console import Console

    with Console(stderr=True).status("reading") as status:
        yield lambda stage: status.update(stage)


def main() -> None:
    """Runs the command; input that cannot be used ends in one line and exit code 2, with nothing written."""
    said = StringIO()
    try:
        with redirect_stdout(said):
            app()
    except (ValueError, TypeError, OSError, FloatingPointError) as error:
        _print(f"strainwave: {one_line(with_options(str(error)))}\n", sys.stderr)
        sys.exit(REFUSED)
    finally:
        _print(said.getvalue(), sys.stdout)


def _print(text: str, stream: TextIO) -> None:
    """Prints what a verb has said. It has done its work, which no terminal and no full disk behind a pipe makes a failure."""
    if isinstance(stream, TextIOWrapper):
        stream.reconfigure(errors="replace")  # letters that the terminal lacks
    try:
        print(text, end="", file=stream, flush=True)
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())  # Python tries again at the exit
        if not isinstance(error, BrokenPipeError):  # whoever read the output has seen enough
            _print(f"strainwave: the output cannot be printed: {error.strerror}\n", sys.stderr)
