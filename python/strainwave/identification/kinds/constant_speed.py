"""Records at constant speed, whose means are the points of one friction table; and torque without the motion that made it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import friction
from strainwave.analysis.branches import turning_points
from strainwave.files.recording import Recording
from strainwave.identification.candidates.plain import sliding_squares
from strainwave.identification.candidates.steady_friction import (
    FULL_TURN,
    Levels,
    PositionFit,
    constant_speeds,
    fit_position,
    levels_of,
)
from strainwave.identification.checks.sizes import opposes_motion
from strainwave.identification.checks.unexplained import MAX_SHARE_OF_TORQUE, Left, error_left, only_if_explained
from strainwave.identification.experiments.drive_log import ENCODERS
from strainwave.identification.experiments.experiment import sensible
from strainwave.identification.experiments.motion import integrated
from strainwave.identification.kinds.friction_table import fit_table
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.kinds.prepared_log import log_of
from strainwave.identification.kinds.warm_up import warmed
from strainwave.identification.reading import unnamed
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.motion import fills_record, stretches
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import MIN_MOTOR_SPEED, Column, ColumnRoles, channels, measured, pair
from strainwave.identification.results.file_result import MAX_UNEXPLAINED, FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar, with_ratio, with_torque
from strainwave.identification.results.identifiability import with_friction_at
from strainwave.identification.results.pictures import Picture
from strainwave.identification.results.steady_friction import AT_SPEEDS, MIN_SPEEDS, different_speeds, friction_at_speeds
from strainwave.messages import listed
from strainwave.questions import LOG_AT_RATE, Answer, QuestionError
from strainwave.statistics.residuals import rms
from strainwave.statistics.scale import SIGNIFICANCE_SIGMA

Array = NDArray[np.float64]

MIN_SPEED_ROWS = 20  # of a record at one speed: fewer are a table
Together = tuple[tuple[FileResult, ...], GearSoFar]  # the results of several files, and the gear with them

MAX_CHANGE = 0.05  # of the median speed, by which the speed of a record at one speed varies
MIN_SHARE_OF_ROWS = 0.95  # of a record at one speed, whose speed varies by no more
WHOLE_TURN = 0.98  # of a turn, from which on it counts as whole
MAX_CHANCE_OF_WAVE = 1e-3  # probability, over all orders, that chance alone gives a wave
JOINED_NAME = "records at constant speed"
ANGLE_TITLE = "friction over the angle, at constant speed"
TABLE_TITLE = "a table of steady friction, of many files"


class ConstantSpeed(Kind):
    """A record of one speed, or of several speeds one way: each a point of the table that all such files are together."""

    time = "used"
    section = "Files at constant speed"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for a torque or current alone, with an angle, or with one speed.

        Raises:
            QuestionError: an angle goes to and fro under a current, as before it slides or in a log
        """
        efforts, angles, speeds = (measured(columns, *each) for each in (("torque", "current"), ("angle",), ("speed",)))
        if efforts and angles and not measured(columns, "torque") and turning_points(angles[0].si):
            ways = [LOG_AT_RATE, Answer("friction before it slides", {"kind": "presliding"})]
            raise QuestionError(f"{pair(angles[0], efforts[0])} go to and fro without time", ways)
        return bool(efforts) and (
            bool(angles) or not speeds or (len(speeds[0].si) > MIN_SPEED_ROWS and is_one_speed(speeds[0].si))
        )

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        quantities = dict.fromkeys(column.channel.quantity for column in columns if column.channel.measured)
        by_channel = channels({quantity: measured(columns, quantity) for quantity in quantities})
        effort = listed(by_channel[name].name for name in ("torque", "current") if name in by_channel)
        side = mapping.side or next((column.channel.side for column in by_channel.values() if column.channel.side), None)
        robot = next((column.name for column in by_channel.values() if column.robot), None) if side is None else None
        if "speed" in by_channel:
            why = f"at one speed, {by_channel['speed'].si.mean():.4g} rad/s: a record at constant speed"
        elif "angle" in by_channel:
            turns = np.ptp(by_channel["angle"].si) / (2.0 * np.pi)
            why = f"over {by_channel['angle'].name}, which runs on for {turns:.3g} turns"
        elif "speed" in mapping.constants:
            why = f"at {mapping.constants['speed']:.4g} rad/s, as was given: a record at constant speed"
        else:
            why = "and nothing that moves: the output was locked, or the speed was constant and is not stated"
        why_side = (f"{robot} is what robots call a channel of a joint: it is taken to be at the output",) if robot else ()
        return ColumnRoles(self.name, by_channel, "output" if robot else side, (f"it has {effort} {why}", *why_side))

    def takes(self, file: Recognised, known: GearSoFar, files: Sequence[Recognised]) -> bool:
        """True also for logs at constant speed, but for one of few speeds whose torque changes as that of a log.

        The torque of a joint is not its friction if other joints move.
        """
        if file.kind == "log" and file.neighbours:
            return False
        if file.kind == "log":
            try:
                run = run_of(file, with_ratio(known, file))
            except ValueError:
                return True
            return run is not None and (len(run.stretches) + len(files) > MIN_SPEEDS or not _is_explained(file, known))
        return file.kind == self.name

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Return the means of a file, which is a point of the table of all."""
        run = run_of(file, known)
        if run is None:
            raise _without_motion(file)
        result, warm = of_run(run), warmed(file)
        if warm is None:
            return result, known
        of_temperature, _ = warm
        return replace(
            result, remarks=(*of_temperature.remarks, *result.remarks), pictures=(*result.pictures, *of_temperature.pictures)
        ), known

    def fit_together(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Fit the friction table of the means of all files."""
        return _or_refused(JOINED_NAME, joined, files, known)

    def fit_last(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Fit friction over the angle of the input, around that which other files determine."""
        return _or_refused("friction over the angle", over_the_angle, files, known)


def _or_refused(
    name: str, fit: Callable[[Sequence[ConstantSpeedRun], GearSoFar], Together], files: Sequence[Recognised], known: GearSoFar
) -> Together:
    """Return what the runs of files determine together, or a result of this name that is refused."""
    runs = list[ConstantSpeedRun]()
    try:
        for file in files:
            with suppress(ValueError):  # one that cannot be used, as its own result states
                run = run_of(file, with_ratio(known, file))
                runs += [run] if run is not None else []
        return fit(runs, known)
    except (ValueError, FloatingPointError) as error:
        return (FileResult(name, refused=str(error)),), known


def _is_explained(file: Recognised, known: GearSoFar) -> bool:
    """True if inertia, gravity and friction explain the torque of a log on data held out."""
    try:
        prepared = log_of(file.at_ratio(known.gear_set.gear.kinematics.ratio), known)
        squares, samples = sliding_squares(prepared.log, prepared.drive)
    except (ValueError, FloatingPointError):
        return False
    return bool(squares.sum() < MAX_UNEXPLAINED**2 * samples.sum())


def _without_motion(file: Recognised) -> QuestionError:
    """Return the refusal of a torque or a current without a motion, or the question which column is one."""
    speed = Answer("the shaft turned at one speed", {"constants": {"speed": 10.0}}, {"speed": "this speed [rad/s]"})
    if {"angle", "speed", *ENCODERS} & {*file.recording.names, *file.constants}:
        ways = [] if {"speed"} & {*file.recording.names, *file.constants} else [speed]
        return QuestionError("torque without its speed determines orders alone: strainwave orders finds them", ways)
    hint = f" (not used, as they contain texts: {listed(file.texts)})" if file.texts else ""
    ways = [*unnamed.motions(file.unnamed), speed]
    return QuestionError(f"torque alone determines nothing of the gear: record an angle or a speed with it{hint}", ways)


# ---- Runs ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of constant speed.

    Attributes:
        speed: mean, of the side on which it was measured [rad/s]
        torque: of each row [N.m]
        temperature: mean of the stretch, or as given with the file [K]; not a number if unknown
        angle: of the joint at each row [rad]; None if it was not measured
        whole: False if an angle shows less than a turn of the input
    """

    speed: float
    torque: Array
    temperature: float
    angle: Array | None = None
    whole: bool = True


@dataclass(frozen=True)
class ConstantSpeedRun:
    """A record at one speed, or at several speeds one after the other.

    Attributes:
        file: that it came from
        side: on which it was measured
        stretches: at constant speed
        turning: usual speed, angle and torque of each stretch in which the input turns once or more
        uncertain: relative standard deviation of the torque constant that the torques rest on [1]
        remarks: what was assumed
    """

    file: Recognised
    side: Side
    stretches: tuple[Stretch, ...]
    turning: tuple[Recording, ...]
    uncertain: float
    remarks: tuple[str, ...]


def run_of(file: Recognised, known: GearSoFar) -> ConstantSpeedRun | None:
    """Return a file as a run at constant speed; None if it is none.

    Raises:
        ValueError: it contains a current alone, and the torque constant is not known
    """
    motion = _motion(file)
    if motion is None or not {"torque", "input_torque", "joint_torque", "current"} & set(file.recording.names):
        return None
    speed, parts, side, assumed = motion
    if not parts:
        return None
    ratio = abs(known.gear_set.gear.kinematics.ratio)
    torque, uncertain, counted = _torque(file, known, side)
    if counted != side:
        torque = torque * ratio if side == "output" else torque / ratio
    load = file.constants.get("load_torque", 0.0)
    torque = torque - (load if side == "output" else load / known.gear_set.gear.kinematics.ratio)
    angle = _angle(file, side)
    turning: tuple[Recording, ...] = ()
    if angle is not None and side == "input":
        turning = tuple(_turning(speed, angle, torque, parts))
        parts = [_whole_turns(angle, part) for part in parts]
    stretches = tuple(_stretches(file, speed, torque, angle, parts, ratio if side == "input" else 1.0))
    if not all(each.whole for each in stretches):
        assumed = (*assumed, "less than a turn at one speed does not average out what varies over the turn")
    return ConstantSpeedRun(file, side, stretches, turning, uncertain, assumed)


def _motion(file: Recognised) -> tuple[Array, Sequence[slice], Side, tuple[str, ...]] | None:
    """Return the speed at each row, the rows of each stretch at constant speed, their side, and what was assumed."""
    recording, rows = file.recording, len(file.recording)
    side, assumed = file.side, list[str]()
    for name, of in (("input", "input"), ("output", "output"), ("", None)):
        prefix = f"{name}_" if name else ""
        if "time" in recording and {f"{prefix}angle", f"{prefix}speed"} & set(recording.names):
            speed, parts = _in_time(recording, prefix)
        elif f"{prefix}speed" in recording:
            speed = sensible(recording, f"{prefix}speed", "rad/s")
            parts = _of_speed(speed)
        elif not name and "speed" in file.constants:
            speed, parts = np.full(rows, file.constants["speed"]), [slice(0, rows)]
        else:
            continue
        fast = bool(np.median(np.abs(speed)) > MIN_MOTOR_SPEED)
        if of is None and side is None and not fast:
            assumed.append("no side is stated, the input is taken; otherwise add --side output")
        of_side: Side = "output" if (of or side) == "output" and not fast else "input"
        return speed, parts, of_side, tuple(assumed)
    return None


def _in_time(recording: Recording, prefix: str) -> tuple[Array, list[slice]]:
    """Return the speed at each row, as measured or the mean of its stretch, and the rows of each stretch at constant speed."""
    time, measured = recording.time, f"{prefix}speed" in recording
    speed = sensible(recording, f"{prefix}speed", "rad/s") if measured else np.zeros(len(recording))
    angle = sensible(recording, f"{prefix}angle", "rad") if f"{prefix}angle" in recording else integrated(speed, time)
    parts = constant_speeds(time, angle)
    for part in [] if measured else parts:
        last = part.stop - 1
        speed[part] = (angle[last] - angle[part.start]) / (time[last] - time[part.start])
    return speed, parts


def is_one_speed(speed: Array) -> bool:
    """True if a speed is the same in nearly all rows."""
    middle = float(np.median(speed))
    return bool(np.quantile(np.abs(speed - middle), MIN_SHARE_OF_ROWS) < MAX_CHANGE * abs(middle))


def _of_speed(speed: Array) -> list[slice]:
    """Return the rows of each stretch of a measured speed."""
    if is_one_speed(speed):
        return [slice(0, len(speed))]
    parts = stretches(speed)
    return parts if speed.min() >= 0.0 or speed.max() <= 0.0 or fills_record(parts, len(speed)) else []


def _torque(file: Recognised, known: GearSoFar, side: Side) -> tuple[Array, float, Side]:
    """Return the torque at each row, the relative uncertainty that all rows share [1], and the side on which it counts."""
    recording = file.recording
    if "joint_torque" in recording:
        return sensible(recording, "joint_torque", "N.m"), 0.0, "output"
    if "input_torque" in recording:
        return sensible(recording, "input_torque", "N.m"), 0.0, "input"
    counted: Side = side if "torque" in recording else file.side or "input"
    with_it, uncertain = with_torque(file, known.gear_set)
    return sensible(with_it, "torque", "N.m"), uncertain, counted


def _stretches(
    file: Recognised, speed: Array, torque: Array, angle: Array | None, parts: Sequence[slice], ratio: float
) -> Iterator[Stretch]:
    """Yield the stretches of a file; `ratio` is that of the measured angle to the angle of the joint."""
    recording, given = file.recording, file.constants.get("temperature", np.nan)
    warm = recording.values("temperature", "K") if "temperature" in recording else np.full(len(speed), given)
    for part in parts:
        turned = None if angle is None else angle[part]
        whole = turned is None or ratio == 1.0 or abs(turned[-1] - turned[0]) > WHOLE_TURN * FULL_TURN
        joint = None if turned is None else turned / ratio
        yield Stretch(float(np.median(speed[part])), torque[part], float(np.mean(warm[part])), joint, whole)


def _angle(file: Recognised, side: Side) -> Array | None:
    """Return the measured angle of a side at each row; None if there is none."""
    name = next((name for name in (f"{side}_angle", "angle") if name in file.recording), None)
    return None if name is None else file.recording.values(name, "rad")


def _whole_turns(angle: Array, part: slice) -> slice:
    """Return the rows of a stretch up to its last whole turn, which average out what varies over it; all of less than one."""
    way = np.abs(angle[part] - angle[part][0])
    turns = float(way[-1] // FULL_TURN)
    return part if turns < 1.0 else slice(part.start, part.start + max(int(np.argmax(way >= turns * FULL_TURN)), 1))


def _turning(speed: Array, angle: Array, torque: Array, parts: Sequence[slice]) -> Iterator[Recording]:
    """Yield usual speed, angle and torque of each stretch in which the input turns once or more."""
    for part in parts:
        if abs(angle[part][-1] - angle[part][0]) >= FULL_TURN:
            usual = np.full(len(angle[part]), abs(np.median(speed[part])))
            columns = {"angle": angle[part], "torque": torque[part], "speed": usual}
            yield Recording(columns, {"angle": "rad", "torque": "N.m", "speed": "rad/s"})


# ---- Results ----------------------------------------------------------------------------------------------------------


def of_run(run: ConstantSpeedRun) -> FileResult:
    """Return the result of one file, whose stretches are points of the table of all."""
    speeds = np.array([each.speed for each in run.stretches])
    levels = levels_of([each.torque for each in run.stretches], [None] * len(speeds), speeds)
    ways = []
    for stretch, torque, sigma in list(zip(run.stretches, levels.torque, levels.sigma, strict=True))[:3]:
        scatter = f" ± {sigma:.2g}" if sigma > 0.0 else ""
        ways.append(f"{torque:.4g}{scatter} N·m at {stretch.speed:.4g} rad/s of the {run.side}")
    count = len(run.stretches)
    more = f", and {count - 3} speeds more" if count > 3 else ""
    kind = "constant speed" if count == 1 else f"{count} stretches at constant speed"
    return FileResult(
        run.file.path.name,
        run.file,
        f"{kind}: {listed(ways)}{more}",
        remarks=(*run.file.remarks, *run.remarks),
        part_of=JOINED_NAME,
    )


def joined(runs: Sequence[ConstantSpeedRun], known: GearSoFar) -> Together:
    """Return the friction that runs determine together: a law from four speeds on, else the friction at each speed.

    If the runs determine gravity over the angle of the joint, it is taken out, and is a result, too.

    Raises:
        ValueError: the runs were measured on different sides, or nothing moves
    """
    if not runs:
        return (), known
    if len({run.side for run in runs}) > 1:
        raise ValueError("some were measured at the input, some at the output: give the files of each side by themselves")
    side, parts = runs[0].side, [each for run in runs for each in run.stretches if each.speed != 0.0]
    if not parts:
        raise ValueError("nothing moves at a constant speed: all stretches are at rest")
    levels = _levels(parts)
    speed, remarks = _signed(np.array([part.speed for part in parts]), levels.torque)
    gravity = tuple(_gravity(levels, known.gear_set.gear.kinematics.ratio if side == "input" else 1.0))
    if gravity:
        remarks = (*remarks, "gravity is one wave over the angle of the joint, which counts from one zero in all files")
    kept = np.array([each.whole for each in parts]) | (gravity != ())
    if not kept.all() and different_speeds(speed[kept]) >= MIN_SPEEDS:
        left_out = f"{np.sum(~kept)} means over less than a turn are left out, as what varies over the turn is in them"
        remarks = (*remarks, left_out)
    else:
        kept[:] = True
    uncertain = max(run.uncertain for run in runs)
    names = listed(run.file.path.name for run in runs)
    why = (f"each of {names} contains the torque at constant speed: their levels are {kept.sum()} points of one table",)
    columns, units = {"speed": speed[kept], "torque": levels.torque[kept]}, {"speed": "rad/s", "torque": "N.m"}
    warm = np.array([each.temperature for each in parts])[kept]
    if np.isfinite(warm).all():
        columns["temperature"], units["temperature"] = warm, "K"
    file = Recognised(Path(JOINED_NAME), "friction", {}, {}, side, why, remarks, {}, Recording(columns, units))
    if different_speeds(speed[kept]) < MIN_SPEEDS:
        estimates, few = friction_at_speeds(speed, levels.torque, levels.covariance, side)
        estimates = tuple(each.resting_on(uncertain) for each in estimates)
        checks = tuple(opposes_motion(estimates, names))
        every = (*estimates, *gravity)
        result = FileResult(JOINED_NAME, file, AT_SPEEDS, every, (*remarks, *few), checks, what=TABLE_TITLE)
        return (result,), with_friction_at(known, speed, estimates, side, names)
    result, after = fit_table(file, file.recording, uncertain, known)
    return (replace(result, name=JOINED_NAME, what=TABLE_TITLE, estimates=(*result.estimates, *gravity)),), after


def _signed(speed: Array, torque: Array) -> tuple[Array, tuple[str, ...]]:
    """Return the speeds, each with the sign of its motion, and what was assumed for it."""
    if (speed > 0.0).all() and (torque < 0.0).any() and (torque > 0.0).any():
        remark = "all speeds are positive, torques are of both signs: each speed is taken to have the sign of its torque"
        return speed * np.sign(torque), (remark,)
    return speed, ()


def _levels(parts: Sequence[Stretch]) -> Levels:
    return levels_of([part.torque for part in parts], [part.angle for part in parts], np.array([part.speed for part in parts]))


def _gravity(levels: Levels, ratio: float) -> Iterator[FileEstimate]:
    """Yield the gravity torque and its phase at the output, as `loads.Pendulum` has them.

    Args:
        levels: of torques over the angle of the joint, counted as the shaft that was measured turns
        ratio: speed of that shaft over that of the output; negative if they turn against each other
    """
    if levels.gravity_sigma is None:
        return
    size, phase = float(np.hypot(levels.cosine, levels.sine)), float(np.arctan2(levels.cosine, levels.sine))
    of_cosine, of_sine = levels.gravity_sigma
    along = float(np.hypot(of_cosine * levels.cosine, of_sine * levels.sine)) / size
    across = float(np.hypot(of_cosine * levels.sine, of_sine * levels.cosine)) / size**2
    yield FileEstimate("load.gravity_torque", "N.m", abs(ratio) * size, abs(ratio) * along, "")
    yield FileEstimate("load.gravity_phase", "rad", float(np.sign(ratio)) * phase, across, "")


def over_the_angle(runs: Sequence[ConstantSpeedRun], known: GearSoFar) -> Together:
    """Return friction over the angle of the input, as the position control article has it; nothing if no run turns once."""
    turning = [run for run in runs if run.turning]
    if not turning:
        return (), known
    recordings = [recording for run in turning for recording in run.turning]
    moving = [stretch for run in runs for stretch in run.stretches if stretch.speed != 0.0]
    has_gravity = _levels(moving).gravity_sigma is not None
    position_fit = fit_position(recordings, 1.0 / abs(known.gear_set.gear.kinematics.ratio) if has_gravity else None)
    names = [run.file.path.name for run in turning]
    measured = "friction_input" in known.determined
    left = Left(rms(position_fit.residual), rms(position_fit.friction), "N.m", MAX_SHARE_OF_TORQUE)
    whole = error_left({"friction over the angle": left}, listed(names))
    estimates = only_if_explained(_estimates(position_fit, max(run.uncertain for run in turning), measured=measured), whole)
    law: Any = known.gear_set.gear.friction_input
    remarks = list(_of_position(position_fit, len(recordings)))
    if len({stretch.speed > 0.0 for stretch in moving}) == 1:
        remarks.append("it has one direction only: gravity over the angle is part of this friction; record both directions")
    sliding = law.law if law.name == "thermal" else law
    waves = _waves(position_fit)
    sigmas = {each.path: each.sigma for each in estimates if not each.why}
    name, after = f"friction over the angle of {listed(names)}", known
    if not measured:
        remarks.append("no other file determines friction: the gear takes this law, valid at the angles and speeds measured")
        after = known.with_parts({"friction_input": position_fit.law}, sigmas, listed(names))
    elif waves and sliding.name != "cyclic":
        after = _modulated(known, waves, listed(names))
        remarks.append("the gear takes its waves around the friction that other files determine, relative to its mean")
    file = turning[0].file
    why = (f"at constant speed the angle of {listed(names)} turns once or more under a torque",)
    columns = {
        "angle": position_fit.angle,
        "torque": position_fit.friction,
        "modelled": position_fit.friction - position_fit.residual,
    }
    rows = slice(0, len(recordings[0]))
    order = np.argsort(position_fit.angle[rows], kind="stable")
    curves = Recording(
        {each: values[rows][order] for each, values in columns.items()}, {"angle": "rad", "torque": "N.m", "modelled": "N.m"}
    )
    read = replace(file, path=Path(name), why=why, remarks=())
    model, picture = "a parabola and ten orders of the turn", Picture(curves)
    return (FileResult(name, read, model, estimates, tuple(remarks), (whole,), what=ANGLE_TITLE, pictures=(picture,)),), after


def _estimates(found: PositionFit, uncertain: float, *, measured: bool) -> Iterator[FileEstimate]:
    """Yield the numbers of the law; `measured`: a table of the same runs determines the viscous part."""
    waves = {f"{name}[{order - 1}]" for order in _waves(found) for name in ("cosine", "sine")}
    one_speed = all(each.path != "viscous" for each in found.estimates)
    for each in found.estimates:
        if (each.path == "viscous" and measured) or ("[" in each.path and each.path not in waves):
            continue
        sure = each.path in waves or abs(each.value) > SIGNIFICANCE_SIGMA * each.sigma
        why = "" if sure else "it is no larger than what chance may make"
        if each.path == "constant" and one_speed:
            why = "one speed determines its sum with the viscous part, see steady friction"
        own = FileEstimate(f"gear.friction_input.{each.path}", each.unit, each.value, each.sigma, "position_dependent", why)
        yield own.sharing(uncertain * abs(each.value))


def _of_position(found: PositionFit, count: int) -> Iterator[str]:
    if count > 1:
        yield f"{count} runs are fitted together: their angles must count from one zero"
    yield f"the law leaves {rms(found.residual):.2g} N·m of {float(np.mean(np.abs(found.friction))):.3g} N·m"
    none = [order for order in range(1, len(found.law.cosine) + 1) if order not in _waves(found)]
    if none:
        bound = SIGNIFICANCE_SIGMA * max(each.sigma for each in found.estimates if "[" in each.path)
        yield f"orders {listed(map(str, none))} of the turn are no larger than what chance makes, at most {bound:.1g} N·m"
    if found.integrated is not None:
        off = max(
            abs(one - other)
            for name in ("cosine", "sine")
            for one, other in zip(getattr(found.law, name), getattr(found.integrated, name), strict=True)
        )
        yield f"the position control article's integrals over whole turns give waves that differ by {off:.1g} N·m at most"


def _waves(found: PositionFit) -> dict[int, tuple[float, float, float]]:
    """Return relative amplitude, phase and relative standard deviation of the waves that chance does not make, by their orders.

    Of a wave that is none, the square of its size over its variance exceeds 2 ln(n / p) with the probability p in one of n
    orders (Rayleigh).
    """
    least = float(np.sqrt(2.0 * np.log(max(len(found.law.cosine), 1) / MAX_CHANCE_OF_WAVE)))
    mean, by_name = float(np.mean(np.abs(found.friction))), {each.path: each for each in found.estimates}
    waves = {}
    for order in range(1, len(found.law.cosine) + 1):
        cosine, sine = by_name[f"cosine[{order - 1}]"], by_name[f"sine[{order - 1}]"]
        size, sigma = float(np.hypot(cosine.value, sine.value)), max(cosine.sigma, sine.sigma)
        if size > least * sigma:
            waves[order] = (size / mean, float(np.arctan2(cosine.value, sine.value)), sigma / mean)
    return waves


def _modulated(known: GearSoFar, waves: dict[int, tuple[float, float, float]], name: str) -> GearSoFar:
    """Return the set with waves around the friction that it has; inside what changes with the temperature."""
    amplitude, phase, sigma = map(list, zip(*waves.values(), strict=True))
    law: Any = known.gear_set.gear.friction_input
    warm = law.name == "thermal"
    around = friction.Cyclic(law=law.law if warm else law, order=list(map(float, waves)), amplitude=amplitude, phase=phase)
    path = f"gear.friction_input.{'law.' if warm else ''}"
    sigmas = {f"{path}amplitude[{i}]": each for i, each in enumerate(sigma)}
    sigmas |= {f"{path}phase[{i}]": each / size for i, (each, size) in enumerate(zip(sigma, amplitude, strict=True))}
    return known.with_parts({"friction_input": law.replace(law=around) if warm else around}, sigmas, name)
