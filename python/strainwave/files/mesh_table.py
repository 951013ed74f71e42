"""Tables of finite elements and tooth-contact analyses: the mesh over wave-generator angle and load, and modes of the ring.

    angle [deg], torque [N.m], transmission_error [arcsec], stiffness [N.m/rad]       a row for each angle and load
    angle [deg], transmission_error 0 N.m [arcsec], transmission_error 20 N.m [arcsec]    a column for each load

In files of arrays (MAT, HDF5, NumPy), `transmission_error` may be a matrix with a row for each angle, and `torque` the load of
each of its columns.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import tau
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments, typeset
from strainwave.equality import ComparedByFields
from strainwave.files.array_table import ArrayTable
from strainwave.files.labels import Label, label_of
from strainwave.files.recording import Recording, recording_of
from strainwave.files.table_format import OpenTable
from strainwave.files.tables import open_table, read_table
from strainwave.files.units import convert, measures
from strainwave.messages import listed, one_line, quoted
from strainwave.presentation import Presented, Row, counted

Array = NDArray[np.float64]

QUANTITY_UNITS = {"transmission_error": "rad", "stiffness": "N.m/rad", "mesh_stiffness": "N/m"}
PLACE_UNITS = {"angle": "rad", "torque": "N.m"}
MODE_UNITS = {"frequency": "Hz", "waves": "1", "damping": "1", "mass": "kg", "shape_squared": "1/kg"}
MAX_MODES = 4  # of a ring
MAX_PAIR_GAP = 1e-3  # relative difference of the frequencies of the two shapes of a mode that travels, by the mesh of elements
MAX_LOADS = 1000  # columns of one quantity
_OF_LOAD = re.compile(
    rf"({'|'.join(QUANTITY_UNITS)})[\s_@=(]*([-+\u2212]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)[\s_]*([^\d\s()][^()]*?)\)?"
)
_IN_GROUP = re.compile(
    rf"(?:\w+\.)+(?=(?:{'|'.join([*PLACE_UNITS, *QUANTITY_UNITS, *MODE_UNITS])})(?![A-Za-z]))"
)  # as mesh.angle
_OF_MATRIX = re.compile(rf"({'|'.join(QUANTITY_UNITS)})_(\d+)")


@dataclass(frozen=True, eq=False)
class MeshTable(ComparedByFields, Presented):
    """Transmission error and stiffness over wave-generator angle and load, by finite elements or a tooth-contact analysis.

    A row is one static solution. Rows may have any order.

    Args:
        angle: of the wave generator [rad], shape (n,)
        torque: that the gear transmits to the output, positive if it drives the output forward [N.m], shape (n,)
        transmission_error: input angle / ratio - output angle, elastic twist included [rad], shape (n,); None if not computed
        stiffness: torsional stiffness of the gear at its output, dT / d(twist) [N.m/rad], shape (n,); None if not computed
        mesh_stiffness: of all engaged teeth along the line of action [N/m], shape (n,); None if not computed
        source: where it comes from, one line of text, as the name of the file

    Raises:
        ValueError: lengths differ, a number is not finite, a stiffness is not positive, no quantity is given, or two rows have
            one angle and one torque

    >>> import numpy as np
    >>> import strainwave as sw
    >>> angle = np.linspace(0.0, 2 * np.pi, 72, endpoint=False)
    >>> sw.files.MeshTable(angle, np.full(72, 20.0), transmission_error=1e-3 + 2e-4 * np.sin(2 * angle), source="by hand")
    <MeshTable: transmission_error at 72 angles from 0° to 355°, 1 load, 20 N·m; by hand>
    """

    angle: Array
    torque: Array
    transmission_error: Array | None = None
    stiffness: Array | None = None
    mesh_stiffness: Array | None = None
    source: str = "finite-element table"

    def __post_init__(self) -> None:
        arguments.text("source", self.source)
        for name in (*PLACE_UNITS, *self.quantities):
            object.__setattr__(self, name, _series(name, getattr(self, name)))
        if not self.quantities:
            raise ValueError(f"a table of a mesh needs one of {listed(QUANTITY_UNITS)}")
        for name in ("torque", *self.quantities):
            if len(getattr(self, name)) != len(self.angle):
                raise ValueError(f"{name} has {len(getattr(self, name))} rows, angle has {len(self.angle)}")
        for name in self.quantities & {"stiffness", "mesh_stiffness"}:
            if not (values := getattr(self, name)).min() > 0.0:
                row = int(np.argmin(values))
                raise ValueError(f"{name} is {values[row]:g} {QUANTITY_UNITS[name]} in row {row}; it must be positive")
        self._check_rows_differ()

    def _check_rows_differ(self) -> None:
        order = np.lexsort((self.angle, self.torque))
        same = (np.diff(self.angle[order]) == 0.0) & (np.diff(self.torque[order]) == 0.0)
        if same.any():
            first, second = sorted(order[int(np.argmax(same)) : int(np.argmax(same)) + 2].tolist())
            where = f"{np.degrees(self.angle[first]):g} deg and {self.torque[first]:g} N.m"
            raise ValueError(f"rows {first} and {second} are both at {where}; keep one of them")

    @property
    def quantities(self) -> set[str]:
        """Names of the quantities that the table contains."""
        return {name for name in QUANTITY_UNITS if getattr(self, name) is not None}

    @staticmethod
    def read(
        path: str | Path,
        columns: Mapping[str, str] | None = None,
        units: Mapping[str, str] | None = None,
        *,
        lever: float | None = None,
    ) -> MeshTable:
        """Read a table from a file of any format that `Recording.read` reads.

        Args:
            path: the file. Its columns are `angle`, `torque` and one or more of `transmission_error`, `stiffness` and
                `mesh_stiffness`, a row for each angle and load; or `angle` and a column for each load, as `transmission_error
                20 N.m`, or in files of arrays a matrix with `torque` of each of its columns
            columns: for each of these names, the name in the file, if it has another one
            units: unit of each column, by these names, if the file has none
            lever: pitch radius x cos(pressure angle) [m], for a mesh stiffness at the output's scale [N.m/rad]

        Raises:
            ValueError: a column or a unit is missing, a number is not finite, or as the class

        >>> import pathlib, tempfile
        >>> import strainwave as sw
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "mesh.csv")
        ...     header = "angle [deg],transmission_error 0 N.m [arcsec],transmission_error 20 N.m [arcsec]"
        ...     _ = path.write_text(f"{header}\\n0,0,120\\n90,30,140\\n180,0,121\\n270,-30,99\\n")
        ...     table = sw.files.MeshTable.read(path)
        >>> len(table.angle), float(table.torque[-1]), round(float(table.transmission_error[-1]), 6)
        (8, 20.0, 0.00048)
        """
        opened = open_table(path)
        wide = _loads_of_columns(opened, units or {})
        wanted = _wanted(opened, columns or {}, wide)
        series = _read(path, opened, wanted, {**(units or {}), **_units_of_loads(wide, units or {})})
        try:
            arm = None if lever is None else arguments.number("lever", lever, "m", low=0.0)
            rows = _stacked(series, wide, arm) if wide else {name: _values(series, name, name, arm) for name in series.names}
            return MeshTable(**rows, source=Path(path).name)
        except ValueError as error:
            raise ValueError(one_line(f"{path}: {error}")) from None

    def _headline(self) -> str:
        angles, loads = np.unique(self.angle), np.unique(self.torque)
        low, high = (f"{number:.4g}°" for number in np.degrees(angles[[0, -1]]))
        ends = [typeset.quantity(float(end), "N.m") for end in loads[[0, -1]]]
        span = ends[0] if len(loads) == 1 else " to ".join(ends)
        names = listed(name for name in QUANTITY_UNITS if name in self.quantities)
        return f"{names} at {len(angles)} angles from {low} to {high}, {counted(len(loads), 'load')}, {span}; {self.source}"

    def _rows(self) -> Iterator[Row]:
        for name, unit in {**PLACE_UNITS, **QUANTITY_UNITS}.items():
            if (values := getattr(self, name)) is not None:
                yield Row(name, (float(values.min()), float(values.max())), unit)


def _series(name: str, values: ArrayLike) -> Array:
    series = np.array(arguments.numbers(name, values))
    if series.ndim != 1 or not series.size:
        raise ValueError(f"{name} must be one series of at least one number; its shape is {series.shape}")
    if not np.isfinite(series).all():
        row = int(np.argmin(np.isfinite(series)))
        raise ValueError(f"{name} is {series[row]} in row {row}; it must be finite: leave out solutions that did not converge")
    series.setflags(write=False)
    return series


# ---- Columns ---------------------------------------------------------------------------------------------------------


class _Load(NamedTuple):
    """A column of one load: its quantity and the load [N.m]."""

    quantity: str
    torque: float


def _loads_of_columns(opened: OpenTable, units: Mapping[str, str]) -> dict[str, _Load]:
    """Return the load of each column that has one; empty if the table has a row for each angle and load."""
    loads = {label.name: load for label in opened.labels if (load := _load_in_name(label))}
    others = {label_of(_IN_GROUP.sub("", name)): values for name, values in getattr(opened, "others", {}).items()}
    torque = next(((label, values) for label, values in others.items() if label.name == "torque"), None)
    if torque is not None and isinstance(opened, ArrayTable):
        loads |= _loads_of_matrix(opened, *torque, units)
    if len(loads) > MAX_LOADS * len(QUANTITY_UNITS):
        raise ValueError(f"{opened.file} has columns of {len(loads)} loads; at most {MAX_LOADS} are read")
    return loads


def _load_in_name(label: Label) -> _Load | None:
    match = _OF_LOAD.fullmatch(label.name)
    if match is None or not measures(match[3], "N.m"):
        return None
    return _Load(match[1], convert(float(match[2].replace("\u2212", "-")), match[3], "N.m"))


def _loads_of_matrix(opened: ArrayTable, label: Label, torque: Array, units: Mapping[str, str]) -> dict[str, _Load]:
    """Return the load of each column of the matrices of a file of arrays."""
    unit = label.unit or units.get("torque")
    if unit is None:
        raise ValueError(f'{opened.file}: torque has no unit; give it with units={{"torque": "N.m"}}')
    values = convert(torque, unit, "N.m")
    loads = {}
    for name in (label.name for label in opened.labels):
        if (match := _OF_MATRIX.fullmatch(_IN_GROUP.sub("", name))) and 1 <= int(match[2]) <= len(values):
            loads[name] = _Load(match[1], float(values[int(match[2]) - 1]))
    return loads


def _wanted(opened: OpenTable, columns: Mapping[str, str], wide: Mapping[str, _Load]) -> dict[str, str]:
    """Return the column of the file for each name."""
    wanted = _given_or_there(opened, columns, [*PLACE_UNITS, *QUANTITY_UNITS], '{"transmission_error": "TE"}')
    there = listed(_names(opened))
    if both := [name for name in wanted if wide and name != "angle"]:
        raise ValueError(f"{opened.file} has columns of single loads and a column {both[0]}; leave one of the two out")
    for name, example in (("angle", "phi"), *(() if wide else (("torque", "load"),))):
        if name not in wanted:
            missing = f"{opened.file} has no column {name}; it has {there}; name it as columns={{{quoted(name)}: "
            more = ", or add it: 0 N.m of a table without load" if name == "torque" else ""
            raise ValueError(one_line(f"{missing}{quoted(example)}}}{more}"))
    if not wide and not set(wanted) & set(QUANTITY_UNITS):
        hint = 'name it as columns={"transmission_error": "TE"}'
        raise ValueError(one_line(f"{opened.file} has none of {listed(QUANTITY_UNITS)}; it has {there}; {hint}"))
    return wanted | {name: name for name in wide}


def _given_or_there(opened: OpenTable, columns: Mapping[str, str], known: Sequence[str], example: str) -> dict[str, str]:
    """Return the column of the file for each known name that is given or is its name in the file."""
    arguments.mapping("columns", columns, example)
    if unknown := [name for name in columns if name not in known]:
        raise ValueError(f"columns names {quoted(unknown[0])}, which is no column of such a table; they are {listed(known)}")
    there = _names(opened)
    return {name: there[name] for name in known if name in there} | dict(columns)


def _names(opened: OpenTable) -> dict[str, str]:
    """Return the name of each column in the file, by its name without that of the group or structure that contains it."""
    return {_IN_GROUP.sub("", label.name): label.name for label in opened.labels}


def _units_of_loads(wide: Mapping[str, _Load], units: Mapping[str, str]) -> dict[str, str]:
    return {name: units[load.quantity] for name, load in wide.items() if load.quantity in units}


def _read(path: str | Path, opened: OpenTable, wanted: Mapping[str, str], units: Mapping[str, str]) -> Recording:
    """Return the columns wanted."""
    there = {name: unit for name, unit in units.items() if name in wanted}
    return recording_of(path, read_table(opened, wanted, there))


def _values(series: Recording, name: str, quantity: str, lever: float | None) -> Array:
    """Return a column in SI units; a mesh stiffness at the output's scale by its lever."""
    if quantity != "mesh_stiffness" or not measures(series.unit(name), "N.m/rad"):
        return series.values(name, {**PLACE_UNITS, **QUANTITY_UNITS}[quantity])
    if lever is None:
        remedy = "give lever=pitch radius x cos(pressure angle) [m]"
        raise ValueError(
            f"column {quoted(name)} is in {series.unit(name)}, and along the line of action it is in N/m; {remedy}"
        )
    return np.asarray(series.values(name, "N.m/rad") / lever**2)


