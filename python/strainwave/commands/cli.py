"""The command `strainwave`: thin; it reads files, calls the package and writes files."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from io import BytesIO, StringIO, TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TextIO

import typer

from strainwave.commands.cache import cache
from strainwave.commands.compile import compile
from strainwave.commands.file_options import number_option
from strainwave.commands.identify import identify
from strainwave.commands.orders import orders
from strainwave.commands.plan_experiments import plan_experiments
from strainwave.commands.rank import rank
from strainwave.commands.rig import rig
from strainwave.commands.study import study
from strainwave.messages import listed, one_line, pairs, quoted, unquoted, with_options
from strainwave.number_texts import is_whole, number_in

if TYPE_CHECKING:
    from strainwave import Drive
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.identification.reading.measurement import Kind
    from strainwave.identification.twin import Twin
    from strainwave.simulation.run import Run
    from strainwave.simulation.scenario_file import ScenarioFile

REFUSED = 2  # exit code for input that cannot be used
DOUBTED = 3  # exit code for measurements that speak against themselves: no gear is written

MISUSED: type[Exception] = typer.BadParameter.__mro__[1]  # what typer raises of a command line, by no name of its own

app = typer.Typer(
    help="Strain wave gears: measurements in, a validated model of that gear out.",
    add_completion=False,
    rich_markup_mode=None,  # plain help: rich alone takes longer to import than the help may take to appear
    pretty_exceptions_enable=False,
)
app.add_typer(study, name="study")
app.add_typer(rig, name="rig")
app.command()(identify)
app.command()(rank)
app.command()(orders)
app.command()(plan_experiments)
app.command()(cache)
app.command()(compile)


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
    from strainwave.identification.reading.measurement import COLUMNS, columns_in, read_measurements, unused_columns
    from strainwave.identification.twin import twin as identify
    from strainwave.report.provenance import Provenance
    from strainwave.report.twin import twin_report

    given: dict[Kind, Path | None] = {"friction": friction, "torsion": torsion, "log": log}
    files = {kind: path for kind, path in given.items() if path is not None}
    if not files:
        raise ValueError(f"twin needs at least one measurement: {', '.join(f'--{kind} FILE' for kind in given)}")
    known = {name for kind in files for name in COLUMNS[kind]}
    columns, units = pairs("--column", column, known), pairs("--unit", unit, known)
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
        report = twin_report(found, provenance=Provenance.of_this_command(files.values()))
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
    from strainwave.report.provenance import Provenance
    from strainwave.report.twin import twin_report

    with _stages() as stage:
        for name, identify in (("torsion-rig", torsion_rig), ("position-drive", position_drive)):
            stage(name.replace("-", " "))
            found = identify()
            runs = experiments(found) if name == "position-drive" else []
            published = PUBLISHED.glob(f"{'torsional' if name == 'torsion-rig' else 'position'}*")
            provenance = Provenance.of_this_command(published)
            _write(out / name, found.gear_set, twin_report(found, runs, provenance))
            _summarise(found)
            print(f"wrote {out / name / 'gear.toml'} and {out / name / 'report.html'}")


@app.command()
def simulate(
    drive: Annotated[
        str, typer.Argument(help="A drive: a set by name (strainwave drives), or a gear file with motor and load.")
    ],
    scenario: Annotated[Path, typer.Option(help="What it does: TOML, or CSV or Parquet with the columns time and command.")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Recording to write, .parquet or .csv.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Picture to write, .svg, .png or .pdf.")] = None,
    dt: Annotated[float | None, typer.Option(parser=number_option, help="Largest step in s, 0.0002 if not given.")] = None,
    sample: Annotated[float, typer.Option(parser=number_option, help="Distance of samples in s.")] = 1e-3,
    tolerance: Annotated[
        float | None,
        typer.Option(parser=number_option, help="Relative error, as 1e-8: steps as long as it allows, instead of --dt."),
    ] = None,
    record: Annotated[list[str] | None, typer.Option(help="A column to keep; repeat as needed. All, if not given.")] = None,
    changed: Annotated[
        list[str] | None, typer.Option("--set", help="Another number, in SI units, as load.inertia=0.6; repeat as needed.")
    ] = None,
) -> None:
    """Run a drive through a scenario."""
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.simulation.scenario_file import ScenarioFile
    from strainwave.simulation.signals import chosen, outputs

    if dt is not None and tolerance is not None:
        raise ValueError(f"--dt {dt:g} and --tolerance {tolerance:g} exclude each other; give one of them")
    for option, path, endings in (("--out", out, (".parquet", ".csv")), ("--plot", plot, (".svg", ".png", ".pdf"))):
        _check_target(option, path, endings, scenario)
    gear_set = GearSet.read(drive)
    whole = gear_set.drive.replace(dict(_change(each) for each in changed or []))
    given = ScenarioFile.read(scenario, whole)
    wanted = list(chosen(whole, record) if record else outputs(whole))
    rated = [name for name in ("torque", "input_speed") if name not in wanted]
    run = _run(given, whole, dt, tolerance, {"sample": sample, "record": [*wanted, *rated], "progress": sys.stderr.isatty()})
    title = one_line(f"{gear_set.name}: {given.name or scenario.stem}")
    recording = Recording(run.columns, run.units, title).select(["time", *wanted])
    _write_run(recording, out, plot)
    _tell_run(gear_set, run, recording)
    for path in filter(None, (out, plot)):
        print(f"wrote {path}")


@app.command()
def compare(
    first: Annotated[str, typer.Argument(help="A recording (.csv, .parquet), a gear file, or a set by name.")],
    second: Annotated[str, typer.Argument(help="Another one of the same kind.")],
    column: Annotated[
        list[str] | None, typer.Option(help="A column to compare; repeat as needed. All that both have, if not given.")
    ] = None,
) -> None:
    """Compare two recordings, or two gears or drives."""
    from strainwave.analysis.compare import compare as compared
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.report.listing import agreement_table, difference_table

    recordings = [Path(each).suffix.lower() in (".csv", ".parquet", ".txt", ".tsv") for each in (first, second)]
    if recordings[0] != recordings[1]:
        recorded, modelled = (first, second) if recordings[0] else (second, first)
        raise ValueError(f"{recorded} is a recording, {modelled} a gear or drive; give two of one kind")
    if recordings[0]:
        agreements = compared(Recording.read(first), Recording.read(second), column)
        print(f"{agreements[0].samples} samples compared\n\n{agreement_table(agreements)}")
        return
    if column:
        raise ValueError(f"--column {column[0]}: of gears and drives all numbers are compared; leave it out")
    differences = compared(GearSet.read(first), GearSet.read(second))
    print(difference_table(differences) if differences else "equal, number by number")


@app.command()
def show(
    gear: Annotated[str, typer.Argument(help="A set by name, or a gear file.")],
    run: Annotated[list[Path] | None, typer.Option(help="A recording to hold against the ratings; repeat as needed.")] = None,
) -> None:
    """Show every number of a gear or drive with its unit and its source, its modes and its ratings."""
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.report.listing import listing

    print(listing(GearSet.read(gear), {str(path): Recording.read(path) for path in run or []}))


@app.command()
def gears(part: Annotated[str, typer.Argument(help="Part of a name.")] = "") -> None:
    """List the gears of the catalogue."""
    print("\n".join(_found("gears", part)))


@app.command()
def drives(part: Annotated[str, typer.Argument(help="Part of a name.")] = "") -> None:
    """List the drives that come with the package: a gear with motor, controller and load."""
    from strainwave.files.gear_set import GearSet
    from strainwave.report.listing import aligned

    names = _found("drives", part)
    print("\n".join(aligned([(name, GearSet.read(name).name) for name in names], "<<")))


def _found(of: str, part: str) -> list[str]:
    """The sets that come with the package and have this part in their name."""
    from difflib import get_close_matches

    from strainwave.files.gear_set import catalogue

    names = catalogue(of)
    found = [name for name in names if part.lower() in name]
    if not found:
        near = ", ".join(get_close_matches(part.lower(), names))
        told = f"near it are {near}" if near else f"`strainwave {of}` lists all"
        raise ValueError(f"none of the {of} that come with the package has {quoted(part)} in its name; {told}")
    return found


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


def _check_target(option: str, path: Path | None, endings: tuple[str, ...], source: Path) -> None:
    """Refuses what cannot be written, before a long run is made for it."""
    if path is None:
        return
    if path.suffix not in endings:
        raise ValueError(f"{option} {path} must end in {' or '.join(endings)}")
    if not path.parent.is_dir():
        raise ValueError(f"{option} {path} cannot be written: there is no folder {path.parent}")
    if path.is_dir():
        raise ValueError(f"{option} {path} cannot be written: it is a folder")
    if path.resolve() == source.resolve():
        raise ValueError(f"{option} {path} is the file of the scenario; give another name")


def _change(given: str) -> tuple[str, float | str]:
    """The path and the value of --set."""
    path, equals, value = given.partition("=")
    if not (path and equals and value):
        raise ValueError(f"--set {given}: write it as --set load.inertia=0.6")
    if is_whole(value):
        return path, int(value)
    try:
        float(value)  # nan and other digits than ASCII are no words of a model either
    except ValueError:
        return path, value
    return path, number_in(value)


def _run(given: ScenarioFile, drive: Drive, dt: float | None, tolerance: float | None, options: dict[str, Any]) -> Run:
    """The run in steps of --dt, or in steps as long as --tolerance allows."""
    if tolerance is None:
        return given.simulate(drive, 2e-4 if dt is None else dt, **options)
    return given.simulate_adaptively(drive, tolerance, **options)


def _tell_run(gear_set: GearSet, run: Run, recording: Recording) -> None:
    """How the run went, the range of what is recorded, and the ratings that it exceeded."""
    from strainwave.files.ratings import check_ratings
    from strainwave.report.listing import range_table

    how = f"{len(run)} samples from 0 s to {run.time[-1]:g} s, {run.method}"
    print(f"{recording.title}\n{how}\n\n{range_table(recording)}")
    for check in check_ratings(gear_set, run):
        if check.exceeded:
            print(one_line(f"rating: {check}"))


def _write_run(run: Recording, out: Path | None, plot: Path | None) -> None:
    """The recording, and a picture of what changes in it; nothing is written before all is made."""
    from strainwave.files.writing import replacing, written

    drawn = BytesIO()
    if plot is not None:
        run.plot().savefig(drawn, format=plot.suffix[1:], dpi=150)
    if out is not None:
        (run.to_csv if out.suffix == ".csv" else run.to_parquet)(out)
        written.append(out)
    if plot is not None:
        with replacing(plot) as file:
            file.write(drawn.getvalue())
        written.append(plot)


def _names_columns(words: list[str]) -> bool:
    """Whether a command has the options --column and --unit."""
    return words[1:2] in (["twin"], ["identify"], ["rank"], ["orders"]) or words[1:3] == ["rig", "analyse"]


def _write(folder: Path, gear_set: GearSet | None, report: str) -> None:
    """The report, and the gear if there is one."""
    from strainwave.files import gear_file
    from strainwave.files.writing import write_folder

    gear = {"gear.toml": gear_file.text(gear_set)} if gear_set is not None else {}
    write_folder(folder, {"report.html": report} | gear)


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
        with redirect_stdout(said), warnings.catch_warnings():
            warnings.showwarning = _warn
            code = app(sys.argv[1:] or ["--help"], standalone_mode=False)
    except MISUSED as error:
        _print(f"strainwave: {one_line(_misuse(error))}\n", sys.stderr)
        code = REFUSED
    except (OverflowError, ZeroDivisionError) as error:
        _print(f"strainwave: a number is too large or too small to compute with: {one_line(str(error))}\n", sys.stderr)
        code = REFUSED
    except (ValueError, TypeError, OSError, ImportError, FloatingPointError, MemoryError) as error:
        reason = str(error) or "this takes more memory than there is"  # where Python itself raises a MemoryError
        _print(f"strainwave: {one_line(with_options(reason, names_columns=_names_columns(sys.argv)))}\n", sys.stderr)
        code = REFUSED
    finally:
        _print(said.getvalue(), sys.stdout)
    sys.exit(code)


def _misuse(error: Any) -> str:
    """What is wrong with the command line, in one sentence, and where help is."""
    command, wrong = "strainwave" if error.ctx is None else error.ctx.command_path, error.format_message().rstrip(".")
    if wrong.startswith("Missing") and error.ctx is not None:
        wrong += f" of {' '.join([command, *error.ctx.command.collect_usage_pieces(error.ctx)])}"
    return f"{wrong}; {command} --help tells more"


def _warn(message: Warning | str, *_: object, **__: object) -> None:
    _print(f"strainwave: warning: {one_line(str(message))}\n", sys.stderr)


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
