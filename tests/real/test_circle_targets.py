"""A photograph of some 350 circular targets on a wall and a floor: what is round is found.

Photograph: matthiashar, marker_detection (MIT). Nobody measured where the targets are: it shows that they are found, not how
well. It is no test of a rig. That needs photographs of one pair of markers, of 20 px in radius or more, at known angles.
"""

from __future__ import annotations

import os
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest
from strainwave.rig.vision.image import Image, read_image
from strainwave.rig.vision.marker import Marker, find_markers, look

FOLDER = Path(os.environ.get("STRAINWAVE_DATA", Path(__file__).parents[3] / "shared" / "data")) / "circle-targets"
PHOTOGRAPH = FOLDER / "md_test_data_example.jpg"

pytestmark = pytest.mark.skipif(not PHOTOGRAPH.is_file(), reason=f"photograph not found: {PHOTOGRAPH} (set STRAINWAVE_DATA)")

# Middles of discs, read from the picture on a screen to some pixels: two sheets on the wall, and one on the floor.
WALL = [(876, 604), (942, 605), (883, 642), (948, 643), (890, 677), (895, 713)]
FLOOR = [(1668, 1509), (1676, 1552), (1588, 1600), (1594, 1651)]


@pytest.fixture(scope="module")
def image() -> Image:
    return read_image(PHOTOGRAPH)


@pytest.fixture(scope="module")
def markers(image: Image) -> list[Marker]:
    return find_markers(image.grey, radius=(4.5, 30.0), dark=True)


@pytest.mark.slow("rig")
def test_most_of_the_targets_are_found_and_hardly_anything_else(image: Image, markers: list[Marker]) -> None:
    print(f"\n{len(markers)} round dark spots of 4.5 to 30 px in radius")
    assert image.grey.shape == (2000, 3000)
    assert image.taken == datetime(2024, 10, 1, 8, 29, 39)
    assert len(markers) > 200


@pytest.mark.slow("rig")
@pytest.mark.parametrize("place", WALL + FLOOR)
def test_discs_that_one_sees_are_among_them(markers: list[Marker], place: tuple[int, int]) -> None:
    near = min(markers, key=lambda marker: np.hypot(marker.x - place[0], marker.y - place[1]))
    assert np.hypot(near.x - place[0], near.y - place[1]) < 6.0
    assert near.arc > 0.8
    assert near.sigma < 0.1
    assert near.contrast > 0.2


@pytest.mark.slow("rig")
def test_it_says_why_this_is_no_test_with_two_markers() -> None:
    frame = look(PHOTOGRAPH)
    assert frame.markers is None
    assert "markers instead of two: dark at x = " in frame.fault
    assert "select them by radius=(least, most) in px, or by dark" in frame.fault