def _stacked(series: Recording, wide: Mapping[str, _Load], lever: float | None) -> dict[str, Any]:
    """Return the rows of a table that has a column for each load."""
    loads: dict[float, dict[str, str]] = {}
    for name, load in wide.items():
        of_load = loads.setdefault(load.torque, {})
        if load.quantity in of_load:
            raise ValueError(f"columns {quoted(of_load[load.quantity])} and {quoted(name)} are both at {load.torque:g} N.m")
        of_load[load.quantity] = name
    names = {load.quantity for load in wide.values()}
    for torque, of_load in loads.items():
        if missing := names - of_load.keys():
            raise ValueError(f"{min(missing)} is missing at {torque:g} N.m, where {min(of_load)} is there; add it")
    angle = series.values("angle", "rad")
    rows: dict[str, Any] = {"angle": np.tile(angle, len(loads)), "torque": np.repeat(np.array(list(loads)), len(angle))}
    for quantity in names:
        columns = [_values(series, of_load[quantity], quantity, lever) for of_load in loads.values()]
        rows[quantity] = np.concatenate(columns)
    return rows


# ---- Modes -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class ModeTable(ComparedByFields, Presented):
    """Modes of the flexspline's ring, as finite elements compute them.

    Args:
        frequency: natural frequency [Hz], shape (n,)
        waves: of the shape around the ring (nodal diameters), whole; 0 of a mode that does not travel, shape (n,)
        damping: damping ratio, as a share of the critical one [1], shape (n,)
        mass: modal mass at the mesh: one over the square of the mass-normalised shape's displacement along the line of action,
            mean over the engaged teeth [kg], shape (n,); of a mode that travels the squares of both shapes of its pair added
        source: where it comes from, one line of text, as the name of the file

    Raises:
        ValueError: lengths differ, a number is not finite or not positive, waves are not whole, or a damping is 1 or more

    >>> import strainwave as sw
    >>> sw.files.ModeTable(frequency=[1800.0, 5100.0], waves=[2, 3], damping=[0.01, 0.01], mass=[0.05, 0.04], source="by hand")
    <ModeTable: 2 modes from 1800 Hz to 5100 Hz; by hand>
    """

    frequency: Array
    waves: Array
    damping: Array
    mass: Array
    source: str = "finite-element table"

    def __post_init__(self) -> None:
        arguments.text("source", self.source)
        for name in ("frequency", "waves", "damping", "mass"):
            object.__setattr__(self, name, _series(name, getattr(self, name)))
            if len(getattr(self, name)) != len(self.frequency):
                raise ValueError(f"{name} has {len(getattr(self, name))} rows, frequency has {len(self.frequency)}")
        if not (self.waves == np.round(self.waves)).all() or self.waves.min() < 0.0:
            raise ValueError(f"waves must be whole numbers of 0 or more, not {listed(f'{count:g}' for count in self.waves)}")
        for name in ("frequency", "damping", "mass"):
            if not (values := getattr(self, name)).min() > 0.0:
                remedy = "leave rigid motions out" if name == "frequency" else "measure or assume it"
                raise ValueError(f"{name} is {values.min():g} in row {int(values.argmin())}; it must be positive: {remedy}")
        if not self.damping.max() < 1.0:
            raise ValueError(f"damping is {self.damping.max():g} in row {int(self.damping.argmax())}; it must be below 1")

    @property
    def compliance(self) -> Array:
        """Static compliance of each mode at the mesh, 1 / (mass x natural frequency squared) [m/N], shape (n,)."""
        return np.asarray(1.0 / (self.mass * (tau * self.frequency) ** 2))

    @property
    def joined(self) -> ModeTable:
        """The table with one row for a mode that travels, whose pair of shapes of equal frequency and waves may be two rows."""
        order = np.lexsort((self.frequency, self.waves))
        second = np.diff(self.waves[order], prepend=-1.0) == 0.0
        second &= np.diff(self.frequency[order], prepend=0.0) < MAX_PAIR_GAP * self.frequency[order]
        second &= self.waves[order] > 0.0
        for place in range(1, len(second)):
            second[place] &= not second[place - 1]
        mass = self.mass.copy()
        first = np.flatnonzero(second) - 1
        mass[order[first]] = 1.0 / (1.0 / mass[order[first]] + 1.0 / mass[order[first + 1]])
        kept = np.sort(order[~second])
        return ModeTable(self.frequency[kept], self.waves[kept], self.damping[kept], mass[kept], self.source)

    @property
    def ring(self) -> Any:
        """The ring of these modes for a `structure.Staged`, `sw.ring.Modes`; of many, those of the largest compliance."""
        from strainwave import ring

        modes = self.joined
        kept = modes._most_compliant
        return ring.Modes(
            natural_frequency=(tau * modes.frequency[kept]).tolist(),
            waves=modes.waves[kept].tolist(),
            damping=modes.damping[kept].tolist(),
            mass=modes.mass[kept].tolist(),
        )

    @property
    def remarks(self) -> list[str]:
        """In words, which rows `ring` joins, and which modes it leaves out."""
        modes, remarks = self.joined, []
        if pairs := len(self.frequency) - len(modes.frequency):
            remarks.append(f"{counted(pairs, 'pair')} of rows with equal waves and frequency joined to one mode each")
        rest = np.delete(np.arange(len(modes.frequency)), modes._most_compliant)
        if len(rest):
            share = typeset.percent(float(modes.compliance[rest].sum() / modes.compliance.sum()))
            names = listed(f"{frequency:.4g} Hz" for frequency in np.sort(modes.frequency[rest]))
            remarks.append(f"a ring has {MAX_MODES} modes; left out: {names}, with {share} of the compliance of all")
        return remarks

    @property
    def _most_compliant(self) -> NDArray[np.int_]:
        """Places of the modes of the largest compliance, in their order."""
        return np.sort(np.argsort(-self.compliance, kind="stable")[:MAX_MODES])

    @staticmethod
    def read(path: str | Path, columns: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None) -> ModeTable:
        """Read a table from a file of any format that `Recording.read` reads.

        Args:
            path: the file. Its columns are `frequency` [Hz or rad/s], `waves`, `damping`, and `mass` or `shape_squared`, the
                square of the mass-normalised shape's displacement along the line of action [1/kg]
            columns: for each of these names, the name in the file, if it has another one
            units: unit of each column, by these names, if the file has none; waves and damping need none

        Raises:
            ValueError: a column or a unit is missing, a number is not finite, or as the class
        """
        opened = open_table(path)
        wanted = _given_or_there(opened, columns or {}, [*MODE_UNITS], '{"waves": "ND"}')
        there = _names(opened)
        if ("mass" in wanted) == ("shape_squared" in wanted):
            raise ValueError(f"{opened.file} needs one of the columns mass and shape_squared; it has {listed(there)}")
        for name in ("frequency", "waves", "damping"):
            if name not in wanted:
                more = "; a model without damping has none: measure it, or assume 0.01" if name == "damping" else ""
                raise ValueError(one_line(f"{opened.file} has no column {name}; it has {listed(there)}{more}"))
        without_unit = {label.name for label in opened.labels if not label.unit}
        plain = {name: "1" for name in ("waves", "damping") if wanted[name] in without_unit}
        series = _read(path, opened, wanted, plain | dict(units or {}))
        try:
            angular = measures(series.unit("frequency"), "rad/s")
            values = {
                name: series.values(name, unit) for name, unit in MODE_UNITS.items() if name in wanted and name != "frequency"
            }
            values["frequency"] = series.values("frequency", "rad/s") / tau if angular else series.values("frequency", "Hz")
            if "shape_squared" in values:
                values["mass"] = 1.0 / _positive(values.pop("shape_squared"))
            return ModeTable(**values, source=Path(path).name)
        except ValueError as error:
            raise ValueError(one_line(f"{path}: {error}")) from None

    def _headline(self) -> str:
        ends = [typeset.quantity(float(end), "Hz") for end in (self.frequency.min(), self.frequency.max())]
        span = f" from {ends[0]} to {ends[1]}" if len(self.frequency) > 1 else f", {ends[0]}"
        return f"{counted(len(self.frequency), 'mode')}{span}; {self.source}"

    def _rows(self) -> Iterator[Row]:
        modes = zip(self.frequency, self.waves, self.damping, self.mass, strict=True)
        for number, (frequency, waves, damping, mass) in enumerate(modes, 1):
            of_shape = f"{counted(int(waves), 'wave')}, mass at the mesh {typeset.quantity(float(mass), 'kg')}"
            yield Row(f"mode {number}", float(frequency), "Hz", note=f"{of_shape}, damping ratio {damping:.3g}")


def _positive(shape_squared: Array) -> Array:
    if not shape_squared.min() > 0.0:
        row = int(shape_squared.argmin())
        raise ValueError(
            f"shape_squared is {shape_squared[row]:g} 1/kg in row {row}: a mode that does not move the mesh; leave it out"
        )
    return shape_squared
