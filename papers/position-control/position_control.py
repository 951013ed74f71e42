"""The position control article's experiments with full and simplified friction, and where the simplified one stops to suffice.

The article holds that average friction suffices "in precision pulse control where the control angle range is small". Both
models run under the same command and the same controller; their difference is what the simplification costs. The article
describes neither its controller nor its amplitudes, and prints no measurement: those here are assumed, and Table 4 is not
reproduced.

    python papers/position-control/position_control.py [--measured run.csv] [--out FOLDER]
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import inf, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from scipy.optimize import brentq

FULL, SIMPLIFIED = "full", "simplified"
SETS = {FULL: "position-drive-full-friction", SIMPLIFIED: "position-drive"}
COMPARED = ("output_angle", "input_angle", "current")
SETTLING_BAND = 0.02  # share of a change within which a response has settled [1]

REST_ANGLE = 0.05  # rad at the output, 5 rad at the motor: no overshoot leaves the domain of the friction
STEP_AMPLITUDE, SINE_AMPLITUDE = 0.04, 0.03  # rad at the output: as large as the spread of Table 4 allows
SAMPLE_TIME = 1e-3  # s

FIT_ERROR = 0.0052  # N.m: the article, Table 1, root mean square error of the average friction
# The article, Table 4: root mean square error [rad], largest error [rad], correlation coefficient. It compares simulated with
# measured responses, and prints neither its amplitudes nor its measurements.
TABLE_4 = {
    "step": (0.0021, 0.0050, 0.995),
    "sine": (0.0018, 0.0042, 0.997),
    "pulse-train": (0.0015, 0.0038, 0.998),
}

STROKES = (0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0, 65.0, 90.0, 120.0, 160.0, 230.0)  # rad at the motor
PULSES_PER_VOLTAGE = 12  # from the least stroke to the largest
VOLTAGES = (6.0, 12.0, 24.0)  # V, of pulses; above the 2.99 V at which the drive breaks away
USUAL_VOLTAGE = 12.0  # V, of the pulses that are shown
COASTING_DURATION = 2.5  # s: from the end of a pulse until the drive is at rest
SWEEP_STEP = 1e-3  # s: ten times shorter steps change strokes by a few millionths


@dataclass(frozen=True)
class CommandExperiment:
    """One command, run through both models.

    Attributes:
        name: as files are called
        title: what is done, in words
        command: the output angle asked for [rad]
        runs: recording of each model
        tracking: how far the output angle is from the command, for each model
        between: how far the models are apart: output angle, input angle and current
        settling: after each jump of the command, the time until the output angle stays within 2 % of its change around where it
            stops [s], for each model; inf where that takes longer than to the next jump
    """

    name: str
    title: str
    command: sw.scenario.Scenario
    runs: Mapping[str, sw.Run]
    tracking: Mapping[str, sw.analysis.Agreement]
    between: Mapping[str, sw.analysis.Agreement]
    settling: Mapping[str, tuple[float, ...]]


@dataclass(frozen=True)
class MeasuredRun:
    """A measured run, and the models under the same command.

    Attributes:
        recording: time, from 0 on, command and output_angle
        runs: recording of each model
        agreement: how far the simulated output angle is from the measured one, for each model
        beyond: least and greatest motor angle [rad], where the average friction was needed outside of its domain; else None
    """

    recording: sw.Recording
    runs: Mapping[str, sw.Run]
    agreement: Mapping[str, sw.analysis.Agreement]
    beyond: tuple[float, float] | None


@dataclass(frozen=True)
class PositionControl:
    """Results of the study.

    Attributes:
        sets: the set of each model
        experiments: step, sine and pulse train
        under_control: moves of the motor under the controller. Columns: `stroke` [rad]; `output_angle` [rad] and `current` [A],
            root mean square of the difference of full and simplified; the same of the output angle [rad] between other models:
            `without_periodic`, simplified and the full one without its periodic part; `averaged`, full and a constant averaged
            over the stroke; `fit_error`, simplified and a constant that is wrong by the error of the article's fit; `used`,
            the root mean square of the full model's current [A]
        by_pulse: moves by a pulse of each voltage in open loop. Columns: `stroke` [rad] of the simplified model, `width` [s] of
            the pulse, and the strokes [rad] of the others: `full`, `without_periodic`, `averaged`, and `stronger` and `weaker`,
            with a constant that is wrong by the error of the fit
        pulse_suffices_to: for each voltage the stroke [rad] beyond which the full model leaves the range of `stronger` and
            `weaker`; inf if it never does
        measured: a measured run, where one was given
    """

    sets: Mapping[str, sw.GearSet]
    experiments: tuple[CommandExperiment, ...]
    under_control: sw.Recording
    by_pulse: Mapping[float, sw.Recording]
    pulse_suffices_to: Mapping[float, float]
    measured: MeasuredRun | None

    @property
    def law_suffices_to(self) -> float:
        """The motor angle [rad] beyond which the average friction is further from the constant than the error of its fit."""
        return law_limit(self.sets[FULL].drive)

    @property
    def control_suffices_to(self) -> float:
        """The stroke [rad] beyond which the output differs by more than the least error of Table 4; inf if it never does."""
        return sw.analysis.stroke_within(self.under_control, min(rms for rms, _, _ in TABLE_4.values()))

    @property
    def control_within_fit_to(self) -> float:
        """The stroke [rad] beyond which the output differs by more than the error of the fit does; inf if it never does."""
        return sw.analysis.stroke_within(self.under_control, self.under_control["fit_error"])


def position_control(measured: str | Path | None = None) -> PositionControl:
    """Run the study.

    Args:
        measured: a recording of your own with time, command [rad] and output_angle [rad], from rest; a path

    Raises:
        ValueError: the recording cannot be read, or lacks a column
    """
    sets = {model: sw.GearSet.read(name) for model, name in SETS.items()}
    drives = {model: gear_set.drive for model, gear_set in sets.items()}
    command = None if measured is None else sw.analysis.MeasuredCommand.read(measured)
    experiments = tuple(_experiment(name, *each, drives) for name, each in commands().items())
    pulses = {voltage: moves_by_pulse(drives, voltage) for voltage in VOLTAGES}
    limits = {voltage: pulse_limit(drives, voltage, each) for voltage, each in pulses.items()}
    own = None if command is None else _measured(command, drives)
    return PositionControl(sets, experiments, moves_under_control(drives), pulses, limits, own)


# ---- The three experiments -------------------------------------------------------------------------------------------


def commands() -> dict[str, tuple[str, sw.scenario.Scenario]]:
    """Title and command of each experiment; all begin at rest at 0.05 rad of the output."""
    at = f"{1e3 * REST_ANGLE:g} mrad"
    return {
        "step": (
            f"Step of {1e3 * STEP_AMPLITUDE:g} mrad",
            sw.scenario.constant(REST_ANGLE, 2.0) + sw.scenario.step(STEP_AMPLITUDE, 2.0, start=0.1),
        ),
        "sine": (
            f"Sine of 1 Hz, {1e3 * SINE_AMPLITUDE:g} mrad about {at}",
            sw.scenario.sine(SINE_AMPLITUDE, frequency=1.0, duration=3.0, offset=REST_ANGLE),
        ),
        "pulse-train": (
            f"Pulses of {1e3 * STEP_AMPLITUDE:g} mrad, 0.5 s each second",
            sw.scenario.constant(REST_ANGLE, 3.0)
            + sw.scenario.pulse_train(STEP_AMPLITUDE, period=1.0, width=0.5, duration=3.0, start=0.1),
        ),
    }


def _experiment(name: str, title: str, command: sw.scenario.Scenario, drives: Mapping[str, sw.Drive]) -> CommandExperiment:
    runs = {
        model: sw.simulate(drive, command, sample=SAMPLE_TIME, initial={"output_angle": REST_ANGLE})
        for model, drive in drives.items()
    }
    return CommandExperiment(
        name,
        title,
        command,
        runs,
        tracking={model: _tracking(run) for model, run in runs.items()},
        between=_agreement(runs[FULL], runs[SIMPLIFIED], COMPARED),
        settling={model: _settling(run, command) for model, run in runs.items()},
    )


def _tracking(run: sw.Recording) -> sw.analysis.Agreement:
    """Return the agreement of the output angle with its command."""
    asked = sw.Recording({"time": run.time, "output_angle": run["command"]}, {"time": "s", "output_angle": run.unit("command")})
    return sw.compare(asked, run.select(["time", "output_angle"]))[0]


def _agreement(first: sw.Recording, second: sw.Recording, names: tuple[str, ...]) -> dict[str, sw.analysis.Agreement]:
    return {each.name: each for each in sw.compare(first.select(["time", *names]), second)}


def _settling(run: sw.Recording, command: sw.scenario.Scenario) -> tuple[float, ...]:
    """After each jump of the command, until the next."""
    jumps = [*command.breaks.tolist(), command.duration]
    return tuple(sw.analysis.settling_time(run.between(*ends), band=SETTLING_BAND) for ends in pairwise(jumps))


# ---- Strokes ---------------------------------------------------------------------------------------------------------


def moves_under_control(drives: Mapping[str, sw.Drive]) -> sw.Recording:
    """Half a cosine from rest to rest for each stroke [rad at the motor]; columns as of `PositionControl.under_control`."""
    models = _models(drives, STROKES[0])

    def apart(first: str, second: str) -> np.ndarray:
        return sw.analysis.strokes_apart(models[first], models[second], STROKES)["output_angle"]

    full = drives[FULL]
    averaged = [
        sw.analysis.strokes_apart(full, with_coulomb(drives[SIMPLIFIED], average(full, stroke)), [stroke])["output_angle"][0]
        for stroke in STROKES
    ]
    found = sw.analysis.strokes_apart(full, drives[SIMPLIFIED], STROKES)
    found = found.with_column("without_periodic", apart("without_periodic", SIMPLIFIED), "rad")
    found = found.with_column("averaged", np.array(averaged), "rad")
    wrong = np.maximum(apart("stronger", SIMPLIFIED), apart("weaker", SIMPLIFIED))
    names = ["stroke", "output_angle", "without_periodic", "averaged", "fit_error", "current", "used"]
    return found.with_column("fit_error", wrong, "rad").select(names)


def moves_by_pulse(drives: Mapping[str, sw.Drive], voltage: float) -> sw.Recording:
    """One pulse of a voltage [V] in open loop for each of some strokes; columns as `PositionControl.by_pulse` has them."""
    ends = pulse_width(drives[SIMPLIFIED], voltage, STROKES[0]), pulse_width(drives[FULL], voltage, STROKES[-1])
    return _columns(
        [_move_by_pulse(drives, voltage, width) for width in np.geomspace(*ends, PULSES_PER_VOLTAGE)], {"width": "s"}
    )


def _move_by_pulse(drives: Mapping[str, sw.Drive], voltage: float, width: float) -> dict[str, float]:
    stroke = travel(drives[SIMPLIFIED], voltage, width)
    models = _models(drives, stroke)
    return {"stroke": stroke, "width": width} | {
        name: travel(drive, voltage, width) for name, drive in models.items() if name != SIMPLIFIED
    }


def pulse_limit(drives: Mapping[str, sw.Drive], voltage: float, pulses: sw.Recording) -> float:
    """The stroke [rad] beyond which the full model leaves the range that the error of the fit opens; inf if it never does.

    Args:
        pulses: as `moves_by_pulse` gives them, which show between which widths to look
    """
    above = np.flatnonzero(_excess(pulses["full"], pulses["stronger"], pulses["weaker"]) > 0.0)
    if not above.size:
        return inf
    models = _models(drives, STROKES[0])

    def excess(width: float) -> float:
        return float(_excess(*(travel(models[name], voltage, width) for name in (FULL, "stronger", "weaker"))))

    first, last = (float(pulses["width"][place]) for place in (max(above[0] - 1, 0), above[0]))
    width = float(brentq(excess, first, last, rtol=1e-4)) if first < last else first
    return travel(models[SIMPLIFIED], voltage, width)


def _excess(full: Any, stronger: Any, weaker: Any) -> Any:
    """Return the distance of the first from the range of the other two; negative within it."""
    return np.maximum(full - weaker, stronger - full)


def travel(drive: sw.Drive, voltage: float, width: float) -> float:
    """Return the turn of the motor by a pulse in open loop [rad]: `voltage` [V] for `width` [s], then 0 V until it rests."""
    duration = width + COASTING_DURATION
    command = sw.scenario.step(voltage, duration) - sw.scenario.step(voltage, duration, start=width)
    open_loop = drive.replace(control=sw.control.OpenLoop())
    run = sw.simulate(open_loop, command, SWEEP_STEP, sample=0.01, record=["input_angle"])
    if run.end.input_slip_direction != 0.0:
        raise ValueError(f"the drive still turns {COASTING_DURATION:g} s after a pulse of {voltage:g} V for {width:g} s")
    return float(run["input_angle"][-1])


def pulse_width(drive: sw.Drive, voltage: float, stroke: float) -> float:
    """Return the width of a pulse [s] of a voltage [V] that moves the motor by a stroke [rad]."""
    shortest, longest = 1e-3, 1e-2
    while travel(drive, voltage, longest) < stroke:
        shortest, longest = longest, 2.0 * longest
    return float(brentq(lambda width: travel(drive, voltage, width) - stroke, shortest, longest, rtol=1e-4))


def _models(drives: Mapping[str, sw.Drive], stroke: float) -> dict[str, sw.Drive]:
    """The models that a stroke [rad] from angle 0 is run with, all of the simplified drive but for the motor's friction."""
    full, simplified = drives[FULL], drives[SIMPLIFIED]
    law: Any = simplified.gear.friction_input
    return {
        SIMPLIFIED: simplified,
        FULL: full,
        "without_periodic": without_periodic(full),
        "averaged": with_coulomb(simplified, average(full, stroke)),
        "stronger": with_coulomb(simplified, law.coulomb + FIT_ERROR),
        "weaker": with_coulomb(simplified, law.coulomb - FIT_ERROR),
    }


