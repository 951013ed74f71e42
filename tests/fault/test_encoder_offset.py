"""An offset of an encoder: the shaft settles off the command by it."""

from __future__ import annotations

import pytest
import strainwave as sw


def test_the_shaft_of_the_encoder_settles_off_the_command_by_the_offset() -> None:
    drive = sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.PlainRatio(reduction=100.0),
            stiffness=sw.stiffness.Linear(k=1e4),
            damping=20.0,
            friction_input=sw.friction.Viscous(viscous=1e-3),
        ),
        motor=sw.motor.TorqueSource(inertia=1e-4),
        control=sw.control.PID(proportional=5.0, derivative=0.05, feedback="input"),
        load=sw.loads.Inertia(inertia=0.1),
    )
    wrong = sw.dataset.with_faults(drive, [sw.fault.EncoderOffset(shaft="input", offset=2e-3, severity=0.5)])
    run = sw.simulate(wrong, sw.scenario.constant(0.1, 3.0))
    assert run["output_angle"][-1] == pytest.approx(0.1 - 1e-3 / 100.0, abs=1e-9)


def test_an_encoder_keeps_its_counts_and_adds_the_offset() -> None:
    wrong = sw.dataset.with_faults(
        sw.load("robot-joint"), [sw.fault.EncoderOffset(shaft="input", offset=1e-3)]
    ).sensors.input_angle
    assert (wrong.counts, wrong.offset) == (131072.0, 1e-3)
