"""Records at constant speed, one speed and direction each: the points of one friction table, and friction over the angle."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import friction
from strainwave.files.recording import Recording
from strainwave.identification.candidates.position import TURN, PositionFit, fit_position
from strainwave.identification.fitting.covariance import correlation_length
from strainwave.identification.kinds.fit_file import friction_of
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.sides import FAST
from strainwave.identification.reading.steady import stretches
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar, with_torque
from strainwave.messages import listed

Array = NDArray[np.float64]

STEADY = 0.05  # of the usual speed, by which most of a record of one speed differs from it at most
MOSTLY = 0.95  # of the rows
ROWS = 200  # parts of a record over which the speed of an angle is told
FEWEST = 41  # rows that tell a speed by the angle
WHOLE = 0.98  # of a turn, from which on it is one
SPEEDS = 4  # different ones that tell a law
SURE = 3.0  # standard deviations: a parabola that is smaller is none
CHANCE = 1e-3  # probability that chance alone gives a wave, over all orders
JOINED = "records at constant speed"
WHAT = "friction over the angle, at constant speed"


@dataclass(frozen=True)
class Point:
    """The mean of one stretch of constant speed.

    Attributes:
        speed: of the side on which it was measured [rad/s]
        torque: [N.m]
        sigma: standard deviation of the torque by its scatter [N.m]
        temperature: mean of the stretch, or as a person gave it [K]; not a number where neither tells it
        whole: whether it is a mean over whole turns, as far as an angle tells
    """

    speed: float
    torque: float
    sigma: float
    temperature: float
    whole: bool = True


@dataclass(frozen=True)
class Run:
    """A file of one speed, or of several speeds one way.

    Attributes:
        file: that it came from
        side: on which it was measured
        points: of its stretches
        turning: angle and torque of a run one way of the input that tells friction over the angle; None if it does not
        uncertain: standard deviation of the torque constant that it rests on, over its value [1]
        remarks: what was assumed
    """

    file: Recognised
    side: Side
    points: tuple[Point, ...]
    turning: Recording | None
    uncertain: float
    remarks: tuple[str, ...]


def run_of(file: Recognised, known: GearSoFar) -> Run | None:
    """A file as a run at constant speed; None where it is none.

    Raises:
        ValueError: it tells a current alone, and the torque constant is not known
    """
    found = _speed(file)
    if found is None or not {"torque", "input_torque", "joint_torque", "current"} & set(file.recording.names):
        return None
    speed, side, told = found
    one = bool(np.quantile(np.abs(speed - np.median(speed)), MOSTLY) < STEADY * abs(np.median(speed)))
    parts = [slice(0, len(speed))] if one else stretches(speed) if speed.min() >= 0.0 or speed.max() <= 0.0 else []
    if not parts:
        return None
    torque, uncertain, counted = _torque(file, known, side)
    if counted != side:
        ratio = known.gear_set.gear.kinematics.ratio
        torque = torque * ratio if side == "output" else torque / ratio
    load = file.constants.get("load_torque", 0.0)
    held = load if side == "output" else load / known.gear_set.gear.kinematics.ratio
    angle = _angle(file, side)
    if angle is not None:
        parts = [_whole_turns(angle, part) for part in parts]
    points = tuple(_points(file.recording, speed, torque - held, parts, file.constants.get("temperature", np.nan)))
    if angle is not None:
        turns = [abs(angle[part][-1] - angle[part][0]) / TURN for part in parts]
        points = tuple(replace(point, whole=each > WHOLE) for point, each in zip(points, turns, strict=True))
        if min(turns) <= WHOLE:
            told = (*told, "less than a turn at one speed does not average out what varies over the turn")
    return Run(file, side, points, _turning(file, torque - held, side) if one else None, uncertain, told)


def _speed(file: Recognised) -> tuple[Array, Side, tuple[str, ...]] | None:
    """Speed at each row, its side, and what was assumed."""
    recording, rows = file.recording, len(file.recording)
    side, told = file.side, list[str]()
    for name, of in (("input", "input"), ("output", "output"), ("", None)):
        prefix = f"{name}_" if name else ""
        if f"{prefix}speed" in recording:
            speed = recording.values(f"{prefix}speed", "rad/s")
        elif f"{prefix}angle" in recording and "time" in recording and rows >= FEWEST:
            speed = _slope(recording.time, recording.values(f"{prefix}angle", "rad"))
        elif not name and "speed" in file.constants:
            speed = np.full(rows, file.constants["speed"])
        else:
            continue
        if of is None and side is None and np.median(np.abs(speed)) <= FAST:
            told.append("no side is stated, the input is taken; --side output says that it was measured there")
        taken: Side = "output" if (of or side) == "output" and np.median(np.abs(speed)) <= FAST else "input"
        return speed, taken, tuple(told)
    return None


def _slope(time: Array, angle: Array) -> Array:
    """Speed of an angle, over a small part of the record."""
    apart = max(len(time) // ROWS, 1)
    elapsed = np.maximum(time[apart:] - time[:-apart], 1e-300)
    found = (angle[apart:] - angle[:-apart]) / elapsed
    return np.interp(time, 0.5 * (time[apart:] + time[:-apart]), found)


def _torque(file: Recognised, known: GearSoFar, side: Side) -> tuple[Array, float, Side]:
    """Torque at each row, what is uncertain of all of it [1], and the side on which it counts."""
    recording = file.recording
    if "joint_torque" in recording:
        return recording.values("joint_torque", "N.m"), 0.0, "output"
    if "input_torque" in recording:
        return recording.values("input_torque", "N.m"), 0.0, "input"
    counted: Side = side if "torque" in recording else file.side or "input"
    with_it, uncertain = with_torque(file, known.gear_set)
    return with_it.values("torque", "N.m"), uncertain, counted


def _points(recording: Recording, speed: Array, torque: Array, parts: Sequence[slice], given: float) -> Iterator[Point]:
    warm = recording.values("temperature", "K") if "temperature" in recording else np.full(len(speed), given)
    for part in parts:
        left = torque[part] - torque[part].mean()
        together = correlation_length(left) if np.ptp(left) > 0.0 and len(left) > 10 else 1.0
        sigma = float(np.std(left) * np.sqrt(together / len(left)))
        yield Point(float(np.median(speed[part])), float(torque[part].mean()), sigma, float(np.mean(warm[part])))


def _angle(file: Recognised, side: Side) -> Array | None:
    """The angle of the input at each row, where it was measured."""
    name = next((name for name in ("input_angle", "angle") if name in file.recording), None)
    return None if name is None or side == "output" else file.recording.values(name, "rad")


def _whole_turns(angle: Array, part: slice) -> slice:
    """The rows of a stretch up to its last whole turn, which average out what varies over the turn; all of less than one."""
    way = np.abs(angle[part] - angle[part][0])
    turns = float(way[-1] // TURN)
    return part if turns < 1.0 else slice(part.start, part.start + max(int(np.argmax(way >= turns * TURN)), 1))


def _turning(file: Recognised, torque: Array, side: Side) -> Recording | None:
    """Angle and torque, where the angle of the input turns once or more."""
    angle = _angle(file, side)
    if angle is None or abs(angle[-1] - angle[0]) < TURN:
        return None
    return Recording({"angle": angle, "torque": torque}, {"angle": "rad", "torque": "N.m"})


# ---- Findings ---------------------------------------------------------------------------------------------------------


def of_run(run: Run) -> FileResult:
    """What one file is, as a part of the table of all."""
    ways = []
    for point in run.points[:3]:
        scatter = f" ± {point.sigma:.2g}" if point.sigma > 0.0 else ""
        ways.append(f"{point.torque:.4g}{scatter} N·m at {point.speed:.4g} rad/s of the {run.side}")
    more = f", and {len(run.points) - 3} speeds more" if len(run.points) > 3 else ""
    kind = "constant speed" if len(run.points) == 1 else f"{len(run.points)} constant speeds one way"
    return FileResult(
        run.file.path.name, run.file, f"{kind}: {listed(ways)}{more}", remarks=(*run.file.remarks, *run.remarks), part_of=JOINED
    )


def joined(runs: Sequence[Run], known: GearSoFar) -> tuple[FileResult, GearSoFar]:
    """The friction table of which each run is one point or some.

    Raises:
        ValueError: they tell no law
    """
    sides = {run.side for run in runs}
    if len(sides) > 1:
        raise ValueError("some were measured at the input, some at the output: give the files of each side by themselves")
    points = [point for run in runs for point in run.points]
    whole = [point for point in points if point.whole]
    short = len(points) - len(whole) if _different(whole) >= SPEEDS else 0
    points = whole if short else points
    speed, torque, signed = _signed(points)
    if short:
        signed = (*signed, f"{short} means over less than a turn are left out, as what varies over the turn is in them")
    different = _different(points)
    if different < SPEEDS:
        raise ValueError(
            f"{len(runs)} {'record' if len(runs) == 1 else 'records'} at {different} different "
            f"{'speed' if different == 1 else 'speeds'}, slow or fast, one way or the other, tell no law of friction; "
            f"record {SPEEDS} speeds or more, best both ways"
        )
    columns, units = {"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"}
    if all(np.isfinite(point.temperature) for point in points):
        columns["temperature"], units["temperature"] = np.array([point.temperature for point in points]), "K"
    (side,) = sides
    names = listed(run.file.path.name for run in runs)
    why = (f"each of {names} holds the torque at constant speed: their means are the {len(points)} points of one table",)
    file = Recognised(Path(JOINED), "friction", {}, {}, side, why, signed, {}, Recording(columns, units))
    finding, after = friction_of(file, file.recording, max(run.uncertain for run in runs), known)
    return replace(finding, name=JOINED, what="a table of steady friction, of many files"), after


def _different(points: Sequence[Point]) -> int:
    """How many speeds are not alike."""
    sizes = np.array([point.speed for point in points])
    return len(np.unique(np.round(np.log(np.abs(sizes)), 1) * np.sign(sizes))) if len(sizes) else 0


def _signed(points: Sequence[Point]) -> tuple[Array, Array, tuple[str, ...]]:
    """Speeds and torques, each speed with the sign of its motion."""
    speed, torque = np.array([point.speed for point in points]), np.array([point.torque for point in points])
    if (speed > 0.0).all() and (torque < 0.0).any() and (torque > 0.0).any():
        said = "all speeds are positive, torques are of both signs: each speed is taken to have the sign of its torque"
        return speed * np.sign(torque), torque, (said,)
    return speed, torque, ()


def over_the_angle(runs: Sequence[Run], known: GearSoFar) -> tuple[FileResult, GearSoFar] | None:
    """Friction over the angle of the input, as document P describes it; None where no run tells it."""
    turning = [run for run in runs if run.turning is not None]
    if not turning:
        return None
    recordings = [_with_speed(run) for run in turning]
    found = fit_position(recordings)
    names = [run.file.path.name for run in turning]
    told = tuple(_numbers(found, max(run.uncertain for run in turning)))
    law: Any = known.gear_set.gear.friction_input
    remarks = list(_of_position(found, len(turning)))
    sliding = law.law if law.name == "thermal" else law
    waves = _waves(found)
    sigmas = {each.path: each.sigma for each in told if not each.why}
    name, after = f"friction over the angle of {listed(names)}", known
    if "friction_input" not in known.determined:
        remarks.append("no other file tells friction: the gear takes this law, valid over the angles measured")
        after = known.with_parts({"friction_input": found.law}, sigmas, listed(names))
    elif waves and sliding.name != "cyclic":
        after = _modulated(known, waves, listed(names))
        remarks.append("the gear takes its waves around the friction that other files tell, relative to its mean")
    file = turning[0].file
    why = (f"at constant speed the angle of {listed(names)} turns once or more beside a torque",)
    columns = {"angle": found.angle, "torque": found.friction, "modelled": found.friction - found.residual}
    rows = slice(0, len(recordings[0]))
    order = np.argsort(found.angle[rows], kind="stable")
    curves = Recording(
        {each: values[rows][order] for each, values in columns.items()}, {"angle": "rad", "torque": "N.m", "modelled": "N.m"}
    )
    read = replace(file, path=Path(name), why=why, remarks=())
    return FileResult(
        name, read, "a parabola and ten orders of the turn", told, remarks=tuple(remarks), what=WHAT, curves=curves
    ), after


def _with_speed(run: Run) -> Recording:
    assert run.turning is not None
    return run.turning.with_column("speed", np.full(len(run.turning), abs(run.points[0].speed)), "rad/s")


def _numbers(found: PositionFit, uncertain: float) -> Iterator[FileEstimate]:
    waves = {f"{name}[{order - 1}]" for order in _waves(found) for name in ("cosine", "sine")}
    for each in found.estimates:
        common = uncertain * abs(each.value)
        sigma = float(np.hypot(each.sigma, common))
        if each.path == "viscous" or ("[" in each.path and each.path not in waves):
            continue  # the table of the same records tells the viscous part
        sure = each.path in waves or abs(each.value) > SURE * each.sigma
        why = "" if sure else "it is no larger than what chance may make"
        yield FileEstimate(f"gear.friction_input.{each.path}", each.unit, each.value, sigma, "position_dependent", why, common)


def _of_position(found: PositionFit, count: int) -> Iterator[str]:
    if count > 1:
        yield f"{count} runs are fitted together: their angles must count from one zero"
    left = float(np.sqrt(np.mean(found.residual**2)))
    yield f"the law leaves {left:.2g} N·m of {float(np.mean(np.abs(found.friction))):.3g} N·m"
    none = [order for order in range(1, len(found.law.cosine) + 1) if order not in _waves(found)]
    if none:
        bound = SURE * max(each.sigma for each in found.estimates if "[" in each.path)
        yield f"orders {listed(map(str, none))} of the turn are no larger than what chance makes, at most {bound:.1g} N·m"
    if found.integrated is not None:
        off = max(
            abs(one - other)
            for name in ("cosine", "sine")
            for one, other in zip(getattr(found.law, name), getattr(found.integrated, name), strict=True)
        )
        yield f"document P's integrals over whole turns give waves that differ by {off:.1g} N·m at most"


def _waves(found: PositionFit) -> dict[int, tuple[float, float, float]]:
    """Relative amplitude, phase and relative standard deviation of the waves that chance does not make, by their orders.

    Of a wave that is none, the square of its size over its variance exceeds 2 ln(n / p) with the probability p in one of n
    orders (Rayleigh).
    """
    least = float(np.sqrt(2.0 * np.log(max(len(found.law.cosine), 1) / CHANCE)))
    mean, by_name = float(np.mean(np.abs(found.friction))), {each.path: each for each in found.estimates}
    waves = {}
    for order in range(1, len(found.law.cosine) + 1):
        cosine, sine = by_name[f"cosine[{order - 1}]"], by_name[f"sine[{order - 1}]"]
        size, sigma = float(np.hypot(cosine.value, sine.value)), max(cosine.sigma, sine.sigma)
        if size > least * sigma:
            waves[order] = (size / mean, float(np.arctan2(cosine.value, sine.value)), sigma / mean)
    return waves


def _modulated(known: GearSoFar, waves: dict[int, tuple[float, float, float]], name: str) -> GearSoFar:
    """The set with waves around the friction that it has; inside what changes with the temperature."""
    amplitude, phase, sigma = map(list, zip(*waves.values(), strict=True))
    law: Any = known.gear_set.gear.friction_input
    warm = law.name == "thermal"
    around = friction.Cyclic(law=law.law if warm else law, order=list(map(float, waves)), amplitude=amplitude, phase=phase)
    path = f"gear.friction_input.{'law.' if warm else ''}"
    sigmas = {f"{path}amplitude[{i}]": each for i, each in enumerate(sigma)}
    sigmas |= {f"{path}phase[{i}]": each / size for i, (each, size) in enumerate(zip(sigma, amplitude, strict=True))}
    return known.with_law(law.replace(law=around) if warm else around, sigmas, name)
