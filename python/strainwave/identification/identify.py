"""From any mixture of measurement files to one gear: the type of each file, its fit, and the combination of all."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from strainwave.equality import ComparedByFields
from strainwave.files.entries import Entry, check_line
from strainwave.files.folder import LINK_NOT_FOLLOWED
from strainwave.files.gear_file import ACCEPTED
from strainwave.files.gear_set import GearSet
from strainwave.files.identified_tables import Validation
from strainwave.files.recording import Recording
from strainwave.files.tables import FORMATS
from strainwave.identification.checks.comparisons import (
    between_files,
    gravity_in_ratings,
    other_loads,
    ratio_in_files,
    torque_scales,
    with_start_set,
)
from strainwave.identification.kinds import KINDS, kind_named
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.joints import check_one_joint
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise
from strainwave.identification.reading.several_files import consistent, joined, same_as
from strainwave.identification.reading.source import (
    BAG_FILE,
    Measurement,
    MeasurementFile,
    MeasurementFiles,
    measurement_files,
    other_format,
)
from strainwave.identification.readings import answered, decided
from strainwave.identification.results.combined_parameter import CombinedParameter, combine, without_motor
from strainwave.identification.results.drive import drive_set, name_of_files
from strainwave.identification.results.file_result import ASSUMED_BY_RECORDER, Check, FileResult
from strainwave.identification.results.gear_so_far import (
    GearSoFar,
    compared_path,
    remark_on_ratio,
    with_kinematics,
    with_ratio,
    with_ratio_of_all,
)
from strainwave.identification.results.measured_range import measured_range
from strainwave.identification.results.parameter_state import ParameterState, over_start_figure, states_of
from strainwave.messages import listed, one_line, shortened
from strainwave.presentation import Pictured, Reported, Row, counted
from strainwave.progress import Progress, in_turn
from strainwave.questions import QuestionError
from strainwave.simulation.threads import one_thread_of_algebra

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Mapped: TypeAlias = Callable[[Path], FileMapping] | FileMapping | None


@dataclass(frozen=True, eq=False)
class Identified(ComparedByFields, Pictured, Reported):
    """Result of `identify`: the estimates of each file, their combination, and the checks of both.

    Attributes:
        start_set: the set it began with
        files: the result of each file, in the order given; then what several files determine only together
        parameters: every parameter determined: the mean of the files that agree about it
        gear_set: the set with the laws of the files that determine them best, and their numbers, the load and motor of the
            log that determines its load best, their covariance, and the errors of this drive on each file. A file with a failed
            check changes nothing of it, unless it was accepted
        checks: consistency checks of all files, and of files with each other and with the start set

    >>> import numpy as np
    >>> import strainwave as sw
    >>> speed = np.array([2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0])
    >>> columns = {"speed": speed, "torque": 0.05 + 3e-4 * speed + 1e-4 * np.array([1, -1, 0, 1, -1, 1, 0])}
    >>> found = sw.identify("hfuc-25-100", {"friction": sw.Recording(columns, {"speed": "rad/s", "torque": "N.m"})})
    >>> for each in found.parameters:
    ...     print(each.estimate.path, f"{each.estimate.value:.3g} ± {each.estimate.sigma:.1g} {each.estimate.unit}")
    gear.friction_input.coulomb 0.05 ± 6e-05 N.m
    gear.friction_input.viscous 0.0003 ± 6e-07 N.m.s/rad
    """

    start_set: GearSet
    files: tuple[FileResult, ...]
    parameters: tuple[CombinedParameter, ...]
    gear_set: GearSet
    checks: tuple[Check, ...] = ()

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that failed: settle them before the gear is used."""
        return tuple(check for check in self.checks if check.failed)

    @property
    def unchecked(self) -> dict[str, str]:
        """Numbers with which estimates scale, or that a file repeats, if no file of the kind checks them: values, by name."""
        kinds: dict[str, list[Mapping[str, str]]] = {}
        for each in self.files:
            if each.recognised and each.estimates:
                kinds.setdefault(each.recognised.kind, []).append(each.unchecked)
        return {
            name: value for files in kinds.values() for name, value in files[0].items() if all(name in each for each in files)
        }

    @property
    def accepted(self) -> GearSet:
        """The gear set with its failed checks in its note: accepted, if it is used all the same."""
        if not self.failed:
            return self.gear_set
        failed = "; ".join(f"{check.source}: {check.message}" for check in self.failed)
        note = f"{self.gear_set.note} " if self.gear_set.note else ""
        return self.gear_set.replace(note=f"{note}{ACCEPTED}: {failed}.")

    @cached_property
    def states(self) -> tuple[ParameterState, ...]:
        """The state of every number of the gear."""
        return tuple(states_of(self.start_set, self.gear_set, self.parameters, self.files))

    def plot(self) -> Figure:
        """Return a figure of the identified numbers of the gear over those of the start set, each with its interval of 95 %.

        A grey bar is the spread of individual gears that the start set states. Each file has a `plot` of its own, measured
        against modelled: `identified.files[0].plot()`.

        Raises:
            ValueError: no identified number has a value in the start set
        """
        return over_start_figure(self.states, self.start_set, self.gear_set.name)

    def _picture(self) -> Figure | None:
        """Return measured and modelled curves of the first file that has any; else the numbers over those of the start set."""
        return next((file.plot() for file in self.files if file.pictures), None) or super()._picture()

    def _headline(self) -> str:
        checks = counted(len(self.checks), "check")
        verdict = f"{len(self.failed)} of {checks} FAILED" if self.failed else f"{checks} passed"
        refused = sum(bool(each.refused) for each in self.files)
        files = counted(len(self.files), "file") + (f", {refused} refused" if refused else "")
        return f"{self.gear_set.name}, {counted(len(self.parameters), 'parameter')} from {files}, {verdict}"

    def _rows(self) -> Iterator[Row]:
        for each in self.parameters:
            taken = each.estimate
            source = each.taken_from if len(self.files) > 1 else ""
            yield Row(taken.label, taken.value, taken.unit, taken.sigma, source)
        for file in self.files:
            yield Row(file.name, file.in_words)

    def _remarks(self) -> Iterator[str]:
        return (f"FAILED: {check.source}: {check.message}; {check.remedy}" for check in self.failed)


