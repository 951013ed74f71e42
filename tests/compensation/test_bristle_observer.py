"""An observer of friction by its bristles: the torque of steady sliding, of presliding, and the true scale."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave.compensation import BristleObserver, ModelFeedforward

from tests.compensation.ideal import KINEMATICS, LIGHT, RATIO, state

PERIOD = 1e-3  # s
INERTIA, DAMPING, POSITION = 2e-4, 4e-3, 20.0  # kg.m2, N.m.s/rad of the speed loop, 1/s of the position loop
SPEED = 0.3  # rad/s of the output
STIFFNESS = 5.0  # N.m/rad of the bristles
LUGRE = sw.friction.LuGre(
    coulomb=0.05, breakaway=0.07, stribeck_speed=3.0, bristle_stiffness=STIFFNESS, bristle_damping=2e-3, viscous=5e-4
)
DRY = sw.friction.Stribeck(coulomb=0.05, breakaway=0.07, stribeck_speed=3.0, viscous=5e-4)
LEVEL = sw.friction.Coulomb(coulomb=0.05, breakaway=0.05)
LAWS = pytest.mark.parametrize("law", [LUGRE, DRY], ids=["lugre", "stribeck"])


def gear(friction: Any) -> sw.Gear:
    return sw.Gear(kinematics=KINEMATICS, stiffness=sw.stiffness.Linear(k=1e5), damping=30.0, friction_input=friction)


def drive(observer: Any, friction: Any, position: float = POSITION, period: float = PERIOD, **others: Any) -> sw.Drive:
    """A rotor in a position loop without an integral."""
    law = sw.control.PID(proportional=position * DAMPING, derivative=DAMPING, limit=5.0)
    part = sw.Compensation(observer=observer, **others)
    return sw.Drive(
        gear=gear(friction),
        motor=sw.motor.TorqueSource(inertia=INERTIA),
        load=LIGHT,
        control=sw.control.Sampled(law=law, period=period, compensation=part),
    )


def lag(one: sw.Drive, command: sw.scenario.Scenario | None = None) -> float:
    """Error of the input at the end of a ramp [rad]."""
    run = sw.simulate(one, command or sw.scenario.ramp(SPEED, 4.0), sample=1e-2)
    return float(RATIO * run["command"][-1] - run["input_angle"][-1])


@LAWS
@pytest.mark.parametrize("share", [0.0, 0.6, 1.0])
def test_in_steady_sliding_it_supplies_its_share_of_the_friction(law: Any, share: float) -> None:
    """The proportional gain gives the rest: k_p e = (1 - share) F(omega)."""
    friction = float(law.steady(RATIO * SPEED))
    error = lag(drive(BristleObserver(friction=law, friction_share=share), law))
    assert POSITION * DAMPING * error == pytest.approx((1.0 - share) * friction, abs=2e-4 * abs(friction))


@LAWS
@pytest.mark.parametrize("model", [LUGRE, DRY, sw.friction.Coulomb(coulomb=0.2)])
def test_friction_of_the_feedforward_is_not_supplied_twice(law: Any, model: Any) -> None:
    """Whatever friction that has."""
    ahead = ModelFeedforward(gear=gear(model), load=LIGHT, motor_inertia=INERTIA)
    friction = abs(float(law.steady(RATIO * SPEED)))
    error = lag(drive(BristleObserver(friction=law), law, feedforward=ahead))
    assert abs(POSITION * DAMPING * error) < 2e-4 * friction


def test_at_rest_its_bristles_take_the_torque_of_presliding() -> None:
    """The input is displaced by x and held there: sigma_0 z = F_c (1 - exp(-sigma_0 x / F_c)), for F_s = F_c (Dahl)."""
    dahl = LUGRE.replace(breakaway=LUGRE.coulomb, bristle_damping=0.0, viscous=0.0)
    one, moved, count = drive(BristleObserver(friction=dahl), sw.friction.Viscous(), position=0.0), 0.005, 50
    now = one.rest()
    for _ in range(count):  # samples at this speed, from one at the angle zero
        now = now.replace({"input_speed": moved / (count * PERIOD), "output_speed": moved / (count * PERIOD) / RATIO})
        now = one.step(now, command=0.0, dt=PERIOD)
    deflection = now["control.compensation.observer.friction.deflection"]
    wanted = dahl.coulomb * (1.0 - np.exp(-STIFFNESS * moved / dahl.coulomb))
    assert STIFFNESS * deflection == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("bristle_gain", [0.0, 0.3, 1.0])
def test_the_error_bends_the_bristles_of_a_shaft_at_rest(bristle_gain: float) -> None:
    """Below breakaway a blocked input has sigma_0 z = F_c (1 - exp(-sigma_0 k lambda e t / F_c)) of a constant error e."""
    dahl = LUGRE.replace(breakaway=LUGRE.coulomb, bristle_damping=0.0, viscous=0.0)
    blocked = sw.friction.Coulomb(coulomb=100.0, breakaway=100.0)
    error, duration = 1e-3, 0.5  # rad of the output, s
    observer = BristleObserver(friction=dahl, bristle_gain=bristle_gain, position_gain=POSITION)
    run = sw.simulate(drive(observer, blocked), sw.scenario.constant(error, duration), sample=1e-2)
    deflection = run.end["control.compensation.observer.friction.deflection"]
    bent = STIFFNESS * bristle_gain * POSITION * RATIO * error * (duration + PERIOD) / dahl.coulomb
    assert STIFFNESS * deflection == pytest.approx(dahl.coulomb * np.sign(bent) * -np.expm1(-abs(bent)), rel=0.01)
    assert abs(STIFFNESS * deflection) <= dahl.coulomb


def test_the_sense_of_a_set_valued_law_turns_over_its_presliding() -> None:
    """After a way x of the input from rest it is 1 - exp(-x / presliding)."""
    presliding, moved, count = 0.01, 0.02, 40
    observer = BristleObserver(friction=DRY, presliding=presliding)
    one = drive(observer, sw.friction.Viscous(), position=0.0)
    now = one.rest()
    for _ in range(count):
        now = now.replace({"input_speed": moved / (count * PERIOD), "output_speed": moved / (count * PERIOD) / RATIO})
        now = one.step(now, command=0.0, dt=PERIOD)
    assert now["control.compensation.observer.sense"] == pytest.approx(1.0 - np.exp(-moved / presliding), rel=1e-9)


@LAWS
@pytest.mark.parametrize("true", [0.7, 1.0, 1.3])
def test_its_scale_converges_to_the_true_one(law: Any, true: float) -> None:
    """Of a drive that has more or less of every torque of the law; and the error goes."""
    levels = ("coulomb", "breakaway", "viscous", "bristle_stiffness", "bristle_damping")
    more = law.replace({name: true * getattr(law, name) for name in levels if hasattr(law, name)})
    one = drive(BristleObserver(friction=law, gain=30.0), more)
    run = sw.simulate(one, sw.scenario.ramp(SPEED, 8.0), sample=1e-2)
    assert state(run.end, "observer")["scale"] == pytest.approx(true, abs=0.01)
    assert abs(RATIO * run["command"][-1] - run["input_angle"][-1]) < 0.01 * abs(lag(drive(sw.compensation.NoObserver(), more)))


@pytest.mark.parametrize("share", [0.8, 1.0])
def test_share_and_largest_scale_bound_what_is_supplied(share: float) -> None:
    """Of a friction twice as large as the bound allows: k_p e is the rest."""
    true = LEVEL.replace(coulomb=0.2, breakaway=0.2)
    one = drive(BristleObserver(friction=LEVEL, friction_share=share, gain=100.0, max_scale=1.5), true)
    wanted = true.coulomb - share * 1.5 * LEVEL.coulomb
    assert abs(POSITION * DAMPING * lag(one)) == pytest.approx(wanted, rel=2e-3)


@pytest.mark.parametrize(("min_speed", "learns"), [(29.9, True), (30.1, False)])
def test_below_the_slowest_its_scale_stands_still(min_speed: float, learns: bool) -> None:
    """At 30 rad/s of the input."""
    one = drive(BristleObserver(friction=LEVEL, gain=30.0, min_speed=min_speed), LEVEL.replace(coulomb=0.06, breakaway=0.06))
    run = sw.simulate(one, sw.scenario.ramp(SPEED, 1.0), sample=1e-2)
    assert (state(run.end, "observer")["scale"] != 1.0) == learns


@given(st.floats(0.0, 1.0), st.floats(1.0, 3.0), st.floats(0.0, 1e4), st.floats(0.0, 10.0), st.floats(0.1, 5.0))
def test_scale_and_bristles_stay_within_their_bounds(least: float, most: float, gain: float, bend: float, true: float) -> None:
    """However fast, and whatever the friction is."""
    observer = BristleObserver(friction=LUGRE, gain=gain, bristle_gain=bend, min_scale=least, max_scale=most)
    one = drive(observer, LEVEL.replace(coulomb=true * 0.05, breakaway=true * 0.05))
    run = sw.simulate(one, sw.scenario.sine(0.1, 2.0, 0.5), sample=1e-2)
    found = state(run.end, "observer")
    assert least <= found["scale"] <= most
    assert abs(found["friction.deflection"]) <= LUGRE.breakaway / STIFFNESS * (1.0 + 1e-12)


@pytest.mark.parametrize("true", [0.7, 1.3])
@pytest.mark.parametrize("share", [0.8, 1.0])
def test_its_lyapunov_function_does_not_grow(true: float, share: float) -> None:
    """J (sigma^2 + lambda^2 e^2) + (s / rho - s^)^2 / gamma in sliding of one sense, at a short period."""
    period, gain = 5e-5, 100.0
    observer = BristleObserver(friction=LEVEL, friction_share=share, gain=gain, max_scale=3.0)
    one = drive(observer, LEVEL.replace(coulomb=true * LEVEL.coulomb, breakaway=true * LEVEL.coulomb), period=period)
    now = one.rest().replace({"input_speed": RATIO * SPEED, "output_speed": SPEED, "control.compensation.observer.sense": -1.0})
    values = []
    for number in range(3000):
        now = one.step(now, command=SPEED * number * period, command_rate=SPEED, dt=period)
        angle = RATIO * SPEED * (number + 1) * period - now.input_angle - 2.0 * np.pi * now.turns
        error = RATIO * SPEED - now.input_speed + POSITION * angle
        missing = true / share - now["control.compensation.observer.scale"]
        values.append(INERTIA * (error**2 + (POSITION * angle) ** 2) + missing**2 / gain)
    assert np.diff(values).max() < 2e-4 * values[0]  # what a period leaves of it
    assert values[-1] < 0.6 * values[0]


@pytest.mark.parametrize("share", [0.6, 0.8])
def test_over_compensated_friction_drives_a_shaft_by_itself(share: float) -> None:
    """Without a controller: J d omega / dt = share F_c - F_true, so a share below the true scale lets it come to rest."""
    true, duration, speed = 0.7 * LEVEL.coulomb, 0.5, 5.0  # N.m, s, rad/s
    one = drive(BristleObserver(friction=LEVEL, friction_share=share), LEVEL.replace(coulomb=true, breakaway=true))
    free = one.replace({"control.law.proportional": 0.0, "control.law.derivative": 0.0})
    start = free.rest().replace(
        {"input_speed": speed, "output_speed": speed / RATIO, "control.compensation.observer.sense": 1.0}
    )
    reached = sw.simulate(free, sw.scenario.constant(0.0, duration), sample=1e-2, initial=start)["input_speed"][-1]
    wanted = max(speed + (share * LEVEL.coulomb - true) * duration / (INERTIA + LIGHT.inertia / RATIO**2), 0.0)
    assert reached == pytest.approx(wanted, rel=1e-3, abs=1e-9)


def test_it_supplies_the_friction_that_the_feedforward_supplies_too_early() -> None:
    """A shaft that another torque keeps at rest: the feed-forward pushes it away, the observer does not."""
    ahead = ModelFeedforward(gear=gear(LEVEL), load=LIGHT, motor_inertia=INERTIA)
    held = sw.friction.Coulomb(coulomb=100.0, breakaway=100.0)
    command, torques = sw.scenario.ramp(1e-6, 0.2), []
    for observer in (sw.compensation.NoObserver(), BristleObserver(friction=LEVEL)):
        one = drive(observer, held, feedforward=ahead.replace(presliding=1e-6))
        torques.append(float(sw.simulate(one, command, sample=1e-2)["motor_torque"][-1]))
    assert torques[0] == pytest.approx(-LEVEL.coulomb, rel=0.01)
    assert abs(torques[1]) < 0.01 * LEVEL.coulomb


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"friction_share": 1.1}, r"bristle_observer\.friction_share = 1\.1 must lie in \[0, 1\]"),
        ({"bristle_gain": -0.1}, r"bristle_observer\.bristle_gain = -0\.1"),
        ({"max_scale": 0.9}, r"bristle_observer\.max_scale = 0\.9"),
        ({"presliding": 0.0}, r"bristle_observer\.presliding = 0"),
    ],
)
def test_what_is_wrong_is_refused(changed: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        BristleObserver(**changed)
