"""Tables of friction under load: what a dynamometer measures, and at which shaft a load is counted."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.gear_set import GearSet
from strainwave.identification.candidates.friction import FrictionCandidate, fit_friction
from strainwave.identification.experiments.friction_table import FrictionTable, with_load
from strainwave.identification.kinds.friction_table import fit_table
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.gear_so_far import GearSoFar

RATIO = 100.0
COULOMB, VISCOUS, LOSS = 0.050, 3e-4, 0.2
QUADRANTS = ("driving_forward", "driving_reverse", "backdriving_forward", "backdriving_reverse")


def dynamometer(loads: np.ndarray, both_ways: bool = True, loss: dict[float, float] | None = None) -> sw.Recording:
    """Speed, motor torque and output torque of a gear, written out by hand; losses by the sign of the power."""
    speeds = np.array([20.0, 50.0, 100.0, 200.0])
    speeds = np.concatenate((speeds, -speeds)) if both_ways else speeds
    speed, output = (each.ravel() for each in np.meshgrid(speeds, loads, indexing="ij"))
    lost = np.vectorize((loss or {1.0: LOSS, -1.0: LOSS, 0.0: 0.0}).get)(np.sign(speed * output))
    torque = output / RATIO + np.sign(speed) * (COULOMB + lost * np.abs(output) / RATIO) + VISCOUS * speed
    noise = 1e-3 * np.random.default_rng(5).normal(size=len(speed))
    units = {"speed": "rad/s", "torque": "N.m", "output_torque": "N.m"}
    return sw.Recording({"speed": speed, "torque": torque + noise, "output_torque": output}, units)


def fitted(recording: sw.Recording) -> FrictionCandidate:
    loaded, _ = with_load(recording, RATIO)
    return fit_friction(FrictionTable.of(loaded), sw.load("csg-20-100"))[0]


def sure(best: FrictionCandidate) -> dict[str, tuple[float, float]]:
    return {each.path: (each.value, each.sigma) for each in best.fit.estimates}


def check(best: FrictionCandidate, quadrants: tuple[str, ...]) -> None:
    truth = {"friction_input.coulomb": COULOMB, "friction_input.viscous": VISCOUS}
    truth |= {f"friction_mesh.{name}": LOSS for name in quadrants}
    found = sure(best)
    assert found.keys() == truth.keys()
    for path, value in truth.items():
        assert abs(found[path][0] - value) < 3.5 * found[path][1] < 0.1 * value, path


@pytest.mark.slow("identification")
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_dynamometer_that_measures_action_or_reaction_gives_the_loss_of_all_quadrants(sign: float) -> None:
    table = dynamometer(np.linspace(-40.0, 40.0, 9))
    _, remarks = with_load(table.with_column("output_torque", sign * table["output_torque"], "N.m"), RATIO)
    assert ("sign is turned" in remarks[0]) == (sign < 0.0)
    check(fitted(table.with_column("output_torque", sign * table["output_torque"], "N.m")), QUADRANTS)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_power_that_flows_one_way_determines_one_quadrant_and_no_other(sign: float) -> None:
    table = dynamometer(sign * np.linspace(0.0, 40.0, 5), both_ways=False)
    best = fitted(table)
    # the ratio of the set is -100: a positive speed of the input is a negative one of the mesh
    check(best, ("driving_reverse",) if sign > 0.0 else ("backdriving_reverse",))
    assert "the loss rests on the ratio" in with_load(table, RATIO)[1][-1]


@pytest.mark.slow("identification")
def test_driving_and_back_driving_have_losses_of_their_own_where_they_differ() -> None:
    best = fitted(dynamometer(np.linspace(-40.0, 40.0, 9), loss={1.0: 0.3, -1.0: 0.15, 0.0: 0.0}))
    assert "driving and back-driving" in best.name
    found = sure(best)
    for name, loss in zip(QUADRANTS, (0.3, 0.3, 0.15, 0.15), strict=True):
        assert abs(found[f"friction_mesh.{name}"][0] - loss) < 3.5 * found[f"friction_mesh.{name}"][1] < 0.05


@pytest.mark.slow("identification")
@pytest.mark.parametrize(("shaft", "scale"), [("input", 1.0 / RATIO), ("output", 1.0)])
def test_a_load_is_counted_at_the_shaft_where_its_loss_is_possible(shaft: str, scale: float) -> None:
    table = dynamometer(np.linspace(-40.0, 40.0, 9))
    friction = table["torque"] - table["output_torque"] / RATIO
    loaded = sw.Recording(
        {"speed": table["speed"], "torque": friction, "load_torque": scale * table["output_torque"]},
        {"speed": "rad/s", "torque": "N.m", "load_torque": "N.m"},
    )
    assert f"counted at the {shaft}" in with_load(loaded, RATIO)[1][0]
    check(fitted(loaded), QUADRANTS)


def test_a_gear_gets_the_loss_of_its_mesh_and_no_source_for_what_no_load_measured() -> None:
    start = GearSet.read("csg-20-100")
    table, _ = with_load(dynamometer(np.linspace(0.0, 40.0, 5), both_ways=False), RATIO)
    file = Recognised(Path("dyno.csv"), "friction", {}, {}, "input", (), (), {}, table)
    result, after = fit_table(file, table, 0.0, GearSoFar(start))
    assert [each.path for each in result.estimates if not each.why] == [
        "gear.friction_input.coulomb",
        "gear.friction_input.viscous",
        "gear.friction_mesh.driving_reverse",
    ]
    mesh, sources = after.gear_set.gear.friction_mesh, after.gear_set.sources
    assert {getattr(mesh, name) for name in QUADRANTS} == {mesh.driving_reverse}
    identified = [name for name in QUADRANTS if "identified from" in sources[f"gear.friction_mesh.{name}"].source]
    assert identified == ["driving_reverse"]


@pytest.mark.slow("identification")
def test_losses_of_quadrants_that_follow_one_are_all_identified() -> None:
    table, _ = with_load(dynamometer(np.linspace(-40.0, 40.0, 9)), RATIO)
    file = Recognised(Path("dyno.csv"), "friction", {}, {}, "input", (), (), {}, table)
    result, after = fit_table(file, table, 0.0, GearSoFar(GearSet.read("csg-20-100")))
    determined = {each.path for each in result.estimates if not each.why}
    assert determined == {"gear.friction_input.coulomb", "gear.friction_input.viscous"} | {
        f"gear.friction_mesh.{name}" for name in QUADRANTS
    }
    for name in QUADRANTS:
        assert after.gear_set.sources[f"gear.friction_mesh.{name}"].source.startswith("identified from")