def identify(
    start_set: GearSet | str | Path,
    files: str | Path | Sequence[str | Path] | Mapping[str, Measurement] | MeasurementFiles,
    *,
    mapping: Mapped = None,
    accept: bool = False,
    name: str | None = None,
    progress: Progress = None,
) -> Identified:
    """Determine the type of each file of measurements, fit it, and combine the estimates of all to one gear.

    Args:
        start_set: the set to start from: a set, the name of one in the catalogue, or the path of a gear file
        files: tables of friction, torsion loops, logs of the drive, records of two encoders, records at constant speed,
            friction at rest, in any format and order; of a folder all files that may be such. Or a mapping from the kind of
            each, as "friction" or "torsion", to a path or a recording
        mapping: what a person states of all files, or a function that returns it for the path of each
        accept: whether files are used although a check of them fails
        name: of the gear, one line of text; by default that of its files, as `gear of joint_5`
        progress: as of `sw.simulate`

    Returns:
        result of each file, and the gear; look at its `failed` checks before it is used

    Raises:
        TypeError: `files` are no paths, or `mapping` is no mapping
        ValueError: no file, or none that can be used; among others, an unusable file is refused in its result

    >>> import numpy as np
    >>> import strainwave as sw
    >>> speed = np.array([2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0])
    >>> columns = {"speed": speed, "torque": 0.05 + 3e-4 * speed + 1e-4 * np.array([1, -1, 0, 1, -1, 1, 0])}
    >>> found = identify("hfuc-25-100", {"friction": sw.Recording(columns, {"speed": "rad/s", "torque": "N.m"})})
    >>> found.files[0].recognised.kind, round(found.gear_set.gear.friction_input.coulomb, 2), found.failed
    ('friction', 0.05, ())
    """
    check_arguments(start_set, files, mapping)
    if name is not None:
        check_line("name", name)
    opened = measurement_files(files)
    read, start_set = read_measurements(
        opened, mapping, start_set if isinstance(start_set, GearSet) else GearSet.read(start_set)
    )
    check_one_joint(_only_read(read))
    recognised = joined(_only_read(read))
    whole = {each.path: each for each in recognised}
    read = {path: whole.get(path, each) for path, each in read.items() if path in whole or isinstance(each, FileResult)}
    with in_turn(progress, len(recognised)) as turn:
        copies = same_as(recognised)
        fits = _fitted(start_set, recognised, copies, mapping, accept, turn)
    own = [each if isinstance(each, FileResult) else fits.results[each.path] for each in read.values()]
    results = (*_named_apart(own, list(read), copies), *fits.together)
    results = without_motor(results, accept=accept)
    loads = other_loads(results)
    results = tuple(replace(each, remarks=_in_order(each, loads.get(each.name, ""))) for each in results)
    determined_by = {compared_path(path, fits.known.gear_set.gear): file for path, file in fits.known.determined_by.items()}
    parameters = combine(results, accept=accept, determined_by=determined_by)
    if not any(each.estimates or each.failed for each in results):
        raise_question(results)
        raise ValueError(f"no file can be used: {'; '.join(map(_why_nothing, results))}")
    failed = {each.name for each in results if each.failed}  # a check of these numbers has failed already
    checks = (
        *(check for each in results for check in each.checks), *_nothing_determined(results),
        *ratio_in_files(start_set, results),
        *with_start_set(start_set, parameters, failed), *gravity_in_ratings(start_set, parameters, failed),
        *between_files(parameters, results), *torque_scales(results),
    )  # fmt: skip
    counted = [each for each in results if not each.same_as and not each.refused and (accept or not each.failed)]
    gear_set = drive_set(start_set, with_means(fits.known, parameters), counted, parameters, name or name_of_files(results))
    return Identified(start_set, results, parameters, with_error_at_constant_speed(gear_set, counted), checks)


