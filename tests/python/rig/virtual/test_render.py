"""Rendered pictures: edges where they must be to a thousandth of a pixel, and light, noise and camera as they are described."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import ncx2
from strainwave.rig.bench.setup import Camera
from strainwave.rig.virtual.render import Scene, render, seen

Array = NDArray[np.float64]
STEP = 0.6  # of brightness between markers and ground


def darkness(scene: Scene, angle: float = 0.0) -> Array:
    """How much a picture without noise is darker than the ground, of the full step."""
    picture = render(scene, angle, np.random.default_rng(0))
    return (scene.ground - picture / (2.0**scene.bits - 1.0)) / STEP


def centroids(scene: Scene, angle: float = 0.0) -> Array:
    """Of both markers: area [px2], x, y. The line half-way between their centres parts them."""
    dark = darkness(scene, angle)
    y, x = np.indices(dark.shape)
    first, second = scene.centres(angle)
    near = np.hypot(x - first[0], y - first[1]) < np.hypot(x - second[0], y - second[1])
    found = []
    for mine in (near, ~near):
        weight = np.where(mine, dark, 0.0)
        found.append([weight.sum(), (weight * x).sum() / weight.sum(), (weight * y).sum() / weight.sum()])
    return np.array(found)


def small(**changes: object) -> Scene:
    """A quick scene of exact grey values: 0.2 and 0.8 of the full scale are whole numbers of 16 and of 8 bits."""
    usual = {"size": (160, 120), "radius": 17.3, "distance": 75.0, "markers": (0.2, 0.2), "ground": 0.8, "bits": 16}
    return Scene(**{**usual, **changes})  # type: ignore[arg-type]


@pytest.mark.parametrize("blur", [0.0, 0.3, 1.2, 3.0])
def test_the_centroid_and_the_area_of_a_disc_are_its_centre_and_its_area(blur: float) -> None:
    """Over sub-pixel positions and angles of the grid: the worst of all, not the mean. Area over circumference is an edge."""
    random = np.random.default_rng(8)
    for angle in np.radians([0.0, 7.3, 45.0, 90.0, 133.7, 291.0]):
        scene = small(size=(200, 200), distance=90.0, blur=blur, middle=tuple(random.uniform(98.0, 101.0, 2)))
        found = centroids(scene, float(angle))
        np.testing.assert_allclose(found[:, 1:], scene.centres(float(angle)), rtol=0.0, atol=1e-3)
        np.testing.assert_allclose(found[:, 0] / (2.0 * np.pi * 17.3), 17.3 / 2.0, rtol=0.0, atol=1e-3)


def test_8_bits_are_rounded_and_no_less_exact_otherwise() -> None:
    """Rounding has 1/sqrt(12) of a grey value in each of some 1500 pixels of the edge, 28 px in x from the centre: 0.4e-3."""
    for angle in (0.0, 0.4, 2.0):
        scene = Scene(markers=(0.2, 0.2), ground=0.8, middle=(320.37, 238.81), offset=(1.5, -2.5), bits=16)
        np.testing.assert_allclose(centroids(scene, angle)[:, 1:], scene.centres(angle), rtol=0.0, atol=1e-4)
        coarse = replace(scene, bits=8)
        np.testing.assert_allclose(centroids(coarse, angle)[:, 1:], scene.centres(angle), rtol=0.0, atol=4.0 * 0.4e-3)


@pytest.mark.slow("rig")
def test_a_blurred_edge_has_the_profile_of_a_blurred_disc() -> None:
    """A disc under a Gaussian, at a distance from its centre, is a noncentral chi-square; over a pixel by Gauss-Legendre.

    Cells of 1/4 px leave first moments out, which lie within h^2/24 of their mean: times the slope of a Gaussian, 6e-4.
    """
    scene = small(blur=1.2, middle=(79.6, 59.3))
    dark = darkness(scene)
    nodes, weights = np.polynomial.legendre.leggauss(6)
    y, x = np.indices(dark.shape)
    expected = np.zeros(dark.shape)
    for centre in scene.centres(0.0):
        for node_x, weight_x in zip(nodes / 2.0, weights / 2.0, strict=True):
            for node_y, weight_y in zip(nodes / 2.0, weights / 2.0, strict=True):
                away = (x + node_x - centre[0]) ** 2 + (y + node_y - centre[1]) ** 2
                expected += weight_x * weight_y * ncx2.cdf(17.3**2 / 1.44, 2.0, away / 1.44)
    assert np.abs(dark - expected).max() < 1.5e-3
    assert np.abs(dark - expected).mean() < 1e-4


def test_turning_is_against_the_clock_about_the_middle() -> None:
    scene = small(middle=(80.0, 60.0), direction=np.radians(10.0), offset=(4.0, 1.0))
    first, second = scene.centres(0.0)
    assert second - first == pytest.approx([75.0 * np.cos(np.radians(10.0)), -75.0 * np.sin(np.radians(10.0))])
    assert (first + second) / 2.0 == pytest.approx([84.0, 61.0])
    quarter = scene.centres(np.pi / 2.0)
    assert (quarter[0] + quarter[1]) / 2.0 == pytest.approx([81.0, 56.0])  # from right of the middle to above it
    assert quarter[1] - quarter[0] == pytest.approx([second[1] - first[1], first[0] - second[0]])


def test_without_a_middle_the_target_turns_about_that_of_the_picture() -> None:
    assert small().centres(1.0).mean(axis=0) == pytest.approx([79.5, 59.5])


def camera() -> Camera:
    return Camera(aspect=1.02, tilt=0.25, tilt_direction=0.7, distance=900.0, centre=(70.0, 65.0), radial=(4e-6, -1e-10))


def test_a_camera_sees_as_its_definition_says() -> None:
    """By rotation of points in space, pinhole, lens and grid, one after the other."""
    points = np.random.default_rng(3).uniform(0.0, 120.0, (50, 2))
    axis = np.array([-np.sin(0.7), np.cos(0.7), 0.0])  # across the direction that recedes; z points away from the camera
    expected = []
    for x, y in points:
        place = np.array([x - 70.0, 65.0 - y, 0.0])
        along, sine, cosine = np.dot(axis, place) * axis, np.sin(0.25), np.cos(0.25)
        place = along + (place - along) * cosine + np.cross(place, axis) * sine
        right, up = 900.0 * place[:2] / (900.0 + place[2])
        square = right**2 + up**2
        stretch = 1.0 + 4e-6 * square - 1e-10 * square**2
        expected.append([70.0 + stretch * right / 1.02, 65.0 - stretch * up])
    np.testing.assert_allclose(seen(points, camera(), (160, 120)), expected, rtol=0.0, atol=1e-10)
    direction = 50.0 * np.array([np.cos(0.7), -np.sin(0.7)])
    near, far = seen(np.array([70.0, 65.0]) + np.outer([-1.0, 1.0], direction), camera(), (160, 120))
    assert np.hypot(*(far - [70.0, 65.0])) < np.hypot(*(near - [70.0, 65.0])) - 1.0  # what recedes looks smaller


def test_a_camera_that_does_nothing_changes_nothing() -> None:
    points = np.random.default_rng(3).uniform(0.0, 120.0, (50, 2))
    np.testing.assert_allclose(seen(points, Camera(), (160, 120)), points, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("blur", [0.0, 1.0])
def test_a_marker_seen_by_a_camera_covers_what_the_image_of_its_circle_encloses(blur: float) -> None:
    """Area and centroid by Gauss's shoelace over the image of the circle."""
    scene = small(blur=blur, camera=camera())
    found = centroids(scene, 0.6)
    turn = 2.0 * np.pi * np.arange(100_000) / 100_000
    for (area, x, y), middle in zip(found, small().centres(0.6), strict=True):
        a, b = seen(middle + 17.3 * np.column_stack((np.cos(turn), np.sin(turn))), camera(), (160, 120)).T
        next_a, next_b = np.roll(a, -1), np.roll(b, -1)
        cross = a * next_b - next_a * b
        assert area == pytest.approx(cross.sum() / 2.0, abs=1e-3 * 2.0 * np.pi * 17.3)
        assert x == pytest.approx(((a + next_a) * cross).sum() / (3.0 * cross.sum()), abs=1e-3)
        assert y == pytest.approx(((b + next_b) * cross).sum() / (3.0 * cross.sum()), abs=1e-3)


