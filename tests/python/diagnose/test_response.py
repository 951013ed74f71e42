"""Current per kinematic error of a recording: that of the plan, of section 7.9 of the physics, or of virtual work."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.diagnosis import Question, RunDiagnosis, diagnosed
from strainwave.diagnose.refusals import usable
from strainwave.diagnose.smallest_error import CURRENT_COLUMN, SteadyRun, detection_limit

from tests.evidence.detection_limits import signature_drive
from tests.support.samples import sample
from tests.support.signature_drive import signature_ramp

NOISE = 0.05  # A
SEEDS = sample(3, 6)  # the level of the noise of one record has a standard deviation of 11 %


def noisy(record: sw.Recording, noise: float, seed: int) -> sw.Recording:
    return record.with_column(
        CURRENT_COLUMN, record[CURRENT_COLUMN] + np.random.default_rng(seed).normal(0.0, noise, len(record)), "A"
    )


def diagnosis(record: sw.Recording, gear_set: sw.GearSet) -> RunDiagnosis:
    return diagnosed([usable(record, "run", ratio=100.0)], Question(gear_set, ratio=100.0)).runs[0]


def to_and_fro() -> sw.Recording:
    """Record of a speed that turns round under 20 N.m, each direction for 10 s."""
    drive = signature_drive()
    command = sw.scenario.sine(amplitude=0.1, frequency=0.05, duration=20.0)
    run = sw.simulate(drive, command, sample=2e-3, load_torque=20.0, record=["input_angle", "output_angle", CURRENT_COLUMN])
    return noisy(run, NOISE, 0)


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("load_torque", [0.0, 20.0])
def test_the_error_that_a_recording_shows_is_that_of_the_plan(load_torque: float) -> None:
    drive = signature_drive()  # with friction of the input, which one direction does not separate from the load
    gear_set = sw.GearSet.of(drive, name="drive", source="a test")
    record = SteadyRun.of(drive, 10.0, load_torque, 20.0, 500.0, 2.0).with_error(0.0)
    runs = [diagnosis(noisy(record, NOISE, seed), gear_set) for seed in range(SEEDS)]
    assert all(run.response.startswith("by the model of the drive in its loop") for run in runs)
    assert {run.verdict == "insensitive" for run in runs} == {not load_torque}
    for place, each in enumerate(runs[0].orders):
        planned = detection_limit(
            drive, speed=10.0, load_torque=load_torque, duration=20.0, sample_rate=500.0, noise=NOISE,
            order=each.order.per_input, tests=len(runs[0].orders),
        )  # fmt: skip
        shown = np.mean([run.orders[place].error for run in runs])
        assert shown == pytest.approx(planned.amplitude, rel=0.2), each.order.name


@pytest.mark.parametrize(("load_torque", "current", "verdict"), [(0.0, 1.2e-3, "insensitive"), (20.0, 0.24, "no line found")])
def test_the_signature_of_section_7_9_without_load_is_insensitive(load_torque: float, current: float, verdict: str) -> None:
    """About 1.2 mA without load, 240 mA under 20 N.m; virtual work has no current without load."""
    ramp = signature_ramp(load_torque)
    run = ramp.settled(ramp.with_error(sw.kinematic_error.Fourier(order=[], amplitude=[], phase=[])).run())
    found = diagnosis(noisy(run, 0.03, 0), sw.GearSet.of(ramp.drive, name="drive", source="a test"))
    assert found.verdict == verdict
    (two,) = (each for each in found.orders if each.order.per_input == 2.0)
    assert two.expected == pytest.approx(current, rel=0.05)  # of the error of 3e-4 rad that the drive has
    assert two.needed > two.expected if not load_torque else two.needed < 0.05 * two.expected


@pytest.mark.slow("diagnose")
def test_without_a_whole_drive_the_response_is_that_of_virtual_work() -> None:
    found = diagnosis(to_and_fro(), sw.GearSet.read("csg-25-100"))
    assert found.response.startswith("by virtual work")
    assert "(the gear has no motor, load, controller)" in found.response
    run = usable(to_and_fro(), "run", ratio=100.0)
    assert "(no gear is given)" in diagnosed([run], Question(ratio=100.0)).runs[0].response
    two = found.orders[0]
    assert two.needed / two.error == pytest.approx(2.0 * 100.0 * found.load, rel=1e-9)
    fast = sw.GearSet.of(
        signature_drive().replace({"control.limit": 0.3}), name="weak", source="a test"
    )  # it cannot hold the speed
    assert diagnosis(to_and_fro(), fast).response.startswith("by virtual work")


def test_one_direction_without_a_whole_drive_has_no_response() -> None:
    """Friction looks like a load, and a record without load would claim to show a tenth of an arc minute."""
    record = noisy(SteadyRun.of(signature_drive(), 10.0, 0.0, 20.0, 500.0, 2.0).with_error(0.0), NOISE, 0)
    found = diagnosis(record, sw.GearSet.read("csg-25-100"))
    assert found.response.startswith("not known: one direction does not separate load from friction; reverse the motion")
    assert np.isnan(found.orders[0].error)


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("share", [0.75, 1.25])
def test_an_unloaded_run_is_insensitive_though_its_friction_is_not_that_of_the_file(share: float) -> None:
    drive = signature_drive()
    gear_set = sw.GearSet.of(drive, name="drive", source="a test")
    path = "gear.friction_input.coulomb"
    unit = drive.replace({path: share * drive.gear.friction_input.coulomb})
    record = noisy(SteadyRun.of(unit, 10.0, 0.0, 20.0, 500.0, 2.0).with_error(0.0), NOISE, 0)
    assert diagnosis(record, gear_set).verdict == "insensitive"
