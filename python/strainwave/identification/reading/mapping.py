"""A user's statements on files: the column of a channel, its unit, and numbers that no column contains; also in a TOML file.

side = "output"
[columns]
joint_torque = "Moment"     # the name in the file
output_speed = 3            # or the number of the column, from 1
[units]
joint_torque = "N.m"
output_angle = "counts/16384"
[sign]
joint_torque = -1
[constants]
rate = 500                  # in SI units, or with a unit: "0.5 kHz"

["two_loads/*.csv"]         # what holds for these files only
constants.load_inertia = 0.85
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields
from functools import reduce
from pathlib import Path
from typing import Any, NamedTuple, get_args

from strainwave import arguments, questions
from strainwave.files.gear_file import at, document
from strainwave.files.units import check as check_unit, convert
from strainwave.identification.kinds import KINDS
from strainwave.identification.reading.names import CHANNEL_ALIASES, CHANNELS, UNUSED, Side
from strainwave.messages import nearest_of, one_line, quoted, shortened
from strainwave.number_texts import is_number, number_in


class ConstantRange(NamedTuple):
    """A number that belongs to a recording: its unit, and the range of its size."""

    unit: str
    low: float
    high: float
    signed: bool = False


CONSTANTS = {
    "rate": ConstantRange("Hz", 1e-6, 1e9),  # of rows without time
    "ratio": ConstantRange("1", arguments.MIN_RATIO, arguments.MAX_RATIO, signed=True),  # of the gear
    "torque_constant": ConstantRange("N.m/A", 1e-6, 1e3),
    "resistance": ConstantRange("Ohm", 1e-6, 1e6),
    "motor_inertia": ConstantRange("kg.m2", 0.0, 1e6),  # 0: the gear's input inertia contains it
    "load_inertia": ConstantRange("kg.m2", 1e-12, 1e9),
    "load_torque": ConstantRange("N.m", 0.0, 1e9, signed=True),  # at the output, constant
    "speed": ConstantRange("rad/s", 0.0, 1e6, signed=True),  # of a record at one speed without a column of it
    "temperature": ConstantRange("K", 1.0, 1e3),
}
MAX_NAMED = 100  # columns of one channel, as of other_angles
MAX_PATTERNS = 1000  # of file names: each file is compared with each
TABLE_ENTRIES = ("columns", "units", "sign", "constants")  # of a section
PATTERN_CHARACTERS = "*?[."  # a section with one of these in its name is a pattern of file names


@dataclass(frozen=True)
class FileMapping:
    """Meaning of the columns of a file as the user states it; strainwave determines the rest from the file, or asks.

    Args:
        columns: for each channel the name or the number of its column in the file; for `unused` those that are not to be used
        units: unit of each channel whose header states none
        sign: 1 or -1 for each channel that counts the other way
        constants: numbers that belong to the recording, of `CONSTANTS`, in SI units or as "75 mN.m/A"
        kind: of measurement, if the file leaves it open
        side: of a friction table, or of the channels of a log whose names contain none
        joint: number or name of the joint to take of several

    Raises:
        ValueError: a name, a unit or a value is none that is known

    >>> FileMapping(columns={"speed": "3"}, units={"speed": "U/min"})
    FileMapping(columns={'speed': '3'}, units={'speed': 'U/min'}, sign={}, constants={}, kind=None, side=None, joint=None)
    >>> FileMapping(constants={"torque_constant": "75 mN.m/A"}).constants
    {'torque_constant': 0.075}
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    sign: Mapping[str, int] = field(default_factory=dict)
    constants: Mapping[str, Any] = field(default_factory=dict)
    kind: str | None = None
    side: Side | None = None
    joint: str | None = None

    def __post_init__(self) -> None:
        channels = {**CHANNELS, **CHANNEL_ALIASES}
        for what, names, known in (("column", self.columns, (*channels, UNUSED)), ("sign", self.sign, channels)):
            for name in names:
                _check_known(f"--{what} {name}", name, known, "channels")
        for name, wanted in self.columns.items():
            if wanted.count(",") >= MAX_NAMED:
                raise ValueError(f"--column {name} names {wanted.count(',') + 1} columns; at most {MAX_NAMED} are taken")
        constants = {name: _constant(f"--constant {name}", value) for name, value in self.constants.items()}
        object.__setattr__(self, "constants", constants)
        for unit in self.units.values():
            check_unit(unit)
        for name, sign in self.sign.items():
            if isinstance(sign, bool) or sign not in (1, -1):
                raise ValueError(f"sign of {name} = {shortened(sign)} must be 1 or -1")
        for name, value, choices in (("kind", self.kind, KINDS), ("side", self.side, get_args(Side))):
            if value is not None:
                _check_known(f"{name} = {shortened(value)}", value, choices, f"{name}s")

    @property
    def options(self) -> list[str]:
        """Options of a command for all that a person states, without signs.

        >>> FileMapping(columns={"speed": "3"}, constants={"torque_constant": 0.0755}, side="input").options
        ['--side', 'input', '--column', 'speed=3', '--constant', 'torque_constant=0.0755']
        """
        words = [
            word for name, option in questions.SINGLE.items() if (value := getattr(self, name)) for word in (option, value)
        ]
        for name, option in questions.TABLES.items():
            words += [word for entry, value in getattr(self, name).items() for word in (option, f"{entry}={value}")]
        return words

    def updated(self, other: FileMapping) -> FileMapping:
        """Return this with the entries of another one, which replace those that both have."""
        both: dict[str, Any] = {}
        for each in fields(self):
            mine, its = getattr(self, each.name), getattr(other, each.name)
            both[each.name] = {**mine, **its} if isinstance(mine, Mapping) else (mine if its is None else its)
        return FileMapping(**both)


