"""Gear files: every model in every table."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Iterator
from functools import reduce
from pathlib import Path
from typing import Any

import pytest
import strainwave as sw
from strainwave import _core
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet, load

from tests.python.files.gear_file_texts import BASE, GRID, THERMAL, VISCOUS
from tests.support.each import each
from tests.support.strategies import fitting, made

TABLES = ("kinematics", "kinematic_error", "kinematic_noise", "stiffness", "hysteresis", "motor", "control")
PLACES = ("friction_input", "friction_mesh", "friction_output")


def filled(model: Any) -> Any:
    """A model in which no sequence is empty: one without numbers might do nothing, and need no table."""
    if hasattr(model, "law"):
        return made(model)
    count = 2 if model is sw.kinematic_error.ToothErrors else 1  # a flank has a beginning and an end
    return made(model, **{field["name"]: count * [fitting(field)] for field in model.fields if field["kind"] == "sequence"})


def with_law(**parts: Any) -> sw.Drive:
    """A drive with these parts, of its gear or its own."""
    drive = sw.Drive(motor=sw.motor.BrushlessDC())  # whose current any controller may act on
    of_gear = {name: parts.pop(name) for name in list(parts) if hasattr(drive.gear, name)}
    return drive.replace(gear=drive.gear.replace(**of_gear), **parts)


def every_model() -> Iterator[tuple[tuple[str, ...], Any, dict[str, Any]]]:
    """Every model in every table: the keys to it, its class, and the part of a drive that holds it."""
    families = _core.families
    for table in TABLES:
        yield from (((table,), model, {table: filled(model)}) for model in families[table].values())
    for place in PLACES:
        for model in families["friction"].values():
            yield (place,), model, {place: filled(model)}
            if model is not sw.friction.Thermal:
                yield (place, "law"), model, {place: sw.friction.Thermal(law=filled(model))}
                if model is not sw.friction.Cyclic:
                    cyclic = sw.friction.Cyclic(law=filled(model), order=[2.0], amplitude=[0.5], phase=[1.0])
                    yield (place, "law", "law"), model, {place: sw.friction.Thermal(law=cyclic)}
    for model in families["density"].values():
        yield ("hysteresis", "density"), model, {"hysteresis": sw.hysteresis.Preisach(density=filled(model))}


MODELS = [pytest.param(keys, model, part, id=f"{'.'.join(keys)}-{model.name}") for keys, model, part in every_model()]


def without(text: str, table: str, name: str) -> str:
    """The text of a file without an entry of a table, which may be a table itself."""
    tables = re.split(r"^(?=\[)", text, flags=re.MULTILINE)
    kept = [part for part in tables if not part.startswith((f"[{table}.{name}]", f"[{table}.{name}."))]
    entry = re.compile(rf"^{name} = .*\n(?:[ \]].*\n)*", re.MULTILINE)
    return "".join(entry.sub("", part) if part.startswith(f"[{table}]") else part for part in kept)


# By default a motor is healthy: its file need not deny each fault.
MAY_BE_LEFT_OUT = {
    "dc": {"cogging_torque", "cogging_order"},
    "brushless_dc": {"cogging_torque", "cogging_order", "open_share", "shorted_share"},
    "cyclic": {"viscous_share", "detent_order", "detent_torque", "detent_phase"},
    "pmsm": {"phase_resistance_excess", "dead_time_voltage", "dead_time_current", "open_share", "shorted_share"},
    "tooth_errors": {"flank_deviation"},
}


@pytest.mark.slow("files")
@each(("keys", "model", "part"), MODELS)
def test_no_parameter_of_any_model_may_be_left_out_but_those_of_faults(
    folder: Path, keys: tuple[str, ...], model: Any, part: dict[str, Any]
) -> None:
    whole = GearSet.of(with_law(**part), name="x", source="x")
    whole.replace(sources=dict.fromkeys(whole.sources, Entry("x"))).save("whole.toml")
    written = Path("whole.toml").read_text(encoding="utf-8")
    for parameter in model.fields:
        text = without(written, ".".join(keys), parameter["name"])
        if parameter["kind"] == "part" and (text == written or not getattr(parameter["default"], "active", True)):
            continue  # a part that does nothing has no table, or needs none
        Path("my.toml").write_text(text, encoding="utf-8")
        if parameter["name"] in MAY_BE_LEFT_OUT.get(model.name, ()):
            read = GearSet.read("my.toml")
            place: Any = read.motor if keys[0] == "motor" else reduce(getattr, keys, read.gear)
            assert getattr(place, parameter["name"]) == parameter["default"]
            continue
        header = re.escape(f"[{'.'.join(keys)}]")
        with pytest.raises(ValueError, match=rf"^my\.toml {header} {parameter['name']} is missing; write "):
            load("my.toml")


@pytest.mark.whole_path("files")
@each(("keys", "model", "part"), MODELS)
def test_every_model_is_written_and_read_in_every_table(
    folder: Path, keys: tuple[str, ...], model: Any, part: dict[str, Any]
) -> None:
    """Each number with a source of its own, so that none is taken for another."""
    drive = with_law(**part)
    one = GearSet.of(drive, name="x", source="x")
    gear_set = one.replace(sources={path: Entry(path, uncertainty=float(i)) for i, path in enumerate(one.sources)})
    gear_set.save("my.toml")
    table: Any = tomllib.loads(Path("my.toml").read_text(encoding="utf-8"))
    for key in keys:
        table = table[key]
    assert table["model"] == model.name
    again = GearSet.read("my.toml")
    assert again == gear_set
    assert repr(again.drive) == repr(drive)


def test_models_inside_models_are_read_with_units_and_sources(folder: Path) -> None:
    Path("my.toml").write_text(BASE + THERMAL + VISCOUS + GRID, encoding="utf-8")
    gear_set = GearSet.read("my.toml")
    law = sw.friction.Thermal(law=sw.friction.Viscous(viscous=0.5), viscous_fall=0.025, reference_temperature=293.15)
    assert gear_set.gear.friction_mesh == law
    assert gear_set.gear.hysteresis.density.limit == pytest.approx(math.radians(0.05), rel=1e-15)
    assert gear_set.gear.hysteresis.density.weight == (1.0, 2.0, 1.0)
    assert gear_set.sources["gear.friction_mesh.law.viscous"] == Entry("run")
    assert gear_set.sources["gear.friction_mesh.viscous_fall"] == Entry("two runs")
    assert gear_set.sources["gear.hysteresis.density.weight[2]"] == Entry("loop")


def test_an_idle_part_that_is_given_is_written_and_one_not_given_is_not(folder: Path) -> None:
    Path("my.toml").write_text(BASE)
    gear_set = GearSet.read("my.toml")
    gear_set.save("again.toml")
    assert tomllib.loads(Path("again.toml").read_text()).keys() == {"name", "kinematics", "stiffness"}
    source = {"gear.friction_mesh.viscous": Entry("assumed: none")}
    gear_set.replace(sources={**gear_set.sources, **source}).save("again.toml")
    assert tomllib.loads(Path("again.toml").read_text()).keys() == {"name", "kinematics", "stiffness", "friction_mesh"}
