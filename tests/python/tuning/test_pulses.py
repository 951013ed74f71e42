"""Travel of pulses against its closed form, and moves by pulses over a spread of friction."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw

FRICTION, BREAKAWAY, INERTIA = 0.072, 0.0748, 1.2e-3
RIGID = sw.Gear(  # the load is so light that the spring has nothing to do
    kinematics=sw.kinematics.PlainRatio(reduction=100.0),
    stiffness=sw.stiffness.Linear(k=150.0),
    damping=0.05,
    friction_input=sw.friction.Coulomb(coulomb=FRICTION, breakaway=BREAKAWAY),
)


def drive_of(gear: sw.Gear, load_inertia: float = 1e-5) -> sw.Drive:
    motor = sw.motor.CurrentSource(torque_constant=0.05, inertia=INERTIA)
    return sw.Drive(gear=gear, motor=motor, control=sw.control.OpenLoop(), load=sw.loads.Inertia(inertia=load_inertia))


@pytest.mark.parametrize(("torque", "width"), [(0.08, 0.05), (0.15, 0.02), (1.0, 0.005)])
def test_a_pulse_turns_a_rigid_drive_as_the_closed_form_has_it(torque: float, width: float) -> None:
    plan = sw.tuning.plan_pulses(drive_of(RIGID), 1e-3, torque=torque)
    run = sw.simulate(plan.drive, plan.pulses([width]), record=["input_angle", "input_speed"])
    assert run["input_speed"][-1] == 0.0
    assert run["input_angle"][-1] == pytest.approx(sw.tuning.pulse_travel(torque, width, INERTIA, FRICTION), rel=1e-4)
    speed = (torque - FRICTION) / INERTIA * width
    assert run["input_speed"].max() == pytest.approx(speed, rel=1e-3)


def test_work_of_a_pulse_is_what_friction_takes() -> None:
    """tau v w / 2 = F x."""
    speed = (0.2 - FRICTION) / INERTIA * 0.01
    assert FRICTION * sw.tuning.pulse_travel(0.2, 0.01, INERTIA, FRICTION) == pytest.approx(0.2 * speed * 0.01 / 2.0)


def test_a_heavy_load_on_a_stiff_gear_counts_as_part_of_the_rotor() -> None:
    """Inertia and friction of the output count over the ratio squared and the ratio."""
    gear = RIGID.replace(
        stiffness=sw.stiffness.Linear(k=5e5), damping=500.0, friction_output=sw.friction.Coulomb(coulomb=1.0, breakaway=1.0)
    )
    plan = sw.tuning.plan_pulses(drive_of(gear, load_inertia=10.0), 5e-3)
    assert plan.inertia == pytest.approx(INERTIA + 10.0 / 100.0**2)
    assert plan.friction == pytest.approx(FRICTION + 1.0 / 100.0)
    run = sw.simulate(plan.drive, plan.command, record=["output_angle"])
    assert run["output_angle"][-1] == pytest.approx(5e-3, rel=0.01)


def test_viscous_friction_shortens_the_travel_by_its_share() -> None:
    """At twice the friction the share is b v / F, to first order."""
    viscous, width = 1e-4, 0.02
    gear = RIGID.replace({"friction_input.viscous": viscous})
    plan = sw.tuning.plan_pulses(drive_of(gear), 1e-3, torque=2.0 * FRICTION)
    run = sw.simulate(plan.drive, plan.pulses([width]), record=["input_angle"])
    shortened = 1.0 - run["input_angle"][-1] / sw.tuning.pulse_travel(2.0 * FRICTION, width, INERTIA, FRICTION)
    assert shortened == pytest.approx(viscous * (FRICTION / INERTIA * width) / FRICTION, rel=0.05)


def test_width_and_travel_are_inverse() -> None:
    assert sw.tuning.pulse_width(0.1, sw.tuning.pulse_travel(0.1, 0.03, INERTIA, 0.05), INERTIA, 0.05) == pytest.approx(0.03)
    assert sw.tuning.pulse_travel(0.1, 0.0, INERTIA, 0.05) == 0.0


def test_a_train_splits_the_travel_into_pulses_that_are_short_enough() -> None:
    one, many = (sw.tuning.plan_pulses(drive_of(RIGID), 0.01, max_width=width) for width in (1.0, 0.04))
    assert len(one.widths) == 1
    assert len(many.widths) == np.ceil((one.widths[0] / 0.04) ** 2)
    assert max(many.widths) <= 0.04
    for plan in (one, many):
        run = sw.simulate(plan.drive, plan.command, record=["output_angle"])
        assert run["output_angle"][-1] == pytest.approx(0.01, rel=1e-3)


@pytest.mark.parametrize("scale", [0.7, 1.0, 1.3])
def test_an_open_train_misses_by_what_the_friction_is_wrong(scale: float) -> None:
    plan = sw.tuning.plan_pulses(drive_of(RIGID), 1e-3)
    true = plan.drive.replace(
        {"gear.friction_input.coulomb": scale * FRICTION, "gear.friction_input.breakaway": scale * BREAKAWAY}
    )
    move = sw.tuning.position_by_pulses(plan, 1e-5, measured=False, drive=true)
    expected = sw.tuning.pulse_travel(plan.torque, plan.widths[0], INERTIA, scale * FRICTION) / 100.0
    assert move.angles[-1] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("scale", [0.5, 0.7, 1.0, 1.3, 1.6])
def test_measured_pulses_reach_the_target_whatever_the_friction(scale: float) -> None:
    """A rigid drive needs one pulse to learn its friction and one to use it; at first one more where the first is stopped."""
    plan = sw.tuning.plan_pulses(drive_of(RIGID), -1e-3)
    true = plan.drive.replace(
        {"gear.friction_input.coulomb": scale * FRICTION, "gear.friction_input.breakaway": scale * BREAKAWAY}
    )
    move = sw.tuning.position_by_pulses(plan, 1e-6, drive=true)
    assert move.reached
    assert move.pulses <= 4
    assert move.angles[-1] == pytest.approx(-1e-3, abs=1e-6)


def test_bristles_and_stribeck_friction_are_moved_too() -> None:
    bristles = sw.friction.LuGre(
        coulomb=FRICTION, breakaway=BREAKAWAY, stribeck_speed=0.5, bristle_stiffness=50.0, bristle_damping=0.02, viscous=1e-3
    )
    falling = sw.friction.Stribeck(coulomb=0.05, breakaway=BREAKAWAY, stribeck_speed=1.0)
    for law in (bristles, falling):
        move = sw.tuning.position_by_pulses(sw.tuning.plan_pulses(drive_of(RIGID.replace(friction_input=law)), 1e-3), 2e-5)
        assert move.reached, law


def test_a_move_starts_where_another_ended() -> None:
    plan = sw.tuning.plan_pulses("position-drive", 2e-3)
    first = sw.tuning.position_by_pulses(plan, 1e-4)
    second = sw.tuning.position_by_pulses(sw.tuning.plan_pulses("position-drive", -2e-3), 1e-4, initial=first.end)
    assert first.reached
    assert second.reached
    assert second.angles[0] == 0.0
    rest = sw.simulate(plan.drive, sw.scenario.constant(0.0, 0.01), initial=second.end, record=["output_angle"])
    assert abs(rest["output_angle"][0]) == pytest.approx(abs(first.angles[-1] + second.angles[-1]), abs=1e-12)


@pytest.mark.slow("tuning")
def test_a_hundred_frictions_are_reached_to_the_jump_of_the_load() -> None:
    """Document P's load jumps by 2 (F_s - F_c) / K = 93 urad where it breaks away."""
    plan = sw.tuning.plan_pulses("position-drive", 1e-3)
    planned, measured = (sw.tuning.pulse_repeatability(plan, 1e-4, measured=each) for each in (False, True))
    assert len(planned.errors) == len(measured.pulses) == 100
    assert measured.reached >= 0.98
    assert measured.upper_error <= 1e-4
    assert measured.median_error < 0.2 * planned.median_error
    assert measured.median_pulses <= 3
    assert measured.upper_pulses <= 8
    assert (planned.pulses == 1).all()
    assert planned.reached < 0.2
    finer = [sw.tuning.pulse_repeatability(plan, each).reached for each in (5e-5, 2e-5)]
    assert finer == pytest.approx([0.96, 0.54], abs=0.04)  # as the page states
    again = sw.tuning.pulse_repeatability(plan, 1e-4)
    assert np.array_equal(again.errors, measured.errors)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"travel": 0.0}, "travel = 0.0 rad"),
        ({"torque": 0.07}, "torque = 0.07 N.m must lie in"),
        ({"max_width": 0.0}, "max_width = 0.0 s"),
        ({"rest": -1.0}, "rest = -1.0 s"),
    ],
)
def test_a_wrong_plan_is_refused(changes: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words.replace(".", r"\.")):
        sw.tuning.plan_pulses(drive_of(RIGID), **({"travel": 1e-3} | changes))


