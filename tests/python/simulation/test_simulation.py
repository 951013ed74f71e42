"""Courses through time, and what the runs along them promise."""

from __future__ import annotations

import copy
import math
import pickle
import re
from collections.abc import Callable

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core
from strainwave.simulation import run as simulation
from strainwave.simulation.excitation import ROOM_TEMPERATURE, Excitation
from strainwave.simulation.signals import outputs
from strainwave.simulation.time_grid import TimeGrid

from tests.support.interrupts import ctrl_c
from tests.support.reference_drive import DRIVE, command

DT = 2.0**-12  # s: its multiples are exact, so that the steps of a run and of a part of it are the same
HELD = sw.scenario.constant(0.02, 0.25)
COLUMNS = list(outputs(sw.Drive()))
EVERY = list(range(len(COLUMNS)))  # channel
STICKING = DRIVE.replace(gear=DRIVE.gear.replace(friction_output=sw.friction.Coulomb(coulomb=3.0, breakaway=4.0, viscous=0.5)))
drives = pytest.mark.parametrize("drive", [DRIVE, STICKING], ids=["smooth", "set-valued"])

durations = st.floats(0.01, 1.0)
steps = st.sampled_from([1e-3, 2e-3, 3e-3, 7e-3, 0.01, 1 / 30])


def same(one: sw.Recording, other: sw.Recording) -> bool:
    return one.names == other.names and all(np.array_equal(one[name], other[name]) for name in one.names)


# Courses


@given(durations, steps, steps, st.lists(st.floats(0.0, 1.0, exclude_min=True, exclude_max=True), max_size=5))
def test_steps_end_at_samples_and_breaks_and_are_no_longer_than_asked(
    duration: float, dt: float, sample: float, shares: list[float]
) -> None:
    breaks = duration * np.array(shares)
    course = TimeGrid.through(duration, dt, sample, breaks)
    one = 1e-9 * min(dt, sample)  # instants this close are one
    assert course.instants[[0, -1]] == pytest.approx([0.0, duration], rel=0.0, abs=one)
    assert np.diff(course.instants).min() > 0.0
    assert np.diff(course.instants).max() <= dt + 2.0 * one
    assert np.isin(breaks, course.instants).all() or np.diff(np.sort(breaks)).min() <= one
    samples = course.instants[course.samples == 1]
    assert samples[:-1] == pytest.approx(sample * np.arange(len(samples) - 1), rel=0.0, abs=one)
    assert samples[-1] == pytest.approx(duration, rel=0.0, abs=one)
    assert len(samples) - 1 == pytest.approx(duration / sample, abs=1.0)


def test_steps_are_as_long_as_asked_where_nothing_asks_for_more() -> None:
    course = TimeGrid.through(1.0, 0.25, 0.5, np.empty(0))
    assert course.instants.tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
    assert course.samples.tolist() == [1, 0, 1, 0, 1]


@pytest.mark.parametrize(("dt", "multiple"), [(2e-4, 3), (3e-4, 5), (6e-4, 5), (7e-4, 17), (1e-3, 7), (0.3, 3)])
def test_a_jump_between_two_steps_is_seen_by_the_second_alone(dt: float, multiple: int) -> None:
    """Also where floating point puts the jump, written in decimals, beside the multiple: 5 * 3e-4 < 0.0015."""
    jump = round(dt * multiple, 12)
    excitation = Excitation(sw.scenario.step(1.0, duration=jump + 2.0 * dt, start=jump))
    inputs = excitation.over(excitation.time_grid(dt, None).instants)[:, :, 0]
    assert inputs.tolist() == multiple * [[0.0] * 3] + 2 * [[1.0] * 3]


@pytest.mark.parametrize("others", [0.1 * 3, 0.3 - 1e-16, 0.3])
def test_jumps_of_two_signals_at_one_instant_but_for_rounding_are_seen_by_the_next_step_alone(others: float) -> None:
    excitation = Excitation(sw.scenario.step(1.0, duration=0.5, start=0.3), sw.scenario.step(2.0, duration=0.5, start=others))
    inputs = excitation.over(excitation.time_grid(0.1, None).instants)
    assert inputs[:, :, 0].tolist() == 3 * [[0.0] * 3] + 2 * [[1.0] * 3]
    assert inputs[:, :, 2].tolist() == 3 * [[0.0] * 3] + 2 * [[2.0] * 3]


