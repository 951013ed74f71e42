"""Each model of each list, in each place it may take: one trajectory in double, in packs and in dual numbers."""

from __future__ import annotations

import warnings
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

from tests.side_by_side import side_by_side
from tests.strategies import built

Array = NDArray[np.float64]

GEAR = sw.Gear(
    kinematic_error=sw.kinematic_error.Fourier(order=[2.0, 4.0], amplitude=[2e-4, 5e-5], phase=[0.3, -1.0]),
    stiffness=sw.stiffness.Cubic(a1=1.2e4, a3=1e9),
    hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[3e3, 2e3], breakaway=[0.5, 1.0]),
    damping=10.0,
    friction_input=sw.friction.Viscous(viscous=1e-3),
    friction_output=sw.friction.Viscous(viscous=0.5),
    input_inertia=1e-5,
)
DRIVE = PositionDrive(
    gear=GEAR,
    motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
    control=sw.control.PID(proportional=2.0, integral=1.0, derivative=0.05),
    load=sw.loads.Pendulum(inertia=0.5, gravity_torque=5.0),
)
SWING = sw.scenario.sine(0.05, 8.0, 0.06)
WARMING = sw.scenario.ramp(100.0, 0.06) + sw.scenario.constant(290.0, 0.06)
COLUMNS = [name for name, _, _ in _core.outputs]
PARTS = [
    pytest.param(field["name"], kind, id=f"{field['name']}-{kind.name}")
    for field in GEAR.fields
    if field["kind"] == "part" and field["name"] != "kinematics"
    for kind in field["options"].values()
]


def columns(run: sw.Recording) -> Array:
    return np.stack([run[name] for name in COLUMNS])


def varied(drive: PositionDrive, count: int, seed: int) -> list[PositionDrive]:
    """Drives that differ in every number but the orders of errors, by a little."""
    base = np.array([number for _, number, *_ in _core.parameters(drive)])
    factors = np.random.default_rng(seed).uniform(0.999, 1.001, (count, base.size))
    factors[:, [".order[" in path or ".seed" in path for path, *_ in _core.parameters(drive)]] = 1.0
    return [_core.with_numbers(drive, base * factor) for factor in factors]


@pytest.mark.parametrize(("part", "kind"), PARTS)
@settings(max_examples=5)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_every_model_runs_one_trajectory_in_every_scalar(part: str, kind: Any, data: st.DataObject, seed: int) -> None:
    drive = DRIVE.replace(gear=GEAR.replace(**{part: data.draw(built(kind))}))
    drives = varied(drive, 9, seed)  # one full pack, and one that repeats its last member
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            singles = [sw.simulate(each, SWING, 1e-4, sample=1e-3, temperature=WARMING) for each in drives]
    except (FloatingPointError, ValueError):  # too coarse a step, or out of bounds: said, and not this test's matter
        assume(False)
    packed = side_by_side(drives, SWING, 1e-4, sample=1e-3, temperature=WARMING)
    others = [i for i, (path, *_) in enumerate(_core.parameters(drive)) if ".order[" not in path]  # whole orders stay whole
    chosen = np.random.default_rng(seed).choice(others, 3, replace=False)
    dual, _ = derivatives(drives[0], SWING, chosen, 1e-4, 1e-3, temperature=WARMING)
    for single, other in zip([*singles, singles[0]], [*map(packed.member, range(9)), dual], strict=True):
        scale = np.abs(columns(single)).max(axis=1, keepdims=True)
        difference = np.abs(columns(other) - columns(single))
        apart = (difference > 1e-11 * scale).any(axis=1)
        assert not apart.any(), [name for name, differs in zip(COLUMNS, apart, strict=True) if differs]
