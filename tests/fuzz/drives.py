"""Drives whose numbers are all allowed, though no gear has them."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import strainwave as sw
from numpy.random import Generator
from strainwave import _core
from strainwave.simulation.run import METHOD_WORDS

from tests.evidence.stress import model
from tests.fuzz.laws import Case, described, finite
from tests.fuzz.mutation import picked

SMALLEST = float(np.finfo(np.float32).tiny)
SIZES = (SMALLEST, 1e-30, 1e-20, 1e-9, 1e-3, 1.0, 1e3, 1e9, 1e20, 1e30, 1e100, 1e160, 1e300)


def drives_case(random: Generator, folder: Path) -> Case:
    """A drive with one to four extreme numbers, looked at in one way."""
    drive, changed = _extreme(random)
    inputs = {"load_torque": _size(random), "temperature": abs(_size(random)) + 1.0} if random.random() < 0.3 else {}
    name, look = picked(random, _LOOKS)
    return Case(f"{name} {described(changed)} {described(inputs)}", lambda: look(drive, random, inputs), _check)


def _size(random: Generator) -> float:
    return picked(random, (-1.0, 1.0)) * picked(random, SIZES)


def _extreme(random: Generator) -> tuple[sw.Drive, dict[str, float]]:
    """A random drive of which some numbers are as large or small as may be; drawn again where they contradict each other."""
    while True:
        drive = model(sw.Drive, random)
        known = _core.parameters(drive)
        numbers = [value for _, value, *_ in known]
        changed = {}
        for place in random.integers(len(known), size=int(random.integers(1, 5))).tolist():
            path, _, _, _, low, high = known[place]
            limits = [limit for limit in (low, high, 0.0) if math.isfinite(limit)]
            numbers[place] = changed[path] = float(np.clip(picked(random, (_size(random), *limits)), low, high))
        try:
            return _made_anew(_core.with_numbers(drive, numbers)), changed
        except (TypeError, ValueError):  # a seed that is no whole number is of the wrong type
            continue


def _made_anew(value: Any) -> Any:
    """The same model, whose numbers have been checked."""
    if not isinstance(getattr(value, "fields", None), tuple):
        return value
    return type(value)(**{field["name"]: _made_anew(getattr(value, field["name"])) for field in value.fields})


def _run(drive: Any, random: Generator, inputs: dict[str, float]) -> sw.Run:
    dt, method = _step(drive, random), picked(random, (*METHOD_WORDS, None))
    return sw.simulate(drive, sw.scenario.sine(5.0, 0.05 / dt, 20.0 * dt), dt, method=method, **inputs)


def _run_adaptively(drive: Any, random: Generator, inputs: dict[str, float]) -> sw.Run:
    dt = _step(drive, random)
    return sw.simulate_adaptively(drive, sw.scenario.sine(5.0, 0.05 / dt, 20.0 * dt), sample=dt, max_steps=300, **inputs)


def _run_many(drive: Any, random: Generator, inputs: dict[str, float]) -> sw.Ensemble:
    dt = _step(drive, random)
    path, value, *_ = picked(random, _core.parameters(drive))
    return sw.simulate_many(drive, sw.scenario.constant(5.0, 20.0 * dt), {path: [value, value]}, dt, threads=1, **inputs)


def _differentiate(drive: Any, random: Generator, inputs: dict[str, float]) -> sw.Recording:
    dt = _step(drive, random)
    path = picked(random, _core.parameters(drive))[0]
    return sw.analysis.derivatives(drive, sw.scenario.constant(5.0, 20.0 * dt), [path], dt, **inputs).run


def _rest(drive: Any, random: Generator, inputs: dict[str, float]) -> Any:
    return sw.analysis.equilibrium(drive, command=_size(random) if random.random() < 0.3 else 0.1, **inputs)


def _linearise(drive: Any, random: Generator, inputs: dict[str, float]) -> Any:
    view = sw.linearise(drive, **inputs)
    return [*view, view.poles, view.modes, view.eigenfrequencies]


def _respond(drive: Any, random: Generator, inputs: dict[str, float]) -> Any:
    answer = sw.analysis.frequency_response(drive, 10.0, abs(_size(random)), max_periods=3, dt=1e-3, **inputs)
    return list(answer.responses.values())


_LOOKS: tuple[tuple[str, Callable[[Any, Generator, dict[str, float]], Any]], ...] = (
    ("simulate", _run), ("simulate", _run), ("adaptively", _run_adaptively), ("many", _run_many),
    ("derivatives", _differentiate), ("equilibrium", _rest), ("linearise", _linearise), ("frequency_response", _respond),
)  # fmt: skip


def _step(drive: Any, random: Generator) -> float:
    """One that follows the drive as it lies at rest, mostly, as long as that is no step of no use."""
    fastest = _core.max_rate(drive, 0.0)
    return float(np.clip(0.1 / fastest, 1e-9, 1e-2)) if fastest > 0.0 and random.random() < 0.8 else 2e-4


def _check(result: Any) -> None:
    if isinstance(result, sw.Ensemble):
        assert all(finite(result.member(number)) for number in range(len(result)) if number not in result.failures)
    else:
        assert finite(result), "a result that is not finite"
    if isinstance(result, sw.Run):
        assert np.isfinite(result.end.numbers).all(), "a state at the end that is not finite"