@pytest.mark.parametrize("second", [0.1 * 3, 0.3 + 1e-13])
def test_two_jumps_of_one_signal_at_one_instant_but_for_rounding_are_seen_by_the_next_step_alone(second: float) -> None:
    twice = sw.scenario.step(1.0, duration=0.5, start=0.3) + sw.scenario.step(2.0, duration=0.5, start=second)
    excitation = Excitation(twice)
    inputs = excitation.over(excitation.time_grid(0.1, None).instants)
    assert inputs[:, :, 0].tolist() == 3 * [[0.0] * 3] + 2 * [[3.0] * 3]


@pytest.mark.parametrize(("dt", "sample", "duration"), [(1e-4, 3e-4, 649.5), (1e-4, 1e-3, 600.0003)])
def test_a_long_run_has_no_slivers_and_no_sample_twice(dt: float, sample: float, duration: float) -> None:
    """Multiples of steps and of samples are apart by rounding, which is more than a share of a step then."""
    course = TimeGrid.through(duration, dt, sample, np.empty(0))
    assert np.diff(course.instants).min() > 1e-3 * dt
    assert len(course.times) == math.ceil(duration / sample * (1.0 - 1e-12)) + 1


def test_steps_are_judged_by_how_long_they_are() -> None:
    """However long they may be: here samples and the end cut them."""
    fast = DRIVE.replace(load=sw.loads.Inertia(inertia=1e-4), control=sw.control.OpenLoop())
    volts = sw.scenario.constant(5.0, 2e-3)
    with pytest.raises(FloatingPointError, match="too coarse"):
        sw.simulate(fast, volts, 2e-4)
    short = sw.simulate(fast, volts, 2e-4, sample=2e-5)
    assert short.method == sw.simulate(fast, volts, 2e-5).method
    assert short["torque"] == pytest.approx(sw.simulate(fast, volts, 2e-5)["torque"], rel=1e-9)
    assert not sw.simulate_many(fast, volts, {"load.inertia": [1e-4]}, 2e-4, sample=2e-5).failures
    assert (
        sw.analysis.derivatives(fast, volts, ["load.inertia"], 2e-4, sample=2e-5).run["torque"].tolist()
        == short["torque"].tolist()
    )
    assert len(sw.simulate(fast, sw.scenario.constant(5.0, 2e-5), 2e-4)) == 2


@pytest.mark.parametrize("steps", [255, 256, 257, 512])
def test_a_jump_is_seen_wherever_inputs_are_laid_out_in_pieces(steps: int, monkeypatch: pytest.MonkeyPatch) -> None:
    jump = steps * 2.0**-10
    sticking = sw.scenario.step(0.05, duration=1.0, start=jump)
    whole = sw.simulate(STICKING, sticking, 2.0**-10)
    monkeypatch.setattr(simulation, "STEPS_PER_CHUNK", steps)
    assert same(sw.simulate(STICKING, sticking, 2.0**-10), whole)
    before = sw.simulate(STICKING, sw.scenario.constant(0.0, jump), 2.0**-10)
    after = sw.simulate(STICKING, sw.scenario.constant(0.05, 1.0 - jump), 2.0**-10, initial=before.end)
    assert after.end == whole.end
    assert whole["output_angle"][-1] > 0.01


@pytest.mark.parametrize(("dt", "sample"), [(1e10, None), (1e-3, 1e10), (1e10, 1e10), (1e10, 5e-4)])
def test_steps_and_samples_longer_than_the_run_end_with_it(dt: float, sample: float | None) -> None:
    drive = DRIVE.replace(motor=DRIVE.motor.replace(inertia=1e6), load=DRIVE.load.replace(inertia=1e9))
    run = sw.simulate(drive, sw.scenario.constant(0.0, 2e-3), dt, sample=sample, method="rosenbrock")
    assert run["time"][[0, -1]].tolist() == [0.0, 2e-3]
    adaptive = sw.simulate_adaptively(DRIVE, sw.scenario.constant(0.0, 2e-3), sample=1e10)
    assert adaptive["time"].tolist() == [0.0, 2e-3]


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ({"dt": 0.0}, "step.dt = 0 s must lie in (0, inf)"),
        ({"dt": -1e-3}, "step.dt = -0.001 s must lie in (0, inf)"),
        ({"dt": float("nan")}, "step.dt = nan s must lie in (0, inf)"),
        ({"command": float("nan")}, "step.command = nan must be finite"),
        ({"command_rate": float("inf")}, "step.command_rate = inf 1/s must be finite"),
        ({"load_torque": float("nan")}, "step.load_torque = nan N.m must be finite"),
        ({"temperature": 0.0}, "step.temperature = 0 K must lie in (0, inf)"),
    ],
)
def test_a_step_by_hand_is_given_numbers_that_mean_something(inputs: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(words)}$"):
        DRIVE.step(DRIVE.rest(), **{"dt": 1e-3} | inputs)


