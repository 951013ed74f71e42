"""A whole torsion test: the loops of its positions and units, each analysed, and all compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import degrees

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.presentation import Presented, Reported, counted
from strainwave.rig.analysis.analysis import LoopAnalysis, analyse
from strainwave.rig.analysis.comparison import By, Comparison, compare
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step
from strainwave.rig.loop import Loop
from strainwave.rig.running.watching import torque_of_masses
from strainwave.rig.torque.budget import Budget, angle_budget, stiffness_budget, torque_budget
from strainwave.rig.vision.follow import Angles


@dataclass(frozen=True, eq=False)
class Evaluation(Presented, Reported):
    """Result of a test.

    Attributes:
        name: of the test
        analyses: of each loop, in the order measured
        measured: the loops as they were before friction of the input was taken out; the analysed ones if none was
        comparisons: of positions and of units, where there are several
        gear_set: the gear that was taken to be on the rig, or None
        rig: on which it was tested, or None where loops were given as they are
        steps: as made
        angles: of the photographs, of each position and unit
        remarks: what holds for the whole test, in words
        deviations: where the steps depart from their plan, in words; None where no plan is known
    """

    name: str
    analyses: tuple[LoopAnalysis, ...]
    measured: tuple[Loop, ...]
    comparisons: tuple[Comparison, ...]
    gear_set: GearSet | None = None
    rig: Rig | None = None
    steps: tuple[Step, ...] = ()
    angles: tuple[Angles, ...] = ()
    remarks: tuple[str, ...] = ()
    deviations: tuple[str, ...] | None = None

    @property
    def loops(self) -> tuple[Loop, ...]:
        """The loops, in the order measured."""
        return tuple(each.loop for each in self.analyses)

    @property
    def labels(self) -> tuple[str, ...]:
        """Return the label of each loop: unit, position of the flexspline and, if several are alike, a number."""
        return tuple(_labels(self.loops))

    def _headline(self) -> str:
        return f"{self.name}, {counted(len(self.analyses), 'loop')}"


def evaluate(
    loops: Sequence[Loop],
    *,
    name: str = "Torsion test",
    measured: Sequence[Loop] | None = None,
    gear_set: GearSet | None = None,
    rated_torque: float | None = None,
    rig: Rig | None = None,
    steps: Sequence[Step] = (),
    angles: Sequence[Angles] = (),
    remarks: Sequence[str] = (),
    deviations: Sequence[str] | None = None,
) -> Evaluation:
    """Analyse the loops of a test, and compare positions and units.

    Args:
        loops: one or more
        name: of the test
        measured: the loops before friction of the input was taken out; if not given, these
        gear_set: the gear on the rig: its ratio, rated torque and catalogue figures
        rated_torque: of the gear at the loaded shaft [N.m], instead of that of the set
        rig, steps, angles: what the loops were made from, for the report
        remarks: what holds for the whole test, in words
        deviations: where the steps depart from their plan, in words; None where no plan is known

    Raises:
        ValueError: there is no loop, or one cannot be analysed

    >>> loop = Loop([3.0, 2.0, -3.0, -2.0, 3.0], [1.0, 0.0, -1.0, 0.0, 1.0], side="output", name="example")
    >>> evaluate([loop]).labels
    ('Flexspline at 0°',)
    """
    if not loops:
        raise ValueError("loops: a test needs one loop or more")
    analyses = tuple(analyse(loop, gear_set=gear_set, rated_torque=rated_torque) for loop in loops)
    compared = tuple(_comparisons(analyses))
    departed = None if deviations is None else tuple(deviations)
    before = tuple(loops if measured is None else measured)
    return Evaluation(name, analyses, before, compared, gear_set, rig, tuple(steps), tuple(angles), tuple(remarks), departed)


def _labels(loops: Sequence[Loop]) -> Iterator[str]:
    plain = [f"{f'Unit {loop.unit}, f' if loop.unit else 'F'}lexspline at {degrees(loop.position):.6g}°" for loop in loops]
    for place, label in enumerate(plain):
        yield f"{label}, no. {plain[: place + 1].count(label)}" if plain.count(label) > 1 else label


def _comparisons(analyses: Sequence[LoopAnalysis]) -> Iterator[Comparison]:
    groups: dict[By, int] = {
        "position": len({each.loop.position for each in analyses}),
        "unit": len({each.loop.unit for each in analyses}),
    }
    for by, count in groups.items():
        if count > 1 and len({each.loop.side for each in analyses}) == 1:
            yield compare(analyses, by)


def budgets(found: Evaluation, analysis: LoopAnalysis) -> list[Budget]:
    """Uncertainty budgets of a loop: torque and angle at its positive peak, and the stiffness of each regime.

    Args:
        found: the test, with its rig and its steps
        analysis: of one of its loops

    Returns:
        Nothing where there is no rig, or the torque was measured otherwise.
    """
    loop = analysis.loop
    steps = [step for step in found.steps if (step.position, step.unit) == (loop.position, loop.unit)]
    if found.rig is None or not steps or any(step.torque is not None for step in steps):
        return []
    peak = max(steps, key=lambda step: step.mass_positive - step.mass_negative)
    reading = float(np.median(loop.angle_sigma))
    torque = torque_budget(found.rig, peak)
    turned = float(np.ptp(loop.angle))
    made = [torque, replace(angle_budget(found.rig, turned, reading, torque, loop.angle_scale), quantity="angle")]
    for each in analysis.stiffnesses:
        sign = 1.0 if each.name.startswith("positive") else -1.0
        low, high = sorted(sign * value for value in each.segments.stretch(each.segments.softest))
        within = [step for step in steps if low - 1e-9 <= sign * torque_of_masses(found.rig, step) <= high + 1e-9]
        if len({step.mass_positive - step.mass_negative for step in within}) > 1 and each.softest.value > 0.0:
            budget = stiffness_budget(found.rig, each.softest.value, within, angle_sigma=reading, angle_scale=loop.angle_scale)
            made.append(replace(budget, quantity=f"stiffness, {each.name.replace('_', ' ')}"))
    return made
