"""Scenario files: what a run commands, what else acts on the drive, and how it starts; read from TOML, CSV and Parquet.

docs/how-to/command-line.md shows the format. What is wrong in a file is refused in one line with file, table and key.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import reduce
from operator import add
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from strainwave import Drive, _core, arguments
from strainwave.files.entries import check_line
from strainwave.files.gear_file import at, document
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import drive_of
from strainwave.files.recording import Recording
from strainwave.files.units import convert
from strainwave.files.writing import replacing
from strainwave.messages import listed, one_line, quoted, shortened
from strainwave.presentation import Presented
from strainwave.simulation import scenario
from strainwave.simulation.run import Run, simulate, simulate_adaptively
from strainwave.simulation.scenario import Scenario, Wave
from strainwave.simulation.signals import command_unit
from strainwave.simulation.state import INITIAL_QUANTITIES

UNIT_EXAMPLE = '{ value = 5.0, unit = "deg" }'
TEXT_KEYS = ("name", "note")


def pieces(
    start: ArrayLike,
    level: ArrayLike,
    slope: ArrayLike,
    duration: float,
    wave_amplitude: ArrayLike = (),
    wave_frequency: ArrayLike = (),
    wave_sweep: ArrayLike = (),
    wave_phase: ArrayLike = (),
) -> Scenario:
    """Return any scenario by its pieces and waves, also those that no other kind describes.

    Args:
        start, level, slope, duration: as `Scenario`
        wave_amplitude, wave_frequency, wave_sweep, wave_phase: of each wave, as `Wave`

    Raises:
        ValueError: the lists of the waves differ in length, or as `Scenario`

    >>> float(pieces([0.0, 1.0], [0.0, 2.0], [1.0, 0.0], duration=2.0).value(0.5))
    0.5
    """
    numbers = {"amplitude": wave_amplitude, "frequency": wave_frequency, "sweep": wave_sweep, "phase": wave_phase}
    columns = [arguments.numbers(f"wave_{name}", values) for name, values in numbers.items()]
    if columns[0].ndim != 1 or any(column.shape != columns[0].shape for column in columns):
        raise ValueError("wave_amplitude, wave_frequency, wave_sweep and wave_phase must be lists of equally many numbers")
    waves = tuple(Wave(*wave) for wave in np.column_stack(columns).tolist())
    return Scenario(duration, np.asarray(start), np.asarray(level), np.asarray(slope), waves)


SIGNAL_KINDS: dict[str, Callable[..., Scenario]] = {
    each.__name__: each
    for each in (
        scenario.constant,
        scenario.step,
        scenario.ramp,
        scenario.sine,
        scenario.chirp,
        scenario.pulse_train,
        scenario.table,
        pieces,
    )
}
IN_SECONDS = ("start", "period", "width", "time")
IN_HERTZ = ("frequency", "start_frequency", "stop_frequency", "wave_frequency")
IN_RADIANS = ("phase", "wave_phase")
PER_SECOND = ("rate", "slope")  # of the signal per second; the unit of all arguments not named here is that of the signal
DIFFERENCE_ARGUMENTS = ("amplitude", "wave_amplitude")  # no values of the signal: 5 degC more are 5 K, not 278.15 K


@dataclass(frozen=True)
class ScenarioFile(Presented):
    """Scenario of a run: its command, the other inputs of the drive, and its initial values.

    Args:
        command: as `simulate` takes it
        inputs: the other inputs, by name, as `simulate` takes them
        initial: known quantities at the start, by name, as `simulate` takes them; at rest if there are none
        name: what it is called, one line of text
        note: free text

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a text is not one line, a number is not finite, or an input lasts another time than the command

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> pushed = sw.simulation.ScenarioFile(sw.scenario.ramp(5.0, duration=0.2), {"load_torque": 3.0}, {"output_angle": 0.1})
    >>> float(pushed.simulate(drive)["output_angle"][0])
    0.1
    """

    command: Scenario
    inputs: Mapping[str, Scenario | float] = field(default_factory=dict)
    initial: Mapping[str, float] = field(default_factory=dict)
    name: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.command, Scenario):
            raise TypeError(f"command = {shortened(self.command)} must be a Scenario, as sw.scenario.constant(...) makes one")
        arguments.mapping("inputs", self.inputs, '{"load_torque": 5.0}')
        arguments.mapping("initial", self.initial, '{"output_angle": 0.3}')
        for name, signal in self.inputs.items():
            arguments.text("the name of an input", name)
            if isinstance(signal, Scenario):
                _check_duration(name, signal, self.command.duration)
            else:
                arguments.number(name, signal)
        for name, value in self.initial.items():
            arguments.number(arguments.one_of("the name of a quantity in initial", name, INITIAL_QUANTITIES), value)
        if arguments.text("name", self.name):
            check_line("name", self.name)
        arguments.text("note", self.note)
        object.__setattr__(self, "inputs", MappingProxyType(dict(self.inputs)))
        object.__setattr__(self, "initial", MappingProxyType(dict(self.initial)))

    def __reduce__(self) -> tuple[type[ScenarioFile], tuple[object, ...]]:
        return ScenarioFile, (self.command, dict(self.inputs), dict(self.initial), self.name, self.note)

    def simulate(self, drive: Drive | GearSet, dt: float = 2e-4, **options: Any) -> Run:
        """Run a drive through it, as `simulate` does.

        Args:
            drive, dt: as `simulate`
            options: sample, record, method and progress of `simulate`

        Raises:
            TypeError, ValueError, FloatingPointError, MemoryError: as `simulate`

        Warns:
            RuntimeWarning, RatingWarning: as `simulate`
        """
        return simulate(drive, self.command, dt, inputs=self.inputs, initial=self.initial or None, **options)

    def simulate_adaptively(self, drive: Drive | GearSet, rtol: float = 1e-6, **options: Any) -> Run:
        """Run a drive through it, as `simulate_adaptively` does.

        Args:
            drive, rtol: as `simulate_adaptively`
            options: atol, sample, record, max_steps and progress of `simulate_adaptively`

        Raises:
            TypeError, ValueError, FloatingPointError, MemoryError: as `simulate_adaptively`

        Warns:
            RatingWarning: as `simulate`
        """
        return simulate_adaptively(drive, self.command, rtol, inputs=self.inputs, initial=self.initial or None, **options)

    @staticmethod
    def read(path: str | Path, drive: Drive | GearSet) -> ScenarioFile:
        """Read the scenario of a drive from a TOML, CSV or Parquet file.

        In TOML a signal is a number, or a table whose `kind` is a function of `sw.scenario` and whose other entries are its
        arguments; several tables are added. Numbers are in SI units, or written with theirs::

            duration = 2.0

            [command]
            kind = "ramp"
            rate = { value = 30.0, unit = "deg/s" }

            [[load_torque]]
            kind = "step"
            amplitude = { value = 5.0, unit = "N.m" }
            start = 1.0

            [initial]
            output_angle = { value = 5.0, unit = "deg" }

        In CSV and Parquet the columns `time` and `command`, and one for each other input, give points that straight lines join.

        Args:
            path: the file; its suffix determines its format
            drive: what is to run: it determines the inputs and their units

        Raises:
            TypeError: `drive` is none
            ValueError: what is wrong, with file, table and key; a unit that does not fit what this drive takes
            OSError: the file cannot be read
        """
        path, drive = Path(path), drive_of(drive)
        if path.suffix == ".toml":
            with at(f"{path}"):
                return _from_toml(document(path), _units(drive))
        points = Recording.read(path)
        with at(f"{path}"):
            return _from_columns(points, _units(drive))

    def save(self, path: str | Path, drive: Drive | GearSet) -> None:
        """Write a TOML file that `read` reads back equal, bit for bit.

        Args:
            path: the file, which must end in .toml
            drive: what is to run: it determines the units

        Raises:
            TypeError: `drive` is none
            ValueError: the path does not end in .toml, or the drive takes no input of a name in `inputs`
            OSError: the file cannot be written

        >>> import tempfile
        >>> import strainwave as sw
        >>> drive = sw.load("position-drive")
        >>> wave = sw.simulation.ScenarioFile(sw.scenario.sine(0.1, frequency=1.0, duration=2.0))
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     wave.save(f"{folder}/wave.toml", drive)
        ...     sw.simulation.ScenarioFile.read(f"{folder}/wave.toml", drive) == wave
        True
        """
        import tomlkit

        path, units = Path(path), _units(drive_of(drive))
        if path.suffix != ".toml":
            raise ValueError(one_line(f"{path}: a scenario is written to a file that ends in .toml"))
        for name in self.inputs:
            _check_known(name, [each for each in units if each != "command"])
        for name, signal in {"command": self.command, **self.inputs}.items():
            if isinstance(signal, Scenario):
                signal.check_unit(name, units[name])
        content = tomlkit.dumps(_written(self, units))
        with replacing(path) as file:
            file.write(content.encode())


def _units(drive: Drive) -> dict[str, str]:
    """The inputs of a drive and their units, the command first."""
    name, unit, *_ = _core.load_input(drive)
    return {"command": command_unit(drive), name: unit, "temperature": "K"}


def _check_duration(name: str, signal: Scenario, duration: float) -> None:
    if signal.duration != duration:
        raise ValueError(f"{name} lasts {signal.duration:g} s, the scenario {duration:g} s; both must last equally long")


def _check_known(key: str, names: Iterable[str]) -> None:
    if key not in (known := list(names)):
        near = get_close_matches(key.lower(), known, n=1)
        raise ValueError(f"{quoted(key)} is not known{'; near it is ' * bool(near)}{''.join(near)}; there are {listed(known)}")


# Reading


def _from_columns(points: Recording, units: Mapping[str, str]) -> ScenarioFile:
    for name in ("time", "command"):
        if name not in points:
            raise ValueError(f"has no column {name}; it has {listed(points.names)}")
    for name in points.names:
        with at("column"):
            _check_known(name, ("time", *units))
    signals: dict[str, Scenario] = {}
    for name, unit in units.items():
        if name in points:
            with at(f"column {name}:"):
                signals[name] = scenario.table(points.time, _in_unit(points[name], points.unit(name), unit))
    return ScenarioFile(signals.pop("command"), signals, name=points.title)


def _from_toml(content: Mapping[str, Any], units: Mapping[str, str]) -> ScenarioFile:
    for key in content:
        _check_known(key, (*TEXT_KEYS, "duration", *units, "initial"))
    if "duration" not in content:
        raise ValueError("duration is missing; write duration = 2.0, in s")
    if "command" not in content:
        raise ValueError(f"command is missing; write [command] with kind = {_kinds()}")
    duration = arguments.seconds("duration", _number("duration", content["duration"], "s"))
    signals = {name: _signal(name, content[name], duration, unit) for name, unit in units.items() if name in content}
    command = signals.pop("command")
    if not isinstance(command, Scenario):
        command = scenario.constant(command, duration)
    texts = {key: arguments.text(key, content[key]) for key in TEXT_KEYS if key in content}
    return ScenarioFile(command, signals, _initial(content.get("initial", {})), **texts)


def _initial(table: Any) -> dict[str, float]:
    if not isinstance(table, dict):
        raise ValueError(f"initial = {shortened(table)} must be a table; write [initial] with output_angle = {UNIT_EXAMPLE}")
    with at("initial:"):
        for name in table:
            _check_known(name, INITIAL_QUANTITIES)
    return {name: _number(f"initial.{name}", value, INITIAL_QUANTITIES[name][1]) for name, value in table.items()}


def _signal(place: str, entry: Any, duration: float, unit: str) -> Scenario | float:
    """A number that stays, or the sum of the signals that a file lists at one place."""
    if not isinstance(entry, list) and not _has_kind(entry):
        return _number(place, entry, unit)
    each = entry if isinstance(entry, list) else [entry]
    if not each:
        raise ValueError(f"{place} is empty; write [{place}] with kind = {_kinds()}")
    places = [place] if len(each) == 1 else [f"{place}[{i}]" for i in range(len(each))]
    pairs = enumerate(zip(places, each, strict=True))
    return reduce(add, [_piece(place, piece, duration, unit, first=i == 0) for i, (place, piece) in pairs])


def _has_kind(entry: Any) -> bool:
    return isinstance(entry, dict) and ("kind" in entry or "value" not in entry)


def _kinds() -> str:
    return " or ".join(map(quoted, SIGNAL_KINDS))


def _piece(place: str, entry: Any, duration: float, unit: str, first: bool) -> Scenario:
    """One of the signals that are added; but for the first, values in a unit with a zero of its own make no sense."""
    if not _has_kind(entry):
        raise ValueError(f"{place} = {shortened(entry)} must be a table with kind = {_kinds()}")
    if (kind := entry.get("kind")) is None:
        raise ValueError(f"{place}.kind is missing; write kind = {_kinds()}")
    if not isinstance(kind, str) or kind not in SIGNAL_KINDS:
        near = get_close_matches(str(kind).lower(), SIGNAL_KINDS, n=1)
        hint = f"{'; near it is ' * bool(near)}{''.join(near)}; write kind = {_kinds()}"
        raise ValueError(f"{place}.kind = {shortened(kind)} is not known{hint}")
    arguments_of_kind = inspect.signature(SIGNAL_KINDS[kind]).parameters
    entries = {key: value for key, value in entry.items() if key != "kind"}
    with at(f"{place}: {kind}:"):
        for key in entries:
            _check_known(key, [name for name in arguments_of_kind if name != "duration"])
    needed = [name for name, each in arguments_of_kind.items() if each.default is each.empty and name != "duration"]
    if missing := [name for name in needed if name not in entries]:
        raise ValueError(f"{place}.{missing[0]} is missing; {kind} needs {listed(needed)}")
    numbers = {
        key: _numbers(f"{place}.{key}", value, _unit_of(key, unit), first and key not in DIFFERENCE_ARGUMENTS)
        for key, value in entries.items()
    }
    with at(f"{place}:"):
        made = SIGNAL_KINDS[kind](**numbers, **({"duration": duration} if "duration" in arguments_of_kind else {}))
    _check_duration(place, made, duration)
    return made


def _unit_of(argument: str, unit: str) -> str:
    """The unit of an argument of a signal in this unit."""
    if argument in PER_SECOND:
        return f"{unit}/s"
    named = {"s": IN_SECONDS, "Hz": IN_HERTZ, "rad": IN_RADIANS, "Hz/s": ("wave_sweep",)}
    return next((own for own, names in named.items() if argument in names), unit)


def _number(place: str, entry: Any, unit: str) -> float:
    if isinstance(number := _numbers(place, entry, unit), list):
        raise ValueError(f"{place} = {shortened(entry)} must be one number")
    return float(number)


def _numbers(place: str, entry: Any, unit: str, absolute: bool = True) -> Any:
    """A number or a list of numbers, in this unit; a file may write them in another."""
    value, written = _with_unit(place, entry) if isinstance(entry, dict) else (entry, unit)
    numbers = [arguments.number(place, each, written) for each in (value if isinstance(value, list) else [value])]
    with at(f"{place}:"):
        if not absolute and _in_unit(0.0, written, unit) != 0.0:
            raise ValueError(f"what is added is a difference; {written} has a zero of its own, so write {unit}")
        found = [_in_unit(each, written, unit) for each in numbers]
    return found if isinstance(value, list) else found[0]


def _in_unit(values: Any, written: str, unit: str) -> Any:
    try:
        return convert(values, written, unit)
    except ValueError as error:
        raise ValueError(f"{error}; this drive takes {unit}") from None


def _with_unit(place: str, table: dict[str, Any]) -> tuple[Any, str]:
    with at(f"{place}:"):
        for key in table:
            _check_known(key, ("value", "unit"))
    if missing := [key for key in ("value", "unit") if key not in table]:
        raise ValueError(f"{place}.{missing[0]} is missing; write {UNIT_EXAMPLE}, or a number in SI units")
    return table["value"], arguments.text(f"{place}.unit", table["unit"])


# Writing


def _written(scenario_file: ScenarioFile, units: Mapping[str, str]) -> dict[str, Any]:
    """Return the content of the file: texts and numbers before tables."""
    content: dict[str, Any] = {key: text for key in TEXT_KEYS if (text := getattr(scenario_file, key))}
    content["duration"] = _quantity(scenario_file.command.duration, "s")
    signals = {"command": scenario_file.command, **scenario_file.inputs}
    constant = {name: value for name, value in signals.items() if not isinstance(value, Scenario)}
    content |= {name: _quantity(float(value), units[name]) for name, value in constant.items()}
    for name, signal in signals.items():
        if isinstance(signal, Scenario):  # as the kinds whose sum it is to the last bit, else as its pieces
            terms = _line(signal) + [_wave(wave, signal.duration) for wave in signal.waves]
            terms = terms if _sum_of(terms, signal.duration) == signal else [_pieces(signal)]
            content[name] = [
                {"kind": kind} | {key: _quantity(value, _unit_of(key, units[name])) for key, value in entries.items()}
                for kind, entries in terms
            ]
    if scenario_file.initial:
        content["initial"] = {
            name: _quantity(float(value), INITIAL_QUANTITIES[name][1]) for name, value in scenario_file.initial.items()
        }
    return content


def _quantity(value: float | list[float], unit: str) -> Any:
    import tomlkit

    quantity = tomlkit.inline_table()
    quantity.update({"value": value, "unit": unit})
    return quantity


Terms = list[tuple[str, dict[str, Any]]]  # kinds, each with its arguments


def _line(signal: Scenario) -> Terms:
    """Return the terms of a signal without its waves; none if it has waves only."""
    start, level, slope = (values.tolist() for values in (signal.start, signal.level, signal.slope))
    if signal.waves and not any(level) and not any(slope):
        return []
    ends_alone = len(start) == 1 or (len(start) == 2 and level[0] == slope[0] == 0.0)
    later = {"start": start[-1]} if len(start) == 2 else {}
    if len(start) == 1 and slope == [0.0]:
        return [("constant", {"value": level[0]})]
    if ends_alone and slope[-1] == 0.0:
        return [("step", {"amplitude": level[-1], **later})]
    if ends_alone and level[-1] == 0.0:
        return [("ramp", {"rate": slope[-1], **later})]
    return [("pieces", {"start": start, "level": level, "slope": slope})]


def _wave(wave: Wave, duration: float) -> tuple[str, dict[str, Any]]:
    if wave.sweep == 0.0:
        return "sine", {"amplitude": wave.amplitude, "frequency": wave.frequency, "phase": wave.phase}
    stop = wave.frequency + wave.sweep * duration
    return "chirp", {"amplitude": wave.amplitude, "start_frequency": wave.frequency, "stop_frequency": stop}


def _pieces(signal: Scenario) -> tuple[str, dict[str, Any]]:
    line = {name: getattr(signal, name).tolist() for name in ("start", "level", "slope")}
    names = ("amplitude", "frequency", "sweep", "phase") if signal.waves else ()
    return "pieces", line | {f"wave_{name}": [float(getattr(wave, name)) for wave in signal.waves] for name in names}


def _sum_of(terms: Terms, duration: float) -> Scenario | None:
    try:
        return reduce(add, [SIGNAL_KINDS[kind](**entries, duration=duration) for kind, entries in terms])
    except ValueError:  # what a kind refuses, as a wave of negative frequency
        return None
