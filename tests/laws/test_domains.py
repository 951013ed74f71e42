"""Where a law holds and where it does not: beyond its domain it says so with the numbers, anywhere else it answers with a number."""

from __future__ import annotations

import math
import re
import sys
import warnings
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from strainwave import _core
from strainwave.friction import Coulomb, Cyclic, LuGre, MaxwellSlipFriction, PositionDependent, Thermal
from strainwave.stiffness import Linear, MultiCompliance

from tests.strategies import built, models

Array = NDArray[np.float64]

LARGEST = sys.float_info.max
EXTREMES = (0.0, 5e-324, 1e-310, 1e-200, 1e-30, 1.0, 1e30, 1e100, 1e155, 1e200, 1e300, LARGEST)
numbers = st.sampled_from([sign * x for x in EXTREMES for sign in (1.0, -1.0)]) | st.floats(allow_nan=False, allow_infinity=False)
paths = st.lists(numbers, min_size=2, max_size=6)
not_finite = st.sampled_from([math.nan, math.inf, -math.inf])


def answers(verb: Callable[..., Any], *arguments: Any, **named: Any) -> Array | None:
    """What a verb answers; nothing where it refuses, if it says why with a number."""
    try:
        return np.atleast_1d(verb(*arguments, **named))
    except ValueError as error:
        assert re.search(r"\d|inf", str(error)), error
        assert "nan" not in str(error), error
        return None


def members(state: Any) -> Array:
    """The numbers of a state."""
    return np.concatenate([np.atleast_1d(getattr(state, field["name"])) for field in type(state).fields])


def smaller(given: Any, share: float) -> Any:
    return [share * x for x in given] if isinstance(given, list) else share * given


def check(verb: Callable[..., Any], *arguments: Any, **named: Any) -> None:
    """Answers are numbers; infinite only where the true value is too large, and then smaller arguments come near the largest.

    No law grows faster than with the fourth power of all its arguments, so that half of them leave a sixteenth or more.
    """
    answer = answers(verb, *arguments, **named)
    if answer is None:
        return
    assert not np.isnan(answer).any()
    share = 1.0
    while np.isinf(answer).any():
        share *= 0.5
        half = answers(verb, *(smaller(x, share) for x in arguments), **{k: smaller(x, share) for k, x in named.items()})
        assert half is not None
        finite = np.abs(half[np.isinf(answer) & np.isfinite(half)])
        assert np.all(finite >= LARGEST / 64.0)
        answer = np.where(np.isinf(answer), half, answer)


# Anywhere


@settings(max_examples=200)
@given(models("stiffness"), numbers)
def test_a_spring_answers_any_finite_number(law: Any, x: float) -> None:
    for verb in (law.torque, law.twist, law.tangent, law.energy):
        check(verb, x)


@settings(max_examples=300)
@given(models("kinematic_error"), numbers)
def test_a_kinematic_error_answers_any_finite_angle_with_a_finite_number(law: Any, angle: float) -> None:
    largest = law.error(np.linspace(-math.pi, math.pi, 65))
    for verb in (law.error, law.slope):
        assert math.isfinite(verb(angle))
    assert np.isfinite(largest).all()


@settings(max_examples=300)
@given(models("kinematic_noise"), numbers, numbers, numbers)
def test_noise_answers_any_finite_angle_torque_and_speed(law: Any, angle: float, torque: float, speed: float) -> None:
    assert math.isfinite(law.error(angle, torque=torque, speed=speed))
    assert math.isfinite(law.slope(angle, torque=torque, speed=speed))


@settings(max_examples=300)
@given(models("friction"), numbers, numbers, numbers, numbers)
def test_friction_answers_any_finite_contact(law: Any, speed: float, angle: float, load: float, temperature: float) -> None:
    at = {"load": load, "temperature": temperature}  # the angle comes round: it is no size
    check(lambda v, **contact: law.steady(v, angle=angle, **contact), speed, **at)
    check(lambda **contact: law.hold(math.copysign(1.0, speed), angle=angle, **contact), **at)


