"""The verbs under `diagnose`: recordings of a joint against noise and a healthy baseline, and what they can show."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from strainwave import exit_codes
from strainwave.commands.file_options import FileOptions, paths_in
from strainwave.commands.help import Verbs
from strainwave.commands.options import Drive, folder, numeric, with_groups
from strainwave.commands.output import write_report
from strainwave.diagnose.detection import DETECTION_PROBABILITY, FALSE_ALARM
from strainwave.progress import in_turn
from strainwave.questions import ALL_JOINTS, QuestionError

if TYPE_CHECKING:
    from strainwave.diagnose.diagnosis import Diagnosis, Question
    from strainwave.diagnose.refusals import JointRecording
    from strainwave.identification.reading.mapping import FileMapping
    from strainwave.identification.reading.source import MeasurementFile, MeasurementFiles

PLANNED_ORDERS = (2.0, 1.0, 4.0)  # per revolution of the input: of the wave generator
BEARING_NUMBERS = (3, 4)  # of an option --bearing, without and with the contact angle


diagnose = typer.Typer(cls=Verbs, help="Diagnose a joint, and compute what recordings can show.")


@diagnose.command()
@with_groups
def joint(
    paths: Annotated[list[Path], typer.Argument(metavar="FILE…", help="Recordings of a joint, in the order of time.")],
    given: FileOptions,
    gear: Annotated[str | None, typer.Option(help="Gear of the joint: a set by name, or a gear file.")] = None,
    baseline: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Recording of the healthy joint, or a folder of them; repeat as needed."),
    ] = None,
    ratio: Annotated[float | None, numeric("Ratio of the gear, if no gear is given.")] = None,
    rate: Annotated[float | None, numeric("Samples per second of files without time, in Hz.")] = None,
    false_alarm: Annotated[float, numeric("Rate of false alarms over all tests of a recording.")] = FALSE_ALARM,
    order: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ORDER",
            help="Further order per revolution of the input; repeat as needed. --bearing names those of a bearing.",
        ),
    ] = None,
    bearing: Annotated[
        list[str] | None,
        typer.Option(
            metavar="BALLS,BALL_MM,PITCH_MM[,CONTACT_DEG]",
            help="Geometry of the bearing of the wave generator, whose orders are named, as 23,4.763,46; repeat as needed.",
        ),
    ] = None,
    hours: Annotated[str | None, typer.Option(help="Hours of operation at each recording, as 0,120,300.")] = None,
    threshold: Annotated[
        float | None, numeric("Health indicator at which the gear is exchanged; its trend gives the remaining life.")
    ] = None,
    geometry: Annotated[
        bool, typer.Option("--geometry", help="Estimate the misalignment too: recordings are ramps from the zero of the drive.")
    ] = False,
    out: Annotated[Path, folder("Folder for report.html and the numbers.")] = Path("out/diagnose"),
) -> None:
    r"""Diagnose a joint from its torque or motor current.

    Each order of the gear is compared with noise, and with the healthy joint. Without a baseline lines are compared with noise
    and with the expected values of the gear alone. A recording without an alarm is no proof of health: the report contains the
    smallest change that would be one. The exit code is 3 if a recording differs from the baseline.

    Examples:
        strainwave diagnose joint robot_log.csv --gear hfuc-20-80
        strainwave diagnose joint robot_log_later.csv --gear gear.toml \
          --baseline robot_log.csv
    """
    from strainwave.identification.reading.source import distinct_names, measurement_files
    from strainwave.report.diagnose import diagnose_files, diagnose_summary
    from strainwave.report.provenance import Provenance

    files, healthy = measurement_files(paths), measurement_files(baseline or [])
    _check_apart(files.files, healthy.files)
    question = _question(gear, ratio, rate, order or [], bearing or [], false_alarm, threshold)
    opened = [*files.files, *healthy.files]
    names = distinct_names(opened)
    by_name = _hours(hours, [names[file.path] for file in files.files])
    if geometry and (question.gear_set is None or question.gear_set.motor is None):
        raise ValueError(
            "--geometry needs --gear with a drive: a set that `strainwave list drives` names, or a file with a motor"
        )
    question = replace(question, hours=by_name, ramp_drive=question.gear_set if geometry else None)
    mapping = given.mapping_of(opened)
    read = [*paths_in(files), *paths_in(healthy)]
    with in_turn(None) as turn:
        joints = _joints(files, mapping) if given.joint == ALL_JOINTS else (given.joint,)
        found = [_of_joint(joint, files, healthy, names, mapping, question, rate, turn) for joint in joints]
        turn("report")
        written = diagnose_files(found, Provenance.of_this_command(read), by_name)
    write_report(out, written, diagnose_summary(found))
    if any(each.alarms for each in found):
        raise typer.Exit(exit_codes.RESULT_CONTRADICTED)


@diagnose.command()
def limit(
    drive: Drive,
    speed: Annotated[float, numeric("Speed of the input, in rad/s.")],
    duration: Annotated[float, numeric("Length of the record, in s.")],
    noise: Annotated[float, numeric("Standard deviation of a sample of the current, in A.")],
    torque: Annotated[float, numeric("Torque at the output against the motion, in N.m.")] = 0.0,
    rate: Annotated[float, numeric("Samples of the current per second, in Hz.")] = 1000.0,
    probability: Annotated[float, numeric("That such an error is found.")] = DETECTION_PROBABILITY,
    false_alarm: Annotated[float, numeric("Rate of false alarms over all tests of a recording.")] = FALSE_ALARM,
    order: Annotated[
        list[str] | None,
        typer.Option(metavar="ORDER", help="Order per revolution of the input; repeat as needed. 2, 1 and 4, if not given."),
    ] = None,
    out: Annotated[Path, folder("Folder for report.html and the numbers.")] = Path("out/diagnose"),
) -> None:
    r"""Compute the smallest error of a gear that a record would show.

    The drive is simulated; no recording is needed.

    Examples:
        strainwave diagnose limit robot-joint --speed 20 --duration 10 --noise 0.05
        strainwave diagnose limit tilt-actuator --speed 30 --duration 20 \
          --noise 0.05 --torque 20 --order 2
    """
    from strainwave.commands.options import number_option
    from strainwave.diagnose.smallest_error import detection_limit
    from strainwave.files.gear_set import GearSet
    from strainwave.report.diagnose_plan import PlannedRecord, plan_files, plan_summary
    from strainwave.report.provenance import Provenance

    model = GearSet.read(drive)
    record = PlannedRecord(model.name, speed, torque, duration, rate, noise)
    orders = [number_option(each) for each in order or []] or list(PLANNED_ORDERS)
    whole, limits = model.drive, []
    with in_turn(None, len(orders)) as turn:
        for one in orders:
            turn(f"order {one:g}")
            limits.append(
                detection_limit(
                    whole, speed=speed, load_torque=torque, duration=duration, sample_rate=rate, noise=noise, order=one,
                    probability=probability, false_alarm=false_alarm, tests=len(orders),
                )
            )  # fmt: skip
    files = plan_files(record, limits, Provenance.of_this_command([]))
    write_report(out, files, plan_summary(record, limits))


@diagnose.command()
def wear(
    tests: Annotated[
        list[Path],
        typer.Argument(metavar="FILE…", help="A table of tests with work [J], or the gear files of the tests, in their order."),
    ],
    limit: Annotated[
        list[str],
        typer.Option(
            metavar="NAME=VALUE",
            help="Value at which the gear is worn out: of play, amplitude, friction or stiffness; repeat as needed.",
        ),
    ],
    work: Annotated[
        list[str] | None, typer.Option(help="Work [J] before each test, as 0,1e6,2e6; gear files lack it. Repeat as needed.")
    ] = None,
    work_per_hour: Annotated[
        str | None, typer.Option(help="Work of the duty in an hour [J]: the life in hours; a table may have time for work.")
    ] = None,
    out: Annotated[Path, folder("Folder for report.html and the numbers.")] = Path("out/diagnose"),
) -> None:
    r"""Estimate wear rate and remaining life of a gear from tests.

    Each quantity is a straight line over the transmitted work, torque times angle of the output. A table has a row for each
    test, with columns called as the quantities. Of gear files only numbers that were identified count.

    Examples:
        strainwave diagnose wear wear.csv --limit 'play=1.4 arcmin'
        strainwave diagnose wear wear.csv --limit 'play=1.4 arcmin' \
          --limit stiffness=15e3 --work-per-hour '30 kJ'
    """
    from strainwave.diagnose.wear import wear_life
    from strainwave.diagnose.wear_tests import limits_in, positive_number, read_wear_tests
    from strainwave.report.provenance import Provenance
    from strainwave.report.wear import wear_files, wear_summary

    limits = limits_in(limit)
    per_hour = None if work_per_hour is None else positive_number("--work-per-hour", work_per_hour, "J")
    read = read_wear_tests(tests, list(limits), ",".join(work) if work else None, per_hour)
    life = wear_life(read.work, read.values, limits, resolution=read.resolution, sigma=read.sigma)
    write_report(out, wear_files(read, life, per_hour, Provenance.of_this_command(tests)), wear_summary(read, life, per_hour))


def _question(
    gear: str | None,
    ratio: float | None,
    rate: float | None,
    orders: Sequence[str],
    bearings: Sequence[str],
    false_alarm: float,
    threshold: float | None,
) -> Question:
    from strainwave.arguments import number, probability
    from strainwave.commands.options import number_option
    from strainwave.diagnose.diagnosis import Question
    from strainwave.diagnose.named_orders import bearing_orders
    from strainwave.files.gear_set import GearSet
    from strainwave.identification.reading.mapping import check_constant

    probability("--false-alarm", false_alarm)
    if threshold is not None:
        number("--threshold", threshold, low=0.0)
    gear_set = None if gear is None else GearSet.read(gear)
    if rate is not None:
        check_constant("--rate", "rate", rate)
    if ratio is not None:
        check_constant("--ratio", "ratio", ratio)
        if gear_set is not None:
            raise ValueError("--ratio and --gear are given; the gear has a ratio: leave --ratio out")
    size = ratio if gear_set is None else float(gear_set.gear.kinematics.ratio)
    further = tuple(number("--order", number_option(each), low=0.0) for each in orders)
    geometry = tuple(_bearing(each) for each in bearings)
    kinematics = None if gear_set is None else gear_set.gear.kinematics
    bearing_orders(geometry, kinematics)  # raises before any file is read
    return Question(gear_set, size, further, geometry, false_alarm, threshold=threshold)


def _bearing(text: str) -> Any:
    """Return the bearing of the wave generator with the geometry of an option."""
    from math import radians

    from strainwave import fault
    from strainwave.number_texts import number_in

    parts = [each.strip() for each in text.split(",")]
    if len(parts) not in BEARING_NUMBERS:
        raise ValueError(
            f"--bearing {text} has {len(parts)} numbers; give balls, diameter of a ball [mm], pitch diameter [mm] and, if it "
            "is not 0, the contact angle [deg], as 23,4.763,46"
        )
    balls, ball, pitch, *contact = (number_in(each) for each in parts)
    if balls != int(balls):
        raise ValueError(f"--bearing {text}: balls = {balls:g} must be a whole number")
    try:
        return fault.WaveGeneratorBearing(
            balls=int(balls),
            ball_diameter=1e-3 * ball,
            pitch_diameter=1e-3 * pitch,
            contact_angle=radians(*contact) if contact else 0.0,
        )
    except ValueError as error:
        raise ValueError(f"--bearing {text}: {error}") from None


def _hours(text: str | None, names: Sequence[str]) -> dict[str, float]:
    """Return the hours of operation by the name of the recording."""
    from strainwave.arguments import number
    from strainwave.number_texts import number_in

    if text is None:
        return {}
    try:
        numbers = [number("hours", number_in(each.strip()), "h", "[)", 0.0) for each in text.split(",")]
    except ValueError as error:
        raise ValueError(f"--hours {text}: {error}; give the hours of operation at each recording, as 0,120,300") from None
    if len(numbers) != len(names):
        raise ValueError(f"--hours has {len(numbers)} numbers for {len(names)} recordings; give one for each, as 0,120,300")
    return dict(zip(names, numbers, strict=True))


def _check_apart(files: Sequence[MeasurementFile], healthy: Sequence[MeasurementFile]) -> None:
    """Raise ValueError for a recording that is in the baseline, too: it would be compared with itself."""
    known = {file.path.resolve() for file in healthy}
    if both := [file.path for file in files if file.path.resolve() in known]:
        raise ValueError(
            f"{both[0]} is diagnosed and is in the baseline, too; a recording does not differ from itself: leave it out of one"
        )


def _joints(files: MeasurementFiles, mapping: Callable[[Path], FileMapping]) -> tuple[str | None, ...]:
    """Return the joints that move in any recording; None for recordings of one joint without a name."""
    from strainwave.identification.reading.joints import joints_of

    found = [joint for file in files.files for joint in joints_of(file, replace(mapping(file.path), joint=None))]
    return tuple(dict.fromkeys(found)) or (None,)


def _of_joint(
    joint: str | None,
    files: MeasurementFiles,
    healthy: MeasurementFiles,
    names: Mapping[Path, str],
    mapping: Callable[[Path], FileMapping],
    question: Question,
    rate: float | None,
    turn: Callable[[str], None],
) -> Diagnosis:
    """Return the diagnosis of one joint; a recording that cannot be used is refused with its reason."""
    from strainwave.diagnose.diagnosis import diagnosed
    from strainwave.messages import one_line, without_name

    runs, refused, questions = [], dict[str, str](), list[QuestionError]()
    for file in files.files:
        turn(name := names[file.path])
        try:
            runs.append(_run_of(file, name, joint, mapping, question, rate))
        except ValueError as error:
            refused[name] = without_name(one_line(str(error)), name, file.path.name)
            questions += [error] if isinstance(error, QuestionError) and error.answers else []
    if questions and not runs:
        raise questions[0]
    baseline = []
    for file in healthy.files:
        turn(name := names[file.path])
        try:
            baseline.append(_run_of(file, name, joint, mapping, question, rate))
        except QuestionError:
            raise
        except ValueError as error:
            raise ValueError(f"baseline {name}: {without_name(one_line(str(error)), name, file.path.name)}") from None
    turn(f"joint {joint}" if joint else "diagnosis")
    return diagnosed(runs, question, baseline=baseline, joint=joint or "", refused=refused)


def _run_of(
    file: MeasurementFile,
    name: str,
    joint: str | None,
    mapping: Callable[[Path], FileMapping],
    question: Question,
    rate: float | None,
) -> JointRecording:
    from strainwave.diagnose.refusals import usable
    from strainwave.identification.reading.recognise import recognise

    own = replace(mapping(file.path), joint=joint)
    constants = own.constants if rate is None else {**own.constants, "rate": rate}
    read = recognise(file, replace(own, constants=constants))
    ratio = read.constants.get("ratio") if question.ratio is None else question.ratio
    read = read if ratio is None else read.at_ratio(ratio)
    side: Any = own.side
    run = usable(read.recording, name, ratio=ratio, side=side, other_angles=read.neighbours)
    return replace(run, remarks=(*read.remarks, *run.remarks))


# ---- Misalignment ----------------------------------------------------------------------------------------------------


@diagnose.command()
def misalignment(
    drive: Annotated[str, typer.Argument(help="A drive: its file, or a set by name; its controller a cascade.")],
    stroke: Annotated[float, numeric("Stroke of the output in degrees.")] = 90.0,
    time: Annotated[float, numeric("Time of the ramp through the stroke in s.")] = 5.0,
    out: Annotated[Path, folder("Folder for the tables.")] = Path("out/misalignment"),
) -> None:
    """Sweep the misalignment of the wave generator of a drive.

    Runs a ramp of the output over levels of each eccentricity and tilt, for each way in which the lobes may share, with the
    position loop closed on the output and on the motor encoder. Prints half swings of error, torque, current and output.

    Examples:
        strainwave diagnose misalignment tilt-actuator-lumped --stroke 20 --time 1
        strainwave diagnose misalignment tilt-actuator-lumped --stroke 20 --time 2
    """
    from itertools import product
    from math import radians

    from strainwave.diagnose.actuator_ramp import LOOPS, ActuatorRamp, in_series, wave_generator
    from strainwave.diagnose.inversion import COMBINE
    from strainwave.diagnose.misalignment_sweep import BOTH_LOOPS, LOBES, level_lines, sweep_misalignment
    from strainwave.files import writing
    from strainwave.files.gear_set import GearSet
    from strainwave.progress import in_turn

    ramp = ActuatorRamp.of(GearSet.read(drive).drive, radians(stroke), time)
    law, assumed = wave_generator(ramp.drive)
    found = {}
    with in_turn(None, len(LOOPS) * len(COMBINE)) as turn:
        for loop, combine in product(LOOPS, COMBINE):
            turn(f"{LOBES[combine]}, loop on the {LOOPS[loop]}")
            found[loop, combine] = sweep_misalignment(in_series(ramp).closed_on(loop), law.replace(combine=combine))
    with writing.making(out):
        for (loop, combine), levels in found.items():
            levels.table.to_csv(out / f"levels-{combine}-{loop}.csv")
            writing.written.append(out / f"levels-{combine}-{loop}.csv")
    for loop, sweep in product(LOOPS, BOTH_LOOPS):
        print("\n".join([*level_lines([found[loop, combine] for combine in COMBINE], sweep), ""]))
    print("Half swings of the error, and of the differences that it makes; each peak over that without misalignment.")
    if assumed:
        print("The drive has no law of misalignment: the dimensions of the wave generator are assumed.")
    print(f"wrote {len(found)} tables into {out}")
