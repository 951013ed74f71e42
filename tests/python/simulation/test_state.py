"""The state of a drive: a mapping of the numbers that its models have."""

from __future__ import annotations

import pickle
from math import inf
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from strainwave import _core
from strainwave.simulation.signals import outputs
from strainwave.simulation.state import State, StateLayout

from tests.support.geared import RATIO, K, geared
from tests.support.reference_drive import DRIVE, SMOOTH
from tests.support.samples import sample
from tests.support.strategies import drives

SHORT = sw.scenario.constant(0.0, 1e-3)
LUGRE = sw.friction.LuGre(
    coulomb=0.01, breakaway=0.015, stribeck_speed=1.0, viscous=1e-3, bristle_stiffness=10.0, bristle_damping=0.0
)


@settings(max_examples=sample(6, 20))  # each of them has a hundred numbers
@given(drives)
def test_a_state_maps_names_to_finite_numbers_each_with_a_unit(drive: sw.Drive) -> None:
    rest = drive.rest()
    assert list(rest) == StateLayout(drive).names == list(rest.units)
    assert len(set(rest)) == len(rest) == len(rest.numbers)
    assert dict(rest) == {name: rest[name] for name in rest}
    assert all(np.isfinite(list(rest.values())))
    assert all(name.startswith(tuple(f"{part}." for part in _core.shape(drive))) for name in rest if "." in name)


@pytest.mark.slow("simulation")
@settings(max_examples=sample(6, 20))
@given(drives)
def test_every_number_can_be_replaced_and_nothing_else_changes(drive: sw.Drive) -> None:
    rest = drive.rest()
    for name in rest:
        other = rest.replace({name: 0.25})
        assert other[name] == 0.25
        assert {key for key in rest if other[key] != rest[key]} <= {name}


def test_numbers_of_the_drive_itself_are_attributes() -> None:
    state = DRIVE.rest().replace(input_speed=2.0)
    assert state.input_speed == state["input_speed"] == 2.0
    assert "input_speed" in dir(state)
    with pytest.raises(AttributeError, match="has no 'speed'"):
        state.speed  # noqa: B018
    with pytest.raises(AttributeError, match=r"never changes; state.replace\(input_speed=...\)"):
        state.input_speed = 1.0
    with pytest.raises(KeyError, match="has no 'speed'"):
        state["speed"]


def test_what_is_no_name_is_no_number_of_a_state() -> None:
    state = DRIVE.rest()
    for name in ("speed", 3, [1.0]):
        assert name not in state
        with pytest.raises(KeyError, match="has no"):
            state[name]  # type: ignore[index]


def test_a_state_changes_for_nobody() -> None:
    state = DRIVE.rest()
    with pytest.raises(ValueError, match="read-only"):
        state.numbers[0] = 1.0
    with pytest.raises(ValueError, match="must be one of"):
        state.replace(speed=1.0)
    with pytest.raises(ValueError, match="input_speed = inf rad/s must be finite"):
        state.replace(input_speed=inf)
    assert state.replace(input_speed="60 rpm") == state.replace(input_speed=60.0 * (np.pi / 30.0))
    with pytest.raises(TypeError, match="is made by a drive"):
        State()


def test_states_are_equal_if_their_numbers_and_models_are() -> None:
    other = DRIVE.replace({"load.inertia": 3.0})
    assert other.rest() == DRIVE.rest()
    assert hash(other.rest()) == hash(DRIVE.rest())
    assert DRIVE.rest().replace(turns=1.0) != DRIVE.rest()
    assert SMOOTH.rest() != DRIVE.rest()
    assert pickle.loads(pickle.dumps(DRIVE.rest())) == DRIVE.rest()


def test_a_step_takes_no_state_of_a_drive_with_other_models() -> None:
    with pytest.raises(ValueError, match="state is a state of another drive: its hysteresis"):
        DRIVE.step(SMOOTH.rest(), dt=1e-4)
    with pytest.raises(TypeError, match="state = 3 must be a state of a drive"):
        DRIVE.step(3, dt=1e-4)  # type: ignore[arg-type]


def test_continuous_numbers_come_first() -> None:
    layout = StateLayout(DRIVE)
    assert layout.names[: layout.count] == [
        *("motor.current", "control.error_integral", "input_angle", "input_speed", "transmission_error", "output_speed"),
        "friction_input.deflection",
    ]
    assert layout.places["friction_input"] == slice(layout.count - 1, layout.count)
    assert layout.places["friction_mesh"] == slice(0, 0)