# ---- Reading ---------------------------------------------------------------------------------------------------------


def check_arguments(gear: object, files: object, mapping: object) -> None:
    """Raise an error for what is no gear, for what are no files, and for what states nothing of them."""
    if isinstance(gear, Recording | Mapping | list | tuple):
        raise TypeError(
            f"the gear comes first, as a set, its name or the path of its file, then the measurements: not {shortened(gear)}"
        )
    if isinstance(files, Recording):
        raise TypeError(f'of a Recording the kind is needed, as in {{"friction": table}}; the kinds are {listed(KINDS)}')
    if isinstance(files, Mapping):
        if unknown := [kind for kind in files if kind not in KINDS]:
            raise ValueError(f"{shortened(unknown[0])} is no kind of measurement; the kinds are {listed(KINDS)}")
        if wrong := [each for each in files.values() if not isinstance(each, str | Path | Recording)]:
            raise TypeError(f"a measurement must be a path or a Recording, not {shortened(wrong[0])}")
    elif not isinstance(files, MeasurementFiles | str | Path) and (
        not isinstance(files, list | tuple) or not all(isinstance(each, str | Path) for each in files)
    ):
        raise TypeError(f"files must be a path, a list of paths, or a mapping from kinds to them, not {shortened(files)}")
    if mapping is not None and not callable(mapping) and not isinstance(mapping, FileMapping):
        raise TypeError(f"mapping must be a FileMapping, or a function that takes a path, not {shortened(mapping)}")
    if not files:
        raise ValueError("identify needs at least one file of measurements")


def read_measurements(
    opened: MeasurementFiles, mapping: Mapped, start: GearSet
) -> tuple[dict[Path, Recognised | FileResult], GearSet]:
    """Return each file as it is read, or why it is refused, by its path; and the set with the ratio given with all files."""
    sources = {file.path: file for file in opened.files}
    given = {file.path: _mapping_of(mapping, file.path, file.kind) for file in opened.files}
    read = {path: _recognised(source, given[path]) for path, source in sources.items()}
    asked = {path: each.question for path, each in read.items() if isinstance(each, FileResult) and each.question is not None}
    in_one_reading = consistent(_only_read(read), sources)
    start = with_ratio_of_all(start, in_one_reading)
    known = GearSoFar(start, start)
    for each in in_one_reading:  # as its names and a fit determine, or its question
        try:
            file = decided(each, sources[each.path], with_ratio(known, each), given[each.path] or FileMapping())
            read[each.path] = file if file.question is None else not_used(each.path, file.question, file)
        except ValueError as error:
            read[each.path] = not_used(each.path, error, each)
    for path, question in asked.items():  # in the one answer that the numbers leave, or the question with the possible ones
        try:
            read[path] = answered(question, sources[path], known, given[path] or FileMapping())
        except (ValueError, FloatingPointError) as error:
            read[path] = not_used(path, error if isinstance(error, QuestionError) else question)
    for link in opened.links:
        read.setdefault(link, FileResult(link.name, refused=LINK_NOT_FOLLOWED))
    return read, start


