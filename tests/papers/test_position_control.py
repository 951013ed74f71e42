"""The position control article's experiments against closed forms, independent integrations and numbers by hand."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import exp, inf, log, sqrt
from pathlib import Path

import numpy as np
import position_control as study
import pytest
import strainwave as sw
from position_control import FULL, SIMPLIFIED, PositionControl, position_control
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

pytestmark = pytest.mark.slow("papers")  # an article's study runs for seconds

# Position control article, Tables 1 and 3, r = 1/100
S1, S2, S3 = 1.5738e-6, -3.7901e-4, 0.0720
MOTOR_INERTIA, LOAD_INERTIA, RATIO = 0.0012, 0.0050, 100.0
TORQUE_CONSTANT, BACK_EMF, RESISTANCE, STIFFNESS = 0.05, 0.05, 2.0, 150.0
MOTOR_VISCOUS, LOAD_VISCOUS = 0.0004, 0.0010
LOAD_COULOMB, GAIN = 0.18, 20.0  # assumed in the sets

# The drive as one rigid inertia at the motor
INERTIA = MOTOR_INERTIA + LOAD_INERTIA / RATIO**2
DAMPING = TORQUE_CONSTANT * BACK_EMF / RESISTANCE + MOTOR_VISCOUS + LOAD_VISCOUS / RATIO**2


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> PositionControl:
    """The study, with its own sine under the simplified friction in place of a measurement."""
    _, command = study.commands()["sine"]
    own = sw.simulate(sw.load("position-drive"), command, sample=1e-3, initial={"output_angle": 0.05})
    path = tmp_path_factory.mktemp("measured") / "own.csv"
    own.select(["time", "command", "output_angle"]).to_csv(path)
    return position_control(path)


def rigid_stroke(voltage: float, width: float, friction: float) -> float:
    """How far a pulse turns a rigid drive: J v' = K_m U / R - F - c v, driven, then to standstill, both in closed form."""
    dry = friction + LOAD_COULOMB / RATIO
    lag, resting = INERTIA / DAMPING, dry / DAMPING
    fastest = (TORQUE_CONSTANT * voltage / RESISTANCE - dry) / DAMPING
    speed = fastest * (1.0 - exp(-width / lag))
    driven = fastest * width - lag * speed
    return driven + lag * speed - resting * lag * log(1.0 + speed / resting)


def integrated_stroke(voltage: float, width: float, friction: Callable[[float, float], float]) -> float:
    """The same for friction of angle and speed, by another integrator."""

    def rate(drive: float) -> Callable[[float, np.ndarray], list[float]]:
        return lambda _, x: [x[1], (drive - friction(x[0], x[1]) - LOAD_COULOMB / RATIO - DAMPING * x[1]) / INERTIA]

    def stands(_: float, x: np.ndarray) -> float:
        return float(x[1])

    stands.terminal, stands.direction = True, -1.0  # type: ignore[attr-defined]
    torque = TORQUE_CONSTANT * voltage / RESISTANCE
    pushed = solve_ivp(rate(torque), (0.0, width), [0.0, 0.0], rtol=1e-8, atol=1e-9)
    coasting = solve_ivp(rate(0.0), (0.0, 10.0), pushed.y[:, -1], rtol=1e-8, atol=1e-9, events=stands)
    return float(coasting.y[0, -1])


# The three experiments


def test_the_figures_are_those_that_their_definitions_give_by_hand(found: PositionControl) -> None:
    def check(agreement: sw.analysis.Agreement, x: np.ndarray, y: np.ndarray) -> None:
        difference = [b - a for a, b in zip(x.tolist(), y.tolist(), strict=True)]
        assert agreement.rms == pytest.approx(sqrt(sum(d * d for d in difference) / len(difference)), rel=1e-9)
        assert agreement.largest == pytest.approx(max(abs(d) for d in difference), rel=1e-12)
        dx, dy = x - sum(x) / len(x), y - sum(y) / len(y)
        assert agreement.correlation == pytest.approx((dx @ dy) / sqrt((dx @ dx) * (dy @ dy)), rel=1e-9)

    for experiment in found.experiments:
        for model, run in experiment.runs.items():
            check(experiment.tracking[model], run["command"], run["output_angle"])
        for name in ("output_angle", "input_angle", "current"):
            check(experiment.between[name], experiment.runs[FULL][name], experiment.runs[SIMPLIFIED][name])


def test_the_two_models_differ_in_their_friction_alone(found: PositionControl) -> None:
    differences = sw.compare(*(found.sets[model].drive for model in (FULL, SIMPLIFIED)))
    assert {each.path.partition(".friction_")[0] for each in differences} == {"gear"}
    for experiment in found.experiments:
        full, simplified = (experiment.runs[model] for model in (FULL, SIMPLIFIED))
        assert np.array_equal(full["command"], simplified["command"])
        for run in (full, simplified):
            assert run["output_angle"][0] == pytest.approx(0.05)
            assert run["torque"][0] == 0.0


