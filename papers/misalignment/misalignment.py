"""An actuator turns through its stroke at constant speed, with and without a misaligned wave generator: the actuator paper.

The paper shows what eccentricities and angular deviations do to torque and current, and prints no number. Here its ramp is run
over levels of each, for each way in which the lobes may share, with the position loop closed on either shaft, and over ramp
times and gains. Its claims are then put to the numbers.

    python papers/misalignment/misalignment.py [--drive DRIVE] [--stroke DEGREES] [--time SECONDS] [--out FOLDER]
        [--measured ramp.csv] [--measured-error curve.csv]
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from pure_error import PureError, pure_error
from strainwave.diagnose import COMBINE, LOOPS, SWEEPS, ActuatorRamp, SweepLevels, swing

STROKE_ANGLE = np.pi / 2.0  # rad: the paper states "the maximum stroke" without its size
STROKE_DURATION = 5.0  # s: the paper
DRIVE = "tilt-actuator"

USUAL = "max"  # how the lobes share where one way is shown: the one with which order 2, that is observed, is of first order
M_PER_MICRON = 1e-6  # m
SHOWN_TILT = np.radians(0.2)
USUAL_E1 = 20e-6  # m: e_1 at which ramp times and gains are varied
INPUT, OUTPUT = "input", "output"
ERROR = "gear.kinematic_error"  # place in the drive
CHANNELS = ("torque", "current", "output_angle", "input_angle")
SHOWN_TILTS = SWEEPS["beta"][1][:3]
SILENT = ("e2", "alpha")  # sweeps of what stands on the shaft alone
MAX_ORDER = 10.0  # of the spectra
WHOLE_ORDER_TOLERANCE = 0.15  # orders: the distance from a whole order within which an order belongs to it
MIN_ORDER = 0.5  # below it lies the order of the load over the stroke

TIMES = (0.5, 1.0, 2.0)  # ramp times over that of the study
GAINS = (0.5, 1.0, 2.0, 4.0)  # gains of the position loop over that of the drive

# What is recovered: e_1 at beta_1, and a tilt. Noise of what is measured, assumed.
INJECTED = {
    "housing_eccentricity": 15e-6,
    "housing_direction": 0.6,
    "housing_tilt_x": np.radians(0.05),
    "housing_tilt_y": np.radians(0.03),
}
MIN_ROWS = 2  # of a measured ramp
RECORDS = {"transmission_error": 2e-5, "current": 0.02}  # root mean square of the noise: two encoders [rad], current sensor [A]
NOISE_TRIALS = 12  # records with different noise from which the misalignment is recovered


@dataclass(frozen=True)
class Passing:
    """Share of the error that reaches the output, over ramp times and gains, for one loop.

    Attributes:
        loop: where the position loop closes
        table: columns `duration` [s], `position_gain` [1/s], `order`, `frequency` of that order [Hz], `share` of the error at
            the order that the output has [1], `torque_swing` [N.m], `current_swing` [A]
    """

    loop: str
    table: sw.Recording


@dataclass(frozen=True)
class Recovery:
    """A simulated misalignment, and its estimates from records.

    Attributes:
        column: of the record
        noise: root mean square of the noise in it
        law: the simulated misalignment
        first: estimates from the first record, by assumed `combine`
        trials: estimates from records with other noises, with the right `combine`
    """

    column: str
    noise: float
    law: Any
    first: Mapping[str, sw.diagnose.MisalignmentEstimate]
    trials: tuple[sw.diagnose.MisalignmentEstimate, ...]

    @property
    def m(self) -> tuple[float, float]:
        """True values of the parameters that a record determines [m]."""
        x, y = self.law.eccentricity
        return float(x), float(y)

    @property
    def best(self) -> sw.diagnose.MisalignmentEstimate:
        """Return the refined estimate from the first record."""
        return self.trials[0]

    @property
    def within(self) -> int:
        """Return the count of trials whose ellipse of 95 % contains the true value."""
        return sum(trial.contains(self.m) for trial in self.trials)


@dataclass(frozen=True)
class MisalignmentStudy:
    """Results of the study.

    Attributes:
        gear_set: the drive with its sources
        ramp: of the drive, with the loop closed on the output
        law: the wave generator, straight
        assumed_geometry: whether its dimensions are assumed, as the drive has none
        shown: runs by loop and tilt [rad], 0 the straight one, with `combine` max
        series: the same ramp with the stages of the gear in series, with which all but the shown runs are made; else the ramp
        shown_in_series: the shown runs with the loop on the output, made with it
        levels: by `combine` and loop
        passing: by loop
        spectra: orders of torque, current and output angle by channel, for the straight and the shown run
        pure: Figure 3.a
        recoveries: misalignments and their estimates
        measured: a recording of a ramp, where one was given
    """

    gear_set: sw.GearSet
    ramp: ActuatorRamp
    law: Any
    assumed_geometry: bool
    shown: Mapping[str, Mapping[float, sw.Recording]]
    series: ActuatorRamp
    shown_in_series: Mapping[float, sw.Recording]
    levels: Mapping[tuple[str, str], SweepLevels]
    passing: Mapping[str, Passing]
    spectra: Mapping[str, tuple[sw.Recording, sw.Recording]]
    pure: PureError
    recoveries: tuple[Recovery, ...]
    measured: sw.Recording | None

    @property
    def straight(self) -> sw.Recording:
        """The run without misalignment, its loop closed on the output."""
        return self.shown[OUTPUT][0.0]

    @property
    def staged(self) -> bool:
        """True if the gear has stages that are in series for all but the shown runs."""
        return self.series is not self.ramp

    def off_in_series(self, name: str) -> float:
        """Return the relative difference of a column's swing, stages in series against the ramp's gear, at the shown tilt."""
        swings = [
            swing(difference(self.ramp, runs, SHOWN_TILT, name)[name]) for runs in (self.shown[OUTPUT], self.shown_in_series)
        ]
        return swings[1] / swings[0] - 1.0

    def per_error(self) -> float:
        """Kinematic error at the output per radial displacement [rad/m]."""
        return float(np.tan(self.law.pressure_angle) / self.law.pitch_radius)


def misalignment(
    drive: str | Path = DRIVE,
    stroke: float = STROKE_ANGLE,
    duration: float = STROKE_DURATION,
    measured: str | Path | None = None,
    measured_error: str | Path | None = None,
) -> MisalignmentStudy:
    """Run the study.

    Args:
        drive: name or path of a set whose controller is a position loop around a speed loop
        stroke: of the output [rad]
        duration: of the ramp [s]
        measured: a recording of a ramp: time, and some of torque, current, output_angle and input_angle
        measured_error: a curve of the pure kinematic error: input_angle and kinematic_error, over a turn

    Raises:
        ValueError: a file cannot be read, the drive has no motor and controller, or no loop that closes on both sides, or the
            ramp is less than three turns of the input
    """
    gear_set = sw.GearSet.read(drive)
    ramp = ActuatorRamp.of(gear_set.drive, stroke, duration).closed_on(OUTPUT)
    law, assumed = sw.diagnose.wave_generator(ramp.drive)
    own = None if measured is None else recording_of_ramp(Path(measured))
    pure = pure_error(measured_error, law)
    shown = {side: _shown(ramp.closed_on(side), law) for side in LOOPS}
    series = sw.diagnose.in_series(ramp)
    sw.compile(series.drive, ["simulate_many"])  # some 200 runs of it follow
    shown_in_series = shown[OUTPUT] if series is ramp else _shown(series, law)
    levels = {
        (combine, side): sw.diagnose.sweep_misalignment(series.closed_on(side), law.replace(combine=combine))
        for combine, side in product(COMBINE, LOOPS)
    }
    passing = {side: passed(series.closed_on(side), law) for side in LOOPS}
    recoveries = tuple(recovered(series, law))
    spectra = {name: _spectra(ramp, shown[OUTPUT], name) for name in ("torque", "current", "output_angle")}
    return MisalignmentStudy(
        gear_set, ramp, law, assumed, shown, series, shown_in_series, levels, passing, spectra, pure, recoveries, own
    )


# ---- The ramp with and without misalignment --------------------------------------------------------------------------


def _shown(ramp: ActuatorRamp, law: Any) -> dict[float, sw.Recording]:
    """The straight run and those of three tilts."""
    tilts = (0.0, *SHOWN_TILTS)
    changes = [{f"{ERROR}.housing_tilt_x": tilt} for tilt in tilts]
    runs = ramp.with_error(law.replace(combine=USUAL)).many(changes)
    return {tilt: runs.member(place) for place, tilt in enumerate(tilts)}


def difference(ramp: ActuatorRamp, runs: Mapping[float, sw.Recording], tilt: float, name: str) -> sw.Recording:
    """A column with a tilt less that without, over time and input angle, after the run-in."""
    run, straight = (ramp.settled(runs[each]) for each in (tilt, 0.0))
    columns = {"time": run.time, "input_angle": run["input_angle"], name: run[name] - straight[name]}
    return sw.Recording(columns, {each: run.unit(each) for each in columns})


def _spectra(ramp: ActuatorRamp, runs: Mapping[float, sw.Recording], name: str) -> tuple[sw.Recording, sw.Recording]:
    """Orders of a column without and with the tilt that is shown; of the output angle, those of its error."""
    found = []
    for tilt in (0.0, SHOWN_TILT):
        run = ramp.settled(runs[tilt])
        values = run["output_angle"] - run["command"] if name == "output_angle" else run[name]
        columns = {"input_angle": run["input_angle"], name: values}
        found.append(
            sw.orders.order_spectrum(sw.Recording(columns, {each: run.unit(each) for each in columns}), name, MAX_ORDER)
        )
    return found[0], found[1]


def share_of_whole_orders(ramp: ActuatorRamp, runs: Mapping[float, sw.Recording], name: str) -> float:
    """Return the share of a difference's power at whole orders, or so close that the load over the stroke explains it [1]."""
    spectrum = sw.orders.order_spectrum(difference(ramp, runs, SHOWN_TILT, name), name, MAX_ORDER)
    order, power = spectrum["order"], spectrum["amplitude"] ** 2
    counted = order > MIN_ORDER
    near = np.abs(order - np.round(order)) <= WHOLE_ORDER_TOLERANCE
    return float(power[counted & near].sum() / power[counted].sum())


