"""A series of torsion tests in which something was varied: what was varied, and what each loop came to."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import exp
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.files.folder import inside
from strainwave.files.gear_file import at
from strainwave.files.recording import Recording
from strainwave.files.text_table import open_csv
from strainwave.files.units import convert
from strainwave.messages import listed, quoted
from strainwave.number_texts import NUMBER, number_in
from strainwave.presentation import Presented
from strainwave.rig.analysis.analysis import analyse
from strainwave.rig.analysis.regimes import RegimeName
from strainwave.rig.influence.trend import Design, Law, Trend, trends
from strainwave.rig.loop import MAX_SIZE, MIN_SIZE, Loop
from strainwave.rig.reading.recorded import read_loop
from strainwave.typeset import number, quantity

Array = NDArray[np.float64]


class Factor(NamedTuple):
    """A quantity that a series varies: its name, its unit, the law of its influence, and the change that a report states."""

    words: str
    unit: str
    law: Law
    step: float
    step_words: str


FACTORS = {
    "torque_max": Factor("torque level", "N.m", "power", 1.0, ""),
    "temperature": Factor("temperature", "K", "exponential", 10.0, "10 K"),
    "preload": Factor("bearing preload", "", "power", 1.0, ""),
    "ratio": Factor("reduction ratio", "1", "power", 1.0, ""),
    "modulus": Factor("elastic modulus", "", "power", 1.0, ""),
    "cycles": Factor("age in cycles", "1", "exponential", 1e6, "a million cycles"),
    "hours": Factor("age in hours", "h", "exponential", 1000.0, "1000 h"),
}
QUANTITIES = {
    "area": ("loop area", "J"),
    "width": ("loop width", "rad"),
    "stiffness": ("stiffness from peak to peak", "N.m/rad"),
    "high_stiffness": ("stiffness in unloading", "N.m/rad"),
    "low_stiffness": ("stiffness in loading", "N.m/rad"),
    "friction": ("friction", ""),
}
TEXTS = ("file", "unit")


@dataclass(frozen=True, eq=False)
class Series(ComparedByFields, Presented):
    """Loops measured one after the other, with what was varied between them.

    Args:
        factors: what was varied, by name of `FACTORS`, in its unit there, each shape (n,)
        quantities: what the loops came to, by name of `QUANTITIES`, each shape (n,)
        units: which specimen each is of, n texts
        name: where they come from

    Raises:
        ValueError: a name is not known, series differ in length or are not finite, or a factor whose law is a power is not
            positive

    >>> series = Series({"torque_max": [0.1, 0.2, 0.3, 0.4]}, {"area": [1.0, 4.1, 8.8, 16.3]})
    >>> (trend,) = analyse_series(series)
    >>> trend.significant, round(trend.slope.value, 1)
    (True, 2.0)
    """

    factors: Mapping[str, Array]
    quantities: Mapping[str, Array]
    units: tuple[str, ...] = ()
    name: str = ""
    files: tuple[Path, ...] = field(default=())

    def __init__(
        self,
        factors: Mapping[str, Sequence[float] | Array],
        quantities: Mapping[str, Sequence[float] | Array],
        units: Sequence[str] = (),
        name: str = "",
        files: Sequence[Path] = (),
    ) -> None:
        _known("factor", factors, FACTORS)
        _known("quantity", quantities, QUANTITIES)
        if not factors or not quantities:
            raise ValueError(
                f"a series needs a column that was varied ({listed(FACTORS)}) and one that was measured ({listed(QUANTITIES)})"
            )
        n = len(next(iter(factors.values())))
        for name_of, columns in (("factors", factors), ("quantities", quantities)):
            object.__setattr__(self, name_of, {each: _column(each, values, n) for each, values in columns.items()})
        if len(units) not in (0, n):
            raise ValueError(f"units names {len(units)} specimens for {n} measurements")
        object.__setattr__(self, "units", tuple(units) or ("",) * n)
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "files", tuple(files))

    def __len__(self) -> int:
        return len(self.units)

    @property
    def varied(self) -> dict[str, Array]:
        """The factors that did not stay the same."""
        return {name: values for name, values in self.factors.items() if np.ptp(values) > 0.0}


def _known(kind: str, names: Mapping[str, object], known: Mapping[str, object]) -> None:
    for name in names:
        if name not in known:
            raise ValueError(f"no {kind} {quoted(name)}; there are {listed(known)}")


def _column(name: str, values: Sequence[float] | Array, n: int) -> Array:
    column = np.array(values, float)
    if column.shape != (n,):
        raise ValueError(f"{name} has shape {column.shape}; all columns of the series must be of shape ({n},)")
    if not np.all(np.isfinite(column)):
        raise ValueError(f"{name} must be finite in every row")
    size = float(np.abs(column).max(initial=0.0))
    if size and not MIN_SIZE <= size <= MAX_SIZE:
        raise ValueError(f"{name}: the largest is {size:g}; it must be 0 or lie in [{MIN_SIZE:g}, {MAX_SIZE:g}]")
    if name in FACTORS and FACTORS[name].law == "power" and not np.all(column > 0.0):
        row = int(np.argmin(column))
        raise ValueError(f"{name} in row {row + 1} is {column[row]:g} {FACTORS[name].unit}; it must be positive")
    column.flags.writeable = False
    return column


def analyse_series(series: Series) -> list[Trend]:
    """Test each measured quantity for a dependence on each factor that was varied.

    Returns:
        A trend for each quantity and each factor that was varied.

    Raises:
        ValueError: nothing was varied, or there are too few measurements for a test

    >>> import strainwave as sw
    >>> series = sw.rig.Series({"temperature": [283.0, 293.0, 303.0, 313.0]}, {"friction": [1.25, 1.01, 0.79, 0.66]})
    >>> (trend,) = sw.rig.analyse_series(series)
    >>> trend.significant, round(100.0 * trend.slope.value, 2)  # percent per kelvin
    (True, -2.16)
    """
    if not series.varied:
        raise ValueError(f"in {series.name or 'the series'} nothing was varied: {listed(series.factors)} stayed the same")
    laws = {name: FACTORS[name].law for name in series.varied}
    return trends(Design(laws, series.varied, series.units), series.quantities)


# ---- From files -------------------------------------------------------------------------------------------------------


def read_series(path: str | Path) -> Series:
    """Read a table of a series: a row for each loop.

    Columns are those of `FACTORS`, which were varied, and of `QUANTITIES`, which were measured, each with its unit in brackets
    as `torque_max [N.m]`; `unit` names the specimen. With a column `file`, which names a file with the points of the loop in
    the folder of the table, area, width and stiffnesses are taken from it. Other columns are refused, but for `note`.

    Returns:
        Factors and quantities in SI units, shape (n,).

    Raises:
        ValueError: a file cannot be read, a column or a number in it is wrong, or a unit is none of its quantity

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "series.csv")
    ...     _ = path.write_text("temperature [degC],area [mJ],unit\\n20,3.1,a\\n40,2.9,a\\n")
    ...     read_series(path).factors["temperature"].tolist()
    [293.15, 313.15]
    """
    table = open_csv(path)
    names = [label.name for label in table.labels]
    if unknown := [name for name in names if name not in {*FACTORS, *QUANTITIES, *TEXTS, "note"}]:
        known = listed([*FACTORS, *QUANTITIES, *TEXTS])
        raise ValueError(f"{table.file} has a column {quoted(unknown[0])}, which no series has; there are {known}, note")
    numeric = [name for name in names if name in FACTORS or name in QUANTITIES]
    if not numeric:
        raise ValueError(f"{table.file} has no column of numbers; it needs what was varied: {listed(FACTORS)}")
    numbers = Recording.from_csv(path, columns={name: name for name in numeric})
    texts = {name: [cells[names.index(name)] for _, cells in table.texts()] for name in TEXTS if name in names}
    units = {name: FACTORS[name].unit if name in FACTORS else QUANTITIES[name][1] for name in numeric}
    values = {name: numbers.values(name, unit) if unit else numbers[name] for name, unit in units.items()}
    factors = {name: column for name, column in values.items() if name in FACTORS}
    quantities = {name: column for name, column in values.items() if name in QUANTITIES}
    with at(f"{path}:"):
        files = [inside(Path(path).parent, each) for each in texts.get("file", [])]
    measured = figures_of([read_loop(each) for each in files]) if files else {}
    quantities = {**{name: np.array(values) for name, values in measured.items()}, **quantities}
    return Series(factors, quantities, texts.get("unit", ()), Path(path).name, (Path(path), *files))


def series_of(loops: Sequence[str]) -> Series:
    """The series of loop files, each with what was varied: `"cold.csv,temperature=5 degC"`.

    Args:
        loops: for each loop its file, then factors by name; a number without a unit is in that of `FACTORS`

    Raises:
        ValueError: a text is not of this form, a file cannot be read, or a loop lacks a factor that another has

    >>> import tempfile
    >>> import strainwave as sw
    >>> loop = sw.rig.cycle_to(sw.load("csg-25-100"), 87.0)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     columns = {"twist": loop.angle, "torque": loop.torque}
    ...     sw.Recording(columns, {"twist": "rad", "torque": "N.m"}).to_csv(f"{folder}/cold.csv")
    ...     found = sw.rig.series_of([f"{folder}/cold.csv,temperature=5 degC"])
    >>> found.factors["temperature"].tolist(), list(found.quantities)[:3]
    ([278.15], ['area', 'width', 'stiffness'])
    """
    paths, conditions = zip(*[_with_condition(each) for each in loops], strict=True)
    names = list(dict.fromkeys(name for each in conditions for name in each))
    for path, each in zip(paths, conditions, strict=True):
        if missing := [name for name in names if name not in each]:
            raise ValueError(f"{path} has no {missing[0]}, which other loops have; give it as {missing[0]}=…")
    factors = {name: [each[name] for each in conditions] for name in names}
    return Series(factors, figures_of([read_loop(path) for path in paths]), name=f"{len(paths)} loops", files=paths)


def _with_condition(text: str) -> tuple[Path, dict[str, float]]:
    path, *conditions = [each.strip() for each in text.split(",")]
    condition = {}
    for each in conditions:
        found = re.fullmatch(rf"(\w+)\s*=\s*({NUMBER})\s*(\D.*)?", each)
        if found is None or found[1] not in FACTORS:
            raise ValueError(f"{quoted(each)} of the loop {path} must be name=number, with one of {listed(FACTORS)}")
        value, unit = number_in(found[2]), FACTORS[found[1]].unit
        condition[found[1]] = convert(value, found[3], unit) if found[3] and unit else value
    return Path(path), condition


def figures_of(loops: Sequence[Loop]) -> dict[str, list[float]]:
    """Area [J], width [rad] and stiffnesses [N.m/rad] of loops: from peak to peak, and of the four regimes by regression.

    The mean of their compliances represents the two regimes of unloading, and likewise the two of loading.

    Raises:
        ValueError: a loop does not close, so that it has no area, or it lacks a regime that others have
    """
    found = [_figures(loop) for loop in loops]
    names = dict.fromkeys(name for each in found for name in each)
    for loop, each in zip(loops, found, strict=True):
        if missing := [name for name in names if name not in each]:
            raise ValueError(f"{loop.name}: the loop does not determine its {QUANTITIES[missing[0]][0]}, which other loops do")
    return {name: [each[name] for each in found] for name in names}


REGIMES: dict[str, tuple[RegimeName, RegimeName]] = {
    "high_stiffness": ("positive_unloading", "negative_unloading"),
    "low_stiffness": ("negative_loading", "positive_loading"),
}


def _figures(loop: Loop) -> dict[str, float]:
    analysis = analyse(loop)
    if analysis.area is None or analysis.hysteresis is None:
        raise ValueError(f"{loop.name}: the loop does not run from peak to peak and back, so it has no area")
    rows = analysis.cut.cycle
    figures = {
        "area": analysis.area.value,
        "width": analysis.hysteresis.width.value,
        "stiffness": float(np.ptp(loop.torque[rows]) / np.ptp(loop.angle[rows])),
    }
    for name, regimes in REGIMES.items():
        both = [analysis.stiffness_by(each, "regression") for each in regimes]
        slopes = [each.value for each in both if each is not None]
        if len(slopes) == len(regimes):
            figures[name] = float(1.0 / np.mean(1.0 / np.array(slopes)))
    return figures


def trend_words(trend: Trend) -> str:
    """Return a trend in one sentence, with its interval and its probabilities.

    >>> import strainwave as sw
    >>> series = sw.rig.Series({"torque_max": [0.1, 0.2, 0.3, 0.4]}, {"area": [1.0, 4.1, 8.8, 16.3]})
    >>> print(sw.rig.trend_words(*sw.rig.analyse_series(series)).partition(" (")[0])
    loop area goes with the power 2 of the torque level, 95 %: 1.89 to 2.11
    """
    name, factor = QUANTITIES[trend.quantity][0], FACTORS[trend.factor]
    if not np.isfinite(trend.slope.value):
        return (
            f"{name}: {factor.words} changed along with {_factors(trend.together_with)}, so their effects cannot be separated."
        )
    change = change_of(trend)
    found = f"{name} {change}" if trend.significant else f"{name}: no significant effect of {factor.words}; it {change}"
    others = [chance(p).removeprefix("= ") for p in (trend.corrected, trend.shuffled)]
    tests = f"p {chance(trend.slope.p)}; {others[0]} for all tests together; {others[1]} by shuffling; {trend.points} loops"
    warning = f"; changed along with {_factors(trend.together_with)}, whose effect it may be" if trend.together_with else ""
    return f"{found} ({tests}){warning}{bent_words(trend)}."


def bent_words(trend: Trend) -> str:
    """Return the evidence of repeated conditions against the law in words; empty if there is none."""
    if not trend.bent:
        return ""
    scattered = f"loops at equal conditions scatter less than they lie from this law (p {chance(trend.misfit)})"
    return f"; {scattered}: the law is not that of the measurements"


def chance(p: float) -> str:
    """Return a probability with its sign of equality.

    >>> chance(0.0312), chance(2e-9)
    ('= 0.031', '< 0.0001')
    """
    return f"= {number(p, 2)}" if p >= 1e-4 else "< 0.0001"


def _factors(names: tuple[str, ...]) -> str:
    return " and ".join(FACTORS[each].words for each in names)


def change_of(trend: Trend) -> str:
    """Return the coefficient of a trend with its interval, in words."""
    factor, (low, high) = FACTORS[trend.factor], trend.interval
    if trend.law == "power":
        return (
            f"goes with the power {number(trend.slope.value, 3)} of the {factor.words}, "
            f"95 %: {number(low, 3)} to {number(high, 3)}"
        )
    if trend.law == "linear":
        unit, step = QUANTITIES[trend.quantity][1] or "1", factor.step
        ends = " to ".join(quantity(step * end, unit) for end in (low, high))
        return f"changes by {quantity(step * trend.slope.value, unit)} per {factor.step_words or factor.unit}, 95 %: {ends}"
    relative = [percent(exp(factor.step * each) - 1.0, 3) for each in (trend.slope.value, low, high)]
    return f"changes by {relative[0]} per {factor.step_words}, 95 %: {relative[1]} to {relative[2]}"


def percent(share: float, digits: int = 2) -> str:
    """Return a share in per cent."""
    return f"{number(100.0 * share, digits)} %"