def test_the_commands_are_those_of_document_p(found: PositionControl) -> None:
    step, sine, pulses = (experiment.runs[FULL] for experiment in found.experiments)
    assert set(step["command"]) == {0.05, 0.09}
    assert sine["command"] == pytest.approx(0.05 + 0.03 * np.sin(2.0 * np.pi * sine.time), abs=1e-12)
    high = (pulses.time % 1.0 > 0.1001) & (pulses.time % 1.0 < 0.5999)
    assert set(pulses["command"][high]) == {0.09}
    assert set(pulses["command"][pulses.time % 1.0 > 0.6001]) == {0.05}


def test_amplitudes_are_within_the_spread_that_table_4_allows() -> None:
    """The standard deviation is at most rmse / sqrt(1 - correlation^2)."""
    published = {"step": (0.0021, 0.0050, 0.995), "sine": (0.0018, 0.0042, 0.997), "pulse-train": (0.0015, 0.0038, 0.998)}
    assert published == study.TABLE_4
    for name, (_, command) in study.commands().items():
        rms, _, correlation = published[name]
        values = command.value(np.linspace(0.0, command.duration, 30_001))
        assert 0.4 < np.std(values) / (rms / sqrt(1.0 - correlation**2)) < 1.0


def test_the_drive_stops_as_near_to_its_command_as_both_frictions_let_it(found: PositionControl) -> None:
    """At the motor F_s R / (K_m k_p); at the output that over the ratio, and F_sl / K_s besides."""
    step = found.experiments[0]
    at_motor = 1.0388 * S3 * RESISTANCE / (TORQUE_CONSTANT * GAIN)
    at_load = 1.0388 * LOAD_COULOMB / STIFFNESS
    run = step.runs[SIMPLIFIED]
    assert 0.0 < abs(run["input_angle"][-1] - RATIO * 0.09) <= at_motor
    assert abs(run["output_angle"][-1] - 0.09) <= at_motor / RATIO + at_load
    assert not np.ptp(run.between(1.0, 2.0)["input_angle"])
    before = run.between(0.0, 0.0999)
    assert not np.ptp(before["input_angle"])
    assert np.abs(before["current"]).max() < 1e-20, "nothing happens before the step"


def test_it_settles_where_the_last_sample_outside_of_the_band_is(found: PositionControl) -> None:
    assert [len(experiment.settling[FULL]) for experiment in found.experiments] == [1, 0, 6]
    for experiment in found.experiments:
        jumps = [*experiment.command.breaks, experiment.command.duration]
        for model, times in experiment.settling.items():
            for (start, stop), settled in zip(pairwise(jumps), times, strict=True):
                part = experiment.runs[model].between(start, stop)
                angle = part["output_angle"]
                outside = np.abs(angle - angle[-1]) > 0.02 * abs(angle[-1] - angle[0])
                last = part.time[np.flatnonzero(outside)[-1]] - start
                assert last - 1e-9 <= settled <= last + 1e-3 + 1e-9


def test_no_run_leaves_the_range_of_the_friction(found: PositionControl) -> None:
    for experiment in found.experiments:
        angle = experiment.runs[FULL]["input_angle"]
        assert angle.min() > 0.0
        assert angle.max() < 240.82
    assert found.under_control["stroke"].max() < 235.0
    for pulses in found.by_pulse.values():
        assert 225.0 < pulses["full"].max() < 240.82


def test_under_simplified_friction_a_run_backwards_mirrors_one_forwards() -> None:
    drive = sw.load("position-drive")
    there, back = (sw.simulate(drive, sw.scenario.sine(side * 0.03, 1.0, 1.5), sample=1e-2) for side in (1.0, -1.0))
    for name in ("output_angle", "input_angle", "current"):
        assert np.array_equal(there[name], -back[name]), name


# Strokes


def test_the_friction_itself_leaves_the_error_of_its_fit_where_the_parabola_says(found: PositionControl) -> None:
    """s_1 q^2 + s_2 q = -0.0052 N.m has its smaller root at 14.6058 rad, 8.37 degrees of the output."""
    assert found.law_suffices_to == pytest.approx(14.6058, abs=1e-4)
    law = study.without_periodic(found.sets[FULL].drive).gear.friction_input.replace(viscous=0.0)
    assert law.steady(0.8, angle=found.law_suffices_to) == pytest.approx(S3 - 0.0052, rel=1e-9)
    assert law.steady(-0.8, angle=20.0) == -law.steady(0.8, angle=20.0)


@pytest.mark.parametrize("voltage", [6.0, 12.0, 24.0])
def test_pulses_go_as_far_as_a_rigid_drive_in_closed_form(found: PositionControl, voltage: float) -> None:
    """But for the vibration that a pulse leaves in the gear, which matters to the shortest ones."""
    pulses = found.by_pulse[voltage]
    for row, width in enumerate(pulses["width"]):
        for name, friction in (("stroke", S3), ("stronger", S3 + 0.0052), ("weaker", S3 - 0.0052)):
            exact = rigid_stroke(voltage, width, friction)
            assert pulses[name][row] == pytest.approx(exact, rel=2e-3, abs=0.03), (name, width)


