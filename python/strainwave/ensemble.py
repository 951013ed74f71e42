"""Many drives that differ in numbers alone, run side by side: kept in memory, or written to files as they come."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import _core, arguments
from strainwave.drives import PositionDrive
from strainwave.files import replacing
from strainwave.parameters import every, unknown
from strainwave.recording import Recording
from strainwave.scenario import Scenario
from strainwave.simulation import (
    COARSEST,
    FASTEST_ON_BRISTLES,
    LARGEST,
    ROOM_TEMPERATURE,
    Course,
    Excitation,
    diverged,
    output_units,
    progressing,
    remedy,
    too_coarse,
    too_stiff,
)

if TYPE_CHECKING:
    import pyarrow

Array = NDArray[np.float64]
MOST_THREADS = 2**31 - 1  # that the core can count
OUTPUTS = [name for name, _, _ in _core.outputs]
SMALLEST = float(np.finfo(np.float32).tiny)  # the lower limit of what must be positive
PART = 64 << 20  # bytes of output that a part of the files holds at most, where one pack does not need more


class EnsembleWarning(UserWarning):
    """Members of an ensemble could not be run to their end."""


@dataclass(frozen=True, eq=False)
class Ensemble:
    """Runs of many members through one command.

    Args:
        time: instants of the samples [s], shape (samples,)
        columns: the outputs recorded, each of shape (members, samples); not-a-number throughout where a member failed
        units: the unit of each
        parameters: what the members differ in, each of shape (members,)
        failures: why a member has no result, by its number
    """

    time: Array
    columns: Mapping[str, Array]
    units: Mapping[str, str]
    parameters: Mapping[str, Array]
    failures: Mapping[int, str]

    def __getitem__(self, name: str) -> Array:
        """An output of all members, shape (members, samples)."""
        if name not in self.columns:
            raise ValueError(f'no column "{name}" was recorded; there are {", ".join(self.columns)}')
        return self.columns[name]

    def __len__(self) -> int:
        """How many members."""
        return len(next(iter(self.columns.values())))

    def member(self, number: int) -> Recording:
        """One member's run; `ValueError` with the reason if it has none."""
        arguments.whole("member", number, 0)
        if number >= len(self):
            raise ValueError(f"member {number} is not among the {len(self)} members, which count from 0")
        if number in self.failures:
            raise ValueError(f"member {number} has no result: {self.failures[number]}")
        series = {name: values[number] for name, values in self.columns.items()}
        return Recording({"time": self.time} | series, {"time": "s"} | dict(self.units), title=f"member {number}")

    @staticmethod
    def read(folder: str | Path) -> Ensemble:
        """What `simulate_to` wrote to a folder, all of it, also where it was interrupted: the members that were done."""
        import pyarrow.parquet as parquet

        written = Path(folder, "members").glob("part-*.parquet")  # after their samples
        parts = sorted(written, key=lambda part: (len(part.name), part.name))  # of a million and more parts, too
        if not parts:
            raise ValueError(f"{folder} holds no ensemble: there is no members/part-*.parquet")
        tables = [parquet.read_table(Path(folder, "samples", part.name)) for part in parts]
        schema = tables[0].schema
        names = [name for name in schema.names if name not in ("member", "time")]
        count = sum(int(table["member"][-1].as_py()) - int(table["member"][0].as_py()) + 1 for table in tables)
        columns = {name: np.concatenate([table[name].to_numpy() for table in tables]).reshape(count, -1) for name in names}
        time = tables[0]["time"].to_numpy()[: next(iter(columns.values())).shape[1]]
        units = {name: schema.field(name).metadata[b"unit"].decode() for name in names}
        members = [parquet.read_table(part).to_pydict() for part in parts]
        paths = [name for name in members[0] if name not in ("member", "failure")]
        parameters = {path: np.array([x for table in members for x in table[path]]) for path in paths}
        numbered = [pair for table in members for pair in zip(table["member"], table["failure"], strict=True)]
        return Ensemble(time, columns, units, parameters, {number: reason for number, reason in numbered if reason})


