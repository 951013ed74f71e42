"""Document A's study: an actuator turns through its stroke at constant speed, with and without a misaligned wave generator.

Document A shows what eccentricities and angular deviations do to torque and current, and prints no number. Here its ramp is run
over levels of each, for each way in which the lobes may share, with the position loop closed on either shaft, and over ramp
times and gains. Its claims are then put to the numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.diagnose.actuator_ramp import CHANNELS, ERROR, LOOPS, OUTPUT, ActuatorRamp, geometry, in_series, noises
from strainwave.diagnose.inversion import COMBINE, MisalignmentEstimate
from strainwave.files.gear_set import GearSet
from strainwave.files.recording import Recording
from strainwave.messages import listed
from strainwave.native import kernels
from strainwave.orders.order_spectrum import order_amplitudes, order_spectrum
from strainwave.simulation.ensemble import Ensemble
from strainwave.simulation.signals import outputs
from strainwave.studies.pure_error import PureError, pure_error
from strainwave.studies.recovery import RecoveryModel, corrected, recover, refined

Array = NDArray[np.float64]

STROKE_ANGLE = np.pi / 2.0  # rad: document A states "the maximum stroke" without its size
STROKE_DURATION = 5.0  # s: document A
DRIVE = "tilt-actuator"

USUAL = "max"  # how the lobes share where one way is shown: the one with which order 2, that is observed, is of first order
M_PER_MICRON, RAD_PER_DEGREE = 1e-6, np.pi / 180.0
SHOWN_TILT = 0.2 * RAD_PER_DEGREE
USUAL_E1 = 20e-6  # m: e_1 of the sweep of the generator's own misalignment
# The sweeps: the varied parameter, its levels, and the other parameters that differ from zero; SI.
SWEEPS: dict[str, tuple[str, tuple[float, ...], dict[str, float]]] = {
    "e1": ("housing_eccentricity", (10e-6, 20e-6, 40e-6, 80e-6), {}),
    "beta": ("housing_tilt_x", tuple(RAD_PER_DEGREE * level for level in (0.1, 0.2, 0.4, 0.8)), {}),
    "h": ("offset", (0.0, 2e-3, 8e-3), {"housing_tilt_x": SHOWN_TILT}),
    "e2": ("generator_eccentricity", (10e-6, 20e-6, 40e-6, 80e-6), {}),
    "alpha": ("generator_tilt_x", tuple(RAD_PER_DEGREE * level for level in (0.1, 0.2, 0.4, 0.8)), {}),
    "e2 with e1": ("generator_eccentricity", (5e-6, 10e-6, 20e-6, 40e-6), {"housing_eccentricity": USUAL_E1}),
}
SHOWN_TILTS = SWEEPS["beta"][1][:3]
BOTH_LOOPS = ("e1", "beta")  # sweeps that are run with the loop on the motor encoder, too
SILENT = ("e2", "alpha")  # sweeps of what stands on the shaft alone
SEEN_ORDERS = (1.0, 2.0, 4.0)
MAX_ORDER = 10.0  # of the spectra
WHOLE_ORDER_TOLERANCE = 0.15  # orders: the distance from a whole order within which an order belongs to it
MIN_ORDER = 0.5  # below it lies the order of the load over the stroke

TIMES = (0.5, 1.0, 2.0)  # ramp times over that of the study
GAINS = (0.5, 1.0, 2.0, 4.0)  # gains of the position loop over that of the drive

# What is recovered: e_1 at beta_1, and a tilt. Noise of what is measured, assumed.
INJECTED = {
    "housing_eccentricity": 15e-6,
    "housing_direction": 0.6,
    "housing_tilt_x": 0.05 * RAD_PER_DEGREE,
    "housing_tilt_y": 0.03 * RAD_PER_DEGREE,
}
MIN_ROWS = 2  # of a measured ramp
RECORDS = {"transmission_error": 2e-5, "current": 0.02}  # root mean square of the noise: two encoders [rad], current sensor [A]
SERIES_RUNS = 200  # about, of the drive with its gear in series: as many determine whether a kernel is compiled first
NOISE_TRIALS = 12  # records with different noise from which the misalignment is recovered


@dataclass(frozen=True)
class SweepLevels:
    """Ramps over the levels of all sweeps, for one `combine` and one loop.

    Attributes:
        combine: how the lobes share
        loop: "output" or "input", where the position loop closes
        table: a row for each run, the first one straight. Columns: the numbers changed; half of the swing of the kinematic
            error (`error_swing`), and of the differences from the straight run (`torque_swing`, `current_swing`,
            `output_swing`); largest absolute value over that of the straight run (`torque_peak`, `current_peak`); the orders
            1, 2, 4 of the error and of the differences (`error_1`, …, `current_4`)
        rows: of each sweep
    """

    combine: str
    loop: str
    table: Recording
    rows: Mapping[str, slice]

    def column(self, sweep: str, name: str) -> Array:
        """A column of the table at the levels of a sweep."""
        return self.table[name][self.rows[sweep]]


@dataclass(frozen=True)
class Passing:
    """Share of the error that reaches the output, over ramp times and gains, for one loop.

    Attributes:
        loop: where the position loop closes
        table: columns `duration` [s], `position_gain` [1/s], `order`, `frequency` of that order [Hz], `share` of the error at
            the order that the output has [1], `torque_swing` [N.m], `current_swing` [A]
    """

    loop: str
    table: Recording


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
    first: Mapping[str, MisalignmentEstimate]
    trials: tuple[MisalignmentEstimate, ...]

    @property
    def m(self) -> tuple[float, float]:
        """True values of the parameters that a record determines [m]."""
        x, y = self.law.eccentricity
        return float(x), float(y)

    @property
    def best(self) -> MisalignmentEstimate:
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

    gear_set: GearSet
    ramp: ActuatorRamp
    law: Any
    assumed_geometry: bool
    shown: Mapping[str, Mapping[float, Recording]]
    series: ActuatorRamp
    shown_in_series: Mapping[float, Recording]
    levels: Mapping[tuple[str, str], SweepLevels]
    passing: Mapping[str, Passing]
    spectra: Mapping[str, tuple[Recording, Recording]]
    pure: PureError
    recoveries: tuple[Recovery, ...]
    measured: Recording | None

    @property
    def straight(self) -> Recording:
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
    progress: Callable[[str], None] = lambda stage: None,
) -> MisalignmentStudy:
    """Run the study.

    Args:
        drive: name or path of a set whose controller is a position loop around a speed loop
        stroke: of the output [rad]
        duration: of the ramp [s]
        measured: a recording of a ramp: time, and some of torque, current, output_angle and input_angle
        measured_error: a curve of the pure kinematic error: input_angle and kinematic_error, over a turn
        progress: is called with the name of each stage

    Raises:
        ValueError: a file cannot be read, the drive has no motor and controller, or no loop that closes on both sides, or the
            ramp is less than three turns of the input
    """
    gear_set = GearSet.read(drive)
    ramp = ActuatorRamp.of(gear_set.drive, stroke, duration).closed_on(OUTPUT)
    law, assumed = geometry(ramp.drive)
    own = None if measured is None else recording_of_ramp(Path(measured))
    progress("pure kinematic error")
    pure = pure_error(measured_error, law)
    progress("ramp with and without misalignment")
    shown = {side: _shown(ramp.closed_on(side), law) for side in LOOPS}
    series = in_series(ramp)
    kernels.prepare(series.drive, "simulate_many", SERIES_RUNS * duration / series.dt)
    shown_in_series = shown[OUTPUT] if series is ramp else _shown(series, law)
    levels = {}
    for combine, side in product(COMBINE, LOOPS):
        progress(f"levels, {combine}, loop on the {LOOPS[side]}")
        levels[combine, side] = swept(series.closed_on(side), law.replace(combine=combine))
    passing = {}
    for side in LOOPS:
        progress(f"ramp times and gains, loop on the {LOOPS[side]}")
        passing[side] = passed(series.closed_on(side), law)
    progress("recovery of a misalignment")
    recoveries = tuple(recovered(series, law))
    spectra = {name: _spectra(ramp, shown[OUTPUT], name) for name in ("torque", "current", "output_angle")}
    return MisalignmentStudy(
        gear_set, ramp, law, assumed, shown, series, shown_in_series, levels, passing, spectra, pure, recoveries, own
    )


# ---- The ramp with and without misalignment --------------------------------------------------------------------------


def _shown(ramp: ActuatorRamp, law: Any) -> dict[float, Recording]:
    """The straight run and those of three tilts."""
    tilts = (0.0, *SHOWN_TILTS)
    changes = [{f"{ERROR}.housing_tilt_x": tilt} for tilt in tilts]
    runs = ramp.with_error(law.replace(combine=USUAL)).many(changes, list(outputs(ramp.drive)))
    return {tilt: runs.member(place) for place, tilt in enumerate(tilts)}


def difference(ramp: ActuatorRamp, runs: Mapping[float, Recording], tilt: float, name: str) -> Recording:
    """A column with a tilt less that without, over time and input angle, after the run-in."""
    run, straight = (ramp.settled(runs[each]) for each in (tilt, 0.0))
    columns = {"time": run.time, "input_angle": run["input_angle"], name: run[name] - straight[name]}
    return Recording(columns, {each: run.unit(each) for each in columns})


def _spectra(ramp: ActuatorRamp, runs: Mapping[float, Recording], name: str) -> tuple[Recording, Recording]:
    """Orders of a column without and with the tilt that is shown; of the output angle, those of its error."""
    found = []
    for tilt in (0.0, SHOWN_TILT):
        run = ramp.settled(runs[tilt])
        values = run["output_angle"] - run["command"] if name == "output_angle" else run[name]
        columns = {"input_angle": run["input_angle"], name: values}
        found.append(order_spectrum(Recording(columns, {each: run.unit(each) for each in columns}), name, MAX_ORDER))
    return found[0], found[1]


def share_of_whole_orders(ramp: ActuatorRamp, runs: Mapping[float, Recording], name: str) -> float:
    """Return the share of a difference's power at whole orders, or so close that the load over the stroke explains it [1]."""
    spectrum = order_spectrum(difference(ramp, runs, SHOWN_TILT, name), name, MAX_ORDER)
    order, power = spectrum["order"], spectrum["amplitude"] ** 2
    counted = order > MIN_ORDER
    near = np.abs(order - np.round(order)) <= WHOLE_ORDER_TOLERANCE
    return float(power[counted & near].sum() / power[counted].sum())


