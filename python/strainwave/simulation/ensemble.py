"""Many drives that differ in numbers alone, run side by side: kept in memory, or written to files as they come."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import Drive, _core, arguments
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.equality import ComparedByFields
from strainwave.files.ensemble_folder import EnsembleFolder, fingerprint
from strainwave.files.plots import MARGIN_HEIGHT, PANEL_HEIGHT, in_words
from strainwave.files.recording import Recording
from strainwave.files.writing import claiming, making
from strainwave.messages import in_a_sentence, listed, one_line, quoted
from strainwave.native import device, kernels
from strainwave.parameters import every, unknown
from strainwave.presentation import Pictured, Row, counted
from strainwave.progress import Progress, by_count
from strainwave.simulation import signals
from strainwave.simulation.excitation import ROOM_TEMPERATURE, TEMPERATURE_PLACE, Excitation
from strainwave.simulation.resolution import (
    FASTEST_ON_BRISTLES,
    MAX_STEP_PHASE,
    diverged,
    fastest_part,
    remedy,
    too_coarse,
    too_stiff,
)
from strainwave.simulation.scenario import Scenario
from strainwave.simulation.signals import Output
from strainwave.simulation.state import Known, known as initial_of
from strainwave.simulation.threads import available_threads
from strainwave.simulation.time_grid import TimeGrid

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

COUNTED_NAMES = {
    field["name"] for kinds in _core.families.values() for kind in kinds.values() for field in kind.fields if field["whole"]
}  # names of numbers that are counted
MAX_THREADS = 2**31 - 1  # that the core can count
MAX_MEMBERS = 100_000_000  # of one call: their parameters alone take gigabytes
MIN_POSITIVE = float(np.finfo(np.float32).tiny)  # the lower limit of what must be positive
# Bytes of output that a part of the files holds at most, where one pack does not need more; of a GPU, which takes many at once.
PART_BYTES, DEVICE_PART_BYTES = 64 << 20, 1 << 30
Backend = Literal["cpu", "gpu", "gpu-float"]

BACKENDS: tuple[Backend, ...] = get_args(Backend)
RUN_MEMBERS: dict[Backend, Callable[..., Any]] = {
    "cpu": _core.simulate_many,
    "gpu": partial(device.simulate_many, scalar="double"),
    "gpu-float": partial(device.simulate_many, scalar="float"),
}
DRAWN_BANDS = ((0.05, 0.95, "90 % of members", 0.2), (0.25, 0.75, "50 % of members", 0.45))  # quantiles, label, opacity
LEGEND_HEIGHT = 0.3  # inch
MAX_DRAWN_INSTANTS = 2_000  # of more every n-th is drawn


class EnsembleWarning(UserWarning):
    """Members of an ensemble could not be run to their end.

    >>> import warnings
    >>> import strainwave as sw
    >>> drive, voltage = sw.Drive(load=sw.loads.Inertia(inertia=0.01)), sw.scenario.step(5.0, duration=0.1)
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", sw.simulation.EnsembleWarning)
    ...     runs = sw.simulate_many(drive, voltage, {"gear.stiffness.k": [1e4, 1e12]})  # too stiff for the step
    >>> list(runs.failures), runs.failures[1].split(":")[0]
    ([1], 'dt = 0.0002 s is too coarse for this drive')
    """


@dataclass(frozen=True, eq=False)
class Ensemble(ComparedByFields, Pictured):
    """Runs of many members through one command.

    Args:
        time: instants of the samples [s], shape (samples,)
        columns: the outputs recorded, each of shape (members, samples); not-a-number throughout where a member failed
        units: the unit of each
        parameters: what the members differ in, each of shape (members,)
        failures: why a member has no result, by its number

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> runs = sw.simulate_many(drive, sw.scenario.step(5.0, duration=0.1), {"load.inertia": [0.01, 0.1, 1.0]})
    >>> runs["torque"].shape, abs(runs["torque"]).max(axis=1).round(2), runs.units["torque"]
    ((3, 501), array([ 3.33, 14.79, 27.58]), 'N.m')
    """

    time: Array
    columns: Mapping[str, Array]
    units: Mapping[str, str]
    parameters: Mapping[str, Array]
    failures: Mapping[int, str]

    def __getitem__(self, name: str) -> Array:
        """An output of all members, shape (members, samples)."""
        if arguments.text("the name of a column", name) not in self.columns:
            raise ValueError(f"no column {quoted(name)} was recorded; there are {listed(self.columns)}")
        return self.columns[name]

    def __len__(self) -> int:
        """Return the count of members."""
        return len(next(iter(self.columns.values())))

    def member(self, number: int) -> Recording:
        """Return the run of one member.

        Raises:
            TypeError: the number is not whole
            ValueError: there is no such member, or it has no result; the message gives the reason
        """
        arguments.whole("member", number, 0)
        if number >= len(self):
            raise ValueError(f"member {number} is not among the {len(self)} members, which count from 0")
        if number in self.failures:
            raise ValueError(f"member {number} has no result: {self.failures[number]}")
        series = {name: values[number] for name, values in self.columns.items()}
        return Recording({"time": self.time} | series, {"time": "s"} | dict(self.units), title=f"member {number}")

    def plot(self, names: Sequence[str] | None = None) -> Figure:
        """Return a figure of outputs over time: the median of all members, and the bands of 50 % and 90 % of them.

        Args:
            names: the outputs to draw; all that were recorded if not given

        Returns:
            a matplotlib figure with a panel for each output; members without a result are left out

        Raises:
            ValueError: an output was not recorded, or no member has a result
            TypeError: a name is no text

        >>> import strainwave as sw
        >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
        >>> runs = sw.simulate_many(drive, sw.scenario.step(5.0, 0.1), {"load.inertia": [0.01, 0.02]}, sample=1e-3)
        >>> runs.plot(["torque"]).get_suptitle()
        'Torque of 2 members'
        """
        drawn = list(self.columns) if names is None else list(arguments.names("names", names))
        for name in drawn:
            self[name]
        if not drawn:
            raise ValueError(f"names is empty; there are {listed(self.columns)}")
        if len(self.failures) == len(self):
            raise ValueError(f"none of the {len(self)} members has a result; the first failed: {self.failures[0]}")
        return ensemble_figure(self, drawn)

    @staticmethod
    def read(folder: str | Path) -> Ensemble:
        """Return the ensemble that `simulate_to` wrote to a folder; every value is checked against its digest.

        Raises:
            ValueError: the folder holds no ensemble, an unfinished one, or damaged files, which the message names

        >>> import tempfile
        >>> import strainwave as sw
        >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
        >>> step, varied = sw.scenario.step(5.0, duration=0.1), {"load.inertia": [0.01, 0.02]}
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     _ = sw.simulation.simulate_to(f"{folder}/runs", drive, step, varied)
        ...     runs = sw.Ensemble.read(f"{folder}/runs")
        >>> runs["torque"].shape
        (2, 501)
        """
        files = EnsembleFolder.open(Path(folder))
        missing = [part for part in files.parts() if not files.has(part)]
        if missing:
            done = files.members - sum(part.last - part.first for part in missing)
            raise ValueError(
                f"{folder} holds {done} of {files.members} members, without {missing[0].name}: call simulate_to again as "
                "before, which runs the others, or Ensemble.read_partial, which reads what is there"
            )
        return _read(files)

    @staticmethod
    def read_partial(folder: str | Path) -> Ensemble:
        """Return the members of an unfinished ensemble: each member keeps its number, and missing ones count as failed.

        Raises:
            ValueError: as `read`, or no member is there
        """
        return _read(EnsembleFolder.open(Path(folder)))

    def _headline(self) -> str:
        failed = f", {len(self.failures)} without a result" if self.failures else ""
        span = f"from {self.time[0]:g} s to {self.time[-1]:g} s"
        return f"{counted(len(self), 'member')}{failed}, {len(self.time)} samples {span}"

    def _rows(self) -> Iterator[Row]:
        for path, values in self.parameters.items():
            yield Row(path, (float(values.min()), float(values.max())), note="of the members")
        for name, values in self.columns.items():
            if len(self.failures) < len(self):
                yield Row(name, (float(np.nanmin(values)), float(np.nanmax(values))), self.units[name])
        yield from (Row(f"member {number}", reason) for number, reason in self.failures.items())


def _read(files: EnsembleFolder) -> Ensemble:
    """All members, those of parts that are not there among the failures."""
    there = [part for part in files.parts() if files.has(part)]
    if not there:
        raise ValueError(
            one_line(f"{files.path} holds none of {files.members} members; call simulate_to again as before to run them")
        )
    failures = dict.fromkeys(range(files.members), "it was not run, or its file is missing")
    columns: dict[str, Array] = {}
    for part in there:
        time, series = files.samples(part)
        for name, values in series.items():
            columns.setdefault(name, np.full((files.members, len(time)), np.nan))[part.first : part.last] = values
        for member in part.members.tolist():
            del failures[member]
        failures |= files.failures(part)
    return Ensemble(time, columns, files.units, files.parameters, dict(sorted(failures.items())))


@dataclass(frozen=True, eq=False)
class _Plan(ComparedByFields):
    """Checked arguments of an ensemble."""

    drive: Drive
    excitation: Excitation
    dt: float
    sample: float
    numbers: list[int]
    parameters: dict[str, Array]
    initial: Known | None
    time_grid: TimeGrid
    inputs: Array
    recorded: Mapping[str, Output]
    threads: int
    backend: Backend

    @classmethod
    def of(
        cls,
        drive: Drive,
        excitation: Excitation,
        parameters: Mapping[str, ArrayLike],
        initial: Mapping[str, ArrayLike] | None,
        dt: float | str,
        sample: float | str | None,
        record: Sequence[str],
        threads: int | None,
        backend: Backend,
    ) -> _Plan:
        arguments.drive(drive)
        arguments.one_of("backend", backend, BACKENDS)
        numbers, values = _checked(drive, parameters)
        known = initial_of(drive, initial, len(next(iter(values.values()))))
        recorded = signals.chosen(drive, record)
        threads = available_threads() if threads is None else arguments.whole("threads", threads, 1, MAX_THREADS)
        dt = arguments.seconds("dt", dt)
        sample = dt if sample is None else arguments.seconds("sample", sample)
        for path in values.keys() & {"control.period", "control.delay"}:
            if (values[path] != every(drive)[path].value).any():
                raise ValueError(f"{path} must be that of the drive for all members: their steps end at the same instants")
        instants = signals.instants(drive, drive.rest().numbers, excitation.command.duration)
        excitation.check_laid_out(min(dt, sample))
        time_grid = excitation.time_grid(dt, sample, instants)
        inputs = excitation.over(time_grid.instants)
        return cls(drive, excitation, dt, sample, numbers, values, known, time_grid, inputs, recorded, threads, backend)

    @property
    def members(self) -> int:
        return len(next(iter(self.parameters.values())))

    @property
    def time(self) -> Array:
        return self.time_grid.times

    @property
    def steps(self) -> int:
        return len(self.time_grid.instants) - 1

    @property
    def units(self) -> dict[str, str]:
        """Return the units of the recorded outputs."""
        units = signals.units(self.drive, self.recorded.values())
        return {name: units[name] for name in self.recorded}

    def run(self, first: int, last: int, shown: object) -> Ensemble:
        """Members `first` up to `last`, not included."""
        values = np.ascontiguousarray([column[first:last] for column in self.parameters.values()])
        channels = [each.channel for each in self.recorded.values()]
        outputs = np.empty((len(channels), last - first, len(self.time)))
        members, to_come = last - first, self.members - last
        prepared = kernels.prepared(self.drive, "simulate_many", members * self.steps, to_come * self.steps)
        with prepared if self.backend == "cpu" else nullcontext():
            sound, twists, fastest, on_bristles, refusals = RUN_MEMBERS[self.backend](
                self.drive,
                self.numbers,
                values,
                None if self.initial is None else (self.initial[0], np.ascontiguousarray(self.initial[1][:, first:last])),
                self.time_grid.instants,
                self.inputs,
                self.time_grid.samples[1:],
                channels,
                MAX_STEP_PHASE / self.time_grid.longest,
                self.threads,
                outputs,
                shown,
            )
        failures = self.failures(first, outputs, sound, twists, fastest, refusals)
        if stiff := np.count_nonzero(self.time_grid.longest * on_bristles > FASTEST_ON_BRISTLES):
            words = too_stiff(self.time_grid.longest, float(on_bristles.max()))
            warnings.warn(f"{stiff} members have {words}", EnsembleWarning, stacklevel=3)
        outputs[:, list(failures), :] = np.nan
        return Ensemble(
            self.time,
            dict(zip(self.recorded, outputs, strict=True)),
            self.units,
            {path: column[first:last] for path, column in self.parameters.items()},
            failures,
        )

    def failures(
        self, first: int, outputs: Array, ran: NDArray[np.bool_], twists: Array, fastest: Array, refusals: dict[int, str]
    ) -> dict[int, str]:
        """Return for each member from `first` on without a result the reason, in the words of `simulate`."""
        reasons, longest = dict(refusals), self.time_grid.longest
        coarse = fastest > MAX_STEP_PHASE / longest
        at_rest = coarse & (twists == 0.0)  # such members are not run
        sound = at_rest | ran
        temperature = float(self.excitation.first()[TEMPERATURE_PLACE])
        for member in np.flatnonzero(~sound | coarse).tolist():
            if member not in reasons and not sound[member]:
                reasons[member] = diverged(self.time, list(self.recorded), outputs[:, member], remedy(longest))
            elif member not in reasons:
                numbers = {path: float(column[first + member]) for path, column in self.parameters.items()}
                twist, rate = float(twists[member]), float(fastest[member])
                part = fastest_part(self.drive.replace(numbers), twist, temperature, rate)
                reasons[member] = too_coarse(longest, twist, rate, part)
        return dict(sorted(reasons.items()))


def simulate_many(
    drive: Drive,
    command: Scenario,
    parameters: Mapping[str, ArrayLike],
    dt: float | str = 2e-4,
    *,
    record: Sequence[str] = ("input_angle", "output_angle", "torque"),
    sample: float | str | None = None,
    load_torque: Scenario | float | str = 0.0,
    temperature: Scenario | float | str = ROOM_TEMPERATURE,
    inputs: Mapping[str, Scenario | float | str] | None = None,
    initial: Mapping[str, ArrayLike] | None = None,
    threads: int | None = None,
    backend: Backend = "cpu",
    progress: Progress = None,
) -> Ensemble:
    """Run a drive many times through one command, each time with other numbers, on all cores.

    Large ensembles compile a kernel, which takes several members to a vector register. The trajectories are those of `simulate`
    with its method "exponential", to the last bit, by a kernel or not, whatever the number of threads and the instruction set;
    only where orders of an error or exponents of a density are whole in some members and not in others may the last digit
    differ. The outputs take 8 bytes times members, outputs recorded and samples; `simulate_to` writes them to files instead, in
    memory that is flat over members. What acts on all of them takes 153 bytes a step.

    Args:
        drive: the drive
        command: as for `simulate`
        parameters: what the members differ in: path of a parameter, as in "gear.friction_input.coulomb" or
            "gear.hysteresis.stiffness[0]", and its value for each member, shape (members,)
        record: the outputs to keep
        dt, sample, load_torque, temperature, inputs, progress: as for `simulate`
        initial: as for `simulate`; a quantity has one value, or one for each member
        threads: how many to run on; all that this process may use, if not given
        backend: "cpu", or "gpu" for the first GPU that CUDA finds, which takes the extra cuda; "gpu-float" computes in single
            precision there. On a GPU Ctrl-C acts between launches, each of as many members as its memory holds

    Returns:
        Ensemble, whose columns have shape (members, samples)

    Raises:
        TypeError: values that are no numbers, `threads` that is no whole number, and as `simulate`
        ValueError: a parameter that the drive does not have, values out of its range or of unequal number, an output that is
            not known, `threads` below 1, and as `simulate`
        MemoryError: the outputs are too many; the message gives their size
        ImportError, OSError: the packages for a GPU are not installed, there is no GPU, or its driver reports an error

    Warns:
        EnsembleWarning: members without result; `failures` of the ensemble gives the reasons, and their outputs are
            not-a-number. Or members whose bristles are too stiff for `dt`

    >>> import numpy as np
    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> inertia = np.linspace(0.01, 0.02, 5)
    >>> runs = sw.simulate_many(drive, sw.scenario.step(amplitude=5.0, duration=0.1), {"load.inertia": inertia})
    >>> runs["output_angle"].shape
    (5, 501)
    """
    excitation = Excitation.of(arguments.drive(drive), command, load_torque, temperature, inputs)
    plan = _Plan.of(drive, excitation, parameters, initial, dt, sample, record, threads, backend)
    try:
        with by_count(progress, "simulating", plan.members * plan.steps) as shown:
            ensemble = plan.run(0, plan.members, shown)
    except MemoryError:
        size = f"{1e-9 * 8 * plan.members * len(plan.recorded) * len(plan.time):.3g} GB"
        raise MemoryError(f"the outputs take {size}; record fewer, sample less often, or let simulate_to write files") from None
    _tell(ensemble.failures, plan.members)
    return ensemble


def simulate_to(
    folder: str | Path,
    drive: Drive,
    command: Scenario,
    parameters: Mapping[str, ArrayLike],
    dt: float | str = 2e-4,
    *,
    record: Sequence[str] = ("input_angle", "output_angle", "torque"),
    sample: float | str | None = None,
    load_torque: Scenario | float | str = 0.0,
    temperature: Scenario | float | str = ROOM_TEMPERATURE,
    inputs: Mapping[str, Scenario | float | str] | None = None,
    initial: Mapping[str, ArrayLike] | None = None,
    threads: int | None = None,
    backend: Backend = "cpu",
    progress: Progress = None,
) -> Path:
    """Run an ensemble as `simulate_many`, and write the members to files as they come: memory stays flat for any count.

    Parquet files, for everything that reads a folder of them (pandas, polars, DuckDB; `Ensemble.read`). Those in samples/ have
    columns member, time [s] and the outputs, one row a sample; those in members/ have columns member, the parameters, and
    failure, empty where there was none. A part holds some thousand members and appears whole or not at all. plan.parquet, which
    is written first, contains the arguments. A run that was interrupted or killed, or whose disk was full, continues when it is
    called again: present members are kept, the others are run, and all are the same bits as of one run on this machine.

    Args:
        folder: where to write; must not exist, be empty, or hold the beginning of the same ensemble
        drive, command, parameters: as for `simulate_many`
        dt, record, sample, load_torque, temperature, inputs, initial, threads, backend, progress: as for `simulate_many`

    Returns:
        the folder

    Raises:
        FileExistsError: the folder contains something else, or another ensemble; the message names the difference
        BlockingIOError: another process is writing to the folder
        OSError: a file cannot be written; the message names it and the reason
        TypeError, ValueError: as `simulate_many`

    Warns:
        EnsembleWarning: as `simulate_many`

    >>> import tempfile
    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> step, varied = sw.scenario.step(5.0, 0.1), {"load.inertia": [0.01, 0.02]}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = sw.simulation.simulate_to(folder, drive, step, varied, sample=1e-2)
    ...     sw.Ensemble.read(folder)["torque"].shape
    (2, 11)
    """
    excitation = Excitation.of(arguments.drive(drive), command, load_torque, temperature, inputs)
    plan = _Plan.of(drive, excitation, parameters, initial, dt, sample, record, threads, backend)
    folder, failures = Path(folder), dict[int, str]()
    size = (PART_BYTES if plan.backend == "cpu" else DEVICE_PART_BYTES) // (8 * len(plan.recorded) * len(plan.time))
    pack = _core.max_lanes * plan.threads  # a part has whole packs for every thread, and its outputs fit into memory
    with making(folder), claiming(folder), by_count(progress, "simulating", plan.members * plan.steps) as shown:
        files = EnsembleFolder(folder, _asked(plan), plan.parameters, plan.units, max(pack, size - size % pack)).begin()
        for part in files.parts():
            if not files.has(part):
                report = None if shown is None else lambda done, begun=part.first: shown(begun * plan.steps + done)
                ensemble = plan.run(part.first, part.last, report)
                reasons = {part.first + member: reason for member, reason in ensemble.failures.items()}
                files.write(part, ensemble.time, ensemble.columns, reasons)
            failures |= files.failures(part)
    _tell(failures, plan.members)
    return folder


def _asked(plan: _Plan) -> dict[str, str]:
    """All that an ensemble depends on, by the names of the arguments."""
    excitation = plan.excitation
    load, temperature = (
        signal if isinstance(signal, Scenario) else float(signal) for signal in (excitation.load, excitation.temperature)
    )
    asked = {
        "drive": plan.drive,
        "command": excitation.command,
        signals.load_input(plan.drive): load,
        "temperature": temperature,
        "members": plan.members,
        "parameters": plan.parameters,
        "initial": plan.initial,
        "dt": plan.dt,
        "sample": plan.sample,
        "record": list(plan.recorded),
        "backend": plan.backend,
        "version": version("strainwave"),
    }
    return {name: fingerprint(value) for name, value in asked.items()}


def _checked(drive: Drive, parameters: Mapping[str, ArrayLike]) -> tuple[list[int], dict[str, Array]]:
    """The places of parameters among the drive's numbers, and their values, shape (members,) each."""
    all_numbers = every(drive)
    arguments.mapping("parameters", parameters, '{"load.inertia": [0.01, 0.02]}')
    if not parameters:
        raise ValueError("parameters must name at least one number that the members differ in")
    values: dict[str, Array] = {}
    for path, column in parameters.items():
        if path not in all_numbers:
            raise unknown(str(path), all_numbers)
        values[path] = arguments.numbers(path, column)
        if values[path].ndim != 1 or len(values[path]) == 0:
            raise ValueError(f"{path} must have one value a member, shape (members,), not {values[path].shape}")
        if len(values[path]) > MAX_MEMBERS:
            raise ValueError(
                f"{path} has {len(values[path])} values; one call has at most {MAX_MEMBERS} members: call it for parts"
            )
        number = all_numbers[path]
        wrong = np.flatnonzero(~(np.isfinite(values[path]) & (values[path] >= number.low) & (values[path] <= number.high)))
        if wrong.size:
            low, high = number.low, number.high
            lowest = "(-inf" if low == -np.inf else "(0" if low == MIN_POSITIVE else f"[{low:g}"
            limits = lowest + (", inf)" if high == np.inf else f", {high:g}]")  # in the notation of the models
            value = f"{values[path][wrong[0]]:g}" + (f" {number.unit}" if number.unit != "1" else "")
            raise ValueError(f"{path} = {value} of member {wrong[0]} must lie in {limits}")
        if path.rpartition(".")[2].partition("[")[0] in COUNTED_NAMES and (broken := np.flatnonzero(values[path] % 1.0)).size:
            raise ValueError(f"{path} = {values[path][broken[0]]:g} of member {broken[0]} must be a whole number")
    if len({len(column) for column in values.values()}) > 1:
        counts = ", ".join(f"{path} {len(column)}" for path, column in values.items())
        raise ValueError(f"all parameters must have as many values as there are members: {counts}")
    return [all_numbers[path].number for path in values], values


