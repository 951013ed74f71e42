"""What no run can do, and how it is refused."""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.simulation import run as simulation
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.resolution import rounded_down
from strainwave.simulation.run import differentiate
from strainwave.simulation.signals import outputs
from strainwave.simulation.time_grid import LONG_RUN

from tests.support.little_memory import little_memory
from tests.support.reference_drive import DRIVE, command
from tests.support.strategies import made

COLUMNS = list(outputs(sw.Drive()))
EVERY = list(range(len(COLUMNS)))  # channel
STICKING = DRIVE.replace(gear=DRIVE.gear.replace(friction_output=sw.friction.Coulomb(coulomb=3.0, breakaway=4.0, viscous=0.5)))
drives = pytest.mark.parametrize("drive", [DRIVE, STICKING], ids=["smooth", "set-valued"])


@pytest.mark.parametrize("name", ["dt", "sample"])
@pytest.mark.parametrize("value", [0.0, -1e-3, float("nan"), float("inf")])
def test_a_step_or_a_sample_that_is_not_positive_is_refused(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=rf"^{name} = {value} s must lie in \(0, inf\)$"):
        sw.simulate(DRIVE, command(0.1), **{name: value})


@pytest.mark.parametrize("name", ["load_torque", "temperature"])
def test_a_load_torque_or_a_temperature_of_another_length_or_not_finite_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name} lasts 0\.2 s, command 0\.1 s; both must last equally long$"):
        sw.simulate(DRIVE, command(0.1), **{name: sw.scenario.constant(300.0, 0.2)})
    with pytest.raises(ValueError, match=rf"^{name} = nan (N.m|K) must be finite$"):
        sw.simulate(DRIVE, command(0.1), **{name: float("nan")})


@pytest.mark.parametrize("temperature", [-20.0, sw.scenario.step(-313.15, 0.1, start=0.07) + sw.scenario.constant(293.15, 0.1)])
def test_a_temperature_below_absolute_zero_is_refused(temperature: sw.scenario.Scenario | float) -> None:
    with pytest.raises(ValueError, match=r"^temperature = -20 K must lie in \(0, inf\); 20 degC are 293\.15 K$"):
        sw.simulate(DRIVE, command(0.1), temperature=temperature)


def test_a_temperature_that_dips_below_absolute_zero_between_steps_is_refused() -> None:
    dipping = sw.scenario.sine(300.0, 40.0, 0.1, phase=0.3) + sw.scenario.constant(299.0, 0.1)
    for simulate in (sw.simulate, sw.simulate_adaptively):
        with pytest.raises(ValueError, match=r"^temperature = -[\d.]+ K must lie in \(0, inf\)"):
            simulate(DRIVE, command(0.1), temperature=dipping)


def test_a_controller_that_acts_too_often_is_refused_before_memory_is_taken() -> None:
    words = r"^a controller with period = 1e-09 s acts 1e\+08 times in 0\.1 s; at most 1e\+07 times are allowed; take a longer"
    held, idle = sw.scenario.constant(0.1, 0.1), DRIVE.replace(control=sw.control.OpenLoop())
    with pytest.raises(ValueError, match=words):
        sw.simulate_controlled(idle, lambda seen: 0.0, held, period=1e-9)
    sampled = DRIVE.replace(control=sw.control.Sampled(law=sw.control.PID(proportional=1.0), period=1e-9))
    with pytest.raises(ValueError, match=words):
        sw.simulate(sampled, held)


def test_steps_and_samples_that_take_more_than_a_run_may_are_refused() -> None:
    held = sw.scenario.constant(0.1, 1.0)
    with pytest.raises(MemoryError, match=r"^9e\+07 samples take 1[0-9.]+ GB; at most 8 GB are allowed; sample less often"):
        sw.simulate(DRIVE, held, sample=1.0 / 9e7)
    with pytest.raises(MemoryError, match=r"^9e\+07 steps take [0-9.]+ GB; at most 8 GB are allowed; take longer steps"):
        sw.simulate_many(DRIVE, held, {"gear.damping": [1.0]}, dt=1.0 / 9e7, sample=0.1)