# ---- Levels ----------------------------------------------------------------------------------------------------------


def members(sweeps: Iterable[str]) -> tuple[list[dict[str, float]], dict[str, slice]]:
    """Return the changes of the straight law in each run of some sweeps, and the runs of each sweep."""
    changes: list[dict[str, float]] = [{}]
    rows = {}
    for sweep in sweeps:
        name, values, others = SWEEPS[sweep]
        rows[sweep] = slice(len(changes), len(changes) + len(values))
        changes += [{**others, name: value} for value in values]
    return changes, rows


def swept(ramp: ActuatorRamp, law: Any) -> SweepLevels:
    """Runs of all levels, without noise of the sensors: differences are those of the misalignment alone."""
    changes, rows = members(SWEEPS if _side(ramp) == OUTPUT else BOTH_LOOPS)
    runs = (
        ramp.without_noise()
        .with_error(law)
        .many(
            [{f"{ERROR}.{name}": value for name, value in change.items()} for change in changes],
            record=[*CHANNELS, "kinematic_error"],
        )
    )
    found = [effect(ramp, runs, number) for number in range(len(changes))]
    names = dict.fromkeys(name for change in changes for name in change)
    units = {each["name"]: each["unit"] for each in law.fields}
    columns = {name: [change.get(name, getattr(law, name)) for change in changes] for name in names}
    columns |= {name: [row[name] for row in found] for name in found[0]}
    known = {name: units[name] for name in names} | {name: _unit(name) for name in found[0]}
    return SweepLevels(law.combine, _side(ramp), Recording(columns, known), rows)


