"""Comparison of loops of several positions or units: their spread, and a test for differences."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import isnan, nan, pi
from typing import Literal

import numpy as np

from strainwave import arguments
from strainwave.presentation import Presented, Statement
from strainwave.rig.analysis.analysis import Definition, LoopAnalysis
from strainwave.rig.analysis.regimes import NAMES
from strainwave.rig.analysis.result import Result

SIGNIFICANCE_LEVEL = 0.05  # probability that a table of quantities shows any difference by chance [1]
By = Literal["position", "unit"]


@dataclass(frozen=True)
class ComparedQuantity(Statement):
    """One quantity of several groups of loops.

    Attributes:
        name: of the quantity
        unit: its unit
        groups: labels of the positions or units
        means: of each group, in `unit`
        counts: loops of each group
        spread: standard deviation of the means, in `unit`
        relative: spread over the mean of the means [1]
        by_stated: probability that the stated random errors alone make the means differ so much; not a number if not stated
        by_repeats: the same from the scatter of repeated loops; not a number unless every group has two or more
        level: below it a difference counts as significant, so that a whole table seldom shows one by chance
    """

    name: str
    unit: str
    groups: tuple[str, ...]
    means: tuple[float, ...]
    counts: tuple[int, ...]
    spread: float
    relative: float
    by_stated: float
    by_repeats: float
    level: float

    @property
    def probability(self) -> float:
        """Return the probability by repeats if there are some, since these contain all errors; else by the stated errors."""
        return self.by_stated if isnan(self.by_repeats) else self.by_repeats

    @property
    def significant(self) -> bool | None:
        """True if the groups differ; None if neither stated errors nor repeats determine it."""
        return None if isnan(self.probability) else self.probability < self.level

    def _headline(self) -> str:
        unit, scale = ("degrees", 180.0 / pi) if self.unit == "rad" else (self.unit, 1.0)
        low, high = (f"{scale * pick(self.means):#.4g}" for pick in (min, max))
        scatter = f"{self.name}: {low} to {high} {unit}, spread {100 * self.relative:.2g} %"
        if self.significant is None:
            return f"{scatter}; no errors are stated and nothing was repeated, so whether they differ is not known"
        basis = "stated errors" if isnan(self.by_repeats) else "scatter of repeats"
        verdict = "they differ" if self.significant else "no difference is shown"
        chance = "< 0.0001" if self.probability < 1e-4 else f"{self.probability:.2g}"
        return f"{scatter}; {verdict} (probability by the {basis} {chance})"


@dataclass(frozen=True)
class Comparison(Presented):
    """Loops compared by position or by unit.

    Attributes:
        by: what the groups are
        quantities: stiffness of each regime, widths, area
        remarks: what the comparison shows and what it does not

    >>> import numpy as np
    >>> import strainwave as sw
    >>> def measured(turn, position):  # a loop over a turn of the input [degrees]
    ...     angle, torque = np.radians([0.0, -4.5, -turn, 4.5 - turn, 0.0]), [0.36, 0.0, -0.36, 0.0, 0.36]
    ...     return sw.rig.analyse(sw.rig.Loop(angle, torque, side="input", name="", position=position, angle_sigma=1e-3))
    >>> found = sw.rig.compare([measured(59.0, 0.0), measured(56.0, np.radians(60.0))])
    >>> print(found.quantities[1])
    negative loading stiffness: 0.3785 to 0.4005 N.m/rad, spread 4 %; they differ (probability by the stated errors < 0.0001)
    """

    by: By
    quantities: tuple[ComparedQuantity, ...]
    remarks: tuple[str, ...]


def compare(analyses: Sequence[LoopAnalysis], by: By = "position", definition: Definition = "softest") -> Comparison:
    """Compare positions of one specimen, or units of one design.

    Errors that all loops share, such as that of the disk's radius, shift all alike and are left out. With repeated loops in
    every group, Welch's analysis of variance compares the means; without, the stated errors do, by chi-square.

    Args:
        analyses: two loops or more, of two positions or units at least
        by: what makes the groups
        definition: of the stiffnesses

    Returns:
        The mean of each group, the spread of the means, and the probability of such differences by chance, for each quantity.

    Raises:
        ValueError: there is only one group, loops are of different sides, or `by` is another

    Source:
        Welch1951

    >>> import numpy as np
    >>> import strainwave as sw
    >>> angle, torque = np.radians([0.0, -4.5, -59.0, -54.5, 0.0]), [0.36, 0.0, -0.36, 0.0, 0.36]
    >>> loops = [sw.rig.Loop(angle, torque, side="input", name=unit, unit=unit, angle_sigma=1e-3) for unit in "AB"]
    >>> found = sw.rig.compare([sw.rig.analyse(each) for each in loops], by="unit")
    >>> [(each.groups, each.significant) for each in found.quantities if each.name == "hysteresis"]
    [(('A', 'B'), False)]
    """
    arguments.one_of("by", by, ("position", "unit"))
    if len(sides := {each.loop.side for each in analyses}) > 1:
        raise ValueError(f"loops of {' and '.join(sorted(sides))} cannot be compared; refer them to one side first")
    keys = [_label(each, by) for each in analyses]
    groups = tuple(dict.fromkeys(keys))
    if len(groups) < 2:
        raise ValueError(f"{len(analyses)} loops of one {by} ({', '.join(groups)}) cannot be compared by {by}")
    members = [[each for each, key in zip(analyses, keys, strict=True) if key == group] for group in groups]
    known = [(name, take) for name, take in _quantities(definition) if all(take(each) is not None for each in analyses)]
    level = SIGNIFICANCE_LEVEL / max(1, len(known))
    compared = tuple(_compared(name, take, groups, members, level) for name, take in known)
    return Comparison(by, compared, tuple(_remarks(analyses, by)))


def _label(analysis: LoopAnalysis, by: By) -> str:
    return f"{np.degrees(analysis.loop.position):g}°" if by == "position" else analysis.loop.unit or "unnamed"


def _quantities(definition: Definition) -> Iterator[tuple[str, Callable[[LoopAnalysis], Result | None]]]:
    for name in NAMES:
        yield f"{name.replace('_', ' ')} stiffness", lambda each, name=name: each.stiffness_by(name, definition)  # type: ignore[misc]
    yield "hysteresis", lambda each: None if each.hysteresis is None else each.hysteresis.width
    yield "width at zero torque", lambda each: each.width_at_zero
    yield "energy lost in a cycle", lambda each: each.area


def _compared(
    name: str,
    take: Callable[[LoopAnalysis], Result | None],
    groups: tuple[str, ...],
    members: Sequence[Sequence[LoopAnalysis]],
    level: float,
) -> ComparedQuantity:
    results = [[found for each in group if (found := take(each)) is not None] for group in members]
    values = [np.array([found.value for found in group]) for group in results]
    means = np.array([float(each.mean()) for each in values])
    errors = np.array([np.sqrt(sum(found.random**2 for found in group)) / len(group) for group in results])
    spread = float(np.std(means, ddof=1))
    return ComparedQuantity(
        name,
        results[0][0].unit,
        groups,
        tuple(means.tolist()),
        tuple(map(len, values)),
        spread,
        spread / abs(float(means.mean())),
        by_chi_square(means, errors),
        by_welch(values),
        level,
    )


def by_chi_square(means: np.ndarray, errors: np.ndarray) -> float:
    """Probability that normal errors of these sizes alone make numbers differ as much; not a number where one is not known.

    >>> round(by_chi_square(np.array([0.0, 1.96 * 2.0**0.5]), np.array([1.0, 1.0])), 3)
    0.05
    """
    from scipy.special import chdtrc

    if not np.all(errors > 0.0):
        return nan
    weights = errors**-2.0
    middle = weights @ means / weights.sum()
    return float(chdtrc(len(means) - 1, weights @ (means - middle) ** 2))


def by_welch(groups: Sequence[np.ndarray]) -> float:
    """Probability by Welch's analysis of variance, whose groups may scatter differently.

    Args:
        groups: values of each; not a number is returned unless each has two or more that differ
    """
    from scipy.special import fdtrc

    counts = np.array([len(each) for each in groups])
    if counts.min() < 2:
        return nan
    variances = np.array([np.var(each, ddof=1) for each in groups])
    if not np.all(variances > 0.0):
        return nan
    weights, means, k = counts / variances, np.array([each.mean() for each in groups]), len(groups)
    middle = weights @ means / weights.sum()
    unequal = float(np.sum((1.0 - weights / weights.sum()) ** 2 / (counts - 1)))
    between = float(weights @ (means - middle) ** 2) / (k - 1)
    return float(fdtrc(k - 1, (k**2 - 1) / (3.0 * unequal), between / (1.0 + 2.0 * (k - 2) / (k**2 - 1) * unequal)))


def _remarks(analyses: Sequence[LoopAnalysis], by: By) -> Iterator[str]:
    units = {each.loop.unit for each in analyses}
    if by == "position" and len(units) == 1:
        yield "one specimen: the comparison does not show how far units of this design differ"
    if by == "position" and len(units) > 1:
        yield f"loops of {len(units)} units are mixed: what differs between positions may be a difference of units"
    if len({_label(each, by) for each in analyses}) == len(analyses):
        yield f"no {by} was tested twice: what differs may be what mounting and testing it again would change"
    positions = {each.loop.position for each in analyses}
    if by == "unit" and len(positions) > 1:
        yield f"loops of {len(positions)} positions are mixed: what differs between units may be a difference of positions"
