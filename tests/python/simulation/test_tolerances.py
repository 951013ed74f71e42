"""The tolerance that adaptive steps keep: of any model, at any place, whatever happens within a step."""

from __future__ import annotations

import re
import sys
from itertools import count, pairwise
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import HealthCheck, assume, given, settings, strategies as st
from strainwave import _core

from tests.evidence.tolerance import COLUMNS, Excited, at_limit, difference, until, verdict
from tests.laws.test_gear import DRIVE as EVERYTHING, EVERY_PART, cannot_create_energy, innermost, laws
from tests.support.little_memory import little_memory
from tests.support.reference_drive import DRIVE, SMOOTH, STICKING, command
from tests.support.samples import sample
from tests.support.strategies import suited


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("drive", [SMOOTH, STICKING, DRIVE], ids=["smooth", "sticking", "reference"])
def test_the_adaptive_method_keeps_its_tolerance_and_wastes_little(drive: sw.Drive, rtol: float) -> None:
    exact = sw.simulate_adaptively(drive, command(0.3), rtol=1e-11)
    error = difference(sw.simulate_adaptively(drive, command(0.3), rtol=rtol), exact)
    assert 1e-4 * rtol < error < 10.0 * rtol


def steps_taken(run: sw.Run) -> int:
    return int(run.method.rpartition(": ")[2].split()[0])


@pytest.mark.parametrize("drive", [SMOOTH, STICKING, DRIVE], ids=["smooth", "sticking", "reference"])
def test_what_is_tolerated_besides_is_kept_and_saves_steps(drive: sw.Drive) -> None:
    """Each angle, speed and torque within `rtol` of its largest plus `atol` in its own unit."""
    exact = sw.simulate_adaptively(drive, command(0.2), rtol=1e-10)
    runs = {atol: sw.simulate_adaptively(drive, command(0.2), rtol=1e-8, atol=atol) for atol in (1e-12, 1e-6, 1e-4, 1e-2)}
    for atol, run in runs.items():
        tolerated = {name: 1e-8 * np.abs(exact[name]).max() + atol for name in COLUMNS}
        errors = [np.abs(run[name] - exact[name]).max() / tolerated[name] for name in COLUMNS]
        assert 1e-3 < max(errors) < 10.0, atol
    steps = [steps_taken(run) for run in runs.values()]
    assert all(fewer < 0.75 * more for more, fewer in pairwise(steps))


def resolvable(drive: sw.Drive, rtol: float, voltage: float = 12.0) -> sw.Run:
    try:
        excited = sw.scenario.sine(voltage, 50.0, 0.02)
        return sw.simulate_adaptively(drive, excited, rtol=rtol, load_torque=2.0, max_steps=10_000)
    except (ValueError, FloatingPointError) as error:  # said, and not this test's matter
        assume(
            not any(words in str(error) for words in ("lies outside of", "the tolerance is not reached", "the largest count"))
        )
        raise


def check_tolerance(drive: sw.Drive) -> None:
    """The error is ten times the tolerance at most, or ten times what a change of the voltage by as much makes.

    A drive that is about to lock or to break away magnifies both.
    """
    assume(cannot_create_energy(drive.gear))
    assume(max(_core.natural_frequency(drive, 1e-3), _core.bristle_frequency(drive)) < 1e4)
    exact = resolvable(drive, 1e-8)
    magnified = max(difference(resolvable(drive, 1e-8, 12.0 * (1.0 + change)), exact) for change in (-1e-5, 1e-5))
    assert difference(resolvable(drive, 1e-5), exact) < 10.0 * max(1e-5, magnified)


