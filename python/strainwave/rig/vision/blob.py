"""Coarse search for round spots in a picture, to a few pixels."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Grey = NDArray[np.float32]
_CELLS_PER_BLOCK = 4  # each way; the local brightness is the mean of a block
_MIN_CONTRAST_SHARE = 0.15  # contrast of a spot, as a share of the contrast of the picture [1]
_MIN_CONTRAST_NOISE = 4.0  # contrast of a spot over the noise of a cell [1]
MAX_SPOTS = 1000  # whose edges are looked at, which takes a few milliseconds each; a target has two
MAX_AREAS = 50_000  # connected cells of the size of a spot, of any shape


class TooManySpots(ValueError):  # noqa: N818 - its message is why a picture is of no use
    """A picture has more spots that may be markers than can be looked at."""


@dataclass(frozen=True)
class Blob:
    """A connected spot that is darker, or brighter, than what is around it.

    Attributes:
        x, y: the middle of its box [px]
        radius: half the geometric mean of the sides of its box [px]
        dark: whether it is the darker one
        whole: whether it lies within the picture with all its edge
        contrast: of the brightest and the darkest around it, of the full scale
    """

    x: float
    y: float
    radius: float
    dark: bool
    whole: bool
    contrast: float


def blobs(grey: Grey, low: float, high: float) -> list[Blob]:
    """Spots whose radius lies between `low` and `high` [px] and whose box and area are not those of anything but a disc.

    A cell is dark if it lies below the middle between the darkest and the brightest block around it, within half the picture.

    Raises:
        TooManySpots: there are more than `MAX_SPOTS`
    """
    side = int(np.clip(low / 2.0, 1.0, 8.0))
    cells = averaged(grey, side)
    middle, contrast, clear = _middle(cells)
    found = []
    for dark in (True, False):
        mask = (cells < middle) if dark else (cells > middle)
        found += list(_spots(mask & clear, contrast, side, dark, low, high))
    if len(found) > MAX_SPOTS:
        raise TooManySpots(_too_many(len(found), MAX_SPOTS))
    return found


def _too_many(count: int, most: int) -> str:
    return f"{count} spots may be markers, and {most} can be looked at; limit them by radius=(least, most) in px"


def averaged(grey: Grey, side: int) -> Grey:
    """Means over squares of `side` pixels; what is left over at the right and the lower edge is cut off.

    >>> averaged(np.array([[0.0, 1.0, 5.0], [1.0, 2.0, 5.0]], np.float32), 2)
    array([[1.]], dtype=float32)
    """
    if side == 1:
        return grey
    height, width = (n // side * side for n in grey.shape)
    rows = grey[0:height:side, :width].copy()
    for i in range(1, side):
        rows += grey[i:height:side, :width]
    cells = rows[:, 0::side].copy()
    for i in range(1, side):
        cells += rows[:, i::side]
    cells *= np.float32(1.0 / side**2)
    return cells


def _middle(cells: Grey) -> tuple[Grey, Grey, NDArray[np.bool_]]:
    """The brightness that parts dark from bright at each cell; the contrast around each block; where that is clear."""
    from scipy.ndimage import maximum_filter, minimum_filter

    height, width = cells.shape
    padded = np.pad(cells, ((0, -height % _CELLS_PER_BLOCK), (0, -width % _CELLS_PER_BLOCK)), mode="edge")
    blocks = averaged(padded, _CELLS_PER_BLOCK)
    window = max(3, min(blocks.shape) // 2)
    brightest, darkest = maximum_filter(blocks, window), minimum_filter(blocks, window)
    contrast = brightest - darkest
    least = max(_MIN_CONTRAST_SHARE * float(blocks.max() - blocks.min()), _MIN_CONTRAST_NOISE * _noise(cells))

    def spread(values: NDArray[np.generic]) -> NDArray[np.generic]:
        return np.repeat(np.repeat(values, _CELLS_PER_BLOCK, axis=0), _CELLS_PER_BLOCK, axis=1)[:height, :width]

    middle: Grey = spread((brightest + darkest) * np.float32(0.5)).astype(np.float32, copy=False)
    return middle, contrast, spread(contrast > least).astype(bool, copy=False)


def _noise(cells: Grey) -> float:
    """Return the noise of a cell, from differences of neighbours; edges are few and do not change the median."""
    sample = cells[:: max(1, cells.shape[0] // 32)]
    return float(np.median(np.abs(np.diff(sample, axis=1))) / (0.6745 * np.sqrt(2.0)))


def _spots(mask: NDArray[np.bool_], contrast: Grey, side: int, dark: bool, low: float, high: float) -> Iterator[Blob]:
    from scipy.ndimage import find_objects, label

    labels, count = label(mask)
    areas = np.bincount(labels.ravel(), minlength=count + 1)[1:] * side**2
    rows, columns = mask.shape
    large = (areas >= 1.2 * low**2) & (areas <= 4.0 * high**2)
    places = np.flatnonzero(large)
    if len(places) > MAX_AREAS:
        raise TooManySpots(_too_many(len(places), MAX_AREAS))
    numbers = np.zeros(count + 1, np.int32)  # of the large ones alone, since the others may be millions
    numbers[places + 1] = np.arange(1, len(places) + 1)
    for i, (down, right) in zip(places, find_objects(numbers[labels]), strict=True):
        height, width = side * (down.stop - down.start), side * (right.stop - right.start)
        radius, share = np.sqrt(height * width) / 2.0, areas[i] / (height * width)
        whole = down.start > 0 and right.start > 0 and down.stop < rows and right.stop < columns
        slender = not 0.4 < width / height < 2.5
        if not low * 0.8 <= radius <= high + 2.0 * side or (whole and (slender or share < 0.5)) or share < 0.3:
            continue
        column, row = ((part.start + part.stop) / 2.0 for part in (right, down))
        around = float(contrast[int(row) // _CELLS_PER_BLOCK, int(column) // _CELLS_PER_BLOCK])
        yield Blob(side * column - 0.5, side * row - 0.5, float(radius), dark, whole, around)