@dataclass(frozen=True)
class _Plan:
    """What is asked for, checked."""

    drive: PositionDrive
    numbers: list[int]
    parameters: dict[str, Array]
    course: Course
    inputs: Array
    recorded: list[str]
    threads: int

    @classmethod
    def of(
        cls,
        drive: PositionDrive,
        excitation: Excitation,
        parameters: Mapping[str, ArrayLike],
        dt: float,
        sample: float | None,
        record: Sequence[str],
        threads: int | None,
    ) -> _Plan:
        arguments.drive(drive)
        numbers, values = _checked(drive, parameters)
        recorded = _outputs(record)
        threads = available_threads() if threads is None else arguments.whole("threads", threads, 1, MOST_THREADS)
        dt = arguments.seconds("dt", dt)
        course = excitation.course(dt, dt if sample is None else arguments.seconds("sample", sample))
        return cls(drive, numbers, values, course, excitation.over(course), recorded, threads)

    @property
    def members(self) -> int:
        return len(next(iter(self.parameters.values())))

    @property
    def time(self) -> Array:
        return self.course.times

    @property
    def steps(self) -> int:
        return len(self.course.instants) - 1

    def run(self, first: int, last: int, shown: object) -> Ensemble:
        """Members `first` up to `last`, not included."""
        values = np.ascontiguousarray([column[first:last] for column in self.parameters.values()])
        channels = [OUTPUTS.index(name) for name in self.recorded]
        outputs = np.empty((len(channels), last - first, len(self.time)))
        sound, twists, fastest, on_bristles, refusals = _core.simulate_many(
            self.drive,
            self.numbers,
            values,
            self.course.instants,
            self.inputs,
            self.course.samples[1:],
            channels,
            COARSEST / self.course.longest,
            LARGEST,
            self.threads,
            outputs,
            shown,  # type: ignore[arg-type]
        )
        failures = self.failures(outputs, sound, twists, fastest, refusals)
        _tell_of_bristles(self.course.longest, on_bristles)
        outputs[:, list(failures), :] = np.nan
        units = output_units(self.drive)
        return Ensemble(
            self.time,
            dict(zip(self.recorded, outputs, strict=True)),
            {name: units[name] for name in self.recorded},
            {path: column[first:last] for path, column in self.parameters.items()},
            failures,
        )

    def failures(
        self, outputs: Array, ran: NDArray[np.bool_], twists: Array, fastest: Array, refusals: dict[int, str]
    ) -> dict[int, str]:
        """Why members have no result, as `simulate` would say it of each alone."""
        found = dict(refusals)
        coarse = fastest > COARSEST / self.course.longest
        at_rest = coarse & (twists == 0.0)  # such members are not run
        sound = at_rest | ran
        for member in np.flatnonzero(~sound | coarse).tolist():
            if member not in found and not sound[member]:
                found[member] = diverged(self.time, self.recorded, outputs[:, member], remedy(self.course.longest))
            elif member not in found:
                found[member] = too_coarse(self.course.longest, float(twists[member]), float(fastest[member]))
        return dict(sorted(found.items()))


def simulate_many(
    drive: PositionDrive,
    command: Scenario,
    parameters: Mapping[str, ArrayLike],
    dt: float = 2e-4,
    *,
    record: Sequence[str] = ("input_angle", "output_angle", "torque"),
    sample: float | None = None,
    load_torque: Scenario | float = 0.0,
    temperature: Scenario | float = ROOM_TEMPERATURE,
    threads: int | None = None,
    progress: bool = False,
) -> Ensemble:
    """Runs a drive many times through one command, each time with other numbers: several to a vector register, on all cores.

    The same trajectories as `simulate` gives from rest with its method "exponential", to the last bit, whatever the number of
    threads and the instruction set; only where orders of an error or exponents of a density are whole in some members and not
    in others may the last digit differ. The outputs take 8 bytes times members, outputs recorded and samples; `simulate_to`
    writes them to files instead, in memory that is flat over members. What acts on all of them takes 105 bytes a step.

    Args:
        drive: the drive
        command: as for `simulate`
        parameters: what the members differ in: path of a parameter, as in "gear.friction_input.coulomb" or
            "gear.hysteresis.stiffness[0]", and its value for each member, shape (members,)
        record: the outputs to keep
        dt, sample, load_torque, temperature, progress: as for `simulate`
        threads: how many to run on; all that this process may use, if not given

    Returns:
        Ensemble, whose columns have shape (members, samples)

    Raises:
        TypeError: values that are no numbers, `threads` that is no whole number, and as `simulate`
        ValueError: a parameter that the drive does not have, values out of its range or of unequal number, an output that is
            not known, `threads` below 1, and as `simulate`
        MemoryError: the outputs are too many; says how large they are

    Warns:
        EnsembleWarning: members without result; `failures` of the ensemble says why, and their outputs are not-a-number. Or
            members whose bristles are too stiff for `dt`

    >>> import numpy as np
    >>> import strainwave as sw
    >>> drive = sw.drives.PositionDrive(load=sw.loads.Inertia(inertia=0.01))
    >>> inertia = np.linspace(0.01, 0.02, 5)
    >>> runs = sw.simulate_many(drive, sw.scenario.step(amplitude=5.0, duration=0.1), {"load.inertia": inertia})
    >>> runs["output_angle"].shape
    (5, 501)
    """
    plan = _Plan.of(drive, Excitation(command, load_torque, temperature), parameters, dt, sample, record, threads)
    try:
        with progressing(progress, plan.members * plan.steps) as shown:
            ensemble = plan.run(0, plan.members, shown)
    except MemoryError:
        size = f"{1e-9 * 8 * plan.members * len(plan.recorded) * len(plan.time):.3g} GB"
        raise MemoryError(f"the outputs take {size}; record fewer, sample less often, or let simulate_to write files") from None
    _tell(ensemble.failures, plan.members)
    return ensemble


