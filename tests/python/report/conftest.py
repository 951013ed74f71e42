"""Results of each kind of measurement, and their reports."""

from __future__ import annotations

from dataclasses import replace

import pytest
import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.identification.identify import Identified
from strainwave.report.identify import identify_report

from tests.python.report.measured import drive_log, friction_table, input_loop, torsion_loop, with_drive
from tests.support.strategies import made


@pytest.fixture(scope="session")
def start() -> GearSet:
    return GearSet.read("hfuc-25-100")


@pytest.fixture(scope="session")
def from_friction(start: GearSet) -> Identified:
    return sw.identify(start, {"friction": friction_table()})


@pytest.fixture(scope="session")
def from_torsion(start: GearSet) -> Identified:
    return sw.identify(start, {"torsion": torsion_loop()})


@pytest.fixture(scope="session")
def from_input(start: GearSet) -> Identified:
    return sw.identify(start, {"torsion": input_loop(start)})


@pytest.fixture(scope="session")
def from_log(start: GearSet) -> Identified:
    full = with_drive(start)
    return sw.identify(full, {"run": drive_log(full)})


@pytest.fixture(scope="session")
def from_log_and_loop(start: GearSet) -> Identified:
    """A run fitted before the loop, whose friction it determines; the loop then gives a spring of another kind."""
    full = with_drive(start)
    friction = start.gear.friction_input.coulomb
    return sw.identify(full, {"run": drive_log(full), "torsion": input_loop(start, friction)})


@pytest.fixture(scope="session")
def contradicted(start: GearSet) -> Identified:
    """A set whose friction was measured before, and now is another."""
    earlier = Entry("test report 7 <of 2019>", uncertainty=1e-3)
    sources = {**start.sources, "gear.friction_input.coulomb": earlier, "gear.friction_input.viscous": earlier}
    return sw.identify(replace(start, sources=sources), {"friction": friction_table()}, accept=True)


VARYING = ("coupling_variation", "bearing_variation", "mesh_variation", "circular_spline_variation")


@pytest.fixture(scope="session")
def complete(start: GearSet) -> Identified:
    """A gear with every kind of part, models inside models too."""
    losses = sw.friction.LoadDependent(driving_forward=0.1, driving_reverse=0.1)
    varying = sw.variation.Periodic(order=[2.0], amplitude=[0.05], phase=[0.0])
    gear = start.gear.replace(
        kinematic_noise=sw.kinematic_error.Stochastic(amplitude=1e-5, seed=7),
        hysteresis=sw.hysteresis.Preisach(density=sw.hysteresis.GridDensity(limit=1e-3, weight=[1.0, 2.0, 1.0])),
        friction_mesh=sw.friction.Thermal(law=sw.friction.Cyclic(law=losses, order=[2.0], amplitude=[0.1], phase=[0.0])),
        friction_output=made(sw.friction.PositionDependent, cosine=[1e-3, 2e-3]),
        softening=sw.softening.ThermalSoftening(stiffness_fall=3e-4),
        stiffness_variation=varying,
        structure=made(sw.structure.Staged, **dict.fromkeys(VARYING, varying)),
        input_inertia=1e-5,
    )
    return sw.identify(GearSet.of(gear, name="complete", source="assumed"), {"friction": friction_table()})


EACH = ["from_friction", "from_torsion", "from_input", "from_log", "from_log_and_loop", "contradicted", "complete"]


@pytest.fixture(scope="session", params=EACH)
def each(request: pytest.FixtureRequest) -> Identified:
    found: Identified = request.getfixturevalue(request.param)
    return found


@pytest.fixture(scope="session")
def html(each: Identified) -> str:
    """The report of each result."""
    return identify_report(each)