# ---- Levels ----------------------------------------------------------------------------------------------------------


def power_of_level(levels: SweepLevels, sweep: str, name: str) -> float:
    """The exponent with which a column grows with the level, by least squares of the logarithms."""
    level = levels.column(sweep, SWEEPS[sweep][0])
    return float(np.polyfit(np.log(level), np.log(levels.column(sweep, name)), 1)[0])


# ---- Ramp times and gains --------------------------------------------------------------------------------------------


def passed(ramp: ActuatorRamp, law: Any) -> Passing:
    """The share of the error that the output has at orders 2 and 4, over ramp times and gains."""
    misaligned = law.replace(combine=USUAL, housing_eccentricity=USUAL_E1)
    rows = []
    for times in TIMES:
        lasting = ramp.without_noise().lasting(times * ramp.duration).with_error(misaligned)
        gains = [factor * ramp.gain for factor in GAINS]
        changes = [
            {ramp.gain_path: gain, f"{ERROR}.housing_eccentricity": eccentricity}
            for gain in gains
            for eccentricity in (0.0, USUAL_E1)
        ]
        runs = lasting.many(changes, record=[*CHANNELS, "kinematic_error"])
        for place, gain in enumerate(gains):
            rows += list(_passed(lasting, runs, place, gain))
    units = {"duration": "s", "position_gain": "1/s", "order": "1", "frequency": "Hz", "share": "1"}
    units |= {"torque_swing": "N.m", "current_swing": "A"}
    return Passing(ramp.loop, sw.Recording({name: [row[name] for row in rows] for name in units}, units))


