"""The angle of the shaft in each photograph of a test."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Marker:
    """A circular marker in an image; x points right, y down, and the middle of the first pixel is 0, 0.

    Attributes:
        x, y: its centre [px]
        radius: mean radius of its edge [px]
        sigma: standard deviation of each coordinate of the centre [px]
        residual: rms distance of the edge from the fitted curve [px]
        contrast: difference of brightness across the edge, of the full scale [1]
        blur: standard deviation of the edge's spread [px]
        arc: share of the edge that was seen and used [1]
    """

    x: float
    y: float
    radius: float
    sigma: float
    residual: float
    contrast: float
    blur: float
    arc: float


@dataclass(frozen=True)
class Frame:
    """What one image told.

    Attributes:
        name: of the file
        sha256: of its bytes
        markers: both, always in the same order; none if the image was of no use
        fault: why it was of no use, empty otherwise
        warnings: what makes it doubtful
    """

    name: str
    sha256: str
    markers: tuple[Marker, Marker] | None
    fault: str = ""
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Angles(ComparedByFields):
    """Angles of the images that told one, in their order.

    Attributes:
        frames: every image, useful or not
        angle: from the reference, positive against the clock [rad], shape (useful frames,)
        sigma: standard deviation of each [rad], same shape
        reference: name of the image whose angle is 0
        centre: about which the shaft turned [px], x and y, and the rms distance of the markers from their circles;
            None where the turn is too small to tell it
    """

    frames: tuple[Frame, ...]
    angle: Array
    sigma: Array
    reference: str
    centre: tuple[float, float, float] | None

    @property
    def useful(self) -> tuple[Frame, ...]:
        """The images whose angles these are."""
        return tuple(frame for frame in self.frames if frame.markers is not None)