def test_pulses_under_the_average_part_go_as_far_as_another_integrator_says(found: PositionControl) -> None:
    pulses = found.by_pulse[12.0]
    for row in (0, len(pulses) // 2, len(pulses) - 2):
        exact = integrated_stroke(12.0, pulses["width"][row], lambda q, v: (S1 * q * q + S2 * q + S3) * (1.0 + 4e-4 * v))
        assert pulses["without_periodic"][row] == pytest.approx(exact, rel=2e-3, abs=0.03)


def test_where_pulses_leave_the_band_the_full_model_goes_as_far_as_a_constant_that_is_wrong(found: PositionControl) -> None:
    drives = {model: gear_set.drive for model, gear_set in found.sets.items()}
    limit = found.pulse_suffices_to[12.0]

    def excess(width: float) -> float:
        average = integrated_stroke(12.0, width, lambda q, v: (S1 * q * q + S2 * q + S3) * (1.0 + 4e-4 * v))
        return average - rigid_stroke(12.0, width, S3 - 0.0052)

    rigid = rigid_stroke(12.0, brentq(excess, 0.2, 1.0, xtol=1e-3), S3)  # 43 rad, without the periodic part
    assert limit == pytest.approx(rigid, rel=0.1)
    width = study.pulse_width(drives[SIMPLIFIED], 12.0, limit)
    weaker = study.with_coulomb(drives[SIMPLIFIED], S3 - 0.0052)
    assert study.travel(drives[FULL], 12.0, width) == pytest.approx(study.travel(weaker, 12.0, width), rel=1e-3)
    assert found.pulse_suffices_to[24.0] < limit < found.pulse_suffices_to[6.0]


def test_sweeps_are_as_good_with_shorter_steps(found: PositionControl, monkeypatch: pytest.MonkeyPatch) -> None:
    drive, width = found.sets[FULL].drive, found.by_pulse[12.0]["width"][6]
    coarse = study.travel(drive, 12.0, width)
    monkeypatch.setattr(study, "SWEEP_STEP", 1e-4)
    assert study.travel(drive, 12.0, width) == pytest.approx(coarse, rel=1e-4)


def test_under_control_friction_shows_in_the_current_and_hardly_in_the_angle(found: PositionControl) -> None:
    """Friction that is wrong by D moves the output by D R / (K_m k_p i) and takes D / K_m more current, once settled."""
    moves = found.under_control
    gap = S2**2 / (4.0 * S1)  # between the constant and the least of the parabola
    assert moves["without_periodic"].max() < gap * RESISTANCE / (TORQUE_CONSTANT * GAIN) / RATIO
    way = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 2001)))
    for stroke, current in zip(moves["stroke"], moves["current"], strict=True):
        q = stroke * way
        wrong = sqrt(np.mean((S1 * q * q + S2 * q) ** 2) + 0.0052**2)  # the parabola, and all that is periodic
        assert stroke < 15.0 or current == pytest.approx(wrong / TORQUE_CONSTANT, rel=0.25), stroke
    assert found.control_suffices_to == inf
    assert moves["output_angle"].max() < min(rms for rms, _, _ in study.TABLE_4.values())
    first = int(np.argmax(moves["output_angle"] > moves["fit_error"]))
    assert moves["stroke"][first - 1] < found.control_within_fit_to <= moves["stroke"][first]


def test_an_average_is_the_integral_over_the_stroke(found: PositionControl) -> None:
    q = np.linspace(0.0, 80.0, 8001)
    exact = np.trapezoid(S1 * q * q + S2 * q + S3, q) / 80.0
    assert study.average(found.sets[FULL].drive, 80.0) == pytest.approx(exact, rel=1e-7)


# A measured run


def test_a_run_of_the_model_itself_is_recognised(found: PositionControl) -> None:
    assert found.measured is not None
    assert found.measured.recording.title == "own.csv"
    assert found.measured.agreement[SIMPLIFIED].rms < 2e-5
    sine = found.experiments[1]
    assert found.measured.agreement[FULL].rms == pytest.approx(sine.between["output_angle"].rms, rel=0.05)
    assert found.measured.beyond is None


def write(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


def test_a_measured_run_may_begin_at_any_time_and_have_its_own_units(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "VOLTAGES", ())
    monkeypatch.setattr(study, "STROKES", (1.0,))
    rows = "".join(f"{5.0 + 0.01 * i:.2f},{-0.01 * i:.3f},{-0.5 * i:.3f}\n" for i in range(100))
    path = write(tmp_path / "run.csv", "time [s],command [rad],output_angle [mrad]\n" + rows)
    measured = position_control(path).measured
    assert measured is not None
    assert measured.recording.time[[0, -1]].tolist() == [0.0, pytest.approx(0.99)]
    assert measured.recording["output_angle"][-1] == pytest.approx(-0.0495)
    assert measured.beyond is not None, "the friction is not known where the motor turns backwards from 0"
    assert measured.beyond[0] < -90.0


def test_a_measured_run_without_a_column_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r'run\.csv has no column "command"; it has time, output_angle'):
        position_control(write(tmp_path / "run.csv", "time [s],output_angle [rad]\n0,0\n1,1\n"))
