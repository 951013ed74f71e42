"""Tables of starting torque and of no-load running torque, as test engineers write them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.identify import Identified, identify

TEMPERATURE = np.array([-10.0, 0.0, 10.0, 20.0, 30.0, 40.0])  # degC
LOAD = np.array([0.0, 10.0, 0.0, 40.0, 20.0, 20.0])  # N.m
NOISE = 0.05 * np.random.default_rng(1).standard_normal(6)  # cN.m


def found(folder: Path, header: str, *columns: np.ndarray) -> Identified:
    np.savetxt(folder / "table.csv", np.column_stack(columns), "%.6g", ",", header=header, comments="")
    return identify("csg-20-100", [folder / "table.csv"])


@pytest.mark.parametrize("name", ["starting torque", "Losbrechmoment", "break-away torque", "no-load starting torque"])
def test_a_starting_torque_is_the_breakaway_torque_of_the_input(tmp_path: Path, name: str) -> None:
    (result,) = found(tmp_path, f"{name} [cNm]", 6.1 + NOISE).files
    (estimate,) = result.estimates
    assert estimate.path == "gear.friction_input.breakaway"
    assert not estimate.why
    assert estimate.value == pytest.approx(0.061, abs=3.0 * estimate.sigma)
    assert estimate.sigma == pytest.approx(5e-4 / np.sqrt(6.0), rel=0.8)


def test_load_and_temperature_are_taken_out(tmp_path: Path) -> None:
    torque = 6.1 - 0.04 * (TEMPERATURE - TEMPERATURE.mean()) + 0.09 * LOAD + NOISE
    identified = found(tmp_path, "temp [degC],load [Nm],starting torque [cNm]", TEMPERATURE, LOAD, torque)
    (result,) = identified.files
    (estimate,) = result.estimates
    assert estimate.value == pytest.approx(0.061, abs=3.0 * estimate.sigma)
    assert identified.gear_set.gear.friction_input.breakaway == estimate.value
    told = " ".join(result.remarks)
    assert "at 15 °C, without load" in told
    assert "for each N·m of load torque" in told
    assert "for each K of temperature" in told


def test_a_backdriving_torque_determines_no_parameter(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="contains the loss of the mesh, and determines no parameter by itself: give that of"):
        found(tmp_path, "backdriving torque [Nm]", 9.0 + NOISE)


def test_one_trial_shows_no_scatter(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="1 rows show no scatter of a starting torque; 2 are the least"):
        found(tmp_path, "starting torque [cNm]", np.array([6.1]))


def test_a_no_load_running_torque_is_measured_at_the_input(tmp_path: Path) -> None:
    """Its name contains the word of a load, which it does not have: it was read as of the output."""
    speed = np.array([300.0, 500.0, 1000.0, 1500.0, 2000.0, 2500.0, 3000.0, 3500.0])
    torque = 6.0 + 0.0015 * speed + 0.02 * np.random.default_rng(2).standard_normal(len(speed))
    (result,) = found(tmp_path, "speed [rpm],no-load running torque [cNm]", speed, torque).files
    coulomb = next(each for each in result.estimates if each.path == "gear.friction_input.coulomb")
    assert coulomb.value == pytest.approx(0.06, abs=3.0 * coulomb.sigma)
    assert not result.failed
