"""Sweep of the misalignment of a wave generator: what each level does to torque, current and output of an actuator."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave.diagnose.actuator_ramp import ERROR_PATH, LOOPS, OUTPUT, RAMP_CHANNELS, ActuatorRamp
from strainwave.diagnose.inversion import M_PER_MICRON
from strainwave.files.recording import Recording
from strainwave.orders.order_spectrum import order_amplitudes
from strainwave.presentation import Presented
from strainwave.simulation.ensemble import Ensemble
from strainwave.typeset import ARCMIN_PER_RADIAN, fixed, number

Array = NDArray[np.float64]

RAD_PER_DEGREE = np.pi / 180.0
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
BOTH_LOOPS = ("e1", "beta")  # sweeps that are run with the loop on the motor encoder, too
SEEN_ORDERS = (1.0, 2.0, 4.0)
LOBES = {"single": "one lobe carries", "mean": "both lobes share", "max": "the outer lobe carries"}  # by `combine` of the law
TABLE_HEAD = ("error [′]", "torque [N·m]", "peak [1]", "current [mA]", "peak [1]", "output [′]")
MIN_TABLE_VALUE = 1e-3  # in the units of the table: nobody would measure less


@dataclass(frozen=True)
class SweepLevels(Presented):
    """Ramps over the levels of all sweeps, for one `combine` and one loop.

    Attributes:
        combine: how the lobes share
        loop: "output" or "input", where the position loop closes
        table: a row for each run, the first one straight. Columns: the numbers changed; half of the swing of the kinematic
            error (`error_swing`), and of the differences from the straight run (`torque_swing`, `current_swing`,
            `output_swing`); largest absolute value over that of the straight run (`torque_peak`, `current_peak`); the orders
            1, 2, 4 of the error and of the differences (`error_1`, …, `current_4`)
        rows: of each sweep

    >>> import strainwave as sw
    >>> columns = {"offset": [4e-3, 0.0, 2e-3, 8e-3], "error_swing": [0.0, 0.1, 1.0, 4.0]}
    >>> table = sw.Recording(columns, {"offset": "m", "error_swing": "rad"})
    >>> SweepLevels("single", "output", table, {"h": slice(1, 4)}).column("h", "error_swing").tolist()
    [0.1, 1.0, 4.0]
    """

    combine: str
    loop: str
    table: Recording
    rows: Mapping[str, slice]

    def column(self, sweep: str, name: str) -> Array:
        """Return a column of the table at the levels of a sweep."""
        return self.table[name][self.rows[sweep]]

    def cells(self, sweep: str) -> list[list[str]]:
        """Return a line for each level of the sweep "e1" or "beta": the level, and its effects in the units of `TABLE_HEAD`."""
        lines = []
        for place, level in enumerate(self.column(sweep, SWEEPS[sweep][0])):
            value = {name: float(self.column(sweep, name)[place]) for name in self.table.names}
            lines.append([
                f"e₁ = {number(level / M_PER_MICRON, 3)} µm" if sweep == "e1" else f"β₂ = {number(np.degrees(level), 2)}°",
                table_number(ARCMIN_PER_RADIAN * value["error_swing"], 3),
                table_number(value["torque_swing"], 3), fixed(value["torque_peak"], 3),
                table_number(1e3 * value["current_swing"], 3), fixed(value["current_peak"], 3),
                table_number(ARCMIN_PER_RADIAN * value["output_swing"], 2),
            ])  # fmt: skip
        return lines


def sweep_misalignment(ramp: ActuatorRamp, law: Any) -> SweepLevels:
    """Run a ramp over levels of each misalignment, without noise of the sensors: differences are those of the misalignment.

    Args:
        ramp: of the drive, with its position loop closed on either shaft. With the loop on the motor encoder only the sweeps
            of the housing, e_1 and beta, are run
        law: `Misalignment`, straight, as `wave_generator` returns it

    Raises:
        ValueError: a run fails, or does not follow the ramp

    >>> import strainwave as sw
    >>> ramp = ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=0.6, duration=2.0)
    >>> law, _ = sw.diagnose.wave_generator(ramp.drive)
    >>> levels = sweep_misalignment(ramp.closed_on("input"), law.replace(combine="single"))
    >>> swing = levels.column("e1", "current_swing")  # A, at eccentricities of 10 to 80 um
    >>> round(float(swing[1] / swing[0]), 1)
    2.0
    """
    changes, rows = _members(SWEEPS if ramp.loop == OUTPUT else BOTH_LOOPS)
    members = [{f"{ERROR_PATH}.{name}": value for name, value in change.items()} for change in changes]
    runs = ramp.without_noise().with_error(law).many(members, record=[*RAMP_CHANNELS, "kinematic_error"])
    effects = [_effect(ramp, runs, place) for place in range(len(changes))]
    names = dict.fromkeys(name for change in changes for name in change)
    columns = {name: [change.get(name, getattr(law, name)) for change in changes] for name in names}
    columns |= {name: [effect[name] for effect in effects] for name in effects[0]}
    units = {field["name"]: field["unit"] for field in law.fields if field["name"] in names}
    units |= {name: _unit(name) for name in effects[0]}
    return SweepLevels(law.combine, ramp.loop, Recording(columns, units), rows)


def _members(sweeps: Iterable[str]) -> tuple[list[dict[str, float]], dict[str, slice]]:
    """Return the changes of the straight law in each run of some sweeps, and the runs of each sweep."""
    changes: list[dict[str, float]] = [{}]
    rows = {}
    for sweep in sweeps:
        name, values, others = SWEEPS[sweep]
        rows[sweep] = slice(len(changes), len(changes) + len(values))
        changes += [{**others, name: value} for value in values]
    return changes, rows


def _effect(ramp: ActuatorRamp, runs: Ensemble, place: int) -> dict[str, float]:
    """Return the differences of a run from the straight one; names as the columns of `SweepLevels.table`."""
    straight, run = (ramp.settled(runs.member(each)) for each in (0, place))
    effect = {"error_swing": swing(run["kinematic_error"])}
    columns = {"input_angle": run["input_angle"], "error": run["kinematic_error"]}
    for name, column in (("torque", "torque"), ("current", "current"), ("output", "output_angle")):
        columns[name] = run[column] - straight[column]
        effect[f"{name}_swing"] = swing(columns[name])
    for name in ("torque", "current"):
        effect[f"{name}_peak"] = float(np.abs(run[name]).max() / np.abs(straight[name]).max())
    turning = Recording(columns, {name: "rad" if name == "input_angle" else _unit(name) for name in columns})
    for name in list(columns)[1:]:
        there = order_amplitudes(turning, name, SEEN_ORDERS)
        effect |= {f"{name}_{order:g}": float(size) for order, size in zip(SEEN_ORDERS, there.amplitude, strict=True)}
    return effect


def swing(values: Array) -> float:
    """Return half of the distance of the greatest from the least.

    >>> swing(np.array([1.0, 3.0, 2.0]))
    1.0
    """
    return 0.5 * float(np.ptp(values))


def _unit(name: str) -> str:
    """Return the unit of a column of the table of levels."""
    of, _, what = name.partition("_")
    return "1" if what == "peak" else {"torque": "N.m", "current": "A"}.get(of, "rad")


def table_number(value: float, digits: int) -> str:
    """Return a number of a table; one that nobody would measure as smaller than `MIN_TABLE_VALUE`.

    >>> table_number(0.0312, 2), table_number(1e-5, 2)
    ('0.031', '< 0.001')
    """
    return number(value, digits) if value >= MIN_TABLE_VALUE or value == 0.0 else f"< {MIN_TABLE_VALUE:g}"


def level_lines(found: Sequence[SweepLevels], sweep: str = "e1") -> list[str]:
    """Return a table of sweeps with the loop on one shaft as lines of text, a row for each level and way of sharing.

    >>> import strainwave as sw
    >>> ramp = ActuatorRamp.of(sw.load("tilt-actuator-lumped"), stroke=0.6, duration=2.0).closed_on("input")
    >>> law, _ = sw.diagnose.wave_generator(ramp.drive)
    >>> print(level_lines([sweep_misalignment(ramp, law.replace(combine="single"))])[2].partition(" carries")[0])
    e₁ = 20 µm, one lobe
    """
    rows = [[f"loop on the {LOOPS[found[0].loop]}", *TABLE_HEAD]]
    for levels in found:
        rows += [[f"{level}, {LOBES[levels.combine]}", *cells] for level, *cells in levels.cells(sweep)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        cells = [f"{cell:>{width}}" for cell, width in zip(row[1:], widths[1:], strict=True)]
        lines.append("  ".join([f"{row[0]:{widths[0]}}", *cells]).rstrip())
    return lines
