"""What acts at which place of a gear, as runs show it: friction at three places, noise, temperature, and bounds."""

from __future__ import annotations

import re

import numpy as np
import pytest
import strainwave as sw
from strainwave.simulation.excitation import ROOM_TEMPERATURE, Excitation
from strainwave.simulation.run import differentiate
from strainwave.simulation.signals import outputs

from tests.support.side_by_side import side_by_side
from tests.support.strategies import made

COLUMNS = list(outputs(sw.Drive()))

MOTOR = sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4)
RATIOS = {"driving_forward": 0.1, "driving_reverse": 0.15, "backdriving_forward": 0.2, "backdriving_reverse": 0.25}


def open_loop(**parts: object) -> sw.Drive:
    """A motor at the voltage commanded, a gear of ratio 20 without kinematic error, a disc."""
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=20.0), stiffness=sw.stiffness.Linear(k=1e4), damping=5.0)
    return sw.Drive(gear=gear.replace(**parts), motor=MOTOR, load=sw.loads.Inertia(inertia=0.05))


def settled(drive: sw.Drive, voltage: float, load_torque: float) -> dict[str, float]:
    """The last sample of a run, many time constants long."""
    run = sw.simulate(drive, sw.scenario.constant(voltage, 1.0), load_torque=load_torque, sample=0.1)
    assert run["output_speed"][-2:] == pytest.approx([run["output_speed"][-1]] * 2, rel=1e-12)
    return {name: float(run[name][-1]) for name in run.names}


@pytest.mark.parametrize(
    ("quadrant", "voltage", "load_torque"),
    [
        ("driving_forward", 24.0, 3.0),
        ("driving_reverse", -24.0, -3.0),
        ("backdriving_forward", 0.0, -30.0),
        ("backdriving_reverse", 0.0, 30.0),
    ],
)
def test_the_efficiency_of_a_mesh_is_that_of_its_quadrant(quadrant: str, voltage: float, load_torque: float) -> None:
    """1 / (1 + mu) when driving, 1 - mu when back-driven, as friction.LoadDependent says of itself."""
    end = settled(open_loop(friction_mesh=sw.friction.LoadDependent(**RATIOS)), voltage, load_torque)
    at_input, at_output = MOTOR.torque_constant * end["current"] * end["input_speed"], load_torque * end["output_speed"]
    assert (end["output_speed"] > 0.0) == quadrant.endswith("forward")
    assert (at_output > 0.0) == quadrant.startswith("driving")
    ratio = RATIOS[quadrant]
    efficiency = at_output / at_input if at_output > 0.0 else at_input / at_output
    assert efficiency == pytest.approx(1.0 / (1.0 + ratio) if at_output > 0.0 else 1.0 - ratio, rel=1e-10)


@pytest.mark.parametrize("load_torque", [30.0, -30.0])
def test_a_mesh_that_loses_more_than_comes_back_locks_itself(load_torque: float) -> None:
    ratios = {"driving_forward": 0.1, "driving_reverse": 0.1}
    locking = sw.friction.LoadDependent(**ratios, backdriving_forward=1.01, backdriving_reverse=1.01)
    run = sw.simulate(open_loop(friction_mesh=locking), sw.scenario.constant(0.0, 1.0), load_torque=load_torque)
    assert not run["input_speed"].any()
    assert run["twist"][-1] == pytest.approx(load_torque / 1e4, rel=1e-9)
    yielding = locking.replace(backdriving_forward=0.99, backdriving_reverse=0.99)
    run = sw.simulate(open_loop(friction_mesh=yielding), sw.scenario.constant(0.0, 1.0), load_torque=load_torque)
    assert run["input_speed"][-1] * load_torque < 0.0


def test_what_the_motor_gives_goes_to_the_load_and_to_the_friction_of_each_place() -> None:
    laws = {
        "friction_input": made(sw.friction.LuGre, coulomb=0.03, breakaway=0.03, bristle_damping=0.01, viscous=1e-4),
        "friction_mesh": sw.friction.LoadDependent(**RATIOS),
        "friction_output": sw.friction.Stribeck(coulomb=1.0, breakaway=1.5, stribeck_speed=0.1, viscous=0.2),
    }
    end = settled(open_loop(**laws), 24.0, 3.0)
    shares = {
        "load": 3.0 * end["output_speed"],
        "friction_input": end["friction_input"] * end["input_speed"],
        "friction_mesh": end["friction_mesh"] * end["input_speed"] / 20.0,
        "friction_output": end["friction_output"] * end["output_speed"],
    }
    assert min(shares.values()) > 0.5
    assert MOTOR.torque_constant * end["current"] * end["input_speed"] == pytest.approx(sum(shares.values()), rel=1e-10)
    assert end["torque"] == pytest.approx(3.0 + end["friction_output"], rel=1e-10)
    for place, law in laws.items():
        speed = end["input_speed"] if place == "friction_input" else end["output_speed"]
        assert end[place] == pytest.approx(law.steady(speed, load=end["torque"]), rel=1e-9)


