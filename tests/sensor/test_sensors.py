"""What a controller sees."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from scipy.integrate import solve_ivp

from tests.support.geared import MOTOR, RATIO, geared

LAW = sw.control.PID(proportional=2.0, derivative=0.05)
COMMAND = sw.scenario.sine(0.2, 4.0, 0.3)
LAG = sw.sensor.FirstOrder(time_constant=4e-3)


def test_a_lag_is_a_differential_equation_of_first_order() -> None:
    """The controller's voltage against what it would be from the speed, filtered by SciPy."""
    law = LAW.replace(proportional=0.0, limit=1e6)
    drive = geared(control=law).replace(sensors=sw.Sensors(input_speed=LAG))
    run = sw.simulate(drive, COMMAND, 1e-4)

    def rate(time: float, shown: float) -> float:
        return (float(np.interp(time, run.time, run["input_speed"])) - shown) / LAG.time_constant

    shown = solve_ivp(rate, (0.0, 0.3), [0.0], t_eval=run.time, rtol=1e-9, atol=1e-9, max_step=1e-3).y[0]
    given = 0.05 * (RATIO * COMMAND.rate(run.time) - shown)
    assert run["voltage"] == pytest.approx(given, abs=2e-4 * np.abs(given).max())


def test_it_adds_its_pole() -> None:
    ideal = sw.linearise(geared(control=LAW))
    lagging = sw.linearise(geared(control=LAW).replace(sensors=sw.Sensors(input_speed=LAG)))
    assert set(lagging.states) - set(ideal.states) == {"sensors.input_speed.shown"}
    row = lagging.states.index("sensors.input_speed.shown")
    assert lagging.A[row, row] == pytest.approx(-1.0 / LAG.time_constant)


def test_what_nobody_looks_at_changes_nothing() -> None:
    plain = geared(control=LAW)
    others = plain.replace(sensors=sw.Sensors(output_angle=LAG, output_speed=LAG, current=LAG, torque=LAG))
    runs = [sw.simulate(each, COMMAND, 1e-4) for each in (plain, others)]
    assert np.array_equal(runs[0]["output_angle"], runs[1]["output_angle"])


def test_a_fast_one_is_ideal() -> None:
    ideal = sw.simulate(geared(control=LAW), COMMAND, 5e-6)["output_angle"]
    lags = [geared(control=LAW).replace(sensors=sw.Sensors(input_angle=LAG.replace(time_constant=t))) for t in (1e-4, 1e-5)]
    errors = [np.abs(sw.simulate(each, COMMAND, 5e-6)["output_angle"] - ideal).max() for each in lags]
    assert errors[1] == pytest.approx(0.1 * errors[0], rel=0.1)


def test_at_the_start_of_a_run_it_has_settled() -> None:
    sensors = sw.Sensors(output_angle=LAG, input_speed=LAG)
    drive = geared(control=LAW).replace(sensors=sensors)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 1e-7), 1e-7, initial={"output_angle": 0.3, "input_speed": 5.0})
    assert run.end["sensors.output_angle.shown"] == pytest.approx(0.3, abs=1e-7)
    assert run.end["sensors.input_speed.shown"] == pytest.approx(5.0, rel=1e-4)


# The encoder that a loop closes on


def test_a_loop_on_the_output_sees_the_wind_up_and_one_on_the_input_does_not() -> None:
    law = LAW.replace(integral=2.0)
    ended = {}
    for feedback in ("input", "output"):
        drive = geared(control=law.replace(feedback=feedback))
        ended[feedback] = sw.simulate(drive, sw.scenario.constant(0.2, 20.0), load_torque=4.0)
    assert ended["output"]["output_angle"][-1] == pytest.approx(0.2, abs=1e-7)
    last = ended["input"]
    assert last["input_angle"][-1] / RATIO == pytest.approx(0.2, abs=1e-7)
    assert last["output_angle"][-1] == pytest.approx(0.2 - last["twist"][-1], abs=1e-7)
    assert last["twist"][-1] > 1e-4


def test_gains_mean_the_same_on_either_shaft() -> None:
    stiff = geared(control=LAW, motor=MOTOR, stiffness=sw.stiffness.Linear(k=1e7), damping=2000.0)
    other = stiff.replace({"control.feedback": "output"})
    runs = [sw.simulate(each, COMMAND, 2e-5)["output_angle"] for each in (stiff, other)]
    assert runs[0] == pytest.approx(runs[1], abs=2e-4)
