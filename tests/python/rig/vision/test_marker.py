"""Markers in pictures whose centres are known from a closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from strainwave.rig.vision.image import as_image
from strainwave.rig.vision.marker import Marker, find_markers, look

from tests.python.rig.vision.discs import DARK, GROUND, picture, target

Array = NDArray[np.float64]
NOISE = 4.0 / 255.0
SMALL = (160, 240)


def found(pixels: NDArray[Any], **options: Any) -> list[Marker]:
    return find_markers(as_image("picture", pixels).grey, **options)


def errors(markers: list[Marker], discs: list[tuple[float, float, float]]) -> Array:
    """Of each centre over its sigma, to the nearest disc."""
    told = []
    for marker in markers:
        x, y, _ = min(discs, key=lambda disc: np.hypot(disc[0] - marker.x, disc[1] - marker.y))
        told.append([(marker.x - x) / marker.sigma, (marker.y - y) / marker.sigma])
    return np.array(told)


def test_in_a_picture_without_noise_of_sixteen_bits_the_centre_is_right_to_a_ten_thousandth_of_a_pixel() -> None:
    discs = [(61.37, 80.21, 25.0), (171.8, 77.64, 30.0)]
    for gradient in (0.0, 0.3):
        larger, smaller = found(picture(discs, shape=SMALL, full=65535, gradient=gradient))
        for marker, (x, y, radius) in ((smaller, discs[0]), (larger, discs[1])):
            assert abs(marker.x - x) < 2e-4
            assert abs(marker.y - y) < 2e-4
            assert abs(marker.radius - radius) < 2e-3
            assert marker.blur == pytest.approx(np.sqrt(1.2**2 + 1.0 / 12.0), rel=2e-3)  # of the lens, and of a pixel
            assert marker.arc == 1.0
            assert marker.dark
            assert marker.ratio == pytest.approx(1.0, abs=1e-5)


def test_the_contrast_is_that_of_marker_and_ground() -> None:
    for marker in found(picture(target(0.3), noise=NOISE)):
        assert marker.contrast == pytest.approx(GROUND - DARK, abs=2e-3)
        assert marker.clipped == 0.0


@pytest.mark.parametrize("blur", [0.8, 1.2, 2.5, 5.0])
def test_the_blur_is_told(blur: float) -> None:
    for marker in found(picture(target(0.3), blur=blur, noise=NOISE)):
        assert marker.blur == pytest.approx(np.sqrt(blur**2 + 1.0 / 12.0), rel=0.03)


@pytest.mark.slow("rig")
def test_centres_scatter_as_their_sigma_says_and_as_little_as_pixels_allow() -> None:
    """Bound of Cramer and Rao: a px of edge tells (step / noise)^2 / (2 sqrt(pi) blur) of its place, half of it of x.

    Brightness inside and outside is not known beforehand, which costs another tenth.
    """
    radius, blur, step = 25.0, np.sqrt(1.2**2 + 1.0 / 12.0), GROUND - DARK
    told = (step / NOISE) ** 2 / (2.0 * np.sqrt(np.pi) * blur) * np.pi * radius
    random, ratios, sigmas = np.random.default_rng(4), [], []
    for seed in range(60):
        shift = random.uniform(-0.5, 0.5, 4)
        discs = [(61.0 + shift[0], 80.0 + shift[1], radius), (171.0 + shift[2], 77.0 + shift[3], radius)]
        markers = found(picture(discs, shape=SMALL, noise=NOISE, gradient=0.3, seed=seed))
        ratios.append(errors(markers, discs))
        sigmas += [marker.sigma for marker in markers]
    ratio = np.concatenate(ratios)
    assert 0.8 < ratio.std() < 1.25  # of 240 values: within 0.09 of 1 in 19 of 20 draws
    assert abs(ratio.mean()) < 4.0 / np.sqrt(ratio.size)
    assert 0.95 < np.median(sigmas) * np.sqrt(told) < 1.35


def test_colour_depth_and_sign_of_the_contrast_do_not_matter() -> None:
    discs = [(61.37, 80.21, 25.0), (171.8, 77.64, 25.0)]
    plain = found(picture(discs, shape=SMALL, full=65535))
    bright = found(picture(discs, shape=SMALL, dark=GROUND, ground=DARK, full=65535))
    colour = found(np.dstack([picture(discs, shape=SMALL, full=65535)] * 3))
    twelve_bits = found(picture(discs, shape=SMALL, full=4095))
    for others in (bright, colour, twelve_bits):
        for one, other in zip(plain, others, strict=True):
            assert np.hypot(one.x - other.x, one.y - other.y) < 1e-3
    assert not any(marker.dark for marker in bright)
    assert found(picture(discs, shape=SMALL), dark=False) == []


@pytest.mark.parametrize("place", [200.0, 205.0, 209.0])
def test_a_marker_that_is_cut_off_by_the_border_keeps_its_centre(place: float) -> None:
    discs = [(61.37, 80.21, 40.0), (place + 0.3, 77.64, 40.0)]
    markers = sorted(found(picture(discs, shape=SMALL, noise=NOISE)), key=lambda marker: marker.x)
    assert np.max(np.abs(errors(markers, discs))) < 4.0
    seen = 1.0 - np.arccos((239.5 - discs[1][0]) / 40.0) / np.pi
    assert markers[1].arc == pytest.approx(seen, abs=0.07)
    turn = np.linspace(np.pi * (1.0 - seen), np.pi * (1.0 + seen), 400)
    slopes = np.column_stack((np.cos(turn), np.sin(turn), np.ones(400)))  # of distances, by centre and radius
    wanted = np.linalg.inv(slopes.T @ slopes)
    covariance = markers[1].covariance
    assert covariance[0] / covariance[2] == pytest.approx(wanted[0, 0] / wanted[1, 1], rel=0.15)  # the border hides x


def test_dirt_on_the_edge_is_left_out() -> None:
    discs = [(61.37, 80.21, 40.0), (171.8, 77.64, 40.0)]
    pixels = picture(discs, shape=SMALL, noise=NOISE)
    pixels[112:124, 55:70] = 190  # as bright as the ground, over the lower edge of the first
    pixels[30:50, 165:172] = 20  # a dark stroke from outside, up to the upper edge of the second
    markers = sorted(found(pixels), key=lambda marker: marker.x)
    assert np.max(np.abs(errors(markers, discs))) < 4.0
    assert all(0.8 < marker.arc < 0.97 for marker in markers)


def test_a_disc_that_holds_markers_a_ring_and_a_hole_are_told_apart() -> None:
    down, right = np.mgrid[:480, :640]
    plate = np.hypot(right - 319.5, down - 239.5) < 225.0
    pixels = np.where(plate, picture(target(0.3), noise=NOISE), 20).astype(np.uint8)
    for x, y, _ in target(0.3):
        pixels[np.hypot(right - x, down - y) < 8.0] = 200  # a hole in each marker
    markers = found(pixels)
    assert [marker.dark for marker in markers] == [False, True, True]
    assert markers[0].radius == pytest.approx(225.0, abs=0.1)
    assert np.max(np.abs(errors(markers[1:], target(0.3)))) < 4.5


def test_only_what_is_round_and_of_the_size_asked_for_is_a_marker() -> None:
    discs = [*target(0.3), (320.0, 240.0, 12.0)]
    pixels = picture(discs, noise=NOISE)
    pixels[20:90, 20:90] = 20  # a square
    pixels[400:420, 100:160] = 20  # a bar
    assert sorted(round(marker.radius) for marker in found(pixels)) == [12, 40, 40]
    assert sorted(round(marker.radius) for marker in found(pixels, radius=(20.0, 60.0))) == [40, 40]
    assert sorted(round(marker.radius) for marker in found(pixels, radius=(5.0, 20.0))) == [12]


def test_nothing_is_found_where_nothing_is() -> None:
    random = np.random.default_rng(1)
    assert found(np.zeros(SMALL, np.uint8)) == []
    assert found(np.full(SMALL, 255, np.uint8)) == []
    assert found(random.integers(0, 256, SMALL).astype(np.uint8)) == []
    assert found(picture([], shape=SMALL, noise=NOISE, gradient=0.5)) == []
    assert found(np.add.outer(np.arange(160), np.arange(240) // 4).astype(np.uint8)) == []
    assert found(np.tile(np.array([[0, 255], [255, 0]], np.uint8).repeat(8, 0).repeat(8, 1), (10, 15))) == []


@pytest.mark.parametrize(("radius", "message"), [((0.5, 9.0), r"radius\[0\] = 0.5 px must lie in \[2, inf\)"),
                                                 ((9.0, 9.0), r"radius\[1\] = 9.0 px must lie in \(9, inf\)")])  # fmt: skip
def test_radii_out_of_order_are_refused(radius: tuple[float, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        found(picture([], shape=SMALL), radius=radius)


def test_a_picture_of_a_thousand_discs_is_refused_before_their_edges_are_sought() -> None:
    rows, columns = np.mgrid[:20, :20]
    disc = np.where(np.hypot(rows - 10, columns - 10) < 7.0, 30, 220).astype(np.uint8)
    frame = look(as_image("many", np.tile(disc, (35, 35))))
    assert "spots may be markers, and 1000 can be looked at; limit them by radius=(least, most) in px" in frame.fault