@dataclass(frozen=True)
class MappingFile:
    """Mappings that a person gives for several files: for all, and for those whose path fits a pattern."""

    general: FileMapping
    patterns: Mapping[str, FileMapping]

    @staticmethod
    def read(path: str | Path) -> MappingFile:
        """Return the mappings in a TOML file.

        Raises:
            ValueError: it cannot be read, or has an entry that is not known; names the place

        >>> import tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = Path(folder, "columns.toml")
        ...     _ = path.write_text('columns.speed = 3\\n["loads/*.csv"]\\nconstants.ratio = 80\\n')
        ...     file = MappingFile.read(path)
        >>> file.of("loads/heavy.csv").constants, file.of("other.csv").columns
        ({'ratio': 80.0}, {'speed': '3'})
        """
        with at(f"{path}"):
            whole = document(Path(path))
        try:
            patterns = {
                name: each for name, each in whole.items() if isinstance(each, dict) and set(name) & set(PATTERN_CHARACTERS)
            }
            if len(patterns) > MAX_PATTERNS:
                raise ValueError(f"has {len(patterns)} patterns of file names; at most {MAX_PATTERNS} are read")
            general = _mapping("", {name: each for name, each in whole.items() if name not in patterns})
            return MappingFile(general, {name: _mapping(f'["{name}"] ', each) for name, each in patterns.items()})
        except ValueError as error:
            raise ValueError(one_line(f"{path}: {error}")) from None

    def of(self, path: str | Path) -> FileMapping:
        """Return the mapping of a file: that of all, and of each pattern that it fits, in the order of the TOML file."""
        return reduce(FileMapping.updated, [own for each, own in self.patterns.items() if Path(path).match(each)], self.general)


def _mapping(place: str, section: Mapping[str, Any]) -> FileMapping:
    """Return the mapping in a section of a TOML file."""
    keys = [each.name for each in fields(FileMapping)]
    statements: dict[str, Any] = {}
    for name, value in section.items():
        _check_known(f"{place}{name}", name, keys, "keys")
        if name not in TABLE_ENTRIES:
            statements[name] = _entry(f"{place}{name}", name, value)
        elif isinstance(value, dict):
            statements[name] = {key: _entry(f"{place}{name}.{key}", name, each) for key, each in value.items()}
        else:
            raise ValueError(f"{place}{name} = {shortened(value)} must be a table, with a line for each channel or constant")
    try:
        return FileMapping(**statements)
    except ValueError as error:
        message = re.sub("--(column|constant) ", r"\1s.", str(error)).replace("--sign ", "sign.")
        raise ValueError(f"{place}{message}") from None


def _entry(place: str, name: str, value: object) -> Any:
    if name == "constants":
        return _constant(place, value)
    if name == "sign":
        return value
    if name != "units" and isinstance(value, int) and not isinstance(value, bool):
        return str(value)  # the number of a column, or of a joint
    if not isinstance(value, str) or not value:
        raise ValueError(f"{place} = {shortened(value)} must be a text")
    return value


def _constant(place: str, value: object) -> float:
    """Return a constant in SI units, from a number in them or a text with a unit."""
    name = place.replace(" ", ".").rpartition(".")[2]
    _check_known(place, name, CONSTANTS, "constants")
    wanted = CONSTANTS[name].unit
    if isinstance(value, str):
        number, _, unit = value.strip().partition(" ")
        try:
            return check_constant(place, name, convert(number_in(number), unit or wanted, wanted))
        except ValueError as error:
            if is_number(number):
                raise ValueError(f"{place} = {quoted(value)}: {error}") from None
            raise ValueError(
                f"{place} = {quoted(value)}: it is no number in {wanted}, nor one with its unit, as '0.1 {wanted}'"
            ) from None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{place} = {shortened(value)} must be a number in {wanted}, or a text with number and unit")
    return check_constant(place, name, value)


def check_constant(place: str, name: str, value: float) -> float:
    """Return a constant [SI], if it lies in its range.

    Args:
        place: what the message calls it

    Raises:
        TypeError, ValueError: it is no number, or lies outside

    >>> check_constant("--rate", "rate", -5.0)
    Traceback (most recent call last):
    ValueError: --rate = -5.0 Hz must lie in [1e-06, 1e+09]
    """
    unit, low, high, signed = CONSTANTS[name]
    written = unit if unit != "1" else ""
    if signed:
        return arguments.sized(place, value, written, low, high)
    return arguments.number(place, value, written, "[]", low, high)


def _check_known(place: str, name: str, known: Collection[str], what: str) -> None:
    if name not in known:
        raise ValueError(one_line(f"{place} is not known; {nearest_of(str(name), what, known)}"))