def test_a_step_by_hand_is_refused_where_a_run_is() -> None:
    narrow = sw.friction.PositionDependent(constant=0.072, domain_start=-10.0, domain_end=9.3)
    bounded = DRIVE.replace(gear=DRIVE.gear.replace(friction_input=narrow))
    rest = bounded.rest()
    turned = rest.replace(input_speed=1e3, turns=2.0)
    with pytest.raises(ValueError, match=r"^gear\.friction_input: angle = .* outside of \[-10, 9\.3\]"):
        bounded.step(turned, dt=1e-4)
    with pytest.raises(ValueError, match=r"^gear\.friction_input: angle = .* first at t = 0\.0001 s"):
        bounded.step(turned.replace(turns=1.0, input_angle=3.0), dt=1e-4)
    with pytest.raises(FloatingPointError, match=r"^the step diverged; take a smaller dt"):
        DRIVE.step(DRIVE.rest(), command=1e308, dt=1e308)


def test_inputs_are_the_left_limits_at_the_end_of_a_step() -> None:
    load = sw.scenario.step(5.0, duration=0.4, start=0.2)
    warming = sw.scenario.step(20.0, duration=0.4, start=0.3) + sw.scenario.constant(290.0, duration=0.4)
    excitation = Excitation(sw.scenario.ramp(2.0, duration=0.4), load, warming)
    inputs = excitation.over(excitation.time_grid(0.1, None).instants)
    assert inputs[:, :, 0] == pytest.approx(2.0 * np.array([[0, 5, 10], [10, 15, 20], [20, 25, 30], [30, 35, 40]]) / 100)
    assert inputs[:, :, 1] == pytest.approx(np.full((4, 3), 2.0))
    assert inputs[:, :, 2].tolist() == [[0.0] * 3, [0.0] * 3, [5.0] * 3, [5.0] * 3]
    assert inputs[:, :, 4].tolist() == [[290.0] * 3, [290.0] * 3, [290.0] * 3, [310.0] * 3]
    assert excitation.first().tolist() == [0.0, 2.0, 0.0, 0.0, 290.0, 0.0]


def test_load_torque_and_temperature_may_be_numbers() -> None:
    numbers = Excitation(HELD, 3.0, 310.0)
    lines = Excitation(HELD, sw.scenario.constant(3.0, 0.25), sw.scenario.constant(310.0, 0.25))
    course = numbers.time_grid(0.1, None)
    assert np.array_equal(numbers.over(course.instants), lines.over(course.instants))
    assert np.array_equal(numbers.first(), lines.first())
    assert Excitation(HELD).first().tolist() == [0.02, 0.0, 0.0, 0.0, ROOM_TEMPERATURE, 0.0]


# Runs


def test_the_first_sample_is_the_start_and_the_last_the_end() -> None:
    run = sw.simulate(DRIVE, command(0.0105), dt=1e-3, sample=2e-3)
    assert run["time"] == pytest.approx([0.0, 2e-3, 4e-3, 6e-3, 8e-3, 0.01, 0.0105], rel=1e-14)
    assert run["output_angle"][0] == -DRIVE.gear.kinematic_error.error(0.0)
    assert run["twist"][0] == run["input_speed"][0] == 0.0
    assert run["command"] == pytest.approx(command(0.0105).value(run["time"]), rel=1e-12)


@pytest.mark.parametrize("simulate", [sw.simulate, sw.simulate_adaptively])
def test_a_run_is_what_a_recording_of_its_columns_would_be(simulate: Callable[..., sw.Run]) -> None:
    """Which checks and freezes all that comes in; runs that are made here skip it, runs that are made by hand do not."""
    run = simulate(DRIVE, sw.scenario.constant(0.02, 0.01))
    checked = sw.Recording({name: run[name].copy() for name in run.names}, run.units, run.title)
    assert run == checked
    assert list(run.units.items()) == list(checked.units.items())
    assert not any(run[name].flags.writeable for name in run.names)
    with pytest.raises(ValueError, match="is not finite"):
        sw.Run({"time": np.array([0.0, np.nan])}, {"time": "s"}, run.end, run.method)


