"""Sources of pictures while a test is being run: a camera, a folder that another program fills, or a virtual rig."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from strainwave.files.budget import RefusedFile, read_regular
from strainwave.messages import one_line
from strainwave.rig.virtual.render import Scene, render
from strainwave.rig.vision.decoding import MAX_PICTURE_BYTES
from strainwave.rig.vision.image import pictures_in

Array = NDArray[np.float64]


class PictureSource(Protocol):
    """Source of pictures of the target, one after the other."""

    def take(self, folder: Path) -> Path | None:
        """Put a new picture into a folder and return its path; None if there is none yet."""


class Device:
    """A camera that opencv can open, by its number.

    Raises:
        ImportError: opencv is not installed
        OSError: the camera cannot be opened
    """

    def __init__(self, number: int) -> None:
        try:
            import cv2
        except ImportError:
            raise ImportError(
                "a camera needs opencv, which is not installed; install strainwave[video], "
                "or let another program fill a folder and give that folder as --camera"
            ) from None
        self.number = number
        self.capture: Any = cv2.VideoCapture(number)
        if not self.capture.isOpened():
            raise OSError(f"camera {number} cannot be opened; is it plugged in, and in use by no other program?")

    def take(self, folder: Path) -> Path:
        """A picture of now, as PNG; `OSError` if the camera gives none."""
        came, picture = self.capture.read()
        if not came:
            raise OSError(f"camera {self.number} gives no picture; is it still plugged in?")
        path = folder / "picture.png"
        _save(picture[..., ::-1] if picture.ndim == 3 else picture, path)
        return path


@dataclass
class Filled:
    """A folder that another program fills; pictures that lie there already are left aside, and symbolic links.

    Raises:
        FileNotFoundError: there is no such folder
    """

    folder: Path
    seen: set[tuple[str, int, int]] = field(default_factory=set)
    sizes: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.folder.is_dir():
            raise FileNotFoundError(f"--camera {self.folder}: there is no such folder")
        self.seen |= {self._mark(path) for path in self._pictures()}

    def take(self, folder: Path) -> Path | None:
        """A copy of the newest picture that is new, once it has not grown since the last look."""
        new = [path for path in self._pictures() if self._mark(path) not in self.seen and self._complete(path)]
        self.seen |= {self._mark(path) for path in new}
        if not new:
            return None
        copy = folder / f"picture{new[-1].suffix.lower()}"
        try:
            copy.write_bytes(read_regular(new[-1], MAX_PICTURE_BYTES))
        except RefusedFile as error:
            raise ValueError(one_line(f"--camera {new[-1]} {error}")) from None
        return copy

    def _pictures(self) -> list[Path]:
        return sorted(pictures_in(self.folder), key=lambda path: (path.stat().st_mtime_ns, path.name))

    def _complete(self, path: Path) -> bool:
        size, before = path.stat().st_size, self.sizes.get(path.name)
        self.sizes[path.name] = size
        return size > 0 and size == before

    @staticmethod
    def _mark(path: Path) -> tuple[str, int, int]:
        found = path.stat()
        return path.name, found.st_mtime_ns, found.st_size


@dataclass
class Virtual:
    """A virtual rig: the scene of a target whose shaft comes to rest at the angle of a step.

    Args:
        scene: what is seen
        angles: of the shaft at rest, step by step [rad], shape (n,)
        random: gives the noise of the pictures
        settling: share of the way that is left from one picture to the next [1]
    """

    scene: Scene
    angles: Array
    random: np.random.Generator
    settling: float = 0.1
    step: int = 0
    angle: float = 0.0

    def load(self, number: int) -> None:
        """Lays on what a step asks for, by its number from 1."""
        self.angle = float(self.angles[number - 2]) if number > 1 else float(self.angles[0])
        self.step = number - 1

    def take(self, folder: Path) -> Path:
        """A picture of now; the shaft is nearer to rest with each."""
        path = folder / "picture.png"
        _save(render(self.scene, self.angle, self.random), path)
        rest = float(self.angles[self.step])
        self.angle = rest + self.settling * (self.angle - rest)
        return path


def _save(picture: NDArray[Any], path: Path) -> None:
    from PIL import Image

    Image.fromarray(np.ascontiguousarray(picture)).save(path)
