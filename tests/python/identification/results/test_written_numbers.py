"""No limit of a law and no rounding leaves a fit: not from any kind of record, and not of any number of a law."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.fitting.fit import fit
from strainwave.identification.fitting.unknowns import LIMIT_TOLERANCE
from strainwave.parameters import every

from tests.evidence.drawn.written_numbers import KINDS, of_kind
from tests.support.samples import sample

FRICTION = (
    sw.friction.Coulomb(coulomb=0.05, breakaway=0.06, viscous=3e-4),
    sw.friction.Stribeck(coulomb=0.05, breakaway=0.08, stribeck_speed=5.0, viscous=3e-4),
    sw.friction.CurvedViscous(
        coulomb=0.05, breakaway=0.06, viscous_torque=0.03, exponent=0.7, reference_speed=100.0, stribeck_speed=3.0
    ),
    sw.friction.LuGre(
        coulomb=0.05, breakaway=0.06, bristle_stiffness=40.0, bristle_damping=1e-4, stribeck_speed=2.0, viscous=3e-4
    ),
)
SPRINGS = (
    sw.stiffness.Linear(k=1e4), sw.stiffness.Cubic(a1=1e4, a3=1e9),
    sw.stiffness.ThreeSegment(k1=1e4, k2=1.5e4, k3=2e4, t1=6.0, t2=15.0),
)  # fmt: skip
ELEMENTS = sw.hysteresis.MaxwellSlip(stiffness=[4e3, 2e3], breakaway=[0.5, 1.5])
TURNING = [(sw.Gear(friction_input=law), "friction_input.") for law in FRICTION]
AT_REST = [(sw.Gear(stiffness=law, hysteresis=ELEMENTS), ("stiffness.", "hysteresis.")) for law in SPRINGS]
FREE = [
    pytest.param(gear, path, parts == "friction_input.", id=f"{gear.friction_input.name}-{gear.stiffness.name}-{path}")
    for gear, parts in (*TURNING, *AT_REST)
    for path in every(gear)
    if path.startswith(parts)
]


def measured(gear: sw.Gear, path: str, turns: bool) -> sw.Recording:
    """Return the torque of a gear whose number would have to lie below 0, by continuing the difference to half of it."""
    half = gear.replace({path: 0.5 * every(gear)[path].value})
    speed = np.geomspace(0.5, 100.0, 40)
    twist = 2e-3 * np.interp(np.linspace(0.0, 5.0, 300), range(6), [0.0, 1.0, -1.0, 1.0, -1.0, 1.0])

    def torque(of: Any) -> Any:
        return of.friction_input.steady(speed) if turns else of.stiffness.torque(twist) + of.hysteresis.trace(twist)

    values = torque(gear) + 2.05 * (torque(half) - torque(gear))
    values = values + 1e-4 * np.abs(values).max() * np.random.default_rng(3).standard_normal(len(values))
    if not turns:
        return sw.Recording({"twist": twist, "torque": values}, {"twist": "rad", "torque": "N.m"})
    return sw.Recording({"speed": speed, "torque": values}, {"speed": "rad/s", "torque": "N.m"})


@pytest.mark.parametrize(("gear", "path", "turns"), FREE)
def test_a_number_that_data_pull_below_nothing_ends_at_its_limit(gear: sw.Gear, path: str, turns: bool) -> None:
    before = every(gear)[path]
    found = fit(gear, measured(gear, path, turns), [path])
    (estimate,) = (each for each in found.estimates if each.path == path)
    assert estimate.value == before.low or estimate.value >= LIMIT_TOLERANCE * before.value * (1.0 - 1e-9)
    if not np.isfinite(estimate.sigma):
        assert estimate.value == before.value


@pytest.mark.parametrize(("kind", "seed"), [("friction_table", 8), ("torsion_at_input", 16), ("one_speed", 0)])
def test_no_limit_and_no_rounding_is_written(kind: str, seed: int) -> None:
    found = of_kind(kind, seed)
    assert found.verdict != "wrong", found.message


@pytest.mark.slow("identification")
@pytest.mark.parametrize("kind", KINDS)
def test_no_limit_and_no_rounding_is_written_of_any_kind(kind: str) -> None:
    few = 2 if "log" in kind else 8  # a log takes up to 1 s
    wrong = [found.message for seed in range(sample(few, 25)) if (found := of_kind(kind, seed)).verdict == "wrong"]
    assert not wrong
