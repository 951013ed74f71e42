"""Measurements that could be made of a gear or a drive within its limits, and the choice among them by Fisher information.

Fedorov1972; Atkinson2007, chapters 10 (criteria) and 12 (exchange).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear
from strainwave.analysis.branches import slid
from strainwave.files.recording import Recording
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.experiments.experiment import Experiment
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.parameters import every
from strainwave.simulation.run import simulate
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.signals import outputs
from strainwave.statistics.determined_sum import MIN_INFORMATION, MIN_MOVED, undetermined
from strainwave.statistics.linear_fit import solved

Array = NDArray[np.float64]
SPEED_COUNT = 40  # of a friction table, from the lowest to the highest
AMPLITUDE_COUNT = 12  # of a torsion loop
MIN_AMPLITUDE_SHARE = 0.02  # of the torque limit: amplitude of the smallest torsion loop
MIN_STEPS = 20.0  # resolutions of torque and of angle in the amplitude of a loop: fewer do not show its shape
TORQUE_RESOLUTION = 2e-3  # of the torque limit; classes of torque sensors are 0.1 to 0.5 % of their rated torque (assumed)
OUTPUT_ANGLE_RESOLUTION = 1e-5  # rad, 2 arc seconds: a good encoder of an output with its mounting (assumed)
INPUT_ANGLE_RESOLUTION = 1e-4  # rad, 16 bit a turn: the encoder of a motor (assumed)
LOOP_SAMPLES = 200
COMMAND_SHARES = (1.0, 0.5, 0.25, 0.1)  # of a command
USUAL_COLUMNS = ("input_angle", "current")  # columns of a log that nearly every drive records
RELATIVE_NOISE = 0.01  # of the largest value of a channel, if no noise is given (assumed)
Criterion = Literal["A", "D"]
MIN_GAIN = 1e-9  # of a criterion; a smaller one is rounding
MAX_EXCHANGE_PASSES = 50  # of exchanges; a handful is enough
BUDGET_TOLERANCE = 1e-12  # relative, for rounding


# ---- Measurements ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Resolution:
    """The smallest differences that sensors resolve, their errors that no mean takes out included.

    Args:
        torque: at the output [N.m]
        angle: at the output [rad]
        input_torque: at the input [N.m]
        input_angle: at the input [rad]
    """

    torque: float
    angle: float
    input_torque: float
    input_angle: float

    @classmethod
    def usual(cls, torque: float, ratio: float) -> Resolution:
        """Return those of usual sensors for a gear of this torque limit at the output [N.m]; 0 for a torque without a limit."""
        of_torque = TORQUE_RESOLUTION * torque if np.isfinite(torque) else 0.0
        return cls(of_torque, OUTPUT_ANGLE_RESOLUTION, of_torque / abs(ratio), INPUT_ANGLE_RESOLUTION)

    def resolves(self, torque: float, twist: float, ratio: float | None) -> bool:
        """True if a loop up to a torque and a twist at the output is large enough; `ratio`: it is measured at the input."""
        if ratio is None:
            return torque >= MIN_STEPS * self.torque and twist >= MIN_STEPS * self.angle
        return torque / abs(ratio) >= MIN_STEPS * self.input_torque and twist * abs(ratio) >= MIN_STEPS * self.input_angle


Noise = Mapping[str, float]
"""Standard deviation of a measurement: "friction" of the mean torque at one speed, at the input [N.m]; of one sample of a
loop "torsion" at the output and "input_torsion" at the input [N.m]; of one sample of a column of a log, by its name."""


@dataclass(frozen=True)
class Limits:
    """Largest speed and torque of a gear; infinite without a limit.

    Args:
        speed: of the input [rad/s]
        torque: at the output [N.m]
        lowest_speed: of the input that can be held steady [rad/s]
    """

    speed: float
    torque: float
    lowest_speed: float


@dataclass(frozen=True, eq=False)
class CandidateMeasurement:
    """One measurement that could be made.

    Attributes:
        kind: friction, torsion or motion
        settings: numbers of the measurement, with units in their names
        words: the same in words
        duration: its time [s]
        information: about the unknown parameters, in their units, shape (p, p)
    """

    kind: str
    settings: Mapping[str, float | str]
    words: str
    duration: float
    information: Array


def friction(
    gear: Gear, paths: Sequence[str], limits: Limits, noise: Noise, resolution: Resolution, duration: float
) -> Iterator[CandidateMeasurement]:
    """Yield friction torques at the input at constant speeds, each both ways."""
    one_way = np.geomspace(limits.lowest_speed, limits.speed, SPEED_COUNT)
    speed = np.concatenate((one_way, -one_way))
    torque, slopes = _predicted(FrictionTable(speed, speed), gear, paths)
    sigma = _sigma(noise, "friction", float(np.abs(torque).max()), resolution.input_torque)
    for row, each in enumerate(one_way.tolist()):
        rows = slopes[:, 0, [row, row + SPEED_COUNT]].T / sigma
        words = f"friction torque at ± {each:.4g} rad/s of the input ({each * 30.0 / pi:.4g} rpm)"
        yield CandidateMeasurement("friction", {"input_speed_rad_s": each}, words, 2.0 * duration, rows.T @ rows)


def torsion(
    gear: Gear, paths: Sequence[str], limits: Limits, noise: Noise, resolution: Resolution, duration: float
) -> Iterator[CandidateMeasurement]:
    """Yield torsion loops up to several torques, at the output with the input held, and at the input with the output held.

    Loops that the sensors do not resolve are left out.
    """
    ratio = float(gear.kinematics.ratio)
    for amplitude in np.geomspace(MIN_AMPLITUDE_SHARE * limits.torque, limits.torque, AMPLITUDE_COUNT).tolist():
        largest = float(np.max(gear.twist([0.0, amplitude])))
        for side, at in (("output", None), ("input", ratio)):
            if not resolution.resolves(amplitude, largest, at):
                continue
            loop = _loop(gear, largest, at)
            _, slopes = _predicted(loop, gear, paths)
            rows, count = (slopes[:, 0] / _loop_sigma(noise, at, limits, resolution, amplitude / largest)).T, len(paths)
            information = without_nuisances(rows[:, :count], rows[:, count:])
            held = "input" if at is None else "output"
            turn = largest if at is None else abs(ratio) * largest
            words = (
                f"torsion loop at the {side}, {held} held, to ± {amplitude:.4g} N.m at the output, which turns the {side} by "
                f"± {turn:.3g} rad"
            )
            settings: dict[str, float | str] = {"torque_N_m": amplitude, "measured_at": side, "held": held}
            yield CandidateMeasurement("torsion", settings, words, duration, information)


def _loop_sigma(noise: Noise, ratio: float | None, limits: Limits, resolution: Resolution, stiffness: float) -> float:
    """Return the noise of the torque of a loop, referred to the output [N.m]; if none is given, with that of the angle."""
    scale, name = (1.0, "torsion") if ratio is None else (abs(ratio), "input_torsion")
    if name in noise:
        return scale * noise[name]
    angle = resolution.angle if ratio is None else resolution.input_angle / scale
    least = resolution.torque if ratio is None else resolution.input_torque
    return float(np.hypot(scale * _sigma(noise, name, limits.torque / scale, least), stiffness * angle))


def _loop(gear: Gear, largest: float, ratio: float | None) -> TorsionLoop:
    quarter = LOOP_SAMPLES // 4
    twist = largest * np.interp(np.arange(LOOP_SAMPLES), [0, quarter, 3 * quarter, LOOP_SAMPLES - 1], [0.0, 1.0, -1.0, 0.0])
    if ratio is not None:
        twist = twist[slid(twist)]
    return TorsionLoop(twist, gear.trace(np.concatenate(([0.0], twist)))[1:], near_zero=0.0, input_ratio=ratio)


def motion(
    drive: Drive, paths: Sequence[str], limits: Limits, noise: Noise, commands: Mapping[str, Scenario], sample: float
) -> Iterator[CandidateMeasurement]:
    """Yield runs of a drive from rest under commands, and under shares of them; those that keep the limits."""
    recorded = outputs(drive)
    channels = [name for name in noise if name in recorded] or [name for name in USUAL_COLUMNS if name in recorded]
    tried = [(name, share, command * share) for name, command in commands.items() for share in COMMAND_SHARES]
    runs = [(*each, simulate(drive, each[-1], sample=sample)) for each in tried]
    within_limits = [each for each in runs if _kept(each[-1], limits)]
    if not within_limits:
        return
    sigmas = [_sigma(noise, each, max(float(np.ptp(run[each])) for *_, run in within_limits)) for each in channels]
    for name, share, command, run in within_limits:
        experiment = DriveLog.of(run.select(["time", "command", *channels]), drive, channels)
        _, slopes = _predicted(experiment, drive, paths)
        rows = np.concatenate([slopes[:, row] / sigma for row, sigma in enumerate(sigmas)], axis=1).T
        information = without_nuisances(rows[:, : len(paths)], rows[:, len(paths) :])
        words = f"run of {command.duration:.3g} s under {share:g} times the command {name}"
        yield CandidateMeasurement("motion", {"command": name, "share": share}, words, command.duration, information)


def _sigma(noise: Noise, name: str, largest: float, least: float = 0.0) -> float:
    """Return the noise that is given, or a share of the largest value that is no smaller than what a sensor resolves."""
    if name in noise:
        return noise[name]
    if not largest > 0.0:
        raise ValueError(
            f"the model predicts zero for {name}, of which no share can be taken as noise; give the noise of {name}"
        )
    return max(RELATIVE_NOISE * largest, least)


def _kept(run: Recording, limits: Limits) -> bool:
    """True if a run keeps the limits of speed and torque."""
    reached = {name: float(np.abs(run[name]).max()) for name in ("input_speed", "torque")}
    return reached["input_speed"] <= limits.speed and reached["torque"] <= limits.torque


def _predicted(experiment: Experiment, model: Any, paths: Sequence[str]) -> tuple[Array, Array]:
    """Return what a model predicts, and derivatives by the parameters, then by the nuisances; 0 by what it does not have."""
    places = {path: each.number for path, each in every(model).items()}
    present = [row for row, path in enumerate(paths) if path in places]
    start = np.array([each.start for each in experiment.nuisances])
    predicted, derivatives = experiment.predict(model, [places[paths[row]] for row in present], start)
    slopes = np.zeros((len(paths) + len(start), *predicted.shape))
    slopes[present] = derivatives[: len(present)]
    slopes[len(paths) :] = derivatives[len(present) :]
    return predicted, slopes


# ---- Choice ----------------------------------------------------------------------------------------------------------


def without_nuisances(slopes: Array, of_nuisances: Array) -> Array:
    """Return the information about parameters if the nuisances are unknown, too: the Schur complement, shape (p, p).

    Args:
        slopes: derivatives of what is measured by the parameters, over the noise, shape (n, p)
        of_nuisances: the same by the nuisances, shape (n, q)
    """
    if of_nuisances.shape[1]:
        slopes = slopes - of_nuisances @ solved(of_nuisances, slopes)
    information: Array = slopes.T @ slopes
    return information


def score(information: Array, wanted: Sequence[int], criterion: Criterion) -> Array:
    """Return the criterion of one information matrix or of many, the smaller the better, shape (…, p, p).

    A: logarithm of the sum of the variances of the wanted parameters. D: logarithm of the determinant of their covariance.
    """
    p = information.shape[-1]
    covariance = np.linalg.inv(information + MIN_INFORMATION * np.eye(p))[..., wanted, :][..., wanted]
    if criterion == "D":
        scored: Array = np.linalg.slogdet(covariance)[1]
        return scored
    return np.asarray(np.log(np.trace(covariance, axis1=-2, axis2=-1)))


def best(
    information: Array, cost: Array, budget: float, before: Array, wanted: Sequence[int], criterion: Criterion
) -> list[int]:
    """Return the places of the measurements to take, repeated ones several times: greedy by gain over cost, then by exchange.

    Args:
        information: of each candidate, in relative units, shape (m, p, p)
        cost: of each, shape (m,)
        budget: what all together may cost
        before: what is known before, shape (p, p)
        wanted: places of the parameters that count
    """
    chosen: list[int] = []
    total, left = before.copy(), budget
    while (affordable := np.flatnonzero(cost <= left * (1.0 + BUDGET_TOLERANCE))).size:
        gain = score(total, wanted, criterion) - score(total + information[affordable], wanted, criterion)
        place = int(np.argmax(gain / cost[affordable]))
        if gain[place] <= MIN_GAIN:
            break
        chosen.append(int(affordable[place]))
        total, left = total + information[chosen[-1]], left - cost[chosen[-1]]
    return _exchanged(chosen, information, cost, left, before, wanted, criterion)


def _exchanged(
    chosen: list[int], information: Array, cost: Array, left: float, before: Array, wanted: Sequence[int], criterion: Criterion
) -> list[int]:
    """Return the places with single measurements replaced by others, as long as that improves the criterion."""
    for _ in range(MAX_EXCHANGE_PASSES):
        improved = False
        for place, one in enumerate(chosen):
            rest = before + information[[*chosen[:place], *chosen[place + 1 :]]].sum(axis=0)
            possible = np.flatnonzero(cost <= (left + cost[one]) * (1.0 + BUDGET_TOLERANCE))
            scores = score(rest + information[possible], wanted, criterion)
            other = int(possible[np.argmin(scores)])
            if scores.min() < score(rest + information[one], wanted, criterion) - MIN_GAIN:
                left += float(cost[one] - cost[other])
                chosen[place], improved = other, True
        if not improved:
            break
    return sorted(chosen)


def covariance_of(information: Array) -> Array:
    """Return the covariance in relative units, shape (p, p); infinite for parameters of which a combination is not known."""
    values, directions = np.linalg.eigh(information)
    dead = undetermined(values)
    root = directions[:, ~dead] / np.sqrt(values[~dead])
    covariance: Array = root @ root.T
    for place in np.flatnonzero((np.abs(directions[:, dead]) > MIN_MOVED).any(axis=1)):
        covariance[place, place] = np.inf
    return covariance