def test_more_steps_than_can_be_are_refused() -> None:
    for most, voltage, remedy in (
        (10_000_000, sw.scenario.sine(1.0, 0.0, 6e6), "sample less often"),
        (10**12, sw.scenario.sine(1.0, 3e8, 1.0), "take longer steps or slower inputs"),
    ):
        with pytest.raises(ValueError, match=rf" s are more than 1e\+08 steps of .* s; {remedy}"):
            sw.simulate_adaptively(DRIVE, voltage, max_steps=most)


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is limited as Linux does it")
@pytest.mark.parametrize(
    ("run", "size"),
    [
        (lambda long: sw.simulate(DRIVE, long), 0.66),
        (lambda long: sw.analysis.derivatives(DRIVE, long, ["gear.damping"]), 3.54),
        (lambda long: sw.simulate_many(DRIVE, long, {"gear.damping": [1.0]}), 3.54),
    ],
)
def test_a_run_too_long_for_the_memory_says_how_large_it_is_and_what_to_do(
    run: Callable[[sw.scenario.Scenario], Any], size: float
) -> None:
    said = f"2e+07 steps take {size} GB, more memory than there is; {LONG_RUN}"
    with little_memory(64 << 20), pytest.raises(MemoryError, match=f"^{re.escape(said)}$"):
        run(sw.scenario.constant(0.1, 4e3))


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is limited as Linux does it")
def test_outputs_too_many_for_the_memory_say_how_large_they_are() -> None:
    held = Excitation(sw.scenario.constant(0.1, 1.0))
    words = r"^5e\+07 samples take 6\.4 GB, .*; sample less often, or record fewer outputs$"
    with little_memory(64 << 20), pytest.raises(MemoryError, match=words):
        simulation.beginning(DRIVE, DRIVE.rest().numbers, held, EVERY, 5 * 10**7)


