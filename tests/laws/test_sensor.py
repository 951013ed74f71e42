"""What every sensor obeys: it begins settled, recordings show what there is, and it is one in every kind of run."""

from __future__ import annotations

from math import tau
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import assume, given
from strainwave import _core

from tests.control.discrete import DC, drive
from tests.sensor.probe import run_of
from tests.strategies import models, usual

LATE = sw.sensor.Delayed(law=sw.sensor.Encoder(counts=4096, eccentricity=1e-3), delay=2e-3)
# Numbers that suit the drive of these tests; another sensor has those that it has by default. Nested ones besides.
SENSORS: dict[str, Any] = {
    "gain": sw.sensor.Gain(gain=1.02, offset=0.01),
    "first_order": sw.sensor.FirstOrder(time_constant=2e-3),
    "second_order": sw.sensor.SecondOrder(natural_frequency=900.0),
    "encoder": sw.sensor.Encoder(counts=4096, offset=0.1, eccentricity=1e-3, eccentricity_phase=0.3),
    "delayed": sw.sensor.Delayed(delay=2e-3),
    "noisy": sw.sensor.Noisy(amplitude=0.01, bandwidth=300.0, seed=5),
}
LISTED = {name: SENSORS.get(name) or law(**usual(law)) for name, law in _core.families["sensor"].items()}
NESTED = {
    "late encoder": LATE,
    "noisy late encoder": sw.sensor.Noisy(law=LATE, amplitude=0.01, bandwidth=300.0, seed=6),
    "noisy lag": sw.sensor.Noisy(law=SENSORS["first_order"], amplitude=0.01, bandwidth=300.0, seed=7),
    "noisy late oscillator": sw.sensor.Noisy(
        law=sw.sensor.Delayed(law=SENSORS["second_order"], delay=2e-3), amplitude=0.01, bandwidth=300.0, seed=8
    ),
}
COMMAND = sw.scenario.sine(0.1, 4.0, 0.1) + sw.scenario.ramp(3.0, 0.1)
LAW = sw.control.PID(proportional=0.5, integral=3.0, derivative=0.01)


def seen_by(sensor: Any, sampled: bool) -> sw.Drive:
    """A drive under position control that looks at its motor through this sensor."""
    control = sw.control.Sampled(law=LAW, period=1e-3, delay=3e-4) if sampled else LAW
    return drive(control, DC, sensors=sw.Sensors(input_angle=sensor))


every_sensor = pytest.mark.parametrize("sensor", [pytest.param(law, id=name) for name, law in (LISTED | NESTED).items()])
both_ways = pytest.mark.parametrize("sampled", [False, True], ids=["continuous", "sampled"])


def inner(sensor: Any) -> Any:
    """What is left of it where all stands still: no noise, no delay."""
    return inner(sensor.law) if isinstance(sensor, sw.sensor.Noisy | sw.sensor.Delayed) else sensor


@given(models("sensor"))
def test_it_begins_settled_and_stays_where_all_stands_still(sensor: Any) -> None:
    """Whatever its numbers: a lag, an oscillator and a delay show what there is, and what they stand around shows."""
    assume(steps_follow(sensor))
    angle, law = 0.3, inner(sensor)
    run = run_of(sensor, sw.scenario.constant(angle, 2e-3), 1e-4)
    noise = np.sqrt(2.0 * 32.0) * getattr(sensor, "amplitude", 0.0)  # all waves at their crests
    wanted, count = angle, 0.0
    if isinstance(law, sw.sensor.Gain):
        wanted = law.gain * angle + law.offset
    elif isinstance(law, sw.sensor.Encoder):
        wanted, count = angle + law.offset + law.eccentricity * np.sin(angle + law.eccentricity_phase), tau / law.counts
    assert np.abs(run["motor_torque"] - wanted).max() <= 0.5 * count + noise + 1e-9 * (abs(wanted) + 1.0)