STIFFNESS, BREAKAWAY = 1e4, 1.0  # N.m/rad, N.m: of a joint that slips, so that its torque shows where it turned round
SLIPPING = sw.Drive(
    gear=sw.Gear(
        stiffness=sw.stiffness.Linear(k=1e-30),
        hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[STIFFNESS], breakaway=[BREAKAWAY]),
    ),
    motor=sw.motor.TorqueSource(inertia=1e-4),
)


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize(
    ("begin", "moved", "end"),
    [
        (1e-4, 1e-6, -1e-4),
        (1e-4, 3e-4, -5e-4),
        (1e-4, -1e-5, -5e-4),
        (1e-19, 3e-4, -5e-4),  # at rest but for rounding, and far on
        (1.7e-29, 2.7e-12, -1.7e-25),  # a stretch of a step that is all rounding
    ],
)
def test_hysteresis_turns_round_where_the_cubic_through_both_twists_and_rates_does(
    begin: float, moved: float, end: float, sense: float
) -> None:
    """The rates are times the time between [rad]. The turning point is found among the roots of the cubic's slope."""
    elapsed = 1e-4
    begin, moved, end = sense * begin, sense * moved, sense * end
    cubic = np.polynomial.Polynomial([0.0, begin, 3.0 * moved - 2.0 * begin - end, begin + end - 2.0 * moved])
    bend, slope = 3.0 * cubic.coef[3], 2.0 * cubic.coef[2]
    q = -0.5 * (slope + np.copysign(np.sqrt(slope**2 - 4.0 * bend * begin), slope))  # nothing is subtracted
    turn = cubic(next(at for at in (q / bend, begin / q) if 0.0 <= at <= 1.0))
    held = np.clip(STIFFNESS * turn, -BREAKAWAY, BREAKAWAY)
    torque = np.clip(held + STIFFNESS * (moved - turn), -BREAKAWAY, BREAKAWAY)
    state = SLIPPING.rest().replace(
        transmission_error=moved, output_speed=-end / elapsed, held_rate=begin / elapsed, elapsed=elapsed
    )
    found = _core.now(SLIPPING, state.numbers, np.array([0.0, 0.0, 0.0, 0.0, 300.0, 0.0]))
    assert found[outputs(SLIPPING)["torque"].channel, 0] == pytest.approx(torque, abs=1e-12 * BREAKAWAY)


def begin(drive: sw.Drive, **initial: float) -> dict[str, float]:
    """The outputs at the start."""
    run = sw.simulate(drive, SHORT, 1e-4, initial=initial)
    return {name: float(run[name][0]) for name in run.names}


@given(angle=st.floats(-1.0, 1.0), speed=st.floats(0.1, 50.0) | st.floats(-50.0, -0.1))
def test_the_rest_follows_from_an_angle_and_a_speed(angle: float, speed: float) -> None:
    drive = geared(friction_input=LUGRE, friction_output=sw.friction.Viscous(viscous=0.2))
    found = begin(drive, output_angle=angle, input_speed=speed)
    assert found["output_angle"] == pytest.approx(angle, abs=1e-14)
    assert found["input_speed"] == speed
    assert found["output_speed"] == pytest.approx(speed / RATIO, rel=1e-14)
    carried = drive.load.torque(angle) if hasattr(drive.load, "torque") else drive.load.gravity_torque * np.sin(angle)
    assert found["torque"] == pytest.approx(carried + 0.2 * speed / RATIO, rel=1e-12, abs=1e-12)
    assert found["twist"] == pytest.approx(found["torque"] / K, rel=1e-12, abs=1e-16)
    assert found["friction_input"] == pytest.approx(float(LUGRE.steady(speed)), rel=1e-9, abs=1e-15)


def test_the_output_does_not_accelerate_at_first() -> None:
    arm = geared(damping=20.0, friction_output=sw.friction.Coulomb(coulomb=2.0))
    found = begin(arm, output_angle=0.4, output_speed=0.3)
    assert found["friction_output"] == pytest.approx(2.0)
    assert found["torque"] == pytest.approx(found["load_torque"] + 2.0, rel=1e-12)


def test_what_stands_still_is_held_from_the_beginning() -> None:
    """Friction at rest is what holds the shaft, not what it would oppose to motion: the input holds the weight's share."""
    held = geared(friction_input=sw.friction.Coulomb(coulomb=0.5), friction_output=sw.friction.Coulomb(coulomb=5.0))
    found = begin(held, output_angle=0.4)
    assert found["friction_input"] == pytest.approx(-found["torque"] / RATIO, rel=1e-12)
    assert found["torque"] == pytest.approx(found["load_torque"], rel=1e-12)
    assert abs(found["friction_output"]) < 1e-12