@settings(max_examples=300)
@given(models("friction"), paths, st.data())
def test_friction_follows_any_finite_motion(law: Any, speed: list[float], data: st.DataObject) -> None:
    steps = data.draw(st.lists(st.sampled_from([1e-300, 1e-9, 1e-3, 1.0, 1e3, 1e300]), min_size=len(speed), max_size=len(speed)))
    time = np.cumsum(steps)
    if np.diff(time).min() > 0.0:
        contact = {name: data.draw(numbers) for name in ("angle", "load", "temperature")}
        answer = answers(law.trace, time, speed, **contact)
        assert answer is None or not np.isnan(answer).any()


@settings(max_examples=300)
@given(models("hysteresis"), paths)
def test_hysteresis_follows_any_finite_path(law: Any, path: list[float]) -> None:
    for name in ("trace", "work", "stored"):
        if hasattr(law, name):
            check(getattr(law, name), path)
    check(lambda twist: members(law.advance(twist)), path)


@given(built(sw.hysteresis.MaxwellSlip), st.sampled_from([1e-300, 1e-30, 1.0, 1e30, 1e300]), paths)
def test_an_inverse_follows_any_finite_path(law: Any, spring: float, path: list[float]) -> None:
    check(law.inverse(spring).trace, path)


@given(models("stiffness"), st.floats(-1e300, 1e300))
@example(sw.stiffness.Cubic(a1=10.0, a3=1e10), 1e100)
def test_however_large_a_torque_a_spring_finds_its_twist(law: Any, torque: float) -> None:
    twist = law.twist(torque)
    if abs(twist) > sys.float_info.min and (back := answers(law.torque, twist)) is not None:
        steep = abs(twist) * law.tangent(twist)
        if abs(torque) < 1e15 or not isinstance(law, MultiCompliance):  # at its bound a twist has no torque of its own
            assert back[0] == pytest.approx(torque, rel=1e-14, abs=4e-15 * min(steep, LARGEST))


# What is no number


@given(models("stiffness"), not_finite)
def test_a_spring_refuses_what_is_not_finite(law: Any, x: float) -> None:
    for verb in (law.torque, law.twist, law.tangent, law.energy):
        for given_ in (x, [0.0, x]):
            with pytest.raises(ValueError, match="finite|lies outside"):
                verb(given_)


@given(models("kinematic_error"), not_finite)
def test_a_kinematic_error_refuses_what_is_not_finite(law: Any, x: float) -> None:
    for verb in (law.error, law.slope):
        for given_ in (x, [0.0, x]):
            with pytest.raises(ValueError, match="finite"):
                verb(given_)


@given(models("kinematic_noise"), not_finite, st.sampled_from(["angle", "torque", "speed"]))
def test_noise_refuses_what_is_not_finite(law: Any, x: float, name: str) -> None:
    for verb in (law.error, law.slope):
        for angle in (1.0, [0.0, 1.0]):
            given_ = {"angle": angle, "torque": 1.0, "speed": 1.0} | {name: x}
            with pytest.raises(ValueError, match="finite"):
                verb(**given_)


@given(models("friction"), not_finite, st.sampled_from(["speed", "angle", "load", "temperature"]))
def test_friction_refuses_what_is_not_finite(law: Any, x: float, name: str) -> None:
    contact = {"speed": 1.0, "angle": 0.0, "load": 1.0, "temperature": 300.0} | {name: x}
    with pytest.raises(ValueError, match="finite|lies outside"):
        law.steady(**contact)
    with pytest.raises(ValueError, match="finite|lies outside"):
        law.trace([0.0, 1.0], **contact | {"speed": [1.0, contact["speed"]]})
    with pytest.raises(ValueError, match="finite|lies outside"):
        law.trace([0.0, x], **contact | {"speed": [1.0, 1.0]})


@given(models("hysteresis"), not_finite)
def test_hysteresis_refuses_what_is_not_finite(law: Any, x: float) -> None:
    for verb in (law.trace, law.work, law.advance):
        with pytest.raises(ValueError, match="finite"):
            verb([0.0, x])


# The domain of a law


MEASURED = PositionDependent(domain_start=-0.5, domain_end=2.0, outside="refuse")
SPRING = MultiCompliance()
BOUND = math.pi / (2.0 * SPRING.flexspline_hardening * SPRING.flexspline_stiffness) + 1.0 / (
    SPRING.reduction * SPRING.wave_generator_hardening * SPRING.wave_generator_stiffness
)


