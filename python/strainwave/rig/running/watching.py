"""Follows the folder of a test while it is being run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from strainwave.rig.bench.setup import Camera, Rig
from strainwave.rig.bench.steps import FILE, Step, read_steps
from strainwave.rig.bench.torque import torque_of_masses
from strainwave.rig.running.guide import Look, Point
from strainwave.rig.vision.angle import follow
from strainwave.rig.vision.image import by_number, pictures_in
from strainwave.rig.vision.marker import Frame, look


@dataclass
class Watch:
    """New photographs of a folder, each time it is looked at.

    Torques come from `steps.csv` once it has a row for a photograph; else from a plan, photograph by photograph.

    Args:
        folder: of the test
        rig: which rig, for the torques
        plan: the steps that are to be made, in order; none if not known

    Raises:
        FileNotFoundError: there is no such folder
    """

    folder: Path
    rig: Rig | None = None
    plan: Sequence[Step] = ()
    frames: list[Frame] = field(default_factory=list)
    sizes: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.folder.is_dir():
            raise FileNotFoundError(f"{self.folder}: there is no such folder")

    def new(self) -> list[Point]:
        """The photographs that came since the last look, once they have been written whole.

        Raises:
            ValueError: `steps.csv` cannot be read
        """
        steps = read_steps(self.folder) if (self.folder / FILE).exists() else []
        recorded = {step.image: step for step in steps}
        known = {frame.name for frame in self.frames}
        names = [name for name in self._pictures() if name not in known and (name in recorded or self._complete(name))]
        camera = Camera() if self.rig is None else self.rig.camera
        self.frames += [look(self.folder / name, camera=camera) for name in names]
        return [self._point(name, recorded, camera) for name in names]

    def _pictures(self) -> list[str]:
        return sorted((each.name for each in pictures_in(self.folder)), key=by_number)

    def _complete(self, name: str) -> bool:
        size, before = (self.folder / name).stat().st_size, self.sizes.get(name)
        self.sizes[name] = size
        return size > 0 and size == before

    def _point(self, name: str, recorded: dict[str | None, Step], camera: Camera) -> Point:
        planned = [*self.plan, *[None] * len(self.frames)]
        steps = [recorded.get(frame.name) or step for frame, step in zip(self.frames, planned, strict=False)]
        place = [frame.name for frame in self.frames].index(name)
        mine = steps[place]
        alike = [
            frame
            for frame, step in zip(self.frames[: place + 1], steps, strict=False)
            if (step and step.place) == (mine and mine.place)
        ]
        frame, found = angle_of(alike, camera)
        torque = None if mine is None else mine.torque
        if mine is not None and torque is None and self.rig is not None:
            torque = torque_of_masses(self.rig, mine)
        return Point(name, torque, found, frame.warnings)


@dataclass
class Reader:
    """Reader of the angle of pictures while a test is guided: from the first photograph of their position and unit.

    While the first step of a position comes to rest, its first picture counts as 0.

    Attributes:
        camera: what it does to lengths
        frames: of each step that has been read, by its number, with the step
    """

    camera: Camera
    frames: dict[int, tuple[Step, Frame]] = field(default_factory=dict)
    first: dict[tuple[float, str], Frame] = field(default_factory=dict)

    def __call__(self, picture: Path, step: Step) -> Look:
        """Return the angle of a picture of a step; the last picture of a step is its photograph."""
        frame = look(picture, camera=self.camera)
        place = step.place
        before = [
            other for number, (made, other) in sorted(self.frames.items()) if number < step.number and made.place == place
        ]
        if not before and frame.markers is not None:
            before = [self.first.setdefault(place, frame)]
        self.frames[step.number] = (step, frame)
        return angle_of([*before, frame], self.camera)[1]


def angle_of(frames: Sequence[Frame], camera: Camera) -> tuple[Frame, Look]:
    """Return the last photograph with its warnings, and its angle from the first photograph that gives one."""
    if frames[-1].markers is None:
        return frames[-1], Look(np.nan, np.nan, frames[-1].fault or "no markers")
    angles = follow(frames, camera=camera)
    last = angles.frames[-1]
    if last.markers is None:
        return last, Look(np.nan, np.nan, last.fault)
    return last, Look(float(angles.angle[-1]), float(angles.sigma[-1]))
