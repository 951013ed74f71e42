"""Gear files: what survives writing."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path
from typing import Any

import pytest
import strainwave as sw
from hypothesis import HealthCheck, assume, given, settings, strategies as st
from strainwave.files.described import optional
from strainwave.files.entries import Entry, Quantity
from strainwave.files.gear_set import GearSet, load, save

from tests.support.samples import sample
from tests.support.strategies import drives, gears, models, suited

# Examples may share one folder; the first of them pays for the imports.
untimed = settings(
    max_examples=sample(8, 20), suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)

printable = st.just(" ") | st.characters(exclude_categories=["C", "Z"])
lines = st.text(printable, min_size=1, max_size=8).filter(lambda text: text.strip() != "")
positive = st.floats(0.0, 1e300)
entries = st.builds(Entry, lines, st.none() | positive, st.none() | positive)
units = st.sampled_from(["1", "rad", "rpm", "N.m", "arcmin", "degC", "Nm/(rad/s)"])
ratings = st.builds(
    Quantity, lines, st.none() | positive, st.none() | positive,
    value=st.floats(allow_nan=False, allow_infinity=False), unit=units,
)  # fmt: skip


def innermost(law: Any) -> Any:
    return innermost(law.law) if hasattr(law, "law") else law


@st.composite
def gear_sets(draw: st.DrawFn) -> GearSet:
    """A set with any models, with or without the rest of a drive, each number with a source of its own."""
    families = {"motor": "motor", "control": "control", "load": "loads"}
    chosen = {part: draw(st.none() | models(family)) for part, family in families.items()}
    gear = draw(gears)
    chosen["control"] = suited(chosen["control"], gear.kinematics)
    motor, control = chosen["motor"], chosen["control"]
    fits = not isinstance(innermost(control), sw.control.Cascade | sw.control.StateFeedback)
    assume(fits or motor is None or isinstance(motor, sw.motor.BrushlessDC | sw.motor.PMSM))
    turns = gear.input_inertia > 0.0 and isinstance(gear.structure, sw.structure.Lumped)
    assume(turns or motor is None or motor.inertia > 0.0)  # something must turn at the input
    whole = {part: model for part, model in chosen.items() if model is not None}
    turned = whole if "motor" in whole else whole | {"motor": sw.motor.BrushlessDC()}
    paths = GearSet.of(sw.Drive(gear=gear, **turned), name="x", source="x").sources
    absent = tuple(f"{part}." for part in chosen.keys() - whole.keys())
    shared, own = draw(entries), draw(st.booleans())
    return GearSet(
        name=draw(lines),
        maker=draw(st.just("") | lines),
        note=draw(st.text(st.characters(exclude_categories=["Cs"]), max_size=20)),
        gear=gear,
        sources={path: draw(entries) if own else shared for path in paths if not path.startswith(absent)},
        ratings=draw(st.dictionaries(lines, ratings, max_size=3)),
        **chosen,
    )


@pytest.mark.slow("files")
@untimed
@given(gear_sets())
def test_a_set_written_and_read_is_equal_bit_for_bit(tmp_path: Path, gear_set: GearSet) -> None:
    gear_set.save(tmp_path / "set.toml")
    again = GearSet.read(tmp_path / "set.toml")
    assert again == gear_set
    assert repr(again) == repr(gear_set)  # tells -0.0 from 0.0
    assert repr(again.ratings) == repr(gear_set.ratings)


@pytest.mark.slow("files")
@untimed
@given(gear_sets())
def test_every_number_is_written_with_unit_and_source(tmp_path: Path, gear_set: GearSet) -> None:
    gear_set.save(tmp_path / "set.toml")
    document = tomllib.loads((tmp_path / "set.toml").read_text(encoding="utf-8"))
    document.pop("ratings", None)
    found = dict(entries_of(document))
    for path in gear_set.sources:
        whole = path.split("[")[0]
        part, _, key = whole.rpartition(".")
        if key in optional(attrgetter(part)(gear_set)):
            continue  # of faults, which a file may leave out
        (unit,) = [field["unit"] for field in attrgetter(part)(gear_set).fields if field["name"] == key]
        entry = found[whole.removeprefix("gear.") if whole.count(".") > 1 else whole]
        assert entry.keys() >= {"value", "unit", "source"}
        assert entry["unit"] == unit


def entries_of(content: Any, path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Every entry of a document by its path, those of a list by that of the list."""
    if isinstance(content, list):
        for one in content:
            yield from entries_of(one, path)
    elif isinstance(content, dict) and "value" in content:
        yield path, content
    elif isinstance(content, dict):
        for key, inner in content.items():
            yield from entries_of(inner, f"{path}.{key}".removeprefix("."))


@pytest.mark.slow("files")
@untimed
@given(drives)
def test_a_drive_that_was_saved_is_loaded_and_so_is_its_gear(tmp_path: Path, drive: sw.Drive) -> None:
    for model in (drive, drive.gear):
        save(model, tmp_path / "model.toml", name="x", source="x")
        again = load(tmp_path / "model.toml")
        assert again == model
        assert repr(again) == repr(model)  # tells -0.0 from 0.0


def test_writing_that_fails_leaves_the_old_file_and_no_other(folder: Path) -> None:
    gear_set = GearSet.of(sw.Gear(), name="x", source="x")
    gear_set.save("my.toml")
    before = Path("my.toml").read_bytes()
    with pytest.raises(UnicodeEncodeError):
        gear_set.replace(note="\ud800").save("my.toml")
    assert [file.name for file in folder.iterdir()] == ["my.toml"]
    assert Path("my.toml").read_bytes() == before
