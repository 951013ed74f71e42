"""What every friction law obeys, whatever it depends on."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

from tests.support.strategies import log_uniform, models, signed, without_detent

laws = models("friction")
set_valued = laws.filter(lambda law: law.set_valued)
with_memory = models("friction", "State").filter(lambda law: not hasattr(law, "law"))  # modulated by nothing
speeds = log_uniform(1e-6, 1e4)


def is_odd(law: Any) -> bool:
    """Whether a law says that it does not tell the two senses of motion apart; one that modulates another asks it."""
    return getattr(law, "odd", True) and (not hasattr(law, "law") or is_odd(law.law))


def in_bounds(law: Any) -> bool:
    """Whether a law takes any angle."""
    return getattr(law, "outside", "") != "refuse" and (not hasattr(law, "law") or in_bounds(law.law))


contacts = st.fixed_dictionaries(
    {
        "angle": st.floats(-1e3, 1e3),
        "load": st.just(0.0) | signed(log_uniform(1e-2, 1e3)),
        "temperature": st.floats(250.0, 350.0),
    }
)
odd = laws.filter(is_odd)


@given(laws.filter(in_bounds), speeds, contacts)
def test_steady_sliding_never_gives_power(law: Any, speed: float, contact: dict[str, float]) -> None:
    friction = without_detent(law)
    assert friction.steady(speed, **contact) >= 0.0
    assert friction.steady(-speed, **contact) <= 0.0


@given(laws.filter(in_bounds), speeds, contacts)
def test_a_detent_takes_no_power_from_a_motion_to_and_fro(law: Any, speed: float, contact: dict[str, float]) -> None:
    both, friction = (each.steady(speed, **contact) - each.steady(-speed, **contact) for each in (law, without_detent(law)))
    stored = abs(law.steady(speed, **contact)) + abs(law.steady(-speed, **contact))
    assert both == pytest.approx(friction, rel=1e-12, abs=1e-12 * stored)


@given(odd.filter(in_bounds), speeds, contacts)
def test_friction_is_odd_in_the_motion(law: Any, speed: float, contact: dict[str, float]) -> None:
    law = without_detent(law)
    reversed_load = contact | {"load": -contact["load"]}
    assert law.steady(-speed, **reversed_load) == -law.steady(speed, **contact)
    assert law.steady(0.0, **contact) == 0.0


@pytest.mark.slow("physics")
@given(laws.filter(in_bounds), st.lists(signed(speeds), min_size=1, max_size=5))
def test_an_array_of_speeds_gives_what_each_speed_gives(law: Any, speed: list[float]) -> None:
    assert law.steady([speed, speed]).tolist() == 2 * [[law.steady(v) for v in speed]]


@given(laws.filter(in_bounds), signed(speeds), st.lists(contacts, min_size=1, max_size=4))
def test_an_array_of_contacts_gives_what_each_contact_gives(law: Any, speed: float, several: list[dict[str, float]]) -> None:
    together = {name: [contact[name] for contact in several] for name in several[0]}
    assert law.steady(speed, **together).tolist() == [law.steady(speed, **contact) for contact in several]


@given(set_valued.filter(in_bounds), contacts, st.sampled_from([-1.0, 1.0]))
def test_what_sticks_holds_at_least_what_sliding_sets_in_with(law: Any, contact: dict[str, float], sense: float) -> None:
    assert law.hold(sense, **contact) >= 0.0
    law = without_detent(law)
    creeping = abs(law.steady(sense * 1e-300, **contact))
    assert creeping <= law.hold(sense, **contact) * (1.0 + 1e-15) + 1e-290  # the viscous part of so slow a motion


@pytest.mark.slow("physics")
@given(laws.filter(lambda law: not law.set_valued and in_bounds(law)), contacts)
def test_what_does_not_stick_holds_nothing(law: Any, contact: dict[str, float]) -> None:
    assert law.hold(1.0, **contact) == 0.0


@given(with_memory, signed(speeds), contacts)
def test_a_memory_settles_on_steady_sliding(law: Any, speed: float, contact: dict[str, float]) -> None:
    settled = law.trace([0.0, 1e15], [speed, speed], **(contact | {"angle": 0.0}))[-1]
    assert settled == pytest.approx(law.steady(speed, **contact), rel=1e-12)


@pytest.mark.slow("physics")
@given(with_memory, signed(speeds), st.lists(st.floats(1e-3, 1.0), min_size=2, max_size=10), contacts)
def test_a_memory_under_one_contact_does_not_depend_on_the_step(
    law: Any, speed: float, steps: list[float], contact: dict[str, float]
) -> None:
    time = np.append(0.0, np.cumsum(steps))
    fine = law.trace(time, np.full(time.shape, speed), **contact)
    coarse = law.trace(time[[0, -1]], [speed, speed], **contact)
    assert coarse[-1] == pytest.approx(fine[-1], rel=1e-12, abs=1e-12 * abs(law.steady(speed, **contact)))


@given(with_memory.filter(is_odd), st.lists(signed(speeds), min_size=2, max_size=10))
def test_a_memory_is_odd_in_the_motion(law: Any, speed: list[float]) -> None:
    time = 0.1 * np.arange(len(speed))
    assert law.trace(time, np.negative(speed)).tolist() == np.negative(law.trace(time, speed)).tolist()


@given(with_memory)
def test_a_memory_without_motion_stays_as_it_is(law: Any) -> None:
    bent = law.trace([0.0, 0.1, 0.2, 100.0], [1.0, 0.0, 0.0, 0.0], load=1.0)
    assert bent[1] == bent[2] == bent[3]
