"""Gear sets: what a set holds and refuses, the catalogue, and how a set is found."""

from __future__ import annotations

import copy
import math
import pickle
import re
import shutil
import tomllib
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pytest
import strainwave as sw
from hypothesis import given
from strainwave import _core
from strainwave.gear_set import Entry, GearSet, Quantity, catalogue, load, save

from tests.strategies import drives

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = {file.stem: file for file in (ROOT / "python" / "strainwave" / "catalogue").glob("*.toml")}


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


# The value


def test_every_number_has_a_source_and_every_source_a_number() -> None:
    gear_set = GearSet.read("hfuc-25-100")
    sources = dict(gear_set.sources)
    del sources["gear.stiffness.k2"]
    with pytest.raises(ValueError, match=exactly("HFUC-25-100: gear.stiffness.k2 has no source")):
        gear_set.replace(sources=sources)
    with pytest.raises(ValueError, match=exactly("HFUC-25-100: sources name gear.x, which is no number of the set")):
        gear_set.replace(sources={**gear_set.sources, "gear.x": Entry("x")})
    with pytest.raises(ValueError, match=exactly("HFUC-25-100: gear.stiffness.k has no source")):
        gear_set.replace(gear=gear_set.gear.replace(stiffness=sw.stiffness.Linear(k=1.0)))


@given(drives)
def test_the_paths_are_those_of_the_drives_parameters_and_its_counts(drive: sw.drives.PositionDrive) -> None:
    counts = {f"gear.kinematics.{f['name']}" for f in drive.gear.kinematics.fields if f["kind"] == "count"}
    numbers = {path for path, *_ in _core.parameters(drive)}
    assert GearSet.of(drive, name="x", source="x").sources.keys() == numbers | counts


def test_a_set_is_frozen_hashable_and_survives_pickling_and_copying() -> None:
    gear_set = GearSet.read("csg-20-100")
    for twin in (pickle.loads(pickle.dumps(gear_set)), copy.deepcopy(gear_set)):
        assert twin == gear_set
        assert hash(twin) == hash(gear_set)
    with pytest.raises(TypeError, match="does not support item assignment"):
        gear_set.sources["gear.damping"] = Entry("x")  # type: ignore[index]
    assert gear_set.replace(note="other") != gear_set


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: Entry(""), ValueError, "source = '' must be one line of text"),
        (lambda: Entry("two\nlines"), ValueError, r"source = 'two\nlines' must be one line of text"),
        (lambda: Entry(3), TypeError, "source must be a text, not 3"),
        (lambda: Entry("x", spread=-1.0), ValueError, "spread = -1.0 must lie in [0, inf)"),
        (lambda: Entry("x", spread="1"), TypeError, "spread must be a number, not '1'"),
        (lambda: Entry("x", uncertainty=math.nan), ValueError, "uncertainty = nan must lie in [0, inf)"),
        (lambda: Entry("x", uncertainty=math.inf), ValueError, "uncertainty = inf must lie in [0, inf)"),
        (lambda: Quantity(value=math.inf, unit="N.m", source="x"), ValueError, "value = inf N.m must be finite"),
        (lambda: Quantity(value="1", unit="N.m", source="x"), TypeError, "value must be a number, not '1'"),
        (
            lambda: Quantity(value=1.0, unit="N.n", source="x"),
            ValueError,
            'unit "N.n" is not known; write it like N.m, rad/s, deg',
        ),
        (lambda: GearSet.read("hfuc-25-100").replace(maker=3), TypeError, "maker must be a text, not 3"),
        (lambda: GearSet.read("hfuc-25-100").replace(maker="a\nb"), ValueError, r"maker = 'a\nb' must be one line of text"),
        (lambda: GearSet.read("hfuc-25-100").replace(note=3), TypeError, "note must be a text, not 3"),
        (
            lambda: GearSet.read("hfuc-25-100").replace(sources=[]),
            TypeError,
            'sources must be a mapping, as in {"gear.damping": Entry("assumed")}, not []',
        ),
        (
            lambda: GearSet.read("hfuc-25-100").replace(ratings={3: Quantity(value=4.0, unit="N.m", source="x")}),
            TypeError,
            "a number is named by a text, not 3",
        ),
        (lambda: GearSet.of(3, name="x", source="x"), TypeError, "position_drive.gear must be a Gear, not 3"),
        (
            lambda: GearSet.read("hfuc-25-100").replace(motor=3),
            TypeError,
            "position_drive.motor must be one of DC, not 3",
        ),
        (
            lambda: GearSet.read("hfuc-25-100").replace(ratings={"peak_torque": 4.0}),
            TypeError,
            "peak_torque must have a strainwave.gear_set.Quantity, not 4.0",
        ),
    ],
)
def test_a_wrong_value_is_refused(make: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=exactly(message)):
        make()


