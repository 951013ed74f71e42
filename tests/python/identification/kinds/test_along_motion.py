"""Logs along their motion: which friction is identified, against torques written down here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.files.gear_set import GearSet
from strainwave.identification.kinds.along_motion import ONE_WAY

from tests.python.command import strainwave

Array = NDArray[np.float64]

START, RATIO, CONSTANT = "hfuc-20-80", -80.0, 0.08
COULOMB, VISCOUS = "gear.friction_input.coulomb", "gear.friction_input.viscous"
TRUTH = {COULOMB: 0.05, VISCOUS: 3e-4, "load.gravity_torque": 10.0}
MOTOR = {"torque_constant": CONSTANT, "motor_inertia": 1e-4}
TIME = np.arange(0.0, 20.0, 0.004)


def record(steady: float, zero: float, seed: int) -> sw.Recording:
    """A log of a joint with an arm; a steady speed [rad/s] of more than 0.9 makes it turn one way only, zero [A] is that of the
    current."""
    waves = ((0.45, 0.7, 0.3), (0.45, 2.9, 1.0))  # of the speed: amplitude, frequency, phase
    angle = steady * TIME - sum(a / w * np.cos(w * TIME + p) for a, w, p in waves)
    speed = steady + sum(a * np.sin(w * TIME + p) for a, w, p in waves)
    rise = sum(a * w * np.cos(w * TIME + p) for a, w, p in waves)
    turning: Array = RATIO * speed
    rotor = (MOTOR["motor_inertia"] + GearSet.read(START).gear.input_inertia) * RATIO
    torque = rotor * rise + (0.8 * rise + 10.0 * np.sin(angle)) / RATIO + 0.05 * np.sign(turning) + 3e-4 * turning
    random = np.random.default_rng(seed)
    current = torque / CONSTANT + zero + 0.05 * random.standard_normal(len(TIME))
    columns = {"time": TIME, "input_angle": RATIO * angle + 1e-4 * random.standard_normal(len(TIME)), "current": current}
    return sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"})


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("logs")
    record(1.0, 0.5, 1).to_csv(place / "one_way.csv")
    record(0.1, 0.5, 2).to_csv(place / "both_ways.csv")
    return place


@pytest.mark.slow("identification")
def test_one_direction_does_not_separate_coulomb_friction_from_the_zero_of_the_torque(folder: Path) -> None:
    options = [f"--constant={name}={value}" for name, value in MOTOR.items()]
    printed = strainwave("identify", START, "one_way.csv", *options, "--out=one", folder=folder).stdout
    gear_set = GearSet.read(folder / "one" / "gear.toml")
    coulomb = gear_set.gear.friction_input.coulomb
    assert coulomb == pytest.approx(0.05 - 0.5 * CONSTANT, abs=1e-3)  # with the zero in it, as the input turns backward
    assert gear_set.sources[COULOMB] == sw.files.Entry(f"fitted but not identified: {ONE_WAY}")
    assert gear_set.sources[VISCOUS].source == "identified from one_way.csv"
    assert f"not identified: {COULOMB} {coulomb:.3g} N.m, one_way.csv: {ONE_WAY}" in " ".join(printed.split())


@pytest.mark.slow("identification")
def test_both_directions_separate_them_and_their_log_gives_the_friction(folder: Path) -> None:
    found = sw.identify(START, [folder / "one_way.csv", folder / "both_ways.csv"], mapping=sw.FileMapping(constants=MOTOR))
    both = {each.path: each for each in found.files[1].estimates}
    for path, truth in TRUTH.items():
        assert both[path].state == "identified"
        assert abs(both[path].value - truth) < 4.0 * both[path].sigma < 0.2 * truth  # another law of friction predicts as well
    assert found.gear_set.gear.friction_input.coulomb == both[COULOMB].value
    assert found.gear_set.sources[COULOMB].source == "identified from both_ways.csv"


@pytest.mark.slow("identification")
def test_friction_that_noise_hides_is_not_written_as_identified() -> None:
    log = record(0.1, 0.0, 3)
    noise = 40.0 * np.random.default_rng(4).standard_normal(len(TIME))
    rough = log.with_column("current", log["current"] + noise, "A")
    found = sw.identify(START, {"log": rough}, mapping=sw.FileMapping(constants=MOTOR), accept=True)
    own = {each.path: each for each in found.files[0].estimates if each.path in (COULOMB, VISCOUS)}
    assert any(each.why for each in own.values())
    start = sw.GearSet.read(START) if isinstance(START, str) else START
    for path, each in own.items():
        source = found.gear_set.sources[path].source
        assert not source.startswith("identified from ") if each.why else source.startswith("identified from ")
    if all(each.why for each in own.values()):
        assert found.gear_set.gear.friction_input == start.gear.friction_input


@pytest.mark.slow("identification")
def test_a_current_that_was_filtered_longer_than_a_delay_may_be_makes_its_numbers_less_certain() -> None:
    """A filter of 15 ms, seven samples: the inertia was 3 % small within 1 %, and a loss under load was found that is none."""
    time, step = np.arange(0.0, 30.0, 0.002), 0.002
    angle = 0.8 * np.sin(0.9 * time) + 0.3 * np.sin(2.1 * time + 1.0) + 0.08 * np.sin(4.7 * time + 2.0)
    speed, rise = np.gradient(angle, step), np.gradient(np.gradient(angle, step), step)
    torque = (2.1 * rise + 22.0 * np.sin(angle)) / 100.0 + 0.055 * np.tanh(500.0 * speed) + 3.5e-2 * speed
    filtered, share = torque.copy(), step / (0.015 + step)
    for place in range(1, len(time)):
        filtered[place] = filtered[place - 1] + share * (torque[place] - filtered[place - 1])
    filtered += 5e-4 * np.random.default_rng(2).standard_normal(len(time))
    columns = {"time": time, "input_angle": -100.0 * angle, "input_torque": -filtered}
    log = sw.Recording(columns, {"time": "s", "input_angle": "rad", "input_torque": "N.m"})
    (file,) = sw.identify("csg-20-100", {"log": log}).files
    (remark,) = (each for each in file.remarks if each.startswith("input_torque comes about "))
    assert 6.0 < float(remark.split()[3]) < 7.5  # a filter of the first order delays slow motion by its time constant
    assert " ms, behind the motion: " in remark
    estimates = {each.path: each for each in file.estimates if not each.why}
    rotor = 1e4 * sw.load("csg-20-100").input_inertia
    truth = {"load.inertia": 2.1 - rotor, "load.gravity_torque": 22.0, "gear.friction_input.coulomb": 0.055}
    for path, value in truth.items():
        assert abs(estimates[path].value - value) < 2.0 * estimates[path].sigma < 0.15 * value, path
    assert not any(path.startswith("gear.friction_mesh") for path in estimates)