def _tell(failures: Mapping[int, str], members: int) -> None:
    if failures:
        number, reason = next(iter(failures.items()))
        warnings.warn(
            f"{len(failures)} of {members} members have no result; the first is member {number}: {reason}",
            EnsembleWarning,
            stacklevel=3,
        )


def ensemble_figure(ensemble: Ensemble, names: Sequence[str]) -> Figure:
    """Return the figure of some outputs, as `Ensemble.plot` describes it."""
    time, columns, units = ensemble.time, ensemble.columns, ensemble.units
    step = -(-len(time) // MAX_DRAWN_INSTANTS)
    ran = ~np.isnan(columns[names[0]][:, 0])
    title = f"{in_a_sentence([in_words(name) for name in names])} of {ran.sum()} members"
    with marks.new_figure(MARGIN_HEIGHT + LEGEND_HEIGHT + PANEL_HEIGHT * len(names), title[0].upper() + title[1:]) as figure:
        axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for axis, name in zip(axes, names, strict=True):
            values = columns[name][ran, ::step]
            for low, high, label, opacity in DRAWN_BANDS:
                edges = np.quantile(values, (low, high), axis=0)
                style = {"facecolor": LIGHT["measured"], "alpha": opacity, "linewidth": 0.0}
                axis.fill_between(time[::step], *edges, label=label, **style)
            axis.plot(time[::step], np.median(values, axis=0), color=LIGHT["ink"], label="median")
            axis.margins(x=0.01)
            marks.label_axes(axis, in_words(name), units[name])
        marks.label_abscissa(axes[-1], "time", "s")
        marks.legend(figure, axes[0])
    return figure