def test_columns_have_their_units_and_the_command_that_of_the_controller() -> None:
    run = sw.simulate(DRIVE, command(0.01))
    assert {name: run.unit(name) for name in COLUMNS if name != "command"} == {
        name: each.unit for name, each in outputs(sw.Drive()).items() if name != "command"
    }
    assert run.unit("command") == "rad"
    assert sw.simulate(DRIVE.replace(control=sw.control.OpenLoop()), command(0.01)).unit("command") == "V"


def test_the_load_torque_holds_the_output_back() -> None:
    """A free drive is accelerated by -T over all its inertia as the output feels it."""
    rigid = sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.StrainWave(), stiffness=sw.stiffness.Linear(k=1e5), damping=50.0, input_inertia=2e-5
        ),
        motor=sw.motor.DC(torque_constant=0.0, inertia=3e-5),
        load=sw.loads.Inertia(inertia=0.5),
    )
    run = sw.simulate(rigid, sw.scenario.constant(0.0, 1.0), dt=1e-4, load_torque=sw.scenario.constant(2.0, 1.0), sample=0.5)
    acceleration = -2.0 / (0.5 + 100.0**2 * 5e-5)
    assert np.diff(run["output_speed"][1:]) == pytest.approx(0.5 * acceleration, rel=1e-9)
    assert run["input_speed"][-1] == pytest.approx(-100.0 * run["output_speed"][-1], rel=1e-9)


@drives
def test_a_run_laid_out_in_pieces_is_one_run(drive: sw.Drive, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = sw.simulate(drive, command(0.2), dt=1e-3, sample=2e-3)
    monkeypatch.setattr(simulation, "STEPS_PER_CHUNK", 7)
    assert same(sw.simulate(drive, command(0.2), dt=1e-3, sample=2e-3), whole)


@drives
def test_a_run_goes_on_where_another_ended_to_the_last_bit(drive: sw.Drive) -> None:
    course = Excitation(HELD).time_grid(DT, None)
    half = len(course.instants) // 2
    first = sw.simulate(drive, sw.scenario.constant(0.02, course.instants[half]), DT)
    rest = sw.scenario.constant(0.02, 0.25 - course.instants[half])
    whole, second = sw.simulate(drive, HELD, DT), sw.simulate(drive, rest, DT, initial=first.end)
    assert second.end == whole.end
    for name in COLUMNS:
        assert np.array_equal(first[name], whole[name][: half + 1]), name
        assert np.array_equal(second[name], whole[name][half:]), name


def test_steps_by_hand_are_the_steps_of_a_run() -> None:
    state = STICKING.rest()
    for _ in range(200):
        state = STICKING.step(state, command=0.02, dt=DT)
    by_hand = _core.now(STICKING, state.numbers, Excitation(HELD).first())[
        [each.channel for each in outputs(STICKING).values()], 0
    ]
    run = sw.simulate(STICKING, sw.scenario.constant(0.02, 200 * DT), DT)
    assert by_hand == pytest.approx([run[name][-1] for name in COLUMNS], rel=1e-12)


# Long runs


def test_progress_counts_the_steps_and_can_stop_the_run() -> None:
    excitation = Excitation(command(10.0))
    course = excitation.time_grid(DT, 1.0)
    outputs = np.empty((len(COLUMNS), len(course.times)))
    course_of = (course.instants, excitation.over(course.instants), course.samples[1:])
    arguments = (DRIVE, DRIVE.rest().numbers, *course_of, _core.Method.exponential, EVERY, outputs, 1)
    counted: list[int] = []
    _core.simulate(*arguments, counted.append)
    assert counted == sorted(set(counted))
    assert counted[0] == 0
    assert counted[-1] < len(course.instants)

    def stop(done: int) -> None:
        raise RuntimeError(f"stopped after {done}")

    with pytest.raises(RuntimeError, match="stopped after 0"):
        _core.simulate(*arguments, stop)


@pytest.mark.parametrize(("channels", "samples", "first"), [(15, 11, 1), (16, 10, 1), (16, 11, 2), (16, 11, 12)])
def test_outputs_are_written_within_the_array_given_only(channels: int, samples: int, first: int) -> None:
    excitation = Excitation(command(0.01))
    course = excitation.time_grid(1e-3, None)
    steps = (course.instants, excitation.over(course.instants), course.samples[1:])
    arguments = (DRIVE, DRIVE.rest().numbers, *steps, _core.Method.exponential, EVERY)
    with pytest.raises(ValueError, match="are written within"):
        _core.simulate(*arguments, np.empty((channels, samples)), first)
    with pytest.raises(TypeError, match="incompatible"):
        _core.simulate(*arguments, np.empty((16, 11), np.float32), 1)  # type: ignore[arg-type]


def test_a_progress_bar_changes_nothing() -> None:
    assert same(sw.simulate(DRIVE, command(0.1), progress=True), sw.simulate(DRIVE, command(0.1)))


def test_an_interrupt_ends_a_long_run_on_its_way() -> None:
    excitation = Excitation(sw.scenario.constant(0.1, 300.0))
    course = excitation.time_grid(DT, 10.0)
    inputs, outputs = excitation.over(course.instants), np.empty((len(COLUMNS), len(course.times)))
    start = DRIVE.rest().numbers
    times = course.instants, inputs, course.samples[1:]
    with ctrl_c(), pytest.raises(KeyboardInterrupt):
        _core.simulate(DRIVE, start, *times, _core.Method.exponential, EVERY, outputs, 1)


HOUR = 3600.0 * 2000.0 / 60.0  # turns of the input at 2000 rpm
RIPPLING = sw.friction.Cyclic(law=sw.friction.Coulomb(coulomb=0.03), order=[2.0, 0.5], amplitude=[0.2, 0.1], phase=[0.3, 0.1])
RUNNING = {
    "reference": DRIVE.gear,
    "set-valued": DRIVE.gear.replace(friction_input=RIPPLING, friction_output=sw.friction.Coulomb(coulomb=3.0, breakaway=4.0)),
    "strain wave": DRIVE.gear.replace(kinematics=sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202)),
}


