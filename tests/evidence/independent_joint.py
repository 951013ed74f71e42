"""From measurement files of a joint to a controller that runs in it: `python -m tests.evidence.independent_joint seed=3`.

The joint and its measurement files are those of another program, `independent-rig` (STRAINWAVE_RIG is its folder), which
shares nothing with this package. One command identifies the joint. The controller compensates by the identified drive; it is
written as firmware, compiled, and takes the place of the joint's own. The reference is a cascade with constant feed-forward
whose gains were tuned on this joint. Arguments are those of the rig's `measure.py`.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from numpy.typing import NDArray
from strainwave.export.firmware import FLAGS
from strainwave.tuning.candidates import candidates
from strainwave.tuning.cascade import Plant
from strainwave.tuning.compensate import goal_of
from strainwave.tuning.loops import sharpest

from tests.evidence.rig import RIG, START as START_SET
from tests.python.command import strainwave
from tests.support.cplusplus import compiler

Array = NDArray[np.float64]
FILES = ("friction.csv", "torsion_output.csv", "log_full.csv")
RESISTANCE, TORQUE_CONSTANT = 0.42, 0.0755  # Ohm, N.m/A, of the motor's data sheet
ROTOR = 7.5e-5  # kg.m2: that of the joint's input without the wave generator of the catalogue set
ENCODER_ZERO = np.radians(2971.3)  # of the motor in the log
PERIOD = 5e-4  # s
START = 1.3  # s, from which on the error counts; the command jumps at the beginning
BEFORE_REVERSAL, AFTER_REVERSAL = 0.05, 0.2  # s
CONSTANTS = {"torque_constant": TORQUE_CONSTANT, "motor_inertia": ROTOR, "resistance": RESISTANCE}

LINE = 20.0, 100.0  # rad/s, input speeds through whose friction the line of the constant feed-forward goes

# Tuned on the joint by default, for each encoder of the position loop: gains of the smallest error without the model, of
# 72 tried by `tuned`, and bandwidth of the observer [rad/s]. With the link encoder, gains and bandwidth were tuned together:
# at a position gain of 60, the best without observer (227 µrad), the joint vibrates with it.
GAINS = {"input": (130.0, 0.8, 16.0), "output": (45.0, 0.4, 8.0)}
BANDWIDTH = {"input": 100.0, "output": 50.0}


@dataclass(frozen=True)
class TrackingError:
    """Error of the output angle over a run [rad].

    Attributes:
        rms, largest: over the run
        at_reversals: root mean square around each reversal of the command
        reversals: their number
    """

    rms: float
    largest: float
    at_reversals: float
    reversals: int

    def __str__(self) -> str:
        numbers = (1e6 * each for each in (self.rms, self.largest, self.at_reversals))
        return " ".join(f"{each:10.1f}" for each in numbers)


def measure(folder: Path, words: Sequence[str]) -> None:
    """Let the rig write its measurement files."""
    subprocess.run([sys.executable, RIG / "measure.py", folder, *words], check=True)


def identify(folder: Path) -> sw.Drive:
    """Return the drive that one command identifies from measurement files."""
    constants = [word for name, value in CONSTANTS.items() for word in ("--constant", f"{name}={value}")]
    done = strainwave("identify", START_SET, *FILES, *constants, "--out", "found", folder=folder)
    assert done.returncode == 0, done.stderr
    drive = sw.load(str(folder / "found" / "gear.toml"))
    assert isinstance(drive, sw.Drive)
    return drive


def with_constants(drive: sw.Drive, feedback: str, gains: Sequence[float] = (), **compensation: Any) -> sw.Drive:
    """Return a drive under a cascade with constant feed-forward of friction and of the back-EMF."""
    friction = drive.gear.friction_input
    slow, fast = (0.5 * float(friction.steady(speed) - friction.steady(-speed)) for speed in LINE)
    viscous = (fast - slow) / (LINE[1] - LINE[0])
    volts = RESISTANCE / TORQUE_CONSTANT
    law = _law(feedback, gains).replace(
        viscous_feedforward=volts * viscous, coulomb_feedforward=volts * (slow - LINE[0] * viscous)
    )
    return _controlled(drive, law, **compensation)


def with_model(drive: sw.Drive, feedback: str, gains: Sequence[float] = (), **compensation: Any) -> sw.Drive:
    """Return a drive under the same cascade with the feed-forward of its model."""
    model = sw.compensation.ModelFeedforward(gear=drive.gear, load=drive.load, motor_inertia=drive.motor.inertia)
    return _controlled(drive, _law(feedback, gains), feedforward=model, **compensation)


def observer(drive: sw.Drive, feedback: str) -> sw.compensation.DisturbanceObserver:
    """Return a disturbance observer with the inertia of a drive."""
    inertia = drive.motor.inertia + drive.gear.input_inertia + drive.load.inertia / drive.gear.kinematics.ratio**2
    return sw.compensation.DisturbanceObserver(inertia=inertia, bandwidth=BANDWIDTH[feedback], limit=0.5)


def candidate(drive: sw.Drive, name: str) -> sw.Drive:
    """Return a drive under a candidate of `compensate`, of which the motor takes a voltage."""
    plant = Plant.read(drive, PERIOD, PERIOD)
    settings, goal = [sharpest(plant, "input", 0.0)], goal_of("position", plant, 0.2, None)
    (found,) = (each for each in candidates(plant, settings, goal, {}) if each.name == name)
    sampled: Any = found.drive.control
    law = sampled.law
    gains = law.position_gain, RESISTANCE * law.speed_proportional, RESISTANCE * law.speed_integral
    compensation = {name: getattr(sampled.compensation, name) for name in ("feedforward", "observer")}
    return _controlled(drive, _law("input", gains), **compensation)


def _law(feedback: str, gains: Sequence[float]) -> sw.control.PositionSpeed:
    position, proportional, integral = gains or GAINS[feedback]
    return sw.control.PositionSpeed(
        position_gain=position, speed_proportional=proportional, speed_integral=integral, limit=48.0, speed_feedforward=1.0,
        feedback=feedback,
    )  # fmt: skip


def _controlled(drive: sw.Drive, law: sw.control.PositionSpeed, **compensation: Any) -> sw.Drive:
    """Return the drive with a motor that takes a voltage, under a sampled controller."""
    taken = {"actuation_per_torque": RESISTANCE / TORQUE_CONSTANT, "actuation_per_speed": TORQUE_CONSTANT}
    control = sw.control.Sampled(law=law, period=PERIOD, compensation=sw.Compensation(**taken, **compensation))
    electric = {"resistance": RESISTANCE, "torque_constant": TORQUE_CONSTANT, "back_emf": TORQUE_CONSTANT}
    return drive.replace(control=control, motor=sw.motor.DC(**electric, inertia=drive.motor.inertia))


def run(drive: sw.Drive, folder: Path, words: Sequence[str]) -> TrackingError:
    """Return the error of the joint under the firmware of a drive's controller."""
    sw.export.firmware(drive, folder)
    subprocess.run([*compiler("g++"), *FLAGS.split(), "-c", "controller.cpp"], cwd=folder, check=True)
    call = "if(k%100==0) u=controlled(ref,rd,th,q,(u-Kt*w)/R);"
    joint, changed = re.subn(r"if\(k%100==0\)\{[^}]*\}", call, (RIG / "joint.c").read_text())
    assert changed == 1
    driver = Path(__file__).with_suffix(".c").read_text()
    (folder / "joint.c").write_text(f"#define ZERO {float(ENCODER_ZERO)!r}\n{driver}\n{joint}")
    subprocess.run([*compiler("gcc"), "-O2", "joint.c", "controller.o", "-lm", "-o", "joint"], cwd=folder, check=True)
    printed = subprocess.run([folder / "joint", *words], check=True, capture_output=True, text=True).stdout
    return tracking_error(np.loadtxt(printed.splitlines()))


