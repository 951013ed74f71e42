"""All joints of an arm: each identified by itself, as each has a gear of its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from strainwave.files.folder import LINK_NOT_FOLLOWED
from strainwave.files.gear_set import GearSet
from strainwave.identification.identify import Identified, check_arguments, identify
from strainwave.identification.reading.joints import joints_of
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.source import MeasurementFile, MeasurementFiles, measurement_files
from strainwave.presentation import Presented, Reported, counted
from strainwave.progress import Progress, in_turn
from strainwave.questions import QuestionError

ONE = "1"  # name of the joint of files that name none
NAMES_NO_JOINT = "its columns name no joint, and those of other files do"
MAX_JOINTS = 100  # of all files: every file is read once for each; humanoids have 50


@dataclass(frozen=True)
class Joints(Presented, Reported):
    """Result of `identify_joints`: the gear of each joint of an arm.

    Attributes:
        found: the result of each joint, by its name
        refused: the reason why a joint could not be identified, by its name
        left_out: the reason why a file was used for no joint, by its name
    """

    found: Mapping[str, Identified]
    refused: Mapping[str, str]
    left_out: Mapping[str, str]

    def _headline(self) -> str:
        refused = f", {len(self.refused)} refused" if self.refused else ""
        return f"{counted(len(self.found), 'joint')}{refused}"


def identify_joints(
    start: GearSet | str | Path,
    files: str | Path | Sequence[str | Path] | MeasurementFiles,
    *,
    mapping: Callable[[Path], FileMapping] | None = None,
    accept: bool = False,
    name: str | None = None,
    progress: Progress = None,
) -> Joints:
    """Identify every joint that moves in files, each by itself.

    Args:
        start: the set to start from, for each joint
        files: logs of an arm; of a folder all files that may be such
        mapping, accept: as of `identify`
        name: of the arm; each gear has that of its joint behind it
        progress: as of `sw.simulate`

    Raises:
        TypeError: as `identify`
        ValueError: no file can be read, more than `MAX_JOINTS` joints move, or none can be identified, with the reason of each
    """
    check_arguments(start, files, mapping)
    user_mapping = mapping or (lambda path: FileMapping())
    by_joint, left_out, nameless = dict[str, list[MeasurementFile]](), dict[str, str](), list[MeasurementFile]()
    opened = measurement_files(files)
    left_out |= {link.name: LINK_NOT_FOLLOWED for link in opened.links}
    for file in opened.files:
        try:
            joints = joints_of(file, replace(user_mapping(file.path), joint=None))
        except ValueError as error:
            left_out[file.path.name] = str(error)
            continue
        if not joints:
            nameless.append(file)
            left_out[file.path.name] = NAMES_NO_JOINT
        for joint in joints:
            by_joint.setdefault(joint, []).append(file)
    if not by_joint and nameless:  # files of one joint, which need no name for it
        by_joint[ONE], left_out = nameless, {name: why for name, why in left_out.items() if why != NAMES_NO_JOINT}
    if not by_joint:
        raise ValueError(f"no file can be used: {'; '.join(f'{name}: {each}' for name, each in left_out.items())}")
    if len(by_joint) > MAX_JOINTS:
        raise ValueError(f"the files have {len(by_joint)} joints that move; at most {MAX_JOINTS} are taken: name one of them")
    found, refused, question = dict[str, Identified](), dict[str, str](), None
    with in_turn(progress, len(by_joint)) as turn:
        for joint, own in by_joint.items():
            turn(f"joint {joint}")
            of_joint = None if name is None else f"{name}, joint {joint}"
            try:
                found[joint] = identify(
                    start, MeasurementFiles(own, []), mapping=_of_joint(user_mapping, joint), accept=accept, name=of_joint
                )
            except ValueError as error:
                refused[joint] = str(error)
                question = question or (error if isinstance(error, QuestionError) and error.answers else None)
    if question is not None and not found:
        raise question
    if not found:
        raise ValueError("; ".join(f"joint {joint}: {why}" for joint, why in refused.items()))
    return Joints(found, refused, left_out)


def _of_joint(user_mapping: Callable[[Path], FileMapping], joint: str) -> Callable[[Path], FileMapping]:
    """Return the mapping of each file, with the joint that is asked for."""
    return lambda path: replace(user_mapping(path), joint=joint)
