"""The command `strainwave simulate`: a drive through a scenario."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave.commands.options import Drive, changed_number, numeric
from strainwave.messages import one_line

if TYPE_CHECKING:
    import strainwave as sw
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.simulation.run import Run
    from strainwave.simulation.scenario_file import ScenarioFile


def simulate(
    drive: Drive,
    scenario: Annotated[Path, typer.Option(help="What it does: TOML, or CSV or Parquet with the columns time and command.")],
    out: Annotated[Path | None, typer.Option("--out", "-o", help="Recording to write, .parquet or .csv.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Picture to write, .svg, .png or .pdf.")] = None,
    dt: Annotated[float | None, numeric("Largest step in s, 0.0002 if not given.")] = None,
    sample: Annotated[float, numeric("Distance of samples in s.")] = 1e-3,
    tolerance: Annotated[float | None, numeric("Relative error, as 1e-8: steps as long as it allows, instead of --dt.")] = None,
    record: Annotated[
        list[str] | None, typer.Option(metavar="COLUMN", help="A column to keep; repeat as needed. All, if not given.")
    ] = None,
    changed: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="PATH=VALUE", help="Another number, in SI units, as load.inertia=0.6; repeat as needed."),
    ] = None,
) -> None:
    """Run a drive through a scenario.

    Examples:
        strainwave simulate robot-joint --scenario move.toml
        strainwave simulate robot-joint --scenario move.toml --plot run.svg
    """
    from strainwave.files.gear_set import GearSet
    from strainwave.files.recording import Recording
    from strainwave.simulation.scenario_file import ScenarioFile
    from strainwave.simulation.signals import chosen, outputs

    if dt is not None and tolerance is not None:
        raise ValueError(f"--dt {dt:g} and --tolerance {tolerance:g} exclude each other; give one of them")
    for option, path, endings in (("--out", out, (".parquet", ".csv")), ("--plot", plot, (".svg", ".png", ".pdf"))):
        _check_target(option, path, endings, scenario)
    gear_set = GearSet.read(drive)
    whole = gear_set.drive.replace(dict(changed_number("--set", each) for each in changed or []))
    given = ScenarioFile.read(scenario, whole)
    wanted = list(chosen(whole, record) if record else outputs(whole))
    rated = [name for name in ("torque", "input_speed") if name not in wanted]
    run = _run(given, whole, dt, tolerance, {"sample": sample, "record": [*wanted, *rated]})
    title = one_line(f"{gear_set.name}: {given.name or scenario.stem}")
    recording = Recording(run.columns, run.units, title).select(["time", *wanted])
    _write_run(recording, out, plot)
    _print_run(gear_set, run, recording)
    for path in filter(None, (out, plot)):
        print(f"wrote {path}")


def _check_target(option: str, path: Path | None, endings: tuple[str, ...], source: Path) -> None:
    """Refuse what cannot be written, before a long run is made for it."""
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


def _run(given: ScenarioFile, drive: sw.Drive, dt: float | None, tolerance: float | None, options: dict[str, Any]) -> Run:
    """The run in steps of --dt, or in steps as long as --tolerance allows."""
    if tolerance is None:
        return given.simulate(drive, 2e-4 if dt is None else dt, **options)
    return given.simulate_adaptively(drive, tolerance, **options)


def _print_run(gear_set: GearSet, run: Run, recording: Recording) -> None:
    """Print the method of the run, the range of each column, and the ratings that it exceeded."""
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