def test_a_shaft_that_is_held_at_zero_begins_there_whatever_the_error_of_the_gear() -> None:
    """The twist is then what the angle leaves of the error, whose rounding is larger than any share of the twist."""
    noise = sw.kinematic_error.Stochastic(amplitude=2e-5, seed=3, load_sensitivity=0.05, speed_sensitivity=0.01)
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), kinematic_noise=noise)
    for load in (sw.loads.Prescribed(), sw.loads.Inertia(inertia=0.05)):
        drive = sw.Drive(gear=gear, load=load)
        given = (
            {"inputs": {"output_angle": 0.0}} if isinstance(load, sw.loads.Prescribed) else {"initial": {"output_angle": 0.0}}
        )
        assert abs(sw.simulate(drive, SHORT, 1e-4, **given)["twist"][0]) < 1e-17


@given(angle=st.floats(-1.0, 1.0))
def test_dry_friction_does_not_wind_up_what_rests(angle: float) -> None:
    """It could hold the output to either side: it holds it to neither, and the gear carries the load alone."""
    dry = sw.friction.Coulomb(coulomb=0.3, breakaway=0.4)
    found = begin(geared(friction_input=dry, friction_output=dry), output_angle=angle)
    assert found["torque"] == pytest.approx(15.0 * np.sin(angle), rel=1e-12, abs=1e-15)
    flywheel = begin(geared(sw.loads.Inertia(inertia=0.5), friction_output=dry), input_angle=angle)
    assert flywheel["torque"] == flywheel["twist"] == 0.0


@given(torque=st.floats(-30.0, 30.0), angle=st.floats(-300.0, 300.0))
def test_a_torque_is_that_of_the_gear(torque: float, angle: float) -> None:
    hysteresis = sw.hysteresis.MaxwellSlip(stiffness=[2000.0, 1000.0], breakaway=[1.0, 3.0])
    found = begin(geared(hysteresis=hysteresis), input_angle=angle, torque=torque)
    assert found["torque"] == pytest.approx(torque, rel=1e-11, abs=1e-11)
    assert found["input_angle"] == pytest.approx(angle, rel=1e-15)


def test_both_angles_give_the_twist_and_both_speeds_its_rate() -> None:
    found = begin(geared(damping=5.0), input_angle=2.0, output_angle=0.099, input_speed=3.0, output_speed=0.1)
    assert found["twist"] == pytest.approx(2.0 / RATIO - 0.099)
    assert found["torque"] == pytest.approx(K * found["twist"] + 5.0 * (3.0 / RATIO - 0.1))


@given(twist=st.floats(-1e-3, 1e-3), angle=st.floats(-2.0, 2.0))
def test_with_kinematic_error_the_angles_agree(twist: float, angle: float) -> None:
    found = begin(DRIVE, output_angle=angle, twist=twist)
    assert found["output_angle"] == pytest.approx(angle, abs=1e-13)
    assert found["twist"] == pytest.approx(twist, abs=1e-15)
    assert found["transmission_error"] == pytest.approx(twist + found["kinematic_error"], abs=1e-15)


def test_a_current_is_kept_where_it_has_a_life_of_its_own() -> None:
    motor = sw.motor.DC(resistance=2.0, inductance=1e-3, back_emf=0.05, torque_constant=0.05)
    assert begin(geared(motor=motor), current=1.5)["current"] == 1.5
    settled = begin(geared(motor=motor), input_speed=40.0)["current"]
    assert settled == pytest.approx(-0.05 * 40.0 / 2.0, rel=1e-12)


def test_nothing_known_is_rest_where_nothing_loads_the_gear() -> None:
    runs = [sw.simulate(geared(), SHORT, 1e-4, initial=initial) for initial in (None, {})]
    for name in runs[0].names:
        assert runs[0][name] == pytest.approx(runs[1][name], abs=1e-9)


def test_members_begin_where_each_alone_does() -> None:
    angles, known = [0.1, -0.4, 0.7], {"input_speed": 3.0}
    many = sw.simulate_many(
        DRIVE, SHORT, {"load.inertia": [0.1, 0.2, 0.3]}, record=["torque"], initial=known | {"output_angle": angles}
    )
    for member, angle in enumerate(angles):
        drive = DRIVE.replace({"load.inertia": 0.1 * (member + 1)})
        alone = sw.simulate(drive, SHORT, method="exponential", initial=known | {"output_angle": angle})
        assert many["torque"][member] == pytest.approx(alone["torque"], rel=1e-13)