def simulate_to(
    folder: str | Path,
    drive: PositionDrive,
    command: Scenario,
    parameters: Mapping[str, ArrayLike],
    dt: float = 2e-4,
    *,
    record: Sequence[str] = ("input_angle", "output_angle", "torque"),
    sample: float | None = None,
    load_torque: Scenario | float = 0.0,
    temperature: Scenario | float = ROOM_TEMPERATURE,
    threads: int | None = None,
    progress: bool = False,
) -> Path:
    """As `simulate_many`, but writes the members to files as they come: memory stays flat however many they are.

    Parquet files, for everything that reads a folder of them (pandas, polars, DuckDB; `Ensemble.read`). Those in samples/ have
    columns member, time [s] and the outputs, one row a sample; those in members/ have columns member, the parameters, and
    failure, empty where there was none. A part holds some thousand members and appears whole or not at all, so that a run that
    is interrupted or killed leaves all parts readable that were done.

    Args:
        folder: where to write; must be empty, or not exist
        drive, command, parameters, dt, record, sample, load_torque, temperature, threads, progress: as for `simulate_many`

    Returns:
        the folder

    Raises:
        FileExistsError: the folder is not empty
        TypeError, ValueError: as `simulate_many`

    Warns:
        EnsembleWarning: as `simulate_many`

    >>> import tempfile
    >>> import strainwave as sw
    >>> drive = sw.drives.PositionDrive(load=sw.loads.Inertia(inertia=0.01))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = sw.simulate_to(folder, drive, sw.scenario.step(5.0, 0.1), {"load.inertia": [0.01, 0.02]}, sample=1e-2)
    ...     sw.Ensemble.read(folder)["torque"].shape
    (2, 11)
    """
    plan = _Plan.of(drive, Excitation(command, load_torque, temperature), parameters, dt, sample, record, threads)
    folder = Path(folder)
    if folder.exists() and any(folder.iterdir()):
        raise FileExistsError(f"{folder} is not empty; take another folder, or move what is there")
    for name in ("samples", "members"):
        (folder / name).mkdir(parents=True)
    failures: dict[int, str] = {}
    with progressing(progress, plan.members * plan.steps) as shown:
        for part, (first, last) in enumerate(_parts(plan)):
            report = None if shown is None else lambda done, begun=first: shown(begun * plan.steps + done)
            ensemble = plan.run(first, last, report)
            failures |= {first + member: reason for member, reason in ensemble.failures.items()}
            _write(folder, f"part-{part:06d}.parquet", ensemble, first)
    _tell(failures, plan.members)
    return folder