def without_periodic(drive: sw.Drive) -> sw.Drive:
    """The full model with the average part of its friction alone, on both sides."""
    none: dict[str, Any] = {f"gear.friction_{side}.{part}": () for side in ("input", "output") for part in ("cosine", "sine")}
    return drive.replace(none)


def with_coulomb(drive: sw.Drive, coulomb: float) -> sw.Drive:
    """The simplified model with another Coulomb friction of the motor [N.m], and a static friction in proportion."""
    law: Any = drive.gear.friction_input
    breakaway = coulomb * law.breakaway / law.coulomb
    return drive.replace({"gear.friction_input.coulomb": coulomb, "gear.friction_input.breakaway": breakaway})


def average(drive: sw.Drive, stroke: float) -> float:
    """The mean of the full model's average friction over a stroke [rad] from angle 0 [N.m]."""
    law: Any = drive.gear.friction_input
    return float(law.constant + law.linear * stroke / 2.0 + law.quadratic * stroke**2 / 3.0)


def law_limit(drive: sw.Drive) -> float:
    """The least motor angle [rad] at which the average friction is as far from that at angle 0 as the error of its fit."""
    law: Any = drive.gear.friction_input
    root = sqrt(law.linear**2 - 4.0 * law.quadratic * FIT_ERROR)
    return float((-law.linear - root) / (2.0 * law.quadratic))


