"""Measurements that could be made of a gear or a drive, within its limits, and what each would tell."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import Drive, Gear
from strainwave.analysis.branches import slid
from strainwave.files.recording import Recording
from strainwave.identification.excitation.design import without_nuisances
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.experiments.experiment import Experiment
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.parameters import every
from strainwave.simulation.run import simulate
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.signals import outputs

Array = NDArray[np.float64]
SPEEDS = 40  # of a friction table, from the lowest to the highest
AMPLITUDES = 12  # of a torsion loop
SMALLEST_LOOP = 0.02  # of the torque limit
LOOP_SAMPLES = 200
SHARES = (1.0, 0.5, 0.25, 0.1)  # of a command
USUAL = ("input_angle", "current")  # columns of a log that nearly every drive records
RELATIVE_NOISE = 0.01  # of the largest value of a channel, where no noise is given (assumed)


Noise = Mapping[str, float]
"""Standard deviation of what is measured: "friction" of the mean torque at one speed, at the input [N.m]; of one sample of a
loop "torsion" at the output and "input_torsion" at the input [N.m]; of one sample of a column of a log, by its name."""


@dataclass(frozen=True)
class Limits:
    """How fast and how hard a gear may be driven; infinite where there is no limit.

    Args:
        speed: of the input [rad/s]
        torque: at the output [N.m]
        lowest_speed: of the input that can be held steady [rad/s]
    """

    speed: float
    torque: float
    lowest_speed: float


@dataclass(frozen=True, eq=False)
class Candidate:
    """One measurement that could be made.

    Attributes:
        kind: friction, torsion or motion
        settings: how it is made, with units in the names
        words: the same in words
        duration: what it takes [s]
        information: about the unknown parameters, in their units, shape (p, p)
    """

    kind: str
    settings: Mapping[str, float | str]
    words: str
    duration: float
    information: Array


def friction(gear: Gear, paths: Sequence[str], limits: Limits, noise: Noise, duration: float) -> Iterator[Candidate]:
    """Friction torques at the input at constant speeds, each both ways."""
    one_way = np.geomspace(limits.lowest_speed, limits.speed, SPEEDS)
    speed = np.concatenate((one_way, -one_way))
    torque, slopes = _predicted(FrictionTable(speed, speed), gear, paths)
    sigma = _sigma(noise, "friction", float(np.abs(torque).max()))
    for row, each in enumerate(one_way.tolist()):
        rows = slopes[:, 0, [row, row + SPEEDS]].T / sigma
        words = f"friction torque at ± {each:.4g} rad/s of the input ({each * 30.0 / pi:.4g} rpm)"
        yield Candidate("friction", {"input_speed_rad_s": each}, words, 2.0 * duration, rows.T @ rows)


def torsion(gear: Gear, paths: Sequence[str], limits: Limits, noise: Noise, duration: float) -> Iterator[Candidate]:
    """Torsion loops up to several torques, at the output with the input held, and at the input with the output held."""
    ratio = float(gear.kinematics.ratio)
    for amplitude in np.geomspace(SMALLEST_LOOP * limits.torque, limits.torque, AMPLITUDES).tolist():
        largest = float(np.max(gear.twist([0.0, amplitude])))
        for side, at in (("output", None), ("input", ratio)):
            loop = _loop(gear, largest, at)
            _, slopes = _predicted(loop, gear, paths)
            rows, known = (slopes[:, 0] / _loop_sigma(noise, at, limits)).T, len(paths)
            information = without_nuisances(rows[:, :known], rows[:, known:])
            held = "input" if at is None else "output"
            turn = largest if at is None else abs(ratio) * largest
            words = (
                f"torsion loop at the {side}, {held} held, to ± {amplitude:.4g} N.m at the output, which turns the {side} by "
                f"± {turn:.3g} rad"
            )
            settings: dict[str, float | str] = {"torque_N_m": amplitude, "measured_at": side, "held": held}
            yield Candidate("torsion", settings, words, duration, information)


def _loop_sigma(noise: Noise, ratio: float | None, limits: Limits) -> float:
    """Noise of the torque of a loop, referred to the output [N.m]."""
    scale, name = (1.0, "torsion") if ratio is None else (abs(ratio), "input_torsion")
    return scale * _sigma(noise, name, limits.torque / scale)


def _loop(gear: Gear, largest: float, ratio: float | None) -> TorsionLoop:
    quarter = LOOP_SAMPLES // 4
    twist = largest * np.interp(np.arange(LOOP_SAMPLES), [0, quarter, 3 * quarter, LOOP_SAMPLES - 1], [0.0, 1.0, -1.0, 0.0])
    if ratio is not None:
        twist = twist[slid(twist)]
    return TorsionLoop(twist, gear.trace(np.concatenate(([0.0], twist)))[1:], near_zero=0.0, input_ratio=ratio)


def motion(
    drive: Drive, paths: Sequence[str], limits: Limits, noise: Noise, commands: Mapping[str, Scenario], sample: float
) -> Iterator[Candidate]:
    """Runs of a drive from rest under commands, and under shares of them; those that keep the limits."""
    known = outputs(drive)
    channels = [name for name in noise if name in known] or [name for name in USUAL if name in known]
    tried = [(name, share, command * share) for name, command in commands.items() for share in SHARES]
    runs = [(*each, simulate(drive, each[-1], sample=sample)) for each in tried]
    kept = [each for each in runs if _kept(each[-1], limits)]
    if not kept:
        return
    sigmas = [_sigma(noise, each, max(float(np.ptp(run[each])) for *_, run in kept)) for each in channels]
    for name, share, command, run in kept:
        experiment = DriveLog.of(run.select(["time", "command", *channels]), drive, channels)
        _, slopes = _predicted(experiment, drive, paths)
        rows = np.concatenate([slopes[:, row] / sigma for row, sigma in enumerate(sigmas)], axis=1).T
        information = without_nuisances(rows[:, : len(paths)], rows[:, len(paths) :])
        words = f"run of {command.duration:.3g} s under {share:g} times the command {name}"
        yield Candidate("motion", {"command": name, "share": share}, words, command.duration, information)


def _sigma(noise: Noise, name: str, largest: float) -> float:
    """The noise that is given, or a share of the largest value."""
    if name in noise:
        return noise[name]
    if not largest > 0.0:
        raise ValueError(
            f"the model predicts zero for {name}, of which no share can be taken as noise; give the noise of {name}"
        )
    return RELATIVE_NOISE * largest


def _kept(run: Recording, limits: Limits) -> bool:
    """Whether a run keeps the limits of speed and torque."""
    reached = {name: float(np.abs(run[name]).max()) for name in ("input_speed", "torque")}
    return reached["input_speed"] <= limits.speed and reached["torque"] <= limits.torque


def _predicted(experiment: Experiment, model: Any, paths: Sequence[str]) -> tuple[Array, Array]:
    """What a model predicts, and derivatives by the parameters, then by the nuisances; zero by what it does not have."""
    places = {path: each.number for path, each in every(model).items()}
    present = [row for row, path in enumerate(paths) if path in places]
    start = np.array([each.start for each in experiment.nuisances])
    predicted, found = experiment.predict(model, [places[paths[row]] for row in present], start)
    slopes = np.zeros((len(paths) + len(start), *predicted.shape))
    slopes[present] = found[: len(present)]
    slopes[len(paths) :] = found[len(present) :]
    return predicted, slopes
