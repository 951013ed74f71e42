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
from tests.support.strategies import models, usual

LATE = sw.sensor.Delayed(law=sw.sensor.Encoder(counts=4096, eccentricity=1e-3), delay=2e-3)
# Numbers that suit the drive of these tests; another sensor has those that it has by default. Nested ones besides.
SENSORS: dict[str, Any] = {
    "gain": sw.sensor.Gain(gain=1.02, offset=0.01),
    "first_order": sw.sensor.FirstOrder(time_constant=2e-3),
    "second_order": sw.sensor.SecondOrder(natural_frequency=900.0),
    "encoder": sw.sensor.Encoder(counts=4096, offset=0.1, eccentricity=1e-3, eccentricity_phase=0.3),
    "sine_cosine_encoder": sw.sensor.SineCosineEncoder(periods=32, sine_offset=0.02, amplitude_ratio=1.05),
    "delayed": sw.sensor.Delayed(delay=2e-3),
    "noisy": sw.sensor.Noisy(amplitude=0.01, bandwidth=300.0, seed=5),
    "quantised": sw.sensor.Quantised(resolution=1e-3),
}
LISTED = {name: SENSORS.get(name) or law(**usual(law)) for name, law in _core.families["sensor"].items()}
NESTED = {
    "late encoder": LATE,
    "noisy late encoder": sw.sensor.Noisy(law=LATE, amplitude=0.01, bandwidth=300.0, seed=6),
    "noisy lag": sw.sensor.Noisy(law=SENSORS["first_order"], amplitude=0.01, bandwidth=300.0, seed=7),
    "noisy late oscillator": sw.sensor.Noisy(
        law=sw.sensor.Delayed(law=SENSORS["second_order"], delay=2e-3), amplitude=0.01, bandwidth=300.0, seed=8
    ),
    "all of it": sw.sensor.Quantised(
        law=sw.sensor.Noisy(
            law=sw.sensor.Delayed(law=SENSORS["first_order"], delay=2e-3), amplitude=0.01, bandwidth=300.0, seed=9
        ),
        resolution=1e-3,
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
    """The innermost."""
    return inner(sensor.law) if hasattr(sensor, "law") else sensor


def step_of(sensor: Any) -> float:
    """From one reading to the next [rad]; 0 if it does not read in steps."""
    if isinstance(sensor, sw.sensor.Quantised):
        return max(sensor.resolution, step_of(sensor.law))
    law = inner(sensor)
    if isinstance(law, sw.sensor.SineCosineEncoder):  # of tracks that are a twelfth of an amplitude long at the least
        return 12.0 * law.converter_step / law.periods
    return tau / law.counts if isinstance(law, sw.sensor.Encoder) else 0.0


@given(models("sensor"))
def test_it_begins_settled_and_stays_where_all_stands_still(sensor: Any) -> None:
    """Whatever its numbers: a lag, an oscillator and a delay show what there is, and what they stand around shows."""
    assume(steps_follow(sensor))
    angle, law = 0.3, inner(sensor)
    run = run_of(sensor, sw.scenario.constant(angle, 2e-3), 1e-4)
    noise = np.sqrt(2.0 * 32.0) * getattr(unquantised(sensor), "amplitude", 0.0)  # all waves at their crests
    wanted = angle
    if isinstance(law, sw.sensor.Gain):
        wanted = law.gain * angle + law.offset
    elif isinstance(law, sw.sensor.Encoder):
        wanted = angle + law.offset + law.eccentricity * np.sin(angle + law.eccentricity_phase)
    elif isinstance(law, sw.sensor.SineCosineEncoder):
        phase = law.periods * angle
        tracks = np.cos(phase) + law.cosine_offset, law.amplitude_ratio * np.sin(phase + law.quadrature_error) + law.sine_offset
        wanted = angle + np.angle(complex(*tracks) * np.exp(-1j * phase)) / law.periods
    assert np.abs(run["motor_torque"] - wanted).max() <= step_of(sensor) + noise + 1e-9 * (abs(wanted) + 1.0)


def unquantised(sensor: Any) -> Any:
    return sensor.law if isinstance(sensor, sw.sensor.Quantised) else sensor


def steps_follow(sensor: Any) -> bool:
    """Whether steps of 0.1 ms do."""
    late = unquantised(sensor)
    late = late.law if isinstance(late, sw.sensor.Noisy) else late
    if isinstance(late, sw.sensor.Delayed) and late.delay < 1e-3:
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


@pytest.mark.parametrize("sensor", [law for law in (LISTED | NESTED).values() if not step_of(law)], ids=lambda law: law.name)
@both_ways
def test_adaptive_steps_lead_to_the_same(sensor: Any, sampled: bool) -> None:
    one = seen_by(sensor, sampled)
    fine = sw.simulate(one, COMMAND, 2e-5, sample=1e-3)
    adaptive = sw.simulate_adaptively(one, COMMAND, 1e-8, sample=1e-3)
    for column in ("input_angle", "input_speed", "output_angle", "output_speed"):
        assert adaptive[column] == pytest.approx(fine[column], abs=2e-7 * np.abs(fine[column]).max())


@pytest.mark.slow("physics")
@pytest.mark.parametrize("sensor", [law for law in (LISTED | NESTED).values() if step_of(law)], ids=lambda law: law.name)
def test_adaptive_steps_lead_to_the_same_within_a_hundredth_of_a_reading(sensor: Any) -> None:
    """Sampled, what reads in steps does not care for those of time. Within a delay each begins where a step of time ends."""
    one = seen_by(sensor, sampled=True)
    fine = sw.simulate(one, COMMAND, 2e-5, sample=1e-3)
    adaptive = sw.simulate_adaptively(one, COMMAND, 1e-6, sample=1e-3)
    share = 1e-2 if isinstance(inner(sensor), sw.sensor.Encoder) and hasattr(sensor, "law") else 1e-4
    assert adaptive["input_angle"] == pytest.approx(fine["input_angle"], abs=share * step_of(sensor))


@every_sensor
@both_ways
def test_derivatives_go_through_it(sensor: Any, sampled: bool) -> None:
    """The run of the values is the run alone to the bit; by a gain they are those of differences.

    Of what reads in steps they take the line through the steps: so does one of very many.
    """
    one = seen_by(sensor, sampled)
    path = "control.law.proportional" if sampled else "control.proportional"
    found = sw.analysis.derivatives(one, COMMAND, [path], 1e-4, sample=1e-2)
    assert np.array_equal(found.run["output_angle"], sw.simulate(one, COMMAND, 1e-4, sample=1e-2)["output_angle"])
    finer = one.replace({"sensors.input_angle": finely(sensor)})
    near = [sw.simulate(finer.replace({path: 0.5 + by}), COMMAND, 1e-4, sample=1e-2)["output_angle"] for by in (-5e-4, 5e-4)]
    slope = found["output_angle", path]
    tolerance = 2e-2 if step_of(sensor) else 1e-5
    assert slope == pytest.approx((near[1] - near[0]) / 1e-3, abs=tolerance * np.abs(slope).max())


def finely(sensor: Any) -> Any:
    """The same with so many steps that none is seen."""
    if isinstance(sensor, sw.sensor.Quantised):
        return sensor.replace(resolution=1e-14)
    if isinstance(sensor, sw.sensor.Encoder):
        return sensor.replace(counts=1e14)
    return sensor.replace(law=finely(sensor.law)) if hasattr(sensor, "law") else sensor


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
    found = sw.analysis.derivatives(one, COMMAND, paths, 1e-4, sample=1e-2)
    for path in paths:
        step = 1e-4 * values[path]
        near = [
            sw.simulate(one.replace({path: values[path] + by}), COMMAND, 1e-4, sample=1e-2)["output_angle"]
            for by in (-step, step)
        ]
        slope = found["output_angle", path]
        assert np.abs(slope).max() > 0.0
        assert slope == pytest.approx((near[1] - near[0]) / (2.0 * step), abs=2e-5 * np.abs(slope).max())


def read(law: Any, amplitude: float, resolution: float, seed: int) -> sw.sensor.Quantised:
    """A sensor with a delay of 1 ms, noise and a converter."""
    noisy = sw.sensor.Noisy(law=sw.sensor.Delayed(law=law, delay=1e-3), amplitude=amplitude, seed=seed)
    return sw.sensor.Quantised(law=noisy, resolution=resolution)


def test_the_sensors_of_document_a_can_be_put_together() -> None:
    """Current of order zero, speed of first and position of second order, each with noise, delay and steps of reading."""
    sensors = sw.Sensors(
        current=read(sw.sensor.Gain(gain=1.01), 0.02, 0.01, seed=1),
        input_speed=read(sw.sensor.FirstOrder(time_constant=1e-3), 0.05, 0.02, seed=2),
        output_angle=read(sw.sensor.SecondOrder(natural_frequency=1500.0), 1e-5, 2e-5, seed=3),
        input_angle=sw.sensor.Noisy(law=LATE, amplitude=1e-4, seed=4),
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