def _passed(ramp: ActuatorRamp, runs: sw.Ensemble, place: int, gain: float) -> Iterator[dict[str, float]]:
    straight, run = (ramp.settled(runs.member(2 * place + each)) for each in (0, 1))
    columns = {
        "input_angle": run["input_angle"],
        "error": run["kinematic_error"],
        "output": run["output_angle"] - straight["output_angle"],
    }
    turning = sw.Recording(columns, dict.fromkeys(columns, "rad"))
    asked = (2.0, 4.0)
    error, output = (sw.orders.order_amplitudes(turning, name, asked).amplitude for name in ("error", "output"))
    for order, there, put_in in zip(asked, output, error, strict=True):
        yield {
            "duration": ramp.duration,
            "position_gain": gain,
            "order": order,
            "frequency": order * ramp.turning / (2.0 * np.pi),
            "share": float(there / put_in),
            "torque_swing": swing(run["torque"] - straight["torque"]),
            "current_swing": swing(run["current"] - straight["current"]),
        }


def share_by_ideal_loop(frequency: Any, gain: float) -> Any:
    """The share of an error at a frequency [Hz] that reaches the output past a loop of a gain [1/s] around an ideal speed loop.

    The loop makes the input follow -gain times the error of the output: s / (s + gain) of the error is left.
    """
    turning = 2.0 * np.pi * np.asarray(frequency)
    return turning / np.hypot(turning, gain)


# ---- Recovery --------------------------------------------------------------------------------------------------------


def recovered(ramp: ActuatorRamp, law: Any) -> Iterator[Recovery]:
    """Put a misalignment in, and look for it in what can be measured."""
    model = sw.diagnose.RecoveryModel.of(ramp)
    for combine in ("max", "single"):
        straight = law.replace(combine=combine)
        injected = straight.replace(**INJECTED)
        records = _records(ramp.with_error(injected))
        measured = {column: [_noisy(each, column, trial) for trial, each in enumerate(records)] for column in RECORDS}
        first = {column: sw.diagnose.recover(seen[0], column, model, straight) for column, seen in measured.items()}
        best = sw.diagnose.refined(
            [each[combine] for each in first.values()], [seen[0] for seen in measured.values()], model, straight
        )
        runs = model.run([each.m for each in best], straight)
        for (column, seen), each, run in zip(measured.items(), best, runs, strict=True):
            trials = tuple(sw.diagnose.corrected(each, record, run, model, straight) for record in seen)
            yield Recovery(column, RECORDS[column], injected, first[column], trials)


