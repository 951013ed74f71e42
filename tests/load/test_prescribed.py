"""An output shaft that is held, or moved from outside."""

from __future__ import annotations

import re

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st

from tests.support.geared import MOTOR, RATIO, K, geared

LOCKED = geared(load=sw.loads.Prescribed(), motor=sw.motor.TorqueSource(inertia=2e-4), damping=0.0)


@pytest.mark.slow("physics")
@given(torque=st.floats(-0.5, 0.5), angle=st.floats(-3.0, 3.0))
def test_a_locked_gear_vibrates_about_the_twist_that_the_torque_gives(torque: float, angle: float) -> None:
    """A mass on a spring: twist = (i tau / k) (1 - cos w t), w^2 = k / (i^2 J)."""
    run = sw.simulate(LOCKED, sw.scenario.constant(torque, 0.05), 1e-5, inputs={"output_angle": angle})
    w = np.sqrt(K / (RATIO**2 * 2e-4))
    twist = RATIO * torque / K * (1.0 - np.cos(w * run.time))
    assert run["twist"] == pytest.approx(twist, abs=1e-9 * RATIO / K + 1e-14)
    assert run["output_angle"] == pytest.approx(angle, abs=1e-12)
    assert run["load_torque"] == pytest.approx(run["torque"])


def test_the_shaft_is_where_it_is_put_and_the_gear_transmits_the_twist() -> None:
    turned = sw.scenario.sine(0.05, 2.0, 1.0)
    drive = geared(load=sw.loads.Prescribed(), motor=MOTOR, friction_output=sw.friction.Viscous(viscous=0.3))
    run = sw.simulate(drive, sw.scenario.constant(0.0, 1.0), inputs={"output_angle": turned})
    assert run["output_angle"] == pytest.approx(turned.value(run.time), abs=1e-12)
    assert run["output_speed"] == pytest.approx(turned.rate(run.time), abs=1e-12)
    assert run["twist"] == pytest.approx(run["input_angle"] / RATIO - run["output_angle"], abs=1e-12)
    assert run["load_torque"] == pytest.approx(run["torque"] - 0.3 * run["output_speed"])


def test_a_shorted_motor_that_is_turned_from_outside_brakes_with_its_back_emf_and_friction() -> None:
    """At constant speed: T = -i^2 (b_in + K^2 / R) w, and what turns the shaft does the work that all places lose."""
    drive = geared(
        load=sw.loads.Prescribed(),
        motor=sw.motor.DC(resistance=2.0, torque_constant=0.05, back_emf=0.05, inertia=1e-5),
        friction_input=sw.friction.Viscous(viscous=4e-4),
        friction_output=sw.friction.Viscous(viscous=0.3),
    ).replace(meter=sw.meter.EnergyMeter())
    turned = sw.scenario.ramp(1.5, 0.5)
    run = sw.simulate(drive, sw.scenario.constant(0.0, 0.5), 2e-5, inputs={"output_angle": turned}, sample=1e-2)
    drag = RATIO**2 * (4e-4 + 0.05**2 / 2.0) * 1.5
    assert run["torque"][-1] == pytest.approx(-drag, rel=1e-9)
    assert run["load_torque"][-1] == pytest.approx(-drag - 0.45, rel=1e-9)
    assert run["current"][-1] == pytest.approx(-0.05 * RATIO * 1.5 / 2.0, rel=1e-9)
    assert run["power_load"][-1] == pytest.approx(-(drag + 0.45) * 1.5, rel=1e-9)
    lost = sum(run[f"power_{place}"][-1] for place in ("motor", "friction_input", "friction_output"))
    assert lost == pytest.approx(-run["power_load"][-1], rel=1e-9)


def test_all_ways_to_run_it_agree() -> None:
    turned = sw.scenario.sine(0.05, 2.0, 0.5)
    drive = geared(load=sw.loads.Prescribed(), friction_input=sw.friction.Coulomb(coulomb=0.02), damping=3.0)
    command = sw.scenario.sine(6.0, 3.0, 0.5)
    acting = {"inputs": {"output_angle": turned}, "sample": 1e-3}
    alone = sw.simulate(drive, command, 1e-4, method="exponential", **acting)
    many = sw.simulate_many(drive, command, {"gear.damping": [3.0, 4.0]}, 1e-4, record=["torque"], **acting)
    assert np.array_equal(many["torque"][0], alone["torque"])
    found = sw.analysis.derivatives(drive, command, ["gear.stiffness.k"], 1e-4, **acting)
    assert np.array_equal(found.run["torque"], alone["torque"])
    scale = np.abs(alone["torque"]).max()
    for method, near in (("rosenbrock", 1e-5), ("moreau_jean", 1e-2)):
        run = sw.simulate(drive, command, 1e-4, method=method, **acting)
        assert run["torque"] == pytest.approx(alone["torque"], abs=near * scale)
    adaptive = sw.simulate_adaptively(drive, command, 1e-9, **acting)
    assert adaptive["torque"] == pytest.approx(alone["torque"], abs=1e-5 * scale)


def test_a_step_moves_the_shaft() -> None:
    state = LOCKED.step(LOCKED.rest(), output_angle=0.01, output_speed=2.0, dt=1e-3)
    ended = LOCKED.gear.kinematics.ratio
    assert state.input_angle / ended - state.transmission_error == pytest.approx(0.012, abs=1e-15)
    assert state.output_speed == 2.0


@pytest.mark.parametrize(
    ("run", "message"),
    [
        (
            lambda d, c: sw.simulate(d, c, load_torque=1.0),
            'takes no load_torque, but output_angle: give inputs={"output_angle"',
        ),
        (lambda d, c: sw.simulate(d, c, inputs={"load_torque": 1.0}), "must be one of output_angle, temperature"),
        (lambda d, c: sw.simulate(d, c, initial={"output_angle": 1.0}), "the load prescribes it"),
        (lambda d, c: sw.simulate(geared(), c, inputs={"output_angle": 1.0}), "must be one of load_torque, temperature"),
        (lambda d, c: d.step(d.rest(), load_torque=1.0, dt=1e-3), "the load of this drive takes output_angle"),
        (lambda d, c: geared().step(geared().rest(), output_angle=1.0, dt=1e-3), "only a load that prescribes"),
        (lambda d, c: sw.analysis.equilibrium(d), "an output shaft that torques move"),
        (lambda d, c: sw.linearise(d), "an output shaft that torques move"),
        (lambda d, c: sw.analysis.frequency_response(d, 1.0, 0.1), "an output shaft that torques move"),
    ],
)
def test_what_contradicts_it_is_refused_with_what_to_do(run: object, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        run(LOCKED, sw.scenario.constant(0.0, 0.1))  # type: ignore[operator]
