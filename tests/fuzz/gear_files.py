"""Gear files that are not as they should be."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import strainwave as sw
from numpy.random import Generator
from strainwave.files.entries import Entry, Quantity
from strainwave.files.gear_set import DRIVES_FOLDER
from strainwave.files.identified_tables import Covariance, Validation

from tests.fuzz.laws import Case, described
from tests.fuzz.mutation import encoded, mutated, picked
from tests.support.strategies import made

WORDS = (
    "[gear]", "[friction_input]", "[ratings]", "[motor]", "[control]", "[load]", "[[gear]]", "[gear.stiffness]",
    'model = "lugre"', 'model = "preisach"', 'model = 5', "model = []", "value = nan", "value = -inf", "value = 1e400",
    'value = "1"', "value = true", "value = []", "value = [[1.0]]", "value = {}", 'unit = "furlong"', 'unit = "deg"',
    "unit = 1", 'unit = ""', 'source = ""', 'source = "a\\nb"', "source = 5", "spread = -1", "spread = nan",
    "uncertainty = 1e999", "note = '''", 'name = ""', "name = 5", '"\\u0000" = 1', "a.b.c = 1", "x = 1979-05-27T07:32:00Z",
    "teeth = 0", "teeth = 1e9", "= 1", '{ value = 1.0, unit = "1" }', "[" * 2000, "{a=" * 500, "a." * 2000 + "b = 1",
)  # fmt: skip


@cache
def _texts() -> tuple[str, ...]:
    """Files as they should be: of the catalogue, and of a drive whose models have sequences, choices and parts."""
    drive = sw.Drive(
        gear=sw.Gear(
            friction_input=sw.friction.Thermal(),
            hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[6e3, 3e3], breakaway=[0.5, 0.8]),
            kinematic_error=sw.kinematic_error.Fourier(order=[2.0], amplitude=[1e-4], phase=[0.0]),
        ),
        control=sw.control.PID(),
        load=sw.loads.Pendulum(),
    )
    whole = sw.GearSet.of(drive, name="whole", source="assumed")
    gear_sets = (whole, sw.GearSet.read("hfuc-25-100"), sw.GearSet.read("csg-14-50"))
    preisach = sw.Gear(hysteresis=sw.hysteresis.Preisach(), friction_input=made(sw.friction.LuGre, viscous=5e-5))
    rated = sw.GearSet.of(preisach, name="rated", source="assumed").replace(
        ratings={"peak_torque": Quantity(source="assumed", value=50.0, unit="N.m")}
    )
    numbers = ("load.inertia", "gear.damping")
    identified = whole.replace(
        covariance=Covariance(numbers, ((1e-4, 1e-5), (1e-5, 1e-4))),
        validation=(Validation("log.csv", "log", "current", "A", 0.1, 0.5, 0.12, 0.4),),
    )
    return tuple(_written(gear_set) for gear_set in (*gear_sets, rated, identified))


def _written(gear_set: sw.GearSet) -> str:
    with TemporaryDirectory() as folder:
        path = Path(folder, "gear.toml")
        gear_set.save(path)
        return path.read_text(encoding="utf-8")


def toml_case(random: Generator, folder: Path) -> Case:
    path = folder / "gear.toml"
    data = encoded(mutated(picked(random, _texts()), random, WORDS), random)
    path.write_bytes(data)

    def check(gear_set: sw.GearSet) -> None:
        again = folder / "again.toml"
        gear_set.save(again)
        assert sw.GearSet.read(again) == gear_set, "a file holds the set otherwise"
        assert all(isinstance(entry, Entry) for entry in gear_set.sources.values()), "a source is none"

    return Case(described(data, 2000), lambda: sw.GearSet.read(path), check)


def name_case(random: Generator, folder: Path) -> Case:
    """A set asked for by a name that is none, or almost."""
    name = mutated(picked(random, sw.catalogue()), random, ("hfuc-25-100", ".toml", "/", str(DRIVES_FOLDER)))
    return Case(described(name), lambda: sw.GearSet.read(name))