@pytest.mark.skipif(sys.platform != "linux", reason="the memory of a process is limited as Linux does it")
@pytest.mark.parametrize(
    "run",
    [
        lambda held: sw.simulate(DRIVE, held, sample=2e-8),
        lambda held: sw.simulate_adaptively(DRIVE, held, sample=2e-8),
        lambda held: sw.simulate_controlled(
            DRIVE.replace(control=sw.control.OpenLoop()), lambda seen: 0.0, held, period=0.1, sample=2e-8
        ),
    ],
    ids=["simulate", "adaptively", "controlled"],
)
def test_samples_too_many_for_the_memory_are_refused_before_a_grid_is_laid_out(
    run: Callable[[sw.scenario.Scenario], Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_core, "grid", None)
    words = r"^5e\+07 samples take [0-9.]+ GB, .*; sample less often, or record fewer outputs$"
    with little_memory(64 << 20), pytest.raises(MemoryError, match=words):
        run(sw.scenario.constant(0.1, 1.0))
    words = r"^100 s are more than 1e\+08 steps of 2e-08 s; sample less often, or record fewer outputs$"
    with pytest.raises(ValueError, match=words):
        run(sw.scenario.constant(0.1, 100.0))


def test_a_run_that_leaves_all_bounds_is_no_result_though_its_numbers_are_finite() -> None:
    """An output pushed by 1.9e17 rad/s2."""
    acceleration, inertia = 1.9e17, 1e-3
    free = sw.Drive(
        gear=sw.Gear(stiffness=sw.stiffness.Linear(k=1e-30), damping=0.0),
        motor=sw.motor.DC(torque_constant=0.0, back_emf=0.0, inertia=1e-4),
        load=sw.loads.Inertia(inertia=inertia),
    )

    def after(steps: int) -> sw.Recording:
        still = sw.scenario.constant(0.0, 5e-4 * steps)
        return sw.simulate(free, still, dt=5e-4, load_torque=-acceleration * inertia)

    largest = math.floor(1e15 / acceleration / 5e-4)
    assert after(largest)["output_speed"][-1] == pytest.approx(acceleration * 5e-4 * largest, rel=1e-9)
    with pytest.raises(
        FloatingPointError, match=rf"^the simulation diverged at t = {5e-4 * (largest + 1):.6g} s \(output_speed"
    ):
        after(largest + 1)


def test_a_step_too_coarse_at_rest_is_refused_before_any_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """The gear of 1.5e4 N.m/rad between 0.5 kg.m2, held by an arm with 15 N.m/rad at most, and 1e-4 kg.m2 times 100 squared."""
    monkeypatch.setattr(_core, "simulate", None)
    vibration = math.sqrt(np.linalg.eigvals([[1.5e4, -1.5e4], [-1.5e4 / 0.5, (1.5e4 + 15.0) / 0.5]]).max())
    motion = f"its own motion is as fast as a vibration of {vibration:.4g} rad/s at a twist of 0 rad"
    words = rf"{motion}; take dt = {rounded_down(1.0 / vibration):g} s or less$"
    with pytest.raises(FloatingPointError, match=words):
        sw.simulate(DRIVE, command(0.1), dt=1.01 / vibration, method="exponential")


@pytest.mark.parametrize(
    ("part", "words"),
    [
        ({"sensors": sw.Sensors(output_angle=sw.sensor.SecondOrder(natural_frequency=1e5))}, "a sensor is"),
        ({"control": sw.control.LeadLag(gain=1.0, lead_denominator=1e-6)}, "what its controller filters is"),
        ({}, "its own motion is"),
    ],
    ids=["sensor", "controller", "gear"],
)
def test_what_a_step_cannot_follow_is_named(part: dict[str, Any], words: str) -> None:
    with pytest.raises(FloatingPointError, match=f"^dt = 0.005 s is too coarse for this drive: {words} as fast as"):
        sw.simulate(DRIVE.replace(**part), command(0.1), dt=5e-3, method="exponential")
    with pytest.warns(sw.simulation.EnsembleWarning):
        runs = sw.simulate_many(DRIVE.replace(**part), command(0.1), {"load.inertia": [0.5, 0.6]}, 5e-3)
    for said in runs.failures.values():
        assert re.match(f"dt = 0.005 s is too coarse for this drive: {words} as fast as", said)
    assert len(runs.failures) == 2


OPEN = sw.Drive(
    gear=sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), stiffness=sw.stiffness.Linear(k=1e4)),
    motor=sw.motor.DC(resistance=0.5, torque_constant=0.05, back_emf=0.04, inertia=1e-4),
    load=sw.loads.Inertia(inertia=0.02),
)
EMF = 0.05 * 0.04 / 0.5 / 1e-4  # 1/s


@pytest.mark.parametrize(
    ("parts", "motor", "rate"),
    [
        ({}, {}, EMF),
        ({}, {"inductance": 1e-3}, 0.0),
        ({"damping": 250.0}, {"back_emf": 0.0}, 250.0 * (1.0 / 0.02 + 1.0 / (1e-4 * 100.0**2))),
        ({"friction_input": sw.friction.Coulomb(coulomb=0.01, breakaway=0.02, viscous=2.0)}, {}, EMF + 2.0 / 1e-4),
        ({"friction_output": sw.friction.Viscous(viscous=300.0)}, {}, 300.0 / 0.02),
        ({"friction_input": made(sw.friction.LuGre, bristle_damping=1.0, viscous=0.5)}, {"back_emf": 0.0}, 1.5 / 1e-4),
    ],
    ids=["back-EMF", "with inductance", "gear", "input", "output", "bristles"],
)
def test_how_fast_speeds_decay_is_known_of_every_part(parts: Any, motor: Any, rate: float) -> None:
    """What damps over what it damps; 2.5 of it weigh as much as one of the gear's vibration, which is soft here."""
    gear = OPEN.gear.replace(stiffness=sw.stiffness.Linear(k=1e-3), **parts)
    drive = OPEN.replace(gear=gear, motor=OPEN.motor.replace(**motor))
    assert _core.max_rate(drive, 0.0) == pytest.approx(max(rate / 2.5, math.sqrt(1e-3 * 51.0)), rel=1e-5)


