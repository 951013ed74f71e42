"""Each model of each list, in each place it may take: one trajectory in double, in packs and in dual numbers, to the last bit.

Where stick and slip alternate, a last digit that differs soon changes many. None does differ: every lane of a pack does what it
would do alone, and dual numbers add derivatives and change no value.
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import HealthCheck, assume, given, reject, settings, strategies as st
from numpy.typing import NDArray
from strainwave import Drive, _core
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.run import differentiate
from strainwave.simulation.signals import load_input, outputs

from tests.laws.test_gear import DRIVE, EVERY_PART, cannot_create_energy, laws, reduced_gears
from tests.support.samples import sample
from tests.support.side_by_side import side_by_side
from tests.support.strategies import built, models, suited

Array = NDArray[np.float64]

DURATION, SAMPLE = 0.05, 1e-3
COMMAND = sw.scenario.sine(12.0, 30.0, DURATION)  # V
TIMED = ("control.period", "control.delay")  # when something happens


def course(drive: Drive) -> dict[str, sw.scenario.Scenario]:
    """Inputs besides the command, by name."""
    size = {"load_torque": 5.0, "output_angle": 1e-3, "brake_torque": 3.0}  # N.m, rad, N.m
    load = load_input(drive)
    return {
        load: sw.scenario.sine(size[load], 17.0, DURATION),
        "temperature": sw.scenario.ramp(100.0, DURATION) + sw.scenario.constant(290.0, DURATION),  # K
    }


CONTROLLED = DRIVE.replace(control=sw.control.PID(proportional=2.0, integral=1.0, derivative=0.05, limit=24.0))
OTHER_FAMILIES = {
    "motor": "motor",
    "control": "control",
    "load": "loads",
    "sensors": "sensor",
    "thermal": "thermal",
    "meter": "meter",
}
OTHER_PARTS = [
    pytest.param(part, model, id=f"{part}={model.name}")
    for part, family in OTHER_FAMILIES.items()
    for model in _core.families[family].values()
]
seeds = st.integers(0, 2**32 - 1)


def neighbours(drive: Drive, seed: int) -> list[Drive]:
    """Eight with other numbers, but for whole ones: orders of errors are summed up otherwise if all of a pack are whole."""
    paths, numbers, _, _, low, high = (np.array(column) for column in zip(*_core.parameters(drive), strict=True))
    random = np.random.default_rng(seed)
    timed = np.array([path in TIMED for path in paths])  # the same for all members of a pack
    found: list[Drive] = []
    for _ in range(200):
        other = np.clip(numbers * (1.0 + random.uniform(-0.1, 0.1, numbers.size)), low, high)
        other = np.where(timed | (numbers == np.rint(numbers)) | (other == np.rint(other)), numbers, other)
        with suppress(ValueError):  # the numbers of a model may not relate to each other so
            found.append(_core.with_numbers(drive, other))
        if len(found) == 8:
            return found
    assume(False)
    return []


def differentiable(drive: Drive) -> list[int]:
    """The parameters by which derivatives leave values as they are: a power or an order is no longer whole then."""
    paths = [path for path, *_ in _core.parameters(drive)]
    return [i for i, path in enumerate(paths) if ".order[" not in path and not path.endswith((".exponent", *TIMED))]


def check(drive: Drive, seed: int, dt: float) -> None:
    """Nine drives are one full pack, and one that repeats its last member."""
    singles = [
        sw.simulate(each, COMMAND, dt, sample=SAMPLE, method="exponential", inputs=course(drive))
        for each in (drive, *neighbours(drive, seed))
    ]
    packed = side_by_side([drive, *neighbours(drive, seed)], COMMAND, dt, sample=SAMPLE, inputs=course(drive))
    for number, single in enumerate(singles):
        assert [name for name in outputs(drive) if not np.array_equal(packed[name][number], single[name])] == []
    chosen = np.random.default_rng(seed).choice(differentiable(drive), 3, replace=False)
    dual, _ = differentiate(drive, Excitation.of(drive, COMMAND, inputs=course(drive)), chosen, dt, SAMPLE)
    assert [name for name in outputs(drive) if not np.array_equal(dual[name], singles[0][name])] == []


def agree(drive: Drive, seed: int) -> None:
    """At a step that resolves the drives, if a small one does, and where all parts are valid."""
    assume(cannot_create_energy(drive.gear))
    for dt in (1e-4, 1.25e-5):
        try:
            check(drive, seed, dt)
            return
        except FloatingPointError:
            continue
        except ValueError as error:
            assume("lies outside of" not in str(error))
            raise
    assume(False)


@pytest.mark.filterwarnings("ignore:the drive has bristles:RuntimeWarning")  # asked for
@pytest.mark.parametrize(("part", "model"), EVERY_PART)
@settings(max_examples=sample(3, 8))
@given(st.data(), seeds)
def test_a_gear_with_any_law_runs_one_trajectory_in_every_scalar(part: str, model: Any, data: st.DataObject, seed: int) -> None:
    law = suited(data.draw(laws(part, model)), DRIVE.gear.kinematics)
    agree(DRIVE.replace(gear=DRIVE.gear.replace(**{part: law})), seed)


@pytest.mark.slow("physics")
@pytest.mark.parametrize(("part", "model"), OTHER_PARTS)
@settings(max_examples=sample(3, 8))
@given(st.data(), seeds)
def test_a_drive_with_any_other_part_runs_one_trajectory_in_every_scalar(
    part: str, model: Any, data: st.DataObject, seed: int
) -> None:
    base = CONTROLLED if part in ("control", "sensors") else DRIVE
    law = suited(data.draw(built(model)), base.gear.kinematics)
    assume(getattr(law, "inertia", 1.0) > 1e-3 or part != "load")
    agree(base.replace(**{part: sw.Sensors(output_angle=law, input_speed=law) if part == "sensors" else law}), seed)


def with_a_start(gear: sw.Gear) -> sw.Gear:
    """The gear with its error as it is without load: a random one that gives way under load may find no start."""
    return gear.replace(kinematic_error=getattr(gear.kinematic_error, "law", gear.kinematic_error))


starting_gears = reduced_gears.map(with_a_start)


@pytest.mark.slow("physics")
@pytest.mark.filterwarnings("ignore:the drive has bristles:RuntimeWarning")  # asked for
@settings(max_examples=sample(6, 50))
@given(starting_gears, seeds)
def test_a_gear_with_laws_drawn_at_every_place_runs_one_trajectory_in_every_scalar(gear: sw.Gear, seed: int) -> None:
    agree(DRIVE.replace(gear=gear), seed)


def whole(gear: sw.Gear, parts: dict[str, Any]) -> Drive:
    """A drive of these parts, if they suit each other."""
    assume(getattr(parts["load"], "inertia", 1.0) > 1e-3)
    try:
        return Drive(gear=gear.replace(input_inertia=2e-5 + gear.input_inertia), **parts)
    except ValueError:  # a voltage for a motor that takes none
        return reject()


other_parts = st.fixed_dictionaries({part: models(family) for part, family in OTHER_FAMILIES.items() if part != "sensors"})


@pytest.mark.whole_path("physics")
@pytest.mark.filterwarnings("ignore:the drive has bristles:RuntimeWarning")  # asked for
@settings(max_examples=sample(6, 15), suppress_health_check=[HealthCheck.filter_too_much])
@given(starting_gears, other_parts, built(sw.Sensors), seeds)
def test_a_drive_with_parts_drawn_from_every_list_runs_one_trajectory_in_every_scalar(
    gear: sw.Gear, parts: dict[str, Any], sensors: sw.Sensors, seed: int
) -> None:
    agree(whole(gear, {**parts, "sensors": sensors}), seed)


@pytest.mark.parametrize("load", [sw.loads.Inertia(inertia=0.05), sw.loads.Prescribed()], ids=lambda load: load.name)
def test_a_sampled_drive_that_begins_in_motion_is_in_a_pack_and_in_dual_numbers_what_it_is_alone(load: Any) -> None:
    """The instants of sampling are the same, be it counted from the beginning or from the first sample after it."""
    control = sw.control.Sampled(law=sw.control.PID(proportional=5.0, derivative=0.1, limit=24.0), period=1.7e-3, delay=3e-4)
    drive = DRIVE.replace(control=control, load=load, meter=sw.meter.EnergyMeter())
    course: dict[str, Any] = {"initial": {"input_speed": 3.0}}
    command = sw.scenario.sine(0.02, 20.0, 0.2)
    alone = sw.simulate(drive, command, **course)
    many = sw.simulate_many(drive, command, {"gear.damping": [5.0, 6.0]}, record=list(outputs(drive)), **course)
    dual = sw.analysis.derivatives(drive, command, ["gear.damping"], **course).run
    for found in (many.member(0), dual):
        assert [name for name in outputs(drive) if not np.array_equal(found[name], alone[name])] == []