def test_the_drive_needs_motor_and_load_and_runs_in_open_loop_without_control() -> None:
    bare = GearSet.of(sw.Gear(), name="bare", source="x")
    with pytest.raises(ValueError, match=exactly("bare has no [motor] and no [load]; a drive needs a motor and a load")):
        _ = bare.drive
    motor, load = sw.motor.DC(resistance=2.0), sw.loads.Inertia(inertia=3.0)
    drive = sw.drives.PositionDrive(gear=sw.Gear(damping=7.0), motor=motor, load=load)
    whole = GearSet.of(drive, name="whole", source="x")
    assert whole.drive == drive
    sources = {path: entry for path, entry in whole.sources.items() if not path.startswith("control.")}
    assert whole.replace(control=None, sources=sources).drive.control == sw.control.OpenLoop(gain=1.0)
    sources = {path: entry for path, entry in sources.items() if not path.startswith("load.")}
    with pytest.raises(ValueError, match=exactly("whole has no [load]; a drive needs a motor and a load")):
        _ = whole.replace(control=None, load=None, sources=sources).drive


def test_the_uncertainty_of_a_temperature_is_a_difference() -> None:
    kelvin = Quantity(value=20.0, unit="degC", source="x", uncertainty=0.5).to("K")
    assert (kelvin.value, kelvin.uncertainty) == (293.15, 0.5)


# The catalogue


@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_a_catalogue_set_is_read_number_by_number(name: str, tmp_path: Path) -> None:
    """Against the file as plain TOML; the files are in SI units."""
    gear_set = GearSet.read(name)
    document = tomllib.loads(SHIPPED[name].read_text(encoding="utf-8"))
    assert load(name) == gear_set.gear
    assert gear_set.name == document.pop("name")
    assert gear_set.maker == document.pop("maker")
    assert gear_set.note == document.pop("note", "")
    assert {key: asdict(rating) for key, rating in gear_set.ratings.items()} == {
        key: {"spread": None, "uncertainty": None, **entry} for key, entry in document.pop("ratings", {}).items()
    }
    counted = 0
    for table, content in document.items():
        model = gear_set.gear if table == "gear" else getattr(gear_set.gear, table)
        assert content.pop("model", model.name) == model.name
        for key, entry in content.items():
            member = getattr(model, key)
            value = entry if isinstance(entry, str) else entry["value"]
            assert (list(member) if isinstance(value, list) else member) == value
            places = [] if isinstance(entry, str) else [""] if not isinstance(value, list) else range(len(value))
            for place in places:
                path = f"{'' if table == 'gear' else 'gear.'}{table}.{key}" + (f"[{place}]" if place != "" else "")
                assert gear_set.sources[path] == Entry(entry["source"], entry.get("spread"))
                counted += 1
    not_given = {path.rpartition(".")[0] for path, entry in gear_set.sources.items() if entry == Entry("not given")}
    assert not_given == {"gear.kinematic_noise", "gear.friction_mesh"}
    assert counted == sum(entry != Entry("not given") for entry in gear_set.sources.values())
    gear_set.save(tmp_path / "copy.toml")
    assert GearSet.read(tmp_path / "copy.toml") == gear_set


def test_the_catalogue_lists_what_is_shipped() -> None:
    assert catalogue() == sorted(SHIPPED)
    assert len(SHIPPED) == 127


@pytest.mark.parametrize("name", ["csg-14-50", "csg-20-160", "hfuc-25-100", "hfuc-58-50", "shg-32-80", "shg-58-160"])
def test_a_catalogue_gear_turns_its_output_by_its_ratio(name: str) -> None:
    """Load and motor are matched to the wave generator, and reach their speed with a time constant of 20 ms."""
    gear = load(name)
    inertia = gear.input_inertia
    motor = sw.motor.DC(inertia=inertia, torque_constant=0.1, back_emf=0.1, resistance=0.1**2 * 0.02 / (3 * inertia))
    disc = sw.loads.Inertia(inertia=inertia * gear.kinematics.ratio**2)
    drive = sw.drives.PositionDrive(gear=gear, motor=motor, load=disc)
    run = sw.simulate(drive, sw.scenario.step(amplitude=20.0, duration=0.2))
    _, _, ratio = name.split("-")
    assert run["input_angle"][-1] > 2 * math.pi
    # Errors and windup of some arcmin are less than a hundredth of the way.
    assert run["output_angle"][-1] == pytest.approx(-run["input_angle"][-1] / int(ratio), rel=1e-2)


# Names and paths


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("HFUC-25-100", "; near it are hfuc-25-100"),
        ("hfuc-25-101", "; near it are hfuc-25-.*, hfuc-25-100"),
        ("xyz", "; strainwave"),
    ],
)
def test_a_name_not_in_the_catalogue_is_answered_with_those_near_it(name: str, near: str) -> None:
    with pytest.raises(ValueError, match=f'^no gear set "{name}" in the catalogue{near}.*catalogue\\(\\) lists all'):
        load(name)


def test_a_path_is_what_has_a_folder_or_ends_in_toml(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("sub").mkdir()
    save(sw.Gear(damping=3.0), "my.toml", name="x", source="x")
    shutil.copy("my.toml", "sub/noending")
    assert load("my.toml") == load(Path("my.toml")) == load("sub/noending") == load(tmp_path / "sub" / "noending")


def test_a_file_is_saved_under_a_name_that_is_read_as_a_path() -> None:
    with pytest.raises(ValueError, match=exactly("mine: a gear file ends in .toml")):
        GearSet.read("hfuc-25-100").save("mine")