def test_friction_follows_the_temperature_of_the_gear() -> None:
    """Exact at every sample: viscous friction has no memory."""
    law = sw.friction.Thermal(law=sw.friction.Viscous(viscous=2e-3), viscous_fall=0.025, reference_temperature=293.15)
    warming = sw.scenario.ramp(40.0, 1.0) + sw.scenario.constant(283.15, 1.0)
    voltage = sw.scenario.constant(12.0, 1.0)
    run = sw.simulate(open_loop(friction_input=law), voltage, temperature=warming, sample=0.01)
    assert run["temperature"] == pytest.approx(warming.value(run["time"]), rel=1e-15)
    friction = 2e-3 * np.exp(-0.025 * (run["temperature"] - 293.15)) * run["input_speed"]
    assert run["friction_input"] == pytest.approx(friction, rel=1e-13)
    cold, warm = run["friction_input"][[20, -1]] / run["input_speed"][[20, -1]]
    assert warm / cold == pytest.approx(np.exp(-0.025 * 0.8 * 40.0), rel=1e-12)
    room = sw.simulate(open_loop(friction_input=law), voltage)
    assert room == sw.simulate(open_loop(friction_input=law), voltage, temperature=ROOM_TEMPERATURE)
    assert room == sw.simulate(open_loop(friction_input=law.law), voltage)


def test_drives_side_by_side_and_derivatives_see_mesh_and_temperature_too() -> None:
    law = sw.friction.Thermal(law=sw.friction.Coulomb(coulomb=0.01, breakaway=0.012, viscous=1e-3), viscous_fall=0.03)
    drive = open_loop(friction_input=law, friction_mesh=sw.friction.LoadDependent(**RATIOS))
    arguments = {"load_torque": 3.0, "temperature": sw.scenario.ramp(100.0, 0.3) + sw.scenario.constant(293.15, 0.3)}
    voltage = sw.scenario.sine(24.0, 5.0, 0.3)
    alone = sw.simulate(drive, voltage, dt=1e-4, sample=1e-3, **arguments)
    packed = side_by_side([drive], voltage, dt=1e-4, sample=1e-3, **arguments).member(0)
    dual, _ = differentiate(drive, Excitation.of(drive, voltage, **arguments), [0], 1e-4, 1e-3)
    for name in ("input_speed", "friction_mesh", "temperature"):
        size = np.abs(alone[name]).max()
        assert size > 0.0
        assert np.abs(dual[name] - alone[name]).max() <= 1e-12 * size, name
        assert np.abs(packed[name] - alone[name]).max() <= 1e-12 * size, name


def test_noise_is_the_error_of_its_seed() -> None:
    noise = sw.kinematic_error.Stochastic(amplitude=2e-5, seed=7)
    run = sw.simulate(open_loop(kinematic_noise=noise), sw.scenario.constant(12.0, 0.5), sample=1e-3)
    assert run["kinematic_error"] == pytest.approx(noise.error(run["input_angle"]), rel=0.0, abs=1e-12 * 2e-5)
    assert run == sw.simulate(open_loop(kinematic_noise=noise), sw.scenario.constant(12.0, 0.5), sample=1e-3)
    other = sw.simulate(open_loop(kinematic_noise=noise.replace(seed=8)), sw.scenario.constant(12.0, 0.5), sample=1e-3)
    assert np.corrcoef(run["kinematic_error"], other["kinematic_error"])[0, 1] < 0.5
    silent = sw.simulate(open_loop(), sw.scenario.constant(12.0, 0.5))
    assert not silent["kinematic_error"].any()


def test_a_drive_that_leaves_the_domain_of_a_part_is_refused_with_part_numbers_and_time() -> None:
    """The place and the time are those at which the same run, not refused, is first beyond."""
    law = sw.friction.PositionDependent(quadratic=0.0, linear=0.0, constant=0.05, domain_start=-1.0, domain_end=20.0)
    voltage = sw.scenario.constant(12.0, 0.5)
    free = sw.simulate(open_loop(friction_input=law.replace(outside="clamp")), voltage)
    beyond = int(np.argmax(free["input_angle"] > 20.0))
    drive = open_loop(friction_input=law)
    for run in (
        lambda: sw.simulate(drive, voltage),
        lambda: differentiate(drive, Excitation(voltage), [0], 2e-4, 1e-2),
    ):
        with pytest.raises(ValueError, match=r"^gear\.friction_input: angle = ") as refusal:
            run()
        words = re.fullmatch(
            r"gear\.friction_input: angle = (\S+) rad lies outside of \[-1, 20\] rad; widen domain_start to domain_end, "
            r"or set outside to 'clamp' or 'periodic'; first at t = (\S+) s",
            str(refusal.value),
        )
        assert words, refusal.value
        assert float(words[1]) == pytest.approx(free["input_angle"][beyond], rel=1e-9)
        assert float(words[2]) == pytest.approx(free["time"][beyond], rel=1e-12)
    assert len(sw.simulate(drive, sw.scenario.constant(12.0, free["time"][beyond - 1]))) == beyond


@pytest.mark.parametrize("place", ["friction_input", "friction_mesh", "friction_output"])
def test_the_place_that_is_out_of_its_domain_is_named_also_inside_another_law(place: str) -> None:
    law = sw.friction.PositionDependent(quadratic=0.0, linear=0.0, constant=0.0, domain_start=-1.0, domain_end=0.5)
    wrapped = sw.friction.Thermal(law=sw.friction.Cyclic(law=law))
    with pytest.raises(ValueError, match=rf"^gear\.{place}: angle = 0\.5\d* rad lies outside of \[-1, 0\.5\] rad; "):
        sw.simulate(open_loop(**{place: wrapped}), sw.scenario.constant(12.0, 1.0))
