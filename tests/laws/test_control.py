"""What every controller obeys, sampled or not: it rests with the drive, keeps its limits, and is one in every kind of run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, reject, strategies as st
from strainwave import _core

from tests.control.discrete import ARM, CURRENT, DC, RATIO, TORQUE, drive
from tests.support.strategies import built, models, suited, usual

LOOPS = {"position_gain": 25.0, "speed_proportional": 0.1, "speed_integral": 2.0, "speed_feedforward": 0.9}
# Gains that suit the drive of these tests; another law has those that it has by default.
OWN_GEAR = drive(sw.control.OpenLoop()).gear
VOLTS = {"actuation_per_torque": DC.resistance / DC.torque_constant, "actuation_per_speed": DC.back_emf}
GAINS: dict[str, dict[str, Any]] = {
    "open_loop": {"gain": 0.5},
    "pid": {"proportional": 0.5, "integral": 3.0, "derivative": 0.01},
    "pi": {"proportional": 0.02, "integral": 1.5},
    "position_speed": LOOPS | {"viscous_feedforward": 2e-3, "coulomb_feedforward": 0.05},
    "cascade": LOOPS | {"current_proportional": 0.3, "current_integral": 200.0, "back_emf_feedforward": 0.1},
    "lead_lag": {"gain": 0.8, "lead_numerator": 0.03, "lead_denominator": 0.004, "lag_numerator": 0.1, "lag_denominator": 0.5},
    "state_feedback": {"input_angle": 0.5, "input_speed": 0.01, "output_angle": 2.0, "current": 0.2, "torque": 0.03},
    "state_space": {
        "D": [0.5, 0.01, 2.0],
        "A": [-1.0, 30.0, -20.0, -150.0],
        "B": [1.0, 0.1, 0.5, 20.0, 2.0, -3.0],
        "C": [3.0, 0.4],
    },
    "feedback_linearisation": {"bandwidth": 20.0, "motor_inertia": 1e-4, "reference_time": 0.05} | VOLTS,
    "kinematic_error_tracking": {"bandwidth": 8.0, "speed_gain": 5e-3, "motor_inertia": 1e-4, "reference_time": 0.05} | VOLTS,
}
MODELS: dict[str, dict[str, Any]] = {
    name: {"gear": OWN_GEAR, "load": ARM} for name in ("feedback_linearisation", "kinematic_error_tracking")
}
MOTORS: dict[str, Any] = {"position_speed": CURRENT}
PLAIN = {name: law for name, law in _core.families["control"].items() if name != "sampled"}
COMMAND = sw.scenario.sine(0.02, 4.0, 0.1) + sw.scenario.ramp(
    0.8, 0.1
)  # always the same way: no friction fed forward turns round


def law_of(name: str) -> Any:
    return PLAIN[name](**(usual(PLAIN[name]) | GAINS.get(name, {}) | MODELS.get(name, {})))


def numbers_of(name: str) -> dict[str, float]:
    """The gains of a law by their paths within it, those of a sequence one by one."""
    found = dict[str, float]()
    for field, value in GAINS.get(name, {PLAIN[name].fields[0]["name"]: PLAIN[name].fields[0]["default"]}).items():
        found |= {f"{field}[{k}]": each for k, each in enumerate(value)} if isinstance(value, list) else {field: value}
    return found


def drive_of(name: str, sampled: bool, **parts: object) -> sw.Drive:
    law = law_of(name)
    return drive(sw.control.Sampled(law=law, period=1e-3, delay=3e-4) if sampled else law, MOTORS.get(name, DC), **parts)


every_law = pytest.mark.parametrize("name", list(PLAIN))
both_ways = pytest.mark.parametrize("sampled", [False, True], ids=["continuous", "sampled"])


@every_law
@both_ways
def test_a_drive_at_rest_with_command_zero_stays_at_rest(name: str, sampled: bool) -> None:
    run = sw.simulate(drive_of(name, sampled), sw.scenario.constant(0.0, 0.02), sample=1e-3)
    for column in run.names:
        if column not in ("time", "temperature"):
            assert not run[column].any(), column


@every_law
@both_ways
def test_the_opposite_command_gives_the_opposite_motion(name: str, sampled: bool) -> None:
    one = drive_of(name, sampled)
    forth, back = (sw.simulate(one, sense * COMMAND, sample=1e-3) for sense in (1.0, -1.0))
    for column in ("input_angle", "input_speed", "output_angle", "torque"):
        assert np.array_equal(forth[column], -back[column])


@pytest.mark.slow("physics")
@given(models("control"), st.sampled_from([-1.0, 1.0]), st.floats(1e-3, 1e3))
def test_whatever_is_asked_no_more_than_its_limit_is_given(law: Any, sense: float, size: float) -> None:
    """Of any numbers, at once and after a while."""
    law = suited(law, sw.kinematics.PlainRatio(reduction=RATIO))
    plain = getattr(law, "law", law)
    limit = getattr(plain, "voltage_limit", getattr(plain, "limit", None))
    try:
        one = drive(law, TORQUE)
        actuation = "motor_torque"
    except ValueError:  # it gives a voltage
        one = drive(law, DC)
        actuation = "voltage"
    if limit is None:
        reject()
    try:
        run = sw.simulate(one, sw.scenario.constant(sense * size, 5e-3), 1e-4)
    except FloatingPointError:  # so stiff a law that steps do not follow it
        reject()
    assert np.abs(run[actuation]).max() <= limit


@every_law
@both_ways
def test_members_of_an_ensemble_are_runs_alone_to_the_bit(name: str, sampled: bool) -> None:
    one = drive_of(name, sampled)
    inertias = np.linspace(0.04, 0.06, 11)
    many = sw.simulate_many(one, COMMAND, {"load.inertia": inertias}, sample=1e-3, record=["output_angle", "torque"])
    for k in (0, 7, 10):
        alone = sw.simulate(one.replace({"load.inertia": float(inertias[k])}), COMMAND, sample=1e-3)
        assert np.array_equal(many["output_angle"][k], alone["output_angle"])
        assert np.array_equal(many["torque"][k], alone["torque"])


@every_law
def test_gains_may_differ_from_member_to_member(name: str) -> None:
    one = drive_of(name, sampled=True)
    field, value = next(iter(numbers_of(name).items()))
    path = f"control.law.{field}"
    gains = value * np.array([0.9, 1.0, 1.1])
    many = sw.simulate_many(one, COMMAND, {path: gains}, sample=1e-3)
    assert not np.array_equal(many["output_angle"][0], many["output_angle"][2])
    for gain, row in zip(gains, many["output_angle"], strict=True):
        assert np.array_equal(row, sw.simulate(one.replace({path: float(gain)}), COMMAND, sample=1e-3)["output_angle"])


@every_law
@both_ways
def test_adaptive_steps_lead_to_the_same(name: str, sampled: bool) -> None:
    one = drive_of(name, sampled)
    fine = sw.simulate(one, COMMAND, 2e-5, sample=1e-3)
    adaptive = sw.simulate_adaptively(one, COMMAND, 1e-8, sample=1e-3)
    for column in ("input_angle", "input_speed", "output_angle", "output_speed"):
        assert adaptive[column] == pytest.approx(fine[column], abs=1e-7 * np.abs(fine[column]).max())


@every_law
@both_ways
@pytest.mark.parametrize("method", ["rosenbrock", "moreau_jean"])
def test_other_methods_converge_to_the_same_motion(name: str, sampled: bool, method: Any) -> None:
    """Of third and of second order: half the step leaves at most a third of the error, which is small already."""
    one = drive_of(name, sampled)
    fine = sw.simulate(one, COMMAND, 2e-5, sample=1e-3)["output_angle"]
    errors = [
        np.abs(sw.simulate(one, COMMAND, dt, sample=1e-3, method=method)["output_angle"] - fine).max() for dt in (1e-4, 5e-5)
    ]
    assert errors[0] < (1e-3 if name in MODELS else 1e-4) * np.abs(fine).max()
    assert errors[1] < errors[0] / 3.0 + 1e-10


@every_law
@both_ways
def test_its_derivatives_are_those_of_differences(name: str, sampled: bool) -> None:
    """Central differences in every gain, of a run that is the run alone to the bit."""
    one = drive_of(name, sampled)
    prefix = "control.law." if sampled else "control."
    values = {prefix + field: value for field, value in numbers_of(name).items()}
    paths = list(values)
    found = sw.analysis.derivatives(one, COMMAND, paths, sample=1e-2)
    assert np.array_equal(found.run["output_angle"], sw.simulate(one, COMMAND, sample=1e-2)["output_angle"])
    for path, value in values.items():
        step = 1e-4 * value
        near = [sw.simulate(one.replace({path: value + by}), COMMAND, sample=1e-2)["output_angle"] for by in (-step, step)]
        slope = found["output_angle", path]
        assert np.abs(slope).max() > 0.0
        assert slope == pytest.approx((near[1] - near[0]) / (2.0 * step), abs=1e-5 * np.abs(slope).max())


@every_law
def test_sampled_without_end_it_is_the_law_itself(name: str) -> None:
    """What is held is late by half a period: the error is of first order."""
    law, motor = law_of(name), MOTORS.get(name, DC)
    wanted = sw.simulate(drive(law, motor), COMMAND, 2e-5, sample=4e-3)["output_angle"]
    errors = []
    for period in (4e-4, 2e-4):
        run = sw.simulate(drive(sw.control.Sampled(law=law, period=period), motor), COMMAND, 2e-5, sample=4e-3)
        errors.append(np.abs(run["output_angle"] - wanted).max())
    assert errors[0] == pytest.approx(2.0 * errors[1], rel=0.1)


@every_law
@both_ways
def test_it_goes_on_where_a_run_ended(name: str, sampled: bool) -> None:
    one = drive_of(name, sampled)
    level = sw.scenario.constant(0.2, 0.1)
    whole = sw.simulate(one, level, sample=1e-3)
    first = sw.simulate(one, sw.scenario.constant(0.2, 0.05), sample=1e-3)
    second = sw.simulate(one, sw.scenario.constant(0.2, 0.05), sample=1e-3, initial=first.end)
    scale = np.abs(whole["output_angle"]).max()
    assert second["output_angle"][-1] == pytest.approx(whole["output_angle"][-1], abs=1e-12 * scale)


@pytest.mark.slow("physics")
@given(built(sw.control.Sampled))
def test_what_is_sampled_says_when_it_acts_next(law: sw.control.Sampled) -> None:
    try:
        one = drive(law, DC)
    except ValueError:
        reject()
    assert 0.0 <= law.delay <= law.period
    rest = one.rest()
    assert rest["control.until_sample"] == 0.0
    assert rest["control.actuation"] == rest["control.pending"] == 0.0
