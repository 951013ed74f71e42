"""Tables of a gear file for a whole gear: covariance of its identified numbers, and its errors on the files they came from."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments
from strainwave.files.entries import Form, check_line, checked, schema
from strainwave.files.units import check as check_unit
from strainwave.messages import listed, shortened, unquoted

Array = NDArray[np.float64]

MAX_NUMBERS = 200  # of a covariance: a whole drive has some 60
MAX_VALIDATIONS = 1000  # files of one gear
RANGES = {"input_speed": "rad/s", "output_torque": "N.m", "output_angle": "rad", "temperature": "K"}  # and their units
MAX_ASYMMETRY = 1e-9  # of correlations
MAX_EXCESS = 1e-6  # of a correlation beyond 1, and of an eigenvalue below 0: more is no rounding


@dataclass(frozen=True)
class Covariance:
    """Covariance of identified numbers.

    Args:
        paths: of the numbers, as `gear.friction_input.coulomb`, shape (n,)
        matrix: their covariance in SI units, rows of n numbers, shape (n, n)

    Raises:
        ValueError: a path comes twice, or the matrix is no covariance of as many numbers

    >>> found = Covariance(("load.inertia", "load.gravity_torque"), ((4e-4, 1e-3), (1e-3, 1e-2)))
    >>> found.correlation("load.inertia", "load.gravity_torque")
    0.5
    """

    paths: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        n, shape = len(self.paths), {len(row) for row in self.matrix}
        if not 1 <= n <= MAX_NUMBERS or len(set(self.paths)) < n:
            raise ValueError(
                f"numbers must be 1 to {MAX_NUMBERS} different paths; there are {n}, {len(set(self.paths))} different"
            )
        if len(self.matrix) != n or shape != {n}:
            raise ValueError(f"matrix must have {n} rows of {n} numbers, one for each of the numbers")
        values = self.array
        if not np.isfinite(values).all() or not (np.diag(values) > 0.0).all():
            raise ValueError("matrix must have variances above 0 on its diagonal, and finite numbers")
        sigma = np.sqrt(np.diag(values))
        with np.errstate(over="ignore"):
            correlation = values / sigma[:, np.newaxis] / sigma
        if (np.abs(correlation) > 1.0 + MAX_EXCESS).any() or np.linalg.eigvalsh(correlation).min() < -MAX_EXCESS:
            raise ValueError("matrix has a correlation beyond 1: it is no covariance")
        if (np.abs(correlation - correlation.T) > MAX_ASYMMETRY).any():
            raise ValueError("matrix must be symmetric")

    @classmethod
    def of(cls, paths: Sequence[str], matrix: Array) -> Covariance:
        """Return that of an array, shape (n, n)."""
        even = 0.5 * matrix + 0.5 * matrix.T
        return cls(tuple(paths), tuple(tuple(row) for row in even.tolist()))

    @property
    def array(self) -> Array:
        """The matrix, shape (n, n)."""
        return np.array(self.matrix)

    def correlation(self, one: str, other: str) -> float:
        """Return the correlation of two numbers, by their paths."""
        i, j = self.paths.index(one), self.paths.index(other)
        return float(self.matrix[i][j] / np.sqrt(self.matrix[i][i] * self.matrix[j][j]))

    def among(self, paths: Collection[str]) -> Covariance | None:
        """Return that of those of its numbers that are among these paths; None if none is."""
        places = [place for place, path in enumerate(self.paths) if path in paths]
        if not places:
            return None
        return Covariance.of([self.paths[place] for place in places], self.array[np.ix_(places, places)])


@dataclass(frozen=True)
class Validation:
    """Error of a model on a file that it was identified from, every sample in the full band.

    Args:
        file: its name
        kind: of measurement, as `--kind` has it: `log`, `friction`, `torsion`
        channel: that is predicted
        unit: of all numbers but `delay`
        error: root mean square of measured less predicted by the model as it is saved, over the whole file
        varies: root mean square of the channel about its mean
        held_out: root mean square error on a stretch that took no part in the fit
        held_out_varies: root mean square of the channel about its mean there
        zero: constant part of the channel that the file contains, as the zero of a sensor
        delay: of the channel behind the motion [s]
        shares: of terms of other joints in the torque of the output, by name, as `cos(2 + 3)` [N.m]
        measured: smallest and largest value of what the file contains, by the names of `RANGES`

    Raises:
        ValueError: a text is no line of text, the unit is not known, a number is not finite, or a range is none

    >>> Validation("a.csv", "log", "current", "A", 0.1, 1.0, 0.1, 1.0, measured={"input_speed": (-90.0, 120.0)}).range_in_words
    'a.csv: input speed -90 to 120 rad/s; output torque, output angle, temperature not known'
    """

    file: str
    kind: str
    channel: str
    unit: str
    error: float
    varies: float
    held_out: float
    held_out_varies: float
    zero: float = 0.0
    delay: float = 0.0
    shares: Mapping[str, float] = field(default_factory=dict, hash=False)
    measured: Mapping[str, tuple[float, ...]] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        check_line("file", self.file)
        check_line("kind", self.kind)
        check_line("channel", self.channel)
        check_unit(self.unit)
        for name in ("error", "varies", "held_out", "held_out_varies"):
            arguments.bare_number(name, getattr(self, name), self.unit, brackets="[)", low=0.0)
        arguments.bare_number("zero", self.zero, self.unit)
        arguments.bare_number("delay", self.delay, "s")
        for name, share in self.shares.items():
            arguments.bare_number(f"share of {name}", share, "N.m")
        for name, ends in self.measured.items():
            unit = RANGES[arguments.one_of("the name of a range in measured", name, RANGES)]
            if len(ends) != 2 or not arguments.bare_number(name, ends[0], unit) <= arguments.bare_number(name, ends[1], unit):
                raise ValueError(f"measured: {name} = {shortened(ends)} must be its smallest and its largest value")

    @property
    def range_in_words(self) -> str:
        """The range over which the file was measured; empty if nothing of it is known."""
        if not self.measured:
            return ""
        ranges = [f"{_words(name)} {low:.3g} to {high:.3g} {RANGES[name]}" for name, (low, high) in self.measured.items()]
        missing = [_words(name) for name in RANGES if name not in self.measured]
        return f"{self.file}: {listed(ranges)}{f'; {listed(missing)} not known' if missing else ''}"

    @property
    def relative(self) -> float:
        """The larger of both errors over what the channel varies by there [1]."""
        pairs = ((self.error, self.varies), (self.held_out, self.held_out_varies))
        return max((error / varies for error, varies in pairs if varies > 0.0), default=0.0)


def _words(name: str) -> str:
    return name.replace("_", " ")


def check_identified(covariance: object, validation: object, paths: Collection[str]) -> None:
    """Raise an error if a covariance or validations are none, or if a covariance names what is no number of a set."""
    if covariance is not None and not isinstance(covariance, Covariance):
        raise TypeError(f"covariance must be a Covariance or None, not {shortened(covariance)}")
    if not isinstance(validation, tuple) or not all(isinstance(each, Validation) for each in validation):
        raise TypeError(f"validation must be a tuple of Validation, not {shortened(validation)}")
    if covariance is not None and (extra := set(covariance.paths) - set(paths)):
        raise ValueError(f"covariance names {unquoted(min(extra))}, which is no number of the set")


def read_covariance(content: Mapping[str, Any]) -> Covariance:
    """Return the covariance of a table of a file.

    Raises:
        ValueError: what is wrong in it
    """
    covariance = checked(_covariance_form(), content)
    return Covariance(tuple(covariance["numbers"]), tuple(map(tuple, covariance["matrix"])))


def read_validation(content: Sequence[Mapping[str, Any]]) -> tuple[Validation, ...]:
    """Return the validations of a list of tables of a file.

    Raises:
        ValueError: what is wrong in one of them
    """
    if len(content) > MAX_VALIDATIONS:
        raise ValueError(f"has {len(content)} tables; at most {MAX_VALIDATIONS} are read")
    tables = (checked(_validation_form(), each) for each in content)
    return tuple(Validation(**table | {"measured": _ranges(table["measured"])}) for table in tables)


def _ranges(content: Mapping[str, Sequence[float]]) -> dict[str, tuple[float, ...]]:
    return {name: tuple(ends) for name, ends in content.items()}


def covariance_table(covariance: Covariance) -> Any:
    """Return the table that `read_covariance` reads back."""
    import tomlkit

    table = tomlkit.table()
    numbers, rows = tomlkit.array().multiline(True), tomlkit.array().multiline(True)
    for path, row in zip(covariance.paths, covariance.matrix, strict=True):
        numbers.append(path)
        rows.append(list(row))
    table.add("numbers", numbers)
    table.add("matrix", rows)
    return table


def validation_tables(validation: Sequence[Validation]) -> Any:
    """Return the list of tables that `read_validation` reads back."""
    import tomlkit

    tables = tomlkit.aot()
    for each in validation:
        table = tomlkit.table()
        for name, value in vars(each).items():
            if name == "measured" and value:
                ranges = tomlkit.inline_table()
                ranges.update({name: list(ends) for name, ends in value.items()})
                table.add(name, ranges)
            elif value != {}:
                table.add(name, value)
        tables.append(table)
    return tables


@cache
def _covariance_form() -> Form:
    keys = {"numbers": (list[str], ...), "matrix": (list[list[float]], ...)}
    examples = {"numbers": 'numbers = ["load.inertia", …]', "matrix": "matrix = [[…], …]"}
    return Form("key of a covariance", schema("covariance", keys), examples)


@cache
def _validation_form() -> Form:
    text, number = {"file", "kind", "channel", "unit"}, {"zero": 0.0, "delay": 0.0}
    names = [each.name for each in fields(Validation) if each.name not in ("shares", "measured")]
    keys: dict[str, Any] = {name: (str if name in text else float, number.get(name, ...)) for name in names}
    keys |= {"shares": (dict[str, float], {}), "measured": (dict[str, list[float]], {})}
    examples = {name: f'{name} = "…"' if name in text else f"{name} = …" for name in names}
    examples |= {"shares": 'shares = {"cos(2 + 3)" = …}', "measured": "measured = {input_speed = [-90.0, 120.0]}"}
    return Form("key of a validation", schema("validation", keys), examples)
