"""Every law answers every finite number: with a finite one, or with an infinity where the true value is too large for one.

What is refused by its name is answered too: a twist beyond a bound, a path wider than numbers reach.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, strategies as st
from numpy.typing import NDArray
from strainwave.friction import Cyclic, LoadDependent, LuGre, PositionDependent, TorqueEfficiency
from strainwave.hysteresis import FadingMemory
from strainwave.stiffness import Cubic, Piecewise, ThreeSegment

from tests.support.strategies import made, models

Array = NDArray[np.float64]
Contact = dict[str, float]

LARGEST = sys.float_info.max
SIZES = (0.0, 5e-324, sys.float_info.min, 1e-160, 1e100, 1e154, 1e300, 5e306, 1e308, LARGEST)
extremes = st.sampled_from([sign * size for size in SIZES for sign in (1.0, -1.0)])
REFUSED_MOTION = "angle = .* lies outside|time from .* is wider|speed.* leads to an angle beyond"

anything = st.floats(-1e100, 1e100) | extremes
contacts = st.fixed_dictionaries({"angle": anything, "load": anything, "temperature": anything})

frictions = models("friction")
springs = models("stiffness")
hystereses = models("hysteresis")


def answer(verb: Callable[..., Any], refusal: str, *numbers: Any, **others: Any) -> Any:
    """What a verb says, or none if it refuses its arguments in such words."""
    try:
        return verb(*numbers, **others)
    except ValueError as error:
        if re.search(refusal, str(error)):
            return None
        raise


def last_finite(value: Callable[[float], float]) -> float:
    """The size of the last finite value on the way from 0 to 1, at whose end it is infinite.

    Of a continuous function that is infinite only where it must be, it is the largest number. The bits of numbers above zero,
    read as whole numbers, are in the order of the numbers.
    """
    low, high = np.array([0.0, 1.0]).view(np.int64).tolist()
    while high - low > 1:
        middle = (low + high) // 2
        finite = math.isfinite(value(np.array(middle).view(np.float64).item()))
        low, high = (middle, high) if finite else (low, middle)
    return abs(value(np.array(low).view(np.float64).item()))


# Friction


@given(frictions, anything, contacts)
@example(LoadDependent(driving_forward=10.0), 0.0, {"load": 1e308})
@example(made(TorqueEfficiency, average_loss=10.0), 0.0, {"load": 1e308})
@example(made(TorqueEfficiency, average_loss=10.0, difference_loss=10.0), -1.0, {"load": 1e308})
@example(made(PositionDependent, constant=0.0, linear=-3.8e-4, speed_factor=10.0), 1e308, {})
@example(made(PositionDependent, constant=1e-6, linear=-3.8e-4, speed_factor=10.0), 1e308, {})
@example(Cyclic(law=made(PositionDependent, speed_factor=1e3), order=1.0, amplitude=1.0, phase=-0.5 * math.pi), LARGEST, {})
def test_friction_of_steady_sliding_at_any_speed(law: Any, speed: float, contact: Contact) -> None:
    torque = answer(law.steady, "angle = .* lies outside", speed, **contact)
    if torque is None or math.isfinite(torque):
        return

    def towards(share: float) -> float:
        return float(law.steady(share * speed, **contact | {"load": share * contact.get("load", 0.0)}))

    assert torque == math.copysign(math.inf, speed)
    assert last_finite(towards) > 0.999 * LARGEST


@given(frictions, st.sampled_from([-1.0, 1.0]), contacts)
def test_what_friction_holds_under_any_load(law: Any, sense: float, contact: Contact) -> None:
    torque = answer(law.hold, "angle = .* lies outside", sense, **contact)
    if torque is None or math.isfinite(torque):
        return
    assert torque == math.inf
    assert last_finite(lambda share: law.hold(sense, **contact | {"load": share * contact["load"]})) > 0.999 * LARGEST


@given(frictions, st.lists(st.tuples(anything, anything), min_size=2, max_size=5), contacts)
@example(made(LuGre, coulomb=0.0, breakaway=0.0), [(0.0, 1e308), (1.0, 0.0)], {})
@example(made(TorqueEfficiency), [(0.0, 1e308), (1.0, 1e308)], {"load": 1.0})
@example(Cyclic(order=1.5, amplitude=0.5, phase=0.0), [(0.0, 1e308), (1e10, 1.0)], {})
def test_friction_of_any_motion(law: Any, motion: list[tuple[float, float]], contact: Contact) -> None:
    time, first = np.unique([time for time, _ in motion], return_index=True)
    speed = np.array([speed for _, speed in motion])[first]
    torque = answer(law.trace, REFUSED_MOTION, time, speed, **contact)
    if torque is None or np.isfinite(torque).all():
        return

    def towards(share: float) -> float:
        load = share * contact.get("load", 0.0)
        return float(np.abs(law.trace(time, share * speed, **contact | {"load": load})).max())

    assert not np.isnan(torque).any()
    assert last_finite(towards) > 0.999 * LARGEST


@pytest.mark.parametrize("angle", [1e17, -1e100, 1e300, LARGEST])
def test_an_angle_too_large_to_tell_its_turn_lies_beyond_a_domain(angle: float) -> None:
    law = made(PositionDependent, linear=1e-3, domain_start=-1.0, domain_end=1.0, outside="clamp")
    assert law.steady(1.0, angle=angle) == law.steady(1.0, angle=math.copysign(1.0, angle))
    with pytest.raises(ValueError, match="position_dependent: angle = "):
        law.replace(outside="refuse").steady(1.0, angle=angle)


# Stiffness


@pytest.mark.parametrize("verb", ["torque", "twist", "tangent", "energy"])
@given(springs, anything)
@example(Cubic(a1=10.0, a3=1e6), 1e154)
@example(Piecewise(k1=1e4, k2=1e3, knee=1e-3), LARGEST)
@example(made(ThreeSegment), LARGEST)
def test_a_spring_at_any_twist_and_torque(verb: str, law: Any, x: float) -> None:
    y = answer(getattr(law, verb), "twist = .* lies outside", x)
    if y is None or math.isfinite(y):
        return
    assert y == (math.inf if verb in ("tangent", "energy") else math.copysign(math.inf, x))
    assert last_finite(lambda share: getattr(law, verb)(share * x)) > 0.999 * LARGEST


@given(st.floats(1e1, 1e5), st.just(0.0) | st.floats(1e-10, 1e10), st.floats(1e-100, 1e100) | st.sampled_from(SIZES[:-1]))
def test_a_cubic_spring_gives_way_to_any_torque_as_its_torque_has_it(a1: float, a3: float, torque: float) -> None:
    spring = Cubic(a1=a1, a3=a3)
    assert spring.torque(spring.twist(torque)) == pytest.approx(torque, rel=2e-15, abs=1e-300)


# Hysteresis

paths = st.lists(anything, min_size=1, max_size=6)


@given(hystereses, paths)
def test_torque_of_any_twist(law: Any, path: list[float]) -> None:
    torque = answer(law.trace, "twist from .* is wider", path)
    if torque is None or np.isfinite(torque).all():
        return
    assert not np.isnan(torque).any()
    assert last_finite(lambda share: np.abs(law.trace(share * np.array(path))).max()) > 0.999 * LARGEST


@given(hystereses, paths)
@example(FadingMemory(stiffness=[10.0], forgetting=[1e-2]), [0.0, 1e300, -1e305])
def test_work_of_any_twist(law: Any, path: list[float]) -> None:
    """Refused where it is too large for a number, or a term of its sum is."""

    def towards(share: float) -> float:
        work = answer(law.work, "leads to work beyond", share * np.array(path))
        return math.inf if work is None else float(np.abs(work).max())

    if math.isinf(16.0 * (max(path) - min(path))):
        with pytest.raises(ValueError, match=r"twist from .* is wider than the range of numbers"):
            law.work(path)
    elif not math.isfinite(towards(1.0)):
        assert last_finite(towards) > 0.1 * LARGEST
