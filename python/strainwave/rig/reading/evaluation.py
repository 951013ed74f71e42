"""A whole torsion test, from folders of tests and files of loops: each loop analysed, and all compared."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import degrees, radians
from pathlib import Path
from typing import ClassVar

import numpy as np

from strainwave.files.gear_set import GearSet
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import recognise
from strainwave.presentation import Presented, Reported, counted
from strainwave.progress import Progress
from strainwave.rig.analysis.analysis import LoopAnalysis, analyse
from strainwave.rig.analysis.comparison import By, Comparison, compare
from strainwave.rig.analysis.sides import friction_at_rest, without_friction
from strainwave.rig.bench.setup import Rig
from strainwave.rig.bench.steps import Step
from strainwave.rig.bench.torque import Budget, angle_budget, stiffness_budget, torque_budget, torque_of_masses
from strainwave.rig.loop import Loop
from strainwave.rig.reading.measurement import PLAN, TorsionTest, read_test
from strainwave.rig.reading.recorded import read_loop
from strainwave.rig.vision.angle import Angles


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

    _report_module: ClassVar[str] = "strainwave.rig.report.files"

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
    steps = [step for step in found.steps if step.place == (loop.position, loop.unit)]
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


@dataclass(frozen=True)
class EvaluationOptions:
    """Options of `evaluate_paths` that the files of tests and loops do not contain; None if not given.

    Attributes:
        rig: instead of `rig.toml` of a test
        gear_set: the gear on the rig
        rated_torque: at the loaded shaft [N.m], instead of that of the gear
        reference: name of the photograph whose angle is 0
        friction: table of speed and torque of the input, whose friction is taken out of the loops
        positions: of the flexspline for each file of a loop [deg]
        columns, units: of files of loops, as `read_loop` takes them
    """

    rig: Rig | None = None
    gear_set: GearSet | None = None
    rated_torque: float | None = None
    reference: str | None = None
    friction: Path | None = None
    positions: Sequence[float] | None = None
    columns: Mapping[str, str] | None = None
    units: Mapping[str, str] | None = None


def evaluate_paths(paths: Sequence[Path], given: EvaluationOptions, progress: Progress = None) -> tuple[Evaluation, list[Path]]:
    """Read folders of tests and files of loops, and evaluate them together.

    Args:
        paths: folders and files
        given: what the files do not contain
        progress: as of `sw.simulate`

    Returns:
        What was found, and the files that were read for it, photographs left out.

    Raises:
        OSError: a file or folder is not there
        ValueError: one cannot be read, or what is given does not fit
    """
    tests, measured, read = _read(paths, given, progress)
    loops = measured
    if given.friction is not None:
        if given.gear_set is None:
            raise ValueError(f"friction {given.friction} needs a gear, whose law of friction is fitted to the table")
        table = recognise(given.friction, FileMapping(kind="friction")).recording
        friction = friction_at_rest(table, given.gear_set.gear)
        loops, read = [without_friction(loop, friction) for loop in measured], [*read, given.friction]
    planned = [test.deviations for test in tests if test.deviations is not None]
    found = evaluate(
        loops,
        name=" and ".join(path.resolve().name for path in paths),
        measured=measured,
        gear_set=given.gear_set,
        rated_torque=given.rated_torque,
        rig=tests[0].rig if len(tests) == len(paths) else None,
        steps=[step for test in tests for step in test.steps],
        angles=[angles for test in tests for angles in test.angles],
        remarks=[remark for test in tests for remark in test.remarks],
        deviations=[words for of_test in planned for words in of_test] if planned else None,
    )
    return found, read


def _read(
    paths: Sequence[Path], given: EvaluationOptions, progress: Progress
) -> tuple[list[TorsionTest], list[Loop], list[Path]]:
    if missing := [path for path in paths if not path.exists()]:
        raise FileNotFoundError(f"{missing[0]}: there is no such folder or file")
    files = [path for path in paths if not path.is_dir()]
    if files and (given.rig is not None or given.reference is not None):
        raise ValueError(f"rig and reference are for folders of tests; {files[0]} is no folder")
    if given.positions is not None and len(given.positions) != len(files):
        raise ValueError(f"there are {len(given.positions)} positions for {len(files)} files of loops; give one for each")
    places = iter(given.positions or [0.0] * len(files))
    tests: list[TorsionTest] = []
    loops: list[Loop] = []
    read: list[Path] = []
    for path in paths:
        if path.is_dir():
            if not (path / "steps.csv").exists():
                raise FileNotFoundError(
                    f"{path} holds no steps.csv, in which each step of a test has its masses and photograph"
                )
            if given.rig is None and not (path / "rig.toml").exists():
                raise FileNotFoundError(f"{path} holds no rig.toml; name the rig, as --rig couple-rig")
            tests.append(read_test(path, rig=given.rig, reference=given.reference, progress=progress))
            loops += tests[-1].loops
            read += [path / each for each in ("rig.toml", "steps.csv", PLAN) if (path / each).exists()]
        else:
            unit = path.stem if len(files) > 1 and given.positions is None else ""
            place = radians(next(places))
            loops.append(read_loop(path, columns=given.columns, units=given.units, position=place, unit=unit))
            read.append(path)
    return tests, loops, read