def _recognised(file: MeasurementFile, mapping: FileMapping | None) -> Recognised | FileResult:
    path = file.path
    if file.recording is None and path.is_dir() and not Path(path, BAG_FILE).is_file():
        suffixes = listed(f"*{suffix}" for suffix in FORMATS)
        return FileResult(path.name, refused=f"the folder contains no file that may be a measurement, as {suffixes}")
    if file.recording is None and (other := other_format(path)):
        return FileResult(path.name, refused=other)
    try:
        return recognise(file, mapping)
    except (ValueError, OSError) as error:
        if file.recording is not None:
            raise
        return not_used(path, error)


def _mapping_of(mapping: Mapped, path: Path, kind: str | None) -> FileMapping | None:
    """Return what a person states of a file, with its kind."""
    stated = mapping if isinstance(mapping, FileMapping) or mapping is None else mapping(path)
    return stated if kind is None else replace(stated or FileMapping(), kind=kind)


def _only_read(files: Mapping[Path, Recognised | FileResult]) -> list[Recognised]:
    return [each for each in files.values() if isinstance(each, Recognised)]


def not_used(path: Path, error: Exception, file: Recognised | None = None) -> FileResult:
    """Return the result of a file that is not used, with the reason, or the question that it leaves open."""
    question = error if isinstance(error, QuestionError) and error.answers else None
    return FileResult(path.name, file, refused=without_name(str(error), path), question=question)


def raise_question(files: Sequence[FileResult]) -> None:
    """Raise the first question that a file leaves open, with the name of the file."""
    for each in files:
        if each.question is not None:
            raise each.question if each.name in each.question.question else each.question.of(each.name)


def without_name(message: str, path: Path) -> str:
    """Return a message about a file without its name, which stands before it."""
    for name in (str(path), path.name):
        for end in (": ", " "):
            message = message.removeprefix(name + end)
    return message


# ---- Fits ------------------------------------------------------------------------------------------------------------


class _Fits(NamedTuple):
    """The fits of all files.

    Attributes:
        results: of each file, by its path
        together: of what several files determine together
        known: the gear with them
    """

    results: dict[Path, FileResult]
    together: list[FileResult]
    known: GearSoFar


@one_thread_of_algebra
def _fitted(
    start: GearSet,
    files: Sequence[Recognised],
    copies: Mapping[str, str],
    mapping: Mapped,
    accept: bool,
    turn: Callable[[str], None],
) -> _Fits:
    """Return the fits of all files, in the order of their kinds, and what files of a kind determine together.

    A file that contains the measurement of another one, or fails a check, changes nothing of the gear.
    """
    before = replace(start, covariance=None, validation=())  # of the start set as a whole, not of what files change of it
    known, results, together = GearSoFar(before, start), dict[Path, FileResult](), list[FileResult]()
    kinds = [kind_named(name) for name in KINDS]
    own = {file.path: next(kind for kind in kinds if kind.takes(file, known, files)) for file in files}
    turns = {file.path: own[file.path].turn(file, {kind.name for kind in own.values()}) for file in files}
    originals = {kind: [file for file in files if own[file.path] is kind and str(file.path) not in copies] for kind in kinds}
    for kind in kinds:
        mine = [file for file in files if turns[file.path][0] == kind.name]
        for file in sorted(mine, key=lambda file: turns[file.path][1]):
            turn(file.path.name)
            result, after = _fit_of_file(own[file.path], file, known, mapping)
            results[file.path] = result
            if str(file.path) not in copies and (accept or not result.failed):
                known = with_kinematics(after, known.gear_set)
        if originals[kind]:
            of_all, after = kind.fit_together(originals[kind], known)
            together += of_all
            known = after if accept or not any(result.failed for result in of_all) else known
    for kind in kinds:
        if originals[kind]:
            of_all, after = kind.fit_last(originals[kind], known)
            together += of_all
            known = after if accept or not any(result.failed for result in of_all) else known
    return _Fits(results, together, known)


def _fit_of_file(kind: Kind, file: Recognised, known: GearSoFar, mapping: Mapped) -> tuple[FileResult, GearSoFar]:
    """Return the result of a file, and the gear with it."""
    stated = _mapping_of(mapping, file.path, None)
    before = replace(with_ratio(known, file), side=None if stated is None else stated.side)
    file = file.at_ratio(before.gear_set.gear.kinematics.ratio)
    try:
        result, after = kind.fit(file, before)
    except (ValueError, FloatingPointError) as error:
        return not_used(file.path, error, file), before
    return replace(result, remarks=(*filter(None, [remark_on_ratio(before, file)]), *result.remarks)), after


