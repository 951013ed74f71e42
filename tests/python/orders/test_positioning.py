"""Positioning of an axis with lost motion, against a play operator by itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.identify import identify
from strainwave.orders.positioning import positioning

PLAY, NOISE = 3.7e-4, 1e-5  # rad
STROKE = np.concatenate([np.arange(0, 40), np.arange(40, 0, -1)]) * 1.5e-4


def reached_of(wanted: np.ndarray, play: float, random: np.random.Generator) -> np.ndarray:
    """Return the angles of an axis behind a play, with a slow error over the angle and noise of the dial."""
    place, places = wanted[0], []
    for each in wanted:
        place = min(max(place, each - 0.5 * play), each + 0.5 * play)
        places.append(place)
    return np.array(places) + 2e-5 * np.sin(500.0 * wanted) + random.normal(0.0, NOISE, len(wanted))


@pytest.mark.parametrize("seed", range(5))
def test_lost_motion_is_that_of_the_play(seed: int) -> None:
    wanted = np.tile(STROKE, 3)
    found = positioning(wanted, reached_of(wanted, PLAY, np.random.default_rng(seed)))
    assert found.lost_motion == pytest.approx(PLAY, abs=4.0 * found.lost_motion_sigma)
    assert found.lost_motion_sigma < 0.02 * PLAY
    assert found.noise == pytest.approx(NOISE, rel=0.4)
    assert found.reversal >= found.lost_motion
    assert found.accuracy >= found.systematic >= found.lost_motion


def test_without_lost_motion_none_is_stated_as_significant() -> None:
    wanted = np.tile(STROKE, 3)
    found = positioning(wanted, reached_of(wanted, 0.0, np.random.default_rng(7)))
    assert abs(found.lost_motion) < 4.0 * found.lost_motion_sigma


def test_one_way_determines_no_lost_motion_but_orders_over_a_turn() -> None:
    wanted = np.radians(np.arange(0.0, 361.0))
    error = np.radians((20.0 * np.sin(wanted) + 5.0 * np.cos(3.0 * wanted)) / 3600.0)
    found = positioning(wanted, wanted + error + np.random.default_rng(0).normal(0.0, 5e-6, len(wanted)))
    assert np.isnan(found.lost_motion)
    assert "lost motion is not determined" in found.remarks[0]
    sizes = {order: 3600.0 * np.degrees(size) for order, size, _ in found.orders}
    assert sizes == {1.0: pytest.approx(20.0, abs=0.4), 3.0: pytest.approx(5.0, abs=0.4)}


def test_orders_of_any_number_are_found_in_the_spectrum() -> None:
    """72 and 144 per turn of a worm wheel, beside an order of the axis and noise that makes none."""
    random = np.random.default_rng(3)
    wanted = np.arange(3600) * (2.0 * np.pi / 3600)
    of_worm = 4e-5 * np.sin(72.0 * wanted + 1.0) + 1e-5 * np.cos(144.0 * wanted) + 6e-5 * np.cos(wanted)
    noise = random.normal(0.0, 2e-5, len(wanted))
    found = positioning(wanted, wanted + of_worm + noise).orders
    assert [order for order, _, _ in found] == [1.0, 72.0, 144.0]
    for (_, size, sigma), true in zip(found, (6e-5, 4e-5, 1e-5), strict=True):
        assert sigma == pytest.approx(2e-5 * np.sqrt(2.0 / len(wanted)), rel=0.1)
        assert size == pytest.approx(true, abs=4.0 * sigma)
    assert not positioning(wanted, wanted + noise).orders


def test_few_rows_are_refused() -> None:
    with pytest.raises(ValueError, match="positioning needs 8 or more rows"):
        positioning([0.0, 1.0], [0.0, 1.0])
    with pytest.raises(ValueError, match="commanded angle does not change"):
        positioning(np.zeros(9), np.zeros(9))


@pytest.mark.parametrize("header", ["step,commanded_deg,measured_deg", "step,target angle [deg],error [arcsec]"])
def test_a_file_of_a_dial_is_recognised(tmp_path: Path, header: str) -> None:
    wanted = np.tile(STROKE, 3)
    reached = reached_of(wanted, PLAY, np.random.default_rng(1))
    second = 3600.0 * np.degrees(reached - wanted) if "error" in header else np.degrees(reached)
    rows = np.column_stack([np.arange(len(wanted)), np.degrees(wanted), second])
    np.savetxt(tmp_path / "dial.csv", rows, "%.7f", ",", header=header, comments="")
    (parameter,) = identify("csg-20-100", [tmp_path / "dial.csv"]).parameters
    assert parameter.estimate.path == "lost_motion"
    assert parameter.estimate.value == pytest.approx(PLAY, abs=4.0 * parameter.estimate.sigma)


def test_a_transmission_error_over_the_input_has_orders_of_the_input(tmp_path: Path) -> None:
    turns = np.arange(0.0, 50.0, 0.05)
    error = 20.0 * np.cos(4.0 * np.pi * turns) + np.random.default_rng(2).normal(0.0, 0.3, len(turns))
    np.savetxt(tmp_path / "te.csv", np.column_stack([turns, error]), "%.4f", ",", header="input [rev],TE [arcsec]", comments="")
    found = identify("csg-20-100", [tmp_path / "te.csv"])
    (parameter,) = found.parameters
    assert parameter.estimate.path == "positioning_error of order 2"
    assert 3600.0 * np.degrees(parameter.estimate.value) == pytest.approx(20.0, abs=0.1)
    assert any(remark.startswith("order 2 per turn of the input: ") for remark in found.files[0].remarks)