@pytest.mark.parametrize("gear", RUNNING.values(), ids=RUNNING)
@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("method", ["exponential", "moreau_jean"])
def test_after_an_hour_of_rotation_a_run_is_as_accurate_as_at_first(
    gear: sw.Gear, sense: float, method: simulation.Method
) -> None:
    """What depends on the angle repeats with whole turns of the output; only where these are told is an hour more.

    The pendulum alone feels that its angle of 7500 rad is told to 1e-12 rad. Had the input angle not been kept within its turn,
    torque and twist would differ by 1e-4 of their peaks.
    """
    drive = DRIVE.replace(gear=gear, control=sw.control.OpenLoop())
    start = sw.simulate(drive, sw.scenario.constant(sense * 21.0, 0.3), method=method).end
    voltage = sw.scenario.constant(sense * 21.0, 0.1)
    first = sw.simulate(drive, voltage, initial=start, method=method)
    later = sw.simulate(drive, voltage, initial=start.replace(turns=start.turns + sense * HOUR), method=method)
    assert np.abs(first["input_speed"]).mean() * 30.0 / math.pi == pytest.approx(1950.0, rel=0.03)
    for name in ("torque", "twist", "transmission_error", "input_speed", "output_speed", "friction_input"):
        assert np.abs(later[name] - first[name]).max() <= 1e-12 * np.abs(first[name]).max(), name
    assert later["input_angle"] - first["input_angle"] == pytest.approx(sense * 2.0 * math.pi * HOUR, rel=1e-14)


@pytest.mark.whole_path("simulation")
def test_an_hour_of_steps_loses_no_angle_speed_or_twist() -> None:
    """Started from rest by a constant voltage: the speed approaches w, and the angle lags by what the inertia has taken."""
    resistance, km, viscous, input_inertia, output_inertia, ratio = 1.0, 0.05, 1e-4, 5e-3, 0.5, 100.0
    drive = sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.PlainRatio(reduction=ratio),
            stiffness=sw.stiffness.Linear(k=50.0),
            damping=5.0,
            friction_input=sw.friction.Viscous(viscous=viscous),
        ),
        motor=sw.motor.DC(resistance=resistance, torque_constant=km, back_emf=km, inertia=input_inertia),
        load=sw.loads.Inertia(inertia=output_inertia),
    )
    run = sw.simulate(drive, sw.scenario.constant(11.0, 3600.0), dt=5e-3, sample=3600.0)
    brake = km * km / resistance + viscous
    w, lag = 11.0 * km / resistance / brake, (input_inertia + output_inertia / ratio**2) / brake
    assert run["input_speed"][-1] == pytest.approx(w, rel=1e-12)
    assert run["output_speed"][-1] == pytest.approx(w / ratio, rel=1e-12)
    assert run["input_angle"][-1] == pytest.approx(w * (3600.0 - lag), rel=1e-12)
    assert abs(run["twist"][-1]) < 1e-12
    assert run.end.turns > HOUR
    assert abs(run.end.input_angle) <= math.pi


