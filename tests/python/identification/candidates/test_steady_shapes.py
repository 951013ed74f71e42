"""Every law that a friction table can tell: fifty truths each, with one percent noise, are found as well as is said.

python -m tests.python.identification.candidates.test_steady_shapes 500       as many truths of each
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave import friction
from strainwave.identification.candidates.steady_shapes import Shape, harmonics_of, over_speed, with_conditions
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.fitting.fit import fit

Array = NDArray[np.float64]

SPEED = np.concatenate([-np.geomspace(0.3, 300.0, 30), np.geomspace(0.3, 300.0, 30)])
NOISE = 0.01  # of the largest torque
REFERENCE = 300.0  # rad/s
TRUTHS = 50


def straight(random: np.random.Generator) -> dict[str, float]:
    return {"coulomb": random.uniform(0.02, 0.06), "viscous": random.uniform(0.5, 2.0) * 0.04 / REFERENCE}


def falling(random: np.random.Generator) -> dict[str, float]:
    numbers = straight(random)
    fall = {"breakaway": numbers["coulomb"] * random.uniform(1.3, 2.0), "stribeck_speed": random.uniform(1.0, 8.0)}
    return {"coulomb": numbers["coulomb"], **fall, "viscous": numbers["viscous"]}


def curved(random: np.random.Generator, fall: bool = False) -> friction.CurvedViscous:
    numbers = falling(random)
    viscous = {"viscous_torque": REFERENCE * numbers.pop("viscous"), "exponent": random.choice([0.45, 0.6, 1.5, 2.0])}
    if not fall:
        numbers = {"coulomb": numbers["coulomb"]}
    return friction.CurvedViscous(**numbers, **viscous, reference_speed=REFERENCE)


def asymmetric(law: Any, random: np.random.Generator) -> friction.Asymmetric:
    dry, viscous = random.uniform(-0.3, 0.3, 2)
    return friction.Asymmetric(law=law, dry_asymmetry=dry, viscous_asymmetry=viscous)


FALL, CURVED, BOTH = "with a fall at low speed", "curved viscous", "curved viscous, with a fall at low speed"
LAWS = {
    "Coulomb and viscous": lambda random: friction.Coulomb(**straight(random)),
    FALL: lambda random: friction.Stribeck(**falling(random)),
    CURVED: curved,
    BOTH: lambda random: curved(random, fall=True),
    "Coulomb and viscous, asymmetric": lambda random: asymmetric(friction.Coulomb(**straight(random)), random),
    f"{FALL}, asymmetric": lambda random: asymmetric(friction.Stribeck(**falling(random)), random),
    f"{CURVED}, asymmetric": lambda random: asymmetric(curved(random), random),
    f"{BOTH}, asymmetric": lambda random: asymmetric(curved(random, fall=True), random),
}


def thermal(random: np.random.Generator) -> friction.Thermal:
    dry, viscous = random.uniform(0.005, 0.03, 2)
    law = friction.Stribeck(**falling(random))
    return friction.Thermal(law=law, dry_fall=dry, viscous_fall=viscous, reference_temperature=303.15)


def lubricated(random: np.random.Generator, **more: float) -> friction.MixedLubrication:
    return friction.MixedLubrication(**falling(random), reference_temperature=303.15, **more)


def cyclic(random: np.random.Generator) -> friction.Cyclic:
    waves = {
        "order": [1.0, 2.0],
        "amplitude": random.uniform(0.1, 0.3, 2).tolist(),
        "phase": random.uniform(-1.0, 1.0, 2).tolist(),
    }
    return friction.Cyclic(law=friction.Coulomb(**straight(random)), **waves)


BESIDE = {
    f"{FALL}, over the temperature": thermal,
    f"{FALL}, lubricated over the temperature": lambda r: lubricated(r, viscosity_fall=r.uniform(0.01, 0.04)),
    f"{FALL}, over the load": lambda r: lubricated(r, load_sensitivity=r.uniform(1.0, 4.0)),
    "Coulomb and viscous, over the angle": cyclic,
}


def measured(law: Any, random: np.random.Generator, **beside: Array) -> FrictionTable:
    speed = np.tile(SPEED, 4) if beside else SPEED
    truth = np.array(
        [law.steady(v, **{name: float(values[i]) for name, values in beside.items()}) for i, v in enumerate(speed)]
    )
    return FrictionTable(speed, truth + NOISE * np.abs(truth).max() * random.normal(size=len(truth)), **beside)


def found(shape: Shape, table: FrictionTable) -> tuple[Any, Array, Array]:
    """The law, its estimates and what they may be off."""
    result = fit(sw.Gear(friction_input=shape.law), table, [f"friction_input.{path}" for path in shape.free])
    return (
        result.gear.friction_input,
        np.array([estimate.value for estimate in result.estimates]),
        np.array([estimate.sigma for estimate in result.estimates]),
    )


def at(law: Any, path: str) -> float:
    """A number of a law by its path."""
    for name in path.split("."):
        name, _, index = name.partition("[")
        law = getattr(law, name)
        law = law[int(index[:-1])] if index else law
    return float(law)


def over_speed_off(name: str, seed: int) -> Array:
    """How far each number lies from the truth, over what it may be off."""
    random = np.random.default_rng(seed)
    law = LAWS[name](random)
    table = measured(law, random)
    (shape,) = (each for each in over_speed(table) if each.name == name)
    _, value, sigma = found(shape, table)
    return (value - [at(law, path) for path in shape.free]) / sigma


def beside_speed_off(name: str, seed: int) -> Array:
    random = np.random.default_rng(seed)
    law = BESIDE[name](random)
    n = 4 * len(SPEED)
    column, values = {
        "temperature": ("temperature", np.repeat([288.15, 298.15, 308.15, 318.15], len(SPEED))),
        "load": ("load", np.repeat([0.0, 0.05, 0.1, -0.15], len(SPEED))),
        "angle": ("angle", random.uniform(0.0, 2.0 * np.pi, n)),
    }[name.rpartition(" ")[2]]
    table = measured(law, random, **{column: values})
    (plain,) = (each for each in over_speed(table) if name.startswith(f"{each.name}, ") and "asymmetric" not in each.name
                and each.name.count(",") == name.count(",") - 1)  # fmt: skip
    inner, *_ = found(plain, table)
    shape = Shape(plain.name, inner, plain.free)
    residual = table.torque - fit(sw.Gear(friction_input=inner), table, ["friction_input.coulomb"]).predicted[0]
    (shape,) = (each for each in with_conditions(table, shape, residual) if each.name == name)
    _, value, sigma = found(shape, table)
    return (value - [at(law, path) for path in shape.free]) / sigma


def calibrated(off: list[Array]) -> None:
    """Nine of ten within two standard deviations, of every number, and the scatter as large as is said."""
    table = np.array(off)
    assert np.all(np.mean(np.abs(table) <= 2.0, axis=0) >= 0.9), np.mean(np.abs(table) <= 2.0, axis=0)
    scatter = np.sqrt(np.mean(table**2, axis=0))
    assert np.all((scatter > 0.7) & (scatter < 1.4)), scatter


@pytest.mark.parametrize("name", LAWS)
def test_what_is_found_over_the_speed_lies_as_near_as_is_said(name: str) -> None:
    calibrated([over_speed_off(name, seed) for seed in range(TRUTHS)])


@pytest.mark.slow("identification")
@pytest.mark.parametrize("name", BESIDE)
def test_what_is_found_beside_the_speed_lies_as_near_as_is_said(name: str) -> None:
    calibrated([beside_speed_off(name, seed) for seed in range(TRUTHS)])


def test_harmonics_are_found_where_they_are_and_nowhere_else() -> None:
    random = np.random.default_rng(1)
    angle = random.uniform(0.0, 2.0 * np.pi, 400)
    table = FrictionTable(np.full(400, 10.0), 0.05 * (1.0 + 0.1 * np.sin(3.0 * angle + 0.4)), angle=angle)
    noise = 5e-4 * random.normal(size=400)
    ((order, amplitude, phase),) = harmonics_of(table, table.torque - 0.05 + noise)
    assert (order, amplitude, phase) == pytest.approx((3.0, 0.1, 0.4), rel=0.1)
    assert harmonics_of(table, noise) == []


if __name__ == "__main__":
    for name in (*LAWS, *BESIDE):
        off = np.array([(over_speed_off if name in LAWS else beside_speed_off)(name, seed) for seed in range(int(sys.argv[1]))])
        print(name, np.mean(np.abs(off) <= 2.0, axis=0).round(3), np.sqrt(np.mean(off**2, axis=0)).round(2))