def effect(ramp: ActuatorRamp, runs: Ensemble, number: int) -> dict[str, float]:
    """Return the differences of a run from the straight one; names as the columns of `SweepLevels.table`."""
    straight, run = (ramp.settled(runs.member(each)) for each in (0, number))
    found = {"error_swing": swing(run["kinematic_error"])}
    columns = {"input_angle": run["input_angle"], "error": run["kinematic_error"]}
    for name, column in (("torque", "torque"), ("current", "current"), ("output", "output_angle")):
        columns[name] = run[column] - straight[column]
        found[f"{name}_swing"] = swing(columns[name])
    for name in ("torque", "current"):
        found[f"{name}_peak"] = float(np.abs(run[name]).max() / np.abs(straight[name]).max())
    turning = Recording(columns, {name: "rad" if name == "input_angle" else _unit(name) for name in columns})
    for name in list(columns)[1:]:
        there = order_amplitudes(turning, name, SEEN_ORDERS)
        found |= {f"{name}_{order:g}": float(size) for order, size in zip(SEEN_ORDERS, there.amplitude, strict=True)}
    return found


def swing(values: Array) -> float:
    """Half of the distance of the greatest from the least."""
    return 0.5 * float(np.ptp(values))


def power_of_level(levels: SweepLevels, sweep: str, name: str) -> float:
    """The exponent with which a column grows with the level, by least squares of the logarithms."""
    level = levels.column(sweep, SWEEPS[sweep][0])
    return float(np.polyfit(np.log(level), np.log(levels.column(sweep, name)), 1)[0])


def _unit(name: str) -> str:
    """The unit of a column of the table of levels."""
    of, _, what = name.partition("_")
    return "1" if what == "peak" else {"torque": "N.m", "current": "A"}.get(of, "rad")