def steps_follow(sensor: Any) -> bool:
    """Whether steps of 0.1 ms do."""
    sensor = sensor.law if isinstance(sensor, sw.sensor.Noisy) else sensor
    if isinstance(sensor, sw.sensor.Delayed) and sensor.delay < 1e-3:
        return False
    return not (isinstance(inner(sensor), sw.sensor.SecondOrder) and inner(sensor).natural_frequency > 5e3)


@every_sensor
def test_a_recording_shows_what_there_is(sensor: Any) -> None:
    motion = sw.scenario.sine(0.3, 4.0, 0.1)
    run = run_of(sensor, motion, 1e-4)
    assert run["output_angle"] == pytest.approx(motion.value(run.time), abs=1e-12)


@every_sensor
@both_ways
def test_members_of_an_ensemble_are_runs_alone_to_the_bit(sensor: Any, sampled: bool) -> None:
    """Noise, too: the same seed is the same noise in every lane."""
    one = seen_by(sensor, sampled)
    inertias = np.linspace(0.04, 0.06, 11)
    many = sw.simulate_many(one, COMMAND, {"load.inertia": inertias}, 1e-4, sample=1e-3, record=["output_angle", "torque"])
    for k in (0, 7, 10):
        alone = sw.simulate(one.replace({"load.inertia": float(inertias[k])}), COMMAND, 1e-4, sample=1e-3)
        assert np.array_equal(many["output_angle"][k], alone["output_angle"])
        assert np.array_equal(many["torque"][k], alone["torque"])


def test_members_may_have_noises_of_their_own() -> None:
    one = seen_by(SENSORS["noisy"], sampled=True)
    seeds = np.arange(9.0)
    many = sw.simulate_many(one, COMMAND, {"sensors.input_angle.seed": seeds}, 1e-4, sample=1e-3)
    for seed, row in zip(seeds, many["output_angle"], strict=True):
        alone = sw.simulate(one.replace({"sensors.input_angle.seed": float(seed)}), COMMAND, 1e-4, sample=1e-3)
        assert np.array_equal(row, alone["output_angle"])
    assert len({row.tobytes() for row in many["output_angle"]}) == 9


def counts(sensor: Any) -> bool:
    return isinstance(inner(sensor), sw.sensor.Encoder)


@pytest.mark.parametrize("sensor", [law for law in (LISTED | NESTED).values() if not counts(law)], ids=lambda law: law.name)
@both_ways
def test_adaptive_steps_lead_to_the_same(sensor: Any, sampled: bool) -> None:
    one = seen_by(sensor, sampled)
    fine = sw.simulate(one, COMMAND, 2e-5, sample=1e-3)
    adaptive = sw.simulate_adaptively(one, COMMAND, 1e-8, sample=1e-3)
    for column in ("input_angle", "input_speed", "output_angle", "output_speed"):
        assert adaptive[column] == pytest.approx(fine[column], abs=2e-7 * np.abs(fine[column]).max())


@pytest.mark.parametrize("sensor", [law for law in (LISTED | NESTED).values() if counts(law)], ids=lambda law: law.name)
def test_adaptive_steps_lead_to_the_same_within_a_hundredth_of_a_count(sensor: Any) -> None:
    """Sampled, an encoder does not care for steps. Within a delay each count begins where a step happens to end."""
    one = seen_by(sensor, sampled=True)
    fine = sw.simulate(one, COMMAND, 2e-5, sample=1e-3)
    adaptive = sw.simulate_adaptively(one, COMMAND, 1e-6, sample=1e-3)
    share = 1e-2 if hasattr(sensor, "law") else 1e-4
    assert adaptive["input_angle"] == pytest.approx(fine["input_angle"], abs=share * tau / 4096)