# What a run may start from, and at which steps


@pytest.mark.parametrize("simulate", [sw.simulate, sw.simulate_adaptively])
def test_the_first_sample_of_a_run_from_the_end_of_another_drive_is_that_of_its_own_friction(
    simulate: Callable[..., sw.Run],
) -> None:
    running = DRIVE.replace(control=sw.control.OpenLoop())
    slow, fast = (running.replace({"gear.friction_input": sw.friction.Coulomb(coulomb=coulomb)}) for coulomb in (0.01, 0.02))
    backwards = sw.scenario.constant(-20.0, 0.1)
    run = simulate(fast, backwards, initial=sw.simulate(slow, backwards).end)
    assert run["input_speed"][0] < 0.0
    assert run["friction_input"][0] == run["friction_input"][1] == -0.02


@pytest.mark.parametrize("simulate", [sw.simulate, sw.simulate_adaptively])
def test_a_start_of_a_drive_with_other_models_is_refused(simulate: Callable[..., sw.Run]) -> None:
    other = DRIVE.replace({"gear.friction_input": sw.friction.Viscous(viscous=1e-4)})
    with pytest.raises(
        ValueError, match="initial is a state of another drive: its friction_input is lugre, here it is viscous"
    ):
        simulate(other, HELD, initial=DRIVE.rest())
    elements = DRIVE.replace({"gear.hysteresis": sw.hysteresis.MaxwellSlip(stiffness=[1.0], breakaway=[1.0])})
    with pytest.raises(ValueError, match="its hysteresis is maxwell_slip with other numbers of elements"):
        simulate(elements, HELD, initial=DRIVE.rest())


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda run: pickle.loads(pickle.dumps(run))])
def test_a_copy_of_a_run_is_one(copied: Callable[[sw.Run], sw.Run]) -> None:
    run = sw.simulate(DRIVE, HELD)
    again = copied(run)
    assert same(again, run)
    assert (again.end, again.method, again.title) == (run.end, run.method, run.title)


def test_a_start_in_motion_slides_whatever_the_state_says_of_sliding() -> None:
    """Coulomb friction alone brakes evenly: w(t) = w0 - F t / J."""
    friction = sw.friction.Coulomb(coulomb=0.01, breakaway=0.01)
    drive = sw.Drive(
        gear=sw.Gear(stiffness=sw.stiffness.Linear(k=1e-30), friction_input=friction),
        motor=sw.motor.DC(torque_constant=0.0, back_emf=0.0, inertia=1e-3),
    )
    rest = drive.rest()
    for speed in (5.0, -5.0):
        start = rest.replace(input_speed=speed)
        run = sw.simulate(drive, sw.scenario.constant(0.0, 0.2), initial=start)
        assert run["input_speed"][-1] == pytest.approx(np.sign(speed) * (5.0 - 0.01 * 0.2 / 1e-3), rel=1e-12)
        assert np.sign(run["friction_input"][-1]) == np.sign(speed)


def test_a_step_that_cannot_follow_the_gear_is_refused_with_one_that_can() -> None:
    drive = sw.Drive(gear=sw.Gear(stiffness=sw.stiffness.Linear(k=1e4)), load=sw.loads.Inertia(inertia=1e-2))
    command = sw.scenario.step(amplitude=1.0, duration=0.1)
    frequency = np.sqrt(1e4 * (1.0 / 1e-2 + 1.0 / (1e4 * drive.motor.inertia)))
    with pytest.raises(FloatingPointError, match=rf"a vibration of {frequency:.4g} rad/s") as refused:
        sw.simulate(drive, command, dt=1.5 / frequency)
    stated = float(str(refused.value).partition("take dt = ")[2].partition(" ")[0])
    assert 0.9 / frequency < stated <= 1.0 / frequency
    assert len(sw.simulate(drive, command, dt=stated)) > 2


def test_a_drive_without_inertia_at_the_input_is_refused() -> None:
    with pytest.raises(ValueError, match="cannot both be 0: the input needs an inertia"):
        sw.Drive(motor=sw.motor.DC(inertia=0.0))
