"""The inertia of a motor that nobody gave: together with the load, or apart; against a simulated drive."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.identify import Identified
from strainwave.identification.results.combined_parameter import LOAD_WITH_MOTOR, MOTOR_WITHOUT_LOAD
from strainwave.identification.results.file_result import FileEstimate

from tests.python.identification.candidates.test_elastic import TRUTH, run

START = "hfuc-20-50"
CONSTANT, LOAD = TRUTH.motor.torque_constant, 0.8
MOTOR = TRUTH.motor.inertia + TRUTH.gear.input_inertia - sw.load(START).input_inertia  # beside the wave generator of the set


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log of both encoders, and a later one of the motor alone."""
    place, random, time = tmp_path_factory.mktemp("logs"), np.random.default_rng(1), run().time
    columns = {name: run()[name] for name in ("input_angle", "output_angle", "current")}
    columns["output_angle"] = columns["output_angle"] + 1e-5 * random.standard_normal(len(time))
    columns["current"] = columns["current"] + 0.02 * random.standard_normal(len(time))
    units = {"time": "s", "input_angle": "rad", "output_angle": "rad", "current": "A"}
    both, later = ({"time": time[rows]} | {name: each[rows] for name, each in columns.items()}
                   for rows in (time < 5.0, time > 3.0))  # fmt: skip
    del later["output_angle"]
    sw.Recording(both, units).to_csv(place / "both.csv")
    sw.Recording(later, {name: units[name] for name in later}).to_csv(place / "later.csv")
    return place


def identified(folder: Path, *names: str, **constants: float) -> Identified:
    mapping = sw.FileMapping(constants={"torque_constant": CONSTANT} | constants)
    return sw.identify(START, [folder / name for name in names], mapping=mapping)


def of_file(found: Identified, place: int) -> dict[str, FileEstimate]:
    return {each.path: each for each in found.files[place].estimates}


@pytest.mark.slow("identification")
def test_two_encoders_separate_motor_and_load_and_the_gear_file_has_what_is_printed(folder: Path) -> None:
    found = identified(folder, "both.csv", "later.csv")
    both, later = of_file(found, 0), of_file(found, 1)
    for estimate, truth in ((both["load.inertia"], LOAD), (later["load.inertia"], LOAD)):
        assert abs(estimate.value - truth) < 4.0 * estimate.sigma < 0.4 * truth
    rotor, share = both["motor.inertia"], LOAD / 50.0**2 / MOTOR  # the load, less which it is what the torque shows
    assert abs(rotor.value - MOTOR) < 2.0 * rotor.sigma
    assert rotor.sigma == pytest.approx(share * both["load.inertia"].sigma / LOAD * MOTOR, rel=0.2)
    assert any(each.startswith(MOTOR_WITHOUT_LOAD) for each in found.files[0].remarks)
    assert "the inertia of the motor is that of both.csv, and load.inertia is without it" in found.files[1].remarks
    saved, sources = found.gear_set, found.gear_set.sources
    for path, value in (("motor.inertia", saved.motor.inertia), ("load.inertia", saved.load.inertia)):
        assert value == both[path].value
        assert sources[path] == sw.files.Entry("identified from both.csv", uncertainty=both[path].sigma)
    covariance = saved.covariance  # the friction is of another fit than the inertia of the load
    assert covariance is not None
    assert covariance.correlation("load.inertia", "gear.friction_input.viscous") == pytest.approx(0.0, abs=1e-9)
    assert covariance.correlation("load.gravity_torque", "gear.friction_input.viscous") > 0.1
    assert covariance.correlation("gear.hysteresis.stiffness[0]", "gear.hysteresis.breakaway[0]") > 0.1


@pytest.mark.slow("identification")
def test_one_encoder_determines_both_together(folder: Path) -> None:
    found = identified(folder, "later.csv")
    (load,) = (each.estimate for each in found.parameters if each.estimate.path == "load.inertia")
    assert abs(load.value - LOAD - MOTOR * 50.0**2) < 4.0 * load.sigma
    assert LOAD_WITH_MOTOR in found.files[0].remarks
    assert found.gear_set.load.inertia == load.value
    assert found.gear_set.motor.inertia == 0.0


@pytest.mark.slow("identification")
def test_a_load_that_is_given_leaves_the_motor(folder: Path) -> None:
    found = identified(folder, "later.csv", load_inertia=LOAD)
    motor = of_file(found, 0)["motor.inertia"]
    assert not found.failed
    assert abs(motor.value - MOTOR) < 4.0 * motor.sigma < 0.3 * MOTOR
    assert found.gear_set.motor.inertia == motor.value
    assert found.gear_set.load.inertia == LOAD
    assert found.gear_set.load.gravity_torque == pytest.approx(15.0, rel=0.02)
    too_large = identified(folder, "later.csv", load_inertia=1.5)
    assert "given inertia of the load" in {check.name for check in too_large.failed}