def test_light_grows_towards_its_direction_and_is_clipped() -> None:
    scene = small(markers=(0.5, 0.5), ground=0.5, gradient=0.3, gradient_direction=np.radians(30.0))
    picture = render(scene, 0.0, np.random.default_rng(0)) / 65535.0
    y, x = np.indices(picture.shape)
    right, up = x - 79.5, 59.5 - y
    along = right * np.cos(np.radians(30.0)) + up * np.sin(np.radians(30.0))
    np.testing.assert_allclose(picture, 0.5 * (1.0 + 0.3 * along / 160.0), rtol=0.0, atol=1e-5)
    bright = render(replace(scene, exposure=1.8), 0.0, np.random.default_rng(0))
    np.testing.assert_array_equal(bright == 65535, 1.8 * picture > 1.0)


def test_noise_has_its_deviation_and_comes_from_its_generator() -> None:
    scene = small(markers=(0.5, 0.5), ground=0.5, noise=0.02)
    picture = render(scene, 0.0, np.random.default_rng(1)) / 65535.0
    count = picture.size
    assert picture.mean() == pytest.approx(0.5, abs=4.0 * 0.02 / np.sqrt(count))
    assert picture.std() == pytest.approx(0.02, rel=4.0 / np.sqrt(2.0 * count))
    assert np.array_equal(picture, render(scene, 0.0, np.random.default_rng(1)) / 65535.0)
    assert not np.array_equal(picture, render(scene, 0.0, np.random.default_rng(2)) / 65535.0)