def outside(name: str, value: float, low: float, high: float) -> str:
    """How a message names a value beyond a domain."""
    return re.escape(f"{name} = {value!r} rad lies outside of [{low!r}, {high!r}] rad".replace(".0 ", " ").replace(".0]", "]"))


@pytest.mark.parametrize("angle", [-0.75, 2.25, 1e6])
@pytest.mark.parametrize(
    "law", [MEASURED, Cyclic(law=MEASURED), Thermal(law=MEASURED), Thermal(law=Cyclic(law=MEASURED))], ids=repr
)
def test_friction_known_at_some_angles_says_where_it_is_not(law: Any, angle: float) -> None:
    message = outside("angle", angle, -0.5, 2.0)
    for ask in (
        lambda: law.steady(1.0, angle=angle),
        lambda: law.steady([1.0, 2.0], angle=[0.0, angle]),
        lambda: law.hold(angle=angle),
        lambda: law.trace([0.0, 1.0], [1.0, 1.0], angle=angle),
    ):
        with pytest.raises(ValueError, match=message):
            ask()


def test_a_motion_that_leaves_the_angles_known_is_refused() -> None:
    assert MEASURED.trace([0.0, 1.0], [1.0, 1.0], angle=0.5).shape == (2,)
    with pytest.raises(ValueError, match=r"angle = 2\.25 rad lies outside of \[-0\.5, 2\] rad"):
        MEASURED.trace([0.0, 1.0, 2.0], [1.0, 1.0, 1.0], angle=0.25)


@pytest.mark.parametrize("choice", ["clamp", "periodic"])
@given(st.floats(-1e6, 1e6))
def test_friction_continued_beyond_the_angles_known_answers_everywhere(choice: str, angle: float) -> None:
    law = MEASURED.replace(outside=choice)
    levels = MEASURED.steady(1.0, angle=np.linspace(-0.5, 2.0, 2001))
    ripple = sum(map(abs, law.cosine)) + sum(map(abs, law.sine))
    assert levels.min() - 2.0 * ripple - 1e-3 <= law.steady(1.0, angle=angle) <= levels.max() + 2.0 * ripple + 1e-3
    assert math.isfinite(law.hold(angle=angle))
    assert np.isfinite(law.trace([0.0, 1.0], [1.0, 1.0], angle=angle)).all()