# ---- Results ---------------------------------------------------------------------------------------------------------


def _named_apart(results: Sequence[FileResult], paths: Sequence[Path], copies: Mapping[str, str]) -> tuple[FileResult, ...]:
    """Return the results by the names of their files; with their folders, if names come twice."""
    names = [one_line(path.name if sum(path.name == each.name for each in paths) == 1 else str(path)) for path in paths]
    by_path = dict(zip(map(str, paths), names, strict=True))
    return tuple(
        replace(each, name=name, same_as=by_path.get(copies.get(str(path), ""), ""))
        for each, name, path in zip(results, names, paths, strict=True)
    )


def _in_order(result: FileResult, of_load: str) -> tuple[str, ...]:
    """Return the remarks of a file, that of its load first; lists of what it contains and nothing uses come last."""
    left_out = () if result.recognised is None else result.recognised.left_out
    return tuple(sorted(filter(None, (of_load, *result.remarks)), key=left_out.__contains__))


def _nothing_determined(results: Sequence[FileResult]) -> list[Check]:
    """Return the check that files determine a parameter, if none does and no check of a file gives the reason."""
    estimates = [estimate for each in results for estimate in each.estimates]
    stated = any(each.state != "not identified" or each.why == ASSUMED_BY_RECORDER for each in estimates)
    if stated or any(each.failed for each in results):
        return []
    return [
        Check(
            "parameters determined", listed(each.name for each in results), 1.0, 0.0, "1", True,
            f"no file determines a parameter of the gear: {'; '.join(map(_why_nothing, results))}",
            "see whether columns, units and sides are what they are taken for, and whether the motion excites the gear",
        )
    ]  # fmt: skip


def _why_nothing(result: FileResult) -> str:
    """Return why a file determines no parameter."""
    if result.refused or result.part_of:
        return f"{result.name}: {result.refused or f'a part of the {result.part_of}'}"
    whys = dict.fromkeys(estimate.why for estimate in result.estimates if estimate.why)
    none = "; ".join(("no parameter stands out", *result.remarks))
    fitted = f"{result.model} {'was' if whys else 'were'} fitted, but {'; '.join(whys) or none}"
    return f"{result.name}: {fitted}"


def with_means(known: GearSoFar, parameters: Sequence[CombinedParameter]) -> GearSet:
    """Return the set with the means of files that agree, if it has the law that the parameter belongs to."""
    gear_set = known.gear_set
    for each in parameters:
        if len(each.mean_of) < 2 or not each.estimate.path.startswith("gear."):
            continue
        names = [Path(name).name for name in each.mean_of]
        for path, name in known.determined_by.items():
            if compared_path(path, gear_set.gear) != each.estimate.path or "[" in each.estimate.path or name not in names:
                continue
            try:
                gear = gear_set.gear.replace({path.removeprefix("gear."): each.estimate.value})
            except ValueError:  # a mean that the law does not allow with its other numbers
                continue
            source = Entry(source=f"identified from the {each.taken_from}", uncertainty=each.estimate.sigma)
            gear_set = replace(gear_set, gear=gear, sources={**gear_set.sources, path: source})
    return gear_set


def with_error_at_constant_speed(gear_set: GearSet, files: Sequence[FileResult]) -> GearSet:
    """Return the set with its error on the whole of a log of which stretches at constant speed were used, if on no other."""
    logs = (each.recognised for each in files if each.part_of and each.recognised is not None)
    log = next((each for each in logs if each.kind == "log"), None)
    if log is None or gear_set.load is None or any(each.kind == "log" for each in gear_set.validation):
        return gear_set
    ratio = gear_set.gear.kinematics.ratio
    try:
        prediction = kind_named(log.kind).predict(log.at_ratio(ratio), gear_set)
    except (ValueError, FloatingPointError):  # no torque along its motion can be compared
        return gear_set
    own = Validation(
        one_line(prediction.name), prediction.kind, prediction.channel, prediction.unit, prediction.error, prediction.varies,
        prediction.error, prediction.varies, measured=measured_range(FileResult(prediction.name, log), ratio),
    )  # fmt: skip
    return replace(gear_set, validation=(*gear_set.validation, own))
