"""Compensations judged on drawn gears: what is known gains, what is assumed does not, and what cannot be gained is stated."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.tuning.candidates import baseline, candidates
from strainwave.tuning.cascade import Plant, Setting
from strainwave.tuning.compensate import _chosen, _drawn, _of_the_drive, _remarks, best_cascade, goal_of
from strainwave.tuning.goals import position, smooth, speed
from strainwave.tuning.judging import Judged, judged
from strainwave.tuning.loops import sharpest

from tests.python.command import refused

STATED = sw.GearSet.read("robot-joint")
KNOWN = STATED.replace(sources=dict.fromkeys(STATED.sources, Entry("measured", spread=0.01)))
MEMBERS = 3  # with the gear as its numbers have it four, which fill the registers of any processor


@pytest.fixture(scope="module")
def known() -> sw.tuning.Compensated:
    return sw.compensate(KNOWN, members=MEMBERS, travel=0.03)


@pytest.mark.whole_path("tuning")
def test_a_model_that_is_known_gains_much_over_the_cascade(known: sw.tuning.Compensated) -> None:
    assert known.gain > 0.4
    assert set(known.chosen.candidate.effects) >= {"torsion"}
    assert known.chosen.upper("tracking error") < known.baseline.median("tracking error")


@pytest.mark.slow("tuning")
def test_what_is_written_runs_as_it_was_judged(known: sw.tuning.Compensated, tmp_path: Path) -> None:
    known.saved.save(tmp_path / "drive.toml")
    drive = sw.load(tmp_path / "drive.toml")
    assert drive.control == known.drive.control
    command = known.goal.command
    run = sw.simulate(drive, command, sample=1e-3, method="exponential")
    period = 2.0 * np.pi / known.goal.pace
    later = (run.time >= period) & (run.time < 2.0 * period)
    error = (command.value(run.time) - run["output_angle"])[later]
    assert np.sqrt(np.mean(error**2)) == pytest.approx(known.chosen.nominal["tracking error"], rel=0.05)


@pytest.mark.slow("tuning")
def test_an_error_of_unknown_phase_is_not_fed_forward() -> None:
    """It adds to the error as often as it takes away."""
    found = sw.compensate(STATED, goal="speed", members=MEMBERS, seed=3)
    with_error = [each for each in found.tried if each.candidate.is_plain and "kinematic error" in each.candidate.effects]
    assert len(with_error) == 2
    assert all(each.median("speed ripple") > 2.0 * each.nominal["speed ripple"] for each in with_error)
    assert "kinematic error" not in found.chosen.candidate.effects
    assert any("kinematic error is assumed" in remark and "both encoders" in remark for remark in found.remarks)


@pytest.mark.slow("tuning")
def test_a_motion_that_creeps_may_have_its_friction_by_the_measured_motion() -> None:
    """A loop at 100 Hz sticks in friction that falls with the speed; friction along the command does not help it, this does."""
    joint = sw.GearSet.read("space-pointing-joint")
    lagging = sw.Sensors(input_speed=sw.sensor.FirstOrder(time_constant=5e-3))
    cold = {"gear.friction_input.reference_temperature": 333.15}
    drive = joint.drive.replace(sensors=lagging, thermal=sw.thermal.Isothermal()).replace(cold)
    found = sw.compensate(drive, goal="smooth", period=0.01, speed=4e-3, members=4)
    observer = found.drive.control.compensation.observer
    assert isinstance(observer, sw.compensation.BristleObserver)
    assert observer.friction == drive.gear.friction_input
    assert found.gain > 0.5
    assert found.chosen.median("time at rest") == 0.0 < found.baseline.median("time at rest")
    assert found.margins == sw.tuning.loop_margins(found.drive)  # an observer of friction is none of its loops


def test_friction_is_by_the_measured_motion_only_where_it_creeps() -> None:
    plant, setting = Plant.of(STATED, 1e-3, 0.0), Setting(0.5, "input", 0.5)
    usual, creeping = (list(candidates(plant, [setting], goal(2e-3, 4.0, "A"), {})) for goal in (speed, smooth))
    more = [each for each in creeping if each.name not in {other.name for other in usual}]
    assert len(creeping) > len(usual)
    for each in more:
        part = each.drive.control.compensation
        assert isinstance(part.observer, sw.compensation.BristleObserver)
        assert part.observer.position_gain == each.drive.control.law.position_gain
        assert "friction" in each.effects


@pytest.mark.slow("tuning")
def test_a_gear_without_effects_needs_none() -> None:
    gear = sw.Gear(kinematics=STATED.gear.kinematics, stiffness=sw.stiffness.Linear(k=1e7), input_inertia=4e-5)
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=5e-5), load=sw.loads.Inertia(inertia=1.0))
    found = sw.compensate(drive, members=3, travel=0.05)
    assert not found.is_compensated
    assert [remark for remark in found.remarks if "the gear has no friction" in remark]


@pytest.mark.slow("tuning")
def test_a_delay_beyond_the_motion_is_stated() -> None:
    plant = Plant.read(KNOWN, 5e-3, 5e-3)
    goal = goal_of("position", plant, travel=0.02, speed=0.1)
    best = best_cascade(plant, goal, _drawn(KNOWN, plant, MEMBERS, 0, known_load=False), "input")
    assert any("a shorter period or delay would gain" in remark for remark in _remarks(KNOWN, plant, goal, best))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"goal": "force"}, "goal"),
        ({"goal": "torque", "torque": -1.0}, "torque"),
        ({"goal": "torque", "torque": 1e6}, r"torque = 1000000\.0 N\.m must lie in \(0, "),
        ({"torque": 20.0}, r"torque = 20\.0 is not used by the goal position, only by torque; leave it out"),
        ({"goal": "speed", "travel": 0.2}, r"travel = 0\.2 is not used by the goal speed, only by position; leave it out"),
        ({"encoder": "both"}, "encoder"),
        ({"period": 0.0}, "period"),
        ({"delay": -1e-3}, "delay"),
        ({"delay": 2e-3}, r"delay = 0\.002 s exceeds the period of 0\.001 s; take a longer period or a shorter delay"),
        pytest.param(
            {"speed": 40.0, "travel": 8.0},
            r"motor is at its limit; the motor takes at most \S+ A: take a lower speed or travel",
            marks=pytest.mark.slow("tuning"),
        ),
        ({"travel": -1.0}, "travel"),
        ({"speed": 0.0}, "speed"),
        ({"members": 1}, "members"),
        ({"members": 10**9}, r"members = 1000000000 must be 10000 or less"),
        ({"period": 1e-9}, r"period = 1e-09 s must be 1e-05 s or more"),
    ],
)
def test_what_is_out_of_range_is_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        sw.compensate(STATED, **{"members": MEMBERS, **changes})  # type: ignore[arg-type]


def test_the_command_refuses_a_travel_that_its_goal_does_not_use(tmp_path: Path) -> None:
    refused(tmp_path, ("compensate", "robot-joint", "--goal", "smooth", "--travel", "0.2"), "travel = 0.2 is not used")


def test_the_spring_of_a_load_is_drawn_and_that_of_a_known_stop_is_not() -> None:
    load = sw.loads.TorsionSpring(inertia=1.0, stiffness=100.0)
    gear_set = STATED.with_parts(load=load, source="assumed")
    plant = Plant.read(gear_set, 1e-3, 0.0)
    drawn, known = (_drawn(gear_set, plant, 3, 0, known_load=each) for each in (False, True))
    assert drawn.keys() - known.keys() == {"load.inertia", "load.stiffness"}


def test_a_gear_alone_is_refused() -> None:
    with pytest.raises(ValueError, match=r"no \[motor\] and no \[load\]"):
        sw.compensate("csg-20-100")


@pytest.mark.slow("tuning")
@pytest.mark.parametrize("name", ["tilt-actuator", "two-inertia-gear"])
def test_drives_of_the_catalogue_run_on_gears_drawn_from_them(name: str) -> None:
    """Of one the pressure angle stands in two parts, which must agree; the other has no friction from which a limit follows."""
    found = sw.compensate(name, members=MEMBERS, travel=0.004)
    assert found.baseline.failures == 0
    assert found.baseline.upper("tracking error") < 2e-3


@pytest.mark.slow("tuning")
def test_the_gain_is_that_on_gears_by_which_nothing_was_chosen(known: sw.tuning.Compensated) -> None:
    """It is chosen on the gears of the seed, and its gain is that on those of the next seed."""
    chosen = next(each for each in known.tried if each.candidate is known.chosen.candidate)
    assert not np.array_equal(chosen.figures["tracking error"], known.chosen.figures["tracking error"])
    assert chosen.nominal == known.chosen.nominal
    plant = Plant.read(KNOWN, 1e-3, 0.0)
    for seed, expected in ((0, chosen), (1, known.chosen)):
        again = judged(chosen.candidate, known.goal, _drawn(KNOWN, plant, MEMBERS, seed, known_load=False), plant)
        assert np.array_equal(again.figures["tracking error"], expected.figures["tracking error"])


def test_the_cascade_supplies_no_friction_twice() -> None:
    """Of a rigid joint whose friction is the line fed forward, the observer finds nothing missing in steady motion."""
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=100.0),
        stiffness=sw.stiffness.Linear(k=1e7),
        damping=100.0,
        friction_input=sw.friction.Coulomb(coulomb=0.05, viscous=5e-4),
        input_inertia=2e-5,
    )
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.5))
    plant = Plant.of(sw.GearSet.of(drive, name="joint", source="stated"), 1e-3, 0.0)
    cascade = baseline(plant, Setting(sharpness=0.5, feedback="input", observer_share=0.5))
    run = sw.simulate(cascade.drive, sw.scenario.ramp(0.2, 1.0), dt=2e-5, sample=1e-3)
    observer = cascade.drive.control.compensation.observer
    momentum = observer.bandwidth * observer.inertia * (run["input_speed"][-1] - 100.0 * 0.2)
    estimate = run.end["control.compensation.observer.filtered"] - momentum
    assert abs(estimate) < 0.01 * 0.05


def test_a_motor_without_inertia_is_remarked() -> None:
    """The load then contains it, so the cascade is slower than that of the joint."""
    joint = sw.GearSet.read("robot-joint")
    bare = joint.with_parts(motor=joint.motor.replace(inertia=0.0), source="changed")
    for gear_set, stated in ((bare, True), (joint, False)):
        plant = Plant.of(gear_set, 1e-3, 0.0)
        remarks = list(_of_the_drive(gear_set, plant, position(0.2, 0.2, "A", plant.period)))
        assert any("the inertia of the motor is 0" in each for each in remarks) == stated


@pytest.mark.slow("tuning")
def test_a_torque_against_a_stop_is_reached_by_what_the_gear_twists() -> None:
    """Without a model the input stands where a rigid gear would have it: half of the angle is lost to a gear as stiff."""
    found = sw.compensate(KNOWN, goal="torque", torque=20.0, members=3)
    assert isinstance(found.gear_set.load, sw.loads.TorsionSpring)
    assert found.gear_set.load.inertia == KNOWN.load.inertia
    assert found.goal.units["torque error"] == "N.m"
    rms_of_half = 0.5 * 20.0 * np.sqrt(3.0 / 8.0)  # of (1 - cos) / 2
    assert 0.7 * rms_of_half < found.baseline.nominal["torque error"] < rms_of_half  # the integral takes back a little
    assert "torsion" in found.chosen.candidate.effects
    assert found.gain > 0.8
    assert any("against which the torque goes from 0 to 20 N·m" in remark for remark in found.remarks)


@pytest.mark.slow("tuning")
def test_the_chosen_setting_keeps_its_margins(known: sw.tuning.Compensated) -> None:
    assert known.margins == sw.tuning.loop_margins(known.drive)
    assert known.margins.modulus >= 0.5


def test_a_loop_without_margin_is_remarked() -> None:
    """A spring so soft that it vibrates within every loop of the output encoder, and without damping."""
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), stiffness=sw.stiffness.Linear(k=1e2))
    drive = sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.6))
    plant = Plant.of(sw.GearSet.of(drive, name="joint", source="stated"), 1e-5, 0.0)
    gear_set, setting = sw.GearSet.of(drive, name="joint", source="stated"), sharpest(plant, "output", 0.0)
    best = Judged(baseline(plant, setting), {"tracking error": np.zeros(3)}, {"tracking error": 0.0})
    remarks = list(_remarks(gear_set, plant, position(0.2, 0.2, "N.m"), best))
    assert any(" and 0.5 is wanted: the gear has little damping" in remark for remark in remarks)


@pytest.mark.parametrize("name", ["position", "torque"])
def test_a_travel_may_have_a_unit(name: str) -> None:
    plant = Plant.read(STATED, 1e-3, 0.0)
    plant = replace(plant, drive=plant.drive.replace(load=sw.loads.TorsionSpring(inertia=0.5, stiffness=1e3)))
    by_text, by_number = (goal_of(name, plant, travel, None) for travel in ("2 deg", np.radians(2.0)))
    assert by_text.command == by_number.command


def with_figures(name: str, error: list[float], settling: list[float]) -> Judged:
    """Return a controller of known figures on drawn gears."""
    candidate = replace(baseline(Plant.of(STATED, 1e-3, 0.0), Setting(0.5, "input", 0.5)), name=name)
    figures = {"tracking error": np.array(error), "settling time": np.array(settling)}
    return Judged(candidate, figures, {each: float(values[0]) for each, values in figures.items()})


CASCADE = with_figures("cascade", [100.0, 101.0, 102.0], [0.0, 0.0, 0.0])
OSCILLATING = with_figures("oscillating", [40.0, 41.0, 42.0], [np.inf, np.inf, 0.1])


@pytest.mark.parametrize(
    ("error", "settling", "name"),
    [
        ([50.0, 38.0, 50.0], [0.0, 0.0, 0.0], "other"),  # 5 more, with a scatter of 5.7
        ([44.0, 45.0, 46.0], [0.0, 0.0, 0.0], "oscillating"),  # worse on each gear
        ([47.0, 40.0, 47.0], [np.inf, np.inf, 0.1], "oscillating"),
        ([47.0, np.nan, 40.0], [0.0, np.nan, 0.0], "oscillating"),
    ],
)
def test_of_controllers_that_gain_as_much_one_that_settles_is_chosen(
    error: list[float], settling: list[float], name: str
) -> None:
    others = [OSCILLATING, with_figures("other", error, settling)]
    goal = position(0.03, 0.02, "A")
    assert _chosen(CASCADE, others, goal).candidate.name == name


def test_a_controller_under_which_the_output_does_not_settle_is_named_with_one_under_which_it_does() -> None:
    other = with_figures("other", [60e-6, 61e-6, 62e-6], [0.0, 0.0, 0.0])
    nothing: Any = ()
    goal = position(0.03, 0.02, "A")
    found = sw.tuning.Compensated(STATED, goal, (OSCILLATING, other), CASCADE, OSCILLATING, 3, nothing, (), (), ())
    words = "does not settle within 0.5 s; the best of those tried under which it does is the other, tracking error 61"
    assert words in found.verdict
    assert found._headline() == found.verdict
    assert "under none that was tried it does" in replace(found, tried=(OSCILLATING,)).verdict
    assert "settle" not in replace(found, chosen=other).verdict
