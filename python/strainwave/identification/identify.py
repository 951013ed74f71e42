"""Any mixture of files in; what each of them is, what it tells, and the gear that they tell together out."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from strainwave.files.gear_set import GearSet
from strainwave.identification.duplicates import same_as
from strainwave.identification.each_file import Known, fitted
from strainwave.identification.findings import Finding, Number, numbers_of
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise


@dataclass(frozen=True)
class Identified:
    """What files tell of a gear.

    Attributes:
        start: the set it started from
        findings: each file with what it tells, in the order given
        numbers: every number told, from the file that tells it best
        gear_set: the set with the laws of the files that tell them
    """

    start: GearSet
    findings: tuple[Finding, ...]
    numbers: tuple[Number, ...]
    gear_set: GearSet


def identify(
    start: GearSet | str | Path,
    files: Sequence[str | Path],
    *,
    mapping: Callable[[Path], FileMapping] | None = None,
    progress: Callable[[str], None] = lambda stage: None,
) -> Identified:
    """Finds out what files of measurements are, fits each, and puts together what they tell of one gear.

    Args:
        start: the set to start from: a set, the name of one in the catalogue, or the path of a gear file
        files: tables of friction, torsion loops, logs of the drive, records of two encoders, in any format and order
        mapping: what a person says of a file, where it says it not itself
        progress: called with the name of each file as its turn comes

    Returns:
        what each file tells, and the gear

    Raises:
        ValueError: no file, or none of which anything can be found; a file alone that cannot be used is told in its finding
    """
    if not files:
        raise ValueError("identify needs at least one file of measurements")
    start = start if isinstance(start, GearSet) else GearSet.read(start)
    read = [_recognised(Path(path), mapping) for path in files]
    recognised = [each for each in read if isinstance(each, Recognised)]
    copies, known, findings = same_as(recognised), Known(start), dict[Path, Finding]()
    for file in sorted(recognised, key=_turn):
        progress(file.path.name)
        copy = copies.get(str(file.path), "")
        try:
            found, after = fitted(file, known)
        except (ValueError, FloatingPointError) as error:
            found, after = Finding(file.path.name, file, refused=str(error)), known
        findings[file.path] = found
        known = known if copy else after
    ordered = _named_apart([each if isinstance(each, Finding) else findings[each.path] for each in read], files, copies)
    numbers = numbers_of(ordered)
    if not numbers:
        raise ValueError("no file tells anything of the gear: " + "; ".join(f"{each.name}: {each.refused}" for each in ordered))
    return Identified(start, ordered, numbers, known.gear_set)


def _named_apart(findings: Sequence[Finding], files: Sequence[str | Path], copies: Mapping[str, str]) -> tuple[Finding, ...]:
    """The findings by the names of their files; with their folders, where names come twice."""
    paths = [Path(path) for path in files]
    names = [path.name if sum(path.name == each.name for each in paths) == 1 else str(path) for path in paths]
    by_path = dict(zip(map(str, paths), names, strict=True))
    return tuple(
        replace(each, name=name, same_as=by_path.get(copies.get(str(path), ""), ""))
        for each, name, path in zip(findings, names, paths, strict=True)
    )


def _recognised(path: Path, mapping: Callable[[Path], FileMapping] | None) -> Recognised | Finding:
    try:
        return recognise(path, mapping(path) if mapping is not None else None)
    except (ValueError, OSError) as error:
        return Finding(path.name, refused=str(error).removeprefix(f"{path}: "))


def _turn(file: Recognised) -> int:
    """What is needed to understand a file comes before it: friction before a loop that has it inside, both before logs."""
    first = {"friction": 0, "torsion": 1, "encoders": 3, "log": 4, "effort": 5}[file.kind]
    return first + (file.kind == "torsion" and "input_angle" in file.recording)
