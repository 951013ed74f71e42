"""One trajectory in double, in a pack and in dual numbers, whatever laws a drive is made of."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from strainwave import _core
from strainwave.drives import PositionDrive
from strainwave.simulation import derivatives

from tests.laws.test_gear import DRIVE, EVERY_PART, PLACES, cannot_create_energy, laws
from tests.strategies import built

Array = NDArray[np.float64]

DURATION, SAMPLE = 0.05, 1e-3
COLUMNS = [name for name, _, _ in _core.outputs]
COMMAND = sw.scenario.sine(12.0, 30.0, DURATION)  # V
LOAD = sw.scenario.sine(5.0, 17.0, DURATION)  # N.m
TEMPERATURE = sw.scenario.ramp(293.15, DURATION) + sw.scenario.constant(293.15, DURATION)
CONTROLLED = DRIVE.replace(control=sw.control.PID(proportional=2.0, integral=1.0, derivative=0.05, limit=24.0))
OTHER_PARTS = [
    pytest.param(part, model, id=f"{part}={model.name}")
    for part, family in (("motor", "motor"), ("control", "control"), ("load", "loads"))
    for model in _core.families[family].values()
]


def neighbour(drive: PositionDrive, share: float) -> PositionDrive:
    """The same models with other numbers; the whole ones, which choose orders and limits, as they are."""
    numbers = [number for _, number, *_ in _core.parameters(drive)]
    return _core.with_numbers(drive, [x if x == round(x) else x * (1.0 + share) for x in numbers])


def columns(run: sw.Recording) -> Array:
    return np.stack([run[name] for name in COLUMNS])


def damping(law: Any) -> float:
    return damping(law.law) if hasattr(law, "law") else float(getattr(law, "bristle_damping", 0.0))


def scales(drive: PositionDrive, run: sw.Recording) -> Array:
    """How large the numbers in each column are; a bristle's torque is a difference of terms as large as its damping's."""
    largest = np.abs(columns(run)).max(axis=1)
    speed = {name: float(np.abs(run[name]).max()) for name in ("input_speed", "output_speed")}
    speed["mesh_speed"] = speed["input_speed"]
    for place in PLACES:
        row, side = COLUMNS.index(place), place.replace("friction_", "") + "_speed"
        largest[row] = max(largest[row], damping(getattr(drive.gear, place)) * speed[side])
    return largest[:, None]


def check(drive: PositionDrive, others: list[PositionDrive], dt: float, numbers: list[int]) -> None:
    """A pack's and a dual number's trajectory against the double's, to 1e-12.

    Or to what numbers that differ by 1e-14 make of the double's, where stick and slip blow that up to more, but not to no
    trajectory at all.
    """
    course = {"load_torque": LOAD, "temperature": TEMPERATURE}
    single, beside = (sw.simulate(each, COMMAND, dt, sample=SAMPLE, **course) for each in (drive, neighbour(drive, 1e-14)))
    size = scales(drive, single)
    strayed = np.maximum.accumulate(np.abs(columns(beside) - columns(single)), axis=1)
    assume(np.all(strayed <= 1e-6 * size))
    allowed = np.maximum(1e-12 * size, strayed)
    packed = sw.simulate_many([drive, *others], COMMAND, dt, sample=SAMPLE, **course)[0]
    assert np.all(np.abs(columns(packed) - columns(single)) <= allowed)
    dual, _ = derivatives(drive, COMMAND, numbers, dt, SAMPLE, **course)
    assert np.all(np.abs(columns(dual) - columns(single)) <= allowed)


def agree(drive: PositionDrive, shares: list[float], draw: st.DataObject) -> None:
    """At a step that resolves each of the drives, if a small one does."""
    count = len(_core.parameters(drive))
    numbers = draw.draw(st.lists(st.integers(0, count - 1), min_size=1, max_size=3, unique=True))
    assume(cannot_create_energy(drive.gear))
    others = [neighbour(drive, share) for share in shares]
    for dt in (1e-4, 1.25e-5):
        try:
            check(drive, others, dt, numbers)
            return
        except FloatingPointError:
            continue
        except ValueError as error:
            assume("lies outside of" not in str(error))
            raise
    assume(False)


shares = st.lists(st.floats(-0.1, 0.1), min_size=1, max_size=8)


@pytest.mark.parametrize(("part", "model"), EVERY_PART)
@settings(max_examples=5)
@given(shares=shares, draw=st.data())
def test_a_gear_with_any_law_runs_one_trajectory_in_every_scalar(
    part: str, model: Any, shares: list[float], draw: st.DataObject
) -> None:
    law = draw.draw(laws(part, model))
    agree(DRIVE.replace(gear=DRIVE.gear.replace(**{part: law})), shares, draw)


@pytest.mark.parametrize(("part", "model"), OTHER_PARTS)
@settings(max_examples=5)
@given(shares=shares, draw=st.data())
def test_a_drive_with_any_motor_control_or_load_runs_one_trajectory_in_every_scalar(
    part: str, model: Any, shares: list[float], draw: st.DataObject
) -> None:
    drive = CONTROLLED if part == "control" else DRIVE
    law = draw.draw(built(model))
    assume(part != "load" or law.inertia > 1e-3)
    agree(drive.replace(**{part: law}), shares, draw)
