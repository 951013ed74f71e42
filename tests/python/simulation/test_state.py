"""The state of a drive: a mapping of the numbers that its models have."""

from __future__ import annotations

import pickle
from math import inf

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings
from strainwave import _core
from strainwave.simulation.signals import outputs
from strainwave.simulation.state import State, StateLayout

from tests.support.reference_drive import DRIVE, SMOOTH
from tests.support.samples import sample
from tests.support.strategies import drives


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
