"""The angle of a target from rendered pictures of its two markers: error, bias, stated uncertainty, time of a picture.

Markers of 40 px in radius 300 px apart, blur 1.2 px, noise 4/255, light that changes by 30 % over the width, 640 x 480 pixels
of 8 bits, at random angles and places. Beside it scikit-image, if it is installed: contours at half the contrast, its circle
through each.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from report import Column, installed, print_table, save, three_digits
from rich.console import Console
from strainwave.rig.virtual.render import Scene, render
from strainwave.rig.vision.angle import follow
from strainwave.rig.vision.image import as_image
from strainwave.rig.vision.marker import look

FRAMES = 2000
QUICK = 200
Array = NDArray[np.float64]
Told = tuple[float, float]  # direction of the line through both markers, and its standard deviation [rad]

COLUMNS = (
    Column("method", words=True),
    *(
        Column(each)
        for each in ("frames", "rms error [µrad]", "bias [µrad]", "of the bias [µrad]", "error / stated", "a frame [ms]")
    ),
)


@dataclass(frozen=True)
class Accuracy:
    """Of the angles of some frames [rad]: the rest's is the standard deviation of the bias; CPU time of a frame [s]."""

    method: str
    frames: int
    rms: float
    bias: float
    bias_sigma: float
    stated: float | None
    cpu_time: float


def strainwave(pixels: NDArray[Any]) -> Told:
    """By this package."""
    angles = follow([look(as_image("frame", pixels))])
    markers = angles.frames[0].markers
    assert markers is not None
    one, other = markers
    return math.atan2(one.y - other.y, other.x - one.x), float(angles.sigma[0])


def scikit_image(pixels: NDArray[Any]) -> Told:
    """By its contours and its circle, least squares of the distances."""
    from skimage.measure import CircleModel, find_contours

    grey = pixels / 255.0
    contours = [each for each in find_contours(grey, 0.45) if len(each) > 100]
    (ay, ax), (by, bx) = (CircleModel.from_estimate(contour).center for contour in contours)
    return math.atan2(ay - by, bx - ax), math.nan


def measured(method: Callable[[NDArray[Any]], Told], name: str, frames: int) -> Accuracy:
    """The same frames for each method."""
    random = np.random.default_rng(19)
    errors, stated, times = np.empty(frames), np.empty(frames), np.empty(frames)
    for i in range(frames):
        angle, middle = random.uniform(-np.pi, np.pi), np.array([319.5, 239.5]) + random.uniform(-3.0, 3.0, 2)
        pixels = render(Scene(gradient=0.3, noise=4.0 / 255.0, middle=(middle[0], middle[1])), angle, random)
        start = time.process_time()
        told, stated[i] = method(pixels)
        times[i] = time.process_time() - start
        errors[i] = (told - angle + 0.5 * np.pi) % np.pi - 0.5 * np.pi  # whichever marker comes first
    rms = float(np.sqrt(np.mean(errors**2)))
    ratio = None if np.isnan(stated).any() else rms / float(np.sqrt(np.mean(stated**2)))
    bias, spread = float(errors.mean()), float(errors.std() / np.sqrt(frames))
    return Accuracy(name, frames, rms, bias, spread, ratio, float(np.median(times)))


def run(console: Console, quick: bool) -> None:
    """Prints, and writes the table."""
    frames = QUICK if quick else FRAMES
    with console.status("strainwave"):
        rows = [measured(strainwave, "strainwave", frames)]
    if installed("scikit-image"):
        with console.status("scikit-image"):
            rows.append(measured(scikit_image, "scikit-image", frames))
    else:
        console.print("scikit-image: not installed: pip install scikit-image")
    cells = [
        (
            row.method,
            str(row.frames),
            *(f"{1e6 * each:.1f}" for each in (row.rms, row.bias, row.bias_sigma)),
            "–" if row.stated is None else f"{row.stated:.2f}",
            three_digits(1e3 * row.cpu_time),
        )
        for row in rows
    ]
    print_table(console, "Angle of a target from pictures of its markers", COLUMNS, cells)
    save("marker_angle", rows)


if __name__ == "__main__":
    run(Console(), quick=False)