def available_threads() -> int:
    """How many threads this process may run at once."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _checked(drive: PositionDrive, parameters: Mapping[str, ArrayLike]) -> tuple[list[int], dict[str, Array]]:
    """The places of parameters among the drive's numbers, and their values, shape (members,) each."""
    known = every(drive)
    arguments.mapping("parameters", parameters, '{"load.inertia": [0.01, 0.02]}')
    if not parameters:
        raise ValueError("parameters must name at least one number that the members differ in")
    values: dict[str, Array] = {}
    for path, column in parameters.items():
        if path not in known:
            raise unknown(str(path), known)
        values[path] = arguments.numbers(path, column)
        if values[path].ndim != 1 or len(values[path]) == 0:
            raise ValueError(f"{path} must have one value a member, shape (members,), not {values[path].shape}")
        number = known[path]
        wrong = np.flatnonzero(~(np.isfinite(values[path]) & (values[path] >= number.low) & (values[path] <= number.high)))
        if wrong.size:
            given = f"{values[path][wrong[0]]:g}" + (f" {number.unit}" if number.unit != "1" else "")
            raise ValueError(f"{path} = {given} of member {wrong[0]} must lie in {_limits(number.low, number.high)}")
    if len({len(column) for column in values.values()}) > 1:
        counts = ", ".join(f"{path} {len(column)}" for path, column in values.items())
        raise ValueError(f"all parameters must have as many values as there are members: {counts}")
    return [known[path].number for path in values], values


def _outputs(record: Sequence[str]) -> list[str]:
    """The outputs to record, in order."""
    names = arguments.names("record", record)
    if not names or not set(names) <= set(OUTPUTS):
        raise ValueError(f"record = {names!r} must list outputs of a drive: {', '.join(OUTPUTS)}")
    return names


def _limits(low: float, high: float) -> str:
    """As the models tell theirs."""
    lowest = "(-inf" if low == -np.inf else "(0" if low == SMALLEST else f"[{low:g}"
    return lowest + (", inf)" if high == np.inf else f", {high:g}]")


def _parts(plan: _Plan) -> Iterator[tuple[int, int]]:
    """Members from and to, by parts that fit into memory."""
    size = PART // (8 * len(plan.recorded) * len(plan.time))
    pack = _core.lanes * plan.threads
    size = max(pack, size - size % pack)
    for first in range(0, plan.members, size):
        yield first, min(first + size, plan.members)


def _write(folder: Path, name: str, ensemble: Ensemble, first: int) -> None:
    """One part: its members last, so that whoever sees them finds their samples."""
    import pyarrow

    members, samples = len(ensemble), len(ensemble.time)
    numbers = np.arange(first, first + members)
    table = {"member": np.repeat(numbers, samples), "time": np.tile(ensemble.time, members)}
    fields = [pyarrow.field("member", pyarrow.int64()), pyarrow.field("time", pyarrow.float64(), metadata={"unit": "s"})]
    for column, values in ensemble.columns.items():
        table[column] = values.reshape(-1)
        fields.append(pyarrow.field(column, pyarrow.float64(), metadata={"unit": ensemble.units[column]}))
    _write_table(folder / "samples" / name, pyarrow.table(table, schema=pyarrow.schema(fields)), list(ensemble.columns))
    failures = pyarrow.array([ensemble.failures.get(member) for member in range(members)], pyarrow.string())
    told = {"member": numbers} | dict(ensemble.parameters) | {"failure": failures}
    _write_table(folder / "members" / name, pyarrow.table(told), list(ensemble.parameters))


def _write_table(path: Path, table: pyarrow.Table, floats: list[str]) -> None:
    from pyarrow.parquet import write_table

    with replacing(path) as file:
        write_table(
            table,
            file,
            compression="zstd",
            use_dictionary=[name for name in table.column_names if name not in floats],
            column_encoding=dict.fromkeys(floats, "BYTE_STREAM_SPLIT"),
            write_page_checksum=True,
        )


def _tell_of_bristles(dt: float, vibrations: Array) -> None:
    stiff = np.flatnonzero(dt * vibrations > FASTEST_ON_BRISTLES)
    if stiff.size:
        told = f"{stiff.size} members have {too_stiff(dt, float(vibrations.max()))}"
        warnings.warn(told, EnsembleWarning, stacklevel=4)


def _tell(failures: Mapping[int, str], members: int) -> None:
    if failures:
        number, reason = next(iter(failures.items()))
        warnings.warn(
            f"{len(failures)} of {members} members have no result; the first is member {number}: {reason}",
            EnsembleWarning,
            stacklevel=3,
        )