def _columns(rows: list[dict[str, float]], units: Mapping[str, str]) -> sw.Recording:
    """Return rows as a recording, whose columns are angles [rad] unless `units` names another unit."""
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    return sw.Recording(columns, {name: units.get(name, "rad") for name in columns})


# ---- A measured run --------------------------------------------------------------------------------------------------


def _measured(command: sw.analysis.MeasuredCommand, drives: Mapping[str, sw.Drive]) -> MeasuredRun:
    runs = {model: command.run(drive) for model, drive in drives.items()}
    agreement = {model: command.agreement(drive) for model, drive in drives.items()}
    return MeasuredRun(command.recording, runs, agreement, _beyond(drives[FULL], runs[FULL]["input_angle"]))


def _beyond(drive: sw.Drive, angle: np.ndarray) -> tuple[float, float] | None:
    law: Any = drive.gear.friction_input
    ends = float(angle.min()), float(angle.max())
    return None if law.domain_start <= ends[0] and ends[1] <= law.domain_end else ends


# ---- Files -----------------------------------------------------------------------------------------------------------


def recordings(found: PositionControl) -> dict[str, sw.Recording]:
    """Everything recorded, by the name of its file."""
    runs = {f"{each.name}-{model}": run for each in found.experiments for model, run in each.runs.items()}
    pulses = {f"strokes-by-pulse-{voltage:g}V": each for voltage, each in found.by_pulse.items()}
    measured = {} if found.measured is None else {f"measured-{model}": run for model, run in found.measured.runs.items()}
    return {**runs, **measured, "strokes-under-control": found.under_control, **pulses}


def main() -> None:
    """Run the study, write recordings, figures and page.md into a folder, and print the results."""
    from position_control_page import summary, write_page

    options = ArgumentParser(description=main.__doc__)
    options.add_argument("--measured", type=Path, help="a run of your own drive: time, command and output_angle, with units")
    options.add_argument("--out", type=Path, default=Path("out/position-control"), help="folder of the results")
    given = options.parse_args()
    found = position_control(given.measured)
    given.out.mkdir(parents=True, exist_ok=True)
    for name, run in recordings(found).items():
        run.to_parquet(given.out / f"{name}.parquet")
    write_page(found, given.out)
    print(summary(found))
    print(f"wrote {given.out / 'page.md'} and {len(recordings(found))} recordings beside it")


if __name__ == "__main__":
    main()