@every_sensor
@both_ways
def test_derivatives_go_through_it(sensor: Any, sampled: bool) -> None:
    """The run of the values is the run alone to the bit; by a gain they are those of differences.

    Of what counts they take the line through the counts: so does an encoder of very many.
    """
    one = seen_by(sensor, sampled)
    path = "control.law.proportional" if sampled else "control.proportional"
    found = sw.derivatives(one, COMMAND, [path], 1e-4, sample=1e-2)
    assert np.array_equal(found.run["output_angle"], sw.simulate(one, COMMAND, 1e-4, sample=1e-2)["output_angle"])
    finer = one
    if counts(sensor):
        place = "sensors.input_angle" + (".law" * nesting(sensor)) + ".counts"
        finer = one.replace({place: 1e14})
    near = [sw.simulate(finer.replace({path: 0.5 + by}), COMMAND, 1e-4, sample=1e-2)["output_angle"] for by in (-5e-4, 5e-4)]
    slope = found["output_angle", path]
    tolerance = 1e-5 if finer is one else 2e-2
    assert slope == pytest.approx((near[1] - near[0]) / 1e-3, abs=tolerance * np.abs(slope).max())


def nesting(sensor: Any) -> int:
    return 1 + nesting(sensor.law) if hasattr(sensor, "law") else 0


@pytest.mark.parametrize(
    ("sensor", "fields"),
    [
        (SENSORS["gain"], ["gain", "offset"]),
        (SENSORS["first_order"], ["time_constant"]),
        (SENSORS["second_order"], ["natural_frequency", "damping_ratio"]),
        (SENSORS["encoder"].replace(counts=1e14), ["offset", "eccentricity", "eccentricity_phase"]),
        (SENSORS["delayed"], ["delay"]),
        (SENSORS["noisy"], ["amplitude", "bandwidth"]),
        (NESTED["noisy late oscillator"], ["amplitude", "law.delay", "law.law.natural_frequency"]),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
@both_ways
def test_derivatives_by_its_own_numbers_are_those_of_differences(sensor: Any, fields: list[str], sampled: bool) -> None:
    one = seen_by(sensor, sampled)
    paths = [f"sensors.input_angle.{field}" for field in fields]
    values = {path: number for path, number, *_ in _core.parameters(one)}
    found = sw.derivatives(one, COMMAND, paths, 1e-4, sample=1e-2)
    for path in paths:
        step = 1e-4 * values[path]
        near = [
            sw.simulate(one.replace({path: values[path] + by}), COMMAND, 1e-4, sample=1e-2)["output_angle"]
            for by in (-step, step)
        ]
        slope = found["output_angle", path]
        assert np.abs(slope).max() > 0.0
        assert slope == pytest.approx((near[1] - near[0]) / (2.0 * step), abs=2e-5 * np.abs(slope).max())


def test_the_sensors_of_document_a_can_be_put_together() -> None:
    """Current of order zero, speed of first and position of second order, each with noise and delay; an encoder, too."""
    sensors = sw.Sensors(
        current=sw.sensor.Noisy(law=sw.sensor.Delayed(law=sw.sensor.Gain(gain=1.01), delay=1e-3), amplitude=0.02, seed=1),
        input_speed=sw.sensor.Noisy(
            law=sw.sensor.Delayed(law=sw.sensor.FirstOrder(time_constant=1e-3), delay=1e-3), amplitude=0.05, seed=2
        ),
        output_angle=sw.sensor.Noisy(
            law=sw.sensor.Delayed(law=sw.sensor.SecondOrder(natural_frequency=1500.0), delay=1e-3), amplitude=1e-5, seed=3
        ),
        input_angle=sw.sensor.Noisy(
            law=sw.sensor.Delayed(law=sw.sensor.Encoder(counts=8192), delay=1e-3), amplitude=1e-4, seed=4
        ),
    )
    law = sw.control.Cascade(
        position_gain=15.0,
        speed_proportional=0.05,
        speed_integral=0.3,
        current_proportional=0.2,
        current_integral=100.0,
        back_emf_feedforward=0.12,
        feedback="output",
    )
    one = drive(sw.control.Sampled(law=law, period=1e-3), DC, sensors=sensors)
    run = sw.simulate(one, sw.scenario.constant(0.5, 2.0), 1e-4, sample=1e-3)
    late = run.between(1.5, 2.0)
    assert late["output_angle"] == pytest.approx(0.5, abs=2e-3)
    assert late["voltage"].std() > 1e-3  # what noise makes of it