@pytest.mark.parametrize(("part", "model"), EVERY_PART)
@settings(max_examples=3, derandomize=True, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_the_tolerance_is_kept_with_any_law_at_any_place(part: str, model: Any, data: st.DataObject) -> None:
    law = suited(data.draw(laws(part, model)), EVERYTHING.gear.kinematics)
    # Friction that changes within 0.01 rad/s or a microradian by more than drives the shaft makes every run a matter of chance.
    assume(getattr(innermost(law), "stribeck_speed", 1.0) >= 1.0)
    assume(getattr(innermost(law), "presliding", 1.0) > 1e-4)
    check_tolerance(EVERYTHING.replace(gear=EVERYTHING.gear.replace(**{part: law})))


@pytest.mark.parametrize("rtol", [1e-4, 4.6e-5, 2.2e-5, 1e-5, 4.6e-6, 2.2e-6, 1e-6])
def test_the_tolerance_is_kept_where_the_twist_turns_round_within_a_step(rtol: float) -> None:
    """A hysteresis of an ounce-inch follows within a microradian, a hundredth of what the twist moves in a step."""
    sudden = sw.hysteresis.BoucWen(stiffness=2.8e5, saturation=0.1, sharpness=60.0)
    check = SMOOTH.replace(gear=SMOOTH.gear.replace(hysteresis=sudden))
    exact, run = (sw.simulate_adaptively(check, command(0.1), rtol=share * rtol, atol=1e-15) for share in (1e-4, 1.0))
    assert difference(run, exact) < 10.0 * rtol


@pytest.mark.parametrize(("least", "most"), [(13.80, 13.82), (15.24, 15.26)])
def test_the_tolerance_is_kept_where_a_play_is_taken_up(least: float, most: float) -> None:
    """Under some of these loads a step and its halves agree by accident on how a loose spring hits its stop."""
    loose = sw.Gear(
        stiffness=sw.stiffness.Piecewise(k1=10.0, k2=1e5, knee=1e-3), friction_input=sw.friction.Viscous(viscous=1e-5)
    )
    drive = sw.Drive(gear=loose, load=sw.loads.Inertia(inertia=0.1))
    errors = []
    for load in np.linspace(least, most, 41):
        exact, run = (
            sw.simulate_adaptively(drive, sw.scenario.constant(24.0, 0.02), rtol=rtol, atol=1e-15, load_torque=load)
            for rtol in (1e-8, 1e-4)
        )
        errors.append(difference(run, exact))
    assert max(errors) < 10.0 * 1e-4


LOCKING, PULL = 100.0, 6.0


def self_locking() -> sw.Drive:
    """A gear whose output bears a hundred times the torque that the gear transmits."""
    locking = sw.friction.LoadDependent(
        driving_forward=LOCKING, driving_reverse=LOCKING, backdriving_forward=LOCKING, backdriving_reverse=LOCKING
    )
    gear = sw.Gear(friction_input=sw.friction.Viscous(viscous=1e-4), friction_output=locking, damping=4.0)
    return sw.Drive(gear=gear, load=sw.loads.Inertia(inertia=0.1))


def slipping(rtol: float, sample: float) -> sw.Recording:
    swing = sw.scenario.sine(24.0, 30.0, 0.06)
    return sw.simulate_adaptively(self_locking(), swing, rtol=rtol, atol=1e-15, load_torque=-PULL, sample=sample)


@pytest.mark.parametrize("rtol", [3e-5, 1e-5, 3e-6, 1e-6])
def test_what_slips_for_a_moment_where_the_torque_turns_over_is_not_missed(rtol: float) -> None:
    """A gear that locks itself holds nothing while it bears nothing: each time, its load moves on by half a nanoradian."""
    exact, run = (slipping(each, 1e-3)["output_angle"] for each in (1e-10, rtol))
    assert np.unique(exact.round(13)).size >= 5
    assert np.abs(run - exact).max() < 10.0 * rtol * np.abs(exact).max()


def test_a_gear_that_locks_itself_slips_as_far_as_the_closed_form_where_its_torque_turns_over() -> None:
    """While the torque T passes zero at some rate, PULL + T - LOCKING |T| moves the load, which then comes to rest.

    What the slip changes of the torque, by the damping, is a hundredth of it and left out.
    """
    run = slipping(1e-6, 1e-5)
    torque, angle = run["torque"], run["output_angle"]
    turnovers = np.flatnonzero(torque[1:] * torque[:-1] < 0.0)
    assert turnovers.size == 3
    for at in turnovers:
        rate = (torque[at + 1] - torque[at]) / 1e-5
        # How the push grows with the torque before that passes zero, and falls after; and the torque where the load rests.
        rising, falling = LOCKING + np.sign(rate), LOCKING - np.sign(rate)
        last = PULL * (1.0 + np.sqrt(1.0 + falling / rising)) / falling
        before = PULL**3 / (6.0 * rising**2)
        after = PULL**2 * last / (2.0 * rising) + PULL * last**2 / 2.0 - falling * last**3 / 6.0
        slip = (before + after) / (0.1 * rate**2)
        assert np.ptp(angle[at - 300 : at + 300]) == pytest.approx(slip, rel=0.02)


# Each is a drive that is compared: those drawn before it of its hundred are set aside, after runs of up to 5 s.
@pytest.mark.slow("simulation")
@pytest.mark.parametrize("first", [10, 104, 201, 310, 401])
def test_the_tolerance_is_kept_with_random_laws_at_all_places(first: int) -> None:
    """By a drive or three from each; `python -m tests.evidence.tolerance` takes two hundred, and says what is left out."""
    verdicts = until(sample(1, 3), map(verdict, count(first)))
    assert [one for one in verdicts if one.missed] == []


@pytest.mark.parametrize("motor", [sw.motor.BrushlessDC(), sw.motor.PMSM()], ids=["brushless", "synchronous"])
@pytest.mark.parametrize(("voltage", "limited"), [(0.5, False), (-0.5, False), (100.0, True), (-100.0, True)])
def test_a_motor_counts_as_limited_only_where_it_is(motor: Any, voltage: float, limited: bool) -> None:
    drive = sw.Drive(motor=motor, control=sw.control.OpenLoop(), load=sw.loads.Inertia(inertia=0.1))
    run = sw.simulate(drive, sw.scenario.constant(voltage, 0.02), sample=1e-3)
    assert at_limit(drive, run) == limited


@pytest.mark.slow("simulation")
@pytest.mark.parametrize("first", [10, 15])
def test_what_fixed_steps_of_random_drives_approach_is_what_adaptive_ones_give(first: int) -> None:
    """Another way to the same; where a controller at its limit switches the error is that of when it does, within a step."""
    compared = 0
    for number in range(first, first + sample(3, 12)):
        random = Excited.drawn(number)
        try:
            exact = random.run(1e-2)
            wide, narrow = (random.run_in_steps(dt) for dt in (4e-6, 1e-6))
        except (ValueError, FloatingPointError):  # told, and not this test's matter
            continue
        errors = [difference(run, exact, random.columns) for run in (wide, narrow)]
        if errors[1] >= 0.02:  # too stiff for such steps, or a shaft comes to rest between them
            narrowest = random.run_in_steps(2.5e-7)
            if difference(narrow, narrowest, random.columns) >= 0.02:
                continue  # these steps do not approach anything yet
            errors = [errors[1], difference(narrowest, exact, random.columns)]
        if not at_limit(random.drive, exact):
            assert errors[1] < max(0.7 * errors[0], 1e-5), number
        assert errors[1] < 0.02, number
        compared += 1
    assert compared >= sample(1, 5)


@pytest.mark.parametrize("sample", [1e-3, 7e-5, 0.03])
def test_samples_lie_anywhere_within_steps(sample: float) -> None:
    """Between the ends of steps a sample is as exact as at them."""
    exact = sw.simulate(SMOOTH, command(0.15), 5e-6, sample=sample)
    run = sw.simulate_adaptively(SMOOTH, command(0.15), rtol=1e-8, sample=sample)
    assert np.array_equal(run["time"], exact["time"])
    assert difference(run, exact) < 1e-7


def test_an_input_that_varies_within_a_step_is_followed() -> None:
    """A load of 200 Hz, and one that jumps."""
    load = sw.scenario.sine(20.0, 200.0, 0.1) + sw.scenario.step(5.0, 0.1, start=0.0333)
    exact = sw.simulate(SMOOTH, command(0.1), 2e-6, sample=1e-3, load_torque=load)
    assert difference(sw.simulate_adaptively(SMOOTH, command(0.1), rtol=1e-7, load_torque=load), exact) < 1e-6


@pytest.mark.slow("simulation")
@pytest.mark.parametrize(
    ("period", "width", "duration"),
    [(0.3, 0.05, 0.4), (0.1 * 3, 0.05, 0.4), (0.3 - 1e-15, 0.05, 0.4), (0.7, 0.1, 0.8), (0.09, 0.01, 0.1), (0.02, 1e-14, 0.1)],
)
def test_inputs_jump_anywhere(period: float, width: float, duration: float) -> None:
    """A rounding beside where steps end anyway, and before the end: 0.7 + 0.1 is less than 0.8."""
    pulse = sw.scenario.pulse_train(0.01, period, width, duration)
    exact = sw.simulate(SMOOTH, pulse, 2e-6, sample=1e-3)
    assert difference(sw.simulate_adaptively(SMOOTH, pulse, rtol=1e-7), exact) < 1e-6


@pytest.mark.parametrize("other", [0.3, 0.1 * 3, 0.3 - 1e-16])
def test_two_inputs_jump_at_one_instant_but_for_rounding(other: float) -> None:
    """Command and load, and a temperature that friction depends on."""
    thermal = sw.friction.Thermal(law=SMOOTH.gear.friction_input, viscous_fall=0.02)
    drive = SMOOTH.replace(gear=SMOOTH.gear.replace(friction_input=thermal))
    pulse = sw.scenario.step(0.01, 0.4, start=0.3)
    acting = {
        "load_torque": sw.scenario.step(5.0, 0.4, start=other),
        "temperature": sw.scenario.constant(293.0, 0.4) + sw.scenario.step(30.0, 0.4, start=other),
    }
    exact = sw.simulate(drive, pulse, 2e-6, sample=1e-3, **acting)
    assert difference(sw.simulate_adaptively(drive, pulse, rtol=1e-7, **acting), exact) < 1e-6


@pytest.mark.parametrize("frequency", [800.0, 12345.6])
def test_an_input_faster_than_the_drive_is_not_overlooked(frequency: float) -> None:
    """Of 800 Hz a step of 5 ms would see nothing but zeros."""
    load = sw.scenario.sine(20.0, frequency, 0.05)
    exact = sw.simulate(SMOOTH, command(0.05), 1e-6, sample=1e-3, load_torque=load)
    assert difference(sw.simulate_adaptively(SMOOTH, command(0.05), rtol=1e-5, load_torque=load), exact) < 1e-4


def test_what_cannot_be_a_tolerance_is_refused() -> None:
    for rtol in (0.0, 1e-12, 0.1, float("nan")):
        with pytest.raises(ValueError, match=r"^rtol = .* must lie in \[1e-11, 0\.01\]$"):
            sw.simulate_adaptively(DRIVE, command(0.1), rtol=rtol)
    with pytest.raises(ValueError, match=r"^atol = 0\.0 must lie in \(0, inf\)$"):
        sw.simulate_adaptively(DRIVE, command(0.1), atol=0.0)


@pytest.mark.parametrize(
    ("voltage", "steps", "words"),
    [
        (
            sw.scenario.constant(0.1, 1e6),
            10_000_000,
            "1e+06 s: adaptive steps are 0.005 s long at most, which makes 2e+08 steps",
        ),
        (
            sw.scenario.constant(0.1, 1e30),
            10_000_000,
            "1e+30 s: adaptive steps are 0.005 s long at most, which makes 2e+32 steps",
        ),
        (sw.scenario.sine(1.0, 1e3, 1.0), 4999, "1 s: adaptive steps are 0.0002 s long at most, which makes 5e+03 steps"),
    ],
)
def test_a_duration_that_max_steps_cannot_span_is_refused_at_once(
    voltage: sw.scenario.Scenario, steps: int, words: str
) -> None:
    """A run takes a step each 5 ms, and five in a period of an input, at the least; nothing is laid out for them."""
    said = f"max_steps = {steps} are too few for {words}; allow more, or make several runs, each from the end of the one before"
    with pytest.raises(ValueError, match=f"^{re.escape(said)}$"):
        sw.simulate_adaptively(DRIVE, voltage, max_steps=steps, sample=voltage.duration)


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is limited as Linux does it")
def test_adaptive_steps_too_many_for_the_memory_say_how_large_they_are() -> None:
    words = r"^2e\+07 steps take 0\.8 GB, more memory than there is; take longer steps, "
    with little_memory(64 << 20), pytest.raises(MemoryError, match=words):
        sw.simulate_adaptively(DRIVE, sw.scenario.constant(0.1, 1e5), max_steps=10**9, sample=1e5)


def test_a_run_that_needs_more_steps_than_allowed_says_how_far_they_led_and_what_is_fast() -> None:
    """The gear at rest: 1.2e4 + 3e3 N.m/rad between 0.5 kg.m2 and 1e-4 kg.m2 times 100 squared; bristles of 50 N.m/rad."""
    vibration = np.sqrt(np.linalg.eigvals([[1.5e4, -1.5e4], [-1.5e4 / 0.5, (1.5e4 + 15.0) / 0.5]]).max())  # 15: of the arm
    run = sw.simulate_adaptively(DRIVE, command(0.1))
    taken = steps_taken(run)
    assert sw.simulate_adaptively(DRIVE, command(0.1), max_steps=taken) == run
    words = (
        r"^the largest count of steps, max_steps, was reached at t = 0\.09\d* s; .*"
        rf" the gear vibrates at {vibration:.4g} rad/s at rest,"
        rf" a shaft on its bristles at {np.sqrt(50.0 / 1e-4):.4g} rad/s$"
    )
    with pytest.raises(FloatingPointError, match=words):
        sw.simulate_adaptively(DRIVE, command(0.1), max_steps=taken - 1)
    with pytest.raises(ValueError, match=r"^max_steps = 0 must be 1 or more$"):
        sw.simulate_adaptively(DRIVE, command(0.1), max_steps=0)
    with pytest.raises(ValueError, match=r"^max_steps = 10{30} must be 9223372036854775807 or less$"):
        sw.simulate_adaptively(DRIVE, command(0.1), max_steps=10**30)
