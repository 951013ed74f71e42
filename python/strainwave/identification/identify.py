"""Any mixture of files in; what each of them is, what it tells, and the gear that they tell together out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from strainwave import kinematics
from strainwave.files.entries import Entry
from strainwave.files.folder import LINK_NOT_FOLLOWED
from strainwave.files.gear_set import GearSet
from strainwave.files.tables import FORMATS
from strainwave.identification.kinds import constant_speed_runs
from strainwave.identification.kinds.constant_speed_runs import Run, run_of
from strainwave.identification.kinds.fit_file import fitted
from strainwave.identification.kinds.plausibility import other_format
from strainwave.identification.reading.consistent import consistent
from strainwave.identification.reading.duplicates import same_as
from strainwave.identification.reading.joined_recordings import joined
from strainwave.identification.reading.kind import Kind
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, check_one_joint, recognise
from strainwave.identification.reading.source import BAG, MeasurementFile, MeasurementFiles, measurement_files
from strainwave.identification.results.file_result import CombinedParameter, FileResult, combine
from strainwave.identification.results.gear_so_far import GearSoFar, plain
from strainwave.messages import listed, shortened

# What is needed to understand a file comes before it: friction before a loop that has it inside, both before logs, and what
# happens at rest after what tells friction that slides.
TURNS: dict[Kind, int] = {
    "friction": 0, "effort": 0, "torsion": 2, "encoders": 4, "log": 5, "presliding": 6, "breakaway": 7,
}  # fmt: skip
RUNS = 1  # records at constant speed, all together
ALIKE = 1e-9  # relative: two ratios that are one


@dataclass(frozen=True)
class Identified:
    """What files tell of a gear.

    Attributes:
        start: the set it started from
        files: each file with what it tells, in the order given; then what several files tell only together
        parameters: every number determined: the mean of the files that agree about it
        gear_set: the set with the laws of the files that tell them best, and their numbers
    """

    start: GearSet
    files: tuple[FileResult, ...]
    parameters: tuple[CombinedParameter, ...]
    gear_set: GearSet


def identify(
    start: GearSet | str | Path,
    files: Sequence[str | Path] | MeasurementFiles,
    *,
    mapping: Callable[[Path], FileMapping] | None = None,
    accept: bool = False,
    progress: Callable[[str], None] = lambda stage: None,
) -> Identified:
    """Finds out what files of measurements are, fits each, and puts together what they tell of one gear.

    Args:
        start: the set to start from: a set, the name of one in the catalogue, or the path of a gear file
        files: tables of friction, torsion loops, logs of the drive, records of two encoders, records at constant speed,
            friction at rest, in any format and order; of a folder all files that may be such
        mapping: what a person says of a file, where it says it not itself
        accept: whether tables and loops are used in spite of doubts about their sizes
        progress: called with the name of each file as its turn comes

    Returns:
        what each file tells, and the gear

    Raises:
        TypeError: `files` are no paths, or `mapping` is no function
        ValueError: no file, or none of which anything can be found; a file alone that cannot be used is told in its finding

    >>> import tempfile
    >>> import numpy as np
    >>> import strainwave as sw
    >>> speed = np.array([2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0])
    >>> columns = {"speed": speed, "torque": 0.05 + 3e-4 * speed + 1e-4 * np.array([1, -1, 0, 1, -1, 1, 0])}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sw.Recording(columns, {"speed": "rad/s", "torque": "N.m"}).to_csv(f"{folder}/table.csv")
    ...     found = identify("hfuc-25-100", [f"{folder}/table.csv"])
    >>> found.files[0].recognised.kind, round(found.gear_set.gear.friction_input.coulomb, 2)
    ('friction', 0.05)
    """
    check_arguments(files, mapping)
    opened = measurement_files(files)
    each_read = {file.path: _recognised(file, mapping) for file in opened.files}
    in_one_reading = consistent(_only_read(each_read), {file.path: file for file in opened.files})
    each_read |= {each.path: _unless_asked(each) for each in in_one_reading}
    for link in opened.links:
        each_read.setdefault(link, FileResult(link.name, refused=LINK_NOT_FOLLOWED))
    check_one_joint(_only_read(each_read))
    recognised = joined(_only_read(each_read))
    whole = {each.path: each for each in recognised}
    read = {path: whole.get(path, each) for path, each in each_read.items() if path in whole or isinstance(each, FileResult)}
    start = _with_ratio_of_all(start if isinstance(start, GearSet) else GearSet.read(start), recognised)
    found = _Found(GearSoFar(start, accept=accept), same_as(recognised), mapping)
    runs = list(found.runs(recognised))
    steady = {run.file.path for run in runs}
    for turn in range(max(TURNS.values()) + 1):
        if turn == RUNS and runs:
            progress(constant_speed_runs.JOINED)
            found.take_runs(runs)
        for file in sorted(recognised, key=_friction_inside):
            if file.path not in steady and file.path not in found.findings and TURNS[file.kind] == turn:
                progress(file.path.name)
                found.take(file)
    found.take_turns(runs)
    own = [each if isinstance(each, FileResult) else found.findings[each.path] for each in read.values()]
    findings = (*_named_apart(own, list(read), found.copies), *found.together)
    numbers = combine(findings)
    if not numbers:
        raise ValueError(f"no file tells anything of the gear: {'; '.join(map(_why_nothing, findings))}")
    return Identified(start, findings, numbers, with_means(found.known, numbers))


def check_arguments(files: object, mapping: object) -> None:
    """Refuses what are no files, and no function that says something of them."""
    is_opened = isinstance(files, MeasurementFiles)
    if not is_opened and (not isinstance(files, list | tuple) or not all(isinstance(each, str | Path) for each in files)):
        raise TypeError(f"files must be a list of paths, not {shortened(files)}")
    if mapping is not None and not callable(mapping):
        raise TypeError(f"mapping must be a function that takes a path, not {shortened(mapping)}")
    if not files:
        raise ValueError("identify needs at least one file of measurements")


def _why_nothing(finding: FileResult) -> str:
    """Why a file tells no number."""
    if finding.refused or finding.part_of:
        return f"{finding.name}: {finding.refused or f'a part of the {finding.part_of}'}"
    whys = dict.fromkeys(told.why for told in finding.estimates if told.why)
    fitted = f"{finding.model} was fitted, but {'; '.join(whys)}" if whys else "nothing was fitted"
    return f"{finding.name}: {fitted}; see whether columns, units and sides are what they are taken for"


class _Found:
    """What is found, file by file."""

    def __init__(self, known: GearSoFar, copies: Mapping[str, str], said: Callable[[Path], FileMapping] | None) -> None:
        self.known, self.copies, self.said = known, copies, said
        self.findings = dict[Path, FileResult]()
        self.together = list[FileResult]()

    def take(self, file: Recognised) -> None:
        """Fits a file; one that shows what another one shows tells its numbers, and changes nothing of the gear."""
        file = file.at_ratio(_with_ratio(self.known, file).gear_set.gear.kinematics.ratio)
        side = self.said(file.path).side if self.said is not None else None
        before = replace(_with_ratio(self.known, file), side=side)
        try:
            found, after = fitted(file, before)
        except (ValueError, FloatingPointError) as error:
            found, after = FileResult(file.path.name, file, refused=_without_name(str(error), file.path)), before
        self.findings[file.path] = found
        if str(file.path) not in self.copies:
            self.known = _with_kinematics(after, self.known.gear_set)

    def runs(self, files: Sequence[Recognised]) -> Iterator[Run]:
        """Those files that are records at constant speed; copies of others left out."""
        for file in files:
            if file.kind in ("effort", "log"):
                try:
                    run = run_of(file, _with_ratio(self.known, file))
                except ValueError as error:
                    self.findings[file.path] = FileResult(file.path.name, file, refused=str(error))
                    continue
                if run is not None:
                    self.findings[file.path] = constant_speed_runs.of_run(run)
                    if str(file.path) not in self.copies:
                        yield run

    def take_runs(self, runs: Sequence[Run]) -> None:
        """The friction table that records at constant speed are together."""
        try:
            table, self.known = constant_speed_runs.joined(runs, self.known)
        except (ValueError, FloatingPointError) as error:
            table = FileResult(constant_speed_runs.JOINED, refused=str(error))
        self.together.append(table)

    def take_turns(self, runs: Sequence[Run]) -> None:
        """Friction over the angle, where records at constant speed tell it."""
        try:
            if (found := constant_speed_runs.over_the_angle(runs, self.known)) is not None:
                self.together.append(found[0])
                self.known = found[1]
        except (ValueError, FloatingPointError) as error:
            self.together.append(FileResult("friction over the angle", refused=str(error)))


def _named_apart(findings: Sequence[FileResult], paths: Sequence[Path], copies: Mapping[str, str]) -> tuple[FileResult, ...]:
    """The findings by the names of their files; with their folders, where names come twice."""
    names = [path.name if sum(path.name == each.name for each in paths) == 1 else str(path) for path in paths]
    by_path = dict(zip(map(str, paths), names, strict=True))
    return tuple(
        replace(each, name=name, same_as=by_path.get(copies.get(str(path), ""), ""))
        for each, name, path in zip(findings, names, paths, strict=True)
    )


def _friction_inside(file: Recognised) -> bool:
    """Whether it is a loop at the input: one at the output tells the hysteresis by itself, and goes first."""
    return file.kind == "torsion" and "input_angle" in file.recording


def _recognised(file: MeasurementFile, mapping: Callable[[Path], FileMapping] | None) -> Recognised | FileResult:
    path = file.path
    if path.is_dir() and not Path(path, BAG).is_file():
        known = listed(f"*{suffix}" for suffix in FORMATS)
        return FileResult(path.name, refused=f"the folder holds no file that may be a measurement, as {known}")
    if other := other_format(path):
        return FileResult(path.name, refused=other)
    try:
        return recognise(file, mapping(path) if mapping is not None else None)
    except (ValueError, OSError) as error:
        return FileResult(path.name, refused=_without_name(str(error), path))


def _only_read(files: Mapping[Path, Recognised | FileResult]) -> list[Recognised]:
    return [each for each in files.values() if isinstance(each, Recognised)]


def _unless_asked(file: Recognised) -> Recognised | FileResult:
    """A file, or its question if nothing determines how to read it."""
    if not file.question:
        return file
    return FileResult(file.path.name, file, refused=_without_name(file.question, file.path))


def _without_name(told: str, path: Path) -> str:
    """What is told of a file, without its name before it, as the name is told beside it."""
    for name in (str(path), path.name):
        for end in (": ", " "):
            told = told.removeprefix(name + end)
    return told


# ---- The ratio ---------------------------------------------------------------------------------------------------------


def _with_ratio_of_all(start: GearSet, files: Sequence[Recognised]) -> GearSet:
    """The set with the ratio that a person gave with all files."""
    ratios = {file.constants.get("ratio") for file in files}
    if len(ratios) != 1 or (ratio := ratios.pop()) is None:
        return start
    gear = _geared(start.gear, ratio)
    if gear is start.gear:
        return start
    sources = {path: entry for path, entry in start.sources.items() if not path.startswith("gear.kinematics.")}
    numbers = [field["name"] for field in gear.kinematics.fields if field["kind"] != "choice"]
    given = {f"gear.kinematics.{name}": Entry("ratio given with the files") for name in numbers}
    return replace(start, gear=gear, sources=sources | given)


def _with_ratio(known: GearSoFar, file: Recognised) -> GearSoFar:
    """What is known, with the ratio that a person gave with this file."""
    if "ratio" not in file.constants:
        return known
    gear = _geared(known.gear_set.gear, file.constants["ratio"])
    return known if gear is known.gear_set.gear else replace(known, gear_set=replace(known.gear_set, gear=gear))


def _with_kinematics(known: GearSoFar, of: GearSet) -> GearSoFar:
    if known.gear_set.gear.kinematics == of.gear.kinematics:
        return known
    gear = known.gear_set.gear.replace(kinematics=of.gear.kinematics)
    return replace(known, gear_set=replace(known.gear_set, gear=gear))


def _geared(gear: Any, ratio: float) -> Any:
    """The gear with another ratio; its output turns the same way as before."""
    if abs(abs(ratio) - abs(gear.kinematics.ratio)) < ALIKE * abs(ratio):
        return gear
    return gear.replace(kinematics=_kinematics(ratio, gear.kinematics.ratio < 0.0))


def _kinematics(ratio: float, backwards: bool) -> Any:
    """A strain wave gear of this ratio, where whole teeth give it; else what has the ratio alone."""
    size = abs(ratio)
    if abs(size - round(size)) > ALIKE * size or round(size) < 2:
        return kinematics.PlainRatio(reduction=size)
    turns = 2 * round(size)  # two teeth fewer on the flexspline
    if backwards or ratio < 0.0:
        return kinematics.StrainWave(flexspline_teeth=turns, circular_spline_teeth=turns + 2, fixed="circular_spline")
    return kinematics.StrainWave(flexspline_teeth=turns - 2, circular_spline_teeth=turns, fixed="flexspline")


# ---- Means -------------------------------------------------------------------------------------------------------------


def with_means(known: GearSoFar, numbers: Sequence[CombinedParameter]) -> GearSet:
    """The set with the means of files that agree, where it has the law that the number belongs to."""
    gear_set = known.gear_set
    for number in numbers:
        if len(number.mean_of) < 2 or not number.estimate.path.startswith("gear."):
            continue
        names = [Path(name).name for name in number.mean_of]
        for path, name in known.determined_by.items():
            if plain(path) != number.estimate.path or "[" in path or name not in names:
                continue
            try:
                gear = gear_set.gear.replace({path.removeprefix("gear."): number.estimate.value})
            except ValueError:  # a mean that the law does not allow beside its other numbers
                continue
            source = Entry(source=f"identified from the {number.taken_from}", uncertainty=number.estimate.sigma)
            gear_set = replace(gear_set, gear=gear, sources={**gear_set.sources, path: source})
    return gear_set
