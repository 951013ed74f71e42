"""From the picture to the plane of the target, against ray tracing and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from strainwave.rig.bench.setup import Camera
from strainwave.rig.vision.camera import changes_nothing, flat, in_picture, slopes_at

Array = NDArray[np.float64]
SHAPE = (480, 640)
CENTRE = np.array([319.5, 239.5])


def photographed(points: Array, tilt: float, direction: float, distance: float) -> Array:
    """By rays through a pinhole: the plane is turned in space by Rodrigues' formula about a line through the centre.

    Axes: right, up, away from the camera; the pinhole lies at a distance before the centre, and the focal length is as long.
    """
    away = np.array([np.cos(direction), np.sin(direction), 0.0])  # the direction that recedes
    axis = np.array([-away[1], away[0], 0.0])  # up x right: about it, `away` turns towards the camera
    space = np.column_stack((points[:, 0] - CENTRE[0], CENTRE[1] - points[:, 1], np.zeros(len(points))))
    cross, along = np.cross(axis, space), np.outer(space @ axis, axis)
    turned = space * np.cos(-tilt) + cross * np.sin(-tilt) + along * (1.0 - np.cos(-tilt))
    seen = turned[:, :2] * (distance / (distance + turned[:, 2]))[:, None]
    return np.column_stack((CENTRE[0] + seen[:, 0], CENTRE[1] - seen[:, 1]))


@given(
    tilt=st.floats(0.0, 1.0), direction=st.floats(-3.2, 3.2), distance=st.floats(900.0, 1e5),
    x=st.floats(60.0, 580.0), y=st.floats(60.0, 420.0),
)  # fmt: skip
def test_tilt_and_perspective_are_those_of_a_pinhole(
    tilt: float, direction: float, distance: float, x: float, y: float
) -> None:
    points = np.array([[x, y]])
    seen = photographed(points, tilt, direction, distance)
    camera = Camera(tilt=tilt, tilt_direction=direction, distance=distance)
    np.testing.assert_allclose(flat(seen, camera, SHAPE), points, rtol=0.0, atol=1e-8)


def test_what_recedes_becomes_smaller() -> None:
    seen = photographed(CENTRE + np.array([[-100.0, 0.0], [100.0, 0.0]]), 0.3, 0.0, 1000.0) - CENTRE
    assert seen[1, 0] < 100.0 * np.cos(0.3) < -seen[0, 0]


def test_without_a_distance_a_tilt_shortens_by_its_cosine() -> None:
    camera = Camera(tilt=np.arccos(0.8), tilt_direction=np.pi / 2.0)
    np.testing.assert_allclose(flat(CENTRE + np.array([[10.0, 40.0]]), camera, SHAPE), CENTRE + np.array([[10.0, 50.0]]))


def test_a_wide_pixel_makes_a_picture_narrow() -> None:
    camera = Camera(aspect=1.25, centre=(100.0, 50.0))
    np.testing.assert_allclose(flat(np.array([[180.0, 90.0]]), camera, SHAPE), [[200.0, 90.0]])


@given(k1=st.floats(-1e-6, 1e-5), k2=st.floats(-1e-13, 1e-12), x=st.floats(0.0, 639.0), y=st.floats(0.0, 479.0))
def test_the_lens_moves_points_along_the_radius_by_its_polynomial(k1: float, k2: float, x: float, y: float) -> None:
    camera = Camera(radial=(k1, k2), centre=(320.0, 240.0))
    right, down = x - 320.0, y - 240.0
    stretch = 1.0 + k1 * (right**2 + down**2) + k2 * (right**2 + down**2) ** 2
    seen = np.array([[320.0 + stretch * right, 240.0 + stretch * down]])
    np.testing.assert_allclose(flat(seen, camera, SHAPE), [[x, y]], rtol=0.0, atol=1e-7)


def test_a_point_of_the_plane_is_found_in_the_picture() -> None:
    camera = Camera(aspect=1.02, tilt=0.4, tilt_direction=0.7, distance=1500.0, radial=(3e-7, 1e-13))
    for point in (np.array([200.0, 150.0]), np.array([500.0, 300.0])):
        at, slopes = in_picture(point, camera, SHAPE, CENTRE)
        np.testing.assert_allclose(flat(at[None], camera, SHAPE)[0], point, rtol=0.0, atol=1e-8)
        step = np.array([0.01, -0.02])
        moved = flat((at + step)[None], camera, SHAPE)[0] - point
        np.testing.assert_allclose(slopes_at(at, camera, SHAPE) @ step, moved, rtol=1e-4)
        np.testing.assert_allclose(slopes, slopes_at(at, camera, SHAPE), rtol=1e-6)


def test_a_camera_that_changes_nothing_leaves_points_alone() -> None:
    for camera in (Camera(), Camera(distance=900.0, centre=(1.0, 2.0), tilt_direction=0.4)):
        assert changes_nothing(camera)
        np.testing.assert_array_equal(flat(CENTRE[None], camera, SHAPE), CENTRE[None])
    for camera in (Camera(aspect=1.01), Camera(tilt=0.1), Camera(radial=(1e-7, 0.0))):
        assert not changes_nothing(camera)


def test_an_impossible_camera_is_refused() -> None:
    corner = np.array([[639.0, 0.0], [0.0, 479.0]])
    with pytest.raises(ValueError, match="the horizon is in the picture"):
        flat(corner, Camera(tilt=1.4, distance=300.0), SHAPE)
    with pytest.raises(ValueError, match=r"radial = \(-5e-06, 0\.0\), the distortion turns back within the picture"):
        flat(corner, Camera(radial=(-5e-6, 0.0)), SHAPE)