def test_derivatives_know_that_the_beginning_moves() -> None:
    paths = ["gear.stiffness.a1", "load.gravity_torque", "gear.damping"]
    initial = {"output_angle": 0.5, "output_speed": 0.2}
    found = sw.analysis.derivatives(DRIVE, SHORT, paths, sample=1e-4, initial=initial)
    for path in paths:
        value = float(_value(DRIVE, path))
        near = [
            sw.simulate(DRIVE.replace({path: value * by}), SHORT, sample=1e-4, method="exponential", initial=initial)
            for by in (1.0 - 1e-5, 1.0 + 1e-5)
        ]
        for name in ("torque", "input_angle", "twist"):
            slope = (near[1][name] - near[0][name]) / (2e-5 * value)
            assert found[name, path] == pytest.approx(slope, abs=1e-5 * np.abs(slope).max() + 1e-15)


def _value(model: Any, path: str) -> Any:
    for name in path.split("."):
        model = getattr(model, name)
    return model


@pytest.mark.parametrize(
    ("initial", "kind", "message"),
    [
        ({"torque": 1.0, "twist": 0.1}, ValueError, "of torque, twist each follows from the others"),
        ({"input_angle": 1.0, "output_angle": 0.1, "torque": 0.1}, ValueError, "each follows from the others"),
        ({"speed": 1.0}, ValueError, 'the name of a quantity in initial = "speed" must be one of'),
        ({"torque": np.nan}, ValueError, "initial torque must be finite"),
        ({"torque": "much"}, ValueError, 'initial torque = "much" must be a number and its unit, as "1.2 N.m"'),
        ({"torque": [1.0, 2.0]}, ValueError, "must be one value"),
        ({"current": 1.0}, ValueError, "it follows at once"),
        (3, TypeError, "initial"),
    ],
)
def test_what_is_no_beginning_is_refused(initial: Any, kind: type[Exception], message: str) -> None:
    with pytest.raises(kind, match=message):
        sw.simulate(geared(motor=sw.motor.DC()), SHORT, initial=initial)


def test_where_nothing_balances_there_is_no_state() -> None:
    soft = geared(stiffness=sw.stiffness.Linear(k=1.0), load=sw.loads.Pendulum(inertia=0.1, gravity_torque=500.0))
    words = "no state has the quantities of initial: .* are not in equilibrium there; give another angle, or the torque$"
    with pytest.raises(ValueError, match=f"^{words}") as alone:
        sw.simulate(soft, SHORT, dt=1e-5, initial={"input_angle": 3.0})
    with pytest.warns(sw.simulation.EnsembleWarning, match=words):
        runs = sw.simulate_many(soft, SHORT, {"load.inertia": [0.1, 0.2]}, dt=1e-5, initial={"input_angle": 3.0})
    assert set(runs.failures.values()) == {str(alone.value)}


def test_a_prescribed_motion_that_no_run_can_begin_with_is_told_as_such() -> None:
    held = sw.Drive(load=sw.loads.Prescribed())
    words = "^a run cannot begin with the motion that the load prescribes at t = 0: .*; let output_angle begin at a smaller"
    for motion in (1e307, sw.scenario.ramp(1e307, SHORT.duration)):
        with pytest.raises(ValueError, match=words):
            sw.simulate(held, SHORT, inputs={"output_angle": motion})


def test_a_fit_takes_a_log_that_begins_in_motion() -> None:
    """An arm let go at an angle, with a turning motor: the friction of the truth comes back."""
    truth = geared(friction_input=sw.friction.Viscous(viscous=2e-3), damping=20.0)
    initial = {"output_angle": 0.4, "input_speed": 20.0}
    log = sw.simulate(truth, sw.scenario.sine(3.0, 2.0, 0.5), 1e-4, sample=1e-3, initial=initial)
    log = log.select(["time", "command", "input_angle", "output_speed"])
    start = truth.replace({"gear.friction_input.viscous": 1e-3})
    found = sw.fit(start, log, ["gear.friction_input.viscous"], initial=initial)
    assert found.model.gear.friction_input.viscous == pytest.approx(2e-3, rel=1e-3)
    with pytest.raises(ValueError, match="start with the arm hanging"):
        sw.fit(start, log, ["gear.friction_input.viscous"])
    with pytest.raises(TypeError, match="initial is the beginning of a drive log"):
        sw.fit(truth.gear, log, ["friction_input.viscous"], initial=initial)
