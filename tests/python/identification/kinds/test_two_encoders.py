"""Orders of two encoders in the gear: as measured at some speeds, or as its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.identification.kinds.two_encoders import curves_of_orders, orders_of, with_error
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.orders.two_encoders import transmission_error

SPEEDS = "10 to 60 1/min of the input"
PATH = "gear.kinematic_error.amplitude[0]"


def error() -> sw.orders.TransmissionError:
    theta = 30.0 * np.sin(np.linspace(0.0, 6.0, 1000))
    output = theta / 100.0 - 3e-4 * np.sin(2 * theta) + np.random.default_rng(1).normal(0.0, 1e-5, len(theta))
    return sw.transmission_error(
        sw.Recording({"input_angle": theta, "output_angle": output}, {"input_angle": "rad", "output_angle": "rad"})
    )


def test_amplitudes_that_change_with_the_speed_are_not_those_of_the_gear_alone() -> None:
    found = replace(error(), speeds=SPEEDS, vibrates=True)
    states = {each.state for each in orders_of(found)}
    assert states == {"identified in combination"}
    known = with_error(GearSoFar(GearSet.read("csg-20-100")), found, "te.csv")
    assert known.gear_set.sources[PATH].source.startswith(
        f"identified in combination: amplitudes are those measured at {SPEEDS}"
    )
    assert "kinematic_error" not in known.determined


def test_amplitudes_at_one_speed_name_it_and_others_do_not() -> None:
    at_one = replace(error(), speeds="60 1/min of the input")
    for found, source in ((error(), "identified from te.csv"), (at_one, "identified from te.csv, at 60 1/min of the input")):
        assert {each.state for each in orders_of(found)} == {"identified"}
        known = with_error(GearSoFar(GearSet.read("csg-20-100")), found, "te.csv")
        assert known.gear_set.sources[PATH].source == source
        assert "kinematic_error" in known.determined


def test_orders_are_as_uncertain_as_amplitude_and_phase_make_them() -> None:
    time = np.arange(0.0, 6.0, 0.004)
    angle = 30.0 * np.sin(0.5 * time) + 5.0 * np.sin(1.3 * time)
    noise = np.random.default_rng(0).normal(0.0, 1e-5, len(time))
    output = -angle / 100 - 2e-4 * np.sin(2 * angle + 0.4) + noise
    columns, units = {"time": time, "input_angle": angle, "output_angle": output}, {"time": "s"}
    found = transmission_error(sw.Recording(columns, units | dict.fromkeys(list(columns)[1:], "rad")), ratio=-100)
    curves = curves_of_orders(found)
    off = curves["modelled"] - 2e-4 * np.sin(2.0 * found.curves["input_angle"] + 0.4)
    (second,) = [each for each in found.orders if each.significant]
    phase = 2.0 * found.curves["input_angle"] + second.phase
    slopes = np.stack([np.sin(phase), second.amplitude * np.cos(phase)], axis=1)
    sigma = np.linalg.norm(slopes * [second.amplitude_sigma, second.phase_sigma], axis=1)
    np.testing.assert_allclose(curves["sigma"], sigma, rtol=1e-9)
    assert np.sqrt(np.mean(off**2)) < 3.0 * np.sqrt(np.mean(sigma**2))
    np.testing.assert_array_equal(curves["residual"], found.curves["residual"])


def recorded(folder: Path, degrees: float, place: int, rate: float) -> Path:
    """A file of two encoders at a temperature [°C], of a gear whose order 2 grows by a rate [rad/K]; all make one motion."""
    time = np.arange(0.0, 20.0, 0.02)
    theta = 30.0 * np.sin(0.5 * time)
    error = (3e-4 + rate * (degrees - 20.0)) * np.sin(2.0 * theta + 0.3)
    output = -theta / 100.0 - error + np.random.default_rng(place).normal(0.0, 1e-5, len(time))
    columns = {"time": time, "input_angle": theta, "output_angle": output, "temperature": np.full(len(time), degrees)}
    units = {"time": "s", "input_angle": "rad", "output_angle": "rad", "temperature": "degC"}
    path = folder / f"record-{place}.csv"
    sw.Recording(columns, units).to_csv(path)
    return path


def test_files_at_several_temperatures_determine_how_the_error_changes(tmp_path: Path) -> None:
    files = [recorded(tmp_path, degrees, place, 2e-6) for place, degrees in enumerate((10.0, 30.0, 50.0))]
    found = sw.identify("csg-20-100", files)
    assert not found.failed
    (change,) = (each.estimate for each in found.parameters if "change" in each.estimate.path)
    assert abs(change.value - 2e-6) < 3.5 * change.sigma
    law: Any = found.accepted.gear.kinematic_error
    assert law.reference_temperature == pytest.approx(303.15)
    angle = np.linspace(0.0, 6.0, 100)
    assert law.replace(temperature=323.15).error(angle) == pytest.approx(3.6e-4 * np.sin(2.0 * angle + 0.3), abs=4e-6)
    (picture,) = found.files[-1].pictures
    assert picture.label == "amplitude of order 2"
    assert picture.curves["temperature"] == pytest.approx([283.15, 303.15, 323.15])
    assert picture.curves["modelled"] == pytest.approx(picture.curves["amplitude"], rel=0.01)
    assert found.gear_set.name.endswith("and 2 more")
    path = tmp_path / "gear.toml"
    found.accepted.save(path)
    assert GearSet.read(path).gear.kinematic_error == law


def test_one_motion_at_two_temperatures_is_two_measurements(tmp_path: Path) -> None:
    files = [recorded(tmp_path, degrees, place, 2e-6) for place, degrees in enumerate((10.0, 50.0))]
    found = sw.identify("csg-20-100", files)
    assert [each.same_as for each in found.files] == ["", "", ""]
    (change,) = (each.estimate for each in found.parameters if "change" in each.estimate.path)
    assert abs(change.value - 2e-6) < 3.5 * change.sigma < 1e-7


@pytest.mark.parametrize(("rate", "degrees"), [(0.0, (20.0, 20.0)), (2e-6, (20.0, 50.0))])
def test_a_repeated_motion_is_no_copy_and_a_rounded_copy_is_one(
    rate: float, degrees: tuple[float, float], tmp_path: Path
) -> None:
    """The temperatures are not in the files: the errors of the output, and their noise, differ."""
    names, units = ("time", "input_angle", "output_angle"), {"time": "s", "input_angle": "rad", "output_angle": "rad"}
    for place, each in enumerate(degrees):
        record = sw.Recording.read(recorded(tmp_path, each, place, rate))
        sw.Recording({name: record[name] for name in names}, units).to_csv(tmp_path / f"run-{place}.csv")
    rounded = sw.Recording({name: np.round(record[name][::2], 6) for name in names}, units)
    rounded.to_csv(tmp_path / "rounded.csv")
    found = sw.identify("csg-20-100", [tmp_path / f"{name}.csv" for name in ("run-0", "run-1", "rounded")])
    assert [each.same_as for each in found.files] == ["", "", "run-1.csv"]


def test_files_at_one_temperature_determine_no_change(tmp_path: Path) -> None:
    found = sw.identify("csg-20-100", [recorded(tmp_path, 20.0, place, 2e-6) for place in range(2)])
    assert found.accepted.gear.kinematic_error.name == "fourier"
    assert not any("change" in each.estimate.path for each in found.parameters)


def test_an_error_that_does_not_change_stays_one_law_of_all_files(tmp_path: Path) -> None:
    files = [recorded(tmp_path, degrees, place, 0.0) for place, degrees in enumerate((10.0, 30.0, 50.0))]
    error: Any = sw.identify("csg-20-100", files).accepted.gear.kinematic_error
    assert (error.name, error.amplitude) == ("fourier", pytest.approx([3e-4], abs=1e-6))
