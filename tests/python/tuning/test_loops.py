"""Loops of a cascade in a computer: against the closed forms of a rigid joint, and against simulation."""

from __future__ import annotations

from math import tau
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.tuning.cascade import Plant, Setting, tuned_law
from strainwave.tuning.loops import MIN_MODULUS, Loops, margins_of, sampled_cascade, sharpest

PERIOD, DELAY = 1e-3, 4e-4
ROTOR, ARM, RATIO = 1e-4, 0.6, 100.0


def joint(stiffness: float, damping: float) -> sw.Drive:
    gear = sw.Gear(
        kinematics=sw.kinematics.PlainRatio(reduction=RATIO), stiffness=sw.stiffness.Linear(k=stiffness), damping=damping
    )
    return sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=ROTOR), load=sw.loads.Inertia(inertia=ARM))


def plant_of(drive: sw.Drive | sw.GearSet, delay: float = DELAY) -> Plant:
    gear_set = drive if isinstance(drive, sw.GearSet) else sw.GearSet.of(drive, name="joint", source="stated")
    return Plant.of(gear_set, PERIOD, delay)


def test_the_speed_loop_of_a_rigid_joint_is_that_of_its_inertia() -> None:
    """Held and late, w' = u / J is T / J (1 - d/T + d/T z^-1) / (z - 1), around which proportional control goes."""
    drive = joint(1e9, 3e4)
    law = sw.control.PositionSpeed(position_gain=1e-6, speed_proportional=0.05, limit=1.0, speed_feedforward=1.0)
    found = sw.tuning.loop_margins(drive.replace(control=sw.control.Sampled(law=law, period=PERIOD, delay=DELAY))).speed
    inertia, late = ROTOR + ARM / RATIO**2, DELAY / PERIOD
    at = np.linspace(1.0, np.pi / PERIOD, 200_000)
    z = np.exp(1j * at * PERIOD)
    loop = 0.05 * PERIOD / inertia * (1.0 - late + late / z) / (z - 1.0)
    assert found.modulus == pytest.approx(np.abs(1.0 + loop).min(), rel=1e-3)
    crossing = np.argmin(np.abs(np.abs(loop) - 1.0))
    assert found.crossover == pytest.approx(at[crossing], rel=0.01)
    assert found.phase == pytest.approx(np.pi + np.angle(loop[crossing]), abs=0.01)
    behind = np.argmax(loop.imag[1000:] > 0.0) + 1000
    assert found.gain == pytest.approx(-1.0 / loop.real[behind], rel=0.01)


def test_a_gain_beyond_its_margin_makes_the_simulated_joint_unstable_and_one_below_does_not() -> None:
    plant = plant_of(joint(2e4, 50.0))
    drive = plant.controlled(tuned_law(plant, Setting(0.5, "output", 0.0)), sw.Compensation())
    gain = sw.tuning.loop_margins(drive).position.gain
    control: Any = drive.control
    assert gain > 2.0
    for factor, is_stable in ((0.9, True), (1.1, False)):
        law = control.law.replace(position_gain=factor * gain * control.law.position_gain)
        changed = drive.replace(control=control.replace(law=law))
        assert (sw.tuning.loop_margins(changed).position.modulus > 0.0) == is_stable
        run = sw.simulate(changed, sw.scenario.step(1e-5, 2.0), sample=PERIOD)
        error = np.abs(run["output_angle"] - 1e-5)
        assert (error[-200:].max() < error[200:400].max()) == is_stable