@pytest.mark.parametrize(
    "parts",
    [
        {"damping": 400.0, "friction_output": sw.friction.Coulomb(coulomb=0.733, breakaway=1.1)},
        {"friction_input": sw.friction.Coulomb(coulomb=0.0067, breakaway=0.01, viscous=2.0)},
    ],
    ids=["gear", "input"],
)
def test_a_step_too_long_for_what_damps_is_refused_where_sticking_would_hide_it(parts: Any) -> None:
    """Unstable steps end in rest there, over and over: bounded, and wrong by any factor. What is not refused is right."""
    drive = OPEN.replace(
        gear=OPEN.gear.replace(**({"friction_input": sw.friction.Coulomb(coulomb=0.0067, breakaway=0.01)} | parts))
    )
    volts = sw.scenario.sine(6.0, 5.0, 0.1)
    longest = 1.0 / _core.max_rate(drive, 0.0)
    exact = sw.simulate_adaptively(drive, volts, rtol=1e-9)
    run = sw.simulate(drive, volts, 0.99 * longest, sample=1e-3)
    for name in ("input_speed", "torque", "output_angle"):
        assert np.abs(run[name] - exact[name]).max() < 1e-2 * np.abs(exact[name]).max()
    words = r"too coarse for this drive: its own motion is as fast as .* at a twist of 0 rad; take dt = .* s or less"
    with pytest.raises(FloatingPointError, match=words):
        sw.simulate(drive, volts, 1.01 * longest)
    light = {"load.inertia": [0.02] * 7 + [1e-3] * 2, "motor.inertia": [1e-4] * 7 + [1e-5] * 2}
    with pytest.warns(sw.simulation.EnsembleWarning, match="2 of 9 members have no result"):
        runs = sw.simulate_many(drive, volts, light, 0.5 * longest)
    assert all(re.search(words, reason) for reason in runs.failures.values())


DIVERGED = (
    r"the simulation diverged at t = [\d.]+ s \(.*\); take a smaller dt \(now 0\.05 s\)"
    r"|dt = 0\.05 s is too coarse for this drive: its own motion is as fast as a vibration of .* rad/s"
)


def diverging(drive: sw.Drive) -> Iterator[Callable[[], object]]:
    """The same too coarse run, each way there is."""
    yield lambda: sw.simulate(drive, command(5.0), dt=0.05, method="exponential")
    yield lambda: differentiate(drive, Excitation(command(5.0)), [0], 0.05, 0.05)


@drives
def test_a_run_that_diverges_says_when_and_returns_nothing(drive: sw.Drive) -> None:
    for run in diverging(drive):
        with pytest.raises(FloatingPointError, match=DIVERGED):
            run()


def test_a_run_that_has_diverged_goes_no_further() -> None:
    """What it records from there on is where it stopped, its command too."""
    drive = DRIVE.replace(control=DRIVE.control.replace(limit=1e300, integral=1e6))
    excitation = Excitation(sw.scenario.sine(0.02, 3.0, 1.0))
    course = excitation.time_grid(5e-4, None)
    outputs = np.empty((len(COLUMNS), len(course.times)))
    course_of = (course.instants, excitation.over(course.instants), course.samples[1:])
    _core.simulate(drive, drive.rest().numbers, *course_of, _core.Method.exponential, EVERY, outputs, 1)
    sound = (np.abs(outputs[:, 1:]) <= simulation.LARGEST_OUTPUT).all(axis=0)
    lost = int(np.argmin(sound))
    assert not sound[lost:].any()
    assert len(set(outputs[COLUMNS.index("command"), lost + 65 :])) == 1
    assert len(sound) > lost + 1000


@pytest.mark.parametrize("quantity", [-1, len(_core.quantities), 10**6])
def test_the_core_refuses_a_quantity_that_does_not_exist(quantity: int) -> None:
    with pytest.raises(ValueError, match="there is no quantity of this index"):
        _core.started(DRIVE, [quantity], np.ones(1), np.zeros(6))
