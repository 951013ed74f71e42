"""The command `strainwave rig`: plans, guides, follows, analyses and simulates torsion tests."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, radians
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from strainwave.commands.help import Verbs
from strainwave.commands.options import folder, numeric, whole, with_groups
from strainwave.commands.output import write_report
from strainwave.files.folder import inside
from strainwave.files.gear_set import GearSet
from strainwave.files.writing import claiming, making, write_folder, written
from strainwave.messages import pairs
from strainwave.number_texts import number_in
from strainwave.report.provenance import Provenance
from strainwave.rig.bench.rig_file import load, write_rig
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step, photograph_of, read_steps, write_steps
from strainwave.rig.bench.torque import torque_of_masses
from strainwave.rig.influence.series import analyse_series, read_series, series_of
from strainwave.rig.loop import COLUMNS
from strainwave.rig.reading.evaluation import EvaluationOptions, evaluate_paths
from strainwave.rig.reading.measurement import PLAN
from strainwave.rig.report.files import files_of, loop_names
from strainwave.rig.report.influence import influence_report, summary as trend_lines
from strainwave.rig.report.live import Terminal, live
from strainwave.rig.report.page import summary
from strainwave.rig.running.guide import Device, Filled, Frames, PictureSource, Settling, conduct, done_before
from strainwave.rig.running.plan import Pans, Plan, plan
from strainwave.rig.running.watching import Reader, Watch
from strainwave.rig.virtual.printed import ARTICLE, gear_named, narrower
from strainwave.rig.virtual.test import Virtual, rehearsal, simulate_test
from strainwave.rig.vision.image import imageio_arrays

if TYPE_CHECKING:
    from rich.console import Console


app = typer.Typer(cls=Verbs, add_completion=False, rich_markup_mode=None)

MAX_SECONDS = 1e6  # of any time that is waited
MAX_PICTURES = 1000  # that must agree
IMAGEIO = "imageio:"  # begins the name of a camera that imageio opens

RigOption = Annotated[str, typer.Option("--rig", help="The rig: a name that comes with the package, or a .toml file.")]


@dataclass(frozen=True)
class PlanOptions:
    """Options of the plan of a test."""

    torque: Annotated[float, numeric("Peak torque in N.m; the nearest that the masses make is taken.")] = 0.36
    step: Annotated[float | None, numeric("Step of the torque in N.m; by default the smallest that the masses make.")] = None
    positions: Annotated[str, typer.Option(help="Positions of the flexspline in its mount in degrees.")] = "0,60,120"
    specimens: Annotated[str, typer.Option(help="Names of the specimens, as A,B; one without a name, if not given.")] = ""
    cycles: Annotated[int, whole("Cycles at each position, one after the other.")] = 1
    unequal: Annotated[
        bool, typer.Option("--unequal", help="Let both pans of a pair differ by one mass: half the step, but no pure couple.")
    ] = False

    def plan(self, bench: Rig) -> Plan:
        """Return the plan for a rig.

        Raises:
            ValueError: a position or a specimen is named twice, or the masses do not make the torque
        """

        places = [radians(each) for each in _numbers("--positions", self.positions)]
        specimens = [each.strip() for each in self.specimens.split(",")]
        if len(set(places)) < len(places) or len(set(specimens)) < len(specimens):
            raise ValueError("--positions and --specimens must each name a thing once; --cycles repeats a position")
        pans: Pans = "unequal" if self.unequal else "equal"
        return plan(bench, self.torque, step=self.step, pans=pans, positions=places, units=specimens, cycles=self.cycles)


USUAL_PLAN = PlanOptions()


@app.command("plan")
@with_groups
def plan_command(
    name: RigOption = "couple-rig",
    options: PlanOptions = USUAL_PLAN,
    out: Annotated[Path | None, typer.Option(help="File for the steps, .csv, as steps.csv of a test has them.")] = None,
) -> None:
    """Print what to lay on the pans and take off, step by step.

    The cycle is the torsional stiffness article's: the positive peak, down to zero, to the negative peak, back to zero, and up
    to the positive peak.

    Examples:
        strainwave rig plan --torque 0.3 --positions 0
        strainwave rig plan --out steps.csv
    """

    if out is not None and out.suffix != ".csv":
        raise ValueError(f"--out {out} must end in .csv")
    made = options.plan(load(name))
    if out is not None:
        write_steps(made.steps, out)
    print(made)
    if out is not None:
        print(f"wrote {out}")


@app.command()
@with_groups
def simulate(
    gear: Annotated[
        str,
        typer.Argument(help="A set by name, a gear file, or torsional-stiffness-article: the gears of its Table 2."),
    ] = ARTICLE,
    name: RigOption = "couple-rig",
    out: Annotated[Path, folder("Folder for the test; it must not hold one yet.")] = Path("out/rig-test"),
    options: PlanOptions = USUAL_PLAN,
    seed: Annotated[int, whole("Of the noise of the photographs.")] = 0,
) -> None:
    """Make a virtual test, as a real one leaves its folder.

    It contains photographs, masses and rig, and the true values.

    Examples:
        strainwave rig simulate --positions 0 --out rehearsal
        strainwave rig simulate hfuc-20-80 --positions 0 --out hfuc
    """

    bench = load(name)
    made = options.plan(bench)
    steps = made.steps
    test = simulate_test(gear_named(gear), bench, steps, folder=out, seed=seed)
    write_steps(steps, out / PLAN)
    print(f"wrote {out}: {len(test.steps)} photographs, steps.csv, {PLAN}, rig.toml, and the truth in truth*")
    if abs(made.peak - options.torque) > 1e-9 * options.torque:
        print(f"the peak is {made.peak:.4f} N.m: {options.torque:g} N.m is no step of the masses")
    if gear == ARTICLE and (short := narrower(sorted({each.position for each in steps}), made.peak)):
        print(*short, sep="\n")
        print("more torque, or --unequal, which halves the steps, may reach it")
    print(f"to analyse it: strainwave rig analyse {out}")


@app.command()
@with_groups
def measure(
    camera: Annotated[
        str,
        typer.Option(
            help="Number of a camera, imageio:<video0>, a folder that another program fills with photographs, or virtual."
        ),
    ],
    out: Annotated[Path, folder("Folder of the test; one that was broken off goes on.")] = Path("out/rig-test"),
    name: Annotated[
        str | None, typer.Option("--rig", help="The rig: a name, or a .toml file; couple-rig if not given.")
    ] = None,
    options: PlanOptions = USUAL_PLAN,
    gear: Annotated[str, typer.Option(help="The gear on a virtual rig, as for simulate.")] = ARTICLE,
    pictures: Annotated[int, whole("Photographs in a row that must agree before a step counts as at rest.")] = 5,
    interval: Annotated[float, numeric("Time between two photographs in s.")] = 0.5,
    patience: Annotated[float, numeric("Time in s after which a shaft that still moves is reported.")] = 60.0,
) -> None:
    """Guide a test step by step.

    Each step is written down as soon as it is done. Prints which masses to move, waits until the shaft rests, and
    keeps the photograph. `steps.csv` in the folder of the test holds what was done; Ctrl-C, or q, breaks off, and the same
    command goes on.

    Examples:
        strainwave rig measure --camera virtual --positions 0
        strainwave rig measure --camera 0 --out test
    """
    from rich.console import Console

    if not 1 <= pictures <= MAX_PICTURES:
        raise ValueError(f"--pictures {pictures} must be 1 to {MAX_PICTURES}")
    settling = Settling(pictures, _seconds("--interval", interval), _seconds("--patience", patience))
    bench = _rig_of_test(out, name)
    made = options.plan(bench)
    source = _source(camera, bench, made.steps, gear)
    with making(out), claiming(out):
        done = _conduct(Console(stderr=True), out, bench, made, source, settling)
    if done < len(made.steps):
        print(f"stopped after step {done} of {len(made.steps)}; the same command goes on")
    else:
        print(f"all {done} steps are made")
        print(f"to analyse them: strainwave rig analyse {out}")


@app.command()
def analyse(
    paths: Annotated[
        list[Path], typer.Argument(metavar="FOLDER|FILE…", help="Folders of tests, or loops as .csv or .parquet; also several.")
    ],
    name: Annotated[
        str | None, typer.Option("--rig", help="The rig, instead of rig.toml of the folder: a name, or a .toml file.")
    ] = None,
    gear: Annotated[str | None, typer.Option(help="The gear on the rig: a set by name, or a gear file.")] = None,
    rated_torque: Annotated[float | None, numeric("Rated torque at the loaded shaft in N.m; by default of the gear.")] = None,
    reference: Annotated[
        str | None, typer.Option(help="Photograph whose angle is 0; the first at the positive peak, if not given.")
    ] = None,
    friction: Annotated[
        Path | None, typer.Option(help="Table of speed and torque of the input, whose friction is taken out; needs --gear.")
    ] = None,
    positions: Annotated[str | None, typer.Option(help="Position of each FILE in degrees, as 0,60,120.")] = None,
    column: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=COLUMN", help="A column's name in FILE, as twist='Angle out'; repeat as needed."),
    ] = None,
    unit: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=UNIT", help="Unit of a column of FILE whose header has none, as torque=N.m; repeat as needed."
        ),
    ] = None,
    out: Annotated[
        Path | None, folder("Folder for the results; FOLDER/analysis, or out/rig for several, if not given.")
    ] = None,
) -> None:
    """Analyse a test: stiffness, lost motion and a report.

    Writes report.html, results.json, and of each loop and of the angles a .csv and a .parquet file. Loops are written as
    measured, with friction inside. The photographs stay where they are; the report has their hashes.

    Examples:
        strainwave rig analyse rehearsal
        strainwave rig analyse rehearsal --out results
    """

    alone = len(paths) == 1 and paths[0].is_dir()
    target = out or (paths[0] / "analysis" if alone else Path("out/rig"))
    given = EvaluationOptions(
        rig=None if name is None else load(name),
        gear_set=None if gear is None else GearSet.read(gear),
        rated_torque=rated_torque,
        reference=reference,
        friction=friction,
        positions=None if positions is None else _numbers("--positions", positions),
        columns=pairs("--column", column, {name for pair in COLUMNS.values() for name in pair}),
        units=pairs("--unit", unit, {name for pair in COLUMNS.values() for name in pair}),
    )
    found, read = evaluate_paths(paths, given)
    files = files_of(found, _provenance(read))
    write_report(target, files, summary(found))
    there = sorted(each.name for kind in ("csv", "parquet") for each in target.glob(f"loop-*.{kind}"))
    if left := [each for each in there if each not in files]:
        print(f"of an earlier analysis, and no part of this one: {', '.join(left)}")
    for each in loop_names(found.loops):
        words = ["identify", gear or "GEAR", *([] if friction is None else [str(friction)]), f"{target / each}.csv"]
        print(f"for a gear{'' if gear else ', its start set in place of GEAR'}: strainwave {shlex.join(words)}")


@app.command()
def watch(
    folder: Annotated[Path, typer.Argument(help="Folder of a test that is being run.")],
    name: Annotated[
        str | None, typer.Option("--rig", help="The rig: a name, or a .toml file; rig.toml of the folder, if not given.")
    ] = None,
    plan: Annotated[
        Path | None,
        typer.Option(help="Steps that are to be made, .csv, where steps.csv lacks them; plan.csv of the folder, if not given."),
    ] = None,
    idle: Annotated[float | None, numeric("End when no photograph came for so many s; never, if not given.")] = None,
    interval: Annotated[float, numeric("Time between two looks in s.")] = 0.5,
) -> None:
    """Draw the loop of a test that is being run; Ctrl-C ends.

    Examples:
        strainwave rig watch rehearsal --idle 1
        strainwave rig watch rehearsal --idle 1 --plan rehearsal/plan.csv
    """
    from rich.console import Console

    if not folder.is_dir():
        raise FileNotFoundError(f"{folder}: there is no such folder")
    bench = _rig_of_test(folder, name)
    kept = inside(folder, PLAN)
    planned = kept if plan is None and kept.exists() else plan
    watched = Watch(folder, bench, read_steps(planned) if planned is not None else ())

    longest = inf if idle is None else _seconds("--idle", idle)
    points = live(Console(stderr=True), watched.new, longest, _seconds("--interval", interval))
    read = sum(not point.look.fault for point in points)
    print(f"{len(points)} photographs, {read} of them with an angle")


@app.command()
def influence(
    measured: Annotated[
        Path | None,
        typer.Option(help="A series of loops, .csv: what was varied, as torque_max or temperature, and area, width or file."),
    ] = None,
    loop: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FILE,NAME=VALUE",
            help="A measured loop, and what was varied, as cold.csv,temperature=5 degC; once for each loop.",
        ),
    ] = None,
    out: Annotated[Path, folder("Folder for report.html.")] = Path("out/rig-influence"),
) -> None:
    """Test a series of torsion loops for trends.

    Prints the dependence of area, width and stiffness on torque level, temperature, preload, ratio, modulus, cycles and hours,
    each with its 95 % interval and its probabilities.

    Examples:
        strainwave rig influence --measured series.csv
        strainwave rig influence --measured series.csv --out trends
    """

    if (measured is None) == (not loop):
        raise ValueError("give one series: a table with --measured, or its loops with --loop")
    series = read_series(measured) if measured is not None else series_of(loop or [])
    trends = analyse_series(series)
    write_folder(out, {"report.html": influence_report(series, trends, Provenance.of_this_command(series.files))})
    print(trend_lines(series, trends))
    print(f"wrote {out / 'report.html'}")


# ---- A test that was made ---------------------------------------------------------------------------------------------


def _provenance(read: Sequence[Path]) -> Provenance:
    """Return the origin of the report; files of the same name are shown with their folders."""
    names = [path.name for path in read]
    digests: dict[str, str] = {}
    for path in read:
        (digest,) = Provenance.of([path], command="", date="").files.values()
        digests[path.name if names.count(path.name) == 1 else str(path)] = digest
    return replace(Provenance.of_this_command([]), files=digests)


# ---- Values of options ------------------------------------------------------------------------------------------------


def _rig_of_test(folder: Path, name: str | None) -> Rig:
    """The rig that was named, or that of the folder, or the one of the torsional stiffness article."""

    there = inside(folder, "rig.toml")
    if name is None and there.exists():
        return load(str(there))
    return load("couple-rig" if name is None else name)


def _numbers(option: str, text: str) -> list[float]:
    try:
        return [number_in(each.strip()) for each in text.split(",")]
    except ValueError:
        raise ValueError(f"{option} {text}: write numbers with commas between, as 0,60,120") from None


def _seconds(option: str, value: float) -> float:
    if not 0.0 < value <= MAX_SECONDS:
        raise ValueError(f"{option} {value:g} s must be above 0 and at most {MAX_SECONDS:g}")
    return value


def _source(camera: str, bench: Rig, steps: tuple[Step, ...], gear: str) -> PictureSource:
    if camera == "virtual":
        return rehearsal(bench, steps, gear_named(gear))
    try:
        if camera.startswith(IMAGEIO):
            return Frames(camera, imageio_arrays(camera.removeprefix(IMAGEIO)))
        return Device(int(camera)) if re.fullmatch("[0-9]{1,4}", camera) else Filled(Path(camera))
    except ImportError as error:
        raise ValueError(f"--camera {camera}: {error}") from None


def _conduct(console: Console, out: Path, bench: Rig, made: Plan, source: PictureSource, settling: Settling) -> int:
    """Guide through the remaining steps, and return the count of steps done."""
    kept = inside(out, PLAN)
    if not kept.exists():
        write_steps(made.steps, kept)
    elif tuple(read_steps(kept)) != made.steps:
        raise ValueError(f"{kept} holds another plan; repeat the options that it was begun with, or give another --out")
    written.append(out)
    done, reader = done_before(made.steps, out), Reader(bench.camera)
    if not (out / "rig.toml").exists():
        write_rig(bench, out / "rig.toml")
    tasks = {stage.step.number: stage.task for stage in made.stages}
    terminal = Terminal(console, len(made.steps), tasks, lambda step: torque_of_masses(bench, step))
    terminal.before |= {step.number: reader(photograph_of(step, out), step) for step in done if step.image}
    load = source.load if isinstance(source, Virtual) else lambda number: None
    return len(conduct(made.steps, out, source, reader, terminal, settling, load))
