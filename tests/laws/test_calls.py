"""What every model and verb says to a call that does not fit, and that it lets Ctrl-C through."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from inspect import ismethod
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core

from tests.support.each import each
from tests.support.interrupts import ctrl_c
from tests.support.strategies import made

FAMILIES = [*_core.families.values(), *_core.fault_families.values()]
LAWS = [made(kind) for family in FAMILIES for kind in family.values()]
WHOLE = [*LAWS, sw.Gear(), sw.Drive()]
VERBS = [
    pytest.param(getattr(law, name), id=f"{law.name}.{name}")
    for law in WHOLE
    for name in dir(law)
    if not name.startswith("_") and name not in ("replace", "State", "from_datasheet") and callable(getattr(law, name))
    if not ismethod(getattr(law, name))  # written in Python, whose own messages serve
]
every_whole = each("whole", WHOLE)
every_verb = each("verb", VERBS)


def one_line(call: Callable[[], Any]) -> str:
    """What a call is refused with."""
    with pytest.raises(TypeError) as refusal:
        call()
    text = str(refusal.value)
    assert "\n" not in text
    assert len(text) < 400
    return text


@every_whole
def test_a_number_without_a_name_is_refused_by_constructor_and_replace(whole: Any) -> None:
    names = ", ".join(field["name"] for field in whole.fields)
    expected = f"{whole.name} takes its parameters by name, not 5.0 alone; it has {names}"
    assert one_line(lambda: type(whole)(5.0)) == expected
    assert one_line(lambda: whole.replace(5.0)) == expected


@every_verb
def test_an_unknown_argument_is_refused_and_the_known_ones_are_named(verb: Any) -> None:
    text = one_line(lambda: verb(unheard_of=1.0))
    assert "has no argument 'unheard_of'; it takes " in text
    assert verb.__name__ in text


@every_verb
def test_too_many_arguments_are_refused(verb: Any) -> None:
    assert "arguments; it takes " in one_line(lambda: verb(*20 * [1.0]))


@every_verb
def test_text_is_no_argument(verb: Any) -> None:
    one_line(lambda: verb("sideways"))


@each("law", [law for law in LAWS if hasattr(law, "State")])
def test_a_state_of_another_kind_is_refused(law: Any) -> None:
    takes = [name for name in ("time", "speed", "twist", "torque") if f"{name}: " in law.trace.__doc__]
    for wrong in (3, None, sw.Drive().rest(), law.State.__new__(law.State)):
        text = one_line(lambda wrong=wrong: law.trace(**{name: [0.0, 1.0] for name in takes}, state=wrong))
        assert text.startswith(f"{law.name}.trace: state must be a ")


def test_an_argument_that_is_missing_or_given_twice_is_named() -> None:
    law = sw.friction.Coulomb(coulomb=1.0)
    assert one_line(law.steady) == "coulomb.steady needs speed; it takes speed, angle, load, temperature"
    assert one_line(lambda: law.steady([1.0], speed=2.0)) == "coulomb.steady is given 'speed' twice"
    assert one_line(lambda: law.trace([0.0])) == "coulomb.trace needs speed; it takes time, speed, angle, load, temperature"


@each("highest", [2.5, "8", None, True])
def test_harmonics_are_whole_in_number(highest: Any) -> None:
    assert "fourier.harmonics: highest must be a " in one_line(lambda: sw.kinematic_error.Fourier().harmonics(highest))


@each("highest", [0, -3, 17, 10**9, 10**30, 1e300])
def test_harmonics_are_not_more_than_there_is_room_for(highest: Any) -> None:
    with pytest.raises(ValueError, match=r"highest = -?\d+ must lie in \[1, 16\]"):
        sw.kinematic_error.Fourier().harmonics(highest)


# Numbers at the ends of what numbers can be

EXTREMES = [math.nan, math.inf, -math.inf, 1e300, -1e300, 5e-324, -5e-324, 1e-300]


def scalars(verb: Any) -> Iterator[str]:
    """The arguments of a verb that are single numbers."""
    for line in verb.__doc__.splitlines():
        if line.startswith(f"{verb.__name__}(self, ") or line[3:].startswith(f"{verb.__name__}(self, "):
            yield from (part.split(":")[0].strip() for part in line.split(", ") if ": float" in part and "|" not in part)


UNUSUAL = [
    sw.kinematic_error.Fourier(order=[1.0, 1e10, 2.5], amplitude=3 * [1e-4], phase=3 * [0.5]),
    sw.friction.Cyclic(law=sw.friction.Coulomb(coulomb=1.0), order=[1e10, 0.3], amplitude=2 * [0.1], phase=2 * [0.0]),
    sw.kinematic_error.Stochastic(amplitude=1e-4, seed=3, load_sensitivity=0.1, speed_sensitivity=0.1),
    made(sw.friction.MaxwellSlipFriction, stiffness=[10.0], share=[1.0]),
    sw.hysteresis.MaxwellSlip(stiffness=[1e3], breakaway=[1.0]),
]
NUMBER_VERBS = [
    pytest.param(getattr(law, name), argument, id=f"{law.name}.{name}.{argument}-{i}")
    for i, law in enumerate(LAWS + UNUSUAL)
    for name in dir(law)
    if not name.startswith("_") and name not in ("replace", "State", "from_datasheet") and callable(getattr(law, name))
    for argument in sorted(set(scalars(getattr(law, name))))
]
PATHS = {"time": [0.0, 1.0], "displacement": [0.0, 1.0]}
MOTION = {"angle": [0.0, 1.0], "speed": [1.0, 1.0], "ratio": -100.0, "period": 1e-3}


@each(("verb", "argument"), NUMBER_VERBS)
@each("value", EXTREMES)
def test_a_number_at_the_end_of_all_is_answered_with_a_number_or_refused(verb: Any, argument: str, value: float) -> None:
    takes = verb.__doc__.splitlines()
    first = next(name for line in takes if "(self, " in line for name in [line.partition("(self, ")[2].partition(":")[0]])
    given: dict[str, Any] = {first: PATHS.get(first, 1.0)} | ({"speed": [1.0, 1.0]} if first == "time" else {})
    given |= MOTION if verb.__name__ == "requests" else {}
    answer: Any = None
    refused = ""
    try:
        answer = verb(**(given | {argument: value}))
    except ValueError as refusal:
        refused = str(refusal)
    assert math.isfinite(value) or f"{argument} = " in refused
    assert re.fullmatch(r"|.*(angle|twist|displacement|domain|spring)\b.* = .*", refused) or f"{argument} = " in refused
    if isinstance(answer, float | np.ndarray):
        assert not np.isnan(answer).any()


@each("hysteresis", [made(kind) for kind in _core.families["hysteresis"].values()])
@each("torque", [1e-300, 5e-324, -1e-300, 1e300, -1e308])
def test_a_gear_turns_any_torque_into_a_twist_or_refuses_it(hysteresis: Any, torque: float) -> None:
    gear = sw.Gear(hysteresis=hysteresis)
    (twist,) = gear.twist([torque])
    assert math.isfinite(twist)
    assert gear.trace([twist])[0] == pytest.approx(torque, rel=1e-12, abs=1e-300)


# Ctrl-C


LONG = 4_000_000
RISE, SWING = np.linspace(0.0, 1.0, LONG), 1e-3 * np.sin(np.linspace(0.0, 1e5, LONG))
POWER = sw.hysteresis.Preisach(density=sw.hysteresis.PowerDensity(limit=1e-3, saturation=1.0))
ELEMENTS = sw.hysteresis.MaxwellSlip(stiffness=16 * [1e3], breakaway=16 * [0.1])
HARMONICS = sw.kinematic_error.Fourier(order=np.arange(0.5, 8.5), amplitude=8 * [1e-4], phase=8 * [0.0])
BRISTLE = made(sw.friction.LuGre, viscous=5e-5)
RANDOM = sw.kinematic_error.Stochastic(amplitude=1e-4)
LASTING: dict[str, Callable[[], Any]] = {
    "preisach.trace": lambda: POWER.trace(SWING),
    "preisach.work": lambda: POWER.work(SWING),
    "maxwell_slip.stored": lambda: ELEMENTS.stored(SWING),
    "preisach.advance": lambda: POWER.advance(SWING),
    "maxwell_slip.inverse.trace": lambda: ELEMENTS.inverse(1e3).trace(SWING),
    "lugre.trace": lambda: BRISTLE.trace(RISE, SWING),
    "lugre.quasistatic": lambda: BRISTLE.quasistatic(SWING),
    "lugre.steady": lambda: BRISTLE.steady(SWING),
    "fourier.error": lambda: HARMONICS.error(SWING),
    "stochastic.error": lambda: RANDOM.error(RISE),
    "misalignment.lobes": lambda: made(sw.kinematic_error.Misalignment).lobes(RISE),
    "gear.trace": lambda: sw.Gear(hysteresis=POWER).trace(SWING),
    "gear.twist": lambda: sw.Gear(hysteresis=ELEMENTS).twist(SWING),
}


@pytest.mark.slow("physics")
@each("name", LASTING)
def test_a_long_call_heeds_ctrl_c_on_its_way(name: str) -> None:
    with ctrl_c(), pytest.raises(KeyboardInterrupt):
        LASTING[name]()


# Memory


@pytest.mark.slow("physics")
def test_too_little_memory_is_told_with_the_size_that_was_asked_for() -> None:
    """In a process of its own, which may take 100 MB more than it has."""
    script = """
import resource
import numpy as np
import strainwave as sw
law, path = sw.stiffness.Linear(k=1e4), np.zeros(60_000_000)
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 100_000_000,) * 2)
try:
    law.torque(path)
except MemoryError as error:
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert run.stderr == ""
    assert run.stdout == "there is no memory for 60000000 numbers, which need 480 MB; use fewer at a time\n"


def test_too_little_memory_for_what_is_copied_is_told_too() -> None:
    script = """
import resource
import numpy as np
from strainwave import _core
zeros = np.zeros(40_000_000)
used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + 100_000_000,) * 2)
try:
    _core.Signal(zeros, zeros, zeros, np.empty(0))
except MemoryError as error:
    print(error)
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert run.stderr == ""
    assert run.stdout == "there is not enough memory; use fewer samples at a time\n"