def test_a_drive_that_does_not_stick_is_refused() -> None:
    gear = RIGID.replace(friction_input=sw.friction.Viscous(viscous=1e-3))
    with pytest.raises(ValueError, match="the gear has no dry friction, so it does not rest after a pulse"):
        sw.tuning.plan_pulses(drive_of(gear), 1e-3)


def test_a_load_that_swings_for_long_is_refused_with_what_would_help() -> None:
    plan = sw.tuning.plan_pulses(drive_of(RIGID.replace(damping=0.0), load_inertia=0.5), 1e-3)
    with pytest.raises(ValueError, match=r"20 rests of 0\.2 s after a pulse .* or take a longer rest or a wider tolerance"):
        sw.tuning.position_by_pulses(plan, 1e-6)


def test_a_friction_beyond_the_torque_is_not_reached() -> None:
    plan = sw.tuning.plan_pulses(drive_of(RIGID), 1e-3)
    true = plan.drive.replace({"gear.friction_input.coulomb": 0.2, "gear.friction_input.breakaway": 0.2})
    move = sw.tuning.position_by_pulses(plan, 1e-5, max_pulses=3, drive=true)
    assert not move.reached
    assert move.pulses == 3
    assert move.angles[-1] == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize("widths", [[], [0.01, -0.01], [np.nan]])
def test_a_train_has_pulses_and_each_has_a_width(widths: list[float]) -> None:
    with pytest.raises(ValueError, match=r"must be one or more positive numbers \[s\]"):
        sw.tuning.plan_pulses(drive_of(RIGID), 0.01).pulses(widths)