def _side(ramp: ActuatorRamp) -> str:
    """Return the side on which the position loop closes."""
    control: Any = ramp.drive.control
    while not hasattr(control, "feedback"):
        control = control.law
    return str(control.feedback)


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
    return Passing(_side(ramp), Recording({name: [row[name] for row in rows] for name in units}, units))


def _passed(ramp: ActuatorRamp, runs: Ensemble, place: int, gain: float) -> Iterator[dict[str, float]]:
    straight, run = (ramp.settled(runs.member(2 * place + each)) for each in (0, 1))
    columns = {
        "input_angle": run["input_angle"],
        "error": run["kinematic_error"],
        "output": run["output_angle"] - straight["output_angle"],
    }
    turning = Recording(columns, dict.fromkeys(columns, "rad"))
    asked = (2.0, 4.0)
    error, output = (order_amplitudes(turning, name, asked).amplitude for name in ("error", "output"))
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
    model = RecoveryModel.of(ramp)
    for combine in ("max", "single"):
        straight = law.replace(combine=combine)
        injected = straight.replace(**INJECTED)
        records = _records(ramp.with_error(injected))
        measured = {column: [_noisy(each, column, trial) for trial, each in enumerate(records)] for column in RECORDS}
        first = {column: recover(seen[0], column, model, straight) for column, seen in measured.items()}
        best = refined([each[combine] for each in first.values()], [seen[0] for seen in measured.values()], model, straight)
        runs = model.run([each.m for each in best], straight)
        for (column, seen), each, run in zip(measured.items(), best, runs, strict=True):
            trials = tuple(corrected(each, record, run, model, straight) for record in seen)
            yield Recovery(column, RECORDS[column], injected, first[column], trials)


def _records(ramp: ActuatorRamp) -> list[Recording]:
    """Return runs of the drive, each with other noises of the sensors in its loops."""
    seeds = noises(ramp.drive, "seed")
    if not seeds:
        run = ramp.settled(ramp.run())
        return [run] * NOISE_TRIALS
    changes = [
        {path: float(1 + trial * len(seeds) + place) for place, path in enumerate(seeds)} for trial in range(NOISE_TRIALS)
    ]
    runs = ramp.many(changes, record=["input_angle", *RECORDS])
    return [ramp.settled(runs.member(trial)) for trial in range(NOISE_TRIALS)]


def _noisy(recording: Recording, column: str, trial: int) -> Recording:
    """A column as a sensor would show it."""
    seen = recording[column] + RECORDS[column] * np.random.default_rng(trial).standard_normal(len(recording))
    columns = {"input_angle": recording["input_angle"], column: seen}
    return Recording(columns, {name: recording.unit(name) for name in columns})


# ---- A measured ramp -------------------------------------------------------------------------------------------------


def recording_of_ramp(path: Path) -> Recording:
    """Time, from 0 on, and those of the channels that a file has."""
    there = [name for name in CHANNELS if name in Recording.header(path)]
    if not there:
        raise ValueError(f"{path} has none of the columns {listed(CHANNELS)}; a ramp has time and one of them or more")
    found = Recording.read(path, columns={name: name for name in ("time", *there)})
    if len(found) < MIN_ROWS:
        raise ValueError(f"{path} has {len(found)} rows; a ramp needs {MIN_ROWS} or more")
    units = {"torque": "N.m", "current": "A"}
    try:
        columns = {"time": found.values("time", "s") - found.values("time", "s")[0]}
        columns |= {name: found.values(name, units.get(name, "rad")) for name in there}
    except ValueError as error:
        raise ValueError(f"{path} {error}; give the column in that unit, or in one of its multiples") from None
    return Recording(columns, {"time": "s"} | {name: units.get(name, "rad") for name in there}, title=path.name)


# ---- Files -----------------------------------------------------------------------------------------------------------


def recordings(found: MisalignmentStudy) -> dict[str, Recording]:
    """Everything recorded, by the name of its file."""
    runs = {
        f"ramp-{side}-tilt-{np.degrees(tilt):g}deg": run
        for side, of_side in found.shown.items()
        for tilt, run in of_side.items()
    }
    return {**runs, **{f"order-spectrum-{name}": pair[1] for name, pair in found.spectra.items()}}


def tables(found: MisalignmentStudy) -> dict[str, Recording]:
    """The tables, by the name of their files."""
    levels = {f"levels-{combine}-{side}": each.table for (combine, side), each in found.levels.items()}
    return levels | {f"ramp-times-and-gains-{side}": each.table for side, each in found.passing.items()}