@pytest.mark.parametrize("observer_share", [0.0, 0.5])
def test_the_loop_follows_a_wave_as_it_is_simulated(observer_share: float) -> None:
    """The command of an input encoder is a lead of the input; observer, delay and vibration count."""
    plant = plant_of(joint(1e4, 20.0))
    setting = Setting(0.5, "input", observer_share)
    control = sampled_cascade(plant, setting)
    for frequency in (10.0, 40.0):  # Hz
        linear = Loops.of(plant, control).following(2.0 * np.pi * frequency)[0]
        motion = sw.scenario.sine(1e-5, frequency, 1.0)
        run = sw.simulate(plant.drive.replace(control=control), motion, dt=5e-5, sample=PERIOD)
        last = run.time >= 0.6 - 1e-9  # whole periods
        wave = np.exp(-2j * np.pi * frequency * run.time[last][:-1])
        found = 2j * np.mean(run["output_angle"][last][:-1] * wave) / 1e-5
        assert found == pytest.approx(linear, rel=0.01)


def test_the_cascade_is_as_sharp_as_its_modulus_margin_allows() -> None:
    plant = plant_of(sw.GearSet.read("robot-joint"))
    for encoder in ("input", "output"):
        law = sw.cascade("robot-joint", period=PERIOD, delay=DELAY, encoder=encoder)
        assert sw.tuning.loop_margins(plant.controlled(law, sw.Compensation())).modulus >= MIN_MODULUS
        setting = sharpest(plant, encoder, 0.0)
        assert law == tuned_law(plant, setting)
        sharper = Setting(setting.sharpness * 2.0**0.5, encoder, 0.0)
        assert margins_of(plant, sharper).modulus < MIN_MODULUS


@pytest.mark.parametrize(
    ("changes", "words"),
    [({"encoder": "both"}, "encoder"), ({"period": 0.0}, "period"), ({"delay": 2.0}, "delay = 2 s exceeds the period")],
)
def test_what_the_cascade_refuses(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        sw.cascade("robot-joint", **changes)  # type: ignore[arg-type]


def test_a_joint_without_damping_has_no_cascade_at_its_output() -> None:
    with pytest.raises(ValueError, match="no cascade with output encoder has a modulus margin"):
        sw.cascade(joint(1e2, 0.0), encoder="output", period=1e-5)


def test_margins_are_those_of_a_position_in_a_computer() -> None:
    drive = joint(1e4, 1.0)
    with pytest.raises(ValueError, match=r"OpenLoop must be control\.Sampled\(law=control\.PositionSpeed.*sw\.cascade"):
        sw.tuning.loop_margins(drive)
    with pytest.raises(ValueError, match=r"Sampled\(law=PID\) must be"):
        sw.tuning.loop_margins(drive.replace(control=sw.control.Sampled(law=sw.control.PID(), period=1e-3)))


def test_marks_lie_at_a_gain_of_one_and_at_minus_half_a_turn() -> None:
    law = sw.cascade("robot-joint", period=1e-3)
    margins = sw.tuning.loop_margins(sw.load("robot-joint").replace(control=sw.control.Sampled(law=law, period=1e-3)))
    figure = margins.plot()
    magnitude, phase = figure.axes
    marks = {
        axes: {
            line.get_marker(): (float(np.asarray(line.get_xdata())[0]), float(np.asarray(line.get_ydata())[0]))
            for line in axes.lines
            if line.get_marker() in ("o", "^") and line.get_color() == axes.lines[1].get_color()
        }
        for axes in (magnitude, phase)
    }  # of the position loop
    position = margins.position
    assert marks[magnitude]["o"] == pytest.approx((position.phase_at / tau, 1.0), rel=1e-3)
    assert phase_of(marks[phase]["o"][1]) == pytest.approx(position.phase, rel=1e-3)
    assert marks[magnitude]["^"] == pytest.approx((position.gain_at / tau, 1.0 / position.gain), rel=1e-2)
    assert phase_of(marks[phase]["^"][1]) == pytest.approx(0.0, abs=0.02)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        f"speed loop: gain margin ∞, phase margin {np.degrees(margins.speed.phase):.0f}°",
        f"position loop: gain margin {position.gain:.1f}, phase margin {np.degrees(position.phase):.0f}°",
    ]


def phase_of(degrees: float) -> float:
    """Return the distance of an angle from half a turn [rad]."""
    return float(abs(np.angle(-np.exp(1j * np.radians(degrees)))))
