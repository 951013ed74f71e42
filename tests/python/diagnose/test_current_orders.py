"""Order lines: closed forms of the current signature, parts of a made signal, the bound of amplitudes, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt, tau

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.diagnose.current_orders import OrderLine, order_lines
from strainwave.diagnose.detection import threshold_of
from strainwave.diagnose.regression import motion_of, regressions

from tests.evidence.detection_limits import false_alarms, interval, noises, signature_drive

Array = NDArray[np.float64]
UNITS = {"time": "s", "input_angle": "rad", "current": "A", "load": "N.m"}
ERROR = {1.0: 8e-5, 2.0: 3e-4, 4.0: 5e-5}  # rad at the output
PHASE = {1.0: 0.0, 2.0: 0.3, 4.0: -1.1}  # rad; the products of orders depend on them
SPEED, RATIO, LOAD = 10.0, 100.0, 20.0
STIFFNESS, OUTPUT_INERTIA, ROTOR, TORQUE_CONSTANT = 8000.0, 0.05, 1.5e-4, 0.05


def recorded(time: Array, angle: Array, current: Array, load: Array | None = None) -> sw.Recording:
    columns = {"time": time, "input_angle": angle, "current": current}
    columns |= {} if load is None else {"load": load}
    return sw.Recording(columns, {name: UNITS[name] for name in columns})


def signature(
    load: float, proportional: float, integral: float, dt: float = 2e-4, orders: tuple[float, ...] = tuple(ERROR)
) -> tuple[OrderLine, ...]:
    law = sw.kinematic_error.Fourier(
        order=list(orders), amplitude=[ERROR[each] for each in orders], phase=[PHASE[each] for each in orders]
    )
    drive = signature_drive().replace(
        {"control": sw.control.PI(proportional=proportional, integral=integral, limit=50.0), "gear.kinematic_error": law}
    )
    ratio = float(drive.gear.kinematics.ratio)
    duration = 20.0 * tau / SPEED
    run = sw.simulate(
        drive,
        sw.scenario.constant(SPEED / ratio, duration),
        dt,
        load_torque=load,
        initial={"input_speed": SPEED, "output_speed": SPEED / ratio, "torque": load},
        sample=1e-3,
        record=["input_angle", "current"],
    )
    return order_lines(run.between(duration - 12.02 * tau / SPEED, duration), "current", list(orders))


def closed_loop(order: float, proportional: float, integral: float) -> float:
    """|T_c(j n omega)| of the speed loop on the rotor."""
    s = 1j * order * SPEED
    gain = (proportional + integral / s) * TORQUE_CONSTANT / (ROTOR * s)
    return float(abs(gain / (1.0 + gain)))


def test_a_loaded_drive_shows_its_error_times_the_factor_of_its_loop() -> None:
    for line, ideal in zip(signature(LOAD, 4.0, 100.0), (0.032, 0.24, 0.08), strict=True):
        assert line.amplitude == pytest.approx(ideal * closed_loop(line.order, 4.0, 100.0), rel=2e-3)
        assert line.detected


def test_a_loop_that_holds_the_speed_ideally_shows_the_reaction_alone() -> None:
    for line, ideal in zip(signature(LOAD, 40.0, 100.0, 5e-5), (0.032, 0.24, 0.08), strict=True):
        assert line.amplitude == pytest.approx(ideal, rel=2e-3)


def test_without_load_the_inertia_of_the_output_is_left() -> None:
    for line, about in zip(signature(0.0, 4.0, 100.0), (0.08e-3, 1.2e-3, 0.8e-3), strict=True):
        s = 1j * line.order * SPEED
        spring = STIFFNESS + 2.0 * s
        inert = OUTPUT_INERTIA * s**2 * spring / (OUTPUT_INERTIA * s**2 + spring) / RATIO
        ideal = abs(inert) * ERROR[line.order] / TORQUE_CONSTANT
        # Products of two orders add some per cent to the least one: order 2 of the torque times the slope of order 1.
        assert line.amplitude == pytest.approx(
            ideal * closed_loop(line.order, 4.0, 100.0), rel=0.05 if line.order == 1.0 else 5e-3
        )
        assert ideal == pytest.approx(about, rel=0.05)


def test_without_load_a_single_order_is_that_of_the_closed_form() -> None:
    for order in ERROR:
        (line,) = signature(0.0, 4.0, 100.0, orders=(order,))
        s = 1j * order * SPEED
        spring = STIFFNESS + 2.0 * s
        inert = OUTPUT_INERTIA * s**2 * spring / (OUTPUT_INERTIA * s**2 + spring) / RATIO
        ideal = abs(inert) * ERROR[order] / TORQUE_CONSTANT
        assert line.amplitude == pytest.approx(ideal * closed_loop(order, 4.0, 100.0), rel=1e-3)


def test_parts_by_direction_load_and_squared_speed_are_recovered() -> None:
    time = np.arange(0.0, 60.0, 2e-3)
    speed = 15.0 * np.sin(tau * time / 20.0)
    angle = -15.0 * 20.0 / tau * np.cos(tau * time / 20.0)
    load = 10.0 + 6.0 * np.sin(tau * time / 7.3)
    waves = {"constant": (0.02, 0.3), "friction": (0.01, -0.5), "kinematic": (2e-3, 1.1), "inertial": (5e-5, 2.0)}
    grows = {"constant": 1.0, "friction": np.sign(speed), "kinematic": load, "inertial": speed**2}
    current = 0.3 * np.sign(speed) + 0.01 * speed + 0.02 * load
    for name, (amplitude, phase) in waves.items():
        current = current + amplitude * grows[name] * np.sin(2.0 * angle + phase)
    (line,) = order_lines(recorded(time, angle, current, load), "current", [2.0], load_column="load")
    assert line.parts.keys() == waves.keys()
    for name, (amplitude, phase) in waves.items():
        assert line.parts[name][0] == pytest.approx(amplitude, rel=0.02), name
        assert np.angle(line.waves[name] * np.exp(-1j * phase)) == pytest.approx(0.0, abs=0.02), name


def test_a_steady_run_has_one_part_and_the_amplitude_of_a_sine() -> None:
    time = np.arange(0.0, 30.0, 2e-3)
    angle = 11.0 * time
    (line, none) = order_lines(recorded(time, angle, 0.5 + 0.02 * np.sin(4.0 * angle + 0.3)), "current", [4.0, 1.0])
    assert (line.amplitude, line.phase) == (pytest.approx(0.02, rel=1e-6), pytest.approx(0.3, abs=1e-6))
    assert list(line.parts) == ["constant"]
    assert none.amplitude < 1e-8


@pytest.mark.slow("diagnose")
def test_the_bound_of_an_amplitude_is_reached_and_reported() -> None:
    random = np.random.default_rng(0)
    time = np.arange(0.0, 30.0, 5e-3)
    angle = 10.0 * time
    found = [
        order_lines(recorded(time, angle, 0.1 * np.sin(2.0 * angle) + random.normal(0.0, 0.3, len(time))), "current", [2.0])[0]
        for _ in range(200)
    ]
    bound = 0.3 * sqrt(2.0 / found[0].samples)
    assert np.std([line.amplitude for line in found]) == pytest.approx(bound, rel=0.2)
    assert np.mean([line.sigma for line in found]) == pytest.approx(bound, rel=0.05)


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("colour", ["white", "pink"])
def test_healthy_units_raise_alarms_at_the_stated_rate(colour: str) -> None:
    alarms, runs = false_alarms(colour, 0.01, 8, 250)
    low, high = interval(0.01, runs)
    assert low <= alarms <= high


@pytest.mark.slow("diagnose")
@pytest.mark.parametrize("colour", ["white", "pink"])
def test_motion_to_and_fro_under_a_load_that_varies_raises_alarms_at_the_stated_rate(colour: str) -> None:
    """All four parts of each order are tested together, F with eight amplitudes; the colour is that over time."""
    time = np.arange(0.0, 60.0, 8e-3)
    angle = -48.0 * np.cos(tau * time / 20.0)
    load = 10.0 + 6.0 * np.sin(tau * time / 7.3)
    made = recorded(time, angle, np.sin(time), load)
    motion = motion_of(made, "current", 4.0, load_column="load")
    rows = noises(colour, len(motion.series), 2000, motion.step, np.random.default_rng(6))
    alarm = np.zeros(2000, dtype=bool)
    for each in regressions(replace(motion, series=rows[:, 0]), [2.0, 4.0]):
        assert len(each.names) == 4
        alarm |= each.evidence(rows) > threshold_of(0.02, 8, each.evidence_freedom, 2)
    low, high = interval(0.02, 2000)
    assert low <= alarm.sum() <= high


def test_orders_that_merge_are_one_until_half_an_output_revolution() -> None:
    for revolutions, separated in ((40.0, False), (101.0, True)):
        angle = np.linspace(0.0, tau * revolutions, 20000)
        current = 0.02 * np.sin(2.0 * angle) + 0.01 * np.sin(2.02 * angle)
        two, mesh = order_lines(recorded(angle / 10.0, angle, current), "current", [2.0, 2.02], ratio=100.0)
        assert mesh.determined == separated
        if separated:
            assert (two.amplitude, mesh.amplitude) == (pytest.approx(0.02, rel=1e-3), pytest.approx(0.01, rel=1e-3))
        else:
            assert "2 and 2.02 are not separated: this takes 50 turns" in mesh.remarks[0]
            assert any("not separated before half a revolution of the output" in each for each in two.remarks)


def test_what_a_record_does_not_determine_has_no_amplitude_and_a_reason() -> None:
    angle = np.linspace(0.0, tau * 12.4, 400)
    current = np.sin(angle)
    low, high = order_lines(recorded(angle / 10.0, angle, current), "current", [0.2, 20.0])
    assert not low.determined
    assert not high.determined
    assert "needs 3 periods, 15 revolutions; 12 recorded" in low.remarks[0]
    assert "record faster" in high.remarks[0]
    assert not low.detected


@pytest.mark.parametrize(
    ("angle", "current", "message"),
    [
        (np.zeros(500), np.sin(np.arange(500.0)), "the shaft rests"),
        (np.linspace(0.0, 5.0, 500), np.sin(np.arange(500.0)), "turns 0.796 revolutions"),
        (np.linspace(0.0, 200.0, 500), np.ones(500), "does not change"),
    ],
)
def test_records_without_orders_are_refused(angle: Array, current: Array, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        order_lines(recorded(np.arange(500.0) * 0.01, angle, current), "current", [2.0])