def _records(ramp: ActuatorRamp) -> list[sw.Recording]:
    """Return runs of the drive, each with other noises of the sensors in its loops."""
    seeds = ramp.seeds
    if not seeds:
        run = ramp.settled(ramp.run())
        return [run] * NOISE_TRIALS
    changes = [
        {path: float(1 + trial * len(seeds) + place) for place, path in enumerate(seeds)} for trial in range(NOISE_TRIALS)
    ]
    runs = ramp.many(changes, record=["input_angle", *RECORDS])
    return [ramp.settled(runs.member(trial)) for trial in range(NOISE_TRIALS)]


def _noisy(recording: sw.Recording, column: str, trial: int) -> sw.Recording:
    """A column as a sensor would show it."""
    seen = recording[column] + RECORDS[column] * np.random.default_rng(trial).standard_normal(len(recording))
    columns = {"input_angle": recording["input_angle"], column: seen}
    return sw.Recording(columns, {name: recording.unit(name) for name in columns})


# ---- A measured ramp -------------------------------------------------------------------------------------------------


def recording_of_ramp(path: Path) -> sw.Recording:
    """Time, from 0 on, and those of the channels that a file has."""
    there = [name for name in CHANNELS if name in sw.Recording.header(path)]
    if not there:
        raise ValueError(f"{path} has none of the columns {', '.join(CHANNELS)}; a ramp has time and one of them or more")
    found = sw.Recording.read(path, columns={name: name for name in ("time", *there)})
    if len(found) < MIN_ROWS:
        raise ValueError(f"{path} has {len(found)} rows; a ramp needs {MIN_ROWS} or more")
    units = {"torque": "N.m", "current": "A"}
    try:
        columns = {"time": found.values("time", "s") - found.values("time", "s")[0]}
        columns |= {name: found.values(name, units.get(name, "rad")) for name in there}
    except ValueError as error:
        raise ValueError(f"{path} {error}; give the column in that unit, or in one of its multiples") from None
    return sw.Recording(columns, {"time": "s"} | {name: units.get(name, "rad") for name in there}, title=path.name)


# ---- Files -----------------------------------------------------------------------------------------------------------


def recordings(found: MisalignmentStudy) -> dict[str, sw.Recording]:
    """Everything recorded, by the name of its file."""
    runs = {
        f"ramp-{side}-tilt-{np.degrees(tilt):g}deg": run
        for side, of_side in found.shown.items()
        for tilt, run in of_side.items()
    }
    return {**runs, **{f"order-spectrum-{name}": pair[1] for name, pair in found.spectra.items()}}


def tables(found: MisalignmentStudy) -> dict[str, sw.Recording]:
    """The tables, by the name of their files."""
    levels = {f"levels-{combine}-{side}": each.table for (combine, side), each in found.levels.items()}
    return levels | {f"ramp-times-and-gains-{side}": each.table for side, each in found.passing.items()}


def main() -> None:
    """Run the study, write recordings, tables, figures and page.md into a folder, and print the results."""
    from misalignment_page import summary, write_page

    options = ArgumentParser(description=main.__doc__)
    options.add_argument("--drive", default=DRIVE, help="a set by name, or a .toml file; its controller a cascade")
    options.add_argument("--stroke", type=float, default=np.degrees(STROKE_ANGLE), help="of the output in degrees")
    options.add_argument("--time", type=float, default=STROKE_DURATION, help="of the ramp through the stroke in s")
    options.add_argument("--measured", type=Path, help="a ramp of your own drive: time, and torque, current or an angle")
    options.add_argument("--measured-error", type=Path, help="a measured curve: input_angle and kinematic_error over a turn")
    options.add_argument("--out", type=Path, default=Path("out/misalignment"), help="folder of the results")
    given = options.parse_args()
    found = misalignment(given.drive, np.radians(given.stroke), given.time, given.measured, given.measured_error)
    given.out.mkdir(parents=True, exist_ok=True)
    for name, run in recordings(found).items():
        run.to_parquet(given.out / f"{name}.parquet")
    for name, table in tables(found).items():
        table.to_csv(given.out / f"{name}.csv")
    write_page(found, given.out)
    print(summary(found))
    print(f"wrote {given.out / 'page.md'}, {len(recordings(found))} recordings and {len(tables(found))} tables beside it")


if __name__ == "__main__":
    main()