def test_a_marker_as_bright_as_the_ground_or_out_of_the_picture_is_not_seen() -> None:
    hidden = render(small(markers=(0.8, 0.8)), 0.0, np.random.default_rng(0))
    assert set(hidden.ravel().tolist()) == {round(0.8 * 65535)}
    one = darkness(small(markers=(0.2, 0.8)))
    assert one.sum() == pytest.approx(np.pi * 17.3**2, rel=1e-3)
    assert one[:, 80:].max() == 0.0
    away = render(small(middle=(79.5, 500.0)), 0.0, np.random.default_rng(0))
    assert set(away.ravel().tolist()) == {round(0.8 * 65535)}


def test_a_marker_at_the_border_is_cut_by_it() -> None:
    whole, cut = darkness(small(middle=(79.5, 59.5))), darkness(small(size=(80, 120), middle=(79.5, 59.5)))
    np.testing.assert_array_equal(cut, whole[:, :80])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"size": (4, 120)}, "size: width = 4 must be 8 or more"),
        ({"radius": 0.0}, "radius = 0.0  must lie in (0, inf)"),
        ({"blur": -1.0}, "blur = -1.0  must lie in [0, inf)"),
        ({"markers": (0.1, -0.1)}, "markers[1] = -0.1  must lie in [0, inf)"),
        ({"bits": 12}, "bits = 12 must be 8 or 16"),
        ({"gradient": 2.5}, "gradient = 2.5  must lie in (-2, 2)"),
    ],
)
def test_a_scene_that_cannot_be_is_refused(changes: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError) as refused:  # noqa: PT011
        small(**changes)
    assert str(refused.value) == said.replace("  ", " ")
