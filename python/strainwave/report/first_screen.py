"""First screen of an identification: verdict, pictures that the files determine, numbers with their sources, next commands."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from strainwave.files.gear_set import GEAR_FILE
from strainwave.identification.identify import Identified
from strainwave.identification.results.file_result import FileResult
from strainwave.identification.results.parameter_state import ParameterState
from strainwave.identification.results.pictures import Subject
from strainwave.report import identify_figures as plots
from strainwave.report.parameter_names import EFFECTS, effect_of, name_of, name_of_path
from strainwave.typeset import percent, quantity, uncertain_quantity

PREDICTED = ("log", "friction")  # kinds of files that `predict` compares
NEEDED: dict[Subject, str] = {  # for a picture that the first screen lacks
    "torque": "the torque or current of a drive in motion",
    "friction": "torque at several speeds, best both ways, that separates friction from the rest",
    "twist": "a torsion loop, or the angles of both shafts under a known torque that changes",
    "error": "the angles of both shafts over a turn of the input, with an order that stands out",
}
LARGEST_TORQUE = "40"  # N.m, to begin with if the set has no rating (assumed)
USUAL_GEAR = "csg-20-100"


def pictures(found: Identified) -> Iterator[dict[str, Any]]:
    """Yield the pictures of the first screen, in order: of each subject that of the first file that determines it."""
    usable = sorted((each for each in found.files if not each.refused), key=lambda each: bool(each.failed))
    for subject, title in plots.SUBJECTS.items():
        own = ((file, picture) for file in usable for picture in file.pictures if picture.subject == subject)
        if first := next(own, None):
            yield {"title": title, "file": first[0].name, "svg": plots.panel(*first, f"first-{subject}")}


def not_determined(found: Identified) -> list[tuple[str, str]]:
    """Return the subjects without a picture, and what they need."""
    shown = {picture.subject for file in found.files if not file.refused for picture in file.pictures}
    return [(title, NEEDED[subject]) for subject, title in plots.SUBJECTS.items() if subject not in shown]


def numbers_by_source(found: Identified) -> dict[str, list[tuple[str, str]]]:
    """Return name and value of every number that files determine, and of one of each other effect, by their source."""
    rows: dict[str, list[tuple[str, str]]] = {}
    determined = set()
    for each in found.parameters:
        taken = each.estimate
        determined.add(effect_of(taken.path))
        source = each.source if len(each.mean_of) < 2 else f"mean of {len(each.mean_of)} files"
        words = uncertain_quantity(taken.value, taken.sigma, taken.unit)
        rows.setdefault(f"from {source}", []).append((name_of(taken), words))
    for effect in EFFECTS:
        own = (each for each in found.states if each.state == "kept" and effect_of(each.path) == effect)
        first = next((each for each in own if each.value and each.unit != "1"), None)
        if effect not in determined and first is not None:
            words = _kept(first, found)
            rows.setdefault(f"from the start set {found.start_set.name}", []).append((name_of_path(first.path), words))
    return rows


def _kept(kept: ParameterState, found: Identified) -> str:
    """Return a number of the start set, with the scatter of individual gears if the set states it."""
    entry = found.gear_set.sources.get(kept.path)
    spread = "" if entry is None or entry.spread is None else f" ± {percent(entry.spread)}"
    return f"{quantity(kept.value, kept.unit)}{spread}"


def next_commands(found: Identified, folder: Path) -> list[tuple[str, str]]:
    """Return what to do next, and the command that does it with the gear file and the file of this result.

    Args:
        found: the result
        folder: that its files are written into
    """
    gear = folder / GEAR_FILE
    steps = [("See every number, and where it comes from", ["show", str(gear)])]
    if is_start_set(found):
        return _in_words(steps)
    compared = next((each for each in found.files if _is_predicted(each, found)), None)
    if compared is not None and compared.recognised is not None:
        options = compared.recognised.mapping.options
        paths = map(str, compared.recognised.parts or (compared.recognised.path,))
        words = ["predict", str(gear), *paths, *options, "--out", str(folder / "predict")]
        steps.insert(0, ("Compare a later recording: its name in place of this one", words))
    torque = [] if "peak_torque" in found.gear_set.ratings else ["--max-torque", LARGEST_TORQUE]
    largest = f" (largest torque in place of {LARGEST_TORQUE} N·m)" if torque else ""
    words = ["export", "joint", str(gear), *torque, "--out", str(folder / "joint")]
    steps.append((f"Write the joint for MuJoCo and URDF{largest}", words))
    if compared is None:
        steps.append(
            ("Compare it with a gear of the catalogue (strainwave list gears lists them)", ["compare", USUAL_GEAR, str(gear)])
        )
    return _in_words(steps)


def _in_words(steps: Sequence[tuple[str, Sequence[str]]]) -> list[tuple[str, str]]:
    return [(what, shlex.join(["strainwave", *words])) for what, words in steps]


def is_start_set(found: Identified) -> bool:
    """True if the files changed nothing of the drive of the start set."""
    result, start = found.gear_set, found.start_set
    return (result.gear, result.motor, result.load) == (start.gear, start.motor, start.load)


def next_lines(found: Identified, folder: Path) -> Iterator[str]:
    """Yield what to do next, each with its command, in lines for a terminal."""
    if is_start_set(found):
        yield f"gear.toml: the start set {found.start_set.name} unchanged"
    for what, command in next_commands(found, folder):
        yield from (f"{what}:", f"  {command}")


def _is_predicted(file: FileResult, found: Identified) -> bool:
    """True if `predict` compares a file with the gear: a table, or a log of a joint whose load is known."""
    read = file.recognised
    if (
        read is None
        or file.refused
        or file.part_of
        or read.kind not in PREDICTED
        or read.mapping.sign
        or not read.path.is_file()
    ):
        return False
    return bool(file.estimates) and (read.kind == "friction" or found.gear_set.load is not None)
