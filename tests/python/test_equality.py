"""Values are equal where their numbers are, and the same after a copy and after a pickle."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import fields, is_dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as hnp
from strainwave import _core
from strainwave.analysis.steady import Rates
from strainwave.equality import ComparedByFields, equal
from strainwave.simulation.excitation import Excitation

from tests.support.each import each
from tests.support.strategies import made as usual

DRIVE = sw.Drive(
    control=sw.control.PID(proportional=2.0, derivative=0.05), load=sw.loads.Pendulum(inertia=0.1, gravity_torque=5.0)
)
COMMAND = sw.scenario.sine(0.1, 1.0, 0.02) + sw.scenario.table([0.0, 0.02], [0.0, 1.0])
RUN = sw.simulate(DRIVE, COMMAND)
MAKERS: dict[str, Callable[[], Any]] = {
    "Recording": lambda: RUN.select(["time", "torque"]),
    "Run": lambda: RUN,
    "Scenario": lambda: COMMAND,
    "Excitation": lambda: Excitation(COMMAND),
    "TimeGrid": lambda: Excitation(COMMAND).time_grid(1e-3, 2e-3),
    "Ensemble": lambda: sw.simulate_many(DRIVE, COMMAND, {"load.inertia": [0.1, 0.2]}),
    "Derivatives": lambda: sw.analysis.derivatives(DRIVE, COMMAND, ["load.inertia"]),
    "Linearisation": lambda: sw.linearise(DRIVE),
    "FrequencyResponse": lambda: sw.analysis.frequency_response(DRIVE, [20.0], 0.01),
    "Rates": lambda: Rates.of(DRIVE, DRIVE.rest().numbers, np.zeros(6)),
    "GearSet": lambda: sw.GearSet.read("hfuc-25-100"),
    "drive": lambda: DRIVE,
    "state": lambda: RUN.end,
} | {
    f"{family}.{name}": partial(usual, kind)
    for family, kinds in (_core.families | _core.fault_families).items()
    for name, kind in kinds.items()
}

made = cache(lambda name: MAKERS[name]())
every_value = each("name", MAKERS)


@every_value
def test_a_value_equals_its_copy_and_nothing_else(name: str) -> None:
    value = made(name)
    copied = copy.deepcopy(value)
    assert copied == value
    assert value != "another"


@every_value
def test_a_value_survives_a_pickle(name: str) -> None:
    value = made(name)
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(value, protocol)) == value


@each("name", [name for name in MAKERS if isinstance(made(name), ComparedByFields)])
def test_a_value_differs_where_one_number_does(name: str) -> None:
    value = made(name)
    for field in fields(value):
        given = getattr(value, field.name)
        if isinstance(given, np.ndarray) and given.dtype.kind in "fc":
            other = given.copy()
            other.flat[-1] += 1.0
            assert replace(value, **{field.name: other}) != value
    with pytest.raises(TypeError, match="unhashable"):
        hash(value)


def test_no_dataclass_with_arrays_is_compared_by_python() -> None:
    """Whose `==` ends in an error wherever an array has more than one element."""
    for name in MAKERS:
        value = made(name)
        if is_dataclass(value) and any(isinstance(getattr(value, field.name), np.ndarray) for field in fields(value)):
            assert isinstance(value, ComparedByFields | sw.scenario.Scenario), name


arrays = hnp.arrays(st.sampled_from([np.float64, np.int64]), hnp.array_shapes(max_dims=2, max_side=3))
trees = st.recursive(
    arrays | st.floats() | st.text(max_size=3), lambda inner: st.lists(inner, max_size=3).map(tuple), max_leaves=5
)


@given(tree=trees)
def test_whatever_a_value_holds_it_equals_its_copy(tree: object) -> None:
    assert equal(tree, copy.deepcopy(tree))
    assert equal({"a": tree}, {"a": copy.deepcopy(tree)})
    assert not equal({"a": tree}, {"a": tree, "b": 1.0})
    assert not equal((tree,), (tree, tree))
    assert not equal(tree, [tree])


@given(array=hnp.arrays(np.float64, hnp.array_shapes()), data=st.data())
def test_arrays_are_equal_where_every_number_is(array: np.ndarray[Any, Any], data: st.DataObject) -> None:
    assert equal(array, array.copy())
    assert not equal(array, array[None])
    other = array.copy()
    place = data.draw(st.integers(0, array.size - 1))
    other.flat[place] = 0.0 if array.flat[place] != 0.0 else 1.0
    assert not equal(array, other)


def test_the_order_of_a_mapping_counts() -> None:
    assert equal({"a": 1, "b": 2}, {"a": 1, "b": 2})
    assert not equal({"a": 1, "b": 2}, {"b": 2, "a": 1})