def drive(**parts: Any) -> sw.drives.PositionDrive:
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=100.0), stiffness=Linear(k=1e4), damping=5.0)
    return sw.drives.PositionDrive(
        gear=gear.replace(**parts),
        motor=sw.motor.DC(resistance=0.5, inductance=0.0, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
        load=sw.loads.Inertia(inertia=0.05),
    )


@pytest.mark.parametrize(
    ("place", "column", "voltage"),
    [("friction_input", "input_angle", 12.0), ("friction_mesh", "input_angle", 12.0), ("friction_output", "output_angle", 12.0)],
)
@pytest.mark.parametrize("modulated", [False, True])
def test_a_drive_that_leaves_the_angles_known_says_which_part_where_and_when(
    place: str, column: str, voltage: float, modulated: bool
) -> None:
    """The angle in the message is the one at the time in the message, and is the first beyond."""
    scale = 100.0 if place == "friction_input" else 1.0
    law = PositionDependent(
        quadratic=0.0, linear=0.0, constant=1e-3, domain_start=-1e-3, domain_end=0.01 * scale, outside="refuse"
    )
    part = {place: Thermal(law=law) if modulated else law}
    command = sw.scenario.constant(voltage, 0.2)
    with pytest.raises(ValueError, match=rf"gear\.{place}: angle = \S+ rad lies outside of \[-0\.001, \S+\] rad") as refused:
        sw.simulate(drive(**part), command, 1e-4)
    value, time = map(float, re.findall(r"angle = (\S+) rad.*t = (\S+) s", str(refused.value))[0])
    allowed = {place: law.replace(outside="clamp")}
    run = sw.simulate(drive(**allowed), command, 1e-4)
    angle = run[column] / (100.0 if place == "friction_mesh" else 1.0)
    first = int(np.argmax(angle > law.domain_end))
    assert first > 0
    assert time == pytest.approx(run["time"][first], rel=1e-5)
    assert value == pytest.approx(angle[first], rel=1e-5)
    for choice in ("clamp", "periodic"):
        assert len(sw.simulate(drive(**{place: law.replace(outside=choice)}), command, 1e-4)) == 2001


@given(st.floats(1.0 + 1e-12, 1e6), st.sampled_from([1.0, -1.0]))
def test_a_spring_with_a_bound_says_where_it_is(times: float, sense: float) -> None:
    twist = sense * times * BOUND
    for verb in (SPRING.torque, SPRING.tangent, SPRING.energy):
        for given_ in (twist, [0.0, twist]):
            with pytest.raises(ValueError, match=r"^multi_compliance: twist = \S+ rad lies outside of \[\S+, \S+\] rad") as refused:
                verb(given_)
            value, low, high = map(float, re.findall(r"= (\S+) rad.*\[(\S+), (\S+)\]", str(refused.value))[0])
            assert value == twist
            assert (low, high) == pytest.approx((-BOUND, BOUND), rel=1e-15)


def test_a_spring_answers_up_to_its_bound() -> None:
    levels = SPRING.torque(BOUND * np.array([0.0, 0.5, 0.9, 0.99, 0.999999]))
    assert all(low < high for low, high in pairwise(levels))


def test_a_drive_that_twists_its_gear_beyond_the_bound_says_which_part_where_and_when() -> None:
    """A motor that pushes against a load all but locked; the spring hardens so late that it is not resolved before."""
    spring = MultiCompliance(flexspline_stiffness=50.0, flexspline_hardening=10.0, wave_generator_hardening=1e3)
    locked = drive(stiffness=spring).replace(load=sw.loads.Inertia(inertia=1e3))
    message = r"gear\.stiffness: twist = \S+ rad lies outside of \[\S+, \S+\] rad.* t = \S+ s"
    with pytest.raises(ValueError, match=message) as refused:
        sw.simulate(locked, sw.scenario.step(48.0, 0.1), 1e-4)
    value, low, high = map(float, re.findall(r"= (\S+) rad.*\[(\S+), (\S+)\]", str(refused.value))[0])
    assert abs(value) > high == -low
    soft = locked.replace(gear=locked.gear.replace(stiffness=spring.replace(flexspline_hardening=0.0)))
    assert np.abs(sw.simulate(soft, sw.scenario.step(48.0, 0.1), 1e-4)["twist"]).max() > high


# Laws that can create energy


CREATING = {
    "lugre": LuGre(coulomb=0.05, breakaway=0.07, stribeck_speed=0.1, bristle_stiffness=50.0, bristle_damping=0.02, viscous=0.0081),
    "maxwell_slip_friction": MaxwellSlipFriction(stiffness=[60.0], share=[1.0], coulomb=0.05, breakaway=0.05),
}
CHANGES = {"lugre": {"viscous": 4e-4}, "maxwell_slip_friction": {"breakaway": 0.07}}
MESSAGES = {
    "lugre": r"^lugre can create energy: viscous = 0\.0004 N\.m\.s/rad .* = 0\.00(80*|7999)\d* N\.m\.s/rad",
    "maxwell_slip_friction": r"^maxwell_slip_friction can create energy: coulomb = 0\.05 N\.m .*breakaway = 0\.07 N\.m",
}


@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("name", CREATING)
def test_a_law_that_can_create_energy_warns_with_both_sides(name: str) -> None:
    law, change, message = CREATING[name], CHANGES[name], MESSAGES[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        law.check()
        assert law.replace() == law
    with pytest.warns(_core.PassivityWarning, match=message):
        creating = law.replace(**change)
    with pytest.warns(_core.PassivityWarning, match=message):
        type(law)(**{field["name"]: getattr(creating, field["name"]) for field in law.fields})
    with pytest.warns(_core.PassivityWarning, match=message):
        creating.check()


def test_every_law_that_knows_when_it_is_passive_is_tried_here() -> None:
    checked = {model.name for model in _core.families["friction"].values() if hasattr(model, "check")}
    assert checked == set(CREATING)
    assert not hasattr(Coulomb, "check")