def tracking_error(rows: Array) -> TrackingError:
    """Return the error of what the joint prints: time, …, link angle, …, command."""
    time, output, command = rows[rows[:, 0] >= START][:, (0, 5, 8)].T
    error = command - output
    turns = time[:-1][np.diff(np.sign(np.gradient(command, time))) != 0.0]
    near = np.any([(time > turn - BEFORE_REVERSAL) & (time < turn + AFTER_REVERSAL) for turn in turns], axis=0)
    rms = [float(np.sqrt(np.mean(each**2))) for each in (error, error[near])]
    return TrackingError(rms[0], float(np.max(np.abs(error))), rms[1], len(turns))


def tuned(drive: sw.Drive, feedback: str, folder: Path, words: Sequence[str]) -> list[tuple[float, tuple[float, ...]]]:
    """Return the errors of the cascade with constant feed-forward for many gains, the smallest first."""
    tried = [
        (p, s, i * s) for p in (20.0, 30.0, 45.0, 60.0, 90.0, 130.0) for s in (0.1, 0.2, 0.4, 0.8) for i in (0.0, 5.0, 20.0)
    ]
    errors = [(run(with_constants(drive, feedback, gains), folder, words).rms, gains) for gains in tried]
    return sorted((error, gains) for error, gains in errors if np.isfinite(error))


def main(words: Sequence[str]) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        measure(folder, words)
        drive = identify(folder)
        own = [word for word in words if not word.startswith("seed=")]
        print(f"{'':58} {'rms':>10} {'largest':>10} {'reversals':>10}  [µrad]")
        for feedback, encoder in (("input", "motor encoder"), ("output", "link encoder")):
            observed = {"observer": observer(drive, feedback)}
            for title, controlled in (
                ("constant feed-forward", with_constants(drive, feedback)),
                ("constant feed-forward, disturbance observer", with_constants(drive, feedback, **observed)),
                ("model", with_model(drive, feedback)),
                ("model, disturbance observer", with_model(drive, feedback, **observed)),
            ):
                print(f"{f'{encoder}: {title}':58} {run(controlled, folder, own)}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
