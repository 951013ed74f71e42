"""A controller that is a function of Python does what the package's own sampled law does."""

from __future__ import annotations

import re

import numpy as np
import pytest
import strainwave as sw

from tests.control import by_hand
from tests.control.discrete import CURRENT, DC, PROMPT, TORQUE, drive as linear
from tests.support.reference_drive import DRIVE, STICKING

OPEN = DRIVE.replace(control=sw.control.OpenLoop())
STICKY = STICKING.replace(control=sw.control.OpenLoop())
COMMAND = sw.scenario.sine(0.1, 3.0, 0.2)
GAINS = sw.control.PID(proportional=2.0, integral=5.0, derivative=0.05, limit=24.0)


@pytest.mark.parametrize(("period", "delay"), [(1e-3, 0.0), (1e-3, 1e-3), (1e-3, 3e-4), (7e-4, 2e-4), (1.3e-4, 1e-5)])
@pytest.mark.parametrize("drive", [OPEN, STICKY], ids=["bristles", "sticking"])
def test_it_does_what_a_sampled_law_of_the_package_does(drive: sw.Drive, period: float, delay: float) -> None:
    sampled = drive.replace(control=sw.control.Sampled(law=GAINS, period=period, delay=delay))
    run = sw.simulate(sampled, COMMAND, sample=1e-3)
    law = by_hand.PID(GAINS, period, drive.gear.kinematics.ratio)
    own = sw.simulate_controlled(drive, law, COMMAND, sample=1e-3, period=period, delay=delay)
    assert own.units == run.units
    for name in run.names:
        assert np.abs(own[name] - run[name]).max() <= 1e-12 * np.abs(run[name]).max(), name


WEAK = sw.motor.BrushlessDC(
    resistance=0.5, inductance=5e-4, torque_constant=0.1, inertia=1e-4, supply_voltage=1.5, current_limit=2.0
)
LOOPS = {"position_gain": 25.0, "speed_proportional": 0.1, "speed_integral": 2.0, "speed_feedforward": 0.9}
CASCADE = sw.control.Cascade(current_proportional=0.3, current_integral=200.0, back_emf_feedforward=0.1, **LOOPS)


@pytest.mark.parametrize(
    ("law", "motor"),
    [
        (sw.control.PI(proportional=0.02, integral=1.5), DC),
        (sw.control.PI(proportional=0.02, integral=1.5), WEAK),
        (sw.control.PositionSpeed(viscous_feedforward=2e-3, coulomb_feedforward=0.05, **LOOPS), CURRENT),
        (sw.control.PositionSpeed(limit=0.05, **(LOOPS | {"speed_proportional": 0.01})), TORQUE),
        (CASCADE, DC),
        (CASCADE, WEAK),
        (CASCADE.replace(current_proportional=0.1, current_integral=60.0, feedback="output"), PROMPT),
        (
            sw.control.LeadLag(gain=0.8, lead_numerator=0.03, lead_denominator=0.004, lag_numerator=0.1, lag_denominator=0.5),
            WEAK,
        ),
        (sw.control.StateFeedback(input_angle=0.5, input_speed=0.01, output_angle=2.0, current=0.2, torque=0.03), PROMPT),
    ],
    ids=lambda part: part.name,
)
@pytest.mark.parametrize("delay", [0.0, 3e-4, 1e-3])
def test_so_does_any_law_on_any_motor(law: object, motor: object, delay: float) -> None:
    """With the limits that a motor hands back, and a current that follows the voltage at once."""
    command = sw.scenario.sine(0.3, 4.0, 0.1) + sw.scenario.ramp(0.8, 0.1)
    run = sw.simulate(linear(sw.control.Sampled(law=law, period=1e-3, delay=delay), motor), command, sample=1e-3)
    written = getattr(by_hand, type(law).__name__)(law, 1e-3)
    own = sw.simulate_controlled(linear(sw.control.OpenLoop(), motor), written, command, sample=1e-3, period=1e-3, delay=delay)
    for name in run.names:
        assert np.abs(own[name] - run[name]).max() <= 1e-12 * np.abs(run[name]).max(), name


def test_it_sees_through_the_sensors_at_its_instants() -> None:
    drive = OPEN.replace(sensors=sw.Sensors(output_angle=sw.sensor.Gain(gain=1.0, offset=0.25)))
    seen: list[sw.simulation.Observation] = []

    def zero(now: sw.simulation.Observation) -> float:
        seen.append(now)
        return 0.0

    run = sw.simulate_controlled(
        drive, zero, sw.scenario.ramp(2.0, 0.01), period=2e-3, initial={"input_speed": 3.0}, sample=2e-3
    )
    assert [now.time for now in seen] == pytest.approx([0.0, 2e-3, 4e-3, 6e-3, 8e-3], abs=1e-15)
    assert [now.command for now in seen] == pytest.approx([0.0, 4e-3, 8e-3, 12e-3, 16e-3], abs=1e-15)
    assert {now.command_rate for now in seen} == {2.0}
    assert [now.output_angle - 0.25 for now in seen] == pytest.approx(list(run["output_angle"][:-1]), abs=1e-15)
    assert seen[0].input_speed == 3.0
    assert run["command"][-1] == pytest.approx(0.02)


def test_what_is_recorded_is_what_is_asked_for_and_a_run_goes_on() -> None:
    whole = sw.simulate_controlled(OPEN, lambda seen: 3.0, COMMAND, period=1e-3, record=["current"], unit="deg")
    assert whole.names == ("time", "current")
    alone = sw.simulate_controlled(OPEN, lambda seen: 3.0, COMMAND, period=1e-3, record=["command"], unit="deg")
    assert alone.unit("command") == "deg"
    open_loop = sw.simulate(OPEN, sw.scenario.constant(3.0, 0.2))
    assert np.abs(whole["current"] - open_loop["current"]).max() < 1e-12
    assert whole.end.input_speed == pytest.approx(open_loop.end.input_speed, rel=1e-12)
    further = sw.simulate_controlled(OPEN, lambda seen: 0.0, COMMAND, period=1e-3, initial=whole.end)
    assert further["input_speed"][0] == whole.end.input_speed


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"drive": DRIVE}, ValueError, "has a controller of its own; give drive.replace(control=sw.control.OpenLoop())"),
        ({"controller": 3.0}, TypeError, "controller = 3.0 must be a function"),
        ({"controller": lambda seen: float("nan")}, ValueError, "what the controller returns at t = 0 s = nan must be finite"),
        ({"controller": lambda seen: None}, TypeError, "what the controller returns at t = 0 s must be a number, not None"),
        ({"period": 0.0}, ValueError, "period = 0.0 s must lie in (0, inf)"),
        ({"delay": 2e-3}, ValueError, "delay = 0.002 s must lie in [0, 0.001]"),
        ({"period": 1e-12}, ValueError, "take a longer period"),
        ({"unit": 5}, TypeError, "unit"),
    ],
)
def test_what_it_cannot_run_is_refused(arguments: dict[str, object], error: type[Exception], message: str) -> None:
    given = {"drive": OPEN, "controller": lambda seen: 0.0, "command": COMMAND, "period": 1e-3} | arguments
    with pytest.raises(error, match=re.escape(message)):
        sw.simulate_controlled(**given)  # type: ignore[arg-type]
